//! Days with more wishes than there is room for, and stops in any order: ours beside CP-SAT, to the proof.
//!
//! Of a day as much reward as possible is wanted; each wish takes the one body and some energy, and half of them have a
//! window. Stops are shared by vehicles that set out from one place, and the last of them is to be done as early as
//! possible; distances are whole numbers, the same for both.

use anyhow::Result;
use exact::{Rational, Time};
use serde::Serialize;
use tpn::generate::Rng;
use tpn::{Departure, Extent, LabelId, Network, ValueId, ValueSet};

use super::proofs::{self, Answer, network_of};
use crate::table::Table;
use crate::tools::Tools;

/// What is asked for.
#[derive(Serialize)]
#[serde(tag = "kind")]
enum Instance {
    Day {
        horizon: i64,
        energy: i64,
        wishes: Vec<Wish>,
    },
    /// Where the vehicles begin is the first point.
    Stops {
        vehicles: usize,
        distances: Vec<Vec<i64>>,
    },
}

#[derive(Serialize)]
struct Wish {
    duration: i64,
    reward: i64,
    energy: i64,
    release: i64,
    deadline: i64,
}

/// Prints the table.
pub(crate) fn compare(tools: &mut Tools, quick: bool) -> Result<()> {
    let mut table = Table::new("Objectives: the best plan, proven", &proofs::COLUMNS);
    let count = if quick { 2 } else { 5 };
    for wishes in [20, 40, 60] {
        let days: Vec<Instance> = (1..=count).map(|seed| day(wishes, seed)).collect();
        compare_family(tools, &mut table, &format!("{wishes} wishes for a day"), &days)?;
    }
    for (number, vehicles) in
        [(4, 1), (6, 1), (8, 1), (10, 1), (6, 2), (8, 2), (10, 2), (6, 3), (8, 3), (10, 3)]
    {
        let stops_of: Vec<Instance> = (1..=count).map(|seed| stops(number, vehicles, seed)).collect();
        let what = if vehicles == 1 { "one vehicle".to_owned() } else { format!("{vehicles} vehicles") };
        compare_family(tools, &mut table, &format!("{number} stops and {what}"), &stops_of)?;
    }
    table.note("Times are of the processor and hold encoding, the first plan and the proof, from a compiled network in memory, one try each; an instance whose proof is missing counts with the ten seconds it had. Ours is given the first plan alone once more, without an objective. CP-SAT has one worker, optional intervals, `no_overlap` and a sum for days, and a circuit for each vehicle for stops.");
    table.print();
    Ok(())
}

fn compare_family(tools: &mut Tools, table: &mut Table, name: &str, instances: &[Instance]) -> Result<()> {
    let files = proofs::files(tools, "objectives", name, instances)?;
    let ours: Vec<Answer> = instances.iter().map(ours).collect();
    let cp_sat = proofs::of_python(tools, "objectives.py", &files);
    proofs::add_rows(table, name, instances.len(), &[("ours", Ok(ours)), ("OR-tools CP-SAT", cp_sat)]);
    Ok(())
}

fn ours(instance: &Instance) -> Answer {
    match instance {
        Instance::Day { horizon, energy, wishes } => {
            let network = network_of(&day_text(*horizon, *energy, wishes));
            // What is best is least.
            proofs::ours(&network, |plan| {
                Time::from_units(plan.quality.reward.checked_neg().unwrap_or_default())
            })
        }
        Instance::Stops { vehicles, distances } => {
            let mut network = network_of(&stops_text(*vehicles, distances.len() - 1));
            network.departures = departures(&network, distances);
            proofs::ours(&network, |plan| plan.quality.end)
        }
    }
}

fn day(count: usize, seed: u64) -> Instance {
    let mut random = Rng::new(seed << 16 | count as u64);
    let durations: Vec<i64> = (0..count).map(|_| random.between(5, 60)).collect();
    let horizon = durations.iter().sum::<i64>() * 2 / 5;
    let wishes: Vec<Wish> = durations
        .into_iter()
        .map(|duration| {
            let (release, deadline) = if random.chance(50) {
                let release = random.between(0, horizon * 2 / 3);
                (release, (release + duration + random.between(10, horizon / 3)).min(horizon))
            } else {
                (0, horizon)
            };
            Wish { duration, reward: random.between(1, 20), energy: random.between(1, 12), release, deadline }
        })
        .collect();
    let energy = wishes.iter().map(|wish| wish.energy).sum::<i64>() * 2 / 5;
    Instance::Day { horizon, energy, wishes }
}

fn day_text(horizon: i64, energy: i64, wishes: &[Wish]) -> String {
    let mut text = format!("resource Body; resource Battery 0..{energy} = {energy};\n");
    let mut branches = Vec::new();
    for (at, wish) in wishes.iter().enumerate() {
        let Wish { duration, reward, energy, release, deadline } = wish;
        text.push_str(&format!(
            "primitive W{at}()[{duration},{duration}] uses Body consumes Battery {energy} rewards {reward};\n"
        ));
        let spare = horizon - deadline;
        branches
            .push(format!("{{ delay[{release},{horizon}]; optional W{at}(); delay[{spare},{horizon}] }}"));
    }
    format!("{text}objective maximize reward;\nscenario Day[0,{horizon}] = {{ {} }}\n", branches.join(", "))
}

fn stops(number: usize, vehicles: usize, seed: u64) -> Instance {
    let mut random = Rng::new(seed << 16 | (number as u64) << 4 | vehicles as u64);
    let points: Vec<(f64, f64)> =
        (0..=number).map(|_| (random.between(0, 1000) as f64, random.between(0, 1000) as f64)).collect();
    let distances = points
        .iter()
        .map(|from| points.iter().map(|to| (from.0 - to.0).hypot(from.1 - to.1).ceil() as i64).collect());
    Instance::Stops { vehicles, distances: distances.collect() }
}

fn stops_text(vehicles: usize, stops: usize) -> String {
    let mut text = "location S0 (0, 0);\n".to_owned();
    for stop in 1..=stops {
        text.push_str(&format!("location S{stop} ({stop}, 0);\n"));
    }
    for vehicle in 0..vehicles {
        text.push_str(&format!("vehicle R{vehicle} : ATRV at S0;\n"));
        text.push_str(&format!("primitive Go{vehicle}(to)[0,9999] moves R{vehicle};\n"));
    }
    let visits: Vec<String> = (1..=stops)
        .map(|stop| {
            let ways: Vec<String> = (0..vehicles).map(|vehicle| format!("Go{vehicle}(S{stop})")).collect();
            format!("{{ delay; choose {{ {} }} }}", ways.join(", "))
        })
        .collect();
    let visits = if vehicles == 1 {
        let calls: Vec<String> = (1..=stops).map(|stop| format!("Go0(S{stop})")).collect();
        format!("unordered {{ {} }}", calls.join("; "))
    } else {
        visits.join(", ")
    };
    format!("{text}objective minimize end;\nscenario Tour[0,99999] = {{ {visits} }}\n")
}

/// Returns how long each movement takes from each place, which is numbered in its name.
fn departures(network: &Network, distances: &[Vec<i64>]) -> Vec<Departure> {
    let number = |place: &str| place.strip_prefix('S').and_then(|number| number.parse::<usize>().ok());
    let mut departures = Vec::new();
    for (at, label) in network.labels.iter().enumerate() {
        let variable = &network.variables[label.literal.variable.index()];
        let is_movement = label.extent == Extent::Effect && variable.name.ends_with(".at");
        let ValueSet::In(places) = &label.literal.values else { continue };
        let arrives = places.first().and_then(|place| number(&variable.values[place.index()]));
        let Some(to) = arrives.filter(|_| is_movement) else { continue };
        for (value, place) in variable.values.iter().enumerate() {
            let Some(from) = number(place) else { continue };
            let least = Rational::from_integer(distances[from][to]);
            departures.push(Departure {
                arrival: LabelId::from_index(at),
                from: ValueId::from_index(value),
                least: Some(Time::from_units(least)),
            });
        }
    }
    departures
}
