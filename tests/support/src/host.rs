//! A host that plans at once, in memory, with a clock that the test moves; for tests with and without a window.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;

use link::{Request, Response};
use mission::{Core, CoreHost};
use workbench::area::Area;
use workbench::host::{FileKind, Host, HostEvent, Save, ShelfContent, ShelfNews, ShelfRequest, StorageError};

/// How the shelf of a world does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shelf {
    /// It answers at once.
    #[default]
    Works,
    /// It answers only when the test says so: [`World::let_shelf_answer`].
    Slow,
    /// It has no room.
    Full,
    /// It may not be used.
    Forbidden,
}

/// News for one host.
type Inbox = Rc<RefCell<VecDeque<HostEvent>>>;

/// What a test and its host share.
#[derive(Default)]
pub struct World {
    /// The parts of the window that were recorded, one after the other.
    pub filmed: RefCell<Vec<Area>>,
    /// Whether the host has no recorder.
    pub cannot_film: Cell<bool>,
    /// Seconds on the host's clock.
    pub now_secs: Cell<f64>,
    /// What is kept between runs.
    pub storage: RefCell<BTreeMap<String, String>>,
    /// Whether there is no room to keep more.
    pub is_full: Cell<bool>,
    /// What lies on the shelf.
    pub shelf: RefCell<BTreeMap<String, Vec<u8>>>,
    /// How the shelf does.
    pub shelf_does: Cell<Shelf>,
    /// What a slow shelf has not done yet.
    pub shelf_waits: RefCell<Vec<(Inbox, Option<ShelfRequest>)>>,
    /// The tabs that are open.
    pub tabs: RefCell<Vec<Inbox>>,
    /// How many random numbers were drawn.
    pub drawn: Cell<u64>,
    /// Files that were saved.
    pub saved: RefCell<Vec<(String, Vec<u8>)>>,
    /// Whether missions are saved to files that were chosen once.
    pub saves_in_place: Cell<bool>,
    /// Missions that were to be saved to their files.
    pub saved_in_place: RefCell<Vec<Save>>,
    /// Missions and the files that they are saved to from then on.
    pub kept_files: RefCell<Vec<(String, u32)>>,
    /// Width and height of the last picture that was saved, in pixels.
    pub picture_size: Cell<[u32; 2]>,
    /// What files the app asked for.
    pub asked: RefCell<Vec<FileKind>>,
    /// What stands after `#`.
    pub fragment: RefCell<String>,
    /// Whether requests are left without an answer.
    pub is_deaf: Cell<bool>,
    /// Whether requests wait until this is over.
    pub is_slow: Cell<bool>,
    /// Events that the host tells next.
    pub news: RefCell<VecDeque<HostEvent>>,
    /// Whether nothing is to move by itself.
    pub reduces_motion: Cell<bool>,
    /// Whether this is a page in Firefox.
    pub is_firefox: Cell<bool>,
    /// What is on the clipboard, if the page may read it.
    pub clipboard: RefCell<Option<String>>,
    /// How many requests were posted.
    pub posted: Cell<usize>,
    /// How often everything was taken back.
    pub stopped: Cell<usize>,
}

/// A host that plans on the spot.
pub struct TestHost {
    core: Core,
    waiting: VecDeque<Request>,
    world: Rc<World>,
    inbox: Inbox,
}

impl World {
    /// The user chose this file, or dropped it.
    pub fn open_file(&self, kind: FileKind, name: &str, bytes: &[u8]) {
        let bytes = bytes.to_vec();
        self.news.borrow_mut().push_back(HostEvent::FileOpened {
            kind,
            name: name.into(),
            bytes,
            token: None,
        });
    }

    /// Returns what was saved last, which is a text.
    pub fn saved_text(&self) -> String {
        let saved = self.saved.borrow();
        String::from_utf8(saved.last().expect("something was saved").1.clone()).expect("a text")
    }

    /// A slow shelf does everything that it was asked for.
    pub fn let_shelf_answer(&self) {
        self.shelf_does.set(Shelf::Works);
        for (inbox, request) in std::mem::take(&mut *self.shelf_waits.borrow_mut()) {
            let news = match request {
                Some(request) => self.use_shelf(request),
                None => Some(ShelfNews::Opened(Ok(self.shelf_content()))),
            };
            inbox.borrow_mut().extend(news.map(HostEvent::Shelf));
        }
    }

    fn shelf_content(&self) -> ShelfContent {
        let shelf = self.shelf.borrow();
        let content = shelf.iter().filter(|(key, _)| !key.starts_with("map/"));
        content.map(|(key, bytes)| (key.clone(), bytes.clone())).collect()
    }

    fn shelf_refusal(&self, bytes: usize) -> Option<StorageError> {
        match self.shelf_does.get() {
            Shelf::Works | Shelf::Slow if !self.is_full.get() => None,
            Shelf::Forbidden => Some(StorageError::Unavailable { reason: "not in this window".to_owned() }),
            _ => Some(StorageError::Full { bytes }),
        }
    }

    fn use_shelf(&self, request: ShelfRequest) -> Option<ShelfNews> {
        match request {
            ShelfRequest::Write { key, bytes, token } => {
                let outcome = self.shelf_refusal(bytes.len()).map_or(Ok(()), Err);
                if outcome.is_ok() {
                    self.shelf.borrow_mut().insert(key.clone(), bytes);
                }
                Some(ShelfNews::Written { key, token, outcome })
            }
            ShelfRequest::Read { key } => {
                let outcome = Ok(self.shelf.borrow().get(&key).cloned());
                Some(ShelfNews::Read { key, outcome })
            }
            ShelfRequest::Remove { key } => {
                self.shelf.borrow_mut().remove(&key);
                None
            }
        }
    }
}

impl TestHost {
    /// A host in a world. Most tests are about the mission Enroute: if the world is new and its address is empty, the
    /// address names this mission.
    pub fn new(world: &Rc<World>) -> Self {
        let has_missions = world.storage.borrow().keys().any(|key| !key.starts_with("enroute/settings"));
        let is_new = world.drawn.get() == 0 && !has_missions && world.shelf.borrow().is_empty();
        let mut fragment = world.fragment.borrow_mut();
        if is_new && fragment.is_empty() {
            "mission=enroute".clone_into(&mut fragment);
        }
        drop(fragment);
        let inbox = Inbox::default();
        world.tabs.borrow_mut().push(Rc::clone(&inbox));
        Self { core: Core::default(), waiting: VecDeque::new(), world: Rc::clone(world), inbox }
    }
}

impl Drop for TestHost {
    fn drop(&mut self) {
        self.world.tabs.borrow_mut().retain(|tab| !Rc::ptr_eq(tab, &self.inbox));
    }
}

impl Host for TestHost {
    fn post(&mut self, request: Request) {
        self.world.posted.set(self.world.posted.get() + 1);
        if !self.world.is_deaf.get() {
            self.waiting.push_back(request);
        }
    }

    fn stop(&mut self) {
        self.world.stopped.set(self.world.stopped.get() + 1);
    }

    fn poll(&mut self) -> Option<HostEvent> {
        while !self.world.is_slow.get()
            && let Some(request) = self.waiting.pop_front()
        {
            self.core.handle(request, &mut Answers { inbox: Rc::clone(&self.inbox) });
        }
        self.inbox.borrow_mut().pop_front().or_else(|| self.world.news.borrow_mut().pop_front())
    }

    fn monotonic_secs(&self) -> f64 {
        self.world.now_secs.get()
    }

    fn unix_millis(&self) -> i64 {
        // 2026-01-02T03:04:05Z, and on from there as the other clock goes.
        1_767_323_045_000 + (self.world.now_secs.get() * 1000.0) as i64
    }

    fn stored(&self, key: &str) -> Option<String> {
        self.world.storage.borrow().get(key).cloned()
    }

    fn store(&mut self, key: &str, value: &str) -> Result<(), StorageError> {
        if self.world.is_full.get() {
            return Err(StorageError::Full { bytes: value.len() });
        }
        self.world.storage.borrow_mut().insert(key.to_owned(), value.to_owned());
        Ok(())
    }

    fn forget(&mut self, key: &str) {
        self.world.storage.borrow_mut().remove(key);
    }

    fn stored_keys(&self) -> Vec<String> {
        self.world.storage.borrow().keys().cloned().collect()
    }

    fn open_shelf(&mut self) -> Option<Result<ShelfContent, StorageError>> {
        match self.world.shelf_does.get() {
            Shelf::Works | Shelf::Full => Some(Ok(self.world.shelf_content())),
            Shelf::Slow => {
                self.world.shelf_waits.borrow_mut().push((Rc::clone(&self.inbox), None));
                None
            }
            Shelf::Forbidden => Some(self.world.shelf_refusal(0).map_or(Ok(Vec::new()), Err)),
        }
    }

    fn use_shelf(&mut self, request: ShelfRequest) {
        if self.world.shelf_does.get() == Shelf::Slow {
            self.world.shelf_waits.borrow_mut().push((Rc::clone(&self.inbox), Some(request)));
        } else {
            let news = self.world.use_shelf(request);
            self.inbox.borrow_mut().extend(news.map(HostEvent::Shelf));
        }
    }

    fn tell_tabs(&mut self, message: &str) {
        for tab in self.world.tabs.borrow().iter().filter(|tab| !Rc::ptr_eq(tab, &self.inbox)) {
            tab.borrow_mut().push_back(HostEvent::TabSaid(message.to_owned()));
        }
    }

    fn random(&mut self) -> u64 {
        self.world.drawn.set(self.world.drawn.get() + 1);
        self.world.drawn.get().wrapping_mul(0x9e37_79b9_7f4a_7c15)
    }

    fn secret_bytes(&mut self) -> Option<[u8; 32]> {
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&self.random().to_le_bytes());
        Some(bytes)
    }

    fn reduces_motion(&self) -> bool {
        self.world.reduces_motion.get()
    }

    fn is_firefox(&self) -> bool {
        self.world.is_firefox.get()
    }

    fn read_clipboard(&mut self) -> bool {
        let text = self.world.clipboard.borrow().clone();
        let refused = || HostEvent::ClipboardRefused { reason: "press Ctrl+V".to_owned() };
        self.inbox.borrow_mut().push_back(text.map_or_else(refused, HostEvent::ClipboardRead));
        true
    }

    fn open_file(&mut self, kind: FileKind) {
        self.world.asked.borrow_mut().push(kind);
    }

    fn saves_in_place(&self) -> bool {
        self.world.saves_in_place.get()
    }

    fn save_in_place(&mut self, save: Save) {
        self.world.saved_in_place.borrow_mut().push(save);
    }

    fn keep_file(&mut self, mission: &str, token: u32) {
        self.world.kept_files.borrow_mut().push((mission.to_owned(), token));
    }

    fn save_file(&mut self, suggested_name: &str, bytes: Vec<u8>) {
        self.world.saved.borrow_mut().push((suggested_name.to_owned(), bytes));
    }

    fn save_picture(&mut self, suggested_name: &str, svg: String, size: [u32; 2]) {
        self.world.saved.borrow_mut().push((suggested_name.to_owned(), svg.into_bytes()));
        self.world.picture_size.set(size);
    }

    fn film(&mut self, area: Area) -> Result<(), String> {
        if self.world.cannot_film.get() {
            return Err("no recorder here".to_owned());
        }
        self.world.filmed.borrow_mut().push(area);
        Ok(())
    }

    fn save_film(&mut self, suggested_name: &str) {
        self.world.saved.borrow_mut().push((suggested_name.to_owned(), Vec::new()));
    }

    fn fragment(&self) -> String {
        self.world.fragment.borrow().clone()
    }

    fn set_fragment(&mut self, fragment: &str) {
        fragment.clone_into(&mut self.world.fragment.borrow_mut());
    }

    fn link(&self, fragment: &str) -> Option<String> {
        Some(format!("https://enroute.example/#{fragment}"))
    }
}

struct Answers {
    inbox: Inbox,
}

impl CoreHost for Answers {
    fn now_millis(&self) -> f64 {
        0.0
    }

    fn is_superseded(&mut self) -> bool {
        false
    }

    fn answer(&mut self, response: Response) {
        self.inbox.borrow_mut().push_back(HostEvent::Answer(response));
    }
}
