//! What the boxes of folded blocks say.

use std::collections::BTreeSet;

use display::Measure;
use smol_str::{SmolStr, format_smolstr};
use tpn::{BlockKind, Network, OccurrenceId, OccurrenceKind};

use crate::folding::Folding;
use crate::metrics::TextRole;
use crate::options::Options;
use crate::text::{arc_bounds_label, cut_to_width, structure_name, width_at};
use crate::tree::{PartId, PartKind, Tree, block_children};

/// What the box of a collapsed part says.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Caption {
    pub(crate) part: PartId,
    /// The activity that the box stands for, if it is one.
    pub(crate) occurrence: Option<OccurrenceId>,
    pub(crate) title: SmolStr,
    pub(crate) title_width: f64,
    pub(crate) detail: SmolStr,
    pub(crate) detail_width: f64,
    /// The sizes of the title and of the detail.
    pub(crate) sizes: [f64; 2],
}

/// A box that stands for no single activity is named by so much of what it holds.
const LONGEST_SUMMARY: f64 = 160.0;

/// Of each folded part, in the order of the parts, what its box says.
pub(crate) fn captions(
    network: &Network,
    tree: &Tree,
    options: &Options,
    measure: &dyn Measure,
) -> Vec<Caption> {
    let mut hidden_counts = vec![0_u32; tree.folding.folds.len()];
    for &fold in tree.folding.hidden_nodes.iter().flatten() {
        hidden_counts[fold as usize] += 1;
    }
    let mut captions = Vec::new();
    for (at, part) in tree.parts.iter().enumerate() {
        let PartKind::Collapsed(fold) = part.kind else { continue };
        let ends = tree.folding.folds[fold as usize];
        let kind = (ends.first == ends.last).then(|| &network.blocks[ends.first.index()].kind);
        let (occurrence, arc) = match kind {
            Some(BlockKind::Scope { arcs, occurrence, .. }) => (*occurrence, arcs.first().copied()),
            Some(BlockKind::Leaf { arc }) => (network.arcs[arc.index()].occurrence, Some(*arc)),
            _ => (None, None),
        };
        let (name, longest) = if let Some(occurrence) = occurrence {
            (Some(network.occurrences[occurrence.index()].activity.clone()), options.longest_name)
        } else {
            let name = summary(network, &tree.folding, fold).or_else(|| kind.map(structure_name));
            (name, options.longest_name.min(LONGEST_SUMMARY))
        };
        let title = cut_to_width(&name.unwrap_or_default(), TextRole::Title, longest, measure);
        let events = match hidden_counts[fold as usize] {
            1 => SmolStr::new_static("1 event"),
            count => format_smolstr!("{count} events"),
        };
        let detail = match arc.map(|arc| &network.arcs[arc.index()]) {
            Some(arc) => format_smolstr!("{} · {events}", arc_bounds_label(arc)),
            None => events,
        };
        let sizes = [TextRole::Title, TextRole::Bounds].map(|role| options.text_size(role));
        captions.push(Caption {
            part: PartId(at as u32),
            occurrence,
            title_width: width_at(&title, sizes[0], measure),
            title,
            detail_width: width_at(&detail, sizes[1], measure),
            detail,
            sizes,
        });
    }
    captions
}

/// The first and the last activity behind a box, or what is asserted there if there is none. What an activity does
/// inside is its own.
fn summary(network: &Network, folding: &Folding, fold: u32) -> Option<SmolStr> {
    let activities = [OccurrenceKind::Primitive, OccurrenceKind::Activity];
    let (first, last) = outermost(network, folding, fold, &activities)
        .or_else(|| outermost(network, folding, fold, &[OccurrenceKind::Assertion]))?;
    Some(if first == last { first } else { format_smolstr!("{first} … {last}") })
}

/// The names of the first and the last outermost occurrence of these kinds behind a box.
fn outermost(
    network: &Network,
    folding: &Folding,
    fold: u32,
    wanted: &[OccurrenceKind],
) -> Option<(SmolStr, SmolStr)> {
    let mut inside: BTreeSet<usize> = BTreeSet::new();
    let (mut first, mut last) = (None, None);
    // Blocks come after what they hold.
    let from = folding.folds[fold as usize].last.index();
    for at in (0..=from).rev().take_while(|&at| folding.fold_of[at] == Some(fold)) {
        let kind = &network.blocks[at].kind;
        let occurrence = match kind {
            BlockKind::Scope { occurrence, .. } => *occurrence,
            BlockKind::Leaf { arc } => network.arcs[arc.index()].occurrence,
            _ => None,
        };
        let occurrence = occurrence.map(|it| &network.occurrences[it.index()]);
        let named = occurrence.filter(|it| wanted.contains(&it.kind));
        let is_inside = inside.remove(&at);
        if is_inside || named.is_some() {
            inside.extend(block_children(kind).iter().map(|child| child.index()));
        }
        if let Some(occurrence) = named.filter(|_| !is_inside) {
            first = Some(&occurrence.activity);
            last = last.or(first);
        }
    }
    Some((first?.clone(), last?.clone()))
}
