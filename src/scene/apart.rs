//! Bodies that overlap at the start are refused, by name, depth and place.

use super::build::{BuildProblem, BuiltBody};
use super::description::{GROUND, SceneDescription};
use super::settle::free_height_m;
use crate::mesh::boxes;
use crate::mesh::{Overlap, overlap};
use crate::sim::BodyMotion;
use parry3d_f64::bounding_volume::BoundingVolume;

/// One problem for each two bodies that overlap. Bodies none of which deforms may: a wall may stand in the
/// ground.
pub(super) fn overlaps(scene: &SceneDescription, bodies: &[BuiltBody]) -> Vec<BuildProblem> {
    let boxes: Vec<_> = bodies.iter().map(|body| boxes::of_mesh(&body.setup.mesh)).collect();
    let mut problems = Vec::new();
    for second in 0..bodies.len() {
        for first in 0..second {
            let near = boxes[first].zip(boxes[second]).is_some_and(|(a, b)| a.intersects(&b));
            let (a, b) = (&bodies[first], &bodies[second]);
            if !near || !(deforms(a) || deforms(b)) {
                continue;
            }
            if let Some(found) = overlap(&a.setup.mesh, &b.setup.mesh) {
                let entry = b.entry.or(a.entry).unwrap_or(0);
                let message = in_words(scene, a, b, found);
                problems.push((format!("bodies[{entry}].position"), message));
            }
        }
    }
    problems
}

fn deforms(body: &BuiltBody) -> bool {
    matches!(body.setup.motion, BodyMotion::Deformable(_))
}

fn in_words(scene: &SceneDescription, a: &BuiltBody, b: &BuiltBody, found: Overlap) -> String {
    let near = found.near_m;
    format!(
        "`{}` and `{}` overlap at the start, by {:.3e} m or more near [{:.4}, {:.4}, {:.4}]; {}",
        a.setup.name,
        b.setup.name,
        found.depth_m,
        near.x,
        near.y,
        near.z,
        remedy(scene, a, b)
    )
}

/// What helps: the later body of the text is the one to move.
fn remedy(scene: &SceneDescription, a: &BuiltBody, b: &BuiltBody) -> String {
    if a.entry == b.entry {
        return "take a larger `offset` of the copies".to_owned();
    }
    let lift_m = free_height_m(&b.setup.mesh, &a.setup.mesh).map_or(0.0, |height_m| -height_m);
    let name = a.entry.map_or(GROUND, |entry| scene.bodies[entry].name.as_str());
    format!(
        "move one of them: `{}` is clear {lift_m:.4} m higher, and `on = \"{name}\"` would put it \
         there",
        b.setup.name
    )
}
