//! The lines about what lasts and what is limited: states, the movements of vehicles, and resources with their margins
//! (SPEC 10, 11). The independent checker examines all of it, and a line has passed only if the checker finds the plan
//! valid.

use std::collections::BTreeSet;

use exact::Rational;
use rmpl::program::LabelMode;
use smol_str::SmolStr;
use snapshot::{Planning, Traverse};
use tpn::{
    CausalLink, Extent, LabelId, Levels, Network, NodeId, OccurrenceId, Plan, Resource, Supply, UseId,
    Variable,
};

use super::lines::Places;
use super::plan_lines::CLOSED;
use super::{Line, ResourceReview, Status};

/// What the lines are made from.
pub(super) struct DemandLines<'input> {
    pub(super) network: &'input Network,
    pub(super) plan: &'input Plan,
    pub(super) traverses: &'input [Traverse],
    pub(super) places: &'input Places<'input>,
    /// How everything stands that the checker examines.
    pub(super) status: Status,
}

/// Changes of a variable in the order of a plan, those together that may come in any order: they give it the same value.
pub(super) fn in_any_order(network: &Network, changes: &[LabelId]) -> Vec<Vec<LabelId>> {
    let mut groups: Vec<Vec<LabelId>> = Vec::new();
    for &label in changes {
        let is_first = network.labels[label.index()].extent == Extent::Initial;
        match groups.last_mut() {
            Some(group) if !is_first && group.iter().all(|&known| is_unordered(network, known, label)) => {
                group.push(label);
            }
            _ => groups.push(vec![label]),
        }
    }
    groups
}

fn is_unordered(network: &Network, known: LabelId, label: LabelId) -> bool {
    network.labels[known.index()].extent != Extent::Initial && !network.conflict(known, label)
}

/// The vehicle and the location of a condition about what is in sight, and whether the vehicle has to see the location, or
/// must not (SPEC 10.5); `None` for a condition about something else.
pub(super) fn required_sight(network: &Network, ask: LabelId) -> Option<(&str, &SmolStr, bool)> {
    let ask = &network.labels[ask.index()];
    let sight = network.sight(ask)?;
    let vehicle = network.variables[sight.variable.index()].name.trim_end_matches(".at");
    Some((vehicle, &sight.location, !ask.text.starts_with("not(")))
}

/// Returns what a vehicle sees where it has to, or does not see where it must not, and from where (SPEC 10.5); `None`
/// for a condition about something else.
pub(super) fn sight_text(network: &Network, link: CausalLink) -> Option<String> {
    let (vehicle, location, is_seen) = required_sight(network, link.ask)?;
    let place = network.value_names(&network.labels[link.tell.index()].literal).join(", ");
    let verb = if is_seen { "sees" } else { "does not see" };
    let owner = network.labels[link.ask.index()].owner;
    let owner = owner.and_then(|owner| network.occurrences.get(owner.index()));
    let during = owner.map(|owner| format!(" during {}", owner.name)).unwrap_or_default();
    Some(format!(
        "{vehicle} {verb} {location} from {place}{during}; rocks and declared obstacles are ignored"
    ))
}

/// Whatever the checker examines has passed only where it finds the plan valid.
pub(super) fn status_by_checker(planning: &Planning) -> Status {
    match &planning.verdict {
        Some(verdict) if verdict.valid => Status::Passed,
        Some(_) => Status::Failed,
        None => Status::Attention,
    }
}

impl DemandLines<'_> {
    /// Returns what requirements rest on, the values of each state in their order, and the movements of each vehicle.
    pub(super) fn states(&self) -> Vec<Line> {
        let mut lines: Vec<Line> = self.requirements().into_iter().collect();
        lines.extend(self.sights());
        lines.extend(self.levels());
        for (index, variable) in self.network.variables.iter().enumerate() {
            if !variable.is_lasting {
                continue;
            }
            let changes = self.changes(index);
            lines.extend(match variable.name.strip_suffix(".at") {
                Some(vehicle) => self.movements(vehicle, &changes),
                None => self.values(variable, &changes),
            });
        }
        lines
    }

    /// Resources with a name, each with its margins.
    pub(super) fn resources(&self) -> Vec<ResourceReview> {
        let all = self.network.resources.iter().zip(&self.plan.levels);
        all.filter(|(resource, _)| !resource.name.contains('#'))
            .filter_map(|(resource, &levels)| self.resource(resource, levels))
            .collect()
    }

    /// The drives that take of a resource, or give to it, by how far they really drive.
    fn drives(&self, resource: &Resource) -> impl Iterator<Item = Option<OccurrenceId>> {
        let is_driven = |used: &&tpn::Use| {
            self.network.resources[used.resource.index()].name == resource.name
                && self.plan.selected_arcs.get(used.arc.index()) == Some(&true)
                && used.at_least < used.amount
        };
        self.network.uses.iter().filter(is_driven).map(|used| used.owner)
    }

    /// The name of a drive whose path rocks could close, if it is one.
    fn closable(&self, drive: OccurrenceId) -> Option<&str> {
        let is_closable = |it: &Traverse| it.occurrence == drive && it.may_be_closed();
        let name = || self.network.occurrences[drive.index()].name.as_str();
        self.traverses.iter().any(is_closable).then(name)
    }

    fn requirements(&self) -> Option<Line> {
        let is_lasting = |link: &&CausalLink| self.network.is_lasting(link.ask);
        let count = self.plan.causal_links.iter().filter(is_lasting).count();
        let text = match count {
            0 => return None,
            1 => "the requirement of a state is supported".to_owned(),
            _ => format!("all {count} requirements of states are supported"),
        };
        Some(self.places.line(self.status, text, None, Vec::new(), Vec::new()))
    }

    /// Returns what vehicles see where they have to, or do not see where they must not, and from where (SPEC 10.5).
    fn sights(&self) -> Vec<Line> {
        let mut lines = Vec::new();
        for link in &self.plan.causal_links {
            let Some(text) = sight_text(self.network, *link) else { continue };
            let names = self.owner(link.ask).map(str::to_owned).into_iter().collect();
            let (start, end) = self.network.interval(link.ask);
            let span = self.network.labels[link.ask.index()].span;
            lines.push(self.places.line(self.status, text, span, names, vec![start, end]));
        }
        lines
    }

    /// Returns what activities require of levels (SPEC 17).
    fn levels(&self) -> Vec<Line> {
        let mut lines = Vec::new();
        let uses = &self.network.uses;
        for (index, used) in uses.iter().enumerate() {
            let Some(level) = used.level_text(&self.network.resources) else { continue };
            // A condition that lasts is two uses: at the start, and from the start to the end. One line is about both.
            let is_part = !used.is_lasting()
                && uses.get(index + 1).is_some_and(|next| {
                    next.is_lasting()
                        && (next.owner, next.start, next.span) == (used.owner, used.start, used.span)
                });
            if is_part || self.plan.selected_arcs.get(used.arc.index()) != Some(&true) {
                continue;
            }
            let owner = used.owner.and_then(|owner| self.network.occurrences.get(owner.index()));
            let name = owner
                .map_or_else(|| self.network.use_name(UseId::from_index(index)), |it| it.name.to_string());
            let when = if used.is_lasting() { "from its start to its end" } else { "at its start" };
            let text = format!("{name} requires {level} {when}");
            lines.push(self.places.line(
                self.status,
                text,
                used.span,
                vec![name],
                vec![used.start, used.end],
            ));
        }
        lines
    }

    /// Returns what the plan makes of a variable that keeps its value, from first to last.
    fn changes(&self, variable: usize) -> Vec<LabelId> {
        let labels = self.network.labels.iter().enumerate();
        let told = labels.filter(|(_, label)| {
            label.literal.variable.index() == variable
                && label.mode == LabelMode::Tell
                && self.plan.selected_arcs.get(label.arc.index()) == Some(&true)
        });
        let mut changes: Vec<LabelId> = told.map(|(index, _)| LabelId::from_index(index)).collect();
        let earliest = |node: NodeId| {
            self.plan.windows.get(node.index()).copied().flatten().map(|window| window.earliest)
        };
        let order = self.plan.state_order.iter().find(|order| order.variable.index() == variable);
        let place = |label: LabelId| order.and_then(|it| it.producers.iter().position(|it| *it == label));
        changes.sort_by_key(|&label| {
            let is_first = self.network.labels[label.index()].extent == Extent::Initial;
            let place = place(label).unwrap_or(usize::MAX);
            (!is_first, place, earliest(self.network.interval(label).0), earliest(self.network.ready(label)))
        });
        changes
    }

    fn owner(&self, label: LabelId) -> Option<&str> {
        let owner = self.network.labels[label.index()].owner?;
        Some(self.network.occurrences.get(owner.index())?.name.as_str())
    }

    fn values(&self, variable: &Variable, changes: &[LabelId]) -> Option<Line> {
        let (name, is_from_plant) = (variable.name.as_str(), variable.component().is_some());
        let value = |label: LabelId| {
            let text = self.network.labels[label.index()].text.as_str();
            let value = text.strip_prefix(name).and_then(|rest| rest.strip_prefix('='));
            value.unwrap_or(text).to_owned()
        };
        let step = |labels: &Vec<LabelId>| {
            let owners: Vec<&str> = labels.iter().filter_map(|&label| self.owner(label)).collect();
            let value = labels.first().map_or_else(String::new, |&label| value(label));
            match owners.as_slice() {
                [] => value,
                [owner] => format!("{value} ({owner})"),
                several => format!("{value} ({}, in any order)", several.join(" and ")),
            }
        };
        let steps: Vec<String> = in_any_order(self.network, changes).iter().map(step).collect();
        let text = match steps.as_slice() {
            [] => return None,
            [only] => format!("{name} stays {only}"),
            [first, rest @ ..] => format!("{name} is {first}, then {}", rest.join(", then ")),
        };
        let text = if is_from_plant { format!("{text}, as long as no component fails") } else { text };
        // What no one changes is about the variable.
        let is_changed = changes.iter().any(|&label| self.owner(label).is_some());
        let names = if is_changed { Vec::new() } else { vec![name.to_owned()] };
        Some(self.line_of(text, changes, names))
    }

    fn movements(&self, vehicle: &str, changes: &[LabelId]) -> Option<Line> {
        let movements: Vec<String> =
            changes.iter().filter_map(|&label| self.owner(label)).map(str::to_owned).collect();
        let text = match movements.as_slice() {
            [] => return None,
            [only] => format!("{vehicle} makes one movement: {only}"),
            several => format!(
                "{vehicle} makes {} movements, one after the other: {}",
                several.len(),
                several.join(", ")
            ),
        };
        let changes: Vec<LabelId> =
            changes.iter().copied().filter(|&label| self.owner(label).is_some()).collect();
        Some(self.line_of(text, &changes, movements))
    }

    fn line_of(&self, text: String, changes: &[LabelId], names: Vec<String>) -> Line {
        let names = if names.is_empty() {
            changes.iter().filter_map(|&label| self.owner(label)).map(str::to_owned).collect()
        } else {
            names
        };
        let span = changes.first().and_then(|label| self.network.labels[label.index()].span);
        let nodes = changes.iter().map(|&label| self.network.ready(label)).collect();
        self.places.line(self.status, text, span, names, nodes)
    }

    fn resource(&self, resource: &Resource, levels: Levels) -> Option<ResourceReview> {
        let name = resource.name.as_str();
        let mut closable = BTreeSet::new();
        let (mut text, spare, room) = match (resource.supply, levels) {
            (Supply::Reusable { capacity }, Levels::Peak(peak)) => {
                let spare = capacity.checked_sub(peak)?;
                let [capacity, peak] = [capacity, peak].map(Rational::readable);
                let text = match spare {
                    _ if spare.is_positive() => {
                        format!("{name}: peak use {peak} of {capacity} ({} to spare)", spare.readable())
                    }
                    _ if spare.is_zero() => {
                        format!("{name}: peak use {capacity} of {capacity} (none to spare)")
                    }
                    _ => format!("{name}: peak use {peak} exceeds the capacity {capacity}"),
                };
                (text, spare, None)
            }
            (Supply::Reservoir { least, greatest, .. }, Levels::Range { low, high }) => {
                let (spare, room) = (low.checked_sub(least)?, greatest.checked_sub(high)?);
                let [low, high, least, greatest] = [low, high, least, greatest].map(Rational::readable);
                let above = if spare.is_zero() {
                    format!("reaches its minimum {least}")
                } else {
                    format!("{} above its minimum {least}", spare.readable())
                };
                let below = if room.is_zero() {
                    format!("reaches its maximum {greatest}")
                } else {
                    format!("{} below its maximum {greatest}", room.readable())
                };
                let mut text = format!("{name} stays between {low} and {high}: {above}, {below}");
                let mut drives = self.drives(resource).peekable();
                if drives.peek().is_some() {
                    text.push_str("; for every distance that drives may take along their paths");
                }
                closable = drives.flatten().filter_map(|drive| self.closable(drive)).collect();
                (text, spare, Some(room))
            }
            _ => return None,
        };
        let is_short = spare.is_negative() || room.is_some_and(Rational::is_negative);
        let mut status = if is_short { Status::Failed } else { self.status };
        if !closable.is_empty() {
            let names: Vec<&str> = closable.into_iter().collect();
            text.push_str(&format!("; {} may drive farther: {CLOSED}", names.join(", ")));
            status = status.max(Status::Attention);
        }
        let line = self.places.line(status, text, resource.span, vec![name.to_owned()], Vec::new());
        let (name, supply) = (name.to_owned(), resource.supply);
        Some(ResourceReview { line, name, supply, levels, spare, room })
    }
}
