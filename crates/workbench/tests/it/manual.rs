//! The manual has a section on every problem that the sources can make, and the contracts every command with arguments.

use std::collections::BTreeSet;
use std::path::Path;

use workbench::manual::{about_code, page_named};

#[test]
fn every_code_that_a_problem_of_the_page_can_have_has_its_section() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut codes = BTreeSet::from(["E-NOPLAN".to_owned()]);
    // The page reads no files of networks, whose problems the command line alone tells.
    for name in
        ["rmpl", "tpn", "kirk", "hca", "plant", "executive", "motion", "terrain", "mission", "workbench"]
    {
        collect_codes(&crates.join(name).join("src"), &mut codes);
    }
    assert!(codes.len() > 25, "{codes:?}");
    for code in codes {
        let (name, section) = about_code(&code).unwrap_or_else(|| panic!("nothing tells about {code}"));
        let page = page_named(name).expect("a page");
        assert!(page.document.heading(&section).is_some(), "{code}: {name}#{section}");
    }
}

#[test]
fn every_command_with_arguments_stands_in_the_contracts() {
    let contracts = include_str!("../../../../docs/contracts.md");
    let called = workbench::registry::all_commands().filter(|spec| !spec.is_plain());
    let missing: Vec<&str> =
        called.map(|spec| spec.id).filter(|id| !contracts.contains(&format!("`{id}`"))).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// The codes in the sources below a folder, as they are made there.
fn collect_codes(folder: &Path, codes: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        if entry.is_dir() {
            collect_codes(&entry, codes);
        } else if entry.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&entry).expect("a source");
            let found = text.split("Code(\"").skip(1).filter_map(|rest| rest.split('"').next());
            let is_of_problem = |code: &&str| {
                let name = code.strip_prefix("E-").or_else(|| code.strip_prefix("W-"));
                name.is_some_and(|name| name.chars().all(|it| it.is_ascii_uppercase()))
            };
            codes.extend(found.filter(is_of_problem).map(str::to_owned));
        }
    }
}
