//! What can be written at a place.

use rustc_hash::FxHashSet;
use smol_str::SmolStr;

use super::place::Place;
use super::{CompletionItem, CompletionKind};
use crate::analysis::{Definition, Namespace, Symbol};
use crate::editor::cursor::declaration_at_cursor;
use crate::editor::name::{NameKind, names_in};
use crate::editor::outline::{OutlineItem, OutlineKind, outline};
use crate::parse::Parse;
use crate::parser::CONTINGENT;
use crate::program::VEHICLE_MODELS;
use crate::syntax::KEEPOUT;

pub(super) fn items(parse: &Parse, offset: u32, place: &Place) -> Vec<CompletionItem> {
    let mut items = Vec::new();
    match place {
        Place::File => items.extend(DECLARATIONS.iter().map(|(label, insert)| keyword(label, insert))),
        Place::Statement => {
            items.extend(STATEMENTS.iter().map(|(label, insert)| keyword(label, insert)));
            calls(parse, &mut items);
            conditions(parse, offset, &mut items);
        }
        Place::Condition => {
            items.push(keyword("not", "not($1)$0"));
            conditions(parse, offset, &mut items);
        }
        Place::Requirement => {
            items.push(keyword("not", "not($1)$0"));
            items.push(keyword("at start", "at start "));
            conditions(parse, offset, &mut items);
        }
        Place::Effect => {
            local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, &mut items);
            variables(parse, &[OutlineKind::State], &mut items);
        }
        Place::Value(variable) => {
            values(parse, variable, &mut items);
            local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, &mut items);
        }
        Place::Values(values) => {
            items.extend(values.iter().map(|value| plain(value, CompletionKind::Value)));
        }
        Place::Resource => {
            local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, &mut items);
            declared(parse, OutlineKind::Resource, CompletionKind::Variable, &mut items);
            declared(parse, OutlineKind::Vehicle, CompletionKind::Vehicle, &mut items);
        }
        Place::BehindDot(owner) => {
            items.push(keyword("at", "at"));
            items.push(keyword("mode", "mode"));
            equipment(parse, owner, &mut items);
        }
        Place::Group => declared(parse, OutlineKind::Group, CompletionKind::Vehicle, &mut items),
        Place::Member => {
            declared(parse, OutlineKind::Vehicle, CompletionKind::Vehicle, &mut items);
            declared(parse, OutlineKind::Group, CompletionKind::Vehicle, &mut items);
            declared(parse, OutlineKind::Location, CompletionKind::Location, &mut items);
        }
        Place::Kind => {
            let words = ["vehicle", "location", "number", "resource", "condition"];
            items.extend(words.map(|word| keyword(word, word)));
            models(parse, &mut items);
            declared(parse, OutlineKind::State, CompletionKind::Variable, &mut items);
        }
        Place::Amount => numbers(parse, offset, &mut items),
        Place::AmountOr(words) => {
            items.extend(words.iter().map(|word| keyword(word, word)));
            numbers(parse, offset, &mut items);
        }
        Place::Bound => {
            items.push(keyword("inf", "inf"));
            numbers(parse, offset, &mut items);
        }
        Place::Argument => {
            local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, &mut items);
            declared(parse, OutlineKind::Location, CompletionKind::Location, &mut items);
            declared(parse, OutlineKind::Vehicle, CompletionKind::Vehicle, &mut items);
            declared(parse, OutlineKind::Constant, CompletionKind::Constant, &mut items);
            declared(parse, OutlineKind::Variable, CompletionKind::Variable, &mut items);
            declared(parse, OutlineKind::State, CompletionKind::Variable, &mut items);
        }
        Place::Vehicle => {
            local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, &mut items);
            declared(parse, OutlineKind::Vehicle, CompletionKind::Vehicle, &mut items);
        }
        Place::Location => {
            local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, &mut items);
            declared(parse, OutlineKind::Location, CompletionKind::Location, &mut items);
        }
        Place::SetOfLocations => {
            items.push(keyword("visible", "visible($1)$0"));
            items.push(keyword("{ … }", "{$1}$0"));
        }
        Place::Model => models(parse, &mut items),
        Place::Option => {
            let options = [
                ("threat_gap", "threat_gap = 1;"),
                ("strict", "strict = 1;"),
                ("time_unit", "time_unit = second;"),
                ("control_step", "control_step = 1;"),
                ("controllability", "controllability = strong;"),
            ];
            items.extend(options.map(|(label, insert)| CompletionItem {
                kind: CompletionKind::Option,
                ..keyword(label, insert)
            }));
        }
        Place::OptionValue(option) => {
            let values: &[&str] = match option.as_str() {
                "time_unit" => &["minute", "second"],
                "strict" => &["0", "1"],
                "controllability" => &["dynamic", "strong", "none"],
                _ => &["1"],
            };
            items.extend(values.iter().map(|value| plain(value, CompletionKind::Option)));
        }
        Place::ClosedTo => {
            declared(parse, OutlineKind::Vehicle, CompletionKind::Vehicle, &mut items);
            models(parse, &mut items);
            declared(parse, OutlineKind::Primitive, CompletionKind::Primitive, &mut items);
        }
        Place::Shape => {
            items.push(keyword("circle", "circle ($0);"));
            items.push(keyword("polygon", "polygon ($0);"));
        }
        Place::Words(words) => {
            let template = |word| if word == CONTINGENT { "contingent [$1,$2]$0" } else { word };
            items.extend(words.iter().map(|word| keyword(word, template(word))));
        }
        Place::Occurrence => occurrences(parse, &mut items),
        Place::Nothing => {}
    }
    items
}

const DECLARATIONS: [(&str, &str); 17] = [
    ("model", "model $1 {\n  $2\n}$0"),
    ("group", "group $1 = $2;$0"),
    ("constrain", "constrain $1.start to $2.end [$3,$4];$0"),
    ("import", "import \"$1\";$0"),
    ("state", "state $1 : {$2} = $3;$0"),
    ("resource", "resource $1;$0"),
    ("objective", "objective $1;$0"),
    ("const", "const $1 = $2;$0"),
    ("var", "var $1 : {$2};$0"),
    ("primitive", "primitive $1($2)[$3,$4];$0"),
    ("scenario", "scenario $1 = {\n  $2\n}$0"),
    ("option", "option $1;$0"),
    ("terrain", "terrain \"$1\";$0"),
    ("location", "location $1 ($2, $3);$0"),
    ("obstacle", "obstacle $1 circle ($2, $3, $4);$0"),
    (KEEPOUT, "keepout $1 circle ($2, $3, $4);$0"),
    ("vehicle", "vehicle $1 : $2 at $3;$0"),
];

const STATEMENTS: [(&str, &str); 17] = [
    ("any", "any $1 in $2 $0"),
    ("each", "each $1 in $2 $0"),
    ("optional", "optional "),
    ("unordered", "unordered { $1 }$0"),
    ("do … using", "do { $1 } using $0"),
    ("repeat", "repeat $1 { $2 }$0"),
    ("free", "free "),
    ("if … thennext … else", "if $1 thennext $2 else $0"),
    ("choose", "choose { $1, $2 }$0"),
    ("do … maintaining", "do { $1 } maintaining $0"),
    ("do … watching", "do { $1 } watching $0"),
    ("if … thennext", "if $1 thennext $0"),
    ("delay", "delay[$1,$2]$0"),
    ("delay contingent", "delay contingent [$1,$2]$0"),
    ("tell", "tell "),
    ("ask", "ask "),
    ("not", "not($1)$0"),
];

fn keyword(label: &str, insert: &str) -> CompletionItem {
    CompletionItem {
        label: label.to_owned(),
        kind: CompletionKind::Keyword,
        detail: String::new(),
        insert: insert.to_owned(),
    }
}

fn plain(label: &str, kind: CompletionKind) -> CompletionItem {
    CompletionItem { kind, ..keyword(label, label) }
}

/// Activities and primitives, with parentheses and the cursor at their first argument.
fn calls(parse: &Parse, items: &mut Vec<CompletionItem>) {
    for OutlineItem { kind, name, detail, .. } in outline(parse) {
        let kind = match kind {
            OutlineKind::Primitive => CompletionKind::Primitive,
            OutlineKind::Activity => CompletionKind::Activity,
            _ => continue,
        };
        let parameters = detail.strip_prefix('(').and_then(|rest| rest.split(')').next()).unwrap_or_default();
        let count = parameters.split(',').filter(|parameter| !parameter.trim().is_empty()).count();
        let stops: Vec<String> = (1..=count).map(|at| format!("${at}")).collect();
        let end = if count == 0 { "" } else { "$0" };
        let insert = format!("{name}({}){end}", stops.join(", "));
        items.push(CompletionItem { label: name, kind, detail, insert });
    }
}

/// Names that represent numbers.
fn numbers(parse: &Parse, offset: u32, items: &mut Vec<CompletionItem>) {
    local_names(parse, offset, &NameKind::BoundName, CompletionKind::BoundName, items);
    local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, items);
    declared(parse, OutlineKind::Constant, CompletionKind::Constant, items);
}

/// Declared variables of these kinds, and the places of vehicles.
fn variables(parse: &Parse, kinds: &[OutlineKind], items: &mut Vec<CompletionItem>) {
    for OutlineItem { kind, name, detail, .. } in outline(parse) {
        let label = match kind {
            OutlineKind::Vehicle => format!("{name}.at"),
            kind if kinds.contains(&kind) => name,
            _ => continue,
        };
        let insert = format!("{label}=");
        let detail = detail.trim_start_matches([':', ' ']).to_owned();
        items.push(CompletionItem { label, kind: CompletionKind::Variable, detail, insert });
    }
}

/// Declared variables, parameters, and the conditions that the file speaks of.
fn conditions(parse: &Parse, offset: u32, items: &mut Vec<CompletionItem>) {
    local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, items);
    variables(parse, &[OutlineKind::Variable, OutlineKind::State], items);
    let mut known: FxHashSet<String> = items.iter().map(|item| item.label.clone()).collect();
    for (_, summary) in parse.summaries() {
        // A name alone may be the very word that is being typed.
        for literal in
            summary.literals.iter().filter(|literal| !literal.variable_is_formal && !literal.is_bare)
        {
            let name = parse.meaning().names.text(literal.variable);
            if known.insert(name.to_string()) {
                let insert = if literal.values.is_empty() { name.to_string() } else { format!("{name}=") };
                items.push(CompletionItem {
                    label: name.to_string(),
                    kind: CompletionKind::Variable,
                    detail: String::new(),
                    insert,
                });
            }
        }
    }
}

/// The domain of a variable; for an undeclared one, the values that the file compares it with.
fn values(parse: &Parse, variable: &str, items: &mut Vec<CompletionItem>) {
    let meaning = parse.meaning();
    if let Some((owner, part)) = variable.split_once('.').filter(|(_, part)| *part != "mode") {
        let states = models_of(parse, owner).into_iter().flat_map(|model| &model.equipment);
        let states = states.filter(|own| meaning.names.text(own.name) == part);
        let values = states.flat_map(|state| &state.values);
        items.extend(values.map(|value| plain(meaning.names.text(*value), CompletionKind::Value)));
        return;
    }
    let Some(symbol) = meaning.names.find(variable) else { return };
    if let Some(domain) = meaning.domain(symbol) {
        items.extend(domain.iter().map(|value| plain(meaning.names.text(*value), CompletionKind::Value)));
        return;
    }
    let mut known: FxHashSet<Symbol> = FxHashSet::default();
    for (_, summary) in parse.summaries() {
        let own = summary.literals.iter().filter(|literal| literal.variable == symbol);
        for (value, _) in own.flat_map(|literal| &literal.values) {
            let text = meaning.names.text(*value);
            if known.insert(*value) {
                items.push(plain(text, CompletionKind::Value));
            }
        }
    }
}

/// Declared and built-in vehicle models.
fn models(parse: &Parse, items: &mut Vec<CompletionItem>) {
    declared(parse, OutlineKind::Model, CompletionKind::Vehicle, items);
    items.extend(VEHICLE_MODELS.iter().map(|model| plain(model, CompletionKind::Vehicle)));
}

/// What a vehicle has of its own; what represents one may have what any model has.
fn equipment(parse: &Parse, owner: &str, items: &mut Vec<CompletionItem>) {
    let meaning = parse.meaning();
    let names = models_of(parse, owner).into_iter().flat_map(|model| &model.equipment);
    items.extend(names.map(|own| plain(meaning.names.text(own.name), CompletionKind::Variable)));
}

/// The declared models of a vehicle; of what represents one, all of them.
fn models_of<'a>(parse: &'a Parse, owner: &str) -> Vec<&'a Definition> {
    let meaning = parse.meaning();
    let vehicle =
        meaning.names.find(owner).and_then(|owner| meaning.index.definition(Namespace::Vehicle, owner));
    if let Some(vehicle) = vehicle {
        return vehicle.model.into_iter().flat_map(|model| meaning.index.lineage(model)).collect();
    }
    let models = meaning.index.defined(Namespace::Model).iter();
    models.filter_map(|&model| meaning.index.definition(Namespace::Model, model)).collect()
}

/// What `as` names.
fn occurrences(parse: &Parse, items: &mut Vec<CompletionItem>) {
    let meaning = parse.meaning();
    let mut names: Vec<&SmolStr> =
        meaning.index.defined(Namespace::Occurrence).iter().map(|&name| meaning.names.text(name)).collect();
    names.sort_unstable();
    items.extend(names.into_iter().map(|name| plain(name, CompletionKind::Value)));
}

fn local_names(
    parse: &Parse,
    offset: u32,
    wanted: &NameKind,
    kind: CompletionKind,
    items: &mut Vec<CompletionItem>,
) {
    let root = declaration_at_cursor(parse, offset);
    let names = root.map(|root| names_in(parse, root)).unwrap_or_default();
    let defined = names.into_iter().filter(|name| name.is_definition && name.kind == *wanted);
    items.extend(defined.map(|name| plain(&name.text, kind)));
}

fn declared(parse: &Parse, wanted: OutlineKind, kind: CompletionKind, items: &mut Vec<CompletionItem>) {
    let found = outline(parse).into_iter().filter(|item| item.kind == wanted);
    items.extend(found.map(|item| CompletionItem { detail: item.detail, ..plain(&item.name, kind) }));
}
