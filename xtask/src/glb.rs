//! Holds GLB files that `mocap-io` writes against Khronos' glTF validator.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::node::{need_node, need_package};
use crate::workspace::{self, DATA, Workspace, capture, text};

/// The registry has no version without `dev`.
const VALIDATOR: &str = "gltf-validator@2.0.0-dev.3.10";

/// Prints a line per file and every issue; fails if a file has an error or a warning.
const SCRIPT: &str = "
const { readFileSync } = require('fs');
const { basename } = require('path');
const { validateBytes } = require('gltf-validator');
(async () => {
  for (const file of process.argv.slice(1)) {
    const { issues } = await validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 100 });
    console.log(`glb: ${basename(file)}: ${issues.numErrors} errors, ${issues.numWarnings} warnings`);
    for (const issue of issues.messages) {
      console.log(`  ${issue.code} at ${issue.pointer ?? `byte ${issue.offset}`}: ${issue.message}`);
    }
    if (issues.numErrors + issues.numWarnings > 0) process.exitCode = 1;
  }
})();
";

/// Small files of the kinds that real ones seldom are: name and text.
const ODD_FILES: [(&str, &str); 5] = [
    (
        "one_joint",
        "HIERARCHY ROOT a { OFFSET 1 2 3 CHANNELS 1 Yrotation } MOTION Frames: 1\nFrame Time: 1\n90\n",
    ),
    (
        "no_frames",
        "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Yrotation End Site { OFFSET 0 170 0 } } MOTION Frames: 0\nFrame Time: 1\n",
    ),
    (
        "nothing_moves",
        "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 0 End Site { OFFSET 0 170 0 } } MOTION Frames: 0\nFrame Time: 1\n",
    ),
    (
        "two_roots_of_one_name",
        "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Yrotation End Site { OFFSET 0 170 0 } }
         ROOT a { OFFSET 50 0 0 CHANNELS 1 Xposition End Site { OFFSET 0 170 0 } }
         MOTION Frames: 2\nFrame Time: 1\n0 50\n180 60\n",
    ),
    (
        "bones_without_length",
        "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 3 Zrotation Yrotation Xrotation
         JOINT b { OFFSET 0 0 0 CHANNELS 3 Zrotation Yrotation Xrotation End Site { OFFSET 0 0 0 } } }
         MOTION Frames: 2\nFrame Time: 1\n0 0 0 0 0 0\n720 90 -90 270 1e-9 0\n",
    ),
];

/// Real files, one of each kind of rig, below the data folder.
const REAL_FILES: [&[&str]; 8] = [
    &["bvh/cgspeed/02/02_01.bvh"],
    &["bvh/mass/walk.bvh"],
    &["tricky/bvh/AnimatedDrawings_jesse_dance.bvh"],
    &["tricky/bvh/iclone_002_03.bvh"],
    &["tricky/bvh/XBMotionGraph_input1.bvh"],
    &["cmu/02/02.asf", "cmu/02/02_01.amc"],
    &[
        "hdm05/depositFloorR/HDM_bd.asf",
        "hdm05/depositFloorR/HDM_bd_depositFloorR_001_120.amc",
    ],
    &[
        "tricky/asfamc/Forrest.ASF",
        "tricky/asfamc/Forrest.Spinning.AMC",
    ],
];

/// Writes GLB files, installs the validator below the target folder if it is not there, and runs it.
pub(crate) fn run(workspace: &Workspace) -> Result<()> {
    let folder = workspace.target.join("glb");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    // With the features of the whole workspace, whose builds are there already.
    let build = ["build", "--quiet", "--workspace", "--example", "glb"];
    workspace::run(workspace.cargo().args(build))?;
    let example = format!("debug/examples/glb{}", env::consts::EXE_SUFFIX);
    let example = workspace.target.join(example);
    let mut written = Vec::new();
    let mut write = |name: &str, arguments: &[PathBuf], options: &[&str]| -> Result<()> {
        let out = folder.join(format!("{name}.glb"));
        let mut command = Command::new(&example);
        workspace::run(command.args(options).args(arguments).arg(&out))?;
        written.push(out);
        Ok(())
    };
    write("bow", &[], &[])?;
    write("bow_z_up", &[], &["--up", "z"])?;
    write("markers_with_gaps", &[], &["--markers"])?;
    for (name, bvh) in ODD_FILES {
        let path = folder.join(name).with_extension("bvh");
        fs::write(&path, bvh).with_context(|| format!("cannot write {}", path.display()))?;
        write(name, &[path], &[])?;
    }
    match workspace.recordings() {
        None => println!("glb: no real files, {DATA} is not set"),
        Some(data) => {
            for paths in REAL_FILES {
                let paths: Vec<PathBuf> = paths.iter().map(|path| data.join(path)).collect();
                let name = paths.last().and_then(|path| path.file_name());
                let name = name.context("a path ends in a name")?.to_string_lossy();
                write(&name, &paths, &[])?;
            }
        }
    }
    validate(&folder, &written)
}

fn validate(folder: &Path, files: &[PathBuf]) -> Result<()> {
    need_node("glb: the glTF validator")?;
    need_package(folder, VALIDATOR)?;
    let mut node = Command::new("node");
    // Modules are looked for from the current folder.
    node.current_dir(folder)
        .args(["-e", SCRIPT, "--"])
        .args(files);
    let output = capture(&mut node)?;
    print!("{}", text(&output.stdout));
    ensure!(
        output.status.success(),
        "glb: the validator is not content\n{}",
        text(&output.stderr)
    );
    Ok(())
}
