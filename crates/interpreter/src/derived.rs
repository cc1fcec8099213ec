//! What is derived of a mechanism: all that takes long, and nothing that does not.

use super::kept::{kept, text};
use super::shapes::Shapes;
use super::store::stored;
use super::tape::{Tape, Unrunnable};
use super::twins::{Tapes, tapes};
use piaffe_codegen::dynamics::{Kernel, family_kernels, kernels, lowest, whole_kernels};
use piaffe_codegen::mechanism::{self, Mechanism};
use piaffe_codegen::program::{Operations as Count, Program, programs};
use piaffe_model::Operations;
use serde::{Deserialize, Serialize};

/// Of a gait, of one robot or of a family.
#[derive(Serialize, Deserialize)]
pub struct Derived {
    /// Which of the mechanism's points can be the lowest.
    pub lowest: Vec<usize>,
    pub shapes: Shapes,
    operations: Vec<Counted>,
    pub tapes: Tapes,
}

/// What a kernel costs.
#[derive(Serialize, Deserialize)]
struct Counted {
    kernel: String,
    flops: usize,
    divisions: usize,
    sincos: usize,
    derived: usize,
}

impl Derived {
    /// Of a mechanism with its numbers folded in. Limits have no part in it.
    ///
    /// # Errors
    /// If the numbers make some that are none, or a kernel is too large.
    pub fn of(mechanism: &Mechanism) -> Result<Derived, Unrunnable> {
        let mechanism = mechanism.unlimited();
        stored(&format!("{mechanism:?}"), || {
            let (mut model, derived) = kernels(&mechanism);
            let lowest = lowest(&mut model);
            Derived::new(lowest, &derived, &programs(&model.ring, &derived))
        })
    }

    /// Of a family whose mechanism has no limits; with what makes of its parameters what the kernels need of them.
    ///
    /// # Errors
    /// As for one robot.
    pub fn of_family(family: &mechanism::Family) -> Result<(Derived, Tape), Unrunnable> {
        stored(&format!("{family:?}"), || {
            let (mut model, derived) = family_kernels(family);
            let lowest = lowest(&mut model);
            let lumps = Tape::new(&derived.lumps, &Program::new(&model.ring, &derived.lumps))?;
            Ok((Derived::new(lowest, &derived.gait, &programs(&model.ring, &derived.gait))?, lumps))
        })
    }

    fn new(lowest: Vec<usize>, kernels: &[Kernel], programs: &[(Program, Count)]) -> Result<Derived, Unrunnable> {
        Ok(Derived {
            lowest,
            shapes: Shapes::new(kernels),
            operations: kernels.iter().zip(programs).map(Counted::new).collect(),
            tapes: tapes(kernels, programs.iter().map(|(program, _)| program))?,
        })
    }

    /// There is no source: it has no length.
    pub fn operations(&self) -> &'static [Operations] {
        let of = |&Counted { ref kernel, flops, divisions, sincos, derived }: &Counted| Operations {
            kernel: text(kernel),
            flops,
            divisions,
            sincos,
            derived,
            bytes: 0,
        };
        kept(self.operations.iter().map(of).collect())
    }
}

impl Counted {
    fn new((kernel, (program, derived)): (&Kernel, &(Program, Count))) -> Counted {
        let Count { flops, divisions, sincos } = program.operations();
        Counted { kernel: kernel.name.clone(), flops, divisions, sincos, derived: derived.flops }
    }
}

/// Of a whole robot.
#[derive(Serialize, Deserialize)]
pub struct DerivedWhole {
    pub shapes: Shapes,
    pub tapes: Tapes,
}

impl DerivedWhole {
    /// As it was derived before, if it was.
    ///
    /// # Errors
    /// If the numbers make some that are none, or a kernel is too large.
    pub fn of(whole: &mechanism::Whole) -> Result<DerivedWhole, Unrunnable> {
        stored(&format!("{whole:?}"), || DerivedWhole::derive(whole))
    }

    /// # Errors
    /// As for [`DerivedWhole::of`].
    pub fn derive(whole: &mechanism::Whole) -> Result<DerivedWhole, Unrunnable> {
        let (ring, kernels) = whole_kernels(whole);
        // On one thread: whoever asks first may be one of many, all of whom wait for this.
        let programs: Vec<Program> = kernels.iter().map(|kernel| Program::new(&ring, kernel)).collect();
        Ok(DerivedWhole { shapes: Shapes::new(&kernels), tapes: tapes(&kernels, &programs)? })
    }
}
