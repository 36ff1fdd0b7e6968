//! Large neighborhood search (Shaw 1998): what a solution decided is decided again first, but for what happens in a window of
//! its time, so that the search looks for a better solution near it. What it learns there holds everywhere.

use typed_index_collections::{TiSlice, TiVec};

use super::literal::{Literal, Variable};
use super::trail::Trail;
use super::{ChoicePoint, ChoicePointKind, Solver};
use crate::ids::ChoicePointId;

/// The part of a solution's decisions that is left open, in turn.
const PARTS: [f64; 4] = [0.1, 0.3, 0.15, 0.5];

/// Where windows begin, as parts of the time: each next one is far from all before it (the golden ratio).
const NEXT_WINDOW: f64 = 0.618_033_988_749_895;

/// A decision of a solution.
#[derive(Clone, Copy, Debug)]
struct Decided {
    of: ChoicePointId,
    literal: Literal,
    /// The earliest and the latest time that it is about.
    times: [i64; 2],
}

/// The decisions that the search makes first.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighborhood {
    /// All of the last solution: alternatives first, then by time.
    solution: Vec<Decided>,
    kept: Vec<(ChoicePointId, Literal)>,
    /// How many of these have been looked at.
    next: usize,
    /// The levels that they opened, with how many had been looked at before.
    levels: Vec<(u32, usize)>,
    /// How many neighborhoods there were before.
    count: u32,
}

impl Neighborhood {
    /// The next decision to make again where its choice point counts, which opens a level.
    pub(super) fn decide(
        &mut self,
        trail: &Trail,
        choice_points: &TiSlice<ChoicePointId, ChoicePoint>,
    ) -> Option<Literal> {
        let before = self.next;
        let is_open = |&(of, literal): &(ChoicePointId, Literal)| {
            trail.is_open(literal) && choice_points[of].when.iter().all(|&when| trail.holds(when))
        };
        let open = self.kept[before..].iter().position(is_open);
        self.next = open.map_or(self.kept.len(), |at| before + at + 1);
        open?;
        self.levels.push((trail.level() + 1, before));
        Some(self.kept[self.next - 1].1)
    }

    /// All levels above this one are left.
    pub(super) fn retract(&mut self, level: u32) {
        while let Some((_, before)) = self.levels.pop_if(|&mut (opened, _)| opened > level) {
            self.next = before;
        }
    }
}

impl Solver {
    /// Notes what the present solution decides.
    pub(crate) fn note_solution(&mut self) {
        let times = self.times_of_booleans();
        let mut solution: Vec<Decided> = Vec::new();
        for (of, choice_point) in self.choice_points.iter_enumerated() {
            if !choice_point.when.iter().all(|&when| self.trail.holds(when)) {
                continue;
            }
            for &literal in choice_point.options.iter().filter(|&&option| self.trail.holds(option)) {
                if let Some(times) = times[literal.side.variable()] {
                    solution.push(Decided { of, literal, times });
                }
            }
        }
        solution.sort_by_key(|decided| {
            let is_alternative = self.choice_points[decided.of].kind == ChoicePointKind::Alternatives;
            (!is_alternative, decided.times)
        });
        self.neighborhood.solution = solution;
    }

    /// Searches near the noted solution: each time elsewhere.
    pub(crate) fn search_near(&mut self) {
        self.search_everywhere();
        let Neighborhood { solution, kept, count, .. } = &mut self.neighborhood;
        let mut times: Vec<i64> = solution.iter().map(|decided| decided.times[0]).collect();
        times.sort_unstable();
        let at = |part: f64| {
            let index = (part * times.len() as f64) as usize;
            times.get(index).or(times.last()).copied().unwrap_or(0)
        };
        let part = PARTS[*count as usize % PARTS.len()];
        let from = (f64::from(*count) * NEXT_WINDOW).fract() * (1.0 - part);
        let window = at(from)..=at(from + part);
        *count += 1;
        let is_kept = |decided: &&Decided| !decided.times.iter().any(|time| window.contains(time));
        kept.extend(solution.iter().filter(is_kept).map(|decided| (decided.of, decided.literal)));
    }

    /// Searches without a look at the last solution.
    pub(crate) fn search_everywhere(&mut self) {
        self.retract(0);
        self.neighborhood.kept.clear();
        self.neighborhood.next = 0;
    }

    /// By Boolean that holds: the earliest and the latest time that depend on it.
    fn times_of_booleans(&self) -> TiVec<Variable, Option<[i64; 2]>> {
        let mut times: TiVec<Variable, Option<[i64; 2]>> = vec![None; self.trail.num_variables()].into();
        let mut add = |literal: Literal, of: Variable| {
            if literal != Literal::TRUE && self.trail.holds(literal) {
                let time = self.trail.least(of);
                let [first, last] = times[literal.side.variable()].unwrap_or([time; 2]);
                times[literal.side.variable()] = Some([first.min(time), last.max(time)]);
            }
        };
        for (from, to, _, whens) in self.differences.constraints() {
            for when in whens {
                add(when, from);
                add(when, to);
            }
        }
        for index in 0..self.trail.num_variables() {
            add(self.trail.presence(Variable::from(index)), Variable::from(index));
        }
        times
    }
}

#[cfg(test)]
mod tests {
    use super::super::trail::Cause;
    use super::*;

    #[test]
    fn what_was_taken_back_is_decided_again() {
        let mut trail = Trail::new();
        let [one, two, three, four] = [(); 4].map(|()| trail.add(0, 1, Literal::TRUE).holds());
        let choice_point = |option: Literal, when: Vec<Literal>| ChoicePoint {
            when,
            kind: ChoicePointKind::Sides,
            options: vec![option],
            last: None,
        };
        let choice_points: TiVec<ChoicePointId, ChoicePoint> = [one, two, three, four]
            .map(|option| choice_point(option, if option == four { vec![two] } else { Vec::new() }))
            .into_iter()
            .collect();
        let kept = choice_points.iter_enumerated().map(|(of, it)| (of, it.options[0])).collect();
        let mut near = Neighborhood { kept, ..Neighborhood::default() };
        let decide = |near: &mut Neighborhood, trail: &mut Trail| {
            let literal = near.decide(trail, &choice_points)?;
            trail.open_level();
            trail.set(literal, Cause::Decision).expect("it is open");
            Some(literal)
        };
        assert_eq!(decide(&mut near, &mut trail), Some(one));
        // What follows by itself is not decided, nor what does not count: the last one.
        trail.set(!two, Cause::Decision).expect("it is open");
        assert_eq!(decide(&mut near, &mut trail), Some(three));
        assert_eq!(decide(&mut near, &mut trail), None);
        trail.retract(1, |_| ());
        near.retract(1);
        assert_eq!(decide(&mut near, &mut trail), Some(three));
        trail.retract(0, |_| ());
        near.retract(0);
        let again = [(); 4].map(|()| decide(&mut near, &mut trail));
        assert_eq!(again, [one, two, three, four].map(Some));
    }
}
