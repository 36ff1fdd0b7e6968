//! Reading a control program: with the plant in its own text, with one that is given, or without any.

use std::collections::BTreeSet;
use std::sync::Arc;

use executive::model_based::System;
use hca::{Automaton, Vocabulary};
use plant::Model;
use rmpl::control::ControlFile;
use rmpl::{Diagnostic, Severity};
use smol_str::SmolStr;

/// What a text in prefix notation comes to.
#[derive(Clone, Debug)]
pub enum Control {
    /// A program and the plant that it controls.
    Bound(Arc<System>),
    /// A program alone: what is known of its variables must come from elsewhere.
    Unbound(Arc<Automaton>),
    /// A plant without a program.
    Plant(Arc<Model>),
    /// Neither, or with errors.
    Nothing,
}

impl Control {
    /// The program with its plant.
    pub(crate) fn system(&self) -> Result<&Arc<System>, String> {
        let Self::Bound(system) = self else {
            return Err("a control program with a plant is needed".to_owned());
        };
        Ok(system)
    }
}

/// Reads a text in prefix notation, and says what is wrong with it.
///
/// A program without a plant of its own is bound to `plant`, a model's text, if all its names fit.
pub fn read_control(text: &str, plant: Option<&str>) -> (Control, Vec<Diagnostic>) {
    let parsed = rmpl::control::parse(text);
    if parsed.has_errors() {
        return (Control::Nothing, parsed.diagnostics);
    }
    let ControlFile { definitions, classes, instances, .. } = &parsed.file;
    match (definitions.is_empty(), classes.is_empty() && instances.is_empty()) {
        (true, true) => (Control::Nothing, parsed.diagnostics),
        (true, false) => {
            let (model, found) = plant::compile(&parsed.file);
            let control = model.map_or(Control::Nothing, |model| Control::Plant(Arc::new(model)));
            (control, joined(parsed.diagnostics, found))
        }
        (false, false) => {
            let compiled = System::compile(text, None);
            let control = compiled.system.map_or(Control::Nothing, Control::Bound);
            (control, compiled.program_diagnostics)
        }
        (false, true) => {
            let system = plant.and_then(|plant| System::compile(text, Some(plant)).system);
            if let Some(system) = system.filter(|system| speaks_of_plant(system)) {
                return (Control::Bound(system), parsed.diagnostics);
            }
            // By SPEC 8.2 this one name is the program's own, whatever is known of the others.
            let program_variables = BTreeSet::from([SmolStr::new_static("exit")]);
            let vocabulary = Vocabulary { program_variables, ..Vocabulary::default() };
            let compiled = hca::compile_text(text, &vocabulary);
            let is_wrong = compiled.diagnostics.iter().any(|found| found.severity == Severity::Error);
            let automaton = compiled.automaton.filter(|_| !is_wrong);
            let control = automaton.map_or(Control::Nothing, Control::Unbound);
            (control, compiled.diagnostics)
        }
    }
}

/// Everything that is wrong with a text in prefix notation, and where its program may wait forever.
pub(crate) fn check_control(text: &str) -> Vec<Diagnostic> {
    let (control, mut found) = read_control(text, None);
    if let Control::Bound(system) = control {
        found.extend(executive::model_based::waits_forever(&system));
        found.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
    }
    found
}

/// Returns whether a program has anything to do with its plant: one whose variables are all its own fits every plant.
fn speaks_of_plant(system: &System) -> bool {
    system.automaton.variables.iter().any(|variable| !variable.is_program_variable)
}

fn joined(mut diagnostics: Vec<Diagnostic>, found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.extend(found);
    diagnostics.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
    diagnostics
}

/// The control text that was read last, so that each content is compiled once.
#[derive(Debug, Default)]
pub(crate) struct ControlTexts {
    read: Option<ReadText>,
}

#[derive(Debug)]
struct ReadText {
    text: Arc<str>,
    /// What it comes to by itself.
    alone: Control,
    found: Vec<Diagnostic>,
    /// What it comes to with a plant that is given.
    with_plant: Option<(Arc<str>, Control)>,
}

impl ControlTexts {
    /// Returns what `text` comes to; a program without a plant of its own is bound to `plant`, if all its names fit.
    pub(crate) fn read(&mut self, text: &Arc<str>, plant: Option<&Arc<str>>) -> &Control {
        let read = self.follow(text);
        match plant {
            Some(plant) if matches!(read.alone, Control::Unbound(_) | Control::Nothing) => {
                let known = read.with_plant.take().filter(|(known, _)| known == plant);
                let bound = known.unwrap_or_else(|| (Arc::clone(plant), read_control(text, Some(plant)).0));
                &read.with_plant.insert(bound).1
            }
            _ => &read.alone,
        }
    }

    /// Returns what is wrong with `text`.
    pub(crate) fn diagnostics(&mut self, text: &Arc<str>) -> &[Diagnostic] {
        &self.follow(text).found
    }

    fn follow(&mut self, text: &Arc<str>) -> &mut ReadText {
        let known = self.read.take().filter(|known| known.text == *text);
        self.read.insert(known.unwrap_or_else(|| {
            let (alone, found) = read_control(text, None);
            ReadText { text: Arc::clone(text), alone, found, with_plant: None }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROGRAM: &str = "Main ():: (WHEN-DONEXT (Lamp = On) (Lamp = Off))";
    const PLANT: &str = "(DEFCLASS Lamp () (COMMAND cmd {none on off}) (MODE Off true) (MODE On true)
        (TRANSITION On Off (cmd = off)) (TRANSITION Off On (cmd = on)))
        (DEFINSTANCE Lamp Lamp INIT On)";

    #[test]
    fn a_program_takes_the_plant_beside_it_or_the_one_that_is_given() {
        let together = format!("{PROGRAM}\n{PLANT}");
        let (control, found) = read_control(&together, None);
        assert!(matches!(control, Control::Bound(_)), "{found:?}");
        assert!(matches!(read_control(PROGRAM, Some(PLANT)).0, Control::Bound(_)));
    }

    #[test]
    fn a_program_that_does_not_fit_the_given_plant_stands_alone() {
        let other = PROGRAM.replace("Lamp", "Engine");
        let (control, found) = read_control(&other, Some(PLANT));
        assert!(matches!(control, Control::Unbound(_)), "{found:?}");
        assert!(found.is_empty(), "{found:?}");
    }

    #[test]
    fn a_program_that_does_not_speak_of_the_given_plant_stands_alone() {
        let own = "Main ():: (WHEN-DONEXT (ready = yes) (ready = no))";
        assert!(matches!(read_control(own, Some(PLANT)).0, Control::Unbound(_)));
    }

    #[test]
    fn a_trap_of_a_program_that_stands_alone_is_left_by_its_exit() {
        let trap = "(SEQUENCE (DO-WATCHING (exit = true) (PARALLEL (ALWAYS (y = b)) (exit = true))) (z = c))";
        let (Control::Unbound(automaton), _) = read_control(trap, None) else { panic!("a program alone") };
        let mut stepper = hca::Stepper::new(&automaton);
        stepper.step(&hca::Estimate::unknown(automaton.variables.len()));
        assert_eq!(hca::TraceStep::at(&stepper, 2).labels, ["assert z=c"]);
    }

    #[test]
    fn a_plant_alone_is_no_error_and_a_broken_text_tells_where() {
        let (control, found) = read_control(PLANT, None);
        assert!(matches!(control, Control::Plant(_)) && found.is_empty(), "{found:?}");
        let (control, found) = read_control("Main ():: (WHEN-DONEXT (Lamp = On)", None);
        assert!(matches!(control, Control::Nothing) && !found.is_empty());
    }
}
