//! Cutting the elements around one node by a plane through it: geometry first, topology second.
//!
//! 1. Nodes around it that lie nearly on the plane count as on it; so do those of a surface that
//!    runs nearly along the plane, those of the crack that ends at the node, and tips of cracks
//!    beside it.
//! 2. Every edge opposite the node that still crosses the plane, where no crack covers it already,
//!    is bisected there, or, where that would leave too small an element, snapped: its nearer end
//!    counts as on the plane.
//! 3. The elements are now above or below, those behind the tip of a crack by its own sides; faces
//!    between the two kinds crack.
//! 4. Fragments are told apart, and nodes that nothing holds together any more are doubled.

use super::changes::NodeCut;
use super::propagate::{Surgery, sort_and_dedup};
use super::solid::{Face, SurfaceFace, area_vector_m2};
use glam::DVec3;

/// Least share of each arm in a direction between them; leaves out the arms themselves.
const BETWEEN: f64 = 1e-6;

/// A crack that ends at a neighbouring node is joined if that node lies off the plane by no more
/// than this share of its distance.
const JOIN: f64 = 0.7;

/// A crack face tells the side of its element if the cosine of its slope to the plane exceeds this.
const CLEAR_SIDE: f64 = 0.25;

/// A node opposite the one that is cut.
#[derive(Clone, Copy, Debug)]
struct LinkNode {
    node: u32,
    /// From the cutting plane, along its normal, m.
    distance_m: f64,
    /// The same, or zero if it counts as lying on the plane.
    snapped_m: f64,
}

/// The surroundings of a node that is cut. Nodes that are not listed came later, on the plane.
pub(super) struct Star {
    node: u32,
    normal: DVec3,
    /// Ascending by node.
    link: Vec<LinkNode>,
    /// Faces of the crack that ends at the node: the arms to their other two corners, m. Where
    /// they lie over the plane it is cut already; a second cut there would only part a flake.
    cracked_arms_m: Vec<[DVec3; 2]>,
    /// The pairs of these faces.
    tip_pairs: Vec<u32>,
}

/// A face that is to crack: the element above and its face, the one below and its.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CrackedFace {
    pub above: (u32, usize),
    pub below: (u32, usize),
}

/// An edge opposite the node whose ends lie on different sides.
struct Crossing {
    ends: [u32; 2],
    /// Of the second end where the plane crosses, at the current position.
    weight: f64,
}

impl Surgery<'_> {
    /// Cuts the elements around `node` by the plane through it; says whether anything cracked.
    pub(super) fn cut_node(&mut self, node: u32, normal: DVec3) -> bool {
        let mut star = self.star(node, normal);
        self.snap_near(&mut star);
        let mut loose = self.bisect_crossings(&mut star);
        let wanted = self.faces_between(&star);
        let cracked = self.crack(node, wanted);
        for face in &cracked {
            loose.extend(self.solid.face_nodes(face.above.0, face.above.1));
        }
        if !cracked.is_empty() {
            self.record_cut(&star, cracked.len());
        }
        sort_and_dedup(&mut loose);
        for node in loose {
            self.separate(node);
        }
        !cracked.is_empty()
    }

    /// Notes a cut, before nodes are doubled. One that opened nothing is none: it must not keep
    /// the nodes around it from being cut.
    fn record_cut(&mut self, star: &Star, cracked_faces: usize) {
        for element in self.solid.elements_at(star.node).to_vec() {
            self.mark_touched(element);
        }
        let cut = NodeCut {
            node: star.node,
            position_m: self.nodes.positions_m[star.node as usize],
            normal: star.normal,
            reach_m: self.reach_m(star),
            elements: self.two_rings(star.node),
            cracked_faces,
        };
        self.changes.cuts.push(cut);
    }

    fn star(&self, node: u32, normal: DVec3) -> Star {
        let elements = self.solid.elements_at(node);
        let corners = elements.iter().flat_map(|&element| self.solid.tets[element as usize]);
        let mut nodes: Vec<u32> = corners.filter(|&corner| corner != node).collect();
        sort_and_dedup(&mut nodes);
        let at_m = self.nodes.positions_m[node as usize];
        let link = nodes
            .into_iter()
            .map(|node| {
                let distance_m = (self.nodes.positions_m[node as usize] - at_m).dot(normal);
                LinkNode { node, distance_m, snapped_m: distance_m }
            })
            .collect();
        Star { node, normal, link, cracked_arms_m: Vec::new(), tip_pairs: Vec::new() }
    }

    /// The elements at a node and those that share a node with one of them, ascending.
    fn two_rings(&self, node: u32) -> Vec<u32> {
        let solid = &self.solid;
        let corners = solid.elements_at(node).iter().flat_map(|&element| solid.tets[element as usize]);
        let mut nodes: Vec<u32> = corners.collect();
        sort_and_dedup(&mut nodes);
        let mut elements: Vec<u32> =
            nodes.iter().flat_map(|&node| solid.elements_at(node)).copied().collect();
        sort_and_dedup(&mut elements);
        elements
    }

    fn reach_m(&self, star: &Star) -> f64 {
        let at_m = self.nodes.positions_m[star.node as usize];
        let distances = star.link.iter().map(|n| (self.nodes.positions_m[n.node as usize] - at_m).length());
        distances.sum::<f64>() / star.link.len().max(1) as f64
    }

    /// Step 1.
    fn snap_near(&self, star: &mut Star) {
        for link in &mut star.link {
            // No element could be cut off there without falling below the floor.
            if link.distance_m.abs() < self.solid.altitude_floor_m {
                link.snapped_m = 0.0;
            }
        }
        let at_m = self.nodes.positions_m[star.node as usize];
        let sin = self.settings.surface_snap_rad.sin();
        for link in &mut star.link {
            // Cracks beside each other join rather than run on abreast.
            let arm_m = self.nodes.positions_m[link.node as usize] - at_m;
            if link.distance_m.abs() <= JOIN * arm_m.length() && self.solid.is_tip(link.node) {
                link.snapped_m = 0.0;
            }
        }
        let faces: Vec<SurfaceFace> = self.solid.surface_at(star.node).collect();
        for face in &faces {
            let mut others: Vec<u32> = face.nodes.into_iter().filter(|&corner| corner != star.node).collect();
            others.sort_unstable();
            let arm_m = |corner: u32| self.nodes.positions_m[corner as usize] - at_m;
            let is_near = |&corner: &u32| star.distance_m(corner).abs() <= sin * arm_m(corner).length();
            let runs_along = others.iter().all(is_near);
            let is_tip = ends_here(face, &faces);
            if let (true, [p, q]) = (is_tip, others.as_slice()) {
                star.cracked_arms_m.push([arm_m(*p), arm_m(*q)]);
                star.tip_pairs.extend(pair_of(face));
            }
            if is_tip || runs_along {
                others.into_iter().for_each(|corner| star.snap(corner));
            }
        }
    }

    /// Whether the crack that ends at the node does not cover this place of the plane.
    fn is_ahead(&self, star: &Star, position_m: DVec3) -> bool {
        let arm_m = position_m - self.nodes.positions_m[star.node as usize];
        !star.cracked_arms_m.iter().any(|arms_m| is_between(arm_m, arms_m, star.normal))
    }

    /// Step 2; returns the new nodes.
    fn bisect_crossings(&mut self, star: &mut Star) -> Vec<u32> {
        let mut crossings = self.crossings(star);
        let off_middle = |crossing: &Crossing| (crossing.weight - 0.5).abs();
        crossings.sort_by(|a, b| off_middle(a).total_cmp(&off_middle(b)).then(a.ends.cmp(&b.ends)));
        let mut new_nodes = Vec::new();
        for Crossing { ends, weight } in crossings {
            if star.side(ends[0]) * star.side(ends[1]) >= 0.0 {
                continue;
            }
            if self.may_bisect(ends, weight) {
                new_nodes.push(self.bisect(ends, weight));
            } else {
                let [a, b] = ends.map(|end| star.distance_m(end).abs());
                star.snap(if a <= b { ends[0] } else { ends[1] });
            }
        }
        new_nodes
    }

    fn may_bisect(&mut self, ends: [u32; 2], weight: f64) -> bool {
        if self.altitude_after_m(ends, weight) < self.solid.altitude_floor_m {
            return false;
        }
        let elements = self.solid.tets.len() + self.ring(ends).len();
        if elements > self.settings.limits.max_elements {
            self.changes.limits.elements += 1;
            return false;
        }
        true
    }

    fn crossings(&self, star: &Star) -> Vec<Crossing> {
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for &element in self.solid.elements_at(star.node) {
            let tet = self.solid.tets[element as usize];
            let mut link = tet.into_iter().filter(|&corner| corner != star.node);
            if let (Some(a), Some(b), Some(c)) = (link.next(), link.next(), link.next()) {
                edges.extend([[a, b], [b, c], [a, c]].map(|[p, q]| [p.min(q), p.max(q)]));
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let crossing = |ends: [u32; 2]| {
            let [a, b] = ends.map(|end| star.side(end));
            let weight = a / (a - b);
            let [x, y] = ends.map(|end| self.nodes.positions_m[end as usize]);
            let crosses = a * b < 0.0 && self.is_ahead(star, x.lerp(y, weight));
            crosses.then_some(Crossing { ends, weight })
        };
        edges.into_iter().filter_map(crossing).collect()
    }

    /// Step 3: the faces between elements above and below the plane, by element.
    fn faces_between(&self, star: &Star) -> Vec<CrackedFace> {
        let elements = self.solid.elements_at(star.node);
        let above = self.sides(star, elements);
        let mut found = Vec::new();
        for (&element, _) in elements.iter().zip(&above).filter(|(_, above)| **above) {
            for (face, behind) in self.solid.faces[element as usize].iter().enumerate() {
                let Face::Inner(neighbour) = *behind else { continue };
                let Ok(place) = elements.binary_search(&neighbour) else { continue };
                let faces = &self.solid.faces[neighbour as usize];
                let opposite = faces.iter().position(|&back| back == Face::Inner(element));
                if let (false, Some(opposite)) = (above[place], opposite) {
                    found.push(CrackedFace { above: (element, face), below: (neighbour, opposite) });
                }
            }
        }
        found
    }

    /// Whether each element around the node is above the plane. Along the crack that ends here its
    /// own sides count, so that it goes on where it ended.
    fn sides(&self, star: &Star, elements: &[u32]) -> Vec<bool> {
        let mut sides: Vec<Option<bool>> =
            elements.iter().map(|&element| self.side_by_crack(star, element)).collect();
        let mut known: Vec<usize> = (0..elements.len()).filter(|&place| sides[place].is_some()).collect();
        let mut next = 0;
        while let Some(&place) = known.get(next) {
            next += 1;
            for face in self.solid.faces[elements[place] as usize] {
                let Face::Inner(neighbour) = face else { continue };
                let Ok(other) = elements.binary_search(&neighbour) else { continue };
                if sides[other].is_none() && !self.is_ahead(star, self.centroid_m(neighbour)) {
                    sides[other] = sides[place];
                    known.push(other);
                }
            }
        }
        let by_plane =
            |(side, &element): (&Option<bool>, &u32)| side.unwrap_or_else(|| self.is_above(star, element));
        sides.iter().zip(elements).map(by_plane).collect()
    }

    /// The side of an element that touches the crack which ends at the node: its crack face looks
    /// down from above.
    fn side_by_crack(&self, star: &Star, element: u32) -> Option<bool> {
        let mut sum_m2 = DVec3::ZERO;
        for face in self.solid.surface_of(element) {
            if star
                .tip_pairs
                .iter()
                .any(|&pair| matches!(face.kind, Face::Crack { pair: p, .. } if p == pair))
            {
                sum_m2 += area_vector_m2(face.nodes, self.nodes.positions_m);
            }
        }
        let along = sum_m2.dot(star.normal);
        (along.abs() > CLEAR_SIDE * sum_m2.length()).then_some(along < 0.0)
    }

    fn centroid_m(&self, element: u32) -> DVec3 {
        let corners = self.solid.tets[element as usize];
        corners.into_iter().map(|node| self.nodes.positions_m[node as usize]).sum::<DVec3>() / 4.0
    }

    /// By its corners; where they do not agree, or all count as on the plane, by its centroid.
    fn is_above(&self, star: &Star, element: u32) -> bool {
        let corners = self.solid.tets[element as usize];
        let sides = corners.map(|corner| star.side(corner));
        let (has_above, has_below) = (sides.iter().any(|x| *x > 0.0), sides.iter().any(|x| *x < 0.0));
        if has_above != has_below {
            return has_above;
        }
        corners.iter().map(|&corner| star.distance_m(corner)).sum::<f64>() >= 0.0
    }
}

/// Whether an arm points between two others, all seen along the normal.
fn is_between(arm_m: DVec3, [first_m, second_m]: &[DVec3; 2], normal: DVec3) -> bool {
    let turn = |a: DVec3, b: DVec3| a.cross(b).dot(normal);
    let whole = turn(*first_m, *second_m);
    let [first, second] = [turn(arm_m, *second_m) / whole, turn(*first_m, arm_m) / whole];
    first > BETWEEN && second > BETWEEN
}

fn pair_of(face: &SurfaceFace) -> Option<u32> {
    if let Face::Crack { pair, .. } = face.kind { Some(pair) } else { None }
}

/// Whether both sides of the crack that `face` belongs to still meet here: its tip.
pub(super) fn ends_here(face: &SurfaceFace, faces: &[SurfaceFace]) -> bool {
    let Face::Crack { pair, above } = face.kind else { return false };
    faces.iter().any(|other| other.kind == Face::Crack { pair, above: !above })
}

impl Star {
    fn find(&self, node: u32) -> Option<usize> {
        self.link.binary_search_by_key(&node, |link| link.node).ok()
    }

    fn distance_m(&self, node: u32) -> f64 {
        self.find(node).map_or(0.0, |place| self.link[place].distance_m)
    }

    /// Positive above, negative below, zero on the plane.
    fn side(&self, node: u32) -> f64 {
        self.find(node).map_or(0.0, |place| self.link[place].snapped_m)
    }

    fn snap(&mut self, node: u32) {
        if let Some(place) = self.find(node) {
            self.link[place].snapped_m = 0.0;
        }
    }
}
