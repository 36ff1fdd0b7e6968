//! Templates: pieces of text with stops, which Tab goes to one after the other.

use rmpl::{Edit, Span};

use crate::{Caret, Document, EditKind};

/// What is left of a template that was inserted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Stops {
    /// Where the stops are that Tab has not gone to, in their order.
    pub(crate) left: Vec<usize>,
    /// Where the template begins and ends: a caret outside of it has left it.
    pub(crate) range: (usize, usize),
}

impl Document {
    /// Replaces a span by a template, as one step. `$1`, `$2` and so on are its stops and `$0` the last one; the caret
    /// goes to the first, or after the text if there is none.
    pub fn insert_template(&mut self, span: Span, template: &str) {
        let (text, stops) = parsed(template);
        let start = self.boundary_before(span.start as usize);
        let length = text.len();
        let mut stops = stops.into_iter().map(|at| start + at);
        let caret = Caret::at(stops.next().unwrap_or(start + length));
        self.edit(&[Edit { span, text }], EditKind::Single, Some(caret));
        // One inside of another goes back to that one.
        let outer = std::mem::take(&mut self.stops);
        let range = if outer.left.is_empty() { (start, start + length) } else { outer.range };
        self.stops = Stops { range, left: stops.chain(outer.left).collect() };
    }

    /// Returns whether Tab goes to another stop of a template.
    pub fn has_stops(&self) -> bool {
        !self.stops.left.is_empty()
    }

    /// Goes to the next stop of the template around the caret. Returns whether there was one.
    pub(crate) fn go_to_next_stop(&mut self) -> bool {
        if self.stops.left.is_empty() {
            return false;
        }
        let mut stops = std::mem::take(&mut self.stops);
        self.set_caret(Caret::at(stops.left.remove(0)));
        self.stops = stops;
        true
    }

    /// Leaves the template: Tab indents again.
    pub fn leave_template(&mut self) {
        self.stops = Stops::default();
    }
}

/// The text of a template, and where its stops are, in their order.
fn parsed(template: &str) -> (String, Vec<usize>) {
    let mut text = String::with_capacity(template.len());
    let mut stops = Vec::new();
    let mut characters = template.chars().peekable();
    while let Some(character) = characters.next() {
        match characters.peek().and_then(|next| next.to_digit(10)).filter(|_| character == '$') {
            Some(number) => {
                characters.next();
                stops.push((if number == 0 { 10 } else { number }, text.len()));
            }
            None => text.push(character),
        }
    }
    stops.sort_unstable();
    (text, stops.into_iter().map(|(_, at)| at).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TextCommand;

    #[test]
    fn tab_goes_from_stop_to_stop_whatever_is_typed_between() {
        let mut document = Document::new("lo");
        document.insert_template(Span::new(0, 2), "location $1 ($2, $3);$0");
        for (typed, is_more) in [("BASE", true), ("10", true), ("20", true)] {
            TextCommand::Insert(typed.to_owned()).apply(&mut document);
            assert_eq!(document.has_stops(), is_more);
            TextCommand::Indent.apply(&mut document);
        }
        assert_eq!(document.text(), "location BASE (10, 20);");
        assert_eq!(document.caret(), Caret::at(document.text().len()));
        TextCommand::Indent.apply(&mut document);
        assert!(document.text().ends_with("; "), "then Tab indents again");
    }

    #[test]
    fn a_template_inside_of_another_goes_back_to_that_one() {
        let mut document = Document::new("");
        document.insert_template(Span::new(0, 0), "do { $1 } maintaining $0");
        document.insert_template(Span::new(5, 5), "Drive($1)$0");
        for typed in ["A", ";", "P=ON"] {
            TextCommand::Insert(typed.to_owned()).apply(&mut document);
            TextCommand::Indent.apply(&mut document);
        }
        assert!(document.text().starts_with("do { Drive(A); } maintaining P=ON"), "{}", document.text());
    }

    #[test]
    fn a_caret_that_leaves_the_template_leaves_its_stops() {
        let mut document = Document::new("x\n");
        document.insert_template(Span::new(2, 2), "const $1 = $2;$0");
        assert!(document.has_stops());
        document.set_caret(Caret::at(0));
        assert!(!document.has_stops());
    }

    #[test]
    fn a_text_without_stops_is_inserted_as_it_is_with_the_caret_behind() {
        let mut document = Document::new("");
        document.insert_template(Span::new(0, 0), "costs $ 5");
        assert_eq!((document.text(), document.caret()), ("costs $ 5", Caret::at(9)));
    }
}
