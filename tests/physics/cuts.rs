//! The elements of a body that is cut again and again, followed cut by cut, are those that would be built anew.

use glam::{DMat3, DVec3};
use hammerfall::fem::{
    CutBody, ElasticConstants, ElasticState, ElementBatches, ElementChanges, ElementKinematics, ForceScratch,
    StepBound,
};
use hammerfall::fracture::{NodeState, Propagation, Solid};
use hammerfall::mesh::shapes::{BoxShape, HexSplit, Meshing, Resolution, Shape};

const STUFF: ElasticConstants = ElasticConstants { lambda_pa: 1e9, mu_pa: 0.8e9, density_kg_m3: 2000.0 };

/// Numbers in [-1, 1), always the same.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn vector(state: &mut u64) -> DVec3 {
    DVec3::new(random(state), random(state), random(state))
}

fn forces_n(elements: &ElementBatches, positions_m: &[DVec3]) -> Vec<DVec3> {
    let mut forces_n = vec![DVec3::ZERO; positions_m.len()];
    elements.forces(&mut ForceScratch::default(), positions_m, ElementKinematics::Green, &mut forces_n);
    forces_n
}

fn green_state(elements: &ElementBatches, positions_m: &[DVec3]) -> ElasticState {
    let mut forces_n = vec![DVec3::ZERO; positions_m.len()];
    elements.forces(&mut ForceScratch::default(), positions_m, ElementKinematics::Green, &mut forces_n)
}

/// `omega^2` of the fastest vibration, 1/s2, by power iteration: never above the true one.
fn largest_eigenvalue(elements: &ElementBatches, at_m: &[DVec3], masses_kg: &[f64]) -> f64 {
    let kinematics = ElementKinematics::BodyFrame { rotation: DMat3::IDENTITY };
    let mut seed = 9;
    let mut mode: Vec<DVec3> = at_m.iter().map(|_| vector(&mut seed)).collect();
    let mut eigenvalue = 0.0;
    for _ in 0..400 {
        let size = 1e-3 / mode.iter().map(|d| d.length_squared()).sum::<f64>().sqrt();
        mode.iter_mut().for_each(|d| *d *= size);
        let moved: Vec<DVec3> = at_m.iter().zip(&mode).map(|(x, d)| *x + *d).collect();
        let mut forces_n = vec![DVec3::ZERO; moved.len()];
        elements.forces(&mut ForceScratch::default(), &moved, kinematics, &mut forces_n);
        let of_nodes = || mode.iter().zip(&forces_n).zip(masses_kg);
        let stiffness: f64 = of_nodes().map(|((d, f), _)| -d.dot(*f)).sum();
        let mass: f64 = of_nodes().map(|((d, _), kg)| kg * d.length_squared()).sum();
        eigenvalue = stiffness / mass;
        mode = forces_n.iter().zip(masses_kg).map(|(f, kg)| -*f / *kg).collect();
    }
    eigenvalue
}

fn lumped_kg(solid: &Solid) -> Vec<f64> {
    (0..solid.node_count() as u32).map(|node| solid.node_mass_kg(node)).collect()
}

#[test]
fn elements_followed_through_a_hundred_cuts_are_those_built_anew() {
    let mut seed = 5;
    let shape = Shape::Box(BoxShape { size_m: DVec3::new(1.0, 0.8, 0.6) });
    let meshing = Meshing { resolution: Resolution::Cells([8, 6, 5]), split: HexSplit::Six };
    let mesh = shape.build(&meshing).expect("a box can be meshed");
    let mut solid = Solid::new(&mesh, &vec![STUFF.density_kg_m3; mesh.tets.len()], 0.25).expect("sound");
    let mut positions_m: Vec<DVec3> = mesh.nodes_m.iter().map(|x| *x + vector(&mut seed) * 1e-3).collect();
    let mut velocities_m_s = vec![DVec3::ZERO; positions_m.len()];
    let constants = |count: usize| vec![STUFF; count];
    let mut elements =
        ElementBatches::new(&mesh.nodes_m, &mesh.tets, &constants(mesh.tets.len())).expect("sound");
    let mut bound = StepBound::new(&mut elements, &lumped_kg(&solid));
    // The shortest step of an element of the smallest altitude that cuts may leave.
    let floor_s = STUFF.stable_step_floor_s(solid.altitude_floor_m());
    let (mut cuts, mut worst, mut shortest_step_s) = (0, f64::INFINITY, bound.step_s());
    for attempt in 0..100 {
        let node = ((random(&mut seed) * 0.5 + 0.5) * solid.node_count() as f64) as u32;
        let normal = vector(&mut seed).normalize();
        let state = NodeState { positions_m: &mut positions_m, velocities_m_s: &mut velocities_m_s };
        let changes = solid.cut_node(state, node, normal, &Propagation::default());
        let cut_from: Vec<u32> = changes.new_elements.iter().map(|new| new.cut_from).collect();
        let of_elements = ElementChanges { changed: &changes.changed_elements, cut_from: &cut_from };
        elements.follow(solid.reference_m(), solid.tets(), of_elements).expect("cuts leave sound elements");
        let masses_kg = lumped_kg(&solid);
        let mut body = CutBody {
            elements: &mut elements,
            reference_m: solid.reference_m(),
            node_masses_kg: &masses_kg,
            elements_at: |node| solid.elements_at(node),
        };
        bound.follow(&mut body, &changes.touched_nodes, of_elements);
        cuts += changes.cuts.len();
        shortest_step_s = shortest_step_s.min(bound.step_s());
        if attempt % 20 != 19 {
            continue;
        }
        let anew = ElementBatches::new(solid.reference_m(), solid.tets(), &constants(solid.tets().len()));
        let anew = anew.expect("sound");
        let (followed, expected) = (forces_n(&elements, &positions_m), forces_n(&anew, &positions_m));
        let most = expected.iter().map(|f| f.length()).fold(0.0, f64::max);
        for (a, b) in followed.iter().zip(&expected) {
            assert!((*a - *b).length() <= 1e-12 * most, "{a} {b}");
        }
        // The sum over elements one by one is the same thing again.
        let mut by_element = vec![DVec3::ZERO; expected.len()];
        for element in 0..solid.tets().len() as u32 {
            let corners_m = solid.corners_m(element);
            let of = elements.element_forces_n(element, &corners_m, &positions_m, ElementKinematics::Green);
            let corners = solid.tets()[element as usize].iter();
            corners.zip(of).for_each(|(node, force_n)| by_element[*node as usize] += force_n);
        }
        for (a, b) in by_element.iter().zip(&expected) {
            assert!((*a - *b).length() <= 1e-11 * most, "{a} {b}");
        }
        let shortest_s = anew.element_stable_steps_s().iter().copied().fold(f64::INFINITY, f64::min);
        assert!(bound.step_s() >= shortest_s);
        // The elements know their shares, those in chunks built anew too: nothing is strained in the reference shape.
        let still = green_state(&elements, solid.reference_m());
        assert!((still.stable_step_s() / bound.step_s() - 1.0).abs() < 1e-6);
        let exact_s = 2.0 / largest_eigenvalue(&elements, solid.reference_m(), &masses_kg).sqrt();
        assert!(bound.step_s() <= exact_s * (1.0 + 1e-9), "{} of {exact_s} s", bound.step_s());
        worst = worst.min(bound.step_s() / exact_s);
    }
    println!("{cuts} cuts, {} elements; step at least {worst:.3} of the true one", solid.tets().len());
    println!("shortest step {shortest_step_s:.3e} s, floor {floor_s:.3e} s");
    assert!(shortest_step_s >= floor_s, "{shortest_step_s} s is below the floor of {floor_s} s");
    assert!(cuts > 60 && worst > 0.8);
}
