//! Boxes around a body for contact with itself, which move along with it.

use super::body::Body;
use crate::contact::SurfaceBoxes;
use crate::math::{best_fit_rotation, in_parts};
use crate::mesh::Renumbering;
use glam::{DMat3, DQuat, DVec3};

/// How far boxes are fattened, as a share of the body's mean surface element size: rebuilding them costs most of the search in
/// soft bodies, candidates on the far side of thin ones the rest.
const MARGIN: f64 = 0.3;
/// The same once the body has cracked and each node's boxes move when they have to;
const CRACKED_MARGIN: f64 = 0.15;
/// they are then also fattened along each axis by the way that the node makes within the body in so many steps,
const MARGIN_STEPS: f64 = 32.0;
/// up to this share of the mean size.
const MOST_MARGIN: f64 = 1.0;
/// Change of shape, as a share of the margin, up to which boxes hold.
const SHARE: f64 = 0.4;
/// Part of it that a node must have used up for its boxes to be moved when some node has used up all.
const MOVED: f64 = 0.5;
/// All boxes are renewed where more of the triangles are affected than this share, as its inverse.
const MOST_AFFECTED: usize = 6;
/// Nodes whose ways one task measures.
const NODES_AT_ONCE: usize = 4096;

/// Boxes around a body's shape, kept while it moves on as a whole and changes its shape but little. Those around nodes that
/// have outrun them, as the splinters of a body that bursts do, are moved without the rest.
#[derive(Clone)]
pub(super) struct OwnBoxes {
    pub boxes: SurfaceBoxes,
    /// Counts how often all of them were renewed.
    pub stamp: u64,
    orientation: DQuat,
    /// Way that nodes may still make before the next look, m.
    spare_m: f64,
    time_s: f64,
}

impl OwnBoxes {
    /// Puts boxes around the body as it is, those that were around it before if there are any. `step_s` is the length of the step
    /// to come.
    fn around(body: &Body, before: Option<Self>, (time_s, step_s): (f64, f64)) -> Self {
        let (surface, positions_m) = (&body.surface, &body.position_m);
        let stamp = before.as_ref().map_or(0, |own| own.stamp + 1);
        let before = before.map(|own| own.boxes);
        let boxes = SurfaceBoxes::moved_or_new(
            before,
            surface,
            positions_m,
            margins_m(body, DMat3::IDENTITY, step_s),
        );
        Self { boxes, stamp, orientation: DQuat::IDENTITY, spare_m: SHARE * margin_m(body), time_s }
    }

    /// Renews what is out of date of boxes around a body, or puts the first ones there. Returns which nodes the boxes have
    /// followed; `None` where all or none were renewed.
    pub fn renew(own: &mut Option<Self>, body: &Body, (time_s, step_s): (f64, f64)) -> Option<Renumbering> {
        if let Some(own) = own {
            let change = own.outrun_by(body, time_s)?;
            if let Some(numbers) = own.move_some(body, &change, step_s) {
                return Some(numbers);
            }
        }
        *own = Some(Self::around(body, own.take(), (time_s, step_s)));
        None
    }

    /// How the shape has changed when that may be more than the boxes allow, at `time_s`; `None` while they hold.
    fn outrun_by(&mut self, body: &Body, time_s: f64) -> Option<ChangeOfShape> {
        // In a body that bursts nodes are too different for one measure.
        if !body.surface.has_cracked() {
            // Half of it for speeding up.
            self.spare_m -= 2.0 * body.inner_speed_m_s() * (time_s - self.time_s);
            self.time_s = time_s;
            if self.spare_m > 0.0 {
                return None;
            }
        }
        let change = self.change(body);
        let spare = 1.0 - change.largest_share();
        self.spare_m = spare * SHARE * margin_m(body);
        (spare < 0.0).then_some(change)
    }

    /// The change of shape, seen in the frame that fits it best.
    fn change(&mut self, body: &Body) -> ChangeOfShape {
        let nodes = || body.surface.nodes.iter().map(|n| *n as usize);
        let built = self.boxes.built_at_m();
        let count = body.surface.nodes.len().max(1) as f64;
        let centre_then_m: DVec3 = nodes().map(|n| built[n]).sum::<DVec3>() / count;
        let centre_now_m: DVec3 = nodes().map(|n| body.position_m[n]).sum::<DVec3>() / count;
        let mut moment = DMat3::ZERO;
        for n in nodes() {
            let (now, then) = (body.position_m[n] - centre_now_m, built[n] - centre_then_m);
            moment += DMat3::from_cols(now * then.x, now * then.y, now * then.z);
        }
        self.orientation = best_fit_rotation(&moment, self.orientation);
        let turn = DMat3::from_quat(self.orientation);
        let change = ChangeOfShape { centre_then_m, centre_now_m, turn, of_nodes: Vec::new() };
        let share = |node: u32| {
            let way_m = change.taken_back(body.position_m[node as usize]) - built[node as usize];
            (way_m / (SHARE * self.boxes.margin_m(node))).length()
        };
        let of_nodes = in_parts::map(&body.surface.nodes, NODES_AT_ONCE, |n| (*n, share(*n)));
        ChangeOfShape { of_nodes, ..change }
    }

    /// Moves the boxes of the nodes that have changed their places most to where they are by now. Returns which they were, or
    /// `None` where they are so many that all had better be renewed.
    fn move_some(&mut self, body: &Body, change: &ChangeOfShape, step_s: f64) -> Option<Renumbering> {
        let surface = &body.surface;
        let mut is_affected = vec![false; body.position_m.len()];
        for (node, share) in &change.of_nodes {
            is_affected[*node as usize] = *share > MOVED;
        }
        let edges = surface.edges.iter().map(|edge| edge.nodes);
        let numbers = Renumbering::unchanged(&surface.triangles, edges, is_affected);
        if numbers.affected_triangles().len() > surface.triangles.len() / MOST_AFFECTED {
            return None;
        }
        let margin_m = margins_m(body, change.turn.transpose(), step_s);
        let now = |n: u32| (change.taken_back(body.position_m[n as usize]), margin_m(n));
        self.boxes.move_affected(surface, &numbers, now);
        Some(numbers)
    }
}

/// By how much the boxes of a body are fattened at least, m.
fn margin_m(body: &Body) -> f64 {
    let margin = if body.surface.has_cracked() { CRACKED_MARGIN } else { MARGIN };
    margin * body.mean_size_m
}

/// By how much the boxes of each node are fattened along each axis, m. `turn` takes velocities to the frame of the boxes.
fn margins_m(body: &Body, turn: DMat3, step_s: f64) -> impl Fn(u32) -> DVec3 {
    let [least_m, most_m] = [margin_m(body), MOST_MARGIN * body.mean_size_m].map(DVec3::splat);
    let ahead_s = if body.surface.has_cracked() { MARGIN_STEPS * step_s } else { 0.0 };
    let velocity_m_s = body.inner_velocity_m_s();
    move |node| (least_m + (turn * velocity_m_s(node)).abs() * ahead_s).min(most_m)
}

/// How a body has changed its shape since boxes were put around it.
struct ChangeOfShape {
    /// Middle of the nodes of its surface then and now, m, and how it has turned.
    centre_then_m: DVec3,
    centre_now_m: DVec3,
    turn: DMat3,
    /// Nodes of the surface and how far each is from where the turned and shifted shape has it, as a share of what its boxes allow.
    of_nodes: Vec<(u32, f64)>,
}

impl ChangeOfShape {
    fn largest_share(&self) -> f64 {
        self.of_nodes.iter().map(|x| x.1).fold(0.0, f64::max)
    }

    /// A present place as it is in the shape around which the boxes were put, m.
    fn taken_back(&self, now_m: DVec3) -> DVec3 {
        self.centre_then_m + self.turn.transpose() * (now_m - self.centre_now_m)
    }
}
