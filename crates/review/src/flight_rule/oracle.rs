//! Rules, and what may overlap, held against every schedule in whole ticks of small random missions, one instant after the
//! other: nothing of how either is evaluated is used.

use rmpl::program::LabelMode;
use rmpl::rule::{Formula, Moment, Order};
use tpn::{Extent, Network, NodeId, Plan};

use super::super::tests::snapshot;
use super::{MissionRule, Outcome, evaluate};

/// Numbers that look like chance (Knuth's linear congruential generator).
pub(super) struct Chance(pub(super) u64);

impl Chance {
    pub(super) fn below(&mut self, count: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % count
    }

    fn bounds(&mut self) -> String {
        let lower = self.below(3);
        format!("[{lower},{}]", lower + self.below(3))
    }

    pub(super) fn statement(&mut self) -> String {
        match self.below(12) {
            0 => format!("delay{}", self.bounds()),
            1 => "Raise()".to_owned(),
            2 => "Lower()".to_owned(),
            3 => "Drive()".to_owned(),
            4 => "Charge()".to_owned(),
            5 => format!("Comm=UP {}", self.bounds()),
            6 => format!("Comm=DOWN {}", self.bounds()),
            7 => format!("Mast={} {}", ["UP", "DOWN"][self.below(2) as usize], self.bounds()),
            8 => "Deploy()".to_owned(),
            9 => "Store()".to_owned(),
            _ => format!("Talk(){}", self.bounds()),
        }
    }

    fn mission(&mut self) -> String {
        self.mission_of(&mut Self::statement)
    }

    /// A mission of such statements.
    pub(super) fn mission_of(&mut self, statement: &mut dyn FnMut(&mut Self) -> String) -> String {
        let mut threads = Vec::new();
        for _ in 0..=self.below(2) {
            let parts: Vec<String> = (0..=self.below(2)).map(|_| statement(self)).collect();
            threads.push(format!("{{ {} }}", parts.join("; ")));
        }
        format!(
            "option threat_gap = 0; var Comm : {{UP, DOWN}}; state Mast : {{UP, DOWN}} = DOWN;
state Arm : {{STOWED, OUT}} = STOWED; location A (0, 0); location B (9, 9); vehicle Rover : ATRV at A;
resource Radio; resource Bay; resource Battery 0..100 = 50; resource Memory 0..20 = 10; resource Power capacity 9; primitive Raise()[1,2] sets Mast=UP;
primitive Lower()[0,1] sets Mast=DOWN; primitive Drive()[1,2] consumes Battery 20 uses Power 2;
primitive Charge()[1,2] produces Battery 15 uses Power; primitive Talk() uses Radio;
primitive Deploy()[1,2] sets Arm=OUT; primitive Store()[1,2] produces Memory 5 consumes Battery 10 uses Bay;
scenario S[0,6] = {{ {} }}",
            threads.join(", ")
        )
    }

    fn atom(&mut self) -> &'static str {
        const ATOMS: [&str; 19] = [
            "Comm=UP",
            "Comm!=UP",
            "Mast=UP",
            "not Mast=UP",
            "Drive",
            "Talk",
            "Charge",
            "Battery >= 31",
            "Battery <= 50",
            "Battery < 65",
            "Power <= 2",
            "Power > 0",
            "Arm=STOWED",
            "Arm=OUT",
            "Rover.at=A",
            "Rover.at=B",
            "Battery >= 40 and Battery <= 60",
            "not (Battery > 30 and Battery < 50)",
            "Memory <= 10",
        ];
        ATOMS[self.below(ATOMS.len() as u64) as usize]
    }

    pub(super) fn rule(&mut self) -> String {
        let word = ["", "always ", "never "][self.below(3) as usize];
        let joint = ["", " and ", " or "][self.below(3) as usize];
        let second = if joint.is_empty() { "" } else { self.atom() };
        let during = if self.below(2) == 0 { String::new() } else { format!(" while {}", self.atom()) };
        let moment =
            ["", "", " at end", " at start", " at start of Drive", " at end of Raise", " from 1 to 4"]
                [self.below(7) as usize];
        format!("{word}{}{joint}{second}{during}{moment}", self.atom())
    }
}

/// What is known of a condition.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Truth {
    No,
    Unknown,
    Yes,
}

/// When an assertion starts and ends, its value, how long that lasts, and its place among those of its variable.
type Told = (i64, i64, String, Extent, Option<usize>);

/// One schedule of a plan, at one tick.
struct Instant<'a> {
    network: &'a Network,
    plan: &'a Plan,
    times: &'a [i64],
    at: i64,
    touches: bool,
}

impl Instant<'_> {
    fn time(&self, node: NodeId) -> i64 {
        self.times[node.index()]
    }

    fn inside(&self, from: i64, to: i64) -> bool {
        from <= self.at && (self.at < to || (self.touches && self.at == to))
    }

    fn told(&self, name: &str) -> Vec<Told> {
        let mut told: Vec<Told> = Vec::new();
        for (index, label) in self.network.labels.iter().enumerate() {
            let variable = &self.network.variables[label.literal.variable.index()];
            if variable.name != name
                || label.mode != LabelMode::Tell
                || !self.plan.selected_arcs[label.arc.index()]
            {
                continue;
            }
            let (start, end) = self.network.interval(tpn::LabelId::from_index(index));
            let value = label.text.split_once('=').expect("a value").1.to_owned();
            let is_it = |producer: &tpn::LabelId| producer.index() == index;
            let mut orders = self.plan.state_order.iter();
            let place = orders.find_map(|order| order.producers.iter().position(is_it));
            told.push((self.time(start), self.time(end), value, label.extent, place));
        }
        told
    }

    fn variable(&self, name: &str, value: &str) -> (bool, bool) {
        let mut told = self.told(name);
        let (mut yes, mut no) = (false, false);
        if name == "Comm" {
            for (start, end, told, ..) in told {
                if self.inside(start, end) {
                    *(if told == value { &mut yes } else { &mut no }) = true;
                }
            }
            return (yes, no);
        }
        if told.is_empty() {
            // What nothing needs or changes is as the mission declares it.
            let declared = match name {
                "Mast" => "DOWN",
                "Arm" => "STOWED",
                _ => "A",
            };
            return (value == declared, value != declared);
        }
        // Of changes at one instant the plan says which follows which.
        told.sort_by_key(|(start, end, _, extent, place)| (*extent != Extent::Initial, *start, *end, *place));
        for (index, (start, end, now, extent, _)) in told.iter().enumerate() {
            let ready = if *extent == Extent::Effect { *end } else { *start };
            let next = told[index + 1..]
                .iter()
                .find(|next| next.3 == Extent::Effect || *extent == Extent::Effect || next.2 != *now);
            if self.inside(ready, next.map_or(i64::MAX, |next| next.0)) {
                *(if now == value { &mut yes } else { &mut no }) = true;
            }
        }
        (yes, no)
    }

    fn amount(&self, name: &str) -> i64 {
        let mut level = match name {
            "Battery" => 50,
            "Memory" => 10,
            _ => 0,
        };
        for used in &self.network.uses {
            if self.network.resources[used.resource.index()].name != name
                || !self.plan.selected_arcs[used.arc.index()]
            {
                continue;
            }
            let amount = used.amount.numerator();
            let (start, end) = (self.time(used.start), self.time(used.end));
            let has_begun = start < self.at || (start == self.at && !self.touches);
            match used.change {
                rmpl::program::Change::Uses => {
                    level += amount * (i64::from(has_begun) - i64::from(end <= self.at));
                }
                rmpl::program::Change::Consumes => level -= amount * i64::from(has_begun),
                rmpl::program::Change::Produces => level += amount * i64::from(end <= self.at),
            }
        }
        level
    }

    /// Returns whether it is known to hold, and whether its negation is; what both sides of a moment touch is neither
    /// inside of a `not`, and where a rule is looked at.
    fn known(&self, formula: &Formula, is_strict: bool) -> (bool, bool) {
        match formula {
            Formula::Not(inner) => {
                let (yes, no) = self.known(inner, true);
                (no, yes)
            }
            Formula::All(parts) => {
                let mut known = parts.iter().map(|part| self.known(part, is_strict));
                (known.clone().all(|it| it.0), known.any(|it| it.1))
            }
            Formula::Any(parts) => {
                let mut known = parts.iter().map(|part| self.known(part, is_strict));
                (known.clone().any(|it| it.0), known.all(|it| it.1))
            }
            _ => {
                let (yes, no) = self.atom(formula);
                if is_strict && yes && no { (false, false) } else { (yes, no) }
            }
        }
    }

    fn atom(&self, formula: &Formula) -> (bool, bool) {
        match formula {
            Formula::Not(_) | Formula::All(_) | Formula::Any(_) => unreachable!("it is made of others"),
            Formula::Is { variable, values } => self.variable(variable, &values[0]),
            Formula::Underway(activity) => {
                let (mut yes, mut no) = (false, true);
                for it in self.network.occurrences.iter().filter(|it| it.activity == activity.name) {
                    let (start, end) = (self.time(it.start), self.time(it.end));
                    yes |= self.inside(start, end);
                    no &= if self.touches {
                        self.at <= start || end <= self.at
                    } else {
                        self.at < start || end <= self.at
                    };
                }
                (yes, no)
            }
            Formula::Amount { resource, order, amount } => {
                let (level, amount) = (self.amount(resource), amount.numerator());
                let yes = match order {
                    Order::Below => level < amount,
                    Order::AtMost => level <= amount,
                    Order::Above => level > amount,
                    Order::AtLeast => level >= amount,
                };
                (yes, !yes)
            }
        }
    }
}

/// Places the nodes one after the other; whether there are not too many ways.
fn place(
    nodes: &[usize],
    start: usize,
    constraints: &[(usize, usize, i64, i64)],
    times: &mut Vec<i64>,
    found: &mut Vec<Vec<i64>>,
) -> bool {
    let Some((&node, rest)) = nodes.split_first() else {
        found.push(times.clone());
        return found.len() < 3000;
    };
    for at in if node == start { 0..=0 } else { 0..=6 } {
        times[node] = at;
        let fits = constraints.iter().all(|&(from, to, lower, upper)| {
            times[from] < 0 || times[to] < 0 || (lower..=upper).contains(&(times[to] - times[from]))
        });
        if fits && !place(rest, start, constraints, times, found) {
            return false;
        }
    }
    times[node] = -1;
    true
}

/// All schedules in whole ticks, unless there are too many.
fn schedules(network: &Network, plan: &Plan) -> Option<Vec<Vec<i64>>> {
    schedules_in_order(network, plan, &plan.precedences(network))
}

/// All schedules in whole ticks of what a plan selects, in such an order.
pub(super) fn schedules_in_order(
    network: &Network,
    plan: &Plan,
    orders: &[tpn::Precedence],
) -> Option<Vec<Vec<i64>>> {
    let mut constraints: Vec<(usize, usize, i64, i64)> = Vec::new();
    for (index, arc) in network.arcs.iter().enumerate().filter(|(index, _)| plan.selected_arcs[*index]) {
        let _ = index;
        let upper = arc.upper.finite().map_or(99, exact::Time::numerator);
        constraints.push((arc.from.index(), arc.to.index(), arc.lower.numerator(), upper));
    }
    for order in orders {
        constraints.push((order.earlier.index(), order.later.index(), order.least.numerator(), 99));
    }
    let nodes: Vec<usize> = (0..network.nodes.len()).filter(|&node| plan.selected_nodes[node]).collect();
    let mut found = Vec::new();
    let mut times = vec![-1; network.nodes.len()];
    place(&nodes, network.start.index(), &constraints, &mut times, &mut found).then_some(found)
}

/// The worst that any schedule makes of a rule at any instant; `None` if no instant is looked at.
fn worst(network: &Network, plan: &Plan, rule: &rmpl::rule::Rule, schedules: &[Vec<i64>]) -> Option<Truth> {
    let mut worst = None;
    for times in schedules {
        let time = |node: NodeId| times[node.index()];
        let (start, end) = (time(network.start), time(network.end));
        let mut instants: Vec<(i64, bool)> = Vec::new();
        let of = |activity: &rmpl::rule::Activity, is_end: bool| {
            let all = network.occurrences.iter().filter(|it| it.activity == activity.name);
            all.map(|it| (time(if is_end { it.end } else { it.start }), true)).collect::<Vec<_>>()
        };
        match &rule.moment {
            Moment::Throughout => {
                instants.extend((start..end).map(|at| (at, false)));
                instants.push((end, true));
            }
            Moment::Within { from, to } => {
                let (from, to) = (from.numerator(), to.finite().expect("a time").numerator());
                instants.extend((start..end).filter(|at| (from..to).contains(at)).map(|at| (at, false)));
                instants.extend(Some((end, true)).filter(|_| (from..to).contains(&end)));
            }
            Moment::Start(None) => instants.push((start, true)),
            Moment::End(None) => instants.push((end, true)),
            Moment::Start(Some(activity)) => instants = of(activity, false),
            Moment::End(Some(activity)) => instants = of(activity, true),
        }
        for (at, is_instant) in instants {
            let instant = Instant { network, plan, times, at, touches: is_instant };
            let (during, not_during) =
                rule.during.as_ref().map_or((true, false), |it| instant.known(it, true));
            if not_during {
                continue;
            }
            let (yes, no) = instant.known(&rule.holds, false);
            let truth = match (yes, no && during) {
                (true, _) => Truth::Yes,
                (false, true) => Truth::No,
                (false, false) => Truth::Unknown,
            };
            worst = Some(worst.map_or(truth, |worst: Truth| worst.min(truth)));
        }
    }
    worst
}

#[test]
fn rules_are_decided_as_by_looking_at_every_schedule() {
    let mut chance = Chance(20);
    let (mut decided, mut seen) = (0, std::collections::BTreeMap::new());
    while decided < 800 {
        let source = chance.mission();
        let snapshot = snapshot(&source);
        let (Some(network), Some(plan)) = (snapshot.network.as_deref(), snapshot.plan()) else { continue };
        let Some(schedules) = schedules(network, plan) else { continue };
        assert!(!schedules.is_empty(), "{source}");
        for _ in 0..8 {
            let text = chance.rule();
            let rule = super::read(&snapshot.program, network, &text).expect("a rule");
            let held = MissionRule { name: "R".into(), rule: text.clone(), ..MissionRule::default() };
            let outcome = evaluate(&snapshot, &[held], &mut || false).remove(0).outcome;
            let expected = match worst(network, plan, &rule, &schedules) {
                None => "never",
                Some(Truth::Yes) => "holds",
                Some(Truth::No) => "broken",
                Some(Truth::Unknown) => "unsure",
            };
            let got = match &outcome {
                Outcome::NeverApplies => "never",
                Outcome::Holds => "holds",
                Outcome::Broken(_) => "broken",
                Outcome::Unsure(_) => "unsure",
                other => panic!("{other:?}"),
            };
            assert_eq!(got, expected, "{text}\n{source}\n{outcome:?}");
            *seen.entry(got).or_insert(0) += 1;
            decided += 1;
        }
    }
    for outcome in ["never", "holds", "broken", "unsure"] {
        assert!(seen.get(outcome).is_some_and(|count| *count > 10), "{seen:?}");
    }
}

#[test]
fn activities_may_overlap_that_do_in_some_schedule() {
    let mut chance = Chance(3);
    let (mut missions, mut found, mut none) = (0, 0, 0);
    while missions < 120 {
        let source = chance.mission();
        let snapshot = snapshot(&source);
        let (Some(network), Some(plan)) = (snapshot.network.as_deref(), snapshot.plan()) else { continue };
        let Some(schedules) = schedules(network, plan) else { continue };
        missions += 1;
        let done: Vec<&tpn::Occurrence> = (network.occurrences.iter())
            .filter(|it| it.kind == tpn::OccurrenceKind::Primitive)
            .filter(|it| it.arc.is_some_and(|arc| plan.selected_arcs[arc.index()]))
            .collect();
        let mut expected = std::collections::BTreeSet::new();
        for (at, one) in done.iter().enumerate() {
            for other in &done[at + 1..] {
                let overlaps = schedules.iter().any(|times| {
                    let time = |node: NodeId| times[node.index()];
                    time(one.start).max(time(other.start)) < time(one.end).min(time(other.end))
                });
                let mut names = [one.activity.to_string(), other.activity.to_string()];
                names.sort();
                // Each of these takes a resource of its own.
                if overlaps && names != ["Store", "Talk"] {
                    expected.insert(names);
                }
            }
        }
        let review = crate::review(&snapshot, &snapshot::Goal::Default, 0, &mut || false);
        let told = review.overlaps.iter().filter(|line| line.status == crate::Status::Attention);
        let told: std::collections::BTreeSet<[String; 2]> = told
            .map(|line| {
                let activity = |name: &String| name.split('#').next().unwrap_or_default().to_owned();
                let mut names = [activity(&line.names[0]), activity(&line.names[1])];
                names.sort();
                names
            })
            .collect();
        assert_eq!(told, expected, "{source}");
        found += usize::from(!expected.is_empty());
        none += usize::from(expected.is_empty() && done.len() > 1);
        let passed = review.overlaps.iter().any(|line| line.status == crate::Status::Passed);
        assert_eq!(passed, expected.is_empty() && done.len() > 1, "{source}");
    }
    assert!(found > 10 && none > 10, "{found} {none}");
}
