//! The link between front end and core on a fake transport: order, superseding, canceling, silence, crash and retry.

use rmpl::{Edit, Span};

use super::*;
use crate::JobId;
use crate::Update;

/// A core that does nothing: a test says what it says.
#[derive(Debug, Default)]
struct Fake {
    /// What it was told: `start 1`, `send …`, `interrupt`, `terminate`.
    told: Vec<String>,
    /// The revision that the text of each job was an edit of, and what was typed.
    edited: Vec<Option<(u64, String)>>,
    /// The jobs that cannot be sent.
    cannot_send: bool,
}

impl Transport for Fake {
    fn start(&mut self, core: u32) {
        self.told.push(format!("start {core}"));
    }

    fn send(&mut self, job: &Job) -> Result<(), String> {
        self.told.push(format!("send {}", shown(&job.request)));
        let since = job.request.source().and_then(|source| source.since.as_ref());
        let typed = |since: &Since| since.edits.iter().map(|edit| edit.text.as_str()).collect();
        self.edited.push(since.map(|since| (since.revision, typed(since))));
        if self.cannot_send { Err("too large".to_owned()) } else { Ok(()) }
    }

    fn interrupt(&mut self) {
        self.told.push("interrupt".to_owned());
    }

    fn terminate(&mut self) {
        self.told.push("terminate".to_owned());
    }

    fn patience_secs(&self) -> f64 {
        2.0
    }
}

fn shown(request: &Request) -> String {
    match request {
        Request::ImportMap { name, bytes } => format!("{} {name} {}", request.kind(), bytes.len()),
        _ => format!("{} {}", request.kind(), request.revision().unwrap_or_default()),
    }
}

fn text(revision: u64) -> Update {
    Update::new(revision, "")
}

fn review(revision: u64) -> Request {
    Request::Review { update: text(revision), rules: Vec::new() }
}

fn update(revision: u64) -> Request {
    Request::Update(text(revision))
}

fn map(name: &str, bytes: usize) -> Request {
    Request::ImportMap { name: name.into(), bytes: vec![0; bytes] }
}

/// A link to a core that has come up.
fn ready() -> Link<Fake> {
    let mut link = Link::start(Fake::default(), 0.0);
    link.hear(1, News::Ready);
    link.transport.told.clear();
    link
}

/// Returns what the core was told since.
fn told(link: &mut Link<Fake>) -> Vec<String> {
    std::mem::take(&mut link.transport.told)
}

fn answer(name: &str) -> Response {
    Response::MapRejected { name: name.into(), reason: String::new() }
}

/// The ids of the jobs that were answered, and the kinds of those that were given up.
fn events(link: &mut Link<Fake>) -> Vec<String> {
    std::iter::from_fn(|| link.next_event())
        .map(|event| match event {
            LinkEvent::Answer { job: JobId(id), .. } => format!("answer {id}"),
            LinkEvent::Failed { kind, revision, message, .. } => {
                let kind = kind.map_or_else(|| "nothing".to_owned(), |kind| kind.to_string());
                format!("{kind} {} failed: {message}", revision.unwrap_or_default())
            }
            LinkEvent::Restarted { message } => format!("restarted: {message}"),
        })
        .collect()
}

#[test]
fn one_job_is_under_way_at_a_time_and_answers_name_it() {
    let mut link = ready();
    let first = link.post(map("a", 1));
    let second = link.post(map("b", 1));
    assert_eq!(told(&mut link), ["send ImportMap a 1"]);
    link.hear(1, News::Answer(answer("a")));
    link.hear(1, News::Finished);
    link.hear(1, News::Answer(answer("b")));
    assert_eq!(told(&mut link), ["send ImportMap b 1"]);
    assert_eq!(events(&mut link), [format!("answer {}", first.0), format!("answer {}", second.0)]);
    assert!(link.is_busy());
    link.hear(1, News::Finished);
    assert!(!link.is_busy());
}

#[test]
fn only_the_newest_text_is_sent() {
    let mut link = ready();
    for revision in 1..=4 {
        link.post(update(revision));
    }
    assert_eq!(told(&mut link), ["send Update 1", "interrupt"], "it is asked once to give up");
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), ["send Update 4"]);
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), [""; 0]);
}

#[test]
fn a_newer_text_ends_what_was_asked_of_the_older_one_and_not_the_other_way_round() {
    let mut link = ready();
    link.post(update(1));
    link.post(review(1));
    link.post(Request::CompareSearches(text(1)));
    link.post(Request::Evaluate { token: 1, update: text(1) });
    assert_eq!(told(&mut link), ["send Update 1"]);
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), ["send Review 1"]);
    link.post(update(2));
    assert_eq!(told(&mut link), ["interrupt"]);
    link.hear(1, News::Finished);
    // The text to compare with represents itself, and has waited longer.
    assert_eq!(told(&mut link), ["send Evaluate 0"]);
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), ["send Update 2"]);
}

#[test]
fn a_map_gives_way_to_a_newer_one_of_its_name_and_comes_before_later_texts() {
    let mut link = ready();
    link.post(update(1));
    link.post(map("a", 1));
    link.post(map("b", 2));
    link.post(map("a", 3));
    link.post(update(2));
    link.hear(1, News::Finished);
    link.hear(1, News::Finished);
    link.hear(1, News::Finished);
    assert_eq!(
        told(&mut link),
        ["send Update 1", "interrupt", "send ImportMap b 2", "send ImportMap a 3", "send Update 2"]
    );
}

#[test]
fn what_waits_or_is_under_way_already_is_not_asked_twice() {
    let mut link = ready();
    let first = link.post(update(1));
    assert_eq!(link.post(update(1)), first);
    assert_eq!(told(&mut link), ["send Update 1"]);
    link.post(review(1));
    link.post(review(1));
    link.hear(1, News::Finished);
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), ["send Review 1"]);
}

#[test]
fn a_text_that_comes_back_is_asked_again_if_it_was_being_given_up() {
    let mut link = ready();
    link.post(update(1));
    link.post(update(2));
    link.post(update(1));
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), ["send Update 1", "interrupt", "send Update 1"]);
}

#[test]
fn a_job_that_is_taken_back_is_not_started_or_is_given_up() {
    let mut link = ready();
    let under_way = link.post(update(1));
    let waiting = link.post(review(1));
    link.cancel(waiting);
    assert_eq!(told(&mut link), ["send Update 1"]);
    link.cancel(under_way);
    assert_eq!(told(&mut link), ["interrupt"]);
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), [""; 0]);
    link.post(update(2));
    link.cancel_kind(Kind::Update);
    assert_eq!(told(&mut link), ["send Update 2", "interrupt"]);
}

#[test]
fn a_core_that_does_not_look_up_from_a_long_job_is_ended_and_the_next_job_goes_on() {
    let mut link = ready();
    link.post(map("m", 1));
    link.hear(1, News::Finished);
    link.post(update(1));
    link.post(update(2));
    told(&mut link);
    assert_eq!(link.due_secs(), Some(2.0));
    link.tick(1.9);
    assert_eq!(told(&mut link), [""; 0]);
    link.tick(2.0);
    // The fresh core is told the map before the text that may name it.
    assert_eq!(told(&mut link), ["terminate", "start 2", "send ImportMap m 1"]);
    link.hear(1, News::Answer(answer("late")));
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), [""; 0], "what the ended core still says is not heard");
    link.hear(2, News::Ready);
    link.hear(2, News::Finished);
    assert_eq!(told(&mut link), ["send Update 2"]);
    assert_eq!(events(&mut link), [""; 0], "nothing was lost that anybody wanted");
}

#[test]
fn a_core_that_gives_up_in_time_is_kept() {
    let mut link = ready();
    link.post(update(1));
    link.post(update(2));
    link.tick(1.0);
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), ["send Update 1", "interrupt", "send Update 2"]);
    link.tick(30.0);
    assert_eq!(told(&mut link), [""; 0]);
}

#[test]
fn a_job_is_tried_once_more_after_a_crash_and_then_given_up() {
    let mut link = ready();
    link.post(map("m", 1));
    link.hear(1, News::Finished);
    link.post(update(7));
    link.post(review(7));
    told(&mut link);
    link.hear(1, News::Failed("out of memory".to_owned()));
    assert_eq!(told(&mut link), ["terminate", "start 2", "send ImportMap m 1"]);
    assert_eq!(events(&mut link), ["restarted: out of memory"]);
    link.hear(2, News::Ready);
    link.hear(2, News::Finished);
    assert_eq!(told(&mut link), ["send Update 7"]);
    link.hear(2, News::Failed("out of memory".to_owned()));
    assert_eq!(events(&mut link), ["Update 7 failed: out of memory"]);
    assert_eq!(told(&mut link), ["terminate", "start 3", "send ImportMap m 1"]);
    link.hear(3, News::Ready);
    link.hear(3, News::Finished);
    assert_eq!(
        told(&mut link),
        ["send Review 7"],
        "what else is wanted goes on, without what stopped the core"
    );
}

#[test]
fn a_job_in_vain_is_not_tried_again() {
    let mut link = ready();
    link.post(update(1));
    link.post(update(2));
    link.hear(1, News::Failed("stumbled".to_owned()));
    link.hear(2, News::Ready);
    assert_eq!(told(&mut link), ["send Update 1", "interrupt", "terminate", "start 2", "send Update 2"]);
    assert_eq!(events(&mut link), [""; 0]);
}

#[test]
fn a_core_that_never_comes_up_is_tried_again_only_when_something_is_asked() {
    let mut link = Link::start(Fake::default(), 0.0);
    link.hear(1, News::Failed("it could not be loaded".to_owned()));
    assert_eq!(told(&mut link), ["start 1", "terminate"]);
    assert_eq!(events(&mut link), ["nothing 0 failed: it could not be loaded"]);
    link.post(update(1));
    assert_eq!(told(&mut link), ["start 2", "send Update 1"]);
    link.hear(2, News::Failed("it could not be loaded".to_owned()));
    assert_eq!(events(&mut link), ["Update 1 failed: it could not be loaded"]);
    assert_eq!(told(&mut link), ["terminate"]);
}

#[test]
fn a_core_that_dies_without_a_word_is_missed_after_a_while() {
    let mut link = ready();
    link.post(update(1));
    link.tick(SILENCE_SECS - 1.0);
    link.hear(1, News::Alive);
    link.tick(SILENCE_SECS + 1.0);
    assert_eq!(told(&mut link), ["send Update 1"], "it said that it lives");
    link.tick(2.0 * SILENCE_SECS);
    assert_eq!(told(&mut link), ["terminate", "start 2", "send Update 1"]);
    link.hear(2, News::Ready);
    link.hear(2, News::Finished);
    link.tick(10.0 * SILENCE_SECS);
    assert_eq!(told(&mut link), [""; 0], "a core without work need not say anything");
}

#[test]
fn what_cannot_be_sent_is_given_up() {
    let mut link = ready();
    link.transport.cannot_send = true;
    link.post(update(1));
    assert_eq!(events(&mut link), ["restarted: too large", "Update 1 failed: too large"]);
    assert!(!link.is_busy());
}

#[test]
fn everything_that_was_asked_can_be_taken_back_and_maps_are_read_all_the_same() {
    let mut link = ready();
    link.post(update(1));
    link.post(review(1));
    link.post(map("a", 1));
    assert_eq!(told(&mut link), ["send Update 1"]);
    link.cancel_all();
    assert_eq!(told(&mut link), ["interrupt"]);
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), ["send ImportMap a 1"]);
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), [""; 0]);
    assert!(!link.is_busy());
    link.post(update(1));
    assert_eq!(told(&mut link), ["send Update 1"], "it can be asked again");
}

/// The text of a revision, which came from the one before by typing a letter.
fn typed(revision: u64, letter: &str) -> Request {
    let edits = vec![Edit { span: Span::default(), text: letter.to_owned() }];
    let source = Source::edited(letter, Some(Since { revision: revision - 1, edits }));
    Request::Update(Update { source, ..text(revision) })
}

/// The revision that the text of the last job was an edit of, and what was typed since.
fn edited(link: &Link<Fake>) -> Option<(u64, &str)> {
    let (revision, typed) = link.transport.edited.last()?.as_ref()?;
    Some((*revision, typed))
}

#[test]
fn the_edits_of_jobs_that_were_dropped_go_with_the_next_one() {
    let mut link = ready();
    link.post(update(1));
    assert_eq!(edited(&link), None, "a core that knows nothing needs the whole text");
    for (revision, letter) in [(2, "a"), (3, "b"), (4, "c")] {
        link.post(typed(revision, letter));
    }
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), ["send Update 1", "interrupt", "send Update 4"]);
    assert_eq!(edited(&link), Some((1, "abc")));
    // Of a job that is taken back, too.
    let taken_back = link.post(typed(5, "d"));
    link.cancel(taken_back);
    link.post(typed(6, "e"));
    link.hear(1, News::Finished);
    assert_eq!(edited(&link), Some((4, "de")));
    // What else is asked of the same text needs no edits.
    link.post(review(6));
    link.hear(1, News::Finished);
    assert_eq!(edited(&link), Some((6, "")));
}

#[test]
fn what_is_asked_of_an_earlier_text_brings_it_along_and_the_next_edits_go_on_from_it() {
    let mut link = ready();
    for request in [update(1), typed(2, "a"), review(1), typed(3, "b")] {
        link.post(request);
        link.hear(1, News::Finished);
    }
    let since = &link.transport.edited;
    let typed = |revision, letters: &str| Some((revision, letters.to_owned()));
    assert_eq!(*since, [None, typed(1, "a"), None, typed(1, "ab")]);
}

#[test]
fn a_text_to_compare_with_is_told_whole_and_the_open_one_stays_known() {
    let mut link = ready();
    for request in [update(1), Request::Evaluate { token: 1, update: text(9) }, typed(2, "a")] {
        link.post(request);
        link.hear(1, News::Finished);
    }
    assert_eq!(link.transport.edited, [None, None, Some((1, "a".to_owned()))]);
}

#[test]
fn a_fresh_core_is_told_the_whole_text_and_another_text_is_told_whole() {
    let mut link = ready();
    link.post(update(1));
    link.hear(1, News::Finished);
    link.post(typed(2, "a"));
    assert_eq!(edited(&link), Some((1, "a")));
    link.hear(1, News::Failed("out of memory".to_owned()));
    assert_eq!(edited(&link), None);
    link.hear(2, News::Finished);
    link.post(typed(3, "b"));
    link.hear(2, News::Finished);
    assert_eq!(edited(&link), Some((2, "b")));
    link.post(update(4));
    assert_eq!(edited(&link), None, "nothing is known of how it came from the one before");
}

#[test]
fn a_core_that_has_lost_the_text_is_told_all_of_it() {
    let mut link = ready();
    link.post(update(1));
    link.hear(1, News::Finished);
    let lost = link.post(typed(2, "a"));
    link.hear(1, News::TextLost);
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), ["send Update 1", "send Update 2", "send Update 2"]);
    assert_eq!(edited(&link), None);
    link.hear(1, News::Answer(answer("it")));
    link.hear(1, News::Finished);
    assert_eq!(events(&mut link), [format!("answer {}", lost.0)]);
    assert_eq!(told(&mut link), [""; 0]);
    // A newer text takes its place.
    link.post(typed(3, "b"));
    link.post(typed(4, "c"));
    link.hear(1, News::TextLost);
    link.hear(1, News::Finished);
    assert_eq!(told(&mut link), ["send Update 3", "interrupt", "send Update 4"]);
    assert_eq!(edited(&link), None);
}
