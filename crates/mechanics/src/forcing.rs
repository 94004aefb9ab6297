//! Periods of the forcing of a drive, and its functions of time.

use std::f64::consts::TAU;

use crate::assembly::Assembled;
use crate::drive::{GuideSupport, Layout, Rotation, Shaft, Stop, Support};
use crate::order::Order;
use crate::torque::Argument;
use crate::{End, Ends, Motion, Torque};

/// Orders of a table that are looked at, points by which, and share of the greatest amplitude below which one does not count. *Assumed*: cams that
/// are drawn seven times a turn to a tenth of a degree have no order below the seventh.
const MOST_ORDERS: u32 = 64;
const POINTS: u32 = 720;
const COUNTS: f64 = 0.01;

impl Assembled {
    /// Period \[s\] of the slowest of all that is known to repeat: teeth that pass, orders and tables of shafts at their mean speeds, harmonic
    /// motions. Infinite where nothing does, or a shaft that counts stands still.
    ///
    /// Faster forcings need not fit into it: orders 4 and 7 of a shaft repeat together with its turn only.
    pub fn slowest_forcing(&self) -> f64 {
        let speeds = self.mean_speeds();
        let wheels = &self.system.bodies.wheels;
        let shafts = self.shaft_speeds();
        let of_shaft = |shaft: usize| {
            let on_it = wheels.iter().position(|wheel| wheel.shaft == shaft);
            let present = on_it.map_or(0.0, |wheel| speeds[wheel]);
            shafts[shaft].unwrap_or(present)
        };
        let mut slowest: f64 = 0.0;
        let mut repeats = |period: f64| slowest = slowest.max(period.abs());
        repeats(self.slowest_tooth());
        for motion in self.motions() {
            periods(motion, &mut repeats);
        }
        for (shaft, it) in self.drive.shafts.iter().enumerate() {
            for torque in it.torques() {
                let turning = of_shaft(torque.follows().unwrap_or(shaft));
                match torque {
                    Torque::Orders { terms, .. } => {
                        for order in terms {
                            period(order, turning, &mut repeats);
                        }
                    }
                    Torque::Table {
                        over: Argument::Angle { turns, .. },
                        curve,
                    } => {
                        let whole = f64::from(*turns) * TAU;
                        let order = lowest_order(whole, |angle| curve.polyline(angle));
                        repeats(whole / (order * turning));
                    }
                    _ => {}
                }
            }
        }
        if slowest > 0.0 {
            slowest
        } else {
            f64::INFINITY
        }
    }

    /// Time \[s\] in which a tooth passes, of the slowest chain; 0 where none runs around sprockets, infinite where it stands still.
    pub fn slowest_tooth(&self) -> f64 {
        let speeds = self.mean_speeds();
        let routes = self.drive.chains.iter().filter_map(|it| match &it.layout {
            Layout::Route { stops, .. } => Some(stops),
            Layout::Points { .. } => None,
        });
        let wheels = routes.flatten().filter_map(|stop| match stop {
            Stop::Sprocket(wheel) => Some(*wheel),
            Stop::Guide(_) => None,
        });
        let teeth = |wheel: usize| f64::from(self.system.bodies.wheels[wheel].teeth);
        wheels
            .map(|wheel| (TAU / (teeth(wheel) * speeds[wheel])).abs())
            .fold(0.0, f64::max)
    }

    /// Shortest time \[s\] between two teeth of a sprocket at its mean speed; infinite where none turns.
    pub fn fastest_tooth(&self) -> f64 {
        let speeds = self.mean_speeds();
        let wheels = self.system.bodies.wheels.iter().zip(speeds);
        // t = 2π/(z ω)
        wheels
            .map(|(wheel, speed)| (TAU / (f64::from(wheel.teeth) * speed)).abs())
            .fold(f64::INFINITY, f64::min)
    }

    /// In words, the first thing that acts as a function of time, such as a ramp: its times are those of the record, and a run-in without a
    /// set length would move it. None where all that acts repeats with the turns of a shaft, or stays.
    pub fn function_of_time(&self) -> Option<&'static str> {
        let of_torque = |torque: &Torque| match torque {
            Torque::Ramp { .. } => Some("a torque that is switched on at a time"),
            Torque::Table {
                over: Argument::Time,
                ..
            } => Some("a torque over time"),
            _ => None,
        };
        let mut torques = self.drive.shafts.iter().flat_map(Shaft::torques);
        let motion = self.motions().find_map(of_time);
        motion.or_else(|| torques.find_map(of_torque))
    }

    /// In words, why the motion of this drive need not come to repeat itself: a chain has ends, is driven by no motion, or by one that is a function of
    /// time. None where it can.
    pub fn why_it_does_not_repeat(&self) -> Option<&'static str> {
        let chains = &self.drive.chains;
        if chains
            .iter()
            .any(|it| matches!(it.chain.ends, Ends::Open(_)))
        {
            return Some("a chain has ends");
        }
        if let Some(why) = self.function_of_time() {
            return Some(why);
        }
        let shafts = self.shaft_speeds();
        let wheels = &self.system.bodies.wheels;
        let turns = |wheel: &usize| shafts[wheels[*wheel].shaft].is_some_and(|it| it != 0.0);
        let members = &self.system.chains;
        if members.is_empty() || members.iter().any(|it| !it.route.iter().any(turns)) {
            return Some(
                "no motion turns a sprocket of a chain; where torques do, take --run-in auto",
            );
        }
        let stands = !self.slowest_forcing().is_finite();
        stands.then_some("a shaft whose turns something follows stands still")
    }

    /// Every motion that is prescribed.
    fn motions(&self) -> impl Iterator<Item = &Motion> {
        let drive = &self.drive;
        let shafts = drive.shafts.iter().filter_map(|it| match &it.rotation {
            Rotation::Prescribed(motion) => Some([Some(motion), None]),
            Rotation::Free { .. } => None,
        });
        let centres = drive.sprockets.iter().filter_map(|it| match &it.support {
            Support::Prescribed { x, y } => Some([Some(x), Some(y)]),
            _ => None,
        });
        let guides = drive.guides.iter().filter_map(|it| match &it.support {
            GuideSupport::Prescribed { x, y } => Some([Some(x), Some(y)]),
            _ => None,
        });
        let strands = drive.chains.iter().filter_map(|it| match &it.chain.ends {
            Ends::Open(ends) => Some(ends),
            Ends::Closed => None,
        });
        let ends = strands.flatten().filter_map(|end| match end {
            End::Driven { x, y } => Some([Some(x), Some(y)]),
            _ => None,
        });
        let all = shafts.chain(centres).chain(guides).chain(ends);
        all.flatten().flatten()
    }
}

/// Tells the periods of a motion \[s\].
fn periods(motion: &Motion, repeats: &mut impl FnMut(f64)) {
    match motion {
        Motion::Orders { turning, terms, .. } => {
            for order in terms {
                period(order, *turning, repeats);
            }
        }
        Motion::Harmonics { terms, .. } => {
            let swinging = terms
                .iter()
                .filter(|it| it.amplitude != 0.0 && it.frequency > 0.0);
            swinging.for_each(|it| repeats(1.0 / it.frequency));
        }
        Motion::From { motion, .. } => periods(motion, repeats),
        Motion::Held
        | Motion::Constant { .. }
        | Motion::Ramp { .. }
        | Motion::Table(_)
        | Motion::Onward(_) => {}
    }
}

/// Tells the period of an order of a shaft of some speed \[rad/s\].
fn period(order: &Order, turning: f64, repeats: &mut impl FnMut(f64)) {
    if order.amplitude != 0.0 && order.order != 0.0 {
        repeats(TAU / (order.order * turning));
    }
}

/// The lowest order of a curve over a whole that counts.
///
/// ```text
/// cₖ = |Σ f(x) exp(−2πi k x)|,   k the least with cₖ ≥ 1 % of the greatest
/// ```
fn lowest_order(whole: f64, curve: impl Fn(f64) -> f64) -> f64 {
    let points: Vec<f64> = (0..POINTS)
        .map(|i| curve(whole * f64::from(i) / f64::from(POINTS)))
        .collect();
    let amplitude = |order: u32| {
        let turns = (0..POINTS).map(|i| TAU * f64::from(order * i % POINTS) / f64::from(POINTS));
        let parts = turns
            .zip(&points)
            .map(|(at, f)| [f * at.cos(), f * at.sin()]);
        let [re, im] = parts.fold([0.0; 2], |[re, im], [c, s]| [re + c, im + s]);
        re.hypot(im)
    };
    let amplitudes: Vec<f64> = (1..=MOST_ORDERS).map(amplitude).collect();
    let counts = COUNTS * amplitudes.iter().copied().fold(0.0, f64::max);
    let lowest = amplitudes.iter().position(|it| *it > 0.0 && *it >= counts);
    lowest.map_or(1.0, |at| (at + 1) as f64)
}

fn of_time(motion: &Motion) -> Option<&'static str> {
    match motion {
        Motion::Ramp { .. } => Some("a speed that changes at a time"),
        Motion::Harmonics { .. } => Some("a motion by frequencies"),
        Motion::Table(_) => Some("a motion over time"),
        Motion::From { motion, .. } => of_time(motion),
        Motion::Held | Motion::Constant { .. } | Motion::Orders { .. } | Motion::Onward(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_order_of_a_table_is_found() {
        let lobes = |n: f64| move |angle: f64| 5.0 + (n * angle).sin().max(0.0);
        for (curve, order) in [(lobes(1.0), 1.0), (lobes(7.0), 7.0), (lobes(2.0), 2.0)] {
            assert!((lowest_order(TAU, curve) - order).abs() < 1e-12);
        }
        let uneven = |angle: f64| (4.0 * angle).sin() + 0.02 * angle.cos();
        assert!((lowest_order(TAU, uneven) - 1.0).abs() < 1e-12);
        assert!((lowest_order(TAU, |_| 3.0) - 1.0).abs() < 1e-12);
    }
}
