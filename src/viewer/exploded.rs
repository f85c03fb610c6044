//! Fragments moved apart, to see what is between them. Only for the eye: nothing of it reaches the simulation.

use crate::frame::{BodyFrame, BodyRole, Frame};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The frame with every fragment of a broken body moved away from the middle of its fragments, by `share` of its distance from it.
#[must_use]
pub fn exploded(frame: &Frame, share: f32) -> Frame {
    let mut moved = frame.clone();
    for body in moved.bodies.iter_mut().filter(|body| body.role == BodyRole::Deformable) {
        explode(body, share);
    }
    // Marks of contacts and pulls would hang in the air.
    moved.contacts.clear();
    moved.pulls.clear();
    moved
}

/// Whether a body is in pieces that could be moved apart.
#[must_use]
pub fn is_in_pieces(frame: &Frame) -> bool {
    let deformable = frame.bodies.iter().filter(|body| body.role == BodyRole::Deformable);
    let mut fragments = deformable.map(|body| &body.surface.triangle_fragment);
    fragments.any(|fragments| fragments.iter().any(|fragment| Some(fragment) != fragments.first()))
}

fn explode(body: &mut BodyFrame, share: f32) {
    let surface = body.surface.clone();
    let mut sums: BTreeMap<u32, (Vec3, f32)> = BTreeMap::new();
    for (index, triangle) in surface.triangles.iter().enumerate() {
        let fragment = surface.triangle_fragment.get(index).copied().unwrap_or(0);
        for vertex in triangle {
            let Some(position) = body.positions_m.get(*vertex as usize) else { continue };
            let (sum, count) = sums.entry(fragment).or_default();
            *sum += Vec3::from(*position);
            *count += 1.0;
        }
    }
    if sums.len() < 2 {
        return;
    }
    let middle = sums.values().map(|(sum, count)| *sum / *count).sum::<Vec3>() / sums.len() as f32;
    let away = |fragment: Option<u32>| {
        let (sum, count) = fragment.and_then(|fragment| sums.get(&fragment))?;
        let away = (*sum / *count - middle) * share;
        // Nothing goes down into the ground.
        Some(away.with_z(away.z.max(0.0)))
    };
    let fragment_of = fragments_of(body.positions_m.len(), &surface.triangles, &surface.triangle_fragment);
    for (position, fragment) in body.positions_m.iter_mut().zip(fragment_of) {
        move_by(position, away(fragment));
    }
    if let Some(interior) = &mut body.interior {
        let interior = Arc::make_mut(interior);
        let topology = interior.topology.clone();
        let fragment_of =
            fragments_of(interior.positions_m.len(), &topology.tets, &topology.element_fragment);
        for (position, fragment) in interior.positions_m.iter_mut().zip(fragment_of) {
            move_by(position, away(fragment));
        }
    }
}

/// The fragment that each point belongs to, by the triangles or tetrahedra at it.
fn fragments_of<const N: usize>(points: usize, cells: &[[u32; N]], fragments: &[u32]) -> Vec<Option<u32>> {
    let mut of_point = vec![None; points];
    for (index, cell) in cells.iter().enumerate() {
        let fragment = fragments.get(index).copied().unwrap_or(0);
        for point in cell {
            if let Some(of) = of_point.get_mut(*point as usize) {
                *of = Some(fragment);
            }
        }
    }
    of_point
}

fn move_by(position: &mut [f32; 3], away: Option<Vec3>) {
    if let Some(away) = away {
        *position = (Vec3::from(*position) + away).to_array();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::SurfaceTopology;

    #[test]
    fn fragments_move_apart_without_changing_their_shape() {
        let surface = SurfaceTopology {
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            triangle_fragment: vec![0, 1],
            ..SurfaceTopology::default()
        };
        let at = |x: f32| [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]];
        let body = BodyFrame {
            positions_m: at(-1.0).into_iter().chain(at(0.0)).collect(),
            surface: Arc::new(surface),
            ..BodyFrame::default()
        };
        let frame = Frame { bodies: vec![body], ..Frame::default() };
        assert!(is_in_pieces(&frame));
        let moved = &exploded(&frame, 1.0).bodies[0].positions_m;
        assert!(moved[0][0] < -1.0 && moved[3][0] > 0.0);
        assert!((moved[1][0] - moved[0][0] - 1.0).abs() < 1e-6);
        let mut whole = frame.clone();
        Arc::make_mut(&mut whole.bodies[0].surface).triangle_fragment = vec![0, 0];
        assert!(!is_in_pieces(&whole));
    }
}
