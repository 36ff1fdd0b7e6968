//! What commands leave for the host to do.

use link::Request;
use review::Record;
use smol_str::SmolStr;

use crate::area::Area;
use crate::host::{FileKind, Save};
use crate::library::MissionId;
use crate::state::keys::KeyChange;

/// Something that the host is to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Put text on the clipboard.
    Copy(String),
    /// Paste what is on the clipboard into the text.
    Paste,
    /// Let the user choose a file.
    OpenFile(FileKind),
    /// Save the open mission to its file, or these files where the host cannot do that.
    Save(Save, Vec<(String, Vec<u8>)>),
    /// A mission is saved from now on to the file that was opened with this token.
    KeepFile(MissionId, u32),
    /// Let the user save a file.
    SaveFile {
        /// The name to suggest.
        name: String,
        bytes: Vec<u8>,
    },
    /// Let the user save a picture as a PNG.
    SavePicture {
        /// The name to suggest.
        name: String,
        /// The picture as an SVG.
        svg: String,
        /// Width and height in pixels.
        size: [u32; 2],
    },
    /// Record what is drawn in a part of the window, from now on or instead of another part.
    Film(Area),
    /// End what is recorded, and let the user save it.
    SaveFilm {
        /// The name to suggest.
        name: String,
    },
    /// Put a link to the present view on the clipboard.
    CopyLink,
    /// Send something to the planning core.
    Post(Request),
    /// Take back everything that the planning core was asked.
    Stop,
    /// Keep what reviewers said of the open mission.
    KeepReview {
        /// Whether what is kept already, perhaps by another tab, is joined with it.
        joins: bool,
    },
    /// Find what reviewers said of the open mission.
    RecallReview,
    /// Add what another tab has kept of it since.
    HearReview,
    /// Change the keys that are kept.
    ChangeKeys(KeyChange),
    /// Find the keys that are kept.
    RecallKeys,
    /// Add to what reviewers said of the open mission.
    JoinReview(Box<Record>),
    /// Keep what came as the review of the open mission and cannot be used.
    SetReviewAside(Aside),
    /// Read a map of a mission from where it is kept.
    ReadMap(MissionId, SmolStr),
    /// Let the address name what is open, so that loading the page again finds it.
    ShowAddress,
    /// The appearance changed.
    Restyle,
}

/// A record that was kept or came with a mission, and cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Aside {
    pub reason: String,
    pub text: String,
}
