//! Lists, one per number, end to end.

/// Lays entries out by their rows, `row_count` of them, in the order in which they come: where each row begins, with the end of
/// the last, and the entries.
pub(crate) fn in_rows<T: Copy + Default>(
    entries: impl Iterator<Item = (u32, T)> + Clone,
    row_count: usize,
) -> (Vec<u32>, Vec<T>) {
    let mut starts = vec![0_u32; row_count + 1];
    entries.clone().for_each(|(row, _)| starts[row as usize + 1] += 1);
    for row in 0..row_count {
        starts[row + 1] += starts[row];
    }
    let mut laid_out = vec![T::default(); starts[row_count] as usize];
    let mut next = starts.clone();
    for (row, entry) in entries {
        let place = &mut next[row as usize];
        laid_out[*place as usize] = entry;
        *place += 1;
    }
    (starts, laid_out)
}
