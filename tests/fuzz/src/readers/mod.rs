//! The readers, each with its seeds and with what must hold whatever it is given.

mod archives;
mod control;
mod documents;
mod exports;
mod links;
mod maps;
mod missions;
mod models;
mod networks;
mod page;

use std::borrow::Cow;
use std::collections::hash_map::DefaultHasher;
use std::fs;
use std::hash::{Hash as _, Hasher as _};
use std::path::{Path, PathBuf};

/// Something that reads other people's data.
#[derive(Clone, Copy)]
pub struct Reader {
    /// Its name, and that of its folders in `corpus/` and `broken/`.
    pub name: &'static str,
    /// Files of the repository that it reads, besides those in its own folder: folders with an ending, or files.
    pub seeds: &'static [&'static str],
    /// Signs of its notation.
    pub words: &'static [&'static str],
    /// Makes checksums right again after a change, so that what lies behind them is reached.
    pub mend: fn(&mut [u8]),
    /// Reads an input and does with it what the program does.
    pub exercise: fn(&[u8]) -> Outcome,
    /// How many inputs a test gives it.
    pub tested: u64,
    /// Of ten mutations, how many keep brackets and words whole.
    pub keeps_form: usize,
    /// A long run gives it one input where others get so many, for it takes as many times as long.
    pub cost: u64,
}

/// All readers, in the order of the table that a long run prints.
pub const READERS: &[Reader] = &[
    missions::TEXTS,
    missions::PLANNED,
    exports::EXPORTS,
    missions::RULES,
    control::CONTROL,
    control::RUN,
    networks::NETWORKS,
    networks::PTPN,
    networks::UNCERTAIN,
    networks::PLANS,
    models::JMPL,
    models::PAMELA,
    documents::OBSERVATIONS,
    documents::DISTURBANCES,
    documents::UNCERTAINTY,
    documents::PLACES,
    documents::REVIEWS,
    documents::FLIGHT_RULES,
    archives::ARCHIVES,
    links::LINKS,
    page::LESSONS,
    page::SETTINGS,
    page::FILES,
    page::COMMANDS,
    maps::PNG,
    maps::TIFF,
    maps::PNM,
    maps::ASCII_GRID,
    maps::MOVING_AI,
    maps::PDS,
    maps::DETACHED,
    maps::ROS,
    maps::ANY,
];

/// The reader of this name.
pub fn by_name(name: &str) -> Option<&'static Reader> {
    READERS.iter().find(|reader| reader.name == name)
}

/// Nothing to make right.
fn nothing(_: &mut [u8]) {}

fn own_folder(kind: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(kind)
}

/// The files of a folder, by name.
fn files(folder: &Path, ending: &str) -> Vec<Vec<u8>> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut paths: Vec<PathBuf> =
        entries.filter(|path| path.is_file() && path.to_string_lossy().ends_with(ending)).collect();
    paths.sort();
    paths.iter().filter_map(|path| fs::read(path).ok()).collect()
}

/// Returns what the files hold that a pattern names: one file, or `folder/*ending`, below the root of the repository.
pub fn matching(pattern: &str) -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    match pattern.split_once('*') {
        Some((folder, ending)) => files(&root.join(folder), ending),
        None => fs::read(root.join(pattern)).into_iter().collect(),
    }
}

impl Reader {
    /// Returns what once broke it.
    pub fn broken(&self) -> Vec<Vec<u8>> {
        files(&own_folder("broken").join(self.name), "")
    }

    /// Files of its kind.
    pub fn seeds(&self) -> Vec<Vec<u8>> {
        let own = files(&own_folder("corpus").join(self.name), "");
        own.into_iter().chain(self.seeds.iter().flat_map(|pattern| matching(pattern))).collect()
    }
}

/// An input as text, as programs read files.
fn text_of(input: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(input)
}

/// What an input led to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// The same number for the same kind of outcome.
    pub signature: u64,
    /// Whether the input was read, and not refused.
    pub is_read: bool,
}

/// An input that is not a document of the reader's kind at all.
const NOTHING: Outcome = Outcome { signature: 0, is_read: false };

/// A refusal: its first words count, and what differs from one input to the next does not.
fn refused(why: &str) -> Outcome {
    Outcome { signature: signature(&why.chars().take(60).collect::<String>()), is_read: false }
}

/// Returns what reading led to.
fn read(what: &str) -> Outcome {
    Outcome { signature: signature(what) | 1, is_read: true }
}

fn signature(words: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    let mut is_quoted = false;
    for letter in words.chars().take(300) {
        is_quoted ^= matches!(letter, '"' | '`');
        if !is_quoted && (letter.is_alphabetic() || letter == ' ') {
            letter.hash(&mut hasher);
        }
    }
    hasher.finish() & !1
}

/// Returns how large something is, roughly.
fn magnitude(count: usize) -> char {
    char::from(b'a' + (usize::BITS - count.leading_zeros()) as u8 % 26)
}
