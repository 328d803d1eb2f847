//! A table of a report as CSV for programs, as Markdown, and as LaTeX.

use polars::prelude::{AnyValue, CsvWriter, DataFrame, SerWriter};
use serde::Serialize;

use crate::error::ReportError;
use crate::read::{SUPERSCRIPTS, mantissa_and_power, number, power_of_ten};

/// Significant digits of a measured number where people read it.
const DIGITS: u8 = 3;

/// Every digit, and nothing where there is no value.
pub(crate) fn csv(table: &DataFrame) -> Result<String, ReportError> {
    let mut bytes = Vec::new();
    CsvWriter::new(&mut bytes).finish(&mut table.clone())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// A column as people read it; in a page its cells stand in rows.
#[derive(Serialize)]
pub(crate) struct Column {
    /// In words.
    pub(crate) name: String,
    /// Numbers stand to the right.
    pub(crate) numeric: bool,
    #[serde(skip)]
    pub(crate) cells: Vec<String>,
}

/// The first `rows` rows of all columns.
pub(crate) fn columns(table: &DataFrame, rows: usize) -> Result<Vec<Column>, ReportError> {
    let column = |column: &polars::prelude::Column| -> Result<Column, ReportError> {
        let cells = (0..table.height().min(rows)).map(|row| Ok(cell(&column.get(row)?)));
        Ok(Column {
            name: words(column.name()),
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

/// More rows than this do not fit on a page: the table is then one that goes on over pages.
const ROWS_OF_A_PAGE: usize = 40;

/// A `tabular` for `\input`, a `longtable` if it is longer than a page: rules of booktabs, numbers in columns of siunitx.
pub(crate) fn latex(table: &DataFrame) -> Result<String, ReportError> {
    let mut rows = vec![Vec::new(); table.height() + 1];
    let mut align = Vec::new();
    for column in table.columns() {
        let numeric = column.dtype().is_primitive_numeric();
        let mut format = Format::default();
        // What stands in braces is text to siunitx.
        rows[0].push(format!("{{{}}}", tex(&words(column.name()))));
        for (i, row) in rows[1..].iter_mut().enumerate() {
            let value = column.get(i)?;
            row.push(if numeric { format.siunitx(&value) } else { tex(&cell(&value)) });
        }
        align.push(if numeric { format.column() } else { "l".to_owned() });
    }
    let mut rows = rows.into_iter().map(|row| row.join(" & ") + " \\\\\n");
    let heading = rows.next().unwrap_or_default();
    let (body, align) = (rows.collect::<String>(), align.join(" "));
    let (name, head, foot) = if table.height() > ROWS_OF_A_PAGE {
        ("longtable", "\\midrule\n\\endhead\n\\bottomrule\n\\endfoot\n", "")
    } else {
        ("tabular", "\\midrule\n", "\\bottomrule\n")
    };
    Ok(format!(
        "% \\usepackage{{booktabs,longtable,siunitx}}\n\\begin{{{name}}}{{{align}}}\n\\toprule\n{heading}{head}{body}{foot}\
         \\end{{{name}}}\n"
    ))
}

/// Room that the numbers of a column take on both sides of their decimal marker.
#[derive(Default)]
struct Format {
    negative: bool,
    whole: usize,
    decimals: usize,
    /// As wide as the widest, with its sign.
    power: String,
}

impl Format {
    /// Returns a number as siunitx reads it, and makes room for it; text in braces where there is none.
    fn siunitx(&mut self, value: &AnyValue) -> String {
        let (mantissa, power) = match value {
            AnyValue::Float64(x) if x.is_finite() => mantissa_and_power(*x, DIGITS),
            AnyValue::Float64(_) | AnyValue::Null => return format!("{{{}}}", tex(&cell(value))),
            count => (count.to_string(), None),
        };
        let (before, after) = mantissa.split_once('.').unwrap_or((&mantissa, ""));
        self.negative |= before.starts_with('-');
        self.whole = self.whole.max(before.trim_start_matches('-').len());
        self.decimals = self.decimals.max(after.len());
        let power = power.map_or(String::new(), |power| format!("e{power}"));
        let number = mantissa + &power;
        if power.len() > self.power.len() {
            self.power = power;
        }
        number
    }

    /// Returns the alignment of the column: numbers at their decimal marker.
    fn column(&self) -> String {
        let Self { negative, whole, decimals, power } = self;
        let sign = if *negative { "-" } else { "" };
        let decimals = if *decimals > 0 { format!(".{decimals}") } else { String::new() };
        format!("S[table-format={sign}{}{decimals}{power}]", whole.max(&1))
    }
}

/// The digit or minus sign that is raised.
fn raised(c: char) -> Option<char> {
    match c {
        '⁻' => Some('-'),
        c => SUPERSCRIPTS.into_iter().zip('0'..='9').find(|(known, _)| *known == c).map(|(_, digit)| digit),
    }
}

/// The name of a stored column in words: its unit in brackets, accuracies as they are written.
pub(crate) fn words(name: &str) -> String {
    const UNITS: [(&str, &str); 10] = [
        ("_m_per_s2", "m/s²"),
        ("_m_per_s", "m/s"),
        ("_rad_per_s", "rad/s"),
        ("_n_s", "N·s"),
        ("_utc", "UTC"),
        ("_hz", "Hz"),
        ("_kg", "kg"),
        ("_j", "J"),
        ("_m", "m"),
        ("_s", "s"),
    ];
    let unit = UNITS.iter().find_map(|(ending, unit)| Some((name.strip_suffix(ending)?, unit)));
    let (name, unit) = unit.map_or((name, String::new()), |(name, unit)| (name, format!(" ({unit})")));
    let power = name.rsplit_once("_1e_").and_then(|(name, power)| Some((name, power.parse::<i32>().ok()?)));
    let (name, accuracy) =
        power.map_or((name, String::new()), |(name, power)| (name, format!(" ≤ {}", power_of_ten(-power))));
    let letters = [("kappa_", "κ_"), ("zeta", "ζ"), ("setup", "set-up"), ("delassus", "Delassus")];
    let name = letters.iter().fold(name.to_owned(), |name, (plain, written)| name.replace(plain, written));
    // Underscores are spaces, but where they lower an index.
    let name = name.replace('_', " ").replace("κ ", "κ_");
    format!("{name}{accuracy}{unit}")
}

/// A text in LaTeX, whatever engine and font: what is not ASCII in the texts of a report has a command.
pub(crate) fn tex(text: &str) -> String {
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
        if let Some(command) = greek(letter) {
            tex.extend(["$\\", command]);
            if letters.next_if_eq(&'_').is_some() {
                tex.extend(letters.next().map(|index| format!("_{index}")));
            }
            tex.push('$');
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

/// The command of a Greek letter.
fn greek(letter: char) -> Option<&'static str> {
    let known = [('ζ', "zeta"), ('κ', "kappa"), ('μ', "mu"), ('τ', "tau"), ('ω', "omega"), ('λ', "lambda")];
    known.into_iter().find(|(known, _)| *known == letter).map(|(_, command)| command)
}

#[cfg(test)]
mod tests;
