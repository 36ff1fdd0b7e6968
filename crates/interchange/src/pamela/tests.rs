//! Classes of our own in Pamela, and what becomes of them.

use super::translate;
use crate::Translation;

fn read(text: &str) -> Translation {
    translate("a.pamela", text).expect("it can be read")
}

fn has(read: &Translation, part: &str) {
    let words = read.text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains(part), "{part}\n{}", read.text);
}

/// Reads the body of a method of a class with two primitives.
fn body(body: &str) -> Translation {
    read(&format!(
        "(defpclass plant [] :methods [(defpmethod a {{:bounds [1 5]}} []) (defpmethod b [x])])
         (defpclass main [plant] :fields {{door {{:initial \"shut\"}}}} :methods [(defpmethod go [] {body})])"
    ))
}

#[test]
fn each_statement_has_its_form() {
    for (pamela, rmpl) in [
        ("(sequence (plant.a) (plant.b 3))", "scenario go = { { a(); b(n3) } }"),
        ("(parallel :bounds [2 9] (plant.a) (plant.a))", "{ a(), a() } [2,9]"),
        (
            "(choose (choice (plant.a)) (choice :bounds [3 (* 2 4)] (plant.b :red)))",
            "choose { a(), { b(red) } [3,(2*4)] }",
        ),
        ("(choose (choice :guard (= door \"open\") (plant.a)))", "choose { if door=open thennext { a() } }"),
        ("(soft-sequence (plant.a) (plant.a))", "{ optional { a() }; optional { a() } }"),
        ("(slack-sequence (plant.a))", "{ delay; a(); delay }"),
        ("(slack-parallel (plant.a) (plant.a))", "{ { delay; a(); delay }, { delay; a(); delay } }"),
        ("(delay :bounds [3 :infinity])", "delay[3,inf]"),
        ("(dotimes 3 (plant.a))", "repeat 3 { a() }"),
        ("(ask (= door \"open\") :bounds [0 9])", "{ delay; ask door=open } [0,9]"),
        ("(tell (= door \"open\"))", "tell door=open"),
        ("(maintain (= door \"open\") (plant.a))", "{ do { a() } maintaining door=open }"),
        (
            "(when (and (= door \"open\") (not (= lamp true))) (plant.a))",
            "if (door=open and not lamp=true) thennext { a() } else delay[0,0]",
        ),
        ("(unless (= door \"open\") (plant.a))", "if not door=open thennext { a() } else delay[0,0]"),
        ("(plant.a :cost 2.5 :reward 4 :label :first)", "{ costs-2-5-rewards-4(); a() } as first"),
    ] {
        let read = body(pamela);
        assert_eq!(read.left_out, [""; 0], "{pamela}");
        has(&read, rmpl);
        let diagnostics = rmpl::parse(&read.text).diagnostics();
        let errors: Vec<_> = diagnostics.iter().filter(|it| it.severity == rmpl::Severity::Error).collect();
        assert!(errors.is_empty(), "{pamela}: {errors:?}\n{}", read.text);
    }
}

#[test]
fn what_a_mission_cannot_mean_is_left_out_with_its_line() {
    for (pamela, told) in [
        ("(whenever (= door \"open\") (plant.a))", "`whenever`"),
        ("(assert (= door \"open\"))", "`assert`"),
        ("(try (plant.a) (catch (plant.a)))", "`catch`"),
        ("(choose :exactly 2 (choice (plant.a)) (choice (plant.a)))", "`:exactly`"),
        ("(sequence :cost<= 4 (plant.a))", "`:cost<=`"),
        ("(plant.c)", "unknown method `plant.c`"),
        ("(plant.b)", "`plant.b` takes 1 arguments, but has 0 here"),
        ("(plant.a :bounds [6 7])", "the method's own bounds exclude them"),
        ("(plant.a :bounds (lvar \"later\"))", "`lvar` bounds without initial values"),
        ("(ask (> level 3))", "the condition `(> …)`"),
        ("word", "expected a statement"),
    ] {
        let read = body(pamela);
        assert_eq!(read.left_out.len(), 1, "{pamela}: {read:?}");
        assert!(read.left_out[0].starts_with("a.pamela:2: ") && read.left_out[0].contains(told), "{read:?}");
        has(&read, "// Not read: a.pamela:2:");
    }
}

#[test]
fn modes_and_fields_of_objects_are_states() {
    let read = read(
        "(defpclass valve [pipe] :modes {:closed true :open (= flow \"high\")} :fields {flow {:initial \"none\"}}
           :methods [(defpmethod open-it {:pre :closed :post (and :open (= flow \"high\"))} [])])
         (defpclass main [] :fields {left (valve) right (valve)}
           :methods [(defpmethod both [] (parallel (left.open-it) (right.open-it) (ask (= right.flow \"high\"))))])",
    );
    assert_eq!(read.left_out, [""; 0]);
    for part in [
        "state left-mode : {closed, open} = closed;",
        "state right-flow : {high, none} = none;",
        "primitive left-open-it()[0,inf] requires at start left-mode=closed sets left-mode=open, left-flow=high;",
        "scenario both = { { left-open-it(), right-open-it(), { delay; ask right-flow=high } } }",
    ] {
        has(&read, part);
    }
}

#[test]
fn values_that_calls_give_are_values_of_the_state() {
    let read = read(
        "(defpclass plant [] :methods [(defpmethod move {:post (= place to)} [to])])
         (defpclass main [robot] :fields {lamp {:initial \"off\"}}
           :methods [(defpmethod all [] (sequence (go \"mine\") (robot.move \"home\") (ask (= lamp \"off\"))))
                     (defpmethod go [where] (sequence (robot.move where) (tell (= lamp where))))])",
    );
    assert_eq!(read.left_out, [""; 0]);
    has(&read, "state lamp : {mine, off} = off;");
    has(&read, "state place : {home, mine, unknown} = unknown;");
    has(&read, "// Note: no field creates a `main`: its argument `robot` is a `plant`");
}

#[test]
fn classes_with_transitions_and_without_bodies_are_a_plant() {
    let read = read(
        "(defpclass volts [] :modes [:high :none])
         (defpclass switch [out] :modes {:off (= out (mode-of volts :none)) :on (= out (mode-of volts :high)) :dead true}
           :methods [(defpmethod turn-on {:pre :off :post :on :bounds [1 3]} []) (defpmethod reset {:post :off} [])]
           :transitions {:off:on {:pre :off :post :on} :on:off {:pre :on :post :off} :*:dead {:probability 0.001}})
         (defpclass lamp [feed] :fields {wire feed light {:initial \"dark\" :observable true}}
           :modes {:off (and (= wire (mode-of volts :none)) (= light \"dark\")) :on (= light \"bright\") :gone true}
           :transitions {:off:on {:pre (and :off (= wire (mode-of volts :high))) :post :on}
                         :*:gone {:probability (lvar \"p\" 0.1)} :on:gone {:probability (lvar \"q\")}})
         (defpclass house [] :fields {line (lvar \"line\") s (switch line) l (lamp line)})",
    );
    assert_eq!(read.left_out.len(), 1, "{read:?}");
    assert!(read.left_out[0].contains("`:on:gone`: its probability"), "{read:?}");
    for part in [
        "(DEFCLASS switch () (VAR out {high none}) (COMMAND command {none turn-on reset})",
        "(MODE off (out = none)) (MODE on (out = high)) (MODE dead true)",
        "(TRANSITION off on (command = turn-on)) (TRANSITION * off (command = reset)) (FAULT * dead 0.001)",
        "(VAR feed {high none}) (VAR light {dark bright} OBSERVABLE)",
        "(MODE off ((feed = none) AND (light = dark)))",
        "(TRANSITION off on (feed = high)) (FAULT * gone 0.1)",
        "(VAR line {high none}) (PART s switch) (PART l lamp) (MODE ok ((s.out = line) AND (l.feed = line)))",
        "(DEFINSTANCE house house)",
    ] {
        has(&read, part);
    }
    assert_eq!(rmpl::control::parse(&read.text).diagnostics, []);
}

#[test]
fn objects_are_given_and_inherited() {
    let read = read(
        "(defpclass base [] :methods [(defpmethod work {:bounds [1 2]} []) (defpmethod rest [] (delay))])
         (defpclass robot [] :inherit [base] :methods [(defpmethod work {:bounds [3 4]} [])])
         (defpclass job [who] :methods [(defpmethod twice [] (sequence (who.work) (who.work :label :end))
             (between-starts :end :end :bounds [0 1]))])
         (defpclass main [] :fields {r (robot) j (job r)} :methods [(defpmethod all [] (j.twice))])",
    );
    assert_eq!(read.left_out, [""; 0]);
    for part in [
        "primitive work()[3,4];",
        "twice() = { { work(); work() as end } }",
        "constrain end.start to end.start [0,1];",
        "scenario all = { twice() }",
        "scenario rest = { delay }",
    ] {
        has(&read, part);
    }
}

#[test]
fn a_text_that_ends_anywhere_is_answered() {
    let text = "(defpclass a [b] :inherit [a c] :modes {:on (= x \"y\")} :fields {f (a f) g 3}
        :methods [(defpmethod m {:bounds [1 2] :pre :on} [x] (choose (choice :guard (= f.g x) (m 3))) (between :a :b))])";
    assert!(translate("a.pamela", text).is_ok());
    for (end, _) in text.char_indices() {
        let _ = translate("a.pamela", &text[..end]);
        let _ = translate("a.pamela", &format!("{}{}", &text[..end], &text[end + 1..]));
    }
    let deep = "(".repeat(100_000);
    assert!(translate("a.pamela", &deep).expect_err("it is deep").to_string().contains("nest more than"));
}
