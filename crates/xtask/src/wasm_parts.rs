//! What a wasm module consists of: the code of each crate, the data, and the files that the data holds.
//!
//! The names of functions say which crate they come from, so the module must be one that still has its names.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result};
use memchr::memmem;
use rustc_demangle::demangle;
use wasmparser::{KnownCustom, Name, Operator, Parser, Payload, TypeRef};

use crate::dist::brotli;

/// The crates of Rust's standard library, and those that stand inside it.
const STANDARD: [&str; 8] = [
    "alloc",
    "compiler_builtins",
    "core",
    "dlmalloc",
    "hashbrown",
    "rustc_std_workspace",
    "std",
    "std_detect",
];

/// Folders and endings of the files that a module may hold.
const HELD: [(&str, &[&str]); 3] =
    [("assets", &["md", "rmpl"]), ("docs", &["md"]), ("crates/theme/fonts", &["otf", "ttf"])];

/// A module, taken apart.
#[derive(Debug, Default)]
pub struct Parts {
    /// All of it, in bytes.
    pub bytes: usize,
    /// The code of each crate, without its head.
    pub crates: BTreeMap<String, Vec<u8>>,
    /// The contents of the data segments.
    pub data: Vec<u8>,
    /// The functions, in the module's order.
    pub functions: Vec<Function>,
}

/// A function of a module.
#[derive(Debug)]
pub struct Function {
    /// Its name, as one writes it in Rust.
    pub name: String,
    /// The crate that it is counted to.
    pub of_crate: String,
    /// Its code in bytes.
    pub bytes: usize,
    /// The functions that it calls by name, by their place in [`Parts::functions`].
    pub calls: BTreeSet<usize>,
}

impl Parts {
    /// Takes a module apart. Fails on what is not a wasm module.
    pub fn read(module: &[u8]) -> Result<Self> {
        let mut parts = Self { bytes: module.len(), ..Self::default() };
        let mut names: BTreeMap<u32, String> = BTreeMap::new();
        let mut bodies = Vec::new();
        let mut imported = 0;
        for payload in Parser::new(0).parse_all(module) {
            match payload? {
                Payload::ImportSection(imports) => {
                    for import in imports.into_imports() {
                        imported += u32::from(matches!(import?.ty, TypeRef::Func(_)));
                    }
                }
                Payload::CodeSectionEntry(body) => bodies.push(body),
                Payload::DataSection(segments) => {
                    for segment in segments {
                        parts.data.extend_from_slice(segment?.data);
                    }
                }
                Payload::CustomSection(section) => {
                    if let KnownCustom::Name(sections) = section.as_known() {
                        for section in sections {
                            if let Name::Function(list) = section? {
                                for naming in list {
                                    let naming = naming?;
                                    names.insert(naming.index, format!("{:#}", demangle(naming.name)));
                                }
                            }
                        }
                    }
                }
                _ => {}
            }
        }
        for (body, index) in bodies.iter().zip(imported..) {
            let name = names.remove(&index).unwrap_or_default();
            let of_crate = crate_of(&name).to_owned();
            parts.crates.entry(of_crate.clone()).or_default().extend_from_slice(body.as_bytes());
            let mut calls = BTreeSet::new();
            for operator in body.get_operators_reader()? {
                if let Operator::Call { function_index } = operator?
                    && let Some(called) = function_index.checked_sub(imported)
                {
                    calls.insert(called as usize);
                }
            }
            parts.functions.push(Function { name, of_crate, bytes: body.as_bytes().len(), calls });
        }
        Ok(parts)
    }

    /// The parts, the largest first: the code of each crate by its name, and the data. Each has its bytes and what it is
    /// of a download of `download` bytes. The second figure is an estimate: each part is compressed by itself, and what
    /// that gives is stretched to the download.
    pub fn shares(&self, download: u64) -> Result<Vec<(&str, usize, f64)>> {
        let mut shares = Vec::new();
        let parts =
            self.crates.iter().map(|(name, code)| (name.as_str(), code)).chain([("(data)", &self.data)]);
        for (name, bytes) in parts {
            shares.push((name, bytes.len(), brotli(bytes, ESTIMATE_QUALITY)?.len() as f64));
        }
        let total: f64 = shares.iter().map(|(_, _, compressed)| compressed).sum();
        for (_, _, compressed) in &mut shares {
            *compressed *= download as f64 / total.max(1.0);
        }
        shares.sort_by(|one, other| other.2.total_cmp(&one.2));
        Ok(shares)
    }

    /// The files of the repository that the data holds whole, the largest first, with their bytes.
    pub fn held_files(&self, root: &Path) -> Result<Vec<(PathBuf, usize)>> {
        let mut held = Vec::new();
        for (folder, endings) in HELD {
            for name in crate::dist::files_under(root, Path::new(folder))? {
                if name.extension().and_then(|ending| ending.to_str()).is_some_and(|it| endings.contains(&it))
                {
                    let content = fs::read(root.join(&name)).with_context(|| name.display().to_string())?;
                    if memmem::find(&self.data, &content).is_some() {
                        held.push((name, content.len()));
                    }
                }
            }
        }
        held.sort_by_key(|(_, bytes)| std::cmp::Reverse(*bytes));
        Ok(held)
    }

    /// The functions of a crate, the largest first, each with the functions of other crates that call it by name. What is
    /// called through a pointer has callers that do not show here.
    pub fn functions_of(&self, of_crate: &str) -> Vec<(&Function, Vec<&Function>)> {
        let mut found: Vec<(&Function, Vec<&Function>)> = Vec::new();
        for (place, function) in self.functions.iter().enumerate() {
            if function.of_crate == of_crate {
                let calls = |caller: &&Function| caller.of_crate != of_crate && caller.calls.contains(&place);
                found.push((function, self.functions.iter().filter(calls).collect()));
            }
        }
        found.sort_by_key(|(function, _)| std::cmp::Reverse(function.bytes));
        found
    }
}

/// Good enough to compare parts, and a tenth of the time that the best takes.
const ESTIMATE_QUALITY: i32 = 9;

/// The crate that a function is counted to: the first in its name that is not of the standard library, as code of the
/// standard library is there for those whose types it handles. Where the name has no such crate, `std`.
fn crate_of(name: &str) -> &str {
    let is_letter = |letter: char| letter.is_alphanumeric() || letter == '_';
    let mut rest = name;
    while let Some(from) = rest.find(is_letter) {
        let goes_on = rest[..from].ends_with("::");
        let word_on = &rest[from..];
        let length = word_on.find(|letter| !is_letter(letter)).unwrap_or(word_on.len());
        let (word, after) = word_on.split_at(length);
        // The first word of a path: `a::b` has one, and what follows `<T>::` continues with another one.
        if after.starts_with("::") && !goes_on && !STANDARD.contains(&word) {
            return word;
        }
        // On to what follows the whole path.
        let path = after.find(|letter: char| !is_letter(letter) && letter != ':').unwrap_or(after.len());
        rest = &after[path..];
    }
    "std"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_counted_to_the_crate_that_they_are_there_for() {
        assert_eq!(crate_of("kirk::search::run"), "kirk");
        assert_eq!(crate_of("<kirk::Plan as core::fmt::Debug>::fmt"), "kirk");
        assert_eq!(crate_of("core::ptr::drop_in_place<alloc::vec::Vec<mission::Snapshot>>"), "mission");
        assert_eq!(crate_of("<alloc::vec::Vec<T,A> as core::clone::Clone>::clone"), "std");
        assert_eq!(
            crate_of("<&mut serde_json::de::Deserializer<R> as serde::Deserializer>::x"),
            "serde_json"
        );
        assert_eq!(crate_of("<T as alloc::slice::SpecCloneIntoVec<T,A>>::clone_into::{{closure}}"), "std");
        assert_eq!(crate_of("memcpy"), "std");
        assert_eq!(crate_of(""), "std");
    }

    /// `(module (import "" "f" (func)) (func $kirk::a (call 2)) (func $stn::b) (memory 1) (data (i32.const 0) "…"))`
    /// with a name section, by hand.
    fn module(data: &[u8]) -> Vec<u8> {
        let section = |id: u8, content: &[u8]| [&[id, content.len() as u8][..], content].concat();
        let name = |index: u8, name: &str| [&[index, name.len() as u8][..], name.as_bytes()].concat();
        let names = [vec![2], name(1, "kirk::a"), name(2, "stn::b")].concat();
        let named = [&[4][..], b"name", &[1, names.len() as u8], &names].concat();
        [
            b"\0asm\x01\0\0\0".to_vec(),
            section(1, &[1, 0x60, 0, 0]),
            section(2, &[1, 0, 1, b'f', 0, 0]),
            section(3, &[2, 0, 0]),
            section(5, &[1, 0, 1]),
            section(10, &[2, 4, 0, 0x10, 2, 0x0b, 2, 0, 0x0b]),
            section(11, &[&[1, 0, 0x41, 0, 0x0b, data.len() as u8][..], data].concat()),
            section(0, &named),
        ]
        .concat()
    }

    #[test]
    fn a_module_is_taken_apart_into_the_code_of_crates_and_data() {
        let module = module(b"some data");
        let parts = Parts::read(&module).expect("a module");
        assert_eq!(parts.data, b"some data");
        let sizes: Vec<(&str, usize)> =
            parts.crates.iter().map(|(name, code)| (name.as_str(), code.len())).collect();
        assert_eq!(sizes, [("kirk", 4), ("stn", 2)]);
        let called = parts.functions_of("stn");
        let [(function, callers)] = &called[..] else { panic!("one function: {called:?}") };
        assert_eq!((function.name.as_str(), callers[0].name.as_str()), ("stn::b", "kirk::a"));
        let total: f64 = parts.shares(1000).expect("compressed").iter().map(|(_, _, share)| share).sum();
        assert!((total - 1000.0).abs() < 1e-6, "{total}");
        assert!(Parts::read(b"no module").is_err());
    }
}
