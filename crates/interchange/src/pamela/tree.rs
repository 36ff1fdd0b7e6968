//! Pamela's notation as trees: lists, vectors and maps of words and texts, each with its line.

use super::PamelaError;

/// Lists nest at most this deep.
const MAX_DEPTH: usize = 100;

/// A word, a text in quotation marks, or what stands between brackets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Tree {
    Word(String, u32),
    Text(String, u32),
    List(Vec<Tree>, u32),
    Vector(Vec<Tree>, u32),
    Map(Vec<Tree>, u32),
}

impl Tree {
    /// All trees of a file.
    pub(super) fn read(text: &str, file: &str) -> Result<Vec<Self>, PamelaError> {
        let shape = |line: u32, what: String| PamelaError { file: file.to_owned(), line, what };
        let mut open: Vec<(char, Vec<Self>, u32)> = Vec::new();
        let mut whole = Vec::new();
        let mut line = 1;
        let mut rest = text;
        while let Some(first) = rest.chars().next() {
            let mut done = None;
            let length = match first {
                ';' => rest.find('\n').unwrap_or(rest.len()),
                ',' | '\u{feff}' => first.len_utf8(),
                _ if first.is_whitespace() => first.len_utf8(),
                '(' | '[' | '{' => {
                    if open.len() == MAX_DEPTH {
                        return Err(shape(line, format!("lists nest more than {MAX_DEPTH} deep")));
                    }
                    open.push((closing(first), Vec::new(), line));
                    1
                }
                ')' | ']' | '}' => {
                    let Some((wanted, list, start)) = open.pop() else {
                        return Err(shape(line, format!("`{first}` closes nothing")));
                    };
                    if wanted != first {
                        return Err(shape(line, format!("expected `{wanted}`, found `{first}`")));
                    }
                    done = Some(match first {
                        ')' => Self::List(list, start),
                        ']' => Self::Vector(list, start),
                        _ => Self::Map(list, start),
                    });
                    1
                }
                '"' => {
                    let Some(end) = rest[1..].find('"') else {
                        return Err(shape(line, "this text is not closed with `\"`".to_owned()));
                    };
                    done = Some(Self::Text(rest[1..=end].to_owned(), line));
                    end + 2
                }
                _ => {
                    let is_end = |letter: char| letter.is_whitespace() || ",;()[]{}\"".contains(letter);
                    let length = rest.find(is_end).unwrap_or(rest.len());
                    done = Some(Self::Word(rest[..length].to_owned(), line));
                    length
                }
            };
            line += rest[..length].matches('\n').count() as u32;
            rest = &rest[length..];
            if let Some(done) = done {
                open.last_mut().map_or(&mut whole, |(_, list, _)| list).push(done);
            }
        }
        match open.last() {
            Some((wanted, _, line)) => Err(shape(*line, format!("this is not closed with `{wanted}`"))),
            None => Ok(whole),
        }
    }

    pub(super) const fn line(&self) -> u32 {
        match self {
            Self::Word(_, line)
            | Self::Text(_, line)
            | Self::List(_, line)
            | Self::Vector(_, line)
            | Self::Map(_, line) => *line,
        }
    }

    pub(super) fn word(&self) -> Option<&str> {
        match self {
            Self::Word(word, _) => Some(word),
            _ => None,
        }
    }

    /// A word such as `:bounds`, without the colon.
    pub(super) fn keyword(&self) -> Option<&str> {
        self.word()?.strip_prefix(':')
    }

    pub(super) fn vector(&self) -> Option<&[Self]> {
        match self {
            Self::Vector(list, _) => Some(list),
            _ => None,
        }
    }

    /// The entries of a map with keywords as keys.
    pub(super) fn entries(&self) -> Option<Vec<(&str, &Self)>> {
        let Self::Map(list, _) = self else { return None };
        list.chunks(2)
            .map(|pair| match pair {
                [key, value] => Some((key.word()?, value)),
                _ => None,
            })
            .collect()
    }

    /// Calls `visit` with each word, at any depth.
    pub(super) fn words<'tree>(&'tree self, visit: &mut dyn FnMut(&'tree str)) {
        match self {
            Self::Word(word, _) => visit(word),
            Self::Text(..) => {}
            Self::List(list, _) | Self::Vector(list, _) | Self::Map(list, _) => {
                for inner in list {
                    inner.words(visit);
                }
            }
        }
    }

    /// The first word of a list and what follows it.
    pub(super) fn headed(&self) -> Option<(&str, &[Self])> {
        let Self::List(list, _) = self else { return None };
        let (head, rest) = list.split_first()?;
        Some((head.word()?, rest))
    }
}

const fn closing(open: char) -> char {
    match open {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}
