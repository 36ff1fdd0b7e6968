//! Errors as JavaScript sees them: `EnrouteError` with a `code` that programs look at.

use js_sys::{Error, Reflect};
use wasm_bindgen::JsValue;
use workbench::host::{RefusalCode, RemoteError};

/// An `EnrouteError`.
pub(crate) fn refusal(code: RefusalCode, message: &str) -> JsValue {
    let error = Error::new(message);
    error.set_name("EnrouteError");
    // Setting a property of a fresh object cannot fail.
    let _ = Reflect::set(&error, &"code".into(), &code.name().into());
    error.into()
}

/// The app's refusal as an `EnrouteError`.
#[expect(clippy::needless_pass_by_value, reason = "to be given to `map_err`")]
pub(crate) fn from_remote(error: RemoteError) -> JsValue {
    refusal(error.code(), &error.to_string())
}

/// Returns what JavaScript threw, in words.
pub(crate) fn words(thrown: &JsValue) -> String {
    Reflect::get(thrown, &"message".into())
        .ok()
        .and_then(|message| message.as_string())
        .or_else(|| thrown.as_string())
        .unwrap_or_else(|| "an unknown error".to_owned())
}
