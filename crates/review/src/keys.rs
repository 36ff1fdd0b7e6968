//! The people of a board as keys (Ed25519): who signs, and whose signatures count.
//!
//! A person is a public key with a name. The owner of the secret key signs as that person, and the signature counts for all
//! who trust the public key. Secret keys stay in the browser, or in a file that their owner saves.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use data_encoding::HEXLOWER;
use ed25519_dalek::{Signature, Signer as _, SigningKey, VerifyingKey};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::{names, strict};

/// A public key, in 64 hexadecimal digits. What came from elsewhere may be anything; that signs nothing.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PublicKey(String);

impl PublicKey {
    /// Reads a key. `None` if the text is none.
    pub fn read(text: &str) -> Option<Self> {
        let key = Self(text.trim().to_ascii_lowercase());
        key.verifying().is_some().then_some(key)
    }

    /// The key in hexadecimal.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// As much of it as people compare: `ab12 cd34 ef56 7890`.
    pub fn fingerprint(&self) -> String {
        let start = self.0.as_bytes().get(..16).unwrap_or_default();
        let groups = start.chunks(4).map(|group| String::from_utf8_lossy(group).into_owned());
        groups.collect::<Vec<_>>().join(" ")
    }

    /// Returns whether its owner signed this message.
    pub fn verify(&self, message: &[u8], signature: &str) -> bool {
        let signature = HEXLOWER.decode(signature.as_bytes()).ok();
        let signature = signature.and_then(|bytes| Signature::from_slice(&bytes).ok());
        let verify =
            |(key, signature): (VerifyingKey, Signature)| key.verify_strict(message, &signature).is_ok();
        self.verifying().zip(signature).is_some_and(verify)
    }

    fn verifying(&self) -> Option<VerifyingKey> {
        let bytes = HEXLOWER.decode(self.0.as_bytes()).ok()?;
        VerifyingKey::from_bytes(&bytes.try_into().ok()?).ok()
    }
}

/// What signs as a person.
#[derive(Clone, PartialEq, Eq)]
pub struct SecretKey(SigningKey);

impl SecretKey {
    /// The key that 32 secret random bytes are.
    pub fn from_bytes(bytes: [u8; 32]) -> Self {
        Self(SigningKey::from_bytes(&bytes))
    }

    /// The key that its signatures are checked with.
    pub fn public(&self) -> PublicKey {
        PublicKey(HEXLOWER.encode(self.0.verifying_key().as_bytes()))
    }

    /// The signature of a message, in hexadecimal.
    pub fn sign(&self, message: &[u8]) -> String {
        HEXLOWER.encode(&self.0.sign(message).to_bytes())
    }

    fn read(text: &str) -> Option<Self> {
        let bytes = HEXLOWER.decode(text.as_bytes()).ok()?;
        Some(Self::from_bytes(bytes.try_into().ok()?))
    }
}

impl fmt::Debug for SecretKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SecretKey of {:?}", self.public())
    }
}

/// Whose signatures count: keys with the names of their owners.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trust {
    names: BTreeMap<PublicKey, String>,
    /// The keys that sign here.
    own: BTreeSet<PublicKey>,
}

impl Trust {
    /// The name of a key's owner, if the key is trusted.
    pub fn name_of(&self, key: &PublicKey) -> Option<&str> {
        self.names.get(key).map(String::as_str)
    }

    /// Returns whether a key signs here.
    pub fn is_own(&self, key: &PublicKey) -> bool {
        self.own.contains(key)
    }

    /// The trusted key whose owner's name could be taken for this one.
    pub fn alike(&self, name: &str) -> Option<&str> {
        self.names.values().find(|known| names::are_alike(known, name)).map(String::as_str)
    }
}

/// A person of the board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Person {
    pub name: String,
    pub key: PublicKey,
    /// What signs as that person, where it is known: on the person's own machine.
    pub secret: Option<SecretKey>,
}

impl Person {
    /// Someone with a new key.
    pub fn new(name: &str, secret: SecretKey) -> Self {
        Self { name: names::tidy(name), key: secret.public(), secret: Some(secret) }
    }

    fn to_json(&self, with_secret: bool) -> Value {
        let mut value = json!({ "name": self.name, "key": self.key });
        if let Some(secret) = self.secret.as_ref().filter(|_| with_secret) {
            value["secret"] = HEXLOWER.encode(secret.0.as_bytes()).into();
        }
        value
    }
}

/// The people whose signatures count here, one's own keys among them. No two have names that people could confuse.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KeyRing {
    people: Vec<Person>,
}

/// The format of a document of keys.
pub const KEYS_FORMAT: &str = "enroute-keys/1";

/// How the formats of all versions begin.
const FORMATS: &str = "enroute-keys/";

/// Why a key is not taken.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum KeyError {
    /// The name misleads, or is empty.
    #[error("{0}")]
    Name(String),
    /// Someone else has a name that looks like this one.
    #[error(
        "“{name}” can be taken for “{known}”, whose key is trusted: choose a name that can't be confused with it"
    )]
    Alike { name: String, known: String },
    /// The key belongs to someone.
    #[error("the key {fingerprint} is trusted already, as that of “{known}”")]
    Known { fingerprint: String, known: String },
    /// The text is not a document of keys, or a key in it is invalid.
    #[error("this is not a key file: {0}")]
    Damaged(String),
    #[error("a later version of Enroute wrote these keys: {0}")]
    Newer(String),
}

impl KeyRing {
    /// The people, in the order in which they were added.
    pub fn people(&self) -> &[Person] {
        &self.people
    }

    /// The people whose secret keys are here.
    pub fn own(&self) -> impl Iterator<Item = &Person> {
        self.people.iter().filter(|person| person.secret.is_some())
    }

    /// The person of this very name whose secret key is here.
    pub fn own_named(&self, name: &str) -> Option<&Person> {
        let name = names::tidy(name);
        self.own().find(|person| person.name == name)
    }

    /// Whose signatures count.
    pub fn trust(&self) -> Trust {
        let names = self.people.iter().map(|person| (person.key.clone(), person.name.clone()));
        let own = self.people.iter().filter(|person| person.secret.is_some());
        Trust { names: names.collect(), own: own.map(|person| person.key.clone()).collect() }
    }

    /// Trusts a person. A secret key of someone who is trusted already is added.
    pub fn add(&mut self, person: Person) -> Result<(), KeyError> {
        let person = Person { name: names::tidy(&person.name), ..person };
        if let Some(known) = self.people.iter_mut().find(|known| known.key == person.key) {
            if known.name != person.name {
                let fingerprint = person.key.fingerprint();
                return Err(KeyError::Known { fingerprint, known: known.name.clone() });
            }
            known.secret = known.secret.take().or(person.secret);
            return Ok(());
        }
        self.may_be_called(&person.name)?;
        self.people.push(person);
        Ok(())
    }

    /// Whether a new person may have this name.
    pub fn may_be_called(&self, name: &str) -> Result<(), KeyError> {
        if let Some(problem) = names::problem(&names::tidy(name)) {
            return Err(KeyError::Name(problem));
        }
        match self.people.iter().find(|known| names::are_alike(&known.name, name)) {
            Some(known) => Err(KeyError::Alike { name: name.to_owned(), known: known.name.clone() }),
            None => Ok(()),
        }
    }

    /// Forgets a key, its secret as well.
    pub fn remove(&mut self, key: &PublicKey) {
        self.people.retain(|person| person.key != *key);
    }

    /// The document with all keys; secret ones only `with_secrets`.
    pub fn to_json(&self, with_secrets: bool) -> String {
        document(&self.people.iter().map(|person| person.to_json(with_secrets)).collect::<Vec<_>>())
    }

    /// The document with one person's own key.
    pub fn own_to_json(&self, name: &str) -> Option<String> {
        Some(document(&[self.own_named(name)?.to_json(true)]))
    }

    /// Reads a document of keys.
    pub fn from_json(text: &str) -> Result<Self, KeyError> {
        let damaged = |error: serde_json::Error| KeyError::Damaged(error.to_string());
        let mut document = strict::from_str(text).map_err(damaged)?;
        match document["format"].as_str() {
            Some(KEYS_FORMAT) => {}
            Some(newer) if newer.starts_with(FORMATS) => return Err(KeyError::Newer(newer.to_owned())),
            _ => return Err(KeyError::Damaged(format!("its format is not \"{KEYS_FORMAT}\""))),
        }
        let written: Vec<Written> = serde_json::from_value(document["keys"].take()).map_err(damaged)?;
        let mut ring = Self::default();
        for Written { name, key, secret } in written {
            let wrong = |what: &str| KeyError::Damaged(format!("the {what} of “{name}” is not valid"));
            let key = PublicKey::read(&key).ok_or_else(|| wrong("key"))?;
            let secret = match secret {
                None => None,
                Some(text) => Some(SecretKey::read(&text).ok_or_else(|| wrong("secret key"))?),
            };
            if secret.as_ref().is_some_and(|secret| secret.public() != key) {
                return Err(KeyError::Damaged(format!("the two keys of “{name}” do not belong together")));
            }
            ring.add(Person { name, key, secret })?;
        }
        Ok(ring)
    }
}

/// A key as it is written.
#[derive(Deserialize)]
struct Written {
    name: String,
    key: String,
    #[serde(default)]
    secret: Option<String>,
}

fn document(keys: &[Value]) -> String {
    let document = json!({ "format": KEYS_FORMAT, "keys": keys });
    let mut text = serde_json::to_string_pretty(&document).unwrap_or_default();
    text.push('\n');
    text
}
