//! Requests and answers as bytes, between a core and a front end that does not share its memory.
//!
//! Of a text only the edits travel, as long as both ends know which text they are of. Of a snapshot only those parts
//! travel that are not there already: [`CoreEnd`] knows what it has sent, [`AskerEnd`] holds what has come, and shares
//! it between snapshots. A part whose places in the text have only moved is moved on the other side, too.

use std::borrow::Cow;
use std::sync::Arc;

use rmpl::program::Program;
use rmpl::spans::Spans;
use rmpl::{Edit, Shift};
use serde::{Deserialize, Serialize};
use snapshot::Problem;
use snapshot::{ContentKey, PartKeys};
use snapshot::{MapKey, Planning, SeparationViolation, Snapshot, Stage, Timings, Traverse, VehicleMotion};
use tpn::Network;

use crate::Since;
use crate::{Request, Response};

/// Why bytes cannot be written or read.
pub type Error = postcard::Error;

/// A request as bytes. They hold its text only where no edits are known that lead there from the text of the request
/// before, which the core has.
pub fn write_request(request: &Request) -> Result<Vec<u8>, Error> {
    let text = request.source().map(|source| match &source.since {
        Some(Since { revision, edits }) => SentText::Edited(*revision, Cow::Borrowed(edits)),
        None => SentText::Full(source),
    });
    postcard::to_stdvec(&(text, request))
}

/// Returns what a request is known by.
pub(crate) fn bytes_of_request(request: &Request) -> Vec<u8> {
    // What has no bytes cannot be sent either, and needs no name.
    postcard::to_stdvec(request).unwrap_or_default()
}

/// The text of a request as it travels.
#[derive(Debug, Serialize, Deserialize)]
enum SentText<'bytes> {
    #[serde(borrow)]
    Full(&'bytes str),
    /// The revision of a text that was told before, and its edits in order.
    Edited(u64, Cow<'bytes, [Edit]>),
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
    /// How its text came from the text of that snapshot. The front end has the text itself.
    shift: Shift,
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
    /// Returns whether it is the very same.
    fn is(&self, other: &Self) -> bool;

    /// The same with its places moved; nothing if it has no places.
    fn moved(&self, shift: Shift) -> Option<Self>;
}

impl<T: Clone + PartialEq + Spans> Shared for Arc<T> {
    fn is(&self, other: &Self) -> bool {
        Self::ptr_eq(self, other)
    }

    fn moved(&self, shift: Shift) -> Option<Self> {
        let mut moved = T::clone(self);
        moved.follow(shift);
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

    fn moved(&self, shift: Shift) -> Option<Self> {
        Some(Some(self.as_ref()?.moved(shift)?))
    }
}

impl<T: PartialEq> Shared for Arc<[T]> {
    fn is(&self, other: &Self) -> bool {
        Self::ptr_eq(self, other) || self == other
    }

    fn moved(&self, _shift: Shift) -> Option<Self> {
        None
    }
}

impl<T: Shared> Change<T> {
    fn of(before: &T, after: &T, shift: Shift, has_same_key: bool) -> Self {
        if before.is(after) {
            return Self::Kept;
        }
        // What has the same key differs in its places at most; that it is so is looked at all the same.
        if has_same_key && before.moved(shift).is_some_and(|moved| moved == *after) {
            return Self::Moved;
        }
        Self::New(after.clone())
    }

    fn apply(self, held: &mut T, shift: Shift) {
        match self {
            Self::Kept => {}
            Self::Moved => {
                if let Some(moved) = held.moved(shift) {
                    *held = moved;
                }
            }
            Self::New(part) => *held = part,
        }
    }
}

/// A core's end of the way to one asker.
#[derive(Debug, Default)]
pub struct CoreEnd {
    /// The text of the last request about the open one, by its revision.
    told: Option<(u64, Arc<str>)>,
    sent: Option<Arc<Snapshot>>,
    /// How the text that was told came from the one of the snapshot that was sent, if that is known.
    shift: Option<Shift>,
}

impl CoreEnd {
    /// A request from bytes, which come in order; nothing if its text cannot be told from them, because the text that
    /// was edited is not here.
    pub fn read(&mut self, bytes: &[u8]) -> Result<Option<Request>, Error> {
        let (sent, mut request): (Option<SentText<'_>>, Request) = postcard::from_bytes(bytes)?;
        let revision = request.revision();
        let (Some(source), Some(sent)) = (request.source_mut(), sent) else { return Ok(Some(request)) };
        match sent {
            SentText::Edited(since, edits) => {
                let told = self.told.take().filter(|(revision, _)| *revision == since);
                let text = told.and_then(|(_, told)| edited(told, &edits)).filter(|text| source.is(text));
                let Some(text) = text else { return Ok(None) };
                self.shift = self.shift.map(|shift| edits.iter().fold(shift, Shift::then));
                source.hold(text, Some(Since { revision: since, edits: edits.into_owned() }));
            }
            SentText::Full(text) => {
                source.hold(text.into(), None);
                self.shift = self.shift.filter(|_| revision.is_none());
            }
        }
        if let Some(revision) = revision {
            self.told = Some((revision, Arc::clone(source.text())));
        }
        Ok(Some(request))
    }

    /// An answer as bytes; they must reach the asker in order.
    pub fn write(&mut self, response: Response) -> Result<Vec<u8>, Error> {
        let Response::Snapshot(snapshot) = response else {
            return postcard::to_stdvec(&Message::Other(response));
        };
        let nothing = Snapshot::empty(0, Arc::default());
        let sent = self.sent.as_deref().unwrap_or(&nothing);
        let is_told = self.told.as_ref().is_some_and(|(_, text)| Arc::ptr_eq(text, &snapshot.source));
        let known = self.shift.filter(|_| is_told);
        let shift = known.unwrap_or_else(|| Shift::between(&sent.source, &snapshot.source));
        let change = SnapshotChange::of(sent, &snapshot, shift);
        self.shift = is_told.then_some(Shift::default());
        self.sent = Some(snapshot);
        postcard::to_stdvec(&Message::Snapshot(Box::new(change)))
    }
}

/// A text after edits; nothing if they are not of this text.
fn edited(text: Arc<str>, edits: &[Edit]) -> Option<Arc<str>> {
    if edits.is_empty() {
        return Some(text);
    }
    let mut edited = String::from(&*text);
    for edit in edits {
        edited.get(edit.span.range())?;
        edited.replace_range(edit.span.range(), &edit.text);
    }
    Some(edited.into())
}

/// An asker's end of the way to one core.
#[derive(Debug, Default)]
pub struct AskerEnd {
    /// Which of several cores is asked.
    core: u32,
    held: Option<Snapshot>,
}

impl AskerEnd {
    /// The end of the way to a core that was started as the `core`th: keys of an earlier one mean nothing to it.
    pub const fn of_core(core: u32) -> Self {
        Self { core, held: None }
    }

    /// An answer from bytes, to a request about a text.
    pub fn read(&mut self, bytes: &[u8], text: Arc<str>) -> Result<Response, Error> {
        let change = match postcard::from_bytes(bytes)? {
            Message::Other(response) => return Ok(self.with_own_keys(response)),
            Message::Snapshot(change) => change,
        };
        let held = self.held.take().unwrap_or_else(|| Snapshot::empty(0, Arc::default()));
        let snapshot = Snapshot { source: text, ..change.apply(held, self.core) };
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
    fn of(before: &Snapshot, after: &Snapshot, shift: Shift) -> Self {
        let (old, new) = (&before.keys, &after.keys);
        let keyed = |old: ContentKey, new: ContentKey| old == new && new != ContentKey::default();
        Self {
            revision: after.revision,
            stage: after.stage,
            timings: after.timings,
            map: after.map.clone(),
            keys: *new,
            problems: Change::of(&before.problems, &after.problems, shift, false),
            program: Change::of(&before.program, &after.program, shift, keyed(old.program, new.program)),
            network: Change::of(&before.network, &after.network, shift, keyed(old.network, new.network)),
            planning: Change::of(&before.planning, &after.planning, shift, keyed(old.planning, new.planning)),
            traverses: Change::of(&before.traverses, &after.traverses, shift, false),
            motions: Change::of(&before.motions, &after.motions, shift, false),
            separation_violations: Change::of(
                &before.separation_violations,
                &after.separation_violations,
                shift,
                false,
            ),
            shift,
        }
    }

    fn apply(self, mut held: Snapshot, core: u32) -> Snapshot {
        let shift = self.shift;
        self.problems.apply(&mut held.problems, shift);
        self.program.apply(&mut held.program, shift);
        self.network.apply(&mut held.network, shift);
        self.planning.apply(&mut held.planning, shift);
        self.traverses.apply(&mut held.traverses, shift);
        self.motions.apply(&mut held.motions, shift);
        self.separation_violations.apply(&mut held.separation_violations, shift);
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
