//! The integration tests of `stn`, in one program: each module is about one thing.

mod by_hand;
mod random_networks;
mod unfolding;
