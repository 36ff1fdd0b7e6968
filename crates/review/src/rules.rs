//! Flight rules: what a review holds a plan against, in one place that people see and change (SPEC 16).
//!
//! A rule that is not there is not applied. What the independent checker examines holds whatever the rules say.

use std::collections::BTreeMap;

use exact::{Rational, Time};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use smol_str::SmolStr;

use super::flight_rule::MissionRule;
use super::keys::PublicKey;
use super::sealed::Sealed;
use super::seat::{self, Seat};
use super::strict;

/// The thresholds of a review.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FlightRules {
    /// How long a condition outlasts what needs it, and how far apart is what must not overlap, in every schedule; in
    /// mission units. At 0 anything above 0 will do.
    pub margin: Option<Time>,
    /// How far the rim of a vehicle stays from obstacles, in meters.
    pub clearance_m: Option<f64>,
    /// The steepest slope on a way, in degrees.
    pub slope_deg: Option<f64>,
    /// What is left of every resource, in every schedule. At 0 anything above 0 will do.
    pub reserve: Option<Rational>,
    /// What is left of single resources, by their names, instead.
    pub reserves: BTreeMap<SmolStr, Rational>,
    /// How many of the runs with chance reach the end.
    pub success_rate: Option<SuccessRate>,
    /// What the mission has to keep to besides, in its own language.
    pub rules: Vec<MissionRule>,
    /// Who has to approve.
    pub board: Vec<Seat>,
}

/// The share of runs that is asked for, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SuccessRate {
    /// Less than this needs attention.
    pub wanted: f64,
    /// Less than this is a failure.
    pub least: f64,
}

/// How many rules of its own a mission has.
const MAX_RULES: usize = 200;

/// The format of a document of flight rules.
pub const RULES_FORMAT: &str = "enroute-rules/1";

impl Default for FlightRules {
    fn default() -> Self {
        Self {
            margin: Some(Time::ZERO),
            clearance_m: Some(0.25),
            slope_deg: Some(15.0),
            reserve: Some(Rational::ZERO),
            reserves: BTreeMap::new(),
            success_rate: Some(SuccessRate { wanted: 0.95, least: 0.8 }),
            rules: Vec::new(),
            board: seat::default_board(),
        }
    }
}

impl FlightRules {
    /// Returns what is wrong with the figures, if something is.
    pub fn problem(&self) -> Option<&'static str> {
        let is_length = |length: Option<f64>| length.is_none_or(|it| it.is_finite() && it >= 0.0);
        let is_share = |share: f64| (0.0..=1.0).contains(&share);
        let mut reserves = self.reserves.values().chain(&self.reserve);
        match self.success_rate {
            _ if self.margin.is_some_and(Time::is_negative) => Some("a margin must not be negative"),
            _ if !is_length(self.clearance_m) => Some("a clearance must not be negative"),
            _ if !is_length(self.slope_deg) => Some("a slope must not be negative"),
            _ if reserves.any(|it| it.is_negative()) => Some("a reserve must not be negative"),
            Some(rate) if !is_share(rate.wanted) || !is_share(rate.least) => {
                Some("a success rate must be from 0 to 1")
            }
            Some(rate) if rate.least > rate.wanted => {
                Some("the failure threshold must not exceed the target success rate")
            }
            _ => self.problem_of_rules().or_else(|| seat::problem(&self.board)),
        }
    }

    fn problem_of_rules(&self) -> Option<&'static str> {
        let mut names: Vec<&str> = self.rules.iter().map(|rule| rule.name.trim()).collect();
        names.sort_unstable();
        if names.len() > MAX_RULES {
            return Some("at most 200 mission rules are allowed");
        }
        if names.first().is_some_and(|name| name.is_empty()) {
            return Some("every mission rule needs a name");
        }
        if names.windows(2).any(|pair| pair[0] == pair[1]) {
            return Some("mission rules must have different names");
        }
        self.rules.iter().any(|it| it.rule.trim().is_empty()).then_some("a mission rule must not be empty")
    }

    /// Reads a document `{"format": "enroute-rules/1", …}`; what it does not name is as by default, and `null` is not a rule.
    pub fn from_json(text: &str) -> Result<Self, String> {
        Self::from_members(Value::Object(members(text)?))
    }

    fn from_members(members: Value) -> Result<Self, String> {
        let rules: Self = serde_json::from_value(members).map_err(|error| error.to_string())?;
        rules.problem().map_or(Ok(rules), |problem| Err(problem.to_owned()))
    }

    /// The SHA-256 of the rules in hexadecimal, those of the board among them.
    pub fn digest(&self) -> String {
        Sealed::new(self.clone()).digest().to_owned()
    }

    /// The document, on several lines.
    pub fn to_json(&self) -> String {
        let mut value = serde_json::to_value(self).unwrap_or_default();
        value["format"] = RULES_FORMAT.into();
        let mut text = serde_json::to_string_pretty(&value).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Returns where a rule comes from, for people.
    pub(super) fn source(is_default: impl Fn(&Self) -> bool) -> &'static str {
        if is_default(&Self::default()) { "flight rules, by default" } else { "flight rules of this mission" }
    }

    /// Returns who has to approve, in words: `2 Science, 1 Mobility (of ab12 cd34 ef56 7890)`.
    pub fn board_in_words(&self) -> String {
        let seats = self.board.iter().map(|seat| {
            let people: Vec<String> = seat.people.iter().map(PublicKey::fingerprint).collect();
            let of = if people.is_empty() { String::new() } else { format!(" (of {})", people.join(", ")) };
            format!("{} {}{of}", seat.approvals, seat.role)
        });
        seats.collect::<Vec<_>>().join(", ")
    }

    /// Each rule in words.
    pub fn in_words(&self, unit: &str) -> Vec<String> {
        let mut words = vec![match self.margin {
            None => "margins are not checked".to_owned(),
            Some(margin) => {
                format!("margins must be {}", at_least(&margin.readable(), margin.is_positive(), unit))
            }
        }];
        words.push(match self.clearance_m {
            None => "clearance is not checked".to_owned(),
            Some(clearance_m) => format!("clearance must be at least {clearance_m} m"),
        });
        words.push(match self.slope_deg {
            None => "slopes must be within the vehicle limits".to_owned(),
            Some(slope_deg) => format!("slopes must be at most {slope_deg}°"),
        });
        words.push(match self.reserve {
            None => "reserves are not checked".to_owned(),
            Some(reserve) => {
                format!(
                    "the reserve of each resource must be {}",
                    at_least(&reserve.readable(), reserve.is_positive(), "")
                )
            }
        });
        words.extend(self.reserves.iter().map(|(name, reserve)| {
            format!(
                "the reserve of {name} must be {}",
                at_least(&reserve.readable(), reserve.is_positive(), "")
            )
        }));
        words.push(match self.success_rate {
            None => "success rates are not checked".to_owned(),
            Some(rate) => format!(
                "at least {} of the Monte Carlo runs must reach the end; less than {} is a failure",
                percent(rate.wanted),
                percent(rate.least)
            ),
        });
        words.extend(self.rules.iter().map(|rule| {
            let source = if rule.source.is_empty() { String::new() } else { format!(" ({})", rule.source) };
            let waivable = if rule.waivable { ", may be waived" } else { "" };
            format!("{}: {}{source}{waivable}", rule.name, rule.rule)
        }));
        words.push(format!("required approvals: {}", self.board_in_words()));
        words
    }
}

/// The members of a document of flight rules, without its format.
fn members(text: &str) -> Result<Map<String, Value>, String> {
    let value = strict::from_str(text).map_err(|error| error.to_string())?;
    let Value::Object(mut members) = value else {
        return Err(format!("this is not a flight rules file: \"format\" must be \"{RULES_FORMAT}\""));
    };
    match members.remove("format") {
        Some(format) if format == RULES_FORMAT => Ok(members),
        Some(format) => Err(format!("its format is {format}, but must be \"{RULES_FORMAT}\"")),
        None => Err(format!("this is not a flight rules file: \"format\" must be \"{RULES_FORMAT}\"")),
    }
}

/// The flight rules that a history has to have: those that a document names.
#[derive(Clone, Debug)]
pub struct RequiredRules {
    rules: FlightRules,
    names: Vec<String>,
}

impl RequiredRules {
    /// Reads a document as [`FlightRules::from_json`] does; what it does not name is not required.
    pub fn from_json(text: &str) -> Result<Self, String> {
        let members = members(text)?;
        let names: Vec<String> = members.keys().cloned().collect();
        if names.is_empty() {
            return Err("it names no rules".to_owned());
        }
        Ok(Self { rules: FlightRules::from_members(Value::Object(members))?, names })
    }

    /// Returns whether it says who must approve.
    pub fn names_board(&self) -> bool {
        self.names.iter().any(|name| name == "board")
    }

    /// The names of the rules that are others than required: `board`, `slope_deg`.
    pub fn differences(&self, rules: &FlightRules) -> Vec<&str> {
        let of = |rules: &FlightRules| serde_json::to_value(rules).unwrap_or_default();
        let (required, present) = (of(&self.rules), of(rules));
        let names = self.names.iter().map(String::as_str);
        names.filter(|&name| required[name] != present[name]).collect()
    }
}

pub(super) fn at_least(amount: &str, is_positive: bool, unit: &str) -> String {
    let what = if is_positive { format!("at least {amount}") } else { "more than 0".to_owned() };
    format!("{what} {unit}").trim_end().to_owned()
}

/// A share as people read it.
pub(super) fn percent(share: f64) -> String {
    let percent = format!("{:.1}", share * 100.0);
    format!("{} %", percent.strip_suffix(".0").unwrap_or(&percent))
}
