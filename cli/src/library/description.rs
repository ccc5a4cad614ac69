//! What the words of a library mean.

use std::fs;
use std::path::Path;

use relfeat::FeatureSet;
use serde::{Deserialize, Serialize};

use crate::failure::Failure;

/// Version of the folder's layout.
const VERSION: u32 = 3;

/// A feature set with the text that it was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSet {
    /// The features.
    pub set: FeatureSet,
    /// TOML.
    pub text: String,
}

impl NamedSet {
    /// A built-in set by its name, or a set from a TOML file.
    ///
    /// # Errors
    /// [`Failure`] if there is no such set or file, or the file is no set.
    pub fn find(name: &str) -> Result<NamedSet, Failure> {
        if let Some(text) = FeatureSet::builtin_toml(name) {
            return Self::from_text(Path::new(name), text);
        }
        let path = Path::new(name);
        if !path.exists() {
            return Err(Failure::Usage(format!(
                "expected {} or a TOML file, found {name:?}",
                relfeat::BUILTIN_SETS.join(", ")
            )));
        }
        let text = fs::read_to_string(path).map_err(|e| Failure::io(path, e))?;
        Self::from_text(path, &text)
    }

    fn from_text(path: &Path, text: &str) -> Result<NamedSet, Failure> {
        let set = FeatureSet::from_toml(text).map_err(|e| Failure::input(path, e))?;
        Ok(NamedSet {
            set,
            text: text.to_owned(),
        })
    }
}

/// `library.toml`.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct LibraryToml {
    version: u32,
    rate: f64,
    feature_set: String,
    feature_set_toml: String,
}

/// The text of `library.toml`.
pub(super) fn write(features: &NamedSet, rate: f64) -> Result<String, toml::ser::Error> {
    toml::to_string_pretty(&LibraryToml {
        version: VERSION,
        rate,
        feature_set: features.set.name().to_owned(),
        feature_set_toml: features.text.clone(),
    })
}

/// Reads `library.toml`: the features and the words per second.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<(NamedSet, f64), Failure> {
    let refuse = |message: String| Failure::input(path, message.trim().replace('\n', " "));
    let text = str::from_utf8(bytes).map_err(|e| refuse(e.to_string()))?;
    let about: LibraryToml = toml::from_str(text).map_err(|e| refuse(e.to_string()))?;
    if about.version != VERSION {
        let found = about.version;
        return Err(refuse(format!(
            "expected library version {VERSION}, found {found}"
        )));
    }
    let features = NamedSet::from_text(path, &about.feature_set_toml)?;
    Ok((features, about.rate))
}
