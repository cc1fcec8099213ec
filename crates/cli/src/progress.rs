//! How far a search is, told on standard error: a bar on a terminal, elsewhere a line now and then, if it takes long.

use super::output;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use std::ops::Deref;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

/// A search says nothing for so long where it has no bar. Every further line comes after twice the time.
const SILENT: Duration = Duration::from_secs(10);

/// What is counted.
#[derive(Clone, Copy)]
pub enum Counted {
    /// Starts of a search, if it is known how many there will be.
    Starts(Option<usize>),
    /// Rows of a table.
    Rows(usize),
    /// So much work in all.
    Work(u64),
}

/// A bar, until it is dropped.
pub struct Progress {
    bar: ProgressBar,
    /// Ends the lines with it.
    _lines: Option<Sender<()>>,
}

impl Deref for Progress {
    type Target = ProgressBar;

    fn deref(&self) -> &ProgressBar {
        &self.bar
    }
}

impl Progress {
    pub fn new(counted: Counted) -> Progress {
        if output::is_quiet() {
            return Progress { bar: ProgressBar::hidden(), _lines: None };
        }
        let bar = counted.length().map_or_else(ProgressBar::no_length, ProgressBar::new);
        let style = ProgressStyle::with_template(counted.template());
        let bar = bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let lines = bar.is_hidden().then(|| lines(bar.clone(), counted));
        Progress { bar, _lines: lines }
    }

    /// What is being done.
    pub fn of(self, message: &'static str) -> Progress {
        self.bar.set_message(message);
        self
    }
}

impl Counted {
    fn length(self) -> Option<u64> {
        match self {
            Counted::Starts(starts) => starts.map(|n| n as u64),
            Counted::Rows(rows) => Some(rows as u64),
            Counted::Work(work) => Some(work),
        }
    }

    fn template(self) -> &'static str {
        match self {
            Counted::Starts(Some(_)) => "{msg} {bar:30} {pos}/{len} starts {elapsed}",
            Counted::Starts(None) => "{msg} {pos} starts {elapsed}",
            Counted::Rows(_) => "{msg} {bar:30} {pos}/{len} {elapsed}, about {eta} left",
            Counted::Work(_) => "{msg} {bar:30} {percent} % {elapsed}, about {eta} left",
        }
    }

    /// How much of it is done, in words; none where it was more than foreseen.
    fn words(self, done: u64) -> Option<String> {
        Some(match self {
            Counted::Starts(None) => format!("{done} starts"),
            Counted::Starts(Some(starts)) => format!("{done} of {starts} starts"),
            Counted::Rows(rows) => format!("{done} of {rows}"),
            Counted::Work(work) if done > work => return None,
            Counted::Work(work) => format!("{} %", (100 * done).checked_div(work).unwrap_or(100)),
        })
    }
}

/// Says now and then how far a bar is that nobody sees, until what is returned is dropped.
fn lines(bar: ProgressBar, counted: Counted) -> Sender<()> {
    let (lines, over) = channel();
    thread::spawn(move || {
        let mut next = SILENT;
        while let Err(RecvTimeoutError::Timeout) = over.recv_timeout(next.saturating_sub(bar.elapsed())) {
            if bar.is_finished() {
                return;
            }
            output::note(&still(bar.elapsed(), &bar.message(), counted.words(bar.position())));
            next *= 2;
        }
    });
    lines
}

fn still(elapsed: Duration, message: &str, done: Option<String>) -> String {
    let said: Vec<String> =
        Some(message.to_string()).filter(|message| !message.is_empty()).into_iter().chain(done).collect();
    format!("still searching after {:#}: {}", HumanDuration(elapsed), said.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_how_long_what_and_how_much() {
        let line = |seconds, message, counted: Counted, done| {
            still(Duration::from_secs(seconds), message, counted.words(done))
        };
        assert_eq!(line(10, "", Counted::Starts(None), 12), "still searching after 10s: 12 starts");
        assert_eq!(line(40, "trot", Counted::Starts(Some(20)), 12), "still searching after 40s: trot, 12 of 20 starts");
        assert_eq!(line(160, "rows", Counted::Rows(900), 30), "still searching after 3m: rows, 30 of 900");
        assert_eq!(line(20, "optima", Counted::Work(4000), 1000), "still searching after 20s: optima, 25 %");
        assert_eq!(line(20, "speeds", Counted::Work(4000), 4100), "still searching after 20s: speeds");
        assert_eq!(line(20, "optima", Counted::Work(0), 0), "still searching after 20s: optima, 100 %");
    }
}
