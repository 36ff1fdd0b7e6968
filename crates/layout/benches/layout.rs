//! How long a drawing takes, with and without the program's structure, and how often its arcs cross.
//!
//! `cargo bench -p layout` prints one row per size; the crossings are counted by looking at every pair of arcs that are
//! near each other.

use std::time::{Duration, Instant};

use display::geometry::flatten;
use display::{Point, Rect, approximate_text_width};
use layout::{NetworkDrawing, Options, Room, Shape};
use tpn::generate::{Recipe, Tightness, mission};
use tpn::{Network, Top};

const SIZES: [usize; 4] = [100, 1_000, 10_000, 100_000];
/// The room of the network's panel in a window of 1280 × 800 points.
const PANEL: Room = Room { width: 620.0, height: 360.0 };

#[expect(clippy::print_stdout, reason = "printing its table is what a benchmark is for")]
fn main() {
    println!(
        "| nodes | arcs | layout ms | ns per node | recovered from the graph ms | fitted into a panel ms | crossings | view query µs |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for nodes in SIZES {
        let network = generated(nodes);
        let bare = Network { blocks: Vec::new(), root: None, ..network.clone() };
        let whole =
            |network: &Network| layout::network(network, &Options::default(), &approximate_text_width);
        let (with, drawing) = median(&network, whole);
        let (without, _) = median(&bare, whole);
        let (fitted, _) = median(&network, |network| {
            layout::fitted(network, &Options::default(), None, PANEL, &approximate_text_width)
        });
        let per_node = with.as_secs_f64() * 1e9 / network.nodes.len() as f64;
        println!(
            "| {} | {} | {:.3} | {per_node:.0} | {:.3} | {:.3} | {} | {:.1} |",
            network.nodes.len(),
            network.arcs.len(),
            with.as_secs_f64() * 1e3,
            without.as_secs_f64() * 1e3,
            fitted.as_secs_f64() * 1e3,
            crossings(&drawing),
            view_query(&drawing).as_secs_f64() * 1e6,
        );
    }
}

fn generated(nodes: usize) -> Network {
    let text = mission(Recipe { nodes, tightness: Tightness::Feasible, seed: 1 });
    let (network, diagnostics) = tpn::compile(&rmpl::parse(&text).program(), &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

/// The median of some runs, and the drawing.
fn median(network: &Network, draw: impl Fn(&Network) -> NetworkDrawing) -> (Duration, NetworkDrawing) {
    let runs = (200_000 / network.nodes.len().max(1)).clamp(5, 200);
    let mut drawing = NetworkDrawing::default();
    let mut times: Vec<Duration> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            drawing = draw(network);
            start.elapsed()
        })
        .collect();
    times.sort();
    (times[runs / 2], drawing)
}

/// Finding what is in a view of 1400 × 800 in the middle.
fn view_query(drawing: &NetworkDrawing) -> Duration {
    let view = Rect::around(drawing.bounds.center(), 0.0);
    let view = Rect { min: view.min.shifted(-700.0, -400.0), max: view.max.shifted(700.0, 400.0) };
    let start = Instant::now();
    let mut found = 0;
    for _ in 0..100 {
        drawing.visit(view, 0.0, &mut |_| found += 1);
    }
    assert!(found > 0, "there is something in the middle");
    start.elapsed() / 100
}

fn crossings(drawing: &NetworkDrawing) -> usize {
    let lines: Vec<Vec<Point>> =
        drawing.arcs.iter().map(|arc| flatten(arc.start, drawing.pieces(arc))).collect();
    let mut count = 0;
    for (at, line) in lines.iter().enumerate() {
        for ends in line.windows(2) {
            let area = Rect { min: ends[0], max: ends[0] }.union(Rect { min: ends[1], max: ends[1] });
            drawing.visit(area, 0.0, &mut |shape| {
                let Shape::Arc(other) = shape else { return };
                if other as usize > at {
                    let others = lines[other as usize].windows(2);
                    count += others.filter(|other| cross(ends[0], ends[1], other[0], other[1])).count();
                }
            });
        }
    }
    count
}

/// Returns whether two segments cross, not counting where one ends on the other.
fn cross(a: Point, b: Point, c: Point, d: Point) -> bool {
    let side = |from: Point, to: Point, point: Point| {
        let product = (to.x - from.x) * (point.y - from.y) - (to.y - from.y) * (point.x - from.x);
        if product.abs() <= 0.01 * from.distance(to) { 0.0 } else { product.signum() }
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}
