//! The main job: every gait and criterion, those that walk at 0.6 m/s beside what was published of them, those that fly at 1 m/s.

use super::built::{Published, published};
use super::digits::decimal;
use super::progress::{Counted, Progress};
use super::{output, report, robots};
use piaffe_model::motion::Criterion;
use piaffe_model::{Description, Gait};
use piaffe_optimizer::examine::Examination;
use piaffe_optimizer::result::Receipt;
use piaffe_optimizer::search::local::Task;
use piaffe_optimizer::search::multi_start::Settings;
use piaffe_report::{Extremes, Record};
use std::io::Write;
use std::path::Path;
use std::time::Instant;

/// Speeds of the two tables, m/s.
const WALKING: f64 = 0.6;
const FLYING: f64 = 1.0;

/// Starts of a gait that flies. A search from one takes ten times as long as that of a walk; `piaffe optimize` goes on until it
/// expects no other optimum.
const STARTS_FLYING: usize = 8;

/// Heading of the phases' durations.
const DURATIONS: &str = "phases, s";

/// Gaits at a speed, one line for each and criterion.
struct Table {
    gaits: Vec<&'static dyn Gait>,
    title: String,
    speed: f64,
    settings: Settings,
}

pub fn run(folder: &Path, examination: Examination) -> anyhow::Result<bool> {
    let started = Instant::now();
    std::fs::create_dir_all(folder).map_err(|e| anyhow::anyhow!("cannot create {}: {e}", folder.display()))?;
    let mut records: Vec<Record> = Vec::new();
    let mut between = "";
    for table in tables(examination)? {
        output::say!("{between}{} at {} m/s\n", table.title, table.speed);
        let starts = table.fill(folder, &mut records)?;
        output::say!("\nEvery optimum is local: the best of {starts} starts.");
        if table.is_published() {
            output::say!(
                "The paper does not give all of the robot's parameters (see model-spec/robot.toml), so its values are a"
            );
            output::say!("yardstick, not a like-for-like comparison.");
        }
        between = "\n";
    }
    let all = records.iter().all(Record::is_confirmed);
    let any = records.iter().any(Record::is_confirmed);
    output::say!("{:.1} s; results in {}", started.elapsed().as_secs_f64(), folder.display());
    if any {
        let page = report::write(records, Extremes::default(), None, folder)?;
        output::say!("To be seen in {}", page.display());
    }
    Ok(all)
}

/// Those that have gaits.
fn tables(examination: Examination) -> anyhow::Result<Vec<Table>> {
    let (flying, mut walking): (Vec<_>, Vec<_>) = robots::first()?.into_iter().partition(|g| g.description().flies());
    // In the order of the paper, what is in none behind.
    walking.sort_by_key(|g| published().iter().position(|p| p.is_of(g.description())).unwrap_or(usize::MAX));
    let walks = Table {
        gaits: walking,
        title: "Optimal gaits".into(),
        speed: WALKING,
        settings: Settings { examination, ..Settings::default() },
    };
    let runs = Table {
        gaits: flying,
        title: "Gaits that fly,".into(),
        speed: FLYING,
        settings: Settings { starts: Some(STARTS_FLYING), examination, ..Settings::default() },
    };
    Ok([walks, runs].into_iter().filter(|table| !table.gaits.is_empty()).collect())
}

impl Table {
    /// What was published of a gait, if that was at this speed.
    fn published(&self, gait: &Description, criterion: Criterion) -> Option<&'static Published> {
        let asked = |p: &&Published| p.criterion == criterion && p.speed == self.speed;
        published().iter().filter(asked).find(|p| p.is_of(gait))
    }

    /// Whether something was of one of its gaits.
    fn is_published(&self) -> bool {
        self.gaits
            .iter()
            .any(|gait| Criterion::ALL.into_iter().any(|c| self.published(gait.description(), c).is_some()))
    }

    /// Searches, writes the results, and says each when it is found; how many starts there were.
    fn fill(&self, folder: &Path, records: &mut Vec<Record<'static>>) -> anyhow::Result<String> {
        let (names, steps) = self.widths();
        let paper = if self.is_published() { format!("  {:>10} {:<12}", "paper", "phases") } else { String::new() };
        output::say!(
            "{:<names$} {:<9} {:>10} {:<7} {:>6} {:<steps$} {:>9} {:>9} {:>9}{paper} active  between    real legs",
            "gait",
            "criterion",
            "cost",
            "unit",
            "E/mgd",
            DURATIONS,
            "violation",
            "cycle",
            "KKT",
        );
        let bar = Progress::new(Counted::Starts(self.settings.starts));
        let searches = self.gaits.len() * Criterion::ALL.len();
        let first = records.len();
        for criterion in Criterion::ALL {
            for gait in &self.gaits {
                let name = gait.description().gait;
                bar.set_message(format!("{name}, {} ({} of {searches})", criterion.name(), records.len() - first + 1));
                let task = Task { gait: *gait, criterion, speed: self.speed };
                let mut result = task.search(&self.settings, &[], &|_| bar.inc(1));
                result.examine(*gait, self.settings.examination);
                output::write_json(&folder.join(format!("{name}-{}.json", criterion.name())), &result)?;
                let record = Record::issued(result, *gait);
                bar.suspend(|| output::quiet_when_closed(self.row(&record, gait.description())))?;
                records.push(record);
            }
        }
        bar.finish_and_clear();
        let starts = || records[first..].iter().map(|r| r.result.search.effort.starts);
        let (fewest, most) = (starts().min().unwrap_or(0), starts().max().unwrap_or(0));
        Ok(if fewest == most { most.to_string() } else { format!("{fewest} to {most}") })
    }

    /// Columns of the gaits' names and of the durations.
    fn widths(&self) -> (usize, usize) {
        const DURATION: usize = "0.0123/".len();
        let descriptions = || self.gaits.iter().map(|g| g.description());
        let names = descriptions().map(|d| d.gait.len()).fold("gait".len(), usize::max);
        (names, descriptions().map(|d| d.phases.len() * DURATION).fold(DURATIONS.len(), usize::max))
    }

    fn row(&self, record: &Record, description: &Description) -> std::io::Result<()> {
        let r = &record.result;
        let mut out = output::person();
        let (names, steps) = self.widths();
        let durations: Vec<String> = r.durations.iter().map(|t| decimal(*t, 3)).collect();
        let published = self.published(description, r.criterion);
        let beside = |p: &Published| format!("  {:>10.2} {:<12}", p.cost, p.durations);
        let paper = match published {
            Some(published) => beside(published),
            None if self.is_published() => format!("  {:>10} {:<12}", "", ""),
            None => String::new(),
        };
        match (r.cost, &r.receipt) {
            (Some(cost), Some(receipt @ Receipt { kkt_residual: Some(kkt), .. })) => writeln!(
                out,
                "{:<names$} {:<9} {:>10} {:<7} {:>6.4} {:<steps$} {:>9.1e} {:>9.1e} {:>9.1e}{paper} {:<6}  {:<9}  {}",
                r.gait,
                r.criterion.name(),
                decimal(cost, 4),
                r.criterion.unit(),
                record.cost_of_transport().unwrap_or(f64::NAN),
                durations.join("/"),
                receipt.max_violation,
                receipt.cycle_error,
                kkt,
                receipt.active.len(),
                r.certificate.as_ref().map_or("", |c| c.standing.name()),
                r.real_legs.as_ref().map_or("", |legs| legs.verdict().name()),
            ),
            _ => writeln!(out, "{:<names$} {:<9} {}{paper}", r.gait, r.criterion.name(), r.message),
        }
    }
}
