//! Numbers that look like chance (`SplitMix64`, Steele, Lea and Flood 2014).

/// What a seed gives, number by number.
pub(super) struct Chance(pub(super) u64);

impl Chance {
    /// Below `count`, which is not 0.
    pub(super) fn below(&mut self, count: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) % count
    }
}
