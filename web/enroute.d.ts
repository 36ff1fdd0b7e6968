// The page's interface for host pages and tests. Made from the types of the crate `workbench`.

/** A time: a number where it is exact in decimal, otherwise `"p/q"`; `"inf"` is without bound. */
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
  /** How far each resource is used over all schedules, where the mission has any. */
  resources?: Record<string, ResourceLevels>;
  /** What the plan is worth, where the mission counts anything. */
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

/** Everything the page shows. What was worked out belongs to `shownRevision`, which is `revision` once `status` is not `working`. */
export type State = {
  /** Counts the edits of the text. */
  revision: number;
  /** The revision that was last answered. */
  answeredRevision: number | null;
  /** The revision of what is shown. */
  shownRevision: number | null;
  status: "working" | "broken" | "empty" | "program" | "plan" | "no-plan" | "undecided";
  /** Whether what is shown is of an older text. */
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
  /** What no plan is better than, where the plan is not known to be optimal: in the first goal that is not settled. */
  bound: Time | null;
  /** What the independent checker says of the plan. */
  verdict: Verdict | null;
  /** Why there is no plan. */
  failure: Failure | null;
  /** The lessons. */
  lesson: Lessons;
  manual: Manual;
  review: Review;
  /** What the mission is compared with. */
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
  /** The run that is watched in the Execute workspace. */
  execution: Execution | null;
  /** What many runs with chance came to; `null` until runs were made. */
  robustness: Robustness | null;
  /** How the passed lines of the review were tried; `null` until some were. */
  contradiction: Contradiction | null;
  /** Which flight rules hold in every plan; `null` until some were proven. */
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

/** Something to tell the author about a place of the text. */
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

/** Where the caret is and where its selection began, in bytes. */
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

/** What the independent checker says of a plan. */
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

/** What the mission is compared with. */
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
  /** All that the frame before took on the page's thread. */
  frameWithShell: number | null;
  /** The app's code in the frame that first shows the answer to the present text; `null` until then. */
  answerFrame: number | null;
  /** When that frame was ready, on the clock of `performance.now()`; `null` until then. */
  shownAt: number | null;
};

/** The recorded search and the step that is looked at. While one is, all panels show that step instead of the plan. */
export type Search = {
  /** The step that is shown, from 1; 0 while the plan is shown. */
  step: number;
  /** How many steps are recorded; 0 if none are. */
  steps: number;
  isPlaying: boolean;
  /** Whether stepping and playing pass over what only prepares a key step. */
  onlyKeySteps: boolean;
  stepsPerSecond: number;
  /** Where running and playing stop. */
  breakpoints: Record<"decision" | "failure" | "threat" | "solution", boolean>;
  /** What the search knew at the step: its choices, links, orderings and windows in the form of a plan. */
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

/** How much work a search was, and where it is looked at. */
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

/** What is done on the terrain. */
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

/** The search for a path that is looked at sample by sample. */
export type PathGrowth = {
  /** Whose searches are shown. */
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

/** A search for a path by the sample that is looked at. */
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
  /** Whether a newer run is being worked out. */
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

/** What many runs with chance came to. */
export type Robustness = {
  runs: number;
  isRunning: boolean;
  probability: number;
  /** The 95 % confidence interval. */
  interval: [number, number];
  /** The events that broke plans, the worst first. */
  worst: Array<string>;
};

/** How the passed lines of the present review were tried. */
export type Contradiction = {
  isRunning: boolean;
  /** How many schedules and runs have been tried, and how many are to be; `null` unless some are being tried. */
  progress: [number, number] | null;
  items: Array<TriedItem>;
};

/** Which flight rules hold in every plan of the mission. */
export type RuleProofs = {
  isRunning: boolean;
  /** How many rules are answered, and how many are to be; `null` unless some are being proven. */
  progress: [number, number] | null;
  rules: Array<ProvenRule>;
};

/** What was found of one rule. */
export type ProvenRule = {
  /** What it says. */
  rule: string;
  verdict: "holds" | "never-applies" | "broken" | "unsure" | "open" | "unreadable" | "no-plan";
  /** In one sentence. */
  outcome: string;
};

/** How one line was tried. */
export type TriedItem = {
  /** The line. */
  text: string;
  status: "survived" | "contradicted" | "not-tried";
  /** How it came out, in one sentence. */
  outcome: string;
};

/** Events pinned to times on the timeline, and the windows that they leave to all events. */
export type Pinned = {
  events: { [key in string]: number };
  windows: Record<string, [Time, Time]>;
  /** How the run against the environment stands, if the environment chooses something in this plan. */
  run: NatureRun | null;
};

/** A run in which the environment's durations are chosen one by one. */
export type NatureRun = {
  /** The present. */
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

/** What someone does. */
export type Act = {
  time: number;
  /** What happens at that instant. */
  events: Array<string>;
  /** The duration that the environment ends there; otherwise the executive acts. */
  nature: string | null;
};

/** An event that waits for the environment. */
export type Waiting = {
  event: string;
  /** The duration whose end it waits for. */
  nature: string;
  /** It waits no longer than until then. */
  until: number;
};

/** The missions that the user has. */
export type Library = {
  /** The id of the open mission; `null` for an original that no one has edited. */
  open: string | null;
  /** Those changed last first, without the deleted ones. */
  missions: Array<KeptMission>;
  /** How many deleted missions can be brought back. */
  deleted: number;
  /** How many things are kept that cannot be read. */
  unreadable: number;
  /** Whether missions are kept beyond the end of this run. */
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
  /** Stops whose questions were answered rightly: `negative-cycle/2`. */
  learned: Array<string>;
  /** Whether the panels stand as the lesson wants them. */
  beside: boolean;
  open: OpenLesson | null;
};

/** The lesson that is open, at its stop. */
export type OpenLesson = {
  name: string;
  title: string;
  /** From 1. */
  stop: number;
  stops: number;
  stopTitle: string;
  /** Whether what the stop shows is still worked out. */
  isDue: boolean;
  /** What the stop says, without its looks. */
  prose: string;
  question: Question | null;
  /** What is wrong in the lesson's file, by line. */
  errors: Array<LessonMistake>;
};

/** What a stop asks. */
export type Question = {
  kind: "choice" | "number" | "word" | "task" | "prediction";
  text: string;
  choices: Array<string>;
  /** What was answered last; of a prediction, the last one that has been shown. */
  given: string | null;
  /** Whether that was right; of a task, whether it is done. */
  isRight: boolean | null;
  /** What was predicted at this stop, if that is asked for. */
  predictions: PredictionCounts | null;
};

/** How often someone predicted what came. */
export type PredictionCounts = {
  made: number;
  right: number;
  /** Whether nothing is left to predict. */
  isOver: boolean;
};

/** Something wrong in a lesson. */
export type LessonMistake = {
  /** From 1. */
  line: number;
  message: string;
};

/** The manual as it is looked at. */
export type Manual = {
  /** `null` while its contents are shown. */
  page: string | null;
  section: string;
  query: string;
  /** Where what is looked for stands: `page#section`. */
  found: Array<string>;
};

/** The review of the mission. */
export type Review = {
  /** The hash of what was reviewed; `null` before the first review of this mission. */
  hash: string | null;
  /** The hash of the present text, map and seed. */
  currentHash: string | null;
  /** The hash of the reviewed plan; empty without one. */
  planHash: string | null;
  /** Whether the two differ. */
  stale: boolean;
  running: boolean;
  status: "information" | "passed" | "attention" | "failed" | null;
  counts: ReviewCounts | null;
  /** What the mission is held against: see section 16 of the specification. */
  rules: { margin: number | string | null; clearance_m: number | null; slope_deg: number | null; reserve: number | string | null; reserves: Record<string, number | string>; success_rate: { wanted: number; least: number } | null; rules: { name: string; rule: string; source: string; waivable: boolean }[]; board: { role: string; approvals: number; people: string[] }[] };
  items: Array<ReviewItem>;
  /** How the plan stands with its board. */
  planStatus: "draft" | "in-review" | "approved" | "approved-with-comments" | "lapsed" | null;
  /** Who has to approve, and who has. */
  board: Array<BoardSeat>;
  /** What stands in the way of any approval. */
  blockers: Array<string>;
  /** The latest approval that has not been taken back. */
  signed: SignOff | null;
  comments: Array<ReviewComment>;
  /** Everything that was done, in order. */
  history: Array<HistoryEntry>;
  /** The digests of the last entries of the history. */
  heads: Array<string>;
  /** Why a review that was kept for this mission is kept aside and not used, if one is. */
  aside: string | null;
  /** Why the history is not kept beyond this visit, if it is not. */
  unkept: string | null;
  /** The waivers that count, oldest first. */
  waivers: Array<ReviewWaiver>;
  /** The people whose signatures count here. */
  people: Array<ReviewPerson>;
};

/** How many lines of a review stand how. */
export type ReviewCounts = {
  passed: number;
  attention: number;
  failed: number;
  /** Lines that say how things are, with nothing to hold them against. */
  information: number;
};

/** A line of a review. */
export type ReviewItem = {
  section: string;
  status: "information" | "passed" | "attention" | "failed";
  text: string;
  /** What it is held against, and where that comes from. */
  criterion: string | null;
  /** The line of its place in the text, from 1. */
  line: number | null;
  /** What it is about, by the names of all output. */
  names: Array<string>;
  /** Who acknowledged it as it is, and why it may be so. */
  acknowledged: { by: string; text: string } | null;
};

/** A role of the board. */
export type BoardSeat = {
  role: string;
  /** How many people have to approve. */
  wanted: number;
  /** Who has approved the present plan. */
  given: Array<string>;
};

/** What someone wrote. */
export type ReviewComment = {
  /** What `review.resolve`, `review.reopen` and `review.withdraw` take. */
  id: string;
  author: string;
  role: string;
  /** An ISO 8601 time in UTC. */
  time: string;
  about: string | null;
  text: string;
  content_hash: string;
  /** Whether it is neither resolved nor taken back. */
  open: boolean;
};

/** Something that someone did. */
export type HistoryEntry = {
  /** Its digest. */
  id: string;
  by: string;
  role: string;
  /** An ISO 8601 time in UTC. */
  time: string;
  /** What was done, in words. */
  act: string;
  /** What was said with it. */
  text: string;
  /** The entry that it is about. */
  of: string | null;
  /** The content that it is about. */
  hash: string;
  /** The plan that it is about; empty if none was known. */
  planHash: string;
  /** Whether someone took it back. */
  withdrawn: boolean;
  /** The public key that it names, in 64 hexadecimal digits; `null` in histories of earlier versions. */
  key: string | null;
  signature: "valid" | "unknown" | "broken" | "unsigned";
  /** Why it does not count in spite of its signature, or what else is odd about it. */
  problem: string | null;
  /** Whether it counts. */
  counts: boolean;
  /** Why it has no effect although it counts: it weakens the board, which has not agreed. */
  withoutEffect: string | null;
};

/** An item that may be as it is until some day. */
export type ReviewWaiver = {
  /** The entry of the history. */
  id: string;
  /** What the item says. */
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

/** Someone has approved a plan. */
export type SignOff = {
  name: string;
  /** An ISO 8601 time in UTC. */
  time: string;
  role: string;
  /** The content that was approved. */
  hash: string;
  /** Whether the present content, plan or rules are others. */
  stale: boolean;
};

/** How a control program stands at the step that is looked at. */
export type ProgramRun = {
  /** The steps taken before this moment. */
  step: number;
  /** All steps that were taken. */
  steps: number;
  locations: number;
  /** The labels of what is marked. */
  marked: Array<string> | null;
  /** The goals that the marked locations assert. */
  goals: Array<string> | null;
  /** The transitions of the step that led here. */
  fired: Array<Fired> | null;
  canStep: boolean;
  isPlaying: boolean;
  trouble: string | null;
  /** How likely the program is to reach its end; `null` until many runs were made of the present text. */
  chance: ProgramChance | null;
  /** What holds in all runs; `null` until it was asked of the present text. */
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
  /** The 95 % confidence interval of the probability. */
  interval: [number, number];
  meanSteps: number;
};

/** What holds in all runs of a program, or why nothing can be proven. */
export type ProgramProof = {
  isRunning: boolean;
  states: number;
  trouble: string | null;
  /** Why not all states were explored, if that is so. */
  stopped: string | null;
  verdicts: Array<ProgramVerdict>;
};

/** Whether a property holds in all runs. */
export type ProgramVerdict = {
  property: string;
  /** `holds`, `broken`, or `open` where no run breaks it but not all were looked at. */
  verdict: string;
  /** In the run that breaks it, the steps in which a component does not do what is nominal, such as `3: EngineA=Failed`. */
  faults: Array<string>;
};

/** What is believed and true of a plant; modes and values by component and variable. */
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
  /** Over how many steps. */
  horizon: number;
  /** Whether the program asks for more steps than could be followed. */
  isShortened: boolean;
};

/** A condition that a program asked for. */
export type Asked = {
  condition: string;
  probability: StateProbability;
  /** Whether it is as probable as the program demands. */
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
  /** Opens an example mission. */
  open(name: string): void;
  /** Replaces the whole text, as one undoable edit. */
  setSource(text: string): void;
  /** The text as it stands. */
  source(): string;
  /** Runs a command by its name: one of the menus, or one with arguments, which section 4.3 of the contracts lists. */
  dispatch(command: string, args?: object): void;
  /** The state as plain data. */
  state(): State;
  /** Calls back with the state whenever it has changed, after the frame that shows it. Call the returned function to unsubscribe. */
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
