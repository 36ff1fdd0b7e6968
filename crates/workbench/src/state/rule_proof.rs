//! Which flight rules hold in every plan of the mission: the core proves one rule after the other.

use link::{Request, Response, Update};
use review::MissionRule;
use review::flight_rule::proof::{ALTERNATIVES, Counterexample, Proven, Verdict};

use crate::state::window::Window;

/// What was proven so far.
#[derive(Debug, Default)]
pub struct RuleProofState {
    running: Option<Running>,
    /// What was found of each content, by its hash, the latest first: an edit and its undo find it again.
    found: Vec<(String, Vec<Proven>)>,
}

/// What can be asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RuleProofCommand {
    /// Proves the rule with this text, or all rules.
    Start(Option<String>),
    /// Stops; what was found is kept.
    Stop,
    /// Opens the plan that does not keep the rule with this text.
    Open(String),
}

#[derive(Debug)]
struct Running {
    revision: u64,
    content_hash: String,
    /// The rules that are not answered, the next one last.
    waiting: Vec<MissionRule>,
    total: usize,
    /// How many alternatives the planner tries for the next one.
    alternatives: u64,
}

/// So many alternatives at first, and this many times more each next time: what is simple is known at once.
const FIRST_ALTERNATIVES: u64 = 2_000;
const FACTOR: u64 = 10;
/// Contents of which results are kept.
const MAX_CONTENTS: usize = 6;

impl RuleProofState {
    /// Returns how many rules have been answered, and how many are to be; `None` while nothing is proven.
    pub fn progress(&self) -> Option<[usize; 2]> {
        let running = self.running.as_ref()?;
        Some([running.total - running.waiting.len(), running.total])
    }

    /// Returns what was found of a rule.
    pub fn of_rule(&self, content_hash: &str, rule: &str) -> Option<&Proven> {
        self.of_content(content_hash).find(|proven| proven.rule == rule)
    }

    /// Returns what was found of all rules of a content.
    pub fn of_content(&self, content_hash: &str) -> impl Iterator<Item = &Proven> {
        let known = self.found.iter().find(|(of, _)| of == content_hash);
        known.into_iter().flat_map(|(_, proven)| proven)
    }

    /// The plan that does not keep a rule.
    pub(crate) fn counterexample(&self, content_hash: &str, rule: &str) -> Option<&Counterexample> {
        self.of_rule(content_hash, rule)?.verdict.counterexample()
    }

    /// What was asked for does not come.
    pub(crate) fn give_up(&mut self) {
        self.running = None;
    }

    /// Begins to prove these rules.
    pub(crate) fn start(
        &mut self,
        update: Update,
        content_hash: String,
        mut rules: Vec<MissionRule>,
        window: &mut Window,
    ) {
        rules.reverse();
        let (revision, total) = (update.revision, rules.len());
        let alternatives = FIRST_ALTERNATIVES;
        self.running = Some(Running { revision, content_hash, waiting: rules, total, alternatives });
        self.lead_on(Some(update), window);
    }

    /// Asks for the next rule, unless the mission has changed.
    fn lead_on(&mut self, update: Option<Update>, window: &mut Window) {
        let Some(running) = &self.running else { return };
        let update = update.filter(|update| update.revision == running.revision);
        match update.zip(running.waiting.last()) {
            Some((update, rule)) => {
                let (rule, alternatives) = (rule.clone(), running.alternatives);
                window.post(Request::ProveRule { update, rule, alternatives });
            }
            None => self.running = None,
        }
    }

    /// Takes what was found of a rule, and asks for the next one.
    pub(crate) fn take(&mut self, answer: Response, update: Option<Update>, window: &mut Window) {
        let Response::RuleProven { revision, rule, alternatives, proven } = answer else { return };
        let is_wanted = |running: &&mut Running| {
            let is_next = running.waiting.last().is_some_and(|next| next.rule == rule);
            (running.revision, running.alternatives) == (revision, alternatives) && is_next
        };
        let Some(running) = self.running.as_mut().filter(is_wanted) else { return };
        let content_hash = running.content_hash.clone();
        match proven {
            Ok(proven) => {
                if proven.verdict.is_open()
                    && proven.alternatives >= alternatives
                    && alternatives < ALTERNATIVES
                {
                    running.alternatives = alternatives * FACTOR;
                } else {
                    running.alternatives = FIRST_ALTERNATIVES;
                    running.waiting.pop();
                }
                self.keep(content_hash.clone(), proven);
            }
            Err(reason) => {
                self.running = None;
                window.failed(format!("Couldn\u{2019}t prove the rules: {reason}"));
                return;
            }
        }
        if self.running.as_ref().is_some_and(|running| !running.waiting.is_empty()) {
            self.lead_on(update, window);
            return;
        }
        self.running = None;
        window.done(self.summary(&content_hash));
    }

    /// Returns what was found of a content, in one sentence.
    fn summary(&self, content_hash: &str) -> String {
        let all: Vec<&Verdict> = self.of_content(content_hash).map(|proven| &proven.verdict).collect();
        let count = |is: fn(&Verdict) -> bool| all.iter().filter(|it| is(it)).count();
        let kept = count(Verdict::is_kept);
        let rules = if all.len() == 1 { "rule" } else { "rules" };
        let others = [
            (count(Verdict::is_open), "not decided"),
            (count(|it| matches!(it, Verdict::Unreadable { .. })), "with an error"),
        ];
        let others = others.iter().filter(|(count, _)| *count > 0);
        let others: String = others.map(|(count, what)| format!(", {count} {what}")).collect();
        format!("{kept} of {} {rules} hold in every plan{others}", all.len())
    }

    /// A rule that is proven again replaces what was found of it before.
    fn keep(&mut self, of: String, proven: Proven) {
        let known = self.found.iter().position(|(known, _)| *known == of);
        let mut all = known.map(|at| self.found.remove(at).1).unwrap_or_default();
        all.retain(|known| known.rule != proven.rule);
        all.push(proven);
        self.found.insert(0, (of, all));
        self.found.truncate(MAX_CONTENTS);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Effect;

    fn rule(text: &str) -> MissionRule {
        MissionRule { name: text.into(), rule: text.into(), ..MissionRule::default() }
    }

    fn answer(rule: &str, alternatives: u64, verdict: Verdict) -> Response {
        let proven = Proven { rule: rule.into(), verdict, alternatives };
        Response::RuleProven { revision: 1, rule: rule.into(), alternatives, proven: Ok(proven) }
    }

    fn asked(window: &mut Window) -> Vec<(String, u64)> {
        let requests = window.take_effects().into_iter().filter_map(|effect| match effect {
            Effect::Post(request) => Some(request),
            _ => None,
        });
        let rules = requests.filter_map(|request| match request {
            Request::ProveRule { rule, alternatives, .. } => Some((rule.rule, alternatives)),
            _ => None,
        });
        rules.collect()
    }

    #[test]
    fn rules_are_proven_one_after_the_other_and_harder_ones_with_more_patience() {
        let (mut state, mut window) = (RuleProofState::default(), Window::default());
        let update = || Update::new(1, "");
        state.start(update(), "hash".into(), vec![rule("A"), rule("B")], &mut window);
        assert_eq!((asked(&mut window), state.progress()), (vec![("A".into(), 2_000)], Some([0, 2])));
        let open = || Verdict::Open("the limit was reached".into());
        state.take(answer("A", 2_000, open()), Some(update()), &mut window);
        assert_eq!(asked(&mut window), [("A".into(), 20_000)]);
        // What was asked before comes too late.
        state.take(answer("A", 2_000, Verdict::Holds), Some(update()), &mut window);
        assert!(asked(&mut window).is_empty());
        state.take(answer("A", 20_000, Verdict::Holds), Some(update()), &mut window);
        assert_eq!((asked(&mut window), state.progress()), (vec![("B".into(), 2_000)], Some([1, 2])));
        state.take(answer("B", 2_000, Verdict::NeverApplies), Some(update()), &mut window);
        assert_eq!(state.progress(), None);
        assert_eq!(state.summary("hash"), "2 of 2 rules hold in every plan");
        assert_eq!(state.of_rule("hash", "A").map(|it| &it.verdict), Some(&Verdict::Holds));
        assert_eq!(state.of_rule("other", "A"), None);
    }

    #[test]
    fn rules_with_errors_are_not_called_undecided() {
        let (mut state, mut window) = (RuleProofState::default(), Window::default());
        let verdicts = [
            Verdict::Holds,
            Verdict::Open("the limit was reached".into()),
            Verdict::Unreadable { column: 3, message: "expected a state".into() },
        ];
        let rules = ["A", "B", "C"];
        state.start(Update::new(1, ""), "hash".into(), rules.map(rule).to_vec(), &mut window);
        for (rule, verdict) in rules.into_iter().zip(verdicts) {
            for alternatives in [2_000, 20_000, 200_000] {
                let update = Some(Update::new(1, ""));
                state.take(answer(rule, alternatives, verdict.clone()), update, &mut window);
            }
        }
        assert_eq!(state.summary("hash"), "1 of 3 rules hold in every plan, 1 not decided, 1 with an error");
    }

    #[test]
    fn an_edit_ends_a_proof() {
        let (mut state, mut window) = (RuleProofState::default(), Window::default());
        state.start(Update::new(1, ""), "hash".into(), vec![rule("A"), rule("B")], &mut window);
        state.take(answer("A", 2_000, Verdict::Holds), Some(Update::new(2, "x")), &mut window);
        assert_eq!(state.progress(), None);
    }
}
