//! By how much features may have come nearer to each other, told cluster by cluster.
//!
//! One bound for a whole body says little about two features side by side: while a body bursts, its pieces fly apart at a
//! speed that nothing near to each other has. So surfaces are divided into clusters of neighbouring triangles. The
//! displacements of a cluster's nodes lie in a sphere; features of two clusters came nearer to each other by the distance of
//! the middles of their spheres and both radii at most. Displacements are measured, not reckoned from velocities, which the
//! response changes.

use super::candidates::Candidates;
use super::surface::ContactSurface;
use crate::math::in_parts;
use glam::DVec3;

/// Triangles of a cluster at most.
const CLUSTER_TRIANGLES: usize = 32;
/// Clusters whose ways one task looks at.
const CLUSTERS_AT_ONCE: usize = 256;
const NONE: u32 = u32::MAX;

/// The triangles of a surface in clusters of neighbours; pieces without a common node never share one.
#[derive(Clone, Debug, Default)]
pub(super) struct Clusters {
    of_triangle: Vec<u32>,
    of_node: Vec<u32>,
    of_edge: Vec<u32>,
    /// Triangles, cluster after cluster,
    order: Vec<u32>,
    /// and where each cluster begins there, with the end of the last.
    starts: Vec<u32>,
}

impl Clusters {
    /// Of a surface of which all but these is known.
    pub fn of(surface: &ContactSurface) -> Self {
        let count = surface.triangles.len();
        let mut neighbours = vec![[NONE; 3]; count];
        for edge in &surface.edges {
            let [a, b] = edge.triangles;
            for (own, other) in [(a, b), (b, a)] {
                if let Some(slot) = neighbours[own as usize].iter_mut().find(|slot| **slot == NONE) {
                    *slot = other;
                }
            }
        }
        let mut found = Self { of_triangle: vec![NONE; count], starts: vec![0], ..Self::default() };
        for seed in 0..count as u32 {
            if found.of_triangle[seed as usize] == NONE {
                found.grow_from(seed, &neighbours);
            }
        }
        found.of_node = vec![NONE; surface.node_size_m.len()];
        for (triangle, nodes) in surface.triangles.iter().enumerate() {
            for (node, _) in nodes.iter().zip(surface.owns_node[triangle]).filter(|(_, owns)| *owns) {
                found.of_node[*node as usize] = found.of_triangle[triangle];
            }
        }
        found.of_edge = surface.edges.iter().map(|e| found.of_triangle[e.triangles[0] as usize]).collect();
        found
    }

    /// A cluster of the triangles around one that belongs to none.
    fn grow_from(&mut self, seed: u32, neighbours: &[[u32; 3]]) {
        let cluster = self.starts.len() as u32 - 1;
        let first = self.order.len();
        self.order.push(seed);
        self.of_triangle[seed as usize] = cluster;
        let mut next = first;
        while next < self.order.len() {
            for neighbour in neighbours[self.order[next] as usize] {
                let is_free = neighbour != NONE && self.of_triangle[neighbour as usize] == NONE;
                if is_free && self.order.len() - first < CLUSTER_TRIANGLES {
                    self.of_triangle[neighbour as usize] = cluster;
                    self.order.push(neighbour);
                }
            }
            next += 1;
        }
        self.starts.push(self.order.len() as u32);
    }

    fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// All nodes of the triangles of a cluster, ascending.
    fn nodes_of(&self, cluster: u32, surface: &ContactSurface) -> Vec<u32> {
        let [from, to] = [cluster, cluster + 1].map(|c| self.starts[c as usize] as usize);
        let triangles = self.order[from..to].iter();
        let mut nodes: Vec<u32> = triangles.flat_map(|t| surface.triangles[*t as usize]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}

/// A sphere around displacements.
#[derive(Clone, Copy, Debug, Default)]
struct Sphere {
    middle_m: DVec3,
    radius_m: f64,
}

impl Sphere {
    fn around(displacements_m: impl Iterator<Item = DVec3> + Clone) -> Self {
        let bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = displacements_m.clone().fold(bounds, |(l, h), d| (l.min(d), h.max(d)));
        let middle_m = 0.5 * (low + high);
        let radius2 = displacements_m.map(|d| (d - middle_m).length_squared()).fold(0.0, f64::max);
        Self { middle_m, radius_m: radius2.sqrt() }
    }

    /// Largest difference between a displacement of this and one of another.
    fn way_m(&self, other: &Self) -> f64 {
        (self.middle_m - other.middle_m).length() + self.radius_m + other.radius_m
    }
}

/// The clusters of one body that some candidate needs.
#[derive(Clone, Debug, Default)]
struct Side {
    /// By cluster of the surface: its place here.
    place_of: Vec<u32>,
    /// Nodes, cluster after cluster,
    nodes: Vec<u32>,
    /// and where each cluster begins there, with the end of the last.
    starts: Vec<usize>,
    /// Where the nodes were at the last look, m.
    seen_at_m: Vec<DVec3>,
}

impl Side {
    fn of(surface: &ContactSurface) -> Self {
        Self { place_of: vec![NONE; surface.clusters.count()], starts: vec![0], ..Self::default() }
    }

    /// Place of a cluster, which is taken in if it is not there yet.
    fn place(&mut self, cluster: u32, surface: &ContactSurface, positions_m: &[DVec3]) -> u32 {
        let place = &mut self.place_of[cluster as usize];
        if *place == NONE {
            *place = self.starts.len() as u32 - 1;
            self.nodes.extend(surface.clusters.nodes_of(cluster, surface));
            let new = &self.nodes[self.seen_at_m.len()..];
            self.seen_at_m.extend(new.iter().map(|n| positions_m[*n as usize]));
            self.starts.push(self.nodes.len());
        }
        *place
    }

    /// Spheres of the values of the nodes of each cluster; `value` is given the place of the node and the node.
    fn spheres(&self, value: impl Fn(usize, usize) -> DVec3 + Sync) -> Vec<Sphere> {
        let ends = &self.starts[1..];
        in_parts::filter_map(ends, CLUSTERS_AT_ONCE, |cluster, end| {
            let values = (self.starts[cluster]..*end).map(|place| value(place, self.nodes[place] as usize));
            Some(Sphere::around(values))
        })
    }

    /// Displacements since the last look.
    fn look(&mut self, positions_m: &[DVec3]) -> Vec<Sphere> {
        let spheres = self.spheres(|place, node| positions_m[node] - self.seen_at_m[place]);
        for (seen, node) in self.seen_at_m.iter_mut().zip(&self.nodes) {
            *seen = positions_m[*node as usize];
        }
        spheres
    }
}

/// Two clusters with candidates between them.
#[derive(Clone, Debug)]
struct ClusterPair {
    places: [u32; 2],
    /// Way by which their features came nearer to each other until the last look, m.
    before_m: f64,
    /// The same in the step to come as far as velocities tell, m.
    ahead_m: f64,
}

/// Ways of a pair of bodies (or of one with itself) since the candidates between them were divided among clusters.
#[derive(Clone, Debug, Default)]
pub(super) struct Ways {
    /// Both bodies, or the one.
    sides: Vec<Side>,
    pairs: Vec<ClusterPair>,
    /// By candidate: the pair of clusters.
    pub of_node_on_second: Vec<u32>,
    pub of_node_on_first: Vec<u32>,
    pub of_edge_pair: Vec<u32>,
}

impl Ways {
    /// Of candidates between two surfaces (of one body, the same twice) with nodes at `positions_m`.
    pub fn of(
        all: &Candidates,
        surfaces: [&ContactSurface; 2],
        positions_m: [&[DVec3]; 2],
        is_own: bool,
    ) -> Self {
        let distinct = &surfaces[..if is_own { 1 } else { 2 }];
        let mut found = Self { sides: distinct.iter().map(|s| Side::of(s)).collect(), ..Self::default() };
        let mut known = KnownPairs::new();
        let mut pair_of = |[first, second]: [u32; 2]| {
            let sides = &mut found.sides;
            let a = sides[0].place(first, surfaces[0], positions_m[0]);
            let last = sides.len() - 1;
            let b = sides[last].place(second, surfaces[1], positions_m[1]);
            let places = if is_own { [a.min(b), a.max(b)] } else { [a, b] };
            known.number(places, || {
                found.pairs.push(ClusterPair { places, before_m: 0.0, ahead_m: 0.0 });
                found.pairs.len() as u32 - 1
            })
        };
        let [s, t] = surfaces.map(|surface| &surface.clusters);
        let of_node = |c: &Clusters, node: u32| c.of_node[node as usize];
        let of_triangle = |c: &Clusters, triangle: u32| c.of_triangle[triangle as usize];
        let of_edge = |c: &Clusters, edge: u32| c.of_edge[edge as usize];
        let on_second = all.node_on_second.iter().map(|(n, p)| [of_node(s, *n), of_triangle(t, *p)]);
        let on_second = on_second.map(&mut pair_of).collect();
        let on_first = all.node_on_first.iter().map(|(n, p)| [of_triangle(s, *p), of_node(t, *n)]);
        let on_first = on_first.map(&mut pair_of).collect();
        let edges = all.edge_pairs.iter().map(|(e, f)| [of_edge(s, *e), of_edge(t, *f)]);
        let edges = edges.map(&mut pair_of).collect();
        (found.of_node_on_second, found.of_node_on_first, found.of_edge_pair) = (on_second, on_first, edges);
        found
    }

    /// Whether these are divided as the candidates are.
    pub fn fit(&self, all: &Candidates) -> bool {
        let counts = [self.of_node_on_second.len(), self.of_node_on_first.len(), self.of_edge_pair.len()];
        counts == [all.node_on_second.len(), all.node_on_first.len(), all.edge_pairs.len()]
    }

    /// Takes note of where the nodes have got since the last look.
    pub fn look(&mut self, positions_m: [&[DVec3]; 2]) {
        let made: Vec<_> = self.sides.iter_mut().zip(positions_m).map(|(side, x)| side.look(x)).collect();
        for pair in &mut self.pairs {
            pair.before_m += pair.way_m(&made);
        }
    }

    /// Reckons with the velocities of a step to come.
    pub fn look_ahead(&mut self, velocities_m_s: [&[DVec3]; 2], step_s: f64) {
        let sides = self.sides.iter().zip(velocities_m_s);
        let ahead: Vec<_> = sides.map(|(side, v)| side.spheres(|_, node| v[node] * step_s)).collect();
        for pair in &mut self.pairs {
            pair.ahead_m = pair.way_m(&ahead);
        }
    }

    /// By pair of clusters: the way that its features have made until the last look, and the one in the step to come, m.
    pub fn of_pairs(&self) -> impl ExactSizeIterator<Item = (f64, f64)> + '_ {
        self.pairs.iter().map(|pair| (pair.before_m, pair.ahead_m))
    }

    /// The largest way of any pair of clusters in the step to come, m.
    pub fn most_ahead_m(&self) -> f64 {
        self.pairs.iter().map(|pair| pair.ahead_m).fold(0.0, f64::max)
    }

    /// By pair of clusters: the largest `value` (not below its default) of a node of the first and of the second, given the
    /// side and the node.
    pub fn most_of_nodes<T: Copy + Default + PartialOrd>(
        &self,
        value: impl Fn(usize, u32) -> T,
    ) -> impl Iterator<Item = [T; 2]> {
        let of_side = |(number, side): (usize, &Side)| -> Vec<T> {
            let most = |range: &[usize]| {
                let values = side.nodes[range[0]..range[1]].iter().map(|n| value(number, *n));
                values.fold(T::default(), |most, value| if value > most { value } else { most })
            };
            side.starts.windows(2).map(most).collect()
        };
        let most: Vec<_> = self.sides.iter().enumerate().map(of_side).collect();
        self.pairs.iter().map(move |pair| {
            let [first, second] = pair.places.map(|place| place as usize);
            [most[0][first], most[most.len() - 1][second]]
        })
    }
}

/// Numbers of pairs of clusters while they are counted.
struct KnownPairs {
    /// By place of the first cluster: places of second ones and the numbers of the pairs.
    of_first: Vec<Vec<(u32, u32)>>,
    /// What was asked for lately, by a few bits of both places: candidates of the same clusters come together.
    lately: Vec<([u32; 2], u32)>,
}

impl KnownPairs {
    const LATELY: usize = 1 << 12;

    fn new() -> Self {
        Self { of_first: Vec::new(), lately: vec![([NONE; 2], NONE); Self::LATELY] }
    }

    fn number(&mut self, places: [u32; 2], new: impl FnOnce() -> u32) -> u32 {
        let [first, second] = places;
        let slot = &mut self.lately[(first.wrapping_mul(61) ^ second) as usize % Self::LATELY];
        if slot.0 == places {
            return slot.1;
        }
        if self.of_first.len() <= first as usize {
            self.of_first.resize(first as usize + 1, Vec::new());
        }
        let of_first = &mut self.of_first[first as usize];
        let known = of_first.iter().find(|(other, _)| *other == second).map(|(_, pair)| *pair);
        let pair = known.unwrap_or_else(|| {
            let pair = new();
            of_first.push((second, pair));
            pair
        });
        *slot = (places, pair);
        pair
    }
}

impl ClusterPair {
    fn way_m(&self, spheres: &[Vec<Sphere>]) -> f64 {
        let [first, second] = self.places.map(|place| place as usize);
        spheres[0][first].way_m(&spheres[spheres.len() - 1][second])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Surface;
    use crate::mesh::shapes::block;

    /// The surface of a box and its nodes.
    fn surface_of_block() -> (ContactSurface, Vec<DVec3>) {
        let mesh = block([4, 3, 2]);
        (ContactSurface::new(&Surface::of(&mesh.tets), &mesh.nodes_m), mesh.nodes_m)
    }

    #[test]
    fn every_feature_lies_in_its_cluster() {
        let (surface, _) = surface_of_block();
        let clusters = &surface.clusters;
        assert!(clusters.count() > 2);
        let mut triangles = clusters.order.clone();
        triangles.sort_unstable();
        assert!(triangles.into_iter().eq(0..surface.triangles.len() as u32));
        let nodes: Vec<_> = (0..clusters.count() as u32).map(|c| clusters.nodes_of(c, &surface)).collect();
        let holds = |cluster: u32, of: &[u32]| of.iter().all(|n| nodes[cluster as usize].contains(n));
        for (triangle, corners) in surface.triangles.iter().enumerate() {
            assert!(holds(clusters.of_triangle[triangle], corners));
        }
        for (edge, cluster) in surface.edges.iter().zip(&clusters.of_edge) {
            assert!(holds(*cluster, &edge.nodes));
        }
        for node in &surface.nodes {
            assert!(holds(clusters.of_node[*node as usize], &[*node]));
        }
    }

    #[test]
    fn no_feature_makes_a_longer_way_than_its_clusters() {
        let (surface, mut x) = surface_of_block();
        let y: Vec<DVec3> = x.iter().map(|x| *x + DVec3::new(0.3, 0.2, 2.1)).collect();
        let mut all = Candidates::default();
        for triangle in 0..surface.triangles.len() as u32 {
            all.node_on_second.extend(surface.nodes.iter().step_by(7).map(|node| (*node, triangle)));
        }
        all.edge_pairs = (0..surface.edges.len() as u32).step_by(3).map(|e| (e, 5)).collect();
        let mut ways = Ways::of(&all, [&surface; 2], [&x, &y], false);
        assert!(ways.fit(&all) && !ways.fit(&Candidates::default()));
        let mut made_m = vec![0.0; all.node_on_second.len()];
        for step in 0..5 {
            let moves = |n: usize| {
                let at = f64::from(step * 100 + n as i32);
                DVec3::new((3.1 * at).sin(), (1.7 * at).cos(), (0.6 * at * at).sin()) * 0.01
            };
            let velocities: Vec<DVec3> = (0..x.len()).map(moves).collect();
            ways.look_ahead([&velocities, &vec![DVec3::ZERO; y.len()]], 1.0);
            let ahead: Vec<f64> = ways.of_pairs().map(|(_, ahead_m)| ahead_m).collect();
            x.iter_mut().zip(&velocities).for_each(|(x, v)| *x += *v);
            ways.look([&x, &y]);
            let before: Vec<f64> = ways.of_pairs().map(|(before_m, _)| before_m).collect();
            for (place, (node, _)) in all.node_on_second.iter().enumerate() {
                let (pair, way_m) =
                    (ways.of_node_on_second[place] as usize, velocities[*node as usize].length());
                made_m[place] += way_m;
                assert!(
                    way_m <= ahead[pair] * (1.0 + 1e-12) && made_m[place] <= before[pair] * (1.0 + 1e-12)
                );
            }
        }
        assert!(ways.most_ahead_m() < 0.1);
        // A body that moves on as a whole brings nothing nearer to anything of it.
        let mut own = Ways::of(&all, [&surface; 2], [&x; 2], true);
        x.iter_mut().for_each(|x| *x += DVec3::new(7.0, -3.0, 2.0));
        own.look([&x; 2]);
        assert!(own.of_pairs().all(|(before_m, _)| before_m < 1e-12));
    }
}
