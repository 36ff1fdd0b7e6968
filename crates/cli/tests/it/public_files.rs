//! Files that others published: how many are read, and why the rest is not. The table of `docs/evidence/public-files.md` is what this
//! test prints.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::command::enroute;

/// The kinds of file by the ends of their names, each with the command that reads it.
const KINDS: [(&str, &[&str], &str); 6] = [
    ("temporal network", &[".stn", ".plainstnu", ".stnu", ".cstn", ".cstnu", ".graphml"], "stn"),
    ("plan network", &[".tpn.json", ".tpn.edn", ".tpn", ".ptpn"], "import"),
    ("map", &[".pgm", ".png", ".tif", ".tiff", ".map", ".asc", ".yaml", ".img"], "path"),
    ("places", &[".geojson"], "import"),
    ("PDDL problem", &[".pddl"], "pddl"),
    ("mission", &[".rmpl"], "check"),
];

/// How a file was answered: read, or not, with the reason.
type Answers = BTreeMap<&'static str, Vec<Result<(), String>>>;

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

fn answer(command: &str, path: &Path) -> Option<Result<(), String>> {
    let name = path.to_str()?;
    let domain = domain_of(path);
    let arguments = match (command, &domain) {
        ("path", _) => vec!["path", name, "--from", "0.5,0.5", "--to", "0.5,0.5"],
        ("pddl", Some(domain)) => vec!["import", domain.to_str()?, name],
        ("pddl", None) => return None,
        _ => vec![command, name],
    };
    let output = enroute(&arguments);
    if output.status.code() != Some(2) {
        return Some(Ok(()));
    }
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = said.lines().find(|line| line.starts_with("error")).unwrap_or("no reason given");
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

fn table(answers: &Answers) -> String {
    let mut text = String::from("| kind | tried | read | not read, because |\n|---|---|---|---|\n");
    for (kind, answers) in answers {
        let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
        for reason in answers.iter().filter_map(|answer| answer.as_ref().err()) {
            *reasons.entry(reason).or_default() += 1;
        }
        let mut reasons: Vec<(usize, &str)> =
            reasons.into_iter().map(|(reason, count)| (count, reason)).collect();
        reasons.sort_by_key(|(count, reason)| (std::cmp::Reverse(*count), *reason));
        let told: Vec<String> = reasons
            .iter()
            .map(|(count, reason)| format!("{count}: {}", reason.replace('|', "\\|")))
            .collect();
        let read = answers.iter().filter(|answer| answer.is_ok()).count();
        text += &format!("| {kind} | {} | {read} | {} |\n", answers.len(), told.join("; "));
    }
    text
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
