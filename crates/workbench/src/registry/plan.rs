//! Planning.

use super::arguments::{number_argument, text_argument};
use super::available::while_working;
use super::spec::{called, plain, when};
use crate::command::Command;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::search::SearchCommand;
use crate::state::settings::SettingsCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    plain("plan.chronological", "Search chronologically", Group::Plan, &[], Scope::Everywhere, |_| {
        Command::Settings(SettingsCommand::SetSearch(kirk::Search::Chronological))
    }),
    plain(
        "plan.conflictDirected",
        "Search with conflict learning",
        Group::Plan,
        &[],
        Scope::Everywhere,
        |_| Command::Settings(SettingsCommand::SetSearch(kirk::Search::ConflictDirected)),
    ),
    plain("plan.bestFirst", "Search best first", Group::Plan, &[], Scope::Everywhere, |_| {
        Command::Settings(SettingsCommand::SetSearch(kirk::Search::BestFirst))
    }),
    plain("plan.compare", "Compare searches", Group::Plan, &[], Scope::Everywhere, |state| {
        Command::Search(SearchCommand::Compare(!state.search.compares()))
    }),
    plain("plan.otherPaths", "Try other paths", Group::Plan, &[], Scope::Everywhere, |state| {
        Command::Settings(SettingsCommand::SetSeed(state.settings.plan.seed + 1))
    }),
    when(
        plain("plan.stop", "Stop planning", Group::Plan, &[], Scope::Everywhere, |_| Command::StopWork),
        while_working,
    ),
    plain("plan.again", "Plan again", Group::Plan, &[], Scope::Everywhere, |_| Command::PlanAgain),
    called("plan.seed", "Set path planning seed", Group::Plan, |_, arguments| {
        number_argument(arguments, "seed")
            .map(|seed| Command::Settings(SettingsCommand::SetSeed(seed.max(0.0) as u64)))
    }),
    called("plan.scenario", "Choose scenario", Group::Plan, |_, arguments| {
        let name = text_argument(arguments, "name")?;
        Ok(Command::Settings(SettingsCommand::SetGoal(snapshot::Goal::Scenario(name.into()))))
    }),
];
