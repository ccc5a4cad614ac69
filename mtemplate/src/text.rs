//! The text form of a [`ClassTemplate`]: TOML, a row of runs for each feature.

mod read;
mod runs;

use std::fmt::Write;

use crate::{ClassError, ClassTemplate, FileError, Keyframe};

/// Version of the text form.
const VERSION: u32 = 1;

impl ClassTemplate {
    /// The template as text.
    ///
    /// ```toml
    /// motion_template = 1
    /// name = "squat"
    /// feature_set = "mueller2006"
    /// rate = 30
    /// columns = 48
    /// n_motions = 26
    /// tau = 0.06
    /// weights = "1x47 0.25"
    ///
    /// [features]
    /// rknee_bent = "0x12 0.25x3 1x20 *x13"
    /// rhand_fast = "*"
    ///
    /// [[keyframe]]
    /// column = 20
    /// stiffness = 0.8
    /// features = { rknee_bent = 1 }
    /// ```
    ///
    /// `motion_template` is the version of the form. A row lists its columns as runs: a value and
    /// `x` with the number of columns that have it; a run without a number is one column, and a row
    /// that is a single run without a number fills all columns. A value is 0, 1, a fraction, or `*`
    /// for "does not matter". `*` is 0.5, which no quantisation makes a 0 or 1: 0.5 may be written
    /// either way, and is always written back as `*`. Fractions have the fewest digits that give the
    /// same number when read, so that reading what was written gives an equal template.
    ///
    /// `weights` is a row, too, and left out when all are 1; `n_motions`, `tau` and keyframes are left
    /// out when there are none. A keyframe's columns count from 0; without a `stiffness` it is 0.5.
    /// All features are written, in their order.
    ///
    /// # Errors
    ///
    /// As [`check`](Self::check).
    pub fn to_text(&self) -> Result<String, ClassError> {
        self.check()?;
        let mut lines = vec![
            format!("motion_template = {VERSION}"),
            format!("name = {}", quoted(&self.name)),
            format!("feature_set = {}", quoted(&self.feature_set)),
            format!("rate = {}", runs::number(self.rate)),
            format!("columns = {}", self.template.n_columns()),
        ];
        lines.extend(self.n_motions.map(|n| format!("n_motions = {n}")));
        lines.extend(self.tau.map(|tau| format!("tau = {}", runs::number(tau))));
        if self.template.weights().iter().any(|&weight| weight != 1.0) {
            let row = runs::write(self.template.weights().iter().copied(), runs::number);
            lines.push(format!("weights = \"{row}\""));
        }
        lines.push("\n[features]".to_owned());
        let keys: Vec<String> = self.features.iter().map(|name| key(name)).collect();
        let width = keys
            .iter()
            .map(|key| key.chars().count())
            .max()
            .unwrap_or(0);
        for (key, row) in keys.iter().zip(self.template.values().columns()) {
            let row = runs::write(row.iter().copied(), runs::value);
            lines.push(format!("{key:width$} = \"{row}\""));
        }
        lines.extend(self.keyframes.iter().map(|one| keyframe(one, &keys)));
        lines.push(String::new());
        Ok(lines.join("\n"))
    }

    /// Reads the text form, of which [`to_text`](Self::to_text) shows an example.
    ///
    /// `names` gives the features of a feature set, in order, by the set's name. Rows may then stand
    /// in any order, and features that have none do not matter (`*`) anywhere. Where it gives `None`,
    /// the file's rows are all the features there are, in the file's order.
    ///
    /// # Errors
    ///
    /// [`FileError`] with line and column, in a row those of the run: no TOML, unknown or missing
    /// keys, another version, a row of other columns, values outside \[0, 1\], a feature that the set
    /// does not have, and what [`check`](Self::check) refuses.
    ///
    /// ```
    /// use mtemplate::ClassTemplate;
    ///
    /// let text = r#"
    ///     motion_template = 1
    ///     name = "clap"
    ///     feature_set = "arms"
    ///     rate = 30
    ///     columns = 4
    ///     [features]
    ///     hands_touching = "0x2 1 *"
    /// "#;
    /// let arms = || vec!["hands_raised".to_owned(), "hands_touching".to_owned()];
    /// let clap = ClassTemplate::from_text(text, |set| (set == "arms").then(arms))?;
    /// assert_eq!(clap.template.values().column(0).to_vec(), [0.5; 4]);
    /// assert_eq!(clap.template.values().column(1).to_vec(), [0.0, 0.0, 1.0, 0.5]);
    /// # Ok::<(), mtemplate::FileError>(())
    /// ```
    pub fn from_text(
        text: &str,
        names: impl Fn(&str) -> Option<Vec<String>>,
    ) -> Result<ClassTemplate, FileError> {
        read::read(text, names)
    }
}

fn keyframe(one: &Keyframe, keys: &[String]) -> String {
    let asked = keys.iter().enumerate();
    let asked = asked.filter(|(bit, _)| one.care >> bit & 1 == 1);
    let asked: Vec<String> = asked
        .map(|(bit, key)| format!("{key} = {}", one.value >> bit & 1))
        .collect();
    format!(
        "\n[[keyframe]]\ncolumn = {}\nstiffness = {}\nfeatures = {{ {} }}",
        one.column,
        runs::number(one.stiffness),
        asked.join(", ")
    )
}

/// A key of TOML: bare where that is allowed.
fn key(name: &str) -> String {
    let is_bare = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-');
    if !name.is_empty() && name.bytes().all(is_bare) {
        name.to_owned()
    } else {
        quoted(name)
    }
}

/// A basic string of TOML.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => {
                let written = write!(quoted, "\\u{:04X}", u32::from(c));
                written.expect("a string takes all that is written to it");
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}
