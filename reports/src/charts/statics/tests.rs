use results::settings::CASE;
use results::simulation::{Role, Simulated};
use serde_json::{Value, json};

use super::*;
use crate::tests::fixture::files;
use crate::tests::fixture_in_time::{read, simulated};

/// A simulation of a case with these settings, of which a grain has moved by so much after its time.
fn moved(case: &str, settings: &[(&str, Value)], by: impl Fn(f64) -> f64) -> Simulated {
    let mut one = simulated(Role::Run, 0.1, 1e-6);
    one.simulation.scene_settings.insert(CASE.to_owned(), case.into());
    for (key, value) in settings {
        one.simulation.scene_settings.insert((*key).to_owned(), value.clone());
    }
    for row in &mut one.series {
        row.greatest_displacement_m = by(row.time_s);
    }
    one
}

fn error(one: Simulated) -> Option<(bool, f64)> {
    Judged::of(&read(&[one])[0]).map(|judged| (judged.stands, judged.error.unwrap()))
}

#[test]
fn a_block_stands_above_the_tangent_of_its_slope_and_slides_below() {
    let slope = ("scene.slope_rad", json!(0.4));
    let block = |friction: f64, by: &dyn Fn(f64) -> f64| {
        error(moved("block-on-slope", &[slope.clone(), ("scene.friction", json!(friction))], by)).unwrap()
    };
    let least = 0.4_f64.tan();
    let (stands, creep) = block(least * (1.0 + 1e-12), &|time| 3e-6 * time);
    assert!(stands && (creep - 3.0).abs() < 1e-9, "{creep}");
    let gravity = read(&[moved("", &[], |_| 0.0)])[0].gravity_m_per_s2;
    let down = gravity * (0.4_f64.sin() - 0.3 * 0.4_f64.cos());
    let (stands, off) = block(0.3, &|time| 0.5 * down * time * time);
    assert!(!stands && off < 1e-6, "{off}");
    let (stands, off) = block(0.3, &|_| 0.0);
    assert!(!stands && off > 1e5, "it stands where it should slide: {off}");
}

#[test]
fn a_heap_stands_where_both_of_its_frictions_suffice() {
    let heap = |case: &str, friction: f64, floor: f64| {
        let settings = [("scene.friction", json!(friction)), ("scene.box.friction", json!(floor))];
        error(moved(case, &settings, |_| 0.0)).is_some_and(|(stands, _)| stands)
    };
    let fifteen = 15.0_f64.to_radians().tan();
    assert!(heap("stack-of-three", fifteen * (1.0 + 1e-12), fifteen / 3.0 * (1.0 + 1e-12)));
    assert!(
        !heap("stack-of-three", fifteen * (1.0 - 1e-12), 1.0)
            && !heap("stack-of-three", 1.0, fifteen / 3.0 * (1.0 - 1e-12))
    );
    assert!(heap("stack-of-four", 0.317_838, 0.079_46) && !heap("stack-of-four", 0.317_836, 0.079_46));
}

#[test]
fn the_worst_of_a_group_is_told_and_what_came_to_no_end_is_a_dash() {
    let pinched = |creep: f64| moved("pinched", &[("scene.friction", json!(0.26))], move |time| creep * time);
    let mut failed = pinched(0.0);
    failed.simulation.status = SimulationEnding::Exploded;
    let csv = |all: &[Simulated]| {
        let all = read(all);
        files(&parts(&all)).iter().find(|(name, _)| name == "statics.csv").unwrap().1.clone()
    };
    let table = csv(&[pinched(1e-6), pinched(2e-6)]);
    assert!(table.lines().nth(1).is_some_and(|row| row.contains("stands") && row.contains("2.0")), "{table}");
    let table = csv(&[pinched(1e-6), failed]);
    assert!(table.lines().nth(1).is_some_and(|row| row.ends_with(",,")), "{table}");
    let mut late = pinched(1e-6);
    late.simulation.totals.missed_time_steps = 1;
    let table = csv(&[pinched(0.0), late]);
    assert!(table.lines().nth(1).is_some_and(|row| row.ends_with(",10⁻⁶")), "{table}");
    assert!(files(&parts(&[])).iter().all(|(name, _)| !name.contains("svg")));
}
