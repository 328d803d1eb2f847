//! Small tables for the tests.

use crate::draw::Formats;
use crate::read::{Problems, Study};
use crate::text::Part;
use contact::Measure;
use contact::{Measures, Work};
use results::journal::Record;
use results::name::StopOn;
use results::schema::Ending;
use results::schema::{ContactRow, End, GrainRow, Provenance, Run, Sample, Timing};
use results::study::{Runs, Study as Stored};
use serde_json::{Map, Value};

pub(crate) fn sample(iteration: u64, zeta: f64, natural_map: f64) -> Sample {
    let measures = Measures {
        zeta,
        natural_map,
        penetration_rate: natural_map,
        quad_dv: natural_map,
        max_dv: natural_map,
        velocity_error: natural_map,
        energy_gap: natural_map * natural_map,
        velocity_jump: 0.0,
        energy: -1.0,
        ..Measures::default()
    };
    let work = Work { contact_updates: 40 * iteration, delassus_products: 2 * iteration, ..Work::default() };
    Sample { iteration, iterating_s: 1e-4 * iteration as f64, measures, work }
}

/// An object of JSON.
pub(crate) fn object(value: &Value) -> Map<String, Value> {
    value.as_object().unwrap().clone()
}

/// A run on `column`, stopped by the natural map at 10⁻⁴.
pub(crate) fn run(run: u32, method: &str, variant: &str, status: Ending) -> Run {
    let Sample { measures, work, .. } = sample(100, 1e-3, 1e-4);
    Run {
        id: format!("{run:016x}"),
        plan: "paper".into(),
        problem: "column".into(),
        problem_hash: "c0ffee".into(),
        grains: 20,
        contacts: 20,
        method: method.into(),
        variant: variant.into(),
        subdomains: 1,
        stop_on: StopOn(Measure::NaturalMap),
        tolerance: 1e-4,
        max_iterations: 1000,
        status,
        iterations: 100,
        setup_s: 1e-5,
        iterating_s: 0.0123,
        last_change_moves: f64::NAN,
        iterations_to_zeta_1e_3: Some(31),
        iterations_to_natural_map_1e_2: Some(47),
        iterations_to_natural_map_1e_4: Some(100),
        iterations_to_velocity_error_1e_2: Some(50),
        timing: Timing {
            repeats: 1,
            timed_alone: true,
            wall_s: 0.02,
            load_average: 0.5,
            ..Timing::default()
        },
        end: End { measures, work },
        provenance: Provenance {
            commit: "0123abc".into(),
            processor: "a processor".into(),
            processors: 8,
            threads: 1,
            rustc: "1.95.0".into(),
            profile: "release".into(),
            started_utc: "2026-01-02T03:04:05Z".into(),
            other_code: String::new(),
        },
        ..Run::default()
    }
}

/// Falls from 1 to 10⁻⁴ over 100 iterations.
pub(crate) fn decay() -> Vec<Sample> {
    let value = |i: u64| 10f64.powf(-4.0 * i as f64 / 100.0);
    (0..=100).map(|i| sample(i, if i == 0 { f64::NAN } else { value(i) }, value(i))).collect()
}

/// Grows beyond every number, and then is none.
pub(crate) fn explosion() -> Vec<Sample> {
    let values = (0..40).map(|i| 10f64.powi(i * i)).chain([f64::INFINITY, f64::NAN]);
    (1..).zip(values).map(|(i, value)| sample(i, value, value)).collect()
}

/// Runs, each with the curve that has its number.
pub(crate) fn tables(runs: &[Run], curves: &[(u32, Vec<Sample>)]) -> Runs {
    let curve = |number: u32| curves.iter().find(|(of, _)| *of == number).map(|(_, curve)| curve.clone());
    let record = |(number, run): (u32, &Run)| Record {
        run: run.clone(),
        curve: curve(number).unwrap_or_default(),
        snapshots: Vec::new(),
    };
    Runs { records: (0..).zip(runs).map(record).collect(), ..Runs::default() }
}

/// As the charts read them.
pub(crate) fn read(study: &Runs) -> Problems {
    study.into()
}

pub(crate) fn study(runs: &[Run], curves: &[(u32, Vec<Sample>)]) -> Problems {
    read(&tables(runs, curves))
}

/// As a report reads them.
pub(crate) fn whole(study: &Runs) -> Study {
    Study::Problems(read(study))
}

/// As they are stored.
pub(crate) fn stored(study: &Runs) -> Stored {
    Stored::Runs(study.clone())
}

/// Returns the end of a run: the measures and the work of its last sample.
pub(crate) fn end(Sample { measures, work, .. }: Sample) -> End {
    End { measures, work }
}

/// Name and text.
pub(crate) type File = (String, String);

/// All files that parts become.
pub(crate) fn files(parts: &[Part]) -> Vec<File> {
    let files = parts.iter().flat_map(|part| part.files(Formats::default()).unwrap());
    files.map(|file| (file.name, String::from_utf8(file.content).unwrap())).collect()
}

/// Removes the velocity errors.
pub(crate) fn without_truth(mut study: Runs) -> Runs {
    for sample in study.records.iter_mut().flat_map(|record| &mut record.curve) {
        sample.measures.velocity_error = f64::NAN;
    }
    study
}

/// Two touching discs on a wall, each with contacts in a subdomain of its own, and a disc above without contact.
pub(crate) fn scene(impulse: f64) -> (Vec<GrainRow>, Vec<ContactRow>) {
    let grain = |grain, x_m, y_m, subdomain, multiplicity| GrainRow {
        problem: "pair".into(),
        partition: "2x1".into(),
        grain,
        x_m,
        z_m: 0.0,
        y_m,
        radius_m: 0.1,
        subdomain,
        multiplicity,
    };
    let contact = |contact, (x0_m, y0_m), (x1_m, y1_m), wall, subdomain| ContactRow {
        problem: "pair".into(),
        partition: "2x1".into(),
        contact,
        x0_m,
        z0_m: 0.0,
        z1_m: 0.0,
        y0_m,
        x1_m,
        y1_m,
        wall,
        subdomain,
        impulse_n_s: impulse,
    };
    let grains =
        vec![grain(0, 0.0, 0.1, Some(0), 1), grain(1, 0.2, 0.1, Some(1), 2), grain(2, 0.1, 0.5, None, 0)];
    let contacts = vec![
        contact(0, (0.0, 0.1), (0.0, 0.0), true, 0),
        contact(1, (0.0, 0.1), (0.2, 0.1), false, 0),
        contact(2, (0.2, 0.1), (0.2, 0.0), true, 1),
    ];
    (grains, contacts)
}
