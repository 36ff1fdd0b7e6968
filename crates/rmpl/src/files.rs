//! A mission of several files (SPEC 14): its texts as one, and the way back from a place to its file.
//!
//! The texts are joined, that of the first file as it is and each other one after a heading with its name. Places are
//! places of the whole, so that everything below the front end reads one text whatever number of files there is, and a
//! mission of one file is its text. A heading ends whatever the file before it leaves open. Nothing here reads files:
//! who joins them says what their texts are.

use std::collections::BTreeMap;

use crate::call_cycles::call_cycles;
use crate::diagnostic::Diagnostic;
use crate::diagnostics::{recursion, undefined};
use crate::parse::{Parse, parse};
use crate::program::ImportDecl;
use crate::span::{LineColumn, LineIndex, Span};

/// Begins a heading, which goes to the end of its line. A doubled one gives the first file's own name.
pub const MARK: char = '\u{1c}';

/// What joins no text: more files than this, or a longer name, are none that anybody wrote.
const MAX_FILES: usize = 1_000;

/// One file of a mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its name, from the mission's folder on, with `/` between folders; empty if no one said it.
    pub name: String,
    /// Where its text begins in the whole.
    pub start: u32,
    /// Where it ends.
    pub end: u32,
}

/// The files of a joined text, the first one first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Files {
    files: Vec<File>,
}

impl Files {
    /// The files of `text`.
    pub fn of(text: &str) -> Self {
        let mut files = vec![File { name: String::new(), start: 0, end: text.len() as u32 }];
        let mut from = 0;
        while let Some(found) = text.get(from..).and_then(|rest| rest.find(MARK)) {
            let heading = from + found;
            if let Some(before) = files.last_mut().filter(|before| before.end as usize == text.len()) {
                before.end = heading as u32;
            }
            let name_start = heading + 1;
            let rest = text.get(name_start..).unwrap_or("");
            let line = rest.find('\n').map_or(rest, |end| &rest[..end]);
            if let Some(name) = line.strip_prefix(MARK) {
                name.clone_into(&mut files[0].name);
            } else {
                let start = (name_start + line.len() + 1).min(text.len());
                files.push(File { name: line.to_owned(), start: start as u32, end: text.len() as u32 });
            }
            from = name_start + line.len();
        }
        Self { files }
    }

    /// All files, in the order of the mission.
    pub fn all(&self) -> &[File] {
        &self.files
    }

    /// The file that holds a place; the heading of a file counts as its own.
    pub fn at(&self, offset: u32) -> &File {
        let after = self.files.partition_point(|file| file.start <= offset);
        &self.files[after.saturating_sub(1)]
    }

    /// The file of this name.
    pub fn named(&self, name: &str) -> Option<&File> {
        self.files.iter().find(|file| file.name == name)
    }

    /// Returns where a place is in its own file, of the joined text `text` with the lines `lines`.
    pub fn line_column(&self, text: &str, lines: &LineIndex, offset: u32) -> LineColumn {
        let place = lines.line_column(text, offset);
        let start = self.at(offset).start;
        if start == 0 {
            return place;
        }
        let first = lines.line_column(text, start).line;
        LineColumn { line: (place.line + 1).saturating_sub(first).max(1), ..place }
    }
}

/// The mission that begins with `text`, the file `name`: with all files that it imports, and those that they import, of
/// which `read` gives the texts. What `read` does not know stays out, and is reported where it is imported.
///
/// ```
/// let world = |name: &str| (name == "world.rmpl").then(|| "location BASE (0, 0);".to_owned());
/// let text = rmpl::files::join("day.rmpl", "import \"world.rmpl\"; scenario Day = { delay }", world);
/// assert_eq!(rmpl::parse(&text).program().world.locations.len(), 1);
/// ```
pub fn join(name: &str, text: &str, mut read: impl FnMut(&str) -> Option<String>) -> String {
    let mut joined = text.to_owned();
    let mut known = vec![name.to_owned()];
    let own = imports(text);
    let mut open = resolved(name, &own);
    while let Some(file) = open.pop() {
        if known.contains(&file) || known.len() > MAX_FILES || file.contains(['\n', MARK]) {
            continue;
        }
        let Some(text) = read(&file) else { continue };
        open.append(&mut resolved(&file, &imports(&text)));
        append(&mut joined, &file, &text);
        known.push(file);
    }
    if !own.is_empty() {
        joined.push('\n');
        joined.extend([MARK, MARK]);
        joined.push_str(name);
        joined.push('\n');
    }
    joined
}

/// Adds a file to a joined text.
fn append(joined: &mut String, name: &str, text: &str) {
    joined.push('\n');
    joined.push(MARK);
    joined.push_str(name);
    joined.push('\n');
    // What would begin a heading means nothing in a text.
    joined.push_str(&text.replace(MARK, " "));
}

/// A text of these files, name and text, the first one first; whether they import each other or not. [`split`] takes it
/// apart again.
pub fn joined<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> String {
    let mut files = files.into_iter();
    let mut text = files.next().map_or_else(String::new, |(_, text)| text.replace(MARK, " "));
    for (name, own) in files {
        append(&mut text, name, own);
    }
    text
}

/// The files of a text, name and text, the first one first, which has no name. The line break in front of a heading
/// belongs to the heading.
pub fn split(text: &str) -> Vec<(&str, &str)> {
    let mut rest = text.split(MARK);
    let first = rest.next().unwrap_or_default();
    let mut files = vec![("", first)];
    for part in rest {
        if let Some((_, before)) = files.last_mut() {
            *before = before.strip_suffix('\n').unwrap_or(before);
        }
        files.push(part.split_once('\n').unwrap_or((part, "")));
    }
    files
}

/// Returns whether a file of a mission can have this name: one in the mission's folder, or in a folder of it, without a
/// way out.
pub fn is_name(name: &str) -> bool {
    !name.contains(char::is_control) && name.len() <= 255 && resolve("", name).as_deref() == Some(name)
}

/// Returns what a text imports, in textual order.
fn imports(text: &str) -> Vec<ImportDecl> {
    if text.contains("import") { parse(text).program().imports } else { Vec::new() }
}

/// The files that a file imports, the last one first.
fn resolved(name: &str, imports: &[ImportDecl]) -> Vec<String> {
    imports.iter().rev().filter_map(|import| resolve(name, &import.file)).collect()
}

/// The file that `file` is in a text of the file `importer`, whose folder it starts from. `None` if it is outside of the
/// mission's folder, or names none.
pub fn resolve(importer: &str, file: &str) -> Option<String> {
    if file.is_empty() || file.starts_with('/') || file.contains(['\\', ':']) {
        return None;
    }
    let mut parts: Vec<&str> = importer.split('/').collect();
    parts.pop();
    for part in file.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            name => parts.push(name),
        }
    }
    (!parts.is_empty()).then(|| parts.join("/"))
}

/// Returns what is wrong with the imports of a text.
pub(crate) fn check(parse: &Parse, imports: &[(Span, ImportDecl)]) -> Vec<Diagnostic> {
    let files = Files::of(parse.text());
    if imports.is_empty() && files.all().len() == 1 {
        return Vec::new();
    }
    let positions: BTreeMap<&str, usize> =
        files.all().iter().enumerate().map(|(position, file)| (file.name.as_str(), position)).collect();
    let mut found = Vec::new();
    let mut edges: Vec<Vec<(usize, Span)>> = vec![Vec::new(); files.all().len()];
    for (span, import) in imports {
        let importer = files.at(span.start);
        let Some(name) = resolve(&importer.name, &import.file) else {
            found.push(undefined::file_outside(&import.file, *span));
            continue;
        };
        match (positions.get(name.as_str()), positions.get(importer.name.as_str())) {
            (Some(&imported), Some(&importer)) => edges[importer].push((imported, *span)),
            _ => found.push(undefined::file(&name, *span)),
        }
    }
    let (mut is_reached, mut open) = (vec![false; files.all().len()], vec![0]);
    while let Some(file) = open.pop() {
        if !std::mem::replace(&mut is_reached[file], true) {
            open.extend(edges[file].iter().map(|&(imported, _)| imported));
        }
    }
    for (file, _) in files.all().iter().zip(is_reached).filter(|(_, is_reached)| !is_reached) {
        found.push(undefined::file_not_imported(&file.name, Span::new(file.start - 1, file.start)));
    }
    for cycle in call_cycles(&edges) {
        let names: Vec<&str> =
            cycle.members.iter().map(|&member| files.all()[member].name.as_str()).collect();
        found.push(recursion::imports(&names, cycle.closing_call));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_are_joined_and_split_are_the_same_again() {
        let cases: [&[(&str, &str)]; 4] = [
            &[("", "")],
            &[("", "scenario S = { delay }\n"), ("world.rmpl", "location A (0, 0);\n")],
            &[("", ""), ("a.rmpl", ""), ("b/c.rmpl", "\n\n")],
            &[("", "x"), ("a.rmpl", "y")],
        ];
        for files in cases {
            let text = joined(files.iter().copied());
            assert_eq!(split(&text), files, "{text:?}");
            let known: Vec<&str> =
                Files::of(&text).files.iter().map(|file| file.end).zip(files).map(|(_, it)| it.0).collect();
            assert_eq!(known.len(), files.len());
        }
        assert!(is_name("world/rocks.rmpl") && is_name("a b.rmpl"));
        assert!(["", "../a", "/a", "a//b", "a\nb", "a\u{1c}", "./a"].iter().all(|name| !is_name(name)));
    }

    fn mission(files: &[(&str, &str)]) -> String {
        let read =
            |name: &str| files.iter().find(|(known, _)| *known == name).map(|(_, text)| (*text).to_owned());
        join(files[0].0, files[0].1, read)
    }

    fn codes(text: &str) -> Vec<(&'static str, String)> {
        let files = Files::of(text);
        let told = |found: Diagnostic| (found.code.0, files.at(found.span.start).name.clone());
        parse(text).diagnostics().into_iter().map(told).collect()
    }

    #[test]
    fn a_mission_of_one_file_is_its_text() {
        let text = "scenario S[0,60] = { delay }\n";
        assert_eq!(mission(&[("a.rmpl", text)]), text);
        assert_eq!(Files::of(text).all().len(), 1);
    }

    #[test]
    fn imported_declarations_count_and_places_are_those_of_their_files() {
        let text = mission(&[
            ("day.rmpl", "import \"lib/acts.rmpl\";\nscenario S[0,60] = { Drive(); Dig(); Drvie() }"),
            ("lib/acts.rmpl", "import \"more.rmpl\";\nprimitive Drive()[2,3];\nprimitive Dig()[5,4];"),
            ("lib/more.rmpl", "// nothing else\nconst N = 3;"),
        ]);
        let told = codes(&text);
        let expected =
            [("W-UNDEF", "day.rmpl"), ("E-BOUNDS", "lib/acts.rmpl"), ("W-UNUSED", "lib/more.rmpl")];
        assert_eq!(told, expected.map(|(code, file)| (code, file.to_owned())));
        let (files, lines) = (Files::of(&text), LineIndex::new(&text));
        let bounds = text.find("[5,4]").expect("it is there") as u32;
        assert_eq!(files.line_column(&text, &lines, bounds), LineColumn { line: 3, column: 16 });
    }

    #[test]
    fn what_a_file_leaves_open_ends_with_it() {
        let text = mission(&[
            ("a.rmpl", "import \"b.rmpl\"; scenario S[0,60] = { Drive() /* never closed"),
            ("b.rmpl", "primitive Drive()[2,3];"),
        ]);
        let program = parse(&text).program();
        assert_eq!((program.scenarios.len(), program.primitives.len()), (1, 1));
    }

    #[test]
    fn files_that_import_each_other_or_are_not_there_are_mistakes() {
        let circle = mission(&[
            ("a.rmpl", "import \"b.rmpl\"; scenario S[0,60] = { delay }"),
            ("b.rmpl", "import \"a.rmpl\";"),
        ]);
        assert_eq!(codes(&circle), [("E-RECURSION", "b.rmpl".to_owned())]);
        let itself = mission(&[("a.rmpl", "import \"a.rmpl\"; scenario S[0,60] = { delay }")]);
        assert_eq!(codes(&itself), [("E-RECURSION", "a.rmpl".to_owned())]);
        for file in ["b.rmpl", "../b.rmpl", "/b.rmpl", "C:/b.rmpl", ""] {
            let text = mission(&[("a.rmpl", &format!("import \"{file}\"; scenario S[0,60] = {{ delay }}"))]);
            assert_eq!(codes(&text), [("E-UNDEF", "a.rmpl".to_owned())], "{file}");
        }
        // Two ways to one file are not a circle, and the file counts once.
        let twice = mission(&[
            ("a.rmpl", "import \"b.rmpl\"; import \"c.rmpl\"; scenario S[0,60] = { Drive() }"),
            ("b.rmpl", "import \"c.rmpl\";"),
            ("c.rmpl", "primitive Drive()[2,3];"),
        ]);
        assert_eq!(codes(&twice), []);
    }

    #[test]
    fn edits_of_a_joined_text_leave_it_as_a_fresh_one() {
        let before = mission(&[
            ("a.rmpl", "import \"b.rmpl\"; scenario S[0,60] = { Drive() }"),
            ("b.rmpl", "primitive Drive()[2,3];"),
        ]);
        for after in [
            before.replace("[0,60]", "[0,70"),
            before.replace("Drive() }", "Drive() /*"),
            before.replace("[2,3]", "[3,2]"),
        ] {
            let mut edited = parse(&before);
            edited.edit(&crate::Shift::between(&before, &after).edit(&after));
            assert_eq!(edited.diagnostics(), parse(&after).diagnostics(), "{after}");
            assert_eq!(edited.program(), parse(&after).program(), "{after}");
        }
    }
}
