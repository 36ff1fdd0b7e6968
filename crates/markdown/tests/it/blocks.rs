//! What is read of Markdown: blocks with their lines, and words with their looks.

use markdown::{Block, Content, Document, Run, Style, anchor, plain};

fn blocks(text: &str) -> Vec<Block> {
    Document::parse(text).blocks
}

fn words(text: &str) -> Vec<Run> {
    match blocks(text).into_iter().next().map(|block| block.content) {
        Some(Content::Paragraph(runs)) => runs,
        other => panic!("a paragraph was expected, not {other:?}"),
    }
}

#[test]
fn blocks_know_the_lines_on_which_they_begin() {
    let text = "---\ntitle: A\n---\n# One\n\nwords\nmore\n\n```show now\nstep: 3\n```\n\n- a\n- b\n\n1. c\n";
    let document = Document::parse(text);
    assert_eq!(document.head.map(|head| (head.line, head.text)), Some((1, "title: A\n".to_owned())));
    let lines: Vec<u32> = document.blocks.iter().map(|block| block.line).collect();
    assert_eq!(lines, [4, 6, 9, 13, 16]);
    let Content::Code { info, text } = &document.blocks[2].content else { panic!("no code") };
    assert_eq!((info.as_str(), text.as_str()), ("show now", "step: 3\n"));
    let Content::List { first: Some(1), items } = &document.blocks[4].content else { panic!("no list") };
    assert_eq!(items.len(), 1);
}

#[test]
fn words_keep_their_looks_and_links_and_lines_are_joined() {
    let runs = words("a **b *c*** `d`\n[e `f`](g.md#h)");
    let look = |run: &Run| (run.text.clone(), run.style, run.link.clone());
    let (strong, both) =
        (Style { strong: true, ..Style::default() }, Style { emphasis: true, strong: true, code: false });
    let code = Style { code: true, ..Style::default() };
    let link = Some("g.md#h".to_owned());
    assert_eq!(
        runs.iter().map(look).collect::<Vec<_>>(),
        [
            ("a ".to_owned(), Style::default(), None),
            ("b ".to_owned(), strong, None),
            ("c".to_owned(), both, None),
            (" ".to_owned(), Style::default(), None),
            ("d".to_owned(), code, None),
            (" ".to_owned(), Style::default(), None),
            ("e ".to_owned(), Style::default(), link.clone()),
            ("f".to_owned(), code, link),
        ]
    );
    assert_eq!(plain(&runs), "a b c d e f");
}

#[test]
fn items_hold_blocks_and_tables_hold_cells() {
    let [list, table] = &blocks("- a `b`\n  - c\n- d\n\n  e\n\n| x | y |\n|---|---|\n| 1 | **2** |\n")[..]
    else {
        panic!("two blocks")
    };
    let Content::List { first: None, items } = &list.content else { panic!("no list") };
    assert_eq!(items.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
    let Content::Table { head, rows } = &table.content else { panic!("no table") };
    assert_eq!(head.iter().map(|cell| plain(cell)).collect::<Vec<_>>(), ["x", "y"]);
    assert_eq!(rows.len(), 1);
    assert_eq!(table.plain(), "x y 1 2");
}

#[test]
fn whatever_is_written_is_some_document() {
    for text in [
        "",
        "---",
        "---\na",
        "```",
        "- ",
        "|a|\n|-|",
        "<b>x</b>\n\n<!-- y -->",
        "[a](b",
        "![p](q)",
        "* * *\n> z",
    ] {
        let document = Document::parse(text);
        for block in &document.blocks {
            assert!(block.line >= 1, "{text:?}");
            assert!(!block.plain().contains("<b>"), "{text:?}");
        }
    }
    assert_eq!(plain(&words("see ![a picture](x.png) here")), "see a picture here");
}

#[test]
fn headings_are_found_by_their_anchors() {
    let document = Document::parse("# Words\n\ntext\n\n## `choose`, and more!\n");
    assert_eq!(document.heading("choose-and-more"), Some(2));
    assert_eq!(document.heading("words"), Some(0));
    assert_eq!(document.heading("nothing"), None);
    assert_eq!(anchor("Bounds [l, u]"), "bounds-l-u");
}
