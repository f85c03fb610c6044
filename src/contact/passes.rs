//! Gauss-Seidel passes over the contact pairs, from a first guess until the multipliers settle.
//!
//! A pass goes forth and back over the pairs. Passes learn from each other (Anderson acceleration, which amounts to
//! conjugate gradients while no pair opens or slips; Zywicz and Puso, IJNME 44, 1999, accelerate in that way). Where they
//! start from stands in `first_guess.rs`.

use super::constraint::Constraint;
use super::nodes::NodeTable;
use super::response::{ResponseParameters, ResponseReport};
use glam::DVec3;

/// Penetration left by the passes, as a share of the local size, that asks for more of them.
const PENETRATION_LEFT: f64 = 1e-4;
/// Penetration within a body up to which no more passes are asked for, as a share of the local size.
const OWN_PENETRATION_LEFT: f64 = 3e-4;
/// Passes after which a response within a body gives up.
const OWN_MOST_PASSES: u32 = 60;
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
    rows: &[PairRow],
    constraints: &mut [Constraint],
    table: &mut NodeTable,
    (p, most_passes): (&ResponseParameters, u32),
) -> ResponseReport {
    let mut report = ResponseReport::default();
    let mut memory = Anderson::default();
    let is_own = rows.iter().any(PairRow::is_own);
    let patience = if is_own { OWN_PATIENCE } else { PATIENCE };
    loop {
        let pass = Pass::over(rows, constraints, table);
        report.last_change = pass.relative_change();
        report.passes += 1;
        let is_settled = report.last_change < p.tolerance;
        let is_time = is_settled || report.passes >= p.passes * patience;
        let is_done = is_time
            && (report.last_change < 1e-12 || !penetrates(rows, constraints, table, (p.step_s, is_own)));
        // The last word has a plain pass, in which every pair obeys its law.
        if is_done || report.passes >= if is_own { most_passes.min(OWN_MOST_PASSES) } else { most_passes } {
            return report;
        }
        memory.accelerate(rows, constraints, table, pass);
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
    fn over(rows: &[PairRow], constraints: &mut [Constraint], table: &mut NodeTable) -> Self {
        let before: Vec<DVec3> = rows.iter().map(|r| constraints[r.index].impulse_n_s).collect();
        for row in rows.iter().chain(rows.iter().rev()) {
            row.relax(&mut constraints[row.index], table);
        }
        let impulses: Vec<DVec3> = rows.iter().map(|r| constraints[r.index].impulse_n_s).collect();
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

impl Anderson {
    /// Goes to where the passes so far promise the smallest change; a pair whose impulse would
    /// pull or leave the friction cone stays, and the next pass sets right what is left.
    fn accelerate(
        &mut self,
        rows: &[PairRow],
        constraints: &mut [Constraint],
        table: &mut NodeTable,
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
        for (row, further) in rows.iter().zip(&further).filter(|_| !too_far) {
            let c = &mut constraints[row.index];
            if *further != DVec3::ZERO && row.allows(c, c.impulse_n_s + *further) {
                c.impulse_n_s += *further;
                table.apply(row.index, &c.weights, *further);
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

/// Whether a pair would end the step too deep. `is_own` where bodies touch themselves, and few passes are taken for granted:
/// there small steps into each other would add up.
fn penetrates(
    rows: &[PairRow],
    constraints: &[Constraint],
    table: &NodeTable,
    (step_s, is_own): (f64, bool),
) -> bool {
    rows.iter().any(|row| {
        let c = &constraints[row.index];
        let normal_v = table.relative_velocity(row.index, &c.weights).dot(c.normal);
        let allowed_m = if is_own {
            (OWN_PENETRATION_LEFT * c.size_m).max(-c.gap_m)
        } else {
            PENETRATION_LEFT * c.size_m - c.gap_m.min(0.0)
        };
        c.gap_m + step_s * normal_v < -allowed_m
    })
}

/// A pair with its block, ready to be solved again and again.
pub(super) struct PairRow {
    pub(super) index: usize,
    pub(super) normal_block_per_kg: f64,
    tangent_block_per_kg: f64,
    /// Relative normal velocity that the pair yields for an impulse, 1/kg.
    pub(super) yield_per_kg: f64,
    /// Normal impulse from which friction is taken at most, N s.
    most_normal_n_s: f64,
}

impl PairRow {
    /// `None` when neither side can move along the normal, be it for round-off in the normal's direction.
    pub(super) fn new(index: usize, constraint: &Constraint, table: &NodeTable) -> Option<Self> {
        let block = table.block(index, &constraint.weights);
        let n = constraint.normal;
        let normal_block_per_kg = n.dot(block * n);
        let is_own = constraint.is_own();
        (normal_block_per_kg > LEAST_BLOCK * block.max_element()).then(|| Self {
            index,
            normal_block_per_kg,
            tangent_block_per_kg: block.max_element(),
            yield_per_kg: if is_own { OWN_YIELD * normal_block_per_kg } else { 0.0 },
            most_normal_n_s: if is_own { constraint.impulse_n_s.dot(n).max(0.0) } else { f64::INFINITY },
        })
    }

    pub(super) fn is_own(&self) -> bool {
        self.yield_per_kg > 0.0
    }

    /// Whether an impulse pushes and its friction is no larger than it may be.
    fn allows(&self, c: &Constraint, impulse_n_s: DVec3) -> bool {
        let most_n_s = c.friction_coefficient * self.most_normal_n_s;
        c.allows(impulse_n_s) && impulse_n_s.reject_from_normalized(c.normal).length() <= most_n_s
    }

    /// Solves the pair with all others held.
    fn relax(&self, c: &mut Constraint, table: &mut NodeTable) {
        let velocity = table.relative_velocity(self.index, &c.weights);
        let old = c.impulse_n_s;
        let old_normal = old.dot(c.normal);
        let shortfall = c.target_m_s - velocity.dot(c.normal) - self.yield_per_kg * old_normal;
        let block_per_kg = self.normal_block_per_kg + self.yield_per_kg;
        let normal_part = (old_normal + shortfall / block_per_kg).max(0.0);
        let mut tangential = DVec3::ZERO;
        if c.friction_coefficient > 0.0 && normal_part > 0.0 {
            let slip = velocity - c.normal * velocity.dot(c.normal);
            let held = old - c.normal * old_normal;
            let yielding_per_kg = if self.is_own() { OWN_YIELD * self.tangent_block_per_kg } else { 0.0 };
            let sticking =
                held - (slip + held * yielding_per_kg) / (self.tangent_block_per_kg + yielding_per_kg);
            tangential =
                sticking.clamp_length_max(c.friction_coefficient * normal_part.min(self.most_normal_n_s));
        }
        c.impulse_n_s = c.normal * normal_part + tangential;
        let change = c.impulse_n_s - old;
        if change != DVec3::ZERO {
            table.apply(self.index, &c.weights, change);
        }
    }

    /// Moves the foot of the force so that the pair has no moment (see `constraint.rs`).
    pub(super) fn free_of_moment(&self, c: &Constraint, table: &mut NodeTable) {
        let weights = c.moment_free_weights();
        if weights != c.weights {
            let change = std::array::from_fn(|i| weights[i] - c.weights[i]);
            table.apply(self.index, &change, c.impulse_n_s);
        }
    }
}
