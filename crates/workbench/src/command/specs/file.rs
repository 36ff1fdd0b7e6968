//! Missions and files.

use super::arguments::text_argument;
use super::available::{with_earlier_draft, with_network};
use super::{CTRL, called, keys, plain, when};
use crate::command::chord::Key;
use crate::command::registry::{CommandSpec, Group, Scope};
use crate::command::{Command, PictureFormat};
use crate::host::FileKind;
use crate::mission_file;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    plain("file.open", "Open a mission…", Group::File, &[keys(CTRL, Key::O)], Scope::Everywhere, |_| {
        Command::OpenFile(FileKind::Mission)
    }),
    when(
        plain("file.openDraft", "Bring back the last draft", Group::File, &[], Scope::Everywhere, |_| {
            Command::OpenEarlierDraft
        }),
        with_earlier_draft,
    ),
    plain("file.save", "Save the mission", Group::File, &[keys(CTRL, Key::S)], Scope::Everywhere, |_| {
        Command::SaveMission
    }),
    plain("file.importMap", "Import a map…", Group::File, &[], Scope::Everywhere, |_| {
        Command::OpenFile(FileKind::Map)
    }),
    plain("file.share", "Copy a link to this mission", Group::File, &[], Scope::Everywhere, |_| {
        Command::CopyLink
    }),
    when(
        plain("file.networkSvg", "Save the network as SVG…", Group::File, &[], Scope::Everywhere, |_| {
            Command::SaveNetwork(PictureFormat::Svg)
        }),
        with_network,
    ),
    when(
        plain("file.networkPng", "Save the network as PNG…", Group::File, &[], Scope::Everywhere, |_| {
            Command::SaveNetwork(PictureFormat::Png)
        }),
        with_network,
    ),
    called("file.example", "Open an example", Group::File, |_, arguments| {
        let name = text_argument(arguments, "name")?;
        mission_file::example(name)
            .map(|example| Command::OpenExample(example.name.into()))
            .ok_or_else(|| format!("there is no example \"{name}\""))
    }),
];
