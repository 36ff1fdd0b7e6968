//! `enroute path`: one path on a map file.
//!
//! Coordinates follow the rows of the file: x to the right and y down from the top left corner of the picture, in cells
//! times `--cell`, so that cell (column, row) covers x from column to column + 1. An elevation map is read as its picture too:
//! dark cells are obstacles.

use exact::counted;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context as _;
use clap::ValueEnum;
use motion::{Failure, PlannerKind, Query, Search, Settings, ShortcutSettings, Statistics};
use nalgebra::Point2;
use rmpl::Diagnostic;
use serde_json::{Value, json};
use snapshot::Problem;
use terrain::format::{FileFormat, ImportOptions, read_raster};
use terrain::{ConfigurationSpace, GridFrame, Occupancy};

use crate::deadline::TimeLimit;
use crate::ground::{LARGEST_MAP_BYTES, with_label};
use crate::input::{folder_of, read_bytes};
use crate::number::{number_in, positive_number, seed};
use crate::output::{
    E_LIMIT, Format, LIMIT, NO, YES, document, exit, failure, print_error, print_json, print_text,
    without_timings,
};

/// Find a path on a map of obstacles.
#[derive(clap::Args)]
pub struct Args {
    /// Map: PGM, PNG, TIFF, ESRI ASCII grid, MovingAI (.map) or ROS (.yaml), where dark cells are obstacles; - reads standard input.
    map: PathBuf,
    /// Start: x to the right and y down from the top left corner.
    #[arg(long, value_name = "X,Y", value_parser = parse_point, allow_hyphen_values = true)]
    from: Point2<f64>,
    /// Goal.
    #[arg(long, value_name = "X,Y", value_parser = parse_point, allow_hyphen_values = true)]
    to: Point2<f64>,
    /// Path planner.
    #[arg(long, value_enum, default_value_t = Planner::RrtConnect)]
    planner: Planner,
    /// Radius of the vehicle, in units of the coordinates.
    #[arg(long, default_value_t = 0.0, value_parser = parse_length)]
    radius: f64,
    /// Side of a cell, in units of the coordinates.
    #[arg(long, default_value_t = 1.0, value_parser = parse_positive)]
    cell: f64,
    /// Longest edge of the tree [default: 1/25 of the map's longer side].
    #[arg(long, value_parser = parse_positive)]
    step: Option<f64>,
    /// Seed for path planning.
    #[arg(long, default_value_t = 1, value_parser = seed)]
    seed: u64,
    /// Probability of sampling the goal.
    #[arg(long, default_value_t = 0.05, value_parser = parse_share)]
    goal_bias: f64,
    /// Maximum number of samples.
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = positive_number)]
    samples: u32,
    #[command(flatten)]
    time_limit: TimeLimit,
    /// Search N times, each with the next seed, and list all runs.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = number_in(1..=1_000_000_u32))]
    repeat: u32,
    /// Don't shorten the path.
    #[arg(long)]
    raw: bool,
    /// Omit timings, for reproducible output.
    #[arg(long)]
    no_timings: bool,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Edges of a tree are no shorter than this many cells: shorter ones lead nowhere.
const MIN_STEP_CELLS: f64 = 0.01;

/// The planners by their names on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Planner {
    /// Grows one tree from the start.
    Rrt,
    /// Grows a tree from each end.
    RrtConnect,
    /// Keeps improving the path after the first one (RRT*).
    RrtStar,
    /// Keeps to the speeds and accelerations of an ATRV rover.
    Kinodynamic,
}

impl Planner {
    const fn kind(self) -> PlannerKind {
        match self {
            Self::Rrt => PlannerKind::Rrt,
            Self::RrtConnect => PlannerKind::RrtConnect,
            Self::RrtStar => PlannerKind::RrtStar,
            Self::Kinodynamic => PlannerKind::Kinodynamic,
        }
    }
}

/// What one search came to.
struct Run {
    seed: u64,
    path: Result<motion::Path, Failure>,
    /// Length before shortening.
    raw_length: f64,
    statistics: Statistics,
    /// Until the first path, the whole search, and the search with shortening, in milliseconds.
    millis: [f64; 3],
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let map = load(args)?;
    let runs: Vec<Run> = (0..args.repeat).map(|run| search(args, &map, u64::from(run))).collect();
    let first = runs.first().context("at least one run")?;
    match args.format {
        Format::Text => {
            if let Some(unclear) = &map.unclear {
                print_error(&format!("note: {}", unclear.message));
            }
            print_text(&describe(&runs, !args.no_timings))?;
        }
        Format::Json => {
            let mut body = to_json(&runs);
            if args.no_timings {
                without_timings(&mut body);
                let repeated = body.get_mut("runs").and_then(Value::as_array_mut);
                repeated.into_iter().flatten().for_each(without_timings);
            }
            let mut problems = Problem::all(map.unclear.as_slice(), "");
            let unanswered = first.path.as_ref().err().filter(|why| is_limit(why));
            problems.extend(unanswered.map(|why| failure(E_LIMIT, &why.to_string())));
            print_json(&document("path", &problems, body))?;
        }
    }
    Ok(exit(match first.path {
        Ok(_) => YES,
        Err(ref why) if is_limit(why) => LIMIT,
        Err(_) => NO,
    }))
}

/// Returns whether a longer search may find a path.
const fn is_limit(why: &Failure) -> bool {
    matches!(why, Failure::NotFound { .. } | Failure::Stopped { .. })
}

/// A map as vehicles see it.
struct Map {
    space: ConfigurationSpace,
    /// Values row by row from the top; NaN where the file has none.
    samples: Vec<f32>,
    /// What to say of cells whose meaning is not clear, if there are any.
    unclear: Option<Diagnostic>,
}

impl Map {
    /// Returns whether the file has no value for the cell of a point in the map.
    fn is_unknown(&self, point: Point2<f64>) -> bool {
        let frame = self.space.frame();
        let index =
            frame.cell_at(point).map(|cell| cell.row as usize * frame.width as usize + cell.column as usize);
        index.and_then(|index| self.samples.get(index)).is_some_and(|sample| sample.is_nan())
    }

    /// The path of a vehicle that stays where it is: it needs to know nothing of the ground, but cannot stand in an obstacle.
    fn standing(&self, point: Point2<f64>) -> Result<motion::Path, Failure> {
        match self.space.collision_at(point) {
            Some(collision) if !self.is_unknown(point) => Err(Failure::StartInCollision(collision)),
            _ => Ok(motion::Path::new(vec![point])),
        }
    }
}

fn load(args: &Args) -> anyhow::Result<Map> {
    let bytes = read_bytes(&args.map, LARGEST_MAP_BYTES)?;
    let name = args.map.display();
    let bytes = if FileFormat::detect(&bytes) == Some(FileFormat::RosMap) {
        with_label(folder_of(&args.map), &args.map, bytes).with_context(|| format!("cannot read {name}"))?
    } else {
        bytes
    };
    anyhow::ensure!(
        FileFormat::detect(&bytes).is_some(),
        "{name}: unrecognized map format (expected PGM, PNG, TIFF, ESRI ASCII grid, MovingAI or ROS)"
    );
    let raster =
        read_raster(&bytes, &ImportOptions::default()).with_context(|| format!("cannot read {name}"))?;
    let cells = (raster.num_unclear, raster.samples.len());
    let unclear = (raster.num_unclear > 0)
        .then(|| rmpl::diagnostics::map::unclear(cells, &name.to_string(), rmpl::Span::default()));
    let frame = GridFrame::new(raster.width, raster.height, args.cell);
    if let Some(step) = args.step {
        let least = args.cell * MIN_STEP_CELLS;
        anyhow::ensure!(step >= least, "--step must be at least {least}, a hundredth of a cell");
    }
    let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &raster.obstacles()), args.radius);
    Ok(Map { space, samples: raster.samples, unclear })
}

fn search(args: &Args, map: &Map, run: u64) -> Run {
    let space = &map.space;
    let seed = args.seed.wrapping_add(run);
    let settings = Settings {
        step_m: args.step.unwrap_or_else(|| Settings::step_across_m(space.frame())),
        goal_bias: args.goal_bias.clamp(0.0, 1.0),
        max_samples: args.samples,
        seed,
        ..Settings::of(args.planner.kind())
    };
    let query = Query { start_m: args.from, goal_m: args.to };
    let started = Instant::now();
    if args.from == args.to {
        let (path, millis) = (map.standing(args.from), [millis_since(started); 3]);
        return Run { seed, path, raw_length: 0.0, statistics: Statistics::default(), millis };
    }
    let limit = args.time_limit.duration();
    let mut first_millis = None;
    let mut stop = |statistics: &Statistics| {
        if first_millis.is_none() && statistics.samples_to_first_path.is_some() {
            first_millis = Some(millis_since(started));
        }
        // Reading the clock before every sample would cost more than the sample.
        limit.is_some_and(|limit| statistics.samples.is_multiple_of(16) && started.elapsed() > limit)
    };
    let (mut result, search_millis) = match Search::new(space, query, settings) {
        Ok(search) => {
            let result = search.run(space, &mut stop);
            (result, millis_since(started))
        }
        Err(failure) => {
            let millis = [millis_since(started); 3];
            return Run {
                seed,
                path: Err(failure),
                raw_length: 0.0,
                statistics: Statistics::default(),
                millis,
            };
        }
    };
    let raw_length = result.path.as_ref().map_or(0.0, motion::Path::length_m);
    if !args.raw {
        let shortcut = ShortcutSettings { seed, ..ShortcutSettings::default() };
        result.shorten(space, &settings, &shortcut);
    }
    let millis = [first_millis.unwrap_or(search_millis), search_millis, millis_since(started)];
    Run { seed, path: result.path, raw_length, statistics: result.statistics, millis }
}

fn millis_since(start: Instant) -> f64 {
    1000.0 * start.elapsed().as_secs_f64()
}

fn to_json(runs: &[Run]) -> Value {
    let mut body = runs.first().map_or(Value::Null, run_json);
    if let (Value::Object(members), true) = (&mut body, runs.len() > 1) {
        members.insert("runs".into(), runs.iter().map(run_json).collect());
    }
    body
}

fn run_json(run: &Run) -> Value {
    let (points, length, failure) = match &run.path {
        Ok(path) => (path.points_m.as_slice(), json!(path.length_m()), Value::Null),
        Err(failure) => (&[][..], Value::Null, json!(failure.to_string())),
    };
    let [first, search, all] = run.millis;
    json!({
        "found": run.path.is_ok(),
        "path": points,
        "length": length,
        "raw_length": run.path.is_ok().then_some(run.raw_length),
        "samples": run.statistics.samples,
        "vertices": run.statistics.vertices,
        "millis": all,
        "search_millis": search,
        "first_path_millis": run.path.is_ok().then_some(first),
        "seed": run.seed,
        "failure": failure,
        "proved": matches!(
            run.path,
            Err(Failure::GoalEnclosed | Failure::StartInCollision(_) | Failure::GoalInCollision(_))
        ),
    })
}

fn describe(runs: &[Run], has_timings: bool) -> String {
    let mut text = String::new();
    let took = |run: &Run| if has_timings { format!(", {:.3} ms", run.millis[2]) } else { String::new() };
    for run in runs {
        let prefix = if runs.len() > 1 { format!("seed {}: ", run.seed) } else { String::new() };
        match &run.path {
            Ok(path) => {
                text += &format!(
                    "{prefix}length {:.3} ({:.3} before shortening), {}, {}{}\n",
                    path.length_m(),
                    run.raw_length,
                    counted(path.points_m.len(), "point"),
                    counted(run.statistics.samples, "sample"),
                    took(run)
                );
                if runs.len() == 1 {
                    text.extend(path.points_m.iter().map(|point| format!("{} {}\n", point.x, point.y)));
                }
            }
            Err(failure) => text += &format!("{prefix}{failure}{}\n", took(run)),
        }
    }
    text
}

fn parse_point(text: &str) -> Result<Point2<f64>, String> {
    let (x, y) = text.split_once(',').ok_or("expected two numbers with a comma between them, as in 8,8")?;
    Ok(Point2::new(parse_number(x)?, parse_number(y)?))
}

fn parse_number(text: &str) -> Result<f64, String> {
    let number: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if number.is_finite() { Ok(number) } else { Err(format!("`{text}` is not finite")) }
}

fn parse_length(text: &str) -> Result<f64, String> {
    let number = parse_number(text)?;
    if number >= 0.0 { Ok(number) } else { Err(format!("{number} is negative")) }
}

fn parse_share(text: &str) -> Result<f64, String> {
    let number = parse_number(text)?;
    if (0.0..=1.0).contains(&number) { Ok(number) } else { Err(format!("{number} is not between 0 and 1")) }
}

fn parse_positive(text: &str) -> Result<f64, String> {
    let number = parse_number(text)?;
    if number > 0.0 { Ok(number) } else { Err(format!("{number} is not positive")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_probability_lies_between_0_and_1() {
        assert_eq!(parse_share("0.05"), Ok(0.05));
        for wrong in ["NaN", "-0.1", "1.5", "inf", "often"] {
            assert!(parse_share(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn points_are_two_finite_numbers() {
        assert_eq!(parse_point("8,-503.5"), Ok(Point2::new(8.0, -503.5)));
        assert_eq!(parse_point(" 1 , 2 "), Ok(Point2::new(1.0, 2.0)));
        assert!(parse_point("8").unwrap_err().contains("comma"));
        assert!(parse_point("8,x").unwrap_err().contains("`x`"));
        assert!(parse_point("8,inf").unwrap_err().contains("finite"));
    }

    #[test]
    fn lengths_are_not_negative_and_cells_have_a_side() {
        assert_eq!(parse_length("0"), Ok(0.0));
        assert!(parse_length("-1").is_err());
        assert!(parse_positive("0").is_err());
    }
}
