//! The page of a study in a browser: every robot is told, ranges of axes select some, and all figures follow.

#[allow(dead_code)]
#[path = "report/browser.rs"]
mod browser;

use browser::Browser;
use std::path::PathBuf;
use std::process::Command;
use std::sync::LazyLock;

const MASS: &str = "links.thigh.mass";
const FRICTION: &str = "limits.friction";

/// Forty robots, with the least energy and the least torque of their trots.
static STUDY: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let robot = concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec");
    let varied = format!("{MASS}=1.2..2.0 {FRICTION}=0.4..1.0 links.shin.length=0.13..0.17");
    let varied = varied.split(' ').flat_map(|vary| ["--vary", vary]);
    let mut asked = Command::new(env!("CARGO_BIN_EXE_piaffe"));
    asked.args(["study", "trot", "--speed", "0.6", "--sample", "40", "--robot", robot, "--out"]);
    let out = asked.arg(folder.path()).args(varied).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    folder
});

fn file(name: &str) -> PathBuf {
    STUDY.path().join(name)
}

fn open() -> Option<Browser> {
    let mut browser = Browser::open(1280, 1000, false)?;
    browser.load(&format!("file://{}", file("study.html").display()));
    Some(browser)
}

/// Rows that have an optimum: design, its numbers and cost, by the names of the table's columns.
struct Row {
    design: usize,
    criterion: String,
    values: Vec<(String, String)>,
}

impl Row {
    fn number(&self, name: &str) -> f64 {
        self.values.iter().find(|(column, _)| column == name).unwrap().1.parse().unwrap()
    }
}

fn rows() -> Vec<Row> {
    let table = std::fs::read_to_string(file("study.csv")).unwrap();
    let mut lines = table.lines().map(|line| line.split(',').map(String::from).collect::<Vec<_>>());
    let names = lines.next().unwrap();
    let row = |cells: Vec<String>| {
        let values: Vec<(String, String)> = names.iter().cloned().zip(cells).collect();
        let text = |name: &str| values.iter().find(|(column, _)| column == name).unwrap().1.clone();
        let (design, criterion) = (text("design").parse().unwrap(), text("criterion"));
        (text("status") == "optimal").then_some(Row { design, criterion, values })
    };
    lines.filter_map(row).collect()
}

/// Designs, each once.
fn designs<'r>(rows: impl IntoIterator<Item = &'r Row>) -> Vec<usize> {
    let mut designs: Vec<usize> = rows.into_iter().map(|row| row.design).collect();
    designs.sort_unstable();
    designs.dedup();
    designs
}

fn words(browser: &mut Browser, expression: &str) -> String {
    browser.eval(expression).as_str().unwrap_or_default().to_string()
}

const TIP: &str = "document.getElementById('tip').hidden ? '' : document.getElementById('tip').innerText";
const SELECTED: &str = "document.querySelector('.selection output').value";

/// Elements of a figure, by the end of its name, that match.
fn count(browser: &mut Browser, figure: &str, what: &str) -> usize {
    let expression = format!("document.querySelectorAll(\"[data-figure='overview/{figure}'] {what}\").length");
    browser.eval(&expression).as_u64().unwrap() as usize
}

/// Drags along an axis of a figure, between two parts of it from its upper end; tells the range.
fn drag(browser: &mut Browser, figure: &str, axis: &str, from: f64, to: f64) -> [f64; 2] {
    let selector = format!("[data-figure='overview/{figure}'] .grip[data-axis='{axis}']");
    let [x, y] = browser.middle(&selector);
    let height = browser.eval(&format!("document.querySelector(\"{selector}\").getBoundingClientRect().height"));
    let at = |part: f64| [x, y + (part - 0.5) * height.as_f64().unwrap()];
    browser.mouse("mousePressed", at(from));
    browser.mouse("mouseMoved", at(0.5 * (from + to)));
    browser.mouse("mouseMoved", at(to));
    let told = words(browser, TIP);
    browser.mouse("mouseReleased", at(to));
    let (_, range) = told.split_once(": ").unwrap_or_else(|| panic!("no range is told: {told}"));
    let ends: Vec<f64> = range.split(" to ").map(|end| end.parse().unwrap()).collect();
    ends.try_into().unwrap()
}

#[test]
fn without_a_script_everything_is_drawn() {
    let page = std::fs::read_to_string(file("study.html")).unwrap();
    let drawn = page.split("<figure").find(|figure| figure.contains("overview/parallel-trot-energy")).unwrap();
    let lines = drawn.split("</figure>").next().unwrap().matches("data-k=").count();
    assert_eq!(lines, rows().iter().filter(|row| row.criterion == "energy").count());
    assert!(!page.contains("class=\"selection\""), "what does nothing is not shown");
}

#[test]
fn every_robot_is_told_under_the_pointer_and_by_keys() {
    let Some(mut b) = open() else { return };
    let rows = rows();
    let dot = "[data-figure='overview/front-trot-0.6'] circle[data-k='0']";
    let at = b.middle(dot);
    b.mouse("mouseMoved", at);
    let told = words(&mut b, TIP);
    let first = &rows[0];
    for word in [&*format!("Design {}: trot, least energy at 0.6 m/s", first.design), MASS, FRICTION, "optimal"] {
        assert!(told.contains(word), "{word}: {told}");
    }
    let told_energy: f64 = told.split("energy ").last().unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((told_energy / first.number("energy") - 1.0).abs() < 1e-4, "{told}");
    b.keep("space", "study-told.png");
    for figure in ["front-trot-0.6", "parallel-trot-energy"] {
        assert_eq!(count(&mut b, figure, ".hot"), 1, "{figure}: it does not stand out");
    }
    assert_eq!(count(&mut b, "parallel-trot-torque", ".hot"), 0);
    b.mouse("mouseMoved", [2.0, 2.0]);
    assert_eq!(words(&mut b, TIP), "");

    // From the best to the next.
    let figure = "document.querySelector(\"[data-figure='overview/parallel-trot-torque'] svg\")";
    let press = |b: &mut Browser, key: &str| {
        b.eval(&format!("{figure}.dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}', bubbles: true }}))"));
        words(b, TIP)
    };
    b.eval(&format!("{figure}.focus()"));
    let mut of_torque: Vec<&Row> = rows.iter().filter(|row| row.criterion == "torque").collect();
    of_torque.sort_by(|a, b| a.number("cost").total_cmp(&b.number("cost")));
    let is_of = |told: String, row: &Row| assert!(told.starts_with(&format!("Design {}:", row.design)), "{told}");
    is_of(press(&mut b, "Home"), of_torque[0]);
    is_of(press(&mut b, "ArrowRight"), of_torque[1]);
    is_of(press(&mut b, "End"), of_torque[of_torque.len() - 1]);
    assert_eq!(press(&mut b, "Escape"), "");
    assert!(b.errors().is_empty(), "{:?}", b.errors());
}

#[test]
fn a_range_of_an_axis_selects_in_all_figures() {
    let Some(mut b) = open() else { return };
    let rows = rows();
    let all = designs(&rows).len();
    assert_eq!(words(&mut b, SELECTED), format!("{all} robots with an optimum"));

    let [least, most] = drag(&mut b, "parallel-trot-energy", "0", 0.1, 0.6);
    let within = |row: &&Row| (least..=most).contains(&row.number(MASS));
    let light: Vec<&Row> = rows.iter().filter(within).collect();
    let selected = designs(light.iter().copied()).len();
    assert!(0 < selected && selected < all, "{least} to {most}");
    let told = format!("{selected} of {all} robots selected, {} of {} optima", light.len(), rows.len());
    assert_eq!(words(&mut b, SELECTED), told);
    for (figure, of) in [("parallel-trot-energy", "energy"), ("parallel-trot-torque", "torque"), ("front-trot-0.6", "")]
    {
        let of_figure = |row: &&&Row| row.criterion.starts_with(of);
        let (drawn, open) = (rows.iter().filter(|row| of_figure(&row)).count(), light.iter().filter(of_figure).count());
        assert_eq!(count(&mut b, figure, "[data-k]"), drawn, "{figure}");
        assert_eq!(count(&mut b, figure, "[data-k]:not(.faded)"), open, "{figure}");
    }
    assert_eq!(count(&mut b, "parallel-trot-torque", ".brush[visibility=visible]"), 1, "the same axis elsewhere");

    // Robots whose least energy is small, wherever they are.
    let [least, most] = drag(&mut b, "parallel-trot-energy", "cost trot energy", 0.5, 1.0);
    let cheap = designs(
        light.iter().copied().filter(|row| row.criterion == "energy" && (least..=most).contains(&row.number("energy"))),
    );
    assert!(!cheap.is_empty() && cheap.len() < selected, "{least} to {most}");
    assert!(words(&mut b, SELECTED).starts_with(&format!("{} of {all} robots selected", cheap.len())));
    let of_torque = light.iter().filter(|row| row.criterion == "torque" && cheap.contains(&row.design)).count();
    assert_eq!(count(&mut b, "parallel-trot-torque", "[data-k]:not(.faded)"), of_torque);
    b.eval("document.querySelector('.selection').scrollIntoView({ behavior: 'instant' })");
    b.keep("space", "study-selected.png");

    // A click lets go of an axis, the button of all.
    b.click("[data-figure='overview/parallel-trot-energy'] .grip[data-axis='0']");
    assert_eq!(count(&mut b, "parallel-trot-energy", ".brush[visibility=visible]"), 1);
    b.click(".selection button");
    assert_eq!(words(&mut b, SELECTED), format!("{all} robots with an optimum"));
    assert_eq!(count(&mut b, "front-trot-0.6", ".faded"), 0);
    assert!(b.errors().is_empty(), "{:?}", b.errors());
    let outside: Vec<String> = b.requests().into_iter().filter(|url| !url.starts_with("file:")).collect();
    assert!(outside.iter().all(|url| url.starts_with("data:")), "{outside:?}");
}
