//! The manual that comes with the app: its pages, what is found in them, and which page tells about what.

use std::sync::LazyLock;

use markdown::{Block, Content, Document, Run, anchor, plain};
use rmpl::editor::Topic;

use crate::lesson::Glossary;
use crate::state::no_plan::NO_PLAN;

/// A page of the manual.
#[derive(Debug)]
pub struct Page {
    /// The heading of the contents that it is listed under.
    pub group: &'static str,
    /// Its name in addresses, commands and links, without `.md`.
    pub name: &'static str,
    pub title: String,
    pub document: Document,
}

/// A place that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    pub page: &'static str,
    /// The heading over it, as links have it; empty above the first heading but the title.
    pub section: String,
    /// Title of the page and the heading.
    pub title: String,
    /// The words around what was found.
    pub excerpt: String,
}

/// The groups of the contents, with the name and the text of each page. The last one also gets the diagnostics.
const GROUPS: &[(&str, &[(&str, &str)])] = &[
    (
        "Tutorials",
        &[
            ("tutorial", include_str!("../../../docs/tutorial.md")),
            ("first-control-program", include_str!("../../../docs/first-control-program.md")),
            ("review-tutorial", include_str!("../../../docs/review-tutorial.md")),
            ("execution", include_str!("../../../docs/execution.md")),
        ],
    ),
    (
        "How-to guides",
        &[
            ("install", include_str!("../../../docs/install.md")),
            ("missions", include_str!("../../../docs/missions.md")),
            ("fix-no-plan", include_str!("../../../docs/fix-no-plan.md")),
            ("resources-and-objectives", include_str!("../../../docs/resources-and-objectives.md")),
            ("terrain", include_str!("../../../docs/terrain.md")),
            ("exchange", include_str!("../../../docs/exchange.md")),
            ("simulation", include_str!("../../../docs/simulation.md")),
            ("robustness", include_str!("../../../docs/robustness.md")),
            ("reviews", include_str!("../../../docs/reviews.md")),
            ("embed", include_str!("../../../docs/embed.md")),
            ("lessons", include_str!("../../../docs/lessons.md")),
            ("troubleshooting", include_str!("../../../docs/troubleshooting.md")),
        ],
    ),
    (
        "Panels",
        &[
            ("mission-text-panel", include_str!("../../../docs/panels/mission-text-panel.md")),
            ("outline-panel", include_str!("../../../docs/panels/outline-panel.md")),
            ("problems-panel", include_str!("../../../docs/panels/problems-panel.md")),
            ("network-panel", include_str!("../../../docs/panels/network-panel.md")),
            ("plan-panel", include_str!("../../../docs/panels/plan-panel.md")),
            ("timeline-panel", include_str!("../../../docs/panels/timeline-panel.md")),
            ("terrain-panel", include_str!("../../../docs/panels/terrain-panel.md")),
            ("search-panel", include_str!("../../../docs/panels/search-panel.md")),
            ("distances-panel", include_str!("../../../docs/panels/distances-panel.md")),
            ("controllability-panel", include_str!("../../../docs/panels/controllability-panel.md")),
            ("automaton-panel", include_str!("../../../docs/panels/automaton-panel.md")),
            ("review-panel", include_str!("../../../docs/panels/review-panel.md")),
            ("compare-panel", include_str!("../../../docs/panels/compare-panel.md")),
            ("execution-panel", include_str!("../../../docs/panels/execution-panel.md")),
            ("robustness-panel", include_str!("../../../docs/panels/robustness-panel.md")),
            ("lesson-panel", include_str!("../../../docs/panels/lesson-panel.md")),
            ("manual-panel", include_str!("../../../docs/panels/manual-panel.md")),
        ],
    ),
    (
        "Explanation",
        &[
            ("how-planning-works", include_str!("../../../docs/how-planning-works.md")),
            ("flexible-times", include_str!("../../../docs/flexible-times.md")),
            ("what-verified-means", include_str!("../../../docs/what-verified-means.md")),
            ("controllability", include_str!("../../../docs/controllability.md")),
        ],
    ),
    (
        "Reference",
        &[
            ("language", include_str!("../../../docs/language.md")),
            ("control-programs", include_str!("../../../docs/control-programs.md")),
            ("esterel", include_str!("../../../docs/esterel.md")),
            ("command-line", include_str!("../../../docs/command-line.md")),
            ("files", include_str!("../../../docs/files.md")),
            ("browsers", include_str!("../../../docs/browsers.md")),
            ("accessibility", include_str!("../../../docs/accessibility.md")),
            (GLOSSARY, include_str!("../../../assets/glossary.md")),
            ("specification", include_str!("../../../docs/specification.md")),
        ],
    ),
];

/// The page of the terms.
pub const GLOSSARY: &str = "glossary";
/// Places that a search answers with at most.
const MAX_FOUND: usize = 60;
/// Letters of an excerpt before and after what was found.
const AROUND: usize = 48;

static PAGES: LazyLock<Vec<Page>> = LazyLock::new(|| {
    let of_group = |&(group, files): &(&'static str, &'static [(&'static str, &'static str)])| {
        files.iter().map(move |&(name, text)| page(group, name, text))
    };
    let files = GROUPS.iter().flat_map(of_group);
    files.chain([page("Reference", "diagnostics", &diagnostics())]).collect()
});

fn page(group: &'static str, name: &'static str, text: &str) -> Page {
    let mut document = Document::parse(&with_known_signs(text));
    if name == GLOSSARY {
        name_terms(&mut document);
    }
    let title = document.blocks.iter().find_map(|block| match &block.content {
        Content::Heading { level: 1, text } => Some(plain(text)),
        _ => None,
    });
    Page { group, name, title: title.unwrap_or_else(|| name.to_owned()), document }
}

/// Leaves one form of each term in its heading: the others are for links.
fn name_terms(glossary: &mut Document) {
    for block in &mut glossary.blocks {
        if let Content::Heading { level: 2, text } = &mut block.content
            && let Some(term) = Glossary::get().in_line(block.line)
            && let Some(run) = text.first().cloned()
        {
            *text = vec![Run { text: term.heading(), ..run }];
        }
    }
}

/// Signs that the page's fonts lack, with what represents them on screen.
const SIGNS: [(&str, &str); 13] = [
    ("θ̇", "θ'"),
    ("v̇", "v'"),
    ("ẋ", "x'"),
    ("ẏ", "y'"),
    ("ᵢ", "_i"),
    ("₊", "+"),
    ("₁", "1"),
    ("₂", "2"),
    ("⁻", "-"),
    ("ℓ", "l"),
    ("∅", "{}"),
    ("∝", "~"),
    ("⊨", "|= "),
];

fn with_known_signs(text: &str) -> String {
    let text = text.replace('⊭', "|≠ ");
    SIGNS.iter().fold(text, |text, (sign, shown)| text.replace(sign, shown))
}

/// Returns what every kind of problem means, one section each.
fn diagnostics() -> String {
    let mut text =
        "# Diagnostics\n\nThe meaning of each error and warning, with an example and a corrected version.\n"
            .to_owned();
    for explanation in rmpl::diagnostics::EXPLANATIONS {
        let page = explanation.markdown();
        let page = page
            .replacen("# ", "## ", 1)
            .replace("\n## Example", "\nExample:")
            .replace("\n## What to do\n", "");
        text.push_str(&format!("\n{page}"));
    }
    text
}

/// All pages, in the order of the contents.
pub fn pages() -> &'static [Page] {
    &PAGES
}

/// The page of this name.
pub fn page_named(name: &str) -> Option<&'static Page> {
    PAGES.iter().find(|page| page.name == name)
}

/// Returns where a link leads inside the manual: a page and a section, which may be empty. `language.md#bounds`, and
/// `#bounds` on the page `here`; nothing for what leads elsewhere.
pub fn target(link: &str, here: &str) -> Option<(&'static str, String)> {
    let (file, section) = link.split_once('#').unwrap_or((link, ""));
    let name = file.rsplit('/').next().unwrap_or(file);
    let name = if file.is_empty() { here } else { name.strip_suffix(".md")? };
    page_named(name).map(|page| (page.name, section.to_owned()))
}

/// The section about a kind of problem.
pub fn section_of_code(code: &str) -> Option<String> {
    let explanation = rmpl::explain(code)?;
    Some(anchor(&format!("{}: {}", explanation.code, explanation.title)))
}

/// The page and the section about a kind of problem, which the app itself may find.
pub fn about_code(code: &str) -> Option<(&'static str, String)> {
    if code == NO_PLAN {
        return Some(("fix-no-plan", "2-read-the-reason".to_owned()));
    }
    section_of_code(code).map(|section| ("diagnostics", section))
}

/// The page and the section about a part of the language.
pub const fn about_topic(topic: Topic) -> (&'static str, &'static str) {
    let section = match topic {
        Topic::Declarations => "declarations",
        Topic::Options => "options",
        Topic::Statements => "statements",
        Topic::Conditions => "conditions",
        Topic::States => "state-variables",
        Topic::Resources => "resources",
        Topic::EarlyEnds => "activities-that-can-be-ended-early",
        Topic::Objectives => "objectives",
        Topic::Bounds => "bounds",
        Topic::ThreadBounds => "bounds-between-threads",
        Topic::Files => "missions-of-several-files",
        Topic::Nature => "uncontrollable-durations",
        Topic::Parameters => "parameters",
        Topic::World => "the-world",
        Topic::Programs => "activities-that-run-programs",
    };
    ("language", section)
}

/// The places where all words of `query` stand in one block, whatever their case: headings first, then glossary entries,
/// then the rest, in the order of the pages. Linear in the manual.
pub fn search(query: &str) -> Vec<Found> {
    let words: Vec<String> = query.split_whitespace().map(str::to_lowercase).collect();
    if words.is_empty() {
        return Vec::new();
    }
    let mut found: Vec<(u8, Found)> = Vec::new();
    for page in pages() {
        let mut heading = String::new();
        for block in &page.document.blocks {
            let is_heading = matches!(block.content, Content::Heading { .. });
            let text = block.plain();
            if is_heading {
                heading.clone_from(&text);
            }
            let term = Glossary::get().in_line(block.line).filter(|_| is_heading && page.name == GLOSSARY);
            // A term is found in all its forms.
            let lower = term.map_or_else(|| text.clone(), |term| term.names.join(" ")).to_lowercase();
            if !words.iter().all(|word| lower.contains(word.as_str())) {
                continue;
            }
            let section = if heading == page.title { String::new() } else { anchor(&heading) };
            let title =
                if section.is_empty() { page.title.clone() } else { format!("{} · {heading}", page.title) };
            // Several blocks of one section are one place.
            if found.last().is_some_and(|(_, last)| last.page == page.name && last.section == section) {
                continue;
            }
            let rank = match (is_heading, page.name) {
                (true, _) => 0,
                (false, GLOSSARY) => 1,
                (false, _) => 2,
            };
            let excerpt = if is_heading { below(page, block) } else { excerpt(&text, &words[0]) };
            found.push((rank, Found { page: page.name, section, title, excerpt }));
        }
    }
    found.sort_by_key(|(rank, _)| *rank);
    found.truncate(MAX_FOUND);
    found.into_iter().map(|(_, found)| found).collect()
}

/// The first words below a heading.
fn below(page: &Page, heading: &Block) -> String {
    let after = page.document.blocks.iter().skip_while(|block| !std::ptr::eq(*block, heading)).nth(1);
    after.map(|block| block.plain().chars().take(2 * AROUND).collect()).unwrap_or_default()
}

/// The words around the first `word` of a text, on one line.
fn excerpt(text: &str, word: &str) -> String {
    let letters: Vec<char> = text.split_whitespace().collect::<Vec<_>>().join(" ").chars().collect();
    let lower: String = letters.iter().flat_map(|letter| letter.to_lowercase()).collect();
    let at = lower.find(word).map_or(0, |at| lower[..at].chars().count());
    let (from, to) = (at.saturating_sub(AROUND), (at + word.chars().count() + AROUND).min(letters.len()));
    let mut out: String = letters.get(from..to).unwrap_or_default().iter().collect();
    if from > 0 {
        out.insert(0, '…');
    }
    if to < letters.len() {
        out.push('…');
    }
    out
}

/// The links of these blocks that lead nowhere: neither out of the app, nor to a section or a term.
pub fn broken_links(blocks: &[Block], here: &str) -> Vec<String> {
    let mut broken = Vec::new();
    visit_links(blocks, &mut |link| {
        let is_outside = link.contains("://") || link.starts_with("mailto:");
        let is_there = target(link, here).is_some_and(|(page, section)| {
            section.is_empty()
                || page_named(page).is_some_and(|page| page.document.heading(&section).is_some())
        });
        let is_term = Glossary::get().linked(link).is_some();
        if !is_outside && !is_there && !is_term {
            broken.push(link.to_owned());
        }
    });
    broken
}

fn visit_links(blocks: &[Block], visit: &mut dyn FnMut(&str)) {
    for block in blocks {
        let runs: Vec<&[markdown::Run]> = match &block.content {
            Content::Heading { text, .. } | Content::Paragraph(text) => vec![text],
            Content::Table { head, rows } => {
                head.iter().chain(rows.iter().flatten()).map(Vec::as_slice).collect()
            }
            Content::List { items, .. } => {
                for item in items {
                    visit_links(item, visit);
                }
                Vec::new()
            }
            Content::Quote(blocks) => {
                visit_links(blocks, visit);
                Vec::new()
            }
            Content::Code { .. } | Content::Rule => Vec::new(),
        };
        runs.into_iter().flatten().filter_map(|run| run.link.as_deref()).for_each(&mut *visit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PanelKind;

    #[test]
    fn every_page_of_a_panel_and_every_code_has_its_section() {
        for panel in PanelKind::ALL {
            let page = page_named(panel.manual()).unwrap_or_else(|| panic!("no page for {panel:?}"));
            assert_eq!(page.title, format!("{} panel", panel.title()));
        }
        for topic in Topic::ALL {
            let (name, section) = about_topic(topic);
            let page = page_named(name).expect("a page");
            assert!(page.document.heading(section).is_some(), "{topic:?}: {name}#{section}");
        }
        let page = page_named("diagnostics").expect("a page of diagnostics");
        for explanation in rmpl::diagnostics::EXPLANATIONS {
            let section = section_of_code(explanation.code.0).expect("a section");
            assert!(page.document.heading(&section).is_some(), "{section}");
        }
    }

    /// Documents for developers, which are not in the manual.
    const OF_THE_REPOSITORY: [&str; 4] = ["contracts.md", "decisions/", "evidence/", "../tests/suite"];

    #[test]
    fn links_of_the_manual_stay_in_the_manual() {
        for page in pages() {
            let broken = broken_links(&page.document.blocks, page.name);
            let inside =
                broken.iter().filter(|link| !OF_THE_REPOSITORY.iter().any(|it| link.starts_with(it)));
            assert_eq!(inside.collect::<Vec<_>>(), Vec::<&String>::new(), "{}", page.name);
        }
    }

    #[test]
    fn links_of_the_glossary_lead_somewhere() {
        for term in &Glossary::get().terms {
            let mut links = 0;
            visit_links(&term.meaning, &mut |_| links += 1);
            assert!(links > 0, "{:?} leads nowhere", term.names);
            assert_eq!(broken_links(&term.meaning, "glossary"), Vec::<String>::new(), "{:?}", term.names);
        }
        assert_eq!(target("../docs/language.md#bounds", "glossary"), Some(("language", "bounds".to_owned())));
        assert_eq!(target("#bounds", "language"), Some(("language", "bounds".to_owned())));
        assert_eq!(target("https://example.org/a.html", "language"), None);
    }

    #[test]
    fn a_search_finds_headings_first_and_all_of_its_words() {
        let glossary = page_named(GLOSSARY).expect("a page");
        assert!(glossary.document.heading("margin").is_some());
        let margin =
            search("margins").into_iter().find(|it| it.page == GLOSSARY).expect("a term in another form");
        assert_eq!((margin.section.as_str(), margin.title.as_str()), ("margin", "Glossary · margin"));
        let found = search("objectives");
        assert_eq!(found.first().map(|it| it.section.as_str()), Some("objectives"), "{found:?}");
        for place in search("Unary RESOURCE") {
            let page = page_named(place.page).expect("a page");
            let text: String =
                page.document.blocks.iter().map(Block::plain).collect::<Vec<_>>().join(" ").to_lowercase();
            assert!(text.contains("unary") && text.contains("resource"), "{place:?}");
        }
        assert_eq!(search("  "), []);
        assert_eq!(search("xyzzyplugh"), []);
    }
}
