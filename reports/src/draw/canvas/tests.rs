use super::*;

#[test]
fn dashes_have_their_lengths() {
    let pen = Pen { dash: &[2.0, 0.5], ..Pen::solid(BLACK, 0.1) };
    let sheet = svg((10.0, 10.0), |canvas| canvas.line(&[(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)], pen));
    let line =
        "stroke=\"#000000\" stroke-width=\"5\" stroke-dasharray=\"100 25\" points=\"0,0 150,0 150,200 \"";
    assert!(sheet.contains(line), "{sheet}");
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
fn sheet_has_its_size_on_paper_a_white_ground_and_fonts_to_fall_back_on() {
    let sheet =
        svg((90.0, 40.5), |canvas| canvas.text("a < b", (10.0, 10.0), 7.0, (HPos::Left, VPos::Center)));
    assert!(sheet.starts_with(r#"<svg width="90mm" height="40.5mm""#), "{sheet}");
    assert!(sheet.contains(r#"viewBox="0 0 4500 2025""#));
    assert!(sheet.contains(r##"fill="#FFFFFF""##));
    assert!(sheet.contains(FONTS) && sheet.contains("a &lt; b"));
}
