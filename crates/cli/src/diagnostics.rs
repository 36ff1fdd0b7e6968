//! Diagnostics for people: what is wrong and where, with the line that it is about.
//!
//! Texts come from files that anybody may have written: what would move a terminal's cursor, color it or turn its
//! direction is shown as a sign, and of a line as long as a book only what is around the place is shown.

use std::io::{IsTerminal as _, Write as _};

use annotate_snippets::{
    AnnotationKind, Level, Renderer, Snippet, normalize_untrusted_str, renderer::DEFAULT_TERM_WIDTH,
};
use rmpl::files::Files;
use rmpl::{LineIndex, Severity};
use snapshot::Problem;

/// Characters of a line on each side of a place that are looked at. The renderer shows what fits a line of a terminal,
/// and says where it has left something out.
const REACH_CHARS: usize = 2 * DEFAULT_TERM_WIDTH;

/// Characters of a place that are marked at most: less than a line of a terminal, so that its end can be seen.
const MAX_MARKED_CHARS: usize = DEFAULT_TERM_WIDTH / 2;

/// Diagnostics that are printed at most; what else there is is counted.
const MAX_PRINTED: usize = 50;

/// Prints diagnostics on standard error with the lines they are about, colored only on a terminal: errors before
/// warnings where there is not room for all, and how many more there are.
pub fn print_problems(name: &str, source: &str, problems: &[Problem]) -> anyhow::Result<()> {
    let is_terminal = std::io::stderr().is_terminal();
    let renderer = if is_terminal { Renderer::styled() } else { Renderer::plain() };
    let lines = LineIndex::new(source);
    let files = Files::of(source);
    let told = |problem: &Problem| {
        let Some(file) = &problem.file else { return describe(&renderer, name, source, &lines, problem) };
        let text = source.get(problem.file_start as usize..files.at(problem.span.start).end as usize);
        let (text, name) = (text.unwrap_or_default(), path_of_file(name, file));
        let local = Problem { span: problem.span_in_file(), ..problem.clone() };
        describe(&renderer, &name, text, &LineIndex::new(text), &local)
    };
    let (shown, more) = shown(problems);
    let text: String = shown.into_iter().map(told).chain(more).collect();
    std::io::stderr().lock().write_all(text.as_bytes())?;
    Ok(())
}

/// The diagnostics that are printed, in textual order, and a line that counts the others.
fn shown(problems: &[Problem]) -> (Vec<&Problem>, Option<String>) {
    let mut order: Vec<usize> = (0..problems.len()).collect();
    order.sort_by_key(|&index| (problems[index].severity, index));
    order.truncate(MAX_PRINTED);
    order.sort_unstable();
    let shown: Vec<&Problem> = order.into_iter().map(|index| &problems[index]).collect();
    let counted = |severity: Severity, word: &str| {
        let count = |those: &mut dyn Iterator<Item = &Problem>| {
            those.filter(|it| it.severity == severity).map(|it| 1 + it.more as usize).sum::<usize>()
        };
        let more = count(&mut problems.iter()) - count(&mut shown.iter().copied());
        let plural = if more == 1 { "" } else { "s" };
        (more > 0).then(|| format!("{more} more {word}{plural}"))
    };
    let kinds = [(Severity::Error, "error"), (Severity::Warning, "warning"), (Severity::Note, "note")];
    let more: Vec<String> = kinds.into_iter().filter_map(|(kind, word)| counted(kind, word)).collect();
    let line = (!more.is_empty()).then(|| format!("and {}\n", more.join(" and ")));
    (shown, line)
}

/// The path of a file of the mission whose first file is `name`.
pub fn path_of_file(name: &str, file: &str) -> String {
    std::path::Path::new(name).with_file_name(file).display().to_string()
}

fn describe(renderer: &Renderer, name: &str, source: &str, lines: &LineIndex, problem: &Problem) -> String {
    let level = match problem.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let (excerpt, marked) = excerpt(source, lines, problem);
    let line = problem.line as usize;
    let name = normalize_untrusted_str(&harmless(name));
    let told = format!("{name}:{line}:{}", excerpt[..marked.start].chars().count() + 1);
    let snippet = Snippet::source(excerpt)
        .line_start(line)
        .path(name.as_str())
        .annotation(AnnotationKind::Primary.span(marked));
    let title = level.primary_title(harmless(&problem.message)).id(problem.code.as_str());
    let hint = problem
        .hint
        .as_deref()
        .map(|hint| Level::HELP.with_name("hint").message(normalize_untrusted_str(&harmless(hint))));
    let text = renderer.render(&[title.element(snippet).elements(hint)]);
    // The renderer counts columns from the start of what it was given, which may be less than the line.
    let place = format!("{name}:{line}:{}", problem.column);
    format!("{}\n", if told == place { text } else { text.replacen(&told, &place, 1) })
}

/// The part of a line that a problem is about, and which of its bytes are marked. Of a place of several lines this is
/// the first.
fn excerpt(source: &str, lines: &LineIndex, problem: &Problem) -> (String, std::ops::Range<usize>) {
    let starts = lines.starts();
    let line = (problem.line as usize).saturating_sub(1);
    let line_start = starts.get(line).map_or(source.len(), |&start| start as usize);
    let line_end = starts.get(line + 1).map_or(source.len(), |&next| next as usize);
    let text = source.get(line_start..line_end).unwrap_or_default().trim_end_matches(['\n', '\r']);
    let at = |offset: u32| text.floor_char_boundary((offset as usize).saturating_sub(line_start));
    let start = at(problem.span.start);
    let end = at(problem.span.end).max(start);
    let (before, rest) = text.split_at(start);
    let marked: String = rest[..end - start].chars().take(MAX_MARKED_CHARS).collect();
    let after: String = rest[marked.len()..].chars().take(REACH_CHARS).collect();
    let from = before.char_indices().rev().nth(REACH_CHARS - 1).map_or(0, |(at, _)| at);
    let (before, marked, after) = (harmless(&before[from..]), harmless(&marked), harmless(&after));
    let range = before.len()..before.len() + marked.len();
    (before + &marked + &after, range)
}

/// The control characters that the renderer leaves as they are: the second set, in which terminals know commands too,
/// and the marks that turn the direction of neighbors.
fn harmless(text: &str) -> String {
    let is_harmful = |c: char| matches!(c, '\u{80}'..='\u{9f}' | '\u{61c}' | '\u{200e}' | '\u{200f}');
    text.chars().map(|c| if is_harmful(c) { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns what is printed about `marked`, the first such piece of `source`.
    fn printed(source: &str, marked: &str) -> String {
        let start = source.find(marked).expect("a piece of the source") as u32;
        let lines = LineIndex::new(source);
        let place = lines.line_column(source, start);
        let problem = Problem {
            code: "E-TEST".into(),
            severity: Severity::Error,
            message: "something is \u{1b}[31mwrong".into(),
            span: rmpl::Span::new(start, start + marked.len() as u32),
            line: place.line,
            column: place.column,
            file: None,
            file_start: 0,
            hint: Some("mend \u{202e}it".into()),
            fixes: Vec::new(),
            more: 0,
        };
        describe(&Renderer::plain(), "a\u{1b}b.rmpl", source, &lines, &problem)
    }

    #[test]
    fn the_line_is_shown_with_its_place_and_what_would_help() {
        let text = printed("first\n  second thing\nthird\n", "thing");
        assert_eq!(
            text,
            "error[E-TEST]: something is ␛[31mwrong
 --> a␛b.rmpl:2:10
  |
2 |   second thing
  |          ^^^^^
  |
  = hint: mend �it
"
        );
    }

    #[test]
    fn of_many_diagnostics_the_errors_are_printed_first_and_the_rest_is_counted() {
        let one = |severity: Severity, line: u32, more: u32| Problem {
            code: "X-TEST".into(),
            severity,
            message: String::new(),
            span: rmpl::Span::new(line, line),
            line,
            column: 1,
            file: None,
            file_start: 0,
            hint: None,
            fixes: Vec::new(),
            more,
        };
        let mut problems: Vec<Problem> = (1..=500).map(|line| one(Severity::Warning, line, 0)).collect();
        problems[499].more = 9_500;
        problems.push(one(Severity::Error, 501, 0));
        let (printed, more) = shown(&problems);
        assert_eq!(printed.len(), MAX_PRINTED);
        assert_eq!(printed.last().map(|last| last.severity), Some(Severity::Error));
        assert_eq!(more.as_deref(), Some("and 9951 more warnings\n"));
        assert_eq!(shown(&problems[..20]).1, None);
    }

    #[test]
    fn carets_stand_below_wide_characters_tabs_and_a_place_without_width() {
        let marks = |source: &str, marked: &str| {
            let text = printed(source, marked);
            let mut lines = text.lines().skip(3).map(|line| line.get(4..).unwrap_or_default().to_owned());
            (lines.next().expect("the source"), lines.next().expect("the marks"))
        };
        assert_eq!(marks("日本 here", "here"), ("日本 here".into(), "     ^^^^".into()));
        assert_eq!(marks("x 日本", "日本"), ("x 日本".into(), "  ^^^^".into()));
        assert_eq!(marks("\tx", "x"), ("    x".into(), "    ^".into()));
        assert_eq!(marks("end\n", "\n"), ("end".into(), "   ^".into()));
        assert_eq!(marks("\u{1b}[2J \u{202e}x", "x"), ("␛[2J �x".into(), "      ^".into()));
        assert_eq!(marks("\u{9b}2J x", "x"), ("�2J x".into(), "    ^".into()));
    }

    #[test]
    fn of_a_place_of_several_lines_the_first_is_marked() {
        let text = printed("one {\n two\n}\nlast", "{\n two\n}");
        assert!(text.contains("\n1 | one {\n  |     ^\n"), "{text}");
        assert!(!text.contains("two"), "{text}");
    }

    #[test]
    fn of_a_huge_line_only_what_is_around_the_place_is_shown() {
        let source = format!("{} here {}", "a".repeat(1_000_000), "b".repeat(1_000_000));
        let text = printed(&source, "here");
        assert!(text.contains(":1:1000002\n"), "{text}");
        assert!(text.lines().all(|line| line.chars().count() < 200), "{text}");
        let lines: Vec<&str> = text.lines().collect();
        let (shown, marks) = (lines[3], lines[4]);
        assert_eq!(shown.find("here"), marks.find("^^^^"), "{text}");
        let all = printed(&"c".repeat(1_000_000), &"c".repeat(900_000));
        assert!(all.lines().all(|line| line.chars().count() < 200), "{all}");
    }
}
