//! Integers from seeded dice, the same on every machine.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;

/// An integer below `n` from the next 64 bits x: ⌊n·x / 2⁶⁴⌋. 0 when `n` is 0.
pub(crate) fn below(dice: &mut ChaCha8Rng, n: usize) -> usize {
    let product = u128::from(dice.next_u64()) * n as u128;
    (product >> 64) as usize
}

/// Shuffles by exchanging each place, from the last on, with one up to it.
pub(crate) fn shuffle<T>(dice: &mut ChaCha8Rng, items: &mut [T]) {
    for place in (1..items.len()).rev() {
        items.swap(place, below(dice, place + 1));
    }
}
