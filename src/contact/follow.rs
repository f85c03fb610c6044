//! Following cuts: candidates of what was not affected stay, under their present numbers; around the cut they are searched.

use super::boxes::SurfaceBoxes;
use super::candidates::{Boxed, Candidates, OwnSearch, between_triangles, found_in_parts};
use super::own::OwnFeatures;
use super::surface::ContactSurface;
use crate::math::in_parts;
use crate::mesh::Renumbering;

/// For every entry of some candidates, the entry of those before a cut that it was; `None` for new ones.
#[derive(Clone, Debug, Default)]
pub(super) struct Origins {
    pub node_on_second: Vec<Option<u32>>,
    pub node_on_first: Vec<Option<u32>>,
    pub edge_pairs: Vec<Option<u32>>,
}

/// What a cut did to the surfaces of a pair of bodies; of a body with itself the same twice.
type OfPair<'a> = [Option<&'a Renumbering>; 2];

impl Candidates {
    /// These after a cut of one of two bodies, by `numbers` of it; its boxes have followed.
    pub(super) fn follow_between(&self, first: Boxed, second: Boxed, numbers: OfPair) -> (Self, Origins) {
        let mut pairs = Vec::new();
        if let Some(cut) = numbers[0] {
            let near = |t: &u32| second.1.overlapping(*first.1.of_triangle(*t));
            pairs.extend(cut.affected_triangles().iter().flat_map(|t| near(t).map(|u| (*t, u))));
        }
        if let Some(cut) = numbers[1] {
            let near = |t: &u32| first.1.overlapping(*second.1.of_triangle(*t));
            pairs.extend(cut.affected_triangles().iter().flat_map(|t| near(t).map(|u| (u, *t))));
        }
        let found = between_triangles(first, second, &pairs, false);
        self.with_new(found.only_affected([first.0, second.0], numbers), numbers, false)
    }

    /// These of a body with itself after it was cut, without what is known of twins; its boxes have followed.
    pub(super) fn follow_within(
        &self,
        own: &OwnFeatures,
        boxes: &SurfaceBoxes,
        numbers: &Renumbering,
    ) -> (Self, Origins) {
        let affected = numbers.affected_triangles();
        let is_first = |t: u32, u: u32| u > t || (u < t && affected.binary_search(&u).is_err());
        let near = |t: u32| boxes.overlapping(*boxes.of_triangle(t)).filter(move |u| is_first(t, *u));
        let search = OwnSearch::new(own, boxes);
        let of_both = [Some(numbers); 2];
        let found = found_in_parts(affected, AFFECTED_AT_ONCE, |part| {
            let pairs: Vec<(u32, u32)> = part.iter().flat_map(|t| near(*t).map(|u| (*t, u))).collect();
            search.of_pairs(&pairs).only_affected([own.surface; 2], of_both)
        });
        self.with_new(found, of_both, true)
    }

    /// Those of which a feature is affected.
    fn only_affected(mut self, surfaces: [&ContactSurface; 2], numbers: OfPair) -> Self {
        let node = |side: usize, n: u32| numbers[side].is_some_and(|cut| cut.is_affected(n));
        let triangle =
            |side: usize, t: u32| surfaces[side].triangles[t as usize].iter().any(|n| node(side, *n));
        let edge =
            |side: usize, e: u32| surfaces[side].edges[e as usize].nodes.iter().any(|n| node(side, *n));
        self.node_on_second.retain(|(n, t)| node(0, *n) || triangle(1, *t));
        self.node_on_first.retain(|(n, t)| node(1, *n) || triangle(0, *t));
        self.edge_pairs.retain(|(e, f)| edge(0, *e) || edge(1, *f));
        self
    }

    /// Those without affected features, under their present numbers, and the new ones.
    fn with_new(&self, new: Self, numbers: OfPair, is_own: bool) -> (Self, Origins) {
        let node = |side: usize, n: u32| numbers[side].is_none_or(|cut| !cut.is_affected(n)).then_some(n);
        let triangle =
            |side: usize, t: u32| numbers[side].map_or(Some(t), |cut| cut.unaffected_triangle_now(t));
        let edge = |side: usize, e: u32| numbers[side].map_or(Some(e), |cut| cut.unaffected_edge_now(e));
        let merged = |mut all: Vec<((u32, u32), Option<u32>)>, new: Vec<(u32, u32)>| {
            all.extend(new.into_iter().map(|entry| (entry, None)));
            // Two runs that are sorted by themselves, or nearly so: the stable sort sees that and merges them.
            all.sort();
            all.into_iter().unzip()
        };
        let nodes = |old: &[(u32, u32)], new: Vec<(u32, u32)>, own: usize| {
            merged(kept(old, |(n, t)| Some((node(own, n)?, triangle(1 - own, t)?))), new)
        };
        let edges = |(e, f)| {
            let (e, f) = (edge(0, e)?, edge(1, f)?);
            Some(if is_own { (e.min(f), e.max(f)) } else { (e, f) })
        };
        let ((node_on_second, from_second), (edge_pairs, from_edges)) = in_parts::both(
            self.count(),
            || nodes(&self.node_on_second, new.node_on_second, 0),
            || merged(kept(&self.edge_pairs, edges), new.edge_pairs),
        );
        let (node_on_first, from_first) = nodes(&self.node_on_first, new.node_on_first, 1);
        let origins =
            Origins { node_on_second: from_second, node_on_first: from_first, edge_pairs: from_edges };
        (Self { node_on_second, node_on_first, edge_pairs, ..Self::default() }, origins)
    }
}

/// Affected triangles around which one task looks.
const AFFECTED_AT_ONCE: usize = 128;

/// The entries that stay, with their old places.
fn kept(
    old: &[(u32, u32)],
    now: impl Fn((u32, u32)) -> Option<(u32, u32)>,
) -> Vec<((u32, u32), Option<u32>)> {
    (0_u32..).zip(old).filter_map(|(place, entry)| Some((now(*entry)?, Some(place)))).collect()
}
