//! Lines of sight that conditions ask for: from each place to the location that must be visible, and where the ground
//! blocks them (SPEC 10.5).

use std::collections::BTreeSet;

use glam::{Vec2, Vec3};
use tpn::Sight;

use crate::scene::{SceneInput, faded, flight_height_m, place};
use crate::shapes::Shapes;

/// The height over the ground of a mast and of what it sees, in meters, as they are drawn.
const POST_M: f32 = 2.0;

/// How a location is seen from a place.
#[derive(Clone, Copy, Debug, PartialEq)]
enum View {
    Clear,
    /// The ground there is in the way.
    Blocked(Vec2),
    /// The map does not have the height of one of the ends.
    Unknown,
}

/// Draws a clear line whole, a blocked one up to the ground that blocks it, with a cross there.
pub fn draw(shapes: &mut Shapes, input: &SceneInput<'_>) {
    let Some(network) = &input.snapshot.network else { return };
    let world = &input.snapshot.program.world;
    let position =
        |name: &str| world.locations.iter().find(|it| it.name.text == name).map(|it| place(it.position_m));
    // Vehicles that see the same from the same height are one line.
    let mut drawn = BTreeSet::new();
    for sight in &network.sights {
        let Some(target) = position(&sight.location) else { continue };
        let variable = &network.variables[sight.variable.index()];
        let vehicle =
            world.vehicles.iter().find(|it| variable.name.strip_suffix(".at") == Some(it.name.text.as_str()));
        for name in variable.values.iter().filter(|name| **name != sight.location) {
            let Some(from) = position(name) else { continue };
            let height_m =
                vehicle.and_then(|it| flight_height_m(input.ground, world, it, from)).unwrap_or(POST_M);
            let view = view(sight, name);
            if drawn.insert((&sight.location, name, height_m.to_bits(), view == View::Clear)) {
                line(shapes, input, [(from, height_m), (target, POST_M)], view);
            }
        }
    }
}

fn view(sight: &Sight, place: &str) -> View {
    match sight.hidden.iter().find(|hidden| hidden.place == *place).map(|hidden| hidden.blocked_at_m) {
        None => View::Clear,
        Some(None) => View::Unknown,
        Some(Some([east, north, _])) => View::Blocked(Vec2::new(east as f32, north as f32)),
    }
}

fn line(shapes: &mut Shapes, input: &SceneInput<'_>, ends: [(Vec2, f32); 2], view: View) {
    let palette = input.palette;
    let [from, to] = ends.map(|(place_m, height_m)| input.ground.drape(place_m, height_m));
    match view {
        View::Clear => shapes.air_line(from, to, 1.6, faded(palette.light, 0.9)),
        View::Unknown => shapes.air_line(from, to, 1.2, faded(palette.warning, 0.4)),
        View::Blocked(at_m) => {
            let at = input.ground.drape(at_m, 0.3);
            shapes.air_line(from, at, 1.6, palette.warning);
            shapes.air_line(at, to, 1.2, faded(palette.warning, 0.4));
            // A cross, so that color is not the only sign.
            let arm = 0.6 * input.options.vehicle_scale;
            for direction in [Vec3::new(arm, arm, 0.0), Vec3::new(arm, -arm, 0.0)] {
                shapes.line(at - direction, at + direction, 2.4, palette.warning);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use tpn::{Hidden, VariableId};

    use super::*;

    #[test]
    fn a_hidden_place_is_drawn_to_the_ground_that_hides_it() {
        let hidden = |place: &str, blocked_at_m| Hidden { place: place.into(), blocked_at_m };
        let sight = Sight {
            variable: VariableId(0),
            location: "BASE".into(),
            hidden: vec![hidden("CRATER", Some([4.0, 9.0, 2.0])), hidden("EDGE", None)],
        };
        assert_eq!(view(&sight, "HILL"), View::Clear);
        assert_eq!(view(&sight, "EDGE"), View::Unknown);
        assert_eq!(view(&sight, "CRATER"), View::Blocked(Vec2::new(4.0, 9.0)));
    }
}
