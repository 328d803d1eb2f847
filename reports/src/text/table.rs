//! A table of a report as CSV for programs, as Markdown, and as LaTeX.

use polars::prelude::{AnyValue, CsvWriter, DataFrame, SerWriter};

use crate::error::ReportError;
use crate::read::number;

/// Significant digits of a measured number where people read it.
const DIGITS: u8 = 3;

/// Every digit, and nothing where there is no value.
pub(crate) fn csv(table: &DataFrame) -> Result<String, ReportError> {
    let mut bytes = Vec::new();
    CsvWriter::new(&mut bytes).finish(&mut table.clone())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// A column as people read it.
pub(crate) struct Column {
    pub(crate) name: String,
    /// Numbers stand to the right.
    pub(crate) numeric: bool,
    pub(crate) cells: Vec<String>,
}

/// The first `rows` rows of all columns.
pub(crate) fn columns(table: &DataFrame, rows: usize) -> Result<Vec<Column>, ReportError> {
    let column = |column: &polars::prelude::Column| -> Result<Column, ReportError> {
        let cells = (0..table.height().min(rows)).map(|row| Ok(cell(&column.get(row)?)));
        Ok(Column {
            name: column.name().to_string(),
            numeric: column.dtype().is_primitive_numeric(),
            cells: cells.collect::<Result<_, ReportError>>()?,
        })
    };
    table.columns().iter().map(column).collect()
}

fn cell(value: &AnyValue) -> String {
    match value {
        AnyValue::Null => "–".to_owned(),
        AnyValue::Float64(x) => number(*x, DIGITS),
        AnyValue::String(text) => text.replace('\n', " "),
        AnyValue::StringOwned(text) => text.replace('\n', " "),
        other => other.to_string(),
    }
}

/// Markdown that also reads well on a terminal: numbers to the right, a dash where there is none.
pub(crate) fn markdown(table: &DataFrame) -> Result<String, ReportError> {
    let mut lines = vec![String::from("|"); table.height() + 2];
    for column in columns(table, usize::MAX)? {
        let escaped = column.cells.iter().map(|cell| cell.replace('|', "\\|"));
        let cells: Vec<String> = std::iter::once(column.name).chain(escaped).collect();
        let width = cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0).max(3);
        let numeric = column.numeric;
        let rule = if numeric { format!("{:->width$}", ":") } else { "-".repeat(width) };
        let pad =
            |cell: &String| if numeric { format!(" {cell:>width$} |") } else { format!(" {cell:<width$} |") };
        lines[0] += &pad(&cells[0]);
        lines[1].extend([" ", rule.as_str(), " |"]);
        for (line, cell) in lines[2..].iter_mut().zip(&cells[1..]) {
            *line += &pad(cell);
        }
    }
    let mut text = lines.join("\n") + "\n";
    if table.height() == 0 {
        text += "\nno such run in this study\n";
    }
    Ok(text)
}

/// A `tabular` for `\input`, with the rules of the package booktabs.
pub(crate) fn latex(table: &DataFrame) -> Result<String, ReportError> {
    let columns = columns(table, usize::MAX)?;
    let row = |cell: &dyn Fn(&Column) -> String| {
        columns.iter().map(|column| tex(&cell(column))).collect::<Vec<_>>().join(" & ") + " \\\\\n"
    };
    let align: String = columns.iter().map(|column| if column.numeric { 'r' } else { 'l' }).collect();
    let mut text = format!("% \\usepackage{{booktabs}}\n\\begin{{tabular}}{{{align}}}\n\\toprule\n");
    text += &row(&|column| column.name.clone());
    text += "\\midrule\n";
    for i in 0..table.height() {
        text += &row(&|column| column.cells[i].clone());
    }
    Ok(text + "\\bottomrule\n\\end{tabular}\n")
}

/// A text in LaTeX, whatever engine and font: what is not ASCII in the texts of a report has a command.
pub(crate) fn tex(text: &str) -> String {
    const SUPERSCRIPTS: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";
    let raised = |c: char| match c {
        '⁻' => Some('-'),
        c => SUPERSCRIPTS.chars().zip('0'..='9').find(|(known, _)| *known == c).map(|(_, digit)| digit),
    };
    let mut tex = String::new();
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        if let Some(first) = raised(letter) {
            let mut power = String::from(first);
            while let Some(next) = letters.peek().copied().and_then(raised) {
                power.push(next);
                letters.next();
            }
            tex.extend(["$^{", &power, "}$"]);
            continue;
        }
        match letter {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => tex.extend(['\\', letter]),
            '\\' => tex += "\\textbackslash{}",
            '~' => tex += "\\textasciitilde{}",
            '^' => tex += "\\textasciicircum{}",
            '<' | '>' | '|' => tex.extend(['$', letter, '$']),
            '–' => tex += "--",
            '−' => tex += "$-$",
            '\u{a0}' => tex.push('~'),
            '\u{202f}' => tex += "\\,",
            'ζ' => tex += "$\\zeta$",
            'κ' => tex += "$\\kappa$",
            'μ' => tex += "$\\mu$",
            'τ' => tex += "$\\tau$",
            'ω' => tex += "$\\omega$",
            'λ' => tex += "$\\lambda$",
            '≤' => tex += "$\\le$",
            '≥' => tex += "$\\ge$",
            '·' => tex += "$\\cdot$",
            '×' => tex += "$\\times$",
            '→' => tex += "$\\to$",
            '∞' => tex += "$\\infty$",
            letter => tex.push(letter),
        }
    }
    tex
}

#[cfg(test)]
mod tests;
