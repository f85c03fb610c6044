//! Contact within one step of one island: detect, respond, book.

use super::body::{Body, Regime};
use super::broad::NearPair;
use super::{ContactMethod, ContactParameters};
use crate::contact::constraint::{Feature, Geometry};
use crate::contact::nodes::{ContactNode, NodeTable};
use crate::contact::response::{
    ResponseParameters, ResponseReport, Settling, apply_penalty, merge_by_place, penalty_energy_j,
    set_targets, solve, sort_by_place,
};
use crate::contact::{BodyView, CollisionList, Constraint, Near, PairDepths, PairView, ThrownNodes};
use glam::DVec3;

/// Rounds of "respond, look whether the correction closed a pair that was left out".
const MOST_ROUNDS: u32 = 6;
/// Penetration at the end of the step, as a share of the local size, below which a pair may be left out.
const LEFT_OUT_DEPTH: f64 = 1e-4;
/// Change of way by the response, as a share of the local size, that the first look of a step allows for.
const LOOK_SLACK: f64 = 0.01;
/// The same within a body, where cracks that have opened a little are many.
const OWN_LOOK_SLACK: f64 = 0.002;

/// Share of a pair's squared weights that nodes free to move must have.
const FREE_WEIGHT: f64 = 0.05;

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
        view(&self.bodies[body])
    }

    fn friction(&self, bodies: [usize; 2]) -> f64 {
        let same = |p: &super::PairFriction| p.bodies == bodies || p.bodies == [bodies[1], bodies[0]];
        let exception = self.parameters.pair_friction.iter().find(|p| same(p));
        exception.map_or(self.parameters.friction_coefficient, |p| p.friction_coefficient)
    }

    fn pair_view<'b>(&'b self, pair: &'b NearPair) -> PairView<'b> {
        PairView {
            bodies: pair.bodies.map(|b| b as u32),
            views: pair.bodies.map(|b| self.view(b)),
            friction_coefficient: self.friction(pair.bodies),
            step_s: self.step_s,
            list: self.list,
            depths: depths(self.parameters.method),
        }
    }

    fn table(&self, constraints: &[Constraint]) -> NodeTable {
        NodeTable::new(constraints, |id| {
            let (body, node) = (&self.bodies[id.0 as usize], id.1 as usize);
            let half = body.velocity_m_s[node];
            let inverse_mass = body.inverse_mass_per_kg[node];
            let kick = body.acceleration_m_s2[node] * (0.5 * self.step_s);
            let start = half - DVec3::select(inverse_mass.cmpgt(DVec3::ZERO), kick, DVec3::ZERO);
            ContactNode::new(id, [start, half], inverse_mass)
        })
    }

    /// Whether an impulse along the normal can open a pair: not where the weight lies on nodes whose motion is prescribed,
    /// as at a crack that has doubled held nodes.
    fn can_open(&self, c: &Constraint) -> bool {
        if !c.is_own() {
            return true;
        }
        let (mut free, mut all) = (0.0, 0.0);
        for ((side, node), weight) in c.nodes.iter().zip(&c.weights) {
            let body = &self.bodies[c.bodies[*side as usize] as usize];
            let inverse_mass = body.inverse_mass_per_kg[*node as usize];
            if (inverse_mass * c.normal).dot(c.normal) > FREE_WEIGHT * inverse_mass.max_element() {
                free += weight * weight;
            }
            all += weight * weight;
        }
        free > FREE_WEIGHT * all
    }

    /// Whether the constraint is a node of the finer body on the coarser one's patch.
    fn is_primary(&self, c: &Constraint) -> bool {
        let [own, other] = c.bodies.map(|b| &self.bodies[b as usize]);
        let is_node = matches!(c.feature, Feature::NodeOnPatch { .. });
        is_node && (c.is_own() || is_finer(own, other))
    }

    /// Leaves out what both sides would say twice, so that the passes converge fast: a coarser body's node
    /// on a patch all of whose corners touch the coarser body themselves.
    fn without_redundant(&self, mut found: Vec<Constraint>) -> Vec<Constraint> {
        let mut touching: Vec<(u32, u32, u32)> = found
            .iter()
            .filter(|c| self.is_primary(c))
            .map(|c| (c.bodies[0], c.nodes[0].1, c.bodies[1]))
            .collect();
        touching.sort_unstable();
        found.retain(|c| {
            let corner_touches =
                |corner: &(u8, u32)| touching.binary_search(&(c.bodies[1], corner.1, c.bodies[0])).is_ok();
            let is_node = matches!(c.feature, Feature::NodeOnPatch { .. });
            !is_node || self.is_primary(c) || !c.nodes[1..].iter().all(corner_touches)
        });
        found
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

fn view(body: &Body) -> BodyView<'_> {
    BodyView {
        surface: &body.surface,
        reference_m: &body.reference_m,
        positions_m: &body.position_m,
        velocities_m_s: &body.velocity_m_s,
    }
}

/// Way by which the response may bring points nearer to each other before there is a second look, m.
fn look_slack_m(bodies: &[Body], pair: [usize; 2]) -> f64 {
    let slack = if pair[0] == pair[1] { OWN_LOOK_SLACK } else { LOOK_SLACK };
    slack * finer_size_m(bodies, pair)
}

fn finer_size_m(bodies: &[Body], pair: [usize; 2]) -> f64 {
    let [a, b] = pair.map(|b| bodies[b].mean_size_m);
    a.min(b)
}

/// Brings the lists of what is close up to date for a step.
pub(super) fn renew_close<'a>(
    (bodies, list): (&[Body], &CollisionList),
    pairs: impl Iterator<Item = &'a mut NearPair>,
    parameters: &ContactParameters,
    step_s: f64,
) {
    for pair in pairs {
        let view = PairView {
            bodies: pair.bodies.map(|b| b as u32),
            views: pair.bodies.map(|b| view(&bodies[b])),
            friction_coefficient: 0.0,
            step_s,
            list,
            depths: depths(parameters.method),
        };
        pair.close.renew(&view, &pair.candidates, look_slack_m(bodies, pair.bodies));
    }
}

fn depths(method: ContactMethod) -> PairDepths {
    match method {
        ContactMethod::Penalty { .. } => PairDepths::SPRINGS,
        ContactMethod::Lagrange { .. } => PairDepths::CONSTRAINED,
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
    let mut look = Look::first(scene);
    let mut constraints = look.find(scene);
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
            let (response, constraints) = solve_all(scene, (&mut look, constraints), &parameters);
            ContactOutcome { constraints, response, spring_j: 0.0 }
        }
    }
}

/// Solves the pairs that are not redundant, then adds what the corrected velocities still close, until nothing is left.
fn solve_all(
    scene: &mut ContactScene,
    (look, found): (&mut Look, Vec<Constraint>),
    parameters: &ResponseParameters,
) -> (ResponseReport, Vec<Constraint>) {
    let mut added = scene.without_redundant(found);
    let (mut active, mut known) = (Vec::new(), Vec::new());
    let (mut round, mut settling) = (0, Settling::default());
    loop {
        // The impulses found so far are the best guess for the next round, for the others those of the last step.
        scene.list.recall_impulses(&mut added);
        known.extend(added.iter().map(|c| (c.bodies, c.feature)));
        // Stable, since that is fast with what is sorted for the most part.
        known.sort();
        merge_by_place(&mut active, added);
        scene.list.stores().hand_over(&mut active);
        let mut table = scene.table(&active);
        set_targets(&mut active, &table, parameters);
        let mut report = solve(&mut active, &mut table, parameters);
        settling.include(&report.settling);
        report.settling = settling;
        write_back(scene.bodies, &table);
        round += 1;
        if round >= MOST_ROUNDS {
            return (report, active);
        }
        added = still_closing(scene, look, &known, &table);
        if added.is_empty() {
            return (report, active);
        }
        take_back(scene.bodies, &table);
    }
}

/// Pairs that are not enforced (those that are known, which are sorted) and would penetrate with the velocities as they are now.
/// Where the enforced pairs have taken away most of the approach already, what is left is only to be stopped, not to be bounced.
fn still_closing(
    scene: &ContactScene,
    look: &mut Look,
    known: &[([u32; 2], Feature)],
    corrected: &NodeTable,
) -> Vec<Constraint> {
    look.renew(scene, corrected);
    let mut closing = look.find_closing(scene, |key| known.binary_search(&key).is_ok());
    for c in &mut closing {
        let others_m_s = |(body, node): (u32, u32)| scene.bodies[body as usize].velocity_m_s[node as usize];
        let before_m_s = -corrected.predicted_velocity_of(c, others_m_s).dot(c.normal);
        c.may_bounce &= c.closing_m_s > 0.5 * before_m_s;
    }
    closing
}

/// What lies near enough to touch in the step, pair by pair of bodies.
struct Look {
    pairs: Vec<PairLook>,
}

struct PairLook {
    near: Near,
    thrown: ThrownNodes,
}

impl Look {
    fn first(scene: &ContactScene) -> Self {
        let of_pair = |pair: &&NearPair| {
            let thrown = ThrownNodes::none(look_slack_m(scene.bodies, pair.bodies));
            PairLook { near: Near::of_close(&scene.pair_view(pair), &pair.close, &thrown), thrown }
        };
        Self { pairs: scene.pairs.iter().map(of_pair).collect() }
    }

    /// Looks anew at the nodes whose ways the response has changed by more than was allowed for.
    fn renew(&mut self, scene: &ContactScene, corrected: &NodeTable) {
        let mut changes_m: Vec<Vec<(u32, f64)>> = vec![Vec::new(); scene.bodies.len()];
        for (node, predicted) in corrected.nodes.iter().zip(corrected.predicted_m_s()) {
            let change_m = scene.step_s * (node.velocity_m_s - *predicted).length();
            changes_m[node.body as usize].push((node.node, change_m));
        }
        for (look, pair) in self.pairs.iter_mut().zip(&scene.pairs) {
            let of_bodies = pair.bodies.map(|body| changes_m[body].as_slice());
            let node_counts = pair.bodies.map(|body| scene.bodies[body].position_m.len());
            if look.thrown.follow(of_bodies, node_counts) {
                let lists = (&pair.candidates, &pair.close);
                look.near.look_again_at(&look.thrown, &scene.pair_view(pair), lists);
            }
        }
    }

    fn find(&self, scene: &ContactScene) -> Vec<Constraint> {
        let mut found = Vec::new();
        for (look, pair) in self.pairs.iter().zip(&scene.pairs) {
            look.near.find(&scene.pair_view(pair), &mut found);
        }
        found.retain(|c| scene.can_open(c));
        found
    }

    fn find_closing(
        &self,
        scene: &ContactScene,
        is_known: impl Fn(([u32; 2], Feature)) -> bool + Sync,
    ) -> Vec<Constraint> {
        let mut found = Vec::new();
        for (look, pair) in self.pairs.iter().zip(&scene.pairs) {
            look.near.find_closing(&scene.pair_view(pair), LEFT_OUT_DEPTH, &is_known, &mut found);
        }
        found.retain(|c| scene.can_open(c));
        found
    }
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
