//! Bounds of variables as literals.

/// A variable seen from one side: its value, or its value negated. Both are bounded from above, so that one kind of
/// bound is enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Side(pub(crate) u32);

/// A variable: a Boolean (0 or 1) or a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Variable(pub(crate) u32);

impl From<usize> for Side {
    fn from(index: usize) -> Self {
        Self(index as u32)
    }
}

impl From<Side> for usize {
    fn from(side: Side) -> Self {
        side.0 as Self
    }
}

impl From<usize> for Variable {
    fn from(index: usize) -> Self {
        Self(index as u32)
    }
}

impl From<Variable> for usize {
    fn from(variable: Variable) -> Self {
        variable.0 as Self
    }
}

impl Variable {
    pub(crate) const fn upper(self) -> Side {
        Side(self.0 * 2)
    }

    /// Its value negated.
    pub(crate) const fn lower(self) -> Side {
        Side(self.0 * 2 + 1)
    }

    /// Of a Boolean: that it holds.
    pub(crate) const fn holds(self) -> Literal {
        Literal { side: self.lower(), most: -1 }
    }
}

impl Side {
    pub(crate) const fn opposite(self) -> Self {
        Self(self.0 ^ 1)
    }

    pub(crate) const fn variable(self) -> Variable {
        Variable(self.0 / 2)
    }

    /// Of a Boolean: the literal that this side has once it is decided.
    pub(crate) const fn decided(self) -> Literal {
        Literal { side: self, most: -((self.0 & 1) as i64) }
    }
}

/// A side is at most a value. Of a time that exists only in some plans: if it exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Literal {
    pub(crate) side: Side,
    pub(crate) most: i64,
}

impl Literal {
    pub(crate) const TRUE: Self = Variable(0).holds();

    pub(crate) const fn new(side: Side, most: i64) -> Self {
        Self { side, most }
    }

    /// Returns whether this implies `other` by itself.
    pub(crate) fn implies(self, other: Self) -> bool {
        self.side == other.side && self.most <= other.most
    }
}

impl std::ops::Not for Literal {
    type Output = Self;

    fn not(self) -> Self {
        Self { side: self.side.opposite(), most: -self.most - 1 }
    }
}
