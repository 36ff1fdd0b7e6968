//! Where the bars of another plan were: a dashed outline behind what has moved, a word beside what is new, and a dashed
//! bar with a line through its name for what is gone.

use display::{Anchor, ColorRole, Dash, Fit, Point, Rect, Stroke, Text, Weight};

use super::{Builder, MIN_WIDTH, SIZES};
use crate::timeline::before::{BarChange, Gone};

impl Builder<'_> {
    /// What differs of the bar at `at`, which is at `place`.
    pub(super) fn change(&mut self, at: usize, place: Rect, row: Rect) {
        match self.chart.changes.get(&at) {
            Some(BarChange::Moved(times)) => {
                let words = format!("approved: {}", words(*times));
                self.former(*times, row, &words);
            }
            Some(BarChange::New) => {
                let left = place.max.x + 4.0;
                let beside = Rect::new(left, row.min.y, left + 30.0, row.max.y);
                let text = Text::new("new", SIZES[1], beside).anchored(Anchor::Start, Fit::Overflow);
                self.list.write(Text { weight: Weight::Strong, ..text.colored(ColorRole::Accent) });
            }
            None => {}
        }
    }

    /// The bar of something that is gone.
    pub(super) fn gone(&mut self, index: usize, row: Rect) {
        let Some(Gone { name, times }) = self.chart.gone.get(index) else { return };
        self.former(*times, row, &format!("{name}: removed from the plan; approved: {}", words(*times)));
        let middle = row.center().y;
        let [from, to] = [times[0][0], times[1][1]].map(|time| self.track.x(time));
        let line = Stroke::solid(ColorRole::TextMuted, 1.0);
        self.list.line(Point::new(from, middle), Point::new(to.max(from + MIN_WIDTH), middle), line);
    }

    fn former(&mut self, times: [[f64; 2]; 2], row: Rect, words: &str) {
        let [from, to] = [times[0][0], times[1][1]].map(|time| self.track.x(time));
        let place = Rect::new(from, row.min.y + 3.0, to.max(from + MIN_WIDTH), row.max.y - 3.0);
        let dashed = Stroke::solid(ColorRole::TextMuted, 1.2).dashed(Dash::Dashed);
        self.list.rectangle(place, 3.0, None, Some(dashed));
        self.list.entitle(words.to_owned());
    }
}

/// When something could start and end.
fn words([start, end]: [[f64; 2]; 2]) -> String {
    let text = |[from, to]: [f64; 2]| {
        let rounded = |time: f64| (time * 1000.0).round() / 1000.0;
        if from == to {
            format!("{}", rounded(from))
        } else {
            format!("{} to {}", rounded(from), rounded(to))
        }
    };
    format!("start {}, end {}", text(start), text(end))
}
