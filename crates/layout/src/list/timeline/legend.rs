//! What colors and lines of a timeline mean, in one line.

use display::{
    Anchor, ColorRole, DisplayList, Fill, Fit, Group, Measure, Point, Rect, Stroke, Text,
    approximate_text_width, text_width_at,
};
use smol_str::{SmolStr, format_smolstr};

use super::{SIZES, category_role};
use crate::timeline::Chart;

/// The height of the line.
pub const LEGEND_HEIGHT: f64 = 18.0;
/// The width of a sample, from it to its word, and from a word to the next sample.
const WIDTHS: (f64, f64, f64) = (16.0, 5.0, 14.0);
/// The width of the number of categories that are left out.
const MORE_WIDTH: f64 = 26.0;

/// A piece of what is explained.
#[derive(Clone, Copy)]
enum Sample {
    Category(usize),
    Scheduled,
    Flexible,
    Contingent,
}

/// The legend in `rect`: the marks, then the categories, as many as fit, and how many more there are.
pub fn legend_list(chart: &Chart, rect: Rect) -> DisplayList {
    let mut list = DisplayList::new(rect);
    list.begin(Group { clip: Some(rect), ..Group::default() });
    let has_contingent = chart.bars.iter().any(|bar| bar.contingent().is_some());
    let has_flexible = chart.bars.iter().any(|bar| bar.start[0] < bar.start[1] || bar.end[0] < bar.end[1]);
    let marks = [
        (Sample::Scheduled, "scheduled", true),
        (Sample::Flexible, "earliest to latest start and end", has_flexible),
        (Sample::Contingent, "uncontrolled duration", has_contingent),
    ];
    let marks = marks.into_iter().filter(|it| it.2).map(|it| (it.0, SmolStr::new_static(it.1)));
    let categories = chart.legend.iter().enumerate().map(|(at, it)| (Sample::Category(at), it.name.clone()));
    let entries: Vec<(Sample, SmolStr)> = marks.chain(categories).collect();
    let measure: &dyn Measure = &approximate_text_width;
    let width_of = |words: &SmolStr| {
        WIDTHS.0 + WIDTHS.1 + (text_width_at(words, SIZES[1], measure) * 1.06).ceil() + WIDTHS.2
    };
    let mut left = rect.min.x;
    let count = entries.len();
    for (at, (sample, words)) in entries.into_iter().enumerate() {
        let width = width_of(&words);
        let reserved = if at + 1 < count { MORE_WIDTH } else { 0.0 };
        if left + width - WIDTHS.2 + reserved > rect.max.x {
            let place = Rect::new(left, rect.min.y, rect.max.x, rect.max.y);
            if place.width() >= MORE_WIDTH {
                list.write(written(format_smolstr!("+{}", count - at), place));
            }
            break;
        }
        draw(&mut list, sample, Rect::new(left, rect.min.y, left + WIDTHS.0, rect.max.y));
        let from = left + WIDTHS.0 + WIDTHS.1;
        list.write(written(words, Rect::new(from, rect.min.y, left + width - WIDTHS.2, rect.max.y)));
        left += width;
    }
    list
}

fn written(words: SmolStr, place: Rect) -> Text {
    Text::new(words, SIZES[1], place).anchored(Anchor::Start, Fit::Cut).colored(ColorRole::TextMuted)
}

fn draw(list: &mut DisplayList, sample: Sample, place: Rect) {
    let middle = place.center().y;
    let block = Rect::new(place.min.x, middle - 5.0, place.max.x, middle + 5.0);
    let mut bar = |role: ColorRole| {
        let line = Stroke::solid(role.mixed(0.85), 1.0);
        list.rectangle(block.expanded(-0.5), 2.0, Some(role.mixed(super::BODY).into()), Some(line));
    };
    match sample {
        Sample::Category(at) => bar(category_role(at)),
        Sample::Scheduled => bar(ColorRole::Slack),
        Sample::Flexible => super::whisker(
            list,
            [Point::new(place.min.x, middle), Point::new(place.max.x, middle)],
            Stroke::solid(ColorRole::TextMuted, 1.2),
        ),
        Sample::Contingent => {
            list.rectangle(block, 0.0, Some(Fill::Hatched(ColorRole::Nature.mixed(0.8))), None);
        }
    }
}
