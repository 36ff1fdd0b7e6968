//! What a stop says, with `{{…}}` filled in by what is computed.

use markdown::{Block, Content, Run};

use super::{Expression, LessonError};
use crate::manual;

/// Checks that everything between `{{` and `}}` can be computed, and that links lead somewhere.
pub(super) fn check(block: &Block, errors: &mut Vec<LessonError>) {
    let line = block.line;
    let mut told = Vec::new();
    filled(std::slice::from_ref(block), &mut |text| {
        if let Err(message) = Expression::read(text) {
            told.push(LessonError::new(line, format!("in `{{{{{text}}}}}`: {message}")));
        }
        String::new()
    });
    errors.append(&mut told);
    for link in manual::broken_links(std::slice::from_ref(block), "lessons") {
        errors.push(LessonError::new(line, format!("the manual has no page or section `{link}`")));
    }
}

/// The same blocks with what `value` says for the text between each `{{` and `}}`. Linear in the blocks.
pub fn filled(blocks: &[Block], value: &mut dyn FnMut(&str) -> String) -> Vec<Block> {
    let filled_blocks = blocks.iter().map(|block| {
        let content = match &block.content {
            Content::Heading { level, text } => Content::Heading { level: *level, text: runs(text, value) },
            Content::Paragraph(text) => Content::Paragraph(runs(text, value)),
            Content::List { first, items } => {
                Content::List { first: *first, items: items.iter().map(|item| filled(item, value)).collect() }
            }
            Content::Quote(blocks) => Content::Quote(filled(blocks, value)),
            Content::Table { head, rows } => Content::Table {
                head: head.iter().map(|cell| runs(cell, value)).collect(),
                rows: rows.iter().map(|row| row.iter().map(|cell| runs(cell, value)).collect()).collect(),
            },
            content @ (Content::Code { .. } | Content::Rule) => content.clone(),
        };
        Block { line: block.line, content }
    });
    filled_blocks.collect()
}

fn runs(runs: &[Run], value: &mut dyn FnMut(&str) -> String) -> Vec<Run> {
    runs.iter().map(|run| Run { text: text(&run.text, value), ..run.clone() }).collect()
}

fn text(text: &str, value: &mut dyn FnMut(&str) -> String) -> String {
    let (mut out, mut rest) = (String::new(), text);
    while let Some((before, (inside, after))) =
        rest.split_once("{{").and_then(|(before, behind)| Some((before, behind.split_once("}}")?)))
    {
        out.push_str(before);
        out.push_str(&value(inside.trim()));
        rest = after;
    }
    out + rest
}
