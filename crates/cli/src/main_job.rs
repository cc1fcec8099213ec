//! The main job: every gait and criterion at 0.6 m/s, beside the values of the paper (§6.2, §6.3).

use super::digits::decimal;
use super::optimize::progress;
use super::{output, report, robots};
use piaffe_model::motion::Criterion;
use piaffe_optimizer::result::Receipt;
use piaffe_optimizer::search::local::Task;
use piaffe_optimizer::search::multi_start::Settings;
use piaffe_report::{Extremes, Record};
use std::io::Write;
use std::path::Path;
use std::time::Instant;

const SPEED: f64 = 0.6;

/// Cost and half-step durations that the paper reports.
struct Published {
    gait: &'static str,
    criterion: Criterion,
    cost: f64,
    durations: &'static str,
}

const PUBLISHED: [Published; 6] = [
    Published { gait: "trot", criterion: Criterion::Energy, cost: 29.98, durations: "0.31" },
    Published { gait: "amble", criterion: Criterion::Energy, cost: 55.13, durations: "0.17" },
    Published { gait: "curvet", criterion: Criterion::Energy, cost: 78.87, durations: "0.31/0.196" },
    Published { gait: "trot", criterion: Criterion::Torque, cost: 112.17, durations: "0.35" },
    Published { gait: "amble", criterion: Criterion::Torque, cost: 256.8, durations: "0.404" },
    Published { gait: "curvet", criterion: Criterion::Torque, cost: 802.26, durations: "0.456/0.298" },
];

/// `of_paper` tells whether the robot is the one whose values were published.
pub fn run(folder: &Path, of_paper: bool) -> anyhow::Result<bool> {
    let started = Instant::now();
    let published: &[Published] = if of_paper { &PUBLISHED } else { &[] };
    std::fs::create_dir_all(folder).map_err(|e| anyhow::anyhow!("cannot create {}: {e}", folder.display()))?;
    output::say!("Optimal gaits at {SPEED} m/s\n");
    output::say!(
        "{:<8} {:<9} {:>10} {:<7} {:>6} {:<13} {:>9} {:>9} {:>9}  {:>10} {:<12} active  between    real legs",
        "gait",
        "criterion",
        "cost",
        "unit",
        "E/mgd",
        "half steps, s",
        "violation",
        "cycle",
        "KKT",
        "paper",
        "half steps"
    );
    let settings = Settings::default();
    // In the order of the paper.
    let mut gaits = robots::first()?;
    gaits.sort_by_key(|g| PUBLISHED.iter().position(|p| p.gait == g.description().gait));
    let bar = progress(settings.starts);
    let searches = gaits.len() * Criterion::ALL.len();
    let mut records: Vec<Record> = Vec::new();
    for criterion in Criterion::ALL {
        for gait in &gaits {
            let name = gait.description().gait;
            bar.set_message(format!("{name}, {} ({} of {searches})", criterion.name(), records.len() + 1));
            let mut result = Task { gait: *gait, criterion, speed: SPEED }.search(&settings, &[], &|_| bar.inc(1));
            result.examine(*gait);
            output::write_json(&folder.join(format!("{name}-{}.json", criterion.name())), &result)?;
            let record = Record::issued(result, *gait);
            bar.suspend(|| output::quiet_when_closed(row(&record, published)))?;
            records.push(record);
        }
    }
    bar.finish_and_clear();
    let starts = || records.iter().map(|r| r.result.search.effort.starts);
    let (fewest, most) = (starts().min().unwrap_or(0), starts().max().unwrap_or(0));
    let starts = if fewest == most { most.to_string() } else { format!("{fewest} to {most}") };
    if of_paper {
        output::say!(
            "\nEvery optimum is local: the best of {starts} starts. The paper does not give all of the robot's parameters"
        );
        output::say!("(see model-spec/robot.toml), so its values are a yardstick, not a like-for-like comparison.");
    } else {
        output::say!("\nEvery optimum is local: the best of {starts} starts.");
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

fn row(record: &Record, published: &[Published]) -> std::io::Result<()> {
    let r = &record.result;
    let mut out = output::person();
    let durations: Vec<String> = r.durations.iter().map(|t| decimal(*t, 3)).collect();
    let published = published.iter().find(|p| p.gait == r.gait && p.criterion == r.criterion);
    let (paper, paper_steps) = published.map_or((String::new(), ""), |p| (format!("{:.2}", p.cost), p.durations));
    match (r.cost, &r.receipt) {
        (Some(cost), Some(receipt @ Receipt { kkt_residual: Some(kkt), .. })) => writeln!(
            out,
            "{:<8} {:<9} {:>10} {:<7} {:>6.4} {:<13} {:>9.1e} {:>9.1e} {:>9.1e}  {paper:>10} {paper_steps:<12} {:<6}  {:<9}  {}",
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
        _ => writeln!(out, "{:<8} {:<9} {} {paper:>10} {paper_steps:<12}", r.gait, r.criterion.name(), r.message),
    }
}
