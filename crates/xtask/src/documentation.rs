//! Documentation that is checked with the libraries that the tests were built with.
//!
//! `cargo doc` reads metadata that only `cargo check` writes, for all dependencies. For examples in documentation cargo calls
//! rustdoc with the libraries that tests use instead. This program replaces rustdoc there, and has it read the
//! documentation of the same crate first, unless the library was not built again since that was found sound.

use std::{
    env,
    ffi::{OsStr, OsString},
    fs,
    path::{Path, PathBuf},
    process::{Command, ExitCode},
    time::SystemTime,
};

use anyhow::{Context as _, Result};
use xtask::process::target_dir;

/// Names rustdoc to this program when cargo runs it in rustdoc's place.
const RUSTDOC: &str = "XTASK_RUSTDOC";

/// Options of rustdoc that are only for examples; each is followed by a value.
const OF_EXAMPLES: [&str; 2] = ["--test-run-directory", "--test-args"];

/// Has cargo run this program in place of rustdoc, which refuses documentation with warnings.
pub(crate) fn by_us(command: &mut Command) -> Result<&mut Command> {
    let rustdoc = env::var_os("RUSTDOC").unwrap_or_else(|| "rustdoc".into());
    let this = env::current_exe().context("this program does not know where it is")?;
    // The build of the tests may have replaced this program. Linux then appends a word to its path; the new program is at that path.
    let this = this.to_string_lossy().trim_end_matches(" (deleted)").to_owned();
    Ok(command.env(RUSTDOC, rustdoc).env("RUSTDOC", this).env("RUSTDOCFLAGS", "-D warnings"))
}

/// Does rustdoc's work, if this program was run in its place.
pub(crate) fn in_place_of_rustdoc() -> Option<ExitCode> {
    let rustdoc = env::var_os(RUSTDOC)?;
    let arguments: Vec<OsString> = env::args_os().skip(1).collect();
    let succeeds = |arguments: &[OsString]| {
        Command::new(&rustdoc).args(arguments).status().is_ok_and(|status| status.success())
    };
    let is_documented = without_examples(&arguments).is_none_or(|mut documenting| {
        let record = Record::of(&documenting);
        documenting.extend(["--out-dir".into(), record.folder.clone().into()]);
        record.is_current(&documenting) || (succeeds(&documenting) && record.write(&documenting).is_ok())
    });
    let succeeded = succeeds(&arguments) && is_documented;
    Some(if succeeded { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Says with which arguments the documentation of a crate was found sound, and when.
struct Record {
    /// Where the crate's documentation is written: in a folder of its own, because rustdoc joins what it finds in a
    /// folder with what it adds.
    folder: PathBuf,
}

impl Record {
    /// The record for the crate that these arguments name.
    fn of(arguments: &[OsString]) -> Self {
        let name = values_of(arguments, "--crate-name").next().unwrap_or(OsStr::new("unnamed"));
        Self { folder: target_dir().join("doc").join(name) }
    }

    fn file(&self) -> PathBuf {
        self.folder.join("checked")
    }

    /// Returns whether the documentation was found sound with these arguments after the crate and its libraries were
    /// built. Cargo builds a library again when any of its sources changes.
    fn is_current(&self, arguments: &[OsString]) -> bool {
        let changed = |path: &Path| fs::metadata(path).and_then(|data| data.modified()).ok();
        let is_older = |library: &OsStr, than: SystemTime| {
            let library = library.to_string_lossy();
            let path = library.split_once('=').map_or(&*library, |(_, path)| path);
            changed(Path::new(path)).is_some_and(|changed| changed < than)
        };
        changed(&self.file()).is_some_and(|checked| {
            fs::read_to_string(self.file()).is_ok_and(|kept| kept == lines_of(arguments))
                && values_of(arguments, "--extern").all(|library| is_older(library, checked))
        })
    }

    fn write(&self, arguments: &[OsString]) -> std::io::Result<()> {
        fs::write(self.file(), lines_of(arguments))
    }
}

/// The values that follow an option of this name.
fn values_of<'a>(arguments: &'a [OsString], name: &str) -> impl Iterator<Item = &'a OsStr> {
    arguments.windows(2).filter(move |pair| pair[0] == name).map(|pair| pair[1].as_os_str())
}

fn lines_of(arguments: &[OsString]) -> String {
    arguments.iter().map(|argument| format!("{}\n", argument.to_string_lossy())).collect()
}

/// Arguments that have rustdoc read the documentation whose examples these arguments run, if they do.
fn without_examples(arguments: &[OsString]) -> Option<Vec<OsString>> {
    let is = |argument: &OsString, name: &str| argument == OsStr::new(name);
    arguments.iter().any(|argument| is(argument, "--test")).then(|| {
        let mut kept = Vec::new();
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            if OF_EXAMPLES.iter().any(|name| is(argument, name)) {
                rest.next();
            } else if !is(argument, "--test") && !is(argument, "--nocapture") {
                kept.push(argument.clone());
            }
        }
        kept
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_only_for_examples_is_left_out() {
        let arguments = |words: &str| words.split(' ').map(OsString::from).collect::<Vec<_>>();
        let asked = arguments("--edition=2024 --test src/lib.rs --test-run-directory here --extern a=b");
        assert_eq!(without_examples(&asked), Some(arguments("--edition=2024 src/lib.rs --extern a=b")));
        assert_eq!(without_examples(&arguments("-vV")), None);
    }

    #[test]
    fn documentation_is_read_again_when_a_library_or_the_arguments_change() {
        let folder = env::temp_dir().join(format!("enroute-documentation-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("temporary files can be written");
        let record = Record { folder: folder.clone() };
        let library = folder.join("liba.rlib");
        let at = |seconds| SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(seconds);
        let build_at = |seconds| {
            let file = fs::File::create(&library).expect("temporary files can be written");
            file.set_modified(at(seconds)).expect("times can be set");
        };
        let arguments: Vec<OsString> =
            vec!["--extern".into(), format!("a={}", library.display()).into(), "src/lib.rs".into()];
        build_at(1);
        assert!(!record.is_current(&arguments), "nothing is recorded");
        record.write(&arguments).expect("temporary files can be written");
        assert!(record.is_current(&arguments));
        assert!(!record.is_current(&arguments[..2]), "other arguments");
        let later = SystemTime::now() + std::time::Duration::from_mins(1);
        build_at(later.duration_since(SystemTime::UNIX_EPOCH).expect("it is after 1970").as_secs());
        assert!(!record.is_current(&arguments), "the library was built again");
        fs::remove_file(&library).expect("it is there");
        assert!(!record.is_current(&arguments), "the library is gone");
        fs::remove_dir_all(&folder).expect("it is there");
    }
}
