//! Values of options that count: whole numbers, refused with the numbers that the option accepts.

use std::ops::RangeInclusive;

use exact::grouped;

/// A reader of whole numbers in `range`, for an option.
pub fn number_in<T>(range: RangeInclusive<T>) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync
where
    T: Copy + Into<u64> + PartialOrd + std::str::FromStr + Send + Sync,
{
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| {
            let [from, to] = [*range.start(), *range.end()].map(|bound| grouped(bound.into()));
            format!("expected a whole number from {from} to {to}")
        })
    }
}

/// A seed: any whole number that has 64 bits.
pub fn seed(text: &str) -> Result<u64, String> {
    number_in(0..=u64::MAX)(text)
}

/// A number of at least 1.
pub fn positive_number(text: &str) -> Result<u32, String> {
    number_in(1..=u32::MAX)(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_names_the_numbers_that_are_accepted() {
        assert_eq!(seed("18446744073709551615"), Ok(u64::MAX));
        let accepted = "expected a whole number from 0 to 18,446,744,073,709,551,615";
        for wrong in ["x", "-1", "1.5", "", "18446744073709551616"] {
            assert_eq!(seed(wrong), Err(accepted.to_owned()), "{wrong}");
        }
        assert_eq!(number_in(1..=1_000_u32)("0"), Err("expected a whole number from 1 to 1,000".to_owned()));
        assert_eq!(positive_number("7"), Ok(7));
    }
}
