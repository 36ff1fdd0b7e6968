//! `--format json` of every command, with good and bad inputs: one document that keeps the published JSON Schema.

use std::collections::BTreeSet;
use std::process::Output;

use serde_json::Value;

use crate::command::{enroute, file};

/// What holds all documents.
struct Schema {
    root: Value,
    /// The kinds of documents that were seen.
    seen: BTreeSet<String>,
}

impl Schema {
    fn published() -> Self {
        let output = enroute(&["schema"]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        Self { root: serde_json::from_slice(&output.stdout).expect("JSON"), seen: BTreeSet::new() }
    }

    /// Returns what of `value` breaks `schema`, in the keywords of JSON Schema that the published one has: any other
    /// one is a mistake.
    fn errors(&self, schema: &Value, value: &Value, at: &str) -> Vec<String> {
        let wrong = |what: &str| vec![format!("{at}: {what}")];
        let mut errors = Vec::new();
        for (keyword, said) in schema.as_object().expect("a schema") {
            let list = || said.as_array().expect("a list");
            let members = || said.as_object().expect("an object").iter();
            let is_valid = |schema: &Value| self.errors(schema, value, at).is_empty();
            errors.extend(match keyword.as_str() {
                "$ref" => {
                    let name = said.as_str().and_then(|name| name.strip_prefix('#')).expect("a reference");
                    self.errors(self.root.pointer(name).expect("a definition"), value, at)
                }
                "type" => {
                    let kinds = said.as_array().cloned().unwrap_or_else(|| vec![said.clone()]);
                    let is_kind = kinds.iter().any(|kind| is_of(value, kind.as_str().expect("a type")));
                    if is_kind { Vec::new() } else { wrong(&format!("{value} is not of type {said}")) }
                }
                "enum" if !list().contains(value) => wrong(&format!("{value} is none of {said}")),
                "const" if said != value => wrong(&format!("{value} is not {said}")),
                // The one pattern is that of times.
                "pattern" => {
                    let text = value.as_str().unwrap_or("0").trim_start_matches('-');
                    if text.parse::<exact::Bound>().is_ok() { Vec::new() } else { wrong("not a time") }
                }
                "required" => {
                    let lacks = |name: &&Value| {
                        value.is_object() && value.get(name.as_str().expect("a name")).is_none()
                    };
                    list()
                        .iter()
                        .filter(lacks)
                        .flat_map(|name| wrong(&format!("{name} is missing")))
                        .collect()
                }
                "properties" => members()
                    .filter_map(|(name, schema)| Some((name, schema, value.get(name)?)))
                    .flat_map(|(name, schema, member)| self.errors(schema, member, &format!("{at}/{name}")))
                    .collect(),
                "additionalProperties" => value
                    .as_object()
                    .into_iter()
                    .flatten()
                    .flat_map(|(name, member)| self.errors(said, member, &format!("{at}/{name}")))
                    .collect(),
                "items" => value
                    .as_array()
                    .into_iter()
                    .flatten()
                    .flat_map(|item| self.errors(said, item, &format!("{at}/[]")))
                    .collect(),
                "minItems" | "maxItems" => {
                    let (count, limit) =
                        (value.as_array().map_or(0, Vec::len) as u64, said.as_u64().expect("a number"));
                    let is_kept = if keyword == "minItems" { count >= limit } else { count <= limit };
                    if is_kept || !value.is_array() { Vec::new() } else { wrong("a list of another length") }
                }
                "contains" => {
                    let has = value
                        .as_array()
                        .is_some_and(|all| all.iter().any(|item| self.errors(said, item, at).is_empty()));
                    if has { Vec::new() } else { wrong("nothing of the list is as it must be") }
                }
                "allOf" => list().iter().flat_map(|schema| self.errors(schema, value, at)).collect(),
                "anyOf" if list().iter().any(is_valid) => Vec::new(),
                "anyOf" => list().iter().flat_map(|schema| self.errors(schema, value, at)).collect(),
                "if" if is_valid(said) => self.errors(&schema["then"], value, at),
                "$schema" | "$defs" | "title" | "description" | "then" | "enum" | "const" | "if" => {
                    Vec::new()
                }
                other => panic!("the keyword {other} is not known here"),
            });
        }
        errors
    }

    /// Runs a command: its one document, with this exit status.
    fn holds(&mut self, arguments: &[&str], status: i32) -> Value {
        let output = enroute(&[arguments, &["--format", "json"]].concat());
        assert_eq!(output.status.code(), Some(status), "{arguments:?}: {output:?}");
        let document = only_document(&output, arguments);
        let errors = self.errors(&self.root, &document, "");
        assert!(errors.is_empty(), "{arguments:?}: {errors:#?}\n{document}");
        let is_told = document["diagnostics"].as_array().is_some_and(|told| !told.is_empty());
        assert!(is_told || status < 2, "{arguments:?}: nothing says why it was not answered: {document}");
        self.seen.insert(document["format"].as_str().expect("a format").to_owned());
        document
    }

    /// A call that is wrong, in its one document.
    fn refuses(&mut self, arguments: &[&str], code: &str) {
        let document = self.holds(arguments, 2);
        let codes: Vec<&Value> =
            document["diagnostics"].as_array().expect("a list").iter().map(|it| &it["code"]).collect();
        assert!(codes.contains(&&code.into()), "{arguments:?}: {codes:?}");
    }
}

fn is_of(value: &Value, kind: &str) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("{other} is not a type"),
    }
}

fn only_document(output: &Output, arguments: &[&str]) -> Value {
    assert!(output.stderr.is_empty(), "{arguments:?}: {output:?}");
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{arguments:?}: {error}: {output:?}"))
}

const MISSION: &str = "assets/missions/enroute.rmpl";
const PROGRAM: &str = "assets/programs/orbit-insertion.rmpl";
const PLANT: &str = "assets/programs/orbit-plant.rmpl";
const BROKEN: &str = "tests/conformance/e02_bad_bounds.rmpl";

#[test]
fn every_answer_keeps_the_schema() {
    let mut schema = Schema::published();
    let none = &file("schema-none.rmpl", "primitive P()[5,6];\nscenario S[0,2] = { P() }\n");
    let plan = schema.holds(&["plan", MISSION], 0);
    let plan = &file("schema-plan.json", &plan.to_string());
    let observed = &file("schema-observed.json", r#"{"executed":{},"now":0}"#);
    let estimates = &file("schema-estimates.json", r#"{"estimates":[{}]}"#);
    let map = &file("schema.map", "type octile\nheight 2\nwidth 3\nmap\n...\n.@.\n");
    let stn = &file(
        "schema.stn",
        "# KIND OF NETWORK\nSTNU\n# Num Time-Points\n3\n# Num Ordinary Edges\n2\n# Num Contingent Links\n1\n\
         # Names of Time-Points\nZ S E\n# Ordinary Edges\nZ 35 E\nE -30 Z\n# Contingent Links\nS 20 40 E\n",
    );
    let record = &file("schema-record.json", &review::record::Record::new("enroute").to_json());
    let table = &file("schema.csv", "");
    let places = &file("schema.geojson", r#"{"type":"Point","coordinates":[1,2]}"#);
    let unformatted = &file("schema-unformatted.rmpl", "scenario   S = { delay }\n");
    let network = &file("schema.tpn.json", &schema.holds(&["tpn", MISSION], 0).to_string());
    for (arguments, status) in [
        (&["check", MISSION][..], 0),
        (&["check", MISSION, BROKEN], 2),
        (&["fmt", "--check", unformatted], 1),
        (&["explain"], 0),
        (&["explain", "E-BOUNDS"], 0),
        (&["tpn", network, "--as", "rmpl"], 1),
        (&["plan", none], 1),
        (&["plan", MISSION, "--all", "--limit", "1"], 3),
        (&["verify", MISSION, plan], 0),
        (&["execute", MISSION, "--observe", observed], 0),
        (&["simulate", MISSION], 0),
        (&["simulate", none], 1),
        (&["robustness", MISSION, "--runs", "2"], 0),
        (&["robustness", none], 1),
        (&["path", map, "--from", "0.5,0.5", "--to", "2.5,0.5"], 0),
        (&["path", map, "--from", "0.5,0.5", "--to", "1.5,1.5"], 1),
        (&["path", map, "--from", "0.5,0.5", "--to", "2.5,1.5", "--samples", "1", "--step", "0.1"], 3),
        (&["stn", stn], 1),
        (&["hca", PROGRAM], 0),
        (&["step", PROGRAM, "--estimates", estimates], 0),
        (&["run", PROGRAM, "--model", PLANT], 0),
        (&["run", PROGRAM, "--model", PLANT, "--steps", "1"], 3),
        (&["run", PROGRAM, "--model", PLANT, "--monte-carlo", "3"], 0),
        (&["report", MISSION], 0),
        (&["review", "verify", record], 1),
        (&["review", "verify", record, "--mission", MISSION], 1),
        (&["export", MISSION, "--as", "csv", "-o", table], 0),
        (&["export", none, "--as", "csv"], 1),
        (&["compare", MISSION, MISSION], 0),
        (&["compare", MISSION, none], 1),
        (&["contradict", MISSION, "--schedules", "1", "--runs", "1"], 0),
        (&["contradict", none], 1),
        (&["import", network], 0),
        (&["import", places, "--meters"], 0),
    ] {
        schema.holds(arguments, status);
    }
    let state = &file("schema-state.json", "{}");
    let goal = &file("schema-goal.json", r#"{"EngineA":"Firing"}"#);
    schema.holds(&["prove", PROGRAM, "--model", PLANT, "--chance", "8"], 0);
    schema.holds(&["prove", PROGRAM, "--model", PLANT, "--faults", "2"], 1);
    schema.holds(&["prove", PROGRAM, "--model", PLANT, "--states", "2"], 3);
    schema.holds(&["run", PROGRAM, "--model", PLANT, "--steps", "1"], 3);
    let rules = &file(
        "schema-rules.json",
        r#"{"format":"enroute-rules/1","rules":[{"name":"R","rule":"never Group-Wait"}]}"#,
    );
    schema.holds(&["prove", MISSION, "--rules", rules], 1);
    schema.holds(&["prove", none, "--rules", rules], 1);
    schema.holds(&["reconfigure", PLANT, "--state", state, "--goal", goal], 0);
}

#[test]
fn every_command_answers_what_it_cannot_use() {
    let mut schema = Schema::published();
    let nothing = "no-such-file.rmpl";
    let empty = &file("schema-empty.json", "");
    for arguments in [
        &["check", nothing][..],
        &["fmt", nothing],
        &["explain", "E-NOTHING"],
        &["tpn", nothing],
        &["plan", nothing],
        &["plan", MISSION, "--threat-gap", "soon"],
        &["plan", MISSION, "--rules", empty],
        &["verify", MISSION, empty],
        &["execute", MISSION, "--observe", empty],
        &["simulate", MISSION, "--disturb", empty],
        &["robustness", MISSION, "--uncertainty", empty],
        &["robustness", "--merge", nothing],
        &["path", nothing, "--from", "0,0", "--to", "1,1"],
        &["stn", nothing],
        &["hca", nothing],
        &["step", PROGRAM, "--estimates", empty],
        &["run", MISSION],
        &["prove", MISSION],
        &["prove", MISSION, "--rules", empty],
        &["prove", PROGRAM, "--model", PLANT, "--property", "soon"],
        &["estimate", PLANT, "--prior", empty, "--commands", empty, "--observations", empty],
        &["reconfigure", PLANT, "--state", empty, "--goal", empty],
        &["report", nothing],
        &["report", MISSION, "--robustness", empty],
        &["review", "verify", empty],
        &["export", nothing, "--as", "csv"],
        &["export", MISSION, "--as", "csv", "-o", MISSION],
        &["compare", MISSION, nothing],
        &["contradict", nothing],
        &["import", empty],
    ] {
        schema.refuses(arguments, "E-INPUT");
    }
    let commands: Vec<String> = schema.seen.iter().cloned().collect();
    assert_eq!(commands.len(), 22, "{commands:?}");
    for arguments in [
        &["plan"][..],
        &["plan", MISSION, "--nothing"],
        &["plan", MISSION, "--best", "none"],
        &["nothing"],
        &["robustness", MISSION, "--runs", "0"],
        &["export", MISSION],
    ] {
        schema.refuses(arguments, "E-CALL");
    }
    for arguments in [
        &["check", BROKEN][..],
        &["tpn", BROKEN],
        &["plan", BROKEN],
        &["verify", BROKEN, empty],
        &["execute", BROKEN, "--observe", empty],
        &["simulate", BROKEN],
        &["robustness", BROKEN],
        &["report", BROKEN],
        &["export", BROKEN, "--as", "csv"],
        &["contradict", BROKEN],
        &["compare", BROKEN, MISSION],
    ] {
        let is_read_first = arguments[0] == "verify";
        schema.refuses(arguments, if is_read_first { "E-INPUT" } else { "E-BOUNDS" });
    }
}

#[test]
fn a_time_limit_is_a_document_too() {
    let mut schema = Schema::published();
    let hard = tpn::families::symmetric(50, 20, 1);
    let mission = &file("schema-hard.rmpl", &hard);
    for arguments in [
        &["plan", mission][..],
        &["simulate", mission],
        &["robustness", mission],
        &["report", mission],
        &["export", mission, "--as", "csv"],
        &["contradict", mission],
    ] {
        let document = schema.holds(&[arguments, &["--time-limit", "1e-9"]].concat(), 3);
        let codes: Vec<&Value> =
            document["diagnostics"].as_array().into_iter().flatten().map(|it| &it["code"]).collect();
        assert!(codes.contains(&&"E-TIME".into()), "{arguments:?}: {document}");
    }
}
