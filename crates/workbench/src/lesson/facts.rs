//! What lessons can know of the live state, by name.
//!
//! Each fact says what it means in a sentence; `docs/lessons.md` lists them, which a test holds it to. What a fact comes
//! to is read from the description of the state.

use super::expression::Value;

/// Something that is known of the state.
#[derive(Debug, PartialEq, Eq)]
pub struct Fact {
    pub name: &'static str,
    pub of: Of,
    /// What it is, in a sentence without its full stop.
    pub meaning: &'static str,
}

/// What a fact is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// The state as a whole.
    Nothing,
    /// Something that is in parentheses.
    Something(&'static str),
    /// The state as a whole, or something in parentheses.
    Maybe(&'static str),
}

/// Gives the values of facts.
pub trait Known {
    /// Returns what a fact is now, of what is in its parentheses; nothing while that is not known or does not exist.
    fn value_of(&self, fact: &str, of: &str) -> Option<Value>;
}

/// Every fact that a question can ask for.
pub fn all() -> impl Iterator<Item = &'static Fact> {
    FACTS.iter()
}

/// The fact of this name.
pub fn by_name(name: &str) -> Option<&'static Fact> {
    all().find(|fact| fact.name == name)
}

const fn fact(name: &'static str, of: Of, meaning: &'static str) -> Fact {
    Fact { name, of, meaning }
}

/// What a count is of.
const WHICH: Of = Of::Maybe("chronological");

/// A step of a search, as a lesson names it.
const STEP: Of = Of::Something("first failure");

/// The first search, or that of a planner.
const SEARCH: Of = Of::Maybe("rrt-star");

const FACTS: &[Fact] = &[
    // The text, its plan and its run.
    fact("plan", Of::Nothing, "whether there is a valid plan"),
    fact("no-plan", Of::Nothing, "whether it is proven that there is no plan"),
    fact("errors", Of::Nothing, "how many errors the text has"),
    fact("problem", Of::Something("E-BOUNDS"), "whether the text has a problem of this kind"),
    fact(
        "says",
        Of::Something("words"),
        "whether the text contains these words, with any spaces between them",
    ),
    fact("events", Of::Nothing, "how many events the network has"),
    fact("constraints", Of::Nothing, "how many arcs the network has"),
    fact("decisions", Of::Nothing, "how many decisions the network has"),
    fact("activities", Of::Nothing, "how many primitive activities the network has"),
    fact("selected", Of::Something("Drive#1"), "whether the plan contains this activity"),
    fact("choice", Of::Something("D1"), "the alternative that the plan selects at a decision, from 0"),
    fact("alternatives", Of::Something("D1"), "how many alternatives a decision has"),
    fact("assertions", Of::Something("LIGHT"), "how many intervals of the text assert a condition"),
    fact("conflicting", Of::Nothing, "how many pairs of conflicting intervals the plan has"),
    fact("lower", Of::Something("Drive#1"), "the minimum duration in the text"),
    fact("upper", Of::Something("Drive#1"), "the maximum duration in the text"),
    fact("earliest", Of::Something("Drive#1.start"), "the earliest time of an event"),
    fact("latest", Of::Something("Drive#1.start"), "the latest time of an event"),
    fact("slack", Of::Something("Drive#1.start"), "how long an event can wait"),
    fact("links", Of::Nothing, "how many requirements have a causal link"),
    fact(
        "link",
        Of::Something("LIGHT"),
        "the assertion that supports the first requirement of this condition",
    ),
    fact("orderings", Of::Nothing, "how many orderings the planner added between conflicting conditions"),
    fact("uses-ordered", Of::Nothing, "how many orderings the planner added between uses of resources"),
    fact(
        "ordered",
        Of::Something("Image#1, Send#1"),
        "whether the planner ordered a condition or a resource use of the first activity before one of the second",
    ),
    fact("consumes", Of::Something("Send#1"), "how much of a resource an activity consumes"),
    fact("produces", Of::Something("Image#1"), "how much of a resource an activity produces"),
    fact("least", Of::Something("Battery"), "the lowest level in any schedule of the plan"),
    fact("greatest", Of::Something("Battery"), "the highest level, or the peak use, in any schedule"),
    fact("end", Of::Nothing, "the earliest end of the mission"),
    fact("reward", Of::Nothing, "the reward of the plan"),
    fact("cost", Of::Nothing, "the cost of the plan"),
    fact("optimal", Of::Nothing, "whether it is proven that no plan is better"),
    fact("length", Of::Maybe("Drive#1"), "the meters of all planned paths, or of one traverse"),
    fact("reasons", Of::Nothing, "how many reasons there are if there is no plan"),
    fact("ways-out", Of::Nothing, "how many suggested fixes there are"),
    fact("natures-choice", Of::Nothing, "whether the plan has uncontrolled durations"),
    fact("pinned", Of::Something("Drive#1.end"), "the time that an event is pinned to"),
    fact("selection", Of::Nothing, "the name of the selection; empty if nothing is selected"),
    fact("selected-kind", Of::Nothing, "the kind of the selection, such as occurrence, node or arc"),
    fact("time", Of::Nothing, "the time shown"),
    fact("finished", Of::Nothing, "whether the run that is shown reaches the end of the mission"),
    fact("disturbances", Of::Nothing, "how many disturbances the run has"),
    fact("reviewed", Of::Nothing, "whether there is a review of the current plan"),
    fact(
        "items",
        Of::Something("needs attention"),
        "how many items of the review have this status: `passed`, `needs attention`, `failed` or `information`",
    ),
    fact("item", Of::Something("words"), "the status of the first item of the review with these words"),
    fact("has-item", Of::Something("words"), "whether the review has an item with these words"),
    fact("predictions", Of::Nothing, "how many predictions were made at this step of the lesson"),
    fact("right-predictions", Of::Nothing, "how many of them were right"),
    // The search.
    fact("steps", WHICH, "how many steps the search has"),
    fact("states", WHICH, "how many states it entered"),
    fact("backtracks", WHICH, "how often it returned to an earlier choice"),
    fact("failures", WHICH, "how many failures it met"),
    fact("failures-before", STEP, "how many failures it meets before a step"),
    fact("next-decision", STEP, "the decision that gets an alternative after a step"),
    fact("propagations", WHICH, "how often it propagated bounds"),
    fact("count", Of::Something("threat"), "how many steps of a kind the search has"),
    fact("step", Of::Nothing, "the number of the current step; 0 is the plan"),
    fact("step-is", Of::Something("failure"), "whether the current step is of this kind"),
    fact("sentence", Of::Nothing, "what happens at the current step, in a sentence"),
    fact("shortfall", Of::Nothing, "how far below zero the sum of the step's negative cycle is"),
    fact(
        "bound",
        Of::Maybe("2nd visit"),
        "the bound on the first goal with the choices of the step, in a best-first search",
    ),
    fact("cycle", Of::Nothing, "the events of the negative cycle of the step, in order"),
    fact("cycle-length", Of::Nothing, "how many bounds the negative cycle of the step has"),
    fact("compared", Of::Nothing, "whether both searches are shown side by side"),
    // The search for a path.
    fact("samples", SEARCH, "how many samples of the search for a path are drawn"),
    fact("all-samples", Of::Nothing, "how many samples the entire search draws"),
    fact("vertices", SEARCH, "how many vertices its trees have so far, including their roots"),
    fact("checks", SEARCH, "how many segments it has checked for obstacles"),
    fact("sample", Of::Nothing, "the position of the last sample"),
    fact("nearest", Of::Nothing, "the vertex that was nearest to it"),
    fact("steered", Of::Nothing, "the vertex that was added toward it"),
    fact("stride", Of::Nothing, "how many meters the tree grew toward it"),
    fact("blocked", Of::Nothing, "whether an obstacle blocked the last sample"),
    fact("path-found", SEARCH, "whether it has found a path"),
    fact("path-length", SEARCH, "the meters of the best path so far"),
    fact("race", Of::Nothing, "whether all planners are shown side by side"),
    fact("obstacles", Of::Nothing, "how many obstacles the mission has"),
    fact(
        "passes",
        Of::Something("Ridge, Scarp"),
        "whether a planned path leads between the centers of two obstacles",
    ),
    // Control programs.
    fact("program", Of::Nothing, "whether the text is a control program that can be run"),
    fact("moments", Of::Nothing, "how many steps the program has taken"),
    fact("locations", Of::Nothing, "how many locations its automaton has"),
    fact("marks", Of::Nothing, "the labels of the active locations, in alphabetical order"),
    fact("marked", Of::Something("assert x=a"), "whether a location with this label is active"),
    fact("marked-places", Of::Nothing, "how many locations are active"),
    fact("goals", Of::Nothing, "what the active locations assert"),
    fact("ended", Of::Nothing, "whether no location is active"),
    fact("fired", Of::Nothing, "how many transitions were taken in the last step"),
    fact("mode", Of::Something("EngineA"), "the mode of a component in the most likely state"),
    fact("true-mode", Of::Something("EngineA"), "the true mode of a component"),
    fact("believed", Of::Nothing, "how many states are believed possible"),
    fact("likelihood", Of::Nothing, "the probability of the most likely state, in percent to three decimals"),
    fact(
        "confidence",
        Of::Something("EngineA"),
        "the probability of the most likely mode of a component, in percent to three decimals",
    ),
    fact("commands", Of::Nothing, "the commands of the next step"),
    fact("observed", Of::Something("EngineA.thrust"), "what was observed of a variable in the last step"),
    fact("conflicts", Of::Nothing, "how many sets of assumptions the last observation contradicts"),
    fact("conflict", Of::Nothing, "the first of them, in words"),
    fact("proof-states", Of::Nothing, "how many states the last proof has explored"),
    fact(
        "verdict",
        Of::Something("the program ends"),
        "whether a property of the last proof `holds`, is `broken` or `open`",
    ),
    fact(
        "counterexample",
        Of::Something("the program ends"),
        "what is unusual in the run that breaks a property, by step",
    ),
    fact("diagnoses", Of::Nothing, "how many minimal diagnoses the conflicts of the last step have"),
    fact(
        "likeliest-diagnosis",
        Of::Nothing,
        "the components of the most likely one of them, such as {EngineA}",
    ),
    fact("diagnosed", Of::Nothing, "whether the hitting-set tree of the last step is finished"),
];
