//! How much detail the drawing has: as much as can be read in the panel, more of it where the user looks.

use std::collections::BTreeSet;

use display::approximate_text_width;
use egui::Vec2;
use layout::{NetworkDrawing, Options, Room};
use tpn::{BlockId, Network, NodeId};

use super::data::{block_key, collapsed_blocks};
use super::view::FIT_MARGIN;

/// What decides which blocks are drawn and which are behind boxes. Blocks are named, so that they are found again after
/// an edit.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Detail {
    /// Blocks that the user collapsed.
    pub(super) collapsed: BTreeSet<String>,
    /// The first and the last of the neighbors that are drawn in more detail than the rest.
    focus: Option<(String, String)>,
    /// Whether everything is drawn, however small.
    pub(super) is_expanded: bool,
    /// The room that the drawing is made for; none before the panel has been seen.
    room: Option<(u32, u32)>,
    /// Whether there is room for the windows of events.
    has_windows: bool,
}

/// Rooms that differ by less than this have the same drawing, in points.
const ROOM_STEP: f32 = 8.0;

impl Detail {
    /// Follows the size of the panel and what is shown.
    pub(super) fn follow(&mut self, panel: Vec2, is_fitted: bool, has_windows: bool) {
        let room = panel - Vec2::splat(2.0 * FIT_MARGIN);
        let step = |length: f32| (length.max(0.0) / ROOM_STEP) as u32;
        // A view that the user has moved keeps what it shows.
        if is_fitted || self.room.is_none() {
            self.room = Some((step(room.x), step(room.y)));
        }
        self.has_windows = has_windows;
    }

    /// Returns whether something is open or collapsed that was not by itself.
    pub(super) fn is_changed(&self) -> bool {
        self.is_expanded || self.focus.is_some() || !self.collapsed.is_empty()
    }

    /// Returns whether some part is drawn in more detail than the rest.
    pub(super) fn has_focus(&self) -> bool {
        self.focus.is_some()
    }

    /// What fits the panel, and nothing else.
    pub(super) fn reset(&mut self) {
        self.collapsed.clear();
        self.focus = None;
        self.is_expanded = false;
    }

    /// The same with everything drawn but what the user collapsed.
    pub(super) fn expanded(&self) -> Self {
        Self { is_expanded: true, ..self.clone() }
    }

    /// Opens the box that represents blocks from `first` to `last`.
    pub(super) fn open(&mut self, network: &Network, first: BlockId, last: BlockId) {
        let (Some(first), Some(last)) = (block_key(network, first), block_key(network, last)) else { return };
        if first != last || !self.collapsed.remove(&first) {
            self.focus = Some((first, last));
        }
    }

    /// Opens boxes until one of those of `nodes` that are hidden in `drawing` is visible.
    pub(super) fn reveal(&mut self, network: &Network, drawing: &NetworkDrawing, nodes: &[NodeId]) {
        let is_hidden = |node: &NodeId| drawing.node(*node).is_none() && drawing.box_of(*node).is_some();
        let nodes: Vec<NodeId> = nodes.iter().copied().filter(is_hidden).collect();
        if nodes.is_empty() {
            return;
        }
        let (options, focus, room) = self.drawn(network);
        for (first, last) in layout::openings(network, &options, focus, room, &nodes, &approximate_text_width)
        {
            self.open(network, first, last);
        }
    }

    /// The drawing of a network in this detail.
    pub(super) fn drawing(&self, network: &Network) -> NetworkDrawing {
        let (options, focus, room) = self.drawn(network);
        match room {
            None => layout::network(network, &options, &approximate_text_width),
            Some(room) => layout::fitted(network, &options, focus, room, &approximate_text_width),
        }
    }

    /// Returns what is drawn of a network: its options, what has most detail, and the room there is, if it is made to
    /// fit.
    fn drawn(&self, network: &Network) -> (Options, Option<layout::Range>, Option<Room>) {
        let window_width = if self.has_windows { Options::default().window_width } else { 0.0 };
        let collapsed = collapsed_blocks(network, &self.collapsed);
        let options = Options { collapsed, window_width, ..Options::default() };
        let length = |steps: u32| f64::from(steps) * f64::from(ROOM_STEP);
        let room = self.room.filter(|_| !self.is_expanded);
        let room = room.map(|(width, height)| Room { width: length(width), height: length(height) });
        let block = |key: &String| {
            let mut blocks = (0..network.blocks.len()).map(BlockId::from_index);
            blocks.find(|&block| block_key(network, block).as_ref() == Some(key))
        };
        let focus = self.focus.as_ref().and_then(|(first, last)| Some((block(first)?, block(last)?)));
        (options, focus.filter(|(first, last)| first <= last), room)
    }
}
