//! Parsing a whole file, and again after one keystroke, by ours and by tree-sitter with three of its grammars.
//!
//! There is no tree-sitter grammar of RMPL, so it gets files of as many lines and about as many bytes in C, JSON and
//! Rust. Each says what the RMPL file says as far as its language can, and its trees have about as many leaves.

use std::fmt::Write as _;
use std::hint::black_box;

use anyhow::{Context as _, Result};
use rmpl::{Edit, Span};
use tree_sitter::{InputEdit, Language, Parser, Point};

use crate::stopwatch::Stopwatch;
use crate::table::{Table, figure, median, millis, quantile, ratio};

/// Prints one table.
pub(crate) fn compare(quick: bool) -> Result<()> {
    let mut table = Table::new(
        "Language: a whole file, and one keystroke in its middle",
        &["lines", "bytes", "parser", "full ms", "best ms", "of ours", "keystroke ms", "best ms", "of ours"],
    );
    for lines in if quick { vec![500] } else { vec![5_015, 10_000] } {
        let runs = if quick { 5 } else { 41 };
        let text = rmpl_text(lines);
        let (full, key) = ours(&text, runs);
        let mut row = |name: &str, text: &str, times: (&[f64], &[f64])| {
            table.row(vec![
                text.lines().count().to_string(),
                text.len().to_string(),
                name.to_owned(),
                figure(median(times.0)),
                figure(quantile(times.0, 0.0)),
                ratio(median(times.0), median(&full)),
                figure(median(times.1)),
                figure(quantile(times.1, 0.0)),
                ratio(median(times.1), median(&key)),
            ]);
        };
        row("ours, RMPL", &text, (&full, &key));
        let others: [(&str, Language, Writer); 3] = [
            ("tree-sitter 0.27.1, JSON", tree_sitter_json::LANGUAGE.into(), json_text),
            ("tree-sitter 0.27.1, C", tree_sitter_c::LANGUAGE.into(), c_text),
            ("tree-sitter 0.27.1, Rust", tree_sitter_rust::LANGUAGE.into(), rust_text),
        ];
        for (name, language, write) in others {
            let text = write(lines);
            let (full, key) = tree_sitter(&language, &text, runs).with_context(|| name.to_owned())?;
            row(name, &text, (&full, &key));
        }
    }
    table.note("A keystroke types a digit into a number in the middle of the file, or deletes it. Ours also checks names, types and bounds, and has its diagnostics current; tree-sitter has the tree alone. Medians of 41 full parses and 400 keystrokes, and the best, which other work on the machine disturbs least.");
    table.print();
    Ok(())
}

/// Writes a file of so many lines.
type Writer = fn(usize) -> String;

const KEYSTROKES: usize = 400;

fn timed(mut work: impl FnMut()) -> f64 {
    let start = Stopwatch::start();
    work();
    millis(start.elapsed())
}

/// Returns where the keystroke goes: before the first digit after the middle that follows `mark`.
fn place(text: &str, mark: &str) -> usize {
    let middle = text.len() / 2;
    text[middle..].find(mark).map_or(middle, |at| middle + at + mark.len())
}

fn ours(text: &str, runs: usize) -> (Vec<f64>, Vec<f64>) {
    let full = (0..runs).map(|_| timed(|| drop(black_box(rmpl::parse(black_box(text)))))).collect();
    let mut current = rmpl::parse(text);
    let at = place(text, "delay[") as u32;
    let insert = Edit { span: Span::new(at, at), text: "1".to_owned() };
    let delete = Edit { span: Span::new(at, at + 1), text: String::new() };
    let mut stroke = |at: usize| {
        let edit = if at.is_multiple_of(2) { &insert } else { &delete };
        timed(|| current.edit(black_box(edit)))
    };
    (full, (0..KEYSTROKES).map(&mut stroke).collect())
}

fn tree_sitter(language: &Language, text: &str, runs: usize) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut parser = Parser::new();
    parser.set_language(language)?;
    let tree = parser.parse(text, None).context("no tree")?;
    anyhow::ensure!(!tree.root_node().has_error(), "the text has errors");
    let full = (0..runs).map(|_| timed(|| drop(black_box(parser.parse(black_box(text), None))))).collect();
    let mut tree = tree;
    let mut text = text.to_owned();
    let at = place(&text, "delay");
    let at = at + text[at..].find(|letter: char| letter.is_ascii_digit()).context("no number")?;
    let row = text[..at].matches('\n').count();
    let column = at - text[..at].rfind('\n').map_or(0, |end| end + 1);
    let (here, after) = (Point { row, column }, Point { row, column: column + 1 });
    let mut key = Vec::new();
    for stroke in 0..KEYSTROKES {
        let types = stroke.is_multiple_of(2);
        if types {
            text.insert(at, '1');
        } else {
            text.remove(at);
        }
        key.push(timed(|| {
            tree.edit(&InputEdit {
                start_byte: at,
                old_end_byte: at + usize::from(!types),
                new_end_byte: at + usize::from(types),
                start_position: here,
                old_end_position: if types { here } else { after },
                new_end_position: if types { after } else { here },
            });
            if let Some(new) = parser.parse(&text, Some(&tree)) {
                tree = new;
            }
        }));
    }
    anyhow::ensure!(!tree.root_node().has_error(), "the edited text has errors");
    Ok((full, key))
}

/// Repeats a leg of eleven lines until there are enough.
fn legs(lines: usize, head: &str, leg: impl Fn(usize) -> String, tail: &str) -> String {
    let mut text = head.to_owned();
    let mut count = text.lines().count() + tail.lines().count();
    let per_leg = leg(1).lines().count();
    for number in 1.. {
        if count >= lines {
            break;
        }
        let _ = write!(text, "{}", leg(number));
        count += per_leg;
    }
    text + tail
}

fn rmpl_text(lines: usize) -> String {
    let leg = |number: usize| {
        format!(
            "// Leg {number} of the survey.\n\
             primitive Drive-{number}(from, to)[20,30];\n\
             primitive Sample-{number}(tool)[2,5];\n\
             \n\
             Leg-{number}()[l,u] = {{\n  \
               choose {{\n    \
                 do {{ Drive-{number}(SITE{number}, BASE)[l*90%,u*90%]; }} maintaining LIGHT_ON,\n    \
                 {{ delay[0,5]; Drive-{number}(SITE{number}, BASE)[20,25] }}\n  \
               }};\n  \
               {{ Sample-{number}(DRILL)[2,4], TOOL{number}=BUSY [3,3] }};\n  \
               if PERMISSION{number}=GIVEN thennext Sample-{number}(BRUSH)\n\
             }}\n\n"
        )
    };
    let tail = "scenario Day[0,100000] = {\n  LIGHT=ON [100000,100000],\n  { Leg-1()[40,90]; delay; Leg-2()[40,90] }\n}\n";
    legs(lines, "var LIGHT : {ON, OFF};\n", leg, tail)
}

fn c_text(lines: usize) -> String {
    let leg = |number: usize| {
        format!(
            "/* Leg {number} of the survey. */\n\
             int drive_{number}(int from, int to, int lower, int upper);\n\
             int sample_{number}(int tool, int lower, int upper);\n\
             \n\
             int leg_{number}(int l, int u) {{\n  \
               if (choose()) {{\n    \
                 maintain(drive_{number}(SITE{number}, BASE, l * 90 / 100, u * 90 / 100), LIGHT_ON);\n  \
               }} else {{\n    \
                 delay(0, 5); drive_{number}(SITE{number}, BASE, 20, 25);\n  \
               }}\n  \
               sample_{number}(DRILL, 2, 4); TOOL{number} = BUSY;\n  \
               if (PERMISSION{number} == GIVEN) sample_{number}(BRUSH, 2, 5);\n\
             }}\n\n"
        )
    };
    legs(lines, "#include \"survey.h\"\n", leg, "\n")
}

fn rust_text(lines: usize) -> String {
    let leg = |number: usize| {
        format!(
            "/// Leg {number} of the survey.\n\
             fn drive_{number}(from: Site, to: Site, bounds: [i64; 2]);\n\
             fn sample_{number}(tool: Tool, bounds: [i64; 2]);\n\
             \n\
             fn leg_{number}(l: i64, u: i64) {{\n  \
               if choose() {{\n    \
                 maintain(drive_{number}(SITE{number}, BASE, [l * 90 / 100, u * 90 / 100]), LIGHT_ON);\n  \
               }} else {{\n    \
                 delay([0, 5]); drive_{number}(SITE{number}, BASE, [20, 25]);\n  \
               }}\n  \
               sample_{number}(DRILL, [2, 4]); tell(TOOL{number}, BUSY, [3, 3]);\n  \
               if PERMISSION{number} == GIVEN {{ sample_{number}(BRUSH, [2, 5]); }}\n\
             }}\n\n"
        )
    };
    legs(lines, "use survey::*;\n", leg, "\n")
}

fn json_text(lines: usize) -> String {
    let leg = |number: usize| {
        format!(
            "  {{\n    \
             \"name\": \"Leg-{number}\", \"parameters\": [\"l\", \"u\"],\n    \
             \"primitives\": [[\"Drive-{number}\", \"from\", \"to\", 20, 30], [\"Sample-{number}\", \"tool\", 2, 5]],\n    \
             \"choose\": [\n      \
             {{\"call\": \"Drive-{number}\", \"with\": [\"SITE{number}\", \"BASE\"], \"maintaining\": \"LIGHT_ON\"}},\n      \
             {{\"delay\": [0, 5], \"then\": [\"Drive-{number}\", \"SITE{number}\", \"BASE\", 20, 25]}}\n    \
             ],\n    \
             \"parallel\": [[\"Sample-{number}\", \"DRILL\", 2, 4], [\"TOOL{number}\", \"BUSY\", 3, 3]],\n    \
             \"if\": {{\"PERMISSION{number}\": \"GIVEN\"}},\n    \
             \"thennext\": [\"Sample-{number}\", \"BRUSH\"]\n  \
             }},\n\n"
        )
    };
    legs(lines, "[\n", leg, "  {}\n]\n")
}
