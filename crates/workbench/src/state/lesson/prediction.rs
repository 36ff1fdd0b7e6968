//! What a student predicted at a stop before it was shown, and how often that was right.

/// The predictions of a stop.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Predictions {
    /// The text that they are about: another one begins again.
    pub(crate) revision: u64,
    /// How many steps of the search, or of the program, were shown at most. No one predicts what was shown.
    pub(crate) seen: usize,
    /// What was predicted of a step of the program that the core still computes.
    pub(crate) pending: Option<String>,
    /// What was predicted and has been shown, in order.
    pub(crate) made: Vec<Prediction>,
    /// Whether nothing is left to predict: the last prediction was that nothing more comes, or nothing more came.
    pub(crate) is_over: bool,
}

/// A prediction, and what came.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Prediction {
    pub given: String,
    /// What the panels then showed.
    pub shown: String,
}

impl Prediction {
    /// Returns whether what was shown is what the student had predicted.
    pub fn is_right(&self) -> bool {
        self.given == self.shown
    }

    /// The same in words, with what came.
    pub fn verdict(&self) -> String {
        if self.is_right() {
            format!("Correct: {}.", self.shown)
        } else {
            format!("Incorrect. You predicted “{}”; the result is “{}”.", self.given, self.shown)
        }
    }
}

impl Predictions {
    /// Returns what was predicted and has been shown, in order.
    pub fn made(&self) -> &[Prediction] {
        &self.made
    }

    /// Returns how many of them were right.
    pub fn right(&self) -> usize {
        self.made.iter().filter(|prediction| prediction.is_right()).count()
    }

    /// Returns whether nothing is left to predict.
    pub const fn is_over(&self) -> bool {
        self.is_over
    }

    /// Returns whether the core still computes what was predicted.
    pub const fn is_pending(&self) -> bool {
        self.pending.is_some()
    }
}
