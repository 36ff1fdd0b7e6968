//! What a lesson computes from the live state: facts by name, numbers and words, compared and counted together.
//!
//! ```text
//! condition  = "if" condition "then" condition "else" condition | conjunct { "or" conjunct }
//! conjunct = negation { "and" negation }
//! negation   = [ "not" ] comparison                comparison = sum [ ("=" | "!=" | "<" | "<=" | ">" | ">=") sum ]
//! sum        = product { ("+" | "-") product }     product = term { ("*" | "/") term }
//! term       = number | "text" | fact | fact(argument) | "-" term | "(" condition ")"
//! ```

use std::fmt;

use exact::Rational;

use super::facts::{self, Fact, Known};

/// What comes of an expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number, in mission units where it is a time.
    Number(Rational),
    Text(String),
    Truth(bool),
}

impl fmt::Display for Value {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => out.write_str(&number.readable()),
            Self::Text(text) => out.write_str(text),
            Self::Truth(truth) => out.write_str(if *truth { "yes" } else { "no" }),
        }
    }
}

/// Something that is computed from the state.
#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    /// Always the same.
    Constant(Value),
    /// What is known of the state, of something in it.
    Fact(&'static Fact, String),
    /// The other truth.
    Not(Box<Self>),
    Both(Box<Self>, Operator, Box<Self>),
    /// The second if the first holds, otherwise the third.
    Either(Box<[Self; 3]>),
}

/// How two values make one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    Or,
    And,
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Plus,
    Minus,
    Times,
    Over,
}

impl Expression {
    /// Reads an expression; `Err` says what is wrong with it.
    pub fn read(text: &str) -> Result<Self, String> {
        let mut reader = Reader { rest: text };
        let expression = reader.condition()?;
        match reader.rest.trim() {
            "" => Ok(expression),
            rest => Err(format!("unexpected `{rest}`")),
        }
    }

    /// Returns what it comes to now; nothing while something in it is not known, or does not exist.
    pub fn value(&self, known: &dyn Known) -> Option<Value> {
        match self {
            Self::Constant(value) => Some(value.clone()),
            Self::Fact(fact, argument) => known.value_of(fact.name, argument),
            Self::Either(parts) => {
                let [condition, then, otherwise] = &**parts;
                if condition.holds(known)? { then.value(known) } else { otherwise.value(known) }
            }
            Self::Not(expression) => Some(Value::Truth(!expression.holds(known)?)),
            Self::Both(left, Operator::And, right) => {
                Some(Value::Truth(left.holds(known)? && right.holds(known)?))
            }
            Self::Both(left, Operator::Or, right) => {
                Some(Value::Truth(left.holds(known)? || right.holds(known)?))
            }
            Self::Both(left, operator, right) => {
                combined(&left.value(known)?, *operator, &right.value(known)?)
            }
        }
    }

    /// Returns whether it is true now; nothing if that is not known.
    pub fn holds(&self, known: &dyn Known) -> Option<bool> {
        match self.value(known)? {
            Value::Truth(truth) => Some(truth),
            Value::Number(_) | Value::Text(_) => None,
        }
    }

    /// The number that it comes to now.
    pub fn number(&self, known: &dyn Known) -> Option<Rational> {
        match self.value(known)? {
            Value::Number(number) => Some(number),
            Value::Truth(_) | Value::Text(_) => None,
        }
    }
}

/// Returns what `left operator right` comes to; words are equal whatever their case.
fn combined(left: &Value, operator: Operator, right: &Value) -> Option<Value> {
    use Operator::{Equal, Greater, GreaterOrEqual, Less, LessOrEqual, Minus, NotEqual, Over, Plus, Times};
    let truth = |truth: bool| Some(Value::Truth(truth));
    match (left, right) {
        (Value::Number(left), Value::Number(right)) => match operator {
            Equal => truth(left == right),
            NotEqual => truth(left != right),
            Less => truth(left < right),
            LessOrEqual => truth(left <= right),
            Greater => truth(left > right),
            GreaterOrEqual => truth(left >= right),
            Plus => left.checked_add(*right).map(Value::Number),
            Minus => left.checked_sub(*right).map(Value::Number),
            Times => left.checked_mul(*right).map(Value::Number),
            Over => left.checked_div(*right).map(Value::Number),
            Operator::And | Operator::Or => None,
        },
        (Value::Text(left), Value::Text(right)) => match operator {
            Equal => truth(left.eq_ignore_ascii_case(right)),
            NotEqual => truth(!left.eq_ignore_ascii_case(right)),
            _ => None,
        },
        (Value::Truth(left), Value::Truth(right)) => match operator {
            Equal => truth(left == right),
            NotEqual => truth(left != right),
            _ => None,
        },
        _ => None,
    }
}

struct Reader<'a> {
    rest: &'a str,
}

const SUMS: &[(&str, Operator)] = &[("+", Operator::Plus), ("-", Operator::Minus)];
const PRODUCTS: &[(&str, Operator)] = &[("*", Operator::Times), ("/", Operator::Over)];
const COMPARISONS: &[(&str, Operator)] = &[
    ("!=", Operator::NotEqual),
    ("<=", Operator::LessOrEqual),
    (">=", Operator::GreaterOrEqual),
    ("=", Operator::Equal),
    ("<", Operator::Less),
    (">", Operator::Greater),
];

impl<'a> Reader<'a> {
    fn condition(&mut self) -> Result<Expression, String> {
        if self.takes_word("if") {
            let condition = self.condition()?;
            let then = self.part("then")?;
            let otherwise = self.part("else")?;
            return Ok(Expression::Either(Box::new([condition, then, otherwise])));
        }
        let mut left = self.conjunct()?;
        while self.takes_word("or") {
            left = both(left, Operator::Or, self.conjunct()?);
        }
        Ok(left)
    }

    fn part(&mut self, word: &str) -> Result<Expression, String> {
        if self.takes_word(word) { self.condition() } else { Err(format!("expected `{word}`")) }
    }

    fn conjunct(&mut self) -> Result<Expression, String> {
        let mut left = self.negation()?;
        while self.takes_word("and") {
            left = both(left, Operator::And, self.negation()?);
        }
        Ok(left)
    }

    fn negation(&mut self) -> Result<Expression, String> {
        if self.takes_word("not") {
            return Ok(Expression::Not(Box::new(self.negation()?)));
        }
        let left = self.sum()?;
        match self.takes_sign(COMPARISONS) {
            Some(operator) => Ok(both(left, operator, self.sum()?)),
            None => Ok(left),
        }
    }

    fn sum(&mut self) -> Result<Expression, String> {
        let mut left = self.product()?;
        while let Some(operator) = self.takes_sign(SUMS) {
            left = both(left, operator, self.product()?);
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<Expression, String> {
        let mut left = self.term()?;
        while let Some(operator) = self.takes_sign(PRODUCTS) {
            left = both(left, operator, self.term()?);
        }
        Ok(left)
    }

    fn term(&mut self) -> Result<Expression, String> {
        self.rest = self.rest.trim_start();
        let Some(first) = self.rest.chars().next() else {
            return Err("unexpected end".to_owned());
        };
        match first {
            '(' => {
                self.rest = &self.rest[1..];
                let inside = self.condition()?;
                self.rest = self.rest.trim_start();
                self.rest = self.rest.strip_prefix(')').ok_or("expected `)`")?;
                Ok(inside)
            }
            '-' => {
                self.rest = &self.rest[1..];
                let nought = Expression::Constant(Value::Number(Rational::ZERO));
                Ok(both(nought, Operator::Minus, self.term()?))
            }
            '"' => {
                let (text, rest) = self.rest[1..].split_once('"').ok_or("expected `\"`")?;
                self.rest = rest;
                Ok(Expression::Constant(Value::Text(text.to_owned())))
            }
            '0'..='9' => {
                let digits = self.taken(|letter| letter.is_ascii_digit() || letter == '.');
                let number = digits.parse().map_err(|_| format!("`{digits}` is not a number"))?;
                Ok(Expression::Constant(Value::Number(number)))
            }
            'a'..='z' => self.fact(),
            other => Err(format!("unexpected `{other}`")),
        }
    }

    fn fact(&mut self) -> Result<Expression, String> {
        let name = self.taken(|letter| letter.is_ascii_lowercase() || letter == '-').trim_end_matches('-');
        let fact = facts::by_name(name).ok_or_else(|| {
            let known: Vec<&str> = facts::all().map(|fact| fact.name).collect();
            format!("unknown name `{name}`; use one of {}", known.join(", "))
        })?;
        let argument = if self.rest.starts_with('(') { self.argument()? } else { "" };
        match (fact.of, argument) {
            (facts::Of::Nothing, "") | (facts::Of::Maybe(_), _) => {}
            (facts::Of::Nothing, _) => {
                return Err(format!("`{name}` takes no argument: write it without `(…)`"));
            }
            (facts::Of::Something(what), "") => {
                return Err(format!("`{name}` needs an argument: `{name}({what})`"));
            }
            (facts::Of::Something(_), _) => {}
        }
        Ok(Expression::Fact(fact, argument.to_owned()))
    }

    /// Returns what is in parentheses, which may hold others: names have them.
    fn argument(&mut self) -> Result<&'a str, String> {
        let mut depth = 0_u32;
        for (at, letter) in self.rest.char_indices() {
            match letter {
                '(' => depth += 1,
                ')' if depth == 1 => {
                    let inside = &self.rest[1..at];
                    self.rest = &self.rest[at + 1..];
                    return Ok(inside.trim());
                }
                ')' => depth -= 1,
                _ => {}
            }
        }
        Err("expected `)`".to_owned())
    }

    fn taken(&mut self, belongs: impl Fn(char) -> bool) -> &'a str {
        let end = self.rest.find(|letter| !belongs(letter)).unwrap_or(self.rest.len());
        let (taken, rest) = self.rest.split_at(end);
        self.rest = rest;
        taken
    }

    fn takes_word(&mut self, word: &str) -> bool {
        let after = self.rest.trim_start().strip_prefix(word);
        let after =
            after.filter(|after| !after.starts_with(|next: char| next.is_alphanumeric() || next == '-'));
        self.rest = after.unwrap_or(self.rest);
        after.is_some()
    }

    fn takes_sign(&mut self, signs: &[(&str, Operator)]) -> Option<Operator> {
        let rest = self.rest.trim_start();
        let (sign, operator) = signs.iter().find(|(sign, _)| rest.starts_with(sign))?;
        self.rest = &rest[sign.len()..];
        Some(*operator)
    }
}

fn both(left: Expression, operator: Operator, right: Expression) -> Expression {
    Expression::Both(Box::new(left), operator, Box::new(right))
}
