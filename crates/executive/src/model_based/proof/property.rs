//! What is to be proven: its text, and the conditions in it.

use std::fmt;

use plant::{Formula, Model};
use rmpl::control::{Constraint, ConstraintKind, Duration, nearest};
use smol_str::SmolStr;

use crate::model_based::System;

/// A condition on the true state of a plant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Condition {
    /// As it was written.
    pub text: SmolStr,
    pub(super) formula: Formula,
    pub(super) opposite: Formula,
}

/// What runs of a program have to do, if not for ever then within some steps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Property {
    /// The condition holds after each step, and before the first.
    Always(Condition),
    /// The condition holds at no time.
    Never(Condition),
    /// The condition comes to hold.
    Eventually { condition: Condition, within: Option<u32> },
    /// Whenever the first condition holds, the second holds then or later.
    LeadsTo { from: Condition, to: Condition, within: Option<u32> },
    /// The program ends.
    Ends { within: Option<u32> },
    /// The goals that are asserted at one time can be achieved together.
    GoalsAgree,
    /// Each location becomes active in some run.
    AllReached,
    /// What a WHEN-DONEXT or WHENEVER-DONEXT waits for becomes true in some run.
    AllGuardsHold,
    /// Locks do not wait for each other for ever.
    NoDeadlock,
}

/// The properties that every program should have.
pub const DEFAULTS: [Property; 5] = [
    Property::Ends { within: None },
    Property::GoalsAgree,
    Property::AllGuardsHold,
    Property::AllReached,
    Property::NoDeadlock,
];

impl Property {
    /// Reads `always C`, `never C`, `eventually C`, `C leads to D` or `ends`; the last three also with `within 20 steps` or
    /// `within 5 s` behind. C and D are conditions of the plant as in control programs. The error says what is wrong.
    pub fn read(text: &str, system: &System) -> Result<Self, String> {
        let text = text.trim();
        let (text, within) = match text.rsplit_once(" within ") {
            Some((text, duration)) => (text.trim_end(), Some(steps(duration, system)?)),
            None => (text, None),
        };
        let condition = |text: &str| Condition::read(text, &system.model);
        let property = if text == "ends" {
            Self::Ends { within }
        } else if let Some(rest) = text.strip_prefix("always ") {
            Self::Always(condition(rest)?)
        } else if let Some(rest) = text.strip_prefix("never ") {
            Self::Never(condition(rest)?)
        } else if let Some(rest) = text.strip_prefix("eventually ") {
            Self::Eventually { condition: condition(rest)?, within }
        } else if let Some((from, to)) = text.split_once(" leads to ") {
            Self::LeadsTo { from: condition(from)?, to: condition(to)?, within }
        } else {
            return Err(format!(
                "expected `always C`, `never C`, `eventually C`, `C leads to D` or `ends`, found `{text}`"
            ));
        };
        match property {
            Self::Always(_) | Self::Never(_) if within.is_some() => {
                Err("`always` and `never` hold for the whole run: remove `within`".to_owned())
            }
            property => Ok(property),
        }
    }

    /// The conditions in it.
    pub(super) fn conditions(&self) -> Vec<&Condition> {
        match self {
            Self::Always(condition) | Self::Never(condition) | Self::Eventually { condition, .. } => {
                vec![condition]
            }
            Self::LeadsTo { from, to, .. } => vec![from, to],
            _ => Vec::new(),
        }
    }
}

fn steps(text: &str, system: &System) -> Result<u32, String> {
    let text = text.trim();
    let amount = text.strip_suffix("steps").or_else(|| text.strip_suffix("step")).map_or(text, str::trim_end);
    let duration = Duration::read(amount);
    let steps = duration.ok().and_then(|duration| duration.steps(system.step_secs));
    let steps = steps.and_then(|steps| u32::try_from(steps).ok()).filter(|steps| *steps > 0);
    steps.ok_or_else(|| format!("`within` needs a time, such as `20 steps` or `5 s`, not `{text}`"))
}

impl Condition {
    fn read(text: &str, model: &Model) -> Result<Self, String> {
        let text = text.trim();
        let parsed = rmpl::control::parse(&format!("Q ():: (WHEN-DONEXT ({text}) true)"));
        if let Some(problem) = parsed.diagnostics.first() {
            return Err(format!("`{text}` is not a condition: {}", problem.message));
        }
        let body = parsed.file.main().map(|main| &main.body);
        let guard = body.and_then(|body| body.guard());
        let guard = guard.ok_or_else(|| format!("`{text}` is not a condition"))?;
        if guard.non_entailed || guard.held.is_some() {
            return Err(format!("`{text}` is not a condition of one state: remove `~` or HELD"));
        }
        let formula = formula(&guard.constraint, model)?;
        Ok(Self { text: text.into(), opposite: model.opposite(formula.clone()), formula })
    }
}

fn formula(constraint: &Constraint, model: &Model) -> Result<Formula, String> {
    let all = |parts: &[Constraint]| parts.iter().map(|part| formula(part, model)).collect::<Result<_, _>>();
    Ok(match &constraint.kind {
        ConstraintKind::True => Formula::Constant(true),
        ConstraintKind::False => Formula::Constant(false),
        ConstraintKind::Not(inner) => model.opposite(formula(inner, model)?),
        ConstraintKind::And(parts) => Formula::All(all(parts)?),
        ConstraintKind::Or(parts) => Formula::Any(all(parts)?),
        ConstraintKind::Equals { variable, value } => {
            return equality(&variable.text, &value.text, model);
        }
        ConstraintKind::Parameter(name) => {
            return Err(format!("`{}` is not a condition: write `component = mode`", name.text));
        }
        ConstraintKind::Unreadable => return Err("this is not a condition".to_owned()),
    })
}

fn equality(variable: &str, value: &str, model: &Model) -> Result<Formula, String> {
    if model.component_named(variable).is_some() {
        return model
            .component_mode(variable, value)
            .map(|(component, mode)| Model::mode_is(component, mode));
    }
    let id = model.variable_named(variable).ok_or_else(|| {
        let components = model.components.iter().map(|component| component.name.as_str());
        let known = components.chain(model.variables.iter().map(|variable| variable.name.as_str()));
        let meant =
            nearest(variable, known).map_or_else(String::new, |name| format!("; did you mean `{name}`?"));
        format!("the plant has no component or variable `{variable}`{meant}")
    })?;
    let values = model.variables.get(id.0 as usize).map_or(&[][..], |data| data.values.as_slice());
    let number = values.iter().position(|known| known == value).ok_or_else(|| {
        let known: Vec<&str> = values.iter().map(SmolStr::as_str).collect();
        format!("`{variable}` has no value `{value}`: its values are {}", known.join(", "))
    })?;
    Ok(model.value_is(id, number as u8))
}

impl fmt::Display for Property {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let limit = |within: &Option<u32>| {
            within.map_or_else(String::new, |steps| {
                format!(" within {steps} step{}", if steps == 1 { "" } else { "s" })
            })
        };
        match self {
            Self::Always(condition) => write!(f, "always {}", condition.text),
            Self::Never(condition) => write!(f, "never {}", condition.text),
            Self::Eventually { condition, within } => {
                write!(f, "eventually {}{}", condition.text, limit(within))
            }
            Self::LeadsTo { from, to, within } => {
                write!(f, "{} leads to {}{}", from.text, to.text, limit(within))
            }
            Self::Ends { within } => write!(f, "the program ends{}", limit(within)),
            Self::GoalsAgree => f.write_str("goals are always consistent"),
            Self::AllReached => f.write_str("every location can become active"),
            Self::AllGuardsHold => f.write_str("every condition that the program waits for can become true"),
            Self::NoDeadlock => f.write_str("locks do not deadlock"),
        }
    }
}
