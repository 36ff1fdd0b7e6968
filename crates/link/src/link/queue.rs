//! The jobs that wait, the one under way, and what a fresh core has to be told again.

use std::collections::VecDeque;

use crate::Request;
use crate::{Job, JobId, Kind};

/// The jobs of a link, in order: one is under way at a time.
#[derive(Debug, Default)]
pub(super) struct Queue {
    last_id: u64,
    waiting: VecDeque<Waiting>,
    under_way: Option<UnderWay>,
    /// The maps that the running core knows.
    imported: Vec<Job>,
}

#[derive(Debug)]
struct Waiting {
    job: Job,
    /// How many cores stopped over it.
    failures: u32,
}

#[derive(Debug)]
struct UnderWay {
    job: Job,
    failures: u32,
    is_canceled: bool,
    /// Whether the core gave it up for want of its text.
    lacks_text: bool,
}

impl Queue {
    /// Adds a request; those that it makes pointless are dropped.
    pub(super) fn post(&mut self, request: Request) -> JobId {
        let key = request.key();
        let is_wanted = |it: &&UnderWay| it.job.key == key && !it.is_canceled;
        if let Some(known) = self.under_way.as_ref().filter(is_wanted)
            && !self.waiting.iter().any(|newer| newer.job.request.supersedes(&known.job.request))
        {
            self.waiting.retain(|earlier| !request.supersedes(&earlier.job.request));
            return known.job.id;
        }
        self.last_id += 1;
        let id = JobId(self.last_id);
        self.waiting.retain(|earlier| earlier.job.key != key && !request.supersedes(&earlier.job.request));
        self.waiting.push_back(Waiting { job: Job { id, key, request }, failures: 0 });
        id
    }

    /// The job to hand over now, if the core is free; it counts as under way from here on.
    pub(super) fn start_next(&mut self) -> Option<&mut Job> {
        if self.under_way.is_some() {
            return None;
        }
        let Waiting { job, failures } = self.waiting.pop_front()?;
        let under_way = UnderWay { job, failures, is_canceled: false, lacks_text: false };
        Some(&mut self.under_way.insert(under_way).job)
    }

    /// The job under way.
    pub(super) fn under_way(&self) -> Option<&Job> {
        self.under_way.as_ref().map(|it| &it.job)
    }

    /// Returns whether a job waits.
    pub(super) fn has_waiting(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// The jobs of a kind.
    pub(super) fn of_kind(&self, kind: Kind) -> Vec<JobId> {
        let jobs = self.waiting.iter().map(|it| &it.job).chain(self.under_way());
        jobs.filter(|job| job.request.kind() == kind).map(|job| job.id).collect()
    }

    /// The core cannot do the job under way without all of its text.
    pub(super) fn text_lost(&mut self) {
        self.under_way.iter_mut().for_each(|it| it.lacks_text = true);
    }

    /// The job under way was answered in full, or given up; it comes next again if it was for want of its text.
    pub(super) fn finished(&mut self) {
        let is_in_vain = self.is_in_vain();
        let Some(UnderWay { job, failures, is_canceled: false, lacks_text }) = self.under_way.take() else {
            return;
        };
        if lacks_text && !is_in_vain {
            self.waiting.push_front(Waiting { job, failures });
        } else if job.request.kind() == Kind::ImportMap {
            self.imported.retain(|earlier| !job.request.supersedes(&earlier.request));
            self.imported.push(job);
        }
    }

    /// Takes a job back.
    pub(super) fn cancel(&mut self, id: JobId) {
        self.waiting.retain(|it| it.job.id != id);
        if let Some(under_way) = self.under_way.as_mut().filter(|it| it.job.id == id) {
            under_way.is_canceled = true;
        }
    }

    /// Returns whether no one wants the job under way any more.
    pub(super) fn is_in_vain(&self) -> bool {
        self.under_way.as_ref().is_some_and(|it| {
            it.is_canceled || self.waiting.iter().any(|newer| newer.job.request.supersedes(&it.job.request))
        })
    }

    /// The core was ended over a job that was not wanted any more; what it knew will be told again first.
    pub(super) fn core_ended(&mut self) {
        self.under_way = None;
        self.tell_again();
    }

    /// The core stopped by itself. The job under way is tried again first, unless it is in vain or `most` cores have
    /// stopped over it: then it is returned.
    pub(super) fn core_failed(&mut self, most: u32) -> Option<Job> {
        let is_in_vain = self.is_in_vain();
        let mut given_up = None;
        if let Some(UnderWay { job, failures, .. }) = self.under_way.take() {
            let failures = failures + 1;
            if failures >= most {
                given_up = Some(job);
            } else if !is_in_vain {
                self.waiting.push_front(Waiting { job, failures });
            }
        }
        self.tell_again();
        given_up
    }

    fn tell_again(&mut self) {
        for known in self.imported.drain(..).rev() {
            if !self.waiting.iter().any(|newer| newer.job.request.supersedes(&known.request)) {
                self.waiting.push_front(Waiting { job: known, failures: 0 });
            }
        }
    }
}
