//! The automaton as a Graphviz description: composites as clusters, guards on edges.

use std::fmt::Write as _;

use markup::graphviz_string;

use crate::automaton::{Automaton, CompositeId, CompositeKind, Element, LocationId};

/// The automaton in the DOT language; a start location has a double border.
pub fn dot(automaton: &Automaton) -> String {
    let mut out = String::from("digraph automaton {\n  compound=true;\n  node [shape=box, style=rounded];\n");
    composite(automaton, Automaton::ROOT, 1, &mut out);
    for transition in &automaton.transitions {
        let label = automaton.condition_text(transition);
        for target in automaton.start_of(&transition.target).iter().take(1) {
            let head = match transition.target {
                Element::Composite(composite) if drawn(automaton, composite) => {
                    format!(", lhead=cluster_{}", composite.0)
                }
                _ => String::new(),
            };
            let source = automaton.location_name(transition.source);
            let _ = writeln!(
                out,
                "  {source} -> {} [label={}{head}];",
                automaton.location_name(*target),
                graphviz_string(&label)
            );
        }
    }
    out.push_str("}\n");
    out
}

/// Composites that say something: sequences, and those with a maintenance condition or a clock.
fn drawn(automaton: &Automaton, id: CompositeId) -> bool {
    automaton.composite(id).is_some_and(|composite| {
        composite.maintenance.is_some()
            || matches!(
                composite.kind,
                CompositeKind::Sequence | CompositeKind::Parallel | CompositeKind::Timeout
            )
    })
}

fn composite(automaton: &Automaton, id: CompositeId, depth: usize, out: &mut String) {
    let Some(data) = automaton.composite(id) else { return };
    let indent = "  ".repeat(depth);
    let is_drawn = drawn(automaton, id);
    if is_drawn {
        let label = match (data.maintenance.and_then(|test| automaton.guard(test)), data.kind) {
            (Some(guard), _) => format!("maintain {guard}"),
            (None, CompositeKind::Sequence) => "sequence".into(),
            _ => automaton.title(id).map_or(String::new(), |title| title.to_string()),
        };
        let _ = writeln!(
            out,
            "{indent}subgraph cluster_{} {{\n{indent}  label={};",
            id.0,
            graphviz_string(&label)
        );
    }
    for child in &data.children {
        match child {
            Element::Composite(inner) => composite(automaton, *inner, depth + 1, out),
            Element::Location(location) => node(automaton, *location, depth + 1, out),
        }
    }
    if is_drawn {
        let _ = writeln!(out, "{indent}}}");
    }
}

fn node(automaton: &Automaton, id: LocationId, depth: usize, out: &mut String) {
    let Some(location) = automaton.location(id) else { return };
    let borders = if automaton.start().contains(id) { 2 } else { 1 };
    let name = automaton.location_name(id);
    let indent = "  ".repeat(depth);
    let _ = writeln!(
        out,
        "{indent}{name} [label={}, peripheries={borders}];",
        graphviz_string(&format!("{name}: {}", location.label))
    );
}
