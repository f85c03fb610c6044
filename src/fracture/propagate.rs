//! One step of crack growth: which nodes are cut, by which planes (METHOD 7).

use super::changes::Changes;
use super::pace::Growth;
use super::solid::{Face, NodeState, Solid};
use glam::DVec3;

/// Which failed elements make a node crack.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PropagationRule {
    /// Two or more failed elements that share the node.
    #[default]
    TwoAtNode,
    /// A single failed element: its plane passes through its centroid and is moved through the
    /// corner nearest to it; that corner cracks.
    SingleElement,
}

/// Elements of average size that the smallest fragment holds by default: a shard, not a splinter.
pub const SMALLEST_FRAGMENT_ELEMENTS: f64 = 6.0;

/// Limits of what fracture may do to a body. Reaching one is counted in [`super::LimitsReached`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FractureLimits {
    /// Most elements of the body; beyond it cracks run along the faces that are there.
    pub max_elements: usize,
    /// No fragment of fewer elements comes off.
    pub smallest_fragment_elements: u32,
    /// No lighter fragment comes off, kg.
    pub smallest_fragment_kg: f64,
}

impl Default for FractureLimits {
    fn default() -> Self {
        Self { max_elements: 1_000_000, smallest_fragment_elements: 1, smallest_fragment_kg: 0.0 }
    }
}

impl FractureLimits {
    /// Limits that suit a body: no fragment below six of its average elements, so that what fails
    /// all over breaks into shards rather than into single elements, and at most eight times its
    /// elements.
    #[must_use]
    pub fn for_body(solid: &Solid) -> Self {
        let mass_kg: f64 = solid.masses_kg().iter().sum();
        let elements = solid.tets().len();
        Self {
            max_elements: 8 * elements,
            smallest_fragment_elements: 1,
            smallest_fragment_kg: SMALLEST_FRAGMENT_ELEMENTS * mass_kg / elements.max(1) as f64,
        }
    }
}

/// How cracks grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Propagation {
    /// Which failed elements make a node crack.
    pub rule: PropagationRule,
    /// A surface (of the body or of an older crack) that runs along the cutting plane within this
    /// angle, radians, takes the plane's place: no thin flake is cut off beside it.
    pub surface_snap_rad: f64,
    /// Limits.
    pub limits: FractureLimits,
}

impl Default for Propagation {
    fn default() -> Self {
        let limits = FractureLimits::default();
        Self { rule: PropagationRule::default(), surface_snap_rad: 0.35, limits }
    }
}

/// An element that fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failure {
    /// The element.
    pub element: u32,
    /// Unit normal of its cutting plane, in the current position.
    pub normal: DVec3,
    /// Failure index: the worst go first.
    pub index: f64,
}

/// A body under the knife.
pub(super) struct Surgery<'a> {
    pub solid: &'a mut Solid,
    pub nodes: NodeState<'a>,
    pub settings: &'a Propagation,
    pub changes: Changes,
    pub first_element: u32,
    /// Elements with other corners or faces than before, and nodes with other elements; with repetitions.
    pub changed: Vec<u32>,
    pub touched_nodes: Vec<u32>,
}

impl Solid {
    /// Lets cracks grow by at most one ring of elements.
    ///
    /// Nodes at which a crack ends come first, then those with the greatest sums of failure
    /// indices; no element takes part in
    /// two cuts of one call. A node is cut only if `may_crack` allows it for every element around
    /// it: the place to limit the speed of cracks and their number ([`super::CrackPace`]) or to spare a region.
    /// The work grows with the number of failures and of cuts, not with the body.
    ///
    /// `nodes` must hold as many entries as there are nodes.
    pub fn propagate(
        &mut self,
        nodes: NodeState<'_>,
        failures: &[Failure],
        settings: &Propagation,
        may_crack: impl Fn(u32, Growth) -> bool,
    ) -> Changes {
        let candidates = self.candidates(nodes.positions_m, failures, settings.rule);
        let mut surgery = Surgery::begin(self, nodes, settings);
        for candidate in candidates {
            if surgery.is_free(candidate.node, candidate.growth(), &may_crack)
                && !surgery.cut_node(candidate.node, candidate.normal)
            {
                surgery.solid.vain_call[candidate.node as usize] = surgery.solid.calls;
            }
        }
        surgery.finish()
    }

    /// Cuts the elements around one node by the plane through it, whatever their stress.
    ///
    /// `normal` must be a unit vector, `nodes` as for [`Self::propagate`].
    pub fn cut_node(
        &mut self,
        nodes: NodeState<'_>,
        node: u32,
        normal: DVec3,
        settings: &Propagation,
    ) -> Changes {
        let mut surgery = Surgery::begin(self, nodes, settings);
        surgery.cut_node(node, normal);
        surgery.finish()
    }
}

impl<'a> Surgery<'a> {
    fn begin(solid: &'a mut Solid, nodes: NodeState<'a>, settings: &'a Propagation) -> Self {
        debug_assert_eq!(nodes.positions_m.len(), solid.node_count());
        debug_assert_eq!(nodes.velocities_m_s.len(), solid.node_count());
        solid.calls += 1;
        let changes = Changes {
            first_node: solid.node_count() as u32,
            first_crack_pair: solid.crack_pairs,
            ..Changes::default()
        };
        let first_element = solid.tets.len() as u32;
        let (changed, touched_nodes) = (Vec::new(), Vec::new());
        Self { solid, nodes, settings, changes, first_element, changed, touched_nodes }
    }

    /// Whether no element at the node was changed in this call, all of them may crack, and their
    /// fragment is large enough to be broken.
    fn is_free(&mut self, node: u32, growth: Growth, may_crack: impl Fn(u32, Growth) -> bool) -> bool {
        let solid = &*self.solid;
        let elements = solid.elements_at(node);
        if elements.iter().any(|&element| solid.touched_in_call[element as usize] == solid.calls) {
            return false;
        }
        if solid.rests(node) {
            return false;
        }
        let fragments = &solid.fragments;
        let fragment = fragments.list()[fragments.of_element()[elements[0] as usize] as usize];
        let limits = &self.settings.limits;
        if fragment.elements < 2 * limits.smallest_fragment_elements
            || fragment.mass_kg < 2.0 * limits.smallest_fragment_kg
        {
            self.leave_whole(node);
            return false;
        }
        let is_allowed = elements.iter().all(|&element| may_crack(element, growth));
        let limits = &mut self.changes.limits;
        match growth {
            _ if is_allowed => {}
            Growth::GoesOn => limits.speed += u32::from(self.solid.too_fast.insert(node)),
            Growth::Starts => limits.spacing += u32::from(self.solid.shielded.insert(node)),
        }
        is_allowed
    }

    /// Notes that a node is not cut since a fragment would be too small.
    pub(super) fn leave_whole(&mut self, node: u32) {
        self.changes.limits.fragments += u32::from(self.solid.left_whole.insert(node));
    }

    /// Notes that an element takes part in a cut.
    pub(super) fn mark_touched(&mut self, element: u32) {
        self.solid.touched_in_call[element as usize] = self.solid.calls;
    }

    /// Notes that an element has other corners or faces than before.
    pub(super) fn mark_changed(&mut self, element: u32) {
        self.mark_touched(element);
        self.changed.push(element);
    }

    fn finish(mut self) -> Changes {
        let first_element = self.first_element;
        sort_and_dedup(&mut self.changed);
        sort_and_dedup(&mut self.touched_nodes);
        let solid = &*self.solid;
        let new = first_element..solid.tets.len() as u32;
        let old = || self.changed.iter().copied().filter(|&element| element < first_element);
        let first_pair = self.changes.first_crack_pair;
        let is_new = |kind: Face| matches!(kind, Face::Crack { pair, .. } if pair >= first_pair);
        let crack_faces = old()
            .chain(new)
            .flat_map(|element| solid.surface_of(element))
            .filter(|face| is_new(face.kind))
            .collect();
        Changes {
            changed_elements: old().collect(),
            touched_nodes: self.touched_nodes,
            crack_faces,
            ..self.changes
        }
    }
}

pub(super) fn sort_and_dedup(values: &mut Vec<u32>) {
    values.sort_unstable();
    values.dedup();
}
