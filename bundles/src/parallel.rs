//! The same work for each of many things, on all threads where the feature `rayon` is on.

/// `work` on each item and its place, in the items' order.
#[cfg(feature = "rayon")]
pub(crate) fn map<I: Sync, O: Send>(
    items: &[I],
    work: impl Fn(usize, &I) -> O + Sync + Send,
) -> Vec<O> {
    use rayon::prelude::*;
    items
        .par_iter()
        .enumerate()
        .map(|(place, item)| work(place, item))
        .collect()
}

/// `work` on each item and its place, in the items' order.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map<I, O>(items: &[I], work: impl Fn(usize, &I) -> O) -> Vec<O> {
    let places = items.iter().enumerate();
    places.map(|(place, item)| work(place, item)).collect()
}

/// `work` on each item, which it may change.
#[cfg(feature = "rayon")]
pub(crate) fn map_mut<I: Send, O: Send>(
    items: &mut [I],
    work: impl Fn(&mut I) -> O + Sync + Send,
) -> Vec<O> {
    use rayon::prelude::*;
    items.par_iter_mut().map(work).collect()
}

/// `work` on each item, which it may change.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map_mut<I, O>(items: &mut [I], work: impl Fn(&mut I) -> O) -> Vec<O> {
    items.iter_mut().map(work).collect()
}

pub(crate) use imp::map_with;

#[cfg(feature = "rayon")]
mod imp {
    use std::sync::Mutex;

    use rayon::prelude::*;

    /// The results in the order of `items`; `pool` keeps each thread's memory from call to call.
    pub(crate) fn map_with<T: Sync, S: Send, R: Send>(
        items: &[T],
        pool: &mut Vec<S>,
        new: impl Fn() -> S + Sync,
        work: impl Fn(&mut S, &T) -> R + Sync,
    ) -> Vec<R> {
        if items.len() < 2 || rayon::current_num_threads() == 1 {
            let mut state = pool.pop().unwrap_or_else(new);
            let results = items.iter().map(|item| work(&mut state, item)).collect();
            pool.push(state);
            return results;
        }
        let states = Mutex::new(std::mem::take(pool));
        let take = || states.lock().ok().and_then(|mut free| free.pop());
        let results = items.par_iter().map(|item| {
            let mut state = take().unwrap_or_else(&new);
            let result = work(&mut state, item);
            if let Ok(mut free) = states.lock() {
                free.push(state);
            }
            result
        });
        let results = results.collect();
        *pool = states.into_inner().unwrap_or_default();
        results
    }
}

#[cfg(not(feature = "rayon"))]
mod imp {
    /// The results in the order of `items`; `pool` keeps the memory from call to call.
    pub(crate) fn map_with<T, S, R>(
        items: &[T],
        pool: &mut Vec<S>,
        new: impl Fn() -> S,
        work: impl Fn(&mut S, &T) -> R,
    ) -> Vec<R> {
        let mut state = pool.pop().unwrap_or_else(new);
        let results = items.iter().map(|item| work(&mut state, item)).collect();
        pool.push(state);
        results
    }
}
