//! Filled polygons, convex or not, as triangles.

use egui::{Color32, Mesh, Pos2, Shape};

/// The inside of a simple polygon. Quadratic in its corners where it is not convex: ears are cut off one by one
/// (Meisters 1975).
pub(super) fn filled(corners: &[Pos2], color: Color32) -> Shape {
    let mut mesh = Mesh::default();
    for &corner in corners {
        mesh.colored_vertex(corner, color);
    }
    let turn = if area(corners) < 0.0 { -1.0 } else { 1.0 };
    let mut left: Vec<u32> = (0..corners.len() as u32).collect();
    while left.len() > 2 {
        let count = left.len();
        let around = |at: usize| [left[(at + count - 1) % count], left[at], left[(at + 1) % count]];
        let is_ear = |&at: &usize| {
            let ids = around(at);
            let [a, b, c] = ids.map(|id| corners[id as usize]);
            let others = left.iter().filter(|id| !ids.contains(id)).map(|&id| corners[id as usize]);
            turn * cross(a, b, c) >= 0.0 && others.into_iter().all(|point| !is_inside(point, [a, b, c], turn))
        };
        // A polygon that crosses itself has none; something is drawn all the same.
        let ear = (0..count).find(is_ear).unwrap_or(0);
        let [a, b, c] = around(ear);
        mesh.add_triangle(a, b, c);
        left.remove(ear);
    }
    Shape::mesh(mesh)
}

/// Twice the area of a triangle; negative if its corners go round the other way.
fn cross(a: Pos2, b: Pos2, c: Pos2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

fn area(corners: &[Pos2]) -> f32 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(one, other)| one.x * other.y - other.x * one.y).sum()
}

fn is_inside(point: Pos2, [a, b, c]: [Pos2; 3], turn: f32) -> bool {
    [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| turn * cross(from, to, point) > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn triangles_fill_a_polygon_with_a_bay_and_not_the_bay() {
        let corners = [pos2(0.0, 0.0), pos2(10.0, 0.0), pos2(10.0, 10.0), pos2(5.0, 2.0), pos2(0.0, 10.0)];
        for turned in [false, true] {
            let mut corners = corners.to_vec();
            if turned {
                corners.reverse();
            }
            let Shape::Mesh(mesh) = filled(&corners, Color32::WHITE) else { panic!("a mesh") };
            let triangles = mesh.indices.chunks(3).map(|ids| {
                let [a, b, c] = [0, 1, 2].map(|at| corners[ids[at] as usize]);
                cross(a, b, c).abs() / 2.0
            });
            let total: f32 = triangles.sum();
            assert!((total - area(&corners).abs() / 2.0).abs() < 1e-3, "{total}");
            assert_eq!(mesh.indices.len(), 9);
        }
    }
}
