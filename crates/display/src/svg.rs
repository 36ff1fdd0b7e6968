//! Display lists as a standalone SVG file, from which pictures are made too.
//!
//! The same lists give the same bytes everywhere. A file grows in proportion to its lists and the lengths of their texts:
//! nothing is written twice, and hatching is one dashed line whatever its area.

use std::fmt::Write as _;

use markup::escaped;

use crate::color::{Color, ColorRole, Ground, Theme};
use crate::geometry::{Piece, Point, Rect};
use crate::list::{DisplayList, Fill, Group, Item, PathEnd, Shape, Stroke, arrow_head, tip};
use crate::text::{Anchor, Fit, Text, Weight, approximate_text_width, cut_to_width, text_width_at};

/// From one line of a hatching to the next, and how broad each is.
const HATCHING: (f64, f64) = (6.0, 1.3);
/// How far a plate reaches beyond its text.
const PLATE_MARGIN: f64 = 2.0;

/// Writes display lists over each other as an SVG file with the frame of the first. `title` is for screen readers.
pub fn svg(lists: &[&DisplayList], theme: Theme, title: &str) -> String {
    let frame = lists.first().map_or(Rect::default(), |list| list.frame);
    let mut writer = Writer { out: String::new(), theme };
    writer.head(frame, title);
    let mut groups: Vec<(&DisplayList, &Group, std::ops::Range<usize>)> = Vec::new();
    for list in lists {
        groups.extend(list.groups().map(|(group, range)| (*list, group, range)));
    }
    groups.sort_by_key(|(_, group, _)| group.layer);
    for (list, group, range) in groups {
        if let Some(clip) = group.clip {
            writer.open_clip(clip);
        }
        for at in range {
            let item = &list.items()[at];
            if item.detail.holds(1.0) {
                writer.item(list, item, list.title(at));
            }
        }
        if group.clip.is_some() {
            writer.out.push_str("</svg>\n");
        }
    }
    writer.out.push_str("</svg>\n");
    writer.out
}

struct Writer {
    out: String,
    theme: Theme,
}

impl Writer {
    fn head(&mut self, frame: Rect, title: &str) {
        let (width, height) = (number(frame.width()), number(frame.height()));
        let (left, top) = (number(frame.min.x), number(frame.min.y));
        let background = hex(self.theme.rgb(ColorRole::Surface));
        let _ = writeln!(
            self.out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"{left} {top} {width} {height}\" role=\"img\" fill=\"none\" \
             font-family=\"Inter, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif\">\n\
             <title>{}</title>\n\
             <rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"{background}\"/>",
            escaped(title)
        );
    }

    /// A picture inside the picture shows nothing outside its frame.
    fn open_clip(&mut self, clip: Rect) {
        let (left, top) = (number(clip.min.x), number(clip.min.y));
        let (width, height) = (number(clip.width()), number(clip.height()));
        let _ = writeln!(
            self.out,
            "<svg x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"{left} {top} {width} {height}\">"
        );
    }

    fn item(&mut self, list: &DisplayList, item: &Item, title: Option<&str>) {
        match item.shape {
            Shape::Path { start, pieces, end } => {
                let pieces = list.pieces(pieces);
                self.path(start, pieces, end, item, title);
            }
            Shape::Rectangle { rect, corner } => {
                let (solid, hatched) = match item.fill {
                    Some(Fill::Hatched(color)) => (None, Some(color)),
                    Some(Fill::Solid(color)) => (Some(color), None),
                    None => (None, None),
                };
                if let Some(color) = hatched {
                    self.hatching(rect, color);
                }
                if solid.is_some() || item.stroke.is_some() {
                    self.rectangle(rect, corner, solid, item.stroke, title);
                }
            }
            Shape::Circle { center, radius } => {
                let (x, y, radius) = (number(center.x), number(center.y), number(radius));
                let _ = write!(self.out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"");
                self.paint(item.fill.map(Fill::color), item.stroke);
                self.close("circle", title);
            }
            Shape::Text(place) => self.text(list.text(place)),
        }
    }

    /// The attributes of a fill and a line.
    fn paint(&mut self, fill: Option<Color>, stroke: Option<Stroke>) {
        if let Some(color) = fill {
            self.color("fill", color);
        }
        if let Some(stroke) = stroke {
            self.stroke(stroke);
        }
    }

    fn color(&mut self, attribute: &str, color: Color) {
        let _ = write!(self.out, " {attribute}=\"{}\"", hex(self.theme.resolved(color)));
        if color.ground == Ground::Below && color.strength < 1.0 {
            let _ = write!(self.out, " {attribute}-opacity=\"{}\"", number(f64::from(color.strength)));
        }
    }

    fn stroke(&mut self, stroke: Stroke) {
        self.color("stroke", stroke.color);
        let _ = write!(self.out, " stroke-width=\"{}\"", number(stroke.width));
        if let Some((mark, gap)) = stroke.dash.lengths() {
            let _ = write!(self.out, " stroke-dasharray=\"{} {}\"", number(mark), number(gap));
        }
    }

    fn close(&mut self, element: &str, title: Option<&str>) {
        let _ = match title {
            Some(title) => writeln!(self.out, "><title>{}</title></{element}>", escaped(title)),
            None => writeln!(self.out, "/>"),
        };
    }

    fn path(&mut self, start: Point, pieces: &[Piece], end: PathEnd, item: &Item, title: Option<&str>) {
        let _ = write!(self.out, "<path d=\"M{} {}", number(start.x), number(start.y));
        for piece in pieces {
            let _ = match *piece {
                Piece::Line(end) => write!(self.out, "L{} {}", number(end.x), number(end.y)),
                Piece::Cubic(first, second, end) => write!(
                    self.out,
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
        self.out.push_str(if end == PathEnd::Closed { "Z\"" } else { "\"" });
        self.paint(item.fill.map(Fill::color), item.stroke);
        self.close("path", title);
        let head = tip(start, pieces).filter(|_| end == PathEnd::Head);
        if let Some(((tip, before), stroke)) = head.zip(item.stroke) {
            let corners = arrow_head(tip, before).map(|it| format!("{},{}", number(it.x), number(it.y)));
            let _ = write!(self.out, "<polygon points=\"{}\"", corners.join(" "));
            self.color("fill", stroke.color);
            self.out.push_str("/>\n");
        }
    }

    fn rectangle(
        &mut self,
        rect: Rect,
        corner: f64,
        fill: Option<Color>,
        stroke: Option<Stroke>,
        title: Option<&str>,
    ) {
        let (x, y) = (number(rect.min.x), number(rect.min.y));
        let (width, height, corner) = (number(rect.width()), number(rect.height()), number(corner));
        let _ = write!(
            self.out,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" rx=\"{corner}\""
        );
        self.paint(fill, stroke);
        self.close("rect", title);
    }

    /// Lines at 45 degrees that lie inside the rectangle: one broad dashed line, skewed.
    fn hatching(&mut self, rect: Rect, color: Color) {
        let (height, (step, breadth)) = (rect.height(), HATCHING);
        if rect.width() <= height {
            return;
        }
        let (x, y) = (number(rect.min.x), number(rect.center().y));
        let (from, to) = (number(height / 2.0), number(rect.width() - height / 2.0));
        let _ = write!(
            self.out,
            "<path transform=\"translate({x} {y}) skewX(-45)\" d=\"M{from} 0H{to}\" stroke-width=\"{}\" \
             stroke-dasharray=\"{} {}\"",
            number(height),
            number(breadth),
            number(step - breadth)
        );
        self.color("stroke", color);
        self.out.push_str("/>\n");
    }

    fn text(&mut self, text: &Text) {
        let rect = text.rect;
        let width_of = |words: &str| text_width_at(words, text.size, &approximate_text_width);
        let words = match text.fit {
            Fit::Cut => cut_to_width(&text.text, rect.width(), width_of),
            Fit::Shrink | Fit::Unabridged | Fit::Overflow => text.text.clone(),
        };
        if let Some(plate) = text.plate {
            let width = if text.fit.fills_its_place() { rect.width() } else { width_of(&words) };
            let left = match text.anchor {
                Anchor::Start => rect.min.x,
                Anchor::Middle => rect.center().x - width / 2.0,
                Anchor::End => rect.max.x - width,
            };
            let place = Rect::new(left, rect.min.y, left + width, rect.max.y).expanded(PLATE_MARGIN);
            self.rectangle(place, PLATE_MARGIN, Some(plate), None, None);
        }
        // The middle of lower-case letters and digits lies about a third of the size above the baseline.
        let baseline = number(rect.center().y + text.size * 0.35);
        let (x, anchor) = match (text.fit, text.anchor) {
            (Fit::Shrink | Fit::Unabridged, _) => (rect.min.x + 0.5, ""),
            (_, Anchor::Start) => (rect.min.x, ""),
            (_, Anchor::Middle) => (rect.center().x, " text-anchor=\"middle\""),
            (_, Anchor::End) => (rect.max.x, " text-anchor=\"end\""),
        };
        let _ = write!(
            self.out,
            "<text x=\"{}\" y=\"{baseline}\" font-size=\"{}\"",
            number(x),
            number(text.size)
        );
        self.color("fill", text.color);
        self.out.push_str(anchor);
        if text.weight == Weight::Strong {
            self.out.push_str(" font-weight=\"600\"");
        }
        if text.fit.fills_its_place() {
            let width = number((rect.width() - 1.0).max(1.0));
            let _ = write!(self.out, " textLength=\"{width}\" lengthAdjust=\"spacingAndGlyphs\"");
        }
        // A line of an SVG has no others in it.
        let words = words.replace(['\n', '\t'], " ");
        let (before, barred) = match text.overbar {
            Some(at) => words.split_at_checked(at as usize).unwrap_or((&words, "")),
            None => (words.as_str(), ""),
        };
        let _ = write!(self.out, ">{}", escaped(before));
        if !barred.is_empty() {
            let _ = write!(self.out, "<tspan text-decoration=\"overline\">{}</tspan>", escaped(barred));
        }
        self.out.push_str("</text>\n");
    }
}

fn hex([red, green, blue]: [u8; 3]) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::list::Detail;

    #[test]
    fn numbers_are_short_and_texts_are_escaped() {
        assert_eq!([number(3.0), number(-0.5), number(2.345), number(-0.001)], ["3", "-0.5", "2.35", "0"]);
        assert_eq!(escaped("not(A<\"B\"&C>)\u{1}"), "not(A&lt;&quot;B&quot;&amp;C&gt;) ");
    }

    fn list_with(layer: u8, role: ColorRole) -> DisplayList {
        let mut list = DisplayList::new(Rect::new(0.0, 0.0, 100.0, 50.0));
        list.begin(Group { layer, ..Group::default() });
        list.circle(Point::new(5.0, 5.0), 2.0, Some(role.into()), None);
        list
    }

    #[test]
    fn lists_lie_over_each_other_by_their_layers() {
        let (low, high) = (list_with(1, ColorRole::Ask), list_with(2, ColorRole::Tell));
        let [ask, tell] = [ColorRole::Ask, ColorRole::Tell].map(|role| hex(Theme::Dark.rgb(role)));
        for lists in [[&low, &high], [&high, &low]] {
            let out = svg(&lists, Theme::Dark, "t");
            assert!(out.find(&ask) < out.find(&tell), "{out}");
        }
    }

    #[test]
    fn what_is_drawn_from_afar_only_is_not_written_and_titles_are_escaped() {
        let mut list = list_with(0, ColorRole::Ask);
        list.entitle("a < b");
        let rect = Rect::new(0.0, 0.0, 50.0, 10.0);
        list.write(Text::new("far", 10.0, rect)).at(Detail::below(0.5));
        list.write(Text { overbar: Some(2), ..Text::new("a b", 10.0, rect) });
        let out = svg(&[&list], Theme::Light, "t");
        assert!(!out.contains("far") && out.contains("<title>a &lt; b</title></circle>"));
        assert!(out.contains(">a <tspan text-decoration=\"overline\">b</tspan></text>"), "{out}");
    }

    #[test]
    fn a_hatching_takes_the_same_room_in_the_file_whatever_its_area() {
        let length = |width: f64| {
            let mut list = DisplayList::new(Rect::new(0.0, 0.0, 10_000.0, 50.0));
            let rect = Rect::new(0.0, 0.0, width, 14.0);
            list.rectangle(rect, 0.0, Some(Fill::Hatched(ColorRole::Slack.into())), None);
            svg(&[&list], Theme::Light, "t").len()
        };
        assert_eq!(length(120.0), length(920.0));
    }
}
