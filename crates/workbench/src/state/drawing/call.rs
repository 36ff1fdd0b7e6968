//! The calls that a mission offers with their arguments, and activities that are not declared yet.

use std::collections::BTreeSet;

use rmpl::program::{PrimitiveDecl, Program};
use rmpl::syntax::{SyntaxKind, SyntaxNode};
use rmpl::{Edit, Parse, Span};
use smol_str::SmolStr;

use super::list::insertion;
use super::{Drawn, Place, insert, site};
use crate::state::placing::{Names, behind};

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

/// What a parameter can represent.
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

/// Returns what the parameters of a primitive represent, as far as the declaration tells.
pub(super) fn kinds(primitive: &PrimitiveDecl) -> Vec<(String, Kind)> {
    let moves = primitive.moves.as_deref();
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
pub(super) fn new_activity(parse: &Parse, file: Span, at: Place) -> Result<Drawn, String> {
    let name = Names::of(parse.text()).fresh("Activity");
    let mut edits = insert(parse, file, &format!("{name}()"), at)?;
    add(&mut edits, declare(parse, file, &format!("primitive {name}(){NEW_BOUNDS};")));
    edits.sort_by_key(|edit| edit.span);
    let mut drawn = Drawn { edits, ..Drawn::default() };
    let changed = drawn.apply(parse.text());
    let places = changed.match_indices(name.as_str());
    drawn.typed_over = places.map(|(at, _)| Span::new(at as u32, (at + name.len()) as u32)).collect();
    Ok(drawn)
}

/// Adds statements, and declares the activities that they call and the mission lacks.
pub(super) fn paste(parse: &Parse, file: Span, text: &str, at: Place) -> Result<Vec<Edit>, String> {
    let mut edits = insert(parse, file, text, at)?;
    let declared = undeclared(parse, text);
    if !declared.is_empty() {
        add(&mut edits, declare(parse, file, &declared.join("\n")));
    }
    Ok(edits)
}

/// A declaration for each activity that statements call and the mission lacks, with a parameter for each argument.
fn undeclared(parse: &Parse, text: &str) -> Vec<String> {
    let program = parse.program();
    let mut known: BTreeSet<SmolStr> = program.primitives.iter().map(|it| it.name.text.clone()).collect();
    known.extend(program.activities.iter().map(|it| it.name.text.clone()));
    let statements = rmpl::parse(&format!("scenario S = {{ {text} }}"));
    let nodes = statements.declarations().flat_map(SyntaxNode::descendants);
    let mut declared = Vec::new();
    for call in nodes.filter(|node| node.kind() == SyntaxKind::Call) {
        let called = call.tokens().find(|token| token.kind == SyntaxKind::Name);
        let Some(name) = called.map(|token| token.text) else { continue };
        if !known.insert(name.into()) {
            continue;
        }
        let arguments = call.child(SyntaxKind::Arguments).map_or(0, |all| all.children().count());
        let formals: Vec<String> = (1..=arguments).map(|at| format!("p{at}")).collect();
        declared.push(format!("primitive {name}({}){NEW_BOUNDS};", formals.join(", ")));
    }
    declared
}

/// Declares something in a file: after its last primitive, or else before its first definition, or at its end.
pub(super) fn declare(parse: &Parse, file: Span, declaration: &str) -> Edit {
    let is_there = move |it: &SyntaxNode<'_>| file.contains(it.span());
    let find =
        |kind: SyntaxKind| parse.declarations().filter_map(move |root| root.child(kind)).filter(is_there);
    if let Some(last) = find(SyntaxKind::PrimitiveDecl).last() {
        return insertion(behind(parse.text(), last.span().end), format!("\n{declaration}"));
    }
    let activity = find(SyntaxKind::ActivityDecl).next();
    let scenario = find(SyntaxKind::ScenarioDecl).next();
    let first = activity.into_iter().chain(scenario).map(|it| it.span().start).min();
    match first {
        Some(first) => insertion(first, format!("{declaration}\n\n")),
        None => at_end(parse, file, declaration),
    }
}

/// Adds lines at the end of a file.
fn at_end(parse: &Parse, file: Span, lines: &str) -> Edit {
    let text = parse.text().get(file.range()).unwrap_or_default();
    insertion(file.end, format!("{}{lines}\n", gap(text)))
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
pub(super) fn new_scenario(parse: &Parse, file: Span, text: &str) -> Option<Edit> {
    let has_one = site::scenario_block(parse).is_ok();
    let lines = super::list::braced("scenario Mission = ", &[text.to_owned()], "");
    (!has_one).then(|| at_end(parse, file, &lines))
}
