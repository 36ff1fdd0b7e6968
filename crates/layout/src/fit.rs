//! The level of detail at which a network can be read in the room there is: as much of it as fits at its designed size.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use display::Measure;
use tpn::{BlockId, Network};

use crate::drawing::NetworkDrawing;
use crate::folding::Fold;
use crate::metrics::{EVENT_RADIUS, MARGIN, OUTLINE_PAD};
use crate::options::{Detail, Finer, Options};
use crate::size::Sizes;
use crate::text::ArcTexts;
use crate::tree::Tree;
use crate::{finish, recover, tree};

/// Room for a drawing, in drawing units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// From left to right.
    pub width: f64,
    /// From top to bottom.
    pub height: f64,
}

/// Rows are made shorter so many times until structure around them fits, too.
const TRIES: usize = 4;
/// Rows are not made shorter than this.
const SHORTEST_ROW: f64 = 240.0;
/// A drawing in little room is made so small.
const LEAST_ZOOM: f64 = 0.8;
/// And its texts are at least so large then, in points of the screen.
pub const LEAST_TEXT: f64 = 11.0;

/// How many times, for each so many blocks of a network, what is left of the room is tried for more detail, between a
/// least and a greatest number.
const REFINEMENTS: (u32, usize, usize) = (150_000, 6, 40);
/// A box is opened into boxes of its steps divided by these, the finest that fits.
const PARTS: [u32; 3] = [12, 5, 3];

/// Neighbours, from the first to the last.
pub type Range = (BlockId, BlockId);

/// Draws a network as [`crate::network`] does, with as much detail as fits into `room` at its designed size: as it is if
/// that fits; otherwise with long sequences in rows; otherwise with less written, and so small that the texts still are
/// at [`LEAST_TEXT`]; otherwise with what is fine behind boxes, `focus` last of all. Of `options` what it says of rows
/// and of the level of detail is not used.
///
/// Takes time linear in the network for each of a number of tries that grows with its logarithm.
pub fn fitted(
    network: &Network,
    options: &Options,
    focus: Option<Range>,
    room: Room,
    measure: &dyn Measure,
) -> NetworkDrawing {
    if network.nodes.is_empty() {
        return NetworkDrawing::default();
    }
    let fitter = Fitter::new(network, options, focus, room, measure, 1.0);
    if let Some(found) = fitter.tried(&Detail::default()).filter(|_| focus.is_none()) {
        return fitter.drawn(&found);
    }
    let brief = options.brief(LEAST_TEXT / LEAST_ZOOM);
    let fitter = Fitter::new(network, &brief, focus, room, measure, LEAST_ZOOM);
    let found = fitter.refined(fitter.finest());
    fitter.drawn(&found)
}

/// A drawing that was tried: its options, and its structure.
struct Found {
    options: Options,
    tree: Tree,
}

struct Fitter<'a> {
    network: &'a Network,
    options: &'a Options,
    focus: Option<Range>,
    texts: ArcTexts,
    room: Room,
    measure: &'a dyn Measure,
}

impl<'a> Fitter<'a> {
    fn new(
        network: &'a Network,
        options: &'a Options,
        focus: Option<Range>,
        room: Room,
        measure: &'a dyn Measure,
        zoom: f64,
    ) -> Self {
        let texts = ArcTexts::new(network, options, measure);
        let room = Room { width: room.width / zoom, height: room.height / zoom };
        Self { network, options, focus, texts, room, measure }
    }

    /// The finest uniform detail whose drawing fits, first inside of the focus and then around it; the coarsest if
    /// none does.
    fn finest(&self) -> Found {
        let grains = grains(self.network.blocks.len() as u32);
        let coarsest = grains.last().copied().unwrap_or(0);
        let detail = |grain: u32, inside: u32| {
            let finer = self.focus.map(|(first, last)| Finer { first, last, grain: inside });
            Detail { grain, finer: finer.into_iter().collect() }
        };
        let (fine, found) = self.first_that_fits(&grains, &|grain| match self.focus {
            None => detail(grain, grain),
            Some(_) => detail(coarsest, grain),
        });
        if self.focus.is_none() {
            return found;
        }
        let around: Vec<u32> = grains.into_iter().filter(|&grain| grain >= fine).collect();
        self.first_that_fits(&around, &|grain| detail(grain, fine)).1
    }

    /// The first of the grains, by halving, whose drawing fits, or else the last, and its drawing.
    fn first_that_fits(&self, grains: &[u32], detail: &dyn Fn(u32) -> Detail) -> (u32, Found) {
        let (mut low, mut high) = (0, grains.len().saturating_sub(1));
        let mut best = None;
        while low < high {
            let middle = usize::midpoint(low, high);
            match self.tried(&detail(grains[middle])) {
                Some(found) => {
                    high = middle;
                    best = Some((middle, found));
                }
                None => low = middle + 1,
            }
        }
        let grain = grains.get(high).copied().unwrap_or(0);
        match best.filter(|(at, _)| *at == high) {
            Some((_, found)) => (grain, found),
            None => (grain, self.arranged(&detail(grain)).0),
        }
    }

    /// The same with boxes opened, the largest first, as long as all of it fits.
    fn refined(&self, mut best: Found) -> Found {
        let (blocks, least, most) = REFINEMENTS;
        let mut left = (blocks as usize / self.network.blocks.len().max(1)).clamp(least, most);
        let mut tried: BTreeSet<Range> = BTreeSet::new();
        loop {
            let is_new = |fold: &&Fold| {
                !tried.contains(&(fold.first, fold.last)) && !self.options.collapsed.contains(&fold.first)
            };
            let folds = best.tree.folding.folds.iter().filter(is_new);
            let Some(&fold) = folds.max_by_key(|fold| (fold.steps, Reverse(fold.first))) else { return best };
            tried.insert((fold.first, fold.last));
            let mut grains: Vec<u32> = PARTS.iter().map(|parts| fold.steps / parts).collect();
            grains.dedup();
            for grain in grains {
                let Some(rest) = left.checked_sub(1) else { return best };
                left = rest;
                let mut detail = best.options.detail.clone();
                detail.finer.push(Finer { first: fold.first, last: fold.last, grain });
                if let Some(found) = self.tried(&detail) {
                    best = found;
                    break;
                }
            }
        }
    }

    /// A drawing in this detail, if it fits.
    fn tried(&self, detail: &Detail) -> Option<Found> {
        let (found, fits) = self.arranged(detail);
        fits.then_some(found)
    }

    /// A drawing in this detail with rows as wide as there is room, and whether it fits.
    fn arranged(&self, detail: &Detail) -> (Found, bool) {
        let Room { width: across, height: down } = self.room;
        let mut options =
            Options { detail: detail.clone(), row_width: f64::INFINITY, ..self.options.clone() };
        let tree = tree::tree_from_blocks(self.network, &options)
            .unwrap_or_else(|| recover::tree_from_graph(self.network));
        let mut fits = false;
        for _ in 0..TRIES {
            let sizes = Sizes::new(self.network, &tree, &self.texts, &options, self.measure);
            let size = tree.root.map(|root| sizes.of(root)).unwrap_or_default();
            let width = size.width + 2.0 * (MARGIN + EVENT_RADIUS + OUTLINE_PAD);
            let height = size.above + size.below + 2.0 * MARGIN;
            fits = height <= down && width <= across;
            if fits || height > down {
                break;
            }
            options.row_width = (options.row_width.min(width) - (width - across)).max(SHORTEST_ROW);
        }
        (Found { options, tree }, fits)
    }

    fn drawn(&self, found: &Found) -> NetworkDrawing {
        finish(self.network, &found.tree, &self.texts, &found.options, self.measure)
    }
}

/// How many steps boxes may hold, from none to all of `most`, each about a third more than the one before.
fn grains(most: u32) -> Vec<u32> {
    let mut grains = vec![0, 2, 3];
    while let Some(&last) = grains.last().filter(|&&last| last < most) {
        grains.push(last + (last / 3).max(1));
    }
    grains
}
