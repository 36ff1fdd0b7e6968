//! Many runs with chance: shards add up, known probabilities come out, and runs can be repeated.

use std::sync::Arc;

use exact::Time;
use mission::planning::{self, Planned, Problem};
use mission::sampling::Sampler;
use mission::{Grounds, Paths};
use rmpl::program::Program;
use snapshot::robustness::{Distribution, Faults, Incident, Others, Rocks, Traverses};
use snapshot::{Goal, RobustnessSettings, Tally, Uncertainty};
use tpn::Network;

struct Mission {
    program: Program,
    network: Arc<Network>,
}

impl Mission {
    fn read(source: &str) -> Self {
        let parse = rmpl::parse(source);
        let program = parse.program();
        let mut found = parse.diagnostics();
        let network = mission::compile(&program, &Goal::Default, &mut found);
        Self { network: Arc::new(network.unwrap_or_else(|| panic!("{found:?}"))), program }
    }

    fn problem(&self) -> Problem<'_> {
        Problem::new(&self.network, &self.program)
    }

    fn planned(&self) -> Planned {
        let (mut grounds, mut paths) = (Grounds::default(), Paths::default());
        planning::plan(&self.problem(), &mut grounds, &mut paths, &mut || false)
    }

    fn sample(&self, settings: &RobustnessSettings, numbers: impl Iterator<Item = u64>) -> Tally {
        let sampler = Sampler::new(&self.problem(), &self.planned(), &settings.uncertainty);
        let sampler = sampler.expect("there is a plan").expect("its times fit");
        let (mut grounds, mut paths) = (Grounds::default(), Paths::default());
        let mut tally = Tally::default();
        for number in numbers {
            sampler
                .run(&self.problem(), settings, number, &mut grounds, &mut paths, &mut tally)
                .expect("its times fit");
        }
        tally
    }
}

fn settings(runs: u64, uncertainty: Uncertainty) -> RobustnessSettings {
    RobustnessSettings { runs, seed: 7, uncertainty }
}

/// Anything from 10 to 20 is drawn, and 13 is the latest that the light allows.
const WORK: &str = "
primitive Work()[10,20];
scenario Day[0,40] = { do { Work() } maintaining LIGHT, LIGHT [13,13] }";

#[test]
fn a_uniform_duration_gives_the_share_of_it_that_fits() {
    let tally = Mission::read(WORK).sample(&settings(4000, Uncertainty::default()), 0..4000);
    let (low, high) = tally.interval();
    assert!(low < 0.3 && 0.3 < high, "{low} to {high}: 3 of 10 minutes fit");
    assert_eq!(tally.worst_events()[0].0, "Work#1.end");
    assert_eq!(tally.breaks["Work#1.end"].stops + tally.succeeded, tally.runs);
}

/// The pass may open late in every second run, and whoever transmits can wait for it.
#[test]
fn a_condition_that_may_be_late_at_a_fork_costs_nothing_where_everything_can_wait() {
    let late = Incident { probability: 0.5, at: Distribution::Uniform(Time::from(1), Time::from(30)) };
    let uncertainty =
        Uncertainty { late: [("Tell(PASS=OPEN)".into(), late)].into(), ..Uncertainty::default() };
    for branch in ["Transmit()", "choose { Transmit(), Store() }"] {
        let mission = Mission::read(&format!(
            "var PASS : {{CLOSED, OPEN}}; primitive Transmit()[5,10] requires PASS=OPEN; primitive Store()[5,10];
             scenario Day[0,120] = {{ {{ delay; {branch} }}, {{ PASS=OPEN [60,60] }} }}"
        ));
        let tally = mission.sample(&settings(100, uncertainty.clone()), 0..100);
        assert_eq!(tally.succeeded, tally.runs, "{branch}: {:?}", tally.breaks);
        assert!(tally.succeeded_by_replanning > 20, "{branch}: {tally:?}");
    }
}

#[test]
fn shards_add_up_to_what_one_machine_finds() {
    let source = include_str!("../../../../tests/conformance/t03_enroute_both_paths.rmpl");
    let mission = Mission::read(source);
    let uncertainty = Uncertainty {
        withdrawn: [(
            "Tell(PATH1=OK)".into(),
            Incident { probability: 0.5, at: Distribution::Uniform(Time::from(0), Time::from(20)) },
        )]
        .into(),
        ..Uncertainty::default()
    };
    let settings = settings(60, uncertainty);
    let whole = mission.sample(&settings, 0..60);
    assert!(whole.succeeded_by_replanning > 0 && whole.succeeded < whole.runs, "{whole:?}");
    for of in [2_u64, 3, 7] {
        let mut sum = Tally::default();
        // In an order that no cluster would keep to.
        for part in (0..of).rev() {
            sum.merge(&mission.sample(&settings, (part..60).step_by(of as usize)));
        }
        assert_eq!(sum, whole, "{of} parts");
    }
}

#[test]
fn runs_are_repeated_by_their_seed_and_others_differ() {
    let mission = Mission::read(WORK);
    let settings = settings(50, Uncertainty::default());
    assert_eq!(mission.sample(&settings, 0..50), mission.sample(&settings, 0..50));
    let other = RobustnessSettings { seed: 8, ..settings.clone() };
    assert_ne!(mission.sample(&settings, 0..50), mission.sample(&other, 0..50));
}

#[test]
fn without_chance_every_run_succeeds() {
    let uncertainty = Uncertainty { others: Others::Planned, ..Uncertainty::default() };
    let tally = Mission::read(WORK).sample(&settings(10, uncertainty), 0..10);
    assert_eq!((tally.succeeded, tally.breaks.len()), (10, 0));
}

/// The plan surveys at once, for 20 minutes, and the storm comes when it likes.
const STORM: &str = "
var DUST : {CLEAR, STORM};
primitive Survey()[20,20];
scenario Day[0,150] = { do { Survey() } watching DUST=STORM, { delay BOUNDS; DUST=STORM [10,10] } }";

#[test]
fn what_a_plan_assumes_of_the_world_comes_early_and_late() {
    let assumed = Mission::read(&STORM.replace("BOUNDS", "[0,100]"));
    let tally = assumed.sample(&settings(2000, Uncertainty::default()), 0..2000);
    let (low, high) = tally.interval();
    assert!(low < 0.8 && 0.8 < high, "{low} to {high}: the storm comes in the first 20 of 100 minutes");
    // Without bounds of its own it may come until the mission ends.
    let endless = Mission::read(&STORM.replace("BOUNDS", ""));
    let (low, high) = endless.sample(&settings(2000, Uncertainty::default()), 0..2000).interval();
    assert!(high < 0.95 && 0.7 < low, "{low} to {high}");
    // As planned, where that is asked for or the mission forbids anything else.
    let planned = Uncertainty { others: Others::Planned, ..Uncertainty::default() };
    assert_eq!(assumed.sample(&settings(50, planned), 0..50).succeeded, 50);
    let forbidden = format!("option controllability = none;{}", STORM.replace("BOUNDS", "[0,100]"));
    let tally = Mission::read(&forbidden).sample(&settings(50, Uncertainty::default()), 0..50);
    assert_eq!(tally.succeeded, 50);
}

/// With a fault in a fifth of all steps from Standby on, one engine often takes over from the other, and often not.
#[test]
fn components_fail_by_chance_while_programs_run() {
    let source = include_str!("../../../../assets/missions/orbit.rmpl").replace("Failed 0.01", "Failed 0.2");
    let mission = Mission::read(&source);
    let chance = Uncertainty { others: Others::Planned, ..Uncertainty::default() };
    let tally = mission.sample(&settings(400, chance.clone()), 0..400);
    assert!(tally.succeeded > 200 && tally.succeeded < 400, "{tally:?}");
    assert!(tally.slack["Insert#1.end"].most_permille > 0, "the backup engine takes longer");
    let never = Uncertainty { faults: Faults::Never, ..chance };
    let tally = mission.sample(&settings(20, never), 0..20);
    let slack = tally.slack["Insert#1.end"];
    assert_eq!((tally.succeeded, slack.sum_permille), (20, 20 * slack.most_permille), "always the same");
}

#[test]
fn draws_keep_to_their_distribution() {
    let mut random = plant::Random::new(3);
    let mut mean = |distribution: Distribution| {
        let draws: Vec<f64> = (0..4000)
            .map(|_| {
                let time = mission::draws::draw(distribution, &mut random).expect("a small time");
                time.to_f64()
            })
            .collect();
        assert!(draws.iter().all(|&draw| draw >= 0.0));
        draws.iter().sum::<f64>() / draws.len() as f64
    };
    assert!((mean(Distribution::Uniform(Time::from(10), Time::from(20))) - 15.0).abs() < 0.2);
    assert!((mean(Distribution::Triangular(Time::from(0), Time::from(3), Time::from(12))) - 5.0).abs() < 0.2);
    assert!((mean(Distribution::Normal(Time::from(30), Time::from(4))) - 30.0).abs() < 0.3);
    assert!((mean(Distribution::Fixed(Time::from(9))) - 9.0).abs() < 1e-9);
}

#[test]
fn uncertainty_is_read_from_json() {
    let text = r#"{
        "durations": { "Work": { "triangular": [10, 11.5, "40/3"] } },
        "late": { "LIGHT": { "probability": 0.25, "at": { "uniform": [0, 5] } } },
        "others": "planned"
    }"#;
    let uncertainty: Uncertainty = serde_json::from_str(text).expect("it is well formed");
    let expected = Distribution::Triangular(
        Time::from(10),
        Time::new(23, 2).expect("a fraction"),
        Time::new(40, 3).expect("a fraction"),
    );
    assert_eq!(uncertainty.durations["Work"], expected);
    assert_eq!(uncertainty.others, Others::Planned);
    let mission = Mission::read(WORK);
    assert_eq!(uncertainty.unknown_names(&mission.network), ["LIGHT"], "an assertion is called Tell(LIGHT)");
}

const DETOUR: &str = include_str!("../../../../assets/missions/detour.rmpl");

/// Runs of a mission with paths over its ground.
fn on_ground(source: &str, settings: &RobustnessSettings, numbers: std::ops::Range<u64>) -> Tally {
    let mission = Mission::read(source);
    let (mut grounds, mut paths) = (Grounds::default(), Paths::default());
    let (ground, _) = grounds.resolve(&mission.program);
    let problem = Problem { ground: ground.as_ref().map(|(key, map)| (key, map)), ..mission.problem() };
    let planned = planning::plan(&problem, &mut grounds, &mut paths, &mut || false);
    let sampler = Sampler::new(&problem, &planned, &settings.uncertainty);
    let sampler = sampler.expect("there is a plan").expect("its times fit");
    let mut tally = Tally::default();
    for number in numbers {
        sampler.run(&problem, settings, number, &mut grounds, &mut paths, &mut tally).expect("its times fit");
    }
    tally
}

/// Runs of the detour mission in which the rover drives.
fn driven(rocks: Rocks, numbers: std::ops::Range<u64>) -> Tally {
    let uncertainty = Uncertainty {
        others: Others::Planned,
        traverses: Traverses::Driven,
        rocks,
        ..Uncertainty::default()
    };
    on_ground(DETOUR, &settings(numbers.end, uncertainty), numbers)
}

/// The path at full speed and the hand-over take 19.4385 minutes; a vehicle that really drives may take longer.
#[test]
fn vehicles_that_drive_take_as_long_as_the_way_and_its_rocks_make_them() {
    let free = driven(Rocks::default(), 0..2);
    assert_eq!(free.succeeded, 2);
    let (least, most) = free.end_least.zip(free.end_most).expect("they end");
    assert!(19_438 <= least && most < 21_500, "{least} to {most}");
    let rocks = Rocks { most: 12, radius: [0.5, 1.0], aside: 1.0 };
    let among = driven(rocks, 0..2);
    assert!(among.end_most > free.end_most, "{:?} after {:?}", among.end_most, free.end_most);
    let mut shards = driven(rocks, 1..2);
    shards.merge(&driven(rocks, 0..1));
    assert_eq!(shards, among);
}

/// Two rovers whose paths cross; the environment chooses how long each takes.
const CROSSING: &str = "
terrain \"tai-plain\" cell 0.6 origin (0, 0);
location A (24, 52); location B (60, 56); location C (44, 40); location D (44, 70);
vehicle Alpha : ATRV at A; vehicle Delta : ATRV at C;
primitive Drive(r, to) contingent [2,30] moves r speed (0.01, 0.5);
scenario S[0,100] = { { Drive(Alpha, B) }, { delay[1.3,1.3]; Drive(Delta, D) } }";

#[test]
fn vehicles_that_touch_on_their_paths_end_a_run_without_driving() {
    let meeting = on_ground(CROSSING, &settings(100, Uncertainty::default()), 0..100);
    let stops: u64 = meeting.breaks.values().map(|breaks| breaks.stops).sum();
    assert!(0 < stops && stops < 100, "{stops} runs stopped");
    assert_eq!(meeting.succeeded + stops, 100);
    assert!(meeting.breaks.values().all(|breaks| breaks.example.contains("touch")), "{:?}", meeting.breaks);
    // The same durations of a plan that reaches the crossing in turn never fail.
    let apart = CROSSING.replace("delay[1.3,1.3]", "delay[40,40]");
    let apart = on_ground(&apart, &settings(100, Uncertainty::default()), 0..100);
    assert_eq!(apart.succeeded, 100, "{:?}", apart.breaks);
}
