//! Drawings that fit the room there is: rows, boxes, and a focus that is drawn in more detail.

use std::collections::BTreeMap;

use crate::drawings::{assert_nothing_overlaps, crossings, draw_with, enroute, network_of, random_mission};
use display::approximate_text_width;
use layout::{BlockForm, Detail, Item, NetworkDrawing, Options, Room, fitted, openings};
use tpn::generate::{Recipe, Tightness, mission};
use tpn::{BlockId, BlockKind, Network};

const ROOM: Room = Room { width: 640.0, height: 360.0 };

fn generated(nodes: usize, seed: u64) -> Network {
    network_of(&mission(Recipe { nodes, tightness: Tightness::Feasible, seed }))
}

/// A scenario of so many steps, one after the other.
fn sequence(steps: usize) -> Network {
    let steps: Vec<String> = (0..steps).map(|at| format!("Step{}()", at % 7)).collect();
    let declared: String = (0..7).map(|at| format!("primitive Step{at}()[1,5];\n")).collect();
    network_of(&format!("{declared}scenario Long = {{ {} }}\n", steps.join("; ")))
}

fn fit(network: &Network, focus: Option<(BlockId, BlockId)>) -> NetworkDrawing {
    let options = Options { window_width: 0.0, ..Options::default() };
    fitted(network, &options, focus, ROOM, &approximate_text_width)
}

fn assert_fits(drawing: &NetworkDrawing, what: &str) {
    let bounds = drawing.bounds;
    // Small networks are made smaller before anything is behind a box.
    let zoom = if drawing.nodes.len() <= 60 && boxes(drawing).is_empty() { 0.35 } else { 0.8 };
    assert!(
        bounds.width() * zoom <= ROOM.width && bounds.height() * zoom <= ROOM.height,
        "{what}: {} by {}",
        bounds.width(),
        bounds.height()
    );
}

fn boxes(drawing: &NetworkDrawing) -> Vec<&layout::BlockShape> {
    drawing.blocks.iter().filter(|block| block.form == BlockForm::Collapsed).collect()
}

#[test]
fn a_sequence_in_rows_overlaps_nothing_and_crosses_nothing() {
    for seed in 0..40 {
        let network = network_of(&random_mission(seed, 60));
        for row_width in [300.0, 500.0, 900.0] {
            let drawing = draw_with(&network, &Options { row_width, ..Options::default() });
            let what = format!("seed {seed}, rows of {row_width}");
            assert_nothing_overlaps(&drawing, &what);
            assert_eq!(crossings(&drawing), 0, "{what}");
            assert_eq!(drawing.nodes.len(), network.nodes.len(), "{what}");
        }
    }
}

#[test]
fn a_level_of_detail_overlaps_nothing_and_shows_or_hides_each_event_once() {
    for seed in 0..40 {
        let network = network_of(&random_mission(seed, 60));
        for grain in [2, 4, 9, 30] {
            let detail = Detail { grain, finer: Vec::new() };
            let drawing = draw_with(&network, &Options { detail, row_width: 500.0, ..Options::default() });
            let what = format!("seed {seed}, grain {grain}");
            assert_nothing_overlaps(&drawing, &what);
            for (at, _) in network.nodes.iter().enumerate() {
                let node = tpn::NodeId::from_index(at);
                let (shown, hidden) = (drawing.node(node).is_some(), drawing.box_of(node).is_some());
                assert!(shown != hidden, "{what}: event {at} is shown {shown}, hidden {hidden}");
            }
        }
    }
}

#[test]
fn missions_of_any_size_fit_their_room_at_their_designed_size() {
    assert_fits(&fit(&enroute(), None), "enroute");
    for steps in [12, 40, 150, 5000] {
        assert_fits(&fit(&sequence(steps), None), &format!("{steps} steps"));
    }
    for (nodes, seed) in [(27, 1), (76, 2), (300, 3), (10_000, 4)] {
        let network = generated(nodes, seed);
        let drawing = fit(&network, None);
        assert_fits(&drawing, &format!("{nodes} events"));
        assert_nothing_overlaps(&drawing, &format!("{nodes} events"));
    }
}

#[test]
fn nothing_of_a_small_mission_is_behind_a_box() {
    assert!(boxes(&fit(&enroute(), None)).is_empty());
    assert!(!boxes(&fit(&generated(300, 3), None)).is_empty());
}

#[test]
fn the_first_mission_is_drawn_whole_in_the_panels_of_small_windows() {
    let network = network_of(include_str!("../../../../assets/missions/both-paths.rmpl"));
    let options = Options { window_width: 0.0, ..Options::default() };
    // What windows of 1280 by 713 and of 1024 by 768 points leave to the network, and less.
    for (width, height) in [(515.0, 280.0), (640.0, 205.0), (400.0, 250.0)] {
        let drawing = fitted(&network, &options, None, Room { width, height }, &approximate_text_width);
        let what = format!("{width} by {height}");
        assert!(boxes(&drawing).is_empty(), "{what}");
        assert_nothing_overlaps(&drawing, &what);
        let numbers = drawing.texts.iter().filter(|it| it.role == layout::TextRole::Bounds);
        assert!(numbers.clone().count() > 3, "{what}: too little is written");
        for number in numbers {
            assert!(!number.text.contains('…'), "{what}: {} is another number", number.text);
        }
    }
}

#[test]
fn what_fits_is_drawn_whole_and_unbroken() {
    let network = network_of("primitive A()[1,5];\nscenario Short = { A(); A() }\n");
    assert_eq!(
        fit(&network, None),
        draw_with(&network, &Options { window_width: 0.0, ..Options::default() })
    );
}

#[test]
fn what_does_not_fit_in_one_line_is_in_rows_before_anything_is_folded() {
    let network = sequence(14);
    let drawing = fit(&network, None);
    assert!(boxes(&drawing).is_empty());
    let lines: std::collections::BTreeSet<i64> =
        drawing.nodes.iter().map(|node| node.center.y as i64).collect();
    assert!(lines.len() > 1, "all on one line");
    assert!(drawing.bounds.height() * 4.0 > drawing.bounds.width(), "the room is used");
}

#[test]
fn a_long_sequence_is_boxes_that_name_what_they_hold_and_its_focus_is_open() {
    let network = sequence(2000);
    let drawing = fit(&network, None);
    let found = boxes(&drawing);
    assert!((4..60).contains(&found.len()), "{} boxes", found.len());
    let titles: Vec<&str> = drawing
        .texts
        .iter()
        .filter(|it| it.role == layout::TextRole::Title)
        .map(|it| it.text.as_str())
        .collect();
    assert!(titles.iter().all(|title| title.contains("Step")), "{titles:?}");
    let (first, last) = (found[1].block.expect("a block"), found[1].last.expect("a block"));
    assert!(first < last);
    let focused = fit(&network, Some((first, last)));
    assert_fits(&focused, "the focus");
    let is_inside = |block: BlockId| first <= block && block <= last;
    let inside =
        boxes(&focused).into_iter().filter_map(|it| it.block).filter(|&block| is_inside(block)).count();
    let leaves = focused.arcs.len();
    assert!(inside > 1 || leaves > 10, "{inside} boxes and {leaves} arcs in the focus");
}

#[test]
fn an_activity_that_is_the_focus_is_open_whatever_is_around_it() {
    let network = generated(300, 5);
    let activity = |block: &tpn::Block| matches!(block.kind, BlockKind::Scope { occurrence: Some(_), .. });
    for (at, _) in network.blocks.iter().enumerate().filter(|(_, block)| activity(block)) {
        let id = BlockId::from_index(at);
        let drawing = fit(&network, Some((id, id)));
        assert!(drawing.blocks.iter().any(|it| it.block == Some(id) && it.form != BlockForm::Collapsed));
    }
}

#[test]
fn any_event_is_seen_once_its_boxes_are_open() {
    let nested =
        (0..40).fold("Step()".to_owned(), |inner, _| format!("sequence {{ Step(); {inner}; Step() }}"));
    let nested = network_of(&format!("primitive Step()[1,5];\nscenario Deep = {{ {nested} }}\n"));
    let networks = [generated(300, 5), sequence(3000), nested, network_of(&random_mission(7, 60))];
    let options = Options { window_width: 0.0, ..Options::default() };
    let measure = &approximate_text_width;
    for (which, network) in networks.iter().enumerate() {
        for node in
            (0..network.nodes.len()).step_by(1 + network.nodes.len() / 40).map(tpn::NodeId::from_index)
        {
            let opened = openings(network, &options, None, Some(ROOM), &[node], measure);
            let drawing = fitted(network, &options, opened.last().copied(), ROOM, measure);
            let was_hidden = fit(network, None).node(node).is_none();
            assert!(drawing.node(node).is_some(), "network {which}: {node:?} after {opened:?}");
            assert_eq!(!opened.is_empty(), was_hidden, "network {which}: {node:?} after {opened:?}");
        }
    }
}

#[test]
fn a_collapsed_activity_is_opened_for_what_it_holds() {
    let network = network_of("primitive A()[1,5];\nB() = { A(); A() }\nscenario S = { B(); A() }\n");
    let is_activity = |block: &tpn::Block| matches!(block.kind, BlockKind::Scope { occurrence: Some(_), .. });
    let at = network.blocks.iter().position(is_activity).expect("an activity");
    let (id, block) = (BlockId::from_index(at), &network.blocks[at]);
    let options = Options { collapsed: [id].into(), ..Options::default() };
    let drawing = draw_with(&network, &options);
    let hidden =
        (0..network.nodes.len()).map(tpn::NodeId::from_index).find(|&node| drawing.node(node).is_none());
    let hidden = hidden.expect("an event inside");
    for room in [None, Some(ROOM)] {
        let seen =
            |nodes: &[tpn::NodeId]| openings(&network, &options, None, room, nodes, &approximate_text_width);
        assert_eq!(seen(&[hidden]), [(id, id)]);
        assert!(seen(&[hidden, block.start]).is_empty(), "one of them is seen");
    }
}

#[test]
fn a_box_counts_the_events_that_it_hides() {
    for seed in 0..40 {
        let network = network_of(&random_mission(seed, 60));
        for grain in [2, 4, 9, 30] {
            let detail = Detail { grain, finer: Vec::new() };
            let drawing = draw_with(&network, &Options { detail, ..Options::default() });
            let mut hidden: BTreeMap<BlockId, usize> = BTreeMap::new();
            for node in (0..network.nodes.len()).map(tpn::NodeId::from_index) {
                if let Some(block) = drawing.box_of(node).and_then(|shape| shape.block) {
                    *hidden.entry(block).or_default() += 1;
                }
            }
            for shape in boxes(&drawing) {
                let count = shape.block.and_then(|block| hidden.get(&block)).copied().unwrap_or(0);
                let told = if count == 1 { "1 event".to_owned() } else { format!("{count} events") };
                let owner = shape.block.map(Item::Block);
                let is_told =
                    drawing.texts.iter().any(|it| Some(it.owner) == owner && it.text.ends_with(&told));
                assert!(is_told, "seed {seed}, grain {grain}: {} hides {told}", shape.title);
            }
        }
    }
}

#[test]
fn a_place_in_a_box_leads_to_its_first_block() {
    let network = sequence(300);
    let drawing = fit(&network, None);
    for shape in boxes(&drawing) {
        assert_eq!(drawing.pick(shape.rect.center(), 0.0), shape.block.map(Item::Block));
    }
}

#[test]
fn a_box_is_named_by_the_activities_it_holds_and_not_by_what_they_do() {
    let network = network_of(
        "primitive Look()[1,2];\nSurvey() = { Look(); delay[1,2]; Look() }\nscenario S = { Survey(); Survey(); \
         delay[1,1]; Look(); X=ON }\n",
    );
    let detail = Detail { grain: 40, finer: Vec::new() };
    let drawing = draw_with(&network, &Options { detail, ..Options::default() });
    let titles: Vec<&str> = boxes(&drawing).iter().map(|shape| shape.title.as_str()).collect();
    assert_eq!(titles, ["Survey … Look"]);
}
