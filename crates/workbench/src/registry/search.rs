//! Stepping through the recorded search.

use serde_json::Value;

use super::arguments::number_argument;
use super::available::{with_comparison, with_search, with_step};
use super::spec::{PLAIN, called, keys, plain, when};
use crate::command::Command;
use crate::command::chord::Key;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::search::SearchCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    when(
        plain(
            "search.run",
            "Run to next breakpoint",
            Group::Play,
            &[keys(PLAIN, Key::CloseBracket)],
            Scope::NotTyping,
            |_| search(SearchCommand::Run(true)),
        ),
        with_search,
    ),
    when(
        plain(
            "search.runBack",
            "Run to previous breakpoint",
            Group::Play,
            &[keys(PLAIN, Key::OpenBracket)],
            Scope::NotTyping,
            |_| search(SearchCommand::Run(false)),
        ),
        with_search,
    ),
    when(
        plain("search.close", "Show plan", Group::Play, &[], Scope::Everywhere, |_| {
            search(SearchCommand::Close)
        }),
        with_step,
    ),
    when(
        plain("search.turn", "Switch to other search", Group::Play, &[], Scope::Everywhere, |state| {
            search(SearchCommand::Turn(1 - state.search.side().min(1)))
        }),
        with_comparison,
    ),
    plain("search.keySteps", "Toggle key steps only", Group::Play, &[], Scope::Everywhere, |state| {
        search(SearchCommand::OnlyKey(!state.search.only_key()))
    }),
    when(
        plain("search.link", "Toggle linked stepping", Group::Play, &[], Scope::Everywhere, |state| {
            search(SearchCommand::Link(!state.search.is_linked()))
        }),
        with_comparison,
    ),
    when(
        called("search.goTo", "Go to search step", Group::Play, |_, arguments| {
            let step = number_argument(arguments, "step")?;
            if step < 1.0 {
                return Ok(search(SearchCommand::Close));
            }
            Ok(search(SearchCommand::GoTo(step as usize - 1)))
        }),
        with_search,
    ),
    when(
        called("search.goToState", "Go to search state", Group::Play, |_, arguments| {
            let state = number_argument(arguments, "state")?;
            Ok(search(SearchCommand::GoToNode(state.max(0.0) as u32)))
        }),
        with_search,
    ),
    called("search.breakpoints", "Set breakpoints", Group::Play, |state, arguments| {
        let mut chosen = state.search.breakpoints;
        for (name, value) in [
            ("decision", &mut chosen.decision),
            ("failure", &mut chosen.failure),
            ("threat", &mut chosen.threat),
            ("solution", &mut chosen.solution),
        ] {
            match arguments.get(name) {
                None => {}
                Some(Value::Bool(stops)) => *value = *stops,
                Some(_) => return Err(format!("\"{name}\" must be true or false")),
            }
        }
        Ok(search(SearchCommand::SetBreakpoints(chosen)))
    }),
    called("search.speed", "Set search speed", Group::Play, |_, arguments| {
        number_argument(arguments, "steps").map(|speed| search(SearchCommand::SetSpeed(speed)))
    }),
    called("play.seek", "Go to time", Group::Play, |_, arguments| {
        number_argument(arguments, "time").map(Command::Seek)
    }),
];

fn search(command: SearchCommand) -> Command {
    Command::Search(command)
}
