//! Tables: columns share the room by what is in them, and cells are wrapped.

use egui::{Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use markdown::{Run, plain};

use super::words::{Look, layout, place};
use super::{Prose, TEXT};
use crate::space;

/// A column that wants no more than this gets it.
const MIN_WIDTH: f32 = 72.0;

/// Shows a table over the width there is. Returns the link that was clicked.
pub(super) fn show(
    ui: &mut Ui,
    prose: &Prose<'_>,
    head: &[Vec<Run>],
    rows: &[Vec<Vec<Run>>],
) -> Option<String> {
    let look = Look { size: TEXT - 1.0, is_strong: false, color: prose.tokens.text };
    let strong = Look { is_strong: true, ..look };
    let gap = space::L;
    let room = ui.available_width() - gap * head.len().saturating_sub(1) as f32;
    let wanted: Vec<f32> = (0..head.len())
        .map(|column| {
            let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| (cell, look));
            let all = std::iter::once((&head[column], strong)).chain(cells);
            all.map(|(cell, look)| layout(ui, prose, cell, look, f32::INFINITY).size().x).fold(0.0, f32::max)
        })
        .collect();
    let widths = shared(&wanted, room);
    let mut clicked = None;
    for (row, look) in std::iter::once((head, strong)).chain(rows.iter().map(|row| (row.as_slice(), look))) {
        let galleys: Vec<_> =
            row.iter().zip(&widths).map(|(cell, &width)| layout(ui, prose, cell, look, width)).collect();
        let height = galleys.iter().map(|galley| galley.size().y).fold(0.0, f32::max) + 2.0 * space::S;
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
        let text = row.iter().map(|cell| plain(cell)).collect::<Vec<_>>().join(" · ");
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &text));
        let mut x = rect.left();
        for ((cell, galley), width) in row.iter().zip(&galleys).zip(&widths) {
            clicked = place(ui, prose, cell, pos2(x, rect.top() + space::S), galley).or(clicked);
            x += width + gap;
        }
        let line = Rect::from_min_max(rect.left_bottom(), rect.right_bottom());
        ui.painter().hline(line.x_range(), line.bottom(), Stroke::new(1.0, prose.tokens.line));
    }
    clicked
}

/// Widths that fit into `room`: narrow columns keep what they want, and the others share the rest by what they want.
fn shared(wanted: &[f32], room: f32) -> Vec<f32> {
    let total: f32 = wanted.iter().sum();
    if total <= room || wanted.is_empty() {
        return wanted.to_vec();
    }
    let fair = room / wanted.len() as f32;
    let is_kept = |width: f32| width <= fair.min(MIN_WIDTH);
    let kept: f32 = wanted.iter().copied().filter(|&width| is_kept(width)).sum();
    // Roots: wide columns differ less than what is in them.
    let others: f32 = wanted.iter().copied().filter(|&width| !is_kept(width)).map(f32::sqrt).sum();
    let rest = (room - kept).max(0.0);
    wanted.iter().map(|&width| if is_kept(width) { width } else { width.sqrt() / others * rest }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_fit_into_the_room_and_narrow_ones_keep_their_width() {
        assert_eq!(shared(&[40.0, 100.0], 200.0), [40.0, 100.0]);
        let widths = shared(&[40.0, 900.0, 300.0], 400.0);
        assert_eq!(widths[0], 40.0);
        assert!((widths.iter().sum::<f32>() - 400.0).abs() < 0.01, "{widths:?}");
        for room in [120.0, 300.0, 700.0] {
            let widths = shared(&[100.0, 900.0, 300.0, 20.0], room);
            assert!(widths.iter().sum::<f32>() < room + 0.01, "{widths:?} in {room}");
        }
    }
}
