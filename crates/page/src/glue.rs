//! What the files of `web/` do for this module.

use js_sys::{Promise, Uint8Array};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// The object that `web/start.js` gives to [`start`](crate::front_end::start).
    #[derive(Clone)]
    pub type Glue;

    /// Starts a planning core; `tell(kind, payload)` hears from it. See `web/core.js`.
    #[wasm_bindgen(method, js_name = startCore)]
    pub(crate) fn start_core(this: &Glue, tell: &Closure<dyn FnMut(String, JsValue)>) -> CoreWorker;

    /// Lets the user choose a file of at most so many bytes: a promise of a [`ChosenFile`] or null. See `web/files.js`.
    #[wasm_bindgen(method, js_name = chooseFile)]
    pub(crate) fn choose_file(this: &Glue, extensions: Vec<String>, most: f64) -> Promise;

    /// Returns whether missions can be saved to files that the user chose once. See `web/disk.js`.
    #[wasm_bindgen(method, js_name = savesInPlace)]
    pub(crate) fn saves_in_place(this: &Glue) -> bool;

    /// Lets the user choose a mission that can be saved to its file: a promise of a [`ChosenFile`] or null.
    #[wasm_bindgen(method, js_name = openMission)]
    pub(crate) fn open_mission(this: &Glue, extensions: Vec<String>, most: f64) -> Promise;

    /// Keeps a file that was opened as the one that a mission is saved to.
    #[wasm_bindgen(method, js_name = keepFile)]
    pub(crate) fn keep_file(this: &Glue, mission: &str, token: u32);

    /// Saves a mission to its file in one of these forms, objects with `name` and `bytes`: a promise of the file's name or
    /// null.
    #[wasm_bindgen(method, js_name = saveInPlace)]
    pub(crate) fn save_in_place(this: &Glue, mission: &str, asks: bool, forms: js_sys::Array) -> Promise;

    /// Reads the text on the clipboard: a promise that fails with what to do instead. See `web/clipboard.js`.
    #[wasm_bindgen(method, js_name = readClipboard)]
    pub(crate) fn read_clipboard(this: &Glue) -> Promise;

    /// Shows a fragment in the address, instead of what is there. See `web/address.js`.
    #[wasm_bindgen(method, js_name = showAddress)]
    pub(crate) fn show_address(this: &Glue, fragment: &str);

    /// Whether the window forgets everything when it is closed, as a promise. See `web/private.js`.
    #[wasm_bindgen(method, js_name = isPrivateWindow)]
    pub(crate) fn is_private_window(this: &Glue) -> Promise;

    /// Lets the user save a file.
    #[wasm_bindgen(method, js_name = saveFile)]
    pub(crate) fn save_file(this: &Glue, name: &str, bytes: Uint8Array);

    /// Lets the user save an SVG as a PNG of this size; the promise fails if the browser cannot draw it.
    #[wasm_bindgen(method, js_name = savePicture)]
    pub(crate) fn save_picture(this: &Glue, name: &str, svg: &str, width: u32, height: u32) -> Promise;

    /// Records what is drawn in a part of the canvas; throws if the browser can't. See `web/video.js`.
    #[wasm_bindgen(method, catch)]
    pub(crate) fn film(this: &Glue, left: f32, top: f32, width: f32, height: f32) -> Result<(), JsValue>;

    /// Ends the video and lets the user save it: a promise that fails if there is none.
    #[wasm_bindgen(method, js_name = saveFilm)]
    pub(crate) fn save_film(this: &Glue, name: &str) -> Promise;

    /// Returns what lies on the shelf: pairs of keys and bytes, or an error; undefined as long as that is not known.
    /// See `web/shelf.js`.
    #[wasm_bindgen(method, js_name = shelfContent)]
    pub(crate) fn shelf_content(this: &Glue) -> JsValue;

    /// The same as a promise.
    #[wasm_bindgen(method, js_name = shelfOpened)]
    pub(crate) fn shelf_opened(this: &Glue) -> Promise;

    /// Keeps bytes on the shelf; the promise fails if they are not kept.
    #[wasm_bindgen(method, js_name = writeToShelf)]
    pub(crate) fn write_to_shelf(this: &Glue, key: &str, bytes: Uint8Array) -> Promise;

    /// A promise of what is kept under a key, or of undefined.
    #[wasm_bindgen(method, js_name = readFromShelf)]
    pub(crate) fn read_from_shelf(this: &Glue, key: &str) -> Promise;

    /// Drops what is kept under a key.
    #[wasm_bindgen(method, js_name = removeFromShelf)]
    pub(crate) fn remove_from_shelf(this: &Glue, key: &str);

    /// Tells the other tabs with this page.
    #[wasm_bindgen(method, js_name = tellTabs)]
    pub(crate) fn tell_tabs(this: &Glue, message: &str);

    /// Hears what other tabs tell.
    #[wasm_bindgen(method, js_name = onTabSaid)]
    pub(crate) fn on_tab_said(this: &Glue, hear: &Closure<dyn FnMut(String)>);

    /// Says that a frame is being drawn.
    #[wasm_bindgen(method, js_name = frameDrawn)]
    pub(crate) fn frame_drawn(this: &Glue);

    /// A planning core in a web worker.
    pub(crate) type CoreWorker;

    /// Returns how long it may continue after [`CoreWorker::supersede`], in milliseconds.
    #[wasm_bindgen(method, getter, js_name = patienceMillis)]
    pub(crate) fn patience_millis(this: &CoreWorker) -> f64;

    /// Hands a request over.
    #[wasm_bindgen(method)]
    pub(crate) fn send(this: &CoreWorker, request: Uint8Array);

    /// Says that the request under way is not wanted any more.
    #[wasm_bindgen(method)]
    pub(crate) fn supersede(this: &CoreWorker);

    /// Ends it at once.
    #[wasm_bindgen(method)]
    pub(crate) fn stop(this: &CoreWorker);

    /// A file that the user chose.
    pub(crate) type ChosenFile;

    #[wasm_bindgen(method, getter)]
    pub(crate) fn name(this: &ChosenFile) -> String;

    /// Returns what [`Glue::keep_file`] knows it by, if it does.
    #[wasm_bindgen(method, getter)]
    pub(crate) fn token(this: &ChosenFile) -> Option<u32>;

    #[wasm_bindgen(method, getter)]
    pub(crate) fn bytes(this: &ChosenFile) -> Uint8Array;
}
