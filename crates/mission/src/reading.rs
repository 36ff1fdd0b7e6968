//! A text, read and compiled, that follows its edits.
//!
//! An edit parses again only the declarations it touches. If the program says the same afterwards, only in other
//! places, its network is kept, and the places in it move.

use std::sync::Arc;

use exact::Time;
use interchange::is_network_text;
use rmpl::program::{ControlDecl, Program, Runs};
use rmpl::spans::{Spans as _, difference};
use rmpl::{Diagnostic, Edit, Parse, Severity};
use smol_str::SmolStr;
use snapshot::ContentKey;
use snapshot::Goal;
use snapshot::content::{Keyed, Keys};
use tpn::{Network, Top};

use crate::network_text::NetworkText;
use crate::programs::Programs;

/// What an edit came to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Followed {
    /// The program is the same, in the same places.
    Same,
    /// The program is the same, but its places have moved through this edit.
    Moved(Edit),
    /// The program is another one.
    Changed,
}

/// A text with what was made of it.
#[derive(Debug, Default)]
pub(crate) struct Reading {
    /// Instead of a mission, if the text is a network.
    network_text: Option<NetworkText>,
    parse: Parse,
    program: Option<Keyed<Program>>,
    compiled: Option<Compiled>,
    programs: Option<CompiledPrograms>,
}

/// The network of a goal.
#[derive(Debug)]
struct Compiled {
    goal: Goal,
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
    step: Time,
    programs: Arc<Programs>,
    found: Vec<Diagnostic>,
}

impl Reading {
    /// Reads `text`, as an edit of the text before.
    pub(crate) fn follow(&mut self, text: &str, keys: &mut Keys) -> Followed {
        if is_network_text(text) {
            return self.follow_network(text, keys);
        }
        if self.network_text.take().is_some() {
            self.compiled = None;
        }
        let edit = difference(self.parse.text(), text);
        if let (true, true, Some(_)) = (edit.span.range().is_empty(), edit.text.is_empty(), &self.program) {
            return Followed::Same;
        }
        self.parse.edit(&edit);
        let program = self.parse.program();
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
        moved.follow(&edit);
        if moved != program {
            self.program = Some(Keyed { key: keys.fresh(), value: Arc::new(program) });
            self.compiled = None;
            return Followed::Changed;
        }
        before.value = Arc::new(program);
        if let Some(programs) = &mut self.programs {
            programs.control.follow(&edit);
            programs.runners.iter_mut().for_each(|(_, name)| name.follow(&edit));
            programs.found.follow(&edit);
        }
        if let Some(compiled) = &mut self.compiled {
            if let Some(network) = &mut compiled.network {
                Arc::make_mut(&mut network.value).follow(&edit);
            }
            compiled.found.follow(&edit);
            compiled.tell(&self.parse, self.programs.as_ref());
        }
        Followed::Moved(edit)
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
        self.compiled = Some(Compiled { goal: Goal::Default, network, is_sound, found, diagnostics });
        self.network_text = Some(read);
        Followed::Changed
    }

    /// The program of the text, and its key.
    pub(crate) fn program(&self) -> Keyed<Program> {
        self.program.clone().unwrap_or_else(|| Keyed { key: ContentKey::default(), value: Arc::default() })
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
            .filter_map(|primitive| Some((primitive.name.text.clone(), primitive.runs.clone()?)))
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
        let step = program.value.options.control_step;
        let is_known = self.programs.as_ref().is_some_and(|known| {
            known.control == program.value.control
                && known.runners == runners
                && known.calls == calls
                && known.step == step
        });
        if !is_known {
            let (programs, found) = Programs::compile(&program.value, network);
            let (control, programs) = (program.value.control.clone(), Arc::new(programs));
            self.programs = Some(CompiledPrograms { control, runners, calls, step, programs, found });
        }
    }

    /// The control programs of the network that was compiled last.
    pub(crate) fn programs(&self) -> Arc<Programs> {
        self.programs.as_ref().map_or_else(Arc::default, |known| Arc::clone(&known.programs))
    }

    /// The network of `goal`, if no error prevents it, and all that is wrong with the text.
    pub(crate) fn compile(
        &mut self,
        goal: &Goal,
        keys: &mut Keys,
    ) -> (Option<Keyed<Network>>, Vec<Diagnostic>) {
        // A network is one thing to plan, whatever the goal.
        let is_network = self.network_text.is_some();
        let known = self.compiled.as_ref().filter(|known| is_network || known.goal == *goal);
        if let Some(known) = known {
            return known.answer();
        }
        let program = self.program();
        let (network, found) = tpn::compile(&program.value, &top(&program.value, goal));
        self.compile_programs(network.as_ref());
        let network = network.map(|network| Keyed { key: keys.fresh(), value: Arc::new(network) });
        let goal = goal.clone();
        let mut compiled = Compiled { goal, network, is_sound: false, found, diagnostics: Vec::new() };
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
pub fn compile_scenarios(
    program: &Program,
    diagnostics: &mut Vec<Diagnostic>,
    keep: bool,
) -> Option<Vec<Network>> {
    let mut networks = Vec::new();
    let mut is_whole = true;
    let (_, mut of_programs) = Programs::compile(program, None);
    let depend_on_calls = Programs::depend_on_calls(program);
    let found = tpn::compile_scenarios(program, |network| {
        if depend_on_calls {
            let (_, found) = Programs::compile(program, network.as_ref());
            for diagnostic in found {
                if !of_programs.contains(&diagnostic) {
                    of_programs.push(diagnostic);
                }
            }
        }
        is_whole &= network.is_some();
        networks.extend(network.filter(|_| keep));
    });
    tpn::merge_diagnostics(diagnostics, found);
    diagnostics.extend(of_programs);
    let is_sound = diagnostics.iter().all(|found| found.severity != Severity::Error);
    (is_whole && is_sound).then_some(networks)
}

/// The network of what is to be planned, if no error prevents it; adds what compiling finds to `diagnostics`.
pub fn compile(program: &Program, goal: &Goal, diagnostics: &mut Vec<Diagnostic>) -> Option<Network> {
    let (network, found) = tpn::compile(program, &top(program, goal));
    tpn::merge_diagnostics(diagnostics, found);
    diagnostics.extend(Programs::compile(program, network.as_ref()).1);
    network.filter(|_| diagnostics.iter().all(|found| found.severity != Severity::Error))
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
