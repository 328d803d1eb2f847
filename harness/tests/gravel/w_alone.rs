//! Problems of W alone in the shapes of other codes' dumps: one contact to 300, in 2D and 3D, blocks of any kind.

use crate::common::{gravel, text, write};
use std::fmt::Write;
use tempfile::TempDir;

/// Motion of contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// Blocks couple nothing, and tangents are at rest: the first step of a start solves the problem exactly.
    Exact,
    /// Blocks couple all, and each contact its neighbours.
    Coupled,
    /// That motion without friction.
    Frictionless,
    /// Tangents move ten times as fast as normals, with little friction.
    Sliding,
    /// All contacts open.
    Open,
    /// Each contact twice, so that W is singular.
    Twice,
}

const SHAPES: [Shape; 6] =
    [Shape::Exact, Shape::Coupled, Shape::Frictionless, Shape::Sliding, Shape::Open, Shape::Twice];

/// Numbers from −1 to 1 without pattern, the same each time.
fn number(k: usize) -> f64 {
    let k = k as u64;
    ((k * k * 2_654_435_761 + 40_503 * k) % 20_011) as f64 / 10_005.0 - 1.0
}

/// W in blocks as Siconos writes it, q and μ: W = A Aᵗ with two columns of blocks in each row of A, so that contacts couple with their
/// neighbours.
fn dat(shape: Shape, d: usize, contacts: usize) -> String {
    let distinct = if shape == Shape::Twice { contacts.div_ceil(2) } else { contacts };
    let a = |contact: usize, row: usize, k: usize| {
        let own = if row == k % d { 1.0 } else { 0.3 * number(7 * contact + 3 * row + 11 * k) };
        match (shape, k < d) {
            (Shape::Exact, own_block) => f64::from(u8::from(own_block && row == k)),
            (_, true) => own,
            (_, false) => 0.5 * number(5 * contact + 13 * row + k),
        }
    };
    // The columns of A that a contact has: its own block, and that of the next one.
    let entry = |(one, row): (usize, usize), (two, column): (usize, usize)| -> f64 {
        let place = |contact: usize, k: usize| d * contact + k;
        let columns = (0..2 * d).flat_map(|k| (0..2 * d).map(move |l| (k, l)));
        columns
            .filter(|(k, l)| place(one, *k) == place(two, *l))
            .map(|(k, l)| a(one, row, k) * a(two, column, l))
            .sum()
    };
    let is = |contact: usize| contact % distinct;
    let blocks: Vec<(usize, usize)> = (0..contacts)
        .flat_map(|one| (0..contacts).map(move |two| (one, two)))
        .filter(|(one, two)| one == two || shape != Shape::Exact && is(*one).abs_diff(is(*two)) <= 1)
        .collect();
    let list = |numbers: &mut dyn Iterator<Item = usize>| {
        numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(" ")
    };
    let (size, count) = (d * contacts, blocks.len());
    let ends = list(&mut (1..=contacts).map(|contact| d * contact));
    let starts = list(&mut (0..=contacts).map(|row| blocks.partition_point(|(one, _)| *one < row)));
    let columns = list(&mut blocks.iter().map(|(_, two)| *two));
    let mut text = format!(
        "{d} {contacts} 1 {size} {size}\n{count} {contacts} {contacts}\n{ends}\n{ends}\n{} {count}\n{starts}\n{columns}\n",
        contacts + 1
    );
    for (number, (one, two)) in blocks.iter().enumerate() {
        write!(text, "{number}").unwrap();
        for (column, row) in (0..d).flat_map(|column| (0..d).map(move |row| (column, row))) {
            write!(text, " {:e}", entry((is(*one), row), (is(*two), column))).unwrap();
        }
        text.push('\n');
    }
    for k in 0..size {
        let (contact, along) = (is(k / d), k % d);
        let q = match shape {
            Shape::Exact => [-1.0, 0.0][along.min(1)],
            Shape::Open => [1.0, 0.3][along.min(1)],
            Shape::Sliding => [-1.0, 10.0][along.min(1)],
            _ => [-0.5, 0.0][along.min(1)] + 0.5 * number(3 * contact + 17 * along),
        };
        write!(text, "{q:e} ").unwrap();
    }
    let friction = match shape {
        Shape::Frictionless => 0.0,
        Shape::Sliding => 0.05,
        _ => 0.4,
    };
    text + &format!("\n{friction} ").repeat(contacts)
}

/// The file is solved or reaches the limit of its iterations; with the distance to a solution where one is found.
#[track_caller]
fn ends(file: &str, method: &[&str]) {
    const MOST: &str = "300";
    let asked = ["solve", file, "--json", "--truth", "--tolerance", "1e-8", "--max-iterations", MOST];
    let object = gravel(&[&asked[..], method].concat()).json();
    let status = object["status"].as_str().unwrap();
    assert!(["converged", "iteration-limit", "stalled", "diverged"].contains(&status), "{file}: {object}");
    assert!(object["iterations"].as_u64().unwrap() <= 300, "{file}: {object}");
    if status == "converged" {
        assert!(object["natural_map"].as_f64().unwrap() <= 1e-8, "{file}: {object}");
    }
}

#[test]
fn every_shape_ends_with_every_method() {
    let folder = TempDir::new().unwrap();
    for (d, contacts) in [(2, 1), (3, 1), (2, 2), (3, 5), (2, 44), (3, 300)] {
        for shape in SHAPES {
            let name = format!("{shape:?}-{d}-{contacts}");
            let there = write(&folder, &format!("{name}.dat"), &dat(shape, d, contacts));
            let subdomains = format!("subdomains={}", contacts.min(3));
            ends(text(&there), &["--method", "nsgs"]);
            ends(text(&there), &["--method", "nsgs-dd", "--set", &subdomains]);
            ends(text(&there), &["--method", "cg"]);
            ends(text(&there), &["--method", "active-set"]);
            let fclib = folder.path().join(format!("{name}.hdf5"));
            gravel(&["convert", text(&there), text(&fclib)]).succeeded();
            ends(text(&fclib), &["--method", "active-set"]);
        }
    }
}

#[test]
fn exact_start_is_a_solution_at_once() {
    let folder = TempDir::new().unwrap();
    let hangs = write(&folder, "hangs.dat", "2 1 0 2 2 2 2 2 0 0 3 -1 0 0.3\n");
    let solve = ["solve", text(&hangs), "--method", "active-set", "--truth", "--json"];
    let object = gravel(&solve).succeeded().json();
    assert_eq!((&object["status"], &object["natural_map"]), (&"converged".into(), &0.0.into()));
    assert_eq!(object["velocity_error"], 0.0);
}
