//! How the app looks: color tokens, spacing, type sizes, and their translation to egui's style.
//!
//! Panels name meanings ("a threat", "weak text"), never colors; `clippy.toml` refuses color constructors elsewhere.
//! Everything that draws takes its looks from here; this knows nothing of missions.

pub mod icon;
mod prose;
mod short;
pub mod structure;
mod style;
mod tokens;

pub use prose::Prose;
pub use short::show_markdown;
#[cfg(not(target_arch = "wasm32"))]
pub use style::FONTS;
pub use style::{apply, install_fonts, strong, strong_family};
pub use tokens::{DARK, LIGHT, Syntax, Tokens};

/// Distances in points, on a grid of 4.
pub mod space {
    /// Between parts of one thing.
    pub const XS: f32 = 2.0;
    /// Between neighbors.
    pub const S: f32 = 4.0;
    /// Between groups; a panel's margin.
    pub const M: f32 = 8.0;
    /// Between sections.
    pub const L: f32 = 12.0;
    /// Around dialogs.
    pub const XL: f32 = 16.0;
    /// The height of a row in lists and tables.
    pub const ROW: f32 = 24.0;
    /// The height of bars.
    pub const BAR: f32 = 36.0;
}

/// Type sizes in points, before the user's text scaling.
pub mod size {
    /// Notes, axis labels, badges.
    pub const SMALL: f32 = 11.0;
    /// Everything else.
    pub const BODY: f32 = 13.0;
    /// Code in prose and in the editor.
    pub const CODE: f32 = 13.0;
    /// Titles of dialogs and sections.
    pub const TITLE: f32 = 15.0;
}
