//! The way to a planning core, wherever it runs: what waits, what is under way, and what happens when a core is too
//! slow, dies, or says nothing any more.
//!
//! A [`Link`] owns no thread, worker or clock. A [`Transport`] carries jobs to a core and is told to start and to end
//! it; what the core says is handed to [`Link::hear`], and time goes by in [`Link::tick`].

mod queue;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::sync::Arc;

use rmpl::Journal;

use crate::{Job, JobId, Kind};
use crate::{Request, Response};
use crate::{Since, Source};
use queue::Queue;

/// Carries jobs to a core.
pub trait Transport {
    /// Starts a core that knows nothing. It is the `core`th, from 1; the previous core has ended.
    fn start(&mut self, core: u32);

    /// Hands a job to the core, which has none under way. The error says why it cannot.
    fn send(&mut self, job: &Job) -> Result<(), String>;

    /// Asks the core to give up the job under way.
    fn interrupt(&mut self);

    /// Ends the core at once, whatever it does.
    fn terminate(&mut self);

    /// After how many seconds an interrupted core has had time to look up from its work.
    fn patience_secs(&self) -> f64;
}

/// What a core says.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    Ready,
    /// It continues with the job under way.
    Alive,
    /// It does not have the text that the job under way edits: it gives the job up, and needs all of the text.
    TextLost,
    /// It answers the job under way.
    Answer(Response),
    /// It has answered the job under way in full, or given it up.
    Finished,
    /// It has stopped, for this reason.
    Failed(String),
}

/// What happened, for the front end.
#[derive(Clone, Debug, PartialEq)]
pub enum LinkEvent {
    /// A job was answered, in full or in part.
    Answer { job: JobId, response: Response },
    /// A job was given up because the core stopped over it, or could not be started.
    Failed {
        /// Which one, if it was over a job.
        job: Option<JobId>,
        kind: Option<Kind>,
        /// The revision of the text that it was about.
        revision: Option<u64>,
        /// What is known of the reason.
        message: String,
    },
    /// The core stopped, and what it was at is tried again by another one.
    Restarted {
        /// What is known of the reason.
        message: String,
    },
}

/// A core at work that says nothing for so long has died without a word.
pub const SILENCE_SECS: f64 = 60.0;

/// A job is tried on a fresh core again after a core stopped over it.
const MAX_FAILURES: u32 = 2;

/// The way to a core.
#[derive(Debug)]
pub struct Link<T> {
    transport: T,
    queue: Queue,
    /// The edits of the open text, those of jobs that were dropped included.
    journal: Journal,
    /// The revision of the text that the running core was handed last.
    handed: Option<u64>,
    state: CoreState,
    /// Counts the cores, so that what a dead one still said is not taken for the word of its successor.
    cores: u32,
    events: VecDeque<LinkEvent>,
    now_secs: f64,
    heard_secs: f64,
    /// When the core was asked to give up the job under way.
    interrupted_secs: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CoreState {
    /// There is none; the next job starts one.
    Absent,
    /// One was started, and has not said anything yet. Jobs are handed to it all the same.
    Starting,
    Ready,
}

impl<T: Transport> Link<T> {
    /// Starts a core.
    pub fn start(transport: T, now_secs: f64) -> Self {
        let mut link = Self {
            transport,
            queue: Queue::default(),
            journal: Journal::default(),
            handed: None,
            state: CoreState::Absent,
            cores: 0,
            events: VecDeque::new(),
            now_secs,
            heard_secs: now_secs,
            interrupted_secs: None,
        };
        link.start_core();
        link
    }

    /// Asks the core. A request that is waiting or under way already is not asked twice.
    pub fn post(&mut self, request: Request) -> JobId {
        if let Request::Update(update) = &request {
            self.note_text(update.revision, &update.source);
        }
        let id = self.queue.post(request);
        self.push_on();
        id
    }

    /// Takes a job back: it is not started any more, or given up.
    pub fn cancel(&mut self, job: JobId) {
        self.queue.cancel(job);
        self.push_on();
    }

    /// Takes back all jobs of a kind.
    pub fn cancel_kind(&mut self, kind: Kind) {
        for job in self.queue.of_kind(kind) {
            self.queue.cancel(job);
        }
        self.push_on();
    }

    /// Takes everything back but the maps, which later jobs need.
    pub fn cancel_all(&mut self) {
        for rule in crate::job::RULES.iter().filter(|rule| rule.kind != Kind::ImportMap) {
            for job in self.queue.of_kind(rule.kind) {
                self.queue.cancel(job);
            }
        }
        self.push_on();
    }

    /// Takes what the `core`th core said.
    pub fn hear(&mut self, core: u32, news: News) {
        if core != self.cores || self.state == CoreState::Absent {
            return;
        }
        self.heard_secs = self.now_secs;
        match news {
            News::Ready => self.state = CoreState::Ready,
            News::Alive => {}
            News::TextLost => {
                self.handed = None;
                self.queue.text_lost();
            }
            News::Answer(response) => {
                if let Some(job) = self.queue.under_way() {
                    self.events.push_back(LinkEvent::Answer { job: job.id, response });
                }
            }
            News::Finished => {
                self.interrupted_secs = None;
                self.queue.finished();
                self.push_on();
            }
            News::Failed(message) => self.fail(message),
        }
    }

    /// Lets time go by up to `now_secs`, in seconds on the host's clock. To be called at least as often as
    /// [`Link::due_secs`] says.
    pub fn tick(&mut self, now_secs: f64) {
        self.now_secs = now_secs;
        if let Some(since) = self.interrupted_secs
            && now_secs - since >= self.transport.patience_secs()
        {
            // It was not wanted any more, so that no one is told.
            self.end_core();
            self.queue.core_ended();
            self.push_on();
        }
        let is_silent = self.state == CoreState::Ready
            && self.queue.under_way().is_some()
            && now_secs - self.heard_secs >= SILENCE_SECS;
        if is_silent {
            self.fail(format!("no response for {SILENCE_SECS} seconds"));
        }
    }

    /// When [`Link::tick`] has something to do, if the core says nothing until then.
    pub fn due_secs(&self) -> Option<f64> {
        let overdue = self.interrupted_secs.map(|since| since + self.transport.patience_secs());
        let is_watched = self.state == CoreState::Ready && self.queue.under_way().is_some();
        let silent = is_watched.then_some(self.heard_secs + SILENCE_SECS);
        overdue.into_iter().chain(silent).reduce(f64::min)
    }

    /// Takes the oldest event.
    pub fn next_event(&mut self) -> Option<LinkEvent> {
        self.events.pop_front()
    }

    /// Returns whether the core has something to do.
    pub fn is_busy(&self) -> bool {
        self.queue.under_way().is_some()
    }

    /// The text that the job under way is about.
    pub fn text_under_way(&self) -> Option<&Arc<str>> {
        Some(self.queue.under_way()?.request.source()?.text())
    }

    /// Returns which core is spoken to, from 1.
    pub const fn core(&self) -> u32 {
        self.cores
    }

    /// Returns what carries the jobs.
    pub const fn transport(&mut self) -> &mut T {
        &mut self.transport
    }

    /// Notes how the open text came to what it is now.
    fn note_text(&mut self, revision: u64, source: &Source) {
        match &source.since {
            Some(Since { revision: before, edits }) if *before == self.journal.revision() => {
                self.journal.record(revision, edits.iter().cloned());
            }
            _ => {
                self.journal = Journal::starting_at(revision);
                self.handed = None;
            }
        }
    }

    fn start_core(&mut self) {
        self.cores += 1;
        self.handed = None;
        self.state = CoreState::Starting;
        self.heard_secs = self.now_secs;
        self.transport.start(self.cores);
    }

    fn end_core(&mut self) {
        self.transport.terminate();
        self.state = CoreState::Absent;
        self.interrupted_secs = None;
    }

    /// Hands the next job over, or asks the core to give up one that is not wanted any more.
    fn push_on(&mut self) {
        if self.state == CoreState::Absent {
            if !self.queue.has_waiting() {
                return;
            }
            self.start_core();
        }
        if let Some(job) = self.queue.start_next() {
            self.heard_secs = self.now_secs;
            if let (Some(revision), Some(source)) = (job.request.revision(), job.request.source_mut()) {
                // The core knows the text that it was handed last, whatever became of the jobs between.
                let since = |before| {
                    let edits = self.journal.between(before, revision)?.cloned().collect();
                    Some(Since { revision: before, edits })
                };
                source.since = self.handed.and_then(since);
                self.handed = Some(revision);
            }
            if let Err(message) = self.transport.send(job) {
                self.fail(message);
            }
        } else if self.queue.is_in_vain() && self.interrupted_secs.is_none() {
            self.interrupted_secs = Some(self.now_secs);
            self.transport.interrupt();
        }
    }

    /// The core is not to be trusted any more. A new one takes over, unless this one never came up: then the next
    /// request tries again.
    fn fail(&mut self, message: String) {
        let was_ready = self.state == CoreState::Ready;
        self.end_core();
        let most = if was_ready { MAX_FAILURES } else { 1 };
        let was_at_work = self.queue.under_way().is_some() && !self.queue.is_in_vain();
        let given_up = self.queue.core_failed(most);
        if was_ready && was_at_work && given_up.is_none() {
            self.events.push_back(LinkEvent::Restarted { message });
        } else if given_up.is_some() || !was_ready {
            let job = given_up.as_ref();
            self.events.push_back(LinkEvent::Failed {
                job: job.map(|job| job.id),
                kind: job.map(|job| job.request.kind()),
                revision: job.and_then(|job| job.request.revision()),
                message,
            });
        }
        if was_ready {
            self.push_on();
        }
    }
}
