//! The track of a variable that keeps its value: its values side by side, hatched while it changes, and below them a
//! strip for each thing that needs it.

use std::ops::Range;

use display::{Anchor, ColorRole, Fill, Fit, Rect, Stroke, TargetKind, Text};

use super::{Builder, MIN_WIDTH, SIZES};
use crate::timeline::{Bar, BarKind, state};

impl Builder<'_> {
    /// A bar of a state track.
    pub(super) fn state_bar(&mut self, at: usize, bar: &Bar, row: Rect, bars: &Range<usize>) {
        let Some(label) = bar.label else { return };
        let place = self.track.bar(bar, row);
        let role = super::bar_role(bar);
        let (color, width) = self.outline(at, bar, role);
        let outline = Some(Stroke::solid(color, width));
        match bar.kind {
            BarKind::Need => self.list.rectangle(place, 1.0, Some(color.into()), None),
            _ if place.width() < MIN_WIDTH => {
                let middle = place.center().x;
                let half = MIN_WIDTH / 2.0;
                let mark = Rect::new(middle - half, place.min.y, middle + half, place.max.y);
                self.list.rectangle(mark, 1.0, Some(role.mixed(0.75).into()), None)
            }
            BarKind::Changing => {
                self.list.rectangle(place, 0.0, Some(role.mixed(0.06).into()), None);
                self.list.rectangle(place, 0.0, Some(Fill::Hatched(role.mixed(0.6))), None);
                self.list.rectangle(place.expanded(-width / 2.0), 2.0, None, outline)
            }
            _ => {
                let fill = Some(role.mixed(0.24).into());
                self.list.rectangle(place.expanded(-width / 2.0), 3.0, fill, outline)
            }
        }
        .stands_for(TargetKind::Label, label.0);
        self.list.entitle(state::words(self.network, self.plan, bar).join("; "));
        if bar.kind == BarKind::Value {
            let mut after = self.chart.bars[at + 1..bars.end].iter();
            let next = after.find(|next| next.kind != BarKind::Need);
            let next = next.map_or(f64::INFINITY, |next| self.track.bar(next, row).min.x);
            if let Some(it) = self.place_of_name(&bar.name, place, next) {
                let place = Rect::new(it.left, place.min.y, it.right, place.max.y);
                let text = Text::new(bar.name.clone(), SIZES[1], place).anchored(Anchor::Start, Fit::Cut);
                self.texts.push(text.colored(ColorRole::Text));
            }
        }
    }
}
