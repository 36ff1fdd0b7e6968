//! The network panel as a user meets it: pointing, selecting, searching, collapsing, and a text with errors.

mod support;

use egui::Key;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use serde_json::json;

use app::host::Remote as _;

fn started() -> support::App {
    let mut app = support::start();
    app.settle();
    app
}

fn has(app: &support::App, label: &str) -> bool {
    app.harness.query_all_by_label(label).next().is_some()
}

#[test]
fn the_network_says_what_it_shows() {
    let app = started();
    let nodes = app.json()["tpn"]["nodes"]
        .as_array()
        .map(Vec::len)
        .or_else(|| app.json()["tpn"]["nodes"].as_u64().map(|count| count as usize));
    let nodes = nodes.expect("the state tells how many nodes there are");
    let found = app.harness.query_all_by_role(egui::Role::Image).any(|node| {
        node.accesskit_node().label().is_some_and(|label| {
            label.starts_with(&format!("Network. {nodes} events")) && label.contains("Chosen: D1=0.")
        })
    });
    assert!(found, "no image says so");
}

#[test]
fn clicking_an_activity_selects_it_everywhere() {
    let mut app = started();
    app.harness.get_by_role_and_label(egui::Role::Button, "Group-Wait#1 in the network").click();
    app.settle();
    assert_eq!(app.json()["selection"]["name"], json!("Group-Wait#1"));
    app.harness.get_by_role_and_label(egui::Role::Button, "D1 in the network").click();
    app.settle();
    assert_eq!(app.json()["selection"]["name"], json!("D1"));
}

#[test]
fn searching_selects_one_match_after_the_other() {
    let mut app = started();
    let field = app.harness.get_by_role_and_label(egui::Role::TextInput, "Find in the network");
    field.focus();
    app.settle();
    app.harness.get_by_role_and_label(egui::Role::TextInput, "Find in the network").type_text("traverse");
    app.settle();
    app.harness.key_press(Key::Enter);
    app.settle();
    assert_eq!(app.json()["selection"]["name"], json!("Group-Traverse-Path#1"));
    app.harness.key_press(Key::Enter);
    app.settle();
    assert_eq!(app.json()["selection"]["name"], json!("Group-Traverse-Path#2"));
}

#[test]
fn a_text_with_errors_keeps_the_last_network_and_says_so() {
    let mut app = started();
    let source = app.harness.state().source();
    app.harness.state_mut().set_source(&format!("{source}\nscenario {{"));
    app.settle();
    assert!(has(&app, "Group-Wait#1 in the network"), "the network is still there");
    let says_so = app.harness.query_all_by_role(egui::Role::Image).any(|node| {
        node.accesskit_node()
            .label()
            .is_some_and(|label| label.starts_with("Network of the last text without errors"))
    });
    assert!(says_so);
}

#[test]
fn a_double_click_closes_an_activity_and_another_opens_it() {
    let mut app = started();
    let double_click = |app: &mut support::App, label: &str| {
        for _ in 0..2 {
            app.harness.get_by_role_and_label(egui::Role::Button, label).click();
        }
        app.settle();
        app.settle();
    };
    assert!(has(&app, "Group-Transmit#1 in the network"));
    double_click(&mut app, "Group-Enroute#1 in the network");
    assert!(!has(&app, "Group-Transmit#1 in the network"), "what is inside is hidden");
    // Apart from the clicks before, so that the four do not count as one.
    for _ in 0..40 {
        app.settle();
    }
    double_click(&mut app, "Group-Enroute#1 in the network");
    assert!(has(&app, "Group-Transmit#1 in the network"), "and comes back");
}
