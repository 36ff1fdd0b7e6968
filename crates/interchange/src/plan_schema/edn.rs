//! Reading EDN, the data notation of Clojure, into the JSON value that says the same: keywords and symbols become
//! strings without their colon, sets and lists become arrays, keys become strings.

use serde_json::{Map, Number, Value};

/// Nesting deeper than this is refused rather than followed.
const DEEPEST: usize = 200;

/// Why a text is not EDN.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("at byte {at}: {problem}")]
pub struct EdnError {
    /// Offset into the text.
    pub at: usize,
    /// What is wrong there.
    pub problem: String,
}

/// Reads one EDN value; comments (`;`) and discarded forms (`#_`) are skipped, tags are dropped.
pub(super) fn parse(text: &str) -> Result<Value, EdnError> {
    let mut reader = Reader { text, at: 0 };
    let value = reader.value(0)?;
    reader.skip_blank(0)?;
    if reader.at < text.len() {
        return Err(reader.error("unexpected content after the value"));
    }
    Ok(value)
}

struct Reader<'text> {
    text: &'text str,
    at: usize,
}

impl Reader<'_> {
    fn error(&self, problem: &str) -> EdnError {
        EdnError { at: self.at, problem: problem.to_owned() }
    }

    fn rest(&self) -> &str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn eat(&mut self, prefix: &str) -> bool {
        let is_there = self.rest().starts_with(prefix);
        if is_there {
            self.at += prefix.len();
        }
        is_there
    }

    /// Skips white space, commas, comments and discarded forms.
    fn skip_blank(&mut self, depth: usize) -> Result<(), EdnError> {
        loop {
            let rest = self.rest();
            let trimmed =
                rest.trim_start_matches(|character: char| character.is_whitespace() || character == ',');
            self.at += rest.len() - trimmed.len();
            if self.peek() == Some(';') {
                self.at += self.rest().find('\n').unwrap_or(self.rest().len());
            } else if self.eat("#_") {
                self.value(depth + 1)?;
            } else {
                return Ok(());
            }
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value, EdnError> {
        if depth > DEEPEST {
            return Err(self.error("values are nested too deeply"));
        }
        self.skip_blank(depth)?;
        match self.peek() {
            None => Err(self.error("expected a value")),
            Some('{') => {
                self.at += 1;
                self.map(depth)
            }
            Some('[') => {
                self.at += 1;
                self.items(']', depth)
            }
            Some('(') => {
                self.at += 1;
                self.items(')', depth)
            }
            Some('"') => {
                self.at += 1;
                self.string().map(Value::String)
            }
            Some('\\') => {
                self.at += 1;
                self.character().map(Value::String)
            }
            Some('#') if self.eat("#{") => self.items('}', depth),
            Some('#') => {
                self.at += 1;
                self.token();
                self.value(depth + 1)
            }
            Some(_) => self.atom(),
        }
    }

    fn items(&mut self, close: char, depth: usize) -> Result<Value, EdnError> {
        let mut items = Vec::new();
        loop {
            self.skip_blank(depth)?;
            match self.peek() {
                Some(character) if character == close => {
                    self.at += close.len_utf8();
                    return Ok(Value::Array(items));
                }
                None => return Err(self.error(&format!("expected `{close}`"))),
                Some(_) => items.push(self.value(depth + 1)?),
            }
        }
    }

    fn map(&mut self, depth: usize) -> Result<Value, EdnError> {
        let start = self.at;
        let Value::Array(items) = self.items('}', depth)? else { return Err(self.error("expected `}`")) };
        if items.len() % 2 != 0 {
            return Err(EdnError { at: start, problem: "a key of this map needs a value".to_owned() });
        }
        let mut map = Map::new();
        let mut items = items.into_iter();
        while let (Some(key), Some(value)) = (items.next(), items.next()) {
            let key = match key {
                Value::String(key) => key,
                other => other.to_string(),
            };
            map.insert(key, value);
        }
        Ok(Value::Object(map))
    }

    fn string(&mut self) -> Result<String, EdnError> {
        let mut text = String::new();
        loop {
            let Some(character) = self.peek() else { return Err(self.error("expected `\"`")) };
            self.at += character.len_utf8();
            match character {
                '"' => return Ok(text),
                '\\' => {
                    let Some(escaped) = self.peek() else { return Err(self.error("expected `\"`")) };
                    self.at += escaped.len_utf8();
                    text.push(match escaped {
                        'n' => '\n',
                        't' => '\t',
                        'r' => '\r',
                        'u' => self.unicode()?,
                        '\\' | '"' => escaped,
                        _ => return Err(self.error("unknown escape in a string")),
                    });
                }
                _ => text.push(character),
            }
        }
    }

    fn unicode(&mut self) -> Result<char, EdnError> {
        let code = self.rest().get(..4).and_then(|digits| u32::from_str_radix(digits, 16).ok());
        let character = code.and_then(char::from_u32).ok_or_else(|| self.error("`\\u` needs four digits"))?;
        self.at += 4;
        Ok(character)
    }

    fn character(&mut self) -> Result<String, EdnError> {
        let Some(first) = self.peek() else { return Err(self.error("expected a character")) };
        self.at += first.len_utf8();
        let name = format!("{first}{}", self.token());
        Ok(match name.as_str() {
            "newline" => "\n".to_owned(),
            "space" => " ".to_owned(),
            "tab" => "\t".to_owned(),
            "return" => "\r".to_owned(),
            _ => name,
        })
    }

    fn token(&mut self) -> String {
        let is_end = |character: char| character.is_whitespace() || ",;\"()[]{}".contains(character);
        let token: String = self.rest().chars().take_while(|&character| !is_end(character)).collect();
        self.at += token.len();
        token
    }

    fn atom(&mut self) -> Result<Value, EdnError> {
        let start = self.at;
        let token = self.token();
        let is_number =
            token.trim_start_matches(['+', '-']).starts_with(|first: char| first.is_ascii_digit());
        Ok(match token.as_str() {
            "" => return Err(self.error("unmatched closing bracket")),
            "nil" => Value::Null,
            "true" => Value::Bool(true),
            "false" => Value::Bool(false),
            number if is_number => number_value(number, start)?,
            _ => Value::String(token.strip_prefix(':').unwrap_or(&token).to_owned()),
        })
    }
}

fn number_value(token: &str, start: usize) -> Result<Value, EdnError> {
    let digits = token.trim_end_matches(['N', 'M']).trim_start_matches('+');
    // Ratios and what no double holds stay text, which exact readers understand.
    if digits.contains('/') {
        return Ok(Value::String(digits.to_owned()));
    }
    if let Ok(whole) = digits.parse::<i64>() {
        return Ok(Value::from(whole));
    }
    let number = digits.parse().ok().and_then(Number::from_f64);
    number
        .map(Value::Number)
        .ok_or_else(|| EdnError { at: start, problem: format!("`{token}` is not a number") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn edn_says_the_same_as_json() {
        let text = "; a comment\n{:a #{:x y}, :b [15.0 1/3 -2], #_ :gone \"s\\n\" (nil true), :c #inst \"2020\" :d \\newline}";
        let expected =
            json!({"a": ["x", "y"], "b": [15.0, "1/3", -2], "s\n": [null, true], "c": "2020", "d": "\n"});
        assert_eq!(parse(text), Ok(expected));
    }

    #[test]
    fn broken_edn_is_refused_with_its_place() {
        for (text, at) in
            [("{:a", 3), ("{:a}", 1), ("[1 2", 4), ("\"x", 2), ("", 0), ("1 2", 2), ("]", 0), ("1x", 0)]
        {
            let error = parse(text).expect_err(text);
            assert_eq!(error.at, at, "{text}: {error}");
        }
    }

    #[test]
    fn deep_nesting_is_refused() {
        assert!(parse(&"[".repeat(100_000)).is_err());
        assert!(parse(&"#_".repeat(100_000)).is_err());
    }
}
