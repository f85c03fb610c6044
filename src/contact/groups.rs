//! Groups of pairs that have nothing to do with each other, each solved by itself.
//!
//! Two pairs act on each other only by way of nodes that both move; a node whose motion is prescribed couples nothing. What is
//! linked by such nodes is a group. Passes over one group do nothing to another, so that every group gets as many as
//! it needs and no more, and groups may be solved at the same time: the result is the same.

use super::nodes::ContactNode;
use super::passes::PairRow;
use super::response::Settling;
use crate::math::DisjointSets;
use glam::DVec3;
use rayon::prelude::*;

/// Pairs below which sharing the groups out among threads costs more than it saves.
const PARALLEL_PAIRS: usize = 200;
/// Stands for a node that does not belong to a group.
const NONE: u32 = u32::MAX;

/// The rows of one group, with nodes of its own.
struct Group<'a> {
    rows: &'a mut [PairRow],
    nodes: Vec<ContactNode>,
    /// Places of its nodes in the table.
    places: Vec<u32>,
}

/// Solves each group by `solve`; puts the rows in the order of the groups, which in turn have the order of their first rows.
pub(super) fn solve_by_group(
    rows: &mut [PairRow],
    nodes: &mut [ContactNode],
    solve: impl Fn(&mut [PairRow], &mut [ContactNode]) -> Settling + Sync,
) -> Settling {
    let sizes = sort_by_group(rows, nodes);
    if sizes.len() <= 1 {
        return solve(rows, nodes);
    }
    let is_parallel = rows.len() >= PARALLEL_PAIRS && rayon::current_num_threads() > 1;
    let mut groups = split(rows, nodes, &sizes);
    let of_group = |group: &mut Group| solve(group.rows, &mut group.nodes);
    let settled: Vec<Settling> = if is_parallel {
        groups.par_iter_mut().with_max_len(1).map(of_group).collect()
    } else {
        groups.iter_mut().map(of_group).collect()
    };
    groups.into_iter().for_each(|group| group.give_back(nodes));
    let mut worst = Settling::default();
    settled.iter().for_each(|of_group| worst.include(of_group));
    worst
}

/// Brings the rows of each group together and returns how many each group has.
fn sort_by_group(rows: &mut [PairRow], nodes: &[ContactNode]) -> Vec<usize> {
    let moves = |node: &u32| nodes[*node as usize].inverse_mass_per_kg != DVec3::ZERO;
    // A pair without a node that moves has no row.
    let first_mover = |row: &PairRow| row.at.nodes.into_iter().find(moves).unwrap_or(row.at.nodes[0]);
    let mut sets = DisjointSets::new(nodes.len());
    for row in rows.iter() {
        let first = first_mover(row);
        row.at.nodes.iter().filter(|node| moves(node)).for_each(|node| sets.join(first, *node));
    }
    let mut group_of_root = vec![NONE; nodes.len()];
    let mut sizes = Vec::new();
    for row in rows.iter() {
        let group = &mut group_of_root[sets.root(first_mover(row)) as usize];
        if *group == NONE {
            *group = sizes.len() as u32;
            sizes.push(0);
        }
        sizes[*group as usize] += 1;
    }
    if sizes.len() > 1 {
        rows.sort_by_cached_key(|row| group_of_root[sets.root(first_mover(row)) as usize]);
    }
    sizes
}

/// Gives each group copies of its nodes, and its rows the places of those.
fn split<'a>(mut rows: &'a mut [PairRow], nodes: &[ContactNode], sizes: &[usize]) -> Vec<Group<'a>> {
    let mut place_in_group = vec![NONE; nodes.len()];
    let mut groups = Vec::with_capacity(sizes.len());
    for size in sizes {
        let (of_group, rest) = rows.split_at_mut(*size);
        rows = rest;
        let mut group = Group { rows: of_group, nodes: Vec::new(), places: Vec::new() };
        for node in group.rows.iter_mut().flat_map(|row| &mut row.at.nodes) {
            let place = &mut place_in_group[*node as usize];
            if *place == NONE {
                *place = group.places.len() as u32;
                group.places.push(*node);
                group.nodes.push(nodes[*node as usize]);
            }
            *node = *place;
        }
        group.places.iter().for_each(|node| place_in_group[*node as usize] = NONE);
        groups.push(group);
    }
    groups
}

impl Group<'_> {
    fn give_back(self, nodes: &mut [ContactNode]) {
        for node in self.rows.iter_mut().flat_map(|row| &mut row.at.nodes) {
            *node = self.places[*node as usize];
        }
        for (node, place) in self.nodes.into_iter().zip(self.places) {
            nodes[place as usize] = node;
        }
    }
}
