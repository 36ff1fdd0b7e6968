//! Every sentence that explains is about the mission at hand: of conditions, states, resources, vehicles and the
//! environment only those speak whose mission has them, and no name is in a sentence that is not in the text. Held
//! against the examples, the conformance cases and many random missions, by both searches.

use std::collections::BTreeSet;

use acceptance::mission::compile;
use acceptance::missions::missions;
use exact::Time;
use kirk::{Constraint, CycleMember, Event, ExpansionLimit, Options, Search};
use review::{Fate, review};
use rmpl::program::LabelMode;
use snapshot::Goal;
use test_core::snapshot;
use tpn::{ArcId, ArcKind, DecisionId, LabelId, Network, Top};
use workbench::state::search::wording;

/// Random missions of each kind.
const MISSIONS: u64 = 150;

/// Words that say nothing of what a mission has.
const PLAIN: &str = "Add Back Before Decide Each Failure Follow From Jump Learned Look No Nothing Of Propagate Search The \
    This Together Try Whatever a after again all allow allows alone and another any arcs around as at back be before besides \
    block blocks both bounded but can cannot choice choices choose chooses chosen come comes conflict contain contradiction delays do \
    duration durations each end ends event events failed failure first fit follows for found from go gaps greatest happens has have \
    here if impossible in inf instead is it its keeping keeps kept last lasts learned least leave leaves left let long lower maximum minimum mission more most \
    move moves much must need needs neither never no node none not nothing of on once one ones only order ordering other \
    others out plan planner program put raise remaining rest rests room rule ruled rules running s search so some start take takes teaches text than that the \
    their them then there these they this time times to together too try up wait was what whatever which with would";

/// More such words, of the messages about steps of a search.
const OF_SEARCH: &str = "Backjump Backtrack Closed Continue Either Initial Plan Expand Find For Found No Open Order Restart Ruled Start Threat \
    adjacent alternatives cause change changes complete conflicts consistent constraints decide departure depends destination \
    are bounds early every fails follow found imply implies incompatible inconsistent initial learning longer many maximum minimum necessary open or ordered \
    orderings outgoing overused place possible prevent resource simultaneous state states succeed t these travel users window \
    windows";

/// Whether a mission has what some words are about.
type Has = fn(&Network) -> bool;

/// Words that are about something, and whether a mission has that.
const TELLING: [(&str, Has); 10] = [
    ("Ask asserts assertion causal link required requires", |it| {
        it.labels.iter().any(|it| it.mode == LabelMode::Ask)
    }),
    ("Set Tell hold holds set", |it| !it.labels.is_empty()),
    ("apart drive overlap separate separating way", |it| has_conflict(it, |_| true) || !it.sights.is_empty()),
    ("between conflicting gap gaps intervals touch", |it| has_conflict(it, |label| !it.is_lasting(label))),
    ("above below capacity consumed drawn enough filled fits give helps level produced share use", |it| {
        !it.uses.is_empty()
    }),
    ("gives support supports", |it| !it.labels.is_empty() || !it.uses.is_empty()),
    ("controllable earlier environment every met planned schedule uncontrolled works", |it| {
        (0..it.arcs.len()).any(|arc| it.is_uncertain(ArcId::from_index(arc)))
    }),
    ("Best best better far improve less optimal", |it| !it.objective.is_empty()),
    ("alternative", |it| !it.decisions.is_empty()),
    ("because ground line near sight", |it| !it.sights.is_empty()),
];

/// Returns whether two conditions, of those that count, exclude each other.
fn has_conflict(network: &Network, counts: impl Fn(LabelId) -> bool) -> bool {
    let labels = || (0..network.labels.len()).map(LabelId::from_index).filter(|&label| counts(label));
    labels().any(|one| labels().any(|other| network.conflict(one, other)))
}

/// Returns whether what needs a time needs more than what it is held against allows.
fn adds_up(sentence: &str) -> bool {
    let Some((needs, allows)) = sentence.split_once(", but ") else { return true };
    let number = |words: &str| words.rsplit(' ').next().and_then(|word| word.parse::<f64>().ok());
    let (allows, excess) = allows.split_once(": ").unwrap_or((allows, ""));
    let excess = excess.split_once(" too long").and_then(|(excess, _)| number(excess));
    match (number(needs).filter(|_| needs.contains("at least")), number(allows)) {
        (Some(needed), Some(allowed)) => {
            needed > allowed && excess.is_none_or(|excess| needed - allowed == excess)
        }
        _ => true,
    }
}

/// Returns how many bounds a sentence says to need time: `MODE=A (2 times), 2 delays and a gap of 1` are five. Nothing
/// if it does not name them all, or says what needs time in other words.
fn told_needs(sentence: &str) -> Option<usize> {
    let (before, _) = sentence.split_once(" at least ")?;
    let names = before.strip_suffix(" need").or(before.strip_suffix(" needs"))?;
    // `X in {A, C}` is one name.
    let names: String =
        names.split('{').map(|part| part.split_once('}').map_or(part, |(_, rest)| rest)).collect();
    let names = without_arguments(names.rsplit(": ").next()?);
    let names = names.as_str();
    let is_named = !["separating them", "running them one after the other", "their order in the mission"]
        .contains(&names);
    let (first, last) = names.rsplit_once(" and ").unwrap_or((names, ""));
    let parts = first.split(", ").chain((!last.is_empty()).then_some(last));
    let count = |part: &str| match part.strip_suffix(" times)").and_then(|it| it.rsplit('(').next()) {
        Some(times) => times.parse().ok(),
        None => match part.split(' ').next().and_then(|it| it.parse().ok()) {
            Some(_) if part.ends_with("others") => None,
            Some(number) => Some(number),
            None => (part != "one other").then_some(1),
        },
    };
    is_named.then(|| parts.map(count).sum()).flatten()
}

/// `Look(Scout1, RIDGE)` is one name, and ` (2 times)` is none.
fn without_arguments(names: &str) -> String {
    let (mut kept, mut is_inside, mut last) = (String::new(), false, ' ');
    for letter in names.chars() {
        is_inside |= letter == '(' && last != ' ';
        if !is_inside {
            kept.push(letter);
        }
        is_inside &= letter != ')';
        last = letter;
    }
    kept
}

/// The bounds of a negative cycle that need time and that an author has written, or that keep two apart.
fn needs(network: &Network, cycle: &[CycleMember]) -> usize {
    let is_written = |arc: ArcId| {
        use ArcKind::{Choice, Fork, Glue, Join, Merge, Point};
        !matches!(network.arcs[arc.index()].kind, Glue | Fork | Join | Choice | Merge | Point)
    };
    let needs = cycle.iter().filter(|member| match member.constraint {
        Constraint::Lower(arc) => member.weight != Time::ZERO && is_written(arc),
        Constraint::Order(_) | Constraint::Departure(_) => member.weight != Time::ZERO,
        Constraint::Upper(_) | Constraint::Link(_) | Constraint::UseOrder(_) => false,
    });
    needs.count()
}

#[test]
fn whoever_adds_up_what_a_failure_names_has_left_out_nothing() {
    let (mut wrong, mut told, mut several) = (Vec::new(), 0, 0);
    for (name, text) in missions(MISSIONS) {
        let (Some(network), _) = compile(&text, &Top::Scenario(None)) else { continue };
        let options =
            Options { search: Search::Chronological, trace_events: Some(20_000), ..Options::default() };
        let outcome = kirk::plan(&network, &options, &mut ExpansionLimit(2_000));
        let Some(trace) = &outcome.trace else { continue };
        for entry in &trace.events {
            let Event::Inconsistent { cycle } = &entry.event else { continue };
            let sentence = wording::event(&network, trace, &entry.event);
            let Some(named) = told_needs(&sentence) else { continue };
            told += 1;
            several += usize::from(sentence.contains("gaps of") || sentence.contains(" times)"));
            if named != needs(&network, cycle) {
                wrong.push(format!("{name}: {sentence} ({} need time)", needs(&network, cycle)));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(told > 1_000 && several > 100, "{told} failures, {several} with several of one name");
}

/// Returns what a sentence says that is not of the mission.
fn strangers<'a>(network: &Network, text: &str, sentence: &'a str) -> Vec<&'a str> {
    // `MODE_A` is another way to write `MODE=A`.
    let own: BTreeSet<&str> = words(text).flat_map(|word| word.split('_').chain([word])).collect();
    let is_decision = |word: &str| {
        let number = word.strip_prefix('D').and_then(|number| number.parse::<usize>().ok());
        number.is_some_and(|number| (1..=network.decisions.len()).contains(&number))
    };
    let is_telling =
        |word: &str| TELLING.iter().any(|(all, has)| all.split(' ').any(|it| it == word) && has(network));
    let is_plain =
        |word: &str| [PLAIN, OF_SEARCH].iter().any(|all| all.split_whitespace().any(|it| it == word));
    words(sentence)
        .filter(|word| !(own.contains(word) || is_plain(word) || is_decision(word) || is_telling(word)))
        .collect()
}

/// Everything that is said of a mission's planning.
fn sentences(network: &Network) -> Vec<String> {
    let mut told = Vec::new();
    for search in [Search::Chronological, Search::ConflictDirected] {
        let options = Options { search, trace_events: Some(20_000), ..Options::default() };
        let outcome = kirk::plan(network, &options, &mut ExpansionLimit(2_000));
        if let Some(failure) = &outcome.failure {
            told.extend(failure.reasons.iter().map(|reason| reason.message.clone()));
            told.extend(failure.reasons.iter().flat_map(|reason| reason.failing_run_in_words(network)));
            told.extend(failure.relaxations.iter().map(|relaxation| relaxation.label.clone()));
        }
        if let Some(trace) = &outcome.trace {
            told.extend(trace.events.iter().map(|entry| wording::event(network, trace, &entry.event)));
            told.extend(trace.tree.iter().map(|state| wording::choice(network, state.choice)));
            for entry in &trace.events {
                if let Event::Inconsistent { cycle } = &entry.event {
                    told.extend(cycle.iter().map(|member| wording::cycle_step(network, member)));
                }
            }
        }
    }
    told
}

/// The choices that a sentence starts with, as `D1=0`, and the rest of it: `if D1 selects Charge() and D2 selects Dig(), …`.
fn choices_of<'a>(network: &Network, sentence: &'a str) -> (Vec<String>, &'a str) {
    let mut told = Vec::new();
    let Some(mut rest) = sentence.strip_prefix("if ") else { return (told, sentence) };
    loop {
        let alternatives = network.decisions.iter().enumerate().flat_map(|(index, decision)| {
            let decision_id = DecisionId::from_index(index);
            (0..decision.alternatives.len() as u32).map(move |alternative| (decision_id, alternative))
        });
        let found = alternatives.filter_map(|(decision, alternative)| {
            let name = Network::decision_name(decision);
            let what = format!("{name} selects {}", network.alternative_name(decision, alternative));
            let readable = network.readable(&what);
            let after =
                [what.as_str(), readable.as_ref()].into_iter().find_map(|what| rest.strip_prefix(what))?;
            let after = after.strip_prefix(" and ").or(after.strip_prefix(", "))?;
            Some((format!("{name}={alternative}"), after))
        });
        // The name of one alternative may begin that of another one.
        let Some((choice, after)) = found.min_by_key(|(_, after)| after.len()) else { return (told, rest) };
        told.push(choice);
        rest = after;
    }
}

/// The words of a text, names in one piece and without the number of their occurrence.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_part = |it: char| it.is_alphanumeric() || it == '_';
    text.split(move |it: char| !is_part(it)).filter(|word| word.chars().any(|it| !it.is_ascii_digit()))
}

#[test]
fn no_explanation_speaks_of_what_the_mission_has_not() {
    let mut strange: Vec<String> = Vec::new();
    let (mut told, mut reasons_without_conditions) = (0, 0);
    for (name, text) in missions(MISSIONS) {
        let (Some(network), _) = compile(&text, &Top::Scenario(None)) else { continue };
        let sentences: BTreeSet<String> = sentences(&network).into_iter().collect();
        told += sentences.len();
        let is_reason = |sentence: &&String| sentence.contains("need");
        if network.labels.is_empty() && network.uses.is_empty() {
            reasons_without_conditions += sentences.iter().filter(is_reason).count();
        }
        for sentence in sentences {
            let (_, rest) = choices_of(&network, &sentence);
            let found = strangers(&network, &text, rest);
            if !found.is_empty() || !adds_up(rest) {
                strange.push(format!("{name}: {sentence} {found:?}"));
            }
        }
    }
    assert!(strange.is_empty(), "{}", strange.join("\n"));
    assert!(told > 10_000, "{told} sentences");
    assert!(reasons_without_conditions > 150, "{reasons_without_conditions} reasons");
}

#[test]
fn why_an_alternative_was_not_taken_rests_on_the_choices_of_the_plan() {
    let mut wrong: Vec<String> = Vec::new();
    let mut reasons = 0;
    for (name, text) in missions(MISSIONS) {
        let snapshot = snapshot(&text);
        let (Some(plan), Some(network)) = (snapshot.plan(), &snapshot.network) else { continue };
        let made: Vec<String> = (plan.choices.iter())
            .map(|it| format!("{}={}", Network::decision_name(it.decision), it.alternative))
            .collect();
        for choice in &review(&snapshot, &Goal::Default, 0, &mut || false).choices {
            for alternative in &choice.alternatives {
                let Fate::Impossible { reason, .. } = &alternative.fate else { continue };
                reasons += 1;
                let itself = format!("{}={}", choice.name, alternative.number);
                let number = |name: &str| name.split('=').next()?.strip_prefix('D')?.parse::<usize>().ok();
                let told: Vec<&str> = reason.split("; ").collect();
                let (rest_on, told): (Vec<_>, Vec<&str>) =
                    told.into_iter().map(|it| choices_of(network, it)).unzip();
                let rest_on: Vec<String> = rest_on.into_iter().flatten().collect();
                let is_given = |it: &String| *it == itself || made.iter().any(|made| made == it);
                let is_later = |it: &String| number(it) > number(&itself);
                // What depends on a later choice is told of each way to make it.
                let is_of_plan = rest_on.iter().all(is_given)
                    || (rest_on.iter().all(|it| is_given(it) || is_later(it)) && told.len() > 1);
                // The order of the program alone never takes time.
                let is_glue =
                    ["order in the mission", "no plan with it exists"].iter().any(|it| reason.contains(it));
                let has_strangers = told.iter().any(|it| !strangers(network, &text, it).is_empty());
                if !is_of_plan || is_glue || has_strangers || !told.iter().all(|it| adds_up(it)) {
                    wrong.push(format!("{name}, {itself} (plan {made:?}): {reason}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(reasons > 200, "{reasons} reasons");
}
