//! A mission is executed in the page, and something goes wrong with it by hand.

use anyhow::{Context as _, Result};
use serde_json::{Value, json};

use crate::opened::Opened;

/// The page in which the mission with both paths is executed, at this time.
fn executing(time: u32) -> Result<Opened> {
    let page = Opened::with_fragment("mission=both-paths&workspace=execute")?;
    // High enough to show all that can go wrong.
    page.tab.resize(1280, 1500)?;
    page.settle()?;
    page.wait_for("state.execution !== null && !state.execution.isWorking")?;
    page.tab.evaluate(&format!("enroute.dispatch('play.seek', {{ time: {time} }})"))?;
    page.wait_for(&format!("state.time === {time}"))?;
    page.tab.next_frame()?;
    Ok(page)
}

/// The kinds of the entries of the log up to the time shown.
fn kinds(page: &Opened) -> Result<Vec<String>> {
    let log = page.state()?["execution"]["log"].clone();
    let entries = log.as_array().context("a log")?;
    Ok(entries.iter().filter_map(|entry| entry["event"].as_str().map(str::to_owned)).collect())
}

/// The rovers wait until 10 for the first path, which is withdrawn at 5; the second one opens at 300.
#[test]
fn withdrawing_the_window_of_path_1_while_the_rovers_wait_sends_them_by_path_2() -> Result<()> {
    let page = executing(5)?;
    assert_eq!(page.state()?["plan"]["choices"], json!({ "D1": 0 }));
    let (before, past) = (page.look()?, kinds(&page)?);
    page.tab.click_widget("button", "Withdraw Tell(PATH1=OK)#1")?;
    page.wait_for("state.plan?.choices.D1 === 1 && !state.execution.isWorking")?;

    let execution = page.state()?["execution"].clone();
    assert_eq!(
        execution["disturbances"],
        json!([{ "kind": "withdrawn", "condition": "Tell(PATH1=OK)#1", "at": 5 }])
    );
    let after = kinds(&page)?;
    assert_eq!(after[..past.len()], past, "the past is as it was");
    assert_eq!(after[past.len()..], ["violation", "replanned"]);
    assert!(page.look()?.difference(&before) > 0.01, "network, timeline and map show the other way");
    assert!(
        !execution["waitedFor"].to_string().contains("PATH1"),
        "nobody waits for what will not come: {execution}"
    );

    // SPEC 3.6 for the second path: it opens at 300, and the drive takes 405 at least.
    let windows = page.state()?["plan"]["windows"].clone();
    assert_eq!(windows["Group-Traverse-Path#2.start"][0], 300);
    assert_eq!(windows["Group-Traverse-Path#2.end"][0], 705);
    assert_eq!(windows["Group-Traverse-Path#1.start"], Value::Null);

    page.tab.evaluate("enroute.dispatch('play.seek', { time: 520 })")?;
    page.wait_for("state.execution.underWay.includes('Group-Traverse-Path#2')")?;
    let east_m = page.state()?["vehicles"][0]["x"].as_f64().context("Rover1 is somewhere")?;
    assert!(east_m > 120.0, "it is past the first place of the second path: {east_m}");
    page.tab.evaluate("enroute.dispatch('play.end')")?;
    page.wait_for("state.execution.status === 'finished'")
}

#[test]
fn a_vehicle_stops_and_an_obstacle_appears_by_hand_and_both_are_taken_back() -> Result<()> {
    let page = executing(100)?;
    let free = page.state()?["execution"]["log"].clone();
    page.tab.evaluate("enroute.dispatch('terrain.appear')")?;
    page.wait_for("state.terrain.tool === 'appear'")?;
    // A place to the side of the paths, on which nothing else stands.
    let map = page.tab.widget("img", "Terrain")?;
    page.tab.click(map.x + 0.5 * map.width, map.y + 0.66 * map.height)?;
    page.wait_for("state.execution.disturbances.length === 1 && !state.execution.isWorking")?;
    let obstacle = page.state()?["execution"]["disturbances"][0].clone();
    assert_eq!(
        (&obstacle["kind"], &obstacle["at"], &obstacle["radius"]),
        (&json!("obstacle"), &json!(100), &json!(5))
    );
    page.wait_for("state.terrain.tool === 'look'")?;

    page.tab.click_widget("button", "Stop Rover2")?;
    page.wait_for("state.execution.disturbances.length === 2 && !state.execution.isWorking")?;
    let stop = page.state()?["execution"]["disturbances"][1].clone();
    assert_eq!(
        stop,
        json!({ "kind": "vehicle-slow", "vehicle": "Rover2", "factor": 0, "from": 100, "until": 120 })
    );
    assert_eq!(page.state()?["execution"]["log"], free, "what happened until now stays as it was");
    page.tab.evaluate("enroute.dispatch('execute.reset')")?;
    page.wait_for("state.execution.disturbances.length === 0")
}

/// The camera that the mission starts fails while it comes up: what was to be set has not come, and the other camera looks.
#[test]
fn a_component_that_fails_by_hand_sends_the_mission_to_the_other_one() -> Result<()> {
    let page = Opened::with_fragment("mission=flyby&workspace=execute")?;
    page.tab.resize(1280, 1500)?;
    page.settle()?;
    page.wait_for("state.execution !== null && !state.execution.isWorking")?;
    assert_eq!(page.state()?["plan"]["choices"], json!({ "D1": 0 }));
    page.tab.evaluate("enroute.dispatch('play.seek', { time: 1 })")?;
    page.wait_for("state.execution.underWay.includes('Start-Up#1')")?;
    page.tab.next_frame()?;
    // The component and the mode that it can come into by a fault stand first in the lists, and the next step is offered.
    page.tab.click_widget("button", "Let it happen")?;
    page.wait_for("state.execution.disturbances.length === 1 && !state.execution.isWorking")?;
    let fault = page.state()?["execution"]["disturbances"][0].clone();
    assert_eq!(
        fault,
        json!({ "kind": "fault", "activity": "Start-Up#1", "step": 1, "component": "CameraA", "mode": "Failed" })
    );
    page.tab.evaluate("enroute.dispatch('play.end')")?;
    page.wait_for("state.execution.status === 'finished'")?;
    assert_eq!(page.state()?["plan"]["choices"], json!({ "D1": 1 }));
    let log = page.state()?["execution"]["log"].clone();
    let log = log.as_array().context("a log")?;
    let happens = |name: &str| log.iter().any(|entry| entry["name"] == name);
    assert!(happens("Look#2.end") && !happens("Look#1.start"), "{log:?}");
    let says =
        |part: &str| log.iter().any(|entry| entry["reason"].as_str().is_some_and(|it| it.contains(part)));
    assert!(says("Calibrate#1 needs CameraA.mode=Ready"), "{log:?}");

    // Nothing goes otherwise that means nothing, or before now.
    let wrong = "enroute.dispatch('execute.disturb', { kind: 'duration', activity: 'Turn#1', duration: -5 })";
    page.tab.evaluate(&format!("(() => {{ try {{ {wrong} }} catch (error) {{ }} }})()"))?;
    page.tab.next_frame()?;
    assert_eq!(page.state()?["execution"]["disturbances"].as_array().map(Vec::len), Some(1));
    Ok(())
}
