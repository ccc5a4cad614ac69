//! No library crate names a sibling, whatever the kind of dependency.

use std::path::{Path, PathBuf};

use super::{File, Finding, line_where};
use crate::workspace::{LIBRARIES, Workspace};

const RULE: &str = "sibling";

/// A member and what it names.
#[derive(Debug, Clone, Default)]
pub(super) struct Member {
    name: String,
    /// Folder, relative to the root.
    folder: PathBuf,
    dependencies: Vec<Dependency>,
}

/// One entry of a dependency table.
#[derive(Debug, Clone, Default)]
struct Dependency {
    /// The package's own name.
    name: String,
    /// The name the manifest gives it, when that differs.
    rename: Option<String>,
    /// Table it stands in, such as `dev-dependencies`.
    table: String,
    /// Folder relative to the root, for a path inside the workspace.
    folder: Option<PathBuf>,
}

/// The workspace's members as the rule sees them.
pub(super) fn packages(workspace: &Workspace) -> Vec<Member> {
    let relative = |path: &Path| {
        path.strip_prefix(&workspace.root)
            .ok()
            .map(Path::to_path_buf)
    };
    workspace
        .members()
        .iter()
        .map(|package| Member {
            name: package.name.to_string(),
            folder: package
                .manifest_path
                .parent()
                .and_then(|folder| relative(folder.as_std_path()))
                .unwrap_or_default(),
            dependencies: package
                .dependencies
                .iter()
                .map(|dependency| Dependency {
                    name: dependency.name.clone(),
                    rename: dependency.rename.clone(),
                    table: table_name(dependency),
                    folder: dependency
                        .path
                        .as_ref()
                        .and_then(|path| relative(path.as_std_path())),
                })
                .collect(),
        })
        .collect()
}

fn table_name(dependency: &cargo_metadata::Dependency) -> String {
    use cargo_metadata::DependencyKind::{Build, Development};
    let kind = match dependency.kind {
        Development => "dev-dependencies",
        Build => "build-dependencies",
        _ => "dependencies",
    };
    match &dependency.target {
        Some(target) => format!("target.'{target}'.{kind}"),
        None => kind.to_owned(),
    }
}

/// Every edge from a library crate to a member, or to anything else inside the workspace.
pub(super) fn sibling_edges(members: &[Member], files: &[File]) -> Vec<Finding> {
    let libraries = members
        .iter()
        .filter(|member| LIBRARIES.contains(&member.name.as_str()));
    libraries
        .flat_map(|member| {
            let path = format!("{}/Cargo.toml", member.folder.display());
            let named = |dependency: &&Dependency| {
                dependency.folder.is_some() || members.iter().any(|m| m.name == dependency.name)
            };
            member
                .dependencies
                .iter()
                .filter(named)
                .map(|dependency| finding(files, path.clone(), &member.name, dependency))
                .collect::<Vec<_>>()
        })
        .collect()
}

/// Every edge from a crate's fuzz crate to a member other than the crate it attacks.
pub(super) fn fuzz_edges(members: &[Member], files: &[File]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in files {
        let Some(attacked) = file.path.strip_suffix("/fuzz/Cargo.toml") else {
            continue;
        };
        let Ok(manifest) = file.text.parse::<toml::Table>() else {
            findings.push(Finding {
                path: file.path.clone(),
                line: 1,
                rule: RULE,
                message: "no valid TOML".into(),
            });
            continue;
        };
        for dependency in manifest_dependencies(&manifest) {
            let named = |member: &&Member| {
                member.name == dependency.name
                    || dependency.folder.as_deref().is_some_and(|path| {
                        path.file_name().is_some() && path.file_name() == member.folder.file_name()
                    })
            };
            let is_own = |member: &&Member| member.folder == Path::new(attacked);
            if members.iter().filter(named).any(|member| !is_own(&member)) {
                findings.push(finding(files, file.path.clone(), attacked, &dependency));
            }
        }
    }
    findings
}

fn finding(files: &[File], path: String, from: &str, dependency: &Dependency) -> Finding {
    let key = dependency.rename.as_ref().unwrap_or(&dependency.name);
    let text = files
        .iter()
        .find(|file| file.path == path)
        .map_or("", |file| &file.text);
    let line = line_where(text, |line| {
        let line = line.trim_start().trim_start_matches('"');
        line.strip_prefix(key.as_str())
            .is_some_and(|rest| rest.starts_with([' ', '.', '=', '"']))
            || line.starts_with('[') && line.contains(&format!("dependencies.{key}]"))
    });
    let message = format!(
        "{from} names {} under [{}]",
        dependency.name, dependency.table
    );
    Finding {
        path,
        line,
        rule: RULE,
        message,
    }
}

/// All dependency tables of one manifest, those under `[target]` included.
fn manifest_dependencies(manifest: &toml::Table) -> Vec<Dependency> {
    const KINDS: [&str; 3] = ["dependencies", "dev-dependencies", "build-dependencies"];
    let mut tables = vec![(String::new(), manifest)];
    if let Some(targets) = manifest.get("target").and_then(toml::Value::as_table) {
        for (name, target) in targets {
            tables.extend(
                target
                    .as_table()
                    .map(|table| (format!("target.'{name}'."), table)),
            );
        }
    }
    let mut dependencies = Vec::new();
    for (prefix, table) in tables {
        for kind in KINDS {
            let Some(entries) = table.get(kind).and_then(toml::Value::as_table) else {
                continue;
            };
            for (key, value) in entries {
                let field = |name: &str| value.get(name).and_then(toml::Value::as_str);
                let package = field("package");
                dependencies.push(Dependency {
                    name: package.unwrap_or(key).to_owned(),
                    rename: package.map(|_| key.clone()),
                    table: format!("{prefix}{kind}"),
                    folder: field("path").map(PathBuf::from),
                });
            }
        }
    }
    dependencies
}

#[cfg(test)]
mod tests {
    use std::fs;

    use cargo_metadata::MetadataCommand;

    use super::super::file;
    use super::*;

    fn member(name: &str, dependencies: Vec<Dependency>) -> Member {
        Member {
            name: name.into(),
            folder: name.into(),
            dependencies,
        }
    }

    fn dependency(name: &str, table: &str) -> Dependency {
        Dependency {
            name: name.into(),
            table: table.into(),
            ..Dependency::default()
        }
    }

    #[track_caller]
    fn check(from: &str, dependency: Dependency, expected: &[&str]) {
        let members = [member(from, vec![dependency]), member("segidx", vec![])];
        let text = "[package]\n\n[dependencies]\nsegidx.workspace = true\nother = { package = \"segidx\" }\n";
        let files = [file(&format!("{from}/Cargo.toml"), text)];
        let found: Vec<String> = sibling_edges(&members, &files)
            .iter()
            .map(ToString::to_string)
            .collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn every_kind_of_edge_is_found() {
        for table in [
            "dependencies",
            "dev-dependencies",
            "build-dependencies",
            "target.'cfg(unix)'.dependencies",
        ] {
            let message = format!("dtw/Cargo.toml:4: sibling: dtw names segidx under [{table}]");
            check("dtw", dependency("segidx", table), &[&message]);
        }
    }

    #[test]
    fn a_renamed_edge_is_found_where_it_stands() {
        let renamed = Dependency {
            rename: Some("other".into()),
            ..dependency("segidx", "dependencies")
        };
        check(
            "relfeat",
            renamed,
            &["relfeat/Cargo.toml:5: sibling: relfeat names segidx under [dependencies]"],
        );
    }

    #[test]
    fn a_path_into_the_workspace_is_found() {
        let inside = Dependency {
            folder: Some("segidx/fuzz".into()),
            ..dependency("odd", "dependencies")
        };
        check(
            "dtw",
            inside,
            &["dtw/Cargo.toml:1: sibling: dtw names odd under [dependencies]"],
        );
    }

    #[test]
    fn the_wiring_may_name_several() {
        for from in ["cli", "benches", "xtask"] {
            check(from, dependency("segidx", "dependencies"), &[]);
        }
        check("dtw", dependency("ndarray", "dependencies"), &[]);
    }

    /// The tables as cargo itself reports them, so that the rule stands on no assumption of ours.
    #[test]
    fn cargo_reports_each_kind_as_the_rule_reads_it() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        let write = |path: &str, text: &str| {
            let path = root.join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        write(
            "Cargo.toml",
            "[workspace]\nresolver = \"3\"\nmembers = [\"dtw\", \"segidx\"]\n\
             [workspace.dependencies]\nsegidx = { path = \"segidx\" }\n",
        );
        write("segidx/Cargo.toml", "[package]\nname = \"segidx\"\n");
        write("segidx/src/lib.rs", "");
        write("dtw/src/lib.rs", "");
        let tables = [
            (
                "[dependencies]\nsegidx.workspace = true\n",
                4,
                "dependencies",
            ),
            (
                "[dependencies]\nsegidx = { workspace = true, optional = true }\n",
                4,
                "dependencies",
            ),
            (
                "[dev-dependencies]\nsegidx = { path = \"../segidx\" }\n",
                4,
                "dev-dependencies",
            ),
            (
                "[build-dependencies.segidx]\npath = \"../segidx\"\n",
                3,
                "build-dependencies",
            ),
            (
                "[dependencies]\nother = { package = \"segidx\", path = \"../segidx\" }\n",
                4,
                "dependencies",
            ),
            (
                "[target.'cfg(unix)'.dev-dependencies]\nsegidx.workspace = true\n",
                4,
                "target.'cfg(unix)'.dev-dependencies",
            ),
        ];
        for (entries, line, table) in tables {
            let manifest = format!("[package]\nname = \"dtw\"\n{entries}");
            write("dtw/Cargo.toml", &manifest);
            let metadata = MetadataCommand::new()
                .current_dir(&root)
                .no_deps()
                .exec()
                .unwrap();
            let workspace = Workspace {
                target: root.join("target"),
                root: root.clone(),
                metadata,
            };
            let found = sibling_edges(&packages(&workspace), &[file("dtw/Cargo.toml", &manifest)]);
            let found: Vec<String> = found.iter().map(ToString::to_string).collect();
            let expected =
                format!("dtw/Cargo.toml:{line}: sibling: dtw names segidx under [{table}]");
            assert_eq!(found, [expected]);
        }
    }

    #[test]
    fn a_fuzz_crate_may_only_name_its_own() {
        let members = [member("dtw", vec![]), member("segidx", vec![])];
        let manifest = "[dependencies]\nsegidx = { path = \"..\" }\n\
                        [target.'cfg(unix)'.dev-dependencies]\nd = { path = \"../../dtw\" }\n";
        let found = fuzz_edges(&members, &[file("segidx/fuzz/Cargo.toml", manifest)]);
        let found: Vec<String> = found.iter().map(ToString::to_string).collect();
        assert_eq!(
            found,
            ["segidx/fuzz/Cargo.toml:4: sibling: segidx names d under \
              [target.'cfg(unix)'.dev-dependencies]"]
        );
        assert_eq!(
            fuzz_edges(&members, &[file("segidx/fuzz/Cargo.toml", "[")]).len(),
            1
        );
    }
}
