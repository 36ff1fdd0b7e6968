//! Constraints that other tools leave without an end.

use exact::{Bound, Time};
use serde_json::json;

use super::Document;

#[test]
fn a_constraint_without_an_end_is_about_what_lists_it() {
    let objects = json!({
        "network-id": "net",
        "net": {"tpn-type": "network", "begin-node": "begin", "end-node": "end"},
        "begin": {"tpn-type": "p-begin", "end-node": "end", "activities": ["fork"], "constraints": ["whole"]},
        "fork": {"tpn-type": "null-activity", "end-node": "first"},
        "first": {"tpn-type": "state", "activities": ["drive"], "constraints": []},
        "drive": {"tpn-type": "activity", "name": "drive", "end-node": "last", "constraints": ["duration"]},
        "last": {"tpn-type": "state", "activities": ["join"], "constraints": []},
        "join": {"tpn-type": "null-activity", "end-node": "end"},
        "end": {"tpn-type": "p-end", "activities": [], "constraints": []},
        "duration": {"tpn-type": "temporal-constraint", "value": [3, 5], "end-node": null},
        "whole": {"tpn-type": "temporal-constraint", "value": [4, 9], "end-node": null},
    });
    let document = Document::parse(&objects.to_string()).unwrap_or_else(|error| panic!("{error}"));
    let arcs = |uid: &str| {
        let of_uid = document.arc_uids.iter().position(|it| it.as_deref() == Some(uid));
        &document.network.arcs[of_uid.unwrap_or_else(|| panic!("no arc of {uid}"))]
    };
    let bounds = |lower: i64, upper: i64| (Time::from(lower), Bound::Finite(Time::from(upper)));
    assert_eq!((arcs("drive").lower, arcs("drive").upper), bounds(3, 5));
    let whole = arcs("whole");
    assert_eq!((whole.lower, whole.upper), bounds(4, 9));
    assert_eq!((whole.from, whole.to), (document.network.start, document.network.end));
    // What has no end itself leaves its constraint without one.
    let mut without = objects.clone();
    without["last"]["constraints"] = json!(["whole"]);
    let error = Document::parse(&without.to_string()).unwrap_err().to_string();
    assert_eq!(error, "`whole` has no `end-node`");
}
