use polars::df;

use super::*;

#[test]
fn latex_has_the_values_of_the_table_and_no_letter_that_a_font_may_lack() {
    let table = df!(
        "ζ ≤ 10⁻³ & more" => ["50 %", "a_b"],
        "κ" => [Some(1.234e7), None],
    )
    .unwrap();
    let expected = "% \\usepackage{booktabs,longtable,siunitx}\n\
                    \\begin{tabular}{l S[table-format=1.2e7]}\n\\toprule\n\
                    {$\\zeta$ $\\le$ 10$^{-3}$ \\& more} & {$\\kappa$} \\\\\n\\midrule\n\
                    50 \\% & 1.23e7 \\\\\na\\_b & {--} \\\\\n\\bottomrule\n\\end{tabular}\n";
    assert_eq!(latex(&table).unwrap(), expected);
}

#[test]
fn numbers_of_latex_have_room_for_the_longest_of_their_column() {
    let column = |values: &[f64]| latex(&df!("x" => values).unwrap()).unwrap();
    for (values, format, written) in [
        (&[1.0, -234.0, 0.5][..], "S[table-format=-3.3]", "-234 "),
        (&[1e-9, 3.0], "S[table-format=1.2e-9]", "1e-9 "),
        (&[f64::NAN, f64::INFINITY], "S[table-format=1]", "{NaN} "),
    ] {
        let text = column(values);
        assert!(text.contains(format) && text.contains(&format!("\n{written}")), "{text}");
    }
}

#[test]
fn table_that_no_page_holds_goes_on_over_pages() {
    let rows = |n: u32| latex(&df!("iterations" => (0..n).collect::<Vec<_>>()).unwrap()).unwrap();
    assert!(rows(40).contains("\\begin{tabular}") && !rows(40).contains("longtable}{"));
    let long = rows(41);
    assert!(long.contains("\\begin{longtable}{S[table-format=2]}") && long.contains("\\endhead"), "{long}");
    assert!(long.ends_with("40 \\\\\n\\end{longtable}\n"), "its rule below is its foot: {long}");
}

#[test]
fn headings_are_words_with_units() {
    for (name, expected) in [
        ("iterations_to_zeta_1e_4", "iterations to ζ ≤ 10⁻⁴"),
        ("penetration_rate_m_per_s", "penetration rate (m/s)"),
        ("setup_s", "set-up (s)"),
        ("impulse_n_s", "impulse (N·s)"),
        ("kappa_l", "κ_l"),
        ("natural map ≤ 10⁻²", "natural map ≤ 10⁻²"),
        ("seconds", "seconds"),
    ] {
        assert_eq!(words(name), expected);
    }
    assert_eq!(tex("κ_l"), "$\\kappa_l$");
}

#[test]
fn text_of_the_only_row_has_no_quotes() {
    let table = df!("processor" => ["a processor"]).unwrap();
    assert!(!markdown(&table).unwrap().contains('"'), "{}", markdown(&table).unwrap());
}

#[test]
fn the_three_formats_hold_the_same_rows() {
    let table = df!("method" => ["cg", "a|b"], "seconds" => [0.5, 2e-9]).unwrap();
    assert_eq!(csv(&table).unwrap(), "method,seconds\ncg,0.5\na|b,2e-9\n");
    assert!(markdown(&table).unwrap().contains("| a\\|b   |  2·10⁻⁹ |"));
    assert!(latex(&table).unwrap().contains("a$|$b & 2e-9"));
}
