//! How a host page, a test or a window drives the app; it mirrors `window.enroute` (DESIGN 4.3).

use serde_json::Value;

use crate::description::State;
use crate::host::RemoteError;

/// How the world outside drives the app: the same operations as `window.enroute` (DESIGN 4.3).
pub trait Remote {
    /// Opens the example mission of this name.
    fn open(&mut self, name: &str) -> Result<(), RemoteError>;

    /// Replaces the whole text, as one undoable edit.
    fn set_source(&mut self, text: &str);

    /// The text as it stands.
    fn source(&self) -> String;

    /// Runs a command of the registry by its name.
    fn dispatch(&mut self, command: &str, arguments: &Value) -> Result<(), RemoteError>;

    /// The state as host pages see it.
    fn state(&self) -> State;

    /// Grows whenever [`Remote::state`] may have changed; subscribers are told then.
    fn state_version(&self) -> u64;
}
