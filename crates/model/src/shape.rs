//! Where everything stands among the numbers that a kernel takes and gives.
//!
//! A kernel writes its outputs one after another into a slice. What each of them is, is declared where the kernel is derived; the
//! build writes it down as these structures, a field for each output by the name that it has there. So nobody counts:
//!
//! ```
//! use piaffe_model::shape::Block;
//! // Two numbers, then their gradients in three variables.
//! let (values, gradients) = (Block::new(0, 2, 1), Block::new(2, 2, 3));
//! let out = [1.0, 2.0, 1.1, 1.2, 1.3, 2.1, 2.2, 2.3];
//! assert_eq!(values.of(&out), [1.0, 2.0]);
//! assert_eq!(gradients.row(&out, 1), [2.1, 2.2, 2.3]);
//! ```

use std::ops::Range;

/// A scalar, a vector or a matrix in a slice of numbers; row-major.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    at: usize,
    rows: usize,
    columns: usize,
}

impl Block {
    /// What a kernel does not have.
    pub const NONE: Block = Block::new(0, 0, 0);

    pub const fn new(at: usize, rows: usize, columns: usize) -> Block {
        Block { at, rows, columns }
    }

    /// Number of rows; of a vector its length.
    pub const fn rows(self) -> usize {
        self.rows
    }

    pub const fn len(self) -> usize {
        self.rows * self.columns
    }

    pub const fn is_empty(self) -> bool {
        self.len() == 0
    }

    pub const fn range(self) -> Range<usize> {
        self.at..self.at + self.len()
    }

    /// Where a number of a matrix stands.
    #[inline]
    pub const fn index(self, row: usize, column: usize) -> usize {
        self.at + row * self.columns + column
    }

    /// Where a number of a scalar (0) or a vector stands.
    #[inline]
    pub const fn place(self, k: usize) -> usize {
        self.at + k
    }

    /// The block itself.
    #[inline]
    pub fn of<T>(self, numbers: &[T]) -> &[T] {
        &numbers[self.range()]
    }

    #[inline]
    pub fn of_mut<T>(self, numbers: &mut [T]) -> &mut [T] {
        &mut numbers[self.range()]
    }

    /// A scalar.
    #[inline]
    pub fn value<T: Copy>(self, numbers: &[T]) -> T {
        numbers[self.at]
    }

    /// A row of a matrix.
    #[inline]
    pub fn row<T>(self, numbers: &[T], row: usize) -> &[T] {
        &numbers[self.at + row * self.columns..][..self.columns]
    }

    /// All rows of a matrix.
    #[inline]
    pub fn each<T>(self, numbers: &[T]) -> std::slice::ChunksExact<'_, T> {
        self.of(numbers).chunks_exact(self.columns.max(1))
    }
}

/// Structures of blocks, in each of which the build leaves out what a gait has not.
macro_rules! shapes {
    ($($(#[$doc:meta])* $kernel:ident { $($(#[$what:meta])* $block:ident),* $(; $($input:ident: $weights:ident),*)? })*) => {
        $($(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct $kernel {
            $($(#[$what])* pub $block: Block,)*
            $($(pub $input: $weights,)*)?
            /// How many numbers they are in all.
            pub len: usize,
        }

        impl $kernel {
            pub const NONE: $kernel = $kernel { $($block: Block::NONE,)* $($($input: $weights::NONE,)*)? len: 0 };

            /// Room for all of them.
            pub fn zeros(&self) -> Vec<f64> {
                vec![0.0; self.len]
            }

            /// From where each block stands, by its name behind `path`: `curvature.gradient`, `curvature.n.torque`.
            pub fn named(path: &str, block: &dyn Fn(&str) -> Block) -> $kernel {
                let ($($block,)*) = ($(block(&format!("{path}.{}", stringify!($block))),)*);
                let len = 0 $(+ $block.len())*;
                $($(let $input = $weights::named(&format!("{path}.{}", stringify!($input)), block);)*)?
                $kernel { $($block,)* $($($input,)*)? len }
            }
        })*
    };
}

/// The shapes of many kernels, by the kernels' names.
macro_rules! all {
    ($(#[$doc:meta])* $name:ident { $($field:ident: $kernel:ident),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct $name {
            $(pub $field: $crate::shape::$kernel,)*
        }

        impl $name {
            pub const NONE: $name = $name { $($field: $crate::shape::$kernel::NONE,)* };

            /// From where each block stands, by its name behind `path`, if that is not empty.
            pub fn named(path: &str, block: &dyn Fn(&str) -> $crate::shape::Block) -> $name {
                let dot = if path.is_empty() { "" } else { "." };
                $(let $field = $crate::shape::$kernel::named(&format!("{path}{dot}{}", stringify!($field)), block);)*
                $name { $($field,)* }
            }
        }
    };
}
pub(crate) use all;

all! {
    /// Shapes of the kernels of a mode. What each is, the kernels themselves document.
    ModeShapes {
        momentum_terms: MomentumTerms,
        reduced: Reduced,
        forward: Forward,
        inverse: Inverse,
        momentum: Momentum,
        inverse_jacobian: InverseJacobian,
        placement: Placement,
        heights: Heights,
        heights_curvature: HeightsCurvature,
        swing_velocity: SwingVelocity,
        early: Early,
        late: Late,
        late_gradient: LateGradient,
        curvature: Curvature,
        sharing: Sharing,
        sharing_curvature: SharingCurvature,
    }
}

all! {
    /// Shapes of the kernels of a gait: those of its modes, and of its transitions. Of stance on either leg they are the same.
    Shapes {
        stance: ModeShapes,
        flight: ModeShapes,
        inertia_and_bias: InertiaAndBias,
        energy: Energy,
        centre_of_mass: CentreOfMass,
        impact: Impact,
        touchdown: Touchdown,
        touchdown_curvature: TouchdownCurvature,
        landing: Landing,
        landing_curvature: LandingCurvature,
        takeoff: Takeoff,
        takeoff_curvature: TakeoffCurvature,
        impact_both: ImpactBoth,
    }
}

// `_q` is a derivative in q, `_w` one in all that a kernel takes: (q, q̇) or (q, q̇, q̈).
shapes! {
    InertiaAndBias { a, h }
    Energy { kinetic, potential }
    CentreOfMass { position, velocity }
    MomentumTerms { f1, f2, sigma, c, sigmadot }
    Reduced { a, h }
    Forward { xdd, f }
    Inverse { xdd, gamma, f }
    Momentum { sigma, sigma_w }
    InverseJacobian { beta_dd, gamma, f, gamma_w, f_w, balance_w }
    Placement { p, swing, p_q, swing_q }
    Heights { heights, heights_q }
    HeightsCurvature { gradient, q_q }
    SwingVelocity { v, v_w }
    Early { early }
    Late { value, by_beta }
    LateGradient { f1_q, f2_q, f2_qd, moment_q }
    Impact { xd_plus, impulse }
    /// The couple and the pitch only where the platform rolls.
    Touchdown {
        qd_plus, impulse, leaving, landing, qd_plus_w, impulse_w, leaving_w, landing_w, couple, pitch, couple_w, pitch_w
    }
    Curvature { gradient, q_q, q_qd, q_qdd, qd_qd; n: CurvatureN, others: CurvatureOthers }
    /// Weights of the generalized forces.
    CurvatureN { torque, balance }
    /// Weights of what else an instant gives.
    CurvatureOthers { sigma, sigmad, swing_height, platform_x, swing_velocity, platform_height }
    TouchdownCurvature { q_q, q_qd, q_plus; outputs: TouchdownCurvatureOutputs }
    /// What a touchdown gives beside q̇⁺.
    TouchdownCurvatureOutputs { impulse, leaving, landing, couple, pitch }
    Sharing { moment, levers, moment_w, levers_w }
    SharingCurvature { gradient, q_q, q_qd, q_qdd, qd_qd; weights: SharingCurvatureWeights }
    SharingCurvatureWeights { moment, levers }
    Landing { qd_plus, impulse, landing, qd_plus_w, impulse_w, landing_w }
    LandingCurvature { q_q, q_v, q_plus; outputs: LandingCurvatureOutputs }
    /// What a landing gives beside q̇⁺.
    LandingCurvatureOutputs { impulse, landing }
    Takeoff { r, v, lift, r_q, v_w, lift_w }
    TakeoffCurvature { gradient, q_q, q_qd, q_qdd, qd_qd; weights: TakeoffCurvatureWeights }
    TakeoffCurvatureWeights { r, v, lift }
    ImpactBoth { xd_plus, impulse1, impulse2, pivots, scale }
    /// Of a whole robot.
    Feet { d, jacobian }
}
