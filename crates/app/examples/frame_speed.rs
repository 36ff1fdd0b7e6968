//! Measures how long a frame takes natively while the network and the timeline are dragged, and how long an event takes
//! to drag, at about 1,000 and 10,000 nodes: `cargo run -p app --example frame_speed`.

#[path = "../tests/it/support/mod.rs"]
mod support;

use std::time::{Duration, Instant};

use egui::{Pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use serde_json::json;
use tpn::generate::{Recipe, Tightness, mission};
use workbench::command::Command;
use workbench::host_io::Remote as _;
use workbench::state::PinCommand;

const STEPS: usize = 80;

fn main() {
    for nodes in [1_000, 10_000] {
        let source = mission(Recipe { nodes, tightness: Tightness::Feasible, seed: 1 });
        let mut app = support::start();
        app.settle();
        app.harness.state_mut().run(Command::OpenSource { name: "long".into(), source });
        app.settle();
        app.harness.state_mut().dispatch("view.workspace", &json!("review")).expect("a workspace");
        app.settle();
        let is_network = |node: &egui_kittest::Node<'_>| {
            node.accesskit_node().label().is_some_and(|label| label.starts_with("Network. "))
        };
        let network =
            app.harness.query_all_by_role(egui::Role::Image).find(is_network).expect("a network").rect();
        let axis = app.harness.get_by_label("Time axis").rect();
        report(nodes, "still", pan(&mut app, None));
        report(nodes, "pan network", pan(&mut app, Some(network.center())));
        report(nodes, "pan timeline", pan(&mut app, Some(axis.center() + vec2(0.0, 80.0))));
        report(nodes, "drag event", drag_event(&mut app));
    }
}

/// The times of frames while a place is dragged to and fro.
fn pan(app: &mut support::App, place: Option<Pos2>) -> Vec<Duration> {
    if let Some(place) = place {
        app.harness.hover_at(place);
        app.settle();
        app.harness.drag_at(place);
        app.settle();
    }
    let mut times = Vec::new();
    for step in 0..STEPS {
        if let Some(place) = place {
            let away = 40.0 * (step as f32 / STEPS as f32 * std::f32::consts::TAU).sin();
            app.harness.hover_at(place + vec2(away, 0.0));
        }
        let begun = Instant::now();
        app.harness.step();
        times.push(begun.elapsed());
    }
    if let Some(place) = place {
        app.harness.drop_at(place);
        app.settle();
    }
    times
}

/// The times that a move of an event takes until all windows are known; the first holds the taking hold of it.
fn drag_event(app: &mut support::App) -> Vec<Duration> {
    let shown = app.harness.state().app_state().shown().cloned().expect("a snapshot");
    let (network, plan) = (shown.network.as_deref().expect("a network"), shown.plan().expect("a plan"));
    let slack = |node: &tpn::NodeId| {
        let window = plan.windows[node.index()];
        window.and_then(|it| it.latest.finite()?.checked_sub(it.earliest)).unwrap_or_default()
    };
    let nodes = (0..network.nodes.len()).map(tpn::NodeId::from_index);
    let node = nodes.max_by_key(slack).expect("an event");
    let earliest = plan.windows[node.index()].expect("it is selected").earliest;
    let mut times = Vec::new();
    for step in 0..STEPS as i64 {
        let begun = Instant::now();
        let state = app.harness.state_mut();
        if step == 0 {
            state.run(Command::Pins(PinCommand::Grab(node)));
        }
        state
            .run(Command::Pins(PinCommand::MoveTo(earliest.checked_add(step.into()).expect("a small time"))));
        times.push(begun.elapsed());
    }
    app.harness.state_mut().run(Command::Pins(PinCommand::ReleaseAll));
    times
}

#[expect(clippy::print_stdout, reason = "the figures are this program's answer")]
fn report(nodes: usize, what: &str, mut times: Vec<Duration>) {
    times.sort();
    let at = |part: usize| times[(times.len() * part / 100).min(times.len() - 1)];
    println!("{nodes} nodes, {what}: median {:?}, 90% {:?}, most {:?}", at(50), at(90), at(100));
}
