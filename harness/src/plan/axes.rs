//! Axes of a plan: listed values and ranges, and their combinations.

use anyhow::{Result, bail};
use serde_json::{Map, Value};

/// Settings by key, or axes by key.
pub(crate) type Settings = Map<String, Value>;

/// A plan with more runs than this was not meant.
pub(super) const MOST: usize = 100_000;

const ACCEPTED: &str = "a list, or a range such as \"1..5\", \"lin(0.1, 1, 10)\" or \"geom(0.1, 1000, 13)\"";

/// The settings `set`, with every combination of the values of `axes`; the values of `zip` are taken together, the first
/// of each, then the second of each.
///
/// # Errors
/// Names the key and the value.
pub(crate) fn combinations(set: &Settings, zip: &Settings, axes: &Settings) -> Result<Vec<Settings>> {
    if let Some(key) = zip.keys().chain(axes.keys()).find(|key| set.contains_key(*key)) {
        bail!("`{key}` is set and an axis");
    }
    if let Some(key) = zip.keys().find(|key| axes.contains_key(*key)) {
        bail!("`{key}` is an axis twice, in `zip` and in `axes`");
    }
    let mut combinations = zipped(set, zip)?;
    for (key, axis) in axes {
        let values = values(key, axis)?;
        if combinations.len() * values.len() > MOST {
            bail!("the axis `{key}` makes more than {MOST} combinations");
        }
        combinations =
            combinations.iter().flat_map(|made| values.iter().map(|value| with(made, key, value))).collect();
    }
    Ok(combinations)
}

/// How many combinations there are.
pub(super) fn count(zip: &Settings, axes: &Settings) -> Result<f64> {
    let of = |(key, axis): (&String, &Value)| Ok(values(key, axis)?.len() as f64);
    let zipped = zip.iter().next().map_or(Ok(1.0), of)?;
    axes.iter().map(of).try_fold(zipped, |made, values: Result<f64>| Ok(made * values?))
}

fn zipped(set: &Settings, zip: &Settings) -> Result<Vec<Settings>> {
    let mut rows: Option<(&str, Vec<Settings>)> = None;
    for (key, axis) in zip {
        let values = values(key, axis)?;
        let (first, made) = rows.unwrap_or_else(|| (key, vec![set.clone(); values.len()]));
        if made.len() != values.len() {
            let (one, other) = (made.len(), values.len());
            bail!("`zip` takes values together: `{first}` has {one}, `{key}` has {other}");
        }
        let made = made.iter().zip(&values).map(|(made, value)| with(made, key, value)).collect();
        rows = Some((first, made));
    }
    Ok(rows.map_or_else(|| vec![set.clone()], |(_, made)| made))
}

fn with(settings: &Settings, key: &str, value: &Value) -> Settings {
    let mut settings = settings.clone();
    settings.insert(key.to_owned(), value.clone());
    settings
}

/// The values of the axis `key`.
pub(crate) fn values(key: &str, axis: &Value) -> Result<Vec<Value>> {
    match axis {
        Value::Array(values) if values.is_empty() => bail!("the axis `{key}` is empty"),
        Value::Array(values) => Ok(values.clone()),
        Value::String(text) => range(text)
            .map_err(|expected| anyhow::anyhow!("the axis `{key}` is \"{text}\": it must be {expected}")),
        other => bail!("the axis `{key}` is {other}: it must be {ACCEPTED}"),
    }
}

/// The values of a range; or else what would be accepted.
fn range(text: &str) -> Result<Vec<Value>, String> {
    let arguments = |name: &str| text.strip_prefix(name)?.strip_prefix('(')?.strip_suffix(')');
    if let Some((first, last)) = text.split_once("..") {
        integers(first, last)
    } else if let Some(arguments) = arguments("lin") {
        let between = |[first, last]: [f64; 2], part: f64| first + (last - first) * part;
        spaced(arguments, "finite numbers", f64::is_finite, between)
    } else if let Some(arguments) = arguments("geom") {
        // The same bits on every machine, which the powers of the standard library do not promise.
        let log = |x: f64| libm::log10(x);
        let between =
            |[first, last]: [f64; 2], part: f64| libm::exp10(log(first) + (log(last) - log(first)) * part);
        spaced(arguments, "positive numbers", |x| x > 0.0 && x.is_finite(), between)
    } else {
        Err(ACCEPTED.to_owned())
    }
}

fn integers(first: &str, last: &str) -> Result<Vec<Value>, String> {
    let expected = || "two integers, the first not above the last, such as \"1..5\"".to_owned();
    let (Ok(first), Ok(last)) = (first.trim().parse::<i64>(), last.trim().parse::<i64>()) else {
        return Err(expected());
    };
    if first > last {
        return Err(expected());
    }
    if last.abs_diff(first) >= MOST as u64 {
        return Err(format!("of at most {MOST} values"));
    }
    Ok((first..=last).map(Value::from).collect())
}

/// `first, last, count`: both ends as they are written, and values between them, rounded to three significant digits.
fn spaced(
    arguments: &str,
    ends: &str,
    valid: fn(f64) -> bool,
    between: impl Fn([f64; 2], f64) -> f64,
) -> Result<Vec<Value>, String> {
    let expected = || {
        format!("two {ends} and a count from 2 to {MOST}, with commas between them, as in lin(0.1, 1, 10)")
    };
    let arguments: Vec<&str> = arguments.split(',').map(str::trim).collect();
    let &[first, last, count] = arguments.as_slice() else { return Err(expected()) };
    let (Ok(first), Ok(last), Ok(count)) = (first.parse(), last.parse(), count.parse::<usize>()) else {
        return Err(expected());
    };
    if !(valid(first) && valid(last) && (2..=MOST).contains(&count)) {
        return Err(expected());
    }
    let value = |k: usize| match k {
        0 => first,
        k if k == count - 1 => last,
        k => three_digits(between([first, last], k as f64 / (count - 1) as f64)),
    };
    let values: Vec<f64> = (0..count).map(value).collect();
    if values.windows(2).any(|pair| pair[0] == pair[1]) {
        return Err("of fewer values: to three significant digits, some of these are equal".to_owned());
    }
    Ok(values.into_iter().map(number).collect())
}

fn three_digits(x: f64) -> f64 {
    // What this prints is a number.
    format!("{x:.2e}").parse().unwrap_or(x)
}

/// A whole number without its fraction, so that it may be a count.
fn number(x: f64) -> Value {
    if x.fract() == 0.0 && x.abs() < 1e15 { Value::from(x as i64) } else { Value::from(x) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn of(range: &str) -> Value {
        Value::Array(values("key", &json!(range)).unwrap())
    }

    #[track_caller]
    fn refused(axis: &Value, words: &[&str]) {
        let error = values("key", axis).unwrap_err().to_string();
        assert!(error.starts_with("the axis `key` is "), "{error}");
        for word in words {
            assert!(error.contains(word), "no `{word}` in: {error}");
        }
    }

    fn settings(value: &Value) -> Settings {
        value.as_object().unwrap().clone()
    }

    #[test]
    fn integers_have_both_ends() {
        assert_eq!(of("1..5"), json!([1, 2, 3, 4, 5]));
        assert_eq!(of("-1 .. 1"), json!([-1, 0, 1]));
        assert_eq!(of("7..7"), json!([7]));
    }

    #[test]
    fn geometric_values_have_equal_ratios_to_three_digits_and_exact_ends() {
        assert_eq!(of("geom(1, 1000, 4)"), json!([1, 10, 100, 1000]));
        assert_eq!(of("geom(0.1, 10, 5)"), json!([0.1, 0.316, 1, 3.16, 10]));
        assert_eq!(of("geom(8, 1, 4)"), json!([8, 4, 2, 1]));
        assert_eq!(of("geom(0.12345, 1.23456, 2)"), json!([0.12345, 1.23456]));
    }

    #[test]
    fn linear_values_have_equal_steps_to_three_digits_and_exact_ends() {
        let tenths = json!([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1]);
        assert_eq!(of("lin(0.1, 1, 10)"), tenths);
        assert_eq!(of("lin(-1, 1.0001, 3)"), json!([-1, 0.00005, 1.0001]));
    }

    #[test]
    fn range_that_is_none_is_refused() {
        refused(&json!([]), &["empty"]);
        refused(&json!(3), &["is 3:", "a list", "\"1..5\""]);
        refused(&json!("4x2"), &["\"4x2\"", "a list", "geom("]);
        refused(&json!("5..1"), &["\"5..1\"", "not above the last"]);
        refused(&json!("1..2.5"), &["\"1..2.5\"", "integers"]);
        refused(&json!("0..9223372036854775807"), &["at most 100000"]);
        refused(&json!("-9223372036854775808..9223372036854775807"), &["at most 100000"]);
        refused(&json!("geom(0, 1, 3)"), &["\"geom(0, 1, 3)\"", "positive"]);
        refused(&json!("geom(1, inf, 3)"), &["positive"]);
        refused(&json!("geom(1, 10)"), &["a count"]);
        refused(&json!("lin(0, 1, 1)"), &["from 2"]);
        refused(&json!("lin(0, nan, 3)"), &["finite"]);
        refused(&json!("lin(1, 2, 3"), &["a list"]);
        refused(&json!("lin(0.8 1.6 5)"), &["two finite numbers and a count", "with commas between them"]);
        refused(&json!("lin(1000, 1001, 11)"), &["some of these are equal"]);
        refused(&json!("lin(1, 1, 2)"), &["some of these are equal"]);
    }

    #[test]
    fn zipped_values_are_taken_together_and_axes_are_combined() {
        let set = settings(&json!({ "law": "iqs" }));
        let zip = settings(&json!({ "grains": [10, 20], "width": [1.0, 2.0] }));
        let axes = settings(&json!({ "seed": "1..2" }));
        let made = combinations(&set, &zip, &axes).unwrap();
        let expected = [(10, 1.0, 1), (10, 1.0, 2), (20, 2.0, 1), (20, 2.0, 2)];
        let expected = expected.map(|(grains, width, seed)| {
            settings(&json!({ "law": "iqs", "grains": grains, "width": width, "seed": seed }))
        });
        assert_eq!(made, expected);
        let none = Settings::new();
        assert_eq!(combinations(&set, &none, &none).unwrap(), [set]);
    }

    #[test]
    fn axes_that_meet_or_do_not_match_are_refused() {
        let refused = |set, zip, axes, words: &[&str]| {
            let error =
                combinations(&settings(&set), &settings(&zip), &settings(&axes)).unwrap_err().to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        };
        let none = || json!({});
        refused(json!({ "a": 1 }), none(), json!({ "a": [1] }), &["`a` is set and an axis"]);
        refused(json!({ "a": 1 }), json!({ "a": [1] }), none(), &["`a` is set and an axis"]);
        refused(none(), json!({ "a": [1] }), json!({ "a": [1] }), &["`a` is an axis twice"]);
        refused(none(), json!({ "a": [1, 2], "b": "1..3" }), none(), &["`a` has 2", "`b` has 3"]);
        refused(none(), none(), json!({ "a": "1..2000", "b": "1..2000" }), &["`b`", "100000 combinations"]);
    }
}
