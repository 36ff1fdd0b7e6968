//! One reason why a mission has no plan whatever is chosen, where there are too many failures to list one after the other:
//! all its bounds and conditions, less those that the solver needs for no proof.

use std::collections::BTreeMap;

use rmpl::program::LabelMode;
use stn::{Inconsistency, Stn};
use tpn::{Choice, LabelId, Network, ResourceId, UseId, VariableId};

use crate::explain::{Effort, Part, spans};
use crate::failure::{FailureKind, Member, Reason};
use crate::model::{Context, INFINITE, Model, node};
use crate::search::UNBOUNDED_BELOW;
use crate::trace::{Constraint, CycleMember};
use crate::wording;

/// A reason that stays larger than this tells nobody anything.
const MAX_MEMBERS: usize = 400;

/// The reason why no plan makes `choices`, if the solver proves it within the effort.
pub(crate) fn reason(
    network: &Network,
    model: &Model,
    choices: &[Choice],
    effort: &mut Effort<'_>,
) -> Option<Reason> {
    let mut search = Shrinking { model, part: Part::new(model, choices), members: Vec::new(), effort };
    search.members = members(model);
    for &member in &search.members {
        search.part.set(model, member, true);
    }
    if search.part.is_refuted(search.effort) != Some(true) {
        return None;
    }
    for group in by_subject(network) {
        search.leave_out(&group);
    }
    let mut size = search.members.len().div_ceil(2);
    let mut is_minimal = true;
    while size > 0 {
        // The last members first: what comes late in the text is told only if it matters.
        let mut end = search.members.len();
        while end > 0 {
            let start = end.saturating_sub(size);
            let chunk = search.members[start..end].to_vec();
            let left_out = search.leave_out(&chunk);
            is_minimal &= size > 1 || left_out.is_some();
            end = start;
        }
        size = if size == 1 { 0 } else { size.div_ceil(2) };
    }
    if search.members.len() > MAX_MEMBERS {
        return None;
    }
    let choices: Vec<Choice> = choices.iter().copied().filter(|&choice| !search.leave_open(choice)).collect();
    search.part.ignores_nature = true;
    let is_natures = model.has_uncertainty && search.part.is_refuted(search.effort) == Some(false);
    let members = search.members;
    let kind = if is_natures { FailureKind::Controllability } else { kind(network, &members) };
    let cycle = if kind == FailureKind::Temporal { cycle(model, &members) } else { Vec::new() };
    let told = wording::Told { network, kind, choices: &choices, conflict: &members, cycle: &cycle };
    Some(Reason {
        message: told.message(),
        spans: spans(network, &members, &cycle),
        choices,
        kind,
        conflict: members,
        cycle,
        is_minimal,
        failing_run: None,
    })
}

struct Shrinking<'a, 't> {
    model: &'a Model,
    part: Part,
    members: Vec<Member>,
    effort: &'a mut Effort<'t>,
}

impl Shrinking<'_, '_> {
    /// Leaves members out if what remains is a contradiction still. Whether it did; `None` if nobody knows.
    fn leave_out(&mut self, chunk: &[Member]) -> Option<bool> {
        for &member in chunk {
            self.part.set(self.model, member, false);
        }
        let is_refuted = self.part.is_refuted(self.effort);
        if is_refuted == Some(true) {
            self.members.retain(|member| !chunk.contains(member));
        } else {
            for &member in chunk.iter().filter(|member| self.members.contains(member)) {
                self.part.set(self.model, member, true);
            }
        }
        is_refuted
    }

    /// Leaves a choice open if what remains is a contradiction whatever is chosen there. Whether it did.
    fn leave_open(&mut self, choice: Choice) -> bool {
        self.part.assume(choice.decision, None);
        let is_refuted = self.part.is_refuted(self.effort) == Some(true);
        if !is_refuted {
            self.part.assume(choice.decision, Some(choice.alternative));
        }
        is_refuted
    }
}

/// All bounds and conditions.
fn members(model: &Model) -> Vec<Member> {
    let mut members = Vec::new();
    for (id, arc) in model.arcs.iter_enumerated() {
        if arc.lower != UNBOUNDED_BELOW {
            members.push(Member::Bound(Constraint::Lower(id)));
        }
        if arc.upper != INFINITE {
            members.push(Member::Bound(Constraint::Upper(id)));
        }
    }
    members.extend(model.conditions.labels.keys().map(Member::Condition));
    members.extend((0..model.demands.num_uses()).map(|used| Member::Use(UseId::from_index(used))));
    members
}

/// The bounds that contradict each other whatever is chosen, if these do so without a look at the choices.
fn cycle(model: &Model, members: &[Member]) -> Vec<CycleMember> {
    let mut stn = Stn::new(model.num_nodes);
    let mut constraints: Vec<Constraint> = Vec::new();
    for member in members {
        let &Member::Bound(constraint) = member else { continue };
        let (from, to, weight) = match constraint {
            Constraint::Upper(arc) => (model.arcs[arc].from, model.arcs[arc].to, model.arcs[arc].upper),
            Constraint::Lower(arc) => (model.arcs[arc].to, model.arcs[arc].from, -model.arcs[arc].lower),
            _ => continue,
        };
        stn.push(model.representative(from), model.representative(to), weight, constraints.len() as u32);
        constraints.push(constraint);
    }
    if !matches!(stn.settle(&model.order), Err(Inconsistency::NegativeCycle)) {
        return Vec::new();
    }
    let told = |edge: &stn::CycleEdge| {
        Some(CycleMember {
            constraint: *constraints.get(edge.tag as usize)?,
            from: node(edge.from),
            to: node(edge.to),
            weight: model.time(edge.weight),
        })
    };
    let cycle: Vec<CycleMember> = stn.cycle().iter().filter_map(told).collect();
    let contexts: Vec<Context> = cycle.iter().flat_map(|member| contexts(model, member.constraint)).collect();
    let is_possible =
        contexts.iter().all(|&one| contexts.iter().all(|&other| model.are_compatible(one, other)));
    if is_possible { cycle } else { Vec::new() }
}

fn contexts(model: &Model, constraint: Constraint) -> [Context; 2] {
    match constraint {
        Constraint::Lower(arc) | Constraint::Upper(arc) => {
            [model.arcs[arc].context, model.arcs[arc].other_context]
        }
        _ => [None; 2],
    }
}

/// The conditions of each variable and the uses of each resource: often one of these is all that it takes.
fn by_subject(network: &Network) -> Vec<Vec<Member>> {
    let mut groups: BTreeMap<VariableId, Vec<Member>> = BTreeMap::new();
    for (id, label) in network.labels.iter().enumerate() {
        groups.entry(label.literal.variable).or_default().push(Member::Condition(LabelId(id as u32)));
    }
    let mut uses: BTreeMap<ResourceId, Vec<Member>> = BTreeMap::new();
    for (id, used) in network.uses.iter().enumerate() {
        uses.entry(used.resource).or_default().push(Member::Use(UseId::from_index(id)));
    }
    uses.into_values().rev().chain(groups.into_values().rev()).collect()
}

fn kind(network: &Network, members: &[Member]) -> FailureKind {
    let conditions = members.iter().filter_map(|member| match member {
        Member::Condition(label) => Some(network.labels[label.index()].mode),
        Member::Use(_) | Member::Bound(_) => None,
    });
    if members.iter().any(|member| matches!(member, Member::Use(_))) {
        return FailureKind::Resource;
    }
    let modes: Vec<LabelMode> = conditions.collect();
    match modes.as_slice() {
        [] => FailureKind::Temporal,
        [LabelMode::Ask] => FailureKind::OpenCondition,
        _ => FailureKind::Threat,
    }
}
