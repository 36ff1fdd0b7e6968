//! The plain-text format: what is read, what is refused and where.

use stn::{Inconsistency, PointId, parse};

const CONSISTENT: &str = "# KIND OF NETWORK\nSTN\n# Num Time-Points\n5\n# Num Ordinary Edges\n8\n\
    # Time-Point Names\nZ A B C D\n# Ordinary Edges\n\
    Z 12 A\nA 5 B\nB 3 A\nB 7 Z\nD 6 Z\nD 11 C\nC 9 D\nA 4 C\n";

#[test]
fn a_consistent_document_has_windows_relative_to_its_first_point() {
    let document = parse(CONSISTENT).expect("well formed");
    let (mut stn, consistent) = document.to_stn();
    assert_eq!(consistent, Ok(()));
    let windows = stn.windows(PointId(0)).expect("small numbers");
    // By hand: A − Z ≤ 12; Z − A ≤ 5 + 7 by way of B, so A − Z ≥ −12.
    assert_eq!((windows[1].earliest, windows[1].latest), (Some(-12), Some(12)));
    assert_eq!((windows[2].earliest, windows[2].latest), (Some(-7), Some(17)));
}

#[test]
fn an_inconsistent_document_names_its_edges() {
    let document =
        parse(&CONSISTENT.replace("Z 12 A", "Z -4 A").replace("B 7 Z", "B -3 Z")).expect("well formed");
    let (stn, consistent) = document.to_stn();
    assert_eq!(consistent, Err(Inconsistency::NegativeCycle));
    let mut tags: Vec<u32> = stn.cycle().iter().map(|edge| edge.tag).collect();
    tags.sort_unstable();
    // Z → A (−4), A → B (5), B → Z (−3) weighs −2.
    assert_eq!(tags, [0, 1, 3]);
}

#[test]
fn what_is_wrong_with_a_document_is_told_with_its_line() {
    let refused = |text: &str| parse(text).expect_err("malformed");
    assert_eq!(refused("STN\n").line, 1);
    assert_eq!(refused(&CONSISTENT.replace("STN", "STNU")).line, 2);
    assert_eq!(refused(&CONSISTENT.replace("\n5\n", "\n6\n")).line, 8);
    assert_eq!(refused(&CONSISTENT.replace("A 5 B", "A 5 Q")).message, "Q is not a time point");
    assert_eq!(refused(&CONSISTENT.replace("A 5 B", "A 5.5 B")).line, 11);
    assert_eq!(
        refused(&CONSISTENT.replace("A 4 C\n", "")).message,
        "8 edges are announced, but 7 are listed"
    );
    assert_eq!(refused(&CONSISTENT.replace("Z A B", "Z A A")).message, "A is named twice");
    assert!(refused("# only\n").message.contains("empty"));
}
