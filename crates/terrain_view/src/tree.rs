//! The growth of search trees on the ground.

use glam::Vec2;
use workbench::state::growth::Standing;

use crate::ground::Ground;
use crate::scene::{SceneInput, cased_line, cased_lines, faded, place};
use crate::shapes::{Shapes, circle_outline};

/// Draws the trees as they stand, the last sample, and the best path. Of searches that race each has its color, and a
/// line of its own for its path ([`crate::dash::DASHES`]).
pub(crate) fn draw(shapes: &mut Shapes, input: &SceneInput<'_>) {
    let Some(shown) = input.growth.shown() else { return };
    let palette = input.palette;
    let is_race = shown.is_race();
    let standings: Vec<Standing> = shown.standings().collect();
    let color = |search: usize, tree: usize| {
        if is_race {
            palette.vehicles[search % palette.vehicles.len()]
        } else {
            palette.trees[tree.min(palette.trees.len() - 1)]
        }
    };
    // Where several trees grow over each other, paths have to stand out of them.
    let (width, strength) = if is_race { (1.1, 0.6) } else { (1.6, 1.0) };
    for (search, standing) in standings.iter().enumerate() {
        let pairs = || {
            let ways = standing.edges.iter();
            ways.flat_map(|(tree, way)| way.windows(2).map(|pair| (*tree, [place(pair[0]), place(pair[1])])))
        };
        // All of the dark ground first: beside short pieces it would cover their neighbors.
        for (_, ends) in pairs().filter(|_| !is_race) {
            shapes.draped_line(input.ground, ends, width + 1.8, faded(palette.under, 0.55));
        }
        for (tree, ends) in pairs() {
            shapes.draped_line(input.ground, ends, width, faded(color(search, tree), strength));
        }
        for (tree, &root) in standing.roots_m.iter().enumerate() {
            disc(shapes, input, place(root), color(search, tree));
        }
    }
    for (search, standing) in standings.iter().enumerate() {
        let path: Vec<Vec2> = standing.path_m.iter().flatten().map(|&point| place(point)).collect();
        let (lines, color_of_path) = if is_race {
            let dashes = crate::dash::DASHES[search % crate::dash::DASHES.len()];
            (crate::dash::dashed(&path, dashes, input.options.vehicle_scale), color(search, 0))
        } else {
            (path.windows(2).map(|pair| [pair[0], pair[1]]).collect(), palette.light)
        };
        cased_lines(shapes, input.ground, &lines, 3.6, color_of_path, palette.under);
        let Some(sample) = standing.sample else { continue };
        let (at, arm) = (place(sample.at_m), 0.8 * input.options.vehicle_scale);
        let color = match () {
            () if is_race => color(search, 0),
            () if sample.is_blocked => palette.warning,
            () => palette.light,
        };
        if !is_race {
            to_sample(shapes, input.ground, [place(sample.nearest_m), at], arm, color);
        }
        for side in [Vec2::new(arm, arm), Vec2::new(arm, -arm)] {
            cased_line(shapes, input.ground, [at - side, at + side], 2.4, color, palette.under);
        }
    }
}

/// The dashed line along which the nearest vertex was steered toward the sample.
fn to_sample(shapes: &mut Shapes, ground: &Ground, ends: [Vec2; 2], dash_m: f32, color: [f32; 4]) {
    for dash in crate::dash::dashed(&ends, &[1.0, 1.0], dash_m) {
        shapes.draped_line(ground, dash, 1.6, color);
    }
}

fn disc(shapes: &mut Shapes, input: &SceneInput<'_>, center_m: Vec2, color: [f32; 4]) {
    let corners = circle_outline(center_m, 0.8 * input.options.vehicle_scale);
    for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        cased_line(shapes, input.ground, [from, to], 2.4, color, input.palette.under);
    }
}
