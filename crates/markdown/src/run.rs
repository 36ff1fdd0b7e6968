//! Words that look alike.

/// Words that look alike and lead to the same place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Run {
    pub text: String,
    /// How they look.
    pub style: Style,
    /// Where a click on them leads.
    pub link: Option<String>,
}

/// How words look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    pub strong: bool,
    /// Slanted, or set apart in another way.
    pub emphasis: bool,
    pub code: bool,
}

/// The words without their looks.
pub fn plain(runs: &[Run]) -> String {
    runs.iter().map(|run| run.text.as_str()).collect()
}
