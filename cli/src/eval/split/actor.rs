//! Who moves, by the names of files.

use std::collections::BTreeSet;
use std::path::Path;

use super::Role;
use crate::eval::folders::Folders;
use crate::failure::Failure;

/// The actor of each clip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Actors {
    /// By clip.
    pub of_clips: Vec<String>,
    /// Which part of the names it is, 1-based.
    pub part: usize,
}

/// The actor of each clip, by its name: the path below the folder of the class, without the extension,
/// in parts of letters and digits, as `HDM_bd_squat1Reps_001_120` has five.
///
/// `part` says which part it is, 1-based. Else it is the first part that is not the same in all
/// names; it must be shared by several clips.
///
/// # Errors
/// [`Failure::Usage`] for a name without this part, and if no part tells actors apart.
pub fn find_actors(folders: &Folders, part: Option<usize>) -> Result<Actors, Failure> {
    let names: Vec<Vec<String>> = folders
        .files
        .iter()
        .map(|file| parts(&file.file.path, &folders.classes[file.class]))
        .collect();
    let values = |part: usize| -> BTreeSet<&str> {
        let values = names.iter().map(|name| name.get(part - 1));
        values.map(|part| part.map_or("", String::as_str)).collect()
    };
    let n_shared = names.iter().map(Vec::len).min().unwrap_or(0);
    let found = part.or_else(|| (1..=n_shared).find(|&part| values(part).len() > 1));
    let example = names.first().map_or(String::new(), |name| name.join(" "));
    let Some(found) = found else {
        return Err(Failure::Usage(format!(
            "no part of the names tells actors apart; the parts of the first are: {example}"
        )));
    };
    if found == 0 || found > n_shared {
        return Err(Failure::Usage(format!(
            "--actor-part {found}: not all names have this part; the parts of the first are: {example}"
        )));
    }
    let n_actors = values(found).len();
    if part.is_none() && n_actors == names.len() {
        return Err(Failure::Usage(format!(
            "cannot tell actors: part {found} of the names is the first that differs, and it differs in each; say \
             with --actor-part which one is the actor; the parts of the first are: {example}"
        )));
    }
    let of_clips = names
        .into_iter()
        .map(|mut name| name.swap_remove(found - 1));
    Ok(Actors {
        of_clips: of_clips.collect(),
        part: found,
    })
}

/// The parts of a clip's name below the last folder of its path that is named as its class.
fn parts(path: &Path, class: &str) -> Vec<String> {
    let pieces: Vec<String> = path
        .with_extension("")
        .iter()
        .map(|piece| piece.to_string_lossy().into_owned())
        .collect();
    let folders = &pieces[..pieces.len().saturating_sub(1)];
    let below = folders.iter().rposition(|piece| piece == class);
    let own = &pieces[below.map_or(0, |at| at + 1)..];
    let words = own
        .iter()
        .flat_map(|piece| piece.split(|c: char| !c.is_alphanumeric()));
    words.filter(|w| !w.is_empty()).map(str::to_owned).collect()
}

impl Actors {
    /// Tests are the clips of `test`.
    ///
    /// # Errors
    /// [`Failure::Usage`] if one of them has no clips, or no other has any.
    pub fn roles(&self, test: &[String]) -> Result<Vec<Role>, Failure> {
        let known: BTreeSet<&str> = self.of_clips.iter().map(String::as_str).collect();
        let list = Vec::from_iter(known.iter().copied()).join(", ");
        let part = self.part;
        if let Some(stranger) = test.iter().find(|name| !known.contains(name.as_str())) {
            return Err(Failure::Usage(format!(
                "--test {stranger}: no such actor; part {part} of the names reads {list}"
            )));
        }
        let is_test = |actor: &str| test.iter().any(|name| name == actor);
        if test.is_empty() || known.iter().all(|actor| is_test(actor)) {
            return Err(Failure::Usage(format!(
                "--split actor learns from some and tests others: expected some, not all, of {list} in --test"
            )));
        }
        let role = |actor: &String| match is_test(actor) {
            true => Role::Test,
            false => Role::Train,
        };
        Ok(self.of_clips.iter().map(role).collect())
    }
}
