//! The workbench: everything the app knows and does, without a front end.
//!
//! [`AppState`](state::AppState) changes only by [`Command`](command::Command)s, which menus, keys, panels and host
//! pages send; what only the host can do it leaves behind as effects. It draws nothing and knows no widget: the panels
//! and the app around them read it.

pub mod acts;
pub mod area;
pub mod command;
pub mod description;
mod dialog;
mod effect;
pub mod host;
pub mod host_io;
pub mod lesson;
pub mod library;
pub mod limits;
pub mod manual;
pub mod mission_file;
mod panel_effect;
mod panel_kind;
pub mod registry;
mod sentence;
mod session;
pub mod state;
pub mod time_text;
pub mod workspace;

pub use dialog::Dialog;
pub use panel_effect::{PanelEffect, PanelEffects, PictureFormat, ViewAction};
pub use panel_kind::PanelKind;
pub use sentence::sentence;
pub use session::{Session, WindowEffect};
