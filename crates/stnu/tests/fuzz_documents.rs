//! A bounded fuzz run of both layouts: pieces are cut, doubled and replaced. Nothing may panic, and what is read is
//! decided, or said to be too large, and written so that it can be read again. The seed of a failure is printed with it.

use stnu::{Document, Layout, check};

const ROUNDS: u64 = 4000;

const FILES: [&str; 3] = [
    "# KIND OF NETWORK\nSTNU\n# Num Time-Points\n3\n# Num Ordinary Edges\n2\n# Num Contingent Links\n1\n\
     # Names of Time-Points\nZ A C\n# Ordinary Edges\nZ 35.5 C\nC -30 Z\n# Contingent Links\nA 20 40 C\n",
    "# KIND OF NETWORK\nSTN\n# Num Time-Points\n2\n# Num Edges\n2\n# Names\nX Y\n# Edges\nX 5 Y\nY -1 X\n",
    "<graphml><key id=\"Type\" for=\"edge\"><default>requirement</default></key><graph edgedefault=\"directed\">\
     <node id=\"Z\"/><node id=\"A\"/><node id=\"C&amp;\"/>\
     <edge source=\"A\" target=\"C&amp;\"><data key=\"Type\">contingent</data><data key=\"LabeledValue\">LC(C):20</data></edge>\
     <edge source=\"C&amp;\" target=\"A\"><data key=\"Type\">contingent</data><data key=\"LabeledValue\">UC(C):-40</data></edge>\
     <edge source=\"Z\" target=\"C&amp;\"><data key=\"Value\">35</data></edge></graph></graphml>",
];

const PIECES: [&str; 18] = [
    "\n",
    " ",
    "#",
    "<",
    ">",
    "/",
    "&",
    "\"",
    "0",
    "-1",
    "99999999999999999999",
    "9223372036854775807",
    "-9223372036854775808",
    "0.0000000001",
    "1e9",
    "inf",
    "Z",
    "<!--",
];

fn next(state: &mut u64, limit: usize) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 16) as usize % limit.max(1)
}

fn mutated(seed: u64) -> String {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut text = FILES[next(&mut state, FILES.len())].to_owned();
    for _ in 0..=next(&mut state, 4) {
        let at = text.floor_char_boundary(next(&mut state, text.len() + 1));
        let end = text.floor_char_boundary((at + next(&mut state, 12)).min(text.len()));
        match next(&mut state, 3) {
            0 => text.replace_range(at..end, ""),
            1 => text.replace_range(at..end, PIECES[next(&mut state, PIECES.len())]),
            _ => {
                let piece = text[at..end].to_owned();
                let to = text.floor_char_boundary(next(&mut state, text.len() + 1));
                text.insert_str(to, &piece);
            }
        }
    }
    text
}

#[test]
fn no_document_panics_and_what_is_read_is_decided_and_written() {
    for seed in 1..=ROUNDS {
        let text = mutated(seed);
        let outcome = std::panic::catch_unwind(|| {
            let Ok(document) = Document::parse(&text) else { return };
            let _ = check(&document.network, &mut || false);
            for layout in [Layout::Plain, Layout::GraphMl] {
                let written = document.write(layout);
                let read = Document::parse(&written);
                assert_eq!(
                    read.map(|read| read.names.len()),
                    Ok(document.names.len()),
                    "{layout:?}: {written}"
                );
            }
        });
        assert!(outcome.is_ok(), "seed {seed}: {text:?}");
    }
}
