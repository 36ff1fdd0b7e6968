//! Holds the lines of a review against flight rules: whatever the independent checker said, and what counts as enough.

use exact::{Rational, Time};
use smol_str::SmolStr;
use snapshot::robustness::Traverses;
use snapshot::{Robustness, Snapshot, Uncertainty};
use tpn::Supply;

use super::flight_rule::{self, Finding, MissionRule, Outcome};
use super::record::{Runs, short};
use super::rules::{FlightRules, at_least, percent};
use super::sealed::Sealed;
use super::{Line, Review, Section, Status};

impl Line {
    /// What the checker said of it, and no rule looks at it.
    fn reset(&mut self) {
        self.status = self.checked;
    }

    /// Holds it against a rule.
    fn judge(&mut self, is_kept: bool, criterion: &str, source: &str) {
        self.judge_as(if is_kept { Status::Passed } else { Status::Attention }, criterion, source);
    }

    fn judge_as(&mut self, status: Status, criterion: &str, source: &str) {
        self.status = self.status.max(status);
        let text = format!("{criterion} ({source})");
        match &mut self.criterion {
            Some(known) => {
                known.push_str("; ");
                known.push_str(&text);
            }
            None => self.criterion = Some(text),
        }
    }
}

/// Where what the checker examines is judged.
const CHECKER: &str = "the independent checker accepts the plan";

impl MissionRule {
    /// Returns what was found of a rule, as a line. What has not been evaluated never counts as held.
    pub fn line(&self, findings: &[Finding]) -> Line {
        let found = findings.iter().find(|it| it.rule == self.rule);
        let broken = if self.waivable { Status::Attention } else { Status::Failed };
        let name = &self.name;
        let (status, text) = match found.map(|it| &it.outcome) {
            Some(Outcome::Holds) => (Status::Passed, format!("{name}: holds in every schedule of the plan")),
            Some(Outcome::NeverApplies) => {
                (Status::Information, format!("{name}: does not apply to this plan"))
            }
            Some(Outcome::Broken(when)) => {
                (broken, format!("{name}: a schedule of the plan violates it, {when}"))
            }
            Some(Outcome::Unsure(when)) => {
                (Status::Attention, format!("{name}: the mission does not say enough to decide it, {when}"))
            }
            Some(Outcome::Undecided) => {
                (Status::Attention, format!("{name}: not decided, because there are too many cases"))
            }
            Some(Outcome::Unreadable { column, message }) => {
                (Status::Failed, format!("{name}: not valid in this mission: {message} (character {column})"))
            }
            Some(Outcome::NoPlan) => (Status::Failed, format!("{name}: there is no plan to check")),
            None => (Status::Failed, format!("{name}: has not been evaluated yet")),
        };
        let mut line = Line::new(status, text);
        let is_broken = matches!(found.map(|it| &it.outcome), Some(Outcome::Broken(_)));
        line.needs_waiver = self.waivable && is_broken;
        if let Some(Finding { names, nodes, place, .. }) = found {
            (line.names, line.nodes, line.place) = (names.clone(), nodes.clone(), place.clone());
        }
        let source = if self.source.is_empty() { String::new() } else { format!("{}, ", self.source) };
        line.criterion = Some(format!("{} ({source}flight rules of this mission)", self.rule));
        line
    }
}

impl Review {
    /// Holds everything against `rules`: those of the mission against the plan of `snapshot`, which was reviewed.
    pub fn hold_against(
        &mut self,
        snapshot: &Snapshot,
        rules: &FlightRules,
        robustness: Option<&Robustness>,
        stop: &mut dyn FnMut() -> bool,
    ) {
        self.findings = flight_rule::evaluate(snapshot, &rules.rules, stop);
        self.judge(rules, robustness);
    }

    /// Holds everything against `rules`, and against what runs with chance came to, if any were made. What was held
    /// against other rules before is judged again.
    pub fn judge(&mut self, rules: &FlightRules, robustness: Option<&Robustness>) {
        self.rules = rules.clone();
        let unit = self.unit.clone();
        for line in self.every_line() {
            line.criterion = None;
            line.reset();
        }
        let links = self.causal_links.iter_mut().map(|it| &mut it.line);
        let conflicts = self.conflicts.iter_mut().map(|it| &mut it.line);
        let resources = self.resources.iter_mut().map(|it| &mut it.line);
        for line in links.chain(conflicts).chain(resources).chain(&mut self.states) {
            line.criterion = Some(CHECKER.to_owned());
        }
        for choice in &mut self.choices {
            choice.line.criterion =
                Some("Enroute checked every other alternative with the earlier choices unchanged".to_owned());
        }
        for line in &mut self.separation_violations {
            line.criterion = Some("vehicles keep 1 m of clearance (this program)".to_owned());
        }
        for line in &mut self.overlaps {
            line.criterion = Some(
                "activities may overlap only if the mission declares it: by an order, `unordered`, or resources used entirely (the mission)".to_owned(),
            );
        }
        for line in &mut self.durations {
            line.criterion = Some("the plan allows the full declared duration (the mission)".to_owned());
        }
        self.mission_rules = rules.rules.iter().map(|rule| rule.line(&self.findings)).collect();
        self.mission_rules.extend(self.reserves_of_nothing(rules));
        self.judge_margins(rules, &unit);
        self.judge_resources(rules);
        self.judge_traverses(rules);
        let robustness = robustness.filter(|it| it.tally.runs > 0);
        self.robustness = robustness.map(|it| success(rules, it, self));
        self.runs = robustness.map(|it| Runs::new(&self.content_hash, it).digest());
        let worst =
            Section::ALL.iter().flat_map(|&section| self.lines(section)).map(|line| line.status).max();
        self.status = worst.unwrap_or(Status::Passed).max(Status::Passed);
    }

    /// Returns whether every rule of the mission has been evaluated.
    pub fn is_evaluated(&self, rules: &FlightRules) -> bool {
        rules.rules.iter().all(|rule| self.findings.iter().any(|it| it.rule == rule.rule))
    }

    fn judge_margins(&mut self, rules: &FlightRules, unit: &str) {
        let Some(margin) = rules.margin else { return };
        let source = FlightRules::source(|it| it.margin == rules.margin);
        let criterion = format!("margin {}", at_least(&margin.readable(), margin.is_positive(), unit));
        let is_kept = |least: Time| least.is_positive() && least >= margin;
        // What lasts is held until the next change, which waits for the need.
        for link in self.causal_links.iter_mut().filter(|link| !link.is_lasting) {
            link.line.judge(is_kept(link.margin.least), &criterion, source);
        }
        // Uses of a resource may follow each other at once.
        for conflict in self.conflicts.iter_mut().filter(|conflict| !conflict.is_of_uses) {
            conflict.line.judge(is_kept(conflict.gap.least), &criterion, source);
        }
    }

    fn judge_resources(&mut self, rules: &FlightRules) {
        for resource in &mut self.resources {
            // Of what one alone uses at a time nothing can be left.
            let is_exclusive =
                matches!(resource.supply, Supply::Reusable { capacity } if capacity <= Rational::ONE);
            let own = rules.reserves.get(resource.name.as_str()).copied();
            let Some(reserve) = own.or(rules.reserve.filter(|_| !is_exclusive)) else { continue };
            let source = FlightRules::source(|it| own.is_none() && it.reserve == rules.reserve);
            let criterion = format!("reserve {}", at_least(&reserve.readable(), reserve.is_positive(), ""));
            let is_kept = resource.spare.is_positive() && resource.spare >= reserve;
            resource.line.judge(is_kept, &criterion, source);
        }
    }

    /// A reserve that names no resource of the plan was held against nothing, and is not taken for kept.
    fn reserves_of_nothing(&self, rules: &FlightRules) -> Vec<Line> {
        let is_here = |name: &str| self.resources.iter().any(|resource| resource.name == name);
        let missing = rules.reserves.iter().filter(|(name, _)| self.is_planned() && !is_here(name));
        let line = |(name, reserve): (&SmolStr, &Rational)| {
            let text = format!("{name}: a reserve is required, but the plan has no resource with this name");
            let mut line = Line::new(Status::Attention, text);
            let wanted = at_least(&reserve.readable(), reserve.is_positive(), "");
            line.criterion = Some(format!("reserve {wanted} (flight rules of this mission)"));
            line
        };
        missing.map(line).collect()
    }

    fn judge_traverses(&mut self, rules: &FlightRules) {
        for traverse in &mut self.traverses {
            if let (Some(clearance_m), Some(min_m)) = (traverse.clearance_m, rules.clearance_m) {
                let source = FlightRules::source(|it| it.clearance_m == rules.clearance_m);
                traverse.line.judge(clearance_m >= min_m, &format!("clearance at least {min_m} m"), source);
            }
            let slope_deg = traverse.slope_max_rad.to_degrees();
            // Who flies is held to no slope.
            if let Some(most_deg) = rules.slope_deg.filter(|_| traverse.slope_limit_rad.is_some()) {
                let source = FlightRules::source(|it| it.slope_deg == rules.slope_deg);
                traverse.line.judge(slope_deg <= most_deg, &format!("slope at most {most_deg}°"), source);
            }
            if let Some(most_rad) = traverse.slope_limit_rad {
                let most_deg = most_rad.to_degrees();
                // Paths are planned by the same slopes, so that there is nothing to round.
                let is_kept = traverse.slope_max_rad <= most_rad + 1e-9;
                let status = if is_kept { Status::Passed } else { Status::Failed };
                let criterion = format!("slope at most {most_deg:.1}°");
                traverse.line.judge_as(status, &criterion, "vehicle limits");
            }
        }
    }

    /// Every line that a rule may judge.
    pub(super) fn every_line(&mut self) -> impl Iterator<Item = &mut Line> {
        self.plan
            .iter_mut()
            .chain(self.choices.iter_mut().map(|it| &mut it.line))
            .chain(self.causal_links.iter_mut().map(|it| &mut it.line))
            .chain(self.conflicts.iter_mut().map(|it| &mut it.line))
            .chain(&mut self.states)
            .chain(self.resources.iter_mut().map(|it| &mut it.line))
            .chain(&mut self.overlaps)
            .chain(&mut self.durations)
            .chain(self.events.iter_mut().map(|it| &mut it.line))
            .chain(self.traverses.iter_mut().map(|it| &mut it.line))
            .chain(&mut self.separation_violations)
            .chain(&mut self.warnings)
    }
}

/// Returns which distributions the runs had, unless they are the usual ones: `, own distributions 3f2a91c07b4e`.
fn distributions(uncertainty: &Uncertainty) -> String {
    if *uncertainty == Uncertainty::default() {
        return String::new();
    }
    let digest = Sealed::new(uncertainty.clone()).digest().to_owned();
    format!(", own distributions {}", short(&digest))
}

/// Returns what runs with chance came to, held against the rule.
fn success(rules: &FlightRules, found: &Robustness, review: &Review) -> Line {
    let (tally, settings) = (&found.tally, &found.settings);
    let (low, high) = tally.interval();
    let rate = tally.probability();
    let made = if found.is_complete() {
        format!("{} runs", tally.runs)
    } else {
        format!("only {} of {} runs", tally.runs, settings.runs)
    };
    let mut text = format!(
        "{} of {made} reached the end (Monte Carlo, seed {}{}; 95% confidence: {} to {})",
        percent(rate),
        settings.seed,
        distributions(&settings.uncertainty),
        percent(low),
        percent(high)
    );
    // The plan that is reviewed did not hold in these.
    match tally.succeeded_by_replanning {
        0 => {}
        1 => text.push_str(", 1 of them after replanning"),
        several => text.push_str(&format!(", {several} of them after replanning")),
    }
    let is_by_chance = settings.uncertainty.leaves_something_to_chance(review.runs_programs);
    if !is_by_chance {
        text.push_str("; nothing in the runs was random");
    }
    if !review.traverses.is_empty() && settings.uncertainty.traverses == Traverses::Drawn {
        text.push_str("; traverses were not simulated: their durations were sampled");
    }
    let checked = match (found.is_complete() && is_by_chance, rules.success_rate) {
        (false, _) => Status::Attention,
        (true, Some(_)) => Status::Passed,
        // Held against nothing.
        (true, None) => Status::Information,
    };
    let mut line = Line::new(checked, text);
    // It is of the whole plan, and of no other.
    line.place = format!("content {}", review.content_hash);
    if let Some(wanted) = rules.success_rate {
        let source = FlightRules::source(|it| it.success_rate == rules.success_rate);
        let status = match rate {
            _ if rate < wanted.least => Status::Failed,
            _ if rate < wanted.wanted => Status::Attention,
            // Few runs that all went well could be luck.
            _ if low < wanted.least => Status::Attention,
            _ => Status::Passed,
        };
        let criterion = format!(
            "success rate at least {}, failed below {}, with enough runs to be confident of the latter",
            percent(wanted.wanted),
            percent(wanted.least)
        );
        line.judge_as(status, &criterion, source);
    }
    line
}
