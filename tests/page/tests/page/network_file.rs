//! Networks of other tools, dropped on the page: drawn, planned, reviewed, executed, reported and exported.

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

/// As `RMPyL` writes one: an activity whose duration is nature's.
const PTPN: &str = r#"<?xml version="1.0" ?>
<tpns xmlns="http://mers.csail.mit.edu/tpn"><tpn><id>survey</id><name>survey</name>
<start-event>s</start-event><end-event>e</end-event>
<events><event><id>s</id><name>s</name></event><event><id>e</id><name>e</name></event></events>
<episodes><episode><id>fly</id><name>fly</name><to-event>e</to-event><from-event>s</from-event>
<duration><set-bounded-uncertain-duration><lower-bound>2</lower-bound><upper-bound>5</upper-bound></set-bounded-uncertain-duration></duration>
<dispatch>(fly ridge)</dispatch></episode></episodes></tpn></tpns>"#;

/// As Aerie's command line writes one.
const PLANDEV: &str = r#"{"name": "night", "start_time": "2030-001T00:00:00", "end_time": "2030-001T02:00:00", "id": 1, "model_id": 1,
  "activities": [
    {"type": "Slew", "start_offset": "0:30:00", "metadata": {"enroute_duration": "00:10:00"}, "name": "Slew", "arguments": {"angle": 3},
     "anchor_id": null, "anchored_to_start": true, "id": 1},
    {"type": "Image", "start_offset": "-1 day, 23:55:00", "metadata": {}, "name": "Image", "arguments": {}, "anchor_id": 1,
     "anchored_to_start": true, "id": 2}]}"#;

#[test]
fn ptpns_and_plans_of_plandev_are_dropped_drawn_planned_reported_and_exported() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.evaluate(
        "window.saved = [];
         window.showSaveFilePicker = undefined;
         URL.createObjectURL = (blob) => { blob.text().then((text) => saved.push(text)); return 'blob:none'; }",
    )?;
    for (file, text, name, activity) in
        [("survey.tpn", PTPN, "survey", "(fly ridge)#1"), ("night.json", PLANDEV, "night", "Image#1")]
    {
        page.tab.drop_file(file, text.as_bytes())?;
        page.wait_for(&format!("state.mission === '{name}' && state.status === 'plan'"))?;
        page.settle()?;
        let state = page.state()?;
        assert!(state["plan"]["activities"].to_string().contains(activity), "{}", state["plan"]);
        assert_eq!(state["diagnostics"][0]["code"], "W-NETWORK");
        assert_eq!(page.tab.evaluate("enroute.source()")?, text);
        page.tab
            .evaluate("saved.length = 0; enroute.dispatch('view.review'); enroute.dispatch('file.report')")?;
        page.tab
            .wait_until("saved.some((text) => text.startsWith('<!') && text.includes('not controllable'))")?;
        for (command, arguments, holds) in [
            ("export.schedule", "{ as: 'plandev', epoch: '2030-01-01' }", "start_offset"),
            ("file.networkPtpn", "{}", "<tpns"),
            ("file.networkPlanSchema", "{}", "tpn-type"),
        ] {
            page.tab.evaluate(&format!("saved.length = 0; enroute.dispatch('{command}', {arguments})"))?;
            page.tab.wait_until(&format!("saved.some((text) => text.includes('{holds}'))"))?;
        }
        page.tab.evaluate("enroute.dispatch('file.toRmpl')")?;
        page.wait_for("state.status === 'plan' && state.answeredRevision === state.revision")?;
        assert!(page.tab.evaluate("enroute.source().includes('primitive')")? == true);
    }
    Ok(())
}
