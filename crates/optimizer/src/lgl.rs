//! Lobatto collocation on the unit interval: five nodes, order 8.
//!
//! A function is represented by the values of its derivative at the nodes; its own values at the
//! nodes and anywhere between are integrals of the interpolating polynomial.

/// Nodes per element.
pub const NODES: usize = 5;

/// Collocation coefficients.
#[derive(Clone, Debug)]
pub struct Lobatto {
    /// Nodes on [0, 1]; first 0, last 1.
    pub nodes: [f64; NODES],
    /// `integral[i][j]` = ∫₀^{nodes[i]} of the j-th Lagrange polynomial.
    pub integral: [[f64; NODES]; NODES],
    /// ∫₀¹ of the j-th Lagrange polynomial.
    pub weights: [f64; NODES],
    /// Monomial coefficients of the Lagrange polynomials: `monomial[j][k]` of sᵏ.
    monomial: [[f64; NODES]; NODES],
}

impl Default for Lobatto {
    fn default() -> Self {
        Self::new()
    }
}

impl Lobatto {
    pub fn new() -> Lobatto {
        // Roots of P₄′ besides ±1: 0 and ±√(3/7).
        let outer = (3.0f64 / 7.0).sqrt();
        let nodes = [-1.0, -outer, 0.0, outer, 1.0].map(|x| 0.5 * (x + 1.0));
        let mut monomial = [[0.0; NODES]; NODES];
        for (j, row) in monomial.iter_mut().enumerate() {
            let mut p = [0.0; NODES];
            p[0] = 1.0;
            let mut degree = 0;
            for (m, node) in nodes.iter().enumerate() {
                if m == j {
                    continue;
                }
                // p ← p·(s − node)/(nodes[j] − node)
                let scale = 1.0 / (nodes[j] - node);
                degree += 1;
                for k in (0..=degree).rev() {
                    let below = if k > 0 { p[k - 1] } else { 0.0 };
                    p[k] = (below - node * p[k]) * scale;
                }
            }
            *row = p;
        }
        let mut lobatto = Lobatto { nodes, integral: [[0.0; NODES]; NODES], weights: [0.0; NODES], monomial };
        for i in 0..NODES {
            lobatto.integral[i] = lobatto.integrals(nodes[i]);
        }
        lobatto.weights = lobatto.integral[NODES - 1];
        lobatto
    }

    /// ∫₀ˢ of each Lagrange polynomial.
    pub fn integrals(&self, s: f64) -> [f64; NODES] {
        self.monomial.map(|p| {
            let mut sum = 0.0;
            for k in (0..NODES).rev() {
                sum = sum * s + p[k] / (k + 1) as f64;
            }
            sum * s
        })
    }

    /// Value of each Lagrange polynomial at `s`.
    pub fn values(&self, s: f64) -> [f64; NODES] {
        self.monomial.map(|p| p.iter().rev().fold(0.0, |sum, c| sum * s + c))
    }

    /// Slope of each Lagrange polynomial at `s`.
    pub fn slopes(&self, s: f64) -> [f64; NODES] {
        self.monomial.map(|p| (1..NODES).rev().fold(0.0, |sum, k| sum * s + k as f64 * p[k]))
    }

    /// Monomial coefficients of the polynomial through `values` at the nodes.
    pub fn interpolate(&self, values: &[f64; NODES]) -> [f64; NODES] {
        let mut p = [0.0; NODES];
        for (v, row) in values.iter().zip(&self.monomial) {
            for (c, r) in p.iter_mut().zip(row) {
                *c += v * r;
            }
        }
        p
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrature_is_exact_to_degree_seven() {
        let l = Lobatto::new();
        for degree in 0..8 {
            let sum: f64 = (0..NODES).map(|j| l.weights[j] * l.nodes[j].powi(degree)).sum();
            assert!((sum - 1.0 / f64::from(degree + 1)).abs() < 1e-14, "degree {degree}");
        }
        let eight: f64 = (0..NODES).map(|j| l.weights[j] * l.nodes[j].powi(8)).sum();
        assert!((eight - 1.0 / 9.0).abs() > 1e-6);
    }

    #[test]
    fn integrals_and_interpolation_reproduce_a_quartic() {
        let l = Lobatto::new();
        let f = |s: f64| 1.0 - 2.0 * s + s * s * s + 0.5 * s.powi(4);
        let primitive = |s: f64| s - s * s + s.powi(4) / 4.0 + 0.1 * s.powi(5);
        let values = l.nodes.map(f);
        for s in [0.0, 0.2, 0.71, 1.0] {
            let integral: f64 = l.integrals(s).iter().zip(&values).map(|(w, v)| w * v).sum();
            assert!((integral - primitive(s)).abs() < 1e-14);
            let value: f64 = l.values(s).iter().zip(&values).map(|(w, v)| w * v).sum();
            assert!((value - f(s)).abs() < 1e-14);
        }
        let p = l.interpolate(&values);
        assert!((p[1] + 2.0).abs() < 1e-13 && p[2].abs() < 1e-12 && (p[4] - 0.5).abs() < 1e-12);
    }
}
