//! One reason why a mission has no plan whatever is chosen, where there are too many failures to list one after the other:
//! all its bounds and conditions, less those that the solver needs for no proof.

use std::collections::{BTreeMap, BTreeSet};

use rmpl::program::LabelMode;
use stn::{Inconsistency, Stn};
use tpn::{CausalLink, Choice, LabelId, Network, Ordering, ResourceId, UseId, VariableId};

use crate::explain::{Effort, Part, Refuted, spans};
use crate::failure::{FailureKind, Member, Reason};
use crate::model::UNBOUNDED_BELOW;
use crate::model::{Context, INFINITE, Model, node};
use crate::trace::{Constraint, CycleMember, TreeChoice};
use crate::{precedence, wording};

/// A reason that stays larger than this tells no one anything.
const MAX_MEMBERS: usize = 400;

/// The reason why no plan makes `choices`, if the solver proves it within the effort.
pub(crate) fn reason(
    network: &Network,
    model: &Model,
    choices: &[Choice],
    effort: &mut Effort<'_>,
) -> Option<Reason> {
    let all = members(model);
    let part = Part::new(model, choices);
    let mut search = Shrinking {
        part,
        members: Vec::new(),
        proven: all.clone(),
        needed: BTreeSet::new(),
        wants_core: true,
        effort,
    };
    search.keep(&all);
    let Refuted::By(core) = search.part.refute(search.effort, true)? else { return None };
    let mut is_minimal = core.is_some_and(|core| search.shrink_core(&core));
    if !is_minimal && !search.effort.is_exhausted() {
        search.wants_core = false;
        search.needed.clear();
        search.keep(&all);
        for group in by_subject(network) {
            search.leave_out(&group);
        }
        is_minimal = search.shrink(2);
    }
    let proven = search.proven.clone();
    if proven.len() > MAX_MEMBERS {
        return None;
    }
    search.keep(&proven);
    let choices: Vec<Choice> = choices.iter().copied().filter(|&choice| !search.leave_open(choice)).collect();
    search.part.ignores_nature = true;
    let is_natures = model.has_uncertainty && search.part.is_refuted(search.effort) == Some(false);
    let members = search.members;
    let kind = if is_natures { FailureKind::Controllability } else { kind(network, &members) };
    let cycle = cycle(model, kind, &choices, &members);
    let told = wording::Told { network, kind, choices: &choices, conflict: &members, cycle: &cycle };
    Some(Reason {
        message: network.readable(&told.message()),
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
    part: Part<'a>,
    members: Vec<Member>,
    /// The last members that were proven to be a contradiction themselves.
    proven: Vec<Member>,
    /// Those that are known to be needed: without one of them the members, and so any part of them, have a solution.
    needed: BTreeSet<Member>,
    /// Whether what a proof does not need is left out, too.
    wants_core: bool,
    effort: &'a mut Effort<'t>,
}

impl Shrinking<'_, '_> {
    /// Shrinks a core, which is a reason already but need not be a minimal one. Whether it is minimal then.
    fn shrink_core(&mut self, core: &[Member]) -> bool {
        self.keep(core);
        if self.is_refuted() != Some(true) {
            return false;
        }
        let is_minimal = self.shrink(16);
        // What was left out on the way was needed for none of the proofs found; this one is of what is left.
        self.wants_core = false;
        self.is_refuted() == Some(true) && is_minimal
    }

    /// Leaves out what is not needed, at first so many parts of the members at a time: smaller parts as long as that helps, and
    /// then one by one. Whether what stays is minimal.
    fn shrink(&mut self, parts: usize) -> bool {
        let mut size = self.members.len().div_ceil(parts);
        let mut is_minimal = true;
        while size > 0 && !self.effort.is_exhausted() {
            let before = self.members.len();
            // The last members first: what comes late in the text is told only if it matters.
            let mut end = self.members.len();
            while end > 0 && !self.effort.is_exhausted() {
                let start = end.saturating_sub(size);
                let open = |member: &&Member| !self.needed.contains(*member);
                let chunk: Vec<Member> = self.members[start..end].iter().filter(open).copied().collect();
                if !chunk.is_empty() {
                    let left_out = self.leave_out(&chunk);
                    is_minimal &= size > 1 || left_out.is_some();
                }
                // More than the chunk may be gone.
                end = start.min(self.members.len());
            }
            size = match size {
                1 => 0,
                _ if self.members.len() == before => 1,
                _ => size.div_ceil(2),
            };
        }
        is_minimal && size == 0
    }

    /// Takes only these members.
    fn keep(&mut self, members: &[Member]) {
        for &member in &self.members {
            self.part.set(member, false);
        }
        for &member in members {
            self.part.set(member, true);
        }
        self.members = members.to_vec();
    }

    /// Returns whether the members are a contradiction; if so, only those stay that the proof needs. `None` if no one
    /// knows.
    fn is_refuted(&mut self) -> Option<bool> {
        Some(matches!(self.refute()?, Refuted::By(_)))
    }

    fn refute(&mut self) -> Option<Refuted> {
        let refuted = self.part.refute(self.effort, self.wants_core)?;
        let Refuted::By(core) = &refuted else { return Some(refuted) };
        self.proven.clone_from(&self.members);
        if let Some(core) = core {
            let core: BTreeSet<Member> = core.iter().copied().collect();
            let rest = self.members.iter().copied().filter(|member| core.contains(member));
            let rest: Vec<Member> = rest.collect();
            self.keep(&rest);
        }
        Some(refuted)
    }

    /// Leaves members out if what remains is a contradiction still. Whether it did; `None` if no one knows.
    fn leave_out(&mut self, chunk: &[Member]) -> Option<bool> {
        let before = self.members.clone();
        let dropped: BTreeSet<Member> = chunk.iter().copied().collect();
        let others: Vec<Member> = before.iter().copied().filter(|member| !dropped.contains(member)).collect();
        self.keep(&others);
        let refuted = self.refute();
        if !matches!(refuted, Some(Refuted::By(_))) {
            self.keep(&before);
        }
        if let Some(Refuted::No(solution)) = &refuted {
            if let [only] = chunk {
                self.needed.insert(*only);
            }
            self.needed.extend(self.part.needed(&before, chunk, solution));
        }
        Some(matches!(refuted?, Refuted::By(_)))
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

/// The bounds that contradict each other whatever is chosen, if these do so without a look at the choices; of one
/// requirement with the first assertion that might carry it, and of two conditions with their order in the text.
fn cycle(model: &Model, kind: FailureKind, choices: &[Choice], members: &[Member]) -> Vec<CycleMember> {
    let conditions: Vec<LabelId> = (members.iter())
        .filter_map(|member| if let Member::Condition(label) = member { Some(*label) } else { None })
        .collect();
    let labels = &model.conditions.labels;
    match (kind, conditions.as_slice()) {
        (FailureKind::Temporal, _) => cycle_with(model, members, &[]),
        (FailureKind::OpenCondition, &[ask]) if !labels[ask].is_lasting => {
            let is_chosen = |tell: &LabelId| {
                let mut context = model.arcs[labels[*tell].arc].context;
                while let Some(choice) = context {
                    if !choices.contains(&choice) {
                        return false;
                    }
                    context = model.decisions[choice.decision].context;
                }
                true
            };
            let tells = model.conditions.supporters(ask).filter(is_chosen);
            let mut cycles = tells.map(|tell| {
                let link = CausalLink { ask, tell };
                cycle_with(model, members, &[(TreeChoice::Link(link), Constraint::Link(link))])
            });
            cycles.find(|cycle| !cycle.is_empty()).unwrap_or_default()
        }
        (FailureKind::Threat, &[first, then]) if !labels[first].is_lasting => {
            let order = Ordering { first, then };
            cycle_with(model, members, &[(TreeChoice::Order(order), Constraint::Order(order))])
        }
        _ => Vec::new(),
    }
}

/// A contradiction among bounds and what some choices say about times.
fn cycle_with(model: &Model, members: &[Member], made: &[(TreeChoice, Constraint)]) -> Vec<CycleMember> {
    let mut stn = Stn::new(model.num_nodes);
    let mut constraints: Vec<Constraint> = Vec::new();
    for &(choice, constraint) in made {
        for (from, to, weight) in precedence::edges(model, choice) {
            let representative = |at| model.representative(node(at));
            stn.push(representative(from), representative(to), weight, constraints.len() as u32);
            constraints.push(constraint);
        }
    }
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

#[cfg(test)]
mod tests {
    use tpn::compile::{Top, compile};
    use tpn::families::{chain, long_requirements, nested, open_shop, pigeonholes, symmetric};
    use tpn::generate::{Recipe, Tightness, mission};

    use super::*;
    use crate::options::Unlimited;

    /// Missions most of which have no plan.
    fn texts() -> Vec<String> {
        let mut texts = vec![pigeonholes(5, 1), pigeonholes(12, 1), symmetric(6, 3, 1), chain(30, false)];
        for seed in 0..60 {
            texts.push(nested(20 + seed as usize * 3, 60, seed));
            texts.push(long_requirements(4, 3, seed, 70));
            texts.push(open_shop(2 + seed as usize % 3, 90 + seed as i64 % 10, seed));
            texts.push(mission(Recipe { nodes: 60, tightness: Tightness::Infeasible, seed }));
            let count = 3 + seed as usize % 5;
            texts.push(lasting(count, seed as usize));
            texts.push(sharing(count, seed as usize));
            texts.push(jobs(count, seed as usize));
        }
        texts
    }

    fn model(text: &str) -> (Network, Model) {
        let (network, diagnostics) = compile(&rmpl::parse(text).program(), &Top::Scenario(None));
        let network = network.unwrap_or_else(|| panic!("does not compile: {diagnostics:?}\n{text}"));
        let model = Model::new(&network, None).expect("times fit");
        (network, model)
    }

    /// What a refutation rests on is a contradiction by itself.
    #[test]
    fn cores_are_contradictions() {
        let (mut cores, mut unnamed, mut plans) = (0, 0, 0);
        for text in &texts() {
            let (_, model) = model(text);
            let mut unlimited = Unlimited;
            let mut effort = Effort::for_size(model.num_nodes, &mut unlimited);
            let mut part = Part::new(&model, &[]);
            for member in members(&model) {
                part.set(member, true);
            }
            let core = match part.refute(&mut effort, true) {
                Some(Refuted::By(Some(core))) => core,
                Some(Refuted::By(None)) => {
                    unnamed += 1;
                    continue;
                }
                _ => {
                    plans += 1;
                    continue;
                }
            };
            cores += 1;
            let mut rest = Part::new(&model, &[]);
            for &member in &core {
                rest.set(member, true);
            }
            assert_eq!(rest.is_refuted(&mut effort), Some(true), "{core:?}\n{text}");
        }
        assert!(cores > 200 && unnamed < 10, "{cores} cores, {unnamed} without a name, {plans} plans");
    }

    /// No member of a minimal reason can be left out, also of those that no search was made for.
    #[test]
    fn what_moved_solutions_show_to_be_needed_is() {
        let (mut searched, mut told) = (0, 0);
        for text in &texts() {
            let (_, model) = model(text);
            let mut unlimited = Unlimited;
            let mut effort = Effort::for_size(model.num_nodes, &mut unlimited);
            let mut part = Part::new(&model, &[]);
            let mut all = members(&model);
            for &member in &all {
                part.set(member, true);
            }
            if !matches!(part.refute(&mut effort, false), Some(Refuted::By(_))) {
                continue;
            }
            let mut shown: BTreeSet<Member> = BTreeSet::new();
            let mut at = all.len();
            while at > 0 {
                at -= 1;
                let member = all[at];
                let is_shown = shown.contains(&member);
                part.set(member, false);
                match part.refute(&mut effort, false) {
                    Some(Refuted::No(solution)) => {
                        shown.extend(part.needed(&all, &[member], &solution));
                        part.set(member, true);
                        *if is_shown { &mut told } else { &mut searched } += 1;
                    }
                    refuted => {
                        assert!(!is_shown || refuted.is_none(), "{member:?} is not needed\n{text}");
                        all.remove(at);
                    }
                }
            }
        }
        assert!(searched > 1_000 && told > 1_000, "{searched} searched for, {told} told by others");
    }

    /// Jobs that go through two shops each, in a horizon that is too short for one of these.
    fn jobs(count: usize, seed: usize) -> String {
        let length = |at: usize| 2 + (at * 5 + seed) % 6;
        let activities = (0..count).map(|at| {
            format!("primitive One{at}()[{0},{0}] uses M; primitive Two{at}()[1,9] uses N;", length(at))
        });
        let calls = (0..count).map(|at| format!("{{ delay; Two{at}(); delay; One{at}(); delay[1,inf] }}"));
        format!(
            "resource M; resource N; {} scenario S[0,{}] = {{ {} }}",
            activities.collect::<String>(),
            (0..count).map(length).sum::<usize>() + 1,
            calls.collect::<Vec<_>>().join(", ")
        )
    }

    /// Changes of one state, one after the other, in a horizon that is too short for all of them.
    fn lasting(count: usize, seed: usize) -> String {
        let changes = (0..count).map(|at| {
            format!("primitive Turn{at}()[{0},{0}] sets ARM=v{1};", 2 + (at * 7 + seed) % 5, at % 3)
        });
        let asks = (0..count).map(|at| format!("primitive Dig{at}()[3,3] requires ARM=v{};", at % 3));
        let calls = (0..count).map(|at| format!("{{ delay; Turn{at}(); delay; Dig{at}(); delay }}"));
        format!(
            "state ARM : {{v0, v1, v2}} = v0; {} {} scenario S[0,{}] = {{ {} }}",
            changes.collect::<String>(),
            asks.collect::<String>(),
            count * 4,
            calls.collect::<Vec<_>>().join(", ")
        )
    }

    /// Activities that share a resource for two and a tank, in a horizon that is too short for all of them.
    fn sharing(count: usize, seed: usize) -> String {
        let activities = (0..count).map(|at| {
            let (length, amount) = (2 + (at * 5 + seed) % 6, 1 + (at + seed) % 2);
            format!("primitive Use{at}()[{length},{length}] uses R {amount} consumes T 1;")
        });
        let calls = (0..count).map(|at| format!("{{ delay; Use{at}(); delay }}"));
        format!(
            "resource R capacity 2; resource T 0 .. 9 = {}; {} scenario S[0,{}] = {{ {} }}",
            2 + seed % 6,
            activities.collect::<String>(),
            count * 2,
            calls.collect::<Vec<_>>().join(", ")
        )
    }
}
