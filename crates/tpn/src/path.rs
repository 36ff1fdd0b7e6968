//! Insertion of a traverse's path into the network (SPEC 7.3): its vertices become events, its segments arcs.
//!
//! Where the path comes from does not concern this module: lengths and speeds are plain numbers.

use exact::{Bound, Rational, Time};

use crate::network::{Arc, ArcKind, EventEnd, EventRef, Network, Node, NodeId, OccurrenceId, Role};

/// A path found for one traverse.
#[derive(Clone, Debug, PartialEq)]
pub struct TraversePath {
    pub occurrence: OccurrenceId,
    /// Its legs between waypoints, in order.
    pub legs: Vec<PathLeg>,
    /// Least and greatest speed in meters per second; the greatest is positive.
    pub speed_mps: (Rational, Rational),
    /// Whether the rover may stop on the way, so that no segment has a greatest duration.
    pub may_stop: bool,
}

/// The path between two waypoints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathLeg {
    /// The length of each segment in meters, in order. The vertex that ends the last one is the waypoint.
    pub segment_lengths_m: Vec<f64>,
    /// The mean speed in meters per second that the ground allows on each segment, where that is less than the
    /// greatest speed. A segment beyond the end of this list is driven as fast as the traverse may be.
    pub slope_speeds_mps: Vec<Option<f64>>,
}

/// Why a path cannot be inserted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PathError {
    /// There is no such traverse, or it has no arc.
    #[error("unknown traverse number")]
    NoTraverse,
    /// It has no segment at all.
    #[error("a path needs at least one segment")]
    Empty,
    /// A length is negative, infinite or not a number, or too long for exact time.
    #[error("a segment of {0} m has no exact duration")]
    Length(String),
    /// The lengths add up to more than exact time holds.
    #[error("the total duration of a path is too large to represent exactly")]
    TooLong,
    /// The greatest speed is not positive, or the least is negative or greater.
    #[error("{0} to {1} m/s is not a valid range of speeds")]
    Speed(String, String),
}

/// One segment of a path with the time it takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SegmentBounds {
    /// Its leg, from 1.
    pub leg: u32,
    /// The vertex that ends it, from 1 within its leg.
    pub vertex: u32,
    /// Least duration in mission units.
    pub least: Time,
    /// Greatest duration.
    pub greatest: Bound,
}

/// The times of a path's segments in order, exactly as [`insert_path`] puts them into a network.
pub fn segment_bounds(path: &TraversePath, unit_seconds: i64) -> Result<Vec<SegmentBounds>, PathError> {
    let (min_mps, max_mps) = path.speed_mps;
    if !max_mps.is_positive() || min_mps.is_negative() || min_mps > max_mps {
        return Err(PathError::Speed(min_mps.to_string(), max_mps.to_string()));
    }
    let has_slowest = !path.may_stop && min_mps.is_positive();
    let mut bounds = Vec::new();
    for (leg, number) in path.legs.iter().zip(1..) {
        let speeds = leg.slope_speeds_mps.iter().copied().chain(std::iter::repeat(None));
        for ((&length_m, slope_mps), vertex) in leg.segment_lengths_m.iter().zip(speeds).zip(1..) {
            let error = || PathError::Length(length_m.to_string());
            let at_speed = |speed| duration(length_m, speed, unit_seconds).ok_or_else(error);
            let mut least = at_speed(max_mps)?;
            if let Some(speed) = slope_mps {
                least = least.max(slope_duration(length_m, speed, unit_seconds).ok_or_else(error)?);
            }
            let greatest =
                if has_slowest { Bound::Finite(at_speed(min_mps)?.max(least)) } else { Bound::Infinite };
            bounds.push(SegmentBounds { leg: number, vertex, least, greatest });
        }
    }
    if bounds.is_empty() { Err(PathError::Empty) } else { Ok(bounds) }
}

/// Inserts `path` into `network`, which is as it was where that gives an error. `unit_seconds` is the length of the mission's
/// time unit.
///
/// Every id of `network` stays valid: nodes and arcs are only appended. Each segment takes its length divided by the
/// speed, rounded up to the millisecond, and has no greatest duration if the rover may stop or may drive at speed zero.
/// On a slope that is too steep for the least speed, the greatest duration is that of the slope.
/// The arc of the traverse keeps its bounds and labels and spans the path. The new events are named
/// `X#1.leg1.vertex1`; the last vertex is the traverse's end. Time is linear in the result.
///
/// Of a traverse whose duration the environment chooses, the path only raises the least duration to what it takes at
/// the greatest speed (SPEC 13.1): when its vertices are passed is the environment's as well, and no event of the
/// plan's. Where that is more than the greatest duration, the arc says that it cannot be driven.
pub fn insert_path(network: &mut Network, path: &TraversePath, unit_seconds: i64) -> Result<(), PathError> {
    let occurrence = network.occurrences.get(path.occurrence.index()).ok_or(PathError::NoTraverse)?;
    let spanning = occurrence.arc.ok_or(PathError::NoTraverse)?;
    let (start, end, span) = (occurrence.start, occurrence.end, network.arcs[spanning.index()].span);
    let segments = segment_bounds(path, unit_seconds)?;
    if network.arcs[spanning.index()].is_contingent {
        let least =
            Time::checked_sum(segments.iter().map(|segment| segment.least)).ok_or(PathError::TooLong)?;
        let arc = &mut network.arcs[spanning.index()];
        arc.lower = arc.lower.max(least);
        return Ok(());
    }
    network.arcs[spanning.index()].kind = ArcKind::Span;
    let count = segments.len();
    let mut from = start;
    for (position, SegmentBounds { leg, vertex, least, greatest }) in segments.into_iter().enumerate() {
        let to = if position + 1 == count {
            end
        } else {
            let event = EventRef { occurrence: path.occurrence, end: EventEnd::PathVertex { leg, vertex } };
            network.nodes.push(Node { role: Role::Event, events: vec![event], ..Node::default() });
            NodeId::from_index(network.nodes.len() - 1)
        };
        let arc = Arc::bare(from, to, (least, greatest), ArcKind::Path);
        network.connect(Arc { occurrence: Some(path.occurrence), span, ..arc });
        from = to;
    }
    Ok(())
}

/// The time for `length_m` at `speed_mps` in units of `unit_seconds`, exact and then rounded up to the millisecond.
/// `None` if the length is not a finite non-negative number or the result does not fit.
pub fn duration(length_m: f64, speed_mps: Rational, unit_seconds: i64) -> Option<Time> {
    if !length_m.is_finite() || length_m < 0.0 || unit_seconds <= 0 {
        return None;
    }
    // A double is mantissa · 2^exponent; both are exact, so the division below is too.
    let bits = length_m.to_bits();
    let biased = (bits >> 52 & 0x7FF) as i32;
    let fraction = i128::from(bits & ((1 << 52) - 1));
    let (mantissa, exponent) =
        if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    let millis_times_speed = mantissa.checked_mul(1000)?.checked_mul(i128::from(speed_mps.denominator()))?;
    let speed = i128::from(speed_mps.numerator());
    let millis = if exponent >= 0 {
        let factor = 1_i128.checked_shl(exponent.unsigned_abs()).filter(|&factor| factor > 0)?;
        divide_up(millis_times_speed.checked_mul(factor)?, speed)?
    } else {
        // Lengths below 2^-60 m only matter by not being zero.
        let shift = exponent.unsigned_abs();
        if shift >= 112 {
            i128::from(mantissa > 0)
        } else {
            match speed.checked_mul(1 << shift) {
                Some(divisor) => divide_up(millis_times_speed, divisor)?,
                None => i128::from(mantissa > 0),
            }
        }
    };
    Time::new(i64::try_from(millis).ok()?, unit_seconds.checked_mul(1000)?)
}

/// The time for `length_m` at a speed that was itself computed, rounded up to the millisecond. Division of doubles is the
/// same on every machine.
fn slope_duration(length_m: f64, speed_mps: f64, unit_seconds: i64) -> Option<Time> {
    if length_m == 0.0 {
        return Some(Time::ZERO);
    }
    let millis =
        Time::from_f64_up(1000.0 * length_m / speed_mps, 1).filter(|millis| !millis.is_negative())?;
    millis.checked_div(unit_seconds.checked_mul(1000)?)
}

fn divide_up(dividend: i128, divisor: i128) -> Option<i128> {
    if divisor <= 0 {
        return None;
    }
    Some(dividend / divisor + i128::from(dividend % divisor != 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn minutes(length_m: f64, speed: (i64, i64)) -> Option<Time> {
        duration(length_m, Rational::new(speed.0, speed.1)?, 60)
    }

    #[test]
    fn a_segment_takes_its_length_over_speed_rounded_up_to_the_millisecond() {
        assert_eq!(minutes(300.0, (5, 100)), Some(Time::from(100)));
        // 500 m at 0.045 m/s are 11,111,111.1 ms.
        assert_eq!(minutes(500.0, (45, 1000)), Time::new(11_111_112, 60_000));
        assert_eq!(minutes(415.0, (5, 100)), Time::new(8_300_000, 60_000));
        assert_eq!(minutes(0.0, (1, 1)), Some(Time::ZERO));
        // One ten-thousandth of a millimeter still takes a millisecond.
        assert_eq!(duration(1e-7, Rational::ONE, 1), Time::new(1, 1000));
        assert_eq!(duration(1e-300, Rational::ONE, 1), Time::new(1, 1000));
    }

    #[test]
    fn a_length_without_exact_duration_is_refused() {
        for length in [-1.0, f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(minutes(length, (1, 1)), None, "{length}");
        }
    }
}
