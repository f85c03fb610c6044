//! Which nodes a boundary condition acts on.

use super::description::{Selection, Side};
use super::problem::suggestion;
use crate::mesh::TetMesh;
use glam::DVec3;

/// Nodes this share of the body's extent away from a side still belong to it: mesh files are rounded.
const SIDE_SHARE: f64 = 1e-5;

/// A body's mesh before and after it was put in its place.
#[derive(Clone, Copy)]
pub(super) struct PlacedMesh<'a> {
    pub own: &'a TetMesh,
    pub world: &'a TetMesh,
}

/// The nodes of a selection, in rising order.
///
/// # Errors
/// A sentence that says why there are none.
pub(super) fn select(mesh: PlacedMesh, selection: &Selection) -> Result<Vec<u32>, String> {
    let nodes = match selection {
        Selection::All => where_node(mesh.world, |_| true),
        Selection::Region(name) => nodes_of_region(mesh.world, name)?,
        Selection::Side { side, depth_m } => nodes_of_side(mesh, *side, *depth_m),
        Selection::Box { min_m, max_m } => {
            where_node(mesh.world, |x| x.cmpge(*min_m).all() && x.cmple(*max_m).all())
        }
        Selection::Sphere { center_m, radius_m } => {
            where_node(mesh.world, |x| x.distance(*center_m) <= *radius_m)
        }
    };
    if nodes.is_empty() {
        return Err(format!("no node of the body lies there{}", reach(mesh.world)));
    }
    Ok(nodes)
}

fn where_node(mesh: &TetMesh, inside: impl Fn(DVec3) -> bool) -> Vec<u32> {
    let nodes = mesh.nodes_m.iter().enumerate();
    nodes.filter(|&(_, &x)| inside(x)).map(|(index, _)| index as u32).collect()
}

fn nodes_of_region(mesh: &TetMesh, name: &str) -> Result<Vec<u32>, String> {
    let names = mesh.region_names.iter().map(String::as_str);
    let Some(region) = names.clone().position(|known| known == name) else {
        let hint = suggestion(name, names);
        return Err(format!("the body has no region called `{name}`{hint}"));
    };
    let tets = mesh.tets.iter().zip(&mesh.regions);
    let mut nodes: Vec<u32> =
        tets.filter(|(_, of)| **of as usize == region).flat_map(|(tet, _)| *tet).collect();
    nodes.sort_unstable();
    nodes.dedup();
    Ok(nodes)
}

fn nodes_of_side(mesh: PlacedMesh, side: Side, depth_m: f64) -> Vec<u32> {
    let (mesh, axis, largest) = match side {
        Side::Bottom => (mesh.world, 2, false),
        Side::Top => (mesh.world, 2, true),
        Side::Own { axis, largest } => (mesh.own, axis, largest),
    };
    let Some((low, high)) = mesh.bounds_m() else {
        return Vec::new();
    };
    let layer_m = depth_m + SIDE_SHARE * (high - low).length();
    where_node(mesh, |x| {
        let inward_m = if largest { high[axis] - x[axis] } else { x[axis] - low[axis] };
        inward_m <= layer_m
    })
}

/// Where the body is, for someone who selected beside it.
fn reach(mesh: &TetMesh) -> String {
    mesh.bounds_m().map_or_else(String::new, |(low, high)| {
        format!(
            "; it reaches from [{:.4}, {:.4}, {:.4}] to [{:.4}, {:.4}, {:.4}] m",
            low.x, low.y, low.z, high.x, high.y, high.z
        )
    })
}
