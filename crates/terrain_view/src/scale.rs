//! How large things are drawn from how far away.

/// Returns how much larger than life vehicles are drawn: so large that they can be seen.
pub fn vehicle_scale(distance_m: f32) -> f32 {
    (distance_m / 45.0).clamp(1.0, 12.0)
}

/// Meters between grid lines.
pub fn grid_spacing_m(distance_m: f32) -> f32 {
    round_step(distance_m / 6.0)
}

/// The largest of 1, 2, 5, 10, … that is not above `value`.
pub fn round_step(value: f32) -> f32 {
    let power = 10.0_f32.powf(value.max(1e-3).log10().floor());
    let factor = [5.0, 2.0].into_iter().find(|factor| power * factor <= value).unwrap_or(1.0);
    power * factor
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_numbers_below_the_value() {
        for (value, expected) in
            [(1.0, 1.0), (3.0, 2.0), (7.0, 5.0), (49.0, 20.0), (0.7, 0.5), (900.0, 500.0)]
        {
            assert!((round_step(value) - expected).abs() < 1e-4, "{value}: {}", round_step(value));
        }
    }
}
