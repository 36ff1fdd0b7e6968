//! Measures what executing an event costs, in missions of several shapes and sizes: the table of `docs/evidence/benchmarks.md`.
//! `cargo run -p executive --release --example event_costs`, with the greatest number of activities as an argument.

#![expect(clippy::print_stdout, reason = "the figures are this program's answer")]

use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Instant;

use executive::{AsPlanned, Disturbance, Ending, Facts, Replanner, Stage, World, run_stage};
use tpn::generate::Rng;
use tpn::{Network, OccurrenceKind, Plan, Top};

/// Nothing here goes so wrong that it is planned again.
struct NoReplanner;

impl Replanner for NoReplanner {
    fn replan(&mut self, _: &Facts) -> Result<(Arc<Network>, Plan), String> {
        Err("a measured run keeps its plan".to_owned())
    }
}

/// A kind of mission that is written for any number of activities.
type Shape = (&'static str, fn(u32) -> String);

const SHAPES: [Shape; 8] = [
    ("one sequence", |count| threads(1, count)),
    ("1,000 threads", |count| threads(1000.min(count / 10), count)),
    ("as many as long", |count| threads(count.isqrt(), count)),
    ("all at once", |count| threads(count, count)),
    ("nested", nested),
    ("conditions", conditions),
    ("states", states),
    ("vehicles", vehicles),
];

const PARTS: &str = "primitive A()[1,3];\n";

fn threads(threads: u32, count: u32) -> String {
    let thread = format!("repeat {} {{ A() }}", count / threads);
    let all = vec![thread; threads as usize].join(", ");
    format!("{PARTS}scenario S[0,{}] = {{ {all} }}\n", 4 * count)
}

/// Sequences of parallel blocks of sequences, and so on.
fn nested(count: u32) -> String {
    fn block(count: u32, is_parallel: bool) -> String {
        if count <= 1 {
            return "A()".to_owned();
        }
        let parts: Vec<String> =
            (0..4.min(count)).map(|part| block((count + part) / 4.min(count), !is_parallel)).collect();
        if is_parallel {
            format!("{{ {} }}", parts.join(", "))
        } else {
            format!("{{ {} }}", parts.join("; "))
        }
    }
    format!("{PARTS}scenario S[0,{}] = {{ {} }}\n", 4 * count, block(count, false))
}

/// Threads of activities each of which needs a condition that the next thread holds.
fn conditions(count: u32) -> String {
    let threads = count.isqrt();
    let (mut text, mut all) = (PARTS.to_owned(), Vec::new());
    for thread in 0..threads {
        let each = count / threads;
        _ = writeln!(text, "var C{thread} : {{ON, OFF}};");
        all.push(format!("repeat {each} {{ do {{ A() }} maintaining C{thread}=ON }}"));
        all.push(format!("C{thread}=ON [{0},{0}]", 3 * each));
    }
    format!("{text}scenario S[0,{}] = {{ {} }}\n", 4 * count, all.join(", "))
}

/// Threads that each change a state and need it in turn.
fn states(count: u32) -> String {
    let threads = count.isqrt();
    let mut text =
        "primitive Go(v, there)[1,3] sets v=there;\nprimitive Work(v, here)[1,3] requires v=here;\n"
            .to_owned();
    let mut all = Vec::new();
    for thread in 0..threads {
        _ = writeln!(text, "state V{thread} : {{HOME, AWAY}} = HOME;");
        let turn =
            format!("Go(V{thread}, AWAY); Work(V{thread}, AWAY); Go(V{thread}, HOME); Work(V{thread}, HOME)");
        all.push(format!("repeat {} {{ {turn} }}", count / threads / 4));
    }
    format!("{text}scenario S[0,{}] = {{ {} }}\n", 4 * count, all.join(", "))
}

/// Vehicles that move between two places, which is a state that they change and need.
fn vehicles(count: u32) -> String {
    let threads = count.isqrt();
    let mut text = "location HOME (0, 0);\nlocation AWAY (9, 0);\n".to_owned();
    text.push_str("primitive Go(v, there)[1,3] moves v;\nprimitive Look(v)[1,3] requires v.at=AWAY;\n");
    let mut all = Vec::new();
    for thread in 0..threads {
        _ = writeln!(text, "vehicle V{thread} : ATRV at HOME;");
        let turn = format!("Go(V{thread}, AWAY); Look(V{thread}); Look(V{thread}); Go(V{thread}, HOME)");
        all.push(format!("repeat {} {{ {turn} }}", count / threads / 4));
    }
    format!("{text}scenario S[0,{}] = {{ {} }}\n", 4 * count, all.join(", "))
}

/// Every activity takes any time between its bounds.
fn any_durations(network: &Network) -> Vec<Disturbance> {
    let mut rng = Rng::new(1);
    let activities = network.occurrences.iter().filter(|it| it.kind == OccurrenceKind::Primitive);
    let duration = |thousandths: i64| exact::Time::from(thousandths).checked_div(1000).expect("a small time");
    activities
        .map(|it| Disturbance::Duration {
            activity: it.name.clone(),
            duration: duration(rng.between(1000, 3000)),
        })
        .collect()
}

fn main() {
    let greatest = std::env::args().nth(1).and_then(|count| count.parse().ok()).unwrap_or(10_000);
    let only = std::env::args().nth(2);
    println!(
        "shape            activities  events  plan s  ready s  as planned: s, µs/event  any durations: s, µs/event"
    );
    for (name, shape) in SHAPES.iter().filter(|(name, _)| only.as_deref().is_none_or(|only| *name == only)) {
        for count in [greatest / 16, greatest / 4, greatest] {
            let program = rmpl::parse(&shape(count)).program();
            let (network, found) = tpn::compile(&program, &Top::Scenario(None));
            let network = Arc::new(network.unwrap_or_else(|| panic!("{name}: {found:?}")));
            let begun = Instant::now();
            let outcome = kirk::plan(&network, &kirk::Options::default(), &mut kirk::Unlimited);
            let plan = outcome.plans.into_iter().next().unwrap_or_else(|| panic!("{name} has no plan"));
            let planned = begun.elapsed().as_secs_f64();
            print!("{name:16} {count:>10}");
            for (column, disturbances) in [Vec::new(), any_durations(&network)].into_iter().enumerate() {
                let world = World::new(&disturbances);
                let grid = world.times(&network).expect("its times fit");
                let begun = Instant::now();
                let stage = Stage::new(Arc::clone(&network), plan.clone(), &grid).expect("a plan");
                let ready = begun.elapsed().as_secs_f64();
                let begun = Instant::now();
                let outcome = run_stage(stage, network.nodes.len(), &world, &mut AsPlanned, &mut NoReplanner)
                    .expect("its times fit");
                let took = begun.elapsed().as_secs_f64();
                assert_eq!(outcome.ending, Ending::Finished, "{:?}", outcome.log.last());
                let events = outcome.last().times.iter().flatten().count();
                if column == 0 {
                    print!("{events:>8}  {planned:>6.3}  {ready:>7.3}");
                }
                print!("  {took:>14.3} {:>8.2}", took * 1e6 / events as f64);
            }
            println!();
        }
    }
}
