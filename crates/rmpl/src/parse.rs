//! A parsed mission text: trees, diagnostics and meaning, kept current through edits.
//!
//! The text is cut into declarations, each with its own tree and relative offsets. An edit parses again only the
//! declarations whose parsing looked at the changed bytes; everything else is shared.

use std::sync::Arc;

use crate::diagnostic::{Diagnostic, Edit};
use crate::lower::{Item, Lowering, OptionValue};
use crate::parser::parse_declaration;
use crate::program::{Program, TimeUnit};
use crate::rational::Rational;
use crate::span::Span;
use crate::syntax::{DeclarationTree, SyntaxNode};

/// Parses a mission text in the infix notation (SPEC 1). Never fails and never panics.
pub fn parse(text: &str) -> Parse {
    Parse::new(text.to_owned())
}

/// A mission text with its trees and what follows from them.
#[derive(Clone, Debug)]
pub struct Parse {
    text: String,
    places: Vec<Place>,
}

/// Where a declaration stands.
#[derive(Clone, Debug)]
struct Place {
    start: u32,
    declaration: Arc<Declaration>,
}

impl Place {
    fn root<'a>(&'a self, text: &'a str) -> SyntaxNode<'a> {
        let end = self.start + self.declaration.tree.len();
        self.declaration.tree.root(text.get(self.start as usize..end as usize).unwrap_or(""), self.start)
    }
}

/// What is known of one declaration whatever the rest of the file says; offsets are relative to its first byte.
#[derive(Debug)]
pub(crate) struct Declaration {
    tree: DeclarationTree,
    diagnostics: Vec<Diagnostic>,
    item: Option<Item>,
    reach: u32,
}

impl Parse {
    fn new(text: String) -> Self {
        let mut parse = Self { text, places: Vec::new() };
        parse.places = declarations_from(&parse.text, 0, |_| false).0;
        parse
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Replaces a part of the text. Only what the edit touches is parsed again. Places outside the text or inside a
    /// character are moved to the nearest place before.
    pub fn edit(&mut self, edit: &Edit) {
        let end = floor_boundary(&self.text, edit.span.end);
        let start = floor_boundary(&self.text, edit.span.start).min(end);
        self.text.replace_range(start..end, &edit.text);
        let first = self.places.iter().position(|place| place.start + place.declaration.reach >= start as u32);
        let first = first.unwrap_or(self.places.len());
        let from = self.places.get(first).map_or_else(|| self.end_of_places(), |place| place.start);
        let new_end = start + edit.text.len();
        // Beyond the edit, places of the old text are found `shift` further on.
        let shift = edit.text.len() as i64 - (end - start) as i64;
        let mut resume = first;
        let old = &self.places;
        let (fresh, _) = declarations_from(&self.text, from, |at| {
            let Ok(old_start) = u32::try_from(i64::from(at) - shift) else { return false };
            if (at as usize) < new_end || old_start < end as u32 {
                return false;
            }
            while old.get(resume).is_some_and(|place| place.start < old_start) {
                resume += 1;
            }
            old.get(resume).is_some_and(|place| place.start == old_start)
        });
        // Everything was parsed to the end of the text unless the parser met an old boundary.
        let met = fresh.last().map_or(from, |place| place.start + place.declaration.tree.len());
        if met as usize == self.text.len() {
            resume = self.places.len();
        }
        for place in self.places.iter_mut().skip(resume) {
            place.start = (i64::from(place.start) + shift) as u32;
        }
        self.places.splice(first..resume, fresh);
    }

    fn end_of_places(&self) -> u32 {
        self.places.last().map_or(0, |place| place.start + place.declaration.tree.len())
    }

    /// The trees of the file's declarations, in textual order; together they hold every byte of the text.
    pub fn declarations(&self) -> impl Iterator<Item = SyntaxNode<'_>> {
        self.places.iter().map(|place| place.root(&self.text))
    }

    /// The tree of the declaration around `offset`.
    pub fn declaration_at(&self, offset: u32) -> Option<SyntaxNode<'_>> {
        let after = self.places.partition_point(|place| place.start <= offset);
        self.places.get(after.checked_sub(1)?).map(|place| place.root(&self.text))
    }

    /// Everything there is to tell the author, in textual order.
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut all = Vec::new();
        for place in &self.places {
            all.extend(place.declaration.diagnostics.iter().map(|diagnostic| diagnostic.clone().moved(place.start)));
        }
        all
    }

    /// What the text means, as far as it is well formed.
    pub fn program(&self) -> Program {
        let mut callables = rustc_hash::FxHashSet::default();
        for place in &self.places {
            match &place.declaration.item {
                Some(Item::Primitive(decl)) => callables.insert(decl.name.text.as_str()),
                Some(Item::Activity(decl)) => callables.insert(decl.name.text.as_str()),
                _ => continue,
            };
        }
        let is_callable = |name: &str| callables.contains(name);
        let mut lowering = Lowering { is_callable: &is_callable, bare_names: Vec::new() };
        let mut program = Program::default();
        for root in self.declarations() {
            if let Some(item) = lowering.item(root) {
                add(&mut program, item);
            }
        }
        program
    }
}

fn add(program: &mut Program, item: Item) {
    match item {
        Item::Variable(decl) => program.variables.push(decl),
        Item::Primitive(decl) => program.primitives.push(decl),
        Item::Activity(decl) => program.activities.push(decl),
        Item::Scenario(decl) => program.scenarios.push(decl),
        Item::Option(decl) => match (decl.name.text.as_str(), decl.value) {
            ("threat_gap", OptionValue::Number(gap)) => program.options.threat_gap = gap,
            ("strict", OptionValue::Number(value)) => program.options.strict = value == Rational::ONE,
            ("time_unit", OptionValue::Name(unit)) if unit == "second" => {
                program.options.time_unit = TimeUnit::Second;
            }
            ("time_unit", OptionValue::Name(unit)) if unit == "minute" => {
                program.options.time_unit = TimeUnit::Minute;
            }
            _ => {}
        },
        Item::Terrain(decl) => program.world.terrain = program.world.terrain.take().or(Some(decl)),
        Item::Location(decl) => program.world.locations.push(decl),
        Item::Obstacle(decl) => program.world.obstacles.push(decl),
        Item::Vehicle(decl) => program.world.vehicles.push(decl),
    }
}

/// The declarations from `start` on, until `meets` accepts the start of the next one or the text ends.
fn declarations_from(text: &str, start: u32, mut meets: impl FnMut(u32) -> bool) -> (Vec<Place>, u32) {
    let mut places = Vec::new();
    let mut at = start;
    while (at as usize) < text.len() && !meets(at) {
        let rest = text.get(at as usize..).unwrap_or("");
        let parsed = parse_declaration(rest);
        let length = parsed.tree.len().max(1);
        let own_text = rest.get(..length as usize).unwrap_or("");
        let mut lowering = Lowering { is_callable: &|_| false, bare_names: Vec::new() };
        let item = lowering.item(parsed.tree.root(own_text, 0));
        let declaration = Declaration { tree: parsed.tree, diagnostics: parsed.diagnostics, item, reach: parsed.reach };
        places.push(Place { start: at, declaration: Arc::new(declaration) });
        at += length;
    }
    (places, at)
}

fn floor_boundary(text: &str, offset: u32) -> usize {
    let mut at = (offset as usize).min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

impl Diagnostic {
    /// The same, `offset` further on.
    fn moved(mut self, offset: u32) -> Self {
        let shift = |span: Span| Span::new(span.start + offset, span.end + offset);
        self.span = shift(self.span);
        for edit in self.fixes.iter_mut().flat_map(|fix| &mut fix.edits) {
            edit.span = shift(edit.span);
        }
        self
    }
}
