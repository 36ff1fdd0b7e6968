// Lays out a graph with ELK or dagre and prints the median time and the lines of the arcs as JSON.
//
// node layouts.mjs elk|dagre RUNS FILE; the file is what src/layouts/mod.rs writes. A first run on a small graph warms
// the library up.

import fs from "node:fs";

const [, , which, runs, file] = process.argv;
const graph = JSON.parse(fs.readFileSync(file, "utf8"));
const SIZE = 24;

/** Milliseconds of wall time or of the processor, whichever is less: other work on the machine disturbs that little. */
const stopwatch = () => {
  const [wall, cpu] = [performance.now(), process.cpuUsage()];
  return () => {
    const { user, system } = process.cpuUsage(cpu);
    return Math.min(performance.now() - wall, (user + system) / 1000);
  };
};

const small = { nodes: 60, edges: Array.from({ length: 59 }, (_, at) => [at >> 1, at + 1]) };

async function elk() {
  const { default: ELK } = await import("elkjs/lib/elk.bundled.js");
  const engine = new ELK();
  return async (graph) => {
    const input = {
      id: "root",
      layoutOptions: { "elk.algorithm": "layered", "elk.direction": "RIGHT" },
      children: Array.from({ length: graph.nodes }, (_, at) => ({ id: `n${at}`, width: SIZE, height: SIZE })),
      edges: graph.edges.map(([from, to], at) => ({ id: `e${at}`, sources: [`n${from}`], targets: [`n${to}`] })),
    };
    const elapsed = stopwatch();
    const output = await engine.layout(input);
    const millis = elapsed();
    const lines = output.edges.flatMap((edge) =>
      edge.sections.map((section) =>
        [section.startPoint, ...(section.bendPoints ?? []), section.endPoint].map(({ x, y }) => [x, y]),
      ),
    );
    return { millis, lines };
  };
}

async function dagre() {
  const { default: dagre } = await import("@dagrejs/dagre");
  return async (graph) => {
    const input = new dagre.graphlib.Graph({ multigraph: true });
    input.setGraph({ rankdir: "LR" });
    input.setDefaultEdgeLabel(() => ({}));
    for (let at = 0; at < graph.nodes; at++) input.setNode(`n${at}`, { width: SIZE, height: SIZE });
    graph.edges.forEach(([from, to], at) => input.setEdge(`n${from}`, `n${to}`, {}, `e${at}`));
    const elapsed = stopwatch();
    dagre.layout(input);
    const millis = elapsed();
    return { millis, lines: input.edges().map((edge) => input.edge(edge).points.map(({ x, y }) => [x, y])) };
  };
}

const lay = await { elk, dagre }[which]();
await lay(small);
const times = [];
let lines = [];
for (let run = 0; run < Number(runs); run++) {
  const drawn = await lay(graph);
  times.push(drawn.millis);
  lines = drawn.lines;
}
times.sort((a, b) => a - b);
process.stdout.write(JSON.stringify({ millis: times[times.length >> 1], lines }));
