//! Links: what stands after `#` in an address.

use workbench::host_io::open_fragment;
use workbench::state::AppState;

use super::{NOTHING, Outcome, Reader, nothing, read, refused, text_of};

/// The first byte says what the rest is: the fragment itself (`#`), or a mission's text (`t`), a compressed text
/// without (`d`) and with a checksum (`z`), which are put into a fragment.
pub(super) const LINKS: Reader = Reader {
    name: "links",
    seeds: &["assets/missions/enroute.rmpl"],
    words: &[
        "mission=",
        "source=",
        "2.",
        "3.",
        "open=",
        "lesson=",
        "stop=",
        "workspace=review",
        "step=",
        "t=",
        "&",
        "%",
        "1e308",
        "-1",
        "NaN",
    ],
    mend: nothing,
    exercise: links,
    tested: 400,
    keeps_form: 3,
    cost: 1,
};

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

fn digits(bytes: &[u8]) -> String {
    let mut digits = String::new();
    for chunk in bytes.chunks(3) {
        let group = [0, 1, 2].map(|at| u32::from(chunk.get(at).copied().unwrap_or(0)));
        let group = group[0] << 16 | group[1] << 8 | group[2];
        digits
            .extend((0..=chunk.len()).map(|at| char::from(ALPHABET[(group >> (18 - 6 * at) & 63) as usize])));
    }
    digits
}

fn links(input: &[u8]) -> Outcome {
    let Some((&kind, rest)) = input.split_first() else { return NOTHING };
    let fragment = match kind {
        b't' => format!("source=2.{}", digits(&miniz_oxide::deflate::compress_to_vec_zlib(rest, 1))),
        b'd' => format!("source={}", digits(rest)),
        b'z' => format!("source=2.{}", digits(rest)),
        _ => text_of(rest).into_owned(),
    };
    let mut state = AppState::new();
    let is_named = open_fragment(&mut state, &fragment);
    let said: String = state.window.toasts.shown().iter().map(|toast| toast.text.as_str()).collect();
    assert!(
        state.playback.time >= 0.0 && state.playback.time <= state.playback.end,
        "the time is within the plan"
    );
    if is_named { read(&said) } else { refused(&said) }
}
