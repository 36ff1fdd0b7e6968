//! The text of nested blocks.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use exact::{Bound, Time};
use rmpl::program::{Controllability, LabelMode};
use smol_str::SmolStr;

use super::Obstacle;
use super::blocks::{Blocks, Event, Form, Wrap};
use super::names::{Names, valid};
use super::series_parallel::Item;
use tpn::network::{ArcId, Label, Network, OccurrenceKind, ValueSet, Variable};

/// Blocks nest no deeper in a text, or in one that is written out (SPEC 1.7).
const DEEPEST: usize = 120;
/// Numbers have no more digits than this (SPEC 1.7).
const MAX_DIGITS: usize = 15;

/// Writes a mission.
pub(super) fn write(network: &Network, blocks: &Blocks, remarks: &[String]) -> Result<String, Obstacle> {
    let mut writer = Writer {
        network,
        blocks,
        names: Names::default(),
        primitives: BTreeMap::new(),
        definitions: Vec::new(),
        depth: 0,
    };
    let scenario = writer.scenario()?;
    let constraints = writer.constraints()?;
    let variables = writer.variables();
    let mut text = String::new();
    for remark in remarks {
        let _ = writeln!(text, "// {}", one_line(remark));
    }
    for (name, called) in &writer.names.renamed {
        let _ = writeln!(text, "// {name} is “{}” in the network.", one_line(called));
    }
    text.push_str(&writer.options()?);
    text.push_str(&variables);
    for (name, count) in &writer.primitives {
        let formals: Vec<String> = (1..=*count).map(|number| format!("p{number}")).collect();
        let _ = writeln!(text, "primitive {name}({});", formals.join(", "));
    }
    for (name, body) in &writer.definitions {
        let _ = writeln!(text, "\n{name}() = {body}");
    }
    let _ = writeln!(text, "\n{scenario}\n{constraints}");
    Ok(text)
}

struct Writer<'network> {
    network: &'network Network,
    blocks: &'network Blocks,
    names: Names,
    /// With how many parameters.
    primitives: BTreeMap<String, usize>,
    /// Defined activities and their blocks.
    definitions: Vec<(String, String)>,
    depth: usize,
}

impl Writer<'_> {
    fn scenario(&mut self) -> Result<String, Obstacle> {
        let whole = self.blocks.tree.sequences[0].items.len();
        let wraps = &self.blocks.wraps[0];
        let is_horizon = wraps.first().is_some_and(|wrap| {
            let is_activity = wrap.arc.and_then(|arc| self.activity(arc)).is_some();
            (wrap.from, wrap.to) == (0, whole) && !is_activity && self.labels(wrap.arc).is_empty()
        });
        let (horizon, wraps) = if is_horizon { wraps.split_at(1) } else { wraps.split_at(0) };
        let bounds = match horizon {
            [wrap] => bounds(wrap.lower, wrap.upper)?,
            _ => String::new(),
        };
        let body = self.items(0, 0, whole, wraps)?.join("; ");
        Ok(format!("scenario Network{bounds} = {{ {body} }}"))
    }

    /// The statements of a part of a sequence, within wraps.
    fn items(
        &mut self,
        sequence: usize,
        from: usize,
        to: usize,
        wraps: &[Wrap],
    ) -> Result<Vec<String>, Obstacle> {
        let mut statements = Vec::new();
        let (mut item, mut wraps) = (from, wraps);
        while item < to {
            let Some(wrap) = wraps.first().filter(|wrap| wrap.from == item) else {
                statements.extend(self.item(sequence, item)?);
                item += 1;
                continue;
            };
            let inner = wraps.iter().position(|other| other.from >= wrap.to).unwrap_or(wraps.len());
            self.deeper()?;
            let inside = self.items(sequence, wrap.from, wrap.to, &wraps[1..inner])?;
            self.depth -= 1;
            statements.push(self.wrapped(&block(&inside), wrap)?);
            item = wrap.to;
            wraps = &wraps[inner..];
        }
        Ok(statements)
    }

    fn wrapped(&mut self, block: &str, wrap: &Wrap) -> Result<String, Obstacle> {
        let bounds = bounds(wrap.lower, wrap.upper)?;
        let core = match wrap.arc.and_then(|arc| self.activity(arc)) {
            Some(activity) => format!("{}()", self.definition(&activity, block)),
            None => block.to_owned(),
        };
        self.conditional(format!("{core}{bounds}"), &self.labels(wrap.arc))
    }

    /// The defined activity with this block: instances of one activity that differ become several.
    fn definition(&mut self, activity: &str, block: &str) -> String {
        let like = valid(activity);
        let is_it = |(name, body): &&(String, String)| body == block && name.starts_with(&like);
        if let Some((name, _)) = self.definitions.iter().find(is_it) {
            return name.clone();
        }
        let name = self.names.free(&like);
        self.definitions.push((name.clone(), block.to_owned()));
        name
    }

    fn activity(&self, arc: ArcId) -> Option<SmolStr> {
        let occurrence = self.network.arcs[arc.index()].occurrence?;
        let occurrence = &self.network.occurrences[occurrence.index()];
        (occurrence.kind == OccurrenceKind::Activity).then(|| occurrence.activity.clone())
    }

    /// One item, unless it is how what surrounds it is compiled.
    fn item(&mut self, sequence: usize, item: usize) -> Result<Option<String>, Obstacle> {
        let place = (sequence, item);
        let statement =
            match (self.blocks.forms[sequence][item], &self.blocks.tree.sequences[sequence].items[item]) {
                (Form::Structure, _) => return Ok(None),
                (Form::Moment, _) => "delay[0,0]".to_owned(),
                (Form::Statement, Item::Arc(arc)) => self.arc(*arc)?,
                (Form::Statement, Item::Choose(alternatives)) => {
                    format!("choose {{ {} }}", self.sequences(alternatives)?.join(", "))
                }
                (Form::Statement, Item::Parallel(_)) => {
                    let branches = self.blocks.branches.get(&place).map_or(&[][..], Vec::as_slice);
                    match self.sequences(branches)?.as_slice() {
                        [] => "delay[0,inf]".to_owned(),
                        [only] => only.clone(),
                        several => format!("{{ {} }}", several.join(", ")),
                    }
                }
            };
        Ok(Some(match self.blocks.names.get(&place) {
            Some(number) => format!("{statement} as Part{number}"),
            None => statement,
        }))
    }

    fn sequences(&mut self, sequences: &[usize]) -> Result<Vec<String>, Obstacle> {
        let mut written = Vec::with_capacity(sequences.len());
        for &sequence in sequences {
            self.deeper()?;
            let whole = self.blocks.tree.sequences[sequence].items.len();
            let blocks = self.blocks;
            let statements = self.items(sequence, 0, whole, &blocks.wraps[sequence])?;
            self.depth -= 1;
            written.push(block(&statements));
        }
        Ok(written)
    }

    fn deeper(&mut self) -> Result<(), Obstacle> {
        self.depth += 1;
        // A choice with a block in it nests twice.
        if self.depth * 2 > DEEPEST {
            return Err(Obstacle::of_network(format!(
                "the network nests deeper than {} levels",
                DEEPEST / 2
            )));
        }
        Ok(())
    }

    fn arc(&mut self, id: ArcId) -> Result<String, Obstacle> {
        let arc = &self.network.arcs[id.index()];
        let occurrence = arc.occurrence.map(|occurrence| &self.network.occurrences[occurrence.index()]);
        let nature = if arc.is_contingent { " contingent" } else { "" };
        let labels = self.labels(Some(id));
        if let Some(occurrence) = occurrence.filter(|occurrence| occurrence.kind == OccurrenceKind::Primitive)
        {
            let arguments: Vec<String> =
                occurrence.arguments.iter().map(|argument| self.argument(argument)).collect();
            let key = format!("{}\u{1f}{}", occurrence.activity, arguments.len());
            let name = self.names.of("activity", &key);
            self.primitives.insert(name.clone(), arguments.len());
            let bounds = bounds(arc.lower, arc.upper)?;
            return self.conditional(format!("{name}({}){nature}{bounds}", arguments.join(", ")), &labels);
        }
        let bounds = format!("[{},{}]", time(arc.lower)?, upper(arc.upper)?);
        let (told, asked): (Vec<_>, Vec<_>) = labels.iter().partition(|label| label.mode == LabelMode::Tell);
        if labels.is_empty() {
            return Ok(format!("delay{nature}{bounds}"));
        }
        if told.is_empty() {
            return Ok(format!("ask {}{nature} {bounds}", self.conditions(&asked)?));
        }
        let assertion = format!("tell {}{nature} {bounds}", self.conditions(&told)?);
        let asked: Vec<Label> = asked.into_iter().cloned().collect();
        self.conditional(assertion, &asked)
    }

    fn labels(&self, arc: Option<ArcId>) -> Vec<Label> {
        let labels = arc.map_or(&[][..], |arc| &self.network.arcs[arc.index()].labels);
        labels.iter().map(|label| self.network.labels[label.index()].clone()).collect()
    }

    /// A unit that requires and asserts what the labels say.
    fn conditional(&mut self, unit: String, labels: &[Label]) -> Result<String, Obstacle> {
        let mut unit = unit;
        for label in labels {
            let condition = self.conditions(&[label])?;
            unit = match label.mode {
                LabelMode::Ask => format!("do {unit} maintaining {condition}"),
                LabelMode::Tell => match condition.strip_prefix("not ") {
                    Some(positive) => format!("do {unit} watching {positive}"),
                    None => format!("do {unit} watching not {condition}"),
                },
            };
        }
        Ok(unit)
    }

    fn conditions(&mut self, labels: &[&Label]) -> Result<String, Obstacle> {
        let mut conditions = Vec::new();
        for label in labels {
            let variable = &self.network.variables[label.literal.variable.index()];
            let name = self.variable(variable);
            let (values, is_negated) = match &label.literal.values {
                ValueSet::In(values) => (values, false),
                ValueSet::NotIn(values) => (values, true),
            };
            let mut given = Vec::new();
            for value in values {
                let text = variable.values[value.index()].clone();
                given.push(self.value(&variable.name, &text));
            }
            let condition = match given.as_slice() {
                [] => return Err(Obstacle::at_arc(label.arc, "has a condition that no value meets")),
                [value] if is_atom(variable) => {
                    if value == "true" {
                        name
                    } else {
                        format!("not {name}")
                    }
                }
                [value] => format!("{name}={value}"),
                several => format!("{name} in {{{}}}", several.join(", ")),
            };
            conditions.push(if is_negated { format!("not {condition}") } else { condition });
        }
        Ok(conditions.join(" and "))
    }

    /// The underscore of an atom's name must not part it into a variable and a value (SPEC 1.3).
    fn variable(&mut self, variable: &Variable) -> String {
        let is_other = |owner: &str| self.network.variables.iter().any(|other| other.name == owner);
        let parts = variable.name.rsplit_once('_');
        if is_atom(variable) && parts.is_some_and(|(owner, _)| is_other(owner)) {
            return self.names.of("variable", &variable.name.replace('_', "-"));
        }
        self.names.of("variable", &variable.name)
    }

    fn value(&mut self, variable: &str, value: &str) -> String {
        let name = valid(value);
        if name == value { name } else { self.names.of("value", &format!("{value}\u{1f}{variable}")) }
    }

    fn argument(&mut self, text: &str) -> String {
        let digits = text.strip_prefix('-').unwrap_or(text);
        let is_number = digits.len() <= MAX_DIGITS
            && digits.starts_with(|first: char| first.is_ascii_digit())
            && digits.ends_with(|last: char| last.is_ascii_digit())
            && digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.')
            && digits.bytes().filter(|&byte| byte == b'.').count() <= 1;
        if is_number { text.to_owned() } else { self.names.of("argument", text) }
    }

    fn options(&self) -> Result<String, Obstacle> {
        let mut text = String::new();
        if self.network.threat_gap != Time::ONE {
            let gap = time(self.network.threat_gap)?;
            if gap.contains('/') {
                return Err(Obstacle::of_network(format!("the threat gap {gap} is not a decimal number")));
            }
            let _ = writeln!(text, "option threat_gap = {gap};");
        }
        match self.network.controllability {
            Controllability::Dynamic => {}
            Controllability::Strong => text.push_str("option controllability = strong;\n"),
            Controllability::None => text.push_str("option controllability = none;\n"),
        }
        Ok(text)
    }

    /// Variables that have no other values than these.
    fn variables(&mut self) -> String {
        let network = self.network;
        let mut text = String::new();
        for variable in network.variables.iter().filter(|variable| variable.closed && !is_atom(variable)) {
            let values: Vec<String> =
                variable.values.iter().map(|value| self.value(&variable.name, value)).collect();
            let _ = writeln!(text, "var {} : {{{}}};", self.variable(variable), values.join(", "));
        }
        text
    }

    fn constraints(&self) -> Result<String, Obstacle> {
        let event = |event: &Event| {
            let number = self.blocks.names.get(&event.item).copied().unwrap_or(0);
            format!("Part{number}.{}", if event.is_end { "end" } else { "start" })
        };
        let mut text = String::new();
        for constraint in &self.blocks.constraints {
            let bounds = format!("[{},{}]", time(constraint.lower)?, upper(constraint.upper)?);
            let _ = writeln!(
                text,
                "constrain {} to {} {bounds};",
                event(&constraint.from),
                event(&constraint.to)
            );
        }
        Ok(text)
    }
}

/// Returns whether a variable is a condition that is true or false.
fn is_atom(variable: &Variable) -> bool {
    let mut values: Vec<&str> = variable.values.iter().map(SmolStr::as_str).collect();
    values.sort_unstable();
    variable.closed && values == ["false", "true"]
}

fn block(statements: &[String]) -> String {
    format!("{{ {} }}", statements.join("; "))
}

fn bounds(lower: Time, greatest: Bound) -> Result<String, Obstacle> {
    if lower.is_zero() && greatest == Bound::Infinite {
        return Ok(String::new());
    }
    Ok(format!("[{},{}]", time(lower)?, upper(greatest)?))
}

fn upper(bound: Bound) -> Result<String, Obstacle> {
    bound.finite().map_or_else(|| Ok("inf".to_owned()), time)
}

fn time(time: Time) -> Result<String, Obstacle> {
    let text = time.to_string();
    let is_short = |part: &str| part.bytes().filter(u8::is_ascii_digit).count() <= MAX_DIGITS;
    if text.split('/').all(is_short) {
        Ok(text)
    } else {
        Err(Obstacle::of_network(format!("the time {text} has more than {MAX_DIGITS} digits")))
    }
}

/// Returns what a comment can hold.
fn one_line(text: &str) -> String {
    text.replace(|character: char| character.is_control(), " ")
}
