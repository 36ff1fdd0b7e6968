// Orbit insertion as a statechart for XState: prints steps per second as JSON.
//
// node automata.mjs transition|actor SECONDS COURSE; a course is a list of [engine A, engine B, active states then].

import { createActor, createMachine, getInitialSnapshot, transition } from "xstate";

const [, , how, seconds, course] = process.argv;
const expected = JSON.parse(course).map(([, , active]) => active);
const events = JSON.parse(course).map(([a, b]) => ({ type: "estimate", a, b, camera: "Off" }));

/** Milliseconds of wall time or of the processor, whichever is less: other work on the machine disturbs that little. */
const stopwatch = () => {
  const [wall, cpu] = [performance.now(), process.cpuUsage()];
  return () => {
    const { user, system } = process.cpuUsage(cpu);
    return Math.min(performance.now() - wall, (user + system) / 1000);
  };
};

/** A region that is active until its condition holds. */
const until = (guard) => ({
  initial: "wait",
  states: { wait: { on: { estimate: { guard: ({ event }) => guard(event), target: "done" } } }, done: { type: "final" } },
});

const machine = createMachine({
  initial: "insert",
  states: {
    insert: {
      type: "parallel",
      // do … watching (EngineA = Firing or EngineB = Firing): the outer transition comes before all inner ones.
      states: {
        standbyA: until(({ a }) => a === "Standby"),
        standbyB: until(({ b }) => b === "Standby"),
        camera: until(({ camera }) => camera === "Off"),
        fireA: {
          initial: "wait",
          states: {
            wait: {
              on: {
                estimate: [
                  { guard: ({ event }) => event.a === "Failed", target: "done" },
                  { guard: ({ event }) => event.a === "Standby" && event.camera === "Off", target: "fire" },
                ],
              },
            },
            fire: {
              on: { estimate: { guard: ({ event }) => event.a === "Failed" || event.a === "Firing", target: "done" } },
            },
            done: { type: "final" },
          },
        },
        fireB: {
          initial: "wait",
          states: {
            wait: {
              on: {
                estimate: {
                  guard: ({ event }) => event.a === "Failed" && event.b === "Standby" && event.camera === "Off",
                  target: "fire",
                },
              },
            },
            fire: { on: { estimate: { guard: ({ event }) => event.b === "Firing", target: "done" } } },
            done: { type: "final" },
          },
        },
      },
      on: { fired: "done" },
    },
    done: { type: "final" },
  },
});

/** An engine that fires ends everything; statecharts give inner transitions precedence, so the sender says it. */
const preempting = events.map((event) =>
  event.a === "Firing" || event.b === "Firing" ? { ...event, type: "fired" } : event,
);

/** The states that are active and not final. */
const active = (value) =>
  typeof value === "string" ? 0 : Object.values(value.insert).filter((state) => state !== "done").length;

const initial = getInitialSnapshot(machine);
let snapshot = initial;
preempting.forEach((event, at) => {
  [snapshot] = transition(machine, snapshot, event);
  if (active(snapshot.value) !== expected[at]) {
    throw new Error(`step ${at + 1}: ${active(snapshot.value)} active states, not ${expected[at]}`);
  }
});

const course_of = {
  transition() {
    let snapshot = initial;
    for (const event of preempting) [snapshot] = transition(machine, snapshot, event);
    return snapshot.status;
  },
  actor() {
    const actor = createActor(machine).start();
    for (const event of preempting) actor.send(event);
    return actor.getSnapshot().status;
  },
}[how];

const run = (millis) => {
  let steps = 0;
  const elapsed = stopwatch();
  while (elapsed() < millis) {
    for (let at = 0; at < 100; at++) {
      if (course_of() !== "done") throw new Error("the program ends");
      steps += preempting.length;
    }
  }
  return (steps * 1000) / elapsed();
};

run(300);
console.log(JSON.stringify({ steps_per_second: run(1000 * Number(seconds)) }));
