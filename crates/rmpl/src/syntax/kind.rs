//! The kinds of token and of node that a mission text is made of.

/// The word that begins the declaration of an area which vehicles may not enter.
pub(crate) const KEEPOUT: &str = "keepout";

/// The kind of a token or of a node of the syntax tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum SyntaxKind {
    /// Spaces, tabs and line ends.
    Whitespace,
    /// `// …`
    LineComment,
    /// `/* … */`
    BlockComment,
    /// Characters that begin no token; the lexer has reported them.
    Unknown,
    /// The end of the text; it has no width.
    End,

    /// A name that is not a keyword.
    Name,
    /// An unsigned number.
    Number,
    /// `"…"`
    String,
    /// `control { … }` with all that is in it, which is in prefix notation.
    ControlText,
    /// `inf` or `∞`
    Infinity,
    /// `{`
    LeftBrace,
    /// `}`
    RightBrace,
    /// `[`
    LeftBracket,
    /// `]`
    RightBracket,
    /// `(`
    LeftParen,
    /// `)`
    RightParen,
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// `:`
    Colon,
    /// `=`
    Equals,
    /// `!=`
    NotEquals,
    /// `!`
    Bang,
    /// `%`
    Percent,
    /// `+`
    Plus,
    /// `-`
    Minus,
    /// `*`
    Star,
    /// `/`
    Slash,
    /// `.` right behind a name or an index: `Rover.at`, `S[1].at`
    Dot,
    /// `..`
    DotDot,
    /// `<`, `<=`, `>` or `>=`
    Order,
    /// `choose`
    ChooseKeyword,
    /// `do`
    DoKeyword,
    /// `maintaining`
    MaintainingKeyword,
    /// `watching`
    WatchingKeyword,
    /// `if`
    IfKeyword,
    /// `thennext`
    ThennextKeyword,
    /// `var`
    VarKeyword,
    /// `primitive`
    PrimitiveKeyword,
    /// `scenario`
    ScenarioKeyword,
    /// `option`
    OptionKeyword,
    /// `delay`
    DelayKeyword,
    /// `not`
    NotKeyword,
    /// `tell`
    TellKeyword,
    /// `ask`
    AskKeyword,

    /// A declaration with the comments that belong to it.
    Root,
    /// `var X : { … };`
    VariableDecl,
    /// `primitive Name(…) … ;`
    PrimitiveDecl,
    /// `option name = value;`
    OptionDecl,
    /// `Name(…) … = { … }`
    ActivityDecl,
    /// `scenario Name … = { … }`
    ScenarioDecl,
    /// `control { … }`
    ControlDecl,
    /// `terrain "…" … ;`
    TerrainDecl,
    /// `location NAME (…);`
    LocationDecl,
    /// `obstacle NAME … ;` or `keepout NAME … ;`
    ObstacleDecl,
    /// `for R1, ATRV, Drive` of a keep-out area
    ClosedTo,
    /// `const NAME = … ;`
    ConstantDecl,
    /// `state X : { … } = V;`
    StateDecl,
    /// `resource NAME … ;`
    ResourceDecl,
    /// `objective … ;`
    ObjectiveDecl,
    /// `constrain NAME.start to OTHER.end [l,u];`
    ConstrainDecl,
    /// `import "…";`
    ImportDecl,
    /// `model NAME … { … }`
    ModelDecl,
    /// `group NAME = … ;`
    GroupDecl,
    /// `vehicle NAME : … ;`
    VehicleDecl,
    /// Text that is not a declaration; it has been reported.
    Garbage,
    /// `extends NAME` of a model.
    Extends,
    /// `body 0.8 x 0.6` and its like of a model.
    Property,
    /// A number of a property, perhaps with a unit.
    Quantity,
    /// `[1..4]` of a fleet.
    FleetRange,
    /// `: vehicle` of a parameter.
    ParameterKind,
    /// `(p, q)` in a header.
    Formals,
    /// `{V1, V2}` of a variable.
    Domain,
    /// `moves … speed(…) kinodynamic`
    Moves,
    /// `kinodynamic`
    Kinodynamic,
    /// `speed (a, b)`
    Speed,
    /// `runs Name`, perhaps with arguments.
    Runs,
    /// `(x, y, …)` of a world declaration.
    Coordinates,
    /// `cell 0.6`
    Cell,
    /// `origin (x, y)`
    Origin,
    /// `at NAME`
    At,
    /// `= V` of a state variable.
    Initial,
    /// `capacity N` of a resource.
    Capacity,
    /// `N .. N = N` of a resource.
    Range,
    /// `minimize …` or `maximize …`
    Goal,
    /// `requires …`, perhaps `at start`.
    Requires,
    /// `sets …`
    Sets,
    /// `X=V` of `sets`.
    Effect,
    /// `uses …`, `consumes …` or `produces …`
    Uses,
    /// A resource of such a clause, with its amount.
    ResourceUse,
    /// `costs …`
    Costs,
    /// `rewards …`
    Rewards,
    /// `aborts …`
    Aborts,
    /// An expression, perhaps with `per` and a unit.
    Amount,

    /// `[lower, upper]`
    Bounds,
    /// Operands joined by `+` and `-`.
    Sum,
    /// Operands joined by `*` and `/`.
    Product,
    /// An operand followed by `%`.
    PercentOf,
    /// `( … )` in a bound.
    Grouped,
    /// A number, perhaps with a unit of time, `inf` or a name in an expression.
    Operand,
    /// `-5` at the head of a bound between events.
    Negation,

    /// A core statement with the bounds after it.
    Statement,
    /// `{ … }`
    Block,
    /// Statements separated by `,`.
    Parallel,
    /// `choose { … }`
    Choose,
    /// One alternative of a choice.
    Alternative,
    /// `do … maintaining …`, `do … watching …` or `do … using …`
    Do,
    /// `if … thennext …`, perhaps with `else …`
    If,
    /// `repeat N { … }`
    Repeat,
    /// `free …`
    Free,
    /// `optional …`
    Optional,
    /// `unordered { … }`
    Unordered,
    /// `any … in …` or `each … in …`
    Members,
    /// `Name( … )`
    Call,
    /// `( … )` of a call.
    Arguments,
    /// A name, a number, an expression or a condition handed to a call.
    Argument,
    /// A condition as a statement, with `tell` or `ask` if written.
    Assertion,
    /// A name alone: a call or an assertion, as the file declares it.
    BareName,
    /// `delay`
    Delay,
    /// A literal with its negations and parentheses.
    Condition,
    /// `visible(BASE)` after `in`.
    Visible,
    /// Conditions joined by `and`.
    AllOf,
    /// Conditions joined by `or`.
    AnyOf,
    /// `not` before conditions in parentheses.
    NotOf,
    /// Conditions in parentheses.
    ConditionGroup,
    /// `Rover.at` or `Engine.mode` in a condition or an effect, and in the declaration of the latter.
    Dotted,
    /// `from plant` of a state.
    FromPlant,
    /// `as NAME` after a statement.
    Naming,
    /// `NAME.start` or `NAME.end`
    EventName,
    /// A flight rule (SPEC 16.1).
    Rule,
    /// `at end of Drive` or `from 10 to 20` of a flight rule.
    Moment,
    /// Tokens that were skipped to recover.
    Skipped,
}

impl SyntaxKind {
    /// Returns whether the grammar looks past it.
    pub const fn is_trivia(self) -> bool {
        matches!(self, Self::Whitespace | Self::LineComment | Self::BlockComment | Self::Unknown)
    }

    /// Returns whether it is a comment.
    pub const fn is_comment(self) -> bool {
        matches!(self, Self::LineComment | Self::BlockComment)
    }

    /// Returns whether it is a reserved word; `inf` counts, `∞` is the same token.
    pub const fn is_keyword(self) -> bool {
        self as u8 >= Self::ChooseKeyword as u8 && self as u8 <= Self::AskKeyword as u8
    }

    /// Returns whether it is a declaration, which is directly under the root.
    pub const fn is_declaration(self) -> bool {
        self as u8 >= Self::VariableDecl as u8 && self as u8 <= Self::VehicleDecl as u8
    }

    /// The reserved word spelled `text`.
    pub fn keyword(text: &str) -> Option<Self> {
        Some(match text {
            "choose" => Self::ChooseKeyword,
            "do" => Self::DoKeyword,
            "maintaining" => Self::MaintainingKeyword,
            "watching" => Self::WatchingKeyword,
            "if" => Self::IfKeyword,
            "thennext" => Self::ThennextKeyword,
            "var" => Self::VarKeyword,
            "primitive" => Self::PrimitiveKeyword,
            "scenario" => Self::ScenarioKeyword,
            "option" => Self::OptionKeyword,
            "delay" => Self::DelayKeyword,
            "not" => Self::NotKeyword,
            "tell" => Self::TellKeyword,
            "ask" => Self::AskKeyword,
            "inf" => Self::Infinity,
            _ => return None,
        })
    }

    /// Returns how a message calls the token.
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Name => "a name",
            Self::Number => "a number",
            Self::String => "a string",
            Self::ControlText => "a control block",
            Self::Infinity => "`inf`",
            Self::LeftBrace => "`{`",
            Self::RightBrace => "`}`",
            Self::LeftBracket => "`[`",
            Self::RightBracket => "`]`",
            Self::LeftParen => "`(`",
            Self::RightParen => "`)`",
            Self::Comma => "`,`",
            Self::Semicolon => "`;`",
            Self::Colon => "`:`",
            Self::Equals => "`=`",
            Self::NotEquals => "`!=`",
            Self::Bang => "`!`",
            Self::Percent => "`%`",
            Self::Plus => "`+`",
            Self::Minus => "`-`",
            Self::Star => "`*`",
            Self::Slash => "`/`",
            Self::Dot => "`.`",
            Self::DotDot => "`..`",
            Self::Order => "`<`, `<=`, `>` or `>=`",
            Self::ThennextKeyword => "`thennext`",
            Self::End => "the end of the text",
            _ => "this",
        }
    }
}
