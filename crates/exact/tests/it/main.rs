//! The integration tests of `exact`, in one program: each module is about one thing.

mod properties;
