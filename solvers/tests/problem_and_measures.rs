//! The measures' definitions, the operator, and what a problem is refused for.

#![allow(clippy::unwrap_used)]

use analysis::Meter;
use contact::{Contact, ContactProblem, Discs, Packing, ProblemError, Truth, greatest};
use nalgebra::Vector2;

/// A grain of 2 kg falling at 1 m/s onto a floor: W = ½, b = −1, so r = 2 N·s.
fn falling_on_a_floor() -> ContactProblem {
    let contact = Contact { candidate: 0, antagonist: None, normal: Vector2::y(), offset: 0.0 };
    ContactProblem::new(vec![2.0], vec![Vector2::new(0.0, -1.0)], vec![contact]).unwrap()
}

#[test]
fn measures_of_one_contact_are_as_by_hand() {
    let problem = falling_on_a_floor();
    let mut meter = Meter::new(&problem);
    // r = 1: v = −1 + ½ = −½, r⁺ = 1 + ½ / ½ = 2, so the natural map is √(½ · 1² / (1² / ½)) = ½.
    let first = meter.measure(&[1.0], 0.25);
    assert!(first.zeta.is_nan());
    assert_eq!((first.natural_map, first.penetration_rate, first.worst_contact), (0.5, 0.5, Some(0)));
    assert_eq!(first.velocity_jump, 0.25);
    // DV = ½ (2 − 1), WR = ½ and 1: √(¼ / ½ (¼ + 1)).
    assert!((first.quad_dv - 0.4_f64.sqrt()).abs() < 1e-15);
    assert!((first.max_dv - 0.4_f64.sqrt()).abs() < 1e-15);
    // q = ½ · ½ · 1 − 1
    assert_eq!(first.energy, -0.75);
    let second = meter.measure(&[2.0], 0.0);
    // ζ = |2 − 1| / √(2 · 1)
    assert!((second.zeta - 0.5_f64.sqrt()).abs() < 1e-15);
    assert_eq!((second.natural_map, second.penetration_rate, second.worst_contact), (0.0, 0.0, None));
    assert_eq!(second.energy, -1.0, "the least that q can be");
}

#[test]
fn errors_beside_the_truth_are_as_by_hand() {
    let problem = falling_on_a_floor();
    let truth = Truth::new(&problem, &[2.0]);
    assert_eq!((truth.velocity(), truth.energy()), (&[Vector2::zeros()][..], -1.0));
    let mut meter = Meter::new(&problem).against(&truth);
    // r = 1: V = −½ of the −1 it was at first; q = −¾ of −1. The gap is the error squared, as v* = 0.
    let half = meter.measure(&[1.0], 0.0);
    assert_eq!((half.velocity_error, half.energy_gap), (0.5, 0.25));
    let solved = meter.measure(&[2.0], 0.0);
    assert_eq!((solved.velocity_error, solved.energy_gap), (0.0, 0.0));
    let unknown = Meter::new(&problem).measure(&[1.0], 0.0);
    assert!(unknown.velocity_error.is_nan() && unknown.energy_gap.is_nan());
}

#[test]
fn where_nothing_is_pushed_any_impulse_is_an_endless_error() {
    let contact = Contact { candidate: 0, antagonist: None, normal: Vector2::y(), offset: 2.0 };
    let problem = ContactProblem::<Discs>::new(vec![1.0], vec![Vector2::zeros()], vec![contact]).unwrap();
    let truth = Truth::new(&problem, &[0.0]);
    let mut meter = Meter::new(&problem).against(&truth);
    assert_eq!(meter.measure(&[0.0], 0.0).velocity_error, 0.0);
    assert_eq!(meter.measure(&[1.0], 0.0).velocity_error, f64::INFINITY);
}

/// Two equal contacts that push twice as hard as they should: v = 1 m/s at both, r⁺ = 0.
#[test]
fn no_norm_but_the_penetration_rate_is_blind_to_impulses_that_are_too_large() {
    let contact = Contact { candidate: 0, antagonist: None, normal: Vector2::y(), offset: 0.0 };
    let falling = vec![Vector2::new(0.0, -1.0)];
    let problem = ContactProblem::<Discs>::new(vec![1.0], falling, vec![contact; 2]).unwrap();
    let measures = Meter::new(&problem).measure(&[1.0, 1.0], 0.0);
    // DV = −1 and WR = 1, WR⁺ = 0 at both: √(2 / ½ · 2) and 1 / √(½ · 2 / 2).
    assert!((measures.quad_dv - 2.0_f64.sqrt()).abs() < 1e-15);
    assert!((measures.max_dv - 2.0_f64.sqrt()).abs() < 1e-15);
    assert_eq!((measures.natural_map, measures.penetration_rate), (1.0, 0.0));
}

#[test]
fn zeta_is_undefined_from_rest() {
    let problem = falling_on_a_floor();
    let mut meter = Meter::new(&problem);
    assert!(meter.measure(&[0.0], 0.0).zeta.is_nan());
    assert!(meter.measure(&[1.0], 0.0).zeta.is_nan());
    assert_eq!(meter.measure(&[1.0], 0.0).zeta, 0.0);
}

#[test]
fn natural_map_is_the_same_in_any_units() {
    let contact = |offset| Contact { candidate: 0, antagonist: Some(1), normal: Vector2::x(), offset };
    let problem = |mass: f64, speed: f64| {
        let velocity = vec![Vector2::new(-speed, 0.0), Vector2::new(speed, speed)];
        let contacts = vec![contact(0.0), contact(0.5 * speed)];
        ContactProblem::<Discs>::new(vec![mass, 3.0 * mass], velocity, contacts).unwrap()
    };
    let (kilograms, tonnes) = (problem(1.0, 1.0), problem(1e-3, 1e3));
    let one = Meter::new(&kilograms).measure(&[0.7, 0.1], 0.0);
    let other = Meter::new(&tonnes).measure(&[0.7, 0.1], 0.0);
    assert!((one.natural_map / other.natural_map - 1.0).abs() < 1e-14);
}

#[test]
fn delassus_operator_is_symmetric_and_has_its_diagonal() {
    let grains = 4;
    let contacts: Vec<Contact> = (0..6_u32)
        .map(|k| Contact {
            candidate: k % 4,
            antagonist: (k % 3 != 0).then_some((k + 1) % 4),
            normal: Vector2::new(f64::from(k).cos(), f64::from(k).sin()),
            offset: 0.0,
        })
        .collect();
    let mass = (1..=grains).map(f64::from).collect();
    let at_rest = vec![Vector2::<f64>::zeros(); grains as usize];
    let problem = ContactProblem::<Discs>::new(mass, at_rest.clone(), contacts).unwrap();
    let column = |k: usize| {
        let (mut unit, mut column, mut scratch) = (vec![0.0; 6], vec![0.0; 6], at_rest.clone());
        unit[k] = 1.0;
        problem.delassus_product(&unit, &mut column, &mut scratch);
        column
    };
    let w: Vec<Vec<f64>> = (0..6).map(column).collect();
    for i in 0..6 {
        assert!((w[i][i] - problem.delassus_diagonal()[i]).abs() < 1e-15);
        for j in 0..6 {
            assert!((w[i][j] - w[j][i]).abs() < 1e-15);
        }
    }
}

/// The data of a problem of two grains and one contact, which makes sense until it is changed.
struct Data {
    mass: Vec<f64>,
    position: Vec<Vector2<f64>>,
    velocity: Vec<Vector2<f64>>,
    contact: Contact,
}

fn with(change: impl Fn(&mut Data)) -> Result<Packing, ProblemError> {
    let contact = Contact { candidate: 0, antagonist: Some(1), normal: Vector2::x(), offset: 0.0 };
    let at_rest = vec![Vector2::zeros(); 2];
    let mut data = Data { mass: vec![1.0, 2.0], position: at_rest.clone(), velocity: at_rest, contact };
    change(&mut data);
    Packing::new(data.mass, data.position, data.velocity, vec![data.contact])
}

#[test]
fn senseless_problems_are_refused_by_name() {
    assert!(with(|_| {}).is_ok());
    let refused = |change: &dyn Fn(&mut Data)| with(change).unwrap_err().to_string();
    for mass in [-1.0, 0.0, 1e-320, f64::NAN, f64::INFINITY] {
        assert!(refused(&|data| data.mass[1] = mass).contains("grains.mass[1]"));
    }
    assert!(refused(&|data| data.position[1].y = f64::NAN).contains("grains.position[1]"));
    assert!(refused(&|data| data.velocity[0].x = f64::INFINITY).contains("grains.free_velocity[0]"));
    assert!(refused(&|data| data.position.truncate(1)).contains("`grains.position` has 1 values where 2"));
    assert!(refused(&|data| data.contact.candidate = 2).contains("contacts.candidate[0]"));
    assert!(refused(&|data| data.contact.antagonist = Some(9)).contains("contacts.antagonist[0]` is 9"));
    assert!(refused(&|data| data.contact.antagonist = Some(0)).contains("another grain"));
    assert!(refused(&|data| data.contact.normal *= 2.0).contains("of length 2"));
    assert!(refused(&|data| data.contact.normal = Vector2::zeros()).contains("contacts.normal[0]"));
    assert!(refused(&|data| data.contact.normal.x = f64::NAN).contains("contacts.normal[0]"));
    assert!(refused(&|data| data.contact.offset = f64::NAN).contains("contacts.offset[0]"));
    assert!(matches!(with(|data| data.mass[0] = -1.0), Err(ProblemError::Value { index: 0, .. })));
}

#[test]
fn value_that_is_undefined_is_the_greatest() {
    let greatest = |values: [f64; 3]| greatest(values.into_iter());
    assert_eq!(greatest([1.0, 3.0, 2.0]), 3.0);
    assert_eq!(greatest([-1.0, -3.0, -2.0]), 0.0);
    assert!(greatest([1.0, f64::NAN, 2.0]).is_nan());
    assert!(greatest([f64::NAN, f64::INFINITY, 2.0]).is_nan());
}
