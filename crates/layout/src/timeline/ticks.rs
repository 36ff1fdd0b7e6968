//! Where the marks of a time axis stand, and what is written at them.

/// The marks of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Ticks {
    /// The times of the labeled marks, ascending.
    pub marks: Vec<f64>,
    /// From one labeled mark to the next.
    pub step: f64,
    /// Into how many parts small marks divide a step.
    pub parts: u32,
}

/// Least distance of two labeled marks, in points, for short numbers.
const MIN_DISTANCE: f32 = 64.0;
/// Points that a digit takes, at most.
const DIGIT_WIDTH: f32 = 8.0;
/// Between two labels, in points.
const GAP: f32 = 22.0;
/// More marks than this are never needed on a screen.
const MAX_MARKS: i64 = 400;

impl Ticks {
    /// Marks at round numbers from `from` to `to` on `width` points, so far apart that their labels cannot touch.
    pub fn new(from: f64, to: f64, width: f32) -> Self {
        let span = (to - from).max(f64::MIN_POSITIVE);
        let mut distance = MIN_DISTANCE;
        // Finer steps need more decimals, which need more room.
        for _ in 0..4 {
            let (step, _) = round_step(span * f64::from(distance / width.max(1.0)));
            let longest = label(from, step).len().max(label(to, step).len()) as f32;
            let needed = longest * DIGIT_WIDTH + GAP;
            if needed <= distance {
                break;
            }
            distance = needed;
        }
        let (step, parts) = round_step(span * f64::from(distance / width.max(1.0)));
        let first = (from / step).ceil();
        let count = (((to / step).floor() - first) as i64 + 1).clamp(0, MAX_MARKS);
        let marks = (0..count).map(|index| (first + index as f64) * step).collect();
        Self { marks, step, parts }
    }

    /// Returns what is written at a mark: as many decimals as the step needs, thousands apart.
    pub fn label(&self, mark: f64) -> String {
        label(mark, self.step)
    }
}

/// The smallest of 1, 2 and 5 times a power of ten that is not below `least`, and how many parts it has.
fn round_step(least: f64) -> (f64, u32) {
    let magnitude = 10_f64.powf(least.log10().floor());
    [(1.0, 5), (2.0, 4), (5.0, 5), (10.0, 5)]
        .into_iter()
        .map(|(factor, parts)| (factor * magnitude, parts))
        .find(|&(step, _)| step >= least * 0.999_999)
        .unwrap_or((10.0 * magnitude, 5))
}

fn label(value: f64, step: f64) -> String {
    let decimals = (-(step * 1.000_001).log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.decimals$}");
    let (whole, rest) = text.split_once('.').map_or((text.as_str(), ""), |(whole, rest)| (whole, rest));
    let (sign, digits) = whole.strip_prefix('-').map_or(("", whole), |digits| ("-", digits));
    let mut grouped = String::new();
    for (at, digit) in digits.chars().enumerate() {
        // Four digits are read at a glance; more need a gap.
        if at > 0 && (digits.len() - at).is_multiple_of(3) && digits.len() > 4 {
            grouped.push('\u{2009}');
        }
        grouped.push(digit);
    }
    let sign = if grouped == "0" && rest.chars().all(|digit| digit == '0') { "" } else { sign };
    if rest.is_empty() { format!("{sign}{grouped}") } else { format!("{sign}{grouped}.{rest}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_round_numbers() {
        let ticks = Ticks::new(0.0, 660.0, 660.0);
        assert_eq!((ticks.marks, ticks.step), (vec![0.0, 100.0, 200.0, 300.0, 400.0, 500.0, 600.0], 100.0));
        assert_eq!(Ticks::new(12.0, 31.0, 400.0).marks, vec![15.0, 20.0, 25.0, 30.0]);
        assert_eq!(Ticks::new(0.0, 1_234_567.0, 500.0).label(1_000_000.0), "1\u{2009}000\u{2009}000");
        assert_eq!(Ticks::new(0.0, 0.5, 300.0).label(0.2), "0.2");
    }

    #[test]
    fn labels_do_not_touch_at_any_zoom() {
        for exponent in -6..9 {
            for (part, width) in [(1.0, 300.0), (1.7, 777.0), (4.4, 1900.0)] {
                let span = part * 10_f64.powi(exponent);
                for from in [0.0, 1_234.5, 98_765.432] {
                    let ticks = Ticks::new(from, from + span, width);
                    let apart = (ticks.step / span) as f32 * width;
                    let longest = ticks.marks.iter().map(|&mark| ticks.label(mark).len()).max().unwrap_or(0);
                    assert!(apart >= longest as f32 * 7.0, "{span} on {width} points: {ticks:?}");
                    assert!(!ticks.marks.is_empty() || width < 400.0, "{span} on {width} points");
                }
            }
        }
    }
}
