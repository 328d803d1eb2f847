//! Newton by subdomains.

use crate::problems::{PACKINGS, frozen, impulses, start};
use active_set::ActiveSet;
use contact::Meter;
use newton_schur::{Interface, NewtonSchur, Preconditioner};
use partition::Grid;

#[test]
fn tmp_iterates() {
    for name in PACKINGS {
        let problem = frozen(name).problem;
        for (grid, interface, acc) in [(1, Interface::Direct, 1e-12), (8, Interface::Direct, 1e-12), (64, Interface::Direct, 1e-12),(1, Interface::Cg, 1e-12), (8, Interface::Cg, 1e-12), (8, Interface::Cg, 1e-9), (8, Interface::Cg, 1e-6)] {
            let method = NewtonSchur { subdomains: Grid::of_count(grid), interface, inner_accuracy: acc, ..NewtonSchur::default() };
            let (mut a, mut b) = (start(&ActiveSet::default(), &problem), start(&method, &problem));
            let mut meter = Meter::new(&problem);
            print!("{name} {grid} {interface:?} {acc:e}:");
            let mut before = 0;
            let now = std::time::Instant::now();
            for _ in 0..2000 {
                if b.stalled() && a.stalled() { break; }
                a.advance();
                b.advance();
                if b.work().factorisations > 0 {
                    let (r, s) = (impulses(&*a, &problem), impulses(&*b, &problem));
                    let (m, n) = (meter.measure(&r, 0.0).natural_map, meter.measure(&s, 0.0).natural_map);
                    let inner = b.derived()[0].1 as u64;
                    print!(" {m:.1e}/{n:.1e}/{}", inner - before);
                    before = inner;
                }
            }
            println!(" {:?}", now.elapsed());
        }
    }
}
