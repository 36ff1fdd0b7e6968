//! What a stop asks, and how an answer is judged: the `ask` block of a lesson.
//!
//! No answer is in a lesson where it can be computed: a number and a word are expressions, a choice can be right
//! when an expression holds, and a task is done when one holds.

use exact::Rational;
use serde_json::Value as Json;

use super::expression::{Expression, Value};
use super::facts::Known;
use super::show::command_of;
use super::{LessonError, entries};

/// A question, or a task.
#[derive(Clone, Debug, PartialEq)]
pub struct Ask {
    /// The line of its fence, from 1.
    pub line: u32,
    /// What is asked, in Markdown of one paragraph.
    pub text: String,
    /// What is right.
    pub answer: Answer,
    pub hint: String,
    /// Says, once it is answered, why that is right.
    pub because: String,
    /// What does the task, if it is one that can be shown.
    pub solution: Vec<Action>,
}

/// What is right.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// One of several.
    Choice(Vec<Choice>),
    /// A number, with or without a unit; what differs from it by no more than the second one counts too.
    Number(Expression, Rational),
    /// A name or a word, or several with commas between them. Capitals, spaces, quotation marks and the order of several
    /// make no difference.
    Word(Expression),
    /// Something to do; it is done when this holds.
    Task(Expression),
    /// What comes next, again and again, before the panels show it.
    Prediction(Forecast),
}

/// What is predicted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Forecast {
    /// The next alternative that the search takes of a decision.
    Decision,
    /// The last choice of the next state that fails.
    Failure,
    /// The mode of this component in the most likely state after the next step.
    Estimate(String),
}

impl Forecast {
    /// Returns what someone predicts who expects no more of it.
    pub const fn nothing(&self) -> Option<&'static str> {
        match self {
            Self::Decision => Some("No further decision"),
            Self::Failure => Some("No further failure"),
            Self::Estimate(_) => None,
        }
    }

    fn read(text: &str) -> Option<Self> {
        match text {
            "decision" => Some(Self::Decision),
            "failure" => Some(Self::Failure),
            other => {
                let component = other.strip_prefix("estimate of ")?.trim();
                (!component.is_empty()).then(|| Self::Estimate(component.to_owned()))
            }
        }
    }
}

/// One of several answers.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    pub text: String,
    /// Whether it is right: always, never, or when this holds.
    pub is_right: Expression,
}

/// What does a task.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// In the mission text, the first of these words become the second.
    Replace(String, String),
    /// The line of a command, its name and its arguments.
    Command(u32, String, Json),
}

impl Answer {
    /// Returns whether what was answered is right, and nothing while that is not known: the number of a choice from 0,
    /// a number or a word; a task is judged by the state alone, and a prediction by what is shown next.
    pub fn is_right(&self, given: &str, known: &dyn Known) -> Option<bool> {
        match self {
            Self::Choice(choices) => choices.get(given.parse::<usize>().ok()?)?.is_right.holds(known),
            Self::Number(expression, within) => {
                let right = expression.number(known)?;
                let Some(given) = number_in(given) else { return Some(false) };
                let off = given.checked_sub(right)?;
                let off = if off.is_negative() { off.checked_neg()? } else { off };
                Some(off <= *within)
            }
            Self::Word(expression) => {
                let right = expression.value(known)?.to_string();
                Some(words_in(&right) == words_in(given))
            }
            Self::Task(expression) => expression.holds(known),
            Self::Prediction(_) => None,
        }
    }

    /// Returns what would be right now, as someone would give it; nothing while that is not known, for a task, and for
    /// a prediction.
    pub fn right_now(&self, known: &dyn Known) -> Option<String> {
        match self {
            Self::Choice(choices) => {
                let right = choices.iter().position(|choice| choice.is_right.holds(known) == Some(true))?;
                Some(right.to_string())
            }
            Self::Number(expression, _) => expression.number(known).map(|number| number.to_string()),
            Self::Word(expression) => expression.value(known).map(|value| value.to_string()),
            Self::Task(_) | Self::Prediction(_) => None,
        }
    }
}

/// Numbers that people write as words.
const NUMBERS: [&str; 13] = [
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve",
];

/// The number that someone gave: `20`, `2,5`, `−3 min`, `80 %`, `two`. Behind it may stand a unit, and nothing else.
fn number_in(given: &str) -> Option<Rational> {
    let given = given.trim().trim_end_matches('.').replace('−', "-").replace(',', ".").to_lowercase();
    if let Some(number) = NUMBERS.iter().position(|word| *word == given) {
        return Some(Rational::from_integer(number as i64));
    }
    let end = given.find(|it: char| !it.is_ascii_digit() && !".-+/ ".contains(it)).unwrap_or(given.len());
    let (number, unit) = given.split_at(end);
    let is_unit = unit.chars().all(|it| it.is_alphabetic() || "%° ".contains(it));
    number.trim().parse().ok().filter(|_| is_unit)
}

/// Returns what someone said, however it is spelled: `(x = a)` is `x=a`, and `b, a` is `a, b`.
fn words_in(given: &str) -> Vec<String> {
    let plain: String = given.to_lowercase().chars().filter(|it| !"`\"“”„'’".contains(*it)).collect();
    let plain = plain.trim().trim_end_matches('.');
    let mut words = Vec::new();
    let (mut depth, mut word) = (0, String::new());
    for letter in plain.chars() {
        depth += match letter {
            '(' | '[' => 1,
            ')' | ']' => -1,
            _ => 0,
        };
        // Within parentheses a comma belongs to a name.
        if letter == ',' && depth <= 0 {
            words.push(std::mem::take(&mut word));
        } else {
            word.push(letter);
        }
    }
    words.push(word);
    let mut words: Vec<String> = words.iter().map(|word| spelled(word)).collect();
    words.sort_unstable();
    words
}

/// A name without the spaces that make no difference, and without parentheses around all of it.
fn spelled(word: &str) -> String {
    let mut out = String::with_capacity(word.len());
    let is_part_of_word = |it: char| it.is_alphanumeric() || it == '_' || it == '-';
    for part in word.split_whitespace() {
        let meets = out.ends_with(is_part_of_word) && part.starts_with(is_part_of_word);
        out.push_str(if meets { " " } else { "" });
        out.push_str(part);
    }
    match out.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) {
        Some(inside) if !inside.contains(['(', ')']) => inside.to_owned(),
        _ => out,
    }
}

/// Reads an `ask` block whose fence is in line `fence`; nothing if it cannot be judged.
pub(super) fn read(text: &str, fence: u32, errors: &mut Vec<LessonError>) -> Option<Ask> {
    let mut question = String::new();
    let mut choices: Vec<Choice> = Vec::new();
    let before = errors.len();
    let mut wrong = Vec::new();
    let entries = entries(text, fence, |line, text| {
        if let Some(written) = text.strip_prefix("- ") {
            match choice(written) {
                Ok(choice) => choices.push(choice),
                Err(message) => wrong.push(LessonError::new(line, message)),
            }
        } else if let Some(choice) = choices.last_mut().filter(|_| text.starts_with(' ')) {
            choice.text.push(' ');
            choice.text.push_str(text.trim());
        } else {
            question.push_str(if question.is_empty() { "" } else { " " });
            question.push_str(text.trim());
        }
    });
    errors.append(&mut wrong);
    let (mut answer, mut hint, mut because, mut solution) = (None, String::new(), String::new(), Vec::new());
    let mut within = Rational::ZERO;
    for (line, key, value) in entries {
        let expression = || {
            Expression::read(&value)
                .map_err(|message| LessonError::new(line, format!("in `{value}`: {message}")))
        };
        let mut note = |outcome: Result<Answer, LessonError>| match outcome {
            Ok(found) if answer.is_none() => answer = Some(found),
            Ok(_) => errors.push(LessonError::new(line, "a question must have exactly one answer")),
            Err(error) => errors.push(error),
        };
        match key {
            "number" => note(expression().map(|it| Answer::Number(it, Rational::ZERO))),
            "word" => note(expression().map(Answer::Word)),
            "task" => note(expression().map(Answer::Task)),
            "predict" => note(Forecast::read(&value).map(Answer::Prediction).ok_or_else(|| {
                let message = "`predict` must be `decision`, `failure` or `estimate of` a component";
                LessonError::new(line, message)
            })),
            "within" => match value.parse() {
                Ok(number) => within = number,
                Err(_) => errors.push(LessonError::new(line, format!("`{value}` is not a number"))),
            },
            "hint" => hint = value,
            "because" => because = value,
            "solution" => match action(line, &value) {
                Ok(action) => solution.push(action),
                Err(message) => errors.push(LessonError::new(line, message)),
            },
            other => {
                let message = format!(
                    "unknown key `{other}` in `ask`; use number, within, word, task, predict, hint, because, solution, or choices \
                     that start with `- [ ]`, `- [x]` or `- [if …]`"
                );
                errors.push(LessonError::new(line, message));
            }
        }
    }
    if let Some(Answer::Number(_, allowed)) = &mut answer {
        *allowed = within;
    }
    if !choices.is_empty() && answer.is_none() {
        if choices.len() < 2 {
            errors.push(LessonError::new(fence, "a question needs at least two choices"));
        }
        answer = Some(Answer::Choice(choices));
    }
    if question.is_empty() {
        errors.push(LessonError::new(fence, "the question is missing: write its text first"));
    }
    if answer.is_none() && errors.len() == before {
        errors.push(LessonError::new(
            fence,
            "the answer is missing: add `number:`, `word:`, `task:`, `predict:` or choices",
        ));
    }
    Some(Ask { line: fence, text: question, answer: answer?, hint, because, solution })
}

/// `[x] words`, `[ ] words` or `[if expression] words`.
fn choice(written: &str) -> Result<Choice, String> {
    let form = || format!("a choice must start with `- [ ]`, `- [x]` or `- [if …]`, not with `- {written}`");
    let (mark, text) = written.strip_prefix('[').and_then(|rest| rest.split_once(']')).ok_or_else(form)?;
    let is_right = match mark.trim() {
        "" => Expression::Constant(Value::Truth(false)),
        "x" => Expression::Constant(Value::Truth(true)),
        other => {
            let condition = other.strip_prefix("if ").ok_or_else(form)?;
            Expression::read(condition).map_err(|message| format!("in `{condition}`: {message}"))?
        }
    };
    Ok(Choice { text: text.trim().to_owned(), is_right })
}

/// `"10,20" becomes "10,35"`, or a command with its arguments.
fn action(line: u32, value: &str) -> Result<Action, String> {
    if !value.starts_with('"') {
        return command_of(value).map(|(id, arguments)| Action::Command(line, id, arguments));
    }
    let quoted = value.trim().strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
    match quoted.and_then(|inside| inside.split_once("\" becomes \"")) {
        Some((before, after)) => Ok(Action::Replace(before.to_owned(), after.to_owned())),
        None => Err(format!(
            "a solution must be `\"these words\" becomes \"those words\"` or a command, not `{value}`"
        )),
    }
}
