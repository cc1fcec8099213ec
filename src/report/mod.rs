//! A report: results as figures, and as one page that needs nothing else.
//!
//! `subject` is one result and its walk, `atlas` many results over speeds. A file per figure makes its plot or
//! drawing; `scene` is what they are made of, `svg` and `pdf` how it is written, `page` the page.

mod atlas;
mod certificate;
mod envelope;
mod figure;
mod font;
mod footfall;
mod ink;
mod joints;
mod levers;
mod momentum;
mod page;
mod pdf;
mod player;
mod plot;
mod power;
mod price;
mod reaction;
mod real_legs;
mod recovery;
mod scale;
mod scene;
mod stick;
mod subject;
mod svg;
mod swing;
mod words;

pub use figure::Figure;
pub use subject::Subject;

use crate::model::Gait;
use crate::readback::Unusable;
use crate::result::GaitResult;
use crate::stance::Undefined;
use atlas::Atlas;
pub use atlas::Extremes;

/// Why there is no report.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReportError {
    #[error("none of the results is an optimum: there is no walk to show")]
    Nothing,
    #[error(transparent)]
    Unusable(#[from] Unusable),
    #[error(transparent)]
    Undefined(#[from] Undefined),
}

/// Results with their walks, and how they compare.
pub struct Report<'a> {
    subjects: Vec<(Subject<'a>, Vec<Figure>)>,
    /// All results, those without an optimum too.
    results: Vec<GaitResult>,
    atlas: Option<(Atlas, Vec<Figure>)>,
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
    /// If no result is an optimum, or one is not of this build or not consistent.
    pub fn new(
        results: Vec<GaitResult>,
        extremes: Extremes,
        detail: Option<f64>,
        gaits: &[&'a dyn Gait],
    ) -> Result<Report<'a>, ReportError> {
        let mut shown: Vec<&GaitResult> = results.iter().filter(|r| r.is_optimal()).collect();
        match (results.as_slice(), shown.is_empty()) {
            ([only], true) => {
                let (name, message) = (only.name(), only.message.clone());
                return Err(Unusable::NoOptimum { name, message }.into());
            }
            (_, true) => return Err(ReportError::Nothing),
            _ => {}
        }
        if shown.len() > DETAILS || detail.is_some() {
            let mut speeds: Vec<f64> = shown.iter().map(|r| r.speed).collect();
            speeds.sort_by(f64::total_cmp);
            let wanted = detail.unwrap_or(speeds[speeds.len() / 2]);
            speeds.sort_by(|a, b| (a - wanted).abs().total_cmp(&(b - wanted).abs()));
            shown.retain(|r| r.speed == speeds[0]);
        }
        let subjects = shown
            .into_iter()
            .map(|r| {
                let subject = Subject::new(r.clone(), gaits)?;
                let figures = figures(&subject);
                Ok((subject, figures))
            })
            .collect::<Result<Vec<_>, ReportError>>()?;
        let atlas = Atlas::new(&results, extremes).map(|atlas| {
            let figures = atlas.figures();
            (atlas, figures)
        });
        Ok(Report { subjects, results, atlas })
    }

    /// `index.html`, and every figure as SVG and PDF.
    pub fn files(&self) -> Vec<File> {
        let mut files = vec![File { path: "index.html".into(), contents: page::page(self).into_bytes() }];
        let of_walks = self.subjects.iter().flat_map(|(s, figures)| figures.iter().map(|f| (s.result.name() + "-", f)));
        let of_atlas = self.atlas.iter().flat_map(|(_, figures)| figures.iter().map(|f| (String::new(), f)));
        for (of, figure) in of_atlas.chain(of_walks) {
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
