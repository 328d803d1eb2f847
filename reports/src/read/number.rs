//! Numbers as a reader of a figure or table expects them.

/// Raised digits.
pub(crate) const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

/// 10ⁿ.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    let digits = exponent.unsigned_abs().to_string();
    let raised = digits.bytes().map(|digit| SUPERSCRIPTS[usize::from(digit - b'0')]);
    "10".chars().chain((exponent < 0).then_some('⁻')).chain(raised).collect()
}

/// Returns the mantissa of a number with up to `digits` significant digits, and its power of ten; plain between 0.01 and 10,000.
pub(crate) fn mantissa_and_power(value: f64, digits: u8) -> (String, Option<i32>) {
    if value == 0.0 || !value.is_finite() {
        return (value.to_string(), None);
    }
    let scientific = format!("{value:.*e}", usize::from(digits.saturating_sub(1)));
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return (scientific, None) };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-2..4).contains(&exponent) {
        let decimals = i32::from(digits) - 1 - exponent;
        return (format!("{value:.*}", decimals.max(0) as usize), None);
    }
    let mantissa =
        if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    (mantissa.to_owned(), Some(exponent))
}

/// `m·10ⁿ` with up to `digits` significant digits, as `10ⁿ` if m = 1; plain between 0.01 and 10,000.
pub(crate) fn number(value: f64, digits: u8) -> String {
    match mantissa_and_power(value, digits) {
        (plain, None) => plain,
        (mantissa, Some(power)) if mantissa == "1" => power_of_ten(power),
        (mantissa, Some(power)) => format!("{mantissa}·{}", power_of_ten(power)),
    }
}

/// Groups of three digits, kept together by a narrow space.
pub(crate) fn count(value: usize) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// `1 contact`, `2 contacts`, on one line.
pub(crate) fn counted(value: usize, noun: &str) -> String {
    format!("{}\u{a0}{noun}{}", count(value), if value == 1 { "" } else { "s" })
}

/// The greatest of 1, 2, 5 times a power of ten that is not above `value > 0`.
pub(crate) fn round_down(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    // The tolerance lets 0.2 count as 2 × 0.1 in spite of round-off.
    [5.0, 2.0]
        .into_iter()
        .map(|m| m * decade)
        .find(|&rounded| rounded <= value * (1.0 + 1e-9))
        .unwrap_or(decade)
}

#[cfg(test)]
mod tests;
