//! The integration tests of `editor`, in one program: each module is about one thing.

mod widget;
