//! A matrix of a few rows, row after row, in place: those of two feet's reactions need no memory of their own.

use smallvec::SmallVec;

/// Rows of one width.
#[derive(Clone, Debug)]
pub struct Rows {
    width: usize,
    rows: usize,
    numbers: SmallVec<[f64; 96]>,
}

impl Rows {
    pub fn zeros(rows: usize, width: usize) -> Rows {
        Rows { width, rows, numbers: SmallVec::from_elem(0.0, rows * width) }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.rows
    }

    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    #[inline]
    pub fn row(&self, k: usize) -> &[f64] {
        &self.numbers[k * self.width..][..self.width]
    }

    #[inline]
    pub fn row_mut(&mut self, k: usize) -> &mut [f64] {
        &mut self.numbers[k * self.width..][..self.width]
    }

    /// From the first to the last.
    #[inline]
    pub fn iter(&self) -> impl Iterator<Item = &[f64]> {
        (0..self.rows).map(|k| self.row(k))
    }

    /// Reflects the rows from `first` on, an orthogonal change of them (Householder's), so that of these only the first has
    /// something left in the column `pivot`, with its sign turned.
    pub fn reflect(&mut self, first: usize, pivot: usize) {
        let (width, rows) = (self.width, &mut self.numbers[first * self.width..]);
        let norm = rows.chunks_exact(width).map(|row| row[pivot] * row[pivot]).sum::<f64>().sqrt();
        if norm == 0.0 {
            return;
        }
        // The mirror's normal is the column with this in place of its first number. Nothing cancels.
        let first = rows[pivot] + norm.copysign(rows[pivot]);
        let normal = |k: usize, row: &[f64]| if k == 0 { first } else { row[pivot] };
        let mut along: SmallVec<[f64; 32]> = SmallVec::from_elem(0.0, width);
        for (k, row) in rows.chunks_exact(width).enumerate() {
            let part = normal(k, row);
            along.iter_mut().zip(row).for_each(|(sum, x)| *sum += part * x);
        }
        let half_square = norm * first.abs();
        for (k, row) in rows.chunks_exact_mut(width).enumerate() {
            let part = normal(k, row) / half_square;
            row.iter_mut().zip(&along).for_each(|(x, sum)| *x -= part * sum);
        }
    }
}

/// Of two lists, the sum of products.
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
