//! Which components of an island may rule each other's modes out.

use crate::formula::{Formula, Truth};
use crate::island::Island;
use crate::model::Model;
use crate::value_set::ValueSet;

/// A constraint whose symbols have more combinations of values than this is taken to rule modes out.
const MAX_COMBINATIONS: u64 = 4096;

/// The places of an island's components whose modes may contradict each other.
///
/// A component is taken out as long as each of its modes can hold whatever values the symbols have that the components left
/// speak of too: then what these agree on can always be completed by it.
pub(crate) fn core(model: &Model, island: &Island) -> Vec<u32> {
    let mut left: Vec<u32> = (0..island.components.len() as u32).collect();
    let mut domains = model.full.clone();
    loop {
        let before = left.len();
        let mut at = 0;
        while at < left.len() {
            if completes(model, island, &left, at, &mut domains) {
                left.remove(at);
            } else {
                at += 1;
            }
        }
        if left.len() == before {
            return left;
        }
    }
}

/// Returns whether the component at a place among those `left` can complete whatever the others agree on.
fn completes(model: &Model, island: &Island, left: &[u32], at: usize, domains: &mut [ValueSet]) -> bool {
    let place = left[at] as usize;
    let own = Model::mode_symbol(island.components[place]);
    let others = |symbol: u32| {
        left.iter().enumerate().filter(|(other, _)| *other != at).any(|(_, &other)| {
            island.sayings[other as usize].iter().any(|saying| saying.symbols.binary_search(&symbol).is_ok())
        })
    };
    if others(own) {
        return false;
    }
    let Some(component) = model.component(island.components[place]) else { return true };
    component.modes.iter().zip(&island.sayings[place]).zip(0..=u8::MAX).all(|((mode, saying), number)| {
        let (shared, private): (Vec<u32>, Vec<u32>) = saying
            .symbols
            .iter()
            .filter(|symbol| **symbol != own)
            .partition(|symbol| (**symbol as usize) < model.components.len() || others(**symbol));
        let of_symbol = |symbol: &u32| u64::from(model.full[*symbol as usize].len());
        let all = shared.iter().chain(&private).map(of_symbol).fold(1_u64, u64::saturating_mul);
        if all > MAX_COMBINATIONS {
            return false;
        }
        domains[own as usize] = ValueSet::one(number);
        let result = for_all(&mode.constraint, &shared, &private, domains);
        domains[own as usize] = model.full[own as usize];
        result
    })
}

/// Returns whether for all values of `shared` some values of `private` satisfy a constraint.
fn for_all(constraint: &Formula, shared: &[u32], private: &[u32], domains: &mut [ValueSet]) -> bool {
    match constraint.truth(domains) {
        Truth::True => return true,
        Truth::False => return false,
        Truth::Open => {}
    }
    let Some((&symbol, rest)) = shared.split_first() else { return for_some(constraint, private, domains) };
    let full = domains[symbol as usize];
    let result = full.values().all(|value| {
        domains[symbol as usize] = ValueSet::one(value);
        for_all(constraint, rest, private, domains)
    });
    domains[symbol as usize] = full;
    result
}

fn for_some(constraint: &Formula, private: &[u32], domains: &mut [ValueSet]) -> bool {
    match constraint.truth(domains) {
        Truth::True => return true,
        Truth::False => return false,
        Truth::Open => {}
    }
    let Some((&symbol, rest)) = private.split_first() else { return false };
    let full = domains[symbol as usize];
    let result = full.values().any(|value| {
        domains[symbol as usize] = ValueSet::one(value);
        for_some(constraint, rest, domains)
    });
    domains[symbol as usize] = full;
    result
}
