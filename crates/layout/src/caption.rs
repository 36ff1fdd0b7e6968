//! What the boxes of folded blocks say.

use display::Measure;
use smol_str::{SmolStr, format_smolstr};
use tpn::{BlockKind, Network, OccurrenceId};

use crate::contents::Contents;
use crate::folding::Fold;
use crate::metrics::TextRole;
use crate::options::Options;
use crate::text::{arc_bounds_label, cut_to_width, structure_name, width_at};
use crate::tree::{PartId, PartKind, Tree};

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
    contents: &Contents,
    tree: &Tree,
    options: &Options,
    measure: &dyn Measure,
) -> Vec<Caption> {
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
            let name = summary(network, &ends).or_else(|| kind.map(structure_name));
            (name, options.longest_name.min(LONGEST_SUMMARY))
        };
        let title = cut_to_width(&name.unwrap_or_default(), TextRole::Title, longest, measure);
        let events = match contents.events(&ends) {
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

/// The first and the last activity behind a box, or what is asserted there if there is none.
fn summary(network: &Network, fold: &Fold) -> Option<SmolStr> {
    let name = |occurrence: OccurrenceId| &network.occurrences[occurrence.index()].activity;
    let (first, last) = fold.named.map(|(first, last)| (name(first), name(last)))?;
    Some(if first == last { first.clone() } else { format_smolstr!("{first} … {last}") })
}
