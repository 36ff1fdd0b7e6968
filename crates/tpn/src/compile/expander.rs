//! What the compile rules work on: the network under construction, the names in scope, and the pieces that it is made of.

use std::collections::BTreeMap;
use std::rc::Rc;

use rmpl::Diagnostic;
use rmpl::fleet::Groups;
use rmpl::program::{ActivityDecl, PrimitiveDecl, Program, Statement};

use super::build::{Builder, Root};
use super::constants::Constants;
use super::constraint::Named;
use super::ground::Ground;
use super::interchangeable::interchangeable;
use super::names::Vocabulary;
use super::scope::Scope;
use crate::network::{ArcId, ArcKind, BlockId, Network, NodeId, OccurrenceId, ResourceId};

/// What kind of node is at an end of a piece, which decides what may share the node (rule M).
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// The start or end of an activity or assertion: shares its node only with a delay.
    Event,
    /// A fork, join, merge, decision or wrapper: shares its node with other structure.
    Structural,
    /// The start or end of a delay: waiting does not have an event, so it shares its neighbor's node.
    Delay,
}

/// Where a piece begins.
#[derive(Clone, Copy)]
pub(super) enum Entry {
    /// At a new node.
    Free,
    /// At `node` if the two may share it, otherwise at a new node after an arc `[0,0]` of kind `link`.
    After { node: NodeId, end: End, link: ArcKind },
}

/// A statement with what its names mean: one of several that stand side by side.
#[derive(Clone, Copy)]
pub(super) struct Branch<'program, 'scope> {
    pub(super) statement: &'program Statement,
    pub(super) scope: &'scope Scope,
    /// Whether it is one of several copies, in which names are those of the copy.
    pub(super) is_copy: bool,
}

impl<'program, 'scope> Branch<'program, 'scope> {
    /// Statements that mean the same wherever they stand.
    pub(super) fn all(statements: &'program [Statement], scope: &'scope Scope) -> Vec<Self> {
        statements.iter().map(|statement| Self { statement, scope, is_copy: false }).collect()
    }
}

/// A compiled piece of the program.
pub(super) struct Piece {
    pub(super) start: NodeId,
    pub(super) end: NodeId,
    pub(super) end_kind: End,
    pub(super) block: BlockId,
    /// The arc, if the piece is a single one.
    pub(super) arc: Option<ArcId>,
    /// The activity or assertion that the piece is, if it is one.
    pub(super) occurrence: Option<OccurrenceId>,
}

/// Expands a program into a network.
pub(super) struct Expander<'program> {
    pub(super) program: &'program Program,
    pub(super) vocabulary: Rc<Vocabulary<'program>>,
    pub(super) constants: Rc<Constants<'program>>,
    pub(super) activities: Rc<BTreeMap<&'program str, &'program ActivityDecl>>,
    pub(super) primitives: Rc<BTreeMap<&'program str, &'program PrimitiveDecl>>,
    pub(super) groups: Rc<Groups>,
    pub(super) builder: Builder,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// The activities being expanded, outermost first.
    pub(super) active: Vec<&'program str>,
    pub(super) depth: usize,
    pub(super) is_cut_off: bool,
    /// The declared resources, by name, with their positions in the network's; `None` for one whose declaration is wrong.
    pub(super) resources: BTreeMap<&'program str, Option<ResourceId>>,
    pub(super) unordered_blocks: usize,
    /// What `as` names, and where that is.
    pub(super) named: Named<'program>,
}

/// What every scenario of a program is expanded with.
#[derive(Clone)]
pub(super) struct Declared<'program> {
    program: &'program Program,
    vocabulary: Rc<Vocabulary<'program>>,
    pub(super) constants: Rc<Constants<'program>>,
    activities: Rc<BTreeMap<&'program str, &'program ActivityDecl>>,
    primitives: Rc<BTreeMap<&'program str, &'program PrimitiveDecl>>,
    groups: Rc<Groups>,
}

impl<'program> Declared<'program> {
    pub(super) fn new(
        program: &'program Program,
        constants: Constants<'program>,
        ground: &'program dyn Ground,
    ) -> Self {
        let mut activities = BTreeMap::new();
        for activity in &program.activities {
            activities.entry(activity.name.text.as_str()).or_insert(activity);
        }
        let mut primitives = BTreeMap::new();
        for primitive in &program.primitives {
            primitives.entry(primitive.name.text.as_str()).or_insert(primitive);
        }
        Self {
            program,
            vocabulary: Rc::new(Vocabulary::new(program, ground)),
            constants: Rc::new(constants),
            activities: Rc::new(activities),
            primitives: Rc::new(primitives),
            // What is wrong with them has been said.
            groups: Rc::new(Groups::new(program).0),
        }
    }
}

impl<'program> Expander<'program> {
    pub(super) fn new(declared: Declared<'program>) -> Self {
        let Declared { program, vocabulary, constants, activities, primitives, groups } = declared;
        let mut expander = Self {
            program,
            vocabulary,
            constants,
            activities,
            primitives,
            groups,
            builder: Builder::default(),
            diagnostics: Vec::new(),
            active: Vec::new(),
            depth: 0,
            is_cut_off: false,
            resources: BTreeMap::new(),
            unordered_blocks: 0,
            named: Named::default(),
        };
        expander.declare_resources();
        expander
    }

    pub(super) fn finish(self, root: Option<Root>) -> (Option<Network>, Vec<Diagnostic>) {
        let objective = self.objective();
        let mut network = root
            .filter(|_| !self.is_cut_off)
            .map(|root| self.builder.finish(&self.vocabulary, &root, &self.program.options, objective));
        if let Some(network) = network.as_mut().filter(|network| !network.exchangeable.copies.is_empty()) {
            network.exchangeable.vehicles = interchangeable(self.program, &self.groups);
        }
        (network, self.diagnostics)
    }
}
