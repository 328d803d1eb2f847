use super::*;

#[test]
fn dashes_turn_corners_and_keep_their_lengths() {
    let corner = [(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)];
    let pieces = dashes(&corner, &[2.0, 0.5, 1.0, 0.5]);
    let expected = [
        vec![(0.0, 0.0), (2.0, 0.0)],
        vec![(2.5, 0.0), (3.0, 0.0), (3.0, 0.5)],
        vec![(3.0, 1.0), (3.0, 3.0)],
        vec![(3.0, 3.5), (3.0, 4.0)],
    ];
    assert_eq!(pieces, expected);
}

#[test]
fn index_of_a_search_direction_is_lowered() {
    let both = lowered("κ_l, κ_d (–)");
    let index =
        |letter| format!(r#"κ<tspan font-size="70%" dy="0.3em">{letter}</tspan><tspan dy="-0.21em">"#);
    assert_eq!(both, format!("{}, </tspan>{} (–)</tspan>", index('l'), index('d')));
    assert_eq!(lowered("kappa_d=0.3"), "kappa_d=0.3");
}

#[test]
fn solid_line_is_one_piece_and_no_line_is_none() {
    assert_eq!(dashes(&[(0.0, 0.0), (1.0, 0.0)], &[]).len(), 1);
    assert!(dashes(&[], &[1.0, 1.0]).is_empty());
}

#[test]
fn sheet_has_its_size_on_paper_a_white_ground_and_fonts_to_fall_back_on() {
    let sheet =
        svg((90.0, 40.5), |canvas| canvas.text("a < b", (10.0, 10.0), 7.0, (HPos::Left, VPos::Center)));
    assert!(sheet.starts_with(r#"<svg width="90mm" height="40.5mm""#), "{sheet}");
    assert!(sheet.contains(r#"viewBox="0 0 4500 2025""#));
    assert!(sheet.contains(r##"fill="#FFFFFF""##));
    assert!(sheet.contains(FONTS) && sheet.contains("a &lt; b"));
}
