//! The manual has a page for every panel and a section on every problem that the sources can make, the contracts have
//! every command with arguments, and menu paths in documents are those of commands.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use test_support::start;
use workbench::PanelKind;
use workbench::command::Command;
use workbench::manual::{about_code, page_named};
use workbench::registry::{Group, all_commands};
use workbench::state::manual::ManualCommand;

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
    let called = all_commands().filter(|spec| !spec.is_plain());
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

#[test]
fn the_question_mark_of_each_panel_opens_its_page() {
    let mut app = start();
    for panel in PanelKind::ALL {
        app.run(Command::Manual(ManualCommand::About(panel)));
        let name = app.json()["manual"]["page"].as_str().unwrap_or_default().to_owned();
        assert_eq!(name, panel.manual(), "{panel:?}");
        assert_eq!(
            page_named(&name).map(|page| page.title.clone()),
            Some(format!("{} panel", panel.title()))
        );
    }
}

/// Menu paths, as documents write them: `**File > Save as…**`.
fn menu_paths(document: &str) -> Vec<(String, String)> {
    let words = document.split_whitespace().collect::<Vec<_>>().join(" ");
    let paths = words.split("**").skip(1).step_by(2).filter_map(|path| path.split_once(" > "));
    paths.map(|(menu, entry)| (menu.to_owned(), entry.to_owned())).collect()
}

#[test]
fn every_menu_path_in_a_document_is_that_of_a_command() {
    let example = "**No menu** in **Edit >\nCut**, and **Help > About**";
    let pair = |menu: &str, entry: &str| (menu.to_owned(), entry.to_owned());
    assert_eq!(menu_paths(example), [pair("Edit", "Cut"), pair("Help", "About")]);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut documents = Vec::new();
    for folder in ["docs", "assets"] {
        collect_documents(&root.join(folder), &mut documents);
    }
    documents.extend(["README.md", "CHANGELOG.md", "CONTRIBUTING.md"].map(|name| root.join(name)));
    let (mut count, mut wrong) = (0, Vec::new());
    for path in documents {
        let text = std::fs::read_to_string(&path).expect("a document");
        for (menu, entry) in menu_paths(&text) {
            // The others are menus of panels.
            let Some(group) = Group::ALL.into_iter().find(|group| group.title() == menu) else { continue };
            count += 1;
            if !all_commands().any(|spec| spec.group == group && spec.title == entry) {
                wrong.push(format!("{}: {menu} > {entry}", path.display()));
            }
        }
    }
    assert!(count > 20, "only {count} menu paths");
    assert!(wrong.is_empty(), "no command is called:\n{}", wrong.join("\n"));
}

/// The Markdown files below a folder.
fn collect_documents(folder: &Path, found: &mut Vec<PathBuf>) {
    for path in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            collect_documents(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
}
