//! Flight rules over time: when a plan is held against each, and when some execution breaks it.

use smol_str::SmolStr;

use super::row::{Item, RowKind};

/// A rule with its stretches of time.
#[derive(Clone, Debug, PartialEq)]
pub struct RuleTrack {
    /// What it is called.
    pub name: SmolStr,
    /// How the plan stands to it, in a sentence.
    pub words: String,
    /// Its stretches, those that matter most last.
    pub bands: Vec<RuleBand>,
}

/// A stretch of time of a rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RuleBand {
    /// From when to when, in mission units; the end may be infinite.
    pub times: [f64; 2],
    /// The status of the rule there.
    pub standing: RuleStanding,
}

/// How a plan stands to a rule for some time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RuleStanding {
    /// It is held against the rule.
    Applies,
    /// The rule is not sure to hold in every execution.
    Open,
    /// Some execution breaks it.
    Broken,
}

/// A row for each rule, below a heading; nothing without any.
pub(super) fn items(rules: &[RuleTrack]) -> Vec<Item> {
    let rows = rules.iter().enumerate().map(|(index, rule)| Item {
        kind: RowKind::Rule(index),
        name: rule.name.clone(),
        key: None,
        depth: 1,
        bars: Vec::new(),
    });
    let heading = Item {
        kind: RowKind::Heading,
        name: SmolStr::new_static("Flight rules"),
        key: Some(SmolStr::new_static("rules")),
        depth: 0,
        bars: Vec::new(),
    };
    let heading = (!rules.is_empty()).then_some(heading);
    heading.into_iter().chain(rows).collect()
}
