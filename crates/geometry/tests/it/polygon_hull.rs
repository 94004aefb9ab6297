//! Polygon action against itself and against a convex hull.
//!
//! The hull of all pins of both wheels knows nothing of linkages, windows or link counts: the chain
//! over its upper bridge must keep its length while the wheels turn.

#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "test code outside of test functions"
)]

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use chaindrive_geometry::{DrivenState, Point, PolygonAction, Vector};

/// Largest deviation from a reference, for the report.
struct Deviation {
    what: String,
    tolerance: f64,
    worst: f64,
}

impl Deviation {
    fn new(what: impl Into<String>, tolerance: f64) -> Self {
        Self {
            what: what.into(),
            tolerance,
            worst: 0.0,
        }
    }

    #[track_caller]
    fn note(&mut self, got: f64, expected: f64) {
        let error = (got - expected).abs();
        let what = &self.what;
        assert!(
            error <= self.tolerance,
            "{what}: got {got}, expected {expected}, off by {error:e}"
        );
        self.worst = self.worst.max(error);
    }
}

impl Drop for Deviation {
    fn drop(&mut self) {
        println!(
            "{}: largest deviation {:.1e}, allowed {:.0e}",
            self.what, self.worst, self.tolerance
        );
    }
}

/// Drives of many proportions: rates are derivatives, seats stay in their windows, periods join.
#[test]
fn linkage_is_consistent() {
    let mut ratio = Deviation::new("ratio against differences of the angle", 1e-7);
    let mut rate = Deviation::new("rate against differences of the ratio", 1e-6);
    let mut joints = Deviation::new("continuity over events and periods", 1e-11);
    for (z1, z2, centres) in drives() {
        let drive = PolygonAction::new(z1, z2, 1.0, centres).unwrap();
        let (h1, h2) = (PI / f64::from(z1), PI / f64::from(z2));
        let period = 2.0 * h1;
        for i in 0..97 {
            let at = period * (f64::from(i) + 0.37) / 97.0;
            let state = drive.driven(at);
            assert!(state.driver_seat.abs() <= h1 + 1e-12 && state.driven_seat.abs() <= h2 + 1e-12);
            let step = 1e-5 * period;
            if (at - drive.lift_off()).abs() < 2.0 * step {
                continue;
            }
            let (before, behind) = (drive.driven(at - step), drive.driven(at + step));
            let slope = |f: fn(&DrivenState) -> f64| (f(&behind) - f(&before)) / (2.0 * step);
            ratio.note(slope(|s| s.angle), state.ratio);
            rate.note(slope(|s| s.ratio), state.ratio_rate);
            let next = drive.driven(at + period);
            joints.note(next.angle - state.angle, 2.0 * h2);
            joints.note(
                drive.transmission_error(at + 5.0 * period),
                drive.transmission_error(at),
            );
        }
        for event in [period, drive.lift_off()] {
            let (before, behind) = (drive.driven(event - 1e-13), drive.driven(event + 1e-13));
            joints.note(before.angle, behind.angle);
            joints.note(before.ratio, behind.ratio);
            joints.note(before.span_angle, behind.span_angle);
        }
        let (least, most) = drive.ratio_extremes();
        for i in 0..500 {
            let ratio = drive.driven(period * f64::from(i) / 500.0).ratio;
            assert!((least - 1e-13..=most + 1e-13).contains(&ratio));
        }
    }
}

/// All pins of both wheels and their convex hull know nothing of linkages, windows or link counts.
#[test]
fn hull_of_all_pins_agrees() {
    let mut angle = Deviation::new("driven angle against the hull", 1e-12);
    let mut length = Deviation::new("wrapping length against the hull", 1e-11);
    for (z1, z2, centres) in drives() {
        let drive = PolygonAction::new(z1, z2, 1.0, centres).unwrap();
        let start = drive.driven(0.0);
        let seats =
            [start.driver_seat, start.driven_seat].map(|seat| start.span_angle + FRAC_PI_2 + seat);
        let pins = |turned: [f64; 2]| Pins {
            teeth: [z1, z2],
            centres,
            angles: [seats[0] + turned[0], seats[1] + turned[1]],
        };
        let constant = pins([0.0, 0.0]).upper_length();
        for i in 0..24 {
            let turned = TAU / f64::from(z1) * f64::from(i) / 24.0;
            // Turning the driven wheel by half a tooth either way brackets the taut position.
            let middle = drive.mean_ratio() * turned;
            let (mut low, mut high) = (middle - PI / f64::from(z2), middle + PI / f64::from(z2));
            let rising = pins([turned, low]).upper_length() < pins([turned, high]).upper_length();
            for _ in 0..60 {
                let trial = 0.5 * (low + high);
                let above = pins([turned, trial]).upper_length() > constant;
                if above == rising {
                    high = trial;
                } else {
                    low = trial;
                }
            }
            let taut = 0.5 * (low + high);
            angle.note(drive.driven(turned).angle, taut);
            length.note(
                drive.wrapping_length(f64::from(i) / 24.0).unwrap(),
                pins([turned, taut]).perimeter(),
            );
        }
    }
}

/// Tooth counts and centre distances in pitches: equal, up, down, coarse, marine, close together.
fn drives() -> [(u32, u32, f64); 9] {
    [
        (17, 17, 20.5),
        (17, 17, 20.0),
        (9, 9, 6.5),
        (14, 28, 15.163),
        (52, 13, 32.99),
        (23, 45, 19.07),
        (76, 76, 40.5),
        (5, 7, 3.3),
        (19, 57, 12.9),
    ]
}

/// Two rings of pins at unit pitch, pin 0 of each at the given angle.
struct Pins {
    teeth: [u32; 2],
    centres: f64,
    angles: [f64; 2],
}

impl Pins {
    /// Corners of the convex hull, counter-clockwise: point, wheel, angle of the pin not brought into one turn.
    fn hull(&self) -> Vec<(Point, usize, f64)> {
        let mut pins = Vec::new();
        for wheel in 0..2 {
            let step = TAU / f64::from(self.teeth[wheel]);
            let radius = 0.5 / (0.5 * step).sin();
            for i in 0..self.teeth[wheel] {
                let angle = self.angles[wheel] + step * f64::from(i);
                let centre = Point::new(if wheel == 0 { 0.0 } else { self.centres }, 0.0);
                pins.push((
                    centre + radius * Vector::new(angle.cos(), angle.sin()),
                    wheel,
                    angle,
                ));
            }
        }
        pins.sort_by(|a, b| a.0.x.total_cmp(&b.0.x).then(a.0.y.total_cmp(&b.0.y)));
        let half = |pins: &mut dyn Iterator<Item = (Point, usize, f64)>| {
            let mut hull: Vec<(Point, usize, f64)> = Vec::new();
            for pin in pins {
                while let [.., a, b] = hull[..] {
                    if (b.0 - a.0).perp(&(pin.0 - b.0)) > 0.0 {
                        break;
                    }
                    hull.pop();
                }
                hull.push(pin);
            }
            hull.pop();
            hull
        };
        let mut hull = half(&mut pins.iter().copied());
        hull.extend(half(&mut pins.iter().rev().copied()));
        hull
    }

    fn edges(&self) -> Vec<[(Point, usize, f64); 2]> {
        let hull = self.hull();
        (0..hull.len())
            .map(|i| [hull[i], hull[(i + 1) % hull.len()]])
            .collect()
    }

    fn perimeter(&self) -> f64 {
        self.edges().iter().map(|[a, b]| (b.0 - a.0).norm()).sum()
    }

    /// Chain between pin 0 of the driver and pin 0 of the driven wheel over the upper span, but for a constant.
    fn upper_length(&self) -> f64 {
        let [b, a] = *self
            .edges()
            .iter()
            .find(|[from, to]| from.1 == 1 && to.1 == 0)
            .unwrap();
        let ordinal = |pin: (Point, usize, f64)| {
            // Above the line of centres: unwrapped about the top of the wheel.
            let top = (pin.2 - FRAC_PI_2 + PI).rem_euclid(TAU) - PI + FRAC_PI_2;
            ((top - self.angles[pin.1]) / (TAU / f64::from(self.teeth[pin.1]))).round()
        };
        (a.0 - b.0).norm() - ordinal(a) + ordinal(b)
    }
}
