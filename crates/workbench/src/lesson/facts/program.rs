//! The run of a control program: what is marked, what is believed, and what is true.

use smol_str::SmolStr;

use super::{Fact, Of, count, fact, truth, words};
use crate::state::AppState;
use crate::state::automaton::{Moment, PlantMoment};

pub(super) const FACTS: &[Fact] = &[
    fact("program", Of::Nothing, "whether the text is a control program that can be run", |state, _| {
        truth(state.automaton.program()?.automaton().is_some() && state.automaton.moment().is_some())
    }),
    fact("moments", Of::Nothing, "how many steps the program has taken", |state, _| {
        count(state.automaton.at())
    }),
    fact("locations", Of::Nothing, "how many locations its automaton has", |state, _| {
        count(state.automaton.program()?.automaton()?.locations.len())
    }),
    fact("marks", Of::Nothing, "the labels of what is marked, in alphabetical order", |state, _| {
        words(listed(&moment(state)?.upcoming.labels))
    }),
    fact(
        "marked",
        Of::Something("assert x=a"),
        "whether something with this label is marked",
        |state, label| truth(moment(state)?.upcoming.labels.iter().any(|it| it == label)),
    ),
    fact("marked-places", Of::Nothing, "how many locations are marked", |state, _| {
        count(moment(state)?.upcoming.marked.len())
    }),
    fact("goals", Of::Nothing, "what the marked locations assert", |state, _| {
        words(listed(&moment(state)?.upcoming.goals))
    }),
    fact("ended", Of::Nothing, "whether nothing is marked any more", |state, _| {
        truth(moment(state)?.upcoming.marked.is_empty())
    }),
    fact("fired", Of::Nothing, "how many transitions were taken in the last step", |state, _| {
        count(moment(state)?.taken.as_ref()?.fired.len())
    }),
    fact(
        "mode",
        Of::Something("EngineA"),
        "the mode of a component in the most likely state",
        |state, name| {
            let (model, plant) = plant(state)?;
            let component = model.component_named(name)?;
            words(model.mode_name(component, plant.belief.most_likely().mode(component)))
        },
    ),
    fact("true-mode", Of::Something("EngineA"), "the mode that a component is really in", |state, name| {
        let (model, plant) = plant(state)?;
        let component = model.component_named(name)?;
        words(model.mode_name(component, plant.true_state.mode(component)))
    }),
    fact("believed", Of::Nothing, "how many states are believed possible", |state, _| {
        count(plant(state)?.1.belief.len())
    }),
    fact(
        "likelihood",
        Of::Nothing,
        "the probability of the most likely state, in percent to three decimals",
        |state, _| {
            let probability = plant(state)?.1.belief.highest_probability();
            words(format!("{:.3} %", percent(&probability.to_string())?))
        },
    ),
    fact("commands", Of::Nothing, "the commands of the next step", |state, _| {
        let (model, plant) = plant(state)?;
        let named = model.command_names(plant.next_commands.as_ref()?);
        let each: Vec<String> = named.iter().map(|(name, value)| format!("{name}.{value}")).collect();
        words(each.join(", "))
    }),
    fact(
        "observed",
        Of::Something("EngineA.thrust"),
        "what was observed of a variable in the last step",
        |state, name| {
            let (model, plant) = plant(state)?;
            words(model.observation_names(&plant.record.as_ref()?.observation).remove(name)?)
        },
    ),
    fact(
        "conflicts",
        Of::Nothing,
        "how many sets of assumptions the last observation contradicts",
        |state, _| count(plant(state)?.1.record.as_ref()?.conflicts.len()),
    ),
    fact("conflict", Of::Nothing, "the first of them, in words", |state, _| {
        let (model, plant) = plant(state)?;
        words(plant.record.as_ref()?.conflicts.first()?.describe(model))
    }),
];

fn moment(state: &AppState) -> Option<&Moment> {
    state.automaton.moment()
}

fn plant(state: &AppState) -> Option<(&plant::Model, &PlantMoment)> {
    let model = state.automaton.program()?.model()?;
    Some((model, moment(state)?.plant.as_ref()?))
}

fn listed(labels: &[SmolStr]) -> String {
    labels.iter().map(SmolStr::as_str).collect::<Vec<_>>().join(", ")
}

/// An exact fraction in percent. Its parts may have more digits than an integer holds.
fn percent(fraction: &str) -> Option<f64> {
    let (numerator, denominator) = fraction.split_once('/').unwrap_or((fraction, "1"));
    Some(numerator.parse::<f64>().ok()? / denominator.parse::<f64>().ok()? * 100.0)
}
