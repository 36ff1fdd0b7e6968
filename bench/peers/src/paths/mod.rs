//! Paths on the same maps by ours and by OMPL: time to the first one, length, simplified length, and cut corners.

mod map;

use std::fs;
use std::process::Command;
use std::time::Duration;

use anyhow::Result;
use motion::{PlannerKind, Query, Search, Settings, ShortcutSettings, find_shortest_path, shorten};
use serde::Deserialize;

use crate::stopwatch::Stopwatch;
use crate::table::{Table, figure, median, millis, quantile};
use crate::tools::{Absent, Tools, answer};
use map::{ENDS, Map};

#[derive(Deserialize)]
struct Run {
    first_ms: f64,
    /// Empty when none was found.
    path: Vec<[f64; 2]>,
    simplify_ms: f64,
    simplified: Vec<[f64; 2]>,
}

/// Prints one table.
pub(crate) fn compare(tools: &mut Tools, quick: bool) -> Result<()> {
    let mut table = Table::new(
        "Paths: five 512 × 512 maps with rectangles on a fifth, corner to corner, steps of 20 cells, goal bias 0.05",
        &[
            "planner",
            "program",
            "success",
            "first ms",
            "90%",
            "worst ms",
            "length",
            "cut corners",
            "simplify ms",
            "simplified",
            "of shortest",
            "within 5%",
            "cut corners",
        ],
    );
    let runs = if quick { 20 } else { 200 };
    let folder = tools.folder("paths")?;
    let maps: Vec<Map> = (1..=if quick { 2 } else { 5 }).map(Map::generated).collect();
    let shortest: Vec<f64> = maps.iter().map(Map::shortest).collect();
    let mut files = Vec::new();
    for (at, map) in maps.iter().enumerate() {
        let file = folder.join(format!("{}.pgm", at + 1));
        fs::write(&file, map.pgm())?;
        files.push(file);
    }
    let ompl = tools.ompl("paths.cpp");
    for (name, planner) in
        [("RRT-Connect", PlannerKind::RrtConnect), ("RRT", PlannerKind::Rrt), ("RRT*", PlannerKind::RrtStar)]
    {
        let by_ompl = |resolution: &str| -> Result<Vec<Vec<Run>>, Absent> {
            let program = ompl.clone()?;
            let mut all = Vec::new();
            for file in &files {
                let mut command = Command::new(&program);
                command.arg(file).args([name, &runs.to_string(), resolution]);
                let text = answer(&mut command, Duration::from_mins(2))?;
                all.push(serde_json::from_str(&text).map_err(|error| format!("failed: {error}"))?);
            }
            Ok(all)
        };
        let ours = maps.iter().map(|map| (0..runs).map(|seed| ours(map, planner, seed)).collect()).collect();
        let programs = [
            ("ours", Ok(ours)),
            ("OMPL, edges checked every cell", by_ompl("1")),
            ("OMPL, edges checked every 1% of the map", by_ompl("7.24")),
        ];
        let as_in_missions = (planner == PlannerKind::RrtConnect).then(|| {
            let found =
                maps.iter().map(|map| (0..runs).map(|seed| best_of_two(map, seed)).collect()).collect();
            ("ours, shortest of two, as missions plan it", Ok(found))
        });
        for (program, found) in programs.into_iter().chain(as_in_missions) {
            let mut cells = vec![name.to_owned(), program.to_owned()];
            match found {
                Ok(found) => cells.extend(summary(&maps, &shortest, &found)),
                Err(why) => cells.push(why),
            }
            table.row(cells);
        }
    }
    let lengths: Vec<String> = shortest.iter().map(|length| format!("{length:.1}")).collect();
    table.note(format!("{runs} searches on each map. Times and lengths are the medians of the maps, from the least to the greatest; 90% and worst over all. A path cuts corners if it passes through an occupied cell by more than a millionth of its width, checked apart from all planners. The shortest paths, found in the visibility graph: {}.", lengths.join(", ")));
    table.note("OMPL's time is that of `solve` alone, until its first exact solution; its simplification is `PathSimplifier::simplifyMax`. Ours is from the query to the path.");
    table.print();
    Ok(())
}

fn summary(maps: &[Map], shortest: &[f64], found: &[Vec<Run>]) -> Vec<String> {
    let of_maps = |measure: &dyn Fn(&Run, f64) -> f64, digits: Option<usize>| {
        let medians: Vec<f64> = (found.iter().zip(shortest))
            .map(|(runs, &shortest)| {
                let values: Vec<f64> = runs
                    .iter()
                    .filter(|run| !run.path.is_empty())
                    .map(|run| measure(run, shortest))
                    .collect();
                median(&values)
            })
            .collect();
        let show = |value: f64| digits.map_or_else(|| figure(value), |digits| format!("{value:.digits$}"));
        let (least, greatest) = (quantile(&medians, 0.0), quantile(&medians, 1.0));
        if least.is_nan() { "–".to_owned() } else { format!("{} – {}", show(least), show(greatest)) }
    };
    let all: Vec<(&Run, &Map, f64)> = (found.iter().zip(maps).zip(shortest))
        .flat_map(|((runs, map), &shortest)| runs.iter().map(move |run| (run, map, shortest)))
        .collect();
    let times: Vec<f64> = all.iter().map(|(run, ..)| run.first_ms).collect();
    let successes = all.iter().filter(|(run, ..)| !run.path.is_empty()).count();
    let share = |count: usize| format!("{:.1} %", 100.0 * count as f64 / successes.max(1) as f64);
    vec![
        format!("{successes}/{}", all.len()),
        of_maps(&|run, _| run.first_ms, None),
        figure(quantile(&times, 0.9)),
        figure(quantile(&times, 1.0)),
        of_maps(&|run, _| length(&run.path), Some(0)),
        share(all.iter().filter(|(run, map, _)| map.cuts(&run.path)).count()),
        of_maps(&|run, _| run.simplify_ms, None),
        of_maps(&|run, _| length(&run.simplified), Some(0)),
        of_maps(&|run, shortest| length(&run.simplified) / shortest, Some(3)),
        share(
            all.iter()
                .filter(|(run, _, shortest)| {
                    !run.path.is_empty() && length(&run.simplified) <= 1.05 * shortest
                })
                .count(),
        ),
        share(all.iter().filter(|(run, map, _)| map.cuts(&run.simplified)).count()),
    ]
}

fn length(path: &[[f64; 2]]) -> f64 {
    path.windows(2).map(|pair| (pair[0][0] - pair[1][0]).hypot(pair[0][1] - pair[1][1])).sum()
}

fn coordinates<P: Into<[f64; 2]>>(points: Vec<P>) -> Vec<[f64; 2]> {
    points.into_iter().map(Into::into).collect()
}

fn ours(map: &Map, planner: PlannerKind, seed: u64) -> Run {
    let query = Query { start_m: ENDS[0].into(), goal_m: ENDS[1].into() };
    let settings = Settings { step_m: 20.0, goal_bias: 0.05, seed, ..Settings::of(planner) };
    let start = Stopwatch::start();
    let mut search = Search::new(&map.space, query, settings).expect("both ends are free");
    while search.statistics().samples_to_first_path.is_none() && !search.is_finished() {
        search.step(&map.space);
    }
    let path = search.path();
    let first_ms = millis(start.elapsed());
    let Some(path) = path else {
        return Run { first_ms, path: Vec::new(), simplify_ms: 0.0, simplified: Vec::new() };
    };
    let start = Stopwatch::start();
    let short = shorten(&map.space, &path, &ShortcutSettings { seed, ..ShortcutSettings::default() });
    Run {
        first_ms,
        path: coordinates(path.points_m),
        simplify_ms: millis(start.elapsed()),
        simplified: coordinates(short.points_m),
    }
}

/// Returns what a mission does for a leg of a traverse, with this comparison's step: all of it, shortening too, counts
/// as the time of the path.
fn best_of_two(map: &Map, seed: u64) -> Run {
    let query = Query { start_m: ENDS[0].into(), goal_m: ENDS[1].into() };
    let settings = Settings { step_m: 20.0, seed, ..Settings::of(PlannerKind::RrtConnect) };
    let shortcut = ShortcutSettings { seed, ..ShortcutSettings::default() };
    let start = Stopwatch::start();
    let found = find_shortest_path(&map.space, query, &settings, &shortcut, 2, &mut |_| false);
    let first_ms = millis(start.elapsed());
    let path = found.path.map(|path| coordinates(path.points_m)).unwrap_or_default();
    Run { first_ms, simplified: path.clone(), path, simplify_ms: f64::NAN }
}
