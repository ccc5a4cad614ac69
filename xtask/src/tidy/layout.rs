//! What stands where: the top level, each library crate's files, the size of data.

use std::collections::BTreeSet;

use super::{File, Finding};
use crate::workspace::LIBRARIES;

const ROOMS: [&str; 9] = [
    "mocap-io",
    "relfeat",
    "segidx",
    "mtemplate",
    "dtw",
    "bundles",
    "cli",
    "xtask",
    "benches",
];
const ROOT_FILES: [&str; 9] = [
    ".cargo",
    ".ci",
    ".gitignore",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE",
    "README.md",
];
const ARCHITECTURE_LINES: usize = 150;
const DATA_BYTES: u64 = 1 << 20;
const DATA_EXTENSIONS: [&str; 12] = [
    "amc", "asf", "bvh", "c3d", "csv", "glb", "mbg", "mtpl", "npy", "npz", "shard", "trc",
];

/// All findings about where files stand.
pub(super) fn check(files: &[File]) -> Vec<Finding> {
    let mut findings = top_level(files);
    findings.extend(LIBRARIES.iter().flat_map(|name| library_files(name, files)));
    findings.extend(architecture_length(files));
    findings.extend(large_data(files));
    findings
}

fn finding(path: impl Into<String>, rule: &'static str, message: impl Into<String>) -> Finding {
    Finding {
        path: path.into(),
        line: 1,
        rule,
        message: message.into(),
    }
}

fn top_level(files: &[File]) -> Vec<Finding> {
    let expected: BTreeSet<&str> = ROOMS.into_iter().chain(ROOT_FILES).collect();
    let found: BTreeSet<&str> = files
        .iter()
        .filter_map(|file| file.path.split('/').next())
        .collect();
    let missing = expected
        .difference(&found)
        .map(|name| (name, "is missing from the top level"));
    let extra = found
        .difference(&expected)
        .map(|name| (name, "does not belong at the top level"));
    missing
        .chain(extra)
        .map(|(name, message)| finding(*name, "top-level", message))
        .collect()
}

fn library_files(name: &str, files: &[File]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for wanted in [
        "README.md",
        "CHANGELOG.md",
        "tests/it/main.rs",
        "src/lib.rs",
    ] {
        let path = format!("{name}/{wanted}");
        if !files.iter().any(|file| file.path == path) {
            findings.push(finding(path, "crate-files", "is missing"));
        }
    }
    let examples = format!("{name}/examples/");
    if !files
        .iter()
        .any(|file| file.path.starts_with(&examples) && file.extension() == "rs")
    {
        findings.push(finding(
            examples,
            "crate-files",
            "needs at least one example",
        ));
    }
    let entry = format!("{name}/src/lib.rs");
    if let Some(file) = files.iter().find(|file| file.path == entry) {
        for heading in ["# Units and shapes", "# Source"] {
            let is_heading = |line: &str| line.strip_prefix("//! ").is_some_and(|l| l == heading);
            if !file.text.lines().any(is_heading) {
                findings.push(finding(
                    &entry,
                    "crate-docs",
                    format!("no `{heading}` section"),
                ));
            }
        }
    }
    findings
}

fn architecture_length(files: &[File]) -> Vec<Finding> {
    let Some(file) = files.iter().find(|file| file.path == "ARCHITECTURE.md") else {
        return Vec::new();
    };
    let lines = file.text.lines().count();
    if lines <= ARCHITECTURE_LINES {
        return Vec::new();
    }
    vec![Finding {
        path: file.path.clone(),
        line: ARCHITECTURE_LINES + 1,
        rule: "length",
        message: format!("{lines} lines, at most {ARCHITECTURE_LINES} wanted"),
    }]
}

fn large_data(files: &[File]) -> Vec<Finding> {
    let is_data = |file: &&File| {
        let extension = file.extension().to_ascii_lowercase();
        DATA_EXTENSIONS.contains(&extension.as_str())
    };
    let large = files
        .iter()
        .filter(is_data)
        .filter(|file| file.size > DATA_BYTES);
    large
        .map(|file| {
            let message = format!("{} bytes of data, at most {DATA_BYTES} wanted", file.size);
            finding(&file.path, "large-data", message)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::file;
    use super::*;

    fn tidy_tree() -> Vec<File> {
        let mut files: Vec<File> = ROOT_FILES.into_iter().map(|path| file(path, "")).collect();
        for room in ROOMS {
            files.push(file(&format!("{room}/Cargo.toml"), ""));
        }
        for name in LIBRARIES {
            for path in [
                "README.md",
                "CHANGELOG.md",
                "tests/it/main.rs",
                "examples/a.rs",
            ] {
                files.push(file(&format!("{name}/{path}"), ""));
            }
            let docs = "//! One.\n//!\n//! # Units and shapes\n//!\n//! # Source\n";
            files.push(file(&format!("{name}/src/lib.rs"), docs));
        }
        files
    }

    #[track_caller]
    fn findings(change: impl FnOnce(&mut Vec<File>), expected: &[&str]) {
        let mut files = tidy_tree();
        change(&mut files);
        let found: Vec<String> = check(&files).iter().map(ToString::to_string).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn a_tidy_tree_has_none() {
        findings(|_| (), &[]);
    }

    #[test]
    fn top_level_is_exact() {
        findings(
            |files| {
                files.retain(|file| file.path != "LICENSE");
                files.push(file("notes/a.md", ""));
            },
            &[
                "LICENSE:1: top-level: is missing from the top level",
                "notes:1: top-level: does not belong at the top level",
            ],
        );
    }

    #[test]
    fn each_library_has_its_files() {
        findings(
            |files| {
                files.retain(|file| {
                    !["dtw/README.md", "dtw/CHANGELOG.md", "dtw/tests/it/main.rs"]
                        .contains(&file.path.as_str())
                        && !file.path.starts_with("dtw/examples")
                });
            },
            &[
                "dtw/README.md:1: crate-files: is missing",
                "dtw/CHANGELOG.md:1: crate-files: is missing",
                "dtw/tests/it/main.rs:1: crate-files: is missing",
                "dtw/examples/:1: crate-files: needs at least one example",
            ],
        );
    }

    #[test]
    fn each_library_names_units_and_source() {
        findings(
            |files| {
                for file in files {
                    if file.path == "dtw/src/lib.rs" {
                        file.text = "//! # Units\n// # Source\n".into();
                    }
                }
            },
            &[
                "dtw/src/lib.rs:1: crate-docs: no `# Units and shapes` section",
                "dtw/src/lib.rs:1: crate-docs: no `# Source` section",
            ],
        );
    }

    #[test]
    fn architecture_is_short() {
        let set = |lines: usize| {
            move |files: &mut Vec<File>| {
                for file in files {
                    if file.path == "ARCHITECTURE.md" {
                        file.text = "a\n".repeat(lines);
                    }
                }
            }
        };
        findings(set(150), &[]);
        findings(
            set(151),
            &["ARCHITECTURE.md:151: length: 151 lines, at most 150 wanted"],
        );
    }

    #[test]
    fn motion_data_is_small() {
        let push = |path: &'static str, size: u64| {
            move |files: &mut Vec<File>| {
                files.push(File {
                    size,
                    ..file(path, "")
                });
            }
        };
        findings(push("cli/tests/data/a.BVH", 1 << 20), &[]);
        findings(push("cli/src/a.rs", 1 << 21), &[]);
        findings(
            push("cli/tests/data/a.BVH", (1 << 20) + 1),
            &["cli/tests/data/a.BVH:1: large-data: 1048577 bytes of data, at most 1048576 wanted"],
        );
    }
}
