//! The integration tests of `tpn`, in one program: each module is about one thing.

mod fleets;
