//! Missions drawn for tests: as networks, as random programs, and with geometry checked the slow way.

use display::geometry::flatten;
use display::{Point, Rect, approximate_text_width};
use layout::{Item, NetworkDrawing, Options};
use tpn::generate::Rng;
use tpn::{Network, Top};

/// The network of a mission text, which must compile.
pub(crate) fn network_of(text: &str) -> Network {
    let parse = rmpl::parse(text);
    let (network, diagnostics) = tpn::compile(&parse.program(), &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("{diagnostics:#?}\n{text}"))
}

/// The mission that the papers describe.
pub(crate) fn enroute() -> Network {
    network_of(include_str!("../../../../../assets/missions/enroute.rmpl"))
}

/// A network as another tool would have written it: without the program's structure.
pub(crate) fn without_blocks(mut network: Network) -> Network {
    network.blocks.clear();
    network.root = None;
    network
}

pub(crate) fn draw(network: &Network) -> NetworkDrawing {
    draw_with(network, &Options::default())
}

pub(crate) fn draw_with(network: &Network, options: &Options) -> NetworkDrawing {
    layout::network(network, options, &approximate_text_width)
}

/// A program that nests everything the language has, in any order.
pub(crate) fn random_mission(seed: u64, size: u32) -> String {
    let mut writer = Writer { rng: Rng::new(seed), left: size, out: String::new() };
    writer
        .out
        .push_str("primitive A(x)[1,5];\nprimitive A-Much-Longer-Name(place, message);\nprimitive B();\n");
    writer.out.push_str("Inner()[l,u] = { A(1)[l,u] }\nOuter(p)[l,u] = { { B(), A(p) }; Inner()[0,u] }\n");
    writer.out.push_str("scenario Random[0,100000] = { B(); ");
    writer.sequence(0);
    writer.out.push_str(" }\n");
    writer.out
}

struct Writer {
    rng: Rng,
    left: u32,
    out: String,
}

impl Writer {
    fn sequence(&mut self, depth: u32) {
        for at in 0..=self.rng.below(3) {
            if at > 0 {
                self.out.push_str("; ");
            }
            self.unit(depth + 1);
        }
    }

    fn list(&mut self, open: &str, close: &str, depth: u32) {
        self.out.push_str(open);
        for at in 0..2 + self.rng.below(3) {
            if at > 0 {
                self.out.push_str(", ");
            }
            self.unit(depth + 1);
        }
        self.out.push_str(close);
    }

    fn unit(&mut self, depth: u32) {
        self.left = self.left.saturating_sub(1);
        let choice = if self.left == 0 || depth > 7 { self.rng.below(6) } else { self.rng.below(14) };
        match choice {
            0 | 1 => self.out.push_str("A(3)"),
            2 => self.out.push_str("A-Much-Longer-Name(Somewhere-far-away, ARRIVED)[12,3000]"),
            3 => self.out.push_str("B()"),
            4 => self.out.push_str("delay[10,inf]"),
            5 => self.out.push_str("MODE=ON[3,450]"),
            6 => self.out.push_str("Outer(7)[0,90]"),
            7 | 8 => self.list("{ ", " }", depth),
            9 => self.list("{ ", " }[5,6000]", depth),
            10 | 11 => self.list("choose { ", " }", depth),
            12 => {
                self.out.push_str("do { ");
                self.sequence(depth);
                self.out.push_str(" } maintaining not MODE=OFF [0,700]");
            }
            _ => {
                self.out.push_str("if FLAG=UP thennext { ");
                self.sequence(depth);
                self.out.push_str(" }");
            }
        }
    }
}

/// All pairs of rectangles that overlap.
pub(crate) fn overlapping(rects: &[Rect]) -> Vec<(usize, usize)> {
    let mut order: Vec<usize> = (0..rects.len()).collect();
    order.sort_by(|&left, &right| rects[left].min.x.total_cmp(&rects[right].min.x));
    let mut found = Vec::new();
    for (at, &left) in order.iter().enumerate() {
        for &right in &order[at + 1..] {
            if rects[right].min.x >= rects[left].max.x {
                break;
            }
            if rects[left].overlaps(rects[right]) {
                found.push((left, right));
            }
        }
    }
    found
}

/// Fails if texts or nodes of a drawing lie over each other.
pub(crate) fn assert_nothing_overlaps(drawing: &NetworkDrawing, what: &str) {
    let nodes = drawing.nodes.iter().map(|node| Rect::around(node.center, node.radius));
    let texts: Vec<_> = drawing.texts.iter().filter(|text| !matches!(text.owner, Item::Node(_))).collect();
    let rects: Vec<Rect> = nodes.chain(texts.iter().map(|text| text.rect)).collect();
    let name = |at: usize| match at.checked_sub(drawing.nodes.len()) {
        None => format!("{:?}", drawing.nodes[at]),
        Some(text) => format!("{:?}", texts[text]),
    };
    if let Some(&(left, right)) = overlapping(&rects).first() {
        panic!("{what}: {} lies over {}", name(left), name(right));
    }
}

/// The straight pieces of all arcs: the arc and the ends of each piece.
pub(crate) fn segments(drawing: &NetworkDrawing) -> Vec<(usize, Point, Point)> {
    let mut segments = Vec::new();
    for (at, arc) in drawing.arcs.iter().enumerate() {
        let points = flatten(arc.start, drawing.pieces(arc));
        segments.extend(points.windows(2).map(|ends| (at, ends[0], ends[1])));
    }
    segments
}

/// Returns how often arcs of a drawing cross, not counting where they share a line or an end.
pub(crate) fn crossings(drawing: &NetworkDrawing) -> usize {
    let mut segments = segments(drawing);
    segments.sort_by(|left, right| left.1.x.min(left.2.x).total_cmp(&right.1.x.min(right.2.x)));
    let mut count = 0;
    for (at, left) in segments.iter().enumerate() {
        let reach = left.1.x.max(left.2.x);
        for right in segments[at + 1..].iter().take_while(|right| right.1.x.min(right.2.x) <= reach) {
            count += usize::from(left.0 != right.0 && segments_cross(left.1, left.2, right.1, right.2));
        }
    }
    count
}

fn segments_cross(a: Point, b: Point, c: Point, d: Point) -> bool {
    let side = |from: Point, to: Point, point: Point| {
        let cross = (to.x - from.x) * (point.y - from.y) - (to.y - from.y) * (point.x - from.x);
        // Points nearer to the line than a hundredth of a unit are on it.
        let limit = 0.01 * from.distance(to);
        if cross.abs() <= limit { 0.0 } else { cross.signum() }
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// Returns whether a segment passes through the inside of a rectangle.
pub(crate) fn segment_meets_rect(from: Point, to: Point, rect: Rect) -> bool {
    let steps = (from.distance(to) / 1.5).ceil().max(1.0) as u32;
    (0..=steps).any(|step| {
        let at = from.lerp(to, f64::from(step) / f64::from(steps));
        rect.min.x < at.x && at.x < rect.max.x && rect.min.y < at.y && at.y < rect.max.y
    })
}
