//! Problems of ours through FCLIB, the three ways in which Siconos writes W, and files that are no problem.

use super::fclib::{Held, write_global, write_local};
use super::global::local;
use super::{converted, dat, read};
use crate::plan::Method;
use cases::AnyFrozen;
use contact::{Measure, Spheres};
use lineup::{Global, OneProblem, Posed, Run, Triplets};
use local::LocalProblem;
use runner::{Measured, Outcome, Status, Stop};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn frozen(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/frozen").join(name).with_extension("json")
}

fn file(folder: &TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn problem_of_every_mechanics_comes_back_byte_by_byte() {
    let folder = TempDir::new().unwrap();
    for name in ["settled-60", "rough-250", "spheres-250", "rough-spheres-250"] {
        let text = std::fs::read_to_string(frozen(name)).unwrap();
        let there = converted(&frozen(name), Held::Ours(text.clone()), Path::new("p.hdf5")).unwrap();
        let there = file(&folder, "p.hdf5", there);
        let back = converted(&there, read(&there).unwrap(), Path::new("p.json")).unwrap();
        assert!(back == text.as_bytes(), "{name}");
    }
}

fn problem(name: &str) -> Box<dyn OneProblem> {
    lineup::problem(AnyFrozen::read(&frozen(name)).unwrap())
}

/// Runs a method from r = 0.
fn solved(posed: &Posed, method: &Method, stop: &Stop) -> anyhow::Result<Outcome> {
    let r0 = vec![0.0; posed.facts().of_contact * posed.facts().contacts];
    let go_on = &mut |_: &runner::Progress| std::ops::ControlFlow::Continue(());
    let run = Run { truths: &[], r0: &r0, stop, measured: Measured::Needed };
    posed.solve(method.ours()?, run, go_on)
}

/// Returns the iterates of a method after some iterations, on W alone and on the problem with its grains: impulses and
/// natural map of each.
fn iterated(name: &str, method: &Method, iterations: u64) -> [(Vec<f64>, f64); 2] {
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-300, max_iterations: iterations };
    let problem = problem(name);
    // Without friction a tangential impulse of 0 stands beside each normal one.
    let (unknowns, own) = (problem.facts().dimensions, problem.facts().of_contact);
    let on_w = Posed::W(Box::new(local(problem.arrays(), unknowns).unwrap()));
    let on_w = solved(&on_w, method, &stop).unwrap();
    let impulses = on_w.impulses.chunks(unknowns).flat_map(|r| r[..own].to_vec()).collect();
    let ours = solved(&Posed::Grains(problem), method, &stop).unwrap();
    [(impulses, on_w.measures.natural_map), (ours.impulses, ours.measures.natural_map)]
}

fn method(name: &str, settings: &[(&str, &str)]) -> Method {
    let settings: Vec<_> = settings.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    Method::parse(name, &settings).unwrap()
}

#[test]
fn iterates_on_w_alone_are_those_with_grains() {
    let check = |[(r, map), (ours, our_map)]: [(Vec<f64>, f64); 2]| {
        let scale = ours.iter().fold(0.0_f64, |most, r| most.max(r.abs()));
        assert!(r.len() == ours.len() && scale > 0.0);
        assert!(r.iter().zip(&ours).all(|(a, b)| (a - b).abs() < 1e-9 * scale));
        assert!((map - our_map).abs() < 1e-7 * our_map, "{map:e} {our_map:e}");
    };
    let diagonal = method("cg", &[("preconditioner", "diagonal")]);
    for method in [method("nsgs", &[]), method("cg", &[]), diagonal] {
        check(iterated("rough-250", &method, 30));
        check(iterated("settled-60", &method, 20));
    }
    // In space the exact direction of sliding is not where a projection ends, so impulses agree at the solution alone.
    let [_, (ours, our_map)] = iterated("rough-spheres-250", &method("nsgs", &[]), 30);
    let map = local(problem("rough-spheres-250").arrays(), 3).unwrap().natural_map(&ours);
    assert!((map - our_map).abs() < 1e-9 * our_map, "{map:e} {our_map:e}");
    check(iterated("rough-spheres-250", &method("cg", &[("preconditioner", "diagonal")]), 2));
}

#[test]
fn solution_on_w_alone_is_that_with_grains() {
    let [(r, map), (ours, _)] = iterated("settled-250", &method("active-set", &[]), 2000);
    let apart = problem("settled-250").distance(&ours, &r);
    assert!(map < 1e-12 && apart < 1e-11, "{map:e}, {apart:e}");
}

/// W = H Hᵗ of contacts of `d` unknowns each between two of half as many grains, any two: mostly singular. The same seed, the same W.
fn between_any(d: usize, contacts: usize, seed: u64) -> LocalProblem {
    let mut state = seed;
    // PCG's multiplier; the upper bits from −1 to 1.
    let mut number = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    };
    let grains = contacts / 2 + 2;
    let mut h = vec![vec![0.0; grains * d]; contacts * d];
    for contact in h.chunks_mut(d) {
        let first = ((number() + 1.0) * 0.5 * grains as f64) as usize % grains;
        for row in contact {
            for k in 0..d {
                row[first * d + k] = number();
                row[(first + 1) % grains * d + k] = number();
            }
        }
    }
    let q = (0..contacts * d).map(|_| number() - 0.25).collect();
    let friction = (0..contacts).map(|_| if d > 1 { number().abs() } else { 0.0 }).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let entry = |row: usize, column: usize| (row, column, dot(&h[row], &h[column]));
    let size = contacts * d;
    let entries = (0..size).flat_map(|row| (0..size).map(move |column| entry(row, column)));
    LocalProblem::new(d, entries.filter(|(.., w)| *w != 0.0), q, friction).unwrap()
}

/// Blocks of 1, without friction, of 2 and of 3.
#[test]
fn w_alone_of_any_size_ends_within_its_iterations() {
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-8, max_iterations: 200 };
    for d in 1..=3 {
        for (contacts, seed) in
            [(1, 1), (1, 2), (2, 1), (2, 2), (3, 1), (17, 1), (17, 2), (90, 1), (300, 1), (300, 2)]
        {
            let problem = between_any(d, contacts, seed);
            let posed = Posed::W(Box::new(problem.clone()));
            let parts = contacts.min(3).to_string();
            for method in [
                method("nsgs", &[]),
                method("nsgs", &[("acceleration", "nesterov")]),
                method("nsgs-dd", &[("subdomains", &parts)]),
                method("cg", &[]),
                method("cg", &[("preconditioner", "diagonal")]),
                method("active-set", &[]),
            ] {
                let end = solved(&posed, &method, &stop).unwrap();
                let name = format!("{} on {contacts} contacts of {d}, seed {seed}", method.name);
                assert!(end.iterations <= stop.max_iterations, "{name}: {}", end.iterations);
                let map = problem.natural_map(&end.impulses);
                match end.status {
                    Status::Converged => assert!(map <= stop.tolerance, "{name}: {map:e}"),
                    Status::IterationLimit => assert_eq!(end.iterations, stop.max_iterations, "{name}"),
                    Status::Stalled | Status::Diverged => {}
                    other => panic!("{name}: {other:?}"),
                }
            }
        }
    }
}

#[test]
fn methods_that_need_grains_are_refused_on_w_alone() {
    let problem = LocalProblem::new(1, [(0, 0, 1.0)], vec![-1.0], vec![0.0]).unwrap();
    let problem = Posed::W(Box::new(problem));
    let refused = |method: &Method| format!("{:#}", solved(&problem, method, &Stop::default()).unwrap_err());
    assert!(refused(&method("latin-dd", &[])).contains("method `latin-dd` needs grains"));
    assert!(
        refused(&method("nsgs", &[("order", "coloured")]))
            .contains("`order` = \"coloured\" has no meaning where there is W alone")
    );
    let two = method("nsgs-dd", &[("subdomains", "2")]);
    assert!(refused(&two).contains("`subdomains` is 2: it must be 1 to 1, the number of contacts"));
}

/// The problem of a text file of Siconos.
fn problem_of(text: &str) -> anyhow::Result<LocalProblem> {
    dat::problem(text, &mut Vec::new())
}

const DENSE: &str =
    "2 2 0 4 4 4 4\n 2 0.5 0.125 0\n 0.5 3 0 0\n 0.25 0 4 0\n 0 0 0 5\n -1 0.5 -2 0.25\n 0.3 0.4\n";

#[test]
fn three_ways_to_write_w_give_one_problem() {
    let dense = problem_of(DENSE).unwrap();
    let blocks = "2 2 1 4 4 4 2 2\n 2 4\n 2 4\n 3 4\n 0 2 4\n 0 1 0 1\n 0 2 0.5 0.5 3\n 1 0.25 0 0 0\n 2 0.125 0 0 0\n 3 4 0 0 5\n \
                  -1 0.5 -2 0.25\n 0.3 0.4\n 0";
    assert_eq!(problem_of(blocks).unwrap(), dense);
    let printed = "2 2 2 4 4 2\nCSparse Version 3.1.9, May 4, 2016.  Copyright (c) Timothy A. Davis, 2006-2016\n4-by-4, nzmax: 8 nnz: 8, \
                   1-norm: 5\n col 0 : locations 0 to 2\n 0 : 2\n 1 : 0.5\n 2 : 0.125\n col 1 : locations 3 to 4\n 0 : 0.5\n 1 : 3\n \
                   col 2 : locations 5 to 6\n 0 : 0.25\n 2 : 4\n col 3 : locations 7 to 7\n 3 : 5\n -1 0.5 -2 0.25\n 0.3 0.4";
    assert_eq!(problem_of(printed).unwrap(), dense);
    // Triplets have no norm.
    let triplets = "2 2 2 4 4 1\nCSparse Version 3.1.9, May 4, 2016.  Copyright (c) Timothy A. Davis, 2006-2016\n\
                    triplet: 4-by-4, nzmax: 9 nnz: 8\n 0 0 : 2\n 1 0 : 0.5\n 2 0 : 0.125\n 0 1 : 0.5\n 1 1 : 3\n 0 2 : 0.25\n \
                    2 2 : 4\n 3 3 : 5\n -1 0.5 -2 0.25\n 0.3 0.4";
    assert_eq!(problem_of(triplets).unwrap(), dense);
}

#[test]
fn local_problem_comes_back_from_fclib_compressed_or_not() {
    let problem = problem_of(DENSE).unwrap();
    let folder = TempDir::new().unwrap();
    let there = file(&folder, "w.hdf5", write_local("w", &problem).unwrap());
    let Held::Local(back) = read(&there).unwrap() else { panic!("W alone") };
    assert_eq!(back, problem);
    // Compressed.
    let group = |nz: i32, p: &[i32], i: &[i32]| {
        let mut file = hdf5_pure::FileBuilder::new();
        let mut local = file.create_group("fclib_local");
        let mut w = local.create_group("W");
        for (name, value) in [("m", 4), ("n", 4), ("nz", nz), ("nzmax", 9)] {
            w.create_dataset(name).with_i32_data(&[value]);
        }
        w.create_dataset("p").with_i32_data(p);
        w.create_dataset("i").with_i32_data(i);
        w.create_dataset("x").with_f64_data(&[2.0, 0.5, 0.125, 0.5, 3.0, 0.25, 4.0, 5.0]);
        local.add_group(w.finish());
        local.create_dataset("spacedim").with_i32_data(&[2]);
        let mut vectors = local.create_group("vectors");
        vectors.create_dataset("q").with_f64_data(&[-1.0, 0.5, -2.0, 0.25]);
        vectors.create_dataset("mu").with_f64_data(&[0.3, 0.4]);
        local.add_group(vectors.finish());
        file.add_group(local.finish());
        self::file(&folder, "rows.hdf5", file.finish().unwrap())
    };
    let i = [0, 1, 2, 0, 1, 0, 2, 3];
    for nz in [-1, -2] {
        let Held::Local(back) = read(&group(nz, &[0, 3, 5, 7, 8], &i)).unwrap() else { panic!("W alone") };
        // The same lists are W by columns, and its transpose by rows.
        let turned =
            |(row, column, value)| if nz == -1 { (row, column, value) } else { (column, row, value) };
        let entries = problem.entries().map(turned);
        let (q, friction) = (problem.q().to_vec(), problem.friction().to_vec());
        assert_eq!(back, LocalProblem::new(2, entries, q, friction).unwrap());
    }
    let refused = |path: PathBuf| format!("{:#}", read(&path).err().unwrap());
    assert!(refused(group(-3, &[0], &i)).contains("`fclib_local/W/nz` is -3"));
    assert!(refused(group(-2, &[0, 3], &i)).contains("`fclib_local/W`: `p` is shorter"));
    assert!(refused(group(-2, &[0, 3, 5, 7, 8], &[0, 1, 7, 0, 1, 0, 2, 3])).contains("row 0, column 7"));
}

/// W and q of a mass matrix that is not diagonal, by hand: M = [2 1; 1 2], H = [1; 0], f = [3; 0], w = −4: M⁻¹ = [2 −1; −1 2]/3.
#[test]
fn mass_matrix_may_couple() {
    let triplets = |rows, columns, entries: &[(usize, usize, f64)]| Triplets {
        rows,
        columns,
        entries: entries.to_vec(),
    };
    let global = || Global {
        mass: triplets(4, 4, &[(0, 0, 2.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 2.0), (2, 2, 1.0), (3, 3, 1.0)]),
        h: triplets(4, 2, &[(0, 0, 1.0), (2, 1, 1.0)]),
        f: vec![3.0, 0.0, 0.0, 0.0],
        w: vec![-4.0, 0.0],
        friction: vec![0.5],
    };
    let read = local(global(), 2).unwrap();
    let expected =
        LocalProblem::new(2, [(0, 0, 2.0 / 3.0), (1, 1, 1.0)], vec![-2.0, 0.0], vec![0.5]).unwrap();
    assert!(read.entries().zip(expected.entries()).all(|(a, b)| (a.2 - b.2).abs() < 1e-15));
    assert!(read.q().iter().zip(expected.q()).all(|(a, b)| (a - b).abs() < 1e-15));
    let refused = |global: Global| format!("{:#}", local(global, 2).unwrap_err());
    assert!(refused(Global { w: vec![0.0; 4], ..global() }).contains("`H` has 4 x 2 entries"));
    assert!(refused(Global { f: vec![0.0; 2], ..global() }).contains("`M` has 4 x 4 entries"));
    let singular = triplets(4, 4, &[(0, 1, 1.0), (1, 0, 1.0), (2, 2, 1.0)]);
    assert!(refused(Global { mass: singular, ..global() }).contains("`M` is singular"));
}

#[test]
fn file_that_is_no_problem_is_refused_with_what_is_wrong() {
    let folder = TempDir::new().unwrap();
    let refused = |name: &str, bytes: &[u8]| {
        let path = file(&folder, name, bytes);
        let why = format!("{:#}", read(&path).err().expect("no problem"));
        assert!(why.starts_with(&path.display().to_string()), "{why}");
        why
    };
    assert!(refused("a.hdf5", b"no HDF5").contains("no HDF5 file"));
    let mut whole = write_local("w", &problem_of(DENSE).unwrap()).unwrap();
    whole.truncate(whole.len() / 2);
    refused("torn.hdf5", &whole);
    let mut other = hdf5_pure::FileBuilder::new();
    other.create_dataset("x").with_f64_data(&[1.0]);
    assert!(
        refused("other.hdf5", &other.finish().unwrap()).contains("neither `fclib_local` nor `fclib_global`")
    );
    let none = Triplets { rows: 0, columns: 0, entries: Vec::new() };
    let more = Triplets { rows: 0, columns: 0, entries: Vec::new() };
    let empty = Global { mass: none, h: more, f: Vec::new(), w: Vec::new(), friction: Vec::new() };
    let bad = write_global(("empty", Some("no JSON")), 3, &empty).unwrap();
    assert!(refused("ours.hdf5", &bad).contains("gravel/problem: expected ident"));
    let dat = |text: &str| refused("a.dat", text.as_bytes());
    assert!(dat("3 1 0 3").contains("ends before the columns of W"));
    assert!(dat("5 1 0 5 5").contains("5 unknowns"));
    assert!(dat("3 1 0 9 9 9 9").contains("the file ends before W"));
    assert!(dat("3 1 7 3 3").contains("in the way 7"));
    assert!(dat(&DENSE.replace("0.125 0\n 0.5", "x 0\n 0.5")).contains("W: \"x\""));
    assert!(dat(&DENSE.replace(" -1 0.5", " nan 0.5")).contains("`vectors/q[0]`"));
    assert!(dat(&format!("{DENSE}{}", "1 ".repeat(10))).contains("10 words follow mu"));
}

/// A list after μ, a size and one matrix, five unknowns of a contact: the files of other laws.
const ONE: &str = "2 1 0 2 2 2 2\n2 0 0 3\n-1 0\n0.3\n";

#[test]
fn text_file_of_another_problem_is_named_as_what_it_seems_to_be() {
    let why = |text: &str| format!("{:#}", problem_of(text).unwrap_err());
    assert!(why(&format!("{DENSE} 0.25 0.25")).contains("rolling friction or of Mohr and Coulomb's law"));
    assert!(why("2 1 0 2 2 2 2\n2 0 0 3\n-1 0\n0.3\n0.25").contains("\"0.25\" first, one for each contact"));
    assert!(why("4 0 4 4 4 4 1 0 0 0").contains("a linear complementarity problem of 4 unknowns"));
    assert!(why("2 0 2 2 2 2 1 0 0 1 -1 -1").contains("a linear complementarity problem of 2 unknowns"));
    // As Siconos wrote them: their size, M and q, decimals or not.
    for old in [
        "2\n1.0 0\n0 1.0\n-1 -1\n",
        "3 1 0 0 0 1 0 0 0 1 -1 -1 -1",
        "3\n2.0 1 0\n1 2 0\n0 0 1\n-1 -1 -1\n0 0 0\n",
    ] {
        assert!(why(old).contains("a linear complementarity problem of"), "{old}: {}", why(old));
    }
    assert!(why("2 1 0 2 2 2 2").contains("the file ends before W"));
    assert!(why("3 1.0 0").contains("the number of contacts: \"1.0\""));
    assert!(why("5 2 0 10 10").contains("rolling friction"));
    assert!(why("2 1 0 3 3 3 3 1 0 0 0 1 0 0 0 1 0 0").contains("the M of a global problem"));
    assert!(why("2 1 1 0 2 2 2 2\n2 0 0 3\n-1 0\n0.3\n0.25").contains("Siconos' plasticity"));
    // Guesses may follow μ, or that there are none, or that there are some and none.
    for (whole, size) in [(DENSE, 8), (ONE, 4)] {
        for guesses in [format!("1 {}", "0 ".repeat(size)), "0".to_owned(), "1".to_owned()] {
            let guessed = problem_of(&format!("{whole} {guesses}")).unwrap();
            assert_eq!(guessed, problem_of(whole).unwrap(), "{guesses}");
        }
    }
    // A decimal is a parameter of the contact, whatever its value.
    for parameter in ["1.0", "0e0", "2"] {
        assert!(why(&format!("{ONE} {parameter}")).contains("one for each contact"), "{parameter}");
    }
}

/// M = [2 1 0; 1 2 0; 0 0 1], H = [1 0; 0 0; 0 1], f = [3 0 0], w = [−4 0].
#[test]
fn global_text_file_is_the_problem_of_its_matrices() {
    let rest = "0 3 2 3 2 1 0 0 0 0 1\n3 0 0\n-4 0\n0.5\n";
    let mut notes = Vec::new();
    let whole = dat::problem(&format!("2 1 0 3 3 3 3 2 1 0 1 2 0 0 0 1\n{rest}"), &mut notes).unwrap();
    assert!(notes.is_empty());
    let expected =
        LocalProblem::new(2, [(0, 0, 2.0 / 3.0), (1, 1, 1.0)], vec![-2.0, 0.0], vec![0.5]).unwrap();
    assert!(whole.entries().zip(expected.entries()).all(|(a, b)| (a.2 - b.2).abs() < 1e-15));
    assert_eq!(whole.q(), expected.q());
    let half = dat::problem(&format!("2 1 0 3 3 3 3 2 0 0 1 2 0 0 0 1\n{rest}"), &mut notes).unwrap();
    assert_eq!((half, notes.len()), (whole, 1));
    assert!(notes[0].contains("`M` holds its upper triangle only"), "{notes:?}");
}

#[test]
fn triangle_of_m_is_mirrored_and_that_of_w_refused() {
    let entries = [(0, 0, 2.0), (0, 1, 0.5), (1, 1, 3.0), (1, 3, -0.25), (2, 2, 1.0), (3, 3, 4.0)];
    let turned = entries.map(|(row, column, x)| (column, row, x));
    let off = |list: &[(usize, usize, f64)]| -> Vec<_> {
        list.iter().filter(|(row, column, _)| row != column).copied().collect()
    };
    let folder = TempDir::new().unwrap();
    let global = |mass: Vec<(usize, usize, f64)>| {
        let mass = Triplets { rows: 4, columns: 4, entries: mass };
        let h = vec![(0, 0, 1.0), (1, 1, 1.0), (2, 1, -1.0), (3, 0, 0.5)];
        let h = Triplets { rows: 4, columns: 2, entries: h };
        let of = Global { mass, h, f: vec![1.0, -2.0, 0.5, 3.0], w: vec![-4.0, 0.5], friction: vec![0.3] };
        let there = file(&folder, "m.hdf5", write_global(("m", None), 2, &of).unwrap());
        let Held::Local(problem) = read(&there).unwrap() else { panic!("W alone") };
        problem
    };
    let whole = global([&entries[..], &off(&turned)].concat());
    assert_eq!(global(entries.to_vec()), whole);
    assert_eq!(global(turned.to_vec()), whole);
    let refused = |text: &str| {
        let path = file(&folder, "w.dat", text);
        format!("{:#}", read(&path).err().expect("no problem"))
    };
    let half = DENSE.replace("0.5 0.125 0", "0 0 0");
    assert!(refused(&half).contains("`W` holds its upper triangle only"), "{}", refused(&half));
    let mut notes = vec![];
    let asymmetric = dat::problem(DENSE, &mut notes).unwrap();
    // ‖W − Wᵗ‖² = 2 · 0.125², ‖W‖² = 54.5 + 0.25² + 0.125²
    let note = super::symmetry::check(&asymmetric).unwrap().unwrap();
    assert!(note.contains("‖W − Wᵗ‖ is 2.4e-2 of ‖W‖") && note.contains("check what wrote it"), "{note}");
    // Single precision and eight digits are no asymmetry; what spin leaves is said as such.
    let said =
        |entry: &str| super::symmetry::check(&problem_of(&DENSE.replace("0.125", entry)).unwrap()).unwrap();
    assert_eq!([said("0.25"), said("0.250001"), said("0.24999999")], [None, None, None]);
    let note = said("0.2495").unwrap();
    assert!(note.contains("is 9.6e-5 of ‖W‖") && note.contains("gyroscopic terms"), "{note}");
}

/// The arrays of a file of ours are changed, as through h5py.
fn edited(name: &str, edit: impl FnOnce(&mut Global)) -> Result<AnyFrozen, String> {
    let text = std::fs::read_to_string(frozen(name)).unwrap();
    let (mut global, d) = (problem(name).arrays(), problem(name).facts().dimensions);
    edit(&mut global);
    let folder = TempDir::new().unwrap();
    let there = file(&folder, "edited.hdf5", write_global((name, Some(&text)), d, &global).unwrap());
    match read(&there).map_err(|error| format!("{error:#}"))? {
        Held::Ours(now) => {
            assert!(now != text);
            Ok(AnyFrozen::of_text(&there, &now).unwrap())
        }
        Held::Local(_) => panic!("{name}: its grains are there"),
    }
}

#[test]
fn edited_arrays_are_the_problem_and_the_text_is_the_rest() {
    let edit = |global: &mut Global| {
        global.friction[3] = 0.75;
        global.w[7] += 0.125;
        global.f[4] = -2.0 * global.f[4] + 0.5;
        // The second grain weighs twice as much.
        global.mass.entries.iter_mut().filter(|(row, ..)| *row / 3 == 1).for_each(|(.., x)| *x *= 2.0);
    };
    let now = edited("rough-250", edit).unwrap();
    let before = AnyFrozen::read(&frozen("rough-250")).unwrap();
    assert!(
        now.source().ends_with("M, vectors/f, vectors/mu, vectors/w as edited in an FCLIB file."),
        "{}",
        now.source()
    );
    assert_eq!(now.name(), before.name());
    let [now, before] = [now, before].map(lineup::problem);
    let mut expected = before.arrays();
    edit(&mut expected);
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-14 * b.abs();
    let global = now.arrays();
    for (now, expected) in
        [(&global.f, &expected.f), (&global.w, &expected.w), (&global.friction, &expected.friction)]
    {
        assert!(now.iter().zip(expected).all(|(a, b)| near(*a, *b)));
    }
    assert!(global.mass.entries.iter().zip(&expected.mass.entries).all(|(a, b)| near(a.2, b.2)));
    assert_eq!(now.radii(), before.radii());
    let gaps = |of: &dyn OneProblem| of.touching().iter().map(|contact| contact.gap).collect::<Vec<_>>();
    assert_eq!(gaps(&*now), gaps(&*before));
    // Without friction an offset is one number.
    let now = edited("spheres-250", |global| global.w[6] += 0.5).unwrap();
    let before = AnyFrozen::read(&frozen("spheres-250")).unwrap();
    let [now, before] = [now, before].map(|frozen| frozen.of::<Spheres>().expect("spheres"));
    assert_eq!(now.problem.contacts()[2].offset, before.problem.contacts()[2].offset + 0.5);
}

#[test]
fn edit_that_contradicts_the_text_is_refused() {
    let refused = |name: &str, edit: &dyn Fn(&mut Global)| edited(name, edit).unwrap_err();
    let h = refused("rough-250", &|global| global.h.entries[0].2 += 0.25);
    assert!(h.contains("`fclib_global/H[0, 1]` is ") && h.contains("without the group `gravel`"), "{h}");
    let mu = refused("settled-60", &|global| global.friction[5] = 0.3);
    assert!(mu.contains("`fclib_global/vectors/mu[5]` is 0.3, and `gravel/problem` makes 0.0 of it"), "{mu}");
    let w = refused("settled-60", &|global| global.w[5] = 0.3);
    assert!(w.contains("`fclib_global/vectors/w[5]` is 0.3"), "{w}");
    let mass = refused("rough-250", &|global| global.mass.entries[1].2 *= 2.0);
    assert!(mass.contains("`fclib_global/M[1, 1]`"), "{mass}");
    let length = refused("rough-250", &|global| global.friction.truncate(9));
    assert!(length.contains("`fclib_global/vectors/mu` is of size"), "{length}");
    let negative = refused("rough-250", &|global| global.friction[0] = -1.0);
    assert!(negative.contains("`contacts.friction[0]` is -1"), "{negative}");
    let nan = refused("rough-250", &|global| global.f[2] = f64::NAN);
    assert!(nan.contains("`fclib_global/vectors/f[2]` is NaN"), "{nan}");
}

/// As h5py writes with `compression="gzip"`, `shuffle` and `fletcher32`.
#[test]
fn compressed_datasets_are_read_under_every_ending() {
    let problem = problem_of(DENSE).unwrap();
    let mut fclib = hdf5_pure::FileBuilder::new();
    let mut local = fclib.create_group("fclib_local");
    let mut w = local.create_group("W");
    let entries: Vec<_> = problem.entries().collect();
    for (name, value) in [("m", 4), ("n", 4), ("nz", 16), ("nzmax", 16)] {
        w.create_dataset(name).with_i32_data(&[value]);
    }
    let index = |of: fn(&(usize, usize, f64)) -> usize| {
        entries.iter().map(|e| i64::try_from(of(e)).unwrap()).collect::<Vec<_>>()
    };
    w.create_dataset("i").with_i64_data(&index(|e| e.0)).with_chunks(&[5]).with_deflate(4);
    w.create_dataset("p").with_i64_data(&index(|e| e.1)).with_chunks(&[16]).with_shuffle().with_deflate(9);
    let x: Vec<f64> = entries.iter().map(|e| e.2).collect();
    w.create_dataset("x")
        .with_f64_data(&x)
        .with_chunks(&[8])
        .with_shuffle()
        .with_deflate(1)
        .with_fletcher32();
    local.add_group(w.finish());
    local.create_dataset("spacedim").with_i32_data(&[2]);
    let mut vectors = local.create_group("vectors");
    vectors.create_dataset("q").with_f64_data(problem.q()).with_chunks(&[4]).with_deflate(4);
    vectors.create_dataset("mu").with_f64_data(problem.friction());
    local.add_group(vectors.finish());
    fclib.add_group(local.finish());
    let (folder, bytes) = (TempDir::new().unwrap(), fclib.finish().unwrap());
    for name in ["a.hdf5", "a.h5", "a.HDF5", "a.H5"] {
        let Held::Local(back) = read(&file(&folder, name, &bytes)).unwrap() else { panic!("W alone") };
        assert_eq!(back, problem, "{name}");
    }
    let Held::Local(back) = read(&file(&folder, "a.DAT", DENSE)).unwrap() else { panic!("W alone") };
    assert_eq!(back, problem);
    let archive = file(&folder, "a.npz", b"PK");
    assert!(format!("{:#}", read(&archive).err().unwrap()).contains("an archive of NumPy"));
}
