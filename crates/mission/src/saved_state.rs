//! The state at the end of a run as a document, and missions that start from it (SPEC 17): values of states, levels of
//! reservoirs, and where vehicles are.

use std::collections::BTreeMap;

use exact::Rational;
use executive::{Happening, RunOutcome};
use rmpl::Span;
use rmpl::program::{Expr, ExprKind, LocationDecl, Name, Program, ResourceDecl, Supply};
use serde::{Deserialize, Serialize};
use smol_str::{SmolStr, format_smolstr};
use snapshot::SimulatedDrive;
use tpn::OccurrenceKind;

/// Values, levels and places, by name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedState {
    /// Of states that are not read from the plant.
    #[serde(default)]
    pub states: BTreeMap<SmolStr, SmolStr>,
    /// Of reservoirs.
    #[serde(default)]
    pub levels: BTreeMap<SmolStr, Rational>,
    #[serde(default)]
    pub places: BTreeMap<SmolStr, Place>,
}

/// Where a vehicle is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Place {
    Location(SmolStr),
    /// Between locations: meters east and north.
    Position([f64; 2]),
}

impl SavedState {
    /// The state at the end of a run. The error names what is still under way or not known then.
    pub fn at_end(
        outcome: &RunOutcome,
        drives: &[SimulatedDrive],
        program: &Program,
    ) -> Result<Self, String> {
        let last = outcome.last();
        let under_way = last.network.occurrences.iter().find(|it| {
            let has_come = |node: tpn::NodeId| last.times[node.index()].is_some();
            it.kind == OccurrenceKind::Primitive && has_come(it.start) && !has_come(it.end)
        });
        if let Some(activity) = under_way {
            return Err(format!("{} is in progress at the end of the run", activity.name));
        }
        let world = &program.world;
        let states = program.variables.iter().filter(|it| !it.is_from_plant);
        let initial =
            states.clone().filter_map(|it| Some((it.name.text.clone(), it.initial.as_ref()?.text.clone())));
        let starts = world.vehicles.iter().map(|it| (place_variable(&it.name.text), it.start.text.clone()));
        let mut values: BTreeMap<SmolStr, SmolStr> = initial.chain(starts).collect();
        let mut levels: BTreeMap<SmolStr, Rational> = BTreeMap::new();
        for resource in &outcome.plans[0].network.resources {
            if let tpn::Supply::Reservoir { level, .. } = resource.supply {
                levels.insert(resource.name.clone(), level);
            }
        }
        for entry in &outcome.log {
            match &entry.happening {
                Happening::State { variable, value: Some(value), .. } => {
                    values.insert(variable.clone(), value.clone());
                }
                Happening::State { variable, value: None, .. } => {
                    values.remove(variable);
                }
                Happening::Level { resource, level, .. } => {
                    if let Some(known) = levels.get_mut(resource) {
                        *known = *level;
                    }
                }
                _ => {}
            }
        }
        let mut saved = Self { levels, ..Self::default() };
        for declared in states.filter(|it| it.initial.is_some()) {
            let name = &declared.name.text;
            let value =
                values.remove(name).ok_or_else(|| format!("`{name}` is changing at the end of the run"))?;
            saved.states.insert(name.clone(), value);
        }
        for (index, vehicle) in world.vehicles.iter().enumerate() {
            let name = &vehicle.name.text;
            let location = values.remove(&place_variable(name));
            let is_declared = |it: &SmolStr| world.locations.iter().any(|location| location.name.text == *it);
            let place = match location.filter(is_declared) {
                Some(location) => Place::Location(location),
                None => position(drives, index)
                    .map(Place::Position)
                    .ok_or_else(|| format!("the run does not tell where `{name}` is at its end"))?,
            };
            saved.places.insert(name.clone(), place);
        }
        Ok(saved)
    }

    /// Returns what the mission does not declare, in words.
    pub fn undeclared(&self, program: &Program) -> Option<String> {
        for (name, value) in &self.states {
            let declared = program.variables.iter().find(|it| it.name.text == *name);
            let Some(declared) = declared.filter(|it| it.initial.is_some() && !it.is_from_plant) else {
                return Some(format!("the mission declares no state `{name}`"));
            };
            if declared.values.iter().all(|it| it.text != *value) {
                return Some(format!("`{value}` is not a value of `{name}`"));
            }
        }
        for name in self.levels.keys() {
            let is_it =
                |it: &ResourceDecl| it.name.text == *name && matches!(it.supply, Supply::Reservoir { .. });
            if !program.resources.iter().any(is_it) {
                return Some(format!("the mission declares no reservoir `{name}`"));
            }
        }
        for (name, place) in &self.places {
            if program.world.vehicles.iter().all(|it| it.name.text != *name) {
                return Some(format!("the mission declares no vehicle `{name}`"));
            }
            match place {
                Place::Location(location)
                    if program.world.locations.iter().all(|it| it.name.text != *location) =>
                {
                    return Some(format!("the mission declares no location `{location}`"));
                }
                Place::Position(position) if !position.iter().all(|it| it.is_finite()) => {
                    return Some(format!("the position of `{name}` is not finite"));
                }
                _ => {}
            }
        }
        None
    }

    /// Lets a mission start from this state. Names that the mission does not declare are ignored.
    pub fn begin(&self, program: &mut Program) {
        for declared in program.variables.iter_mut().filter(|it| !it.is_from_plant) {
            if let (Some(initial), Some(value)) =
                (&mut declared.initial, self.states.get(&declared.name.text))
            {
                initial.text = value.clone();
            }
        }
        for declared in &mut program.resources {
            if let (Supply::Reservoir { level, .. }, Some(&saved)) =
                (&mut declared.supply, self.levels.get(&declared.name.text))
            {
                *level = Expr { kind: ExprKind::Number(saved), span: level.span };
            }
        }
        let world = &mut program.world;
        for vehicle in &mut world.vehicles {
            match self.places.get(&vehicle.name.text) {
                None => {}
                Some(Place::Location(location)) => vehicle.start.text = location.clone(),
                Some(&Place::Position(position_m)) => {
                    let mut text = format_smolstr!("{}-start", vehicle.name.text);
                    while world.locations.iter().any(|it| it.name.text == text) {
                        text = format_smolstr!("{text}-start");
                    }
                    vehicle.start.text = text.clone();
                    let span = Span::default();
                    let name = Name { text, span };
                    world.locations.push(LocationDecl { name, position_m, numbers_span: span, span });
                }
            }
        }
    }
}

/// The variable of a vehicle's place.
fn place_variable(vehicle: &str) -> SmolStr {
    format_smolstr!("{vehicle}.at")
}

/// Returns where the vehicle with this index was when its last drive ended.
fn position(drives: &[SimulatedDrive], vehicle: usize) -> Option<[f64; 2]> {
    let driven = drives.iter().flat_map(|drive| &drive.vehicles).filter(|it| it.vehicle as usize == vehicle);
    let frames = driven.filter_map(|it| it.frames.last());
    let last = frames.max_by(|one, other| one.time.total_cmp(&other.time))?;
    Some([last.position_m.x, last.position_m.y])
}
