//! Places of an older text carried over to the present one, so that marks stay put while answers are under way.

use rmpl::Span;

/// How one text became another: a single replacement that covers all changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shift {
    start: usize,
    removed: usize,
    inserted: usize,
}

impl Shift {
    /// The change from `old` to `new`.
    pub fn between(old: &str, new: &str) -> Self {
        let (old, new) = (old.as_bytes(), new.as_bytes());
        let prefix = old.iter().zip(new).take_while(|(left, right)| left == right).count();
        let rest = old[prefix..].iter().rev().zip(new[prefix..].iter().rev());
        let suffix = rest.take_while(|(left, right)| left == right).count();
        Self { start: prefix, removed: old.len() - prefix - suffix, inserted: new.len() - prefix - suffix }
    }

    /// The change that changes nothing.
    pub const NONE: Self = Self { start: 0, removed: 0, inserted: 0 };

    /// Where a span of the old text is in the new one; `None` if all of it was replaced.
    pub fn span(self, span: Span) -> Option<Span> {
        let (start, end) = (self.offset(span.start as usize, true), self.offset(span.end as usize, false));
        let survives = start < end || span.start == span.end;
        survives.then(|| Span::new(start as u32, end as u32))
    }

    fn offset(self, offset: usize, is_start: bool) -> usize {
        let end = self.start + self.removed;
        if offset < self.start || offset == self.start && (!is_start || self.removed > 0) {
            offset
        } else if offset >= end {
            offset - self.removed + self.inserted
        } else if is_start {
            self.start + self.inserted
        } else {
            self.start
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_move_with_the_text_around_them() {
        let shift = Shift::between("one two three", "one 2222222 three");
        assert_eq!(shift.span(Span::new(0, 3)), Some(Span::new(0, 3)));
        assert_eq!(shift.span(Span::new(8, 13)), Some(Span::new(12, 17)));
        assert_eq!(shift.span(Span::new(5, 6)), None);
    }

    #[test]
    fn typing_before_a_span_pushes_it_on_and_typing_behind_it_leaves_it() {
        let before = Shift::between("ab", "xab");
        assert_eq!(before.span(Span::new(0, 2)), Some(Span::new(1, 3)));
        let behind = Shift::between("ab", "abx");
        assert_eq!(behind.span(Span::new(0, 2)), Some(Span::new(0, 2)));
    }
}
