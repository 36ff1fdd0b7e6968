//! The page works out exactly what the native build works out.

use anyhow::Result;
use app::{Enroute, native::NativeHost};
use egui::{Context, RawInput};
use serde_json::{Value, json};
use workbench::{mission_file::EXAMPLES, outside::Remote as _};

use crate::opened::Opened;

/// The app without a window.
struct Native {
    context: Context,
    app: Enroute,
}

impl Native {
    fn new() -> Self {
        let context = Context::default();
        let host = NativeHost::without_storage(context.clone());
        let app = Enroute::new(&context, Box::new(host), "");
        Self { context, app }
    }

    /// The state once an example has been answered in full.
    fn state_of(&mut self, example: &str) -> Result<Value> {
        self.app.open(example)?;
        loop {
            let mut output = self.context.run_ui(RawInput::default(), |ui| self.app.show(ui, None));
            // Nothing is painted here.
            output.textures_delta.clear();
            let state = serde_json::to_value(self.app.state())?;
            if state["status"] != "working" && state["answeredRevision"] == state["revision"] {
                return Ok(state);
            }
            std::thread::yield_now();
        }
    }
}

#[test]
fn every_example_leads_to_the_same_network_plan_and_paths_in_the_page_and_natively() -> Result<()> {
    let page = Opened::planned()?;
    let mut native = Native::new();
    for example in EXAMPLES {
        let expected = native.state_of(example.name)?;
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
