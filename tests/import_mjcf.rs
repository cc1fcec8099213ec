//! What MuJoCo makes of a file, an import makes of it too: masses and inertias, what drives joints, classes of defaults, springs,
//! feet. Numbers of the compiler are MuJoCo's own (4.0.0).

#[path = "import/given.rs"]
mod given;
#[path = "import/made.rs"]
mod made;

use made::{made, refused, says};
use piaffe::import::Kind;
use piaffe_codegen::spec::Robot;

/// A biped: what stands in the trunk beside its legs, in the shins, on the joints; the whole file's head and its actuators.
struct Biped<'t> {
    head: &'t str,
    trunk: &'t str,
    shin: &'t str,
    knee: &'t str,
    actuators: &'t str,
}

const MOTORS: &str = "<motor joint='l_hip' ctrlrange='-9 9'/><motor joint='l_knee' ctrlrange='-9 9'/>\
                      <motor joint='r_hip' ctrlrange='-9 9'/><motor joint='r_knee' ctrlrange='-9 9'/>";

const PLAIN: Biped<'static> = Biped {
    head: "",
    trunk: "<geom type='box' size='.1 .1 .2' mass='10'/>",
    shin: "<geom type='capsule' fromto='0 0 0 0 0 -.4' size='.02' mass='1'/>",
    knee: "",
    actuators: MOTORS,
};

impl Biped<'_> {
    fn text(&self) -> String {
        let Biped { head, trunk, shin, knee, actuators } = self;
        let leg = |name: &str, y: f64| {
            format!(
                "<body name='{name}_thigh' pos='0 {y} 0'><joint name='{name}_hip' axis='0 1 0' range='-90 90'/>\
                 <geom type='capsule' fromto='0 0 0 0 0 -.4' size='.03' mass='2'/><body name='{name}_shin' pos='0 0 -.4'>\
                 <joint name='{name}_knee' axis='0 1 0' range='0 120' {knee}/>{shin}</body></body>"
            )
        };
        format!(
            "<mujoco>{head}<worldbody><body name='trunk'><freejoint/>{trunk}{}{}</body></worldbody><actuator>{actuators}</actuator></mujoco>",
            leg("l", 0.1),
            leg("r", -0.1)
        )
    }

    fn robot(&self, options: &[(&str, &str)]) -> Robot {
        made(&self.text(), &[&[("--velocity", "20")], options].concat()).1
    }
}

fn near(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * b.abs().max(1e-3))
}

/// Mass and moments of the trunk, about the file's x, y and z.
fn trunk(robot: &Robot) -> [f64; 4] {
    let [x, y, z] = [0, 1, 2].map(|k| robot.platform.inertia[k][k]);
    [robot.platform.mass, x, z, y]
}

#[test]
fn masses_and_inertias_are_those_of_the_compiler() {
    let with = |head: &str, geoms: &str| trunk(&Biped { head, trunk: geoms, ..PLAIN }.robot(&[]));
    let is = |head: &str, geoms: &str, expected: [f64; 4]| {
        let found = with(head, geoms);
        assert!(near(&found, &expected), "{head} {geoms}: {found:?}, not {expected:?}");
    };
    // Shells: their surface times the density, or a mass on it.
    is("", "<geom type='box' size='.1 .2 .3' shellinertia='true'/>", [880.0, 54.13333333, 42.13333333, 24.26666667]);
    let ball = "<geom type='sphere' size='.1' shellinertia='true' mass='1'/>";
    is("", ball, [1.0, 0.00666667, 0.00666667, 0.00666667]);
    let capsule = "<geom type='capsule' size='.1 .3' shellinertia='true' mass='1'/>";
    is("", capsule, [1.0, 0.05791667, 0.05791667, 0.00916667]);
    let cylinder = "<geom type='cylinder' size='.1 .3' shellinertia='true' mass='1'/>";
    is("", cylinder, [1.0, 0.04321429, 0.04321429, 0.00928571]);
    // MuJoCo takes the difference of two ellipsoids, and so has five digits.
    let egg = with("", "<geom type='ellipsoid' size='.1 .2 .3' shellinertia='true'/>");
    let expected = [489.7193333, 18.07517488, 14.06836658, 8.10268094];
    assert!(egg.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-5), "{egg:?}");
    // An ellipsoid between two points, its radius alone; a size of which an element gives the first number.
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 0.1 * 0.1 * 0.2;
    let [across, along] = [0.05, 0.02].map(|square| 1000.0 * volume * square / 5.0);
    for size in [".1", ".1 .1 .1"] {
        let between = format!("<geom type='ellipsoid' fromto='-.2 0 0 .2 0 0' size='{size}'/>");
        is("", &between, [1000.0 * volume, along, across, across]);
    }
    let partial = "<default><default class='b'><geom type='box' size='.1 .2 .3'/></default></default>";
    is(partial, "<geom class='b' size='.5' mass='3'/>", [3.0, 0.13, 0.34, 0.29]);
    // Groups that give inertias, and geoms instead of what stands there.
    let groups = "<geom type='sphere' size='.1' mass='3' group='2'/><geom type='box' size='1 1 1' group='3'/>";
    is("<compiler inertiagrouprange='0 2'/>", groups, [3.0, 0.012, 0.012, 0.012]);
    let both = "<inertial pos='0 0 0' mass='7' diaginertia='1 1 1'/><geom type='sphere' size='.1' mass='3'/>";
    is("", both, [7.0, 1.0, 1.0, 1.0]);
    is("<compiler inertiafromgeom='true'/>", both, [3.0, 0.012, 0.012, 0.012]);
    let never = Biped { head: "<compiler inertiafromgeom='false'/>", trunk: both, ..PLAIN }.text();
    let faults = refused(&never, &[("--velocity", "20")]);
    assert!(faults.len() == 4 && faults.iter().all(|f| f.what.contains("has no mass")), "{faults:?}");
    // Least values first, balance then.
    let bounds = "<compiler balanceinertia='true' boundinertia='2' boundmass='4'/>";
    is(bounds, "<inertial pos='0 0 0' mass='1' diaginertia='1 1 7'/>", [4.0, 11.0 / 3.0, 11.0 / 3.0, 11.0 / 3.0]);
    // All together, the other bodies of the world too.
    let total = "<compiler settotalmass='32'/>";
    let robot = Biped { head: total, ..PLAIN }.robot(&[]);
    assert!(near(&trunk(&robot)[..1], &[20.0]) && near(&[robot.legs[0].chain[1].link.mass], &[2.0]));
    let crate_ = "<body name='trunk'><freejoint/>";
    let text = Biped { head: total, ..PLAIN }
        .text()
        .replace(crate_, &format!("<body><geom size='.1' mass='16'/></body>{crate_}"));
    assert!(near(&trunk(&made(&text, &[("--velocity", "20")]).1)[..1], &[10.0]));
}

#[test]
fn a_mass_without_moments_is_said_to_be_a_point() {
    let trunk = "<inertial pos='0 0 0' mass='9'/>";
    let (made, robot) = made(&Biped { trunk, ..PLAIN }.text(), &[("--velocity", "20")]);
    assert_eq!(robot.platform.inertia, [[0.0; 3]; 3]);
    assert!(says(&made, "`trunk`: a mass without moments of inertia"), "{:?}", made.notes);
}

#[test]
fn actuators_of_a_joint_add_up() {
    let drive = |knee: &str, most: f64| {
        let actuators = format!(
            "<motor joint='l_hip' ctrlrange='-9 9'/><motor joint='r_hip' ctrlrange='-9 9'/>{knee}{}",
            knee.replace("l_", "r_")
        );
        let robot = Biped { actuators: &actuators, ..PLAIN }.robot(&[]);
        let motor = &robot.legs[0].chain[1].joint.actuator;
        assert!(near(&[motor.max_torque * motor.gear], &[most]), "{knee}: {}", motor.max_torque * motor.gear);
    };
    drive(
        "<position joint='l_knee' kp='9' forcerange='-20 20'/><velocity joint='l_knee' kv='2' forcerange='-10 10'/>",
        30.0,
    );
    drive("<motor joint='l_knee' ctrlrange='0 7'/><motor joint='l_knee' ctrlrange='-5 0'/>", 5.0);
    drive("<motor joint='l_knee' ctrlrange='0 7'/><motor joint='l_knee' ctrlrange='0 5' gear='-1'/>", 5.0);
    drive("<motor joint='l_knee' ctrlrange='-1 1' gear='7'/><motor joint='l_knee' ctrlrange='-1 1' gear='5'/>", 12.0);
    // What is said of all actuators makes a `general` one of its kind: a servo's control is no force.
    let general = |defaults: &str| {
        let head = format!("<default>{defaults}</default>");
        let actuators = MOTORS.replace("<motor", "<general");
        let text = Biped { head: &head, actuators: &actuators, ..PLAIN }.text();
        made(&text, &[("--velocity", "20"), ("--effort", "1")]).1.legs[0].chain[1].joint.actuator.max_torque
    };
    let servo = "<position kp='7'/>";
    assert_eq!(
        [general("<general gainprm='5'/>"), general(servo), general(&format!("{servo}<motor/>"))],
        [45.0, 1.0, 9.0]
    );
    // One without a limit has none together with another.
    let open = format!("{MOTORS}<damper joint='l_knee' kv='1' ctrlrange='0 1'/>");
    let faults = refused(&Biped { actuators: &open, ..PLAIN }.text(), &[("--velocity", "20")]);
    assert!(matches!(&faults[..], [f] if f.kind == Kind::Limit && f.remedy.contains("--effort")), "{faults:?}");
}

#[test]
fn rotors_at_the_joint_stay_what_the_joint_feels() {
    let at_joint = |robot: &Robot, leg: usize| {
        let motor = &robot.legs[leg].chain[1].joint.actuator;
        (motor.gear, motor.rotor_inertia * motor.gear * motor.gear)
    };
    let knee = "armature='0.01'";
    let plain = Biped { knee, ..PLAIN };
    assert_eq!(at_joint(&plain.robot(&[]), 0), (1.0, 0.01));
    for gear in ["*_knee=10", "10"] {
        let (gear, felt) = at_joint(&plain.robot(&[("--gear", gear)]), 0);
        assert!(gear == 10.0 && near(&[felt], &[0.01]), "{gear}: {felt}");
    }
    // A gear that the file has keeps its place beside one for all, and not beside one that names it.
    let geared = MOTORS.replace("_knee' ctrlrange='-9 9'", "_knee' gear='50' ctrlrange='-9 9'");
    let geared = Biped { knee, actuators: &geared, ..PLAIN };
    for (given, expected) in [("7", 50.0), ("*=7", 7.0)] {
        let (gear, felt) = at_joint(&geared.robot(&[("--gear", given)]), 1);
        assert!(gear == expected && near(&[felt], &[0.01]), "{given}: {gear} {felt}");
    }
    // One that is known of the counterpart alone.
    let left = MOTORS
        .replace("l_knee'", "l_knee' gear='50'")
        .replace("r_knee' ctrlrange='-9 9'", "r_knee' ctrlrange='-450 450'");
    let robot = Biped { knee, actuators: &left, ..PLAIN }.robot(&[]);
    for leg in 0..2 {
        let (gear, felt) = at_joint(&robot, leg);
        assert!(gear == 50.0 && near(&[felt], &[0.01]), "{gear}: {felt}");
    }
}

/// The class of all may have any name, several parts, and more than one line about actuators; a class that is not there is told.
#[test]
fn classes_of_defaults_lose_nothing() {
    let damping = |robot: &Robot| robot.legs[0].chain[1].joint.friction.damping;
    let actuators = "<position joint='l_hip'/><motor joint='l_knee'/><position joint='r_hip'/><motor joint='r_knee'/>";
    let heads = [
        "<default class='robot'><joint damping='.5'/><motor ctrlrange='-9 9' forcerange='-9 9'/></default>",
        "<default><joint damping='.5'/></default><default><joint armature='.1'/><motor ctrlrange='-9 9' forcerange='-9 9'/></default>",
        "<default class='main'><joint damping='.5'/><motor ctrlrange='-9 9' forcerange='-9 9'/><position kp='7'/></default>",
    ];
    for head in heads {
        let robot = Biped { head, actuators, ..PLAIN }.robot(&[]);
        assert_eq!(damping(&robot), 0.5, "{head}");
        assert_eq!(robot.legs[0].chain[0].joint.actuator.max_torque, 9.0, "{head}");
    }
    let faults = refused(
        &Biped { head: "<default><default class='leg'/></default>", knee: "class='legs'", ..PLAIN }.text(),
        &[],
    );
    assert!(faults.iter().any(|f| f.what.contains("no class `legs`") && f.remedy.contains("`leg`")), "{faults:?}");
}

#[test]
fn springs_come_from_classes_and_count_from_the_pose_of_the_file() {
    let head =
        "<default><default class='knee'><joint stiffness='7' springref='40' damping='2' ref='10'/></default></default>";
    let robot = Biped { head, knee: "class='knee'", ..PLAIN }.robot(&[]);
    let joint = &robot.legs[0].chain[1].joint;
    // The axis is turned round; at its pose in the file the joint is at 10°.
    assert!(near(
        &[joint.spring.stiffness, joint.spring.rest.abs(), joint.friction.damping],
        &[7.0, 30f64.to_radians(), 2.0]
    ));
    let (low, high) = (joint.range[0], joint.range[1]);
    assert!(low < joint.spring.rest && joint.spring.rest < high);
    // Those that MuJoCo computes are no numbers of the file.
    let faults = refused(&Biped { knee: "springdamper='.1 1'", ..PLAIN }.text(), &[("--velocity", "20")]);
    assert!(
        faults.len() == 2 && faults.iter().all(|f| f.what.contains("springdamper") && f.remedy.contains("saved.xml"))
    );
    Biped { knee: "springdamper='0 1'", ..PLAIN }.robot(&[]);
    let (made, robot) = made(&Biped { knee: "damping='1 2' stiffness='3 4'", ..PLAIN }.text(), &[("--velocity", "20")]);
    assert_eq!(
        (robot.legs[0].chain[1].joint.friction.damping, robot.legs[0].chain[1].joint.spring.stiffness),
        (1.0, 3.0)
    );
    assert!(says(&made, "the first number is taken"), "{:?}", made.notes);
}

/// A sole is below the ankle, wherever the capsules of which it is made begin; a shin that lies where all joints are at zero has its
/// foot at its end.
#[test]
fn feet_touch_the_ground_with_what_is_lowest() {
    let end = |shin: &str| {
        let leg = made(&Biped { shin, ..PLAIN }.text(), &[("--velocity", "20"), ("--effort", "9")]).1.legs.remove(0);
        let last = leg.chain.last().unwrap().link.end;
        (leg.chain.len(), last)
    };
    let shin = "<geom type='capsule' fromto='0 0 0 0 0 -.4' size='.02' mass='1'/>";
    let foot = |geoms: &str| {
        format!("{shin}<body name='foot' pos='0 0 -.4'><joint name='ankle' axis='0 1 0' range='-45 45'/>{geoms}</body>")
    };
    for (geoms, down) in [
        ("<geom type='capsule' fromto='-.1 0 0 .1 0 0' size='.05'/>", 0.05),
        ("<geom type='capsule' fromto='0 0 0 .2 0 0' size='.05'/>", 0.05),
        ("<geom type='cylinder' fromto='0 0 0 .2 0 0' size='.05'/>", 0.05),
        (
            "<geom type='capsule' fromto='-.07 -.02 -.08 .14 -.04 -.08' size='.027'/><geom type='capsule' fromto='-.07 .02 -.08 .14 .04 -.08' size='.027'/>",
            0.107,
        ),
        ("<geom type='ellipsoid' pos='.0 0 -.05' size='.1 .04 .02'/>", 0.07),
    ] {
        // A joint of each foot needs a name of its own.
        let both = foot(geoms);
        let text = Biped { shin: &both, ..PLAIN }.text();
        let mut sides = ["l", "r"].into_iter();
        let named: Vec<String> = text.split("'foot'").map(String::from).collect();
        let text = named.iter().skip(1).fold(named[0].clone(), |text, rest| {
            let side = sides.next().unwrap();
            text + &format!("'{side}_foot'{}", rest.replacen("'ankle'", &format!("'{side}_ankle'"), 1))
        });
        let robot = made(&text, &[("--velocity", "20"), ("--effort", "9")]).1;
        let last = robot.legs[0].chain.last().unwrap().link.end;
        assert_eq!(robot.legs[0].chain.len(), 3, "{geoms}");
        assert!(last[0].abs() < 3e-3 && near(&[last[1]], &[-down]), "{geoms}: {last:?}");
    }
    // On the shin itself, in front of it, and bent.
    let fixed = format!("{shin}<geom type='capsule' fromto='-.03 0 -.42 .06 0 -.42' size='.02'/>");
    assert!(near(&end(&fixed).1, &[0.0, -0.44, 0.0]), "{:?}", end(&fixed));
    let egg = format!("{shin}<geom type='ellipsoid' pos='0 0 -.42' size='.03 .02 .02'/>");
    assert!(near(&end(&egg).1, &[0.0, -0.44, 0.0]), "{:?}", end(&egg));
    let lying = "<geom type='capsule' fromto='0 0 0 .4 0 0' size='.02' mass='1'/>";
    assert!(near(&end(lying).1, &[0.42, 0.0, 0.0]), "{:?}", end(lying));
    let plain = end(&lying.replace("capsule", "cylinder"));
    assert!(near(&plain.1, &[0.4, 0.0, 0.0]), "{plain:?}");
}

#[test]
fn gravity_tells_which_way_is_up() {
    for (gravity, up) in [("-9.81 0 0", "--up x"), ("0 0 9.81", "--up -z"), ("0 9.81 0", "--up -y")] {
        let head = format!("<option gravity='{gravity}'/>");
        let text = Biped { head: &head, ..PLAIN }.text();
        let faults = refused(&text, &[("--velocity", "20")]);
        assert!(matches!(&faults[..], [f] if f.kind == Kind::Axes && f.remedy.contains(up)), "{gravity}: {faults:?}");
        made(&text, &[("--velocity", "20"), ("--up", "z")]);
    }
    // A trunk that stands turned in its world is turned.
    let turned = PLAIN.text().replace("<body name='trunk'>", "<body name='trunk' euler='180 0 0'>");
    assert!(refused(&turned, &[("--velocity", "20")])[0].remedy.contains("--up -z"));
}

/// Limits are shares of the weight that the robot has where it is.
#[test]
fn assumed_forces_are_shares_of_the_weight_in_the_gravity_of_the_file() {
    let force = |head: &str| {
        let made = made(&Biped { head, ..PLAIN }.text(), &[("--velocity", "20")]).0;
        let line = made.gaits[0].1.lines().find(|line| line.starts_with("min_vertical_force")).unwrap().to_string();
        line.split(['=', '#']).nth(1).unwrap().trim().parse::<f64>().unwrap()
    };
    // Three digits.
    assert!((force("<option gravity='0 0 -1.62'/>") - 0.05 * 16.0 * 1.62).abs() < 0.01);
    assert!((force("") - 0.05 * 16.0 * 9.81).abs() < 0.01);
}

#[test]
fn what_only_mujoco_puts_together_is_left_to_it() {
    for head in ["<include file='skybox.xml'/>", "<compiler coordinate='global'/>"] {
        let faults = refused(&Biped { head, ..PLAIN }.text(), &[]);
        assert!(faults[0].kind == Kind::Format && faults[0].remedy.contains("MuJoCo"), "{faults:?}");
    }
    let faults = refused(&Biped { trunk: "<geom type='mesh' mesh='m'/>", ..PLAIN }.text(), &[]);
    assert!(faults.iter().any(|f| f.remedy.contains("saveinertial = True")), "{faults:?}");
    let faults = refused(&Biped { trunk: "<geom type='capsule' size='.1'/>", ..PLAIN }.text(), &[]);
    assert!(faults.iter().any(|f| f.what.contains("its size is not known")), "{faults:?}");
}
