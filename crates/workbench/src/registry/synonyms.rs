//! Other words for commands and panels, by which the palette finds them too.

use super::score;

/// Words of other programs and of everyday language, with the commands and the titles of panels that they mean.
const SYNONYMS: &[(&str, &[&str])] = &[
    ("3d", &["Terrain", "terrain.reset"]),
    ("attack", &["review.contradict"]),
    ("autocomplete", &["edit.complete"]),
    ("baseline", &["compare.pin"]),
    ("beautify", &["edit.format"]),
    ("bindings", &["help.keys"]),
    ("camera", &["terrain.follow", "terrain.tour", "terrain.top", "terrain.reset"]),
    ("change order", &["draw.earlier", "draw.later"]),
    ("chart", &["Timeline"]),
    ("check", &["review.run", "Problems"]),
    ("contrast", &["view.theme"]),
    ("counterexample", &["review.contradict", "review.proveRules"]),
    ("course", &["learn.lessons"]),
    ("create", &["draw.add", "file.new"]),
    ("dark mode", &["view.theme"]),
    ("deadline", &["Timeline"]),
    ("diff", &["compare.pin", "compare.approved", "Compare"]),
    ("docs", &["help.manual"]),
    ("documentation", &["help.manual"]),
    ("download", &["file.save", "file.saveAs", "file.report"]),
    ("drive", &["view.execute", "play.toggle"]),
    ("errors", &["Problems", "go.nextProblem"]),
    ("execute", &["view.execute"]),
    ("explain", &["Plan"]),
    ("export", &["file.saveAs", "file.networkSvg", "file.networkPng"]),
    ("faults", &["view.execute"]),
    ("font size", &["view.textLarger", "view.textSmaller", "view.textReset"]),
    ("fullscreen", &["view.maximize"]),
    ("gallery", &["file.missions"]),
    ("gantt", &["Timeline"]),
    ("graph", &["Network"]),
    ("help", &["help.manual", "help.keys"]),
    ("history", &["file.missions", "compare.approved"]),
    ("hotkeys", &["help.keys"]),
    ("image", &["file.networkPng", "file.networkSvg"]),
    ("layout", &["view.resetWorkspace"]),
    ("lessons", &["learn.lessons"]),
    ("library", &["file.missions"]),
    ("light mode", &["view.theme"]),
    ("link", &["file.share"]),
    ("load", &["file.open", "file.missions"]),
    ("map", &["Terrain", "file.importMap", "terrain.reset"]),
    ("minimize", &["view.maximize"]),
    ("monte carlo", &["Robustness"]),
    ("open example", &["file.missions"]),
    ("optimize", &["plan.bestFirst"]),
    ("pdf", &["file.report"]),
    ("picture", &["file.networkPng", "file.networkSvg"]),
    (
        "preferences",
        &["view.settings", "view.theme", "view.textLarger", "view.wordWrap", "view.resetWorkspace"],
    ),
    ("print", &["file.report"]),
    ("prove", &["review.proveRules", "review.contradict"]),
    ("recompute", &["plan.again"]),
    ("replan", &["plan.again"]),
    ("robot", &["terrain.vehicle"]),
    ("rover", &["terrain.vehicle"]),
    ("ruler", &["terrain.measure"]),
    ("run", &["view.execute", "play.toggle"]),
    ("samples", &["file.missions"]),
    ("schedule", &["Timeline"]),
    ("screenshot", &["file.networkPng"]),
    ("settings", &["view.settings", "view.theme", "view.textLarger", "view.wordWrap", "view.resetWorkspace"]),
    ("share", &["file.share"]),
    ("shortcuts", &["help.keys"]),
    ("sign", &["Review"]),
    ("simulate", &["view.execute", "play.toggle", "Execution"]),
    ("site", &["terrain.location"]),
    ("snapshot", &["file.keepVersion"]),
    ("solve", &["plan.again"]),
    ("statistics", &["Robustness"]),
    ("test", &["review.contradict", "Robustness"]),
    ("tpn", &["Network"]),
    ("tutorial", &["learn.lessons", "help.manual"]),
    ("url", &["file.share"]),
    ("validate", &["review.run"]),
    ("verify", &["review.run"]),
    ("versions", &["file.keepVersion", "file.missions"]),
    ("warnings", &["Problems", "go.nextProblem"]),
    ("waypoint", &["terrain.location"]),
    ("zoom out", &["view.fit"]),
];

/// Queries with fewer letters find names only.
const MIN_LETTERS: usize = 3;

/// Returns how well another word for a command or a panel begins with `query`; `None` if none does.
pub(super) fn score_of_synonyms(named: &str, query: &str) -> Option<i32> {
    let wanted = query.trim().to_lowercase();
    if wanted.chars().count() < MIN_LETTERS {
        return None;
    }
    let meant = SYNONYMS.iter().filter(|(word, means)| word.starts_with(&wanted) && means.contains(&named));
    meant.filter_map(|(word, _)| score(word, &wanted)).max().map(|score| score - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PanelKind;
    use crate::registry::{all_commands, matching};

    #[test]
    fn everyday_words_find_commands() {
        let first = |query: &str| matching(query).first().map(|spec| spec.id);
        assert_eq!(first("verify"), Some("review.run"));
        assert_eq!(first("dark"), Some("view.theme"));
        assert!(matching("settings").iter().any(|spec| spec.id == "view.theme"));
        assert!(matching("simulate").iter().any(|spec| spec.id == "view.execute"));
        assert_eq!(first("undo"), Some("edit.undo"), "names come first");
    }

    #[test]
    fn synonyms_mean_what_there_is_in_alphabetical_order() {
        let panels = PanelKind::ALL.iter().map(|panel| panel.title());
        let commands = all_commands().filter(|spec| spec.is_plain()).map(|spec| spec.id);
        let known: Vec<&str> = panels.chain(commands).collect();
        for (word, means) in SYNONYMS {
            assert!(means.iter().all(|named| known.contains(named)), "{word}: {means:?}");
        }
        assert!(SYNONYMS.is_sorted_by_key(|(word, _)| word));
    }
}
