//! Which elements are computed together: neighbours in space, in chunks of fixed size.
//!
//! A chunk reads each of its nodes once and adds its forces up in a buffer that stays in the fastest
//! cache. Chunks depend on the mesh alone, never on the number of threads, so neither do results.

use glam::DVec3;

/// Elements in a chunk. Smaller chunks share more nodes with each other (half the size costs 4 %),
/// larger ones leave less to share among threads in small bodies and gain nothing.
pub(super) const CHUNK_ELEMENTS: usize = 512;
/// Nodes in a chunk at most: a power of two, so that a masked index needs no bounds check.
pub(super) const CHUNK_NODES: usize = 512;

/// A set of elements and the nodes they touch.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ChunkLayout {
    /// Elements, in the order they are computed.
    pub elements: Vec<u32>,
    /// Nodes touched, ascending.
    pub nodes: Vec<u32>,
}

/// Cuts the elements into chunks of at most [`CHUNK_ELEMENTS`] and [`CHUNK_NODES`], along a
/// space-filling curve through their centres.
pub(super) fn partition(nodes_m: &[DVec3], tets: &[[u32; 4]]) -> Vec<ChunkLayout> {
    let mut chunks = Vec::new();
    let mut chunk = ChunkLayout::default();
    // The last chunk that touched each node, counted from 1.
    let mut touched_by = vec![0_u32; nodes_m.len()];
    let all: Vec<u32> = (0..tets.len() as u32).collect();
    for element in curve_order(nodes_m, tets, &all) {
        let tet = &tets[element as usize];
        if chunk.elements.len() == CHUNK_ELEMENTS || chunk.nodes.len() + 4 > CHUNK_NODES {
            chunks.push(std::mem::take(&mut chunk));
        }
        let stamp = chunks.len() as u32 + 1;
        for &node in tet {
            if std::mem::replace(&mut touched_by[node as usize], stamp) != stamp {
                chunk.nodes.push(node);
            }
        }
        chunk.elements.push(element);
    }
    if !chunk.elements.is_empty() {
        chunks.push(chunk);
    }
    for chunk in &mut chunks {
        chunk.nodes.sort_unstable();
    }
    chunks
}

/// The same for some of the elements, which fill one chunk or a little more: as few chunks of about equal size as will do.
pub(super) fn layouts_of(nodes_m: &[DVec3], tets: &[[u32; 4]], elements: Vec<u32>) -> Vec<ChunkLayout> {
    let mut nodes: Vec<u32> = elements.iter().flat_map(|&e| tets[e as usize]).collect();
    nodes.sort_unstable();
    nodes.dedup();
    if elements.len() <= CHUNK_ELEMENTS && nodes.len() <= CHUNK_NODES {
        return vec![ChunkLayout { elements, nodes }];
    }
    let order = curve_order(nodes_m, tets, &elements);
    let halves = order.split_at(order.len() / 2);
    [halves.0, halves.1].into_iter().flat_map(|half| layouts_of(nodes_m, tets, half.to_vec())).collect()
}

/// Elements along the Morton curve of their centres; ties in their own order.
fn curve_order(nodes_m: &[DVec3], tets: &[[u32; 4]], elements: &[u32]) -> Vec<u32> {
    let centre =
        |element: &u32| -> DVec3 { tets[*element as usize].iter().map(|&n| nodes_m[n as usize]).sum() };
    let bounds = elements
        .iter()
        .map(centre)
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let side = (bounds.1 - bounds.0).max_element().max(f64::MIN_POSITIVE);
    let mut keys: Vec<(u64, u32)> =
        elements.iter().map(|element| (morton_code((centre(element) - bounds.0) / side), *element)).collect();
    keys.sort_unstable();
    keys.into_iter().map(|(_, element)| element).collect()
}

/// Interleaved bits of a place in the unit cube, 21 bits an axis.
fn morton_code(place: DVec3) -> u64 {
    let spread = |x: f64| {
        let mut bits = (x * f64::from((1 << 21) - 1)) as u64 & 0x1f_ffff;
        bits = (bits | bits << 32) & 0x001f_0000_0000_ffff;
        bits = (bits | bits << 16) & 0x001f_0000_ff00_00ff;
        bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
        bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
        (bits | bits << 2) & 0x1249_2492_4924_9249
    };
    spread(place.x) | spread(place.y) << 1 | spread(place.z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::test_support::box_mesh;

    #[test]
    fn every_element_is_in_exactly_one_chunk_within_limits() {
        let mesh = box_mesh([13, 11, 9], 0.1);
        let chunks = partition(&mesh.nodes_m, &mesh.tets);
        let mut seen: Vec<u32> = chunks.iter().flat_map(|c| c.elements.clone()).collect();
        seen.sort_unstable();
        assert_eq!(seen, (0..mesh.tets.len() as u32).collect::<Vec<_>>());
        for chunk in &chunks {
            assert!(chunk.elements.len() <= CHUNK_ELEMENTS && chunk.nodes.len() <= CHUNK_NODES);
            let mut nodes: Vec<u32> = chunk.elements.iter().flat_map(|&e| mesh.tets[e as usize]).collect();
            nodes.sort_unstable();
            nodes.dedup();
            assert_eq!(nodes, chunk.nodes);
        }
    }

    #[test]
    fn chunks_are_compact() {
        let mesh = box_mesh([16, 16, 16], 0.0);
        let chunks = partition(&mesh.nodes_m, &mesh.tets);
        let shared: usize = chunks.iter().map(|c| c.nodes.len()).sum();
        assert!(shared < 3 * mesh.nodes_m.len(), "{shared} of {}", mesh.nodes_m.len());
    }

    #[test]
    fn elements_without_common_nodes_do_not_overflow_a_chunk() {
        let nodes: Vec<DVec3> = (0..4 * 300).map(|i| DVec3::splat(f64::from(i))).collect();
        let tets: Vec<[u32; 4]> = (0..300).map(|i| [0, 1, 2, 3].map(|c| 4 * i + c)).collect();
        assert!(partition(&nodes, &tets).iter().all(|c| c.nodes.len() <= CHUNK_NODES));
    }

    #[test]
    fn morton_code_interleaves() {
        assert_eq!(morton_code(DVec3::ZERO), 0);
        assert_eq!(morton_code(DVec3::ONE), (1 << 63) - 1);
        assert_eq!(morton_code(DVec3::new(1.0 / 2097151.0, 0.0, 0.0)), 1);
        assert_eq!(morton_code(DVec3::new(0.0, 0.0, 2.0 / 2097151.0)), 1 << 5);
    }
}
