//! Cracks that grow step by step: which nodes crack, how far, how fast, how straight.

use super::specimen::{Random, Specimen, area_m2, assert_sound};
use crate::fracture::{
    Changes, CrackPace, Face, Failure, FractureLimits, Growth, NodeState, Propagation, PropagationRule,
};
use crate::mesh::shapes::block;
use glam::DVec3;

fn propagate(
    specimen: &mut Specimen,
    failures: &[Failure],
    settings: &Propagation,
    may_crack: impl Fn(u32, Growth) -> bool,
) -> Changes {
    let nodes =
        NodeState { positions_m: &mut specimen.positions_m, velocities_m_s: &mut specimen.velocities_m_s };
    specimen.solid.propagate(nodes, failures, settings, may_crack)
}

/// What the plane crosses at the nodes of the crack: all that fails at the tip of a single one.
fn failures_at_tip(specimen: &Specimen, point_m: DVec3, normal: DVec3) -> Vec<Failure> {
    let mut sides = std::collections::BTreeMap::<(u32, u32), [bool; 2]>::new();
    for face in specimen.solid.surface() {
        if let Face::Crack { pair, above } = face.kind {
            face.nodes
                .iter()
                .for_each(|&node| sides.entry((pair, node)).or_default()[usize::from(above)] = true);
        }
    }
    let mut is_tip = vec![false; specimen.solid.node_count()];
    sides
        .iter()
        .filter(|(_, both)| **both == [true; 2])
        .for_each(|((_, node), _)| is_tip[*node as usize] = true);
    let crosses = |element: &u32| {
        let corners = specimen.solid.tets()[*element as usize];
        let distances = corners.map(|n| (specimen.positions_m[n as usize] - point_m).dot(normal));
        let is_at_tip = corners.iter().any(|&n| is_tip[n as usize]);
        is_at_tip && [1.0, -1.0].iter().all(|s| distances.iter().any(|d| d * s > 1e-6))
    };
    specimen.elements().filter(crosses).map(|element| Failure { element, normal, index: 1.0 }).collect()
}

#[test]
fn a_crack_across_a_bar_leaves_two_pieces_and_a_plane_between_them() {
    for (rule, slope) in [
        (PropagationRule::TwoAtNode, 0.0),
        (PropagationRule::TwoAtNode, 0.4),
        (PropagationRule::SingleElement, 0.0),
        (PropagationRule::SingleElement, 0.4),
    ] {
        let mut specimen = Specimen::new(&block([9, 4, 4]), 0.25);
        let normal = DVec3::new(1.0, 0.1, slope).normalize();
        let limits = FractureLimits::for_body(&specimen.solid);
        let settings = Propagation { rule, limits, ..Propagation::default() };
        // The node in the middle of the upper side.
        let is_seed = |x: &DVec3| x.distance(DVec3::new(0.5, 0.0, 2.0)) < 1e-9;
        let seed = specimen.positions_m.iter().position(is_seed).unwrap();
        let point_m = specimen.positions_m[seed];
        specimen.cut(seed as u32, normal, &settings);
        let mut steps = 0;
        while heaviest_share(&specimen) > 0.65 {
            let failures = failures_at_tip(&specimen, point_m, normal);
            propagate(&mut specimen, &failures, &settings, |_, _| true);
            assert_sound(&specimen);
            steps += 1;
            assert!(steps < 40, "{rule:?} {slope}: the crack does not get through");
        }
        let (area, farthest_m) = crack_shape(&specimen, point_m, normal);
        let ratio = area / (16.0 / normal.x);
        println!("{rule:?} {slope}: {steps} steps, area {ratio:.3}, off the plane by {farthest_m:.3} cells");
        assert!(specimen.solid.fragments().list().len() < 4);
        // What straddles the ideal plane keeps failing here, relieved or not, wherever snapping led
        // the crack beside it: across the grain of so coarse a mesh it then forks.
        let (most, far_m) = if slope == 0.0 { (1.05, 0.25) } else { (5.0, 1.5) };
        assert!(ratio < most && farthest_m < far_m, "{rule:?} {slope}: {ratio} {farthest_m}");
    }
}

fn heaviest_share(specimen: &Specimen) -> f64 {
    let masses = specimen.solid.fragments().list().iter().map(|fragment| fragment.mass_kg);
    masses.clone().fold(0.0, f64::max) / masses.sum::<f64>()
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
    let specimen = Specimen::new(&block([3, 3, 3]), 0.25);
    let failures = [Failure { element: 81, normal: DVec3::X, index: 1.2 }];
    for (rule, expected) in [(PropagationRule::TwoAtNode, 0), (PropagationRule::SingleElement, 1)] {
        let mut specimen = specimen.clone();
        let settings = Propagation { rule, ..Propagation::default() };
        let changes = propagate(&mut specimen, &failures, &settings, |_, _| true);
        assert_eq!(changes.cuts.len(), expected, "{rule:?}");
        assert_eq!(changes.crack_faces.is_empty(), expected == 0);
        assert_eq!(changes.is_empty(), expected == 0);
    }
}

#[test]
fn failures_of_a_node_are_averaged_with_signs_aligned_and_conjugates_kept_apart() {
    let specimen = Specimen::new(&block([3, 3, 3]), 0.25);
    let node = specimen.solid.tets()[81][0];
    let at_node = specimen.solid.elements_at(node).to_vec();
    // One family of normals with mixed signs, its mean along x; and the worst one, across it.
    let family = [DVec3::new(1.0, 0.2, 0.0), DVec3::new(-1.0, 0.2, 0.0), DVec3::new(1.0, 0.0, 0.0)];
    let normals = family.into_iter().chain([DVec3::new(0.1, 0.0, 1.0)]).map(DVec3::normalize);
    let failures: Vec<Failure> = at_node
        .iter()
        .zip(normals)
        .zip([1.0, 1.0, 1.0, 2.0])
        .map(|((&element, normal), index)| Failure { element, normal, index })
        .collect();
    let mut cut = specimen.clone();
    let changes = propagate(&mut cut, &failures, &Propagation::default(), |_, _| true);
    let normal = changes.cuts[0].normal;
    assert!(normal.x > 0.999 && normal.z == 0.0, "{normal}");
}

#[test]
fn one_call_goes_one_ring_and_touches_nothing_twice() {
    let mut random = Random(11);
    for rule in [PropagationRule::TwoAtNode, PropagationRule::SingleElement] {
        let mut specimen = Specimen::new(&block([6, 5, 4]), 0.25);
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
            let changes = propagate(&mut specimen, &failures, &settings, |_, _| true);
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
    for round in 0..10 {
        let mut failures: Vec<Failure> = specimen
            .elements()
            .filter(|element| element % 3 == round % 3)
            .map(|element| Failure {
                element,
                normal: random.direction(),
                index: 1.0 + random.signed().abs(),
            })
            .collect();
        let first = propagate(&mut specimen, &failures, &Propagation::default(), |_, _| true);
        failures.reverse();
        let second = propagate(&mut other, &failures, &Propagation::default(), |_, _| true);
        assert_eq!(first, second);
        assert_eq!(specimen.positions_m, other.positions_m);
    }
}

#[test]
fn cracks_wait_for_their_pace_and_say_so() {
    let mut specimen = Specimen::new(&block([5, 4, 4]), 0.25);
    let mut pace = CrackPace::new(100.0, 0.0, specimen.solid.tets().len());
    let settings = Propagation::default();
    let seed =
        specimen.positions_m.iter().position(|x| x.distance(DVec3::new(0.5, 0.0, 2.0)) < 1e-9).unwrap();
    let point_m = specimen.positions_m[seed];
    let normal = DVec3::new(1.0, 0.1, 0.0).normalize();
    let changes = specimen.cut(seed as u32, normal, &settings);
    pace.record(&specimen.solid, &changes, 0.0);
    let (mut steps, mut pauses, mut told) = (0, 0, 0);
    while specimen.solid.fragments().list().len() == 1 {
        steps += 1;
        assert!(steps < 100, "the crack does not get through");
        let time_s = f64::from(steps) * 2e-3;
        let failures = failures_at_tip(&specimen, point_m, normal);
        let changes = propagate(&mut specimen, &failures, &settings, |element, growth| {
            pace.may_crack(element, growth, time_s)
        });
        pace.record(&specimen.solid, &changes, time_s);
        pauses += u32::from(changes.cuts.is_empty());
        told += changes.limits.speed;
    }
    // At 100 m/s a crack needs 40 ms for the 4 m to the far side, give or take a ring.
    let time_s = f64::from(steps) * 2e-3;
    assert!((0.025..0.08).contains(&time_s) && pauses > 5, "{time_s} s, {pauses} pauses");
    // In each pause some node waits: counted at every call they would be more than the pauses.
    assert!(told > 1 && told < pauses, "{told} nodes in {pauses} pauses");
}

#[test]
fn beside_a_crack_no_other_starts_until_the_news_has_arrived() {
    let mut specimen = Specimen::new(&block([9, 4, 4]), 0.25);
    let mut pace = CrackPace::new(100.0, 3.0, specimen.solid.tets().len());
    let at = |place_m: DVec3, specimen: &Specimen| {
        specimen.positions_m.iter().position(|x| x.distance(place_m) < 1e-9).unwrap() as u32
    };
    let seed = at(DVec3::new(0.5, 0.0, 2.0), &specimen);
    let changes = specimen.cut(seed, DVec3::new(1.0, 0.1, 0.0).normalize(), &Propagation::default());
    pace.record(&specimen.solid, &changes, 0.0);
    let reach_m = changes.cuts[0].reach_m;
    let may_start = |place_m: DVec3, time_s: f64| {
        let elements = specimen.solid.elements_at(at(place_m, &specimen)).iter();
        let mut allowed = elements.map(|e| pace.may_crack(*e, Growth::Starts, time_s));
        allowed.all(|allowed| allowed)
    };
    let beside = DVec3::new(2.5, 0.0, 2.0);
    let distance_m = 2.0;
    assert!(distance_m < 2.0 * reach_m && !may_start(beside, 0.5 * distance_m / 100.0));
    assert!(may_start(beside, 1.5 * distance_m / 100.0));
    // Out of its reach, and for a crack that goes on there.
    assert!(may_start(DVec3::new(-4.5, 0.0, 2.0), 0.0));
    let elements = specimen.solid.elements_at(at(beside, &specimen)).iter();
    let outside = elements.filter(|e| !changes.cuts[0].elements.contains(e));
    assert!(outside.copied().all(|e| pace.may_crack(e, Growth::GoesOn, 0.0)));
}

#[test]
fn a_body_that_fails_all_over_breaks_into_shards_not_splinters() {
    let mut specimen = Specimen::new(&block([8, 6, 3]), 0.25);
    let limits = FractureLimits::for_body(&specimen.solid);
    let settings = Propagation { limits, ..Propagation::default() };
    let mut random = Random(9);
    for _ in 0..40 {
        let failures: Vec<Failure> = specimen
            .elements()
            .map(|element| Failure { element, normal: random.direction(), index: 1.0 })
            .collect();
        propagate(&mut specimen, &failures, &settings, |_, _| true);
    }
    assert_sound(&specimen);
    let list = specimen.solid.fragments().list();
    assert!(list.len() > 5, "{}", list.len());
    assert!(list.iter().all(|f| f.mass_kg >= limits.smallest_fragment_kg * (1.0 - 1e-9)));
    assert!(specimen.solid.tets().len() <= limits.max_elements);
}
