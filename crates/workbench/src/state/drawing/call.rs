//! The calls that a mission offers with their arguments, and activities that are not declared yet.

use rmpl::program::{PrimitiveDecl, Program};
use rmpl::syntax::SyntaxKind;
use rmpl::{Edit, Parse, Span};

use super::list::insertion;
use super::{Drawn, Place, insert, site};
use crate::state::placing::Names;

/// An activity that a mission declares, with the calls of it that are offered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Callable {
    pub name: String,
    /// Each as it is written, such as `Drive(RIDGE)`.
    pub calls: Vec<String>,
}

/// At most this many calls of one activity are offered.
const MAX_CALLS: usize = 24;
/// The bounds of a new activity, and of a statement whose duration is set, for the author to type over.
pub const NEW_BOUNDS: &str = "[1,5]";

/// What a parameter can stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Vehicle,
    Location,
    Number,
    /// Unknown: no use of the parameter tells.
    Any,
}

/// The activities that a mission declares, in textual order, with their calls: a call for each vehicle and location.
pub fn callables(program: &Program) -> Vec<Callable> {
    let world = &program.world;
    let vehicles = || world.vehicles.iter().map(|it| it.name.text.to_string());
    let locations = || world.locations.iter().map(|it| it.name.text.to_string());
    let choices = |name: &str, kind: Kind| -> Vec<String> {
        let found: Vec<String> = match kind {
            Kind::Vehicle => vehicles().collect(),
            Kind::Location | Kind::Any => locations().collect(),
            Kind::Number => vec!["1".to_owned()],
        };
        if found.is_empty() { vec![name.to_uppercase()] } else { found }
    };
    let calls = |name: &str, kinds: Vec<(String, Kind)>| {
        let mut calls = vec![Vec::<String>::new()];
        for (formal, kind) in kinds {
            let options = choices(&formal, kind);
            let longer = |call: &Vec<String>| -> Vec<Vec<String>> {
                options.iter().map(|it| call.iter().cloned().chain([it.clone()]).collect()).collect()
            };
            calls = calls.iter().flat_map(longer).take(MAX_CALLS).collect();
        }
        let calls = calls.into_iter().map(|arguments| format!("{name}({})", arguments.join(", ")));
        Callable { name: name.to_owned(), calls: calls.collect() }
    };
    let mut found: Vec<(u32, Callable)> = Vec::new();
    for primitive in &program.primitives {
        found.push((primitive.name.span.start, calls(&primitive.name.text, kinds(primitive))));
    }
    for activity in &program.activities {
        let written = activity.formals.iter().zip(&activity.kinds);
        let kinds = written.map(|(formal, kind)| {
            let kind = kind.as_ref().map(|kind| kind.text.as_str());
            (formal.text.to_string(), written_kind(program, kind).unwrap_or(Kind::Any))
        });
        found.push((activity.name.span.start, calls(&activity.name.text, kinds.collect())));
    }
    found.sort_by_key(|(at, _)| *at);
    found.into_iter().map(|(_, callable)| callable).collect()
}

/// What the parameters of a primitive stand for, as far as the declaration tells.
pub(super) fn kinds(primitive: &PrimitiveDecl) -> Vec<(String, Kind)> {
    let moves = primitive.moves.as_ref();
    let kind_of = |(index, formal): (usize, &rmpl::program::Name)| {
        let name = formal.text.as_str();
        let is_vehicle = moves.is_some_and(|moves| moves.vehicles.iter().any(|it| it.text == name))
            || primitive.requires.iter().any(|it| it.condition.variable.text == format!("{name}.at"));
        let is_place = |it: &rmpl::program::Requirement| {
            it.condition.variable.text.ends_with(".at")
                && it.condition.values.iter().any(|it| it.text == name)
        };
        let written = primitive.kinds.get(index).and_then(Option::as_ref).map(|kind| kind.text.as_str());
        let kind = match written {
            Some("vehicle") => Kind::Vehicle,
            Some("location") => Kind::Location,
            Some("number") => Kind::Number,
            _ if is_vehicle => Kind::Vehicle,
            _ if moves.is_some() || primitive.requires.iter().any(is_place) => Kind::Location,
            _ => Kind::Any,
        };
        (name.to_owned(), kind)
    };
    primitive.formals.iter().enumerate().map(kind_of).collect()
}

fn written_kind(program: &Program, kind: Option<&str>) -> Option<Kind> {
    match kind? {
        "vehicle" => Some(Kind::Vehicle),
        "location" => Some(Kind::Location),
        "number" => Some(Kind::Number),
        model if program.world.vehicles.iter().any(|it| it.model.text == model) => Some(Kind::Vehicle),
        _ => None,
    }
}

/// Adds a call of an activity that is new, and declares it; the author types its name over both.
pub(super) fn new_activity(parse: &Parse, at: Place) -> Result<Drawn, String> {
    let name = Names::of(parse.text()).fresh("Activity");
    let mut edits = insert(parse, &format!("{name}()"), at)?;
    add(&mut edits, declare(parse, &format!("primitive {name}(){NEW_BOUNDS};")));
    edits.sort_by_key(|edit| edit.span);
    let mut drawn = Drawn { edits, ..Drawn::default() };
    let changed = drawn.apply(parse.text());
    let places = changed.match_indices(name.as_str());
    drawn.typed_over = places.map(|(at, _)| Span::new(at as u32, (at + name.len()) as u32)).collect();
    Ok(drawn)
}

/// Declares something after the last primitive, or else before the first definition, or at the end.
pub(super) fn declare(parse: &Parse, declaration: &str) -> Edit {
    let find = |kind: SyntaxKind| parse.declarations().filter_map(move |root| root.child(kind));
    if let Some(last) = find(SyntaxKind::PrimitiveDecl).last() {
        return insertion(last.span().end, format!("\n{declaration}"));
    }
    let activity = find(SyntaxKind::ActivityDecl).next();
    let scenario = find(SyntaxKind::ScenarioDecl).next();
    let first = activity.into_iter().chain(scenario).map(|it| it.span().start).min();
    match first {
        Some(first) => insertion(first, format!("{declaration}\n\n")),
        None => insertion(parse.text().len() as u32, format!("{}{declaration}\n", gap(parse.text()))),
    }
}

/// Adds a declaration to edits. Both may go to the end of a text that has neither activities nor a scenario.
pub(super) fn add(edits: &mut Vec<Edit>, declaration: Edit) {
    match edits.iter_mut().find(|edit| edit.span == declaration.span) {
        Some(same) => same.text = format!("{}\n{}", declaration.text, same.text.trim_start_matches('\n')),
        None => edits.push(declaration),
    }
}

/// The blank lines between a text and a declaration that is added at its end.
pub fn gap(text: &str) -> &'static str {
    if text.trim().is_empty() || text.ends_with("\n\n") {
        ""
    } else if text.ends_with('\n') {
        "\n"
    } else {
        "\n\n"
    }
}

/// Puts statements into a scenario that the mission does not have yet.
pub(super) fn new_scenario(parse: &Parse, text: &str) -> Option<Edit> {
    let has_one = site::scenario_block(parse).is_ok();
    let end = parse.text().len() as u32;
    let lines = super::list::braced("scenario Mission = ", &[text.to_owned()], "");
    (!has_one).then(|| insertion(end, format!("{}{lines}\n", gap(parse.text()))))
}
