"""Solves mission instances with OR-tools CP-SAT or Z3 and prints one JSON line for each.

planner.py cp-sat|z3 REPEATS LIMIT_SECONDS FILE…

An instance is what src/planner/instance.rs writes. The time of a run begins when the instance is in memory; the best
of the repeats counts. Encoding is the share of it for building the solver's model.
"""

import json
import sys
import time


def now():
    """Wall time and the time that this process had the processor."""
    return time.perf_counter(), time.process_time()


def between(begun, done):
    """The lesser of the two, which other work on the machine disturbs little."""
    return min(done[0] - begun[0], done[1] - begun[1])


def cp_sat(instance, limit_s):
    """One worker, no presolve. Times are variables over the horizon; a constraint binds if its literal holds."""
    from ortools.sat.python import cp_model

    begun = now()
    model = cp_model.CpModel()
    horizon = instance["horizon"]
    literals = [None] + [model.new_bool_var("") for _ in range(1, instance["literals"])]
    times = [model.new_int_var(0, horizon if event else 0, "") for event in range(len(instance["events"]))]

    def imply(condition, difference, lower, upper):
        constraint = model.add_linear_constraint(difference, lower, upper)
        if condition is not None:
            constraint.only_enforce_if(condition)

    for choice in instance["choices"]:
        alternatives = [literals[at] for at in choice["alternatives"]]
        if choice["when"] == 0:
            model.add_exactly_one(alternatives)
        else:
            when = literals[choice["when"]]
            model.add_exactly_one(alternatives + [when.negated()])
    for bounds in instance["bounds"]:
        upper = horizon if bounds["upper"] is None else bounds["upper"]
        imply(literals[bounds["when"]], times[bounds["to"]] - times[bounds["from"]], bounds["lower"], upper)
    for requirement in instance["requirements"]:
        asked = requirement["interval"]
        links = []
        for support in requirement["supports"]:
            link = model.new_bool_var("")
            if support["when"]:
                model.add_implication(link, literals[support["when"]])
            imply(link, times[asked["start"]] - times[support["start"]], 0, horizon)
            imply(link, times[support["end"]] - times[asked["end"]], 0, horizon)
            links.append(link)
        model.add_bool_or(links + ([literals[asked["when"]].negated()] if asked["when"] else []))
    for one, other in instance["conflicts"]:
        orders = []
        for first, second in ((one, other), (other, one)):
            order = model.new_bool_var("")
            imply(order, times[second["start"]] - times[first["end"]], instance["gap"], horizon)
            orders.append(order)
        absent = [literals[interval["when"]].negated() for interval in (one, other) if interval["when"]]
        model.add_bool_or(orders + absent)
    encoded = now()
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.cp_model_presolve = False
    solver.parameters.max_time_in_seconds = limit_s
    status = solver.solve(model)
    done = now()
    verdicts = {cp_model.OPTIMAL: "plan", cp_model.FEASIBLE: "plan", cp_model.INFEASIBLE: "no-plan"}
    return verdicts.get(status, "limit"), between(begun, encoded), between(begun, done)


def z3(instance, limit_s):
    """Integer difference logic, told as SMT-LIB text, which Z3 reads faster than calls from Python."""
    import z3

    begun = now()
    lines = [f"(declare-const l{at} Bool)" for at in range(1, instance["literals"])]
    lines += [f"(declare-const t{at} Int)" for at in range(len(instance["events"]))]
    lines.append("(assert (= t0 0))")
    fresh = 0

    def least(gap, start, end):
        """start + gap ≤ end"""
        return f"(<= (- t{start} t{end}) {-gap if gap <= 0 else f'(- {gap})'})"

    def imply(when, body):
        lines.append(f"(assert {body})" if when == 0 else f"(assert (=> l{when} {body}))")

    for choice in instance["choices"]:
        alternatives = [f"l{at}" for at in choice["alternatives"]]
        imply(choice["when"], f"(or {' '.join(alternatives)} false)")
        for at, one in enumerate(alternatives):
            if choice["when"]:
                lines.append(f"(assert (=> {one} l{choice['when']}))")
            lines += [f"(assert (not (and {one} {other})))" for other in alternatives[at + 1 :]]
    for event in range(1, len(instance["events"])):
        lines.append(f"(assert {least(0, 0, event)})")
        lines.append(f"(assert {least(-instance['horizon'], event, 0)})")
    for bounds in instance["bounds"]:
        imply(bounds["when"], least(bounds["lower"], bounds["from"], bounds["to"]))
        if bounds["upper"] is not None:
            imply(bounds["when"], least(-bounds["upper"], bounds["to"], bounds["from"]))
    for requirement in instance["requirements"]:
        asked = requirement["interval"]
        links = []
        for support in requirement["supports"]:
            parts = [least(0, support["start"], asked["start"]), least(0, asked["end"], support["end"])]
            if support["when"]:
                parts.append(f"l{support['when']}")
            links.append(f"(and {' '.join(parts)})")
        imply(asked["when"], f"(or {' '.join(links)} false)")
    for one, other in instance["conflicts"]:
        orders = [least(instance["gap"], a["end"], b["start"]) for a, b in ((one, other), (other, one))]
        absent = [f"(not l{interval['when']})" for interval in (one, other) if interval["when"]]
        lines.append(f"(assert (or {' '.join(orders + absent)}))")
    solver = z3.SolverFor("QF_IDL")
    solver.set("timeout", int(limit_s * 1000))
    solver.from_string("\n".join(lines))
    encoded = now()
    verdict = {"sat": "plan", "unsat": "no-plan"}.get(str(solver.check()), "limit")
    return verdict, between(begun, encoded), between(begun, now())


def main():
    name, repeats, limit_s, *files = sys.argv[1:]
    solve = {"cp-sat": cp_sat, "z3": z3}[name]
    for at, file in enumerate(files):
        with open(file, encoding="utf-8") as source:
            instance = json.load(source)
        if at == 0:
            solve(instance, 1.0)  # Loads the library before any time is taken.
        best = min((solve(instance, float(limit_s)) for _ in range(int(repeats))), key=lambda answer: answer[2])
        print(json.dumps({"verdict": best[0], "encoding_s": best[1], "total_s": best[2]}), flush=True)


main()
