//! What the language and the plan say about places of the text, for the editor.

use std::ops::Range;

use editor::{Highlight, LanguageService, Signature};
use egui::Color32;
use rmpl::Span;
use rmpl::editor::{CompletionKind, Evaluation, Hover};
use theme::Tokens;
use workbench::state::folding;
use workbench::state::language::{SyntaxRole, evaluation};

use crate::Context;

/// Answers about the text, kept while nothing changes.
#[derive(Default)]
pub(super) struct Answers {
    /// The revisions of the text and of the plan that what is hovered over belongs to.
    revisions: (u64, u64),
    evaluation: Evaluation,
    hovered: Option<(usize, Option<Hover>)>,
    /// The lines at which something can be folded, for the revision they were found at.
    foldable: (u64, Vec<usize>),
}

/// The language of the text in one frame.
pub(super) struct Language<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) answers: &'a mut Answers,
}

impl LanguageService for Language<'_> {
    fn highlights(&mut self, bytes: Range<usize>) -> Vec<Highlight> {
        let roles = self.context.state.language.roles(Span::new(bytes.start as u32, bytes.end as u32));
        let tokens = self.context.tokens;
        roles
            .into_iter()
            .map(|(span, role)| Highlight { bytes: span.range(), color: syntax_color(role, tokens) })
            .collect()
    }

    fn hover(&mut self, offset: usize) -> Option<String> {
        let context = self.context;
        let shown = context.snapshot.filter(|_| !context.is_stale);
        let revisions = (context.state.document.revision(), shown.map_or(0, |shown| shown.revision));
        if self.answers.revisions != revisions {
            self.answers.revisions = revisions;
            self.answers.evaluation = shown.map(|shown| evaluation(shown)).unwrap_or_default();
            self.answers.hovered = None;
        }
        if self.answers.hovered.as_ref().is_none_or(|(at, _)| *at != offset) {
            let parse = context.state.language.parse();
            let evaluation = &self.answers.evaluation;
            let found = parse.and_then(|parse| rmpl::editor::hover(parse, offset as u32, evaluation));
            self.answers.hovered = Some((offset, found));
        }
        let (_, hover) = self.answers.hovered.as_ref()?;
        Some(hover.as_ref()?.markdown.clone())
    }

    fn signature(&mut self, offset: usize) -> Option<Signature> {
        let parse = self.context.state.language.parse()?;
        let signature = rmpl::editor::signature_at(parse, offset as u32)?;
        Some(Signature {
            active: signature.parameters.get(signature.active as usize).map(|span| span.range()),
            label: signature.label,
            documentation: signature.documentation,
        })
    }

    fn foldable_lines(&mut self) -> &[usize] {
        let Some(parse) = self.context.state.language.parse() else { return &[] };
        let document = &self.context.state.document;
        if self.answers.foldable.0 != document.revision() {
            let regions = folding::regions(document, parse);
            self.answers.foldable =
                (document.revision(), regions.iter().map(|region| region.first_line).collect());
        }
        &self.answers.foldable.1
    }
}

/// A letter and a color for a kind of completion.
pub(super) const fn completion_sign(tokens: &Tokens, kind: CompletionKind) -> (&'static str, Color32) {
    let syntax = &tokens.syntax;
    match kind {
        CompletionKind::Keyword => ("k", syntax.keyword),
        CompletionKind::Activity => ("A", syntax.activity),
        CompletionKind::Primitive => ("P", syntax.activity),
        CompletionKind::Variable => ("x", syntax.variable),
        CompletionKind::Value => ("=", syntax.value),
        CompletionKind::Parameter => ("p", syntax.parameter),
        CompletionKind::BoundName => ("b", syntax.parameter),
        CompletionKind::Constant => ("c", syntax.parameter),
        CompletionKind::Location => ("@", syntax.place),
        CompletionKind::Vehicle => ("v", syntax.place),
        CompletionKind::Option => ("o", syntax.keyword),
    }
}

const fn syntax_color(role: SyntaxRole, tokens: &Tokens) -> Color32 {
    let syntax = &tokens.syntax;
    match role {
        SyntaxRole::Keyword => syntax.keyword,
        SyntaxRole::Activity => syntax.activity,
        SyntaxRole::Variable => syntax.variable,
        SyntaxRole::Value => syntax.value,
        SyntaxRole::Parameter => syntax.parameter,
        SyntaxRole::Place => syntax.place,
        SyntaxRole::Number => syntax.number,
        SyntaxRole::String => syntax.string,
        SyntaxRole::Comment => syntax.comment,
        SyntaxRole::Punctuation => syntax.punctuation,
        SyntaxRole::Unknown => tokens.error,
    }
}
