//! Missions and files.

use super::arguments::text_argument;
use super::available::{with_deleted, with_file_at_caret, with_network, with_own_mission};
use super::spec::{CTRL, CTRL_SHIFT, called, keys, plain, when};
use crate::command::Command;
use crate::command::chord::Key;
use crate::dialog::Dialog;
use crate::host::FileKind;
use crate::library::LibraryCommand;
use crate::library::{MissionId, TEMPLATES, template};
use crate::mission_file;
use crate::panel_effect::PictureFormat;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::AppState;
use crate::state::files::FileCommand;
use crate::state::networks::NetworkForm;
use crate::state::window::WindowCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    plain(
        "file.missions",
        "Show missions…",
        Group::File,
        &[keys(CTRL_SHIFT, Key::O)],
        Scope::Everywhere,
        |_| Command::Window(WindowCommand::ShowDialog(Dialog::missions())),
    ),
    plain("file.new", "New mission", Group::File, &[], Scope::Everywhere, |_| {
        Command::Library(LibraryCommand::New(&TEMPLATES[0]))
    }),
    plain("file.open", "Open file…", Group::File, &[keys(CTRL, Key::O)], Scope::Everywhere, |_| {
        Command::Window(WindowCommand::OpenFile(FileKind::Mission))
    }),
    plain("file.rename", "Rename mission…", Group::File, &[], Scope::Everywhere, |state| {
        Command::Window(WindowCommand::ShowDialog(Dialog::MissionName {
            name: state.mission_title().to_owned(),
        }))
    }),
    plain("file.duplicate", "Duplicate mission", Group::File, &[], Scope::Everywhere, |_| {
        Command::Library(LibraryCommand::Duplicate(None))
    }),
    when(
        plain("file.toRmpl", "Convert network to RMPL", Group::File, &[], Scope::Everywhere, |_| {
            Command::Library(LibraryCommand::TurnIntoRmpl)
        }),
        AppState::has_read_network,
    ),
    when(
        plain("file.delete", "Delete mission", Group::File, &[], Scope::Everywhere, |_| {
            Command::Library(LibraryCommand::Delete(None))
        }),
        with_own_mission,
    ),
    when(
        plain("file.restore", "Restore deleted mission", Group::File, &[], Scope::Everywhere, |_| {
            Command::Library(LibraryCommand::Restore(None))
        }),
        with_deleted,
    ),
    plain("file.keepVersion", "Save version…", Group::File, &[], Scope::Everywhere, |_| {
        Command::Window(WindowCommand::ShowDialog(Dialog::VersionName { name: String::new() }))
    }),
    plain("file.save", "Save", Group::File, &[keys(CTRL, Key::S)], Scope::Everywhere, |_| {
        Command::SaveMission
    }),
    plain("file.saveAs", "Save as…", Group::File, &[keys(CTRL_SHIFT, Key::S)], Scope::Everywhere, |_| {
        Command::Library(LibraryCommand::SaveMissionFile)
    }),
    plain("file.addFile", "Add file to mission…", Group::File, &[], Scope::Everywhere, |_| {
        Command::Window(WindowCommand::ShowDialog(Dialog::FileName { name: String::new(), renames: false }))
    }),
    when(
        plain("file.renameFile", "Rename file at cursor…", Group::File, &[], Scope::Everywhere, |state| {
            let name =
                state.file_names().get(state.file_at_caret()).map_or_else(String::new, ToString::to_string);
            Command::Window(WindowCommand::ShowDialog(Dialog::FileName { name, renames: true }))
        }),
        with_file_at_caret,
    ),
    when(
        plain("file.removeFile", "Remove file at cursor", Group::File, &[], Scope::Everywhere, |_| {
            Command::Files(FileCommand::Remove)
        }),
        with_file_at_caret,
    ),
    plain("file.importMap", "Import map…", Group::File, &[], Scope::Everywhere, |_| {
        Command::Window(WindowCommand::OpenFile(FileKind::Map))
    }),
    plain("file.share", "Copy mission link", Group::File, &[], Scope::Everywhere, |_| {
        Command::Window(WindowCommand::CopyLink)
    }),
    when(
        plain("file.networkSvg", "Save network as SVG…", Group::File, &[], Scope::Everywhere, |_| {
            Command::Window(WindowCommand::SaveNetwork(PictureFormat::Svg))
        }),
        with_network,
    ),
    when(
        plain("file.networkPng", "Save network as PNG…", Group::File, &[], Scope::Everywhere, |_| {
            Command::Window(WindowCommand::SaveNetwork(PictureFormat::Png))
        }),
        with_network,
    ),
    when(
        plain(
            "file.networkPlanSchema",
            "Save network as plan-schema",
            Group::File,
            &[],
            Scope::Everywhere,
            |_| Command::WriteNetwork(NetworkForm::PlanSchema),
        ),
        with_network,
    ),
    when(
        plain("file.networkPtpn", "Save network as pTPN", Group::File, &[], Scope::Everywhere, |_| {
            Command::WriteNetwork(NetworkForm::Ptpn)
        }),
        with_network,
    ),
    called("file.newFrom", "Create mission from template", Group::File, |_, arguments| {
        let name = text_argument(arguments, "name")?;
        let from_template = template(name).map(LibraryCommand::New);
        let from_example =
            || mission_file::example(name).map(|it| LibraryCommand::NewFromExample(it.name.into()));
        let command = from_template.or_else(from_example).map(Command::Library);
        command.ok_or_else(|| format!("unknown template or example \"{name}\""))
    }),
    called("file.openMission", "Open saved mission", Group::File, |state, arguments| {
        let id = MissionId(text_argument(arguments, "id")?.into());
        state.library.mission(&id).ok_or_else(|| format!("unknown mission \"{}\"", id.0))?;
        Ok(Command::Library(LibraryCommand::Open(id)))
    }),
    called("file.renameTo", "Rename open mission", Group::File, |_, arguments| {
        let name = text_argument(arguments, "name")?.to_owned();
        Ok(Command::Library(LibraryCommand::Rename { id: None, name }))
    }),
    called("file.keepVersionAs", "Save named version", Group::File, |_, arguments| {
        let name = text_argument(arguments, "name")?.to_owned();
        Ok(Command::Library(LibraryCommand::KeepVersion(name)))
    }),
    called("file.addFileNamed", "Add named file", Group::File, |_, arguments| {
        Ok(Command::Files(FileCommand::Add(text_argument(arguments, "name")?.to_owned())))
    }),
    called("file.renameFileTo", "Rename file at cursor", Group::File, |_, arguments| {
        Ok(Command::Files(FileCommand::Rename(text_argument(arguments, "name")?.to_owned())))
    }),
    called("file.example", "Open example", Group::File, |_, arguments| {
        let name = text_argument(arguments, "name")?;
        mission_file::example(name)
            .map(|example| Command::OpenExample(example.name.into()))
            .ok_or_else(|| format!("unknown example \"{name}\""))
    }),
];
