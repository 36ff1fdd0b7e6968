//! What the alternatives of a choice are called when people are told about it.

use smol_str::SmolStr;

use crate::network::{ArcId, DecisionId, Network, NodeId, Occurrence, OccurrenceKind};

/// The longest call that represents an alternative, in characters; of longer ones, the first and the last argument are told.
const LONGEST_CALL: usize = 40;
/// The fewest characters of an argument that is cut.
const MIN_ARGUMENT: usize = 6;
/// So many parts of an alternative are named.
const MAX_NAMED: usize = 2;

/// What an alternative is called that does nothing.
const NOTHING: &str = "nothing";

/// Returns how an alternative of this name reads after `instead of`: one that does nothing skips the one that was selected.
pub fn other_choice(name: &str) -> &str {
    if name == NOTHING { "skipping it" } else { name }
}

impl Network {
    /// Returns what an alternative of a decision does, for people: `Carry(GAP, LANDER)`, or `Group-Traverse-Path(A, …,
    /// TAI_POS)` where the call is long, or `Drive(RIDGE), Dig#1 and 2 more`. `nothing` where it does nothing.
    ///
    /// Takes time linear in the network for each alternative of the decision.
    pub fn alternative_name(&self, decision: DecisionId, alternative: u32) -> String {
        let Some(choice_arcs) = self.decisions.get(decision.index()).map(|it| &it.alternatives) else {
            return format!("alternative {alternative}");
        };
        if choice_arcs.len() <= alternative as usize {
            return format!("alternative {alternative}");
        }
        let own = self.own_nodes(decision, alternative);
        let is_own = |node: NodeId| own[node.index()];
        let is_in = |occurrence: &Occurrence| is_own(occurrence.start);
        let named = |is_wanted: &dyn Fn(OccurrenceKind) -> bool| -> Vec<&Occurrence> {
            let is_part = |occurrence: &&Occurrence| {
                // What an activity consists of goes without saying.
                let parent = occurrence.parent.and_then(|parent| self.occurrences.get(parent.index()));
                is_wanted(occurrence.kind) && is_in(occurrence) && !parent.is_some_and(is_in)
            };
            self.occurrences.iter().filter(is_part).collect()
        };
        let calls = named(&|kind| matches!(kind, OccurrenceKind::Primitive | OccurrenceKind::Activity));
        let parts = if calls.is_empty() {
            named(&|kind| matches!(kind, OccurrenceKind::Assertion | OccurrenceKind::Delay))
        } else {
            calls
        };
        match parts.as_slice() {
            [] => NOTHING.to_owned(),
            [single] => self.call(single),
            several => {
                let names: Vec<String> =
                    several.iter().take(MAX_NAMED).map(|it| self.readable(&it.name)).collect();
                match several.len().saturating_sub(MAX_NAMED) {
                    0 => names.join(" and "),
                    rest => format!("{} and {rest} more", names.join(", ")),
                }
            }
        }
    }

    /// The call of an activity; its name where another call, shortened, reads the same.
    fn call(&self, occurrence: &Occurrence) -> String {
        let text = shortened_call(occurrence);
        let is_alike = |other: &Occurrence| {
            other.activity == occurrence.activity
                && other.arguments != occurrence.arguments
                && shortened_call(other) == text
        };
        if occurrence.arguments.is_empty() || (text.contains('…') && self.occurrences.iter().any(is_alike))
        {
            return occurrence.name.to_string();
        }
        text
    }

    /// By node, whether an alternative of a decision leads to it and no other one does; of a decision with one alternative,
    /// whether that leads to it. Takes time linear in the network for each alternative.
    pub fn own_nodes(&self, decision: DecisionId, alternative: u32) -> Vec<bool> {
        let choice_arcs = self.decisions.get(decision.index()).map(|it| it.alternatives.as_slice());
        let choice_arcs = choice_arcs.unwrap_or_default();
        let Some(&own_arc) = choice_arcs.get(alternative as usize) else {
            return vec![false; self.nodes.len()];
        };
        let mut own = self.followers(own_arc);
        for &arc in choice_arcs.iter().filter(|&&arc| arc != own_arc) {
            for (is_own, is_followed) in own.iter_mut().zip(self.followers(arc)) {
                *is_own &= !is_followed;
            }
        }
        own
    }

    /// The nodes that an arc leads to, directly or not.
    fn followers(&self, arc: ArcId) -> Vec<bool> {
        let mut found = vec![false; self.nodes.len()];
        let mut open = vec![self.arcs[arc.index()].to];
        while let Some(node) = open.pop() {
            // Arcs back to the start hold facts of a run.
            if node != self.start && !std::mem::replace(&mut found[node.index()], true) {
                open.extend(self.nodes[node.index()].out_arcs.iter().map(|arc| self.arcs[arc.index()].to));
            }
        }
        found
    }
}

/// The call of an activity, shortened where it is long.
pub(crate) fn shortened_call(occurrence: &Occurrence) -> String {
    let arguments: Vec<&str> = occurrence.arguments.iter().map(SmolStr::as_str).collect();
    shortened(&occurrence.activity, &arguments)
}

/// A call, shortened where it is long: by the arguments between the first and the last one, then by the ends of both.
fn shortened(activity: &str, arguments: &[&str]) -> String {
    let call = |arguments: &[&str]| format!("{activity}({})", arguments.join(", "));
    let fits = |call: &String| call.chars().count() <= LONGEST_CALL;
    let complete = call(arguments);
    if fits(&complete) {
        return complete;
    }
    let ends: Vec<&str> = match arguments {
        [first, last] => vec![first, last],
        [first, .., last] => vec![first, "…", last],
        _ => arguments.to_vec(),
    };
    let told = call(&ends);
    if fits(&told) {
        return told;
    }
    let named = ends.iter().filter(|&&it| it != "…").count().max(1);
    let around = told.chars().count() - ends.iter().map(|it| it.chars().count()).sum::<usize>();
    let each = (LONGEST_CALL.saturating_sub(around + ends.len() - named) / named).max(MIN_ARGUMENT);
    let cut: Vec<String> = ends.iter().map(|argument| cut(argument, each)).collect();
    call(&cut.iter().map(String::as_str).collect::<Vec<_>>())
}

/// The beginning of a text that has more than so many characters.
fn cut(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most.saturating_sub(1)).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::shortened;
    use crate::{DecisionId, Top, compile};

    fn names(alternatives: &str) -> Vec<String> {
        let source = format!(
            "primitive Dig(place); primitive Rest();\n\
             Both() = {{ Dig(A)[1,2]; Dig(B)[1,2] }}\n\
             Work() = {{ choose {{ {alternatives} }}; Rest()[1,1] }}\n\
             scenario S[0,100] = {{ Work() }}"
        );
        let parse = rmpl::parse(&source);
        let (network, diagnostics) = compile(&parse.program(), &Top::Scenario(None));
        let network = network.unwrap_or_else(|| panic!("{:?} {diagnostics:?}", parse.diagnostics()));
        let count = network.decisions[0].alternatives.len() as u32;
        (0..count).map(|index| network.alternative_name(DecisionId(0), index)).collect()
    }

    #[test]
    fn alternatives_are_named_by_what_they_alone_do() {
        assert_eq!(names("Dig(EAST)[1,2], Dig(WEST)[1,2]"), ["Dig(EAST)", "Dig(WEST)"]);
        assert_eq!(
            names("Both(), { Dig(A)[1,2]; Rest()[1,1]; Dig(B)[1,2] }"),
            ["Both#1", "Dig(A)#3, Rest#1 and 1 more"]
        );
        assert_eq!(
            names("Dig(A-PLACE-WITH-A-NAME-THAT-NOBODY-READS)[1,2], delay[1,2]"),
            ["Dig(A-PLACE-WITH-A-NAME-THAT-NOBODY-RE…)", "delay#1"]
        );
        let alike = "Dig(FIRST-OUTCROP, EAST, LAST-OUTCROP-OF-ALL)[1,2], Dig(FIRST-OUTCROP, WEST, LAST-OUTCROP-OF-ALL)[1,2]";
        assert_eq!(names(alike), ["Dig#1", "Dig#2"]);
    }

    #[test]
    fn a_long_call_tells_its_first_and_its_last_argument() {
        let places = ["PATH1_1", "PATH1_2", "PATH1_3", "TAI_POS"];
        assert_eq!(shortened("Group-Traverse-Path", &places), "Group-Traverse-Path(PATH1_1, …, TAI_POS)");
        assert_eq!(shortened("Visit", &["A", "B"]), "Visit(A, B)");
        let long = ["SOUTHERN-OUTCROP-OF-THE-CRATER", "B", "NORTHERN-OUTCROP-OF-THE-CRATER"];
        assert_eq!(shortened("Traverse", &long), "Traverse(SOUTHERN-OU…, …, NORTHERN-OU…)");
    }
}
