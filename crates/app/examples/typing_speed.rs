//! Measures how long a frame and a keystroke take in the editor with a long text: `cargo run -p app --example typing_speed`.

mod figures;
#[path = "../tests/it/support/mod.rs"]
mod support;

use std::time::Instant;

use text_editing::TextCommand;
use workbench::command::Command;

use figures::report;

const LINES: usize = 10_000;
const KEYS: usize = 200;

fn main() {
    let mut source = String::new();
    for line in 0..LINES / 4 {
        source.push_str(&format!("Step-{line}()[l,u] = {{\n  Drive(A, B)[l*50%,u];\n  delay[0,inf]\n}}\n"));
    }
    let world = std::rc::Rc::<support::World>::default();
    let mut app = support::start_in(std::rc::Rc::clone(&world), |builder| builder);
    app.settle();
    // Only the front end is measured: planning runs elsewhere.
    world.is_deaf.set(true);
    app.harness.state_mut().run(Command::OpenSource { name: "long".into(), source });
    let middle = app.harness.state().app_state().document.text().len() / 2;
    app.harness.state_mut().run(Command::Text(TextCommand::Select { anchor: middle, head: middle }));
    app.settle();
    let mut keys = Vec::new();
    let mut frames = Vec::new();
    for _ in 0..KEYS {
        let begun = Instant::now();
        app.harness.state_mut().run(Command::Text(TextCommand::Insert("x".to_owned())));
        keys.push(begun.elapsed());
        let begun = Instant::now();
        app.harness.step();
        frames.push(begun.elapsed());
    }
    report("key", keys);
    report("frame", frames);
}
