//! ∂parameters/∂Θ of a phase: most parameters are a variable, and the others depend on few.

use piaffe_sqp::axpy;

/// The matrix by rows, one per parameter, without its zeros.
#[derive(Clone, Debug)]
pub struct ByTheta {
    /// Variables.
    n: usize,
    /// Where each row ends.
    ends: Vec<usize>,
    /// Variable and derivative.
    entries: Vec<(usize, f64)>,
}

impl ByTheta {
    /// Room for so many parameters and variables.
    pub fn new(parameters: usize, n: usize) -> ByTheta {
        ByTheta { n, ends: Vec::with_capacity(parameters), entries: Vec::with_capacity(parameters * n) }
    }

    /// Takes over a matrix by rows.
    pub fn set(&mut self, matrix: &[f64]) {
        self.ends.clear();
        self.entries.clear();
        for row in matrix.chunks_exact(self.n) {
            let entries = row.iter().copied().enumerate();
            self.entries.extend(entries.filter(|(_, derivative)| *derivative != 0.0));
            self.ends.push(self.entries.len());
        }
    }

    fn rows(&self) -> impl Iterator<Item = &[(usize, f64)]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, end)| &self.entries[start..*end])
    }

    /// `out += scale · ∂parameters/∂Θᵀ local`: the gradient in Θ of what has the gradient `local`.
    pub fn pull(&self, local: &[f64], scale: f64, out: &mut [f64]) {
        for (row, x) in self.rows().zip(local) {
            let x = scale * x;
            row.iter().for_each(|(variable, derivative)| out[*variable] += x * derivative);
        }
    }

    /// How the parameters change along a direction in Θ.
    pub fn push<'a>(&'a self, direction: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.rows().map(|row| row.iter().map(|(variable, derivative)| derivative * direction[*variable]).sum())
    }

    /// `out += ∂parameters/∂Θᵀ h ∂parameters/∂Θ`, with `half` for the product with h.
    pub fn congruence(&self, h: &[f64], half: &mut [f64], out: &mut [f64]) {
        let n = self.n;
        for (half, h) in half.chunks_exact_mut(n).zip(h.chunks_exact(self.ends.len())) {
            half.fill(0.0);
            self.pull(h, 1.0, half);
        }
        for (row, half) in self.rows().zip(half.chunks_exact(n)) {
            for (variable, derivative) in row {
                axpy(*derivative, half, &mut out[variable * n..(variable + 1) * n]);
            }
        }
    }
}
