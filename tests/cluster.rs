//! The job array of `docs/cluster.md`, run as Slurm runs it: every task in a process of its own, one of which is killed and run again.

use std::path::Path;
use std::process::{Command, Output};

const PAGE: &str = include_str!("../docs/cluster.md");

/// Parts of the study here; the page has more. And robots of each: so many that a task is killed before it is done with them.
const PARTS: usize = 4;
const ROBOTS: usize = 16;

/// What stands in the place of Slurm. It reads from the script what Slurm reads.
const SBATCH: &str = r#"#!/bin/bash
set -eu
script=${!#}
of() { sed -n "s/^#SBATCH --$1=//p" "$script"; }
array=$(of array)
export SLURM_CPUS_PER_TASK=$(of cpus-per-task)
for SLURM_ARRAY_TASK_ID in $(seq "${array%-*}" "${array#*-}"); do
  export SLURM_ARRAY_TASK_ID
  if [ "$SLURM_ARRAY_TASK_ID" = 2 ]; then
    # Killed when it has found something; the node comes back, and the task is run again.
    setsid bash "$script" & task=$!
    until [ -s part-2/journal.jsonl ]; do sleep 0.01; done
    kill -9 -- "-$task"
    wait "$task" || touch killed
  fi
  bash "$script"
done
"#;

/// The fenced block of the page's chapter about Slurm that has these words.
fn block(words: &str) -> String {
    let chapter = PAGE.split("\n## ").find(|chapter| chapter.starts_with("Slurm")).unwrap();
    let mut blocks = chapter.split("```sh\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    blocks.find(|block| block.contains(words)).unwrap_or_else(|| panic!("no block with {words}")).into()
}

/// The same with as many parts as here. What the page says of their number must agree.
fn with_few_parts(script: &str) -> String {
    let parts: usize = script.split("--array=1-").nth(1).unwrap().lines().next().unwrap().parse().unwrap();
    let shard = format!("--shard $SLURM_ARRAY_TASK_ID/{parts} ");
    assert!(script.contains(&shard), "the array has {parts} tasks, and the study another number of parts");
    script
        .replace(&format!("1-{parts}\n"), &format!("1-{PARTS}\n"))
        .replace(&shard, &shard.replace(&parts.to_string(), &PARTS.to_string()))
}

fn run(folder: &Path, command: &str) {
    let program = Path::new(env!("CARGO_BIN_EXE_piaffe")).parent().unwrap();
    let path = format!("{}:{}:{}", folder.display(), program.display(), std::env::var("PATH").unwrap());
    let mut shell = Command::new("bash");
    let Output { status, stdout, stderr } =
        shell.args(["-ec", command]).current_dir(folder).env("PATH", path).output().unwrap();
    let told = [stdout, stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    assert!(status.success(), "`{command}` fails: {told}");
}

#[test]
fn a_job_array_gives_the_table_of_a_single_machine() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let masses = (0..ROBOTS * PARTS).map(|k| format!("{}\n", 1.4 + 0.005 * k as f64));
    std::fs::write(at("designs.csv"), format!("links.thigh.mass\n{}", masses.collect::<String>())).unwrap();
    std::fs::write(at("study.sh"), with_few_parts(&block("#SBATCH"))).unwrap();
    std::fs::write(at("sbatch"), SBATCH).unwrap();
    run(folder.path(), "chmod +x sbatch");
    run(folder.path(), &block("sbatch"));
    assert!(at("killed").exists(), "no task was killed");
    run(folder.path(), "piaffe study trot --speed 0.6 --designs designs.csv --out whole");
    for name in ["study.csv", "study.html", "study.json"] {
        assert!(
            std::fs::read(at("study").join(name)).unwrap() == std::fs::read(at("whole").join(name)).unwrap(),
            "{name}"
        );
    }
}
