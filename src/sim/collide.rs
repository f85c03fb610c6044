//! Contact within one step of one island: detect, respond, book.

use super::body::{Body, Regime};
use super::broad::NearPair;
use super::{ContactMethod, ContactParameters};
use crate::contact::constraint::{Feature, Geometry};
use crate::contact::response::{
    ContactNode, NodeTable, ResponseParameters, ResponseReport, apply_penalty, penalty_energy_j, set_targets,
    solve, sort_by_place,
};
use crate::contact::{BodyView, CollisionList, Constraint, PairView, detect};
use glam::DVec3;

/// Rounds of "respond, look whether the correction closed a pair that was left out".
const MOST_ROUNDS: u32 = 6;
/// Penetration at the end of the step, as a share of the local size, below which a pair may be left out.
const LEFT_OUT_DEPTH: f64 = 1e-4;

/// What a step's contact did, to be added up.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactOutcome {
    /// The constraints with their impulses.
    pub constraints: Vec<Constraint>,
    pub response: ResponseReport,
    /// Energy in penalty springs, J.
    pub spring_j: f64,
}

/// What contact of an island needs to know.
pub(super) struct ContactScene<'a> {
    pub bodies: &'a mut [Body],
    pub pairs: Vec<&'a NearPair>,
    pub parameters: &'a ContactParameters,
    pub list: &'a CollisionList,
    pub step_s: f64,
    pub gravity_m_s2: f64,
}

impl ContactScene<'_> {
    fn view(&self, body: usize) -> BodyView<'_> {
        let body = &self.bodies[body];
        BodyView { surface: &body.surface, positions_m: &body.position_m, velocities_m_s: &body.velocity_m_s }
    }

    fn friction(&self, bodies: [usize; 2]) -> f64 {
        let same = |p: &super::PairFriction| p.bodies == bodies || p.bodies == [bodies[1], bodies[0]];
        let exception = self.parameters.pair_friction.iter().find(|p| same(p));
        exception.map_or(self.parameters.friction_coefficient, |p| p.friction_coefficient)
    }

    fn find(&self) -> Vec<Constraint> {
        let mut found = Vec::new();
        for pair in &self.pairs {
            let view = PairView {
                bodies: pair.bodies.map(|b| b as u32),
                views: pair.bodies.map(|b| self.view(b)),
                candidates: &pair.candidates,
                friction_coefficient: self.friction(pair.bodies),
            };
            detect(&view, self.step_s, self.list, &mut found);
        }
        found
    }

    fn table(&self, constraints: &[Constraint]) -> NodeTable {
        self.table_with(constraints, |_, v| v)
    }

    /// The table with half-step velocities that `half_of` may replace.
    fn table_with(
        &self,
        constraints: &[Constraint],
        half_of: impl Fn((u32, u32), DVec3) -> DVec3,
    ) -> NodeTable {
        NodeTable::new(constraints, |id| {
            let (body, node) = (&self.bodies[id.0 as usize], id.1 as usize);
            let half = half_of(id, body.velocity_m_s[node]);
            let inverse_mass = body.inverse_mass_per_kg[node];
            let kick = body.acceleration_m_s2[node] * (0.5 * self.step_s);
            let start = half - DVec3::select(inverse_mass.cmpgt(DVec3::ZERO), kick, DVec3::ZERO);
            ContactNode::new(id, [start, half], inverse_mass)
        })
    }

    /// Whether the constraint is a node of the finer body on the coarser one's patch.
    fn is_primary(&self, c: &Constraint) -> bool {
        let [own, other] = c.bodies.map(|b| &self.bodies[b as usize]);
        let is_node = matches!(c.feature, Feature::NodeOnPatch { .. });
        is_node && (c.bodies[0] == c.bodies[1] || is_finer(own, other))
    }

    /// Sorts out what both sides would say twice, so that the passes converge fast: a coarser body's node
    /// on a patch all of whose corners touch the coarser body themselves. Returns what is to be enforced and what is to
    /// be watched.
    fn without_redundant(&self, found: Vec<Constraint>) -> (Vec<Constraint>, Vec<Constraint>) {
        let mut touching: Vec<(u32, u32, u32)> = found
            .iter()
            .filter(|c| self.is_primary(c))
            .map(|c| (c.bodies[0], c.nodes[0].1, c.bodies[1]))
            .collect();
        touching.sort_unstable();
        found.into_iter().partition(|c| {
            let corner_touches =
                |corner: &(u8, u32)| touching.binary_search(&(c.bodies[1], corner.1, c.bodies[0])).is_ok();
            let is_node = matches!(c.feature, Feature::NodeOnPatch { .. });
            !is_node || self.is_primary(c) || !c.nodes[1..].iter().all(corner_touches)
        })
    }

    /// Closing speed below which nothing bounces, m/s.
    fn rest_speed_m_s(&self) -> f64 {
        if let Some(speed) = self.parameters.rest_speed_m_s {
            return speed;
        }
        let movers = self.pairs.iter().flat_map(|p| p.bodies).map(|b| &self.bodies[b]);
        let deformable = movers.filter(|b| b.is_deformable());
        let radius_m = deformable.map(|b| b.radius_m).fold(f64::INFINITY, f64::min);
        let radius_m = if radius_m.is_finite() { radius_m } else { 0.0 };
        // A twenty-fifth of the speed gained in falling by the body's radius, and what gravity adds in
        // a step to a node that carries a column of others.
        0.04 * (2.0 * self.gravity_m_s2 * radius_m).sqrt() + 20.0 * self.gravity_m_s2 * self.step_s
    }
}

/// Whether `a`'s nodes go first. Between equals the place decides, not the number.
fn is_finer(a: &Body, b: &Body) -> bool {
    if !a.is_deformable() || !b.is_deformable() {
        return a.is_deformable();
    }
    let ratio = a.mean_size_m / b.mean_size_m;
    if (ratio - 1.0).abs() > 1e-6 {
        return ratio < 1.0;
    }
    let key = |x: &Body| x.reference.centre_m.to_array();
    let (ka, kb) = (key(a), key(b));
    (0..3).rev().map(|i| ka[i].total_cmp(&kb[i])).find(|o| o.is_ne()).is_some_and(|o| o.is_gt())
}

/// Finds and solves the contacts of an island for the predicted velocities, and writes the corrected
/// velocities to the bodies.
pub(super) fn respond(scene: &mut ContactScene) -> ContactOutcome {
    let mut constraints = scene.find();
    if constraints.is_empty() {
        return ContactOutcome::default();
    }
    match scene.parameters.method {
        ContactMethod::Penalty { stiffness_n_m } => {
            sort_by_place(&mut constraints);
            let mut table = scene.table(&constraints);
            let response = apply_penalty(&mut constraints, &mut table, stiffness_n_m, scene.step_s);
            write_back(scene.bodies, &table);
            let spring_j = penalty_energy_j(&constraints, stiffness_n_m);
            ContactOutcome { constraints, response, spring_j }
        }
        ContactMethod::Lagrange { passes, tolerance, conserve_impact_energy } => {
            let parameters = ResponseParameters {
                step_s: scene.step_s,
                passes,
                tolerance,
                conserve_impact_energy,
                rest_speed_m_s: scene.rest_speed_m_s(),
            };
            let (response, constraints) = solve_all(scene, constraints, &parameters);
            ContactOutcome { constraints, response, spring_j: 0.0 }
        }
    }
}

/// Solves the pairs that are not redundant, then adds what the corrected velocities still close, until nothing is left.
fn solve_all(
    scene: &mut ContactScene,
    found: Vec<Constraint>,
    parameters: &ResponseParameters,
) -> (ResponseReport, Vec<Constraint>) {
    let (mut active, _) = scene.without_redundant(found);
    let mut round = 0;
    loop {
        sort_by_place(&mut active);
        scene.list.stores().hand_over(&mut active);
        let mut table = scene.table(&active);
        set_targets(&mut active, &table, parameters);
        let report = solve(&mut active, &mut table, parameters);
        write_back(scene.bodies, &table);
        round += 1;
        if round >= MOST_ROUNDS {
            return (report, active);
        }
        let added = still_closing(scene, &active, &table);
        if added.is_empty() {
            return (report, active);
        }
        take_back(scene.bodies, &table);
        active.iter_mut().for_each(|c| c.impulse_n_s = DVec3::ZERO);
        active.extend(added);
    }
}

/// Pairs that are not enforced and would penetrate with the velocities as they are now. Where the enforced pairs
/// have taken away most of the approach already, what is left is only to be stopped, not to be bounced.
fn still_closing(scene: &ContactScene, active: &[Constraint], corrected: &NodeTable) -> Vec<Constraint> {
    let mut known: Vec<([u32; 2], Feature)> = active.iter().map(|c| (c.bodies, c.feature)).collect();
    known.sort_unstable();
    let mut found = scene.find();
    found.retain(|c| known.binary_search(&(c.bodies, c.feature)).is_err());
    let table = scene.table(&found);
    let predicted = scene.table_with(&found, |id, v| corrected.predicted_of(id).unwrap_or(v));
    let closing = |table: &NodeTable, row: usize, c: &Constraint| {
        -scene.step_s * table.relative_velocity(row, &c.weights).dot(c.normal)
    };
    let mut closing_pairs = Vec::new();
    for (row, mut c) in found.into_iter().enumerate() {
        let (now_m, before_m) = (closing(&table, row, &c), closing(&predicted, row, &c));
        if c.gap_m - now_m < -LEFT_OUT_DEPTH * c.size_m {
            c.may_bounce = now_m > 0.5 * before_m;
            closing_pairs.push(c);
        }
    }
    closing_pairs
}

fn take_back(bodies: &mut [Body], table: &NodeTable) {
    for (node, predicted) in table.nodes.iter().zip(table.predicted_m_s()) {
        bodies[node.body as usize].velocity_m_s[node.node as usize] = *predicted;
    }
}

/// Writes the corrected velocities back to the bodies.
fn write_back(bodies: &mut [Body], table: &NodeTable) {
    for node in &table.nodes {
        let body = &mut bodies[node.body as usize];
        if body.regime == Regime::Elastic {
            body.velocity_m_s[node.node as usize] = node.velocity_m_s;
        }
    }
}

/// Deepest penetration of the constraints at the bodies' present positions: in metres and over the
/// local size.
pub(super) fn penetration(bodies: &[Body], constraints: &[Constraint]) -> (f64, f64) {
    let mut deepest = (0.0_f64, 0.0_f64);
    for c in constraints.iter().filter(|c| c.impulse_n_s != DVec3::ZERO) {
        let at = |k: usize| {
            let (side, node) = c.nodes[k];
            bodies[c.bodies[side as usize] as usize].position_m[node as usize]
        };
        let geometry = match c.feature {
            Feature::NodeOnPatch { .. } => Geometry::node_on_patch(at(0), [at(1), at(2), at(3)]),
            Feature::EdgeOnEdge { .. } => Geometry::edge_on_edge([at(0), at(1)], [at(2), at(3)], c.normal),
        };
        let Some(g) = geometry.filter(|g| g.is_inside(0.0)) else { continue };
        deepest = (deepest.0.max(-g.gap_m), deepest.1.max(-g.gap_m / c.size_m));
    }
    deepest
}
