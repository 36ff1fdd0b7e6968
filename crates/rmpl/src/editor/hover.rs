//! What is known about the thing under the pointer.

use exact::{Bound, Time};
use smol_str::SmolStr;

use super::definition::references_of;
use super::name::{NameKind, NameUse, name_at};
use super::topic::Topic;
use super::users::{users_of_resource, users_of_state, users_of_vehicle};
use crate::analysis::constant::Constants;
use crate::lower::bounds::{contingent_in, expression};
use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode, SyntaxToken};

/// What compiling and planning found out about the text, as far as it is known. Without it, hovering shows what the
/// text alone says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluation {
    /// The calls of activities, expanded.
    pub invocations: Vec<Invocation>,
    /// The windows of the current plan.
    pub windows: Vec<EventWindow>,
}

/// One call of an activity in the compiled mission, and the bounds that it has there.
#[derive(Clone, Debug, PartialEq)]
pub struct Invocation {
    /// The activity that is called.
    pub activity: SmolStr,
    /// The occurrence, such as `Group-Enroute#1`.
    pub occurrence: SmolStr,
    /// The lower bound of the call: the value of the header's first name.
    pub lower: Time,
    /// The upper bound of the call: the value of the header's second name.
    pub upper: Bound,
}

/// When an event of the current plan can happen.
#[derive(Clone, Debug, PartialEq)]
pub struct EventWindow {
    /// The statement whose event it is.
    pub span: Span,
    /// The event, such as `Group-Wait#1.start`.
    pub event: SmolStr,
    pub earliest: Time,
    /// The latest time.
    pub latest: Bound,
}

/// What the editor shows about the place under the pointer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hover {
    /// What it is about.
    pub span: Span,
    /// The part of the language that it belongs to.
    pub topic: Topic,
    /// The text, in Markdown.
    pub markdown: String,
}

/// Returns what is known about the name, the bound or the word at `offset`.
pub fn hover(parse: &Parse, offset: u32, evaluation: &Evaluation) -> Option<Hover> {
    if let Some(found) = hover_bound(parse, offset, evaluation) {
        return Some(found);
    }
    if let Some(name) = name_at(parse, offset) {
        let topic = Topic::of_name(parse, &name);
        return Some(Hover { span: name.span, topic, markdown: describe(parse, &name, evaluation) });
    }
    let root = parse.declaration_at(offset)?;
    let token = root.tokens().find(|token| token.span.start <= offset && offset < token.span.end)?;
    if let Some(markdown) = contingent(parse, root, token, evaluation) {
        return Some(Hover { span: token.span, topic: Topic::Nature, markdown });
    }
    let markdown = word(token)?.to_owned();
    Some(Hover { span: token.span, topic: Topic::of_word(token.kind, token.text), markdown })
}

/// Returns what the environment may do within the bounds whose word `token` is, and what is left to the executive.
fn contingent(
    parse: &Parse,
    root: SyntaxNode<'_>,
    token: SyntaxToken<'_>,
    evaluation: &Evaluation,
) -> Option<String> {
    let bounds = root.path_to(token.span.end).into_iter().rfind(|node| node.kind() == SyntaxKind::Bounds)?;
    let word = contingent_in(bounds).filter(|word| word.span == token.span)?;
    let mut lines = vec![CONTINGENT_MEANING.to_owned()];
    let constants = Constants::new(&parse.program());
    let mut sides = bounds.children().map(|side| constants.evaluate(&expression(side)?, &|_| None));
    if let (Some(Some(least)), Some(Some(most))) = (sides.next(), sides.next()) {
        lines.push(format!("Uncontrolled duration: **{least}** to **{most}**."));
    }
    let windows = windows_at(evaluation, word.span);
    if !windows.is_empty() {
        lines.push(windows.join("\n"));
    }
    Some(lines.join("\n\n"))
}

/// What the word before bounds means.
const CONTINGENT_MEANING: &str = "`contingent [l,u]`: the environment chooses the duration. The executive decides the start, \
    observes the end, and can react at the same instant. The plan must work for every duration in the range.";

/// The values of the smallest expression around `offset` in every invocation of its activity.
fn hover_bound(parse: &Parse, offset: u32, evaluation: &Evaluation) -> Option<Hover> {
    let root = parse.declaration_at(offset)?;
    let path = root.path_to(offset);
    path.iter().find(|node| node.kind() == SyntaxKind::Bounds)?;
    let node = path.iter().rev().find(|node| {
        matches!(
            node.kind(),
            SyntaxKind::Sum
                | SyntaxKind::Product
                | SyntaxKind::PercentOf
                | SyntaxKind::Operand
                | SyntaxKind::Grouped
        )
    })?;
    // The whole side says more than its parts, unless the pointer is on a name.
    let name = plain_name(*node);
    let side = path.iter().skip_while(|node| node.kind() != SyntaxKind::Bounds).nth(1)?;
    let shown = if name.is_some() { node } else { side };
    let constants = Constants::new(&parse.program());
    let activity = path.iter().find(|node| node.kind() == SyntaxKind::ActivityDecl);
    let header: Vec<Option<&str>> = activity
        .and_then(|activity| activity.child(SyntaxKind::Bounds))
        .into_iter()
        .flat_map(SyntaxNode::children)
        .map(|side| plain_name(side).filter(|name| constants.value(name).is_none()))
        .collect();
    let value = |node: &SyntaxNode<'_>, invocation: Option<&Invocation>| {
        let lookup = |name: &str| match header.iter().position(|bound| *bound == Some(name))? {
            0 => Some(Bound::Finite(invocation?.lower)),
            _ => Some(invocation?.upper),
        };
        constants.evaluate(&expression(*node)?, &lookup)
    };
    let mut lines = vec![format!("`{}`", shown.text())];
    let own_name = activity.and_then(|activity| activity.token(SyntaxKind::Name)).map(|name| name.text);
    let is_own = |invocation: &&Invocation| Some(invocation.activity.as_str()) == own_name;
    let is_of_header = |name: &str| header.contains(&Some(name));
    let depends_on_call = name.is_none_or(is_of_header);
    let invocations = evaluation.invocations.iter().filter(is_own).filter(|_| depends_on_call);
    for invocation in invocations.take(MAX_LINES) {
        if let Some(result) = value(shown, Some(invocation)) {
            lines.push(format!("= **{result}** in {}", invocation.occurrence));
        }
        if name.is_some()
            && shown.span() != side.span()
            && let Some(result) = value(side, Some(invocation))
        {
            lines.push(format!("`{}` = **{result}** in {}", side.text(), invocation.occurrence));
        }
    }
    if lines.len() == 1 {
        match name {
            Some(name) if is_of_header(name) => lines.push("a bound of the call".to_owned()),
            // What else a name is, its declaration says.
            Some(_) => return None,
            None => {
                let says_more = shown.tokens().filter(|token| !token.kind.is_trivia()).count() > 1;
                let result = value(shown, None).filter(|_| says_more)?;
                lines.push(format!("= **{result}**"));
            }
        }
    }
    Some(Hover { span: shown.span(), topic: Topic::Bounds, markdown: lines.join("  \n") })
}

/// The name that an operand is; what follows a number is a unit.
fn plain_name(node: SyntaxNode<'_>) -> Option<&str> {
    let is_operand = node.kind() == SyntaxKind::Operand && node.token(SyntaxKind::Number).is_none();
    node.token(SyntaxKind::Name).filter(|_| is_operand).map(|name| name.text)
}

/// How many occurrences a hover lists.
const MAX_LINES: usize = 8;

fn describe(parse: &Parse, name: &NameUse, evaluation: &Evaluation) -> String {
    let places = references_of(parse, name);
    let definition = places.iter().find(|place| place.is_definition).map(|place| place.span);
    let mut parts = Vec::new();
    match (definition, &name.kind) {
        (Some(place), NameKind::Occurrence) => parts.extend(named(parse, place)),
        (Some(place), kind) if !kind.is_local() => {
            let declared = parse.declaration_at(place.start).and_then(|root| root.children().next());
            let is_natures = declared.and_then(|it| contingent_in(it.child(SyntaxKind::Bounds)?)).is_some();
            if let Some((header, comments)) = parse.declaration_at(place.start).and_then(header) {
                parts.push(format!("```rmpl\n{header}\n```"));
                if !comments.is_empty() {
                    parts.push(comments);
                }
            }
            if is_natures && *kind == NameKind::Activity {
                parts.push(
                    "The environment chooses the duration. In a call, bounds without `contingent` only limit it."
                        .to_owned(),
                );
            }
            let value = || Constants::new(&parse.program()).value(&name.text);
            let users = match kind {
                NameKind::Variable if is_state(parse, &name.text) => users_of_state(parse, &name.text),
                NameKind::Resource => users_of_resource(parse, &name.text),
                NameKind::Vehicle => users_of_vehicle(parse, &name.text),
                _ => Vec::new(),
            };
            if !users.is_empty() {
                parts.push(users.join("  \n"));
            }
            if let Some(value) = (*kind == NameKind::Constant).then(value).flatten() {
                parts.push(format!("= **{value}**"));
            }
        }
        (_, NameKind::Parameter) => parts.push(format!("`{}`: a parameter", name.text)),
        (_, NameKind::BoundName) => parts.push(format!("`{}`: a bound of the call", name.text)),
        (_, NameKind::Constant) => parts.push(format!("`{}`: a constant", name.text)),
        (_, NameKind::Activity) => {
            parts.push(format!("`{}`: an undeclared primitive with duration [0,inf]", name.text));
        }
        (_, NameKind::Variable) => {
            parts.push(format!("`{}`: an undeclared condition; any value is allowed", name.text));
        }
        (_, NameKind::Value(variable)) => parts.push(format!("`{}`: a value of `{variable}`", name.text)),
        (_, NameKind::Resource) => parts.push(format!("`{}`: an undeclared resource", name.text)),
        (_, NameKind::Vehicle) => parts.push(format!("`{}`: an undeclared vehicle", name.text)),
        (_, NameKind::Occurrence) => parts.push(format!("`{}`: unknown name", name.text)),
        (_, NameKind::Model) => parts.push(format!("`{}`: a vehicle model", name.text)),
        (_, NameKind::Group) => parts.push(format!("`{}`: an undeclared group", name.text)),
        (_, NameKind::Equipment) => parts.push(format!("`{}`: equipment of a vehicle", name.text)),
        (_, NameKind::ControlProgram) => parts.push(format!("`{}`: a control program", name.text)),
        _ => parts.push(format!("`{}`: a symbol", name.text)),
    }
    let calls = evaluation.invocations.iter().filter(|call| call.activity == name.text);
    if name.kind == NameKind::Activity {
        let lines: Vec<String> = calls
            .take(MAX_LINES)
            .map(|call| format!("- {}: [{},{}]", call.occurrence, call.lower, call.upper))
            .collect();
        if !lines.is_empty() {
            parts.push(lines.join("\n"));
        }
    }
    let windows = windows_at(evaluation, name.span);
    if !windows.is_empty() {
        parts.push(windows.join("\n"));
    }
    parts.join("\n\n")
}

/// The statement that is named at `place`, without its blocks.
fn named(parse: &Parse, place: Span) -> Option<String> {
    let root = parse.declaration_at(place.start)?;
    let statement = root.path_to(place.end).into_iter().rfind(|node| node.kind() == SyntaxKind::Statement)?;
    let words: Vec<&str> = statement.text().split_whitespace().collect();
    let text = words.join(" ");
    let shown: String = text.chars().take(MAX_STATEMENT).collect();
    let rest = if shown.len() < text.len() { " …" } else { "" };
    Some(format!("```rmpl\n{shown}{rest}\n```\nNames this occurrence for use in `constrain`."))
}

/// How many characters of a statement a hover shows.
const MAX_STATEMENT: usize = 120;

pub(super) fn is_state(parse: &Parse, name: &str) -> bool {
    let meaning = parse.meaning();
    meaning.names.find(name).is_some_and(|symbol| meaning.is_state(symbol))
}

/// The windows of the smallest statement around `span`.
fn windows_at(evaluation: &Evaluation, span: Span) -> Vec<String> {
    let contains = |window: &&EventWindow| window.span.start <= span.start && span.end <= window.span.end;
    let around: Vec<&EventWindow> = evaluation.windows.iter().filter(contains).collect();
    let smallest = around.iter().map(|window| window.span.end - window.span.start).min();
    let own = around.into_iter().filter(|window| Some(window.span.end - window.span.start) == smallest);
    own.take(MAX_LINES)
        .map(|window| format!("- {} in [{},{}]", window.event, window.earliest, window.latest))
        .collect()
}

/// A declaration without its body, on one line, and the comments before it.
pub(super) fn header(root: SyntaxNode<'_>) -> Option<(String, String)> {
    let declaration = root.children().next()?;
    let end = declaration.child(SyntaxKind::Block).map_or(declaration.span().end, |body| body.span().start);
    let length = (end - declaration.span().start) as usize;
    let text = declaration.text().get(..length).unwrap_or("");
    let words: Vec<&str> = text.split_whitespace().collect();
    let header = words.join(" ");
    let header = header.trim_end_matches([';', '=', ' ']);
    // Only the comment right above belongs to the declaration: an empty line sets others apart.
    let mut comments: Vec<&str> = Vec::new();
    for token in root.tokens().take_while(|token| token.span.start < declaration.span().start) {
        if token.kind.is_comment() {
            comments.push(token.text);
        } else if token.text.matches('\n').count() > 1 {
            comments.clear();
        }
    }
    let plain = |comment: &&str| {
        comment.trim_start_matches("//").trim_start_matches("/*").trim_end_matches("*/").trim().to_owned()
    };
    let comments: Vec<String> = comments.iter().map(plain).collect();
    Some((header.to_owned(), comments.join("\n")))
}

/// Returns what a word of the language means.
fn word(token: SyntaxToken<'_>) -> Option<&'static str> {
    Some(match token.kind {
        SyntaxKind::ChooseKeyword => "`choose { A, B }`: the planner selects exactly one alternative.",
        SyntaxKind::DoKeyword => {
            "`do A maintaining c`: A requires `c` throughout. `do A watching c`: A asserts that `c` is false throughout, and \
             ends when `c` becomes true. `do A using R n`: A uses n of the resource R throughout."
        }
        SyntaxKind::MaintainingKeyword => "`do A maintaining c`: an assertion of `c` must contain A.",
        SyntaxKind::WatchingKeyword => "`do A watching c`: the plan asserts that `c` is false during A.",
        SyntaxKind::IfKeyword | SyntaxKind::ThennextKeyword => {
            "`if c thennext A`: A requires `c` at its start. Bounds after it belong to A."
        }
        SyntaxKind::DelayKeyword => "`delay[l,u]`: wait this long; without bounds, [0,inf].",
        SyntaxKind::NotKeyword | SyntaxKind::Bang => "`not c`, `!c`: the condition is false.",
        SyntaxKind::TellKeyword => "`tell c[l,u]`: asserts `c` for this long; without bounds, [0,0].",
        SyntaxKind::AskKeyword => "`ask c[l,u]`: requires `c` for this long.",
        SyntaxKind::VarKeyword => {
            "`var X : {V1, V2};` declares a variable and its values. It has a value only while it is asserted; a `state` keeps its value."
        }
        SyntaxKind::PrimitiveKeyword => "`primitive A(p)[l,u];` declares an atomic activity.",
        SyntaxKind::ScenarioKeyword => "`scenario S[l,u] = { … }`: the part to plan, and its total duration.",
        SyntaxKind::OptionKeyword => {
            "`option name = value;` The options are `threat_gap`, `strict`, `time_unit`, `control_step` and `controllability`."
        }
        SyntaxKind::Infinity => "`inf`: no maximum.",
        SyntaxKind::Order => {
            "`R >= n`: the level of the reservoir R must be at least n for as long as the condition is required; with `at start`, \
             only just before the start."
        }
        SyntaxKind::Name => return word_in_its_place(token.text),
        _ => return None,
    })
}

/// Returns what a word means that is one of the language only in its place.
fn word_in_its_place(word: &str) -> Option<&'static str> {
    Some(match word {
        "const" => "`const NAME = e;`: a named number for bounds, arguments and `repeat`.",
        "state" => {
            "`state X : {V1, V2} = V1;`: a variable with initial value V1 that keeps its value until an activity sets it."
        }
        "resource" => {
            "`resource R;`: one user at a time. `resource R capacity n;`: a capacity of n. `resource R a..b = c;`: a level \
             that starts at c and stays between a and b."
        }
        "capacity" => "`resource R capacity n;`: at most n can be in use at a time.",
        "objective" => {
            "`objective minimize cost, maximize reward;`: goals for the best plan, the most important first."
        }
        "minimize" => "`minimize cost`: prefers lower values.",
        "maximize" => "`maximize reward`: prefers higher values.",
        "cost" => "`cost`: total cost of the selected activities.",
        "reward" => "`reward`: total reward of the selected activities.",
        "end" => "`end`: the earliest end of the scenario.",
        "length" => "`length`: the distance driven, in meters.",
        "requires" => {
            "`requires X=V`: the condition must be true throughout the activity; `requires at start X=V`: only when it starts."
        }
        "sets" => "`sets X=V`: X changes during the activity, and is V when the activity ends.",
        "uses" => "`uses R n`: uses n of R from the start to the end of the activity; without an amount, 1.",
        "consumes" => {
            "`consumes R n`: removes n from R when the activity starts. `per minute`: for each minute of its maximum duration."
        }
        "produces" => {
            "`produces R n`: adds n to R when the activity ends. `per minute`: for each minute of its minimum duration."
        }
        "costs" => "`costs n`: adds n to `cost`; `costs n per metre`: adds n for each meter of the path.",
        "rewards" => "`rewards n`: adds n to `reward`.",
        "aborts" => {
            "`aborts [a,b]`: the executive may end the activity early, which takes a to b. Its effects then do not happen."
        }
        "per" => {
            "`n per minute`, `per second`, `per hour`: n times the duration. `n per metre`: n times the length of the path."
        }
        "using" => {
            "`do A using R n`: A uses n of the resource R from its start to its end; without an amount, 1."
        }
        "optional" => "`optional A`: the planner may include or skip A. Bounds after it belong to A.",
        "unordered" => {
            "`unordered { A; B; C }`: all of them, one at a time, in an order that the planner chooses."
        }
        "at" => {
            "`V.at`: the location of the vehicle V. `vehicle V : MODEL at L;`: V starts at L. `requires at start c`: c must \
             be true when the activity starts."
        }
        "start" => "`requires at start c`: c must be true when the activity starts, and may change later.",
        "repeat" => "`repeat n { A }`: n copies of A, one after the other.",
        "free" => "`free A`: same as `delay; A`. The branch may start later.",
        "else" => {
            "`if c thennext A else B`: the planner chooses A where `c` is true, or B where it is false."
        }
        "and" => "`a and b`: both are true.",
        "or" => "`a or b`: the planner chooses which of the two it relies on.",
        "in" => {
            "`X in {V, W}`: X has one of these values. `V.at in visible(L)`: V is at a location from which it sees L."
        }
        "visible" => {
            "`V.at in visible(L)`: V is at a location from which its mast has a clear line of sight to 2 m above L."
        }
        "s" | "min" | "h" | "d" | "sol" => {
            "A unit of time: `s`, `min`, `h`, `d` (24 hours) or `sol` (88,775.244 seconds), converted exactly."
        }
        "as" => "`A as NAME`: names this occurrence, so that `constrain` can refer to its start and its end.",
        "constrain" | "to" => {
            "`constrain X.start to Y.end [l,u];`: Y must end at least l and at most u after X starts, if both are selected. \
             With a negative l, Y may end up to -l before X starts."
        }
        "import" => "`import \"file\";`: includes the declarations of another file of the mission.",
        "model" | "extends" => {
            "`model M extends N { … }`: what vehicles of M can do, and the resources and states that each of them has. M \
             inherits the rest from N."
        }
        "group" => {
            "`group G = R1, S, A;`: vehicles, fleets, locations, values or groups, for `any` and `each`."
        }
        "any" => "`any x in G A`: the planner chooses one member x of the group G, and A is done for it.",
        "each" | "sequence" => {
            "`each x in G A`: A for every member x of the group G, in parallel. `in sequence`: one after the other. \
             `unordered`: one at a time, in an order that the planner chooses."
        }
        "body" => "`body 0.8 x 0.6`: length and width, in meters.",
        "slope" => "`slope 20 degrees`: the steepest slope that the vehicle drives; at most 60 degrees.",
        "clearance" => {
            "`clearance 0.3`: diameter of the largest rock that the vehicle passes over, in meters. For a model that flies, the \
             minimum height above the ground."
        }
        "turning" => "`turning 0.5`: radius of the tightest turn at the maximum speed, in meters.",
        "mast" => "`mast 1.2`: height of the antenna over the ground, in meters, for `visible`.",
        "flies" => {
            "`flies (10, 40)`: minimum and maximum altitude over the lowest ground of the map, in meters."
        }
        "vehicle" => {
            "`vehicle R1, S[1..4] : M at L;`: vehicles of the model M that start at L: R1, S[1] to S[4]."
        }
        "moves" => "`moves V1, V2`: the activity is a traverse; the first vehicle leads.",
        "speed" => "`speed (minimum, maximum)`, in meters per second.",
        "kinodynamic" => {
            "`moves V kinodynamic`: the duration includes turning, speeding up and slowing down within the limits of V's \
             model."
        }
        "runs" => {
            "`runs P`: the activity runs the control program P; `runs P(C)` passes it the component C, or a parameter of the \
             activity."
        }
        "mode" | "from" | "plant" => {
            "`state C.mode from plant;`: makes the mode of the component C a state of the mission. It starts with the \
             plant's initial mode. While control programs run, it is the most likely mode."
        }
        "cell" => "`cell 0.6`: size of a map cell, in meters.",
        "origin" => "`origin (x, y)`: position of the map's south-west corner, in meters.",
        _ => return None,
    })
}
