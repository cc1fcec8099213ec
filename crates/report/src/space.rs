//! Many robots that differ in some numbers: what each costs as a line across axes, and which are better than all others.

use super::figure::Figure;
use super::font::Weight;
use super::ink::Ink;
use super::number::{given, significant};
use super::plot::{Axis, Curve, Plot, rounded};
use super::scale::{Scale, domain};
use super::scene::{Anchor, Pen, Scene, Xy};
use super::subject::spaced;
use piaffe_model::digits::digits;
use piaffe_model::motion::{Costs, Criterion};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Robots that are drawn; more show nothing more.
const DRAWN: usize = 1500;

/// The share of the robots whose lines stand out.
const BEST: f64 = 0.05;

/// Walks that a page shows of a study.
const WALKS: usize = 12;

/// The answers of a study.
pub struct Space {
    pub robot: String,
    /// Names of the varied numbers.
    pub numbers: Vec<String>,
    pub spots: Vec<Spot>,
}

/// An answer.
#[derive(Clone, Debug)]
pub struct Spot {
    pub point: usize,
    pub design: usize,
    /// In the order of the names.
    pub numbers: Vec<f64>,
    pub gait: String,
    pub criterion: Criterion,
    /// m/s.
    pub speed: f64,
    /// Of its optimum, if there is one.
    pub costs: Option<Costs>,
    /// What became of the question, in a few words.
    pub status: String,
}

impl Spot {
    fn cost(&self) -> Option<f64> {
        Some(self.costs?.of(self.criterion))
    }
}

/// An axis across which lines go.
#[derive(Clone, Copy, PartialEq)]
enum Across {
    /// Which of the varied ones.
    Number(usize),
    Speed,
    Cost,
}

impl Across {
    /// Tells it from others, whichever figure it is in; costs are of a gait's criterion.
    fn key(self, first: &Spot) -> String {
        match self {
            Across::Number(k) => k.to_string(),
            Across::Speed => "speed".into(),
            Across::Cost => format!("cost {} {}", first.gait, first.criterion.name()),
        }
    }

    /// Where a spot is on it.
    fn value(self, spot: &Spot) -> Option<f64> {
        match self {
            Across::Number(k) => spot.numbers.get(k).copied(),
            Across::Speed => Some(spot.speed),
            Across::Cost => spot.cost(),
        }
    }
}

impl Space {
    /// How many robots there are.
    pub fn designs(&self) -> usize {
        let mut designs: Vec<usize> = self.spots.iter().map(|spot| spot.design).collect();
        designs.sort_unstable();
        designs.dedup();
        designs.len()
    }

    pub(super) fn lead(&self) -> String {
        let optimal = self.spots.iter().filter(|spot| spot.costs.is_some()).count();
        format!("{} questions, {optimal} with a local optimum whose receipt holds.", self.spots.len())
    }

    /// Points whose walks are worth showing: the best of every gait, criterion and speed, then those that are best in both criteria.
    /// No more than a page can hold.
    pub fn worth_showing(&self) -> Vec<usize> {
        let best = |group: &[&Spot]| {
            let cost = |spot: &&&Spot| spot.cost().unwrap_or(f64::INFINITY);
            group.iter().min_by(|a, b| cost(a).total_cmp(&cost(b))).filter(|spot| spot.costs.is_some()).map(|s| s.point)
        };
        let bests = self.groups(|spot| (&spot.gait, spot.criterion, spot.speed)).into_iter();
        let mut points: Vec<usize> = bests.filter_map(|group| best(&group)).collect();
        for group in self.groups(|spot| (&spot.gait, spot.speed)) {
            points.extend(front(&group, both).into_iter().map(|(spot, _)| spot.point));
        }
        let mut known = BTreeSet::new();
        points.retain(|point| known.insert(*point));
        points.truncate(WALKS);
        points
    }

    /// How many robots stand between one that is drawn and the next, and the answers of those that are.
    fn drawn(&self) -> (usize, Vec<&Spot>) {
        let every = self.designs().div_ceil(DRAWN).max(1);
        let shown: BTreeSet<usize> = self.worth_showing().into_iter().collect();
        let of_shown: BTreeSet<usize> =
            self.spots.iter().filter(|spot| shown.contains(&spot.point)).map(|spot| spot.design).collect();
        let is_drawn = |spot: &&Spot| {
            spot.costs.is_some() && (spot.design.is_multiple_of(every) || of_shown.contains(&spot.design))
        };
        (every, self.spots.iter().filter(is_drawn).collect())
    }

    /// What a page needs to bring the figures to life: the answers in the order of their numbers there. Costs are energy and torque.
    pub(super) fn data(&self) -> Value {
        let spot = |spot: &Spot| {
            let costs = spot.costs.map(|costs| [costs.energy, costs.torque].map(rounded));
            let (numbers, criterion) = (spot.numbers.iter().map(|n| rounded(*n)).collect::<Vec<_>>(), spot.criterion);
            json!([spot.design, spot.gait, criterion.name(), spot.speed, costs, spot.status, numbers])
        };
        let (_, drawn) = self.drawn();
        json!({
            "numbers": self.numbers,
            "units": Criterion::ALL.map(Criterion::unit),
            "designs": self.designs(),
            "spots": drawn.into_iter().map(spot).collect::<Vec<_>>(),
        })
    }

    /// The robots whose walks are worth showing, each with its numbers.
    pub(super) fn shown(&self) -> Vec<String> {
        let points = self.worth_showing();
        let mut designs: Vec<&Spot> = Vec::new();
        for spot in points.iter().filter_map(|point| self.spots.iter().find(|spot| spot.point == *point)) {
            if designs.iter().all(|known| known.design != spot.design) {
                designs.push(spot);
            }
        }
        let number = |(name, value): (&String, &f64)| format!("{name} = {}", significant(*value, 5));
        let words = |spot: &&Spot| {
            let numbers: Vec<String> = self.numbers.iter().zip(&spot.numbers).map(number).collect();
            format!(
                "Design {}: {}",
                spot.design,
                if numbers.is_empty() { "as specified".into() } else { numbers.join(", ") }
            )
        };
        designs.iter().map(words).collect()
    }

    /// All figures, in the order in which they are read.
    pub fn figures(&self) -> Vec<Figure> {
        let mut figures = Vec::new();
        let (every, drawn) = self.drawn();
        let drawn = Drawn { every, numbers: drawn.iter().enumerate().map(|(k, spot)| (spot.point, k)).collect() };
        for group in self.groups(|spot| (&spot.gait, spot.criterion)) {
            figures.extend(self.parallel(&group, &drawn));
        }
        for group in self.groups(|spot| (&spot.gait, spot.speed)) {
            figures.extend(self.fronts(&group, &drawn));
        }
        for group in self.groups(|spot| (&spot.gait, spot.criterion, spot.speed)) {
            for k in 0..self.numbers.len() {
                figures.extend(self.over(k, &group, &drawn));
            }
        }
        figures
    }

    /// Spots that are alike in something, in the order of their first ones.
    fn groups<'a, K: PartialEq>(&'a self, key: impl Fn(&'a Spot) -> K) -> Vec<Vec<&'a Spot>> {
        let mut groups: Vec<(K, Vec<&Spot>)> = Vec::new();
        for spot in &self.spots {
            let key = key(spot);
            match groups.iter_mut().find(|group| group.0 == key) {
                Some(group) => group.1.push(spot),
                None => groups.push((key, vec![spot])),
            }
        }
        groups.into_iter().map(|(_, group)| group).collect()
    }

    /// Parallel coordinates: a line for each robot across the varied numbers, the speed and the cost.
    fn parallel(&self, group: &[&Spot], drawn: &Drawn) -> Option<Figure> {
        let first = group.first()?;
        let mut axes: Vec<Across> = (0..self.numbers.len()).map(Across::Number).chain([Across::Speed]).collect();
        // What is the same for all says nothing.
        axes.retain(|axis| {
            let mut values = group.iter().filter_map(|spot| axis.value(spot));
            let first = values.next();
            values.any(|value| Some(value) != first)
        });
        axes.push(Across::Cost);
        let mut optimal: Vec<&Spot> = group.iter().copied().filter(|spot| spot.costs.is_some()).collect();
        if axes.len() < 2 || optimal.len() < 2 {
            return None;
        }
        let cost = |spot: &Spot| spot.cost().unwrap_or(f64::INFINITY);
        optimal.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
        let best = ((optimal.len() as f64 * BEST).ceil() as usize).max(1);
        let (left, right, top, bottom) = (64.0, 736.0, 52.0, 262.0);
        let scale = |axis: &Across| {
            let domain = domain(optimal.iter().filter_map(|spot| axis.value(spot)));
            Scale { domain, range: [bottom, top] }
        };
        let scales: Vec<Scale> = axes.iter().map(scale).collect();
        let x = |k: usize| left + (right - left) * k as f64 / (axes.len() - 1) as f64;
        let mut scene = Scene::new(800.0, bottom + 24.0);
        let title = format!("{}, least {}", spaced(&first.gait), first.criterion.name());
        scene.write([4.0, 15.0], &title, 13.0, Weight::Bold, Anchor::Start, Ink::Text);
        // The best last, on top.
        for (k, spot) in optimal.iter().enumerate().rev() {
            let Some(number) = drawn.numbers.get(&spot.point) else { continue };
            let place = |(j, axis): (usize, &Across)| Some([x(j), scales[j].at(axis.value(spot)?)]);
            let points: Option<Vec<Xy>> = axes.iter().enumerate().map(place).collect();
            let pen = if k < best { Pen::new(Ink::gait(0), 1.4) } else { Pen::new(Ink::Muted, 0.7).opacity(0.25) };
            scene.line(&points?, pen);
            scene.number(*number);
        }
        for (k, (axis, scale)) in axes.iter().zip(&scales).enumerate() {
            scene.line(&[[x(k), top], [x(k), bottom]], Pen::new(Ink::Axis, 1.0));
            let ticks = scale.ticks(5);
            for (tick, label) in &ticks.list {
                let at = scale.at(*tick);
                scene.line(&[[x(k) - 3.0, at], [x(k), at]], Pen::new(Ink::Axis, 1.0));
                scene.text([x(k) - 5.0, at + 4.0], label, 10.0, Anchor::End, Ink::Muted);
            }
            // Names stand in turn in two rows, so that long ones have room.
            let row = if k % 2 == 0 { 42.0 } else { 30.0 };
            let words = match axis {
                Across::Number(k) => [self.numbers[*k].as_str(), ""],
                Across::Speed => ["speed", "m/s"],
                Across::Cost => ["cost", first.criterion.unit()],
            };
            scene.quantity([x(k), row], words, ticks.power, 10.0, Anchor::Middle, Ink::Text);
        }
        let name = format!("parallel-{}-{}", first.gait.replace('/', "-"), first.criterion.name());
        let some = match drawn.every {
            1 => String::new(),
            every => format!(" Drawn: one in {every}, and those whose walks are shown."),
        };
        let caption =
            format!("A line for each robot with an optimum. In colour: the best {best} of {}.{some}", optimal.len());
        let axis = |(k, (axis, scale)): (usize, (&Across, &Scale))| {
            let what = match axis {
                Across::Number(k) => self.numbers[*k].as_str(),
                Across::Speed => "speed",
                Across::Cost => "cost",
            };
            json!({ "key": axis.key(first), "name": what, "x": x(k), "domain": scale.domain, "range": scale.range })
        };
        let axes: Vec<Value> = axes.iter().zip(&scales).enumerate().map(axis).collect();
        Some(Figure { data: Some(json!({ "axes": axes })), ..Figure::drawing(&name, &title, scene, caption) })
    }

    /// Both criteria of all optima of a gait at a speed, and those that no other beats in both.
    fn fronts(&self, group: &[&Spot], drawn: &Drawn) -> Option<Figure> {
        let first = group.first()?;
        let title = format!("{} at {} m/s", spaced(&first.gait), given(first.speed));
        let mut plot = Plot::new(title, Axis::new("torque", Criterion::Torque.unit()), Axis::new("energy", "N"));
        let better = front(group, both);
        if better.len() < 2 {
            return None;
        }
        for criterion in Criterion::ALL {
            let spots = group.iter().copied().filter(|spot| spot.criterion == criterion);
            let ink = Ink::gait(1 + usize::from(criterion == Criterion::Torque));
            plot.curves.push(drawn.scattered(format!("least {}", criterion.name()), ink, spots, both));
        }
        plot.curves.retain(|curve| !curve.segments.is_empty());
        plot.curves.push(Curve::new("front", Ink::Text, vec![better.into_iter().map(|(_, at)| at).collect()]));
        let name = format!("front-{}-{}", first.gait.replace('/', "-"), digits(first.speed));
        let caption = "Both criteria of every optimum. Front: no other is better in both.";
        Some(Figure { data: None, ..Figure::plot(&name, &plot, caption) })
    }

    /// Costs over a varied number, and those that no other beats with as little of it.
    fn over(&self, k: usize, group: &[&Spot], drawn: &Drawn) -> Option<Figure> {
        let (first, name) = (group.first()?, self.numbers.get(k)?);
        let at = |spot: &Spot| Some([*spot.numbers.get(k)?, spot.cost()?]);
        let mut spots = group.iter().filter_map(|spot| at(spot));
        let [one, _] = spots.next()?;
        if spots.all(|[x, _]| x == one) {
            return None;
        }
        let title = format!("{}, least {}: {name}", spaced(&first.gait), first.criterion.name());
        let mut plot = Plot::new(title, Axis::new("", ""), Axis::new("", first.criterion.unit()));
        plot.curves.push(drawn.scattered("a robot each".into(), Ink::gait(0), group.iter().copied(), at));
        let better = front(group, at).into_iter().map(|(_, at)| at).collect();
        plot.curves.push(Curve::new("front", Ink::Text, vec![better]));
        let [gait, number] = [&first.gait, name].map(|text| text.replace(['/', '{', '}', ','], "-"));
        let file = format!("cost-{gait}-{}-{}-{number}", first.criterion.name(), digits(first.speed));
        let caption = format!(
            "Cost at {} m/s over {name}. Front: no other robot costs less with as little of it.",
            given(first.speed)
        );
        Some(Figure { data: None, ..Figure::plot(&file, &plot, caption) })
    }
}

/// Torque and energy criterion.
fn both(spot: &Spot) -> Option<Xy> {
    spot.costs.map(|costs| [costs.torque, costs.energy])
}

/// Which answers are drawn.
struct Drawn {
    /// One robot in so many.
    every: usize,
    /// Of their points the numbers that they have on the page.
    numbers: BTreeMap<usize, usize>,
}

impl Drawn {
    /// Dots that are not connected.
    fn scattered<'a>(
        &self,
        name: String,
        ink: Ink,
        spots: impl Iterator<Item = &'a Spot>,
        of: impl Fn(&Spot) -> Option<Xy>,
    ) -> Curve {
        let place = |spot: &Spot| Some((*self.numbers.get(&spot.point)?, vec![of(spot)?]));
        let (numbers, segments) = spots.filter_map(place).unzip();
        Curve { dots: true, numbers, ..Curve::new(name, ink, segments) }
    }
}

/// The spots that no other beats in both of two things of which less is better, by the first of these.
fn front<'a>(group: &[&'a Spot], of: impl Fn(&Spot) -> Option<Xy>) -> Vec<(&'a Spot, Xy)> {
    let mut all: Vec<(&Spot, Xy)> = group.iter().filter_map(|spot| Some((*spot, of(spot)?))).collect();
    all.sort_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut least = f64::INFINITY;
    all.retain(|(_, [_, y])| {
        let better = *y < least;
        least = least.min(*y);
        better
    });
    all
}

#[cfg(test)]
mod tests {
    use super::{Space, Spot, both, front};
    use piaffe_model::motion::{Costs, Criterion};

    fn spot(point: usize, [torque, energy]: [f64; 2]) -> Spot {
        let costs = (torque > 0.0).then_some(Costs { energy, torque });
        let (gait, criterion) = ("trot".into(), Criterion::Energy);
        let status = "optimal".into();
        Spot { point, design: point, numbers: vec![point as f64], gait, criterion, speed: 0.6, costs, status }
    }

    /// Against the definition, pair by pair.
    #[test]
    fn a_front_has_what_nothing_beats() {
        // All over a band that falls.
        let share = |k: usize, step: f64| ((k + 1) as f64 * step).fract();
        let place = |k: usize| [0.01 + share(k, 0.618), 0.01 + (1.0 - share(k, 0.618)).powi(2) + 0.3 * share(k, 1.414)];
        let spots: Vec<Spot> = (0..200).map(|k| spot(k, place(k))).collect();
        let all: Vec<&Spot> = spots.iter().collect();
        let found: Vec<usize> = front(&all, both).into_iter().map(|(spot, _)| spot.point).collect();
        let beats = |a: &Spot, b: &Spot| {
            let ([ax, ay], [bx, by]) = (both(a).unwrap(), both(b).unwrap());
            ax <= bx && ay <= by && (ax, ay) != (bx, by)
        };
        let mut expected: Vec<&Spot> = all.iter().copied().filter(|b| !all.iter().any(|a| beats(a, b))).collect();
        expected.sort_by(|a, b| both(a).unwrap()[0].total_cmp(&both(b).unwrap()[0]));
        assert_eq!(found, expected.iter().map(|spot| spot.point).collect::<Vec<_>>());
        assert!(found.len() > 3);
    }

    #[test]
    fn what_has_no_optimum_is_neither_shown_nor_drawn() {
        let spots = vec![spot(0, [0.0, 0.0]), spot(1, [2.0, 3.0]), spot(2, [3.0, 2.0]), spot(3, [4.0, 4.0])];
        let space = Space { robot: "dog".into(), numbers: vec!["links.leg.mass".into()], spots };
        assert_eq!(space.worth_showing(), [2, 1], "the best in energy, then the rest of the front");
        let names: Vec<String> = space.figures().into_iter().map(|figure| figure.name).collect();
        assert_eq!(names, ["parallel-trot-energy", "front-trot-0.6", "cost-trot-energy-0.6-links.leg.mass"]);
        let nothing = Space { spots: vec![spot(0, [0.0, 0.0])], ..space };
        assert!(nothing.figures().is_empty() && nothing.worth_showing().is_empty());
    }
}
