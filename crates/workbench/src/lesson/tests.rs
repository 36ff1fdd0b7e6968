//! What is read of a lesson, what is said of mistakes in one, and what expressions come to.

use std::collections::BTreeSet;

use exact::Rational;

use super::*;
use crate::description::Description;
use crate::panel_kind::PanelKind;
use crate::registry::read_lesson;
use crate::state::AppState;
use crate::workspace::Workspace;

const WHOLE: &str = r#"---
about: Something
mission: enroute
search: both
---
# A title

Prose with {{steps}} steps.

```show
panels: network / search | editor, plan
workspace: teach
search: conflict-directed
step: 2nd failure with D1
select: D1
near: network
time: 12.5
do: view.panel {"name": "plan"}
```

## Another stop

```rmpl mission
scenario S { }
```

```ask
What is
right?
- [ ] No
- [x] Yes
- [if plan and steps > 3] Sometimes
hint: Think
  twice.
because: So.
```

## The last one

```ask
Do it.
task: choice(D1) = 1
solution: "a" becomes "b"
solution: search.goTo {"step": 4}
```
"#;

fn errors(text: &str) -> Vec<(u32, String)> {
    let (_, errors) = read_lesson("x", text);
    errors.into_iter().map(|error| (error.line, error.message)).collect()
}

/// A lesson whose second stop has these lines, which begin in line 7.
fn with(lines: &str) -> String {
    format!("---\nmission: enroute\n---\n# T\n\n## S\n{lines}\n")
}

/// Checks that a stop with these lines has exactly one mistake, in this line, with these words.
fn check(lines: &str, line: u32, words: &str) {
    let found = errors(&with(lines));
    assert_eq!(found.len(), 1, "{lines}: {found:?}");
    assert!(found[0].0 == line && found[0].1.contains(words), "{lines}: {found:?}");
}

#[test]
fn a_whole_lesson_is_read() {
    let (lesson, errors) = read_lesson("whole", WHOLE);
    assert_eq!(errors, []);
    assert_eq!((lesson.title.as_str(), lesson.about.as_str()), ("A title", "Something"));
    assert_eq!((&lesson.mission, lesson.search), (&LessonMission::Example("enroute"), LessonSearch::Both));
    let titles: Vec<(&str, u32)> = lesson.stops.iter().map(|stop| (stop.title.as_str(), stop.line)).collect();
    assert_eq!(titles, [("A title", 6), ("Another stop", 21), ("The last one", 38)]);
    let show = &lesson.stops[0].show;
    assert_eq!(
        show.panels,
        [
            vec![vec![PanelKind::Network]],
            vec![vec![PanelKind::Search], vec![PanelKind::Editor, PanelKind::Plan]]
        ]
    );
    assert_eq!((show.workspace, show.side, show.time), (Some(Workspace::Teach), 1, Some(12.5)));
    let step = StepTarget::Kind { which: Which::Nth(2), kind: StepKind::Failure, with: "D1".to_owned() };
    assert_eq!((show.step.clone(), show.select.clone()), (Some((14, step)), Some((15, "D1".to_owned()))));
    assert_eq!((&show.near[..], show.commands.len()), (&[PanelKind::Network][..], 1));
    let ask = lesson.stops[1].ask.as_ref().expect("a question");
    assert_eq!((ask.text.as_str(), ask.hint.as_str()), ("What is right?", "Think twice."));
    let Answer::Choice(choices) = &ask.answer else { panic!("choices") };
    assert_eq!(choices.len(), 3);
    assert_eq!(lesson.stops[2].ask.as_ref().map(|ask| ask.solution.len()), Some(2));
    // From the second stop on, there is another mission.
    let missions: Vec<&str> = (0..3).map(|stop| lesson.mission_at(stop).source()).collect();
    assert_ne!(missions[0], missions[1]);
    assert_eq!((missions[1], missions[2]), ("scenario S { }\n", "scenario S { }\n"));
}

#[test]
fn a_mistake_is_told_with_its_line_and_what_would_be_right() {
    check("{{nonsense}}", 7, "unknown name `nonsense`");
    check("{{earliest}}", 7, "`earliest(Drive#1.start)`");
    check("{{steps + }}", 7, "unexpected end");
    check("[a](language.md#nowhere)", 7, "the manual has no page or section");
    check("```show\nstop: 3\n```", 8, "unknown key `stop` in `show`");
    check("```show\npanels: nowhere\n```", 8, "unknown panel `nowhere`");
    check("```show\npanels: plan / plan\n```", 8, "twice");
    check("```show\n\nstep: 3rd nonsense\n```", 9, "negative cycle");
    check("```show\nstep: any failure\n```", 8, "last");
    check("```show\nnear: plan\n```", 8, "cannot be zoomed");
    check("```show\nwords\n```", 8, "key: value");
    check("```show\ndo: no.command\n```", 8, "unknown command");
    check("```show\nmission: nowhere\n```", 8, "unknown example");
    check("```ask\nWhat?\n```", 7, "the answer is missing");
    check("```ask\nnumber: 3\n```", 7, "the question is missing");
    check("```ask\nWhat?\nnumber: 3\nword: choice(D1)\n```", 10, "one answer");
    check("```ask\nWhat?\n- [x] one\n```", 7, "at least two");
    let (read, errors) =
        Lesson::read("x", &with("```ask\nWhat?\n- [x] one\n  and more\n- [ ] two\nhint: a\n  b\n```"));
    let ask = read.stops[1].ask.as_ref().expect("it asks");
    let Answer::Choice(choices) = &ask.answer else { panic!("{ask:?}") };
    assert_eq!((choices[0].text.as_str(), ask.hint.as_str(), errors.len()), ("one and more", "a b", 0));
    check("```ask\nWhat?\n- [x] one\n- two\n- [ ] three\n```", 10, "a choice must start with");
    check("```ask\nWhat?\npredict: weather\n```", 9, "`estimate of` a component");
    check("```ask\nWhat?\npredict: estimate of \n```", 9, "`estimate of` a component");
    check("```ask\nWhat?\ntask: plan\nsolution: \"a\" instead\n```", 10, "becomes");
    let two = "```ask\nA?\nnumber: 1\n```\n\n```ask\nB?\nnumber: 1\n```";
    check(two, 12, "one question");
}

#[test]
fn a_lesson_needs_a_title_and_a_mission() {
    assert!(errors("").iter().any(|(line, text)| *line == 1 && text.contains("title")));
    assert!(errors("# T\n").iter().any(|(_, text)| text.contains("needs a mission")));
    assert_eq!(errors("# T\n\n```rmpl\nscenario S { }\n```\n"), []);
    assert_eq!(errors("---\nmission: nowhere\nsearch: fast\nmood: good\n---\n# T\n").len(), 3);
}

fn value(text: &str) -> Option<Value> {
    Expression::read(text).expect("an expression").value(&Description::of(&AppState::new()))
}

#[test]
fn expressions_count_and_compare() {
    let number = |number: i64| Some(Value::Number(Rational::from_integer(number)));
    assert_eq!(value("1 + 2 * 3 - 4 / 2"), number(5));
    assert_eq!(value("-(1 - 4) * 2"), number(6));
    assert_eq!(value("1 < 2 and not 2 < 1 or 1 = 2"), Some(Value::Truth(true)));
    assert_eq!(value("\"Deploy#1\" = \"deploy#1\""), Some(Value::Truth(true)));
    assert_eq!(value("1 = \"1\""), None, "a number is no word");
    assert_eq!(value("1 / 0"), None);
    assert_eq!(value("if 1 < 2 then 3 else 4 + 5"), number(3));
    assert_eq!(value("1 + (if 1 > 2 then 3 else if 1 = 1 then 5 else 6)"), number(6));
    assert_eq!(value("if plan then 1 else 2"), None, "whether there is a plan is not known");
    // Nothing has been worked out in this state.
    assert_eq!(value("backtracks > 3"), None);
    assert_eq!(value("earliest(Tell(A=B)#1.start)"), None, "names have parentheses of their own");
    for wrong in ["", "1 +", "(1", "1 2", "\"a", "plan(x)", "D1", "if 1 = 1 then 2", "if 1 = 1 else 2"] {
        assert!(Expression::read(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn answers_are_judged() {
    let state = AppState::new();
    let known = Description::of(&state);
    let number =
        Answer::Number(Expression::read("5 / 2").expect("a number"), Rational::new(1, 10).expect("a tenth"));
    for (given, is_right) in [("2.5", true), ("2,5", true), ("2.45", true), ("2.3", false), ("two", false)] {
        assert_eq!(number.is_right(given, &known), Some(is_right), "{given}");
    }
    let word = Answer::Word(Expression::read("\"Deploy#1\"").expect("a word"));
    assert_eq!(word.is_right(" deploy#1 ", &known), Some(true));
    assert_eq!(word.is_right("Stow#1", &known), Some(false));
    // Right in other words, and wrong in words that look like it.
    let minutes = Answer::Number(Expression::read("20").expect("a number"), Rational::ZERO);
    for given in ["20", " 20 min", "20 minutes.", "20,0", "+20", "40/2", "20 %", "20min"] {
        assert_eq!(minutes.is_right(given, &known), Some(true), "{given}");
    }
    for given in
        ["", "2", "-20", "−20", "20 to 30", "20-30", "20 30", "min", "about 20", "200", "20,5", "two"]
    {
        assert_eq!(minutes.is_right(given, &known), Some(false), "{given}");
    }
    let two = Answer::Number(Expression::read("2").expect("a number"), Rational::ZERO);
    assert_eq!(
        ["two", "Two", "twelve"].map(|it| two.is_right(it, &known)),
        [Some(true), Some(true), Some(false)]
    );
    let marks = Answer::Word(Expression::read("\"assert x=a, when s=on\"").expect("words"));
    for given in [
        "assert x=a, when s=on",
        "when s = on, assert x = a",
        "`assert x=a`,`when s=on`",
        "Assert X=A , when s=on.",
    ] {
        assert_eq!(marks.is_right(given, &known), Some(true), "{given}");
    }
    for given in ["assert x=a", "assert x=b, when s=on", "assertx=a, when s=on", "assert x=a when s=on", ""] {
        assert_eq!(marks.is_right(given, &known), Some(false), "{given}");
    }
    let goal = Answer::Word(Expression::read("\"lamp=on\"").expect("a word"));
    for (given, is_right) in
        [("(lamp = on)", true), ("“lamp=on”", true), ("lamp", false), ("lamp=off", false)]
    {
        assert_eq!(goal.is_right(given, &known), Some(is_right), "{given}");
    }
    let tell = Answer::Word(Expression::read("\"Tell(PATH1=OK)#1\"").expect("a word"));
    for (given, is_right) in
        [("tell (PATH1 = OK) #1", true), ("Tell(PATH1=OK)", false), ("Tell(PATH1=OK)#2", false)]
    {
        assert_eq!(tell.is_right(given, &known), Some(is_right), "{given}");
    }
    assert_eq!(number.right_now(&known).as_deref(), Some("2.5"));
}

#[test]
fn the_manual_lists_every_fact_and_every_kind_of_step() {
    let manual = include_str!("../../../../docs/lessons.md");
    let mut names = BTreeSet::new();
    for fact in facts::all() {
        assert!(names.insert(fact.name), "{} is there twice", fact.name);
        let shown = match fact.of {
            facts::Of::Nothing => format!("| `{}` |", fact.name),
            facts::Of::Something(what) | facts::Of::Maybe(what) => format!("| `{}({what})` |", fact.name),
        };
        let row = manual.lines().find(|line| line.starts_with(&shown));
        let row = row.unwrap_or_else(|| panic!("docs/lessons.md has no row that begins with {shown}"));
        assert!(row.contains(fact.meaning), "{row} does not say: {}", fact.meaning);
    }
    for (name, _) in StepKind::ALL {
        assert!(manual.contains(&format!("`{name}`")), "docs/lessons.md does not name the step `{name}`");
    }
}
