//! The integration tests of `stnu`, in one program: each module is about one thing.

mod conflicts;
mod controllability;
mod documents;
mod execution;
mod oracle;
