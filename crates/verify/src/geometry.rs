//! What vectors, spins and rotations are: in space, or in the sagittal plane, where all turning is about z.
//!
//! In the plane a spin and a moment are one number each and a body's axes one vector; what is left out is zero in space
//! too, so both geometries give the same bits, the plane in a fraction of the time.

use super::numbers::Rigid;
use nalgebra::{Vector2, Vector3};
use num_traits::Zero;
use piaffe_model::Description;
use piaffe_number::Scalar;
use std::fmt::Debug;
use std::ops::{AddAssign, Mul, Neg, Sub, SubAssign};

/// A vector in world axes.
pub type Vec3<T = f64> = Vector3<T>;

/// What can be added up and multiplied by numbers.
pub trait Linear<T>:
    Copy + Debug + Zero + Sub<Output = Self> + Neg<Output = Self> + Mul<T, Output = Self> + AddAssign + SubAssign
{
}

impl<T: Scalar> Linear<T> for T {}
impl<T: Scalar> Linear<T> for Vector2<T> {}
impl<T: Scalar> Linear<T> for Vector3<T> {}

/// A geometry in numbers of a kind.
pub trait Geometry<T: Scalar>: Copy + Debug {
    /// Positions, velocities, accelerations, forces; in world axes.
    type Vector: Linear<T>;
    /// Angular velocities and accelerations, angular momenta, moments; in world axes.
    type Spin: Linear<T>;
    /// The axes of a body in the world.
    type Axes: Copy + Debug;

    /// What it has of a vector.
    fn seen(v: &Vec3<T>) -> Self::Vector;
    /// As a vector in space.
    fn in_space(v: Self::Vector) -> Vec3<T>;
    /// Without its part across the sagittal plane.
    fn flattened(v: Self::Vector) -> Self::Vector;
    /// Straight up, of this length.
    fn up(length: T) -> Self::Vector;

    /// The world's axes.
    fn upright() -> Self::Axes;
    /// Turns the axes about one of them (0, 1 or 2), by an angle with this sine and cosine.
    fn turn(axes: &mut Self::Axes, about: usize, sin_cos: (T, T));
    /// One of them.
    fn axis(axes: &Self::Axes, k: usize) -> Self::Spin;
    /// From the body's axes to the world's.
    fn in_world(axes: &Self::Axes, v: Self::Vector) -> Self::Vector;
    /// The part straight up of a vector in the body's axes.
    fn rise(axes: &Self::Axes, v: &Vec3<T>) -> T;

    /// ω × r: the velocity of the tip of an arm.
    fn swirl(spin: Self::Spin, arm: Self::Vector) -> Self::Vector;
    /// r × F.
    fn moment(arm: Self::Vector, force: Self::Vector) -> Self::Spin;
    /// ω × w: how fast an axis with this spin changes.
    fn precession(spin: Self::Spin, axis: Self::Spin) -> Self::Spin;
    /// w · w′.
    fn along(spin: Self::Spin, axis: Self::Spin) -> T;
    /// Component about a world axis (0, 1 or 2).
    fn about(spin: Self::Spin, axis: usize) -> T;

    /// I ω of a body.
    fn spin_momentum(axes: &Self::Axes, body: &Rigid<T>, spin: Self::Spin) -> Self::Spin;
    /// I α + ω × I ω.
    fn spin_moment(axes: &Self::Axes, body: &Rigid<T>, spin: Self::Spin, spin_rate: Self::Spin) -> Self::Spin;
}

/// All three directions.
#[derive(Clone, Copy, Debug)]
pub struct Space;

/// The sagittal plane.
#[derive(Clone, Copy, Debug)]
pub struct Plane;

impl Plane {
    /// Whether all motion of a robot is in it.
    pub fn holds(d: &Description) -> bool {
        let turns_about_z = d.bodies.iter().all(|body| body.coordinate.is_none() || body.axis == 2);
        !d.is_spatial() && turns_about_z
    }
}

impl<T: Scalar> Geometry<T> for Space {
    type Vector = Vec3<T>;
    type Spin = Vec3<T>;
    type Axes = [Vec3<T>; 3];

    fn seen(v: &Vec3<T>) -> Vec3<T> {
        *v
    }

    fn in_space(v: Vec3<T>) -> Vec3<T> {
        v
    }

    fn flattened(v: Vec3<T>) -> Vec3<T> {
        Vec3::new(v.x, v.y, T::zero())
    }

    fn up(length: T) -> Vec3<T> {
        Vec3::new(T::zero(), length, T::zero())
    }

    fn upright() -> [Vec3<T>; 3] {
        let (o, l) = (T::zero(), T::from(1.0));
        [Vec3::new(l, o, o), Vec3::new(o, l, o), Vec3::new(o, o, l)]
    }

    fn turn(axes: &mut [Vec3<T>; 3], about: usize, (sin, cos): (T, T)) {
        let (j, k) = ((about + 1) % 3, (about + 2) % 3);
        let (x, y) = (axes[j], axes[k]);
        axes[j] = x * cos + y * sin;
        axes[k] = y * cos - x * sin;
    }

    fn axis(axes: &[Vec3<T>; 3], k: usize) -> Vec3<T> {
        axes[k]
    }

    #[inline]
    fn in_world(axes: &[Vec3<T>; 3], v: Vec3<T>) -> Vec3<T> {
        axes[0] * v.x + axes[1] * v.y + axes[2] * v.z
    }

    fn rise(axes: &[Vec3<T>; 3], v: &Vec3<T>) -> T {
        axes[0].y * v.x + axes[1].y * v.y + axes[2].y * v.z
    }

    fn swirl(spin: Vec3<T>, arm: Vec3<T>) -> Vec3<T> {
        cross(spin, arm)
    }

    fn moment(arm: Vec3<T>, force: Vec3<T>) -> Vec3<T> {
        cross(arm, force)
    }

    fn precession(spin: Vec3<T>, axis: Vec3<T>) -> Vec3<T> {
        cross(spin, axis)
    }

    fn along(spin: Vec3<T>, axis: Vec3<T>) -> T {
        spin.dot(&axis)
    }

    fn about(spin: Vec3<T>, axis: usize) -> T {
        spin[axis]
    }

    fn spin_momentum(axes: &[Vec3<T>; 3], body: &Rigid<T>, spin: Vec3<T>) -> Vec3<T> {
        Self::in_world(axes, by_inertia(body, in_body(axes, spin)))
    }

    fn spin_moment(axes: &[Vec3<T>; 3], body: &Rigid<T>, spin: Vec3<T>, spin_rate: Vec3<T>) -> Vec3<T> {
        // In the body's axes, where the inertia is constant.
        let (spin, spin_rate) = (in_body(axes, spin), in_body(axes, spin_rate));
        Self::in_world(axes, by_inertia(body, spin_rate) + cross(spin, by_inertia(body, spin)))
    }
}

/// By value, so that it is always written out where it stands.
#[inline(always)]
fn cross<T: Scalar>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// From the world's axes to a body's.
fn in_body<T: Scalar>(axes: &[Vec3<T>; 3], v: Vec3<T>) -> Vec3<T> {
    Vec3::from(axes.map(|axis| axis.dot(&v)))
}

/// A body's inertia about its mass centre times a vector, both in its own axes.
fn by_inertia<T: Scalar>(body: &Rigid<T>, v: Vec3<T>) -> Vec3<T> {
    // Rows for columns: it is symmetric.
    Space::in_world(&body.inertia, v)
}

impl<T: Scalar> Geometry<T> for Plane {
    type Vector = Vector2<T>;
    type Spin = T;
    /// The body's x.
    type Axes = Vector2<T>;

    fn seen(v: &Vec3<T>) -> Vector2<T> {
        v.xy()
    }

    fn in_space(v: Vector2<T>) -> Vec3<T> {
        Vec3::new(v.x, v.y, T::zero())
    }

    fn flattened(v: Vector2<T>) -> Vector2<T> {
        v
    }

    fn up(length: T) -> Vector2<T> {
        Vector2::new(T::zero(), length)
    }

    fn upright() -> Vector2<T> {
        Vector2::new(T::from(1.0), T::zero())
    }

    fn turn(axes: &mut Vector2<T>, _about: usize, (sin, cos): (T, T)) {
        *axes = *axes * cos + quarter_turn(*axes) * sin;
    }

    fn axis(_axes: &Vector2<T>, _k: usize) -> T {
        T::from(1.0)
    }

    fn in_world(axes: &Vector2<T>, v: Vector2<T>) -> Vector2<T> {
        *axes * v.x + quarter_turn(*axes) * v.y
    }

    fn rise(axes: &Vector2<T>, v: &Vec3<T>) -> T {
        axes.y * v.x + axes.x * v.y
    }

    fn swirl(spin: T, arm: Vector2<T>) -> Vector2<T> {
        quarter_turn(arm) * spin
    }

    fn moment(arm: Vector2<T>, force: Vector2<T>) -> T {
        arm.x * force.y - arm.y * force.x
    }

    fn precession(_spin: T, _axis: T) -> T {
        T::zero()
    }

    fn along(spin: T, _axis: T) -> T {
        // There is one axis, of length 1.
        spin
    }

    fn about(spin: T, _axis: usize) -> T {
        spin
    }

    fn spin_momentum(_axes: &Vector2<T>, body: &Rigid<T>, spin: T) -> T {
        body.inertia[2].z * spin
    }

    fn spin_moment(_axes: &Vector2<T>, body: &Rigid<T>, _spin: T, spin_rate: T) -> T {
        body.inertia[2].z * spin_rate
    }
}

/// Turned by 90° from x to y.
fn quarter_turn<T: Scalar>(v: Vector2<T>) -> Vector2<T> {
    Vector2::new(-v.y, v.x)
}
