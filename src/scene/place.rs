//! Where bodies are at the start: position and rotation, standing on others, copies.

use super::description::{Body, GROUND};
use super::settle::free_height_m;
use crate::mesh::TetMesh;
use glam::{DQuat, DVec3};

/// A rotation and then a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub rotation: DQuat,
    pub origin_m: DVec3,
}

impl Frame {
    /// Without rotation.
    pub fn at(origin_m: DVec3) -> Self {
        Self { rotation: DQuat::IDENTITY, origin_m }
    }

    /// First `inner`, then this one.
    fn after(self, inner: Self) -> Self {
        Self { rotation: self.rotation * inner.rotation, origin_m: self.point(inner.origin_m) }
    }

    fn inverse(self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, origin_m: rotation * -self.origin_m }
    }

    /// Bodies that are not turned keep every digit of their coordinates.
    fn point(self, x: DVec3) -> DVec3 {
        if self.rotation == DQuat::IDENTITY { x + self.origin_m } else { self.rotation * x + self.origin_m }
    }

    /// The mesh, turned and moved.
    pub fn applied_to(self, mesh: &TetMesh) -> TetMesh {
        TetMesh { nodes_m: mesh.nodes_m.iter().map(|&x| self.point(x)).collect(), ..mesh.clone() }
    }
}

/// What has been placed so far: an entry of the text and its copies.
pub(super) struct Placed {
    name: String,
    frame: Frame,
    pub meshes: Vec<TetMesh>,
}

impl Placed {
    /// An entry whose first copy stands in this frame.
    pub fn new(name: &str, frame: Frame) -> Self {
        Self { name: name.to_owned(), frame, meshes: Vec::new() }
    }

    /// Whether the entry has this name.
    pub fn is_called(&self, name: &str) -> bool {
        self.name == name
    }

    /// The ground.
    pub fn ground(mesh: TetMesh) -> Self {
        Self { name: GROUND.to_owned(), frame: Frame::at(DVec3::ZERO), meshes: vec![mesh] }
    }
}

/// The frame of each copy of a body whose mesh is centred; or the key at fault and why.
pub(super) fn place(
    body: &Body,
    mesh: &TetMesh,
    placed: &[Placed],
) -> Result<Vec<Frame>, (&'static str, String)> {
    let placement = &body.placement;
    let find = |name: &String| placed.iter().find(|entry| entry.name == *name);
    let axes = placement.axes_of.as_ref().and_then(find);
    let axes = axes.map_or(Frame::at(DVec3::ZERO), |entry| entry.frame);
    let mut first = Frame { rotation: placement.rotation, origin_m: placement.position_m };
    if let Some(support) = placement.on.as_ref().and_then(find) {
        first.origin_m.z += height_on(support, axes, &first.applied_to(mesh), placement.gap_m)?;
    }
    let mut frames = Vec::with_capacity(body.copies.count as usize);
    let mut turn = DQuat::IDENTITY;
    for number in 0..body.copies.count {
        frames.push(axes.after(Frame {
            rotation: turn * first.rotation,
            origin_m: first.origin_m + f64::from(number) * body.copies.offset_m,
        }));
        turn = body.copies.rotation * turn;
    }
    Ok(frames)
}

/// How far the mesh has to go up, along z of `axes`, to have `gap_m` below it.
fn height_on(
    support: &Placed,
    axes: Frame,
    mesh: &TetMesh,
    gap_m: f64,
) -> Result<f64, (&'static str, String)> {
    let into_axes = axes.inverse();
    support
        .meshes
        .iter()
        .filter_map(|lower| free_height_m(mesh, &into_axes.applied_to(lower)))
        .min_by(f64::total_cmp)
        .map(|height_m| gap_m - height_m)
        .ok_or_else(|| {
            let message = format!(
                "the body is nowhere above `{}`, so it cannot stand on it; check its `position`",
                support.name
            );
            ("on", message)
        })
}
