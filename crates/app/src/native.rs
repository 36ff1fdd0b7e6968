//! The app's surroundings in a native window: the planning core on a thread, files on the disk.
//!
//! The page has its own in the `page` crate.

mod picture;
mod shelf;

use std::{
    fs, io,
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender, channel},
    },
    thread,
    time::{Duration, Instant, SystemTime},
};

use egui::Context;
use etcetera::BaseStrategy as _;
use link::{Job, Link, LinkEvent, Request, Response, Transport};
use mission::{Core, CoreHost};
use workbench::host::{FileKind, Host, HostEvent, ShelfContent, ShelfRequest, StorageError};

/// A window's surroundings.
pub struct NativeHost {
    link: Link<CoreThreads>,
    receiver: Receiver<News>,
    sender: Sender<News>,
    wake: Context,
    folder: Option<PathBuf>,
    begun: Instant,
}

/// What threads tell the window.
enum News {
    /// What a core says, by its number.
    Core(u32, link::News),
    Happened(HostEvent),
}

/// Starts threads with a core each, one at a time. A thread cannot be ended: one that is not wanted any more is told so,
/// and is not listened to.
struct CoreThreads {
    running: Option<CoreThread>,
    sender: Sender<News>,
    wake: Context,
}

struct CoreThread {
    requests: Sender<Request>,
    superseded: Arc<AtomicBool>,
}

/// A core that was interrupted has so long to look up from its work before another one takes over.
const PATIENCE_SECS: f64 = 10.0;

impl NativeHost {
    /// Starts the core; `wake` is asked for a frame whenever there is news.
    pub fn start(wake: Context) -> Self {
        let folder = etcetera::choose_base_strategy().ok().map(|places| places.data_dir().join("enroute"));
        Self::start_in(wake, folder)
    }

    /// The same, keeping nothing beyond the end of this run, for tests.
    pub fn without_storage(wake: Context) -> Self {
        Self::start_in(wake, None)
    }

    fn start_in(wake: Context, folder: Option<PathBuf>) -> Self {
        let (sender, receiver) = channel();
        let threads = CoreThreads { running: None, sender: sender.clone(), wake: wake.clone() };
        Self { link: Link::start(threads, 0.0), receiver, sender, wake, folder, begun: Instant::now() }
    }

    /// Asks for a frame when the link has something to do by itself.
    fn wake_when_due(&self) {
        if let Some(due_secs) = self.link.due_secs() {
            let wait_secs = (due_secs - self.monotonic_secs()).max(0.0);
            self.wake.request_repaint_after(Duration::from_secs_f64(wait_secs));
        }
    }

    fn file_of(&self, key: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(file_name(key)))
    }

    fn shelf_folder(&self) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join("shelf"))
    }

    /// Reads files that are dropped on the window.
    pub fn drop_reader(&self) -> impl Fn(egui::DroppedFileHandle) + 'static {
        let background = self.background();
        move |file| {
            background.run(move || {
                let name = name_of(file.path());
                Some(match file.bytes() {
                    Ok(bytes) => {
                        HostEvent::FileOpened { kind: FileKind::of_name(&name), name, bytes, token: None }
                    }
                    Err(reason) => HostEvent::FileFailed { name, reason },
                })
            });
        }
    }

    fn background(&self) -> Background {
        Background { sender: self.sender.clone(), wake: self.wake.clone() }
    }
}

/// What threads beside the core tell the window through.
struct Background {
    sender: Sender<News>,
    wake: Context,
}

impl Background {
    /// Runs a file dialog on a thread of its own, because some systems' dialogs block.
    fn run(&self, ask: impl FnOnce() -> Option<HostEvent> + Send + 'static) {
        let (sender, wake) = (self.sender.clone(), self.wake.clone());
        thread::spawn(move || {
            if let Some(event) = ask() {
                // No one listens any more when the window was closed meanwhile.
                let _ = sender.send(News::Happened(event));
                wake.request_repaint();
            }
        });
    }
}

impl Host for NativeHost {
    fn post(&mut self, request: Request) {
        self.link.tick(self.begun.elapsed().as_secs_f64());
        self.link.post(request);
        self.wake_when_due();
    }

    fn stop(&mut self) {
        self.link.tick(self.begun.elapsed().as_secs_f64());
        self.link.cancel_all();
        self.wake_when_due();
    }

    fn poll(&mut self) -> Option<HostEvent> {
        loop {
            self.link.tick(self.begun.elapsed().as_secs_f64());
            match self.link.next_event() {
                Some(LinkEvent::Answer { response, .. }) => return Some(HostEvent::Answer(response)),
                Some(LinkEvent::Failed { revision, message, .. }) => {
                    return Some(HostEvent::CoreFailed { revision, message });
                }
                Some(LinkEvent::Restarted { message }) => return Some(HostEvent::CoreRestarted { message }),
                None => {}
            }
            match self.receiver.try_recv() {
                Ok(News::Core(core, news)) => self.link.hear(core, news),
                Ok(News::Happened(event)) => return Some(event),
                Err(_) => break,
            }
        }
        self.wake_when_due();
        None
    }

    fn monotonic_secs(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    fn unix_millis(&self) -> i64 {
        let since_1970 = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        i64::try_from(since_1970.as_millis()).unwrap_or(i64::MAX)
    }

    fn stored(&self, key: &str) -> Option<String> {
        fs::read_to_string(self.file_of(key)?).ok()
    }

    fn store(&mut self, key: &str, value: &str) -> Result<(), StorageError> {
        let file = self.file_of(key).ok_or_else(no_folder)?;
        keep(&file, value.as_bytes())
    }

    fn forget(&mut self, key: &str) {
        if let Some(file) = self.file_of(key) {
            // A missing file needs no removal.
            let _ = fs::remove_file(file);
        }
    }

    fn stored_keys(&self) -> Vec<String> {
        self.folder.as_deref().map(shelf::keys_in).unwrap_or_default()
    }

    fn open_shelf(&mut self) -> Option<Result<ShelfContent, StorageError>> {
        Some(shelf::content(self.shelf_folder().as_deref()))
    }

    fn use_shelf(&mut self, request: ShelfRequest) {
        if let Some(news) = shelf::answer(self.shelf_folder().as_deref(), request) {
            // The window itself listens.
            let _ = self.sender.send(News::Happened(HostEvent::Shelf(news)));
            self.wake.request_repaint();
        }
    }

    /// Windows know nothing of each other.
    fn tell_tabs(&mut self, _message: &str) {}

    fn random(&mut self) -> u64 {
        let since_1970 = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let process = u64::from(std::process::id());
        (since_1970.as_nanos() as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ process.rotate_left(32)
    }

    fn secret_bytes(&mut self) -> Option<[u8; 32]> {
        let mut bytes = [0; 32];
        getrandom::fill(&mut bytes).ok()?;
        Some(bytes)
    }

    fn open_file(&mut self, kind: FileKind) {
        self.background().run(move || {
            let path = rfd::FileDialog::new()
                .add_filter(kind.title(), kind.extensions())
                .add_filter("All files", &["*"])
                .pick_file()?;
            let name = name_of(&path);
            Some(match fs::read(&path) {
                Ok(bytes) => HostEvent::FileOpened { kind, name, bytes, token: None },
                Err(reason) => HostEvent::FileFailed { name, reason: reason.to_string() },
            })
        });
    }

    fn save_file(&mut self, suggested_name: &str, bytes: Vec<u8>) {
        let suggested_name = suggested_name.to_owned();
        self.background().run(move || save_asking(suggested_name, &bytes));
    }

    fn save_picture(&mut self, suggested_name: &str, svg: String, size: [u32; 2]) {
        let name = suggested_name.to_owned();
        self.background().run(move || match picture::png(&svg, size) {
            Ok(bytes) => save_asking(name, &bytes),
            Err(reason) => Some(HostEvent::FileFailed { name, reason }),
        });
    }

    fn fragment(&self) -> String {
        String::new()
    }

    fn set_fragment(&mut self, _fragment: &str) {}

    fn link(&self, _fragment: &str) -> Option<String> {
        None
    }
}

/// Asks where to save a file and saves it; blocks meanwhile. Answers what went wrong, if anything did.
fn save_asking(suggested_name: String, bytes: &[u8]) -> Option<HostEvent> {
    let path = rfd::FileDialog::new().set_file_name(suggested_name).save_file()?;
    let reason = write_atomically(&path, bytes).err()?.to_string();
    Some(HostEvent::FileFailed { name: name_of(&path), reason })
}

impl Transport for CoreThreads {
    fn start(&mut self, core: u32) {
        let (sender, wake) = (self.sender.clone(), self.wake.clone());
        let superseded = Arc::new(AtomicBool::new(false));
        let host = ThreadHost {
            core,
            sender,
            superseded: Arc::clone(&superseded),
            wake,
            begun: Instant::now(),
            told: Instant::now(),
        };
        let (requests, received) = channel();
        thread::spawn(move || run_core(&received, host));
        self.running = Some(CoreThread { requests, superseded });
    }

    fn send(&mut self, job: &Job) -> Result<(), String> {
        let Some(running) = &self.running else { return Ok(()) };
        running.superseded.store(false, Ordering::Relaxed);
        running.requests.send(job.request.clone()).map_err(|_| "the planning core has stopped".to_owned())
    }

    fn interrupt(&mut self) {
        if let Some(running) = &self.running {
            running.superseded.store(true, Ordering::Relaxed);
        }
    }

    fn terminate(&mut self) {
        self.interrupt();
        self.running = None;
    }

    fn patience_secs(&self) -> f64 {
        PATIENCE_SECS
    }
}

/// Does jobs until no one can ask for more, or one of them panics: what a panic leaves behind is not to be trusted.
fn run_core(requests: &Receiver<Request>, mut host: ThreadHost) {
    let mut core = Core::default();
    host.tell(link::News::Ready);
    for request in requests {
        match catch_unwind(AssertUnwindSafe(|| core.handle(request, &mut host))) {
            Ok(()) => host.tell(link::News::Finished),
            Err(cause) => return host.tell(link::News::Failed(panic_message(cause.as_ref()))),
        }
    }
}

/// A core at work says at least so often that it continues.
const ALIVE: Duration = Duration::from_secs(5);

struct ThreadHost {
    core: u32,
    sender: Sender<News>,
    superseded: Arc<AtomicBool>,
    wake: Context,
    begun: Instant,
    /// When the window last heard something.
    told: Instant,
}

impl ThreadHost {
    fn tell(&self, news: link::News) {
        // No one listens any more when the window was closed meanwhile.
        let _ = self.sender.send(News::Core(self.core, news));
        self.wake.request_repaint();
    }
}

impl CoreHost for ThreadHost {
    fn now_millis(&self) -> f64 {
        self.begun.elapsed().as_secs_f64() * 1e3
    }

    fn is_superseded(&mut self) -> bool {
        if self.told.elapsed() > ALIVE {
            self.told = Instant::now();
            self.tell(link::News::Alive);
        }
        self.superseded.load(Ordering::Relaxed)
    }

    fn answer(&mut self, response: Response) {
        self.tell(link::News::Answer(response));
    }
}

fn panic_message(cause: &(dyn std::any::Any + Send)) -> String {
    cause
        .downcast_ref::<&str>()
        .map(|message| (*message).to_owned())
        .or_else(|| cause.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "the planning core stopped for an unknown reason".to_owned())
}

fn no_folder() -> StorageError {
    StorageError::Unavailable { reason: "this system has no folder for application data".to_owned() }
}

fn keep(file: &Path, bytes: &[u8]) -> Result<(), StorageError> {
    write_atomically(file, bytes).map_err(|reason| match reason.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            StorageError::Full { bytes: bytes.len() }
        }
        _ => StorageError::Unavailable { reason: reason.to_string() },
    })
}

/// Writes a file so that it is never seen half written.
fn write_atomically(file: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    let mut beside = file.as_os_str().to_owned();
    beside.push(".part");
    fs::write(&beside, bytes)?;
    fs::rename(&beside, file)
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A key as the name of a file on any system.
fn file_name(key: &str) -> String {
    key.bytes()
        .map(|byte| match byte {
            b'a'..=b'z' | b'0'..=b'9' | b'-' => char::from(byte).to_string(),
            _ => format!("_{byte:02x}"),
        })
        .collect()
}

/// The key that such a name represents; `None` for other files.
fn key_of(file_name: &str) -> Option<String> {
    let mut bytes = Vec::new();
    let mut rest = file_name;
    while let Some(first) = rest.bytes().next() {
        match first {
            b'_' => {
                bytes.push(u8::from_str_radix(rest.get(1..3)?, 16).ok()?);
                rest = rest.get(3..)?;
            }
            b'a'..=b'z' | b'0'..=b'9' | b'-' => {
                bytes.push(first);
                rest = rest.get(1..)?;
            }
            _ => return None,
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use kirk::Search as SearchKind;
    use link::Update;
    use snapshot::Goal;
    use workbench::host::ShelfNews;

    use super::*;

    /// Polls until an event is as wished; the other events are dropped.
    fn wait_for(host: &mut NativeHost, wished: impl Fn(&HostEvent) -> bool) -> HostEvent {
        loop {
            match host.poll() {
                Some(event) if wished(&event) => return event,
                Some(_) => {}
                None => thread::yield_now(),
            }
        }
    }

    #[test]
    fn the_newest_text_is_answered_whatever_was_posted_before() {
        let mut host = NativeHost::start_in(Context::default(), None);
        for revision in 1..=20 {
            host.post(Request::Update(Update {
                revision,
                source: "".into(),
                goal: Goal::default(),
                search: SearchKind::default(),
                seed: 0,
                trace: None,
            }));
        }
        wait_for(
            &mut host,
            |event| matches!(event, HostEvent::Answer(Response::Snapshot(snapshot)) if snapshot.revision == 20),
        );
    }

    #[test]
    fn what_is_stored_is_found_again_until_it_is_forgotten() {
        let folder = std::env::temp_dir().join(format!("enroute-native-{}", std::process::id()));
        let mut host = NativeHost::start_in(Context::default(), Some(folder.clone()));
        assert_eq!(host.stored("draft/A"), None);
        host.store("draft/A", "text").expect("a writable folder");
        let again = NativeHost::start_in(Context::default(), Some(folder.clone()));
        assert_eq!(again.stored("draft/A").as_deref(), Some("text"));
        host.forget("draft/A");
        assert_eq!(host.stored("draft/A"), None);
        fs::remove_dir_all(folder).expect("made above");
    }

    #[test]
    fn without_a_folder_storing_says_so() {
        let mut host = NativeHost::start_in(Context::default(), None);
        assert!(matches!(host.store("a", "b"), Err(StorageError::Unavailable { .. })));
    }

    #[test]
    fn missions_lie_on_the_shelf_until_they_are_removed() {
        let folder = std::env::temp_dir().join(format!("enroute-shelf-{}", std::process::id()));
        let mut host = NativeHost::start_in(Context::default(), Some(folder.clone()));
        assert_eq!(host.open_shelf(), Some(Ok(Vec::new())));
        for key in ["mission/A-1", "map/A-1/yard.pgm"] {
            let request = ShelfRequest::Write { key: key.to_owned(), bytes: b"kept".to_vec(), token: 7 };
            host.use_shelf(request);
            let news = wait_for(&mut host, |event| matches!(event, HostEvent::Shelf(_)));
            let written = ShelfNews::Written { key: key.to_owned(), token: 7, outcome: Ok(()) };
            assert_eq!(news, HostEvent::Shelf(written));
        }
        let mut again = NativeHost::start_in(Context::default(), Some(folder.clone()));
        let content = vec![("mission/A-1".to_owned(), b"kept".to_vec())];
        assert_eq!(again.open_shelf(), Some(Ok(content)));
        again.use_shelf(ShelfRequest::Read { key: "map/A-1/yard.pgm".to_owned() });
        let news = wait_for(&mut again, |event| matches!(event, HostEvent::Shelf(_)));
        let outcome = Ok(Some(b"kept".to_vec()));
        let read = ShelfNews::Read { key: "map/A-1/yard.pgm".to_owned(), outcome };
        assert_eq!(news, HostEvent::Shelf(read));
        again.use_shelf(ShelfRequest::Remove { key: "mission/A-1".to_owned() });
        assert_eq!(again.open_shelf(), Some(Ok(Vec::new())));
        fs::remove_dir_all(folder).expect("made above");
    }

    #[test]
    fn a_key_is_known_by_its_file() {
        for key in ["a/b", "enroute/writing-1/9F-1/a", "Δ", ""] {
            assert_eq!(key_of(&file_name(key)).as_deref(), Some(key));
        }
        assert_eq!(key_of("some.part"), None);
    }

    #[test]
    fn keys_that_differ_lie_in_files_that_differ_on_any_system() {
        let names = ["a/b", "a_b", "A", "a", ".."].map(file_name);
        assert_eq!(names, ["a_2fb", "a_5fb", "_41", "a", "_2e_2e"]);
    }
}
