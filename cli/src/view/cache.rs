//! What was read lately, up to a number of bytes.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Values by the number of their clip. Together they take at most a number of bytes: the ones that were not asked for
/// longest go first.
#[derive(Debug)]
pub(super) struct Cache<V> {
    max_bytes: usize,
    kept: Mutex<Kept<V>>,
}

#[derive(Debug)]
struct Kept<V> {
    values: BTreeMap<u32, Value<V>>,
    /// Clips by when they were last asked for.
    by_use: BTreeMap<u64, u32>,
    n_bytes: usize,
    /// Counts what was asked.
    now: u64,
}

#[derive(Debug)]
struct Value<V> {
    value: Arc<V>,
    n_bytes: usize,
    used: u64,
}

impl<V> Cache<V> {
    pub(super) fn new(max_bytes: usize) -> Cache<V> {
        Cache {
            max_bytes,
            kept: Mutex::new(Kept {
                values: BTreeMap::new(),
                by_use: BTreeMap::new(),
                n_bytes: 0,
                now: 0,
            }),
        }
    }

    /// The value of a clip, if it is kept.
    pub(super) fn get(&self, clip: u32) -> Option<Arc<V>> {
        let mut kept = self.lock();
        let kept = &mut *kept;
        let value = kept.values.get_mut(&clip)?;
        kept.now += 1;
        kept.by_use.remove(&value.used);
        kept.by_use.insert(kept.now, clip);
        value.used = kept.now;
        Some(Arc::clone(&value.value))
    }

    /// Keeps a value of `n_bytes`, in place of others if need be; not at all if it is too large even so.
    pub(super) fn insert(&self, clip: u32, value: Arc<V>, n_bytes: usize) {
        let mut kept = self.lock();
        kept.remove(clip);
        if n_bytes > self.max_bytes {
            return;
        }
        while kept.n_bytes > self.max_bytes - n_bytes {
            let Some((_, oldest)) = kept.by_use.pop_first() else {
                break;
            };
            kept.remove(oldest);
        }
        kept.now += 1;
        let used = kept.now;
        kept.by_use.insert(used, clip);
        kept.n_bytes += n_bytes;
        let value = Value {
            value,
            n_bytes,
            used,
        };
        kept.values.insert(clip, value);
    }

    /// Nothing is left half done where a thread might panic.
    fn lock(&self) -> MutexGuard<'_, Kept<V>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<V> Kept<V> {
    fn remove(&mut self, clip: u32) {
        if let Some(value) = self.values.remove(&clip) {
            self.by_use.remove(&value.used);
            self.n_bytes -= value.n_bytes;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const MAX_BYTES: usize = 10;

    /// The same with a list, the latest last.
    #[derive(Default)]
    struct Naive(Vec<(u32, usize)>);

    impl Naive {
        fn get(&mut self, clip: u32) -> bool {
            let place = self.0.iter().position(|one| one.0 == clip);
            if let Some(place) = place {
                let one = self.0.remove(place);
                self.0.push(one);
            }
            place.is_some()
        }

        fn insert(&mut self, clip: u32, n_bytes: usize) {
            self.0.retain(|one| one.0 != clip);
            if n_bytes > MAX_BYTES {
                return;
            }
            self.0.push((clip, n_bytes));
            while self.0.iter().map(|one| one.1).sum::<usize>() > MAX_BYTES {
                self.0.remove(0);
            }
        }
    }

    proptest! {
        #[test]
        fn the_latest_are_kept(steps in proptest::collection::vec((0u32..6, proptest::option::of(0usize..13)), 0..60)) {
            let cache = Cache::new(MAX_BYTES);
            let mut naive = Naive::default();
            for (clip, n_bytes) in steps {
                match n_bytes {
                    None => prop_assert_eq!(cache.get(clip).is_some(), naive.get(clip)),
                    Some(n_bytes) => {
                        cache.insert(clip, Arc::new(()), n_bytes);
                        naive.insert(clip, n_bytes);
                    }
                }
                let kept = cache.lock();
                let known: Vec<(u32, usize)> = kept
                    .by_use
                    .values()
                    .map(|clip| (*clip, kept.values[clip].n_bytes))
                    .collect();
                prop_assert_eq!(&known, &naive.0);
                prop_assert_eq!(kept.n_bytes, known.iter().map(|one| one.1).sum::<usize>());
                prop_assert_eq!(kept.values.len(), known.len());
            }
        }
    }
}
