//! How pointer and keys move the camera.

use egui::{InputState, Key, PointerButton, Response};
use glam::{Vec2, Vec3};

use crate::camera::Camera;

const WHEEL_ZOOM: f32 = 0.0018;
const KEY_STEP: f32 = 24.0;

/// Moves the camera as pointer and keys ask, in an image of `size` points; `under` is the ground under the pointer.
pub fn update(response: &Response, camera: &mut Camera, size: Vec2, under: Option<Vec3>) {
    // Two fingers move and zoom; one of them alone would turn as well.
    let touch = response.ctx.input(InputState::multi_touch);
    if let Some(touch) = touch.filter(|touch| response.rect.contains(touch.start_pos)) {
        camera.pan(Vec2::new(touch.translation_delta.x, touch.translation_delta.y), size.y);
        if touch.zoom_delta != 1.0 && touch.zoom_delta > 0.0 {
            camera.zoom(1.0 / touch.zoom_delta);
        }
        return;
    }
    let drag = Vec2::new(response.drag_delta().x, response.drag_delta().y);
    let shift = response.ctx.input(|input| input.modifiers.shift);
    if response.dragged_by(PointerButton::Secondary)
        || response.dragged_by(PointerButton::Middle)
        || (response.dragged_by(PointerButton::Primary) && shift)
    {
        camera.pan(drag, size.y);
    } else if response.dragged_by(PointerButton::Primary) {
        camera.orbit(drag);
    }
    if response.hovered() {
        let (scroll, pinch) = response.ctx.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = if pinch == 1.0 { (-scroll * WHEEL_ZOOM).exp() } else { 1.0 / pinch };
        if factor != 1.0 {
            match under {
                Some(point_m) => camera.zoom_at(factor, point_m),
                None => camera.zoom(factor),
            }
        }
    }
    if response.has_focus() {
        response.ctx.input(|input| {
            let pressed = |key| f32::from(u8::from(input.key_pressed(key)));
            let across = pressed(Key::ArrowLeft) - pressed(Key::ArrowRight);
            let along = pressed(Key::ArrowUp) - pressed(Key::ArrowDown);
            if input.modifiers.shift {
                camera.orbit(Vec2::new(across, along) * KEY_STEP);
            } else {
                camera.pan(Vec2::new(across, along) * KEY_STEP, size.y);
            }
        });
    }
}
