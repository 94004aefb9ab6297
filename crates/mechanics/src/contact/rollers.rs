//! Rollers as contacts see them, whatever they belong to.

/// The rollers' part of a state, and of its accelerations.
#[derive(Debug)]
pub(crate) struct Rollers<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) y: &'a [f64],
    pub(crate) vx: &'a [f64],
    pub(crate) vy: &'a [f64],
    pub(crate) ax: &'a mut [f64],
    pub(crate) ay: &'a mut [f64],
    pub(crate) inverse_mass: &'a [f64],
    /// Angular speeds of the circles that touch \[rad/s\]; empty where none of them turns.
    pub(crate) spin: &'a [f64],
    /// Half of the step \[s\] at whose end the velocities are predicted; zero where they are what they are.
    pub(crate) half_step: f64,
}

impl Rollers<'_> {
    /// The same.
    #[inline(always)]
    pub(crate) fn of_one_length(&mut self) -> Rollers<'_> {
        let n = self.x.len();
        Rollers {
            x: &self.x[..n],
            y: &self.y[..n],
            vx: &self.vx[..n],
            vy: &self.vy[..n],
            ax: &mut self.ax[..n],
            ay: &mut self.ay[..n],
            inverse_mass: &self.inverse_mass[..n],
            spin: self.spin,
            half_step: self.half_step,
        }
    }
}
