//! What a review was made of, as one figure.

use sha2::{Digest as _, Sha256};
use snapshot::Goal;
use snapshot::{MapKey, Snapshot};
use tpn::plan_json::plan_to_json;

/// Changes when the meaning of the hashed bytes does.
const DOMAIN: &[u8] = b"enroute-review/1";

/// The SHA-256 of text, map, goal and seed in hexadecimal: the same everywhere, and another after any edit.
///
/// The map counts by its key: the name, cell size, origin and what was imported under that name. The goal counts where
/// it is not the first scenario, which is what the text itself says.
pub fn content_hash(source: &str, map: Option<&MapKey>, goal: &Goal, seed: u64) -> String {
    let mut hash = Sha256::new();
    // Each part is preceded by its length, so that no two different inputs give the same bytes.
    let mut part = |bytes: &[u8]| {
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    part(DOMAIN);
    part(source.as_bytes());
    if let Some(map) = map {
        part(map.asset.as_bytes());
        part(&map.cell_mm.to_le_bytes());
        part(&map.origin_mm[0].to_le_bytes());
        part(&map.origin_mm[1].to_le_bytes());
        // A map that comes with the program is hashed as in earlier versions, which had a number here.
        match &map.version {
            Some(digest) => part(digest),
            None => part(&[0; 4]),
        }
    }
    match goal {
        Goal::Default | Goal::FirstScenario => {}
        Goal::Scenario(name) => {
            part(b"scenario");
            part(name.as_bytes());
        }
        Goal::Activity { name, lower, upper } => {
            part(b"activity");
            part(name.as_bytes());
            part(format!("{lower} {upper}").as_bytes());
        }
    }
    part(&seed.to_le_bytes());
    in_hexadecimal(hash)
}

/// The SHA-256 of the plan in hexadecimal: its choices, links, orders, windows and figures by name, and how long its
/// ways are, to the millimeter. Empty without a plan. One content has another plan with another search, and may have one
/// in another version of this program.
pub fn plan_hash(snapshot: &Snapshot) -> String {
    let Some((network, plan)) = snapshot.network.as_deref().zip(snapshot.plan()) else {
        return String::new();
    };
    let mut text = plan_to_json(network, plan).to_string();
    for traverse in snapshot.traverses.iter() {
        text.push_str(&format!("\n{:.3}", traverse.length_m));
    }
    sha256(text.as_bytes())
}

/// The SHA-256 of some bytes in hexadecimal.
pub(super) fn sha256(bytes: &[u8]) -> String {
    let mut hash = Sha256::new();
    hash.update(bytes);
    in_hexadecimal(hash)
}

fn in_hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().fold(String::with_capacity(64), |mut text, byte| {
        for half in [byte >> 4, byte & 15] {
            text.push(char::from_digit(u32::from(half), 16).unwrap_or('0'));
        }
        text
    })
}
