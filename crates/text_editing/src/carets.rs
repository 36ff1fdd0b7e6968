//! Several carets at once: how they come and go, and how one key does the same at each of them.

use crate::document::{Caret, Document};
use crate::history::{EditKind, Step};
use crate::typing::word_at;

/// The caret that the view follows, and the others.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Carets {
    /// The one that was placed last.
    pub(crate) main: Caret,
    /// In no order; they touch neither each other nor the main one.
    pub(crate) others: Vec<Caret>,
}

impl Document {
    /// The carets besides the main one.
    pub fn other_carets(&self) -> &[Caret] {
        &self.others
    }

    /// All carets in the order of the text.
    pub fn carets(&self) -> Vec<Caret> {
        let mut all = self.others.clone();
        all.push(self.caret());
        all.sort_by_key(|caret| (caret.range().start, caret.range().end));
        all
    }

    /// The selected pieces of text, in their order, each on a line of its own.
    pub fn all_selected_text(&self) -> String {
        let pieces = self.carets().into_iter().map(|caret| &self.text()[caret.range()]);
        pieces.collect::<Vec<_>>().join("\n")
    }

    /// Another caret at an offset, or one less if there is one already and it is not the last.
    pub(crate) fn toggle_caret(&mut self, offset: usize) {
        let offset = self.boundary_before(offset);
        let (main, mut others) = (self.caret(), self.others.clone());
        if let Some(at) = others.iter().position(|caret| touches(*caret, offset)) {
            others.remove(at);
            self.set_carets(main, others);
        } else if touches(main, offset) {
            if let Some(next) = others.pop() {
                self.set_carets(next, others);
            }
        } else {
            others.push(main);
            self.set_carets(Caret::at(offset), others);
        }
    }

    /// Another caret in the row above the topmost or below the lowest one, at its column.
    pub(crate) fn add_caret_beside(&mut self, below: bool) {
        let all = self.carets();
        let Some(outermost) = (if below { all.last() } else { all.first() }) else { return };
        let here = (self.line_at(outermost.head), self.row_in_line(outermost.head));
        let (line, row) = self.row_away(here.0, here.1, 1, below);
        if (line, row) == here {
            return;
        }
        let column = outermost.goal_column.unwrap_or_else(|| self.column_in_row(outermost.head));
        let caret = Caret { goal_column: Some(column), ..Caret::at(self.offset_in_row(line, row, column)) };
        let mut others = self.others.clone();
        others.push(self.caret());
        self.set_carets(caret, others);
    }

    /// Selects the word at the caret, or where the selected text stands next: that is selected, too.
    pub(crate) fn select_next_occurrence(&mut self) {
        let main = self.caret();
        if main.is_empty() {
            let word = word_at(self.text(), main.head);
            let others = self.others.clone();
            self.set_carets(Caret::selecting(word.start, word.end), others);
            return;
        }
        let wanted = self.selected_text().to_owned();
        let (before, after) = self.text().split_at(main.range().end);
        let found_after = after.match_indices(&wanted).map(|(at, _)| before.len() + at);
        let found_before = self.text().match_indices(&wanted).map(|(at, _)| at);
        let is_free = |at: &usize| self.carets().iter().all(|caret| caret.range().start != *at);
        let found = found_after.chain(found_before.take_while(|at| *at < main.range().start)).find(is_free);
        if let Some(at) = found {
            let mut others = self.others.clone();
            others.push(main);
            self.set_carets(Caret::selecting(at, at + wanted.len()), others);
        }
    }

    /// Does the same at every caret, from the last to the first, as one step of the history. `act` is told which caret
    /// of all it is at.
    pub(crate) fn at_each_caret(&mut self, mut act: impl FnMut(&mut Self, usize)) {
        if self.others.is_empty() {
            act(self, 0);
            return;
        }
        let before = Carets { main: self.caret(), others: std::mem::take(&mut self.others) };
        let mut all = before.others.clone();
        all.push(before.main);
        all.sort_by_key(|caret| (caret.range().start, caret.range().end));
        let main = all.iter().position(|caret| *caret == before.main).unwrap_or_default();
        let steps = self.undo.len();
        self.may_join = false;
        self.is_many = true;
        for (index, &caret) in all.iter().enumerate().rev() {
            self.caret = caret;
            act(self, index);
            // What comes before in the text moves it along.
            let done = self.caret;
            self.parked.push(done);
        }
        let mut done = std::mem::take(&mut self.parked);
        done.reverse();
        let caret = done.remove(main.min(done.len() - 1));
        self.is_many = false;
        let first = done.iter().map(|caret| caret.head).fold(caret.head, usize::min);
        let mut closers = std::mem::take(&mut self.closers);
        self.set_carets(caret, done);
        closers.retain(|&closer| closer >= first);
        self.closers = closers;
        self.join_steps(steps, before);
    }

    /// Places all carets; those that touch become one.
    pub(crate) fn set_carets(&mut self, main: Caret, others: Vec<Caret>) {
        self.set_caret(main);
        let main = self.caret();
        let mut kept: Vec<Caret> = Vec::new();
        for caret in others {
            let is_apart = |other: &Caret| {
                let (one, two) = (caret.range(), other.range());
                one.end < two.start
                    || two.end < one.start
                    || (!one.is_empty() && !two.is_empty() && (one.end == two.start || two.end == one.start))
            };
            if is_apart(&main) && kept.iter().all(is_apart) {
                kept.push(caret);
            }
        }
        self.others = kept;
    }

    /// Makes one step of those since there were `count` of them.
    fn join_steps(&mut self, count: usize, before: Carets) {
        if self.undo.len() <= count {
            return;
        }
        let changes = self.undo.drain(count..).flat_map(|step| step.changes).collect();
        let after = Carets { main: self.caret(), others: self.others.clone() };
        self.undo.push(Step { kind: EditKind::Single, changes, before, after });
        self.may_join = false;
    }
}

fn touches(caret: Caret, offset: usize) -> bool {
    let range = caret.range();
    range.start <= offset && offset <= range.end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Motion, TextCommand};

    fn with(text: &str, commands: &[TextCommand]) -> Document {
        let mut document = Document::new(text);
        for command in commands {
            command.apply(&mut document);
        }
        document
    }

    fn insert(text: &str) -> TextCommand {
        TextCommand::Insert(text.to_owned())
    }

    #[test]
    fn the_same_word_is_selected_again_and_again_and_typed_over_everywhere_as_one_step() {
        let text = "Drive(A); Stop(); Drive(B); Drive(C)";
        let more = TextCommand::SelectNextOccurrence;
        let mut document = with(text, &[more.clone(), more.clone(), more.clone(), more.clone(), more]);
        assert_eq!(document.carets().len(), 3, "and no more than there are");
        insert("G").apply(&mut document);
        insert("o").apply(&mut document);
        assert_eq!(document.text(), "Go(A); Stop(); Go(B); Go(C)");
        document.undo();
        document.undo();
        assert_eq!(document.text(), text);
        assert_eq!(document.carets().len(), 3, "the carets come back, too");
        document.redo();
        assert_eq!(document.text(), "G(A); Stop(); G(B); G(C)");
    }

    #[test]
    fn carets_above_and_below_keep_their_column_and_move_and_delete_together() {
        let down = TextCommand::AddCaretBelow;
        let end = TextCommand::Move { motion: Motion::LineEnd, select: false };
        let mut document = with("one\ntwo\nthree", &[down.clone(), down.clone(), down, end]);
        let heads = |document: &Document| document.carets().iter().map(|it| it.head).collect::<Vec<_>>();
        assert_eq!(heads(&document), [3, 7, 13]);
        insert(";").apply(&mut document);
        assert_eq!(document.text(), "one;\ntwo;\nthree;");
        TextCommand::Delete(Motion::Left).apply(&mut document);
        TextCommand::Delete(Motion::Left).apply(&mut document);
        assert_eq!(document.text(), "on\ntw\nthre");
        TextCommand::OneCaret.apply(&mut document);
        assert_eq!(document.carets().len(), 1);
    }

    #[test]
    fn a_click_adds_a_caret_and_another_takes_it_away() {
        let mut document = with("abc def", &[TextCommand::ToggleCaret(4), TextCommand::ToggleCaret(4)]);
        assert_eq!(document.carets(), [Caret::at(0)]);
        TextCommand::ToggleCaret(0).apply(&mut document);
        assert_eq!(document.carets(), [Caret::at(0)], "the last one stays");
    }

    #[test]
    fn carets_that_meet_become_one() {
        let home = TextCommand::Move { motion: Motion::LineStart, select: false };
        let document = with("abc def", &[TextCommand::ToggleCaret(4), home]);
        assert_eq!(document.carets(), [Caret::at(0)]);
    }

    #[test]
    fn all_carets_stay_between_characters_when_the_text_around_them_is_replaced() {
        let mut document = with("abc", &[TextCommand::ToggleCaret(1), TextCommand::ToggleCaret(3)]);
        document.replace_all("∞");
        let carets = document.carets();
        assert!(carets.iter().all(|caret| document.text().is_char_boundary(caret.head)), "{carets:?}");
    }

    #[test]
    fn as_many_lines_as_carets_are_pasted_one_to_each() {
        let down = TextCommand::AddCaretBelow;
        let document = with("\n\n", &[down.clone(), down, TextCommand::Paste("a\nb\nc".to_owned())]);
        assert_eq!(document.text(), "a\nb\nc");
    }

    #[test]
    fn any_mix_of_carets_and_keys_can_be_undone_to_the_start_and_redone_to_the_end() {
        let start = "scenario S = {\n  Drive(A); Drive(B);\n  délai[0,∞]\n}\n";
        for seed in 0..200_u64 {
            let mut document = Document::new(start);
            let mut random = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
            let mut next = |below: u64| {
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                random % below
            };
            for _ in 0..30 {
                let command = match next(12) {
                    0 => insert("("),
                    1 => insert(")"),
                    2 => insert("{"),
                    3 => insert("é"),
                    4 => TextCommand::NewLine,
                    5 => TextCommand::Delete(Motion::Left),
                    6 => TextCommand::ToggleCaret(next(60) as usize),
                    7 => TextCommand::AddCaretBelow,
                    8 => TextCommand::AddCaretAbove,
                    9 => TextCommand::SelectNextOccurrence,
                    10 => TextCommand::Paste("x\ny".to_owned()),
                    _ => TextCommand::Move { motion: Motion::WordRight, select: next(2) == 0 },
                };
                command.apply(&mut document);
                for caret in document.carets() {
                    let is_boundary = |at| document.text().is_char_boundary(at);
                    assert!(is_boundary(caret.head) && is_boundary(caret.anchor), "seed {seed}: {command:?}");
                }
            }
            let end = document.text().to_owned();
            while document.can_undo() {
                document.undo();
            }
            assert_eq!(document.text(), start, "seed {seed}");
            while document.can_redo() {
                document.redo();
            }
            assert_eq!(document.text(), end, "seed {seed}");
        }
    }
}
