//! The chain from a mission's text to a plan that has been checked: `cargo run -p mission --example plan`.
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

const TEXT: &str = "
primitive Drive()[20,30];
primitive Dig()[5,10];
scenario Morning[0,120] = {
  { delay; do { Drive(); Dig() } maintaining LIGHT },
  { delay[5,5]; LIGHT [100,100] }
}";

fn main() -> Result<(), String> {
    let parsed = rmpl::parse(TEXT);
    let (network, diagnostics) = tpn::compile(&parsed.program(), &tpn::Top::Scenario(None));
    let network = network.ok_or_else(|| format!("{:#?} {diagnostics:#?}", parsed.diagnostics()))?;
    println!(
        "{} nodes, {} arcs, {} decisions",
        network.nodes.len(),
        network.arcs.len(),
        network.decisions.len()
    );

    // `Unlimited` never asks the search to stop; a host with a clock or a button gives another condition.
    let outcome = kirk::plan(&network, &kirk::Options::default(), &mut kirk::Unlimited);
    let Some(plan) = outcome.plans.first() else {
        return Err(format!("there is no plan: {:#?}", outcome.failure));
    };
    let json = tpn::plan_json::plan_to_json(&network, plan);
    for member in ["choices", "causal_links", "orderings_added", "windows"] {
        println!("{member}: {}", json[member]);
    }

    // The checker shares no code with the planner.
    let verdict = verify::check_plan(&network, plan);
    let earliest = verify::check_schedule(&network, plan, &verify::earliest_schedule(plan));
    println!("the plan is valid: {}; its earliest schedule is: {}", verdict.valid, earliest.valid);
    if verdict.valid && earliest.valid { Ok(()) } else { Err("a plan that does not hold".to_owned()) }
}
