//! Panels, zoom, appearance.

use layout::timeline::Grouping;
use serde_json::Value;

use super::arguments::{panel_argument, text_argument};
use super::available::with_selection;
use super::spec::{ALT, CTRL, PLAIN, SHIFT, called, keys, plain, when};
use crate::command::Command;
use crate::command::chord::Key;
use crate::dialog::Dialog;
use crate::library::LibraryCommand;
use crate::panel_effect::ViewAction;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::settings::SettingsCommand;
use crate::state::settings::ThemeChoice;
use crate::state::window::WindowCommand;
use crate::workspace::Workspace;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    plain(
        "view.author",
        "Show Author workspace",
        Group::View,
        &[keys(CTRL, Key::Num1)],
        Scope::Everywhere,
        |_| Command::ShowWorkspace(Workspace::Author),
    ),
    plain(
        "view.teach",
        "Show Teach workspace",
        Group::View,
        &[keys(CTRL, Key::Num2)],
        Scope::Everywhere,
        |_| Command::ShowWorkspace(Workspace::Teach),
    ),
    plain(
        "view.review",
        "Show Review workspace",
        Group::View,
        &[keys(CTRL, Key::Num3)],
        Scope::Everywhere,
        |_| Command::ShowWorkspace(Workspace::Review),
    ),
    plain(
        "view.execute",
        "Show Execute workspace",
        Group::View,
        &[keys(CTRL, Key::Num4)],
        Scope::Everywhere,
        |_| Command::ShowWorkspace(Workspace::Execute),
    ),
    plain(
        "view.settings",
        "Show settings…",
        Group::View,
        &[keys(CTRL, Key::Comma)],
        Scope::Everywhere,
        |_| Command::Window(WindowCommand::ShowDialog(Dialog::Settings)),
    ),
    plain("view.resetWorkspace", "Reset layout", Group::View, &[], Scope::Everywhere, |_| {
        Command::Window(WindowCommand::ResetWorkspace)
    }),
    plain(
        "view.zoomIn",
        "Zoom in",
        Group::View,
        &[keys(PLAIN, Key::Equals), keys(PLAIN, Key::Plus)],
        Scope::NotTyping,
        |_| Command::Window(WindowCommand::View(ViewAction::ZoomIn)),
    ),
    plain("view.zoomOut", "Zoom out", Group::View, &[keys(PLAIN, Key::Minus)], Scope::NotTyping, |_| {
        Command::Window(WindowCommand::View(ViewAction::ZoomOut))
    }),
    plain("view.zoomReset", "Reset zoom", Group::View, &[keys(PLAIN, Key::Num0)], Scope::NotTyping, |_| {
        Command::Window(WindowCommand::View(ViewAction::ZoomReset))
    }),
    plain("view.fit", "Zoom to fit", Group::View, &[keys(PLAIN, Key::F)], Scope::NotTyping, |_| {
        Command::Window(WindowCommand::View(ViewAction::Fit))
    }),
    when(
        plain(
            "view.fitSelection",
            "Zoom to selection",
            Group::View,
            &[keys(SHIFT, Key::F)],
            Scope::NotTyping,
            |_| Command::Window(WindowCommand::View(ViewAction::FitSelection)),
        ),
        with_selection,
    ),
    plain("view.theme", "Toggle light/dark theme", Group::View, &[], Scope::Everywhere, |state| {
        Command::Settings(SettingsCommand::SetTheme(if state.is_dark() {
            ThemeChoice::Light
        } else {
            ThemeChoice::Dark
        }))
    }),
    plain("view.systemTheme", "Use system theme", Group::View, &[], Scope::Everywhere, |_| {
        Command::Settings(SettingsCommand::SetTheme(ThemeChoice::System))
    }),
    plain(
        "view.textLarger",
        "Increase text size",
        Group::View,
        &[keys(CTRL, Key::Equals), keys(CTRL, Key::Plus)],
        Scope::Everywhere,
        |state| Command::Settings(SettingsCommand::SetTextScale(state.settings.text_scale + 0.1)),
    ),
    plain(
        "view.textSmaller",
        "Decrease text size",
        Group::View,
        &[keys(CTRL, Key::Minus)],
        Scope::Everywhere,
        |state| Command::Settings(SettingsCommand::SetTextScale(state.settings.text_scale - 0.1)),
    ),
    plain("view.textReset", "Reset text size", Group::View, &[], Scope::Everywhere, |_| {
        Command::Settings(SettingsCommand::SetTextScale(1.0))
    }),
    plain(
        "view.wordWrap",
        "Toggle word wrap",
        Group::View,
        &[keys(ALT, Key::Z)],
        Scope::Everywhere,
        |state| {
            let mut views = state.settings.views.clone();
            views.editor.wraps = !views.editor.wraps;
            Command::Settings(SettingsCommand::SetViews(Box::new(views)))
        },
    ),
    plain(
        "view.nextPanel",
        "Focus next panel",
        Group::View,
        &[keys(PLAIN, Key::F6)],
        Scope::Everywhere,
        |_| Command::Window(WindowCommand::TurnPanel(true)),
    ),
    plain(
        "view.previousPanel",
        "Focus previous panel",
        Group::View,
        &[keys(SHIFT, Key::F6)],
        Scope::Everywhere,
        |_| Command::Window(WindowCommand::TurnPanel(false)),
    ),
    plain(
        "view.maximize",
        "Maximize or restore panel",
        Group::View,
        &[keys(ALT, Key::Enter)],
        Scope::Everywhere,
        |_| Command::Window(WindowCommand::Maximize(None)),
    ),
    called("view.saveLayout", "Save layout with mission", Group::View, |_, arguments| {
        let name = text_argument(arguments, "name")?.trim();
        if name.is_empty() {
            return Err("\"name\" must not be empty: a layout needs a name".into());
        }
        Ok(Command::Library(LibraryCommand::SaveLayout(name.to_owned())))
    }),
    called("view.showLayout", "Show saved layout", Group::View, |state, arguments| {
        let name = text_argument(arguments, "name")?;
        let saved = state.library.open_mission().map_or(&[][..], |mission| &mission.layouts);
        let number = saved.iter().position(|layout| layout.name == name);
        let number = number.ok_or_else(|| format!("the mission has no layout \"{name}\""))?;
        Ok(Command::Library(LibraryCommand::ShowLayout(number)))
    }),
    called("view.panel", "Show panel", Group::View, |_, arguments| {
        panel_argument(arguments).map(|panel| Command::Window(WindowCommand::ShowPanel(panel)))
    }),
    called("view.closePanel", "Close panel", Group::View, |_, arguments| {
        panel_argument(arguments).map(|panel| Command::Window(WindowCommand::ClosePanel(panel)))
    }),
    called("view.grouping", "Group timeline rows", Group::View, |state, arguments| {
        let name = text_argument(arguments, "name")?;
        let grouping = Grouping::ALL.into_iter().find(|grouping| grouping.name() == name);
        let mut views = state.settings.views.clone();
        views.timeline.grouping =
            grouping.ok_or("\"name\" must be \"structure\", \"thread\" or \"vehicle\"")?;
        Ok(Command::Settings(SettingsCommand::SetViews(Box::new(views))))
    }),
    called("view.selectTimes", "Select time range", Group::View, |_, arguments| {
        let number = |name: &str| arguments.get(name).and_then(Value::as_f64);
        Ok(Command::SelectTimes(number("from").zip(number("to")).map(|(from, to)| [from, to])))
    }),
    called("view.setTheme", "Choose theme", Group::View, |_, arguments| {
        match text_argument(arguments, "theme")? {
            "dark" => Ok(Command::Settings(SettingsCommand::SetTheme(ThemeChoice::Dark))),
            "light" => Ok(Command::Settings(SettingsCommand::SetTheme(ThemeChoice::Light))),
            "system" => Ok(Command::Settings(SettingsCommand::SetTheme(ThemeChoice::System))),
            other => Err(format!("\"theme\" must be \"dark\", \"light\" or \"system\", not \"{other}\"")),
        }
    }),
    called("view.workspace", "Show workspace", Group::View, |_, arguments| {
        let name = text_argument(arguments, "name")?;
        Workspace::by_name(name)
            .map(Command::ShowWorkspace)
            .ok_or_else(|| format!("unknown workspace \"{name}\""))
    }),
];
