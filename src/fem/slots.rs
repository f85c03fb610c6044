//! Where each node finds the forces of the chunks that it is part of.
//!
//! Every chunk has a fixed range of slots, one for each node it may have, so that a chunk can change its nodes without
//! moving anybody else's.

use super::partition::{CHUNK_NODES, ChunkLayout};

/// Slots of each node.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeSlots {
    /// Start and length of each node's part of `entries`.
    parts: Vec<[u32; 2]>,
    entries: Vec<u32>,
}

/// Slot of a chunk's node.
fn slot(chunk: usize, place: usize) -> u32 {
    (chunk * CHUNK_NODES + place) as u32
}

impl NodeSlots {
    pub fn of(nodes: usize, layouts: &[ChunkLayout]) -> Self {
        let mut parts = vec![[0_u32; 2]; nodes];
        layouts.iter().flat_map(|layout| &layout.nodes).for_each(|&node| parts[node as usize][1] += 1);
        let mut start = 0;
        for part in &mut parts {
            part[0] = start;
            start += std::mem::take(&mut part[1]);
        }
        let mut entries = vec![0; start as usize];
        for (chunk, layout) in layouts.iter().enumerate() {
            for (place, &node) in layout.nodes.iter().enumerate() {
                let [start, count] = &mut parts[node as usize];
                entries[(*start + *count) as usize] = slot(chunk, place);
                *count += 1;
            }
        }
        Self { parts, entries }
    }

    pub fn node_count(&self) -> usize {
        self.parts.len()
    }

    /// Slots of a node, ascending.
    #[inline(always)]
    pub fn slots(&self, node: usize) -> &[u32] {
        let [start, count] = self.parts[node];
        &self.entries[start as usize..(start + count) as usize]
    }

    /// Follows changed and new chunks (`now`, by number) that had these nodes before; there are `nodes` of them now.
    pub fn follow(&mut self, nodes: usize, before: &[(usize, Vec<u32>)], now: &[(usize, &ChunkLayout)]) {
        self.parts.resize(nodes, [0; 2]);
        let had = before.iter().flat_map(|(_, nodes)| nodes).copied();
        let mut changed: Vec<u32> = had.chain(now.iter().flat_map(|(_, l)| &l.nodes).copied()).collect();
        changed.sort_unstable();
        changed.dedup();
        let is_old = |slot: &u32| {
            let chunk = *slot as usize / CHUNK_NODES;
            before.iter().all(|(other, _)| *other != chunk)
        };
        let mut slots: Vec<u32> = Vec::new();
        for node in changed {
            slots.clear();
            slots.extend(self.slots(node as usize).iter().filter(|slot| is_old(slot)));
            for (chunk, layout) in now {
                slots.extend(layout.nodes.binary_search(&node).ok().map(|place| slot(*chunk, place)));
            }
            slots.sort_unstable();
            self.put(node as usize, &slots);
        }
    }

    /// Writes a node's slots where they were, or at the end if there are more of them.
    fn put(&mut self, node: usize, slots: &[u32]) {
        let [start, count] = &mut self.parts[node];
        if slots.len() > *count as usize {
            *start = self.entries.len() as u32;
            self.entries.extend_from_slice(slots);
        } else {
            self.entries[*start as usize..][..slots.len()].copy_from_slice(slots);
        }
        *count = slots.len() as u32;
    }
}
