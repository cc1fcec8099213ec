//! How generation grows with the robot: a planar chain of n links, from link to link with the platform in its middle.
//!
//! `cargo run --release -p piaffe-codegen --example growth [LARGEST]` prints a table: time to derive all kernels of the
//! gait, to factor them, to write them; operations of some; and what rustc takes for the module at -O.

use piaffe_codegen::dynamics::kernels;
use piaffe_codegen::emit::{Embedding, embedding_source};
use piaffe_codegen::mechanism::Mechanism;
use piaffe_codegen::program::Program;
use piaffe_codegen::spec::{parse_gait, parse_robot};
use piaffe_codegen::{RobotFiles, SpecFile, generate};
use std::fmt::Write;
use std::process::Command;
use std::sync::LazyLock;
use std::time::Instant;

const KERNELS: [&str; 4] = ["inertia_and_bias", "inverse1", "inverse_jacobian1", "curvature1"];

fn main() {
    let largest = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(16);
    print!("| links | derive, s | factor, s | all, s | source, kB | rustc -O, s |");
    println!("{}", KERNELS.map(|k| format!(" {k} |")).concat());
    println!("|{}", "---:|".repeat(6 + KERNELS.len()));
    for links in (2..=largest).step_by(2) {
        println!("{}", row(links));
    }
}

/// Seconds that all threads have run, where the system tells (Linux); else seconds since the first call.
fn processor_time() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let Ok(threads) = std::fs::read_dir("/proc/self/task") else { return START.elapsed().as_secs_f64() };
    let told = threads.filter_map(|t| std::fs::read_to_string(t.ok()?.path().join("schedstat")).ok());
    told.filter_map(|t| t.split(' ').next()?.parse::<f64>().ok()).sum::<f64>() * 1e-9
}

fn row(links: usize) -> String {
    let (robot, gait) = chain(links / 2);
    let parsed = parse_robot(&robot.path, &robot.text).expect("the chain is a robot");
    let of_gait = parse_gait(&gait.path, &gait.text, &parsed).expect("the chain has a gait");
    let mechanism = Mechanism::new(&parsed.robot, &of_gait);
    let start = processor_time();
    let (model, kernels) = kernels(&mechanism);
    let derive = processor_time() - start;
    let programs: Vec<(&str, usize)> =
        kernels.iter().map(|k| (k.name.as_str(), Program::new(&model.ring, k).operations().flops)).collect();
    let factor = processor_time() - start - derive;
    let start = processor_time();
    let embedding = Embedding::new(&mechanism);
    let source = embedding.functions().and_then(|functions| embedding_source(&functions, None, "growth"));
    let source = source.expect("the chain can be written");
    let all = processor_time() - start;
    let files = RobotFiles { module: "chain".into(), robot, gaits: vec![gait] };
    let files = generate(&[files], None).expect("the chain is generated");
    let rustc = compile(&files);
    let mut line = format!("| {links} | {derive:.2} | {factor:.2} | {all:.2} | {} | {rustc:.1} |", source.len() / 1000);
    for kernel in KERNELS {
        let flops = programs.iter().find(|(name, _)| *name == kernel).map_or(0, |(_, flops)| *flops);
        let _ = write!(line, " {flops} |");
    }
    line
}

/// A robot with legs of `links` links each, fore and hind, whose platform pitches.
fn chain(links: usize) -> (SpecFile, SpecFile) {
    let mut text = String::from(
        "name = \"chain\"\ngravity = 9.81\n[links.platform]\nmass = 6.0\ninertia = { pitch = 0.3, roll = 0.2, yaw = 0.5 }\n",
    );
    for k in 1..=links {
        let parent = if k == 1 { "platform".to_string() } else { format!("link{}", k - 1) };
        let (mass, com) = (1.0 + 0.1 * k as f64, 0.05 + 0.003 * k as f64);
        let _ = write!(
            text,
            "[links.link{k}]\nmass = {mass:?}\nlength = 0.15\ncom = {com:?}\n\
             inertia = {{ swing = 0.002, lateral = 0.002, axial = 0.0 }}\n\
             [joints.joint{k}]\nparent = \"{parent}\"\nchild = \"link{k}\"\nrange = [-1.0, 1.0]\nactuator = \"motor\"\n"
        );
    }
    text += "[legs]\n";
    for (leg, x, z) in
        [("fore_left", 0.2, -0.1), ("fore_right", 0.2, 0.1), ("hind_left", -0.2, -0.1), ("hind_right", -0.2, 0.1)]
    {
        let _ = writeln!(text, "{leg} = {{ mount = [{x:?}, 0.0, {z:?}] }}");
    }
    text += "[actuators.motor]\ngear = 50.0\nmax_torque = 0.8\n\
             max_speed = { unloaded = 5000.0, at_max_torque = 3300.0 }\nrotor_inertia = 0.0\n";
    let gait = "virtual_legs = [[\"hind_left\", \"hind_right\"], [\"fore_left\", \"fore_right\"]]\n\
                platform = { moves = [\"x\", \"y\"], rotates = \"pitch\" }\nunactuated = \"platform\"\n\
                half_steps = \"distinct\"\n[limits]\nfriction = 1.0\nmin_vertical_force = 10.0\n\
                swing_clearance = 0.005\nhalf_step_duration = [0.05, 0.5]\n";
    let file = |path: &str, text: String| SpecFile { path: path.into(), text };
    (file("chain.toml", text), file("walk.toml", gait.into()))
}

/// Seconds that rustc takes for a library with the generated module.
fn compile(files: &[(String, String)]) -> f64 {
    let folder = std::env::temp_dir().join(format!("piaffe-growth-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder is writable");
    let library = "include!(concat!(env!(\"OUT_DIR\"), \"/gaits.rs\"));\n".to_string();
    for (name, text) in files.iter().map(|(n, t)| (n.as_str(), t)).chain([("lib.rs", &library)]) {
        let path = folder.join(name);
        let written = path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(&path, text));
        written.expect("the temporary folder is writable");
    }
    let start = Instant::now();
    let status = Command::new("rustc")
        .args(["--edition=2024", "--crate-type=lib", "-Copt-level=3", "-Cdebuginfo=1", "--cap-lints=allow", "lib.rs"])
        .current_dir(&folder)
        .env("OUT_DIR", &folder)
        .status();
    let seconds = start.elapsed().as_secs_f64();
    let _ = std::fs::remove_dir_all(&folder);
    assert!(status.is_ok_and(|s| s.success()), "rustc refuses what was generated");
    seconds
}
