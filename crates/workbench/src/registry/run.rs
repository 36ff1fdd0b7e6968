//! The run of a mission, and of a control program.

use executive::Disturbance;

use super::arguments::{hitting, injection, knowledge, number_argument, part, proof, text_argument};
use super::available::{with_chance, with_program, with_run};
use super::spec::{called, plain, when};
use crate::command::Command;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::automaton::AutomatonCommand;
use crate::state::chance::ChanceCommand;
use crate::state::execution::ExecutionCommand;
use crate::state::program_proof::ProgramProofCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    when(
        plain("execute.reset", "Restart run", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Execution(ExecutionCommand::Reset)
        }),
        with_run,
    ),
    when(
        plain("execute.save", "Save run…", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Execution(ExecutionCommand::Save)
        }),
        with_run,
    ),
    plain("execute.replay", "Replay run…", Group::Play, &[], Scope::Everywhere, |_| {
        Command::Execution(ExecutionCommand::Open)
    }),
    when(
        called("execute.withdraw", "Withdraw condition", Group::Play, |_, arguments| {
            let condition = text_argument(arguments, "condition")?;
            Ok(Command::Execution(ExecutionCommand::Withdraw(condition.into())))
        }),
        with_run,
    ),
    when(
        called("execute.disturb", "Add disturbance", Group::Play, |_, arguments| {
            let disturbance: Disturbance =
                serde_json::from_value(arguments.clone()).map_err(|error| error.to_string())?;
            disturbance.problem().map_or(Ok(()), |problem| Err(problem.to_owned()))?;
            Ok(Command::Execution(ExecutionCommand::Disturb(disturbance)))
        }),
        with_run,
    ),
    when(called("program.inject", "Force component mode", Group::Play, injection), with_program),
    when(called("program.know", "Set known value", Group::Play, knowledge), with_program),
    when(
        called("program.goTo", "Go to step", Group::Play, |_, arguments| {
            let moment = number_argument(arguments, "moment")?.max(0.0) as usize;
            Ok(Command::Automaton(AutomatonCommand::GoTo(moment)))
        }),
        with_program,
    ),
    when(called("program.diagnose", "Build hitting-set tree", Group::Play, hitting), with_program),
    when(called("program.show", "Show part of program", Group::Play, part), with_program),
    when(
        plain("program.reset", "Restart program", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Automaton(AutomatonCommand::Reset)
        }),
        with_program,
    ),
    when(
        plain("program.prove", "Prove properties", Group::Play, &[], Scope::Everywhere, |_| {
            Command::ProgramProof(ProgramProofCommand::Start)
        }),
        with_program,
    ),
    when(called("program.setProof", "Set properties to prove", Group::Play, proof), with_program),
    plain("program.stopProof", "Stop proof", Group::Play, &[], Scope::Everywhere, |_| {
        Command::ProgramProof(ProgramProofCommand::Stop)
    }),
    when(
        plain("execute.sample", "Run Monte Carlo", Group::Play, &[], Scope::Everywhere, |_| {
            Command::Chance(ChanceCommand::Start)
        }),
        with_chance,
    ),
    plain("execute.stopSampling", "Stop Monte Carlo", Group::Play, &[], Scope::Everywhere, |_| {
        Command::Chance(ChanceCommand::Stop)
    }),
];
