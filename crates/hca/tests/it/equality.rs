//! `(x = y)` between two variables that have one domain (SPEC 2.2).

use hca::{Vocabulary, compile_text};

fn vocabulary() -> Vocabulary {
    let values = |values: &[&str]| values.iter().map(|value| (*value).into()).collect();
    let domains = [("a", values(&["x", "y"])), ("b", values(&["y", "x"])), ("c", values(&["x"]))];
    Vocabulary {
        domains: domains.into_iter().map(|(name, values)| (name.into(), values)).collect(),
        ..Vocabulary::default()
    }
}

#[test]
fn a_guard_holds_when_both_variables_are_known_to_be_equal() {
    for (guard, steps) in [("(a = b)", 3), ("(NOT (a = b))", 1), ("~(a = b)", 1)] {
        let text = format!("(WHEN-DONEXT {guard} (c = x))");
        let compilation = compile_text(&text, &vocabulary());
        assert_eq!(compilation.diagnostics, [], "{text}");
        let automaton = compilation.automaton.expect("an automaton");
        let estimates = [("x", "y"), ("y", "x"), ("y", "y"), ("y", "y")]
            .map(|(a, b)| automaton.estimate([("a", a), ("b", b), ("c", "x")]));
        let run = hca::trace(&automaton, &estimates);
        let asserted =
            run.steps.iter().position(|step| step.labels.iter().any(|it| it.starts_with("assert")));
        assert_eq!(asserted, Some(steps), "{text}");
    }
}

#[test]
fn variables_with_different_domains_cannot_be_equal() {
    let found = compile_text("(WHEN-DONEXT (a = c) (c = x))", &vocabulary()).diagnostics;
    assert_eq!(found.iter().map(|it| it.code.0).collect::<Vec<_>>(), ["E-VALUE"]);
    assert_eq!(found[0].message, "`a` and `c` have different domains");
}
