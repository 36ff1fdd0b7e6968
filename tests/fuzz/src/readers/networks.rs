//! Networks of other tools, networks with uncertainty, and plans.

use std::sync::LazyLock;

use interchange::Source;
use interchange::plan_schema::Document;
use stnu::{Document as Uncertain, Layout, check};
use tpn::Network;

use super::{NOTHING, Outcome, Reader, magnitude, nothing, read, refused, text_of};

/// plan-schema and Enroute's own, as JSON and EDN: read, planned, checked, and written so that they can be read again.
pub(super) const NETWORKS: Reader = Reader {
    name: "networks",
    seeds: &[],
    words: &[
        "\"tpn-type\"",
        ":tpn-type",
        "\"temporal-constraint\"",
        "\"parallel-begin\"",
        "\"choice-begin\"",
        "\"end-node\"",
        "\"constraints\"",
        "\"controllable\"",
        "\"guard\"",
        "#{",
        "#_",
        "n1",
        "n2",
        "\"n3\"",
        "[0 10]",
        "[0, \"Infinity\"]",
        "\"anchor_id\": 2",
        "\"start_offset\": \"1 day 00:00:01\"",
        "\"end_time\": \"2024-060T00:00:00+01:00\"",
        "PT1H",
    ],
    mend: nothing,
    exercise: networks,
    tested: 1200,
    keeps_form: 3,
    cost: 1,
};

/// pTPN: read, and written again.
pub(super) const PTPN: Reader = Reader {
    name: "ptpn",
    seeds: &[],
    words: &[
        "<guard>",
        "</guard>",
        "<not>",
        "</not>",
        "<or>",
        "<and/>",
        "<boolean-constant>false</boolean-constant>",
        "<lower-bound>",
        "-INF",
        "INF",
        "<set-bounded-uncertain-duration>",
        "<event><id>a</id></event>",
        "<value>2</value>",
        "aC",
    ],
    mend: nothing,
    exercise: ptpn,
    tested: 1200,
    keeps_form: 3,
    cost: 1,
};

fn ptpn(input: &[u8]) -> Outcome {
    match interchange::ptpn::read(&text_of(input)) {
        Ok(document) => {
            let said = document.not_honored().join(" ");
            let is_written = interchange::ptpn::write(&document.network).is_ok();
            read(&format!("{said} {is_written} {}", magnitude(document.network.nodes.len())))
        }
        Err(reason) => refused(&reason.to_string()),
    }
}

fn networks(input: &[u8]) -> Outcome {
    let text = &*text_of(input);
    let source = match Source::read(text) {
        Ok(source) => source,
        Err(reason) => return refused(&reason.to_string()),
    };
    let said = source.not_honored().join(" ");
    let network = source.into_network();
    let written = interchange::plan_schema::write(&network);
    assert!(Document::parse(&written.to_string()).is_ok(), "what is written can be read");
    let mut left = 200;
    let mut stop = || {
        left -= 1;
        left <= 0
    };
    let outcome = kirk::plan(&network, &kirk::Options::default(), &mut |_: &kirk::Stats| stop());
    let plan = outcome.plans.first();
    if let Some(plan) = plan {
        let _ = verify::check_plan(&network, plan);
        let plan = tpn::plan_json::plan_to_json(&network, plan);
        assert!(tpn::plan_json::plan_from_json(&network, &plan).is_ok(), "what is written can be read");
    }
    let counts = [network.nodes.len(), network.arcs.len(), network.decisions.len()].map(magnitude);
    read(&format!("{} {} {said}", plan.is_some(), String::from_iter(counts)))
}

/// Networks with uncertainty in both layouts: decided, or said to be too large, and written.
pub(super) const UNCERTAIN: Reader = Reader {
    name: "uncertain-networks",
    seeds: &[],
    words: &[
        "Z",
        "inf",
        "<!--",
        "UC(",
        "LC(",
        "contingent",
        "<edge ",
        "<data key=\"Value\">",
        "# Contingent Links\n",
    ],
    mend: nothing,
    exercise: uncertain,
    tested: 4000,
    keeps_form: 3,
    cost: 1,
};

fn uncertain(input: &[u8]) -> Outcome {
    let document = match Uncertain::parse(&text_of(input)) {
        Ok(document) => document,
        Err(reason) => return refused(&reason.to_string()),
    };
    let _ = check(&document.network, &mut || false);
    for layout in [Layout::Plain, Layout::GraphMl] {
        let written = document.write(layout);
        let again = Uncertain::parse(&written);
        assert_eq!(again.map(|read| read.names.len()), Ok(document.names.len()), "{layout:?}: {written}");
    }
    read(&String::from(magnitude(document.names.len())))
}

/// Plans of a mission: read, and held against the network by the checker.
pub(super) const PLANS: Reader = Reader {
    name: "plans",
    seeds: &[],
    words: &[
        "\"choices\"",
        "\"windows\"",
        "\"causal_links\"",
        "\"conflict_order\"",
        "\"levels\"",
        "[0, 1]",
        "null",
    ],
    mend: nothing,
    exercise: plans,
    tested: 1200,
    keeps_form: 3,
    cost: 1,
};

/// A mission with links.
static NETWORK: LazyLock<Network> = LazyLock::new(|| {
    let program = rmpl::parse(include_str!("../../../../assets/missions/causal-links.rmpl")).program();
    mission::compile(&program, &snapshot::Goal::Default, &mut Vec::new()).expect("the example")
});

fn plans(input: &[u8]) -> Outcome {
    let network = &*NETWORK;
    let value: serde_json::Value = match serde_json::from_str(&text_of(input)) {
        Ok(value) => value,
        Err(_) => return NOTHING,
    };
    match tpn::plan_json::plans_from_json(network, &value) {
        Ok(plans) => {
            for plan in &plans {
                let written = tpn::plan_json::plan_to_json(network, plan);
                assert!(
                    tpn::plan_json::plan_from_json(network, &written).is_ok(),
                    "what is written can be read"
                );
            }
            let verdicts: Vec<_> = plans.iter().map(|plan| verify::check_plan(network, plan)).collect();
            read(&format!("{verdicts:?}"))
        }
        Err(reason) => refused(&reason.to_string()),
    }
}
