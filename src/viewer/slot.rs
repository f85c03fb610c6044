//! A slot that holds the latest value: what was not looked at in time is replaced, never queued.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// One place, one writer, one reader; neither ever waits for the other's work.
#[derive(Debug)]
pub struct LatestSlot<T> {
    content: Mutex<Content<T>>,
}

#[derive(Debug)]
struct Content<T> {
    latest: Option<Arc<T>>,
    was_taken: bool,
}

impl<T> Default for LatestSlot<T> {
    fn default() -> Self {
        Self { content: Mutex::new(Content { latest: None, was_taken: true }) }
    }
}

impl<T> LatestSlot<T> {
    /// Replaces what is in the slot.
    pub fn put(&self, value: Arc<T>) {
        // The old value is dropped after the lock is open again: freeing a large frame takes time.
        let old = {
            let mut content = self.lock();
            content.was_taken = false;
            content.latest.replace(value)
        };
        drop(old);
    }

    /// The latest value, if any was ever put.
    #[must_use]
    pub fn latest(&self) -> Option<Arc<T>> {
        let mut content = self.lock();
        content.was_taken = true;
        content.latest.clone()
    }

    /// Whether the reader has seen the latest value, so that a new one is worth making.
    #[must_use]
    pub fn was_taken(&self) -> bool {
        self.lock().was_taken
    }

    fn lock(&self) -> MutexGuard<'_, Content<T>> {
        // Nothing that can panic runs under the lock.
        self.content.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_value_wins_and_stays() {
        let slot = LatestSlot::default();
        assert!(slot.latest().is_none() && slot.was_taken());
        slot.put(Arc::new(1));
        slot.put(Arc::new(2));
        assert!(!slot.was_taken());
        assert_eq!(slot.latest().as_deref(), Some(&2));
        assert!(slot.was_taken());
        assert_eq!(slot.latest().as_deref(), Some(&2));
    }

    #[test]
    fn a_reader_keeps_its_value_while_the_writer_goes_on() {
        let slot = LatestSlot::default();
        slot.put(Arc::new(vec![7; 3]));
        let seen = slot.latest().unwrap();
        slot.put(Arc::new(vec![8; 3]));
        assert_eq!((seen[0], slot.latest().unwrap()[0]), (7, 8));
    }
}
