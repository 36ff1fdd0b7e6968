//! `enroute simulate`: executes a mission's plan in the simulated world and logs what happens.

use std::path::PathBuf;
use std::process::ExitCode;

use executive::{Ending, Entry, Happening, Script};
use mission::execution::Ran;
use mission::{Manner, SavedState};
use rmpl::program::Program;
use serde_json::{Value, json};
use snapshot::{DriveFrame, Problem, SimulatedDrive};
use tpn::Network;

use crate::deadline::Undecided;
use crate::diagnostics::print_problems;
use crate::input::read_json;
use crate::number::seed;
use crate::output::{Format, NO, YES, document, exit, print_json, print_text};
use crate::save::{refuse_input, save};
use crate::target::{PlanOptions, Target};

/// Simulate a plan, replanning when it fails.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// Disturbances to inject: {"disturbances": [{"kind": …}…]}, or a counterexample of enroute contradict.
    ///
    /// The kinds are duration, slow, withdrawn, late, state, level, fault, obstacle and vehicle-slow; docs/simulation.md describes their members.
    #[arg(long, value_name = "D.json")]
    disturb: Option<PathBuf>,
    /// Use worst-case contingent durations.
    #[arg(long)]
    adversary: bool,
    /// Seed for random durations [default: that of the script or of --seed].
    #[arg(long, value_name = "SEED", value_parser = seed)]
    run_seed: Option<u64>,
    /// Write the values, levels and places at the end to STATE.json.
    #[arg(long, value_name = "STATE.json")]
    state: Option<PathBuf>,
    #[command(flatten)]
    options: PlanOptions,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let mut mission = args.target.open()?;
    let compiled = mission.compile()?;
    let mut script = match &args.disturb {
        Some(file) => read_json::<Script>(file)?,
        None => Script::default(),
    };
    script.adversary |= args.adversary;
    script.run_seed = args.run_seed.or(script.run_seed);
    let mut problems = compiled.problems();
    if compiled.network().is_none() {
        let body = json!({ "status": "error", "log": [] });
        return mission.refuse(&problems, args.options.format, ("simulate", body));
    }
    compiled.check_script(&script).map_err(anyhow::Error::msg)?;
    args.state.as_deref().map_or(Ok(()), refuse_input)?;
    let ground = mission.ground(&compiled)?;
    let deadline = args.options.time_limit.start();
    let manner = Manner { seed: args.options.seed, ..Manner::default() };
    let evaluated = mission.plan(compiled, ground, manner, deadline)?;
    problems.extend(Problem::all(&evaluated.planned.warnings, &mission.source));
    if matches!(args.options.format, Format::Text) {
        print_problems(&mission.name, &mission.source, &problems)?;
    }
    let limit = deadline.enforce(Undecided::Execution, ("simulate", args.options.format));
    let executed = mission.core.run(&evaluated, &script);
    limit.answered();
    let Some(outcome) = executed else {
        match args.options.format {
            Format::Text => {
                print_text("the mission has no plan to execute; run `enroute plan` for the reason\n")?;
            }
            Format::Json => {
                let body = json!({ "status": "no-plan", "log": [] });
                print_json(&document("simulate", &problems, body))?;
            }
        }
        return Ok(exit(NO));
    };
    let Ran { outcome, drives, .. } = outcome?;
    let save_state = || -> anyhow::Result<()> {
        let Some(file) = &args.state else { return Ok(()) };
        let saved = SavedState::at_end(&outcome, &drives, &evaluated.compiled.program);
        let saved = saved.map_err(|reason| {
            anyhow::anyhow!(
                "cannot write a state to {}: {}",
                file.display(),
                evaluated.network.readable(&reason)
            )
        })?;
        save(file, &format!("{}\n", serde_json::to_string_pretty(&saved)?))
    };
    let drive = |drive| drive_json(drive, &evaluated.network, &evaluated.compiled.program);
    match args.options.format {
        Format::Text => {
            let log: String = outcome.log.iter().map(line).collect();
            print_text(&evaluated.network.readable(&log))?;
            save_state()?;
        }
        Format::Json => {
            // That a state cannot be written is the only document then.
            save_state()?;
            let mut body = json!({
                "status": outcome.ending,
                "seed": args.options.seed,
                "log": outcome.log,
                "drives": drives.iter().map(drive).collect::<Vec<_>>(),
            });
            if let (Some(body), Value::Object(script)) = (body.as_object_mut(), json!(script)) {
                body.extend(script);
            }
            print_json(&document("simulate", &problems, body))?;
        }
    }
    Ok(exit(if outcome.ending == Ending::Finished { YES } else { NO }))
}

/// A traverse as it was driven: each vehicle's track as [time, east, north, heading, speed].
fn drive_json(drive: &SimulatedDrive, network: &Network, program: &Program) -> Value {
    let name = |vehicle: u32| program.world.vehicles.get(vehicle as usize).map(|it| it.name.text.as_str());
    let track = |frames: &[DriveFrame]| -> Vec<[f64; 5]> {
        let row = |it: &DriveFrame| [it.time, it.position_m.x, it.position_m.y, it.heading_rad, it.speed_mps];
        frames.iter().map(row).collect()
    };
    json!({
        "activity": network.occurrences[drive.occurrence.index()].name,
        "start": drive.start,
        "duration": drive.duration,
        "driven_m": drive.driven_m,
        "reroutes": drive.reroutes,
        "least_clearance_m": drive.min_clearance_m.is_finite().then_some(drive.min_clearance_m),
        "vehicles": drive.vehicles.iter().map(|vehicle| json!({
            "vehicle": name(vehicle.vehicle),
            "track": track(&vehicle.frames),
        })).collect::<Vec<_>>(),
    })
}

fn line(entry: &Entry) -> String {
    let time = entry.time.readable();
    let text = match &entry.happening {
        Happening::Executed { name } => name.to_string(),
        Happening::Progress { name, text } => format!("  {name}: {text}"),
        Happening::State { .. } | Happening::Level { .. } => {
            format!("  {}", entry.happening.state_words().unwrap_or_default())
        }
        Happening::Violation { reason, .. } => format!("VIOLATION  {reason}"),
        Happening::Replanned { changes } if changes.is_empty() => {
            "replanned, with the same choices".to_owned()
        }
        Happening::Replanned { changes } => format!("replanned: {}", changes.join(", ")),
        Happening::Stopped { reason } => format!("STOPPED  {reason}"),
        Happening::Finished => "finished".to_owned(),
    };
    format!("{time:>9}  {text}\n")
}
