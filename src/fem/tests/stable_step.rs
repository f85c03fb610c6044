//! The stable step and mass scaling, against power iteration and against time stepping.

use super::*;
use crate::fem::test_support::box_mesh;
use crate::mesh::signed_volume_m3;

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
    for kinematics in all_kinematics() {
        assert!(leapfrog(&body, &mesh, kinematics, 0.99 * step_s) < 1e-4);
        let above = leapfrog(&body, &mesh, kinematics, 1.02 * step_s);
        assert!(above > 1e-2 || above.is_nan(), "{above}");
    }
}

/// Largest eigenvalue of the tangent stiffness over the mass of one element, by differences of forces: a value never above
/// the true one. `shift` keeps the iteration from going to a large negative one.
fn tangent_eigenvalue(
    body: &ElementBatches,
    x: &[DVec3],
    (kinematics, shift): (ElementKinematics, f64),
    random: &mut Random,
) -> f64 {
    let mass_kg = body.lumped_masses_kg(None)[0];
    let mut mode: Vec<DVec3> = (0..4).map(|_| random.vector()).collect();
    let mut eigenvalue = f64::NAN;
    for _ in 0..300 {
        let length = mode.iter().map(|d| d.length_squared()).sum::<f64>().sqrt();
        mode.iter_mut().for_each(|d| *d /= length);
        let moved =
            |sign: f64| -> Vec<DVec3> { x.iter().zip(&mode).map(|(x, d)| *x + *d * (sign * 1e-6)).collect() };
        let ahead = forces(body, &moved(1.0), kinematics).0;
        let behind = forces(body, &moved(-1.0), kinematics).0;
        let pulls = ahead.iter().zip(&behind).map(|(a, b)| (*b - *a) / (2e-6 * mass_kg));
        let next: Vec<DVec3> = pulls.zip(&mode).map(|(pull, d)| pull + *d * shift).collect();
        eigenvalue = mode.iter().zip(&next).map(|(d, k)| d.dot(*k)).sum::<f64>() - shift;
        mode = next;
    }
    eigenvalue
}

#[test]
fn deformed_elements_stay_within_their_bound() {
    let mesh = TetMesh::with_one_region(
        vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.2, 0.3, 0.7)],
        vec![[0, 1, 2, 3]],
    );
    let mut random = Random(5);
    for kinematics in [ElementKinematics::Green, ElementKinematics::Corotated, ElementKinematics::NeoHookean]
    {
        let mut tightest = [0.0_f64; 4];
        for constants in [STEEL, RUBBER] {
            let body = batches(&mesh, &[constants]);
            for round in 0..40 {
                // From small strain to elements that are turned inside out.
                let shake = [0.05, 0.2, 0.4, 0.9][round % 4];
                let grown = 1.0 + shake * random.vector().x;
                let x: Vec<DVec3> =
                    mesh.nodes_m.iter().map(|x| *x * grown + shake * random.vector()).collect();
                let (_, state) = forces(&body, &x, kinematics);
                let most = state.eigenvalue_per_s2;
                let eigenvalue = tangent_eigenvalue(&body, &x, (kinematics, most), &mut random);
                assert!(eigenvalue.is_finite());
                let share = (eigenvalue.max(0.0) / most).sqrt();
                assert!(share <= 1.0 + 1e-6, "{kinematics:?}, {shake}: {share}");
                tightest[round % 4] = tightest[round % 4].max(share);
            }
        }
        println!("{kinematics:?}: largest shares of the true step {tightest:?}");
    }
    let steel = batches(&mesh, &[STEEL]);
    for kinematics in all_kinematics() {
        let still = forces(&steel, &mesh.nodes_m, kinematics).1;
        let turned = kinematics == all_kinematics()[1];
        let share = still.stable_step_s() / steel.element_stable_steps_s()[0];
        assert!(turned || (share > 1.0 - 1e-6 && share <= 1.0 + 1e-12), "{kinematics:?}: {share}");
    }
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

/// A box with one element drawn flat, without the neighbours that this turned over.
fn box_with_sliver() -> TetMesh {
    let mut mesh = box_mesh([3, 3, 3], 0.1);
    let [a, b, c, d] = mesh.tets[40].map(|node| node as usize);
    let middle = (mesh.nodes_m[a] + mesh.nodes_m[b] + mesh.nodes_m[c]) / 3.0;
    mesh.nodes_m[d] = middle + (mesh.nodes_m[d] - middle) * 0.02;
    let nodes_m = &mesh.nodes_m;
    let is_sound = |tet: &[u32; 4]| signed_volume_m3(&tet.map(|n| nodes_m[n as usize])) > 1e-9;
    mesh.tets.retain(is_sound);
    mesh
}

#[test]
fn a_sliver_does_not_dictate_the_step() {
    let mesh = box_with_sliver();
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    let masses_kg = body.lumped_masses_kg(None);
    let exact_s = 2.0 / power_iteration(&body, &mesh, &masses_kg).sqrt();
    let by_elements_s = smallest(body.element_stable_steps_s());
    let assembled_s = body.stable_step_s(&masses_kg);
    assert!(assembled_s <= exact_s * (1.0 + 1e-9));
    assert!(assembled_s > 0.7 * exact_s && assembled_s > 3.0 * by_elements_s);
}

#[test]
fn strain_far_from_the_worst_element_does_not_shorten_the_step() {
    let mesh = box_with_sliver();
    let mut body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    let step_s = body.share_masses(&body.lumped_masses_kg(None));
    let [low, high] = [DVec3::min, DVec3::max].map(|of| mesh.nodes_m.iter().copied().reduce(of).unwrap());
    let bent = |share: f64| -> Vec<DVec3> {
        let push = |x: &DVec3| if x.distance(high) < 1e-9 { (low - high) * share } else { DVec3::ZERO };
        mesh.nodes_m.iter().map(|x| *x + push(x)).collect()
    };
    for kinematics in [ElementKinematics::Green, ElementKinematics::Corotated, ElementKinematics::NeoHookean]
    {
        let [still, some] = [0.0, 0.4].map(|share| forces(&body, &bent(share), kinematics).1);
        let grown: Vec<DVec3> = mesh.nodes_m.iter().map(|x| *x * 1.3).collect();
        let all = forces(&body, &grown, kinematics).1;
        assert!((still.stable_step_s() / step_s - 1.0).abs() < 1e-6, "{kinematics:?}");
        assert!(some.max_strain > 0.2 && some.stable_step_s() >= still.stable_step_s() * 0.999_999);
        assert!(all.stable_step_s() < 0.95 * step_s, "{kinematics:?}: {}", all.stable_step_s() / step_s);
    }
}

#[test]
fn mass_scaling_raises_the_step_of_the_assembled_body() {
    let mesh = box_with_sliver();
    let body = batches(&mesh, &vec![STEEL; mesh.tets.len()]);
    let masses_kg = body.lumped_masses_kg(None);
    let scaled = body.scale_node_masses(&masses_kg, 0.05);
    let exact_s = 2.0 / power_iteration(&body, &mesh, &scaled.node_masses_kg).sqrt();
    assert!(scaled.step_s <= exact_s * (1.0 + 1e-9));
    let gain = scaled.step_s / body.stable_step_s(&masses_kg);
    println!("5 % more mass: {gain:.3} times the step");
    assert!(gain > 1.05);
    let total = |masses: &[f64]| masses.iter().sum::<f64>();
    let added_kg = total(&scaled.node_masses_kg) - total(&masses_kg);
    assert!((added_kg / (0.05 * total(&masses_kg)) - 1.0).abs() < 1e-9);
    assert!((scaled.added_mass_kg / added_kg - 1.0).abs() < 1e-9);
    assert!(scaled.heavier_elements > 0);
    assert!(masses_kg.iter().zip(&scaled.node_masses_kg).all(|(before, after)| before <= after));
    let unscaled = body.scale_node_masses(&masses_kg, 0.0);
    assert_eq!(unscaled.node_masses_kg, masses_kg);
    // Element by element, with own masses only.
    let scaling = scale_masses(body.element_stable_steps_s(), body.element_masses_kg(), 0.05);
    let lumped_kg = body.lumped_masses_kg(Some(&scaling.factors));
    let exact_s = 2.0 / power_iteration(&body, &mesh, &lumped_kg).sqrt();
    assert!(scaling.step_s <= exact_s * (1.0 + 1e-9));
    assert!(scaling.step_s > 3.0 * smallest(body.element_stable_steps_s()));
}

fn smallest(numbers: &[f64]) -> f64 {
    numbers.iter().copied().fold(f64::INFINITY, f64::min)
}
