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
    let mut equipment = equipment(program);
    let mut alike: BTreeMap<_, BTreeSet<&str>> = BTreeMap::new();
    for vehicle in &program.world.vehicles {
        let name = vehicle.name.text.as_str();
        let Some(member_of) = member_of.get(name).filter(|_| !named.contains(name)) else { continue };
        let own = equipment.remove(name).unwrap_or_default();
        alike.entry((&vehicle.model.text, &vehicle.start.text, member_of, own)).or_default().insert(name);
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

/// Returns what each vehicle has of its own, without its name, as text.
fn equipment(program: &Program) -> BTreeMap<&str, Vec<String>> {
    let vehicles = vehicles(program);
    let mut equipment: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    let mut add = |name: &'_ SmolStr, described: serde_json::Result<Value>| {
        let (Some((vehicle, own)), Ok(mut described)) = (name.split_once('.'), described) else { return };
        if let Some(&vehicle) = vehicles.get(vehicle) {
            described["name"] = own.into();
            equipment.entry(vehicle).or_default().push(described.to_string());
        }
    };
    for resource in &program.resources {
        add(&resource.name.text, serde_json::to_value(resource));
    }
    for variable in &program.variables {
        add(&variable.name.text, serde_json::to_value(variable));
    }
    equipment
}

fn vehicles(program: &Program) -> BTreeSet<&str> {
    program.world.vehicles.iter().map(|vehicle| vehicle.name.text.as_str()).collect()
}

/// All names in a mission but in declarations of vehicles, their equipment, fleets and groups.
fn named(program: &Program) -> BTreeSet<SmolStr> {
    let vehicles = vehicles(program);
    let is_own = |name: &str| name.split_once('.').is_some_and(|(vehicle, _)| vehicles.contains(vehicle));
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
