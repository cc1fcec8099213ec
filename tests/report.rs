//! Reports as a person reads them: in a browser where there is one, and as files.

#[path = "report/browser.rs"]
mod browser;

use browser::Browser;
use piaffe::gaits::GAITS;
use piaffe::result::GaitResult;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

fn piaffe(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_piaffe")).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A folder with an optimum of every gait, and their report.
static RESULTS: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    for gait in ["trot", "amble", "curvet"] {
        let file = folder.path().join(format!("{gait}.json"));
        let arguments = ["optimize", gait, "--criterion", "torque", "--speed", "0.6", "--starts", "1", "--json"];
        let out = piaffe(&[&arguments[..], &[file.to_str().unwrap()]].concat());
        assert!(out.status.success(), "{}", text(&out.stderr));
    }
    let (results, report) = (folder.path().to_str().unwrap(), folder.path().join("report"));
    let out = piaffe(&["report", results, "--out", report.to_str().unwrap()]);
    assert!(out.status.success(), "{}", text(&out.stderr));
    folder
});

fn report() -> PathBuf {
    RESULTS.path().join("report")
}

fn page() -> String {
    format!("file://{}", report().join("index.html").display())
}

fn result(gait: &str) -> GaitResult {
    serde_json::from_slice(&std::fs::read(RESULTS.path().join(format!("{gait}.json"))).unwrap()).unwrap()
}

fn number(value: Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

const TROT: &str = "[id='trot-torque-0.6']";

#[test]
fn the_walk_plays_pauses_and_is_scrubbed() {
    let Some(mut b) = Browser::open(1280, 900, false) else { return };
    b.load(&page());
    let pose = format!("document.querySelector(\"{TROT} .stage path[stroke-width='8']\").getAttribute('d')");
    let clock = format!("document.querySelector(\"{TROT} output\").value");
    let cursor =
        format!("+document.querySelector(\"{TROT} [data-figure$='/torques'] line.s-text\").getAttribute('x1')");
    let (still, start) = (b.eval(&pose), b.eval(&clock));
    b.wait(200);
    assert_eq!(b.eval(&pose), still, "it plays without being asked to");

    b.click(&format!("{TROT} .play"));
    b.wait(600);
    assert_ne!(b.eval(&pose), still);
    assert_ne!(b.eval(&clock), start);
    b.click(&format!("{TROT} .play"));
    let (paused, x) = (b.eval(&pose), number(b.eval(&cursor)));
    b.wait(200);
    assert_eq!(b.eval(&pose), paused, "it goes on after the pause");

    let scrub = format!(
        "(() => {{ const s = document.querySelector(\"{TROT} .time\"); s.value = 750; s.dispatchEvent(new Event('input')) }})()"
    );
    b.eval(&scrub);
    assert_ne!(b.eval(&pose), paused);
    assert_ne!(number(b.eval(&cursor)), x, "the figures' cursor stays");
    let duration: f64 = 2.0 * result("trot").durations[0];
    let shown = b.eval(&clock).as_str().unwrap().to_string();
    assert!(shown.starts_with(&format!("{:.3}", 0.75 * duration)), "{shown}");

    // Other views, and turning by hand.
    for view in ["side", "behind"] {
        let before = b.eval(&pose);
        b.click(&format!("{TROT} [data-view={view}]"));
        assert_ne!(b.eval(&pose), before, "{view}");
    }
    let (before, at) = (b.eval(&pose), b.middle(&format!("{TROT} .stage > svg")));
    b.mouse("mousePressed", at);
    b.mouse("mouseMoved", [at[0] + 60.0, at[1] + 20.0]);
    b.mouse("mouseReleased", [at[0] + 60.0, at[1] + 20.0]);
    assert_ne!(b.eval(&pose), before, "it does not turn");
    assert!(b.errors().is_empty(), "{:?}", b.errors());
}

#[test]
fn pointing_at_a_curve_tells_its_values_and_a_click_goes_there() {
    let Some(mut b) = Browser::open(1280, 900, false) else { return };
    b.load(&page());
    let at = b.middle(&format!("{TROT} [data-figure$='/torques'] svg"));
    b.mouse("mouseMoved", at);
    let told = b.eval("document.getElementById('tip').innerText").as_str().unwrap().to_string();
    for joint in ["haunch1", "knee1", "haunch2", "knee2"] {
        assert!(told.contains(joint), "{told}");
    }
    assert!(told.starts_with("time ") && told.matches(" N·m").count() == 4, "{told}");
    b.click(&format!("{TROT} [data-figure$='/torques'] svg"));
    let clock = b.eval(&format!("document.querySelector(\"{TROT} output\").value"));
    let told_time: f64 = told.split(' ').nth(1).unwrap().parse().unwrap();
    let shown: f64 = clock.as_str().unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((told_time - shown).abs() < 1e-3, "{told_time} and {shown}");
    assert!(b.errors().is_empty(), "{:?}", b.errors());
}

/// What is drawn that is not there, sticks out of its drawing, or lies on another text.
const FLAWS: &str = "
    [...document.querySelectorAll('figure')].flatMap(f => {
        const svg = f.querySelector('svg'), name = f.dataset.figure, box = svg.getBoundingClientRect();
        const texts = [...svg.querySelectorAll('text')].map(t => [t.textContent, t.getBoundingClientRect()]);
        const flaws = [];
        if (svg.querySelectorAll('path').length < 3) flaws.push(name + ' is empty');
        texts.forEach(([t, a], i) => {
            if (a.left < box.left - 1 || a.right > box.right + 1 || a.top < box.top - 1 || a.bottom > box.bottom + 1)
                flaws.push(`${name}: ${t} sticks out`);
            texts.slice(i + 1).forEach(([u, b]) => {
                const w = Math.min(a.right, b.right) - Math.max(a.left, b.left);
                const h = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
                if (w > 1 && h > 3) flaws.push(`${name}: ${t} and ${u} overlap`);
            });
        });
        return flaws;
    })";

#[test]
fn the_page_needs_nothing_else_and_fits_desk_and_phone() {
    for (name, width, height, phone) in [("desk.png", 1280, 1500, false), ("phone.png", 390, 844, true)] {
        let Some(mut b) = Browser::open(width, height, phone) else { return };
        b.load(&page());
        let fetched: Vec<String> = b.requests().into_iter().filter(|r| !r.starts_with("data:")).collect();
        assert_eq!(fetched, [page()], "something is fetched");
        assert!(b.errors().is_empty(), "{:?}", b.errors());
        assert!(number(b.eval("document.documentElement.scrollWidth")) <= f64::from(width), "{name} is too wide");
        // What is drawn is there, within its drawing, and no text lies on another.
        let flaws = b.eval(FLAWS);
        assert_eq!(flaws, serde_json::json!([]), "{name}");
        // A moment in the middle of a swing.
        let show = "document.querySelector(\"TROT\").scrollIntoView({ behavior: 'instant' });
            const s = document.querySelector(\"TROT .time\"); s.value = 230; s.dispatchEvent(new Event('input'))";
        b.eval(&show.replace("TROT", TROT));
        b.keep("report", name);
    }
}

#[test]
fn the_numbers_are_those_of_the_results() {
    let html = std::fs::read_to_string(report().join("index.html")).unwrap();
    for gait in ["trot", "amble", "curvet"] {
        let r = result(gait);
        // Six significant digits of the cost, three of the cost of transport.
        let cost = r.cost.unwrap();
        let digits = 5 - cost.log10().floor() as usize;
        assert!(html.contains(&format!("<p class=\"cost\">{cost:.digits$} ")), "{gait}");
        let description = GAITS.iter().map(|g| g.description()).find(|d| d.key == gait).unwrap();
        let weight = description.bodies.iter().map(|b| b.mass).sum::<f64>() * description.gravity;
        let transport = r.costs.unwrap().energy / weight;
        let digits = (2.0 - transport.log10().floor()) as usize;
        assert!(html.contains(&format!("<td class=\"n\">{transport:.digits$}</td>")), "{gait}: {transport}");
        for finding in &r.receipt.unwrap().findings {
            assert!(html.contains(&finding.constraint), "{gait}: {}", finding.constraint);
        }
    }
    assert!(
        !html.contains("http://")
            || html.matches("http://").count() == html.matches("http://www.w3.org/2000/svg").count()
    );
}

#[test]
fn every_figure_is_a_file_that_others_can_read() {
    let figures: Vec<PathBuf> =
        std::fs::read_dir(report().join("figures")).unwrap().map(|entry| entry.unwrap().path()).collect();
    let of =
        |extension: &str| figures.iter().filter(|f| f.extension().unwrap() == extension).cloned().collect::<Vec<_>>();
    let (svg, pdf) = (of("svg"), of("pdf"));
    assert!(svg.len() > 35 && svg.len() == pdf.len());
    for file in &svg {
        let text = std::fs::read_to_string(file).unwrap();
        assert!(!text.contains("NaN") && !text.contains("inf"), "{}", file.display());
        assert!(text.starts_with("<svg") && text.ends_with("</svg>"), "{}", file.display());
    }
    for file in &pdf {
        let bytes = std::fs::read(file).unwrap();
        assert!(bytes.starts_with(b"%PDF-") && bytes.ends_with(b"%%EOF"), "{}", file.display());
    }
}

/// In flight there is no force that friction could be a share of, and no foot to have a momentum about.
#[test]
fn a_gait_that_flies_is_drawn_with_numbers_alone() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let asked = ["optimize", "running_trot", "--criterion", "torque", "--speed", "1", "--starts", "1", "--json"];
    assert!(piaffe(&[&asked[..], &[&at("run.json")]].concat()).status.success());
    assert!(piaffe(&["report", &at("run.json"), "--out", &at("page")]).status.success());
    for entry in std::fs::read_dir(folder.path().join("page/figures")).unwrap() {
        let file = entry.unwrap().path();
        let drawn = text(&std::fs::read(&file).unwrap());
        assert!(!drawn.contains("NaN") && !drawn.contains("inf "), "{}", file.display());
    }
    let html = std::fs::read_to_string(folder.path().join("page/index.html")).unwrap();
    let data = html.split("data-of=\"running_trot-torque-1\">").nth(1).unwrap().split("</script>").next().unwrap();
    let data: Value = serde_json::from_str(data).unwrap();
    for (name, figure) in data["figures"].as_object().unwrap() {
        for curve in figure["curves"].as_array().unwrap() {
            let numbers = |axis: &str| curve[axis].as_array().unwrap().iter().all(Value::is_number);
            assert!(numbers("x") && numbers("y"), "{name}: {}", curve["name"]);
        }
    }
    assert!(html.contains("in flight, G") && !html.contains("recover from a push where it is farther"), "momentum");
}

/// A robot that weighs three times as much spends more, and less of its weight.
#[test]
fn robots_of_any_weight_compare_by_their_cost_of_transport() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    for (gait, file) in [("trot", "trot.json"), ("rabbit/walk", "walk.json")] {
        let asked = ["optimize", gait, "--speed", "0.6", "--starts", "1", "--json", &at(file)];
        assert!(piaffe(&asked).status.success());
    }
    assert!(piaffe(&["report", &at("trot.json"), &at("walk.json"), "--out", &at("page")]).status.success());
    let html = std::fs::read_to_string(folder.path().join("page/index.html")).unwrap();
    let table = html.split("<table class=\"compare\">").nth(1).unwrap().split("</table>").next().unwrap();
    let place = |name: &str| table.find(name).unwrap_or_else(|| panic!("no {name} in {table}"));
    assert!(
        place("Rabbit/walk, RABBIT") < place("</span> the best")
            && place("</span> the best") < place("Trot, quadruped"),
        "{table}"
    );
}

#[test]
fn what_cannot_be_shown_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("result.json");
    let out = folder.path().join("report");
    let attempt = |value: &Value| {
        std::fs::write(&file, value.to_string()).unwrap();
        let done = piaffe(&["report", file.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        assert_eq!(done.status.code(), Some(1));
        assert!(!out.exists(), "a report was written nevertheless");
        text(&done.stderr)
    };
    let good = serde_json::to_value(result("trot")).unwrap();
    let mut other = good.clone();
    other["fingerprint"] = "0".into();
    assert!(attempt(&other).contains("another robot"));
    let mut cheaper = good.clone();
    cheaper["cost"] = (good["cost"].as_f64().unwrap() * 0.99).into();
    assert!(attempt(&cheaper).contains("is not confirmed"));
    // Someone edits the speed: the motion is no answer to that question.
    let mut faster = good.clone();
    faster["speed"] = 1.2.into();
    let told = attempt(&faster);
    assert!(told.contains("is not confirmed") && told.contains("no optimum"), "{told}");
    let mut short = good.clone();
    short["variables"][0]["q_final"] = serde_json::json!([0.1]);
    assert!(attempt(&short).contains("is not confirmed"));
    let mut unknown = good.clone();
    unknown["gait"] = "gallop".into();
    assert!(attempt(&unknown).contains("another robot"));
    unknown.as_object_mut().unwrap().remove("specification");
    assert!(attempt(&unknown).contains("no gait `gallop`"));
    let mut failed = good;
    failed["status"] = "infeasible".into();
    assert!(attempt(&failed).contains("is not confirmed"));
}

#[test]
fn the_same_results_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let again = folder.path().to_str().unwrap();
    assert!(piaffe(&["report", RESULTS.path().to_str().unwrap(), "--out", again]).status.success());
    let read = |at: &Path, name: &str| std::fs::read(at.join(name)).unwrap();
    for name in ["index.html", "figures/trot-torque-0.6-torques.svg", "figures/trot-torque-0.6-torques.pdf"] {
        assert!(read(folder.path(), name) == read(&report(), name), "{name} differs");
    }
}

#[test]
fn every_gait_says_what_stands_behind_it_and_what_does_not() {
    let html = std::fs::read_to_string(report().join("index.html")).unwrap();
    let head = |gait: &str| {
        let section = html.split(&format!("<section class=\"walk\" id=\"{gait}-torque-0.6\">")).nth(1).unwrap();
        section.split("</ul>").next().unwrap().to_string()
    };
    for gait in ["trot", "amble", "curvet"] {
        let head = head(gait);
        assert!(head.contains("Receipt") && head.contains("<b class=\"holds\">holds</b>"), "{head}");
        assert!(head.contains("Between the instants") && head.contains("<b class=\"holds\">certified</b>"), "{head}");
    }
    assert!(head("trot").contains("<b class=\"holds\">equal shares</b>"));
    // The real amble cannot be done so: no green mark stands there.
    let amble = head("amble");
    assert!(amble.contains("<b class=\"fails\">beyond limits</b>") && amble.contains("% of the step"), "{amble}");
    let overview = html.split("id=\"overview\"").nth(1).unwrap().split("</section>").next().unwrap();
    assert_eq!(overview.matches(">beyond limits</span>").count(), 2, "in the comparison and among all results");
    // Which is better, by how much: the trot is a third of the amble.
    let ratio = result("amble").cost.unwrap() / result("trot").cost.unwrap();
    assert!(overview.contains("the best") && overview.contains(&format!("×{ratio:.2}")), "{overview}");
}

/// The report of a copy of a folder's results, some of them changed, and the page, if there is one.
fn changed(results: &Path, change: impl Fn(&str, &mut Value)) -> (Output, Option<String>) {
    let folder = tempfile::tempdir().unwrap();
    for file in std::fs::read_dir(results).unwrap().map(|e| e.unwrap().path()) {
        if file.extension().is_some_and(|e| e == "json") {
            let name = file.file_name().unwrap().to_str().unwrap();
            let mut value: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
            change(name, &mut value);
            std::fs::write(folder.path().join(name), value.to_string()).unwrap();
        }
    }
    let out = folder.path().join("report");
    let done = piaffe(&["report", folder.path().to_str().unwrap(), "--out", out.to_str().unwrap()]);
    (done, std::fs::read_to_string(out.join("index.html")).ok())
}

#[test]
fn what_is_not_confirmed_is_shown_as_that_among_others() {
    let (_, html) = changed(RESULTS.path(), |name, value| {
        if name == "trot.json" {
            value["speed"] = 1.2.into();
            value["message"] = "the best gait ever".into();
        }
    });
    let html = html.unwrap();
    assert!(html.contains("2 local optima") && html.contains("One result could not be confirmed"));
    assert!(html.contains("Not confirmed") && html.contains("trot-torque-1.2 is not confirmed"));
    assert!(!html.contains("id=\"trot-torque-1.2\""), "its walk is shown");
    assert!(!html.contains("least torque at 1.2 m/s"), "its claim is repeated");
    // Nor is anything else believed that is said of a motion.
    let (_, html) = changed(RESULTS.path(), |name, value| {
        if name == "amble.json" {
            value["real_legs"]["support"]["margin"] = 1.0.into();
        }
    });
    let html = html.unwrap();
    assert!(html.contains("amble-torque-0.6 is not confirmed") && !html.contains("id=\"amble-torque-0.6\""));
}

/// A sweep of two gaits, with a crossing, greatest speeds and a jump of the amble's.
static SWEEP: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["sweep", "--gait", "trot", "--gait", "amble", "--starts", "2"];
    let more = ["--speeds", "0.4,0.5,0.6,1.0,1.05", "--out", folder.path().to_str().unwrap()];
    let out = piaffe(&[&arguments[..], &more].concat());
    assert!(out.status.success(), "{}", text(&out.stderr));
    folder
});

/// The points of a sweep, by speed.
fn points(gait: &str, criterion: &str) -> Vec<(f64, f64, f64)> {
    let summary: Value = serde_json::from_slice(&std::fs::read(SWEEP.path().join("sweep.json")).unwrap()).unwrap();
    let of_gait = summary["points"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|p| [&p["gait"], &p["criterion"], &p["status"]] == [gait, criterion, "optimal"]);
    of_gait
        .map(|p| [&p["speed"], &p["cost"], &p["durations"][0]].map(|v| number(v.clone())))
        .map(|[v, c, t]| (v, c, t))
        .collect()
}

#[test]
fn a_sweeps_page_says_what_it_draws() {
    for (width, height, phone) in [(1280, 1500, false), (390, 844, true)] {
        let Some(mut b) = Browser::open(width, height, phone) else { return };
        b.load(&format!("file://{}", SWEEP.path().join("index.html").display()));
        assert_eq!(b.eval(FLAWS), serde_json::json!([]));
        assert!(b.errors().is_empty(), "{:?}", b.errors());
        b.keep("report", if phone { "sweep-phone.png" } else { "sweep-desk.png" });
        let pills = b.eval("[...document.querySelectorAll('nav a')].map(a => a.innerText)");
        let mut pills: Vec<&str> = pills.as_array().unwrap().iter().map(|p| p.as_str().unwrap()).collect();
        let count = pills.len();
        pills.sort_unstable();
        pills.dedup();
        assert_eq!(pills.len(), count, "{pills:?}");

        // The ring of the crossing is where the lines cross, and the words have its speed.
        let figure = "document.querySelector(\"[data-figure='overview/speed-energy']\")";
        let data =
            "JSON.parse(document.querySelector(\"script[data-of='overview']\").textContent).figures['speed-energy']";
        let rings = b.eval(&format!(
            "[...{figure}.querySelectorAll(\"circle[r='5.2']\")].map(c => [+c.getAttribute('cx'), +c.getAttribute('cy')])"
        ));
        let curves = b.eval(&format!("{data}.curves"));
        let (x, y) = (b.eval(&format!("{data}.x")), b.eval(&format!("{data}.y")));
        let place = |axis: &Value, value: f64| {
            let [a, b, from, to] = [&axis["domain"][0], &axis["domain"][1], &axis["range"][0], &axis["range"][1]]
                .map(|v| number(v.clone()));
            from + (value - a) / (b - a) * (to - from)
        };
        let at = |curve: &Value, speed: f64| {
            let [xs, ys] =
                ["x", "y"].map(|k| curve[k].as_array().unwrap().iter().map(|v| number(v.clone())).collect::<Vec<_>>());
            let k = xs.iter().rposition(|v| *v <= speed).unwrap().min(xs.len() - 2);
            ys[k] + (speed - xs[k]) / (xs[k + 1] - xs[k]) * (ys[k + 1] - ys[k])
        };
        let told = b.eval("document.querySelector('#overview').innerText").as_str().unwrap().to_string();
        let line = told
            .lines()
            .find(|l| l.contains("energy: the amble overtakes the trot "))
            .unwrap_or_else(|| panic!("{told}"));
        let said: Vec<f64> = line.split(' ').filter_map(|word| word.parse().ok()).collect();
        let ring: Vec<f64> =
            rings.as_array().unwrap().last().unwrap().as_array().unwrap().iter().map(|v| number(v.clone())).collect();
        // "at 1.083 m/s", or "between 1.0 and 1.1 m/s".
        let [from, to] = [said[0], said[said.len() - 1]];
        assert!((place(&x, from) - 0.5..=place(&x, to) + 0.5).contains(&ring[0]), "{line}: {ring:?}");
        let [first, last] = [number(x["domain"][0].clone()), number(x["domain"][1].clone())];
        let [left, right] = [number(x["range"][0].clone()), number(x["range"][1].clone())];
        let speed = first + (ring[0] - left) / (right - left) * (last - first);
        for curve in curves.as_array().unwrap() {
            let drawn = place(&y, at(curve, speed));
            assert!((ring[1] - drawn).abs() < 1.0, "{line}: {ring:?}, but {} is at {drawn}", curve["name"]);
        }

        // What is told under the pointer are a point's own numbers.
        let svg = format!("{} svg", "[data-figure='overview/speed-energy']");
        let middle = b.middle(&svg);
        let mut speeds = std::collections::BTreeSet::new();
        for step in 0..24 {
            b.mouse("mouseMoved", [middle[0] - 120.0 + 10.0 * f64::from(step), middle[1]]);
            let told = b.eval("document.getElementById('tip').innerText").as_str().unwrap().to_string();
            let told: Vec<&str> = told.lines().collect();
            let speed: f64 = told[0].split(' ').nth(1).unwrap().parse().unwrap();
            speeds.insert(told[0].to_string());
            for line in &told[1..] {
                let gait = line.split([' ', '(']).next().unwrap();
                let cost: f64 = line.split_whitespace().rev().nth(1).unwrap().parse().unwrap();
                let near = |a: f64, b: f64| (a - b).abs() <= 1e-4 * b.abs();
                assert!(points(gait, "energy").iter().any(|p| near(p.0, speed) && near(p.1, cost)), "{told:?}");
            }
        }
        assert!(speeds.len() > 3, "{speeds:?}");
    }
}

#[test]
fn a_jump_to_another_branch_is_no_slope() {
    // The amble of least torque takes steps of 0.16 s at 0.4 m/s and of 0.26 s at 0.5 m/s: another branch.
    let amble = points("amble", "torque");
    let jumps: Vec<_> = amble.windows(2).filter(|w| w[1].2 / w[0].2 > 1.4).map(|w| [w[0], w[1]]).collect();
    assert!(!jumps.is_empty(), "{amble:?}");
    let smooth: Vec<_> = amble
        .windows(2)
        .filter(|w| (w[1].2 / w[0].2 - 1.0).abs() < 0.1 && w[1].0 - w[0].0 < 0.15)
        .map(|w| [w[0], w[1]])
        .collect();
    assert!(!smooth.is_empty(), "{amble:?}");
    let Some(mut b) = Browser::open(1280, 900, false) else { return };
    b.load(&format!("file://{}", SWEEP.path().join("index.html").display()));
    let data =
        b.eval("JSON.parse(document.querySelector(\"script[data-of='overview']\").textContent).figures.durations");
    let place = |axis: &str, value: f64| {
        let axis = &data[axis];
        let [a, b, from, to] =
            [&axis["domain"][0], &axis["domain"][1], &axis["range"][0], &axis["range"][1]].map(|v| number(v.clone()));
        from + (value - a) / (b - a) * (to - from)
    };
    let mut drawn = |from: (f64, f64, f64), to: (f64, f64, f64)| {
        let point = |p: (f64, f64, f64)| [place("x", p.0), place("y", p.2)];
        let ends = serde_json::json!([point(from), point(to)]);
        b.eval(&format!(
            "(() => {{ const [a, b] = {ends}, near = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1]) < 0.1;
              return [...document.querySelectorAll(\"[data-figure='overview/durations'] path\")].some(path => {{
                const points = path.getAttribute('d').slice(1).split('L').map(t => t.split(' ').map(Number));
                return points.some((p, k) => k > 0 && near(points[k - 1], a) && near(p, b)); }}) }})()"
        )) == true
    };
    for [from, to] in jumps {
        assert!(!drawn(from, to), "a slope from {from:?} to {to:?}");
    }
    for [from, to] in smooth {
        assert!(drawn(from, to), "no line from {from:?} to {to:?}");
    }
}

#[test]
fn a_sweeps_own_account_is_not_believed() {
    type Change = fn(&mut Value);
    let changes: [Change; 2] = [
        |sweep| sweep["maximum_speeds"][0]["speed"] = 99.0.into(),
        |sweep| sweep["comparisons"][0]["crossovers"][0]["bracket"][0] = 0.41.into(),
    ];
    for change in changes {
        let (done, html) = changed(SWEEP.path(), |name, value| {
            if name == "sweep.json" {
                change(value);
            }
        });
        assert_eq!((done.status.code(), html), (Some(1), None));
        assert!(text(&done.stderr).contains("sweep.json"), "{}", text(&done.stderr));
    }
}

/// Legs with other joints, stops and motors: each is drawn between its own, and what it spends has its own name.
#[test]
fn legs_that_differ_are_shown_by_their_own_joints() {
    let folder = tempfile::tempdir().unwrap();
    let kitten = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/report/kitten");
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let optimum = |name: &str, more: &[&str]| {
        let asked =
            ["optimize", "bound", "--speed", "0.3", "--criterion", "torque", "--starts", "1", "--robot", kitten];
        let out = piaffe(&[&asked[..], &["--examine", "none", "--json", &at(name)], more].concat());
        assert!(out.status.success(), "{}", text(&out.stderr));
        text(&out.stdout)
    };
    let told = optimum("a.json", &[]);
    // A limit is told as finely as what stands beside it: 0.32 is not 0.3.
    assert!(told.contains(" of 0.320"), "{told}");
    optimum("b.json", &["--set", "links.body.mass=0.17"]);
    let out = piaffe(&["report", &at("a.json"), &at("b.json"), "--out", &at("page")]);
    assert!(out.status.success(), "{}", text(&out.stderr));
    let page = std::fs::read_to_string(folder.path().join("page/index.html")).unwrap();
    for joint in ["hip", "hock", "shoulder", "knee", "wrist"] {
        assert!(page.contains(&format!("<span>{joint} ")), "nothing is spent by the {joint}");
    }
    let figures = std::fs::read_dir(folder.path().join("page/figures")).unwrap();
    let figures: Vec<PathBuf> = figures.map(|entry| entry.unwrap().path()).collect();
    let figure = |name: &str| {
        let ending = format!("{name}.svg");
        let file = figures.iter().find(|path| path.to_str().unwrap().ends_with(&ending));
        std::fs::read_to_string(file.unwrap_or_else(|| panic!("no figure {name}"))).unwrap()
    };
    for (joint, stops) in [("shoulder", ["−0.6", "0.6"]), ("hip", ["−0.6", "1.2"]), ("wrist", ["0.1", "1.8"])] {
        let angles = figure(&format!("angles-{joint}"));
        for stop in stops {
            assert!(angles.contains(&format!("stop {stop}<")), "the {joint}'s stops are others: {angles}");
        }
    }
    // The motors of the hind legs turn half as fast, rev/min.
    let [hind, fore] = ["envelope-hip", "envelope-shoulder"].map(|name| figure(name).contains(">20000<"));
    assert!(fore && !hind, "joints are drawn in the envelope of other motors");
}
