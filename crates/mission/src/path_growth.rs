//! The search for the path of one leg by a planner of the asker's choice, sample by sample.

use motion::{GrowthStep, PlannerKind};
use nalgebra::Point2;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::content::ContentKey;
use crate::request::Update;

/// A search that is wanted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathGrowth {
    /// The mission.
    pub update: Update,
    /// The name of the traverse.
    pub traverse: SmolStr,
    /// Its leg, from 0.
    pub leg: u32,
    /// Who searches.
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
    /// Who searches.
    pub planner: PlannerKind,
    /// The search.
    pub search: ContentKey,
    /// Where its trees begin, in metres.
    pub roots_m: Vec<Point2<f64>>,
    /// The number of the first of these samples, from 0; the asker holds those before.
    pub first: u32,
    /// What the samples from there on did.
    pub steps: Vec<GrowthStep>,
    /// Whether these are all; otherwise more will come.
    pub is_complete: bool,
    /// Why there is no search.
    pub refusal: Option<String>,
}

/// Samples after which a search that finds nothing is given up.
pub const MAX_SAMPLES: u32 = 20_000;
