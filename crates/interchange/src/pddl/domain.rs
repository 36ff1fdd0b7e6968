//! Domains and problems as data, before objects replace parameters.

use std::collections::BTreeMap;

use exact::Rational;

use super::error::PddlError;
use super::tree::Tree;

/// How an error names `:constraints`.
const CONSTRAINTS: &str = "a constraint on the course of a plan (`:constraints`)";

/// Names with their types. A name with several types (`either`) may have any of them.
pub(super) type Typed = Vec<(String, Vec<String>)>;

/// A predicate or a function with its terms.
pub(super) type Application = Vec<String>;

/// A domain together with a problem of it.
#[derive(Debug, Default)]
pub(super) struct Task {
    pub(super) domain: String,
    pub(super) problem: String,
    /// The types above each type.
    pub(super) parents: BTreeMap<String, Vec<String>>,
    /// Constants and objects.
    pub(super) objects: Typed,
    pub(super) schemas: Vec<Schema>,
    /// The atoms that are true at the start.
    pub(super) facts: Vec<Application>,
    /// The numbers at the start.
    pub(super) values: Vec<(Application, Rational)>,
    /// What becomes true or false at a time, whatever the plan does.
    pub(super) timed: Vec<(Rational, Application, bool)>,
    pub(super) goal: Option<Formula>,
    pub(super) metric: Option<Metric>,
}

/// `(:metric minimize …)`
#[derive(Debug)]
pub(super) struct Metric {
    pub(super) is_maximized: bool,
    pub(super) measure: Expr,
    /// As it was written.
    pub(super) text: String,
}

/// An action with parameters.
#[derive(Debug)]
pub(super) struct Schema {
    pub(super) name: String,
    pub(super) line: u32,
    pub(super) parameters: Typed,
    /// Limits of the duration; `None` for an action that takes no time.
    pub(super) duration: Option<Vec<(Comparison, Expr)>>,
    pub(super) conditions: Vec<(When, Formula)>,
    pub(super) effects: Vec<(When, Effect)>,
}

/// When a condition has to hold or an effect happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum When {
    Start,
    Throughout,
    End,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Comparison {
    Less,
    AtMost,
    Equal,
    AtLeast,
    Greater,
}

impl Comparison {
    fn named(word: &str) -> Option<Self> {
        Some(match word {
            "<" => Self::Less,
            "<=" => Self::AtMost,
            "=" => Self::Equal,
            ">=" => Self::AtLeast,
            ">" => Self::Greater,
            _ => return None,
        })
    }

    /// With its sides exchanged.
    pub(super) const fn mirrored(self) -> Self {
        match self {
            Self::Less => Self::Greater,
            Self::AtMost => Self::AtLeast,
            Self::Equal => Self::Equal,
            Self::AtLeast => Self::AtMost,
            Self::Greater => Self::Less,
        }
    }
}

#[derive(Clone, Debug)]
pub(super) enum Formula {
    Atom(Application),
    Same(String, String),
    Compare(Comparison, Expr, Expr),
    Not(Box<Formula>),
    And(Vec<Formula>),
    Or(Vec<Formula>),
    Each(Typed, Box<Formula>),
    Any(Typed, Box<Formula>),
}

#[derive(Clone, Debug)]
pub(super) enum Effect {
    Set(Application, bool),
    /// How much a number grows.
    Grow(Application, Expr),
    /// How much a number shrinks.
    Shrink(Application, Expr),
    Each(Typed, Vec<Effect>),
}

#[derive(Clone, Debug)]
pub(super) enum Expr {
    Number(Rational),
    Fluent(Application),
    Duration,
    TotalTime,
    Sum(Vec<Expr>),
    Product(Vec<Expr>),
    Difference(Box<Expr>, Box<Expr>),
    Quotient(Box<Expr>, Box<Expr>),
}

/// Reads one file.
struct Reader<'file> {
    file: &'file str,
}

/// The task of a domain and a problem, each with the name of its file.
pub(super) fn read(domain: (&str, &str), problem: (&str, &str)) -> Result<Task, PddlError> {
    let mut task = Task::default();
    let reader = Reader { file: domain.0 };
    for (head, section) in reader.sections(domain.1, "domain", &mut task.domain)? {
        reader.domain_section(&mut task, &head, &section)?;
    }
    let reader = Reader { file: problem.0 };
    let mut of_domain = String::new();
    for (head, section) in reader.sections(problem.1, "problem", &mut task.problem)? {
        reader.problem_section(&mut task, &head, &section, &mut of_domain)?;
    }
    if !of_domain.is_empty() && of_domain != task.domain {
        return Err(PddlError::OtherDomain { wanted: of_domain, found: task.domain });
    }
    Ok(task)
}

impl Reader<'_> {
    fn shape(&self, tree: &Tree, what: impl Into<String>) -> PddlError {
        PddlError::Shape { file: self.file.to_owned(), line: tree.line(), what: what.into() }
    }

    fn unsupported(&self, tree: &Tree, what: impl Into<String>) -> PddlError {
        PddlError::Unsupported { file: self.file.to_owned(), line: tree.line(), what: what.into() }
    }

    /// The sections of `(define (domain NAME) …)`, by their first words.
    fn sections(&self, text: &str, kind: &str, name: &mut String) -> Result<Vec<(String, Tree)>, PddlError> {
        let whole = Tree::read(text, self.file)?;
        let lacks = || self.shape(&whole, format!("expected `(define ({kind} NAME) …)`"));
        let Some(("define", [header, sections @ ..])) = whole.headed() else { return Err(lacks()) };
        match header.headed() {
            Some((head, [found])) if head == kind => found.word().ok_or_else(lacks)?.clone_into(name),
            _ => return Err(lacks()),
        }
        let headed = |section: &Tree| {
            let (head, _) = section.headed().ok_or_else(|| self.shape(section, "expected `(:section …)`"))?;
            Ok((head.to_owned(), section.clone()))
        };
        sections.iter().map(headed).collect()
    }

    fn domain_section(&self, task: &mut Task, head: &str, section: &Tree) -> Result<(), PddlError> {
        let rest = section.list().and_then(|list| list.get(1..)).unwrap_or_default();
        match head {
            // Requirements decide nothing: each construct is read or refused where it is used. So are predicates and
            // functions.
            ":requirements" | ":predicates" | ":functions" => {}
            ":types" => task.parents.extend(self.typed(rest)?),
            ":constants" => task.objects.extend(self.typed(rest)?),
            ":durative-action" | ":action" => {
                task.schemas.push(self.schema(section, rest, head == ":durative-action")?);
            }
            ":derived" => return Err(self.unsupported(section, "a derived predicate (`:derived`)")),
            ":constraints" => return Err(self.unsupported(section, CONSTRAINTS)),
            ":process" | ":event" => {
                return Err(self.unsupported(section, format!("PDDL+ (`{head}`)")));
            }
            other => return Err(self.unsupported(section, format!("the section `{other}`"))),
        }
        Ok(())
    }

    fn problem_section(
        &self,
        task: &mut Task,
        head: &str,
        section: &Tree,
        of_domain: &mut String,
    ) -> Result<(), PddlError> {
        let rest = section.list().and_then(|list| list.get(1..)).unwrap_or_default();
        match (head, rest) {
            (":requirements", _) => {}
            (":domain", [name]) => name.word().unwrap_or_default().clone_into(of_domain),
            (":objects", _) => task.objects.extend(self.typed(rest)?),
            (":init", _) => {
                for fact in rest {
                    self.fact(task, fact)?;
                }
            }
            (":goal", [goal]) => task.goal = Some(self.formula(goal)?),
            (":metric", [direction, measure]) => {
                let is_maximized = match direction.word() {
                    Some("minimize") => false,
                    Some("maximize") => true,
                    _ => return Err(self.shape(section, "expected `minimize` or `maximize`")),
                };
                let text = format!("{direction} {measure}");
                task.metric = Some(Metric { is_maximized, measure: self.expr(measure)?, text });
            }
            (":constraints", _) => return Err(self.unsupported(section, CONSTRAINTS)),
            (other, _) => return Err(self.unsupported(section, format!("the section `{other}`"))),
        }
        Ok(())
    }

    fn fact(&self, task: &mut Task, fact: &Tree) -> Result<(), PddlError> {
        match fact.headed() {
            Some(("=", [fluent, number])) => {
                let value = number.word().and_then(|word| word.parse().ok());
                let value = value
                    .ok_or_else(|| self.shape(number, format!("expected a number, found `{number}`")))?;
                task.values.push((self.fluent(fluent)?, value));
            }
            Some(("at", [time, event])) if event.list().is_some() => {
                let time: Option<Rational> = time.word().and_then(|word| word.parse().ok());
                let time = time.filter(|time| !time.is_negative());
                let time = time.ok_or_else(|| self.shape(event, "expected a time of 0 or more"))?;
                let (event, value) = match event.headed() {
                    Some(("not", [event])) => (event, false),
                    Some(("=", _)) => return Err(self.unsupported(event, "a number that changes at a time")),
                    _ => (event, true),
                };
                task.timed.push((time, self.application(event)?, value));
            }
            // An atom that the problem does not list is false anyway.
            Some(("not", [_])) => {}
            _ => task.facts.push(self.application(fact)?),
        }
        Ok(())
    }

    fn schema(&self, section: &Tree, rest: &[Tree], is_durative: bool) -> Result<Schema, PddlError> {
        let (name, rest) = rest.split_first().ok_or_else(|| self.shape(section, "the action has no name"))?;
        let name = name.word().ok_or_else(|| self.shape(name, "expected the name of the action"))?.to_owned();
        let mut schema = Schema {
            name,
            line: section.line(),
            parameters: Vec::new(),
            duration: None,
            conditions: Vec::new(),
            effects: Vec::new(),
        };
        for pair in rest.chunks(2) {
            let [key, value] = pair else { return Err(self.shape(section, "a keyword lacks its value")) };
            match (key.word().unwrap_or_default(), is_durative) {
                (":parameters", _) => schema.parameters = self.typed(value.list().unwrap_or_default())?,
                (":duration", true) => {
                    let mut limits = Vec::new();
                    self.limits(value, &mut limits)?;
                    schema.duration = Some(limits);
                }
                (":condition", true) => self.conditions(value, &mut schema.conditions)?,
                (":precondition", false) => schema.conditions.push((When::Start, self.formula(value)?)),
                (":effect", true) => self.timed_effects(value, &mut schema.effects)?,
                (":effect", false) => {
                    let effects = self.effects(value)?;
                    schema.effects.extend(effects.into_iter().map(|effect| (When::Start, effect)));
                }
                (other, _) => return Err(self.unsupported(key, format!("`{other}` of an action"))),
            }
        }
        if is_durative && schema.duration.is_none() {
            return Err(
                self.shape(section, format!("the durative action `{}` has no :duration", schema.name))
            );
        }
        Ok(schema)
    }

    /// `(= ?duration 10)`, several of them joined by `and`, or `()`.
    fn limits(&self, tree: &Tree, limits: &mut Vec<(Comparison, Expr)>) -> Result<(), PddlError> {
        match tree.headed() {
            None if tree.is_empty() => {}
            Some(("and", parts)) => {
                for part in parts {
                    self.limits(part, limits)?;
                }
            }
            Some(("at", [when, limit])) if when.word() == Some("start") => self.limits(limit, limits)?,
            Some((head, [left, right])) => {
                let comparison = Comparison::named(head).ok_or_else(|| {
                    self.shape(tree, format!("expected a limit of ?duration, found `{tree}`"))
                })?;
                if left.word() == Some("?duration") {
                    limits.push((comparison, self.expr(right)?));
                } else if right.word() == Some("?duration") {
                    limits.push((comparison.mirrored(), self.expr(left)?));
                } else {
                    return Err(self.shape(tree, format!("expected a limit of ?duration, found `{tree}`")));
                }
            }
            _ => return Err(self.unsupported(tree, format!("the duration `{tree}`"))),
        }
        Ok(())
    }

    fn conditions(&self, tree: &Tree, found: &mut Vec<(When, Formula)>) -> Result<(), PddlError> {
        if let Some((when, condition)) = timed(tree) {
            found.push((when, self.formula(condition)?));
            return Ok(());
        }
        match tree.headed() {
            None if tree.is_empty() => {}
            Some(("and", parts)) => {
                for part in parts {
                    self.conditions(part, found)?;
                }
            }
            Some(("forall", [names, inner])) => {
                let names = self.typed(names.list().unwrap_or_default())?;
                let mut inside = Vec::new();
                self.conditions(inner, &mut inside)?;
                let each = |(when, formula)| (when, Formula::Each(names.clone(), Box::new(formula)));
                found.extend(inside.into_iter().map(each));
            }
            Some(("preference", _)) => return Err(self.unsupported(tree, "a preference")),
            _ => {
                return Err(
                    self.shape(tree, format!("expected `at start`, `over all` or `at end`, found `{tree}`"))
                );
            }
        }
        Ok(())
    }

    fn timed_effects(&self, tree: &Tree, found: &mut Vec<(When, Effect)>) -> Result<(), PddlError> {
        match (timed(tree), tree.headed()) {
            (Some((When::Throughout, _)), _) => {
                return Err(self.shape(tree, "an effect happens at the start or at the end, not over all"));
            }
            (Some((when, effect)), _) => {
                found.extend(self.effects(effect)?.into_iter().map(|effect| (when, effect)));
            }
            (None, None) if tree.is_empty() => {}
            (None, Some(("and", parts))) => {
                for part in parts {
                    self.timed_effects(part, found)?;
                }
            }
            (None, Some(("forall", [names, inner]))) => {
                let names = self.typed(names.list().unwrap_or_default())?;
                let mut inside = Vec::new();
                self.timed_effects(inner, &mut inside)?;
                found.extend(
                    inside
                        .into_iter()
                        .map(|(when, effect)| (when, Effect::Each(names.clone(), vec![effect]))),
                );
            }
            (None, Some(("when", _))) => return Err(self.unsupported(tree, "a conditional effect (`when`)")),
            (None, Some(("increase" | "decrease", _))) => {
                return Err(self.unsupported(tree, format!("the continuous effect `{tree}`")));
            }
            _ => return Err(self.shape(tree, format!("expected `at start` or `at end`, found `{tree}`"))),
        }
        Ok(())
    }

    fn effects(&self, tree: &Tree) -> Result<Vec<Effect>, PddlError> {
        let change = |fluent: &Tree, amount: &Tree| Ok((self.fluent(fluent)?, self.expr(amount)?));
        Ok(match tree.headed() {
            None if tree.is_empty() => Vec::new(),
            Some(("and", parts)) => {
                let mut all = Vec::new();
                for part in parts {
                    all.extend(self.effects(part)?);
                }
                all
            }
            Some(("not", [atom])) => vec![Effect::Set(self.application(atom)?, false)],
            Some(("increase", [fluent, amount])) => {
                let (fluent, amount) = change(fluent, amount)?;
                vec![Effect::Grow(fluent, amount)]
            }
            Some(("decrease", [fluent, amount])) => {
                let (fluent, amount) = change(fluent, amount)?;
                vec![Effect::Shrink(fluent, amount)]
            }
            Some(("forall", [names, inner])) => {
                vec![Effect::Each(self.typed(names.list().unwrap_or_default())?, self.effects(inner)?)]
            }
            Some(("when", _)) => return Err(self.unsupported(tree, "a conditional effect (`when`)")),
            Some((head @ ("assign" | "scale-up" | "scale-down"), _)) => {
                return Err(self.unsupported(tree, format!("the effect `{head}` on a number")));
            }
            _ => vec![Effect::Set(self.application(tree)?, true)],
        })
    }

    fn formula(&self, tree: &Tree) -> Result<Formula, PddlError> {
        let several =
            |parts: &[Tree]| parts.iter().map(|part| self.formula(part)).collect::<Result<Vec<_>, _>>();
        Ok(match tree.headed() {
            None if tree.is_empty() => Formula::And(Vec::new()),
            Some(("and", parts)) => Formula::And(several(parts)?),
            Some(("or", parts)) => Formula::Or(several(parts)?),
            Some(("not", [inner])) => Formula::Not(Box::new(self.formula(inner)?)),
            Some(("imply", [reason, result])) => {
                Formula::Or(vec![Formula::Not(Box::new(self.formula(reason)?)), self.formula(result)?])
            }
            Some((head @ ("forall" | "exists"), [names, inner])) => {
                let names = self.typed(names.list().unwrap_or_default())?;
                let inner = Box::new(self.formula(inner)?);
                if head == "forall" { Formula::Each(names, inner) } else { Formula::Any(names, inner) }
            }
            Some(("preference", _)) => return Err(self.unsupported(tree, "a preference")),
            Some((head, [left, right])) if Comparison::named(head).is_some() => {
                let is_term = |tree: &Tree| tree.word().is_some_and(|word| word.parse::<Rational>().is_err());
                match (Comparison::named(head), is_term(left) && is_term(right)) {
                    (Some(Comparison::Equal), true) => Formula::Same(left.to_string(), right.to_string()),
                    (Some(comparison), false) => {
                        Formula::Compare(comparison, self.expr(left)?, self.expr(right)?)
                    }
                    _ => return Err(self.shape(tree, format!("`{tree}` compares no numbers"))),
                }
            }
            _ => Formula::Atom(self.application(tree)?),
        })
    }

    fn expr(&self, tree: &Tree) -> Result<Expr, PddlError> {
        if let Some(word) = tree.word() {
            return match word {
                "?duration" => Ok(Expr::Duration),
                "total-time" => Ok(Expr::TotalTime),
                "#t" => Err(self.unsupported(tree, "a continuous effect (`#t`)")),
                _ => match word.parse() {
                    Ok(number) => Ok(Expr::Number(number)),
                    Err(_) => Ok(Expr::Fluent(vec![word.to_owned()])),
                },
            };
        }
        let several =
            |parts: &[Tree]| parts.iter().map(|part| self.expr(part)).collect::<Result<Vec<_>, _>>();
        Ok(match tree.headed() {
            Some(("+", parts)) => Expr::Sum(several(parts)?),
            Some(("*", parts)) => Expr::Product(several(parts)?),
            Some(("-", [one])) => {
                Expr::Difference(Box::new(Expr::Number(Rational::default())), Box::new(self.expr(one)?))
            }
            Some(("-", [left, right])) => {
                Expr::Difference(Box::new(self.expr(left)?), Box::new(self.expr(right)?))
            }
            Some(("/", [left, right])) => {
                Expr::Quotient(Box::new(self.expr(left)?), Box::new(self.expr(right)?))
            }
            Some(("total-time", [])) => Expr::TotalTime,
            Some(("is-violated", _)) => return Err(self.unsupported(tree, "a preference (`is-violated`)")),
            _ => Expr::Fluent(self.application(tree)?),
        })
    }

    /// `(fuel ?v)`, or a word alone, as early problems write it.
    fn fluent(&self, tree: &Tree) -> Result<Application, PddlError> {
        tree.word().map_or_else(|| self.application(tree), |word| Ok(vec![word.to_owned()]))
    }

    /// `(at ?r ?a)`
    fn application(&self, tree: &Tree) -> Result<Application, PddlError> {
        let words = tree.list().and_then(|list| list.iter().map(Tree::word).collect::<Option<Vec<_>>>());
        let words = words.filter(|words| !words.is_empty());
        let words =
            words.ok_or_else(|| self.shape(tree, format!("expected `(name term …)`, found `{tree}`")))?;
        Ok(words.into_iter().map(str::to_owned).collect())
    }

    /// `a b - t c`
    fn typed(&self, trees: &[Tree]) -> Result<Typed, PddlError> {
        let (mut all, mut untyped) = (Typed::new(), Vec::new());
        let mut trees = trees.iter();
        while let Some(tree) = trees.next() {
            let name =
                tree.word().ok_or_else(|| self.shape(tree, format!("expected a name, found `{tree}`")))?;
            if name != "-" {
                untyped.push(name.to_owned());
                continue;
            }
            let kind = trees.next().ok_or_else(|| self.shape(tree, "`-` lacks its type"))?;
            let kinds = match (kind.word(), kind.headed()) {
                (Some(word), _) => vec![word.to_owned()],
                (None, Some(("either", kinds))) => kinds.iter().map(Tree::to_string).collect(),
                _ => return Err(self.shape(kind, format!("expected a type, found `{kind}`"))),
            };
            all.extend(untyped.drain(..).map(|name| (name, kinds.clone())));
        }
        all.extend(untyped.into_iter().map(|name| (name, vec![super::names::OBJECT.to_owned()])));
        Ok(all)
    }
}

/// `at start`, `over all` or `at end`, and what follows.
fn timed(tree: &Tree) -> Option<(When, &Tree)> {
    let (head, [when, rest]) = tree.headed()? else { return None };
    let when = match (head, when.word()?) {
        ("at", "start") => When::Start,
        ("over", "all") => When::Throughout,
        ("at", "end") => When::End,
        _ => return None,
    };
    Some((when, rest))
}
