//! Properties of exact numbers: agreement with unbounded arithmetic, order, and round trips through every form.

use exact::{Bound, Rational, Scale, Time};
use num_bigint::BigInt;
use num_rational::Ratio;
use proptest::prelude::*;

type Big = Ratio<BigInt>;

fn big(number: Rational) -> Big {
    Big::new(number.numerator().into(), number.denominator().into())
}

/// The unbounded result, if 64 bits over 64 bits hold it.
fn fitting(result: &Big) -> Option<Rational> {
    let side = |side: &BigInt| i64::try_from(side).ok();
    Rational::new(side(result.numer())?, side(result.denom())?)
}

/// Integers of all magnitudes, with the extremes.
fn integer() -> impl Strategy<Value = i64> {
    prop_oneof![
        -20_i64..20,
        any::<i64>(),
        any::<i32>().prop_map(i64::from),
        prop_oneof![Just(i64::MIN), Just(i64::MIN + 1), Just(i64::MAX), Just(i64::MAX - 1)],
    ]
}

fn rational() -> impl Strategy<Value = Rational> {
    (integer(), integer())
        .prop_filter_map("no such fraction", |(numerator, denominator)| Rational::new(numerator, denominator))
}

proptest! {
    #[test]
    fn arithmetic_is_that_of_unbounded_fractions_or_none(left in rational(), right in rational()) {
        let (a, b) = (big(left), big(right));
        prop_assert_eq!(left.checked_add(right), fitting(&(&a + &b)));
        prop_assert_eq!(left.checked_sub(right), fitting(&(&a - &b)));
        prop_assert_eq!(left.checked_mul(right), fitting(&(&a * &b)));
        let quotient = if right.is_zero() { None } else { fitting(&(&a / &b)) };
        prop_assert_eq!(left.checked_div(right), quotient);
        prop_assert_eq!(left.checked_neg(), fitting(&-&a));
        prop_assert_eq!(left.cmp(&right), a.cmp(&b));
        prop_assert_eq!(BigInt::from(left.floor()), a.floor().to_integer());
    }

    #[test]
    fn bounds_are_ordered_below_infinity(left in rational(), right in rational()) {
        let (left, right) = (Time::from_units(left), Time::from_units(right));
        prop_assert_eq!(Bound::Finite(left).cmp(&Bound::Finite(right)), left.cmp(&right));
        prop_assert!(Bound::Finite(left) < Bound::Infinite);
    }

    #[test]
    fn what_is_printed_is_read_back(number in rational()) {
        prop_assert_eq!(number.to_string().parse::<Rational>(), Ok(number));
        let fraction = format!("{}/{}", number.numerator(), number.denominator());
        prop_assert_eq!(fraction.parse::<Rational>(), Ok(number));
    }

    #[test]
    fn what_is_written_into_documents_is_read_back(number in rational()) {
        for bound in [Bound::Finite(Time::from_units(number)), Bound::Infinite] {
            let text = serde_json::to_string(&bound).expect("no writer fails");
            prop_assert_eq!(serde_json::from_str::<Bound>(&text).ok(), Some(bound));
            let value = serde_json::to_value(bound).expect("no writer fails");
            prop_assert_eq!(serde_json::from_value::<Bound>(value).ok(), Some(bound));
            let bytes = postcard::to_allocvec(&bound).expect("no writer fails");
            prop_assert_eq!(postcard::from_bytes::<Bound>(&bytes).ok(), Some(bound));
        }
    }

    #[test]
    fn a_number_in_a_document_is_its_decimal(number in rational()) {
        let text = serde_json::to_string(&number).expect("no writer fails");
        if !text.starts_with('"') {
            prop_assert_eq!(text.parse::<Rational>(), Ok(number));
        }
    }

    #[test]
    fn readers_accept_or_refuse_any_text(text in ".{0,30}", digits in "[-+0-9./eE]{0,40}") {
        for text in [text, digits] {
            if let Ok(read) = text.parse::<Rational>() {
                prop_assert_eq!(read.to_string().parse::<Rational>(), Ok(read));
            }
        }
    }

    #[test]
    fn ticks_are_exact(times in prop::collection::vec((-1_000_000_i64..1_000_000, 1_i64..60), 1..8)) {
        let times: Vec<Time> = times.iter().filter_map(|&(n, d)| Time::new(n, d)).collect();
        if let Ok(scale) = Scale::common(times.iter().copied()) {
            for &time in &times {
                let ticks = scale.ticks(time).expect("the scale counts it");
                prop_assert_eq!(scale.time(ticks), time);
                prop_assert_eq!(scale.nearest_tick(time), ticks);
            }
        }
    }

    #[test]
    fn the_nearest_tick_is_at_most_half_a_tick_away(number in rational(), part in 1_i64..1000) {
        let scale = Scale::common(Time::new(1, part)).expect("a small denominator");
        let exact = big(number) * Big::from(BigInt::from(part));
        let nearest = (&exact + Big::new(1.into(), 2.into())).floor().to_integer();
        let expected = i64::try_from(&nearest).unwrap_or(if nearest < 0.into() { i64::MIN } else { i64::MAX });
        prop_assert_eq!(scale.nearest_tick(Time::from_units(number)), expected);
    }

    #[test]
    fn floats_are_rounded_up_or_to_the_nearest_part(units in -1e9_f64..1e9, parts in 1_u32..2000) {
        let up = Time::from_f64_up(units, parts).expect("within range").to_f64();
        let nearest = Time::from_f64_nearest(units, parts).expect("within range").to_f64();
        let part = 1.0 / f64::from(parts);
        // The product of a float and the parts is itself rounded.
        let slip = units.abs() * 1e-15;
        prop_assert!(up >= units - slip && up < units + part + slip);
        prop_assert!((nearest - units).abs() <= part / 2.0 + slip);
    }
}

#[test]
fn a_document_has_numbers_only_where_they_are_exact() {
    let shown = |n, d| serde_json::to_string(&Time::new(n, d)).expect("no writer fails");
    assert_eq!(shown(819, 2), "409.5");
    assert_eq!(shown(-7, 1), "-7");
    assert_eq!(shown(1000, 3), "\"1000/3\"");
    assert_eq!(shown(1, 10), "0.1");
    // More digits than a double holds: as a fraction, not rounded.
    assert_eq!(shown(12_345_678_901_234_567, 10), "\"12345678901234567/10\"");
    assert_eq!(serde_json::to_string(&Bound::Infinite).expect("no writer fails"), "\"inf\"");
}

#[test]
fn what_is_no_exact_time_in_a_document_is_refused_with_its_reason() {
    let refused = |text: &str| serde_json::from_str::<Time>(text).expect_err(text).to_string();
    assert!(refused("\"soon\"").contains("`soon` is not a number"));
    assert!(refused("9223372036854775808").contains("too large or too precise to represent exactly"));
    assert!(refused("1e300").contains("too large or too precise to represent exactly"));
    assert!(refused("\"inf\"").contains("finite"));
    assert!(refused("true").contains("an exact number"));
    assert!(postcard::from_bytes::<Time>(&[2, 0]).is_err(), "a denominator of zero");
}

#[test]
fn floats_beyond_exact_counting_become_no_time() {
    for wrong in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, 1e15] {
        assert_eq!(Time::from_f64_up(wrong, 1000), None, "{wrong}");
        assert_eq!(Time::from_f64_nearest(wrong, 1000), None, "{wrong}");
    }
    assert_eq!(Time::from_f64_up(0.0001, 1000), Time::new(1, 1000));
    assert_eq!(Time::from_f64_nearest(0.0001, 1000), Some(Time::ZERO));
    assert_eq!(Time::from_f64_up(1.0, 0), None);
}

#[test]
fn expressions_of_bounds_follow_the_rules_for_infinity() {
    let finite = |units: i64| Bound::Finite(units.into());
    assert_eq!(Bound::Infinite.times(finite(0)), Ok(Bound::ZERO));
    assert_eq!(Bound::Infinite.times(finite(3)), Ok(Bound::Infinite));
    assert_eq!(Bound::Infinite.minus(finite(3)), Ok(Bound::Infinite));
    assert_eq!(finite(450).times(finite(90)).and_then(|it| it.over(finite(100))), Ok(finite(405)));
    assert!(finite(3).minus(Bound::Infinite).is_err());
    assert!(finite(3).over(finite(0)).is_err());
    assert!(finite(i64::MAX).plus(finite(1)).is_err());
    assert!(finite(i64::MAX).times(finite(2)).is_err());
}
