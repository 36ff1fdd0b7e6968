//! Every sentence of the key steps of lessons 1 to 8, by both searches, listed in `docs/evidence/key-sentences.md`, and each held
//! against what the search did: against the network, the choices after it, and the list of all plans.

use std::collections::BTreeSet;

use kirk::{Constraint, Event, Options, Search, Trace, TreeChoice, TreeNodeId, Unlimited};
use rmpl::program::LabelMode;
use test_support::start;
use tpn::{ArcId, LabelId, Network, Plan, Top, compile};
use workbench::command::Command;
use workbench::lesson::COURSE;
use workbench::state::lesson::LessonCommand;
use workbench::state::search::focus::is_key;
use workbench::state::search::wording;

/// What comes before the sentences.
const LISTING: &str = "\
# Search messages in lessons 1 to 8

This page lists the message of each key step in the first eight lessons, for both searches, in order of first use. A test
(`crates/workbench/tests/it/key_sentences.rs`) generates the list. It checks each message against the network, the choices,
the recorded step and all possible plans.
";

/// A search with what it was made of.
struct Told<'a> {
    network: &'a Network,
    trace: &'a Trace,
    /// Every plan that there is.
    plans: &'a [Plan],
}

impl Told<'_> {
    /// A state and all that it was reached through.
    fn line(&self, state: TreeNodeId) -> Vec<TreeNodeId> {
        let mut line = vec![state];
        while let Some(parent) = self.trace.tree[*line.last().expect("a state") as usize].parent {
            line.push(parent);
        }
        line
    }

    /// The arcs that had been selected on the way to a step.
    fn selected(&self, step: usize) -> BTreeSet<ArcId> {
        let line = self.line(self.trace.events[step].tree_node);
        let before = self.trace.events[..step].iter().filter(|entry| line.contains(&entry.tree_node));
        let arcs = before.filter_map(|entry| match entry.event {
            Event::AddArc { arc } => Some(arc),
            _ => None,
        });
        arcs.collect()
    }

    /// The plans that make all of these choices.
    fn plans_with<'c>(&'c self, choices: &'c [TreeChoice]) -> impl Iterator<Item = &'c Plan> {
        self.plans.iter().filter(|plan| choices.iter().all(|&choice| makes(plan, choice)))
    }

    /// Returns whether no plan makes all of these choices.
    fn excludes(&self, choices: &[TreeChoice]) -> bool {
        self.plans_with(choices).next().is_none()
    }

    /// Returns whether the record tells what a solver decides, and not how a network grows arc by arc.
    fn is_by_solver(&self) -> bool {
        matches!(self.trace.events.first().map(|entry| &entry.event), Some(Event::Begin(_)))
    }

    /// Whose condition it is, in the author's terms.
    fn name(&self, label: LabelId) -> String {
        let owner = self.network.labels[label.index()].owner.expect("lessons 1 to 8 have no first values");
        self.network.occurrences[owner.index()].name.to_string()
    }

    fn choice_of(&self, state: TreeNodeId) -> Option<TreeChoice> {
        self.trace.tree[state as usize].choice
    }

    /// Returns what of a sentence is not so.
    fn lie(&self, step: usize, sentence: &str) -> Option<String> {
        let entry = &self.trace.events[step];
        let selected = self.selected(step);
        let arc_of = |label: LabelId| self.network.labels[label.index()].arc;
        let is_selected = |label: LabelId| self.is_by_solver() || selected.contains(&arc_of(label));
        let literal = |label: LabelId| &self.network.labels[label.index()].literal;
        let line = self.line(entry.tree_node);
        let says =
            |words: &str| sentence.contains(words).then_some(()).ok_or(format!("it does not say {words}"));
        let holds = |is_so: bool, what: &str| is_so.then_some(()).ok_or(what.to_owned());
        let check = || -> Result<(), String> {
            match &entry.event {
                Event::Decide { decision, alternative } => {
                    let chosen = TreeChoice::Decision { decision: *decision, alternative: *alternative };
                    let name = self.network.alternative_name(*decision, *alternative);
                    says(&format!("{}: {name}", Network::decision_name(*decision)))?;
                    holds(self.choice_of(entry.tree_node) == Some(chosen), "the state has another choice")
                }
                Event::Inconsistent { cycle } => {
                    let total = exact::Time::checked_sum(cycle.iter().map(|it| it.weight)).expect("it fits");
                    let excess = total.checked_neg().expect("it fits");
                    holds(total.is_negative(), "the cycle is not negative")?;
                    let words: Vec<&str> = sentence.split([' ', ',', ':']).collect();
                    let numbers = words.iter().filter_map(|word| word.parse::<exact::Time>().ok());
                    // Before these may stand the gap that is kept.
                    let needed = match numbers.collect::<Vec<_>>()[..] {
                        [.., needed, allowed, told] if sentence.contains("too long") => {
                            holds(told == excess, "it is not so much too much")?;
                            holds(needed.checked_sub(allowed) == Some(excess), "its numbers do not add up")?;
                            needed
                        }
                        [.., needed] if sentence.contains("cannot wait that long") => needed,
                        _ => return Err("it does not say what is needed and what is allowed".to_owned()),
                    };
                    let lower = cycle.iter().map(|it| it.weight).filter(|weight| weight.is_negative());
                    let needs = exact::Time::checked_sum(lower).and_then(exact::Time::checked_neg);
                    holds(needs == Some(needed), "the bounds need another time")?;
                    for (at, member) in cycle.iter().enumerate() {
                        let next = &cycle[(at + 1) % cycle.len()];
                        holds(member.to == next.from, "the cycle is not closed")?;
                        let (id, is_upper) = match member.constraint {
                            Constraint::Lower(arc) => (arc, false),
                            Constraint::Upper(arc) => (arc, true),
                            _ => continue,
                        };
                        let arc = &self.network.arcs[id.index()];
                        let ends = if is_upper { (arc.from, arc.to) } else { (arc.to, arc.from) };
                        holds(
                            ends == (member.from, member.to),
                            "a constraint of the cycle is between other events",
                        )?;
                        let weight = if is_upper { arc.upper.finite() } else { arc.lower.checked_neg() };
                        holds(weight == Some(member.weight), "a constraint of the cycle has another weight")?;
                    }
                    Ok(())
                }
                Event::Unclosable { ask } => {
                    says(&self.name(*ask))?;
                    holds(is_selected(*ask), "the requirement is not selected")?;
                    let tried = |tell: LabelId| {
                        self.trace.events[..step].iter().any(|it| {
                            matches!(it.event, Event::TryLink { link } if link.ask == *ask && link.tell == tell)
                        })
                    };
                    let carriers = (0..self.network.labels.len()).map(LabelId::from_index).filter(|&it| {
                        self.network.labels[it.index()].mode == LabelMode::Tell
                            && literal(it).supports(literal(*ask))
                            && is_selected(it)
                    });
                    let left: Vec<String> =
                        carriers.filter(|&it| !tried(it)).map(|it| self.name(it)).collect();
                    // What is left is known not to contain the requirement, or it would have been tried.
                    let chosen: Vec<TreeChoice> = line.iter().filter_map(|&it| self.choice_of(it)).collect();
                    holds(left.is_empty() || self.excludes(&chosen), &format!("{left:?} could carry it"))
                }
                Event::TryLink { link } => {
                    says(&format!("{} supports ", self.name(link.tell)))?;
                    says(&format!(" of {}.", self.name(link.ask)))?;
                    holds(literal(link.tell).supports(literal(link.ask)), "it carries something else")?;
                    holds(is_selected(link.ask) && is_selected(link.tell), "one of them is not selected")
                }
                Event::Threat { left, right } | Event::Unresolvable { left, right } => {
                    says(&self.name(*left))?;
                    says(&self.name(*right))?;
                    holds(self.network.conflict(*left, *right), "they may overlap")?;
                    holds(is_selected(*left) && is_selected(*right), "one of them is not selected")
                }
                Event::TryOrder { order } => {
                    says(&format!("Order {} before {}:", self.name(order.first), self.name(order.then)))?;
                    let is_threat = |event: &Event| {
                        matches!(event, Event::Threat { left, right }
                            if [(*left, *right), (*right, *left)].contains(&(order.first, order.then)))
                    };
                    let before = &self.trace.events[..step];
                    holds(before.iter().any(|it| is_threat(&it.event)), "nothing said that they may overlap")
                }
                Event::Known { choices } | Event::Learn { choices } => {
                    says(&wording::never(self.network, choices))?;
                    let chosen: Vec<TreeChoice> = line.iter().filter_map(|&it| self.choice_of(it)).collect();
                    holds(choices.iter().all(|it| chosen.contains(it)), "it is about other choices")?;
                    holds(!choices.is_empty() && self.excludes(choices), "there is a plan with these choices")
                }
                Event::Clash { choices } => {
                    let chosen: Vec<TreeChoice> = line.iter().filter_map(|&it| self.choice_of(it)).collect();
                    holds(choices.iter().all(|it| chosen.contains(it)), "it is about other choices")?;
                    holds(!choices.is_empty() && self.excludes(choices), "there is a plan with these choices")
                }
                Event::Backtrack { to } => {
                    holds(line.contains(to), "it goes to a state that did not lead here")
                }
                Event::Backjump { to, because } => {
                    holds(line.contains(to), "it goes to a state that did not lead here")?;
                    let blamed: Vec<TreeChoice> =
                        because.iter().filter_map(|&it| self.choice_of(it)).collect();
                    for &choice in &blamed {
                        match choice {
                            TreeChoice::Decision { decision, alternative } if self.is_by_solver() => {
                                let name = self.network.alternative_name(decision, alternative);
                                says(&format!("{name} in {}", Network::decision_name(decision)))?;
                            }
                            _ => says(&wording::choice(self.network, Some(choice)))?,
                        }
                    }
                    holds(!blamed.is_empty(), "it blames nothing")?;
                    holds(self.excludes(&blamed), "there is a plan with the choices that are blamed")
                }
                Event::Begin(_) => holds(step == 0, "it has begun already"),
                Event::Imply { choice, holds: is_so, because } => {
                    let is_told = |plan: &Plan| *is_so == makes(plan, *choice);
                    holds(self.plans_with(because).all(is_told), "there is a plan in which it is not so")
                }
                Event::Restart => holds(line.len() == 1, "it does not go back to the start"),
                Event::Keep { orders, .. } => {
                    let keeps = |plan: &Plan| orders.iter().all(|it| plan.orderings_added.contains(it));
                    holds(self.plans.iter().any(keeps), "no plan keeps that order")
                }
                Event::Solution { .. } => holds(!self.plans.is_empty(), "there is no plan"),
                Event::Exhausted => holds(self.plans.is_empty(), "there is a plan"),
                other => Err(format!("nobody has said when this is so: {other:?}")),
            }
        };
        check().err()
    }
}

/// Returns whether a plan makes a choice. Of an order that follows from other things it says nothing, so it makes that
/// unless it adds the opposite.
fn makes(plan: &Plan, choice: TreeChoice) -> bool {
    match choice {
        TreeChoice::Decision { decision, alternative } => {
            plan.choices.iter().any(|it| it.decision == decision && it.alternative == alternative)
        }
        TreeChoice::Link(link) => plan.causal_links.contains(&link),
        TreeChoice::Order(order) => {
            !plan.orderings_added.iter().any(|it| (it.first, it.then) == (order.then, order.first))
        }
        other => unreachable!("lessons 1 to 8 have no {other:?}"),
    }
}

/// The heading of a lesson.
fn title_of(text: &str) -> &str {
    text.lines().find_map(|line| line.strip_prefix("# ")).expect("a lesson has a title")
}

#[test]
fn every_sentence_of_the_key_steps_of_lessons_1_to_8_is_true() {
    let mut listing = LISTING.to_owned();
    let mut lies = Vec::new();
    let mut kinds = BTreeSet::new();
    let lessons = COURSE.iter().flat_map(|chapter| chapter.lessons).take(8);
    let mut app = start();
    for (number, lesson) in lessons.enumerate() {
        app.run(Command::Lesson(LessonCommand::Open(lesson.name.into(), 0)));
        app.settle();
        listing.push_str(&format!("\n## {}. {}\n", number + 1, title_of(lesson.text)));
        let program = rmpl::parse(app.session.state().document.text()).program();
        let (network, problems) = compile(&program, &Top::Scenario(None));
        let network = network.unwrap_or_else(|| panic!("{}: {problems:?}", lesson.name));
        let all = Options { all: true, max_plans: 10_000, ..Options::default() };
        let plans = kirk::plan(&network, &all, &mut Unlimited).plans;
        for (search, title) in [
            (Search::Chronological, "Chronological search"),
            (Search::ConflictDirected, "Conflict-directed search"),
        ] {
            let options = Options { search, trace_events: Some(100_000), ..Options::default() };
            let trace = kirk::plan(&network, &options, &mut Unlimited).trace.expect("it was asked for");
            assert!(!trace.is_truncated, "{}", lesson.name);
            let told = Told { network: &network, trace: &trace, plans: &plans };
            listing.push_str(&format!("\n### {title}\n\n"));
            let mut said: Vec<(String, usize)> = Vec::new();
            for (step, entry) in trace.events.iter().enumerate().filter(|(_, entry)| is_key(&entry.event)) {
                let sentence = wording::event(&network, &trace, &entry.event);
                kinds.insert(
                    format!("{:?}", entry.event).split([' ', '{']).next().unwrap_or_default().to_owned(),
                );
                let lie = told.lie(step, &sentence);
                lies.extend(lie.map(|lie| format!("{}, step {step}: {sentence} ({lie})", lesson.name)));
                match said.iter_mut().find(|(it, _)| *it == sentence) {
                    Some((_, times)) => *times += 1,
                    None => said.push((sentence, 1)),
                }
            }
            for (sentence, times) in said {
                let times = if times == 1 { String::new() } else { format!(" ({times} times)") };
                listing.push_str(&format!("* {sentence}{times}\n"));
            }
        }
    }
    assert_eq!(lies, Vec::<String>::new());
    for kind in
        ["Decide", "Inconsistent", "Unresolvable", "TryLink", "Threat", "TryOrder", "Backtrack", "Backjump"]
    {
        assert!(kinds.contains(kind), "no {kind} among {kinds:?}");
    }
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/evidence/key-sentences.md");
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(file, &listing).expect("the listing can be written");
    }
    let kept = std::fs::read_to_string(file).unwrap_or_default();
    assert!(
        listing == kept,
        "docs/evidence/key-sentences.md is not what the test finds: run it with UPDATE_SNAPSHOTS=1 to update the file"
    );
}
