//! A network of another tool, dropped on the page: drawn, planned, reviewed, executed, reported and exported.

use anyhow::Result;

use crate::opened::Opened;

/// Two activities of rovers one after the other, or a delay, with a cost.
const NETWORK: &str = r#"{"network-id": "net",
  "net": {"uid": "net", "tpn-type": "network", "begin-node": "n1", "end-node": "n3"},
  "n1": {"uid": "n1", "tpn-type": "c-begin", "activities": ["a1", "a3"], "constraints": ["whole"], "end-node": "n3"},
  "n2": {"uid": "n2", "tpn-type": "state", "activities": ["a2"], "constraints": []},
  "n3": {"uid": "n3", "tpn-type": "c-end", "activities": [], "constraints": []},
  "a1": {"uid": "a1", "tpn-type": "activity", "name": "Drive", "end-node": "n2", "constraints": ["c1"], "cost": 7},
  "a2": {"uid": "a2", "tpn-type": "activity", "name": "Dig", "end-node": "n3", "constraints": ["c2"]},
  "a3": {"uid": "a3", "tpn-type": "delay-activity", "end-node": "n3", "constraints": ["c3"]},
  "c1": {"uid": "c1", "tpn-type": "temporal-constraint", "value": [2, 5], "end-node": "n2"},
  "c2": {"uid": "c2", "tpn-type": "temporal-constraint", "value": [3, 6], "end-node": "n3"},
  "c3": {"uid": "c3", "tpn-type": "temporal-constraint", "value": [8, 9], "end-node": "n3"},
  "whole": {"uid": "whole", "tpn-type": "temporal-constraint", "value": [1, 100], "end-node": "n3"}}"#;

#[test]
fn a_network_that_is_dropped_is_a_mission_like_any_other() -> Result<()> {
    let page = Opened::planned()?;
    // What is saved is caught instead of downloaded.
    page.tab.evaluate(
        "window.saved = [];
         window.showSaveFilePicker = undefined;
         URL.createObjectURL = (blob) => { blob.text().then((text) => saved.push(text)); return 'blob:none'; }",
    )?;
    page.tab.drop_file("first.tpn.json", NETWORK.as_bytes())?;
    page.wait_for("state.mission === 'first' && state.status === 'plan'")?;
    page.settle()?;
    let state = page.state()?;
    assert_eq!(state["diagnostics"].as_array().map(Vec::len), Some(1), "{}", state["diagnostics"]);
    assert_eq!(state["diagnostics"][0]["code"], "W-NETWORK");
    assert_eq!(page.tab.evaluate("enroute.source()")?, NETWORK);
    assert_eq!(state["plan"]["activities"], serde_json::json!(["Dig#1", "Drive#1"]));

    page.tab.evaluate("enroute.dispatch('view.execute')")?;
    page.wait_for("state.execution !== null && !state.execution.isWorking")?;
    page.tab.evaluate("enroute.dispatch('play.end')")?;
    page.wait_for("state.execution.status === 'finished'")?;
    page.tab.evaluate("enroute.dispatch('view.review')")?;
    page.tab.evaluate("enroute.dispatch('file.report')")?;
    page.tab.wait_until(
        "saved.some((text) => text.startsWith('<!') && text.includes('Dig') && text.includes('a cost'))",
    )?;
    page.tab.evaluate("enroute.dispatch('export.schedule', { as: 'csv' })")?;
    page.tab.wait_until("saved.some((text) => text.includes('Dig#1,primitive,Dig'))")?;

    // It is edited like any other text, and found again.
    page.place_caret_after("\"value\": [2, ")?;
    page.type_text("1")?;
    page.wait_for("state.status === 'plan' && state.answeredRevision === state.revision")?;
    page.tab.evaluate("enroute.setSource(enroute.source().replace('[3, 6]', '[6, 3]'))")?;
    page.wait_for("state.diagnostics.length === 1 && state.diagnostics[0].code === 'E-NETWORK'")?;
    Ok(())
}
