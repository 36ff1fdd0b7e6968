//! Levels of detail: a quadtree over the map whose leaves are patches of equal vertex count, finer near the eye.

use glam::{Mat4, Vec3, Vec4};

use crate::ground::Ground;

/// Quads along the side of a patch.
pub const PATCH_QUADS: u32 = 32;

/// A patch to draw: its first cell, and how many cells apart its vertices are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patch {
    /// First column and row.
    pub cell: [u32; 2],
    /// Cells between vertices, a power of two.
    pub stride: u32,
}

/// The patches to draw from `eye_m`, those outside the image left out. `refinement` is how many times its own side
/// length a patch must be away to be drawn whole: larger is finer.
pub fn patches(ground: &Ground, eye_m: Vec3, clip_from_world: &Mat4, refinement: f32) -> Vec<Patch> {
    let mut stride = 1;
    while PATCH_QUADS * stride < ground.width.max(ground.height) {
        stride *= 2;
    }
    let mut found = Vec::new();
    let mut pending = vec![Patch { cell: [0, 0], stride }];
    while let Some(patch) = pending.pop() {
        let (low, high) = bounds(ground, patch);
        if patch.cell[0] + 1 >= ground.width || patch.cell[1] + 1 >= ground.height {
            continue;
        }
        if outside(clip_from_world, low, high) {
            continue;
        }
        let side_m = (PATCH_QUADS * patch.stride) as f32 * ground.cell_m;
        let away_m = eye_m.distance(eye_m.clamp(low, high));
        if patch.stride == 1 || away_m > side_m * refinement {
            found.push(patch);
            continue;
        }
        let half = patch.stride / 2;
        let step = PATCH_QUADS * half;
        for (east, north) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let cell = [patch.cell[0] + east * step, patch.cell[1] + north * step];
            pending.push(Patch { cell, stride: half });
        }
    }
    found
}

fn bounds(ground: &Ground, patch: Patch) -> (Vec3, Vec3) {
    let at = |index: usize, extra: u32| {
        let limit = if index == 0 { ground.width } else { ground.height };
        let cell = (patch.cell[index] + extra).min(limit.saturating_sub(1));
        ground.origin_m[index] + cell as f32 * ground.cell_m
    };
    let side = PATCH_QUADS * patch.stride;
    (Vec3::new(at(0, 0), at(1, 0), ground.range_m[0]), Vec3::new(at(0, side), at(1, side), ground.range_m[1]))
}

/// Returns whether all corners of a box lie outside the same side of the image.
fn outside(clip_from_world: &Mat4, low: Vec3, high: Vec3) -> bool {
    let corners: [Vec4; 8] = std::array::from_fn(|index| {
        let pick = |bit: usize, axis: usize| if index >> bit & 1 == 1 { high[axis] } else { low[axis] };
        *clip_from_world * Vec4::new(pick(0, 0), pick(1, 1), pick(2, 2), 1.0)
    });
    let all = |test: &dyn Fn(&Vec4) -> bool| corners.iter().all(test);
    all(&|c| c.x < -c.w)
        || all(&|c| c.x > c.w)
        || all(&|c| c.y < -c.w)
        || all(&|c| c.y > c.w)
        || all(&|c| c.w < 0.0)
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::camera::Camera;

    #[test]
    fn patches_cover_every_cell_in_view_once() {
        let ground = Ground::new(200, 130, 1.0, Vec2::ZERO, &vec![0.0; 200 * 130]);
        let camera = Camera::overview(ground.center_m(), 400.0);
        let found = patches(&ground, Vec3::new(20.0, 20.0, 5.0), &camera.clip_from_world(1.5), 1.5);
        let mut covered = vec![0_u8; 200 * 130];
        for patch in &found {
            let side = PATCH_QUADS * patch.stride;
            for row in patch.cell[1]..(patch.cell[1] + side).min(130) {
                for column in patch.cell[0]..(patch.cell[0] + side).min(200) {
                    covered[(row * 200 + column) as usize] += 1;
                }
            }
        }
        assert!(covered.iter().all(|&count| count == 1));
        assert!(found.iter().any(|patch| patch.stride == 1) && found.iter().any(|patch| patch.stride > 1));
    }
}
