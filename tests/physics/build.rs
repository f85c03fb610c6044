//! Small worlds for the tests.

use glam::DVec3;
use hammerfall::mesh::TetMesh;
use hammerfall::mesh::shapes::{BoxShape, HexSplit, Meshing, Resolution, Shape};
use hammerfall::sim::{BodyMotion, BodySetup, Material, Sample, World, WorldSetup};

pub fn steel() -> Material {
    material(7844.0, 206.82e9, 0.3)
}

pub fn rubber() -> Material {
    material(1100.0, 2e6, 0.4)
}

pub fn material(density_kg_m3: f64, youngs_modulus_pa: f64, poisson_ratio: f64) -> Material {
    Material::elastic("test", density_kg_m3, youngs_modulus_pa, poisson_ratio)
}

/// A box of the given sizes (m) and cells, its centre at `centre_m`.
pub fn box_mesh(size_m: DVec3, cells: [u32; 3], centre_m: DVec3) -> TetMesh {
    let shape = Shape::Box(BoxShape { size_m });
    let meshing = Meshing { resolution: Resolution::Cells(cells), split: HexSplit::default() };
    let mut mesh = shape.build(&meshing).expect("a sound box");
    mesh.nodes_m.iter_mut().for_each(|x| *x += centre_m);
    mesh
}

pub fn body(name: &str, mesh: TetMesh, material: Material) -> BodySetup {
    BodySetup::at_rest(name, mesh, material)
}

pub fn fixed(name: &str, mesh: TetMesh) -> BodySetup {
    BodySetup { motion: BodyMotion::Fixed, ..body(name, mesh, steel()) }
}

/// A world without gravity and friction.
pub fn quiet_world(bodies: Vec<BodySetup>) -> WorldSetup {
    let mut setup = WorldSetup { bodies, ..WorldSetup::default() };
    setup.contact.friction_coefficient = 0.0;
    setup
}

/// Steps to `end_s` and calls `each` after every step.
pub fn run(world: &mut World, end_s: f64, mut each: impl FnMut(&World, &Sample)) {
    while world.time_s() < end_s {
        world.step(end_s).expect("the run stays finite");
        let sample = world.sample();
        each(world, &sample);
    }
}
