//! Why files of JMPL cannot be read.

/// Why files cannot become a plant model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum JmplError {
    /// The file is not JMPL, or not well formed.
    #[error("{file}, line {line}: {what}")]
    Shape { file: String, line: u32, what: String },
    #[error("{file} declares enumerations only; import the file of a class together with it")]
    NoClass { file: String },
    #[error("{file} is not a harness (.hrn) or the initial modes (.ini) of Livingstone: {what}")]
    Harness { file: String, what: String },
    #[error("the model has more than {most} {what}; import a smaller part of it")]
    TooMany { what: &'static str, most: usize },
}

impl JmplError {
    pub(super) fn shape(file: &str, line: u32, what: &str) -> Self {
        Self::Shape { file: file.to_owned(), line, what: what.to_owned() }
    }
}
