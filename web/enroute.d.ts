// The page's interface for host pages and tests. Made from the types of the crate `workbench`.

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

/** The `code` of an error that the page throws: a stable name for programs. */
export type RefusalCode = "not-ready" | "stopped" | "no-graphics" | "unknown-mission" | "unknown-command" | "bad-arguments" | "unavailable";

/** Everything the page shows. All results belong to `shownRevision`, which is `revision` once `status` is not `working`. */
export type State = {
  /** Counts the edits of the text. */
  revision: number;
  /** The last revision for which there is an answer. */
  answeredRevision: number | null;
  /** The revision of what is shown. */
  shownRevision: number | null;
  status: "working" | "broken" | "empty" | "program" | "plan" | "no-plan" | "undecided";
  /** Whether the page shows an answer to an older text. */
  isStale: boolean;
  /** The name of the open mission. */
  mission: string;
  /** The missions that the user has. */
  library: Library;
  workspace: string;
  activePanel: string;
  /** The panels on screen, by name. */
  panels: Array<string>;
  theme: "dark" | "light";
  diagnostics: Array<Diagnostic>;
  /** How many of each the network has; `null` while the text does not compile. */
  tpn: NetworkSize | null;
  plan: Plan | null;
  /** No plan is better than this value in the first undecided goal, if the plan is not known to be optimal. */
  bound: Time | null;
  /** The verdict of the independent checker on the plan. */
  verdict: Verdict | null;
  /** Why there is no plan. */
  failure: Failure | null;
  /** The lessons. */
  lesson: Lessons;
  manual: Manual;
  review: Review;
  /** The comparison of the mission with another one. */
  compare: Comparison | null;
  search: Search;
  /** The run of a control program; `null` for a mission. */
  hca: ProgramRun | null;
  vehicles: Array<Vehicle>;
  traverses: Traverse[] | null;
  /** The time shown, in mission units. */
  time: number;
  endTime: number;
  isPlaying: boolean;
  /** The range of times that is selected on the timeline. */
  timeRange: [number, number] | null;
  pinned: Pinned | null;
  /** The run in the Execute workspace. */
  execution: Execution | null;
  /** The results of Monte Carlo runs; `null` before the first run. */
  robustness: Robustness | null;
  /** The search for counterexamples of the passed items of the review; `null` before the first one. */
  contradiction: Contradiction | null;
  /** Which flight rules hold in every plan; `null` before the first proof. */
  ruleProofs: RuleProofs | null;
  selection: { kind: string; name: string | null; id: unknown } | null;
  caret: Caret;
  canUndo: boolean;
  canRedo: boolean;
  /** The dialog that is open. */
  dialog: string | null;
  terrain: Terrain;
  /** The messages on screen. */
  toasts: Array<string>;
  /** What draws the canvas: WebGPU or WebGL2. */
  renderer: string;
  timings: Timings;
};

/** An error, a warning or a note about a place of the text. */
export type Diagnostic = {
  code: string;
  severity: "error" | "warning" | "note";
  message: string;
  span: Span;
  hint: string | null;
  /** The labels of its quick fixes. */
  fixes: Array<string>;
};

/** A place of the text: `start` and `end` in bytes, `line` and `column` from 1. */
export type Span = {
  start: number;
  end: number;
  line: number;
  column: number;
};

/** Where the cursor is (`head`) and where its selection starts (`anchor`), in bytes. */
export type Caret = {
  anchor: number;
  head: number;
};

/** How large a network is. */
export type NetworkSize = {
  nodes: number;
  arcs: number;
  decisions: number;
  occurrences: number;
};

/** The verdict of the independent checker on a plan. */
export type Verdict = {
  valid: boolean;
  violations: Array<string>;
};

/** Why there is no plan. */
export type Failure = {
  reasons: Array<Reason>;
  /** The labeled intervals that take part. */
  conditions: Array<string>;
  /** What would make a plan possible. */
  relaxations: Array<string>;
};

/** One minimal conflict: the choices that it holds for, and what is wrong then. */
export type Reason = {
  choices: { [key in string]: number };
  kind: string;
  message: string;
};

/** The comparison of the mission with another one. */
export type Comparison = {
  with: string;
  planned: boolean;
};

/** Milliseconds by stage, for the revision shown. */
export type Timings = {
  parse: number;
  compile: number;
  plan: number;
  layout: number;
  total: number;
  /** The app's own code in the last frame. */
  frame: number;
  /** The whole time of the previous frame on the page's thread. */
  frameWithShell: number | null;
  /** The app's code in the frame that first shows the answer to the present text; `null` until then. */
  answerFrame: number | null;
  /** When that frame was ready, on the clock of `performance.now()`; `null` until then. */
  shownAt: number | null;
};

/** The recorded search and its current step. If there is a current step, all panels show it instead of the plan. */
export type Search = {
  /** The current step, from 1; 0 while the panels show the plan. */
  step: number;
  /** How many steps are recorded; 0 if none are. */
  steps: number;
  isPlaying: boolean;
  /** Whether stepping and playing skip steps that only prepare a key step. */
  onlyKeySteps: boolean;
  stepsPerSecond: number;
  /** Where running and playing stop. */
  breakpoints: Record<"decision" | "failure" | "threat" | "solution", boolean>;
  /** The knowledge of the search at the step: its choices, links, orderings and windows in the form of a plan. */
  known: (Plan & { event: string | null; text: string | null; state: number; cycle: string[] }) | null;
  /** Both searches side by side, if they are compared. */
  compare: SearchComparison | null;
};

/** Two searches of one mission side by side. */
export type SearchComparison = {
  /** The one that the panels show, from 0. */
  side: number;
  isLinked: boolean;
  searches: Array<SearchFigures>;
};

/** The amount of work of a search, and its current step. */
export type SearchFigures = {
  search: "chronological" | "conflict-directed";
  status: string;
  step: number;
  steps: number;
  states: number;
  propagations: number;
  backtracks: number;
  deadEnds: number;
  millis: number;
};

/** Where a vehicle is: meters, and radians counter-clockwise from east. */
export type Vehicle = {
  name: string;
  x: number;
  y: number;
  /** The height of the ground there, for a blimp its height over it; `null` off the map. */
  z: number | null;
  heading: number;
  time: number;
};

/** The tool on the terrain, and what the terrain shows. */
export type Terrain = {
  tool: "look" | "measure" | "location" | "circle" | "appear" | "polygon" | "wall" | "vehicle";
  /** The places that the tool has so far, in meters east and north. */
  points: Array<[number, number]>;
  /** Whether the clearance map is shown. */
  clearance: boolean;
  /** How many rays of range sensors are drawn. */
  rays: number;
  /** Whether a video is recorded. */
  recording: boolean;
  growth: PathGrowth | null;
};

/** The search for a path, sample by sample. */
export type PathGrowth = {
  /** The planner whose searches are shown. */
  planner: string;
  leg: number;
  samples: number;
  total: number;
  vertices: number;
  /** The length of the best path so far, in meters. */
  length: number | null;
  /** What the last sample did, in a sentence. */
  sentence: string | null;
  /** What each search has done by now; several of them race. */
  searches: Array<PathSearch>;
};

/** A search for a path up to the current sample. */
export type PathSearch = {
  planner: string;
  samples: number;
  vertices: number;
  /** Straight pieces of ground that were checked for obstacles. */
  checks: number;
  /** The length of the best path so far, in meters. */
  length: number | null;
  /** Whether the core has drawn all samples. */
  complete: boolean;
  /** Why there is no search. */
  refusal: string | null;
};

/** A run of the mission at the time shown. */
export type Execution = {
  status: "under-way" | "finished" | "stopped";
  /** How the whole run ends. */
  ending: "finished" | "stopped";
  /** Whether Enroute is simulating a newer run. */
  isWorking: boolean;
  time: number;
  replans: number;
  underWay: Array<string>;
  holding: Array<string>;
  waitedFor: Array<string>;
  deadline: Deadline | null;
  disturbances: Record<string, unknown>[];
  /** What has happened up to the time shown. */
  log: ({ time: Time; event: string } & Record<string, unknown>)[];
};

/** The next event that must happen, and its latest time. */
export type Deadline = {
  event: string;
  time: Time;
};

/** The results of Monte Carlo runs. */
export type Robustness = {
  runs: number;
  isRunning: boolean;
  probability: number;
  /** The 95% confidence interval. */
  interval: [number, number];
  /** The events that broke plans, the worst first. */
  worst: Array<string>;
};

/** The search for counterexamples of the passed items of the present review. */
export type Contradiction = {
  isRunning: boolean;
  /** How many schedules and runs have been tried, of how many; `null` unless a search is running. */
  progress: [number, number] | null;
  items: Array<TriedItem>;
};

/** Which flight rules hold in every plan of the mission. */
export type RuleProofs = {
  isRunning: boolean;
  /** How many rules have a verdict, of how many; `null` unless a proof is running. */
  progress: [number, number] | null;
  rules: Array<ProvenRule>;
};

/** The result for one rule. */
export type ProvenRule = {
  /** The text of the rule. */
  rule: string;
  verdict: "holds" | "never-applies" | "broken" | "unsure" | "open" | "unreadable" | "no-plan";
  /** The result, in one sentence. */
  outcome: string;
};

/** The search for a counterexample of one item. */
export type TriedItem = {
  /** The item. */
  text: string;
  status: "survived" | "contradicted" | "not-tried";
  /** The result, in one sentence. */
  outcome: string;
};

/** Events pinned to times on the timeline, and the windows that they leave to all events. */
export type Pinned = {
  events: { [key in string]: number };
  windows: Record<string, [Time, Time]>;
  /** The run against the environment, if the environment chooses something in this plan. */
  run: NatureRun | null;
};

/** A run in which the environment's durations are chosen one by one. */
export type NatureRun = {
  /** The present time. */
  now: number;
  /** What happened, in the order of time. */
  acts: Array<Act>;
  /** The durations that the environment is choosing, and when each may still end. */
  underWay: Record<string, [Time, Time]>;
  /** What could happen earlier if the environment ended something earlier. */
  waiting: Array<Waiting>;
  /** What happens next if the environment lets everything last. */
  next: Act | null;
};

/** An act of the executive or of the environment. */
export type Act = {
  time: number;
  /** The events at that instant. */
  events: Array<string>;
  /** The duration that the environment ends there; `null` if the executive acts. */
  nature: string | null;
};

/** An event that waits for the environment. */
export type Waiting = {
  event: string;
  /** The duration whose end it waits for. */
  nature: string;
  /** The time until which it waits at most. */
  until: number;
};

/** The missions that the user has. */
export type Library = {
  /** The id of the open mission; `null` for an original that no one has edited. */
  open: string | null;
  /** The missions without the deleted ones, the last changed one first. */
  missions: Array<KeptMission>;
  /** How many deleted missions can be restored. */
  deleted: number;
  /** How many saved items are unreadable. */
  unreadable: number;
  /** Whether missions are saved beyond the end of this run. */
  keeping: "opening" | "kept" | "until-closed" | "latest-only" | "nothing";
};

/** A mission of the library. */
export type KeptMission = {
  id: string;
  name: string;
  kind: "own" | "example" | "lesson" | "shared" | "file";
  /** In milliseconds since 1970, UTC. */
  created: number;
  /** In milliseconds since 1970, UTC. */
  changed: number;
  /** The names of its texts, the main one first. */
  texts: Array<string>;
  /** The names of its maps. */
  maps: Array<string>;
  /** The names of its versions, the oldest first. */
  versions: Array<string>;
};

/** The lessons; `open` is `null` while the contents of the course are shown. */
export type Lessons = {
  /** The names of the course's lessons, in order. */
  course: Array<string>;
  /** Steps whose questions the user answered correctly: `negative-cycle/2`. */
  learned: Array<string>;
  /** Whether the panels are arranged for the lesson. */
  beside: boolean;
  open: OpenLesson | null;
};

/** The open lesson, at its current step. */
export type OpenLesson = {
  name: string;
  title: string;
  /** From 1. */
  stop: number;
  stops: number;
  stopTitle: string;
  /** Whether Enroute is still calculating what the step shows. */
  isDue: boolean;
  /** The text of the step, without its format. */
  prose: string;
  question: Question | null;
  /** The errors in the lesson's file, by line. */
  errors: Array<LessonMistake>;
};

/** The question of a step. */
export type Question = {
  kind: "choice" | "number" | "word" | "task" | "prediction";
  text: string;
  choices: Array<string>;
  /** The last answer; of a prediction, the last one whose result has been shown. */
  given: string | null;
  /** Whether that answer is right; of a task, whether it is done. */
  isRight: boolean | null;
  /** The predictions at this step, if the step asks for them. */
  predictions: PredictionCounts | null;
};

/** The number of predictions, and of right ones. */
export type PredictionCounts = {
  made: number;
  right: number;
  /** Whether nothing is left to predict. */
  isOver: boolean;
};

/** An error in a lesson. */
export type LessonMistake = {
  /** From 1. */
  line: number;
  message: string;
};

/** The open page of the manual, and its search. */
export type Manual = {
  /** `null` while its contents are shown. */
  page: string | null;
  section: string;
  query: string;
  /** The sections that contain the query: `page#section`. */
  found: Array<string>;
};

/** The review of the mission. */
export type Review = {
  /** The hash of the reviewed text, map and seed; `null` before the first review of this mission. */
  hash: string | null;
  /** The hash of the present text, map and seed. */
  currentHash: string | null;
  /** The hash of the reviewed plan; empty without one. */
  planHash: string | null;
  /** Whether the content, the plan or the search has changed since. */
  stale: boolean;
  running: boolean;
  status: "information" | "passed" | "attention" | "failed" | null;
  counts: ReviewCounts | null;
  /** The flight rules: see section 16 of the specification. */
  rules: { margin: number | string | null; clearance_m: number | null; slope_deg: number | null; reserve: number | string | null; reserves: Record<string, number | string>; success_rate: { wanted: number; least: number } | null; rules: { name: string; rule: string; source: string; waivable: boolean }[]; board: { role: string; approvals: number; people: string[] }[] };
  items: Array<ReviewItem>;
  /** The status of the plan with its board. */
  planStatus: "draft" | "in-review" | "approved" | "approved-with-comments" | "lapsed" | null;
  /** The required approvals, and who has given them. */
  board: Array<BoardSeat>;
  /** What blocks any approval. */
  blockers: Array<string>;
  /** The latest approval that has not been withdrawn. */
  signed: SignOff | null;
  comments: Array<ReviewComment>;
  /** All acts, in order. */
  history: Array<HistoryEntry>;
  /** The digests of the last entries of the history. */
  heads: Array<string>;
  /** Why a saved review of this mission was set aside and is not used, if there is one. */
  aside: string | null;
  /** Why the history is not saved beyond this visit; `null` if it is saved. */
  unkept: string | null;
  /** The waivers that count, oldest first. */
  waivers: Array<ReviewWaiver>;
  /** The people whose signatures count here. */
  people: Array<ReviewPerson>;
};

/** How many items of a review have each status. */
export type ReviewCounts = {
  passed: number;
  attention: number;
  failed: number;
  /** Items without a criterion. */
  information: number;
};

/** An item of a review. */
export type ReviewItem = {
  section: string;
  status: "information" | "passed" | "attention" | "failed";
  text: string;
  /** Its criterion, with the source of the criterion. */
  criterion: string | null;
  /** The line of its place in the text, from 1. */
  line: number | null;
  /** Its subjects, by their names in all output. */
  names: Array<string>;
  /** Who acknowledged it, and the reason. */
  acknowledged: { by: string; text: string } | null;
};

/** A role of the board. */
export type BoardSeat = {
  role: string;
  /** The required number of approvals. */
  wanted: number;
  /** Who has approved the present plan. */
  given: Array<string>;
};

/** A comment. */
export type ReviewComment = {
  /** The argument of `review.resolve`, `review.reopen` and `review.withdraw`. */
  id: string;
  author: string;
  role: string;
  /** An ISO 8601 time in UTC. */
  time: string;
  about: string | null;
  text: string;
  content_hash: string;
  /** Whether it is neither resolved nor withdrawn. */
  open: boolean;
};

/** An entry of the history. */
export type HistoryEntry = {
  /** Its digest. */
  id: string;
  by: string;
  role: string;
  /** An ISO 8601 time in UTC. */
  time: string;
  /** The act, in words. */
  act: string;
  /** The words of the entry. */
  text: string;
  /** The entry that it is about. */
  of: string | null;
  /** The content that it is about. */
  hash: string;
  /** The plan that it is about; empty if none was known. */
  planHash: string;
  /** Whether someone withdrew it. */
  withdrawn: boolean;
  /** The public key that it names, in 64 hexadecimal digits; `null` in histories of earlier versions. */
  key: string | null;
  signature: "valid" | "unknown" | "broken" | "unsigned";
  /** Why it does not count in spite of its signature, or another problem with it. */
  problem: string | null;
  /** Whether it counts. */
  counts: boolean;
  /** Why it has no effect although it counts: it weakens the board, which has not agreed. */
  withoutEffect: string | null;
};

/** A waiver of an item until some day. */
export type ReviewWaiver = {
  /** The entry of the history. */
  id: string;
  /** The text of the item. */
  item: string;
  reason: string;
  by: string;
  /** The day on which it lapses: `2026-01-31`. */
  until: string;
  state: "in-force" | "about-to-lapse" | "lapsed";
};

/** Someone whose signatures count here. */
export type ReviewPerson = {
  name: string;
  /** The public key, in 64 hexadecimal digits. */
  key: string;
  /** Whether that person can sign here. */
  own: boolean;
};

/** An approval of a plan. */
export type SignOff = {
  name: string;
  /** An ISO 8601 time in UTC. */
  time: string;
  role: string;
  /** The content that was approved. */
  hash: string;
  /** Whether the content, the plan or the rules have changed since. */
  stale: boolean;
};

/** A run of a control program at the current step. */
export type ProgramRun = {
  /** The number of steps before this moment. */
  step: number;
  /** The number of all steps of the run. */
  steps: number;
  locations: number;
  /** The labels of the marked locations. */
  marked: Array<string> | null;
  /** The goals that the marked locations assert. */
  goals: Array<string> | null;
  /** The transitions of the step that led here. */
  fired: Array<Fired> | null;
  canStep: boolean;
  isPlaying: boolean;
  trouble: string | null;
  /** How likely the program is to reach its end; `null` before Monte Carlo runs of the present text. */
  chance: ProgramChance | null;
  /** Which properties hold in all runs; `null` before a proof for the present text. */
  proof: ProgramProof | null;
  plant: PlantState | null;
};

/** A transition that was taken. */
export type Fired = {
  from: string;
};

/** How likely a program is to reach its end. */
export type ProgramChance = {
  runs: number;
  isRunning: boolean;
  reached: number;
  probability: number;
  /** The 95% confidence interval of the probability. */
  interval: [number, number];
  meanSteps: number;
};

/** Which properties hold in all runs of a program, or why Enroute can prove none. */
export type ProgramProof = {
  isRunning: boolean;
  states: number;
  trouble: string | null;
  /** Why some states were not explored; `null` if all were. */
  stopped: string | null;
  verdicts: Array<ProgramVerdict>;
};

/** Whether a property holds in all runs. */
export type ProgramVerdict = {
  property: string;
  /** `holds`, `broken`, or `open` if no examined run breaks it but some runs were not examined. */
  verdict: string;
  /** In the run that breaks it, the steps in which a component does not behave nominally, such as `3: EngineA=Failed`. */
  faults: Array<string>;
};

/** The belief about a plant, and its true state; modes and values by component and variable. */
export type PlantState = {
  /** Most likely first, at most 64 of them. */
  belief: Array<Believed>;
  trueState: { [key in string]: string };
  observations: { [key in string]: string } | null;
  commands: { [key in string]: string } | null;
  nextCommands: { [key in string]: string } | null;
  unachievable: Array<Unachievable>;
  /** The choices by rewards that led into the last step. */
  chosen: Array<Chosen>;
  /** The conditions that the program asked for in the last step; empty without the option `entailment`. */
  asked: Array<Asked>;
  /** Whether no state explains the observations, so that the run ends here. */
  isUnexplained: boolean;
  /** Whether more states are possible than the estimator keeps, so that probabilities are known less well. */
  isUncertain: boolean;
  /** Which assumptions the observations contradict. */
  conflicts: Array<string> | null;
};

/** A state that is believed possible. */
export type Believed = {
  state: { [key in string]: string };
  probability: StateProbability;
};

/** How likely a state is. */
export type StateProbability = string | [string, string];

/** A goal that cannot be reached. */
export type Unachievable = {
  goal: string;
  reason: string;
};

/** A choice by rewards. */
export type Chosen = {
  choice: string;
  /** Which alternative was chosen, from 1. */
  alternative: number;
  /** The expected sum of rewards of each alternative, as decimals or fractions. */
  expected: Array<string>;
  /** The number of steps that the sum covers. */
  horizon: number;
  /** Whether the program asks for more steps than the calculation could cover. */
  isShortened: boolean;
};

/** A condition that a program asked for. */
export type Asked = {
  condition: string;
  probability: StateProbability;
  /** Whether its probability reaches the threshold of the program. */
  isKnown: boolean;
};

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
