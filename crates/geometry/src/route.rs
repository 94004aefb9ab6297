//! Taut route of a closed chain over wheels and curved guides.
//!
//! The chain is a closed, directed curve. Every [`Wheel`] carries the circle on which roller
//! centres ride and the [`Side`] of the travelling chain on which it lies; the taut route joins
//! the circles by common tangents. Lengths follow the pitch line, so one tooth of wrap on a
//! sprocket takes exactly one pitch, although its arc is longer than its chord.
//!
//! The route is the smooth picture of a drive: link counts are fractional and tooth phases do not
//! matter. [`Closing`](crate::Closing) is the exact picture.

use std::f64::consts::{PI, TAU};

use crate::{GeometryError, Point, Vector};

/// On which side of the travelling chain a wheel lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The route turns counter-clockwise around the wheel.
    Left,
    /// The route turns clockwise: a back-side idler, or a guide outside a counter-clockwise loop.
    Right,
}

impl Side {
    /// Sense of the turn \[–\]: +1 counter-clockwise, −1 clockwise.
    pub fn sense(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// Seat of the rollers on the circle of a [`Wheel`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WheelKind {
    /// A sprocket: rollers sit in gaps, 2π/z apart.
    Toothed {
        /// Number of teeth z \[–\], at least 3.
        teeth: u32,
    },
    /// A curved guide: rollers lie anywhere on the circle, one chord apart.
    Smooth,
}

/// A circle of roller centres that the chain touches: a sprocket, an idler or a curved guide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel {
    /// Centre of the circle \[m\].
    pub centre: Point,
    /// Radius of the circle of roller centres \[m\]; for a sprocket its pitch radius.
    pub radius: f64,
    /// Side of the travelling chain on which the wheel lies.
    pub side: Side,
    /// Sprocket or guide.
    pub kind: WheelKind,
}

impl Wheel {
    /// A sprocket of z teeth for a chain of pitch p \[m\].
    ///
    /// ```text
    /// R = p / (2 sin(π/z))
    /// ```
    pub fn toothed(centre: Point, teeth: u32, pitch: f64, side: Side) -> Self {
        // R = p / (2 sin(π/z))
        let radius = pitch / (2.0 * (PI / f64::from(teeth)).sin());
        let kind = WheelKind::Toothed { teeth };
        Self {
            centre,
            radius,
            side,
            kind,
        }
    }

    /// A curved guide on which roller centres ride at `radius` \[m\].
    pub fn smooth(centre: Point, radius: f64, side: Side) -> Self {
        Self {
            centre,
            radius,
            side,
            kind: WheelKind::Smooth,
        }
    }

    /// Number of teeth z \[–\]; for a guide the virtual number of teeth for a pitch p \[m\], not whole.
    ///
    /// ```text
    /// z_v = π / asin(p / 2R)
    /// ```
    pub fn teeth(&self, pitch: f64) -> f64 {
        match self.kind {
            WheelKind::Toothed { teeth } => f64::from(teeth),
            // z_v = π / asin(p / 2R)
            WheelKind::Smooth => PI / (0.5 * pitch / self.radius).asin(),
        }
    }

    /// Angle from one roller to the next, 2π/z \[rad\], for a pitch p \[m\].
    pub fn pitch_angle(&self, pitch: f64) -> f64 {
        TAU / self.teeth(pitch)
    }

    /// Point of the circle at `angle` \[rad\], counter-clockwise from the x axis \[m\].
    pub fn at(&self, angle: f64) -> Point {
        self.centre + self.radius * Vector::new(angle.cos(), angle.sin())
    }

    /// Sense of the turn of the chain around the wheel \[–\], ±1.
    pub fn sense(&self) -> f64 {
        self.side.sense()
    }

    /// Refuses a wheel whose numbers are not finite, positive, or enough teeth.
    pub(crate) fn check(&self, wheel: usize) -> Result<(), GeometryError> {
        let numbers = || {
            GeometryError::positive("radius [m]", self.radius)?;
            GeometryError::finite("x of the centre [m]", self.centre.x)?;
            GeometryError::finite("y of the centre [m]", self.centre.y)?;
            match self.kind {
                WheelKind::Toothed { teeth } => check_teeth(teeth),
                WheelKind::Smooth => Ok(()),
            }
        };
        numbers().map_err(|source| GeometryError::Wheel {
            wheel,
            source: Box::new(source),
        })
    }
}

/// Refuses a polygon of fewer than three corners.
pub(crate) fn check_teeth(teeth: u32) -> Result<(), GeometryError> {
    if teeth < 3 {
        let (what, value) = ("number of teeth", f64::from(teeth));
        return Err(GeometryError::OutOfRange {
            what,
            value,
            allowed: "at least 3",
        });
    }
    Ok(())
}

/// A straight piece of a [`Route`] between two wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Direction of travel \[rad\], counter-clockwise from the x axis, in (−2π, 2π).
    pub direction: f64,
    /// Length between the points of tangency \[m\].
    pub length: f64,
    /// Where the chain leaves the wheel before \[m\].
    pub leaves: Point,
    /// Where the chain arrives at the next wheel \[m\].
    pub arrives: Point,
}

/// Taut closed route: circles joined by common tangents.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// The wheels, in the order in which the chain passes them.
    pub wheels: Vec<Wheel>,
    /// Span i leads from wheel i to wheel i + 1, the last one back to wheel 0.
    pub spans: Vec<Span>,
    /// Wrap angle w of every wheel \[rad\], in [0, 2π).
    pub wraps: Vec<f64>,
}

impl Route {
    /// Stretches a closed chain around `wheels`, given in the order in which it passes them.
    ///
    /// With s the sense of a wheel, ρ = s R, D and θ length and direction of the line of centres,
    /// and n the left normal of the span:
    ///
    /// ```text
    /// φ = θ − asin((ρ_j − ρ_i) / D)        L = √(D² − (ρ_j − ρ_i)²)
    /// T_i = c_i − ρ_i n,  T_j = c_j − ρ_j n        w_i = s_i (φ_out − φ_in) mod 2π
    /// ```
    ///
    /// Wheels that the chain passes elsewhere are not looked at: a span may run through them.
    ///
    /// # Errors
    /// Fewer than two wheels, a wheel with impossible numbers, two sprockets that overlap, two
    /// neighbours without a common tangent, or a chain that does not go round exactly once
    /// (it crosses itself or misses a wheel).
    pub fn taut(wheels: &[Wheel]) -> Result<Self, GeometryError> {
        check_wheels(wheels)?;
        let behind = |i: usize| (i + 1) % wheels.len();
        let spans = (0..wheels.len())
            .map(|i| tangent(wheels, i, behind(i)))
            .collect::<Result<Vec<_>, _>>()?;
        let wraps: Vec<f64> = (0..wheels.len())
            .map(|i| {
                let arriving = spans[(i + wheels.len() - 1) % wheels.len()].direction;
                // w_i = s_i (φ_out − φ_in) mod 2π
                full_turn(wheels[i].sense() * (spans[i].direction - arriving))
            })
            .collect();

        // A simple loop turns once: Σ s_i w_i = ±2π.
        let turns = wheels
            .iter()
            .zip(&wraps)
            .map(|(wheel, wrap)| wheel.sense() * wrap)
            .sum::<f64>()
            / TAU;
        if (turns.abs() - 1.0).abs() > 1e-6 {
            let missed = (0..wheels.len())
                .max_by(|&i, &j| wraps[i].total_cmp(&wraps[j]))
                .unwrap_or(0);
            return Err(GeometryError::RouteTurns {
                turns,
                wheel: missed,
                wrap: wraps[missed].to_degrees(),
                around: sense_around(wheels),
            });
        }
        Ok(Self {
            wheels: wheels.to_vec(),
            spans,
            wraps,
        })
    }

    /// Number of links that the taut route takes \[–\], not whole, for a pitch p \[m\].
    ///
    /// ```text
    /// X = Σ L/p + Σ w z/2π
    /// ```
    ///
    /// A smooth estimate: the exact polygon differs by some (π/z)² of a pitch, and with the tooth phase.
    pub fn pitches(&self, pitch: f64) -> f64 {
        let straight: f64 = self.spans.iter().map(|span| span.length / pitch).sum();
        let wrapped: f64 = self
            .wheels
            .iter()
            .zip(&self.wraps)
            .map(|(wheel, wrap)| wrap / wheel.pitch_angle(pitch))
            .sum();
        // X = Σ L/p + Σ w z/2π
        straight + wrapped
    }

    /// Gradient of the route's length by the centre of a wheel \[–\]: the direction of the greatest effect.
    ///
    /// ```text
    /// dL/dc_i = u_in − u_out        |dL/dc_i| = 2 sin(w_i / 2)
    /// ```
    ///
    /// A chain under tension T pulls the wheel the other way, with T times this.
    ///
    /// # Panics
    /// There is no such wheel.
    pub fn lengthening(&self, wheel: usize) -> Vector {
        let arriving = &self.spans[(wheel + self.spans.len() - 1) % self.spans.len()];
        // dL/dc_i = u_in − u_out
        arriving.along() - self.spans[wheel].along()
    }

    /// The sprocket after the first stop that changes the length most when it moves, and the direction: of two the line of
    /// centres. None where there is no other sprocket.
    pub fn most_effective(&self) -> Option<(usize, Vector)> {
        let toothed = |wheel: &usize| matches!(self.wheels[*wheel].kind, WheelKind::Toothed { .. });
        let effect = |wheel: usize| self.lengthening(wheel).norm();
        let candidates = (1..self.wheels.len()).filter(toothed);
        let wheel = candidates.max_by(|&i, &j| effect(i).total_cmp(&effect(j)))?;
        let direction = match self.wheels.as_slice() {
            [first, second] => second.centre - first.centre,
            _ => self.lengthening(wheel),
        };
        Some((wheel, direction.try_normalize(0.0)?))
    }

    /// Length of the smooth curve, Σ L + Σ w R \[m\]: longer than [`pitches`](Self::pitches) × pitch.
    pub fn length(&self) -> f64 {
        let straight: f64 = self.spans.iter().map(|span| span.length).sum();
        let wrapped: f64 = self
            .wheels
            .iter()
            .zip(&self.wraps)
            .map(|(wheel, wrap)| wrap * wheel.radius)
            .sum();
        straight + wrapped
    }
}

/// Angle brought into [0, 2π); rounding just below a full turn counts as none.
/// Sense in which the centres of wheels follow one another: that of the area which they enclose, 0 where it is next to nothing.
fn sense_around(wheels: &[Wheel]) -> f64 {
    let behind = wheels.iter().cycle().skip(1);
    let (mut twice, mut squares) = (0.0, 0.0);
    // 2 A = Σ rᵢ × rᵢ₊₁, from the first centre
    let first = wheels[0].centre;
    for (wheel, next) in wheels.iter().zip(behind) {
        let (a, b) = (wheel.centre - first, next.centre - first);
        twice += a.perp(&b);
        squares += (b - a).norm_squared();
    }
    if twice.abs() > 1e-9 * squares {
        twice.signum()
    } else {
        0.0
    }
}

fn full_turn(angle: f64) -> f64 {
    let turned = angle.rem_euclid(TAU);
    if TAU - turned < 1e-12 { 0.0 } else { turned }
}

/// Refuses wheels no chain can be laid around, whatever the tangents.
fn check_wheels(wheels: &[Wheel]) -> Result<(), GeometryError> {
    if wheels.len() < 2 {
        return Err(GeometryError::TooFewWheels {
            wheels: wheels.len(),
        });
    }
    for (index, wheel) in wheels.iter().enumerate() {
        wheel.check(index)?;
    }
    let toothed = |wheel: &Wheel| matches!(wheel.kind, WheelKind::Toothed { .. });
    for (second, b) in wheels.iter().enumerate() {
        for (first, a) in wheels[..second].iter().enumerate() {
            let distance = (b.centre - a.centre).norm();
            let least = a.radius + b.radius;
            if toothed(a) && toothed(b) && distance <= least {
                return Err(GeometryError::WheelsOverlap {
                    first,
                    second,
                    distance,
                    least,
                });
            }
        }
    }
    Ok(())
}

impl Span {
    /// The straight span from one wheel to another, whatever else the chain passes.
    ///
    /// # Errors
    /// Wheels with impossible numbers, or without a common tangent on their sides.
    pub fn between(from: &Wheel, to: &Wheel) -> Result<Self, GeometryError> {
        from.check(0)?;
        to.check(1)?;
        tangent(&[*from, *to], 0, 1)
    }
}

/// The common tangent from wheel i to wheel j.
fn tangent(wheels: &[Wheel], i: usize, j: usize) -> Result<Span, GeometryError> {
    let (a, b) = (&wheels[i], &wheels[j]);
    let line = b.centre - a.centre;
    let distance = line.norm();
    let (rho_i, rho_j) = (a.sense() * a.radius, b.sense() * b.radius);
    let step = rho_j - rho_i;
    if distance <= step.abs() {
        return Err(GeometryError::NoTangent {
            from: i,
            to: j,
            distance,
            least: step.abs(),
        });
    }
    // φ = θ − asin((ρ_j − ρ_i) / D)
    let direction = line.y.atan2(line.x) - (step / distance).asin();
    // L = √(D² − (ρ_j − ρ_i)²)
    let length = ((distance - step) * (distance + step)).sqrt();
    let normal = Vector::new(-direction.sin(), direction.cos());
    // T_i = c_i − ρ_i n,  T_j = c_j − ρ_j n
    Ok(Span {
        direction,
        length,
        leaves: a.centre - rho_i * normal,
        arrives: b.centre - rho_j * normal,
    })
}
