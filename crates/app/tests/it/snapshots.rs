//! Snapshots of the workspaces: every widget with its role, its name and its place, as assistive technologies are told.
//! They are texts, so that they need no graphics and a change of one panel can be read.
//!
//! After an intended change, `UPDATE_SNAPSHOTS=1 cargo test -p app --test it snapshots` updates them.

use crate::support;
use std::fmt::Write as _;
use std::path::Path;

use egui_kittest::kittest::NodeT as _;
use workbench::command::Command;
use workbench::workspace::Workspace;

/// Names longer than this are cut: the mission's text is one.
const MAX_CHARACTERS: usize = 80;

fn outline(app: &support::App) -> String {
    let mut text = String::new();
    for node in app.harness.root().children_recursive() {
        let node = node.accesskit_node();
        // A label's own text says the same again.
        if node.role() == egui::accesskit::Role::TextRun {
            continue;
        }
        let (Some(name), Some(area)) = (node.label().or_else(|| node.value()), node.bounding_box()) else {
            continue;
        };
        let name: String = name.replace('\n', "⏎").chars().take(MAX_CHARACTERS).collect();
        let (width, height) = (area.x1 - area.x0, area.y1 - area.y0);
        let _ = writeln!(
            text,
            "{:?} \"{name}\" at {:.0},{:.0} size {width:.0}×{height:.0}",
            node.role(),
            area.x0,
            area.y0
        );
    }
    text
}

fn assert_snapshot(workspace: Workspace) {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().run(Command::ShowWorkspace(workspace));
    app.settle();
    let now = outline(&app);
    assert!(now.lines().count() > 40, "the workspace is empty:\n{now}");
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/it/snapshots/{}.txt", workspace.name()));
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(&path, &now).expect("the snapshot can be written");
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    let differing = now.lines().zip(kept.lines()).find(|(now, kept)| now != kept);
    assert!(
        now == kept,
        "{} differs from the workspace as it is, first in {differing:?}; see this file's first lines",
        path.display()
    );
}

#[test]
fn author_is_as_it_was() {
    assert_snapshot(Workspace::Author);
}

#[test]
fn teach_is_as_it_was() {
    assert_snapshot(Workspace::Teach);
}

#[test]
fn review_is_as_it_was() {
    assert_snapshot(Workspace::Review);
}

#[test]
fn execute_is_as_it_was() {
    assert_snapshot(Workspace::Execute);
}
