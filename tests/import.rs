//! URDF in: the specification made of it has the dynamics of the URDF's own numbers.

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use piaffe::import::{Import, Kind, Options, import};
use piaffe_codegen::dynamics::kernels;
use piaffe_codegen::mechanism::Mechanism;
use piaffe_codegen::spec::{Friction, Gait, Robot, parse_gait, parse_robot};
use std::collections::{BTreeMap, BTreeSet};

fn urdf() -> String {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/a1.urdf")).unwrap()
}

fn imported() -> Import {
    import(&urdf(), &Options::default()).unwrap()
}

fn gait_of(made: &Import, text: &str) -> (Robot, Gait) {
    let robot = parse_robot("robot.toml", &made.robot).unwrap_or_else(|e| panic!("{}", e[0]));
    let gait = parse_gait("gait.toml", text, &robot).unwrap_or_else(|e| panic!("{}", e[0]));
    (robot.robot.locked(&gait.locked).unwrap(), gait)
}

/// Values of a kernel from its expressions.
fn run(mechanism: &Mechanism, name: &str, inputs: &[&[f64]]) -> Vec<f64> {
    let (model, kernels) = kernels(mechanism);
    let kernel = kernels.iter().find(|k| k.name == name).unwrap();
    let symbols = kernel.inputs.iter().flat_map(|i| i.symbols.iter().copied());
    let values: BTreeMap<_, _> = symbols.zip(inputs.iter().flat_map(|i| i.iter().copied())).collect();
    model.ring.evaluate_all(kernel.outputs.iter().flat_map(|o| &o.values), &values)
}

/// A URDF read by nobody else.
struct Urdf {
    links: Vec<Link>,
    joints: Vec<Joint>,
}

struct Link {
    name: String,
    mass: f64,
    frame: Isometry3<f64>,
    tensor: Matrix3<f64>,
}

struct Joint {
    name: String,
    parent: String,
    child: String,
    frame: Isometry3<f64>,
    axis: Vector3<f64>,
}

impl Urdf {
    fn read() -> Urdf {
        let text = urdf();
        let file = roxmltree::Document::parse(&text).unwrap();
        let child = |node: roxmltree::Node, tag: &str| node.children().find(|n| n.has_tag_name(tag)).map(|n| n.id());
        let node = |id| file.get_node(id).unwrap();
        let numbers = |of: roxmltree::Node, tag: &str, key: &str| -> Vec<f64> {
            let text = child(of, tag).and_then(|id| node(id).attribute(key)).unwrap_or("0 0 0");
            text.split_whitespace().map(|x| x.parse().unwrap()).collect()
        };
        let frame = |of: roxmltree::Node| {
            let (p, r) = (numbers(of, "origin", "xyz"), numbers(of, "origin", "rpy"));
            Isometry3::from_parts(
                Translation3::new(p[0], p[1], p[2]),
                UnitQuaternion::from_euler_angles(r[0], r[1], r[2]),
            )
        };
        let text_of =
            |of: roxmltree::Node, tag: &str| node(child(of, tag).unwrap()).attribute("link").unwrap().to_string();
        let all = |tag: &'static str| file.root_element().children().filter(move |n| n.has_tag_name(tag));
        let name = |n: roxmltree::Node| n.attribute("name").unwrap().to_string();
        let links = all("link").map(|link| {
            let Some(inertial) = child(link, "inertial").map(node) else {
                return Link { name: name(link), mass: 0.0, frame: Isometry3::identity(), tensor: Matrix3::zeros() };
            };
            let i = |key: &str| numbers(inertial, "inertia", key)[0];
            let (xy, xz, yz) = (i("ixy"), i("ixz"), i("iyz"));
            let tensor = Matrix3::new(i("ixx"), xy, xz, xy, i("iyy"), yz, xz, yz, i("izz"));
            Link { name: name(link), mass: numbers(inertial, "mass", "value")[0], frame: frame(inertial), tensor }
        });
        let joints = all("joint").map(|joint| Joint {
            name: name(joint),
            parent: text_of(joint, "parent"),
            child: text_of(joint, "child"),
            frame: frame(joint),
            axis: Vector3::from_vec(numbers(joint, "axis", "xyz")),
        });
        Urdf { links: links.collect(), joints: joints.collect() }
    }
}

/// Frames of all links by URDF's own rules, in URDF's axes: joints at these angles, the root at `base`.
fn frames(robot: &Urdf, base: Isometry3<f64>, angles: &BTreeMap<String, f64>) -> Vec<Isometry3<f64>> {
    let mut frames: Vec<Option<Isometry3<f64>>> = vec![None; robot.links.len()];
    let index = |name: &str| robot.links.iter().position(|l| l.name == name).unwrap();
    frames[index("base")] = Some(base);
    for _ in 0..robot.joints.len() {
        for joint in &robot.joints {
            if let Some(parent) = frames[index(&joint.parent)] {
                let angle = angles.get(&joint.name).copied().unwrap_or(0.0);
                let turn = UnitQuaternion::from_scaled_axis(joint.axis * angle);
                frames[index(&joint.child)] = Some(parent * joint.frame * turn);
            }
        }
    }
    frames.into_iter().map(Option::unwrap).collect()
}

/// Kinetic and potential energy of the links one by one; their motion by differences along `path`.
fn energy(robot: &Urdf, path: impl Fn(f64) -> Vec<Isometry3<f64>>) -> [f64; 2] {
    let h = 1e-5;
    let (before, now, after) = (path(-h), path(0.0), path(h));
    let mut sum = [0.0; 2];
    for (k, link) in robot.links.iter().enumerate() {
        let (b, n, a) = (before[k] * link.frame, now[k] * link.frame, after[k] * link.frame);
        let velocity = (a.translation.vector - b.translation.vector) / (2.0 * h);
        let spin = n.rotation.inverse() * ((a.rotation * b.rotation.inverse()).scaled_axis() / (2.0 * h));
        sum[0] += 0.5 * link.mass * velocity.norm_squared() + 0.5 * spin.dot(&(link.tensor * spin));
        sum[1] += 9.81 * link.mass * n.translation.vector.z;
    }
    sum
}

/// A state of a gait of the A1 as a motion of its URDF. `legs` are those of the two virtual legs.
fn compare(gait: &str, legs: [[&str; 2]; 2]) {
    let made = imported();
    let (robot, gait) = gait_of(&made, gait);
    let m = Mechanism::new(&robot, &gait);
    let (np, nq) = (m.positions(), m.orientations());
    let draw = |k: usize| (k as f64 * 0.618_033_988_749_895).fract() - 0.5;
    let x: Vec<f64> = (0..np + nq).map(|k| draw(k + 1)).collect();
    let xd: Vec<f64> = (0..np + nq).map(|k| 4.0 * draw(k + 23)).collect();
    let file = Urdf::read();
    // The platform with the hips, locked at zero: its mass centre is what p places.
    let centre = Vector3::from(robot.platform.com);
    let path = |t: f64| {
        let x: Vec<f64> = x.iter().zip(&xd).map(|(x, xd)| x + t * xd).collect();
        let mut angles = BTreeMap::new();
        for (side, names) in legs.iter().enumerate() {
            for leg in names {
                for (depth, joint) in ["thigh", "calf"].iter().enumerate() {
                    // URDF's axis is to the left, the specification's to the right.
                    angles.insert(format!("{leg}_{joint}_joint"), -x[np + 2 * side + depth]);
                }
            }
        }
        let theta = if nq > 4 { x[np + 4] } else { 0.0 };
        let (axis, p) = match np {
            3 => (Vector3::x(), Vector3::new(x[0], x[1], x[2])),
            _ => (-Vector3::y(), Vector3::new(x[0], x[1], centre.z)),
        };
        let to_urdf = |v: Vector3<f64>| Vector3::new(v.x, -v.z, v.y);
        let turn = UnitQuaternion::from_scaled_axis(axis * theta);
        let place = to_urdf(p) - turn * to_urdf(centre);
        frames(&file, Isometry3::from_parts(Translation3::from(place), turn), &angles)
    };
    let expected = energy(&file, path);
    let found = run(&m, "energy", &[&x, &xd]);
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() < 1e-7 * e.abs().max(1.0), "{found:?} instead of {expected:?}");
    }
    let mass: f64 = file.links.iter().map(|l| l.mass).sum();
    assert!((m.total_mass() - mass).abs() < 1e-9);
}

#[test]
fn the_trot_has_the_energies_of_the_urdf() {
    let trot = &imported().gaits[0].1.clone();
    compare(trot, [["FL", "RR"], ["FR", "RL"]]);
}

/// Here the platform turns too, and in the amble out of the plane: products of inertia count.
#[test]
fn turning_gaits_have_the_energies_of_the_urdf() {
    let trot = imported().gaits[0].1.clone();
    let rest = |legs: &str, motion: &str| {
        trot.replace(r#"[["FL", "RR"], ["FR", "RL"]]"#, legs)
            .replace(r#"moves = ["x", "y"], rotates = "none""#, motion)
            .replace("leg1.FL_thigh_joint", "platform")
            .replace("mirrored", "distinct")
    };
    compare(
        &rest(r#"[["RL", "RR"], ["FL", "FR"]]"#, r#"moves = ["x", "y"], rotates = "pitch""#),
        [["RL", "RR"], ["FL", "FR"]],
    );
    compare(
        &rest(r#"[["FR", "RR"], ["FL", "RL"]]"#, r#"moves = ["x", "y", "z"], rotates = "roll""#),
        [["FR", "RR"], ["FL", "RL"]],
    );
}

/// The A1 in `model-spec/` is what its URDF says, but for friction: the same round numbers at every joint, which it leaves out.
#[test]
fn the_shipped_a1_is_the_import() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec/a1/robot.toml");
    let read = |text: &str| parse_robot("robot.toml", text).unwrap_or_else(|e| panic!("{}", e[0])).robot;
    let shipped = read(&std::fs::read_to_string(path).unwrap());
    let mut imported = read(&imported().robot);
    let rubs = |name: &String| name.ends_with(".damping") || name.ends_with(".coulomb");
    imported.written = imported.written.iter().filter(|name| !rubs(name)).cloned().collect::<BTreeSet<_>>().into();
    for joint in imported.legs.iter_mut().flat_map(|leg| &mut leg.chain).map(|segment| &mut segment.joint) {
        assert_eq!((joint.friction.damping, joint.friction.coulomb), (0.01, 0.2));
        joint.friction = Friction::default();
    }
    assert!(shipped == imported, "{shipped:?} {imported:?}");
}

#[test]
fn what_is_no_such_robot_is_refused_with_advice() {
    let broken = |from: &str, to: &str| {
        let text = urdf();
        assert!(text.contains(from), "{from}");
        import(&text.replacen(from, to, 1), &Options::default())
    };
    let refused = |made: Result<Import, piaffe::import::ImportError>, kind: Kind, words: &str| {
        let faults = made.expect_err(words).0;
        let found = faults.iter().any(|f| f.kind == kind && !f.remedy.is_empty() && format!("{f}").contains(words));
        assert!(found, "{faults:#?}");
    };
    let revolute = r#"<joint name="FR_calf_joint" type="revolute">"#;
    let kind = |kind: &str| broken(revolute, &revolute.replace("revolute", kind));
    refused(kind("prismatic"), Kind::Joint, "--lock FR_calf_joint");
    assert!(kind("continuous").is_ok_and(|i| i.notes.iter().any(|n| n.contains("without stops"))));
    assert!(kind("fixed").is_err(), "legs of which one has fewer joints do not pair");
    refused(broken(r#"<axis xyz="0 1 0"/>"#, r#"<axis xyz="0 1 1"/>"#), Kind::ObliqueAxis, "45.0°");
    refused(broken(r#"effort="33.5""#, r#"effort="0""#), Kind::Limit, "--effort");
    let foot = r#"<child link="FR_foot"/>"#;
    refused(broken(foot, r#"<child link="FR_fot"/>"#), Kind::NotATree, "did you mean `FR_foot`?");
    refused(broken(r#"<parent link="FR_hip"/>"#, r#"<parent link="FR_foot"/>"#), Kind::NotATree, "hangs on itself");
    refused(broken(r#"<child link="FR_calf"/>"#, r#"<child link="FL_calf"/>"#), Kind::Loop, "FL_calf");
    refused(broken(r#"<parent link="FL_calf"/>"#, r#"<parent link="FL_thigh"/>"#), Kind::NoFoot, "--foot FL_calf=");
    refused(import("<robot", &Options::default()), Kind::Syntax, "1:");
    refused(import("<robot name=\"x\"/>", &Options::default()), Kind::NotATree, "no <link>");
    let locked = Options { locks: vec!["FR_hip_join=0".parse().unwrap()], ..Options::default() };
    refused(import(&urdf(), &locked), Kind::Option, "--lock FR_hip_joint");
}
