//! From the XML to objects of plan-schema, and to their network.

use std::collections::{BTreeMap, BTreeSet};

use exact::{Bound, Time};
use roxmltree::{Document as Xml, Node};
use serde_json::{Map, Value, json};

use super::PtpnError;
use super::guard::{Guard, TooManyTerms};
use crate::plan_schema::{BETWEEN_THREADS, Document};

/// How deep guards may nest.
const MAX_GUARD_DEPTH: u32 = 64;

/// Beyond so many constraints none is looked at for whether others lead the same way.
const MAX_TRANSITIVE: usize = 2_000;

/// The network of a file. Times are in minutes, the unit of networks that do not name one.
///
/// An episode is an activity. A temporal constraint is a way to its event where no other leads there, and otherwise a bound
/// between two events. A decision variable is a choice right after its event.
pub fn read(text: &str) -> Result<Document, PtpnError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let xml = Xml::parse(text).map_err(|error| PtpnError::Xml(error.to_string()))?;
    let root = xml.root_element();
    let networks: Vec<Node> = match root.tag_name().name() {
        "tpns" => children(root, "tpn").collect(),
        "tpn" | "ptpn" => vec![root],
        other => return Err(PtpnError::Shape(format!("`{other}` is not an element of a pTPN"))),
    };
    match networks.as_slice() {
        [network] => Reader::new(*network)?.document(*network),
        networks => {
            Err(PtpnError::Shape(format!("the file has {} networks, but needs exactly one", networks.len())))
        }
    }
}

/// A decision variable.
struct Decision {
    id: String,
    event: String,
    values: Vec<String>,
    utilities: Vec<Option<f64>>,
    /// How likely each value is, where the file says it: `foundC: yes 0.3, no 0.7`.
    probability: Option<String>,
    is_controllable: bool,
}

/// A temporal constraint or an episode.
struct Edge<'xml> {
    id: String,
    from: String,
    to: String,
    guard: Guard,
    object: Map<String, Value>,
    bounds: (Time, Bound),
    xml: Node<'xml, 'xml>,
    is_episode: bool,
}

/// What an edge is among the arcs.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// An arc from its event.
    Arc,
    /// An arc of one alternative of a choice at its event: the decision and the value.
    Alternative(usize, u32),
    /// A bound between two events that are reached otherwise.
    Bound,
    /// A bound where both events are part of the plan.
    BetweenThreads,
}

struct Reader {
    decisions: Vec<Decision>,
    value_counts: Vec<u32>,
    by_id: BTreeMap<String, u32>,
    objects: Map<String, Value>,
}

impl Reader {
    fn new(network: Node<'_, '_>) -> Result<Self, PtpnError> {
        let mut reader = Self {
            decisions: Vec::new(),
            value_counts: Vec::new(),
            by_id: BTreeMap::new(),
            objects: Map::new(),
        };
        for decision in listed(network, "decision-variables", "decision-variable") {
            let id = text_of(decision, "id")?;
            let domain = children(decision, "domain").flat_map(|domain| children(domain, "domainval"));
            let domain: Vec<Node> = domain.collect();
            let values =
                domain.iter().map(|value| text_of(*value, "value")).collect::<Result<Vec<_>, _>>()?;
            if values.iter().collect::<BTreeSet<_>>().len() != values.len() || values.is_empty() {
                return Err(PtpnError::Shape(format!("`{id}` needs values that are all different")));
            }
            let number = |value: &Node, key: &'static str| {
                text_of(*value, key).ok().and_then(|text| text.parse().ok())
            };
            let kind = text_of(decision, "type").unwrap_or_default();
            let number_of_it = reader.decisions.len() as u32;
            if reader.by_id.insert(id.clone(), number_of_it).is_some() {
                return Err(PtpnError::Shape(format!("duplicate decision variable `{id}`")));
            }
            reader.value_counts.push(values.len() as u32);
            reader.decisions.push(Decision {
                event: text_of(decision, "at-event")?,
                utilities: domain.iter().map(|value| number(value, "utility")).collect(),
                probability: probability(decision, &id, &domain),
                is_controllable: kind.is_empty() || kind == "controllable",
                id,
                values,
            });
        }
        Ok(reader)
    }

    fn document(mut self, network: Node<'_, '_>) -> Result<Document, PtpnError> {
        let start = text_of(network, "start-event")?;
        let mut header = json!({ "tpn-type": "network", "begin-node": start });
        if let Ok(end) = text_of(network, "end-event") {
            header["end-node"] = end.into();
        }
        let mut events: BTreeMap<String, Guard> = BTreeMap::new();
        for event in listed(network, "events", "event") {
            let id = text_of(event, "id")?;
            let guard = self.guard_of(event, &format!("event `{id}`"))?;
            self.add(&id, json!({ "tpn-type": "state" }))?;
            events.insert(id, guard);
        }
        self.add("the network", header)?;
        for (index, decision) in self.decisions.iter().enumerate() {
            if !events.contains_key(&decision.event) {
                return Err(dangling(&decision.id, &decision.event));
            }
            let mut object = json!({ "tpn-type": "c-begin" });
            if !decision.is_controllable {
                object["controllable"] = false.into();
            }
            if let Some(probability) = &decision.probability {
                object["probability"] = probability.as_str().into();
            }
            let way = format!("to {}", decision.id);
            let arc = json!({ "tpn-type": "null-activity", "end-node": decision.id });
            let taken = [(decision.id.clone(), object), (way.clone(), arc)];
            for (uid, object) in taken {
                if self.objects.insert(uid.clone(), object).is_some() {
                    return Err(twice(&uid));
                }
            }
            list(&mut self.objects, &decision.event, "activities", &way);
            debug_assert_eq!(
                self.by_id.get(&decision.id),
                Some(&(index as u32)),
                "decisions have their numbers"
            );
        }
        let edges = self.edges(network, &events)?;
        let places = self.places(&edges, &events)?;
        self.check(&start, &edges, &places, &events)?;
        for (edge, place) in edges.into_iter().zip(places) {
            self.add_edge(edge, place)?;
        }
        for constraint in listed(network, "chance-constraints", "chance-constraint") {
            self.add(&text_of(constraint, "id")?, json!({ "tpn-type": "chance-constraint" }))?;
        }
        Ok(Document::of_objects(self.objects)?)
    }

    fn add(&mut self, uid: &str, object: Value) -> Result<(), PtpnError> {
        let before = self.objects.insert(uid.to_owned(), object);
        if before.is_some() { Err(twice(uid)) } else { Ok(()) }
    }

    fn edges<'xml>(
        &self,
        network: Node<'xml, 'xml>,
        events: &BTreeMap<String, Guard>,
    ) -> Result<Vec<Edge<'xml>>, PtpnError> {
        let constraints =
            listed(network, "temporal-constraints", "temporal-constraint").map(|xml| (xml, false));
        let episodes = listed(network, "episodes", "episode").map(|xml| (xml, true));
        let mut edges = Vec::new();
        for (xml, is_episode) in constraints.chain(episodes) {
            let id = text_of(xml, "id")?;
            let (mut from, mut to) = (text_of(xml, "from-event")?, text_of(xml, "to-event")?);
            for event in [&from, &to] {
                if !events.contains_key(event) {
                    return Err(dangling(&id, event));
                }
            }
            let mut object = Map::new();
            let (lower, upper) = duration(xml, &id, &mut object)?;
            let bounds = match (lower, upper) {
                (Some(lower), upper) if !lower.is_negative() => (lower, upper),
                // Both events the other way around.
                (lower, Bound::Finite(upper)) if upper <= Time::ZERO && !is_episode => {
                    std::mem::swap(&mut from, &mut to);
                    let negated = |time: Time| time.checked_neg().ok_or_else(|| beyond(&id));
                    let longest = lower.map(negated).transpose()?.map_or(Bound::Infinite, Bound::Finite);
                    (negated(upper)?, longest)
                }
                _ => {
                    let problem = format!(
                        "`{id}` allows both orders of its events, which is not supported; both bounds must have the same sign"
                    );
                    return Err(PtpnError::Shape(problem));
                }
            };
            let guard = self.guard_of(xml, &format!("`{id}`"))?;
            edges.push(Edge { id, from, to, guard, object, bounds, xml, is_episode });
        }
        Ok(edges)
    }

    /// Returns what each edge is: by its guard, and constraints by whether other edges lead the same way.
    fn places(&self, edges: &[Edge<'_>], events: &BTreeMap<String, Guard>) -> Result<Vec<Place>, PtpnError> {
        let mut places = Vec::with_capacity(edges.len());
        for edge in edges {
            let (from, to) = (&events[&edge.from], &events[&edge.to]);
            let many = |_: TooManyTerms| PtpnError::TooManyTerms { place: format!("`{}`", edge.id) };
            let mut place = (edge.guard == *from).then_some(Place::Arc);
            for (index, decision) in self.decisions.iter().enumerate().filter(|(_, it)| it.event == edge.from)
            {
                for value in 0..decision.values.len() as u32 {
                    let way = from.and(&Guard::equals(index as u32, value)).map_err(many)?;
                    if place.is_none() && edge.guard == way.simplified(&self.value_counts) {
                        place = Some(Place::Alternative(index, value));
                    }
                }
            }
            let both = from.and(to).map_err(many)?.simplified(&self.value_counts);
            let between = (edge.guard == both && !edge.is_episode).then_some(Place::BetweenThreads);
            let found = place.or(between);
            places.push(found.ok_or_else(|| PtpnError::Guard { place: format!("`{}`", edge.id) })?);
        }
        if edges.len() <= MAX_TRANSITIVE {
            make_bounds(edges, &mut places);
        }
        Ok(places)
    }

    /// Each event has to be part of the plan just when arcs lead there that are.
    fn check(
        &self,
        start: &str,
        edges: &[Edge<'_>],
        places: &[Place],
        events: &BTreeMap<String, Guard>,
    ) -> Result<(), PtpnError> {
        let mut reached: BTreeMap<&str, Guard> =
            events.keys().map(|id| (id.as_str(), Guard::never())).collect();
        reached.insert(start, Guard::always());
        let mut ways = vec![BTreeSet::new(); self.decisions.len()];
        for (edge, place) in edges.iter().zip(places) {
            match place {
                Place::Bound | Place::BetweenThreads => continue,
                Place::Alternative(decision, value) => {
                    ways[*decision].insert(*value);
                }
                Place::Arc => {}
            }
            if let Some(guard) = reached.remove(edge.to.as_str()) {
                let many =
                    |_: TooManyTerms| PtpnError::TooManyTerms { place: format!("event `{}`", edge.to) };
                reached.insert(&edge.to, guard.or(&edge.guard).map_err(many)?.simplified(&self.value_counts));
            }
        }
        for (decision, ways) in self.decisions.iter().zip(ways) {
            if let Some(value) = (0..decision.values.len()).find(|value| !ways.contains(&(*value as u32))) {
                let value = &decision.values[value];
                return Err(PtpnError::Shape(format!("nothing follows `{}` = {value}", decision.id)));
            }
        }
        match events.iter().find(|(id, guard)| reached.get(id.as_str()) != Some(guard)) {
            Some((id, _)) => Err(PtpnError::Guard { place: format!("event `{id}`") }),
            None => Ok(()),
        }
    }

    fn add_edge(&mut self, edge: Edge<'_>, place: Place) -> Result<(), PtpnError> {
        let Edge { id, from, to, mut object, bounds, xml, is_episode, .. } = edge;
        let value = json!([bounds.0, bounds.1]);
        if matches!(place, Place::Bound | Place::BetweenThreads) {
            object.insert("tpn-type".to_owned(), "temporal-constraint".into());
            object.insert("end-node".to_owned(), to.into());
            object.insert("value".to_owned(), value);
            if place == Place::BetweenThreads {
                object.insert(BETWEEN_THREADS.to_owned(), true.into());
            }
            self.add(&id, Value::Object(object))?;
            list(&mut self.objects, &from, "constraints", &id);
            return Ok(());
        }
        let kind = if is_episode { "activity" } else { "null-activity" };
        object.insert("tpn-type".to_owned(), kind.into());
        object.insert("end-node".to_owned(), to.clone().into());
        if is_episode {
            let name = text_of(xml, "dispatch").or_else(|_| text_of(xml, "name"));
            object.insert("name".to_owned(), name.unwrap_or_else(|_| id.clone()).into());
            let is_conditional = children(xml, "state-constraint")
                .flat_map(|constraint| constraint.descendants())
                .any(|it| it.tag_name().name() == "boolean-expression");
            if is_conditional {
                object.insert("state-constraint".to_owned(), true.into());
            }
        }
        let leaves = match place {
            Place::Alternative(decision, value) => {
                let decision = &self.decisions[decision];
                if let Some(utility) = decision.utilities[value as usize].filter(|utility| *utility != 0.0) {
                    object.insert("reward".to_owned(), utility.into());
                }
                object.insert("order".to_owned(), value.into());
                decision.id.clone()
            }
            _ => from,
        };
        let bounds_id = format!("bounds of {id}");
        let constraint = json!({ "tpn-type": "temporal-constraint", "end-node": to, "value": value });
        self.add(&bounds_id, constraint)?;
        self.add(&id, Value::Object(object))?;
        list(&mut self.objects, &id, "constraints", &bounds_id);
        list(&mut self.objects, &leaves, "activities", &id);
        Ok(())
    }

    fn guard_of(&self, xml: Node<'_, '_>, place: &str) -> Result<Guard, PtpnError> {
        let Some(guard) = children(xml, "guard").next() else { return Ok(Guard::always()) };
        let many = |_: TooManyTerms| PtpnError::TooManyTerms { place: place.to_owned() };
        let read = self.guard(guard, false, MAX_GUARD_DEPTH).map_err(|error| match error {
            GuardError::TooManyTerms => many(TooManyTerms),
            GuardError::Shape(problem) => PtpnError::Shape(format!("the guard of {place}: {problem}")),
        })?;
        Ok(read.simplified(&self.value_counts))
    }

    fn guard(&self, xml: Node<'_, '_>, is_negated: bool, depth: u32) -> Result<Guard, GuardError> {
        let Some(depth) = depth.checked_sub(1) else { return Err(shape("it is nested too deeply")) };
        let parts = || xml.children().filter(Node::is_element);
        match (xml.tag_name().name(), is_negated) {
            ("guard", _) => match (parts().next(), parts().nth(1)) {
                (Some(part), None) => self.guard(part, is_negated, depth),
                _ => Err(shape("expected one condition")),
            },
            ("not", _) => match parts().next() {
                Some(part) => self.guard(part, !is_negated, depth),
                None => Err(shape("`not` needs a condition")),
            },
            ("or", false) | ("and", true) => parts()
                .try_fold(Guard::never(), |all, part| Ok(all.or(&self.guard(part, is_negated, depth)?)?)),
            ("and", false) | ("or", true) => parts()
                .try_fold(Guard::always(), |all, part| Ok(all.and(&self.guard(part, is_negated, depth)?)?)),
            ("boolean-constant", _) => {
                let says_true = match xml.text().unwrap_or_default().trim() {
                    "true" | "1" => true,
                    "false" | "0" => false,
                    other => return Err(shape(&format!("expected true or false, found `{other}`"))),
                };
                Ok(if says_true == is_negated { Guard::never() } else { Guard::always() })
            }
            ("decision-variable-equals", _) => self.equals(xml, is_negated),
            (other, _) => Err(shape(&format!("unknown condition `{other}`"))),
        }
    }

    fn equals(&self, xml: Node<'_, '_>, is_negated: bool) -> Result<Guard, GuardError> {
        let part = |key: &'static str| text_of(xml, key).map_err(|error| shape(&error.to_string()));
        let (variable, value) = (part("variable")?, part("value")?);
        let known = self.by_id.get(&variable).copied();
        let index = known.ok_or_else(|| shape(&format!("unknown decision variable `{variable}`")))?;
        let values = &self.decisions[index as usize].values;
        let chosen = values.iter().position(|it| *it == value);
        let chosen = chosen.ok_or_else(|| shape(&format!("`{variable}` has no value `{value}`")))?;
        let others = (0..values.len()).filter(|it| (*it == chosen) != is_negated);
        others.map(|it| Guard::equals(index, it as u32)).try_fold(Guard::never(), |all, it| Ok(all.or(&it)?))
    }
}

enum GuardError {
    TooManyTerms,
    Shape(String),
}

impl From<TooManyTerms> for GuardError {
    fn from(_: TooManyTerms) -> Self {
        Self::TooManyTerms
    }
}

fn shape(problem: &str) -> GuardError {
    GuardError::Shape(problem.to_owned())
}

/// Makes a constraint a bound where its end is reached from its beginning by others, too.
fn make_bounds(edges: &[Edge<'_>], places: &mut [Place]) {
    let mut leaving: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, edge) in edges.iter().enumerate() {
        leaving.entry(&edge.from).or_default().push(index);
    }
    for at in 0..edges.len() {
        if edges[at].is_episode || places[at] != Place::Arc {
            continue;
        }
        let mut seen = BTreeSet::new();
        let mut stack = vec![edges[at].from.as_str()];
        while let Some(event) = stack.pop() {
            for &next in leaving.get(event).into_iter().flatten() {
                let is_way = matches!(places[next], Place::Arc | Place::Alternative(..)) && next != at;
                if is_way && seen.insert(edges[next].to.as_str()) {
                    stack.push(&edges[next].to);
                }
            }
        }
        if seen.contains(edges[at].to.as_str()) {
            places[at] = Place::Bound;
        }
    }
}

/// The bounds of a duration, without a lower one where there is none; what planning does not honor of it goes into
/// `object`.
fn duration(
    xml: Node<'_, '_>,
    id: &str,
    object: &mut Map<String, Value>,
) -> Result<(Option<Time>, Bound), PtpnError> {
    let Some(kind) = children(xml, "duration").next().and_then(|it| it.first_element_child()) else {
        return Ok((Some(Time::ZERO), Bound::Infinite));
    };
    if kind.tag_name().name() != "bounded-duration" {
        object.insert("controllable".to_owned(), false.into());
    }
    match kind.tag_name().name() {
        "bounded-duration" | "set-bounded-uncertain-duration" => {
            Ok((lower(&text_of(kind, "lower-bound")?, id)?, upper(&text_of(kind, "upper-bound")?, id)?))
        }
        "probabilistic-uncertain-duration" => {
            let parameters = children(kind, "parameters").flat_map(|it| children(it, "parameter"));
            let parameters: Vec<&str> = parameters.filter_map(|it| it.text()).map(str::trim).collect();
            let distribution = text_of(kind, "distribution-type")?.to_ascii_uppercase();
            let of =
                text_of(xml, "dispatch").or_else(|_| text_of(xml, "name")).unwrap_or_else(|_| id.to_owned());
            let said = format!("{distribution}({}) of {of}", parameters.join(", "));
            object.insert("probability".to_owned(), said.into());
            match (distribution.as_str(), parameters.as_slice()) {
                ("UNIFORM", &[from, to]) => Ok((lower(from, id)?, upper(to, id)?)),
                // Any time is possible, if not likely.
                _ => Ok((Some(Time::ZERO), Bound::Infinite)),
            }
        }
        other => Err(PtpnError::Shape(format!("`{id}` has a duration of the unknown kind `{other}`"))),
    }
}

/// Returns what a decision variable says of how likely its values are, by its name.
fn probability(decision: Node<'_, '_>, id: &str, domain: &[Node<'_, '_>]) -> Option<String> {
    let name = text_of(decision, "name").unwrap_or_else(|_| id.to_owned());
    let said = |value: &Node<'_, '_>| {
        let probability = text_of(*value, "probability").ok()?;
        Some(format!("{} {probability}", text_of(*value, "value").ok()?))
    };
    let said: Vec<String> = domain.iter().filter_map(said).collect();
    (!said.is_empty()).then(|| format!("{name}: {}", said.join(", ")))
}

fn lower(text: &str, id: &str) -> Result<Option<Time>, PtpnError> {
    if ["-INF", "-INFINITY"].contains(&text.to_ascii_uppercase().as_str()) {
        return Ok(None);
    }
    text.parse().map(Some).map_err(|_| PtpnError::Shape(format!("`{id}`: `{text}` is not a time")))
}

fn upper(text: &str, id: &str) -> Result<Bound, PtpnError> {
    match text.to_ascii_uppercase().as_str() {
        "INF" | "INFINITY" => Ok(Bound::Infinite),
        _ => text
            .parse()
            .map(Bound::Finite)
            .map_err(|_| PtpnError::Shape(format!("`{id}`: `{text}` is not a time"))),
    }
}

fn list(objects: &mut Map<String, Value>, uid: &str, key: &str, item: &str) {
    if let Some(Value::Object(object)) = objects.get_mut(uid)
        && let Value::Array(list) = object.entry(key).or_insert_with(|| json!([]))
    {
        list.push(item.into());
    }
}

fn children<'xml>(
    node: Node<'xml, 'xml>,
    name: &'static str,
) -> impl Iterator<Item = Node<'xml, 'xml>> + use<'xml> {
    node.children().filter(move |child| child.tag_name().name() == name)
}

fn listed<'xml>(
    node: Node<'xml, 'xml>,
    list: &'static str,
    item: &'static str,
) -> impl Iterator<Item = Node<'xml, 'xml>> + use<'xml> {
    children(node, list).flat_map(move |list| children(list, item))
}

fn text_of(node: Node<'_, '_>, name: &'static str) -> Result<String, PtpnError> {
    let found = node.children().find(|child| child.tag_name().name() == name).and_then(|child| child.text());
    let text = found.map(str::trim).filter(|text| !text.is_empty());
    let missing = || PtpnError::Shape(format!("`{}` has no `{name}`", node.tag_name().name()));
    text.map(str::to_owned).ok_or_else(missing)
}

fn dangling(from: &str, to: &str) -> PtpnError {
    PtpnError::Shape(format!("`{from}` refers to `{to}`, which is not in the file"))
}

fn twice(id: &str) -> PtpnError {
    PtpnError::Shape(format!("duplicate element `{id}`"))
}

fn beyond(id: &str) -> PtpnError {
    PtpnError::Shape(format!("the bounds of `{id}` are too large"))
}
