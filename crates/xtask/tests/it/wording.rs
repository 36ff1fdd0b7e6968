//! The texts of the interface follow the writing guide: no banned words, and no label, tooltip or message that is too long.
//!
//! The texts are those of the sources ([`xtask::texts`]), those of the page's scripts; the help of the command line, as its reference quotes it; the
//! comments of the declarations for host pages; and the documents. To check another crate, add its folder. A word that is right in one place goes
//! to [`ALLOWED`], with the reason.

use std::collections::BTreeSet;
use std::fs;
use std::sync::LazyLock;

use regex::Regex;
use xtask::process::root;
use xtask::texts::{FOLDERS, MORE_FOLDERS, template, texts_in, texts_of};

/// Documents whose prose is not checked, and why.
const OTHER_DOCUMENTS: [(&str, &str); 1] =
    [("key-sentences.md", "made of lessons and messages, which are checked in the sources")];

/// Patterns that no text of the interface contains, and what to write instead. They ignore case.
const BANNED_IN_THE_INTERFACE: [(&str, &str); 6] = [
    (r"^(What|Who|Where|How|That which)\b[^?]*$", "a label is a noun or a command, not a noun clause"),
    (r"\b(is|are) no ([^l]|l[^o])", "say is not a"),
    (r"\bthere is (no|none|nothing)\b", "say unknown …, or no …"),
    (r"\bnothing is\b|\bnothing has been\b", "name the subject"),
    (r"\w …", "no space before an ellipsis"),
    (r"`", "backticks are shown raw"),
];

/// Patterns that no text contains at all.
const BANNED: [(&str, &str); 46] = [
    (
        r"^(Shows|Gives|Goes|Hides|Keeps|Opens|Leaves|Brings|Adds|Checks|Marks|Runs|Works|Collapses) ",
        "a tooltip starts with an imperative",
    ),
    (r"\bbehind\b", "say after"),
    (r"\bmend", "say fix"),
    (r"\bstands?\b", "say is, or appears"),
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
    (r"\bnobody\b|\bsomebody\b", "say no, or someone"),
    (r"\bcannot be (used|read|opened)\b", "name who fails: Couldn't open …"),
    (r"\bstays as it is\b", "say is unchanged"),
    (r"\bcaret\b", "say cursor"),
    (r"\bdouble click", "write double-click"),
    (r"\bEscape\b", "write Esc"),
    (r"\b(lesson|this|the|next|previous) stop\b", "say step"),
    (r" · \w+ the\b", "a menu path is written File > Save version…"),
    (r"[\d}] %", "write 95%"),
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
    (r"\w\(s\)", "plurals are real: 1 decision, 2 decisions"),
    (r"\b(this|it|that|which|what) (is|are) no ([^l]|l[^o])", "say is not a"),
    (r"\bso and (pass|fail)", "name what is printed"),
    (r"\b(is|are) (the )?others\b|\bis another one\b", "say has changed, or differs"),
    (r"\bbegins\b|\bbegan\b|\bto begin\b", "say start"),
    (r"\bthe ones? before\b", "say previous"),
    (r"\bspeaks? of\b", "say mention, or refer to"),
    (r"\bshall\b|\bupon\b|\bthus\b|\bhence\b", "use plain, modern words"),
    (r"\bthe (least|greatest) (bound|time|value|speed|slope|level|limit)s?\b", "say minimum or maximum"),
];

/// Texts in which a banned pattern is right, by the file's end and a part of the text, and why.
const ALLOWED: [(&str, &str, &str); 21] = [
    ("terrain/src/format/tiff/georeference.rs", "metre", "what files say"),
    ("rmpl/src/diagnostics/undefined.rs", "usual reason", "the most frequent reason, not a default"),
    ("review/src/plan_lines.rs", "in formation behind", "a place, not a time"),
    ("executive/src/model_based/proof/product.rs", "runs of more than", "a noun, not what a tooltip does"),
    ("mission/src/repairs/candidates.rs", "gives {}", "a part of a fix: “do Charge(): it gives Battery”"),
    ("review/src/rules.rs", "{} %", "a part of criteria, which are in signed reviews"),
    ("rmpl/src/control/expand.rs", "cannot be used as an expression", "what the program says, not a file"),
    ("rmpl/src/diagnostics/unused.rs", "usual reason", "the most frequent reason, not a default"),
    ("interchange/src/geojson/projection.rs", "metres", "a unit of the file format"),
    ("interchange/src/plan_schema/edn.rs", "unknown escape", "an escape sequence, not the key"),
    ("mission/src/traverse.rs", "per metre", "a keyword of the language"),
    ("rmpl/src/diagnostics/kind.rs", "stands for", "what a parameter stands for is its argument"),
    ("rmpl/src/diagnostics/syntax.rs", "per metre", "a keyword of the language"),
    ("rmpl/src/editor/hover.rs", "per metre", "a keyword of the language"),
    ("rmpl/src/parser/clause.rs", "metre", "a keyword of the language"),
    ("rmpl/src/program.rs", "metre", "a keyword of the language"),
    ("terrain/src/format/pds.rs", "METRE", "a unit of the file format"),
    ("terrain/src/format/tiff/calibration.rs", "metre", "a unit of the file format"),
    ("description/typescript.rs", "", "declarations for programs, with code in backticks"),
    ("theme/src/short.rs", "```", "a mark of Markdown"),
    ("library/template.rs", "// Three activities", "a comment of a mission, which quotes its text"),
];

/// The most words of a text by the function that it is given to.
const LIMITS: [(&[&str], usize, &str); 3] = [
    (&["on_hover_text", "on_disabled_hover_text", "on_hover_text_at_pointer"], 12, "tooltip"),
    (&["done", "info", "failed"], 15, "toast"),
    (&["button", "small_button", "checkbox", "toggle_value", "menu_button"], 4, "label"),
];

fn patterns(of: &[(&str, &'static str)]) -> Vec<(Regex, &'static str)> {
    of.iter()
        .map(|(pattern, instead)| (Regex::new(&format!("(?i){pattern}")).expect("a pattern"), *instead))
        .collect()
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

/// A file that msgfmt can read: each text once, with its places and an empty translation.
#[test]
fn the_template_of_a_translation_has_each_text_once() {
    let template = template();
    let ids: Vec<&str> = template.lines().filter(|line| line.starts_with("msgid ")).collect();
    let different: BTreeSet<&str> = ids.iter().copied().collect();
    assert!(ids.len() > 1_500 && different.len() == ids.len(), "{} of {}", different.len(), ids.len());
    assert!(template.contains("\nmsgid \"Maximize or restore panel\"\nmsgstr \"\"\n"));
    assert!(
        template.lines().all(|line| line.is_empty() || line.starts_with("#: ") || line.starts_with("msg"))
    );
}

#[test]
fn no_text_has_a_banned_word() {
    let everywhere = patterns(&BANNED);
    let in_the_interface = patterns(&BANNED_IN_THE_INTERFACE);
    let (interface, more) = (texts_in(&FOLDERS), texts_in(&MORE_FOLDERS));
    assert!(interface.len() > 2_000, "only {} texts", interface.len());
    assert!(more.len() > 2_000, "only {} texts", more.len());
    let mut wrong = Vec::new();
    let mut used = BTreeSet::new();
    let (all, some) = ([&everywhere, &in_the_interface], [&everywhere]);
    for (texts, lists) in [(&interface, all.as_slice()), (&more, some.as_slice())] {
        for (file, text) in texts {
            let found = lists.iter().copied().flatten().filter(|(pattern, _)| pattern.is_match(&text.words));
            for (pattern, instead) in found {
                let allowed = ALLOWED
                    .iter()
                    .position(|(end, part, _)| file.ends_with(end) && text.words.contains(part));
                match allowed {
                    Some(allowed) => {
                        used.insert(allowed);
                    }
                    None => {
                        wrong.push(format!("{file}:{}: {:?} ({pattern}: {instead})", text.line, text.words));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} texts:\n{}", wrong.len(), wrong.join("\n"));
    let idle: Vec<_> = (0..ALLOWED.len()).filter(|it| !used.contains(it)).map(|it| ALLOWED[it]).collect();
    assert!(idle.is_empty(), "these exceptions are not needed: {idle:?}");
}

/// Returns what matches one of these patterns in a text, with what to write instead.
fn problems(file: &str, line: usize, words: &str, patterns: &[(Regex, &str)]) -> Vec<String> {
    let found = patterns.iter().filter(|(pattern, _)| pattern.is_match(words));
    found.map(|(pattern, instead)| format!("{file}:{line}: {words:?} ({pattern}: {instead})")).collect()
}

/// The paragraphs of the help texts, as the reference of the command line quotes them, each option its own.
fn help_texts(reference: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let (mut is_help, mut continues) = (false, false);
    for (number, line) in reference.lines().enumerate() {
        if line.starts_with("```") {
            (is_help, continues) = (!is_help, false);
            continue;
        }
        let words = line.trim();
        let starts = line.starts_with(' ') && (words.starts_with('-') || !line.starts_with("     "));
        match found.last_mut() {
            _ if !is_help || words.is_empty() => continues = false,
            Some((_, paragraph)) if continues && !starts => *paragraph += &format!(" {words}"),
            _ => {
                found.push((number + 1, words.to_owned()));
                continues = true;
            }
        }
    }
    found
}

#[test]
fn no_help_text_has_a_banned_word() {
    // A description must not start as a tooltip must not, so it is held without its option.
    static OPTION: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r"^-[^ ]*( [A-Z<][^ ]*|, --[^ ]+)*  +").expect("a pattern"));
    let example = "```text\nPlan\nit\n\nOptions:\n  --all  List\n          all\n  -h     Help\n```\nout\n";
    let expected = [(2, "Plan it"), (5, "Options:"), (6, "--all  List all"), (8, "-h     Help")];
    assert_eq!(help_texts(example), expected.map(|(line, words)| (line, words.to_owned())));
    let file = "docs/command-line.md";
    let texts = help_texts(&fs::read_to_string(root().join(file)).expect("the reference"));
    assert!(texts.len() > 300, "only {} texts", texts.len());
    let patterns = patterns(&BANNED);
    let wrong =
        texts.iter().flat_map(|(line, words)| problems(file, *line, &OPTION.replace(words, ""), &patterns));
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{} texts:\n{}", wrong.len(), wrong.join("\n"));
}

/// The texts of a script: its string literals that have several words, each placeholder as `{}`.
fn script_texts(script: &str) -> Vec<(usize, String)> {
    static LITERAL: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r#""((?:[^"\\]|\\.)*)"|`((?:[^`\\]|\\.)*)`"#).expect("a pattern"));
    static HOLE: LazyLock<Regex> = LazyLock::new(|| Regex::new(r"\$\{[^}]*\}").expect("a pattern"));
    let is_code = |line: &&str| !["//", "/*", "*"].iter().any(|comment| line.trim().starts_with(comment));
    let mut found = Vec::new();
    for (number, line) in script.lines().enumerate().filter(|(_, line)| is_code(line)) {
        for literal in LITERAL.captures_iter(line) {
            let words = literal.get(1).or(literal.get(2)).map_or("", |words| words.as_str());
            let words = HOLE.replace_all(words, "{}");
            if words.contains(' ') && words.contains(char::is_alphabetic) {
                found.push((number + 1, words.into_owned()));
            }
        }
    }
    found
}

/// The texts of a page in HTML: what is between its tags, and what describes it to assistive technology and search engines.
fn page_texts(html: &str) -> Vec<(usize, String)> {
    static TEXT: LazyLock<Regex> = LazyLock::new(|| {
        Regex::new(
            r#">([^<>]*[A-Za-z][^<>]*)<|(?:aria-label|title|alt|name="description" content)="([^"]*)""#,
        )
        .expect("a pattern")
    });
    let of_line = |(number, line): (usize, &str)| {
        let texts =
            TEXT.captures_iter(line).filter_map(|text| text.get(1).or(text.get(2)).map(|it| it.as_str()));
        texts.map(|words| (number + 1, words.to_owned())).collect::<Vec<_>>()
    };
    html.lines().enumerate().flat_map(of_line).collect()
}

#[test]
fn no_text_of_the_page_s_own_files_has_a_banned_word() {
    let script = "// \"not this\"\nthrow new Error(`is ${kind} here`, \"no\", \"and this\");\n";
    assert_eq!(script_texts(script), [(2, "is {} here".to_owned()), (2, "and this".to_owned())]);
    let html = "<p id=\"a\">Loading…</p>\n<img alt=\"A map\">\n";
    assert_eq!(page_texts(html), [(1, "Loading…".to_owned()), (2, "A map".to_owned())]);
    let patterns: Vec<(Regex, &str)> =
        [patterns(&BANNED), patterns(&BANNED_IN_THE_INTERFACE)].into_iter().flatten().collect();
    let (mut count, mut wrong) = (0, Vec::new());
    for (path, text) in crate::citations::texts() {
        let name = path.to_string_lossy().replace('\\', "/");
        let is_script =
            name.starts_with("web/") && path.extension().is_some_and(|extension| extension == "js");
        for (line, words) in if is_script { script_texts(&text) } else { Vec::new() } {
            count += 1;
            wrong.extend(problems(&name, line, &words, &patterns));
        }
    }
    let html = fs::read_to_string(root().join("index.html")).expect("the page");
    for (line, words) in page_texts(&html) {
        count += 1;
        wrong.extend(problems("index.html", line, &words, &patterns));
    }
    assert!(count > 45, "only {count} texts");
    assert!(wrong.is_empty(), "{} texts:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn no_label_tooltip_or_toast_is_too_long() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for (file, text) in texts_in(&FOLDERS) {
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

static CODE_OR_TARGET: LazyLock<Regex> =
    LazyLock::new(|| Regex::new(r"`[^`]*`|\]\([^)]*\)").expect("a pattern"));

/// The lines of a Markdown text outside of blocks of code.
fn lines(markdown: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    markdown.lines().enumerate().filter_map(move |(number, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        (!is_code && !is_fence).then_some((number + 1, line))
    })
}

/// The prose of a Markdown text by paragraphs and items of lists, whose lines are joined, with their first lines. Headings
/// and rows of tables are their own.
fn paragraphs(markdown: &str) -> Vec<(usize, String)> {
    static ITEM: LazyLock<Regex> = LazyLock::new(|| Regex::new(r"^([*-]|\d+\.)\s").expect("a pattern"));
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut last_line = None;
    for (line, words) in lines(markdown) {
        let words = words.trim();
        let is_own = words.starts_with(['#', '|', '<']);
        let continues = last_line == Some(line - 1) && !is_own && !ITEM.is_match(words);
        match found.last_mut() {
            _ if words.is_empty() => {}
            Some((_, paragraph)) if continues => {
                paragraph.push(' ');
                paragraph.push_str(words);
            }
            _ => found.push((line, words.to_owned())),
        }
        last_line = (!words.is_empty() && !is_own).then_some(line);
    }
    for (_, paragraph) in &mut found {
        *paragraph = CODE_OR_TARGET.replace_all(paragraph, "").into_owned();
    }
    found
}

#[test]
fn paragraphs_have_neither_code_nor_targets() {
    let found =
        paragraphs("# A\nb `behind` [link](behind.md)\nc\n```\nbehind\n```\n* d\n  e\n* f\n| g |\nh\n\ni\n");
    let expected =
        [(1, "# A"), (2, "b  [link c"), (7, "* d e"), (9, "* f"), (10, "| g |"), (11, "h"), (13, "i")];
    assert_eq!(found, expected.map(|(line, words)| (line, words.to_owned())));
}

/// The documents that people read, with their texts, without those of [`OTHER_DOCUMENTS`].
fn documents() -> Vec<(String, String)> {
    let mut found = Vec::new();
    for (path, text) in crate::citations::texts() {
        let name = path.to_string_lossy().replace('\\', "/");
        let is_for_users = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md"]
            .contains(&name.as_str())
            || name.starts_with("docs/panels/")
            || name.starts_with("docs/evidence/")
            || name.starts_with("docs/decisions/")
            || name.strip_prefix("docs/").is_some_and(|name| !name.contains('/'))
            || name.starts_with("assets/");
        let is_other = OTHER_DOCUMENTS.iter().any(|(other, _)| name.ends_with(other));
        if is_for_users && !is_other && path.extension().is_some_and(|extension| extension == "md") {
            found.push((name, text));
        }
    }
    assert!(found.len() > 65, "only {} documents", found.len());
    found
}

/// The comments of declarations in TypeScript, each of which is on one line, without code.
fn comments(declarations: &str) -> Vec<(usize, String)> {
    let of_line = |(number, line): (usize, &str)| {
        let line = line.trim();
        let block = line.strip_prefix("/**").and_then(|rest| rest.strip_suffix("*/"));
        let words = block.or(line.strip_prefix("//"))?.trim();
        Some((number + 1, CODE_OR_TARGET.replace_all(words, "").into_owned()))
    };
    declarations.lines().enumerate().filter_map(of_line).collect()
}

#[test]
fn comments_of_declarations_have_no_code() {
    let found = comments("// A\n\n/** B `behind` c. */\nexport type D = {\n  /** E. */\n  f: number;\n};\n");
    let expected = [(1, "A"), (3, "B  c."), (5, "E.")];
    assert_eq!(found, expected.map(|(line, words)| (line, words.to_owned())));
}

#[test]
fn no_document_for_users_has_a_banned_word() {
    // What is true of labels and tooltips is not true of sentences.
    let patterns = patterns(&BANNED).into_iter().filter(|(pattern, _)| !pattern.as_str().contains('^'));
    let patterns: Vec<(Regex, &str)> = patterns.collect();
    let declarations = "web/enroute.d.ts";
    let of_declarations = comments(&fs::read_to_string(root().join(declarations)).expect("the declarations"));
    assert!(of_declarations.len() > 200, "only {} comments", of_declarations.len());
    let of_documents = documents().into_iter().map(|(name, text)| {
        let found = paragraphs(&text);
        (name, found)
    });
    let mut wrong = Vec::new();
    for (name, found) in of_documents.chain([(declarations.to_owned(), of_declarations)]) {
        for (line, words) in found {
            for (pattern, instead) in patterns.iter().filter(|(pattern, _)| pattern.is_match(&words)) {
                // The word is in quotes where its meaning is explained.
                if !words.contains("“nature”") {
                    wrong.push(format!("{name}:{line}: {words:?} ({pattern}: {instead})"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} paragraphs:\n{}", wrong.len(), wrong.join("\n"));
}

/// The most words of a sentence in a document.
const MAX_WORDS: usize = 35;

/// Documents with longer sentences, and why.
const LONG_SENTENCES: [(&str, &str); 3] = [
    ("benchmarks.md", "the conditions of measurements"),
    ("contracts.md", "formats, for programs"),
    ("specification.md", "definitions, with all their conditions"),
];

/// The sentences of a document's paragraphs and lists, with the line where each paragraph starts; without tables.
fn sentences(markdown: &str) -> Vec<(usize, String)> {
    static END: LazyLock<Regex> = LazyLock::new(|| Regex::new(r"[.!?][)”*]*\s+").expect("a pattern"));
    let split = |(line, paragraph): (usize, String)| {
        let ended = END.replace_all(&paragraph, "$0\n");
        ended.lines().map(|sentence| (line, sentence.trim().to_owned())).collect::<Vec<_>>()
    };
    let is_prose = |(_, paragraph): &(usize, String)| !paragraph.starts_with(['#', '|', '<']);
    paragraphs(markdown).into_iter().filter(is_prose).flat_map(split).collect()
}

#[test]
fn sentences_end_at_full_stops_and_items_start_their_own() {
    let found =
        sentences("# Title\n\nOne\nand two. (Three.) Four\n* five\n* six\n\n```\ncode\n```\n| table |\n");
    let expected = [(3, "One and two."), (3, "(Three.)"), (3, "Four"), (5, "* five"), (6, "* six")];
    assert_eq!(found, expected.map(|(line, words)| (line, words.to_owned())));
}

#[test]
fn no_sentence_of_a_document_is_too_long() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for (name, text) in documents() {
        if LONG_SENTENCES.iter().any(|(other, _)| name.ends_with(other)) {
            continue;
        }
        for (line, sentence) in sentences(&text) {
            count += 1;
            let words = sentence.split_whitespace().filter(|word| word.chars().any(char::is_alphanumeric));
            let words = words.count();
            if words > MAX_WORDS {
                wrong.push(format!("{name}:{line}: {words} words: {sentence}"));
            }
        }
    }
    assert!(count > 2_000, "only {count} sentences");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
