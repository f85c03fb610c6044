//! The impulses that the Gauss-Seidel passes start from.
//!
//! Pairs that pressed in the last step most likely press in this one, and one step changes their impulses little. As long
//! as the set of pressing pairs is known, their normal impulses obey linear equations, which conjugate gradients solve in
//! few iterations from the impulses of the last step, without assembling anything. The set is put right in a few rounds:
//! pairs that would pull leave, pairs that would close enter. The passes have the last word, on friction in particular.

use super::nodes::ContactNode;
use super::passes::PairRow;
use glam::DVec3;

/// Rounds in which the set of pressing pairs may change.
const ROUNDS: u32 = 16;
/// Rounds in which all pairs that should leave or enter the set do so at once.
const ROUNDS_TOGETHER: u32 = 4;
/// Iterations of conjugate gradients in one round.
const ITERATIONS: u32 = 40;
/// Change of an impulse, over the largest impulse, that a round may leave.
const TOLERANCE: f64 = 1e-5;

/// Applies first guesses of the impulses. The rows carry those of the last step.
pub(super) fn start(rows: &mut [PairRow], nodes: &mut [ContactNode]) {
    // Within a body pairs that say the same are many, and which of them press changes from step to step: the passes find
    // out sooner.
    if !rows.iter().any(PairRow::is_own) {
        set_right(rows, nodes);
    }
    rows.iter_mut().for_each(|row| row.at.apply(nodes, row.impulse_n_s));
}

/// Makes the impulses of the last step suit this one.
fn set_right(rows: &mut [PairRow], nodes: &[ContactNode]) {
    let mut guess = Guess::new(rows, nodes);
    guess.find_pressing();
    let normal_n_s = guess.normal_n_s;
    for (row, normal_n_s) in rows.iter_mut().zip(normal_n_s) {
        let last = row.impulse_n_s;
        let last_normal_n_s = last.dot(row.normal);
        row.impulse_n_s = row.normal * normal_n_s;
        if last_normal_n_s > 0.0 {
            // Friction grows and shrinks with the pressure.
            row.impulse_n_s += (last - row.normal * last_normal_n_s) * (normal_n_s / last_normal_n_s);
        }
    }
}

/// Normal impulses and what they leave.
struct Guess<'a> {
    rows: &'a [PairRow],
    nodes: &'a [ContactNode],
    /// Normal impulse of each pair, N s.
    normal_n_s: Vec<f64>,
    /// What the relative normal velocity of each pair lacks of its target with these impulses, m/s.
    shortfall_m_s: Vec<f64>,
    presses: Vec<bool>,
    /// Changes of node velocities, in the order of the table, m/s.
    change_m_s: Vec<DVec3>,
}

impl<'a> Guess<'a> {
    fn new(rows: &'a [PairRow], nodes: &'a [ContactNode]) -> Self {
        let shortfall = |row: &PairRow| row.target_m_s - row.at.velocity(nodes).dot(row.normal);
        let normal = |row: &PairRow| row.impulse_n_s.dot(row.normal).max(0.0);
        let mut guess = Self {
            rows,
            nodes,
            normal_n_s: rows.iter().map(normal).collect(),
            shortfall_m_s: rows.iter().map(shortfall).collect(),
            presses: Vec::new(),
            change_m_s: vec![DVec3::ZERO; nodes.len()],
        };
        guess.presses = guess.normal_n_s.iter().map(|x| *x > 0.0).collect();
        if guess.presses.contains(&true) {
            let response = guess.response(&guess.normal_n_s.clone());
            guess.shortfall_m_s.iter_mut().zip(response).for_each(|(s, r)| *s -= r);
        } else {
            guess.presses = guess.shortfall_m_s.iter().map(|s| *s > 0.0).collect();
        }
        guess
    }

    /// Change of the pairs' relative normal velocities by normal impulses, m/s.
    fn response(&mut self, normal_n_s: &[f64]) -> Vec<f64> {
        self.change_m_s.fill(DVec3::ZERO);
        for (row, x) in self.rows.iter().zip(normal_n_s).filter(|(_, x)| **x != 0.0) {
            row.at.add_change(self.nodes, &mut self.change_m_s, row.normal * *x);
        }
        let response = |(row, x): (&PairRow, &f64)| {
            row.at.sum(|i| self.change_m_s[i]).dot(row.normal) + row.yield_per_kg * x
        };
        self.rows.iter().zip(normal_n_s).map(response).collect()
    }

    /// Solves for the pressing pairs and mends their set until it no longer changes.
    fn find_pressing(&mut self) {
        for round in 0..ROUNDS {
            self.solve();
            let most_n_s = self.most_n_s();
            let pulling = self.strongest(round, |guess, i| -guess.normal_n_s[i]);
            if !pulling.is_empty() {
                self.let_go(&pulling);
                continue;
            }
            let closing = self.strongest(round, |guess, i| {
                let change_n_s = guess.shortfall_m_s[i] / guess.rows[i].normal_block_per_kg;
                if guess.presses[i] { 0.0 } else { change_n_s - 2.0 * TOLERANCE * most_n_s }
            });
            if closing.is_empty() {
                return;
            }
            closing.into_iter().for_each(|i| self.presses[i] = true);
        }
        let pulling = self.strongest(0, |guess, i| -guess.normal_n_s[i]);
        self.let_go(&pulling);
    }

    /// The pairs with positive `excess`. After the first rounds only the one with the largest: pairs that say nearly the
    /// same would otherwise leave and enter together for ever.
    fn strongest(&self, round: u32, excess: impl Fn(&Self, usize) -> f64) -> Vec<usize> {
        let found = (0..self.rows.len()).filter(|i| excess(self, *i) > 0.0);
        if round < ROUNDS_TOGETHER {
            return found.collect();
        }
        found.max_by(|a, b| excess(self, *a).total_cmp(&excess(self, *b))).into_iter().collect()
    }

    /// Takes pairs out of the set, and their impulses back.
    fn let_go(&mut self, pairs: &[usize]) {
        let mut taken_n_s = vec![0.0; self.rows.len()];
        for i in pairs {
            taken_n_s[*i] = std::mem::take(&mut self.normal_n_s[*i]);
            self.presses[*i] = false;
        }
        let response = self.response(&taken_n_s);
        self.shortfall_m_s.iter_mut().zip(response).for_each(|(s, r)| *s += r);
    }

    fn most_n_s(&self) -> f64 {
        self.normal_n_s.iter().fold(0.0, |most, x| most.max(x.abs()))
    }

    /// Residual of a pressing pair as a change of its impulse, N s; zero for others.
    fn preconditioned(&self) -> Vec<f64> {
        let change = |i: usize| self.shortfall_m_s[i] / self.rows[i].normal_block_per_kg;
        let each = |i| if self.presses[i] { change(i) } else { 0.0 };
        (0..self.rows.len()).map(each).collect()
    }

    /// Conjugate gradients for the pressing pairs.
    fn solve(&mut self) {
        let mut z = self.preconditioned();
        let mut direction = z.clone();
        let mut energy_j = self.work_j(&z);
        for _ in 0..ITERATIONS {
            let largest_n_s = z.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            if largest_n_s <= TOLERANCE * self.most_n_s() {
                return;
            }
            let response = self.response(&direction);
            let curvature: f64 = direction.iter().zip(&response).map(|(d, r)| d * r).sum();
            if curvature <= 0.0 {
                return;
            }
            let length = energy_j / curvature;
            self.normal_n_s.iter_mut().zip(&direction).for_each(|(x, d)| *x += length * d);
            self.shortfall_m_s.iter_mut().zip(&response).for_each(|(s, r)| *s -= length * r);
            z = self.preconditioned();
            let next_j = self.work_j(&z);
            let keep = next_j / energy_j;
            direction.iter_mut().zip(&z).for_each(|(d, z)| *d = z + keep * *d);
            energy_j = next_j;
        }
    }

    fn work_j(&self, z: &[f64]) -> f64 {
        z.iter().zip(&self.shortfall_m_s).map(|(z, s)| z * s).sum()
    }
}
