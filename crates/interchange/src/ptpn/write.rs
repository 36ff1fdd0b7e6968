//! From a network to the XML.

use std::fmt::Write as _;

use exact::Bound;
use markup::escaped;
use rmpl::program::LabelMode;

use super::guard::{Guard, TooManyTerms};
use super::{NAMESPACE, PtpnError};
use tpn::network::{Arc, ArcKind, Network, NodeId};

/// The network as `RMPyL` writes one: primitives and assertions as episodes, all other arcs as temporal constraints, and each
/// decision as a decision variable whose values are the numbers of its alternatives from 1. Conditions that are asked of one
/// value are state constraints. What has no place there is told in a comment: what is told, state variables, resources,
/// wishes and objectives.
///
/// # Errors
/// When what selects an event are too many ways to write.
pub fn write(network: &Network) -> Result<String, PtpnError> {
    let guards = guards(network)?;
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    for said in left_out(network) {
        let _ = writeln!(out, "<!-- Not written: {said}. -->");
    }
    let _ = writeln!(
        out,
        "<tpns xmlns=\"{NAMESPACE}\">\n\t<tpn>\n\t\t<id>network</id>\n\t\t<name>network</name>"
    );
    let _ = writeln!(out, "\t\t<features/>\n\t\t<start-event>{}</start-event>", event(network.start));
    let _ = writeln!(out, "\t\t<end-event>{}</end-event>\n\t\t<events>", event(network.end));
    for (index, guard) in guards.iter().enumerate() {
        let id = event(NodeId::from_index(index));
        let _ =
            writeln!(out, "\t\t\t<event><id>{id}</id><name>{id}</name>{}</event>", written(guard, network));
    }
    out.push_str("\t\t</events>\n");
    for (list, item, is_episode) in
        [("temporal-constraints", "temporal-constraint", false), ("episodes", "episode", true)]
    {
        let _ = writeln!(out, "\t\t<{list}>");
        for (index, arc) in network.arcs.iter().enumerate().filter(|(_, arc)| is_act(arc) == is_episode) {
            let guard = guard_of(arc, &guards)?.simplified(&value_counts(network));
            let name = match arc.occurrence.filter(|_| is_episode) {
                Some(id) => network.occurrences[id.index()].name.to_string(),
                None => format!("A{index}"),
            };
            let _ = write!(out, "\t\t\t<{item}><id>A{index}</id><name>{}</name>", escaped(&name));
            let (from, to) = (event(arc.from), event(arc.to));
            let _ = write!(out, "{}<to-event>{to}</to-event>", written(&guard, network));
            let _ = write!(out, "<from-event>{from}</from-event>{}", duration(arc));
            if is_episode {
                let _ = write!(
                    out,
                    "<dispatch>{}</dispatch>{}",
                    escaped(&call(network, arc)),
                    conditions(network, arc)
                );
            }
            let _ = writeln!(out, "</{item}>");
        }
        let _ = writeln!(out, "\t\t</{list}>");
    }
    out.push_str("\t\t<chance-constraints/>\n\t\t<decision-variables>\n");
    for decision in &network.decisions {
        let id = event(decision.node);
        let guard = written(&guards[decision.node.index()], network);
        let _ = write!(out, "\t\t\t<decision-variable><id>{id}C</id><name>{id}C</name>{guard}");
        let _ = write!(out, "<type>controllable</type><at-event>{id}</at-event><domain>");
        for value in 1..=decision.alternatives.len() {
            let _ = write!(out, "<domainval><value>{value}</value></domainval>");
        }
        out.push_str("</domain></decision-variable>\n");
    }
    out.push_str(
        "\t\t</decision-variables>\n\t\t<state-variables/>\n\t\t<initial-state/>\n\t</tpn>\n</tpns>\n",
    );
    Ok(out)
}

/// Returns whether an arc is an episode.
fn is_act(arc: &Arc) -> bool {
    matches!(arc.kind, ArcKind::Activity | ArcKind::Assertion | ArcKind::Delay | ArcKind::Path)
}

fn value_counts(network: &Network) -> Vec<u32> {
    network.decisions.iter().map(|decision| decision.alternatives.len() as u32).collect()
}

/// Under which choices each event is part of a plan: any of the arcs that lead there.
fn guards(network: &Network) -> Result<Vec<Guard>, PtpnError> {
    let counts = value_counts(network);
    let many = |node: NodeId| PtpnError::TooManyTerms { place: format!("event `{}`", event(node)) };
    let mut guards = vec![Guard::never(); network.nodes.len()];
    let mut awaited: Vec<usize> = network.nodes.iter().map(|node| node.in_arcs.len()).collect();
    let leads = |kind: ArcKind| !matches!(kind, ArcKind::Span | ArcKind::Composite | ArcKind::Constraint);
    guards[network.start.index()] = Guard::always();
    let mut ready: Vec<NodeId> =
        (0..awaited.len()).filter(|&node| awaited[node] == 0).map(NodeId::from_index).collect();
    while let Some(node) = ready.pop() {
        for id in &network.nodes[node.index()].out_arcs {
            let arc = &network.arcs[id.index()];
            let to = arc.to.index();
            if leads(arc.kind) {
                let way = guard_of(arc, &guards)?;
                let before = std::mem::replace(&mut guards[to], Guard::never());
                guards[to] = before.or(&way).map_err(|_: TooManyTerms| many(arc.to))?.simplified(&counts);
            }
            awaited[to] = awaited[to].saturating_sub(1);
            if awaited[to] == 0 {
                ready.push(arc.to);
            }
        }
    }
    Ok(guards)
}

fn guard_of(arc: &Arc, guards: &[Guard]) -> Result<Guard, PtpnError> {
    let from = &guards[arc.from.index()];
    let narrower = match (arc.kind, arc.choice) {
        (_, Some((decision, alternative))) => from.and(&Guard::equals(decision.index() as u32, alternative)),
        (ArcKind::Constraint | ArcKind::Span | ArcKind::Composite, None) => from.and(&guards[arc.to.index()]),
        _ => Ok(from.clone()),
    };
    narrower.map_err(|_: TooManyTerms| PtpnError::TooManyTerms {
        place: format!("the arc from {}", event(arc.from)),
    })
}

fn written(guard: &Guard, network: &Network) -> String {
    if guard.is_always() {
        return "<guard><boolean-constant>true</boolean-constant></guard>".to_owned();
    }
    let mut out = String::from("<guard><or>");
    for term in guard.terms() {
        out.push_str("<guard><and>");
        for (&decision, &value) in term {
            let id = event(network.decisions[decision as usize].node);
            let _ = write!(
                out,
                "<guard><decision-variable-equals><variable>{id}C</variable><value>{}</value></decision-variable-equals></guard>",
                value + 1
            );
        }
        out.push_str("</and></guard>");
    }
    out.push_str("</or></guard>");
    out
}

fn duration(arc: &Arc) -> String {
    let kind = if arc.is_contingent { "set-bounded-uncertain-duration" } else { "bounded-duration" };
    let upper = match arc.upper {
        Bound::Finite(upper) => upper.to_string(),
        Bound::Infinite => "INF".to_owned(),
    };
    let bounds = format!("<lower-bound>{}</lower-bound><upper-bound>{upper}</upper-bound>", arc.lower);
    format!("<duration><{kind}>{bounds}</{kind}></duration>")
}

fn call(network: &Network, arc: &Arc) -> String {
    let Some(id) = arc.occurrence else { return String::new() };
    let occurrence = &network.occurrences[id.index()];
    if occurrence.arguments.is_empty() {
        return occurrence.activity.to_string();
    }
    let arguments: Vec<&str> = occurrence.arguments.iter().map(smol_str::SmolStr::as_str).collect();
    format!("{}({})", occurrence.activity, arguments.join(", "))
}

/// Returns what an episode asks, each of one value.
fn conditions(network: &Network, arc: &Arc) -> String {
    let asked =
        arc.labels.iter().map(|id| &network.labels[id.index()]).filter(|label| label.mode == LabelMode::Ask);
    let asked: Vec<(&str, &str)> = asked.filter_map(|label| simple(&label.text)).collect();
    if asked.is_empty() {
        return "<state-constraint><wff><boolean-constant>true</boolean-constant></wff></state-constraint>"
            .to_owned();
    }
    let mut out = String::from("<state-constraint><wff><and>");
    for (variable, value) in asked {
        let _ = write!(
            out,
            "<wff><boolean-expression><condition>{}=</condition><value><constant>{}</constant></value></boolean-expression></wff>",
            escaped(variable),
            escaped(value)
        );
    }
    out.push_str("</and></wff></state-constraint>");
    out
}

/// `X=V`, and nothing else that a condition can be.
fn simple(text: &str) -> Option<(&str, &str)> {
    let (variable, value) = text.split_once('=')?;
    let is_plain = |part: &str| !part.is_empty() && !part.contains(['!', '=', '<', '>', '{', ' ']);
    (is_plain(variable) && is_plain(value)).then_some((variable, value))
}

fn left_out(network: &Network) -> Vec<String> {
    let is_written = |label: &&tpn::network::Label| {
        label.mode == LabelMode::Ask
            && is_act(&network.arcs[label.arc.index()])
            && simple(&label.text).is_some()
    };
    let counted = [
        (
            network.labels.iter().filter(|label| !is_written(label)).count(),
            "conditions that are assertions, span blocks, or have several values",
        ),
        (network.uses.len(), "uses of resources"),
        (network.worths.len(), "costs or rewards"),
        (network.objective.len(), "objectives"),
        (network.departures.len() + network.distances.len(), "paths"),
    ];
    counted
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("{count} {what}"))
        .collect()
}

fn event(node: NodeId) -> String {
    format!("E{}", node.index())
}
