//! `enroute import` of models that are programs elsewhere: JMPL as a plant model, Pamela as a mission or a plant model.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context as _;
use interchange::jmpl::{self, SourceFile};
use interchange::{Translation, pamela};
use serde_json::json;
use snapshot::{Goal, Problem};

use crate::diagnostics::print_problems;
use crate::input::read_text;
use crate::opened::Opened;
use crate::output::{Format, WRONG, YES, any_error, document, exit, print_error, print_json, print_verbatim};

/// A folder is searched for at most this many files.
const MAX_FILES: usize = 2000;

/// Prints a file in Pamela as a mission or a plant model.
pub fn import_pamela(file: &Path, text: &str, format: Format) -> anyhow::Result<ExitCode> {
    let read = pamela::translate(&short_name(file), text).context("cannot read the model")?;
    print(&read, file, format)
}

/// Prints the classes of files in JMPL as a plant model. Folders among `more`, and the folder of `file`, are searched for
/// what the classes need.
pub fn import_jmpl(file: &Path, text: String, more: &[PathBuf], format: Format) -> anyhow::Result<ExitCode> {
    let mut files = vec![SourceFile { name: short_name(file), text }];
    let mut library = Vec::new();
    let mut given = vec![file.to_owned()];
    for path in more.iter().filter(|path| !path.is_dir()) {
        anyhow::ensure!(
            jmpl::is_jmpl(&path.to_string_lossy()),
            "{} is not a file of Livingstone; give .jmpl, .hrn and .ini files, or folders of these",
            path.display()
        );
        files.push(source(path)?);
        given.push(path.clone());
    }
    for end in ["hrn", "ini"] {
        let beside = file.with_extension(end);
        if beside.is_file() && !given.iter().any(|path| path.extension().is_some_and(|known| known == end)) {
            files.push(source(&beside)?);
        }
    }
    let folder = file.parent().filter(|_| file != Path::new("-"));
    let folder = folder.map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    let mut found = Vec::new();
    if let Some(folder) = folder {
        collect(folder, false, &mut found);
    }
    for folder in more.iter().filter(|path| path.is_dir()) {
        collect(folder, true, &mut found);
    }
    for path in found.iter().filter(|path| !given.contains(path)) {
        match source(path) {
            Ok(file) => library.push(file),
            Err(error) => print_error(&format!("not read: {error:#}")),
        }
    }
    let read = jmpl::translate(&files, &library).context("cannot read the model")?;
    print(&read, file, format)
}

fn source(path: &Path) -> anyhow::Result<SourceFile> {
    Ok(SourceFile { name: short_name(path), text: read_text(path)? })
}

/// A file's name without folders.
fn short_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into())
}

/// The files in JMPL of a folder, and of its folders if `is_deep`, in the order of their names.
fn collect(folder: &Path, is_deep: bool, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    for path in paths {
        if found.len() >= MAX_FILES {
            return;
        }
        if path.is_dir() && !path.is_symlink() && is_deep {
            collect(&path, true, found);
        } else if path.extension().is_some_and(|end| end.eq_ignore_ascii_case("jmpl"))
            && path.is_file()
            && !found.contains(&path)
        {
            found.push(path);
        }
    }
}

/// Prints what was read, with the errors that `enroute check` finds in it.
fn print(read: &Translation, file: &Path, format: Format) -> anyhow::Result<ExitCode> {
    let diagnostics = Opened::new(file, read.text.clone(), Goal::Default).compile_all()?.diagnostics;
    let problems = Problem::all(&diagnostics, &read.text);
    match format {
        Format::Json => {
            let body = json!({ "rmpl": read.text, "remarks": read.remarks, "left_out": read.left_out });
            print_json(&document("rmpl", &problems, body))?;
        }
        Format::Text => {
            print_verbatim(&read.text)?;
            read.left_out.iter().for_each(|what| print_error(&format!("not read: {what}")));
            read.remarks.iter().for_each(|remark| print_error(&format!("note: {remark}")));
            if any_error(&problems) {
                print_error(&format!("error: the model read from {} has errors:", file.display()));
                print_problems(&file.display().to_string(), &read.text, &problems)?;
            }
        }
    }
    Ok(exit(if any_error(&problems) { WRONG } else { YES }))
}
