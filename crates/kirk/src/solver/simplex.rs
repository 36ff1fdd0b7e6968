//! The simplex method for small linear programs whose variables lie between 0 and 1 (Dantzig 1963), on a dense tableau.

/// What the method found: the values of the variables, and what one more unit of each row's limit would be worth.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Optimum {
    pub(super) values: Vec<f64>,
    pub(super) prices: Vec<f64>,
}

/// Less than this is nothing.
const SMALL: f64 = 1e-9;
/// After so many steps what has been found is taken: it is worth something, if not the best.
const MAX_STEPS: usize = 5_000;
/// After so many steps ties are broken so that the method cannot go in a circle (Bland 1977).
const GREEDY_STEPS: usize = 1_000;

/// Makes the sum of `gains` as large as possible where no row's sum is greater than its limit. Limits are not negative.
pub(super) fn maximize(gains: &[f64], rows: &[(Vec<f64>, f64)]) -> Optimum {
    let mut tableau = Tableau::new(gains, rows);
    for step in 0..MAX_STEPS {
        let Some(entering) = tableau.entering(step < GREEDY_STEPS) else { break };
        tableau.step(entering);
    }
    tableau.optimum()
}

/// Columns are the variables, then the slack of each row. A column that is turned represents 1 minus its variable.
struct Tableau {
    num_variables: usize,
    columns: usize,
    /// In row-major order.
    cells: Vec<f64>,
    limits: Vec<f64>,
    gains: Vec<f64>,
    /// Of each row, the column that it gives the value of.
    basis: Vec<usize>,
    is_basic: Vec<bool>,
    is_turned: Vec<bool>,
}

impl Tableau {
    fn new(gains: &[f64], rows: &[(Vec<f64>, f64)]) -> Self {
        let num_variables = gains.len();
        let columns = num_variables + rows.len();
        let mut cells = vec![0.0; columns * rows.len()];
        for (at, (row, _)) in rows.iter().enumerate() {
            cells[at * columns..][..num_variables].copy_from_slice(row);
            cells[at * columns + num_variables + at] = 1.0;
        }
        let mut all_gains = gains.to_vec();
        all_gains.resize(columns, 0.0);
        let mut is_basic = vec![false; num_variables];
        is_basic.resize(columns, true);
        Self {
            num_variables,
            columns,
            cells,
            limits: rows.iter().map(|&(_, limit)| limit).collect(),
            gains: all_gains,
            basis: (num_variables..columns).collect(),
            is_basic,
            is_turned: vec![false; columns],
        }
    }

    fn cell(&self, row: usize, column: usize) -> f64 {
        self.cells[row * self.columns + column]
    }

    /// A column that gains: the one that gains most, or the first.
    fn entering(&self, is_greedy: bool) -> Option<usize> {
        let mut gaining = (0..self.columns).filter(|&at| !self.is_basic[at] && self.gains[at] > SMALL);
        if is_greedy {
            gaining.max_by(|&one, &other| self.gains[one].total_cmp(&self.gains[other]))
        } else {
            gaining.next()
        }
    }

    /// Lets a column grow until it, or what a row gives the value of, comes to its end.
    fn step(&mut self, entering: usize) {
        let mut most = if entering < self.num_variables { 1.0 } else { f64::INFINITY };
        let mut leaving = None;
        for (row, &basic) in self.basis.iter().enumerate() {
            let (cell, value) = (self.cell(row, entering), self.limits[row]);
            let room = if cell > SMALL {
                value / cell
            } else if cell < -SMALL && basic < self.num_variables {
                (1.0 - value) / -cell
            } else {
                continue;
            };
            if room < most {
                (most, leaving) = (room.max(0.0), Some(row));
            }
        }
        let Some(row) = leaving else {
            self.turn(entering);
            return;
        };
        if self.cell(row, entering) < 0.0 {
            self.turn_basic(row);
        }
        self.pivot(row, entering);
    }

    /// A column that is at its one end is told from its other end.
    fn turn(&mut self, column: usize) {
        for row in 0..self.basis.len() {
            let cell = &mut self.cells[row * self.columns + column];
            self.limits[row] -= *cell;
            *cell = -*cell;
        }
        self.gains[column] = -self.gains[column];
        self.is_turned[column] = !self.is_turned[column];
    }

    /// The same for the column that a row gives the value of.
    fn turn_basic(&mut self, row: usize) {
        let basic = self.basis[row];
        for column in 0..self.columns {
            if column != basic {
                let cell = &mut self.cells[row * self.columns + column];
                *cell = -*cell;
            }
        }
        self.limits[row] = 1.0 - self.limits[row];
        self.is_turned[basic] = !self.is_turned[basic];
    }

    fn pivot(&mut self, row: usize, entering: usize) {
        let begin = row * self.columns;
        let scale = 1.0 / self.cells[begin + entering];
        let pivot: Vec<f64> =
            self.cells[begin..begin + self.columns].iter().map(|cell| cell * scale).collect();
        let limit = self.limits[row] * scale;
        self.cells[begin..begin + self.columns].copy_from_slice(&pivot);
        self.limits[row] = limit;
        for other in (0..self.basis.len()).filter(|&other| other != row) {
            let factor = self.cell(other, entering);
            if factor != 0.0 {
                let cells = &mut self.cells[other * self.columns..][..self.columns];
                cells.iter_mut().zip(&pivot).for_each(|(cell, pivot)| *cell -= factor * pivot);
                self.limits[other] -= factor * limit;
            }
        }
        let factor = self.gains[entering];
        self.gains.iter_mut().zip(&pivot).for_each(|(gain, pivot)| *gain -= factor * pivot);
        self.is_basic[self.basis[row]] = false;
        self.is_basic[entering] = true;
        self.basis[row] = entering;
    }

    fn optimum(&self) -> Optimum {
        let mut values = vec![0.0; self.columns];
        for (&column, &value) in self.basis.iter().zip(&self.limits) {
            values[column] = value;
        }
        for (value, _) in values.iter_mut().zip(&self.is_turned).filter(|(_, is_turned)| **is_turned) {
            *value = 1.0 - *value;
        }
        values.truncate(self.num_variables);
        let prices = self.gains[self.num_variables..].iter().map(|gain| (-gain).max(0.0)).collect();
        Optimum { values, prices }
    }
}

#[cfg(test)]
mod tests {
    use super::maximize;
    use tpn::generate::Rng;

    #[test]
    fn a_knapsack_takes_what_is_worth_most_for_its_weight_and_a_part_of_the_next() {
        let found = maximize(&[6.0, 10.0, 12.0], &[(vec![1.0, 2.0, 3.0], 5.0)]);
        for (value, expected) in found.values.iter().zip([1.0, 1.0, 2.0 / 3.0]) {
            assert!((value - expected).abs() < 1e-9, "{:?}", found.values);
        }
        assert!((found.prices[0] - 4.0).abs() < 1e-9, "{:?}", found.prices);
    }

    #[test]
    fn values_are_allowed_and_no_better_than_what_prices_prove() {
        let mut random = Rng::new(7);
        for case in 0..300 {
            let (columns, count) = (random.between(1, 20) as usize, random.between(1, 8) as usize);
            let mut numbers = |count: usize, least: i64, most: i64| -> Vec<f64> {
                (0..count).map(|_| random.between(least, most) as f64).collect()
            };
            let gains = numbers(columns, -5, 20);
            let rows: Vec<(Vec<f64>, f64)> =
                (0..count).map(|_| (numbers(columns, -4, 12), numbers(1, 0, 40)[0])).collect();
            let found = maximize(&gains, &rows);
            let sum = |weights: &[f64]| weights.iter().zip(&found.values).map(|(a, b)| a * b).sum::<f64>();
            for (row, limit) in &rows {
                assert!(sum(row) <= limit + 1e-6, "case {case}: {row:?} is {} of {limit}", sum(row));
            }
            assert!(found.values.iter().all(|value| (-1e-9..=1.0 + 1e-9).contains(value)), "case {case}");
            let priced: f64 = rows.iter().zip(&found.prices).map(|((_, limit), price)| price * limit).sum();
            let left = |column: usize| {
                let taken: f64 =
                    rows.iter().zip(&found.prices).map(|((row, _), price)| price * row[column]).sum();
                (gains[column] - taken).max(0.0)
            };
            let proven = priced + (0..columns).map(left).sum::<f64>();
            assert!((sum(&gains) - proven).abs() < 1e-6, "case {case}: {} and {proven}", sum(&gains));
        }
    }
}
