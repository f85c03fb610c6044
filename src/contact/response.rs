//! Contact response: multipliers by Gauss-Seidel over the pairs, Coulomb's law, balances.
//!
//! The forward Lagrange multiplier method (Carpenter, Taylor, Katona, IJNME 32, 1991) enforces the
//! displacement constraint of step n+1 by multipliers of step n. Every pair has its own small block
//! `h^2 G Mhat^-1 G^T`, here written with impulses `h lambda` and velocities: with lumped masses the block is
//! `sum_i w_i^2 / m_i`, and a pair is solved without assembling anything. Passes go forth and back
//! over the pairs in an order taken from their places, not from their numbers.
//!
//! What a pair does about the energy of an impact stands in `impact.rs`: it is taken up in the step that stops
//! the pair and given back in the step that opens it. Both are reckoned with the velocities at the start of the
//! step, where positions and velocities belong to the same moment: the half step's prediction holds half a
//! kick of elastic force already.

use super::constraint::Constraint;
use super::impact::{ImpactStore, rebound_speeds_m_s, share_of_blow};
use glam::DVec3;

/// Passes after which a response that still penetrates gives up.
const MOST_PASSES: u32 = 400;
/// Penetration left by the passes, as a share of the local size, that asks for more of them.
const PENETRATION_LEFT: f64 = 1e-4;

/// Compliance of redundant pairs over their block.
const SOFTNESS: f64 = 0.25;

/// Pairs that say nearly the same settle more slowly than the passes asked for allow: they get this many times as many.
const PATIENCE: u32 = 8;
/// Share of the squared shortfalls that the last step's pattern of impulses may leave.
const GOOD_START: f64 = 0.1;
/// Blows are aimed higher than the rebound, since pairs that open one after the other need more speed
/// for the same energy; what is too much is cut off.
const BLOW_MARGIN: f64 = 1.2;
/// Share of an aimed blow below which its nodes count as obstructed. A free pair takes `1 / BLOW_MARGIN`.
const OBSTRUCTED: f64 = 0.5;

/// A node that takes part in the response.
#[derive(Clone, Copy, Debug)]
pub struct ContactNode {
    /// Body.
    pub body: u32,
    /// Node of the body.
    pub node: u32,
    /// Velocity of the half step, m/s; corrected by the response.
    pub velocity_m_s: DVec3,
    /// Velocity at the start of the step, m/s.
    pub start_velocity_m_s: DVec3,
    /// Inverse mass along x, y, z, 1/kg; zero where the motion is prescribed.
    pub inverse_mass_per_kg: DVec3,
    /// Sum of the contact impulses, N s.
    pub impulse_n_s: DVec3,
}

impl ContactNode {
    /// A node before the response.
    #[must_use]
    pub fn new((body, node): (u32, u32), velocities_m_s: [DVec3; 2], inverse_mass_per_kg: DVec3) -> Self {
        let [start_velocity_m_s, velocity_m_s] = velocities_m_s;
        Self { body, node, velocity_m_s, start_velocity_m_s, inverse_mass_per_kg, impulse_n_s: DVec3::ZERO }
    }
}

/// Parameters of the response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResponseParameters {
    /// Length of the step, s.
    pub step_s: f64,
    /// Gauss-Seidel passes that should do; more are taken while the multipliers still change or a penetration is left.
    pub passes: u32,
    /// Relative change of the multipliers at which the passes stop.
    pub tolerance: f64,
    /// Whether impacts keep their energy until the pair opens.
    pub conserve_impact_energy: bool,
    /// Closing speed below which an impact keeps nothing, m/s.
    pub rest_speed_m_s: f64,
}

/// What the response did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResponseReport {
    /// Passes taken to solve the pairs; where some of them opened with a blow and all were solved again, the
    /// larger number.
    pub passes: u32,
    /// Largest change of a multiplier in the last pass over the largest multiplier.
    pub last_change: f64,
    /// Energy taken from the nodes by friction and impact, J.
    pub dissipated_j: f64,
    /// Work done by nodes whose motion is prescribed, J.
    pub prescribed_work_j: f64,
}

/// The nodes of a set of constraints and where each constraint finds its four.
#[derive(Debug, Default)]
pub struct NodeTable {
    /// Nodes, sorted by body and node.
    pub nodes: Vec<ContactNode>,
    rows: Vec<[usize; 4]>,
    predicted_m_s: Vec<DVec3>,
}

impl NodeTable {
    /// Collects the nodes of the constraints; `state` gives the node of a (body, node).
    #[must_use]
    pub fn new(constraints: &[Constraint], state: impl Fn((u32, u32)) -> ContactNode) -> Self {
        let id = |c: &Constraint, k: usize| (c.bodies[c.nodes[k].0 as usize], c.nodes[k].1);
        let mut ids: Vec<(u32, u32)> =
            constraints.iter().flat_map(|c| (0..4).map(move |k| id(c, k))).collect();
        ids.sort_unstable();
        ids.dedup();
        let rows = constraints
            .iter()
            .map(|c| std::array::from_fn(|k| ids.binary_search(&id(c, k)).unwrap_or_default()))
            .collect();
        let nodes: Vec<ContactNode> = ids.into_iter().map(state).collect();
        let predicted_m_s = nodes.iter().map(|n| n.velocity_m_s).collect();
        Self { nodes, rows, predicted_m_s }
    }

    /// Relative velocity of the half step of a constraint, m/s.
    #[must_use]
    pub fn relative_velocity(&self, row: usize, weights: &[f64; 4]) -> DVec3 {
        self.rows[row].iter().zip(weights).map(|(i, w)| self.nodes[*i].velocity_m_s * *w).sum()
    }

    /// Relative velocity at the start of the step of a constraint, m/s.
    fn relative_start_velocity(&self, row: usize, weights: &[f64; 4]) -> DVec3 {
        self.rows[row].iter().zip(weights).map(|(i, w)| self.nodes[*i].start_velocity_m_s * *w).sum()
    }

    /// Change of the relative velocity of a constraint by the response so far, m/s.
    fn relative_change(&self, row: usize, weights: &[f64; 4]) -> DVec3 {
        let change = |i: usize| self.nodes[i].velocity_m_s - self.predicted_m_s[i];
        self.rows[row].iter().zip(weights).map(|(i, w)| change(*i) * *w).sum()
    }

    /// Velocities before the response, in the order of `nodes`, m/s.
    #[must_use]
    pub fn predicted_m_s(&self) -> &[DVec3] {
        &self.predicted_m_s
    }

    /// Velocity of a node before the response, m/s; `None` for a node that is not in the table.
    #[must_use]
    pub fn predicted_of(&self, id: (u32, u32)) -> Option<DVec3> {
        let at = self.nodes.binary_search_by(|n| (n.body, n.node).cmp(&id)).ok()?;
        Some(self.predicted_m_s[at])
    }

    fn apply(&mut self, row: usize, weights: &[f64; 4], impulse_n_s: DVec3) {
        for (i, w) in self.rows[row].into_iter().zip(weights) {
            let node = &mut self.nodes[i];
            node.impulse_n_s += impulse_n_s * *w;
            node.velocity_m_s += node.inverse_mass_per_kg * impulse_n_s * *w;
        }
    }

    /// Diagonal of the pair's block: `sum_i w_i^2 / m_i` along x, y, z, 1/kg.
    fn block(&self, row: usize, weights: &[f64; 4]) -> DVec3 {
        let rows = self.rows[row].iter().zip(weights);
        rows.map(|(i, w)| self.nodes[*i].inverse_mass_per_kg * (w * w)).sum()
    }

    /// Energy that the impulses took from the nodes and work that prescribed motion did, J.
    ///
    /// The impulse acts at the start of the step, on the velocity of that moment.
    fn balances(&self) -> (f64, f64) {
        let (mut dissipated_j, mut prescribed_j) = (0.0, 0.0);
        for node in &self.nodes {
            let change = node.inverse_mass_per_kg * node.impulse_n_s;
            let work = node.impulse_n_s * (node.start_velocity_m_s + change * 0.5);
            dissipated_j -= work.element_sum();
            let is_prescribed = node.inverse_mass_per_kg.cmpeq(DVec3::ZERO);
            prescribed_j -= DVec3::select(is_prescribed, work, DVec3::ZERO).element_sum();
        }
        (dissipated_j, prescribed_j)
    }
}

/// Puts constraints into an order that depends on where they are, not on how things are numbered.
pub fn sort_by_place(constraints: &mut [Constraint]) {
    constraints.sort_by_cached_key(|c| {
        // Quantised so that round-off does not reorder places that are meant to be level.
        let grid_m = 1e-5 * c.size_m;
        let [x, y, z] = c.place_m.to_array().map(|x| (x / grid_m + 0.377).floor() as i64);
        ([z, y, x], c.bodies, c.feature)
    });
}

/// Solves the constraints: sets their impulses, what they have stored, and the velocities in the table.
///
/// A pass goes forth and back over the pairs. Passes learn from each other (Anderson acceleration, which amounts to
/// conjugate gradients while no pair opens or slips; Zywicz and Puso, IJNME 44, 1999, accelerate in that way), and start from
/// the impulses of the last step or, at an impact, from such as would be exact if all pairs needed the same.
pub fn solve(
    constraints: &mut [Constraint],
    table: &mut NodeTable,
    p: &ResponseParameters,
) -> ResponseReport {
    let rows: Vec<PairRow> =
        constraints.iter().enumerate().filter_map(|(i, c)| PairRow::new(i, c, table)).collect();
    let stored_before_j = stored_j(constraints);
    start(&rows, constraints, table);
    let mut report = settle(&rows, constraints, table, (p, MOST_PASSES));
    if let Some(blow) = p.conserve_impact_energy.then(|| deal_blows(&rows, constraints, table, p)).flatten() {
        report.passes = report.passes.max(blow.passes);
    }
    for row in &rows {
        row.free_of_moment(&constraints[row.index], table);
    }
    if p.conserve_impact_energy {
        store_impacts(&rows, constraints, table, (stored_before_j, p.rest_speed_m_s));
    }
    (report.dissipated_j, report.prescribed_work_j) = table.balances();
    report
}

/// Passes over the pairs until they settle, `most_passes` at most.
fn settle(
    rows: &[PairRow],
    constraints: &mut [Constraint],
    table: &mut NodeTable,
    (p, most_passes): (&ResponseParameters, u32),
) -> ResponseReport {
    let mut report = ResponseReport::default();
    let mut memory = Anderson::default();
    loop {
        let pass = Pass::over(rows, constraints, table);
        report.last_change = pass.relative_change();
        report.passes += 1;
        let is_settled = report.last_change < p.tolerance;
        let is_time = is_settled || report.passes >= p.passes * PATIENCE;
        let is_done =
            is_time && (report.last_change < 1e-12 || !penetrates(rows, constraints, table, p.step_s));
        // The last word has a plain pass, in which every pair obeys its law.
        if is_done || report.passes >= most_passes {
            return report;
        }
        memory.accelerate(rows, constraints, table, pass);
    }
}

/// Aims all pairs of the places that open and have stored an impact at a velocity a little above that of a full
/// rebound. Returns their numbers.
fn aim_blows(rows: &[PairRow], constraints: &mut [Constraint], table: &NodeTable) -> Vec<usize> {
    let speed_m_s = rebound_speeds_m_s(constraints);
    let mut aimed = Vec::new();
    for index in rows.iter().map(|r| r.index).filter(|i| speed_m_s[*i] > 0.0) {
        let c = &mut constraints[index];
        let velocity_m_s = table.relative_velocity(index, &c.weights).dot(c.normal);
        c.target_m_s = velocity_m_s + BLOW_MARGIN * speed_m_s[index];
        aimed.push(index);
    }
    aimed
}

/// Solves again with the blows' targets and takes as much of the blow as gives what the pairs had stored. Where the
/// nodes cannot give way because their neighbours still press, there is no blow yet.
fn deal_blows(
    rows: &[PairRow],
    constraints: &mut [Constraint],
    table: &mut NodeTable,
    p: &ResponseParameters,
) -> Option<ResponseReport> {
    let aimed = aim_blows(rows, constraints, table);
    if aimed.is_empty() {
        return None;
    }
    let nodes = table.nodes.clone();
    let impulses: Vec<DVec3> = constraints.iter().map(|c| c.impulse_n_s).collect();
    // A blow is cut to its energy anyway: the usual passes are enough.
    let report = settle(rows, constraints, table, (p, p.passes));
    let spent_j = aimed.iter().map(|i| constraints[*i].stored.energy_j).sum();
    let (mut work_j, mut square_j) = (0.0, 0.0);
    for (before, after) in nodes.iter().zip(&table.nodes) {
        let impulse = after.impulse_n_s - before.impulse_n_s;
        let made_m_s = after.velocity_m_s - before.velocity_m_s;
        let start_m_s = before.start_velocity_m_s + before.inverse_mass_per_kg * before.impulse_n_s;
        square_j += 0.5 * impulse.dot(made_m_s);
        work_j += impulse.dot(start_m_s + made_m_s * 0.5);
    }
    let mut share = share_of_blow(spent_j, work_j, square_j);
    if share < OBSTRUCTED {
        share = 0.0;
    } else {
        aimed.iter().for_each(|i| constraints[*i].stored = ImpactStore::default());
    }
    for (c, before) in constraints.iter_mut().zip(&impulses) {
        c.impulse_n_s = before.lerp(c.impulse_n_s, share);
    }
    for (node, before) in table.nodes.iter_mut().zip(&nodes) {
        node.impulse_n_s = before.impulse_n_s.lerp(node.impulse_n_s, share);
        node.velocity_m_s = before.velocity_m_s.lerp(node.velocity_m_s, share);
    }
    (share > 0.0).then_some(report)
}

fn stored_j(constraints: &[Constraint]) -> f64 {
    constraints.iter().map(|c| c.stored.energy_j).sum()
}

/// Books what the normal impulses took from the motion with the pairs that took it.
fn store_impacts(
    rows: &[PairRow],
    constraints: &mut [Constraint],
    table: &NodeTable,
    (stored_before_j, rest_speed_m_s): (f64, f64),
) {
    let mut most_j = stored_before_j;
    for row in rows {
        let c = &mut constraints[row.index];
        let normal_n_s = c.impulse_n_s.dot(c.normal);
        if normal_n_s <= 0.0 {
            continue;
        }
        let weights = c.moment_free_weights();
        let before_m_s = table.relative_start_velocity(row.index, &weights).dot(c.normal);
        let after_m_s = before_m_s + table.relative_change(row.index, &weights).dot(c.normal);
        let loss_j = -0.5 * normal_n_s * (before_m_s + after_m_s);
        let share = if c.may_bounce { bounce_share(-before_m_s, rest_speed_m_s) } else { 0.0 };
        c.stored = c.stored.after(loss_j, [-before_m_s, after_m_s], share);
        most_j += loss_j;
    }
    // One pair's gain may be another's loss: all together never keep more than was taken from the motion.
    let left = (most_j.max(0.0) / stored_j(constraints)).min(1.0);
    if left < 1.0 {
        constraints.iter_mut().for_each(|c| c.stored = c.stored.leaked(left));
    }
}

/// What the pairs' relative normal velocities lack of their targets, m/s.
fn shortfalls_m_s(rows: &[PairRow], constraints: &[Constraint], table: &NodeTable) -> Vec<f64> {
    let shortfall = |row: &PairRow| {
        let c = &constraints[row.index];
        c.target_m_s - table.relative_velocity(row.index, &c.weights).dot(c.normal)
    };
    rows.iter().map(shortfall).collect()
}

/// Applies first guesses of the impulses: those of the last step where they fit, else even ones.
fn start(rows: &[PairRow], constraints: &mut [Constraint], table: &mut NodeTable) {
    if !start_as_before(rows, constraints, table) {
        constraints.iter_mut().for_each(|c| c.impulse_n_s = DVec3::ZERO);
        start_evenly(rows, constraints, table);
    }
}

/// Starts from the pattern of the last step's impulses, which the constraints carry, to the scale that fits best.
/// Returns false, with nothing applied, when it does not take away most of what is lacking.
fn start_as_before(rows: &[PairRow], constraints: &mut [Constraint], table: &mut NodeTable) -> bool {
    let lacking = |shortfalls: &[f64], constraints: &[Constraint]| -> f64 {
        // A pair that presses must neither close nor open; others must not close.
        let pressing = |row: &PairRow| constraints[row.index].impulse_n_s != DVec3::ZERO;
        let each = rows.iter().zip(shortfalls);
        each.map(|(row, s)| if pressing(row) { s * s } else { s.max(0.0).powi(2) }).sum()
    };
    if constraints.iter().all(|c| c.impulse_n_s == DVec3::ZERO) {
        return false;
    }
    let before = shortfalls_m_s(rows, constraints, table);
    let saved = table.nodes.clone();
    for row in rows {
        let c = &constraints[row.index];
        table.apply(row.index, &c.weights, c.impulse_n_s);
    }
    let after = shortfalls_m_s(rows, constraints, table);
    let pressing = rows.iter().zip(before.iter().zip(&after));
    let pressing = pressing.filter(|(row, _)| constraints[row.index].impulse_n_s != DVec3::ZERO);
    let (mut along, mut square) = (0.0, 0.0);
    for (_, (b, a)) in pressing {
        along += b * (b - a);
        square += (b - a) * (b - a);
    }
    let scale = if square > 0.0 { (along / square).max(0.0) } else { 0.0 };
    let scaled: Vec<f64> = before.iter().zip(&after).map(|(b, a)| b + (a - b) * scale).collect();
    if lacking(&scaled, constraints) > GOOD_START * lacking(&before, constraints) {
        table.nodes = saved;
        return false;
    }
    for (node, saved) in table.nodes.iter_mut().zip(&saved) {
        node.velocity_m_s = saved.velocity_m_s.lerp(node.velocity_m_s, scale);
        node.impulse_n_s = saved.impulse_n_s.lerp(node.impulse_n_s, scale);
    }
    constraints.iter_mut().for_each(|c| c.impulse_n_s *= scale);
    true
}

/// Applies even first guesses of the normal impulses: each pair's shortfall over the sum of its row, as if its
/// neighbours fell short as much.
fn start_evenly(rows: &[PairRow], constraints: &mut [Constraint], table: &mut NodeTable) {
    let mut short = shortfalls_m_s(rows, constraints, table);
    short.iter_mut().for_each(|s| *s = s.max(0.0));
    let saved: Vec<ContactNode> = table.nodes.clone();
    for (row, _) in rows.iter().zip(&short).filter(|(_, s)| **s > 0.0) {
        let c = &constraints[row.index];
        table.apply(row.index, &c.weights, c.normal);
    }
    let left = shortfalls_m_s(rows, constraints, table);
    table.nodes = saved;
    for ((row, short), left) in rows.iter().zip(&short).zip(left) {
        let c = &mut constraints[row.index];
        // Rows whose neighbours work against them are left to the passes.
        c.impulse_n_s = c.normal * (short / (short - left).max(row.normal_block_per_kg));
        table.apply(row.index, &c.weights, c.impulse_n_s);
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
            if *further != DVec3::ZERO && c.allows(c.impulse_n_s + *further) {
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

fn penetrates(rows: &[PairRow], constraints: &[Constraint], table: &NodeTable, step_s: f64) -> bool {
    rows.iter().filter(|row| row.softness_per_kg == 0.0).any(|row| {
        let c = &constraints[row.index];
        let normal_v = table.relative_velocity(row.index, &c.weights).dot(c.normal);
        let allowed_m = PENETRATION_LEFT * c.size_m - c.gap_m.min(0.0);
        c.gap_m + step_s * normal_v < -allowed_m
    })
}

/// A pair with its block, ready to be solved again and again.
struct PairRow {
    index: usize,
    normal_block_per_kg: f64,
    tangent_block_per_kg: f64,
    /// Compliance of pairs that say nearly the same as others: with it the passes share the load between
    /// them at once instead of passing it to and fro, 1/kg.
    softness_per_kg: f64,
}

impl PairRow {
    /// `None` when neither side can move along the normal.
    fn new(index: usize, constraint: &Constraint, table: &NodeTable) -> Option<Self> {
        let block = table.block(index, &constraint.weights);
        let n = constraint.normal;
        let normal_block_per_kg = n.dot(block * n);
        (normal_block_per_kg > 0.0).then(|| Self {
            index,
            normal_block_per_kg,
            tangent_block_per_kg: block.max_element(),
            softness_per_kg: if constraint.may_bounce { 0.0 } else { SOFTNESS * normal_block_per_kg },
        })
    }

    /// Solves the pair with all others held.
    fn relax(&self, c: &mut Constraint, table: &mut NodeTable) {
        let velocity = table.relative_velocity(self.index, &c.weights);
        let old = c.impulse_n_s;
        let old_normal = old.dot(c.normal);
        let shortfall = c.target_m_s - velocity.dot(c.normal) - self.softness_per_kg * old_normal;
        let block_per_kg = self.normal_block_per_kg + self.softness_per_kg;
        let normal_part = (old_normal + shortfall / block_per_kg).max(0.0);
        let mut tangential = DVec3::ZERO;
        if c.friction_coefficient > 0.0 && normal_part > 0.0 {
            let slip = velocity - c.normal * velocity.dot(c.normal);
            let sticking = (old - c.normal * old_normal) - slip / self.tangent_block_per_kg;
            tangential = sticking.clamp_length_max(c.friction_coefficient * normal_part);
        }
        c.impulse_n_s = c.normal * normal_part + tangential;
        let change = c.impulse_n_s - old;
        if change != DVec3::ZERO {
            table.apply(self.index, &c.weights, change);
        }
    }

    /// Moves the foot of the force so that the pair has no moment (see `constraint.rs`).
    fn free_of_moment(&self, c: &Constraint, table: &mut NodeTable) {
        let weights = c.moment_free_weights();
        if weights != c.weights {
            let change = std::array::from_fn(|i| weights[i] - c.weights[i]);
            table.apply(self.index, &change, c.impulse_n_s);
        }
    }
}

/// Sets the relative normal velocity of the half step that each pair must at least have after the
/// response: the one that brings it to touch at the end of the step.
pub fn set_targets(constraints: &mut [Constraint], table: &NodeTable, p: &ResponseParameters) {
    for (row, c) in constraints.iter_mut().enumerate() {
        let closing_m_s = -table.relative_start_velocity(row, &c.weights).dot(c.normal);
        let mut touch_m_s = -c.gap_m / p.step_s;
        if touch_m_s > 0.0 {
            // A penetration left over is pushed out gently: at once would throw the nodes apart.
            touch_m_s = touch_m_s.min(p.rest_speed_m_s + 0.1 * closing_m_s.abs() + f64::MIN_POSITIVE);
        }
        c.target_m_s = touch_m_s;
    }
}

/// Share of a new impact's energy that is kept: none below the rest speed, all above twice that.
fn bounce_share(closing_m_s: f64, rest_speed_m_s: f64) -> f64 {
    if rest_speed_m_s > 0.0 {
        (closing_m_s / rest_speed_m_s - 1.0).clamp(0.0, 1.0)
    } else if closing_m_s > 0.0 {
        1.0
    } else {
        0.0
    }
}

/// The penalty baseline: a spring between the features of every penetrating pair, with Coulomb friction.
///
/// `stiffness_n_m` in N/m. Returns the energy taken by friction and stored in the springs together: the
/// springs' energy is [`penalty_energy_j`].
pub fn apply_penalty(
    constraints: &mut [Constraint],
    table: &mut NodeTable,
    stiffness_n_m: f64,
    step_s: f64,
) -> ResponseReport {
    for (row, c) in constraints.iter_mut().enumerate().filter(|(_, c)| c.gap_m < 0.0) {
        let normal_part = -c.gap_m * stiffness_n_m * step_s;
        let velocity = table.relative_velocity(row, &c.weights);
        let slip = velocity - c.normal * velocity.dot(c.normal);
        let block = table.block(row, &c.weights).max_element();
        if block <= 0.0 {
            continue;
        }
        let tangential = (-slip / block).clamp_length_max(c.friction_coefficient * normal_part);
        c.impulse_n_s = c.normal * normal_part + tangential;
        let weights = c.moment_free_weights();
        table.apply(row, &weights, c.impulse_n_s);
    }
    let (dissipated_j, prescribed_work_j) = table.balances();
    ResponseReport { passes: 1, dissipated_j, prescribed_work_j, ..ResponseReport::default() }
}

/// Energy in the penalty springs at the start of the step, J.
#[must_use]
pub fn penalty_energy_j(constraints: &[Constraint], stiffness_n_m: f64) -> f64 {
    constraints.iter().map(|c| 0.5 * stiffness_n_m * c.gap_m.min(0.0).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::super::constraint::{Feature, Geometry};
    use super::*;

    const STEP_S: f64 = 1e-3;

    fn parameters(conserve: bool) -> ResponseParameters {
        ResponseParameters {
            step_s: STEP_S,
            passes: 100,
            tolerance: 1e-13,
            conserve_impact_energy: conserve,
            rest_speed_m_s: 0.0,
        }
    }

    /// A node of body 0 above the middle of a triangle of body 1.
    fn pair(gap_m: f64, friction: f64) -> Vec<Constraint> {
        let patch = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let node = DVec3::new(0.3, 0.3, gap_m);
        let g = Geometry::node_on_patch(node, patch).unwrap();
        vec![Constraint {
            bodies: [0, 1],
            feature: Feature::NodeOnPatch { node: 0, triangle: 0 },
            nodes: [(0, 0), (1, 0), (1, 1), (1, 2)],
            weights: g.weights,
            weight_shifts_per_m: g.weight_shifts_per_m,
            normal: g.normal,
            gap_m: g.gap_m,
            place_m: node,
            size_m: 1.0,
            friction_coefficient: friction,
            closing_m_s: 0.0,
            may_bounce: true,
            stored: ImpactStore::default(),
            target_m_s: 0.0,
            impulse_n_s: DVec3::ZERO,
        }]
    }

    fn run(
        c: &mut [Constraint],
        velocity: DVec3,
        patch_inverse_mass: f64,
        conserve: bool,
    ) -> (NodeTable, ResponseReport) {
        let mut table = NodeTable::new(c, |id| match id.0 {
            0 => ContactNode::new(id, [velocity; 2], DVec3::splat(0.5)),
            _ => ContactNode::new(id, [DVec3::ZERO; 2], DVec3::splat(patch_inverse_mass)),
        });
        set_targets(c, &table, &parameters(conserve));
        let report = solve(c, &mut table, &parameters(conserve));
        (table, report)
    }

    fn kinetic(table: &NodeTable) -> f64 {
        let energy = |n: &ContactNode| 0.5 * n.velocity_m_s.length_squared() / n.inverse_mass_per_kg.x;
        table.nodes.iter().filter(|n| n.inverse_mass_per_kg.x > 0.0).map(energy).sum()
    }

    #[test]
    fn an_impact_is_stored_when_it_stops_and_given_back_when_it_opens() {
        let mut c = pair(0.0, 0.0);
        let (table, report) = run(&mut c, DVec3::NEG_Z * 3.0, 0.25, true);
        assert!(table.relative_velocity(0, &c[0].weights).z.abs() < 1e-14);
        assert!((c[0].stored.energy_j - report.dissipated_j).abs() < 1e-14);
        assert!((c[0].stored.energy_j + kinetic(&table) - 9.0).abs() < 1e-12);
        // The same pair as it begins to open.
        let stored = c[0].stored;
        c[0].impulse_n_s = DVec3::ZERO;
        let (table, report) = run(&mut c, DVec3::Z * 0.1, 0.25, true);
        assert!((report.dissipated_j + stored.energy_j).abs() < 1e-12);
        assert!((kinetic(&table) - (0.01 + stored.energy_j)).abs() < 1e-12);
        assert!(!c[0].stored.is_filled());
        let momentum: DVec3 = table.nodes.iter().map(|n| n.impulse_n_s).sum();
        assert!(momentum.length() < 1e-14);
    }

    #[test]
    fn plastic_contact_closes_the_gap_exactly_and_books_the_loss() {
        let mut c = pair(1e-4, 0.0);
        let (table, report) = run(&mut c, DVec3::NEG_Z * 3.0, 0.0, false);
        let end = c[0].gap_m + STEP_S * table.nodes[0].velocity_m_s.z;
        assert!(end.abs() < 1e-18);
        assert!((report.dissipated_j - (9.0 - kinetic(&table))).abs() < 1e-12);
    }

    #[test]
    fn a_leaving_pair_is_never_pulled() {
        let mut c = pair(-1e-9, 0.5);
        let (_, report) = run(&mut c, DVec3::Z, 0.25, true);
        assert_eq!(c[0].impulse_n_s, DVec3::ZERO);
        assert_eq!(report.dissipated_j, 0.0);
    }

    #[test]
    fn friction_sticks_inside_the_cone_and_slides_on_it() {
        let mut sticking = pair(0.0, 0.5);
        let (table, _) = run(&mut sticking, DVec3::new(0.4, 0.0, -1.0), 0.0, false);
        assert!(table.nodes[0].velocity_m_s.length() < 1e-15);
        let mut sliding = pair(0.0, 0.5);
        let (table, report) = run(&mut sliding, DVec3::new(2.0, 0.0, -1.0), 0.0, false);
        assert!((table.nodes[0].velocity_m_s.x - 1.5).abs() < 1e-14);
        let tangential = sliding[0].impulse_n_s.truncate().length();
        assert!((tangential - 0.5 * sliding[0].impulse_n_s.z).abs() < 1e-14);
        assert!(report.dissipated_j > 0.0);
    }

    #[test]
    fn the_same_pair_seen_three_times_converges_to_the_same_motion() {
        let mut once = pair(0.0, 0.3);
        let (expected, _) = run(&mut once, DVec3::new(0.1, 0.2, -1.0), 0.25, true);
        let mut thrice: Vec<Constraint> = (0..3).flat_map(|_| pair(0.0, 0.3)).collect();
        let (table, report) = run(&mut thrice, DVec3::new(0.1, 0.2, -1.0), 0.25, true);
        assert!(report.last_change < 1e-12);
        for (a, b) in table.nodes.iter().zip(&expected.nodes) {
            assert!((a.velocity_m_s - b.velocity_m_s).length() < 1e-12);
        }
    }
}
