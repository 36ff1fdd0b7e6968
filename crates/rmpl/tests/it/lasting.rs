//! State that lasts, resources, objectives and the statements that go with them: what texts with them mean (SPEC 10, 11,
//! 12, 14), which mistakes are told, and that none of their words is taken from a mission that uses it as a name.

use rmpl::program::{
    Change, Condition, Expr, ExprKind, LabelMode, Measure, Per, PrimitiveDecl, Statement, StatementKind,
    Supply,
};
use rmpl::{format, parse};

#[track_caller]
fn program(text: &str) -> rmpl::program::Program {
    let parsed = parse(text);
    let errors: Vec<_> = parsed
        .diagnostics()
        .into_iter()
        .filter(|it| it.code.0 == "E-SYNTAX" || it.code.0 == "E-LEX")
        .collect();
    assert!(errors.is_empty(), "{text}\n{errors:?}");
    parsed.program()
}

/// The codes and places of what is not text of the language, with the messages.
fn errors(text: &str) -> Vec<(String, String, String)> {
    let errors = parse(text).diagnostics().into_iter();
    errors
        .filter(|it| it.code.0 == "E-SYNTAX" || it.code.0 == "E-LEX")
        .map(|it| (it.code.0.to_owned(), text[it.span.range()].to_owned(), it.message))
        .collect()
}

#[track_caller]
fn one_error(text: &str, place: &str, message: &str) {
    let found = errors(text);
    let [(code, at, said)] = found.as_slice() else { panic!("{text}: {found:?}") };
    assert_eq!((code.as_str(), at.as_str()), ("E-SYNTAX", place), "{text}: {said}");
    assert!(said.contains(message), "{text}: {said}");
}

fn shown(expr: &Expr) -> String {
    match &expr.kind {
        ExprKind::Number(number) => number.to_string(),
        ExprKind::Name(name) => name.to_string(),
        ExprKind::Binary(op, left, right) => format!("({} {op:?} {})", shown(left), shown(right)),
        kind => format!("{kind:?}"),
    }
}

fn literal(condition: &Condition) -> String {
    let values: Vec<&str> = condition.values.iter().map(|value| value.text.as_str()).collect();
    let sign = if condition.negated { "!" } else { "" };
    format!("{sign}{}={}", condition.variable.text, values.join("|"))
}

fn clauses(decl: &PrimitiveDecl) -> Vec<String> {
    let requires = decl.requires.iter().map(|it| {
        format!("{} {}", if it.is_at_start { "at start" } else { "requires" }, literal(&it.condition))
    });
    let sets = decl.sets.iter().map(|it| format!("sets {}={}", it.variable.text, it.value.text));
    let amount = |it: &rmpl::program::Amount| match it.per {
        None => shown(&it.value),
        Some(Per::Meter) => format!("{} per metre", shown(&it.value)),
        Some(Per::Time(unit)) => format!("{} per {unit:?}", shown(&it.value)),
    };
    let uses = decl.uses.iter().map(|it| {
        let amount = it.amount.as_ref().map(amount).unwrap_or_default();
        format!("{} {} {amount}", it.change.word(), it.resource.text).trim_end().to_owned()
    });
    let costs = decl.costs.iter().map(|it| format!("costs {}", amount(it)));
    let rewards = decl.rewards.iter().map(|it| format!("rewards {}", shown(it)));
    requires.chain(sets).chain(uses).chain(costs).chain(rewards).collect()
}

#[track_caller]
fn primitive(tail: &str, wanted: &[&str]) {
    let text = format!("primitive P(s, n)[1,2] {tail};");
    assert_eq!(clauses(&program(&text).primitives[0]), wanted, "{tail}");
}

#[test]
fn a_state_has_a_domain_and_a_value_at_the_start() {
    let text = "state ARM : {IN, OUT} = OUT;\nvar LIGHT : {ON, OFF};";
    let variables = program(text).variables;
    assert_eq!(variables[0].name.text, "ARM");
    assert_eq!(variables[0].values.len(), 2);
    let initial = variables[0].initial.as_ref().unwrap();
    assert_eq!((initial.text.as_str(), &text[initial.span.range()]), ("OUT", "OUT"));
    assert_eq!(initial.span.start as usize, text.find("OUT;").unwrap());
    assert_eq!(&text[variables[0].span.range()], "state ARM : {IN, OUT} = OUT;");
    assert_eq!(variables[1].initial, None);
}

#[test]
fn resources_are_for_one_for_several_or_a_store() {
    let program = program(
        "resource Drill; resource Power capacity 2*N; resource Battery 0..100 = 40;\
         resource Tank LOW+1 .. HIGH = (LOW+HIGH)/2; const N = 3; const LOW = 1; const HIGH = 9;",
    );
    let supplies: Vec<String> = program
        .resources
        .iter()
        .map(|decl| match &decl.supply {
            Supply::Reusable { capacity } => {
                format!("{}: {}", decl.name.text, capacity.as_ref().map(shown).unwrap_or_default())
            }
            Supply::Reservoir { least, greatest, level } => {
                format!("{}: {} to {} from {}", decl.name.text, shown(least), shown(greatest), shown(level))
            }
        })
        .collect();
    let wanted = [
        "Drill: ",
        "Power: (2 Multiply N)",
        "Battery: 0 to 100 from 40",
        "Tank: (LOW Add 1) to HIGH from ((LOW Add HIGH) Divide 2)",
    ];
    assert_eq!(supplies, wanted);
}

#[test]
fn goals_are_sums_of_measures_with_factors() {
    let program = program("objective minimize 2*cost + end - 0.5 * length, maximize -cost + reward;");
    let goals: Vec<(bool, Vec<(String, Measure)>)> = program.objectives[0]
        .goals
        .iter()
        .map(|goal| {
            let terms = goal.terms.iter().map(|(factor, measure)| (factor.to_string(), *measure));
            (goal.is_maximized, terms.collect())
        })
        .collect();
    let term = |factor: &str, measure| (factor.to_owned(), measure);
    assert_eq!(
        goals,
        [
            (false, vec![term("2", Measure::Cost), term("1", Measure::End), term("-0.5", Measure::Length)]),
            (true, vec![term("-1", Measure::Cost), term("1", Measure::Reward)]),
        ]
    );
}

#[test]
fn clauses_stand_in_any_order_and_repeat() {
    primitive("requires A=X, s, !B", &["requires A=X", "requires s=", "requires !B="]);
    primitive("requires at start A=X, B in {Y, Z}", &["at start A=X", "at start B=Y|Z"]);
    primitive(
        "requires A=X and (B and not C) requires D",
        &["requires A=X", "requires B=", "requires !C=", "requires D="],
    );
    primitive("sets A=s, V.at=s", &["sets A=s", "sets V.at=s"]);
    primitive("uses R, Power 2, Crew n", &["uses R", "uses Power 2", "uses Crew n"]);
    primitive(
        "consumes B 2 per minute, C n*2 per metre produces D 1 per hour",
        &["consumes B 2 per Minute", "consumes C (n Multiply 2) per metre", "produces D 1 per Hour"],
    );
    primitive(
        "costs 3 costs 0.5 per metre rewards n rewards 2",
        &["costs 3", "costs 0.5 per metre", "rewards n", "rewards 2"],
    );
    primitive(
        "rewards 1 sets A=X moves s runs Prog uses R requires B",
        &["requires B=", "sets A=X", "uses R", "rewards 1"],
    );
    let decl = &program("primitive P(v)[1,2] sets A=X moves v speed (1, 2) uses R runs Prog;").primitives[0];
    assert!(decl.moves.is_some());
    assert_eq!(decl.runs.as_ref().unwrap().program.text, "Prog");
}

#[test]
fn a_vehicles_place_is_one_name_wherever_a_condition_stands() {
    let text = "primitive Dig(v, s)[1,2] requires v.at=s sets Rover-1.at = s;\n\
         M(s) = { do Dig(R, s) maintaining (Rover-1.at=s or Rover-1.at=B) and LIGHT; Rover-1.at != s;\n\
         if Rover-1.at in {A, B} thennext Dig(R, s); ask not (Rover-1.at=A and LIGHT); Dig(R, Rover-1.at=A) }";
    let program = program(text);
    let effect = &program.primitives[0].sets[0];
    assert_eq!(effect.variable.text, "Rover-1.at");
    assert_eq!(&text[effect.variable.span.range()], "Rover-1.at");
    assert_eq!(&text[effect.span.range()], "Rover-1.at = s");
    assert_eq!(program.primitives[0].requires[0].condition.variable.text, "v.at");
    let shown = format!("{:?}", program.activities[0].body);
    assert_eq!(shown.matches("text: \"Rover-1.at\"").count(), 6, "{shown}");
}

#[test]
fn a_composite_uses_a_resource_for_its_whole_length() {
    let body = |text: &str| program(text).activities.remove(0).body;
    let using = |statement: &Statement| match &statement.kind {
        StatementKind::Using(_, resource, amount) => {
            (resource.text.to_string(), amount.as_ref().map(shown), statement.bounds.is_some())
        }
        kind => panic!("{kind:?}"),
    };
    let plain = |name: &str, amount: Option<&str>| (name.to_owned(), amount.map(str::to_owned), false);
    assert_eq!(
        using(&body("M(n) = { do { A(); B() } using Power 2*n }")),
        plain("Power", Some("(2 Multiply n)"))
    );
    assert_eq!(using(&body("M() = { do A() using Crew }")), plain("Crew", None));
    let bounded = body("M() = { do A()[1,2] using Crew (1+1) [0,9] }");
    let StatementKind::Sequence(parts) = &bounded.kind else { panic!("{bounded:?}") };
    assert_eq!(using(&parts[0]), ("Crew".to_owned(), Some("(1 Add 1)".to_owned()), true));
    let nested = body("M(n) = { do do A() using P using Q n }");
    assert_eq!(using(&nested), plain("Q", Some("n")));
    let StatementKind::Using(inner, ..) = &nested.kind else { panic!("{nested:?}") };
    assert_eq!(using(inner), plain("P", None));
    // Behind the resource, `else` belongs to the `if`.
    let either = body("M() = { if C thennext do A() using P else B() }");
    let StatementKind::Choose(ways) = &either.kind else { panic!("{either:?}") };
    assert_eq!(ways.len(), 2);
}

#[test]
fn an_optional_statement_is_a_choice_between_it_and_nothing() {
    let body = program("M() = { optional A()[1,2] }").activities.remove(0).body;
    let StatementKind::Choose(ways) = &body.kind else { panic!("{body:?}") };
    let [taken, nothing] = ways.as_slice() else { panic!("{ways:?}") };
    assert!(matches!(&taken.kind, StatementKind::Call(name, _) if name.text == "A"));
    assert!(taken.bounds.is_some() && body.bounds.is_none());
    assert_eq!(nothing.kind, StatementKind::Sequence(Vec::new()));
    let several =
        program("M() = { optional free { A(); B() }; optional X=V [1,2], optional do A() using P }");
    let shown = format!("{:?}", several.activities[0].body);
    assert_eq!(shown.matches("Choose(").count(), 3);
}

#[test]
fn what_is_unordered_keeps_its_parts() {
    let body = program("M() = { unordered { A(); B(), C(); { D(); E() } }[0,9] }").activities.remove(0).body;
    let StatementKind::Sequence(steps) = &body.kind else { panic!("{body:?}") };
    assert!(steps[0].bounds.is_some());
    let StatementKind::Unordered(parts) = &steps[0].kind else { panic!("{body:?}") };
    let kinds: Vec<&str> = parts
        .iter()
        .map(|part| match &part.kind {
            StatementKind::Call(..) => "call",
            StatementKind::Parallel(_) => "parallel",
            StatementKind::Sequence(_) => "sequence",
            _ => "other",
        })
        .collect();
    assert_eq!(kinds, ["call", "parallel", "sequence"]);
    let single = program("M() = { unordered { A() } }").activities.remove(0).body;
    assert!(matches!(single.kind, StatementKind::Unordered(parts) if parts.len() == 1));
}

const WORDS: [&str; 24] = [
    "state",
    "resource",
    "objective",
    "capacity",
    "requires",
    "sets",
    "uses",
    "consumes",
    "produces",
    "costs",
    "rewards",
    "using",
    "optional",
    "unordered",
    "per",
    "at",
    "start",
    "minimize",
    "maximize",
    "cost",
    "reward",
    "end",
    "length",
    "metre",
];

/// Returns what a mission means that has `word` in every place where a name can stand.
fn mission(word: &str) -> String {
    format!(
        "{word}(x)[l,u] = {{ delay }}\n\
         var V_{word} : {{{word}, OTHER}};\n\
         primitive Go({word})[1,2] moves {word}, R speed (1, 2);\n\
         primitive Run()[1,2] moves {word} runs {word};\n\
         location {word} (1, 2);\n\
         vehicle {word} : ATRV at {word};\n\
         vehicle R : ATRV at {word};\n\
         const K = {word}*2;\n\
         option threat_gap = 2;\n\
         A({word}, y)[{word},u] = {{\n\
         {word}; {word}[1,2]; {word}({word}, 1); {word}={word} [1,2]; {word}!={word}; ask {word}; not {word};\n\
         {word} and y; ask {word} or y; ask {word} in {{{word}, OTHER}}; ask {word} and y;\n\
         {word};\n\
         {word} and y;\n\
         {word}\n\
         }}\n\
         B() = {{ choose {{ {word}, {word}() }}; do {word} maintaining {word}; do {word}() watching {word};\n\
         if {word} thennext {word} else {word}(); if {word} thennext\n{word} else {word}; repeat {word} {{ {word} }};\n\
         do {word}=X maintaining y; Go({word}+1, {word}={word}); delay[{word},{word}*2]; free {word}; {{ {word} }} }}\n\
         scenario {word}[0,9] = {{ {word}(1), B() }}\n\
         scenario Last = {{ {word}\n}}"
    )
}

/// A mission's meaning, with the places left out and the word itself made neutral.
fn meaning(word: &str) -> String {
    let text = mission(word);
    let parsed = parse(&text);
    let syntax: Vec<_> = parsed.diagnostics().into_iter().filter(|it| it.code.0 == "E-SYNTAX").collect();
    assert!(syntax.is_empty(), "{word}: {syntax:?}\n{text}");
    let shown = format!("{:?}", parsed.program());
    let mut parts = shown.split("Span {");
    let first = parts.next().unwrap_or("").to_owned();
    let bare = parts.fold(first, |sum, part| sum + part.split_once('}').map_or("", |(_, rest)| rest));
    bare.replace(&format!("\"{word}\""), "WORD").replace(&format!("\"V_{word}\""), "V_WORD")
}

#[test]
fn the_new_words_are_names_wherever_a_name_can_stand() {
    let plain = meaning("Plain");
    for word in WORDS {
        assert_eq!(meaning(word), plain, "{word}");
    }
}

#[test]
fn names_that_are_words_are_read_by_what_follows_them() {
    primitive("uses Power sets", &["uses Power sets"]);
    primitive("uses Power sets sets A=X", &["sets A=X", "uses Power sets"]);
    primitive("uses uses uses uses per", &["uses uses", "uses uses per"]);
    primitive("consumes B per per minute", &["consumes B per per Minute"]);
    primitive("requires at=start, at", &["requires at=start", "requires at="]);
    primitive("requires at start start", &["at start start="]);
    primitive(
        "requires requires=sets sets sets=uses uses costs costs costs",
        &["requires requires=sets", "sets sets=uses", "uses costs", "costs costs"],
    );
    let level = &program("resource Tank capacity..9 = capacity; const capacity = 1;").resources[0].supply;
    assert!(matches!(level, Supply::Reservoir { .. }));
    let resource = &program("resource capacity capacity capacity; const capacity = 1;").resources[0];
    assert_eq!(resource.name.text, "capacity");
    assert!(matches!(&resource.supply, Supply::Reusable { capacity: Some(_) }));
    let using = program("M(using) = { do using using using using }").activities.remove(0).body;
    assert!(
        matches!(&using.kind, StatementKind::Using(_, name, Some(_)) if name.text == "using"),
        "{using:?}"
    );
}

#[test]
fn assertions_of_states_are_statements_as_before() {
    let body =
        program("state ARM : {IN, OUT} = IN; M() = { ARM=OUT [1,2]; ask ARM=OUT }").activities.remove(0);
    let shown = format!("{:?}", body.body);
    assert!(
        shown.contains(&format!("{:?}", LabelMode::Tell)) && shown.contains(&format!("{:?}", LabelMode::Ask))
    );
}

#[test]
fn one_mistake_gives_one_diagnostic() {
    one_error("state ARM : {IN, OUT};", ";", "the value at the start");
    one_error("state ARM {IN, OUT} = IN;", "{", "expected `:`");
    one_error("state ARM : {IN, OUT} = ;", ";", "the value at the start");
    one_error("resource P 5;", ";", "`capacity` before the number");
    one_error("resource P 0..9;", ";", "the level at the start");
    one_error("resource P 0.. = 3;", "=", "the maximum level");
    one_error("resource P capacity;", ";", "a number");
    one_error("resource P capacity -2;", "-", "negative");
    one_error("objective cost;", "cost", "`minimize` or `maximize`");
    one_error("objective minimize price, maximize reward;", "price", "`cost`, `reward`, `end` or `length`");
    one_error("objective minimize end-cost;", "end-cost", "found `end-cost`");
    one_error("objective minimize 2 cost;", "2", "expected `*`");
    one_error("objective minimize 2 * ;", ";", "`cost`");
    one_error("objective minimize cost maximize reward;", "t", "expected `,`");
    let clause = |tail: &str, place: &str, message: &str| {
        one_error(&format!("primitive P(s)[1,2] {tail};\nprimitive Q()[1,2];\n"), place, message);
    };
    clause("requires A or B", "A or B", "must require one condition");
    clause("requires not (A and B) sets C=V", "not (A and B)", "must require one condition");
    clause("requires", ";", "a condition");
    clause("requires at start", ";", "a condition");
    clause("requires A, sets B=V", ",", "a new clause starts here");
    clause("requires A, at start B", ",", "its own clause");
    clause("requires A B", "A", "expected `,`");
    clause("requires A== V sets B=V", "=", "single `=`");
    clause("requires s.=V sets B=V", "=", "`at`");
    clause("requires s. at=V sets B=V", "at", "directly after `.`");
    clause("sets not A=V", "not", "exactly one value");
    clause("sets A!=V, B=V", "!=", "exactly one value");
    clause("sets A in {V}, B=V", "in", "exactly one value");
    clause("sets A uses R", "uses", "the value");
    clause("sets A= uses R 2", "R", "");
    clause("uses", ";", "the name of a resource");
    clause("uses R 2 per minute", "per minute", "cannot count per unit of time");
    clause("uses R per minute", "per", "a number");
    clause("consumes R", ";", "a number");
    clause("consumes R sets A=V", "sets", "a number");
    clause("consumes R 2 per day sets A=V", "day", "`second`, `minute`, `hour` or `metre`");
    clause("consumes R -2", "-", "negative");
    clause("costs 2 per hour", "per hour", "cannot count per unit of time");
    clause("costs 2, rewards 3", ",", "a new clause starts here");
    clause("rewards 2 per metre", "per", "expected `;`");
    clause("needs A", "needs", "expected `;`");
    let body = |text: &str, place: &str, message: &str| {
        one_error(&format!("M() = {{ {text} }}\nprimitive Q()[1,2];\n"), place, message);
    };
    body("do A() using", "}", "the name of a resource");
    body("do A() using P 2 per minute [1,2]; A()", "per minute", "has no unit");
    body("do A()", "}", "`maintaining`");
    body("A.at()", "(", "`=` and a location");
    body("unordered { A() B() }", ")", "expected `;`");
    body("unordered { A(); ", "{", "unclosed");
    body("optional { A(; }", ";", "a name or a number");
}

#[test]
fn a_broken_clause_leaves_the_others_whole() {
    let parsed =
        parse("primitive P(s)[1,2] requires A or B sets C=V uses R 2 per minute consumes T sets D=W;");
    let decl = &parsed.program().primitives[0];
    assert_eq!(clauses(decl), ["sets C=V", "sets D=W", "uses R 2 per Minute"]);
    assert!(decl.uses.iter().all(|it| it.change == Change::Uses));
    let state = parse("state ARM : {IN, OUT}").program().variables.remove(0);
    assert!(state.initial.is_some(), "a state is one before its value is written");
}

#[track_caller]
fn laid_out(before: &str, after: &str) {
    assert_eq!(format(before), after);
    assert_eq!(format(after), after, "formatting twice");
}

#[test]
fn the_new_forms_have_a_layout() {
    laid_out("state  ARM:{IN ,OUT}=IN ;", "state ARM : {IN, OUT} = IN;\n");
    laid_out("resource P ;resource Q capacity(1+2);", "resource P;\nresource Q capacity (1 + 2);\n");
    laid_out("resource B 0 .. (N)=N*2;", "resource B 0..(N) = N * 2;\n");
    laid_out(
        "objective minimize 2*cost+end ,maximize - reward -0.5*length;",
        "objective minimize 2 * cost + end, maximize -reward - 0.5 * length;\n",
    );
    laid_out(
        "primitive P(s)[1,2]requires at  start A = X ,s and(B or C)sets A= Y,v.at =s uses R 3,Q;",
        "primitive P(s)[1,2]requires at  start A = X ,s and(B or C)sets A= Y,v.at =s uses R 3,Q;\n",
    );
    laid_out(
        "primitive P(s)[1,2]requires at  start A = X ,not(s)sets A= Y,v.at =s uses R n*3,Q  costs 2 per  metre;",
        "primitive P(s)[1,2]\n  requires at start A=X, not(s)\n  sets A=Y, v.at=s\n  uses R n * 3, Q\n  costs 2 per metre;\n",
    );
    laid_out(
        "primitive P(s)[1,2]requires A = X ,not(s)sets A= Y,v.at =s rewards 2*3;",
        "primitive P(s)[1,2] requires A=X, not(s) sets A=Y, v.at=s rewards 2 * 3;\n",
    );
    laid_out(
        "primitive P(s)[1,2] requires A=X\nsets A=Y  // out\n;",
        "primitive P(s)[1,2]\n  requires A=X\n  sets A=Y // out\n    ;\n",
    );
    laid_out(
        "primitive Collect-Sample(site)[10,20] requires ARM=OUT, Rover1.at=site consumes Battery 2 per minute sets SAMPLE=site;",
        "primitive Collect-Sample(site)[10,20]\n  requires ARM=OUT, Rover1.at=site\n  consumes Battery 2 per minute\n  sets SAMPLE=site;\n",
    );
    laid_out(
        "M()={unordered{A();B()}[0,9];optional A()[1,2];do{A()}using P  2*n[1,2]}",
        "M() = { unordered { A(); B() } [0,9]; optional A()[1,2]; do { A() } using P 2 * n [1,2] }\n",
    );
    laid_out("M() = {\nunordered { A();\nB() }\n}", "M() = {\n  unordered {\n    A();\n    B()\n  }\n}\n");
}

#[test]
fn what_is_told_together_is_told_for_as_long() {
    let body = program("M() = { A=X and not B and C=Y [1,2] }").activities.remove(0).body;
    let StatementKind::Telling(inner, last) = &body.kind else { panic!("{body:?}") };
    let StatementKind::Telling(first, middle) = &inner.kind else { panic!("{inner:?}") };
    assert_eq!((literal(last), literal(middle)), ("C=Y".to_owned(), "!B=".to_owned()));
    assert!(matches!(&first.kind, StatementKind::Condition(LabelMode::Tell, it) if literal(it) == "A=X"));
    assert!(first.bounds.is_some() && inner.bounds.is_none() && body.bounds.is_none());
}

/// Each fix of the only diagnostic of `text` gives one of these texts, in which nothing is wrong.
#[track_caller]
fn mended(text: &str, wanted: &[&str]) {
    let found = parse(text).diagnostics();
    let [found] = found.as_slice() else { panic!("{found:?}") };
    let texts = found.fixes.iter().map(|fix| {
        let mut mended = text.to_owned();
        for edit in fix.edits.iter().rev() {
            mended.replace_range(edit.span.range(), &edit.text);
        }
        mended
    });
    let texts: Vec<String> = texts.collect();
    assert_eq!(texts, wanted);
    for text in texts {
        assert_eq!(parse(&text).diagnostics(), [], "{text}");
    }
}

#[test]
fn a_missing_declaration_is_offered() {
    mended(
        "// Out with it.\nprimitive P()[1,2] sets ARM=OUT;\n",
        &["// Out with it.\nstate ARM : {OUT} = OUT;\nprimitive P()[1,2] sets ARM=OUT;\n"],
    );
    mended(
        "primitive P()[1,2] requires at start ARM=IN sets ARM=OUT;\n",
        &["state ARM : {IN, OUT} = IN;\nprimitive P()[1,2] requires at start ARM=IN sets ARM=OUT;\n"],
    );
    mended(
        "primitive P(s)[1,2] sets SAMPLE=s;\n",
        &["state SAMPLE : {NONE} = NONE;\nprimitive P(s)[1,2] sets SAMPLE=s;\n"],
    );
    mended("primitive P()[1,2] uses Power 3;\n", &["resource Power;\nprimitive P()[1,2] uses Power 3;\n"]);
    mended(
        "primitive P()[1,2] consumes Fuel 3;\n",
        &["resource Fuel 0..100 = 100;\nprimitive P()[1,2] consumes Fuel 3;\n"],
    );
    mended("M() = { do delay using Power }", &["resource Power;\nM() = { do delay using Power }"]);
    let known =
        "state ARM : {IN, OUT} = IN; resource Power; location BASE (1, 2); vehicle Rover : ATRV at BASE;\n";
    let near = |written: &str, mended_text: &str| {
        mended(&format!("{known}{written}"), &[&format!("{known}{mended_text}")]);
    };
    near("primitive P()[1,2] sets AMR=OUT;", "primitive P()[1,2] sets ARM=OUT;");
    near("primitive P()[1,2] sets ARM=OTU;", "primitive P()[1,2] sets ARM=OUT;");
    near("primitive P()[1,2] uses Pwoer;", "primitive P()[1,2] uses Power;");
    near("primitive P()[1,2] requires Rovre.at=BASE;", "primitive P()[1,2] requires Rover.at=BASE;");
    near("primitive P()[1,2] sets Rover.at=BSAE;", "primitive P()[1,2] sets Rover.at=BASE;");
    near("M() = { not ARM=IN [1,2] }", "M() = { ARM=OUT [1,2] }");
    near("M() = { not ARM_IN [1,2] }", "M() = { ARM=OUT [1,2] }");
    mended(
        "state LIGHT : {true, false} = true; M() = { not LIGHT [1,2] }",
        &["state LIGHT : {true, false} = true; M() = { LIGHT=false [1,2] }"],
    );
}

#[test]
fn a_dash_in_the_name_of_a_vehicle_moves_nothing() {
    let text = "primitive P()[1,2] requires Rover\u{2013}1.at=BASE;";
    let found = parse(text).diagnostics();
    let undefined = found.iter().find(|it| it.code.0 == "E-UNDEF").expect("no such vehicle");
    assert_eq!(&text[undefined.span.range()], "Rover\u{2013}1");
}

#[test]
fn what_begins_so_or_is_moved_there_is_supported() {
    let warned = |text: &str| {
        let found = parse(text).diagnostics().into_iter().filter(|it| it.code.0 == "W-SUPPORT").count();
        assert_eq!(parse(text).diagnostics().len(), found, "{text}: {:?}", parse(text).diagnostics());
        found > 0
    };
    let world = "location A (1, 2); location B (2, 3); vehicle R : ATRV at A;\n";
    let place =
        |rest: &str| warned(&format!("{world}{rest}\nscenario S[0,9] = {{ {{ delay; ask R.at=B }}, P() }}"));
    assert!(place("primitive P()[1,2];"));
    assert!(place("primitive P()[1,2] requires R.at=A;"));
    assert!(!place("primitive P()[1,2] sets R.at=B;"));
    assert!(!place(
        "primitive P()[1,2]; primitive D(v)[1,2] sets v.at=B; M() = { D(R) } N() = { M() }\nO() = { N(); O2() }\nprimitive O2()[1,2]; scenario T[0,99] = { O() }"
    ));
    assert!(!place("primitive P()[1,2]; primitive D(x)[1,2] moves R; scenario T[0,99] = { D(B) }"));
    assert!(!place("primitive P()[1,2]; primitive D(v, x)[1,2] moves v; scenario T[0,99] = { D(R, B) }"));
    assert!(!place("primitive P()[1,2]; scenario T[0,99] = { R.at=B }"));
    let state = |rest: &str| {
        warned(&format!(
            "state X : {{A, B, C}} = A;\nprimitive P()[1,2];\nscenario S[0,9] = {{ P(); {rest} }}"
        ))
    };
    assert!(!state("ask X=A"));
    assert!(!state("ask X!=B"));
    assert!(!state("ask X in {A, B}"));
    assert!(!state("do P() watching X=B"));
    assert!(state("ask X=B"));
    assert!(state("ask X!=A"));
    assert!(state("ask X in {B, C}"));
    assert!(state("do P() watching X=A"), "watching a state asks that it is another");
    assert!(state("do P() watching X=C; ask X!=A"), "watching a state changes nothing");
    assert!(!state("ask X=B; X=B"));
}
