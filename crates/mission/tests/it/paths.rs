//! Paths of missions: clear of obstacles by a sampler of its own, timed by length and slope, within bounds or given up,
//! and searched for only when something they depend on changes.

use std::sync::Arc;

use exact::{Bound, Time};
use mission::planning::{self, Planned, Problem};
use mission::{Grounds, Paths};
use nalgebra::{Point2, distance};
use rmpl::program::{Program, World};
use snapshot::Goal;
use terrain::{CellState, Occupancy, Terrain};
use tpn::ArcKind;

const ENROUTE: &str = include_str!("../../../../assets/missions/enroute.rmpl");
const BOTH_PATHS: &str = include_str!("../../../../assets/missions/both-paths.rmpl");
const DETOUR: &str = include_str!("../../../../assets/missions/detour.rmpl");

/// What is kept from one planning to the next.
#[derive(Default)]
struct Planner {
    grounds: Grounds,
    paths: Paths,
}

/// A mission as it was planned.
struct Answer {
    program: Program,
    map: Option<Arc<Terrain>>,
    planned: Planned,
}

impl Planner {
    fn plan(&mut self, source: &str, seed: u64) -> Answer {
        let parse = rmpl::parse(source);
        let program = parse.program();
        let mut diagnostics = parse.diagnostics();
        let network = mission::compile(&program, &Goal::Default, &mut diagnostics);
        let network = Arc::new(network.unwrap_or_else(|| panic!("{diagnostics:?}")));
        let (ground, found) = self.grounds.resolve(&program);
        assert!(found.is_empty(), "{found:?}");
        let problem = Problem {
            ground: ground.as_ref().map(|(key, map)| (key, map)),
            seed,
            ..Problem::new(&network, &program)
        };
        let planned = planning::plan(&problem, &mut self.grounds, &mut self.paths, &mut || false);
        Answer { map: ground.map(|(_, map)| map), planned, program }
    }
}

fn plan(source: &str, seed: u64) -> Answer {
    Planner::default().plan(source, seed)
}

impl Answer {
    fn alternative(&self) -> Option<u32> {
        let plan = self.planned.planning.outcome.plans.first()?;
        Some(plan.choices.first()?.alternative)
    }

    /// Occupied squares of the map for a vehicle of this model, as centers, with half their side.
    fn occupied(&self, model: &str) -> (Vec<Point2<f64>>, f64) {
        let map = self.map.as_ref().expect("there is ground");
        let model = motion::vehicle_model(model).expect("it is known");
        let shapes: Vec<_> =
            self.program.world.obstacles.iter().map(|it| snapshot::ground::obstacle(&it.shape)).collect();
        let occupancy = Occupancy::of_terrain(map, &shapes, &model.traversability(map));
        let frame = *occupancy.frame();
        let states = occupancy.states().iter().enumerate();
        let centers = states
            .filter(|(_, state)| **state != CellState::Free)
            .map(|(index, _)| frame.center_m(frame.cell(index)))
            .collect();
        (centers, 0.5 * frame.cell_size_m)
    }
}

/// The distance from a point to the nearest of some squares.
fn to_nearest(point: Point2<f64>, squares: &[Point2<f64>], half: f64) -> f64 {
    let to_square = |center: &Point2<f64>| {
        let across = ((point[0] - center[0]).abs() - half).max(0.0);
        let along = ((point[1] - center[1]).abs() - half).max(0.0);
        across * across + along * along
    };
    squares.iter().map(to_square).fold(f64::INFINITY, f64::min).sqrt()
}

/// Returns whether two segments cross inside both.
fn cross(a: [Point2<f64>; 2], b: [Point2<f64>; 2]) -> bool {
    let side = |from: Point2<f64>, to: Point2<f64>, point: Point2<f64>| {
        (to[0] - from[0]) * (point[1] - from[1]) - (to[1] - from[1]) * (point[0] - from[0])
    };
    side(a[0], a[1], b[0]) * side(a[0], a[1], b[1]) < 0.0
        && side(b[0], b[1], a[0]) * side(b[0], b[1], a[1]) < 0.0
}

#[test]
fn every_leg_keeps_radius_and_margin_from_every_obstacle_and_never_crosses_itself() {
    for (name, source) in [("enroute", ENROUTE), ("both-paths", BOTH_PATHS), ("detour", DETOUR)] {
        for seed in [1, 2, 3] {
            let answer = plan(source, seed);
            let (squares, half) = answer.occupied("ATRV");
            let model = motion::vehicle_model("ATRV").expect("it is known");
            assert!(!answer.planned.traverses.is_empty());
            for leg in answer.planned.traverses.iter().flat_map(|traverse| &traverse.legs) {
                let what = format!("{name}, seed {seed}, the leg to {}", leg.to);
                let location = answer
                    .program
                    .world
                    .locations
                    .iter()
                    .find(|it| it.name.text == leg.to)
                    .expect("declared");
                assert_eq!(leg.points_m.last(), Some(&location.position_m.into()), "{what}");
                let segments: Vec<[Point2<f64>; 2]> =
                    leg.points_m.windows(2).map(|it| [it[0], it[1]]).collect();
                for (index, segment) in segments.iter().enumerate() {
                    for other in &segments[index + 1..] {
                        assert!(
                            !cross(*segment, *other),
                            "{what} crosses itself at {segment:?} and {other:?}"
                        );
                    }
                    let pieces = (distance(&segment[0], &segment[1]) / 0.15).ceil();
                    let near: Vec<Point2<f64>> = squares
                        .iter()
                        .copied()
                        .filter(|&center| {
                            distance(&center, &segment[0]) + distance(&center, &segment[1])
                                < distance(&segment[0], &segment[1]) + 8.0
                        })
                        .collect();
                    for piece in 0..=pieces as u32 {
                        let part = f64::from(piece) / pieces.max(1.0);
                        let point = segment[0] + (segment[1] - segment[0]) * part;
                        let free = to_nearest(point, &near, half);
                        assert!(free >= model.radius_m() - 1e-6, "{what}: {free} m at {point:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn paths_keep_away_from_obstacles_where_that_costs_little() {
    let answer = plan(ENROUTE, 0);
    let clearances: Vec<f64> =
        answer.planned.traverses[0].leg_figures.iter().map(|it| it.min_clearance_m).collect();
    assert!(clearances.iter().all(|&clearance| clearance >= 0.3), "{clearances:?}");
}

#[test]
fn vertices_of_the_network_are_those_of_the_path_and_their_times_follow_from_length_and_speed() {
    let answer = plan(ENROUTE, 1);
    let traverse = &answer.planned.traverses[0];
    let network = &answer.planned.network;
    let arcs: Vec<_> = network.arcs.iter().filter(|arc| arc.kind == ArcKind::Path).collect();
    let segments: Vec<[Point2<f64>; 2]> =
        traverse.legs.iter().flat_map(|leg| leg.points_m.windows(2).map(|it| [it[0], it[1]])).collect();
    assert_eq!(arcs.len(), segments.len());
    let map = answer.map.as_ref().expect("there is ground");
    for (arc, segment) in arcs.iter().zip(&segments) {
        let length_m = map.draped_length_m(segment[0], segment[1]);
        // Speeds of 0.005 to 0.025 m/s, in minutes, rounded up to the millisecond.
        let minutes = |bound: Time| bound.to_f64();
        let (least, greatest) = (length_m / 0.025 / 60.0, length_m / 0.005 / 60.0);
        let over = minutes(arc.lower) - least;
        assert!((-1e-9..1.0 / 60_000.0 + 1e-9).contains(&over), "{over} over {least}");
        let Bound::Finite(upper) = arc.upper else { panic!("it may not stop") };
        let over = minutes(upper) - greatest;
        assert!((-1e-9..1.0 / 60_000.0 + 1e-9).contains(&over), "{over} over {greatest}");
    }
    let sum = Time::checked_sum(arcs.iter().map(|arc| arc.lower));
    let figures = traverse.leg_figures.iter().map(|figures| figures.min_duration);
    assert_eq!(sum, Time::checked_sum(figures));
    assert!(sum.is_some());
}

/// A ramp of the given rise per metre toward the east, 60 m wide, as an ESRI ASCII grid.
fn ramp(grade: f64) -> Vec<u8> {
    let mut text =
        String::from("ncols 60\nnrows 60\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n");
    for _ in 0..60 {
        let row: Vec<String> = (0..60).map(|column| format!("{:.3}", grade * f64::from(column))).collect();
        text.push_str(&row.join(" "));
        text.push('\n');
    }
    text.into_bytes()
}

#[test]
fn a_slope_makes_a_traverse_take_longer_and_a_steep_one_cannot_be_driven() {
    let source = "option time_unit = second;
        terrain \"ramp\" cell 1 origin (0, 0);
        location LOW (10, 30);
        location HIGH (50, 30);
        vehicle Rover : ATRV at LOW;
        primitive Climb(to) moves Rover speed (0, 0.8);
        scenario S[0,inf] = { Climb(HIGH)[0,inf] }";
    let climb = |grade: f64| {
        let mut planner = Planner::default();
        planner.grounds.import("ramp", &ramp(grade)).expect("it can be read");
        planner.plan(source, 1)
    };
    let least = |grade: f64| climb(grade).planned.traverses[0].leg_figures[0].min_duration;
    assert_eq!(least(0.0), Time::from(50));
    // 40 m up a grade of 0.182, half of the greatest: a little longer, and at 0.6 m/s instead of 0.8.
    let time = least(0.182);
    let expected = 40.0 * (1.0 + 0.182_f64 * 0.182).sqrt() / 0.6;
    let time = time.to_f64();
    assert!((time - expected).abs() < 0.1, "{time} instead of {expected}");
    let steep = climb(0.6).planned;
    assert!(steep.planning.outcome.plans.is_empty());
    let failure = steep.planning.outcome.failure.as_ref().expect("it is explained");
    assert!(failure.reasons[0].message.contains("Climb#1 can't be driven"), "{}", failure.reasons[0].message);
}

/// Two ways to one place, with bounds for each.
fn two_ways(first: &str, second: &str) -> String {
    format!(
        "location BASE (0, 0);
        location NEAR (30, 0);
        location FAR (30, 40);
        location SITE (60, 0);
        vehicle Rover : ATRV at BASE;
        primitive Drive(by, to) moves Rover speed (0.05, 0.1);
        scenario S[0,inf] = {{ choose {{ Drive(NEAR, SITE){first}, Drive(FAR, SITE){second} }} }}"
    )
}

#[test]
fn an_alternative_whose_path_does_not_fit_its_bounds_is_given_up_and_the_search_goes_on() {
    // 60 m at 0.1 m/s are 10 minutes, 100 m are 16.7.
    assert_eq!(plan(&two_ways("[0,11]", "[0,30]"), 1).alternative(), Some(0));
    for too_narrow in ["[0,9]", "[21,25]"] {
        let answer = plan(&two_ways(too_narrow, "[0,30]"), 1);
        assert_eq!(answer.alternative(), Some(1), "{too_narrow}");
        let undrivable = &answer.planned.planning.undrivable;
        assert_eq!(undrivable.len(), 1, "{too_narrow}");
        assert!(undrivable[0].reason.contains("its path of 60 m takes at"), "{}", undrivable[0].reason);
    }
    let none = plan(&two_ways("[0,9]", "[0,16]"), 1);
    let failure = none.planned.planning.outcome.failure.as_ref().expect("there is no plan");
    let messages: Vec<&str> = failure.reasons.iter().map(|reason| reason.message.as_str()).collect();
    assert_eq!(messages.len(), 2, "{messages:?}");
    assert!(
        messages.iter().all(|message| message.contains("can't be driven within its bounds")),
        "{messages:?}"
    );
}

/// The vehicle stands where its own last traverse ended, not where the clause's other vehicles do.
#[test]
fn a_vehicle_that_is_handed_over_is_the_one_that_moves() {
    let source = "const SHARE = 2; location BASE (0, 0); location SITE (60, 0); location HILL (0, 40);
        vehicle R1 : ATRV at BASE; vehicle R2 : ATRV at SITE;
        primitive Drive(rover, to)[0, SHARE * 1h] moves rover speed (0.05, 0.1);
        Visit(v, to) = { Drive(v, to) }
        scenario S[0,inf] = { Visit(R2, BASE); Visit(R1, HILL); Drive(R2, HILL) }";
    let answer = plan(source, 1);
    let found: Vec<(Vec<u32>, f64)> = (answer.planned.traverses.iter())
        .map(|traverse| (traverse.vehicles.clone(), traverse.length_m.round()))
        .collect();
    assert_eq!(found, [(vec![1], 60.0), (vec![0], 40.0), (vec![1], 40.0)]);
    let unknown = source.replace("Visit(R1, HILL)", "Visit(R3, HILL)");
    let parse = rmpl::parse(&unknown);
    let network =
        mission::compile(&parse.program(), &Goal::Default, &mut Vec::new()).expect("it is a network");
    let warnings = mission::traverse::check(&network, &parse.program());
    assert_eq!(warnings.len(), 1);
    assert_eq!(warnings[0].message, "unknown vehicle `R3`");
}

#[test]
fn a_leg_is_searched_for_again_only_when_its_inputs_change() {
    let mut planner = Planner::default();
    let mut searches = |source: &str, seed: u64| {
        let before = planner.paths.searches();
        planner.plan(source, seed);
        planner.paths.searches() - before
    };
    assert_eq!(searches(ENROUTE, 1), 4, "one for each leg");
    assert_eq!(searches(ENROUTE, 1), 0);
    assert_eq!(
        searches(&ENROUTE.replace("[500,800]", "[500,790]"), 1),
        0,
        "bounds are none of a path's inputs"
    );
    assert_eq!(
        searches(&ENROUTE.replace("PATH1_2 (64, 214)", "PATH1_2 (66, 214)"), 1),
        2,
        "the legs at the place"
    );
    assert_eq!(
        searches(&ENROUTE.replace("(170, 66, 12)", "(170, 66, 10)"), 1),
        4,
        "obstacles are inputs of all"
    );
    assert_eq!(searches(ENROUTE, 2), 4, "and so is the seed");
    assert_eq!(searches(ENROUTE, 1), 0, "what was known before still is");
}

#[test]
fn the_boulder_dragged_into_the_gap_makes_the_plan_take_the_long_way() {
    let mut planner = Planner::default();
    let free = planner.plan(DETOUR, 1);
    assert_eq!(free.alternative(), Some(0));
    assert!(free.planned.planning.undrivable.is_empty());
    let moved = DETOUR.replace("circle (166, 86, 4)", "circle (200, 68, 4)");
    assert_ne!(moved, DETOUR);
    let blocked = planner.plan(&moved, 1);
    assert_eq!(blocked.alternative(), Some(1));
    assert!(blocked.planned.planning.undrivable[0].reason.contains("GAP"));
    assert!(blocked.planned.planning.verdict.as_ref().is_some_and(|verdict| verdict.valid));
    // Beside the waypoint, where the rover could still stand on it, the gap is closed all the same.
    let beside = planner.plan(&DETOUR.replace("circle (166, 86, 4)", "circle (205, 68, 4)"), 1);
    assert_eq!(beside.alternative(), Some(1));
    assert_eq!(planner.plan(DETOUR, 1).alternative(), Some(0));
}

#[test]
fn vehicles_of_one_traverse_never_touch_each_other_or_an_obstacle() {
    for source in [ENROUTE, BOTH_PATHS] {
        let answer = plan(source, 1);
        let motions = &answer.planned.motions;
        assert_eq!(motions.len(), 2);
        let (squares, half) = answer.occupied("ATRV");
        let [atrv, jr] =
            ["ATRV", "ATRV-Jr"].map(|name| motion::vehicle_model(name).expect("known").circumradius_m);
        let (from, to) = (0.0, 500.0);
        let mut least = f64::INFINITY;
        for step in 0..=8000 {
            let time = from + (to - from) * f64::from(step) / 8000.0;
            let [leader, follower] = [0, 1].map(|index: usize| motions[index].at(time).expect("it moves").0);
            let apart = distance(&leader, &follower);
            assert!(apart >= atrv + jr, "{apart} m apart at {time}");
            assert!(apart <= 12.0, "{apart} m apart at {time}");
            least = least.min(apart);
            if step % 8 == 0 {
                let free = to_nearest(follower, &squares, half);
                assert!(free >= jr, "the follower is {free} m from an obstacle at {follower:?}");
            }
        }
        assert!(least < 5.0, "they keep formation: {least}");
    }
}

const CROSSING: &str = "option time_unit = second;
    location WEST (0, 0);
    location EAST (60, 0);
    location SOUTH (30, -30);
    location NORTH (30, 30);
    vehicle Rover1 : ATRV at WEST;
    vehicle Rover2 : ATRV-Jr at SOUTH;
    primitive Drive1(to) moves Rover1 speed (0.1, 0.5);
    primitive Drive2(to) moves Rover2 speed (0.1, 0.5);
    scenario S[0,inf] = { Drive1(EAST)[120,120], Drive2(NORTH)[120,120] }";

#[test]
fn concurrent_traverses_that_cross_are_reported_with_time_and_place() {
    let answer = plan(CROSSING, 1);
    let [violation] = answer.planned.separation_violations.as_slice() else {
        panic!("{:?}", answer.planned.separation_violations);
    };
    assert_eq!(violation.vehicles, [0, 1]);
    assert!((violation.time - 60.0).abs() < 0.1, "{violation:?}");
    assert!(distance(&violation.position_m, &Point2::new(30.0, 0.0)) < 0.1, "{violation:?}");
    // Safety radius 0.661 + 0.515 + 1 m, approached at 0.5·√2 m/s.
    assert!((violation.since - (60.0 - 2.176 / (0.5 * 2.0_f64.sqrt()))).abs() < 0.1, "{violation:?}");
    let warning =
        answer.planned.warnings.iter().find(|it| it.code.0 == "W-ENCOUNTER").expect("the author is told");
    assert!(
        warning.message.contains("Rover1 and Rover2") && warning.message.contains("(30, 0)"),
        "{}",
        warning.message
    );
    let one_after_the_other = CROSSING.replace("Drive1(EAST)[120,120], ", "Drive1(EAST)[120,120]; ");
    assert!(plan(&one_after_the_other, 1).planned.separation_violations.is_empty());
}

#[test]
fn a_rover_that_drives_past_a_parked_one_too_near_is_reported() {
    let parked = CROSSING.replace("location NORTH (30, 30)", "location NORTH (30, 1)");
    let later = parked.replace(
        "Drive1(EAST)[120,120], Drive2(NORTH)[120,120]",
        "Drive2(NORTH)[60,70]; Drive1(EAST)[120,120]",
    );
    let answer = plan(&later, 1);
    assert_eq!(answer.planned.separation_violations.len(), 1);
    assert!((answer.planned.separation_violations[0].distance_m - 1.0).abs() < 0.01);
}

#[test]
fn a_follower_wider_than_its_leader_decides_where_the_path_leads() {
    let source = ENROUTE.replace("moves Rover1, Rover2", "moves Rover2, Rover1");
    let answer = plan(&source, 1);
    let widest = motion::vehicle_model("ATRV").expect("known").radius_m();
    let (squares, half) = answer.occupied("ATRV");
    for point in answer.planned.traverses[0].legs.iter().flat_map(|leg| &leg.points_m) {
        assert!(to_nearest(*point, &squares, half) >= widest - 1e-6);
    }
}

#[test]
fn the_clearance_is_negative_exactly_where_the_vehicle_cannot_be() {
    let answer = plan(ENROUTE, 1);
    let world: &World = &answer.program.world;
    let map = answer.map.as_ref().expect("there is ground");
    let model = motion::vehicle_model("ATRV").expect("known");
    let obstacles: Vec<_> = world.obstacles.iter().map(|it| snapshot::ground::obstacle(&it.shape)).collect();
    let space = model.configuration_space(map, &obstacles);
    let (frame, clearances_m) = (space.frame(), space.clearance_map_m());
    let (squares, half) = answer.occupied("ATRV");
    assert_eq!(clearances_m.len(), frame.cell_count());
    for index in (0..clearances_m.len()).step_by(1999) {
        let center = frame.center_m(frame.cell(index));
        let free = to_nearest(center, &squares, half) - model.radius_m();
        let clearance = f64::from(clearances_m[index]);
        assert!((free - clearance).abs() < 0.01 || (free < 0.0 && clearance < 0.0), "{free} {clearance}");
    }
}

/// A file of the data that is beside the repository, or `None` with a message.
#[expect(clippy::print_stderr, reason = "a test that could not look at its data says so")]
fn shared(name: &str) -> Option<Vec<u8>> {
    let path =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/terrain").join(name);
    let bytes = std::fs::read(&path).ok();
    if bytes.is_none() {
        eprintln!("NOT TESTED: there is no {}", path.display());
    }
    bytes
}

#[test]
fn a_mission_on_an_imported_map_of_phobos_keeps_to_ground_that_can_be_driven() {
    let Some(bytes) = shared("Phobos_ME_HRSC_DEM_Global_2ppd.tiff") else { return };
    let mut planner = Planner::default();
    planner.grounds.import("phobos", &bytes).expect("it can be read");
    // Two places kilometers apart; much of Phobos between them is too steep.
    let source = "terrain \"phobos\" cell 100 origin (0, 0);
        location LANDING (31050, 15050);
        location MONOLITH (36050, 19050);
        vehicle Rover : ATRV at LANDING;
        primitive Drive(to) moves Rover speed (0, 0.8);
        scenario S[0,inf] = { Drive(MONOLITH)[0,inf] }";
    let model = motion::vehicle_model("ATRV").expect("known");
    let map = {
        let program = rmpl::parse(source).program();
        let (ground, found) = planner.grounds.resolve(&program);
        assert!(found.is_empty(), "{found:?}");
        ground.expect("it was imported").1
    };
    let space = model.configuration_space(&map, &[]);
    // The free places nearest to those of the text.
    let near = |wanted: Point2<f64>| {
        let frame = *space.frame();
        (0..frame.cell_count())
            .map(|index| frame.center_m(frame.cell(index)))
            .filter(|&center| {
                space.is_free(center) && !space.are_separated(center, Point2::new(33_050.0, 17_050.0))
            })
            .min_by(|a, b| distance(a, &wanted).total_cmp(&distance(b, &wanted)))
    };
    let (Some(from), Some(to)) =
        (near(Point2::new(31_050.0, 15_050.0)), near(Point2::new(36_050.0, 19_050.0)))
    else {
        panic!("nothing of Phobos can be driven");
    };
    let source = source
        .replace("(31050, 15050)", &format!("({}, {})", from[0], from[1]))
        .replace("(36050, 19050)", &format!("({}, {})", to[0], to[1]));
    let answer = planner.plan(&source, 1);
    let failure = answer.planned.planning.outcome.failure.as_ref().map(|failure| failure.reasons.first());
    assert_eq!(answer.planned.traverses.len(), 1, "{failure:?}");
    let leg = &answer.planned.traverses[0].legs[0];
    let (squares, half) = answer.occupied("ATRV");
    assert!(!squares.is_empty(), "some of it is steep");
    for pair in leg.points_m.windows(2) {
        let pieces = (distance(&pair[0], &pair[1]) / 25.0).ceil().max(1.0) as u32;
        for piece in 0..=pieces {
            let part = f64::from(piece) / f64::from(pieces);
            let point = pair[0] + (pair[1] - pair[0]) * part;
            assert!(to_nearest(point, &squares, half) >= model.radius_m() - 1e-6, "{point:?}");
        }
    }
    assert!(answer.planned.traverses[0].leg_figures[0].length_m >= distance(&from, &to));
}

/// Two rovers and a blimp on a plain. The direct way to the site leads through an area.
fn beside_an_area(closed_to: &str) -> String {
    format!(
        "location A (0, 0); location B (0, 20); location C (0, 40); location SITE (100, 20);
         location NEAR (100, 0); location FAR (100, 40);
         vehicle R1 : ATRV at A; vehicle R2 : ATRV-Jr at B; vehicle Flyer : Blimp at C;
         keepout Area polygon (40, -30, 60, -30, 60, 70, 40, 70){closed_to};
         primitive Drive(r, to)[0,100] moves r speed (0.1, 0.5);
         primitive Haul(to)[0,100] moves R2 speed (0.1, 0.5);
         primitive Fly(to)[0,100] moves Flyer speed (0.1, 0.5);
         scenario S[0,300] = {{ Drive(R1, NEAR), {{ Drive(R2, SITE); Haul(B) }}, Fly(FAR) }}"
    )
}

/// Returns whether a point is in that area, or nearer to it than `radius_m`.
fn is_in_the_area(point: Point2<f64>, radius_m: f64) -> bool {
    (40.0 - radius_m..60.0 + radius_m).contains(&point.x)
        && (-30.0 - radius_m..70.0 + radius_m).contains(&point.y)
}

#[test]
fn keep_out_areas_are_closed_to_the_vehicles_models_and_activities_that_they_name() {
    for (closed_to, expected) in [
        ("", ["Drive#1", "Drive#2", "Haul#1", "Fly#1"].as_slice()),
        (" for R1", &["Drive#1"]),
        (" for ATRV-Jr, Flyer", &["Drive#2", "Haul#1", "Fly#1"]),
        (" for Blimp", &["Fly#1"]),
        (" for Haul", &["Haul#1"]),
        (" for Drive", &["Drive#1", "Drive#2"]),
    ] {
        let answer = plan(&beside_an_area(closed_to), 1);
        let mut stays_out = Vec::new();
        for traverse in &answer.planned.traverses {
            let occurrence = &answer.planned.network.occurrences[traverse.occurrence.index()];
            let enters = traverse.legs.iter().any(|leg| {
                let mut pairs = leg.points_m.windows(2);
                pairs.any(|pair| {
                    (0..=50).any(|at| is_in_the_area(pair[0].lerp(&pair[1], f64::from(at) / 50.0), 0.5))
                })
            });
            if !enters {
                stays_out.push(occurrence.name.as_str());
            }
        }
        stays_out.sort_unstable();
        let mut expected = expected.to_vec();
        expected.sort_unstable();
        assert_eq!(stays_out, expected, "closed to{closed_to}");
    }
}
