//! The nodes that take part in a response, and their velocities.

use super::constraint::Constraint;
use glam::DVec3;

/// A node that takes part in the response.
#[derive(Clone, Copy, Debug)]
pub struct ContactNode {
    /// Velocity of the half step, m/s; corrected by the response.
    pub velocity_m_s: DVec3,
    /// Inverse mass along x, y, z, 1/kg; zero where the motion is prescribed.
    pub inverse_mass_per_kg: DVec3,
    /// Velocity at the start of the step, m/s.
    pub start_velocity_m_s: DVec3,
    /// Body.
    pub body: u32,
    /// Node of the body.
    pub node: u32,
}

impl ContactNode {
    /// A node before the response.
    #[must_use]
    pub fn new((body, node): (u32, u32), velocities_m_s: [DVec3; 2], inverse_mass_per_kg: DVec3) -> Self {
        let [start_velocity_m_s, velocity_m_s] = velocities_m_s;
        Self { velocity_m_s, inverse_mass_per_kg, start_velocity_m_s, body, node }
    }
}

/// Four nodes of a table and their weights in a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weighted {
    /// Places in the table.
    pub nodes: [u32; 4],
    pub weights: [f64; 4],
}

impl Weighted {
    /// Weighted sum over the nodes, by their places in the table.
    pub fn sum(&self, of_node: impl Fn(usize) -> DVec3) -> DVec3 {
        let [a, b, c, d] = self.nodes.map(|node| node as usize);
        let [wa, wb, wc, wd] = self.weights;
        of_node(a) * wa + of_node(b) * wb + (of_node(c) * wc + of_node(d) * wd)
    }

    /// Relative velocity of the half step, m/s.
    pub fn velocity(&self, nodes: &[ContactNode]) -> DVec3 {
        self.sum(|i| nodes[i].velocity_m_s)
    }

    /// Lets an impulse act on the nodes.
    pub fn apply(&self, nodes: &mut [ContactNode], impulse_n_s: DVec3) {
        for (node, weight) in self.nodes.into_iter().zip(self.weights) {
            let node = &mut nodes[node as usize];
            node.velocity_m_s += node.inverse_mass_per_kg * impulse_n_s * weight;
        }
    }

    /// Adds to changes of the nodes' velocities, m/s, what an impulse would do.
    pub fn add_change(&self, nodes: &[ContactNode], changes_m_s: &mut [DVec3], impulse_n_s: DVec3) {
        for (node, weight) in self.nodes.into_iter().zip(self.weights) {
            changes_m_s[node as usize] += nodes[node as usize].inverse_mass_per_kg * impulse_n_s * weight;
        }
    }

    /// Diagonal of the pair's block: `sum_i w_i^2 / m_i` along x, y, z, 1/kg.
    pub fn block(&self, nodes: &[ContactNode]) -> DVec3 {
        let pairs = self.nodes.iter().zip(self.weights);
        pairs.map(|(node, weight)| nodes[*node as usize].inverse_mass_per_kg * (weight * weight)).sum()
    }
}

/// The nodes of a set of constraints and where each constraint finds its four.
#[derive(Clone, Debug, Default)]
pub struct NodeTable {
    /// Nodes, sorted by body and node.
    pub nodes: Vec<ContactNode>,
    rows: Vec<[u32; 4]>,
    predicted_m_s: Vec<DVec3>,
}

/// Stands for a node that has no place in a table.
const NO_PLACE: u32 = u32::MAX;

/// Body and node of each of the four.
fn ids_of(c: &Constraint) -> [(u32, u32); 4] {
    c.nodes.map(|(side, node)| (c.bodies[side as usize], node))
}

impl NodeTable {
    /// Collects the nodes of the constraints; `state` gives the node of a (body, node).
    #[must_use]
    pub fn new(constraints: &[Constraint], state: impl Fn((u32, u32)) -> ContactNode) -> Self {
        // By body and node: its place.
        let mut places: Vec<Vec<u32>> = Vec::new();
        for (body, node) in constraints.iter().flat_map(ids_of) {
            let [body, index] = [body, node].map(|number| number as usize);
            if places.len() <= body {
                places.resize(body + 1, Vec::new());
            }
            let of_body = &mut places[body];
            if of_body.len() <= index {
                of_body.resize((index + 1).max(2 * of_body.len()), NO_PLACE);
            }
            of_body[index] = 0;
        }
        let mut ids: Vec<(u32, u32)> = Vec::new();
        for (body, of_body) in (0_u32..).zip(&mut places) {
            for (node, place) in (0_u32..).zip(of_body).filter(|(_, place)| **place != NO_PLACE) {
                *place = ids.len() as u32;
                ids.push((body, node));
            }
        }
        let place = |(body, node): (u32, u32)| places[body as usize][node as usize];
        let rows = constraints.iter().map(|c| ids_of(c).map(place)).collect();
        let nodes: Vec<ContactNode> = ids.iter().copied().map(state).collect();
        let predicted_m_s = nodes.iter().map(|n| n.velocity_m_s).collect();
        Self { nodes, rows, predicted_m_s }
    }

    /// A constraint's nodes, with these weights.
    pub(super) fn weighted(&self, row: usize, weights: [f64; 4]) -> Weighted {
        Weighted { nodes: self.rows[row], weights }
    }

    /// Relative velocity of the half step of a constraint, m/s.
    #[must_use]
    pub fn relative_velocity(&self, row: usize, weights: &[f64; 4]) -> DVec3 {
        self.weighted(row, *weights).velocity(&self.nodes)
    }

    /// Relative velocity at the start of the step of a constraint, m/s.
    pub(super) fn relative_start_velocity(&self, row: usize, weights: &[f64; 4]) -> DVec3 {
        self.weighted(row, *weights).sum(|i| self.nodes[i].start_velocity_m_s)
    }

    /// Change of the relative velocity of a constraint by the response so far, m/s.
    pub(super) fn relative_change(&self, row: usize, weights: &[f64; 4]) -> DVec3 {
        self.weighted(row, *weights).sum(|i| self.change_m_s(i))
    }

    /// Change of a node's velocity by the response so far, m/s.
    pub(super) fn change_m_s(&self, node: usize) -> DVec3 {
        self.nodes[node].velocity_m_s - self.predicted_m_s[node]
    }

    /// Velocities before the response, in the order of `nodes`, m/s.
    #[must_use]
    pub fn predicted_m_s(&self) -> &[DVec3] {
        &self.predicted_m_s
    }

    /// Relative velocity before the response of a constraint that has no row, m/s; `others_m_s` gives the velocities of the nodes
    /// (by body and node) that are not in the table.
    #[must_use]
    pub fn predicted_velocity_of(&self, c: &Constraint, others_m_s: impl Fn((u32, u32)) -> DVec3) -> DVec3 {
        let velocity_m_s = |id: (u32, u32)| {
            let at = self.nodes.binary_search_by_key(&id, |n| (n.body, n.node));
            at.map_or_else(|_| others_m_s(id), |at| self.predicted_m_s[at])
        };
        let ids = ids_of(c);
        Weighted { nodes: [0, 1, 2, 3], weights: c.weights }.sum(|corner| velocity_m_s(ids[corner]))
    }

    /// Energy that the constraints' impulses took from the nodes and work that prescribed motion did, J. The weights are those
    /// with which the impulses act.
    ///
    /// The impulse acts at the start of the step, on the velocity of that moment.
    pub(super) fn balances(&self, constraints: &[Constraint], weights: &[[f64; 4]]) -> (f64, f64) {
        let (mut dissipated_j, mut prescribed_j) = (0.0, 0.0);
        let rows = constraints.iter().zip(weights).zip(&self.rows);
        for ((c, weights), nodes) in rows.filter(|((c, _), _)| c.impulse_n_s != DVec3::ZERO) {
            for (node, weight) in nodes.iter().copied().zip(*weights) {
                let (at, node) = (node as usize, &self.nodes[node as usize]);
                let midway_m_s = node.start_velocity_m_s + self.change_m_s(at) * 0.5;
                let work = c.impulse_n_s * weight * midway_m_s;
                dissipated_j -= work.element_sum();
                let is_prescribed = node.inverse_mass_per_kg.cmpeq(DVec3::ZERO);
                prescribed_j -= DVec3::select(is_prescribed, work, DVec3::ZERO).element_sum();
            }
        }
        (dissipated_j, prescribed_j)
    }
}
