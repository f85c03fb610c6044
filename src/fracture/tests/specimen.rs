//! Random bodies to cut, and everything that must hold of them.

use crate::fracture::{Changes, Face, NodeBirth, NodeState, Propagation, Solid};
use crate::mesh::shapes::{Ball, Beam, BoxShape, Meshing, Resolution, Shape};
use crate::mesh::{ElementShape, Surface, TetMesh, signed_volume_m3};
use glam::{DMat3, DVec3};

/// Seeded random numbers (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// In [-1, 1).
    pub fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.vector();
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}

/// What no cut may change.
#[derive(Clone, Copy, Debug)]
pub struct Totals {
    pub volume_m3: f64,
    pub mass_kg: f64,
    pub momentum_kg_m_s: DVec3,
    pub energy_j: f64,
    /// Of the body's surface as it was given.
    pub boundary_m2: f64,
}

/// A body with a state of motion and deformation.
#[derive(Clone, Debug)]
pub struct Specimen {
    pub solid: Solid,
    pub positions_m: Vec<DVec3>,
    pub velocities_m_s: Vec<DVec3>,
}

impl Specimen {
    pub fn new(mesh: &TetMesh, altitude_share: f64) -> Self {
        let density: Vec<f64> =
            mesh.regions.iter().map(|region| 1000.0 + 500.0 * f64::from(*region)).collect();
        let solid = Solid::new(mesh, &density, altitude_share).unwrap();
        let (positions_m, velocities_m_s) = (mesh.nodes_m.clone(), vec![DVec3::ZERO; mesh.nodes_m.len()]);
        Self { solid, positions_m, velocities_m_s }
    }

    /// A box, ball or beam with displaced nodes, strained by some percent, in wild motion.
    pub fn random(random: &mut Random) -> Self {
        let cells = [1, 2, 3].map(|least| least + random.below(3) as u32);
        let shape = match random.below(3) {
            0 => Shape::Ball(Ball { radius_m: 0.5 }),
            1 => Shape::Beam(Beam::default()),
            _ => Shape::Box(BoxShape { size_m: DVec3::from_array(cells.map(f64::from)) * 0.2 }),
        };
        let resolution = match shape {
            Shape::Box(_) => Resolution::Cells(cells),
            _ => Resolution::Refinement(1 + random.below(2) as u32),
        };
        let mut mesh = shape.build(&Meshing { resolution, ..Meshing::default() }).unwrap();
        jitter(&mut mesh, random);
        let mut specimen = Self::new(&mesh, 0.25);
        let strain = DMat3::from_cols(random.vector(), random.vector(), random.vector()) * 0.02;
        for (x, v) in specimen.positions_m.iter_mut().zip(&mut specimen.velocities_m_s) {
            *x += strain * *x + random.vector() * 5e-4;
            *v = random.vector() * 10.0;
        }
        specimen
    }

    pub fn cut(&mut self, node: u32, normal: DVec3, settings: &Propagation) -> Changes {
        let nodes =
            NodeState { positions_m: &mut self.positions_m, velocities_m_s: &mut self.velocities_m_s };
        self.solid.cut_node(nodes, node, normal, settings)
    }

    pub fn elements(&self) -> std::ops::Range<u32> {
        0..self.solid.tets().len() as u32
    }

    pub fn smallest_altitude_m(&self) -> f64 {
        let altitude_m = |e| ElementShape::of(&self.solid.corners_m(e)).min_altitude_m;
        self.elements().map(altitude_m).fold(f64::INFINITY, f64::min)
    }

    pub fn kinetic_energy_j(&self) -> f64 {
        (0_u32..)
            .zip(&self.velocities_m_s)
            .map(|(n, v)| 0.5 * self.solid.node_mass_kg(n) * v.length_squared())
            .sum()
    }

    pub fn angular_momentum_kg_m2_s(&self) -> DVec3 {
        let nodes = (0_u32..).zip(self.positions_m.iter().zip(&self.velocities_m_s));
        nodes.map(|(n, (x, v))| self.solid.node_mass_kg(n) * x.cross(*v)).sum()
    }

    pub fn totals(&self) -> Totals {
        let area = |nodes: [u32; 3]| area_m2(nodes, self.solid.reference_m()).length();
        Totals {
            volume_m3: self.elements().map(|e| signed_volume_m3(&self.solid.corners_m(e))).sum(),
            mass_kg: (0..self.solid.node_count() as u32).map(|n| self.solid.node_mass_kg(n)).sum(),
            momentum_kg_m_s: (0_u32..)
                .zip(&self.velocities_m_s)
                .map(|(n, v)| self.solid.node_mass_kg(n) * *v)
                .sum(),
            energy_j: self.elements().map(|e| self.energy_j(e)).sum(),
            boundary_m2: self
                .solid
                .surface()
                .filter(|f| f.kind == Face::Boundary)
                .map(|f| area(f.nodes))
                .sum(),
        }
    }

    /// St. Venant-Kirchhoff: `V0 (lambda/2 tr(E)^2 + mu E : E)`.
    fn energy_j(&self, element: u32) -> f64 {
        let edges = |at: [DVec3; 4]| DMat3::from_cols(at[1] - at[0], at[2] - at[0], at[3] - at[0]);
        let reference_m = self.solid.corners_m(element);
        let current_m = self.solid.tets()[element as usize].map(|node| self.positions_m[node as usize]);
        let gradient = edges(current_m) * edges(reference_m).inverse();
        let strain = (gradient.transpose() * gradient - DMat3::IDENTITY) * 0.5;
        let trace = strain.x_axis.x + strain.y_axis.y + strain.z_axis.z;
        let square: f64 = strain.to_cols_array().iter().map(|x| x * x).sum();
        let modulus_pa = 1e9 * (1.0 + 0.1 * f64::from(self.solid.origins()[element as usize] % 7));
        signed_volume_m3(&reference_m) * modulus_pa * (0.5 * trace * trace + square)
    }
}

fn jitter(mesh: &mut TetMesh, random: &mut Random) {
    let smallest = |mesh: &TetMesh| {
        let shapes = (0..mesh.tets.len()).map(|e| ElementShape::of(&mesh.corners_m(e)));
        shapes.map(|s| if s.volume_m3 > 0.0 { s.min_altitude_m } else { 0.0 }).fold(f64::INFINITY, f64::min)
    };
    let altitude_m = smallest(mesh);
    let straight = mesh.nodes_m.clone();
    let mut share = 0.5;
    loop {
        for (x, before) in mesh.nodes_m.iter_mut().zip(&straight) {
            *x = *before + random.vector() * share * altitude_m;
        }
        if smallest(mesh) > 0.4 * altitude_m {
            return;
        }
        share *= 0.8;
    }
}

pub fn area_m2(nodes: [u32; 3], at_m: &[DVec3]) -> DVec3 {
    let [a, b, c] = nodes.map(|node| at_m[node as usize]);
    (b - a).cross(c - a) / 2.0
}

/// Everything that must hold of a body at any time; returns the number of edges with four faces.
pub fn assert_sound(specimen: &Specimen) -> usize {
    assert_elements_sound(specimen);
    assert_faces_match(specimen);
    assert_cracks_close(specimen);
    assert_nodes_hang_together(specimen);
    assert_fragments_sound(specimen)
}

fn assert_elements_sound(specimen: &Specimen) {
    let floor_m = specimen.solid.altitude_floor_m();
    for element in specimen.elements() {
        let shape = ElementShape::of(&specimen.solid.corners_m(element));
        assert!(shape.volume_m3 > 0.0, "element {element} is inverted");
        let ratio = shape.min_altitude_m / floor_m;
        assert!(ratio >= 1.0, "element {element}: {ratio} of the floor");
    }
}

/// No hanging node: what the table calls neighbours share the whole face; no face belongs to more
/// than two elements.
fn assert_faces_match(specimen: &Specimen) {
    let solid = &specimen.solid;
    let mut keys = Vec::new();
    for element in specimen.elements() {
        for (face, kind) in solid.faces()[element as usize].iter().enumerate() {
            let mut nodes = solid.face_nodes(element, face);
            nodes.sort_unstable();
            keys.push((nodes, element, *kind));
        }
    }
    keys.sort_unstable_by_key(|key| (key.0, key.1));
    for group in keys.chunk_by(|a, b| a.0 == b.0) {
        match *group {
            [(_, element, kind)] => {
                assert!(!matches!(kind, Face::Inner(_)), "{element} misses its neighbour")
            }
            [(_, a, Face::Inner(to_b)), (_, b, Face::Inner(to_a))] => assert_eq!((to_a, to_b), (a, b)),
            [(_, _, Face::Crack { pair: p, above: up }), (_, _, Face::Crack { pair: q, above: down })] => {
                assert!(p == q && up != down, "a crack that parted nothing must have its two sides")
            }
            _ => panic!("faces meet that should not: {group:?}"),
        }
    }
}

/// The two sides of each pair cover the same area, with opposite normals.
fn assert_cracks_close(specimen: &Specimen) {
    let mut sums: std::collections::BTreeMap<u32, (DVec3, f64)> = std::collections::BTreeMap::new();
    for face in specimen.solid.surface() {
        if let Face::Crack { pair, above } = face.kind {
            let area = area_m2(face.nodes, specimen.solid.reference_m());
            let sum = sums.entry(pair).or_default();
            sum.0 += area;
            sum.1 += if above { area.length() } else { -area.length() };
        }
    }
    for (pair, (vector, scalar)) in sums {
        assert!(vector.length() < 1e-14 && scalar.abs() < 1e-14, "crack pair {pair}: {vector} {scalar}");
    }
}

/// The elements at each node are listed rightly and connected across uncracked faces.
fn assert_nodes_hang_together(specimen: &Specimen) {
    let solid = &specimen.solid;
    let mut at_node = vec![Vec::new(); solid.node_count()];
    for element in specimen.elements() {
        solid.tets()[element as usize].iter().for_each(|&node| at_node[node as usize].push(element));
    }
    for (node, elements) in (0_u32..).zip(&at_node) {
        assert_eq!(elements, solid.elements_at(node));
        let mut reached = vec![elements[0]];
        let mut next = 0;
        while let Some(&element) = reached.get(next) {
            next += 1;
            for face in solid.faces()[element as usize] {
                if let Face::Inner(other) = face
                    && elements.contains(&other)
                    && !reached.contains(&other)
                {
                    reached.push(other);
                }
            }
        }
        assert_eq!(reached.len(), elements.len(), "node {node} holds what nothing connects");
    }
}

fn assert_fragments_sound(specimen: &Specimen) -> usize {
    let solid = &specimen.solid;
    let fragments = solid.fragments();
    let total_kg: f64 = solid.masses_kg().iter().sum();
    let mut four_faced = 0;
    for (id, fragment) in (0_u32..).zip(fragments.list()) {
        let members: Vec<u32> =
            specimen.elements().filter(|&e| fragments.of_element()[e as usize] == id).collect();
        assert_eq!(members.len(), fragment.elements as usize, "fragment {id}");
        let mass_kg: f64 = members.iter().map(|&e| solid.masses_kg()[e as usize]).sum();
        assert!((mass_kg - fragment.mass_kg).abs() < 1e-12 * total_kg);
        // In one piece, and in nobody else's.
        let mut reached = std::collections::BTreeSet::from([members[0]]);
        let mut stack = vec![members[0]];
        while let Some(element) = stack.pop() {
            for face in solid.faces()[element as usize] {
                if let Face::Inner(other) = face
                    && reached.insert(other)
                {
                    stack.push(other);
                }
            }
        }
        assert_eq!(reached.into_iter().collect::<Vec<_>>(), members, "fragment {id}");
        let tets: Vec<[u32; 4]> = members.iter().map(|&e| solid.tets()[e as usize]).collect();
        let surface = Surface::of(&tets);
        assert!(surface.is_closed() && surface.overused_faces == 0, "fragment {id} is not closed");
        four_faced += surface.non_manifold_edges;
    }
    four_faced
}

pub fn assert_same(before: &Totals, after: &Totals) {
    let close = |a: f64, b: f64, share: f64| (a - b).abs() <= share * a.abs();
    assert!(close(before.volume_m3, after.volume_m3, 1e-12), "{before:?} {after:?}");
    assert!(close(before.mass_kg, after.mass_kg, 1e-12), "{before:?} {after:?}");
    assert!(close(before.boundary_m2, after.boundary_m2, 1e-12), "{before:?} {after:?}");
    assert!(close(before.energy_j, after.energy_j, 1e-9), "{before:?} {after:?}");
    let drift = (before.momentum_kg_m_s - after.momentum_kg_m_s).length();
    assert!(drift <= 1e-12 * before.mass_kg * 10.0, "{before:?} {after:?}");
}

/// The changes tell someone who only follows them everything.
pub fn assert_followable(before: &Specimen, after: &Specimen, changes: &Changes) {
    let (old, new) = (&before.solid, &after.solid);
    let mut reference_m = old.reference_m().to_vec();
    assert_eq!(changes.first_node as usize, reference_m.len());
    for birth in &changes.new_nodes {
        reference_m.push(match *birth {
            NodeBirth::OnEdge { ends: [a, b], weight } => {
                reference_m[a as usize] * (1.0 - weight) + reference_m[b as usize] * weight
            }
            NodeBirth::TwinOf(node) => reference_m[node as usize],
        });
    }
    assert_eq!(reference_m, new.reference_m());
    assert_eq!(changes.new_elements.len(), new.tets().len() - old.tets().len());
    for element in before.elements().filter(|e| changes.changed_elements.binary_search(e).is_err()) {
        assert_eq!(old.tets()[element as usize], new.tets()[element as usize], "element {element}");
    }
    let untouched = |node: &u32| changes.touched_nodes.binary_search(node).is_err();
    for node in (0..new.node_count() as u32).filter(untouched) {
        assert_eq!(old.elements_at(node), new.elements_at(node), "node {node}");
    }
    let new_cracks: Vec<_> = new
        .surface()
        .filter(|f| matches!(f.kind, Face::Crack { pair, .. } if pair >= changes.first_crack_pair))
        .collect();
    let mut told = changes.crack_faces.clone();
    told.sort_by_key(|face| (face.element, face.face));
    assert_eq!(new_cracks, told);
}
