//! The page works out exactly what the native build works out.

use std::sync::LazyLock;

use anyhow::{Context as _, Result};
use serde_json::{Value, json};
use workbench::{host_io::Remote as _, mission_file::EXAMPLES};

use crate::opened::Opened;

/// What the page says of a mission that must be the same everywhere.
pub(crate) const PARTS: [&str; 9] =
    ["mission", "status", "diagnostics", "tpn", "plan", "verdict", "failure", "vehicles", "traverses"];

/// The name of each example, the hash of its content, and the parts of its state, all as the native build has them.
static NATIVE: LazyLock<Vec<(&str, Value)>> = LazyLock::new(|| {
    let mut native = test_support::start();
    let mut expected = Vec::new();
    for example in EXAMPLES {
        native.session.open(example.name).expect("an example");
        native.settle();
        if native.json()["plan"].is_object() {
            native.dispatch("review.run", &Value::Null);
            native.settle();
        }
        let state = native.json();
        let parts: Vec<&Value> = PARTS.iter().map(|&part| &state[part]).collect();
        let all = json!({ "parts": parts, "hash": state["review"]["hash"] });
        expected.push((example.name, as_javascript_writes(&all)));
    }
    expected
});

/// Opens all examples with `ask`, which evaluates JavaScript in a page, and holds what comes of each against the native build.
pub(crate) fn every_example_is_the_same(mut ask: impl FnMut(&str) -> Result<Value>) -> Result<()> {
    ask("enroute.dispatch('view.workspace', { name: 'review' })")?;
    for (name, expected) in NATIVE.iter() {
        ask(&format!("enroute.open({})", json!(name)))?;
        let found = ask(&format!(
            "new Promise((done) => {{
                const look = () => {{
                    const state = enroute.state();
                    const isDone = state.status !== 'working' && state.answeredRevision === state.revision
                        && (state.plan === null || (state.review.hash !== null && !state.review.stale));
                    if (!isDone) return setTimeout(look, 20);
                    // Without a plan, the page may or may not have asked for a review yet; the native build does not ask.
                    const hash = state.plan === null ? null : state.review.hash;
                    done({{ parts: {}.map((part) => state[part]), hash }});
                }};
                look();
            }})",
            json!(PARTS)
        ))
        .with_context(|| format!("opening {name}"))?;
        for (part, (found, expected)) in PARTS.iter().zip(
            found["parts"]
                .as_array()
                .into_iter()
                .flatten()
                .zip(expected["parts"].as_array().into_iter().flatten()),
        ) {
            assert_eq!(found, expected, "{part} of {name}");
        }
        assert_eq!(found["hash"], expected["hash"], "the content of {name}");
    }
    Ok(())
}

#[test]
fn every_example_leads_to_the_same_network_plan_and_paths_in_the_page_and_natively() -> Result<()> {
    let page = Opened::planned()?;
    every_example_is_the_same(|expression| page.tab.evaluate(expression))
}

/// The same value with whole numbers as JavaScript writes them, without a decimal point.
fn as_javascript_writes(value: &Value) -> Value {
    match value {
        Value::Number(number) => match number.as_f64() {
            Some(real) if number.is_f64() && real.fract() == 0.0 && real.abs() < 1e15 => json!(real as i64),
            _ => value.clone(),
        },
        Value::Array(items) => items.iter().map(as_javascript_writes).collect(),
        Value::Object(fields) => {
            fields.iter().map(|(name, field)| (name.clone(), as_javascript_writes(field))).collect()
        }
        _ => value.clone(),
    }
}
