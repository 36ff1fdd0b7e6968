//! Who changes, requires and uses what lasts: states, the places of vehicles, resources.

use crate::analysis::{Origin, Symbol, UseKind};
use crate::parse::Parse;
use crate::program::{Change, LabelMode};

/// How many names a line lists.
const MAX_NAMES: usize = 8;

/// Returns who sets a state variable, and who needs it; empty where no one does.
pub(super) fn users_of_state(parse: &Parse, variable: &str) -> Vec<String> {
    let Some(symbol) = parse.meaning().names.find(variable) else { return Vec::new() };
    let (mut setters, mut users) = (Vec::new(), Vec::new());
    for (_, summary) in parse.summaries() {
        let Some(definition) = &summary.definition else { continue };
        for literal in &summary.literals {
            let stem = literal.split.map(|(stem, _)| stem);
            if literal.variable != symbol && stem != Some(symbol) {
                continue;
            }
            match (literal.mode, literal.origin) {
                (_, Origin::Argument) => {}
                (LabelMode::Tell, Origin::Written | Origin::Effect) => setters.push(definition.name),
                _ => users.push(definition.name),
            }
        }
    }
    [line(parse, "Set by", setters), line(parse, "Needed by", users)].into_iter().flatten().collect()
}

/// Returns who moves a vehicle, sets its place, and needs it to be somewhere.
pub(super) fn users_of_vehicle(parse: &Parse, vehicle: &str) -> Vec<String> {
    let symbol = parse.meaning().names.find(vehicle);
    let is_move = |kind: UseKind| kind == UseKind::Vehicle;
    let movers = symbol.map(|symbol| declarations_with(parse, symbol, is_move)).unwrap_or_default();
    let place = format!("{vehicle}.at");
    let about_place =
        users_of_state(parse, &place).into_iter().map(|line| format!("`{place}`: {}", lower_first(&line)));
    line(parse, "Moved by", movers).into_iter().chain(about_place).collect()
}

/// Returns who does what to a resource.
pub(super) fn users_of_resource(parse: &Parse, resource: &str) -> Vec<String> {
    let Some(symbol) = parse.meaning().names.find(resource) else { return Vec::new() };
    let ways =
        [("Used by", Change::Uses), ("Consumed by", Change::Consumes), ("Produced by", Change::Produces)];
    let lines = ways.into_iter().map(|(what, change)| {
        line(parse, what, declarations_with(parse, symbol, |kind| kind == UseKind::Resource(change)))
    });
    lines.flatten().collect()
}

/// The names of the declarations that use a name in this way, in textual order.
fn declarations_with(parse: &Parse, name: Symbol, is_way: impl Fn(UseKind) -> bool) -> Vec<Symbol> {
    let uses = |summary: &&crate::analysis::Summary| {
        summary.uses.iter().any(|used| used.name == name && is_way(used.kind))
    };
    let using = parse.summaries().map(|(_, summary)| summary).filter(uses);
    using.filter_map(|summary| summary.definition.as_ref()).map(|definition| definition.name).collect()
}

fn line(parse: &Parse, what: &str, mut names: Vec<Symbol>) -> Option<String> {
    names.dedup();
    let shown = names.iter().take(MAX_NAMES).map(|&name| format!("`{}`", parse.meaning().names.text(name)));
    let mut shown: Vec<String> = shown.collect();
    if names.len() > MAX_NAMES {
        shown.push(format!("{} more", names.len() - MAX_NAMES));
    }
    (!shown.is_empty()).then(|| format!("{what} {}", shown.join(", ")))
}

fn lower_first(line: &str) -> String {
    let mut letters = line.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}
