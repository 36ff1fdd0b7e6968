//! The run of a mission, and of a control program.

use executive::Disturbance;

use super::arguments::{injection, knowledge, number_argument, part, text_argument};
use super::available::{with_chance, with_program, with_run};
use super::spec::{called, plain, when};
use crate::command::Command;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::automaton::AutomatonCommand;
use crate::state::chance::ChanceCommand;
use crate::state::execution::ExecutionCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    when(
        plain("execute.reset", "Start the run over", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Execution(ExecutionCommand::Reset)
        }),
        with_run,
    ),
    when(
        plain("execute.save", "Save the run…", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Execution(ExecutionCommand::Save)
        }),
        with_run,
    ),
    plain("execute.replay", "Replay a run…", Group::Play, &[], Scope::Everywhere, |_| {
        Command::Execution(ExecutionCommand::Open)
    }),
    when(
        called("execute.withdraw", "Withdraw a condition now", Group::Play, |_, arguments| {
            let condition = text_argument(arguments, "condition")?;
            Ok(Command::Execution(ExecutionCommand::Withdraw(condition.into())))
        }),
        with_run,
    ),
    when(
        called("execute.disturb", "Disturb the run", Group::Play, |_, arguments| {
            let disturbance: Disturbance =
                serde_json::from_value(arguments.clone()).map_err(|error| error.to_string())?;
            disturbance.problem().map_or(Ok(()), |problem| Err(problem.to_owned()))?;
            Ok(Command::Execution(ExecutionCommand::Disturb(disturbance)))
        }),
        with_run,
    ),
    when(
        called("program.inject", "Bring a component into a mode in this step", Group::Play, injection),
        with_program,
    ),
    when(
        called("program.know", "Say what is known of a variable in this step", Group::Play, knowledge),
        with_program,
    ),
    when(
        called("program.goTo", "Go to the moment after so many steps", Group::Play, |_, arguments| {
            let moment = number_argument(arguments, "moment")?.max(0.0) as usize;
            Ok(Command::Automaton(AutomatonCommand::GoTo(moment)))
        }),
        with_program,
    ),
    when(
        called(
            "program.show",
            "Show a part of the program where there is no room for all",
            Group::Play,
            part,
        ),
        with_program,
    ),
    when(
        plain("program.reset", "Start the program anew", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Automaton(AutomatonCommand::Reset)
        }),
        with_program,
    ),
    when(
        plain("execute.sample", "Run many times with chance", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Chance(ChanceCommand::Start)
        }),
        with_chance,
    ),
    plain("execute.stopSampling", "Stop the runs with chance", Group::Play, &[], Scope::Everywhere, |_| {
        Command::Chance(ChanceCommand::Stop)
    }),
];
