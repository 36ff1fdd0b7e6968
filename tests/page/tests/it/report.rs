//! What the page writes: the report as Chromium shows and prints it, and schedules for other tools.

use std::{fs, path::PathBuf};

use anyhow::{Context as _, Result, ensure};
use data_encoding::BASE64;
use serde_json::json;
use xtask::browser::Tab;

use crate::opened::Opened;

/// A paper with its size in inches and what fits between the report's margins, in CSS pixels.
struct Paper {
    name: &'static str,
    size_inches: [f64; 2],
    content_width: u32,
}

const PAPERS: [Paper; 2] = [
    Paper { name: "A4", size_inches: [8.268, 11.693], content_width: 680 },
    Paper { name: "Letter", size_inches: [8.5, 11.0], content_width: 702 },
];

/// Notes the files that the page saves from here on.
fn watch_saving(page: &Opened) -> Result<()> {
    page.tab.evaluate(
        "(() => {
            window.saved = [];
            const original = URL.createObjectURL;
            URL.createObjectURL = (blob) => { window.saved.push(blob); return original.call(URL, blob); };
        })()",
    )?;
    Ok(())
}

/// The text of the first file that was saved.
fn saved_text(page: &Opened) -> Result<String> {
    page.tab.wait_until("window.saved.length > 0")?;
    let text = page.tab.evaluate("window.saved.shift().text()")?;
    Ok(text.as_str().context("the file is a text")?.to_owned())
}

/// A file among temporary ones, gone when it is dropped.
struct Written(PathBuf);

impl Written {
    fn new(text: &str) -> Result<Self> {
        let path = std::env::temp_dir().join(format!("enroute-report-{}.html", std::process::id()));
        fs::write(&path, text)?;
        Ok(Self(path))
    }
}

impl Drop for Written {
    fn drop(&mut self) {
        // What is left behind lies among temporary files.
        let _ = fs::remove_file(&self.0);
    }
}

fn count(tab: &Tab, selector: &str) -> Result<u64> {
    let count = tab.evaluate(&format!("document.querySelectorAll({}).length", json!(selector)))?;
    count.as_u64().context("a count")
}

#[test]
fn the_report_is_a_page_that_stands_alone_and_prints_on_both_papers() -> Result<()> {
    let page = Opened::planned()?;
    watch_saving(&page)?;
    page.tab.evaluate("enroute.dispatch('review.createKey', { name: 'Grace' })")?;
    page.tab.evaluate("enroute.dispatch('review.comment', { author: 'Grace', text: 'Fine.' })")?;
    page.tab.evaluate("enroute.dispatch('file.report')")?;
    let text = saved_text(&page)?;
    let hash = page.state()?["review"]["hash"].clone();
    let report = Written::new(&text)?;
    let tab = &page.tab;
    tab.go_to(&format!("file://{}", report.0.display()))?;
    tab.wait_until("document.readyState === 'complete' && document.querySelector('h1') !== null")?;

    assert_eq!(tab.evaluate("performance.getEntriesByType('resource').length")?, 0, "it asks for nothing");
    assert_eq!(count(tab, "script, link, iframe, img, object")?, 0);
    assert_eq!(tab.evaluate("document.querySelector('.hash').textContent")?, hash);
    let headings = tab.evaluate("[...document.querySelectorAll('h2')].map((it) => it.textContent)")?;
    for heading in [
        "Plan",
        "Choices",
        "Causal links",
        "Threats and orderings",
        "Windows and slack",
        "Traverses",
        "Conflicts between vehicles",
        "Warnings in the text",
        "History of the review",
        "Timeline",
        "Network",
        "Map",
        "Program",
    ] {
        assert!(
            headings.as_array().is_some_and(|all| all.contains(&json!(heading))),
            "{heading}: {headings}"
        );
    }
    for (drawing, name) in [
        ("Timeline of the plan", "Group-Traverse-Path(PATH1_1, …, TAI_POS)"),
        // The network writes calls with their arguments.
        ("Temporal plan network", "Group-Wait(TAI_HOLD1, TAI_HOLD2)"),
        ("Map with the paths of the plan", "TAI_POS"),
    ] {
        let shown = tab.evaluate(&format!(
            "[...document.querySelectorAll('figure > svg')].some((it) => it.querySelector('title').textContent === {} \
             && it.textContent.includes({}) && it.getBoundingClientRect().height > 100)",
            json!(drawing),
            json!(name)
        ))?;
        assert_eq!(shown, true, "{drawing} with {name}");
    }
    // Every place in a table is a line of the listing.
    let lost = "[...document.querySelectorAll('a[href^=\"#\"]')]
        .filter((it) => document.getElementById(it.getAttribute('href').slice(1)) === null).length";
    assert_eq!(tab.evaluate(lost)?, 0);
    for paper in &PAPERS {
        prints(tab, paper)?;
    }
    Ok(())
}

/// Nothing is wider than the paper, no row of a table is torn, and there are pages of the right size.
fn prints(tab: &Tab, paper: &Paper) -> Result<()> {
    tab.call("Emulation.setEmulatedMedia", &json!({ "media": "print" }))?;
    tab.resize(paper.content_width, 900)?;
    let too_wide = tab.evaluate(
        "[...document.querySelectorAll('table, figure svg, pre, dl')]
            .filter((it) => it.getBoundingClientRect().right > innerWidth + 1)
            .map((it) => it.textContent.slice(0, 60))",
    )?;
    assert_eq!(too_wide, json!([]), "{}: wider than the paper", paper.name);
    let torn = "[...document.querySelectorAll('tr, figure')]
        .filter((it) => getComputedStyle(it).breakInside !== 'avoid').length";
    assert_eq!(tab.evaluate(torn)?, 0, "{}: rows may be torn", paper.name);
    let clipped =
        "[...document.querySelectorAll('td, th')].filter((it) => it.scrollWidth > it.clientWidth + 1).length";
    assert_eq!(tab.evaluate(clipped)?, 0, "{}: cells are cut", paper.name);
    tab.call("Emulation.setEmulatedMedia", &json!({ "media": "" }))?;

    let [width, height] = paper.size_inches;
    let printed = tab.call(
        "Page.printToPDF",
        &json!({ "paperWidth": width, "paperHeight": height, "printBackground": true }),
    )?;
    let bytes = BASE64.decode(printed["data"].as_str().context("a document")?.as_bytes())?;
    let text = String::from_utf8_lossy(&bytes);
    ensure!(text.starts_with("%PDF-"), "{}: no PDF", paper.name);
    let boxes: Vec<[f64; 2]> = text.split("/MediaBox").skip(1).filter_map(page_size).collect();
    assert!(boxes.len() >= 3, "{}: {} pages", paper.name, boxes.len());
    for [wide, high] in boxes {
        assert!((wide - width * 72.0).abs() < 2.0 && (high - height * 72.0).abs() < 2.0, "{wide} by {high}");
    }
    Ok(())
}

/// The width and height in ` [0 0 612 792]…`, in points.
fn page_size(text: &str) -> Option<[f64; 2]> {
    let inside = text.split_once('[')?.1.split_once(']')?.0;
    let numbers: Vec<f64> = inside.split_whitespace().filter_map(|it| it.parse().ok()).collect();
    match numbers.as_slice() {
        [_, _, width, height] => Some([*width, *height]),
        _ => None,
    }
}

#[test]
fn a_signed_review_is_still_there_after_the_page_was_closed() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.evaluate("enroute.dispatch('view.workspace', { name: 'review' })")?;
    page.wait_for("state.review.hash !== null && !state.review.stale")?;
    page.tab.evaluate("enroute.dispatch('review.createKey', { name: 'Ada' })")?;
    page.tab.evaluate(
        "enroute.state().review.items.forEach((it, item) => it.status === 'attention'
            && enroute.dispatch('review.acknowledge', { name: 'Ada', item, text: 'As meant.' }))",
    )?;
    page.tab.evaluate("enroute.dispatch('review.approve', { name: 'Ada' })")?;
    page.wait_for("state.review.signed?.stale === false")?;
    page.tab.evaluate("window.isOldPage = true; location.reload()")?;
    page.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
    page.tab.wait_until_ready()?;
    page.settle()?;
    page.wait_for("state.review.signed?.name === 'Ada' && state.review.signed.stale === false")?;
    page.tab.evaluate("enroute.setSource(enroute.source() + '\\n// more')")?;
    page.wait_for("state.review.signed.stale === true")?;
    page.tab.evaluate("enroute.dispatch('edit.undo')")?;
    page.wait_for("state.review.signed.stale === false")
}
