//! The parts of a model whose mode constraints share nothing, prepared once for all that is asked of them.

use serde::{Deserialize, Serialize};

use crate::model::{ComponentId, Mode, Model, VariableId};
use crate::table::Table;

/// Components whose mode constraints speak of each other, directly or through others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Island {
    /// Its components in their order.
    pub(crate) components: Vec<ComponentId>,
    /// Its variables in their order.
    pub(crate) variables: Vec<VariableId>,
    /// The symbols of its variables and, where a constraint asks for modes, of its components.
    pub(crate) own_symbols: Vec<u32>,
    /// By place (in `components`) and mode, what the mode says.
    pub(crate) sayings: Vec<Vec<Saying>>,
    /// Whether some constraint asks for the mode of a component.
    pub(crate) speaks_of_modes: bool,
    /// The places of components whose modes may contradict each other.
    pub(crate) core: Vec<u32>,
}

/// What a mode says, prepared for propagation.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Saying {
    /// The symbols of the mode's constraint.
    pub(crate) symbols: Vec<u32>,
    /// The constraint as a table, where it can be one.
    pub(crate) table: Option<Table>,
}

/// A set of components of an island, of which bit `b` represents all places that are `b` modulo 128.
///
/// In islands of more than 128 components it may therefore name more components than are meant, never fewer.
pub(crate) type Places = u128;

pub(crate) const fn place_bit(place: usize) -> Places {
    1 << (place % 128)
}

/// Cuts the model into islands; called once, when it is compiled.
pub(crate) fn islands(model: &Model) -> Vec<Island> {
    let symbols = model.components.len() + model.variables.len();
    let mut parents: Vec<usize> = (0..symbols).collect();
    for (at, component) in model.components.iter().enumerate() {
        let mut mine = vec![at as u32];
        for mode in &component.modes {
            mode.constraint.symbols(&mut |symbol| mine.push(symbol));
        }
        mine.sort_unstable();
        mine.dedup();
        mine.retain(|&symbol| (symbol as usize) < symbols);
        for &symbol in &mine {
            let (left, right) = (root(&mut parents, at), root(&mut parents, symbol as usize));
            parents[left.max(right)] = left.min(right);
        }
    }
    // A variable that no mode speaks of stays with its component.
    for (at, variable) in model.variables.iter().enumerate() {
        let symbol = model.components.len() + at;
        if root(&mut parents, symbol) == symbol {
            let owner = root(&mut parents, variable.component.0 as usize);
            parents[symbol] = owner;
        }
    }
    let mut islands: std::collections::BTreeMap<usize, Island> = std::collections::BTreeMap::new();
    let empty = || Island {
        components: Vec::new(),
        variables: Vec::new(),
        own_symbols: Vec::new(),
        sayings: Vec::new(),
        speaks_of_modes: false,
        core: Vec::new(),
    };
    for component in model.component_ids() {
        let root = root(&mut parents, component.0 as usize);
        islands.entry(root).or_insert_with(empty).components.push(component);
    }
    for at in 0..model.variables.len() {
        let root = root(&mut parents, model.components.len() + at);
        islands.entry(root).or_insert_with(empty).variables.push(VariableId(at as u32));
    }
    let mut islands: Vec<Island> = islands.into_values().collect();
    for island in &mut islands {
        let modes = island.components.iter().filter_map(|component| model.component(*component));
        island.sayings = modes.map(|component| component.modes.iter().map(said).collect()).collect();
        let mut asked = island.sayings.iter().flatten().flat_map(|saying| &saying.symbols);
        island.speaks_of_modes = asked.any(|&symbol| (symbol as usize) < model.components.len());
        let variables = island.variables.iter().map(|variable| model.variable_symbol(*variable));
        let components = island.components.iter().map(|component| Model::mode_symbol(*component));
        island.own_symbols = variables.chain(components.filter(|_| island.speaks_of_modes)).collect();
        island.core = crate::island_core::core(model, island);
    }
    islands
}

/// By symbol, the places (in the island that the symbol belongs to) of the components whose modes speak of it.
pub(crate) fn watchers(model: &Model) -> Vec<Vec<u32>> {
    let mut watchers: Vec<Vec<u32>> = vec![Vec::new(); model.full.len()];
    for island in &model.islands {
        for (place, sayings) in (0..).zip(&island.sayings) {
            for &symbol in sayings.iter().flat_map(|saying| &saying.symbols) {
                let Some(watchers) = watchers.get_mut(symbol as usize) else { continue };
                if watchers.last() != Some(&place) {
                    watchers.push(place);
                }
            }
        }
    }
    watchers
}

fn said(mode: &Mode) -> Saying {
    let mut symbols = Vec::new();
    mode.constraint.symbols(&mut |symbol| symbols.push(symbol));
    symbols.sort_unstable();
    symbols.dedup();
    Saying { symbols, table: Table::new(&mode.constraint) }
}

/// The first symbol of the set that a symbol belongs to.
pub(crate) fn root(parents: &mut [usize], mut at: usize) -> usize {
    while parents[at] != at {
        parents[at] = parents[parents[at]];
        at = parents[at];
    }
    at
}
