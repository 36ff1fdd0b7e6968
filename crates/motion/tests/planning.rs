//! Every planner on random maps: paths keep their clearance by an independent dense sampler, ends are exact, seeds
//! repeat, and failures say what is known.

use motion::{
    Failure, Growth, Path, PlannerKind, Query, Root, Search, Settings, ShortcutSettings, Statistics, Tree,
    find_path, plan_legs, shorten,
};
use terrain::{Cell, CellState, Collision, ConfigurationSpace, GridFrame, Obstacle, Occupancy, Random};

const PLANNERS: [PlannerKind; 2] = [PlannerKind::Rrt, PlannerKind::RrtConnect];

/// A map with random discs, and the obstacle cells for a check that shares nothing with the space.
fn random_space(seed: u64, radius_m: f64) -> ConfigurationSpace {
    let mut random = Random::from_seed(seed);
    let frame = GridFrame { width: 140, height: 110, cell_size_m: 0.6, origin_m: [-20.0, 35.0] };
    let mut occupancy = Occupancy::free(frame);
    let [east, north] = frame.extent_m();
    for _ in 0..24 {
        let center_m = [frame.origin_m[0] + random.unit() * east, frame.origin_m[1] + random.unit() * north];
        occupancy.mark(&Obstacle::Circle { center_m, radius_m: random.range(0.5, 5.0) }, CellState::Obstacle);
    }
    ConfigurationSpace::new(occupancy, radius_m)
}

fn free_point(space: &ConfigurationSpace, random: &mut Random) -> [f64; 2] {
    let [low, high] = space.free_box_m();
    loop {
        let point = [random.range(low[0], high[0]), random.range(low[1], high[1])];
        if space.is_free(point) {
            return point;
        }
    }
}

/// Panics unless every point of a dense sample of the path keeps the radius from every occupied square.
fn assert_clear(space: &ConfigurationSpace, path: &Path, what: &str) {
    let frame = space.frame();
    let occupied: Vec<[f64; 2]> = space
        .occupancy()
        .states()
        .iter()
        .enumerate()
        .filter(|(_, state)| **state != CellState::Free)
        .map(|(index, _)| frame.center_m(frame.cell(index)))
        .collect();
    let half = 0.5 * frame.cell_size_m;
    for (a, b) in path.segments() {
        let length = ((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1])).sqrt();
        let samples = (length / (0.1 * frame.cell_size_m)).ceil() as u32 + 1;
        for sample in 0..=samples {
            let share = f64::from(sample) / f64::from(samples);
            let point = [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share];
            assert!(frame.contains(point), "{what}: {point:?} is off the map");
            for center in &occupied {
                let across = ((point[0] - center[0]).abs() - half).max(0.0);
                let along = ((point[1] - center[1]).abs() - half).max(0.0);
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
        let from = tree.vertices[parent as usize].point_m;
        let length = (from[0] - vertex.point_m[0]).hypot(from[1] - vertex.point_m[1]);
        assert!(length <= step_m + 1e-9, "edge {index} is {length} m long");
        assert_clear(space, &Path::new(vec![from, vertex.point_m]), "a tree edge");
        assert_eq!(tree.path_to(index as u32).points_m.first(), Some(&root));
    }
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
            let settings = Settings { seed, ..Settings::of(planner) };
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
    let query = Query { start_m: [-18.0, 37.0], goal_m: [60.0, 98.0] };
    for planner in PLANNERS {
        let run = |seed| {
            let settings = Settings { seed, ..Settings::of(planner) };
            find_path(&space, query, &settings, Some(&ShortcutSettings::default()), &mut never)
        };
        assert_eq!(run(5), run(5), "{planner:?}");
        assert_ne!(run(5).trees, run(6).trees, "{planner:?}");
    }
}

#[test]
fn stepping_one_by_one_gives_what_running_gives() {
    let space = random_space(4, 0.7);
    let query = Query { start_m: [-18.0, 37.0], goal_m: [60.0, 98.0] };
    for planner in PLANNERS {
        let settings = Settings::of(planner);
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
    occupancy.mark(&Obstacle::Circle { center_m: [25.0, 25.0], radius_m: 3.0 }, CellState::Steep);
    let space = ConfigurationSpace::new(occupancy, 1.0);
    for planner in PLANNERS {
        let fail = |start_m, goal_m| {
            find_path(&space, Query { start_m, goal_m }, &Settings::of(planner), None, &mut never)
                .path
                .unwrap_err()
        };
        let Failure::StartInCollision(Collision::Cell { state, .. }) = fail([25.0, 25.0], [2.0, 2.0]) else {
            panic!("the start is not in collision")
        };
        assert_eq!(state, CellState::Steep);
        assert_eq!(
            fail([2.0, 2.0], [60.0, 2.0]),
            Failure::GoalInCollision(Collision::OutsideMap),
            "{planner:?}"
        );
        assert!(fail([2.0, 2.0], [25.0, 28.7]).to_string().contains("too steep"));
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
    let query = Query { start_m: [3.0, 3.0], goal_m: [20.0, 20.0] };
    for planner in PLANNERS {
        let settings = Settings { greatest_samples: 20_000, step_m: 3.0, ..Settings::of(planner) };
        let run = |space: &ConfigurationSpace| find_path(space, query, &settings, None, &mut never);
        let closed = run(&ring(0, 0.3));
        assert_eq!(closed.path, Err(Failure::GoalEnclosed), "{planner:?}");
        assert_eq!(closed.statistics.samples, 0, "proved without a search");
        let open = ring(3, 0.5);
        assert_clear(&open, &run(&open).path.expect("the gap is wide enough"), "through the gap");
        // Two cells are 1 m; a vehicle 1.2 m wide does not pass, which takes the finer proof after a failed search.
        let narrow = Settings { greatest_samples: 300, ..settings };
        let result = find_path(&ring(2, 0.6), query, &narrow, None, &mut never);
        assert_eq!(result.path, Err(Failure::GoalEnclosed), "{planner:?}");
    }
}

#[test]
fn running_out_of_samples_is_no_proof_and_says_how_many() {
    let query = Query { start_m: [3.0, 3.0], goal_m: [20.0, 20.0] };
    for planner in PLANNERS {
        let settings = Settings { greatest_samples: 15, step_m: 1.0, ..Settings::of(planner) };
        let result = find_path(&ring(1, 0.1), query, &settings, None, &mut never);
        assert_eq!(result.path, Err(Failure::NotFound { samples: 15 }), "{planner:?}");
    }
}

#[test]
fn a_caller_can_stop_a_search() {
    let query = Query { start_m: [3.0, 3.0], goal_m: [20.0, 20.0] };
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
    let query = Query { start_m: [10.0, 10.0], goal_m: [110.0, 90.0] };
    for planner in PLANNERS {
        let settings = Settings::of(planner);
        let result = find_path(&space, query, &settings, Some(&ShortcutSettings::default()), &mut never);
        assert_eq!(result.path.unwrap().points_m, [query.start_m, query.goal_m], "{planner:?}");
    }
}

#[test]
fn shortening_comes_near_the_shortest_way_around_a_disc() {
    let mut occupancy = Occupancy::free(GridFrame::new(400, 400, 0.1));
    occupancy.mark(&Obstacle::Circle { center_m: [20.0, 20.0], radius_m: 6.0 }, CellState::Obstacle);
    let space = ConfigurationSpace::new(occupancy, 0.5);
    // Two tangents and an arc, around the disc grown by the radius, from 15 m left to 15 m right of its centre.
    let grown = 6.5_f64;
    let tangent = (15.0_f64 * 15.0 - grown * grown).sqrt();
    let arc = std::f64::consts::PI - 2.0 * (grown / 15.0).acos();
    let shortest = 2.0 * tangent + grown * arc;
    let query = Query { start_m: [5.0, 20.0], goal_m: [35.0, 20.0] };
    for seed in 0..5 {
        let settings = Settings { seed, ..Settings::of(PlannerKind::RrtConnect) };
        let path =
            find_path(&space, query, &settings, Some(&ShortcutSettings::default()), &mut never).path.unwrap();
        let ratio = path.length_m() / shortest;
        assert!((0.999..1.02).contains(&ratio), "seed {seed}: {ratio} times the shortest");
    }
}

#[test]
fn legs_join_at_waypoints_and_a_failure_names_its_leg() {
    let space = ring(0, 0.3);
    let waypoints = [[3.0, 3.0], [36.0, 4.0], [36.0, 36.0]];
    let legs = plan_legs(&space, &waypoints, 3, &mut never).unwrap();
    assert_eq!(legs.len(), 2);
    for (leg, pair) in legs.iter().zip(waypoints.windows(2)) {
        assert_eq!([leg.path.points_m[0], *leg.path.points_m.last().unwrap()], [pair[0], pair[1]]);
    }
    let blocked = [[3.0, 3.0], [36.0, 4.0], [20.0, 20.0]];
    let failure = plan_legs(&space, &blocked, 3, &mut never).unwrap_err();
    assert_eq!((failure.leg, failure.failure), (1, Failure::GoalEnclosed));
}
