//! What may be depended on: the rules of `deny.toml`, checked without `cargo-deny` and without a network. Known
//! vulnerabilities are not looked up here; `cargo deny check` does that where it is installed.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context as _, Result, bail};
use serde_json::Value;
use spdx::{Expression, ParseMode};

/// The only place that packages come from.
const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// The rules that are read, and the values that they may have. Others would not be checked, so they are refused.
const UNDERSTOOD: [(&str, &str, Option<&str>); 11] = [
    ("graph", "all-features", Some("true")),
    ("licenses", "allow", None),
    ("licenses", "exceptions", None),
    // Licenses are taken as packages state them; their files are not read.
    ("licenses", "confidence-threshold", None),
    ("bans", "multiple-versions", Some("\"allow\"")),
    ("bans", "wildcards", Some("\"deny\"")),
    ("bans", "allow-wildcard-paths", Some("true")),
    ("advisories", "yanked", Some("\"deny\"")),
    // Advisories are not looked up here.
    ("advisories", "unmaintained", Some("\"workspace\"")),
    ("sources", "unknown-registry", Some("\"deny\"")),
    ("sources", "unknown-git", Some("\"deny\"")),
];

/// The rules of a `deny.toml`.
#[derive(Debug)]
pub struct Rules {
    allowed: BTreeSet<String>,
    exceptions: BTreeMap<String, BTreeSet<String>>,
}

impl Rules {
    /// Reads the rules; fails on any that would not be checked.
    pub fn read(text: &str) -> Result<Self> {
        let tables: toml::Table = text.parse().context("deny.toml is not TOML")?;
        for (section, rules) in &tables {
            let rules = rules.as_table().with_context(|| format!("[{section}] is no table"))?;
            for (rule, value) in rules {
                let found = UNDERSTOOD.iter().find(|(of, name, _)| of == section && name == rule);
                match found {
                    None => bail!("deny.toml: the rule {section}.{rule} is checked by nothing here"),
                    Some((_, _, Some(expected))) if value.to_string() != *expected => {
                        bail!("deny.toml: {section}.{rule} = {value} is checked by nothing here")
                    }
                    Some(_) => {}
                }
            }
        }
        let licenses = tables.get("licenses").context("deny.toml has no [licenses]")?;
        let exceptions = licenses.get("exceptions").and_then(toml::Value::as_array);
        let exceptions = exceptions.into_iter().flatten().map(|exception| {
            let name = exception.get("crate").and_then(toml::Value::as_str);
            Ok((name.context("an exception names no crate")?.to_owned(), texts(exception.get("allow"))))
        });
        Ok(Self { allowed: texts(licenses.get("allow")), exceptions: exceptions.collect::<Result<_>>()? })
    }

    /// Returns what is wrong with the packages of `cargo metadata`, a line each.
    pub fn check(&self, metadata: &Value) -> Vec<String> {
        let packages = metadata["packages"].as_array().into_iter().flatten();
        packages.flat_map(|package| self.check_package(package)).collect()
    }

    fn check_package(&self, package: &Value) -> Vec<String> {
        let mut wrong = Vec::new();
        let name = package["name"].as_str().unwrap_or_default();
        match package["source"].as_str() {
            None => {
                // Ours: every version of what it depends on is said, except for what lies beside it.
                for dependency in package["dependencies"].as_array().into_iter().flatten() {
                    if dependency["req"] == "*" && dependency["path"].is_null() {
                        wrong.push(format!("{name} takes any version of {}", dependency["name"]));
                    }
                }
                return wrong;
            }
            Some(REGISTRY) => {}
            Some(other) => wrong.push(format!("{name} comes from {other}")),
        }
        let Some(license) = package["license"].as_str() else {
            wrong.push(format!("{name} names no license"));
            return wrong;
        };
        let by_exception = self.exceptions.get(name);
        match Expression::parse_mode(license, ParseMode::LAX) {
            Err(problem) => {
                wrong.push(format!("{name} has a license that SPDX does not know: {}", problem.reason));
            }
            Ok(expression) => {
                let is_met = |allowed: &BTreeSet<String>| {
                    expression.evaluate(|requirement| allowed.contains(&requirement.to_string()))
                };
                if !is_met(&self.allowed) && !by_exception.is_some_and(is_met) {
                    wrong.push(format!("{name} has the license {license}"));
                }
            }
        }
        wrong
    }
}

fn texts(list: Option<&toml::Value>) -> BTreeSet<String> {
    let list = list.and_then(toml::Value::as_array).into_iter().flatten();
    list.filter_map(|text| Some(text.as_str()?.to_owned())).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    const TEXT: &str = r#"
        [licenses]
        allow = ["MIT", "Apache-2.0", "Apache-2.0 WITH LLVM-exception"]
        exceptions = [{ crate = "colored", allow = ["MPL-2.0"] }]
        [bans]
        wildcards = "deny"
    "#;

    fn said_of(package: &Value) -> Vec<String> {
        Rules::read(TEXT).expect("rules").check(&json!({ "packages": [package] }))
    }

    #[test]
    fn license_expressions_are_read_as_spdx_says() {
        for (license, is_allowed) in [
            ("MIT", true),
            ("GPL-3.0-only", false),
            ("MIT/Apache-2.0", true),
            ("GPL-2.0-only OR MIT", true),
            ("MIT AND GPL-2.0-only", false),
            ("(MIT OR GPL-2.0-only) AND Apache-2.0", true),
            ("GPL-2.0-only OR (MIT AND ISC)", false),
            ("Apache-2.0 WITH LLVM-exception", true),
            ("no license at all", false),
        ] {
            let package = json!({ "name": "some", "source": REGISTRY, "license": license });
            assert_eq!(said_of(&package).is_empty(), is_allowed, "{license}");
        }
        let named = |name: &str| json!({ "name": name, "source": REGISTRY, "license": "MPL-2.0" });
        assert_eq!(said_of(&named("colored")), Vec::<String>::new());
        assert_eq!(said_of(&named("color")).len(), 1);
        let silent = json!({ "name": "some", "source": REGISTRY, "license": null });
        assert_eq!(said_of(&silent), ["some names no license"]);
    }

    #[test]
    fn packages_come_from_the_registry_and_say_their_versions() {
        let elsewhere = json!({ "name": "some", "source": "git+https://example.org/some", "license": "MIT" });
        assert_eq!(said_of(&elsewhere), ["some comes from git+https://example.org/some"]);
        let ours = json!({ "name": "ours", "source": null, "dependencies": [
            { "name": "beside", "req": "*", "path": "/beside" },
            { "name": "exact", "req": "^1", "path": null },
            { "name": "any", "req": "*", "path": null },
        ]});
        assert_eq!(said_of(&ours), ["ours takes any version of \"any\""]);
    }

    #[test]
    fn rules_that_nothing_here_checks_are_refused() {
        for more in
            ["[bans]\ndeny = [\"openssl\"]", "[licenses]\nunused = 1", "[advisories]\nyanked = \"warn\""]
        {
            assert!(Rules::read(more).is_err(), "{more}");
        }
    }
}
