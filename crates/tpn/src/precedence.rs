//! Which precedences follow from others.

use std::collections::BTreeMap;

/// Returns which of the pairs, each of an earlier and a later interval, do not follow from the others (the transitive
/// reduction). All are needed where they go in circles. Linear in the pairs times the intervals, 64 at a time.
pub fn needed(pairs: &[[usize; 2]]) -> Vec<bool> {
    let mut places: BTreeMap<usize, usize> = pairs.iter().flatten().map(|&interval| (interval, 0)).collect();
    for (place, at) in places.values_mut().enumerate() {
        *at = place;
    }
    let count = places.len();
    let mut later: Vec<Vec<(usize, usize)>> = vec![Vec::new(); count];
    let mut awaited = vec![0_usize; count];
    for (number, [earlier, then]) in pairs.iter().enumerate() {
        let (earlier, then) = (places[earlier], places[then]);
        later[earlier].push((then, number));
        awaited[then] += 1;
    }
    let mut order: Vec<usize> = (0..count).filter(|&interval| awaited[interval] == 0).collect();
    let mut at = 0;
    while let Some(&interval) = order.get(at) {
        at += 1;
        for &(then, _) in &later[interval] {
            awaited[then] -= 1;
            if awaited[then] == 0 {
                order.push(then);
            }
        }
    }
    let mut is_needed = vec![true; pairs.len()];
    if order.len() < count {
        return is_needed;
    }
    let mut rank = vec![0; count];
    for (place, &interval) in order.iter().enumerate() {
        rank[interval] = place;
    }
    let words = count.div_ceil(64);
    let mut reached = vec![0_u64; count * words];
    for &interval in order.iter().rev() {
        later[interval].sort_by_key(|&(then, _)| rank[then]);
        let mut own = vec![0_u64; words];
        for &(then, number) in &later[interval] {
            let (word, bit) = (then / 64, 1 << (then % 64));
            is_needed[number] = own[word] & bit == 0;
            own[word] |= bit;
            for (own, other) in own.iter_mut().zip(&reached[then * words..][..words]) {
                *own |= other;
            }
        }
        reached[interval * words..][..words].copy_from_slice(&own);
    }
    is_needed
}

#[cfg(test)]
mod tests {
    use super::needed;

    #[test]
    fn of_a_total_order_the_steps_are_left() {
        let count = 130;
        let pairs: Vec<[usize; 2]> =
            (0..count).flat_map(|later| (0..later).map(move |earlier| [earlier * 3, later * 3])).collect();
        let left: Vec<[usize; 2]> =
            pairs.iter().zip(needed(&pairs)).filter(|(_, needed)| *needed).map(|(pair, _)| *pair).collect();
        let steps: Vec<[usize; 2]> = (1..count).map(|later| [(later - 1) * 3, later * 3]).collect();
        assert_eq!(left, steps);
    }

    #[test]
    fn what_nothing_else_says_stays() {
        assert_eq!(needed(&[[1, 2], [1, 3], [2, 4], [3, 4], [1, 4]]), [true, true, true, true, false]);
        assert_eq!(needed(&[[1, 2], [2, 1]]), [true, true]);
        assert_eq!(needed(&[[1, 2], [1, 2]]), [true, false]);
        assert!(needed(&[]).is_empty());
    }
}
