use super::*;
use crate::error::StoreError;
use crate::store::{Store, read, records_of};
use crate::study::Study;
use crate::tests::run;
use tempfile::TempDir;

fn simulated(number: u32) -> Simulated {
    let row = run(number);
    let simulation = Simulation {
        id: row.id,
        plan: "time".into(),
        scene: "column".into(),
        scene_settings: Map::new(),
        scene_hash: row.problem_hash,
        role: Role::Run,
        grains: 20,
        mass_kg: 1.0,
        mean_diameter_m: 0.1,
        gravity_m_per_s2: 9.81,
        time_step_s: 0.005,
        duration_s: 1.0,
        method: row.method,
        settings: row.settings,
        variant: String::new(),
        warm_start: true,
        start: "previous".into(),
        stop_on: row.stop_on,
        tolerance: row.tolerance,
        max_iterations: row.max_iterations,
        status: SimulationEnding::Exploded,
        reason: "exploded in time step 7".into(),
        last_state: "last-states/7.json".into(),
        totals: Totals {
            time_steps: 6,
            missed_time_steps: 2,
            diverged_time_steps: 1,
            infeasible_time_steps: 1,
            restarted_time_steps: 1,
            iterations: 60,
            setup_s: 0.1,
            iterating_s: 0.2,
            work: Work { contact_updates: 1, interface_values: 5, ..Work::default() },
            energy: Energy { shocks: -1.0 / 3.0, ..Energy::default() },
        },
        timing: row.timing,
        provenance: row.provenance,
    };
    let observed = Observed {
        time_step: 6,
        time_s: 0.1 + 0.2,
        contacts: 20,
        iterations: 60,
        kinetic_energy_j: f64::INFINITY,
        mean_height_m: 1.0,
        greatest_overlap_m: f64::NAN,
        mean_overlap_m: 5e-324,
        greatest_speed_m_per_s: 1.0,
        greatest_displacement_m: 0.1,
        floor_impulse_n_s: 1.0,
        left_impulse_n_s: 2.0,
        right_impulse_n_s: 3.0,
        energy: Energy { walls: 0.1 + 0.2, sliding: f64::NAN, ..Energy::default() },
        stress: Stress { xy: -1.0 / 3.0, coordination: 3.2, ..Stress::default() },
        bulk: Bulk::default(),
        shape: Shape::default(),
    };
    Simulated { simulation, series: vec![observed] }
}

/// NaN is what it is, here.
fn same(a: &[Simulated], b: &[Simulated]) -> bool {
    format!("{a:?}") == format!("{b:?}")
}

#[test]
fn simulations_read_equal_those_appended_to_the_last_bit() {
    let root = TempDir::new().unwrap();
    let all = [simulated(1), simulated(2)];
    let mut store: Store<Simulated> = Store::open(root.path(), "time").unwrap();
    for one in &all {
        store.append(one.clone()).unwrap();
    }
    assert!(same(&records_of(store.folder(), &["nsgs"]).unwrap().records, &all));
    drop(store);
    // A store of runs does not take them for its own.
    let error = Store::<crate::journal::Record>::open(root.path(), "time").unwrap_err();
    assert!(matches!(error, StoreError::Line { line: 1, .. }), "{error}");
}

#[test]
fn journals_from_before_failed_time_steps_were_counted_are_read() {
    let root = TempDir::new().unwrap();
    let mut line = serde_json::to_value(simulated(1)).unwrap();
    for key in ["diverged_time_steps", "infeasible_time_steps", "restarted_time_steps"] {
        line["simulation"].as_object_mut().unwrap().remove(key).unwrap();
    }
    std::fs::write(root.path().join("journal.jsonl"), format!("{line}\n")).unwrap();
    let read: Vec<Simulated> = records_of(root.path(), &["nsgs", "cg"]).unwrap().records;
    assert_eq!(
        (read[0].simulation.totals.missed_time_steps, read[0].simulation.totals.diverged_time_steps),
        (2, 0)
    );
}

#[test]
fn simulation_of_no_known_scene_or_origin_is_not_stored() {
    let root = TempDir::new().unwrap();
    let mut store: Store<Simulated> = Store::open(root.path(), "time").unwrap();
    let mut no_scene = simulated(1);
    no_scene.simulation.scene_hash.clear();
    let mut no_commit = simulated(1);
    no_commit.simulation.provenance.commit.clear();
    for odd in [no_scene, no_commit] {
        assert!(matches!(store.append(odd), Err(StoreError::Entry(RowError::Untraced(_)))));
    }
    assert!(store.records().is_empty());
}

#[test]
fn tables_number_the_simulations_and_are_kept_aside_whole() {
    let root = TempDir::new().unwrap();
    let mut store: Store<Simulated> = Store::open(root.path(), "time").unwrap();
    let written = Study::Simulations(vec![simulated(1), simulated(2)]);
    store.write_tables(&written).unwrap();
    let series = std::fs::read_to_string(store.folder().join("series.csv")).unwrap();
    let second = series.lines().nth(2).unwrap();
    assert!(second.starts_with("1,6,0.30000000000000004,20,60,inf,1.0,,"), "{series}");
    assert_eq!(format!("{:?}", read(store.folder()).unwrap().0), format!("{written:?}"));
    drop(store);
    let aside = Store::set_aside(root.path(), "time").unwrap().unwrap();
    for file in ["simulations.parquet", "series.parquet", "simulations.csv", "series.csv", "journal.jsonl"] {
        assert!(aside.join(file).is_file() && !root.path().join("time").join(file).exists(), "{file}");
    }
}

#[test]
fn the_mean_stress_of_time_steps_does_not_depend_on_how_it_is_gathered() {
    let each = [1.0, 2.0, 6.0].map(|xy| Stress { xy, yy: -4.0 * xy, ..Stress::default() });
    let mean = each[0].and_then(1, each[1]).and_then(2, each[2]);
    assert_eq!((mean.xy, mean.yy), (3.0, -12.0));
    assert_eq!(mean.ratio(), None, "nothing presses");
    assert_eq!(Stress { yy: 12.0, ..mean }.ratio(), Some(0.25));
}
