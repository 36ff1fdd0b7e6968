//! What is computed after a command: only what depends on what the command changed.

use serde_json::json;
use test_support::start;
use text_editing::TextCommand;
use workbench::command::Command;
use workbench::host_io::Remote as _;
use workbench::state::Selection;
use workbench::state::derived::Derivation::{
    self, Conflicts, Extent, Folding, Language, Lesson, Moment, Program, Questions, Review,
};

fn computed(command: Command) -> Vec<Derivation> {
    let mut app = start();
    app.session.apply(vec![command]);
    let mut computed = app.session.state().derived.latest().to_vec();
    computed.dedup();
    computed
}

#[test]
fn what_does_not_depend_on_a_command_is_not_computed_after_it() {
    let typed = computed(Command::Text(TextCommand::Insert(" ".to_owned())));
    assert_eq!(typed, [Language, Folding, Program, Conflicts, Review, Lesson, Questions]);
    assert_eq!(computed(Command::Seek(10.0)), [Moment, Lesson]);
    assert_eq!(computed(Command::Hover(Selection::None)), []);
    assert_eq!(computed(Command::ShowReason(0)), []);
}

#[test]
fn another_workspace_shows_another_time_of_another_thing() {
    let mut app = start();
    app.session.dispatch("view.workspace", &json!({ "name": "execute" })).expect("a workspace");
    let computed = app.session.state().derived.latest().to_vec();
    assert!(computed.contains(&Extent) && computed.contains(&Moment), "{computed:?}");
    assert!(!computed.contains(&Language), "{computed:?}");
}
