//! Loops over long lists, shared out among threads in parts; short ones stay where they are, since calling other threads costs
//! more than it saves (the more so from outside of the pool).

use rayon::prelude::*;

/// What `f`, given places and items, makes of a list, in its order. A thread takes `part` items at a time.
pub fn filter_map<T: Sync, R: Send>(
    items: &[T],
    part: usize,
    f: impl Fn(usize, &T) -> Option<R> + Sync,
) -> Vec<R> {
    flat_map(items, part, |place, item, found| found.extend(f(place, item)))
}

/// The same where every item becomes something.
pub fn map<T: Sync, R: Send>(items: &[T], part: usize, f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    filter_map(items, part, |_, item| Some(f(item)))
}

/// The same where an item becomes any number of things, which `f` adds to what it is lent.
pub fn flat_map<T: Sync, R: Send>(
    items: &[T],
    part: usize,
    f: impl Fn(usize, &T, &mut Vec<R>) + Sync,
) -> Vec<R> {
    let of_part = |(number, items): (usize, &[T])| -> Vec<R> {
        let mut found = Vec::new();
        (number * part..).zip(items).for_each(|(place, item)| f(place, item, &mut found));
        found
    };
    if items.len() <= part {
        return of_part((0, items));
    }
    let mut found = items.par_chunks(part).enumerate().map(of_part).collect::<Vec<_>>().into_iter();
    let mut all = found.next().unwrap_or_default();
    found.for_each(|part| all.extend(part));
    all
}

/// Items of both together from which two things are worth doing side by side.
const WORTH_TWO: usize = 2048;

/// Does two things that look through so many items together: side by side where that is worth it.
pub fn both<A: Send, B: Send>(
    items: usize,
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    if items < WORTH_TWO { (first(), second()) } else { rayon::join(first, second) }
}
