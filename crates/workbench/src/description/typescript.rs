//! `web/enroute.d.ts`, made from the types that are written.
//!
//! After an intended change, `UPDATE_TYPES=1 cargo test -p workbench --lib typescript` updates it.

use std::collections::BTreeSet;
use std::path::Path;

use ts_rs::{Config, TS};

use super::{execution, lesson, library, program, review, search, terrain};
use crate::host::RefusalCode;

/// What has no type of its own below: the times, and documents that the command line writes too.
const DOCUMENTS: &str = r#"// The page's interface for host pages and tests. Made from the types of the crate `workbench`.

/** A time: a number if it is exact in decimal, otherwise `"p/q"`; `"inf"` is without bound. */
export type Time = number | string;

/** A plan; windows are earliest and latest times by event. */
export interface Plan {
  choices: Record<string, number>;
  /** The primitives that it selects. */
  activities: string[];
  causal_links: { ask: string; tell: string }[];
  conflict_order: [string, string][];
  conflict_order_omitted?: number;
  state_order?: Record<string, string[]>;
  orderings_added: [string, string][];
  windows: Record<string, [Time, Time]>;
  /** Uses of resources that planning put in order; with `resources`. */
  uses_ordered?: [string, string][];
  /** The use of each resource over all schedules, if the mission has any. */
  resources?: Record<string, ResourceLevels>;
  /** The cost and the reward of the plan, if the mission counts them. */
  cost?: Time;
  reward?: Time;
  /** The earliest time of the scenario's end. */
  end?: Time;
  /** Meters driven. */
  length?: number;
  /** Whether no plan is better; only with an objective. */
  optimal?: boolean;
}

/** A reusable resource with the most that is used of it at a time, or a reservoir with its lowest and highest level. */
export type ResourceLevels =
  | { capacity: Time; peak: Time }
  | { least: Time; greatest: Time; low: Time; high: Time };

/** A path between two waypoints. Lengths in meters, durations in mission units. */
export interface Leg {
  to: string;
  path: [number, number][];
  length_m: number;
  /** Beyond the vehicle's rim and margin; null where there is no obstacle. */
  min_clearance_m: number | null;
  max_slope_deg: number;
  duration: [Time, Time];
}

/** A traverse of the plan with its path. */
export interface Traverse {
  activity: string | null;
  vehicles: (string | null)[];
  legs: Leg[];
}
"#;

/// What `web/api.js` and `web/mirror.js` make.
const CALLS: &str = r#"
/** The error that a call throws. */
export interface EnrouteError extends Error {
  readonly name: "EnrouteError";
  readonly code: RefusalCode;
}

/** A widget on the canvas, as assistive technology sees it. Places are in CSS pixels. */
export interface Widget {
  id: string;
  /** Its ARIA role; `"text"` for plain text. */
  role: string;
  label: string;
  value: string | null;
  x: number;
  y: number;
  width: number;
  height: number;
  enabled: boolean;
  checked: string | null;
  selected: string | null;
  expanded: string | null;
}

/** `window.enroute`. Every call but `ready` and `subscribe` throws an {@link EnrouteError} before it is ready. */
export interface Enroute {
  /** Fulfilled when the front end is drawn and can be driven. */
  readonly ready: Promise<void>;
  /** Open an example mission. */
  open(name: string): void;
  /** Replace the whole text, as one undoable edit. */
  setSource(text: string): void;
  /** The current text. */
  source(): string;
  /** Run a command by its name: one of the menus, or one with arguments, which section 4.3 of the contracts lists. */
  dispatch(command: string, args?: object): void;
  /** The state as plain data. */
  state(): State;
  /** Call back with the state after each change, after the frame that shows it. Call the returned function to unsubscribe. */
  subscribe(callback: (state: State) => void): () => void;
  /** The widgets of a role whose name or text contains `label`. */
  widgets(role: string, label?: string): Widget[];
  /** How many frames were drawn. */
  readonly frames: number;
}

declare global {
  interface Window {
    readonly enroute: Enroute;
  }
}
"#;

/// Adds the declaration of a type, with its documentation.
fn declare<T: TS + 'static>(out: &mut String) {
    let documentation = T::docs().unwrap_or_default();
    let declaration = T::decl(&Config::new());
    let (head, members) = declaration.split_once('{').unwrap_or((&declaration, ""));
    out.push_str(&format!("\n{}export {}", on_one_line(&documentation), head.trim_end()));
    if !members.is_empty() {
        out.push_str(" {\n");
        for line in members_by_line(&on_one_line(members)).lines() {
            out.push_str(&format!("  {line}\n"));
        }
        out.push_str("};");
    }
    out.push('\n');
}

/// Comments of one line, without the lines around it.
fn on_one_line(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, comment)) = rest.split_once("/**\n") {
        let (comment, after) = comment.split_once("*/").expect("a comment ends");
        let lines: Vec<&str> =
            comment.lines().map(|line| line.trim().trim_start_matches('*').trim()).collect();
        out.push_str(&format!("{before}/** {} */", lines.join(" ").trim()));
        rest = after;
    }
    out + rest
}

/// The members of an object type, up to its closing brace, each on a line of its own below its comment.
fn members_by_line(members: &str) -> String {
    let (mut out, mut depth, mut is_quoted, mut is_comment) = (String::new(), 0_i32, false, false);
    for (at, letter) in members.char_indices() {
        let rest = &members[at..];
        match letter {
            '/' if rest.starts_with("/**") => is_comment = true,
            '/' if is_comment && members[..at].ends_with('*') => is_comment = false,
            '"' if !is_comment => is_quoted = !is_quoted,
            '{' | '[' | '(' | '<' if !is_comment && !is_quoted => depth += 1,
            '}' | ']' | ')' | '>' if !is_comment && !is_quoted => depth -= 1,
            ',' if !is_comment && !is_quoted && depth == 0 => {
                out.push_str(";\n");
                continue;
            }
            _ => {}
        }
        // The brace of the object itself.
        if depth < 0 {
            break;
        }
        out.push(letter);
    }
    let lines = out.lines().map(str::trim).filter(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join("\n")
}

/// Everything that host pages may rely on.
fn interface() -> String {
    let mut out = DOCUMENTS.to_owned();
    declare::<RefusalCode>(&mut out);
    declare::<super::State>(&mut out);
    declare::<super::Diagnostic>(&mut out);
    declare::<super::Span>(&mut out);
    declare::<super::Caret>(&mut out);
    declare::<super::NetworkSize>(&mut out);
    declare::<super::Verdict>(&mut out);
    declare::<super::Failure>(&mut out);
    declare::<super::Reason>(&mut out);
    declare::<super::Comparison>(&mut out);
    declare::<super::Timings>(&mut out);
    declare::<search::Search>(&mut out);
    declare::<search::SearchComparison>(&mut out);
    declare::<search::SearchFigures>(&mut out);
    declare::<terrain::Vehicle>(&mut out);
    declare::<terrain::Terrain>(&mut out);
    declare::<terrain::PathGrowth>(&mut out);
    declare::<terrain::PathSearch>(&mut out);
    declare::<execution::Execution>(&mut out);
    declare::<execution::Deadline>(&mut out);
    declare::<execution::Robustness>(&mut out);
    declare::<execution::Contradiction>(&mut out);
    declare::<execution::RuleProofs>(&mut out);
    declare::<execution::ProvenRule>(&mut out);
    declare::<execution::TriedItem>(&mut out);
    declare::<execution::Pinned>(&mut out);
    declare::<execution::NatureRun>(&mut out);
    declare::<execution::Act>(&mut out);
    declare::<execution::Waiting>(&mut out);
    declare::<library::Library>(&mut out);
    declare::<library::KeptMission>(&mut out);
    declare::<lesson::Lessons>(&mut out);
    declare::<lesson::OpenLesson>(&mut out);
    declare::<lesson::Question>(&mut out);
    declare::<lesson::PredictionCounts>(&mut out);
    declare::<lesson::LessonMistake>(&mut out);
    declare::<lesson::Manual>(&mut out);
    declare::<review::Review>(&mut out);
    declare::<review::ReviewCounts>(&mut out);
    declare::<review::ReviewItem>(&mut out);
    declare::<review::BoardSeat>(&mut out);
    declare::<review::ReviewComment>(&mut out);
    declare::<review::HistoryEntry>(&mut out);
    declare::<review::ReviewWaiver>(&mut out);
    declare::<review::ReviewPerson>(&mut out);
    declare::<review::SignOff>(&mut out);
    declare::<program::ProgramRun>(&mut out);
    declare::<program::Fired>(&mut out);
    declare::<program::ProgramChance>(&mut out);
    declare::<program::ProgramProof>(&mut out);
    declare::<program::ProgramVerdict>(&mut out);
    declare::<program::PlantState>(&mut out);
    declare::<program::Believed>(&mut out);
    declare::<program::StateProbability>(&mut out);
    declare::<program::Unachievable>(&mut out);
    declare::<program::Chosen>(&mut out);
    declare::<program::Asked>(&mut out);
    out.push_str(CALLS);
    out
}

#[test]
fn the_declarations_of_the_page_are_those_of_its_types() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../web/enroute.d.ts");
    let now = interface();
    if std::env::var_os("UPDATE_TYPES").is_some() {
        std::fs::write(&path, &now).expect("the declarations can be written");
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    let differing = now.lines().zip(kept.lines()).find(|(now, kept)| now != kept);
    assert!(now == kept, "{} differs, first in {differing:?}; see this file's first lines", path.display());
}

#[test]
fn every_type_that_is_named_is_declared_once() {
    let text = interface();
    let declared: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("export type ").or(line.strip_prefix("export interface ")))
        .filter_map(|rest| rest.split(|letter: char| !letter.is_alphanumeric()).next())
        .collect();
    let once: BTreeSet<&str> = declared.iter().copied().collect();
    assert_eq!(once.len(), declared.len(), "{declared:?}");
    // A name that stands where a type does: after a colon, in a list or a union.
    let known = ["Promise", "Record", "Error", "Window", "Array", "EnrouteError", "WebGPU", "WebGL2"];
    let code = text.lines().filter(|line| {
        let line = line.trim_start();
        !line.starts_with("//") && !line.starts_with("/**") && !line.starts_with('*')
    });
    for word in code.flat_map(|line| line.split(|letter: char| !letter.is_alphanumeric() && letter != '_')) {
        let is_type = word.starts_with(|first: char| first.is_ascii_uppercase());
        assert!(!is_type || once.contains(word) || known.contains(&word), "`{word}` is not declared");
    }
}
