//! Drawings of automata: what is inside lies inside, and nothing lies over anything else.

use std::sync::Arc;

use display::{Rect, Theme, approximate_text_width, svg};
use hca::{Automaton, Element, LocationId, Vocabulary, compile_text};
use layout::{AutomatonDrawing, AutomatonItem, AutomatonState, automaton_list};

const ORBIT: &str = include_str!("../../../../tests/conformance/h01_orbit_nominal.rmpl");

fn compiled(text: &str) -> Arc<Automaton> {
    let compilation = compile_text(text, &Vocabulary::default());
    compilation.automaton.unwrap_or_else(|| panic!("{:#?}", compilation.diagnostics))
}

fn drawn(automaton: &Automaton) -> AutomatonDrawing {
    layout::automaton(automaton, &approximate_text_width)
}

fn inside(inner: Rect, outer: Rect) -> bool {
    outer.contains(inner.min) && outer.contains(inner.max)
}

/// Programs with every form, nested.
const PROGRAMS: [&str; 6] = [
    ORBIT,
    // Guards of several lines, over an arrow to each of two and over one back.
    "P ()::(PARALLEL (IF-THENNEXT-ELSENEXT ((first_engine = standing_by) AND (second_engine = standing_by) AND (camera = off)) (A = on) (DO-WATCHING (A = on) (B = on))) (WHENEVER-DONEXT ((first_engine = standing_by) OR (second_engine = standing_by) OR (camera = off)) (A = on)))",
    "P ()::(SEQUENCE (A = on) (PARALLEL (B = off) (ALWAYS (C = on))) (WHENEVER-DONEXT (A = on) (B = on)))",
    "P ()::(IF-THENNEXT-ELSENEXT (A = on) (SEQUENCE (B = on) (C = on)) (UNLESS-THENNEXT (B = on) (A = off)))",
    "P ()::(DO-WATCHING (A = failed) (SEQUENCE (WHEN-DONEXT (A = on) (DO-WATCHING (B = on) (ALWAYS (C = on)))) (D = on)))",
    // A title longer than what is in its box, and a box within a box with nothing between them.
    "P ()::(SEQUENCE (DO-WATCHING (door = open) (ALWAYS (lamp = on))) (DO-WATCHING (B = on) (DO-WATCHING ~(A = on) (C = on))))",
];

#[test]
fn every_location_and_transition_is_drawn() {
    for program in PROGRAMS {
        let automaton = compiled(program);
        let drawing = drawn(&automaton);
        assert_eq!(drawing.locations.len(), automaton.locations.len());
        assert_eq!(drawing.transitions.len(), automaton.transitions.len());
    }
}

#[test]
fn boxes_nest_as_composites_do() {
    for program in PROGRAMS {
        let automaton = compiled(program);
        let drawing = drawn(&automaton);
        let rect_of = |element: Element| match element {
            Element::Location(id) => Some(drawing.locations[id.0 as usize].rect),
            Element::Composite(id) => {
                drawing.composites.iter().find(|shape| shape.id == id).map(|it| it.rect)
            }
        };
        for shape in &drawing.composites {
            let composite = automaton.composite(shape.id).expect("it exists");
            for rect in composite.children.iter().filter_map(|&child| rect_of(child)) {
                assert!(inside(rect, shape.rect), "{rect:?} sticks out of {shape:?}");
            }
        }
        assert!(drawing.texts.iter().all(|text| inside(text.rect, drawing.bounds)), "a text is clipped");
    }
}

#[test]
fn texts_and_locations_do_not_overlap() {
    for program in PROGRAMS {
        let drawing = drawn(&compiled(program));
        let texts: Vec<_> = drawing.texts.iter().collect();
        for (at, text) in texts.iter().enumerate() {
            for other in &texts[at + 1..] {
                assert!(!text.rect.overlaps(other.rect), "{:?} lies over {:?}", text.lines, other.lines);
            }
            for location in &drawing.locations {
                let own = text.owner == AutomatonItem::Location(location.id);
                assert!(own || !text.rect.overlaps(location.rect), "{:?} lies over {location:?}", text.lines);
            }
        }
        for (at, location) in drawing.locations.iter().enumerate() {
            assert!(drawing.locations[at + 1..].iter().all(|other| !other.rect.overlaps(location.rect)));
        }
    }
}

#[test]
fn what_was_preempted_is_told_where_nothing_else_is_written() {
    let mut notes = 0;
    for program in PROGRAMS {
        let automaton = compiled(program);
        let drawing = drawn(&automaton);
        let watching = drawing.composites.iter().filter(|it| it.is_watching).map(|it| it.id);
        let preempted: Vec<_> = watching.collect();
        let state = AutomatonState { preempted: &preempted, ..AutomatonState::default() };
        let list = automaton_list(&drawing, &automaton, &state);
        let (told, others): (Vec<_>, Vec<_>) =
            list.texts().iter().partition(|text| text.text.contains("preempted"));
        assert_eq!(told.len(), preempted.len());
        for (at, note) in told.iter().enumerate() {
            assert!(inside(note.rect, drawing.bounds), "{:?} is cut off in {program}", note.rect);
            for other in told[at + 1..].iter().chain(&others) {
                assert!(!note.rect.overlaps(other.rect), "it lies over {} in {program}", other.text);
            }
            for location in &drawing.locations {
                assert!(!note.rect.overlaps(location.rect), "it lies over {location:?} in {program}");
            }
        }
        notes += told.len();
    }
    assert!(notes >= 7, "{notes}");
}

#[test]
fn transitions_run_from_their_location_to_their_target() {
    for program in PROGRAMS {
        let automaton = compiled(program);
        let drawing = drawn(&automaton);
        for shape in &drawing.transitions {
            let transition = &automaton.transitions[shape.id.0 as usize];
            let source = drawing.locations[transition.source.0 as usize].rect;
            assert!(source.expanded(0.5).contains(shape.start));
            let end = shape.pieces.last().expect("it goes somewhere").end();
            if let Element::Location(target) = transition.target {
                assert!(drawing.locations[target.0 as usize].rect.expanded(0.5).contains(end));
            }
            assert!(transition.target == Element::Location(transition.source) || end.x > source.max.x);
        }
    }
}

#[test]
fn the_locations_of_orbit_insert_start_as_the_paper_says() {
    let drawing = drawn(&compiled(ORBIT));
    let starts = drawing.locations.iter().filter(|location| location.is_start).count();
    assert_eq!(starts, 5, "SPEC 8.4: a1 a2 a3 w1 w2");
    let watching = drawing.composites.iter().filter(|composite| composite.is_watching).count();
    assert_eq!(watching, 2, "the outer composite and that of w1 and a4");
}

#[test]
fn a_place_on_the_drawing_leads_back_to_what_is_there() {
    let drawing = drawn(&compiled(ORBIT));
    for location in &drawing.locations {
        let found = drawing.pick(location.rect.center(), 3.0);
        assert_eq!(found, Some(AutomatonItem::Location(location.id)));
    }
    assert!(matches!(
        drawing.pick(drawing.composites[0].rect.min.shifted(2.0, 2.0), 0.5),
        Some(AutomatonItem::Composite(_))
    ));
}

#[test]
fn marked_locations_stand_out_in_the_exported_picture() {
    let automaton = compiled(ORBIT);
    let drawing = drawn(&automaton);
    let marking = automaton.start();
    assert!(marking.contains(LocationId(0)));
    let drawn = |state: &AutomatonState<'_>| {
        svg(&[&automaton_list(&drawing, &automaton, state)], Theme::Light, "OrbitInsert")
    };
    let plain = drawn(&AutomatonState::default());
    let marked = drawn(&AutomatonState { marking: Some(&marking), ..AutomatonState::default() });
    let strong = "stroke-width=\"2.6\"";
    assert_eq!((plain.matches(strong).count(), marked.matches(strong).count()), (0, 5));
}
