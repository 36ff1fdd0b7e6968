//! Durations that the environment chooses, in the network (SPEC 13.1): which arcs are the environment's, what plain
//! bounds require of them, and what a path makes of a drive. Known answers are worked out by hand.

use acceptance::mission::{compile, error_codes, network, try_plans};
use exact::{Bound, Rational, Time};
use kirk::{Search, Status};
use rmpl::program::Controllability;
use tpn::path::{PathLeg, TraversePath};
use tpn::{ArcKind, BlockKind, Network, Top};

/// Every arc that takes time or is the environment's: the name of what it belongs to or its kind, and its bounds.
fn arcs(network: &Network) -> Vec<String> {
    let mut found = Vec::new();
    for arc in &network.arcs {
        let is_glue = matches!(arc.kind, ArcKind::Glue | ArcKind::Fork | ArcKind::Join);
        if is_glue && !arc.is_contingent {
            continue;
        }
        let name = arc.occurrence.map_or("-", |owner| network.occurrences[owner.index()].name.as_str());
        let word = if arc.is_contingent { "contingent " } else { "" };
        found.push(format!("{name} {word}[{},{}]", Bound::Finite(arc.lower), arc.upper));
    }
    found
}

#[track_caller]
fn compiles_to(text: &str, wanted: &[&str]) {
    assert_eq!(arcs(&network(text)), wanted, "{text}");
}

const DRIVE: &str = "primitive Drive() contingent [20,40]; var L : {A, B};";

#[test]
fn activities_assertions_and_delays_are_natures() {
    compiles_to(
        "const N = 4; primitive Drive(n) contingent [n,2*n];\
         scenario S = { Drive(3); delay contingent [N,50%*10]; L=A contingent [1,1h]; ask L=A contingent [0,0] }",
        &[
            "Drive#1 contingent [3,6]",
            "delay#1 contingent [4,5]",
            "Tell(L=A)#1 contingent [1,60]",
            "Ask(L=A)#1 contingent [0,0]",
        ],
    );
    compiles_to(
        "primitive Talk()[1,30]; scenario S = { Talk() contingent [2,30]; Nowhere() contingent [1,2] }",
        &["Talk#1 contingent [2,30]", "Nowhere#1 contingent [1,2]"],
    );
}

#[test]
fn bounds_of_the_defined_activity_around_are_put_in() {
    compiles_to(
        "primitive Drive(); Survey()[l,u] = { Drive() contingent [l,u*90%] } scenario S = { Survey()[9,20] }",
        &["Survey#1 [9,20]", "Drive#1 contingent [9,18]"],
    );
    // As a parameter, too.
    compiles_to(
        &format!("{DRIVE} Twice(A) = {{ A; A contingent [25,30] }} scenario S = {{ Twice(Drive) }}"),
        &["Twice#1 [0,inf]", "Drive#1 contingent [20,40]", "Drive#2 contingent [25,30]"],
    );
}

/// The environment's range stays; the bounds span the same events.
#[test]
fn plain_bounds_of_a_call_and_of_a_block_around_it_are_requirements() {
    for body in ["Drive()[30,35]", "{ Drive() }[30,35]"] {
        let text = format!("{DRIVE} scenario S = {{ {body} }}");
        compiles_to(&text, &["- [30,35]", "Drive#1 contingent [20,40]"]);
        let network = network(&text);
        let [required, drive] = network.arcs.as_slice() else { panic!("two arcs") };
        assert_eq!((required.from, required.to, required.kind), (drive.from, drive.to, ArcKind::Span));
        assert_eq!(drive.kind, ArcKind::Activity);
        let is_scope = |kind: &BlockKind| matches!(kind, BlockKind::Scope { arcs, .. } if arcs.len() == 1);
        assert!(network.blocks.iter().any(|block| is_scope(&block.kind)));
    }
    // Where nothing is in both, the plan fails and not the compilation.
    compiles_to(
        &format!("{DRIVE} scenario S = {{ Drive()[1,2] }}"),
        &["- [1,2]", "Drive#1 contingent [20,40]"],
    );
    // What is required while it continues is a label of the environment's arc.
    let network =
        network(&format!("{DRIVE} scenario S = {{ do Drive()[30,35] maintaining L=A, L=A[1,50] }}"));
    let labeled: Vec<_> = network.labels.iter().map(|label| &network.arcs[label.arc.index()]).collect();
    assert!(labeled.iter().any(|arc| arc.is_contingent && arc.kind == ArcKind::Activity));
    assert!(labeled.iter().all(|arc| arc.kind != ArcKind::Span));
}

#[test]
fn a_whole_activity_is_planned_within_bounds_that_are_required() {
    let text = "primitive Drive() contingent [20,40];";
    let top = |lower: i64, upper: Bound| {
        let top = Top::Activity { name: "Drive".into(), lower: Time::from(lower), upper };
        arcs(&compile(text, &top).0.expect("it compiles"))
    };
    assert_eq!(top(0, Bound::Infinite), ["Drive#1 contingent [20,40]"]);
    assert_eq!(top(25, Bound::Finite(Time::from(30))), ["- [25,30]", "Drive#1 contingent [20,40]"]);
}

#[test]
fn what_nature_cannot_choose_is_refused() {
    let code =
        |body: &str| error_codes(&format!("{DRIVE} primitive Talk(n)[n,30]; scenario S = {{ {body} }}"));
    assert_eq!(code("Drive() contingent [10,30]"), ["E-BOUNDS"]);
    assert_eq!(code("Drive() contingent [20,41]"), ["E-BOUNDS"]);
    assert_eq!(code("Drive() contingent [20,40]"), [""; 0]);
    assert_eq!(code("Talk(5) contingent [4,10]"), ["E-BOUNDS"]);
    assert_eq!(code("Talk(5) contingent [5,10]"), [""; 0]);
    assert_eq!(code("delay contingent [2,inf]"), ["E-BOUNDS"]);
    assert_eq!(code("delay contingent [2,1]"), ["E-BOUNDS"]);
    assert_eq!(code("{ Drive(); Drive() } contingent [6,9]"), ["E-CONTINGENT"]);
    assert_eq!(code("do Drive() maintaining L=A contingent [6,9]; L=A"), ["E-CONTINGENT"]);
    assert_eq!(error_codes("const N = inf - 1; scenario S = { delay contingent [1,N] }"), ["E-BOUNDS"]);
    assert_eq!(error_codes("A() = { delay } scenario S = { A() contingent [1,2] }"), ["E-CONTINGENT"]);
    assert_eq!(error_codes("A() contingent [1,2] = { delay } scenario S = { A() }"), ["E-CONTINGENT"]);
    assert_eq!(error_codes("scenario S contingent [1,2] = { delay }"), ["E-CONTINGENT"]);
    // What a parameter represents is known at the call.
    let handed = "A() = { delay } B(x) = { x contingent [1,2] } scenario S = { B(A) }";
    assert_eq!(error_codes(handed), ["E-CONTINGENT"]);
}

#[test]
fn the_option_is_in_the_network_and_survives_with_the_arcs_in_its_file() {
    let text = format!("option controllability = strong; {DRIVE} scenario S = {{ Drive() }}");
    let network = network(&text);
    assert_eq!(network.controllability, Controllability::Strong);
    let again = tpn::network_json::network_from_json(&tpn::network_json::network_to_json(&network)).unwrap();
    assert_eq!(arcs(&again), ["Drive#1 contingent [20,40]"]);
}

/// 100 m at 0.05 to 0.1 m/s take 1000 to 2000 seconds, 16 2/3 to 33 1/3 minutes.
fn with_path(bounds: &str, length_m: f64) -> Network {
    let network = network(&format!(
        "location FAR (100, 0); location BASE (0, 0); vehicle R : ATRV at BASE;\
         primitive Drive(to){bounds} moves R speed (0.05, 0.1); scenario S = {{ Drive(FAR) }}"
    ));
    let occurrence = network.occurrences.iter().position(|it| it.name == "Drive#1").expect("the drive");
    let speed = |hundredths: i64| Rational::new(hundredths, 100).expect("a number");
    let path = TraversePath {
        occurrence: tpn::OccurrenceId::from_index(occurrence),
        legs: vec![PathLeg { segment_lengths_m: vec![length_m / 2.0; 2], slope_speeds_mps: Vec::new() }],
        speed_mps: (speed(5), speed(10)),
        may_stop: false,
    };
    crate::paths::with_path(&network, &path, 60).expect("a sound path")
}

#[test]
fn a_path_raises_what_a_drive_of_natures_takes_and_adds_no_event_of_its_own() {
    let drive = |bounds: &str, length_m: f64| {
        let network = with_path(bounds, length_m);
        assert!(network.arcs.iter().all(|arc| arc.kind != ArcKind::Path));
        assert_eq!(network.nodes.len(), 2);
        let arc = network.arcs.iter().find(|arc| arc.is_contingent).expect("the drive");
        assert_eq!(arc.kind, ArcKind::Activity);
        (arc.lower, arc.upper)
    };
    let minutes = |minutes: i64| Time::from(minutes);
    // 120 m at 0.1 m/s take 20 minutes, less than the environment's least: the range stays.
    assert_eq!(drive(" contingent [25,40]", 120.0), (minutes(25), Bound::Finite(minutes(40))));
    // 180 m take 30.
    assert_eq!(drive(" contingent [25,40]", 180.0), (minutes(30), Bound::Finite(minutes(40))));
    // An ordinary traverse keeps its bounds, and has an event at each vertex.
    let network = with_path("[25,40]", 180.0);
    assert_eq!(network.nodes.len(), 3);
    assert_eq!(network.arcs.iter().filter(|arc| arc.kind == ArcKind::Path).count(), 2);
}

#[test]
fn texts_and_drawings_of_networks_say_what_is_natures() {
    let network = network(&format!("{DRIVE} scenario S = {{ Drive()[30,35] }}"));
    let text = tpn::text::to_text(&network);
    assert!(text.contains("[20,40] contingent act Drive#1"), "{text}");
    assert!(text.contains("[30,35] span"), "{text}");
    let dot = tpn::text::to_dot(&network);
    assert!(dot.contains("[20,40] contingent\\nDrive#1"), "{dot}");
}

// --- 13.3 ----------------------------------------------------------------------------------------------------------

/// The places of the warnings, and the text with the one fix of each applied.
fn exogenous(text: &str) -> (Vec<&str>, String) {
    let (_, diagnostics) = compile(text, &Top::Scenario(None));
    let diagnostics: Vec<_> = diagnostics.into_iter().filter(|it| it.code.0 == "W-EXOGENOUS").collect();
    let places = diagnostics.iter().map(|it| &text[it.span.range()]).collect();
    let mut edits: Vec<_> = diagnostics.iter().flat_map(|it| &it.fixes).flat_map(|it| &it.edits).collect();
    edits.sort_by_key(|edit| edit.span.start);
    let mut mended = text.to_owned();
    for edit in edits.into_iter().rev() {
        mended.replace_range(edit.span.range(), &edit.text);
    }
    (places, mended)
}

/// The branch beside one that calls something.
fn world(branch: &str) -> String {
    format!(
        "const N = 5; const M = 300s; var L : {{A, B}}; var K : {{C, D}}; primitive Dig()[4,4];\n\
         scenario S [0,60] = {{ {{ delay; Dig() }}, {branch} }}"
    )
}

/// The branch is warned of at `place`; its fix makes it `fixed`, of which `left` is still open.
#[track_caller]
fn warned(branch: &str, place: &str, mended: &str, left: &[&str]) {
    let text = world(branch);
    let (places, after) = exogenous(&text);
    assert_eq!(places, [place], "{branch}");
    assert_eq!(after, world(mended), "{branch}");
    assert_eq!(exogenous(&after).0, left, "{after}");
}

#[test]
fn a_branch_that_calls_nothing_and_leaves_a_choice_is_the_worlds() {
    let mends = |branch: &str, place: &str, mended: &str| warned(branch, place, mended, &[]);
    mends("{ delay [5,20]; L=A [10,10] }", "[5,20]", "{ delay contingent [5,20]; L=A [10,10] }");
    mends("{ delay[5,20]; L=A [10,10] }", "[5,20]", "{ delay contingent [5,20]; L=A [10,10] }");
    mends("L=A[10,20]", "[10,20]", "L=A contingent [10,20]");
    mends("ask L=A [10,20]", "[10,20]", "ask L=A contingent [10,20]");
    mends(
        "{ delay[1,1]; L=A [N,2*N]; L=B [1,2] }",
        "[N,2*N]",
        "{ delay[1,1]; L=A contingent [N,2*N]; L=B contingent [1,2] }",
    );
    // Inside whatever it is built of, and with the word already in some places.
    mends(
        "repeat 2 { { delay [1,2], delay contingent [2,3] } }",
        "[1,2]",
        "repeat 2 { { delay contingent [1,2], delay contingent [2,3] } }",
    );
    mends("L=A and K=C[1,2]", "[1,2]", "L=A and K=C contingent [1,2]");
}

/// The environment chooses from finite bounds: what has none, the author has to say.
#[test]
fn a_wait_without_an_end_leaves_a_choice_that_no_fix_can_take() {
    warned("{ delay; L=A [10,10] }", "delay", "{ delay; L=A [10,10] }", &["delay"]);
    warned("{ delay[5,inf]; L=A [10,10] }", "[5,inf]", "{ delay[5,inf]; L=A [10,10] }", &["[5,inf]"]);
    warned("{ delay; L=A [10,12] }", "delay", "{ delay; L=A contingent [10,12] }", &["delay"]);
    let (_, diagnostics) = compile(&world("{ delay; L=A [10,12] }"), &Top::Scenario(None));
    let found = diagnostics.iter().find(|it| it.code.0 == "W-EXOGENOUS").and_then(|it| it.hint.as_deref());
    assert!(found.is_some_and(|hint| hint.contains("`delay contingent [0,30]`")), "{found:?}");
}

#[test]
fn a_branch_that_leaves_no_choice_or_acts_for_the_mission_is_none_of_the_worlds() {
    let none = |branch: &str| {
        let text = world(branch);
        let (_, diagnostics) = compile(&text, &Top::Scenario(None));
        assert!(diagnostics.iter().all(|it| it.code.0 != "W-EXOGENOUS"), "{branch}: {diagnostics:?}");
    };
    none("{ delay [30,30]; L=A [15,15] }");
    none("{ delay [N,5]; L=A [M,N]; L=B }");
    none("{ delay contingent [5,20]; L=A contingent [10,12] }");
    none("{ delay [5,20]; L=A [10,10]; Dig() }");
    none("{ delay [5,20]; Dig }");
    none("{ delay [5,20]; choose { L=A, { L=A; Dig() } } }");
}

/// The planner would take the weather that suits it. No word makes that the environment's yet, so that there is no fix.
#[test]
fn a_branch_that_chooses_what_the_world_does_is_the_worlds() {
    let warned_of = |branch: &str, places: &[&str]| {
        let text = world(branch);
        let (found, after) = exogenous(&text);
        assert_eq!(found, places, "{branch}");
        assert_eq!(after, text, "{branch}: no fix changes what is chosen");
    };
    warned_of("choose { L=A [60,60], L=B [60,60] }", &["choose"]);
    warned_of("{ delay [5,5]; choose { { L=A [5,5]; L=B [5,5] }, L=B } }", &["choose"]);
    warned_of("repeat 2 { choose { L=A [5,5], L=B [5,5], { } } }", &["choose"]);
    // What the text or a condition decides, what is optional, and what acts for the mission is not.
    warned_of("choose { L=A [60,60] }", &[]);
    warned_of("{ K=C [9,9]; if K=C thennext L=A else L=B }", &[]);
    warned_of("optional L=A [60,60]", &[]);
    warned_of("ask L=A or L=B [5,5]", &[]);
    warned_of("choose { L=A [60,60], { L=B; Dig() } }", &[]);
    // Times and alternatives are told of apart: a fix of the one leaves the other.
    let text = world("choose { delay [1,2], L=A [4,4] }");
    let (places, after) = exogenous(&text);
    assert_eq!(places, ["[1,2]", "choose"]);
    assert_eq!(after, world("choose { delay contingent [1,2], L=A [4,4] }"));
    let (_, diagnostics) = compile(&text, &Top::Scenario(None));
    assert!(
        diagnostics
            .iter()
            .any(|it| it.message.ends_with("event happens: one of the 2 alternatives of `choose`"))
    );
}

/// Members, orders and activities are as good as alternatives and statements that are written out.
#[test]
fn what_the_world_does_is_the_worlds_however_it_is_written() {
    let told = |rest: &str| {
        let text = format!(
            "var L : {{A, B}}; group G = A, B; group One = A; primitive Dig()[4,4] requires L=A;
             Weather() = {{ choose {{ L=A [60,60], L=B [60,60] }} }} Late() = {{ delay[2,9]; Storm() }}
             Storm() = {{ L=B [5,5] }} Rain() = {{ Storm(); Dig() }} {rest}"
        );
        exogenous(&text).0.iter().map(|&place| place.to_owned()).collect::<Vec<String>>()
    };
    let scenario = |branch: &str| told(&format!("scenario S[0,60] = {{ {{ delay; Dig() }}, {branch} }}"));
    assert_eq!(scenario("any x in G { L=x [60,60] }"), ["any"]);
    assert_eq!(scenario("unordered { L=A [20,20]; L=B [20,20] }"), ["unordered"]);
    assert_eq!(scenario("each x in G unordered { L=x [20,20] }"), ["each"]);
    assert_eq!(scenario("Weather()"), ["choose"]);
    assert_eq!(scenario("{ delay[1,1]; Late() }"), ["[2,9]"]);
    // One member leaves no choice, the order of a sequence neither, and what digs is the mission.
    for branch in
        ["any x in One { L=x [60,60] }", "each x in G in sequence { L=x [20,20] }", "Storm()", "Rain()"]
    {
        assert_eq!(scenario(branch), [""; 0], "{branch}");
    }
}

#[test]
fn every_branch_of_the_worlds_is_told_of_once_and_a_scenario_of_one_branch_has_one() {
    let (places, _) = exogenous(
        "var L : {A, B}; var K : {C, D}; primitive Dig()[4,4];\
         scenario S = { Dig(), { delay[1,2]; L=A [3,4] }, K=C [5,6] }",
    );
    assert_eq!(places, ["[1,2]", "[5,6]"]);
    assert_eq!(exogenous("var L : {A, B}; scenario S = { delay[1,2]; L=A [3,4] }").0, ["[1,2]"]);
    // What is planned for an activity has no scenario.
    let text = "var L : {A, B}; Wait() = { delay[1,2]; L=A [3,4] }";
    let (_, diagnostics) = compile(text, &Top::activity("Wait"));
    assert!(diagnostics.iter().all(|it| it.code.0 != "W-EXOGENOUS"), "{diagnostics:?}");
}

/// What comes at one time in every schedule is put in order, whatever the environment chooses elsewhere (SPEC 10.4).
#[test]
fn what_comes_at_one_time_is_in_order_beside_a_contingent_duration() {
    let texts = [
        "resource R capacity 1; primitive A()[2,2] uses R; primitive B()[1,1] uses R;
         scenario S[0,14] = { { W() }, { delay[3,3]; A() }, { delay[5,5]; B() } }",
        "resource R capacity 1; primitive A()[0,0] uses R; primitive B()[0,0] uses R; primitive C()[0,0] uses R;
         scenario S[0,14] = { { W() }, { delay[5,5]; A() }, { delay[5,5]; B(); C() } }",
        "resource T 1..6 = 2; primitive A()[0,0] consumes T 3; primitive B()[0,0] produces T 2;
         scenario S[0,14] = { { W() }, { delay[5,5]; B() }, { delay[5,5]; A() } }",
        "resource T 1..6 = 2; primitive A()[0,0] consumes T 3 produces T 2; primitive B()[0,0] produces T 2;
         scenario S[0,14] = { { W(); B() }, { delay; A() } }",
        "resource T 0..9 = 4; primitive A()[0,0] requires T >= 4; primitive B()[0,0] consumes T 2;
         scenario S[0,14] = { { W() }, { delay[5,5]; A() }, { delay[5,5]; B() } }",
        "resource T 0..9 = 4; primitive A()[2,2] requires T >= 4; primitive B()[0,0] consumes T 2;
         scenario S[0,14] = { { W() }, { delay[5,5]; A() }, { delay[7,7]; B() } }",
        "resource T 0..2 = 2; primitive A()[1,1] consumes T 1 produces T 1; primitive B() produces T 0;
         scenario S[0,7] = { { W() }, { B()[1,1] }, { delay[0,2]; A() } }",
        "var X : {A, B}; scenario S[0,14] = { { delay[0,5]; do V() maintaining not X=A; X=A [3,3] }, { X=B [0,1] } }",
    ];
    for text in texts {
        let text = format!("primitive W() contingent [0,1]; primitive V() contingent [0,0]; {text}");
        let network = network(&text);
        for search in [Search::BestFirst, Search::Chronological, Search::ConflictDirected] {
            let outcome = try_plans(&network, search, false).unwrap_or_else(|why| panic!("{why}: {text}"));
            assert_eq!(outcome.status, Status::Plan, "{text}");
        }
    }
}
