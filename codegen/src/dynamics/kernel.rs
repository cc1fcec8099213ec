//! A kernel: inputs, outputs, and what they mean.

use crate::expr::{Poly, Var};
use crate::mechanism::{Mechanism, Mode, Transition};

/// A group of expressions evaluated together; becomes one generated function.
#[derive(Clone, Debug)]
pub struct Kernel {
    /// What it computes, whichever mode or leg it is of: trait methods are called like this.
    pub what: String,
    /// The same of its mode or leg: the generated function is called like this.
    pub name: String,
    /// What it computes, with equation numbers, units and frame.
    pub doc: String,
    pub inputs: Vec<Input>,
    pub outputs: Vec<Output>,
    /// Whether it is also wanted for many states at once.
    pub batched: bool,
    /// Whether its length is of interest though it gives one thing alone.
    pub measured: bool,
    pub of: Of,
}

/// What has a kernel of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// The robot, whatever stands.
    Robot,
    /// A leg (0 or 1), whatever stands.
    Leg(usize),
    Mode(Mode),
    Transition(Transition),
}

#[derive(Clone, Debug)]
pub struct Input {
    pub name: &'static str,
    pub symbols: Vec<Var>,
    /// A single number rather than an array.
    pub scalar: bool,
    /// What its numbers are, one after another, if they are of several kinds.
    pub blocks: Vec<Block>,
}

/// Numbers that belong together, in an input or among the outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    pub name: &'static str,
    pub shape: Shape,
}

#[derive(Clone, Debug)]
pub struct Output {
    pub name: &'static str,
    pub shape: Shape,
    /// Row-major.
    pub values: Vec<Poly>,
    pub doc: &'static str,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    Scalar,
    Vector(usize),
    Matrix(usize, usize),
}

impl Shape {
    /// How many rows and columns its numbers have.
    pub fn size(self) -> (usize, usize) {
        match self {
            Shape::Scalar => (1, 1),
            Shape::Vector(n) => (n, 1),
            Shape::Matrix(rows, columns) => (rows, columns),
        }
    }

    /// The indices of each of its numbers, in order.
    pub fn places(self) -> impl Iterator<Item = Vec<usize>> {
        let (rows, columns) = self.size();
        (0..rows * columns).map(move |k| match self {
            Shape::Scalar => Vec::new(),
            Shape::Vector(_) => vec![k],
            Shape::Matrix(..) => vec![k / columns, k % columns],
        })
    }
}

impl Block {
    pub fn scalar(name: &'static str) -> Block {
        Block { name, shape: Shape::Scalar }
    }

    pub fn vector(name: &'static str, length: usize) -> Block {
        Block { name, shape: Shape::Vector(length) }
    }

    /// How many numbers they are.
    pub fn count(&self) -> usize {
        let (rows, columns) = self.shape.size();
        rows * columns
    }

    /// How many numbers they are in all.
    pub fn total(blocks: &[Block]) -> usize {
        blocks.iter().map(Block::count).sum()
    }
}

impl Input {
    pub fn new(name: &'static str, symbols: Vec<Var>) -> Input {
        Input { name, symbols, scalar: false, blocks: Vec::new() }
    }

    pub fn of_blocks(name: &'static str, symbols: Vec<Var>, blocks: Vec<Block>) -> Input {
        Input { blocks, ..Input::new(name, symbols) }
    }

    pub fn shape(&self) -> Shape {
        if self.scalar { Shape::Scalar } else { Shape::Vector(self.symbols.len()) }
    }
}

impl Kernel {
    /// One of the whole robot, whatever stands.
    pub fn new(what: &str, doc: impl Into<String>) -> Kernel {
        Kernel::named(what, what.into(), Of::Robot, doc)
    }

    fn named(what: &str, name: String, of: Of, doc: impl Into<String>) -> Kernel {
        Kernel {
            what: what.into(),
            name,
            doc: doc.into(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            batched: false,
            measured: false,
            of,
        }
    }

    /// One of a leg, whatever stands.
    pub fn of_leg(leg: usize, what: &str, doc: impl Into<String>) -> Kernel {
        Kernel::named(what, format!("{what}{}", leg + 1), Of::Leg(leg), doc)
    }

    /// Pairs of terms in its sums, about: what the time to factor it goes by.
    pub fn pairs(&self) -> usize {
        self.outputs.iter().flat_map(|output| &output.values).map(|sum| sum.len() * sum.len()).sum()
    }

    /// One of the kernels of a mode: what it computes is called `what`.
    pub fn of_mode(mode: Mode, what: &str, doc: impl Into<String>) -> Kernel {
        Kernel::named(what, mode.kernel(what), Of::Mode(mode), doc)
    }

    /// One of the kernels of a transition; `what` as in [`Transition::kernel`].
    pub fn of_transition(transition: Transition, what: &str, doc: impl Into<String>) -> Kernel {
        Kernel::named(&transition.what(what), transition.kernel(what), Of::Transition(transition), doc)
    }

    /// The mode that it is of, if it is of one.
    pub fn mode(&self) -> Option<Mode> {
        if let Of::Mode(mode) = self.of { Some(mode) } else { None }
    }

    /// Whether a gait with these modes and transitions can need it.
    pub fn serves(&self, mechanism: &Mechanism) -> bool {
        match self.of {
            Of::Robot | Of::Leg(_) => true,
            Of::Mode(mode) => mechanism.modes.contains(&mode),
            Of::Transition(transition) => mechanism.transitions.contains(&transition),
        }
    }

    /// The leg (0 or 1) whose twin it is, if there are twins for the legs.
    pub fn leg(&self) -> Option<usize> {
        match self.of {
            Of::Robot | Of::Mode(Mode::Flight) => None,
            Of::Leg(leg) | Of::Mode(Mode::Stance(leg)) => Some(leg),
            Of::Transition(transition) => Some(transition.leg()),
        }
    }

    /// Whether somebody asks where what it gives or takes stands.
    pub fn has_shape(&self) -> bool {
        self.measured || self.outputs.len() > 1 || self.inputs.iter().any(|input| !input.blocks.is_empty())
    }

    pub fn measured(self) -> Kernel {
        Kernel { measured: true, ..self }
    }

    pub fn batched(self) -> Kernel {
        Kernel { batched: true, ..self }
    }

    pub fn input(mut self, name: &'static str, symbols: Vec<Var>) -> Kernel {
        self.inputs.push(Input::new(name, symbols));
        self
    }

    /// An input of several kinds of numbers, such as a weight for each of several results.
    pub fn blocks(mut self, name: &'static str, symbols: Vec<Var>, blocks: Vec<Block>) -> Kernel {
        self.inputs.push(Input::of_blocks(name, symbols, blocks));
        self
    }

    pub fn inputs(mut self, inputs: Vec<Input>) -> Kernel {
        self.inputs.extend(inputs);
        self
    }

    pub fn scalar_input(mut self, name: &'static str, symbol: Var) -> Kernel {
        self.inputs.push(Input { scalar: true, ..Input::new(name, vec![symbol]) });
        self
    }

    pub fn scalar(mut self, name: &'static str, value: Poly, doc: &'static str) -> Kernel {
        self.outputs.push(Output { name, shape: Shape::Scalar, values: vec![value], doc });
        self
    }

    pub fn vector(mut self, name: &'static str, values: Vec<Poly>, doc: &'static str) -> Kernel {
        self.outputs.push(Output { name, shape: Shape::Vector(values.len()), values, doc });
        self
    }

    pub fn matrix(mut self, name: &'static str, rows: Vec<Vec<Poly>>, doc: &'static str) -> Kernel {
        let shape = Shape::Matrix(rows.len(), rows.first().map_or(0, Vec::len));
        self.outputs.push(Output { name, shape, values: rows.into_iter().flatten().collect(), doc });
        self
    }
}
