//! Rules of the documents: every citation names a section that exists, and every link leads to a file and a heading.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use xtask::process::root;

/// What a citation begins with, and the document whose sections it names.
const CITED: [(&str, &str); 2] = [("SPEC", "docs/specification.md"), ("DESIGN", "docs/contracts.md")];

/// Where citations and links are looked for, below the root.
const PLACES: [&str; 7] = ["crates", "tests", "bench", "docs", "web", "assets", ".github"];

const EXTENSIONS: [&str; 9] = ["rs", "md", "js", "ts", "toml", "rmpl", "css", "html", "yml"];

fn texts_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let extension = path.extension().and_then(|extension| extension.to_str());
        if path.is_dir() {
            // Build outputs of a workspace of its own.
            // What once broke a reader is not a source, and may not be text.
            if !path.ends_with("target") && !path.ends_with("tests/fuzz/broken") {
                texts_below(&path, found);
            }
        } else if extension.is_some_and(|extension| EXTENSIONS.contains(&extension)) {
            found.push(path);
        }
    }
}

/// All texts of the repository, with their paths below the root.
pub(crate) fn texts() -> Vec<(PathBuf, String)> {
    let root = root();
    let mut paths = Vec::new();
    for place in PLACES {
        texts_below(&root.join(place), &mut paths);
    }
    let top = fs::read_dir(&root).expect("the repository").flatten().map(|entry| entry.path());
    paths.extend(top.filter(|path| path.extension().is_some_and(|extension| extension == "md")));
    paths.sort();
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).expect("sources are UTF-8");
        (path.strip_prefix(&root).expect("below the root").to_path_buf(), text)
    };
    paths.into_iter().map(read).collect()
}

/// The headings of a Markdown text, without what only looks like one inside a code block.
fn headings(markdown: &str) -> Vec<&str> {
    let mut is_code = false;
    let mut found = Vec::new();
    for line in markdown.lines() {
        if line.starts_with("```") {
            is_code = !is_code;
        } else if !is_code && line.starts_with('#') {
            found.push(line.trim_start_matches('#').trim());
        }
    }
    found
}

/// The numbers of the sections of a document: `5`, `5.3`.
fn sections(markdown: &str) -> BTreeSet<String> {
    let number = |heading: &str| {
        let number = heading.split(' ').next()?.trim_end_matches('.');
        is_section_number(number).then(|| number.to_owned())
    };
    headings(markdown).into_iter().filter_map(number).collect()
}

fn is_section_number(text: &str) -> bool {
    !text.is_empty()
        && text.split('.').all(|part| !part.is_empty() && part.chars().all(|it| it.is_ascii_digit()))
}

/// The sections that follow `word` in a text: of `SPEC 5.2, 5.3 and 6` these three.
fn citations(text: &str, word: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices(word) {
        let is_word = !text[..at].ends_with(|before: char| before.is_ascii_alphanumeric() || before == '_');
        let mut rest = &text[at + word.len()..];
        if !is_word {
            continue;
        }
        let mut separators: &[&str] = &[" "];
        while let Some(after) = separators.iter().find_map(|separator| rest.strip_prefix(separator)) {
            let end = after.find(|it: char| !it.is_ascii_digit() && it != '.').unwrap_or(after.len());
            let number = after[..end].trim_end_matches('.');
            // A number that more follows without a blank, as in `5%`, is something else.
            if !is_section_number(number) {
                break;
            }
            found.push(number.to_owned());
            rest = &after[number.len()..];
            separators = &[", ", " and ", " to ", " or "];
        }
    }
    found
}

#[test]
fn citations_are_read_in_lists() {
    let text = "(SPEC 5.2, 5.3 and 6), SPEC 7.1. MYSPEC 9 SPEC SPEC 2 to 4; DESIGN 4.2, 17 of them";
    assert_eq!(citations(text, "SPEC"), ["5.2", "5.3", "6", "7.1", "2", "4"]);
    assert_eq!(citations(text, "DESIGN"), ["4.2", "17"]);
    assert_eq!(citations("SPECIFICATION 9", "SPEC"), Vec::<String>::new());
}

#[test]
fn every_citation_names_a_section_that_exists() {
    let texts = texts();
    for (word, document) in CITED {
        let sections = sections(&fs::read_to_string(root().join(document)).expect("the document"));
        let mut count = 0;
        let mut wrong = Vec::new();
        for (path, text) in &texts {
            // The rules for citations are tried out above.
            if path.ends_with(file!()) {
                continue;
            }
            for cited in citations(text, word) {
                count += 1;
                if !sections.contains(&cited) {
                    wrong.push(format!("{}: {word} {cited}", path.display()));
                }
            }
        }
        assert!(count > 10, "only {count} citations of {word} were found");
        assert!(wrong.is_empty(), "{document} has no such section:\n{}", wrong.join("\n"));
    }
}

#[test]
fn no_source_names_a_document_that_is_not_here() {
    let mut wrong = Vec::new();
    for (path, text) in texts() {
        for absent in ["SPEC.md", "SPEC2.md", "DESIGN.md"] {
            if text.contains(absent) && !path.ends_with(file!()) {
                wrong.push(format!("{}: {absent}", path.display()));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "cite docs/specification.md or docs/contracts.md instead:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn the_specification_has_every_section_in_order() {
    let text = fs::read_to_string(root().join("docs/specification.md")).expect("the specification");
    let numbered: Vec<Vec<u32>> = headings(&text)
        .into_iter()
        .filter_map(|heading| Some(heading.split(' ').next()?.trim_end_matches('.')))
        .filter(|number| is_section_number(number))
        .map(|number| number.split('.').map(|part| part.parse().expect("small numbers")).collect())
        .collect();
    let chapters: Vec<u32> = numbered.iter().filter(|it| it.len() == 1).map(|it| it[0]).collect();
    assert_eq!(chapters, (1..=17).collect::<Vec<_>>());
    let mut before = vec![0];
    for section in numbered {
        assert!(section > before, "{section:?} comes after {before:?}");
        // The next of its siblings, or the first of its parent.
        let last = section.len() - 1;
        let expected = if section.len() > before.len() { 1 } else { before[last] + 1 };
        assert_eq!(section[last], expected, "{section:?} follows {before:?}");
        before = section;
    }
}

/// The links of a Markdown text that lead inside the repository: file and heading.
fn links(markdown: &str) -> Vec<(&str, Option<&str>)> {
    let mut is_code = false;
    let mut found = Vec::new();
    for line in markdown.lines() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        }
        if is_code {
            continue;
        }
        for (at, _) in line.match_indices("](") {
            let target = &line[at + 2..];
            let Some(end) = target.find(')') else { continue };
            let target = &target[..end];
            if !target.contains("://") && !target.starts_with("mailto:") {
                let (file, heading) =
                    target.split_once('#').map_or((target, None), |(file, it)| (file, Some(it)));
                found.push((file, heading));
            }
        }
    }
    found
}

/// The name by which hosts of repositories link to a heading.
fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|it| it.is_alphanumeric() || matches!(it, ' ' | '-' | '_'));
    kept.flat_map(char::to_lowercase).map(|it| if it == ' ' { '-' } else { it }).collect()
}

#[test]
fn every_link_in_a_document_leads_somewhere() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for (path, text) in texts() {
        // The language's suite and the conformance cases hold missions, not links.
        if path.extension().is_none_or(|extension| extension != "md") || path.starts_with("tests") {
            continue;
        }
        for (file, heading) in links(&text) {
            count += 1;
            let folder = path.parent().unwrap_or(Path::new(""));
            let target = if file.is_empty() { root().join(&path) } else { root().join(folder).join(file) };
            if !target.exists() {
                wrong.push(format!("{}: {file}", path.display()));
            } else if let Some(heading) = heading {
                let target = fs::read_to_string(&target).expect("a document");
                if !headings(&target).into_iter().any(|it| anchor(it) == heading) {
                    wrong.push(format!("{}: {file}#{heading}", path.display()));
                }
            }
        }
    }
    assert!(count > 20, "only {count} links were found");
    assert!(wrong.is_empty(), "links that lead nowhere:\n{}", wrong.join("\n"));
}
