//! The app's surroundings in a page.

use js_sys::Uint8Array;
use mission::Request;
use wasm_bindgen::prelude::*;
use web_sys::{DomException, Location, Storage, Window};
use workbench::host::{FileKind, Host, HostEvent, StorageError};

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
    _fragment_listener: Closure<dyn FnMut()>,
}

impl PageHost {
    /// Starts the planning core and listens to the address line.
    pub(crate) fn start(glue: Glue, wake: egui::Context) -> Option<Self> {
        let window = web_sys::window()?;
        let link = CoreLink::start(glue.clone(), wake);
        let listener = Closure::<dyn FnMut()>::new({
            let (window, link) = (window.clone(), link.clone());
            move || link.happened(HostEvent::FragmentChanged(fragment_of(&window.location())))
        });
        window.set_onhashchange(Some(listener.as_ref().unchecked_ref()));
        Some(Self { glue, link, window, _fragment_listener: listener })
    }

    /// Reads files that are dropped on the canvas.
    pub(crate) fn drop_reader(&self) -> impl Fn(egui::DroppedFileHandle) + 'static {
        let link = self.link.clone();
        move |file| {
            let link = link.clone();
            wasm_bindgen_futures::spawn_local(async move {
                let name = file.path().to_string_lossy().into_owned();
                link.happened(match file.bytes_async().await {
                    Ok(bytes) => HostEvent::FileOpened { kind: FileKind::of_name(&name), name, bytes },
                    Err(reason) => HostEvent::FileFailed { name, reason },
                });
            });
        }
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
        self.storage()?.set_item(&prefixed(key), value).map_err(|thrown| {
            let is_full = thrown
                .dyn_ref::<DomException>()
                .is_some_and(|exception| exception.code() == DomException::QUOTA_EXCEEDED_ERR);
            if is_full {
                StorageError::Full { bytes: value.len() }
            } else {
                StorageError::Unavailable { reason: words(&thrown) }
            }
        })
    }

    fn forget(&mut self, key: &str) {
        if let Ok(storage) = self.storage() {
            // What cannot be reached is forgotten already.
            let _ = storage.remove_item(&prefixed(key));
        }
    }

    fn open_file(&mut self, kind: FileKind) {
        let extensions = kind.extensions().iter().map(|&extension| extension.to_owned()).collect();
        let chosen = self.glue.choose_file(extensions);
        let link = self.link.clone();
        wasm_bindgen_futures::spawn_local(async move {
            match wasm_bindgen_futures::JsFuture::from(chosen).await {
                Ok(file) if file.is_null() => {}
                Ok(file) => {
                    let file: ChosenFile = file.unchecked_into();
                    link.happened(HostEvent::FileOpened {
                        kind,
                        name: file.name(),
                        bytes: file.bytes().to_vec(),
                    });
                }
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

    fn save_file(&mut self, suggested_name: &str, bytes: Vec<u8>) {
        self.glue.save_file(suggested_name, Uint8Array::from(bytes.as_slice()));
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
        if let Ok(history) = self.window.history() {
            // Browsers refuse changes that come too fast; the next one brings the address up to date.
            let _ = history.replace_state_with_url(&JsValue::NULL, "", Some(&format!("#{fragment}")));
        }
    }

    fn link(&self, fragment: &str) -> Option<String> {
        let address = self.window.location().href().ok()?;
        let page = address.split('#').next()?;
        Some(format!("{page}#{fragment}"))
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
