//! The tables of a report: one for each section of the review.

use exact::Bound;
use review::record::LineKey;
use review::{Alternative, EventReview, Line, Record, Review, Section, Status};
use snapshot::Robustness;
use tpn::{Levels, Supply};

use crate::board;
use crate::shown::{sentence, shown};

/// All sections, each with its heading; one without lines says so.
pub(crate) fn sections(review: &Review) -> String {
    let mut out = String::new();
    for section in Section::ALL {
        if section == Section::Robustness {
            // It has a table of its own.
            continue;
        }
        out.push_str(&format!("<h2>{}</h2>\n", section.title()));
        if review.lines(section).is_empty() {
            out.push_str(&format!("<p class=\"muted\">{}</p>\n", shown(review.nothing(section))));
            continue;
        }
        out.push_str(&match section {
            Section::Plan
            | Section::MissionRules
            | Section::States
            | Section::Overlaps
            | Section::Durations
            | Section::SeparationViolations
            | Section::Robustness
            | Section::Warnings => lines(&review.lines(section)),
            Section::Resources => resources(review),
            Section::Choices => choices(review),
            Section::CausalLinks => links(review),
            Section::Conflicts => conflicts(review),
            Section::Events => events(review),
            Section::Traverses => traverses(review),
        });
    }
    out
}

/// Returns what has failed and what deserves a look, of all sections, before anything else.
pub(crate) fn summary(review: &Review, record: Option<&Record>) -> String {
    let acknowledged = record.map(Record::acknowledgments).unwrap_or_default();
    let acknowledged = &acknowledged;
    let of_status = |wanted: Status| {
        let rows = Section::ALL.iter().flat_map(move |&section| {
            review
                .lines(section)
                .into_iter()
                .filter(move |line| line.status == wanted)
                .map(move |line| (section, line))
        });
        rows.map(|(section, line)| {
            vec![
                status(line.status),
                section.title().to_owned(),
                sentence(&line.text),
                criterion(line),
                board::acknowledgment(acknowledged, &LineKey::new(section, line)),
                place(line),
            ]
        })
    };
    let rows: Vec<Vec<String>> = of_status(Status::Failed).chain(of_status(Status::Attention)).collect();
    let mut out = String::from("<h2>Summary</h2>\n");
    if rows.is_empty() {
        out.push_str("<p class=\"muted\">Nothing failed, and nothing needs attention.</p>\n");
    } else {
        out.push_str(&table(&["", "Section", "Finding", "Criterion", "Acknowledged by", "Where"], rows));
    }
    out
}

/// The word for a status, with its sign and in its color.
pub(crate) fn status(status: Status) -> String {
    word(status.name(), status.name())
}

/// A word in the look of a status.
pub(crate) fn word(status: &str, word: &str) -> String {
    let sign = match status {
        "passed" => "✓",
        "information" => "•",
        "attention" => "!",
        _ => "✕",
    };
    format!("<span class=\"status {status}\"><b>{sign}</b> {word}</span>")
}

/// Rows of a table that are written: what has not passed before what has, where there are more.
const MAX_ROWS: usize = 1000;

/// The rows of a table that are written, in their order, and how many are not.
fn readable(mut rows: Vec<Vec<String>>) -> (Vec<Vec<String>>, usize) {
    let all = rows.len();
    if all > MAX_ROWS {
        let keep = chosen(&rows, MAX_ROWS, <[_]>::len);
        let mut keep = keep.into_iter();
        rows.retain(|_| keep.next().unwrap_or(false));
    }
    let more = all - rows.len();
    (rows, more)
}

/// Returns which rows there is room for: what has failed or needs attention before the rest, and what has passed last.
/// Rows that go on with the one before, which have nothing in their first cell, stay with it. `size` is what rows take
/// of the room.
fn chosen(rows: &[Vec<String>], mut room: usize, size: impl Fn(&[Vec<String>]) -> usize) -> Vec<bool> {
    let begins: Vec<usize> = (0..rows.len())
        .filter(|&at| at == 0 || rows[at].first().is_some_and(|cell| !cell.is_empty()))
        .collect();
    let ends = begins.iter().skip(1).copied().chain([rows.len()]);
    let mut groups: Vec<std::ops::Range<usize>> =
        begins.iter().copied().zip(ends).map(|(from, to)| from..to).collect();
    groups.sort_by_key(|group| urgency(&rows[group.start]));
    let mut is_chosen = vec![false; rows.len()];
    for group in groups {
        if room == 0 {
            break;
        }
        room = room.saturating_sub(size(&rows[group.clone()]));
        is_chosen[group].fill(true);
    }
    is_chosen
}

/// Returns where a row stands among those that there is no room for all of, by its status.
fn urgency(row: &[String]) -> u8 {
    let is = |status: Status| {
        let start = format!("<span class=\"status {}\">", status.name());
        row.first().is_some_and(|cell| cell.starts_with(&start))
    };
    if is(Status::Failed) || is(Status::Attention) {
        0
    } else if is(Status::Passed) {
        2
    } else {
        1
    }
}

/// How high the rows of a table may be on paper together, in points: about two pages, so that a report of all sections
/// stays below what people leaf through.
const PRINTED_HEIGHT: usize = 1500;

/// Returns how high a row is on paper, in points, judged by how much is written in its cells.
fn printed_height(row: &[String]) -> usize {
    let visible = |cell: &String| {
        let mut is_tag = false;
        let is_text = |letter: &char| {
            is_tag = *letter == '<' || (is_tag && *letter != '>');
            !is_tag && *letter != '>'
        };
        cell.chars().filter(is_text).count()
    };
    let letters: usize = row.iter().map(visible).sum();
    5 + 13 * letters.div_ceil(45).max(1)
}

/// Returns which rows of a table are printed, while there is room. The others stand on the screen.
fn printed(rows: &[Vec<String>]) -> Vec<bool> {
    chosen(rows, PRINTED_HEIGHT, |rows| rows.iter().map(|row| printed_height(row)).sum())
}

/// A table of rows of cells that are HTML already; a heading that begins with `#` is that of figures.
pub(crate) fn table(headings: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let is_figure: Vec<bool> = headings.iter().map(|heading| heading.starts_with('#')).collect();
    let class = |column: usize| {
        if is_figure.get(column).copied().unwrap_or(false) { " class=\"figure\"" } else { "" }
    };
    let mut out = String::from("<table><thead><tr>");
    for (column, heading) in headings.iter().enumerate() {
        let text = shown(heading.trim_start_matches('#'));
        out.push_str(&format!("<th{}>{text}</th>", class(column)));
    }
    out.push_str("</tr></thead><tbody>\n");
    let (rows, more) = readable(rows.into_iter().collect());
    let columns = headings.len();
    let is_printed = printed(&rows);
    for (row, &is_printed) in rows.iter().zip(&is_printed) {
        out.push_str(if is_printed { "<tr>" } else { "<tr class=\"on-screen\">" });
        for (column, cell) in row.iter().enumerate() {
            out.push_str(&format!("<td{}>{cell}</td>", class(column)));
        }
        out.push_str("</tr>\n");
    }
    let on_screen = is_printed.iter().filter(|it| !**it).count();
    if on_screen > 0 {
        out.push_str(&format!(
            "<tr class=\"in-print\"><td colspan=\"{columns}\">and {on_screen} more, not printed; open this file on a screen \
             to see them</td></tr>\n"
        ));
    }
    if more > 0 {
        out.push_str(&format!("<tr><td colspan=\"{columns}\">and {more} more, not listed</td></tr>\n"));
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
    shown(&time.readable().replace("inf", "∞"))
}

fn lines(lines: &[&Line]) -> String {
    table(
        &["", "Finding", "Criterion", "Where"],
        lines
            .iter()
            .map(|line| vec![status(line.status), sentence(&line.text), criterion(line), place(line)]),
    )
}

/// Returns what a line is held against.
fn criterion(line: &Line) -> String {
    let criterion = line.criterion.as_deref().map(sentence);
    criterion.map(|it| format!("<div class=\"criterion\">{it}</div>")).unwrap_or_default()
}

/// The flight rules, each in a line.
pub(crate) fn rules(review: &Review) -> String {
    let rules = review.rules.in_words(&review.unit);
    let rules: String = rules.iter().map(|rule| format!("<li>{}</li>", shown(rule))).collect();
    format!("<h2>Flight rules</h2>\n<ul>{rules}</ul>\n")
}

fn choices(review: &Review) -> String {
    let rows = review.choices.iter().flat_map(|choice| {
        choice.alternatives.iter().map(|alternative| {
            let is_first = alternative.number == 0;
            vec![
                if is_first { status(choice.line.status) } else { String::new() },
                if is_first { shown(&choice.name) } else { String::new() },
                alternative_cell(alternative),
                sentence(&alternative.fate.sentence()),
                if is_first { place(&choice.line) } else { String::new() },
            ]
        })
    });
    table(&["", "Choice", "Alternative", "Reason", "Where"], rows)
}

/// Its name, and its text where that says more.
fn alternative_cell(alternative: &Alternative) -> String {
    let (name, text) = (shown(&alternative.name), shown(&alternative.text));
    if text.starts_with(name.trim_end_matches(')')) {
        format!("<code>{text}</code>")
    } else {
        format!("{name}<div class=\"muted\"><code>{text}</code></div>")
    }
}

fn links(review: &Review) -> String {
    let rows = review.causal_links.iter().map(|link| {
        vec![
            status(link.line.status),
            shown(&link.ask),
            shown(&link.tell),
            shown(&link.lead.to_string()),
            shown(&link.margin.to_string()),
            criterion(&link.line),
            place(&link.line),
        ]
    });
    table(&["", "Needed", "Supported by", "#Holds before", "#Outlasts by", "Criterion", "Where"], rows)
}

fn resources(review: &Review) -> String {
    let rows = review.resources.iter().map(|resource| {
        let (supply, used) = match (resource.supply, resource.levels) {
            (Supply::Reusable { capacity }, Levels::Peak(peak)) => {
                (format!("capacity {}", capacity.readable()), format!("at most {}", peak.readable()))
            }
            (Supply::Reservoir { least, greatest, .. }, Levels::Range { low, high }) => (
                format!("{} to {}", least.readable(), greatest.readable()),
                format!("{} to {}", low.readable(), high.readable()),
            ),
            _ => (String::new(), String::new()),
        };
        let margin = match resource.room {
            Some(room) => format!("{} below, {} above", resource.spare.readable(), room.readable()),
            None => resource.spare.readable(),
        };
        vec![
            status(resource.line.status),
            shown(&resource.name),
            shown(&supply),
            shown(&used),
            shown(&margin),
            criterion(&resource.line),
            place(&resource.line),
        ]
    });
    table(&["", "Resource", "Capacity", "Range over all schedules", "Margin", "Criterion", "Where"], rows)
}

fn conflicts(review: &Review) -> String {
    let rows = review.conflicts.iter().map(|conflict| {
        let by = if conflict.is_added { "planning" } else { "the program" };
        vec![
            status(conflict.line.status),
            shown(&conflict.first),
            shown(&conflict.then),
            shown(&conflict.gap.to_string()),
            by.to_owned(),
            criterion(&conflict.line),
            place(&conflict.line),
        ]
    });
    table(&["", "First", "Then", "#Apart", "Ordered by", "Criterion", "Where"], rows)
}

/// Events of the program first; the points of paths, which are many and follow from them, in a table of their own.
fn events(review: &Review) -> String {
    let row = |event: &EventReview| {
        vec![
            shown(&event.name),
            time(Bound::Finite(event.window.earliest)),
            time(event.window.latest),
            time(event.slack),
            place(&event.line),
        ]
    };
    let (points, events): (Vec<&EventReview>, Vec<&EventReview>) =
        review.events.iter().partition(|event| event.name.contains(".leg"));
    let headings = ["Event", "#Earliest", "#Latest", "#Slack", "Where"];
    let mut out = table(&headings, events.into_iter().map(row));
    if !points.is_empty() {
        out.push_str("<h3>Points of paths</h3>\n");
        out.push_str(&table(&headings, points.into_iter().map(row)));
    }
    out
}

/// Returns how many runs with chance reached the end, and what broke the others; before such runs, that there were
/// none.
pub(crate) fn robustness(review: &Review, found: Option<&Robustness>) -> String {
    let mut out = String::from("<h2>Robustness</h2>\n");
    if let Some(line) = &review.robustness {
        out.push_str(&lines(&[line]));
    }
    let Some(found) = found.filter(|found| found.tally.runs > 0) else {
        out.push_str("<p class=\"muted\">No Monte Carlo runs.</p>\n");
        return out;
    };
    let tally = &found.tally;
    let (low, high) = tally.interval();
    let percent = |part: f64| format!("{:.1}%", part * 100.0);
    out.push_str(&format!(
        "<p>{} of {} runs reached the end: {} (95% confidence: {} to {}). {} of them had to replan.</p>\n",
        tally.succeeded,
        tally.runs,
        percent(tally.probability()),
        percent(low),
        percent(high),
        tally.succeeded_by_replanning
    ));
    let rows: Vec<Vec<String>> = tally
        .worst_events()
        .into_iter()
        .map(|(event, breaks)| {
            vec![
                shown(event),
                breaks.violations.to_string(),
                breaks.stops.to_string(),
                shown(&breaks.example),
            ]
        })
        .collect();
    if !rows.is_empty() {
        out.push_str(&table(&["Event", "#Violated", "#Ended the run", "Example"], rows));
    }
    out
}

fn traverses(review: &Review) -> String {
    let rows = review.traverses.iter().map(|traverse| {
        let clearance =
            traverse.clearance_m.map_or_else(|| "–".to_owned(), |clearance_m| format!("{clearance_m:.2}"));
        vec![
            status(traverse.line.status),
            shown(&traverse.name),
            shown(&traverse.vehicles.join(", ")),
            shown(&traverse.places.join(", ")),
            format!("{:.1}", traverse.length_m),
            shown(&traverse.duration.to_string()),
            clearance,
            format!("{:.1}", traverse.slope_max_rad.to_degrees()),
            criterion(&traverse.line),
            place(&traverse.line),
        ]
    });
    let headings = [
        "",
        "Traverse",
        "Vehicles",
        "Via",
        "#Length, m",
        "#Duration",
        "#Clearance, m",
        "#Slope, °",
        "Criterion",
        "Where",
    ];
    table(&headings, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_rows_those_that_have_not_passed_are_written_and_the_others_counted() {
        let row = |number: usize| {
            let of = if number % 1000 == 999 { Status::Failed } else { Status::Passed };
            vec![status(of), format!("row {number}")]
        };
        let html = table(&["", "What"], (0..80_000).map(row));
        assert_eq!(html.matches("status failed").count(), 80);
        assert_eq!(html.matches("<tr").count(), 1 + MAX_ROWS + 2);
        let is_printed = |row: &&str| row.starts_with("<tr>");
        let printed: Vec<&str> = html.lines().filter(is_printed).collect();
        assert_eq!(printed.iter().filter(|row| row.contains("status failed")).count(), 80);
        assert!(printed.len() <= 3 + PRINTED_HEIGHT / 18, "{}", printed.len());
        let on_screen = html.matches("class=\"on-screen\"").count();
        assert!(html.contains(&format!("and {on_screen} more, not printed")));
        assert!(html.contains("and 79000 more, not listed"));
        assert!(!table(&["", "What"], (0..MAX_ROWS).map(row)).contains("not listed"));
    }

    #[test]
    fn rows_that_go_on_with_another_stay_with_it_and_those_for_attention_come_first() {
        let group = |number: usize| {
            let of = if number == 900 { Status::Attention } else { Status::Information };
            let first = vec![status(of), format!("D{number}"), "selected".to_owned()];
            let next = vec![String::new(), String::new(), format!("not needed in D{number}")];
            [first, next.clone(), next]
        };
        let html = table(&["", "Choice", "Why"], (0..1000).flat_map(group));
        let printed: Vec<&str> = html.lines().filter(|row| row.starts_with("<tr>")).collect();
        assert!(printed.iter().any(|row| row.contains("status attention")), "{printed:#?}");
        for name in ["D0", "D1", "D900"] {
            let of_choice = printed.iter().filter(|row| row.contains(&format!("{name}<")));
            assert_eq!(of_choice.count(), 3, "{name}: its own row and both that go on with it");
        }
        let written = html.matches("not needed in D").count();
        assert_eq!(html.matches("status information").count() * 2 + 2, written, "no choice without its rows");
    }
}
