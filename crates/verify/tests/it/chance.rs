//! What the two comparisons with brute force draw: the threads of tiny missions, and members of lists.

use tpn::Plan;
use tpn::generate::Rng;

use crate::brute_force::Schedule;
use crate::missions::time;

/// A thread of a mission: one or two parts after a delay. Of 100 parts, `choices` choose between two of `leaf`.
pub(crate) fn thread(rng: &mut Rng, leaf: fn(&mut Rng) -> String, choices: u64) -> String {
    let part = |rng: &mut Rng| {
        if rng.chance(choices) {
            return format!("choose {{ {}, {} }}", leaf(rng), leaf(rng));
        }
        leaf(rng)
    };
    let lead = match rng.below(3) {
        0 => String::new(),
        1 => format!("delay[{0},{0}]; ", rng.below(3)),
        _ => format!("delay[0,{}]; ", rng.between(1, 4)),
    };
    let second = if rng.chance(40) { format!("; {}", part(rng)) } else { String::new() };
    format!("{{ {lead}{}{second} }}", part(rng))
}

pub(crate) fn pick<'list, T>(rng: &mut Rng, list: &'list [T]) -> Option<&'list T> {
    if list.is_empty() { None } else { Some(&list[rng.below(list.len() as u64) as usize]) }
}

/// A schedule's times as the checker takes them.
pub(crate) fn times(plan: &Plan, at: &Schedule) -> Vec<Option<exact::Time>> {
    at.iter().zip(&plan.selected_nodes).map(|(&at, &is_selected)| is_selected.then(|| time(at))).collect()
}
