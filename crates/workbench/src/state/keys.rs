//! The keys of people: one's own, which sign, and those whose signatures count here.

use review::keys::{KeyRing, Person, PublicKey, SecretKey};

/// A change of the keys that are kept.
#[derive(Clone, Debug, PartialEq)]
pub enum KeyChange {
    /// Creates a key of one's own under this name.
    Create(String),
    /// Trusts these people; secret keys that come with them become one's own.
    Add(Vec<Person>),
    /// Forgets a key, its secret as well.
    Remove(PublicKey),
}

/// The keys as they are kept.
#[derive(Clone, Debug, Default)]
pub struct KeysState {
    pub(crate) ring: KeyRing,
    /// Why they are not kept beyond this run, if they could not be.
    pub(crate) unkept: Option<String>,
}

impl KeysState {
    /// The keys of this browser, and those that it trusts.
    pub fn ring(&self) -> &KeyRing {
        &self.ring
    }

    /// Returns why they are not kept beyond this run, if they could not be.
    pub fn unkept(&self) -> Option<&str> {
        self.unkept.as_deref()
    }

    /// Returns what signs as the person of this name; `Err` says that nothing does.
    pub(crate) fn secret(&self, name: &str) -> Result<(PublicKey, SecretKey), String> {
        let own = self.ring.own_named(name).and_then(|person| Some((person, person.secret.clone()?)));
        match own {
            Some((person, secret)) => Ok((person.key.clone(), secret)),
            None if name.trim().is_empty() => Err("Create a key first: reviews are signed".to_owned()),
            None => Err(format!("Unknown key “{}”: create it first", name.trim())),
        }
    }

    /// The keys after a change, and what has been done, in words.
    pub(crate) fn changed(
        ring: &KeyRing,
        change: KeyChange,
        bytes: Option<[u8; 32]>,
    ) -> Result<(KeyRing, String), String> {
        let mut ring = ring.clone();
        let words = match change {
            KeyChange::Create(name) => {
                let bytes = bytes.ok_or("This browser offers no secret random numbers")?;
                let person = Person::new(&name, SecretKey::from_bytes(bytes));
                let fingerprint = person.key.fingerprint();
                ring.add(person).map_err(|error| format!("No key created: {error}"))?;
                format!("Key of {} created: {fingerprint}", name.trim())
            }
            KeyChange::Add(people) => {
                let names: Vec<String> = people.iter().map(|person| person.name.clone()).collect();
                for person in people {
                    ring.add(person).map_err(|error| format!("No key added: {error}"))?;
                }
                format!("Trusted: {}", names.join(", "))
            }
            KeyChange::Remove(key) => {
                ring.remove(&key);
                format!("Key {} removed", key.fingerprint())
            }
        };
        Ok((ring, words))
    }
}
