//! Whether bodies are inside each other, found without any of what contact knows: by every node against every element.

use glam::{DMat3, DVec3};
use hammerfall::sim::{BodyMotion, World};

/// A node is inside an element when it is farther from each of its faces than this share of the altitude.
const DEPTH: f64 = 0.05;

/// No node of one body is inside another. Bodies that may go through each other are left out: those that supports move.
pub fn check(world: &World) -> Result<(), String> {
    let bodies = || (0..world.body_count()).filter(|body| !world.is_removed(*body));
    let gives_way = |body: usize| {
        let setup = &world.setup().bodies[body];
        matches!(setup.motion, BodyMotion::Deformable(_)) && setup.boundary.is_empty()
    };
    for a in bodies() {
        for b in bodies().filter(|b| *b != a && (gives_way(a) || gives_way(*b))) {
            if let Some((node, element)) = node_inside(world, a, b) {
                let name = |body: usize| &world.setup().bodies[body].name;
                let (a, b, time_s) = (name(a), name(b), world.time_s());
                return Err(format!(
                    "inside: node {node} of {a} is in element {element} of {b} at {time_s:.5} s"
                ));
            }
        }
    }
    Ok(())
}

fn bounds_m(points_m: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    points_m.fold(nothing, |(low, high), x| (low.min(x), high.max(x)))
}

/// The first node of `a` inside an element of `b`.
fn node_inside(world: &World, a: usize, b: usize) -> Option<(usize, usize)> {
    let (low, high) = bounds_m(world.positions_m(b).iter().copied());
    let near: Vec<(usize, DVec3)> = world
        .positions_m(a)
        .iter()
        .copied()
        .enumerate()
        .filter(|(_, x)| x.cmpge(low).all() && x.cmple(high).all())
        .collect();
    if near.is_empty() {
        return None;
    }
    world.tets(b).iter().enumerate().find_map(|(element, tet)| {
        let corners_m = tet.map(|n| world.positions_m(b)[n as usize]);
        let (low, high) = bounds_m(corners_m.into_iter());
        let within = near.iter().filter(|(_, x)| x.cmpge(low).all() && x.cmple(high).all());
        within.into_iter().find(|(_, x)| is_inside(*x, &corners_m)).map(|(node, _)| (*node, element))
    })
}

/// By barycentric coordinates, which are the distances from the faces over the altitudes.
fn is_inside(x: DVec3, [a, b, c, d]: &[DVec3; 4]) -> bool {
    let edges_m = DMat3::from_cols(*b - *a, *c - *a, *d - *a);
    let shares = edges_m.inverse() * (x - *a);
    shares.min_element() > DEPTH && shares.element_sum() < 1.0 - DEPTH
}
