//! Cutting the elements around one node by a plane through it: geometry first, topology second.
//!
//! 1. Nodes around it that lie nearly on the plane count as on it; so do those of a surface that
//!    runs nearly along the plane, and those of the crack that ends at the node.
//! 2. Every edge opposite the node that still crosses the plane is bisected there, or, where that
//!    would leave too small an element, snapped: its nearer end counts as on the plane.
//! 3. The elements are now above or below; faces between the two kinds crack.
//! 4. Fragments are told apart, and nodes that nothing holds together any more are doubled.

use super::changes::NodeCut;
use super::propagate::Surgery;
use super::solid::{Face, SurfaceFace};
use glam::DVec3;

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
    /// Where the crack that ends at the node points, unit vector in the plane; the plane is cut
    /// only on that side. `None`: no crack yet, cut all around.
    ahead: Option<DVec3>,
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
    /// Cuts the elements around `node` by the plane through it.
    pub(super) fn cut_node(&mut self, node: u32, normal: DVec3) {
        let mut star = self.star(node, normal);
        self.snap_near(&mut star);
        let mut loose = self.bisect_crossings(&mut star);
        let wanted = self.faces_between(&star);
        let cracked = self.crack(wanted);
        for face in &cracked {
            loose.extend(self.solid.face_nodes(face.above.0, face.above.1));
        }
        let cut = NodeCut {
            node,
            position_m: self.nodes.positions_m[node as usize],
            normal,
            reach_m: self.reach_m(&star),
            elements: self.solid.node_elements[node as usize].clone(),
            cracked_faces: cracked.len(),
        };
        for &element in &cut.elements {
            self.mark_touched(element);
        }
        self.changes.cuts.push(cut);
        loose.sort_unstable();
        loose.dedup();
        for node in loose {
            self.separate(node);
        }
    }

    fn star(&self, node: u32, normal: DVec3) -> Star {
        let elements = self.solid.elements_at(node);
        let corners = elements.iter().flat_map(|&element| self.solid.tets[element as usize]);
        let mut nodes: Vec<u32> = corners.filter(|&corner| corner != node).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let at_m = self.nodes.positions_m[node as usize];
        let link = nodes
            .into_iter()
            .map(|node| {
                let distance_m = (self.nodes.positions_m[node as usize] - at_m).dot(normal);
                LinkNode { node, distance_m, snapped_m: distance_m }
            })
            .collect();
        Star { node, normal, link, ahead: None }
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
        let faces: Vec<SurfaceFace> = self.solid.surface_at(star.node).collect();
        let mut behind_m = DVec3::ZERO;
        for face in &faces {
            let others: Vec<u32> = face.nodes.into_iter().filter(|&corner| corner != star.node).collect();
            let arm_m = |corner: u32| self.nodes.positions_m[corner as usize] - at_m;
            let runs_along = |&corner: &u32| star.distance_m(corner).abs() <= sin * arm_m(corner).length();
            let is_tip = ends_here(face, &faces);
            if is_tip {
                behind_m += others.iter().copied().map(arm_m).sum::<DVec3>();
            }
            if is_tip || others.iter().all(runs_along) {
                others.into_iter().for_each(|corner| star.snap(corner));
            }
        }
        let in_plane_m = -behind_m.reject_from_normalized(star.normal);
        if in_plane_m.length() > 0.5 * behind_m.length() {
            star.ahead = in_plane_m.try_normalize();
        }
    }

    fn is_ahead(&self, star: &Star, position_m: DVec3) -> bool {
        let arm_m = position_m - self.nodes.positions_m[star.node as usize];
        star.ahead.is_none_or(|ahead| arm_m.dot(ahead) >= 0.0)
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
        let above: Vec<bool> = elements.iter().map(|&element| self.is_above(star, element)).collect();
        let mut found = Vec::new();
        for (&element, _) in elements.iter().zip(&above).filter(|(_, above)| **above) {
            for (face, behind) in self.solid.faces[element as usize].iter().enumerate() {
                let Face::Inner(neighbour) = *behind else { continue };
                let Ok(place) = elements.binary_search(&neighbour) else { continue };
                if above[place] || !self.is_ahead(star, self.face_centre_m(element, face)) {
                    continue;
                }
                let faces = &self.solid.faces[neighbour as usize];
                if let Some(opposite) = faces.iter().position(|&back| back == Face::Inner(element)) {
                    found.push(CrackedFace { above: (element, face), below: (neighbour, opposite) });
                }
            }
        }
        found
    }

    fn face_centre_m(&self, element: u32, face: usize) -> DVec3 {
        let nodes = self.solid.face_nodes(element, face);
        nodes.into_iter().map(|node| self.nodes.positions_m[node as usize]).sum::<DVec3>() / 3.0
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

/// Whether both sides of the crack that `face` belongs to still meet here: its tip.
fn ends_here(face: &SurfaceFace, faces: &[SurfaceFace]) -> bool {
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
