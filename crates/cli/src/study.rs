//! `piaffe study`: the optimal gaits of many robots that differ in some numbers, resumed where an earlier run stopped.

use super::digits::decimal;
use super::journal::Folder;
use super::progress::{Counted, Progress};
use super::robots::Wanted;
use super::{criteria, gait_names_or_all, input, output, report, robots, sweep, whole};
use anyhow::{Context, bail};
use clap::builder::PossibleValuesParser;
use piaffe_codegen::Changes;
use piaffe_model::digits::digits;
use piaffe_optimizer::search::journal::Journal;
use piaffe_report::space::{Space, Spot};
use piaffe_report::{Extremes, Record, Report};
use piaffe_study::{Answers, Beyond, Column, Designs, Question, Row, Search, Shard, Study, Vary, table};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub struct Arguments {
    /// If none is given, the gaits of the first robot that never leave the ground (where all fly, all). `all` are those that fly too, whose
    /// searches take ten times as long.
    #[arg(value_parser = gait_names_or_all(), value_name = "GAIT")]
    pub gaits: Vec<String>,
    /// Mean forward speeds: a list, or FROM..TO:STEP, m/s.
    #[arg(long, value_parser = sweep::parse_speeds)]
    speed: std::vec::Vec<f64>,
    /// energy, torque or all; may be given several times.
    #[arg(long, value_parser = PossibleValuesParser::new(["energy", "torque", "all"]), default_value = "all")]
    criterion: Vec<String>,
    /// Impose contact, torque and speed limits at each real leg, not only at the virtual ones, where the platform rolls. `cost` is then
    /// the real joints', and `virtual_cost` that without these limits.
    #[arg(long)]
    real_legs: bool,
    /// A number of the specification and its values: NAME=FROM..TO:STEP or NAME=A,B,C; may be given several times, for every
    /// combination. Several numbers at once with braces: 'links.{left,right}_shin.mass=1.0..2.0:0.1'.
    #[arg(long, value_name = "NAME=VALUES")]
    vary: Vec<Vary>,
    /// So many robots spread evenly over the intervals of --vary, NAME=FROM..TO, instead of every combination.
    #[arg(long, value_name = "N", requires = "vary", value_parser = clap::value_parser!(u32).range(1..))]
    sample: Option<u32>,
    /// A table of robots, CSV or Parquet: a column for each number under its name, a line for each robot.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["vary", "sample"])]
    designs: Option<PathBuf>,
    /// What to tell of each optimum beyond its receipt. Slopes take about as long as finding it, a certificate a third of that.
    #[arg(long, value_delimiter = ',', value_parser = PossibleValuesParser::new(Beyond::ALL.map(Beyond::name)))]
    also: Vec<String>,
    /// Answer one of N parts, I/N; `piaffe merge` puts them together.
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE, hide_default_value = true)]
    shard: Shard,
    /// Folder for the table and the page.
    #[arg(long = "out", value_name = "DIR", default_value = "study")]
    folder: PathBuf,
    /// Starts for every row besides those from the base robot's optima; if it is not given, one, and where all these lead to no
    /// optimum as many as for `optimize`.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    starts: Option<u32>,
    /// Of the random starts.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// What a folder's rows are about.
#[derive(PartialEq, Serialize, Deserialize)]
pub struct Asked {
    pub shard: Shard,
    pub question: Question,
}

/// Name of it in the folder.
pub const ASKED: &str = "study.json";

/// The folder in it with the walks that the page shows, as results.
pub const WALKS: &str = "walks";

/// The table of its rows.
const TABLE: &str = "study.csv";

/// The step of a journal that answers a point.
pub fn step(fingerprint: &str, point: usize) -> String {
    format!("study {fingerprint} point {point}")
}

/// `changes` are those that the base robot already has.
pub fn run(arguments: Arguments, changes: &Changes) -> anyhow::Result<bool> {
    let (shard, path) = (arguments.shard, arguments.folder.clone());
    let study = asked(arguments, changes)?;
    let asked = Asked { shard, question: Question::from(&study) };
    let points = shard.points(&study);
    let folder = Folder::open(&path, Progress::new(Counted::Rows(points.len())).of("rows"))?;
    whole::check(&path.join(TABLE))?;
    let own = std::fs::read_to_string(path.join(ASKED)).ok();
    if let Some(earlier) = own.and_then(|text| serde_json::from_str::<Asked>(&text).ok())
        && earlier.question.fingerprint != asked.question.fingerprint
    {
        output::note(&format!("the last study in {} was another one: all is answered anew", input::name(&path)));
    }
    output::write_json(&path.join(ASKED), &asked)?;
    let answers = Answers::new(&study);
    let rows: Vec<Row> = points.par_iter().map(|point| row(&answers, *point, &asked.question, &folder)).collect();
    folder.bar.finish_and_clear();
    if let Some(error) = folder.failure() {
        return Err(error);
    }
    write(&study, shard, &answers, &rows, &path)
}

/// The study that is asked for, if nothing is wrong with it.
fn asked(arguments: Arguments, changes: &Changes) -> anyhow::Result<Study> {
    let Arguments { gaits, speed, criterion, real_legs, vary, sample, designs, also, starts, seed, .. } = arguments;
    let (robot, gaits) = robots::robot_of(&Wanted::by(&gaits))?;
    let wanted = |beyond: &Beyond| also.iter().any(|name| name == beyond.name());
    let mut names: Vec<String> = vary.iter().map(|vary| vary.name.clone()).collect();
    let made = match (&designs, sample) {
        (Some(file), _) => table::designs(input::read(file)?).map_err(|why| {
            names = why.names.clone();
            format!("{}: {why}", input::name(file))
        }),
        (None, Some(count)) => Designs::sample(&vary, count as usize),
        (None, None) if vary.is_empty() => Ok(Designs::base()),
        (None, None) => Designs::grid(&vary),
    };
    // Names are looked at whether there are designs or not, so that everything wrong is said at once.
    names.retain(|name| !name.is_empty());
    let named = || Designs::listed(names.clone(), &[vec![1.0; names.len()]]);
    let unmade = made.as_ref().err().cloned();
    let study = Study {
        robot,
        designs: made.or_else(|_| named()).unwrap_or_else(|_| Designs::base()),
        gaits,
        criteria: criteria(&criterion),
        speeds: speed,
        real_legs,
        search: Search { starts: starts.map(|n| n as usize), seed },
        beyond: Beyond::ALL.into_iter().filter(wanted).collect(),
    };
    let faults: Vec<String> = unmade.into_iter().chain(study.faults()).chain(twice(&study, changes)).collect();
    if !faults.is_empty() {
        bail!("this study cannot be asked:\n{}", faults.join("\n"));
    }
    Ok(study)
}

/// Numbers that are varied and changed for this run besides: of one of both nothing would be left.
fn twice(study: &Study, changes: &Changes) -> Vec<String> {
    let varied = study.designs.varied();
    let changed = changes.names(study.robot.files());
    let both = changed.intersection(&varied);
    both.map(|name| {
        format!("{name} is varied, and changed by an option for the robot (--set, a limit, a load): do one of both")
    })
    .collect()
}

/// The row of a point: the one that an earlier run has found, or a new one.
fn row(answers: &Answers, point: usize, question: &Question, folder: &Folder) -> Row {
    let step = step(&question.fingerprint, point);
    let known = folder.known(&step).and_then(|known| serde_json::from_value(known).ok());
    let row = known.unwrap_or_else(|| {
        let row = answers.row(point);
        if let Ok(outcome) = serde_json::to_value(&row) {
            folder.record(&step, outcome);
        }
        row
    });
    folder.bar.inc(1);
    row
}

/// Writes the rows of a study's part as tables, and of a whole study the page; tells what is best.
pub fn write(study: &Study, shard: Shard, answers: &Answers, rows: &[Row], path: &Path) -> anyhow::Result<bool> {
    let columns = Column::all(study);
    whole::write(&path.join(TABLE), &table::csv(&columns, rows).context("cannot write the table")?)?;
    #[cfg(feature = "parquet")]
    whole::write(
        &path.join("study.parquet"),
        &piaffe_study::parquet(&columns, rows).context("cannot write the table")?,
    )?;
    let shown = if shard == Shard::WHOLE { Some(page(study, answers, rows, path)?) } else { None };
    if rows.is_empty() {
        output::say!("part {shard} has no robots: the study has {}", study.designs.count());
    } else {
        output::quiet_when_closed(tell(study, rows))?;
    }
    output::say!("rows in {}", path.join(TABLE).display());
    match shown {
        Some(Some(page)) => output::say!("To be seen in {}", page.display()),
        Some(None) => output::say!("no page: there is no walk to show"),
        None => {}
    }
    // A part has done what was asked when its rows are there: only the whole can tell that no robot has an optimum.
    Ok(shard != Shard::WHOLE || rows.iter().any(|row| row.optimum.is_some()))
}

/// Writes the page of a study, with the walks that are worth showing as results of their own; tells where it is, if there are any.
fn page(study: &Study, answers: &Answers, rows: &[Row], path: &Path) -> anyhow::Result<Option<PathBuf>> {
    let spot = |row: &Row| Spot {
        point: row.point,
        design: row.design,
        numbers: row.numbers.clone(),
        gait: row.gait.clone(),
        criterion: row.criterion,
        speed: row.speed,
        costs: row.optimum.as_ref().map(|optimum| optimum.costs),
        status: status(row),
    };
    let numbers = study.designs.names().to_vec();
    let space = Space { robot: study.robot.name().into(), numbers, spots: rows.iter().map(spot).collect() };
    let walks = space.worth_showing();
    // Each by its own specification, as if it had been asked for alone.
    let results: Vec<_> = walks.iter().map(|point| answers.result(*point)).collect::<Result<_, _>>()?;
    let folder = path.join(WALKS);
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", input::name(&folder)))?;
    whole::tidy(&folder);
    let mut records = Vec::new();
    for (point, (result, gait)) in walks.iter().zip(&results) {
        output::write_json(&folder.join(format!("{point}-{}", result.file_name())), result)?;
        let design = format!("design {}", study.point(*point).design);
        records.push(Record::issued(result.clone(), gait).named(Some(design)));
    }
    if !records.iter().any(Record::is_confirmed) {
        return Ok(None);
    }
    let report = Report::new(records, Extremes::default(), None)?.of_space(space);
    report::write_report(&report, path).map(Some)
}

/// What became of a point, in a few words.
fn status(row: &Row) -> String {
    let certificate = row.optimum.as_ref().and_then(|optimum| optimum.certificate);
    match certificate {
        Some(certificate) => format!("{}, {}", row.status.name(), certificate.name()),
        None => row.status.name().into(),
    }
}

/// What is best of each gait and criterion at each speed.
fn tell(study: &Study, rows: &[Row]) -> std::io::Result<()> {
    let mut out = output::person();
    for first in 0..study.of_design() {
        let point = study.point(first);
        let same = || rows.iter().filter(|row| row.point % study.of_design() == first);
        let optimal = same().filter(|row| row.optimum.is_some()).count();
        write!(out, "{}, least {} at {} m/s: ", point.gait, point.criterion.name(), digits(point.speed))?;
        write!(out, "{optimal} of {} robots have an optimum", same().count())?;
        let best = same().filter_map(|row| Some((row, row.cost()?))).min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((best, cost)) = best else {
            writeln!(out)?;
            continue;
        };
        let with =
            study.designs.names().iter().zip(&best.numbers).map(|(name, number)| format!("{name}={}", digits(*number)));
        let with: Vec<String> = with.collect();
        let with = if with.is_empty() { String::new() } else { format!(" with {}", with.join(" ")) };
        writeln!(out, "; best {} {}{with} (design {})", decimal(cost, 4), point.criterion.unit(), best.design)?;
    }
    if rows.iter().all(|row| row.optimum.is_none()) {
        return Ok(());
    }
    let starts = study.search.starts.unwrap_or(piaffe_study::FEW);
    let from = if starts == 1 { "a start that knows".into() } else { format!("{starts} starts that know") };
    writeln!(out, "Every optimum is local: the best from the base robot's optima and {from} nothing of them.")
}
