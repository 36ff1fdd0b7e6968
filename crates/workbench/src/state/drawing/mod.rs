//! Activities as they are drawn: created, moved, wrapped, bounded and deleted, each as edits of the mission's text.
//!
//! `site` finds the statement that a drawing represents, `list` adds to and removes from statements in a row, `wrap` puts
//! constructs around them, `call` lists calls and their arguments, and `visit` sends a vehicle to a place.

mod call;
mod list;
mod site;
mod visit;
mod wrap;

#[cfg(test)]
mod tests;

use rmpl::{Edit, Parse, Severity, Span};

pub use call::{Callable, NEW_BOUNDS, callables, gap};
pub use wrap::{Wrapping, conditions};

use site::Site;

/// A change of a mission's activities. Spans are those of statements, as selections have them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// Adds statements, separated by `;`.
    Insert { text: String, at: Place },
    /// Adds statements from elsewhere, and declares the activities that they call and the mission lacks.
    Paste { text: String, at: Place },
    /// Adds an activity that is not declared yet, with its declaration.
    New { at: Place },
    /// Moves a statement.
    Move { what: Span, at: Place },
    /// Deletes a statement, and what would be empty without it.
    Delete(Span),
    /// Puts a construct around a statement.
    Wrap(Span, Wrapping),
    /// Takes away the construct around what is in it.
    Unwrap(Span),
    /// Gives a statement bounds, such as `[1,5]`.
    Bound(Span, String),
    /// Lets one statement start only after another one has ended, even in another thread.
    Connect { from: Span, to: Span },
    /// Sends a vehicle to a location after all else that it does: the drive, and the visit.
    Visit { vehicle: String, location: String },
}

/// What can be asked of the drawings of a mission's activities.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DrawCommand {
    Make(Change),
    /// Adds a new activity after what is selected, or at the end.
    Add,
    /// Adds a new activity at the same time as what is selected, or in a thread of its own.
    AddBeside,
    /// Moves what is selected past its neighbor.
    Shift {
        forwards: bool,
    },
    /// Deletes what is selected.
    Delete,
    /// Puts the text of what is selected on the clipboard, and deletes it if it is cut.
    Copy {
        cut: bool,
    },
    /// Adds a text after what is selected, or at the end.
    Paste(String),
}

/// Where a statement goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    After(Span),
    Before(Span),
    /// At the same time as another one.
    Beside(Span),
    /// As another alternative to one.
    Instead(Span),
    /// At the end of the first scenario.
    End,
    /// In a thread of its own beside all that the first scenario does.
    Thread,
}

/// A change as edits of a text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Drawn {
    /// Disjoint, in textual order.
    pub edits: Vec<Edit>,
    /// What the author is to type over, by its place in the new text: a name, or bounds.
    pub typed_over: Vec<Span>,
    /// Where what was added or moved begins in the new text.
    pub made: Option<u32>,
}

impl Drawn {
    fn of(edits: Vec<Edit>) -> Self {
        Self { edits, ..Self::default() }
    }

    /// The text with the edits.
    pub fn apply(&self, text: &str) -> String {
        let mut changed = text.to_owned();
        for edit in self.edits.iter().rev() {
            changed.replace_range(edit.span.range(), &edit.text);
        }
        changed
    }

    /// The lines that the edits change, before and after: at most `most` of them.
    pub fn preview(&self, text: &str, most: usize) -> String {
        let changed = self.apply(text);
        let before: Vec<&str> = text.lines().collect();
        let after: Vec<&str> = changed.lines().collect();
        let same = |one: &mut dyn Iterator<Item = (&&str, &&str)>| one.take_while(|(a, b)| a == b).count();
        let head = same(&mut before.iter().zip(&after));
        let room = before.len().min(after.len()) - head;
        let tail = same(&mut before.iter().rev().zip(after.iter().rev())).min(room);
        let lines = |all: &[&str], sign: char| -> Vec<String> {
            all[head..all.len() - tail].iter().map(|line| format!("{sign} {}", line.trim_end())).collect()
        };
        let mut shown = lines(&before, '-');
        shown.extend(lines(&after, '+'));
        let rest = shown.len().saturating_sub(most);
        if rest > 0 {
            shown.truncate(most);
            shown.push(format!("… {rest} more"));
        }
        shown.join("\n")
    }
}

/// The edits that make a change; `Err` says why it cannot be made. What is declared goes to the file that is shown, `file`.
pub fn draw(parse: &Parse, file: Span, change: &Change) -> Result<Drawn, String> {
    let mut drawn = match change {
        Change::Insert { text, at } => Drawn::of(insert(parse, file, text, *at)?),
        Change::Paste { text, at } => Drawn::of(call::paste(parse, file, text, *at)?),
        Change::New { at } => call::new_activity(parse, file, *at)?,
        Change::Move { what, at } => Drawn::of(relocate(parse, file, *what, *at)?),
        Change::Delete(what) => Drawn::of(list::delete(parse, &Site::of(parse, *what)?)),
        Change::Wrap(what, wrapping) => Drawn::of(wrap::wrap(parse, &Site::of(parse, *what)?, wrapping)?),
        Change::Unwrap(what) => Drawn::of(wrap::unwrap(parse, &Site::of(parse, *what)?)?),
        Change::Bound(what, bounds) => wrap::bound(&Site::of(parse, *what)?, bounds),
        Change::Connect { from, to } => wrap::connect(parse, *from, *to)?,
        Change::Visit { vehicle, location } => Drawn::of(visit::visit(parse, file, vehicle, location)?),
    };
    drawn.edits.sort_by_key(|edit| edit.span);
    drawn.made = drawn.made.or_else(|| made(parse, change, &drawn.edits));
    let changed = drawn.apply(parse.text());
    if changed == parse.text() {
        return Err("Already there".to_owned());
    }
    // A change that adds syntax errors is refused.
    if syntax_errors(&rmpl::parse(&changed)) > syntax_errors(parse) {
        return Err("This change would cause a syntax error".to_owned());
    }
    Ok(drawn)
}

/// Returns where what a change adds or moves begins in the new text.
fn made(parse: &Parse, change: &Change, edits: &[Edit]) -> Option<u32> {
    let text = match change {
        Change::Insert { text, .. } | Change::Paste { text, .. } => text.clone(),
        Change::Move { what, .. } => statement_text(parse, *what)?,
        Change::Visit { vehicle, .. } => vehicle.clone(),
        _ => return None,
    };
    let first = text.lines().next().unwrap_or_default();
    let is_declaration = |edit: &Edit| edit.text.trim_start().starts_with("primitive");
    let mut shift = 0_i64;
    for edit in edits {
        let within = edit.text.find(first).filter(|_| !first.is_empty() && !is_declaration(edit));
        if let Some(within) = within {
            return u32::try_from(i64::from(edit.span.start) + shift + within as i64).ok();
        }
        shift += edit.text.len() as i64 - i64::from(edit.span.end - edit.span.start);
    }
    None
}

fn syntax_errors(parse: &Parse) -> usize {
    let is_syntax = |it: &&rmpl::Diagnostic| it.severity == Severity::Error && it.code.0 == "E-SYNTAX";
    parse.diagnostics().iter().filter(is_syntax).count()
}

/// The text of the statement that a span represents, as it is copied.
pub fn statement_text(parse: &Parse, what: Span) -> Option<String> {
    let site = Site::of(parse, what).ok()?;
    Some(list::outdented(parse.text(), site.span()))
}

/// Returns whether a span represents a statement that can be changed as a whole.
pub fn is_statement(parse: &Parse, what: Span) -> bool {
    Site::of(parse, what).is_ok()
}

/// The statement before or after the one of a span, among those in the same row.
pub fn neighbor(parse: &Parse, what: Span, forwards: bool) -> Option<Span> {
    Site::of(parse, what).ok()?.neighbor(forwards).map(rmpl::syntax::SyntaxNode::span)
}

fn insert(parse: &Parse, file: Span, text: &str, at: Place) -> Result<Vec<Edit>, String> {
    Ok(match at {
        Place::After(other) => list::beside(parse, &Site::of(parse, other)?, text, list::Side::After),
        Place::Before(other) => list::beside(parse, &Site::of(parse, other)?, text, list::Side::Before),
        Place::Beside(other) => list::parallel(parse, &Site::of(parse, other)?, text),
        Place::Instead(other) => list::alternative(parse, &Site::of(parse, other)?, text),
        Place::End | Place::Thread if let Some(edit) = call::new_scenario(parse, file, text) => vec![edit],
        Place::End => list::at_end(parse, &site::scenario_block(parse)?, text),
        Place::Thread => list::thread(parse, &site::scenario_block(parse)?, text),
    })
}

fn relocate(parse: &Parse, file: Span, what: Span, at: Place) -> Result<Vec<Edit>, String> {
    let site = Site::of(parse, what)?;
    if let Place::After(other) | Place::Before(other) | Place::Beside(other) | Place::Instead(other) = at {
        let target = Site::of(parse, other)?;
        if site.span().contains(target.span()) {
            return Err("An activity cannot be moved into itself".to_owned());
        }
        let forwards = matches!(at, Place::Before(_));
        let is_next = site.neighbor(forwards).is_some_and(|next| next.span() == target.span());
        if is_next && matches!(at, Place::After(_) | Place::Before(_)) {
            return Err("Already there".to_owned());
        }
    }
    let text = list::outdented(parse.text(), site.span());
    let mut edits = list::delete(parse, &site);
    for added in insert(parse, file, &text, at)? {
        let is_in_gap = |edit: &Edit| edit.span.start < added.span.start && added.span.start < edit.span.end;
        if edits.iter().any(is_in_gap) {
            return Err("Already there".to_owned());
        }
        edits.push(added);
    }
    Ok(edits)
}
