//! Periods of the forcing of a drive, and its functions of time.

use std::f64::consts::TAU;

use crate::action::{Action, Argument};
use crate::assembly::Assembled;
use crate::drive::{GuideSupport, Layout, Rotation, Shaft, Stop, Support};
use crate::order::Forcing;
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
        let periods = self.forcings().into_iter().map(|it| it.period);
        let slowest = periods.fold(self.slowest_tooth(), f64::max);
        if slowest > 0.0 {
            slowest
        } else {
            f64::INFINITY
        }
    }

    /// All that is known to repeat, see [`slowest_forcing`](Self::slowest_forcing): the slowest first, each period once.
    pub fn forcings(&self) -> Vec<Forcing> {
        let speeds = self.mean_speeds();
        let wheels = &self.system.bodies.wheels;
        let given = self.shaft_speeds();
        let mut found: Vec<Forcing> = Vec::new();
        let mut repeats = |shaft: Option<usize>, rate: f64, period: f64| {
            found.push(Forcing {
                shaft,
                rate,
                period: period.abs(),
            });
        };
        // An order of a shaft, which is a frequency where its mean speed is given.
        let mut turns = |shaft: usize, order: f64| {
            if let Some(speed) = given[shaft] {
                repeats(None, order * speed, TAU / (order * speed));
            } else {
                let on_it = wheels.iter().position(|wheel| wheel.shaft == shaft);
                let present = on_it.map_or(0.0, |wheel| speeds[wheel]);
                repeats(Some(shaft), order, TAU / (order * present));
            }
        };
        for wheel in self.system.chains.iter().filter_map(|it| it.route.first()) {
            let wheel = &wheels[*wheel];
            turns(wheel.shaft, f64::from(wheel.teeth));
        }
        for (shaft, action) in self.actions() {
            match action {
                Action::Orders { terms, .. } => {
                    for order in terms.iter().filter(|it| it.acts()) {
                        turns(shaft, order.order);
                    }
                }
                Action::Table {
                    over: Argument::Angle { turns: whole, .. },
                    curve,
                } => {
                    let whole = f64::from(*whole);
                    for order in orders(|share| curve.polyline(TAU * whole * share)) {
                        turns(shaft, f64::from(order) / whole);
                    }
                }
                _ => {}
            }
        }
        for motion in self.motions() {
            frequencies(motion, &mut |rate| repeats(None, rate, TAU / rate));
        }
        found.sort_by(|a, b| b.period.total_cmp(&a.period));
        found.dedup_by(|a, b| a.shaft == b.shaft && (a.period / b.period - 1.0).abs() < 1e-9);
        found
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
        let told = |action: &Action, words: [&'static str; 2]| match action {
            Action::Ramp { .. } => Some(words[0]),
            Action::Table {
                over: Argument::Time,
                ..
            } => Some(words[1]),
            _ => None,
        };
        let torques = self.drive.shafts.iter().flat_map(Shaft::torques);
        let mut torques = torques.filter_map(Torque::action);
        let words = [
            "a torque that is switched on at a time",
            "a torque over time",
        ];
        let motion = self.motions().find_map(of_time);
        let torque = || torques.find_map(|it| told(it, words));
        let words = ["a force that is switched on at a time", "a force over time"];
        let mut forces = self.drive.forces().flat_map(|(_, forces)| forces.all());
        let force = || forces.find_map(|it| told(it, words));
        motion.or_else(torque).or_else(force)
    }

    /// All that follows time or an angle, torques before forces, each with the shaft whose angle counts: any where none does.
    fn actions(&self) -> impl Iterator<Item = (usize, &Action)> {
        let shafts = self.drive.shafts.iter().enumerate();
        let torques = shafts.flat_map(|(shaft, it)| {
            let actions = it.torques().filter_map(Torque::action);
            actions.map(move |action| (shaft, action))
        });
        let sprockets = self.drive.sprockets.iter();
        let centres =
            sprockets.flat_map(|it| it.forces.all().map(move |action| (it.shaft, action)));
        let carriers = self.drive.tensioners.iter();
        let carriers = carriers.flat_map(|it| it.forces.all().map(|action| (0, action)));
        let all = torques.chain(centres).chain(carriers);
        all.map(|(shaft, action)| (action.follows().unwrap_or(shaft), action))
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

/// Tells the circular frequencies of a motion \[rad/s\].
fn frequencies(motion: &Motion, repeats: &mut impl FnMut(f64)) {
    match motion {
        Motion::Orders { turning, terms, .. } => {
            let swinging = terms.iter().filter(|it| it.acts());
            swinging.for_each(|it| repeats(it.order * turning));
        }
        Motion::Harmonics { terms, .. } => {
            let swinging = terms
                .iter()
                .filter(|it| it.amplitude != 0.0 && it.frequency > 0.0);
            swinging.for_each(|it| repeats(TAU * it.frequency));
        }
        Motion::From { motion, .. } => frequencies(motion, repeats),
        Motion::Held
        | Motion::Constant { .. }
        | Motion::Ramp { .. }
        | Motion::Table(_)
        | Motion::SpeedTable(_)
        | Motion::Onward(_) => {}
    }
}

/// Orders of a curve over a whole that count, at least one of them, the lowest first.
///
/// ```text
/// cₖ = |Σ f(x) exp(−2πi k x)|,   all k with cₖ ≥ 1 % of the greatest
/// ```
fn orders(curve: impl Fn(f64) -> f64) -> Vec<u32> {
    let points: Vec<f64> = (0..POINTS)
        .map(|i| curve(f64::from(i) / f64::from(POINTS)))
        .collect();
    let circle: Vec<[f64; 2]> = (0..POINTS)
        .map(|i| TAU * f64::from(i) / f64::from(POINTS))
        .map(|at| [at.cos(), at.sin()])
        .collect();
    let amplitude = |order: u32| {
        let places = (0..POINTS).map(|i| circle[(order * i % POINTS) as usize]);
        let parts = places.zip(&points).map(|([c, s], f)| [f * c, f * s]);
        let [re, im] = parts.fold([0.0; 2], |[re, im], [c, s]| [re + c, im + s]);
        re.hypot(im)
    };
    let amplitudes: Vec<(u32, f64)> = (1..=MOST_ORDERS).map(|k| (k, amplitude(k))).collect();
    // What is rounding is no order.
    let all: f64 = points.iter().map(|f| f.abs()).sum();
    let greatest = amplitudes.iter().map(|it| it.1).fold(0.0, f64::max);
    let counts = (COUNTS * greatest).max(1e-12 * all);
    let counting = amplitudes.iter().filter(|it| it.1 > counts);
    let mut orders: Vec<u32> = counting.map(|it| it.0).collect();
    if orders.is_empty() {
        orders.push(1);
    }
    orders
}

fn of_time(motion: &Motion) -> Option<&'static str> {
    match motion {
        Motion::Ramp { .. } => Some("a speed that changes at a time"),
        Motion::Harmonics { .. } => Some("a motion by frequencies"),
        Motion::Table(_) | Motion::SpeedTable(_) => Some("a motion over time"),
        Motion::From { motion, .. } => of_time(motion),
        Motion::Held | Motion::Constant { .. } | Motion::Orders { .. } | Motion::Onward(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_orders_of_a_table_are_found() {
        let lobes = |n: f64| move |share: f64| 5.0 + (n * TAU * share).sin().max(0.0);
        for (curve, order) in [(lobes(1.0), 1), (lobes(7.0), 7), (lobes(2.0), 2)] {
            let found = orders(curve);
            // A half wave has its order and the even multiples of it.
            assert_eq!(found[..3], [order, 2 * order, 4 * order]);
        }
        let uneven = |share: f64| (4.0 * TAU * share).sin() + 0.02 * (TAU * share).cos();
        assert_eq!(orders(uneven), [1, 4]);
        assert_eq!(orders(|_| 3.0), [1]);
    }
}
