//! Gauss-Seidel passes over a group of contact pairs, from a first guess until the multipliers settle.
//!
//! A pass goes forth and back over the pairs. Passes learn from each other (Anderson acceleration, which amounts to
//! conjugate gradients while no pair opens or slips; Zywicz and Puso, IJNME 44, 1999, accelerate in that way). Where they
//! start from stands in `first_guess.rs`, what becomes of a few that stay too deep in `deep.rs`.

use super::constraint::Constraint;
use super::deep::{DepthLimit, Progress};
use super::nodes::{ContactNode, NodeTable, Weighted};
use super::response::{ResponseParameters, Settling};
use glam::DVec3;
use std::borrow::BorrowMut;

/// Mobility along the normal, over that along the freest axis, below which a pair cannot be opened.
const LEAST_BLOCK: f64 = 1e-3;
/// Pairs that say nearly the same settle more slowly than the passes asked for allow: they get this many times as many.
const PATIENCE: u32 = 8;
/// The same where bodies touch themselves. The sides of a crack say the same many times over, so that impulses wander among
/// them for ever while the velocities stand.
const OWN_PATIENCE: u32 = 2;

/// By how much of its own block a pair of one body yields. The sides of a crack may hold each other in both directions: then
/// only the difference of the impulses means anything, and their sum would grow from step to step.
const OWN_YIELD: f64 = 5e-3;

/// Passes over the pairs until they settle, `most_passes` at most.
pub(super) fn settle(
    rows: &mut [PairRow],
    nodes: &mut [ContactNode],
    (p, most_passes): (&ResponseParameters, u32),
) -> Settling {
    let mut settling = Settling::default();
    let mut memory = Anderson::default();
    let is_own = rows.iter().any(PairRow::is_own);
    let patience = if is_own { OWN_PATIENCE } else { PATIENCE };
    let limit = DepthLimit { step_s: p.step_s, is_own };
    let mut progress = Progress::default();
    loop {
        let pass = Pass::over(rows, nodes);
        settling.last_change = pass.relative_change();
        if let Some(change) = settling.changes.get_mut(settling.passes as usize) {
            *change = settling.last_change;
        }
        settling.passes += 1;
        let is_settled = settling.last_change < p.tolerance;
        let is_time = is_settled || settling.passes >= p.passes * patience;
        let is_done = is_time && {
            let excess = limit.largest_excess(rows, nodes);
            settling.last_change < 1e-12 || excess <= 0.0 || progress.has_stalled(excess, is_own)
        };
        // The last word has a plain pass, in which every pair obeys its law.
        if is_done || settling.passes >= most_passes {
            return settling;
        }
        memory.accelerate(rows, nodes, pass);
        if is_time && is_own {
            limit.relax_around_deep(rows, nodes);
        }
    }
}

/// Changes of how many passes are remembered.
const DEPTH: usize = 4;
/// How many times the last change one may go on without a look at the laws of the pairs.
const FURTHEST: f64 = 5.0;

/// What the passes so far tell about the next ones (D. G. Anderson, J. ACM 12, 1965): how their changes depend on the
/// impulses they started from.
#[derive(Default)]
struct Anderson {
    /// Impulses after the last pass, and its change.
    last: Option<(Vec<DVec3>, Vec<DVec3>)>,
    /// Orthonormal differences of changes, and the differences of impulses that belong to them.
    differences: Vec<(Vec<DVec3>, Vec<DVec3>)>,
}

/// One pass over the pairs, forth and back: the impulses after it and their changes.
struct Pass {
    impulses: Vec<DVec3>,
    change: Vec<DVec3>,
}

impl Pass {
    fn over(rows: &mut [PairRow], nodes: &mut [ContactNode]) -> Self {
        let before = impulses(rows);
        relax_forth_and_back(rows, nodes);
        let impulses = impulses(rows);
        let change = difference(&impulses, &before);
        Self { impulses, change }
    }

    /// The largest change over the largest multiplier.
    fn relative_change(&self) -> f64 {
        let largest = |it: &[DVec3]| it.iter().map(|x| x.length()).fold(0.0, f64::max);
        let largest_impulse = largest(&self.impulses);
        if largest_impulse > 0.0 { largest(&self.change) / largest_impulse } else { 0.0 }
    }
}

/// Solves pair by pair, in their order and back.
pub(super) fn relax_forth_and_back(rows: &mut [impl BorrowMut<PairRow>], nodes: &mut [ContactNode]) {
    rows.iter_mut().for_each(|row| row.borrow_mut().relax(nodes));
    rows.iter_mut().rev().for_each(|row| row.borrow_mut().relax(nodes));
}

fn impulses(rows: &[PairRow]) -> Vec<DVec3> {
    rows.iter().map(|row| row.impulse_n_s).collect()
}

impl Anderson {
    /// Goes to where the passes so far promise the smallest change; a pair whose impulse would
    /// pull or leave the friction cone stays, and the next pass sets right what is left.
    fn accelerate(
        &mut self,
        rows: &mut [PairRow],
        nodes: &mut [ContactNode],
        Pass { impulses, change }: Pass,
    ) {
        if let Some((last_impulses, last_change)) = self.last.take() {
            if dot(&change, &change) > dot(&last_change, &last_change) {
                // A pair that opens or slips has changed the law the differences were learnt from.
                self.differences.clear();
            }
            self.learn(difference(&impulses, &last_impulses), difference(&change, &last_change));
        }
        let mut further = vec![DVec3::ZERO; rows.len()];
        for (of_change, of_impulses) in &self.differences {
            let share = dot(of_change, &change);
            further.iter_mut().zip(of_impulses).for_each(|(f, d)| *f -= *d * share);
        }
        let too_far = dot(&further, &further) > FURTHEST * FURTHEST * dot(&change, &change);
        for (row, further) in rows.iter_mut().zip(&further).filter(|_| !too_far) {
            if *further != DVec3::ZERO && row.allows(row.impulse_n_s + *further) {
                row.add(*further, nodes);
            }
        }
        self.last = Some((impulses, change));
    }

    /// Adds a pair of differences, made orthogonal to the ones before.
    fn learn(&mut self, mut of_impulses: Vec<DVec3>, mut of_change: Vec<DVec3>) {
        if self.differences.len() >= DEPTH {
            self.differences.clear();
        }
        let length = dot(&of_change, &of_change).sqrt();
        for (known, its_impulses) in &self.differences {
            let share = dot(known, &of_change);
            of_change.iter_mut().zip(known).for_each(|(d, k)| *d -= *k * share);
            of_impulses.iter_mut().zip(its_impulses).for_each(|(d, k)| *d -= *k * share);
        }
        let left = dot(&of_change, &of_change).sqrt();
        // What is left of a difference that says nothing new is round-off.
        if left > 1e-6 * length {
            of_change.iter_mut().for_each(|d| *d /= left);
            of_impulses.iter_mut().for_each(|d| *d /= left);
            self.differences.push((of_change, of_impulses));
        }
    }
}

fn difference(a: &[DVec3], b: &[DVec3]) -> Vec<DVec3> {
    a.iter().zip(b).map(|(a, b)| *a - *b).collect()
}

fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

/// A pair with its block and its impulse, ready to be solved again and again: what the passes need and no more, since they
/// spend their time in fetching it.
pub(super) struct PairRow {
    /// Number of the constraint.
    pub index: usize,
    pub at: Weighted,
    pub normal: DVec3,
    /// Impulse on the first body, N s.
    pub impulse_n_s: DVec3,
    /// Relative normal velocity that must at least hold, m/s.
    pub target_m_s: f64,
    pub normal_block_per_kg: f64,
    tangent_block_per_kg: f64,
    /// Relative normal velocity that the pair yields for an impulse, 1/kg.
    pub yield_per_kg: f64,
    friction_coefficient: f64,
    /// Whether the impulse is right unless another pair of the group's is not.
    pub is_settled: bool,
    /// Normal impulse from which friction is taken at most, N s.
    most_normal_n_s: f64,
    pub gap_m: f64,
    pub size_m: f64,
}

impl PairRow {
    /// `None` when neither side can move along the normal, be it for round-off in the normal's direction.
    pub fn new(index: usize, c: &Constraint, table: &NodeTable) -> Option<Self> {
        let at = table.weighted(index, c.weights);
        let block = at.block(&table.nodes);
        let normal_block_per_kg = c.normal.dot(block * c.normal);
        let is_own = c.is_own();
        (normal_block_per_kg > LEAST_BLOCK * block.max_element()).then(|| Self {
            index,
            at,
            normal: c.normal,
            impulse_n_s: c.impulse_n_s,
            target_m_s: c.target_m_s,
            normal_block_per_kg,
            tangent_block_per_kg: block.max_element(),
            yield_per_kg: if is_own { OWN_YIELD * normal_block_per_kg } else { 0.0 },
            friction_coefficient: c.friction_coefficient,
            // What impacts have stored changes hands between bodies wherever a pair is added.
            is_settled: c.is_settled && is_own,
            most_normal_n_s: if is_own { c.impulse_n_s.dot(c.normal).max(0.0) } else { f64::INFINITY },
            gap_m: c.gap_m,
            size_m: c.size_m,
        })
    }

    pub fn is_own(&self) -> bool {
        self.yield_per_kg > 0.0
    }

    /// Lets a further impulse act.
    pub fn add(&mut self, impulse_n_s: DVec3, nodes: &mut [ContactNode]) {
        self.impulse_n_s += impulse_n_s;
        self.at.apply(nodes, impulse_n_s);
    }

    /// Whether an impulse pushes and its friction is no larger than it may be.
    fn allows(&self, impulse_n_s: DVec3) -> bool {
        let normal_n_s = impulse_n_s.dot(self.normal);
        let tangential = impulse_n_s - self.normal * normal_n_s;
        let most_n_s = self.friction_coefficient * normal_n_s.min(self.most_normal_n_s);
        normal_n_s >= 0.0 && tangential.length() <= most_n_s + 1e-300
    }

    /// Solves the pair with all others held.
    fn relax(&mut self, nodes: &mut [ContactNode]) {
        let (normal, old) = (self.normal, self.impulse_n_s);
        let velocity = self.at.velocity(nodes);
        let (old_normal, opening_m_s) = (old.dot(normal), velocity.dot(normal));
        let shortfall = self.target_m_s - opening_m_s - self.yield_per_kg * old_normal;
        let block_per_kg = self.normal_block_per_kg + self.yield_per_kg;
        let normal_part = (old_normal + shortfall / block_per_kg).max(0.0);
        let mut tangential = DVec3::ZERO;
        if self.friction_coefficient > 0.0 && normal_part > 0.0 {
            let slip = velocity - normal * opening_m_s;
            let held = old - normal * old_normal;
            let yielding_per_kg = if self.is_own() { OWN_YIELD * self.tangent_block_per_kg } else { 0.0 };
            let sticking =
                held - (slip + held * yielding_per_kg) / (self.tangent_block_per_kg + yielding_per_kg);
            let most_n_s = self.friction_coefficient * normal_part.min(self.most_normal_n_s);
            tangential = sticking.clamp_length_max(most_n_s);
        }
        let change = normal * normal_part + tangential - old;
        if change != DVec3::ZERO {
            self.add(change, nodes);
        }
    }
}

/// Moves the foot of a constraint's force to where its moment-free weights have it (see `constraint.rs`).
pub(super) fn free_of_moment(
    row: &PairRow,
    (c, weights): (&Constraint, &[f64; 4]),
    nodes: &mut [ContactNode],
) {
    if *weights != c.weights {
        let change = std::array::from_fn(|i| weights[i] - c.weights[i]);
        Weighted { weights: change, ..row.at }.apply(nodes, c.impulse_n_s);
    }
}
