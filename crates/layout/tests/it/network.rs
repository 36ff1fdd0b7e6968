//! Drawings of networks that come from programs: nothing overlaps, nothing crosses, and edits move little.

use crate::drawings::{
    assert_nothing_overlaps, crossings, draw, draw_with, enroute, network_of, random_mission,
    segment_meets_rect, segments,
};
use display::{Point, Rect, Theme, svg};
use exact::Rational;
use layout::{BlockForm, Item, NetworkDrawing, NetworkState, Options, Shape, TextRole, network_list};
use tpn::generate::{Recipe, Tightness, mission};
use tpn::{BlockId, BlockKind, EventEnd, Network, NodeId, OccurrenceId};

fn generated(nodes: usize, seed: u64) -> Network {
    network_of(&mission(Recipe { nodes, tightness: Tightness::Feasible, seed }))
}

fn event(network: &Network, name: &str) -> NodeId {
    let (occurrence, end) = name.rsplit_once('.').expect("an occurrence and an end");
    let occurrence = network
        .occurrences
        .iter()
        .find(|other| other.name == occurrence)
        .unwrap_or_else(|| panic!("no {occurrence}"));
    if end == "start" { occurrence.start } else { occurrence.end }
}

fn at(network: &Network, drawing: &NetworkDrawing, name: &str) -> Point {
    drawing.node(event(network, name)).unwrap_or_else(|| panic!("{name} is hidden")).center
}

#[test]
fn every_event_and_constraint_of_enroute_is_drawn_where_time_puts_it() {
    let network = enroute();
    let drawing = draw(&network);
    assert_eq!((drawing.nodes.len(), drawing.arcs.len()), (network.nodes.len(), network.arcs.len()));
    let x = |name: &str| at(&network, &drawing, name).x;
    let order = [
        "Group-Enroute#1.start",
        "Group-Traverse-Path#1.start",
        "Group-Traverse-Path#1.end",
        "Group-Wait#1.start",
        "Group-Wait#1.end",
        "Group-Enroute#1.end",
    ];
    assert!(order.windows(2).all(|pair| x(pair[0]) < x(pair[1])));
    let y = |name: &str| at(&network, &drawing, name).y;
    assert!(y("Group-Traverse-Path#1.start") < y("Group-Traverse-Path#2.start"), "alternatives go downwards");
    assert!(y("Group-Transmit#1.start") < y("Group-Wait#1.start"), "so do branches");
    let texts: Vec<&str> = drawing.texts.iter().map(|text| text.text.as_str()).collect();
    for expected in
        ["[450,540]", "[405,486]", "Ask(PATH1=OK)", "Tell(PROCEED=OK)", "[0,54]", "[500,800]", "D1"]
    {
        assert!(texts.contains(&expected), "{expected} is not written");
    }
}

#[test]
fn bounds_of_an_activity_arch_over_everything_in_it() {
    let network = enroute();
    let drawing = draw(&network);
    let enroute =
        network.occurrences.iter().find(|occurrence| occurrence.activity == "Group-Enroute").expect("it is");
    let arch = drawing.arc(enroute.arc.expect("an instance has an arc")).expect("visible");
    let inside = ["Group-Traverse-Path#1.start", "Group-Traverse-Path#2.end", "Group-Transmit#1.start"];
    for name in inside {
        assert!(arch.bounds.min.y < at(&network, &drawing, name).y - 20.0);
    }
}

#[test]
fn the_picture_of_enroute_has_not_changed() {
    let network = enroute();
    let drawing = draw(&network);
    let list = network_list(&drawing, &network, &NetworkState::default());
    insta::assert_snapshot!(svg(&[&list], Theme::Light, "Enroute"));
}

#[test]
fn nothing_overlaps_in_programs_of_any_shape() {
    for seed in 0..60 {
        let network = network_of(&random_mission(seed, 60));
        assert_nothing_overlaps(&draw(&network), &format!("seed {seed}"));
    }
    for seed in 0..6 {
        assert_nothing_overlaps(&draw(&generated(300, seed)), &format!("generated, seed {seed}"));
    }
}

#[test]
fn nothing_overlaps_without_arguments_zero_bounds_or_windows() {
    let bare = Options { arguments: false, zero_bounds: false, window_width: 0.0, ..Options::default() };
    for seed in 0..20 {
        let network = network_of(&random_mission(seed, 40));
        assert_nothing_overlaps(&draw_with(&network, &bare), &format!("seed {seed}"));
    }
}

#[test]
fn arcs_of_a_program_never_cross() {
    for seed in 0..60 {
        let network = network_of(&random_mission(seed, 60));
        assert_eq!(crossings(&draw(&network)), 0, "seed {seed}");
    }
    for seed in 0..6 {
        assert_eq!(crossings(&draw(&generated(300, seed))), 0, "generated, seed {seed}");
    }
}

#[test]
fn no_arc_passes_through_a_text_or_through_a_node_that_is_not_its_own() {
    for seed in 0..25 {
        let network = network_of(&random_mission(seed, 30));
        let drawing = draw(&network);
        for (arc, from, to) in segments(&drawing) {
            let ends = &network.arcs[drawing.arcs[arc].id.index()];
            let area = Rect { min: from, max: from }.union(Rect { min: to, max: to });
            drawing.visit(area, 0.0, &mut |shape| {
                let obstacle = match shape {
                    Shape::Text(at) => Some(drawing.texts[at as usize].rect.expanded(-0.5)),
                    Shape::Node(at) => {
                        let node = &drawing.nodes[at as usize];
                        let own = node.id == ends.from || node.id == ends.to;
                        (!own).then(|| Rect::around(node.center, node.radius * 0.7))
                    }
                    _ => None,
                };
                if let Some(rect) = obstacle {
                    let id = drawing.arcs[arc].id;
                    assert!(
                        !segment_meets_rect(from, to, rect),
                        "seed {seed}: {id:?} meets {shape:?} at {rect:?}"
                    );
                }
            });
        }
    }
}

#[test]
fn an_edit_leaves_the_shape_of_everything_else_alone() {
    let text = |name: &str, extra: &str| {
        format!(
            "primitive A()[1,2]; primitive {name}()[1,2]; primitive C()[1,2];
             Left() = {{ A(); choose {{ C(), {{A(), C()}} }} }}
             Right() = {{ {name}(){extra}; C() }}
             scenario S[0,500] = {{ {{ A(), Left() }}; {{ Right(), Left() }} }}"
        )
    };
    let (before, after) = (network_of(&text("B", "")), network_of(&text("B-With-A-Long-Name", "; C(); C()")));
    let (first, second) = (draw(&before), draw(&after));
    for instance in ["Left#1", "Left#2"] {
        let shape = |network: &Network, drawing: &NetworkDrawing| {
            let origin = at(network, drawing, &format!("{instance}.start"));
            let inside = |occurrence: &tpn::Occurrence| {
                let mut parent = occurrence.parent;
                while let Some(id) = parent {
                    let around = &network.occurrences[id.index()];
                    if around.name == instance {
                        return true;
                    }
                    parent = around.parent;
                }
                false
            };
            let events = network.occurrences.iter().filter(|occurrence| inside(occurrence));
            let places = events.flat_map(|occurrence| [occurrence.start, occurrence.end]).map(|node| {
                let center = drawing.node(node).expect("visible").center;
                (center.x - origin.x, center.y - origin.y)
            });
            places.collect::<Vec<_>>()
        };
        let (was, is) = (shape(&before, &first), shape(&after, &second));
        assert!(was.len() >= 8, "the instance has events inside");
        assert_eq!(was, is, "{instance} has been moved apart");
    }
}

#[test]
fn what_comes_before_an_edit_stays_in_place() {
    let text = |end: &str| format!("primitive A()[1,2]; scenario S[0,500] = {{ A(); {{A(), A()}}; {end} }}");
    let (before, after) = (network_of(&text("A()")), network_of(&text("A(); {A(); A(), A()}; A()")));
    let (first, second) = (draw(&before), draw(&after));
    for name in ["A#1.start", "A#1.end", "A#2.start", "A#3.end"] {
        assert_eq!(at(&before, &first, name), at(&after, &second, name));
    }
}

#[test]
fn the_same_network_is_drawn_the_same() {
    let network = generated(200, 3);
    assert_eq!(draw(&network), draw(&network));
}

#[test]
fn a_collapsed_activity_is_a_box_with_its_name_and_what_it_hides() {
    let network = enroute();
    let is_enroute = |kind: &BlockKind| match kind {
        BlockKind::Scope { occurrence: Some(occurrence), .. } => {
            network.occurrences[occurrence.index()].activity == "Group-Enroute"
        }
        _ => false,
    };
    let block = network.blocks.iter().position(|block| is_enroute(&block.kind)).map(BlockId::from_index);
    let block = block.expect("Group-Enroute is a block");
    let options = Options { collapsed: [block].into(), ..Options::default() };
    let drawing = draw_with(&network, &options);
    let inside = network.nodes.len() - drawing.nodes.len();
    let hidden = event(&network, "Group-Traverse-Path#1.start");
    assert!(drawing.node(hidden).is_none());
    let shape = drawing.blocks.iter().find(|shape| shape.form == BlockForm::Collapsed).expect("a box");
    assert!(shape.rect.contains(drawing.anchor(hidden)), "what is hidden is found at the box");
    let texts: Vec<&str> = drawing
        .texts
        .iter()
        .filter(|text| text.owner == Item::Block(block))
        .map(|text| text.text.as_str())
        .collect();
    let bounds = format!("[450,540] · {inside} events");
    assert_eq!(texts, ["Group-Enroute", bounds.as_str(), "Rover1, Rover2 · 1 decision"]);
    assert_eq!(inside, 11, "SPEC 3.4: thirteen nodes, of which two are its start and end");
    assert!(drawing.bounds.width() < draw(&network).bounds.width());
    assert_nothing_overlaps(&drawing, "collapsed");
}

#[test]
fn a_box_names_the_call_and_counts_many_vehicles_and_decisions() {
    let network = network_of(
        "location CAMP (0, 0); location RIDGE (9, 0);\n\
         vehicle A, B, C : ATRV at CAMP;\n\
         group All = A, B, C;\n\
         primitive Drive(r : vehicle, to : location)[1,9] moves r;\n\
         primitive Look(to)[1,1];\n\
         Tour(to) = { each r in All { optional Drive(r, to) }; choose { Look(to), Look(CAMP) } }\n\
         scenario S[0,99] = { Tour(RIDGE) }",
    );
    let is_tour = |block: &&BlockId| match &network.blocks[block.index()].kind {
        BlockKind::Scope { occurrence: Some(occurrence), .. } => {
            network.occurrences[occurrence.index()].activity == "Tour"
        }
        _ => false,
    };
    let blocks: Vec<BlockId> = (0..network.blocks.len()).map(BlockId::from_index).collect();
    let tour = *blocks.iter().find(is_tour).expect("Tour is a block");
    let drawing = draw_with(&network, &Options { collapsed: [tour].into(), ..Options::default() });
    let texts: Vec<&str> = drawing
        .texts
        .iter()
        .filter(|text| text.owner == Item::Block(tour))
        .map(|text| text.text.as_str())
        .collect();
    assert_eq!((texts[0], texts[2]), ("Tour(RIDGE)", "3 vehicles · 4 decisions"));
    assert_nothing_overlaps(&drawing, "three lines");
}

#[test]
fn any_blocks_can_be_collapsed() {
    for seed in 0..40 {
        let network = network_of(&random_mission(seed, 50));
        let collapsed = (0..network.blocks.len()).filter(|at| (at * 7 + seed as usize).is_multiple_of(5));
        let options =
            Options { collapsed: collapsed.map(BlockId::from_index).collect(), ..Options::default() };
        let drawing = draw_with(&network, &options);
        assert_nothing_overlaps(&drawing, &format!("seed {seed}"));
        assert_eq!(crossings(&drawing), 0, "seed {seed}");
        assert!(drawing.arcs.iter().all(|arc| arc.route != layout::Route::Across), "seed {seed}");
    }
}

#[test]
fn a_place_on_the_drawing_leads_back_to_what_is_there() {
    let network = enroute();
    let drawing = draw(&network);
    for node in &drawing.nodes {
        assert_eq!(drawing.pick(node.center, 2.0), Some(Item::Node(node.id)));
    }
    for text in drawing.texts.iter().filter(|text| text.role != TextRole::Node) {
        assert_eq!(drawing.pick(text.rect.center(), 0.0), Some(text.owner), "{}", text.text);
    }
    let traverse = &network.occurrences
        [network.nodes[event(&network, "Group-Traverse-Path#1.start").index()].events[0].occurrence.index()];
    let arc = traverse.arc.expect("a primitive has an arc");
    let middle = drawing.anchor(traverse.start).lerp(drawing.anchor(traverse.end), 0.5);
    assert_eq!(drawing.pick(middle.shifted(0.0, 1.0), 2.0), Some(Item::Arc(arc)));
    assert_eq!(drawing.pick(drawing.bounds.min, 2.0), None);
    assert_eq!(network.nodes[traverse.start.index()].events[0].end, EventEnd::Start);
}

#[test]
fn the_index_finds_exactly_what_a_look_at_every_shape_finds() {
    let drawing = draw(&generated(400, 1));
    let all = |area: Rect, least: f64| {
        let texts = (0..drawing.texts.len() as u32).map(Shape::Text);
        let nodes = (0..drawing.nodes.len() as u32).map(Shape::Node);
        let arcs = (0..drawing.arcs.len() as u32).map(Shape::Arc);
        let blocks = (0..drawing.blocks.len() as u32).map(Shape::Block);
        let connectors = (0..drawing.connectors.len() as u32).map(Shape::Connector);
        let mut found: Vec<Shape> = texts
            .chain(nodes)
            .chain(arcs)
            .chain(blocks)
            .chain(connectors)
            .filter(|&shape| {
                let rect = drawing.shape_bounds(shape);
                rect.touches(area) && rect.width().max(rect.height()) >= least
            })
            .collect();
        found.sort();
        found
    };
    let bounds = drawing.bounds;
    for step in 0..40 {
        let fraction = f64::from(step) / 40.0;
        let corner = bounds.min.lerp(bounds.max, fraction);
        let area = Rect { min: corner, max: corner.shifted(30.0 + 50.0 * f64::from(step), 120.0) };
        for least in [0.0, 40.0, 500.0] {
            let mut found = Vec::new();
            drawing.visit(area, least, &mut |shape| found.push(shape));
            found.sort();
            assert_eq!(found, all(area, least));
        }
    }
}

#[test]
fn deep_nesting_and_wide_forks_are_drawn() {
    let deep = format!(
        "primitive A()[1,2]; scenario S[0,500] = {{ {}A(){} }}",
        "{A(), {A(); ".repeat(60),
        "}}".repeat(60)
    );
    let wide =
        format!("primitive A()[1,2]; scenario S[0,500] = {{ A(); {{ {} }} }}", vec!["A()"; 3000].join(", "));
    for (name, text) in [("deep", deep), ("wide", wide)] {
        let network = network_of(&text);
        let drawing = draw(&network);
        assert_eq!(drawing.nodes.len(), network.nodes.len(), "{name}");
        assert_nothing_overlaps(&drawing, name);
    }
}

#[test]
fn the_text_of_an_arch_slides_along_it_into_view_and_no_further() {
    let network = generated(200, 2);
    let drawing = draw(&network);
    let sliding: Vec<_> = drawing.texts.iter().filter(|text| text.slide.is_some()).collect();
    assert!(!sliding.is_empty());
    for text in sliding {
        let arch = drawing.arc(text.slide.expect("it slides").arc).expect("visible").bounds;
        assert_eq!(text.rect_in_view(arch.min.x, arch.max.x), text.rect, "all of the arch is in view");
        let all_in_view = text.rect_in_view(arch.center().x, arch.max.x);
        assert!(all_in_view.min.x >= text.rect.min.x, "{}", text.text);
        for far in
            [text.rect_in_view(arch.max.x + 500.0, arch.max.x + 900.0), text.rect_in_view(-900.0, -500.0)]
        {
            assert!(arch.min.x <= far.min.x && far.max.x <= arch.max.x, "{} leaves its arch", text.text);
        }
    }
}

#[test]
fn the_path_of_a_traverse_is_strung_above_its_arc() {
    use tpn::path::{PathLeg, TraversePath, insert_path};
    let network = enroute();
    let traverse =
        network.occurrences.iter().position(|it| it.name == "Group-Traverse-Path#1").expect("it is there");
    let leg = |length_m: f64, count: usize| PathLeg {
        segment_lengths_m: vec![length_m; count],
        ..PathLeg::default()
    };
    let path = TraversePath {
        occurrence: OccurrenceId::from_index(traverse),
        legs: vec![leg(10.0, 7), leg(5.0, 4)],
        speed_mps: (Rational::new(1, 10).expect("a tenth"), Rational::new(1, 2).expect("a half")),
        may_stop: false,
    };
    let mut with_path = network.clone();
    insert_path(&mut with_path, &path, 60).expect("the path is sound");
    assert_eq!(with_path.nodes.len(), network.nodes.len() + 10);
    let drawing = draw(&with_path);
    assert_eq!((drawing.nodes.len(), drawing.arcs.len()), (with_path.nodes.len(), with_path.arcs.len()));
    assert_nothing_overlaps(&drawing, "with a path");
    assert_eq!(crossings(&drawing), 0);
    let start = at(&with_path, &drawing, "Group-Traverse-Path#1.start");
    let end = at(&with_path, &drawing, "Group-Traverse-Path#1.end");
    let beads: Vec<Point> = drawing.nodes[network.nodes.len()..].iter().map(|node| node.center).collect();
    assert!(beads.windows(2).all(|pair| pair[0].x < pair[1].x && pair[0].y == pair[1].y));
    assert!(beads.iter().all(|bead| start.x < bead.x && bead.x < end.x && bead.y < start.y));
    assert_eq!(drawing.bounds.width(), draw(&network).bounds.width(), "a short path needs no more room");
}

#[test]
fn an_arc_that_begins_a_branch_runs_all_the_way_from_the_fork() {
    let network = network_of(
        "primitive A()[1,2]; scenario S[0,50] = { { delay[3,4]; A() }, { A() }, { A(); delay[1,2] } }",
    );
    let drawing = draw(&network);
    assert!(drawing.connectors.is_empty(), "no arc begins or ends beside its node");
    for arc in &drawing.arcs {
        let ends = &network.arcs[arc.id.index()];
        let tip = drawing.pieces(arc).last().expect("it goes somewhere").end();
        for (point, node) in [(arc.start, ends.from), (tip, ends.to)] {
            let shape = drawing.node(node).expect("visible");
            assert!((point.distance(shape.center) - shape.radius).abs() < 0.5, "{:?}", arc.id);
        }
    }
}
