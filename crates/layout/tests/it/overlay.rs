//! What a plan or its failure adds to a drawing, and what of it is exported.

use crate::drawings::{draw, draw_with, enroute, network_of, random_mission, segment_meets_rect};
use display::{Theme, approximate_text_width, svg};
use exact::{Bound, Time};
use layout::overlay::{causal_links, negative_cycle, orderings, windows};
use layout::{Item, NetworkState, Options, network_list};
use tpn::{BlockId, BlockKind, CausalLink, LabelId, Network, Ordering, Plan, Window};

fn label(network: &Network, name: &str) -> LabelId {
    let all = (0..network.labels.len()).map(LabelId::from_index);
    let found = all.into_iter().find(|&label| network.label_name(label) == name);
    found.unwrap_or_else(|| panic!("no label {name}"))
}

/// The plan of SPEC 3.6, as far as drawings read it; the same window everywhere.
fn plan(network: &Network) -> Plan {
    let second_alternative = network.decisions[0].alternatives[1];
    let selected_arcs: Vec<bool> =
        (0..network.arcs.len()).map(|at| at != second_alternative.index()).collect();
    let skipped = network.arcs[second_alternative.index()].to;
    Plan {
        choices: Vec::new(),
        selected_nodes: (0..network.nodes.len()).map(|at| at != skipped.index()).collect(),
        selected_arcs,
        causal_links: vec![CausalLink {
            ask: label(network, "Ask(PATH1=OK)@Group-Traverse-Path#1"),
            tell: label(network, "Tell(PATH1=OK)@Tell(PATH1=OK)#1"),
        }],
        conflict_order: Vec::new(),
        conflict_order_omitted: 0,
        state_order: Vec::new(),
        orderings_added: vec![Ordering {
            first: label(network, "Tell(not(PROCEED=OK))@Group-Wait#1"),
            then: label(network, "Tell(PROCEED=OK)@Tell(PROCEED=OK)#1"),
        }],
        uses_ordered: Vec::new(),
        levels: Vec::new(),
        quality: tpn::Quality::default(),
        windows: vec![
            Some(Window { earliest: Time::from(460), latest: Bound::Finite(Time::from(600)) });
            network.nodes.len()
        ],
    }
}

#[test]
fn a_causal_link_runs_from_the_assertion_to_the_requirement() {
    let network = enroute();
    let drawing = draw(&network);
    let plan = plan(&network);
    let links = causal_links(&drawing, &network, &plan);
    let [link] = links.as_slice() else { panic!("one link") };
    let rect = |label: LabelId| {
        drawing.texts.iter().find(|text| text.owner == Item::Label(label)).expect("it is written").rect
    };
    assert!(rect(plan.causal_links[0].tell).contains(link.start));
    assert!(rect(plan.causal_links[0].ask).contains(link.pieces.last().expect("it goes somewhere").end()));
}

#[test]
fn an_ordering_runs_from_the_first_end_to_the_second_start() {
    let network = enroute();
    let drawing = draw(&network);
    let plan = plan(&network);
    let curves = orderings(&drawing, &network, &plan);
    let [curve] = curves.as_slice() else { panic!("one ordering") };
    let arc = |label: LabelId| &network.arcs[network.labels[label.index()].arc.index()];
    let from = drawing.node(arc(plan.orderings_added[0].first).to).expect("visible");
    let to = drawing.node(arc(plan.orderings_added[0].then).from).expect("visible");
    assert!((curve.start.distance(from.center) - from.radius).abs() < 1e-6);
    let end = curve.pieces.last().expect("it goes somewhere").end();
    assert!((end.distance(to.center) - to.radius).abs() < 1e-6);
}

#[test]
fn a_negative_cycle_follows_arcs_where_there_are_any_and_closes() {
    let network = enroute();
    let drawing = draw(&network);
    let required = network.labels[label(&network, "Ask(PATH1=OK)@Group-Traverse-Path#1").index()].arc;
    let traverse = &network.arcs[required.index()];
    let events = [network.start, traverse.from, traverse.to, network.end];
    let curves = negative_cycle(&drawing, &network, &events);
    assert_eq!(curves.len(), events.len());
    let arc = drawing.arc(required).expect("visible");
    assert_eq!(curves[1].start, arc.start);
    assert_eq!(curves[1].pieces, drawing.pieces(arc));
    let span = network.nodes[network.start.index()].out_arcs.iter();
    let span = span.copied().find(|id| network.arcs[id.index()].to == network.end).expect("the horizon");
    let span = drawing.arc(span).expect("visible");
    assert_eq!(
        curves[3].pieces.last().expect("it goes back").end(),
        span.start,
        "the horizon is walked backwards"
    );
}

#[test]
fn a_step_of_a_cycle_leads_from_its_event_to_the_next_over_rows_as_well() {
    let mut joined = 0;
    for seed in 0..20 {
        let network = network_of(&random_mission(seed, 60));
        for row_width in [300.0, 500.0] {
            let drawing = draw_with(&network, &Options { row_width, ..Options::default() });
            for shape in &drawing.arcs {
                let arc = &network.arcs[shape.id.index()];
                let curves = negative_cycle(&drawing, &network, &[arc.from, arc.to]);
                let Some(step) = curves.first() else { continue };
                let end = step.pieces.last().expect("it goes somewhere").end();
                for (node, at) in [(arc.from, step.start), (arc.to, end)] {
                    let node = drawing.node(node).expect("nothing is folded");
                    let apart = node.center.distance(at) - node.radius;
                    assert!(apart < 1.0, "seed {seed}, {row_width}: {apart} from {:?}", node.id);
                }
                joined += usize::from(step.pieces.len() > drawing.pieces(shape).len());
            }
        }
    }
    assert!(joined > 200, "{joined}");
}

#[test]
fn windows_stand_below_their_events_and_over_nothing() {
    let network = enroute();
    let drawing = draw(&network);
    let plan = plan(&network);
    let notes = windows(&drawing, &plan, Options::default().window_width, &approximate_text_width);
    assert!(notes.iter().all(|note| note.text == "[460,600]"));
    assert!(notes.len() >= 15, "every event and decision has one");
    for note in &notes {
        let over = drawing.texts.iter().find(|text| text.rect.overlaps(note.rect));
        assert!(over.is_none(), "{:?} lies over {over:?}", note.owner);
    }
}

#[test]
fn a_window_wider_than_its_room_is_written_smaller() {
    let network = enroute();
    let drawing = draw(&network);
    let mut plan = plan(&network);
    let earliest = Time::new(123_456_789, 7).expect("a fraction");
    plan.windows.fill(Some(Window { earliest, latest: Bound::Finite(earliest) }));
    let width = Options::default().window_width;
    let notes = windows(&drawing, &plan, width, &approximate_text_width);
    assert!(notes.iter().all(|note| note.rect.width() <= width && note.size < 10.5));
}

#[test]
fn the_exported_picture_shows_the_plan_and_the_theme() {
    let network = enroute();
    let drawing = draw(&network);
    let plan = plan(&network);
    let overlays = causal_links(&drawing, &network, &plan);
    let export = |theme: Theme, plan: Option<&Plan>| {
        let parts = layout::Parts { structure: false, ..layout::Parts::default() };
        let state = NetworkState { plan, overlays: &overlays, parts, ..NetworkState::default() };
        svg(&[&network_list(&drawing, &network, &state)], theme, "A < B")
    };
    let light = export(Theme::Light, Some(&plan));
    assert!(light.starts_with("<svg ") && light.ends_with("</svg>\n"));
    assert!(light.contains("<title>A &lt; B</title>"));
    assert_eq!(light.matches("<circle").count(), network.nodes.len() + network.decisions.len());
    let gray = "stroke=\"#a3aeba\"";
    assert!(light.contains(gray), "what is not selected is gray");
    assert!(!export(Theme::Light, None).contains(gray));
    assert!(export(Theme::Dark, Some(&plan)).contains("fill=\"#13171d\""));
    assert!(light.contains("stroke-dasharray"), "the causal link is dashed");
}

#[test]
fn an_ordering_between_rows_runs_over_no_text() {
    let network = enroute();
    let drawing = draw(&network);
    let plan = plan(&network);
    for curve in orderings(&drawing, &network, &plan) {
        let line = display::geometry::flatten(curve.start, &curve.pieces);
        for ends in line.windows(2) {
            let over = drawing.texts.iter().find(|text| {
                !matches!(text.owner, Item::Node(_)) && segment_meets_rect(ends[0], ends[1], text.rect)
            });
            assert!(over.is_none(), "the ordering runs over {over:?}");
        }
    }
}

#[test]
fn links_and_orderings_end_at_the_edge_of_the_box_that_hides_their_end_and_not_within_it() {
    let network = enroute();
    let mut plan = plan(&network);
    let is_enroute = |kind: &BlockKind| match kind {
        BlockKind::Scope { occurrence: Some(occurrence), .. } => {
            network.occurrences[occurrence.index()].activity == "Group-Enroute"
        }
        _ => false,
    };
    let block = network.blocks.iter().position(|block| is_enroute(&block.kind)).map(BlockId::from_index);
    let collapsed = [block.expect("Group-Enroute is a block")].into();
    let drawing = draw_with(&network, &Options { collapsed, ..Options::default() });
    let ask = plan.causal_links[0].ask;
    let hiding =
        drawing.box_of(network.arcs[network.labels[ask.index()].arc.index()].from).expect("a box").rect;
    let is_on_edge = |point: display::Point| point.y == hiding.min.y || point.y == hiding.max.y;
    let links = causal_links(&drawing, &network, &plan);
    let [link] = links.as_slice() else { panic!("one link") };
    assert!(is_on_edge(link.pieces.last().expect("it goes somewhere").end()), "{link:?} {hiding:?}");
    let curves = orderings(&drawing, &network, &plan);
    let [curve] = curves.as_slice() else { panic!("one ordering") };
    assert!(is_on_edge(curve.start), "{curve:?} {hiding:?}");
    // What is between two hidden places has no way to show.
    plan.causal_links[0].tell = label(&network, "Tell(not(PROCEED=OK))@Group-Wait#1");
    plan.orderings_added[0].then = ask;
    assert_eq!(causal_links(&drawing, &network, &plan), []);
    assert_eq!(orderings(&drawing, &network, &plan), []);
}

/// Three threads below each other, whose events stand in columns.
const THREE_USES: &str = "var ARM : {STOWED, DIG, LIFT};
scenario Arm-Day[0,20] = {
  { delay[0,inf]; ARM=DIG [5,5] },
  { delay[0,6]; ARM=LIFT [5,5] },
  { delay[6,6]; ARM=STOWED [4,4] }
}";

#[test]
fn orderings_run_beside_each_other_and_past_the_events_between_them() {
    let network = network_of(THREE_USES);
    let drawing = draw(&network);
    let tell = |value: &str| label(&network, &format!("Tell(ARM={value})@Tell(ARM={value})#1"));
    let orders = [("LIFT", "STOWED"), ("STOWED", "DIG"), ("DIG", "STOWED")];
    let orderings_added: Vec<Ordering> =
        orders.iter().map(|(first, then)| Ordering { first: tell(first), then: tell(then) }).collect();
    let plan = Plan { orderings_added, ..plan(&enroute()) };
    let curves = orderings(&drawing, &network, &plan);
    assert_eq!(curves.len(), 3);
    let lines: Vec<Vec<display::Point>> =
        curves.iter().map(|curve| display::geometry::flatten(curve.start, &curve.pieces)).collect();
    for line in &lines {
        for node in &drawing.nodes {
            // Half its size: a way begins and ends at the rim of its own events.
            let inner = display::Rect::around(node.center, node.radius / 2.0);
            let is_through = line.windows(2).any(|ends| segment_meets_rect(ends[0], ends[1], inner));
            assert!(!is_through, "{line:?} passes through {node:?}");
        }
    }
    let level_runs = |line: &[display::Point]| {
        let runs = line.windows(2).filter(|ends| ends[0].y == ends[1].y && ends[0].distance(ends[1]) > 1.0);
        runs.map(|ends| (ends[0].y, ends[0].x.min(ends[1].x), ends[0].x.max(ends[1].x))).collect::<Vec<_>>()
    };
    for (at, one) in lines.iter().enumerate() {
        for other in &lines[at + 1..] {
            for (y, left, right) in level_runs(one) {
                let is_on = |run: &&(f64, f64, f64)| run.0 == y && run.1 < right && left < run.2;
                assert_eq!(level_runs(other).iter().find(is_on), None, "{one:?} {other:?}");
            }
        }
    }
}

#[test]
fn a_text_that_a_link_runs_through_stands_on_a_plate() {
    let network = network_of(THREE_USES);
    let drawing = draw(&network);
    let text = drawing.texts.iter().find(|text| text.text == "[0,6]").expect("the delay's bound");
    let across = layout::OverlayCurve {
        kind: layout::OverlayKind::CausalLink,
        number: 0,
        start: text.rect.center().shifted(0.0, -40.0),
        pieces: vec![display::Piece::Line(text.rect.center().shifted(0.0, 40.0))],
        bounds: text.rect.expanded(40.0),
    };
    let plates = |overlays: &[layout::OverlayCurve]| {
        let state = NetworkState { overlays, ..NetworkState::default() };
        let list = network_list(&drawing, &network, &state);
        list.texts()
            .iter()
            .filter(|text| text.plate.is_some())
            .map(|text| text.text.to_string())
            .collect::<Vec<_>>()
    };
    assert!(!plates(&[]).contains(&"[0,6]".to_owned()));
    assert!(plates(&[across]).contains(&"[0,6]".to_owned()));
}
