//! Files of other codes: what another code makes of ours, and what we make of theirs.

use crate::common::{gravel, write};
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// The contacts of a file without friction, as a complementarity problem.
const SCRIPT: &str = r#"
import sys, json, h5py, numpy, scipy.sparse as sparse, siconos.numerics as numerics
file = h5py.File(sys.argv[1])["fclib_global"]
def matrix(name):
    of = lambda part: file[name][part][()]
    count = of("nz")[0]
    return sparse.csc_matrix((of("x")[:count], (of("i")[:count], of("p")[:count])), (of("m")[0], of("n")[0]))
m, h = matrix("M"), matrix("H")
of = lambda name: file["vectors"][name][()]
d, inverse = file["spacedim"][0], sparse.diags(1 / m.diagonal())
assert not of("mu").any()
w, q = (h.T @ inverse @ h).toarray()[::d, ::d], (h.T @ (inverse @ of("f")) + of("w"))[::d]
r, v = numpy.zeros(len(q)), numpy.zeros(len(q))
options = numerics.SolverOptions(numerics.SICONOS_LCP_LEMKE)
assert numerics.linearComplementarity_driver(numerics.LCP(w, q), r, v, options) == 0
json.dump({"impulse": r.tolist()}, open(sys.argv[2], "w"))
"#;

/// Debian's Python, for which its packages of Siconos and of HDF5 are.
const PYTHON: &str = "/usr/bin/python3";

fn python(args: &[&str]) -> bool {
    Command::new(PYTHON).args(args).output().is_ok_and(|output| output.status.success())
}

#[test]
fn siconos_solves_a_file_that_was_written_and_the_answer_is_certified() {
    if !python(&["-c", "import h5py, siconos.numerics, scipy"]) {
        eprintln!("skipped: {PYTHON} has no h5py, siconos.numerics or scipy");
        return;
    }
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    write(&folder, "lemke.py", SCRIPT);
    for problem in ["settled-60", "spheres-250"] {
        gravel(&["convert", problem, &path("p.hdf5")]).succeeded();
        assert!(python(&[&path("lemke.py"), &path("p.hdf5"), &path("r.json")]), "{problem}");
        gravel(&["certify", problem, "--impulses", &path("r.json")]).succeeded();
    }
}

#[test]
fn w_alone_is_solved_by_methods_that_need_no_grains() {
    let folder = TempDir::new().unwrap();
    write(&folder, "one.dat", "2 1 0 2 2 2 2\n 2 0.5\n 0.5 3\n -1 0.5\n 0.3\n");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let one = path("one.dat");
    let solve = |args: &[&str]| gravel(&[&["solve", &one, "--json"], args].concat());
    let object = solve(&["--method", "nsgs"]).succeeded().json();
    assert_eq!((&object["status"], &object["iterations"]), (&"converged".into(), &1.into()));
    assert!(object["natural_map"].as_f64().unwrap() < 1e-14);
    assert!(object["zeta"].is_null(), "none from r = 0");
    for method in ["cg", "active-set", "nsgs-dd"] {
        let object = solve(&["--method", method, "--tolerance", "1e-10", "--truth"]).succeeded().json();
        assert!(object["natural_map"].as_f64().unwrap() < 1e-10, "{method}");
        assert!(object["velocity_error"].as_f64().unwrap() < 1e-9, "{method}");
    }
    solve(&["--method", "latin-dd"]).refused(&["one.dat", "method `latin-dd` needs grains"]);
    let refused =
        |args: &[&str], word| solve(&[&["--method", "nsgs"], args].concat()).refused(&["one.dat", word]);
    refused(&["--set", "symmetric=true"], "`symmetric` = true has no meaning where there is W alone");
    refused(&["--on", "quad_dv"], "`on` is quad_dv");
    refused(&["--start", "warm"], "has no impulses of a time step before");
    refused(&["--scene", "a=1"], "has no scene");
    gravel(&["convert", &one, &path("one.hdf5")]).succeeded();
    let again = gravel(&["solve", &path("one.hdf5"), "--json", "--method", "nsgs"]).succeeded().json();
    assert_eq!(again["natural_map"], object["natural_map"]);
    gravel(&["convert", &one, &path("one.json")]).refused(&["W but no grains"]);
    gravel(&["convert", "settled-60", &path("one.txt")]).refused(&["one.txt", ".hdf5 (FCLIB) or .json"]);
    gravel(&["convert", &path("none.hdf5"), &path("one.json")]).refused(&["none.hdf5", "no such file"]);
    assert!(!Path::new(&path("one.json")).exists());
    gravel(&["convert", "column", &path("c.hdf5"), "--scene", "sample.grains=7"]).succeeded();
    let column = gravel(&["solve", &path("c.hdf5"), "--json"]).succeeded().json();
    assert_eq!((&column["problem"], &column["grains"]), (&"column-t1".into(), &7.into()));
}

/// The sweeps that dumps of another code take.
#[test]
fn dumps_of_another_code_are_solved() {
    let solve = |file: &str| {
        let file = format!("{}/../cases/foreign/{file}", env!("CARGO_MANIFEST_DIR"));
        let args = ["--method", "nsgs", "--tolerance", "1e-4", "--json"];
        gravel(&[&["solve", &file][..], &args].concat()).succeeded().json()
    };
    let check = |file, contacts: u32, sweeps: u32| {
        let solved = solve(file);
        let found = ["contacts", "unknowns", "iterations"].map(|key| solved[key].as_u64());
        assert_eq!(found, [contacts, 3, sweeps].map(|count| Some(count.into())), "{file}");
    };
    check("Box_Stacks-i0122-82-5.hdf5", 82, 13);
    check("Capsules-i125-1213.hdf5", 286, 372);
}
