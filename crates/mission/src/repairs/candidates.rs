//! Changes that might give a plan, by what is in conflict. Whether they do is found by planning.

use std::collections::BTreeMap;

use kirk::{Failure, FailureKind, Member, Reason};
use rmpl::program::{Change, LabelMode, PrimitiveDecl, Program, VariableDecl};
use rmpl::{Edit, Fix, Span};
use smol_str::SmolStr;
use tpn::{ArcId, BlockId, Extent, Label, LabelId, Network, ResourceId, Supply, Use, ValueSet};

use super::amounts::Amount;
use super::places::Places;

/// Reasons, and members of each, that are looked at.
const MAX_REASONS: usize = 4;
const MAX_MEMBERS: usize = 4;
/// Longer texts are not repeated in a label.
const MAX_SHOWN: usize = 40;

/// A change to try.
pub(super) enum Candidate {
    Change(Fix),
    /// More of a resource; how much has to be found out.
    More(Amount),
}

/// The changes to try, the likeliest first, each once.
pub(super) fn of(failure: &Failure, network: &Network, program: &Program, source: &str) -> Vec<Candidate> {
    let candidates = Candidates { network, program, source, places: Places::new(network) };
    let mut changes: Vec<Vec<Edit>> = Vec::new();
    let mut amounts: Vec<Amount> = Vec::new();
    let mut found: Vec<Candidate> = Vec::new();
    for reason in failure.reasons.iter().take(MAX_REASONS) {
        for fix in candidates.of_reason(reason) {
            if !changes.contains(&fix.edits) {
                changes.push(fix.edits.clone());
                found.push(Candidate::Change(fix));
            }
        }
        for amount in candidates.amounts(reason) {
            if !amounts.contains(&amount) {
                amounts.push(amount.clone());
                found.push(Candidate::More(amount));
            }
        }
    }
    found
}

struct Candidates<'a> {
    network: &'a Network,
    program: &'a Program,
    source: &'a str,
    places: Places<'a>,
}

impl Candidates<'_> {
    fn of_reason(&self, reason: &Reason) -> Vec<Fix> {
        let labels = || {
            reason.conflict.iter().filter_map(|member| match member {
                Member::Condition(label) => Some(*label),
                Member::Bound(_) | Member::Use(_) => None,
            })
        };
        match reason.kind {
            FailureKind::Threat => {
                let arcs: Vec<ArcId> = labels().map(|label| self.label(label).arc).collect();
                self.orders(&arcs)
            }
            FailureKind::OpenCondition => {
                labels().take(MAX_MEMBERS).flat_map(|ask| self.for_condition(self.label(ask))).collect()
            }
            FailureKind::Resource => self.for_resource(&self.uses(reason)),
            FailureKind::Temporal | FailureKind::Controllability => Vec::new(),
        }
    }

    /// The resources that a reason has too little of.
    fn amounts(&self, reason: &Reason) -> Vec<Amount> {
        if reason.kind != FailureKind::Resource {
            return Vec::new();
        }
        let mut of_resource: BTreeMap<ResourceId, Vec<&Use>> = BTreeMap::new();
        for used in self.uses(reason) {
            of_resource.entry(used.resource).or_default().push(used);
        }
        let amounts = of_resource.values();
        amounts.filter_map(|uses| Amount::new(self.network, self.program, self.source, uses)).collect()
    }

    fn uses(&self, reason: &Reason) -> Vec<&Use> {
        let used = reason.conflict.iter().filter_map(|member| match member {
            Member::Use(used) => Some(&self.network.uses[used.index()]),
            Member::Bound(_) | Member::Condition(_) => None,
        });
        used.collect()
    }

    fn label(&self, label: LabelId) -> &Label {
        &self.network.labels[label.index()]
    }

    fn text(&self, span: Span) -> &str {
        self.source.get(span.range()).unwrap_or_default()
    }

    /// Returns what the author calls a place of the text: the text itself where it is short.
    fn shown(&self, block: BlockId, arc: ArcId) -> String {
        let text = self.places.span(block).map_or("", |span| self.text(span));
        if text.is_empty() || text.len() > MAX_SHOWN || text.contains('\n') {
            let occurrence = self.network.arcs[arc.index()].occurrence;
            let name = occurrence.map(|it| self.network.occurrences[it.index()].name.to_string());
            return name.unwrap_or_else(|| "this branch".to_owned());
        }
        text.to_owned()
    }

    /// Returns what the author calls an activity: by its number where there are several of its kind.
    fn named(&self, block: BlockId, arc: ArcId) -> String {
        let occurrences = &self.network.occurrences;
        let Some(own) = self.network.arcs[arc.index()].occurrence.map(|it| &occurrences[it.index()]) else {
            return self.shown(block, arc);
        };
        let same = occurrences.iter().filter(|it| it.activity == own.activity).count();
        if same > 1 { own.name.to_string() } else { own.activity.to_string() }
    }

    /// That one of several that exclude each other waits for another.
    fn orders(&self, arcs: &[ArcId]) -> Vec<Fix> {
        let arcs = &arcs[..arcs.len().min(MAX_MEMBERS)];
        let mut found = Vec::new();
        for (index, &first) in arcs.iter().enumerate() {
            for &then in &arcs[index + 1..] {
                found.extend(self.waits(then, first));
                found.extend(self.waits(first, then));
            }
        }
        found
    }

    /// That the branch of `waiting` may start after that of `other`.
    fn waits(&self, waiting: ArcId, other: ArcId) -> Option<Fix> {
        let [one, two] = [self.places.of_arc(waiting)?, self.places.of_arc(other)?];
        let [own, others] = self.places.branches(one, two)?;
        let span = self.places.span(own)?;
        if self.text(span).is_empty() || self.text(span).starts_with("free") {
            return None;
        }
        let label = format!(
            "let {} start after {}: free {}",
            self.shown(own, waiting),
            self.shown(others, other),
            self.shown(own, waiting)
        );
        Some(Fix { label, edits: vec![insertion(span.start, "free ")] })
    }

    /// A condition that nothing meets: it waits for what does, or something that does is done first, or it lasts.
    fn for_condition(&self, ask: &Label) -> Vec<Fix> {
        let is_producer = |label: &&Label| {
            label.mode == LabelMode::Tell
                && label.extent != Extent::Initial
                && label.literal.supports(&ask.literal)
        };
        let producers: Vec<ArcId> =
            self.network.labels.iter().filter(is_producer).map(|label| label.arc).take(MAX_MEMBERS).collect();
        let mut found: Vec<Fix> =
            producers.iter().filter_map(|&producer| self.waits(ask.arc, producer)).collect();
        let variable = &self.network.variables[ask.literal.variable.index()];
        if !variable.is_lasting {
            found.extend(self.lasting(ask).filter(|_| !producers.is_empty()));
            return found;
        }
        let ValueSet::In(values) = &ask.literal.values else { return found };
        for value in values.iter().take(MAX_MEMBERS).map(|value| &variable.values[value.index()]) {
            for primitive in &self.program.primitives {
                if let Some(call) = call_that_sets(primitive, &variable.name, value) {
                    let why = format!("sets {}={value}", variable.name);
                    found.extend(self.first(&call, &why, ask.arc));
                }
            }
        }
        found
    }

    /// That `call` is made right before an activity.
    fn first(&self, call: &str, why: &str, before: ArcId) -> Option<Fix> {
        let unit = self.places.unit(self.places.of_arc(before)?);
        let span = self.places.span(unit)?;
        let edits = if self.places.is_in_sequence(unit) {
            vec![insertion(span.start, &format!("{call}; "))]
        } else {
            vec![insertion(span.start, &format!("{{ {call}; ")), insertion(span.end, " }")]
        };
        let label = format!("do {call} before {}: it {why}", self.named(unit, before));
        Some(Fix { label, edits })
    }

    /// That a condition which is known only while it is asserted keeps its value.
    fn lasting(&self, ask: &Label) -> Option<Fix> {
        let variable = &self.network.variables[ask.literal.variable.index()];
        let is_atom = variable.values.iter().any(|value| matches!(value.as_str(), "true" | "false"));
        let is_met = |index: usize| match &ask.literal.values {
            ValueSet::In(values) => values.iter().any(|value| value.index() == index),
            ValueSet::NotIn(values) => values.iter().all(|value| value.index() != index),
        };
        if is_atom {
            return None;
        }
        let other = (0..variable.values.len()).find(|&index| !is_met(index));
        let mut values = variable.values.clone();
        let initial = other.map_or(SmolStr::new_static("UNKNOWN"), |index| variable.values[index].clone());
        if other.is_none() {
            values.push(initial.clone());
        }
        let name = &variable.name;
        let text = format!("state {name} : {{{}}} = {initial};", values.join(", "));
        let is_own = |declared: &&VariableDecl| declared.name.text == *name;
        let edit = match self.program.variables.iter().find(is_own) {
            Some(declared) => Edit { span: declared.span, text: text.clone() },
            None => rmpl::editor::add_declaration(&rmpl::parse(self.source), &text),
        };
        Some(Fix { label: format!("make {name} a state that keeps its value: {text}"), edits: vec![edit] })
    }

    /// Activities that need more than there is: one waits, or something gives more first.
    fn for_resource(&self, uses: &[&Use]) -> Vec<Fix> {
        let Some(first) = uses.first() else { return Vec::new() };
        let resource = &self.network.resources[first.resource.index()];
        let arcs: Vec<ArcId> = uses.iter().map(|used| used.arc).collect();
        let Supply::Reservoir { .. } = resource.supply else {
            return self.orders(&arcs);
        };
        let is_change = |used: &&Use| used.resource == first.resource && used.level.is_none();
        let own = self.network.uses.iter().filter(is_change);
        let (givers, takers): (Vec<&Use>, Vec<&Use>) = own.partition(|used| used.change == Change::Produces);
        let is_short = first.change != Change::Produces;
        let (waiting, others) = if is_short { (uses, &givers) } else { (uses, &takers) };
        let mut found = Vec::new();
        for used in waiting.iter().rev().take(MAX_MEMBERS) {
            found.extend(others.iter().take(MAX_MEMBERS).filter_map(|other| self.waits(used.arc, other.arc)));
        }
        for used in waiting.iter().rev().take(MAX_MEMBERS).filter(|_| is_short) {
            for primitive in self.program.primitives.iter().filter(|it| it.formals.is_empty()) {
                let gives = |it: &&rmpl::program::ResourceUse| {
                    it.change == Change::Produces && it.resource.text == resource.name
                };
                if primitive.uses.iter().any(|it| gives(&it)) {
                    let call = format!("{}()", primitive.name.text);
                    found.extend(self.first(&call, &format!("gives {}", resource.name), used.arc));
                }
            }
        }
        found
    }
}

/// A call of a primitive after which a variable has a value, if its parameters can be chosen so.
fn call_that_sets(primitive: &PrimitiveDecl, variable: &str, value: &str) -> Option<String> {
    let is_formal = |name: &str| primitive.formals.iter().any(|formal| formal.text == name);
    // A traverse sets the place of what it moves, to where it goes last.
    let vehicle = variable.strip_suffix(".at");
    let mut bound: Vec<(&str, &str)> = Vec::new();
    let moved = primitive.moves.as_ref().and_then(|moves| {
        let vehicle = vehicle?;
        let own = moves.vehicles.iter().find(|it| it.text == vehicle);
        own.or_else(|| moves.vehicles.first().filter(|it| is_formal(&it.text)))
    });
    let effect = primitive.sets.iter().find(|effect| {
        effect.variable.text == variable && (effect.value.text == value || is_formal(&effect.value.text))
    });
    match (moved, effect) {
        (Some(moved), _) => {
            if is_formal(&moved.text) {
                bound.push((&moved.text, vehicle?));
            }
            let mut others = primitive.formals.iter().filter(|formal| formal.text != moved.text);
            bound.push((&others.next()?.text, value));
        }
        (None, Some(effect)) if is_formal(&effect.value.text) => bound.push((&effect.value.text, value)),
        (None, Some(_)) => {}
        (None, None) => return None,
    }
    let argument = |formal: &rmpl::program::Name| {
        bound.iter().find(|(name, _)| *name == formal.text).map(|(_, value)| *value)
    };
    let arguments: Option<Vec<&str>> = primitive.formals.iter().map(argument).collect();
    Some(format!("{}({})", primitive.name.text, arguments?.join(", ")))
}

fn insertion(at: u32, text: &str) -> Edit {
    Edit { span: Span::new(at, at), text: text.to_owned() }
}
