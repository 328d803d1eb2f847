use super::*;
use crate::detect::{Side, detect};
use crate::sample::sizes::Sizes;

fn strips(grains: u32, count: u32, width: f64, seed: u64) -> Strips<'static> {
    let radii = Radii { sizes: &Sizes::UniformByNumber, range: [0.05, 0.1], dimensions: 2 };
    Strips { radii, seed, grains, count, width }
}

#[test]
fn strips_join_without_overlap_and_hold_each_other() {
    for (grains, count, width, seed) in
        [(4000, 3, 9.6, 1), (3000, 4, 12.0, 2), (1500, 2, 5.0, 3), (6000, 2, 5.0, 4)]
    {
        let strips = strips(grains, count, width, seed);
        strips.check().unwrap();
        let all = strips.whole().unwrap();
        assert_eq!(all.len(), grains as usize);
        let (position, radius): (Vec<_>, Vec<_>) = all.into_iter().unzip();
        let contacts = detect(&position, &radius, 1e-9);
        assert!(contacts.iter().all(|contact| contact.gap >= -1e-10), "discs overlap");
        let mut held = vec![0; grains as usize];
        for contact in &contacts {
            let Side::Grain(other) = contact.antagonist else { panic!("there are no walls") };
            held[contact.candidate as usize] += 1;
            held[other as usize] += 1;
        }
        for (x, r) in position.iter().zip(&radius) {
            assert!(x.x >= r - 1e-9 && x.x <= width - r + 1e-9 && x.y >= r - 1e-9, "a disc leaves the box");
        }
        for border in 1..count {
            // A seam is about as high as the box is filled, and each two greatest diameters of it are held from both sides.
            let seam = strips.seam(border - 1);
            let first = strips.numbers(border).start;
            let in_seam = |k: u32| seam.ends[0] - 0.1 <= position[k as usize].x && k < first;
            let across = contacts.iter().filter(|contact| {
                matches!(contact.antagonist, Side::Grain(j) if contact.candidate < first && j >= first)
            });
            let height = position.iter().map(|x| x.y).fold(0.0, f64::max);
            assert!(across.count() as f64 > height / 0.4, "strips {border} do not touch");
            let of_seam: Vec<u32> = (strips.numbers(border - 1)).filter(|k| in_seam(*k)).collect();
            let area: f64 = of_seam.iter().map(|k| std::f64::consts::PI * radius[*k as usize].powi(2)).sum();
            assert!(area > 0.6 * height * 0.4, "the seam is filled to {}", area / (height * 0.4));
            let loose = of_seam.iter().filter(|k| held[**k as usize] < 2 && position[**k as usize].y > 0.1);
            // Those whose neighbour of the next strip was one too many.
            assert!(loose.count() * 20 < of_seam.len() + 40);
        }
        // The surface is level to a few diameters.
        let surface = |k: u32| strips.numbers(k).map(|k| position[k as usize].y).fold(0.0, f64::max);
        let heights: Vec<f64> = (0..count).map(surface).collect();
        assert!(heights.iter().all(|h| (h - heights[0]).abs() < 0.1 * heights[0] + 0.4), "{heights:?}");
    }
}

#[test]
fn strips_that_are_too_narrow_are_refused() {
    let error = strips(1000, 8, 4.8, 1).check().unwrap_err();
    assert!(
        error.starts_with("`sample.strips` is 8: strips are to be at least 24 greatest radii"),
        "{error}"
    );
}
