//! What is known of the state beside the sections of its description, for the facts of lessons: the answer to the present
//! text, the recorded searches, and what is looked at of them.

use kirk::{Event, Search as SearchKind};
use motion::GrowthStep;
use snapshot::{Snapshot, Stage};
use tpn::{Network, NodeId, Plan};

use super::program::ProgramVerdict;
use super::{Description, PlantState};
use crate::lesson::StepTarget;
use crate::state::automaton::{Moment, PlantMoment, Program};
use crate::state::diagnosing::{Diagnosing, StepConflicts};
use crate::state::lesson::Predictions;
use crate::state::search::{Counts, Recording};
use crate::state::{Selection, Status};

impl<'a> Description<'a> {
    pub(super) fn text(&self) -> &'a str {
        self.state.document.text()
    }

    pub(super) fn status(&self) -> Status {
        self.state.status()
    }

    pub(super) fn time(&self) -> f64 {
        self.state.playback.time
    }

    pub(super) fn shown(&self) -> Option<&'a Snapshot> {
        self.state.shown().map(AsRef::as_ref)
    }

    /// Returns what is known of the present text, complete.
    pub(super) fn fresh(&self) -> Option<&'a Snapshot> {
        self.shown().filter(|shown| self.is_complete(shown))
    }

    /// The answer to the present text, also if it does not compile.
    pub(super) fn latest(&self) -> Option<&'a Snapshot> {
        self.state.snapshots.latest().map(AsRef::as_ref).filter(|latest| self.is_complete(latest))
    }

    fn is_complete(&self, snapshot: &Snapshot) -> bool {
        snapshot.revision == self.state.document.revision() && snapshot.stage == Stage::Complete
    }

    pub(super) fn network(&self) -> Option<&'a Network> {
        self.fresh()?.network.as_deref()
    }

    pub(super) fn plan(&self) -> Option<(&'a Network, &'a Plan)> {
        Some((self.network()?, self.fresh()?.plan()?))
    }

    /// The node of an event by its name.
    pub(super) fn node(&self, event: &str) -> Option<NodeId> {
        match Selection::by_name(self.fresh()?, event)? {
            Selection::Node(node) => Some(node),
            _ => None,
        }
    }

    /// The time that an event is pinned to.
    pub(super) fn pinned(&self, node: NodeId) -> Option<exact::Time> {
        self.state.pins.all().into_iter().find(|(pinned, _)| *pinned == node).map(|(_, time)| time)
    }

    pub(super) fn selected_name(&self) -> String {
        self.state.selection.name(self.shown().and_then(|shown| shown.network.as_deref()))
    }

    pub(super) fn selected_kind(&self) -> &'static str {
        self.state.selection.kind()
    }

    /// Returns how many disturbances the run has.
    pub(super) fn disturbances(&self) -> usize {
        self.state.execution.disturbances().len()
    }

    /// The searches that are recorded of what is shown.
    pub(super) fn recordings(&self) -> Vec<Recording> {
        self.state.search.recordings(self.state.shown())
    }

    /// That of the search that is looked at, or of the one that is named.
    pub(super) fn recording(&self, which: &str) -> Option<Recording> {
        self.fresh()?;
        let mut recordings = self.recordings().into_iter();
        if which.is_empty() {
            return recordings.nth(self.state.search.side());
        }
        let kind = SearchKind::ALL.into_iter().find(|kind| kind.name() == which)?;
        recordings.find(|recording| recording.kind().unwrap_or(self.state.settings.plan.recorded()) == kind)
    }

    pub(super) fn counts(&self, which: &str) -> Option<Counts> {
        Some(Counts::of(self.recording(which)?.trace()))
    }

    /// A step of the search that is looked at, as a lesson names it, with its search.
    pub(super) fn step_called(&self, name: &str) -> Option<(Recording, usize)> {
        let step = self.state.step_of(&StepTarget::read(name).ok()?)?;
        Some((self.recording("")?, step))
    }

    /// The step that is looked at, with its search.
    pub(super) fn looked_at(&self) -> Option<(&'a Recording, &'a Event)> {
        let view = self.state.search.shown()?;
        let entry = view.recording.trace().events.get(view.step.step)?;
        Some((&view.recording, &entry.event))
    }

    /// The hitting-set tree of the last step, as far as it was built.
    pub(super) fn diagnosing(&self) -> Option<&'a Diagnosing> {
        self.state.automaton.diagnosing()
    }

    /// The conflicts of the last step.
    pub(super) fn step_conflicts(&self) -> Option<&'a StepConflicts> {
        self.state.automaton.step_conflicts()
    }

    /// The review of the present plan.
    pub(super) fn current_review(&self) -> Option<&'a review::Review> {
        self.state.review.current().map(AsRef::as_ref)
    }

    /// Returns what was predicted at the stop of the lesson.
    pub(super) fn predictions(&self) -> &'a Predictions {
        self.state.lesson.predictions()
    }

    /// Returns what the last sample of the growth did.
    pub(super) fn last_sample(&self) -> Option<&'a GrowthStep> {
        self.state.terrain.growth.shown()?.last()
    }

    pub(super) fn plant(&self) -> Option<&PlantState> {
        self.program()?.plant.as_ref()
    }

    pub(super) fn moment(&self) -> Option<&'a Moment> {
        self.state.automaton.moment()
    }

    /// Returns what the last proof says of a property.
    pub(super) fn verdict(&self, property: &str) -> Option<&ProgramVerdict> {
        let proof = self.program()?.proof.as_ref()?;
        proof.verdicts.iter().find(|verdict| verdict.property == property)
    }

    /// The plant at the moment that is looked at, with its model.
    pub(super) fn plant_of_moment(&self) -> Option<(&'a plant::Model, &'a PlantMoment)> {
        let model = self.state.automaton.program().and_then(Program::model)?;
        Some((model, self.moment()?.plant.as_ref()?))
    }
}
