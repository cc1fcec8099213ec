//! Files on which imports fell short, each the smallest of its kind, with what is right: in `tests/import/`. What is imported
//! passes the specification's checks; what is not says everything that is in the way, each with where it is and a remedy.

#[path = "import/given.rs"]
mod given;

use given::given;
use piaffe::import::{Fault, Import, Kind, Options, import};
use piaffe_codegen::spec::{Robot, Then, parse_gait, parse_robot};
use piaffe_codegen::{RobotFiles, SpecFile, check};

fn text(file: &str) -> String {
    let path = format!("{}/tests/import/{file}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// What an import must give: a specification that builds, in a folder of its own.
fn builds(made: &Import) -> Robot {
    let file = |path: &str, text: &str| SpecFile { path: path.into(), text: text.into() };
    let gaits = made.gaits.iter().map(|(name, text)| file(name, text)).collect();
    check(&[RobotFiles { module: made.folder.clone(), robot: file("robot.toml", &made.robot), gaits }])
        .unwrap_or_else(|e| panic!("{e}"));
    let robot = parse_robot("robot.toml", &made.robot).unwrap_or_else(|e| panic!("{}", e[0]));
    assert!(!made.gaits.is_empty());
    for (name, text) in &made.gaits {
        parse_gait(name, text, &robot).unwrap_or_else(|e| panic!("{}", e[0]));
    }
    robot.robot
}

fn imported(file: &str) -> (Import, Robot) {
    with(file, &[])
}

/// With options, written as on the command line.
fn with(file: &str, options: &[(&str, &str)]) -> (Import, Robot) {
    let made = import(&text(file), &given(options)).unwrap_or_else(|e| panic!("{file}: {e}"));
    let robot = builds(&made);
    (made, robot)
}

fn refused(file: &str) -> Vec<Fault> {
    let faults = import(&text(file), &Options::default()).expect_err(file).0;
    assert!(faults.iter().all(|f| !f.remedy.is_empty()), "{faults:#?}");
    faults
}

fn gaits(made: &Import) -> Vec<&str> {
    made.gaits.iter().map(|(name, _)| name.as_str()).collect()
}

fn says(made: &Import, words: &str) -> bool {
    made.notes.iter().any(|note| note.contains(words)) && made.robot.contains(words)
}

/// What follows the phases of a gait.
fn then(made: &Import, gait: &str) -> Then {
    let robot = parse_robot("robot.toml", &made.robot).unwrap();
    let (name, text) = made.gaits.iter().find(|(name, _)| name == gait).unwrap();
    parse_gait(name, text, &robot).unwrap().phases.then
}

#[test]
fn a_plain_quadruped_trots_and_bounds() {
    let (made, robot) = imported("00-control-ok.urdf");
    assert_eq!(gaits(&made), ["trot.toml", "bound.toml"]);
    assert_eq!(then(&made, "trot.toml"), Then::Mirrored);
    assert_eq!(robot.legs[0].chain[1].link.end, [0.0, -0.2, 0.0]);
}

#[test]
fn stops_beyond_a_turn_become_a_turn() {
    let (made, robot) = imported("01-continuous-hip.urdf");
    assert!(says(&made, "one turn to either side"));
    let [low, high] = robot.legs[0].chain[0].joint.range;
    let turn = std::f64::consts::TAU;
    assert!(high <= turn && turn - high < 1e-6 && low == -high);
    let wide = text("00-control-ok.urdf").replace(r#"lower="-1.5" upper="1.5""#, r#"lower="-9.42" upper="9.42""#);
    let made = import(&wide, &Options::default()).unwrap();
    assert!(says(&made, "cut to one turn"));
    assert_eq!(builds(&made).legs[0].chain[0].joint.range, [low, high]);
}

#[test]
fn what_is_dropped_anyway_refuses_no_file() {
    for file in ["03-two-materials.urdf", "11-comment-rest-in-geometry.urdf"] {
        assert_eq!(imported(file).1, imported("00-control-ok.urdf").1, "{file}");
    }
    let odd = text("00-control-ok.urdf")
        .replace("<robot name=\"q\">", "<robot name=\"q\"><gazebo:plugin/><unknown a=\"1\"><b/></unknown>")
        .replace(
            "<link name=\"fl_foot\"/>",
            "<link name=\"fl_foot\"><visual><geometry><mesh/></geometry></visual></link>",
        );
    let odd = format!("\n\n{odd}\0\n");
    assert_eq!(builds(&import(&odd, &Options::default()).unwrap()), imported("00-control-ok.urdf").1);
}

#[test]
fn what_a_file_rounds_is_made_alike() {
    let (made, robot) = imported("04-left-right-differ-by-15um-in-the-virtual-leg.urdf");
    assert!(says(&made, "made alike"));
    assert_eq!(then(&made, "trot.toml"), Then::Mirrored);
    assert!((robot.legs[0].chain[0].link.com[0] - 0.010015).abs() < 1e-12);
    let (made, robot) = imported("cad.urdf");
    assert_eq!(then(&made, "walk.toml"), Then::Mirrored);
    assert!((robot.legs[1].chain[1].link.mass - 1.00015).abs() < 1e-12);
    // Where a person wants them as they are, the phases are two.
    let (made, robot) = with("cad.urdf", &[("--alike", "0")]);
    assert_eq!(then(&made, "walk.toml"), Then::Repeat);
    assert_eq!(robot.legs[1].chain[1].link.mass, 1.0003);
}

#[test]
fn counterparts_keep_to_the_stops_that_they_share() {
    let (made, robot) = imported("05-fore-hind-range-differ.urdf");
    assert_eq!(gaits(&made), ["trot.toml", "bound.toml"]);
    assert!(says(&made, "the stops of `fl_hip`") && says(&made, "the stops of `hl_hip`"));
    // To the left in the file, to the right in the specification.
    for leg in &robot.legs {
        assert_eq!(leg.chain[0].joint.range, [-3.4, 0.5]);
    }
}

#[test]
fn legs_that_bend_opposite_ways_bound() {
    let (made, _) = imported("06-fore-hind-mirrored-legs.urdf");
    assert_eq!(gaits(&made), ["bound.toml"]);
    assert!(says(&made, "bend opposite ways"));
}

#[test]
fn all_that_is_missing_is_said_at_once_and_can_be_given() {
    let faults = refused("08-no-limit-element.urdf");
    assert_eq!(faults.len(), 12);
    assert!(
        faults
            .iter()
            .all(|f| f.kind == Kind::Limit && f.place.as_ref().is_some_and(|p| [9, 16, 23, 30].contains(&p.line)))
    );
    let shown = piaffe::import::ImportError(faults).to_string();
    for option in ["--effort", "--velocity", "--range"] {
        assert_eq!(shown.matches(&format!("{option} JOINT=")).count(), 1, "{shown}");
    }
    let (_, robot) =
        with("08-no-limit-element.urdf", &[("--effort", "30"), ("--velocity", "20"), ("--range", "*_hip=-1.5,1.5")]);
    assert_eq!(robot, imported("00-control-ok.urdf").1);
}

#[test]
fn gears_and_rotors_are_taken_over() {
    let (made, robot) = imported("09-transmission.urdf");
    let knee = |leg: usize| &robot.legs[leg].chain[1].joint.actuator;
    for leg in 0..4 {
        assert_eq!((knee(leg).gear, knee(leg).rotor_inertia, knee(leg).max_torque), (50.0, 0.0003, 0.6));
        assert!((knee(leg).unloaded_speed - 20.0 * 50.0 * 60.0 / std::f64::consts::TAU).abs() < 1e-6);
    }
    assert_eq!(robot.legs[0].chain[0].joint.actuator.gear, 1.0);
    assert!(says(&made, "the gear of `fr_knee` is the one that the file gives for its counterpart"));
    let (_, given) = with("00-control-ok.urdf", &[("--gear", "*_knee=50"), ("--rotor", "*_knee=0.0003")]);
    assert_eq!(given, robot);
}

#[test]
fn a_robot_that_faces_elsewhere_is_asked_about() {
    let faults = refused("12-y-forward.urdf");
    assert!(matches!(&faults[..], [f] if f.kind == Kind::Axes && f.remedy.contains("--forward y")), "{faults:?}");
    let (made, robot) = with("12-y-forward.urdf", &[("--forward", "y")]);
    assert_eq!(gaits(&made), ["trot.toml", "bound.toml"]);
    let control = imported("00-control-ok.urdf").1;
    for (a, b) in robot.legs.iter().zip(&control.legs) {
        assert_eq!(a.mount, b.mount);
    }
    // Facing backward, and lying on its side.
    let plain = text("00-control-ok.urdf");
    let backward =
        plain.replace("xyz=\"0.2 ", "xyz=\"T ").replace("xyz=\"-0.2 ", "xyz=\"0.2 ").replace("\"T ", "\"-0.2 ");
    let names = [("fl_", "front_l_"), ("fr_", "front_r_"), ("hl_", "hind_l_"), ("hr_", "hind_r_")];
    let backward = names.iter().fold(backward, |text, (from, to)| text.replace(from, to));
    let faults = import(&backward, &Options::default()).expect_err("faces backward").0;
    assert!(faults[0].kind == Kind::Axes && faults[0].remedy.contains("--forward -x"));
    // y up: (x, y, z) of the file become (x, −z, y).
    let aside = |text: &str| {
        let mut out = String::new();
        let mut rest = text;
        while let Some(at) = rest.find("xyz=\"") {
            let (head, tail) = rest.split_at(at + 5);
            let end = tail.find('"').unwrap();
            let p: Vec<f64> = tail[..end].split(' ').map(|x| x.parse().unwrap()).collect();
            out += &format!("{head}{} {} {}", p[0], p[2], -p[1]);
            rest = &tail[end..];
        }
        out + rest
    };
    let faults = import(&aside(&plain), &Options::default()).expect_err("lies on its side").0;
    assert!(faults[0].kind == Kind::Axes && faults[0].remedy.contains("--up y"), "{faults:?}");
    let options = given(&[("--forward", "x"), ("--up", "y")]);
    builds(&import(&aside(&plain), &options).unwrap());
}

#[test]
fn a_head_is_no_leg() {
    let (made, robot) = imported("14-head-is-a-leg.urdf");
    assert_eq!(robot.legs.len(), 4);
    assert!(says(&made, "`neck` is held at 0 rad") && says(&made, "does not reach the ground"));
    assert!((robot.platform.mass - 8.3).abs() < 1e-12);
}

#[test]
fn names_are_distinct_and_stay_on_their_line() {
    let (_, robot) = imported("15-name-clash.urdf");
    let names: Vec<&str> = robot.legs.iter().map(|leg| leg.chain[0].link.name.as_str()).collect();
    assert_eq!(names, ["leg_a_2", "leg_a", "hl_thigh", "hr_thigh"]);
    let hostile = text("00-control-ok.urdf")
        .replace("name=\"q\"", "name=\"a&#10;evil = 1&#x202e;&#x2028;\"")
        .replace("\"fl_hip\"", "\"fl&#10;[x]&#x202e;hip\"");
    let made = import(&hostile, &Options::default()).unwrap();
    builds(&made);
    let hidden = |c: char| (c.is_control() && c != '\n') || "\u{202e}\u{2028}".contains(c);
    assert!(!made.robot.contains(hidden) && !made.robot.lines().any(|l| l.starts_with("evil") || l.starts_with("[x]")));
    assert!(made.notes.iter().all(|n| !n.contains(|c: char| c == '\n' || hidden(c))));
}

#[test]
fn a_number_that_is_none_is_named_with_its_place() {
    let faults = refused("16-bad-number.urdf");
    let shown = faults[0].to_string();
    assert!(shown.contains("line 9") && shown.contains("<limit>") && shown.contains("lower=\"-1.5.\""), "{shown}");
}

#[test]
fn every_fault_has_its_place_and_remedy() {
    let faults = refused("17-massless-link-between.urdf");
    assert!(matches!(&faults[..], [f] if f.kind == Kind::Inertia && f.remedy.contains("--lock fl_hip")));
    let faults = refused("19-two-refusals-at-once.urdf");
    assert_eq!(faults.iter().filter(|f| f.kind == Kind::ObliqueAxis).count(), 8);
    let faults = refused("masslessroot.urdf");
    assert!(matches!(&faults[..], [f] if f.kind == Kind::Inertia && f.what.contains("trunk")));
    let faults = refused("triangle.urdf");
    assert!(faults.len() == 2 && faults.iter().all(|f| f.kind == Kind::Inertia && f.remedy.contains("--mend")));
    let (made, _) = with("triangle.urdf", &[("--mend", "")]);
    assert!(says(&made, "changed to the nearest"));
    let faults = refused("degrees.urdf");
    assert!(faults.len() == 2 && faults.iter().all(|f| f.what.contains("degrees") && f.remedy.contains("1.7977")));
}

#[test]
fn other_formats_are_named_with_what_converts_them() {
    let faults = refused("22-xacro.urdf.xacro");
    assert!(faults[0].what.contains("xacro") && faults[0].remedy.contains("xacro FILE > robot.urdf"));
    let sdf = import("<sdf version=\"1.6\"/>", &Options::default()).expect_err("SDF").0;
    assert!(sdf[0].remedy.contains("sdf2mjcf"));
    let faults = refused("21-mjcf.xml");
    assert!(faults[0].what.contains("no body of this file has joints"));
}

#[test]
fn a_locked_ankle_leaves_the_foot_where_it_was() {
    for (file, options) in [
        ("lockankle.urdf", &[("--lock", "*_ankle")][..]),
        ("lockankle.urdf", &[]),
        ("sensor_foot.urdf", &[("--lock", "*_ankle")]),
        ("sensor_foot.urdf", &[]),
    ] {
        let (_, robot) = with(file, options);
        for leg in &robot.legs {
            assert_eq!(leg.chain[1].link.end, [0.0, -0.35, 0.0], "{file}");
        }
    }
    let (_, robot) = with("lockankle.urdf", &[("--foot", "*_foot=0.03,0,-0.02")]);
    assert_eq!(robot.legs[0].chain.len(), 3);
    let bent =
        import(&text("lockankle.urdf"), &given(&[("--lock", "left_ankle=0.7")])).expect_err("beyond its stops").0;
    assert!(bent[0].kind == Kind::Option && bent[0].remedy.contains("left_ankle=0.5"));
}

#[test]
fn round_and_flat_feet_touch_the_ground_with_their_bottoms() {
    let foot = |geometry: &str| {
        let shape = format!("<collision><geometry>{geometry}</geometry></collision></link>");
        let text = text("00-control-ok.urdf");
        let text = ["fl", "fr", "hl", "hr"].iter().fold(text, |text, leg| {
            text.replace(&format!("<link name=\"{leg}_foot\"/>"), &format!("<link name=\"{leg}_foot\">{shape}"))
        });
        let made = import(&text, &Options::default()).unwrap();
        let robot = builds(&made);
        (robot.legs[0].chain[1].link.end, made.notes.join("\n"))
    };
    let (end, notes) = foot("<sphere radius=\"0.02\"/>");
    assert!((end[1] + 0.22).abs() < 1e-12 && notes.contains("20 mm (that it rolls is neglected)"), "{end:?}");
    let (end, _) = foot("<box size=\"0.1 0.05 0.03\"/>");
    assert!((end[1] + 0.215).abs() < 1e-12 && end[0] == 0.0, "{end:?}");
}

/// Angles that people round: legs that are turned half round by 3.14, with all in them the other way, are the same legs.
#[test]
fn rounded_right_angles_are_right() {
    let turned = text("00-control-ok.urdf")
        .replace("rpy=\"0 0 0\"", "rpy=\"0 0 3.14\"")
        .replace("axis xyz=\"0 1 0\"", "axis xyz=\"0 -1 0\"")
        .replace("xyz=\"0.01 0 -0.1\"", "xyz=\"-0.01 0 -0.1\"");
    let made = import(&turned, &Options::default()).unwrap();
    assert!(says(&made, "4 angles of the file are right angles rounded by up to 1.6e-3 rad"));
    assert_eq!(builds(&made), imported("00-control-ok.urdf").1);
}

/// Planar robots: an inertia about one axis, hips at one place.
#[test]
fn planar_robots_are_robots() {
    let flat = text("cad.urdf")
        .replace("xyz=\"0 0.1 0\"", "xyz=\"0 0 0\"")
        .replace("xyz=\"0 -0.1 0\"", "xyz=\"0 0 0\"")
        .replace(
            "ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.001\"",
            "ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0\"",
        );
    let made = import(&flat, &Options::default()).unwrap();
    let robot = builds(&made);
    assert!(says(&made, "mm apart sideways") && says(&made, "none that a body can have"));
    assert_eq!(robot.legs[0].chain[1].link.inertia[2][2], 0.01);
    assert!(robot.legs[0].mount[2] < 0.0 && robot.legs[1].mount[2] > 0.0);
}

/// Links without mass between the joints of a hip are merged, and said.
#[test]
fn virtual_links_of_a_hip_are_held() {
    let hip = text("00-control-ok.urdf");
    let hip = ["fl", "fr", "hl", "hr"].iter().fold(hip, |text, leg| {
        let joint = format!("<joint name=\"{leg}_hip\" type=\"revolute\"><parent link=\"base\"/>");
        let at = text.find(&joint).unwrap();
        let rest = &text[at..];
        let origin = &rest[rest.find("<origin").unwrap()..rest.find("<axis").unwrap()];
        let new = format!(
            "<link name=\"{leg}_v\"/><joint name=\"{leg}_roll\" type=\"revolute\"><parent link=\"base\"/><child link=\"{leg}_v\"/>{origin}\
             <axis xyz=\"1 0 0\"/><limit lower=\"-0.5\" upper=\"0.5\" effort=\"30\" velocity=\"20\"/></joint>\
             <joint name=\"{leg}_hip\" type=\"revolute\"><parent link=\"{leg}_v\"/>"
        );
        let moved = rest.replacen(&joint, &new, 1);
        let at_zero = moved.rfind(&format!("<joint name=\"{leg}_hip\"")).unwrap();
        let (head, tail) = moved.split_at(at_zero);
        format!("{}{head}{}", &text[..at], tail.replacen(origin, "", 1))
    });
    let made = import(&hip, &Options::default()).unwrap();
    assert!(says(&made, "`fl_roll` is held at 0 rad: `fl_v` has no mass"));
    assert_eq!(builds(&made), imported("00-control-ok.urdf").1);
}

/// Depth is bounded by nothing but the file: no recursion.
#[test]
fn long_chains_and_deep_nests_do_not_abort() {
    let mut text = String::from("<robot name=\"long\"><link name=\"l0\"/>");
    for k in 1..8000 {
        text += &format!(
            "<link name=\"l{k}\"/><joint name=\"j{k}\" type=\"fixed\"><parent link=\"l{}\"/><child link=\"l{k}\"/></joint>",
            k - 1
        );
    }
    assert!(import(&(text + "</robot>"), &Options::default()).is_err());
    let turning = |kind: &str, count: usize| {
        let mut text = String::from("<robot name=\"long\"><link name=\"l0\"/>");
        for k in 1..count {
            text += &format!(
                "<link name=\"l{k}\"/><joint name=\"j{k}\" type=\"{kind}\"><parent link=\"l{}\"/><child link=\"l{k}\"/></joint>",
                k - 1
            );
        }
        text + "</robot>"
    };
    assert!(import(&turning("revolute", 300), &Options::default()).is_err());
    for (tag, root) in [("a", "robot"), ("body", "mujoco")] {
        let nest =
            format!("<{root}>{}{}</{root}>", format!("<{tag}>").repeat(16_000), format!("</{tag}>").repeat(16_000));
        assert!(import(&nest, &Options::default()).is_err());
        let open = format!("<{root}>{}", format!("<{tag}>").repeat(16_000));
        assert!(
            matches!(&import(&open, &Options::default()).expect_err("not closed").0[..], [f] if f.kind == Kind::Syntax)
        );
    }
}

/// The same robot in MJCF: defaults, degrees, motors, geoms as feet, inertias by their principal axes.
/// The robot of 00-control-ok.urdf.
fn as_mjcf() -> String {
    let mut legs = String::new();
    for (name, x, y) in [("fl", 0.2, 0.1), ("fr", 0.2, -0.1), ("hl", -0.2, 0.1), ("hr", -0.2, -0.1)] {
        legs += &format!(
            r#"<body name="{name}_thigh" pos="{x} {y} 0"><inertial pos="0.01 0 -0.1" mass="0.8" diaginertia="0.001 0.005 0.005" quat="1 0 1 0"/>
            <joint name="{name}_hip" range="-85.943669269623 85.943669269623"/>
            <body name="{name}_calf" pos="0 0 -0.2"><inertial pos="0 0 -0.1" mass="0.2" fullinertia="0.002 0.002 0.0001 0 0 0"/>
            <joint name="{name}_knee" class="knee"/><geom type="sphere" size="0.02" pos="0 0 -0.18"/><geom class="look" type="box" size="1 1 1"/></body></body>"#
        );
    }
    let motors: String = ["fl", "fr", "hl", "hr"]
        .iter()
        .map(|l| {
            format!(
                "<motor joint=\"{l}_hip\"/><position joint=\"{l}_knee\" kp=\"9\" forcerange=\"-0.6 0.6\" gear=\"50\"/>"
            )
        })
        .collect();
    format!(
        r#"<mujoco model="q"><compiler autolimits="true"/><default><joint axis="0 1 0"/><motor ctrlrange="-30 30"/>
        <default class="knee"><joint range="-143.2394487827 -5.7295779513" armature="0.75" damping="1"/></default>
        <default class="look"><geom contype="0" conaffinity="0" mass="0"/></default></default>
        <worldbody><geom type="plane" size="1 1 1"/><body name="base" pos="0 0 1"><freejoint/>
        <inertial pos="0 0 0" mass="8" diaginertia="0.05 0.1 0.12"/>{legs}</body></worldbody><actuator>{motors}</actuator></mujoco>"#
    )
}

#[test]
fn mjcf_says_the_same_as_urdf() {
    let text = as_mjcf();
    let lacking = import(&text, &Options::default()).expect_err("no speeds").0;
    assert!(lacking.len() == 8 && lacking.iter().all(|f| f.remedy.contains("--velocity")));
    let made = import(&text, &given(&[("--velocity", "20")])).unwrap();
    let (robot, control) = (builds(&made), imported("00-control-ok.urdf").1);
    assert!(says(&made, "the friction of 4 joints is taken over, as `damping` and `coulomb`"));
    assert_eq!(robot.platform, control.platform);
    for (leg, other) in robot.legs.iter().zip(&control.legs) {
        for (s, t) in leg.chain.iter().zip(&other.chain) {
            let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
            assert!(near(s.link.com, t.link.com) && near(s.link.end, t.link.end) && s.link.mass == t.link.mass);
            assert!(s.link.inertia.iter().zip(t.link.inertia).all(|(a, b)| near(*a, b)), "{:?}", s.link);
            assert!((0..2).all(|k| (s.joint.range[k] - t.joint.range[k]).abs() < 1e-9));
        }
        let knee = &leg.chain[1].joint.actuator;
        assert!((knee.gear, knee.max_torque) == (50.0, 0.6) && (knee.rotor_inertia - 0.0003).abs() < 1e-12);
        assert_eq!((leg.chain[1].joint.friction.damping, leg.chain[0].joint.friction.damping), (1.0, 0.0));
        assert_eq!(leg.chain[0].joint.actuator.max_torque, 30.0);
    }
}

/// Geoms give inertias where there is no <inertial>, and what closes a loop is refused.
#[test]
fn mjcf_takes_inertias_from_geoms_and_refuses_loops() {
    let leg = |name: &str, y: f64| {
        format!(
            r#"<body name="{name}_thigh" pos="0 {y} 0"><joint name="{name}_hip" axis="0 1 0" range="-90 90"/>
            <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" density="1000"/>
            <body name="{name}_shin" pos="0 0 -0.4"><joint name="{name}_knee" axis="0 1 0" range="0 120"/>
            <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.02" mass="1"/></body></body>"#
        )
    };
    let text = |more: &str| {
        format!(
            r#"<mujoco><worldbody><body name="trunk"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>
            <joint axis="0 1 0"/><geom type="box" size="0.1 0.1 0.2" mass="10"/>{}{}</body></worldbody>
            <actuator><general joint="l_hip" ctrlrange="-1 1" gear="40"/><motor joint="l_knee" ctrlrange="-1 1" gear="40"/>
            <motor joint="r_hip" ctrlrange="-1 1" gear="40"/><motor joint="r_knee" ctrlrange="-1 1" gear="40"/></actuator>{more}</mujoco>"#,
            leg("l", 0.1),
            leg("r", -0.1)
        )
    };
    let options = given(&[("--velocity", "10")]);
    let made = import(&text(""), &options).unwrap();
    let robot = builds(&made);
    assert!(says(&made, "the joints by which `trunk` moves in the world are dropped"));
    let thigh = &robot.legs[0].chain[0].link;
    let (r, h) = (0.03f64, 0.4);
    let pi = std::f64::consts::PI;
    let (tube, ball) = (1000.0 * pi * r * r * h, 1000.0 * 4.0 / 3.0 * pi * r.powi(3));
    assert!((thigh.mass - tube - ball).abs() < 1e-9);
    let swing = tube * (r * r / 4.0 + h * h / 12.0) + ball * (0.4 * r * r + h * h / 4.0 + 3.0 * h * r / 8.0);
    assert!((thigh.inertia[2][2] - swing).abs() < 1e-9 * swing);
    assert!((robot.legs[0].chain[1].link.end[1] + 0.42).abs() < 1e-12);
    assert_eq!(robot.legs[0].chain[0].joint.actuator.max_torque, 1.0);
    let closed = text("<equality><connect body1=\"l_shin\" body2=\"r_shin\" anchor=\"0 0 0\"/></equality>");
    assert!(import(&closed, &options).expect_err("a loop").0.iter().any(|f| f.kind == Kind::Loop));
}

/// Numbers of any size end in a specification that builds or in a fault, as do texts cut anywhere.
#[test]
fn hostile_numbers_and_torn_files_do_not_panic() {
    let control = text("00-control-ok.urdf");
    for number in ["nan", "inf", "1e308", "-1e308", "1e-320", "", "0x10", "1,5", "-0"] {
        for (from, to) in [
            ("0.2 0.1 0\"", format!("{number} 0.1 0\"")),
            ("value=\"0.8\"", format!("value=\"{number}\"")),
            ("iyy=\"0.005\"", format!("iyy=\"{number}\"")),
            ("lower=\"-1.5\"", format!("lower=\"{number}\"")),
            ("upper=\"1.5\"", format!("upper=\"{number}\"")),
            ("effort=\"30\"", format!("effort=\"{number}\"")),
            ("axis xyz=\"0 1 0\"", format!("axis xyz=\"0 {number} 0\"")),
            ("rpy=\"0 0 0\"", format!("rpy=\"0 {number} 0\"")),
        ] {
            if let Ok(made) = import(&control.replace(from, &to), &Options::default()) {
                builds(&made);
            }
        }
    }
    for end in (0..control.len()).step_by(97).filter(|end| control.is_char_boundary(*end)) {
        assert!(import(&control[..end], &Options::default()).is_err());
    }
}

/// A dog whose knees stay bent cannot trot without flight: it is given a trot that flies.
#[test]
fn where_only_flight_makes_a_trot_possible_that_is_the_trot() {
    let stiff = text("00-control-ok.urdf").replace(r#"upper="-0.1""#, r#"upper="-1.6""#);
    let made = import(&stiff, &Options::default()).unwrap().tried(&|gait| gait.contains("trot"));
    builds(&made);
    assert_eq!(gaits(&made), ["trot.toml"]);
    assert!(
        made.gaits[0].1.contains("stance = []")
            && made.gaits[0].1.contains("# It flies: without flight none was found")
    );
    assert!(made.notes.iter().any(|note| note.starts_with("the trot flies: ")), "{:#?}", made.notes);
    assert!(made.found[0].gait == "trot" && made.found[0].speeds.len() >= 3, "{:?}", made.found);
}

/// Where joints rub dry, what is asked for and told is energy; what the file says of it is found again.
#[test]
fn what_is_said_of_a_robot_that_rubs_is_of_energy() {
    let rubbing = text("sensor_foot.urdf").replace("<limit ", r#"<dynamics friction="0.2"/><limit "#);
    let made = import(&rubbing, &Options::default()).unwrap().tried(&|gait| gait == "walk");
    let (_, walk) = &made.gaits[0];
    let line = walk.lines().find(|line| line.starts_with("# Least")).unwrap();
    let (cost, rest) = line
        .strip_prefix("# Least energy that a short search found, N (local optima): ")
        .unwrap()
        .split_once(" at ")
        .unwrap();
    let (cost, speed): (f64, f64) = (cost.parse().unwrap(), rest.split_once(" m/s").unwrap().0.parse().unwrap());
    let file = |path: &str, text: &str| SpecFile { path: path.into(), text: text.into() };
    let files = RobotFiles {
        module: String::new(),
        robot: file("robot.toml", &made.robot),
        gaits: vec![file("walk.toml", walk)],
    };
    let gait = piaffe::Robot::new(files).unwrap().gait("walk").unwrap();
    let task = piaffe::search::local::Task { gait: &gait, criterion: piaffe::motion::Criterion::Energy, speed };
    let settings = piaffe::search::multi_start::Settings { starts: Some(8), ..Default::default() };
    let again = task.search(&settings, &[], &|_| {}).cost.unwrap();
    assert!((again / cost - 1.0).abs() < 1e-4, "{line}: {again}");
}

/// `<dynamics>` of URDF and what MJCF calls `damping` and `frictionloss` are the specification's `damping` and `coulomb`.
#[test]
fn friction_is_taken_over_and_said() {
    let plain = text("00-control-ok.urdf");
    let limits = plain.matches("<limit ").count();
    let given = |dynamics: &dyn Fn(usize) -> String| {
        let mut parts = plain.split("<limit ");
        let first = parts.next().unwrap().to_string();
        parts.enumerate().fold(first, |all, (k, part)| format!("{all}{}<limit {part}", dynamics(k)))
    };
    let all = import(&given(&|_| r#"<dynamics damping="0.02" friction="0.3"/>"#.into()), &Options::default()).unwrap();
    assert!(says(&all, &format!("the friction of {limits} joints is taken over")) && !says(&all, "dropped, of"));
    let joints = |robot: Robot| robot.legs.into_iter().flat_map(|leg| leg.chain).map(|s| s.joint).collect::<Vec<_>>();
    for joint in joints(builds(&all)) {
        assert_eq!((joint.friction.damping, joint.friction.coulomb), (0.02, 0.3), "{}", joint.name);
    }
    // As without it, but for that.
    let bare = import(&plain, &Options::default()).unwrap();
    let stripped = all.robot.lines().filter(|l| !l.contains("damping") && !l.contains("coulomb"));
    assert_eq!(stripped.collect::<Vec<_>>(), bare.robot.lines().collect::<Vec<_>>());

    // Counterparts rub alike.
    let one = given(&|k| if k == 0 { r#"<dynamics damping="0.04"/>"#.into() } else { String::new() });
    let one = import(&one, &Options::default()).unwrap();
    assert!(one.notes.iter().any(|note| note.contains("is the mean of it and its counterparts")), "{:?}", one.notes);
    let sum: f64 = joints(builds(&one)).iter().map(|joint| joint.friction.damping).sum();
    assert!((sum - 0.04).abs() < 1e-12, "{sum}");

    let drives =
        import(&given(&|_| r#"<dynamics damping="-0.1"/>"#.into()), &Options::default()).expect_err("drives").0;
    assert!(drives.len() == limits && drives.iter().all(|f| f.what.contains("less than none") && !f.remedy.is_empty()));
}

/// `stiffness` and `springref` of MJCF, in the file's angles and counted from its `ref`, are the specification's `stiffness` and
/// `rest_angle`; of a joint that is turned round the angle is too.
#[test]
fn springs_are_taken_over_and_said() {
    let plain = as_mjcf();
    let import = |knee: &str, hip: &str| {
        let knees = plain.replace("damping=\"1\"", knee);
        assert!(knees != plain && knees.contains("_hip\" range"), "{knees}");
        import(&knees.replace("_hip\" range", &format!("_hip\" {hip} range")), &given(&[("--velocity", "20")]))
    };
    let made = import("stiffness=\"7\" springref=\"-60\"", "stiffness=\"2\"").unwrap();
    assert!(says(&made, "the springs of 8 joints are taken over, as `stiffness` and `rest_angle`"), "{:?}", made.notes);
    let robot = builds(&made);
    for leg in &robot.legs {
        let [hip, knee] = [0, 1].map(|k| leg.chain[k].joint.spring);
        assert_eq!((hip.stiffness, hip.rest, knee.stiffness), (2.0, 0.0, 7.0));
        assert!((knee.rest.abs() - 60f64.to_radians()).abs() < 1e-9, "{}", knee.rest);
        // On the side of the joint's own range.
        let [low, high] = leg.chain[1].joint.range;
        assert!((low..high).contains(&knee.rest), "{low} {high} {}", knee.rest);
    }
    let pushes = import("stiffness=\"-7\"", "").expect_err("pushes").0;
    assert!(pushes.len() == 4 && pushes.iter().all(|f| f.what.contains("less than none") && !f.remedy.is_empty()));
    let wound = import("stiffness=\"7\" springref=\"-400\"", "").expect_err("wound up").0;
    assert!(wound.len() == 4 && wound.iter().all(|f| f.what.contains("more than a turn away") && !f.remedy.is_empty()));
}

/// What the file says of its world is not the robot's: where it moves freely is no part of it, what it weighs is.
#[test]
fn a_world_is_no_part_of_the_robot_but_for_its_gravity() {
    let plain = text("00-control-ok.urdf");
    let made = import(&plain, &Options::default()).unwrap();
    assert!(says(&made, "gravity is taken to be 9.81 m/s²"));
    let trunk = "<link name=\"base\">";
    assert!(plain.contains(trunk));
    let world = "<link name=\"world\"/><joint name=\"root\" type=\"floating\"><parent link=\"world\"/><child link=\"base\"/>\
                 <origin xyz=\"0.3 0 1\"/></joint>";
    let in_world = import(&plain.replacen(trunk, &format!("{world}{trunk}"), 1), &Options::default()).unwrap();
    let [alone, free] = [&made, &in_world].map(builds);
    assert_eq!(alone.platform.name, free.platform.name);
    assert_eq!(alone.platform.com, free.platform.com);
    assert!(alone.legs.iter().zip(&free.legs).all(|(a, b)| a.mount == b.mount), "mounts are where they were");

    let mjcf = as_mjcf();
    let gravity = |option: &str| {
        let file = mjcf.replacen("<worldbody>", &format!("{option}<worldbody>"), 1);
        let made = import(&file, &given(&[("--velocity", "20")])).unwrap_or_else(|e| panic!("{option}: {e}"));
        (builds(&made).gravity, made.notes.join("\n"))
    };
    assert_eq!(gravity("").0, 9.81);
    assert_eq!(gravity("<option gravity=\"0 0 -1.62\"/>").0, 1.62);
    let (none, told) = gravity("<option gravity=\"0 0 0\"/>");
    assert!(none == 9.81 && told.contains("the file has no gravity") && told.contains("taken to be 9.81"), "{told}");
    let (oblique, told) = gravity("<option gravity=\"1 0 -2\"/>");
    assert!((oblique - 5.0f64.sqrt()).abs() < 1e-11 && told.contains("gravity is oblique"), "{told}");
}

/// Whichever leg it is on: what a gait holds still is said, with its angle.
#[test]
fn joints_that_are_held_are_named() {
    let (made, _) = imported("unlike-legs.urdf");
    assert!(says(&made, "FL_wrist = 0.1, FR_wrist = 0.1 rad"), "{}", made.notes.join("\n"));
    let (plain, _) = imported("00-control-ok.urdf");
    assert!(!plain.notes.iter().any(|note| note.contains("hold still")), "{}", plain.notes.join("\n"));
}

/// Motors that differ keep legs from moving as one: it is said what that costs, and how to have them alike.
#[test]
fn what_follows_from_motors_that_differ_is_said() {
    let hind = |line: &str| match line.contains("\"hl_hip\"") || line.contains("\"hr_hip\"") {
        true => line.replace("effort=\"30\" velocity=\"20\"", "effort=\"40\" velocity=\"21\"") + "\n",
        false => line.to_string() + "\n",
    };
    let text: String = text("00-control-ok.urdf").lines().map(hind).collect();
    let made = import(&text, &Options::default()).unwrap();
    assert!(
        says(&made, "`fl_hip` and `hl_hip` have different motors: 30 and 40 N·m, 20 and 21 rad/s"),
        "{:?}",
        made.notes
    );
    assert!(says(&made, "diagonal legs do not move as one, and there is no trot"), "{:?}", made.notes);
    assert!(!gaits(&made).contains(&"trot.toml"));
    let alike = given(&[("--effort", "*_hip=35"), ("--velocity", "*_hip=20")]);
    let made = import(&text, &alike).unwrap();
    assert!(gaits(&made).contains(&"trot.toml") && !made.notes.iter().any(|note| note.contains("legs differ")));
}

/// A joint that follows another one does not move: it is said where it stays, or what to do where a leg hangs on it.
#[test]
fn what_follows_from_joints_that_mimic_is_said() {
    let plain = text("00-control-ok.urdf");
    let joint = |name: &str| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><parent link=\"base\"/><child link=\"flag\"/><axis xyz=\"0 1 0\"/><mimic joint=\"fl_hip\"/></joint>"
        )
    };
    let flag = format!("<link name=\"flag\"/>{}</robot>", joint("pole"));
    let made = import(&plain.replace("</robot>", &flag), &Options::default()).unwrap();
    assert!(
        says(&made, "(mimic), and stays at 0 while that one moves (--lock JOINT=ANGLE holds it elsewhere): `pole`"),
        "{:?}",
        made.notes
    );
    let made = import(&plain.replace("</robot>", &flag), &given(&[("--lock", "pole=0.3")])).unwrap();
    assert!(!made.notes.iter().any(|note| note.contains("stays at 0")), "{:?}", made.notes);
    let knee = "<joint name=\"fl_knee\" type=\"revolute\">";
    let follower = plain.replace(knee, &format!("{knee}<mimic joint=\"fl_hip\"/>"));
    let faults = import(&follower, &Options::default()).unwrap_err().0;
    assert!(faults.iter().any(|f| f.what.contains("mimic") && f.remedy.contains("a motor of its own")), "{faults:?}");
}
