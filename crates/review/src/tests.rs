//! The Enroute mission, reviewed: the figures are those of SPEC 3.6.

use std::sync::Arc;

use exact::{Bound, Time};
use snapshot::{Goal, Snapshot};
pub(super) use test_core::snapshot;

use super::lines::{DYNAMIC, STRONG};
use super::{Fate, Review, Section, Status, TimeRange, content_hash, review};

pub(super) const SCENARIO: &str = include_str!("../../../tests/conformance/t01_enroute_scenario.rmpl");
pub(super) const MISSION: &str = include_str!("../../../assets/missions/enroute.rmpl");

pub(super) fn reviewed(source: &str) -> Review {
    review(&snapshot(source), &Goal::Default, 0, &mut || false)
}

fn range(least: i64, greatest: i64) -> TimeRange {
    TimeRange { least: Time::from(least), greatest: Bound::Finite(Time::from(greatest)) }
}

#[test]
fn the_enroute_plan_exists_and_is_verified() {
    let review = reviewed(SCENARIO);
    let statuses: Vec<Status> = review.plan.iter().map(|line| line.status).collect();
    assert_eq!(statuses[..2], [Status::Passed; 2]);
    // Permission comes when the plan wants it: the paper's mission leaves it to the planner.
    assert!(review.plan[2..].iter().all(|line| line.text.starts_with("assumes ")), "{review:?}");
    assert!(review.status < Status::Failed, "{review:?}");
}

#[test]
fn a_review_crosses_to_the_page_unharmed() {
    for source in [SCENARIO, MISSION, "scenario S[0,10] = { Nothing-Here( }"] {
        let review = reviewed(source);
        let bytes = postcard::to_allocvec(&review).expect("an answer can be written");
        assert_eq!(postcard::from_bytes::<Review>(&bytes).as_ref(), Ok(&review));
    }
}

#[test]
fn path_2_is_impossible_because_nothing_asserts_its_condition() {
    let review = reviewed(SCENARIO);
    let [choice] = review.choices.as_slice() else { panic!("one choice: {:?}", review.choices) };
    assert_eq!(choice.alternatives[0].fate, Fate::Taken);
    let Fate::Impossible { reason, .. } = &choice.alternatives[1].fate else {
        panic!("{:?}", choice.alternatives[1])
    };
    assert!(reason.contains("PATH2") && reason.contains("nothing asserts it"), "{reason}");
}

#[test]
fn an_alternative_that_would_do_as_well_is_said_to() {
    let both = include_str!("../../../tests/conformance/t03_enroute_both_paths.rmpl");
    let review = reviewed(both);
    assert_eq!(review.choices[0].alternatives[0].fate, Fate::Taken);
    assert_eq!(review.choices[0].alternatives[1].fate, Fate::AlsoPossible);
}

#[test]
fn an_alternative_of_a_best_plan_says_what_it_would_come_to() {
    let review = reviewed(
        "primitive Near()[5,5] rewards 3; primitive Far()[20,20] rewards 10;
         scenario S[0,30] = { choose { Near(), Far() }; optional Near() } objective maximize reward, minimize end;",
    );
    assert_eq!(review.choices[0].alternatives[1].fate, Fate::Taken);
    let sentences: Vec<String> =
        review.choices.iter().flat_map(|it| &it.alternatives).map(|it| it.fate.sentence()).collect();
    assert_eq!(
        sentences,
        [
            "not chosen: with it and the previous choices, reward 6, end 10 at best",
            "selected",
            "selected",
            "not chosen: with it and the previous choices, reward 10, end 20 at best"
        ]
    );
}

#[test]
fn the_path_1_condition_outlasts_the_drive_by_up_to_45_minutes() {
    let review = reviewed(SCENARIO);
    let [link] = review.causal_links.as_slice() else { panic!("one link: {:?}", review.causal_links) };
    assert_eq!(
        (link.ask.as_str(), link.tell.as_str()),
        ("Ask(PATH1=OK)@Group-Traverse-Path#1", "Tell(PATH1=OK)@Tell(PATH1=OK)#1")
    );
    // Event 4 is in [10,55] and event 14 at 10; event 15 is at 460 and event 5 in [415,460].
    assert_eq!((link.lead, link.margin), (range(0, 45), range(0, 45)));
}

#[test]
fn the_wait_is_over_1_to_185_minutes_before_permission() {
    let review = reviewed(SCENARIO);
    let [conflict] = review.conflicts.as_slice() else { panic!("one pair: {:?}", review.conflicts) };
    assert!(conflict.first.contains("Group-Wait#1") && conflict.then.contains("Tell(PROCEED=OK)"));
    assert_eq!(conflict.gap, range(1, 185));
    assert!(conflict.is_added);
}

#[test]
fn events_come_with_their_windows_the_tightest_first() {
    let review = reviewed(SCENARIO);
    let slacks: Vec<Bound> = review.events.iter().map(|event| event.slack).collect();
    assert!(slacks.is_sorted(), "{slacks:?}");
    let window = |name: &str| {
        let event = review.events.iter().find(|event| event.name == name);
        let window = event.unwrap_or_else(|| panic!("no {name}")).window;
        (window.earliest, window.latest)
    };
    let expected = |least: i64, greatest: i64| {
        let TimeRange { least, greatest } = range(least, greatest);
        (least, greatest)
    };
    assert_eq!(window("Group-Traverse-Path#1.start"), expected(10, 55));
    assert_eq!(window("Group-Wait#1.end"), expected(415, 514));
    assert_eq!(window("Group-Transmit#1.end"), expected(415, 462));
    assert_eq!(window("Tell(PROCEED=OK)#1.start"), expected(460, 600));
    assert_eq!(window("scenario#1.end"), expected(660, 800));
}

#[test]
fn a_traverse_is_reviewed_with_its_way() {
    let review = reviewed(MISSION);
    let [traverse] = review.traverses.as_slice() else { panic!("one traverse: {:?}", review.traverses) };
    assert_eq!(traverse.vehicles, ["Rover1", "Rover2"]);
    assert_eq!(traverse.places, ["PATH1_1", "PATH1_2", "PATH1_3", "TAI_POS"]);
    // The way is at least as long as the straight lines between its places.
    let straight_m: f64 = [[24.0, 52.0], [44.0, 120.0], [64.0, 214.0], [176.0, 252.0], [256.0, 238.0]]
        .windows(2)
        .map(|pair: &[[f64; 2]]| {
            let (east, north) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
            (east * east + north * north).sqrt()
        })
        .sum();
    assert!(traverse.length_m >= straight_m - 1e-6, "{} < {straight_m}", traverse.length_m);
    assert_eq!(traverse.duration, range(405, 450));
    assert!(traverse.clearance_m.is_none_or(|clearance_m| clearance_m >= 0.0));
}

#[test]
fn a_mission_without_a_plan_says_why_and_what_would_help() {
    let review = reviewed(&SCENARIO.replace("PATH1=OK [450,450]", "PATH1=OK [400,400]"));
    assert_eq!(review.status, Status::Failed);
    assert!(review.plan.iter().any(|line| line.text == "there is no plan"), "{:?}", review.plan);
    assert!(review.plan.iter().any(|line| line.text.contains("PATH1=OK") && line.span.is_some()));
    assert!(review.events.is_empty());
}

#[test]
fn a_time_that_does_not_fit_is_said_to_with_its_event() {
    let huge = "46116860184273*100000";
    let source =
        format!("scenario S = {{ delay[{huge},{huge}]; delay[{huge},{huge}]; delay[{huge},{huge}] }}");
    let review = reviewed(&source);
    let line = &review.plan[0];
    assert_eq!(line.status, Status::Failed);
    // Two of the delays fit: only the third one's end is too late.
    assert!(line.text.ends_with("that of delay#3.end"), "{}", line.text);
}

#[test]
fn errors_of_the_text_fail_the_review_at_their_line() {
    let review = reviewed("scenario S[0,10] = { Nothing-Here( }");
    assert_eq!(review.status, Status::Failed);
    let line = review.warnings.first().expect("the error");
    assert_eq!((line.status, line.line_number), (Status::Failed, Some(1)));
}

#[test]
fn every_line_of_the_plan_leads_to_its_place() {
    let review = reviewed(SCENARIO);
    for section in [Section::Choices, Section::CausalLinks, Section::Conflicts, Section::Events] {
        for line in review.lines(section) {
            assert!(!line.names.is_empty() && !line.nodes.is_empty(), "{line:?}");
        }
    }
    let link = &review.causal_links[0].line;
    let text = link.span.and_then(|span| SCENARIO.get(span.range())).unwrap_or_default();
    assert!(text.contains("PATH1"), "{text}");
}

#[test]
fn the_hash_follows_text_map_and_seed() {
    let map = snapshot::MapKey { asset: "a".into(), cell_mm: 600, origin_mm: [0, 0], version: None };
    let moved = snapshot::MapKey { origin_mm: [1, 0], ..map.clone() };
    let mut digest = [0; 32];
    let imported = [0, 1].map(|last| {
        digest[31] = last;
        snapshot::MapKey { version: Some(digest), ..map.clone() }
    });
    let hashes = [
        content_hash("text", Some(&imported[0]), &Goal::Default, 0),
        content_hash("text", Some(&imported[1]), &Goal::Default, 0),
        content_hash("text", Some(&map), &Goal::Default, 0),
        content_hash("text ", Some(&map), &Goal::Default, 0),
        content_hash("text", Some(&moved), &Goal::Default, 0),
        content_hash("text", None, &Goal::Default, 0),
        content_hash("text", Some(&map), &Goal::Default, 1),
        content_hash("text", Some(&map), &Goal::Scenario("S".into()), 0),
    ];
    for (index, hash) in hashes.iter().enumerate() {
        assert_eq!(hash.len(), 64);
        assert!(!hashes[..index].contains(hash), "{hashes:?}");
    }
    assert_eq!(reviewed(SCENARIO), reviewed(SCENARIO));
}

/// The figure of a built-in map is that of earlier versions, so that their approvals hold. It was computed by another program,
/// from the description in SPEC 16.
#[test]
fn the_hash_of_a_built_in_map_is_that_of_earlier_versions() {
    let map =
        snapshot::MapKey { asset: "mars-ridge".into(), cell_mm: 600, origin_mm: [-1500, 20], version: None };
    assert_eq!(
        content_hash("scenario S = { }", Some(&map), &Goal::Default, 7),
        "bdd077ca1ac6a4e2ae03c778d42f6e9b8ca634f88fb0e62b0c556496883cb417"
    );
}

pub(super) const LASTING: &str = "state ARM : { IN, OUT } = IN;
resource Battery 0..100 = 60;
resource Power capacity 3;
primitive Deploy()[4,8] requires ARM=IN sets ARM=OUT consumes Battery 50 uses Power 2;
primitive Dig()[5,9] requires ARM=OUT uses Power 1;
primitive Charge()[10,20] produces Battery 40 costs 7;
scenario S[0,100] = { Deploy(); Dig(); Charge() }";

fn texts(review: &Review, section: Section) -> Vec<String> {
    review.lines(section).iter().map(|line| line.text.clone()).collect()
}

#[test]
fn states_and_resources_are_reviewed_with_their_margins() {
    let review = reviewed(LASTING);
    assert_eq!(
        texts(&review, Section::States),
        ["all 2 requirements of states are supported", "ARM is IN, then OUT (Deploy#1)",]
    );
    assert_eq!(
        texts(&review, Section::Resources),
        [
            "Battery stays between 10 and 60: 10 above its minimum 0, 40 below its maximum 100",
            "Power: peak use 2 of 3 (1 to spare)",
        ]
    );
    assert!(texts(&review, Section::Plan).contains(&"objective: cost 7".to_owned()), "{:?}", review.plan);
    assert_eq!(review.status, Status::Passed, "{review:?}");
    assert_eq!(
        texts(&review, Section::CausalLinks),
        [
            "ARM=IN holds from the start, 0 min before Deploy#1 needs it; Deploy#1 itself changes it then",
            "Deploy#1 sets ARM=OUT 0 min before Dig#1 needs it; nothing changes it later",
        ]
    );
}

/// The review of a mission's plan, had the checker said this of it.
pub(super) fn reviewed_with(source: &str, verdict: Option<verify::Verdict>) -> Review {
    let snapshot = snapshot(source);
    let planning = snapshot.planning.as_deref().expect("it was planned").clone();
    let planning = snapshot::Planning { verdict, ..planning };
    let changed = Snapshot { planning: Some(Arc::new(planning)), ..(*snapshot).clone() };
    review(&changed, &Goal::Default, 0, &mut || false)
}

pub(super) fn refused() -> verify::Verdict {
    verify::Verdict { valid: false, violations: Vec::new() }
}

/// The review of a drive of 36 m that takes 1 for each meter of a battery with so much.
fn driving(terrain: &str, level: i64) -> Review {
    reviewed(&format!(
        "{terrain} location A (30, 60); location B (66, 60); vehicle R : ATRV-Jr at A; resource Battery 0..200 = {level};
        primitive Drive(to)[5,60] moves R speed (0.01, 0.5) consumes Battery 1 per metre; scenario S[0,100] = {{ Drive(B) }}"
    ))
}

/// The review of a drive with a battery through a gap of so many meters between long walls, on a map without rocks or without one.
fn through_a_gap(terrain: &str, gap_m: i64) -> Review {
    let (south, north) = (60 - gap_m / 2, 60 + gap_m / 2);
    reviewed(&format!(
        "{terrain} location A (30, 60); location B (66, 60); vehicle R : ATRV-Jr at A; resource Battery 0..200 = 100;
        obstacle NORTH polygon (46, {north}, 50, {north}, 50, 110, 46, 110);
        obstacle SOUTH polygon (46, 10, 50, 10, 50, {south}, 46, {south});
        primitive Drive(to) contingent [5,60] moves R speed (0.01, 0.5) consumes Battery 1 per metre; scenario S[0,100] = {{ Drive(B) }}"
    ))
}

#[test]
fn what_depends_on_a_path_that_a_rock_could_close_has_not_passed() {
    let terrain = "terrain \"flat\" cell 0.6 origin (0, 0);";
    let lines = |review: &Review| {
        let controllable =
            review.plan.iter().find(|line| line.text.starts_with(DYNAMIC) || line.text.starts_with(STRONG));
        [
            review.traverses[0].line.clone(),
            review.resources[0].line.clone(),
            controllable.expect("it is contingent").clone(),
        ]
    };
    for line in lines(&through_a_gap(terrain, 4)) {
        assert_eq!(line.status, Status::Attention, "{line:?}");
        assert!(line.text.contains("rocks that the map does not show could close its path"), "{line:?}");
    }
    for (terrain, gap_m) in [(terrain, 12), ("", 4)] {
        for line in lines(&through_a_gap(terrain, gap_m)) {
            assert_eq!(line.status, Status::Passed, "{line:?}");
        }
    }
}

#[test]
fn a_reservoir_has_room_for_detours_where_the_map_may_leave_out_rocks() {
    let terrain = "terrain \"tai-plain\" cell 0.6 origin (0, 0);";
    let tight = driving(terrain, 45);
    assert!(tight.resources.is_empty() && tight.status == Status::Failed, "{tight:?}");
    let reasons = format!("{tight:?}");
    assert!(
        reasons.contains("depending on the distance that is really driven, Drive(B) takes 28."),
        "{reasons}"
    );
    for (terrain, level) in [(terrain, 70), ("", 45)] {
        let enough = driving(terrain, level).resources[0].line.clone();
        assert_eq!(enough.status, Status::Passed, "{enough:?}");
        assert!(
            enough.text.ends_with("; for every distance that drives may take along their paths"),
            "{enough:?}"
        );
    }
}

#[test]
fn no_drive_passes_on_very_rocky_ground() {
    let review = driving("terrain \"noachian-highland\" cell 0.6 origin (0, 0);", 150);
    for line in [&review.traverses[0].line, &review.resources[0].line] {
        assert_eq!(line.status, Status::Attention, "{line:?}");
        assert!(line.text.contains("rocks that the map does not show could close its path"), "{line:?}");
    }
}

#[test]
fn nothing_about_states_and_resources_has_passed_on_the_planner_s_word() {
    for (verdict, status) in [(None, Status::Attention), (Some(refused()), Status::Failed)] {
        let review = reviewed_with(LASTING, verdict);
        for section in [Section::States, Section::Resources, Section::CausalLinks] {
            let lines = review.lines(section);
            assert!(!lines.is_empty() && lines.iter().all(|line| line.status == status), "{lines:?}");
        }
    }
}

#[test]
fn that_a_plan_withstands_nature_has_not_passed_on_the_planner_s_word() {
    let source = "primitive Drive() contingent [20,40]; scenario S[0,60] = { Drive(); delay }";
    for (verdict, status) in [(None, Status::Attention), (Some(refused()), Status::Failed)] {
        let review = reviewed_with(source, verdict);
        let line = review.plan.iter().find(|line| line.names == ["Drive#1"]).expect("nature chooses");
        assert_eq!(line.status, status, "{line:?}");
        assert!(line.text.contains("is not verified"), "{line:?}");
    }
}

#[test]
fn a_contingent_drive_that_rocks_may_hold_up_beyond_its_range_needs_attention() {
    let controllable = |terrain: &str, most: &str| {
        let source = format!(
            "{terrain} location A (20, 20); location B (50, 20); vehicle R : ATRV at A;
             primitive Drive(to) contingent [1,{most}] moves R; primitive Walk() contingent [1,2];
             scenario S[0,60] = {{ {{ Drive(B); delay }}, {{ Walk(); delay }} }}"
        );
        line(&source, "dynamically controllable").expect("nature chooses")
    };
    let mapped = "terrain \"flat\" cell 0.6;";
    let (status, text) = controllable(mapped, "1.2");
    assert_eq!(status, Status::Attention, "{text}");
    assert!(text.ends_with("; slow driving in Drive(B) may make the plan late"), "{text}");
    // With more time, or without a map that may leave out rocks, nothing extends it.
    for (terrain, most) in [(mapped, "9"), ("", "1.2")] {
        assert_eq!(controllable(terrain, most).0, Status::Passed);
    }
}

#[test]
fn a_drive_that_others_cannot_wait_for_needs_attention() {
    let drive = |scenario: &str| {
        let order = if scenario.contains("First") {
            "constrain First.start to Then.start [0,500]; constrain First.end to Then.end [0,500];"
        } else {
            ""
        };
        let source = format!(
            "location A (20, 20); location B (50, 20); vehicle R : ATRV at A; var SKY : {{OK, BAD}};
             primitive Drive(to)[0,200] moves R speed (0.1, 0.5) requires SKY=OK;
             primitive Free(to)[0,200] moves R speed (0.1, 0.5);
             primitive Walk() contingent [1,4]; primitive Rest()[10,10]; primitive Wait()[0,20];
             {order} scenario S[0,600] = {scenario}"
        );
        let review = reviewed(&source);
        let line = &review.traverses.first().expect("a drive").line;
        let is_late = line.text.ends_with("; slow driving, up to 1.4 min, may make the plan late");
        assert_eq!(line.status == Status::Attention, is_late, "{}", line.text);
        line.status
    };
    // 30 m at 0.5 m/s are one minute, and may take up to 1.39 min.
    let cases = [
        // The whole plan has to wait, together with what the environment chooses.
        ("{ { { Walk(); Free(B) } [0,5.2] }; delay }", Status::Attention),
        ("{ { { Walk(); Free(B) } [0,5.4] }; delay }", Status::Passed),
        ("{ { { Walk(); Free(B) } [0,5.4] }; { delay[0,2]; Rest() } }", Status::Passed),
        // The sky is to be clear no longer than needed, and has to be before the drive sets out.
        ("{ { Rest(); Drive(B) }, { delay; SKY=OK [4,4] } }", Status::Attention),
        ("{ Drive(B), { SKY=OK [4,4] } }", Status::Passed),
        // What ends when it will can wait for the drive, but then the wait before it was too early.
        ("{ { Rest(); Free(B) as First }, { delay; { Wait(); Walk() as Then } [0,6] } }", Status::Attention),
        ("{ { Rest(); Free(B) as First }, { delay; { Wait(); Walk() as Then } } }", Status::Passed),
    ];
    for (scenario, status) in cases {
        assert_eq!(drive(scenario), status, "{scenario}");
    }
}

/// A path to an occupied place depends on the order of arrival, so another order may be better.
#[test]
fn a_plan_whose_vehicles_stop_beside_each_other_is_not_called_optimal() {
    let objective = |goal: &str| {
        let source = format!(
            "location A (0, 0); location B (40, 0); location C (40, 30); location D (0, 30);
             vehicle R1 : ATRV at A; vehicle R2 : ATRV at C; primitive Drive(r, to)[1,60] moves r;
             objective minimize length; scenario S[0,200] = {{ unordered {{ Drive(R1, B); Drive(R2, {goal}) }} }}"
        );
        line(&source, "objective: ").expect("a plan")
    };
    let (status, text) = objective("B");
    assert_eq!(status, Status::Attention, "{text}");
    assert!(text.contains("not proven optimal: in another order"), "{text}");
    let (status, text) = objective("D");
    assert_eq!(status, Status::Passed, "{text}");
    assert!(text.ends_with("optimal: no better plan exists"), "{text}");
}

/// What may hold up a drive is said of it, and of the line on controllability.
#[test]
fn drives_that_others_may_hold_up_need_attention() {
    let source = "location A (0, 20); location B (40, 20); location C (20, 0); location D (20, 40);
         vehicle R1 : ATRV at A; vehicle R2 : ATRV at C; primitive Drive(r, to) contingent [3,30] moves r;
         scenario S[0,100] = { Drive(R1, B), Drive(R2, D) }";
    let review = reviewed(source);
    let drives: Vec<(Status, &str)> =
        review.traverses.iter().map(|it| (it.line.status, it.line.text.as_str())).collect();
    let plan = line(source, "dynamically controllable").expect("nature chooses");
    let lines = drives.into_iter().chain([(plan.0, plan.1.as_str())]);
    let ends = [
        "; R2 may be in its way",
        "; R1 may be in its way",
        "; vehicles that come too close may delay each other beyond that",
    ];
    for ((status, text), end) in lines.zip(ends) {
        assert_eq!(status, Status::Attention, "{text}");
        assert!(text.ends_with(end), "{text}");
    }
}

#[test]
fn a_formation_sets_out_from_one_location() {
    let mission = |first: &str| {
        reviewed(&format!(
            "location A (0, 0); location B (30, 0); location C (0, 40); vehicle R1 : ATRV at A; vehicle R2 : ATRV at B;
             primitive Drive(r, to)[1,60] moves r; primitive Convoy(to)[1,60] moves R1, R2;
             scenario S[0,200] = {{ {first} Convoy(C) }}"
        ))
    };
    let texts_of = |review: &Review| -> Vec<(Status, String)> {
        review.separation_violations.iter().map(|line| (line.status, line.text.clone())).collect()
    };
    let expected =
        "Convoy(C) sets out in formation behind R1 from A, but R2 is at B; drive it to A first".to_owned();
    let scattered = mission("");
    assert_eq!(texts_of(&scattered), [(Status::Failed, expected)]);
    let drives = scattered.traverses.iter().map(|it| (it.line.status, it.may_be_late)).collect::<Vec<_>>();
    assert_eq!(drives, [(Status::Attention, true)]);
    let drive = &scattered.traverses[0].line.text;
    assert!(drive.ends_with("; R2 is at B when it sets out"), "{drive}");
    assert_eq!(texts_of(&mission("Drive(R2, A); delay;")), []);
}

#[test]
fn what_comes_after_a_formation_that_cannot_set_out_is_not_controllable() {
    let mission = |start: &str| {
        line(
            &format!(
                "location A (0, 0); location B (30, 0); vehicle R1 : ATRV at A; vehicle R2 : ATRV at {start};
                 primitive Convoy(to)[1,90] moves R1, R2; primitive Wait() contingent [1,2];
                 scenario S[0,200] = {{ Wait(); delay; Convoy(B) }}"
            ),
            "dynamically controllable",
        )
        .expect("something is contingent")
    };
    assert_eq!(mission("A").0, Status::Passed);
    let (status, text) = mission("B");
    assert_eq!(status, Status::Attention);
    assert!(text.ends_with("; not every formation can set out as planned"), "{text}");
}

#[test]
fn a_vehicle_s_movements_come_one_after_the_other() {
    let review = reviewed(
        "location BASE (0, 0); location ROCK (10, 0);
         vehicle R1 : ATRV-Jr at BASE;
         primitive Drive(to)[1,90] moves R1;
         scenario S[0,500] = { Drive(ROCK); Drive(BASE) }",
    );
    let lines = texts(&review, Section::States);
    let wanted = "R1 makes 2 movements, one after the other: Drive(ROCK), Drive(BASE)".to_owned();
    assert!(lines.contains(&wanted), "{lines:?} {:?}", review.plan);
}

/// The line of a mission's review that begins so.
fn line(source: &str, start: &str) -> Option<(Status, String)> {
    let review = reviewed(source);
    let found = review.plan.iter().find(|line| line.text.starts_with(start));
    found.map(|line| (line.status, line.text.clone()))
}

#[test]
fn what_nature_chooses_has_the_first_line_of_its_own() {
    let drive = |option: &str, most: i64| {
        format!(
            "{option} primitive Drive() contingent [20,40]; primitive Dig()[5,5];
             scenario S[0,{most}] = {{ Drive(); delay; Dig() }}"
        )
    };
    let (status, text) = line(&drive("", 60), "dynamically controllable").expect("nature chooses");
    assert_eq!(status, Status::Passed);
    assert!(text.ends_with("Drive#1 [20, 40]"), "{text}");
    // A schedule that does not look is harder to find, and here the drive's end is what the delay waits for.
    assert!(line(&drive("option controllability = strong;", 60), "strongly controllable").is_some());
    // What is planned as if the environment did not choose is never passed.
    let none = line(&drive("option controllability = none;", 44), "the plan chooses contingent durations");
    assert_eq!(none.expect("it is said").0, Status::Attention);
    // And what the environment can break has no plan.
    assert!(line(&drive("", 44), "whatever").is_none());
    assert!(line(&drive("", 44), "there is no plan").is_some());
    assert!(line(SCENARIO, "whatever").is_none(), "the paper's mission leaves nothing to nature");
}

#[test]
fn what_a_plan_assumes_is_for_attention() {
    let storm = |delay: &str| {
        format!(
            "var DUST : {{CLEAR, STORM}}; primitive Survey()[20,30];
             scenario S[0,200] = {{ {{ delay; do {{ Survey() }} watching DUST=STORM }}, {{ delay {delay}; DUST=STORM [10,10] }} }}"
        )
    };
    let (status, text) = line(&storm("[5,100]"), "assumes").expect("the plan moves the storm");
    assert_eq!(status, Status::Attention);
    assert!(text.contains("[5,100]"), "{text}");
    assert!(line(&storm("contingent [5,100]"), "assumes").is_none());
}
