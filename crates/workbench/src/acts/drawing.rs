//! Drawing: changes of activities that are made in network, timeline and map, each as one edit of the text.

use rmpl::{Parse, Span};
use text_editing::{Caret, EditKind, TextCommand};

use crate::effect::Effect;
use crate::panel_kind::PanelKind;
use crate::state::AppState;
use crate::state::drawing::{self, Change, DrawCommand, Drawn, Place};
use crate::state::files;

/// A preview of a change has at most this many lines.
const PREVIEW_LINES: usize = 8;

impl AppState {
    /// The statement that is selected, if a drawing of the present text can change it.
    pub fn drawn_statement(&self) -> Option<Span> {
        let shown = self.shown().filter(|shown| shown.revision == self.document.revision())?;
        let span = self.selection.span(shown)?;
        let parse = self.language.parse()?;
        drawing::is_statement(parse, span).then_some(span)
    }

    /// The lines of the text that a change would change; `Err` says why it cannot be made.
    pub fn drawing_preview(&self, change: &Change) -> Result<String, String> {
        let parse = self.drawn_text()?;
        Ok(drawing::draw(parse, files::shown(&self.document), change)?.preview(parse.text(), PREVIEW_LINES))
    }

    /// The text, if the drawings are up to date with it.
    fn drawn_text(&self) -> Result<&Parse, String> {
        if self.snapshots.is_stale(self.document.revision()) {
            return Err("The drawing is out of date. Fix the errors of the text first.".to_owned());
        }
        self.language.parse().ok_or_else(|| "Control programs cannot be drawn. Edit the text.".to_owned())
    }

    pub(super) fn apply_to_drawing(&mut self, command: DrawCommand) {
        let selected = self.drawn_statement();
        let after = selected.map_or(Place::End, Place::After);
        let change = match command {
            DrawCommand::Make(change) => Some(change),
            DrawCommand::Add => Some(Change::New { at: after }),
            DrawCommand::AddBeside => Some(Change::New { at: selected.map_or(Place::Thread, Place::Beside) }),
            DrawCommand::Shift { forwards } => selected.and_then(|what| {
                let next = drawing::neighbor(self.language.parse()?, what, forwards)?;
                let at = if forwards { Place::After(next) } else { Place::Before(next) };
                Some(Change::Move { what, at })
            }),
            DrawCommand::Delete => selected.map(Change::Delete),
            DrawCommand::Copy { cut } => {
                let parse = self.language.parse();
                let text = parse.zip(selected).and_then(|(parse, what)| drawing::statement_text(parse, what));
                if let Some(text) = text {
                    self.window.ask(Effect::Copy(text));
                }
                selected.filter(|_| cut).map(Change::Delete)
            }
            DrawCommand::Paste(text) => {
                let text = text.replace("\r\n", "\n");
                let text = text.trim().trim_end_matches([';', ',']).to_owned();
                (!text.is_empty()).then_some(Change::Paste { text, at: after })
            }
        };
        let Some(change) = change else { return };
        match self.drawn_text().and_then(|parse| drawing::draw(parse, files::shown(&self.document), &change))
        {
            Ok(drawn) => self.take_drawn(&drawn),
            Err(reason) => self.window.failed(reason),
        }
    }

    /// Edits the text, selects the new statement once it is planned, and lets the author type over names and bounds.
    fn take_drawn(&mut self, drawn: &Drawn) {
        self.document.edit(&drawn.edits, EditKind::Single, None);
        self.derived.made = drawn.made.map(|at| (self.document.revision(), at));
        let Some(first) = drawn.typed_over.first() else { return };
        self.document.set_caret(Caret::selecting(first.start as usize, first.end as usize));
        for _ in drawn.typed_over.iter().skip(1) {
            TextCommand::SelectNextOccurrence.apply(&mut self.document);
        }
        self.window.scroll_to(*first, true);
        self.window.show(PanelKind::Editor);
        self.window.focus_panel(PanelKind::Editor);
    }
}
