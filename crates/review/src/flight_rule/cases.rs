//! Which instants meet a condition: it is taken apart into cases, each of which says of some events whether they have
//! come, and what levels there are to be.

use std::ops::ControlFlow;

use super::cut::{Edge, Times};
use super::level::Wanted;

/// A condition on an instant.
#[derive(Clone, Debug)]
pub(super) enum Condition {
    /// An event has come, or is to come.
    Edge(Edge),
    /// A level is like this.
    Level(Wanted),
    /// All of them; without any, it is always met.
    All(Vec<Condition>),
    /// One of them; without any, it is never met.
    Any(Vec<Condition>),
}

impl Condition {
    /// Returns what is met exactly where this is not.
    pub(super) fn negated(self) -> Self {
        let all = |parts: Vec<Self>| parts.into_iter().map(Self::negated).collect();
        match self {
            Self::Edge(edge) => Self::Edge(edge.negated()),
            Self::Level(wanted) => Self::Level(wanted.negated()),
            Self::All(parts) => Self::Any(all(parts)),
            Self::Any(parts) => Self::All(all(parts)),
        }
    }
}

/// Where an instant lies.
#[derive(Clone, Debug, Default)]
pub(super) struct Case {
    pub(super) past: Vec<Edge>,
    pub(super) future: Vec<Edge>,
    pub(super) levels: Vec<Wanted>,
}

/// There were more cases than anybody waits for.
pub(super) struct TooMany;

/// How many pairs of events are looked at for one condition.
pub(super) const MAX_PAIRS: usize = 3_000_000;
/// How many alternatives may be open at a time.
const MAX_DEPTH: usize = 600;

/// Calls `found` with each case that meets `condition` as far as its events go, until that breaks off.
pub(super) fn each_case(
    times: &mut Times,
    condition: &Condition,
    stop: &mut dyn FnMut() -> bool,
    found: &mut dyn FnMut(&mut Times, &Case) -> ControlFlow<()>,
) -> Result<(), TooMany> {
    let mut search = Search { times, pairs: 0, depth: 0, is_too_many: false, stop, found };
    let mut case = Case::default();
    let _ = search.visit(vec![condition], Vec::new(), &mut case);
    if search.is_too_many { Err(TooMany) } else { Ok(()) }
}

struct Search<'a> {
    times: &'a mut Times,
    pairs: usize,
    depth: usize,
    is_too_many: bool,
    stop: &'a mut dyn FnMut() -> bool,
    found: &'a mut dyn FnMut(&mut Times, &Case) -> ControlFlow<()>,
}

impl Search<'_> {
    fn visit<'c>(
        &mut self,
        mut open: Vec<&'c Condition>,
        mut choices: Vec<&'c [Condition]>,
        case: &mut Case,
    ) -> ControlFlow<()> {
        let marks = (case.past.len(), case.future.len(), case.levels.len());
        let mut is_possible = true;
        while let Some(condition) = open.pop().filter(|_| is_possible) {
            match condition {
                Condition::Edge(edge) => is_possible = self.add(case, *edge),
                Condition::Level(wanted) => case.levels.push(*wanted),
                Condition::All(parts) => open.extend(parts),
                Condition::Any(parts) => match parts.as_slice() {
                    [only] => open.push(only),
                    parts => choices.push(parts),
                },
            }
        }
        let flow = match (is_possible, choices.pop()) {
            (false, _) => ControlFlow::Continue(()),
            (true, None) => (self.found)(self.times, case),
            (true, Some(choice)) => self.choose(choice, &choices, case),
        };
        case.past.truncate(marks.0);
        case.future.truncate(marks.1);
        case.levels.truncate(marks.2);
        flow
    }

    /// Takes one alternative after the other, with the other choices still open.
    fn choose<'c>(
        &mut self,
        alternatives: &'c [Condition],
        others: &[&'c [Condition]],
        case: &mut Case,
    ) -> ControlFlow<()> {
        if self.depth >= MAX_DEPTH || self.pairs > MAX_PAIRS || (self.stop)() {
            self.is_too_many = true;
            return ControlFlow::Break(());
        }
        self.depth += 1;
        for alternative in alternatives {
            self.visit(vec![alternative], others.to_vec(), case)?;
        }
        self.depth -= 1;
        ControlFlow::Continue(())
    }

    /// Adds what is said of an event, if an instant still fits.
    fn add(&mut self, case: &mut Case, edge: Edge) -> bool {
        let own = if edge.is_past { &case.past } else { &case.future };
        if own.contains(&edge) {
            return true;
        }
        let others = if edge.is_past { &case.future } else { &case.past };
        self.pairs += others.len();
        for &other in others {
            let (past, future) = if edge.is_past { (edge, other) } else { (other, edge) };
            if !self.times.fits(past, future) {
                return false;
            }
        }
        let own = if edge.is_past { &mut case.past } else { &mut case.future };
        own.push(edge);
        true
    }
}
