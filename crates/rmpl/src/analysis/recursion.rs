//! Activities that call themselves, directly or through others: no finite network can hold them.

use crate::call_cycles::call_cycles;
use crate::diagnostic::Diagnostic;
use crate::diagnostics::recursion as wording;
use crate::span::Span;

use super::index::{DeclarationKey, Index, Namespace};
use super::names::Names;
use super::summary::Summary;

/// One diagnostic for each cycle of calls, at the call that closes it; cycles that share an activity are one
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
    let calls: Vec<Vec<(usize, Span)>> = calls.collect();
    let name = |node: usize| {
        let definition = declarations.get(node).and_then(|(_, summary)| summary.definition.as_ref());
        definition.map(|definition| names.text(definition.name).as_str()).unwrap_or_default()
    };
    let described = call_cycles(&calls).into_iter().map(|cycle| {
        let way: Vec<&str> = cycle.members.iter().map(|&node| name(node)).collect();
        (declarations[cycle.last()].0, wording::cycle(&way, cycle.closing_call))
    });
    described.collect()
}
