//! Pieces of the text that are folded away in the editor.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use rmpl::Parse;
use rmpl::editor::{FoldKind, folds};
use text_editing::{Caret, Document, Rows};

/// What is folded. A piece is known by what its first line says, so it stays folded while the text around it changes.
#[derive(Clone, Debug, Default)]
pub struct Folding {
    folded: BTreeSet<FirstLine>,
    rows: Rows,
    revision: u64,
    caret_line: usize,
}

/// A line by its text, and how many lines above it say the same.
type FirstLine = (String, usize);

/// A piece of the text that can be folded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Region {
    /// The line that stays.
    pub first_line: usize,
    /// The lines that disappear.
    pub hidden: Range<usize>,
}

impl Folding {
    /// Returns which line stands where.
    pub const fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Folds or unfolds the piece that begins in a line. Returns whether there is one.
    pub fn toggle(&mut self, line: usize, document: &Document, parse: &Parse) -> bool {
        let is_region = regions(document, parse).iter().any(|region| region.first_line == line);
        if is_region {
            let key = first_line(document, line);
            if !self.folded.remove(&key) {
                self.folded.insert(key);
            }
            self.arrange(document, parse);
        }
        is_region
    }

    /// Folds the innermost open piece around a line.
    pub fn fold_around(&mut self, line: usize, document: &Document, parse: &Parse) {
        let around = regions(document, parse).into_iter().filter(|region| {
            (region.first_line == line || region.hidden.contains(&line) || region.hidden.end == line)
                && !self.rows.is_folded_at(region.first_line)
        });
        if let Some(region) = around.min_by_key(|region| region.hidden.len()) {
            self.folded.insert(first_line(document, region.first_line));
            self.arrange(document, parse);
        }
    }

    /// Folds every piece that is not inside another.
    pub fn fold_all(&mut self, document: &Document, parse: &Parse) {
        let regions = regions(document, parse);
        let outer = regions
            .iter()
            .filter(|region| !regions.iter().any(|other| other.hidden.contains(&region.first_line)));
        self.folded = outer.map(|region| first_line(document, region.first_line)).collect();
        self.arrange(document, parse);
    }

    /// Shows everything again.
    pub fn unfold_all(&mut self) {
        self.folded.clear();
        self.rows = Rows::default();
    }

    /// Follows the text and the caret: a caret that goes up or down passes over what is folded, any other way into it
    /// unfolds it.
    pub fn follow(&mut self, document: &mut Document, parse: Option<&Parse>) {
        let line = document.line_at(document.caret().head);
        let came_from = std::mem::replace(&mut self.caret_line, line);
        if self.folded.is_empty() {
            return;
        }
        let Some(parse) = parse else { return self.unfold_all() };
        if self.revision != document.revision() {
            self.arrange(document, parse);
        }
        let Some(hidden) = self.rows.hiding(line) else { return };
        let passes_down = came_from + 1 == hidden.start && line == hidden.start;
        let passes_up = came_from == hidden.end && line + 1 == hidden.end;
        let target = match (passes_down, passes_up) {
            (true, _) if hidden.end < document.line_count() => hidden.end,
            (_, true) if hidden.start > 0 => hidden.start - 1,
            _ => return self.unfold_around(line, document, parse),
        };
        let caret = document.caret();
        let column = caret.goal_column.unwrap_or_else(|| document.column_in_row(caret.head));
        // From below one comes to the last of the rows that a long line is broken into.
        let row = if passes_up { usize::MAX } else { 0 };
        let head = document.offset_in_row(target, row, column);
        let anchor = if document.caret().is_empty() { head } else { document.caret().anchor };
        document.set_caret(Caret { anchor, head, ..document.caret() });
        self.caret_line = target;
    }

    fn unfold_around(&mut self, line: usize, document: &Document, parse: &Parse) {
        for region in regions(document, parse) {
            if region.hidden.contains(&line) {
                self.folded.remove(&first_line(document, region.first_line));
            }
        }
        self.arrange(document, parse);
    }

    fn arrange(&mut self, document: &Document, parse: &Parse) {
        self.revision = document.revision();
        // Counting equal lines once is enough for all regions.
        let mut seen = BTreeMap::<&str, usize>::new();
        let keys: Vec<FirstLine> = (0..document.line_count())
            .map(|line| {
                let text = document.line_text(line).trim();
                let count = seen.entry(text).or_default();
                *count += 1;
                (text.to_owned(), *count - 1)
            })
            .collect();
        let folded = regions(document, parse)
            .into_iter()
            .filter(|region| keys.get(region.first_line).is_some_and(|key| self.folded.contains(key)));
        self.rows = Rows::new(folded.map(|region| region.hidden).collect());
    }
}

/// Returns what can be folded, by first line; of several that begin in one line, the largest.
pub fn regions(document: &Document, parse: &Parse) -> Vec<Region> {
    let mut largest = BTreeMap::<usize, Region>::new();
    for fold in folds(parse) {
        let first_line = document.line_at(fold.span.start as usize);
        let last = document.line_at(fold.span.end as usize);
        // The line with the closing brace stays, so that the text still reads as balanced.
        let end = if fold.kind == FoldKind::Braces { last } else { last + 1 };
        if end <= first_line + 1 {
            continue;
        }
        let region = Region { first_line, hidden: first_line + 1..end };
        let known = largest.entry(first_line).or_insert_with(|| region.clone());
        if region.hidden.end > known.hidden.end {
            *known = region;
        }
    }
    largest.into_values().collect()
}

fn first_line(document: &Document, line: usize) -> FirstLine {
    let text = document.line_text(line).trim();
    let above = (0..line).filter(|&above| document.line_text(above).trim() == text).count();
    (text.to_owned(), above)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "A()[l,u] = {\n  B()[1,2];\n  choose {\n    C()[1,2],\n    D()[1,2]\n  }\n}\nE()[1,2];\n";

    fn opened() -> (Document, Parse) {
        (Document::new(TEXT), rmpl::parse(TEXT))
    }

    #[test]
    fn a_block_folds_to_its_first_and_last_line() {
        let (document, parse) = opened();
        let mut folding = Folding::default();
        assert!(folding.toggle(0, &document, &parse));
        assert_eq!(*folding.rows(), Rows::new(vec![Range { start: 1, end: 6 }]));
        assert!(folding.toggle(0, &document, &parse));
        assert_eq!(*folding.rows(), Rows::default());
        assert!(!folding.toggle(1, &document, &parse));
    }

    #[test]
    fn an_edit_elsewhere_leaves_it_folded_and_an_edit_of_its_first_line_unfolds_it() {
        let (mut document, parse) = opened();
        let mut folding = Folding::default();
        folding.toggle(2, &document, &parse);
        assert_eq!(*folding.rows(), Rows::new(vec![Range { start: 3, end: 5 }]));
        document.replace_all(&format!("// first\n{TEXT}"));
        folding.follow(&mut document, Some(&rmpl::parse(&format!("// first\n{TEXT}"))));
        assert_eq!(*folding.rows(), Rows::new(vec![Range { start: 4, end: 6 }]));
        let changed = TEXT.replace("choose {", "choose  {");
        document.replace_all(&changed);
        folding.follow(&mut document, Some(&rmpl::parse(&changed)));
        assert_eq!(*folding.rows(), Rows::default());
    }

    #[test]
    fn a_caret_steps_over_what_is_folded_and_a_jump_into_it_unfolds_it() {
        let (mut document, parse) = opened();
        let mut folding = Folding::default();
        let at = |document: &Document, line| Caret {
            anchor: document.offset_at(line, 0),
            head: document.offset_at(line, 0),
            ..Caret::default()
        };
        document.set_caret(at(&document, 2));
        folding.follow(&mut document, Some(&parse));
        folding.toggle(2, &document, &parse);
        document.set_caret(at(&document, 3));
        folding.follow(&mut document, Some(&parse));
        assert_eq!(document.line_at(document.caret().head), 5);
        document.set_caret(at(&document, 4));
        folding.follow(&mut document, Some(&parse));
        assert_eq!(document.line_at(document.caret().head), 2);
        document.set_caret(at(&document, 4));
        folding.follow(&mut document, Some(&parse));
        assert_eq!(document.line_at(document.caret().head), 4);
        assert_eq!(*folding.rows(), Rows::default());
    }

    #[test]
    fn folding_at_the_caret_takes_the_innermost_piece_and_folding_all_the_outermost() {
        let (document, parse) = opened();
        let mut folding = Folding::default();
        folding.fold_around(3, &document, &parse);
        assert_eq!(*folding.rows(), Rows::new(vec![Range { start: 3, end: 5 }]));
        folding.fold_around(2, &document, &parse);
        assert_eq!(*folding.rows(), Rows::new(vec![Range { start: 1, end: 6 }]));
        folding.unfold_all();
        folding.fold_all(&document, &parse);
        assert_eq!(*folding.rows(), Rows::new(vec![Range { start: 1, end: 6 }]));
    }
}
