//! Every fuzz target is declared and starts from a committed corpus.

use super::{File, Finding, line_where};

const RULE: &str = "fuzz-target";

/// Findings about every `<crate>/fuzz` folder.
pub(super) fn check(files: &[File]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in files {
        let Some((folder, source)) = file.path.split_once("/fuzz/fuzz_targets/") else {
            continue;
        };
        let Some(target) = source
            .strip_suffix(".rs")
            .filter(|name| !name.contains('/'))
        else {
            continue;
        };
        let mut report = |line, message: String| {
            findings.push(Finding {
                path: file.path.clone(),
                line,
                rule: RULE,
                message,
            });
        };
        let manifest = format!("{folder}/fuzz/Cargo.toml");
        let declared = files
            .iter()
            .find(|file| file.path == manifest)
            .is_some_and(|file| {
                declared_targets(&file.text)
                    .iter()
                    .any(|(name, _)| name == target)
            });
        if !declared {
            report(1, format!("no [[bin]] of that name and path in {manifest}"));
        }
        let corpus = format!("{folder}/fuzz/corpus/{target}/");
        if !files.iter().any(|file| file.path.starts_with(&corpus)) {
            report(1, format!("no committed corpus in {corpus}"));
        }
    }
    for file in files {
        let Some(folder) = file.path.strip_suffix("/fuzz/Cargo.toml") else {
            continue;
        };
        for (name, path) in declared_targets(&file.text) {
            let source = format!("{folder}/fuzz/{path}");
            if !files.iter().any(|file| file.path == source) {
                let quoted = format!("\"{name}\"");
                findings.push(Finding {
                    path: file.path.clone(),
                    line: line_where(&file.text, |line| line.contains(&quoted)),
                    rule: RULE,
                    message: format!("{name} names {path}, which does not exist"),
                });
            }
        }
    }
    findings
}

/// Name and source path of each `[[bin]]` whose path follows its name.
fn declared_targets(manifest: &str) -> Vec<(String, String)> {
    let Ok(manifest) = manifest.parse::<toml::Table>() else {
        return Vec::new();
    };
    let bins = manifest.get("bin").and_then(toml::Value::as_array);
    bins.into_iter()
        .flatten()
        .filter_map(|bin| {
            let name = bin.get("name")?.as_str()?;
            let path = bin.get("path")?.as_str()?;
            (path == format!("fuzz_targets/{name}.rs")).then(|| (name.to_owned(), path.to_owned()))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::file;
    use super::*;

    const MANIFEST: &str = "[[bin]]\nname = \"ops\"\npath = \"fuzz_targets/ops.rs\"\n";

    #[track_caller]
    fn findings(files: &[(&str, &str)], expected: &[&str]) {
        let files: Vec<File> = files.iter().map(|(path, text)| file(path, text)).collect();
        let found: Vec<String> = check(&files).iter().map(ToString::to_string).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn a_declared_target_with_a_corpus_is_fine() {
        findings(
            &[
                ("segidx/fuzz/Cargo.toml", MANIFEST),
                ("segidx/fuzz/fuzz_targets/ops.rs", ""),
                ("segidx/fuzz/corpus/ops/a", ""),
            ],
            &[],
        );
    }

    #[test]
    fn a_missing_declaration_or_corpus_is_found() {
        findings(
            &[
                ("segidx/fuzz/Cargo.toml", MANIFEST),
                ("segidx/fuzz/fuzz_targets/ops.rs", ""),
                ("segidx/fuzz/fuzz_targets/shard.rs", ""),
                ("segidx/fuzz/corpus/ops/a", ""),
                ("segidx/fuzz/corpus/shard_old/a", ""),
            ],
            &[
                "segidx/fuzz/fuzz_targets/shard.rs:1: fuzz-target: \
                 no [[bin]] of that name and path in segidx/fuzz/Cargo.toml",
                "segidx/fuzz/fuzz_targets/shard.rs:1: fuzz-target: \
                 no committed corpus in segidx/fuzz/corpus/shard/",
            ],
        );
    }

    #[test]
    fn a_declaration_without_source_is_found() {
        findings(
            &[("segidx/fuzz/Cargo.toml", MANIFEST)],
            &["segidx/fuzz/Cargo.toml:2: fuzz-target: \
               ops names fuzz_targets/ops.rs, which does not exist"],
        );
    }
}
