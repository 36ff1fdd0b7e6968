//! The growth of a search tree on the ground.

use glam::Vec2;

use crate::scene::{SceneInput, cased_line, faded, place};
use crate::shapes::{Shapes, circle_outline};

/// Draws the trees as they stand, the last sample, and the best path.
pub(crate) fn draw(shapes: &mut Shapes, input: &SceneInput<'_>) {
    let Some(shown) = input.growth.shown() else { return };
    let palette = input.palette;
    let standing = shown.standing();
    let color = |tree: usize| palette.trees[tree.min(palette.trees.len() - 1)];
    for (tree, way) in &standing.edges {
        for pair in way.windows(2) {
            let ends = [place(pair[0]), place(pair[1])];
            shapes.draped_line(input.ground, ends, 3.4, faded(palette.under, 0.55));
            shapes.draped_line(input.ground, ends, 1.6, color(*tree));
        }
    }
    for (tree, &root) in standing.roots_m.iter().enumerate() {
        disc(shapes, input, place(root), color(tree));
    }
    for pair in standing.path_m.iter().flat_map(|path| path.windows(2)) {
        let ends = [place(pair[0]), place(pair[1])];
        cased_line(shapes, input.ground, ends, 3.6, palette.light, palette.under);
    }
    if let Some((sample, is_blocked)) = standing.sample {
        let (sample, arm) = (place(sample), 0.8 * input.options.vehicle_scale);
        let color = if is_blocked { palette.warning } else { palette.light };
        for side in [Vec2::new(arm, arm), Vec2::new(arm, -arm)] {
            cased_line(shapes, input.ground, [sample - side, sample + side], 2.4, color, palette.under);
        }
    }
}

fn disc(shapes: &mut Shapes, input: &SceneInput<'_>, center_m: Vec2, color: [f32; 4]) {
    let corners = circle_outline(center_m, 0.8 * input.options.vehicle_scale);
    for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        cased_line(shapes, input.ground, [from, to], 2.4, color, input.palette.under);
    }
}
