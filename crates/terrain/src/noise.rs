//! Gradient noise (Perlin 1985, 2002) and its fractal sums, from hashes of lattice points.

/// Noise of zero mean, within about -1 to 1, smooth to its second derivative, with features of length 1.
pub(crate) fn gradient_noise(seed: u32, x: f64, y: f64) -> f64 {
    let (left, low) = (x.floor(), y.floor());
    let (column, row) = (left as i32, low as i32);
    let (u, v) = (x - left, y - low);
    let corner = |east: i32, north: i32| {
        let hash = lattice_hash(seed, column.wrapping_add(east), row.wrapping_add(north));
        let [across, along] = DIRECTIONS[(hash >> 28) as usize];
        across * (u - f64::from(east)) + along * (v - f64::from(north))
    };
    let (fade_u, fade_v) = (fade(u), fade(v));
    let south = mix(corner(0, 0), corner(1, 0), fade_u);
    let north = mix(corner(0, 1), corner(1, 1), fade_u);
    1.5 * mix(south, north, fade_v)
}

/// A sum of octaves of noise, each of half the wavelength of the one before and `gain` times its height.
pub(crate) fn fractal_noise(seed: u32, x: f64, y: f64, octaves: u32, gain: f64) -> f64 {
    sum_octaves(seed, x, y, octaves, gain, |noise| noise)
}

/// Like [`fractal_noise`] with crests where the noise of an octave passes zero; mostly between -1 and 1.
pub(crate) fn ridged_noise(seed: u32, x: f64, y: f64, octaves: u32, gain: f64) -> f64 {
    sum_octaves(seed, x, y, octaves, gain, |noise| 1.0 - 4.0 * noise.abs().min(0.5))
}

/// 0 below `low`, 1 above `high`, smooth between.
pub(crate) fn smooth_step(low: f64, high: f64, value: f64) -> f64 {
    let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

fn sum_octaves(seed: u32, x: f64, y: f64, octaves: u32, gain: f64, shape: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut height, mut frequency) = (0.0, 1.0, 1.0);
    for octave in 0..octaves {
        // Lattices of different octaves are shifted against each other so that their zeros don't coincide.
        let shift = f64::from(octave) * 17.31;
        let noise = gradient_noise(seed.wrapping_add(octave), x * frequency + shift, y * frequency - shift);
        sum += height * shape(noise);
        height *= gain;
        frequency *= 2.0;
    }
    sum
}

const DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Sine and cosine of a sixteenth of a turn.
const SHORT: f64 = 0.382_683_432_365_089_8;
const LONG: f64 = 0.923_879_532_511_286_7;

/// Sixteen directions around the circle.
const DIRECTIONS: [[f64; 2]; 16] = [
    [1.0, 0.0],
    [LONG, SHORT],
    [DIAGONAL, DIAGONAL],
    [SHORT, LONG],
    [0.0, 1.0],
    [-SHORT, LONG],
    [-DIAGONAL, DIAGONAL],
    [-LONG, SHORT],
    [-1.0, 0.0],
    [-LONG, -SHORT],
    [-DIAGONAL, -DIAGONAL],
    [-SHORT, -LONG],
    [0.0, -1.0],
    [SHORT, -LONG],
    [DIAGONAL, -DIAGONAL],
    [LONG, -SHORT],
];

fn lattice_hash(seed: u32, column: i32, row: i32) -> u32 {
    let mut hash = seed
        .wrapping_mul(0x9e37_79b1)
        .wrapping_add((column as u32).wrapping_mul(0x85eb_ca77))
        .wrapping_add((row as u32).wrapping_mul(0xc2b2_ae3d));
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
    hash = (hash ^ (hash >> 12)).wrapping_mul(0x297a_2d39);
    hash ^ (hash >> 15)
}

fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn mix(a: f64, b: f64, share: f64) -> f64 {
    a + (b - a) * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_centered_and_bounded() {
        let samples: Vec<f64> = (0..10_000)
            .map(|index| gradient_noise(5, f64::from(index % 100) * 0.37, f64::from(index / 100) * 0.41))
            .collect();
        assert!((samples.iter().sum::<f64>() / 10_000.0).abs() < 0.05);
        assert!(samples.iter().all(|sample| sample.abs() <= 1.5));
        assert!(samples.iter().any(|sample| sample.abs() > 0.5));
    }

    #[test]
    fn noise_has_no_jumps_across_lattice_lines() {
        for line in -3..4 {
            let place = f64::from(line);
            let below = gradient_noise(9, place - 1e-7, 0.3);
            let above = gradient_noise(9, place + 1e-7, 0.3);
            assert!((below - above).abs() < 1e-5);
        }
    }
}
