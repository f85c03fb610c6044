//! Contact within one step of one island: detect, respond, book.

use super::body::{Body, Regime};
use super::broad::NearPair;
use super::{ContactMethod, ContactParameters};
use crate::contact::constraint::{Feature, Geometry};
use crate::contact::response::{
    NodeTable, ResponseParameters, ResponseReport, apply_penalty, penalty_energy_j, set_targets, solve,
    sort_by_place,
};
use crate::contact::{BodyView, CollisionList, Constraint, PairView, detect};
use glam::DVec3;

/// Rounds of "respond, look whether the correction closed a pair that was left out".
const MOST_ROUNDS: u32 = 6;

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
    pub bodies: &'a [Body],
    pub pairs: Vec<&'a NearPair>,
    pub parameters: &'a ContactParameters,
    pub list: &'a CollisionList,
    pub step_s: f64,
    pub gravity_m_s2: f64,
}

impl ContactScene<'_> {
    fn view(&self, body: usize) -> BodyView<'_> {
        let body = &self.bodies[body];
        BodyView {
            surface: &body.surface,
            positions_m: &body.position_m,
            velocities_m_s: &body.velocity_m_s,
        }
    }

    fn friction(&self, bodies: [usize; 2]) -> f64 {
        let same = |p: &super::PairFriction| {
            p.bodies == bodies || p.bodies == [bodies[1], bodies[0]]
        };
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
        NodeTable::new(constraints, |body, node| {
            let body = &self.bodies[body as usize];
            (body.velocity_m_s[node as usize], body.inverse_mass_per_kg[node as usize])
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
        // A hundredth of the speed gained in falling by the body's radius, and what gravity adds in
        // a step to a node that carries a column of others.
        0.01 * (2.0 * self.gravity_m_s2 * radius_m).sqrt() + 20.0 * self.gravity_m_s2 * self.step_s
    }
}

/// Finds and solves the contacts of an island for the predicted velocities; returns the outcome and the table of
/// corrected nodes.
pub(super) fn respond(scene: &ContactScene) -> (ContactOutcome, NodeTable) {
    let mut constraints = scene.find();
    if constraints.is_empty() {
        return (ContactOutcome::default(), NodeTable::default());
    }
    sort_by_place(&mut constraints);
    let mut table = scene.table(&constraints);
    match scene.parameters.method {
        ContactMethod::Penalty { stiffness_n_m } => {
            let response = apply_penalty(&mut constraints, &mut table, stiffness_n_m, scene.step_s);
            let spring_j = penalty_energy_j(&constraints, stiffness_n_m);
            (ContactOutcome { constraints, response, spring_j }, table)
        }
        ContactMethod::Lagrange { passes, tolerance, conserve_impact_energy } => {
            let parameters = ResponseParameters {
                step_s: scene.step_s,
                passes,
                tolerance,
                conserve_impact_energy,
                rest_speed_m_s: scene.rest_speed_m_s(),
            };
            let (response, constraints, table) = solve_all(scene, constraints, &parameters);
            (ContactOutcome { constraints, response, spring_j: 0.0 }, table)
        }
    }
}

/// Solves, and adds pairs that the corrected velocities close, until there are none.
fn solve_all(
    scene: &ContactScene,
    mut constraints: Vec<Constraint>,
    parameters: &ResponseParameters,
) -> (ResponseReport, Vec<Constraint>, NodeTable) {
    let mut known: Vec<([u32; 2], Feature)> = Vec::new();
    for round in 0.. {
        let mut table = scene.table(&constraints);
        set_targets(&mut constraints, &table, parameters);
        let report = solve(&mut constraints, &mut table, parameters);
        if round + 1 >= MOST_ROUNDS || constraints.iter().all(|c| c.impulse_n_s == DVec3::ZERO) {
            return (report, constraints, table);
        }
        known.clear();
        known.extend(constraints.iter().map(|c| (c.bodies, c.feature)));
        known.sort_unstable();
        let added = newly_closed(scene, &table, &known);
        if added.is_empty() {
            return (report, constraints, table);
        }
        constraints.iter_mut().for_each(|c| c.impulse_n_s = DVec3::ZERO);
        constraints.extend(added);
        sort_by_place(&mut constraints);
    }
    unreachable!("the loop returns")
}

/// Pairs that close under the corrected velocities and are not known yet.
fn newly_closed(
    scene: &ContactScene,
    table: &NodeTable,
    known: &[([u32; 2], Feature)],
) -> Vec<Constraint> {
    let mut velocities: Vec<Option<Vec<DVec3>>> = vec![None; scene.bodies.len()];
    for node in &table.nodes {
        let body = node.body as usize;
        let corrected =
            velocities[body].get_or_insert_with(|| scene.bodies[body].velocity_m_s.clone());
        corrected[node.node as usize] = node.velocity_m_s;
    }
    let mut found = Vec::new();
    for pair in &scene.pairs {
        let views = pair.bodies.map(|b| {
            let mut view = scene.view(b);
            if let Some(corrected) = &velocities[b] {
                view.velocities_m_s = corrected;
            }
            view
        });
        let view = PairView {
            bodies: pair.bodies.map(|b| b as u32),
            views,
            candidates: &pair.candidates,
            friction_coefficient: scene.friction(pair.bodies),
        };
        detect(&view, scene.step_s, scene.list, &mut found);
    }
    found.retain(|c| known.binary_search(&(c.bodies, c.feature)).is_err());
    found
}

/// Writes the corrected velocities back to the bodies.
pub(super) fn write_back(bodies: &mut [Body], table: &NodeTable) {
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
            Feature::EdgeOnEdge { .. } => {
                Geometry::edge_on_edge([at(0), at(1)], [at(2), at(3)], c.normal)
            }
        };
        let Some(g) = geometry.filter(|g| g.is_inside(0.0)) else { continue };
        deepest = (deepest.0.max(-g.gap_m), deepest.1.max(-g.gap_m / c.size_m));
    }
    deepest
}
