//! Commands that documents quote exist, with their options: those of `enroute` and of `cargo xtask`.

use std::collections::BTreeMap;
use std::process::Command;
use std::sync::LazyLock;

use regex::Regex;
use xtask::process::root;

/// A command that a document quotes: the line, its program, and what follows it.
#[derive(Debug, PartialEq)]
struct Quoted {
    line: usize,
    program: String,
    arguments: String,
}

/// The commands in blocks of code and in code within sentences. A line that ends with `\` continues on the next one.
fn quoted(markdown: &str) -> Vec<Quoted> {
    static COMMAND: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r"(^|[`\s(])(enroute|cargo xtask) ([a-z][^`]*)").expect("a pattern"));
    static END: LazyLock<Regex> = LazyLock::new(|| Regex::new(r" (#|\||&&|>) |; ").expect("a pattern"));
    let mut found = Vec::new();
    let mut is_code = false;
    let mut continued = String::new();
    for (number, line) in markdown.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
            continue;
        }
        if let Some(start) = line.strip_suffix('\\').filter(|_| is_code) {
            continued.push_str(start);
            continue;
        }
        let line = std::mem::take(&mut continued) + line;
        for command in COMMAND.captures_iter(&line).filter(|it| is_code || &it[1] == "`") {
            let arguments = END.split(&command[3]).next().unwrap_or_default().trim().to_owned();
            found.push(Quoted { line: number + 1, program: command[2].to_owned(), arguments });
        }
    }
    found
}

/// The help texts of `enroute` by command, as its reference quotes them; a test of `cli` holds these against the program.
fn help_of_enroute() -> BTreeMap<String, String> {
    let reference = std::fs::read_to_string(root().join("docs/command-line.md")).expect("the reference");
    let mut found = BTreeMap::new();
    let mut command = String::new();
    // The reference lists commands by their first names.
    found.insert("convert".to_owned(), String::new());
    for line in reference.lines() {
        match line.trim_start_matches('#').strip_prefix(" enroute ") {
            Some(name) if line.starts_with('#') => name.clone_into(&mut command),
            _ if command.is_empty() => {}
            _ => *found.entry(command.clone()).or_insert_with(String::new) += &format!("{line}\n"),
        }
    }
    found
}

/// The help texts of `cargo xtask` by command.
fn help_of_xtask() -> BTreeMap<String, String> {
    let help = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_xtask")).args(arguments).output().expect("xtask runs");
        String::from_utf8(output.stdout).expect("UTF-8")
    };
    let all = help(&["--help"]);
    let (_, listed) = all.split_once("Commands:\n").expect("a list of commands");
    let names = listed.lines().take_while(|line| !line.is_empty());
    let names = names.filter_map(|line| line.split_whitespace().next());
    names.map(|name| (name.to_owned(), help(&[name, "--help"]))).collect()
}

/// Returns what is wrong with a command, by the help texts of its program.
fn problem(arguments: &str, helps: &BTreeMap<String, String>) -> Option<String> {
    static OPTION: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r"(?:^|[\s\[(])(--?[a-zA-Z][a-z0-9-]*)").expect("a pattern"));
    let words: Vec<&str> = arguments.split_whitespace().collect();
    let name = words.first().copied().unwrap_or_default();
    let two = words.get(1).map(|second| format!("{name} {second}")).unwrap_or_default();
    let is_group = helps.keys().any(|known| known.starts_with(&format!("{name} ")));
    let of_one = helps.get(name).filter(|_| !is_group || words.len() == 1);
    let Some(help) = helps.get(&two).or(of_one) else { return Some(format!("no command {name} {words:?}")) };
    let has = |option: &str| {
        let word =
            Regex::new(&format!(r"(^|[\s`]){}([\s,`<=]|$)", regex::escape(option))).expect("a pattern");
        help.lines().any(|line| word.is_match(line))
    };
    let options = OPTION.captures_iter(arguments).map(|option| option[1].to_owned());
    let unknown: Vec<String> = options.filter(|option| !has(option)).collect();
    (!unknown.is_empty()).then(|| format!("no option {}", unknown.join(", ")))
}

#[test]
fn commands_are_read_to_their_end() {
    let text = "`enroute plan a.rmpl --all`, enroute runs\n```sh\nx=1 enroute prove a \\\n  -o b   # --not | c\n```\n";
    let found = quoted(text);
    let of = |line, arguments: &str| {
        let (program, arguments) = ("enroute".to_owned(), arguments.to_owned());
        Quoted { line, program, arguments }
    };
    assert_eq!(found, [of(1, "plan a.rmpl --all"), of(4, "prove a   -o b")]);
    let helps = help_of_enroute();
    assert_eq!(problem("plan FILE [--all] [--limit N] -o x", &helps), Some("no option -o".to_owned()));
    assert_eq!(problem("review verify R.json --trust K", &helps), None);
    assert!(problem("review check R.json", &helps).is_some() && problem("replan", &helps).is_some());
}

#[test]
fn every_command_that_a_document_quotes_exists() {
    let helps = [("enroute", help_of_enroute()), ("cargo xtask", help_of_xtask())];
    let (mut count, mut wrong) = (0, Vec::new());
    for (path, text) in crate::citations::texts() {
        let name = path.to_string_lossy().replace('\\', "/");
        if path.extension().is_none_or(|extension| extension != "md") || name == "docs/command-line.md" {
            continue;
        }
        for Quoted { line, program, arguments } in quoted(&text) {
            count += 1;
            let (_, helps) = helps.iter().find(|(known, _)| *known == program).expect("a known program");
            if let Some(problem) = problem(&arguments, helps) {
                wrong.push(format!("{name}:{line}: {program} {arguments}: {problem}"));
            }
        }
    }
    assert!(count > 150, "only {count} commands");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
