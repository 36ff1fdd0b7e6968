//! Changes of bytes that find what readers do not expect.

/// Numbers by chance from a seed (xorshift).
pub struct Random(u64);

impl Random {
    /// Starts from a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// A number below `limit`, or 0.
    pub fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) as usize % limit.max(1)
    }

    fn one_of<'a, T: ?Sized>(&mut self, all: &[&'a T]) -> &'a T {
        all[self.below(all.len())]
    }
}

/// Inputs do not grow beyond this.
pub const MAX_BYTES: usize = 1 << 14;

/// Signs of every notation, numbers at the ends of their ranges, and texts that cannot be shown.
const PIECES: [&[u8]; 44] = [
    b"{",
    b"}",
    b"[",
    b"]",
    b"(",
    b")",
    b"<",
    b">",
    b"\"",
    b":",
    b",",
    b";",
    b"=",
    b"-",
    b"%",
    b"#",
    b"&",
    b"\\",
    b"/*",
    b"//",
    b"\n",
    b" ",
    b"null",
    b"\"Infinity\"",
    b"\"1/3\"",
    b"inf",
    b"NaN",
    b"0",
    b"-1",
    b"0.1",
    b"1e308",
    b"1e-308",
    b"4294967295",
    b"4294967296",
    b"9223372036854775807",
    b"-9223372036854775808",
    b"99999999999999999999",
    b"\x00\x00\x00\x00",
    b"\xff\xff\xff\xff",
    b"\x7f\xff\xff\xff",
    b"\xef\xbb\xbf",
    b"\xe2\x80\xae",
    b"\xe2\x88\x9e",
    b"\x1b",
];

/// One of the inputs, changed in a few places. `words` are signs of the reader's own notation.
pub fn mutated(random: &mut Random, pool: &[Vec<u8>], words: &[&str]) -> Vec<u8> {
    let Some(begun) = pool.get(random.below(pool.len())) else { return Vec::new() };
    let mut bytes = begun.clone();
    // Most often a single change, which leaves the rest as it was.
    let most = if random.below(2) == 0 { 1 } else { 5 };
    for _ in 0..=random.below(most) {
        change(random, &mut bytes, pool, words);
        bytes.truncate(MAX_BYTES);
    }
    bytes
}

fn change(random: &mut Random, bytes: &mut Vec<u8>, pool: &[Vec<u8>], words: &[&str]) {
    match random.below(10) {
        0 => {
            let range = stretch(random, bytes);
            bytes.drain(range);
        }
        1 => {
            let copied = bytes[stretch(random, bytes)].to_vec();
            let at = place(random, bytes);
            bytes.splice(at..at, copied);
        }
        2 => {
            let at = place(random, bytes);
            bytes.splice(at..at, piece(random, words).iter().copied());
        }
        3 => {
            let range = stretch(random, bytes);
            bytes.splice(range, piece(random, words).iter().copied());
        }
        4 => {
            let other = &pool[random.below(pool.len())];
            let other = other[stretch(random, other)].to_vec();
            let range = stretch(random, bytes);
            bytes.splice(range, other);
        }
        5 => {
            let at = place(random, bytes);
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << random.below(8);
            }
        }
        6 => {
            let piece = piece(random, words);
            let at = place(random, bytes);
            let end = (at + piece.len()).min(bytes.len());
            bytes.splice(at..end, piece.iter().copied());
        }
        7 => number(random, bytes),
        8 => {
            // The same over and over: depth and length.
            let range = stretch(random, bytes);
            let repeated = bytes[range.start..range.end.min(range.start + 8)].repeat(1 << random.below(8));
            bytes.splice(range.start..range.start, repeated);
        }
        _ => {
            let at = place(random, bytes);
            bytes.truncate(at);
        }
    }
}

fn piece<'a>(random: &mut Random, words: &[&'a str]) -> &'a [u8] {
    if !words.is_empty() && random.below(2) == 0 {
        random.one_of(words).as_bytes()
    } else {
        random.one_of(&PIECES)
    }
}

/// Headers are where lengths are.
fn place(random: &mut Random, bytes: &[u8]) -> usize {
    let reach = if random.below(3) == 0 { bytes.len().min(160) } else { bytes.len() };
    random.below(reach + 1)
}

fn stretch(random: &mut Random, bytes: &[u8]) -> std::ops::Range<usize> {
    let start = place(random, bytes);
    let length = if random.below(8) == 0 { random.below(400) } else { random.below(40) };
    start..(start + length).min(bytes.len())
}

/// A number becomes another one.
fn number(random: &mut Random, bytes: &mut Vec<u8>) {
    let from = place(random, bytes);
    let Some(start) = (from..bytes.len()).find(|&at| bytes[at].is_ascii_digit()) else { return };
    let end = (start..bytes.len()).find(|&at| !bytes[at].is_ascii_digit()).unwrap_or(bytes.len());
    let known = std::str::from_utf8(&bytes[start..end]).ok().and_then(|digits| digits.parse::<u64>().ok());
    let other = match random.below(6) {
        0 => known.unwrap_or(0).wrapping_add(1).to_string(),
        1 => known.unwrap_or(0).saturating_sub(1).to_string(),
        2 => (u64::MAX >> random.below(64)).to_string(),
        3 => format!("{}/{}", random.below(100), random.below(7)),
        4 => format!("-{}", random.below(1000)),
        _ => random.below(1000).to_string(),
    };
    bytes.splice(start..end, other.into_bytes());
}
