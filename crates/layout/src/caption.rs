//! What the boxes of folded blocks say.

use exact::counted;
use std::collections::BTreeSet;

use display::Measure;
use rmpl::program::LabelMode;
use smol_str::{SmolStr, format_smolstr};
use tpn::{ArcId, Block, BlockKind, Network, OccurrenceId};

use crate::contents::Contents;
use crate::folding::Fold;
use crate::metrics::{COLLAPSED_PAD, TextRole};
use crate::options::Options;
use crate::text::{activity_name, arc_bounds_label, cut_to_width, structure_name, text_width, width_at};
use crate::tree::{PartKind, Tree};

/// What the box of a collapsed part says.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Caption {
    /// The activity that the box represents, if it is one.
    pub(crate) occurrence: Option<OccurrenceId>,
    /// From top to bottom; the first line is the title.
    pub(crate) lines: Vec<Line>,
}

/// A line of a caption.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Line {
    pub(crate) text: SmolStr,
    pub(crate) role: TextRole,
    pub(crate) size: f64,
    pub(crate) width: f64,
}

impl Caption {
    pub(crate) fn title(&self) -> SmolStr {
        self.lines.first().map(|line| line.text.clone()).unwrap_or_default()
    }

    pub(crate) fn width(&self) -> f64 {
        self.lines.iter().map(|line| line.width).fold(0.0, f64::max)
    }

    /// The height of its lines.
    pub(crate) fn text_height(&self) -> f64 {
        self.lines.iter().map(|line| line.role.line_height()).sum()
    }

    /// The height of its box.
    pub(crate) fn height(&self) -> f64 {
        self.text_height() + 2.0 * COLLAPSED_PAD
    }
}

/// A box that represents no single activity is named by so much of what it holds.
const LONGEST_SUMMARY: f64 = 160.0;
/// A longer call is named without its arguments.
const LONGEST_CALL: f64 = 200.0;
/// So many vehicles are named; the others are counted.
const MAX_VEHICLES: usize = 2;

/// Of each folded part, in the order of the parts, what its box says.
pub(crate) fn captions(
    network: &Network,
    contents: &Contents,
    tree: &Tree,
    options: &Options,
    measure: &dyn Measure,
) -> Vec<Caption> {
    let mut captions = Vec::new();
    for part in &tree.parts {
        let PartKind::Collapsed(fold) = part.kind else { continue };
        let ends = tree.folding.folds[fold as usize];
        let kind = (ends.first == ends.last).then(|| &network.blocks[ends.first.index()].kind);
        let (occurrence, arc) = match kind {
            Some(BlockKind::Scope { arcs, occurrence, .. }) => (*occurrence, arcs.first().copied()),
            Some(BlockKind::Leaf { arc }) => (network.arcs[arc.index()].occurrence, Some(*arc)),
            _ => (None, None),
        };
        let (name, longest) = if let Some(occurrence) = occurrence {
            let occurrence = &network.occurrences[occurrence.index()];
            let call = activity_name(occurrence);
            let is_short = text_width(&call, TextRole::Title, measure) <= LONGEST_CALL;
            (Some(if is_short { call } else { occurrence.activity.clone() }), options.longest_name)
        } else {
            let name = summary(network, &ends).or_else(|| kind.map(structure_name));
            (name, options.longest_name.min(LONGEST_SUMMARY))
        };
        let title = cut_to_width(&name.unwrap_or_default(), TextRole::Title, longest, measure);
        let events = counted(contents.events(&ends), "event");
        let detail = match arc.map(|arc| &network.arcs[arc.index()]) {
            Some(arc) => format_smolstr!("{} · {events}", arc_bounds_label(arc)),
            None => events.into(),
        };
        let line = |text: SmolStr, role: TextRole| {
            let size = options.text_size(role);
            Line { width: width_at(&text, size, measure), text, role, size }
        };
        let mut lines = vec![line(title, TextRole::Title), line(detail, TextRole::Bounds)];
        let inside = &network.blocks[contents.first_inside(ends.first).index()..=ends.last.index()];
        if let Some(inside) = what_is_inside(network, inside) {
            let inside = cut_to_width(&inside, TextRole::Bounds, longest, measure);
            lines.push(line(inside, TextRole::Bounds));
        }
        captions.push(Caption { occurrence, lines });
    }
    captions
}

/// The vehicles that move behind a box, and how many decisions are made there: `Rover1, Rover2 · 1 decision`.
fn what_is_inside(network: &Network, blocks: &[Block]) -> Option<SmolStr> {
    let mut vehicles = BTreeSet::new();
    let mut decisions = 0;
    for block in blocks {
        let arcs: &[ArcId] = match &block.kind {
            BlockKind::Leaf { arc } => std::slice::from_ref(arc),
            BlockKind::Scope { arcs, .. } => arcs,
            BlockKind::Choose { .. } => {
                decisions += 1;
                continue;
            }
            _ => continue,
        };
        for label in arcs.iter().flat_map(|arc| &network.arcs[arc.index()].labels) {
            let label = &network.labels[label.index()];
            if label.mode == LabelMode::Tell {
                vehicles.insert(label.literal.variable);
            }
        }
    }
    let names =
        vehicles.iter().filter_map(|variable| network.variables[variable.index()].name.strip_suffix(".at"));
    let names: Vec<&str> = names.collect();
    let mut told: Vec<SmolStr> = Vec::new();
    match names.as_slice() {
        [] => {}
        names if names.len() > MAX_VEHICLES => told.push(counted(names.len(), "vehicle").into()),
        names => told.push(names.join(", ").into()),
    }
    if decisions > 0 {
        told.push(counted(decisions, "decision").into());
    }
    (!told.is_empty()).then(|| told.join(" · ").into())
}

/// The first and the last activity behind a box, or what is asserted there if there is none.
fn summary(network: &Network, fold: &Fold) -> Option<SmolStr> {
    let name = |occurrence: OccurrenceId| &network.occurrences[occurrence.index()].activity;
    let (first, last) = fold.named.map(|(first, last)| (name(first), name(last)))?;
    Some(if first == last { first.clone() } else { format_smolstr!("{first} … {last}") })
}
