"""Finds the best plan of days and tours with OR-tools CP-SAT and proves it; prints one JSON line for each.

objectives.py LIMIT_SECONDS FILE…

An instance is what src/planner/objectives.rs writes. Time begins when the instance is in memory.
"""

import json
import sys
import time

from ortools.sat.python import cp_model


def now():
    """Wall time and the time that this process had the processor."""
    return time.perf_counter(), time.process_time()


def passed(begun):
    return min(after - before for before, after in zip(begun, now()))


class First(cp_model.CpSolverSolutionCallback):
    """Takes down when there was a first solution."""

    def __init__(self, begun):
        super().__init__()
        self.begun = begun
        self.after_s = None

    def on_solution_callback(self):
        if self.after_s is None:
            self.after_s = passed(self.begun)


def add_day(model, day):
    """What is best is least."""
    intervals, rewards, energies = [], [], []
    for wish in day["wishes"]:
        if wish["release"] + wish["duration"] > wish["deadline"]:
            continue
        taken = model.new_bool_var("")
        start = model.new_int_var(wish["release"], wish["deadline"] - wish["duration"], "")
        intervals.append(model.new_optional_fixed_size_interval_var(start, wish["duration"], taken, ""))
        rewards.append(wish["reward"] * taken)
        energies.append(wish["energy"] * taken)
    model.add_no_overlap(intervals)
    model.add(sum(energies) <= day["energy"])
    model.minimize(-sum(rewards))


def add_stops(model, tour):
    """A circuit for each vehicle through the stops that it makes, open at its end."""
    distances = tour["distances"]
    points = range(len(distances))
    visits = {stop: [] for stop in points if stop > 0}
    end = model.new_int_var(0, sum(map(max, distances)), "")
    for _ in range(tour["vehicles"]):
        stays = model.new_bool_var("")
        arcs, driven = [(0, 0, stays)], []
        for stop in visits:
            skipped = model.new_bool_var("")
            visits[stop].append(~skipped)
            model.add_implication(stays, skipped)
            arcs.append((stop, stop, skipped))
            arcs.append((stop, 0, model.new_bool_var("")))
        for start in points:
            for stop in visits:
                if start != stop:
                    goes = model.new_bool_var("")
                    arcs.append((start, stop, goes))
                    driven.append(distances[start][stop] * goes)
        model.add_circuit(arcs)
        model.add(sum(driven) <= end)
    for vehicles in visits.values():
        model.add_exactly_one(vehicles)
    model.minimize(end)


def solve(instance, limit_s):
    begun = now()
    model = cp_model.CpModel()
    (add_day if instance["kind"] == "Day" else add_stops)(model, instance)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.max_time_in_seconds = limit_s
    first = First(begun)
    status = solver.solve(model, first)
    return {
        "value": round(solver.objective_value) if status in (cp_model.OPTIMAL, cp_model.FEASIBLE) else None,
        "is_proven": status == cp_model.OPTIMAL,
        "total_s": passed(begun),
        "first_s": first.after_s,
    }


def main():
    limit_s, *files = sys.argv[1:]
    for at, file in enumerate(files):
        with open(file, encoding="utf-8") as source:
            instance = json.load(source)
        if at == 0:
            solve(instance, 1.0)  # Loads the library before any time is taken.
        print(json.dumps(solve(instance, float(limit_s))), flush=True)


main()
