//! Axes of a plan: listed values and ranges, and their combinations.

use anyhow::{Result, bail};
use serde_json::{Map, Value};

/// Settings by key, or axes by key.
pub(crate) type Settings = Map<String, Value>;

/// A plan with more runs than this was not meant.
pub(crate) const MOST: usize = 100_000;

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
            bail!("the axis `{key}` gives more than {MOST} combinations");
        }
        combinations =
            combinations.iter().flat_map(|one| values.iter().map(|value| with(one, key, value))).collect();
    }
    Ok(combinations)
}

/// Returns the number of combinations.
pub(crate) fn count(zip: &Settings, axes: &Settings) -> Result<f64> {
    let of = |(key, axis): (&String, &Value)| Ok(values(key, axis)?.len() as f64);
    let zipped = zip.iter().next().map_or(Ok(1.0), of)?;
    axes.iter().map(of).try_fold(zipped, |count, values: Result<f64>| Ok(count * values?))
}

fn zipped(set: &Settings, zip: &Settings) -> Result<Vec<Settings>> {
    let axes = zip.iter().map(|(key, axis)| Ok((key, values(key, axis)?))).collect::<Result<Vec<_>>>()?;
    let Some((first, values)) = axes.first() else { return Ok(vec![set.clone()]) };
    let one = values.len();
    if let Some((key, other)) = axes.iter().find(|(_, other)| other.len() != one) {
        bail!("`zip` takes values together: `{first}` has {one}, `{key}` has {}", other.len());
    }
    let row = |k: usize| axes.iter().fold(set.clone(), |row, (key, values)| with(&row, key, &values[k]));
    Ok((0..one).map(row).collect())
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
    match (first.trim().parse::<i64>(), last.trim().parse::<i64>()) {
        (Ok(first), Ok(last)) if first <= last && last.abs_diff(first) < MOST as u64 => {
            Ok((first..=last).map(Value::from).collect())
        }
        (Ok(first), Ok(last)) if first <= last => Err(format!("of at most {MOST} values")),
        _ => Err("two integers, the first not above the last, such as \"1..5\"".to_owned()),
    }
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
