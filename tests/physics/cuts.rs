//! The elements of a body that is cut again and again, followed cut by cut, are those that would be built anew.

use glam::DVec3;
use hammerfall::fem::{
    CutBody, ElasticConstants, ElementBatches, ElementChanges, ElementKinematics, ForceScratch, StepBound,
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
    let mut bound = StepBound::new(&elements, &lumped_kg(&solid));
    let (mut cuts, mut worst) = (0, f64::INFINITY);
    for attempt in 0..100 {
        let node = ((random(&mut seed) * 0.5 + 0.5) * solid.node_count() as f64) as u32;
        let normal = vector(&mut seed).normalize();
        let state = NodeState { positions_m: &mut positions_m, velocities_m_s: &mut velocities_m_s };
        let changes = solid.cut_node(state, node, normal, &Propagation::default());
        let cut_from: Vec<u32> = changes.new_elements.iter().map(|new| new.cut_from).collect();
        let of_elements = ElementChanges { changed: &changes.changed_elements, cut_from: &cut_from };
        elements.follow(solid.reference_m(), solid.tets(), of_elements).expect("cuts leave sound elements");
        let masses_kg = lumped_kg(&solid);
        let body = CutBody {
            elements: &elements,
            reference_m: solid.reference_m(),
            node_masses_kg: &masses_kg,
            elements_at: |node| solid.elements_at(node),
        };
        bound.follow(&body, &changes.touched_nodes, of_elements);
        cuts += changes.cuts.len();
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
        worst = worst.min(bound.step_s() / anew.stable_step_s(&masses_kg));
    }
    println!("{cuts} cuts, {} elements; step at least {worst:.3} of one found anew", solid.tets().len());
    assert!(cuts > 60 && worst > 0.6);
}
