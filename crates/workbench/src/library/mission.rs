//! A mission of the library: a small project of texts and maps, with its dates and named versions.
//!
//! Written as JSON (`enroute-mission/1`), both where missions are kept and as the one file that holds a whole mission.

use std::borrow::Cow;
use std::sync::Arc;

use review::record::RecordError;
use review::{Record, strict};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use smol_str::SmolStr;

use crate::library::base64;

/// What tells missions apart, whatever they are called; the same in every tab and in every run.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct MissionId(pub SmolStr);

/// Where a mission came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MissionKind {
    /// Created in Enroute.
    Own,
    /// An edited copy of an example.
    Example,
    /// An edited copy of a lesson's mission.
    Lesson,
    /// An edited copy of what a link held.
    Shared,
    /// Opened from a file.
    File,
}

impl MissionKind {
    /// Returns what lists say of it; nothing of what was started here.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Own => "",
            Self::Example => "from an example",
            Self::Lesson => "from a lesson",
            Self::Shared => "from a link",
            Self::File => "from a file",
        }
    }
}

/// A named text of a mission.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextFile {
    /// Its name with extension, unique in the mission.
    pub name: SmolStr,
    pub text: String,
}

pub(crate) fn joined(texts: &[TextFile]) -> String {
    rmpl::files::joined(texts.iter().map(|file| (file.name.as_str(), file.text.as_str())))
}

/// The texts of a joined one; the main one keeps its name.
pub(super) fn split(text: &str, main: &str) -> Vec<TextFile> {
    let named = |(name, text): (&str, &str)| {
        let name = if name.is_empty() { main } else { name };
        TextFile { name: name.into(), text: text.to_owned() }
    };
    rmpl::files::split(text).into_iter().map(named).collect()
}

/// A map of a mission.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MapFile {
    /// The name under which the text asks for it.
    pub name: SmolStr,
    /// The file; `None` where only the name is written because the content is kept beside, or is not read yet.
    #[serde(default, skip_serializing_if = "Option::is_none", with = "base64")]
    pub bytes: Option<Arc<[u8]>>,
}

/// The texts of a mission as they once were.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Version {
    /// What its author called it.
    pub name: String,
    /// When it was kept, in milliseconds since 1970, UTC.
    pub at_millis: i64,
    /// The texts, the main one first.
    pub texts: Vec<TextFile>,
}

/// A layout of panels that was saved with a mission.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SavedLayout {
    /// What its author called it.
    pub name: String,
    /// The workspace that it is a layout of.
    pub workspace: String,
    /// The panels with their places, as the front end writes them; empty before that.
    pub tiles: String,
}

/// A mission that the library keeps: texts, maps and versions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mission {
    /// What tells it apart.
    pub id: MissionId,
    /// What its author calls it.
    pub name: SmolStr,
    /// Where it came from.
    pub kind: MissionKind,
    /// When it was started, in milliseconds since 1970, UTC.
    pub created_millis: i64,
    /// When it was last changed, in milliseconds since 1970, UTC.
    pub changed_millis: i64,
    /// When it was deleted, if it was: until it is thrown away it can be brought back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deleted_millis: Option<i64>,
    /// The texts, the main one first; at least one.
    pub texts: Vec<TextFile>,
    /// The maps that were imported for it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub maps: Vec<MapFile>,
    /// The texts as they once were, the oldest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub versions: Vec<Version>,
    /// What reviewers said and signed, where the whole mission is in one file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub review: Option<Value>,
    /// A small picture of its plan: bars by start, end and row, in thousandths of the picture.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub picture: Vec<[u16; 3]>,
    /// Layouts that were saved with it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layouts: Vec<SavedLayout>,
}

/// The name of the main text of a mission that has no other.
pub const MAIN_TEXT: &str = "mission.rmpl";

/// What the JSON of a mission calls itself.
pub const FORMAT: &str = "enroute-mission/1";

/// What is before the checksum at the end of the JSON.
const CHECKSUM: &str = ",\"checksum\":\"";

/// Returns whether the checksum is that of what is before it, if there is one.
fn fits_checksum(text: &str) -> bool {
    let Some((body, end)) = text.rsplit_once(CHECKSUM) else { return true };
    let checksum = end.strip_suffix("\"}").and_then(|digits| u64::from_str_radix(digits, 16).ok());
    // What stands elsewhere is none.
    checksum.is_none_or(|checksum| checksum == print(&format!("{body}}}")))
}

/// A number that tells texts apart (FNV-1a).
pub(crate) fn print(text: &str) -> u64 {
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |print, byte| (print ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Why something cannot be read as a mission.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MissionError {
    /// It is not a mission.
    #[error("not a mission file")]
    NoMission,
    /// A later version of the program wrote it.
    #[error("unknown mission format {0}; update Enroute to open it")]
    Unknown(String),
    /// It says that it is a mission, and is damaged.
    #[error("the file is damaged: {0}")]
    Damaged(String),
}

/// What is written: a mission with the name of its format.
#[derive(Serialize)]
struct Written<'a> {
    format: &'static str,
    program: &'static str,
    #[serde(flatten)]
    mission: &'a Mission,
}

impl Mission {
    /// All texts as one, which is what is edited (`rmpl::files`).
    pub fn joined_text(&self) -> String {
        joined(&self.texts)
    }

    /// Returns whether its texts are those of a joined one.
    pub(crate) fn says(&self, text: &str) -> bool {
        let files = rmpl::files::split(text);
        files.len() == self.texts.len()
            && files
                .iter()
                .zip(&self.texts)
                .enumerate()
                .all(|(index, (file, kept))| file.1 == kept.text && (index == 0 || file.0 == kept.name))
    }

    /// Makes its texts those of a joined one.
    pub(crate) fn say(&mut self, text: &str) {
        let main = self.texts.first().map_or(MAIN_TEXT, |main| &main.name);
        self.texts = split(text, main);
    }

    /// The mission as JSON with all that it holds.
    pub fn to_json(&self) -> String {
        serde_json::to_string(&Written { format: FORMAT, program: review::PROGRAM, mission: self })
            .unwrap_or_default()
    }

    /// The same JSON with a checksum as its last entry, by which [`Mission::from_json`] notices damage: what the library
    /// keeps. A file that other programs may change goes without.
    pub fn to_checked_json(&self) -> String {
        let mut json = self.to_json();
        let checksum = print(&json);
        json.pop();
        json.push_str(&format!("{CHECKSUM}{checksum:016x}\"}}"));
        json
    }

    /// The mission with the names of its maps and without their content, which is kept beside it.
    pub fn without_maps(&self) -> Cow<'_, Self> {
        if self.maps.iter().all(|map| map.bytes.is_none()) {
            return Cow::Borrowed(self);
        }
        let maps = self.maps.iter().map(|map| MapFile { name: map.name.clone(), bytes: None }).collect();
        Cow::Owned(Self { maps, ..self.clone() })
    }

    /// The same without what takes room and hardly changes: what is written down at each key press.
    pub(crate) fn latest(&self) -> Self {
        let maps = self.maps.iter().map(|map| MapFile { name: map.name.clone(), bytes: None }).collect();
        Self { maps, versions: Vec::new(), review: None, picture: Vec::new(), ..self.clone() }
    }

    /// Reads a mission.
    pub fn from_json(text: &str) -> Result<Self, MissionError> {
        if !fits_checksum(text) {
            return Err(MissionError::Damaged("its checksum does not fit".to_owned()));
        }
        let value = strict::from_str(text).map_err(|error| {
            // What begins like one and ends too early is a mission that was cut off.
            let begins = text.trim_start().starts_with('{') && text.contains("\"enroute-mission/");
            if begins { MissionError::Damaged(error.to_string()) } else { MissionError::NoMission }
        })?;
        match value.get("format").and_then(Value::as_str) {
            Some(FORMAT) => {}
            Some(other) if other.starts_with("enroute-mission/") => {
                return Err(MissionError::Unknown(other.to_owned()));
            }
            _ => return Err(MissionError::NoMission),
        }
        let mission: Self =
            serde_json::from_value(value).map_err(|error| MissionError::Damaged(error.to_string()))?;
        if mission.texts.is_empty() {
            return Err(MissionError::Damaged("the text is missing".to_owned()));
        }
        Ok(mission)
    }

    /// Returns what its board said, if the file holds it, or why that cannot be used.
    pub fn review_record(&self) -> Option<Result<Record, RecordError>> {
        self.review.as_ref().map(|review| Record::from_json(&review.to_string()))
    }
}
