//! Activities that call themselves, directly or through others: no finite network can hold them.

use crate::diagnostic::Diagnostic;
use crate::diagnostics::recursion as wording;
use crate::span::Span;

use super::index::{DeclarationKey, Index, Namespace};
use super::names::Names;
use super::summary::Summary;

/// One diagnostic for each circle of calls, at the call that closes it; circles that share an activity are one
/// mistake. Offsets are relative to the declaration of the key. Linear in the number of calls.
pub(crate) fn recursion<'a>(
    names: &Names,
    index: &Index,
    declarations: impl Iterator<Item = (DeclarationKey, &'a Summary)>,
) -> Vec<(DeclarationKey, Diagnostic)> {
    let declarations: Vec<(DeclarationKey, &Summary)> = declarations
        .filter(|(_, summary)| summary.definition.as_ref().is_some_and(|definition| definition.is_activity))
        .collect();
    let mut node_of_key = vec![None; index.keys()];
    for (node, (key, _)) in declarations.iter().enumerate() {
        node_of_key[key.index()] = Some(node);
    }
    let calls = declarations.iter().map(|(_, summary)| {
        let targets = summary.calls.iter().filter_map(|call| {
            let key = index.first_key(Namespace::Callable, call.name)?;
            Some(((*node_of_key.get(key.index())?)?, call.span))
        });
        targets.collect()
    });
    let mut search =
        Search { calls: calls.collect(), state: vec![State::New; declarations.len()], circles: Vec::new() };
    for start in 0..declarations.len() {
        search.visit(start);
    }
    let name = |node: usize| {
        let definition = declarations.get(node).and_then(|(_, summary)| summary.definition.as_ref());
        definition.map(|definition| names.text(definition.name).as_str()).unwrap_or_default()
    };
    let described = search.circles.iter().map(|circle| {
        let way: Vec<&str> = circle.nodes.iter().map(|&node| name(node)).collect();
        (declarations[circle.caller].0, wording::circle(&way, circle.span))
    });
    described.collect()
}

struct Search {
    calls: Vec<Vec<(usize, Span)>>,
    state: Vec<State>,
    circles: Vec<Circle>,
}

struct Circle {
    /// The activities, from the one that is called again.
    nodes: Vec<usize>,
    caller: usize,
    span: Span,
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    New,
    Open,
    Done,
    Reported,
}

impl Search {
    /// Depth first without the call stack, which a long chain of activities would exhaust.
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
            match self.state[callee] {
                State::New => {
                    self.state[callee] = State::Open;
                    path.push((callee, 0));
                }
                State::Open => {
                    let from = path.iter().position(|&(open, _)| open == callee).unwrap_or(0);
                    let nodes: Vec<usize> = path[from..].iter().map(|&(open, _)| open).collect();
                    let is_told = nodes.iter().any(|&node| self.state[node] == State::Reported);
                    for &node in &nodes {
                        self.state[node] = State::Reported;
                    }
                    if !is_told {
                        self.circles.push(Circle { nodes, caller, span });
                    }
                }
                State::Done | State::Reported => {}
            }
        }
    }
}
