//! Every planner on random maps: paths keep their clearance by an independent dense sampler, ends are exact, seeds
//! repeat, and failures say what is known.

use motion::{
    DriveLimits, Failure, Growth, Path, PlannerKind, Query, Root, Search, Settings, ShortcutSettings,
    Statistics, Trajectory, Tree, drive_path, find_path, find_shortest_path, shorten, vehicle_model,
};
use nalgebra::{Point2, Vector2};
use terrain::{Cell, CellState, Collision, ConfigurationSpace, GridFrame, Obstacle, Occupancy, Random};

const PLANNERS: [PlannerKind; 4] =
    [PlannerKind::Rrt, PlannerKind::RrtConnect, PlannerKind::RrtStar, PlannerKind::Kinodynamic];

/// A map with random discs, and the obstacle cells for a check that shares nothing with the space.
fn random_space(seed: u64, radius_m: f64) -> ConfigurationSpace {
    let mut random = Random::from_seed(seed);
    let frame = GridFrame { width: 140, height: 110, cell_size_m: 0.6, origin_m: Point2::new(-20.0, 35.0) };
    let mut occupancy = Occupancy::free(frame);
    let extent = frame.extent_m();
    for _ in 0..24 {
        let part = Vector2::new(random.unit(), random.unit());
        let center_m = frame.origin_m + part.component_mul(&extent);
        occupancy.mark(&Obstacle::Circle { center_m, radius_m: random.range(0.5, 5.0) }, CellState::Obstacle);
    }
    ConfigurationSpace::new(occupancy, radius_m)
}

fn free_point(space: &ConfigurationSpace, random: &mut Random) -> Point2<f64> {
    let [low, high] = space.free_box_m();
    loop {
        let point = Point2::new(random.range(low.x, high.x), random.range(low.y, high.y));
        if space.is_free(point) {
            return point;
        }
    }
}

/// Panics unless every point of a dense sample of the path keeps the radius from every occupied square.
fn assert_clear(space: &ConfigurationSpace, path: &Path, what: &str) {
    let frame = space.frame();
    let occupied: Vec<Point2<f64>> = space
        .occupancy()
        .states()
        .iter()
        .enumerate()
        .filter(|(_, state)| **state != CellState::Free)
        .map(|(index, _)| frame.center_m(frame.cell(index)))
        .collect();
    let half = 0.5 * frame.cell_size_m;
    for (a, b) in path.segments() {
        let length = (b - a).norm();
        let samples = (length / (0.1 * frame.cell_size_m)).ceil() as u32 + 1;
        for sample in 0..=samples {
            let share = f64::from(sample) / f64::from(samples);
            let point = a + (b - a) * share;
            assert!(frame.contains(point), "{what}: {point:?} is off the map");
            for center in &occupied {
                let across = ((point.x - center.x).abs() - half).max(0.0);
                let along = ((point.y - center.y).abs() - half).max(0.0);
                let distance = (across * across + along * along).sqrt();
                assert!(distance >= space.radius_m() - 1e-7, "{what}: {point:?} is {distance} m from a cell");
            }
        }
    }
}

fn assert_tree_is_sound(space: &ConfigurationSpace, tree: &Tree, query: &Query, step_m: f64) {
    let root = if tree.root == Root::Start { query.start_m } else { query.goal_m };
    assert_eq!(tree.vertices[0].point_m, root);
    assert_eq!(tree.vertices[0].parent, None);
    for (index, vertex) in tree.vertices.iter().enumerate().skip(1) {
        let parent = vertex.parent.expect("only the root has no parent");
        let mut points = vec![tree.vertices[parent as usize].point_m];
        match tree.curves.get(index) {
            Some(curve) => points.extend(curve),
            None => points.push(vertex.point_m),
        }
        assert_eq!(points.last(), Some(&vertex.point_m));
        let edge = Path::new(points);
        assert!(edge.length_m() <= step_m * 1.05, "edge {index} is {} m long", edge.length_m());
        assert_clear(space, &edge, "a tree edge");
        assert_eq!(tree.path_to(index as u32).points_m.first(), Some(&root));
    }
}

fn settings(planner: PlannerKind, seed: u64) -> Settings {
    Settings { seed, improving_samples: 400, ..Settings::of(planner) }
}

fn never(_: &Statistics) -> bool {
    false
}

#[test]
fn paths_have_exact_ends_and_keep_their_clearance() {
    for planner in PLANNERS {
        for seed in 0..12 {
            let radius_m = [0.0, 0.6, 1.1][seed as usize % 3];
            let space = random_space(seed, radius_m);
            let mut random = Random::from_seed(seed + 77);
            let query =
                Query { start_m: free_point(&space, &mut random), goal_m: free_point(&space, &mut random) };
            let settings = settings(planner, seed);
            let result = find_path(&space, query, &settings, None, &mut never);
            let what = format!("{planner:?}, seed {seed}");
            let path = match result.path {
                Ok(path) => path,
                Err(Failure::GoalEnclosed) => continue,
                Err(failure) => panic!("{what}: {failure}"),
            };
            assert_eq!(path.points_m.first(), Some(&query.start_m), "{what}");
            assert_eq!(path.points_m.last(), Some(&query.goal_m), "{what}");
            assert_clear(&space, &path, &what);
            let count: usize = result.trees.iter().map(|tree| tree.vertices.len()).sum();
            assert_eq!(result.statistics.vertices as usize, count, "{what}");
            if seed < 3 {
                for tree in &result.trees {
                    assert_tree_is_sound(&space, tree, &query, settings.step_m);
                }
            }
            let short = shorten(&space, &path, &ShortcutSettings::default());
            assert!(short.length_m() <= path.length_m() + 1e-9, "{what}");
            assert_eq!(short.points_m.first(), Some(&query.start_m), "{what}");
            assert_eq!(short.points_m.last(), Some(&query.goal_m), "{what}");
            assert_clear(&space, &short, &format!("{what}, shortened"));
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_path_and_another_seed_another() {
    let space = random_space(4, 0.7);
    let query = Query { start_m: Point2::new(-18.0, 37.0), goal_m: Point2::new(60.0, 98.0) };
    for planner in PLANNERS {
        let run = |seed| {
            let settings = settings(planner, seed);
            find_path(&space, query, &settings, Some(&ShortcutSettings::default()), &mut never)
        };
        assert_eq!(run(5), run(5), "{planner:?}");
        assert_ne!(run(5).trees, run(6).trees, "{planner:?}");
    }
}

#[test]
fn stepping_one_by_one_gives_what_running_gives() {
    let space = random_space(4, 0.7);
    let query = Query { start_m: Point2::new(-18.0, 37.0), goal_m: Point2::new(60.0, 98.0) };
    for planner in PLANNERS {
        let settings = settings(planner, 1);
        let mut search = Search::new(&space, query, settings).unwrap();
        let mut vertices = search.trees().len();
        while !search.is_finished() {
            let event = search.step(&space);
            let now: usize = search.trees().iter().map(|tree| tree.vertices.len()).sum();
            assert_eq!(now > vertices, !matches!(event.growth, Growth::Blocked { .. }), "{planner:?}");
            vertices = now;
        }
        let result = Search::new(&space, query, settings).unwrap().run(&space, &mut never);
        assert_eq!(search.path(), result.path.ok(), "{planner:?}");
        assert_eq!(search.statistics(), result.statistics, "{planner:?}");
    }
}

#[test]
fn an_end_in_collision_is_said() {
    let mut occupancy = Occupancy::free(GridFrame::new(50, 50, 1.0));
    occupancy.mark(&Obstacle::Circle { center_m: Point2::new(25.0, 25.0), radius_m: 3.0 }, CellState::Steep);
    let space = ConfigurationSpace::new(occupancy, 1.0);
    for planner in PLANNERS {
        let fail = |start_m, goal_m| {
            find_path(&space, Query { start_m, goal_m }, &Settings::of(planner), None, &mut never)
                .path
                .unwrap_err()
        };
        let Failure::StartInCollision(Collision::Cell { state, .. }) =
            fail(Point2::new(25.0, 25.0), Point2::new(2.0, 2.0))
        else {
            panic!("the start is not in collision")
        };
        assert_eq!(state, CellState::Steep);
        assert_eq!(
            fail(Point2::new(2.0, 2.0), Point2::new(60.0, 2.0)),
            Failure::GoalInCollision(Collision::OutsideMap),
            "{planner:?}"
        );
        assert!(fail(Point2::new(2.0, 2.0), Point2::new(25.0, 28.7)).to_string().contains("too steep"));
    }
}

/// A map of 512 × 512 cells beside the repository, as bytes of its pixels from the top, or `None` with a message.
#[expect(clippy::print_stderr, reason = "a test that could not look at its data says so")]
fn shared_map(name: &str) -> Option<Vec<u8>> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/maps").join(name);
    let bytes = std::fs::read(&path).ok();
    if bytes.is_none() {
        eprintln!("NOT TESTED: there is no {}", path.display());
    }
    bytes.map(|bytes| bytes[bytes.len() - 512 * 512..].to_vec())
}

#[test]
fn no_sample_of_a_path_on_the_shared_maps_lies_in_an_obstacle_pixel() {
    for name in ["map_1.pgm", "map_2.pgm"] {
        let Some(pixels) = shared_map(name) else { return };
        let occupied: Vec<bool> = pixels.iter().map(|&pixel| pixel == 0).collect();
        let frame = GridFrame::new(512, 512, 1.0);
        let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), 0.0);
        let query = Query { start_m: Point2::new(8.0, 8.0), goal_m: Point2::new(503.0, 503.0) };
        for planner in [PlannerKind::Rrt, PlannerKind::RrtConnect, PlannerKind::RrtStar] {
            for seed in 0..8 {
                let settings = Settings { step_m: 20.0, ..settings(planner, seed) };
                let raw = find_path(&space, query, &settings, None, &mut never).path.unwrap();
                let short = shorten(&space, &raw, &ShortcutSettings::default());
                assert!(short.length_m() < 0.95 * raw.length_m() || raw.length_m() < 760.0);
                for (a, b) in raw.segments().chain(short.segments()) {
                    let samples = (40.0 * (b - a).norm()).ceil();
                    for sample in 0..=samples as u32 {
                        let share = f64::from(sample) / samples;
                        let (x, y) = (a.x + (b.x - a.x) * share, a.y + (b.y - a.y) * share);
                        assert!(
                            pixels[y as usize * 512 + x as usize] > 0,
                            "{name} {planner:?} at ({x}, {y})"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_path_around_the_wrong_end_of_a_wall_is_led_around_the_other() {
    let mut occupied = vec![false; 120 * 120];
    for row in 10..110 {
        occupied[row * 120 + 60] = true;
    }
    let frame = GridFrame::new(120, 120, 0.5);
    let occupancy = Occupancy::from_obstacles(frame, &occupied);
    let (start, goal) = (Point2::new(15.0, 20.0), Point2::new(45.0, 20.0));
    let given = Path::new(vec![start, Point2::new(15.0, 58.0), Point2::new(45.0, 58.0), goal]);
    // The corners of the wall's southern end are at (30, 5) and (30.5, 5).
    let shortest_m = 15.0_f64.hypot(15.0) + 0.5 + 14.5_f64.hypot(15.0);
    for radius_m in [0.0, 0.3] {
        let space = ConfigurationSpace::new(occupancy.clone(), radius_m);
        assert!(given.is_free(&space));
        let short = shorten(&space, &given, &ShortcutSettings::default());
        assert_clear(&space, &short, "shortened");
        let length_m = short.length_m();
        assert!((shortest_m - 1e-9..1.02 * shortest_m).contains(&length_m), "{length_m} of {shortest_m}");
        let settings = ShortcutSettings { blocks: 0, ..ShortcutSettings::default() };
        let same_side = shorten(&space, &given, &settings).length_m();
        assert!(same_side > 1.3 * shortest_m, "{same_side}");
    }
}

#[test]
fn more_tries_never_give_a_longer_path() {
    let space = random_space(4, 0.7);
    let query = Query { start_m: Point2::new(-18.0, 37.0), goal_m: Point2::new(60.0, 98.0) };
    let mut before = f64::INFINITY;
    for tries in 1..6 {
        let settings = settings(PlannerKind::Rrt, 2);
        let result =
            find_shortest_path(&space, query, &settings, &ShortcutSettings::default(), tries, &mut never);
        let length = result.path.unwrap().length_m();
        assert!(length <= before);
        before = length;
    }
}

/// A closed ring around the middle of a map, with a gap of some cells.
fn ring(gap_cells: u32, radius_m: f64) -> ConfigurationSpace {
    let frame = GridFrame::new(80, 80, 0.5);
    let mut occupied = vec![false; frame.cell_count()];
    for step in 20..=60 {
        for (column, row) in [(step, 20), (step, 60), (20, step), (60, step)] {
            occupied[frame.index(Cell { column, row })] = true;
        }
    }
    for column in 40..40 + gap_cells {
        occupied[frame.index(Cell { column, row: 60 })] = false;
    }
    ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), radius_m)
}

#[test]
fn an_enclosed_goal_is_proved_and_a_gap_opens_it() {
    let query = Query { start_m: Point2::new(3.0, 3.0), goal_m: Point2::new(20.0, 20.0) };
    for planner in PLANNERS {
        let settings = Settings { max_samples: 20_000, step_m: 3.0, ..Settings::of(planner) };
        let run = |space: &ConfigurationSpace| find_path(space, query, &settings, None, &mut never);
        let closed = run(&ring(0, 0.3));
        assert_eq!(closed.path, Err(Failure::GoalEnclosed), "{planner:?}");
        assert_eq!(closed.statistics.samples, 0, "proved without a search");
        let open = ring(3, 0.5);
        assert_clear(&open, &run(&open).path.expect("the gap is wide enough"), "through the gap");
        // Two cells are 1 m; a vehicle 1.2 m wide does not pass, which takes the finer proof after a failed search.
        let narrow = Settings { max_samples: 300, ..settings };
        let result = find_path(&ring(2, 0.6), query, &narrow, None, &mut never);
        assert_eq!(result.path, Err(Failure::GoalEnclosed), "{planner:?}");
    }
}

#[test]
fn running_out_of_samples_is_no_proof_and_says_how_many() {
    let query = Query { start_m: Point2::new(3.0, 3.0), goal_m: Point2::new(20.0, 20.0) };
    for planner in PLANNERS {
        let settings = Settings { max_samples: 15, step_m: 1.0, ..Settings::of(planner) };
        let result = find_path(&ring(1, 0.1), query, &settings, None, &mut never);
        assert_eq!(result.path, Err(Failure::NotFound { samples: 15 }), "{planner:?}");
    }
}

#[test]
fn a_caller_can_stop_a_search() {
    let query = Query { start_m: Point2::new(3.0, 3.0), goal_m: Point2::new(20.0, 20.0) };
    for planner in PLANNERS {
        let settings = Settings { step_m: 1.0, ..Settings::of(planner) };
        let mut stop = |statistics: &Statistics| statistics.samples >= 9;
        let result = find_path(&ring(1, 0.2), query, &settings, None, &mut stop);
        assert_eq!(result.path, Err(Failure::Stopped { samples: 9 }), "{planner:?}");
    }
}

#[test]
fn a_path_in_the_open_becomes_a_straight_line() {
    let space = ConfigurationSpace::new(Occupancy::free(GridFrame::new(200, 200, 0.6)), 0.7);
    let query = Query { start_m: Point2::new(10.0, 10.0), goal_m: Point2::new(110.0, 90.0) };
    for planner in [PlannerKind::Rrt, PlannerKind::RrtConnect, PlannerKind::RrtStar] {
        let settings = settings(planner, 1);
        let result = find_path(&space, query, &settings, Some(&ShortcutSettings::default()), &mut never);
        assert_eq!(result.path.unwrap().points_m, [query.start_m, query.goal_m], "{planner:?}");
    }
}

#[test]
fn shortening_comes_near_the_shortest_way_around_a_disc() {
    let mut occupancy = Occupancy::free(GridFrame::new(400, 400, 0.1));
    occupancy
        .mark(&Obstacle::Circle { center_m: Point2::new(20.0, 20.0), radius_m: 6.0 }, CellState::Obstacle);
    let space = ConfigurationSpace::new(occupancy, 0.5);
    // Two tangents and an arc, around the disc grown by the radius, from 15 m left to 15 m right of its center.
    let grown = 6.5_f64;
    let tangent = (15.0_f64 * 15.0 - grown * grown).sqrt();
    let arc = std::f64::consts::PI - 2.0 * (grown / 15.0).acos();
    let shortest = 2.0 * tangent + grown * arc;
    let query = Query { start_m: Point2::new(5.0, 20.0), goal_m: Point2::new(35.0, 20.0) };
    for seed in 0..5 {
        let settings = Settings { seed, ..Settings::of(PlannerKind::RrtConnect) };
        let path =
            find_path(&space, query, &settings, Some(&ShortcutSettings::default()), &mut never).path.unwrap();
        let ratio = path.length_m() / shortest;
        assert!((0.999..1.02).contains(&ratio), "seed {seed}: {ratio} times the shortest");
    }
}

#[test]
fn rrt_star_gets_shorter_with_more_samples_and_its_lengths_are_those_of_its_path() {
    let space = random_space(4, 0.7);
    let query = Query { start_m: Point2::new(-18.0, 37.0), goal_m: Point2::new(60.0, 98.0) };
    let mut search = Search::new(&space, query, Settings::of(PlannerKind::RrtStar)).unwrap();
    let mut found = Vec::new();
    while !search.is_finished() {
        if let Growth::Found { length_m, .. } = search.step(&space).growth {
            let path = search.path().unwrap();
            assert!((path.length_m() - length_m).abs() < 1e-6);
            found.push(length_m);
        }
    }
    assert!(found.len() > 3, "{found:?}");
    assert!(found.windows(2).all(|pair| pair[1] < pair[0]), "{found:?}");
    let straight = (78.0_f64 * 78.0 + 61.0 * 61.0).sqrt();
    assert!(found[found.len() - 1] < 1.08 * straight, "{found:?}");
}

#[test]
fn a_motion_stays_within_the_limits_of_its_vehicle_and_rests_at_both_ends() {
    for (name, seed) in [("ATRV", 2), ("ATRV-Jr", 3), ("ATRV", 5)] {
        let space = random_space(seed, 0.8);
        let mut random = Random::from_seed(seed);
        let query =
            Query { start_m: free_point(&space, &mut random), goal_m: free_point(&space, &mut random) };
        let limits = DriveLimits::of(vehicle_model(name).unwrap());
        let settings = Settings { limits, ..settings(PlannerKind::Kinodynamic, seed) };
        let result = find_path(&space, query, &settings, None, &mut never);
        let trajectory = result.trajectory.unwrap();
        assert_eq!(trajectory.path(), result.path.unwrap());
        assert_within_limits(&trajectory, &limits);
        let (first, last) = (trajectory.states[0].state, trajectory.states.last().unwrap().state);
        assert_eq!((first.position_m, first.speed_mps), (query.start_m, 0.0));
        assert_eq!((last.position_m, last.speed_mps, last.turn_rate_rps), (query.goal_m, 0.0, 0.0));
    }
}

/// Checks every step of a trajectory by differences, independently of how it was made.
fn assert_within_limits(trajectory: &Trajectory, limits: &DriveLimits) {
    let slack = 1e-9;
    for pair in trajectory.states.windows(2) {
        let (before, after) = (pair[0].state, pair[1].state);
        let seconds = pair[1].time_s - pair[0].time_s;
        assert!(seconds > 0.0 && seconds <= Trajectory::STEP_S + slack);
        assert!((after.speed_mps - before.speed_mps).abs() <= limits.acceleration_mps2 * seconds + slack);
        let turn = (after.turn_rate_rps - before.turn_rate_rps).abs();
        assert!(turn <= limits.turn_acceleration_rps2 * seconds + slack);
        assert!(after.turn_rate_rps.abs() <= limits.turn_rate_rps + slack);
        let wheels = after.speed_mps.abs() + after.turn_rate_rps.abs() * limits.half_track_m;
        assert!(wheels <= limits.speed_mps + slack, "a wheel runs at {wheels} m/s");
        let moved = after.position_m - before.position_m;
        let way = moved.norm();
        assert!(way <= before.speed_mps.max(after.speed_mps) * seconds + 1e-3, "{way} m in {seconds} s");
        assert!((after.heading_rad - before.heading_rad).abs() <= limits.turn_rate_rps * seconds + slack);
        // It moves where it looks, never sideways.
        let middle = 0.5 * (before.heading_rad + after.heading_rad);
        let sideways = moved.y * middle.cos() - moved.x * middle.sin();
        assert!(sideways.abs() < 1e-6, "{sideways} m sideways");
    }
}

#[test]
fn driving_a_path_passes_its_corners_within_the_limits() {
    let limits = DriveLimits::of(vehicle_model("ATRV-Jr").unwrap());
    let path = Path::new([[0.0, 0.0], [10.0, 0.0], [10.0, 0.2], [-3.0, 7.0]].map(Point2::from).to_vec());
    let trajectory = drive_path(&path, 2.0, &limits);
    assert_within_limits(&trajectory, &limits);
    for &corner in &path.points_m {
        assert!(trajectory.states.iter().any(|timed| timed.state.position_m == corner), "{corner:?}");
    }
    // 10 m at 1 m/s with ramps of 0.6 m/s²: 10 s and 1 / 0.6 s for the ramps.
    let arrival =
        trajectory.states.iter().find(|timed| timed.state.position_m == Point2::new(10.0, 0.0)).unwrap();
    let departure =
        trajectory.states.iter().rfind(|timed| timed.state.position_m == Point2::new(0.0, 0.0)).unwrap();
    assert!((arrival.time_s - departure.time_s - 10.0 - 1.0 / 0.6).abs() < 1e-6);
    assert_eq!(trajectory.state_at(-1.0).unwrap().position_m, Point2::new(0.0, 0.0));
    assert_eq!(trajectory.state_at(1e9).unwrap().position_m, Point2::new(-3.0, 7.0));
}
