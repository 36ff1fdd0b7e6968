//! That there is no plan, as problems of the text: at what each reason names, with the changes that would give a plan.

use rmpl::files::Files;
use rmpl::{LineIndex, Severity, Span};
use smol_str::SmolStr;
use snapshot::Snapshot;
use snapshot::{Problem, TextFix};

/// The code of these problems; the Plan panel explains them.
pub const NO_PLAN: &str = "E-NOPLAN";

/// Reasons that are listed at most; the Plan panel has all of them.
const MAX_REASONS: usize = 8;

/// Returns what is wrong with a text that has no plan; nothing if it has one, or if that is not known.
pub(super) fn problems(snapshot: &Snapshot) -> Vec<Problem> {
    let Some(planning) = snapshot.planning.as_ref().filter(|_| snapshot.plan().is_none()) else {
        return Vec::new();
    };
    let source = &*snapshot.source;
    let (lines, files) = (LineIndex::new(source), Files::of(source));
    let problem = |message: String, spans: &[Span], fixes: &[TextFix]| {
        let span = telling(spans, source).unwrap_or_else(|| scenario_span(snapshot));
        let place = files.line_column(source, &lines, span.start);
        let file = files.at(span.start);
        Problem {
            code: SmolStr::new_static(NO_PLAN),
            severity: Severity::Error,
            message,
            span,
            file: (file.start > 0).then(|| SmolStr::new(&file.name)),
            file_start: file.start,
            line: place.line,
            column: place.column,
            hint: (!fixes.is_empty()).then(|| "any one of these fixes gives a plan".to_owned()),
            fixes: fixes.to_vec(),
            more: 0,
        }
    };
    if let Some(network) = snapshot.network.as_deref()
        && let Some(message) = planning.outcome.unplannable_message(network)
    {
        return vec![problem(format!("No plan: {message}"), &[], &[])];
    }
    let Some(failure) = &planning.outcome.failure else { return Vec::new() };
    let fixes: Vec<TextFix> = failure
        .gap_fix(source)
        .into_iter()
        .chain(planning.repairs.iter().cloned())
        .chain(failure.relaxations.iter().filter_map(|relaxation| relaxation.fix(source)))
        .map(|fix| TextFix { label: fix.label, edits: fix.edits })
        .collect();
    let reasons = failure.reasons.iter().take(MAX_REASONS);
    reasons.map(|reason| problem(format!("No plan: {}", reason.message), &reason.spans, &fixes)).collect()
}

/// The most telling place that is on one line, otherwise the smallest.
fn telling(spans: &[Span], source: &str) -> Option<Span> {
    let is_short = |span: &&Span| source.get(span.range()).is_some_and(|text| !text.contains('\n'));
    let smallest = || spans.iter().min_by_key(|span| span.range().len());
    spans.iter().find(is_short).or_else(smallest).copied()
}

/// The first line of what was planned, where a reason names nothing.
fn scenario_span(snapshot: &Snapshot) -> Span {
    let occurrences = snapshot.network.iter().flat_map(|network| &network.occurrences);
    let start = occurrences.filter_map(|it| it.span).map(|span| span.start).min().unwrap_or(0) as usize;
    let rest = snapshot.source.get(start..).unwrap_or_default();
    let end = start + rest.find('\n').unwrap_or(rest.len());
    Span::new(start as u32, end as u32)
}
