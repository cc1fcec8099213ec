//! A kernel as a list of simple operations on numbered cells, and what runs it.
//!
//! The operations are those of the generated code, in its order (`piaffe_codegen::program::Step`): the results have the same bits.
//! A sum is built up in one number and put into its cell; products of three are one operation, which is most of what kernels are.

use piaffe_codegen::dynamics::Kernel;
use piaffe_codegen::program::{Id, Node, Program, Step, Term, math, terms};
use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::collections::{BTreeMap, btree_map};
use std::sync::Arc;

/// A cell: constants come first, then inputs, then what is computed. Every such number is one of a place in [`Cells`].
type Cell = u16;

/// As many as a [`Cell`] can tell apart, so that none is out of bounds.
type Cells = [f64; 1 << 16];

/// Works on a sum, a product and cells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Operation {
    /// The sum begins with a cell, or with a product of cells.
    Set(Cell),
    Set2(Cell, Cell),
    Set3(Cell, Cell, Cell),
    Add(Cell),
    Add2(Cell, Cell),
    Add3(Cell, Cell, Cell),
    Subtract(Cell),
    Subtract2(Cell, Cell),
    Subtract3(Cell, Cell, Cell),
    /// A longer product begins, and goes on.
    Multiply3(Cell, Cell, Cell),
    Times(Cell),
    /// Its last factor, and what becomes of it.
    SetTimes(Cell),
    AddTimes(Cell),
    SubtractTimes(Cell),
    Negate,
    /// The sum is known.
    Store(Cell),
    Reciprocal(Cell),
    /// Its sine and cosine.
    Sine(Cell, Cell),
}

/// A kernel that can be evaluated.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Tape {
    constants: Vec<f64>,
    /// Length of each input.
    inputs: Vec<usize>,
    operations: Arc<[Operation]>,
    outputs: Arc<[Cell]>,
}

/// Why a kernel has no tape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unrunnable {
    #[error("the kernel `{kernel}` has the number {number}")]
    NotFinite { kernel: String, number: f64 },
    #[error("the kernel `{kernel}` is too large to be evaluated as it stands; build it")]
    TooLarge { kernel: String },
    #[error("a gait cannot hold `{joint}` still: it is tilted")]
    Tilted { joint: String },
}

thread_local! {
    /// Every thread's own; what is not used of them is never touched.
    static CELLS: RefCell<Box<Cells>> = RefCell::new(zeros());
}

fn zeros() -> Box<Cells> {
    // On the heap from the beginning: they are too many for some threads' stacks.
    match vec![0.0; 1 << 16].into_boxed_slice().try_into() {
        Ok(cells) => cells,
        Err(_) => Box::new([0.0; 1 << 16]),
    }
}

impl Tape {
    /// # Errors
    /// If the kernel has more values than there are cells, or a number that is none.
    pub fn new(kernel: &Kernel, program: &Program) -> Result<Tape, Unrunnable> {
        Writer::new(kernel, program)?.written()
    }

    /// The outputs one after another; not numbers if an input is too short.
    pub fn evaluate(&self, inputs: &[&[f64]], out: &mut [f64]) {
        CELLS.with_borrow_mut(|cells| match self.load(inputs, cells) {
            Some(()) => {
                run(&self.operations, cells);
                out.iter_mut().zip(self.outputs.iter()).for_each(|(out, cell)| *out = cells[usize::from(*cell)]);
            }
            None => out.fill(f64::NAN),
        });
    }

    /// The tape that has these numbers for its first input: one more of its constants, behind which that input stands.
    pub fn with(&self, first: &[f64]) -> Tape {
        let mut tape = self.clone();
        tape.constants.extend(first);
        tape.inputs.remove(0);
        tape
    }

    /// How many numbers it gives.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    fn load(&self, inputs: &[&[f64]], cells: &mut Cells) -> Option<()> {
        let (constants, mut rest) = cells.split_at_mut_checked(self.constants.len())?;
        constants.copy_from_slice(&self.constants);
        for (input, length) in inputs.iter().zip(&self.inputs) {
            let (head, tail) = rest.split_at_mut_checked(*length)?;
            head.copy_from_slice(input.get(..*length)?);
            rest = tail;
        }
        Some(())
    }
}

fn run(operations: &[Operation], cells: &mut Cells) {
    let (mut sum, mut product) = (0.0, 0.0);
    macro_rules! cell {
        ($cell:ident) => {
            cells[usize::from($cell)]
        };
    }
    for operation in operations {
        match *operation {
            Operation::Set(a) => sum = cell!(a),
            Operation::Set2(a, b) => sum = cell!(a) * cell!(b),
            Operation::Set3(a, b, c) => sum = cell!(a) * cell!(b) * cell!(c),
            Operation::Add(a) => sum += cell!(a),
            Operation::Add2(a, b) => sum += cell!(a) * cell!(b),
            Operation::Add3(a, b, c) => sum += cell!(a) * cell!(b) * cell!(c),
            Operation::Subtract(a) => sum -= cell!(a),
            Operation::Subtract2(a, b) => sum -= cell!(a) * cell!(b),
            Operation::Subtract3(a, b, c) => sum -= cell!(a) * cell!(b) * cell!(c),
            Operation::Multiply3(a, b, c) => product = cell!(a) * cell!(b) * cell!(c),
            Operation::Times(a) => product *= cell!(a),
            Operation::SetTimes(a) => sum = product * cell!(a),
            Operation::AddTimes(a) => sum += product * cell!(a),
            Operation::SubtractTimes(a) => sum -= product * cell!(a),
            Operation::Negate => sum = -sum,
            Operation::Store(a) => cell!(a) = sum,
            Operation::Reciprocal(a) => cell!(a) = 1.0 / sum,
            Operation::Sine(sin, cos) => (cell!(sin), cell!(cos)) = math::sin_cos(sum),
        }
    }
}

/// Where a term stands in its sum.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    First,
    Added,
    Subtracted,
}

/// Writes the tape of a kernel.
struct Writer<'a> {
    kernel: &'a Kernel,
    program: &'a Program,
    constants: Vec<f64>,
    /// Where constants are, by their bits.
    places: BTreeMap<u64, Cell>,
    inputs: Vec<usize>,
    /// Of each node, once it is known.
    nodes: Vec<Cell>,
    next: usize,
    operations: Vec<Operation>,
}

impl<'a> Writer<'a> {
    fn new(kernel: &'a Kernel, program: &'a Program) -> Result<Writer<'a>, Unrunnable> {
        let inputs: Vec<usize> = kernel.inputs.iter().map(|input| input.symbols.len()).collect();
        let nodes = vec![0; program.nodes.len()];
        let (constants, places, operations) = (Vec::new(), BTreeMap::new(), Vec::new());
        let mut writer = Writer { kernel, program, constants, places, inputs, nodes, next: 0, operations };
        writer.number_constants()?;
        writer.number_inputs()?;
        Ok(writer)
    }

    fn number_constants(&mut self) -> Result<(), Unrunnable> {
        for sum in &self.program.sums {
            for (k, term) in terms(sum).enumerate() {
                if let Some(number) = number(term, k == 0) {
                    self.constant(number)?;
                }
            }
        }
        self.constant(0.0).map(|_| ())
    }

    fn constant(&mut self, number: f64) -> Result<Cell, Unrunnable> {
        if !number.is_finite() {
            return Err(Unrunnable::NotFinite { kernel: self.kernel.name.clone(), number });
        }
        match self.places.entry(number.to_bits()) {
            btree_map::Entry::Occupied(known) => Ok(*known.get()),
            btree_map::Entry::Vacant(_) => {
                let cell = self.cell()?;
                self.places.insert(number.to_bits(), cell);
                self.constants.push(number);
                Ok(cell)
            }
        }
    }

    fn number_inputs(&mut self) -> Result<(), Unrunnable> {
        let mut first = Vec::with_capacity(self.inputs.len());
        for length in self.inputs.clone() {
            first.push(self.next);
            for _ in 0..length {
                self.cell()?;
            }
        }
        for (id, node) in self.program.nodes.iter().enumerate() {
            if let Node::Input(input, element) = node {
                // All of these cells have been taken: they can be told apart.
                self.nodes[id] = (first[*input] + element) as Cell;
            }
        }
        Ok(())
    }

    /// One that nothing else is in.
    fn cell(&mut self) -> Result<Cell, Unrunnable> {
        let cell = Cell::try_from(self.next).map_err(|_| Unrunnable::TooLarge { kernel: self.kernel.name.clone() })?;
        self.next += 1;
        Ok(cell)
    }

    fn written(mut self) -> Result<Tape, Unrunnable> {
        for step in self.program.steps() {
            match step {
                Step::Value(id, sum) => {
                    self.sum(sum)?;
                    let cell = self.node(id)?;
                    self.operations.push(Operation::Store(cell));
                }
                Step::Reciprocal(id, sum) => {
                    self.sum(sum)?;
                    let cell = self.node(id)?;
                    self.operations.push(Operation::Reciprocal(cell));
                }
                Step::Sines(sines) => {
                    for sine in sines {
                        self.sum(sine.argument)?;
                        let [sin, cos] = [self.node_or_none(sine.sin)?, self.node_or_none(sine.cos)?];
                        self.operations.push(Operation::Sine(sin, cos));
                    }
                }
            }
        }
        let outputs = self.outputs()?;
        let (constants, operations) = (self.constants, self.operations.into());
        Ok(Tape { constants, inputs: self.inputs, operations, outputs: outputs.into() })
    }

    fn node(&mut self, id: Id) -> Result<Cell, Unrunnable> {
        let cell = self.cell()?;
        self.nodes[id as usize] = cell;
        Ok(cell)
    }

    /// What nothing needs has a cell too.
    fn node_or_none(&mut self, id: Option<Id>) -> Result<Cell, Unrunnable> {
        match id {
            Some(id) => self.node(id),
            None => self.cell(),
        }
    }

    /// Cells of the outputs, each sum of which is computed once.
    fn outputs(&mut self) -> Result<Vec<Cell>, Unrunnable> {
        let mut known: BTreeMap<usize, Cell> = BTreeMap::new();
        let mut outputs = Vec::new();
        for sum in self.program.outputs.iter().flatten() {
            let cell = match (known.get(sum), self.alone(*sum)) {
                (Some(cell), _) => *cell,
                (None, Some(node)) => node,
                (None, None) => {
                    self.sum(*sum)?;
                    let cell = self.cell()?;
                    self.operations.push(Operation::Store(cell));
                    cell
                }
            };
            known.insert(*sum, cell);
            outputs.push(cell);
        }
        Ok(outputs)
    }

    /// The cell of a sum that is a node and nothing else.
    fn alone(&self, sum: usize) -> Option<Cell> {
        match self.program.sums[sum].as_slice() {
            [Term { coefficient: 1.0, factors }] if factors.len() == 1 => Some(self.nodes[factors[0] as usize]),
            _ => None,
        }
    }

    /// Operations that make a sum.
    fn sum(&mut self, sum: usize) -> Result<(), Unrunnable> {
        let program = self.program;
        for (k, term) in terms(&program.sums[sum]).enumerate() {
            let place = match k {
                0 => Place::First,
                _ if term.coefficient < 0.0 => Place::Subtracted,
                _ => Place::Added,
            };
            self.term(term, place)?;
        }
        if program.sums[sum].is_empty() {
            let zero = self.constant(0.0)?;
            self.operations.push(Operation::Set(zero));
        }
        Ok(())
    }

    fn term(&mut self, term: &Term, place: Place) -> Result<(), Unrunnable> {
        let number = number(term, place == Place::First);
        let mut cells = Vec::with_capacity(term.factors.len() + 1);
        if let Some(number) = number {
            cells.push(self.constant(number)?);
        }
        cells.extend(term.factors.iter().map(|id| self.nodes[*id as usize]));
        use Operation::*;
        use Place::*;
        self.operations.extend(match (cells.as_slice(), place) {
            (&[a], First) => vec![Set(a)],
            (&[a], Added) => vec![Add(a)],
            (&[a], Subtracted) => vec![Subtract(a)],
            (&[a, b], First) => vec![Set2(a, b)],
            (&[a, b], Added) => vec![Add2(a, b)],
            (&[a, b], Subtracted) => vec![Subtract2(a, b)],
            (&[a, b, c], First) => vec![Set3(a, b, c)],
            (&[a, b, c], Added) => vec![Add3(a, b, c)],
            (&[a, b, c], Subtracted) => vec![Subtract3(a, b, c)],
            (&[a, b, c, ref middle @ .., last], place) => {
                let mut list = vec![Multiply3(a, b, c)];
                list.extend(middle.iter().map(|cell| Times(*cell)));
                list.push(match place {
                    First => SetTimes(last),
                    Added => AddTimes(last),
                    Subtracted => SubtractTimes(last),
                });
                list
            }
            (&[], _) => Vec::new(),
        });
        if place == First && term.coefficient < 0.0 && number.is_none() {
            self.operations.push(Negate);
        }
        Ok(())
    }
}

/// The number that a term's product begins with; of a sum's first term with its sign.
fn number(term: &Term, first: bool) -> Option<f64> {
    let number = term.number()?;
    Some(if first && term.coefficient < 0.0 { -number } else { number })
}
