//! The kinds of diagnostic of SPEC 1.7, one file each: what it means, an example, its fix, and how it is worded.

pub mod lex;
pub mod syntax;
