//! What is computed from what, and when: a table of inputs and of what depends on them.
//!
//! An input counts its changes. After a command, an answer, or a moment that went by, each row whose inputs have changed
//! since it last ran is computed, from the top; a row that changes the input of an earlier one makes that one due again.

use std::sync::Arc;

use link::Request;
use snapshot::Snapshot;

use crate::library::picture;
use crate::state::derived::Derivation;
use crate::state::selection::Selection;
use crate::state::{AppState, playback};

/// Something that other things are computed from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Input {
    Text,
    /// The text with its carets.
    Carets,
    /// What the planning core answered.
    Answers,
    Settings,
    Workspace,
    Time,
    Search,
    Program,
    Run,
    Terrain,
    Review,
    Chance,
    Pins,
    Selection,
    Lesson,
}

use Input::{
    Answers, Carets, Chance, Lesson, Program, Review, Run, Search, Settings, Terrain, Text, Time, Workspace,
};

/// A row of the table.
struct Row {
    of: Derivation,
    from: &'static [Input],
    compute: fn(&mut AppState),
}

static TABLE: [Row; 10] = [
    Row { of: Derivation::Language, from: &[Text], compute: |it| it.language.follow(&it.document) },
    Row { of: Derivation::Folding, from: &[Carets], compute: AppState::follow_folding },
    Row { of: Derivation::Program, from: &[Text], compute: AppState::follow_program },
    Row { of: Derivation::Conflicts, from: &[Program], compute: AppState::follow_conflicts },
    Row { of: Derivation::Shown, from: &[Answers], compute: AppState::follow_shown },
    Row {
        of: Derivation::Review,
        from: &[Text, Answers, Settings, Review, Chance],
        compute: |it| it.reviewing().follow(),
    },
    Row { of: Derivation::Extent, from: &[Answers, Run, Workspace], compute: AppState::fit_time },
    Row { of: Derivation::Moment, from: &[Answers, Run, Workspace, Time], compute: AppState::follow_run },
    Row {
        of: Derivation::Lesson,
        from: &[
            Text,
            Answers,
            Settings,
            Time,
            Search,
            Program,
            Run,
            Terrain,
            Review,
            Input::Pins,
            Input::Selection,
            Lesson,
        ],
        compute: AppState::follow_lesson,
    },
    Row {
        of: Derivation::Questions,
        from: &[Text, Answers, Settings, Search, Program, Terrain],
        compute: AppState::ask_the_core,
    },
];

impl AppState {
    /// Computes whatever depends on what has changed.
    pub(crate) fn derive(&mut self) {
        self.derived.latest.clear();
        while let Some(row) = TABLE.iter().find(|row| self.is_due(row)) {
            (row.compute)(self);
            // What a row changes of its own inputs, it knows.
            let seen = row.from.iter().map(|&input| self.changes_of(input)).collect();
            self.derived.seen.insert(row.of, seen);
            self.derived.latest.push(row.of);
        }
    }

    fn is_due(&self, row: &Row) -> bool {
        let changes = row.from.iter().map(|&input| self.changes_of(input));
        self.derived.seen.get(&row.of).is_none_or(|seen| changes.ne(seen.iter().copied()))
    }

    /// Returns how often an input has changed.
    fn changes_of(&self, input: Input) -> u64 {
        match input {
            Text => self.document.revision(),
            Carets => self.document.changes(),
            Answers => self.snapshots.changes(),
            Settings => self.settings.changes(),
            Workspace => self.window.workspace as u64,
            Time => self.playback.changes(),
            Search => self.search.changes(),
            Program => self.automaton.changes(),
            Run => self.execution.changes(),
            Terrain => self.terrain.changes(),
            Review => self.review.changes(),
            Chance => self.chance.changes(),
            Input::Pins => self.pins.changes(),
            Input::Selection => self.selection.changes(),
            Lesson => self.lesson.changes(),
        }
    }

    fn follow_folding(&mut self) {
        self.editor.folding.follow(&mut self.document, self.language.parse());
    }

    fn follow_program(&mut self) {
        self.automaton.follow(&self.document, self.language.is_control());
    }

    fn follow_conflicts(&mut self) {
        // Mutable access to the program makes everything that depends on it due again.
        if self.automaton.has_other_conflicts() {
            self.automaton.follow_conflicts();
        }
    }

    /// Carries over to what is shown now what belongs to what was shown before.
    fn follow_shown(&mut self) {
        let after = self.snapshots.shown().cloned();
        let before = std::mem::replace(&mut self.derived.shown, after.clone());
        let Some(after) = after else { return };
        if before.as_ref().is_some_and(|before| Arc::ptr_eq(before, &after)) {
            return;
        }
        self.search.follow(before.as_ref(), &after);
        let same_plan = |before: &Arc<Snapshot>| match (&before.planning, &after.planning) {
            (Some(before), Some(after)) => Arc::ptr_eq(before, after),
            _ => false,
        };
        if !before.as_ref().is_some_and(same_plan) {
            self.pins.follow(before.as_deref(), &after);
            self.reason = 0;
        }
        if let Some(before) = before {
            self.carry_selection(&before, &after);
            self.hovered = Selection::None;
        }
        if let Some((_, at)) = self.derived.made.take_if(|(revision, _)| *revision <= after.revision) {
            *self.selection = Selection::at_offset(&after, at, &self.selection);
        }
        let input = self.maps.growth_input(&self.snapshots, &self.selection);
        self.terrain.growth.follow(input);
        if after.revision == self.document.revision()
            && let Some(picture) = picture(&after)
        {
            self.library.take_picture(picture);
        }
    }

    /// Carries the selection over to a newer snapshot. If an edit removes the selected thing, it is selected again when it
    /// returns, such as after an undo, unless something else was selected meanwhile.
    fn carry_selection(&mut self, before: &Snapshot, after: &Snapshot) {
        if self.selection.is_none() {
            let lost = self.derived.lost_selection.as_deref();
            let again = lost.and_then(|name| Selection::by_name(after, name));
            if let Some(again) = again {
                self.derived.lost_selection = None;
                *self.selection = again;
            }
            return;
        }
        let carried = self.selection.carried(before, after);
        let name = self.selection.name(before.network.as_deref());
        self.derived.lost_selection = (carried.is_none() && !name.is_empty()).then_some(name);
        *self.selection = carried;
    }

    /// Lets time end where the run does, or where the plan does when none is watched.
    fn fit_time(&mut self) {
        let run = self.run_shown().map(|run| playback::number(run.end()));
        let end = run.or_else(|| self.shown()?.plan().map(playback::end));
        if let Some(end) = end.filter(|&end| end != self.playback.end || self.playback.time > end) {
            self.playback.fit(end);
        }
    }

    /// Computes what the time shown shows of the run.
    fn follow_run(&mut self) {
        if self.is_executing()
            && let Some(base) = self.shown().cloned()
        {
            let view = self.execution.view_at(&base, self.playback.time);
            if let Some(view) = view {
                self.execution.show(view);
            }
        }
    }

    /// Asks the core for what the state now wants to know.
    fn ask_the_core(&mut self) {
        let revision = self.document.revision();
        if self.search.wants_comparison(self.snapshots.shown(), revision)
            && let Some(update) = self.update_planned()
        {
            self.search.note_asked(revision);
            self.window.post(Request::CompareSearches(update));
        }
        if self.automaton.wants_answer() {
            let wanted = self.automaton.request(&self.document);
            self.window.post(Request::RunControl(wanted));
        }
        if self.automaton.proof.is_wanted() {
            self.automaton.prove_on(&self.document, &mut self.window);
        }
        if self.terrain.growth.wants_answer()
            && let Some(update) = self.update_with_plan()
            && let Some(wanted) = self.terrain.growth.take_request(update)
        {
            self.window.post(Request::GrowPath(wanted));
        }
    }
}
