//! Random draws of what an uncertainty leaves to chance: times, incidents, and rocks about a path.

use exact::{Overflow, Time};
use executive::Disturbance;
use motion::Path;
use plant::Random;
use snapshot::robustness::{Distribution, Incident, Rocks};

/// Draws are multiples of this part of a unit.
pub const PER_UNIT: u32 = 1000;

/// Draws a time; an error if it does not fit.
pub fn draw(distribution: Distribution, random: &mut Random) -> Result<Time, Overflow> {
    let least = distribution.least();
    let after = |time: Time| time.checked_sub(least).ok_or(Overflow);
    let offset = match distribution {
        Distribution::Fixed(_) => Some(Time::ZERO),
        Distribution::Uniform(_, most) => {
            let steps = after(most)?.integer_parts(PER_UNIT).ok_or(Overflow)?.max(0) as u64;
            Time::new(random.below(steps.saturating_add(1)) as i64, i64::from(PER_UNIT))
        }
        Distribution::Triangular(_, likely, most) => {
            let (width, peak) = (after(most)?.to_f64(), after(likely)?.to_f64());
            let share = unit(random);
            let offset = if width <= 0.0 {
                0.0
            } else if share * width < peak {
                (share * width * peak).sqrt()
            } else {
                width - ((1.0 - share) * width * (width - peak)).sqrt()
            };
            Time::from_f64_nearest(offset, PER_UNIT)
        }
        Distribution::Normal(mean, deviation) => {
            let (radius, angle) = (1.0 - unit(random), unit(random));
            let normal = (-2.0 * libm::log(radius)).sqrt() * libm::cos(2.0 * std::f64::consts::PI * angle);
            let drawn = mean.to_f64() + deviation.to_f64() * normal;
            Time::from_f64_nearest(drawn, PER_UNIT).map(|drawn| drawn.max(Time::ZERO))
        }
    };
    offset.and_then(|offset| least.checked_add(offset)).ok_or(Overflow)
}

/// Draws when an incident happens, if it does.
pub fn incident(incident: &Incident, random: &mut Random) -> Result<Option<Time>, Overflow> {
    // Both are always drawn, so that a probability can be changed without changing the rest of a run.
    let chance = unit(random);
    let at = draw(incident.at, random)?;
    Ok((chance < incident.probability).then_some(at))
}

/// Rocks about a path, none of them on a place that the path leads to. As much is drawn for each that might lie there as
/// for one that does.
pub fn rocks(rocks: &Rocks, path: &Path, place_ends_m: &[f64], random: &mut Random) -> Vec<Disturbance> {
    const ROOM_M: f64 = 3.0;
    let count = random.below(u64::from(rocks.most) + 1);
    let length_m = path.length_m();
    let mut drawn = Vec::new();
    for number in 0..u64::from(rocks.most) {
        let along_m = unit(random) * length_m;
        let aside_m = (2.0 * unit(random) - 1.0) * rocks.aside;
        let [least, greatest] = rocks.radius;
        let radius = least + (greatest - least) * unit(random);
        let mut places_m = place_ends_m.iter().copied().chain([0.0]);
        if number >= count || places_m.any(|end_m| (end_m - along_m).abs() < radius + ROOM_M) {
            continue;
        }
        let Some((place, segment)) = path.point_at(along_m) else { continue };
        let Some((from, to)) = path.segments().nth(segment) else { continue };
        let (east, north) = (to[0] - from[0], to[1] - from[1]);
        let length = (east * east + north * north).sqrt().max(1e-9);
        let (x, y) = (place[0] - north / length * aside_m, place[1] + east / length * aside_m);
        drawn.push(Disturbance::Obstacle { at: Time::ZERO, x, y, radius, low: false });
    }
    drawn
}

/// A number from 0 up to 1.
fn unit(random: &mut Random) -> f64 {
    (random.next_bits() >> 11) as f64 / (1_u64 << 53) as f64
}
