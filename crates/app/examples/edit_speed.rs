//! Measures what an edit of a large mission costs: the core's answer, and the frame that shows it. `cargo run -p app
//! --release --example edit_speed -- 10000`; panels are those of the Author workspace.

mod figures;
#[path = "../tests/it/support/mod.rs"]
mod support;

use std::time::Instant;

use text_editing::TextCommand;
use tpn::generate::{Recipe, Tightness, mission};
use workbench::command::Command;

use figures::report;

const EDITS: usize = 20;

fn main() {
    let nodes = std::env::args().nth(1).and_then(|size| size.parse().ok()).unwrap_or(10_000);
    let source = mission(Recipe { nodes, tightness: Tightness::Feasible, seed: 1 });
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().run(Command::OpenSource { name: "large".into(), source });
    app.settle();
    let text = app.harness.state().app_state().document.text().to_string();
    // The first bound with two digits, of which the last one is typed again.
    let at = text.find("0,").or_else(|| text.find("1,")).unwrap_or(0);
    let (mut keys, mut answers, mut idle) = (Vec::new(), Vec::new(), Vec::new());
    for edit in 0..EDITS {
        app.harness.state_mut().run(Command::Text(TextCommand::Select { anchor: at, head: at + 1 }));
        app.harness.step();
        let digit = if edit % 2 == 0 { "1" } else { "0" };
        let begun = Instant::now();
        app.harness.state_mut().run(Command::Text(TextCommand::Insert(digit.to_owned())));
        keys.push(begun.elapsed());
        let begun = Instant::now();
        app.harness.step();
        answers.push(begun.elapsed());
        app.settle();
        let begun = Instant::now();
        app.harness.step();
        idle.push(begun.elapsed());
    }
    report("edit, with the core's answer", keys);
    report("frame that shows it", answers);
    report("frame at rest", idle);
}
