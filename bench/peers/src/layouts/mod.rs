//! Drawings of the same mission networks by ours, Graphviz, ELK, dagre and `rust-sugiyama`, with crossings counted alike.

mod crossings;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::Result;
use display::approximate_text_width;
use display::geometry::flatten;
use layout::Options;
use rust_sugiyama::configure::Config;
use serde::{Deserialize, Serialize};
use tpn::generate::{Recipe, Tightness, mission};
use tpn::{Network, Top};

use crate::stopwatch::Stopwatch;
use crate::table::{Table, figure, median, millis, ratio};
use crate::tools::{Absent, Tools, answer};
use crossings::{Line, crossings};

/// How long a layout may take.
const LIMIT: Duration = Duration::from_mins(1);

/// A graph as the others take it. All nodes have one size.
#[derive(Serialize)]
struct Graph {
    nodes: usize,
    edges: Vec<(usize, usize)>,
}

/// The width and height of every node.
const NODE_SIZE: f64 = 24.0;

/// What a layout came to.
#[derive(Deserialize)]
struct Drawn {
    /// Milliseconds, the median of the runs.
    millis: f64,
    lines: Vec<Line>,
}

/// Prints one table.
pub(crate) fn compare(tools: &mut Tools, quick: bool) -> Result<()> {
    let mut table = Table::new(
        "Layout of mission networks",
        &["nodes", "arcs", "layout", "median ms", "of ours", "crossings"],
    );
    let sizes: &[usize] = if quick { &[100] } else { &[100, 1_000, 10_000] };
    let folder = tools.folder("layout")?;
    for &size in sizes {
        let network = generated(size);
        let graph = Graph {
            nodes: network.nodes.len(),
            edges: network.arcs.iter().map(|arc| (arc.from.index(), arc.to.index())).collect(),
        };
        let file = folder.join(format!("{size}.json"));
        fs::write(&file, serde_json::to_vec(&graph)?)?;
        let bare = Network { blocks: Vec::new(), root: None, ..network.clone() };
        let runs = if size < 10_000 { 5 } else { 1 };
        let ours = ours(&network);
        let base = ours.millis;
        let rows = [
            ("ours", Ok(ours)),
            ("ours, without the program", Ok(self::ours(&bare))),
            ("rust-sugiyama 0.4.0", sugiyama(&graph)),
            ("Graphviz dot", graphviz(&graph, &folder.join(format!("{size}.dot")))),
            ("ELK layered (elkjs 0.12.1)", javascript(tools, "elk", runs, &file)),
            ("dagre 3.1.3", javascript(tools, "dagre", runs, &file)),
        ];
        for (name, drawn) in rows {
            let mut cells = vec![graph.nodes.to_string(), graph.edges.len().to_string(), name.to_owned()];
            match drawn {
                Ok(drawn) => cells.extend([
                    figure(drawn.millis),
                    ratio(drawn.millis, base),
                    crossings(&drawn.lines).to_string(),
                ]),
                Err(why) => cells.push(why),
            }
            table.row(cells);
        }
    }
    table.note("Ours also sizes and places all texts. The others get bare nodes of one size. Graphviz' time is that of its process (10 to 20 ms of it for starting). `rust-sugiyama` places nodes only: its arcs are counted as straight lines. Crossings are counted on the lines as drawn, touching and running along each other not counted.");
    table.print();
    Ok(())
}

fn generated(nodes: usize) -> Network {
    let text = mission(Recipe { nodes, tightness: Tightness::Feasible, seed: 1 });
    let (network, diagnostics) = tpn::compile(&rmpl::parse(&text).program(), &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

/// The median time of some runs, and the lines of the last.
fn timed(runs: usize, mut draw: impl FnMut()) -> f64 {
    let times: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Stopwatch::start();
            draw();
            millis(start.elapsed())
        })
        .collect();
    median(&times)
}

fn ours(network: &Network) -> Drawn {
    let mut drawing = None;
    let runs = (200_000 / network.nodes.len().max(1)).clamp(5, 200);
    let millis = timed(runs, || {
        drawing = Some(layout::network(network, &Options::default(), &approximate_text_width));
    });
    let lines = drawing.iter().flat_map(|drawing| {
        drawing.arcs.iter().map(|arc| {
            flatten(arc.start, drawing.pieces(arc)).into_iter().map(|point| [point.x, point.y]).collect()
        })
    });
    Drawn { millis, lines: lines.collect() }
}

fn sugiyama(graph: &Graph) -> Result<Drawn, Absent> {
    let vertices: Vec<(u32, (f64, f64))> =
        (0..graph.nodes as u32).map(|at| (at, (NODE_SIZE, NODE_SIZE))).collect();
    let mut edges: Vec<(u32, u32)> = graph.edges.iter().map(|&(from, to)| (from as u32, to as u32)).collect();
    edges.sort_unstable();
    edges.dedup();
    let mut places = vec![[0.0; 2]; graph.nodes];
    let runs = (10_000 / graph.nodes.max(1)).clamp(3, 20);
    let mut components = 0;
    let millis = timed(runs, || {
        let layouts = rust_sugiyama::from_vertices_and_edges(&vertices, &edges, &Config::default());
        components = layouts.len();
        for (at, (x, y)) in layouts.into_iter().flat_map(|(layout, _, _)| layout) {
            places[at] = [x, y];
        }
    });
    if components != 1 {
        return Err("failed: it does not see that the network is connected".to_owned());
    }
    Ok(Drawn {
        millis,
        lines: graph.edges.iter().map(|&(from, to)| vec![places[from], places[to]]).collect(),
    })
}

/// `dot -Tplain`, whose time is that of the process.
fn graphviz(graph: &Graph, file: &Path) -> Result<Drawn, Absent> {
    let absent = |error: std::io::Error| format!("not run: {error}");
    let mut text = String::from(
        "digraph {\n rankdir=LR;\n node [shape=box, width=0.33, height=0.33, fixedsize=true, label=\"\"];\n",
    );
    for (from, to) in &graph.edges {
        let _ = writeln!(text, " n{from} -> n{to};");
    }
    text.push_str("}\n");
    fs::write(file, text).map_err(absent)?;
    let mut times = Vec::new();
    let mut plain = String::new();
    for _ in 0..if graph.nodes < 5_000 { 5 } else { 1 } {
        let start = Instant::now();
        plain = answer(Command::new("dot").arg("-Tplain").arg(file), LIMIT).map_err(|why| match why {
            why if why.starts_with("not run") => "not run: no Graphviz (Debian: graphviz)".to_owned(),
            why => why,
        })?;
        times.push(millis(start.elapsed()));
    }
    Ok(Drawn { millis: median(&times), lines: plain.lines().filter_map(plain_edge).collect() })
}

/// `edge TAIL HEAD N X1 Y1 … XN YN …`: the control points of joined cubic curves, in inches.
fn plain_edge(line: &str) -> Option<Line> {
    const PER_INCH: f64 = 72.0;
    const STEPS: u32 = 16;
    let mut words = line.strip_prefix("edge ")?.split_whitespace().skip(2);
    let count: usize = words.next()?.parse().ok()?;
    let numbers: Vec<f64> = words.take(2 * count).filter_map(|word| word.parse().ok()).collect();
    let points: Vec<[f64; 2]> =
        numbers.chunks_exact(2).map(|pair| [pair[0] * PER_INCH, pair[1] * PER_INCH]).collect();
    let mut corners = vec![*points.first()?];
    for start in (0..points.len().saturating_sub(3)).step_by(3) {
        let [a, b, c, d] = [points[start], points[start + 1], points[start + 2], points[start + 3]];
        for step in 1..=STEPS {
            let t = f64::from(step) / f64::from(STEPS);
            let weights =
                [(1.0 - t).powi(3), 3.0 * t * (1.0 - t).powi(2), 3.0 * t * t * (1.0 - t), t.powi(3)];
            corners.push([0, 1].map(|axis| {
                weights[0] * a[axis] + weights[1] * b[axis] + weights[2] * c[axis] + weights[3] * d[axis]
            }));
        }
    }
    Some(corners)
}

/// `layouts.mjs` in Node.
fn javascript(tools: &mut Tools, which: &str, runs: usize, file: &Path) -> Result<Drawn, Absent> {
    let folder = tools.node()?;
    let mut command = Command::new("node");
    command
        .arg("--stack-size=60000")
        .arg("layouts.mjs")
        .args([which, &runs.to_string()])
        .arg(file)
        .current_dir(folder);
    let text = answer(&mut command, LIMIT * (runs as u32 + 1))?;
    serde_json::from_str(&text).map_err(|error| format!("failed: {error}"))
}
