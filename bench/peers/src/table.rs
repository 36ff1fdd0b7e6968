//! Tables in Markdown, and the figures in them.

use std::time::Duration;

/// A table that is printed when it is complete.
pub(crate) struct Table {
    title: String,
    head: Vec<String>,
    rows: Vec<Vec<String>>,
    notes: Vec<String>,
}

impl Table {
    /// A table with its title and the heads of its columns.
    pub(crate) fn new(title: &str, head: &[&str]) -> Self {
        let head = head.iter().map(|&text| text.to_owned()).collect();
        Self { title: title.to_owned(), head, rows: Vec::new(), notes: Vec::new() }
    }

    /// Adds a row; missing cells are dashes.
    pub(crate) fn row(&mut self, mut cells: Vec<String>) {
        cells.resize(self.head.len(), "–".to_owned());
        self.rows.push(cells);
    }

    /// Adds a sentence below the table.
    pub(crate) fn note(&mut self, text: impl Into<String>) {
        self.notes.push(text.into());
    }

    #[expect(clippy::print_stdout, reason = "printing tables is what this program is for")]
    pub(crate) fn print(&self) {
        let width = |column: usize| {
            self.rows.iter().chain([&self.head]).map(|row| row[column].chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.head.len()).map(width).collect();
        let line = |cells: &[String]| {
            let cells = cells.iter().zip(&widths).map(|(cell, &width)| format!("{cell:<width$}"));
            println!("| {} |", cells.collect::<Vec<_>>().join(" | "));
        };
        println!("\n### {}\n", self.title);
        line(&self.head);
        line(&widths.iter().map(|&width| "-".repeat(width)).collect::<Vec<_>>());
        self.rows.iter().for_each(|row| line(row));
        for note in &self.notes {
            println!("\n{note}");
        }
    }
}

/// The value below which the given share of all lies; not a number without values.
pub(crate) fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(((sorted.len() as f64 - 1.0) * share).round() as usize).copied().unwrap_or(f64::NAN)
}

pub(crate) fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// Milliseconds.
pub(crate) fn millis(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// A number with three significant digits, or a dash.
pub(crate) fn figure(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let digits = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    format!("{value:.*}", (2 - digits).clamp(0, 5) as usize)
}

/// Returns how many times `value` is of `base`, as `12 ×`.
pub(crate) fn ratio(value: f64, base: f64) -> String {
    if value.is_finite() && base > 0.0 { format!("{} ×", figure(value / base)) } else { "–".to_owned() }
}
