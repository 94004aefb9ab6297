//! Polygon action: exact kinematics of a chain that runs over sprockets as a polygon.
//!
//! A taut span of n links between the last roller seated on one sprocket and the first on the
//! other is the coupler of a four-bar linkage O₁ A B O₂. While the driver turns through one tooth,
//! one roller seats on it (n falls by one) and one roller lifts off the driven wheel (n grows by
//! one), so that the linkage is replaced twice in a period. At both events the speed ratio is
//! continuous and its rate jumps.
//!
//! ```text
//!            span of n links, direction ψ
//!        A ←─────────────────────────────── B
//!       ╱ φ_A                            φ_B ╲
//!     O₁ ───────────────── C ───────────────── O₂
//! ```
//!
//! The frame has its x axis from the driver's centre O₁ to the driven one O₂. The driver turns
//! counter-clockwise and pulls the upper span. Angles φ are those of a seat past the normal of the
//! span, positive counter-clockwise; on both wheels −π/z ≤ φ ≤ π/z. Everything is periodic in the
//! driver's angle θ₁ with 2π/z₁, but for the angle of the driven wheel, which advances by 2π/z₂.
//!
//! # Source
//! Own closed form. On the theory see N. Fuglede and J. J. Thomsen, *Mech. Mach. Theory* **100**,
//! 2016, 17–32.

use std::f64::consts::{FRAC_PI_2, PI};

use self::extremes::bisect;
use crate::closing::Lattice;
use crate::route::check_teeth;
use crate::{GeometryError, Point, Side, Vector, Wheel};

mod chordal_action;
mod extremes;

pub use chordal_action::{ChordalAction, PressureAngles, mesh_frequency};

/// Polygon action of an open drive: two sprockets on the same side of the chain, upper span tight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolygonAction {
    teeth: [u32; 2],
    pitch: f64,
    centre_distance: f64,
    radii: [f64; 2],
    /// Angle of the driver's seat A just after seating \[rad\].
    seated_driver: f64,
    /// Angle of the driven wheel's seat B at that moment \[rad\].
    seated_driven: f64,
    /// Links in the span just after seating.
    seated_links: u32,
    /// Driver angle from seating to lift-off at the driven wheel \[rad\], in [0, 2π/z₁].
    lift_off: f64,
}

/// State of the drive at one angle of its driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenState {
    /// Angle θ₂ of the driven wheel since the seating at θ₁ = 0 \[rad\].
    pub angle: f64,
    /// Speed ratio ω₂/ω₁ \[–\], z₁/z₂ in the mean.
    pub ratio: f64,
    /// Its rate d(ω₂/ω₁)/dθ₁ \[1/rad\]; on a constant driver α₂ = ω₁² times it.
    pub ratio_rate: f64,
    /// Direction ψ of the span from A to B against the line of centres \[rad\].
    pub span_angle: f64,
    /// Rate dψ/dθ₁ of the span's rotation \[–\].
    pub span_rate: f64,
    /// Number n of links in the span \[–\].
    pub links: u32,
    /// Angle φ_A of seat A past the normal of the span \[rad\].
    pub driver_seat: f64,
    /// Angle φ_B of seat B past the normal of the span \[rad\].
    pub driven_seat: f64,
}

/// Relative velocity of a roller at its seat on the driver, see [`PolygonAction::seating_velocity`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeatingVelocity {
    /// Speed of the roller relative to its seat, divided by p ω₁ \[–\].
    pub relative: f64,
    /// Rate dψ/dθ₁ of the span's rotation just before \[–\].
    pub span_rate: f64,
    /// Angle φ_B of the seat at the driven wheel just before \[rad\].
    pub driven_seat: f64,
    /// Number of links in the span just before \[–\].
    pub links: u32,
}

/// The linkage while n does not change: what it takes to evaluate it.
struct Linkage {
    links: u32,
    /// Angle of seat A at θ₁ = 0 \[rad\].
    driver: f64,
    /// Angle of the driven wheel between this linkage's B and the one just after seating \[rad\].
    turned: f64,
}

impl PolygonAction {
    /// A drive of z₁ driving and z₂ driven teeth, pitch p \[m\] and centre distance C \[m\].
    ///
    /// With the seats at φ_A and φ_B, the components of B − A across and along the span read
    ///
    /// ```text
    /// C sin ψ = R₂ cos φ_B − R₁ cos φ_A
    /// n p     = C cos ψ − R₂ sin φ_B + R₁ sin φ_A
    /// ```
    ///
    /// At seating φ_A = −π/z₁; of all n just one leaves φ_B between −π/z₂ and π/z₂, because the
    /// window is one pitch wide.
    ///
    /// # Errors
    /// Numbers that are not finite and positive; fewer than three teeth; sprockets that overlap;
    /// centres so close that no whole link is left in the span.
    pub fn new(
        driver_teeth: u32,
        driven_teeth: u32,
        pitch: f64,
        centre_distance: f64,
    ) -> Result<Self, GeometryError> {
        let teeth = [driver_teeth, driven_teeth];
        for z in teeth {
            check_teeth(z)?;
        }
        GeometryError::positive("pitch [m]", pitch)?;
        GeometryError::positive("centre distance [m]", centre_distance)?;
        // R = p / (2 sin(π/z))
        let radii = teeth.map(|z| 0.5 * pitch / (PI / f64::from(z)).sin());
        let least = radii[0] + radii[1];
        if centre_distance <= least {
            let (first, second, distance) = (0, 1, centre_distance);
            return Err(GeometryError::WheelsOverlap {
                first,
                second,
                distance,
                least,
            });
        }
        let mut drive = Self {
            teeth,
            pitch,
            centre_distance,
            radii,
            seated_driver: 0.0,
            seated_driven: 0.0,
            seated_links: 0,
            lift_off: 0.0,
        };
        drive.find_events()?;
        Ok(drive)
    }

    /// Half pitch angles π/z₁, π/z₂.
    fn half(&self) -> [f64; 2] {
        self.teeth.map(|z| PI / f64::from(z))
    }

    /// Span angle and length for given seats, by the two equations of [`new`](Self::new).
    fn span(&self, [a, b]: [f64; 2]) -> (f64, f64) {
        let [r1, r2] = self.radii;
        // C sin ψ = R₂ cos φ_B − R₁ cos φ_A
        let angle = ((r2 * b.cos() - r1 * a.cos()) / self.centre_distance).asin();
        // n p = C cos ψ − R₂ sin φ_B + R₁ sin φ_A
        (
            angle,
            self.centre_distance * angle.cos() - r2 * b.sin() + r1 * a.sin(),
        )
    }

    /// Finds the seating and the lift-off that begin and divide a period.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a count of links, checked"
    )]
    fn find_events(&mut self) -> Result<(), GeometryError> {
        let [h1, h2] = self.half();
        let (_, longest) = self.span([-h1, -h2]);
        // Where lift-off falls together with seating it has happened: rounding must not undo it.
        let links = (longest / self.pitch + 1e-9).floor();
        if links < 1.0 {
            let (what, value) = ("centre distance [m]", self.centre_distance);
            return Err(GeometryError::OutOfRange {
                what,
                value,
                allowed: "long enough for one free link",
            });
        }
        self.seated_links = links as u32;
        let length = links * self.pitch;
        let driven_seat = bisect(-h2, h2, |b| length - self.span([-h1, b]).1);
        let (span_angle, _) = self.span([-h1, driven_seat]);
        self.seated_driver = span_angle + FRAC_PI_2 - h1;
        self.seated_driven = span_angle + FRAC_PI_2 + driven_seat;

        // Lift-off: φ_B = π/z₂ with the same n, φ_A anywhere in its window.
        let driver_seat = bisect(-h1, h1, |a| self.span([a, h2]).1 - length);
        let (lifting, _) = self.span([driver_seat, h2]);
        self.lift_off = (driver_seat + h1 + lifting - span_angle).clamp(0.0, 2.0 * h1);
        Ok(())
    }

    /// State of the driven wheel when the driver has turned by θ₁ \[rad\] since a seating.
    ///
    /// At a seating and at a lift-off the state just after it. Any real angle; not finite in,
    /// not finite out.
    ///
    /// ```text
    /// ω₂/ω₁  = R₁ cos φ_A / (R₂ cos φ_B)
    /// dψ/dθ₁ = (R₁ sin φ_A − R₂ (ω₂/ω₁) sin φ_B) / (n p)
    /// d(ω₂/ω₁)/dθ₁ = (ω₂/ω₁) (tan φ_B dφ_B/dθ₁ − tan φ_A dφ_A/dθ₁),   dφ/dθ₁ = ω/ω₁ − dψ/dθ₁
    /// ```
    pub fn driven(&self, driver_angle: f64) -> DrivenState {
        let [h1, h2] = self.half();
        let tooth = (driver_angle / (2.0 * h1)).floor();
        let within = driver_angle - tooth * 2.0 * h1;
        let mut state = self.after_seating(within);
        state.angle += tooth * 2.0 * h2;
        state
    }

    /// State in the first period, by the linkage that holds there.
    fn after_seating(&self, within: f64) -> DrivenState {
        let lifted = within >= self.lift_off;
        let turned = if lifted { 2.0 * self.half()[1] } else { 0.0 };
        let links = self.seated_links + u32::from(lifted);
        self.evaluate(
            &Linkage {
                links,
                driver: self.seated_driver,
                turned,
            },
            within,
        )
    }

    fn evaluate(&self, linkage: &Linkage, within: f64) -> DrivenState {
        let [r1, r2] = self.radii;
        let length = f64::from(linkage.links) * self.pitch;
        let a = linkage.driver + within;
        // D = O₂ − A;  |D + R₂ e^{iβ}| = n p, upper of the two solutions
        let line = Vector::new(self.centre_distance - r1 * a.cos(), -r1 * a.sin());
        let reach = line.norm();
        let cosine = (length * length - reach * reach - r2 * r2) / (2.0 * r2 * reach);
        let b = line.y.atan2(line.x) + cosine.acos();
        let span = line + r2 * Vector::new(b.cos(), b.sin());
        let span_angle = span.y.atan2(span.x);

        let driver_seat = a - span_angle - FRAC_PI_2;
        let driven_seat = b - span_angle - FRAC_PI_2;
        // ω₂/ω₁ = R₁ cos φ_A / (R₂ cos φ_B)
        let ratio = r1 * driver_seat.cos() / (r2 * driven_seat.cos());
        // dψ/dθ₁ = (R₁ sin φ_A − R₂ (ω₂/ω₁) sin φ_B) / (n p)
        let span_rate = (r1 * driver_seat.sin() - r2 * ratio * driven_seat.sin()) / length;
        // d(ω₂/ω₁)/dθ₁ = (ω₂/ω₁) (tan φ_B dφ_B/dθ₁ − tan φ_A dφ_A/dθ₁),   dφ/dθ₁ = ω/ω₁ − dψ/dθ₁
        let ratio_rate = ratio
            * (driven_seat.tan() * (ratio - span_rate) - driver_seat.tan() * (1.0 - span_rate));
        DrivenState {
            angle: b + linkage.turned - self.seated_driven,
            ratio,
            ratio_rate,
            span_angle,
            span_rate,
            links: linkage.links,
            driver_seat,
            driven_seat,
        }
    }

    /// Transmission error θ₂ − θ₁ z₁/z₂ at a driver angle θ₁ \[rad\], zero at every seating.
    pub fn transmission_error(&self, driver_angle: f64) -> f64 {
        self.driven(driver_angle).angle - self.mean_ratio() * driver_angle
    }

    /// Mean speed ratio z₁/z₂ \[–\].
    pub fn mean_ratio(&self) -> f64 {
        f64::from(self.teeth[0]) / f64::from(self.teeth[1])
    }

    /// Driver angle from a seating on the driver to the lift-off at the driven wheel \[rad\], in [0, 2π/z₁].
    pub fn lift_off(&self) -> f64 {
        self.lift_off
    }

    /// Pitch p \[m\].
    pub fn pitch(&self) -> f64 {
        self.pitch
    }

    /// Pitch radii of driver and driven wheel \[m\].
    pub fn radii(&self) -> [f64; 2] {
        self.radii
    }

    /// Length \[pitches\] of a taut loop around both sprockets when the driven one follows the upper span.
    ///
    /// Rollers sit in all gaps that the loop covers; the lower span is as long as it comes out. What a
    /// chain of whole links has more than this it carries as slack, what it has less it takes as stretch.
    /// `phase` is the driver angle since a seating in units of its pitch angle \[–\].
    ///
    /// # Errors
    /// A phase that is not finite.
    pub fn wrapping_length(&self, phase: f64) -> Result<f64, GeometryError> {
        GeometryError::finite("tooth phase", phase)?;
        let [h1, h2] = self.half();
        let state = self.driven(phase.rem_euclid(1.0) * 2.0 * h1);
        // The loop runs counter-clockwise: it arrives at the driver's seat A above, leaves below, and
        // leaves the driven wheel at B above.
        let up = state.span_angle + FRAC_PI_2;
        let wheel = |x, teeth| Wheel::toothed(Point::new(x, 0.0), teeth, self.pitch, Side::Left);
        let wheels = [
            wheel(0.0, self.teeth[0]),
            wheel(self.centre_distance, self.teeth[1]),
        ];
        let driver = Lattice {
            wheel: &wheels[0],
            half: h1,
            origin: up + state.driver_seat,
        };
        let driven = Lattice {
            wheel: &wheels[1],
            half: h2,
            origin: up + state.driven_seat,
        };

        // Nearly the mirror image of the upper span; the right seats are next to where that one ends.
        let leaving = driver.ordinal(-state.span_angle);
        let arriving = driven.ordinal(-state.span_angle) - i64::from(self.teeth[1]);
        let unreachable = GeometryError::NoSeat { from: 0, to: 1 };
        let (leaves, arrives) = driver.join(&driven, leaving, arriving).ok_or(unreachable)?;
        let lower = (driven.at(arrives) - driver.at(leaves)).norm() / self.pitch;
        // n + k₁ + k₂ + lower span
        Ok(f64::from(state.links) + (leaves - arrives) as f64 + lower)
    }

    /// Speed at which the next roller meets its seat on the driver, from the limit just before.
    ///
    /// ```text
    /// v_rel = p (ω₁ − dψ/dt)
    /// ```
    pub fn seating_velocity(&self) -> SeatingVelocity {
        let [h1, h2] = self.half();
        // If lift-off coincides with seating, it is still to come.
        let lifted = self.lift_off < 2.0 * h1 * (1.0 - 1e-9);
        let linkage = Linkage {
            links: self.seated_links + u32::from(lifted),
            driver: self.seated_driver,
            turned: if lifted { 2.0 * h2 } else { 0.0 },
        };
        let before = self.evaluate(&linkage, 2.0 * h1);
        SeatingVelocity {
            // v_rel / (p ω₁) = 1 − dψ/dθ₁
            relative: 1.0 - before.span_rate,
            span_rate: before.span_rate,
            driven_seat: before.driven_seat,
            links: before.links,
        }
    }
}
