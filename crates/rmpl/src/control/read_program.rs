//! From matched parentheses to the typed tree: definitions and expressions (SPEC 2.1).

use std::collections::BTreeSet;

use smol_str::SmolStr;

use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;

use super::keyword::{self, EXPRESSION_KEYWORDS, TIMED_KEYWORDS};
use super::lexer::{Token, TokenKind};
use super::suggest::nearest;
use super::syntax::{
    Argument, Constraint, ConstraintKind, ControlFile, Definition, Expression, ExpressionKind, Guard, Name,
};
use super::tree::{List, Node, Tree};

/// Reads all definitions, classes and components of a text.
pub(super) fn read(text: &str, tree: &Tree) -> (ControlFile, Vec<Diagnostic>) {
    let mut reader =
        Reader { text, diagnostics: Vec::new(), defined: defined(text, &tree.items), parameters: Vec::new() };
    let mut file = ControlFile::default();
    let mut rest = tree.items.as_slice();
    while !rest.is_empty() {
        let length = unit_length(rest);
        let (unit, after) = rest.split_at(length);
        let before = reader.diagnostics.len();
        reader.unit(unit, &mut file);
        // A parenthesis too few or too many has been reported; what it makes of its surroundings is no further
        // mistake of the author.
        let span = unit.iter().map(Node::span).reduce(Span::cover).unwrap_or_default();
        let next = after.first().map_or(u32::MAX, |node| node.span().start);
        let broken = tree.broken.iter().any(|place| place.start < next && place.end >= span.start);
        if broken {
            reader.diagnostics.truncate(before);
        }
        rest = after;
    }
    (file, reader.diagnostics)
}

/// The names of the definitions of a text.
fn defined<'text>(text: &'text str, items: &[Node]) -> BTreeSet<&'text str> {
    let names = (0..items.len()).filter(|&at| starts_definition(items, at));
    names.filter_map(|at| Some(keyword::word(text, items.get(at)?)?.0)).collect()
}

fn starts_definition(items: &[Node], at: usize) -> bool {
    matches!(items.get(at), Some(Node::Leaf(token)) if token.kind == TokenKind::Word)
        && matches!(items.get(at + 1), Some(Node::List(_)))
        && matches!(items.get(at + 2), Some(Node::Leaf(token)) if token.kind == TokenKind::DoubleColon)
}

/// Returns how many items belong to the definition, class, component or expression at the front.
fn unit_length(items: &[Node]) -> usize {
    if !starts_definition(items, 0) {
        // A guard's bar is before its list.
        let barred = matches!(items.first(), Some(Node::Leaf(token)) if token.kind == TokenKind::Tilde);
        return if barred && items.len() > 1 { 2 } else { 1 };
    }
    let barred = matches!(items.get(3), Some(Node::Leaf(token)) if token.kind == TokenKind::Tilde);
    let length = if barred { 5 } else { 4 };
    if starts_definition(items, 3) { 3 } else { length.min(items.len()) }
}

/// Reads nodes and collects what is wrong with them.
pub(super) struct Reader<'text> {
    pub(super) text: &'text str,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// The names of the text's definitions.
    pub(super) defined: BTreeSet<&'text str>,
    /// The parameters of the definition that is read.
    pub(super) parameters: Vec<SmolStr>,
}

impl Reader<'_> {
    pub(super) fn error(
        &mut self,
        code: &'static str,
        span: Span,
        message: impl Into<String>,
    ) -> &mut Diagnostic {
        self.diagnostics.push(Diagnostic::error(Code(code), span, message));
        let last = self.diagnostics.len() - 1;
        &mut self.diagnostics[last]
    }

    pub(super) fn name(&self, node: &Node) -> Option<Name> {
        keyword::word(self.text, node).map(|(text, span)| Name { text: SmolStr::new(text), span })
    }

    fn unit(&mut self, items: &[Node], file: &mut ControlFile) {
        let span = items.iter().map(Node::span).reduce(Span::cover).unwrap_or_default();
        if let [name, Node::List(parameters), _, body @ ..] = items
            && let Some(name) = self.name(name)
        {
            self.definition(name, parameters, body, span, file);
            return;
        }
        if let [Node::List(list)] = items
            && let Some(head) = keyword::head(self.text, &list.items)
        {
            match head.upper.as_str() {
                "DEFCLASS" => return file.classes.extend(self.class(list)),
                "DEFINSTANCE" => return file.instances.extend(self.instance(list)),
                "DEFOPTION" => return file.options.extend(self.option(list)),
                "DEFSTEP" => return file.steps.extend(self.step_length(list)),
                _ => {}
            }
        }
        if let [Node::Leaf(token)] = items
            && !(token.kind == TokenKind::Word
                && matches!(self.word_text(*token).to_ascii_lowercase().as_str(), "true" | "false"))
        {
            self.stray(*token);
            return;
        }
        let body = self.expression_of(items, span);
        if let Some(earlier) = file.definitions.iter().find(|definition| definition.name.text == "main") {
            let whole = earlier.name.span == earlier.span;
            if whole {
                self.error("E-SYNTAX", span, "only one expression may have no name").hint = Some(
                    "name each one, as in `Name ():: (PARALLEL …)`, or join them with PARALLEL or SEQUENCE"
                        .into(),
                );
                return;
            }
        }
        let name = Name { text: SmolStr::new_static("main"), span };
        file.definitions.push(Definition { name, parameters: Vec::new(), body, span });
    }

    fn definition(
        &mut self,
        name: Name,
        parameters: &List,
        body: &[Node],
        span: Span,
        file: &mut ControlFile,
    ) {
        let mut names: Vec<Name> = Vec::new();
        for item in &parameters.items {
            match (self.name(item), item) {
                (Some(parameter), _) => {
                    if names.iter().any(|known| known.text == parameter.text) {
                        self.error(
                            "E-DUP",
                            parameter.span,
                            format!("`{}` has two parameters `{}`", name.text, parameter.text),
                        );
                    } else {
                        names.push(parameter);
                    }
                }
                (None, Node::Leaf(token)) if token.kind == TokenKind::Comma => {}
                _ => {
                    self.error("E-SYNTAX", item.span(), "a parameter must be a name");
                }
            }
        }
        if body.is_empty() {
            self.error(
                "E-SYNTAX",
                span,
                format!("the definition of `{}` is empty: add an expression after `::`", name.text),
            );
        }
        self.parameters = names.iter().map(|name| name.text.clone()).collect();
        let body = self.expression_of(body, span);
        self.parameters.clear();
        file.definitions.push(Definition { name, parameters: names, body, span });
    }

    fn stray(&mut self, token: Token) {
        let word = self.word_text(token).to_owned();
        let diagnostic =
            self.error("E-SYNTAX", token.span, format!("unexpected `{word}` outside any definition"));
        diagnostic.hint = Some(
            "expected a definition such as `Main ():: …`, a class `(DEFCLASS …)`, a component `(DEFINSTANCE …)` or an option `(DEFOPTION …)`"
                .into(),
        );
    }

    fn word_text(&self, token: Token) -> &str {
        self.text.get(token.span.range()).unwrap_or("")
    }

    /// The expression that `items` write; more than a barred or plain node has been cut off before.
    pub(super) fn expression_of(&mut self, items: &[Node], span: Span) -> Expression {
        match items {
            [] => Expression { kind: ExpressionKind::Unreadable, span },
            [node] => self.expression(node),
            [bar, _, ..] => {
                self.error("E-CONSTRAINT", bar.span(), "non-entailment can be a guard, but not an assertion").hint =
                    Some("use `~c` as the guard of IF, UNLESS, WHEN, WHENEVER or DO-WATCHING; to assert the opposite of c, write `(NOT c)`".into());
                Expression { kind: ExpressionKind::Unreadable, span }
            }
        }
    }

    /// Reads one node as an expression.
    pub(super) fn expression(&mut self, node: &Node) -> Expression {
        let span = node.span();
        let kind = match node {
            Node::Leaf(token) => self.bare(*token),
            Node::List(list) if list.braced => {
                self.error("E-SYNTAX", span, "braces enclose the values of a domain, not an expression")
                    .hint = Some("use parentheses".into());
                ExpressionKind::Unreadable
            }
            Node::List(list) => self.list(list),
        };
        Expression { kind, span }
    }

    fn bare(&mut self, token: Token) -> ExpressionKind {
        let text = SmolStr::new(self.word_text(token));
        let constraint = |kind| ExpressionKind::Assert(Constraint { kind, span: token.span });
        match (token.kind, text.to_ascii_lowercase().as_str()) {
            (TokenKind::Word, "true") => constraint(ConstraintKind::True),
            (TokenKind::Word, "false") => constraint(ConstraintKind::False),
            (TokenKind::Word, _) => {
                let name = Name { text, span: token.span };
                ExpressionKind::Call { name, arguments: Vec::new(), bare: true }
            }
            _ => {
                self.error("E-SYNTAX", token.span, format!("expected an expression, found `{text}`"));
                ExpressionKind::Unreadable
            }
        }
    }

    fn list(&mut self, list: &List) -> ExpressionKind {
        if self.is_constraint(list) {
            let constraint = self.constraint_list(list);
            return ExpressionKind::Assert(constraint);
        }
        let Some(head) = keyword::head(self.text, &list.items) else {
            if let [inner @ Node::List(_)] = list.items.as_slice() {
                return self.expression(inner).kind;
            }
            if list.items.is_empty() {
                self.error("E-SYNTAX", list.span, "these parentheses are empty");
            } else {
                self.error(
                    "E-SYNTAX",
                    list.span,
                    "start a form with its name, or write a constraint as `(variable = value)`",
                );
            }
            return ExpressionKind::Unreadable;
        };
        let arguments = list.items.get(head.length..).unwrap_or_default();
        match head.upper.as_str() {
            "NOT-ENTAILED" => {
                self.error("E-CONSTRAINT", head.span, "non-entailment can be a guard, but not an assertion").hint =
                    Some("use it as the guard of IF, UNLESS, WHEN, WHENEVER or DO-WATCHING; to assert the opposite of c, write `(NOT c)`".into());
                ExpressionKind::Unreadable
            }
            "HELD" if !self.calls_definition(list) => {
                self.error("E-CONSTRAINT", head.span, "HELD can be a guard, but not an assertion").hint =
                    Some("use it as the guard of IF, UNLESS, WHEN, WHENEVER or DO-WATCHING".into());
                ExpressionKind::Unreadable
            }
            "DEFCLASS" | "DEFINSTANCE" | "DEFOPTION" | "DEFSTEP" => {
                self.error("E-FORM", head.span, format!("{} cannot be inside an expression", head.upper))
                    .hint = Some(
                    "move it out of the definition: declare classes, components, options and the step at the top level"
                        .into(),
                );
                ExpressionKind::Unreadable
            }
            keyword if EXPRESSION_KEYWORDS.contains(&keyword) && !self.calls_definition(list) => {
                self.form(keyword, head.span, arguments)
            }
            _ => self.call(list, arguments),
        }
    }

    fn form(&mut self, keyword: &str, span: Span, items: &[Node]) -> ExpressionKind {
        if matches!(keyword, "PARALLEL" | "SEQUENCE") {
            if items.is_empty() {
                self.error("E-ARITY", span, format!("{keyword} needs at least one expression"));
                return ExpressionKind::Unreadable;
            }
            let parts = Self::parts_of(items).into_iter().map(|part| self.part(part)).collect();
            return if keyword == "PARALLEL" {
                ExpressionKind::Parallel(parts)
            } else {
                ExpressionKind::Sequence(parts)
            };
        }
        if keyword == "ALWAYS" {
            let [body] = items else {
                return self.wrong_arity(keyword, span, "one expression", items.len());
            };
            return ExpressionKind::Always(Box::new(self.expression(body)));
        }
        if TIMED_KEYWORDS.contains(&keyword) {
            return self.timed_form(keyword, span, items);
        }
        self.guarded_form(keyword, span, items)
    }

    fn guarded_form(&mut self, keyword: &str, span: Span, items: &[Node]) -> ExpressionKind {
        let bars = items
            .iter()
            .take_while(|node| matches!(node, Node::Leaf(token) if token.kind == TokenKind::Tilde))
            .count();
        let bodies = if keyword == "IF-THENNEXT-ELSENEXT" { 2 } else { 1 };
        let (guard_items, rest) = items.split_at((bars + 1).min(items.len()));
        if guard_items.len() == bars || rest.len() != bodies {
            let wanted = if bodies == 2 {
                "a condition and two expressions"
            } else {
                "a condition and one expression"
            };
            let given = items.len().saturating_sub(bars);
            if keyword == "IF-THENNEXT" && rest.len() == 2 {
                self.error(
                    "E-ARITY",
                    span,
                    "IF-THENNEXT takes a condition and one expression, but has two expressions",
                )
                .hint = Some("with an alternative, use IF-THENNEXT-ELSENEXT".into());
                return ExpressionKind::Unreadable;
            }
            return self.wrong_arity(keyword, span, wanted, given);
        }
        let guard = self.guard(guard_items);
        let mut bodies =
            rest.iter().map(|node| Box::new(self.expression(node))).collect::<Vec<_>>().into_iter();
        let (Some(body), otherwise) = (bodies.next(), bodies.next()) else {
            return ExpressionKind::Unreadable;
        };
        match keyword {
            "IF-THENNEXT-ELSENEXT" | "IF-THENNEXT" => {
                ExpressionKind::IfThenNext { guard, then: body, otherwise }
            }
            "UNLESS-THENNEXT" => ExpressionKind::UnlessThenNext { guard, body },
            "WHEN-DONEXT" => ExpressionKind::WhenDoNext { guard, body },
            "WHENEVER-DONEXT" => ExpressionKind::WheneverDoNext { guard, body },
            _ => ExpressionKind::DoWatching { guard, body },
        }
    }

    pub(super) fn wrong_arity(
        &mut self,
        keyword: &str,
        span: Span,
        wanted: &str,
        given: usize,
    ) -> ExpressionKind {
        let parts = if given == 1 { "part is" } else { "parts are" };
        self.error("E-ARITY", span, format!("{keyword} takes {wanted}, but {given} {parts} given"));
        ExpressionKind::Unreadable
    }

    pub(super) fn guard(&mut self, items: &[Node]) -> Guard {
        let span = items.iter().map(Node::span).reduce(Span::cover).unwrap_or_default();
        let (bars, constraint) = items.split_at(items.len().saturating_sub(1));
        let Some(node) = constraint.first() else {
            return Guard::unreadable(span);
        };
        if let [_, second, ..] = bars {
            self.error("E-CONSTRAINT", second.span(), "write `~` only once").hint = Some(
                "`~` tests whether something is not known; for the opposite of a constraint, write `(NOT c)`"
                    .into(),
            );
        }
        let mut non_entailed = !bars.is_empty();
        let mut inner = node;
        if let Node::List(list) = node
            && let Some(head) = keyword::head(self.text, &list.items)
            && head.upper == "NOT-ENTAILED"
        {
            match list.items.get(head.length..) {
                Some([only]) if !non_entailed => {
                    non_entailed = true;
                    inner = only;
                }
                Some([_]) => {
                    self.error("E-CONSTRAINT", span, "NOT-ENTAILED is repeated; write it once");
                }
                _ => {
                    self.error("E-ARITY", head.span, "NOT-ENTAILED takes one constraint");
                }
            }
        } else if let Node::List(list) = node
            && let [Node::Leaf(bar), wrapped] = list.items.as_slice()
            && bar.kind == TokenKind::Tilde
            && !non_entailed
        {
            // `(~ c)` can mean nothing else than `~c`.
            non_entailed = true;
            inner = wrapped;
        }
        if let Some(held) = self.held_guard(inner, non_entailed, span) {
            return held;
        }
        Guard { non_entailed, held: None, constraint: self.constraint(inner), span }
    }

    fn call(&mut self, list: &List, items: &[Node]) -> ExpressionKind {
        let Some(name) = list.items.first().and_then(|node| self.name(node)) else {
            return ExpressionKind::Unreadable;
        };
        let mut arguments = Vec::new();
        for part in Self::parts_of(items) {
            match part {
                [_, _, ..] => arguments.push(Argument::Guard(self.guard(part))),
                [Node::Leaf(token)] if token.kind == TokenKind::Comma => {}
                [word @ Node::Leaf(token)] if token.kind == TokenKind::Word => {
                    arguments.extend(self.name(word).map(Argument::Word));
                }
                [node @ Node::List(inner)] if !self.calls_definition(inner) => {
                    let held = self.held_guard(node, false, node.span());
                    arguments.push(match held {
                        Some(held) => Argument::Guard(held),
                        None => Argument::Expression(self.expression(node)),
                    });
                }
                _ => arguments.push(Argument::Expression(self.part(part))),
            }
        }
        ExpressionKind::Call { name, arguments, bare: false }
    }

    /// A hint about the keyword that `word` nearly is.
    pub(super) fn keyword_hint(word: &str) -> Option<String> {
        nearest(&word.to_ascii_uppercase(), EXPRESSION_KEYWORDS).map(|known| format!("did you mean {known}?"))
    }
}
