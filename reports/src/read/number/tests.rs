use super::*;

#[test]
fn powers_are_raised_digits() {
    assert_eq!(power_of_ten(-12), "10⁻¹²");
    assert_eq!(power_of_ten(3), "10³");
}

#[test]
fn numbers_keep_their_significant_digits() {
    assert_eq!(number(1e-4, 2), "10⁻⁴");
    assert_eq!(number(5e-4, 2), "5·10⁻⁴");
    assert_eq!(number(1.234e7, 3), "1.23·10⁷");
    assert_eq!(number(0.0123, 2), "0.012");
    assert_eq!(number(1.0, 2), "1.0");
    assert_eq!(number(1234.5, 2), "1234");
    assert_eq!(number(0.0, 2), "0");
    assert_eq!(number(f64::INFINITY, 2), "inf");
}

#[test]
fn counts_are_grouped_by_three() {
    assert_eq!(count(999), "999");
    assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
    assert_eq!(counted(1, "grain"), "1\u{a0}grain");
}

#[test]
fn rounding_goes_to_one_two_five() {
    assert_eq!([0.2, 0.19, 7.0, 1.0].map(round_down), [0.2, 0.1, 5.0, 1.0]);
}
