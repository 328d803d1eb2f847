//! Limits of memory, and durations that time steps divide.

use crate::problems::case::fits;
use crate::problems::scene::whole;
use cases::Case;
use std::path::Path;

#[test]
fn scene_that_needs_more_than_is_free_is_refused_by_the_key_that_asks() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases");
    let refused = |case: &str, overrides: &[(&str, &str)], words: &[&str]| {
        let overrides: Vec<(String, String)> =
            overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let case = Case::read(&folder.join(format!("{case}.toml")), &overrides).unwrap();
        assert_eq!(fits(&case, None), Ok(()), "nothing is known of the machine");
        let why = fits(&case, Some(1_000_000_000)).unwrap_err();
        assert!(words.iter().all(|word| why.contains(word)), "{why}");
    };
    // 4,294,967,295 grains of 700 B.
    let grains = ["`sample.grains` is 4294967295: ", "about 3006.5 GB", "1.0 GB are free"];
    refused("column", &[("sample.grains", "4294967295")], &grains);
    let all = [("sample.columns", "4294967295"), ("sample.rows", "4294967295")];
    refused("triangular", &all, &["`sample.columns times sample.rows` is 18446744062972133378"]);
    refused("column", &[("scene.contact_copies", "4294967295")], &["`scene.contact_copies` is 4294967295: "]);
    let case = Case::read(&folder.join("column.toml"), &[]).unwrap();
    assert_eq!(fits(&case, Some(1_000_000)), Ok(()));
}

#[test]
fn decimal_fractions_divide_in_spite_of_their_rounding() {
    assert_eq!(whole(0.3 / 0.1), Some(3));
    assert_eq!(whole(2.0 / 0.000_25), Some(8000));
    for odd in [0.5, 2.5, 1.0001, f64::NAN, f64::INFINITY, -3.0, 0.0] {
        assert_eq!(whole(odd), None, "{odd}");
    }
}
