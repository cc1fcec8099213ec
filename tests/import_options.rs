//! What is given beside a file does what it says, or it is said that it does nothing; and what a file says is taken as it stands, or
//! it is said what became of it.

#[path = "import/given.rs"]
mod given;
#[path = "import/made.rs"]
mod made;

use made::{made, refused, says};
use piaffe::import::Kind;

fn control() -> String {
    let path = format!("{}/tests/import/00-control-ok.urdf", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"))
}

#[test]
fn options_that_name_nothing_are_refused() {
    for (option, value, near) in [
        ("--effort", "fl_hipp=3", "--effort fl_hip"),
        ("--velocity", "nojoint=3", "name a joint"),
        ("--gear", "nope=9", "name a joint"),
        ("--rotor", "nope=1", "name a joint"),
        ("--range", "fl_kneee=-1,1", "--range fl_knee"),
        ("--foot", "fl_feet", "--foot fl_foot"),
        ("--lock", "fl_hipp", "--lock fl_hip"),
    ] {
        let faults = refused(&control(), &[(option, value)]);
        assert!(
            matches!(&faults[..], [f] if f.kind == Kind::Option && f.remedy.contains(near)),
            "{option}: {faults:?}"
        );
    }
    for (option, value) in [("--gear", "0"), ("--effort", "fl_hip=0"), ("--velocity", "0")] {
        let faults = refused(&control(), &[(option, value)]);
        assert!(
            faults[0].kind == Kind::Option && faults[0].what.contains(&format!("{option} {value}: no joint has that"))
        );
    }
    made(&control(), &[("--rotor", "0")]);
}

#[test]
fn options_that_change_nothing_are_told() {
    let tells = |options: &[(&str, &str)], words: &str| {
        let (made, _) = made(&control(), options);
        let told: Vec<&String> = made.notes.iter().filter(|note| note.contains("changes nothing")).collect();
        assert_eq!(told.len(), usize::from(!words.is_empty()), "{options:?}: {told:?}");
        assert!(words.is_empty() || says(&made, words), "{options:?}: {told:?}");
    };
    tells(&[("--effort", "99")], "--effort 99 changes nothing: the file has one for every joint that moves");
    tells(&[("--effort", "*_hip=99")], "");
    tells(&[("--gear", "9"), ("--rotor", "0.1")], "");
    tells(
        &[("--gear", "*=9"), ("--gear", "*=8")],
        "--gear *=9 changes nothing: for all that it names another one counts",
    );
    tells(&[("--gear", "*=9"), ("--gear", "*_hip=8")], "");
    tells(&[("--range", "*_hip=-1,1"), ("--range", "*=-1,1")], "--range *_hip changes nothing");
    tells(&[("--foot", "base")], "--foot base changes nothing: no leg ends");
    tells(&[("--foot", "*_foot=0,0,0.01"), ("--foot", "f?_foot=0,0,0.02")], "");
    tells(&[("--foot", "f?_foot=0,0,0.02"), ("--foot", "*_foot=0,0,0.01")], "--foot f?_foot changes nothing");
    // Joints that are held have no motor, and those that are fixed are held already.
    let head = "<link name=\"head\"/><joint name=\"neck\" type=\"revolute\"><parent link=\"base\"/><child link=\"head\"/><axis xyz=\"0 1 0\"/>\
                <limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>";
    let with_head = control().replace("</robot>", head);
    assert!(says(&made(&with_head, &[("--effort", "neck=3")]).0, "it names no joint that moves in a leg"));
    let fixed = with_head.replace("\"neck\" type=\"revolute\"", "\"neck\" type=\"fixed\"");
    assert!(says(&made(&fixed, &[("--lock", "neck")]).0, "--lock neck changes nothing: the joint is fixed"));
}

/// Without a point the foot is what the link is made of.
#[test]
fn a_foot_that_is_given_touches_the_ground_with_its_bottom() {
    let ball = "_foot\"><collision><geometry><sphere radius=\"0.02\"/></geometry></collision></link>";
    let round = ["fl", "fr", "hl", "hr"].iter().fold(control(), |text, leg| {
        text.replace(&format!("<link name=\"{leg}_foot\"/>"), &format!("<link name=\"{leg}{ball}"))
    });
    let (plain, robot) = made(&round, &[("--foot", "*_foot")]);
    assert!((robot.legs[0].chain[1].link.end[1] + 0.22).abs() < 1e-12);
    assert!(says(&plain, "the bottom of a round foot of 20 mm"), "{:?}", plain.notes);
    let (point, robot) = made(&round, &[("--foot", "*_foot=0,0,0.01")]);
    assert!((robot.legs[0].chain[1].link.end[1] + 0.19).abs() < 1e-12 && says(&point, "the point that was given"));
    let (origin, _) = made(&control(), &[("--foot", "*_foot")]);
    assert!(says(&origin, "the origin of link `fl_foot`") && !says(&origin, "that was given"), "{:?}", origin.notes);
}

#[test]
fn stops_in_degrees_are_asked_about() {
    for (low, high) in [("-45", "45"), ("-60", "120"), ("-150", "15"), ("-150", "-20")] {
        let text = control().replace("lower=\"-1.5\" upper=\"1.5\"", &format!("lower=\"{low}\" upper=\"{high}\""));
        let faults = refused(&text, &[]);
        assert!(
            faults.len() == 4 && faults.iter().all(|f| f.kind == Kind::Limit && f.what.contains("degrees")),
            "{faults:?}"
        );
        let limits = format!("{:.4}", low.parse::<f64>().unwrap().to_radians());
        assert!(faults[0].remedy.contains(&format!("lower=\"{limits}\"")), "{}", faults[0].remedy);
    }
    let endless = control().replace("lower=\"-1.5\" upper=\"1.5\"", "lower=\"-1e6\" upper=\"1e6\"");
    assert!(says(&made(&endless, &[]).0, "without stops"));
}

#[test]
fn moments_that_are_missing_are_told() {
    let trunk = "<inertia ixx=\"0.05\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.12\"/>";
    assert!(control().contains(trunk));
    let (point, robot) = made(&control().replace(trunk, ""), &[]);
    assert!(robot.platform.inertia == [[0.0; 3]; 3] && says(&point, "`base`: a mass without moments of inertia"));
    let faults = refused(&control().replace(trunk, "<inertia ixx=\"0.05\" iyy=\"0.1\"/>"), &[]);
    assert!(matches!(&faults[..], [f] if f.kind == Kind::Inertia && f.what.contains("no izz")), "{faults:?}");
    let faults = refused(&control().replacen("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>", 1), &[]);
    assert!(faults[0].kind == Kind::Joint && faults[0].what.contains("no direction"), "{faults:?}");
}

/// A trunk with its z axis down.
#[test]
fn legs_that_point_up_are_asked_about() {
    let turned = "<link name=\"down\"/><joint name=\"turn\" type=\"fixed\"><parent link=\"down\"/><child link=\"base\"/>\
                  <origin rpy=\"3.141592653589793 0 0\"/></joint></robot>";
    let text = control().replace("</robot>", turned);
    let faults = refused(&text, &[]);
    assert!(
        matches!(&faults[..], [f] if f.kind == Kind::Axes && f.remedy.contains("--forward x --up -z")),
        "{faults:?}"
    );
    let robot = made(&text, &[("--forward", "x"), ("--up", "-z")]).1;
    assert!(robot.legs.iter().all(|leg| (leg.chain[1].link.end[1] + 0.2).abs() < 1e-9));
}

#[test]
fn a_document_type_and_its_entities_are_xml() {
    let text =
        control().replacen("<robot name=\"q\">", "<!DOCTYPE robot [<!ENTITY mass \"8\">]>\n<robot name=\"q\">", 1);
    let text = text.replacen("value=\"8\"", "value=\"&mass;\"", 1);
    assert!(text.contains("&mass;"));
    assert_eq!(made(&text, &[]).1, made(&control(), &[]).1);
    let bomb = "<!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;\"><!ENTITY c \"&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;\">\
                <!ENTITY d \"&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;\"><!ENTITY e \"&d;&d;&d;&d;&d;&d;&d;&d;&d;&d;\">]><robot name=\"&e;\"/>";
    refused(bomb, &[]);
}

#[test]
fn a_number_beyond_all_robots_is_told_at_its_joints() {
    let text = control().replace("velocity=\"20\"", "velocity=\"1e10\"");
    let faults = refused(&text, &[]);
    assert!(
        faults
            .iter()
            .all(|f| f.place.as_ref().is_some_and(|p| p.element.contains("joint"))
                && f.remedy.contains("--velocity JOINT=")),
        "{faults:?}"
    );
}

#[test]
fn names_that_change_are_told_beside_the_new_ones() {
    let text = control().replace("\"fl_hip\"", "\"左前\"").replace("\"fr_hip\"", "\"fr.knee\"");
    let (told, robot) = made(&text, &[]);
    assert!(says(&told, "`fr.knee` is `fr_knee_2`, `左前` is `a___`"), "{:?}", told.notes);
    assert!(told.robot.contains("[joints.fr_knee_2]\n# \"fr.knee\" in the file"));
    assert_eq!(robot.legs[1].chain.iter().map(|s| s.joint.name.as_str()).collect::<Vec<_>>(), ["fr_knee_2", "fr_knee"]);
    assert!(!made(&control(), &[]).0.robot.contains("in the file\n"));
    // Long names that differ at their ends are different names.
    let long = "l".repeat(120);
    let text = control().replace("fl_", &format!("{long}_a_")).replace("fr_", &format!("{long}_b_"));
    made(&text, &[]);
}

/// What slides stays where it is, or where it is put: along its axis.
#[test]
fn a_joint_that_slides_is_held_at_a_place() {
    let tray = |stops: &str| {
        let joint = format!(
            "<link name=\"tray\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\"/></inertial></link>\
             <joint name=\"rail\" type=\"prismatic\"><parent link=\"base\"/><child link=\"tray\"/><axis xyz=\"2 0 0\"/><limit {stops} effort=\"1\" velocity=\"1\"/></joint></robot>"
        );
        control().replace("</robot>", &joint)
    };
    let com = |text: &str, options: &[(&str, &str)]| {
        let (made, robot) = made(text, options);
        (robot.platform.com[0], made)
    };
    let (at_zero, _) = com(&tray("lower=\"-1\" upper=\"1\""), &[]);
    let (put, told) = com(&tray("lower=\"-1\" upper=\"1\""), &[("--lock", "rail=0.18")]);
    assert!((put - at_zero - 0.18 / 9.0).abs() < 1e-12, "{put} {at_zero}");
    assert!(says(&told, "`rail` is held at 0.18 m (the file's place), as you say"), "{:?}", told.notes);
    let (stops, told) = com(&tray("lower=\"0.09\" upper=\"1\""), &[]);
    assert!((stops - at_zero - 0.01).abs() < 1e-12 && says(&told, "`rail` is held at [0.0900] m"), "{:?}", told.notes);
    let faults = refused(&tray("lower=\"0.09\" upper=\"1\""), &[("--lock", "rail=0")]);
    assert!(faults[0].what.contains("its stops are at 0.09 and 1 m"), "{faults:?}");
    let free = tray("lower=\"0\" upper=\"1\"").replace("prismatic", "floating");
    let faults = refused(&free, &[("--lock", "rail=0.1")]);
    assert!(faults[0].kind == Kind::Option && faults[0].what.contains("one number does not say"), "{faults:?}");
    assert!(says(&made(&free, &[("--lock", "rail")]).0, "`rail` is held as it is in the file"));
}

/// Forelegs have wrists too.
#[test]
fn arms_that_stand_on_the_ground_are_legs() {
    let bones = control().replace("fl_foot", "finger_l").replace("fr_foot", "finger_r");
    let bones = ["fl", "fr"].iter().fold(bones, |text, leg| {
        let text = text
            .replace(&format!("{leg}_thigh"), &format!("{leg}_humerus"))
            .replace(&format!("{leg}_calf"), &format!("{leg}_radius"));
        text.replace(&format!("{leg}_hip"), &format!("{leg}_shoulder"))
            .replace(&format!("{leg}_knee"), &format!("{leg}_elbow"))
    });
    assert_eq!(made(&bones, &[]).1.legs.len(), 4);
}

/// Where links differ too much to be alike, nothing of them changes, and nothing else is told.
#[test]
fn what_is_not_made_alike_is_not_told_as_if_it_were() {
    // Of one thigh the mass is a little off, and the inertia far.
    let thigh = "<mass value=\"0.8\"/><inertia ixx=\"0.005\" ixy=\"0\" ixz=\"0\" iyy=\"0.005\"";
    let text = control();
    let at = text.find("<link name=\"fl_thigh\">").unwrap();
    let (head, tail) = text.split_at(at);
    let text = head.to_string()
        + &tail.replacen(thigh, "<mass value=\"0.8004\"/><inertia ixx=\"0.007\" ixy=\"0\" ixz=\"0\" iyy=\"0.007\"", 1);
    assert!(text.contains("0.8004"));
    let (told, robot) = made(&text, &[]);
    assert!(
        says(&told, "weigh differently") && !told.notes.iter().any(|note| note.contains("made alike")),
        "{:?}",
        told.notes
    );
    assert_eq!(robot.legs.iter().map(|leg| leg.chain[0].link.mass).fold(0.0, f64::max), 0.8004);
}

#[test]
fn legs_in_fours_are_no_tripod() {
    let mut text = control();
    for (name, side) in [("ml", "0.1"), ("mr", "-0.1"), ("nl", "0.1"), ("nr", "-0.1")] {
        let x = if name.starts_with('m') { "0.07" } else { "-0.07" };
        let all = control();
        let from = all.find("<link name=\"fl_thigh\">").unwrap();
        let leg = &all[from..all.find("<link name=\"fr_thigh\">").unwrap()];
        let leg = leg.replace("fl_", &format!("{name}_")).replace("0.2 0.1 0", &format!("{x} {side} 0"));
        text = text.replace("</robot>", &format!("{leg}</robot>"));
    }
    let made = made(&text, &[]).0;
    assert_eq!(made.gaits.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["tetrapod.toml"]);
    let named = |name: &str| made_folder(&control().replace("name=\"q\"", &format!("name=\"{name}\"")));
    assert_eq!([named("Trot"), named("curvet"), named("schema")], ["trot_robot", "curvet", "schema_robot"]);
}

fn made_folder(text: &str) -> String {
    made(text, &[]).0.folder
}
