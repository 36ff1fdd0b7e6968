//! Selection between text and automaton: where each thing is written, and what stands where the caret is.

use hca::{Automaton, CompositeId, CompositeKind, LocationId, TransitionId};
use layout::AutomatonItem;
use rmpl::Span;
use text_editing::Caret;

/// Returns where something on the drawing is written; for a transition its guard.
pub(super) fn span_of(automaton: &Automaton, item: AutomatonItem) -> Option<Span> {
    match item {
        AutomatonItem::Location(id) => Some(automaton.location(id)?.span),
        AutomatonItem::Composite(id) => Some(automaton.composite(id)?.span),
        AutomatonItem::Transition(id) => {
            let transition = automaton.transitions.get(id.0 as usize)?;
            let guard = transition.guard.and_then(|guard| automaton.guard(guard));
            guard.map(|guard| guard.span).or_else(|| Some(automaton.location(transition.source)?.span))
        }
    }
}

/// Returns what is marked on the drawing: what was pressed last, as long as its text is selected; otherwise all that
/// the smallest expression around the caret, or around the selected text, represents.
pub(super) fn marked(
    automaton: &Automaton,
    caret: Caret,
    pressed: Option<AutomatonItem>,
) -> Vec<AutomatonItem> {
    let range = caret.range();
    let pressed = pressed.filter(|item| span_of(automaton, *item).is_some_and(|span| span.range() == range));
    if let Some(pressed) = pressed {
        return vec![pressed];
    }
    let mut least = usize::MAX;
    let mut found = Vec::new();
    for (span, item) in written(automaton) {
        let around = span.range();
        if around.start > range.start || range.end > around.end || around.len() > least {
            continue;
        }
        if around.len() < least {
            least = around.len();
            found.clear();
        }
        found.push(item);
    }
    found
}

/// Everything that the parts of the text represent, but for the program as a whole.
fn written(automaton: &Automaton) -> impl Iterator<Item = (Span, AutomatonItem)> {
    let locations = (0..).map(LocationId).zip(&automaton.locations);
    let locations = locations.map(|(id, location)| (location.span, AutomatonItem::Location(id)));
    let composites = (0..).map(CompositeId).zip(&automaton.composites);
    let composites = composites.filter(|(_, composite)| composite.kind != CompositeKind::Program);
    let composites = composites.flat_map(|(id, composite)| {
        let condition = composite.maintenance.and_then(|test| automaton.guard(test));
        let spans = [Some(composite.span), condition.map(|condition| condition.span)];
        spans.into_iter().flatten().map(move |span| (span, AutomatonItem::Composite(id)))
    });
    let transitions = (0..).map(TransitionId).zip(&automaton.transitions);
    let transitions = transitions.filter_map(|(id, transition)| {
        let guard = automaton.guard(transition.guard?)?;
        Some((guard.span, AutomatonItem::Transition(id)))
    });
    locations.chain(composites).chain(transitions)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "P ():: (DO-WATCHING (a = yes) (PARALLEL (b = yes) (WHEN-DONEXT (c = yes) (d = yes))))";

    fn automaton() -> std::sync::Arc<Automaton> {
        hca::compile_text(TEXT, &hca::Vocabulary::default()).automaton.expect("it is well formed")
    }

    /// The names of what is marked with the caret before `word`.
    fn at(automaton: &Automaton, word: &str) -> Vec<String> {
        let offset = TEXT.find(word).expect("in the text") + 1;
        let names = marked(automaton, Caret::at(offset), None).into_iter().map(|item| match item {
            AutomatonItem::Location(id) => automaton.location_name(id),
            AutomatonItem::Composite(id) => format!("{:?}", automaton.composite(id).expect("known").kind),
            AutomatonItem::Transition(_) => "transition".to_owned(),
        });
        names.collect()
    }

    #[test]
    fn the_caret_marks_the_smallest_expression_around_it() {
        let automaton = automaton();
        assert_eq!(at(&automaton, "PARALLEL"), ["Parallel"]);
        assert_eq!(at(&automaton, "DO-WATCHING"), ["DoWatching"]);
        assert_eq!(at(&automaton, "a = yes"), ["DoWatching"], "its condition");
        assert!(at(&automaton, "b = yes").contains(&"a1".to_owned()));
        assert!(at(&automaton, "WHEN-DONEXT").contains(&"w1".to_owned()));
        assert_eq!(
            at(&automaton, "c = yes"),
            ["transition", "transition"],
            "its guard and the opposite of it"
        );
        assert!(at(&automaton, "P ()").is_empty());
    }

    #[test]
    fn what_was_pressed_is_marked_alone_while_its_text_is_selected() {
        let automaton = automaton();
        let pressed = AutomatonItem::Transition(TransitionId(automaton.transitions.len() as u32 - 1));
        let range = span_of(&automaton, pressed).expect("written").range();
        let selecting = Caret::selecting(range.start, range.end);
        assert_eq!(marked(&automaton, selecting, Some(pressed)), [pressed]);
        assert_ne!(marked(&automaton, Caret::at(range.start), Some(pressed)), [pressed], "the caret went on");
        let location = AutomatonItem::Location(LocationId(0));
        let range = span_of(&automaton, location).expect("written").range();
        let inside = marked(&automaton, Caret::selecting(range.start, range.end), Some(pressed));
        assert!(inside.contains(&location), "selected in the text");
    }
}
