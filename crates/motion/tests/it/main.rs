//! The integration tests of `motion`, in one program: each module is about one thing.

mod driving;
mod planning;
mod shapes;
