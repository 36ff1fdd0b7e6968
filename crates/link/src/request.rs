//! What the core is asked, and what it answers; both cross to a worker as bytes.

use std::sync::Arc;

use review::contradict::{Effort, Tried};
use review::flight_rule::proof::Proven;
use review::record::LineKey;
use review::{MissionRule, Review};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;
use snapshot::Execution;
use snapshot::{Goal, MapKey, Snapshot};
use snapshot::{RobustnessSettings, Tally};

use crate::BothSearches;
use crate::Source;
use crate::{ControlRun, ControlStanding};
use crate::{GrowthStanding, PathGrowth};
use crate::{ProgramChance, ProofAnswer, ProofQuestion};

/// Something that the core is asked to compute.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Request {
    /// Compile and plan a text; a later one supersedes an earlier one that is still under way.
    Update(Update),
    /// Execute the plan of a text in the simulated world.
    Execute {
        /// The text and how it is planned.
        update: Update,
        /// What goes otherwise than planned.
        #[serde(with = "snapshot::json_text")]
        script: executive::Script,
    },
    /// Execute the plan of a text many times, with chance: the runs from one number on. The answer says how far it got.
    Sample {
        /// The text and how it is planned.
        update: Update,
        /// What is left to chance.
        settings: RobustnessSettings,
        /// The first run, from 0.
        from: u64,
    },
    /// Run a control program many times, its components failing by chance: the runs from one number on. The answer says
    /// how far it got.
    SampleProgram {
        /// The revision of the text.
        revision: u64,
        source: Source,
        /// What the runs are.
        chance: ProgramChance,
        /// The first run, from 0.
        from: u64,
    },
    /// Find out what holds in all runs of a control program. The answer says how far it got.
    ProveProgram {
        /// The revision of the text.
        revision: u64,
        source: Source,
        /// What is to be proven.
        question: ProofQuestion,
        /// How many states were found before; 0 starts again.
        from: usize,
    },
    /// Review the plan of a text: see [`review`].
    Review {
        /// The text and how it is planned.
        update: Update,
        /// The rules of the mission to hold the plan against.
        rules: Vec<MissionRule>,
    },
    /// Look for counterexamples of what has passed in the review of the plan of a text: the schedules and runs from one number
    /// on. The answer says how far it got.
    Contradict {
        /// The text and how it is planned.
        update: Update,
        /// Its review, held against its rules.
        review: Arc<Review>,
        /// The one line that is tried; otherwise all that have passed.
        only: Option<LineKey>,
        /// How much is tried.
        effort: Effort,
        /// How many schedules and runs have been tried.
        from: u64,
    },
    /// Find out whether a flight rule holds in every plan of a text: see [`review::flight_rule::proof`].
    ProveRule {
        /// The text and how it is planned.
        update: Update,
        rule: MissionRule,
        /// How many alternatives the planner tries.
        alternatives: u64,
    },
    /// Plan another text than the open one, to compare with: answered once, when it is done.
    Evaluate {
        /// Comes back with the answer.
        token: u64,
        /// The other text.
        update: Update,
    },
    /// Makes a map file available to `terrain "name"` declarations.
    ImportMap {
        /// The name that the declaration uses.
        name: SmolStr,
        bytes: Vec<u8>,
    },
    /// Searches the network of a text in both ways, recorded and measured, for showing side by side.
    CompareSearches(Update),
    /// Run a control program: see [`crate::control_run`].
    RunControl(ControlRun),
    /// Search for a path, sample by sample: see [`crate::path_growth`].
    GrowPath(PathGrowth),
}

/// A text to compile and plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Update {
    /// Counts the edits of the text; every answer says which revision it belongs to.
    pub revision: u64,
    pub source: Source,
    pub goal: Goal,
    /// How to search for the plan.
    pub search: kirk::Search,
    /// Seeds path planning.
    pub seed: u64,
    /// Which search to record for stepping through it, if any.
    pub trace: Option<kirk::Search>,
}

impl Update {
    /// A text whose default goal is planned, with the usual search and the seed 0.
    pub fn new(revision: u64, source: impl Into<Source>) -> Self {
        Self {
            revision,
            source: source.into(),
            goal: Goal::Default,
            search: kirk::Search::default(),
            seed: 0,
            trace: None,
        }
    }
}

/// An answer of the core.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Response {
    /// The state of a revision; a revision is answered more than once as its stages complete.
    Snapshot(Arc<Snapshot>),
    /// The review of a revision.
    Review {
        /// The revision of the text.
        revision: u64,
        /// What was found.
        review: Arc<Review>,
    },
    /// How far the lines of a review were tried.
    Contradicted {
        /// The revision of the text.
        revision: u64,
        /// The one line that is tried.
        only: Option<LineKey>,
        /// How many schedules and runs have been tried, and how many are to be.
        progress: [u64; 2],
        /// The lines so far; or why they cannot be tried.
        tried: Result<Vec<Tried>, String>,
    },
    /// What was found of a flight rule.
    RuleProven {
        /// The revision of the text.
        revision: u64,
        /// What the rule says.
        rule: String,
        /// How many alternatives the planner was to try.
        alternatives: u64,
        /// What was found; or why it cannot be proven.
        proven: Result<Proven, String>,
    },
    /// Another text, planned.
    Evaluated {
        /// That of the request.
        token: u64,
        /// The other text's last snapshot.
        snapshot: Arc<Snapshot>,
    },
    /// The ground of the missions that name `key`; sent once, before the first snapshot that refers to it.
    Map { key: MapKey, map: Arc<terrain::Terrain> },
    /// A run of a mission.
    Execution(Arc<Execution>),
    /// A mission cannot be executed.
    NotExecuted {
        /// The revision of its text.
        revision: u64,
        reason: String,
    },
    /// Some of many runs of a mission.
    Sampled {
        /// The revision of its text.
        revision: u64,
        /// What was left to chance.
        settings: Box<RobustnessSettings>,
        /// The first of these runs.
        from: u64,
        /// How they went; as many as there was time for, at least one.
        tally: Tally,
    },
    /// Some of many runs of a control program.
    ProgramSampled {
        /// The revision of its text.
        revision: u64,
        /// What the runs are.
        chance: ProgramChance,
        /// The first of these runs.
        from: u64,
        /// How they went, as many as there was time for, at least one; or why there can be none.
        tally: Result<executive::model_based::ProgramTally, String>,
    },
    /// How far a proof about a control program is.
    ProgramProven {
        /// The revision of its text.
        revision: u64,
        /// What is to be proven.
        question: ProofQuestion,
        /// How many states were found.
        states: usize,
        /// What was found once all is explored, or why there can be no proof.
        answer: Option<Result<ProofAnswer, String>>,
    },
    /// How a control program's run stands.
    ControlRun(Box<ControlStanding>),
    /// How far the search for a path has come.
    PathGrowth(Box<GrowthStanding>),
    /// The two searches of a revision.
    Searches(Arc<BothSearches>),
    /// A map file was read; texts that name it find it from now on.
    MapAccepted {
        /// The name it has.
        name: SmolStr,
        /// Columns and rows.
        cells: [u32; 2],
        /// How many cells have no data.
        no_data_cells: u64,
    },
    /// A map file could not be read.
    MapRejected {
        /// The name it was to have.
        name: SmolStr,
        /// Why, for the person who chose the file.
        reason: String,
    },
    /// A file held places and obstacles instead of a map (`GeoJSON`).
    PlacesRead {
        /// The name of the file.
        name: SmolStr,
        /// Declarations in the language.
        lines: String,
    },
}
