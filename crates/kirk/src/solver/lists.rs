//! Many short lists in one place: most keys have none, and few have more than two entries.

use std::marker::PhantomData;

/// By key, a list that entries are added to at its end.
#[derive(Clone, Debug)]
pub(super) struct Lists<K, V> {
    /// The first and the last entry of each key.
    ends: Vec<(u32, u32)>,
    /// Each entry with the one after it.
    entries: Vec<(V, u32)>,
    keys: PhantomData<K>,
}

/// Where there is no entry.
const NONE: u32 = u32::MAX;

impl<K, V> Default for Lists<K, V> {
    fn default() -> Self {
        Self { ends: Vec::new(), entries: Vec::new(), keys: PhantomData }
    }
}

impl<K, V: Copy> Lists<K, V>
where
    usize: From<K>,
{
    /// Gives so many keys an empty list each, unless they have one.
    pub(super) fn resize(&mut self, num_keys: usize) {
        self.ends.resize(num_keys, (NONE, NONE));
    }

    pub(super) fn push(&mut self, key: K, value: V) {
        let new = self.entries.len() as u32;
        self.entries.push((value, NONE));
        let (first, last) = &mut self.ends[usize::from(key)];
        match self.entries.get_mut(*last as usize) {
            Some((_, next)) => *next = new,
            None => *first = new,
        }
        *last = new;
    }

    pub(super) fn last(&self, key: K) -> Option<V> {
        let (_, last) = self.ends[usize::from(key)];
        self.entries.get(last as usize).map(|&(value, _)| value)
    }

    pub(super) fn is_empty(&self, key: K) -> bool {
        self.ends[usize::from(key)].0 == NONE
    }

    pub(super) fn iter(&self, key: K) -> impl Iterator<Item = V> + '_ {
        let (mut at, _) = self.ends[usize::from(key)];
        std::iter::from_fn(move || {
            let &(value, next) = self.entries.get(at as usize)?;
            at = next;
            Some(value)
        })
    }
}
