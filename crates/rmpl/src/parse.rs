//! A parsed mission text: trees, diagnostics and meaning, kept current through edits.
//!
//! The text is cut into declarations, each with its own tree and relative offsets. An edit parses again only the
//! declarations whose parsing looked at the changed bytes; everything else is shared.

use std::ops::Range;
use std::sync::Arc;

use exact::{Rational, Time};
use rustc_hash::{FxHashMap, FxHashSet};
use smol_str::SmolStr;

use crate::analysis::local::local_diagnostics;
use crate::analysis::{
    Checked, DeclarationKey, Index, Meaning, Names, Namespace, Summary, check, recursion, summarize,
};
use crate::control::{ComponentModes, component_modes};
use crate::copies;
use crate::diagnostic::{Diagnostic, Edit, Known, Listed, Severity};
use crate::diagnostics::{syntax, undefined};
use crate::edits::Shift;
use crate::files::{self, MARK};
use crate::fleet;
use crate::lower::{Item, Lowering, OptionValue};
use crate::parser::{Scratch, parse_declaration};
use crate::program::{ControlDecl, Controllability, ImportDecl, Name, Program, TimeUnit, state_of_component};
use crate::span::Span;
use crate::syntax::{DeclarationTree, SyntaxKind, SyntaxNode};

/// Parses a mission text in the infix notation (SPEC 1). Never fails and never panics.
///
/// ```
/// let parsed = rmpl::parse("scenario Day[0,60] = { Drive()[20,30]; Dig()[5,10] ");
/// // The brace is missing: the author is told so once, and what is there is read nevertheless.
/// let errors: Vec<&str> = parsed.diagnostics().iter().map(|it| it.code.0).filter(|it| it.starts_with("E-")).collect();
/// assert_eq!(errors, ["E-SYNTAX"]);
/// assert_eq!(parsed.program().scenarios[0].name.text, "Day");
/// ```
pub fn parse(text: &str) -> Parse {
    Parse::new(text.into())
}

/// A mission text with its trees and what follows from them.
#[derive(Clone, Debug, Default)]
pub struct Parse {
    text: Arc<str>,
    places: Vec<Place>,
    names: Names,
    index: Index,
    cycles: Vec<(DeclarationKey, Diagnostic)>,
    declarations_read: u64,
}

/// Where a declaration is.
#[derive(Clone, Debug)]
struct Place {
    start: u32,
    key: DeclarationKey,
    declaration: Arc<Declaration>,
    checked: Arc<Checked>,
}

impl Place {
    fn root<'a>(&'a self, text: &'a str) -> SyntaxNode<'a> {
        let end = self.start + self.declaration.tree.len();
        self.declaration.tree.root(text.get(self.start as usize..end as usize).unwrap_or(""), self.start)
    }

    /// Returns what the declaration declares, with places relative to it. It is made again whenever it is needed: a
    /// mission may have a million declarations.
    fn item(&self, text: &str) -> Option<Item> {
        let end = self.start + self.declaration.tree.len();
        let own = text.get(self.start as usize..end as usize).unwrap_or("");
        Lowering::new(&|_| false).item(self.declaration.tree.root(own, 0))
    }
}

/// A declaration that has just been read.
struct Fresh {
    start: u32,
    declaration: Arc<Declaration>,
    /// What it declares, of the first [`MAX_ITEMS`].
    item: Option<Item>,
}

/// So many declarations are kept from reading them to checking them.
const MAX_ITEMS: usize = 64;

/// What is known of one declaration whatever the rest of the file says; offsets are relative to its first byte.
#[derive(Debug)]
pub(crate) struct Declaration {
    tree: DeclarationTree,
    diagnostics: Vec<Diagnostic>,
    summary: Summary,
    /// Whether it has no errors of its own.
    is_sound: bool,
    reach: u32,
}

impl Parse {
    /// Parses a text that is held elsewhere, too.
    pub fn new(text: Arc<str>) -> Self {
        let mut parse = Self { text, ..Self::default() };
        let fresh = parse.read_declarations(0, |_, _| false);
        parse.exchange(0..0, fresh);
        parse
    }

    /// The trees of a text alone: what its names mean is not asked.
    pub(crate) fn trees(text: Arc<str>) -> Self {
        let mut parse = Self { text, ..Self::default() };
        let fresh = parse.read_declarations(0, |_, _| false);
        let checked = Arc::new(Checked::default());
        let place = |Fresh { start, declaration, .. }| Place {
            start,
            key: parse.index.new_key(),
            declaration,
            checked: Arc::clone(&checked),
        };
        parse.places = fresh.into_iter().map(place).collect();
        parse
    }

    /// The text that was parsed.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns how many declarations were parsed so far, those of earlier texts included.
    pub const fn declarations_read(&self) -> u64 {
        self.declarations_read
    }

    /// Replaces a part of the text. Only what the edit touches is parsed again. Places outside the text or inside a
    /// character are moved to the nearest place before.
    pub fn edit(&mut self, edit: &Edit) {
        let end = floor_boundary(&self.text, edit.span.end);
        let start = floor_boundary(&self.text, edit.span.start).min(end);
        let text = [&self.text[..start], &edit.text, &self.text[end..]].concat();
        let [start, removed, inserted] = [start, end - start, edit.text.len()].map(|bytes| bytes as u32);
        self.follow(text.into(), Shift { start, removed, inserted });
    }

    /// Follows the text to what it has become. Only what `shift`, which leads there, covers is parsed again.
    pub fn follow(&mut self, text: Arc<str>, shift: Shift) {
        self.text = text;
        let (start, end) = (shift.start, shift.start + shift.removed);
        let first = self.places.iter().position(|place| place.start + place.declaration.reach >= start);
        let first = first.unwrap_or(self.places.len());
        let from = self.places.get(first).map_or_else(|| self.end_of_places(), |place| place.start);
        let new_end = start + shift.inserted;
        // Beyond the edit, places of the old text are found so much further on.
        let shift = i64::from(shift.inserted) - i64::from(shift.removed);
        let mut resume = first;
        let fresh = self.read_declarations(from, |old, at| {
            let Ok(old_start) = u32::try_from(i64::from(at) - shift) else { return false };
            if at < new_end || old_start < end {
                return false;
            }
            while old.get(resume).is_some_and(|place| place.start < old_start) {
                resume += 1;
            }
            old.get(resume).is_some_and(|place| place.start == old_start)
        });
        // Everything was parsed to the end of the text unless the parser met an old boundary.
        let met = fresh.last().map_or(from, |last| last.start + last.declaration.tree.len());
        if met as usize == self.text.len() {
            resume = self.places.len();
        }
        for place in self.places.iter_mut().skip(resume) {
            place.start = (i64::from(place.start) + shift) as u32;
        }
        self.exchange(first..resume, fresh);
    }

    /// Parses declarations from `start` on, until `meets` accepts the start of the next one or the text ends.
    fn read_declarations(&mut self, start: u32, mut meets: impl FnMut(&[Place], u32) -> bool) -> Vec<Fresh> {
        let mut found: Vec<Fresh> = Vec::new();
        let mut scratch = Scratch::default();
        let (mut at, mut file_end) = (start, 0);
        while (at as usize) < self.text.len() && !meets(&self.places, at) {
            if at as usize >= file_end {
                file_end = self.end_of_file(at);
            }
            let rest = self.text.get(at as usize..file_end).unwrap_or("");
            let (declaration, item) = Declaration::read(rest, &mut scratch, &mut self.names);
            let length = declaration.tree.len().max(1);
            let item = item.filter(|_| found.len() < MAX_ITEMS);
            found.push(Fresh { start: at, declaration: Arc::new(declaration), item });
            self.declarations_read += 1;
            at += length;
        }
        found
    }

    /// Returns where the file that holds a place ends: nothing reaches beyond the heading of the next one.
    fn end_of_file(&self, at: u32) -> usize {
        let next = at as usize + 1;
        let rest = self.text.get(next..).and_then(|rest| rest.find(MARK));
        rest.map_or(self.text.len(), |length| next + length)
    }

    /// Puts fresh declarations in place of old ones and brings the diagnostics of the whole file up to date.
    fn exchange(&mut self, old: Range<usize>, fresh: Vec<Fresh>) {
        let removed: Vec<Place> = self.places.get(old.clone()).unwrap_or_default().to_vec();
        let mut keys: Vec<DeclarationKey> = removed.iter().rev().map(|place| place.key).collect();
        let unchecked = Arc::new(Checked::default());
        let (fresh, items): (Vec<Place>, Vec<Option<Item>>) = fresh
            .into_iter()
            .map(|Fresh { start, declaration, item }| {
                let key = keys.pop().unwrap_or_else(|| self.index.new_key());
                (Place { start, key, declaration, checked: Arc::clone(&unchecked) }, item)
            })
            .unzip();
        let summaries = |place: &Place| (place.key, Arc::clone(&place.declaration));
        let (before, after): (Vec<_>, Vec<_>) =
            (removed.iter().map(summaries).collect(), fresh.iter().map(summaries).collect());
        self.index.exchange(
            &self.names,
            before.iter().map(|(key, declaration)| (*key, &declaration.summary)),
            after.iter().map(|(key, declaration)| (*key, &declaration.summary)),
        );
        self.index.release(keys);
        let changed = old.start..old.start + fresh.len();
        self.places.splice(old, fresh);
        self.index.find_rivals(self.places.iter().map(|place| place.key));
        self.check_again(&changed, items);
    }

    /// Checks what has changed, of which some items are at hand, and all that the change concerns.
    fn check_again(&mut self, changed: &Range<usize>, mut items: Vec<Option<Item>>) {
        let may_concern_others = self.index.has_changed();
        for (position, place) in self.places.iter_mut().enumerate() {
            let checked = &place.checked;
            let declaration = &place.declaration;
            let is_stale = changed.contains(&position)
                || (may_concern_others
                    && self.index.is_stale(&declaration.summary, checked.revision, checked.depends_on_names));
            if is_stale {
                let at_hand =
                    position.checked_sub(changed.start).and_then(|fresh| items.get_mut(fresh)?.take());
                place.checked = Arc::new(check(
                    place.key,
                    &declaration.summary,
                    at_hand.or_else(|| place.item(&self.text)).as_ref(),
                    declaration.is_sound,
                    &self.names,
                    &self.index,
                ));
            }
        }
        let in_cycles: FxHashSet<DeclarationKey> = self.cycles.iter().map(|(key, _)| *key).collect();
        let mut changed_keys =
            self.places.get(changed.clone()).unwrap_or_default().iter().map(|place| place.key);
        let moves_circle = !in_cycles.is_empty() && changed_keys.any(|key| in_cycles.contains(&key));
        if self.index.take_calls_changed() || moves_circle {
            let summaries = self.places.iter().map(|place| (place.key, &place.declaration.summary));
            self.cycles = recursion(&self.names, &self.index, summaries);
        }
    }

    fn end_of_places(&self) -> u32 {
        self.places.last().map_or(0, |place| place.start + place.declaration.tree.len())
    }

    /// The trees of the file's declarations, in textual order; together they hold every byte of the text.
    pub fn declarations(&self) -> impl Iterator<Item = SyntaxNode<'_>> {
        self.places.iter().map(|place| place.root(&self.text))
    }

    /// The trees of the file's declarations, each with whether it follows the grammar. What a declaration lacks may be
    /// reported after it, where the next one begins.
    pub(crate) fn declarations_by_syntax(&self) -> impl Iterator<Item = (SyntaxNode<'_>, bool)> {
        self.places.iter().map(|place| {
            let own = &place.declaration.diagnostics;
            (place.root(&self.text), own.iter().all(|found| found.code != syntax::CODE))
        })
    }

    /// The trees of the declarations that touch `range`.
    pub fn declarations_in(&self, range: Span) -> impl Iterator<Item = SyntaxNode<'_>> {
        let first =
            self.places.partition_point(|place| place.start + place.declaration.tree.len() < range.start);
        let touching = self.places.iter().skip(first).take_while(move |place| place.start <= range.end);
        touching.map(|place| place.root(&self.text))
    }

    /// The tree of the declaration around `offset`.
    pub fn declaration_at(&self, offset: u32) -> Option<SyntaxNode<'_>> {
        let after = self.places.partition_point(|place| place.start <= offset);
        self.places.get(after.checked_sub(1)?).map(|place| place.root(&self.text))
    }

    /// Returns what there is to tell the author, in textual order: of each severity the first [`MAX_LISTED`], of which
    /// the last one says how many more there are.
    ///
    /// [`MAX_LISTED`]: crate::diagnostic::MAX_LISTED
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let imports: Vec<(Span, ImportDecl)> = (self.places.iter())
            .filter(|place| place.root(&self.text).child(SyntaxKind::ImportDecl).is_some())
            .filter_map(|place| match place.item(&self.text)? {
                Item::Import(import) => {
                    let span = import.file_span;
                    Some((Span::new(span.start + place.start, span.end + place.start), import))
                }
                _ => None,
            })
            .collect();
        let of_imports = files::check(self, &imports);
        let lacks_a_file = of_imports.iter().any(|found| found.code == undefined::CODE);
        // What the missing file declares is missing once.
        let is_consequence = |found: &Diagnostic| {
            lacks_a_file
                && matches!(
                    found.code.0,
                    "E-UNDEF" | "E-NAME" | "W-UNDEF" | "W-SIMILAR" | "W-SUPPORT" | "W-TRAVERSE"
                )
        };
        let mut cycles: FxHashMap<DeclarationKey, Vec<&Diagnostic>> = FxHashMap::default();
        for (key, found) in &self.cycles {
            cycles.entry(*key).or_default().push(found);
        }
        let mut all = Listed::default();
        let mut told = FxHashSet::default();
        for place in &self.places {
            let own = place.declaration.diagnostics.iter();
            let shown = place.checked.diagnostics.iter().filter_map(|(once, diagnostic)| {
                once.is_none_or(|once| told.insert(once)).then_some(diagnostic)
            });
            let cycles = cycles.get(&place.key).into_iter().flatten().copied();
            let mut here: Vec<&Diagnostic> =
                own.chain(shown).chain(cycles).filter(|found| !is_consequence(found)).collect();
            here.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.severity));
            for found in here {
                all.add(found, place.start);
            }
        }
        let is_sound =
            all.list.iter().all(|found| found.severity != Severity::Error) && of_imports.is_empty();
        let of_file = if is_sound { copies::check(self) } else { of_imports };
        if !of_file.is_empty() {
            for found in &of_file {
                all.add(found, 0);
            }
            all.list.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.severity));
        }
        all.list
    }

    /// Returns what names mean in this file.
    pub(crate) const fn meaning(&self) -> Meaning<'_> {
        Meaning { names: &self.names, index: &self.index }
    }

    /// Each declaration's tree with what it declares and uses.
    pub(crate) fn summaries(&self) -> impl Iterator<Item = (SyntaxNode<'_>, &Summary)> {
        self.places.iter().map(|place| (place.root(&self.text), &place.declaration.summary))
    }

    /// Returns what the text means, as far as it is well formed.
    pub fn program(&self) -> Program {
        let definitions =
            self.places.iter().filter_map(|place| place.declaration.summary.definition.as_ref());
        let callables = definitions.filter(|definition| definition.namespace == Namespace::Callable);
        let callables: FxHashSet<&str> =
            callables.map(|definition| self.names.text(definition.name).as_str()).collect();
        let is_callable = |name: &str| callables.contains(name);
        let mut lowering = Lowering::new(&is_callable);
        let mut program = Program::default();
        for root in self.declarations() {
            if let Some(item) = lowering.item(root) {
                add(&mut program, item);
            }
        }
        fill_states_of_plant(&mut program);
        fill_control_step(&mut program);
        fleet::equip(&mut program);
        program
    }
}

/// Without an option, a step is as long as the control block says. Of several control blocks the first counts.
fn fill_control_step(program: &mut Program) {
    let Program { options, control, .. } = program;
    let names_step = |block: &&ControlDecl| block.text.to_ascii_uppercase().contains("DEFSTEP");
    let Some(block) = control.first().filter(names_step).filter(|_| !options.has_control_step) else {
        return;
    };
    let file = crate::control::parse(&block.text).file;
    let units = Rational::from_integer(options.time_unit.seconds());
    if let Some(step) = file.own_step_secs().and_then(|secs| secs.checked_div(units)) {
        options.control_step = Time::from_units(step);
    }
}

/// Gives states that are read from the plant the modes of their components. Of several control blocks the first counts.
fn fill_states_of_plant(program: &mut Program) {
    let Program { variables, control, .. } = program;
    let mut states = variables.iter_mut().filter(|variable| variable.is_from_plant).peekable();
    let Some(block) = control.first().filter(|_| states.peek().is_some()) else { return };
    let components = component_modes(&crate::control::parse(&block.text).file);
    for state in states {
        let of = |component: &&ComponentModes| state_of_component(&component.name) == state.name.text;
        if let Some(component) = components.iter().find(of) {
            let named = |text: &SmolStr| Name { text: text.clone(), span: state.name.span };
            state.values = component.modes.iter().map(named).collect();
            state.initial = Some(named(&component.initial));
        }
    }
}

fn add(program: &mut Program, item: Item) {
    match item {
        Item::Constant(decl) => program.constants.push(decl),
        Item::Variable(decl) => program.variables.push(decl),
        Item::Resource(decl) => program.resources.push(*decl),
        Item::Objective(decl) => program.objectives.push(decl),
        Item::Primitive(decl) => program.primitives.push(*decl),
        Item::Activity(decl) => program.activities.push(*decl),
        Item::Scenario(decl) => program.scenarios.push(*decl),
        Item::Option(decl) => match (decl.name.text.as_str(), decl.value) {
            ("threat_gap", OptionValue::Number(gap)) => program.options.threat_gap = Time::from_units(gap),
            ("control_step", OptionValue::Number(step)) if step.is_positive() => {
                program.options.control_step = Time::from_units(step);
                program.options.has_control_step = true;
            }
            ("strict", OptionValue::Number(value)) => program.options.strict = value == Rational::ONE,
            ("time_unit", OptionValue::Name(unit)) if unit == "second" => {
                program.options.time_unit = TimeUnit::Second;
            }
            ("time_unit", OptionValue::Name(unit)) if unit == "minute" => {
                program.options.time_unit = TimeUnit::Minute;
            }
            ("controllability", OptionValue::Name(name)) => {
                program.options.controllability = Controllability::by_name(&name).unwrap_or_default();
            }
            _ => {}
        },
        Item::Constrain(decl) => program.constraints.push(*decl),
        Item::Import(decl) => program.imports.push(decl),
        Item::Control(decl) => program.control.push(decl),
        Item::Terrain(decl) => program.world.terrain = program.world.terrain.take().or(Some(*decl)),
        Item::Location(decl) => program.world.locations.push(decl),
        Item::Obstacle(decl) => program.world.obstacles.push(decl),
        Item::Vehicles(decl) => {
            program.world.vehicles.extend(decl.vehicles);
            program.fleets.extend(decl.fleets);
        }
        Item::Model(decl) => program.world.models.push(*decl),
        Item::Group(decl) => program.groups.push(decl),
    }
}

impl Declaration {
    /// Reads the declaration at the start of `text`, and what it declares.
    fn read(text: &str, scratch: &mut Scratch, names: &mut Names) -> (Self, Option<Item>) {
        let parsed = parse_declaration(text, scratch);
        let root = parsed.tree.root(text.get(..parsed.tree.len() as usize).unwrap_or(""), 0);
        let mut lowering = Lowering::new(&|_| false);
        let item = lowering.item(root);
        let mut diagnostics = parsed.diagnostics;
        diagnostics.append(&mut lowering.diagnostics);
        let mut is_sound = diagnostics.is_empty();
        if let Some(item) = &item {
            let local = local_diagnostics(item, root);
            is_sound &= local.iter().all(|diagnostic| diagnostic.severity != Severity::Error);
            diagnostics
                .extend(local.into_iter().filter(|found| is_sound || found.severity == Severity::Error));
        }
        let mut known = Known::default();
        diagnostics.retain(|found| known.is_new(found));
        diagnostics.shrink_to_fit();
        let summary = summarize(item.as_ref(), &lowering.bare_names, names);
        (Self { tree: parsed.tree, diagnostics, summary, is_sound, reach: parsed.reach }, item)
    }
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
    pub(crate) fn moved(mut self, offset: u32) -> Self {
        let shift = |span: Span| Span::new(span.start + offset, span.end + offset);
        self.span = shift(self.span);
        for edit in self.fixes.iter_mut().flat_map(|fix| &mut fix.edits) {
            edit.span = shift(edit.span);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_declaration_takes_little_room_of_its_own() {
        // A mission may have a million of them.
        let sizes = [size_of::<Item>(), size_of::<Summary>(), size_of::<Declaration>()];
        assert!(sizes[0] <= 128 && sizes[2] <= 408, "{sizes:?}");
    }
}
