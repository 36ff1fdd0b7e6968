//! The concrete syntax of the infix notation (SPEC 1.1, 1.2): kinds, the lexer, and the lossless tree.
//!
//! Nothing here knows what a text means; see `crate::parser` for the grammar and `crate::lower` for meaning.

mod kind;
mod lexer;
mod tree;

pub(crate) use kind::KEEPOUT;
pub use kind::SyntaxKind;
pub(crate) use lexer::{LexProblem, LexProblemKind, Lexer, is_dash};
pub(crate) use tree::RawNode;
pub use tree::{DeclarationTree, Element, SyntaxNode, SyntaxToken, Token};
