use polars::df;

use super::*;

#[test]
fn latex_has_the_values_of_the_table_and_no_letter_that_a_font_may_lack() {
    let table = df!(
        "ζ ≤ 10⁻³ & more" => ["50 %", "a_b"],
        "κ" => [Some(1.234e7), None],
    )
    .unwrap();
    let expected = "% \\usepackage{booktabs}\n\\begin{tabular}{lr}\n\\toprule\n\
                    $\\zeta$ $\\le$ 10$^{-3}$ \\& more & $\\kappa$ \\\\\n\\midrule\n\
                    50 \\% & 1.23$\\cdot$10$^{7}$ \\\\\na\\_b & -- \\\\\n\\bottomrule\n\\end{tabular}\n";
    assert_eq!(latex(&table).unwrap(), expected);
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
    assert!(latex(&table).unwrap().contains("a$|$b & 2$\\cdot$10$^{-9}$"));
}
