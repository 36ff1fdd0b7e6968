//! The integration tests of `controllability`, in one program: each module is about one thing.

mod plans;
