//! A figure: a drawing with a name, for a page or for a file.

use super::plot::Plot;
use super::scene::Scene;
use serde_json::Value;

#[derive(Clone, Debug)]
pub struct Figure {
    /// Names its files.
    pub name: String,
    /// In one line, for those who cannot see it.
    pub title: String,
    /// Under it.
    pub caption: String,
    pub scene: Scene,
    /// What a reader who points at it is told.
    pub data: Option<Value>,
    /// Whether it takes the whole width.
    pub wide: bool,
}

impl Figure {
    pub fn plot(name: &str, plot: &Plot, caption: impl Into<String>) -> Figure {
        Figure {
            name: name.into(),
            title: plot.title.clone(),
            caption: caption.into(),
            scene: plot.scene(),
            data: Some(plot.data()),
            wide: false,
        }
    }

    pub fn drawing(name: &str, title: &str, scene: Scene, caption: impl Into<String>) -> Figure {
        Figure { name: name.into(), title: title.into(), caption: caption.into(), scene, data: None, wide: true }
    }
}
