//! The shipped specifications say what they should, the schemas are up to date, and no input makes the pass
//! panic. Messages are tested in `tests/ui.rs`.

use std::fs;
use std::path::{Path, PathBuf};

use super::*;

fn model_spec() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../model-spec")
}

fn read(path: &str) -> String {
    fs::read_to_string(model_spec().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

fn rendered(found: Vec<Diagnostic>) -> String {
    found.iter().map(|d| d.render() + "\n").collect()
}

fn shipped_robot() -> RobotFile {
    parse_robot("robot.toml", &read("robot.toml")).unwrap_or_else(|found| panic!("{}", rendered(found)))
}

fn shipped_gait(name: &str) -> Gait {
    let path = format!("gaits/{name}.toml");
    parse_gait(&path, &read(&path), &shipped_robot()).unwrap_or_else(|found| panic!("{}", rendered(found)))
}

fn diagonal(moments: [f64; 3]) -> Inertia {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { moments[i] } else { 0.0 }))
}

#[test]
#[allow(clippy::approx_constant)] // the stops are decimal numbers
fn the_shipped_robot() {
    let robot = shipped_robot().robot;
    assert_eq!((robot.name.as_str(), robot.gravity), ("quadruped", 9.81));
    let platform = Platform {
        name: "platform".into(),
        mass: 6.65,
        com: [0.0; 3],
        inertia: diagonal([0.2031, 0.5188, 0.3157]),
        extent: None,
    };
    assert_eq!(robot.platform, platform);
    let mounts: Vec<_> = robot.legs.iter().map(|leg| (leg.name.as_str(), leg.mount)).collect();
    assert_eq!(
        mounts,
        [
            ("fore_left", [0.187, 0.0, -0.15]),
            ("fore_right", [0.187, 0.0, 0.15]),
            ("hind_left", [-0.187, 0.0, -0.15]),
            ("hind_right", [-0.187, 0.0, 0.15]),
        ]
    );
    let motor = |name: &str, unloaded_speed, loaded_speed| Actuator {
        name: name.into(),
        gear: 50.0,
        max_torque: 0.4,
        unloaded_speed,
        loaded_speed,
        rotor_inertia: 0.0,
    };
    let segment = |joint: &str, range, actuator, link: &str, mass, com: f64, inertia| Segment {
        joint: Joint {
            name: joint.into(),
            axis: Axis::Pitch,
            range,
            spring: Spring::default(),
            friction: Friction::default(),
            actuator,
        },
        link: Link {
            name: link.into(),
            mass,
            end: [0.0, -0.15, 0.0],
            com: [0.0, -com, 0.0],
            inertia: diagonal([inertia, 0.0, inertia]),
            foot_mass: 0.0,
            locked: Vec::new(),
        },
    };
    let chain = [
        segment("haunch", [-0.5236, 1.0472], motor("haunch_motor", 5000.0, 3300.0), "thigh", 1.6, 0.139, 0.00215),
        segment("knee", [-1.7453, -0.2618], motor("knee_motor", 6600.0, 4200.0), "shin", 0.2, 0.083, 0.0017),
    ];
    for leg in &robot.legs {
        assert_eq!(leg.chain, chain);
    }
    let mass: f64 = robot.legs.iter().flat_map(|leg| &leg.chain).map(|s| s.link.mass).sum();
    assert!((robot.platform.mass + mass - 13.85).abs() < 1e-12, "§2: 13.85 kg in all");
}

#[test]
fn the_shipped_gaits() {
    let limits = Limits {
        friction: 1.0,
        min_vertical_force: 10.0,
        swing_clearance: 0.005,
        min_platform_height: 0.0,
        body_clearance: 0.0,
    };
    let gait = |name: &str, virtual_legs, rotation, unactuated, then, longest| Gait {
        name: name.into(),
        virtual_legs,
        locked: Vec::new(),
        rotation,
        unactuated,
        phases: Phases::half_steps(then, [0.05, longest]),
        polynomial_order: 4,
        limits: limits.clone(),
    };
    let haunch = Unactuated::Joint { leg: 0, joint: 0 };
    assert_eq!(
        shipped_gait("trot"),
        gait("trot", [vec![0, 3], vec![1, 2]], Rotation::None, haunch, Then::Mirrored, 2.0)
    );
    assert_eq!(
        shipped_gait("amble"),
        gait("amble", [vec![1, 3], vec![0, 2]], Rotation::Roll, Unactuated::Platform, Then::Mirrored, 2.0)
    );
    assert_eq!(
        shipped_gait("curvet"),
        gait("curvet", [vec![2, 3], vec![0, 1]], Rotation::Pitch, Unactuated::Platform, Then::Repeat, 0.5)
    );
}

/// The trot with a flight after each stance.
fn running_trot() -> String {
    let short = |line: &&str| !line.starts_with("half_step");
    let trot = read("gaits/trot.toml");
    trot.lines().filter(short).collect::<Vec<_>>().join("\n")
        + "\n\n[[phases]]\nstance = [\"leg1\"]\nduration = [0.05, 2.0]\n\n[[phases]]\nstance = []\nduration = [0.02, 0.5]\n\n\
           [cycle]\nthen = \"mirrored\"\n"
}

#[test]
fn a_list_of_phases() {
    let gait = parse_gait("trot.toml", &running_trot(), &shipped_robot());
    let list = vec![Phase { stance: Some(0), duration: [0.05, 2.0] }, Phase { stance: None, duration: [0.02, 0.5] }];
    let phases = Phases { list, then: Then::Mirrored, half_steps: false };
    assert_eq!(gait.unwrap_or_else(|found| panic!("{}", rendered(found))), Gait { phases, ..shipped_gait("trot") });
}

/// `BLESS=1 cargo test` writes them anew.
#[test]
fn the_schemas_are_up_to_date() {
    for (path, schema) in [("schema/robot.schema.json", robot_schema()), ("schema/gait.schema.json", gait_schema())] {
        let path = model_spec().join(path);
        if std::env::var_os("BLESS").is_some() {
            fs::write(&path, &schema).expect("written");
        }
        let stored = fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(stored, schema, "{}: BLESS=1 writes it anew", path.display());
    }
}

/// Defaults, and a name that is given rather than the file's.
#[test]
fn what_may_be_left_out() {
    let text = read("robot.toml").replace("axis = \"pitch\"\n", "");
    let robot = parse_robot("robot.toml", &text).unwrap_or_else(|found| panic!("{}", rendered(found)));
    assert_eq!(robot.robot, shipped_robot().robot);
    let trot = read("gaits/trot.toml").replace("[limits]", "[limits]\nmin_platform_height = 0.12");
    let text = format!("name = \"slow_trot\"\npolynomial_order = 6\n{trot}");
    let gait = parse_gait("elsewhere/trot.toml", &text, &robot).unwrap_or_else(|found| panic!("{}", rendered(found)));
    assert_eq!((gait.name.as_str(), gait.polynomial_order), ("slow_trot", 6));
    assert_eq!(gait.limits.min_platform_height, 0.12);
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_text() {
    let marked = |path: &str| format!("\u{feff}{}", read(path));
    let text = marked("robot.toml");
    let robot = parse_robot("robot.toml", &text).unwrap_or_else(|found| panic!("{}", rendered(found)));
    assert_eq!(robot.robot, shipped_robot().robot);
    assert!(parse_gait("trot.toml", &marked("gaits/trot.toml"), &robot).is_ok());
    let heavier = set(&text, "links.thigh.mass", 3.5).unwrap();
    assert_eq!(number(&heavier, "links.thigh.mass"), Some(3.5));
    assert!(parse_robot("robot.toml", &heavier).is_ok());
    assert!(parse_robot("robot.toml", &super::load(&text, 1.0, [0.0; 3]).unwrap()).is_ok());
}

/// A mass centre as a vector is the same as a distance along the link, which points along -y.
#[test]
fn two_ways_to_write_a_mass_centre() {
    let text = read("robot.toml").replace("com = 0.139 ", "com = [0.0, -0.139, 0.0] ");
    assert_ne!(text, read("robot.toml"));
    let robot = parse_robot("robot.toml", &text).unwrap_or_else(|found| panic!("{}", rendered(found)));
    let shipped = shipped_robot().robot;
    assert_ne!(robot.robot.written, shipped.written);
    assert_eq!(Robot { written: shipped.written.clone(), ..robot.robot }, shipped);
}

/// Inputs that break parsers: nothing panics, each is refused, each message can be shown.
#[test]
fn hostile_inputs() {
    let robot = shipped_robot();
    let nested = |open: &str, close: &str, n: usize| format!("a = {}{}", open.repeat(n), close.repeat(n));
    let inputs = [
        String::new(),
        "\u{feff}".into(),
        "\0".into(),
        "é = \"".into(),
        "\r\n\r\n= 1\r\n".into(),
        nested("[", "]", 100_000),
        nested("[", "", 1000),
        nested("{a=", "}", 10_000),
        format!("{}a = 1", "a.".repeat(100_000)),
        format!("[{}a]", "a.".repeat(10_000)),
        format!("name = \"{}\"", "x".repeat(1_000_000)),
        format!("gravity = {}", "9".repeat(100_000)),
        "gravity = 0x".to_string() + &"f".repeat(1000),
        "\"\" = 1\n'\\u0000' = 2".into(),
        "name = \"\\u0000\\u202e\"\nlinks = []\njoints = [[]]\nlegs = 1\nactuators = \"\"".into(),
        "[[links]]\n[[joints]]\n[[legs]]\n[[actuators]]".into(),
        "links.a.b.c = 1\nlinks.\"\".x = 1\njoints.\"\u{1f434}\" = {}".into(),
        "virtual_legs = [[], [[]], 1]\nplatform = []\nunactuated = []\nlimits = 1979-05-27".into(),
    ];
    for text in inputs {
        refuse(parse_robot("robot.toml", &text).err());
        refuse(parse_gait("trot.toml", &text, &robot).err());
        refuse(parse_gait("", &text, &robot).err());
    }
    refuse(parse_gait("", &read("gaits/trot.toml"), &robot).err());
}

fn refuse(found: Option<Vec<Diagnostic>>) {
    let found = found.expect("broken input");
    assert!(!found.is_empty(), "refused without a word");
    // Rendering scans the whole text: a few messages of each are enough.
    assert!(found.iter().take(5).all(|d| d.render().starts_with("error[S")));
}

/// Inputs that are large in every way that a file can be: each is refused in a moment, with few words.
#[test]
fn huge_inputs() {
    const N: usize = 200_000;
    let robot = shipped_robot();
    let (spec, trot) = (read("robot.toml"), read("gaits/trot.toml"));
    let many = |line: &dyn Fn(usize) -> String| (0..N).map(line).collect::<String>();
    let list = |item: &str| format!("[{}]", format!("{item}, ").repeat(N));
    let robots = [
        many(&|k| format!("key_{k} = {k}\n")),
        format!("{}\n{spec}", many(&|k| format!("key_{k} = {k}\n"))),
        format!("{spec}\n{}", many(&|k| format!("[links.l{k}]\nmas = 1\n"))),
        format!("{spec}\n[legs.more]\n{}", many(&|k| format!("mount_{k} = [0, 0, {k}]\n"))),
        format!("{spec}\n{}", many(&|k| format!("[joints.j{k}]\nparent = \"l{k}\"\nchild = \"l{}\"\n", k + 1))),
        format!("{spec}\n{}", many(&|k| format!("[actuators.a{k}]\ngear = 1\n"))),
        spec.replace("[0.187, 0.0, -0.15]", &list("0.0")),
        spec.replace("name = \"quadruped\"", &format!("name = \"{}\"", "x\\n".repeat(N))),
        spec.replace("parent = \"platform\"", &format!("parent = \"{}\"", "x".repeat(5 * N))),
        "= 1\n\n\n\n".repeat(N),
    ];
    let gaits = [
        trot.replace("virtual_legs = [", &format!("virtual_legs = [{} [", list("\"fore_left\"") + ",")),
        trot.replace("virtual_legs = [", &format!("virtual_legs = [{}", "[\"fore_left\"], ".repeat(N))),
        trot.replace("moves = [", &format!("moves = [{}", "\"y\", ".repeat(N))),
        format!("{trot}\n[locked]\n{}", many(&|k| format!("joint_{k} = 0.0\n"))),
        running_trot() + &"[[phases]]\nstance = []\nduration = [0.02, 0.5]\n".repeat(N),
        running_trot().replace("[\"leg1\"]", &list("\"leg1\"")),
    ];
    for (k, text) in robots.iter().chain(&gaits).enumerate() {
        assert!(text.len() > N, "{k}: nothing was replaced");
        let started = std::time::Instant::now();
        let found = match k < robots.len() {
            true => parse_robot("robot.toml", text).err(),
            false => parse_gait("trot.toml", text, &robot).err(),
        };
        let found = found.unwrap_or_else(|| panic!("{k}: accepted"));
        assert!((1..=200).contains(&found.len()), "{k}: {}", found.len());
        let words: usize = found.iter().take(5).map(|d| d.render().len()).sum();
        let seconds = started.elapsed().as_secs_f64();
        assert!(words < 50_000, "{k}: {words} characters");
        println!("{k}: {seconds:.2} s, {} mistakes, {words} characters", found.len());
        assert!(seconds < 10.0, "{k}: {seconds:.1} s");
    }
}

/// Thousands of small accidents to the shipped files: nothing panics, and whoever is refused is told why.
#[test]
fn accidents() {
    let robot = shipped_robot();
    let mut dice = Dice(0x9e37_79b9_7f4a_7c15);
    let text = read("robot.toml");
    let (mut refused, mut accepted) = (0, 0);
    for _ in 0..3000 {
        match parse_robot("robot.toml", &dice.damage(&text)) {
            Ok(robot) => {
                accepted += 1;
                for gait in ["trot", "amble", "curvet"] {
                    let path = format!("gaits/{gait}.toml");
                    let parsed = parse_gait(&path, &read(&path), &robot);
                    if let Err(found) = parsed {
                        refuse(Some(found));
                    }
                }
            }
            Err(found) => {
                refused += 1;
                refuse(Some(found));
            }
        }
    }
    let gaits = ["trot", "amble", "curvet"].map(|gait| read(&format!("gaits/{gait}.toml")));
    for text in gaits.into_iter().chain([running_trot()]) {
        for _ in 0..1000 {
            if let Err(found) = parse_gait("gait.toml", &dice.damage(&text), &robot) {
                refuse(Some(found));
            }
        }
    }
    assert!(refused > 300 && accepted > 100, "{refused} refused, {accepted} accepted");
}

/// A xorshift generator: the same accidents in every run.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % n.max(1)
    }

    /// One to three accidents to lines, words or characters.
    fn damage(&mut self, text: &str) -> String {
        const WORDS: &[&str] = &[
            "inf",
            "nan",
            "-1",
            "0",
            "1e400",
            "\"\"",
            "[]",
            "{}",
            "[[1]]",
            "true",
            "=",
            "\"",
            "\n",
            "[a]",
            "é",
            "\0",
            "\"thigh\"",
            "\"platform\"",
            "\"shin\"",
            "\"haunch\"",
            "\"fore_left\"",
            "roll",
            "[links.x]",
            "[[phases]]",
            "\"leg2\"",
            ".",
            "#",
        ];
        let mut lines: Vec<String> = text.lines().map(str::to_string).collect();
        for _ in 0..=self.below(3) {
            let (i, j) = (self.below(lines.len()), self.below(lines.len()));
            match self.below(6) {
                0 => drop(lines.remove(i)),
                1 => lines.swap(i, j),
                2 => lines[i] = lines[j].clone(),
                3 => lines[i] = lines[i].chars().filter(|_| self.below(8) > 0).collect(),
                4 => {
                    let mut words: Vec<&str> = lines[i].split(' ').collect();
                    let k = self.below(words.len());
                    words[k] = WORDS[self.below(WORDS.len())];
                    lines[i] = words.join(" ");
                }
                _ => {
                    let at = self.below(lines[i].chars().count() + 1);
                    let word = WORDS[self.below(WORDS.len())];
                    let (a, b): (Vec<_>, Vec<_>) = lines[i].chars().enumerate().partition(|(k, _)| *k < at);
                    let text = |part: Vec<(usize, char)>| part.into_iter().map(|(_, c)| c).collect::<String>();
                    lines[i] = text(a) + word + &text(b);
                }
            }
        }
        lines.join("\n")
    }
}

/// Whatever stands in a file or in its name, messages turn neither a terminal's colours on nor its writing round.
#[test]
fn messages_show_every_character() {
    let (robot, path) = (read("robot.toml"), "a\n\u{1b}[31m\u{9b}b/robot.toml");
    let hostile = "\u{202e}\u{200b}\u{9b}31m\u{e0001}";
    for text in
        [robot.replace("thigh", hostile), robot.replace("mass", hostile), format!("{robot}\nz = \u{1b}[31m{hostile}")]
    {
        let mistakes = parse_robot(path, &text).unwrap_err();
        for shown in mistakes.iter().map(Diagnostic::render) {
            let unseen = shown.chars().find(|c| *c != '\n' && !name::is_visible(*c));
            assert_eq!(unseen, None, "{shown:?}");
        }
        assert!(mistakes[0].render().contains(r"a\n\u{1b}[31m\u{9b}b/robot.toml:"));
    }
}
