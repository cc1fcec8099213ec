//! `piaffe`: what a person types, and what comes back. Everything that prints is below here.

#![forbid(unsafe_code)]

mod asked;
mod built;
mod check;
mod diff;
mod digits;
mod document;
mod dynamics;
mod export;
mod harmless;
mod import;
mod input;
mod journal;
mod lift;
mod main_job;
mod manual;
mod merge;
mod model;
mod optimize;
mod output;
mod peaks;
mod progress;
mod report;
mod robots;
mod study;
mod summary;
mod sweep;
mod verify;
mod whole;

use asked::Asked;
pub use built::{Build, Published};
use clap::builder::{PossibleValuesParser, TypedValueParser, ValueParser};
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use piaffe_codegen::Changes;
use piaffe_interpreter::Store;
use piaffe_model::motion::Criterion;
use piaffe_optimizer::examine::Examination;
use piaffe_optimizer::optimize::Unaskable;
use piaffe_optimizer::search::local::Task;
use piaffe_optimizer::search::multi_start::Settings;
use rayon::ThreadPoolBuilder;
use robots::{Wanted, by_name};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Exit code of a run that could not do what was asked.
const FAILED: u8 = 1;
/// Exit code of a run that ended, but without an optimum.
const NO_OPTIMUM: u8 = 3;
/// Exit code where not everything that results state was confirmed.
const NOT_CONFIRMED: u8 = 4;

#[derive(Parser)]
#[command(
    name = "piaffe",
    version,
    about = "Optimal gaits of a legged robot, each with a receipt",
    long_about = "Optimal periodic gaits of the robots in model-spec/, or of any robot (--robot), each with a receipt.\n\n\
                  Without a command: finds the optimum of every gait and criterion, at 0.6 m/s beside the published\n\
                  values, at 1 m/s of those that fly, and writes the results to a folder.",
    after_help = "Examples:\n  \
                  piaffe                                             the main job; open results/index.html\n  \
                  piaffe optimize trot --speed 0.6 --json trot.json  one optimum\n  \
                  piaffe optimize trot --speed 0.6 --robot dog       of another robot, without a compiler\n  \
                  piaffe report trot.json --out trot                 a page that shows it\n  \
                  piaffe export trot.json --format csv               its numbers over time\n  \
                  piaffe verify trot.json                            what it states, derived anew\n  \
                  piaffe sweep --speeds 0.2..1.2:0.1 --out sweep     many speeds\n\n\
                  Exit codes: 0 success, 1 something failed, 2 wrong usage, 3 no optimum (infeasible or not converged),\n\
                  4 a result was not confirmed.\n\
                  NO_COLOR=1 turns colours off. Files are written whole or not at all, also when the program is interrupted.\n\
                  What is derived without a compiler is kept in ~/.cache/piaffe: PIAFFE_CACHE=DIR keeps it elsewhere, PIAFFE_CACHE=off nowhere."
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Folder for the results of the main job.
    #[arg(long, default_value = "results", value_name = "DIR")]
    out: PathBuf,
    /// The robot of this folder, with robot.toml and gaits/*.toml, instead of those that the program was built with.
    ///
    /// Needs no compiler. Where the folder model-spec/ is here and has changed since the build, its files are taken too.
    #[arg(long, global = true, value_name = "DIR")]
    robot: Option<PathBuf>,
    #[command(flatten)]
    closely: Closely,
    #[command(flatten)]
    asked: Asked,
    /// Say nothing but errors, and what was asked for with `-`.
    #[arg(long, short, global = true)]
    quiet: bool,
}

/// Of commands that search.
#[derive(clap::Args)]
struct Closely {
    /// How closely to look at what is found: `none` is its receipt, `quick` its slopes and stability too, `full` also the proof
    /// between the receipt's instants and the real legs.
    #[arg(long, value_parser = examinations(), default_value = "full", value_name = "LEVEL")]
    examine: Examination,
}

#[derive(Subcommand)]
enum Command {
    /// Say what a build would say of a robot's folder, at once, and draw the robot as it stands.
    #[command(after_help = "Example:\n  piaffe check model-spec/a1 --svg a1.svg")]
    Check {
        /// The folder with robot.toml and gaits/.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Draw the robot, standing, from its right and from behind.
        #[arg(long, value_name = "FILE")]
        svg: Option<PathBuf>,
    },
    /// Evaluate the generated dynamics at given states.
    #[command(
        after_help = "Example:\n  echo '{\"states\":[{\"X\":[0,0.28,0.4,-0.8,0.1,-0.5],\"Xdot\":[0,0,1,0,0,0]}]}' | piaffe dynamics trot -"
    )]
    Dynamics {
        #[arg(value_parser = gait_names())]
        gait: String,
        /// JSON: {"states": [{"X": […], "Xdot": […], "Xddot": […], "Gamma": […]}]}; `-` reads standard input.
        #[arg(default_value = "-", value_name = "FILE|-")]
        file: PathBuf,
    },
    /// Show what was generated for a gait: coordinates, virtual legs, masses, kernels; or its equations.
    #[command(after_help = "Example:\n  piaffe model trot --latex > trot.tex && pdflatex trot.tex")]
    Model {
        #[arg(value_parser = gait_names())]
        gait: String,
        /// The closed forms with the names of the robot's parameters, as a LaTeX document.
        #[arg(long, conflicts_with = "json")]
        latex: bool,
        /// Write what was generated as JSON; `-` is standard output.
        #[arg(long, value_name = "FILE|-")]
        json: Option<String>,
    },
    /// Write a specification from a URDF or MJCF: robot.toml and gaits to begin with.
    ///
    /// What is written builds, or everything that is in the way is said, each with what to do. Says what it took, what it
    /// assumed and what it dropped. Legs are chains of revolute joints that can reach the ground.
    #[command(
        after_help = "Examples:\n  piaffe import a1.urdf --out model-spec/a1\n  piaffe import dog.xml --velocity 20 --lock 'arm_*' --lock tail=0.3"
    )]
    Import(import::Arguments),
    /// Find the optimal periodic motion of a gait at a mean speed.
    #[command(after_help = "Example:\n  piaffe optimize trot --criterion energy --speed 0.6 --json trot.json")]
    Optimize {
        #[arg(value_parser = gait_names())]
        gait: String,
        /// What to minimize per metre: the work of the actuators or the squares of their torques.
        #[arg(long, value_parser = criterion_names(), default_value = "energy")]
        criterion: String,
        /// Mean forward speed, m/s.
        #[arg(long, value_parser = speed)]
        speed: f64,
        /// Of the random starts.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Impose contact, torque and speed limits at each real leg, not only at the virtual ones, where the platform rolls.
        #[arg(long)]
        real_legs: bool,
        /// Number of starts, a default walk and random ones; if it is not given, as many as the optima found let expect others.
        #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000))]
        starts: Option<u32>,
        #[command(flatten)]
        closely: Closely,
        /// Write the whole result as JSON; `-` is standard output.
        #[arg(long, value_name = "FILE|-")]
        json: Option<String>,
    },
    /// Write a result for other software: tables, arrays, polynomials, robot models.
    #[command(
        after_help = "Examples:\n  piaffe export results/trot-energy.json --format csv --rate 1000 --out trot.csv\n  piaffe export results/trot-energy.json --format mjcf --out quadruped.xml"
    )]
    Export {
        /// A result as JSON; `-` reads standard input.
        #[arg(value_name = "FILE|-")]
        result: PathBuf,
        #[arg(long, value_enum)]
        format: export::Format,
        /// Moments per second in csv and npz.
        #[arg(long, default_value_t = 1000.0, value_parser = rate, value_name = "HZ")]
        rate: f64,
        /// `-` is standard output.
        #[arg(long, default_value = "-", value_name = "FILE|-")]
        out: String,
    },
    /// Write the motion of a result for the real legs: platform, joints, torques and the reaction on every foot.
    ///
    /// What the torques cost on the real joints is told.
    #[command(after_help = "Example:\n  piaffe lift results/amble-energy.json --rate 500 --out amble.csv")]
    Lift {
        /// A result as JSON; `-` reads standard input.
        #[arg(value_name = "FILE|-")]
        result: PathBuf,
        /// Moments per second.
        #[arg(long, default_value_t = 1000.0, value_parser = rate, value_name = "HZ")]
        rate: f64,
        #[arg(long, value_enum, default_value = "csv")]
        format: lift::Format,
        /// Which of the ways to share what legs that move as one do together.
        #[arg(long, value_enum, default_value = "least-cost")]
        shares: lift::Shares,
        /// `-` is standard output.
        #[arg(long, default_value = "-", value_name = "FILE|-")]
        out: String,
    },
    /// Derive anew what results state, from the specification and the variables of their motions alone.
    ///
    /// Says of every entry whether it was confirmed, what it should be instead, or why it could not be checked. How a
    /// motion was found (other optima, times, the search's settings) cannot be seen from it and is passed over. What a sweep
    /// says of its results as a whole must follow from the results beside it, but for what ended a gait.
    #[command(
        after_help = "Examples:\n  piaffe verify results/*.json\n  piaffe verify trot.json --json -\n  piaffe verify sweep/*.json\n\nThe exit code is 0 only if everything was confirmed that is stated about motions."
    )]
    Verify {
        /// Results as JSON, overviews of sweeps (`sweep.json`), or folders of them; `-` reads standard input.
        #[arg(required = true, value_name = "FILE|DIR|-")]
        results: Vec<PathBuf>,
        /// Write all verdicts as JSON; `-` is standard output.
        #[arg(long, value_name = "FILE|-")]
        json: Option<String>,
    },
    /// Show results: one page with the walks, all figures, and the receipts in words.
    ///
    /// The page needs neither network nor other files. Every figure is also written as SVG and PDF.
    #[command(
        after_help = "Examples:\n  piaffe report results/trot-energy.json --out trot\n  piaffe report sweep --out atlas"
    )]
    Report {
        /// Results as JSON, or the folder of a sweep; `-` reads standard input.
        #[arg(required = true, value_name = "FILE|DIR|-")]
        results: Vec<PathBuf>,
        /// Of results over many speeds, show in detail the walks at the speed nearest to this one, m/s.
        #[arg(long, value_parser = speed, value_name = "SPEED")]
        detail: Option<f64>,
        /// Folder for the report.
        #[arg(long, default_value = "report", value_name = "DIR")]
        out: PathBuf,
    },
    /// Find the optima of gaits over a range of speeds, their greatest speeds and where they overtake each other.
    ///
    /// Every point is written as it is found; a sweep that was interrupted goes on where it stopped.
    #[command(
        after_help = "Example:\n  piaffe sweep --gait trot --gait amble --criterion all --speeds 0.1..1.6:0.1 --out sweep"
    )]
    Sweep {
        /// May be given several times; if it is not given, the gaits of the first robot that never leave the ground (where all fly, all).
        /// `all` are those that fly too, whose searches take ten times as long.
        #[arg(long, value_parser = gait_names_or_all())]
        gait: Vec<String>,
        /// energy, torque or all; may be given several times.
        #[arg(long, value_parser = PossibleValuesParser::new(["energy", "torque", "all"]), default_value = "all")]
        criterion: Vec<String>,
        /// FROM..TO:STEP or a list, m/s.
        #[arg(long, value_parser = sweep::parse_speeds, default_value = "0.1..1.6:0.1")]
        speeds: std::vec::Vec<f64>,
        /// Impose contact, torque and speed limits at each real leg, not only at the virtual ones, where the platform rolls.
        #[arg(long)]
        real_legs: bool,
        /// Folder for the results.
        #[arg(long = "out", value_name = "DIR", default_value = "sweep")]
        folder: PathBuf,
        /// Starts at every speed, besides those from the neighbours; if it is not given, as for `optimize`.
        #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000))]
        starts: Option<u32>,
        /// Of the random starts.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        #[command(flatten)]
        closely: Closely,
    },
    /// Set two results side by side: numbers that differ, costs, limits, and how much of the difference the numbers explain.
    ///
    /// What both state is derived anew first. The slopes of the least cost, times the changes of the numbers, predict the cost's
    /// difference to first order. Each motion is carried over to the other's question, which tells one optimum that moved from two.
    #[command(
        after_help = "Examples:\n  piaffe diff light.json heavy.json\n  piaffe diff trot.json amble.json --json -"
    )]
    Diff {
        /// A result as JSON.
        #[arg(value_name = "A")]
        a: PathBuf,
        /// Another one.
        #[arg(value_name = "B")]
        b: PathBuf,
        /// Write all of it as JSON; `-` is standard output.
        #[arg(long, value_name = "FILE|-")]
        json: Option<String>,
    },
    /// Answer many robots that differ in some numbers: a table with a row for each robot, gait, criterion and speed.
    ///
    /// Numbers are named as for --set. Every row is written as it is found; a study that was interrupted goes on where it
    /// stopped. Every optimum is local: sought from the base robot's optima, and from starts that know nothing of them.
    #[command(
        after_help = "Examples:\n  piaffe study trot --speed 0.6 --vary links.thigh.mass=1.0..2.0:0.1\n  piaffe study trot --speed 0.6 --vary links.thigh.mass=1.0..2.0 --vary limits.friction=0.4..1.0 --sample 500\n  piaffe study --speed 0.4,0.6 --designs table.csv --shard 2/8 --out part2"
    )]
    Study(study::Arguments),
    /// Put the parts of a study together that were answered with --shard.
    #[command(after_help = "Example:\n  piaffe merge part1 part2 --out study")]
    Merge {
        /// Folders of the parts.
        #[arg(required = true, value_name = "DIR")]
        parts: Vec<PathBuf>,
        /// Folder for the whole.
        #[arg(long = "out", value_name = "DIR", default_value = "study")]
        folder: PathBuf,
    },
    /// Write the completions of a shell to standard output.
    #[command(after_help = "Example:\n  piaffe completions bash > ~/.local/share/bash-completion/completions/piaffe")]
    Completions { shell: clap_complete::Shell },
    /// Write the manual pages, one per command.
    #[command(after_help = "Example:\n  piaffe manual --out ~/.local/share/man/man1 && man piaffe")]
    Manual {
        /// Folder for the pages.
        #[arg(long, default_value = ".", value_name = "DIR")]
        out: PathBuf,
    },
}

/// What a command is about, and with it which options beside it mean something.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Subject {
    /// The gaits of a robot, which can be changed for this run.
    Gaits,
    /// Results, which carry what they are of.
    Results,
    /// No robot of the program.
    Else,
}

/// Of every command that there is.
const SUBJECTS: [(&str, Subject); 15] = [
    ("check", Subject::Else),
    ("dynamics", Subject::Gaits),
    ("model", Subject::Gaits),
    ("import", Subject::Else),
    ("optimize", Subject::Gaits),
    ("export", Subject::Results),
    ("lift", Subject::Results),
    ("verify", Subject::Results),
    ("report", Subject::Results),
    ("sweep", Subject::Gaits),
    ("diff", Subject::Results),
    ("study", Subject::Gaits),
    ("merge", Subject::Else),
    ("completions", Subject::Else),
    ("manual", Subject::Else),
];

impl Subject {
    /// Of the command of this name; of the main job, which has none, the gaits.
    fn of(command: &str) -> Subject {
        SUBJECTS.iter().find(|(name, _)| *name == command).map_or(Subject::Gaits, |(_, subject)| *subject)
    }

    /// What is wrong with options that mean nothing here.
    fn objection(self, robot: bool, changes: bool) -> Option<&'static str> {
        match self {
            Subject::Results if changes => Some(
                "--set, limits and loads are for commands that search: results carry what they are of, and cannot be changed",
            ),
            Subject::Else if robot || changes => {
                Some("--robot, --set, limits and loads are for commands about a robot's gaits and results")
            }
            _ => None,
        }
    }

    /// The command without the options that mean nothing there: who uses one all the same is told so.
    fn hide_from(self, command: clap::Command, robot: &[clap::Arg], changes: &[clap::Arg]) -> clap::Command {
        let meaningless = match self {
            Subject::Gaits => return command,
            Subject::Results => changes.to_vec(),
            Subject::Else => [robot, changes].concat(),
        };
        command.args(meaningless.into_iter().map(|arg| arg.global(false).hide(true)))
    }
}

impl Arguments {
    /// Says what stands behind the answer, where that is not what was built.
    fn note_changes(&self) {
        let first = || robots::keys().into_iter().flatten().filter(|key| !key.contains('/'));
        match &self.command {
            _ if self.robot.is_some() => {}
            None => robots::note_of(first()),
            Some(Command::Dynamics { gait, .. } | Command::Model { gait, .. } | Command::Optimize { gait, .. }) => {
                robots::note_of([gait.as_str()]);
            }
            Some(Command::Study(study)) if study.gaits.is_empty() => robots::note_of(first()),
            Some(Command::Study(study)) => robots::note_of(study.gaits.iter().map(String::as_str)),
            Some(Command::Sweep { gait, .. }) if gait.is_empty() => robots::note_of(first()),
            Some(Command::Sweep { gait, .. }) => robots::note_of(gait.iter().map(String::as_str)),
            // Results carry their robots.
            Some(_) => {}
        }
    }
}

/// The command line itself.
fn command() -> clap::Command {
    let whole = Arguments::command();
    let robot: Vec<clap::Arg> = whole.get_arguments().filter(|arg| arg.get_id() == "robot").cloned().collect();
    let changes: Vec<clap::Arg> = Asked::augment_args(clap::Command::new("")).get_arguments().cloned().collect();
    let own = |command: clap::Command| Subject::of(command.get_name()).hide_from(command, &robot, &changes);
    with_negative_numbers(whole.mut_subcommands(own))
}

/// A number with a sign is a value, which can be wrong as a value, and no option that nobody knows.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let of_arg = |arg: clap::Arg| match arg.get_action().takes_values() {
        true => arg.allow_negative_numbers(true),
        false => arg,
    };
    command.mut_args(of_arg).mut_subcommands(with_negative_numbers)
}

fn parse(typed: &[OsString]) -> Result<(Arguments, Subject), clap::Error> {
    let mut command = command();
    let read = |found: clap::ArgMatches| {
        let subject = found.subcommand_name().map_or(Subject::Gaits, Subject::of);
        Ok((Arguments::from_arg_matches(&found)?, subject))
    };
    command.try_get_matches_from_mut(typed).and_then(read).map_err(|error: clap::Error| error.format(&mut command))
}

/// The folder behind `--robot`, also where what was typed is no whole command.
fn robot_in(typed: &[OsString]) -> Option<PathBuf> {
    let mut words = typed.iter();
    words
        .find_map(|word| match word.to_str()? {
            "--robot" => Some(None),
            word => word.strip_prefix("--robot=").map(|folder| Some(folder.into())),
        })?
        .or_else(|| words.next().map(PathBuf::from))
}

/// What was typed. The names that a gait can have depend on the robot that is asked for: that is read first.
fn read(typed: &[OsString]) -> Result<Arguments, u8> {
    let usage = |error: clap::Error| {
        let _ = error.print();
        error.exit_code() as u8
    };
    let chosen = match parse(typed) {
        Ok((first, subject)) => {
            let changes = first.asked.changes();
            if let Some(why) = subject.objection(first.robot.is_some(), !changes.is_empty()) {
                return Err(usage(command().error(ErrorKind::ArgumentConflict, why)));
            }
            if subject == Subject::Else {
                robots::choose_built();
                Ok(())
            } else {
                robots::choose(first.robot.as_deref(), &changes)
            }
        }
        // Help names the gaits of the robot that was asked for, if it is one; of what is wrong else nothing hangs on the robot.
        Err(help) if help.kind() == ErrorKind::DisplayHelp => {
            let of_robot = robot_in(typed).map(|folder| robots::choose(Some(&folder), &Changes::default()));
            of_robot.filter(Result::is_ok).unwrap_or_else(|| robots::choose(None, &Changes::default()))
        }
        Err(error) => return Err(usage(error)),
    };
    if let Err(error) = chosen {
        output::error(&error);
        return Err(FAILED);
    }
    parse(typed).map(|(arguments, _)| arguments).map_err(usage)
}

/// Runs the program for the robots of `build`.
pub fn run(build: Build) -> ExitCode {
    ExitCode::from(run_with(build, &std::env::args_os().collect::<Vec<_>>()))
}

/// The same with what was typed, the program's name first; tells the exit code. Once in a process: it is the robots of the first
/// run that later ones find.
pub fn run_with(build: Build, typed: &[OsString]) -> u8 {
    let started = Instant::now();
    built::set(build);
    choose_threads();
    Store::of_user().choose();
    let arguments = match read(typed) {
        Ok(arguments) => arguments,
        Err(code) => return code,
    };
    if arguments.quiet {
        output::be_quiet();
    }
    arguments.note_changes();
    let unsuccessful =
        if matches!(arguments.command, Some(Command::Verify { .. })) { NOT_CONFIRMED } else { NO_OPTIMUM };
    let outcome = answer(arguments, started);
    // A full disk is a failure, also where only words went there.
    let outcome = outcome.and_then(|good| match output::lost() {
        Some(error) => Err(anyhow::anyhow!("cannot write to standard output: {error}")),
        None => Ok(good),
    });
    match outcome {
        Ok(true) => 0,
        Ok(false) => unsuccessful,
        Err(error) => {
            output::error(&error);
            FAILED
        }
    }
}

/// As many threads as RAYON_NUM_THREADS asks for, but no more than there are cores: those would only wait for each other.
fn choose_threads() {
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|count| count.trim().parse::<usize>().ok());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if asked.is_some_and(|count| count > cores) {
        // Whoever has threads already keeps those.
        let _ = ThreadPoolBuilder::new().num_threads(cores).build_global();
    }
}

/// Names of gaits: any, until it is known of which robots.
fn gait_names() -> ValueParser {
    robots::keys().map_or_else(ValueParser::string, |keys| PossibleValuesParser::new(keys).into())
}

fn gait_names_or_all() -> ValueParser {
    let names = |keys: Vec<&'static str>| PossibleValuesParser::new([robots::ALL].into_iter().chain(keys)).into();
    robots::keys().map_or_else(ValueParser::string, names)
}

/// Does what was asked for, by a program that was started then.
fn answer(arguments: Arguments, started: Instant) -> anyhow::Result<bool> {
    match arguments.command {
        None => main_job::run(&arguments.out, arguments.closely.examine),
        Some(Command::Check { folder, svg }) => check::run(&folder, svg.as_deref()),
        Some(Command::Dynamics { gait, file }) => dynamics::run(by_name(&gait)?, &file),
        Some(Command::Model { gait, latex, json }) => model::run(by_name(&gait)?, latex, json.as_deref()),
        Some(Command::Import(arguments)) => import::run(arguments),
        Some(Command::Optimize { gait, criterion, speed, seed, real_legs, starts, closely, json }) => {
            let task = Task { gait: by_name(&gait)?, criterion: criterion_by_name(&criterion), speed };
            optimize::run(task, real_legs, &settings(starts, seed, closely.examine), json.as_deref(), started)
        }
        Some(Command::Completions { shell }) => manual::completions(shell),
        Some(Command::Manual { out }) => manual::pages(&out),
        Some(Command::Export { result, format, rate, out }) => export::run(&result, format, rate, &out),
        Some(Command::Lift { result, rate, format, shares, out }) => lift::run(&result, format, rate, shares, &out),
        Some(Command::Verify { results, json }) => verify::run(&results, json.as_deref()),
        Some(Command::Report { results, detail, out }) => report::run(&results, detail, &out),
        Some(Command::Sweep { gait, criterion, speeds, real_legs, folder, starts, seed, closely }) => {
            let gaits = robots::wanted(&Wanted::by(&gait))?;
            sweep::run(
                &gaits,
                real_legs,
                &criteria(&criterion),
                &speeds,
                &folder,
                &settings(starts, seed, closely.examine),
            )
        }
        Some(Command::Diff { a, b, json }) => diff::run(&a, &b, json.as_deref()),
        Some(Command::Study(study)) => study::run(study, &arguments.asked.changes()),
        Some(Command::Merge { parts, folder }) => merge::run(&parts, &folder),
    }
}

fn settings(starts: Option<u32>, seed: u64, examination: Examination) -> Settings {
    Settings { starts: starts.map(|n| n as usize), seed, examination }
}

/// Those that are wanted by name, or all.
fn criteria(wanted: &[String]) -> Vec<Criterion> {
    let wanted = |c: &Criterion| wanted.iter().any(|w| w == "all" || w == c.name());
    Criterion::ALL.into_iter().filter(wanted).collect()
}

fn criterion_names() -> PossibleValuesParser {
    PossibleValuesParser::new(Criterion::ALL.map(Criterion::name))
}

fn examinations() -> impl TypedValueParser<Value = Examination> {
    let names = PossibleValuesParser::new(Examination::ALL.map(Examination::name));
    names.map(|name| Examination::by_name(&name).unwrap_or_default())
}

/// The criterion of that name; the parser has admitted no other names.
fn criterion_by_name(name: &str) -> Criterion {
    Criterion::ALL.into_iter().find(|c| c.name() == name).unwrap_or(Criterion::Energy)
}

/// A speed, m/s.
fn speed(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if Unaskable::of(v).is_none() => Ok(v),
        Ok(_) => Err("is no positive number of m/s; write for example 0.6".into()),
        Err(_) => Err("is not a number; write for example 0.6".into()),
    }
}

fn rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if (1.0..=1e6).contains(&v) => Ok(v),
        Ok(_) => Err("must be between 1 and 1000000 per second".into()),
        Err(_) => Err("is not a number; write for example 1000".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_its_subject() {
        let commands = Arguments::command();
        let names: Vec<&str> = commands.get_subcommands().map(clap::Command::get_name).collect();
        assert_eq!(names, SUBJECTS.map(|(name, _)| name));
    }
}
