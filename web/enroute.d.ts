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

/** Where a vehicle is: metres, and radians counter-clockwise from east. */
export interface Vehicle {
  name: string;
  x: number;
  y: number;
  z: number;
  heading: number;
}

/** Everything the page shows, for one revision of the text. */
export interface State {
  /** Counts the edits of the text; everything below belongs to the revision it says. */
  revision: number;
  workspace: string;
  diagnostics: Diagnostic[];
  tpn: { nodes: unknown[]; arcs: unknown[] } | null;
  plan: Plan | null;
  verdict: unknown;
  search: { step: number; steps: number } | null;
  hca: unknown;
  vehicles: Vehicle[];
  time: Time;
  selection: unknown;
  /** What draws the canvas: WebGPU or WebGL2. */
  renderer: string;
  /** Milliseconds by stage, for the revision shown. */
  timings: Record<"parse" | "compile" | "plan" | "layout" | "total" | "frame", number | null>;
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
