//! What of the drawings is on paper: sheets on which texts can be read, of A4 and of Letter alike.

use markup::escaped;

/// How wide a drawing may be on a sheet, in units of the drawing. Between the margins of A4 are 510 points, of Letter 527,
/// so that a text of 11 units is at least 7 points high.
pub(super) const WIDTH: f64 = 780.0;
/// How high a drawing may be on a sheet, in units of the drawing: with its heading and what is said of it, a page.
pub(super) const HEIGHT: f64 = 900.0;

/// Where a drawing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Medium {
    /// On the screen and on paper.
    Everywhere,
    /// On the screen alone, at its own size.
    Screen,
    /// On paper alone.
    Paper,
}

/// A drawing with what is to be said of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    /// The drawing, as SVG.
    pub(crate) drawing: String,
    /// What is to be said of it.
    pub(crate) caption: String,
    pub(crate) medium: Medium,
}

impl Figure {
    pub(crate) fn html(&self) -> String {
        // A drawing inside HTML needs no namespace of its own.
        let drawing = self.drawing.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
        let class = match self.medium {
            Medium::Everywhere => "",
            Medium::Screen => " class=\"on-screen\"",
            Medium::Paper => " class=\"in-print\"",
        };
        let caption = escaped(&self.caption);
        format!("<figure{class}>\n{drawing}<figcaption>{caption}</figcaption>\n</figure>\n")
    }
}

/// Drawings one after the other, as HTML.
pub(crate) fn html(figures: &[Figure]) -> String {
    figures.iter().map(Figure::html).collect()
}

/// The same under a heading, which stays with the first of them on paper.
pub(crate) fn under_heading(heading: &str, figures: &[Figure]) -> String {
    let on_paper = figures.iter().position(|figure| !matches!(figure.medium, Medium::Screen));
    let (first, rest) = figures.split_at(on_paper.map_or(0, |first| first + 1));
    format!("<div class=\"together\">\n<h2>{heading}</h2>\n{}</div>\n{}", html(first), html(rest))
}
