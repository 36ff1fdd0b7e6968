//! Times the planners on the two 512 × 512 maps, corner to corner, with a step of 20 cells and a goal bias of 0.05:
//! `cargo bench -p motion --bench plan`. The reference length is found by an any-angle grid search (Theta*).

#![expect(clippy::print_stdout, reason = "a benchmark prints its table")]

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::time::Instant;

use motion::{Path, PlannerKind, Query, Search, Settings, ShortcutSettings, shorten};
use nalgebra::{Point2, distance};
use terrain::{Cell, ConfigurationSpace, GridFrame, Occupancy};

const RUNS: u64 = 200;

fn main() {
    println!(
        "| map | radius | planner | success | first path ms (median) | 90% | length | smoothing ms | smoothed | of reference | worst | within 5% |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for map in ["map_1", "map_2"] {
        for radius in [0.0, 1.5] {
            let Some(space) = load(map, radius) else {
                println!("| {map} | the file ../shared/data/maps/{map}.pgm is not here |");
                continue;
            };
            let query = Query { start_m: Point2::new(8.0, 8.0), goal_m: Point2::new(503.0, 503.0) };
            let reference = theta_star(&space, query).map_or(f64::NAN, |path| {
                let settings =
                    ShortcutSettings { attempts: 5000, corner_rounds: 200, ..ShortcutSettings::default() };
                shorten(&space, &path, &settings).length_m()
            });
            for planner in [PlannerKind::Rrt, PlannerKind::RrtConnect, PlannerKind::RrtStar] {
                report(map, radius, planner, &space, query, reference);
            }
        }
    }
}

fn report(
    map: &str,
    radius: f64,
    planner: PlannerKind,
    space: &ConfigurationSpace,
    query: Query,
    reference: f64,
) {
    let (mut found, mut first, mut lengths, mut smoothing, mut smoothed) =
        (0, Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for seed in 0..RUNS {
        let settings = Settings { step_m: 20.0, seed, ..Settings::of(planner) };
        let start = Instant::now();
        let mut search = Search::new(space, query, settings).expect("both ends are free");
        while search.statistics().samples_to_first_path.is_none() && !search.is_finished() {
            search.step(space);
        }
        let path = search.path();
        first.push(1000.0 * start.elapsed().as_secs_f64());
        let Some(path) = path else { continue };
        found += 1;
        lengths.push(path.length_m());
        let start = Instant::now();
        let short = shorten(space, &path, &ShortcutSettings { seed, ..ShortcutSettings::default() });
        smoothing.push(1000.0 * start.elapsed().as_secs_f64());
        smoothed.push(short.length_m());
    }
    let near = smoothed.iter().filter(|&&length| length <= 1.05 * reference).count();
    println!(
        "| {map} | {radius} | {planner:?} | {found}/{RUNS} | {:.3} | {:.3} | {:.0} | {:.3} | {:.1} | {:.4} | {:.4} | {near}/{found} |",
        quantile(&mut first, 0.5),
        quantile(&mut first, 0.9),
        quantile(&mut lengths, 0.5),
        quantile(&mut smoothing, 0.5),
        quantile(&mut smoothed, 0.5),
        quantile(&mut smoothed, 0.5) / reference,
        quantile(&mut smoothed, 1.0) / reference,
    );
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(((values.len() as f64 - 1.0) * share).round() as usize).copied().unwrap_or(f64::NAN)
}

fn load(map: &str, radius: f64) -> Option<ConfigurationSpace> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/maps");
    let bytes = std::fs::read(format!("{root}/{map}.pgm")).ok()?;
    let pixels = &bytes[bytes.len() - 512 * 512..];
    let occupied: Vec<bool> = pixels.iter().map(|&pixel| pixel < 128).collect();
    Some(ConfigurationSpace::new(Occupancy::from_obstacles(GridFrame::new(512, 512, 1.0), &occupied), radius))
}

/// Theta* (Nash, Daniel, Koenig and Felner 2007) over cell centers, between the query's ends.
fn theta_star(space: &ConfigurationSpace, query: Query) -> Option<Path> {
    let frame = space.frame();
    let start = frame.index(frame.cell_at(query.start_m)?);
    let goal = frame.index(frame.cell_at(query.goal_m)?);
    let point = |index: usize| match index {
        index if index == start => query.start_m,
        index if index == goal => query.goal_m,
        index => frame.center_m(frame.cell(index)),
    };
    let mut costs = vec![f64::INFINITY; frame.cell_count()];
    let mut parents = vec![usize::MAX; frame.cell_count()];
    let mut done = vec![false; frame.cell_count()];
    costs[start] = 0.0;
    parents[start] = start;
    let mut open = BinaryHeap::from([(Reverse(0_u64), start)]);
    while let Some((_, current)) = open.pop() {
        if std::mem::replace(&mut done[current], true) {
            continue;
        }
        if current == goal {
            break;
        }
        let Cell { column, row } = frame.cell(current);
        for (east, north) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
            let (Some(column), Some(row)) = (column.checked_add_signed(east), row.checked_add_signed(north))
            else {
                continue;
            };
            if column >= frame.width || row >= frame.height {
                continue;
            }
            let next = frame.index(Cell { column, row });
            if done[next] || !space.is_segment_free(point(current), point(next)) {
                continue;
            }
            let from = parents[current];
            let parent = if space.is_segment_free(point(from), point(next)) { from } else { current };
            let cost = costs[parent] + distance(&point(parent), &point(next));
            if cost < costs[next] {
                costs[next] = cost;
                parents[next] = parent;
                open.push((Reverse(((cost + distance(&point(next), &query.goal_m)) * 1e6) as u64), next));
            }
        }
    }
    let mut points = Vec::new();
    let mut index = goal;
    while parents[index] != usize::MAX {
        points.push(point(index));
        if index == start {
            points.reverse();
            return Some(Path::new(points));
        }
        index = parents[index];
    }
    None
}
