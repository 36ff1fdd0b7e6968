//! A model of another tool in our notations.

/// A model of another tool as a mission in RMPL, or as a plant model in the prefix notation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Translation {
    pub text: String,
    /// What may be meant in another way than it is read.
    pub remarks: Vec<String>,
    /// What the text lacks, each with file and line.
    pub left_out: Vec<String>,
}
