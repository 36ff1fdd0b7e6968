//! Names for contents, by which whoever shows an answer knows what is new in it.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

/// Names a content. Contents with equal keys are equal but for the places in the text that they refer to: a key changes
/// when anything else does.
///
/// Keys are counted by the core that made the content, and mean nothing to another core.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ContentKey {
    /// Which core counted, if there were several.
    core: u32,
    /// 0 for nothing.
    number: u64,
}

impl ContentKey {
    /// The same content of the core that was started as the `core`th.
    #[must_use]
    pub const fn of_core(self, core: u32) -> Self {
        if self.number == 0 { self } else { Self { core, number: self.number } }
    }
}

/// Counts the contents of a core.
#[derive(Clone, Debug, Default)]
pub struct Keys(u64);

impl Keys {
    /// The key of a new content.
    pub const fn fresh(&mut self) -> ContentKey {
        self.0 += 1;
        ContentKey { core: 0, number: self.0 }
    }
}

/// A content and its key.
#[derive(Debug)]
pub struct Keyed<T: ?Sized> {
    pub key: ContentKey,
    pub value: Arc<T>,
}

impl<T: ?Sized> Clone for Keyed<T> {
    fn clone(&self) -> Self {
        Self { key: self.key, value: Arc::clone(&self.value) }
    }
}

impl<T: ?Sized + PartialEq> Keyed<T> {
    /// A content that may be the same as an earlier one: then that is kept, with its key.
    pub fn new(value: Arc<T>, earlier: Option<&Self>, keys: &mut Keys) -> Self {
        match earlier.filter(|earlier| Arc::ptr_eq(&earlier.value, &value) || earlier.value == value) {
            Some(earlier) => earlier.clone(),
            None => Self { key: keys.fresh(), value },
        }
    }
}

/// The keys of the parts of a snapshot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PartKeys {
    /// Of what the text says.
    pub program: ContentKey,
    /// Of the network, with the paths in it.
    pub network: ContentKey,
    /// Of what planning found, the recorded search included.
    pub planning: ContentKey,
    /// Of the traverses with their paths.
    pub traverses: ContentKey,
    /// Of where vehicles are over time.
    pub motions: ContentKey,
    /// Of vehicles too near each other.
    pub separation_violations: ContentKey,
}
