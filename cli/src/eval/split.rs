//! Which clips are learned from, and which are tests.

use std::collections::BTreeSet;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::folders::Folders;
use crate::failure::Failure;

mod actor;

pub use actor::{Actors, find_actors};

/// What a clip is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Templates are learned from it.
    Train,
    /// Templates are matched against it.
    Test,
}

/// How clips are divided.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Split {
    /// As the 2006 paper: of the N clips of a class, m = max(2, min(N, ⌈N/2⌉)) are learned from, those with
    /// the 0-based numbers ⌊j·N/m⌋ for j from 0 to m - 1 in order of file names (spec.md c.8).
    Paper,
    /// Clips of some actors are tests, those of all others are learned from.
    Actor {
        /// The actors whose clips are tests.
        test: Vec<String>,
        /// Which part of a name is the actor, 1-based; found if `None`.
        part: Option<usize>,
    },
    /// Of each class every k-th clip is a test, in order of file names or in an order by a seed.
    File {
        /// k, at least 2.
        every: usize,
        /// Seed of the order.
        seed: Option<u64>,
    },
}

impl Split {
    /// The role of each clip.
    ///
    /// # Errors
    /// [`Failure::Usage`] if actors cannot be told apart, or one to be tested has no clips.
    pub fn roles(&self, folders: &Folders) -> Result<Vec<Role>, Failure> {
        match self {
            Split::Paper => Ok(by_class(folders, paper)),
            Split::Actor { test, part } => Ok(find_actors(folders, *part)?.roles(test)?),
            Split::File { every, seed } => {
                let mut rng = seed.map(ChaCha8Rng::seed_from_u64);
                Ok(by_class(folders, |n| every_kth(n, *every, rng.as_mut())))
            }
        }
    }
}

/// Puts together the roles of each class's clips.
fn by_class(folders: &Folders, mut roles: impl FnMut(usize) -> Vec<Role>) -> Vec<Role> {
    let classes = 0..folders.classes.len();
    let n_clips = |class| folders.files.iter().filter(|f| f.class == class).count();
    classes.flat_map(|class| roles(n_clips(class))).collect()
}

fn paper(n_clips: usize) -> Vec<Role> {
    let n_train = n_clips.div_ceil(2).min(n_clips).max(2);
    let training: BTreeSet<usize> = (0..n_train).map(|j| j * n_clips / n_train).collect();
    let role = |clip| match training.contains(&clip) {
        true => Role::Train,
        false => Role::Test,
    };
    (0..n_clips).map(role).collect()
}

fn every_kth(n_clips: usize, every: usize, rng: Option<&mut ChaCha8Rng>) -> Vec<Role> {
    let mut order: Vec<usize> = (0..n_clips).collect();
    if let Some(rng) = rng {
        // Fisher and Yates; a remainder is fair enough for so few.
        for last in (1..n_clips).rev() {
            let other = (rng.next_u64() % (last as u64 + 1)) as usize;
            order.swap(last, other);
        }
    }
    let mut roles = vec![Role::Train; n_clips];
    for &clip in order.iter().skip(every - 1).step_by(every) {
        roles[clip] = Role::Test;
    }
    roles
}

#[cfg(test)]
mod tests;
