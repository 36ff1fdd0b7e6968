//! Prints how long a mission of 500, 5,000 and 10,000 lines takes to read, and to be current after one keystroke.

#![expect(clippy::print_stdout, reason = "the table is what this program is for")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use rmpl::{Edit, Span, parse};

fn main() {
    println!("Medians; in parentheses the best, which other work on the machine disturbs least.\n");
    println!("| lines | bytes | full | meaning | keystroke in a body | keystroke in a name | diagnostics |");
    println!("|------:|------:|-----:|--------:|--------------------:|--------------------:|------------:|");
    for lines in [500, 5_000, 10_000] {
        let text = mission(lines);
        let full = median(41, || {
            black_box(parse(black_box(&text)));
        });
        let mut current = parse(&text);
        let meaning = median(15, || {
            black_box(current.program());
        });
        let middle = text.len() / 2;
        let find =
            |pattern: &str, after: usize| text[middle..].find(pattern).map_or(0, |at| middle + at + after);
        let body = keystrokes(&mut current, find("delay[", 6));
        let name = keystrokes(&mut current, find("primitive ", 12));
        let diagnostics = median(15, || {
            black_box(current.diagnostics());
        });
        println!(
            "| {} | {} | {} | {} | {} | {} | {} |",
            text.lines().count(),
            text.len(),
            show(&full),
            show(&meaning),
            show(&body),
            show(&name),
            show(&diagnostics)
        );
    }
}

/// The median time of typing and deleting one character at `at`.
fn keystrokes(current: &mut rmpl::Parse, at: usize) -> Measured {
    let at = at as u32;
    let insert = Edit { span: Span::new(at, at), text: "1".to_owned() };
    let delete = Edit { span: Span::new(at, at + 1), text: String::new() };
    let mut insert_next = true;
    median(200, || {
        current.edit(if insert_next { &insert } else { &delete });
        insert_next = !insert_next;
    })
}

fn median(times: usize, mut run: impl FnMut()) -> Measured {
    let mut measured: Vec<Duration> = (0..times)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed()
        })
        .collect();
    measured.sort();
    Measured { median: measured[times / 2], best: measured[0] }
}

struct Measured {
    median: Duration,
    best: Duration,
}

fn show(time: &Measured) -> String {
    let millis = |time: Duration| time.as_secs_f64() * 1000.0;
    format!("{:.3} ({:.3}) ms", millis(time.median), millis(time.best))
}

/// A mission of about `lines` lines: activities with choices, conditions and bounds, and the primitives they call.
fn mission(lines: usize) -> String {
    let mut text = String::from("var LIGHT : {ON, OFF};\n");
    let mut number = 0;
    while text.lines().count() < lines.saturating_sub(8) {
        number += 1;
        text.push_str(&format!(
            "// Leg {number} of the survey.\n\
             primitive Drive-{number}(from, to)[20,30];\n\
             primitive Sample-{number}(tool)[2,5];\n\
             \n\
             Leg-{number}()[l,u] = {{\n  \
               choose {{\n    \
                 do {{ Drive-{number}(SITE{number}, BASE)[l*90%,u*90%]; }} maintaining LIGHT_ON,\n    \
                 {{ delay[0,5]; Drive-{number}(SITE{number}, BASE)[20,25] }}\n  \
               }};\n  \
               {{ Sample-{number}(DRILL)[2,4], TOOL{number}=BUSY [3,3] }};\n  \
               if PERMISSION{number}=GIVEN thennext Sample-{number}(BRUSH)\n\
             }}\n\n"
        ));
    }
    text.push_str("scenario Day[0,100000] = {\n  LIGHT=ON [100000,100000],\n  { Leg-1()[40,90]; delay; Leg-2()[40,90] }\n}\n");
    text
}
