//! Whether a flight rule holds in every plan of its mission (SPEC 16.4): whatever is chosen, linked, ordered and scheduled,
//! and whatever the environment does.
//!
//! That is planning with the rule negated. The mission gets one more event, an instant that breaks the rule, and the planner
//! looks for a plan that has it. If there is none, the rule holds in every plan. If there is one, it is a counterexample once
//! the checker accepts it as a plan of the mission and the rule, held against it as against any plan, is broken.

mod candidate;
mod question;
mod witness;

use exact::{Scale, Time};
use executive::Script;
use kirk::{Options, Search, Stats, Status, Termination};
use rmpl::program::Program;
use rmpl::rule::Rule;
use serde::{Deserialize, Serialize};
use tpn::{ArcId, Choice, Network, Plan};

use self::candidate::{Held, Judge, Tried, own_choices};
use self::question::{Question, Sought};
use self::witness::with_instant;
use super::meaning::times_of;
use super::{MissionRule, Outcome, read, unreadable};

/// A rule, and whether it holds in every plan of a mission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Proven {
    /// What the rule says.
    pub rule: String,
    pub verdict: Verdict,
    /// How many alternatives the planner tried.
    pub alternatives: u64,
}

/// How the plans of a mission stand to a rule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Verdict {
    /// No execution of any plan breaks it.
    Holds,
    /// No plan comes to what the rule is about.
    NeverApplies,
    /// This plan breaks it.
    Broken(Box<Counterexample>),
    /// No plan breaks it, but the mission does not say enough to be sure of it in this plan.
    Unsure(Box<Counterexample>),
    /// Nobody knows, for this reason.
    Open(String),
    /// The rule cannot be read in this mission: the character in it, from 1, and what is wrong there.
    Unreadable {
        column: u32,
        message: String,
    },
    NoPlan,
}

/// A plan that does not keep a rule, with a schedule that shows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Counterexample {
    /// When, and between which events.
    pub text: String,
    /// The plan, as `enroute plan --format json` has it.
    #[serde(with = "snapshot::json_text")]
    pub plan: serde_json::Value,
    /// What it chooses.
    pub choices: Vec<Choice>,
    /// Whether it is the plan that the mission has.
    pub is_own: bool,
    /// A run that has the times of the schedule.
    #[serde(with = "snapshot::json_text")]
    pub script: Script,
}

/// A mission whose plans are asked about.
#[derive(Clone, Copy)]
pub struct Mission<'a> {
    pub program: &'a Program,
    /// Its network without paths, whose plans are all that may be plans with paths.
    pub network: &'a Network,
    /// Its plan, in a network that may have paths; without one there is nothing to prove.
    pub plan: Option<(&'a Network, &'a Plan)>,
}

/// The network with the paths of a plan, in which its movements start where they do in it; why there are none.
pub type WithPaths<'a> = dyn FnMut(&Plan) -> Result<Network, String> + 'a;

/// The paths of a mission's plans.
pub struct Paths<'a> {
    pub find: &'a mut WithPaths<'a>,
    /// Whether the choices of a plan say where each movement starts and ends.
    pub follow_from_choices: bool,
}

/// How long to look, and what to ask.
pub struct Effort<'a> {
    /// How many alternatives the planner tries for one rule.
    pub alternatives: u64,
    /// Whether to leave the rest open.
    pub stop: &'a mut dyn FnMut() -> bool,
    /// Finds paths, where the mission's vehicles need them.
    pub paths: Option<Paths<'a>>,
}

impl Verdict {
    /// Its name in documents.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::NeverApplies => "never-applies",
            Self::Broken(_) => "broken",
            Self::Unsure(_) => "unsure",
            Self::Open(_) => "open",
            Self::Unreadable { .. } => "unreadable",
            Self::NoPlan => "no-plan",
        }
    }

    /// Returns whether every plan keeps the rule.
    pub const fn is_kept(&self) -> bool {
        matches!(self, Self::Holds | Self::NeverApplies)
    }

    /// Returns whether nothing is known of some plans.
    pub const fn is_open(&self) -> bool {
        matches!(self, Self::Open(_))
    }

    /// The plan that does not keep the rule.
    pub fn counterexample(&self) -> Option<&Counterexample> {
        match self {
            Self::Broken(found) | Self::Unsure(found) => Some(found),
            _ => None,
        }
    }

    /// Returns what was found, in one sentence without an end.
    pub fn sentence(&self) -> String {
        let of = |found: &Counterexample| if found.is_own { "this plan" } else { "another plan" };
        match self {
            Self::Holds => "holds in every plan".to_owned(),
            Self::NeverApplies => "never applies in any plan".to_owned(),
            Self::Broken(found) => format!("{} can violate it: {}", of(found), found.text),
            Self::Unsure(found) => format!("not sure in {}: {}", of(found), found.text),
            Self::Open(why) => format!("not decided: {why}"),
            Self::Unreadable { column, message } => format!("error at character {column}: {message}"),
            Self::NoPlan => "the mission has no plan".to_owned(),
        }
    }
}

/// How many choices are tried of which the solver says that they break a rule.
const MAX_CANDIDATES: usize = 12;

/// Any plan will do, and nobody asks why there is none.
const OPTIONS: Options = Options {
    search: Search::ConflictDirected,
    threat_gap: None,
    all: false,
    max_plans: 1,
    best: 1,
    trace_events: None,
    traced: None,
    explain: false,
    relax: false,
};

/// How many alternatives are tried where nothing else is asked for.
pub const ALTERNATIVES: u64 = 200_000;

/// Proves that a rule holds in every plan of a mission, or finds a plan that breaks it.
pub fn prove(mission: Mission<'_>, rule: &MissionRule, effort: Effort<'_>) -> Proven {
    let Effort { alternatives, stop, paths } = effort;
    let meter = Meter { left: alternatives, before: 0, last: 0, stop, limit: None };
    let mut proof = Proof { mission, paths, meter };
    let verdict = proof.verdict(&rule.rule);
    Proven { rule: rule.rule.clone(), verdict, alternatives: proof.meter.tried() }
}

/// Counts alternatives over several searches, and stops them.
struct Meter<'a> {
    left: u64,
    before: u64,
    last: u64,
    stop: &'a mut dyn FnMut() -> bool,
    limit: Option<String>,
}

impl Meter<'_> {
    const fn tried(&self) -> u64 {
        self.before + self.last
    }

    /// Plans, without the plans that make the choices of one of `excluded`.
    fn plan(&mut self, network: &Network, options: &Options, excluded: &[Vec<Choice>]) -> kirk::Outcome {
        let outcome = kirk::plan_except(network, options, excluded, self);
        self.before += outcome.stats.expanded;
        self.last = 0;
        outcome
    }

    fn is_stopped(&mut self) -> bool {
        if self.limit.is_none() && (self.stop)() {
            self.limit = Some("the search was stopped".to_owned());
        }
        self.limit.is_some()
    }
}

impl Termination for Meter<'_> {
    fn should_stop(&mut self, stats: &Stats) -> bool {
        self.last = stats.expanded;
        if self.limit.is_none() && self.tried() >= self.left {
            self.limit = Some(format!("the limit of {} alternatives was reached", self.left));
        }
        self.is_stopped()
    }
}

struct Proof<'a, 'b> {
    mission: Mission<'a>,
    paths: Option<Paths<'b>>,
    meter: Meter<'b>,
}

/// What a search for a plan with an instant came to.
enum Found {
    Shown(Box<Counterexample>),
    /// There is no such plan.
    None,
    Open(String),
}

const TOO_LARGE: &str = "its times are too large to compute exactly";

impl Proof<'_, '_> {
    fn verdict(&mut self, text: &str) -> Verdict {
        let Mission { program, network, plan } = self.mission;
        let rule = match read(program, network, text).map_err(|found| unreadable(text, &found)) {
            Ok(rule) => rule,
            Err(Outcome::Unreadable { column, message }) => return Verdict::Unreadable { column, message },
            Err(_) => return Verdict::NoPlan,
        };
        if plan.is_none() {
            return Verdict::NoPlan;
        }
        match self.find(text, &rule, Sought::Broken) {
            Found::Shown(found) => return Verdict::Broken(found),
            Found::Open(why) => return Verdict::Open(why),
            Found::None => {}
        }
        match self.find(text, &rule, Sought::Unsure) {
            Found::Shown(found) => return Verdict::Unsure(found),
            Found::Open(why) => return Verdict::Open(why),
            Found::None => {}
        }
        match self.find(text, &rule, Sought::Applying) {
            Found::None => Verdict::NeverApplies,
            Found::Shown(_) | Found::Open(_) => Verdict::Holds,
        }
    }

    /// Looks for a plan with an instant that is as sought.
    fn find(&mut self, text: &str, rule: &Rule, sought: Sought) -> Found {
        let Mission { program, network, plan } = self.mission;
        let judge = Judge { program, text, rule, sought };
        if let Some((network, plan)) = plan {
            match judge.hold(network, plan, true, &mut || self.meter.is_stopped()) {
                Held::Shown(shown) => return Found::Shown(shown),
                Held::Kept => {}
                Held::Unknown => {
                    return Found::Open(
                        "no schedule was confirmed in which this plan violates it".to_owned(),
                    );
                }
            }
        }
        if network.root.is_none() {
            return Found::Open("the file is a network without the structure of a mission".to_owned());
        }
        self.find_in(network, self.paths.is_some(), judge)
    }

    /// Looks for it among the plans of a network, which may await the paths of its plans.
    fn find_in(&mut self, network: &Network, awaits_paths: bool, judge: Judge<'_>) -> Found {
        let Some(scale) = scale_of(network, judge.rule) else { return Found::Open(TOO_LARGE.to_owned()) };
        let question = Question { program: self.mission.program, network, scale, awaits_paths };
        let Some(requirements) = question.requirements(judge.rule, judge.sought) else {
            return Found::Open(TOO_LARGE.to_owned());
        };
        let mut open = None;
        for requirement in requirements.iter().filter(|it| !it.is_impossible()) {
            let found = match with_instant(network, scale, requirement) {
                Some(extended) => self.plan_with_instant(network, awaits_paths, judge, extended),
                None => Found::Open(TOO_LARGE.to_owned()),
            };
            match found {
                Found::None => {}
                Found::Open(why) => open = open.or(Some(why)),
                Found::Shown(shown) => return Found::Shown(shown),
            }
        }
        open.map_or(Found::None, Found::Open)
    }

    fn plan_with_instant(
        &mut self,
        network: &Network,
        awaits_paths: bool,
        judge: Judge<'_>,
        mut extended: Network,
    ) -> Found {
        // Before what the environment begins there is no gap (SPEC 13.1), and in the extended network it begins nothing.
        let has_environment = (0..network.arcs.len()).any(|arc| network.is_uncertain(ArcId::from_index(arc)));
        let mut is_complete = !has_environment || network.threat_gap.is_zero();
        let mut excluded: Vec<Vec<Choice>> = Vec::new();
        let mut open: Option<String> = None;
        loop {
            let outcome = self.meter.plan(&extended, &OPTIONS, &excluded);
            match (outcome.status, outcome.plans.first()) {
                (Status::Plan, Some(found)) => {
                    let choices = own_choices(network, found);
                    let tried = if awaits_paths {
                        self.driven(network, judge, &choices)
                    } else {
                        judge.tried(network, (&extended, found), &mut self.meter)
                    };
                    match tried {
                        Tried::Shown(shown) => return Found::Shown(shown),
                        Tried::Refuted => {}
                        // A plan to which the rule applies is all that is sought.
                        Tried::Open(why) if judge.sought == Sought::Applying => return Found::Open(why),
                        Tried::Open(why) => open = open.or(Some(why)),
                    }
                    if choices.is_empty() {
                        return open.map_or(Found::None, Found::Open);
                    }
                    excluded.push(choices);
                    if excluded.len() > MAX_CANDIDATES {
                        return Found::Open(open.unwrap_or_else(|| "too many candidate plans".to_owned()));
                    }
                }
                (Status::Plan | Status::NoPlan, _) if is_complete => {
                    return open.map_or(Found::None, Found::Open);
                }
                (Status::Plan | Status::NoPlan, _) => {
                    is_complete = true;
                    extended.threat_gap = Time::ZERO;
                }
                (Status::Limit, _) => {
                    let limit = self.meter.limit.clone();
                    return Found::Open(
                        limit.unwrap_or_else(|| "a limit of the planner was reached".to_owned()),
                    );
                }
                (Status::Error, _) => return Found::Open(TOO_LARGE.to_owned()),
            }
        }
    }

    /// Looks for it among the plans that make these choices, with the paths of their traverses.
    fn driven(&mut self, network: &Network, judge: Judge<'_>, choices: &[Choice]) -> Tried {
        let mut bare = network.with_choices(choices.iter().copied());
        bare.objective.clear();
        let outcome = self.meter.plan(&bare, &OPTIONS, &[]);
        let (Some(plan), Some(paths)) = (outcome.plans.first(), &mut self.paths) else {
            return match outcome.status {
                Status::NoPlan => Tried::Refuted,
                _ => Tried::Open("no plan was found that makes its choices".to_owned()),
            };
        };
        let is_only_way = paths.follow_from_choices;
        match (paths.find)(plan) {
            Err(_) if is_only_way => Tried::Refuted,
            Err(why) => Tried::Open(why),
            Ok(driven) => match self.find_in(&driven.with_choices(choices.iter().copied()), false, judge) {
                Found::Shown(shown) => Tried::Shown(shown),
                Found::Open(why) => Tried::Open(why),
                Found::None if is_only_way => Tried::Refuted,
                Found::None => Tried::Open("its vehicles may take other paths in another order".to_owned()),
            },
        }
    }
}

/// The ticks of all times of a mission and a rule; `None` if they are too large.
fn scale_of(network: &Network, rule: &Rule) -> Option<Scale> {
    let arcs = network.arcs.iter().flat_map(|arc| [Some(arc.lower), arc.upper.finite()]);
    let departures = network.departures.iter().map(|departure| departure.least);
    let times = arcs.chain(departures).flatten().chain([network.threat_gap]).chain(times_of(rule));
    Scale::common(times).ok()
}

#[cfg(test)]
mod tests;
