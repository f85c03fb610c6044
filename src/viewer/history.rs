//! What the plots show: the balances over time, in bounded memory.

use crate::sim::{RoundOff, Sample};

/// Most rows kept; when they are full, every second one goes.
const MOST_ROWS: usize = 2000;

/// The balances at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Simulated time, s.
    pub time_s: f64,
    /// Kinetic energy, J.
    pub kinetic_j: f64,
    /// Strain energy, J.
    pub strain_j: f64,
    /// Potential energy of gravity relative to the start, J.
    pub potential_j: f64,
    /// Energy dissipated so far, J.
    pub dissipated_j: f64,
    /// Work done on the bodies from outside so far, J.
    pub work_j: f64,
    /// Sum of the four energies less that work: constant when all is well, J.
    pub sum_j: f64,
    /// Contact force, mean since the row before, N.
    pub contact_force_n: f64,
    /// Length of the momentum, kg m/s.
    pub momentum_kg_m_s: f64,
    /// Connected pieces of what deforms.
    pub fragments: f64,
    /// Elastic step of the slowest body, s; 0 when nothing deforms.
    pub stable_step_s: f64,
}

impl Row {
    /// Without values that are nothing but round-off: an axis that is found from them would show them as if they were
    /// something.
    #[must_use]
    pub fn without(self, round_off: &RoundOff) -> Self {
        let clear = |value: f64, least: f64| if value.abs() < least { 0.0 } else { value };
        let energy = |value_j| clear(value_j, round_off.energy_j);
        Self {
            kinetic_j: energy(self.kinetic_j),
            strain_j: energy(self.strain_j),
            potential_j: energy(self.potential_j),
            dissipated_j: energy(self.dissipated_j),
            work_j: energy(self.work_j),
            sum_j: energy(self.sum_j),
            momentum_kg_m_s: clear(self.momentum_kg_m_s, round_off.momentum_kg_m_s),
            ..self
        }
    }

    /// The row of a sample.
    #[must_use]
    pub fn of(sample: &Sample, time_s: f64, contact_force_n: f64, stable_step_s: f64) -> Self {
        Self {
            time_s,
            kinetic_j: sample.kinetic_j,
            strain_j: sample.strain_j,
            potential_j: sample.potential_j,
            dissipated_j: sample.dissipated_j,
            work_j: sample.external_work_j,
            sum_j: sample.balance_j(),
            contact_force_n,
            momentum_kg_m_s: sample.linear_momentum_kg_m_s.length(),
            fragments: sample.fragments as f64,
            stable_step_s: if stable_step_s.is_finite() { stable_step_s } else { 0.0 },
        }
    }
}

/// Rows in the order of time, evenly thinned out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    rows: Vec<Row>,
    /// Of so many rows offered one is kept, as a power of two.
    thinning: u32,
    offered: u64,
}

impl History {
    /// The row nearest to a time, s; of two at the same time the later one.
    #[must_use]
    pub fn row_at(&self, time_s: f64) -> Option<&Row> {
        let after = self.rows.partition_point(|row| row.time_s <= time_s);
        let before = after.checked_sub(1).and_then(|last| self.rows.get(last));
        let next = self.rows.get(after);
        match (before, next) {
            (Some(before), Some(next)) if next.time_s - time_s < time_s - before.time_s => Some(next),
            (before, next) => before.or(next),
        }
    }

    /// The rows.
    #[must_use]
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Offers a row, later than all before.
    pub fn offer(&mut self, row: Row) {
        if self.offered.is_multiple_of(1 << self.thinning) {
            if self.rows.len() >= MOST_ROWS {
                self.thin_out();
            }
            self.rows.push(row);
        }
        self.offered += 1;
    }

    /// Forgets the rows after a time, s.
    pub fn cut_after(&mut self, time_s: f64) {
        self.split_off(time_s);
    }

    /// Takes the rows after a time, s, out.
    pub fn split_off(&mut self, time_s: f64) -> Self {
        let later = self.rows.partition_point(|row| row.time_s <= time_s);
        let rows = self.rows.split_off(later);
        self.offered = (self.rows.len() as u64) << self.thinning;
        Self { offered: (rows.len() as u64) << self.thinning, rows, thinning: self.thinning }
    }

    /// Puts rows behind, later than all before.
    pub fn append(&mut self, later: &Self) {
        self.rows.extend_from_slice(&later.rows);
        self.thinning = self.thinning.max(later.thinning);
        while self.rows.len() > MOST_ROWS {
            self.thin_out();
        }
        self.offered = (self.rows.len() as u64) << self.thinning;
    }

    fn thin_out(&mut self) {
        let mut is_kept = false;
        self.rows.retain(|_| {
            is_kept = !is_kept;
            is_kept
        });
        self.thinning += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_off_is_no_value() {
        let row = Row {
            kinetic_j: 6e-26,
            strain_j: -1e-20,
            sum_j: 3e-9,
            momentum_kg_m_s: 1e-18,
            contact_force_n: 1e-20,
            ..Row::default()
        };
        let row = row.without(&RoundOff { energy_j: 1e-15, momentum_kg_m_s: 1e-9 });
        assert_eq!(row, Row { sum_j: 3e-9, contact_force_n: 1e-20, ..Row::default() });
    }

    #[test]
    fn the_row_of_a_time_is_the_nearest_one() {
        let mut history = History::default();
        assert_eq!(history.row_at(0.0), None);
        for (kinetic_j, time_s) in [(0.0, 1.0), (1.0, 2.0), (2.0, 2.0), (3.0, 4.0)] {
            history.offer(Row { time_s, kinetic_j, ..Row::default() });
        }
        let found =
            [0.0, 1.0, 1.4, 1.6, 2.0, 2.9, 3.1, 9.0].map(|at_s| history.row_at(at_s).unwrap().kinetic_j);
        assert_eq!(found, [0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
    }

    #[test]
    fn memory_is_bounded_and_rows_stay_evenly_spaced() {
        let mut history = History::default();
        for moment in 0..50_000 {
            history.offer(Row { time_s: f64::from(moment), ..Row::default() });
        }
        let rows = history.rows();
        assert!(rows.len() <= MOST_ROWS && rows.len() > MOST_ROWS / 4, "{}", rows.len());
        let gap = rows[1].time_s - rows[0].time_s;
        assert!(rows.windows(2).all(|pair| pair[1].time_s - pair[0].time_s == gap));
        assert_eq!(rows[0].time_s, 0.0);
        assert!(rows[rows.len() - 1].time_s > 50_000.0 - 2.0 * gap);
    }
}
