//! Pulling at a body by a spring, as with the mouse.
//!
//! A spring of stiffness `k = m / tau^2` goes from a material point of the body to a point in space that moves along a
//! path; `m` is the mass of the fragment that the material point belongs to and `tau` the time in which the body
//! follows. While it is held, the fragment is slowed down by `2 m_i v_i / tau` at every node `i`: for the motion of the
//! whole that is critical damping, and hardly any for vibration.
//!
//! The spring acts on the corners of one element with the shares `w_i` of the point in it. It raises the highest
//! frequency of the mesh by no more than `omega^2 = k sum(w_i^2 / m_i)` (Weyl: the largest eigenvalue of a sum is at
//! most the sum of the largest), which the stable step takes into account.

use super::body::{Body, Regime};
use super::elastic::StepContext;
use super::{SimError, World};
use crate::fracture::{Changes, NodeBirth};
use glam::{DMat3, DVec3};

/// Largest frequency that a spring may give the grabbed element, as a share of the mesh's highest: the step gets 2 %
/// shorter then.
const FREQUENCY_SHARE: f64 = 0.2;
/// Largest stretch that the spring may cause in the grabbed element, roughly: beyond, only that one would follow.
const LARGEST_STRAIN: f64 = 0.5;

/// A point of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// When the path is there, s.
    pub time_s: f64,
    /// Where, m.
    pub point_m: DVec3,
}

/// A spring that pulls at a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Pull {
    /// Name of the body.
    pub body: String,
    /// The grabbed point, where it was when the body came in, m.
    pub at_m: DVec3,
    /// Time in which the body follows, s, positive.
    pub follow_s: f64,
    /// Where the other end of the spring is: straight from point to point, in the order of time, at least one. The first
    /// time is that of grabbing; behind the last point it stays there.
    pub path: Vec<PathPoint>,
    /// When it lets go, s; infinite for never.
    pub until_s: f64,
}

impl Pull {
    /// When it grabs, s.
    #[must_use]
    pub fn begins_s(&self) -> f64 {
        self.path.first().map_or(f64::INFINITY, |point| point.time_s)
    }

    /// Where the other end of the spring is, m.
    #[must_use]
    pub fn target_m(&self, time_s: f64) -> DVec3 {
        let after = self.path.partition_point(|point| point.time_s <= time_s);
        let before = after.checked_sub(1).and_then(|at| self.path.get(at));
        match (before, self.path.get(after)) {
            (Some(a), Some(b)) => {
                a.point_m + (b.point_m - a.point_m) * ((time_s - a.time_s) / (b.time_s - a.time_s))
            }
            (Some(only), None) | (None, Some(only)) => only.point_m,
            (None, None) => DVec3::ZERO,
        }
    }

    /// Whether it is the same pull, perhaps with a longer path.
    fn is_same(&self, other: &Self) -> bool {
        self.body == other.body && self.at_m == other.at_m && self.begins_s() == other.begins_s()
    }

    fn check(&self) -> Result<(), SimError> {
        let fail = |text: &str| Err(SimError::Setup(format!("pull at `{}`: {text}", self.body)));
        if !(self.follow_s > 0.0 && self.follow_s.is_finite()) {
            return fail("the time in which the body follows must be positive");
        }
        if self.path.is_empty() || self.until_s.is_nan() {
            return fail("it needs a path and an end");
        }
        let is_finite = |point: &PathPoint| point.time_s.is_finite() && point.point_m.is_finite();
        if !self.at_m.is_finite() || !self.path.iter().all(is_finite) {
            return fail("its points and times must be finite");
        }
        if self.path.windows(2).any(|pair| pair[1].time_s <= pair[0].time_s) {
            return fail("the times of its path must ascend");
        }
        Ok(())
    }
}

/// A pull at work.
#[derive(Clone)]
pub(super) struct Grip {
    pub pull: Pull,
    /// The element that holds the grabbed point.
    element: u32,
    /// Shares of its corners.
    weights: [f64; 4],
    /// Nodes of the fragment.
    held: Vec<u32>,
    stiffness_n_m: f64,
    /// Slowing down of the fragment, 1/s.
    drag_per_s: f64,
    most_n: f64,
    /// `sum(w_i^2 / m_i)`, 1/kg.
    mobility_per_kg: f64,
    /// Where the grabbed point was when the forces were last found, m.
    point_m: DVec3,
    /// Forces of the spring and of the drag at the end of the last step, by node, N.
    spring_n: Vec<(u32, DVec3)>,
    drag_n: Vec<(u32, DVec3)>,
    /// No look at the path goes beyond the end of the world's step, s: later points may not be known yet.
    limit_s: f64,
    /// Whether it lets go in this step: only the work of its last forces is still to be booked.
    is_over: bool,
}

impl Grip {
    fn new(pull: Pull, body: &Body, time_s: f64) -> Self {
        let element = element_at(body, 0..body.tets.len() as u32, pull.at_m);
        let mut grip = Self {
            pull,
            element,
            weights: [0.25; 4],
            held: Vec::new(),
            stiffness_n_m: 0.0,
            drag_per_s: 0.0,
            most_n: 0.0,
            mobility_per_kg: 0.0,
            point_m: DVec3::ZERO,
            spring_n: Vec::new(),
            drag_n: Vec::new(),
            limit_s: time_s,
            is_over: false,
        };
        grip.fit(body);
        grip.point_m = grip.point_m(body);
        grip
    }

    /// Takes what the spring needs to know from the body as it is.
    fn fit(&mut self, body: &Body) {
        let Some(elasticity) = &body.elasticity else { return };
        let corners = body.tets[self.element as usize].map(|node| body.reference_m[node as usize]);
        self.weights = inner_weights(&corners, self.pull.at_m);
        self.held = nodes_of_fragment(body, self.element);
        let mass_kg: f64 = self.held.iter().map(|node| body.mass_kg[*node as usize]).sum();
        let nodes = body.tets[self.element as usize].iter().zip(self.weights);
        self.mobility_per_kg = nodes.map(|(node, w)| w * w / body.mass_kg[*node as usize]).sum();
        let highest_rad_s = 2.0 / elasticity.critical_step_s;
        let most_n_m = (FREQUENCY_SHARE * highest_rad_s).powi(2) / self.mobility_per_kg;
        self.stiffness_n_m = (mass_kg / self.pull.follow_s.powi(2)).min(most_n_m);
        self.drag_per_s = 2.0 * (self.stiffness_n_m / mass_kg).sqrt();
        let element_n = LARGEST_STRAIN * body.softest_pa * body.mean_size_m.powi(2);
        self.most_n = (self.stiffness_n_m * body.radius_m).min(element_n);
    }

    /// Where the grabbed point is, m.
    fn point_m(&self, body: &Body) -> DVec3 {
        let corners = body.tets[self.element as usize].iter().zip(self.weights);
        corners.map(|(node, w)| body.position_m[*node as usize] * w).sum()
    }

    /// Finds the forces anew after a step; returns the work of their means with those before, J.
    fn renew(&mut self, body: &Body, c: &StepContext) -> f64 {
        let point_m = self.point_m(body);
        let target_m = self.pull.target_m(c.time_s.min(self.limit_s));
        let before_n: DVec3 = self.spring_n.iter().map(|(_, force_n)| *force_n).sum();
        let pull_n = ((target_m - point_m) * self.stiffness_n_m).clamp_length_max(self.most_n);
        let force_n = if self.is_over { DVec3::ZERO } else { pull_n };
        let mut work_j = 0.5 * (before_n + force_n).dot(point_m - self.point_m);
        self.point_m = point_m;
        let power = |(node, force): &(u32, DVec3)| force.dot(body.velocity_m_s[*node as usize]);
        work_j += 0.5 * c.step_s * self.drag_n.iter().map(power).sum::<f64>();
        if self.is_over {
            (self.spring_n, self.drag_n) = Default::default();
            return work_j;
        }
        let corners = body.tets[self.element as usize].into_iter().zip(self.weights);
        self.spring_n = corners.map(|(node, w)| (node, force_n * w)).collect();
        let drag =
            |node: u32| -self.drag_per_s * body.mass_kg[node as usize] * body.velocity_m_s[node as usize];
        self.drag_n = self.held.iter().map(|node| (*node, drag(*node))).collect();
        work_j + 0.5 * c.step_s * self.drag_n.iter().map(power).sum::<f64>()
    }

    fn forces_n(&self) -> impl Iterator<Item = &(u32, DVec3)> {
        self.spring_n.iter().chain(&self.drag_n)
    }

    /// The grabbed point stays with the part of a cut element that it lies in.
    fn follow(&mut self, body: &Body, changes: &Changes) {
        let mut parts = vec![self.element];
        // Parts of parts come later.
        for new in &changes.new_elements {
            if parts.contains(&new.cut_from) {
                parts.push(new.element);
            }
        }
        self.element = element_at(body, parts.into_iter(), self.pull.at_m);
        self.fit(body);
    }
}

impl Body {
    /// Adds the forces of the pulls at the end of a step and books their work.
    pub(super) fn add_pulls(&mut self, c: &StepContext) {
        let mut grips = std::mem::take(&mut self.grips);
        for grip in &mut grips {
            self.ledger.external_j += grip.renew(self, c);
            grip.forces_n().for_each(|(node, force_n)| self.force_n[*node as usize] += *force_n);
        }
        self.grips = grips;
    }

    /// Forces of the pulls on a node as they are now, N.
    pub(super) fn pulled_n(&self, node: u32) -> DVec3 {
        let forces = self.grips.iter().flat_map(Grip::forces_n);
        forces.filter(|(at, _)| *at == node).map(|(_, force_n)| *force_n).sum()
    }

    /// Largest stable step with the pulls, s, from the one without: `(h omega)^2 / 4 + h alpha / 2 <= 1`.
    pub(super) fn pulled_step_s(&self, step_s: f64) -> f64 {
        if self.grips.is_empty() {
            return step_s;
        }
        let squares = self.grips.iter().map(|grip| grip.stiffness_n_m * grip.mobility_per_kg);
        let square_rad_s = (2.0 / step_s).powi(2) + squares.sum::<f64>();
        let half_per_s = 0.5 * self.grips.iter().map(|grip| grip.drag_per_s).sum::<f64>();
        2.0 / (half_per_s + (half_per_s * half_per_s + square_rad_s).sqrt())
    }

    /// Brings the pulls up to date with cuts: a node that has been doubled shares its forces by mass.
    pub(super) fn follow_grips(&mut self, changes: &Changes) {
        let mut grips = std::mem::take(&mut self.grips);
        for grip in &mut grips {
            for (twin, birth) in (changes.first_node..).zip(&changes.new_nodes) {
                let NodeBirth::TwinOf(parent) = *birth else { continue };
                let [twin_kg, parent_kg] = [twin, parent].map(|node| self.mass_kg[node as usize]);
                let share = twin_kg / (twin_kg + parent_kg);
                share_with_twin(&mut grip.spring_n, [parent, twin], share);
                share_with_twin(&mut grip.drag_n, [parent, twin], share);
            }
            grip.follow(self, changes);
        }
        self.grips = grips;
    }
}

fn share_with_twin(forces_n: &mut Vec<(u32, DVec3)>, [parent, twin]: [u32; 2], share: f64) {
    let Some(at) = forces_n.iter().position(|(node, _)| *node == parent) else { return };
    let force_n = forces_n[at].1;
    forces_n[at].1 = force_n * (1.0 - share);
    forces_n.push((twin, force_n * share));
}

/// Nodes of the fragment of an element, ascending; all that belong to it where nothing breaks.
fn nodes_of_fragment(body: &Body, element: u32) -> Vec<u32> {
    let nodes = 0..body.mass_kg.len() as u32;
    match &body.breaking {
        Some(breaking) => {
            let fragment = breaking.solid.fragments().of_element()[element as usize];
            let of_node = breaking.fragment_of_node();
            nodes.filter(|node| of_node[*node as usize] == fragment).collect()
        }
        None => nodes.collect(),
    }
}

/// Shares of four corners in a point, by volume (barycentric coordinates).
fn weights(corners: &[DVec3; 4], point_m: DVec3) -> [f64; 4] {
    let [a, b, c, d] = *corners;
    let inner = DMat3::from_cols(b - a, c - a, d - a).inverse() * (point_m - a);
    [1.0 - inner.element_sum(), inner.x, inner.y, inner.z]
}

/// The same, moved into the element.
fn inner_weights(corners: &[DVec3; 4], point_m: DVec3) -> [f64; 4] {
    let inside = weights(corners, point_m).map(|w| if w.is_finite() { w.max(0.0) } else { 0.25 });
    let sum: f64 = inside.iter().sum();
    inside.map(|w| w / sum)
}

/// Of these elements the one that a point of the reference shape lies in, or is nearest to in shares.
fn element_at(body: &Body, elements: impl Iterator<Item = u32>, point_m: DVec3) -> u32 {
    let depth = |element: &u32| {
        let corners = body.tets[*element as usize].map(|node| body.reference_m[node as usize]);
        let least = weights(&corners, point_m).into_iter().fold(f64::INFINITY, f64::min);
        if least.is_finite() { least } else { f64::NEG_INFINITY }
    };
    let deepest = elements.map(|element| (depth(&element), element));
    // The first of equals.
    deepest.reduce(|best, next| if next.0 > best.0 { next } else { best }).map_or(0, |(_, element)| element)
}

impl World {
    /// Begins to pull at a body.
    ///
    /// # Errors
    /// [`SimError::Setup`]: no such body, one that does not deform, or an unsound pull.
    pub fn pull(&mut self, pull: &Pull) -> Result<(), SimError> {
        pull.check()?;
        let Some(index) = self.bodies.iter().position(|body| body.name == pull.body) else {
            return Err(SimError::Setup(format!("there is no body `{}` to pull at", pull.body)));
        };
        if self.bodies[index].is_removed {
            return Ok(());
        }
        if !self.bodies[index].is_deformable() {
            return Err(SimError::Setup(format!("`{}` moves as prescribed and follows no pull", pull.body)));
        }
        self.wake(index);
        self.rest[index].disturb(self.time_s);
        let body = &mut self.bodies[index];
        let grip = Grip::new(pull.clone(), body, self.time_s);
        body.grips.push(grip);
        Ok(())
    }

    /// Gives a pull that has begun what is known of it now: more of its path, or its end.
    pub fn renew_pull(&mut self, pull: &Pull) {
        let grips = self.bodies.iter_mut().flat_map(|body| &mut body.grips);
        grips.filter(|grip| grip.pull.is_same(pull)).for_each(|grip| grip.pull = pull.clone());
    }

    /// Where a point of an element, given as it is now, was when its body came in, m: moved inwards, so that it belongs to
    /// this element and no other. `None` for what cannot be pulled at.
    pub fn grabbed_point_m(&mut self, body: usize, element: u32, point_m: DVec3) -> Option<DVec3> {
        /// Share of the way to the middle of the element.
        const INWARDS: f64 = 0.3;
        self.place_free_bodies();
        let body = self.bodies.get(body).filter(|body| body.is_deformable())?;
        let nodes = body.tets.get(element as usize)?.map(|node| node as usize);
        let shares = inner_weights(&nodes.map(|node| body.position_m[node]), point_m);
        let shares = shares.map(|w| w + (0.25 - w) * INWARDS);
        Some(nodes.iter().zip(shares).map(|(node, w)| body.reference_m[*node] * w).sum())
    }

    /// Lets go what is over, at the start of a step.
    pub(super) fn let_go(&mut self) {
        let time_s = self.time_s;
        for body in &mut self.bodies {
            body.grips.iter_mut().for_each(|grip| grip.is_over = grip.pull.until_s <= time_s);
            body.grips.retain(|grip| !grip.is_over || !grip.spring_n.is_empty());
        }
    }

    /// Tells the pulls how far the next step goes.
    pub(super) fn limit_pulls(&mut self, end_s: f64) {
        self.bodies.iter_mut().flat_map(|body| &mut body.grips).for_each(|grip| grip.limit_s = end_s);
    }

    /// Grabbed points and what they are pulled to, m.
    #[must_use]
    pub fn pulls_m(&self) -> Vec<[DVec3; 2]> {
        let pulled = self.bodies.iter().filter(|body| body.regime == Regime::Elastic);
        let ends = |body: &Body| {
            let of = |grip: &Grip| [grip.point_m(body), grip.pull.target_m(self.time_s)];
            let at_work = body.grips.iter().filter(|grip| grip.pull.until_s > self.time_s);
            at_work.map(of).collect::<Vec<_>>()
        };
        pulled.flat_map(ends).collect()
    }
}
