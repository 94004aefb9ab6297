//! Places and velocities of the rollers of a chain.

use chaindrive_integrate::Moment;

/// Positions and velocities of the rollers, with the ghosts after the last one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) y: &'a [f64],
    pub(crate) vx: &'a [f64],
    pub(crate) vy: &'a [f64],
}

impl<'a> Pose<'a> {
    /// Of coordinates that begin with x, then y of the rollers, `stride` of each.
    pub(crate) fn of_first(at: Moment<'a>, stride: usize) -> Self {
        Self {
            x: &at.q[..stride],
            y: &at.q[stride..2 * stride],
            vx: &at.v[..stride],
            vy: &at.v[stride..2 * stride],
        }
    }
}
