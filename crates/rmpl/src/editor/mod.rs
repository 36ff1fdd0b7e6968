//! What an editor asks about a mission text, one file per query. Every query is a pure function of a [`Parse`], works
//! on broken programs, and looks only at the declarations that it must.
//!
//! Finding and replacing is the editor's own: it needs no knowledge of the language. For control programs, see
//! [`crate::control`].
//!
//! [`Parse`]: crate::Parse

mod brackets;
mod comment;
mod completion;
mod cursor;
mod definition;
mod folding;
mod highlight;
mod hover;
mod indent;
mod insertion;
mod name;
mod outline;
mod rename;
mod selection;
mod signature;
mod topic;
mod users;

pub use brackets::matching_bracket;
pub use comment::toggle_comment;
pub use completion::{Completion, CompletionItem, CompletionKind, Wanted, complete};
pub use definition::{Reference, definition, references};
pub use folding::{Fold, FoldKind, folds};
pub use highlight::{Highlight, HighlightKind, highlight};
pub use hover::{Evaluation, EventWindow, Hover, Invocation, hover};
pub use indent::new_line;
pub use insertion::{add_declaration, set_option};
pub use name::{NameKind, NameUse, name_at};
pub use outline::{OutlineItem, OutlineKind, outline};
pub use rename::{RenameProblem, prepare_rename, rename};
pub use selection::wider_selection;
pub use signature::{Signature, signature_at};
pub use topic::Topic;
