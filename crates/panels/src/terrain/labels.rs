//! Names over the ground: on plates, so that they stay readable over light and dark ground, and never on each other.

use egui::{Color32, FontId, Painter, Rect, Stroke, StrokeKind, Vec2, vec2};
use theme::{Tokens, size};
use workbench::state::Selection;

/// A name to write.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// What it names, in the window: the place of a vehicle's image, a point of other things.
    pub around: Rect,
    pub text: String,
    pub color: Color32,
    /// How much it matters: names of the highest rank are never left out.
    pub rank: Rank,
    pub names: Selection,
}

/// How much a name matters, the most important first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    /// It is selected or under the pointer.
    Chosen,
    Vehicle,
    /// A place that the plan drives to.
    OnPath,
    /// Another place.
    Place,
    Obstacle,
}

/// Between plates, and between a plate and what it names.
const GAP: f32 = 3.0;

/// Returns where the plates of labels go: each beside what it names, inside `room`, over no other and over nothing that
/// is `taken`, such as a vehicle; `None` for names that are left out because there is no place for them. `sizes` are
/// those of the plates.
pub fn arrange(room: Rect, labels: &[Label], sizes: &[Vec2], taken: &[Rect]) -> Vec<Option<Rect>> {
    let mut order: Vec<usize> = (0..labels.len()).collect();
    order.sort_by_key(|&index| (labels[index].rank, index));
    let mut taken = taken.to_vec();
    let mut placed = vec![None; labels.len()];
    for index in order {
        let (label, Some(&size)) = (&labels[index], sizes.get(index)) else { continue };
        if !room.contains(label.around.center()) {
            continue;
        }
        let is_free = |plate: &Rect| {
            room.contains_rect(*plate) && !taken.iter().any(|other| other.expand(1.0).intersects(*plate))
        };
        let reach = if label.rank <= Rank::Vehicle { 5 } else { 1 };
        let found = (0..reach).flat_map(|ring| positions(label.around, size, ring)).find(is_free);
        if let Some(plate) = found {
            taken.push(plate);
            placed[index] = Some(plate);
        }
    }
    placed
}

/// The places for a plate around what it names, the best first; farther away in later rings.
fn positions(around: Rect, size: Vec2, ring: u32) -> [Rect; 8] {
    let away = ring as f32 * (size.y + GAP);
    let half = around.size() / 2.0;
    let (right, up) = (half.x + size.x / 2.0 + GAP + away, half.y + size.y / 2.0 + GAP + away);
    let beside = half.x + size.x / 2.0 + GAP;
    [
        vec2(0.0, -up),
        vec2(right, -up),
        vec2(-right, -up),
        vec2(right + GAP, 0.0),
        vec2(-right - GAP, 0.0),
        vec2(0.0, up + GAP),
        vec2(beside, up + GAP),
        vec2(-beside, up + GAP),
    ]
    .map(|offset| Rect::from_center_size(around.center() + offset, size))
}

/// Paints names where there is room for them, and answers the plates with what they name.
pub fn paint(
    painter: &Painter,
    tokens: &Tokens,
    room: Rect,
    labels: &[Label],
    taken: &[Rect],
) -> Vec<(Rect, Selection)> {
    let font = FontId::proportional(size::SMALL);
    let galleys: Vec<_> = labels
        .iter()
        .map(|label| painter.layout_no_wrap(label.text.clone(), font.clone(), label.color))
        .collect();
    let sizes: Vec<Vec2> = galleys.iter().map(|galley| galley.size() + vec2(10.0, 4.0)).collect();
    let plates = arrange(room, labels, &sizes, taken);
    for (label, plate) in labels.iter().zip(&plates) {
        let Some(plate) = plate else { continue };
        let from = label.around.clamp(plate.center());
        let nearest = plate.clamp(from);
        if nearest.distance(from) > 2.0 * GAP + 1.0 {
            painter.line_segment([from, nearest], Stroke::new(3.0, tokens.surface.gamma_multiply(0.7)));
            painter.line_segment([from, nearest], Stroke::new(1.0, label.color));
        }
    }
    let mut painted = Vec::new();
    for ((label, plate), galley) in labels.iter().zip(plates).zip(galleys) {
        let Some(plate) = plate else { continue };
        let is_chosen = label.rank == Rank::Chosen;
        let line = if is_chosen { label.color } else { tokens.line_strong.gamma_multiply(0.8) };
        let fill = tokens.surface.gamma_multiply(0.9);
        painter.rect(plate, 4.0, fill, Stroke::new(1.0, line), StrokeKind::Inside);
        painter.galley(plate.center() - galley.size() / 2.0, galley, label.color);
        painted.push((plate, label.names.clone()));
    }
    painted
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    fn label(x: f32, y: f32, rank: Rank) -> Label {
        let around = Rect::from_pos(pos2(x, y));
        Label { around, text: String::new(), color: Color32::WHITE, rank, names: Selection::None }
    }

    #[test]
    fn no_name_covers_another_and_the_important_ones_are_kept() {
        let room = Rect::from_min_size(pos2(0.0, 0.0), vec2(300.0, 200.0));
        let mut labels: Vec<Label> = (0..60)
            .map(|index| {
                label(20.0 + (index % 10) as f32 * 26.0, 20.0 + (index / 10) as f32 * 28.0, Rank::Place)
            })
            .collect();
        labels.push(label(150.0, 100.0, Rank::Vehicle));
        labels.push(label(152.0, 101.0, Rank::Vehicle));
        labels.push(label(151.0, 99.0, Rank::Chosen));
        let sizes = vec![vec2(60.0, 16.0); labels.len()];
        let plates = arrange(room, &labels, &sizes, &[]);
        assert!(plates[60..].iter().all(Option::is_some), "{:?}", &plates[60..]);
        let placed: Vec<Rect> = plates.into_iter().flatten().collect();
        assert!(placed.len() > 10 && placed.len() < labels.len());
        for (index, left) in placed.iter().enumerate() {
            assert!(room.contains_rect(*left));
            assert!(placed[index + 1..].iter().all(|right| !left.intersects(*right)));
        }
    }

    #[test]
    fn names_keep_clear_of_the_images_of_vehicles() {
        let room = Rect::from_min_size(pos2(0.0, 0.0), vec2(300.0, 200.0));
        let images =
            [pos2(140.0, 100.0), pos2(175.0, 104.0)].map(|at| Rect::from_center_size(at, vec2(50.0, 30.0)));
        let mut labels: Vec<Label> =
            images.map(|around| Label { around, ..label(0.0, 0.0, Rank::Vehicle) }).to_vec();
        labels.push(label(150.0, 100.0, Rank::Place));
        labels.push(label(190.0, 120.0, Rank::OnPath));
        let plates = arrange(room, &labels, &vec![vec2(60.0, 16.0); labels.len()], &images);
        assert!(plates[..2].iter().all(Option::is_some), "vehicles keep their names: {plates:?}");
        for plate in plates.iter().flatten() {
            assert!(images.iter().all(|image| !image.intersects(*plate)), "{plate:?}");
        }
    }

    #[test]
    fn a_lone_name_stands_above_what_it_names() {
        let room = Rect::from_min_size(pos2(0.0, 0.0), vec2(300.0, 200.0));
        let plates = arrange(room, &[label(150.0, 100.0, Rank::Obstacle)], &[vec2(40.0, 16.0)], &[]);
        let plate = plates[0].expect("there is room");
        assert!(plate.bottom() < 100.0 && (plate.center().x - 150.0).abs() < 0.1);
        let outside = arrange(room, &[label(350.0, 100.0, Rank::Chosen)], &[vec2(40.0, 16.0)], &[]);
        assert_eq!(outside, [None]);
    }
}
