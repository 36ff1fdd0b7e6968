//! The notation as authors meet it: the paper's listing, its damage, and one diagnostic per mistake.

use super::*;

const ORBIT: &str = "OrbitInsert ()::
(do -watching ((EngineA = Firing) OR ( EngineB = Firing))
(parallel
(EngineA = Standby)
(EngineB = Standby)
(Camera = Off)
(do -watching (EngineA = Failed)
(when -donext ( (EngineA = Standby) AND
(Camera = Off) )
(EngineA = Firing) ))
(when -donext ( (EngineA = Failed) AND
(EngineB = Standby) AND
(Camera = Off) )
(EngineB = Firing) )))
";

fn codes(text: &str) -> Vec<&'static str> {
    let parsed = parse(text);
    let mut found: Vec<&'static str> =
        parsed.diagnostics.iter().map(|diagnostic| diagnostic.code.0).collect();
    if found.is_empty() {
        found.extend(expand_main(&parsed.file).1.iter().map(|diagnostic| diagnostic.code.0));
    }
    found
}

#[test]
fn the_listing_of_the_paper_is_read_with_its_torn_keywords() {
    let parsed = parse(ORBIT);
    assert_eq!(parsed.diagnostics, []);
    let main = parsed.file.main().expect("one definition");
    assert_eq!(main.name.text, "OrbitInsert");
    let ExpressionKind::DoWatching { guard, body } = &main.body.kind else { panic!("{:?}", main.body.kind) };
    assert_eq!(guard.to_string(), "(EngineA=Firing OR EngineB=Firing)");
    assert!(!guard.non_entailed, "the listing has no overbars");
    let ExpressionKind::Parallel(parts) = &body.kind else { panic!("{:?}", body.kind) };
    assert_eq!(parts.len(), 5);
}

#[test]
fn each_mistake_gives_one_diagnostic_with_its_code() {
    for (text, code) in [
        ("(PARALLEL (x = a)", "E-SYNTAX"),
        ("(PARALLEL (x = a)))", "E-SYNTAX"),
        ("(WHEN-DONEXT (x = a))", "E-ARITY"),
        ("(IF-THENNEXT (x = a) (y = a) (y = b))", "E-ARITY"),
        ("(REPEAT (x = a))", "E-FORM"),
        ("(PARALEL (x = a))", "E-FORM"),
        ("~(x = a)", "E-CONSTRAINT"),
        ("(PARALLEL (x = a) ~(y = b))", "E-CONSTRAINT"),
        ("((x = a) AND (y = b) OR (z = c))", "E-CONSTRAINT"),
        ("(x = )", "E-CONSTRAINT"),
        ("(SEQUENCE (x = a) (Foo))", "E-UNDEF"),
        ("A ():: (x = a)\nA ():: (x = b)", "E-DUP"),
        ("A ():: (SEQUENCE (x = a) (A))", "E-RECURSION"),
        ("A ():: (B)\nB ():: (A)", "E-RECURSION"),
        ("P (c):: (WHEN-DONEXT c (x = a))\nM ():: (P)", "E-ARITY"),
        ("P (c):: (WHEN-DONEXT c (x = a))\nM ():: (P (ALWAYS true))", "E-CONSTRAINT"),
        ("(WHEN-DONEXT (x = a) @ (y = b))", "E-LEX"),
        ("(WHEN-DONEXT () (y = b))", "E-SYNTAX"),
        ("(DEFOPTION entailment 0.5) (x = a)", "E-PROBABILITY"),
        ("(DEFOPTION entailment 1.01) (x = a)", "E-PROBABILITY"),
        ("(DEFOPTION entailment most) (x = a)", "E-PROBABILITY"),
        ("(DEFOPTION entailment) (x = a)", "E-ARITY"),
        ("(DEFOPTION entailment 0.9) (DEFOPTION entailment 0.8) (x = a)", "E-DUP"),
        ("(DEFOPTION entialment 0.9) (x = a)", "W-OPTION"),
        ("(PARALLEL (DEFOPTION entailment 0.9))", "E-FORM"),
        ("(DEFINSTANCE P Pump INIT) (x = a)", "E-ARITY"),
        ("(DEFINSTANCE P Pump INIT Off 0.9 Idle) (x = a)", "E-ARITY"),
        ("(DEFINSTANCE P Pump INIT Off 0.9 Idle 0.2) (x = a)", "E-PROBABILITY"),
        ("(DEFINSTANCE P Pump INIT Off 0.9) (x = a)", "E-PROBABILITY"),
        ("(DEFINSTANCE P Pump INIT Off 1 Idle 0) (x = a)", "E-PROBABILITY"),
        ("(DEFINSTANCE P Pump INIT Off 0.5 Off 0.5) (x = a)", "E-DUP"),
        ("(DEFINSTANCE P Pump INIT * Off) (x = a)", "E-SYNTAX"),
        ("", "E-UNDEF"),
    ] {
        assert_eq!(codes(text), [code], "{text}");
    }
}

#[test]
fn a_definition_after_an_open_parenthesis_is_still_read() {
    let parsed = parse("A ():: (PARALLEL (x = a)\nB ():: (WHEN-DONEXT (x = a) (y = b))\n");
    assert_eq!(parsed.diagnostics.len(), 1);
    assert_eq!(parsed.file.definitions.len(), 2);
}

#[test]
fn macros_take_names_constraints_guards_and_expressions() {
    let text = "Await (S):: (DO-WATCHING S (ALWAYS true))
Go (Engine mode body):: (SEQUENCE (Await (Engine = mode)) body)
Unless (c body):: (IF-THENNEXT c body)
Main ():: (PARALLEL (Go EngineA Standby (x = a)) (Unless ~(c = on) (y = b)))";
    let parsed = parse(text);
    assert_eq!(parsed.diagnostics, []);
    let (body, problems) = expand_main(&parsed.file);
    assert_eq!(problems, []);
    let Some(Expression { kind: ExpressionKind::Parallel(parts), .. }) = body else { panic!("not parallel") };
    let [
        Expression { kind: ExpressionKind::Sequence(go), .. },
        Expression { kind: ExpressionKind::IfThenNext { guard, .. }, .. },
    ] = parts.as_slice()
    else {
        panic!("{parts:?}")
    };
    assert!(
        matches!(&go[0].kind, ExpressionKind::DoWatching { guard, .. } if guard.to_string() == "EngineA=Standby")
    );
    assert!(matches!(&go[1].kind, ExpressionKind::Assert(c) if c.to_string() == "x=a"));
    assert_eq!(guard.to_string(), "~c=on");
}

#[test]
fn every_beginning_of_a_text_is_read_without_panic_and_without_loss() {
    let model = "(DEFCLASS A (B) (VAR v {x y} OBSERVABLE SHOWS x) (MODE M (v = x)) (FAULT M N 0.1))\n(DEFINSTANCE a A (p b) INIT M)";
    for text in [ORBIT, model] {
        for end in 0..=text.len() {
            let part = &text[..end];
            let parsed = parse(part);
            let joined: String = parsed.tokens.iter().map(|token| &part[token.span.range()]).collect();
            assert_eq!(joined, part);
            let _ = expand_main(&parsed.file);
            let _ = is_control_text(part);
        }
    }
    let deep = "(NOT ".repeat(5000);
    assert!(parse(&deep).has_errors());
}

#[test]
fn the_notation_of_a_text_is_recognized_with_comments_and_when_broken() {
    for text in [
        ORBIT,
        "; scenario of the engine; with drivers\n(DEFCLASS Engine () (MODE Off true))",
        "(WHEN-DONEXT (c = on) (x = go))",
        "(x = a)",
        "(PARALLEL (x = a)",
        "A ():: (SEQUENCE (x",
        "Pause ():: true",
    ] {
        assert!(is_control_text(text), "{text}");
    }
    for text in [
        "",
        "// a mission (DO-WATCHING)\nA()[l,u] = { B()[1,2]; C() }",
        "primitive A(); primitive B();\nscenario S[0,10] = { A(); B() }",
        "var X : {A, B};",
        "A() = { do { B() } watching (X=OK) }",
        "scenario S = { if (X=OK) thennext A()",
    ] {
        assert!(!is_control_text(text), "{text}");
    }
}

#[test]
fn formatting_keeps_the_meaning_and_settles_at_once() {
    let commented = "; head\n\nA (c, d):: ; why\n(parallel (x = a) ; one\n (when -donext ~(y = b) (z = c)) ; two\n)\n; tail";
    let long = format!(
        "(SEQUENCE {})",
        "(IF-THENNEXT-ELSENEXT ((aaaaaaaa = b) AND (cccccccccc = d)) (eeeeeeee = f) (ggggg = h)) ".repeat(4)
    );
    for text in [ORBIT, commented, &long] {
        let once = format(text);
        assert_eq!(format(&once), once, "{once}");
        let meaning = |text: &str| {
            let parsed = parse(text);
            assert_eq!(parsed.diagnostics, [], "{text}");
            let comments: Vec<String> = parsed
                .tokens
                .iter()
                .filter(|token| token.kind == TokenKind::Comment)
                .map(|token| text[token.span.range()].trim_end().to_owned())
                .collect();
            (outline(&parsed.file), comments)
        };
        assert_eq!(meaning(&once), meaning(text), "{once}");
        assert!(once.lines().all(|line| line.chars().count() <= 100), "{once}");
    }
}

/// The tree without its spans.
fn outline(file: &ControlFile) -> String {
    let text = format!("{file:?}");
    let mut bare = String::new();
    let mut rest = text.as_str();
    while let Some((before, after)) = rest.split_once("Span {") {
        bare.push_str(before);
        rest = after.split_once('}').map_or("", |(_, rest)| rest);
    }
    bare + rest
}

#[test]
fn a_prior_and_a_threshold_are_read_exactly_wherever_they_stand() {
    let text = "(DEFINSTANCE P Pump INIT Off 0.9 Idle 1/10 (feed Q)) (DEFINSTANCE Q Pump INIT *)
(DEFINSTANCE R Pump INIT Idle) (DEFINSTANCE S Pump) (DEFOPTION entailment 19/20) (x = a)";
    let parsed = parse(text);
    assert_eq!(parsed.diagnostics, []);
    assert_eq!(parsed.file.entailment().map(|threshold| threshold.to_string()).as_deref(), Some("0.95"));
    let [p, q, r, s] = parsed.file.instances.as_slice() else { panic!("four components") };
    let prior: Vec<String> =
        p.initial.prior().into_iter().map(|(mode, weight)| format!("{mode} {weight}")).collect();
    assert_eq!(prior, ["Off 9", "Idle 1"]);
    assert_eq!(p.ports[0].1.text, "Q", "a port may stand after the prior");
    assert_eq!((&q.initial, &s.initial), (&Initial::AnyMode, &Initial::FirstMode));
    assert!(matches!(&r.initial, Initial::Mode(mode) if mode.text == "Idle"));
    assert_eq!(parse("(x = a)").file.entailment(), None);
}

#[test]
fn the_first_value_of_a_mode_is_the_likeliest_of_its_prior() {
    let class = "(DEFCLASS Pump () (MODE Off true) (MODE Idle true) (MODE On true))";
    for (init, first) in [
        ("", "Off"),
        ("INIT *", "Off"),
        ("INIT Idle", "Idle"),
        ("INIT On 0.5 Idle 0.3 Off 0.2", "On"),
        ("INIT On 0.4 Idle 0.4 Off 0.2", "Idle"),
    ] {
        let parsed = parse(&format!("{class} (DEFINSTANCE P Pump {init})"));
        assert_eq!(component_modes(&parsed.file)[0].initial, first, "{init}");
    }
}

#[test]
fn options_and_priors_are_laid_out_on_their_lines() {
    let text = "(defoption entailment\n 0.95)\n(DEFINSTANCE P Pump INIT Off 0.9\n Idle 0.1)\n(DEFINSTANCE Q Pump INIT *)\n";
    let laid_out = "(defoption entailment 0.95)\n(DEFINSTANCE P Pump INIT Off 0.9 Idle 0.1)\n(DEFINSTANCE Q Pump INIT *)\n";
    assert_eq!(format(text), laid_out);
    assert_eq!(format(laid_out), laid_out);
}

#[test]
fn forms_in_time_are_read_with_their_durations_and_laid_out() {
    let text = "(DEFSTEP 100 ms)
Main ():: (WARP 2 (SEQUENCE (TIMEOUT 5 s (x = a) (y = b)) (WITHIN 1 s 2min (WAIT 3)) (AT 1h (EVERY 250ms (x = b)))
 (WHENEVER-DONEXT ~(HELD 2 s ~(x = a)) (LOCK (y = a) (CHOOSE-PROB (0.5 (REWARD 2)) (0.5 (x = a)))))))";
    let parsed = parse(text);
    assert_eq!(parsed.diagnostics, []);
    assert_eq!(parsed.file.step_secs().to_string(), "0.1");
    let mut durations = Vec::new();
    let mut left = vec![&parsed.file.definitions[0].body];
    while let Some(expression) = left.pop() {
        durations.extend(expression.durations().into_iter().map(|name| name.text.as_str()));
        left.extend(expression.parts().into_iter().rev());
    }
    assert_eq!(durations, ["5 s", "1 s", "2min", "3", "1h", "250ms", "2 s"]);
    let once = format(text);
    assert_eq!(format(&once), once, "{once}");
    assert_eq!(outline(&parse(&once).file), outline(&parsed.file), "{once}");
    assert!(once.contains("(TIMEOUT 5 s (x = a) (y = b))"), "{once}");
}

#[test]
fn a_duration_may_be_a_parameter_and_is_checked_where_it_is_handed_over() {
    let text = |given: &str| format!("P (d s):: (TIMEOUT d (WAIT 3 s)) Main ():: (P {given} x)");
    assert_eq!(parse(&text("5s")).diagnostics.len(), 1, "`s` is a parameter there, so WAIT has too much");
    let text = |given: &str| format!("P (d):: (SEQUENCE (WAIT d) (x = a)) Main ():: (P {given})");
    assert_eq!(parse(&text("5s")).diagnostics, []);
    for (given, expected) in [("5s", None), ("0s", Some("E-BOUNDS")), ("soon", Some("E-SYNTAX"))] {
        let (_, found) = expand_main(&parse(&text(given)).file);
        assert_eq!(found.first().map(|found| found.code.0), expected, "{given}");
    }
}

#[test]
fn words_of_time_alone_do_not_make_a_mission_a_control_program() {
    assert!(!is_control_text("scenario S = { Drive(at), Move(wait); }"));
    assert!(!is_control_text("<?xml version=\"1.0\"?>\n<dispatch>(MODE=A)</dispatch>"));
    assert!(is_control_text("(WAIT 3)"));
    assert!(is_control_text("(TIMEOUT 3 (x = a))"));
}

const METHODS: &str = "(DEFCLASS Driver () (MODE Off true) (MODE On true) (METHOD on () (self = On)))
(DEFCLASS Valve () (PORT driver Driver) (PART seat Seat) (VAR flow {no yes})
  (MODE Closed true) (MODE Open true)
  (METHOD open (d c) (SEQUENCE (driver.on) (WAIT d) (seat.press) (PARALLEL (self = Open) c (flow = yes) (seat = Dry))))
  (METHOD shut () (WHEN-DONEXT ~(driver = Off) (DO-WATCHING (flow = no) (self = Closed)))))
(DEFCLASS Quick (Valve) (METHOD shut () (self = Closed)))
(DEFCLASS Seat () (MODE Dry true) (METHOD press () (self = Dry)))
(DEFINSTANCE D Driver) (DEFINSTANCE V Valve (driver D)) (DEFINSTANCE Q Quick (driver D))
";

/// A program laid out in one line, after its calls are expanded.
fn expanded(program: &str) -> Result<String, Vec<&'static str>> {
    let parsed = parse(&format!("{METHODS}{program}"));
    let (body, found) = expand_main(&parsed.file);
    let codes: Vec<&str> = parsed.diagnostics.iter().chain(&found).map(|found| found.code.0).collect();
    if codes.is_empty() { Ok(shown(&body.expect("a program"))) } else { Err(codes) }
}

fn shown(expression: &Expression) -> String {
    let parts: Vec<String> = expression.parts().into_iter().map(shown).collect();
    let own = match &expression.kind {
        ExpressionKind::Assert(constraint) => constraint.to_string(),
        ExpressionKind::Wait(duration) => format!("wait {}", duration.text),
        _ => expression.guard().map(ToString::to_string).unwrap_or_default(),
    };
    if parts.is_empty() { own } else { format!("{own}[{}]", parts.join(" ")) }
}

#[test]
fn a_method_means_its_component_and_what_is_at_its_ports_and_inside_it() {
    assert_eq!(
        expanded("Main ():: (V.open 3s (X = y))").as_deref(),
        Ok("[D=On wait 3s V.seat=Dry [V=Open X=y V.flow=yes V.seat=Dry]]")
    );
    assert_eq!(expanded("Main ():: (V.shut)").as_deref(), Ok("~D=Off[V.flow=no[V=Closed]]"));
    assert_eq!(expanded("Main ():: (Q.shut)").as_deref(), Ok("Q=Closed"), "the most specific method counts");
    assert_eq!(expanded("Main ():: (V.open 3s)"), Err(vec!["E-ARITY", "E-UNDEF"]));
    assert_eq!(expanded("Main ():: (V.turn)"), Err(vec!["E-UNDEF", "E-UNDEF"]));
    // Without a plant, methods may be those of another text.
    assert_eq!(parse("Main ():: (V.turn)").diagnostics, []);
}

#[test]
fn methods_that_call_each_other_in_a_cycle_are_one_mistake() {
    let text = "(DEFCLASS A () (MODE M true) (METHOD one () (two)) (METHOD two () (self.one)))
(DEFINSTANCE a A) (DEFINSTANCE b A)
Main ():: (a.one)";
    let codes: Vec<&str> = parse(text).diagnostics.iter().map(|found| found.code.0).collect();
    assert_eq!(codes, ["E-RECURSION"]);
}

#[test]
fn parts_and_methods_are_laid_out_like_other_fields() {
    let text = "(DEFCLASS V () (PART seat Seat (owner self) INIT Dry 0.5 Wet 0.5) (METHOD open (d) (SEQUENCE (WAIT d) (self = Open)))\n  (TRANSITION * Open (cmd = open) 0.5) (FAULT * Stuck 0.001 (cmd = open)) (VAR v {x y} OBSERVABLE ERROR 0.1))\n";
    let laid_out = format(text);
    assert_eq!(format(&laid_out), laid_out);
    assert!(laid_out.contains("(METHOD open (d) (SEQUENCE (WAIT d) (self = Open)))"), "{laid_out}");
    assert!(laid_out.contains("(FAULT * Stuck 0.001 (cmd = open))"), "{laid_out}");
    assert_eq!(parse(&laid_out).diagnostics, []);
}
