//! Models of our own in JMPL, and what becomes of them.

use super::{JmplError, SourceFile, translate};
use crate::Translation;

const PIPES: &str = "
// Water in a pipe.
enum Sign { positive, zero, negative } {
    relation opposite (Sign other) {
        if (this = positive) other = negative;
        if (this = negative) other = positive;
        iff (this = zero) other = zero;
    }
};
class Water { Sign flow; Sign pressure; }
class Pipe extends Water {
    relation still () { flow = zero & pressure = zero; }
}
enum TapCommand { open, close, noCommand };
class Tap {
    Pipe in;
    Pipe out;
    TapCommand command;
    private Sign back;
    private enum Mode { stuck, closed, opened };
    private Mode mode;
    stateVector [mode];
    {
        in.flow.opposite(back);
        switch (mode) {
            case opened: in = out;
            case closed: case stuck: { out.still(); }
        }
    }
    transition openIt (closed, opened) { command == open; in.pressure != zero; }
    transition closeIt (opened, closed, 3) { command = close; }
    failure stick (*, stuck, 1.0e-3) {}
}
";

fn file(name: &str, text: &str) -> SourceFile {
    SourceFile { name: name.to_owned(), text: text.to_owned() }
}

fn read(text: &str) -> Translation {
    translate(&[file("a.jmpl", text)], &[]).expect("it can be read")
}

fn has(model: &Translation, part: &str) {
    let words = model.text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains(part), "{part}\n{}", model.text);
}

#[test]
fn a_class_with_structures_and_relations_becomes_a_class_with_parts() {
    let model = read(PIPES);
    assert_eq!(model.left_out, [""; 0]);
    for part in [
        "(DEFCLASS Water () (VAR flow {positive zero negative} OBSERVABLE)",
        "(DEFCLASS Pipe (Water))",
        "(PART in Pipe) (PART out Pipe)",
        "(COMMAND command {noCommand open close})",
        "(VAR back {positive zero negative})",
        // The relation is written out, and the mode that no failure leads to is the first one.
        "(MODE closed (((NOT (in.flow = positive)) OR (back = negative))",
        "(out.flow = zero) AND (out.pressure = zero)",
        "(in.flow = out.flow) AND (in.pressure = out.pressure)",
        "(TRANSITION closed opened ((command = open) AND (NOT (in.pressure = zero))))",
        "(TRANSITION opened closed (command = close))",
        "(FAULT * stuck 0.001)",
        "(DEFINSTANCE Tap Tap)",
    ] {
        has(&model, part);
    }
    assert!(model.remarks.iter().any(|remark| remark.contains("costs of transitions")), "{model:?}");
    let parsed = rmpl::control::parse(&model.text);
    assert_eq!(parsed.diagnostics, []);
}

#[test]
fn what_is_not_known_is_left_out_with_its_line() {
    let model = read(
        "class Lamp {
            enum Light { dark, bright } light;
            enum M { on, off, gone, never } mode;
            stateVector [mode];
            Socket socket;
            {
                switch (mode) {
                    case on: light = bright; socket.current = high;
                    case off: light = dim;
                    case never: mode = on;
                }
                light.shine();
            }
            transition (on, out) { }
            transition (on, off) { switch_position = down; }
            failure (*, gone, sometimes) { }
            failure ([on, off], gone, 0.1) { }
        }",
    );
    let told = [
        "a.jmpl:1: the mode `never` of `Lamp`",
        "a.jmpl:5: the attribute `socket`: unknown type `Socket`",
        "a.jmpl:8: unknown name `socket.current`",
        "a.jmpl:9: `dim` is not a value of the type `Light`",
        "a.jmpl:12: unknown relation `light.shine`",
        "a.jmpl:14: this transition: `Lamp` has no mode `out`",
        "a.jmpl:15: this transition: unknown names `switch_position` and `down`",
        "a.jmpl:16: this failure: `sometimes` is not a probability",
        "a.jmpl:17: this failure: a state vector of several variables",
    ];
    assert_eq!(model.left_out.len(), told.len(), "{:#?}", model.left_out);
    for (line, start) in model.left_out.iter().zip(told) {
        assert!(line.starts_with(start), "{line}");
    }
    has(&model, "(MODE on (light = bright)) (MODE off true) (MODE gone true)");
    has(&model, "; Not read: a.jmpl:8: unknown name");
}

#[test]
fn a_harness_says_what_is_observed_and_commanded_and_where_components_start() {
    let system = "
        enum Position { up, down }
        class Gate { Position command; Position position; Position hidden; enum M { low, high } m; stateVector m;
            { switch (m) { case low: position = down; case high: position = up; } }
            transition (low, high) { command = up; } }
        class Yard { Gate left; Gate right; Position lever; { lever = left.command; right.command = lever; } }";
    let harness = "<xmpl><mplHarness name='x' version='1'><obs name='yard.left.position'/><obs name='yard.right.position'/>
        <cmd name='yard.lever'/></mplHarness></xmpl>";
    let initial = "<!DOCTYPE mplInit [<!ELEMENT mplInit (assign*)>]>
        <mplInit><assign eq='yard.left.m=high'/><assign eq='yard.right.m=low'/></mplInit>";
    let files = [file("yard.jmpl", system), file("yard.hrn", harness), file("yard.ini", initial)];
    let model = translate(&files, &[]).expect("it can be read");
    assert_eq!(model.left_out, [""; 0]);
    for part in [
        "(VAR position {up down} OBSERVABLE) (VAR hidden {up down}) (MODE",
        "(PART left Gate) (PART right Gate INIT low) (PART lever Position-line)",
        // The type has no idle value: the command lasts.
        "(DEFCLASS Position-line () (COMMAND cmd {none up down}) (MODE up true) (MODE down true)",
        "(DEFINSTANCE yard Yard)",
    ] {
        has(&model, part);
    }
    assert!(model.remarks.iter().any(|remark| remark.contains("one step after it is given")), "{model:?}");
    let broken =
        [file("yard.jmpl", system), file("yard.hrn", "<xmpl><mplHarness><obs/></mplHarness></xmpl>")];
    let error = translate(&broken, &[]).expect_err("an observation without a name").to_string();
    assert!(error.contains("yard.hrn") && error.contains("`obs` has no `name`"), "{error}");
}

#[test]
fn classes_of_a_library_are_written_if_they_are_needed() {
    let library = [
        file(
            "lamp.jmpl",
            "class Lamp { enum M { on, gone } m; stateVector [m]; failure (on, gone, likely) {} }",
        ),
        file("unused.jmpl", "class Unused { }"),
        file("broken.jmpl", "class {"),
    ];
    let model = translate(&[file("house.jmpl", "class House { Lamp hall; }")], &library).expect("read");
    has(&model, "(DEFCLASS House () (PART hall Lamp) (MODE ok true))");
    has(&model, "(FAULT on gone 0.1)");
    assert!(!model.text.contains("Unused") && model.left_out.is_empty(), "{model:?}");
    let numbers = file("symbols.jmpl", "enum symbols { likely = \"0.05\" };");
    let model =
        translate(&[file("house.jmpl", "class House { Lamp hall; }"), numbers], &library).expect("read");
    has(&model, "(FAULT on gone 0.05)");
}

#[test]
fn what_is_not_jmpl_is_refused_with_its_line() {
    let refused = |text: &str| translate(&[file("a.jmpl", text)], &[]).expect_err(text).to_string();
    for (text, told) in [
        ("class A {\n  on off\n}", "a.jmpl, line 3: expected `;`, found `}`"),
        ("class A {\n{ a = b; /* no end\n}", "a.jmpl, line 2: this comment is not closed"),
        ("#include \"x\"", "line 1: unrecognized character `#`"),
        ("enum A { a, b };", "declares enumerations only"),
        ("class A { { if a = b; } }", "expected `(`"),
        ("interface A", "expected `class` or `enum`"),
    ] {
        assert!(refused(text).contains(told), "{text}: {}", refused(text));
    }
    let deep = format!("class A {{ {} }}", "{".repeat(100_000));
    assert!(refused(&deep).contains("nest more than"), "{}", refused(&deep));
}

/// Each relation calls the previous one twice.
#[test]
fn relations_that_grow_when_they_are_written_out_are_refused() {
    let mut text = "enum E { a, b } class A { E e; relation r0 () { e = a; }\n".to_owned();
    for at in 1..40 {
        text += &format!("relation r{at} () {{ r{0}(); r{0}(); }}\n", at - 1);
    }
    text += "{ r39(); } relation again () { again(); } { again(); } }";
    let found = translate(&[file("a.jmpl", &text)], &[]);
    assert!(matches!(found, Err(JmplError::TooMany { .. })), "{found:?}");
    let model = read("enum E { a, b } class A { E e; relation again () { again(); } { again(); } }");
    assert!(model.left_out[0].contains("`again` calls itself"), "{model:?}");
    // A class inside itself is an error of the model, which its compiler reports.
    has(&read("class A { A a; B b; { a = b.a; } } class B { A a; A c; }"), "(PART a A)");
    assert!(
        translate(&[file("a.jmpl", "class A { A a; { a = a; } enum M { x } m; stateVector m; }")], &[])
            .is_ok()
    );
}

#[test]
fn a_text_that_ends_anywhere_is_answered() {
    for (end, _) in PIPES.char_indices() {
        let _ = translate(&[file("a.jmpl", &PIPES[..end])], &[]);
        let _ = translate(&[file("a.jmpl", &format!("{}{}", &PIPES[..end], &PIPES[end + 1..]))], &[]);
    }
}
