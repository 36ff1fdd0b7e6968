//! From the parser's events to blocks.

use std::iter::Peekable;

use pulldown_cmark::{CodeBlockKind, Event, OffsetIter, Options, Parser, Tag, TagEnd};

use crate::{Block, Content, Document, Head, Run, Style};

pub(crate) fn read(text: &str) -> Document {
    let options = Options::ENABLE_TABLES | Options::ENABLE_YAML_STYLE_METADATA_BLOCKS;
    let events = Parser::new_ext(text, options).into_offset_iter().peekable();
    let line_starts = text.match_indices('\n').map(|(at, _)| at + 1).collect();
    let mut reader = Reader { events, line_starts, head: None };
    let blocks = reader.blocks();
    Document { head: reader.head, blocks }
}

struct Reader<'a> {
    events: Peekable<OffsetIter<'a>>,
    /// Where every line but the first begins, in bytes.
    line_starts: Vec<usize>,
    head: Option<Head>,
}

impl Reader<'_> {
    /// The line of a byte, from 1.
    fn line(&self, at: usize) -> u32 {
        self.line_starts.partition_point(|&start| start <= at) as u32 + 1
    }

    /// Blocks up to the end of what holds them, which is taken too.
    fn blocks(&mut self) -> Vec<Block> {
        let mut blocks = Vec::new();
        loop {
            // The words of a list's item without empty lines between stand in it without a paragraph.
            let loose =
                self.events.peek().filter(|(event, _)| is_inline(event)).map(|(_, range)| range.start);
            if let Some(start) = loose {
                let line = self.line(start);
                let text = self.loose_runs();
                blocks.push(Block { line, content: Content::Paragraph(text) });
                continue;
            }
            let Some((event, range)) = self.events.next() else { return blocks };
            let line = self.line(range.start);
            let content = match event {
                Event::End(_) => return blocks,
                Event::Rule => Some(Content::Rule),
                Event::Start(tag) => self.block(tag, line),
                _ => None,
            };
            blocks.extend(content.map(|content| Block { line, content }));
        }
    }

    /// The block that has just started.
    fn block(&mut self, tag: Tag<'_>, line: u32) -> Option<Content> {
        match tag {
            Tag::Heading { level, .. } => Some(Content::Heading { level: level as u8, text: self.runs() }),
            Tag::Paragraph => Some(Content::Paragraph(self.runs())),
            Tag::CodeBlock(kind) => {
                let info = match kind {
                    CodeBlockKind::Fenced(info) => info.trim().to_owned(),
                    CodeBlockKind::Indented => String::new(),
                };
                Some(Content::Code { info, text: self.verbatim() })
            }
            Tag::List(first) => {
                let mut items = Vec::new();
                while let Some((Event::Start(Tag::Item), _)) = self.events.next() {
                    items.push(self.blocks());
                }
                Some(Content::List { first, items })
            }
            Tag::BlockQuote(_) => Some(Content::Quote(self.blocks())),
            Tag::Table(_) => Some(self.table()),
            Tag::MetadataBlock(_) => {
                let text = self.verbatim();
                self.head.get_or_insert(Head { line, text });
                None
            }
            _ => {
                self.verbatim();
                None
            }
        }
    }

    fn table(&mut self) -> Content {
        let (mut head, mut rows) = (Vec::new(), Vec::new());
        while let Some((event, _)) = self.events.next() {
            match event {
                Event::Start(Tag::TableHead) => head = self.cells(),
                Event::Start(Tag::TableRow) => rows.push(self.cells()),
                Event::End(TagEnd::Table) => break,
                _ => {}
            }
        }
        Content::Table { head, rows }
    }

    fn cells(&mut self) -> Vec<Vec<Run>> {
        let mut cells = Vec::new();
        while let Some((Event::Start(Tag::TableCell), _)) = self.events.next() {
            cells.push(self.runs());
        }
        cells
    }

    /// The text up to the end of what holds it, whatever is in it.
    fn verbatim(&mut self) -> String {
        let (mut text, mut depth) = (String::new(), 0_u32);
        for (event, _) in self.events.by_ref() {
            match event {
                Event::Text(more) => text.push_str(&more),
                Event::Start(_) => depth += 1,
                Event::End(_) if depth == 0 => break,
                Event::End(_) => depth -= 1,
                _ => {}
            }
        }
        text
    }

    /// The words up to the end of what holds them, which is taken too.
    fn runs(&mut self) -> Vec<Run> {
        let mut words = Words::default();
        for (event, _) in self.events.by_ref() {
            if matches!(event, Event::End(_)) && words.is_outside() {
                break;
            }
            words.take(event);
        }
        words.runs
    }

    /// The words up to the next block or the end of what holds them, which is left.
    fn loose_runs(&mut self) -> Vec<Run> {
        let mut words = Words::default();
        while let Some((event, _)) = self
            .events
            .next_if(|(event, _)| is_inline(event) || matches!(event, Event::End(_)) && !words.is_outside())
        {
            words.take(event);
        }
        words.runs
    }
}

/// Returns whether an event belongs to words.
fn is_inline(event: &Event<'_>) -> bool {
    match event {
        Event::Text(_)
        | Event::Code(_)
        | Event::InlineHtml(_)
        | Event::SoftBreak
        | Event::HardBreak
        | Event::InlineMath(_)
        | Event::DisplayMath(_)
        | Event::FootnoteReference(_)
        | Event::TaskListMarker(_) => true,
        Event::Start(tag) => matches!(
            tag,
            Tag::Emphasis
                | Tag::Strong
                | Tag::Strikethrough
                | Tag::Superscript
                | Tag::Subscript
                | Tag::Link { .. }
                | Tag::Image { .. }
        ),
        Event::End(_) | Event::Html(_) | Event::Rule => false,
    }
}

/// Words as they come.
#[derive(Default)]
struct Words {
    runs: Vec<Run>,
    /// How what follows looks, and what it was before each tag that is open.
    style: Style,
    link: Option<String>,
    before: Vec<(Style, Option<String>)>,
}

impl Words {
    /// Returns whether no tag is open.
    fn is_outside(&self) -> bool {
        self.before.is_empty()
    }

    fn take(&mut self, event: Event<'_>) {
        match event {
            Event::Text(text) => self.add(&text, self.style),
            Event::Code(text) => self.add(&text, Style { code: true, ..self.style }),
            Event::SoftBreak => self.add(" ", self.style),
            Event::HardBreak => self.add("\n", self.style),
            Event::Start(tag) => {
                self.before.push((self.style, self.link.clone()));
                match tag {
                    Tag::Emphasis => self.style.emphasis = true,
                    Tag::Strong => self.style.strong = true,
                    Tag::Link { dest_url, .. } => self.link = Some(dest_url.to_string()),
                    _ => {}
                }
            }
            Event::End(_) => {
                if let Some((style, link)) = self.before.pop() {
                    (self.style, self.link) = (style, link);
                }
            }
            _ => {}
        }
    }

    fn add(&mut self, text: &str, style: Style) {
        match self.runs.last_mut() {
            Some(last) if last.style == style && last.link == self.link => last.text.push_str(text),
            _ => self.runs.push(Run { text: text.to_owned(), style, link: self.link.clone() }),
        }
    }
}
