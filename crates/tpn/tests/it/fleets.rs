//! Vehicles with their own equipment, groups, and what parameters represent (SPEC 17): each compiles to the network of
//! the mission that is written out, and each mistake is told at its place.

use rmpl::Severity;
use tpn::{LabelId, Network, Top};

/// The network, and the errors and notes of both stages.
fn compiled(text: &str) -> (Option<Network>, Vec<(&'static str, String, String)>) {
    let parsed = rmpl::parse(text);
    let mut diagnostics = parsed.diagnostics();
    let (network, found) = tpn::compile(&parsed.program(), &Top::Scenario(None));
    tpn::merge_diagnostics(&mut diagnostics, found);
    diagnostics.sort_by_key(|it| it.span);
    let told = diagnostics.into_iter().filter(|it| it.severity != Severity::Warning);
    let told = told.map(|it| (it.code.0, text[it.span.range()].to_owned(), it.message));
    (network, told.collect())
}

#[track_caller]
fn network(text: &str) -> Network {
    let (network, told) = compiled(text);
    network.unwrap_or_else(|| panic!("{text}\n{told:?}"))
}

/// Everything of a network but where it is written.
fn meaning(network: &Network) -> Vec<String> {
    let arcs = network.arcs.iter().map(|arc| {
        let labels: Vec<String> =
            arc.labels.iter().map(|&label| network.label_name(LabelId::from_index(label.index()))).collect();
        format!("{}→{} [{},{}] {:?} {labels:?}", arc.from.0, arc.to.0, arc.lower, arc.upper, arc.kind)
    });
    let occurrences = network.occurrences.iter().map(|it| format!("{} {:?}", it.name, it.arguments));
    let resources = network.resources.iter().map(|it| format!("{} {:?}", it.name, it.supply));
    let uses = network.uses.iter().map(|it| {
        let name = &network.resources[it.resource.index()].name;
        format!("{name} {:?} {} {} {}→{}", it.change, it.amount, it.per_meter, it.start.0, it.end.0)
    });
    arcs.chain(occurrences).chain(resources).chain(uses).collect()
}

/// `short` means what `long` says. In `long`, `R1-battery` represents `R1.battery` and `S-1` for `S[1]`.
#[track_caller]
fn same(short: &str, long: &str) {
    let mut short_meaning = meaning(&network(short));
    for line in &mut short_meaning {
        for part in ["battery", "arm", "drill", "light"] {
            *line = line.replace(&format!(".{part}"), &format!("-{part}"));
        }
        for number in 1..=4 {
            *line = line.replace(&format!("S[{number}]"), &format!("S-{number}"));
        }
    }
    assert_eq!(short_meaning, meaning(&network(long)), "{short}\n{long}");
}

/// The errors and notes of a text: code, place and message.
#[track_caller]
fn tells(text: &str, expected: &[(&str, &str, &str)]) {
    let (network, told) = compiled(text);
    let shown: Vec<(&str, &str, &str)> =
        told.iter().map(|(code, place, message)| (*code, place.as_str(), message.as_str())).collect();
    assert_eq!(shown, expected, "{text}");
    assert!(network.is_none() || expected.is_empty(), "{text}");
}

const WORLD: &str = "location BASE (0, 0); location ROCK (9, 9);\n";

#[test]
fn each_vehicle_has_its_own_copy_of_what_its_model_has() {
    same(
        &format!(
            "{WORLD}
             model Rover {{ resource battery 20..100 = 84; resource arm; }}
             model Scout extends Rover {{ state drill : {{STOWED, OUT}} = STOWED; }}
             vehicle R1, R2 : Scout at BASE; vehicle T : Rover at ROCK;
             primitive Dig()[1,2] requires R1.drill=STOWED uses R1.arm sets R2.drill=OUT consumes T.battery 3;
             scenario S[0,9] = {{ do {{ Dig() }} using T.arm; do {{ delay[1,1] }} maintaining R2.drill=OUT }}"
        ),
        &format!(
            "{WORLD}
             resource R1-battery 20..100 = 84; resource R1-arm; state R1-drill : {{STOWED, OUT}} = STOWED;
             resource R2-battery 20..100 = 84; resource R2-arm; state R2-drill : {{STOWED, OUT}} = STOWED;
             resource T-battery 20..100 = 84; resource T-arm;
             vehicle R1 : ATRV at BASE; vehicle R2 : ATRV at BASE; vehicle T : ATRV at ROCK;
             primitive Dig()[1,2] requires R1-drill=STOWED uses R1-arm sets R2-drill=OUT consumes T-battery 3;
             scenario S[0,9] = {{ do {{ Dig() }} using T-arm; do {{ delay[1,1] }} maintaining R2-drill=OUT }}"
        ),
    );
}

#[test]
fn a_parameter_stands_for_a_resource_a_state_or_the_vehicle_that_has_them() {
    let own = "model Scout { resource battery 0..9 = 5; state drill : {STOWED, OUT} = STOWED; }
               vehicle R1, R2 : Scout at BASE;";
    let (direct, handed) = (
        format!(
            "{WORLD}{own} primitive Work(a, b)[1,2] consumes R1.battery 2, R2.battery 1 sets R1.drill=OUT;
             scenario S[0,9] = {{ Work(R1.battery, R1) }}"
        ),
        format!(
            "{WORLD}{own} primitive Work(a : resource, b)[1,2] consumes a 2, R2.battery 1 sets b.drill=OUT;
             scenario S[0,9] = {{ Work(R1.battery, R1) }}"
        ),
    );
    assert_eq!(meaning(&network(&handed)), meaning(&network(&direct)));
    let through = format!(
        "{WORLD}{own} primitive Work(a, b)[1,2] consumes a 2, R2.battery 1 sets b.drill=OUT;
         Shift(r) = {{ Work(r.battery, r) }} scenario S[0,9] = {{ Shift(R1) }}"
    );
    let uses = |text: &str| {
        meaning(&network(text)).into_iter().filter(|it| it.contains("Consumes")).collect::<Vec<_>>()
    };
    assert_eq!(uses(&through).len(), 2);
    assert!(uses(&through)[0].starts_with("R1.battery Consumes 2"), "{:?}", uses(&through));
    tells(
        &format!(
            "{WORLD} resource bat 0..9 = 5; primitive Work(r)[1,2] consumes r 2; scenario S[0,9] = {{ Work(bat) }}"
        ),
        &[],
    );
}

#[test]
fn any_is_a_choice_and_each_is_for_all() {
    let world = |vehicles: &str| {
        format!(
            "{WORLD} vehicle R1 : ATRV at BASE; {vehicles}
        primitive Look(r, to)[1,2] requires r.at=to; primitive Rest(to)[1,2];
        Both(r, to) = {{ Look(r, to); Rest(to) }}"
        )
    };
    let short = format!(
        "{} group G = R1, S, R1, S[2]; group P = ROCK, BASE;",
        world("vehicle S[1..2] : ATRV at ROCK;")
    );
    let long = world("vehicle S-1 : ATRV at ROCK; vehicle S-2 : ATRV at ROCK;");
    for (form, written) in [
        ("any r in G Look(r, BASE)", "choose { Look(R1, BASE), Look(S-1, BASE), Look(S-2, BASE) }"),
        (
            "any r in G { Both(r, BASE) }[1,9]",
            "choose { { Both(R1, BASE) }[1,9], { Both(S-1, BASE) }[1,9], { Both(S-2, BASE) }[1,9] }",
        ),
        ("each r in S Look(r, ROCK)[1,1]", "{ free Look(S-1, ROCK)[1,1], free Look(S-2, ROCK)[1,1] }"),
        ("each r in S in sequence Both(r, ROCK)", "{ Both(S-1, ROCK); Both(S-2, ROCK) }"),
        (
            "each r in S unordered { Look(r, ROCK); Rest(ROCK) }",
            "unordered { { Look(S-1, ROCK); Rest(ROCK) }; { Look(S-2, ROCK); Rest(ROCK) } }",
        ),
        (
            "each to in P in sequence any r in S Look(r, to)",
            "{ choose { Look(S-1, ROCK), Look(S-2, ROCK) }; choose { Look(S-1, BASE), Look(S-2, BASE) } }",
        ),
        (
            "{ any r in S { if r.at=ROCK thennext Rest(ROCK) } }[0,9]",
            "{ choose { if S-1.at=ROCK thennext Rest(ROCK), if S-2.at=ROCK thennext Rest(ROCK) } }[0,9]",
        ),
        (
            "each r in P in sequence any r in S Rest(BASE)",
            "{ choose { Rest(BASE), Rest(BASE) }; choose { Rest(BASE), Rest(BASE) } }",
        ),
    ] {
        same(
            &format!("{short} scenario Sol[0,99] = {{ Rest(BASE); {form} }}"),
            &format!("{long} scenario Sol[0,99] = {{ Rest(BASE); {written} }}"),
        );
    }
}

#[test]
fn a_group_may_be_handed_to_an_activity() {
    let world = "location A (0, 0); vehicle S[1..2] : ATRV at A; vehicle R : ATRV at A; group G = R, S[2];
                 primitive P(r)[1,2] requires r.at=A; All(group) = { each r in group in sequence P(r) }";
    let calls = |body: &str| {
        let network = network(&format!("{world} scenario Sol[0,99] = {{ {body} }}"));
        let calls = network.occurrences.iter().filter(|it| it.activity == "P");
        calls.map(|it| it.arguments[0].to_string()).collect::<Vec<_>>()
    };
    assert_eq!(calls("All(G); All(S)"), ["R", "S[2]", "S[1]", "S[2]"]);
    let (network, told) = compiled(&format!("{world} scenario Sol[0,99] = {{ All(R) }}"));
    assert!(network.is_none());
    assert_eq!(told, [("E-UNDEF", "group".to_owned(), "unknown group `R`".to_owned())]);
}

#[test]
fn a_name_in_each_copy_is_that_copys() {
    let world = "location A (0, 0); vehicle S[1..2] : ATRV at A; primitive P(r)[1,2]; primitive Q(r)[1,2];";
    let network = network(&format!(
        "{world} constrain X.end to Y.start [3,4];
         scenario Sol[0,99] = {{ each r in S {{ P(r) as X; delay; Q(r) as Y }} }}"
    ));
    let constraints = network.arcs.iter().filter(|arc| arc.kind == tpn::ArcKind::Constraint).count();
    assert_eq!(constraints, 2);
}

#[test]
fn an_argument_of_another_kind_is_told_with_both_places() {
    let world = format!(
        "{WORLD} model Scout {{ resource arm; }} vehicle R1 : Scout at BASE; vehicle T : ATRV at BASE; resource power;
         const N = 3;"
    );
    let call =
        |header: &str, call: &str| format!("{world}\nprimitive P({header};\nscenario S[0,9] = {{ {call} }}");
    tells(
        &call("r : vehicle)[1,2]", "P(ROCK)"),
        &[
            ("E-KIND", "vehicle", "`r` stands for a vehicle because of this"),
            ("E-KIND", "ROCK", "`r` of `P` stands for a vehicle, but `ROCK` is a location"),
        ],
    );
    tells(
        &call("r)[1,2] uses r.arm", "P(ROCK)"),
        &[
            ("E-KIND", "r", "`r` stands for a vehicle because of this"),
            ("E-KIND", "ROCK", "`r` of `P` stands for a vehicle, but `ROCK` is a location"),
        ],
    );
    tells(
        &call("r : Scout)[1,2]", "P(T)"),
        &[
            ("E-KIND", "Scout", "`r` stands for a vehicle of the model `Scout` because of this"),
            ("E-KIND", "T", "`r` of `P` stands for a vehicle of the model `Scout`, but `T` is a vehicle"),
        ],
    );
    for (header, argument) in [
        ("r : location)[1,2]", "R1"),
        ("r : number)[1,2]", "R1"),
        ("r)[1,r]", "ROCK"),
        ("r)[1,2] uses r", "R1"),
        ("r : resource)[1,2]", "3"),
        ("r : vehicle)[1,2]", "N + 1"),
        ("r : vehicle)[1,2]", "X"),
        ("r : condition)[1,2]", "R1"),
        ("r)[1,2] requires R1.at = r", "T"),
    ] {
        let (_, told) = compiled(&call(header, &format!("P({argument})")));
        let codes: Vec<&str> = told.iter().map(|it| it.0).collect();
        assert_eq!(codes, ["E-KIND", "E-KIND"], "{header} {argument} {told:?}");
        assert_eq!(told[1].1, argument, "{told:?}");
    }
    for (header, argument) in [
        ("r : Scout)[1,2]", "R1"),
        ("r : vehicle)[1,2]", "T"),
        ("r : number)[1,2]", "N"),
        ("r : number)[1,2]", "3"),
        ("r : number)[1,2]", "N + 1"),
        ("r : resource)[1,2]", "R1.arm"),
        ("r : resource)[1,2]", "power"),
        ("r : condition)[1,2]", "X = 3"),
        ("r : condition)[1,2]", "Y"),
        ("r)[1,2] requires R1.at = r", "BASE"),
        ("r)[1,2]", "Whatever"),
    ] {
        tells(&call(header, &format!("P({argument})")), &[]);
    }
}

#[test]
fn kinds_are_handed_on_through_calls_and_members() {
    let world = format!(
        "{WORLD} model Scout {{ resource arm; }} model Fast extends Scout {{ speed (0, 2); }}
         vehicle R1 : Scout at BASE; vehicle F : Fast at BASE; vehicle T : ATRV at BASE; group G = R1, T; group H = R1, F;
         primitive P(r : Scout)[1,2] uses r.arm; Q(r) = {{ P(r) }} V(r : vehicle) = {{ P(r) }}"
    );
    let codes = |body: &str| {
        let (_, told) = compiled(&format!("{world}\nscenario S[0,9] = {{ {body} }}"));
        told.into_iter().filter(|it| it.0 == "E-KIND").map(|it| it.1).collect::<Vec<_>>()
    };
    // What `V` requires of its parameter is less than what it needs.
    assert_eq!(codes("Q(R1)"), ["vehicle", "r"]);
    let world = world.replace(" V(r : vehicle) = { P(r) }", "");
    let codes = |body: &str| {
        let (_, told) = compiled(&format!("{world}\nscenario S[0,9] = {{ {body} }}"));
        told.into_iter().filter(|it| it.0 == "E-KIND").map(|it| it.1).collect::<Vec<_>>()
    };
    assert_eq!(codes("Q(R1); Q(F)"), [""; 0]);
    assert_eq!(codes("Q(T)"), ["r", "T"]);
    assert_eq!(codes("each x in G Q(x)"), ["r", "x"]);
    assert_eq!(codes("each x in H Q(x)"), [""; 0]);
    assert_eq!(codes("each x in H { x.at = BASE; delay[x,9] }"), ["x"]);
}

#[test]
fn one_parameter_has_one_kind() {
    tells(
        &format!(
            "{WORLD} vehicle R1 : ATRV at BASE; primitive P(r)[1,r] moves r; scenario S[0,9] = {{ delay }}"
        ),
        &[
            ("E-KIND", "r", "`r` stands for a vehicle, but this needs a number"),
            ("E-KIND", "r", "`r` stands for a vehicle because of this"),
        ],
    );
    tells(
        "primitive P(r : wheel)[1,2]; scenario S[0,9] = { delay }",
        &[("E-KIND", "wheel", "unknown kind `wheel`")],
    );
}

#[test]
fn models_say_nothing_twice_and_nothing_impossible() {
    let model = |body: &str| format!("location A (0, 0); {body} scenario S[0,9] = {{ delay }}");
    let first = |text: &str| {
        let (_, told) = compiled(&model(text));
        let (code, place, _) = told.first().unwrap_or_else(|| panic!("{text}"));
        format!("{code} {place}")
    };
    assert_eq!(first("model A { body 0 x 1; }"), "E-MODEL body 0 x 1");
    assert_eq!(first("model A { slope 70 degrees; }"), "E-MODEL slope 70 degrees");
    assert_eq!(first("model A { slope 2 rad; }"), "E-MODEL slope 2 rad");
    assert_eq!(first("model A { speed (1, 0.5); }"), "E-MODEL speed (1, 0.5)");
    assert_eq!(first("model A { turning 0; }"), "E-MODEL turning 0");
    assert_eq!(first("model A { mast -1; }"), "E-MODEL mast -1");
    assert_eq!(first("model A { clearance 0 m; }"), "E-MODEL clearance 0 m");
    assert_eq!(first("model A { flies (9, 3); }"), "E-MODEL flies (9, 3)");
    assert_eq!(first("model A extends ATRV { flies (3, 9); }"), "E-MODEL flies (3, 9)");
    assert_eq!(first("model A extends Blimp { slope 20; }"), "E-MODEL slope 20");
    assert_eq!(first("model A { mast 1; mast 2; }"), "E-DUP mast 2");
    assert_eq!(first("model A { resource b; } model B extends A { state b : {X} = X; }"), "E-DUP b");
    assert_eq!(first("model A { resource b; resource b; }"), "E-DUP b");
    assert_eq!(first("model A { resource at; }"), "E-DUP at");
    assert_eq!(first("model ATRV { mast 1; }"), "E-DUP ATRV");
    assert_eq!(first("model A { mast 1; } model A { mast 2; }"), "E-DUP A");
    assert_eq!(first("model A extends B { mast 1; } model B extends A { mast 2; }"), "E-RECURSION A");
    assert_eq!(first("model A extends A { mast 1; }"), "E-RECURSION A");
    assert_eq!(first("model A { resource b 0..9 = 12; } vehicle R : A at A; "), "E-BOUNDS 12");
    tells(&model("model A extends Blimp { flies (20, 30); clearance 4; }"), &[]);
    tells(&model("model A { slope 60 degrees; turning 0.5; }"), &[]);
}

#[test]
fn a_traverse_is_no_faster_than_the_declared_models_of_its_vehicles() {
    let text = |speed: &str| {
        format!(
            "{WORLD} model Scout {{ speed (0, 0.8); }} model Slow extends Scout {{ mast 1; }}
             vehicle R : Slow at BASE; vehicle T : ATRV at BASE;
             primitive Drive(r, to)[0,60] moves r speed {speed};
             scenario Day[0,60] = {{ Drive(T, ROCK); Drive(R, ROCK) }}"
        )
    };
    tells(&text("(0, 0.8)"), &[]);
    let message = "`R` cannot move at 1 m/s: its model `Slow` does at most 0.8 m/s";
    tells(&text("(1, 1)"), &[("E-MODEL", "moves r speed (1, 1)", message)]);
}

#[test]
fn fleets_and_groups_have_members_of_one_kind() {
    let world = "location A (0, 0); location B (1, 1); var X : {V, W}; vehicle R : ATRV at A; vehicle S[1..2] : ATRV at A;";
    let told = |text: &str| {
        let (_, told) = compiled(&format!("{world} {text} scenario Sol[0,9] = {{ delay }}"));
        told.into_iter().map(|it| format!("{} {}", it.0, it.1)).collect::<Vec<_>>()
    };
    assert_eq!(told("group G = R, S; group H = G, S[1]; group P = A, B; group Q = V, W;"), [""; 0]);
    assert_eq!(told("group G = R, A;"), ["E-KIND R", "E-KIND A"]);
    assert_eq!(told("group G = V, S;"), ["E-KIND V", "E-KIND S"]);
    assert_eq!(told("group G = H; group H = G;"), ["E-RECURSION G"]);
    assert_eq!(told("group G = G;"), ["E-RECURSION G"]);
    assert_eq!(told("group G = S[3];"), ["E-UNDEF S[3]"]);
    assert_eq!(told("vehicle T[4..1] : ATRV at A;"), ["E-BOUNDS [4..1]"]);
    assert_eq!(told("vehicle T[0..9999] : ATRV at A;"), ["E-BOUNDS [0..9999]"]);
    assert_eq!(told("group S = R;"), ["E-DUP S"]);
}

#[test]
fn nested_members_end_at_the_limit_of_a_network() {
    let deep = "each a in S in sequence ".repeat(30);
    let (network, told) = compiled(&format!(
        "location A (0, 0); vehicle S[1..9] : ATRV at A; primitive P()[1,2]; scenario Sol[0,9] = {{ {deep} P() }}"
    ));
    assert!(network.is_none());
    assert_eq!(told.iter().map(|it| it.0).collect::<Vec<_>>(), ["E-LIMIT"]);
}

#[test]
fn only_reservoirs_have_levels() {
    let own = "model Scout { resource battery 0..9 = 5; resource arm; state drill : {IN, OUT} = IN; }
               vehicle R1 : Scout at BASE; resource Crew capacity 3; const C = 2;";
    let text = |condition: &str| {
        format!(
            "{WORLD}{own} primitive Work(r)[1,2] requires {condition} consumes r.battery 1;
             scenario S[0,9] = {{ Work(R1) }}"
        )
    };
    let no = |name: &str, is: &str, place: &str| {
        tells(
            &text(&format!("{} >= 2", if name == "R1.arm" { "r.arm" } else { name })),
            &[("E-KIND", place, &format!("only a reservoir has a level, but `{name}` is {is}"))],
        );
    };
    no("Crew", "a resource with a capacity", "Crew");
    no("R1.drill", "a state", "R1.drill");
    no("R1.at", "the place of a vehicle", "R1.at");
    no("R1.arm", "a resource with a capacity", "Work");
    no("C", "a constant", "C");
    tells(&text("Oil >= 2"), &[("E-UNDEF", "Oil", "unknown resource `Oil`")]);
    tells(&text("r.wheel >= 2"), &[("E-UNDEF", "Work", "`R1` has no resource `wheel`")]);
    tells(&text("r.battery >= C - 3"), &[("E-BOUNDS", "C - 3", "an amount must not be negative")]);
    tells(&text("r.battery >= 2, not r.battery > C + 2 at start"), &[]);
}

#[test]
fn a_condition_on_a_level_is_asked_before_the_start_and_as_long_as_it_lasts() {
    let network = network(&format!(
        "{WORLD} model Scout {{ resource battery 0..9 = 5; }} vehicle R1 : Scout at BASE;
         primitive Work(r)[1,2] requires r.battery >= 3, not r.battery > 8 at start;
         scenario S[0,9] = {{ Work(R1); if not R1.battery < 2 thennext Work(R1) }}"
    ));
    let asked: Vec<String> = (network.uses.iter().enumerate())
        .map(|(at, used)| {
            let name = network.use_name(tpn::UseId::from_index(at));
            let span = if used.start == used.end { "before" } else { "during" };
            format!("{name} {} {span}", used.level_text(&network.resources).expect("it asks for a level"))
        })
        .collect();
    assert_eq!(
        asked,
        [
            "Requires(R1.battery)@Work#1 R1.battery >= 3 before",
            "Requires(R1.battery)#2@Work#1 R1.battery >= 3 during",
            "Requires(R1.battery)#3@Work#1 R1.battery <= 8 before",
            "Requires(R1.battery)@if#1 R1.battery >= 2 before",
            "Requires(R1.battery)@Work#2 R1.battery >= 3 before",
            "Requires(R1.battery)#2@Work#2 R1.battery >= 3 during",
            "Requires(R1.battery)#3@Work#2 R1.battery <= 8 before",
        ]
    );
}

/// Ten wrong programs: the code, the place, and what to do about each.
#[test]
fn each_mistake_has_its_place_and_what_to_do() {
    let own = "location BASE (0, 0); location ROCK (9, 9);
               model Scout { speed (0.01, 0.8); resource battery 0..9 = 5; resource arm; state drill : {IN, OUT} = IN; }
               vehicle R1, R2 : Scout at BASE; vehicle S[1..3] : Scout at BASE; vehicle T : ATRV at BASE;
               primitive Rest(r : Scout, site : location)[1,2] requires r.at=site; primitive Wait()[1,2];";
    let cases = [
        ("model M { body 0 x 1; }", "{ Wait() }", "E-MODEL", "body 0 x 1", "correct the value"),
        (
            "model M extends N { mast 1; } model N extends M { mast 2; }",
            "{ Wait() }",
            "E-RECURSION",
            "M",
            "remove one `extends`",
        ),
        ("vehicle V[4..1] : Scout at BASE;", "{ Wait() }", "E-BOUNDS", "[4..1]", "Change to `[1..4]`"),
        ("group G = R1, ROCK;", "{ Wait() }", "E-KIND", "ROCK", "declare two groups"),
        ("model M extends Scout { resource arm; }", "{ Wait() }", "E-DUP", "arm", "choose another name"),
        ("", "{ Rest(T, BASE) }", "E-KIND", "T", "pass a vehicle of the model `Scout`"),
        ("", "{ Rest(R1, R2) }", "E-KIND", "R2", "pass a location"),
        ("", "{ Wait(); R1.battery >= 3 }", "E-VALUE", "R1.battery >= 3", "Write `ask`"),
        ("", "{ do { Wait() } maintaining R1.arm >= 1 }", "E-KIND", "R1.arm", "`resource R 0..100 = 50;`"),
        ("", "{ each r in Scouts { Rest(r, BASE) } }", "E-UNDEF", "Scouts", "group Scouts = R1, R2;"),
    ];
    for (declared, body, code, place, advice) in cases {
        let text = format!("{own} {declared} scenario Sol[0,99] = {body}");
        let parsed = rmpl::parse(&text);
        let mut diagnostics = parsed.diagnostics();
        let (_, found) = tpn::compile(&parsed.program(), &Top::Scenario(None));
        tpn::merge_diagnostics(&mut diagnostics, found);
        let errors: Vec<_> = diagnostics.iter().filter(|it| it.severity == Severity::Error).collect();
        let [error] = errors.as_slice() else { panic!("{text}\n{errors:#?}") };
        assert_eq!((error.code.0, &text[error.span.range()]), (code, place), "{text}\n{error:?}");
        let fixes = error.fixes.iter().map(|fix| fix.label.as_str());
        let told: Vec<&str> = error.hint.as_deref().into_iter().chain(fixes).collect();
        assert!(told.iter().any(|it| it.contains(advice)), "{text}\n{told:?}");
    }
}
