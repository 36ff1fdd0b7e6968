//! The app's surroundings in a page.

use js_sys::Uint8Array;
use link::Request;
use wasm_bindgen::prelude::*;
use web_sys::{Location, MediaQueryList, Storage, Window};
use workbench::area::Area;
use workbench::host::{FileKind, Host, HostEvent, Save, ShelfContent, ShelfNews, ShelfRequest, StorageError};
use workbench::limits::{MAX_FILE_BYTES, too_large};

use crate::{
    core_link::CoreLink,
    glue::{ChosenFile, Glue},
    refusal::words,
};

/// What keys of the page's storage begin with, since other pages of the same origin share it.
const STORAGE_PREFIX: &str = "enroute/";

/// The app's surroundings in a page.
pub(crate) struct PageHost {
    glue: Glue,
    link: CoreLink,
    window: Window,
    /// Whether the user wants nothing to move by itself, where the browser can tell.
    reduces_motion: Option<MediaQueryList>,
    _fragment_listener: Closure<dyn FnMut()>,
    _tab_listener: Closure<dyn FnMut(String)>,
}

impl PageHost {
    /// The way to the planning core.
    pub(crate) fn core(&self) -> CoreLink {
        self.link.clone()
    }

    /// Starts the planning core and listens to the address line.
    pub(crate) fn start(glue: Glue, wake: egui::Context) -> Option<Self> {
        let window = web_sys::window()?;
        let link = CoreLink::start(glue.clone(), wake);
        let listener = Closure::<dyn FnMut()>::new({
            let (window, link) = (window.clone(), link.clone());
            move || link.happened(HostEvent::FragmentChanged(fragment_of(&window.location())))
        });
        window.set_onhashchange(Some(listener.as_ref().unchecked_ref()));
        let tab_listener = Closure::<dyn FnMut(String)>::new({
            let link = link.clone();
            move |message| link.happened(HostEvent::TabSaid(message))
        });
        glue.on_tab_said(&tab_listener);
        let (private, news) = (glue.is_private_window(), link.clone());
        wasm_bindgen_futures::spawn_local(async move {
            let answer = wasm_bindgen_futures::JsFuture::from(private).await;
            if answer.is_ok_and(|is_private| is_private.is_truthy()) {
                news.happened(HostEvent::PrivateWindow);
            }
        });
        let listeners = (listener, tab_listener);
        let reduces_motion = window.match_media("(prefers-reduced-motion: reduce)").ok().flatten();
        Some(Self {
            glue,
            link,
            window,
            reduces_motion,
            _fragment_listener: listeners.0,
            _tab_listener: listeners.1,
        })
    }

    /// Reads files that are dropped on the canvas.
    pub(crate) fn drop_reader(&self) -> impl Fn(egui::DroppedFileHandle) + 'static {
        let link = self.link.clone();
        move |file| {
            let link = link.clone();
            wasm_bindgen_futures::spawn_local(async move {
                let name = file.path().to_string_lossy().into_owned();
                let kind = FileKind::of_name(&name);
                // What is too large is not even read: it may not fit into the memory.
                let size = file.web_file().map_or(0.0, |file| file.size());
                if let Some(reason) = too_large(size as usize, kind.max_bytes(&name)) {
                    link.happened(HostEvent::FileFailed { name, reason });
                    return;
                }
                link.happened(match file.bytes_async().await {
                    Ok(bytes) => HostEvent::FileOpened { kind, name, bytes, token: None },
                    Err(reason) => HostEvent::FileFailed { name, reason },
                });
            });
        }
    }

    /// Tells what comes of a file that the user was asked for, unless they chose none.
    fn tell_later(&self, chosen: js_sys::Promise, event: impl FnOnce(JsValue) -> HostEvent + 'static) {
        let link = self.link.clone();
        wasm_bindgen_futures::spawn_local(async move {
            match wasm_bindgen_futures::JsFuture::from(chosen).await {
                Ok(none) if none.is_null() => {}
                Ok(chosen) => link.happened(event(chosen)),
                Err(thrown) => link.happened(HostEvent::FileFailed {
                    name: js_sys::Reflect::get(&thrown, &"fileName".into())
                        .ok()
                        .and_then(|name| name.as_string())
                        .unwrap_or_default(),
                    reason: words(&thrown),
                }),
            }
        });
    }

    fn storage(&self) -> Result<Storage, StorageError> {
        let unavailable = |reason: String| StorageError::Unavailable { reason };
        match self.window.local_storage() {
            Ok(Some(storage)) => Ok(storage),
            Ok(None) => Err(unavailable("this page has no storage".to_owned())),
            Err(thrown) => Err(unavailable(words(&thrown))),
        }
    }
}

impl Host for PageHost {
    fn post(&mut self, request: Request) {
        self.link.post(request);
    }

    fn stop(&mut self) {
        self.link.stop();
    }

    fn poll(&mut self) -> Option<HostEvent> {
        self.link.poll()
    }

    fn monotonic_secs(&self) -> f64 {
        self.window.performance().map_or(0.0, |clock| clock.now() / 1e3)
    }

    fn unix_millis(&self) -> i64 {
        js_sys::Date::now() as i64
    }

    fn stored(&self, key: &str) -> Option<String> {
        self.storage().ok()?.get_item(&prefixed(key)).ok()?
    }

    fn store(&mut self, key: &str, value: &str) -> Result<(), StorageError> {
        self.storage()?.set_item(&prefixed(key), value).map_err(|thrown| refused(&thrown, value.len()))
    }

    fn forget(&mut self, key: &str) {
        if let Ok(storage) = self.storage() {
            // An entry that cannot be removed is harmless: the next write replaces it.
            let _ = storage.remove_item(&prefixed(key));
        }
    }

    fn stored_keys(&self) -> Vec<String> {
        let Ok(storage) = self.storage() else { return Vec::new() };
        let keys = (0..storage.length().unwrap_or_default()).filter_map(|at| storage.key(at).ok()?);
        keys.filter_map(|key| key.strip_prefix(STORAGE_PREFIX).map(str::to_owned)).collect()
    }

    fn open_shelf(&mut self) -> Option<Result<ShelfContent, StorageError>> {
        let opened = self.glue.shelf_content();
        if !opened.is_undefined() {
            return Some(content_of(&opened));
        }
        let (late, link) = (self.glue.shelf_opened(), self.link.clone());
        wasm_bindgen_futures::spawn_local(async move {
            let opened = wasm_bindgen_futures::JsFuture::from(late).await.unwrap_or_else(|thrown| thrown);
            link.happened(HostEvent::Shelf(ShelfNews::Opened(content_of(&opened))));
        });
        None
    }

    fn use_shelf(&mut self, request: ShelfRequest) {
        let link = self.link.clone();
        match request {
            ShelfRequest::Write { key, bytes, token } => {
                let written = self.glue.write_to_shelf(&key, Uint8Array::from(bytes.as_slice()));
                wasm_bindgen_futures::spawn_local(async move {
                    let outcome = wasm_bindgen_futures::JsFuture::from(written).await;
                    let outcome = outcome.map(|_| ()).map_err(|thrown| refused(&thrown, bytes.len()));
                    link.happened(HostEvent::Shelf(ShelfNews::Written { key, token, outcome }));
                });
            }
            ShelfRequest::Read { key } => {
                let read = self.glue.read_from_shelf(&key);
                wasm_bindgen_futures::spawn_local(async move {
                    let outcome = wasm_bindgen_futures::JsFuture::from(read).await;
                    let outcome = outcome
                        .map(|value| value.dyn_into::<Uint8Array>().ok().map(|bytes| bytes.to_vec()))
                        .map_err(|thrown| refused(&thrown, 0));
                    link.happened(HostEvent::Shelf(ShelfNews::Read { key, outcome }));
                });
            }
            ShelfRequest::Remove { key } => self.glue.remove_from_shelf(&key),
        }
    }

    fn tell_tabs(&mut self, message: &str) {
        self.glue.tell_tabs(message);
    }

    fn reduces_motion(&self) -> bool {
        self.reduces_motion.as_ref().is_some_and(MediaQueryList::matches)
    }

    fn is_firefox(&self) -> bool {
        self.window.navigator().user_agent().is_ok_and(|agent| agent.contains("Firefox/"))
    }

    fn random(&mut self) -> u64 {
        // Two halves of 32 bits; the sum of both fits.
        let half = || (js_sys::Math::random() * f64::from(u32::MAX)) as u64;
        half() << 32 | half()
    }

    fn secret_bytes(&mut self) -> Option<[u8; 32]> {
        let mut bytes = [0; 32];
        web_sys::window()?.crypto().ok()?.get_random_values_with_u8_array(&mut bytes).ok()?;
        Some(bytes)
    }

    fn open_file(&mut self, kind: FileKind) {
        let extensions = kind.extensions().iter().map(|&extension| extension.to_owned()).collect();
        let chosen = if kind == FileKind::Mission && self.glue.saves_in_place() {
            self.glue.open_mission(extensions, MAX_FILE_BYTES as f64)
        } else {
            self.glue.choose_file(extensions, MAX_FILE_BYTES as f64)
        };
        self.tell_later(chosen, move |file| {
            let file: ChosenFile = file.unchecked_into();
            let (name, bytes, token) = (file.name(), file.bytes().to_vec(), file.token());
            HostEvent::FileOpened { kind, name, bytes, token }
        });
    }

    fn saves_in_place(&self) -> bool {
        self.glue.saves_in_place()
    }

    fn save_in_place(&mut self, save: Save) {
        let form = |(name, bytes): (String, Vec<u8>)| {
            let form = js_sys::Object::new();
            // Setting a property of a fresh object cannot fail.
            let _ = js_sys::Reflect::set(&form, &"name".into(), &name.into());
            let _ = js_sys::Reflect::set(&form, &"bytes".into(), &Uint8Array::from(bytes.as_slice()));
            form
        };
        let forms = save.forms.into_iter().map(form).collect();
        let saved = self.glue.save_in_place(&save.mission, save.asks, forms);
        self.tell_later(saved, move |name| HostEvent::FileSaved {
            name: name.as_string().unwrap_or_default(),
            revision: save.revision,
        });
    }

    fn keep_file(&mut self, mission: &str, token: u32) {
        self.glue.keep_file(mission, token);
    }

    fn read_clipboard(&mut self) -> bool {
        let (read, link) = (self.glue.read_clipboard(), self.link.clone());
        wasm_bindgen_futures::spawn_local(async move {
            link.happened(match wasm_bindgen_futures::JsFuture::from(read).await {
                Ok(text) => HostEvent::ClipboardRead(text.as_string().unwrap_or_default()),
                Err(thrown) => HostEvent::ClipboardRefused { reason: words(&thrown) },
            });
        });
        true
    }

    fn save_file(&mut self, suggested_name: &str, bytes: Vec<u8>) {
        self.glue.save_file(suggested_name, Uint8Array::from(bytes.as_slice()));
    }

    fn film(&mut self, [left, top, width, height]: Area) -> Result<(), String> {
        self.glue.film(left, top, width, height).map_err(|thrown| words(&thrown))
    }

    fn save_film(&mut self, suggested_name: &str) {
        let saved = self.glue.save_film(suggested_name);
        let (link, name) = (self.link.clone(), suggested_name.to_owned());
        wasm_bindgen_futures::spawn_local(async move {
            if let Err(thrown) = wasm_bindgen_futures::JsFuture::from(saved).await {
                link.happened(HostEvent::FileFailed { name, reason: words(&thrown) });
            }
        });
    }

    fn save_picture(&mut self, suggested_name: &str, svg: String, [width, height]: [u32; 2]) {
        let saved = self.glue.save_picture(suggested_name, &svg, width, height);
        let (link, name) = (self.link.clone(), suggested_name.to_owned());
        wasm_bindgen_futures::spawn_local(async move {
            if let Err(thrown) = wasm_bindgen_futures::JsFuture::from(saved).await {
                link.happened(HostEvent::FileFailed { name, reason: words(&thrown) });
            }
        });
    }

    fn fragment(&self) -> String {
        fragment_of(&self.window.location())
    }

    fn set_fragment(&mut self, fragment: &str) {
        self.glue.show_address(fragment);
    }

    fn link(&self, fragment: &str) -> Option<String> {
        let address = self.window.location().href().ok()?;
        let page = address.split('#').next()?;
        Some(format!("{page}#{fragment}"))
    }
}

/// Returns what the shelf holds, as `web/shelf.js` tells it: pairs of keys and bytes, or what went wrong.
fn content_of(opened: &JsValue) -> Result<ShelfContent, StorageError> {
    let pairs = opened.dyn_ref::<js_sys::Array>().ok_or_else(|| refused(opened, 0))?;
    let pair = |pair: JsValue| {
        let pair = js_sys::Array::from(&pair);
        Some((pair.get(0).as_string()?, pair.get(1).dyn_into::<Uint8Array>().ok()?.to_vec()))
    };
    Ok(pairs.iter().filter_map(pair).collect())
}

/// Returns why the browser keeps nothing more.
fn refused(thrown: &JsValue, bytes: usize) -> StorageError {
    let name = js_sys::Reflect::get(thrown, &"name".into()).ok().and_then(|name| name.as_string());
    if name.as_deref() == Some("QuotaExceededError") {
        StorageError::Full { bytes }
    } else {
        StorageError::Unavailable { reason: words(thrown) }
    }
}

fn prefixed(key: &str) -> String {
    format!("{STORAGE_PREFIX}{key}")
}

fn fragment_of(location: &Location) -> String {
    let hash = location.hash().unwrap_or_default();
    let encoded = hash.trim_start_matches('#');
    js_sys::decode_uri_component(encoded)
        .ok()
        .and_then(|decoded| decoded.as_string())
        .unwrap_or_else(|| encoded.to_owned())
}
