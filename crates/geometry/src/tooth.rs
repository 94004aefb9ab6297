//! Tooth gaps of a sprocket and the wheel they make.
//!
//! A gap is described in its own frame: wheel centre at the origin, gap axis along +y. It is
//! travelled counter-clockwise about the wheel, from the centre line of the tooth on the right
//! through the seat to the centre line of the tooth on the left, with the material on the left.
//!
//! ```text
//!     left tip                      right tip
//!        ╲__                          __╱          ◀── travel
//!           ╲          ○ (0, d/2)    ╱
//!            ╲__                  __╱
//!               ╲______seat______╱       root
//!                                          + wheel centre, far below
//! ```

mod asa;
mod circular;
mod half;
mod iso606;
mod path;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::{ArcSpline, GeometryError, Piece};

/// Fewest teeth of a wheel.
const LEAST_TEETH: u32 = 5;
/// Most teeth of a wheel.
const MOST_TEETH: u32 = 600;

/// Shape of the gap between two teeth.
#[derive(Clone, Debug, PartialEq)]
pub enum ToothForm {
    /// ISO 606: circular seat and convex circular flanks.
    ///
    /// The standard bounds the gap by a minimum and a maximum form; any between is allowed.
    Iso606 {
        /// Where between the two \[–\]: 0 the minimum, 0.5 the middle, 1 the maximum gap.
        gap: f64,
        /// Tip diameter.
        tip: Tip,
        /// Where the seat arc is centred.
        seat: Seat,
    },
    /// ASME B29.1, type II: seat, concave working curve, short flat, convex topping curve.
    AsaTypeII {
        /// Tip diameter. `Mid` is the standard turned diameter p (0.6 + cot(π/z)), `Maximum` the
        /// pointed tooth, `Minimum` the lower bound of ISO 606 for the same chain.
        tip: Tip,
    },
    /// Circular seat with straight flanks tangent to it, for comparison with simpler models.
    ///
    /// The flanks leave the seat where those of the maximum ISO gap do: 60° − 45°/z from its
    /// lowest point.
    Circular {
        /// Seat radius \[m\], at least that of the roller.
        seat_radius: f64,
        /// Tip diameter, between the bounds of ISO 606.
        tip: Tip,
        /// Where the seat arc is centred.
        seat: Seat,
    },
    /// The user's own pieces in the gap frame, from right to left.
    Path {
        /// Must run from the right tooth centre line to the left one at equal radius.
        pieces: Vec<Piece>,
    },
}

/// Tip diameter of a wheel, between the bounds of its form.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Tip {
    /// The smallest the standard allows.
    Minimum,
    /// Half way.
    #[default]
    Mid,
    /// The largest the standard allows.
    Maximum,
    /// A diameter \[m\].
    Diameter(f64),
}

/// Where the seat arc, slightly larger than the roller, is centred.
///
/// This decides about the pretension of a chain. Centred on the pitch circle, the seat lets a
/// roller sink by r_i − d₁/2 before it touches, so the chain runs on a smaller polygon and a loop
/// loses about 2π (r_i − d₁/2) of stretch: a few millimetres in a large drive, which may be all
/// the pretension there is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Seat {
    /// On the pitch circle, the usual drawing; the gap is deeper than its nominal root diameter.
    Pitch,
    /// So that a roller on the bottom sits exactly on the pitch circle: the root diameter is
    /// d − d₁, which is what ISO 606 prescribes.
    #[default]
    Bottom,
}

/// One tooth gap with its dimensions.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ToothGap {
    /// Number of teeth z.
    pub teeth: u32,
    /// Pitch p of the chain \[m\].
    pub pitch: f64,
    /// Roller diameter d₁ \[m\].
    pub roller_diameter: f64,
    /// Radius of the pitch circle d/2 \[m\], d = p / sin(π/z).
    pub pitch_radius: f64,
    /// Smallest distance of the gap from the wheel centre \[m\].
    pub root_radius: f64,
    /// Largest distance of the gap from the wheel centre \[m\].
    pub tip_radius: f64,
    /// Seat radius less roller radius, r_i − d₁/2 \[m\]; zero where a path has no seat arc.
    pub seat_clearance: f64,
    /// Whether the flanks meet below the tip circle asked for, which is then lowered to the point.
    pub pointed: bool,
    pieces: Vec<Piece>,
}

/// Dimensions from which every form starts.
#[derive(Clone, Copy, Debug)]
struct Wheel {
    teeth: u32,
    /// z as a number \[–\].
    z: f64,
    /// Half the pitch angle π/z \[rad\].
    half_angle: f64,
    pitch: f64,
    roller_diameter: f64,
    pitch_radius: f64,
}

/// Dimensions to which every form comes.
#[derive(Clone, Debug)]
struct Drawing {
    pieces: Vec<Piece>,
    root_radius: f64,
    tip_radius: f64,
    seat_clearance: f64,
    pointed: bool,
}

impl ToothGap {
    /// Gap of a wheel with `teeth` teeth for a chain of this pitch \[m\] and roller diameter \[m\].
    ///
    /// A flank that reaches the tooth's centre line below the tip circle asked for makes a pointed
    /// tooth: the tip circle is lowered to the point and [`pointed`](Self::pointed) is set.
    ///
    /// Below 5 teeth the flat of the American form vanishes and the ISO angles lose their meaning;
    /// all forms are tested up to 600. The standards themselves speak of 9 to 150 teeth.
    ///
    /// # Errors
    /// Fewer than 5 or more than 600 teeth; lengths that are not finite and positive; a roller
    /// not smaller than the pitch; a form that cannot be drawn with these numbers.
    pub fn new(
        teeth: u32,
        pitch: f64,
        roller_diameter: f64,
        form: &ToothForm,
    ) -> Result<Self, GeometryError> {
        let wheel = Wheel::new(teeth, pitch, roller_diameter)?;
        let drawing = match form {
            ToothForm::Iso606 { gap, tip, seat } => iso606::draw(&wheel, *gap, *tip, *seat),
            ToothForm::AsaTypeII { tip } => asa::draw(&wheel, *tip),
            ToothForm::Circular {
                seat_radius,
                tip,
                seat,
            } => circular::draw(&wheel, *seat_radius, *tip, *seat),
            ToothForm::Path { pieces } => path::draw(&wheel, pieces),
        }?;
        Ok(Self {
            teeth,
            pitch,
            roller_diameter,
            pitch_radius: wheel.pitch_radius,
            root_radius: drawing.root_radius,
            tip_radius: drawing.tip_radius,
            seat_clearance: drawing.seat_clearance,
            pointed: drawing.pointed,
            pieces: drawing.pieces,
        })
    }

    /// The pieces of the gap in its own frame, from right to left.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The whole wheel: gap k turned by 2πk/z, as a closed curve about the origin.
    ///
    /// # Errors
    /// Those of [`ArcSpline::closed`], which a gap made by [`ToothGap::new`] does not provoke.
    pub fn outline(&self) -> Result<ArcSpline, GeometryError> {
        let pieces: Vec<_> = (0..self.teeth)
            .flat_map(|k| {
                let angle = self.gap_axis(k) - FRAC_PI_2;
                self.pieces.iter().map(move |piece| piece.rotated(angle))
            })
            .collect();
        ArcSpline::closed(&pieces)
    }

    /// Pressure angle γ where the flank leaves the seat \[rad\]: between the line from roller to roller and the normal of the tooth.
    ///
    /// ```text
    /// γ = π/2 − π/z − β,   β: half the angle of the seat arc
    /// ```
    ///
    /// None where no arc of its own makes the bottom of the gap, or the arc is all of it.
    pub fn pressure_angle(&self) -> Option<f64> {
        let bottom = self
            .pieces
            .iter()
            .enumerate()
            .find_map(|(at, piece)| match piece {
                Piece::Arc(arc) if arc.sweep < 0.0 && arc.centre.x.abs() < 1e-9 * self.pitch => {
                    Some((at, arc))
                }
                _ => None,
            });
        let (at, arc) = bottom?;
        let whole = at == 0 || at + 1 == self.pieces.len();
        let beta = 0.5 * arc.sweep.abs();
        let half = PI / f64::from(self.teeth);
        (!whole && self.seat_clearance > 0.0).then_some(FRAC_PI_2 - half - beta)
    }

    /// Direction of the axis of gap k in the frame of the wheel \[rad\]: π/2 + 2πk/z.
    pub fn gap_axis(&self, k: u32) -> f64 {
        FRAC_PI_2 + TAU * f64::from(k) / f64::from(self.teeth)
    }
}

impl Wheel {
    fn new(teeth: u32, pitch: f64, roller_diameter: f64) -> Result<Self, GeometryError> {
        if !(LEAST_TEETH..=MOST_TEETH).contains(&teeth) {
            return Err(GeometryError::Teeth {
                teeth,
                least: LEAST_TEETH,
                most: MOST_TEETH,
            });
        }
        GeometryError::positive("pitch of a chain [m]", pitch)?;
        GeometryError::positive("roller diameter [m]", roller_diameter)?;
        if roller_diameter >= pitch {
            return Err(GeometryError::OutOfRange {
                what: "roller diameter [m]",
                value: roller_diameter,
                allowed: "smaller than the pitch",
            });
        }
        let z = f64::from(teeth);
        let half_angle = PI / z;
        Ok(Self {
            teeth,
            z,
            half_angle,
            pitch,
            roller_diameter,
            // d = p / sin(π/z)
            pitch_radius: 0.5 * pitch / half_angle.sin(),
        })
    }

    /// Height of the seat centre above the wheel centre \[m\].
    fn seat_height(&self, seat: Seat, seat_radius: f64) -> f64 {
        match seat {
            Seat::Pitch => self.pitch_radius,
            Seat::Bottom => self.pitch_radius + (seat_radius - 0.5 * self.roller_diameter),
        }
    }

    /// Tip diameters allowed by ISO 606, least and most \[m\].
    fn iso_tip_diameters(&self) -> (f64, f64) {
        // d_a,min = d + p (1 − 1.6/z) − d₁,   d_a,max = d + 1.25 p − d₁
        let base = 2.0 * self.pitch_radius - self.roller_diameter;
        (
            base + self.pitch * (1.0 - 1.6 / self.z),
            base + 1.25 * self.pitch,
        )
    }

    /// Refuses a length of the drawing that makes no tooth.
    fn refuse(&self, what: &'static str, value: f64, allowed: String) -> GeometryError {
        GeometryError::ToothForm {
            teeth: self.teeth,
            what,
            value,
            allowed,
        }
    }
}

impl Tip {
    /// The tip radius asked for \[m\], with the diameters that minimum, mid and maximum stand for.
    fn radius(self, minimum: f64, mid: f64, maximum: f64) -> Result<f64, GeometryError> {
        let diameter = match self {
            Self::Minimum => minimum,
            Self::Mid => mid,
            Self::Maximum => maximum,
            Self::Diameter(diameter) => {
                GeometryError::positive("tip diameter [m]", diameter)?;
                diameter
            }
        };
        Ok(0.5 * diameter)
    }
}
