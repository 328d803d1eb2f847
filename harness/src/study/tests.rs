//! Inputs of the id of a run.

use crate::plan::{Method, Variant};
use crate::study::problems::run_id;
use lineup::METHODS;
use runner::Stop;

fn nsgs(settings: &[(&str, &str)]) -> Variant {
    let settings: Vec<(String, String)> =
        settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    variant(Method::parse("nsgs", &settings).unwrap())
}

fn variant(method: Method) -> Variant {
    Variant { method, warm_start: false, name: String::new(), problems: Vec::new() }
}

#[test]
fn defaults_spelled_out_do_not_change_the_id_and_every_part_does() {
    let stop = Stop::default();
    let id = |settings: &[(&str, &str)]| run_id("c0ffee", &nsgs(settings), &stop);
    let defaults = id(&[]);
    assert_eq!(defaults, id(&[("relaxation", "1.0")]));
    let changed = Method { own_code: Some("changed"), ..nsgs(&[]).method };
    let others = [
        id(&[("relaxation", "1.5")]),
        run_id("decaf", &nsgs(&[]), &stop),
        run_id("c0ffee", &Variant { warm_start: true, ..nsgs(&[]) }, &stop),
        run_id("c0ffee", &nsgs(&[]), &Stop { tolerance: 1e-7, ..stop }),
        run_id("c0ffee", &nsgs(&[]), &Stop { max_iterations: 7, ..stop }),
        run_id("c0ffee", &variant(changed), &stop),
        run_id("c0ffee", &variant(Method::parse("jacobi", &[]).unwrap()), &stop),
    ];
    assert!(others.iter().all(|other| *other != defaults), "{others:?}");
}

#[test]
fn every_method_has_the_version_of_its_own_crate() {
    let code = |name: &str| Method::parse(name, &[]).unwrap().code().to_owned();
    for method in METHODS {
        assert_eq!(code(method.name).len(), 16);
    }
    assert_ne!(code("nsgs"), code("jacobi"));
    assert_ne!(code("nsgs"), code("nsgs-dd"));
}
