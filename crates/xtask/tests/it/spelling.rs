//! Code, comments and documents are spelled in American English, because a search finds a word
//! only if it is spelled in one way.

use std::path::Path;
use std::sync::LazyLock;

use regex::Regex;

use crate::citations::texts;

/// British spellings, also as parts of names.
static BRITISH: LazyLock<Regex> = LazyLock::new(|| {
    let parts = [
        "colour|behaviour|neighbour|favour|honour|centre|metre|licence|catalogue|artefact|judgement",
        r"labell(ed|ing)|modell(ed|ing)|travell(ed|er|ing)|cancell(ed|ing|able)|analys(e|ed|es|ing)\b",
        r"\bgrey|towards|whilst|amongst|learnt|spelt|fulfil\b",
        "(optim|minim|maxim|organ|initial|normal|general|serial|visual|synchron|parenthes|linear|character|summar|\
         recogn|prior|util|final|special|discret|parallel)is(e|ed|es|ing|ation)",
    ];
    Regex::new(&format!("(?i){}", parts.join("|"))).expect("a pattern")
});

/// What is right all the same: the keyword of the language, units as files write them, and names of other libraries.
static RIGHT: LazyLock<Regex> = LazyLock::new(|| {
    let keyword = r"per\s+metre";
    let quoted = r#"["`](centi|kilo)?metres?["`\\]"#;
    let of_others = "labelled_?by";
    Regex::new(&format!("(?i){keyword}|{quoted}|{of_others}")).expect("a pattern")
});

/// Files that have such words for a reason.
const ALLOWED: [(&str, &str); 4] = [
    ("crates/xtask/tests/it/spelling.rs", "lists them"),
    ("crates/xtask/tests/it/wording.rs", "lists them"),
    ("tests/conformance/README.md", "a copy of the suite's text"),
    ("tests/suite/05-activities.md", "an option with any name"),
];

/// The British spellings of a text, with their lines from 1.
fn british(text: &str) -> Vec<(usize, String)> {
    // As long as before, so that lines stay.
    let text = RIGHT.replace_all(text, |found: &regex::Captures<'_>| {
        found[0].chars().filter(|it| *it == '\n').collect::<String>()
    });
    let found = BRITISH.find_iter(&text);
    found.map(|found| (text[..found.start()].matches('\n').count() + 1, found.as_str().to_owned())).collect()
}

#[test]
fn british_spellings_are_found_also_in_names() {
    let found = |text: &str| british(text).into_iter().map(|(_, word)| word).collect::<Vec<_>>();
    assert_eq!(found("NEIGHBOURS and a cell_centre"), ["NEIGHBOUR", "centre"]);
    assert_eq!(found("normalised, labelled\nand cancelled"), ["normalise", "labelled", "cancelled"]);
    assert_eq!(british("a\n\nin metres"), [(3, "metre".to_owned())]);
    for right in
        ["`per\nmetre`", "\"metres\"", ".labelled_by(name)", "canceled, color, cancellation, ModelLabel"]
    {
        assert_eq!(found(right), Vec::<String>::new(), "{right}");
    }
}

#[test]
fn code_comments_and_documents_are_spelled_in_american_english() {
    let mut wrong = Vec::new();
    let mut used = Vec::new();
    for (path, text) in texts() {
        let found = british(&text);
        match ALLOWED.iter().find(|(file, _)| path == Path::new(file)) {
            Some(allowed) if !found.is_empty() => used.push(allowed),
            _ => wrong.extend(found.iter().map(|(line, word)| format!("{}:{line}: {word}", path.display()))),
        }
    }
    assert!(wrong.is_empty(), "{} British spellings:\n{}", wrong.len(), wrong.join("\n"));
    assert_eq!(used.len(), ALLOWED.len(), "only these exceptions are needed: {used:?}");
}
