//! Random planes through random nodes of random bodies.

use super::specimen::{Random, Specimen, assert_followable, assert_same, assert_sound};
use crate::fracture::{FractureLimits, Propagation};

/// A node of a random element: the finer a place has become, the likelier.
fn any_node(specimen: &Specimen, random: &mut Random) -> u32 {
    let tets = specimen.solid.tets();
    tets[random.below(tets.len())][random.below(4)]
}

#[test]
fn a_thousand_random_planes_leave_sound_bodies_that_lost_nothing() {
    let (mut four_faced, mut fragments, mut cracked) = (0, 0, 0);
    for seed in 0..50 {
        let mut random = Random(seed);
        let mut specimen = Specimen::random(&mut random);
        assert_sound(&specimen);
        let (first, settings) = (specimen.totals(), Propagation::default());
        for _ in 0..20 {
            let node = any_node(&specimen, &mut random);
            let before = specimen.clone();
            let changes = specimen.cut(node, random.direction(), &settings);
            four_faced += assert_sound(&specimen);
            assert_same(&before.totals(), &specimen.totals());
            assert_followable(&before, &specimen, &changes);
            cracked += changes.crack_faces.len();
        }
        assert_same(&first, &specimen.totals());
        fragments += specimen.solid.fragments().list().len();
    }
    println!("four-faced edges {four_faced}, fragments {fragments}, crack faces {cracked}");
    assert!(fragments > 100 && cracked > 5000, "{fragments} {cracked}: hardly anything was cut");
}

#[test]
fn hundreds_of_cuts_of_one_body_keep_to_the_floor() {
    let mut worst = f64::INFINITY;
    for seed in 100..106 {
        let mut random = Random(seed);
        let mut specimen = Specimen::random(&mut random);
        let (first, settings) = (specimen.totals(), Propagation::default());
        let initial_m = specimen.smallest_altitude_m();
        for _ in 0..300 {
            let node = any_node(&specimen, &mut random);
            specimen.cut(node, random.direction(), &settings);
        }
        assert_sound(&specimen);
        assert_same(&first, &specimen.totals());
        worst = worst.min(specimen.smallest_altitude_m() / initial_m);
        let list = specimen.solid.fragments().list();
        println!("{} elements, {} fragments", specimen.solid.tets().len(), list.len());
    }
    println!("smallest altitude {worst:.4} of the initial one");
    assert!(worst >= 0.25);
}

#[test]
fn what_bisection_takes_from_the_motion_is_booked() {
    let mut random = Random(7);
    let mut specimen = Specimen::random(&mut random);
    for _ in 0..30 {
        let (energy, spin) = (specimen.kinetic_energy_j(), specimen.angular_momentum_kg_m2_s());
        let changes =
            specimen.cut(any_node(&specimen, &mut random), random.direction(), &Propagation::default());
        let lost_j = energy - specimen.kinetic_energy_j();
        assert!((lost_j - changes.kinetic_energy_lost_j).abs() < 1e-12 * energy);
        assert!(changes.kinetic_energy_lost_j >= 0.0);
        let lost = spin - specimen.angular_momentum_kg_m2_s();
        assert!((lost - changes.angular_momentum_lost_kg_m2_s).length() < 1e-12 * energy);
    }
}

#[test]
fn limits_hold_and_are_reported() {
    let mut random = Random(3);
    let mut specimen = Specimen::random(&mut random);
    let max_elements = specimen.solid.tets().len() + 60;
    let limits = FractureLimits { max_elements, smallest_fragment_elements: 12, smallest_fragment_kg: 0.0 };
    let settings = Propagation { limits, ..Propagation::default() };
    let (mut elements, mut fragments) = (0, 0);
    for _ in 0..400 {
        let node = any_node(&specimen, &mut random);
        let changes = specimen.cut(node, random.direction(), &settings);
        elements += changes.limits.elements;
        fragments += changes.limits.fragments;
    }
    assert_sound(&specimen);
    assert!(specimen.solid.tets().len() <= max_elements);
    let list = specimen.solid.fragments().list();
    assert!(list.iter().all(|fragment| fragment.elements >= 12), "{list:?}");
    assert!(list.len() > 1 && elements > 0 && fragments > 0, "{} {elements} {fragments}", list.len());
    // A node that is left whole again and again counts once.
    let left_whole: Vec<u32> = specimen.solid.left_whole.iter().copied().collect();
    assert_eq!(left_whole.len(), fragments as usize);
    for node in left_whole {
        assert_eq!(specimen.cut(node, random.direction(), &settings).limits.fragments, 0);
    }
}

#[test]
fn the_heaviest_part_keeps_its_id() {
    for seed in 20..40 {
        let mut random = Random(seed);
        let mut specimen = Specimen::random(&mut random);
        for _ in 0..40 {
            let before = specimen.solid.fragments().list().to_vec();
            let changes =
                specimen.cut(any_node(&specimen, &mut random), random.direction(), &Propagation::default());
            let list = specimen.solid.fragments().list();
            for (new, id) in changes.new_fragments.iter().zip(before.len()..) {
                assert_eq!(new.id as usize, id);
                assert_eq!(list[id].parent, Some(new.parent));
                assert!(list[id].mass_kg <= list[new.parent as usize].mass_kg * (1.0 + 1e-9));
            }
            assert_eq!(list.len(), before.len() + changes.new_fragments.len());
        }
    }
}
