//! Lines of dashes: what tells paths apart without their colors.

use glam::Vec2;

/// Lengths of dashes and of the gaps between them, by turns, for paths that are shown side by side; none is a whole line.
pub const DASHES: [&[f32]; 4] = [&[], &[3.0, 1.6], &[0.6, 1.4], &[4.0, 1.4, 0.6, 1.4]];

/// The dashes along a line, where the unit of their lengths is `unit`.
pub fn dashed(line: &[Vec2], lengths: &[f32], unit: f32) -> Vec<[Vec2; 2]> {
    let pieces = line.windows(2).map(|pair| [pair[0], pair[1]]);
    if lengths.is_empty() || unit <= 0.0 {
        return pieces.collect();
    }
    let mut dashes = Vec::new();
    let (mut turn, mut left) = (0, lengths[0] * unit);
    for [from, to] in pieces {
        let length = from.distance(to);
        let mut at = 0.0;
        while at < length {
            let end = (at + left).min(length);
            if turn % 2 == 0 {
                dashes.push([from.lerp(to, at / length), from.lerp(to, end / length)]);
            }
            left -= end - at;
            at = end;
            // What rounding leaves of a dash must not hold it up.
            if left <= 1e-3 * unit {
                turn = (turn + 1) % lengths.len();
                left = lengths[turn] * unit;
            }
        }
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covered(dashes: &[[Vec2; 2]]) -> f32 {
        dashes.iter().map(|[from, to]| from.distance(*to)).sum()
    }

    #[test]
    fn dashes_go_on_around_corners_and_cover_their_share() {
        let line = [Vec2::ZERO, Vec2::new(7.0, 0.0), Vec2::new(7.0, 13.0)];
        let dashes = dashed(&line, &[1.0, 1.0], 2.0);
        assert!((covered(&dashes) - 10.0).abs() < 1e-4, "{dashes:?}");
        assert_eq!(dashes[1], [Vec2::new(4.0, 0.0), Vec2::new(6.0, 0.0)]);
        assert_eq!(dashes[2], [Vec2::new(7.0, 1.0), Vec2::new(7.0, 3.0)], "the gap goes around the corner");
        assert!((covered(&dashed(&line, &[], 2.0)) - 20.0).abs() < 1e-4);
    }

    #[test]
    fn every_line_is_of_its_own_kind() {
        let line = [Vec2::ZERO, Vec2::new(100.0, 0.0)];
        let mut kinds: Vec<_> = DASHES.map(|lengths| dashed(&line, lengths, 1.0)).to_vec();
        kinds.dedup();
        assert_eq!(kinds.len(), DASHES.len());
    }
}
