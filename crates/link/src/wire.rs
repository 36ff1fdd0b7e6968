//! Requests and answers as bytes, between a core and whoever asks it from another memory.
//!
//! Of a snapshot only those parts travel that are not there already: [`Writer`] knows what it has sent, [`Reader`]
//! holds what has come, and shares it between snapshots. A part whose places in the text have only moved is moved on
//! the other side, too.

use std::sync::Arc;

use rmpl::Edit;
use rmpl::program::Program;
use rmpl::spans::{Spans, difference};
use serde::{Deserialize, Serialize};
use snapshot::Problem;
use snapshot::{ContentKey, PartKeys};
use snapshot::{MapKey, Planning, SeparationViolation, Snapshot, Stage, Timings, Traverse, VehicleMotion};
use tpn::Network;

use crate::{Request, Response};

/// Why bytes cannot be written or read.
pub type Error = postcard::Error;

/// A request as bytes.
pub fn write_request(request: &Request) -> Result<Vec<u8>, Error> {
    postcard::to_stdvec(request)
}

/// A request from bytes.
pub fn read_request(bytes: &[u8]) -> Result<Request, Error> {
    postcard::from_bytes(bytes)
}

/// What a request is known by.
pub(crate) fn bytes_of_request(request: &Request) -> Vec<u8> {
    // What has no bytes cannot be sent either, and needs no name.
    write_request(request).unwrap_or_default()
}

/// An answer as it travels.
#[derive(Debug, Serialize, Deserialize)]
enum Message {
    Snapshot(Box<SnapshotChange>),
    Other(Response),
}

/// A snapshot, as far as it differs from the one sent before.
#[derive(Debug, Serialize, Deserialize)]
struct SnapshotChange {
    revision: u64,
    stage: Stage,
    timings: Timings,
    map: Option<MapKey>,
    keys: PartKeys,
    /// Of the text sent before.
    source: Edit,
    problems: Change<Arc<[Problem]>>,
    program: Change<Arc<Program>>,
    network: Change<Option<Arc<Network>>>,
    planning: Change<Option<Arc<Planning>>>,
    traverses: Change<Arc<[Traverse]>>,
    motions: Change<Arc<[VehicleMotion]>>,
    separation_violations: Change<Arc<[SeparationViolation]>>,
}

/// What became of a part.
#[derive(Debug, Serialize, Deserialize)]
enum Change<T> {
    /// It is there already.
    Kept,
    /// Its places moved with the edit of the text.
    Moved,
    /// It is another one.
    New(T),
}

/// A part that is shared.
trait Shared: Clone + PartialEq {
    /// Whether it is the very same.
    fn is(&self, other: &Self) -> bool;

    /// The same with its places moved; nothing if it has no places.
    fn moved(&self, edit: &Edit) -> Option<Self>;
}

impl<T: Clone + PartialEq + Spans> Shared for Arc<T> {
    fn is(&self, other: &Self) -> bool {
        Self::ptr_eq(self, other)
    }

    fn moved(&self, edit: &Edit) -> Option<Self> {
        let mut moved = T::clone(self);
        moved.follow(edit);
        Some(Self::new(moved))
    }
}

impl<T: Clone + PartialEq + Spans> Shared for Option<Arc<T>> {
    fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (None, None) => true,
            _ => false,
        }
    }

    fn moved(&self, edit: &Edit) -> Option<Self> {
        Some(Some(self.as_ref()?.moved(edit)?))
    }
}

impl<T: PartialEq> Shared for Arc<[T]> {
    fn is(&self, other: &Self) -> bool {
        Self::ptr_eq(self, other) || self == other
    }

    fn moved(&self, _edit: &Edit) -> Option<Self> {
        None
    }
}

impl<T: Shared> Change<T> {
    fn of(before: &T, after: &T, edit: &Edit, has_same_key: bool) -> Self {
        if before.is(after) {
            return Self::Kept;
        }
        // What has the same key differs in its places at most; that it is so is looked at all the same.
        if has_same_key && before.moved(edit).is_some_and(|moved| moved == *after) {
            return Self::Moved;
        }
        Self::New(after.clone())
    }

    fn apply(self, held: &mut T, edit: &Edit) {
        match self {
            Self::Kept => {}
            Self::Moved => {
                if let Some(moved) = held.moved(edit) {
                    *held = moved;
                }
            }
            Self::New(part) => *held = part,
        }
    }
}

/// Writes the answers of one core to one asker.
#[derive(Debug, Default)]
pub struct Writer {
    sent: Option<Arc<Snapshot>>,
}

impl Writer {
    /// An answer as bytes; they must reach the asker in order.
    pub fn write(&mut self, response: Response) -> Result<Vec<u8>, Error> {
        let Response::Snapshot(snapshot) = response else {
            return postcard::to_stdvec(&Message::Other(response));
        };
        let nothing = Snapshot::empty(0, Arc::default());
        let sent = self.sent.as_deref().unwrap_or(&nothing);
        let bytes = postcard::to_stdvec(&Message::Snapshot(Box::new(SnapshotChange::of(sent, &snapshot))));
        self.sent = Some(snapshot);
        bytes
    }
}

/// Reads the answers of one core.
#[derive(Debug, Default)]
pub struct Reader {
    /// Which of several cores is read.
    core: u32,
    held: Option<Snapshot>,
}

impl Reader {
    /// Reads what a core says that was started as the `core`th: keys of an earlier one mean nothing to it.
    pub const fn of_core(core: u32) -> Self {
        Self { core, held: None }
    }

    /// An answer from bytes.
    pub fn read(&mut self, bytes: &[u8]) -> Result<Response, Error> {
        let change = match postcard::from_bytes(bytes)? {
            Message::Other(response) => return Ok(self.with_own_keys(response)),
            Message::Snapshot(change) => change,
        };
        let held = self.held.take().unwrap_or_else(|| Snapshot::empty(0, Arc::default()));
        let snapshot = change.apply(held, self.core);
        self.held = Some(snapshot.clone());
        Ok(Response::Snapshot(Arc::new(snapshot)))
    }

    fn with_own_keys(&self, mut response: Response) -> Response {
        match &mut response {
            Response::ControlRun(standing) => {
                standing.run = standing.run.of_core(self.core);
                standing.program = standing.program.of_core(self.core);
            }
            Response::PathGrowth(standing) => standing.search = standing.search.of_core(self.core),
            _ => {}
        }
        response
    }
}

impl SnapshotChange {
    fn of(before: &Snapshot, after: &Snapshot) -> Self {
        let edit = difference(&before.source, &after.source);
        let (old, new) = (&before.keys, &after.keys);
        let keyed = |old: ContentKey, new: ContentKey| old == new && new != ContentKey::default();
        Self {
            revision: after.revision,
            stage: after.stage,
            timings: after.timings,
            map: after.map.clone(),
            keys: *new,
            problems: Change::of(&before.problems, &after.problems, &edit, false),
            program: Change::of(&before.program, &after.program, &edit, keyed(old.program, new.program)),
            network: Change::of(&before.network, &after.network, &edit, keyed(old.network, new.network)),
            planning: Change::of(&before.planning, &after.planning, &edit, keyed(old.planning, new.planning)),
            traverses: Change::of(&before.traverses, &after.traverses, &edit, false),
            motions: Change::of(&before.motions, &after.motions, &edit, false),
            separation_violations: Change::of(
                &before.separation_violations,
                &after.separation_violations,
                &edit,
                false,
            ),
            source: edit,
        }
    }

    fn apply(self, mut held: Snapshot, core: u32) -> Snapshot {
        let edit = &self.source;
        let has_changed = !edit.text.is_empty() || !edit.span.range().is_empty();
        if has_changed && held.source.get(edit.span.range()).is_some() {
            let mut source = held.source.to_string();
            source.replace_range(edit.span.range(), &edit.text);
            held.source = source.into();
        }
        self.problems.apply(&mut held.problems, edit);
        self.program.apply(&mut held.program, edit);
        self.network.apply(&mut held.network, edit);
        self.planning.apply(&mut held.planning, edit);
        self.traverses.apply(&mut held.traverses, edit);
        self.motions.apply(&mut held.motions, edit);
        self.separation_violations.apply(&mut held.separation_violations, edit);
        held.revision = self.revision;
        held.stage = self.stage;
        held.timings = self.timings;
        held.map = self.map;
        let PartKeys { program, network, planning, traverses, motions, separation_violations } = self.keys;
        held.keys = PartKeys {
            program: program.of_core(core),
            network: network.of_core(core),
            planning: planning.of_core(core),
            traverses: traverses.of_core(core),
            motions: motions.of_core(core),
            separation_violations: separation_violations.of_core(core),
        };
        held
    }
}
