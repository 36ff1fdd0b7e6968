//! The track of a flight rule: a thin line where the plan is held against it, hatched where it is not sure to hold, and
//! filled, with a word, where some execution breaks it.

use display::{Anchor, ColorRole, Fill, Fit, Rect, Stroke, Text, Weight};

use super::{Builder, MIN_WIDTH, SIZES};
use crate::timeline::rule::{RuleBand, RuleStanding};

/// A stretch with less room than this has nothing written in it.
const MIN_WORD: f64 = 52.0;

impl Builder<'_> {
    /// The stretches of the rule with this number, in its row.
    pub(super) fn rule(&mut self, index: usize, row: Rect) {
        let Some(rule) = self.chart.rules.get(index) else { return };
        for &RuleBand { times, standing } in &rule.bands {
            let [from, to] = times.map(|time| self.track.x(time));
            let height = if standing == RuleStanding::Applies { 3.0 } else { 13.0 };
            let middle = row.center().y;
            let place =
                Rect::new(from, middle - height / 2.0, to.max(from + MIN_WIDTH), middle + height / 2.0);
            match standing {
                RuleStanding::Applies => {
                    self.list.rectangle(place, 1.0, Some(ColorRole::Tell.mixed(0.8).into()), None);
                }
                RuleStanding::Open => {
                    let outline = Some(Stroke::solid(ColorRole::Warning, 1.0));
                    self.list.rectangle(place, 0.0, Some(Fill::Hatched(ColorRole::Warning.mixed(0.6))), None);
                    self.list.rectangle(place, 2.0, None, outline);
                }
                RuleStanding::Broken => {
                    let outline = Some(Stroke::solid(ColorRole::Error, 1.5));
                    self.list.rectangle(place, 2.0, Some(ColorRole::Error.mixed(0.25).into()), outline);
                }
            }
            self.list.entitle(format!("{}: {}", rule.name, rule.words));
            let seen = self.track.visible;
            let (left, right) = (place.min.x.max(seen.min.x) + 5.0, place.max.x.min(seen.max.x) - 3.0);
            if standing == RuleStanding::Broken && right - left >= MIN_WORD {
                let inside = Rect::new(left, place.min.y, right, place.max.y);
                let text = Text::new("broken", SIZES[1], inside).anchored(Anchor::Start, Fit::Cut);
                self.texts.push(Text { weight: Weight::Strong, ..text.colored(ColorRole::Text) });
            }
        }
    }
}
