//! What vehicles see over the ground of a mission: the conditions `V.at in visible(L)` (SPEC 10.5).

use nalgebra::Point2;
use rmpl::program::{ArgumentValue, Condition, LocationDecl, Program, Statement, StatementKind, World};
use terrain::{LineOfSight, Terrain};
use tpn::Hidden;

use crate::evaluated::Ground;
use crate::ground::Grounds;

/// How high what has to be in sight is over the ground at its location, in meters.
const TARGET_M: f64 = 2.0;

/// The ground of a mission, if a condition asks what is in sight and a terrain is declared: without one, everything is.
pub(crate) fn ground(program: &Program, grounds: &mut Grounds) -> Option<Ground> {
    if program.world.terrain.is_none() || !asks(program) {
        return None;
    }
    grounds.resolve(program).0
}

/// Returns whether a condition asks what is in sight.
fn asks(program: &Program) -> bool {
    let is_sight = |condition: &Condition| condition.sees.is_some();
    let mut is_asked = program
        .primitives
        .iter()
        .flat_map(|primitive| &primitive.requires)
        .any(|required| is_sight(&required.condition));
    let mut visit = |statement: &Statement| {
        is_asked |= match &statement.kind {
            StatementKind::Maintaining(_, condition)
            | StatementKind::Watching(_, condition)
            | StatementKind::Telling(_, condition)
            | StatementKind::IfThennext(condition, _)
            | StatementKind::Condition(_, condition) => is_sight(condition),
            StatementKind::Call(_, arguments) => arguments.iter().any(
                |argument| matches!(&argument.value, ArgumentValue::Condition(condition) if is_sight(condition)),
            ),
            _ => false,
        };
    };
    program.activities.iter().for_each(|activity| activity.body.for_each(&mut visit));
    program.scenarios.iter().for_each(|scenario| scenario.body.for_each(&mut visit));
    is_asked
}

/// The vehicles of a world on its map.
pub(crate) struct Seeing<'a> {
    world: &'a World,
    map: &'a Terrain,
}

impl<'a> Seeing<'a> {
    pub(crate) const fn new(world: &'a World, map: &'a Terrain) -> Self {
        Self { world, map }
    }

    /// Returns why a location is hidden from a place of a vehicle, if it is. A place sees itself.
    fn hidden_from(
        &self,
        model: &motion::VehicleModel,
        place: &LocationDecl,
        target: &LocationDecl,
    ) -> Option<Hidden> {
        if place.name.text == target.name.text {
            return None;
        }
        let blocked_at_m = match self.line_of_sight(model, place.position_m.into(), target) {
            None => None,
            Some(sight) => Some(sight.blocked_at_m?.into()),
        };
        Some(Hidden { place: place.name.text.clone(), blocked_at_m })
    }

    /// Returns what is between a vehicle at a place and a location; `None` if one of the two has no height.
    fn line_of_sight(
        &self,
        model: &motion::VehicleModel,
        from_m: Point2<f64>,
        target: &LocationDecl,
    ) -> Option<LineOfSight> {
        let heights_m = [model.antenna_m(self.map, self.map.height_at(from_m)?), TARGET_M];
        self.map.line_of_sight(from_m, target.position_m.into(), heights_m)
    }

    /// Returns whether a vehicle sees a location from a place; `None` if a height or a name is not known.
    pub(crate) fn sees(&self, vehicle: &str, from_m: Point2<f64>, location: &str) -> Option<bool> {
        let (model, target) = self.found(vehicle, location)?;
        Some(self.line_of_sight(&model, from_m, target)?.blocked_at_m.is_none())
    }

    fn found(&self, vehicle: &str, location: &str) -> Option<(motion::VehicleModel, &LocationDecl)> {
        let vehicle = self.world.vehicles.iter().find(|it| it.name.text == vehicle)?;
        let model = snapshot::vehicle::model(self.world, &vehicle.model.text)?;
        Some((model, self.world.locations.iter().find(|it| it.name.text == location)?))
    }
}

impl tpn::Ground for Seeing<'_> {
    fn hidden(&self, vehicle: &str, location: &str) -> Vec<Hidden> {
        let Some((model, target)) = self.found(vehicle, location) else { return Vec::new() };
        let places = self.world.locations.iter();
        places.filter_map(|place| self.hidden_from(&model, place, target)).collect()
    }
}
