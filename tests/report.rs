//! Reports as a person reads them: in a browser where there is one, and as files.

#[path = "report/browser.rs"]
mod browser;

use base64::Engine;
use browser::Browser;
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

/// Keeps what the window shows where a person can look at it.
fn keep(browser: &mut Browser, name: &str) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report");
    std::fs::create_dir_all(&folder).unwrap();
    let image = base64::engine::general_purpose::STANDARD.decode(browser.screenshot()).unwrap();
    assert!(image.len() > 20_000, "{name} shows next to nothing");
    std::fs::write(folder.join(name), image).unwrap();
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
        let flaws = b.eval(
            "[...document.querySelectorAll('figure')].flatMap(f => {
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
            })",
        );
        assert_eq!(flaws, serde_json::json!([]), "{name}");
        // A moment in the middle of a swing.
        let show = "document.querySelector(\"TROT\").scrollIntoView({ behavior: 'instant' });
            const s = document.querySelector(\"TROT .time\"); s.value = 230; s.dispatchEvent(new Event('input'))";
        b.eval(&show.replace("TROT", TROT));
        keep(&mut b, name);
    }
}

#[test]
fn the_numbers_are_those_of_the_results() {
    let html = std::fs::read_to_string(report().join("index.html")).unwrap();
    for gait in ["trot", "amble", "curvet"] {
        let r = result(gait);
        assert!(html.contains(&format!("<p class=\"cost\">{:.4} ", r.cost.unwrap())), "{gait}");
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
    assert!(attempt(&cheaper).contains("contradicts itself"));
    let mut short = good.clone();
    short["variables"][0]["q_final"] = serde_json::json!([0.1]);
    assert!(attempt(&short).contains("contradicts itself"));
    let mut unknown = good.clone();
    unknown["gait"] = "gallop".into();
    assert!(attempt(&unknown).contains("no gait `gallop`"));
    let mut failed = good;
    failed["status"] = "infeasible".into();
    assert!(attempt(&failed).contains("no optimum"));
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
