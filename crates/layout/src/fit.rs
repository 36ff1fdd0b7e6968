//! The level of detail at which a network can be read in the room there is: as much of it as fits at its designed size.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use display::Measure;
use tpn::{BlockId, Network, NodeId};

use crate::contents::Contents;
use crate::drawing::NetworkDrawing;
use crate::folding::Fold;
use crate::metrics::{EVENT_RADIUS, MARGIN, OUTLINE_PAD, SHORTEST_RUN, VERTEX_RADIUS};
use crate::options::{Detail, Finer, Options, Written};
use crate::size::Sizes;
use crate::text::ArcTexts;
use crate::tree::Tree;
use crate::{finish, tree_of};

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
const MIN_ZOOM: f64 = 0.8;
/// Networks with so many events at most are small, and made so much smaller before anything is put behind a box.
const SMALL: usize = 60;
const SMALL_ZOOMS: [f64; 5] = [MIN_ZOOM, 0.65, 0.5, 0.42, 0.35];
/// And less is written before that.
const SHORTENED: [Written; 3] = [Written::Everything, Written::Short, Written::Names];
/// And its texts are at least so large then, in points of the screen.
pub const MIN_TEXT: f64 = 11.0;

/// What is left of the room is tried for more detail so many times.
const REFINEMENTS: usize = 100;
/// A box is opened into boxes of its steps divided by these, the finest that fits.
const PARTS: [u32; 5] = [12, 8, 5, 3, 2];

/// Neighbors, from the first to the last.
pub type Range = (BlockId, BlockId);

/// Something is looked for in boxes inside of boxes so often before everything around it is opened.
const MAX_OPENINGS: usize = 24;
/// No step takes less room than this, in square units: the shortest arc, as high as the smallest node.
const MIN_AREA: f64 = SHORTEST_RUN * 2.0 * VERTEX_RADIUS;

/// Draws a network as [`crate::network`] does, with as much detail as fits into `room` at its designed size: as it is if
/// that fits; otherwise with long sequences in rows; otherwise with less written, and so small that the texts still are
/// at [`MIN_TEXT`], small networks with as little as [`Written::Names`]; otherwise with what is fine behind boxes, `focus`
/// last of all. Of `options` what it says of rows, of what is written and of the level of detail is not used.
///
/// Takes time linear in the network once, and for each of a number of tries in what is drawn.
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
    let contents = Contents::new(network);
    let fitter = Fitter::new(network, &contents, options, room, measure, 1.0);
    if focus.is_none()
        && !fitter.are_too_many()
        && let Some(found) = fitter.tried(&Detail::default())
    {
        return fitter.drawn(&found);
    }
    // Of a small network nothing is behind boxes as long as what is written can be read.
    let is_small = focus.is_none() && network.nodes.len() <= SMALL;
    for written in SHORTENED {
        for zoom in SMALL_ZOOMS.into_iter().filter(|_| is_small) {
            let brief = options.brief(MIN_TEXT / zoom).shortened(written, zoom);
            // What is left of the room tells calls of one activity apart.
            let with_arguments = Options { arguments: options.arguments, ..brief.clone() };
            let drawn = |options: &Options| {
                let fitter = Fitter::new(network, &contents, options, room, measure, zoom);
                fitter.tried(&Detail::default()).map(|found| fitter.drawn(&found))
            };
            if let Some(drawing) = drawn(&brief) {
                return drawn(&with_arguments).unwrap_or(drawing);
            }
        }
    }
    let brief = options.brief(MIN_TEXT / MIN_ZOOM);
    let fitter = Fitter::new(network, &contents, &brief, room, measure, MIN_ZOOM);
    let found = fitter.refined(fitter.finest(focus));
    fitter.drawn(&found)
}

/// The boxes to open, one after the other, until the drawing that [`fitted`] makes shows one of `nodes`: each the focus
/// of the drawing then, or no longer collapsed if the options say that it is. Without `room`, everything is drawn that
/// is not collapsed.
pub fn openings(
    network: &Network,
    options: &Options,
    mut focus: Option<Range>,
    room: Option<Room>,
    nodes: &[NodeId],
    measure: &dyn Measure,
) -> Vec<Range> {
    let contents = Contents::new(network);
    let mut options = match room {
        Some(_) => options.brief(MIN_TEXT / MIN_ZOOM),
        None => Options { detail: Detail::default(), ..options.clone() },
    };
    let mut openings = Vec::new();
    loop {
        let tree = match room {
            Some(room) => {
                let fitter = Fitter::new(network, &contents, &options, room, measure, MIN_ZOOM);
                fitter.finest(focus).tree
            }
            None => tree_of(network, &contents, &options),
        };
        let folds = &tree.folding.folds;
        let hiders: Option<Vec<&Fold>> = nodes.iter().map(|&node| contents.hider(node, folds)).collect();
        let (Some(&node), Some(&hider)) = (nodes.first(), hiders.iter().flatten().next()) else {
            return openings;
        };
        let mut opened = (hider.first, hider.last);
        if openings.len() >= MAX_OPENINGS {
            opened = contents.home(node).map_or(opened, |home| (home, home));
        } else if focus == Some(opened) {
            // These neighbors are behind one box even where there is more detail: the one of them that holds the node.
            let holder = tree.folding.shown.iter().copied().find(|&block| contents.holds(block, node));
            opened = holder.map_or(opened, |holder| (holder, holder));
        }
        if openings.last() == Some(&opened) {
            return openings;
        }
        openings.push(opened);
        if opened.0 != opened.1 || !options.collapsed.remove(&opened.0) {
            focus = Some(opened);
        }
    }
}

/// A drawing that was tried: its options, and its structure.
struct Found {
    options: Options,
    tree: Tree,
}

struct Fitter<'a> {
    network: &'a Network,
    contents: &'a Contents,
    options: &'a Options,
    texts: ArcTexts<'a>,
    room: Room,
}

impl<'a> Fitter<'a> {
    fn new(
        network: &'a Network,
        contents: &'a Contents,
        options: &'a Options,
        room: Room,
        measure: &'a dyn Measure,
        zoom: f64,
    ) -> Self {
        let room = Room { width: room.width / zoom, height: room.height / zoom };
        Self { network, contents, options, texts: ArcTexts::new(network, options, measure), room }
    }

    /// The finest uniform detail whose drawing fits, first inside of the focus and then around it; the coarsest if
    /// none does.
    fn finest(&self, focus: Option<Range>) -> Found {
        let grains = grains(self.network.blocks.len() as u32);
        let coarsest = grains.last().copied().unwrap_or(0);
        let detail = |grain: u32, inside: u32| {
            let finer = focus.map(|(first, last)| Finer { first, last, grain: inside });
            Detail { grain, finer: finer.into_iter().collect() }
        };
        let (fine, found) = self.first_that_fits(&grains, &|grain| match focus {
            None => detail(grain, grain),
            Some(_) => detail(coarsest, grain),
        });
        if focus.is_none() {
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
            None => (grain, self.arranged(self.unplaced(&detail(grain))).0),
        }
    }

    /// The same with boxes opened, the largest first, as long as all of it fits.
    fn refined(&self, mut best: Found) -> Found {
        let mut left = REFINEMENTS;
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
        let (found, fits) = self.arranged(self.unplaced(detail));
        fits.then_some(found)
    }

    /// Returns whether all steps together are too many for the room, however they are arranged.
    fn are_too_many(&self) -> bool {
        let root = self.network.root.filter(|root| root.index() < self.network.blocks.len());
        let steps = root.map_or(0, |root| self.contents.steps(root));
        let is_complete = self.options.collapsed.is_empty();
        is_complete && f64::from(steps) * MIN_AREA > self.room.width * self.room.height
    }

    /// The structure of a drawing in this detail.
    fn unplaced(&self, detail: &Detail) -> Found {
        let options = Options { detail: detail.clone(), row_width: f64::INFINITY, ..self.options.clone() };
        Found { tree: tree_of(self.network, self.contents, &options), options }
    }

    /// The same with rows as wide as there is room, and whether it fits.
    fn arranged(&self, mut found: Found) -> (Found, bool) {
        let Room { width: across, height: down } = self.room;
        let Found { options, tree } = &mut found;
        let mut sizes = Sizes::new(self.network, self.contents, tree, &self.texts, options);
        let mut fits = false;
        for _ in 0..TRIES {
            let size = tree.root.map(|root| sizes.of(root)).unwrap_or_default();
            let width = size.width + 2.0 * (MARGIN + EVENT_RADIUS + OUTLINE_PAD);
            let height = size.above + size.below + 2.0 * MARGIN;
            fits = height <= down && width <= across;
            if fits || height > down {
                break;
            }
            options.row_width = (options.row_width.min(width) - (width - across)).max(SHORTEST_ROW);
            sizes.break_rows(options.row_width);
        }
        (found, fits)
    }

    fn drawn(&self, found: &Found) -> NetworkDrawing {
        finish(self.network, self.contents, &found.tree, &self.texts, &found.options)
    }
}

/// Returns how many steps boxes may hold, from none to all of `most`, each about a third more than the one before.
fn grains(most: u32) -> Vec<u32> {
    let mut grains = if most == 0 { vec![0] } else { vec![0, 2, 3] };
    while let Some(&last) = grains.last().filter(|&&last| last < most) {
        grains.push(last + (last / 3).max(1));
    }
    grains
}
