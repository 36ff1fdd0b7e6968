//! The integration tests of `markdown`, in one program: each module is about one thing.

mod blocks;
