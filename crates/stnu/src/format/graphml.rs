//! The `GraphML` of the CSTNU Tool (Posenato), as far as it holds STNs and STNUs.
//!
//! Nodes are time points. Edges have the data `Type` (`requirement`, `contingent`, or `derived`, which is left out),
//! `Value` (the weight) and `LabeledValue`: `LC(C):x` from a link's activation to its end C, `UC(C):-y` back. The
//! labeled values of conditional networks are read where their labels are empty. A contingent pair with values only has
//! its upper bound on the way to the end and its negated lower one on the way back.

use std::collections::BTreeMap;

use exact::{Bound, Time};
use markup::escaped;
use roxmltree::{Document as Xml, Node};

use super::{Document, Draft, DraftEdge, DraftLink, ParseError};
use crate::network::{Link, PointId};

/// What the two edges of a contingent link say, from the activation's or the end's side.
#[derive(Default)]
struct Pair {
    line: usize,
    lower: Option<Time>,
    upper: Option<Time>,
    value: Option<Bound>,
}

/// The value of one edge.
enum Value {
    Ordinary(Bound),
    LowerCase(Time),
    UpperCase(Time),
}

pub(super) fn parse(text: &str) -> Result<Document, ParseError> {
    let xml = Xml::parse(text).map_err(|error| {
        ParseError::new(error.pos().row as usize, format!("not well-formed XML: {error}"))
    })?;
    let graph = xml.descendants().find(|node| node.is_named("graph"));
    let graph = graph.ok_or_else(|| ParseError::new(1, "expected a `graph` element"))?;
    let keys: BTreeMap<&str, &str> = xml
        .descendants()
        .filter(|node| node.is_named("key"))
        .filter_map(|key| Some((key.attribute("id")?, key.attribute("attr.name").or(key.attribute("id"))?)))
        .collect();
    let reader = Reader { xml: &xml, keys };
    if let Some(kind) = reader.data(graph, "NetworkType")
        && !["STN", "STNU", "CSTN", "CSTNU"].contains(&kind)
    {
        return Err(reader.error(graph, format!("networks of type {kind} are not supported")));
    }
    let mut draft = Draft::default();
    let mut by_name = BTreeMap::new();
    for node in graph.children().filter(|node| node.is_named("node")) {
        let name = reader.attribute(node, "id")?;
        reader.refuse_conditions(node)?;
        let point = PointId(draft.names.len() as u32);
        if by_name.insert(name, point).is_some() {
            return Err(reader.error(node, format!("duplicate name {name}")));
        }
        draft.names.push(name.to_owned());
    }
    let mut pairs: BTreeMap<(PointId, PointId), Pair> = BTreeMap::new();
    for edge in graph.children().filter(|node| node.is_named("edge")) {
        let end = |name: &str| -> Result<PointId, ParseError> {
            let name = reader.attribute(edge, name)?;
            let unknown = || reader.error(edge, format!("{name} is not a time point"));
            by_name.get(name).copied().ok_or_else(unknown)
        };
        let (from, to) = (end("source")?, end("target")?);
        let kind = reader.data(edge, "Type").unwrap_or("requirement");
        if kind == "derived" {
            continue;
        }
        let line = reader.line(edge);
        for value in reader.values(edge)? {
            match value {
                Value::LowerCase(lower) => {
                    let pair = pairs.entry((from, to)).or_default();
                    (pair.line, pair.lower) = (line, Some(lower));
                }
                Value::UpperCase(weight) => {
                    let pair = pairs.entry((to, from)).or_default();
                    (pair.line, pair.upper) = (line, weight.checked_neg());
                }
                Value::Ordinary(weight) if kind == "contingent" => {
                    let pair = pairs.entry((from, to)).or_default();
                    (pair.line, pair.value) = (line, Some(weight));
                }
                Value::Ordinary(weight) => {
                    draft.edges.push(DraftEdge { line, from, to, weight });
                }
            }
        }
    }
    add_links(&mut draft, &pairs)?;
    draft.finish()
}

/// Makes links of the pairs, and ordinary constraints of the values of a link that has its cases as well.
fn add_links(draft: &mut Draft, pairs: &BTreeMap<(PointId, PointId), Pair>) -> Result<(), ParseError> {
    for (&(from, to), pair) in pairs {
        let back = pairs.get(&(to, from));
        let back_value = back.and_then(|back| back.value);
        let is_back_labeled = back.is_some_and(|back| back.lower.is_some() || back.upper.is_some());
        let is_labeled = pair.lower.is_some() || pair.upper.is_some();
        let (lower, upper) = match (pair.lower, pair.upper) {
            (Some(lower), Some(upper)) => (lower, upper),
            // With values only, the positive one leads to the end.
            (None, None) => {
                if is_back_labeled {
                    if let Some(weight) = pair.value {
                        draft.edges.push(DraftEdge { line: pair.line, from, to, weight });
                    }
                    continue;
                }
                let finite = |value: Option<Bound>| value.and_then(Bound::finite);
                match (finite(pair.value), finite(back_value)) {
                    (Some(upper), Some(weight)) if weight <= Time::ZERO && upper >= Time::ZERO => {
                        // Two zeros are one link of no length.
                        if upper == Time::ZERO && weight == Time::ZERO && from > to {
                            continue;
                        }
                        let Some(lower) = weight.checked_neg() else {
                            return Err(incomplete(draft, from, to, pair.line));
                        };
                        (lower, upper)
                    }
                    (Some(weight), Some(upper)) if weight <= Time::ZERO && upper >= Time::ZERO => continue,
                    _ => return Err(incomplete(draft, from, to, pair.line)),
                }
            }
            _ => return Err(incomplete(draft, from, to, pair.line)),
        };
        if is_labeled && let Some(weight) = pair.value {
            draft.edges.push(DraftEdge { line: pair.line, from, to, weight });
        }
        draft.links.push(DraftLink { line: pair.line, activation: from, end: to, lower, upper });
    }
    Ok(())
}

fn incomplete(draft: &Draft, from: PointId, to: PointId, line: usize) -> ParseError {
    let (from, to) = (&draft.names[from.index()], &draft.names[to.index()]);
    ParseError::new(
        line,
        format!("the contingent link between {from} and {to} needs a minimum and a maximum"),
    )
}

/// Elements by their local names: files differ in whether they declare the namespace.
trait LocalName {
    fn is_named(&self, name: &str) -> bool;
}

impl LocalName for Node<'_, '_> {
    fn is_named(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

struct Reader<'a, 'input> {
    xml: &'a Xml<'input>,
    /// The names of data by the keys that the file gives them.
    keys: BTreeMap<&'a str, &'a str>,
}

impl<'a, 'input> Reader<'a, 'input> {
    fn line(&self, node: Node<'a, 'input>) -> usize {
        self.xml.text_pos_at(node.range().start).row as usize
    }

    fn error(&self, node: Node<'a, 'input>, message: impl Into<String>) -> ParseError {
        ParseError::new(self.line(node), message)
    }

    fn attribute(&self, node: Node<'a, 'input>, name: &str) -> Result<&'a str, ParseError> {
        node.attribute(name).ok_or_else(|| {
            self.error(node, format!("expected `{name}` of the element `{}`", node.tag_name().name()))
        })
    }

    /// Returns what an element says under a name; `None` where it says nothing.
    fn data(&self, node: Node<'a, 'input>, name: &str) -> Option<&'a str> {
        node.children()
            .filter(|child| child.is_named("data"))
            .find(|data| {
                let key = data.attribute("key").unwrap_or_default();
                self.keys.get(key).copied().unwrap_or(key) == name
            })
            .and_then(|data| data.text())
            .map(str::trim)
            .filter(|text| !text.is_empty() && *text != "{}")
    }

    fn refuse_conditions(&self, node: Node<'a, 'input>) -> Result<(), ParseError> {
        let name = node.attribute("id").unwrap_or_default();
        if let Some(proposition) = self.data(node, "Obs") {
            return Err(self.conditional(node, &format!("{name} observes {proposition}")));
        }
        match self.data(node, "Label").filter(|label| *label != "⊡") {
            Some(label) => {
                Err(self.conditional(node, &format!("{name} exists only under the condition {label}")))
            }
            None => Ok(()),
        }
    }

    /// Returns what makes the file a conditional network.
    fn conditional(&self, node: Node<'a, 'input>, what: &str) -> ParseError {
        let message = format!(
            "{what}, so this is a conditional network (CSTN or CSTNU), which is not supported; only STN and STNU are"
        );
        self.error(node, message)
    }

    fn time(&self, node: Node<'a, 'input>, text: &str) -> Result<Time, ParseError> {
        super::time(self.line(node), text)
    }

    fn weight(&self, node: Node<'a, 'input>, text: &str) -> Result<Bound, ParseError> {
        super::weight(self.line(node), text)
    }

    fn values(&self, edge: Node<'a, 'input>) -> Result<Vec<Value>, ParseError> {
        let mut values = Vec::new();
        if let Some(text) = self.data(edge, "Value") {
            values.push(Value::Ordinary(self.weight(edge, text)?));
        }
        if let Some(text) = self.data(edge, "LabeledValue") {
            let (case, number) = text
                .split_once("):")
                .ok_or_else(|| self.error(edge, format!("expected LC(…):… or UC(…):…, not {text}")))?;
            let number = self.time(edge, number)?;
            match case.split_once('(').map(|(case, _)| case.trim()) {
                Some("LC") => values.push(Value::LowerCase(number)),
                Some("UC") => values.push(Value::UpperCase(number)),
                _ => return Err(self.error(edge, format!("expected LC(…):… or UC(…):…, not {text}"))),
            }
        }
        for [number] in self.tuples(edge, "LabeledValues")? {
            values.push(Value::Ordinary(self.weight(edge, number)?));
        }
        for [_, number] in self.tuples(edge, "LowerCaseLabeledValues")? {
            values.push(Value::LowerCase(self.time(edge, number)?));
        }
        for [_, number] in self.tuples(edge, "UpperCaseLabeledValues")? {
            values.push(Value::UpperCase(self.time(edge, number)?));
        }
        Ok(values)
    }

    /// The tuples of `{(…, label) (…, label)}` without their labels, which must be empty.
    fn tuples<const N: usize>(
        &self,
        edge: Node<'a, 'input>,
        name: &str,
    ) -> Result<Vec<[&'a str; N]>, ParseError> {
        let Some(text) = self.data(edge, name) else { return Ok(Vec::new()) };
        let mut tuples = Vec::new();
        for tuple in text.split('(').skip(1) {
            let tuple = tuple.split(')').next().unwrap_or_default();
            let mut words: Vec<&str> = tuple.split(',').map(str::trim).collect();
            let label = words.pop().unwrap_or_default();
            if !label.is_empty() && label != "⊡" {
                let what = format!("a value of the edge holds only under the condition {label}");
                return Err(self.conditional(edge, &what));
            }
            let words = words.try_into();
            tuples.push(words.map_err(|_| self.error(edge, format!("{name} are not as expected: {text}")))?);
        }
        Ok(tuples)
    }
}

pub(super) fn write(document: &Document) -> String {
    let Document { names, network, .. } = document;
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <graphml xmlns=\"http://graphml.graphdrawing.org/xmlns/graphml\">\n\
         <key id=\"NetworkType\" for=\"graph\"/>\n<key id=\"Type\" for=\"edge\"/>\n\
         <key id=\"Value\" for=\"edge\"/>\n<key id=\"LabeledValue\" for=\"edge\"/>\n\
         <graph edgedefault=\"directed\">\n<data key=\"NetworkType\">STNU</data>\n",
    );
    for name in names {
        text.push_str(&format!("<node id=\"{}\"/>\n", escaped(name)));
    }
    let mut number = 0;
    let mut edge = |from: PointId, to: PointId, kind: &str, key: &str, value: &str| {
        number += 1;
        format!(
            "<edge id=\"e{number}\" source=\"{}\" target=\"{}\"><data key=\"Type\">{kind}</data>\
             <data key=\"{key}\">{}</data></edge>\n",
            escaped(document.name(from)),
            escaped(document.name(to)),
            escaped(value),
        )
    };
    for Link { activation, end, lower, upper } in network.links() {
        let name = document.name(*end);
        let (lower, upper) = (document.time(*lower), document.time(*upper));
        text.push_str(&edge(*activation, *end, "contingent", "LabeledValue", &format!("LC({name}):{lower}")));
        text.push_str(&edge(
            *end,
            *activation,
            "contingent",
            "LabeledValue",
            &format!("UC({name}):-{upper}"),
        ));
    }
    for ordinary in network.edges() {
        let weight = document.time(ordinary.weight).to_string();
        text.push_str(&edge(ordinary.from, ordinary.to, "requirement", "Value", &weight));
    }
    text.push_str("</graph>\n</graphml>\n");
    text
}
