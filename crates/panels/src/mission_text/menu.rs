//! What the menu of the mission text offers: commands of the registry.

use editor::MenuEntry;
use workbench::command::Command;
use workbench::registry;
use workbench::state::AppState;

/// The commands with their keys; the first three are about the clipboard, the others about what is under the pointer.
const ENTRIES: [(&str, &str); 6] = [
    ("edit.cut", "Ctrl+X"),
    ("edit.copy", "Ctrl+C"),
    ("edit.paste", "Ctrl+V"),
    ("go.definition", "F12"),
    ("edit.rename", "F2"),
    ("edit.quickFix", "Ctrl+."),
];

/// How many of them are about the clipboard.
pub(super) const CLIPBOARD: usize = 3;

/// The entries as the editor shows them.
pub(super) fn entries(state: &AppState) -> Vec<MenuEntry<'static>> {
    let known = ENTRIES.iter().filter_map(|&(id, keys)| Some((registry::by_id(id)?, keys)));
    let entry = known.map(|(spec, keys)| MenuEntry {
        label: spec.title,
        keys,
        unavailable: (spec.available)(state).err(),
    });
    entry.collect()
}

/// Returns what an entry does.
pub(super) fn command(state: &AppState, index: usize) -> Option<Command> {
    ENTRIES.get(index).and_then(|(id, _)| registry::by_id(id))?.plain(state)
}
