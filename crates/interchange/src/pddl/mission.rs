//! The text of the mission.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use exact::Rational;

use super::domain::Task;
use super::error::PddlError;
use super::ground::{Action, Atom, Conditions, Fluent, Ground, Linear, Names, Snap};
use super::groups::Groups;
use super::names::{BEFORE_PART, BETWEEN_WORDS, EPSILON, INSTANT, body_of};
use super::numbers::{Range, Side, ranges};

/// The end of the name of a group's state, after its object.
const IS: &str = "is";

/// The value of a group's state while none of its atoms is true.
const NONE: &str = "none";

/// No action happens more often than this.
pub const MAX_TIMES: u32 = 20;

/// A problem as a mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Translation {
    /// The mission in RMPL.
    pub mission: String,
    /// What the mission leaves out or changes.
    pub remarks: Vec<String>,
}

/// Writes the mission.
pub(super) fn write(task: &Task, mut ground: Ground, times: u32) -> Result<Translation, PddlError> {
    let times = times.clamp(1, MAX_TIMES);
    let ranges = ranges(&mut ground, times)?;
    let groups = Groups::find(&ground);
    if groups.exclude(&ground.goal) {
        return Err(PddlError::NeverTrue);
    }
    let mut writer = Writer::new(&ground, &ranges, &groups)?;
    let mut branches = writer.timed()?;
    for action in &ground.actions {
        let Some(call) = writer.action(action)? else { continue };
        let mut branch = String::new();
        for _ in 0..times {
            let more = if branch.is_empty() { String::new() } else { format!("; {branch}") };
            branch = format!("choose {{ delay[0,0], {{ delay; {call}{more} }} }}");
        }
        branches.push(branch);
    }
    let goal = writer.goal(&ground.goal)?;
    let objective = writer.objective(task, ground.metric.as_ref());
    let mut text = heading(task, times, &writer.remarks);
    text += &writer.states()?;
    text += &writer.reservoirs()?;
    text += &writer.declarations;
    text += &objective;
    let steps = match (branches.is_empty(), goal.is_empty()) {
        (true, true) => "  delay[0,0]".to_owned(),
        (true, false) => format!("  {goal}"),
        (false, true) => format!("  {{\n    {}\n  }}", branches.join(",\n    ")),
        (false, false) => format!("  {{\n    {}\n  }};\n  {goal}", branches.join(",\n    ")),
    };
    let _ = write!(text, "\nscenario Problem = {{\n{steps}\n}}\n");
    Ok(Translation { mission: text, remarks: writer.remarks })
}

fn heading(task: &Task, times: u32, remarks: &[String]) -> String {
    let often = if times == 1 { "once".to_owned() } else { format!("{times} times") };
    let mut text = format!(
        "// The PDDL problem {} of the domain {}.\n\
        //\n\
        // A plan of this mission is a plan of the problem; enroute export FILE --as pddl writes it.\n\
        // The planner decides which actions happen, each at most {often}. If there is no plan, none exists in\n\
        // which each action happens at most {often}; enroute import --times N allows more.\n\
        // A change takes {EPSILON}, because PDDL keeps actions apart that change what others need.\n",
        task.problem, task.domain
    );
    for remark in remarks {
        let _ = writeln!(text, "// Note: {remark}.");
    }
    text.push('\n');
    text
}

struct Writer<'ground> {
    ground: &'ground Ground,
    ranges: &'ground BTreeMap<Fluent, Range>,
    groups: &'ground Groups,
    epsilon: Rational,
    /// The atoms that are states, or values of one.
    states: BTreeSet<Atom>,
    declarations: String,
    remarks: Vec<String>,
    /// The atoms that some conditions only mention.
    mentioned: BTreeSet<Atom>,
    has_costs: bool,
    has_rewards: bool,
}

impl<'ground> Writer<'ground> {
    fn new(
        ground: &'ground Ground,
        ranges: &'ground BTreeMap<Fluent, Range>,
        groups: &'ground Groups,
    ) -> Result<Self, PddlError> {
        Ok(Self {
            ground,
            ranges,
            groups,
            epsilon: EPSILON.parse().map_err(|_| PddlError::Number)?,
            states: BTreeSet::new(),
            mentioned: mentioned(ground),
            declarations: String::new(),
            remarks: Vec::new(),
            has_costs: false,
            has_rewards: false,
        })
    }

    fn literal(&mut self, atom: Atom, value: bool) -> Result<String, PddlError> {
        self.states.insert(atom);
        let name = name_of(&self.ground.atoms, atom)?;
        Ok(match self.groups.of(atom) {
            Some(group) => format!("{}={name}", self.state_of(group)?),
            None => format!("{name}={}", if value { "yes" } else { "no" }),
        })
    }

    /// Conditions. No condition wants an atom of a group to be false.
    fn literals(&mut self, literals: &BTreeMap<Atom, bool>) -> Result<Vec<String>, PddlError> {
        literals.iter().map(|(atom, value)| self.literal(*atom, *value)).collect()
    }

    /// Effects. For a group: the atom that becomes true, or that none is true.
    fn sets(&mut self, sets: &BTreeMap<Atom, bool>) -> Result<Vec<String>, PddlError> {
        let is_written = |atom: &Atom, value: bool| {
            let group = self.groups.of(*atom);
            value
                || group.is_none()
                || !sets.iter().any(|(other, value)| *value && self.groups.of(*other) == group)
        };
        let written: Vec<(Atom, bool)> = sets
            .iter()
            .map(|(atom, value)| (*atom, *value))
            .filter(|(atom, value)| is_written(atom, *value))
            .collect();
        let mut texts = Vec::new();
        for (atom, value) in written {
            let text = match self.groups.of(atom) {
                Some(group) if !value => {
                    self.states.insert(atom);
                    format!("{}={NONE}", self.state_of(group)?)
                }
                _ => self.literal(atom, value)?,
            };
            texts.push(text);
        }
        texts.dedup();
        Ok(texts)
    }

    /// The name of the state of a group.
    fn state_of(&self, group: usize) -> Result<String, PddlError> {
        let object = &self.groups.all[group].object;
        let before = self.groups.all[..group].iter().filter(|other| other.object == *object).count();
        // No atom has this name, because names of atoms do not contain the separator of parts.
        name(&[object.clone(), IS.to_owned()])?;
        Ok(match before {
            0 => format!("{object}{BEFORE_PART}{IS}"),
            _ => format!("{object}{BEFORE_PART}{IS}{}", before + 1),
        })
    }

    /// The declarations of an action. Returns its call; `None` if the action can never happen.
    fn action(&mut self, action: &Action) -> Result<Option<String>, PddlError> {
        if action.conditions().into_iter().any(|conditions| self.groups.exclude(conditions)) {
            return Ok(None);
        }
        let name = name(&action.words)?;
        let place = format!("({})", action.words.join(" "));
        let Some((least, greatest)) = action.duration else {
            let snap = format!("{name}{BEFORE_PART}{INSTANT}");
            let clauses = self.clauses(&action.start, None, &place)? + &self.worth(action)?;
            self.primitive(&snap, self.epsilon, Some(self.epsilon), &clauses);
            return Ok(Some(format!("{snap}()")));
        };
        if greatest.is_some_and(|greatest| greatest < self.epsilon) {
            return Err(PddlError::Said { place, what: "a duration shorter than 0.02" });
        }
        let is_against_itself = action
            .throughout
            .literals
            .iter()
            .any(|(atom, value)| action.start.sets.get(atom) == Some(&!value));
        if is_against_itself {
            return Ok(None);
        }
        if least < self.epsilon {
            self.remarks.push(format!("{place} takes at least {EPSILON}"));
        }
        let least = least.max(self.epsilon);
        let required = self.literals(&action.throughout.literals)?;
        let mut clauses = clause("requires", &required);
        clauses += &self.reserved(action, &place)?;
        let worth = self.worth(action)?;
        let start =
            self.snap(&action.start, Some(&action.throughout), &format!("{name}{BEFORE_PART}start"), &place)?;
        let end = self.snap(&action.end, None, &format!("{name}{BEFORE_PART}end"), &place)?;
        if action.rests_on_start() {
            let shorter = |time: Rational| time.checked_sub(self.epsilon).ok_or(PddlError::Number);
            let body = body_of(&name);
            let (shortest, longest) = (shorter(least)?, greatest.map(shorter).transpose()?);
            self.primitive(&body, shortest, longest, &(clauses + &worth));
            let steps = start.into_iter().chain([format!("{body}()")]).collect::<Vec<_>>().join("; ");
            let _ = writeln!(self.declarations, "{name}(){} = {{ {steps} }}", bounds(least, greatest));
            let call = format!("{name}()");
            return Ok(Some(end.map_or_else(|| call.clone(), |end| format!("{{ {call}; {end} }}"))));
        }
        self.primitive(&name, least, greatest, &(clauses + &worth));
        let call = end.map_or_else(|| format!("{name}()"), |end| format!("{{ {name}(); {end} }}"));
        Ok(Some(start.map_or_else(|| call.clone(), |start| format!("{{ {call}, {start} }}"))))
    }

    fn primitive(&mut self, name: &str, least: Rational, greatest: Option<Rational>, clauses: &str) {
        let _ = writeln!(self.declarations, "primitive {name}(){}{clauses};", bounds(least, greatest));
    }

    /// Declares the start or the end of an action. Returns its call; `None` if it needs and changes nothing.
    fn snap(
        &mut self,
        snap: &Snap,
        throughout: Option<&Conditions>,
        name: &str,
        place: &str,
    ) -> Result<Option<String>, PddlError> {
        let clauses = self.clauses(snap, throughout, place)?;
        if clauses.is_empty() {
            return Ok(None);
        }
        self.primitive(name, self.epsilon, Some(self.epsilon), &clauses);
        Ok(Some(format!("{name}()")))
    }

    /// Returns what a snap needs and changes.
    fn clauses(
        &mut self,
        snap: &Snap,
        throughout: Option<&Conditions>,
        place: &str,
    ) -> Result<String, PddlError> {
        let required = self.literals(&snap.conditions.literals)?;
        let sets = self.sets(&snap.sets)?;
        let mut text = clause("requires", &required);
        text += &clause("sets", &sets);
        let (mut locks, mut takes, mut gives) = (Vec::new(), Vec::new(), Vec::new());
        for (fluent, range) in self.ranges {
            let is_asked = snap.conditions.needs.iter().any(|need| need.fluent == *fluent);
            let is_changed = snap.changes.contains_key(fluent);
            if !is_asked && !is_changed {
                continue;
            }
            locks.push(lock_of(&self.ground.fluents, *fluent)?);
            let lasts = |conditions: &&Conditions| conditions.needs.iter().any(|need| need.fluent == *fluent);
            let lasting = throughout.filter(lasts);
            if lasting.is_some() && is_changed {
                return Err(PddlError::Said {
                    place: place.to_owned(),
                    what: "a condition over all on a number that the start of the same action changes",
                });
            }
            for (side, _) in range.sides()? {
                let already = lasting
                    .map(|conditions| range.reserved(*fluent, side, conditions))
                    .transpose()?
                    .unwrap_or_default();
                let exchange = range.exchange(*fluent, side, snap, already)?;
                let reservoir = reservoir_of(self.ground, *fluent, side)?;
                for (amount, list) in [(exchange.takes, &mut takes), (exchange.gives, &mut gives)] {
                    if amount.is_positive() {
                        list.push(format!("{reservoir} {amount}"));
                    }
                }
            }
        }
        for atom in &self.mentioned {
            if snap.conditions.mentioned.contains(atom) || snap.sets.contains_key(atom) {
                locks.push(lock_of(&self.ground.atoms, *atom)?);
            }
        }
        text += &clause("uses", &locks);
        text += &clause("consumes", &takes);
        text += &clause("produces", &gives);
        Ok(text)
    }

    /// The amounts of reservoirs that an action reserves while it lasts.
    fn reserved(&self, action: &Action, place: &str) -> Result<String, PddlError> {
        let mut amounts = Vec::new();
        for (fluent, range) in self.ranges {
            for (side, _) in range.sides()? {
                let amount = range.reserved(*fluent, side, &action.throughout)?;
                if amount.is_positive() {
                    amounts.push(format!("{} {amount}", reservoir_of(self.ground, *fluent, side)?));
                }
            }
        }
        if !amounts.is_empty() && action.rests_on_start() {
            let what =
                "a condition over all on a number beside one that the start of the same action makes true";
            return Err(PddlError::Said { place: place.to_owned(), what });
        }
        Ok(clause("consumes", &amounts) + &clause("produces", &amounts))
    }

    /// Returns what an action adds to what is minimized.
    fn worth(&mut self, action: &Action) -> Result<String, PddlError> {
        let Some(metric) = &self.ground.metric else { return Ok(String::new()) };
        let mut worth = Rational::default();
        for (fluent, change) in action.snaps().into_iter().flat_map(|snap| &snap.changes) {
            let factor = metric.factors.get(fluent).copied().unwrap_or_default();
            let more = factor.checked_mul(*change).and_then(|more| worth.checked_add(more));
            worth = more.ok_or(PddlError::Number)?;
        }
        self.has_costs |= worth.is_positive();
        self.has_rewards |= worth.is_negative();
        Ok(match worth.checked_neg() {
            Some(reward) if reward.is_positive() => format!(" rewards {reward}"),
            _ if worth.is_positive() => format!(" costs {worth}"),
            _ => String::new(),
        })
    }

    /// Branches for what becomes true or false at a time.
    fn timed(&mut self) -> Result<Vec<String>, PddlError> {
        let mut at_times: BTreeMap<Rational, BTreeMap<Atom, bool>> = BTreeMap::new();
        for (time, atom, value) in &self.ground.timed {
            *at_times.entry(*time).or_default().entry(*atom).or_insert(*value) |= *value;
        }
        let mut branches = Vec::new();
        for (index, (time, sets)) in at_times.into_iter().enumerate() {
            let name = format!("initially{BEFORE_PART}{}", index + 1);
            let sets = self.sets(&sets)?;
            self.primitive(&name, self.epsilon, Some(self.epsilon), &clause("sets", &sets));
            branches.push(format!("{{ delay[{time},{time}]; {name}() }}"));
        }
        Ok(branches)
    }

    /// The statement that asks for the goal.
    fn goal(&mut self, goal: &Conditions) -> Result<String, PddlError> {
        let mut asks: Vec<String> =
            self.literals(&goal.literals)?.into_iter().map(|literal| format!("ask {literal}")).collect();
        if !goal.needs.is_empty() {
            let snap = Snap {
                conditions: Conditions { needs: goal.needs.clone(), ..Conditions::default() },
                ..Snap::default()
            };
            asks.extend(self.snap(&snap, None, &format!("goal{BEFORE_PART}numbers"), "the goal")?);
        }
        Ok(if asks.len() > 1 { format!("{{ {} }}", asks.join(", ")) } else { asks.concat() })
    }

    fn objective(&mut self, task: &Task, metric: Option<&Linear>) -> String {
        let (Some(metric), Some(written)) = (metric, &task.metric) else { return String::new() };
        let mut terms = Vec::new();
        if self.has_costs {
            terms.push("cost".to_owned());
        }
        if self.has_rewards {
            terms.push(if terms.is_empty() { "-reward" } else { "- reward" }.to_owned());
        }
        if metric.of_time.is_positive() {
            let sign = if terms.is_empty() { "" } else { "+ " };
            match metric.of_time.decimal() {
                Some(factor) if metric.of_time != Rational::ONE => {
                    terms.push(format!("{sign}{factor} * end"));
                }
                Some(_) => terms.push(format!("{sign}end")),
                None => terms.clear(),
            }
        }
        if terms.is_empty() || metric.of_time.is_negative() {
            self.remarks.push(format!(
                "the metric `{}` is left out, so plans are valid but not the best",
                written.text
            ));
            return String::new();
        }
        if let Some(last) =
            self.ground.timed.iter().map(|(time, _, _)| *time).max().filter(|_| metric.of_time.is_positive())
        {
            self.remarks.push(format!(
                "the mission ends after the last timed change, at {last}, even if the goal is reached earlier"
            ));
        }
        format!("\nobjective minimize {};\n", terms.join(" "))
    }

    /// The states, in the order of their names.
    fn states(&self) -> Result<String, PddlError> {
        let mut lines = BTreeSet::new();
        for atom in &self.states {
            let line = if let Some(group) = self.groups.of(*atom) {
                let named = |atom: &Atom| name_of(&self.ground.atoms, *atom);
                let atoms = &self.groups.all[group].atoms;
                let values = atoms.iter().map(named).collect::<Result<Vec<_>, _>>()?;
                let first = atoms.intersection(&self.ground.initial).next().map(named).transpose()?;
                let first = first.unwrap_or_else(|| NONE.to_owned());
                format!("state {} : {{{NONE}, {}}} = {first};\n", self.state_of(group)?, values.join(", "))
            } else {
                let value = if self.ground.initial.contains(atom) { "yes" } else { "no" };
                format!("state {} : {{no, yes}} = {value};\n", name_of(&self.ground.atoms, *atom)?)
            };
            lines.insert(line);
        }
        Ok(lines.into_iter().collect())
    }

    fn reservoirs(&self) -> Result<String, PddlError> {
        let mut text = String::new();
        for (fluent, range) in self.ranges {
            let words = self.ground.fluents.all[*fluent].join(" ");
            for (side, level) in range.sides()? {
                let reservoir = reservoir_of(self.ground, *fluent, side)?;
                let meaning = match side {
                    Side::Above => format!("({words}) - {}", range.least),
                    Side::Below => format!("{} - ({words})", range.greatest),
                };
                let _ = writeln!(text, "resource {reservoir} 0..{} = {level}; // {meaning}", range.size()?);
            }
            let _ = writeln!(text, "resource {};", lock_of(&self.ground.fluents, *fluent)?);
        }
        for atom in &self.mentioned {
            let _ = writeln!(text, "resource {};", lock_of(&self.ground.atoms, *atom)?);
        }
        Ok(text)
    }
}

/// The atoms that the start or the end of an action mentions and that another one sets.
fn mentioned(ground: &Ground) -> BTreeSet<Atom> {
    let snaps = || ground.actions.iter().flat_map(Action::snaps);
    let set: BTreeSet<Atom> = snaps().flat_map(|snap| snap.sets.keys().copied()).collect();
    snaps().flat_map(|snap| snap.conditions.mentioned.intersection(&set).copied()).collect()
}

fn clause(word: &str, parts: &[String]) -> String {
    if parts.is_empty() { String::new() } else { format!(" {word} {}", parts.join(", ")) }
}

fn bounds(least: Rational, greatest: Option<Rational>) -> String {
    format!("[{least},{}]", greatest.map_or_else(|| "inf".to_owned(), |greatest| greatest.to_string()))
}

fn name_of(names: &Names, id: usize) -> Result<String, PddlError> {
    name(&names.all[id])
}

fn reservoir_of(ground: &Ground, fluent: Fluent, side: Side) -> Result<String, PddlError> {
    let name = name_of(&ground.fluents, fluent)?;
    Ok(format!("{name}{BEFORE_PART}{}", if side == Side::Above { "level" } else { "room" }))
}

/// The resource that keeps changes of an atom or a number apart from each other and from conditions on it.
fn lock_of(names: &Names, id: usize) -> Result<String, PddlError> {
    Ok(format!("{}{BEFORE_PART}lock", name_of(names, id)?))
}

/// The words of an action, an atom or a number as one name of RMPL, from which they can be read again.
fn name(words: &[String]) -> Result<String, PddlError> {
    let is_letter = |letter: char| letter.is_ascii_alphanumeric() || "-_".contains(letter);
    let is_plain = |word: &&String| {
        word.chars().all(is_letter)
            && !word.contains(BETWEEN_WORDS)
            && !["--", "-_", "_-"].iter().any(|pair| word.contains(pair))
            && !word.starts_with(['-', '_'])
            && !word.ends_with(['-', '_'])
    };
    if let Some(word) = words.iter().find(|word| !is_plain(word)) {
        return Err(PddlError::Name { name: word.clone() });
    }
    match words {
        // Alone, a word could be one of the language.
        [word] => Ok(format!("{word}{BETWEEN_WORDS}")),
        words if words[0].starts_with(|first: char| first.is_ascii_alphabetic()) => {
            Ok(words.join(BETWEEN_WORDS))
        }
        words => Err(PddlError::Name { name: words[0].clone() }),
    }
}
