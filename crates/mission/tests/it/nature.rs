//! What nature chooses, in simulation and in many runs (SPEC 13.2): within its ranges a controllable plan never fails.

use exact::{Rational, Time};
use executive::{Disturbance, Ending, Happening, Script};
use mission::execution::{self, Ran};
use mission::sampling::Sampler;
use snapshot::robustness::Distribution;
use snapshot::{RobustnessSettings, Tally, Uncertainty};

use crate::support::Mission;

/// What the tests do with a mission.
trait Runs {
    /// Executes it, with what the environment chooses drawn by the seed.
    fn execute(&self, seed: u64, script: &Script) -> Ran;
    /// Executes it so many times.
    fn sample(&self, runs: u64, uncertainty: &Uncertainty) -> Tally;
}

impl Runs for Mission {
    fn execute(&self, seed: u64, script: &Script) -> Ran {
        self.with_plan((kirk::Options::default(), seed), |problem, planned, grounds, paths| {
            let ran = execution::execute(problem, &planned, script, grounds, paths);
            ran.expect("there is a plan").expect("its times fit")
        })
    }

    fn sample(&self, runs: u64, uncertainty: &Uncertainty) -> Tally {
        let settings = RobustnessSettings { runs, seed: 3, uncertainty: uncertainty.clone() };
        self.with_plan((kirk::Options::default(), 0), |problem, planned, grounds, paths| {
            let sampler = Sampler::new(problem, &planned, uncertainty);
            let sampler = sampler.expect("there is a plan").expect("its times fit");
            let mut tally = Tally::default();
            for number in 0..runs {
                sampler.run(problem, &settings, number, grounds, paths, &mut tally).expect("its times fit");
            }
            tally
        })
    }
}

/// Returns how long something took in the plan that was executed last.
fn lasted(ran: &Ran, name: &str) -> Time {
    let executed = ran.outcome.last();
    let occurrence = executed.network.occurrences.iter().find(|occurrence| occurrence.name == name);
    let occurrence = occurrence.unwrap_or_else(|| panic!("{name}"));
    let [start, end] = [occurrence.start, occurrence.end].map(|node| executed.times[node.index()]);
    start.zip(end).and_then(|(start, end)| end.checked_sub(start)).unwrap_or_else(|| panic!("{name} lasts"))
}

/// The drive is followed by work that makes up for it, and nothing is photographed in the dust, whenever that comes.
const DAY: &str = "
primitive Drive()contingent[20,40];
primitive Photograph()[5,10];
primitive Dig()[1,30];
scenario Day[0,80] = {
  { Drive(); Dig() },
  { do { Photograph() } maintaining SKY=CLEAR },
  { SKY=CLEAR contingent[30,60]; SKY=DUST [1,1] }
}";

#[test]
fn a_controllable_plan_never_fails_by_chance_or_against_the_adversary() {
    let mission = Mission::read(DAY);
    for adversary in [false, true] {
        let tally = mission.sample(500, &Uncertainty { adversary, ..Uncertainty::default() });
        assert_eq!((tally.succeeded, tally.succeeded_by_replanning), (500, 0), "{:?}", tally.breaks);
        // The mission ends when the dust has, and that is drawn.
        let (least, most) = (tally.end_least.expect("an end"), tally.end_most.expect("an end"));
        assert!(least < 45_000 && most >= 60_000, "{least} to {most}");
        if adversary {
            assert!([31_000, 41_000].contains(&least) && most == 61_000, "{least} to {most}");
        }
    }
}

#[test]
fn what_is_said_of_a_range_is_drawn_within_it() {
    let durations = [("Drive".into(), Distribution::Fixed(Time::from(39)))];
    let short = [("Tell(SKY=CLEAR)#1".into(), Distribution::Fixed(Time::from(3)))];
    let uncertainty =
        Uncertainty { durations: durations.into_iter().chain(short).collect(), ..Uncertainty::default() };
    let mission = Mission::read(DAY);
    assert_eq!(uncertainty.unknown_names(&mission.network), Vec::<&str>::new());
    let tally = mission.sample(20, &uncertainty);
    assert_eq!(tally.succeeded, 20, "{:?}", tally.breaks);
    // 39 of driving and 1 of digging, and the sky is clear for 30 and not for 3.
    assert_eq!((tally.end_least, tally.end_most), (Some(40_000), Some(40_000)));
}

#[test]
fn a_seed_draws_what_nature_chooses_and_a_disturbance_says_otherwise() {
    let mission = Mission::read(DAY);
    let drives: Vec<Time> = (0..6)
        .map(|seed| {
            let ran = mission.execute(seed, &Script::default());
            assert_eq!(ran.outcome.ending, Ending::Finished);
            let again = mission.execute(seed, &Script::default());
            assert_eq!(ran.outcome.log, again.outcome.log, "seed {seed} gives the same run");
            lasted(&ran, "Drive#1")
        })
        .collect();
    let range = Time::from(20)..=Time::from(40);
    assert!(drives.iter().all(|drive| range.contains(drive)), "{drives:?}");
    assert!(drives.iter().any(|drive| *drive != drives[0]), "{drives:?}");
    let given = |duration: i64| Script {
        disturbances: vec![Disturbance::Duration {
            activity: "Drive#1".into(),
            duration: Time::from(duration),
        }],
        ..Script::default()
    };
    assert_eq!(lasted(&mission.execute(0, &given(31)), "Drive#1"), Time::from(31));
    let outside = mission.execute(0, &given(50));
    let is_violation = |it: &executive::Entry| matches!(it.happening, Happening::Violation { .. });
    assert!(outside.outcome.log.iter().any(is_violation), "{:?}", outside.outcome.log);
}

#[test]
fn a_vehicle_drives_at_the_speed_that_natures_duration_needs() {
    let detour = include_str!("../../../../assets/missions/detour.rmpl");
    let source = detour.replace("Carry(GAP, LANDER)[10,60]", "Carry(GAP, LANDER)contingent[30,60]");
    assert_ne!(source, detour);
    let mission = Mission::read(&source);
    let mut durations = Vec::new();
    for adversary in [false, true] {
        let ran = mission.execute(2, &Script { adversary, ..Script::default() });
        assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log.last());
        assert_eq!(ran.replanned.len(), 0);
        let [drive] = ran.drives.as_slice() else { panic!("one traverse is driven") };
        let (drawn, driven) = (lasted(&ran, "Carry#1"), drive.duration.expect("it arrives"));
        assert!(driven <= drawn, "{driven} of {drawn}");
        assert!(driven.to_f64() > 0.9 * drawn.to_f64(), "{driven} of {drawn}: it does not race and wait");
        durations.push(drawn);
    }
    assert!([Time::from(30), Time::from(60)].contains(&durations[1]), "{durations:?}");
    assert_ne!(durations[0], durations[1]);
}

/// Runs keep bounds between threads of which either event may come first, and what else the plan orders.
#[test]
fn either_event_of_a_bound_may_come_first_in_runs() {
    let mut random = tpn::generate::Rng::new(11);
    let mut planned = 0;
    for case in 0..48 {
        let (low, high) = (random.between(-20, 4), random.between(0, 12));
        let ends = ["start", "end"];
        let (from, to) = (ends[random.below(2) as usize], ends[random.below(2) as usize]);
        let kind = ["", "contingent "][random.below(2) as usize];
        let source = format!(
            "resource Link; primitive Send() {kind}[2,5] uses Link;
             scenario M[0,60] = {{ {{ delay; Send() as One }}, {{ delay; Send() as Other }} }}
             constrain One.{from} to Other.{to} [{low},{high}];"
        );
        let mission = Mission::read(&source);
        let has_plan = mission.with_plan((kirk::Options::default(), 0), |_, planned, _, _| {
            mission::planning::has_plan(&planned.planning.outcome)
        });
        if !has_plan {
            continue;
        }
        planned += 1;
        for seed in 0..3 {
            let outcome = mission.execute(seed, &Script::default()).outcome;
            assert_eq!(outcome.ending, Ending::Finished, "case {case}: {:?}\n{source}", outcome.log);
            for entry in &outcome.log {
                let is_kept = match &entry.happening {
                    Happening::Violation { .. } => false,
                    Happening::Level { level, .. } => *level <= Rational::ONE,
                    _ => true,
                };
                assert!(is_kept, "case {case}: {entry:?}\n{source}");
            }
        }
    }
    assert!(planned > 20, "{planned} plans");
}
