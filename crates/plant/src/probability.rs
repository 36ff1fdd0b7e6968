//! Exact probabilities.

use num_bigint::BigInt;
use num_rational::BigRational;

/// An exact fraction.
pub type Probability = BigRational;

/// Reads `0.01`, `1/100` or `1`; `None` if it is not such a number, negative, or longer than 18 digits.
pub fn parse(text: &str) -> Option<(u64, u64)> {
    let digits = |text: &str| {
        (!text.is_empty() && text.len() <= 18 && text.bytes().all(|byte| byte.is_ascii_digit()))
            .then(|| text.parse::<u64>().ok())
            .flatten()
    };
    if let Some((numerator, denominator)) = text.split_once('/') {
        let (numerator, denominator) = (digits(numerator)?, digits(denominator)?);
        return (denominator > 0).then(|| reduced(numerator, denominator));
    }
    let (whole, decimals) = text.split_once('.').unwrap_or((text, ""));
    let denominator = 10_u64.checked_pow(decimals.len() as u32).filter(|_| decimals.len() <= 18)?;
    let decimals = if decimals.is_empty() { 0 } else { digits(decimals)? };
    let whole = if whole.is_empty() { 0 } else { digits(whole)? };
    let numerator = whole.checked_mul(denominator)?.checked_add(decimals)?;
    Some(reduced(numerator, denominator))
}

/// Reads an exact fraction of any length: `96059601/96668224`, `1`, `0.25`.
pub fn parse_exact(text: &str) -> Option<Probability> {
    let number = |text: &str| {
        (!text.is_empty() && text.len() <= 100_000 && text.bytes().all(|byte| byte.is_ascii_digit()))
            .then(|| text.parse::<BigInt>().ok())
            .flatten()
    };
    if let Some((numerator, denominator)) = text.split_once('/') {
        let (numerator, denominator) = (number(numerator)?, number(denominator)?);
        return (denominator != BigInt::from(0)).then(|| BigRational::new(numerator, denominator));
    }
    match text.split_once('.') {
        None => number(text).map(BigRational::from),
        Some((whole, decimals)) => {
            let scale = BigInt::from(10).pow(u32::try_from(decimals.len()).ok()?);
            Some(BigRational::new(number(&format!("{whole}{decimals}"))?, scale))
        }
    }
}

fn reduced(numerator: u64, denominator: u64) -> (u64, u64) {
    let divisor = num_integer::gcd(numerator, denominator).max(1);
    (numerator / divisor, denominator / divisor)
}
