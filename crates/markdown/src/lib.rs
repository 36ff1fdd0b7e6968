//! Markdown as a tree of blocks with their lines: what lessons, the glossary and the manual are written in.
//!
//! [`Document::parse`] reads `CommonMark` with tables and a head of `---` lines. It cannot fail: any text is some
//! document. Raw HTML and pictures are left out, with the words of a picture in its place. This draws nothing and
//! follows no links; `theme` shows the blocks.

mod reader;
mod run;

pub use run::{Run, Style, plain};

/// A Markdown text as a tree.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Document {
    /// What is between `---` lines at the very top, without them.
    pub head: Option<Head>,
    /// What follows, in order.
    pub blocks: Vec<Block>,
}

/// What is between `---` lines at the top of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Head {
    /// The line of its first `---`, from 1.
    pub line: u32,
    /// The lines between.
    pub text: String,
}

/// A part of a document that stands by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// The line on which it begins, from 1; for fenced code, that of the fence.
    pub line: u32,
    pub content: Content,
}

/// What a block is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Content {
    Heading {
        /// From 1 for the title to 6.
        level: u8,
        text: Vec<Run>,
    },
    /// Words that are wrapped together.
    Paragraph(Vec<Run>),
    /// Lines that are kept as they are.
    Code {
        /// What follows the fence: the language first, then whatever else; empty for indented code.
        info: String,
        /// The lines, each with its end.
        text: String,
    },
    /// Items, each of which holds blocks.
    List {
        /// The number of the first item; without it, items have no numbers.
        first: Option<u64>,
        items: Vec<Vec<Block>>,
    },
    /// What someone else says, or what is set apart.
    Quote(Vec<Block>),
    /// A table; each row has as many cells as the first one.
    Table {
        /// The titles of the columns.
        head: Vec<Vec<Run>>,
        /// The rows below.
        rows: Vec<Vec<Vec<Run>>>,
    },
    /// A line between what was and what comes.
    Rule,
}

impl Document {
    /// Reads a text. Linear in it but for what the parser's rules of emphasis cost.
    pub fn parse(text: &str) -> Self {
        reader::read(text)
    }

    /// The heading that a link `#anchor` leads to, as its place among the blocks.
    pub fn heading(&self, wanted: &str) -> Option<usize> {
        self.blocks.iter().position(|block| match &block.content {
            Content::Heading { text, .. } => anchor(&plain(text)) == wanted,
            _ => false,
        })
    }
}

impl Block {
    /// All words of the block, without their looks; cells, items and lines are parted by spaces.
    pub fn plain(&self) -> String {
        let within = |blocks: &[Self]| blocks.iter().map(Self::plain).collect::<Vec<_>>().join(" ");
        match &self.content {
            Content::Heading { text, .. } | Content::Paragraph(text) => plain(text),
            Content::Code { text, .. } => text.clone(),
            Content::List { items, .. } => {
                items.iter().map(|item| within(item)).collect::<Vec<_>>().join(" ")
            }
            Content::Quote(blocks) => within(blocks),
            Content::Table { head, rows } => {
                let cells = head.iter().chain(rows.iter().flatten());
                cells.map(|cell| plain(cell)).collect::<Vec<_>>().join(" ")
            }
            Content::Rule => String::new(),
        }
    }
}

/// Returns what a link to a heading of these words says after `#`, as pages of repositories have it: small letters,
/// dashes for spaces, and no other signs.
pub fn anchor(title: &str) -> String {
    let kept =
        title.trim().chars().filter(|letter| letter.is_alphanumeric() || matches!(letter, ' ' | '-' | '_'));
    kept.map(|letter| if letter == ' ' { '-' } else { letter }).collect::<String>().to_lowercase()
}
