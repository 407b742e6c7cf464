//! A place for one thing, between a thread that brings them and one that takes them.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::interrupt;

/// How often whoever waits looks whether the user has asked to stop.
const LOOK: Duration = Duration::from_millis(20);

/// The place. Both sides hold it.
pub(super) struct Latest<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
}

struct State<T> {
    waiting: Option<T>,
    dropped: u64,
    has_ended: bool,
}

impl<T> Latest<T> {
    pub(super) fn new() -> Arc<Self> {
        let state = Mutex::new(State { waiting: None, dropped: 0, has_ended: false });
        Arc::new(Self { state, changed: Condvar::new() })
    }

    /// Puts a thing there. What waits there is dropped if `live`, and otherwise waited for. False where nobody wants any more.
    pub(super) fn put(&self, thing: T, live: bool) -> bool {
        let mut state = self.lock();
        while !live && state.waiting.is_some() && !interrupt::asked() {
            state = self.wait(state);
        }
        state.dropped += u64::from(state.waiting.replace(thing).is_some());
        self.changed.notify_all();
        !interrupt::asked()
    }

    /// Says that no more will come.
    pub(super) fn end(&self) {
        self.lock().has_ended = true;
        self.changed.notify_all();
    }

    /// Takes what is there or comes next, and how many were dropped so far; nothing at the end, or where the user has asked to
    /// stop.
    pub(super) fn take(&self) -> Option<(T, u64)> {
        let mut state = self.lock();
        loop {
            if interrupt::asked() {
                return None;
            }
            if let Some(thing) = state.waiting.take() {
                self.changed.notify_all();
                return Some((thing, state.dropped));
            }
            if state.has_ended {
                return None;
            }
            state = self.wait(state);
        }
    }

    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State<T>>) -> MutexGuard<'a, State<T>> {
        self.changed.wait_timeout(state, LOOK).unwrap_or_else(PoisonError::into_inner).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_live_things_the_newest_is_taken_and_the_others_are_counted() {
        let latest = Latest::new();
        (0..5).for_each(|i| assert!(latest.put(i, true)));
        assert_eq!(latest.take(), Some((4, 4)));
        latest.end();
        assert_eq!(latest.take(), None);
    }

    #[test]
    fn others_are_all_taken() {
        let latest = Latest::new();
        let other = latest.clone();
        let bringer = std::thread::spawn(move || {
            (0..50).for_each(|i| assert!(other.put(i, false)));
            other.end();
        });
        let taken: Vec<_> = std::iter::from_fn(|| latest.take()).collect();
        assert_eq!(taken, (0..50).map(|i| (i, 0)).collect::<Vec<_>>());
        bringer.join().unwrap();
    }
}
