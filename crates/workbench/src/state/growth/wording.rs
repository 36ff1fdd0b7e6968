//! What a search for a path has done, in words.

use nalgebra::Point2;

use super::{Counts, Shown};

impl Shown {
    /// Returns how far the search is: of a race, how far each is.
    pub fn words(&self) -> String {
        if let Some(reason) = self.refusal() {
            return reason.to_owned();
        }
        if self.is_race() {
            return format!("After {} of {} samples", self.samples(), self.total());
        }
        let Counts { samples, vertices, length_m, .. } = self.counts();
        let total = self.total();
        let mut text = format!("{samples} of {total} samples, {vertices} vertices");
        match length_m {
            Some(length_m) => text.push_str(&format!(", best path {length_m:.1} m")),
            None if samples == total && total > 0 => text.push_str(", no path found"),
            None => text.push_str(", no path yet"),
        }
        text
    }

    /// Returns what the last sample did, in a sentence: which place was sampled, which vertex is nearest, and where the
    /// tree was steered to. Nothing before the first sample, nor of a race.
    pub fn sentence(&self) -> Option<String> {
        let step = self.last().filter(|_| !self.is_race())?;
        let sample = format!("Sample {} is {}", self.samples(), place(step.sample_m));
        let nearest = place(step.nearest_m);
        let Some(to) = step.steered_m() else {
            return Some(format!(
                "{sample}. Nearest vertex: {nearest}. Blocked by an obstacle; nothing added."
            ));
        };
        let stride_m = (to - step.nearest_m).norm();
        let mut text = format!(
            "{sample}. Nearest vertex: {nearest}. Steered {stride_m:.1} m toward the sample, to {}.",
            place(to)
        );
        let others = step.added.len() - 1;
        if others > 0 && self.searches[0].roots_count() > 1 {
            text.push_str(&format!(" The other tree grew toward it by {}.", vertices(others)));
        }
        if !step.rewired.is_empty() {
            text.push_str(&format!(" Rewired: {} now on a shorter path.", are(step.rewired.len())));
        }
        if let Some(path_m) = &step.path_m {
            text.push_str(&format!(" Path found: {:.1}\u{a0}m.", motion::length_m(path_m)));
        }
        Some(text)
    }
}

fn place(point: Point2<f64>) -> String {
    format!("({:.1}, {:.1})", point.x, point.y)
}

fn vertices(count: usize) -> String {
    if count == 1 { "1 vertex".to_owned() } else { format!("{count} vertices") }
}

fn are(count: usize) -> String {
    if count == 1 { "1 vertex is".to_owned() } else { format!("{count} vertices are") }
}
