//! What must hold in any scene.

use super::inside;
use glam::DVec3;
use hammerfall::frame::BodyFrame;
use hammerfall::mesh::{Pieces, Surface, signed_volume_m3};
use hammerfall::scene::Scene;
use hammerfall::sim::{BodyMotion, Change, ContactMethod, Sample, World};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Elastic steps after which a scene has been run for long enough.
const MOST_STEPS: u64 = 2000;
/// Steps in all, free ones included.
const MOST_ROUNDS: u64 = 5000;
/// Steps between two looks at what is costly to check.
const STEPS_BETWEEN_LOOKS: u64 = 100;
/// Deepest penetration of a pair of features over the local element size with multipliers.
const DEPTH: f64 = 0.01;
/// Energy that comes from nowhere or goes there, over the energy and work in play.
const ENERGY: f64 = 0.05;
/// The same while pairs press: coarse bodies tell it badly as long as a blow lasts (README, Limits).
const ENERGY_IN_A_BLOW: f64 = 0.15;
/// Less energy than this is the round-off of bodies at rest, J.
const NO_ENERGY_J: f64 = 1e-9;
/// The same for momentum, mass, volume and area, which are sums: round-off.
const ROUND_OFF: f64 = 1e-9;
/// Positions of frames have seven digits.
const FRAME_VOLUME: f64 = 1e-3;

/// How far scenes went and how near the bounds.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    elastic_steps: u64,
    depth: f64,
    spring_depth: f64,
    energy: f64,
    new_fragments: usize,
    contacts: usize,
    isolated: usize,
}

impl Findings {
    pub fn join(&mut self, other: &Self) {
        self.elastic_steps += other.elastic_steps;
        self.depth = self.depth.max(other.depth);
        self.spring_depth = self.spring_depth.max(other.spring_depth);
        self.energy = self.energy.max(other.energy);
        self.new_fragments += other.new_fragments;
        self.contacts += other.contacts;
        self.isolated += other.isolated;
    }

    pub fn has_seen_everything(&self) -> bool {
        self.new_fragments > 0 && self.contacts > 0 && self.isolated > 0 && self.spring_depth > 0.0
    }
}

impl fmt::Display for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} elastic steps, depth {:.1e} (springs {:.1e}), energy {:.1e}, {} contacts, {} new fragments, {} isolated",
            self.elastic_steps,
            self.depth,
            self.spring_depth,
            self.energy,
            self.contacts,
            self.new_fragments,
            self.isolated
        )
    }
}

/// Runs a scene and checks it on the way; what is wrong with it begins with words that name the kind.
pub fn check(scene: &Scene) -> Result<Findings, String> {
    let mut world = World::new(scene.setup.clone()).map_err(|error| format!("no world: {error}"))?;
    let mut laws = Laws::new(&world);
    let (mut rounds, mut next_look) = (0, 0);
    while world.time_s() < scene.description.duration_s
        && rounds < MOST_ROUNDS
        && laws.found.elastic_steps < MOST_STEPS
    {
        // Bodies in free travel are only placed where somebody wants to look.
        let soon_s = world.time_s() + 1e-12;
        let limit_s = if rounds + 1 >= next_look { soon_s } else { scene.description.duration_s };
        let report = world.step(limit_s).map_err(|error| format!("no step: {error}"))?;
        laws.found.elastic_steps += u64::from(report.elastic_steps);
        rounds += 1;
        laws.check_step(&world)?;
        if rounds >= next_look {
            look(&world)?;
            if !laws.is_penalty {
                inside::check(&world)?;
            }
            next_look += STEPS_BETWEEN_LOOKS;
        }
    }
    laws.check_end(&world)?;
    Ok(laws.found)
}

/// What is compared with how it was.
struct Laws {
    found: Findings,
    start: Sample,
    /// Largest kinetic and strain energy and work so far, J.
    energy_in_play_j: f64,
    /// Nothing outside acts but gravity.
    is_isolated: bool,
    is_penalty: bool,
    mass_kg: f64,
    gravity_m_s2: DVec3,
}

impl Laws {
    fn new(world: &World) -> Self {
        let setup = world.setup();
        let is_left_alone = setup
            .bodies
            .iter()
            .all(|body| matches!(body.motion, BodyMotion::Deformable(_)) && body.boundary.is_empty());
        let is_isolated = is_left_alone && setup.changes.is_empty();
        Self {
            found: Findings { isolated: usize::from(is_isolated), ..Findings::default() },
            start: world.sample(),
            energy_in_play_j: 0.0,
            is_isolated,
            is_penalty: matches!(setup.contact.method, ContactMethod::Penalty { .. }),
            mass_kg: (0..world.body_count()).map(|body| world.mass_kg(body)).sum(),
            gravity_m_s2: setup.gravity_m_s2,
        }
    }

    fn check_step(&mut self, world: &World) -> Result<(), String> {
        let now = world.sample();
        let time_s = world.time_s();
        let numbers = [now.kinetic_j, now.strain_j, now.potential_j, now.dissipated_j, now.external_work_j];
        if !numbers.iter().all(|number| number.is_finite()) || !now.linear_momentum_kg_m_s.is_finite() {
            return Err(format!("not finite: {now:?}"));
        }
        let depth = world.largest_penetration_ratio();
        // Springs promise nothing.
        let of = if self.is_penalty { &mut self.found.spring_depth } else { &mut self.found.depth };
        *of = of.max(depth);
        if depth > DEPTH && !self.is_penalty {
            return Err(format!("penetration: {depth:.3e} of an element at {time_s:.5} s"));
        }
        let in_play_j =
            now.kinetic_j + now.strain_j.abs() + now.external_work_j.abs() + now.potential_j.abs();
        self.energy_in_play_j = self.energy_in_play_j.max(in_play_j);
        let error_j = (now.balance_j() - self.start.balance_j()).abs();
        let share = error_j / self.energy_in_play_j.max(NO_ENERGY_J);
        self.found.energy = self.found.energy.max(share);
        let bound = if now.step.contact_pairs > 0 { ENERGY_IN_A_BLOW } else { ENERGY };
        if share > bound {
            return Err(format!("energy: {share:.3e} of that in play is off at {time_s:.5} s: {now:?}"));
        }
        if self.is_isolated { self.check_momentum(&now, time_s) } else { Ok(()) }
    }

    fn check_momentum(&self, now: &Sample, time_s: f64) -> Result<(), String> {
        let expected = self.start.linear_momentum_kg_m_s + self.mass_kg * self.gravity_m_s2 * time_s;
        let error = (now.linear_momentum_kg_m_s - expected).length();
        // That of all bodies if they moved alike with the same energy.
        let in_play = (2.0 * self.mass_kg * self.energy_in_play_j).sqrt();
        if error > ROUND_OFF * in_play {
            return Err(format!("momentum: {error:.3e} of {in_play:.3e} kg m/s at {time_s:.5} s"));
        }
        Ok(())
    }

    fn check_end(&mut self, world: &World) -> Result<(), String> {
        self.found.contacts = world.contact_episodes().len();
        self.found.new_fragments = world.sample().fragments.saturating_sub(self.start.fragments);
        let entered = |name: &str| {
            let changes = world.setup().changes.iter();
            changes.clone().any(|c| matches!(&c.change, Change::Enter(body) if body.body.name == name))
        };
        let setups = world.setup().bodies.iter().enumerate();
        for (body, setup) in setups.filter(|(body, setup)| !world.is_removed(*body) && !entered(&setup.name))
        {
            check_matter(world, body, setup)?;
        }
        Ok(())
    }
}

/// Cuts neither make nor take matter, and leave no holes: without the faces of cracks, the surface is as large as it was.
fn check_matter(world: &World, body: usize, setup: &hammerfall::sim::BodySetup) -> Result<(), String> {
    let volume_m3 = |nodes_m: &[DVec3], tets: &[[u32; 4]]| -> f64 {
        tets.iter().map(|tet| signed_volume_m3(&tet.map(|n| nodes_m[n as usize]))).sum()
    };
    let (nodes_m, tets) = (world.reference_positions_m(body), world.tets(body));
    let before_m3 = volume_m3(&setup.mesh.nodes_m, &setup.mesh.tets);
    let after_m3 = volume_m3(nodes_m, tets);
    if (after_m3 / before_m3 - 1.0).abs() > ROUND_OFF {
        return Err(format!("volume: body {} had {before_m3} m3 and has {after_m3}", setup.name));
    }
    let flattest_m3 = tets
        .iter()
        .map(|tet| signed_volume_m3(&tet.map(|n| nodes_m[n as usize])))
        .fold(f64::INFINITY, f64::min);
    if flattest_m3 <= 0.0 {
        return Err(format!("an element without volume: {flattest_m3:e} m3 in body {}", setup.name));
    }
    let mass_kg: f64 = (0_u32..)
        .zip(tets)
        .map(|(element, tet)| {
            let density = world.material_of(body, element).map_or(f64::NAN, |m| m.density_kg_m3);
            density * signed_volume_m3(&tet.map(|n| nodes_m[n as usize]))
        })
        .sum();
    let known_kg = world.mass_kg(body) - world.mass_scaling(body).added_kg;
    if !mass_kg.is_finite() || (mass_kg / known_kg - 1.0).abs() > ROUND_OFF {
        return Err(format!("mass: body {} of {mass_kg} kg counts as {known_kg}", setup.name));
    }
    let sorted = |mut corners: [u32; 3]| {
        corners.sort_unstable();
        corners
    };
    let cracks: BTreeSet<[u32; 3]> = world.crack_faces(body).map(|face| sorted(face.nodes)).collect();
    let area_m2 = |nodes_m: &[DVec3], tets: &[[u32; 4]], cracks: &BTreeSet<[u32; 3]>| -> f64 {
        let triangles =
            Surface::of(tets).triangles.into_iter().filter(|corners| !cracks.contains(&sorted(*corners)));
        let corners = triangles.map(|triangle| triangle.map(|n| nodes_m[n as usize]));
        corners.map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum()
    };
    let after_m2 = area_m2(nodes_m, tets, &cracks);
    let before_m2 = area_m2(&setup.mesh.nodes_m, &setup.mesh.tets, &BTreeSet::new());
    if (after_m2 / before_m2 - 1.0).abs() > ROUND_OFF {
        return Err(format!(
            "holes: without its cracks the surface of body {} grew from {before_m2} to {after_m2} m2",
            setup.name
        ));
    }
    Ok(())
}

/// What a look at the world shows: its pieces, and every fragment a closed surface around its own volume.
fn look(world: &World) -> Result<(), String> {
    let frame = world.publish();
    let mut pieces = 0;
    for (body, drawn) in frame.bodies.iter().enumerate().filter(|(body, _)| !world.is_removed(*body)) {
        let name = &drawn.name;
        let tets = world.tets(body);
        if Surface::of(tets).overused_faces > 0 {
            return Err(format!("a face of three elements in body {name}"));
        }
        let by_faces = Pieces::by_faces(tets);
        let is_deformable = matches!(world.setup().bodies[body].motion, BodyMotion::Deformable(_));
        pieces += if is_deformable { by_faces.count } else { 0 };
        check_labels(world.fragment_of_element(body), &by_faces)
            .map_err(|reason| format!("fragments: {name}: {reason}"))?;
        if !drawn.positions_m.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(format!("not finite: the picture of body {name}"));
        }
        check_drawn(world, body, drawn).map_err(|reason| format!("surface: {name}: {reason}"))?;
    }
    let counted = world.sample().fragments;
    if counted != pieces {
        return Err(format!("fragments: {counted} are counted, {pieces} are there"));
    }
    Ok(())
}

/// Elements have the same label exactly if faces lead from one to the other.
fn check_labels(labels: &[u32], pieces: &Pieces) -> Result<(), String> {
    let mut piece_of_label = BTreeMap::new();
    for (label, piece) in labels.iter().zip(&pieces.of_tet) {
        if piece_of_label.insert(label, piece).is_some_and(|before| before != piece) {
            return Err(format!("label {label} stands for two pieces"));
        }
    }
    if !labels.is_empty() && piece_of_label.len() != pieces.count {
        return Err(format!("{} labels for {} pieces", piece_of_label.len(), pieces.count));
    }
    Ok(())
}

fn check_drawn(world: &World, body: usize, drawn: &BodyFrame) -> Result<(), String> {
    let labels = &drawn.surface.triangle_fragment;
    let fragment = |triangle: usize| labels.get(triangle).copied().unwrap_or(0);
    // Each edge is passed as often in one direction as in the other.
    let mut edges: BTreeMap<(u32, u32, u32), i32> = BTreeMap::new();
    let mut drawn_m3: BTreeMap<u32, f64> = BTreeMap::new();
    let place_m = |vertex: u32| glam::Vec3::from(drawn.positions_m[vertex as usize]).as_dvec3();
    let origin_m = drawn.positions_m.first().map_or(DVec3::ZERO, |p| glam::Vec3::from(*p).as_dvec3());
    for (triangle, corners) in drawn.surface.triangles.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            *edges.entry((fragment(triangle), a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
        }
        let [a, b, c] = corners.map(|corner| place_m(corner) - origin_m);
        *drawn_m3.entry(fragment(triangle)).or_insert(0.0) += a.dot(b.cross(c)) / 6.0;
    }
    if let Some(((fragment, a, b), _)) = edges.iter().find(|(_, sum)| **sum != 0) {
        return Err(format!("fragment {fragment} is open at the edge {a}-{b}"));
    }
    let positions_m = world.positions_m(body);
    let of_element = world.fragment_of_element(body);
    let mut volumes_m3: BTreeMap<u32, f64> = BTreeMap::new();
    for (element, tet) in world.tets(body).iter().enumerate() {
        let fragment = of_element.get(element).copied().unwrap_or(0);
        *volumes_m3.entry(fragment).or_insert(0.0) += signed_volume_m3(&tet.map(|n| positions_m[n as usize]));
    }
    let whole_m3: f64 = volumes_m3.values().map(|volume_m3| volume_m3.abs()).sum();
    for (fragment, volume_m3) in &volumes_m3 {
        let shown_m3 = drawn_m3.get(fragment).copied().unwrap_or(0.0);
        if (shown_m3 - volume_m3).abs() > FRAME_VOLUME * whole_m3 {
            return Err(format!("fragment {fragment} of {volume_m3:e} m3 is drawn with {shown_m3:e}"));
        }
    }
    Ok(())
}
