//! What is checked of a model's text, and what classes inherit.

use plant::compile;

fn found(text: &str) -> Vec<(&'static str, String)> {
    let parsed = rmpl::control::parse(text);
    assert_eq!(parsed.diagnostics, [], "{text}");
    compile(&parsed.file).1.into_iter().map(|found| (found.code.0, found.message)).collect()
}

#[test]
fn each_mistake_in_a_model_gives_one_diagnostic_with_its_code() {
    for (text, code) in [
        ("(DEFCLASS A () (MODE M true)) (DEFCLASS A () (MODE M true))", "E-DUP"),
        ("(DEFCLASS A (B) (MODE M true))", "E-UNDEF"),
        ("(DEFCLASS A (B) (MODE M true)) (DEFCLASS B (A) (MODE N true))", "E-RECURSION"),
        (
            "(DEFCLASS X () (MODE M true)) (DEFCLASS Y () (MODE M true)) (DEFCLASS A (X Y)) (DEFCLASS B (Y X)) (DEFCLASS C (A B))",
            "E-FORM",
        ),
        ("(DEFCLASS A () (MODE M (v = x)))", "E-UNDEF"),
        ("(DEFCLASS A () (VAR v {x y}) (MODE M (v = z)))", "E-VALUE"),
        ("(DEFCLASS A () (VAR v {x y} OBSERVABLE SHOWS z) (MODE M true))", "E-VALUE"),
        ("(DEFCLASS A () (COMMAND c {none go}) (MODE M (c = go)))", "E-CONSTRAINT"),
        ("(DEFCLASS A () (COMMAND c {none go}) (MODE M true) (TRANSITION M N (c = go)))", "E-UNDEF"),
        ("(DEFCLASS A () (MODE M true) (MODE N true) (FAULT M N 1.5))", "E-PROBABILITY"),
        (
            "(DEFCLASS A () (MODE M true) (MODE N true) (MODE O true) (FAULT M N 0.6) (FAULT M O 0.6))",
            "E-PROBABILITY",
        ),
        ("(DEFCLASS A () (MODE M true)) (DEFINSTANCE a A INIT N)", "E-UNDEF"),
        ("(DEFCLASS A () (MODE M true)) (DEFINSTANCE a B)", "E-UNDEF"),
        ("(DEFCLASS A () (PORT p A) (MODE M true)) (DEFINSTANCE a A)", "E-ARITY"),
        (
            "(DEFCLASS A () (MODE M true)) (DEFCLASS B () (PORT p A) (MODE M true)) (DEFINSTANCE b B (p b))",
            "E-VALUE",
        ),
        ("(DEFCLASS A () (VAR v {x y})) (DEFCLASS B (A) (VAR v {z}) (MODE M true))", "E-VALUE"),
        ("(DEFCLASS A () (VAR v {x})) (DEFINSTANCE a A)", "E-FORM"),
        ("(DEFCLASS A () (MODE M true)) (DEFINSTANCE a A) (DEFINSTANCE a A)", "E-DUP"),
    ] {
        let found = found(text);
        assert_eq!(found.iter().map(|(code, _)| *code).collect::<Vec<_>>(), [code], "{text}: {found:?}");
    }
}

#[test]
fn a_class_inherits_modes_domains_and_arcs_and_the_most_specific_arc_wins() {
    let text =
        "(DEFCLASS Base () (VAR v {x y z}) (COMMAND c {none go stop}) (MODE M (NOT (v = z))) (MODE N true)
                  (TRANSITION M N (c = go)) (FAULT M N 0.1))
                (DEFCLASS Derived (Base) (VAR v {y z} OBSERVABLE) (MODE M true) (TRANSITION M N (c = stop)))
                (DEFINSTANCE d Derived)";
    let parsed = rmpl::control::parse(text);
    let model = compile(&parsed.file).0.expect("a model");
    assert_eq!(model.variables[0].values, ["y", "z"]);
    assert!(model.variables[0].observable);
    let mode = &model.components[0].modes[0];
    assert_eq!(
        mode.transitions.iter().map(|transition| transition.label.as_str()).collect::<Vec<_>>(),
        ["c=stop"]
    );
    assert_eq!(mode.faults.len(), 1);
    let entailed = model.entailed_values(&model.initial_state(), &plant::Observation::default());
    assert_eq!(
        entailed,
        [(plant::VariableId(0), 0)],
        "both constraints of M hold: of y and z only y is left"
    );
}
