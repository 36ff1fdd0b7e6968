//! Which part of the language something in a text belongs to: where a manual tells about it.

use super::hover::is_state;
use super::name::{NameKind, NameUse};
use crate::parse::Parse;
use crate::syntax::SyntaxKind;

/// A part of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// What declares activities, scenarios and constants.
    Declarations,
    /// Options of the planner.
    Options,
    /// Sequences, parallel branches, choices, delays and the like.
    Statements,
    /// What is asserted and what is required.
    Conditions,
    /// Variables that keep their values.
    States,
    /// What activities use, consume and produce.
    Resources,
    /// Activities that execution may end.
    EarlyEnds,
    /// What plans are to be best in.
    Objectives,
    /// The least and the greatest time.
    Bounds,
    /// Bounds between events of different threads.
    ThreadBounds,
    /// Missions of several files.
    Files,
    /// Durations that the environment chooses.
    Nature,
    /// Parameters and arguments.
    Parameters,
    /// Maps, places, obstacles and vehicles.
    World,
    /// Activities that run control programs.
    Programs,
}

impl Topic {
    /// Every topic, in the order of the reference.
    pub const ALL: [Self; 15] = [
        Self::Declarations,
        Self::Options,
        Self::Statements,
        Self::Conditions,
        Self::States,
        Self::Resources,
        Self::EarlyEnds,
        Self::Objectives,
        Self::Bounds,
        Self::ThreadBounds,
        Self::Files,
        Self::Nature,
        Self::Parameters,
        Self::World,
        Self::Programs,
    ];

    /// Returns what a name is about.
    pub(super) fn of_name(parse: &Parse, name: &NameUse) -> Self {
        match &name.kind {
            NameKind::Activity | NameKind::Scenario | NameKind::Constant => Self::Declarations,
            NameKind::Variable if is_state(parse, &name.text) => Self::States,
            NameKind::Value(variable) if is_state(parse, variable) => Self::States,
            NameKind::Variable | NameKind::Value(_) => Self::Conditions,
            NameKind::Parameter | NameKind::Symbol => Self::Parameters,
            NameKind::BoundName => Self::Bounds,
            NameKind::Location
            | NameKind::Obstacle
            | NameKind::Vehicle
            | NameKind::Model
            | NameKind::Group
            | NameKind::Equipment => Self::World,
            NameKind::Resource => Self::Resources,
            NameKind::Occurrence => Self::ThreadBounds,
            NameKind::Option | NameKind::OptionValue => Self::Options,
            NameKind::ControlProgram => Self::Programs,
        }
    }

    /// Returns what a keyword, or a word that is one in its place, is about.
    pub(super) fn of_word(kind: SyntaxKind, word: &str) -> Self {
        match kind {
            SyntaxKind::MaintainingKeyword
            | SyntaxKind::WatchingKeyword
            | SyntaxKind::IfKeyword
            | SyntaxKind::ThennextKeyword
            | SyntaxKind::NotKeyword
            | SyntaxKind::Bang
            | SyntaxKind::TellKeyword
            | SyntaxKind::AskKeyword
            | SyntaxKind::VarKeyword => return Self::Conditions,
            SyntaxKind::PrimitiveKeyword | SyntaxKind::ScenarioKeyword => return Self::Declarations,
            SyntaxKind::OptionKeyword => return Self::Options,
            SyntaxKind::Infinity => return Self::Bounds,
            _ => {}
        }
        match word {
            "const" => Self::Declarations,
            "state" | "requires" | "sets" | "start" => Self::States,
            "resource" | "capacity" | "uses" | "consumes" | "produces" | "per" | "using" => Self::Resources,
            "objective" | "minimize" | "maximize" | "cost" | "reward" | "end" | "length" | "costs"
            | "rewards" => Self::Objectives,
            "aborts" => Self::EarlyEnds,
            "else" | "and" | "or" | "in" | "visible" => Self::Conditions,
            "s" | "min" | "h" | "d" | "sol" => Self::Bounds,
            "as" | "constrain" | "to" => Self::ThreadBounds,
            "import" => Self::Files,
            "at" | "moves" | "speed" | "kinodynamic" | "cell" | "origin" | "model" | "extends" | "group"
            | "body" | "slope" | "clearance" | "turning" | "mast" | "flies" => Self::World,
            "runs" | "mode" | "from" | "plant" => Self::Programs,
            _ => Self::Statements,
        }
    }
}
