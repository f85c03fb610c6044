//! `corotated` and `neo-hookean` far from the reference shape: inverted, flat, scrambled.

use super::forces::assert_downhill;
use super::*;
use crate::fem::test_support::box_mesh;
use crate::fem::{corotated, neo_hookean};
use crate::mesh::signed_volume_m3;

const LARGE: [ElementKinematics; 2] = [ElementKinematics::Corotated, ElementKinematics::NeoHookean];

/// Every node anywhere in the unit cube.
fn scrambled(mesh: &TetMesh) -> Vec<DVec3> {
    let mut random = Random(11);
    mesh.nodes_m.iter().map(|_| random.vector() * 0.5 + 0.5).collect()
}

fn inverted_share(mesh: &TetMesh, x: &[DVec3]) -> f64 {
    let is_inverted = |tet: &&[u32; 4]| signed_volume_m3(&tet.map(|node| x[node as usize])) < 0.0;
    mesh.tets.iter().filter(is_inverted).count() as f64 / mesh.tets.len() as f64
}

#[test]
fn fast_forces_equal_plain_ones_in_a_scrambled_body() {
    let mesh = box_mesh([5, 4, 3], 0.15);
    let constants = two_materials(mesh.tets.len());
    let body = batches(&mesh, &constants);
    let x = scrambled(&mesh);
    assert!(inverted_share(&mesh, &x) > 0.4);
    for kinematics in LARGE {
        let (fast, state) = forces(&body, &x, kinematics);
        let mut plain = vec![DVec3::ZERO; x.len()];
        for (element, tet) in mesh.tets.iter().enumerate() {
            let of = body.element_forces_n(element as u32, &mesh.corners_m(element), &x, kinematics);
            tet.iter().zip(of).for_each(|(node, force)| plain[*node as usize] += force);
        }
        let difference: Vec<DVec3> = fast.iter().zip(&plain).map(|(a, b)| *a - *b).collect();
        assert!(
            largest(&difference) < 1e-11 * largest(&plain),
            "{:e}",
            largest(&difference) / largest(&plain)
        );
        let energy_j = body.strain_energy_j(&x, kinematics);
        assert!((state.strain_energy_j / energy_j - 1.0).abs() < 1e-12);
    }
}

#[test]
fn forces_of_a_scrambled_body_are_the_downhill_slope_of_its_energy() {
    let mesh = box_mesh([2, 2, 2], 0.2);
    let body = batches(&mesh, &vec![RUBBER; mesh.tets.len()]);
    let x = scrambled(&mesh);
    for kinematics in LARGE {
        assert_downhill(&body, &x, kinematics, 1e-6);
    }
}

#[test]
fn a_scrambled_and_a_flat_cube_come_back_to_their_shape() {
    let mesh = box_mesh([3, 3, 3], 0.1);
    let soft = ElasticConstants::new(1e5, 0.3, 1000.0).unwrap();
    let mut body = batches(&mesh, &vec![soft; mesh.tets.len()]);
    let masses_kg = body.lumped_masses_kg(None);
    body.share_masses(&masses_kg);
    let flat: Vec<DVec3> = mesh.nodes_m.iter().map(|x| DVec3::new(x.x, x.y, 0.3 * x.x * x.y)).collect();
    let point = vec![DVec3::splat(0.3); mesh.nodes_m.len()];
    let mut nearly_point = point.clone();
    let mut random = Random(3);
    nearly_point.iter_mut().for_each(|x| *x += 1e-3 * random.vector());
    for (what, start) in [("scrambled", scrambled(&mesh)), ("flat", flat), ("nearly a point", nearly_point)] {
        let kinematics = ElementKinematics::NeoHookean;
        let mut x = start;
        let mut v = vec![DVec3::ZERO; x.len()];
        let mut forces_n = vec![DVec3::ZERO; x.len()];
        let mut scratch = ForceScratch::default();
        let mut energy_j = f64::NAN;
        for _ in 0..20_000 {
            let state = body.forces(&mut scratch, &x, kinematics, &mut forces_n);
            energy_j = state.strain_energy_j;
            assert!(energy_j.is_finite(), "{what}");
            let step_s = 0.8 * state.stable_step_s();
            for node in 0..x.len() {
                v[node] = (v[node] + forces_n[node] * (step_s / masses_kg[node])) * (1.0 - 4.0 * step_s);
                x[node] += v[node] * step_s;
            }
        }
        println!("{what}: {energy_j:e} J, inverted {}", inverted_share(&mesh, &x));
        assert_eq!(inverted_share(&mesh, &x), 0.0, "{what}");
        assert!(energy_j < 1e-6 * soft.mu_pa, "{what}: {energy_j:e}");
        // Edges have their lengths again.
        for tet in &mesh.tets {
            let length = |x: &[DVec3]| (x[tet[0] as usize] - x[tet[3] as usize]).length();
            assert!((length(&x) / length(&mesh.nodes_m) - 1.0).abs() < 1e-3, "{what}");
        }
    }
}

#[test]
fn closed_form_and_robust_rotation_meet_and_neither_sees_a_turn() {
    // Elements from nearly rigid to nearly flat, each beside its turned self.
    let mesh = TetMesh::with_one_region(vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], vec![[0, 1, 2, 3]]);
    let body = batches(&mesh, &[RUBBER]);
    let turn = DMat3::from_quat(rotation_from_vector(DVec3::new(2.0, -0.7, 1.3)));
    let mut random = Random(2);
    for kinematics in LARGE {
        for round in 0..200 {
            let shake = [1e-6, 0.1, 0.6, 2.0][round % 4];
            let x: Vec<DVec3> = mesh.nodes_m.iter().map(|x| *x + shake * random.vector()).collect();
            let turned: Vec<DVec3> = x.iter().map(|x| turn * *x).collect();
            let (straight_n, state) = forces(&body, &x, kinematics);
            let (turned_n, after) = forces(&body, &turned, kinematics);
            // Round-off of F is that of numbers of order one.
            let scale = largest(&straight_n) + 1e-4 * RUBBER.lambda_pa;
            for (a, b) in straight_n.iter().zip(&turned_n) {
                assert!((turn * *a - *b).length() < 1e-9 * scale, "{kinematics:?} {shake}");
            }
            let scale_j = state.strain_energy_j + 1e-12 * RUBBER.lambda_pa;
            assert!((state.strain_energy_j - after.strain_energy_j).abs() < 1e-9 * scale_j);
            assert!(state.strain_energy_j > -1e-18 * RUBBER.lambda_pa);
        }
    }
}

#[test]
fn small_strain_agrees_with_hooke() {
    let strain = DMat3::from_cols_array(&[2.0, 0.3, -0.5, 0.3, -1.0, 0.7, -0.5, 0.7, 1.5]) * 1e-6;
    for law in [STEEL, RUBBER, ElasticConstants::new(1e9, -0.4, 1000.0).unwrap()] {
        let hooke = law.stress_pa(&strain);
        let error = neo_hookean::first_piola_pa(&(DMat3::IDENTITY + strain), &law) - hooke;
        assert!(error.abs_diff_eq(DMat3::ZERO, 2e-5 * hooke.x_axis.x.abs().max(law.mu_pa * 1e-6)));
        let works = hooke.to_cols_array().iter().zip(strain.to_cols_array()).map(|(s, e)| s * e).sum::<f64>();
        let energy = neo_hookean::energy_pa(&(DMat3::IDENTITY + strain), &law);
        assert!((energy / (0.5 * works) - 1.0).abs() < 1e-4, "{}", energy / (0.5 * works));
    }
}

#[test]
fn stress_never_exceeds_what_the_search_for_failure_relies_on() {
    let mut random = Random(8);
    let mut tightest = [0.0_f64; 2];
    for round in 0..40_000 {
        let law = [STEEL, RUBBER][round % 2];
        let size = 0.5 * f64::from(round as u32 % 97) / 97.0;
        let e = DMat3::from_cols(random.vector(), random.vector(), random.vector());
        let e = (e + e.transpose()) * 0.5;
        let norm = |m: &DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
        let e = e * (size / norm(&e));
        for (kind, kinematics) in LARGE.into_iter().enumerate() {
            // A symmetric gradient: Biot strain e, or Green's strain e.
            let gradient = if kind == 0 {
                DMat3::IDENTITY + e
            } else {
                let squared = crate::math::symmetric_eigen(&(DMat3::IDENTITY + e * 2.0));
                let axes = squared.directions;
                axes * DMat3::from_diagonal(squared.values.map(f64::sqrt)) * axes.transpose()
            };
            let first_piola = if kind == 0 {
                law.stress_pa(&corotated::strain(&gradient, &DMat3::IDENTITY))
            } else {
                neo_hookean::first_piola_pa(&gradient, &law)
            };
            let cauchy = first_piola * gradient.transpose() * gradient.determinant().recip();
            let most = ElementBatches::most_stress_pa(&law, kinematics, size);
            assert!(norm(&cauchy) <= most * (1.0 + 1e-9), "{kinematics:?} {size}");
            if size > 0.0 {
                tightest[kind] = tightest[kind].max(norm(&cauchy) / most);
            }
        }
    }
    println!("largest stress over its bound: {tightest:?}");
}

#[test]
fn the_logarithm_by_roots_is_the_library_s() {
    for u in [-0.75, -0.4, -0.1, -1e-9, 0.0, 1e-7, 0.3, 0.49, 0.51, 3.0, 1e4, 1e150] {
        let exact = u - f64::ln_1p(u);
        let error = (neo_hookean::log_defect(u) - exact).abs();
        assert!(error <= 4e-15 * (exact.abs() + f64::EPSILON * u.abs() / 1e-15), "{u}: {error:e}");
    }
    assert!(neo_hookean::log_defect(f64::NAN).is_nan());
}
