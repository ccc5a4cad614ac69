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
