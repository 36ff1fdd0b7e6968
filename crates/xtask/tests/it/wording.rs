//! The texts of the interface follow the writing guide: no banned words, and no label, tooltip or message that is too long.
//!
//! The texts are the string literals of the sources below [`FOLDERS`], outside tests, attributes and reasons of panics. To
//! check another crate, add its folder. A word that is right in one place goes to [`ALLOWED`], with the reason.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use regex::Regex;
use xtask::process::root;

/// Where user-visible texts are looked for, below the root.
const FOLDERS: [&str; 7] = [
    "crates/app/src",
    "crates/display/src",
    "crates/editor/src",
    "crates/layout/src",
    "crates/panels/src",
    "crates/terrain_view/src",
    "crates/workbench/src",
];

/// Parts of these folders that are not checked, and why.
const EXCLUDED: [(&str, &str); 2] = [
    ("crates/workbench/src/lesson", "messages to authors of lessons, in the terms of the lesson format"),
    ("crates/workbench/src/manual.rs", "headings and addresses of the manual"),
];

/// Patterns that no text contains, and what to write instead. They ignore case.
const BANNED: [(&str, &str); 43] = [
    (r"^(What|Who|Where|How|That which)\b[^?]*$", "a label is a noun or a command, not a noun clause"),
    (
        r"^(Shows|Gives|Goes|Hides|Keeps|Opens|Leaves|Brings|Adds|Checks|Marks|Runs|Works|Collapses) ",
        "a tooltip starts with an imperative",
    ),
    (r"\bbehind\b", "say after"),
    (r"\bmend", "say fix"),
    (r"\bstands?\b", "say is, or appears"),
    (r"\b(is|are) no ([^l]|l[^o])", "say is not a"),
    (r"\b(whatever|whoever|whichever)\b", "name the subject"),
    (r"\bwork(s|ed|ing)? out\b|\bwork(s|ed|ing)? the \w+ out\b", "say plan, simulate or calculate"),
    (r"\b(is|are|was|being) looked (for|at)\b", "name who searches or checks"),
    (r"\b(by|with) chance\b", "say random, or Monte Carlo"),
    (r"\bnature\b", "say the environment, or uncontrolled"),
    (r"\banew\b|\bonce more\b", "say again"),
    (r"\bbegun\b", "say created or started"),
    (r"\bgo(es)? on\b", "say continue"),
    (r"\b(is|are|not|was|latest) kept\b|\bkept (as|in|here)\b|\bkeep (a|the) (version|text)\b", "say saved"),
    (r"\bput(s)? back\b|\bbr(ing|ings|ought) back\b", "say restore"),
    (r"\btak(e|en|es) (it |that )?back\b|\bgive(s)? back\b", "say undo, withdraw or remove"),
    (r"\bmistakes?\b|\btroubles?\b", "say error"),
    (r"\bso (many|much)\b", "say at most N, or N"),
    (r"\bany more\b", "say no longer"),
    (r"\b(least|greatest) duration", "say minimum or maximum duration"),
    (r"\bthe usual\b", "say default"),
    (r"\bcarri(es|ed)\b", "say supports"),
    (r"\bcontradict(s|ed)? each other\b", "say inconsistent"),
    (r"\bdoes not suffice\b", "say not enough"),
    (r"\bhand(s|ed)? over\b", "say pass"),
    (r"\bthere is (no|none|nothing)\b", "say unknown …, or no …"),
    (r"\bnothing is\b|\bnothing has been\b", "name the subject"),
    (r"\bnobody\b|\bsomebody\b", "say no, or someone"),
    (r"\bcannot be (used|read|opened)\b", "name who fails: Couldn't open …"),
    (r"\bstays as it is\b", "say is unchanged"),
    (r"\bcaret\b", "say cursor"),
    (r"\bdouble click", "write double-click"),
    (r"\bEscape\b", "write Esc"),
    (r"\b(lesson|this|the|next|previous) stop\b", "say step"),
    (r" · \w+ the\b", "a menu path is written File > Save version…"),
    (r"\w …", "no space before an ellipsis"),
    (r"[\d}] %", "write 95%"),
    (r"`", "backticks are shown raw"),
    (
        r"\b(colou?rs? of the ground|colours?|behaviours?|centres?|grey|honours?|favours?|neighbours?)\b",
        "American spelling",
    ),
    (
        r"\b(metres?|licences?|cancelled|towards|modelled|labelled|travelled|organis|optimis|minimis)",
        "American spelling",
    ),
    (r"\bwho (has|have) to\b", "say required"),
    (r"^Worth$", "say objective"),
];

/// Texts in which a banned pattern is right, by the file's end and a part of the text, and why.
const ALLOWED: [(&str, &str, &str); 2] = [
    ("description/typescript.rs", "", "declarations for programs, with code in backticks"),
    ("library/template.rs", "// Three activities", "a comment of a mission, which quotes its text"),
];

/// The most words of a text by the function that it is given to.
const LIMITS: [(&[&str], usize, &str); 3] = [
    (&["on_hover_text", "on_disabled_hover_text", "on_hover_text_at_pointer"], 12, "tooltip"),
    (&["done", "info", "failed"], 15, "toast"),
    (&["button", "small_button", "checkbox", "toggle_value", "menu_button"], 4, "label"),
];

/// Calls whose texts no user sees.
const HIDDEN: [&str; 10] = [
    "expect",
    "expect_err",
    "panic",
    "unreachable",
    "assert",
    "assert_eq",
    "assert_ne",
    "debug_assert",
    "debug_assert_eq",
    "debug_assert_ne",
];

/// Where a literal continues on the next line.
static CONTINUATION: LazyLock<Regex> = LazyLock::new(|| Regex::new(r"\\\n\s*").expect("a pattern"));
static PLACEHOLDER: LazyLock<Regex> = LazyLock::new(|| Regex::new(r"\{[^{}]*\}").expect("a pattern"));

/// A string literal of a source.
struct Text {
    line: usize,
    words: String,
    /// The innermost function or macro that it is given to.
    callee: String,
}

/// The string literals of a source, without those of tests, attributes and hidden calls.
fn texts_of(source: &str) -> Vec<Text> {
    let tokens: TokenStream = source.parse().expect("sources are Rust");
    let mut found = Vec::new();
    collect(tokens, "", &mut found);
    found
}

fn collect(tokens: TokenStream, callee: &str, found: &mut Vec<Text>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut at = 0;
    let mut is_test = false;
    // The last name, which is the callee of the group that follows.
    let mut name = String::new();
    while let Some(token) = tokens.get(at) {
        at += 1;
        match token {
            TokenTree::Punct(punct) if punct.as_char() == '#' => {
                // Attributes of what they are in, as `//!` is one.
                if matches!(tokens.get(at), Some(TokenTree::Punct(punct)) if punct.as_char() == '!') {
                    at += 1;
                }
                if let Some(TokenTree::Group(group)) = tokens.get(at)
                    && group.delimiter() == Delimiter::Bracket
                {
                    let attribute = group.stream().to_string();
                    is_test |= attribute.replace(' ', "") == "cfg(test)";
                    // The messages of errors are attributes.
                    if attribute.starts_with("error") {
                        collect(group.stream(), "error", found);
                    }
                    at += 1;
                }
            }
            TokenTree::Punct(punct) => {
                if punct.as_char() == ';' {
                    is_test = false;
                }
                if !matches!(punct.as_char(), '!' | ':' | '.') {
                    name.clear();
                }
            }
            TokenTree::Ident(ident) => name = ident.to_string(),
            TokenTree::Group(group) => {
                let is_body = group.delimiter() == Delimiter::Brace;
                let is_hidden = HIDDEN.contains(&name.as_str());
                if !(is_hidden || is_test && is_body) {
                    let is_call = group.delimiter() == Delimiter::Parenthesis && !name.is_empty();
                    let inner = if is_call && name != "format" { name.as_str() } else { callee };
                    collect(group.stream(), if is_body { "" } else { inner }, found);
                }
                is_test &= !is_body;
                name.clear();
            }
            TokenTree::Literal(literal) => {
                let line = literal.span().start().line;
                if let Some(words) = string(&literal.to_string()) {
                    found.push(Text { line, words, callee: callee.to_owned() });
                }
            }
        }
    }
}

/// What a literal says, if it is a string: without quotes and line breaks, each placeholder as `{}`.
fn string(literal: &str) -> Option<String> {
    let literal = literal.trim_start_matches('r').trim_matches('#');
    let inner = literal.strip_prefix('"')?.strip_suffix('"')?;
    let joined = CONTINUATION.replace_all(inner, "");
    let unquoted = joined.replace("\\\"", "\"").replace("\\n", " ").replace("\\u{a0}", " ");
    Some(PLACEHOLDER.replace_all(&unquoted, "{}").into_owned())
}

/// The sources below a folder, with their paths below the root.
fn sources_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            sources_below(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") && !path.ends_with("tests.rs") {
            found.push(path);
        }
    }
}

/// Every text of the interface, with its file.
fn interface() -> Vec<(String, Text)> {
    let root = root();
    let mut paths = Vec::new();
    for folder in FOLDERS {
        sources_below(&root.join(folder), &mut paths);
    }
    paths.sort();
    let mut found = Vec::new();
    for path in paths {
        let name = path.strip_prefix(&root).expect("below the root").to_string_lossy().replace('\\', "/");
        if EXCLUDED.iter().any(|(part, _)| name.starts_with(part)) || name.contains("/tests/") {
            continue;
        }
        let source = fs::read_to_string(&path).expect("sources are UTF-8");
        found.extend(texts_of(&source).into_iter().map(|text| (name.clone(), text)));
    }
    found
}

#[test]
fn texts_are_found_with_their_callees() {
    let source = r#"
        #[doc = "hidden"]
        fn shown(ui: &mut Ui) {
            ui.button("Save version…").on_hover_text(format!("Save {name} \
                as it is"));
            value.expect("hidden");
        }
        #[error("unknown name {0}")]
        struct Unknown(String);
        #[cfg(test)]
        mod tests { const HIDDEN: &str = "hidden"; }
        const LAST: &str = "Last";
    "#;
    let found: Vec<(String, String)> =
        texts_of(source).into_iter().map(|text| (text.callee, text.words)).collect();
    let expected = [
        ("button", "Save version…"),
        ("on_hover_text", "Save {} as it is"),
        ("error", "unknown name {}"),
        ("", "Last"),
    ];
    assert_eq!(found, expected.map(|(callee, words)| (callee.to_owned(), words.to_owned())));
}

#[test]
fn no_text_of_the_interface_has_a_banned_word() {
    let patterns: Vec<(Regex, &str)> = BANNED
        .iter()
        .map(|(pattern, instead)| (Regex::new(&format!("(?i){pattern}")).expect("a pattern"), *instead))
        .collect();
    let texts = interface();
    let mut wrong = Vec::new();
    let mut used = BTreeSet::new();
    for (file, text) in &texts {
        for (pattern, instead) in patterns.iter().filter(|(pattern, _)| pattern.is_match(&text.words)) {
            let allowed =
                ALLOWED.iter().position(|(end, part, _)| file.ends_with(end) && text.words.contains(part));
            match allowed {
                Some(allowed) => {
                    used.insert(allowed);
                }
                None => wrong.push(format!("{file}:{}: {:?} ({pattern}: {instead})", text.line, text.words)),
            }
        }
    }
    assert!(texts.len() > 2_000, "only {} texts", texts.len());
    assert!(wrong.is_empty(), "{} texts:\n{}", wrong.len(), wrong.join("\n"));
    let idle: Vec<_> = (0..ALLOWED.len()).filter(|it| !used.contains(it)).map(|it| ALLOWED[it]).collect();
    assert!(idle.is_empty(), "these exceptions are not needed: {idle:?}");
}

#[test]
fn no_label_tooltip_or_toast_is_too_long() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for (file, text) in interface() {
        let limit = LIMITS.iter().find(|(callees, ..)| callees.contains(&text.callee.as_str()));
        let Some((_, most, kind)) = limit else { continue };
        count += 1;
        let words = text
            .words
            .split_whitespace()
            .filter(|word| word.chars().any(char::is_alphanumeric) || *word == "{}");
        let words = words.count();
        if words > *most {
            wrong.push(format!("{file}:{}: a {kind} of {words} words: {:?}", text.line, text.words));
        }
    }
    assert!(count > 150, "only {count} texts");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
