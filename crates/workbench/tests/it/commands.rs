//! Titles of commands: each starts with a verb, is short, and names one command.

use std::collections::BTreeSet;

use workbench::registry::all_commands;

/// What a title may start with. *New mission* and *About Enroute* are called so everywhere.
const VERBS: &str = "About Acknowledge Add Advance Allow Announce Answer Approve Build Change Choose Close Compare Contradict Convert Copy \
    Create Cut Decrease Delete Draw Duplicate Expand Export Find Focus Fold Follow Force Format Go Group Import Increase Insert Make \
    Maximize Measure Merge Move New Open Paste Pin Place Plan Play Prove Record Redo Remove Rename Reopen Replace Replay Reset Resolve Restart \
    Restore Review Run Save Search Select Send Set Show Solve Stop Switch Take Toggle Tour Trigger Trust Try Undo Unfold Unpin Use Waive Withdraw Wrap Write \
    Zoom";

const MAX_WORDS: usize = 5;

#[test]
fn titles_of_commands_start_with_a_verb_and_are_short() {
    let verbs: BTreeSet<&str> = VERBS.split_whitespace().collect();
    let mut used = BTreeSet::new();
    for spec in all_commands() {
        let words: Vec<&str> = spec.title.split(' ').map(|word| word.trim_end_matches('…')).collect();
        let verb = verbs.get(words[0]);
        assert!(verb.is_some(), "{}: {:?} does not start with a verb", spec.id, spec.title);
        used.extend(verb);
        assert!(words.len() <= MAX_WORDS, "{}: {:?} is too long", spec.id, spec.title);
        assert!(!spec.title.ends_with('.') && !spec.title.contains(" …"), "{}: {:?}", spec.id, spec.title);
    }
    assert_eq!(used, verbs, "no command starts with the others");
}

#[test]
fn no_two_commands_of_the_palette_have_one_title() {
    let mut titles = BTreeSet::new();
    for spec in all_commands().filter(|spec| spec.is_plain()) {
        assert!(titles.insert(spec.title), "two commands are called {:?}", spec.title);
    }
}
