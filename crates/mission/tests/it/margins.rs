//! What drivers and formations really need, measured over random missions without disturbances: the bounds that plans count
//! hold for every drive.

use std::fmt::Write as _;

use executive::Script;
use kirk::Options;
use mission::execution;
use terrain::Random;

use crate::support::Mission;

/// A plain with rocks, and narrow ways between steep dunes.
const PLAIN: &str = "tai-plain";
const DUNES: &str = "gale-dunes";

/// A mission with a few places, obstacles, and one to three vehicles that drive together, on a map whose rocks it does not
/// show, or some without a map instead of the plain; and the greatest speed of its drives, in m/s.
fn random_mission(ground: &str, seed: u64) -> (String, f64) {
    let mut random = Random::from_seed(seed);
    let mut text = String::new();
    if ground != PLAIN || random.below(2) == 0 {
        let _ = writeln!(text, "terrain \"{ground}\" cell 0.6 origin (0, 0);");
    }
    let places = 2 + random.below(3);
    for place in 0..places {
        let _ = writeln!(
            text,
            "location P{place} ({:.1}, {:.1});",
            random.range(20.0, 90.0),
            random.range(20.0, 90.0)
        );
    }
    for number in 0..random.below(5) {
        let (x, y, r) = (random.range(20.0, 90.0), random.range(20.0, 90.0), random.range(1.0, 6.0));
        let _ = writeln!(text, "obstacle O{number} circle ({x:.1}, {y:.1}, {r:.1});");
    }
    let mut names = Vec::new();
    for vehicle in 0..=random.below(3) {
        let model = if random.below(2) == 0 { "ATRV" } else { "ATRV-Jr" };
        let _ = writeln!(text, "vehicle R{vehicle} : {model} at P0;");
        names.push(format!("R{vehicle}"));
    }
    let greatest = [0.05, 0.2, 0.5, 0.8][random.below(4) as usize];
    let _ =
        writeln!(text, "primitive Drive(to)[0,600] moves {} speed (0.005, {greatest});", names.join(", "));
    let drives: Vec<String> = (1..=places).map(|place| format!("Drive(P{})", place % places)).collect();
    let _ = writeln!(text, "scenario S[0,4000] = {{ {} }}", drives.join("; delay; "));
    (text, greatest)
}

#[test]
fn no_driver_gives_up_or_needs_more_than_plans_count() {
    let mut drives = 0;
    // Those after the first were the hardest of many.
    let on_plain = (0..24).chain([144, 404, 524, 528, 541, 720]).map(|seed| (PLAIN, seed));
    let on_dunes = (0..6).chain([41, 178, 203]).map(|seed| (DUNES, seed));
    for (ground, seed) in on_plain.chain(on_dunes) {
        let (source, speed_mps) = random_mission(ground, seed);
        Mission::read(&source).with_plan((Options::default(), seed), |problem, planned, grounds, paths| {
            // A place in an obstacle, or one that no path reaches.
            let Some(ran) = execution::execute(problem, &planned, &Script::default(), grounds, paths) else { return };
            for drive in ran.expect("its times fit").drives {
                let is_its = |it: &&snapshot::Traverse| it.occurrence == drive.occurrence;
                let Some(traverse) = planned.traverses.iter().find(is_its) else { continue };
                // The review has not passed them.
                if traverse.may_be_closed() || traverse.clearance_m < 0.0 {
                    continue;
                }
                let duration = drive.duration.unwrap_or_else(|| panic!("seed {seed}: a drive is given up\n{source}"));
                let (length_m, followers) = (traverse.length_m, traverse.vehicles.len() - 1);
                let bounds = [
                    motion::min_driven_m(length_m, followers, traverse.rocks),
                    motion::driven_at_most_m(length_m, followers, traverse.rocks),
                ];
                assert!(
                    (bounds[0]..=bounds[1]).contains(&drive.driven_m),
                    "seed {seed}: {} m along {length_m} m with {followers} followers; {bounds:?} are counted\n{source}",
                    drive.driven_m
                );
                let least: f64 = traverse.leg_figures.iter().map(|leg| leg.min_duration.to_f64()).sum();
                let within_s = motion::driven_within_s(least * 60.0, speed_mps, followers, traverse.rocks);
                let took_s = duration.to_f64() * 60.0;
                assert!(took_s <= within_s, "seed {seed}: {took_s} s, where {within_s} s are counted\n{source}");
                drives += 1;
            }
        });
    }
    assert!(drives > 40, "only {drives} drives");
}

/// A rover goes aside where another one is parked; its next drive, in formation, starts there, and ends beside a rock.
const BESIDE: &str = "terrain \"tai-plain\" cell 0.6 origin (0, 0);
    location HOME (27, 83); location WEST (15, 17); location MIDDLE (19, 43); location ROCK (35, 19);
    model Small { body 1.0 x 0.6; resource battery 10..100 = 61; }
    vehicle S[1..3] : Small at HOME;
    primitive Drive(r : vehicle, to : location)[1,200] moves r consumes r.battery 0.1 per metre;
    primitive Convoy(a : vehicle, b : vehicle, to : location)contingent [10,60] moves a, b consumes a.battery 0.2 per metre;
    objective maximize reward, minimize end;
    scenario M[0,495] = {
      { Drive(S[3], MIDDLE); delay; Drive(S[1], MIDDLE); delay; Convoy(S[1], S[3], ROCK) },
      { delay; Drive(S[2], WEST); delay[1,9] } }";

#[test]
fn a_vehicle_starts_where_the_drive_before_has_left_it() {
    Mission::read(BESIDE).with_plan((Options::default(), 0), |problem, planned, grounds, paths| {
        let ends = |name: &str| {
            let is_its =
                |it: &&snapshot::Traverse| planned.network.occurrences[it.occurrence.index()].name == name;
            let traverse = planned.traverses.iter().find(is_its).expect(name);
            let points_m = snapshot::joined(&traverse.legs).points_m;
            (points_m[0], points_m[points_m.len() - 1])
        };
        let (arrived, left) = (ends("Drive#2").1, ends("Convoy#1").0);
        assert_ne!(arrived, nalgebra::Point2::new(19.0, 43.0), "S[3] is parked there");
        assert_eq!(arrived, left);
        let script = Script { nature: [("Convoy#1".into(), 10.into())].into(), ..Script::default() };
        let ran = execution::execute(problem, &planned, &script, grounds, paths).expect("it has a plan");
        let ran = ran.expect("its times fit");
        assert!(ran.drives.iter().all(|drive| drive.duration.is_some()), "{:?}", ran.outcome.log.last());
    });
}
