//! The meaning of a mission text, with names as written and a span on everything: what the network compiler reads.
//!
//! It is made from the syntax tree and holds only well-formed pieces; what was broken is left out and has a diagnostic.
//! Calls are not expanded and bounds not evaluated here: both depend on the scenario and happen in `tpn`.

use exact::{Rational, Time};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::span::Span;

/// A name and where it is written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Name {
    pub text: SmolStr,
    pub span: Span,
}

/// A mission file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Program {
    /// Constants, in textual order (SPEC 14).
    pub constants: Vec<ConstantDecl>,
    /// Declared finite-domain variables, in textual order: those of `var` and those of `state` (SPEC 10.1).
    pub variables: Vec<VariableDecl>,
    /// Resources, in textual order (SPEC 11).
    pub resources: Vec<ResourceDecl>,
    /// What plans are to be best in; the first declaration counts (SPEC 12).
    pub objectives: Vec<ObjectiveDecl>,
    /// Declared primitives.
    pub primitives: Vec<PrimitiveDecl>,
    /// Activity definitions.
    pub activities: Vec<ActivityDecl>,
    /// Scenarios; the first is the default.
    pub scenarios: Vec<ScenarioDecl>,
    /// Bounds between events of different threads, in textual order (SPEC 14).
    pub constraints: Vec<ConstrainDecl>,
    /// The files whose declarations belong to the mission as well, in textual order.
    pub imports: Vec<ImportDecl>,
    /// Options, as declared or by default.
    pub options: Options,
    /// The control programs and the plant that activities run, if the mission has any; the first counts.
    pub control: Vec<ControlDecl>,
    /// The world of the mission (SPEC 1.8).
    pub world: World,
    /// Vehicles that one declaration numbers; each is in the world as well.
    pub fleets: Vec<FleetDecl>,
    /// What `any` and `each` range over, beside fleets.
    pub groups: Vec<GroupDecl>,
}

/// `control { … }`: control programs and their plant, in prefix notation (SPEC 2).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ControlDecl {
    /// What is between the braces.
    pub text: String,
    pub text_span: Span,
    /// The whole block.
    pub span: Span,
}

/// `const NAME = expression;`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConstantDecl {
    pub name: Name,
    /// Its value, which may name other constants.
    pub value: Expr,
    /// The whole declaration.
    pub span: Span,
}

/// `var X : {V1, V2};` or `state X : {V1, V2} = V1;`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariableDecl {
    pub name: Name,
    /// Its domain, in textual order.
    pub values: Vec<Name>,
    /// The value at the scenario's start, which lasts until something changes it: of a `state` only.
    pub initial: Option<Name>,
    /// `from plant`: what it is is estimated, and its domain and first value are those of the component (SPEC 15). Both
    /// are empty where the plant has none of that name.
    pub is_from_plant: bool,
    /// The whole declaration.
    pub span: Span,
}

/// The name of the state that a component's mode is: `EngineA.mode`.
pub fn state_of_component(component: &str) -> SmolStr {
    smol_str::format_smolstr!("{component}.mode")
}

/// The component whose mode a variable of this name is, if it is one's.
pub fn component_of_state(variable: &str) -> Option<&str> {
    variable.strip_suffix(".mode")
}

/// `resource NAME …;`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResourceDecl {
    pub name: Name,
    /// How much of it there is.
    pub supply: Supply,
    /// The whole declaration.
    pub span: Span,
}

/// How much of a resource there is (SPEC 11).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Supply {
    /// `resource NAME;` or `resource NAME capacity 3;`: what is used is free again afterwards.
    Reusable {
        /// How much may be used at a time; 1 if none is given.
        capacity: Option<Expr>,
    },
    /// `resource NAME 0..100 = 40;`: what is consumed is gone until something produces it.
    Reservoir {
        /// The level never goes below.
        least: Expr,
        /// The level never goes above.
        greatest: Expr,
        /// The level at the scenario's start.
        level: Expr,
    },
}

/// `objective minimize cost, maximize reward;`: the goals, the most important one first (SPEC 12).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObjectiveDecl {
    pub goals: Vec<GoalDecl>,
    /// The whole declaration.
    pub span: Span,
}

/// `minimize 2 * cost + end`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GoalDecl {
    /// Whether more is better.
    pub is_maximized: bool,
    /// What is added up: each measure with its factor, which may be negative.
    pub terms: Vec<(Rational, Measure)>,
    pub span: Span,
}

/// What a goal measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// What the selected activities cost.
    Cost,
    /// What the selected activities are rewarded with.
    Reward,
    /// The earliest time of the scenario's end.
    End,
    /// Meters driven.
    Length,
}

impl Measure {
    /// All of them, by the words that texts use.
    pub const ALL: [(&'static str, Self); 4] =
        [("cost", Self::Cost), ("reward", Self::Reward), ("end", Self::End), ("length", Self::Length)];

    /// The measure that this word represents.
    pub fn by_name(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|(name, _)| *name == word).map(|(_, measure)| measure)
    }
}

/// `primitive Name(p,…)[lo,hi] moves … requires … sets …;`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PrimitiveDecl {
    /// The primitive.
    pub name: Name,
    /// Its formal parameters.
    pub formals: Vec<Name>,
    /// What each parameter represents, where that is written (SPEC 17).
    pub kinds: Vec<Option<Name>>,
    /// Its default duration; `[0,inf]` when absent.
    pub bounds: Option<Bounds>,
    /// Present if the primitive is a traverse.
    pub moves: Option<Box<Moves>>,
    /// The control program that the primitive runs when it is executed.
    pub runs: Option<Box<Runs>>,
    /// What each activity of it requires, in textual order (SPEC 10.1).
    pub requires: Vec<Requirement>,
    /// What each activity of it changes.
    pub sets: Vec<Effect>,
    /// The resources that each activity of it takes and gives (SPEC 11).
    pub uses: Vec<ResourceUse>,
    /// What each activity of it costs (SPEC 12); several add up.
    pub costs: Vec<Amount>,
    /// What each activity of it is rewarded with; several add up.
    pub rewards: Vec<Expr>,
    /// How long it takes to end an activity of it early, if that can be done (SPEC 15).
    pub aborts: Option<Box<Bounds>>,
    /// The whole declaration.
    pub span: Span,
}

/// `runs OrbitInsert(EngineA)`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Runs {
    /// The control program.
    pub program: Name,
    /// What it is handed: names of its plant, or parameters of the primitive that represent them.
    pub arguments: Vec<Name>,
}

/// `model NAME extends PARENT { … }`: what vehicles of it can do, and the equipment that each of them has (SPEC 17).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelDecl {
    pub name: Name,
    /// The model that says what this one does not.
    pub parent: Option<Name>,
    /// In textual order.
    pub properties: Vec<PropertyDecl>,
    /// Each vehicle has its own.
    pub resources: Vec<ResourceDecl>,
    /// Each vehicle has its own.
    pub states: Vec<VariableDecl>,
    /// The whole declaration.
    pub span: Span,
}

/// `speed (0.01, 0.8);` of a model
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PropertyDecl {
    pub property: Property,
    /// Without the semicolon.
    pub span: Span,
}

/// What a vehicle model can do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Property {
    /// From front to back and from side to side, in meters.
    Body { length_m: f64, width_m: f64 },
    /// Least and greatest speed in meters per second.
    Speed { min_mps: Rational, max_mps: Rational },
    /// The steepest slope that is driven, in radians.
    Slope { angle_rad: f64 },
    /// The size of what passes below, in meters: a rock, or for what flies the height over the ground.
    Clearance { size_m: f64 },
    /// The radius of the tightest turn at the greatest speed, in meters.
    Turning { radius_m: f64 },
    /// Height of the antenna in meters.
    Mast { height_m: f64 },
    /// Least and greatest altitude over the map's lowest ground, in meters.
    Flies { altitude_band_m: [f64; 2] },
}

impl Property {
    /// The word of the language.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Body { .. } => "body",
            Self::Speed { .. } => "speed",
            Self::Slope { .. } => "slope",
            Self::Clearance { .. } => "clearance",
            Self::Turning { .. } => "turning",
            Self::Mast { .. } => "mast",
            Self::Flies { .. } => "flies",
        }
    }
}

/// `S[1..4]` of a `vehicle` declaration
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FleetDecl {
    pub name: Name,
    /// The number of the first member.
    pub first: u32,
    /// The number of the last member; an empty or too large range is reported, and has none.
    pub last: u32,
    /// Where its range is in the text, with the brackets.
    pub range_span: Span,
}

/// Fleets have no more members than this.
pub const MAX_FLEET: u32 = 1000;

impl FleetDecl {
    /// The names of its vehicles; none if the range is empty or too large.
    pub fn members(&self) -> impl Iterator<Item = SmolStr> + '_ {
        let is_sound = self.first <= self.last && self.last - self.first < MAX_FLEET;
        let last = is_sound.then_some(self.last);
        last.into_iter().flat_map(|last| self.first..=last).map(|number| member_name(&self.name.text, number))
    }
}

/// The name of a vehicle of a fleet: `S[3]`.
fn member_name(fleet: &str, number: u32) -> SmolStr {
    smol_str::format_smolstr!("{fleet}[{number}]")
}

/// `group NAME = R1, S, OTHERS;`
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GroupDecl {
    pub name: Name,
    pub members: Vec<Name>,
    /// The whole declaration.
    pub span: Span,
}

/// `requires ARM=OUT` or `requires at start ARM=OUT`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Requirement {
    /// What must hold.
    pub condition: Condition,
    /// Whether it must hold at the activity's start only, instead of throughout.
    pub is_at_start: bool,
}

/// `sets ARM=OUT`: changing during the activity, and so from its end on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// The state variable, perhaps `V.at`.
    pub variable: Name,
    /// The value, or a parameter that represents one.
    pub value: Name,
    /// Variable and value together.
    pub span: Span,
}

/// `uses Power 3`, `consumes Battery 2 per minute`, `produces Battery 5`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResourceUse {
    pub resource: Name,
    /// What happens to it.
    pub change: Change,
    /// How much; 1 if `uses` does not say.
    pub amount: Option<Amount>,
    /// The resource with its amount.
    pub span: Span,
}

/// What an activity does to a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    /// Takes it from start to end.
    Uses,
    /// Takes it away at its start.
    Consumes,
    /// Adds to it at its end.
    Produces,
}

impl Change {
    /// The word of the language.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Uses => "uses",
            Self::Consumes => "consumes",
            Self::Produces => "produces",
        }
    }
}

/// How an amount compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// `<`
    Below,
    /// `<=`
    AtMost,
    /// `>`
    Above,
    /// `>=`
    AtLeast,
}

impl Order {
    /// As it is written.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Below => "<",
            Self::AtMost => "<=",
            Self::Above => ">",
            Self::AtLeast => ">=",
        }
    }

    /// The one that is written so.
    pub fn by_symbol(symbol: &str) -> Self {
        match symbol {
            "<" => Self::Below,
            "<=" => Self::AtMost,
            ">" => Self::Above,
            _ => Self::AtLeast,
        }
    }

    /// Returns what holds exactly when this does not.
    #[must_use]
    pub const fn opposite(self) -> Self {
        match self {
            Self::Below => Self::AtLeast,
            Self::AtMost => Self::Above,
            Self::Above => Self::AtMost,
            Self::AtLeast => Self::Below,
        }
    }

    /// Returns whether it asks for much, so that what is taken breaks it.
    pub const fn is_minimum(self) -> bool {
        matches!(self, Self::Above | Self::AtLeast)
    }

    /// Returns whether the bound itself is excluded.
    pub const fn is_strict(self) -> bool {
        matches!(self, Self::Above | Self::Below)
    }

    /// Returns whether an amount compares so with a bound.
    pub fn holds(self, amount: Rational, bound: Rational) -> bool {
        match self {
            Self::Below => amount < bound,
            Self::AtMost => amount <= bound,
            Self::Above => amount > bound,
            Self::AtLeast => amount >= bound,
        }
    }
}

/// `3`, `2 per minute`, `0.5 per metre`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Amount {
    pub value: Expr,
    /// What it is multiplied by.
    pub per: Option<Per>,
    /// The number with its unit.
    pub span: Span,
}

/// What an amount is counted per.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Per {
    /// `per second`, `per minute`, `per hour`: of the activity's duration.
    Time(DurationUnit),
    /// `per metre`: of the planned path.
    Meter,
}

impl Per {
    /// All of them, by the words that texts use.
    pub const ALL: [(&'static str, Self); 4] = [
        ("second", Self::Time(DurationUnit::Second)),
        ("minute", Self::Time(DurationUnit::Minute)),
        ("hour", Self::Time(DurationUnit::Hour)),
        ("metre", Self::Meter),
    ];

    /// The unit that this word represents.
    pub fn by_name(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|(name, _)| *name == word).map(|(_, per)| per)
    }
}

impl PrimitiveDecl {
    /// The vehicles that a call with these arguments moves, by name; the first leads.
    pub fn moved<'a>(&'a self, arguments: &'a [SmolStr]) -> impl Iterator<Item = &'a SmolStr> {
        self.moves.iter().flat_map(|moves| &moves.vehicles).map(|vehicle| {
            let formal = self.formals.iter().position(|formal| formal.text == vehicle.text);
            formal.and_then(|at| arguments.get(at)).unwrap_or(&vehicle.text)
        })
    }
}

/// `moves V1, V2 speed (least, greatest) kinodynamic`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moves {
    /// The vehicles that move; the first leads.
    pub vehicles: Vec<Name>,
    /// Least and greatest speed in meters per second; the vehicle's own when absent.
    pub speed_mps: Option<(Rational, Rational)>,
    /// Whether what the vehicles can do with their wheels bounds how long their ways take (SPEC 7.2).
    pub is_kinodynamic: bool,
    pub span: Span,
}

/// `Name(params)[l,u] = { … }`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActivityDecl {
    pub name: Name,
    /// Its formal parameters.
    pub formals: Vec<Name>,
    /// What each parameter represents, where that is written (SPEC 17).
    pub kinds: Vec<Option<Name>>,
    pub bounds: HeaderBounds,
    pub body: Statement,
    /// The whole definition.
    pub span: Span,
}

/// The bounds in the header of an activity definition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum HeaderBounds {
    None,
    /// Either side may be a bound parameter (a plain name, bound to the invocation's bound: default 0 and inf)
    /// or an expression, intersected with the invocation's.
    Sides {
        /// The lower side.
        lower: HeaderBound,
        /// The upper side.
        upper: HeaderBound,
        /// With the brackets.
        span: Span,
    },
}

/// One side of a header's bounds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum HeaderBound {
    /// Declares a bound parameter.
    Parameter(Name),
    /// Restricts the invocation.
    Limit(Expr),
}

/// `scenario Name[lo,hi] = { … }`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScenarioDecl {
    pub name: Name,
    pub bounds: Option<Bounds>,
    pub body: Statement,
    /// The whole definition.
    pub span: Span,
}

/// `constrain NAME.start to OTHER.end [l,u];`: in force where both are selected (SPEC 14).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConstrainDecl {
    /// The event from which the time is counted.
    pub from: EventName,
    /// The event that comes so much later.
    pub to: EventName,
    /// How much later; the environment does not choose it.
    pub bounds: Bounds,
    /// The whole declaration.
    pub span: Span,
}

/// `NAME.start` or `NAME.end`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EventName {
    /// The name that `as` gives to an occurrence.
    pub name: Name,
    /// Its end, otherwise its start.
    pub is_end: bool,
    /// The name with the event.
    pub span: Span,
}

/// `import "file";`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImportDecl {
    /// The file, as the text names it.
    pub file: SmolStr,
    /// Where it is named, with its quotes.
    pub file_span: Span,
    /// The whole declaration.
    pub span: Span,
}

/// `[lower, upper]`, not evaluated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// The lower bound.
    pub lower: Expr,
    /// The upper bound.
    pub upper: Expr,
    /// Whether the environment chooses the duration within them (SPEC 13.1).
    pub is_contingent: bool,
    /// With the brackets, and with `contingent`.
    pub span: Span,
}

/// An expression in a bound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
}

/// The kinds of expression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ExprKind {
    Number(Rational),
    /// A number of a unit of time: `90s`, `1.5h`.
    Duration(Rational, DurationUnit),
    /// `inf` or `∞`.
    Infinity,
    /// A bound parameter, a parameter that represents a number, or a constant.
    Name(SmolStr),
    /// `e%`: a hundredth of `e`.
    Percent(Box<Expr>),
    /// `left op right`.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
}

/// A unit that is written after a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum DurationUnit {
    /// `s`
    Second,
    /// `min`
    Minute,
    /// `h`
    Hour,
    /// `d`: 24 hours.
    Day,
    /// `sol`: a solar day of Mars, 88 775.244 seconds.
    Sol,
}

impl DurationUnit {
    /// All of them, by the words that texts use.
    pub const ALL: [(&'static str, Self); 5] =
        [("s", Self::Second), ("min", Self::Minute), ("h", Self::Hour), ("d", Self::Day), ("sol", Self::Sol)];

    /// The unit that this word represents.
    pub fn by_name(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|(name, _)| *name == word).map(|(_, unit)| unit)
    }

    /// Seconds in one, exactly.
    fn seconds(self) -> Option<Rational> {
        let (numerator, denominator) = match self {
            Self::Second => (1, 1),
            Self::Minute => (60, 1),
            Self::Hour => (3_600, 1),
            Self::Day => (86_400, 1),
            Self::Sol => (22_193_811, 250),
        };
        Rational::new(numerator, denominator)
    }

    /// Returns how many of a mission's units of time one is, if that can be said exactly.
    pub fn in_units(self, unit: TimeUnit) -> Option<Rational> {
        self.seconds()?.checked_div(Rational::from_integer(unit.seconds()))
    }
}

/// The arithmetic of bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum BinaryOp {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
}

/// A statement with the bounds written after it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Statement {
    pub kind: StatementKind,
    /// The bounds written after it.
    pub bounds: Option<Bounds>,
    /// Where it is, with its bounds.
    pub span: Span,
}

impl Statement {
    /// Returns what is directly in it.
    pub fn parts(&self) -> &[Self] {
        match &self.kind {
            StatementKind::Sequence(parts)
            | StatementKind::Parallel(parts)
            | StatementKind::Choose(parts)
            | StatementKind::Unordered(parts) => parts,
            StatementKind::Maintaining(body, _)
            | StatementKind::Watching(body, _)
            | StatementKind::Telling(body, _)
            | StatementKind::IfThennext(_, body)
            | StatementKind::Repeat(_, body)
            | StatementKind::Named(body, _)
            | StatementKind::Using(body, ..)
            | StatementKind::Members(Members { body, .. }) => std::slice::from_ref(body),
            StatementKind::Call(..) | StatementKind::Condition(..) | StatementKind::Delay => &[],
        }
    }

    /// Visits it and everything in it, in textual order.
    pub fn for_each<'program>(&'program self, visit: &mut dyn FnMut(&'program Self)) {
        visit(self);
        self.parts().iter().for_each(|part| part.for_each(visit));
    }
}

/// The kinds of statement. A block is the sequence or parallel it contains; bounds of a block stand on that statement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum StatementKind {
    /// `{ a; b; … }`; may be empty. A block with one statement that itself has bounds stays a one-element sequence.
    Sequence(Vec<Statement>),
    /// `a, b, …`, at least two.
    Parallel(Vec<Statement>),
    /// `choose { a, b, … }`, at least one.
    Choose(Vec<Statement>),
    /// `do body maintaining condition`
    Maintaining(Box<Statement>, Condition),
    /// `do body watching condition`
    Watching(Box<Statement>, Condition),
    /// `a and b` as an assertion: the body asserts `a`, and for as long the condition `b` is asserted.
    Telling(Box<Statement>, Condition),
    /// `if condition thennext body`
    IfThennext(Condition, Box<Statement>),
    /// `repeat count { … }`: so many copies of the body, one after the other.
    Repeat(Expr, Box<Statement>),
    /// `unordered { a; b; … }`: all of them, each when it fits, no two at a time (SPEC 14).
    Unordered(Vec<Statement>),
    /// `do body using resource amount`: the amount, 1 if none is given, is used for the body's whole length (SPEC 11).
    Using(Box<Statement>, Name, Option<Expr>),
    /// `body as NAME` (SPEC 14).
    Named(Box<Statement>, Name),
    /// `any x in G body` or `each x in G body` (SPEC 17).
    Members(Members),
    /// `Name(args)`, or a bare name that is a declared activity or primitive.
    Call(Name, Vec<Argument>),
    /// `c`, `tell c` (an assertion) or `ask c`.
    Condition(LabelMode, Condition),
    /// `delay`
    Delay,
}

/// A statement for one member of a group, or for each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Members {
    pub form: MembersForm,
    /// What represents the member in the body.
    pub variable: Name,
    /// A group or a fleet.
    pub group: Name,
    /// In [`MembersForm::Parallel`] it begins with a delay.
    pub body: Box<Statement>,
}

/// How the copies of a statement for members of a group belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MembersForm {
    /// `any`: one is chosen.
    Any,
    /// `each`: all of them, each when it fits.
    Parallel,
    /// `each … in sequence`: one after the other.
    Sequence,
    /// `each … unordered`: all of them, no two at a time.
    Unordered,
}

/// Whether a condition is asserted or required.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum LabelMode {
    /// The condition is required to hold.
    Ask,
    /// The condition is asserted.
    Tell,
}

/// An argument of a call.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Argument {
    /// What is handed over.
    pub value: ArgumentValue,
    pub span: Span,
}

/// What an argument is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ArgumentValue {
    /// A name: a formal of the surrounding activity, a location, or a symbol.
    Name(SmolStr),
    Number(Rational),
    /// An expression, evaluated where the call is.
    Expression(Expr),
    Condition(Condition),
}

/// A literal: `X`, `X=V`, `X!=V`, `X in {V, W}`, `V.at in visible(L)`, or the negation of one. Negations are folded into `negated`.
///
/// `X_V` is still written as the author wrote it (`variable` = `X_V`, no value): how it splits depends on the file
/// (SPEC 1.3) and on substitution of formals; [`crate::program::Program`]'s users resolve it after substitution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Condition {
    /// The variable, the atom, or a formal that represents one; of a vehicle's place `V.at`, of its state `V.arm`.
    pub variable: Name,
    /// The value, or several of which the variable has one; an atom has none, and neither has what is to see a location.
    pub values: Vec<Name>,
    /// The location that is in sight from where the vehicle is, or a formal that represents one (SPEC 10.5).
    pub sees: Option<Name>,
    /// What the level of a reservoir is compared with; the variable is the reservoir then (SPEC 17).
    pub level: Option<Level>,
    /// Whether the literal is negated an odd number of times (`not`, `!`, `!=`).
    pub negated: bool,
    pub span: Span,
}

/// What a level is compared with: `>= 30 at start`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Level {
    pub order: Order,
    pub bound: Expr,
    /// Whether it is asked for only when what needs it starts.
    pub is_at_start: bool,
}

/// Options of a mission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    /// Least gap between conflicting intervals that planning orders (SPEC 5.3).
    pub threat_gap: Time,
    /// Whether undeclared primitives are errors.
    pub strict: bool,
    /// The unit of time of the mission's bounds.
    pub time_unit: TimeUnit,
    /// How long one step of a control program takes, in mission units; above 0.
    pub control_step: Time,
    /// Whether an option says so.
    pub has_control_step: bool,
    /// What plans have to withstand of durations that the environment chooses.
    pub controllability: Controllability,
}

/// What a plan has to withstand of durations that the environment chooses (SPEC 13.1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Controllability {
    /// There are times that satisfy all constraints whatever the environment chooses.
    Strong,
    /// Times can be chosen as it goes, each after what was observed before it.
    #[default]
    Dynamic,
    /// Nothing: the planner chooses these durations too.
    None,
}

impl Controllability {
    /// All of them, by the words that texts use.
    pub const ALL: [(&'static str, Self); 3] =
        [("dynamic", Self::Dynamic), ("strong", Self::Strong), ("none", Self::None)];

    /// Returns what this word asks for.
    pub fn by_name(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|(name, _)| *name == word).map(|(_, asked)| asked)
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            threat_gap: Time::ONE,
            strict: false,
            time_unit: TimeUnit::Minute,
            control_step: Time::ONE,
            has_control_step: false,
            controllability: Controllability::Dynamic,
        }
    }
}

/// The unit of a mission's bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TimeUnit {
    /// The papers' unit.
    Minute,
    /// `option time_unit = second;`
    Second,
}

impl TimeUnit {
    /// Seconds in one unit.
    pub const fn seconds(self) -> i64 {
        match self {
            Self::Minute => 60,
            Self::Second => 1,
        }
    }
}

/// The world of a mission (SPEC 1.8): meters east and meters north of the map's origin.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct World {
    /// The terrain, if declared.
    pub terrain: Option<TerrainDecl>,
    pub locations: Vec<LocationDecl>,
    pub obstacles: Vec<ObstacleDecl>,
    /// Those of fleets included.
    pub vehicles: Vec<VehicleDecl>,
    /// The vehicle models that the mission declares (SPEC 17).
    pub models: Vec<ModelDecl>,
}

impl ObstacleDecl {
    /// Returns whether it is a body that vehicles would touch.
    pub const fn is_solid(&self) -> bool {
        matches!(self.kind, ObstacleKind::Solid)
    }
}

/// `terrain "asset" cell 0.6 origin (0, 0);`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TerrainDecl {
    /// The name of an asset or an imported map.
    pub asset: SmolStr,
    /// Where the asset is named, with its quotes.
    pub asset_span: Span,
    /// Meters per cell; without it those that the map's file says, or 0.6.
    pub cell_m: Option<f64>,
    /// Mission coordinates of the map's south-west corner, in meters; without it those that the map's file says, or 0.
    pub origin_m: Option<[f64; 2]>,
    /// The whole declaration.
    pub span: Span,
}

/// `location NAME (x, y);`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocationDecl {
    pub name: Name,
    /// Meters east and north.
    pub position_m: [f64; 2],
    /// The numbers inside the parentheses, for edits.
    pub numbers_span: Span,
    /// The whole declaration.
    pub span: Span,
}

/// `obstacle NAME circle (x, y, r);`, `obstacle NAME polygon (x, y, …);`, or the same of a `keepout`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObstacleDecl {
    pub name: Name,
    pub kind: ObstacleKind,
    pub shape: ObstacleShape,
    /// The numbers inside the parentheses, for edits.
    pub numbers_span: Span,
    /// The whole declaration.
    pub span: Span,
}

/// What keeps vehicles out of an area.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ObstacleKind {
    /// A body that vehicles would touch.
    Solid,
    /// A rule: nothing is there.
    KeepOut {
        /// The vehicles, vehicle models, and activities that the rule holds for; all of them if it names none.
        closed_to: Vec<Name>,
    },
}

/// The shape of an obstacle, in meters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ObstacleShape {
    Circle {
        center_m: [f64; 2],
        radius_m: f64,
    },
    /// A simple polygon, at least three corners.
    Polygon {
        /// The corners, in textual order.
        corners_m: Vec<[f64; 2]>,
    },
}

/// The vehicle models of SPEC 1.8, which models can extend.
pub(crate) const VEHICLE_MODELS: [&str; 3] = ["ATRV", "ATRV-Jr", "Blimp"];

/// A vehicle of `vehicle NAME, NAME : MODEL at LOCATION;`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VehicleDecl {
    pub name: Name,
    /// Its model: ATRV, ATRV-Jr, Blimp, or a declared one.
    pub model: Name,
    /// The location it starts from.
    pub start: Name,
    /// The whole declaration.
    pub span: Span,
}
