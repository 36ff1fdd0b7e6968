//! `enroute hca`: compiles a control program to its automaton.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::ValueEnum;
use hca::{Automaton, Element, Vocabulary};
use serde_json::{Value, json};
use snapshot::Problem;

use crate::diagnostics::print_problems;
use crate::input::read_control;
use crate::output::{Format, WRONG, YES, any_error, document, exit, print_json, print_text, print_verbatim};

/// Compile a control program to a hierarchical constraint automaton (HCA).
#[derive(clap::Args)]
pub struct Args {
    /// Control program; - reads standard input.
    file: PathBuf,
    /// Notation [default: text, or json with --format json].
    #[arg(long = "as", value_enum, value_name = "NOTATION")]
    form: Option<Form>,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// The forms of an automaton.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Form {
    /// Locations, transitions and composites.
    Json,
    /// Human-readable listing.
    Text,
    /// Graphviz.
    Dot,
    /// SVG drawing.
    Svg,
}

/// Runs the command.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let source = read_control(&args.file, "use `enroute tpn`")?;
    let compilation = hca::compile_text(&source, &Vocabulary::default());
    let problems = Problem::all(&compilation.diagnostics, &source);
    let form = args.form.unwrap_or(if args.format == Format::Json { Form::Json } else { Form::Text });
    if form != Form::Json {
        print_problems(&args.file.display().to_string(), &source, &problems)?;
    }
    match &compilation.automaton {
        Some(automaton) => match form {
            Form::Json => print_json(&document("hca", &problems, automaton_json(automaton)))?,
            Form::Text => print_text(&automaton_text(automaton))?,
            Form::Dot => print_verbatim(&hca::dot::dot(automaton))?,
            Form::Svg => print_verbatim(&drawing(automaton))?,
        },
        None if form == Form::Json => print_json(&document("hca", &problems, json!({})))?,
        None => {}
    }
    Ok(exit(if any_error(&problems) || compilation.automaton.is_none() { WRONG } else { YES }))
}

fn drawing(automaton: &Automaton) -> String {
    let drawing = layout::automaton(automaton, &display::approximate_text_width);
    let list = layout::automaton_list(&drawing, automaton, &layout::AutomatonState::default());
    display::svg(&[&list], display::Theme::Light, "Control program")
}

fn element_name(automaton: &Automaton, element: Element) -> String {
    match element {
        Element::Location(location) => automaton.location_name(location),
        Element::Composite(composite) => format!("c{}", composite.0),
    }
}

fn automaton_json(automaton: &Automaton) -> Value {
    let start = automaton.start();
    let guard =
        |test: Option<hca::TestId>| test.and_then(|test| automaton.guard(test)).map(ToString::to_string);
    // With the steps that it takes.
    let clock = |id: Option<hca::ClockId>| {
        let clock = id.and_then(|id| automaton.clock(id))?;
        Some(json!({ "label": clock.label, "steps": clock.steps }))
    };
    let locations: Vec<Value> = automaton
        .locations
        .iter()
        .enumerate()
        .map(|(at, location)| {
            let id = hca::LocationId(at as u32);
            json!({
                "id": automaton.location_name(id),
                "kind": location.kind,
                "label": location.label,
                "goals": location.assertion.as_ref().map(|assertion| assertion.goals.clone()).unwrap_or_default(),
                "start": start.contains(id),
                "clock": clock(location.clock),
                "parent": format!("c{}", location.parent.0),
                "span": { "start": location.span.start, "end": location.span.end },
            })
        })
        .collect();
    let transitions: Vec<Value> = automaton
        .transitions
        .iter()
        .map(|transition| {
            json!({
                "from": automaton.location_name(transition.source),
                "to": element_name(automaton, transition.target),
                "guard": automaton.condition_text(transition),
            })
        })
        .collect();
    let composites: Vec<Value> = automaton
        .composites
        .iter()
        .enumerate()
        .map(|(at, composite)| {
            json!({
                "id": format!("c{at}"),
                "kind": composite.kind,
                "parent": composite.parent.map(|parent| format!("c{}", parent.0)),
                "children": composite.children.iter().map(|&child| element_name(automaton, child)).collect::<Vec<_>>(),
                "start": composite.start.iter().map(|id| automaton.location_name(*id)).collect::<Vec<_>>(),
                "maintenance": guard(composite.maintenance),
                "clock": clock(composite.clock),
                "span": { "start": composite.span.start, "end": composite.span.end },
            })
        })
        .collect();
    json!({ "locations": locations, "transitions": transitions, "composites": composites })
}

fn automaton_text(automaton: &Automaton) -> String {
    let mut out = String::new();
    tree(automaton, Element::Composite(Automaton::ROOT), 0, &mut out);
    out
}

fn tree(automaton: &Automaton, element: Element, depth: usize, out: &mut String) {
    let indent = "  ".repeat(depth);
    match element {
        Element::Location(id) => {
            let Some(location) = automaton.location(id) else { return };
            let mark = if automaton.start().contains(id) { " (start)" } else { "" };
            out.push_str(&format!("{indent}{}: {}{mark}\n", automaton.location_name(id), location.label));
            for at in location.transitions.clone() {
                let Some(transition) = automaton.transitions.get(at as usize) else { continue };
                let guard = automaton.condition_text(transition);
                let targets: Vec<String> = automaton
                    .start_of(&transition.target)
                    .iter()
                    .map(|id| automaton.location_name(*id))
                    .collect();
                out.push_str(&format!("{indent}  -- {guard} --> {}\n", targets.join(" ")));
            }
        }
        Element::Composite(id) => {
            let Some(composite) = automaton.composite(id) else { return };
            let kind = match composite.kind {
                hca::CompositeKind::Parallel => Some("parallel".to_owned()),
                hca::CompositeKind::Sequence => Some("sequence".to_owned()),
                hca::CompositeKind::DoWatching => composite
                    .maintenance
                    .and_then(|test| automaton.guard(test))
                    .map(|guard| format!("while {guard}")),
                hca::CompositeKind::Timeout | hca::CompositeKind::Lock | hca::CompositeKind::Choice => {
                    automaton.title(id).map(|title| title.to_string())
                }
                hca::CompositeKind::Program | hca::CompositeKind::Guarded => None,
            };
            let inner = depth + usize::from(kind.is_some());
            if let Some(kind) = kind {
                out.push_str(&format!("{indent}{kind}\n"));
            }
            for &child in &composite.children {
                tree(automaton, child, inner, out);
            }
        }
    }
}
