//! The page works out exactly what the native build works out.

use anyhow::Result;
use serde_json::{Value, json};
use workbench::{host_io::Remote as _, mission_file::EXAMPLES};

use crate::opened::Opened;

#[test]
fn every_example_leads_to_the_same_network_plan_and_paths_in_the_page_and_natively() -> Result<()> {
    let page = Opened::planned()?;
    let mut native = test_support::start();
    for example in EXAMPLES {
        native.session.open(example.name)?;
        native.settle();
        let expected = native.json();
        page.tab.evaluate(&format!("enroute.open('{}')", example.name))?;
        page.settle()?;
        let state = page.state()?;
        for part in
            ["mission", "status", "diagnostics", "tpn", "plan", "verdict", "failure", "vehicles", "traverses"]
        {
            assert_eq!(state[part], as_javascript_writes(&expected[part]), "{part} of {}", example.name);
        }
    }
    Ok(())
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
