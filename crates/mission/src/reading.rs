//! A text, read and compiled, that follows its edits.
//!
//! An edit parses again only the declarations it touches. If the program says the same afterwards, only in other
//! places, its network is kept, and the places in it move.

use std::sync::Arc;

use interchange::is_network_text;
use link::Source;
use rmpl::program::{ControlDecl, Options, Program, Runs};
use rmpl::spans::Spans as _;
use rmpl::{Diagnostic, Parse, Severity, Shift};
use smol_str::SmolStr;
use snapshot::ContentKey;
use snapshot::content::{Keyed, Keys};
use snapshot::{Goal, MapKey};
use tpn::{Network, Top};

use crate::evaluated::Ground;
use crate::ground::Grounds;
use crate::network_text::NetworkText;
use crate::programs::Programs;
use crate::saved_state::SavedState;
use crate::sight::{self, Seeing};

/// What an edit came to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Followed {
    /// The program is the same, in the same places.
    Same,
    /// The program is the same, but its places have moved.
    Moved(Shift),
    /// The program is another one.
    Changed,
}

/// A text with what was made of it.
#[derive(Debug, Default)]
pub(crate) struct Reading {
    /// Of the text that was parsed last.
    revision: Option<u64>,
    /// Instead of a mission, if the text is a network.
    network_text: Option<NetworkText>,
    parse: Parse,
    program: Option<Keyed<Program>>,
    compiled: Option<Compiled>,
    programs: Option<CompiledPrograms>,
    /// What the mission starts from instead of what its text says.
    start: Option<SavedState>,
}

/// The network of a goal.
#[derive(Debug)]
struct Compiled {
    goal: Goal,
    /// The map that decided what is in sight, if that counts.
    map: Option<MapKey>,
    /// The network, whether or not an error forbids to plan it.
    network: Option<Keyed<Network>>,
    is_sound: bool,
    /// What compiling the network found.
    found: Vec<Diagnostic>,
    /// All that is wrong with the text.
    diagnostics: Vec<Diagnostic>,
}

/// The control programs of a mission, with what they were compiled from.
#[derive(Debug)]
struct CompiledPrograms {
    control: Vec<ControlDecl>,
    runners: Vec<(SmolStr, Runs)>,
    /// What activities are called with whose programs are handed that.
    calls: Vec<(SmolStr, Vec<SmolStr>)>,
    options: Options,
    programs: Arc<Programs>,
    found: Vec<Diagnostic>,
}

impl Reading {
    /// Reads the text of a revision. Where it is not known which edits led there, the texts are compared.
    pub(crate) fn follow(&mut self, revision: u64, text: &Source, keys: &mut Keys) -> Followed {
        if is_network_text(text) {
            return self.follow_network(text, keys);
        }
        if self.network_text.take().is_some() {
            self.compiled = None;
        }
        let known = text.shift_from(self.revision.replace(revision));
        let shift = known.unwrap_or_else(|| Shift::between(self.parse.text(), text));
        if shift.is_nothing() && self.program.is_some() {
            return Followed::Same;
        }
        self.parse.follow(Arc::clone(text.text()), shift);
        let mut program = self.parse.program();
        if let Some(start) = &self.start {
            start.begin(&mut program);
        }
        let Some(before) = &mut self.program else {
            self.program = Some(Keyed { key: keys.fresh(), value: Arc::new(program) });
            self.compiled = None;
            return Followed::Changed;
        };
        if *before.value == program {
            // What the text is told by its diagnostics may have changed all the same.
            if let Some(compiled) = &mut self.compiled {
                compiled.tell(&self.parse, self.programs.as_ref());
            }
            return Followed::Same;
        }
        let mut moved = Program::clone(&before.value);
        moved.follow(shift);
        if moved != program {
            self.program = Some(Keyed { key: keys.fresh(), value: Arc::new(program) });
            self.compiled = None;
            return Followed::Changed;
        }
        before.value = Arc::new(program);
        if let Some(programs) = &mut self.programs {
            programs.control.follow(shift);
            programs.runners.iter_mut().for_each(|(_, name)| name.follow(shift));
            programs.found.follow(shift);
        }
        if let Some(compiled) = &mut self.compiled {
            if let Some(network) = &mut compiled.network {
                Arc::make_mut(&mut network.value).follow(shift);
            }
            compiled.found.follow(shift);
            compiled.tell(&self.parse, self.programs.as_ref());
        }
        Followed::Moved(shift)
    }

    /// Reads the text of a network; any change of it gives another one.
    fn follow_network(&mut self, text: &str, keys: &mut Keys) -> Followed {
        if self.network_text.as_ref().is_some_and(|known| known.is_of(text)) {
            return Followed::Same;
        }
        let read = NetworkText::read(text);
        let network = read.network.clone().map(|value| Keyed { key: keys.fresh(), value });
        *self = Self::default();
        self.program = Some(Keyed { key: keys.fresh(), value: Arc::default() });
        let diagnostics = read.found.clone();
        let (is_sound, found) = (read.is_sound(), Vec::new());
        self.compiled =
            Some(Compiled { goal: Goal::Default, map: None, network, is_sound, found, diagnostics });
        self.network_text = Some(read);
        Followed::Changed
    }

    /// Lets the texts that are read from now on start from a state.
    pub(crate) fn start_from(&mut self, start: SavedState) {
        *self = Self { start: Some(start), ..Self::default() };
    }

    /// The program of the text, and its key.
    pub(crate) fn program(&self) -> Keyed<Program> {
        self.program.clone().unwrap_or_else(|| Keyed { key: ContentKey::default(), value: Arc::default() })
    }

    /// Returns whether the text is a network instead of a mission.
    pub(crate) fn is_network(&self) -> bool {
        self.network_text.is_some()
    }

    /// Returns what is wrong with the text, before it is compiled.
    pub(crate) fn diagnostics(&self) -> Vec<Diagnostic> {
        self.parse.diagnostics()
    }

    /// The network that was compiled last.
    pub(crate) fn network(&self) -> Option<Arc<Network>> {
        Some(Arc::clone(&self.compiled.as_ref()?.network.as_ref()?.value))
    }

    pub(crate) fn network_key(&self) -> Option<ContentKey> {
        Some(self.compiled.as_ref()?.network.as_ref()?.key)
    }

    /// Compiles the control programs that the mission's activities run, once for each content.
    fn compile_programs(&mut self, network: Option<&Network>) {
        let program = self.program();
        let runners: Vec<(SmolStr, Runs)> = (program.value.primitives.iter())
            .filter_map(|primitive| Some((primitive.name.text.clone(), primitive.runs.as_deref().cloned()?)))
            .collect();
        let is_handed = |activity: &SmolStr| {
            runners.iter().any(|(name, runs)| name == activity && !runs.arguments.is_empty())
        };
        let occurrences = network.into_iter().flat_map(|network| &network.occurrences);
        let mut calls: Vec<(SmolStr, Vec<SmolStr>)> = occurrences
            .filter(|it| is_handed(&it.activity))
            .map(|it| (it.activity.clone(), it.arguments.clone()))
            .collect();
        calls.sort_unstable();
        calls.dedup();
        let options = &program.value.options;
        let is_known = self.programs.as_ref().is_some_and(|known| {
            known.control == program.value.control
                && known.runners == runners
                && known.calls == calls
                && known.options == *options
        });
        if !is_known {
            let (programs, found) = Programs::compile(&program.value, network);
            let (control, programs) = (program.value.control.clone(), Arc::new(programs));
            let options = options.clone();
            self.programs = Some(CompiledPrograms { control, runners, calls, options, programs, found });
        }
    }

    /// The control programs of the network that was compiled last.
    pub(crate) fn programs(&self) -> Arc<Programs> {
        self.programs.as_ref().map_or_else(Arc::default, |known| Arc::clone(&known.programs))
    }

    /// The network of `goal` on its ground, if no error prevents it, and all that is wrong with the text.
    pub(crate) fn compile(
        &mut self,
        goal: &Goal,
        grounds: &mut Grounds,
        keys: &mut Keys,
    ) -> (Option<Keyed<Network>>, Vec<Diagnostic>) {
        // A network is one thing to plan, whatever the goal.
        let is_network = self.network_text.is_some();
        let program = self.program();
        let ground = sight::ground(&program.value, grounds);
        let map = ground.as_ref().map(|(key, _)| key.clone());
        let is_known = |known: &&Compiled| is_network || (known.goal == *goal && known.map == map);
        if let Some(known) = self.compiled.as_ref().filter(is_known) {
            return known.answer();
        }
        let (network, found) = compiled_on(&program.value, goal, ground.as_ref());
        self.compile_programs(network.as_ref());
        let network = network.map(|network| Keyed { key: keys.fresh(), value: Arc::new(network) });
        let goal = goal.clone();
        let mut compiled = Compiled { goal, map, network, is_sound: false, found, diagnostics: Vec::new() };
        compiled.tell(&self.parse, self.programs.as_ref());
        let answer = compiled.answer();
        self.compiled = Some(compiled);
        answer
    }
}

impl Compiled {
    fn tell(&mut self, parse: &Parse, programs: Option<&CompiledPrograms>) {
        self.diagnostics = parse.diagnostics();
        tpn::merge_diagnostics(&mut self.diagnostics, self.found.clone());
        self.diagnostics.extend(programs.into_iter().flat_map(|it| it.found.iter().cloned()));
        self.is_sound = self.diagnostics.iter().all(|found| found.severity != Severity::Error);
    }

    fn answer(&self) -> (Option<Keyed<Network>>, Vec<Diagnostic>) {
        (self.network.clone().filter(|_| self.is_sound), self.diagnostics.clone())
    }
}

/// The networks of all scenarios, in textual order, as far as no error prevents one; adds what compiling finds to
/// `diagnostics`. Only with `keep` do the networks stay: they may be many.
pub(crate) fn compile_scenarios(
    program: &Program,
    grounds: &mut Grounds,
    diagnostics: &mut Vec<Diagnostic>,
    keep: bool,
) -> Option<Vec<Network>> {
    let mut networks = Vec::new();
    let mut is_complete = true;
    let (_, mut of_programs) = Programs::compile(program, None);
    let depend_on_calls = Programs::depend_on_calls(program);
    let ground = sight::ground(program, grounds);
    let seeing = ground.as_ref().map(|(_, map)| Seeing::new(&program.world, map));
    let ground = seeing.as_ref().map_or(&tpn::Level as &dyn tpn::Ground, |seeing| seeing);
    let found = tpn::compile_scenarios(program, ground, |network| {
        if depend_on_calls {
            let (_, found) = Programs::compile(program, network.as_ref());
            for diagnostic in found {
                if !of_programs.contains(&diagnostic) {
                    of_programs.push(diagnostic);
                }
            }
        }
        is_complete &= network.is_some();
        networks.extend(network.filter(|_| keep));
    });
    tpn::merge_diagnostics(diagnostics, found);
    diagnostics.extend(of_programs);
    let is_sound = diagnostics.iter().all(|found| found.severity != Severity::Error);
    (is_complete && is_sound).then_some(networks)
}

/// The network of what is to be planned without heights, if no error prevents it; adds what compiling finds to
/// `diagnostics`.
pub fn compile(program: &Program, goal: &Goal, diagnostics: &mut Vec<Diagnostic>) -> Option<Network> {
    compile_over(program, goal, None, diagnostics)
}

/// [`compile`] on the ground of the mission.
pub(crate) fn compile_on(
    program: &Program,
    goal: &Goal,
    grounds: &mut Grounds,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<Network> {
    compile_over(program, goal, sight::ground(program, grounds).as_ref(), diagnostics)
}

fn compile_over(
    program: &Program,
    goal: &Goal,
    ground: Option<&Ground>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<Network> {
    let (network, found) = compiled_on(program, goal, ground);
    tpn::merge_diagnostics(diagnostics, found);
    diagnostics.extend(Programs::compile(program, network.as_ref()).1);
    network.filter(|_| diagnostics.iter().all(|found| found.severity != Severity::Error))
}

fn compiled_on(
    program: &Program,
    goal: &Goal,
    ground: Option<&Ground>,
) -> (Option<Network>, Vec<Diagnostic>) {
    let top = top(program, goal);
    match ground {
        Some((_, map)) => tpn::compile_on(program, &top, &Seeing::new(&program.world, map)),
        None => tpn::compile(program, &top),
    }
}

fn top(program: &Program, goal: &Goal) -> Top {
    match goal {
        Goal::Default => match (program.scenarios.first(), program.activities.last()) {
            (None, Some(activity)) => Top::activity(activity.name.text.clone()),
            _ => Top::Scenario(None),
        },
        Goal::FirstScenario => Top::Scenario(None),
        Goal::Scenario(name) => Top::Scenario(Some(name.clone())),
        Goal::Activity { name, lower, upper } => {
            Top::Activity { name: name.clone(), lower: *lower, upper: *upper }
        }
    }
}

#[cfg(test)]
mod tests {
    use link::Since;
    use rmpl::{Edit, Span};

    use super::*;

    /// A text whose comment was replaced, and how many declarations that took.
    fn followed(since: u64) -> (Followed, u64) {
        let (mut reading, mut keys) = (Reading::default(), Keys::default());
        let before = "// note\nprimitive A()[1,2]; primitive B()[1,2];\nscenario S[0,9] = { A(); B() }\n";
        reading.follow(1, &before.into(), &mut keys);
        let read = reading.parse.declarations_read();
        let edits = vec![Edit { span: Span::new(3, 7), text: "notes".to_owned() }];
        let since = Some(Since { revision: since, edits });
        let after = Source::edited(before.replace("note", "notes"), since);
        let followed = reading.follow(2, &after, &mut keys);
        assert_eq!(reading.program().value, rmpl::parse(&after).program().into());
        (followed, reading.parse.declarations_read() - read)
    }

    #[test]
    fn an_edit_that_is_known_is_not_looked_for() {
        let told = Shift { start: 3, removed: 4, inserted: 5 };
        assert_eq!(followed(1), (Followed::Moved(told), 1));
    }

    #[test]
    fn where_the_edits_are_of_another_text_both_texts_are_compared() {
        let least = Shift { start: 7, removed: 0, inserted: 1 };
        assert_eq!(followed(7), (Followed::Moved(least), 1));
    }
}
