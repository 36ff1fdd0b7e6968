//! How much memory a problem may take, and whether to continue telling it to the solver.

/// Why a problem is not told to the solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unencoded {
    /// Its times, or sums of them, do not fit into 60 bits.
    TimesTooLarge,
    /// There are too many links and orders.
    TooManyLinks,
    /// It was stopped meanwhile.
    Stopped,
}

/// What a clause takes, in units of about 150 bytes.
pub(super) const CLAUSE: usize = 1;
/// What a possible causal link takes, with its literal, its two differences and its part of a choice point.
pub(super) const LINK: usize = 6;
/// What a choice point of two orders takes.
pub(super) const ORDER: usize = 8;
/// At most this much: a million and a quarter of orders, or ten million clauses, 1.5 GB.
const MAX_SIZE: usize = 10_000_000;
/// Steps between two looks at whether to stop.
const STEPS: usize = 1 << 16;

/// Counts what a problem grows by.
pub(crate) struct Growth<'s> {
    size: usize,
    steps: usize,
    pub(super) stop: &'s mut dyn FnMut() -> bool,
}

impl<'s> Growth<'s> {
    pub(crate) fn new(stop: &'s mut dyn FnMut() -> bool) -> Self {
        Self { size: 0, steps: 0, stop }
    }

    /// The problem grows by so many units.
    pub(super) fn add(&mut self, units: usize) -> Result<(), Unencoded> {
        self.size += units;
        if self.size > MAX_SIZE {
            return Err(Unencoded::TooManyLinks);
        }
        self.look_at(units)
    }

    /// So many things are looked at that need not make the problem grow.
    pub(super) fn look_at(&mut self, count: usize) -> Result<(), Unencoded> {
        self.steps += count;
        if self.steps < STEPS {
            return Ok(());
        }
        self.steps = 0;
        if (self.stop)() { Err(Unencoded::Stopped) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_ends_at_its_limit_and_where_it_is_stopped() {
        let mut looks = 0;
        let mut never = || {
            looks += 1;
            false
        };
        let mut growth = Growth::new(&mut never);
        let orders = (0..MAX_SIZE).take_while(|_| growth.add(ORDER).is_ok()).count();
        assert_eq!(orders, MAX_SIZE / ORDER);
        assert_eq!(growth.add(CLAUSE), Err(Unencoded::TooManyLinks));
        assert_eq!(looks, MAX_SIZE / STEPS);

        let mut at_once = || true;
        let mut growth = Growth::new(&mut at_once);
        let steps = (0..MAX_SIZE).take_while(|_| growth.look_at(1).is_ok()).count();
        assert_eq!(steps, STEPS - 1);
    }
}
