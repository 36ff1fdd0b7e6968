//! Which vehicles are interchangeable (SPEC 17): those that the mission names only in fleets and groups, with the same
//! model, place, equipment and groups.

use std::collections::{BTreeMap, BTreeSet};

use rmpl::fleet::Groups;
use rmpl::program::Program;
use serde_json::Value;
use smol_str::SmolStr;

/// Interchangeable vehicles, each list in the order of a group that has them.
pub(super) fn interchangeable(program: &Program, groups: &Groups) -> Vec<Vec<SmolStr>> {
    let of_vehicles: Vec<(&str, &[SmolStr])> = (program.fleets.iter().map(|fleet| &fleet.name))
        .chain(program.groups.iter().map(|group| &group.name))
        .filter_map(|name| Some((name.text.as_str(), groups.members(&name.text)?)))
        .collect();
    if of_vehicles.is_empty() {
        return Vec::new();
    }
    let mut member_of: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for &(group, members) in &of_vehicles {
        for member in members {
            member_of.entry(member).or_default().push(group);
        }
    }
    let named = named(program);
    let mut alike: BTreeMap<String, BTreeSet<&str>> = BTreeMap::new();
    for vehicle in &program.world.vehicles {
        let name = vehicle.name.text.as_str();
        let Some(member_of) = member_of.get(name).filter(|_| !named.contains(name)) else { continue };
        let key = (&vehicle.model.text, &vehicle.start.text, member_of, equipment(program, name));
        alike.entry(Value::from(format!("{key:?}")).to_string()).or_default().insert(name);
    }
    let alike = alike.into_values().filter(|vehicles| vehicles.len() > 1);
    let in_order = |vehicles: BTreeSet<&str>| {
        let has_all = |members: &[SmolStr]| {
            members.iter().filter(|it| vehicles.contains(it.as_str())).count() == vehicles.len()
        };
        let (_, members) = of_vehicles.iter().find(|(_, members)| has_all(members))?;
        Some(members.iter().filter(|it| vehicles.contains(it.as_str())).cloned().collect())
    };
    alike.filter_map(in_order).collect()
}

/// What a vehicle has of its own, without its name.
fn equipment(program: &Program, vehicle: &str) -> Vec<Value> {
    let own = |name: &str| name.strip_prefix(vehicle)?.strip_prefix('.').map(Value::from);
    let resources = program.resources.iter().filter_map(|resource| {
        let mut described = serde_json::to_value(resource).ok()?;
        described["name"] = own(&resource.name.text)?;
        Some(described)
    });
    let states = program.variables.iter().filter_map(|variable| {
        let mut described = serde_json::to_value(variable).ok()?;
        described["name"] = own(&variable.name.text)?;
        Some(described)
    });
    resources.chain(states).collect()
}

/// All names in a mission but in declarations of vehicles, their equipment, fleets and groups.
fn named(program: &Program) -> BTreeSet<SmolStr> {
    let is_own = |name: &str| {
        let vehicle = name.split_once('.').map(|(vehicle, _)| vehicle);
        vehicle.is_some_and(|vehicle| program.world.vehicles.iter().any(|it| it.name.text == vehicle))
    };
    let mut rest = program.clone();
    rest.world.vehicles.clear();
    rest.fleets.clear();
    rest.groups.clear();
    rest.resources.retain(|resource| !is_own(&resource.name.text));
    rest.variables.retain(|variable| !is_own(&variable.name.text));
    let mut names = BTreeSet::new();
    collect(&serde_json::to_value(&rest).unwrap_or_default(), &mut names);
    names
}

/// The names in all texts of a document.
fn collect(value: &Value, names: &mut BTreeSet<SmolStr>) {
    match value {
        Value::String(text) => {
            let is_of_name = |letter: char| letter.is_alphanumeric() || "_-[]".contains(letter);
            names.extend(text.split(|letter| !is_of_name(letter)).map(SmolStr::from));
        }
        Value::Array(items) => items.iter().for_each(|item| collect(item, names)),
        Value::Object(members) => members.values().for_each(|member| collect(member, names)),
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
}
