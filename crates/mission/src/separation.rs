//! Separation violations: vehicles of different traverses that come too near each other in some schedule of a plan, with
//! time, place and schedule.

mod schedules;

use std::collections::BTreeMap;

use motion::TimedPoint;
use nalgebra::{Point2, Vector2, distance};
use rmpl::Diagnostic;
use rmpl::program::{Program, World};
use snapshot::vehicle::{GAP_M, flies, radius_m};
use snapshot::{MovementTimes, SeparationViolation, VehicleMotion, standing};
use tpn::{ArcKind, Network, NodeId, OccurrenceId, Plan};

use self::schedules::{Gaps, Stretch};
use crate::driving::{self, Drive, Place};

/// Two vehicles that can be too near each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Meeting {
    pub vehicles: [u32; 2],
    /// What each of them drives then; nothing for one that stands.
    pub movements: [Option<OccurrenceId>; 2],
    /// Where each of them can be while the other one is near, in meters.
    pub places_m: [Vec<Point2<f64>>; 2],
    /// Orders of two traverses that may keep them apart, the likeliest first.
    pub orders: Vec<(OccurrenceId, OccurrenceId)>,
    pub violation: SeparationViolation,
}

/// Pieces of paths that are looked at are at most this long, in meters.
const PIECE_M: f64 = 0.5;
/// A driver may be this far ahead of or behind an even pace, in meters: it turns before it sets out.
const PACE_M: f64 = 1.0;
/// Formations keep their spacing but for rounding. Vehicles that are nearer by less than this are not too near, in meters.
const ROUNDING_M: f64 = 0.05;
/// Places that a vehicle passes are told apart from this distance on, in meters.
const APART_M: f64 = 0.25;

/// What a vehicle does between two events of the plan: it drives, or stands.
struct Part {
    movement: Option<OccurrenceId>,
    track: Vec<Place>,
    length_m: f64,
    from: NodeId,
    until: [NodeId; 2],
    /// How long a drive takes at least, in mission units.
    least: f64,
}

impl Part {
    /// A vehicle that stands at a place between two events.
    fn standing(place_m: Point2<f64>, from: NodeId, until: NodeId) -> Self {
        let track = vec![Place { share: 0.0, position_m: place_m }];
        Self { movement: None, track, length_m: 0.0, from, until: [until; 2], least: 0.0 }
    }

    /// When a vehicle is on a piece of one of its segments.
    fn stretch(&self, segment: usize, [start, end]: [f64; 2]) -> Stretch {
        let (from, until) = (self.from, self.until);
        let (Some(a), Some(b)) = (self.track.get(segment), self.track.get(segment + 1)) else {
            return Stretch { from, after: 0.0, until, share: 1.0 };
        };
        let share = |part: f64| a.share + (b.share - a.share) * part;
        let pace = PACE_M / self.length_m.max(PACE_M);
        let after = (share(start) - pace).max(0.0) * self.least;
        Stretch { from, after, until, share: (share(end) + pace).min(1.0) }
    }

    fn full(&self) -> Stretch {
        Stretch { from: self.from, after: 0.0, until: self.until, share: 1.0 }
    }
}

/// All pairs of vehicles that do not drive together and can come nearer than the sum of their radii and [`GAP_M`] in some
/// schedule of the plan, once for each pair of what they drive. A vehicle that has not started to move or has stopped
/// stands where it is. `tracks` are those of [`driving::all_tracks`].
pub(crate) fn meetings(
    (drives, tracks): (&[Drive], Vec<Vec<Vec<Place>>>),
    motions: &[VehicleMotion],
    program: &Program,
    network: &Network,
    plan: &Plan,
) -> Vec<Meeting> {
    let parts = parts((drives, tracks), motions, program, network);
    let near = near_parts(&parts, &program.world);
    let of = |(vehicle, index): (u32, usize)| &parts[&vehicle][index];
    let pairs = near.iter().map(|pair| [of(pair.one), of(pair.other)]);
    let events = pairs.map(|pair| pair.map(|part| [part.from, part.until[0], part.until[1]]).concat());
    let Some(gaps) = (!near.is_empty()).then(|| Gaps::new(network, plan, events)).flatten() else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for NearParts { one, other, safety_m } in near {
        let (part, other_part) = (of(one), of(other));
        let (full, other_full) = (part.full(), other_part.full());
        if gaps.is_before(&full, &other_full) || gaps.is_before(&other_full, &full) {
            continue;
        }
        let Some(meeting) = meeting(&gaps, [one.0, other.0], [part, other_part], safety_m) else { continue };
        let orders = orders([one, other].map(|(vehicle, index)| (parts[&vehicle].as_slice(), index)));
        found.push(Meeting { orders, ..meeting });
    }
    in_earliest_schedule(&mut found, drives, motions);
    found.sort_by_key(|meeting| !meeting.violation.schedule.is_empty());
    found
}

/// Parts of two vehicles whose tracks may be nearer to each other than `safety_m`, each with the vehicle and its number there.
struct NearParts {
    one: (u32, usize),
    other: (u32, usize),
    safety_m: f64,
}

/// The pairs of parts of different vehicles that are not one movement and have boxes around their tracks that are near each
/// other, in the order of vehicles and parts: boxes are compared with those that overlap them from west to east.
fn near_parts(parts: &BTreeMap<u32, Vec<Part>>, world: &World) -> Vec<NearParts> {
    let mut boxes: Vec<PartBox> = Vec::new();
    for (&vehicle, own) in parts {
        let (flies, radius_m) = (flies(world, vehicle), radius_m(world, vehicle));
        // Half of the gap on each side.
        let room = Vector2::repeat(radius_m + 0.5 * GAP_M);
        boxes.extend(own.iter().enumerate().filter_map(|(index, part)| {
            let mut places = part.track.iter().map(|place| place.position_m);
            let first = places.next()?;
            let (low, high) =
                places.fold((first, first), |(low, high), place| (low.inf(&place), high.sup(&place)));
            let (part, movement) = ((vehicle, index), part.movement);
            Some(PartBox { part, movement, flies, radius_m, low: low - room, high: high + room })
        }));
    }
    boxes.sort_by(|one, other| one.low.x.total_cmp(&other.low.x));
    let mut near = Vec::new();
    for (at, west) in boxes.iter().enumerate() {
        let overlapping = boxes[at + 1..].iter().take_while(|east| east.low.x <= west.high.x);
        for east in overlapping.filter(|east| west.may_meet(east)) {
            let (one, other) = (west.part.min(east.part), west.part.max(east.part));
            near.push(NearParts { one, other, safety_m: west.radius_m + east.radius_m + GAP_M });
        }
    }
    near.sort_by_key(|pair| (pair.one.0, pair.other.0, pair.one.1, pair.other.1));
    near
}

/// A part with the box around its track and the room around the vehicle.
struct PartBox {
    part: (u32, usize),
    movement: Option<OccurrenceId>,
    flies: bool,
    radius_m: f64,
    low: Point2<f64>,
    high: Point2<f64>,
}

impl PartBox {
    /// Returns whether this part and one of another vehicle, which begins no farther west, overlap from south to north
    /// and are no one movement.
    fn may_meet(&self, other: &Self) -> bool {
        self.part.0 != other.part.0
            && self.flies == other.flies
            && (self.movement.is_none() || self.movement != other.movement)
            && self.low.y <= other.high.y
            && other.low.y <= self.high.y
    }
}

/// Returns how near each pair of vehicles comes: in the earliest schedule, or in another one where that has nothing to
/// say.
pub(crate) fn violations(meetings: &[Meeting]) -> Vec<SeparationViolation> {
    let mut of_pairs: BTreeMap<[u32; 2], &SeparationViolation> = BTreeMap::new();
    for meeting in meetings {
        let violation = &meeting.violation;
        let key = |it: &SeparationViolation| (!it.schedule.is_empty(), it.distance_m);
        let known = of_pairs.entry(meeting.vehicles).or_insert(violation);
        if key(violation) < key(known) {
            *known = violation;
        }
    }
    of_pairs.into_values().cloned().collect()
}

/// Tells the author, at the traverse of the second vehicle.
pub(crate) fn warnings(
    violations: &[SeparationViolation],
    drives: &[Drive],
    network: &Network,
    program: &Program,
) -> Vec<Diagnostic> {
    violations
        .iter()
        .filter_map(|violation| {
            let [first, second] = violation.vehicles;
            let under_way =
                |drive: &&Drive| drive.vehicles.contains(&second) && drive.start.to_f64() <= violation.time;
            let own = |drive: &&Drive| drive.vehicles.contains(&second);
            let others = |drive: &&Drive| drive.vehicles.contains(&first);
            let drive = drives.iter().rev().find(under_way);
            let drive = drive.or_else(|| drives.iter().find(own)).or_else(|| drives.iter().find(others))?;
            let span = network.occurrences.get(drive.occurrence.index())?.span?;
            let message = violation.words(&program.world, network);
            Some(Diagnostic::warning(SeparationViolation::CODE, span, message).with_hint(
                "delay one of them or route it differently; vehicles of one traverse keep formation",
            ))
        })
        .collect()
}

/// Returns what each vehicle does from the start of the plan to its end, in order.
fn parts(
    (drives, tracks): (&[Drive], Vec<Vec<Vec<Place>>>),
    motions: &[VehicleMotion],
    program: &Program,
    network: &Network,
) -> BTreeMap<u32, Vec<Part>> {
    let mut parts: BTreeMap<u32, Vec<Part>> = BTreeMap::new();
    let mut stands: BTreeMap<u32, (NodeId, Point2<f64>)> = BTreeMap::new();
    let starts = standing::starts(program, &network.occurrences);
    let paths = min_of_paths(network);
    for (drive, tracks) in drives.iter().zip(tracks) {
        let of = &network.occurrences[drive.occurrence.index()];
        let bounds = of.arc.map_or(0.0, |arc| network.arcs[arc.index()].lower.to_f64());
        // By its own bounds and by its path.
        let least = paths.get(&drive.occurrence).copied().unwrap_or_default().max(bounds);
        for (index, (&vehicle, mut track)) in drive.vehicles.iter().zip(tracks).enumerate() {
            let Some(first) = track.first().map(|place| place.position_m) else { continue };
            let (since, stands_m) = stands.get(&vehicle).copied().unwrap_or_else(|| {
                let start = starts.get(vehicle as usize).copied().flatten();
                (network.start, driving::place_before(drive, index, first, start))
            });
            if distance(&stands_m, &first) > driving::EVEN_M {
                track = driving::joined_from(&track, stands_m);
            }
            let own = parts.entry(vehicle).or_default();
            own.push(Part::standing(stands_m, since, of.start));
            let end_m = track.last().map_or(first, |place| place.position_m);
            let length_m = drive.path.length_m();
            let (movement, until) = (Some(drive.occurrence), [of.start, of.end]);
            own.push(Part { movement, track, length_m, from: of.start, until, least });
            stands.insert(vehicle, (of.end, end_m));
        }
    }
    for (&vehicle, &(since, place_m)) in &stands {
        parts.entry(vehicle).or_default().push(Part::standing(place_m, since, network.end));
    }
    for motion in motions.iter().filter(|motion| !stands.contains_key(&motion.vehicle)) {
        let Some(frame) = motion.keyframes.first() else { continue };
        let part = Part::standing(frame.position_m, network.start, network.end);
        parts.insert(motion.vehicle, vec![part]);
    }
    parts
}

/// Returns how long the path of each traverse takes at least in every schedule, in mission units.
fn min_of_paths(network: &Network) -> BTreeMap<OccurrenceId, f64> {
    let mut least: BTreeMap<OccurrenceId, f64> = BTreeMap::new();
    for arc in network.arcs.iter().filter(|arc| arc.kind == ArcKind::Path) {
        if let Some(occurrence) = arc.occurrence {
            *least.entry(occurrence).or_default() += arc.lower.to_f64();
        }
    }
    least
}

/// Returns where two vehicles can be too near each other at once while they do these parts, and how near at the
/// nearest.
fn meeting(gaps: &Gaps, vehicles: [u32; 2], parts: [&Part; 2], safety_m: f64) -> Option<Meeting> {
    let points = |part: &Part| part.track.iter().map(|place| place.position_m).collect::<Vec<_>>();
    let tracks = parts.map(points);
    let mut near: Vec<(motion::NearPieces, [Stretch; 2])> = Vec::new();
    motion::near_pieces(&tracks[0], &tracks[1], safety_m - ROUNDING_M, PIECE_M, &mut |pieces| {
        let stretches =
            [0, 1].map(|index| parts[index].stretch(pieces.segments[index], pieces.shares[index]));
        let [one, other] = &stretches;
        if !gaps.is_before(one, other) && !gaps.is_before(other, one) {
            near.push((pieces, stretches));
        }
    });
    near.sort_by(|(one, _), (other, _)| one.distance_m.total_cmp(&other.distance_m));
    let (pieces, (times, time)) =
        near.iter().find_map(|(pieces, [one, other])| Some((pieces, gaps.meeting(one, other)?)))?;
    let place = |part: &&Part| {
        let at = |event: NodeId| times.get(&event).copied().unwrap_or_default();
        let occurrence = part.movement?;
        Some(MovementTimes { occurrence, start: at(part.until[0]), end: at(part.until[1]) })
    };
    let [a, b] = pieces.places_m;
    let mut places_m = [Vec::new(), Vec::new()];
    for (pieces, _) in &near {
        for (places_m, &place_m) in places_m.iter_mut().zip(&pieces.places_m) {
            if places_m.iter().all(|known| distance(known, &place_m) >= APART_M) {
                places_m.push(place_m);
            }
        }
    }
    let violation = SeparationViolation {
        vehicles,
        since: time,
        time,
        position_m: nalgebra::center(&a, &b),
        distance_m: pieces.distance_m,
        min_m: safety_m,
        schedule: parts.iter().filter_map(place).collect(),
    };
    let (movements, orders) = (parts.map(|part| part.movement), Vec::new());
    Some(Meeting { vehicles, movements, places_m, orders, violation })
}

/// The orders of two traverses that may keep two vehicles apart. Of two that drive, the one that is before the other in the
/// text's order goes first; a vehicle that stands in the way drives on before, or comes there after.
fn orders(of: [(&[Part], usize); 2]) -> Vec<(OccurrenceId, OccurrenceId)> {
    let [(own, index), (others, other_index)] = of;
    let beside = |moving: OccurrenceId, parts: &[Part], standing: usize| {
        let next = parts.get(standing + 1).and_then(|next| next.movement).map(|next| (next, moving));
        let before = standing.checked_sub(1).and_then(|at| parts.get(at)).and_then(|before| before.movement);
        next.into_iter().chain(before.map(|before| (moving, before))).collect::<Vec<_>>()
    };
    match (own[index].movement, others[other_index].movement) {
        (Some(one), Some(other)) => vec![(one, other), (other, one)],
        (Some(moving), None) => beside(moving, others, other_index),
        (None, Some(moving)) => beside(moving, own, index),
        (None, None) => {
            let (next, other_next) = (own.get(index + 1), others.get(other_index + 1));
            let before = |parts: &[Part], at: usize| at.checked_sub(1).and_then(|at| parts[at].movement);
            let leaves_first = next.and_then(|it| it.movement).zip(before(others, other_index));
            let other_first = other_next.and_then(|it| it.movement).zip(before(own, index));
            leaves_first.into_iter().chain(other_first).collect()
        }
    }
}

/// What two vehicles come to in the earliest schedule is told of that.
fn in_earliest_schedule(meetings: &mut [Meeting], drives: &[Drive], motions: &[VehicleMotion]) {
    let last = drives.iter().map(|drive| drive.end.to_f64()).fold(0.0, f64::max);
    let of_vehicles: BTreeMap<u32, &VehicleMotion> =
        motions.iter().map(|motion| (motion.vehicle, motion)).collect();
    let track = |vehicle: u32| of_vehicles.get(&vehicle).map(|motion| track(motion, last));
    for meeting in meetings {
        let [Some(one), Some(other)] = meeting.vehicles.map(track) else { continue };
        let Some(near) = motion::closest_approach(&one, &other, meeting.violation.min_m) else { continue };
        let Some(since) = near.violation else { continue };
        let is_under_way = |movement: &Option<OccurrenceId>| {
            movement.is_none_or(|occurrence| {
                let drive = drives.iter().find(|drive| drive.occurrence == occurrence);
                drive.is_some_and(|drive| {
                    (drive.start.to_f64()..=drive.end.to_f64()).contains(&near.closest.time_s)
                })
            })
        };
        if !meeting.movements.iter().all(is_under_way) {
            continue;
        }
        let [a, b] = near.closest.positions_m;
        meeting.violation.since = since.time_s;
        meeting.violation.time = near.closest.time_s;
        meeting.violation.position_m = nalgebra::center(&a, &b);
        meeting.violation.distance_m = near.closest.distance_m;
        meeting.violation.schedule = Vec::new();
    }
}

/// The positions of a vehicle from the mission's start till all have stopped.
fn track(motion: &VehicleMotion, last: f64) -> Vec<TimedPoint> {
    let frames = motion.keyframes.iter();
    let mut points: Vec<TimedPoint> = frames
        .map(|frame| TimedPoint { time_s: frame.time.to_f64(), position_m: frame.position_m })
        .collect();
    if let (Some(&first), Some(&end)) = (points.first(), points.last()) {
        points.insert(0, TimedPoint { time_s: 0.0, ..first });
        points.push(TimedPoint { time_s: last.max(end.time_s), ..end });
    }
    points
}
