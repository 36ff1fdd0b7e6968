// The page's interface for host pages and tests.

/** What a call refuses with. */
export interface EnrouteError extends Error {
  readonly name: "EnrouteError";
  readonly code:
    | "not-ready"
    | "stopped"
    | "no-graphics"
    | "unknown-mission"
    | "unknown-command"
    | "bad-arguments"
    | "unavailable";
}

/** A time: a number where it is exact in decimal, otherwise `"p/q"`; `"inf"` is without bound. */
export type Time = number | string;

/** Something to tell the author about a place of the text. */
export interface Diagnostic {
  code: string;
  severity: string;
  message: string;
  /** `start` and `end` in bytes, `line` and `column` from 1. */
  span: { start: number; end: number; line: number; column: number };
  hint: string | null;
}

/** A plan; windows are earliest and latest times by event. */
export interface Plan {
  choices: Record<string, number>;
  activities: unknown[];
  causal_links: { ask: string; tell: string }[];
  conflict_order: [string, string][];
  orderings_added: [string, string][];
  windows: Record<string, [Time, Time]>;
}

/** The recorded search and the step that is looked at. While one is, all panels show that step instead of the plan. */
export interface Search {
  /** The step that is shown, from 1; 0 while the plan is shown. */
  step: number;
  /** How many steps are recorded; 0 if none are. */
  steps: number;
  isPlaying: boolean;
  stepsPerSecond: number;
  /** Where running and playing stop. */
  breakpoints: Record<"decision" | "failure" | "threat" | "solution", boolean>;
  /** What the search knew at the step: its choices, links, orderings and windows in the form of a plan. */
  known: (Plan & { event: string; text: string; state: number; cycle: string[] }) | null;
  /** Both searches side by side, if they are compared; `side` is the one that the panels show. */
  compare: { side: number; isLinked: boolean; searches: SearchFigures[] } | null;
}

/** How much work a search was, and where it is looked at. */
export interface SearchFigures {
  search: "chronological" | "conflict-directed";
  status: string;
  step: number;
  steps: number;
  states: number;
  propagations: number;
  backtracks: number;
  deadEnds: number;
  millis: number;
}

/** Where a vehicle is: metres, and radians counter-clockwise from east. */
export interface Vehicle {
  name: string;
  x: number;
  y: number;
  /** The height of the ground there, for a blimp its height over it; `null` off the map. */
  z: number | null;
  heading: number;
  time: number;
}

/** A run of the mission at the time shown. */
export interface Execution {
  status: "under-way" | "finished" | "stopped";
  /** How the whole run ends. */
  ending: "finished" | "stopped";
  /** Whether a newer run is being worked out. */
  isWorking: boolean;
  time: number;
  replans: number;
  underWay: string[];
  holding: string[];
  waitedFor: string[];
  deadline: { event: string; time: Time } | null;
  disturbances: Record<string, unknown>[];
  /** What has happened up to the time shown. */
  log: ({ time: Time; event: string } & Record<string, unknown>)[];
}

/** What many runs with chance came to. */
export interface Robustness {
  runs: number;
  isRunning: boolean;
  probability: number;
  /** The 95 % confidence interval. */
  interval: [number, number];
  /** The events that broke plans, the worst first. */
  worst: string[];
}

/** What is done on the terrain. */
export interface Terrain {
  tool: "look" | "measure" | "location" | "circle" | "polygon" | "vehicle";
  /** The places that the tool has so far, in metres east and north. */
  points: [number, number][];
  /** Whether the clearance map is shown. */
  clearance: boolean;
  /** The search for a path that is looked at sample by sample. `length` is that of the best path so far, in metres. */
  growth: {
    planner: string;
    leg: number;
    samples: number;
    total: number;
    vertices: number;
    length: number | null;
  } | null;
}

/** How a control program stands at the step that is looked at. */
export interface ProgramRun {
  /** The steps taken before this moment, and all that were taken. */
  step: number;
  steps: number;
  locations: number;
  /** The labels of what is marked, and the goals that it asserts. */
  marked: string[] | null;
  goals: string[] | null;
  /** The transitions of the step that led here. */
  fired: { from: string }[] | null;
  canStep: boolean;
  isPlaying: boolean;
  trouble: string | null;
  /** How likely the program is to reach its end; `null` until many runs were made of the present text. */
  chance: {
    runs: number;
    isRunning: boolean;
    reached: number;
    probability: number;
    /** The 95 % confidence interval of the probability. */
    interval: [number, number];
    meanSteps: number;
  } | null;
  plant: PlantState | null;
}

/** What is believed and true of a plant; modes and values by component and variable. */
export interface PlantState {
  /** Most likely first; probabilities are exact fractions. */
  belief: { state: Record<string, string>; probability: string }[];
  trueState: Record<string, string>;
  observations: Record<string, string> | null;
  commands: Record<string, string> | null;
  nextCommands: Record<string, string> | null;
  unachievable: { goal: string; reason: string }[];
  isUnexplained: boolean;
  /** Which assumptions the observations contradict. */
  conflicts: string[] | null;
}

/** A path between two waypoints. Lengths in metres, durations in mission units. */
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

/** The review of the mission. */
export interface Review {
  /** The hash of what was reviewed; `null` before the first review of this mission. */
  hash: string | null;
  /** The hash of the present text, map and seed. */
  currentHash: string | null;
  /** Whether the two differ. */
  stale: boolean;
  running: boolean;
  status: "passed" | "attention" | "failed" | null;
  counts: { passed: number; attention: number; failed: number } | null;
  items: {
    section: string;
    status: "passed" | "attention" | "failed";
    text: string;
    /** The line of its place in the text, from 1. */
    line: number | null;
    /** What it is about, by the names of all output. */
    names: string[];
  }[];
  /** The latest sign-off of the present content, otherwise the latest of any. */
  signed: { name: string; time: string; hash: string; stale: boolean } | null;
  comments: { author: string; time: string; about: string | null; text: string; content_hash: string }[];
  /** Why comments and sign-offs are not kept beyond this visit, if they are not. */
  unkept: string | null;
}

/** Everything the page shows, for one revision of the text. */
export interface State {
  /** Counts the edits of the text; everything below belongs to the revision it says. */
  revision: number;
  workspace: string;
  diagnostics: Diagnostic[];
  /** How many of each the network has; `null` while the text does not compile. */
  tpn: { nodes: number; arcs: number; decisions: number; occurrences: number } | null;
  plan: Plan | null;
  verdict: unknown;
  review: Review;
  /** What the mission is compared with. */
  compare: { with: string; planned: boolean } | null;
  search: { step: number; steps: number };
  /** The run of a control program; `null` for a mission. */
  hca: ProgramRun | null;
  vehicles: Vehicle[];
  /** The run that is watched in the Execute workspace. */
  execution: Execution | null;
  robustness: Robustness | null;
  traverses: Traverse[] | null;
  terrain: Terrain;
  time: Time;
  /** The range of times that is selected on the timeline. */
  timeRange: [number, number] | null;
  /** Events pinned to times on the timeline, and the windows that they leave to all events. */
  pinned: { events: Record<string, number>; windows: Record<string, [Time, Time]> } | null;
  selection: unknown;
  /** What draws the canvas: WebGPU or WebGL2. */
  renderer: string;
  /**
   * Milliseconds by stage, for the revision shown. `frame` is the app's own code in the last frame, `wholeFrame` all
   * that the frame before took on the page's thread. `answerFrame` is the app's code in the frame that first shows
   * the answer to the present text, and `shownAt` is when that frame was ready, on the clock of `performance.now()`;
   * both are `null` until then.
   */
  timings: Record<
    "parse" | "compile" | "plan" | "layout" | "total" | "frame" | "wholeFrame" | "answerFrame" | "shownAt",
    number | null
  >;
  [more: string]: unknown;
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
  /** Runs a command of the command palette by its name. */
  dispatch(command: string, args?: object): void;
  /** The state as plain data. */
  state(): State;
  /** Calls back with the state whenever it has changed, after the frame that shows it; the answer ends that. */
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
