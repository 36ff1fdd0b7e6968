//! Bodies of methods: statements as units of a mission.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::conditions::by_argument;
use super::{Given, NOTHING, Place, UNKNOWN, Writer};
use crate::pamela::names::{limits, name, number};
use crate::pamela::tree::Tree;

/// What a statement says beside its parts.
#[derive(Default)]
struct Options<'file> {
    bounds: Option<&'file Tree>,
    label: Option<&'file str>,
    others: BTreeMap<&'file str, &'file Tree>,
}

impl<'file> Writer<'file> {
    /// Returns what stands in the braces of a method.
    pub(super) fn body(&mut self, place: Place<'_, 'file>) -> String {
        let method = place.method;
        let mut steps = Vec::new();
        if let Some(condition) = method.options.get("pre") {
            match self.condition(condition, place) {
                Ok(condition) => steps.push(format!("ask {condition}")),
                Err(what) => self
                    .leave_out(condition.line(), format!("the condition before `{}`: {what}", method.name)),
            }
        }
        if let Some(effect) = method.options.get("post") {
            self.leave_out(effect.line(), format!("the effect of `{}`, which has a body", method.name));
        }
        let worth = self.account(&method.options);
        steps.extend(worth);
        self.say_unused(&method.options);
        if let Some(body) = method.body {
            match self.statement(body, place) {
                Ok(text) => steps.push(text),
                Err(what) => self.leave_out(body.line(), what),
            }
        }
        if steps.is_empty() { NOTHING.to_owned() } else { steps.join("; ") }
    }

    /// A call that counts a cost and a reward, if there are any.
    fn account(&mut self, options: &BTreeMap<&'file str, &'file Tree>) -> Option<String> {
        let clauses = self.worth(options);
        if clauses.is_empty() {
            return None;
        }
        let own = name(&clauses.trim().replace([' ', '.'], "-"));
        self.accounts.insert(own.clone(), clauses);
        Some(format!("{own}()"))
    }

    /// Statements of a sequence or a parallel block, without those that cannot be read.
    fn statements(&mut self, trees: &'file [Tree], place: Place<'_, 'file>) -> Vec<String> {
        let mut texts = Vec::new();
        for tree in trees {
            match self.statement(tree, place) {
                Ok(text) => texts.push(text),
                Err(what) => self.leave_out(tree.line(), what),
            }
        }
        texts
    }

    /// A statement as a unit of a mission.
    fn statement(&mut self, tree: &'file Tree, place: Place<'_, 'file>) -> Result<String, String> {
        let (head, rest) = tree.headed().ok_or("expected a statement `(…)`")?;
        let (mut options, parts) = options(rest);
        let block = |texts: Vec<String>, between: &str| {
            let inside = if texts.is_empty() { NOTHING.to_owned() } else { texts.join(between) };
            format!("{{ {inside} }}")
        };
        let optional =
            |texts: Vec<String>| texts.into_iter().map(|text| format!("optional {{ {text} }}")).collect();
        let late = |texts: Vec<String>| texts.into_iter().map(|text| format!("delay; {text}"));
        let core = match head {
            "sequence" => block(self.statements(parts, place), "; "),
            "parallel" => block(self.statements(parts, place), ", "),
            "soft-sequence" => block(optional(self.statements(parts, place)), "; "),
            "soft-parallel" => block(optional(self.statements(parts, place)), ", "),
            "slack-sequence" => {
                let mut texts: Vec<String> = late(self.statements(parts, place)).collect();
                texts.push("delay".to_owned());
                block(texts, "; ")
            }
            "slack-parallel" => {
                let texts = late(self.statements(parts, place)).map(|text| format!("{{ {text}; delay }}"));
                block(texts.collect(), ", ")
            }
            "optional" => format!("optional {{ {} }}", self.only(parts, place)?),
            "delay" => {
                let bounds = self.bounds(options.bounds.take()).unwrap_or_default();
                format!("delay{bounds}")
            }
            "choose" => self.choose(parts, place)?,
            "dotimes" => {
                let (count, body) = parts.split_first().ok_or("expected a number")?;
                let count =
                    count.word().filter(|count| count.parse::<u32>().is_ok()).ok_or("expected a number")?;
                format!("repeat {count} {{ {} }}", self.only(body, place)?)
            }
            "ask" | "tell" => {
                let [condition, rest @ ..] = parts else {
                    return Err(format!("`{head}` without a condition"));
                };
                merge(&mut options, rest);
                let condition = self.condition(condition, place)?;
                if head == "tell" {
                    format!("tell {condition}")
                } else {
                    format!("{{ delay; ask {condition} }}")
                }
            }
            "maintain" | "when" | "unless" => {
                let [condition, rest @ ..] = parts else {
                    return Err(format!("`{head}` without a condition"));
                };
                let condition = self.condition(condition, place)?;
                let body = self.only(merge(&mut options, rest), place)?;
                match head {
                    "maintain" => format!("{{ do {{ {body} }} maintaining {condition} }}"),
                    "when" => format!("{{ if {condition} thennext {{ {body} }} else {NOTHING} }}"),
                    _ => format!("{{ if not {condition} thennext {{ {body} }} else {NOTHING} }}"),
                }
            }
            "try" => {
                if let Some(catch) = parts.get(1) {
                    self.leave_out(
                        catch.line(),
                        "`catch`: a mission has no text for what follows a failure".to_owned(),
                    );
                }
                format!("{{ {} }}", self.only(parts.get(..1).unwrap_or_default(), place)?)
            }
            "assert" => {
                return Err("`assert`: the planner adds no activities that make a condition true".to_owned());
            }
            "whenever" | "choose-whenever" => {
                return Err(format!(
                    "`{head}`: a plan cannot repeat an activity each time a condition becomes true"
                ));
            }
            _ => return self.call(tree.line(), head, rest, place),
        };
        Ok(self.finish(tree.line(), core, &options))
    }

    /// A statement with its bounds, its label, and what it costs.
    fn finish(&mut self, line: u32, core: String, options: &Options<'file>) -> String {
        for (key, given) in &options.others {
            if matches!(*key, "cost<=" | "reward>=") {
                self.leave_out(given.line(), format!("`:{key}`: a limit on the sum of a part of the plan"));
            }
            let is_one = given.word() == Some("1");
            if matches!(*key, "exactly" | "min" | "max") && !is_one {
                self.leave_out(line, format!("`:{key}`: exactly one of the choices is chosen"));
            }
        }
        self.say_unused(&options.others);
        let mut text = core;
        if let Some(account) = self.account(&options.others) {
            text = format!("{{ {account}; {text} }}");
        }
        let bounds = self.bounds(options.bounds).unwrap_or_default();
        if !bounds.is_empty() && !text.starts_with('{') {
            text = format!("{{ {text} }}");
        }
        text += &bounds;
        if let Some(label) = options.label {
            self.labels.insert(label);
            let _ = write!(text, " as {}", name(label));
        }
        text
    }

    /// The one statement of a form.
    fn only(&mut self, parts: &'file [Tree], place: Place<'_, 'file>) -> Result<String, String> {
        match parts {
            [only] => self.statement(only, place),
            _ => Err("expected one statement here".to_owned()),
        }
    }

    fn choose(&mut self, parts: &'file [Tree], place: Place<'_, 'file>) -> Result<String, String> {
        let mut alternatives = Vec::new();
        for part in parts {
            match self.alternative(part, place) {
                Ok(text) => alternatives.push(text),
                Err(what) => self.leave_out(part.line(), what),
            }
        }
        if alternatives.is_empty() {
            return Err("no alternative of this choice could be converted".to_owned());
        }
        Ok(format!("choose {{ {} }}", alternatives.join(", ")))
    }

    fn alternative(&mut self, tree: &'file Tree, place: Place<'_, 'file>) -> Result<String, String> {
        let Some(("choice", rest)) = tree.headed() else { return Err("expected `(choice …)`".to_owned()) };
        let (choice, parts) = options(rest);
        let mut text = self.only(parts, place)?;
        for (key, is_before) in [("enter", true), ("leave", false)] {
            if let Some(given) = choice.others.get(key).copied() {
                let around = self.statement(given, place)?;
                text = if is_before {
                    format!("{{ {around}; {text} }}")
                } else {
                    format!("{{ {text}; {around} }}")
                };
            }
        }
        let text = self.finish(tree.line(), text, &choice);
        match choice.others.get("guard") {
            Some(guard) => {
                let guard = self.condition(guard, place)?;
                Ok(format!("if {guard} thennext {{ {text} }}"))
            }
            None => Ok(text),
        }
    }

    fn call(
        &mut self,
        line: u32,
        path: &'file str,
        rest: &'file [Tree],
        place: Place<'_, 'file>,
    ) -> Result<String, String> {
        let (mut options, arguments) = options(rest);
        let key = self.instances.method(place.instance, path);
        let key = key.ok_or_else(|| format!("unknown method `{path}`"))?;
        let method = &self.instances.class(key.0).methods[key.1];
        // Options may stand among arguments, too.
        let arguments: Vec<&Tree> = merge(&mut options, arguments).iter().collect();
        if arguments.len() != method.arguments.len() {
            return Err(format!(
                "`{path}` takes {} arguments, but has {} here",
                method.arguments.len(),
                arguments.len()
            ));
        }
        let mut given = Vec::new();
        for (number, argument) in arguments.into_iter().enumerate() {
            let value = self.value(argument, place).unwrap_or_else(|| UNKNOWN.to_owned());
            let written = by_argument(argument, place).unwrap_or_else(|| Given::Written(value.clone()));
            self.given.entry((key, number)).or_default().insert(written);
            given.push(value);
        }
        self.called.insert(key);
        let own = self.names.get(&key).cloned().unwrap_or_default();
        if let (Some((least, most)), Some((low, high))) =
            (limits(options.bounds), limits(method.options.get("bounds").copied()))
            && (most.is_some_and(|most| most < low) || high.is_some_and(|high| high < least))
        {
            self.leave_out(
                line,
                format!("the bounds of this call of `{path}`: the method's own bounds exclude them"),
            );
            options.bounds = None;
        }
        let bounds = self.bounds(options.bounds.take()).unwrap_or_default();
        let core = format!("{own}({}){bounds}", given.join(", "));
        Ok(self.finish(line, core, &options))
    }

    /// `(between from to :bounds [l u])` as a declaration.
    pub(super) fn between(&mut self, tree: &'file Tree) -> String {
        let Some((head, [from, to, rest @ ..])) = tree.headed() else { return String::new() };
        let (options, _) = options(rest);
        for (key, given) in &options.others {
            self.leave_out(given.line(), format!("`:{key}`: a limit on the sum of a part of the plan"));
        }
        let (first, second) = match head {
            "between-starts" => ("start", "start"),
            "between-ends" => ("end", "end"),
            _ => ("end", "start"),
        };
        let (Some(from), Some(to)) = (from.keyword(), to.keyword()) else {
            self.leave_out(tree.line(), format!("`{head}`: expected two labels"));
            return String::new();
        };
        if let Some(unknown) = [from, to].into_iter().find(|label| !self.labels.contains(label)) {
            self.leave_out(tree.line(), format!("`{head}`: nothing has the label `{unknown}`"));
            return String::new();
        }
        match self.bounds(options.bounds) {
            Some(bounds) => format!("constrain {}.{first} to {}.{second} {bounds};\n", name(from), name(to)),
            None => String::new(),
        }
    }

    /// Bounds in brackets; `None` if there are none that can be read.
    pub(super) fn bounds(&mut self, tree: Option<&'file Tree>) -> Option<String> {
        let tree = tree?;
        let given = match tree.headed() {
            // A variable of the plan, perhaps with bounds at the start.
            Some(("lvar", parts)) => {
                let bounds = parts.iter().find(|part| part.vector().is_some());
                if bounds.is_some() {
                    self.remark("`lvar` bounds are fixed to their initial values");
                } else {
                    self.leave_out(tree.line(), "`lvar` bounds without initial values".to_owned());
                }
                bounds?
            }
            _ => tree,
        };
        let pair = match given.vector() {
            Some([least, most]) => number(least).zip(match most.keyword() {
                Some("infinity") => Some("inf".to_owned()),
                _ => number(most),
            }),
            _ => None,
        };
        if pair.is_none() {
            self.leave_out(given.line(), "these bounds: expected `[number number]`".to_owned());
        }
        pair.map(|(least, most)| format!("[{least},{most}]"))
    }
}

/// The options before the parts of a statement.
fn options(rest: &[Tree]) -> (Options<'_>, &[Tree]) {
    let mut found = Options::default();
    let rest = merge(&mut found, rest);
    (found, rest)
}

/// Adds the options before the parts of a statement, and returns the parts.
fn merge<'file>(found: &mut Options<'file>, mut rest: &'file [Tree]) -> &'file [Tree] {
    const KEYS: [&str; 16] = [
        "bounds",
        "label",
        "cost",
        "reward",
        "controllable",
        "probability",
        "guard",
        "enter",
        "leave",
        "exactly",
        "min",
        "max",
        "cost<=",
        "reward>=",
        "display-name",
        "doc",
    ];
    while let [key, value, after @ ..] = rest
        && let Some(key) = key.keyword().filter(|key| KEYS.contains(key))
    {
        match key {
            "bounds" => found.bounds = Some(value),
            "label" => found.label = value.keyword(),
            _ => {
                found.others.insert(key, value);
            }
        }
        rest = after;
    }
    rest
}
