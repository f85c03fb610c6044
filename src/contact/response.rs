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

use super::constraint::{Constraint, Feature};
use super::deep::OWN_TOO_DEEP;
use super::first_guess::start;
use super::groups::solve_by_group;
use super::impact::{ImpactStore, rebound_speeds_m_s, share_of_blow};
use super::nodes::NodeTable;
use super::passes::{PairRow, free_of_moment, settle};
use crate::math::in_parts;
use glam::DVec3;

/// Passes after which a response that still penetrates gives up.
const MOST_PASSES: u32 = 400;

/// Blows are aimed higher than the rebound, since pairs that open one after the other need more speed
/// for the same energy; what is too much is cut off.
const BLOW_MARGIN: f64 = 1.2;
/// Share of an aimed blow below which its nodes count as obstructed. A free pair takes `1 / BLOW_MARGIN`.
const OBSTRUCTED: f64 = 0.5;

/// Penetration, as a share of the local size, that is not pushed out between features of one body. The sides of a crack may
/// interlock, so that one pair's way out is another's way in.
const OWN_SLACK: f64 = 1e-4;
/// Share of what is deeper that one step pushes out there, where that is no faster than what counts as rest.
const OWN_PUSH: f64 = 0.25;
/// Share of what is deeper than [`OWN_TOO_DEEP`] that one step pushes out however fast that is. Pairs within a body yield under their load (see
/// `passes.rs`), and where that is faster than what counts as rest, as it may be without gravity, they would sink on and on.
const OWN_LEAST_PUSH: f64 = 0.01;

/// Pairs of which one task makes rows.
const ROWS_AT_ONCE: usize = 512;

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

/// Passes whose changes are reported one by one.
pub const CHANGES_KEPT: usize = 12;

/// How the multipliers settled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settling {
    /// Passes taken to solve the group of pairs that needed most; where some of them opened with a blow and all were
    /// solved again, the larger number.
    pub passes: u32,
    /// Largest change of a multiplier in the last pass over the largest multiplier of its group; without the passes of a blow,
    /// which is cut to its energy.
    pub last_change: f64,
    /// The same after each of the first passes; 0 after the last.
    pub changes: [f64; CHANGES_KEPT],
}

impl Settling {
    /// Takes over what settled worse elsewhere, value by value.
    pub fn include(&mut self, other: &Self) {
        self.passes = self.passes.max(other.passes);
        self.last_change = self.last_change.max(other.last_change);
        for (worst, change) in self.changes.iter_mut().zip(other.changes) {
            *worst = worst.max(change);
        }
    }
}

/// What the response did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResponseReport {
    /// How the passes went, of the worst group of pairs.
    pub settling: Settling,
    /// Energy taken from the nodes by friction and impact, J.
    pub dissipated_j: f64,
    /// Work done by nodes whose motion is prescribed, J.
    pub prescribed_work_j: f64,
}

/// Puts constraints into an order that depends on where they are, not on how things are numbered.
pub fn sort_by_place(constraints: &mut [Constraint]) {
    constraints.sort_by_cached_key(order_by_place);
}

/// Adds constraints, in any order, to some that are sorted by place, and keeps those so.
pub fn merge_by_place(sorted: &mut Vec<Constraint>, mut added: Vec<Constraint>) {
    sort_by_place(&mut added);
    let before = std::mem::replace(sorted, Vec::with_capacity(sorted.len() + added.len()));
    let mut added = added.into_iter().map(|c| (order_by_place(&c), c)).peekable();
    for c in before {
        let order = order_by_place(&c);
        while let Some((_, first)) = added.next_if(|(of_added, _)| *of_added < order) {
            sorted.push(first);
        }
        sorted.push(c);
    }
    sorted.extend(added.map(|(_, c)| c));
}

fn order_by_place(c: &Constraint) -> ([i64; 3], [u32; 2], Feature) {
    // Quantised so that round-off does not reorder places that are meant to be level.
    let grid_m = 1e-5 * c.size_m;
    let [x, y, z] = c.place_m.to_array().map(|x| (x / grid_m + 0.377).floor() as i64);
    ([z, y, x], c.bodies, c.feature)
}

/// Solves the constraints: sets their impulses, what they have stored, and the velocities in the table.
///
/// `passes.rs` says how the passes go; the impulses that the constraints carry are their first guess, or the solution
/// where all of a group within a body are settled.
pub fn solve(
    constraints: &mut [Constraint],
    table: &mut NodeTable,
    p: &ResponseParameters,
) -> ResponseReport {
    let mut rows = in_parts::filter_map(constraints, ROWS_AT_ONCE, |i, c| PairRow::new(i, c, table));
    let stored_before_j = stored_j(constraints);
    let mut settling = solve_by_group(&mut rows, &mut table.nodes, |rows, nodes| {
        if rows.iter().all(|row| row.is_settled) {
            rows.iter().for_each(|row| row.at.apply(nodes, row.impulse_n_s));
            return Settling::default();
        }
        start(rows, nodes);
        settle(rows, nodes, (p, MOST_PASSES))
    });
    constraints.iter_mut().for_each(|c| c.is_settled = true);
    write_impulses(&rows, constraints);
    if let Some(blow) =
        p.conserve_impact_energy.then(|| deal_blows(&mut rows, constraints, table, p)).flatten()
    {
        settling.passes = settling.passes.max(blow.passes);
    }
    let weights = in_parts::map(constraints, ROWS_AT_ONCE, Constraint::moment_free_weights);
    for row in &rows {
        free_of_moment(row, (&constraints[row.index], &weights[row.index]), &mut table.nodes);
    }
    if p.conserve_impact_energy {
        store_impacts(&rows, (constraints, &weights), table, (stored_before_j, p.rest_speed_m_s));
    }
    let (dissipated_j, prescribed_work_j) = table.balances(constraints, &weights);
    ResponseReport { settling, dissipated_j, prescribed_work_j }
}

/// A constraint without a row cannot be opened: it has no impulse.
fn write_impulses(rows: &[PairRow], constraints: &mut [Constraint]) {
    constraints.iter_mut().for_each(|c| c.impulse_n_s = DVec3::ZERO);
    rows.iter().for_each(|row| constraints[row.index].impulse_n_s = row.impulse_n_s);
}

/// Aims all pairs of the places that open and have stored an impact at a velocity a little above that of a full
/// rebound. Returns the numbers of the constraints.
fn aim_blows(rows: &mut [PairRow], constraints: &[Constraint], table: &NodeTable) -> Vec<usize> {
    let speed_m_s = rebound_speeds_m_s(constraints);
    let mut aimed = Vec::new();
    for row in rows.iter_mut().filter(|row| speed_m_s[row.index] > 0.0) {
        let velocity_m_s = row.at.velocity(&table.nodes).dot(row.normal);
        row.target_m_s = velocity_m_s + BLOW_MARGIN * speed_m_s[row.index];
        aimed.push(row.index);
    }
    aimed
}

/// Solves again with the blows' targets and takes as much of the blow as gives what the pairs had stored. Where the
/// nodes cannot give way because their neighbours still press, there is no blow yet.
fn deal_blows(
    rows: &mut [PairRow],
    constraints: &mut [Constraint],
    table: &mut NodeTable,
    p: &ResponseParameters,
) -> Option<Settling> {
    let aimed = aim_blows(rows, constraints, table);
    if aimed.is_empty() {
        return None;
    }
    let before_m_s: Vec<DVec3> = table.nodes.iter().map(|node| node.velocity_m_s).collect();
    let impulses: Vec<DVec3> = rows.iter().map(|row| row.impulse_n_s).collect();
    // A blow is cut to its energy anyway: the usual passes are enough.
    let mut is_aimed = vec![false; constraints.len()];
    aimed.iter().for_each(|i| is_aimed[*i] = true);
    let settling = solve_by_group(rows, &mut table.nodes, |rows, nodes| {
        if !rows.iter().any(|row| is_aimed[row.index]) {
            return Settling::default();
        }
        settle(rows, nodes, (p, p.passes))
    });
    let spent_j = aimed.iter().map(|i| constraints[*i].stored.energy_j).sum();
    let (mut work_j, mut square_j) = (0.0, 0.0);
    let predicted_m_s = table.predicted_m_s();
    // Only the normal parts: friction's work on what slides would hide that of the blow, which then were not cut.
    for (row, before) in rows.iter().zip(&impulses) {
        let impulse_n_s = (row.impulse_n_s - *before).dot(row.normal);
        let made = row.at.sum(|i| table.nodes[i].velocity_m_s - before_m_s[i]);
        let start = row.at.sum(|i| table.nodes[i].start_velocity_m_s + before_m_s[i] - predicted_m_s[i]);
        let (made_m_s, start_m_s) = (made.dot(row.normal), start.dot(row.normal));
        square_j += 0.5 * impulse_n_s * made_m_s;
        work_j += impulse_n_s * (start_m_s + made_m_s * 0.5);
    }
    let mut share = share_of_blow(spent_j, work_j, square_j);
    if share < OBSTRUCTED {
        share = 0.0;
    } else {
        aimed.iter().for_each(|i| constraints[*i].stored = ImpactStore::default());
    }
    for (row, before) in rows.iter_mut().zip(&impulses) {
        row.impulse_n_s = before.lerp(row.impulse_n_s, share);
    }
    for (node, before) in table.nodes.iter_mut().zip(&before_m_s) {
        node.velocity_m_s = before.lerp(node.velocity_m_s, share);
    }
    write_impulses(rows, constraints);
    (share > 0.0).then_some(settling)
}

fn stored_j(constraints: &[Constraint]) -> f64 {
    constraints.iter().map(|c| c.stored.energy_j).sum()
}

/// Books what the normal impulses took from the motion with the pairs that took it.
fn store_impacts(
    rows: &[PairRow],
    (constraints, weights): (&mut [Constraint], &[[f64; 4]]),
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
        let weights = &weights[row.index];
        let before_m_s = table.relative_start_velocity(row.index, weights).dot(c.normal);
        let after_m_s = before_m_s + table.relative_change(row.index, weights).dot(c.normal);
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

/// Sets the relative normal velocity of the half step that each pair must at least have after the
/// response: the one that brings it to touch at the end of the step.
pub fn set_targets(constraints: &mut [Constraint], table: &NodeTable, p: &ResponseParameters) {
    for (row, c) in constraints.iter_mut().enumerate() {
        let closing_m_s = -table.relative_start_velocity(row, &c.weights).dot(c.normal);
        let mut touch_m_s = -c.gap_m / p.step_s;
        let mut gentle_m_s = p.rest_speed_m_s;
        if touch_m_s > 0.0 && c.is_own() {
            let beyond_m_s = |depth: f64| (touch_m_s - depth * c.size_m / p.step_s).max(0.0);
            gentle_m_s = gentle_m_s.max(OWN_LEAST_PUSH * beyond_m_s(OWN_TOO_DEEP));
            touch_m_s = OWN_PUSH * beyond_m_s(OWN_SLACK);
        }
        if touch_m_s > 0.0 {
            // A penetration left over is pushed out gently: at once would throw the nodes apart.
            touch_m_s = touch_m_s.min(gentle_m_s + 0.1 * closing_m_s.abs() + f64::MIN_POSITIVE);
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
        let block = table.weighted(row, c.weights).block(&table.nodes).max_element();
        if block <= 0.0 {
            continue;
        }
        let tangential = (-slip / block).clamp_length_max(c.friction_coefficient * normal_part);
        c.impulse_n_s = c.normal * normal_part + tangential;
        table.weighted(row, c.moment_free_weights()).apply(&mut table.nodes, c.impulse_n_s);
    }
    let weights: Vec<[f64; 4]> = constraints.iter().map(Constraint::moment_free_weights).collect();
    let (dissipated_j, prescribed_work_j) = table.balances(constraints, &weights);
    let settling = Settling { passes: 1, ..Settling::default() };
    ResponseReport { settling, dissipated_j, prescribed_work_j }
}

/// Energy in the penalty springs at the start of the step, J.
#[must_use]
pub fn penalty_energy_j(constraints: &[Constraint], stiffness_n_m: f64) -> f64 {
    constraints.iter().map(|c| 0.5 * stiffness_n_m * c.gap_m.min(0.0).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::super::constraint::Geometry;
    use super::super::nodes::ContactNode;
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
        let feature = Feature::NodeOnPatch { node: 0, triangle: 0 };
        vec![Constraint {
            nodes: [(0, 0), (1, 0), (1, 1), (1, 2)],
            weights: g.weights,
            weight_shifts_per_m: feature.weight_shifts_per_m([node, patch[0], patch[1], patch[2]], g.normal),
            normal: g.normal,
            gap_m: g.gap_m,
            place_m: node,
            friction_coefficient: friction,
            ..Constraint::blank(feature)
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
    fn what_is_merged_lies_as_if_all_had_been_sorted() {
        let at = |i: u32| Constraint {
            place_m: DVec3::new(f64::from(i * 7 % 5), f64::from(i * 3 % 4), f64::from(i * 5 % 3)),
            ..Constraint::blank(Feature::NodeOnPatch { node: i, triangle: 0 })
        };
        let mut all: Vec<Constraint> = (0..60).map(at).collect();
        let mut merged = Vec::new();
        for part in [&all[..23], &all[23..24], &[], &all[24..]] {
            merge_by_place(&mut merged, part.to_vec());
        }
        sort_by_place(&mut all);
        assert!(merged.iter().map(|c| c.feature).eq(all.iter().map(|c| c.feature)));
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
        let change = |(i, n): (usize, &ContactNode)| table.change_m_s(i) / n.inverse_mass_per_kg;
        let momentum: DVec3 = table.nodes.iter().enumerate().map(change).sum();
        assert!(momentum.length() < 1e-14);
    }

    #[test]
    fn a_blow_that_slides_gives_back_no_more_than_one_that_does_not() {
        let mut c = pair(0.0, 0.2);
        run(&mut c, DVec3::NEG_Z * 3.0, 0.25, true);
        let stored_j = c[0].stored.energy_j;
        c[0].impulse_n_s = DVec3::ZERO;
        let (table, _) = run(&mut c, DVec3::new(20.0, 0.0, 0.1), 0.25, true);
        let along_normal = |n: &ContactNode| 0.5 * n.velocity_m_s.z.powi(2) / n.inverse_mass_per_kg.z;
        let kept_j = table.nodes.iter().map(along_normal).sum::<f64>();
        assert!((kept_j - (0.01 + stored_j)).abs() < 1e-12, "{kept_j} {stored_j}");
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
    fn a_pair_of_one_body_bears_a_load_without_sinking() {
        const LOAD_N_S: f64 = 0.5;
        let mut c = pair(0.0, 0.0);
        c[0].bodies = [0, 0];
        c[0].nodes = std::array::from_fn(|i| (0, i as u32));
        let mut speed_m_s = 0.0;
        let mut deepest_m = 0.0_f64;
        for _ in 0..4000 {
            c[0].is_settled = false;
            // The node itself does not fly at the patch: others push it.
            let speeds_m_s = [speed_m_s, speed_m_s - 0.5 * LOAD_N_S].map(|v| DVec3::Z * v);
            let mut table = NodeTable::new(&c, |id| match id.1 {
                0 => ContactNode::new(id, speeds_m_s, DVec3::splat(0.5)),
                _ => ContactNode::new(id, [DVec3::ZERO; 2], DVec3::ZERO),
            });
            set_targets(&mut c, &table, &parameters(true));
            solve(&mut c, &mut table, &parameters(true));
            speed_m_s = table.nodes[0].velocity_m_s.z;
            c[0].gap_m += STEP_S * speed_m_s;
            deepest_m = deepest_m.max(-c[0].gap_m);
        }
        assert!((c[0].impulse_n_s.z - LOAD_N_S).abs() < 0.01 * LOAD_N_S, "{}", c[0].impulse_n_s);
        assert!(deepest_m < 1.5e-3, "{deepest_m}");
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
    fn a_settled_group_stays_and_one_that_a_pair_joins_is_solved_anew() {
        let own = |first_node: u32, gap_m: f64| {
            let mut c = pair(gap_m, 0.3).remove(0);
            c.bodies = [0, 0];
            c.nodes = std::array::from_fn(|i| (0, first_node + i as u32));
            c.feature = Feature::NodeOnPatch { node: first_node, triangle: first_node };
            c
        };
        let table_of = |c: &[Constraint]| {
            NodeTable::new(c, |id| {
                let falls = if id.1 % 4 == 0 { DVec3::new(0.3, 0.0, -2.0) } else { DVec3::ZERO };
                ContactNode::new(id, [falls; 2], DVec3::splat(0.5))
            })
        };
        let solve_all = |c: &mut Vec<Constraint>| {
            let mut table = table_of(c);
            set_targets(c, &table, &parameters(true));
            let report = solve(c, &mut table, &parameters(true));
            (table, report)
        };
        let mut c = vec![own(0, 0.0), own(4, 0.0)];
        solve_all(&mut c);
        let alone = c.clone();
        // Another node comes down on the second patch, harder.
        let mut added = own(8, -1e-5);
        added.nodes = [(0, 8), (0, 5), (0, 6), (0, 7)];
        c.push(added);
        let (table, report) = solve_all(&mut c);
        assert_eq!(c[0].impulse_n_s, alone[0].impulse_n_s);
        assert_ne!(c[1].impulse_n_s, alone[1].impulse_n_s);
        assert!(report.settling.passes > 1);
        for (row, c) in c.iter().enumerate() {
            let opening_m_s = table.relative_velocity(row, &c.weights).dot(c.normal);
            let yields_m_s = 0.01 * c.impulse_n_s.length();
            assert!((opening_m_s - c.target_m_s).abs() < yields_m_s, "{row}: {opening_m_s}");
        }
    }

    #[test]
    fn nodes_held_along_the_normal_are_left_alone_however_their_normal_is_rounded() {
        let mut c = pair(-1e-6, 0.0);
        c[0].normal = DVec3::new(1e-13, 0.0, 1.0);
        let held = DVec3::new(4.0, 4.0, 0.0);
        let mut table = NodeTable::new(&c, |id| ContactNode::new(id, [DVec3::NEG_Z * 1e-3; 2], held));
        set_targets(&mut c, &table, &parameters(true));
        solve(&mut c, &mut table, &parameters(true));
        assert_eq!(c[0].impulse_n_s, DVec3::ZERO);
    }

    #[test]
    fn the_same_pair_seen_three_times_converges_to_the_same_motion() {
        let mut once = pair(0.0, 0.3);
        let (expected, _) = run(&mut once, DVec3::new(0.1, 0.2, -1.0), 0.25, true);
        let mut thrice: Vec<Constraint> = (0..3).flat_map(|_| pair(0.0, 0.3)).collect();
        let (table, report) = run(&mut thrice, DVec3::new(0.1, 0.2, -1.0), 0.25, true);
        assert!(report.settling.last_change < 1e-12);
        for (a, b) in table.nodes.iter().zip(&expected.nodes) {
            assert!((a.velocity_m_s - b.velocity_m_s).length() < 1e-12);
        }
    }
}
