//! Whose signatures count: the keys that a call names.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use jiff::Timestamp;
use review::Record;
use review::keys::KeyRing;

use crate::input::read_text;

/// Whose signatures count.
#[derive(clap::Args)]
pub struct Trusted {
    /// Trusted keys, as the page saves them; without keys, nothing is approved.
    #[arg(long = "trust", value_name = "KEYS.json")]
    files: Vec<PathBuf>,
}

impl Trusted {
    /// Returns whether no keys were named.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Checks the signatures of a history, as of now.
    pub fn judge(&self, record: &mut Record) -> anyhow::Result<()> {
        let mut ring = KeyRing::default();
        for file in &self.files {
            let name = || format!("cannot use {}", file.display());
            for person in KeyRing::from_json(&read_text(file)?).with_context(name)?.people() {
                ring.add(person.clone()).with_context(name)?;
            }
        }
        record.judge(&ring.trust(), &Timestamp::now().strftime("%Y-%m-%dT%H:%M:%SZ").to_string());
        Ok(())
    }

    /// Reads the history of a review, and checks it.
    pub fn read(&self, path: &Path) -> anyhow::Result<Record> {
        let record = Record::from_json(&read_text(path)?);
        let mut record = record.with_context(|| format!("cannot use {}", path.display()))?;
        self.judge(&mut record)?;
        Ok(record)
    }
}
