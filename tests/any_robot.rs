//! Any robot, as it stands in its files, without a compiler: the program as a person runs it.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::{TempDir, tempdir};

const STORK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/any_robot/stork");
const SHIPPED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec");

fn piaffe_in(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_piaffe")).args(arguments.split_whitespace()).current_dir(folder).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// What is printed, of a run that ends well and says nothing on standard error but these words.
#[track_caller]
fn succeeds(folder: &Path, arguments: &str, note: &str) -> String {
    let out = piaffe_in(folder, arguments);
    let told = text(&out.stderr);
    assert!(out.status.success() && told.contains(note), "{arguments}: {told}{}", text(&out.stdout));
    // How long it takes is the machine's.
    let lines = told.lines().filter(|line| !line.starts_with("note: still searching"));
    assert!(lines.count() <= usize::from(!note.is_empty()), "{told}");
    text(&out.stdout)
}

#[track_caller]
fn fails(folder: &Path, arguments: &str, code: i32, words: &str) {
    let out = piaffe_in(folder, arguments);
    let told = text(&out.stderr);
    assert!(out.status.code() == Some(code) && told.contains(words), "{arguments}: {:?} {told}", out.status);
}

fn result(folder: &Path, arguments: &str, note: &str) -> Value {
    serde_json::from_str(&succeeds(folder, &format!("{arguments} --json -"), note)).unwrap()
}

/// All but how long it took.
fn timeless(mut result: Value) -> Value {
    result["seconds"] = 0.into();
    result
}

/// A folder with a copy of what is shipped, in which `from` is `to`.
fn edited(from: &str, to: &str) -> TempDir {
    let folder = tempdir().unwrap();
    copy(Path::new(SHIPPED), &folder.path().join("model-spec"));
    let robot = folder.path().join("model-spec/robot.toml");
    let text = std::fs::read_to_string(&robot).unwrap();
    assert!(text.contains(from));
    std::fs::write(&robot, text.replace(from, to)).unwrap();
    folder
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let (entry, name) = (entry.as_ref().unwrap().path(), entry.as_ref().unwrap().file_name());
        if entry.is_dir() { copy(&entry, &to.join(name)) } else { assert!(std::fs::copy(entry, to.join(name)).is_ok()) }
    }
}

#[test]
fn a_robot_that_nobody_built_walks_and_its_result_is_good_anywhere() {
    let folder = tempdir().unwrap();
    let walks = format!("optimize stalk --speed 0.5 --starts 3 --robot {STORK} --json stalk.json");
    let told = succeeds(folder.path(), &walks, "");
    assert!(told.contains("stalk of stork, least energy at 0.5 m/s: local optimum, receipt holds"), "{told}");
    // The result says what it is of: nothing else is needed.
    let of_others = "of the robot whose files it carries";
    let told = succeeds(folder.path(), "verify stalk.json", "");
    assert!(told.contains("stalk-energy-0.5, confirmed") && told.contains(of_others), "{told}");
    assert!(!succeeds(folder.path(), &format!("verify stalk.json --robot {STORK}"), "").contains(of_others));
    assert!(succeeds(folder.path(), "export stalk.json --format csv --rate 100", "").lines().count() > 10);
    assert!(succeeds(folder.path(), "export stalk.json --format mjcf", "").contains("left_metatarsus"));
    // On the ground it would fall over to the side, which a model in the plane does not know.
    succeeds(folder.path(), "lift stalk.json --rate 100", "the real legs cannot move so");
    assert!(succeeds(folder.path(), "report stalk.json --out page", "").contains("index.html"));
    assert!(succeeds(folder.path(), &format!("model stalk --robot {STORK}"), "").contains("ankle2"));

    // What it carries is what is verified: another number there is another robot.
    let text = std::fs::read_to_string(folder.path().join("stalk.json")).unwrap();
    std::fs::write(folder.path().join("heavier.json"), text.replace("mass = 5.0 ", "mass = 5.5 ")).unwrap();
    let out = piaffe_in(folder.path(), "verify heavier.json");
    assert_eq!(out.status.code(), Some(4), "{}", self::text(&out.stdout));
    std::fs::write(folder.path().join("broken.json"), text.replace("mass = 5.0 ", "mess = 5.0 ")).unwrap();
    let out = piaffe_in(folder.path(), "verify broken.json");
    let told = self::text(&out.stdout);
    assert!(out.status.code() == Some(4) && told.contains("did you mean `mass`?"), "{told}");
}

#[test]
fn a_sweep_of_any_robot_is_confirmed_as_a_whole() {
    let folder = tempdir().unwrap();
    let sweep = format!("sweep --robot {STORK} --criterion torque --speeds 0.4,0.5 --starts 2 --out sweep");
    succeeds(folder.path(), &sweep, "");
    assert!(succeeds(folder.path(), "verify sweep", "").contains("sweep.json"));
}

/// The program has these robots in itself. Whether it asks them or their files makes no difference.
#[test]
fn files_lead_to_the_result_of_the_built_robot() {
    let folder = tempdir().unwrap();
    for (gait, robot) in [("trot", SHIPPED.to_string()), ("curvet", SHIPPED.to_string())] {
        let ask = format!("optimize {gait} --speed 0.6 --starts 1");
        let built = timeless(result(folder.path(), &ask, ""));
        assert_eq!(timeless(result(folder.path(), &format!("{ask} --robot {robot}"), "")), built, "{gait}");
    }
}

#[test]
fn a_number_set_for_a_run_is_the_number_in_the_file() {
    let (here, folder) = (tempdir().unwrap(), edited("mass = 1.6 ", "mass = 1.25 "));
    let ask = "optimize trot --speed 0.6 --starts 1";
    let note =
        "note: model-spec/robot.toml has changed since this program was built: it takes the files as they are now";
    let of_file = timeless(result(folder.path(), ask, note));
    // Of the robot in the program, which needs no files.
    let set = timeless(result(here.path(), &format!("{ask} --set links.thigh.mass=1.25"), ""));
    assert_eq!(set, of_file);
    let as_built = timeless(result(here.path(), ask, ""));
    assert!(set["cost"].as_f64() < as_built["cost"].as_f64(), "{}", set["cost"]);
    assert_ne!(set["fingerprint"], as_built["fingerprint"]);
    // Over a changed file, and of a gait.
    let both = format!("{ask} --set links.thigh.mass=1.6 --set limits.swing_clearance=0.01");
    let both = timeless(result(folder.path(), &both, "has changed"));
    assert_eq!(both, timeless(result(here.path(), &format!("{ask} --set limits.swing_clearance=0.01"), "")));

    // Each is confirmed by any program.
    std::fs::write(here.path().join("light.json"), serde_json::to_string(&set).unwrap()).unwrap();
    std::fs::write(here.path().join("built.json"), serde_json::to_string(&as_built).unwrap()).unwrap();
    assert_eq!(succeeds(here.path(), "verify light.json built.json", "").matches(", confirmed").count(), 2);
    assert!(
        succeeds(folder.path(), &format!("verify {}", here.path().join("built.json").display()), "")
            .contains(", confirmed")
    );
}

#[test]
fn what_is_no_robot_is_said_with_its_place_and_a_remedy() {
    let here = tempdir().unwrap();
    let trot = "optimize trot --speed 0.6";
    fails(here.path(), &format!("{trot} --set links.thigh.mas=1"), 1, "did you mean `links.thigh.mass`?");
    fails(here.path(), &format!("{trot} --set links.thigh.mass=heavy"), 2, "`heavy` is not a number");
    fails(here.path(), &format!("{trot} --set links.thigh.mass=-1"), 1, "mass = -1");
    fails(here.path(), &format!("{trot} --set links.thigh.inertia.axial=1"), 1, "robot.toml:");
    fails(here.path(), &format!("{trot} --robot nowhere"), 1, "nowhere");
    fails(here.path(), &format!("optimize trot --speed 0.6 --robot {STORK}"), 2, "[possible values: stalk]");
    fails(here.path(), &format!("check {STORK} --set gravity=1"), 2, "--set");
    // What is wrong is told, not what other robots have.
    for (typed, words) in [
        ("optimize stalk", "--speed"),
        ("optimize stalk --speed 0", "no positive number"),
        ("optimize stalk --speed 0.6 --criterion enrgy", "energy"),
        ("optimize stalk --speed 0.6 --friction 0", "more than 0"),
        ("optimize stalk --speed 0.6 --bogus", "--bogus"),
        ("sweep --speeds 0.6..0.2:0.1", "ends below its beginning"),
    ] {
        let out = piaffe_in(here.path(), &format!("{typed} --robot {STORK}"));
        let told = text(&out.stderr);
        assert!(out.status.code() == Some(2) && told.contains(words) && !told.contains("curvet"), "{typed}: {told}");
    }
    let help = succeeds(here.path(), &format!("optimize --help --robot {STORK}"), "");
    assert!(help.contains("stalk") && !help.contains("curvet"), "{help}");

    let folder = edited("mass = 1.6 ", "masss = 1.6 ");
    fails(folder.path(), trot, 1, "model-spec/robot.toml:");
    fails(folder.path(), trot, 1, "did you mean `mass`?");
    // Which does not keep other robots from walking.
    succeeds(folder.path(), "model rabbit/walk", "");
}

/// Limits and loads that are asked for are those of the files that say the same.
#[test]
fn what_is_asked_for_beside_the_files_is_what_files_would_say() {
    let folder = tempdir().unwrap();
    let optimum =
        |asked: &str| timeless(result(folder.path(), &format!("optimize trot --speed 0.6 --starts 1 {asked}"), ""));
    let same = [
        ("--friction 0.9", "--set limits.friction=0.9"),
        ("--clearance 0.01", "--set limits.swing_clearance=0.01"),
        ("--min-force 20", "--set limits.min_vertical_force=20"),
        ("--platform-height 0.2", "--set limits.min_platform_height=0.2"),
        (
            "--duration 0.1,0.22",
            "--set limits.half_step_duration.shortest=0.1 --set limits.half_step_duration.longest=0.22",
        ),
        ("--torque-scale 0.5", "--set actuators.haunch_motor.max_torque=0.2 --set actuators.knee_motor.max_torque=0.2"),
    ];
    let plain = optimum("");
    for (option, setting) in same {
        let asked = optimum(option);
        assert!(asked == optimum(setting), "{option}");
        assert_ne!(asked["fingerprint"], plain["fingerprint"], "{option}");
    }
    let cost = |result: &Value| result["cost"].as_f64().unwrap();
    assert!(cost(&optimum("--duration 0.1,0.22")) > cost(&plain));
    // A kilogram at the mass centre is a heavier platform; anywhere in a platform that neither pitches nor rolls it weighs the same.
    let heavier = optimum("--set links.platform.mass=7.65");
    assert!((cost(&optimum("--payload 1@0,0,0")) / cost(&heavier) - 1.0).abs() < 1e-9);
    assert!(cost(&heavier) > 1.05 * cost(&plain));
    // The file says nothing of friction, and can be told.
    assert!(cost(&optimum("--set joints.haunch.damping=0.2")) > 1.001 * cost(&plain));
    let flying =
        |asked: &str| result(folder.path(), &format!("optimize running_trot --speed 1 --starts 1 {asked}"), "");
    let slow = flying("--duration 0.2,0.5");
    assert!(slow["durations"][0].as_f64().unwrap() >= 0.2 && slow["durations"][1].as_f64().unwrap() < 0.1, "{slow}");
    fails(folder.path(), "optimize trot --speed 0.6 --payload 1", 2, "MASS@X,Y,Z");
    fails(folder.path(), "optimize trot --speed 0.6 --friction 0", 2, "more than 0");
    fails(folder.path(), "optimize trot --speed 0.6 --duration 0.5,0.1", 2, "shorter one first");
    fails(folder.path(), "verify --friction 1 x.json", 2, "results carry what they are of");
}

/// Editors that begin a text with a byte-order mark change nothing in it, nor the places of mistakes.
#[test]
fn a_byte_order_mark_is_passed_over() {
    let folder = tempdir().unwrap();
    let trot = "optimize trot --speed 0.6 --starts 1 --set links.thigh.mass=1.2 --set limits.min_platform_height=0.1";
    let plain = result(folder.path(), &format!("{trot} --robot {SHIPPED}"), "");
    copy(Path::new(SHIPPED), &folder.path().join("dog"));
    let marked = |file: &str| {
        let file = folder.path().join(file);
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, format!("\u{feff}{text}")).unwrap();
    };
    marked("dog/robot.toml");
    marked("dog/gaits/trot.toml");
    let found = result(folder.path(), &format!("{trot} --robot dog"), "");
    assert_eq!((&found["cost"], &found["fingerprint"]), (&plain["cost"], &plain["fingerprint"]));
    std::fs::write(folder.path().join("found.json"), format!("\u{feff}{found}")).unwrap();
    succeeds(folder.path(), "verify found.json", "");
    std::fs::write(folder.path().join("dog/robot.toml"), "\u{feff}nam = \"dog\"\n").unwrap();
    let told = text(&piaffe_in(folder.path(), "check dog").stderr);
    assert!(told.contains("robot.toml:1:1") && !told.contains(['\u{feff}', '\u{fffd}']), "{told}");
}

/// A change that makes one gait impossible stands in nobody's way who asks for another, and is told to who asks for that one.
#[test]
fn a_gait_that_is_not_asked_about_forbids_nothing() {
    let emu = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/friction/emu");
    let robot = piaffe::Robot::read(emu).unwrap().with("phases.2.duration.longest", 0.05).unwrap();
    assert_eq!(robot.gaits(), ["run", "skip"]);
    let run = robot.gait("run").unwrap();
    assert_eq!(piaffe::model::Gait::description(&run).phases[1].duration, [0.02, 0.05]);
    let why = robot.gait("skip").err().unwrap().to_string();
    assert!(why.contains("with what is asked for") && why.contains("`phases.2.duration` does not rise"), "{why}");
    // What makes no robot, or none of its gaits, is told at once.
    assert!(robot.with("links.femur.mass", -1.0).is_err());
    assert!(piaffe::Robot::read(emu).unwrap().with("phases.1.duration.longest", 0.01).is_err());
}
