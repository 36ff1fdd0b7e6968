//! Changing expressions in place: what they directly consist of.

use super::syntax::{Argument, Constraint, ConstraintKind, Expression, ExpressionKind};

impl Expression {
    /// The expressions that it directly consists of, as [`Self::parts`].
    pub fn parts_mut(&mut self) -> Vec<&mut Self> {
        match &mut self.kind {
            ExpressionKind::Parallel(parts) | ExpressionKind::Sequence(parts) => parts.iter_mut().collect(),
            ExpressionKind::IfThenNext { then: first, otherwise, .. }
            | ExpressionKind::Timeout { body: first, otherwise, .. }
            | ExpressionKind::Within { body: first, otherwise, .. } => {
                std::iter::once(&mut **first).chain(otherwise.as_deref_mut()).collect()
            }
            ExpressionKind::Always(body)
            | ExpressionKind::UnlessThenNext { body, .. }
            | ExpressionKind::WhenDoNext { body, .. }
            | ExpressionKind::WheneverDoNext { body, .. }
            | ExpressionKind::DoWatching { body, .. }
            | ExpressionKind::At { body, .. }
            | ExpressionKind::Every { body, .. }
            | ExpressionKind::Warp { body, .. }
            | ExpressionKind::Lock { body, .. } => vec![body],
            ExpressionKind::ChooseProb(alternatives) | ExpressionKind::ChooseReward(alternatives) => {
                alternatives.iter_mut().map(|alternative| &mut alternative.body).collect()
            }
            ExpressionKind::Call { arguments, .. } => {
                let expressions = arguments.iter_mut().filter_map(|argument| match argument {
                    Argument::Expression(inner) => Some(inner),
                    Argument::Word(_) | Argument::Guard(_) => None,
                });
                expressions.collect()
            }
            ExpressionKind::Assert(_)
            | ExpressionKind::Wait(_)
            | ExpressionKind::Reward(_)
            | ExpressionKind::Unreadable => Vec::new(),
        }
    }

    /// The constraints that it asserts, asks for, or hands to a definition itself.
    pub fn constraints_mut(&mut self) -> Vec<&mut Constraint> {
        match &mut self.kind {
            ExpressionKind::IfThenNext { guard, .. }
            | ExpressionKind::UnlessThenNext { guard, .. }
            | ExpressionKind::WhenDoNext { guard, .. }
            | ExpressionKind::WheneverDoNext { guard, .. }
            | ExpressionKind::DoWatching { guard, .. } => vec![&mut guard.constraint],
            ExpressionKind::Assert(constraint) | ExpressionKind::Lock { constraint, .. } => vec![constraint],
            ExpressionKind::Call { arguments, .. } => {
                let guards = arguments.iter_mut().filter_map(|argument| match argument {
                    Argument::Guard(guard) => Some(&mut guard.constraint),
                    Argument::Word(_) | Argument::Expression(_) => None,
                });
                guards.collect()
            }
            _ => Vec::new(),
        }
    }

    /// Changes all constraints inside, equalities before what they are parts of.
    pub fn change_constraints(&mut self, change: &mut dyn FnMut(&mut Constraint)) {
        for constraint in self.constraints_mut() {
            constraint.change(change);
        }
        for part in self.parts_mut() {
            part.change_constraints(change);
        }
    }
}

impl Constraint {
    /// Changes it and all of its parts, parts first.
    pub(super) fn change(&mut self, change: &mut dyn FnMut(&mut Self)) {
        match &mut self.kind {
            ConstraintKind::Not(inner) => inner.change(change),
            ConstraintKind::And(parts) | ConstraintKind::Or(parts) => {
                for part in parts {
                    part.change(change);
                }
            }
            _ => {}
        }
        change(self);
    }
}
