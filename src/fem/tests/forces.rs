//! Forces, stress and mass: physics, determinism, and the fast kernel against plain code.

use super::*;
use crate::fem::test_support::box_mesh;
use crate::math::{MassProperties, best_fit_rotation, symmetric_eigen, symmetric_eigenvalues};
use crate::mesh::signed_volume_m3;
use glam::DQuat;

/// Forces straight from the definition, element by element.
fn plain_forces(
    mesh: &TetMesh,
    constants: &[ElasticConstants],
    x: &[DVec3],
    kinematics: ElementKinematics,
) -> (Vec<DVec3>, f64) {
    let edges = |x: [DVec3; 4]| DMat3::from_cols(x[1] - x[0], x[2] - x[0], x[3] - x[0]);
    let (mut forces_n, mut energy_j) = (vec![DVec3::ZERO; x.len()], 0.0);
    for (element, tet) in mesh.tets.iter().enumerate() {
        let inverse = edges(mesh.corners_m(element)).inverse();
        let f = edges(tet.map(|node| x[node as usize])) * inverse;
        let volume_m3 = signed_volume_m3(&mesh.corners_m(element));
        let law = &constants[element];
        let (first_piola, energy_pa) = match kinematics {
            ElementKinematics::Green => {
                let strain = (f.transpose() * f - DMat3::IDENTITY) * 0.5;
                (f * law.stress_pa(&strain), linear_energy_pa(law, &strain))
            }
            ElementKinematics::BodyFrame { rotation } => {
                let seen = rotation.transpose() * f;
                let strain = (seen + seen.transpose()) * 0.5 - DMat3::IDENTITY;
                (rotation * law.stress_pa(&strain), linear_energy_pa(law, &strain))
            }
            ElementKinematics::Corotated => {
                // The stretch as the root of F^T F; these elements are not inverted.
                let squared = symmetric_eigen(&(f.transpose() * f));
                let axes = squared.directions;
                let stretch = axes * DMat3::from_diagonal(squared.values.map(f64::sqrt)) * axes.transpose();
                let strain = stretch - DMat3::IDENTITY;
                (f * stretch.inverse() * law.stress_pa(&strain), linear_energy_pa(law, &strain))
            }
            ElementKinematics::NeoHookean => published_neo_hookean(law, &f),
        };
        energy_j += volume_m3 * energy_pa;
        // Columns of -V0 P Dm^-T are the forces on corners 1, 2, 3.
        let corner_forces = first_piola * inverse.transpose() * -volume_m3;
        for corner in 0..3 {
            forces_n[tet[corner + 1] as usize] += corner_forces.col(corner);
            forces_n[tet[0] as usize] -= corner_forces.col(corner);
        }
    }
    (forces_n, energy_j)
}

fn linear_energy_pa(law: &ElasticConstants, strain: &DMat3) -> f64 {
    let products = law.stress_pa(strain).to_cols_array().into_iter().zip(strain.to_cols_array());
    0.5 * products.map(|(s, e)| s * e).sum::<f64>()
}

/// `P` and `W - W(I)` as equation 14 of Smith, de Goes and Kim has them.
fn published_neo_hookean(law: &ElasticConstants, f: &DMat3) -> (DMat3, f64) {
    let (mu, lambda) = (4.0 / 3.0 * law.mu_pa, law.lambda_pa + 5.0 / 6.0 * law.mu_pa);
    let alpha = 1.0 + mu / lambda - mu / (4.0 * lambda);
    let energy = |f: &DMat3| {
        let squares = f.to_cols_array().iter().map(|x| x * x).sum::<f64>();
        0.5 * mu * (squares - 3.0) + 0.5 * lambda * (f.determinant() - alpha).powi(2)
            - 0.5 * mu * (squares + 1.0).ln()
    };
    let squares = f.to_cols_array().iter().map(|x| x * x).sum::<f64>();
    let cofactor = f.inverse().transpose() * f.determinant();
    let first_piola =
        *f * (mu * (1.0 - 1.0 / (squares + 1.0))) + cofactor * (lambda * (f.determinant() - alpha));
    (first_piola, energy(f) - energy(&DMat3::IDENTITY))
}

#[test]
fn fast_forces_equal_the_definition() {
    // 5 x 4 x 3 cells leave a last batch that is not full; the larger mesh has several chunks.
    for cells in [[5, 4, 3], [9, 10, 8]] {
        let mesh = box_mesh(cells, 0.15);
        let constants = two_materials(mesh.tets.len());
        let body = batches(&mesh, &constants);
        for kinematics in all_kinematics() {
            let x = shaken(&mesh, 0.01, kinematics);
            let (fast, state) = forces(&body, &x, kinematics);
            let (plain, energy_j) = plain_forces(&mesh, &constants, &x, kinematics);
            let difference: Vec<DVec3> = fast.iter().zip(&plain).map(|(a, b)| *a - *b).collect();
            assert!(
                largest(&difference) < 1e-12 * largest(&plain),
                "{:e}",
                largest(&difference) / largest(&plain)
            );
            // The published energy is a difference of large numbers.
            let digits = if kinematics == ElementKinematics::NeoHookean { 1e-10 } else { 1e-12 };
            assert!((state.strain_energy_j / energy_j - 1.0).abs() < digits);
            let slow_energy_j = body.strain_energy_j(&x, kinematics);
            assert!((slow_energy_j / state.strain_energy_j - 1.0).abs() < 1e-12);
        }
    }
}

/// Asserts that the forces are the slope of the energy, downhill, by central differences of `step_m`.
pub(super) fn assert_downhill(
    body: &ElementBatches,
    x: &[DVec3],
    kinematics: ElementKinematics,
    step_m: f64,
) {
    let (forces_n, _) = forces(body, x, kinematics);
    for node in 0..x.len() {
        for axis in 0..3 {
            let energy_at = |shift: f64| {
                let mut moved = x.to_vec();
                moved[node][axis] += shift;
                forces(body, &moved, kinematics).1.strain_energy_j
            };
            let slope = (energy_at(step_m) - energy_at(-step_m)) / (2.0 * step_m);
            let error = (forces_n[node][axis] + slope).abs() / largest(&forces_n);
            assert!(error < 1e-8, "{kinematics:?} node {node} axis {axis}: {error:e}");
        }
    }
}

#[test]
fn forces_are_the_downhill_slope_of_the_energy() {
    let mesh = box_mesh([2, 2, 2], 0.2);
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    for kinematics in all_kinematics() {
        let x = shaken(&mesh, 0.1, kinematics);
        assert_downhill(&body, &x, kinematics, 1e-5);
    }
}

#[test]
fn patch_test_constant_strain_gives_constant_stress_and_no_inner_force() {
    let cells = [4, 3, 5];
    let mesh = box_mesh(cells, 0.2);
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    let stretch = DMat3::from_cols_array(&[1.02, 0.01, -0.02, 0.03, 0.97, 0.01, 0.0, -0.01, 1.01]);
    for kinematics in all_kinematics() {
        let rotation = rotation_of(kinematics);
        let x: Vec<DVec3> = mesh.nodes_m.iter().map(|x| rotation * (stretch * *x)).collect();
        let expected = match kinematics {
            ElementKinematics::BodyFrame { rotation } => {
                let strain = (stretch + stretch.transpose()) * 0.5 - DMat3::IDENTITY;
                rotation * STEEL.stress_pa(&strain) * rotation.transpose()
            }
            ElementKinematics::Green => {
                let strain = (stretch.transpose() * stretch - DMat3::IDENTITY) * 0.5;
                stretch * STEEL.stress_pa(&strain) * stretch.transpose() * stretch.determinant().recip()
            }
            ElementKinematics::Corotated => {
                let squared = symmetric_eigen(&(stretch.transpose() * stretch));
                let (axes, roots) = (squared.directions, squared.values.map(f64::sqrt));
                let right = axes * DMat3::from_diagonal(roots) * axes.transpose();
                let rotation = stretch * right.inverse();
                let pulled = rotation * STEEL.stress_pa(&(right - DMat3::IDENTITY));
                pulled * stretch.transpose() * stretch.determinant().recip()
            }
            ElementKinematics::NeoHookean => {
                published_neo_hookean(&STEEL, &stretch).0
                    * stretch.transpose()
                    * stretch.determinant().recip()
            }
        };
        for stress in body.cauchy_stresses_pa(&x, kinematics) {
            assert!(stress.abs_diff_eq(expected, 1e-12 * STEEL.mu_pa));
        }
        let (forces_n, _) = forces(&body, &x, kinematics);
        let is_inner = |x: &DVec3| x.min_element() > 1e-9 && x.max_element() < 1.0 - 1e-9;
        let inner: Vec<DVec3> =
            mesh.nodes_m.iter().zip(&forces_n).filter(|(x, _)| is_inner(x)).map(|(_, f)| *f).collect();
        assert_eq!(inner.len(), 3 * 2 * 4);
        assert!(largest(&inner) < 1e-12 * largest(&forces_n));
    }
}

#[test]
fn rigid_motion_is_free_of_stress() {
    let mesh = box_mesh([3, 3, 3], 0.2);
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    let turn = rotation_from_vector(DVec3::new(2.0, 1.0, -1.5));
    let x: Vec<DVec3> = mesh.nodes_m.iter().map(|x| turn * *x + DVec3::splat(10.0)).collect();
    let mut all = all_kinematics();
    all[1] = ElementKinematics::BodyFrame { rotation: DMat3::from_quat(turn) };
    for kinematics in all {
        for stress in body.cauchy_stresses_pa(&x, kinematics) {
            assert!(stress.abs_diff_eq(DMat3::ZERO, 1e-12 * STEEL.mu_pa));
        }
        let (forces_n, state) = forces(&body, &x, kinematics);
        assert!(largest(&forces_n) < 1e-12 * STEEL.mu_pa);
        assert!(state.max_strain < 1e-13);
        assert!(state.strain_energy_j < 1e-24 * STEEL.mu_pa);
    }
}

#[test]
fn inner_forces_have_no_resultant() {
    let mesh = box_mesh([4, 4, 4], 0.2);
    let body = batches(&mesh, &two_materials(mesh.tets.len()));
    for kinematics in all_kinematics() {
        let x = shaken(&mesh, 0.05, kinematics);
        let (forces_n, _) = forces(&body, &x, kinematics);
        let sum: DVec3 = forces_n.iter().sum();
        assert!(sum.abs().max_element() < 1e-13 * largest(&forces_n) * x.len() as f64);
        let torque: DVec3 = x.iter().zip(&forces_n).map(|(x, f)| x.cross(*f)).sum();
        if !matches!(kinematics, ElementKinematics::BodyFrame { .. }) {
            assert!(torque.abs().max_element() < 1e-12 * largest(&forces_n) * x.len() as f64);
        }
    }
}

#[test]
fn same_bytes_for_any_thread_count_and_instruction_set() {
    let mesh = box_mesh([12, 12, 12], 0.2);
    let mut body = batches(&mesh, &two_materials(mesh.tets.len()));
    for kinematics in all_kinematics() {
        let x = shaken(&mesh, 0.01, kinematics);
        let in_pool = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| forces(&body, &x, kinematics))
        };
        let one = in_pool(1);
        assert!(one == in_pool(2) && one == in_pool(2) && one == in_pool(3));
    }
    let fastest: Vec<_> = all_kinematics().map(|k| forces(&body, &shaken(&mesh, 0.01, k), k)).into();
    body.arch = pulp::Arch::Scalar;
    let plainest: Vec<_> = all_kinematics().map(|k| forces(&body, &shaken(&mesh, 0.01, k), k)).into();
    assert!(fastest == plainest);
}

#[test]
fn mass_is_volume_times_density() {
    let mesh = box_mesh([4, 3, 2], 0.2);
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    let masses_kg = body.lumped_masses_kg(None);
    let whole = MassProperties::of_points(&masses_kg, &mesh.nodes_m);
    assert!((whole.mass_kg / 7850.0 - 1.0).abs() < 1e-14);
    assert!((whole.centre_m - DVec3::splat(0.5)).length() < 0.05);
    let doubled = body.lumped_masses_kg(Some(&vec![2.0; mesh.tets.len()]));
    assert!(doubled.iter().zip(&masses_kg).all(|(a, b)| *a == 2.0 * b));
    assert_eq!(body.element_masses_kg().len(), mesh.tets.len());
}

#[test]
fn finds_the_first_place_that_is_not_finite() {
    let mesh = box_mesh([2, 2, 2], 0.0);
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    for kinematics in all_kinematics() {
        let mut x = mesh.nodes_m.clone();
        assert_eq!(body.first_not_finite(&x, kinematics), None);
        x[5].y = f64::NAN;
        assert!(!forces(&body, &x, kinematics).1.strain_energy_j.is_finite());
        assert_eq!(body.first_not_finite(&x, kinematics), Some(NotFinitePlace::Node(5)));
        let apart: Vec<DVec3> = mesh.nodes_m.iter().map(|x| *x * 1e200).collect();
        assert!(!forces(&body, &apart, kinematics).1.strain_energy_j.is_finite());
        assert_eq!(body.first_not_finite(&apart, kinematics), Some(NotFinitePlace::Element(0)));
    }
}

#[test]
fn unsound_elements_are_refused_by_number() {
    let mesh = box_mesh([1, 1, 1], 0.0);
    let constants = vec![STEEL; 6];
    let new = |nodes: &[DVec3], tets: &[[u32; 4]]| ElementBatches::new(nodes, tets, &constants).unwrap_err();
    let mut tets = mesh.tets.clone();
    tets[3].swap(0, 1);
    assert!(
        matches!(new(&mesh.nodes_m, &tets), FemError::NoVolume { element: 3, volume_m3 } if volume_m3 < 0.0)
    );
    tets[3] = [0, 1, 2, 8];
    assert_eq!(new(&mesh.nodes_m, &tets), FemError::NoSuchNode { element: 3, node: 8, nodes: 8 });
    let mut nodes = mesh.nodes_m.clone();
    nodes[mesh.tets[0][0] as usize].x = f64::NAN;
    assert!(matches!(new(&nodes, &mesh.tets), FemError::NoVolume { element: 0, .. }));
    assert_eq!(new(&mesh.nodes_m, &mesh.tets[..5]), FemError::ConstantsCount { constants: 6, elements: 5 });
    let mut bad = constants.clone();
    bad[2].mu_pa = 0.0;
    assert!(matches!(
        ElementBatches::new(&mesh.nodes_m, &mesh.tets, &bad),
        Err(FemError::Constants { element: 2, .. })
    ));
    let nothing = ElementBatches::new(&[], &[], &[]).unwrap();
    assert_eq!(forces(&nothing, &[], ElementKinematics::Green).1, ElasticState::default());
    assert_eq!(nothing.stable_step_s(&[]), f64::INFINITY);
}

#[test]
fn body_frame_follows_the_best_fit_of_a_turned_body() {
    let mesh = box_mesh([3, 2, 2], 0.1);
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    let masses_kg = body.lumped_masses_kg(None);
    let turn = rotation_from_vector(DVec3::new(0.0, 2.5, 0.3));
    let stretch = DMat3::from_diagonal(DVec3::new(1.001, 1.0, 0.999));
    let x: Vec<DVec3> = mesh.nodes_m.iter().map(|x| turn * (stretch * *x)).collect();
    let rest = MassProperties::of_points(&masses_kg, &mesh.nodes_m).centre_m;
    let now = MassProperties::of_points(&masses_kg, &x).centre_m;
    let moment = (0..x.len()).fold(DMat3::ZERO, |sum, node| {
        let (arm, rest_arm) = ((x[node] - now) * masses_kg[node], mesh.nodes_m[node] - rest);
        sum + DMat3::from_cols(arm * rest_arm.x, arm * rest_arm.y, arm * rest_arm.z)
    });
    let rotation = DMat3::from_quat(best_fit_rotation(&moment, DQuat::IDENTITY));
    let stresses = body.cauchy_stresses_pa(&x, ElementKinematics::BodyFrame { rotation });
    let expected = STEEL.stress_pa(&DMat3::from_diagonal(DVec3::new(1e-3, 0.0, -1e-3)));
    for stress in stresses {
        let error = symmetric_eigenvalues(&stress) - symmetric_eigenvalues(&expected);
        assert!(error.abs().max_element() < 1e-2 * expected.x_axis.x);
    }
}
