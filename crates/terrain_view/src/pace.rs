//! How much is drawn: less where frames come slowly while something moves.

/// What is left out, from nothing to most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Savings {
    #[default]
    None,
    /// The ground has no grain and rocks throw no shadows; three quarters of the pixels in each direction.
    Some,
    /// Half of the pixels in each direction, as well.
    Most,
}

impl Savings {
    /// Returns which part of the pixels is drawn in each direction.
    pub const fn resolution(self) -> f32 {
        match self {
            Self::None => 1.0,
            Self::Some => 0.75,
            Self::Most => 0.5,
        }
    }

    const fn more(self) -> Self {
        match self {
            Self::None => Self::Some,
            Self::Some | Self::Most => Self::Most,
        }
    }
}

/// Watches the time between frames while something moves. It saves more as long as they are slow, and never less again,
/// so that the image does not go to and fro.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    savings: Savings,
    last_secs: Option<f64>,
    frames: u32,
    total_secs: f64,
}

/// Slower frames than this, on average, are too slow.
const SLOW_SECS: f64 = 1.0 / 22.0;
/// So many frames are looked at together.
const WINDOW_FRAMES: u32 = 24;
/// Longer pauses are none of the drawing's: the page was hidden, or the core has answered.
const PAUSE_SECS: f64 = 0.5;

impl Pace {
    /// Notes a frame at a time of the host's clock; `is_moving` says that the next frame is due at once.
    pub fn note(&mut self, now_secs: f64, is_moving: bool) {
        let since_secs = self.last_secs.map(|last_secs| now_secs - last_secs);
        self.last_secs = is_moving.then_some(now_secs);
        let Some(frame_secs) = since_secs.filter(|secs| (0.0..PAUSE_SECS).contains(secs)) else { return };
        self.frames += 1;
        self.total_secs += frame_secs;
        if self.frames == WINDOW_FRAMES {
            if self.total_secs > SLOW_SECS * f64::from(WINDOW_FRAMES) {
                self.savings = self.savings.more();
            }
            (self.frames, self.total_secs) = (0, 0.0);
        }
    }

    /// Returns what is to be left out.
    pub const fn savings(&self) -> Savings {
        self.savings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(frame_secs: f64, frames: u32, is_moving: bool) -> Savings {
        let mut pace = Pace::default();
        for frame in 0..=frames {
            pace.note(f64::from(frame) * frame_secs, is_moving);
        }
        pace.savings()
    }

    #[test]
    fn slow_frames_in_motion_turn_effects_down_in_steps_and_fast_ones_do_not() {
        assert_eq!(after(1.0 / 60.0, 600, true), Savings::None);
        assert_eq!(after(0.1, WINDOW_FRAMES - 1, true), Savings::None, "a moment says nothing");
        assert_eq!(after(0.1, WINDOW_FRAMES, true), Savings::Some);
        assert_eq!(after(0.1, 5 * WINDOW_FRAMES, true), Savings::Most);
    }

    #[test]
    fn frames_that_are_only_rare_are_not_slow() {
        assert_eq!(after(0.1, 600, false), Savings::None, "nothing moves");
        assert_eq!(after(2.0, 600, true), Savings::None, "the page was hidden");
    }
}
