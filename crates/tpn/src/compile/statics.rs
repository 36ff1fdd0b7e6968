//! Checks that need no expansion but decide whether one is possible: recursion, and bounds without names.

use std::collections::BTreeMap;

use rmpl::program::{
    ActivityDecl, Bounds, HeaderBound, HeaderBounds, Name, Program, Statement, StatementKind,
};
use rmpl::{Code, Diagnostic};

use super::bounds;

/// Activities call each other in a circle.
pub(super) const E_RECURSION: Code = Code("E-RECURSION");

/// Everything that is wrong whatever is compiled.
pub(super) fn check(program: &Program) -> Vec<Diagnostic> {
    let mut found = recursion(program);
    let mut check_bounds = |written: &Bounds| {
        if bounds::is_constant(written)
            && let Err(error) = bounds::interval(written, &|_| None)
        {
            found.push(error);
        }
    };
    for primitive in &program.primitives {
        primitive.bounds.iter().for_each(&mut check_bounds);
    }
    for activity in &program.activities {
        if let HeaderBounds::Sides {
            lower: HeaderBound::Limit(lower),
            upper: HeaderBound::Limit(upper),
            span,
        } = &activity.bounds
        {
            check_bounds(&Bounds { lower: lower.clone(), upper: upper.clone(), span: *span });
        }
        for_each_statement(&activity.body, &mut |statement| {
            statement.bounds.iter().for_each(&mut check_bounds);
        });
    }
    for scenario in &program.scenarios {
        scenario.bounds.iter().for_each(&mut check_bounds);
        for_each_statement(&scenario.body, &mut |statement| {
            statement.bounds.iter().for_each(&mut check_bounds);
        });
    }
    found
}

/// One diagnostic for each circle of calls; circles that share an activity are one mistake.
fn recursion(program: &Program) -> Vec<Diagnostic> {
    let mut by_name: BTreeMap<&str, usize> = BTreeMap::new();
    for (index, activity) in program.activities.iter().enumerate() {
        by_name.entry(activity.name.text.as_str()).or_insert(index);
    }
    let calls: Vec<Vec<(usize, &Name)>> =
        program.activities.iter().map(|activity| calls_of(activity, &by_name)).collect();
    let mut search =
        CircleSearch { program, calls: &calls, state: vec![State::New; calls.len()], found: Vec::new() };
    for start in 0..calls.len() {
        search.visit(start);
    }
    search.found
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    New,
    Open,
    Done,
    Reported,
}

struct CircleSearch<'program> {
    program: &'program Program,
    calls: &'program [Vec<(usize, &'program Name)>],
    state: Vec<State>,
    found: Vec<Diagnostic>,
}

impl CircleSearch<'_> {
    /// Depth first without the call stack, which a long chain of activities would exhaust.
    fn visit(&mut self, start: usize) {
        if self.state[start] != State::New {
            return;
        }
        self.state[start] = State::Open;
        let mut path = vec![(start, 0)];
        while let Some((activity, next)) = path.last_mut() {
            let Some(&(callee, name)) = self.calls[*activity].get(*next) else {
                if self.state[*activity] == State::Open {
                    self.state[*activity] = State::Done;
                }
                path.pop();
                continue;
            };
            *next += 1;
            match self.state[callee] {
                State::New => {
                    self.state[callee] = State::Open;
                    path.push((callee, 0));
                }
                State::Open => {
                    let from = path.iter().position(|&(open, _)| open == callee).unwrap_or(0);
                    let circle: Vec<usize> = path[from..].iter().map(|&(open, _)| open).collect();
                    self.report(&circle, name);
                }
                State::Done | State::Reported => {}
            }
        }
    }

    fn report(&mut self, circle: &[usize], call: &Name) {
        let is_told = circle.iter().any(|&activity| self.state[activity] == State::Reported);
        for &activity in circle {
            self.state[activity] = State::Reported;
        }
        if is_told {
            return;
        }
        let names = circle.iter().map(|&activity| self.program.activities[activity].name.text.as_str());
        let way: Vec<String> = names.chain([call.text.as_str()]).map(|name| format!("`{name}`")).collect();
        let message =
            format!("activities may not call themselves, and {} does: {}", way[0], way.join(" calls "));
        self.found.push(
            Diagnostic::error(E_RECURSION, call.span, message)
                .with_hint("a network is finite: write repetitions out, one after the other"),
        );
    }
}

fn calls_of<'program>(
    activity: &'program ActivityDecl,
    by_name: &BTreeMap<&str, usize>,
) -> Vec<(usize, &'program Name)> {
    let mut calls = Vec::new();
    for_each_statement(&activity.body, &mut |statement| {
        if let StatementKind::Call(name, _) = &statement.kind
            && let Some(&callee) = by_name.get(name.text.as_str())
            && activity.formals.iter().all(|formal| formal.text != name.text)
        {
            calls.push((callee, name));
        }
    });
    calls
}

/// Visits `statement` and everything in it, in textual order.
pub(super) fn for_each_statement<'program>(
    statement: &'program Statement,
    visit: &mut dyn FnMut(&'program Statement),
) {
    visit(statement);
    match &statement.kind {
        StatementKind::Sequence(items) | StatementKind::Parallel(items) | StatementKind::Choose(items) => {
            for item in items {
                for_each_statement(item, visit);
            }
        }
        StatementKind::Maintaining(body, _)
        | StatementKind::Watching(body, _)
        | StatementKind::IfThennext(_, body) => {
            for_each_statement(body, visit);
        }
        StatementKind::Call(..) | StatementKind::Condition(..) | StatementKind::Delay => {}
    }
}
