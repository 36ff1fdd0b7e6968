//! What vehicles see: the places from which a location that a condition is about is hidden (SPEC 10.5).
//!
//! The conditions themselves are sets of values, like any other; this says where the sets come from.

use rmpl::program::LabelMode;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::network::{Label, Literal, Network, ValueSet, VariableId};

/// From which places a vehicle does not see a location; it sees it from all others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sight {
    /// The place of the vehicle, `V.at`.
    pub variable: VariableId,
    pub location: SmolStr,
    /// In the order of the locations.
    pub hidden: Vec<Hidden>,
}

/// A place from which a location is hidden.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hidden {
    pub place: SmolStr,
    /// Where the ground first rises over the line from the vehicle to the location, in meters east, north and up;
    /// `None` if the height of one of the ends is not known.
    pub blocked_at_m: Option<[f64; 3]>,
}

impl Hidden {
    /// Returns why the location is not in sight from the place.
    pub fn reason(&self) -> String {
        match self.blocked_at_m {
            Some([east, north, _]) => {
                format!(
                    "from {} the ground near ({east:.0}, {north:.0}) blocks the line of sight",
                    self.place
                )
            }
            None => {
                format!("from {} the map has too little height data to decide the line of sight", self.place)
            }
        }
    }
}

/// How many places an explanation names.
const MAX_REASONS: usize = 3;

/// A condition on what is in sight, as the language writes it.
pub fn sight_text(variable: &str, location: &str) -> String {
    format!("{variable} in visible({location})")
}

impl Network {
    /// Returns what decides about a label, if it is about what is in sight.
    pub fn sight(&self, label: &Label) -> Option<&Sight> {
        let text = label.text.strip_prefix("not(").map_or(label.text.as_str(), |text| {
            // The closing parenthesis of `visible(…)` stays.
            text.strip_suffix(')').unwrap_or(text)
        });
        self.sights.iter().find(|sight| {
            sight.variable == label.literal.variable
                && text == sight_text(&self.variables[sight.variable.index()].name, &sight.location)
        })
    }

    /// Returns why a location is not in sight from the places to which `changes` take the vehicle of an Ask: three
    /// reasons at most.
    pub fn unseen<'a>(&self, ask: &Label, changes: impl Iterator<Item = &'a Label>) -> Vec<String> {
        let Some(sight) = self.sight(ask).filter(|_| !ask.text.starts_with("not(")) else {
            return Vec::new();
        };
        let is_of = |label: &&'a Label| {
            label.mode == LabelMode::Tell && label.literal.variable == ask.literal.variable
        };
        let told: Vec<&str> =
            changes.filter(is_of).flat_map(|label| self.value_names(&label.literal)).collect();
        let hidden = sight.hidden.iter().filter(|hidden| told.contains(&hidden.place.as_str()));
        hidden.take(MAX_REASONS).map(Hidden::reason).collect()
    }

    /// The values of a literal by name.
    pub fn value_names(&self, literal: &Literal) -> Vec<&str> {
        let variable = &self.variables[literal.variable.index()];
        let name = |value: &crate::network::ValueId| variable.values[value.index()].as_str();
        match &literal.values {
            ValueSet::In(values) | ValueSet::NotIn(values) => values.iter().map(name).collect(),
        }
    }

    /// The places from which a vehicle sees a location.
    pub fn seen_from(&self, sight: &Sight) -> Vec<SmolStr> {
        let places = &self.variables[sight.variable.index()].values;
        let is_seen = |place: &&SmolStr| sight.hidden.iter().all(|hidden| hidden.place != **place);
        places.iter().filter(is_seen).cloned().collect()
    }
}
