//! The run of a control program as plain JSON, for host pages and tests (DESIGN 4.3).

use hca::Automaton;
use plant::Model;
use serde_json::{Value, json};

use crate::state::automaton::{AutomatonState, PlantMoment};
use crate::state::program_chance::ProgramChanceState;

/// The step that is looked at, what is marked there and, with a plant, what is believed, true, observed and commanded;
/// nothing if the text is no control program.
pub fn hca_json(state: &AutomatonState, revision: u64) -> Option<Value> {
    let program = state.program()?;
    let moment = state.moment();
    let plant = program.model().zip(moment.and_then(|moment| moment.plant.as_ref()));
    Some(json!({
        "step": state.at(),
        "steps": state.moments().len().saturating_sub(1),
        "locations": program.automaton().map_or(0, |automaton| automaton.locations.len()),
        "marked": moment.map(|moment| &moment.upcoming.labels),
        "goals": moment.map(|moment| &moment.upcoming.goals),
        "fired": program.automaton().zip(moment).map(|(automaton, moment)| {
            let taken = moment.taken.iter().flat_map(|taken| &taken.fired);
            taken.filter_map(|&id| fired_json(automaton, id)).collect::<Vec<_>>()
        }),
        "canStep": state.can_step(),
        "isPlaying": state.is_playing,
        "trouble": state.error,
        "chance": chance_json(&state.chance, revision),
        "plant": plant.map(|(model, moment)| plant_json(model, moment)),
    }))
}

/// How likely the program is to reach its end; null until runs were made of the present text.
fn chance_json(chance: &ProgramChanceState, revision: u64) -> Option<Value> {
    let tally = chance.tally(revision)?;
    let (low, high) = tally.interval();
    Some(json!({
        "runs": tally.runs,
        "isRunning": chance.is_running(),
        "reached": tally.reached,
        "probability": tally.probability(),
        "interval": [low, high],
        "meanSteps": tally.mean_steps(),
    }))
}

fn fired_json(automaton: &Automaton, id: hca::TransitionId) -> Option<Value> {
    let transition = automaton.transitions.get(id.0 as usize)?;
    Some(json!({ "from": automaton.location_name(transition.source) }))
}

fn plant_json(model: &Model, moment: &PlantMoment) -> Value {
    let believed = moment.belief.states().map(|(state, probability)| {
        json!({ "state": model.state_names(state), "probability": probability.to_string() })
    });
    let record = moment.record.as_ref();
    json!({
        "belief": believed.collect::<Vec<_>>(),
        "trueState": model.state_names(&moment.true_state),
        "observations": record.map(|record| model.observation_names(&record.observation)),
        "commands": record.map(|record| model.command_names(&record.commands)),
        "nextCommands": moment.next_commands.as_ref().map(|commands| model.command_names(commands)),
        "unachievable": moment.unachievable.iter()
            .map(|(goal, reason)| json!({ "goal": goal, "reason": reason }))
            .collect::<Vec<_>>(),
        "isUnexplained": record.is_some_and(|record| record.is_unexplained),
        "conflicts": record.map(|record| {
            record.conflicts.iter().map(|conflict| conflict.describe(model)).collect::<Vec<_>>()
        }),
    })
}
