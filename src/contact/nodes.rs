//! The nodes that take part in a response, and their velocities.

use super::constraint::Constraint;
use glam::DVec3;

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
        self.between((row, weights), |i| self.nodes[i].velocity_m_s)
    }

    /// Relative velocity at the start of the step of a constraint, m/s.
    pub(super) fn relative_start_velocity(&self, row: usize, weights: &[f64; 4]) -> DVec3 {
        self.between((row, weights), |i| self.nodes[i].start_velocity_m_s)
    }

    /// Change of the relative velocity of a constraint by the response so far, m/s.
    pub(super) fn relative_change(&self, row: usize, weights: &[f64; 4]) -> DVec3 {
        self.between((row, weights), |i| self.nodes[i].velocity_m_s - self.predicted_m_s[i])
    }

    /// Weighted sum over a constraint's nodes, by their indices in the table.
    fn between(&self, (row, weights): (usize, &[f64; 4]), of_node: impl Fn(usize) -> DVec3) -> DVec3 {
        self.rows[row].iter().zip(weights).map(|(i, w)| of_node(*i) * *w).sum()
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

    pub(super) fn apply(&mut self, row: usize, weights: &[f64; 4], impulse_n_s: DVec3) {
        for (i, w) in self.rows[row].into_iter().zip(weights) {
            let node = &mut self.nodes[i];
            node.impulse_n_s += impulse_n_s * *w;
            node.velocity_m_s += node.inverse_mass_per_kg * impulse_n_s * *w;
        }
    }

    /// Adds to changes of the nodes' velocities, m/s, what an impulse of a constraint would do.
    pub(super) fn add_change(
        &self,
        changes_m_s: &mut [DVec3],
        (row, weights): (usize, &[f64; 4]),
        impulse_n_s: DVec3,
    ) {
        for (i, w) in self.rows[row].into_iter().zip(weights) {
            changes_m_s[i] += self.nodes[i].inverse_mass_per_kg * impulse_n_s * *w;
        }
    }

    /// Relative velocity of a constraint that goes with changes of the nodes' velocities, m/s.
    pub(super) fn change_between(&self, changes_m_s: &[DVec3], (row, weights): (usize, &[f64; 4])) -> DVec3 {
        self.between((row, weights), |i| changes_m_s[i])
    }

    /// Takes back all but a share of what has been applied since `saved`; above 1 it goes beyond.
    pub(super) fn keep_share(&mut self, saved: &[ContactNode], share: f64) {
        for (node, saved) in self.nodes.iter_mut().zip(saved) {
            node.velocity_m_s = saved.velocity_m_s.lerp(node.velocity_m_s, share);
            node.impulse_n_s = saved.impulse_n_s.lerp(node.impulse_n_s, share);
        }
    }

    /// Diagonal of the pair's block: `sum_i w_i^2 / m_i` along x, y, z, 1/kg.
    pub(super) fn block(&self, row: usize, weights: &[f64; 4]) -> DVec3 {
        let rows = self.rows[row].iter().zip(weights);
        rows.map(|(i, w)| self.nodes[*i].inverse_mass_per_kg * (w * w)).sum()
    }

    /// Energy that the impulses took from the nodes and work that prescribed motion did, J.
    ///
    /// The impulse acts at the start of the step, on the velocity of that moment.
    pub(super) fn balances(&self) -> (f64, f64) {
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
