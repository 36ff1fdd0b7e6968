//! The files of the open mission, which are edited as one text (`rmpl::files`): adding, naming and removing them.

use rmpl::Span;
use rmpl::files::{self, Files, MARK};
use rmpl::program::ImportDecl;
use smol_str::SmolStr;
use text_editing::{Caret, Document};

use crate::state::editing::Writing;
use crate::state::imports::imports;
use crate::state::networks::network_ending;

/// Something that concerns the files of the open mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileCommand {
    /// Adds an empty file of this name, and imports it in the main text.
    Add(String),
    /// Gives the file at the caret another name, where it is imported, too.
    Rename(String),
    /// Removes the file at the caret, with what imports it.
    Remove,
}

/// The extension of a file whose name has none.
const EXTENSION: &str = ".rmpl";

/// The names of a mission's files, the main text first.
pub(crate) fn names(document: &Document, main_text: SmolStr) -> Vec<SmolStr> {
    let named = |line: &usize| document.heading(*line).map(SmolStr::new);
    std::iter::once(main_text).chain(document.headings().iter().filter_map(named)).collect()
}

/// Returns which file of a mission the caret is in.
pub(crate) fn at_caret(document: &Document) -> usize {
    let line = document.line_at(document.caret().head);
    document.headings().partition_point(|&heading| heading <= line)
}

/// The file that the text shows, which new declarations go to: that of the caret.
pub(crate) fn shown(document: &Document) -> Span {
    let range = document.file_range(document.caret().head);
    Span::new(range.start as u32, range.end as u32)
}

impl Writing<'_> {
    pub(crate) fn apply_to_files(&mut self, command: FileCommand) {
        self.window.dialog = None;
        let done = match command {
            FileCommand::Add(name) => self.add_file(&name, ""),
            FileCommand::Rename(name) => self.rename_file(&name),
            FileCommand::Remove => self.remove_file(),
        };
        if let Err(reason) = done {
            self.window.failed(reason);
        }
        self.window.focus_editor();
    }

    /// Adds a file, and imports it in the main text unless something imports it already.
    pub(crate) fn add_file(&mut self, name: &str, text: &str) -> Result<(), String> {
        let name = self.free_name(name)?;
        let mut whole = self.document.text().to_owned();
        if !self.imports().iter().any(|(file, _)| *file == name) {
            let (at, line) = import_line(&whole, &name);
            whole.insert_str(at, &line);
        }
        let known = files::split(&whole).into_iter().chain([(name.as_str(), text)]);
        self.document.replace_all(&files::joined(known));
        let start = self.document.text().len() - text.len();
        self.document.set_caret(Caret::at(start));
        self.window.scroll_to(Span::new(start as u32, start as u32), true);
        self.window.done(format!("Added {name} to this mission"));
        Ok(())
    }

    /// Adds a file of declarations that another file came to, under that one's name.
    pub(crate) fn take_places(&mut self, of_file: &str, lines: &str) {
        let stem = of_file.rsplit_once('.').map_or(of_file, |(stem, _)| stem);
        let added = if self.language.is_network() || self.language.is_control() {
            Err(format!("Open or create a mission before you import the places of {of_file}"))
        } else {
            self.add_file(&format!("{stem}{EXTENSION}"), lines)
        };
        if let Err(reason) = added {
            self.window.failed(reason);
        }
    }

    fn rename_file(&mut self, name: &str) -> Result<(), String> {
        let (old, heading) = self.file_of_caret()?;
        if name.trim() == old {
            return Ok(());
        }
        let name = self.free_name(name)?;
        let known = Files::of(self.document.text());
        let renamed = |(_, import): (String, ImportDecl)| {
            let importer = &known.at(import.span.start).name;
            (import.file_span, format!("\"{}\"", relative(importer, &name)))
        };
        let mut edits: Vec<(Span, String)> =
            self.imports().into_iter().filter(|(file, _)| *file == old).map(renamed).collect();
        edits.push((heading, name.clone()));
        self.replace_spans(edits);
        Ok(())
    }

    fn remove_file(&mut self) -> Result<(), String> {
        let (old, heading) = self.file_of_caret()?;
        let file = self.document.file_range(heading.end as usize);
        // With the mark of its heading, and the line break in front of it.
        let start = heading.start.saturating_sub(1 + MARK.len_utf8() as u32);
        let mut spans = vec![Span::new(start, file.end as u32)];
        let text = self.document.text();
        let imports = self.imports().into_iter().filter(|(file, _)| *file == old).map(|(_, import)| {
            let rest = text.get(import.span.end as usize..).unwrap_or_default();
            Span::new(import.span.start, import.span.end + u32::from(rest.starts_with('\n')))
        });
        spans.extend(imports.filter(|span| !(start..file.end as u32).contains(&span.start)));
        self.replace_spans(spans.into_iter().map(|span| (span, String::new())).collect());
        self.window.done(format!("Removed {old}. Undo to restore it."));
        Ok(())
    }

    /// The text with all its files, each as a file of its own.
    pub(crate) fn files_to_save(&self) -> Vec<(String, Vec<u8>)> {
        let is_network = self.language.is_network();
        let extension = if is_network { network_ending(self.document.text()) } else { EXTENSION };
        let named = |(index, (name, text)): (usize, (&str, &str))| {
            let name = if index == 0 { format!("{}{extension}", self.mission) } else { name.to_owned() };
            (name, text.as_bytes().to_vec())
        };
        files::split(self.document.text()).into_iter().enumerate().map(named).collect()
    }

    /// The file that is imported under this name, or one like it in a folder, and is not there.
    pub(crate) fn missing_file(&self, name: &str) -> Option<String> {
        let known = Files::of(self.document.text());
        let is_missing = |file: &String| known.named(file).is_none();
        let is_it = |file: &String| file == name || file.ends_with(&format!("/{name}"));
        self.imports().into_iter().map(|(file, _)| file).filter(is_missing).find(is_it)
    }

    /// Each import with the file that it means.
    fn imports(&self) -> Vec<(String, ImportDecl)> {
        self.language.parse().map_or_else(Vec::new, |parse| imports(parse.text(), &parse.program().imports))
    }

    /// The name of the file at the caret, and where its heading has it.
    fn file_of_caret(&self) -> Result<(String, Span), String> {
        let line = self.document.line_at(self.document.caret().head);
        let heading = self.document.file_lines(line).start.checked_sub(1);
        let name = heading.and_then(|heading| Some((heading, self.document.heading(heading)?)));
        let (heading, name) =
            name.ok_or("The main file can't be removed. To rename it, rename the mission.")?;
        let range = self.document.line_range(heading);
        Ok((name.to_owned(), Span::new((range.start + MARK.len_utf8()) as u32, range.end as u32)))
    }

    /// The name as a file's, if a file can have it and none does.
    fn free_name(&self, name: &str) -> Result<String, String> {
        let name = name.trim();
        let name = if name.contains('.') { name.to_owned() } else { format!("{name}{EXTENSION}") };
        if name.starts_with('.') || !files::is_name(&name) {
            return Err(format!("“{name}” is not a valid file name"));
        }
        if names(self.document, self.main_text.clone()).iter().any(|known| *known == name) {
            return Err(format!("This mission already has a file {name}"));
        }
        Ok(name)
    }

    fn replace_spans(&mut self, mut edits: Vec<(Span, String)>) {
        edits.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
        let mut text = self.document.text().to_owned();
        for (span, by) in edits {
            text.replace_range(span.range(), &by);
        }
        self.document.replace_all(&text);
    }
}

/// Returns how the file `importer` names another one.
fn relative(importer: &str, name: &str) -> String {
    let folder = importer.rsplit_once('/').map_or("", |(folder, _)| folder);
    let steps: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    let common = steps.iter().zip(name.split('/')).take_while(|(left, right)| **left == *right).count();
    let rest = name.split('/').skip(common).collect::<Vec<_>>().join("/");
    format!("{}{rest}", "../".repeat(steps.len() - common))
}

/// Returns where a file is imported in the main text, and the line that does it: after its last import, otherwise in
/// front of its first declaration.
fn import_line(text: &str, name: &str) -> (usize, String) {
    let main = files::split(text).first().map_or("", |(_, text)| text);
    let (mut at, mut place) = (0, None);
    let mut begin = None;
    for line in main.split_inclusive('\n') {
        let is_comment = line.trim().is_empty() || line.trim_start().starts_with("//");
        if begin.is_none() && !is_comment {
            begin = Some(at);
        }
        at += line.len();
        if line.trim_start().starts_with("import ") {
            place = Some(at);
        }
    }
    let at = place.or(begin).unwrap_or(main.len());
    let is_at_line_start = at == 0 || main.as_bytes().get(at - 1) == Some(&b'\n');
    let before = if is_at_line_start { "" } else { "\n" };
    let after = if place.is_some() { "" } else { "\n" };
    (at, format!("{before}import \"{name}\";\n{after}"))
}
