//! An edit on its way from the caret to the core: whatever is typed, dropped, lost or started again, the core has the text
//! of the document, and what it says of it is what a core says that reads the whole text.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use link::wire::{self, AskerEnd, CoreEnd};
use link::{Job, JobId, Link, LinkEvent, News, Request, Response, Since, Source, Transport, Update};
use mission::Core;
use proptest::prelude::*;
use snapshot::Snapshot;
use test_core::Answers;
use text_editing::{Caret, Document, Motion, TextCommand};
use workbench::state::language::Language;

const MISSIONS: [&str; 3] = [
    "// A début.\nprimitive Drive(to)[1,9];\nA()[0,9] = { Drive(X); delay[1,2] }\nscenario S[0,20] = { A() }\n",
    "state ARM : {IN, OUT} = IN;\nprimitive Out()[1,2] sets ARM=OUT;\n// ∞\nscenario S[0,∞] = { Out(); Out() }\n",
    "Main ():: (WHEN-DONEXT (Lamp = On) (Lamp = Off))\n",
];

const PIECES: [&str; 12] =
    ["é", "∞", "x", ";", "{", "}", "1", "// ", "\n", "A()", "delay[2,3]; ", "primitive B()[1,2];\n"];

/// A core at the other end of a line of bytes, which works when the test says so.
#[derive(Default)]
struct Worker {
    core: Core,
    end: CoreEnd,
    inbox: VecDeque<Vec<u8>>,
}

#[derive(Default)]
struct Workers {
    running: Worker,
    /// How long each request was.
    bytes: Vec<usize>,
}

impl Transport for Workers {
    fn start(&mut self, _core: u32) {
        self.running = Worker::default();
    }

    fn send(&mut self, job: &Job) -> Result<(), String> {
        let bytes = wire::write_request(&job.request).map_err(|error| error.to_string())?;
        self.bytes.push(bytes.len());
        self.running.inbox.push_back(bytes);
        Ok(())
    }

    fn interrupt(&mut self) {}

    fn terminate(&mut self) {
        self.running = Worker::default();
    }

    fn patience_secs(&self) -> f64 {
        1.0
    }
}

/// A document that is edited, and the way from it to a core and back.
struct Desk {
    document: Document,
    language: Language,
    posted: u64,
    link: Link<Workers>,
    asker: AskerEnd,
    /// The texts that the core was asked about.
    texts: BTreeMap<u64, Arc<str>>,
    last_job: Option<JobId>,
    latest: Option<Arc<Snapshot>>,
    lost: usize,
}

/// Returns what a core says that reads the whole text.
fn fresh(text: &str) -> Snapshot {
    content(&test_core::snapshot(text))
}

fn content(snapshot: &Snapshot) -> Snapshot {
    let mut content = snapshot.clone();
    (content.timings, content.keys, content.revision) = Default::default();
    content
}

impl Desk {
    fn new(text: &str) -> Self {
        let document = Document::new(text);
        let mut desk = Self {
            language: Language::new(&document),
            document,
            posted: 0,
            link: Link::start(Workers::default(), 0.0),
            asker: AskerEnd::of_core(1),
            texts: BTreeMap::new(),
            last_job: None,
            latest: None,
            lost: 0,
        };
        desk.link.hear(1, News::Ready);
        desk
    }

    /// A key, which the language follows at once.
    fn key(&mut self, command: &TextCommand) {
        command.apply(&mut self.document);
        self.language.follow(&self.document);
    }

    /// Asks the core about the present text, as a session does.
    fn post(&mut self) {
        let revision = self.document.revision();
        let since = self
            .document
            .edits_since(self.posted)
            .map(|edits| Since { revision: self.posted, edits: edits.cloned().collect() });
        let source = Source::edited(self.document.shared_text(), since);
        self.texts.insert(revision, self.document.shared_text());
        self.posted = revision;
        self.last_job = Some(self.link.post(Request::Update(Update::new(revision, source))));
    }

    /// Asks for something else about a text that the core was asked about before.
    fn review(&mut self, which: usize) {
        let Some((&revision, text)) = self.texts.iter().rev().nth(which) else { return };
        let update = Update::new(revision, Arc::clone(text));
        self.link.post(Request::Review { update, rules: Vec::new() });
    }

    /// The core does the job that it was handed. Returns whether there was one.
    fn work(&mut self) -> bool {
        let core = self.link.core();
        let worker = &mut self.link.transport().running;
        let Some(bytes) = worker.inbox.pop_front() else { return false };
        match worker.end.read(&bytes).expect("a request is read") {
            None => {
                self.lost += 1;
                self.link.hear(core, News::TextLost);
            }
            Some(request) => {
                let source = request.source().expect("all jobs here are about a text");
                if let Some(revision) = request.revision() {
                    assert_eq!(source.text(), &self.texts[&revision], "what the core reads was asked");
                }
                let mut answers = Answers::default();
                worker.core.handle(request, &mut answers);
                let end = &mut worker.end;
                let bytes: Vec<Vec<u8>> =
                    answers.0.into_iter().map(|it| end.write(it).expect("an answer is written")).collect();
                for bytes in bytes {
                    let text = Arc::clone(self.link.text_under_way().expect("there is a job"));
                    let answer = self.asker.read(&bytes, text).expect("an answer is read");
                    self.link.hear(core, News::Answer(answer));
                }
            }
        }
        self.link.hear(core, News::Finished);
        while let Some(event) = self.link.next_event() {
            if let LinkEvent::Answer { response: Response::Snapshot(snapshot), .. } = event {
                self.latest = Some(snapshot);
            }
        }
        true
    }

    /// The core stops, and another one takes over.
    fn crash(&mut self) {
        self.link.hear(self.link.core(), News::Failed("it stopped".to_owned()));
        self.link.hear(self.link.core(), News::Ready);
        self.asker = AskerEnd::of_core(self.link.core());
        while self.link.next_event().is_some() {}
    }

    /// The core's end takes another text for the one that is edited, and no one is told.
    fn mislead(&mut self) {
        let other = Request::Update(Update::new(u64::MAX, "another text"));
        let bytes = wire::write_request(&other).expect("a request is written");
        self.link.transport().running.end.read(&bytes).expect("a request is read");
    }

    /// All work is done, and the present text is known.
    fn settle(&mut self) {
        self.post();
        while self.work() {}
        // A core that stopped twice over a text is not asked again.
        if self.latest.as_ref().is_none_or(|latest| latest.revision != self.document.revision()) {
            self.document.touch();
            self.post();
            while self.work() {}
        }
        let latest = self.latest.as_ref().expect("it was answered");
        assert_eq!(latest.revision, self.document.revision());
        assert_eq!(&*latest.source, self.document.text());
        let is_as_fresh = content(latest) == fresh(&self.document.shared_text());
        assert!(is_as_fresh, "what is said of {:?}", self.document.text());
        assert_eq!(self.language.parse().is_some(), Language::new(&self.document).parse().is_some());
        if let Some(parse) = self.language.parse() {
            let fresh = rmpl::parse(self.document.text());
            assert_eq!(parse.text(), self.document.text());
            assert_eq!((parse.program(), parse.diagnostics()), (fresh.program(), fresh.diagnostics()));
        }
    }
}

/// Does something by its number, at a place.
fn act(desk: &mut Desk, what: u8, at: usize, piece: usize) {
    let piece = PIECES[piece % PIECES.len()];
    let offset = at % (desk.document.text().len() + 1);
    match what {
        0..=5 => desk.key(&TextCommand::Insert(piece.to_owned())),
        6 => desk.key(&TextCommand::Paste(piece.repeat(1 + at % 3))),
        7 => desk.key(&TextCommand::Delete(if at.is_multiple_of(2) {
            Motion::Left
        } else {
            Motion::WordRight
        })),
        8 => desk.key(&TextCommand::ToggleCaret(offset)),
        9 => desk.key(&TextCommand::AddCaretBelow),
        10 => desk.key(&TextCommand::Select { anchor: offset, head: at / 2 % (offset + 1) }),
        11 => desk.key(&TextCommand::SelectNextOccurrence),
        12 | 13 => desk.key(&TextCommand::Undo),
        14 => desk.key(&TextCommand::Redo),
        15 => desk.key(&TextCommand::MoveLinesDown),
        16 => {
            let replaced = desk.document.text().replace('A', piece);
            desk.document.replace_all(&replaced);
            desk.language.follow(&desk.document);
        }
        17 => {
            desk.document.open(MISSIONS[at % MISSIONS.len()]);
            desk.document.set_caret(Caret::at(offset));
            desk.language.follow(&desk.document);
        }
        18 => {
            desk.document.touch();
            desk.post();
        }
        19..=23 => desk.post(),
        24 => desk.review(0),
        25 => desk.review(at % 4),
        26 => {
            let update = Update::new(desk.document.revision(), MISSIONS[at % 2]);
            desk.link.post(Request::Evaluate { token: 1, update });
        }
        27 => desk.last_job.into_iter().for_each(|job| desk.link.cancel(job)),
        28 => desk.link.cancel_all(),
        29 => desk.crash(),
        30 => desk.mislead(),
        _ => {
            desk.work();
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_core_has_the_text_of_the_document_whatever_happens_on_the_way(
        mission in 0..MISSIONS.len(),
        acts in proptest::collection::vec((0_u8..38, any::<u16>(), 0..PIECES.len()), 1..60),
    ) {
        let mut desk = Desk::new(MISSIONS[mission]);
        for (what, at, piece) in acts {
            act(&mut desk, what, at.into(), piece);
        }
        desk.settle();
    }
}

/// A text of so many bytes and more, of many declarations.
fn long_text(bytes: usize) -> String {
    let lines = (0..).map(|number| format!("primitive Drive{number}(to)[1,9]; // Étape {number}.\n"));
    let mut text = "scenario S[0,9] = { delay }\n".to_owned();
    lines
        .take_while(|line| {
            text.push_str(line);
            text.len() < bytes
        })
        .for_each(drop);
    text
}

#[test]
fn a_key_is_read_once_on_each_side_and_its_request_is_as_short_as_the_edit() {
    let mut desk = Desk::new(&long_text(1_000_000));
    desk.settle();
    assert!(desk.link.transport().bytes[0] > 1_000_000, "the first text travels whole");
    let carets = [desk.document.text().len() / 2, desk.document.text().len() - 1, 0];
    for (at, letter) in carets.into_iter().zip(["é", "\n", "/"]) {
        desk.key(&TextCommand::Select { anchor: at, head: at });
        let read = desk.language.parse().expect("a mission").declarations_read();
        desk.key(&TextCommand::Insert(letter.to_owned()));
        let read = desk.language.parse().expect("a mission").declarations_read() - read;
        assert!((1..=3).contains(&read), "{read} declarations were read");
        desk.post();
        assert!(desk.work() && !desk.work());
        let latest = desk.latest.as_ref().expect("it is answered");
        assert_eq!(&*latest.source, desk.document.text());
        let bytes = desk.link.transport().bytes.last().copied().unwrap_or_default();
        assert!(bytes < 100, "the request has {bytes} bytes");
    }
    assert_eq!(desk.lost, 0);
}

#[test]
fn a_core_that_lost_the_text_gets_it_whole_once() {
    let mut desk = Desk::new(&long_text(10_000));
    desk.settle();
    desk.mislead();
    for letter in ["a", "b"] {
        desk.key(&TextCommand::Insert(letter.to_owned()));
        desk.settle();
    }
    assert_eq!(desk.lost, 1);
    let bytes = &desk.link.transport().bytes;
    assert_eq!(bytes.iter().map(|bytes| *bytes > 10_000).collect::<Vec<_>>(), [true, false, true, false]);
}
