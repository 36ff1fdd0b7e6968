//! What the files of a mission import.

use rmpl::files::{self, Files, MARK};
use rmpl::program::ImportDecl;
use rmpl::{Edit, Span};
use snapshot::{Problem, TextFix};

/// Each import with the file that it means.
pub(crate) fn imports(text: &str, imports: &[ImportDecl]) -> Vec<(String, ImportDecl)> {
    let known = Files::of(text);
    let meant = |import: &ImportDecl| files::resolve(&known.at(import.span.start).name, &import.file);
    imports.iter().filter_map(|import| Some((meant(import)?, import.clone()))).collect()
}

/// Gives each problem of an import whose file is not there the fix that adds it.
pub(crate) fn offer_files(problems: &mut [Problem], text: &str, declared: &[ImportDecl]) {
    if declared.is_empty() {
        return;
    }
    let known = Files::of(text);
    let end = text.len() as u32;
    for (file, import) in imports(text, declared) {
        if known.named(&file).is_some() || !files::is_name(&file) {
            continue;
        }
        let of_import = problems.iter_mut().filter(|it| it.span == import.file_span && it.fixes.is_empty());
        for problem in of_import {
            let edit = Edit { span: Span::new(end, end), text: format!("\n{MARK}{file}\n") };
            problem.fixes.push(TextFix { label: format!("Add file {file}"), edits: vec![edit] });
        }
    }
}
