//! The contact law, eq. (2): 0 ≤ v ⊥ r ≥ 0, as a fixed point.

/// max(0, s), the projection on admissible impulses, which hands a NaN on instead of hiding it as `f64::max` does.
#[inline]
pub fn non_negative(s: f64) -> f64 {
    if 0.0 > s { 0.0 } else { s }
}

/// r⁺ = max(0, r − ω v / `W_αα`): with ω = 1, the impulse that solves (2) at one contact when all others are kept.
/// `inverse_delassus` is 1/`W_αα` (kg), `relaxation` is ω (–).
#[inline]
pub fn update(r: f64, v: f64, inverse_delassus: f64, relaxation: f64) -> f64 {
    non_negative(r - relaxation * v * inverse_delassus)
}

/// r⁺ − r = max(−r, −ω v) of [`update`] where `W_αα` = 1, which waits for v one addition less; r plus this is NaN where r or v
/// is.
#[inline]
pub fn change(r: f64, v: f64, relaxation: f64) -> f64 {
    let change = -relaxation * v;
    if -r > change { -r } else { change }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_points_of_the_update_are_the_solutions_of_the_law() {
        for (r, v, solves) in [
            (0.0, 1.0, true),
            (2.0, 0.0, true),
            (0.0, 0.0, true),
            (2.0, 1.0, false),
            (0.0, -1.0, false),
            (2.0, -1.0, false),
        ] {
            assert_eq!(update(r, v, 0.5, 1.0) == r, solves, "r = {r}, v = {v}");
            assert_eq!(change(r, v, 1.0) == 0.0, solves, "r = {r}, v = {v}");
        }
    }

    #[test]
    fn not_a_number_is_not_hidden_by_the_projection() {
        assert!(non_negative(f64::NAN).is_nan());
        assert_eq!(non_negative(-1.0), 0.0);
        assert!([(f64::NAN, 1.0), (1.0, f64::NAN)].iter().all(|(r, v)| (r + change(*r, *v, 1.0)).is_nan()));
        assert_eq!(change(2.0, 3.0, 1.0), -2.0);
    }
}
