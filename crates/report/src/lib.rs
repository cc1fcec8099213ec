//! A report: results as figures, and as one page that needs nothing else.
//!
//! `subject` is one result and its walk, `atlas` many results over speeds. A file per figure makes its plot or
//! drawing; `scene` is what they are made of, `svg` and `pdf` how it is written, `page` the page.

#![forbid(unsafe_code)]

mod atlas;
mod certificate;
mod compare;
mod envelope;
mod figure;
mod font;
mod footfall;
mod ink;
mod joints;
mod levers;
mod marks;
mod momentum;
mod number;
pub mod overview;
mod page;
mod pdf;
mod player;
mod plot;
mod power;
mod price;
mod reaction;
mod real_legs;
mod record;
mod recovery;
mod scale;
mod scene;
pub mod space;
mod stick;
mod subject;
mod svg;
mod swing;
mod words;

pub use atlas::{Extremes, is_one_speed, told_apart};
pub use figure::Figure;
pub use record::{Record, Standing};
pub use subject::Subject;

use atlas::Atlas;
use piaffe_optimizer::flow::Undefined;
use space::Space;

/// Why there is no report.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReportError {
    #[error("{0}")]
    Nothing(String),
    #[error(transparent)]
    Undefined(#[from] Undefined),
}

/// Results with their walks, and how they compare.
pub struct Report<'a> {
    subjects: Vec<(Subject<'a>, Vec<Figure>)>,
    /// All results, those without an optimum and those that could not be confirmed too.
    records: Vec<Record<'a>>,
    atlas: Option<(Atlas, Vec<Figure>)>,
    space: Option<(Space, Vec<Figure>)>,
}

/// A file of a report: its path in the report's folder, with `/`, and its contents.
pub struct File {
    pub path: String,
    pub contents: Vec<u8>,
}

/// With more optima than this, only those at one speed are shown in detail.
const DETAILS: usize = 12;

impl<'a> Report<'a> {
    /// Makes all figures. Of results over many speeds, the walks at the speed nearest to `detail` (m/s; the middle
    /// one if there is none) are shown.
    ///
    /// # Errors
    /// If no result is a confirmed optimum, or the motion of one cannot be followed.
    pub fn new(
        mut records: Vec<Record<'a>>,
        extremes: Extremes,
        detail: Option<f64>,
    ) -> Result<Report<'a>, ReportError> {
        let mut kept: Vec<Record> = Vec::new();
        for record in records.drain(..) {
            // The same result given twice is one.
            if !kept.iter().any(|k| k.result == record.result && k.is_confirmed() == record.is_confirmed()) {
                kept.push(record);
            }
        }
        let records = kept;
        let mut shown: Vec<&Record> = records.iter().filter(|r| r.is_confirmed()).collect();
        if shown.is_empty() {
            return Err(ReportError::Nothing(nothing(&records)));
        }
        if shown.len() > DETAILS || detail.is_some() {
            let mut speeds: Vec<f64> = shown.iter().map(|r| r.result.speed).collect();
            speeds.sort_by(f64::total_cmp);
            let wanted = detail.unwrap_or(speeds[speeds.len() / 2]);
            speeds.sort_by(|a, b| (a - wanted).abs().total_cmp(&(b - wanted).abs()));
            shown.retain(|r| r.result.speed == speeds[0]);
        }
        let mut subjects: Vec<(Subject, Vec<Figure>)> = Vec::new();
        for record in shown {
            let id = unique(record, subjects.iter().map(|(s, _)| s.id.as_str()));
            if let Some(subject) = Subject::new(record, id)? {
                let figures = figures(&subject);
                subjects.push((subject, figures));
            }
        }
        let atlas = Atlas::new(&records, extremes).map(|atlas| {
            let figures = atlas.figures();
            (atlas, figures)
        });
        Ok(Report { subjects, records, atlas, space: None })
    }

    /// The same for some walks out of a study.
    pub fn of_space(self, space: Space) -> Report<'a> {
        let figures = space.figures();
        Report { space: Some((space, figures)), ..self }
    }

    /// The page alone.
    pub fn page(&self) -> String {
        page::page(self)
    }

    /// Name of the page's file.
    pub fn file_name(&self) -> &'static str {
        if self.space.is_some() { "study.html" } else { "index.html" }
    }

    /// The page, and every figure as SVG and PDF.
    pub fn files(&self) -> Vec<File> {
        let mut files = vec![File { path: self.file_name().into(), contents: self.page().into_bytes() }];
        let of_walks = self.subjects.iter().flat_map(|(s, figures)| figures.iter().map(|f| (format!("{}-", s.id), f)));
        let of_atlas = self.atlas.iter().flat_map(|(_, figures)| figures.iter().map(|f| (String::new(), f)));
        let of_space = self.space.iter().flat_map(|(_, figures)| figures.iter().map(|f| (String::new(), f)));
        for (of, figure) in of_atlas.chain(of_space).chain(of_walks) {
            let path = format!("figures/{of}{}", figure.name);
            files.push(File {
                path: format!("{path}.svg"),
                contents: svg::file(&figure.scene, &figure.title).into_bytes(),
            });
            files.push(File { path: format!("{path}.pdf"), contents: pdf::file(&figure.scene, &figure.title) });
        }
        files
    }
}

/// Why there is nothing to show.
fn nothing(records: &[Record]) -> String {
    let reasons: Vec<String> = records.iter().filter_map(Record::reason).collect();
    match reasons.as_slice() {
        [] => "no results were given".into(),
        [only] => only.clone(),
        all => format!("none of the results is a confirmed optimum: there is no walk to show\n  {}", all.join("\n  ")),
    }
}

/// A name for a result that none of these has.
fn unique<'i>(record: &Record, taken: impl Iterator<Item = &'i str> + Clone) -> String {
    let legs = if record.result.limits_at_real_legs { "-real-legs" } else { "" };
    let name = format!("{}{legs}", record.result.name());
    let numbered = (2..).map(|k| format!("{name}-{k}"));
    let free = |id: &String| !taken.clone().any(|other| other == id);
    std::iter::once(name.clone()).chain(numbered).find(free).unwrap_or(name)
}

/// All figures of a walk, in the order in which they are read.
pub fn figures(s: &Subject) -> Vec<Figure> {
    let mut figures = vec![footfall::figure(s)];
    figures.extend(stick::figures(s));
    figures.extend(envelope::figures(s));
    figures.push(joints::torques(s));
    figures.push(reaction::forces(s));
    figures.push(reaction::friction(s));
    figures.extend(real_legs::figures(s));
    figures.push(swing::clearance(s));
    figures.extend(joints::angles(s));
    figures.push(joints::speeds(s));
    figures.push(power::power(s));
    figures.push(power::integral(s));
    figures.push(momentum::momentum(s));
    figures
}
