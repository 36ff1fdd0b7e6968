//! A drawing as a standalone SVG file: exactly what the page paints, from the same display list.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use tpn::{ArcKind, LabelId, Network, Plan, Role};

use crate::drawing::{BlockForm, NetworkDrawing, Route, TextShape};
use crate::geometry::{Piece, Point, Rect};
use crate::look::{self, Ink, Parts, Standing, Stroke};
use crate::metrics::{DECISION_INSET, TextRole};
use crate::overlay::OverlayCurve;
use crate::palette::{Palette, Rgb};
use crate::progress::{Progress, elapsed};
use crate::threads::{thread_name, threads};

/// What of a network's drawing goes into the picture.
#[derive(Clone, Debug)]
pub struct SvgOptions<'a> {
    /// Its colours.
    pub palette: &'a Palette,
    /// The plan that is marked, if any.
    pub plan: Option<&'a Plan>,
    /// Curves over the drawing.
    pub overlays: &'a [OverlayCurve],
    /// Texts over the drawing, such as windows.
    pub notes: &'a [TextShape],
    /// What of the drawing is shown.
    pub parts: Parts,
    /// What has happened at the moment that is shown, if one is.
    pub progress: Option<&'a Progress>,
    /// The title of the picture, for screen readers.
    pub title: &'a str,
}

/// A picture in the making.
pub(crate) struct Canvas<'a> {
    out: String,
    palette: &'a Palette,
}

/// Writes a drawing of `network` as an SVG file.
pub fn svg(drawing: &NetworkDrawing, network: &Network, options: &SvgOptions<'_>) -> String {
    let mut canvas = Canvas::new(drawing.bounds, options.palette, options.title);
    let parts = options.parts;
    if parts.lanes {
        draw_lanes(&mut canvas, drawing, network);
    }
    for block in &drawing.blocks {
        if parts.structure || block.form == BlockForm::Collapsed {
            let (fill, stroke) = look::block_look(block.form);
            canvas.rectangle(block.rect, 6.0, fill, stroke);
        }
    }
    for connector in &drawing.connectors {
        let standing = look::node_standing(options.plan, connector.node);
        if !parts.shows(standing) {
            continue;
        }
        let stroke = look::arc_stroke(ArcKind::Glue, Route::Along, standing);
        canvas.curve(connector.start, &[connector.piece], stroke);
    }
    // What the plan selects lies over what it does not.
    for is_selected in [false, true] {
        for arc in &drawing.arcs {
            let standing = look::arc_standing(options.plan, arc.id);
            if (standing == Standing::Selected) == is_selected && parts.shows(standing) {
                let stroke = look::arc_stroke(arc.kind, arc.route, standing);
                canvas.curve(arc.start, drawing.pieces(arc), stroke);
                if let Some((tip, before)) = drawing.arrow(arc) {
                    canvas.polygon(&look::arrow_head(tip, before), stroke.ink);
                }
            }
        }
    }
    let passed = options.progress.into_iter().flat_map(|progress| &progress.under_way);
    for (start, pieces) in passed.filter_map(|&(arc, fraction)| elapsed(drawing, arc, fraction)) {
        canvas.curve(start, &pieces, look::elapsed_stroke());
    }
    for curve in options.overlays {
        let stroke = look::overlay_stroke(curve.kind);
        canvas.curve(curve.start, &curve.pieces, stroke);
        if let Some((last, before)) = curve.pieces.split_last() {
            let start = before.last().map_or(curve.start, |piece| piece.end());
            canvas.polygon(&look::arrow_head(last.end(), last.before_end(start)), stroke.ink);
        }
    }
    for node in &drawing.nodes {
        let standing = look::node_standing(options.plan, node.id);
        if !parts.shows(standing) {
            continue;
        }
        let stroke = look::node_stroke(node.role, node.radius, standing);
        canvas.circle(node.center, node.radius, look::node_fill(node.role, node.radius, standing), stroke);
        if node.role == Role::Decision {
            canvas.circle(
                node.center,
                node.radius - DECISION_INSET,
                Ink::NodeFill,
                Stroke { width: 1.0, ..stroke },
            );
        }
    }
    let done = options.progress.into_iter().flat_map(|progress| &progress.done);
    for node in done.filter_map(|&node| drawing.node(node)) {
        let radius = look::done_radius(node.radius);
        canvas.circle(node.center, radius, Ink::Now, Stroke::solid(Ink::Now, 0.0));
    }
    let arc_of_label = |label: LabelId| network.labels[label.index()].arc;
    for text in drawing.texts.iter().chain(options.notes) {
        let standing = look::item_standing(options.plan, text.owner, arc_of_label);
        if parts.shows_text(text.role) && parts.shows(standing) {
            canvas.text(&text.text, text.size, text.rect, look::text_ink(text.role, standing));
        }
    }
    canvas.finish()
}

/// A band for every parallel branch, with its name in its upper left corner.
fn draw_lanes(canvas: &mut Canvas<'_>, drawing: &NetworkDrawing, network: &Network) {
    let lanes = drawing.blocks.iter().filter(|it| it.form == BlockForm::Lane);
    let lanes: BTreeMap<_, _> = lanes.filter_map(|lane| Some((lane.block?, lane))).collect();
    let threads = threads(network);
    for (at, thread) in threads.iter().enumerate() {
        let Some(lane) = thread.block.and_then(|block| lanes.get(&block)) else { continue };
        let number = thread.path.last().copied().unwrap_or(0) as usize;
        let (fill, stroke) = look::lane_look(number);
        canvas.rectangle(lane.rect, 0.0, fill.unwrap_or(Ink::Surface), stroke);
        if let Some(name) = thread_name(network, &threads[at..]) {
            let size = TextRole::Quiet.size();
            let width = f64::from(crate::approximate_text_width(&name)) * size / crate::metrics::TEXT_SIZE;
            let min = lane.rect.min.shifted(4.0, 2.0);
            let rect = Rect { min, max: min.shifted(width, TextRole::Quiet.line_height()) };
            canvas.text(&name, size, rect, Ink::TextMuted);
        }
    }
}

impl<'a> Canvas<'a> {
    pub(crate) fn new(bounds: Rect, palette: &'a Palette, title: &str) -> Self {
        let mut out = String::new();
        let (width, height) = (number(bounds.width()), number(bounds.height()));
        let (left, top) = (number(bounds.min.x), number(bounds.min.y));
        let background = hex(palette.surface);
        let _ = writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"{left} {top} {width} {height}\" role=\"img\" fill=\"none\" \
             font-family=\"Inter, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif\">\n\
             <title>{}</title>\n\
             <rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"{background}\"/>",
            escaped(title)
        );
        Self { out, palette }
    }

    fn color(&self, ink: Ink) -> String {
        hex(self.palette.color(ink))
    }

    fn stroke_attributes(&self, stroke: Stroke) -> String {
        let mut text =
            format!("stroke=\"{}\" stroke-width=\"{}\"", self.color(stroke.ink), number(stroke.width));
        if let Some((mark, gap)) = stroke.dash.lengths() {
            let _ = write!(text, " stroke-dasharray=\"{} {}\"", number(mark), number(gap));
        }
        text
    }

    pub(crate) fn curve(&mut self, start: Point, pieces: &[Piece], stroke: Stroke) {
        let mut path = format!("M{} {}", number(start.x), number(start.y));
        for piece in pieces {
            let _ = match *piece {
                Piece::Line(end) => write!(path, "L{} {}", number(end.x), number(end.y)),
                Piece::Cubic(first, second, end) => write!(
                    path,
                    "C{} {} {} {} {} {}",
                    number(first.x),
                    number(first.y),
                    number(second.x),
                    number(second.y),
                    number(end.x),
                    number(end.y)
                ),
            };
        }
        let stroke = self.stroke_attributes(stroke);
        let _ = writeln!(self.out, "<path d=\"{path}\" {stroke}/>");
    }

    pub(crate) fn polygon(&mut self, corners: &[Point], fill: Ink) {
        let corners: Vec<String> =
            corners.iter().map(|corner| format!("{},{}", number(corner.x), number(corner.y))).collect();
        let fill = self.color(fill);
        let _ = writeln!(self.out, "<polygon points=\"{}\" fill=\"{fill}\"/>", corners.join(" "));
    }

    pub(crate) fn circle(&mut self, center: Point, radius: f64, fill: Ink, stroke: Stroke) {
        let (x, y, radius) = (number(center.x), number(center.y), number(radius));
        let (fill, stroke) = (self.color(fill), self.stroke_attributes(stroke));
        let _ = writeln!(self.out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{fill}\" {stroke}/>");
    }

    pub(crate) fn rectangle(&mut self, rect: Rect, corner: f64, fill: Ink, stroke: Stroke) {
        let (x, y) = (number(rect.min.x), number(rect.min.y));
        let (width, height, corner) = (number(rect.width()), number(rect.height()), number(corner));
        let (fill, stroke) = (self.color(fill), self.stroke_attributes(stroke));
        let _ = writeln!(
            self.out,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" rx=\"{corner}\" fill=\"{fill}\" {stroke}/>"
        );
    }

    /// Writes a text, stretched to its rectangle whatever the reader's fonts are.
    pub(crate) fn text(&mut self, text: &str, size: f64, rect: Rect, ink: Ink) {
        let (x, width) = (number(rect.min.x + 0.5), number((rect.width() - 1.0).max(1.0)));
        // The middle of lower-case letters and digits lies about a third of the size above the baseline.
        let baseline = number(rect.center().y + size * 0.35);
        let (size, fill) = (number(size), self.color(ink));
        let _ = writeln!(
            self.out,
            "<text x=\"{x}\" y=\"{baseline}\" font-size=\"{size}\" fill=\"{fill}\" \
             textLength=\"{width}\" lengthAdjust=\"spacingAndGlyphs\">{}</text>",
            escaped(text)
        );
    }

    pub(crate) fn finish(mut self) -> String {
        self.out.push_str("</svg>\n");
        self.out
    }
}

fn hex([red, green, blue]: Rgb) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// A coordinate with at most two decimals.
fn number(value: f64) -> String {
    let hundredths = (value * 100.0).round() as i64;
    let (sign, magnitude) = (if hundredths < 0 { "-" } else { "" }, hundredths.unsigned_abs());
    let (whole, rest) = (magnitude / 100, magnitude % 100);
    match rest {
        0 => format!("{sign}{whole}"),
        _ if rest % 10 == 0 => format!("{sign}{whole}.{}", rest / 10),
        _ => format!("{sign}{whole}.{rest:02}"),
    }
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // Control characters have no place in XML, not even escaped.
            _ if character.is_control() => out.push(' '),
            _ => out.push(character),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_texts_are_escaped() {
        assert_eq!([number(3.0), number(-0.5), number(2.345), number(-0.001)], ["3", "-0.5", "2.35", "0"]);
        assert_eq!(escaped("not(A<\"B\"&C>)\u{1}"), "not(A&lt;&quot;B&quot;&amp;C&gt;) ");
    }
}
