//! What of a report's drawings is on paper, and whether it can be read there.

use super::report;

/// The drawings of a page that are on paper.
fn printed_drawings(page: &str) -> Vec<&str> {
    let figures = page.split("<figure").skip(1).filter(|figure| !figure.starts_with(" class=\"on-screen\""));
    figures.map(|figure| figure.split("</figure>").next().unwrap_or_default()).collect()
}

/// The value of the first attribute of this name.
fn attribute(element: &str, name: &str) -> f64 {
    let value = element.split_once(&format!(" {name}=\"")).map(|(_, rest)| rest.split('"').next());
    value.flatten().and_then(|value| value.parse().ok()).unwrap_or_else(|| panic!("no {name} in {element}"))
}

/// The texts of a drawing, each with its size on paper in points, at most: A4 and the style sheet leave 510 by 637.
fn printed_texts(drawing: &str) -> Vec<(f64, &str)> {
    let [width, height] = ["width", "height"].map(|name| attribute(drawing, name));
    let points = (510.0 / width).min(637.0 / height).min(0.75);
    let texts = drawing.split("<text").skip(1);
    let texts = texts.map(|text| {
        let words = text.split_once('>').map_or("", |(_, rest)| rest.split('<').next().unwrap_or_default());
        (points * attribute(text, "font-size"), words)
    });
    texts.collect()
}

/// A mission of this many branches of so many activities, of which each takes one of two alternatives.
fn wide(branches: usize, activities: usize) -> String {
    let branch = |branch: usize| {
        let step = |step: usize| format!("choose {{ Survey()[{branch},50], Wait()[{step},50] }}");
        (0..activities).map(step).collect::<Vec<_>>().join("; ")
    };
    let branches: Vec<String> = (0..branches).map(|at| format!("{{ {} }}", branch(at))).collect();
    format!(
        "primitive Survey()[0,50]; primitive Wait()[0,50]; scenario S[0,9000] = {{ {} }}",
        branches.join(", ")
    )
}

#[test]
fn what_is_drawn_on_paper_can_be_read_and_the_rest_is_counted() {
    for (branches, activities) in [(2, 3), (4, 12), (12, 40)] {
        let page = report(&wide(branches, activities), "wide.rmpl");
        let drawings = printed_drawings(&page);
        let of = |title: &str| drawings.iter().filter(|it| it.contains(&format!("<title>{title}"))).count();
        assert!((1..=6).contains(&of("Timeline")) && (1..=5).contains(&of("Temporal plan network")));
        for drawing in &drawings {
            for (size, words) in printed_texts(drawing) {
                // What is in the circle of an event, and its window, which the tables have.
                let is_of_event = words.trim_start_matches('D').parse::<u32>().is_ok()
                    || ["s", "e"].contains(&words)
                    || words.starts_with('[');
                assert!(size >= 6.5 || is_of_event, "{words} has {size} points");
            }
        }
        let rows = branches * activities;
        let on_paper = drawings.iter().filter(|it| it.contains("<title>Timeline"));
        let names = |drawing: &&str| drawing.matches("Survey#").count() + drawing.matches("Wait#").count();
        let printed: usize = on_paper.map(names).sum();
        if rows <= 200 {
            assert_eq!(printed, rows, "each activity has a row on one of the sheets");
        } else {
            let left_out = format!("{} rows are not printed", rows - printed);
            assert!(printed < rows && page.contains(&left_out), "{left_out}");
        }
        if rows > 200 {
            let mut on_screen = page.split("<figure class=\"on-screen\">");
            assert!(
                on_screen.any(|it| it.contains("<title>Temporal plan network")),
                "the whole is on the screen"
            );
        }
    }
}

#[test]
fn what_deserves_a_look_has_a_sheet_of_its_own_where_the_network_is_too_large() {
    let source =
        wide(12, 40).replace("scenario S[0,9000] = {", "scenario S[0,9000] = { { Hurry()[9000,9000] },");
    let source = format!("primitive Hurry()[1,9000]; {source}");
    let page = report(&source, "wide.rmpl");
    let sheets = printed_drawings(&page);
    let details: Vec<&&str> = sheets.iter().filter(|it| it.contains("<figcaption>In detail: ")).collect();
    assert!(!details.is_empty() && details.len() <= 4, "{}", details.len());
    for detail in details {
        assert!(detail.contains("events are drawn; boxes replace the rest"));
    }
}
