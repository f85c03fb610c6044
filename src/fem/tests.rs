//! Tests of the whole module: physics, determinism, and the fast kernel against plain code.

use super::test_support::{Random, box_mesh};
use super::*;
use crate::math::{MassProperties, best_fit_rotation, rotation_from_vector, symmetric_eigenvalues};
use crate::mesh::{TetMesh, signed_volume_m3};
use glam::{DMat3, DQuat, DVec3};

const STEEL: ElasticConstants = ElasticConstants { lambda_pa: 1.2e11, mu_pa: 8e10, density_kg_m3: 7850.0 };
const RUBBER: ElasticConstants = ElasticConstants { lambda_pa: 2e7, mu_pa: 1e6, density_kg_m3: 1100.0 };

/// Alternating steel and rubber.
fn two_materials(elements: usize) -> Vec<ElasticConstants> {
    (0..elements).map(|e| if e % 3 == 0 { STEEL } else { RUBBER }).collect()
}

fn batches(mesh: &TetMesh, constants: &[ElasticConstants]) -> ElementBatches {
    ElementBatches::new(&mesh.nodes_m, &mesh.tets, constants).unwrap()
}

fn both_kinematics() -> [ElementKinematics; 2] {
    let turn = rotation_from_vector(DVec3::new(0.5, -1.2, 0.8));
    let rotation = DMat3::from_quat(turn);
    [ElementKinematics::Green, ElementKinematics::BodyFrame { rotation }]
}

fn rotation_of(kinematics: ElementKinematics) -> DMat3 {
    match kinematics {
        ElementKinematics::Green => DMat3::IDENTITY,
        ElementKinematics::BodyFrame { rotation } => rotation,
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
        let (strain, first_piola);
        match kinematics {
            ElementKinematics::Green => {
                strain = (f.transpose() * f - DMat3::IDENTITY) * 0.5;
                first_piola = f * constants[element].stress_pa(&strain);
            }
            ElementKinematics::BodyFrame { rotation } => {
                let seen = rotation.transpose() * f;
                strain = (seen + seen.transpose()) * 0.5 - DMat3::IDENTITY;
                first_piola = rotation * constants[element].stress_pa(&strain);
            }
        }
        let stress = constants[element].stress_pa(&strain);
        let products = stress.to_cols_array().into_iter().zip(strain.to_cols_array());
        energy_j += 0.5 * volume_m3 * products.map(|(s, e)| s * e).sum::<f64>();
        // Columns of -V0 P Dm^-T are the forces on corners 1, 2, 3.
        let corner_forces = first_piola * inverse.transpose() * -volume_m3;
        for corner in 0..3 {
            forces_n[tet[corner + 1] as usize] += corner_forces.col(corner);
            forces_n[tet[0] as usize] -= corner_forces.col(corner);
        }
    }
    (forces_n, energy_j)
}

#[test]
fn fast_forces_equal_the_definition() {
    // 5 x 4 x 3 cells leave a last batch that is not full; the larger mesh has several chunks.
    for cells in [[5, 4, 3], [9, 10, 8]] {
        let mesh = box_mesh(cells, 0.15);
        let constants = two_materials(mesh.tets.len());
        let body = batches(&mesh, &constants);
        for kinematics in both_kinematics() {
            let x = shaken(&mesh, 0.01, kinematics);
            let (fast, state) = forces(&body, &x, kinematics);
            let (plain, energy_j) = plain_forces(&mesh, &constants, &x, kinematics);
            let difference: Vec<DVec3> = fast.iter().zip(&plain).map(|(a, b)| *a - *b).collect();
            assert!(
                largest(&difference) < 1e-12 * largest(&plain),
                "{:e}",
                largest(&difference) / largest(&plain)
            );
            assert!((state.strain_energy_j / energy_j - 1.0).abs() < 1e-12);
            let slow_energy_j = body.strain_energy_j(&x, kinematics);
            assert!((slow_energy_j / energy_j - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn forces_are_the_downhill_slope_of_the_energy() {
    let mesh = box_mesh([2, 2, 2], 0.2);
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    for kinematics in both_kinematics() {
        let x = shaken(&mesh, 0.1, kinematics);
        let (forces_n, _) = forces(&body, &x, kinematics);
        let step_m = 1e-5;
        for node in 0..x.len() {
            for axis in 0..3 {
                let energy_at = |shift: f64| {
                    let mut moved = x.clone();
                    moved[node][axis] += shift;
                    forces(&body, &moved, kinematics).1.strain_energy_j
                };
                let slope = (energy_at(step_m) - energy_at(-step_m)) / (2.0 * step_m);
                let error = (forces_n[node][axis] + slope).abs() / largest(&forces_n);
                assert!(error < 1e-8, "node {node} axis {axis}: {error:e}");
            }
        }
    }
}

#[test]
fn patch_test_constant_strain_gives_constant_stress_and_no_inner_force() {
    let cells = [4, 3, 5];
    let mesh = box_mesh(cells, 0.2);
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    let stretch = DMat3::from_cols_array(&[1.02, 0.01, -0.02, 0.03, 0.97, 0.01, 0.0, -0.01, 1.01]);
    for kinematics in both_kinematics() {
        let rotation = rotation_of(kinematics);
        let x: Vec<DVec3> = mesh.nodes_m.iter().map(|x| rotation * (stretch * *x)).collect();
        let expected = match kinematics {
            ElementKinematics::Green => {
                let strain = (stretch.transpose() * stretch - DMat3::IDENTITY) * 0.5;
                stretch * STEEL.stress_pa(&strain) * stretch.transpose() * stretch.determinant().recip()
            }
            ElementKinematics::BodyFrame { rotation } => {
                let strain = (stretch + stretch.transpose()) * 0.5 - DMat3::IDENTITY;
                rotation * STEEL.stress_pa(&strain) * rotation.transpose()
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
    for kinematics in
        [ElementKinematics::Green, ElementKinematics::BodyFrame { rotation: DMat3::from_quat(turn) }]
    {
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
    for kinematics in both_kinematics() {
        let x = shaken(&mesh, 0.05, kinematics);
        let (forces_n, _) = forces(&body, &x, kinematics);
        let sum: DVec3 = forces_n.iter().sum();
        assert!(sum.abs().max_element() < 1e-13 * largest(&forces_n) * x.len() as f64);
        let torque: DVec3 = x.iter().zip(&forces_n).map(|(x, f)| x.cross(*f)).sum();
        if kinematics == ElementKinematics::Green {
            assert!(torque.abs().max_element() < 1e-12 * largest(&forces_n) * x.len() as f64);
        }
    }
}

#[test]
fn same_bytes_for_any_thread_count_and_instruction_set() {
    let mesh = box_mesh([12, 12, 12], 0.2);
    let mut body = batches(&mesh, &two_materials(mesh.tets.len()));
    for kinematics in both_kinematics() {
        let x = shaken(&mesh, 0.01, kinematics);
        let in_pool = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| forces(&body, &x, kinematics))
        };
        let one = in_pool(1);
        assert!(one == in_pool(2) && one == in_pool(2) && one == in_pool(3));
    }
    let fastest: Vec<_> = both_kinematics().map(|k| forces(&body, &shaken(&mesh, 0.01, k), k)).into();
    body.arch = pulp::Arch::Scalar;
    let plainest: Vec<_> = both_kinematics().map(|k| forces(&body, &shaken(&mesh, 0.01, k), k)).into();
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

/// Largest eigenvalue of `M^-1 K` by power iteration on the body-frame forces, which are linear: a value never above the
/// true one.
fn power_iteration(body: &ElementBatches, mesh: &TetMesh, masses_kg: &[f64]) -> f64 {
    let kinematics = ElementKinematics::BodyFrame { rotation: DMat3::IDENTITY };
    let mut random = Random(3);
    let mut mode: Vec<DVec3> = mesh.nodes_m.iter().map(|_| random.vector()).collect();
    let mut eigenvalue = 0.0;
    for _ in 0..3000 {
        let size = 1e-3 / mode.iter().map(|d| d.length_squared()).sum::<f64>().sqrt();
        mode.iter_mut().for_each(|d| *d *= size);
        let x: Vec<DVec3> = mesh.nodes_m.iter().zip(&mode).map(|(x, d)| *x + *d).collect();
        let (forces_n, _) = forces(body, &x, kinematics);
        let (mut stiffness, mut mass) = (0.0, 0.0);
        for node in 0..x.len() {
            stiffness -= mode[node].dot(forces_n[node]);
            mass += masses_kg[node] * mode[node].length_squared();
            mode[node] = -forces_n[node] / masses_kg[node];
        }
        eigenvalue = stiffness / mass;
    }
    eigenvalue
}

#[test]
fn stable_step_is_a_tight_bound_of_the_assembled_body() {
    for (jitter, needed_share) in [(0.0, 0.8), (0.3, 0.6)] {
        let mesh = box_mesh([3, 3, 3], jitter);
        let body = batches(&mesh, &two_materials(mesh.tets.len()));
        let masses_kg = body.lumped_masses_kg(None);
        let exact_s = 2.0 / power_iteration(&body, &mesh, &masses_kg).sqrt();
        let by_elements_s = body.element_stable_steps_s().iter().copied().fold(f64::INFINITY, f64::min);
        let assembled_s = body.stable_step_s(&masses_kg);
        println!(
            "jitter {jitter}: elements {:.3}, assembled {:.3} of exact",
            by_elements_s / exact_s,
            assembled_s / exact_s
        );
        assert!(assembled_s <= exact_s * (1.0 + 1e-9));
        assert!(by_elements_s <= assembled_s * (1.0 + 1e-12));
        assert!(assembled_s >= needed_share * exact_s);
    }
}

#[test]
fn step_of_one_element_is_exact_and_the_altitude_estimate_is_not_safe() {
    let auxetic = ElasticConstants { lambda_pa: -0.6 * STEEL.mu_pa, ..STEEL };
    for constants in [STEEL, RUBBER, auxetic] {
        let mut random = Random(11);
        for _ in 0..5 {
            let far = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis + 0.4 * random.vector());
            let mesh =
                TetMesh::with_one_region(vec![DVec3::ZERO, far[0], far[1], far[2]], vec![[0, 1, 2, 3]]);
            let body = batches(&mesh, &[constants]);
            let masses_kg = body.lumped_masses_kg(None);
            let exact_s = 2.0 / power_iteration(&body, &mesh, &masses_kg).sqrt();
            let step_s = body.element_stable_steps_s()[0];
            assert!((step_s / exact_s - 1.0).abs() < 1e-6, "{}", step_s / exact_s);
            assert!((body.stable_step_s(&masses_kg) / step_s - 1.0).abs() < 1e-12);
            assert!(body.element_altitude_steps_s()[0] > step_s);
        }
    }
}

/// Sum of the displacements after 400 leapfrog steps from a small shake.
fn leapfrog(body: &ElementBatches, mesh: &TetMesh, kinematics: ElementKinematics, step_s: f64) -> f64 {
    let masses_kg = body.lumped_masses_kg(None);
    let mut x = shaken(mesh, 1e-6, kinematics);
    let start = x.clone();
    let mut v = vec![DVec3::ZERO; x.len()];
    for _ in 0..400 {
        let (forces_n, _) = forces(body, &x, kinematics);
        for node in 0..x.len() {
            v[node] += forces_n[node] * (step_s / masses_kg[node]);
            x[node] += v[node] * step_s;
        }
    }
    // A sum, because a maximum would pass over NaN.
    x.iter().zip(&start).map(|(x, s)| (*x - *s).length()).sum()
}

#[test]
fn leapfrog_of_one_element_is_bounded_below_the_step_and_blows_up_above() {
    let mesh = TetMesh::with_one_region(
        vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.2, 0.3, 0.7)],
        vec![[0, 1, 2, 3]],
    );
    let body = batches(&mesh, &[STEEL]);
    let step_s = body.element_stable_steps_s()[0];
    for kinematics in both_kinematics() {
        assert!(leapfrog(&body, &mesh, kinematics, 0.99 * step_s) < 1e-4);
        let above = leapfrog(&body, &mesh, kinematics, 1.02 * step_s);
        assert!(above > 1e-2 || above.is_nan(), "{above}");
    }
}

#[test]
fn deformed_green_elements_stay_within_the_step_factor() {
    // Tangent stiffness of one strongly stretched element by differences of forces.
    let mesh = TetMesh::with_one_region(
        vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.2, 0.3, 0.7)],
        vec![[0, 1, 2, 3]],
    );
    let mut random = Random(5);
    for constants in [STEEL, RUBBER] {
        let body = batches(&mesh, &[constants]);
        let mass_kg = body.lumped_masses_kg(None)[0];
        for _ in 0..20 {
            let x: Vec<DVec3> = mesh.nodes_m.iter().map(|x| *x * 1.2 + 0.2 * random.vector()).collect();
            let (_, state) = forces(&body, &x, ElementKinematics::Green);
            let mut mode: Vec<DVec3> = (0..4).map(|_| random.vector()).collect();
            let mut eigenvalue = 0.0;
            for _ in 0..300 {
                let size = 1e-6 / largest(&mode);
                let moved = |sign: f64| -> Vec<DVec3> {
                    x.iter().zip(&mode).map(|(x, d)| *x + *d * (sign * size)).collect()
                };
                let ahead = forces(&body, &moved(1.0), ElementKinematics::Green).0;
                let behind = forces(&body, &moved(-1.0), ElementKinematics::Green).0;
                let next: Vec<DVec3> =
                    ahead.iter().zip(&behind).map(|(a, b)| (*b - *a) / (2.0 * size * mass_kg)).collect();
                let along: f64 = mode.iter().zip(&next).map(|(d, k)| d.dot(*k)).sum();
                eigenvalue = along / mode.iter().map(|d| d.length_squared()).sum::<f64>();
                mode = next;
            }
            let allowed_s = body.element_stable_steps_s()[0] * body.green_step_factor(state.max_strain);
            assert!(
                allowed_s <= 2.0 / f64::sqrt(eigenvalue.max(1e-300)) * (1.0 + 1e-6),
                "{}",
                allowed_s * eigenvalue.sqrt() / 2.0
            );
        }
    }
    assert_eq!(batches(&mesh, &[STEEL]).green_step_factor(0.0), 1.0);
}

#[test]
fn stiffness_damping_shortens_the_step_by_the_formula() {
    // One oscillator with lagged damping: bounded just below, growing just above.
    let (omega, beta) = (1.0e4_f64, 1e-4);
    let step_s = damped_step_s(2.0 / omega, beta);
    let run = |h: f64| {
        let (mut x, mut v) = (1.0, 0.0);
        for _ in 0..2000 {
            v -= h * omega * omega * (x + beta * v);
            x += h * v;
        }
        f64::abs(x)
    };
    assert!(run(0.999 * step_s) < 1.0 && run(1.001 * step_s) > 2.0);
    assert_eq!(damped_step_s(3e-6, 0.0), 3e-6);
    assert_eq!(damped_step_s(f64::INFINITY, 1.0), f64::INFINITY);
}

#[test]
fn mass_scaling_raises_the_step_of_the_assembled_body() {
    let mut mesh = box_mesh([3, 3, 3], 0.1);
    // Flatten one element: its last corner is drawn almost into the opposite face.
    let [a, b, c, d] = mesh.tets[40].map(|node| node as usize);
    let middle = (mesh.nodes_m[a] + mesh.nodes_m[b] + mesh.nodes_m[c]) / 3.0;
    mesh.nodes_m[d] = middle + (mesh.nodes_m[d] - middle) * 0.2;
    let sound: Vec<[u32; 4]> = (0..mesh.tets.len())
        .filter(|&e| signed_volume_m3(&mesh.corners_m(e)) > 1e-6)
        .map(|e| mesh.tets[e])
        .collect();
    mesh.tets = sound;
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    let scaling = scale_masses(body.element_stable_steps_s(), body.element_masses_kg(), 0.05);
    let masses_kg = body.lumped_masses_kg(Some(&scaling.factors));
    let exact_s = 2.0 / power_iteration(&body, &mesh, &masses_kg).sqrt();
    assert!(scaling.step_s <= exact_s * (1.0 + 1e-9));
    let before_s = body.element_stable_steps_s().iter().copied().fold(f64::INFINITY, f64::min);
    assert!(scaling.step_s > 1.2 * before_s);
}

#[test]
fn finds_the_first_place_that_is_not_finite() {
    let mesh = box_mesh([2, 2, 2], 0.0);
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    for kinematics in both_kinematics() {
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
