//! Vehicles that drive by themselves in a world finer than their map.

use motion::{
    Convoy, ConvoyMember, DriveEvent, DriveLimits, Driver, DriverSettings, FineWorld, Path, Surroundings,
    Trajectory, VehicleModel, vehicle_model,
};
use nalgebra::{Point2, Vector2, distance};
use terrain::{Obstacle, Random};

fn rover() -> &'static VehicleModel {
    vehicle_model("ATRV-Jr").unwrap()
}

fn settings() -> DriverSettings {
    DriverSettings::new(DriveLimits::of(rover()), rover().circumradius_m)
}

/// Drives until something other than driving is reported; panics when the vehicle touches something, breaks its limits,
/// or goes so fast that it could not stop in front of a thing ahead.
fn drive(world: &FineWorld, path: Path, seed: u64) -> (DriveEvent, Driver) {
    let mut driver = Driver::new(path, 0.0, settings(), seed);
    let limits = settings().limits;
    for _ in 0..6000 {
        let before = driver.state();
        let (event, _) = driver.step(world, None);
        let after = driver.state();
        let clearance = world.distance_m(after.position_m);
        assert!(clearance >= settings().radius_m, "seed {seed}: {clearance} m at {:?}", after.position_m);
        let change = (after.speed_mps - before.speed_mps).abs();
        assert!(change <= limits.acceleration_mps2 * Trajectory::STEP_S + 1e-9);
        assert!(after.speed_mps + after.turn_rate_rps.abs() * limits.half_track_m <= limits.speed_mps + 1e-9);
        let stopping = after.speed_mps * after.speed_mps / (2.0 * limits.acceleration_mps2);
        let ahead = after.world_from_body() * Point2::from(Vector2::x() * stopping);
        // Straight ahead is one of the ways to stop; it must be free unless a turn under way leads around.
        assert!(
            after.turn_rate_rps.abs() > 0.02 || world.distance_m(ahead) >= settings().radius_m - 0.02,
            "seed {seed}: can't stop at {:?}",
            after.position_m
        );
        if event != DriveEvent::Driving {
            return (event, driver);
        }
    }
    (DriveEvent::Driving, driver)
}

#[test]
fn an_empty_world_is_driven_at_full_speed_to_the_end() {
    let path = Path::new([[0.0, 0.0], [30.0, 0.0], [30.0, 20.0]].map(Point2::from).to_vec());
    let (event, driver) = drive(&FineWorld::default(), path, 1);
    assert_eq!(event, DriveEvent::Arrived);
    let end = driver.state().position_m;
    assert!(distance(&end, &Point2::new(30.0, 20.0)) <= 0.2);
    // 50 m at 1 m/s, with ramps, the corner and a slow approach.
    assert!((50.0..75.0).contains(&driver.time_s()), "{} s", driver.time_s());
}

#[test]
fn rocks_that_the_map_does_not_show_are_passed_without_touching() {
    let mut arrived = 0;
    for seed in 0..8 {
        let mut random = Random::from_seed(seed);
        let mut world = FineWorld::default();
        for _ in 0..14 {
            let center_m = Point2::new(random.range(5.0, 35.0), random.range(-4.0, 4.0));
            world.add(&Obstacle::Circle { center_m, radius_m: random.range(0.2, 0.45) });
        }
        let (event, driver) =
            drive(&world, Path::new([[0.0, 0.0], [40.0, 0.0]].map(Point2::from).to_vec()), seed);
        match event {
            DriveEvent::Arrived => arrived += 1,
            DriveEvent::Blocked { .. } | DriveEvent::OffCorridor { .. } => {}
            DriveEvent::Driving => panic!("seed {seed}: still driving at {:?}", driver.state()),
        }
    }
    assert!(arrived >= 7, "{arrived} of 8 arrived");
}

#[test]
fn a_wall_across_the_way_is_reported() {
    let mut world = FineWorld::default();
    world.add(&Obstacle::Polygon {
        corners_m: [[15.0, -30.0], [16.0, -30.0], [16.0, 30.0], [15.0, 30.0]].map(Point2::from).to_vec(),
    });
    let (event, driver) = drive(&world, Path::new([[0.0, 0.0], [40.0, 0.0]].map(Point2::from).to_vec()), 3);
    assert!(
        matches!(event, DriveEvent::Blocked { .. } | DriveEvent::OffCorridor { .. }),
        "{event:?} at {:?}",
        driver.state()
    );
    let mut driver = driver;
    let here = driver.state().position_m;
    driver.follow(Path::new(vec![here, ([0.0, here[1]]).into()]));
    for _ in 0..2000 {
        if driver.step(&world, None).0 == DriveEvent::Arrived {
            return;
        }
    }
    panic!("did not come back: {:?}", driver.state());
}

#[test]
fn the_same_seed_drives_the_same_way() {
    let mut world = FineWorld::default();
    world.add(&Obstacle::Circle { center_m: Point2::new(10.0, 0.1), radius_m: 0.4 });
    let run = |seed| drive(&world, Path::new([[0.0, 0.0], [20.0, 0.0]].map(Point2::from).to_vec()), seed).1;
    let end = |driver: &Driver| (driver.state(), driver.time_s());
    assert_eq!(end(&run(7)), end(&run(7)));
    assert_ne!(end(&run(7)), end(&run(8)));
}

#[test]
fn a_creeping_vehicle_passes_rocks_too_and_takes_as_long_as_its_speed_says() {
    let creeping = settings().at_most(0.025);
    assert!((creeping.step_s - 3.2).abs() < 1e-9);
    let mut arrived = 0;
    for seed in 0..8 {
        let mut random = Random::from_seed(seed);
        let mut world = FineWorld::default();
        for _ in 0..14 {
            let center_m = Point2::new(random.range(5.0, 35.0), random.range(-4.0, 4.0));
            world.add(&Obstacle::Circle { center_m, radius_m: random.range(0.2, 0.45) });
        }
        let mut driver =
            Driver::new(Path::new([[0.0, 0.0], [40.0, 0.0]].map(Point2::from).to_vec()), 0.0, creeping, seed);
        for _ in 0..2000 {
            let before = driver.state().position_m;
            let (event, _) = driver.step(&world, None);
            let place = driver.state().position_m;
            assert!(distance(&place, &before) <= 0.1 + 1e-9);
            let clearance = world.distance_m(place);
            assert!(clearance >= creeping.radius_m, "seed {seed}: {clearance} m at {place:?}");
            if event == DriveEvent::Arrived {
                arrived += 1;
                // 40 m at 0.025 m/s are 1600 s; ways around rocks are longer.
                assert!((1590.0..2100.0).contains(&driver.time_s()), "seed {seed}: {} s", driver.time_s());
            }
            if event != DriveEvent::Driving {
                break;
            }
        }
    }
    assert!(arrived >= 7, "{arrived} of 8 arrived");
}

/// Its patience is for the way that it is told to drive, not for time: on an empty plain nothing blocks it.
#[test]
fn a_vehicle_with_a_slow_pace_is_not_blocked_by_nothing() {
    let settings = settings().at_most(1.0);
    for (seed, pace_mps) in [(1, 0.015), (2, 0.004), (3, 0.1)] {
        let path = Path::new([[0.0, 0.0], [9.0, 0.0]].map(Point2::from).to_vec());
        let mut convoy =
            Convoy::new(vec![ConvoyMember { path, heading_rad: 2.0, settings, flies: false }], 2.0, seed);
        let world = FineWorld::default();
        let around = Surroundings { world: &world, air: &world, has_changed: false, maps: &[], others: &[] };
        let mut steps = 0;
        while !convoy.has_arrived() {
            let (event, _) = convoy.step(&around, pace_mps, &[1.0]).swap_remove(0);
            assert!(!matches!(event, DriveEvent::Blocked { .. }), "{event:?} at {} s", convoy.time_s());
            steps += 1;
            assert!(steps < 1000, "9 m take a step for each 8 cm, and a few to turn");
        }
        assert!((8.5 / pace_mps..12.0 / pace_mps).contains(&convoy.time_s()), "{} s", convoy.time_s());
    }
}

/// What it waits for in between does not make it forget that it could not continue before.
#[test]
fn a_blocked_vehicle_that_often_waits_reports_it() {
    let mut world = FineWorld::default();
    for (low, high) in [([-2.0, 1.6], [16.0, 2.6]), ([-2.0, -2.6], [16.0, -1.6]), ([15.0, -2.6], [16.0, 2.6])]
    {
        let corners_m = [low, [high[0], low[1]], high, [low[0], high[1]]].map(Point2::from).to_vec();
        world.add(&Obstacle::Polygon { corners_m });
    }
    let path = Path::new([[0.0, 0.0], [40.0, 0.0]].map(Point2::from).to_vec());
    let mut driver = Driver::new(path, 0.0, settings(), 1);
    let mut waited_s = 0.0;
    for step in 0..12_000 {
        let waits = step % 40 < 20;
        driver.set_cruise(if waits { 0.0 } else { 0.8 });
        let before_s = driver.time_s();
        match driver.step(&world, None).0 {
            DriveEvent::Driving => {}
            DriveEvent::Blocked { seconds } => {
                assert!(seconds < 40.0, "{seconds} s, of which it was to stand in half");
                return;
            }
            other => panic!("{other:?}"),
        }
        waited_s += if waits { driver.time_s() - before_s } else { 0.0 };
    }
    panic!("it waited {waited_s} s and reported nothing at {:?}", driver.state());
}

#[test]
fn a_convoy_keeps_apart_waits_for_a_stopped_follower_and_arrives() {
    let jr = rover();
    let spacing_m = 2.2 * jr.circumradius_m + 1.0;
    let settings = DriverSettings::new(DriveLimits::of(jr), jr.circumradius_m).at_most(0.5);
    let leader = Path::new([[0.0, 0.0], [30.0, 0.0], [30.0, 25.0]].map(Point2::from).to_vec());
    let follower =
        Path::new([[-spacing_m, 0.0], [30.0, 0.0], [30.0, 25.0 - spacing_m]].map(Point2::from).to_vec());
    let members = [leader, follower]
        .map(|path| ConvoyMember { path, heading_rad: 0.0, settings, flies: false })
        .to_vec();
    let mut convoy = Convoy::new(members, spacing_m, 3);
    let world = FineWorld::default();
    let around = Surroundings { world: &world, air: &world, has_changed: false, maps: &[], others: &[] };
    let mut farthest = 0.0_f64;
    while !convoy.has_arrived() && convoy.time_s() < 600.0 {
        let stopped = (20.0..60.0).contains(&convoy.time_s());
        convoy.step(&around, 0.5, &[0.5, if stopped { 0.0 } else { 0.6 }]);
        let [a, b] = [0, 1].map(|vehicle| convoy.state(vehicle).position_m);
        let apart = distance(&a, &b);
        assert!(apart > 2.0 * jr.circumradius_m, "{apart} m apart at {}", convoy.time_s());
        farthest = farthest.max(apart);
    }
    assert!(convoy.has_arrived(), "{:?} {:?}", convoy.state(0), convoy.state(1));
    assert!(farthest < 6.0 * spacing_m, "the leader waits: {farthest}");
    // 55 m at 0.5 m/s are 110 s, and 40 s of standing, less the lead that the leader had.
    assert!((130.0..190.0).contains(&convoy.time_s()), "{}", convoy.time_s());
}

/// Where those behind are sent back the way they came, the leader has to get past them, and they past each other.
#[test]
fn a_convoy_that_is_sent_back_turns_around_without_touching() {
    let jr = rover();
    let spacing_m = 2.2 * jr.circumradius_m + 1.0;
    let settings = DriverSettings::new(DriveLimits::of(jr), jr.circumradius_m).at_most(0.5);
    let count = 3;
    for (seed, half_width_m) in [(1, 20.0), (2, 3.0), (3, 2.5), (4, 2.0)] {
        let along = |from: f64, to: f64| Path::new([[from, 0.0], [to, 0.0]].map(Point2::from).to_vec());
        let behind_m = |vehicle: usize| spacing_m * vehicle as f64;
        let members = (0..count).map(|vehicle| {
            let path = along(-behind_m(vehicle), 40.0 - behind_m(vehicle));
            ConvoyMember { path, heading_rad: 0.0, settings, flies: false }
        });
        let mut convoy = Convoy::new(members.collect(), spacing_m, seed);
        let mut world = FineWorld::default();
        for side in [-1.0, 1.0] {
            let [near, far] = [side * half_width_m, side * (half_width_m + 1.0)];
            let corners = [[-60.0, near], [60.0, near], [60.0, far], [-60.0, far]];
            world.add(&Obstacle::Polygon { corners_m: corners.map(Point2::from).to_vec() });
        }
        let around = Surroundings { world: &world, air: &world, has_changed: false, maps: &[], others: &[] };
        let (mut is_sent_back, mut nearest) = (false, f64::INFINITY);
        while !convoy.has_arrived() && convoy.time_s() < 1_000.0 {
            if convoy.time_s() > 30.0 && !is_sent_back {
                is_sent_back = true;
                for vehicle in 0..count {
                    let here = convoy.state(vehicle).position_m;
                    convoy.follow(vehicle, along(here.x, -40.0 + behind_m(vehicle)));
                }
            }
            convoy.step(&around, 0.4, &[0.5; 3]);
            for first in 0..count {
                for second in first + 1..count {
                    let places = [first, second].map(|vehicle| convoy.state(vehicle).position_m);
                    nearest = distance(&places[0], &places[1]).min(nearest);
                }
            }
        }
        let places = [0, 1, 2].map(|vehicle| convoy.state(vehicle).position_m);
        assert!(convoy.has_arrived(), "{half_width_m} m: {places:?}");
        assert!(nearest > 2.0 * jr.circumradius_m, "{half_width_m} m: {nearest} m apart");
    }
}
