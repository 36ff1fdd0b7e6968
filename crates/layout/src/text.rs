//! What is written at each arc, and how much room it takes.

use std::cell::OnceCell;

use display::{Measure, text_width_at};
use exact::{Bound, Time};
use rmpl::program::LabelMode;
use smol_str::{SmolStr, format_smolstr};
use tpn::{Arc, ArcId, ArcKind, BlockKind, Extent, Label, LabelId, Network, Occurrence, OccurrenceKind};

use crate::drawing::Item;
use crate::metrics::{TextRole, WORD_GAP, rounded_up};
use crate::options::{Options, Written};

/// The least height of a line of text, as a part of the text's size.
const LINE_HEIGHT: f64 = 1.15;

/// A text with its width, and the line that it is on: −1 is on the arc, 0 the first below it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) text: SmolStr,
    pub(crate) role: TextRole,
    /// The size of the text.
    pub(crate) size: f64,
    pub(crate) width: f64,
    pub(crate) line: i32,
    pub(crate) owner: Item,
}

/// The texts of the arcs of a network, made when they are asked for.
pub(crate) struct ArcTexts<'a> {
    network: &'a Network,
    options: &'a Options,
    pub(crate) measure: &'a dyn Measure,
    runs: Vec<OnceCell<Vec<Run>>>,
}

/// Width and height of some lines of text.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TextSize {
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl<'a> ArcTexts<'a> {
    pub(crate) fn new(network: &'a Network, options: &'a Options, measure: &'a dyn Measure) -> Self {
        Self { network, options, measure, runs: vec![OnceCell::new(); network.arcs.len()] }
    }

    /// The texts of one arc, in the order of their lines.
    pub(crate) fn of(&self, arc: ArcId) -> &[Run] {
        self.runs[arc.index()].get_or_init(|| self.written(arc))
    }

    fn written(&self, id: ArcId) -> Vec<Run> {
        let Self { network, options, measure, .. } = *self;
        let arc = &network.arcs[id.index()];
        let mut runs: Vec<Run> = Vec::new();
        let run = |text: SmolStr, role: TextRole, line: i32, owner: Item| {
            let size = options.text_size(role);
            let width_of = |text: &str| width_at(text, size, measure);
            // A number that is cut is another number.
            let is_number = matches!(role, TextRole::Bounds | TextRole::Nature | TextRole::ZeroBounds);
            let longest = if is_number { f64::INFINITY } else { options.longest_name };
            let text = display::cut_to_width(&text, longest, width_of);
            Run { width: width_of(&text), text, role, size, line, owner }
        };
        let labels = || arc.labels.iter().copied().filter(|&label| is_written(network, options, label));
        let name = arc_name(network, options, id, arc);
        let with_bounds = options.written != Written::Names;
        if let Some((text, role)) = name.clone() {
            runs.push(run(text, role, -1, Item::Arc(id)));
        } else {
            runs.extend(labels().map(|label| {
                let (text, role) = label_text(network, label);
                run(text, role, -1, Item::Label(label))
            }));
        }
        if let Some((text, role)) = bounds_text(arc, options).filter(|_| with_bounds || runs.is_empty()) {
            runs.push(run(text, role, if runs.is_empty() { -1 } else { 0 }, Item::Arc(id)));
        }
        if name.is_some() && with_bounds {
            let easy = runs[0].width.max(options.easy_line);
            for label in labels() {
                let (text, role) = label_text(network, label);
                let last = runs.last().map_or(0, |run| run.line.max(0));
                let used = line_size(&runs, last).width;
                let width = width_at(&text, options.text_size(role), measure);
                let fits = used == 0.0 || used + WORD_GAP + width <= easy;
                runs.push(run(text, role, if fits { last } else { last + 1 }, Item::Label(label)));
            }
        }
        runs
    }
}

/// The room that line `line` of `runs` takes.
pub(crate) fn line_size(runs: &[Run], line: i32) -> TextSize {
    row_size(runs.iter().filter(|run| run.line == line))
}

/// The room of all lines above the arc, and of all below.
pub(crate) fn sizes_above_and_below(runs: &[Run]) -> (TextSize, TextSize) {
    let mut below = TextSize::default();
    for line in 0..=runs.last().map_or(-1, |run| run.line) {
        let size = line_size(runs, line);
        below = TextSize { width: below.width.max(size.width), height: below.height + size.height };
    }
    (line_size(runs, -1), below)
}

/// The room of all texts in one row.
pub(crate) fn one_row_size(runs: &[Run]) -> TextSize {
    row_size(runs.iter())
}

fn row_size<'a>(runs: impl Iterator<Item = &'a Run>) -> TextSize {
    let mut size = TextSize::default();
    for run in runs {
        size.width += run.width + if size.width > 0.0 { WORD_GAP } else { 0.0 };
        size.height = size.height.max(run.role.line_height()).max((run.size * LINE_HEIGHT).ceil());
    }
    size
}

/// Returns whether a condition is written at its arc.
fn is_written(network: &Network, options: &Options, label: LabelId) -> bool {
    options.changes || !matches!(network.labels[label.index()].extent, Extent::Effect | Extent::Initial)
}

/// The width of `text` at `size`.
pub(crate) fn width_at(text: &str, size: f64, measure: &dyn Measure) -> f64 {
    rounded_up(text_width_at(text, size, measure)) + 1.0
}

/// The width of `text` in its role.
pub(crate) fn text_width(text: &str, role: TextRole, measure: &dyn Measure) -> f64 {
    width_at(text, role.size(), measure)
}

/// `text`, or as much of it as fits with an ellipsis.
pub(crate) fn cut_to_width(text: &str, role: TextRole, longest: f64, measure: &dyn Measure) -> SmolStr {
    display::cut_to_width(text, longest, |text| text_width(text, role, measure))
}

/// The bounds as the papers print them: `[405,486]`, `[0,∞]`.
pub fn bounds_label(lower: Time, upper: Bound) -> SmolStr {
    match upper {
        Bound::Finite(upper) => format_smolstr!("[{lower},{upper}]"),
        Bound::Infinite => format_smolstr!("[{lower},∞]"),
    }
}

/// The bounds of an arc, and that the environment chooses within them: `[20,40] contingent`.
pub fn arc_bounds_label(arc: &Arc) -> SmolStr {
    let bounds = bounds_label(arc.lower, arc.upper);
    if arc.is_contingent { format_smolstr!("{bounds} contingent") } else { bounds }
}

/// A condition as the paper prints it on an arc: `Ask(PATH1=OK)`, and of what lasts `Set(ARM=OUT)` and `Init(ARM=IN)`.
pub fn label_text(network: &Network, label: LabelId) -> (SmolStr, TextRole) {
    let label = &network.labels[label.index()];
    let role = match label.mode {
        LabelMode::Ask => TextRole::Ask,
        LabelMode::Tell => TextRole::Tell,
    };
    (format_smolstr!("{}({})", label.verb(), label.text), role)
}

/// Returns what a labeled interval means for whoever has it, in words: `requires ARM=OUT throughout`.
pub fn label_words(label: &Label) -> String {
    let text = &label.text;
    match (label.mode, label.extent) {
        (LabelMode::Ask, Extent::Start) => format!("requires {text} at start"),
        (LabelMode::Ask, _) => format!("requires {text} throughout"),
        (LabelMode::Tell, Extent::Effect) => format!("sets {text} at end"),
        (LabelMode::Tell, Extent::Initial) => format!("{text} holds initially"),
        (LabelMode::Tell, _) => format!("asserts {text} throughout"),
    }
}

fn bounds_text(arc: &Arc, options: &Options) -> Option<(SmolStr, TextRole)> {
    let text = arc_bounds_label(arc);
    let at_once = arc.lower.is_zero() && arc.upper == Bound::ZERO;
    if at_once && arc.occurrence.is_none() {
        return options.zero_bounds.then_some((text, TextRole::ZeroBounds));
    }
    // That something comes later, its arrow says.
    let is_free = arc.lower.is_zero() && arc.upper == Bound::Infinite && !arc.is_contingent;
    let is_plain =
        arc.occurrence.is_none() || (arc.kind == ArcKind::Delay && options.written != Written::Everything);
    if is_free && is_plain && !options.zero_bounds {
        return None;
    }
    Some((text, if arc.is_contingent { TextRole::Nature } else { TextRole::Bounds }))
}

/// The name written on an arc; assertions are named by their labels.
fn arc_name(network: &Network, options: &Options, id: ArcId, arc: &Arc) -> Option<(SmolStr, TextRole)> {
    let occurrence = network.occurrences.get(arc.occurrence?.index())?;
    let is_named = match arc.kind {
        ArcKind::Activity | ArcKind::Composite | ArcKind::Delay => true,
        // A scenario's own arc, and that of a traverse over its path.
        ArcKind::Span => occurrence.arc == Some(id),
        _ => false,
    };
    if !is_named {
        return None;
    }
    match occurrence.kind {
        OccurrenceKind::Assertion | OccurrenceKind::Scope => None,
        OccurrenceKind::Delay => (options.written == Written::Everything)
            .then_some((SmolStr::new_static("delay"), TextRole::Muted)),
        OccurrenceKind::Primitive | OccurrenceKind::Activity | OccurrenceKind::Scenario => {
            let text =
                if options.arguments { activity_name(occurrence) } else { occurrence.activity.clone() };
            Some((text, TextRole::Name))
        }
    }
}

/// The display name of an occurrence: its activity with the arguments of the call, `Drive(RIDGE)`. Several occurrences may
/// share it.
pub fn activity_name(occurrence: &Occurrence) -> SmolStr {
    match occurrence.kind {
        OccurrenceKind::Delay => SmolStr::new_static("delay"),
        _ if occurrence.arguments.is_empty() => occurrence.activity.clone(),
        _ => format_smolstr!("{}({})", occurrence.activity, occurrence.arguments.join(", ")),
    }
}

/// Returns what kind of structure a block is, in the words of the language.
pub fn structure_name(kind: &BlockKind) -> SmolStr {
    match kind {
        BlockKind::Leaf { .. } => SmolStr::new_static("step"),
        BlockKind::Sequence { .. } => SmolStr::new_static("sequence"),
        BlockKind::Parallel { .. } => SmolStr::new_static("parallel"),
        BlockKind::Choose { decision, .. } => format_smolstr!("choose {}", Network::decision_name(*decision)),
        BlockKind::Scope { .. } => SmolStr::new_static("block"),
        BlockKind::Guard { .. } => SmolStr::new_static("if"),
    }
}
