//! Display lists: everything that a drawing has is in its list, in its role, and the screen's frame and a report's give
//! the same shapes.

use std::collections::{BTreeMap, BTreeSet};

use crate::drawings::{draw, enroute, network_of, overlapping};
use crate::plans::earliest_plan;
use display::{ColorRole, DisplayList, Fill, Rect, Shape, Target, TargetKind, Theme, approximate_text_width};
use layout::list::map::{MapFrame, MapPath, extent_m, map_list, path_stroke};
use layout::list::timeline::{ROW_HEIGHT, Standing, TimelineState, Track, axis_list, timeline_list};
use layout::timeline::before::{BarChange, Before};
use layout::timeline::rule::{RuleBand, RuleStanding, RuleTrack};
use layout::timeline::{Bar, BarKind, Chart, ChartOptions, Grouping, RowKind};
use layout::{Item, NetworkDrawing, NetworkState, network_list};
use tpn::generate::{Recipe, Tightness, mission};
use tpn::{Levels, Network, Plan};

/// A plan that selects everything, with windows by the longest ways from the start.
fn plan_of(network: &Network) -> Plan {
    earliest_plan(network, Some(30))
}

fn targets(list: &DisplayList) -> BTreeMap<Target, usize> {
    let mut found = BTreeMap::new();
    for target in list.items().iter().filter_map(|item| item.target) {
        *found.entry(target).or_default() += 1;
    }
    found
}

fn of_kind(list: &DisplayList, kind: TargetKind) -> BTreeSet<u32> {
    targets(list).into_keys().filter(|target| target.kind == kind).map(|target| target.id).collect()
}

fn networks() -> Vec<Network> {
    let generated =
        |nodes, seed| network_of(&mission(Recipe { nodes, tightness: Tightness::Feasible, seed }));
    vec![enroute(), generated(200, 1), generated(2_000, 2)]
}

#[test]
fn every_node_arc_and_label_is_in_the_list_of_a_network() {
    for network in networks() {
        let drawing = draw(&network);
        let list = network_list(&drawing, &network, &NetworkState::default());
        let all = |count: usize| (0..count as u32).collect::<BTreeSet<_>>();
        assert_eq!(of_kind(&list, TargetKind::Node), all(network.nodes.len()));
        assert_eq!(of_kind(&list, TargetKind::Arc), all(network.arcs.len()));
        let written = |drawing: &NetworkDrawing| {
            let labels = drawing.texts.iter().filter_map(|text| match text.owner {
                Item::Label(label) => Some(label.0),
                _ => None,
            });
            labels.collect::<BTreeSet<_>>()
        };
        assert_eq!(of_kind(&list, TargetKind::Label), written(&drawing));
    }
}

#[test]
fn labels_of_a_list_lie_inside_its_frame_and_over_no_other() {
    for network in networks() {
        let list = network_list(&draw(&network), &network, &NetworkState::default());
        let texts: Vec<_> = list
            .items()
            .iter()
            .filter(|item| item.detail.holds(1.0))
            .filter_map(|item| match item.shape {
                Shape::Text(place) => Some(list.text(place)),
                _ => None,
            })
            .collect();
        let rects: Vec<Rect> = texts.iter().map(|text| text.rect).collect();
        assert!(rects.iter().all(|it| list.frame.contains(it.min) && list.frame.contains(it.max)));
        if let Some(&(one, other)) = overlapping(&rects).first() {
            panic!("{:?} lies over {:?}", texts[one], texts[other]);
        }
        assert!(texts.iter().all(|text| text.size >= 5.0), "all can be read at the designed size");
    }
}

#[test]
fn the_roles_of_a_network_say_what_the_plan_selects() {
    let network = enroute();
    let drawing = draw(&network);
    let mut plan = plan_of(&network);
    plan.selected_arcs[0] = false;
    let state = NetworkState { plan: Some(&plan), ..NetworkState::default() };
    let list = network_list(&drawing, &network, &state);
    let role_of_arc = |id: u32| {
        let found = list.items().iter().find(|item| {
            item.target == Some(Target { kind: TargetKind::Arc, id })
                && matches!(item.shape, Shape::Path { .. })
        });
        found.and_then(|item| item.stroke).expect("a line").color.role
    };
    assert_eq!(role_of_arc(0), ColorRole::PathUnselected);
    assert!((1..network.arcs.len() as u32).all(|arc| role_of_arc(arc) == ColorRole::Path));
    let asks = list.items().iter().filter_map(|item| match (item.shape, item.target?) {
        (Shape::Text(place), Target { kind: TargetKind::Label, .. }) => Some(list.text(place)),
        _ => None,
    });
    for text in asks {
        let wanted = if text.text.starts_with("Ask") { ColorRole::Ask } else { ColorRole::Tell };
        assert!([wanted, ColorRole::TextFaint].contains(&text.color.role), "{text:?}");
    }
}

#[test]
fn a_network_s_file_has_a_size_in_proportion_to_its_list() {
    for network in networks() {
        let list = network_list(&draw(&network), &network, &NetworkState::default());
        let written = display::svg(&[&list], Theme::Dark, "t");
        assert_eq!(written, display::svg(&[&list], Theme::Dark, "t"), "the same list, the same file");
        assert!(written.len() < 400 * list.items().len() + 1_000, "{} items", list.items().len());
    }
}

const TIMED: &str = "MODE, PATH1: ON | OFF | OK;
primitive Drive() = { MODE=ON [3,9] };
primitive Wait(); primitive Talk();
scenario S = { Drive()[4,9]; { Wait()[2,30]; { Talk()[5,6]; Wait()[1,1] } }; Talk()[3,3] }";

fn chart_of(network: &Network, plan: &Plan, text: &str) -> Chart {
    let options = ChartOptions {
        conditions: true,
        states: true,
        resources: true,
        delays: true,
        grouping: Grouping::Structure,
    };
    Chart::new(&rmpl::parse(text).program(), (network, plan), &[], options, &BTreeSet::new())
}

fn track(chart: &Chart, frame: Rect, names: f64, notes: f64) -> Track {
    let (left, right) = (frame.min.x + names, frame.max.x - notes);
    let visible = Rect::new(left, frame.min.y, right, frame.max.y);
    let scale = (right - left) / chart.horizon;
    Track { frame, left, right, top: frame.min.y, start: 0.0, scale, visible }
}

fn rows_of(chart: &Chart, shown: (&Network, &Plan), track: &Track) -> DisplayList {
    let links: Vec<_> = track.links(chart).into_iter().map(|curve| (curve, false)).collect();
    let state = TimelineState {
        now: None,
        is_executing: false,
        range: None,
        row: &|_| Standing::default(),
        bar: &|_| Standing::default(),
        links: &links,
        note: None,
    };
    timeline_list(chart, shown, track, 0..chart.rows.len(), &state)
}

#[test]
fn a_timeline_has_the_same_bars_in_a_panel_and_on_paper() {
    for text in [TIMED, include_str!("../../../../assets/missions/enroute.rmpl")] {
        let network = network_of(text);
        let plan = plan_of(&network);
        let chart = chart_of(&network, &plan, text);
        let height = ROW_HEIGHT * chart.rows.len() as f64 + 20.0;
        let panel = track(&chart, Rect::new(300.0, 80.0, 1_700.0, 80.0 + height), 190.0, 8.0);
        let paper = track(&chart, Rect::new(0.0, 0.0, 940.0, height), 230.0, 110.0);
        let [in_panel, on_paper] = [panel, paper].map(|track| rows_of(&chart, (&network, &plan), &track));
        assert_eq!(targets(&in_panel), targets(&on_paper));
        let bars = of_kind(&in_panel, TargetKind::Occurrence);
        let drawn = chart.bars.iter().filter(|bar| bar.label.is_none()).filter_map(|bar| bar.occurrence);
        assert_eq!(bars.intersection(&drawn.clone().map(|it| it.0).collect()).count(), drawn.count());
        for list in [&in_panel, &on_paper] {
            let inside = list.frame.expanded(1.0);
            let boxes = list.items().iter().filter(|item| matches!(item.shape, Shape::Rectangle { .. }));
            assert!(
                boxes.map(|item| list.bounds_of(item)).all(|it| inside.contains(it.min)),
                "nothing is cut"
            );
        }
    }
}

const LASTING: &str = "state ARM : { IN, OUT } = IN;
resource Battery 0..100 = 60;
resource Power capacity 3;
primitive Deploy()[4,8] requires ARM=IN sets ARM=OUT consumes Battery 50 uses Power 2;
primitive Dig()[5,9] requires ARM=OUT uses Power 1;
primitive Charge()[10,20] produces Battery 40;
scenario S = { Deploy(); Dig(); Charge() }";

/// The bars of the row of this name, with what they are and when, in the earliest schedule.
fn state_bars(chart: &Chart, name: &str) -> Vec<(BarKind, String, [f64; 2])> {
    let row = chart.rows.iter().find(|row| row.kind == RowKind::State && row.name == name).expect("a track");
    let bars = chart.bars[row.bars.clone()].iter();
    bars.map(|bar| (bar.kind, bar.name.to_string(), [bar.start[0], bar.end[0]])).collect()
}

#[test]
fn a_state_has_its_values_side_by_side_and_who_needs_them() {
    let network = network_of(LASTING);
    let plan = plan_of(&network);
    let chart = chart_of(&network, &plan, LASTING);
    let mut bars = state_bars(&chart, "ARM");
    bars.sort_by(|left, right| left.2[0].total_cmp(&right.2[0]).then(left.2[1].total_cmp(&right.2[1])));
    let bar = |kind, name: &str, times| (kind, name.to_owned(), times);
    assert_eq!(
        bars,
        [
            // What sets a variable needs its old value at its start alone.
            bar(BarKind::Value, "IN", [0.0, 0.0]),
            bar(BarKind::Need, "IN", [0.0, 0.0]),
            bar(BarKind::Changing, "OUT", [0.0, 4.0]),
            bar(BarKind::Need, "OUT", [4.0, 9.0]),
            bar(BarKind::Value, "OUT", [4.0, 19.0]),
        ]
    );
    let list =
        rows_of(&chart, (&network, &plan), &track(&chart, Rect::new(0.0, 0.0, 900.0, 500.0), 200.0, 8.0));
    let drawn = of_kind(&list, TargetKind::Label);
    assert_eq!(drawn.len(), network.labels.len(), "each requirement and each change can be pointed at");
    let is_hatched = |item: &&display::Item| matches!(item.fill, Some(Fill::Hatched(color)) if matches!(color.role, ColorRole::Series(_)));
    assert_eq!(list.items().iter().filter(is_hatched).count(), 1, "the arm is moving once");
    assert!(list.texts().iter().any(|text| text.text == "OUT"));
}

#[test]
fn what_a_value_is_for_is_said_in_words() {
    let network = network_of(LASTING);
    let mut plan = plan_of(&network);
    let label = |name: &str| {
        let found = (0..network.labels.len()).map(tpn::LabelId::from_index);
        found.into_iter().find(|&label| network.label_name(label) == name).expect("a label")
    };
    let (ask, tell) = (label("Ask(ARM=OUT)@Dig#1"), label("Set(ARM=OUT)@Deploy#1"));
    plan.causal_links = vec![tpn::CausalLink { ask, tell }];
    let chart = chart_of(&network, &plan, LASTING);
    let words = |kind: BarKind, label: tpn::LabelId| {
        let bar = chart.bars.iter().find(|bar| bar.kind == kind && bar.label == Some(label)).expect("a bar");
        layout::timeline::state::words(&network, &plan, bar)
    };
    assert_eq!(words(BarKind::Value, tell), ["ARM is OUT, set by Deploy#1", "required by Dig#1"]);
    assert_eq!(words(BarKind::Changing, tell), ["ARM is changing: Deploy#1 sets it to OUT"]);
    assert_eq!(words(BarKind::Value, label("Init(ARM=IN)")), ["ARM is initially IN", "no activity needs it"]);
    assert_eq!(
        words(BarKind::Need, ask),
        ["Dig#1 requires ARM=OUT throughout", "supported by Set(ARM=OUT)@Deploy#1"]
    );
    let link = chart.links.first().expect("the link is drawn");
    assert_eq!(chart.bars[link.from.1].kind, BarKind::Value, "the value carries it");
    assert_eq!(chart.bars[link.to.1].name, "Dig");
}

#[test]
fn a_resource_has_its_profile_with_its_limits_and_the_plan_s_extremes() {
    let network = network_of(LASTING);
    let mut plan = plan_of(&network);
    plan.levels = vec![Levels::Range { low: 10.into(), high: 50.into() }, Levels::Peak(2.into())];
    let chart = chart_of(&network, &plan, LASTING);
    let steps: Vec<Vec<(f64, i64)>> = chart
        .profiles
        .iter()
        .map(|profile| profile.steps.iter().map(|step| (step.time, step.level.floor())).collect())
        .collect();
    assert_eq!(steps, [vec![(0.0, 10), (19.0, 50)], vec![(0.0, 2), (4.0, 1), (9.0, 0)]]);
    let height = ROW_HEIGHT * chart.rows.len() as f64 + 20.0;
    let place = track(&chart, Rect::new(0.0, 0.0, 900.0, height), 200.0, 8.0);
    let list = rows_of(&chart, (&network, &plan), &place);
    let written: Vec<&str> = list.texts().iter().map(|text| text.text.as_str()).collect();
    for words in [
        "from 10 to 50",
        "allowed 0 to 100",
        "low 10",
        "high 50",
        "minimum 0",
        "maximum 100",
        "peak 2 of 3",
        "1 to spare",
        "peak 2",
        "capacity 3",
    ] {
        assert!(written.contains(&words), "{words} is missing in {written:?}");
    }
    let is_number = |text: &&display::Text| {
        let words = ["low ", "high ", "minimum ", "maximum ", "peak ", "capacity "];
        words.iter().any(|word| text.text.starts_with(word))
    };
    let numbers: Vec<_> = list.texts().iter().filter(is_number).collect();
    assert_eq!(numbers.len(), 7, "what is possible and what is reached, of both");
    let words_of = |text: &display::Text| {
        let width = display::text_width_at(&text.text, text.size, &approximate_text_width);
        Rect::new(text.rect.max.x - width, text.rect.min.y, text.rect.max.x, text.rect.max.y)
    };
    for (at, text) in numbers.iter().enumerate() {
        for other in &numbers[at + 1..] {
            assert!(!words_of(text).overlaps(words_of(other)), "{} lies over {}", text.text, other.text);
        }
    }
    // Scrolled so that its first row is above what is seen, a profile is drawn all the same.
    let first = chart.rows.iter().position(|row| matches!(row.kind, RowKind::Profile(_))).expect("a profile");
    let state = TimelineState {
        now: None,
        is_executing: false,
        range: None,
        row: &|_| Standing::default(),
        bar: &|_| Standing::default(),
        links: &[],
        note: None,
    };
    let lower = timeline_list(&chart, (&network, &plan), &place, first + 1..chart.rows.len(), &state);
    assert!(lower.texts().iter().any(|text| text.text == "low 10"));
    let written = display::svg(&[&list], Theme::Light, "t");
    assert!(written.contains("<title>Battery: level 10; Deploy#1 consumes 50 at start</title>"), "{written}");
}

#[test]
fn numbers_of_an_axis_do_not_touch() {
    for horizon in [7.0, 660.0, 1_234_567.0] {
        let chart = Chart { horizon, ..Chart::default() };
        let track = track(&chart, Rect::new(0.0, 0.0, 940.0, 24.0), 200.0, 20.0);
        let list = axis_list(&track, Rect::new(200.0, 0.0, 920.0, 24.0), "min", Some(1.0));
        let numbers = list.texts().iter().filter(|text| text.text != "min");
        let places: Vec<Rect> = numbers
            .map(|text| {
                let width = display::text_width_at(&text.text, text.size, &approximate_text_width);
                let middle = text.rect.center().x;
                Rect::new(middle - width / 2.0, 0.0, middle + width / 2.0, 10.0)
            })
            .collect();
        assert!(places.len() > 2, "{horizon}: {places:?}");
        assert!(overlapping(&places).is_empty(), "{horizon}: {places:?}");
    }
}

#[test]
fn everything_of_a_world_is_on_its_map() {
    let text = include_str!("../../../../assets/missions/enroute.rmpl");
    let world = rmpl::parse(text).program().world;
    let [low, high] = extent_m(&world, std::iter::empty()).expect("places");
    let frame = MapFrame::with_side(low, high, 640.0);
    let points_m = world.locations.iter().map(|it| it.position_m.into()).collect();
    let paths = [MapPath { name: "tour <1>", points_m, stroke: path_stroke(0) }];
    let list = map_list(&world, &paths, &frame, Some(&|_| 200));
    let all = |count: usize| (0..count as u32).collect::<BTreeSet<_>>();
    assert_eq!(of_kind(&list, TargetKind::Place), all(world.locations.len()));
    assert_eq!(of_kind(&list, TargetKind::Obstacle), all(world.obstacles.len()));
    assert_eq!(of_kind(&list, TargetKind::Path), all(1));
    let seen = list.frame.expanded(2.0);
    for item in list.items().iter().filter(|item| item.target.is_some_and(|it| it.kind != TargetKind::Path)) {
        let bounds = list.bounds_of(item);
        assert!(seen.contains(bounds.min) && seen.contains(bounds.max), "{item:?} sticks out");
    }
    let written = display::svg(&[&list], Theme::Light, "Map");
    assert!(written.contains("<title>tour &lt;1&gt;</title>"));
}

#[test]
fn another_plan_is_laid_over_a_timeline() {
    let mission = |first: &str, second: &str| {
        format!("primitive A(); primitive B(); primitive C(); scenario S = {{ {first}; B()[4,6]; {second} }}")
    };
    let (before, after) = (mission("A()[2,3]", "C()[1,2]"), mission("A()[5,6]", "A()[1,1]"));
    let times = |text: &str| {
        let network = network_of(text);
        let plan = plan_of(&network);
        let bars = chart_of(&network, &plan, text).bars;
        let named = bars.iter().filter_map(|bar| {
            let occurrence = network.occurrences.get(bar.occurrence?.index())?;
            Some((occurrence.name.clone(), [bar.start, bar.end]))
        });
        named.collect::<Vec<_>>()
    };
    let former = Before::new(times(&before));
    let network = network_of(&after);
    let plan = plan_of(&network);
    let mut chart = chart_of(&network, &plan, &after);
    let unchanged = chart.rows.len();
    chart.compare_with(&Before::new(times(&after)), &network, &plan);
    assert_eq!((chart.changes.len(), chart.gone.len(), chart.rows.len()), (0, 0, unchanged));
    chart.compare_with(&former, &network, &plan);
    let gone: Vec<&str> = chart.gone.iter().map(|gone| gone.name.as_str()).collect();
    assert_eq!(gone, ["C#1"]);
    assert_eq!(chart.rows.len(), unchanged + 2, "a heading and what is gone");
    let change = |name: &str| {
        let is_it = |bar: &Bar| bar.occurrence.is_some_and(|it| network.occurrences[it.index()].name == name);
        let at = chart.bars.iter().position(is_it).expect("a bar");
        chart.changes.get(&at).copied()
    };
    assert_eq!(change("A#2"), Some(BarChange::New));
    assert_eq!(change("A#1"), Some(BarChange::Moved([[0.0, 30.0], [2.0, 32.0]])));
    assert_eq!(change("B#1"), Some(BarChange::Moved([[2.0, 32.0], [6.0, 36.0]])));
    // What was is dashed: both that have moved, the whole mission, and what is gone.
    let list =
        rows_of(&chart, (&network, &plan), &track(&chart, Rect::new(0.0, 0.0, 900.0, 400.0), 200.0, 8.0));
    let dashed = list.items().iter().filter(|item| {
        matches!(item.shape, Shape::Rectangle { .. })
            && item.stroke.is_some_and(|stroke| stroke.dash != display::Dash::Solid)
    });
    let moved = chart.changes.values().filter(|it| matches!(it, BarChange::Moved(_))).count();
    assert_eq!(dashed.count(), moved + 1);
}

#[test]
fn a_rule_is_drawn_where_it_is_looked_at_and_where_it_is_broken() {
    let network = network_of(TIMED);
    let plan = plan_of(&network);
    let mut chart = chart_of(&network, &plan, TIMED);
    let rows = chart.rows.len();
    let band = |from: f64, to: f64, standing| RuleBand { times: [from, to], standing };
    let bands = vec![
        band(0.0, f64::INFINITY, RuleStanding::Applies),
        band(2.0, 30.0, RuleStanding::Open),
        band(4.0, 30.0, RuleStanding::Broken),
    ];
    let rule = RuleTrack { name: "Quiet".into(), words: "an execution breaks it".to_owned(), bands };
    chart.add_rules(vec![rule], &BTreeSet::new());
    assert_eq!(
        chart.rows[rows..].iter().map(|row| row.name.as_str()).collect::<Vec<_>>(),
        ["Flight rules", "Quiet"]
    );
    let track = track(&chart, Rect::new(0.0, 0.0, 1_900.0, 900.0), 200.0, 8.0);
    let list = rows_of(&chart, (&network, &plan), &track);
    let has_word = list.texts().iter().any(|text| text.text == "broken");
    assert!(has_word, "a state is a word, never a color alone");
    let closed: BTreeSet<_> = [chart.rows[rows].key.clone().expect("it can be closed")].into();
    let mut folded = chart_of(&network, &plan, TIMED);
    folded.add_rules(chart.rules.clone(), &closed);
    assert_eq!(folded.rows.len(), rows + 1);
}

#[test]
fn a_network_over_another_plan_has_words_beside_what_is_new_or_moved_and_crosses_what_is_gone() {
    use layout::list::network_before::{NetworkChanges, changes_list};
    let mission = |first: &str, rest: &str| {
        format!(
            "primitive A()[1,9]; primitive B()[1,9]; primitive C()[1,9]; scenario S[0,40] = {{ {first}; B()[3,4]; {rest} }}"
        )
    };
    let (before, after) = (mission("A()[2,3]", "C()[1,2]"), mission("A()[5,6]", "A()[1,1]"));
    let times = |text: &str| {
        let network = network_of(text);
        let plan = plan_of(&network);
        let window = |node: tpn::NodeId| {
            let window = plan.windows[node.index()].expect("it is in the plan");
            [window.earliest.to_f64(), window.latest.to_f64()]
        };
        let named =
            network.occurrences.iter().map(|it| (it.name.clone(), [window(it.start), window(it.end)]));
        Before::new(named.collect::<Vec<_>>())
    };
    let network = network_of(&after);
    let plan = plan_of(&network);
    let measure = &display::approximate_text_width;
    let drawing = layout::network(&network, &layout::Options::default(), measure);
    let same = NetworkChanges::new(&times(&after), &network, &plan);
    assert_eq!((same.changes.len(), same.gone.len()), (0, 0));
    let nothing = changes_list(&drawing, (&network, &plan), &same, measure);
    assert_eq!((nothing.items().len(), nothing.frame), (0, drawing.bounds));
    let changes = NetworkChanges::new(&times(&before), &network, &plan);
    let list = changes_list(&drawing, (&network, &plan), &changes, measure);
    let mut words: Vec<String> = list.texts().iter().map(|text| text.text.to_string()).collect();
    words.sort();
    assert_eq!(words, ["C#1", "Removed from the plan", "end was 2–32", "new", "was 2–32"]);
    // What is said along arcs lies over no name, no bound and no circle, and over nothing else that is said.
    let said: Vec<_> = list.texts().iter().filter(|it| it.text.contains("was") || it.text == "new").collect();
    for (at, words) in said.iter().enumerate() {
        let name = drawing.texts.iter().find(|it| it.rect.overlaps(words.rect));
        assert!(name.is_none(), "{} lies over {name:?}", words.text);
        assert!(!said[at + 1..].iter().any(|it| it.rect.overlaps(words.rect)), "{}", words.text);
        let circle =
            |it: &layout::NodeShape| display::Rect { min: it.center, max: it.center }.expanded(it.radius);
        assert!(!drawing.nodes.iter().any(|it| circle(it).overlaps(words.rect)), "{}", words.text);
    }
    // Told apart without color: what has moved is dashed, what is new is not.
    let dashed = |item: &&display::Item| item.stroke.is_some_and(|it| it.dash == display::Dash::Dashed);
    let paths: Vec<_> = list.items().iter().filter(|item| matches!(item.shape, Shape::Path { .. })).collect();
    assert_eq!(paths.iter().copied().filter(dashed).count(), 2, "A#1 and B#1 have moved");
    // Everything is inside the frame, which goes below the drawing for what is gone.
    assert!(list.frame.max.y > drawing.bounds.max.y && list.frame.min.y == drawing.bounds.min.y);
    for item in list.items() {
        let place = list.bounds_of(item);
        assert!(list.frame.expanded(6.0).contains(place.min) && list.frame.expanded(6.0).contains(place.max));
    }
}
