//! The tables of a report: one for each section of the review.

use mission::review::{Line, Review, Section, Status, short_time};
use rmpl::Bound;

use crate::escape::escaped;

/// All sections that have lines, each with its heading.
pub(crate) fn sections(review: &Review) -> String {
    let mut out = String::new();
    for section in Section::ALL {
        if review.lines(section).is_empty() {
            continue;
        }
        out.push_str(&format!("<h2>{}</h2>\n", section.title()));
        out.push_str(&match section {
            Section::Plan | Section::Encounters | Section::Warnings => lines(&review.lines(section)),
            Section::Choices => choices(review),
            Section::CausalLinks => links(review),
            Section::Conflicts => conflicts(review),
            Section::Events => events(review),
            Section::Traverses => traverses(review),
        });
    }
    out
}

/// The word for a status, in its colour.
pub(crate) fn status(status: Status) -> String {
    let name = status.name();
    format!("<span class=\"status {name}\">{name}</span>")
}

/// A table of rows of cells that are HTML already; a heading that begins with `#` is that of figures.
fn table(headings: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let is_figure: Vec<bool> = headings.iter().map(|heading| heading.starts_with('#')).collect();
    let class = |column: usize| {
        if is_figure.get(column).copied().unwrap_or(false) { " class=\"figure\"" } else { "" }
    };
    let mut out = String::from("<table><thead><tr>");
    for (column, heading) in headings.iter().enumerate() {
        let text = escaped(heading.trim_start_matches('#'));
        out.push_str(&format!("<th{}>{text}</th>", class(column)));
    }
    out.push_str("</tr></thead><tbody>\n");
    for row in rows {
        out.push_str("<tr>");
        for (column, cell) in row.iter().enumerate() {
            out.push_str(&format!("<td{}>{cell}</td>", class(column)));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table>\n");
    out
}

/// The place in the listing that a line leads to.
fn place(line: &Line) -> String {
    match line.line_number {
        Some(number) => format!("<a href=\"#line-{number}\">line {number}</a>"),
        None => String::new(),
    }
}

fn time(time: Bound) -> String {
    escaped(&short_time(time).replace("inf", "∞"))
}

fn lines(lines: &[&Line]) -> String {
    table(
        &["", "What", "Where"],
        lines.iter().map(|line| vec![status(line.status), escaped(&line.text), place(line)]),
    )
}

fn choices(review: &Review) -> String {
    let rows = review.choices.iter().flat_map(|choice| {
        choice.alternatives.iter().map(|alternative| {
            let is_first = alternative.number == 0;
            vec![
                if is_first { status(choice.line.status) } else { String::new() },
                if is_first { escaped(&choice.name) } else { String::new() },
                alternative.number.to_string(),
                format!("<code>{}</code>", escaped(&alternative.text)),
                escaped(&alternative.fate.sentence()),
                if is_first { place(&choice.line) } else { String::new() },
            ]
        })
    });
    table(&["", "Choice", "#No.", "Alternative", "Taken, or why not", "Where"], rows)
}

fn links(review: &Review) -> String {
    let rows = review.causal_links.iter().map(|link| {
        vec![
            status(link.line.status),
            escaped(&link.ask),
            escaped(&link.tell),
            escaped(&link.lead.to_string()),
            escaped(&link.margin.to_string()),
            place(&link.line),
        ]
    });
    table(&["", "Needed", "Carried by", "#Holds before", "#Outlasts by", "Where"], rows)
}

fn conflicts(review: &Review) -> String {
    let rows = review.conflicts.iter().map(|conflict| {
        let by = if conflict.is_added { "planning" } else { "the program" };
        vec![
            status(conflict.line.status),
            escaped(&conflict.first),
            escaped(&conflict.then),
            escaped(&conflict.gap.to_string()),
            by.to_owned(),
            place(&conflict.line),
        ]
    });
    table(&["", "First", "Then", "#Apart", "Ordered by", "Where"], rows)
}

fn events(review: &Review) -> String {
    let rows = review.events.iter().map(|event| {
        vec![
            escaped(&event.name),
            time(Bound::Finite(event.window.earliest)),
            time(event.window.latest),
            time(event.slack),
            place(&event.line),
        ]
    });
    table(&["Event", "#Earliest", "#Latest", "#Slack", "Where"], rows)
}

fn traverses(review: &Review) -> String {
    let rows = review.traverses.iter().map(|traverse| {
        let clearance =
            traverse.clearance_m.map_or_else(|| "–".to_owned(), |clearance_m| format!("{clearance_m:.2}"));
        vec![
            status(traverse.line.status),
            escaped(&traverse.name),
            escaped(&traverse.vehicles.join(", ")),
            escaped(&traverse.places.join(", ")),
            format!("{:.1}", traverse.length_m),
            escaped(&traverse.duration.to_string()),
            clearance,
            format!("{:.1}", traverse.slope_max_rad.to_degrees()),
            place(&traverse.line),
        ]
    });
    let headings = [
        "",
        "Traverse",
        "Vehicles",
        "By way of",
        "#Length, m",
        "#Duration",
        "#Clearance, m",
        "#Slope, °",
        "Where",
    ];
    table(&headings, rows)
}
