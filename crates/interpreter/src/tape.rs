//! A kernel as a list of sums of products of numbered cells, and what runs it.
//!
//! The sums are those of the generated code, in its order (`piaffe_codegen::program::Step`), with its products in their order: the
//! results have the same bits. Every product has four factors, some of which may be one: so there is nothing to decide within a sum, and
//! a processor that cannot foresee decisions does not have to.

use piaffe_codegen::dynamics::Kernel;
use piaffe_codegen::math;
use piaffe_codegen::program::{Id, Node, Program, Step, Term, terms};
use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::collections::{BTreeMap, btree_map};
use std::sync::Arc;

/// A cell: constants come first, then inputs, then what is computed. Every such number is one of a place in [`Cells`].
type Cell = u16;

/// As many as a [`Cell`] can tell apart, so that none is out of bounds.
type Cells = [f64; 1 << 16];

/// Factors of a product.
const FACTORS: usize = 4;

/// What becomes of a sum, and in which cell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum End {
    Value(Cell),
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
    /// Of all sums, one after another.
    products: Arc<[[Cell; FACTORS]]>,
    /// How many products each has, and its end.
    sums: Arc<[(u16, End)]>,
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
                run(&self.sums, &self.products, cells);
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

fn run(sums: &[(u16, End)], mut products: &[[Cell; FACTORS]], cells: &mut Cells) {
    for (count, end) in sums {
        let Some((own, rest)) = products.split_at_checked(usize::from(*count)) else { return };
        products = rest;
        // To add something to −0 changes nothing of it, not even its sign.
        let mut sum = -0.0;
        for factors in own {
            let [a, b, c, d] = factors.map(|cell| cells[usize::from(cell)]);
            sum += a * b * c * d;
        }
        match *end {
            End::Value(cell) => cells[usize::from(cell)] = sum,
            End::Reciprocal(cell) => cells[usize::from(cell)] = 1.0 / sum,
            End::Sine(sin, cos) => (cells[usize::from(sin)], cells[usize::from(cos)]) = math::sin_cos(sum),
        }
    }
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
    products: Vec<[Cell; FACTORS]>,
    sums: Vec<(u16, End)>,
}

impl<'a> Writer<'a> {
    fn new(kernel: &'a Kernel, program: &'a Program) -> Result<Writer<'a>, Unrunnable> {
        let inputs: Vec<usize> = kernel.inputs.iter().map(|input| input.symbols.len()).collect();
        let nodes = vec![0; program.nodes.len()];
        let (constants, places, products, sums) = (Vec::new(), BTreeMap::new(), Vec::new(), Vec::new());
        let mut writer = Writer { kernel, program, constants, places, inputs, nodes, next: 0, products, sums };
        writer.number_constants()?;
        writer.number_inputs()?;
        Ok(writer)
    }

    fn number_constants(&mut self) -> Result<(), Unrunnable> {
        for term in self.program.sums.iter().flat_map(terms) {
            if let Some(number) = number(term) {
                self.constant(number)?;
            }
        }
        self.constant(0.0)?;
        self.constant(1.0).map(|_| ())
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
        let cell = Cell::try_from(self.next).map_err(|_| self.too_large())?;
        self.next += 1;
        Ok(cell)
    }

    fn written(mut self) -> Result<Tape, Unrunnable> {
        for step in self.program.steps() {
            match step {
                Step::Value(id, sum) => {
                    let count = self.sum(sum)?;
                    let cell = self.node(id)?;
                    self.sums.push((count, End::Value(cell)));
                }
                Step::Reciprocal(id, sum) => {
                    let count = self.sum(sum)?;
                    let cell = self.node(id)?;
                    self.sums.push((count, End::Reciprocal(cell)));
                }
                Step::Sines(sines) => {
                    for sine in sines {
                        let count = self.sum(sine.argument)?;
                        let [sin, cos] = [self.node_or_none(sine.sin)?, self.node_or_none(sine.cos)?];
                        self.sums.push((count, End::Sine(sin, cos)));
                    }
                }
            }
        }
        let outputs = self.outputs()?;
        let (products, sums) = (self.products.into(), self.sums.into());
        Ok(Tape { constants: self.constants, inputs: self.inputs, products, sums, outputs: outputs.into() })
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
                    let count = self.sum(*sum)?;
                    let cell = self.cell()?;
                    self.sums.push((count, End::Value(cell)));
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

    /// The products of a sum, and how many they are.
    fn sum(&mut self, sum: usize) -> Result<u16, Unrunnable> {
        let program = self.program;
        let mut own = Vec::with_capacity(program.sums[sum].len().max(1));
        for term in terms(&program.sums[sum]) {
            own.push(self.product(term)?);
        }
        if own.is_empty() {
            let zero = self.constant(0.0)?;
            own.push(self.padded(&[zero])?);
        }
        self.products.extend(&own);
        u16::try_from(own.len()).map_err(|_| self.too_large())
    }

    /// The factors of a term. Of more than there is room for, the first make a sum of their own.
    fn product(&mut self, term: &Term) -> Result<[Cell; FACTORS], Unrunnable> {
        let mut cells = Vec::with_capacity(term.factors.len() + 1);
        if let Some(number) = number(term) {
            cells.push(self.constant(number)?);
        }
        cells.extend(term.factors.iter().map(|id| self.nodes[*id as usize]));
        while cells.len() > FACTORS {
            let rest = cells.split_off(FACTORS);
            let first = self.padded(&cells)?;
            self.products.push(first);
            let cell = self.cell()?;
            self.sums.push((1, End::Value(cell)));
            cells = [&[cell], &*rest].concat();
        }
        self.padded(&cells)
    }

    fn padded(&mut self, cells: &[Cell]) -> Result<[Cell; FACTORS], Unrunnable> {
        let mut factors = [self.constant(1.0)?; FACTORS];
        factors.iter_mut().zip(cells).for_each(|(factor, cell)| *factor = *cell);
        Ok(factors)
    }

    fn too_large(&self) -> Unrunnable {
        Unrunnable::TooLarge { kernel: self.kernel.name.clone() }
    }
}

/// The number that a term's product begins with, with its sign.
fn number(term: &Term) -> Option<f64> {
    (term.coefficient != 1.0 || term.factors.is_empty()).then_some(term.coefficient)
}
