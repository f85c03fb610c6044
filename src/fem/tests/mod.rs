//! Tests of the whole module, and what they share.

mod forces;
mod large_strain;
mod stable_step;

use super::test_support::Random;
use super::*;
use crate::math::rotation_from_vector;
use crate::mesh::TetMesh;
use glam::{DMat3, DVec3};

const STEEL: ElasticConstants = ElasticConstants { lambda_pa: 1.2e11, mu_pa: 8e10, density_kg_m3: 7850.0 };
const RUBBER: ElasticConstants = ElasticConstants { lambda_pa: 2e7, mu_pa: 1e6, density_kg_m3: 1100.0 };

/// Alternating steel and rubber.
fn two_materials(elements: usize) -> Vec<ElasticConstants> {
    (0..elements).map(|e| if e % 3 == 0 { STEEL } else { RUBBER }).collect()
}

fn batches(mesh: &TetMesh, constants: &[ElasticConstants]) -> ElementBatches {
    ElementBatches::new(&mesh.nodes_m, &mesh.tets, constants).unwrap()
}

fn all_kinematics() -> [ElementKinematics; 4] {
    let turn = rotation_from_vector(DVec3::new(0.5, -1.2, 0.8));
    let rotation = DMat3::from_quat(turn);
    [
        ElementKinematics::Green,
        ElementKinematics::BodyFrame { rotation },
        ElementKinematics::Corotated,
        ElementKinematics::NeoHookean,
    ]
}

fn rotation_of(kinematics: ElementKinematics) -> DMat3 {
    match kinematics {
        ElementKinematics::BodyFrame { rotation } => rotation,
        _ => DMat3::IDENTITY,
    }
}

fn forces(body: &ElementBatches, x: &[DVec3], kinematics: ElementKinematics) -> (Vec<DVec3>, ElasticState) {
    let mut forces_n = vec![DVec3::NAN; x.len()];
    let state = body.forces(&mut ForceScratch::default(), x, kinematics, &mut forces_n);
    (forces_n, state)
}

/// Every node moved by up to `amplitude`, in the axes of the body.
fn shaken(mesh: &TetMesh, amplitude: f64, kinematics: ElementKinematics) -> Vec<DVec3> {
    let mut random = Random(7);
    let rotation = rotation_of(kinematics);
    let moved = |x: &DVec3| rotation * (*x + amplitude * random.vector()) + DVec3::new(3.0, 1.0, -2.0);
    mesh.nodes_m.iter().map(moved).collect()
}

fn largest(vectors: &[DVec3]) -> f64 {
    vectors.iter().fold(0.0, |most, v| f64::max(most, v.abs().max_element()))
}
