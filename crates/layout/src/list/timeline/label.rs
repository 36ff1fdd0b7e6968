//! What is written in a bar or beside it: its name, where that covers no other bar.

use display::{Anchor, ColorRole, Fit, Rect, Text, Weight, text_width_at};
use smol_str::{SmolStr, format_smolstr};

use super::{Builder, SIZES};
use crate::timeline::before::BarChange;
use crate::timeline::{Bar, BarKind};

/// From the edges of a bar to its name, inside and beside it.
const MARGINS: (f64, f64) = (5.0, 4.0);
/// With less room than this, a name is left out rather than cut.
const MIN_CUT: f64 = 34.0;
/// How much wider than measured a name may be.
const SPARE: f64 = 1.06;

/// Where a name is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) left: f64,
    pub(super) right: f64,
    is_inside: bool,
}

/// Returns where a name of this width is written: inside its bar if it fits there, otherwise between the bar and the
/// `next` one; cut if it fits in neither. `seen` is the part of the row that is in view.
fn place(width: f64, bar: [f64; 2], next: f64, seen: [f64; 2]) -> Option<Place> {
    let inside = [bar[0].max(seen[0]) + MARGINS.0, bar[1].min(seen[1]) - MARGINS.0];
    let beside = [bar[1].max(seen[0]) + MARGINS.1, next.min(seen[1]) - MARGINS.1];
    let room = |span: [f64; 2]| span[1] - span[0];
    let is_inside = match (width <= room(inside), width <= room(beside) && bar[1] >= seen[0]) {
        (true, _) => true,
        (false, true) => false,
        (false, false) if room(inside) >= MIN_CUT.max(room(beside)) => true,
        (false, false) if room(beside) >= MIN_CUT && bar[1] >= seen[0] => false,
        (false, false) => return None,
    };
    let [left, right] = if is_inside { inside } else { beside };
    Some(Place { left, right: right.min(left + width), is_inside })
}

impl Builder<'_> {
    /// Returns where these words are written, which name what covers `rect`; something else begins at `next`.
    pub(super) fn place_of_name(&self, words: &str, rect: Rect, next: f64) -> Option<Place> {
        let width = (text_width_at(words, SIZES[1], self.measure) * SPARE).ceil();
        let seen = self.track.visible;
        place(width, [rect.min.x, rect.max.x], next, [seen.min.x, seen.max.x])
    }

    /// Writes the name of the bar at `at`, which covers `rect`; the next bar of its row begins at `next`.
    pub(super) fn name(&mut self, at: usize, bar: &Bar, rect: Rect, next: f64) {
        let is_new = self.chart.changes.get(&at) == Some(&BarChange::New);
        let words: SmolStr = match bar.kind {
            BarKind::Aborted => format_smolstr!("{} · aborted", bar.name),
            BarKind::Ask => format_smolstr!("requires {}", bar.name),
            _ if is_new => format_smolstr!("{} · new", bar.name),
            _ => bar.name.clone(),
        };
        let Some(place) = self.place_of_name(&words, rect, next) else { return };
        let role = match bar.kind {
            _ if is_new => ColorRole::Accent,
            BarKind::Delay | BarKind::Composite => ColorRole::TextMuted,
            _ if place.is_inside => ColorRole::Text,
            _ => ColorRole::TextMuted,
        };
        let weight = if is_new { Weight::Strong } else { Weight::Regular };
        let rect = Rect::new(place.left, rect.min.y, place.right, rect.max.y);
        let text = Text::new(words, SIZES[1], rect).anchored(Anchor::Start, Fit::Cut);
        self.texts.push(Text { weight, ..text.colored(role) });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEEN: [f64; 2] = [0.0, 1_000.0];

    #[test]
    fn a_name_is_inside_its_bar_or_beside_it_but_never_over_another() {
        for width in [20.0, 60.0, 140.0] {
            for length in [0.0, 8.0, 50.0, 200.0] {
                for gap in [0.0, 10.0, 60.0, 300.0] {
                    let bar = [100.0, 100.0 + length];
                    let next = bar[1] + gap;
                    let Some(Place { left, right, is_inside }) = place(width, bar, next, SEEN) else {
                        assert!(width > length - 10.0 && width > gap - 8.0, "{width} in {length}, {gap}");
                        continue;
                    };
                    let [from, to] = if is_inside { bar } else { [bar[1], next] };
                    assert!(from < left && left < right && right < to, "{width} in {length}, {gap}");
                }
            }
        }
    }

    #[test]
    fn a_name_goes_where_it_is_whole_and_is_cut_where_it_is_not() {
        let is_inside = |width, bar, next| place(width, bar, next, SEEN).map(|it| it.is_inside);
        assert_eq!(is_inside(60.0, [0.0, 100.0], 100.0), Some(true));
        assert_eq!(is_inside(60.0, [0.0, 50.0], 300.0), Some(false), "beside it there is room for all of it");
        assert_eq!(is_inside(60.0, [0.0, 50.0], 80.0), Some(true), "cut");
        assert_eq!(is_inside(60.0, [0.0, 10.0], 60.0), Some(false), "cut");
        assert_eq!(is_inside(60.0, [0.0, 20.0], 30.0), None);
        // Of a bar that begins left of what is seen, the seen part has the name.
        let place = place(60.0, [-500.0, 90.0], 100.0, SEEN).expect("there is room");
        assert_eq!((place.left, place.right), (5.0, 65.0));
    }
}
