//! Studies through time: simulations, their store, what explodes and what is refused.

use crate::bench::{Study, rows};
use crate::common::{command, entries, gravel, text, write};
use std::collections::BTreeMap;
use std::fs;

/// The column through 20 time steps under two stop rules, with NSGS and CG, at two time steps.
const PLAN: &str = r#"
name = "time"
why = "A test."
warm_start = true

[stop]
on = "natural_map"
tolerance = 1e-3
max_iterations = 10_000

[simulate]
duration_s = 0.04
sample_every_s = 0.01
axes = { tolerance = [1e-1, 1e-6] }

[simulate.reference]
method = "cg"
tolerance = 1e-10

[[cases]]
case = "column"
axes = { "sample.grains" = [3, 6], "scene.time_step_s" = [0.01, 0.005] }

[[methods]]
method = "nsgs"

[[methods]]
method = "cg"
"#;

fn study(plan: &str) -> Study {
    let study = Study::new();
    write(study.folder(), "harness/plans/time.toml", plan);
    study
}

/// The rows of a table, less what differs from one time to the next.
fn counted(study: &Study, table: &str) -> Vec<BTreeMap<String, String>> {
    let mut rows = rows(study.runs("time").join(table));
    let timing =
        ["setup_s", "iterating_s", "wall_s", "load_average", "started_utc", "threads", "timed_alone"];
    for row in &mut rows {
        row.retain(|column, _| !timing.contains(&column.as_str()));
    }
    assert!(!rows.is_empty());
    rows
}

fn lines(study: &Study) -> Vec<String> {
    let journal = fs::read_to_string(study.runs("time").join("journal.jsonl")).unwrap();
    journal.lines().map(str::to_owned).collect()
}

#[test]
fn every_scene_meets_every_method_under_every_rule_beside_a_reference() {
    let study = study(PLAN);
    let printed = study.gravel(&["bench", "time"]).succeeded().stdout;
    assert!(printed.contains("16 simulations, and 8 to compare them with; 24 of 24 to run"), "{printed}");
    let table = rows(study.runs("time").join("simulations.csv"));
    let roles = |role: &str| table.iter().filter(|row| row["role"] == role).count();
    assert_eq!(["reference", "twin", "floor", "run"].map(roles), [2, 2, 4, 16]);
    for row in &table {
        let h: f64 = row["time_step_s"].parse().unwrap();
        let steps: f64 = row["time_steps"].parse().unwrap();
        assert!((h * steps - 0.04).abs() < 1e-12, "{row:?}");
        assert_eq!(h == 0.00125, ["reference", "twin"].contains(&&*row["role"]), "{row:?}");
    }
    // Four rows of series each; the floor bears the weight: 0.01 s of n m g.
    let series = rows(study.runs("time").join("series.csv"));
    assert_eq!(series.len(), 4 * table.len());
    for row in series.iter().filter(|row| row["simulation"] == "0") {
        let weight = 3.0 * std::f64::consts::PI * 250.0 * 9.81;
        let impulse: f64 = row["floor_impulse_n_s"].parse().unwrap();
        assert!((impulse / (0.01 * weight) - 1.0).abs() < 1e-6, "{row:?}");
    }
    assert!(study.gravel(&["bench", "time"]).succeeded().stdout.contains("0 of 24 to run"));
    study.gravel(&["report", "time"]).succeeded();
    study.gravel(&["figure", "atlas-in-time", "time"]).succeeded();
    study.gravel(&["view", &table[0]["id"]]).refused(&[&table[0]["id"], "simulation", "gravel simulate"]);
    let shown = study.gravel(&["plan", "time", "--count"]).succeeded().stdout;
    assert!(shown.contains("       24       24  in all"), "{shown}");
}

/// The column is at rest and the floor bears its weight: the reference is exact, and what a tolerance leaves is error.
#[test]
fn tighter_tolerance_lowers_the_error_and_the_reference_has_none() {
    let study = study(PLAN);
    study.bench("time");
    let errors = rows(study.folder().path().join("reports/out/time/trajectory.csv"));
    let nsgs = |row: &&BTreeMap<String, String>| row["role"] == "run" && row["method"] == "nsgs";
    let error = |row: &BTreeMap<String, String>| row["wall_impulse"].parse::<f64>().unwrap();
    let runs: Vec<_> = errors.iter().filter(nsgs).collect();
    assert_eq!(runs.len(), 8);
    for pair in runs.chunks(2) {
        assert_eq!((&*pair[0]["tolerance"], &*pair[1]["tolerance"]), ("0.1", "1e-6"));
        assert!(error(pair[1]) < 1e-3 * error(pair[0]), "{pair:?}");
    }
    for row in errors.iter().filter(|row| row["role"] == "reference") {
        assert_eq!(error(row), 0.0);
        assert_eq!(row["mean_height_mean_diameters"].parse::<f64>().unwrap(), 0.0);
    }
}

#[test]
fn series_are_the_same_with_any_number_of_threads_and_jobs() {
    let (one, other) = (study(PLAN), study(PLAN));
    one.gravel(&["--threads", "1", "bench", "time"]).succeeded();
    other.gravel(&["--threads", "3", "bench", "time", "--jobs", "3"]).succeeded();
    for table in ["simulations.csv", "series.csv"] {
        assert_eq!(counted(&one, table), counted(&other, table));
    }
}

#[test]
fn stores_of_simulations_join_and_go_on() {
    let (here, there) = (study(PLAN), study(PLAN));
    here.bench("time");
    there.bench("time");
    let journal = here.runs("time").join("journal.jsonl");
    fs::write(&journal, lines(&here)[..9].join("\n") + "\n").unwrap();
    let printed = here.gravel(&["merge", "time", text(&there.runs("time"))]).succeeded().stdout;
    assert!(printed.contains("15 of 24 runs are new here"), "{printed}");
    assert_eq!(counted(&here, "series.csv"), counted(&there, "series.csv"));
    fs::write(&journal, lines(&here)[..5].join("\n") + "\n").unwrap();
    let printed = here.gravel(&["bench", "time"]).succeeded().stdout;
    assert!(printed.contains("19 of 24 to run"), "{printed}");
    for table in ["simulations.csv", "series.csv"] {
        assert_eq!(counted(&here, table), counted(&there, table));
    }
}

/// With few iterations of Jacobi at twice its limit a packing flies apart.
fn exploding() -> String {
    let jacobi = "[[methods]]\nmethod = \"jacobi\"\nset = { relaxation = 1.9 }\n";
    let (before, _) = PLAN.split_once("[[methods]]").unwrap();
    before
        .replace("[3, 6], \"scene.time_step_s\" = [0.01, 0.005]", "[40], \"scene.time_step_s\" = [0.01]")
        .replace("axes = { tolerance = [1e-1, 1e-6] }", "set = { tolerance = 0.0, max_iterations = 12 }")
        .replace("duration_s = 0.04", "duration_s = 0.4")
        + jacobi
}

#[test]
fn explosion_is_a_row_with_its_class_and_a_state_that_can_be_solved_again() {
    let study = study(&exploding().replace("[simulate.reference]", "[simulate.reference]\nrefine = 1"));
    study.gravel(&["bench", "time"]).succeeded();
    let table = rows(study.runs("time").join("simulations.csv"));
    let row = table.iter().find(|row| row["role"] == "run").unwrap();
    assert_eq!(row["status"], "exploded", "{row:?}");
    assert!(row["reason"].starts_with("exploded in time step "), "{row:?}");
    let made: u64 = row["time_steps"].parse().unwrap();
    assert!(row["reason"].contains(&format!("time step {}:", made + 1)), "{row:?}");
    let state = study.runs("time").join(&row["last_state"]);
    let solved =
        gravel(&["solve", text(&state), "--method", "cg", "--set", "preconditioner=diagonal", "--json"])
            .json();
    assert_eq!(solved["status"], "converged");
    study.gravel(&["figure", "atlas-in-time", "time"]).succeeded();
    let atlas = study.folder().path().join("reports/out/time-atlas-in-time/atlas-in-time.csv");
    let judged = rows(atlas);
    let jacobi = judged.iter().find(|row| row["method"] == "jacobi").unwrap();
    assert_eq!(jacobi["class"], "exploded");
    assert!(study.gravel(&["bench", "time"]).succeeded().stdout.contains("0 of"));
    study.gravel(&["bench", "time", "--fresh"]).succeeded();
    assert!(state.is_file(), "computed again");
}

#[test]
fn simulation_that_explodes_says_how_and_keeps_its_last_good_state() {
    let folder = tempfile::TempDir::new().unwrap();
    let file = folder.path().join("column.csv");
    let scene = ["--scene", "sample.grains=40", "--method", "jacobi", "--set", "relaxation=1.9"];
    let run = ["simulate", "column", "--time-steps", "50", "--max-iterations", "40", "--tolerance", "0"];
    let ran = command(&[&run[..], &scene, &["-o", text(&file)]].concat()).output().unwrap();
    let printed = String::from_utf8(ran.stderr).unwrap();
    assert_eq!(ran.status.code(), Some(3), "{printed}");
    assert!(printed.starts_with("error: column: exploded in time step "), "{printed}");
    let made = fs::read_to_string(&file).unwrap().lines().count() - 1;
    let state = folder.path().join(format!("column-t{}.json", made + 1));
    assert!(printed.contains(text(&state)), "{printed}");
    gravel(&["solve", text(&state)]).succeeded();
}

#[test]
fn plans_through_time_that_make_no_sense_are_refused() {
    let refused = |from: &str, to: &str, words: &[&str]| {
        assert!(PLAN.contains(from), "{from}");
        study(&PLAN.replacen(from, to, 1)).gravel(&["bench", "time"]).refused(words);
    };
    refused("sample_every_s = 0.01", "sample_every_s = 0.012", &["sample_every_s", "0.012", "0.01 s"]);
    refused("duration_s = 0.04", "duration_s = 0.045", &["duration_s", "0.045", "whole number"]);
    refused("duration_s = 0.04\n", "", &["column", "`duration_s`"]);
    refused("tolerance = [1e-1, 1e-6]", "tolerance = [-1.0]", &["simulate", "tolerance", "-1"]);
    let march = "case = \"column\"\nmarch = { method = \"cg\" }";
    refused("case = \"column\"", march, &["column", "`march`"]);
    refused("axes = { tolerance", "axes = { tolerence", &["simulate", "tolerence"]);
    refused("why =", "problems = [\"pair\"]\nwhy =", &["`problems`", "`cases` only"]);
    refused("why =", "charts = [\"size\"]\nwhy =", &["`charts`", "size", "simulations"]);
    refused("on = \"natural_map\"", "on = \"velocity_error\"", &["velocity_error", "not known"]);
    let top = |key: &str, words: &[&str]| refused("why =", &format!("{key}\nwhy ="), words);
    top("spectra = true", &["time.toml", "`spectra` is true"]);
    top("repeats = 3", &["time.toml", "`repeats` is 3"]);
    top("curves = \"ends\"", &["time.toml", "`curves` is \"ends\""]);
    top("reference = false", &["time.toml", "`reference` is false"]);
    let view = "[view]\nproblem = \"column\"\nruns = [\"cg\"]\n\n[stop]";
    refused("[stop]", view, &["time.toml", "`view` is of problem `column`"]);
    let own = "method = \"nsgs\"\nwarm_start = [false, true]";
    refused(
        "method = \"nsgs\"",
        own,
        &["time.toml", "`nsgs`", "`warm_start` is [false, true]", "[simulate]"],
    );
    study(PLAN).gravel(&["bench", "time", "--repeats", "3"]).refused(&["--repeats"]);
    study(PLAN).gravel(&["regress", "time"]).refused(&["time"]);
}

/// The points of a frame and its values by name.
fn frame(file: &std::path::Path) -> (Vec<f64>, BTreeMap<String, Vec<f64>>) {
    let vtkio::model::DataSet::UnstructuredGrid { pieces, .. } = vtkio::Vtk::import(file).unwrap().data
    else {
        panic!("no unstructured grid")
    };
    let piece = pieces.into_iter().next().unwrap().into_loaded_piece_data(None).unwrap();
    let values = |attribute: &vtkio::model::Attribute| match attribute {
        vtkio::model::Attribute::DataArray(array) => {
            (array.name.clone(), array.data.cast_into::<f64>().unwrap())
        }
        vtkio::model::Attribute::Field { .. } => panic!("a field"),
    };
    let all: BTreeMap<_, _> = piece.data.point.iter().chain(&piece.data.cell).map(values).collect();
    let cells = piece.cells.num_cells();
    for (name, values) in &all {
        assert_eq!(values.len() % cells, 0, "{name}: readers ask for as many values as there are cells");
        assert!(
            (1..=3).contains(&(values.len() / cells)),
            "{name}: {} values of {cells} cells",
            values.len()
        );
    }
    (piece.points.cast_into::<f64>().unwrap(), all)
}

#[test]
fn frames_have_grains_contacts_and_walls_apart_from_the_initial_state_on() {
    let folder = tempfile::TempDir::new().unwrap();
    let vtk = folder.path().join("frames");
    let args = ["simulate", "two-discs", "--time-steps", "6", "--every", "3", "--cold", "--vtk", text(&vtk)];
    let method = ["--method", "nsgs-dd", "--set", "subdomains=1x2", "--tolerance", "1e-9"];
    gravel(&[&args[..], &method].concat()).succeeded();
    let of = |part: &str, k: u32| format!("two-discs-{part}-{k:06}.vtu");
    // At the beginning nothing has touched yet, and there is no file without contacts.
    let mut expected = vec![of("contacts", 3), of("contacts", 6)];
    expected.extend([0, 3, 6].map(|k| of("grains", k)));
    expected.extend([0, 3, 6].map(|k| of("walls", k)));
    expected.push("two-discs.pvd".to_owned());
    assert_eq!(entries(&vtk), expected);
    let collection = fs::read_to_string(vtk.join("two-discs.pvd")).unwrap();
    for line in [
        "timestep=\"0\" part=\"0\" name=\"grains\" file=\"two-discs-grains-000000.vtu\"",
        "timestep=\"0.03\" part=\"1\" name=\"contacts\" file=\"two-discs-contacts-000006.vtu\"",
    ] {
        assert!(collection.contains(line), "{collection}");
    }
    let (places, grains) = frame(&vtk.join(of("grains", 3)));
    assert!((places[1] - 0.5).abs() < 1e-9, "{places:?}");
    assert_eq!((&*grains["radius_m"], &*grains["grain"]), (&[0.5, 1.0][..], &[0.0, 1.0][..]));
    let ratio = grains["mass_kg"][1] / grains["mass_kg"][0];
    assert!((ratio - 4.0).abs() < 1e-12, "a disc of twice the radius: {ratio}");
    assert!(grains["velocity_m_per_s"].iter().all(|v| v.abs() < 1e-6));
    // The lower disc has contacts in both subdomains.
    assert_eq!(grains["multiplicity"], [2.0, 1.0]);
    // Two contacts of the lower one, one of the upper; the upper subdomain has the upper disc and half of the lower.
    assert_eq!(grains["subdomain_coordination"].iter().copied().fold(0.0, f64::max), 2.0);
    assert!(grains["subdomain_pressure_n_per_m"].iter().all(|pressure| *pressure > 0.0));
    let (ends, contacts) = frame(&vtk.join(of("contacts", 3)));
    assert!((ends[1] - 0.5).abs() < 1e-9 && ends[4].abs() < 1e-9, "from the disc to the floor: {ends:?}");
    assert_eq!((&*contacts["candidate"], &*contacts["antagonist"]), (&[0.0, 0.0][..], &[-1.0, 1.0][..]));
    assert_eq!((&*contacts["wall"], &*contacts["subdomain"]), (&[1.0, 0.0][..], &[0.0, 1.0][..]));
    assert_eq!(contacts["normal"], [0.0, 1.0, 0.0, 0.0, -1.0, 0.0]);
    assert!(contacts["gap_m"].iter().all(|gap| gap.abs() < 1e-9));
    // The floor bears both discs, the upper contact one.
    let r = &contacts["impulse_n_s"];
    assert!((r[0] / 192.62 - 1.0).abs() < 1e-4 && (r[1] / 154.10 - 1.0).abs() < 1e-4, "{r:?}");
    let (ends, walls) = frame(&vtk.join(of("walls", 0)));
    assert_eq!((&*walls["wall"], ends[1], ends[4]), (&[0.0][..], 0.0, 0.0));
    gravel(&args).refused(&["--vtk", "frames", "empty"]);
}

/// The type of each array of a frame, by its name.
fn types(file: &std::path::Path) -> BTreeMap<String, String> {
    let text = fs::read_to_string(file).unwrap();
    let value = |array: &str, key: &str| {
        array.split_once(&format!(" {key}=\"")).map(|(_, rest)| rest.split('"').next().unwrap().to_owned())
    };
    let arrays = text.split("<DataArray").skip(1).map(|rest| rest.split('>').next().unwrap());
    arrays.filter_map(|array| Some((value(array, "Name")?, value(array, "type")?))).collect()
}

/// meshio reads no unsigned numbers of points, and an integer is one, not a number with a fraction.
#[test]
fn frames_have_signed_numbers_of_points_and_whole_statuses() {
    let folder = tempfile::TempDir::new().unwrap();
    let vtk = folder.path().join("frames");
    let few =
        ["--scene", "scene.friction=0.3", "--time-steps", "2", "--tolerance", "1e-2", "--vtk", text(&vtk)];
    gravel(&[&["simulate", "column"][..], &few].concat()).succeeded();
    let of = types(&vtk.join("column-contacts-000002.vtu"));
    for name in ["connectivity", "offsets", "status", "contact", "subdomain"] {
        assert_eq!(of[name], "Int64", "{name}");
    }
    assert_eq!(of["impulse_n_s"], "Float64");
    let (_, contacts) = frame(&vtk.join("column-contacts-000002.vtu"));
    assert!(contacts["status"].iter().all(|status| [0.0, 1.0, 2.0].contains(status)));
}

#[test]
fn frames_of_spheres_have_the_faces_of_their_box() {
    let folder = tempfile::TempDir::new().unwrap();
    let vtk = folder.path().join("frames");
    let few = ["--scene", "sample.grains=8", "--time-steps", "1", "--vtk", text(&vtk)];
    gravel(&[&["simulate", "sphere-box"][..], &few].concat()).succeeded();
    let (corners, walls) = frame(&vtk.join("sphere-box-walls-000000.vtu"));
    // The floor, left and right, back and front.
    assert_eq!((corners.len(), &*walls["wall"]), (5 * 4 * 3, &[0.0, 1.0, 2.0, 5.0, 6.0][..]));
}

#[test]
fn simulation_that_stopped_resumes_bitwise_from_its_state() {
    let folder = tempfile::TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    let scene = ["simulate", "rough-box", "--scene", "sample.grains=40", "--scene", "scene.box.width_m=1.0"];
    let run = |steps: &str, more: &[&str]| {
        let steps = ["--method", "nsgs", "--tolerance", "1e-3", "--time-steps", steps];
        gravel(&[&scene[..], &steps, more].concat()).succeeded()
    };
    run("30", &["-o", text(&at("whole.csv")), "--state", text(&at("whole.json"))]);
    run("13", &["-o", text(&at("first.csv")), "--state", text(&at("stop.json.gz"))]);
    let [stop, second, end] = ["stop.json.gz", "second.csv", "end.json"].map(at);
    run("17", &["--restart", text(&stop), "-o", text(&second), "--state", text(&end)]);
    let read = |name: &str| fs::read_to_string(at(name)).unwrap();
    assert_eq!(read("whole.json"), read("end.json"));
    let (_, second) = read("second.csv").split_once('\n').map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
    assert_eq!(read("whole.csv"), read("first.csv") + &second);
    let steps = ["--time-steps", "1", "--restart", text(&end)];
    gravel(&[&scene[..], &steps, &["--scene", "scene.friction=0.5"]].concat()).refused(&[
        "end.json",
        "`scene.friction` is 0.3",
        "it is 0.5",
    ]);
    gravel(&[&scene[..], &steps, &["--state", text(&end)]].concat()).refused(&["end.json exists"]);
    // With another friction its grains begin another scene.
    let grains = at("grains.csv");
    gravel(&["convert", text(&end), text(&grains)]).succeeded();
    let sample =
        format!("sample={{ kind = \"placed\", density_kg_per_m2 = 1.0, file = {:?} }}", text(&grains));
    let placed = ["--scene", &sample, "--scene", "scene.friction=0.5", "--time-steps", "1", "--json"];
    let object = gravel(&[&scene[..2], &placed].concat()).json();
    assert!(object["last_time_step"]["mean_height_m"].as_f64().unwrap() > 0.0, "{object}");
    gravel(&["convert", text(&at("first.csv")), text(&grains)]).refused(&["first.csv"]);
}

#[test]
fn table_of_contacts_adds_up_to_the_weight_and_has_both_formats() {
    let folder = tempfile::TempDir::new().unwrap();
    let (csv, parquet) = (folder.path().join("c.csv"), folder.path().join("c.parquet"));
    let run = ["simulate", "column", "--scene", "scene.friction=0.3", "--time-steps", "4", "--every", "2"];
    for file in [&csv, &parquet] {
        gravel(&[&run[..], &["--tolerance", "1e-10", "--contacts", text(file)]].concat()).succeeded();
    }
    let contacts = rows(csv);
    let number = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<f64>().unwrap();
    let steps: Vec<f64> = contacts.iter().map(|row| number(row, "time_step")).collect();
    assert_eq!((steps[0], steps[steps.len() - 1]), (2.0, 4.0));
    let floor: Vec<_> = contacts.iter().filter(|row| row["body"] == "floor").collect();
    assert_eq!(floor.len(), 2);
    let above: Vec<_> =
        contacts.iter().filter(|row| row["body"] == "grain" && row["time_step"] == "4").collect();
    let weight = number(floor[1], "impulse_y_n_s") / (above.len() + 1) as f64;
    for row in above {
        let carried = f64::from(number(row, "candidate").min(number(row, "antagonist")) as u32 + 1);
        let expected =
            weight * ((floor.len() as f64 / 2.0) * number(floor[1], "impulse_y_n_s") / weight - carried);
        assert!((number(row, "normal_impulse_n_s") / expected - 1.0).abs() < 1e-6, "{row:?}");
        assert_eq!((&*row["status"], &*row["segment"]), ("sticks", ""));
        // The candidate of two grains is the lower one: the other presses it down.
        assert!((number(row, "impulse_y_n_s") + expected).abs() < 1e-6 * expected, "{row:?}");
    }
    assert_eq!((number(floor[1], "y_m"), &*floor[1]["antagonist"]), (0.0, ""));
    assert!(fs::read(parquet).unwrap().ends_with(b"PAR1"), "it has been ended");
    let text_file = folder.path().join("c.txt");
    let wrong = gravel(&[&run[..], &["--contacts", text(&text_file)]].concat());
    wrong.refused(&["--contacts", "c.txt", ".csv", ".parquet"]);
    assert!(!text_file.exists());
}

#[test]
fn simulation_ends_where_its_condition_is_met_and_says_where_it_was_not() {
    let until = |more: &[&str]| {
        let run = ["simulate", "two-discs", "--tolerance", "1e-9", "--until", "at-rest"];
        gravel(&[&run[..], more].concat())
    };
    let printed = until(&["--time-steps", "2000"]).succeeded().stdout;
    assert!(printed.contains("\nat rest: no grain faster than "), "{printed}");
    let printed = until(&["--time-steps", "2"]).ended(3).stdout;
    assert!(printed.contains("\nnot at rest: "), "{printed}");
    until(&["--time-steps", "2", "--over", "-1"]).refused(&["--over -1", "positive"]);
    until(&["--time-steps", "2", "--scene", "scene.gravity_m_per_s2=0"]).refused(&["gravity_m_per_s2"]);
    gravel(&["simulate", "two-discs", "--time-steps", "2", "--every", "2"]).refused(&["--every 2", "--vtk"]);
}
