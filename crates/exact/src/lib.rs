//! Exact numbers, times and bounds (SPEC 1.5): what cannot be kept exactly in 64 bits is an error, never a wrong number.
//!
//! [`Time`] is a point in time or a duration in the mission's units, [`Bound`] one that may be infinite, and
//! [`Rational`] a number without a unit, such as a factor or a speed. None of them has operators: every operation that
//! can leave 64 bits is a `checked_…` method that gives `None` exactly when the result does not fit. All are read by
//! one reader ([`std::str::FromStr`]), printed by one printer ([`std::fmt::Display`], and `readable` for people), and
//! become floats by one conversion (`to_f64`). [`Scale`] turns times into whole ticks and back.
//!
//! This is not a calendar, and knows no units: what a unit is stands in the mission.
//!
//! ```
//! use exact::{Bound, Rational, Time};
//!
//! let drive: Time = "450".parse()?;
//! let share: Rational = "0.9".parse()?;
//! assert_eq!(drive.checked_mul(share), Some(Time::from(405)));
//! assert_eq!(Time::new(1000, 3).map(|time| time.to_string()), Some("1000/3".to_owned()));
//! assert!(Bound::Finite(drive) < "inf".parse::<Bound>()?);
//! assert_eq!(Time::from(i64::MAX).checked_add(drive), None);
//! # Ok::<(), exact::ReadError>(())
//! ```

mod bound;
mod counted;
mod print;
mod rational;
mod read;
mod scale;
mod serial;
mod time;

pub use bound::{Bound, BoundError};
pub use counted::{counted, grouped};
pub use rational::Rational;
pub use read::ReadError;
pub use scale::Scale;
pub use time::Time;

/// An exact result does not fit into 64 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, thiserror::Error)]
#[error("the value is too large to represent exactly")]
pub struct Overflow;
