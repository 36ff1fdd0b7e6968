//! Definitions that call each other in a cycle.

use crate::span::Span;

/// A cycle of calls.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CallCycle {
    /// The definitions, each calling the next one, from the one that is called again.
    pub members: Vec<usize>,
    /// The last member's call of the first one.
    pub closing_call: Span,
}

impl CallCycle {
    /// The definition with the call that closes the cycle.
    pub fn last(&self) -> usize {
        self.members.last().copied().unwrap_or_default()
    }
}

/// The cycles among definitions of which each calls others, by position, at places of the text. Cycles that share a
/// definition are one mistake, and only the first one is given. Linear in the number of calls.
pub fn call_cycles(calls: &[Vec<(usize, Span)>]) -> Vec<CallCycle> {
    let mut search = Search { calls, state: vec![State::New; calls.len()], found: Vec::new() };
    for start in 0..calls.len() {
        search.visit(start);
    }
    search.found
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    New,
    Open,
    Done,
    Reported,
}

struct Search<'calls> {
    calls: &'calls [Vec<(usize, Span)>],
    state: Vec<State>,
    found: Vec<CallCycle>,
}

impl Search<'_> {
    /// Depth first without the call stack, which a long chain of definitions would exhaust.
    fn visit(&mut self, start: usize) {
        if self.state[start] != State::New {
            return;
        }
        self.state[start] = State::Open;
        let mut path = vec![(start, 0)];
        while let Some((caller, next)) = path.last_mut() {
            let caller = *caller;
            let Some(&(callee, span)) = self.calls[caller].get(*next) else {
                if self.state[caller] == State::Open {
                    self.state[caller] = State::Done;
                }
                path.pop();
                continue;
            };
            *next += 1;
            // Everything on the path is open, or reported as part of a cycle.
            match self.state[callee] {
                State::New => {
                    self.state[callee] = State::Open;
                    path.push((callee, 0));
                }
                State::Open => {
                    let from = path.iter().position(|&(open, _)| open == callee).unwrap_or(0);
                    let members: Vec<usize> = path[from..].iter().map(|&(open, _)| open).collect();
                    let is_told = members.iter().any(|&member| self.state[member] == State::Reported);
                    for &member in &members {
                        self.state[member] = State::Reported;
                    }
                    if !is_told {
                        self.found.push(CallCycle { members, closing_call: span });
                    }
                }
                State::Done | State::Reported => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circles_of(calls: &[&[usize]]) -> Vec<Vec<usize>> {
        let with_spans =
            |callees: &&[usize]| callees.iter().map(|&callee| (callee, Span::default())).collect();
        let calls: Vec<Vec<(usize, Span)>> = calls.iter().map(with_spans).collect();
        call_cycles(&calls).into_iter().map(|cycle| cycle.members).collect()
    }

    #[test]
    fn a_circle_is_found_wherever_the_search_enters_it_and_once() {
        assert_eq!(circles_of(&[&[1], &[2], &[1]]), [vec![1, 2]]);
        assert_eq!(circles_of(&[&[0]]), [vec![0]]);
        assert_eq!(circles_of(&[&[1, 1], &[2], &[0]]), [vec![0, 1, 2]]);
        assert_eq!(circles_of(&[&[1], &[0], &[3], &[2]]), [vec![0, 1], vec![2, 3]]);
    }

    #[test]
    fn calls_that_meet_again_are_no_circle() {
        assert!(circles_of(&[&[1, 2], &[3], &[3], &[]]).is_empty());
    }

    #[test]
    fn a_chain_of_a_hundred_thousand_calls_is_searched() {
        let chain: Vec<Vec<(usize, Span)>> =
            (1..=100_000).map(|next| vec![(next % 100_000, Span::default())]).collect();
        assert_eq!(call_cycles(&chain).len(), 1);
    }
}
