//! Lists in parentheses, as PDDL is written: words in lower case, since PDDL does not tell cases apart.

use super::error::PddlError;

/// How deep lists may nest.
const MAX_DEPTH: usize = 200;

/// A word or a list, with the line that it begins in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Tree {
    Word(String, u32),
    List(Vec<Tree>, u32),
}

impl Tree {
    /// The one list of a file.
    pub(super) fn read(text: &str, file: &str) -> Result<Self, PddlError> {
        let shape =
            |line: u32, what: &str| PddlError::Shape { file: file.to_owned(), line, what: what.to_owned() };
        let mut open: Vec<(Vec<Self>, u32)> = Vec::new();
        let mut whole = None;
        for (index, row) in text.lines().enumerate() {
            let line = index as u32 + 1;
            for word in words(row.split(';').next().unwrap_or_default()) {
                if whole.is_some() {
                    return Err(shape(line, "there is text after the closing parenthesis of `(define …)`"));
                }
                let done = match word {
                    "(" if open.len() >= MAX_DEPTH => {
                        return Err(shape(line, &format!("lists nest deeper than {MAX_DEPTH} levels")));
                    }
                    "(" => {
                        open.push((Vec::new(), line));
                        continue;
                    }
                    ")" => match open.pop() {
                        Some((list, start)) => Self::List(list, start),
                        None => return Err(shape(line, "`)` closes nothing")),
                    },
                    word => Self::Word(word.to_ascii_lowercase(), line),
                };
                match open.last_mut() {
                    Some((list, _)) => list.push(done),
                    None if matches!(done, Self::List(..)) => whole = Some(done),
                    None => return Err(shape(line, "expected `(define …)`")),
                }
            }
        }
        match (whole, open.last()) {
            (Some(whole), _) => Ok(whole),
            (None, Some((_, line))) => Err(shape(*line, "unclosed `(`")),
            (None, None) => Err(shape(1, "expected `(define …)`")),
        }
    }

    pub(super) const fn line(&self) -> u32 {
        match self {
            Self::Word(_, line) | Self::List(_, line) => *line,
        }
    }

    pub(super) fn word(&self) -> Option<&str> {
        match self {
            Self::Word(word, _) => Some(word),
            Self::List(..) => None,
        }
    }

    pub(super) fn list(&self) -> Option<&[Self]> {
        match self {
            Self::List(list, _) => Some(list),
            Self::Word(..) => None,
        }
    }

    /// Returns whether it is `()`.
    pub(super) fn is_empty(&self) -> bool {
        self.list().is_some_and(<[Self]>::is_empty)
    }

    /// The first word of a list and what follows it.
    pub(super) fn headed(&self) -> Option<(&str, &[Self])> {
        let (head, rest) = self.list()?.split_first()?;
        Some((head.word()?, rest))
    }
}

impl std::fmt::Display for Tree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Word(word, _) => f.write_str(word),
            Self::List(list, _) => {
                f.write_str("(")?;
                for (index, tree) in list.iter().enumerate() {
                    write!(f, "{}{tree}", if index > 0 { " " } else { "" })?;
                }
                f.write_str(")")
            }
        }
    }
}

/// The parentheses of a row, and the words between parentheses and blanks.
fn words(row: &str) -> impl Iterator<Item = &str> {
    let is_end = |letter: char| letter.is_whitespace() || letter == '(' || letter == ')';
    let mut rest = row;
    std::iter::from_fn(move || {
        rest = rest.trim_start();
        let first = rest.chars().next()?;
        let length = match first {
            '(' | ')' => 1,
            _ => rest.find(is_end).unwrap_or(rest.len()),
        };
        let (word, after) = rest.split_at(length);
        rest = after;
        Some(word)
    })
}
