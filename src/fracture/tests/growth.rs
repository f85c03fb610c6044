//! Cracks that grow step by step: which nodes crack, how far, how fast, how straight.

use super::specimen::{Random, Specimen, area_m2, assert_same, assert_sound};
use crate::fracture::{
    Changes, CrackPace, Face, Failure, FractureLimits, NodeState, Propagation, PropagationRule,
};
use crate::mesh::TetMesh;
use crate::mesh::shapes::{BoxShape, HexSplit, Meshing, Resolution, Shape};
use glam::DVec3;

fn bar(cells: [u32; 3]) -> TetMesh {
    let size_m = DVec3::from_array(cells.map(f64::from));
    let meshing = Meshing { resolution: Resolution::Cells(cells), split: HexSplit::Six };
    Shape::Box(BoxShape { size_m }).build(&meshing).unwrap()
}

fn propagate(
    specimen: &mut Specimen,
    failures: &[Failure],
    settings: &Propagation,
    may_crack: impl Fn(u32) -> bool,
) -> Changes {
    let nodes =
        NodeState { positions_m: &mut specimen.positions_m, velocities_m_s: &mut specimen.velocities_m_s };
    specimen.solid.propagate(nodes, failures, settings, may_crack)
}

/// Everything that still holds together across the plane fails there, the worst at the top, as
/// under a bending load.
fn failures_across(specimen: &Specimen, point_m: DVec3, normal: DVec3) -> Vec<Failure> {
    let mut failures = Vec::new();
    for element in specimen.elements() {
        let corners = specimen.solid.tets()[element as usize].map(|n| specimen.positions_m[n as usize]);
        let distances = corners.map(|x| (x - point_m).dot(normal));
        let [above, below] = [1.0, -1.0].map(|s| distances.iter().any(|d| d * s > 1e-9));
        if above && below {
            failures.push(Failure { element, normal, index: 1.0 + 0.1 * corners[0].z });
        }
    }
    failures
}

#[test]
fn a_crack_across_a_bar_leaves_two_pieces_and_a_plane_between_them() {
    for (rule, slope) in [
        (PropagationRule::TwoAtNode, 0.0),
        (PropagationRule::TwoAtNode, 0.4),
        (PropagationRule::SingleElement, 0.0),
        (PropagationRule::SingleElement, 0.4),
    ] {
        let mut specimen = Specimen::new(&bar([9, 4, 4]), 0.25);
        let before = specimen.totals();
        let (point_m, normal) = (DVec3::new(0.1, 0.0, 0.0), DVec3::new(1.0, 0.0, slope).normalize());
        let settings = Propagation { rule, ..Propagation::default() };
        let mut steps = 0;
        while specimen.solid.fragments().list().len() == 1 {
            let failures = failures_across(&specimen, point_m, normal);
            propagate(&mut specimen, &failures, &settings, |_| true);
            assert_sound(&specimen);
            steps += 1;
            assert!(steps < 40, "{rule:?} {slope}: the crack does not get through");
        }
        assert_same(&before, &specimen.totals());
        let (area, farthest_m) = crack_shape(&specimen, point_m, normal);
        let ratio = area / (16.0 / normal.x);
        println!("{rule:?} {slope}: {steps} steps, area {ratio:.3}, off the plane by {farthest_m:.3} cells");
        let masses: Vec<f64> = specimen.solid.fragments().list().iter().map(|f| f.mass_kg).collect();
        let total_kg: f64 = masses.iter().sum();
        assert!(masses[1] > 0.35 * total_kg, "{masses:?}");
        assert!(ratio < 1.5 && farthest_m < 1.0, "{rule:?} {slope}: {ratio} {farthest_m}");
    }
}

/// Area of one side of all cracks, m2, and how far they stray from the plane, m.
fn crack_shape(specimen: &Specimen, point_m: DVec3, normal: DVec3) -> (f64, f64) {
    let reference_m = specimen.solid.reference_m();
    let mut area = 0.0;
    let mut farthest_m = 0.0_f64;
    for face in specimen.solid.surface() {
        if matches!(face.kind, Face::Crack { above: true, .. }) {
            area += area_m2(face.nodes, reference_m).length();
            for node in face.nodes {
                farthest_m = farthest_m.max((reference_m[node as usize] - point_m).dot(normal).abs());
            }
        }
    }
    (area, farthest_m)
}

#[test]
fn a_single_failure_cracks_under_one_rule_and_not_under_the_other() {
    let specimen = Specimen::new(&bar([3, 3, 3]), 0.25);
    let failures = [Failure { element: 81, normal: DVec3::X, index: 1.2 }];
    for (rule, expected) in [(PropagationRule::TwoAtNode, 0), (PropagationRule::SingleElement, 1)] {
        let mut specimen = specimen.clone();
        let settings = Propagation { rule, ..Propagation::default() };
        let changes = propagate(&mut specimen, &failures, &settings, |_| true);
        assert_eq!(changes.cuts.len(), expected, "{rule:?}");
        assert_eq!(changes.crack_faces.is_empty(), expected == 0);
        assert_eq!(changes.is_empty(), expected == 0);
    }
}

#[test]
fn failures_of_a_node_are_averaged_with_signs_aligned_and_conjugates_kept_apart() {
    let specimen = Specimen::new(&bar([3, 3, 3]), 0.25);
    let node = specimen.solid.tets()[81][0];
    let at_node = specimen.solid.elements_at(node).to_vec();
    let tilted = [DVec3::new(1.0, 0.2, 0.0), DVec3::new(-1.0, 0.2, 0.0), DVec3::new(1.0, 0.0, 0.0)];
    let conjugate = DVec3::new(0.1, 0.0, 1.0).normalize();
    let mut failures: Vec<Failure> = at_node
        .iter()
        .zip(tilted)
        .map(|(&element, normal)| Failure { element, normal: normal.normalize(), index: 1.0 })
        .collect();
    failures.push(Failure { element: at_node[3], normal: conjugate, index: 2.0 });
    let mut cut = specimen.clone();
    let changes = propagate(&mut cut, &failures, &Propagation::default(), |_| true);
    let of_node = changes.cuts.iter().find(|c| c.node == node).unwrap();
    assert!((of_node.normal.x - 1.0).abs() < 1e-3 && of_node.normal.z == 0.0, "{}", of_node.normal);
}

#[test]
fn one_call_goes_one_ring_and_touches_nothing_twice() {
    let mut random = Random(11);
    for rule in [PropagationRule::TwoAtNode, PropagationRule::SingleElement] {
        let mut specimen = Specimen::new(&bar([6, 5, 4]), 0.25);
        let settings = Propagation { rule, ..Propagation::default() };
        for _ in 0..12 {
            let failures: Vec<Failure> = specimen
                .elements()
                .map(|element| Failure {
                    element,
                    normal: random.direction(),
                    index: 1.0 + random.signed().abs(),
                })
                .collect();
            let before = specimen.clone();
            let changes = propagate(&mut specimen, &failures, &settings, |_| true);
            let mut used = vec![false; specimen.solid.tets().len()];
            for cut in &changes.cuts {
                for &element in before.solid.elements_at(cut.node) {
                    assert!(!std::mem::replace(&mut used[element as usize], true), "{element} was cut twice");
                }
            }
            assert!(changes.cuts.len() > 3);
        }
        assert_sound(&specimen);
    }
}

#[test]
fn same_failures_same_result_whatever_their_order() {
    let mut random = Random(5);
    let mut specimen = Specimen::random(&mut random);
    let mut other = specimen.clone();
    for _ in 0..10 {
        let mut failures: Vec<Failure> = specimen
            .elements()
            .filter(|_| random.below(3) == 0)
            .map(|element| Failure {
                element,
                normal: random.direction(),
                index: 1.0 + random.signed().abs(),
            })
            .collect();
        let first = propagate(&mut specimen, &failures, &Propagation::default(), |_| true);
        failures.reverse();
        let second = propagate(&mut other, &failures, &Propagation::default(), |_| true);
        assert_eq!(first, second);
        assert_eq!(specimen.positions_m, other.positions_m);
    }
}

#[test]
fn cracks_wait_for_their_pace_and_say_so() {
    let mut specimen = Specimen::new(&bar([5, 4, 4]), 0.25);
    let mut pace = CrackPace::new(100.0, specimen.solid.tets().len());
    let settings = Propagation::default();
    let mut advances = Vec::new();
    for step in 0..60 {
        let time_s = f64::from(step) * 2e-3;
        let failures = failures_across(&specimen, DVec3::new(0.1, 0.0, 0.0), DVec3::X);
        let worst: Vec<Failure> = failures.into_iter().filter(|f| f.index > 1.15 || step > 0).collect();
        let changes = propagate(&mut specimen, &worst, &settings, |element| pace.may_crack(element, time_s));
        pace.record(&changes, time_s);
        if !changes.crack_faces.is_empty() {
            advances.push(time_s);
        }
        if step == 1 {
            assert!(changes.cuts.len() < 6 && changes.limits.waiting > 0, "{:?}", changes.limits);
        }
    }
    // A ring is at least a cell wide: at 100 m/s, 4 cells take several waits of 10 ms.
    assert!(advances.len() > 2 && advances[advances.len() - 1] > 0.01, "{advances:?}");
    assert!(specimen.solid.fragments().list().len() > 1);
}

#[test]
fn a_body_that_fails_all_over_breaks_into_shards_not_splinters() {
    let mut specimen = Specimen::new(&bar([8, 6, 3]), 0.25);
    let limits = FractureLimits::for_body(&specimen.solid);
    let settings = Propagation { limits, ..Propagation::default() };
    let mut random = Random(9);
    for _ in 0..40 {
        let failures: Vec<Failure> = specimen
            .elements()
            .map(|element| Failure { element, normal: random.direction(), index: 1.0 })
            .collect();
        propagate(&mut specimen, &failures, &settings, |_| true);
    }
    assert_sound(&specimen);
    let list = specimen.solid.fragments().list();
    assert!(list.len() > 5, "{}", list.len());
    assert!(list.iter().all(|f| f.mass_kg >= limits.smallest_fragment_kg * (1.0 - 1e-9)));
    assert!(specimen.solid.tets().len() <= limits.max_elements);
}
