//! A host that plans at once, in memory, with a clock that the test moves; for tests with and without a window.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;

use mission::{Core, CoreHost, Request, Response};
use workbench::host::{FileKind, Host, HostEvent, StorageError};

/// What a test and its host share.
#[derive(Default)]
pub struct World {
    /// Seconds on the host's clock.
    pub now_secs: Cell<f64>,
    /// What is kept between runs.
    pub storage: RefCell<BTreeMap<String, String>>,
    /// Whether there is no room to keep more.
    pub is_full: Cell<bool>,
    /// Files that were saved.
    pub saved: RefCell<Vec<(String, Vec<u8>)>>,
    /// Width and height of the last picture that was saved, in pixels.
    pub picture_size: Cell<[u32; 2]>,
    /// What files the app asked for.
    pub asked: RefCell<Vec<FileKind>>,
    /// What stands after `#`.
    pub fragment: RefCell<String>,
    /// Whether requests are answered.
    pub is_deaf: Cell<bool>,
    /// Events that the host tells next.
    pub news: RefCell<VecDeque<HostEvent>>,
    /// How many requests were posted.
    pub posted: Cell<usize>,
    /// How often everything was taken back.
    pub stopped: Cell<usize>,
}

/// A host that plans on the spot.
pub struct TestHost {
    core: Core,
    world: Rc<World>,
}

impl TestHost {
    /// A host in a world.
    pub fn new(world: &Rc<World>) -> Self {
        Self { core: Core::default(), world: Rc::clone(world) }
    }
}

impl Host for TestHost {
    fn post(&mut self, request: Request) {
        self.world.posted.set(self.world.posted.get() + 1);
        if self.world.is_deaf.get() {
            return;
        }
        let world = Rc::clone(&self.world);
        self.core.handle(request, &mut Answers { world });
    }

    fn stop(&mut self) {
        self.world.stopped.set(self.world.stopped.get() + 1);
    }

    fn poll(&mut self) -> Option<HostEvent> {
        self.world.news.borrow_mut().pop_front()
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

    fn open_file(&mut self, kind: FileKind) {
        self.world.asked.borrow_mut().push(kind);
    }

    fn save_file(&mut self, suggested_name: &str, bytes: Vec<u8>) {
        self.world.saved.borrow_mut().push((suggested_name.to_owned(), bytes));
    }

    fn save_picture(&mut self, suggested_name: &str, svg: String, size: [u32; 2]) {
        self.world.saved.borrow_mut().push((suggested_name.to_owned(), svg.into_bytes()));
        self.world.picture_size.set(size);
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
    world: Rc<World>,
}

impl CoreHost for Answers {
    fn now_millis(&self) -> f64 {
        0.0
    }

    fn is_superseded(&mut self) -> bool {
        false
    }

    fn answer(&mut self, response: Response) {
        self.world.news.borrow_mut().push_back(HostEvent::Answer(response));
    }
}
