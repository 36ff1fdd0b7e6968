//! Files that others published: how many are read, and why the rest is not. The table of `docs/evidence/public-files.md` is what this
//! test prints.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::command::enroute;

/// The kinds of file by the ends of their names, each with the command that reads it.
const KINDS: [(&str, &[&str], &str); 8] = [
    ("temporal network", &[".stn", ".plainstnu", ".stnu", ".cstn", ".cstnu", ".graphml"], "stn"),
    ("plan network", &[".tpn.json", ".tpn.edn", ".tpn", ".ptpn"], "import"),
    ("map", &[".pgm", ".png", ".tif", ".tiff", ".map", ".asc", ".yaml", ".img"], "path"),
    ("places", &[".geojson"], "import"),
    ("PDDL problem", &[".pddl"], "pddl"),
    ("JMPL", &[".jmpl"], "jmpl"),
    ("Pamela", &[".pamela"], "import"),
    ("mission", &[".rmpl"], "check"),
];

/// How a file was answered: read, with what was left out, or not, with the reason.
type Answer = Result<Vec<String>, String>;

/// The answers of files by their kind.
type Answers = BTreeMap<&'static str, Vec<Answer>>;

fn files_in(folder: &Path, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() { files_in(&path, found) } else { found.push(path) }
    }
}

/// The domain of a problem: `domain-3.pddl` for `instance-3.pddl`, or `domain.pddl`.
fn domain_of(problem: &Path) -> Option<PathBuf> {
    let name = problem.file_name()?.to_str()?;
    let own = problem.with_file_name(name.replace("instance", "domain").replace("problem", "domain"));
    let domains = [own, problem.with_file_name("domain.pddl")];
    domains.into_iter().find(|domain| domain != problem && domain.is_file())
}

fn answer(command: &str, path: &Path) -> Option<Answer> {
    let name = path.to_str()?;
    let domain = domain_of(path);
    let arguments = match (command, &domain) {
        ("path", _) => vec!["path", name, "--from", "0.5,0.5", "--to", "0.5,0.5"],
        ("pddl", Some(domain)) => vec!["import", domain.to_str()?, name],
        ("pddl", None) => return None,
        // Classes of a model are in the folders beside that of its system.
        ("jmpl", _) => vec!["import", name, path.parent()?.parent()?.to_str()?],
        _ => vec![command, name],
    };
    let output = enroute(&arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if output.status.code() != Some(2) {
        let left_out = said.lines().filter_map(|line| line.strip_prefix("not read: "));
        return Some(Ok(left_out.map(without_names).collect()));
    }
    let errors = said.lines().filter(|line| line.starts_with("error"));
    // The first line says that the text that was read has errors, and the second line which.
    let line = errors.take(2).last().unwrap_or("no reason given");
    Some(Err(reason(line, path)))
}

/// An error without what differs from file to file: names of files, actions and lines.
fn reason(line: &str, path: &Path) -> String {
    let file = path.display().to_string();
    let rest = line.trim_start_matches("error: ").replace(&file, "FILE");
    let rest = rest
        .trim_start_matches("cannot read the problem as a mission: ")
        .trim_start_matches("cannot read FILE: ");
    let is_place = |start: &str| {
        start == "FILE" || start.starts_with('(') || start.contains(", line ") || start == "the goal"
    };
    match rest.split_once(": ") {
        Some((start, rest)) if is_place(start) => rest.to_owned(),
        _ => rest.to_owned(),
    }
}

/// Returns what was left out of a file, without the place and without what differs from file to file.
fn without_names(line: &str) -> String {
    let what = line.split_once(": ").map_or(line, |(_, what)| what);
    what.split('`').enumerate().map(|(at, part)| if at % 2 == 0 { part } else { "`…`" }).collect()
}

fn table(answers: &Answers) -> String {
    let mut text =
        String::from("| kind | tried | read | in part | not read, because |\n|---|---|---|---|---|\n");
    for (kind, answers) in answers {
        let reasons = answers.iter().filter_map(|answer| answer.as_ref().err());
        let read = answers.iter().filter(|answer| answer.as_ref().is_ok_and(Vec::is_empty)).count();
        let in_part = answers.iter().filter(|answer| answer.as_ref().is_ok_and(|it| !it.is_empty())).count();
        let told = counted(reasons).replace('|', "\\|");
        text += &format!("| {kind} | {} | {read} | {in_part} | {told} |\n", answers.len());
    }
    for (kind, answers) in answers {
        let left_out = answers.iter().flatten().flatten();
        if answers.iter().flatten().any(|left_out| !left_out.is_empty()) {
            text += &format!("\nLeft out of {kind}: {}\n", counted(left_out));
        }
    }
    text
}

/// Reasons with their counts, the most frequent first.
fn counted<'reason>(all: impl Iterator<Item = &'reason String>) -> String {
    let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
    all.for_each(|reason| *reasons.entry(reason).or_default() += 1);
    let mut reasons: Vec<(usize, &str)> =
        reasons.into_iter().map(|(reason, count)| (count, reason)).collect();
    reasons.sort_by_key(|(count, reason)| (std::cmp::Reverse(*count), *reason));
    let told: Vec<String> = reasons.iter().map(|(count, reason)| format!("{count}: {reason}")).collect();
    told.join("; ")
}

#[test]
#[expect(
    clippy::print_stderr,
    clippy::print_stdout,
    reason = "a table that is asked for, or that there are no files"
)]
fn public_files_are_read_as_the_table_says() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let named = std::env::var_os("ENROUTE_PUBLIC_FILES").map(PathBuf::from);
    let folder = named.clone().unwrap_or_else(|| root.join("../shared/data"));
    if !folder.is_dir() {
        eprintln!("not tried: {} is not there", folder.display());
        return;
    }
    let (mut files, mut answers) = (Vec::new(), Answers::new());
    files_in(&folder, &mut files);
    for path in files {
        let name = path.to_string_lossy().to_lowercase();
        let kind = KINDS.iter().find(|(_, ends, _)| ends.iter().any(|end| name.ends_with(end)));
        let Some((kind, _, command)) = kind else { continue };
        if let Some(answer) = answer(command, &path) {
            answers.entry(kind).or_default().push(answer);
        }
    }
    let table = table(&answers);
    println!("{table}");
    if named.is_none() {
        let page = std::fs::read_to_string(root.join("docs/evidence/public-files.md")).expect("the page");
        assert!(page.contains(&table), "docs/evidence/public-files.md has another table than this:\n{table}");
    }
}
