//! The same work for each of many things, on all threads where the feature `rayon` is on.

/// `work` on each item, in the items' order; every thread works with a `scratch` of its own.
#[cfg(feature = "rayon")]
pub(crate) fn map<I: Sync, S, O: Send>(
    items: &[I],
    scratch: impl Fn() -> S + Sync + Send,
    work: impl Fn(&mut S, &I) -> O + Sync + Send,
) -> Vec<O> {
    use rayon::prelude::*;
    items.par_iter().map_init(scratch, work).collect()
}

/// `work` on each item, in the items' order.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map<I, S, O>(
    items: &[I],
    scratch: impl Fn() -> S,
    work: impl Fn(&mut S, &I) -> O,
) -> Vec<O> {
    let mut scratch = scratch();
    items.iter().map(|item| work(&mut scratch, item)).collect()
}
