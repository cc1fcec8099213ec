//! The table that rows make: which columns a study has, of what kind, and what a row has there.

use crate::row::{Beyond, Optimum, Row};
use crate::study::Study;

/// A column of a study's table. Every row has every one of them.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    Point,
    Design,
    /// A varied number: which one, its name.
    Number(usize, String),
    Gait,
    Criterion,
    Speed,
    Status,
    Reason,
    Conflict,
    Cost,
    Energy,
    Torque,
    VirtualCost,
    /// Of a phase, from 0.
    Duration(usize),
    StepLength,
    Violation,
    CycleError,
    KktResidual,
    LeastMargin,
    LeastLimit,
    Active,
    Starts,
    Successes,
    Optima,
    Certificate,
    SlopeInSpeed,
    /// In a varied number: which one, its name.
    Slope(usize, String),
    PushByClock,
    PushByPhase,
}

/// What stands in a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// From 0 up.
    Integer,
    /// Finite.
    Number,
    Text,
}

/// What a row has in a column; nothing where there is nothing to tell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    Integer(Option<u64>),
    Number(Option<f64>),
    Text(Option<String>),
}

impl Cell {
    pub fn is_there(&self) -> bool {
        match self {
            Cell::Integer(integer) => integer.is_some(),
            Cell::Number(number) => number.is_some(),
            Cell::Text(text) => text.is_some(),
        }
    }

    pub fn integer(&self) -> Option<u64> {
        if let Cell::Integer(integer) = self { *integer } else { None }
    }

    pub fn number(&self) -> Option<f64> {
        if let Cell::Number(number) = self { *number } else { None }
    }

    pub fn text(&self) -> Option<&str> {
        if let Cell::Text(text) = self { text.as_deref() } else { None }
    }
}

/// Between entries of a list in a cell.
const BETWEEN: &str = "; ";

impl Column {
    /// Those of a study, in their order.
    pub fn all(study: &Study) -> Vec<Column> {
        use Column::*;
        let names = || study.designs.names().iter().cloned().enumerate();
        let asked = |beyond: Beyond| study.beyond.contains(&beyond);
        let mut columns = vec![Point, Design];
        columns.extend(names().map(|(k, name)| Number(k, name)));
        columns.extend([Gait, Criterion, Speed, Status, Reason, Conflict, Cost, Energy, Torque]);
        columns.extend(study.real_legs.then_some(VirtualCost));
        columns.extend((0..study.phases()).map(Duration));
        columns.extend([StepLength, Violation, CycleError, KktResidual, LeastMargin, LeastLimit, Active]);
        columns.extend([Starts, Successes, Optima]);
        columns.extend(asked(Beyond::Certificate).then_some(Certificate));
        if asked(Beyond::Slopes) {
            columns.push(SlopeInSpeed);
            columns.extend(names().map(|(k, name)| Slope(k, name)));
        }
        if asked(Beyond::Stability) {
            columns.extend([PushByClock, PushByPhase]);
        }
        columns
    }

    /// Its name in the table's first line. Varied numbers are called as in the specification.
    pub fn name(&self) -> String {
        use Column::*;
        match self {
            Point => "point".into(),
            Design => "design".into(),
            Number(_, name) => name.clone(),
            Gait => "gait".into(),
            Criterion => "criterion".into(),
            Speed => "speed".into(),
            Status => "status".into(),
            Reason => "reason".into(),
            Conflict => "conflict".into(),
            Cost => "cost".into(),
            Energy => "energy".into(),
            Torque => "torque".into(),
            VirtualCost => "virtual_cost".into(),
            Duration(phase) => format!("duration.{}", phase + 1),
            StepLength => "step_length".into(),
            Violation => "max_violation".into(),
            CycleError => "cycle_error".into(),
            KktResidual => "kkt_residual".into(),
            LeastMargin => "least_margin".into(),
            LeastLimit => "least_limit".into(),
            Active => "active".into(),
            Starts => "starts".into(),
            Successes => "successes".into(),
            Optima => "optima".into(),
            Certificate => "certificate".into(),
            SlopeInSpeed => "slope.speed".into(),
            Slope(_, name) => format!("slope.{name}"),
            PushByClock => "push.by_clock".into(),
            PushByPhase => "push.by_phase".into(),
        }
    }

    pub fn kind(&self) -> Kind {
        use Column::*;
        match self {
            Point | Design | Starts | Successes | Optima => Kind::Integer,
            Gait | Criterion | Status | Reason | Conflict | LeastLimit | Active | Certificate => Kind::Text,
            Number(..) | Speed | Cost | Energy | Torque | VirtualCost | Duration(_) | StepLength | Violation
            | CycleError | KktResidual | LeastMargin | SlopeInSpeed | Slope(..) | PushByClock | PushByPhase => {
                Kind::Number
            }
        }
    }

    /// What a row has here.
    pub fn of(&self, row: &Row) -> Cell {
        use Column::*;
        let optimum = row.optimum.as_ref();
        let integer = |of: fn(&Optimum) -> usize| Cell::Integer(optimum.map(|optimum| of(optimum) as u64));
        let number = |of: &dyn Fn(&Optimum) -> Option<f64>| Cell::Number(optimum.and_then(of));
        let text = |text: &str| Cell::Text(Some(text.into()));
        let list = |list: &[String]| Cell::Text((!list.is_empty()).then(|| list.join(BETWEEN)));
        match self {
            Point => Cell::Integer(Some(row.point as u64)),
            Design => Cell::Integer(Some(row.design as u64)),
            Number(k, _) => Cell::Number(row.numbers.get(*k).copied()),
            Gait => text(&row.gait),
            Criterion => text(row.criterion.name()),
            Speed => Cell::Number(Some(row.speed)),
            Status => text(row.status.name()),
            Reason => Cell::Text(row.reason.clone()),
            Conflict => list(&row.conflict),
            Cost => Cell::Number(row.cost()),
            Energy => number(&|o| Some(o.costs.energy)),
            Torque => number(&|o| Some(o.costs.torque)),
            VirtualCost => number(&|o| o.virtual_cost),
            Duration(phase) => number(&|o| o.durations.get(*phase).copied()),
            StepLength => number(&|o| Some(o.step_length)),
            Violation => number(&|o| Some(o.violation)),
            CycleError => number(&|o| Some(o.cycle_error)),
            KktResidual => number(&|o| Some(o.kkt_residual)),
            LeastMargin => number(&|o| Some(o.least.as_ref()?.margin)),
            LeastLimit => Cell::Text(optimum.and_then(|o| Some(o.least.as_ref()?.constraint.clone()))),
            Active => list(optimum.map_or(&[], |o| &o.active)),
            Starts => integer(|o| o.starts),
            Successes => integer(|o| o.successes),
            Optima => integer(|o| o.optima),
            Certificate => Cell::Text(optimum.and_then(|o| Some(o.certificate?.name().into()))),
            SlopeInSpeed => number(&|o| Some(o.slopes.as_ref()?.speed)),
            Slope(k, _) => number(&|o| o.slopes.as_ref()?.numbers.get(*k).copied().flatten()),
            PushByClock => number(&|o| o.stability?.by_clock),
            PushByPhase => number(&|o| o.stability?.by_phase),
        }
    }
}
