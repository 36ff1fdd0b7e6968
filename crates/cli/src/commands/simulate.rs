//! `enroute simulate`: executes a mission's plan in the simulated world and logs what happens.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use executive::{Ending, Entry, Happening, Script};
use mission::Paths;
use mission::execution::{self, Ran};
use mission::planning::{self, Problem};
use rmpl::program::Program;
use serde_json::{Value, json};
use snapshot::{DriveFrame, Problem as Found, SimulatedDrive};
use tpn::Network;

use crate::deadline::{TimeLimit, Undecided};
use crate::diagnostics::print_problems;
use crate::ground::ground;
use crate::input::read_json;
use crate::load::Target;
use crate::output::{Format, NO, WRONG, YES, document, exit, print_json, print_text};

/// Executes a mission's plan in the simulated world, planning again when the plan cannot be kept.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    target: Target,
    /// Seeds path planning.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// What goes otherwise than planned: {"disturbances": [{"kind": "duration" | "slow" | "withdrawn" | "late" | "state" |
    /// "level" | "fault" | "obstacle" | "vehicle-slow", …}…]}; `docs/simulation.md` lists their members.
    #[arg(long, value_name = "D.json")]
    disturb: Option<PathBuf>,
    /// Lets nature choose its durations so as to break the plan: ends of ranges, where nothing breaks it.
    #[arg(long)]
    adversary: bool,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// For whom the answer is.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let loaded = args.target.load()?;
    let mut script = match &args.disturb {
        Some(file) => read_json::<Script>(file)?,
        None => Script::default(),
    };
    script.adversary |= args.adversary;
    let disturbances = &script.disturbances;
    // A network has no activities beside its own, and no ground.
    let nothing = Program::default();
    let program = loaded.program.as_ref().unwrap_or(&nothing);
    let Some(network) = loaded.network.clone().map(Arc::new) else {
        print_problems(&loaded.name, &loaded.source, &loaded.problems)?;
        return Ok(exit(WRONG));
    };
    let (programs, _) = mission::programs::Programs::compile(program, Some(&network));
    execution::check_disturbances(&network, program, &programs, disturbances).map_err(anyhow::Error::msg)?;
    let (mut grounds, ground) = ground(&args.target.file, &program.world)?;
    let mut paths = Paths::default();
    let problem = Problem {
        ground: ground.as_ref().map(|(key, map)| (key, map)),
        seed: args.seed,
        programs: Some(&programs),
        ..Problem::new(&network, program)
    };
    let deadline = args.time_limit.start();
    let planned = planning::plan(&problem, &mut grounds, &mut paths, &mut || deadline.is_over());
    deadline.check(&planned.planning.outcome)?;
    let mut problems = loaded.problems.clone();
    problems.extend(Found::all(&planned.warnings, &loaded.source));
    if matches!(args.format, Format::Text) {
        print_problems(&loaded.name, &loaded.source, &problems)?;
    }
    let limit = deadline.enforce(Undecided::Execution);
    let executed = execution::execute(&problem, &planned, &script, &mut grounds, &mut paths);
    limit.answered();
    let Some(outcome) = executed else {
        match args.format {
            Format::Text => print_text("the mission has no plan to execute; `enroute plan` says why\n")?,
            Format::Json => {
                let body = json!({ "status": "no-plan", "log": [] });
                print_json(&document("simulate", &problems, body))?;
            }
        }
        return Ok(exit(NO));
    };
    let Ran { outcome, drives, .. } = outcome?;
    match args.format {
        Format::Text => print_text(&outcome.log.iter().map(line).collect::<String>())?,
        Format::Json => {
            let body = json!({
                "status": outcome.ending,
                "seed": args.seed,
                "disturbances": disturbances,
                "log": outcome.log,
                "drives": drives.iter().map(|drive| drive_json(drive, &network, program)).collect::<Vec<_>>(),
            });
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
        "reroutes": drive.reroutes,
        "least_clearance_m": drive.least_clearance_m.is_finite().then_some(drive.least_clearance_m),
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
            "planned again, with the same choices".to_owned()
        }
        Happening::Replanned { changes } => format!("planned again: {}", changes.join(", ")),
        Happening::Stopped { reason } => format!("STOPPED  {reason}"),
        Happening::Finished => "finished".to_owned(),
    };
    format!("{time:>9}  {text}\n")
}
