"""Schedules projects with OR-tools CP-SAT, as short as possible, and prints one JSON line for each.

resources.py LIMIT_SECONDS FILE…

A project is what src/planner/resources.rs writes. Time begins when the project is in memory.
"""

import json
import sys
import time

from ortools.sat.python import cp_model


def now():
    """Wall time and the time that this process had the processor."""
    return time.perf_counter(), time.process_time()


def solve(project, limit_s):
    """One worker. A resource is a cumulative constraint, of capacity one `no_overlap`."""
    begun = now()
    model = cp_model.CpModel()
    horizon = sum(activity["duration"] for chain in project["chains"] for activity in chain)
    takers = [([], []) for _ in project["capacities"]]
    ends = []
    for chain in project["chains"]:
        before = None
        for activity in chain:
            start = model.new_int_var(0, horizon, "")
            interval = model.new_fixed_size_interval_var(start, activity["duration"], "")
            if before is not None:
                model.add(start >= before)
            before = start + activity["duration"]
            for (intervals, amounts), amount in zip(takers, activity["amounts"]):
                if amount:
                    intervals.append(interval)
                    amounts.append(amount)
        ends.append(before)
    for (intervals, amounts), capacity in zip(takers, project["capacities"]):
        if capacity == 1:
            model.add_no_overlap(intervals)
        else:
            model.add_cumulative(intervals, amounts, capacity)
    end = model.new_int_var(0, horizon, "")
    for last in ends:
        model.add(end >= last)
    model.minimize(end)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.max_time_in_seconds = limit_s
    status = solver.solve(model)
    done = now()
    has_schedule = status in (cp_model.OPTIMAL, cp_model.FEASIBLE)
    return {
        "value": int(solver.objective_value) if has_schedule else None,
        "is_proven": status == cp_model.OPTIMAL,
        "total_s": min(done[0] - begun[0], done[1] - begun[1]),
        "first_s": None,
    }


def main():
    limit_s, *files = sys.argv[1:]
    for at, file in enumerate(files):
        with open(file, encoding="utf-8") as source:
            project = json.load(source)
        if at == 0:
            solve(project, 1.0)  # Loads the library before any time is taken.
        print(json.dumps(solve(project, float(limit_s))), flush=True)


main()
