//! The lossless syntax tree: one flat tree per declaration, with offsets relative to it.
//!
//! A tree is two vectors: tokens in textual order, comments and blanks included, and nodes in preorder, each knowing its
//! tokens and the size of its subtree. Trees never change; an edit replaces those of the declarations that it touches.

use crate::span::Span;

use super::SyntaxKind;

/// A token: it starts where the one before it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token {
    pub kind: SyntaxKind,
    /// Offset just past it, relative to its declaration.
    pub end: u32,
}

/// A node in preorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RawNode {
    pub(crate) kind: SyntaxKind,
    /// Index of its first token.
    pub(crate) first_token: u32,
    /// Index just past its last token.
    pub(crate) end_token: u32,
    /// How many nodes its subtree has, itself included.
    pub(crate) size: u32,
}

/// The tree of one declaration, with the blanks and comments before it and the comments after it on its last line.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct DeclarationTree {
    pub(crate) tokens: Vec<Token>,
    pub(crate) nodes: Vec<RawNode>,
}

impl DeclarationTree {
    /// The length of its text in bytes.
    pub fn len(&self) -> u32 {
        self.tokens.last().map_or(0, |token| token.end)
    }

    /// Returns whether it has no text.
    pub fn is_empty(&self) -> bool {
        self.tokens.is_empty()
    }

    /// The root as a cursor. `text` is the declaration's own text and `base` its offset in the file.
    pub fn root<'a>(&'a self, text: &'a str, base: u32) -> SyntaxNode<'a> {
        SyntaxNode { tree: self, text, base, index: 0 }
    }

    fn token_start(&self, index: u32) -> u32 {
        index.checked_sub(1).and_then(|before| self.tokens.get(before as usize)).map_or(0, |token| token.end)
    }
}

/// A node seen in its file.
#[derive(Clone, Copy, Debug)]
pub struct SyntaxNode<'a> {
    tree: &'a DeclarationTree,
    text: &'a str,
    base: u32,
    index: u32,
}

/// A token seen in its file.
#[derive(Clone, Copy, Debug)]
pub struct SyntaxToken<'a> {
    pub kind: SyntaxKind,
    pub text: &'a str,
    /// Where it is in the file.
    pub span: Span,
    /// Its index among the tokens of its declaration.
    pub index: u32,
}

/// A direct child of a node.
#[derive(Clone, Copy, Debug)]
pub enum Element<'a> {
    Node(SyntaxNode<'a>),
    /// A token that belongs to no child node.
    Token(SyntaxToken<'a>),
}

impl<'a> SyntaxNode<'a> {
    fn raw(self) -> RawNode {
        let nothing = RawNode { kind: SyntaxKind::Root, first_token: 0, end_token: 0, size: 1 };
        self.tree.nodes.get(self.index as usize).copied().unwrap_or(nothing)
    }

    /// The kind of node or token.
    pub fn kind(self) -> SyntaxKind {
        self.raw().kind
    }

    /// Its position in the preorder of its declaration.
    pub const fn index(self) -> u32 {
        self.index
    }

    /// Returns where it is in the file.
    pub fn span(self) -> Span {
        let raw = self.raw();
        let start = self.tree.token_start(raw.first_token);
        let end = self.tree.token_start(raw.end_token).max(start);
        Span::new(self.base + start, self.base + end)
    }

    /// The source text, with what lies between its tokens.
    pub fn text(self) -> &'a str {
        let span = self.span();
        self.text.get((span.start - self.base) as usize..(span.end - self.base) as usize).unwrap_or("")
    }

    /// Its child nodes, in textual order.
    pub fn children(self) -> impl Iterator<Item = SyntaxNode<'a>> + use<'a> {
        let end = self.index + self.raw().size;
        let mut next = self.index + 1;
        std::iter::from_fn(move || {
            let child = (next < end).then_some(SyntaxNode { index: next, ..self })?;
            next += child.raw().size.max(1);
            Some(child)
        })
    }

    /// The first child node of a kind.
    pub fn child(self, kind: SyntaxKind) -> Option<SyntaxNode<'a>> {
        self.children().find(|child| child.kind() == kind)
    }

    /// Its subtree in preorder, itself first.
    pub fn descendants(self) -> impl Iterator<Item = SyntaxNode<'a>> + use<'a> {
        (self.index..self.index + self.raw().size).map(move |index| SyntaxNode { index, ..self })
    }

    /// All tokens in its span, those of its descendants included.
    pub fn tokens(self) -> impl DoubleEndedIterator<Item = SyntaxToken<'a>> + use<'a> {
        let raw = self.raw();
        (raw.first_token..raw.end_token).map(move |index| self.token_at_index(index))
    }

    /// Its direct children: nodes, and the tokens between them.
    pub fn elements(self) -> impl Iterator<Item = Element<'a>> + use<'a> {
        let end = self.raw().end_token;
        let mut at = self.raw().first_token;
        let mut children = self.children().peekable();
        std::iter::from_fn(move || {
            // A node without tokens is before the token it was expected at.
            if let Some(child) = children.next_if(|child| child.raw().first_token <= at) {
                at = at.max(child.raw().end_token);
                return Some(Element::Node(child));
            }
            let token = (at < end).then(|| self.token_at_index(at))?;
            at += 1;
            Some(Element::Token(token))
        })
    }

    /// The first token of a kind that belongs to no child node.
    pub fn token(self, kind: SyntaxKind) -> Option<SyntaxToken<'a>> {
        self.own_tokens().find(|token| token.kind == kind)
    }

    /// The tokens that belong to no child node, blanks and comments left out.
    pub fn own_tokens(self) -> impl Iterator<Item = SyntaxToken<'a>> + use<'a> {
        self.elements().filter_map(|element| match element {
            Element::Token(token) if !token.kind.is_trivia() => Some(token),
            _ => None,
        })
    }

    /// The path of nodes from here down to the smallest whose span touches `offset`, itself first.
    pub fn path_to(self, offset: u32) -> Vec<SyntaxNode<'a>> {
        let mut path = vec![self];
        let mut here = self;
        // Of two neighbors that meet at the offset, the later one is where typing continues a construct.
        while let Some(child) = here.children().filter(|child| child.span().touches(offset)).last() {
            path.push(child);
            here = child;
        }
        path
    }

    fn token_at_index(self, index: u32) -> SyntaxToken<'a> {
        let start = self.tree.token_start(index);
        let token = self.tree.tokens.get(index as usize).copied();
        let token = token.unwrap_or(Token { kind: SyntaxKind::End, end: start });
        let text = self.text.get(start as usize..token.end as usize).unwrap_or("");
        SyntaxToken {
            kind: token.kind,
            text,
            span: Span::new(self.base + start, self.base + token.end),
            index,
        }
    }
}
