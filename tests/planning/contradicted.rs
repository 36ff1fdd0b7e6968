//! What reviews of random missions have passed, held against schedules of the plan, undisturbed runs and other plans: a line
//! that is contradicted is a defect.

use std::fmt::Write as _;

use acceptance::lasting_missions::{Kind, lasting_mission};
use acceptance::random::{crowded_mission, small_mission};
use link::Update;
use mission::{Core, Manner};
use review::contradict::{Effort, Observed, Sight, Trial, Tried, Verdict};
use review::{FlightRules, MissionRule, Section, review};
use snapshot::Goal;
use test_core::Answers;
use tpn::{Network, OccurrenceKind, Supply, generate::Rng};

/// The text of a mission number.
type Made = fn(u64) -> String;

/// Missions of each kind.
const MISSIONS: u64 = 400;
/// Missions in which vehicles drive.
const DRIVING_MISSIONS: u64 = 12;
/// The numbers of other missions in which vehicles drive, as `200..300`.
const OTHER_MISSIONS: &str = "ENROUTE_DRIVING_MISSIONS";
const EFFORT: Effort = Effort { schedules: 40, runs: 8, seed: 5 };

/// Flight rules for each mission.
const RULES: usize = 24;

/// What was tried.
#[derive(Default, Debug)]
struct Count {
    plans: u64,
    /// Plans in which the environment chooses something.
    with_nature: u64,
    lines: u64,
    schedules: u64,
    runs: u64,
    /// Flight rules among the lines.
    rules: u64,
    contradicted: Vec<String>,
}

/// The mission with some of its bounds given to the environment, by chance.
fn with_nature(text: &str, seed: u64) -> String {
    let mut rng = Rng::new(seed ^ 0x6e61);
    let mut parts = text.split("()[");
    let mut changed = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        changed.push_str(if rng.chance(30) { "() contingent [" } else { "()[" });
        changed.push_str(part);
    }
    changed
}

/// Flight rules about what a mission has, by chance. Many do not hold.
fn random_rules(network: &Network, seed: u64) -> FlightRules {
    let mut rng = Rng::new(seed ^ 0x72_756c_6573);
    let performed = network.occurrences.iter().filter(|it| it.kind == OccurrenceKind::Primitive);
    let performed: Vec<&str> = performed.map(|it| it.activity.as_str()).collect();
    let levels = network.resources.iter().map(|it| {
        let most = match it.supply {
            Supply::Reusable { capacity } => capacity,
            Supply::Reservoir { greatest, .. } => greatest,
        };
        (it.name.as_str(), most.to_f64() as i64)
    });
    let levels: Vec<(&str, i64)> = levels.collect();
    let values: Vec<String> = (network.variables.iter())
        .flat_map(|of| of.values.iter().map(|value| format!("{}={value}", of.name)))
        .collect();
    let mut condition = || {
        let any = |rng: &mut Rng, count: usize| rng.between(0, count as i64 - 1) as usize;
        match rng.between(0, 2) {
            0 if !performed.is_empty() => performed[any(&mut rng, performed.len())].to_owned(),
            1 if !levels.is_empty() => {
                let (name, most) = levels[any(&mut rng, levels.len())];
                let order = ["<", "<=", ">", ">="][any(&mut rng, 4)];
                format!("{name} {order} {}", rng.between(0, most))
            }
            _ if !values.is_empty() => values[any(&mut rng, values.len())].clone(),
            _ => "NOTHING".to_owned(),
        }
    };
    let rules = (0..RULES).map(|index| {
        let (first, other) = (condition(), condition());
        let rule = match index % 4 {
            0 => format!("always {first}"),
            1 => format!("never {first}"),
            2 => format!("never {first} while {other}"),
            _ => format!("({first} or {other}) at end"),
        };
        MissionRule { name: format!("R{index} ({rule})"), rule, ..MissionRule::default() }
    });
    FlightRules { rules: rules.collect(), ..FlightRules::default() }
}

fn try_mission(text: &str, seed: u64, effort: Effort, count: &mut Count) {
    let mut core = Core::default();
    let mut host = Answers::default();
    let compiled = core.compile(&Update::new(1, text), &host);
    let ground = core.ground(&compiled.program).expect("its ground is known");
    let Some(evaluated) = core.plan(compiled, ground, Manner::unexplained(), &mut host) else { return };
    let snapshot = evaluated.snapshot();
    let Some(plan) = snapshot.plan() else { return };
    let mut arcs = evaluated.planned.network.arcs.iter().zip(&plan.selected_arcs);
    let has_nature = arcs.any(|(arc, is_selected)| arc.is_contingent && *is_selected);
    if let Some(found) = evaluated.planned.planning.verdict.as_ref().filter(|it| !it.valid) {
        count
            .contradicted
            .push(format!("seed {seed}, the plan is not valid: {:?}\n{text}", found.violations));
    }
    count.plans += 1;
    count.with_nature += u64::from(has_nature);
    let mut reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    let rules = random_rules(&evaluated.planned.network, seed);
    reviewed.hold_against(&snapshot, &rules, None, &mut || false);
    let Some(mut trial) = Trial::new(&snapshot, &reviewed, None, effort) else { return };
    while core.try_next(&evaluated, &mut trial).expect("its times fit") {}
    let is_tried = |tried: &&Tried| tried.verdict() != Verdict::NotTried;
    for tried in trial.tried().filter(is_tried) {
        count.lines += 1;
        count.schedules += tried.schedules;
        count.runs += tried.runs;
        count.rules += u64::from(tried.line.section == Section::MissionRules);
        if let Some(found) = &tried.counterexample {
            let (section, line) = (tried.line.section, &tried.line.text);
            let problem = format!("seed {seed}, {section:?}: {line}: {}\n{text}", found.text);
            count.contradicted.push(problem);
        }
    }
}

#[test]
#[expect(clippy::print_stdout, reason = "the count is part of the evidence")]
fn nothing_that_reviews_of_random_missions_have_passed_is_contradicted() {
    let kinds: [(&str, Made); 5] = [
        ("conditions", small_mission),
        ("crowded", crowded_mission),
        ("states", |seed| lasting_mission(seed, Kind::STATES)),
        ("resources", |seed| lasting_mission(seed, Kind::RESOURCES)),
        ("both", |seed| lasting_mission(seed, Kind::BOTH)),
    ];
    for (kind, mission) in kinds {
        let mut count = Count::default();
        for seed in 0..MISSIONS {
            let text = mission(seed);
            try_mission(&text, seed, EFFORT, &mut count);
            try_mission(&with_nature(&text, seed), seed, EFFORT, &mut count);
        }
        let Count { plans, with_nature, lines, schedules, runs, rules, contradicted } = count;
        println!(
            "{kind}: {plans} plans ({with_nature} with nature), {lines} lines ({rules} rules), {schedules} schedules, {runs} runs"
        );
        assert!(contradicted.is_empty(), "{}: {}", contradicted.len(), contradicted.join("\n"));
        assert!(plans > MISSIONS / 4 && lines > plans && schedules > lines && runs > 0, "{kind}");
    }
}

/// Declares the locations P0 and so on, each near a place of its own.
fn write_places(text: &mut String, rng: &mut Rng, count: usize) {
    let places = [(20, 24), (58, 30), (26, 70), (72, 66), (44, 48), (60, 80), (84, 40)];
    for (number, (x, y)) in places.iter().take(count).enumerate() {
        let _ =
            writeln!(text, "location P{number} ({}, {});", x + rng.between(-4, 4), y + rng.between(-4, 4));
    }
}

/// A mission of one or two vehicles that drive with a battery, which may be charged, among obstacles, on a map or without one.
fn driving_mission(seed: u64) -> String {
    let mut rng = Rng::new(seed ^ 0x6472);
    let mut text = String::new();
    if rng.chance(60) {
        text.push_str("terrain \"tai-plain\" cell 0.6 origin (0, 0);\n");
    }
    write_places(&mut text, &mut rng, 5);
    if rng.chance(50) {
        let _ = writeln!(text, "obstacle O circle ({}, {}, 3);", rng.between(34, 38), rng.between(30, 60));
    }
    let vehicles = rng.between(1, 2);
    for number in 0..vehicles {
        let _ = writeln!(text, "vehicle V{number} : ATRV-Jr at P{number};");
    }
    let (level, charge) = (rng.between(30, 100), rng.between(5, 30));
    let greatest = rng.between(2, 8);
    let bounds = ["[1,80]", "contingent [8,40]", "[0,200]"][rng.below(3) as usize];
    let _ = writeln!(
        text,
        "resource Battery 0..100 = {level}; resource Data 0..20 = 0;
primitive Drive(r, to){bounds} moves r speed (0.005, 0.{greatest}) consumes Battery 0.{} per metre produces Data 0.1 per metre;
primitive Look(r, at)[1,4] requires r.at=at consumes Battery 2 rewards 3;
primitive Charge()[5,9] produces Battery {charge}; primitive Send()[1,2] consumes Data 4;
objective maximize reward, minimize end;",
        rng.between(1, 5)
    );
    let mut branches = Vec::new();
    for number in 0..vehicles {
        let steps = (0..rng.between(1, 2)).map(|_| {
            let place = rng.between(vehicles, 4);
            let look = if rng.chance(50) { "optional Look" } else { "Look" };
            format!("Drive(V{number}, P{place}); delay; {look}(V{number}, P{place})")
        });
        branches.push(format!("{{ {} }}", steps.collect::<Vec<_>>().join("; delay; ")));
    }
    for (more, chance) in [("{ delay; Charge() }", 70), ("{ delay; Send() }", 50)] {
        if rng.chance(chance) {
            branches.push(more.to_owned());
        }
    }
    let _ = writeln!(text, "scenario S[0,600] = {{ {} }}", branches.join(", "));
    text
}

/// A mission of a fleet whose vehicles drive alone or in a formation, for one member, for each or in an order that the planner
/// finds, while something is sent within bounds of which either event may come first, under a sky that changes.
fn fleet_mission(seed: u64) -> String {
    let mut rng = Rng::new(seed ^ 0x666c);
    let mut one_of = |texts: &[&str]| texts[rng.below(texts.len() as u64) as usize].to_owned();
    let bounds = one_of(&["[0,200]", " contingent [8,40]", "[3,60]"]);
    let (look, send) = (one_of(&["[2,4]", " contingent [2,6]"]), one_of(&["[2,3]", " contingent [2,5]"]));
    let drives = one_of(&[
        "any r in S { Visit(r, P1) }, each r in S { optional Visit(r, P2) }",
        "each r in S { Visit(r, P1) }",
        "each r in S in sequence { Visit(r, P2) }",
        "{ each p in Sites unordered { optional Visit(S[1], p) } }, { delay; Visit(S[2], P3) }",
        "{ Convoy(S[1], S[2], P1); delay; Convoy(S[1], S[2], P3) }, { delay; Visit(S[3], P2) }",
        "choose { Convoy(S[2], S[3], P2), delay[1,9] }, { delay; Visit(S[1], P1) }",
        "{ Convoy(S[1], S[2], P1); delay; Visit(S[2], P3) }, { delay; optional Visit(S[3], P1) }",
        "{ Convoy(S[2], S[3], P2); delay; Convoy(S[3], S[2], P1) }, Visit(S[1], P3)",
        "{ Convoy(S[1], S[3], P3); { delay; Visit(S[1], P2), delay; Visit(S[3], P1) } }",
        "Convoy(S[1], S[2], P1), each r in S unordered { optional Visit(r, P2) }",
    ]);
    let sky = one_of(&[
        "{ delay contingent [5,20]; SKY=CLEAR [150,200] }",
        "{ delay[9,9]; SKY=CLEAR contingent [100,150] }",
        "{ delay[0,30]; SKY=CLEAR [200,200] }",
    ]);
    let objective = one_of(&[
        "",
        "objective minimize end;",
        "objective maximize reward, minimize length;",
        "objective minimize length;",
    ]);
    let events = [one_of(&["start", "end"]), one_of(&["start", "end"])];
    let low = rng.between(-20, 3);
    let high = low + rng.between(4, 30);
    let battery = rng.between(40, 100);
    format!(
        "location P0 (20, 20); location P1 (60, {}); location P2 (30, 70); location P3 (75, 60); group Sites = P1, P2, P3;
model Scout {{ resource arm; resource battery 0..100 = {battery}; state drill : {{STOWED, OUT}} = STOWED; }}
vehicle S[1..3] : Scout at P0; var SKY : {{CLEAR, DUSTY}}; resource Link;
primitive Drive(r : vehicle, to : location){bounds} moves r requires r.drill=STOWED consumes r.battery 0.2 per metre;
primitive Convoy(a : vehicle, b : vehicle, to : location)[0,200] moves a, b consumes a.battery 0.1 per metre;
primitive Look(r : Scout, at : location){look} requires r.at=at uses r.arm rewards 3;
primitive Send(){send} uses Link requires SKY=CLEAR;
Visit(r, site) = {{ Drive(r, site); delay; Look(r, site) }}
constrain First.{} to Second.{} [{low},{high}];
{objective}
scenario S[0,600] = {{ {drives}, {{ delay; Send() as First }}, {{ delay; Send() as Second }}, {sky} }}",
        rng.between(20, 40),
        events[0],
        events[1],
    )
}

/// A mission of one to three vehicles that drive between deadlines, in light or through a gate that someone opens for a
/// while, before and after what ends when it will, at speeds below which they may not drive.
fn deadline_mission(seed: u64) -> String {
    let mut rng = Rng::new(seed ^ 0x646c);
    let mut text = String::new();
    if rng.chance(50) {
        text.push_str("terrain \"tai-plain\" cell 0.6 origin (0, 0);\n");
    }
    write_places(&mut text, &mut rng, 7);
    let vehicles = rng.between(1, 3);
    for number in 0..vehicles {
        let model = if rng.chance(60) { "ATRV" } else { "ATRV-Jr" };
        let _ = writeln!(text, "vehicle V{number} : {model} at P{number};");
    }
    let one_of = |rng: &mut Rng, texts: &[&str]| texts[rng.below(texts.len() as u64) as usize].to_owned();
    let speeds = ["speed (0.01, 0.5)", "speed (0.05, 0.3)", "", "speed (0.1, 0.4) kinodynamic"];
    let speeds = one_of(&mut rng, &speeds);
    let look = one_of(&mut rng, &["[1,4]", " contingent [1,4]", "[2,2]", " contingent [2,9]"]);
    let objective = one_of(&mut rng, &["", "objective minimize end;", "objective minimize length;"]);
    let _ = writeln!(
        text,
        "var SUN : {{UP, DOWN}}; state GATE : {{OPEN, SHUT}} = SHUT; resource Link; resource Battery 0..200 = 150;
primitive Drive(r, to)[0,200] moves r {speeds} consumes Battery 0.1 per metre;
primitive Lit(r, to)[0,200] moves r {speeds} requires SUN=UP;
primitive Gated(r, to)[0,200] moves r {speeds} requires GATE=OPEN;
primitive Slow(r, to) contingent [{},{}] moves r {speeds};
primitive Look(r, at){look} requires r.at=at uses Link;
primitive Walk() contingent [{},{}]; primitive Wait()[2,{}];
primitive Open()[1,2] requires GATE=SHUT sets GATE=OPEN; primitive Shut()[1,2] requires GATE=OPEN sets GATE=SHUT;
{objective}",
        rng.between(3, 8),
        rng.between(12, 40),
        rng.between(0, 2),
        rng.between(3, 9),
        rng.between(3, 30),
    );
    let mut branches = Vec::new();
    for number in 0..vehicles {
        let mut steps = Vec::new();
        for _ in 0..rng.between(1, 3) {
            let place = rng.between(0, 6);
            let drive = one_of(&mut rng, &["Drive", "Drive", "Drive", "Lit", "Gated", "Slow"]);
            let mut step = format!("{drive}(V{number}, P{place})");
            if rng.chance(40) {
                step = format!("{}; {step}", one_of(&mut rng, &["Walk()", "delay", "delay[0,3]", "Wait()"]));
            }
            if rng.chance(50) {
                step += &one_of(&mut rng, &["; ", "; delay; ", "; delay[0,2]; "]);
                step += &format!("Look(V{number}, P{place})");
            }
            if rng.chance(25) {
                step = format!("{{ {step} }} [0,{}]", one_of(&mut rng, &["8", "12", "20", "40"]));
            }
            steps.push(step);
        }
        let first = one_of(&mut rng, &["", "delay; ", "delay[1,4]; "]);
        let between = one_of(&mut rng, &["; ", "; delay; ", "; delay[0,5]; "]);
        let within = if rng.chance(30) { format!(" [0,{}]", rng.between(20, 60)) } else { String::new() };
        branches.push(format!("{{ {first}{} }}{within}", steps.join(&between)));
    }
    let all = branches.join(" ");
    if all.contains("Lit") {
        let [least, most] = [["6", "12", "30"], ["30", "45", "60"]].map(|it| one_of(&mut rng, &it));
        branches.push(format!("{{ delay; SUN=UP [{least},{most}]; delay }}"));
    }
    if all.contains("Gated") {
        let open = one_of(&mut rng, &["", "[0,10]", "[0,20]", "[4,8]"]);
        branches.push(format!("{{ delay; Open(); delay{open}; Shut(); delay }}"));
    }
    branches.push("{ Walk(); delay }".to_owned());
    let end = one_of(&mut rng, &["40", "60", "200"]);
    let _ = writeln!(text, "scenario S[0,{end}] = {{ {} }}", branches.join(", "));
    text
}

/// A mission among dunes or on a plain, of two or three rovers with equipment of their own and a blimp: rovers look, drill, hand
/// over a sample, and report from where they see their base, around areas that are closed to some of them, while a condition
/// comes late and a control program runs.
fn expedition_mission(seed: u64) -> String {
    let mut rng = Rng::new(seed ^ 0x6578);
    let one_of = |rng: &mut Rng, texts: &[&str]| texts[rng.below(texts.len() as u64) as usize].to_owned();
    let mut text = String::new();
    let ground = one_of(&mut rng, &["gale-dunes", "gale-dunes", "tai-plain", ""]);
    if !ground.is_empty() {
        let _ = writeln!(text, "terrain \"{ground}\" cell 0.6 origin (0, 0);");
    }
    let places = [(64, 64), (96, 112), (16, 112), (96, 80), (32, 80), (40, 30), (80, 24)];
    for (number, (x, y)) in places.iter().enumerate() {
        let _ =
            writeln!(text, "location P{number} ({}, {});", x + rng.between(-4, 4), y + rng.between(-4, 4));
    }
    let rovers = rng.between(2, 3);
    let _ = writeln!(
        text,
        "group Sites = P1, P3, P4;
model Big {{ body {}; speed (0.01, 0.8); slope {} degrees; turning {}; mast {};
  resource battery {}..100 = {}; resource arm; resource memory 0..{} = {}; state drill : {{STOWED, OUT}} = STOWED; }}",
        one_of(&mut rng, &["1.2 x 0.8", "0.9 x 0.6", "1.4 x 1.0"]),
        rng.between(15, 25),
        one_of(&mut rng, &["0.3", "0.5", "1.2"]),
        one_of(&mut rng, &["0.6", "1.2", "2.5"]),
        rng.between(0, 20),
        rng.between(50, 100),
        rng.between(40, 120),
        rng.between(0, 30),
    );
    for number in 0..rovers {
        let _ = writeln!(text, "vehicle R{number} : Big at P{};", if rng.chance(50) { 0 } else { number });
    }
    let speeds =
        one_of(&mut rng, &["speed (0.01, 0.5)", "speed (0.02, 0.3)", "", "speed (0.05, 0.4) kinodynamic"]);
    let names: Vec<String> = (0..rovers).map(|number| format!("R{number}")).collect();
    let _ = writeln!(
        text,
        "vehicle Sky : Blimp at P0; group Rovers = {}; keepout K circle ({}, {}, {}){};
var LINK : {{UP, DOWN}}; var DUST : {{CLEAR, STORM}}; state SAMPLE : {{NONE, TAKEN, HOME}} = NONE; resource Channel;
primitive Drive(r : vehicle, to : location){} moves r {speeds} requires r.drill=STOWED consumes r.battery 0.{} per metre;
primitive Haul(a : vehicle, b : vehicle, to : location)[0,200] moves a, b {speeds} consumes a.battery 0.1 per metre;
primitive Fly(to : location){} moves Sky speed (0.2, 2.0);
primitive Drill(r : Big, at : location){} requires r.at=at uses r.arm requires at start r.drill=STOWED sets r.drill=OUT consumes r.battery 4;
primitive Stow(r : Big)[1,2] requires at start r.drill=OUT sets r.drill=STOWED uses r.arm;
primitive Look(r : Big, at : location){} requires r.at=at produces r.memory {} rewards 3;
primitive Report(r : Big, to : location)[1,4] requires r.at in visible(to) consumes r.memory {} uses Channel rewards 4;
primitive Take(r : Big, at : location)[1,3] requires r.at=at requires at start SAMPLE=NONE sets SAMPLE=TAKEN;
primitive Give(a : Big, b : Big, at : location)[1,3] requires a.at=at, b.at=at requires at start SAMPLE=TAKEN sets SAMPLE=HOME uses a.arm, b.arm;
primitive Survey(at : location)[4,9] requires Sky.at=at requires DUST=CLEAR rewards 2; primitive Set()[2,{}] runs Warm;
Visit(r, site) = {{ Drive(r, site); delay; Look(r, site) }}
{}",
        names.join(", "),
        rng.between(30, 85),
        rng.between(35, 100),
        rng.between(2, 6),
        one_of(&mut rng, &["", " for Big", " for R0", " for Drive", " for Haul, R1"]),
        one_of(&mut rng, &["[0,200]", "[0,200]", " contingent [5,40]", "[1,120]"]),
        rng.between(1, 2),
        one_of(&mut rng, &["[0,60]", " contingent [2,20]"]),
        one_of(&mut rng, &["[3,6]", " contingent [3,8]"]),
        one_of(&mut rng, &["[1,4]", " contingent [1,4]", "[2,2]"]),
        rng.between(5, 25),
        rng.between(5, 20),
        rng.between(6, 20),
        one_of(
            &mut rng,
            &["", "objective minimize end;", "objective minimize length;", "objective maximize reward, minimize end;"]
        ),
    );
    let mut branches = Vec::new();
    for name in &names {
        let mut step = || {
            let (place, base) = (rng.between(0, 6), one_of(&mut rng, &["P0", "P1", "P5"]));
            let step = match rng.below(7) {
                0 => format!("Drive({name}, P{place})"),
                1 => format!("Visit({name}, P{place})"),
                2 => format!("Drive({name}, P{place}); delay; Drill({name}, P{place}); delay; Stow({name})"),
                3 => format!("Drive({name}, P{place}); delay; Report({name}, {base})"),
                4 => format!("Visit({name}, P{place}); delay; optional Report({name}, P0)"),
                5 => format!("optional Visit({name}, P{place})"),
                _ => format!("choose {{ Visit({name}, P{place}), Visit({name}, P{}) }}", (place + 3) % 7),
            };
            if rng.chance(20) { format!("{{ {step} }} [0,{}]", rng.between(15, 50)) } else { step }
        };
        let first = step();
        branches.push(format!("{{ delay; {first}; delay; {}; delay }}", step()));
    }
    branches.extend(match rng.below(6) {
        0 => vec![
            "{ delay; Drive(R0, P3); Take(R0, P3); delay }".to_owned(),
            "{ delay; Drive(R1, P3); delay; Give(R0, R1, P3); delay; Drive(R1, P0) }".to_owned(),
        ],
        1 => vec![format!("free {{ any r in Rovers {{ Visit(r, P{}) }} }}", rng.between(1, 6))],
        2 => vec!["each p in Sites unordered { optional Visit(R0, p) }".to_owned()],
        3 => vec![format!("{{ delay; Haul(R0, R1, P{}); delay }}", rng.between(1, 6))],
        _ => Vec::new(),
    });
    let place = rng.between(1, 6);
    for (more, chance) in [
        (format!("{{ delay; Fly(P{place}); delay; optional Survey(P{place}); delay; Fly(P0) }}"), 50),
        ("{ delay contingent [5,20]; DUST=CLEAR contingent [20,40]; delay }".to_owned(), 40),
        ("{ do { delay; Report(R0, P0); delay } maintaining LINK=UP; delay }, { delay[5,5]; LINK=UP [20,60]; delay }".to_owned(), 20),
        ("{ delay; Set(); delay }".to_owned(), 30),
    ] {
        if rng.chance(chance) {
            branches.push(more);
        }
    }
    let end = one_of(&mut rng, &["60", "90", "200", "400"]);
    let _ = writeln!(text, "scenario S[0,{end}] = {{ {} }}", branches.join(", "));
    text.push_str(
        "control {
  Warm ()::(SEQUENCE (Heater = On) (Heater = Off))
  (DEFCLASS HeaterClass () (COMMAND cmd {none on off}) (MODE Off true) (MODE On true)
    (TRANSITION Off On (cmd = on)) (TRANSITION On Off (cmd = off)))
  (DEFINSTANCE Heater HeaterClass INIT Off)
}
",
    );
    text
}

#[test]
#[expect(clippy::print_stdout, reason = "the count is part of the evidence")]
fn nothing_that_reviews_of_driving_missions_have_passed_is_contradicted() {
    let kinds: [(&str, Made); 4] = [
        ("driving", driving_mission),
        ("fleets", fleet_mission),
        ("deadlines", deadline_mission),
        ("expeditions", expedition_mission),
    ];
    let other = std::env::var(OTHER_MISSIONS).ok().and_then(|range| {
        let (first, end) = range.split_once("..")?;
        Some(first.parse().ok()?..end.parse().ok()?)
    });
    // More is tried with each of the others.
    let effort = if other.is_some() { Effort { schedules: 100, runs: 40, ..EFFORT } } else { EFFORT };
    for (kind, mission) in kinds {
        let mut count = Count::default();
        for seed in other.clone().unwrap_or(0..DRIVING_MISSIONS) {
            try_mission(&mission(seed), seed, effort, &mut count);
        }
        let Count { plans, lines, runs, rules, contradicted, .. } = count;
        println!("{kind}: {plans} plans, {lines} lines ({rules} rules), {runs} runs");
        assert!(contradicted.is_empty(), "{}: {}", contradicted.len(), contradicted.join("\n"));
        assert!(other.is_some() || plans > DRIVING_MISSIONS / 3, "{kind}: {plans} plans");
        assert!(runs > plans, "{kind}: {plans} plans, {runs} runs");
    }
}

/// A better plan than the one that is called optimal is found.
#[test]
fn another_plan_contradicts_that_none_is_better() {
    let mut core = Core::default();
    let mut host = Answers::default();
    let source = "primitive A()[1,2] costs 3; primitive B()[1,2] costs 5; objective minimize cost;
scenario S[0,9] = { choose { A(), B() } }";
    let compiled = core.compile(&Update::new(1, source), &host);
    let evaluated = core.plan(compiled, None, Manner::default(), &mut host).expect("it is planned");
    let verdict = |change: &mut dyn FnMut(&mut tpn::Plan)| {
        let mut snapshot = evaluated.snapshot();
        let mut planning = snapshot.planning.as_deref().expect("it was planned").clone();
        change(&mut planning.outcome.plans[0]);
        snapshot.planning = Some(std::sync::Arc::new(planning));
        let reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
        let mut trial = Trial::new(&snapshot, &reviewed, None, EFFORT).expect("a plan");
        let mut core = Core::default();
        while core.try_next(&evaluated, &mut trial).expect("its times fit") {}
        let line =
            trial.tried().find(|it| it.line.text.starts_with("objective: ")).expect("it has passed").clone();
        (line.verdict(), line.plans, line.sentence())
    };
    let (kept, plans, _) = verdict(&mut |_| {});
    assert_eq!((kept, plans), (Verdict::Survived, 3), "its own, and one for each choice");
    let (worse, _, sentence) = verdict(&mut |plan| plan.quality.cost = 4.into());
    assert_eq!(worse, Verdict::Contradicted);
    assert_eq!(sentence, "contradicted: another plan has cost 3");
}

/// What a vehicle sees is looked at from where it is in a run, in the direction that the line says.
#[test]
fn what_vehicles_see_is_tried_in_runs() {
    let source = "terrain \"tai-plain\" cell 0.6 origin (0, 0); location BASE (20, 20); location P (40, 30);
vehicle R : ATRV at BASE; primitive Drive(to)[1,60] moves R;
primitive Send()[1,2] requires R.at in visible(BASE), R.at=P; scenario S[0,99] = { Drive(P); Send() }";
    let mut core = Core::default();
    let mut host = Answers::default();
    let compiled = core.compile(&Update::new(1, source), &host);
    let ground = core.ground(&compiled.program).expect("its ground is known");
    let evaluated = core.plan(compiled, ground, Manner::default(), &mut host).expect("it is planned");
    let snapshot = evaluated.snapshot();
    let reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    let mut trial = Trial::new(&snapshot, &reviewed, None, EFFORT).expect("a plan");
    while core.try_next(&evaluated, &mut trial).expect("its times fit") {}
    let line =
        trial.tried().find(|it| it.line.text.starts_with("R sees BASE from P")).expect("it has passed");
    assert_eq!((line.verdict(), line.schedules), (Verdict::Survived, 0), "{line:?}");
    assert!(line.runs > 0, "{line:?}");
    // A run in which the vehicle does not see it contradicts the line.
    let mut trial = Trial::new(&snapshot, &reviewed, None, EFFORT).expect("a plan");
    let script = trial.next_run().expect("it drives");
    let ran = core.run(&evaluated, &script).expect("a plan").expect("its times fit").outcome;
    let hidden = |_: &str, _: &str, _| Some(Sight { is_seen: false, from_m: [40.0, 30.0] });
    trial.try_run(&script, &Observed { log: &ran.log, ending: ran.ending, sight: &hidden });
    let line =
        trial.tried().find(|it| it.line.text.starts_with("R sees BASE from P")).expect("it has passed");
    assert!(line.sentence().ends_with("R does not see BASE from (40.00, 30.00)"), "{}", line.sentence());
}

/// The sections whose lines are tried in missions without vehicles.
#[test]
fn what_can_be_tried_is_tried() {
    let snapshot = test_core::snapshot(
        "state X : {A, B} = A; resource R capacity 2; primitive P()[1,2] requires X=A uses R 1 sets X=B;
scenario S[0,9] = { P(); delay }",
    );
    let reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    let mut trial = Trial::new(&snapshot, &reviewed, None, EFFORT).expect("a plan");
    while trial.try_schedule() {}
    for section in [Section::Plan, Section::CausalLinks, Section::States, Section::Resources] {
        let mut tried = trial.tried().filter(|it| it.line.section == section);
        assert!(tried.any(|it| it.verdict() == Verdict::Survived), "{section:?}");
    }
}
