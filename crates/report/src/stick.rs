//! Stick diagrams (figs. 6–11, top left): poses of the virtual legs at equal times, to scale.

use super::figure::Figure;
use super::font::Weight;
use super::ink::Ink;
use super::scale::Scale;
use super::scene::{Anchor, Dash, Pen, Scene, Xy};
use super::subject::Subject;
use piaffe_optimizer::walk::{Moment, Point};

/// Poses per phase.
const POSES: usize = 7;
const SMALL: f64 = 11.0;

/// From the side; where the robot moves sideways also from the front and in space.
pub fn figures(s: &Subject) -> Vec<Figure> {
    let side = View { horizontal: [1.0, 0.0, 0.0], vertical: [0.0, 1.0, 0.0], axis: "Xf" };
    let caption = format!(
        "One whole step in {} poses at equal times. Blue: virtual leg 1 ({}); orange: virtual leg 2 ({}). Dotted: the feet's paths and the platform's mass centre. Dashed: the robot's mass centre{}.",
        s.walk.phases.len() * POSES,
        s.leg_name(0),
        s.leg_name(1),
        if s.description().flies() { ", in flight on a parabola" } else { "" }
    );
    let mut figures = vec![Figure::drawing("sticks", "Stick diagram", side.draw(s, 640.0), caption)];
    if s.description().is_spatial() {
        let front = View { horizontal: [0.0, 0.0, 1.0], vertical: [0.0, 1.0, 0.0], axis: "Zf" };
        let mut figure = Figure::drawing(
            "sticks-behind",
            "Stick diagram from behind",
            front.draw(s, 384.0),
            "From behind: plane of Zf and Yf.",
        );
        figure.wide = false;
        figures.push(figure);
        let space = View { horizontal: [1.0, 0.0, 0.5], vertical: [0.0, 1.0, -0.3], axis: "" };
        let caption = "In space, obliquely; the platform's length is left out, as it is in fig. 7.";
        figures.push(Figure::drawing("sticks-space", "Stick diagram in space", space.draw(s, 640.0), caption));
    }
    figures
}

/// A parallel projection.
struct View {
    horizontal: Point,
    vertical: Point,
    /// Name of the horizontal axis, if it is one of the world's.
    axis: &'static str,
}

fn dot(a: Point, b: Point) -> f64 {
    a.iter().zip(&b).map(|(a, b)| a * b).sum()
}

impl View {
    fn project(&self, p: Point) -> Xy {
        [dot(self.horizontal, p), dot(self.vertical, p)]
    }

    fn draw(&self, s: &Subject, width: f64) -> Scene {
        let d = s.description();
        let poses = poses(s);
        let chains = |m: &Moment| {
            [0, 1].map(|leg| m.virtual_chain(d, leg).into_iter().map(|p| self.project(p)).collect::<Vec<_>>())
        };
        let all: Vec<Xy> = poses
            .iter()
            .flat_map(|m| chains(m).concat())
            .chain(poses.iter().flat_map(|m| [m.platform[0], m.centre[0]]).map(|p| self.project(p)))
            .collect();
        let bounds = |k: usize| {
            all.iter().map(|p| p[k]).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
        };
        let ([x0, x1], [y0, y1]) = (bounds(0), bounds(1));
        let (left, right, top, bottom) = (40.0, 16.0, 14.0, 36.0);
        // To scale, and no taller than wide.
        let least = 1e-3 * s.description().leg_length();
        let scale = ((width - left - right) / (x1 - x0).max(least)).min(0.58 * width / (y1 - y0).max(least));
        let height = top + bottom + scale * (y1 - y0);
        let middle = 0.5 * (left + width - right);
        let reach = 0.5 * scale * (x1 - x0);
        let x = Scale { domain: [x0, x1], range: [middle - reach, middle + reach] };
        let y = Scale { domain: [y0, y1], range: [height - bottom, top] };
        let place = |p: Xy| [x.at(p[0]), y.at(p[1])];
        let mut scene = Scene::new(width, height);
        self.axes(&mut scene, x, y);

        let path = |scene: &mut Scene, points: Vec<Point>, ink, dash| {
            let points: Vec<Xy> = points.into_iter().map(|p| place(self.project(p))).collect();
            scene.line(&points, Pen::new(ink, 1.4).dash(dash));
        };
        for (k, phase) in s.walk.phases.iter().enumerate() {
            for leg in phase.mode.swinging() {
                let foot = s.walk.moments.iter().filter(|m| m.phase == k).map(|m| m.feet[leg]).collect();
                path(&mut scene, foot, Ink::Leg(leg), Dash::Dotted);
            }
        }
        let mut order: Vec<usize> = (0..poses.len()).collect();
        // The poses at impacts come last, so that they are on top.
        order.sort_by_key(|k| poses[*k].share == 0.0 || poses[*k].share == 1.0);
        for k in order {
            let m = poses[k];
            let key = m.share == 0.0 || m.share == 1.0;
            let (weight, opacity) = if key { (2.6, 1.0) } else { (1.3, 0.55) };
            let legs = chains(m);
            let hips: Vec<Xy> = legs.iter().map(|chain| place(chain[0])).collect();
            scene.line(&hips, Pen::new(Ink::Muted, weight).opacity(opacity));
            for (leg, chain) in legs.iter().enumerate() {
                let points: Vec<Xy> = chain.iter().map(|p| place(*p)).collect();
                scene.line(&points, Pen::new(Ink::Leg(leg), weight).opacity(opacity));
            }
        }
        path(&mut scene, s.walk.moments.iter().map(|m| m.platform[0]).collect(), Ink::Text, Dash::Dotted);
        path(&mut scene, s.walk.moments.iter().map(|m| m.centre[0]).collect(), Ink::Text, Dash::Dashed);
        scene
    }

    fn axes(&self, scene: &mut Scene, x: Scale, y: Scale) {
        let ground = y.range[0];
        let (left, right) = (40.0, scene.width - 10.0);
        if self.axis.is_empty() {
            return;
        }
        scene.line(&[[left, ground], [right, ground]], Pen::new(Ink::Axis, 1.2));
        // Equal scales: round numbers of one axis serve both.
        let count = (((right - left) / 70.0) as usize).max(2);
        let per_unit = (x.range[1] - x.range[0]) / (x.domain[1] - x.domain[0]);
        let wide =
            Scale { domain: [left, right].map(|at| x.domain[0] + (at - x.range[0]) / per_unit), range: [left, right] };
        let ticks = wide.roomy_ticks(count, |label| Weight::Regular.width(label, SMALL));
        for (tick, label) in &ticks.list {
            let at = wide.at(*tick);
            scene.line(&[[at, ground], [at, ground + 4.0]], Pen::new(Ink::Axis, 1.0));
            scene.text([at, ground + 16.0], label, SMALL, Anchor::Middle, Ink::Muted);
        }
        let heights = y.ticks(4);
        for (tick, label) in &heights.list {
            let at = y.at(*tick);
            scene.text([left - 7.0, at + 4.0], label, SMALL, Anchor::End, Ink::Muted);
            scene.line(&[[left - 4.0, at], [left, at]], Pen::new(Ink::Axis, 1.0));
        }
        scene.quantity([right, ground + 31.0], [self.axis, "m"], ticks.power, SMALL, Anchor::End, Ink::Muted);
        scene.quantity([left + 6.0, 11.0], ["Yf", "m"], heights.power, SMALL, Anchor::Start, Ink::Muted);
    }
}

/// Moments at equal times, both ends of each phase among them.
fn poses<'s>(s: &'s Subject) -> Vec<&'s Moment> {
    let of_phase = |k| {
        let moments: Vec<&Moment> = s.walk.moments.iter().filter(|m| m.phase == k).collect();
        let last = moments.len() - 1;
        (0..POSES).map(move |pose| moments[(pose * last + (POSES - 1) / 2) / (POSES - 1)]).collect::<Vec<_>>()
    };
    (0..s.walk.phases.len()).flat_map(of_phase).collect()
}
