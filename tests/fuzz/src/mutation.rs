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
const PIECES: [&[u8]; 46] = [
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
    b"\xef\xbf\xbf",
    b"<script>alert(1)</script>",
];

/// One of the inputs, changed in a few places. `words` are signs of the reader's own notation; of `of_ten` changes in ten none
/// breaks a word or leaves a bracket without its other.
pub fn mutated(random: &mut Random, pool: &[Vec<u8>], words: &[&str], of_ten: usize) -> Vec<u8> {
    let Some(begun) = pool.get(random.below(pool.len())) else { return Vec::new() };
    let mut bytes = begun.clone();
    // What keeps its brackets and words whole is more often read, and so goes deeper.
    if random.below(10) < of_ten {
        for _ in 0..=random.below(3) {
            match random.below(3) {
                0 => word(random, &mut bytes, pool),
                _ => group(random, &mut bytes, pool),
            }
        }
        bytes.truncate(MAX_BYTES);
        return bytes;
    }
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

/// A word or number becomes another one of the same text or of another input.
fn word(random: &mut Random, bytes: &mut Vec<u8>, pool: &[Vec<u8>]) {
    let own = words_of(bytes);
    let other = &pool[random.below(pool.len())];
    let (from, theirs) =
        if random.below(3) == 0 { (other.clone(), words_of(other)) } else { (bytes.clone(), own.clone()) };
    let (Some(at), Some(word)) = (own.get(random.below(own.len())), theirs.get(random.below(theirs.len())))
    else {
        return;
    };
    bytes.splice(at.clone(), from[word.clone()].iter().copied());
}

fn words_of(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let is_of_word = |byte: &u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'.');
    let mut words = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let length = bytes[at..].iter().take_while(|byte| is_of_word(byte)).count();
        if length > 0 {
            words.push(at..at + length);
        }
        at += length + 1;
    }
    words
}

/// What stands between brackets, with them: taken out, doubled, exchanged for another one, or put around itself.
fn group(random: &mut Random, bytes: &mut Vec<u8>, pool: &[Vec<u8>]) {
    let own = groups_of(bytes);
    let Some(at) = own.get(random.below(own.len())).cloned() else { return };
    let copied = bytes[at.clone()].to_vec();
    match random.below(6) {
        0 => {
            bytes.drain(at);
        }
        1 => {
            bytes.splice(at.start..at.start, copied.into_iter().chain(*b" "));
        }
        2 | 3 => {
            let other = &pool[random.below(pool.len())];
            let theirs = groups_of(other);
            let alike: Vec<_> = theirs.iter().filter(|range| other[range.start] == copied[0]).collect();
            let Some(taken) = alike.get(random.below(alike.len())) else { return };
            let range = if random.below(2) == 0 { at } else { at.end..at.end };
            bytes.splice(range, other[(*taken).clone()].iter().copied());
        }
        4 => {
            let Some(other) = own.get(random.below(own.len())) else { return };
            let replacement = bytes[other.clone()].to_vec();
            bytes.splice(at, replacement);
        }
        _ => {
            // Its inside goes where it stood.
            bytes.splice(at, copied[1..copied.len() - 1].iter().copied());
        }
    }
}

/// Returns where brackets open and close in turn. What is in quotes counts as anything else: inputs need not be sound.
fn groups_of(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let mut open: Vec<usize> = Vec::new();
    let mut groups = Vec::new();
    for (at, byte) in bytes.iter().enumerate() {
        match byte {
            b'(' | b'[' | b'{' => open.push(at),
            b')' | b']' | b'}' => {
                if let Some(start) = open.pop() {
                    groups.push(start..at + 1);
                }
            }
            _ => {}
        }
    }
    groups
}
