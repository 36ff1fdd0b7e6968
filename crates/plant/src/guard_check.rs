//! Guards that no modes and commands make true: such a transition is never taken, and nothing can be planned with it.

use std::collections::BTreeSet;

use rmpl::{Code, Diagnostic, Span};

use crate::belief::State;
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::formula::Formula;
use crate::island::Island;
use crate::model::{Commands, ComponentId, Model, Observation};
use crate::successor::is_entailed;
use crate::value_set::ValueSet;

/// A guard with more alternatives is not judged.
const MAX_ALTERNATIVES: usize = 256;
/// A guard that hangs on more combinations of modes is not judged.
const MAX_COMBINATIONS: usize = 4096;

/// A warning for each guard that cannot be brought about.
pub(crate) fn check_guards(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    let mut reported: BTreeSet<Span> = BTreeSet::new();
    for (id, component) in model.component_ids().zip(&model.components) {
        for (from, mode) in (0..=u8::MAX).zip(&component.modes) {
            for choice in mode.choices.iter().filter(|choice| choice.nominal != from) {
                if can_hold(model, id, from, &choice.guard) || !reported.insert(choice.span) {
                    continue;
                }
                let message = format!(
                    "`{}` can never take this transition from {}: its guard cannot become true",
                    component.name, mode.name
                );
                let hint =
                    "only modes and commands can make a guard true; values that they leave open cannot";
                let warning = Diagnostic::warning(Code("E-CONSTRAINT"), choice.span, message);
                diagnostics.push(warning.with_hint(hint));
            }
        }
    }
}

/// Returns whether some modes of the other components, and some commands, make a guard true in a mode of its component.
fn can_hold(model: &Model, component: ComponentId, from: u8, guard: &Formula) -> bool {
    let Some(alternatives) = guard.alternatives(MAX_ALTERNATIVES) else { return true };
    let mut involved: BTreeSet<ComponentId> = BTreeSet::new();
    let mut islands: Vec<&Island> = Vec::new();
    guard.symbols(&mut |symbol| {
        if (symbol as usize) < model.components.len() {
            involved.insert(ComponentId(symbol));
        } else if let Some(variable) = model.symbol_variable(symbol) {
            let with = model.islands.iter().find(|island| island.variables.binary_search(&variable).is_ok());
            islands.extend(with);
        }
    });
    if islands.is_empty() {
        // Other components and commands can be brought into whatever is asked for.
        let own = Model::mode_symbol(component);
        let fits = |(symbol, set): &(u32, ValueSet)| *symbol != own || set.contains(from);
        return alternatives.iter().any(|alternative| alternative.iter().all(fits));
    }
    involved.extend(islands.iter().flat_map(|island| &island.components));
    involved.remove(&component);
    let modes = |id: &ComponentId| model.component(*id).map_or(1, |data| data.modes.len().max(1));
    let all = involved.iter().map(modes).fold(1_usize, usize::saturating_mul);
    if all > MAX_COMBINATIONS {
        return true;
    }
    let mut state = model.initial_state();
    state.set_mode(component, from);
    let commands: Vec<Commands> =
        alternatives.iter().map(|alternative| commands_of(model, alternative)).collect();
    (0..all).any(|number| {
        let mut rest = number;
        for id in &involved {
            state.set_mode(*id, (rest % modes(id)) as u8);
            rest /= modes(id);
        }
        is_possible(model, &islands, &state)
            && commands.iter().any(|commands| is_entailed(model, guard, &state, commands))
    })
}

/// The first commands that an alternative of a guard asks for, all others idle.
fn commands_of(model: &Model, alternative: &[(u32, ValueSet)]) -> Commands {
    let mut commands = model.idle();
    for (symbol, set) in alternative {
        if let Some(command) = model.symbol_command(*symbol)
            && let Some((slot, value)) = commands.0.get_mut(command.0 as usize).zip(set.values().next())
        {
            *slot = value;
        }
    }
    commands
}

/// Returns whether the modes of a state can hold together in some islands.
fn is_possible(model: &Model, islands: &[&Island], state: &State) -> bool {
    let mut free = Domains::observed(model, &Observation::default());
    islands.iter().all(|island| Assumed::all(model, island, &state.0).check(&mut free).is_ok())
}
