//! Texts as sentences.

pub(crate) use workbench::sentence;
