//! Searches for the path of one leg by planners of the asker's choice, sample by sample: one alone, or several that race.

use motion::{GrowthStep, PlannerKind};
use nalgebra::Point2;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;
use snapshot::ContentKey;

use crate::Update;

/// Searches that are wanted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathGrowth {
    pub update: Update,
    /// The name of the traverse.
    pub traverse: SmolStr,
    /// Its leg, from 0.
    pub leg: u32,
    /// Who searches. Several draw their samples in turn, on the same ground between the same ends.
    pub planners: Vec<WantedPlanner>,
}

/// A planner that is to search.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WantedPlanner {
    pub planner: PlannerKind,
    /// The search that the asker holds samples of.
    pub held_search: ContentKey,
    /// How many of its samples the asker holds, from the first.
    pub held: u32,
}

/// A search as far as it has come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GrowthStanding {
    /// The revision of the text.
    pub revision: u64,
    /// The name of the traverse.
    pub traverse: SmolStr,
    /// Its leg, from 0.
    pub leg: u32,
    pub planner: PlannerKind,
    pub search: ContentKey,
    /// Where its trees begin, in meters.
    pub roots_m: Vec<Point2<f64>>,
    /// The number of the first of these samples, from 0; the asker holds those before.
    pub first: u32,
    /// What the samples from there on did.
    pub steps: Vec<GrowthStep>,
    /// Milliseconds that the search has taken by now, with what it takes to record it.
    pub elapsed_millis: f64,
    /// Whether these are all; otherwise more will come.
    pub is_complete: bool,
    /// Why there is no search.
    pub refusal: Option<String>,
}

/// Samples after which a search that finds nothing is given up.
pub const MAX_SAMPLES: u32 = 20_000;
