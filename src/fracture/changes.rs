//! What a cut did, so that whoever keeps data per node or element can follow.

use super::solid::SurfaceFace;
use glam::DVec3;

/// Where a new node comes from. Reference position, position and velocity are already those of the
/// weighted parents; other data per node should follow in the same way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NodeBirth {
    /// On an edge: `(1 - weight)` of the first end and `weight` of the second.
    OnEdge {
        /// End nodes.
        ends: [u32; 2],
        /// Weight of the second one, between 0 and 1.
        weight: f64,
    },
    /// The same place as this node, which keeps some of the elements they shared.
    TwinOf(u32),
}

/// An element that a bisection added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NewElement {
    /// Its index.
    pub element: u32,
    /// The element it was cut from, which keeps its index and the other part.
    pub cut_from: u32,
    /// Element of the mesh as given that both come from.
    pub origin: u32,
}

/// A node at which a crack opened.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeCut {
    /// The node.
    pub node: u32,
    /// Where it was at that time, m.
    pub position_m: DVec3,
    /// Unit normal of the plane, in the current position.
    pub normal: DVec3,
    /// Mean distance of the nodes around it: how far the crack ran, m.
    pub reach_m: f64,
    /// The elements around it after the cut, on both sides, and those that share a node with one
    /// of them, ascending: what feels the cut first.
    pub elements: Vec<u32>,
    /// Number of faces that cracked; at least one.
    pub cracked_faces: usize,
}

/// A fragment that came off.
#[derive(Clone, Debug, PartialEq)]
pub struct NewFragment {
    /// Its id.
    pub id: u32,
    /// The fragment it came off.
    pub parent: u32,
    /// Its elements, ascending.
    pub elements: Vec<u32>,
}

/// How often a limit kept a crack from going where it would.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LimitsReached {
    /// Bisections left out because the body has as many elements as it may.
    pub elements: u32,
    /// Nodes at which a cut was left out since it would have set free a fragment below the smallest size, each counted once.
    pub fragments: u32,
    /// Nodes at which `may_crack` let a crack not go on yet, each counted once: it would have been too fast.
    pub speed: u32,
    /// Nodes at which it let no crack start, each counted once: one close by had just relieved them.
    pub spacing: u32,
}

impl std::ops::AddAssign for LimitsReached {
    fn add_assign(&mut self, other: Self) {
        self.elements += other.elements;
        self.fragments += other.fragments;
        self.speed += other.speed;
        self.spacing += other.spacing;
    }
}

/// Everything that one call of [`super::Solid::propagate`] did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// Index of the first new node.
    pub first_node: u32,
    /// New nodes, by index from `first_node` on. Later ones may have earlier ones as parents.
    pub new_nodes: Vec<NodeBirth>,
    /// New elements, by index.
    pub new_elements: Vec<NewElement>,
    /// Elements that were there before and have other corners now, ascending.
    pub changed_elements: Vec<u32>,
    /// Nodes whose elements changed, new ones included, ascending: their masses are to be
    /// computed again.
    pub touched_nodes: Vec<u32>,
    /// Index of the first new pair of crack faces.
    pub first_crack_pair: u32,
    /// The new crack faces, by element.
    pub crack_faces: Vec<SurfaceFace>,
    /// Nodes that were cut, in order.
    pub cuts: Vec<NodeCut>,
    /// Fragments that came off, by id.
    pub new_fragments: Vec<NewFragment>,
    /// Limits that were reached.
    pub limits: LimitsReached,
    /// Kinetic energy that went with the finer lumping of masses, J: `m/8 w (1-w) |v_a - v_b|^2`
    /// for every element of mass m around a bisected edge. Never negative.
    pub kinetic_energy_lost_j: f64,
    /// Angular momentum that went the same way, `m/4 w (1-w) (x_a - x_b) x (v_a - v_b)`, kg m2/s:
    /// corner masses have more inertia than the element. Linear momentum stays.
    pub angular_momentum_lost_kg_m2_s: DVec3,
}

impl Changes {
    /// For each new node, the two nodes between which it lies, twice the same for a twin, and the weight of the second.
    #[must_use]
    pub fn parents(&self) -> Vec<([u32; 2], f64)> {
        let of = |birth: &NodeBirth| match *birth {
            NodeBirth::TwinOf(parent) => ([parent; 2], 0.0),
            NodeBirth::OnEdge { ends, weight } => (ends, weight),
        };
        self.new_nodes.iter().map(of).collect()
    }

    /// Whether nothing happened.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.new_elements.is_empty() && self.crack_faces.is_empty() && self.new_nodes.is_empty()
    }
}
