//! Texts of a drawing, and how wide they are where no fonts are at hand.

use smol_str::SmolStr;

use crate::color::{Color, ColorRole};
use crate::geometry::Rect;

/// A text in the place that is reserved for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    pub text: SmolStr,
    /// Its size in drawing units.
    pub size: f64,
    /// Where it is: centered in the height, and in the width as [`Text::anchor`] says.
    pub rect: Rect,
    /// Where in the width.
    pub anchor: Anchor,
    /// How heavy it is.
    pub weight: Weight,
    /// What becomes of it where its place is too narrow.
    pub fit: Fit,
    pub color: Color,
    /// A plate behind it, which keeps what passes below from disturbing it.
    pub plate: Option<Color>,
    /// From this byte on there is a bar over it.
    pub overbar: Option<u32>,
    /// Present for a name that keeps a legible size where the drawing is small: the room that it may then take, in
    /// drawing units. It is left out where others are in its way.
    pub legible: Option<f64>,
    /// Present if the text may be moved along its line to stay in view.
    pub slide: Option<Slide>,
    /// Present if the text is the heading of an area: on the screen it keeps its size and is in the upper left corner
    /// of what is seen of the area, if that has room for it.
    pub heading: Option<Rect>,
}

/// Which part of a text lies on the same part of its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Anchored at the left end of the text.
    Start,
    /// Anchored at the middle of the text.
    Middle,
    /// Its right end.
    End,
}

/// How heavy a text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    Regular,
    Strong,
}

/// What becomes of a text that is wider than its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// It is made narrower. A layout that measured it fills the place with it, whatever the reader's fonts are.
    Shrink,
    /// It is made narrower, and left out where it would have to be cut to be read: half of a number is another number.
    Unabridged,
    /// It is cut, with an ellipsis.
    Cut,
    /// It stays as it is.
    Overflow,
}

impl Fit {
    /// Returns whether a text fills the place that was measured for it.
    pub const fn fills_its_place(self) -> bool {
        matches!(self, Self::Shrink | Self::Unabridged)
    }
}

/// How far a text may be moved along a long line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slide {
    /// The left edge and the width of the row that the text is part of.
    pub row: (f64, f64),
    /// The least and greatest left edge that the row may have.
    pub limits: (f64, f64),
}

impl Text {
    /// A text that fills `rect`, in its usual color.
    pub fn new(text: impl Into<SmolStr>, size: f64, rect: Rect) -> Self {
        Self {
            text: text.into(),
            size,
            rect,
            anchor: Anchor::Middle,
            weight: Weight::Regular,
            fit: Fit::Shrink,
            color: ColorRole::Text.into(),
            plate: None,
            overbar: None,
            legible: None,
            slide: None,
            heading: None,
        }
    }

    /// The same text in another color.
    pub fn colored(self, color: impl Into<Color>) -> Self {
        Self { color: color.into(), ..self }
    }

    /// The same text, anchored so and never shrunk: `fit` says what happens instead.
    pub fn anchored(self, anchor: Anchor, fit: Fit) -> Self {
        Self { anchor, fit, ..self }
    }

    /// Returns where the text is when its row is moved, as far as it may be, between `left` and `right`.
    pub fn rect_in_view(&self, left: f64, right: f64) -> Rect {
        self.slide.map_or(self.rect, |slide| slide.moved(self.rect, left, right))
    }

    /// Everything that the text may cover.
    pub fn bounds(&self) -> Rect {
        if let Some(area) = self.heading {
            return area;
        }
        let Some(slide) = self.slide else { return self.rect };
        let [least, most] = [slide.limits.0, slide.limits.1].map(|left| left - slide.row.0);
        Rect { min: self.rect.min.shifted(least, 0.0), max: self.rect.max.shifted(most, 0.0) }
    }
}

impl Slide {
    /// `rect`, which is part of the row, when the row is moved between `left` and `right` as far as it may be.
    pub fn moved(self, rect: Rect, left: f64, right: f64) -> Rect {
        let (row, width) = self.row;
        let wanted = row.min(right - width).max(left).clamp(self.limits.0, self.limits.1);
        let moved = wanted - row;
        Rect { min: rect.min.shifted(moved, 0.0), max: rect.max.shifted(moved, 0.0) }
    }
}

/// The text size that a [`Measure`] answers for; other sizes are in proportion.
pub const TEXT_SIZE: f64 = 13.0;

/// Knows how wide texts are.
pub trait Measure {
    /// The width of `text` at [`TEXT_SIZE`].
    fn width(&self, text: &str) -> f32;
}

impl<F: Fn(&str) -> f32> Measure for F {
    fn width(&self, text: &str) -> f32 {
        self(text)
    }
}

/// The width of a text at `size`.
pub fn text_width_at(text: &str, size: f64, measure: &dyn Measure) -> f64 {
    f64::from(measure.width(text)) * size / TEXT_SIZE
}

/// `text`, or as much of it as is no wider than `longest`, with an ellipsis.
pub fn cut_to_width(text: &str, longest: f64, width_of: impl Fn(&str) -> f64) -> SmolStr {
    let mut width = width_of(text);
    let mut kept = text.chars().count();
    let mut cut = SmolStr::new(text);
    while width > longest && kept > 1 {
        kept = ((kept as f64 * longest / width) as usize).clamp(1, kept - 1);
        cut = text.chars().take(kept).chain(['…']).collect();
        width = width_of(&cut);
    }
    cut
}

/// Advance widths of the characters from space to tilde in thousandths of the text size, in the page's own face
/// (Inter).
#[rustfmt::skip]
const CHARACTER_WIDTHS: [u16; 95] = [
    281, 278, 403, 631, 638, 812, 639, 222, 362, 362, 500, 659, 280, 460, 276, 357,
    625, 464, 605, 636, 642, 608, 624, 571, 616, 624, 276, 280, 659, 659, 659, 507,
    936, 676, 651, 727, 719, 598, 587, 743, 740, 264, 543, 652, 562, 889, 753, 761,
    635, 761, 639, 638, 642, 741, 676, 949, 642, 665, 625, 362, 357, 362, 469, 452,
    497, 564, 621, 558, 621, 582, 361, 609, 591, 237, 237, 544, 237, 869, 585, 597,
    609, 609, 372, 523, 364, 581, 557, 812, 540, 557, 541, 362, 327, 362, 659,
];

/// The width of `text` at [`TEXT_SIZE`] in the page's face, with some room for faces that are a little wider.
///
/// It needs no fonts and is the same everywhere, so pictures are too.
pub fn approximate_text_width(text: &str) -> f32 {
    let thousandths: u32 = text.chars().map(|character| u32::from(character_width(character))).sum();
    thousandths as f32 / 1000.0 * 1.02 * TEXT_SIZE as f32
}

fn character_width(character: char) -> u16 {
    let ascii = (character as u32).checked_sub(u32::from(b' ')).map(|at| at as usize);
    match ascii.and_then(|at| CHARACTER_WIDTHS.get(at)) {
        Some(&width) => width,
        None if character == '·' => 276,
        None if character == '∞' => 930,
        None if matches!(character, '¬' | '≥' | '≤' | '…') || character.is_alphabetic() => 700,
        None => 1000,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_cut_to_its_room_and_no_further() {
        let width_of = |text: &str| text_width_at(text, 12.0, &approximate_text_width);
        let cut = cut_to_width("Group-Traverse-Path#1", 60.0, width_of);
        assert!(cut.ends_with('…') && width_of(&cut) <= 60.0 && cut.chars().count() > 5, "{cut}");
        assert_eq!(cut_to_width("short", 60.0, width_of), "short");
        assert_eq!(cut_to_width("ab", 0.0, width_of), "a…", "something is always left");
    }

    #[test]
    fn a_sliding_text_stays_in_view_as_far_as_its_line_goes() {
        let rect = Rect::new(50.0, 0.0, 70.0, 10.0);
        let slide = Slide { row: (50.0, 20.0), limits: (0.0, 100.0) };
        let text = Text { slide: Some(slide), ..Text::new("x", 10.0, rect) };
        assert_eq!(text.rect_in_view(80.0, 200.0).min.x, 80.0);
        assert_eq!(text.rect_in_view(500.0, 900.0).min.x, 100.0);
        assert_eq!(text.rect_in_view(0.0, 1000.0), rect);
        assert_eq!(text.bounds(), Rect::new(0.0, 0.0, 120.0, 10.0));
    }
}
