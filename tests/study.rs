//! Studies as a person runs them: in parts, interrupted, on a robot that nobody tuned; and two results side by side.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;
use tempfile::tempdir;

const SHIPPED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec");

fn piaffe(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_piaffe"));
    command.args(arguments.split(' ')).current_dir(folder).stdin(Stdio::null());
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[track_caller]
fn succeeds(folder: &Path, arguments: &str) -> String {
    let Output { status, stdout, stderr } = piaffe(folder, arguments).output().unwrap();
    assert!(status.success(), "{arguments}: {}", text(&stderr));
    text(&stdout)
}

#[track_caller]
fn fails(folder: &Path, arguments: &str, words: &[&str]) {
    let Output { status, stderr, .. } = piaffe(folder, arguments).output().unwrap();
    let told = text(&stderr);
    assert!(!status.success() && words.iter().all(|word| told.contains(word)), "{arguments}: {told}");
}

/// All files of a study but its journal, whose lines stand in the order in which they were found.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if entry.is_dir() {
                folders.push(entry);
            } else if !entry.ends_with("journal.jsonl") {
                files.insert(entry.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&entry).unwrap());
            }
        }
    }
    files
}

#[track_caller]
fn same(a: &Path, b: &Path) {
    let (a, b) = (contents(a), contents(b));
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    let differing: Vec<&String> = a.keys().filter(|name| a[*name] != b[*name]).collect();
    assert!(differing.is_empty(), "{differing:?}");
}

/// The table of a study, line by line under its names.
fn rows(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let table = std::fs::read_to_string(folder.join("study.csv")).unwrap();
    let mut lines = table.lines().map(|line| line.split(',').map(String::from));
    let names: Vec<String> = lines.next().unwrap().collect();
    lines.map(|cells| names.iter().cloned().zip(cells).collect()).collect()
}

const ASKED: &str =
    "study trot --speed 0.6 --vary links.thigh.mass=1.2..2.0 --vary limits.friction=0.5..1.0 --sample 5 --robot";

#[test]
fn parts_interruptions_and_threads_change_no_byte() {
    let folder = tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let asked = format!("{ASKED} {SHIPPED}");
    succeeds(folder.path(), &format!("{asked} --out whole"));
    assert_eq!(rows(&at("whole")).len(), 10);

    let (mut kills, mut wait) = (0, 20);
    loop {
        let mut child = piaffe(folder.path(), &format!("{asked} --out broken --quiet"));
        let mut child = child.env("RAYON_NUM_THREADS", "1").stdout(Stdio::null()).spawn().unwrap();
        // Longer and longer, or a machine that is too slow would never end.
        std::thread::sleep(Duration::from_millis(wait));
        let _ = child.kill();
        if child.wait().unwrap().success() {
            break;
        }
        (kills, wait) = (kills + 1, wait * 2);
    }
    assert!(kills > 1, "the study was never killed");
    same(&at("whole"), &at("broken"));

    for part in ["1/3", "2/3", "3/3"] {
        succeeds(folder.path(), &format!("{asked} --shard {part} --out part{}", &part[..1]));
    }
    succeeds(folder.path(), "merge part3 part1 part2 --out merged");
    same(&at("whole"), &at("merged"));

    fails(folder.path(), "merge part1 part2 part2 --out other", &["part 3/3 is missing", "are both part 2/3"]);
    succeeds(folder.path(), &format!("{asked} --seed 2 --shard 3/3 --out part4"));
    fails(folder.path(), "merge part1 part2 part4 --out other", &["part4 is a part of another study than part1"]);
    let journal = std::fs::read_to_string(at("part2").join("journal.jsonl")).unwrap();
    let cut: Vec<&str> = journal.lines().skip(1).collect();
    std::fs::write(at("part2").join("journal.jsonl"), cut.join("\n") + "\n").unwrap();
    fails(folder.path(), "merge part1 part2 part3 --out other", &["part2 lacks 1 rows"]);
    std::fs::write(at("part2").join("journal.jsonl"), journal.replacen("\"point\":", "\"point\":1", 1)).unwrap();
    fails(
        folder.path(),
        "merge part1 part2 part3 --out other",
        &["changed since it was written", "part2 lacks 1 rows"],
    );
    std::fs::write(at("part2").join("journal.jsonl"), journal).unwrap();
    fails(folder.path(), "merge part1 part2 part3 --out part1", &["this is what was read: write to another file"]);
    let asked = std::fs::read_to_string(at("part2").join("study.json")).unwrap();
    let none = asked.replacen("\"count\": 3", "\"count\": 0", 1);
    assert_ne!(asked, none);
    std::fs::write(at("part2").join("study.json"), none).unwrap();
    fails(folder.path(), "merge part1 part2 part3 --out other", &["there is no part 2 of 0"]);
}

#[test]
fn a_row_is_what_optimize_gives_with_the_same_numbers() {
    let folder = tempdir().unwrap();
    let asked = "study trot --speed 0.5,0.6 --criterion torque --vary links.thigh.mass=1.3,1.9 --also slopes --robot";
    succeeds(folder.path(), &format!("{asked} {SHIPPED}"));
    let rows = rows(&folder.path().join("study"));
    assert_eq!(rows.len(), 4);
    for row in rows {
        let (mass, speed) = (&row["links.thigh.mass"], &row["speed"]);
        let asked =
            format!("optimize trot --criterion torque --speed {speed} --set links.thigh.mass={mass} --json - --robot");
        let alone: Value = serde_json::from_str(&succeeds(folder.path(), &format!("{asked} {SHIPPED}"))).unwrap();
        let near = |a: &str, b: f64| (a.parse::<f64>().unwrap() - b).abs() <= 1e-6 * b.abs();
        assert!(near(&row["cost"], alone["cost"].as_f64().unwrap()), "{row:?} {}", alone["cost"]);
        assert!(near(&row["duration.1"], alone["durations"][0].as_f64().unwrap()), "{row:?}");
        let slopes = alone["sensitivities"]["slopes"].as_array().unwrap();
        let of_mass = slopes.iter().find(|slope| slope["parameter"] == "links.thigh.mass").unwrap();
        assert!(
            (row["slope.links.thigh.mass"].parse::<f64>().unwrap() / of_mass["slope"].as_f64().unwrap() - 1.0).abs()
                < 1e-3
        );
    }
}

/// All legs of an imported robot have links of their own: numbers of several change together.
#[test]
fn a_robot_that_nobody_tuned_is_studied() {
    let folder = tempdir().unwrap();
    let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/import/00-control-ok.urdf");
    succeeds(folder.path(), &format!("import {urdf} --out dog"));
    let told = succeeds(
        folder.path(),
        "study trot --speed 0.4 --vary links.{fl,fr,hl,hr}_thigh.mass=0.8..1.2 --sample 3 --robot dog --out study",
    );
    assert!(told.contains("trot, least energy at 0.4 m/s: 3 of 3 robots have an optimum"), "{told}");
    let page = std::fs::read_to_string(folder.path().join("study/study.html")).unwrap();
    assert!(page.contains("3 robots like q") && page.contains("parallel-trot-energy"), "no lines across axes");
    let walks: Vec<_> = std::fs::read_dir(folder.path().join("study/walks")).unwrap().collect();
    assert!(!walks.is_empty());
    succeeds(folder.path(), "verify study/walks");
}

#[test]
fn everything_wrong_with_a_question_is_told_before_anything_is_computed() {
    let folder = tempdir().unwrap();
    let asked = "study trot --speed 0.6 --vary links.thig.mass=1,2 --vary links.shin.lenght=0.1..0.2 --out bad --robot";
    let words =
        ["did you mean `links.thigh.mass`", "did you mean `links.shin.length`", "has no values between 0.1 and 0.2"];
    fails(folder.path(), &format!("{asked} {SHIPPED}"), &words);
    assert!(!folder.path().join("bad").exists());
    std::fs::write(folder.path().join("table.csv"), "links.thigh.mass,gravty\n1.5,9.81\nheavy,9.81\n").unwrap();
    let asked = format!("study trot --speed 0.6 --designs table.csv --robot {SHIPPED}");
    fails(folder.path(), &asked, &["table.csv", "line 3: `heavy` is no number", "did you mean `gravity`"]);
    fails(folder.path(), &format!("study trot --speed -1 --robot {SHIPPED}"), &["-1", "--speed", "positive"]);
    let asked = format!("optimize trot --speed 0.6 --set links.thigh.mas=1 --set limits.frictoin=3 --robot {SHIPPED}");
    fails(folder.path(), &asked, &["did you mean `links.thigh.mass`", "did you mean `limits.friction`"]);
    let asked = format!("optimize trot --speed 0.6 --set links.thigh.mas=1 --set links.shin.mass=-1 --robot {SHIPPED}");
    fails(folder.path(), &asked, &["did you mean `links.thigh.mass`", "`links.shin.mass` must be greater than 0"]);
    // Of two things that a number is to be, neither is dropped in silence.
    let vary = "--vary links.thigh.mass=1,2 --vary links.{thigh,shin}.mass=1.5";
    fails(
        folder.path(),
        &format!("study trot --speed 0.6 {vary} --robot {SHIPPED}"),
        &["links.thigh.mass is varied twice"],
    );
    for (varied, also) in [
        ("links.platform.mass", "--payload 2@0,0,0"),
        ("limits.friction", "--friction 0.5"),
        ("gravity", "--set gravity=3.7"),
    ] {
        let asked = format!("study trot --speed 0.6 --vary {varied}=1,2 {also} --robot {SHIPPED}");
        fails(folder.path(), &asked, &[varied, "is varied, and changed by an option for the robot"]);
    }
    fails(folder.path(), &format!("{ASKED} {SHIPPED} --shard 3/2"), &["I/N"]);
}

/// Without a name walks are meant, and what is left out is said; `all` are all.
#[test]
fn gaits_that_fly_are_asked_for_by_name() {
    let folder = tempdir().unwrap();
    let rest = format!("--speed 1.0 --criterion torque --starts 1 --robot {SHIPPED}/rabbit");
    let out = piaffe(folder.path(), &format!("study {rest}")).output().unwrap();
    assert!(text(&out.stderr).contains("left out, since they leave the ground: run;"), "{}", text(&out.stderr));
    let gaits = |folder: &Path| rows(folder).into_iter().map(|row| row["gait"].clone()).collect::<Vec<_>>();
    assert_eq!(gaits(&folder.path().join("study")), ["walk"]);
    succeeds(folder.path(), &format!("study all {rest} --out all"));
    assert_eq!(gaits(&folder.path().join("all")), ["run", "walk"]);
}

/// A part has done what was asked when its rows are there, whatever they say: the script of docs/cluster.md goes on.
#[test]
fn a_part_ends_well_without_an_optimum_and_without_a_robot() {
    let folder = tempdir().unwrap();
    let asked =
        format!("study trot --speed 4 --criterion torque --starts 1 --vary links.thigh.mass=1.6 --robot {SHIPPED}");
    let told = succeeds(folder.path(), &format!("{asked} --shard 1/2 --out part1"));
    assert!(told.contains("0 of 1 robots have an optimum"), "{told}");
    let told = succeeds(folder.path(), &format!("{asked} --shard 2/2 --out part2"));
    assert!(told.contains("part 2/2 has no robots: the study has 1") && !told.contains("0 of 0"), "{told}");
    // The whole can tell.
    assert_eq!(piaffe(folder.path(), "merge part1 part2 --out whole").output().unwrap().status.code(), Some(3));
    assert_eq!(rows(&folder.path().join("whole")).len(), 1);
}

/// Slopes of energy beside slopes of torque say nothing.
#[test]
fn what_is_least_in_different_criteria_has_no_common_slopes() {
    let folder = tempdir().unwrap();
    for criterion in ["energy", "torque"] {
        succeeds(folder.path(), &format!("optimize trot --speed 0.6 --criterion {criterion} --json {criterion}.json"));
    }
    let difference: Value =
        serde_json::from_str(&succeeds(folder.path(), "diff energy.json torque.json --json -")).unwrap();
    assert!(difference["slopes"].as_array().unwrap().is_empty() && difference["prediction"].is_null());
}

/// A copy of the shipped robot with its trot alone, as it is and with other words in it.
fn reworded(folder: &Path, name: &str, words: &[(&str, &str)]) {
    let (robot, trot) = (folder.join(name), format!("{SHIPPED}/gaits/trot.toml"));
    std::fs::create_dir_all(robot.join("gaits")).unwrap();
    std::fs::copy(format!("{SHIPPED}/robot.toml"), robot.join("robot.toml")).unwrap();
    let text = words.iter().fold(std::fs::read_to_string(trot).unwrap(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    std::fs::write(robot.join("gaits/trot.toml"), text).unwrap();
}

/// What differs between two questions is named, whatever it is, and what does not is not.
#[test]
fn what_differs_between_questions_is_named_and_nothing_else() {
    let folder = tempdir().unwrap();
    reworded(folder.path(), "one", &[]);
    // Said as it is meant where it is not said, and in other words.
    let defaults = "polynomial_order = 4\nvirtual_legs = [ ['fore_left',";
    let said = [("virtual_legs = [[\"fore_left\",", defaults), ("[limits] ", "[limits]\nbody_clearance = 0 ")];
    reworded(folder.path(), "same", &said);
    reworded(folder.path(), "other", &[("\"fore_left\", \"hind_right\"", "\"hind_right\", \"fore_left\"")]);
    let asked = "optimize trot --speed 0.6 --starts 2 --quiet";
    for (name, options) in [
        ("one", "--robot one"),
        ("same", "--robot same"),
        ("other", "--robot other"),
        ("legs", "--robot one --real-legs"),
        ("seed", "--robot one --seed 2"),
    ] {
        succeeds(folder.path(), &format!("{asked} {options} --json {name}.json"));
    }
    let same = "numbers         the same in both specifications".to_string();
    let question = |b: &str| {
        let told = succeeds(folder.path(), &format!("diff one.json {b}.json"));
        let lines = told.lines().skip_while(|line| !line.starts_with("numbers"));
        let asked = |line: &&str| ["explained", "in all", "phases"].iter().all(|answer| !line.starts_with(answer));
        lines.take_while(asked).map(String::from).collect::<Vec<_>>()
    };
    assert_eq!(question("one"), std::slice::from_ref(&same));
    assert_eq!(question("same"), std::slice::from_ref(&same));
    let words = "words           virtual_legs: [[\"fore_left\", \"hind_right\"], [\"fore_right\", \"hind_left\"]] → \
                 [[\"hind_right\", \"fore_left\"], [\"fore_right\", \"hind_left\"]]";
    assert_eq!(question("other")[..2], [same.clone(), words.to_string()]);
    assert_eq!(question("seed"), [same.clone(), "search          2 starts of seed 1 → 2 starts of seed 2".into()]);
    let limits = "limits hold     at the virtual legs only → at each real leg".to_string();
    assert_eq!(question("legs"), [same, limits]);
    // One robot is not two on a page because its limits hold elsewhere.
    succeeds(folder.path(), "report one.json legs.json --out page");
    let page = std::fs::read_to_string(folder.path().join("page/index.html")).unwrap();
    assert!(page.contains("Trot at real legs") && !page.contains("robot 1"), "the same robot has two names");
}

/// What the limits of each real leg cost each robot.
#[test]
fn limits_at_each_real_leg_are_in_the_table() {
    let folder = tempdir().unwrap();
    let asked = "study amble --speed 0.4 --criterion energy --vary links.thigh.mass=1.5 --real-legs --robot";
    succeeds(folder.path(), &format!("{asked} {SHIPPED}"));
    let [row] = &rows(&folder.path().join("study"))[..] else { panic!() };
    let number = |name: &str| row[name].parse::<f64>().unwrap();
    assert!(number("cost") > 1.01 * number("virtual_cost"), "{row:?}");
    succeeds(folder.path(), "verify study/walks");
}

/// What the slopes let expect of a small change, against the change itself; and both robots on one page.
#[test]
fn slopes_explain_the_difference_of_two_robots() {
    let folder = tempdir().unwrap();
    for (name, mass) in [("light", 1.6), ("heavy", 1.62)] {
        let set = format!("--set links.thigh.mass={mass} --robot {SHIPPED}");
        succeeds(folder.path(), &format!("optimize trot --speed 0.6 {set} --json {name}.json"));
    }
    let difference: Value =
        serde_json::from_str(&succeeds(folder.path(), "diff light.json heavy.json --json -")).unwrap();
    let prediction = &difference["prediction"];
    let number = |key: &str| prediction[key].as_f64().unwrap();
    assert_eq!(difference["numbers"][0]["name"], "links.thigh.mass");
    assert_eq!(difference["numbers"].as_array().unwrap().len(), 1);
    let real = number("difference");
    assert!(real > 0.01, "{real}");
    assert!((number("at_a") / real - 1.0).abs() < 0.05, "{prediction}");
    // To second order it is nearer.
    assert!((number("mean") / real - 1.0).abs() < 0.005, "{prediction}");
    let told = succeeds(folder.path(), "diff light.json heavy.json");
    assert!(told.contains("links.thigh.mass: 1.6 → 1.62") && told.contains("to first order"), "{told}");

    succeeds(folder.path(), "report light.json heavy.json --out page");
    let page = std::fs::read_to_string(folder.path().join("page/index.html")).unwrap();
    assert!(page.contains("Trot, links.thigh.mass=1.62") && page.contains("Trot, links.thigh.mass=1.6 "), "no names");
}

/// What one file leaves out is what it means, and no zero.
#[test]
fn a_number_that_is_not_given_is_the_one_that_is_meant() {
    let folder = tempdir().unwrap();
    reworded(folder.path(), "four", &[]);
    reworded(folder.path(), "six", &[("virtual_legs", "polynomial_order = 6\nvirtual_legs")]);
    for name in ["four", "six"] {
        let asked = format!("optimize trot --speed 0.6 --starts 1 --robot {name} --json {name}.json --quiet");
        succeeds(folder.path(), &asked);
    }
    let told = succeeds(folder.path(), "diff four.json six.json");
    assert!(told.contains("polynomial_order: 4 (not given) → 6") && !told.contains("it is 0"), "{told}");
    assert!(told.contains("incomplete: no slope is known in polynomial_order\n"), "{told}");
    succeeds(folder.path(), "report four.json six.json --out page");
    let page = std::fs::read_to_string(folder.path().join("page/index.html")).unwrap();
    for order in [4, 6] {
        assert!(page.contains(&format!("Trot, polynomial_order={order}")), "no name for order {order}");
    }
}

#[test]
fn slopes_of_one_robot_explain_no_other() {
    let folder = tempdir().unwrap();
    for (gait, file) in [("trot", "trot"), ("rabbit/walk", "walk"), ("curvet", "curvet")] {
        succeeds(folder.path(), &format!("optimize {gait} --speed 0.6 --starts 1 --json {file}.json --quiet"));
    }
    for (other, kinship, words) in [
        ("walk", "other-robot", &["made of different parts", "mass 13.850 → 40.000 kg", "legs 0.300 → 0.800 m"][..]),
        ("curvet", "other-gait", &["put together differently"]),
    ] {
        let told = succeeds(folder.path(), &format!("diff trot.json {other}.json"));
        assert!(words.iter().all(|word| told.contains(word)), "{told}");
        for claim in ["explained by", "no slope is known", "slopes  "] {
            assert!(!told.contains(claim), "{claim}: {told}");
        }
        assert!(told.lines().count() < 30, "{told}");
        let json: Value =
            serde_json::from_str(&succeeds(folder.path(), &format!("diff trot.json {other}.json --json -"))).unwrap();
        assert_eq!(json["kinship"], kinship);
        assert!(
            json["prediction"].is_null() && json["carried"].is_null() && json["slopes"].as_array().unwrap().is_empty()
        );
    }
}

/// A sum without what matters most explains nothing, and does not say so in percent.
#[test]
fn an_explanation_says_what_it_leaves_out() {
    let folder = tempdir().unwrap();
    for (name, load) in [("bare", ""), ("loaded", " --payload 2@0.05,0.1,0")] {
        succeeds(folder.path(), &format!("optimize trot --speed 0.6 --json {name}.json --robot {SHIPPED}{load}"));
    }
    let told = succeeds(folder.path(), "diff bare.json loaded.json");
    let line = |start: &str| {
        told.lines().find(|line| line.trim_start().starts_with(start)).unwrap_or_else(|| panic!("{told}"))
    };
    assert!(!line("in all").contains('%'), "{told}");
    let left_out = "links.platform.com.x (it does not stand in A, where it is 0)";
    assert!(line("incomplete: no slope is known in").contains(left_out), "{told}");
}

/// Two optima of different kinds: what the numbers are worth is told by the motion that is carried over.
#[test]
fn two_local_optima_are_told_from_one_that_moved() {
    let folder = tempdir().unwrap();
    let asked = format!("optimize curvet --criterion torque --speed 0.4 --examine quick --quiet --robot {SHIPPED}");
    for (name, options) in [
        ("a", "--starts 1"),
        ("b", "--starts 6 --set links.thigh.mass=1.598"),
        ("near", "--starts 1 --set links.thigh.mass=1.598"),
        ("again", "--starts 1 --seed 5"),
    ] {
        succeeds(folder.path(), &format!("{asked} {options} --json {name}.json"));
    }
    let diff = |b: &str| succeeds(folder.path(), &format!("diff a.json {b}.json"));
    let carried = |b: &str| -> Value {
        serde_json::from_str::<Value>(&succeeds(folder.path(), &format!("diff a.json {b}.json --json -"))).unwrap()["carried"].take()
    };
    let cost = |name: &str| -> f64 {
        let text = std::fs::read_to_string(folder.path().join(format!("{name}.json"))).unwrap();
        serde_json::from_str::<Value>(&text).unwrap()["cost"].as_f64().unwrap()
    };
    assert!(!diff("near").contains("other optimum"), "{}", diff("near"));
    let (told, arrived) = (diff("b"), carried("b"));
    assert!(told.contains("other optimum   the motion of A, carried over to B, costs"), "{told}");
    assert!(told.contains("A is not the best of its kind"), "{told}");
    // It is the optimum that is found with the same numbers from the same start.
    assert!((arrived["a"]["cost"].as_f64().unwrap() / cost("near") - 1.0).abs() < 1e-6, "{arrived}");
    assert_eq!(arrived["a"]["is_found"], false);
    assert!(diff("again").contains("B costs as much as A"), "{}", diff("again"));
}
