//! Groups with their members (SPEC 17): vehicles, locations or values, each once, at its first place.

use std::collections::{BTreeMap, BTreeSet};

use smol_str::SmolStr;

use crate::diagnostic::Diagnostic;
use crate::diagnostics::{fleet as wording, kind as kind_wording, recursion};
use crate::program::{GroupDecl, Name, Program};

/// What the members of a group are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupKind {
    Vehicles,
    Locations,
    /// Values of variables and states.
    Values,
}

impl GroupKind {
    /// As messages name one member.
    pub(crate) const fn one(self) -> &'static str {
        match self {
            Self::Vehicles => "a vehicle",
            Self::Locations => "a location",
            Self::Values => "a value",
        }
    }
}

/// The groups and fleets of a mission.
#[derive(Clone, Debug, Default)]
pub struct Groups {
    members: BTreeMap<SmolStr, (GroupKind, Vec<SmolStr>)>,
}

impl Groups {
    /// Reads all declarations, in time linear in the members of all groups; says what is wrong with them.
    pub fn new(program: &Program) -> (Self, Vec<Diagnostic>) {
        let mut reader = Reader {
            declared: BTreeMap::new(),
            vehicles: program.world.vehicles.iter().map(|it| it.name.text.as_str()).collect(),
            locations: program.world.locations.iter().map(|it| it.name.text.as_str()).collect(),
            values: program.variables.iter().flat_map(|it| &it.values).map(|it| it.text.as_str()).collect(),
            groups: Self::default(),
            open: Vec::new(),
            found: Vec::new(),
        };
        for fleet in &program.fleets {
            let members = fleet.members().collect();
            reader.groups.members.entry(fleet.name.text.clone()).or_insert((GroupKind::Vehicles, members));
        }
        for group in &program.groups {
            reader.declared.entry(group.name.text.as_str()).or_insert(group);
        }
        for group in &program.groups {
            reader.read(group);
        }
        (reader.groups, reader.found)
    }

    /// The members of a group or a fleet, in order; `None` if there is none of this name.
    pub fn members(&self, name: &str) -> Option<&[SmolStr]> {
        self.members.get(name).map(|(_, members)| members.as_slice())
    }

    /// Returns what the members of a group or a fleet are.
    pub fn kind(&self, name: &str) -> Option<GroupKind> {
        self.members.get(name).map(|(kind, _)| *kind)
    }
}

/// Groups nest no deeper than this.
const MAX_DEPTH: usize = 100;

struct Reader<'program> {
    declared: BTreeMap<&'program str, &'program GroupDecl>,
    vehicles: BTreeSet<&'program str>,
    locations: BTreeSet<&'program str>,
    values: BTreeSet<&'program str>,
    groups: Groups,
    /// The groups being read, outermost first.
    open: Vec<&'program str>,
    found: Vec<Diagnostic>,
}

impl<'program> Reader<'program> {
    /// Reads a group, and before it those that it names.
    fn read(&mut self, group: &'program GroupDecl) {
        if self.groups.members.contains_key(&group.name.text) {
            return;
        }
        self.open.push(&group.name.text);
        let mut kind: Option<(GroupKind, &Name)> = None;
        let mut members: Vec<SmolStr> = Vec::new();
        let mut known = BTreeSet::new();
        for written in &group.members {
            let Some((own, names)) = self.member(written) else { continue };
            match kind {
                Some((first, by)) if first != own => {
                    self.found.extend(kind_wording::mixed_group(&group.name, (by, first), (written, own)));
                    continue;
                }
                _ => kind = kind.or(Some((own, written))),
            }
            members.extend(names.into_iter().filter(|name| known.insert(name.clone())));
        }
        self.open.pop();
        let kind = kind.map_or(GroupKind::Values, |(kind, _)| kind);
        self.groups.members.insert(group.name.text.clone(), (kind, members));
    }

    /// Returns what one member is, and the names that it represents.
    fn member(&mut self, written: &'program Name) -> Option<(GroupKind, Vec<SmolStr>)> {
        let name = written.text.as_str();
        if let Some(at) = self.open.iter().position(|open| *open == name) {
            let diagnostic = recursion::groups(&self.open[at..], written.span);
            self.found.push(diagnostic);
            return None;
        }
        if let Some(&group) = self.declared.get(name)
            && self.open.len() < MAX_DEPTH
        {
            self.read(group);
        }
        if let Some((kind, members)) = self.groups.members.get(name) {
            return Some((*kind, members.clone()));
        }
        let kind = if self.vehicles.contains(name) {
            GroupKind::Vehicles
        } else if self.locations.contains(name) {
            GroupKind::Locations
        } else if self.values.contains(name) {
            GroupKind::Values
        } else {
            self.found.push(wording::unknown_member(written));
            return None;
        };
        Some((kind, vec![written.text.clone()]))
    }
}
