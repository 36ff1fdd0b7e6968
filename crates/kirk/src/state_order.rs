//! What gives a variable that keeps its value one, in order (SPEC 10.2): changes that exclude each other follow each other;
//! neighbors that give one and the same value may overlap.

use tpn::{LabelId, Ordering};

use crate::conditions::Conditions;

/// Changes of one variable in order, by which of two that exclude each other comes first. What is nearly in order already
/// costs little. Changes that nothing tells apart come in textual order, so that one order has one list.
pub(crate) fn in_order(
    conditions: &Conditions,
    changes: &[LabelId],
    is_before: impl Fn(LabelId, LabelId) -> bool,
) -> Vec<LabelId> {
    let mut order: Vec<LabelId> = Vec::with_capacity(changes.len());
    for &change in changes {
        let comes_first = |earlier: LabelId| is_before(earlier, change);
        let last = order.iter().rposition(|&it| conditions.exclude(it, change) && comes_first(it));
        let Some(last) = last else {
            order.insert(0, change);
            continue;
        };
        // Those that may overlap the last one may come after the change: what lies between tells them apart.
        let is_alike = |&&it: &&LabelId| !conditions.exclude(it, order[last]);
        let from = last - order[..last].iter().rev().take_while(is_alike).count();
        let to = last + 1 + order[last + 1..].iter().take_while(is_alike).count();
        let (mut earlier, later): (Vec<LabelId>, Vec<LabelId>) =
            order[from..to].iter().partition(|&&it| comes_first(it));
        earlier.push(change);
        earlier.extend(later);
        order.splice(from..to, earlier);
    }
    for alike in order.chunk_by_mut(|&one, &other| !conditions.exclude(one, other)) {
        alike.sort_unstable();
    }
    order
}

/// The pairs of an order from which all the others follow: each change with the next ones that it excludes.
pub(crate) fn neighbors(conditions: &Conditions, order: &[LabelId]) -> Vec<Ordering> {
    let runs: Vec<&[LabelId]> = order.chunk_by(|&one, &other| !conditions.exclude(one, other)).collect();
    let mut pairs = Vec::new();
    for next in runs.windows(2) {
        for &first in next[0] {
            pairs.extend(next[1].iter().map(|&then| Ordering { first, then }));
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use tpn::{LabelId, Network, Top};

    use super::*;
    use crate::model::Model;

    fn model(text: &str) -> (Network, Model) {
        let parsed = rmpl::parse(text);
        let (network, diagnostics) = tpn::compile(&parsed.program(), &Top::Scenario(None));
        let network = network.unwrap_or_else(|| panic!("{text} has errors: {diagnostics:?}"));
        let model = Model::new(&network, None).expect("the bounds are small");
        (network, model)
    }

    /// Labels by the names of what they are of.
    fn labels(network: &Network, names: &[&str]) -> Vec<LabelId> {
        let all = tpn::plan_json::Names::new(network);
        names.iter().map(|name| all.label(name).unwrap_or_else(|problem| panic!("{problem}"))).collect()
    }

    #[test]
    fn an_order_does_not_depend_on_where_it_is_begun() {
        let text = "state X : {A, B} = A; primitive ToB()[1,1] sets X=B; \
            scenario S[0,99] = { X=A [1,2], X=A [1,2], ToB(), X=B [1,2], X=A [1,2] }";
        let (network, model) = model(text);
        let tell = |number: u32, value: &str| format!("Tell(X={value})@Tell(X={value})#{number}");
        let names = [tell(1, "A"), tell(2, "A"), "Set(X=B)@ToB#1".to_owned(), tell(1, "B"), tell(3, "A")];
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        // Two assertions of A, the change, the assertion of B, and A again.
        let expected = labels(&network, &names);
        let rank = |label: LabelId| expected.iter().position(|&it| it == label).expect("one of them").max(1);
        let mut orders = vec![expected.clone()];
        for position in 0..expected.len() {
            let mut other = expected.clone();
            other.rotate_left(position);
            orders.push(other.clone());
            other.reverse();
            orders.push(other);
        }
        for begun in orders {
            let found = in_order(&model.conditions, &begun, |first, then| rank(first) < rank(then));
            assert_eq!(found, expected, "{begun:?}");
        }
        let pairs = neighbors(&model.conditions, &expected);
        let at = |first: usize, then: usize| Ordering { first: expected[first], then: expected[then] };
        assert_eq!(pairs, [at(0, 2), at(1, 2), at(2, 3), at(3, 4)]);
    }
}
