//! Vehicles with their own equipment, written once (SPEC 17): what models give to each of their vehicles, what groups
//! hold, and what parameters represent.
//!
//! A vehicle's own resources and states become ordinary ones with the vehicle's name before a dot, so that nothing
//! after the front end knows of models.

mod groups;
mod kinds;

use std::collections::BTreeSet;

use exact::Rational;
use smol_str::{SmolStr, format_smolstr};

use crate::diagnostic::Diagnostic;
use crate::diagnostics::{duplicate, fleet as wording, model as model_wording, recursion};
use crate::program::{
    FleetDecl, MAX_FLEET, ModelDecl, Name, Program, Property, ResourceDecl, VEHICLE_MODELS, VariableDecl,
    World,
};

pub use groups::{GroupKind, Groups};

/// What models that extend none are made from: the first if they drive, the second if they fly.
const ROVER: &str = VEHICLE_MODELS[0];
const BLIMP: &str = VEHICLE_MODELS[2];

/// Everything that is wrong with models, fleets, groups and what parameters represent, whatever is compiled.
pub fn check(program: &Program) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for model in &program.world.models {
        check_model(&program.world, model, &mut found);
    }
    found.extend(program.fleets.iter().filter_map(check_range));
    let (groups, of_groups) = Groups::new(program);
    found.extend(of_groups);
    found.extend(kinds::check(program, &groups));
    found
}

/// Gives each vehicle its own copy of its model's resources and states.
pub(crate) fn equip(program: &mut Program) {
    let World { vehicles, models, .. } = &program.world;
    if models.is_empty() {
        return;
    }
    for vehicle in vehicles {
        let own = |name: &Name| Name {
            text: format_smolstr!("{}.{}", vehicle.name.text, name.text),
            span: name.span,
        };
        let mut names = BTreeSet::new();
        for model in lineage(&program.world, &vehicle.model.text) {
            for declared in model.resources.iter().filter(|it| names.insert(&it.name.text)) {
                program.resources.push(ResourceDecl { name: own(&declared.name), ..declared.clone() });
            }
            for declared in model.states.iter().filter(|it| names.insert(&it.name.text)) {
                program.variables.push(VariableDecl { name: own(&declared.name), ..declared.clone() });
            }
        }
    }
}

/// The declared models that make up the model of this name, the outermost one first; none if it is not declared.
pub fn lineage<'world>(world: &'world World, name: &str) -> Vec<&'world ModelDecl> {
    let mut found: Vec<&ModelDecl> = Vec::new();
    let mut next = Some(name);
    while let Some(model) = next.and_then(|name| declared(world, name)) {
        if found.iter().any(|known| known.name.text == model.name.text) {
            break;
        }
        found.push(model);
        next = model.parent.as_ref().map(|parent| parent.text.as_str());
    }
    found.reverse();
    found
}

fn declared<'world>(world: &'world World, name: &str) -> Option<&'world ModelDecl> {
    world.models.iter().find(|model| model.name.text == name)
}

/// Returns whether a model is `wanted`, or extends it.
pub fn is_of(world: &World, model: &str, wanted: &str) -> bool {
    let lineage = lineage(world, model);
    let extends = |it: &&ModelDecl| {
        it.name.text == wanted || it.parent.as_ref().is_some_and(|parent| parent.text == wanted)
    };
    model == wanted || lineage.iter().any(extends)
}

/// The built-in model that a model is made from: the one that it extends at last. Without one, what flies is made from
/// the blimp, and what drives from the first rover. `None` if there is no such model.
pub fn built_in<'world>(world: &'world World, name: &'world str) -> Option<&'world str> {
    let lineage = lineage(world, name);
    let Some(outermost) = lineage.first() else { return VEHICLE_MODELS.contains(&name).then_some(name) };
    if let Some(parent) = &outermost.parent {
        return VEHICLE_MODELS.iter().copied().find(|known| *known == parent.text);
    }
    let flies = properties(&lineage).any(|property| matches!(property, Property::Flies { .. }));
    Some(if flies { BLIMP } else { ROVER })
}

/// The properties of a declared model, those of the models that it extends first: of two of a kind the later one counts.
pub fn properties<'models>(
    lineage: &'models [&'models ModelDecl],
) -> impl Iterator<Item = Property> + 'models {
    lineage.iter().flat_map(|model| &model.properties).map(|written| written.property)
}

/// The greatest speed in meters per second that a declared model says, or a model that it extends.
pub fn said_speed_mps(world: &World, model: &str) -> Option<Rational> {
    let lineage = lineage(world, model);
    let speeds = properties(&lineage).filter_map(|property| match property {
        Property::Speed { max_mps, .. } => Some(max_mps),
        _ => None,
    });
    speeds.last()
}

fn check_model(world: &World, model: &ModelDecl, found: &mut Vec<Diagnostic>) {
    let lineage = lineage(world, &model.name.text);
    // Of several with one name the first counts, which has been reported.
    if lineage.last().is_none_or(|last| !std::ptr::eq(*last, model)) {
        return;
    }
    if let Some(parent) = lineage.first().and_then(|outermost| outermost.parent.as_ref())
        && parent.text == model.name.text
    {
        let way: Vec<&str> = lineage.iter().rev().map(|model| model.name.text.as_str()).collect();
        // The circle is told once, at its first model.
        let is_first = world.models.iter().find(|it| way.contains(&it.name.text.as_str()));
        if is_first.is_some_and(|first| std::ptr::eq(first, model)) {
            found.push(recursion::models(&way, parent.span));
        }
        return;
    }
    if VEHICLE_MODELS.contains(&model.name.text.as_str()) {
        found.push(duplicate::built_in_model(&model.name));
    }
    let inherited: Vec<&Name> =
        lineage.iter().take(lineage.len() - 1).flat_map(|model| equipment(model)).collect();
    let mut own: BTreeSet<&SmolStr> = BTreeSet::new();
    for name in equipment(model) {
        if matches!(name.text.as_str(), "at" | "mode") {
            found.push(duplicate::reserved_equipment(name));
        } else if inherited.iter().any(|known| known.text == name.text) {
            found.push(duplicate::inherited_equipment(name));
        } else if !own.insert(&name.text) {
            found.push(duplicate::in_list(name, "resource or state"));
        }
    }
    check_properties(world, model, &lineage, found);
}

/// The names of a model's own resources and states.
fn equipment(model: &ModelDecl) -> impl Iterator<Item = &Name> {
    model.resources.iter().map(|it| &it.name).chain(model.states.iter().map(|it| &it.name))
}

fn check_properties(world: &World, model: &ModelDecl, lineage: &[&ModelDecl], found: &mut Vec<Diagnostic>) {
    let flies = built_in(world, &model.name.text) == Some(BLIMP)
        || properties(lineage).any(|property| matches!(property, Property::Flies { .. }));
    let is_rover = built_in(world, &model.name.text).is_some_and(|base| base != BLIMP);
    let mut words = BTreeSet::new();
    for written in &model.properties {
        let word = written.property.word();
        if !words.insert(word) {
            found.push(duplicate::property(word, written.span));
        } else if let Some(problem) = problem(written.property) {
            found.push(model_wording::impossible(problem, written.span));
        } else if matches!(written.property, Property::Flies { .. }) && is_rover {
            found.push(model_wording::flying_rover(written.span));
        } else if matches!(written.property, Property::Slope { .. }) && flies {
            found.push(model_wording::slope_of_flight(written.span));
        }
    }
}

/// The steepest slope that a model can have, in radians.
const MAX_SLOPE_RAD: f64 = std::f64::consts::FRAC_PI_3;

/// Returns what no vehicle can be, if the property says it.
fn problem(property: Property) -> Option<&'static str> {
    let is_wrong = match property {
        Property::Body { length_m, width_m } => length_m <= 0.0 || width_m <= 0.0,
        Property::Speed { min_mps, max_mps } => {
            min_mps.is_negative() || min_mps > max_mps || !max_mps.is_positive()
        }
        Property::Slope { angle_rad } => angle_rad <= 0.0 || angle_rad > MAX_SLOPE_RAD + 1e-9,
        Property::Clearance { size_m } => size_m <= 0.0,
        Property::Turning { radius_m } => radius_m <= 0.0,
        Property::Mast { height_m } => height_m < 0.0,
        Property::Flies { altitude_band_m: [low, high] } => low < 0.0 || low >= high,
    };
    is_wrong.then_some(match property {
        Property::Body { .. } => "a body must have a length and a width greater than 0",
        Property::Speed { .. } => "speeds must satisfy 0 ≤ minimum ≤ maximum, with a maximum greater than 0",
        Property::Slope { .. } => "a slope must be greater than 0 and at most 60 degrees",
        Property::Clearance { .. } => "a clearance must be greater than 0",
        Property::Turning { .. } => "a turning radius must be greater than 0",
        Property::Mast { .. } => "a mast must not be shorter than 0",
        Property::Flies { .. } => "altitudes must satisfy 0 ≤ minimum < maximum",
    })
}

fn check_range(fleet: &FleetDecl) -> Option<Diagnostic> {
    if fleet.first > fleet.last {
        return Some(wording::reversed_range(fleet));
    }
    (fleet.last - fleet.first >= MAX_FLEET).then(|| wording::long_range(fleet))
}
