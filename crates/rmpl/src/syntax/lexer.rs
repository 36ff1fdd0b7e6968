//! Cuts a mission text into tokens (SPEC 1.1), one at a time, and never fails.
//!
//! A hyphen joins names outside square brackets and is minus inside. The depth of brackets is reset at `;`, `{` and
//! `}`, which no bound contains, so that one unclosed bracket does not change the names of the rest of the file.

use super::SyntaxKind;
use crate::files::MARK;

/// A place that the lexer cannot read, relative to the text it reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LexProblem {
    pub(crate) kind: LexProblemKind,
    pub(crate) start: u32,
    pub(crate) end: u32,
}

/// What the lexer cannot read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LexProblemKind {
    /// Characters that begin no token.
    Unknown,
    /// A name with letters or dashes outside the ASCII alphabet.
    ForeignName,
    /// A `/*` without `*/`.
    UnclosedComment,
    /// A `"` without its partner on the line.
    UnclosedString,
    /// A `control {` without its `}`.
    UnclosedControl,
    /// A number too long to be exact.
    HugeNumber,
}

/// The state of cutting one text.
pub(crate) struct Lexer<'t> {
    text: &'t str,
    position: usize,
    bracket_depth: u32,
    /// Whether the token before is a name.
    is_behind_name: bool,
    pub(crate) problems: Vec<LexProblem>,
}

const NAME_START: u8 = 1;
const NAME_PART: u8 = 2;
const SPACE: u8 = 4;
const DIGIT: u8 = 8;

const CLASSES: [u8; 256] = {
    let mut classes = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let letter = byte as u8;
        if letter.is_ascii_alphabetic() || letter == b'_' {
            classes[byte] |= NAME_START | NAME_PART;
        }
        if letter.is_ascii_digit() {
            classes[byte] |= NAME_PART | DIGIT;
        }
        if matches!(letter, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c) {
            classes[byte] |= SPACE;
        }
        byte += 1;
    }
    classes
};

fn is(byte: u8, class: u8) -> bool {
    CLASSES[byte as usize] & class != 0
}

/// Digits that always fit an exact rational with its decimals.
const MAX_DIGITS: usize = 15;

impl<'t> Lexer<'t> {
    pub(crate) fn new(text: &'t str) -> Self {
        Self { text, position: 0, bracket_depth: 0, is_behind_name: false, problems: Vec::new() }
    }

    /// The next token's kind and the offset of its end; `End` without width when nothing is left.
    pub(crate) fn next_token(&mut self) -> (SyntaxKind, u32) {
        let bytes = self.text.as_bytes();
        let start = self.position;
        let Some(&first) = bytes.get(start) else { return (SyntaxKind::End, start as u32) };
        let kind = if is(first, SPACE) {
            self.position = self.scan_while(start + 1, SPACE);
            SyntaxKind::Whitespace
        } else if is(first, NAME_START) {
            self.name(start)
        } else if is(first, DIGIT) {
            self.number(start)
        } else if first == MARK as u8 {
            // The heading of a file is not part of any text.
            let line = self.text.get(start..).and_then(|rest| rest.find('\n'));
            self.position = line.map_or(self.text.len(), |length| start + length);
            SyntaxKind::LineComment
        } else {
            self.punctuation(first, start)
        };
        self.is_behind_name = matches!(kind, SyntaxKind::Name | SyntaxKind::RightBracket);
        (kind, self.position as u32)
    }

    fn byte(&self, at: usize) -> u8 {
        self.text.as_bytes().get(at).copied().unwrap_or(0)
    }

    fn scan_while(&self, from: usize, class: u8) -> usize {
        let bytes = self.text.as_bytes();
        let mut at = from;
        while at < bytes.len() && is(bytes[at], class) {
            at += 1;
        }
        at
    }

    fn problem(&mut self, kind: LexProblemKind, start: usize) {
        self.problems.push(LexProblem { kind, start: start as u32, end: self.position as u32 });
    }

    fn name(&mut self, start: usize) -> SyntaxKind {
        let mut at = start + 1;
        let mut foreign = false;
        loop {
            at = self.scan_while(at, NAME_PART);
            let byte = self.byte(at);
            if byte == b'-' && self.bracket_depth == 0 && is(self.byte(at + 1), NAME_PART) {
                at += 2;
            } else if byte >= 0x80 && self.bracket_depth == 0 {
                let Some(letter) = self.text.get(at..).and_then(|rest| rest.chars().next()) else { break };
                if !(letter.is_alphanumeric() || is_dash(letter)) {
                    break;
                }
                foreign = true;
                at += letter.len_utf8();
            } else {
                break;
            }
        }
        self.position = at;
        if foreign {
            self.problem(LexProblemKind::ForeignName, start);
            return SyntaxKind::Name;
        }
        let length = at - start;
        if &self.text[start..at] == "control" && self.bracket_depth == 0 {
            let brace = self.scan_while(at, SPACE);
            if self.byte(brace) == b'{' {
                return self.control(start, brace);
            }
        }
        if (2..=11).contains(&length) && self.byte(start).is_ascii_lowercase() {
            return SyntaxKind::keyword(&self.text[start..at]).unwrap_or(SyntaxKind::Name);
        }
        SyntaxKind::Name
    }

    /// Everything up to the brace that closes the one at `brace`. What is inside is in prefix notation, where comments
    /// run from `;` to the end of the line.
    fn control(&mut self, start: usize, brace: usize) -> SyntaxKind {
        let bytes = self.text.as_bytes();
        let (mut depth, mut at) = (0_u32, brace);
        while let Some(&byte) = bytes.get(at) {
            at += 1;
            match byte {
                b'{' => depth += 1,
                b'}' => depth -= 1,
                b';' => at += bytes[at..].iter().position(|&byte| byte == b'\n').unwrap_or(bytes.len() - at),
                _ => {}
            }
            if depth == 0 {
                self.position = at;
                return SyntaxKind::ControlText;
            }
        }
        self.position = bytes.len();
        let kind = LexProblemKind::UnclosedControl;
        self.problems.push(LexProblem { kind, start: start as u32, end: brace as u32 + 1 });
        SyntaxKind::ControlText
    }

    fn number(&mut self, start: usize) -> SyntaxKind {
        let mut at = self.scan_while(start + 1, DIGIT);
        if self.byte(at) == b'.' && is(self.byte(at + 1), DIGIT) {
            at = self.scan_while(at + 1, DIGIT);
        }
        self.position = at;
        if at - start > MAX_DIGITS {
            self.problem(LexProblemKind::HugeNumber, start);
        }
        SyntaxKind::Number
    }

    fn punctuation(&mut self, first: u8, start: usize) -> SyntaxKind {
        self.position = start + 1;
        match first {
            b'{' => self.forget_brackets(SyntaxKind::LeftBrace),
            b'}' => self.forget_brackets(SyntaxKind::RightBrace),
            b';' => self.forget_brackets(SyntaxKind::Semicolon),
            b'[' => {
                self.bracket_depth += 1;
                SyntaxKind::LeftBracket
            }
            b']' => {
                self.bracket_depth = self.bracket_depth.saturating_sub(1);
                SyntaxKind::RightBracket
            }
            b'(' => SyntaxKind::LeftParen,
            b')' => SyntaxKind::RightParen,
            b',' => SyntaxKind::Comma,
            b':' => SyntaxKind::Colon,
            b'=' => SyntaxKind::Equals,
            b'%' => SyntaxKind::Percent,
            b'+' => SyntaxKind::Plus,
            b'-' => SyntaxKind::Minus,
            b'*' => SyntaxKind::Star,
            b'!' if self.byte(start + 1) == b'=' => {
                self.position = start + 2;
                SyntaxKind::NotEquals
            }
            b'!' => SyntaxKind::Bang,
            b'<' | b'>' => {
                let is_or_equal = self.byte(start + 1) == b'=';
                self.position = start + 1 + usize::from(is_or_equal);
                SyntaxKind::Order
            }
            b'.' if self.byte(start + 1) == b'.' => {
                self.position = start + 2;
                SyntaxKind::DotDot
            }
            b'.' if self.is_behind_name => SyntaxKind::Dot,
            b'/' => self.slash(start),
            b'"' => self.string(start),
            _ => self.unknown(start),
        }
    }

    fn forget_brackets(&mut self, kind: SyntaxKind) -> SyntaxKind {
        self.bracket_depth = 0;
        kind
    }

    fn slash(&mut self, start: usize) -> SyntaxKind {
        let rest = &self.text.as_bytes()[start..];
        match rest.get(1) {
            Some(b'/') => {
                let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
                self.position = start + length;
                SyntaxKind::LineComment
            }
            Some(b'*') => {
                let close = rest[2..].windows(2).position(|pair| pair == b"*/");
                self.position = close.map_or(self.text.len(), |at| start + 2 + at + 2);
                if close.is_none() {
                    self.problems.push(LexProblem {
                        kind: LexProblemKind::UnclosedComment,
                        start: start as u32,
                        end: start as u32 + 2,
                    });
                }
                SyntaxKind::BlockComment
            }
            _ => SyntaxKind::Slash,
        }
    }

    fn string(&mut self, start: usize) -> SyntaxKind {
        let rest = &self.text.as_bytes()[start + 1..];
        let stop = rest.iter().position(|&byte| byte == b'"' || byte == b'\n').unwrap_or(rest.len());
        if rest.get(stop) == Some(&b'"') {
            self.position = start + 1 + stop + 1;
        } else {
            self.position = start + 1 + stop;
            self.problem(LexProblemKind::UnclosedString, start);
        }
        SyntaxKind::String
    }

    fn unknown(&mut self, start: usize) -> SyntaxKind {
        let rest = self.text.get(start..).unwrap_or("");
        if rest.starts_with('∞') {
            self.position = start + '∞'.len_utf8();
            return SyntaxKind::Infinity;
        }
        if let Some(blank) =
            rest.chars().next().filter(|&letter| letter == '\u{feff}' || letter.is_whitespace())
        {
            self.position = start + blank.len_utf8();
            return SyntaxKind::Whitespace;
        }
        let length =
            rest.find(begins_token).unwrap_or(rest.len()).max(rest.chars().next().map_or(1, char::len_utf8));
        self.position = start + length;
        self.problem(LexProblemKind::Unknown, start);
        SyntaxKind::Unknown
    }
}

/// Returns whether `letter` is one of the dashes that word processors put in place of a hyphen.
pub(crate) fn is_dash(letter: char) -> bool {
    matches!(letter, '\u{2010}'..='\u{2015}' | '\u{2212}')
}

fn begins_token(letter: char) -> bool {
    letter.is_ascii_alphanumeric()
        || letter.is_whitespace()
        || letter == '∞'
        || letter == '\u{feff}'
        || "_{}[]();:,=%+-*!/\"".contains(letter)
}
