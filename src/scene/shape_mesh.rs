//! The tetrahedra of a shape, with their middle at the origin.

use super::shape::{MeshFile, Shape};
use crate::mesh::TetMesh;
use crate::mesh::import::{ImportOptions, read_mesh};
use crate::mesh::shapes::{self, ShapeError};
use glam::DVec3;
use std::path::Path;

/// Most elements of a whole scene.
pub(super) const ELEMENT_LIMIT: usize = shapes::ELEMENT_LIMIT as usize;

/// A body's mesh before it is put in its place.
pub(super) struct ShapeMesh {
    /// The mesh, its middle at the origin.
    pub mesh: TetMesh,
    /// What reading the file had to say.
    pub notes: Vec<String>,
}

/// Why a shape has no mesh.
pub(super) struct ShapeProblem {
    /// The key at fault, below the body.
    pub key: String,
    /// What is wrong.
    pub message: String,
}

/// Meshes a shape; mesh files are looked for from `folder`.
pub(super) fn mesh_of(shape: &Shape, folder: &Path) -> Result<ShapeMesh, ShapeProblem> {
    match shape {
        Shape::BuiltIn { shape, meshing } => {
            let mut mesh = shape.build(meshing).map_err(problem_of_shape)?;
            centre(&mut mesh);
            Ok(ShapeMesh { mesh, notes: Vec::new() })
        }
        Shape::File(file) => mesh_of_file(file, folder),
    }
}

/// A box of one cell, centred.
pub(super) fn box_mesh(size_m: DVec3) -> TetMesh {
    let corner = |c: usize| {
        let share = |axis: usize| (c >> axis & 1) as f64 - 0.5;
        size_m * DVec3::new(share(0), share(1), share(2))
    };
    // Six tetrahedra around the diagonal from corner 0 to corner 7.
    let around = [1, 3, 2, 6, 4, 5, 1];
    let tets = around.windows(2).map(|pair| [0, pair[0], pair[1], 7]);
    TetMesh::with_one_region((0..8).map(corner).collect(), tets.collect())
}

fn centre(mesh: &mut TetMesh) {
    let Some((low, high)) = mesh.bounds_m() else {
        return;
    };
    let middle_m = low.midpoint(high);
    for node_m in &mut mesh.nodes_m {
        *node_m -= middle_m;
    }
}

/// The mesher's arguments are the scene's keys with their unit at the end.
fn problem_of_shape(error: ShapeError) -> ShapeProblem {
    let (key, message) = match &error {
        ShapeError::Argument { shape, argument, value, expected } => {
            let key = argument.replace("_m", "");
            let expected = expected.replace("_m`", "`");
            let message = format!("{shape}: `{key}` is {value}, but it must be {expected}");
            (format!(".{key}"), message)
        }
        ShapeError::TooManyElements { shape, elements } => (
            String::new(),
            format!(
                "{shape}: this resolution would give about {elements:.1e} elements, and at most \
                 {ELEMENT_LIMIT} are allowed; take a larger `element_size`, a smaller \
                 `refinement` or fewer `cells`"
            ),
        ),
        ShapeError::NoCells { .. } => (".cells".to_owned(), error.to_string()),
    };
    ShapeProblem { key: format!("shape{key}"), message }
}

fn mesh_of_file(file: &MeshFile, folder: &Path) -> Result<ShapeMesh, ShapeProblem> {
    let problem = |message: String| ShapeProblem { key: "mesh.file".to_owned(), message };
    let path = folder.join(&file.file);
    if !path.exists() {
        return Err(problem(format!(
            "there is no mesh file `{}`; relative paths start at the scene's folder",
            path.display()
        )));
    }
    let options = ImportOptions { drop_bad_elements: file.drop_bad_elements };
    let imported = read_mesh(&path, &options).map_err(|error| problem(error.to_string()))?;
    let mut mesh = imported.mesh;
    if mesh.tets.len() > ELEMENT_LIMIT {
        return Err(problem(format!(
            "the mesh has {} elements, and at most {ELEMENT_LIMIT} are allowed",
            mesh.tets.len()
        )));
    }
    if !file.keep_origin {
        centre(&mut mesh);
    }
    for node_m in &mut mesh.nodes_m {
        *node_m *= file.scale;
    }
    check_extent(&mesh)?;
    Ok(ShapeMesh { mesh, notes: imported.notes })
}

/// Beyond these sizes volumes and stiffness leave the range of numbers; the built-in shapes' limits, too.
fn check_extent(mesh: &TetMesh) -> Result<(), ShapeProblem> {
    let extent_m = mesh.bounds_m().map_or(0.0, |(low, high)| (high - low).length());
    if (1e-9..=1e9).contains(&extent_m) {
        return Ok(());
    }
    Err(ShapeProblem {
        key: "mesh.scale".to_owned(),
        message: format!("the mesh becomes {extent_m:e} m large; it must be from 1e-9 to 1e9 m"),
    })
}
