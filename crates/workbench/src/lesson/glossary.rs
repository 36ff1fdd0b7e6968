//! The glossary: terms with a sentence each, found in prose where they are.

use std::sync::LazyLock;

use markdown::{Block, Content, Document, Run, plain};

/// The terms of the field, each with what it means.
#[derive(Debug)]
pub struct Glossary {
    /// In the order of the file.
    pub terms: Vec<Term>,
}

/// A term with its explanation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Term {
    /// What it is called: the usual form first, then others that stand in prose.
    pub names: Vec<String>,
    /// The line of the file.
    pub line: u32,
    /// What it means; with a link to the manual.
    pub meaning: Vec<Block>,
}

impl Term {
    /// Returns what its heading says: its usual form, with an abbreviation if it has one.
    pub fn heading(&self) -> String {
        let (usual, others) = self.names.split_first().expect("every heading has a text");
        let is_abbreviation = |name: &&String| name.chars().all(|letter| letter.is_ascii_uppercase());
        match others.iter().find(is_abbreviation) {
            Some(short) => format!("{usual} ({short})"),
            None => usual.clone(),
        }
    }
}

/// What the target of a link to a term begins with.
const SCHEME: &str = "glossary:";

static GLOSSARY: LazyLock<Glossary> =
    LazyLock::new(|| Glossary::read(include_str!("../../../../assets/glossary.md")));

impl Glossary {
    /// The glossary that comes with the app.
    pub fn get() -> &'static Self {
        &GLOSSARY
    }

    /// Reads a glossary: each term is a heading of the second level, `## threat, threats`, and what it means stands
    /// below.
    pub fn read(text: &str) -> Self {
        let mut terms: Vec<Term> = Vec::new();
        for block in Document::parse(text).blocks {
            match &block.content {
                Content::Heading { level: 2, text } => {
                    let names = plain(text).split(',').map(|name| name.trim().to_owned()).collect();
                    terms.push(Term { names, line: block.line, meaning: Vec::new() });
                }
                _ => {
                    if let Some(term) = terms.last_mut() {
                        term.meaning.push(block);
                    }
                }
            }
        }
        Self { terms }
    }

    /// The term of this name, in any of its forms.
    pub fn term(&self, name: &str) -> Option<&Term> {
        self.terms.iter().find(|term| term.names.iter().any(|it| it.eq_ignore_ascii_case(name)))
    }

    /// The term whose heading is in this line of the file.
    pub fn in_line(&self, line: u32) -> Option<&Term> {
        self.terms.iter().find(|term| term.line == line)
    }

    /// The term that a link leads to, if it leads to one.
    pub fn linked(&self, link: &str) -> Option<&Term> {
        self.term(link.strip_prefix(SCHEME)?)
    }

    /// The same blocks where the first occurrence of each term in running text is a link to it. Headings, code and what is
    /// a link already stay as they are. Linear in the text for each name of a term.
    pub fn marked(&self, blocks: &[Block]) -> Vec<Block> {
        let mut is_marked = vec![false; self.terms.len()];
        blocks.iter().map(|block| self.marked_block(block, &mut is_marked)).collect()
    }

    fn marked_block(&self, block: &Block, is_marked: &mut [bool]) -> Block {
        let content = match &block.content {
            Content::Paragraph(runs) => Content::Paragraph(self.marked_runs(runs, is_marked)),
            Content::List { first, items } => {
                let mut item = |item: &Vec<Block>| -> Vec<Block> {
                    item.iter().map(|block| self.marked_block(block, is_marked)).collect()
                };
                Content::List { first: *first, items: items.iter().map(&mut item).collect() }
            }
            Content::Quote(blocks) => {
                Content::Quote(blocks.iter().map(|block| self.marked_block(block, is_marked)).collect())
            }
            other => other.clone(),
        };
        Block { line: block.line, content }
    }

    fn marked_runs(&self, runs: &[Run], is_marked: &mut [bool]) -> Vec<Run> {
        let mut out = Vec::new();
        for run in runs {
            if run.style.code || run.link.is_some() {
                out.push(run.clone());
                continue;
            }
            let mut rest = run.text.as_str();
            while let Some((number, from, to)) = self.first_in(rest, is_marked) {
                is_marked[number] = true;
                let link = format!("{SCHEME}{}", self.terms[number].names[0]);
                if from > 0 {
                    out.push(Run { text: rest[..from].to_owned(), ..run.clone() });
                }
                out.push(Run { text: rest[from..to].to_owned(), link: Some(link), ..run.clone() });
                rest = &rest[to..];
            }
            if !rest.is_empty() {
                out.push(Run { text: rest.to_owned(), ..run.clone() });
            }
        }
        out
    }

    /// The first term in a text that is not marked yet, and the longest there: its number and where it is.
    fn first_in(&self, text: &str, is_marked: &[bool]) -> Option<(usize, usize, usize)> {
        let unmarked = self.terms.iter().enumerate().filter(|(number, _)| !is_marked[*number]);
        let found = unmarked.flat_map(|(number, term)| {
            term.names.iter().filter_map(move |name| {
                let (from, to) = find_word(text, name)?;
                Some((number, from, to))
            })
        });
        found.min_by_key(|&(number, from, to)| (from, std::cmp::Reverse(to), number))
    }
}

/// Returns where `word` is in `text` as whole words, whatever their case.
fn find_word(text: &str, word: &str) -> Option<(usize, usize)> {
    let is_letter = |letter: char| letter.is_alphanumeric() || letter == '-' || letter == '_';
    text.char_indices().find_map(|(from, _)| {
        let to = from + word.len();
        let here = text.get(from..to).filter(|here| here.eq_ignore_ascii_case(word))?;
        let is_word = !text[..from].ends_with(is_letter) && !text[to..].starts_with(is_letter);
        (is_word && !here.is_empty()).then_some((from, to))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_occurrence_of_each_term_is_marked_the_longest_first_and_none_inside_of_words() {
        let glossary =
            Glossary::read("# G\n\n## link, links\nA.\n\n## causal link, causal links\nB. [More](x.md#y)\n");
        assert_eq!(glossary.term("Links").map(|term| term.names[0].as_str()), Some("link"));
        let prose =
            Document::parse("Linked are no links-to, but Causal links and `link` and a link, a link.");
        let [block] = &glossary.marked(&prose.blocks)[..] else { panic!("one paragraph") };
        let Content::Paragraph(runs) = &block.content else { panic!("a paragraph") };
        let links: Vec<(&str, &str)> =
            runs.iter().filter_map(|run| Some((run.text.as_str(), run.link.as_deref()?))).collect();
        assert_eq!(links, [("Causal links", "glossary:causal link"), ("link", "glossary:link")]);
        assert_eq!(plain(runs), prose.blocks[0].plain());
        assert_eq!(glossary.linked("glossary:causal link").map(|term| term.meaning.len()), Some(1));
    }

    #[test]
    fn a_heading_has_the_usual_form_and_an_abbreviation() {
        let glossary =
            Glossary::read("# G\n\n## link, links\nA.\n\n## simple network, SN\nB.\n\n## RMPL\nC.\n");
        let headings: Vec<String> = glossary.terms.iter().map(Term::heading).collect();
        assert_eq!(headings, ["link", "simple network (SN)", "RMPL"]);
    }

    #[test]
    fn every_term_has_a_name_of_its_own_and_a_meaning() {
        let mut names = Vec::new();
        for term in &Glossary::get().terms {
            assert!(!term.meaning.is_empty(), "{:?} in line {}", term.names, term.line);
            for name in &term.names {
                assert!(!name.is_empty() && !names.contains(name), "{name} in line {}", term.line);
                names.push(name.clone());
            }
        }
        assert!(names.len() > 30);
    }
}
