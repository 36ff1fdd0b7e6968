//! Where the bars of another plan were: a dashed outline behind what has moved, a word beside what is new, and a dashed
//! bar with a line through its name for what is gone.

use display::{Anchor, ColorRole, Dash, Fit, Point, Rect, Stroke, Text, Weight};

use super::{BAR_EDGES, Builder, MIN_WIDTH, SIZES};
use crate::timeline::before::{BarChange, Gone};
use crate::timeline::scheduled;

impl Builder<'_> {
    /// What differs of the bar at `at`, which is at `place`, in a row that it may have alone.
    pub(super) fn change(&mut self, at: usize, place: Rect, row: Rect, is_alone: bool) {
        match self.chart.changes.get(&at) {
            Some(BarChange::Moved(times)) => {
                let words = format!("{}: {}", self.chart.origin.word(), words(*times));
                self.former(*times, row, &words);
            }
            // In a row with others, the bar's name says that it is new.
            Some(BarChange::New) if is_alone => {
                let left = place.max.x + 4.0;
                let beside = Rect::new(left, row.min.y, left + 30.0, row.max.y);
                let text = Text::new("new", SIZES[1], beside).anchored(Anchor::Start, Fit::Overflow);
                self.texts.push(Text { weight: Weight::Strong, ..text.colored(ColorRole::Accent) });
            }
            Some(BarChange::New) | None => {}
        }
    }

    /// The bar of something that is gone.
    pub(super) fn gone(&mut self, index: usize, row: Rect) {
        let Some(Gone { name, times }) = self.chart.gone.get(index) else { return };
        let (origin, words) = (self.chart.origin.word(), words(*times));
        self.former(*times, row, &format!("{name}: removed from the plan; {origin}: {words}"));
        let middle = row.min.y + BAR_EDGES.iter().sum::<f64>() / 2.0;
        let [from, to] = scheduled(*times).map(|time| self.track.x(time));
        let line = Stroke::solid(ColorRole::TextMuted, 1.0);
        self.list.line(Point::new(from, middle), Point::new(to.max(from + MIN_WIDTH), middle), line);
    }

    fn former(&mut self, times: [[f64; 2]; 2], row: Rect, words: &str) {
        let [from, to] = scheduled(times).map(|time| self.track.x(time));
        let [top, bottom] = BAR_EDGES.map(|edge| row.min.y + edge);
        let place = Rect::new(from, top - 1.0, to.max(from + MIN_WIDTH), bottom + 1.0);
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
