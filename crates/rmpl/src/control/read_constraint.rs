//! Reading constraints: equalities joined by AND, OR and NOT (SPEC 2.1).

use crate::span::Span;

use super::keyword;
use super::lexer::TokenKind;
use super::read_program::Reader;
use super::syntax::{Constraint, ConstraintKind};
use super::tree::{List, Node};

impl Reader<'_> {
    /// Returns whether a list is a constraint rather than a form or call.
    pub(super) fn is_constraint(&self, list: &List) -> bool {
        if list.items.iter().any(|node| is_leaf(node, TokenKind::Equals)) {
            return true;
        }
        match list.items.first() {
            Some(Node::Leaf(token)) if token.kind == TokenKind::Word => {
                let head = self.upper(&list.items[0]);
                matches!(head.as_str(), "NOT" | "AND" | "OR" | "TRUE" | "FALSE")
                    || self.has_connective(&list.items)
            }
            Some(Node::List(inner)) => {
                !inner.braced && (self.is_constraint(inner) || self.has_connective(&list.items))
            }
            _ => false,
        }
    }

    fn has_connective(&self, items: &[Node]) -> bool {
        items.iter().skip(1).any(|node| self.is_connective(node))
    }

    fn upper(&self, node: &Node) -> String {
        keyword::word(self.text, node).map_or_else(String::new, |(word, _)| word.to_ascii_uppercase())
    }

    /// Reads one node as a constraint.
    pub(super) fn constraint(&mut self, node: &Node) -> Constraint {
        let span = node.span();
        let kind = match node {
            Node::List(list) if !list.braced => return self.constraint_list(list),
            Node::List(_) => {
                self.error("E-SYNTAX", span, "braces enclose the values of a domain, not a constraint")
                    .hint = Some("use parentheses".into());
                ConstraintKind::Unreadable
            }
            Node::Leaf(_) => match (self.upper(node).as_str(), self.name(node)) {
                ("TRUE", _) => ConstraintKind::True,
                ("FALSE", _) => ConstraintKind::False,
                (_, Some(name)) => ConstraintKind::Parameter(name),
                _ => {
                    self.error("E-CONSTRAINT", span, "expected a constraint").hint =
                        Some("write a constraint as `(variable = value)`, `true` or `false`".into());
                    ConstraintKind::Unreadable
                }
            },
        };
        Constraint { kind, span }
    }

    /// Reads a list as a constraint.
    pub(super) fn constraint_list(&mut self, list: &List) -> Constraint {
        let kind = self.constraint_kind(list);
        Constraint { kind, span: list.span }
    }

    fn constraint_kind(&mut self, list: &List) -> ConstraintKind {
        let items = list.items.as_slice();
        match items {
            [] => {
                self.error("E-SYNTAX", list.span, "these parentheses are empty");
                return ConstraintKind::Unreadable;
            }
            [only] => return self.constraint(only).kind,
            _ => {}
        }
        match self.upper(&items[0]).as_str() {
            "NOT" if !items.get(1).is_some_and(|node| is_leaf(node, TokenKind::Equals)) => {
                let [_, inner] = items else {
                    self.error("E-ARITY", items[0].span(), "NOT takes one constraint");
                    return ConstraintKind::Unreadable;
                };
                return ConstraintKind::Not(Box::new(self.constraint(inner)));
            }
            joint @ ("AND" | "OR") if !items.get(1).is_some_and(|node| is_leaf(node, TokenKind::Equals)) => {
                if items.len() < 3 {
                    self.error("E-ARITY", items[0].span(), format!("{joint} takes at least two constraints"));
                    return ConstraintKind::Unreadable;
                }
                let parts = items[1..].iter().map(|node| self.constraint(node)).collect();
                return if joint == "AND" { ConstraintKind::And(parts) } else { ConstraintKind::Or(parts) };
            }
            _ => {}
        }
        if self.has_connective(items) { self.infix(items) } else { self.equality(items, list) }
    }

    fn equality(&mut self, items: &[Node], list: &List) -> ConstraintKind {
        if let [variable, equals, value] = items
            && is_leaf(equals, TokenKind::Equals)
            && let (Some(variable), Some(value)) = (self.name(variable), self.name(value))
        {
            return ConstraintKind::Equals { variable, value };
        }
        if items.iter().any(|node| is_leaf(node, TokenKind::Tilde)) {
            self.error(
                "E-CONSTRAINT",
                list.span,
                "`~` must come before a whole guard, not inside a constraint",
            )
            .hint = Some(
                "inside a constraint, write `(NOT c)`; as a guard, write `~c` or `(NOT-ENTAILED c)`".into(),
            );
        } else if matches!(items, [_, equals] if is_leaf(equals, TokenKind::Equals)) {
            self.error("E-CONSTRAINT", list.span, "the value is missing after `=`");
        } else if matches!(items, [equals, _] if is_leaf(equals, TokenKind::Equals)) {
            self.error("E-CONSTRAINT", list.span, "the variable is missing before `=`");
        } else {
            self.error("E-CONSTRAINT", list.span, "this is not a constraint").hint =
                Some("write a constraint as `(variable = value)`; join several with AND or OR".into());
        }
        ConstraintKind::Unreadable
    }

    fn infix(&mut self, items: &[Node]) -> ConstraintKind {
        let joints: Vec<&Node> = items.iter().filter(|node| self.is_connective(node)).collect();
        let first = joints.first().map(|node| self.upper(node)).unwrap_or_default();
        if let Some(mixed) = joints.iter().find(|node| self.upper(node) != first) {
            self.error("E-CONSTRAINT", mixed.span(), "AND and OR are mixed without parentheses").hint =
                Some("use parentheses to show which part binds first".into());
            return ConstraintKind::Unreadable;
        }
        let operands: Vec<&[Node]> = items.split(|node| self.is_connective(node)).collect();
        if operands.iter().any(|operand| operand.is_empty()) {
            let span = joints.iter().map(|node| node.span()).reduce(Span::cover).unwrap_or_default();
            self.error("E-CONSTRAINT", span, format!("{first} needs another constraint"));
            return ConstraintKind::Unreadable;
        }
        let parts = operands.into_iter().map(|operand| self.operand(operand)).collect();
        if first == "AND" { ConstraintKind::And(parts) } else { ConstraintKind::Or(parts) }
    }

    /// One side of AND or OR; `a = b` needs no parentheses of its own there.
    fn operand(&mut self, items: &[Node]) -> Constraint {
        if let [only] = items {
            return self.constraint(only);
        }
        let span = items.iter().map(Node::span).reduce(Span::cover).unwrap_or_default();
        self.constraint_list(&List { items: items.to_vec(), span, braced: false })
    }

    fn is_connective(&self, node: &Node) -> bool {
        matches!(self.upper(node).as_str(), "AND" | "OR")
    }
}

fn is_leaf(node: &Node, kind: TokenKind) -> bool {
    matches!(node, Node::Leaf(token) if token.kind == kind)
}
