//! What the plots show: the balances over time, in bounded memory.

use crate::sim::Sample;

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
    /// Sum of the above less the work done on the bodies: constant when all is well, J.
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
    /// The row of a sample.
    #[must_use]
    pub fn of(sample: &Sample, time_s: f64, contact_force_n: f64, stable_step_s: f64) -> Self {
        Self {
            time_s,
            kinetic_j: sample.kinetic_j,
            strain_j: sample.strain_j,
            potential_j: sample.potential_j,
            dissipated_j: sample.dissipated_j,
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
        self.rows.retain(|row| row.time_s <= time_s);
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
