//! The ground of the missions opened so far, and maps on their way to the core that reads them.

use std::collections::BTreeMap;
use std::sync::Arc;

use link::Request;
use smol_str::SmolStr;
use snapshot::{MapKey, Snapshot};
use terrain::Terrain;
use terrain::format::{FileFormat, attach_label, image_of_label};

use crate::state::growth::GrowthInput;
use crate::state::selection::Selection;
use crate::state::snapshots::Snapshots;
use crate::state::window::Window;

/// The maps that were read, and those that wait for the core.
#[derive(Debug, Default)]
pub struct Maps {
    read: BTreeMap<MapKey, Arc<Terrain>>,
    /// Maps that the user chose and that the core has not read yet.
    in_hand: BTreeMap<SmolStr, Arc<[u8]>>,
    /// A label that came without its image.
    waiting_label: Option<WaitingLabel>,
    /// The map that was opened last, whose label may come after it.
    last: Option<(String, Vec<u8>)>,
}

/// A file that describes an image that did not come yet.
#[derive(Debug)]
struct WaitingLabel {
    name: String,
    /// As the label names it, maybe with folders.
    image_name: String,
    bytes: Vec<u8>,
}

impl Maps {
    /// The maps that the core has read, by their keys.
    pub(crate) fn keys(&self) -> impl Iterator<Item = &MapKey> {
        self.read.keys()
    }

    /// The ground of a mission.
    pub fn of(&self, snapshot: &Snapshot) -> Option<&Arc<Terrain>> {
        self.read.get(snapshot.map.as_ref()?)
    }

    /// Returns what the growth of a search tree is made from, if the mission and its ground are there.
    pub(crate) fn growth_input<'a>(
        &self,
        snapshots: &'a Snapshots,
        selection: &'a Selection,
    ) -> Option<GrowthInput<'a>> {
        let snapshot = snapshots.shown()?;
        self.of(snapshot)?;
        Some(GrowthInput { snapshot, selection })
    }

    /// Takes a map as the core has read it.
    pub(crate) fn take(&mut self, key: MapKey, map: Arc<Terrain>) {
        self.read.insert(key, map);
    }

    /// Has the core read the file of a map, which says then what it has found.
    pub(crate) fn open_file(&mut self, name: &str, bytes: Vec<u8>, window: &mut Window) {
        let Some((name, bytes)) = self.with_label(name, bytes, window) else { return };
        let name = SmolStr::new(name);
        self.in_hand.insert(name.clone(), Arc::from(bytes.as_slice()));
        window.post(Request::ImportMap { name, bytes });
    }

    /// Lets go of a map that the core has read, or cannot use.
    pub(crate) fn let_go(&mut self, name: &str) -> Option<Arc<[u8]>> {
        self.in_hand.remove(name)
    }

    /// A map with the label that describes it, where that is a file of its own: whichever of the two comes first waits
    /// for the other.
    fn with_label(&mut self, name: &str, bytes: Vec<u8>, window: &mut Window) -> Option<(String, Vec<u8>)> {
        let (label, image_name, image) = if let Some(image_name) = image_of_label(&bytes) {
            let label = WaitingLabel { name: name.to_owned(), image_name, bytes };
            let Some((known, image)) = self.last.take().filter(|(known, _)| label.describes(known)) else {
                let words = format!("{name} is a label of {}. Open that file, too.", label.image_name);
                window.info(words);
                self.waiting_label = Some(label);
                return None;
            };
            (label, known, image)
        } else {
            let Some(label) = self.waiting_label.take().filter(|label| label.describes(name)) else {
                // Its label may come after it.
                let may_have_one = matches!(
                    FileFormat::detect(&bytes),
                    None | Some(FileFormat::Pgm | FileFormat::Png | FileFormat::Tiff)
                );
                self.last = may_have_one.then(|| (name.to_owned(), bytes.clone()));
                return Some((name.to_owned(), bytes));
            };
            (label, name.to_owned(), bytes)
        };
        // Missions name a map of ROS by its description, and an image of PDS3 by itself.
        let is_ros = FileFormat::detect(&label.bytes) == Some(FileFormat::RosMap);
        let whole_name = if is_ros { label.name } else { image_name };
        match attach_label(&label.bytes, &image) {
            Ok(whole) => Some((whole_name, whole)),
            Err(reason) => {
                window.failed(format!("Couldn't import map {whole_name}: {reason}"));
                None
            }
        }
    }
}

impl WaitingLabel {
    /// Returns whether its image is a file of this name, wherever that lies.
    fn describes(&self, file_name: &str) -> bool {
        self.image_name.rsplit(['/', '\\']).next().is_some_and(|it| it.eq_ignore_ascii_case(file_name))
    }
}
