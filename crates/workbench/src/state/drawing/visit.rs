//! Sending a vehicle to a place: the drive there, and what it does there.

use rmpl::program::{PrimitiveDecl, Program};
use rmpl::syntax::{SyntaxKind, SyntaxNode};
use rmpl::{Edit, Parse, Span};
use smol_str::SmolStr;

use super::call::{Kind, add, declare, kinds};
use super::{Place, insert, site};
use crate::state::placing::Names;

/// Adds a drive of a vehicle to a location and a visit of it after all else that the vehicle does, or in a thread of its
/// own. Declares the activities that the mission lacks.
pub(super) fn visit(parse: &Parse, file: Span, vehicle: &str, location: &str) -> Result<Vec<Edit>, String> {
    let program = parse.program();
    if !program.world.vehicles.iter().any(|it| it.name.text == vehicle) {
        return Err(format!("Unknown vehicle {vehicle}: declare it first"));
    }
    if !program.world.locations.iter().any(|it| it.name.text == location) {
        return Err(format!("Unknown location {location}: declare it first"));
    }
    let last = last_of(parse, &program, vehicle);
    let here = last.as_ref().and_then(|(_, at)| at.clone()).or_else(|| start(&program, vehicle));
    let mut names = Names::of(parse.text());
    let mut declared = Vec::new();
    let drives = |it: &&PrimitiveDecl| moves(it, vehicle);
    let drive = if let Some(drive) = program.primitives.iter().find(drives) {
        call(drive, vehicle, (here.as_deref(), location))
    } else {
        let name = name_for("Drive", &mut names);
        declared.push(format!("primitive {name}(rover, to)[1,inf] moves rover;"));
        format!("{name}({vehicle}, {location})")
    };
    let visit = if let Some(visit) = program.primitives.iter().find(|it| is_visit(&program, it, vehicle)) {
        call(visit, vehicle, (None, location))
    } else {
        let name = name_for("Visit", &mut names);
        declared.push(format!("primitive {name}(rover, site)[1,10] requires rover.at=site;"));
        format!("{name}({vehicle}, {location})")
    };
    let place = last.map_or(Place::Thread, |(span, _)| Place::After(span));
    let mut edits = insert(parse, file, &format!("{drive};\n{visit}"), place)?;
    if !declared.is_empty() {
        add(&mut edits, declare(parse, file, &declared.join("\n")));
    }
    Ok(edits)
}

/// A name by its plain word, or with a number where the mission has that word for something else.
fn name_for(word: &str, names: &mut Names) -> SmolStr {
    if names.contains(word) { names.fresh(word) } else { SmolStr::new(word) }
}

fn start(program: &Program, vehicle: &str) -> Option<String> {
    let declared = program.world.vehicles.iter().find(|it| it.name.text == vehicle)?;
    Some(declared.start.text.to_string())
}

/// Returns whether a primitive can move a vehicle, and that vehicle alone.
fn moves(primitive: &PrimitiveDecl, vehicle: &str) -> bool {
    let Some(moves) = &primitive.moves else { return false };
    let [leader] = moves.vehicles.as_slice() else { return false };
    let is_formal = primitive.formals.iter().any(|formal| formal.text == leader.text);
    let has_place = kinds(primitive).iter().any(|(_, kind)| *kind == Kind::Location);
    has_place && (is_formal || leader.text == vehicle)
}

/// Returns whether a primitive is what a vehicle does at a location that it is given.
fn is_visit(program: &Program, primitive: &PrimitiveDecl, vehicle: &str) -> bool {
    let kinds = kinds(primitive);
    let places = kinds.iter().filter(|(_, kind)| *kind == Kind::Location).count();
    let is_of_other = |it: &rmpl::program::Requirement| {
        let owner = it.condition.variable.text.strip_suffix(".at");
        let is_vehicle = |owner: &str| program.world.vehicles.iter().any(|it| it.name.text == owner);
        owner.is_some_and(|owner| is_vehicle(owner) && owner != vehicle)
    };
    primitive.moves.is_none() && places == 1 && !primitive.requires.iter().any(is_of_other)
}

/// A call that gives vehicles the vehicle, and locations the way from one to the other.
fn call(primitive: &PrimitiveDecl, vehicle: &str, (from, to): (Option<&str>, &str)) -> String {
    let kinds = kinds(primitive);
    let last = kinds.iter().rposition(|(_, kind)| *kind == Kind::Location);
    let arguments = kinds.iter().enumerate().map(|(index, (formal, kind))| match kind {
        Kind::Vehicle => vehicle.to_owned(),
        Kind::Location if Some(index) != last => from.unwrap_or(to).to_owned(),
        Kind::Location => to.to_owned(),
        Kind::Number => "1".to_owned(),
        Kind::Any => formal.to_uppercase(),
    });
    format!("{}({})", primitive.name.text, arguments.collect::<Vec<_>>().join(", "))
}

/// The last statement of the first scenario in which a vehicle does something, and where that takes it, if it says so.
fn last_of(parse: &Parse, program: &Program, vehicle: &str) -> Option<(Span, Option<String>)> {
    let block = site::scenario_block(parse).ok()?;
    let is_location = |text: &str| program.world.locations.iter().any(|it| it.name.text == text);
    let does = |call: &SyntaxNode<'_>| {
        let names: Vec<&str> = words(*call);
        let primitive =
            names.first().and_then(|name| program.primitives.iter().find(|it| it.name.text == *name));
        let is_own = |it: &PrimitiveDecl| {
            let moved = it.moves.iter().flat_map(|moves| &moves.vehicles).any(|it| it.text == vehicle);
            moved || it.requires.iter().any(|it| it.condition.variable.text == format!("{vehicle}.at"))
        };
        names.iter().skip(1).any(|name| *name == vehicle) || primitive.is_some_and(is_own)
    };
    let last = block.descendants().filter(|node| node.kind() == SyntaxKind::Call && does(node)).last()?;
    let place = words(last).into_iter().skip(1).rfind(|name| is_location(name));
    let span = site::unconditional(parse, last.span())?.span();
    Some((span, place.map(str::to_owned)))
}

/// The names in a call: what is called, and its arguments.
fn words(call: SyntaxNode<'_>) -> Vec<&str> {
    call.tokens().filter(|token| token.kind == SyntaxKind::Name).map(|token| token.text).collect()
}
