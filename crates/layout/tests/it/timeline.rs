//! The timeline as data and as drawn: whose lane an activity is in, what is packed into which row, and where names are.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use display::{DisplayList, Rect, approximate_text_width, text_width_at};
use layout::list::timeline::{ROW_HEIGHT, Standing, TimelineState, Track, legend_list, timeline_list};
use layout::timeline::{BarKind, Chart, ChartOptions, Grouping, Past, RowKind};
use tpn::{Network, OccurrenceId, OccurrenceKind, Plan};

use crate::drawings::{network_of, overlapping};
use crate::plans::earliest_plan;

/// A plan that selects everything, as early as the lower bounds allow, with much slack.
fn plan_of(network: &Network) -> Plan {
    earliest_plan(network, Some(500))
}

fn chart(text: &str, grouping: Grouping) -> (Network, Plan, Chart) {
    let network = network_of(text);
    let plan = plan_of(&network);
    let chart = chart_of(text, &network, &plan, grouping, &[]);
    (network, plan, chart)
}

fn chart_of(text: &str, network: &Network, plan: &Plan, grouping: Grouping, past: &[Past]) -> Chart {
    let options = ChartOptions { conditions: true, states: true, resources: true, delays: false, grouping };
    Chart::new(&rmpl::parse(text).program(), (network, plan), past, options, &BTreeSet::new())
}

const ROVERS: &str = "location CAMP (0, 0); location RIDGE (9, 0); location BASIN (0, 9);
vehicle Scout : ATRV at CAMP; vehicle Lab : ATRV at CAMP;
resource Battery 0..100 = 60; resource Radio; resource Arm; state SAMPLE : {NO, YES} = NO;
primitive Drive(rover, to)[4,9] moves rover consumes Battery 2;
primitive Convoy(to)[5,5] moves Scout, Lab;
primitive Look(rover, place)[2,3] requires rover.at=place;
primitive Dig()[3,4] uses Arm sets SAMPLE=YES;
primitive Reach()[3,4] requires Lab.at=RIDGE uses Arm;
primitive Talk()[1,2] uses Radio;
primitive Clean()[1,1] sets SAMPLE=NO;
primitive Wait()[1,2];
Survey(rover)[0,90] = { Drive(rover, RIDGE); Look(rover, RIDGE); Talk() }
All()[0,99] = { Wait(); Talk() }
scenario S = { Convoy(CAMP); { Survey(Scout), Drive(Lab, RIDGE) }; Reach(); Dig(); Clean(); All() }";

/// Each lane by its name, with what is in its rows.
fn lanes(chart: &Chart) -> BTreeMap<String, BTreeSet<String>> {
    let mut lanes = BTreeMap::new();
    let mut name = String::new();
    for row in &chart.rows {
        if row.depth == 0 {
            name = row.name.to_string();
        }
        let lane: &mut BTreeSet<String> = lanes.entry(name.clone()).or_default();
        match row.kind {
            RowKind::Packed => {
                lane.extend(chart.bars[row.bars.clone()].iter().map(|bar| bar.name.to_string()));
            }
            RowKind::State | RowKind::Profile(_) if !row.name.is_empty() => {
                lane.insert(format!("= {}", row.name));
            }
            _ => {}
        }
    }
    lanes
}

#[test]
fn an_activity_is_in_the_lane_of_its_vehicle_then_of_its_resource_then_of_its_state() {
    let (_, _, chart) = chart(ROVERS, Grouping::Vehicle);
    let lanes = lanes(&chart);
    let of = |lane: &str| lanes[lane].iter().map(String::as_str).collect::<Vec<_>>();
    assert_eq!(of("Mission"), ["All", "Wait"]);
    // What is called with a vehicle is the vehicle's, with what uses no one's resource in it.
    assert_eq!(
        of("Scout"),
        ["= Radio", "= Scout.at", "Drive(Scout, RIDGE)", "Look(Scout, RIDGE)", "Survey(Scout)", "Talk"]
    );
    // Only the laboratory uses the arm, so digging is its work, and the sample its state.
    assert_eq!(of("Lab"), ["= Arm", "= Lab.at", "= SAMPLE", "Clean", "Dig", "Drive(Lab, RIDGE)", "Reach"]);
    assert_eq!(of("Scout, Lab"), ["Convoy(CAMP)"]);
    assert_eq!(of("Battery"), ["= Battery"], "both vehicles drain it");
}

#[test]
fn every_activity_is_in_one_row_with_no_other_at_its_time_and_rows_go_by_time() {
    for text in [ROVERS, &generated(300), include_str!("../../../../assets/missions/enroute.rmpl")] {
        for grouping in Grouping::ALL {
            let (network, _, chart) = chart(text, grouping);
            let is_activity = |kind| matches!(kind, OccurrenceKind::Primitive | OccurrenceKind::Activity);
            let wanted: BTreeSet<usize> = (0..network.occurrences.len())
                .filter(|&at| is_activity(network.occurrences[at].kind))
                .collect();
            let shown: Vec<usize> = chart
                .bars
                .iter()
                .filter(|bar| bar.label.is_none())
                .filter_map(|bar| Some(bar.occurrence?.index()))
                .collect();
            assert_eq!(shown.len(), wanted.len(), "{grouping:?}: each once");
            assert_eq!(shown.into_iter().collect::<BTreeSet<_>>(), wanted, "{grouping:?}");
            for row in chart.rows.iter().filter(|row| matches!(row.kind, RowKind::Packed | RowKind::Track)) {
                let bars = &chart.bars[row.bars.clone()];
                for pair in bars.windows(2) {
                    let [[_, end], [start, _]] = [pair[0].scheduled(), pair[1].scheduled()];
                    assert!(end <= start, "{grouping:?}: {} and {}", pair[0].name, pair[1].name);
                }
            }
            // The rows of a lane begin one after the other.
            for pair in chart.rows.windows(2) {
                let [first, second] = [&pair[0], &pair[1]].map(|row| (row.kind, row.lane, row.bars.clone()));
                if first.0 == RowKind::Packed && second.0 == RowKind::Packed && first.1 == second.1 {
                    let start = |bars: std::ops::Range<usize>| chart.bars[bars.start].start[0];
                    assert!(start(first.2) <= start(second.2));
                }
            }
        }
    }
}

#[test]
fn rows_by_activity_go_by_time_below_what_they_are_part_of() {
    let (_, _, chart) = chart(ROVERS, Grouping::Structure);
    let rows: Vec<(u32, &str)> = chart
        .rows
        .iter()
        .filter(|row| row.kind == RowKind::Single)
        .map(|row| (row.depth, row.name.as_str()))
        .collect();
    assert_eq!(
        rows,
        [
            (0, "Convoy(CAMP)"),
            (0, "Survey(Scout)"),
            (1, "Drive(Scout, RIDGE)"),
            (1, "Look(Scout, RIDGE)"),
            (1, "Talk"),
            (0, "Drive(Lab, RIDGE)"),
            (0, "Reach"),
            (0, "Dig"),
            (0, "Clean"),
            (0, "All"),
            (1, "Wait"),
            (1, "Talk"),
        ]
    );
}

/// As many activities in branches, one after the other, so that none fills more than a part of its branch.
fn generated(count: usize) -> String {
    let mut text = String::from(
        "location CAMP (0, 0); location RIDGE (9, 0); resource Radio capacity 9; resource Battery 0..9000 = 900;
         primitive Drive(to)[5,20]; primitive Image(target)[2,6] uses Radio; primitive Charge()[9,30] produces Battery 1;
         scenario S = { ",
    );
    for branch in 0..count.div_ceil(25) {
        let calls = ["Drive(RIDGE)", "Image(CAMP)", "Charge()", "Drive(CAMP)"];
        let own = (branch * 25..count.min(branch * 25 + 25)).map(|at| calls[at % 4]);
        let separator = if branch == 0 { "" } else { ", " };
        let _ = write!(text, "{separator}{{ {} }}", own.collect::<Vec<_>>().join("; delay; "));
    }
    text + " }"
}

fn track(chart: &Chart, width: f64, zoom: f64) -> Track {
    let frame = Rect::new(0.0, 0.0, width, ROW_HEIGHT * chart.rows.len() as f64 + 20.0);
    let visible = Rect::new(150.0, 0.0, width, frame.max.y);
    let scale = (width - 150.0) / chart.end * zoom;
    Track { frame, left: 150.0, right: width, top: 0.0, start: 0.0, scale, visible }
}

fn drawn(chart: &Chart, shown: (&Network, &Plan), track: &Track) -> DisplayList {
    let state = TimelineState {
        now: Some(1.0),
        is_executing: false,
        range: None,
        row: &|_| Standing::default(),
        bar: &|_| Standing::default(),
        links: &[],
        note: None,
    };
    timeline_list(chart, shown, track, 0..chart.rows.len(), &state)
}

/// Returns what a text covers, as far as it is not cut.
fn covered(text: &display::Text) -> Rect {
    let width = text_width_at(&text.text, text.size, &approximate_text_width).min(text.rect.width());
    let middle = text.rect.center().y;
    let [top, bottom] = [middle - text.size / 2.0, middle + text.size / 2.0];
    match text.anchor {
        display::Anchor::End => Rect::new(text.rect.max.x - width, top, text.rect.max.x, bottom),
        _ => Rect::new(text.rect.min.x, top, text.rect.min.x + width, bottom),
    }
}

#[test]
fn no_name_covers_another_and_none_is_small_however_many_there_are() {
    for count in [10, 40, 300, 1_000] {
        let text = generated(count);
        let (network, plan, chart) = chart(&text, Grouping::Vehicle);
        for width in [1_024.0, 1_280.0, 1_920.0] {
            for zoom in [1.0, 20.0] {
                let list = drawn(&chart, (&network, &plan), &track(&chart, width, zoom));
                let texts = list.texts();
                assert!(texts.iter().all(|text| text.size >= 10.0));
                let places: Vec<Rect> = texts.iter().map(covered).collect();
                if let Some(&(one, other)) = overlapping(&places).first() {
                    panic!("{:?} lies over {:?} of {count}", texts[one], texts[other]);
                }
            }
        }
        // Near enough, each bar in view has its name.
        let near = drawn(&chart, (&network, &plan), &track(&chart, 1_280.0, 40.0));
        let names = near.texts().iter().filter(|text| text.text.starts_with("Drive(")).count();
        assert!(names > 0, "{count}");
    }
}

#[test]
fn forty_activities_have_few_rows() {
    let (_, _, chart) = chart(&generated(40), Grouping::Vehicle);
    assert!(chart.rows.len() <= 12, "{}", chart.rows.len());
}

#[test]
fn sites_and_values_have_colors_that_the_legend_explains() {
    let (_, _, chart) = chart(ROVERS, Grouping::Vehicle);
    let names: Vec<(&str, bool)> = chart.legend.iter().map(|it| (it.name.as_str(), it.is_site)).collect();
    assert_eq!(names, [("CAMP", true), ("RIDGE", true), ("NO", false), ("YES", false)], "BASIN is not used");
    let category = |name: &str| {
        let bar = chart.bars.iter().find(|bar| bar.name == name && bar.label.is_none()).expect("a bar");
        bar.category.map(|at| chart.legend[at].name.as_str())
    };
    assert_eq!(category("Drive(Lab, RIDGE)"), Some("RIDGE"));
    assert_eq!(category("Reach"), Some("RIDGE"), "where it must be");
    assert_eq!(category("Convoy(CAMP)"), Some("CAMP"));
    assert_eq!(category("Talk"), None);
    let value =
        chart.bars.iter().find(|bar| bar.kind == BarKind::Value && bar.name == "RIDGE").expect("a value");
    assert_eq!(value.category, Some(1), "a place has one color, wherever it is");
    for width in [60.0, 200.0, 400.0, 900.0] {
        let list = legend_list(&chart, Rect::new(0.0, 0.0, width, 18.0));
        let places: Vec<Rect> = list.texts().iter().map(covered).collect();
        assert!(overlapping(&places).is_empty() && places.iter().all(|it| it.max.x <= width), "{width}");
        let has_all = list.texts().iter().any(|text| text.text == "YES");
        let has_rest = list.texts().iter().any(|text| text.text.starts_with('+'));
        assert!(has_all != has_rest || width < 100.0, "{width}");
    }
}

#[test]
fn what_a_run_has_left_behind_stays_in_its_lane() {
    let network = network_of(ROVERS);
    let mut plan = plan_of(&network);
    let id = (0..network.occurrences.len())
        .map(OccurrenceId::from_index)
        .find(|id| network.occurrences[id.index()].name == "Dig#1")
        .expect("it digs");
    // The plan followed now has it no longer.
    let occurrence = &network.occurrences[id.index()];
    for node in [occurrence.start, occurrence.end] {
        plan.windows[node.index()] = None;
    }
    let past = Past { occurrence: id, times: [16.0, 17.5], is_aborted: true };
    let mut chart = chart_of(ROVERS, &network, &plan, Grouping::Vehicle, &[past]);
    assert!(lanes(&chart)["Lab"].contains("Dig"));
    chart.retime(&plan);
    let bars: Vec<_> = chart.bars.iter().filter(|bar| bar.name == "Dig").collect();
    assert_eq!(bars.len(), 1);
    assert_eq!((bars[0].kind, bars[0].scheduled()), (BarKind::Aborted, [16.0, 17.5]));
    let list = drawn(&chart, (&network, &plan), &track(&chart, 1_900.0, 1.0));
    assert!(
        list.texts().iter().any(|text| text.text.starts_with("Dig · abort")),
        "a word, not a color alone"
    );
}
