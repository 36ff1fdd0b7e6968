//! Probabilities of failures as decimals.

use exact::Rational;

/// Livingstone's ranks as probabilities: 10 to the power of minus rank.
pub(super) const RANKS: [(&str, &str); 5] = [
    ("likely", "0.1"),
    ("lessLikely", "0.01"),
    ("unlikely", "0.001"),
    ("rare", "0.0001"),
    ("unknownFaultRank", "0.0000000001"),
];

/// A probability such as `.5` or `1.0e-4` without an exponent.
pub(super) fn decimal(text: &str) -> Option<String> {
    let (digits, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let exponent: i32 = exponent.parse().ok().filter(|exponent| (-18..=18).contains(exponent))?;
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    if !whole.chars().chain(part.chars()).all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    let digits = format!("{whole}{part}");
    let shift = part.len() as i32 - exponent;
    let written = if shift > 0 {
        let padded = format!("{digits:0>width$}", width = shift as usize + 1);
        let (whole, part) = padded.split_at(padded.len() - shift as usize);
        format!("{}.{}", whole.trim_start_matches('0'), part.trim_end_matches('0'))
    } else {
        format!("{digits}{}", "0".repeat(-shift as usize))
    };
    let written = if written.starts_with('.') { format!("0{written}") } else { written };
    let written = written.trim_end_matches('.').to_owned();
    let value: Rational = written.parse().ok()?;
    (value > Rational::ZERO && value <= Rational::ONE).then_some(written)
}
