//! Slanted lines as one mesh: time that may or may not be used. Meshes are cheaper than lines, of which there are many.

use egui::{Color32, Mesh, Pos2, Rect, Vec2, pos2, vec2};

/// From one line to the next, in points.
const STEP: f32 = 6.0;
/// Half the width of a line with its soft edges.
const HALF_WIDTH: f32 = 0.95;

/// Adds lines that fill `rect` as far as it is `visible`.
pub(super) fn add(mesh: &mut Mesh, rect: Rect, visible: Rect, color: Color32) {
    let (left, right) = (rect.left().max(visible.left()), rect.right().min(visible.right()));
    let height = rect.height();
    if right <= left || height <= 0.0 || rect.bottom() < visible.top() || rect.top() > visible.bottom() {
        return;
    }
    // The lines stand still on the screen's grid, so that neighbors match and nothing crawls while bars move.
    let first = ((left - height) / STEP).floor() as i64;
    let last = (right / STEP).ceil() as i64;
    for index in first..=last {
        let foot = index as f32 * STEP;
        let (from, to) = (foot.max(left), (foot + height).min(right));
        if to > from {
            let at = |x: f32| pos2(x, rect.bottom() - (x - foot));
            line(mesh, at(from), at(to), color);
        }
    }
}

/// A line at 45 degrees that fades out on both sides.
fn line(mesh: &mut Mesh, from: Pos2, to: Pos2, color: Color32) {
    let across: Vec2 = vec2(HALF_WIDTH, HALF_WIDTH);
    let base = mesh.vertices.len() as u32;
    for (point, color) in [
        (from - across, Color32::TRANSPARENT),
        (from, color),
        (from + across, Color32::TRANSPARENT),
        (to - across, Color32::TRANSPARENT),
        (to, color),
        (to + across, Color32::TRANSPARENT),
    ] {
        mesh.colored_vertex(point, color);
    }
    for [a, b, c] in [[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]] {
        mesh.add_triangle(base + a, base + b, base + c);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_inside_what_they_fill_and_are_made_only_where_they_are_seen() {
        let rect = Rect::from_min_max(pos2(10.0, 5.0), pos2(4_000.0, 19.0));
        let visible = Rect::from_min_max(pos2(100.0, 0.0), pos2(160.0, 50.0));
        let mut mesh = Mesh::default();
        add(&mut mesh, rect, visible, Color32::WHITE);
        assert!((60..=130).contains(&mesh.vertices.len()), "{}", mesh.vertices.len());
        let soft = HALF_WIDTH + 0.01;
        for vertex in &mesh.vertices {
            assert!(rect.intersect(visible.expand2(vec2(0.0, 99.0))).expand(soft).contains(vertex.pos));
        }
        add(&mut mesh, rect, Rect::from_min_max(pos2(0.0, 30.0), pos2(90.0, 60.0)), Color32::WHITE);
        assert!(mesh.vertices.len() <= 130, "a bar below the view adds nothing");
    }
}
