//! The line between the front end and where it runs: a page, a native window, or a test.
//!
//! [`Host`] is what the app needs from outside: the planning core, storage, files, the address line and a clock. The
//! app never touches a thread, a file or a clock itself. The other direction is [`Remote`](crate::host_io::Remote).

use link::{Request, Response};
#[cfg(test)]
use ts_rs::TS;

use crate::area::Area;
use crate::limits::{MAX_FILE_BYTES, MAX_TEXT_BYTES};

/// What the app needs from where it runs.
///
/// Nothing here blocks. What takes time is started by one call and answered by a later [`Host::poll`]; the host asks for
/// a repaint when it has something to tell.
pub trait Host {
    /// Sends a request to the planning core.
    ///
    /// An [`Request::Update`] supersedes every earlier one that has not been answered in full: the earlier one may
    /// then be dropped or stopped half way. Other requests are kept, in order.
    fn post(&mut self, request: Request);

    /// Takes back everything that was asked of the planning core, but the maps that it reads.
    fn stop(&mut self);

    /// The next thing that happened outside, oldest first; `None` when there is nothing new.
    ///
    /// To be called in every frame until it answers `None`.
    fn poll(&mut self) -> Option<HostEvent>;

    /// Seconds since an arbitrary fixed moment; never goes back.
    fn monotonic_secs(&self) -> f64;

    /// The date and time, in milliseconds since the start of 1970 in UTC; for saying when something was written, not
    /// for measuring.
    fn unix_millis(&self) -> i64;

    /// The text kept under this key, if any.
    fn stored(&self, key: &str) -> Option<String>;

    /// Keeps a text under a key, beyond the end of this run.
    fn store(&mut self, key: &str, value: &str) -> Result<(), StorageError>;

    /// Drops what is kept under a key.
    fn forget(&mut self, key: &str);

    /// The keys under which a text is kept, in no particular order.
    fn stored_keys(&self) -> Vec<String>;

    /// Begins to use the shelf, the large place where missions are kept: all that lies on it but the content of maps
    /// (keys that begin with `map/`). `None` if that takes longer: [`ShelfNews::Opened`] brings it then.
    fn open_shelf(&mut self) -> Option<Result<ShelfContent, StorageError>>;

    /// Reads from the shelf, or writes to it. What is asked for one key is done in order, and each of it as a whole or
    /// not at all; [`HostEvent::Shelf`] answers.
    fn use_shelf(&mut self, request: ShelfRequest);

    /// Tells the other tabs that show this page; [`HostEvent::TabSaid`] is how they hear it.
    fn tell_tabs(&mut self, message: &str);

    /// Returns whether the user wants nothing to move by itself.
    fn reduces_motion(&self) -> bool {
        false
    }

    /// Returns whether this is a page in Firefox, which keeps some keys for itself.
    fn is_firefox(&self) -> bool {
        false
    }

    /// A number that no other run has drawn.
    fn random(&mut self) -> u64;

    /// 32 bytes that no one can guess, for secret keys; `None` where there is no source of such.
    fn secret_bytes(&mut self) -> Option<[u8; 32]>;

    /// Lets the user choose one file; [`HostEvent::FileOpened`] brings it. Must be called while handling a click or a
    /// key press: browsers refuse otherwise.
    fn open_file(&mut self, kind: FileKind);

    /// Returns whether missions are saved to files that the user chose once, by [`Host::save_in_place`].
    fn saves_in_place(&self) -> bool {
        false
    }

    /// Saves a mission to its file; lets the user choose one where it has none. [`HostEvent::FileSaved`] or
    /// [`HostEvent::FileFailed`] answers, and nothing where the user chooses no file. As [`Host::open_file`], only while
    /// handling a click or a key press; never called where [`Host::saves_in_place`] says no.
    fn save_in_place(&mut self, _save: Save) {}

    /// From now on a mission is saved to the file that was opened with this token.
    fn keep_file(&mut self, _mission: &str, _token: u32) {}

    /// Reads the text on the clipboard; [`HostEvent::ClipboardRead`] or [`HostEvent::ClipboardRefused`] answers. As
    /// [`Host::open_file`], only while handling a click or a key press. Returns whether the host can do that: in others
    /// the window around the app pastes.
    fn read_clipboard(&mut self) -> bool {
        false
    }

    /// Lets the user save `bytes` as a file.
    fn save_file(&mut self, suggested_name: &str, bytes: Vec<u8>);

    /// Lets the user save an SVG as a PNG of this width and height in pixels. A browser can draw SVGs; hosts that
    /// cannot answer with [`HostEvent::FileFailed`].
    fn save_picture(&mut self, suggested_name: &str, svg: String, size: [u32; 2]);

    /// Records what is drawn in a part of the window as a video, until [`Host::save_film`]; while one is recorded, it
    /// continues with that part. Says why it can't.
    fn film(&mut self, _area: Area) -> Result<(), String> {
        Err("Videos are recorded in a browser: open the mission in the page of Enroute".to_owned())
    }

    /// Ends the video and lets the user save it; [`HostEvent::FileFailed`] says if there is none.
    fn save_film(&mut self, _suggested_name: &str) {}

    /// Returns what is after `#` in the page's address; empty outside a page.
    fn fragment(&self) -> String;

    /// Replaces what is after `#` in the page's address, without a new entry in the history. Does nothing
    /// outside a page.
    fn set_fragment(&mut self, fragment: &str);

    /// The whole address of the page with this fragment, for sharing; `None` outside a page.
    fn link(&self, fragment: &str) -> Option<String>;
}

/// Something that happened outside the app.
#[derive(Clone, Debug, PartialEq)]
pub enum HostEvent {
    /// The planning core answered.
    Answer(Response),
    /// The planning core stopped while it worked on this revision and has been started again. The text and the last
    /// answer are unharmed; the next [`Request::Update`] is answered as usual, the one that stopped it is not
    /// repeated.
    CoreFailed {
        /// The revision that was being worked on, if the request had one.
        revision: Option<u64>,
        /// What the core said when it stopped.
        message: String,
    },
    /// The planning core ended and was started again; what it was at is done again.
    CoreRestarted {
        /// What is known of the reason.
        message: String,
    },
    /// The user chose a file.
    FileOpened {
        /// What it was asked for.
        kind: FileKind,
        /// Its name, without folders.
        name: String,
        bytes: Vec<u8>,
        /// What [`Host::keep_file`] knows the file by, where the host can write to it.
        token: Option<u32>,
    },
    /// A mission was saved to its file.
    FileSaved {
        /// The file's name, without folders.
        name: String,
        /// What came with the request.
        revision: u64,
    },
    /// A file could not be read or written.
    FileFailed {
        /// Its name, as far as known.
        name: String,
        /// Why, for the person who chose it.
        reason: String,
    },
    /// The user edited the address line or followed a link within the page: the new text after `#`.
    FragmentChanged(String),
    /// The shelf answers.
    Shelf(ShelfNews),
    /// Another tab said this by [`Host::tell_tabs`].
    TabSaid(String),
    /// The window is a private one: all that is kept is deleted when it closes.
    PrivateWindow,
    /// The text on the clipboard, to be pasted into the mission's text.
    ClipboardRead(String),
    /// The clipboard could not be read.
    ClipboardRefused {
        /// Why, and what to do instead.
        reason: String,
    },
}

/// Keys of a shelf with what is kept under them.
pub type ShelfContent = Vec<(String, Vec<u8>)>;

/// Something that is asked of the shelf.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ShelfRequest {
    /// Keep bytes under a key.
    Write {
        key: String,
        bytes: Vec<u8>,
        /// Comes back with the answer.
        token: i64,
    },
    /// Tell what is kept under a key.
    Read { key: String },
    /// Drop what is kept under a key.
    Remove { key: String },
}

/// What the shelf answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ShelfNews {
    /// What lies on it, late.
    Opened(Result<ShelfContent, StorageError>),
    /// A request to write was carried out, or could not be.
    Written {
        key: String,
        /// What came with the request.
        token: i64,
        /// Why nothing was changed, if so.
        outcome: Result<(), StorageError>,
    },
    /// What is kept under a key, if anything.
    Read {
        key: String,
        /// What is kept there.
        outcome: Result<Option<Vec<u8>>, StorageError>,
    },
}

/// A mission that is to be saved to its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Save {
    /// What the mission is known by.
    pub mission: String,
    /// Whether the user chooses a file even where the mission has one.
    pub asks: bool,
    /// The forms in which it can be saved, as names that can be suggested and contents: the text alone, or the whole
    /// mission. The file's extension decides; the first one is suggested.
    pub forms: Vec<(String, Vec<u8>)>,
    /// The revision of the text; comes back with the answer.
    pub revision: u64,
}

/// What a file is opened for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A mission's text.
    Mission,
    /// An elevation or occupancy map.
    Map,
    /// What reviewers said and signed, or another JSON document.
    Json,
    Lesson,
    /// A mission, a saved plan or a signed review, to compare the open mission with.
    Comparison,
}

impl FileKind {
    /// Returns what a file of this name is opened for; a mission if its extension says nothing.
    pub fn of_name(name: &str) -> Self {
        let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension).to_ascii_lowercase();
        let is_one = |kind: &Self| kind.extensions().contains(&extension.as_str());
        [Self::Map, Self::Json, Self::Lesson].into_iter().find(is_one).unwrap_or(Self::Mission)
    }

    /// The most bytes of such a file that are read.
    pub fn max_bytes(self, name: &str) -> usize {
        let is_mission_file = name.to_ascii_lowercase().ends_with(".enroute");
        if self == Self::Map || is_mission_file { MAX_FILE_BYTES } else { MAX_TEXT_BYTES }
    }

    /// Returns what the file dialog calls it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Mission => "Missions and networks",
            Self::Map => "Maps and GeoJSON places",
            Self::Json => "JSON documents",
            Self::Lesson => "Lessons",
            Self::Comparison => "Missions, plans and reviews",
        }
    }

    /// The extensions that the file dialog offers, without dots.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Mission => {
                &["rmpl", "enroute", "txt", "lisp", "json", "edn", "tpn", "ptpn", "xml", "jmpl", "pamela"]
            }
            Self::Map => {
                &["pgm", "png", "map", "tif", "tiff", "asc", "dem", "img", "lbl", "yaml", "yml", "geojson"]
            }
            Self::Json => &["json", "edn"],
            Self::Lesson => &["md", "markdown"],
            Self::Comparison => &["rmpl", "txt", "json"],
        }
    }
}

/// Why a text was not kept.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StorageError {
    /// The place is full; nothing was changed.
    #[error("storage is full: no space for {bytes} more bytes")]
    Full {
        /// How many bytes were to be kept.
        bytes: usize,
    },
    /// There is no place to keep anything, as in a private window.
    #[error("storage is not available: {reason}")]
    Unavailable {
        /// What the host says about it.
        reason: String,
    },
}

/// Why a call from outside was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RemoteError {
    /// There is no example of this name.
    #[error("unknown mission \"{name}\"; known missions: {}", known.join(", "))]
    UnknownMission {
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
    /// The registry has no such command.
    #[error("unknown command \"{name}\"")]
    UnknownCommand {
        /// What was asked for.
        name: String,
    },
    /// The command cannot be used with these arguments.
    #[error("invalid arguments for command \"{command}\": {reason}")]
    BadArguments {
        command: String,
        /// What is wrong with the arguments.
        reason: String,
    },
    /// The command cannot be used now.
    #[error("command \"{command}\" is not available now: {reason}")]
    Unavailable {
        command: String,
        /// What it waits for.
        reason: String,
    },
}

/// The `code` of an error that the page throws: a stable name for programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(test, derive(TS), ts(rename_all = "kebab-case"))]
pub enum RefusalCode {
    /// The front end is still loading.
    NotReady,
    /// The front end has stopped.
    Stopped,
    /// Nothing can draw the front end here.
    NoGraphics,
    /// There is no example of this name.
    UnknownMission,
    /// There is no command of this name.
    UnknownCommand,
    /// The arguments do not fit.
    BadArguments,
    /// The command has nothing to work on now.
    Unavailable,
}

impl RefusalCode {
    /// The name that programs read.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotReady => "not-ready",
            Self::Stopped => "stopped",
            Self::NoGraphics => "no-graphics",
            Self::UnknownMission => "unknown-mission",
            Self::UnknownCommand => "unknown-command",
            Self::BadArguments => "bad-arguments",
            Self::Unavailable => "unavailable",
        }
    }
}

impl RemoteError {
    /// The code of the error that the page throws.
    pub const fn code(&self) -> RefusalCode {
        match self {
            Self::UnknownMission { .. } => RefusalCode::UnknownMission,
            Self::UnknownCommand { .. } => RefusalCode::UnknownCommand,
            Self::BadArguments { .. } => RefusalCode::BadArguments,
            Self::Unavailable { .. } => RefusalCode::Unavailable,
        }
    }
}
