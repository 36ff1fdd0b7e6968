//! Assignments that satisfy constraints together: found by search, to check models and to show what is wrong with them.

use smol_str::{SmolStr, format_smolstr};

use crate::formula::{Formula, Truth};
use crate::model::{ComponentId, Model};
use crate::value_set::ValueSet;

/// A search stops after this many trials.
const MAX_TRIALS: u32 = 20_000;

/// The result of a search for an assignment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// Values of symbols with which all constraints hold, whatever the other symbols are.
    Assignment(Vec<(u32, u8)>),
    Nothing,
    /// The search stopped at its limit.
    Undecided,
}

/// Values within `sets` with which all `formulas` hold. Exponential in the symbols that are open at worst.
pub(crate) fn satisfying(formulas: &[&Formula], sets: &mut [ValueSet]) -> Found {
    let mut trials = 0;
    match search(formulas, sets, &mut Vec::new(), &mut trials) {
        Some(assignment) => Found::Assignment(assignment),
        None if trials > MAX_TRIALS => Found::Undecided,
        None => Found::Nothing,
    }
}

fn search(
    formulas: &[&Formula],
    sets: &mut [ValueSet],
    assigned: &mut Vec<(u32, u8)>,
    trials: &mut u32,
) -> Option<Vec<(u32, u8)>> {
    *trials += 1;
    let mut open = None;
    for formula in formulas {
        match formula.truth(sets) {
            Truth::True => {}
            Truth::False => return None,
            Truth::Open => {
                formula.symbols(&mut |symbol| {
                    let is_open = sets.get(symbol as usize).is_some_and(|set| set.len() > 1);
                    if is_open && open.is_none() {
                        open = Some(symbol);
                    }
                });
            }
        }
    }
    let Some(symbol) = open else { return Some(assigned.clone()) };
    let before = sets[symbol as usize];
    let mut found = None;
    for value in before.values() {
        if *trials > MAX_TRIALS {
            break;
        }
        sets[symbol as usize] = ValueSet::one(value);
        assigned.push((symbol, value));
        found = search(formulas, sets, assigned, trials);
        assigned.pop();
        if found.is_some() {
            break;
        }
    }
    sets[symbol as usize] = before;
    found
}

/// Returns whether the same values within `sets` satisfy both; false if the search stopped at its limit.
pub(crate) fn are_equal(model: &Model, left: &Formula, right: &Formula, sets: &mut [ValueSet]) -> bool {
    let mut implies = |from: &Formula, to: &Formula| {
        satisfying(&[from, &model.opposite(to.clone())], sets) == Found::Nothing
    };
    left == right || implies(left, right) && implies(right, left)
}

/// Values in words: `where V.cmd=open, D=On`.
pub(crate) fn describe(model: &Model, assignment: &[(u32, u8)]) -> SmolStr {
    if assignment.is_empty() {
        return SmolStr::new_static("in every step");
    }
    let name = |&(symbol, value): &(u32, u8)| {
        let (name, value) = if let Some(variable) = model.symbol_variable(symbol) {
            let data = model.variables.get(variable.0 as usize)?;
            (&data.name, data.values.get(usize::from(value))?.as_str())
        } else if let Some(command) = model.symbol_command(symbol) {
            let data = model.command_variables.get(command.0 as usize)?;
            (&data.name, data.values.get(usize::from(value))?.as_str())
        } else {
            (&model.component(ComponentId(symbol))?.name, model.mode_name(ComponentId(symbol), value))
        };
        Some(format_smolstr!("{name}={value}"))
    };
    let names: Vec<SmolStr> = assignment.iter().filter_map(name).collect();
    format_smolstr!("where {}", names.join(", "))
}
