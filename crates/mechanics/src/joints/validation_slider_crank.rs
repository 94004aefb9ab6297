//! A slider-crank whose wrist pin has play, assembled from the library's joint (cases S01, S02, S05).
//!
//! The crank turns at constant speed, the rod hangs on it by an ideal hinge, and its other end is the pin in the
//! bush of the slider: two degrees of freedom, the angle of the rod and the place of the slider.

use std::f64::consts::TAU;

use chaindrive_contact::dissipation::LankaraniNikravesh;
use chaindrive_contact::elastic::Power;
use chaindrive_contact::{Dissipation, Elastic, Friction, Law};
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Continuity, Method, Moment, SecondOrderSystem, State, Verdict};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};

use super::{Part, touch, turned};
use crate::Surface;
use crate::contact::{BoreContact, ContactMemory, LaneTally, MemoryLanes, Tally};
use crate::lanes::Wide;

/// One contact of pin and bush.
#[derive(Clone, Copy, Debug, Default)]
struct Impact {
    start: f64,
    end: f64,
    approach: f64,
    force: f64,
}

struct SliderCrank {
    crank: f64,
    rod: f64,
    speed: f64,
    rod_mass: f64,
    /// Of the rod about its hinge on the crank.
    rod_inertia: f64,
    slider_mass: f64,
    bearing: BoreContact,
    depth: f64,
    memory: (f64, ContactMemory),
    impacts: Vec<Impact>,
}

struct Work {
    touch: ContactMemory,
    tally: Tally,
    slider_acceleration: f64,
}

impl SliderCrank {
    fn of(case: &Case) -> Self {
        let input = |name: &str| case.number(&format!("inputs.{name}"));
        let (bore, clearance) = (input("R_bearing"), input("clearance"));
        // K = 4/3 E* sqrt(R_i R_j/(R_i - R_j)) where the case does not list it
        let stiffness = if case.lists("inputs.K") {
            input("K")
        } else {
            66_101_983_978.97
        };
        let surface = Surface {
            law: Law {
                series: None,
                elastic: Elastic::Power(Power {
                    stiffness,
                    exponent: 1.5,
                }),
                dissipation: Dissipation::LankaraniNikravesh(LankaraniNikravesh {
                    restitution: input("e"),
                }),
                onset_floor: 1e-6,
            },
            friction: Friction::None,
            film: None,
        };
        let (rod, rod_mass) = (input("l"), input("m_conrod"));
        Self {
            crank: input("r"),
            rod,
            speed: input("rpm") * TAU / 60.0,
            rod_mass,
            rod_inertia: input("J_conrod") + 0.25 * rod_mass * rod * rod,
            slider_mass: input("m_slider"),
            bearing: BoreContact::new(&surface, bore, bore - clearance),
            depth: 2e-9,
            memory: (0.0, ContactMemory::open(1)),
            impacts: Vec::new(),
        }
    }

    fn start(&self) -> State {
        let rate = -self.crank * self.speed / self.rod;
        State::new(0.0, vec![0.0, self.crank + self.rod], vec![rate, 0.0])
    }

    fn sides(&self, at: Moment<'_>) -> [Part; 2] {
        let turn = self.speed * at.t;
        let hinge = Vector::new(turn.cos(), turn.sin()) * self.crank;
        let arm = Vector::new(at.q[0].cos(), at.q[0].sin()) * self.rod;
        let slider = Part {
            body: None,
            place: Point::new(at.q[1], 0.0),
            velocity: Vector::new(at.v[1], 0.0),
            arm: Vector::zeros(),
            spin: 0.0,
        };
        let pin = Part {
            place: Point::from(hinge + arm),
            velocity: turned(hinge) * self.speed + turned(arm) * at.v[0],
            arm,
            spin: at.v[0],
            ..slider
        };
        [slider, pin]
    }
}

impl SecondOrderSystem for SliderCrank {
    type Record = Work;

    fn new_record(&self) -> Work {
        Work {
            touch: ContactMemory::open(1),
            tally: Tally::new(),
            slider_acceleration: 0.0,
        }
    }

    fn dofs(&self) -> usize {
        2
    }

    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], _: &mut [f64], record: &mut Work) {
        let [slider, pin] = self.sides(at);
        let (w, dt) = (Wide(pulp::Scalar), at.t - self.memory.0);
        let mut memory = MemoryLanes::new(w, &self.memory.1, &mut record.touch, 1);
        let mut tally = LaneTally::new(w);
        let parts = [&slider, &pin];
        let element = touch(&self.bearing, 0, parts, &mut memory, 0, dt, &mut tally);
        record.tally = Tally::of(&tally);
        let push = element.map_or_else(Vector::zeros, |element| element.push());
        // J φ̈ = M − m l/2 (n·a_hinge),   m_s ẍ = −F_x
        let turn = self.speed * at.t;
        let hinge = Vector::new(turn.cos(), turn.sin()) * (-self.crank * self.speed * self.speed);
        let across = turned(pin.arm);
        a[0] = (across.dot(&push) - 0.5 * self.rod_mass * across.dot(&hinge)) / self.rod_inertia;
        a[1] = -push.x / self.slider_mass;
        record.slider_acceleration = a[1];
    }

    fn inspect(&self, h: f64, end: &Work) -> Verdict {
        if end.tally.first_depth <= self.depth {
            return Verdict::Accept;
        }
        let before = end.tally.first_share;
        let beyond = 0.5 * self.depth / end.tally.first_depth;
        Verdict::Retry {
            at_most: h * (before + (1.0 - before) * beyond),
        }
    }

    fn commit(&mut self, t: f64, _: &mut [f64], _: &mut [f64], end: &mut Work) -> Continuity {
        let (before, now) = (self.memory.1.closed(0), end.touch.closed(0));
        if let (Some((approach, _)), None) = (now, before) {
            self.impacts.push(Impact {
                start: t,
                end: f64::INFINITY,
                approach,
                force: 0.0,
            });
        }
        if let Some(impact) = self.impacts.last_mut() {
            if let Some((_, force)) = now {
                impact.force = impact.force.max(force);
            } else if before.is_some() {
                impact.end = t;
            }
        }
        self.memory.0 = t;
        std::mem::swap(&mut self.memory.1, &mut end.touch);
        Continuity::Smooth
    }
}

/// The first ten contacts of the two published clearances.
#[test]
fn s01_s02_first_impacts_of_a_slider_crank() {
    for id in ["S01", "S02"] {
        let case = Case::read(id);
        let mut mechanism = SliderCrank::of(&case);
        let mut state = mechanism.start();
        let method = Method::Rk4 { step: 5e-8 };
        let mut stepper = method.start(&mut mechanism, &mut state).unwrap();
        while state.t < 4.1e-3 && mechanism.impacts.len() < 11 {
            stepper.advance(&mut mechanism, &mut state).unwrap();
        }
        let tolerance = |key: &str| case.number(&format!("tolerance.{key}"));
        for (k, row) in case.table("expected.impacts").iter().enumerate() {
            let found = mechanism.impacts[k];
            let (which, allowed) = match k {
                0..3 => ("1 to 3", tolerance("first_three")),
                3..7 => ("4 to 7", tolerance("up_to_seven")),
                _ => ("8 to 10", tolerance("up_to_ten")),
            };
            let judge = |quantity: &str, unit: &str, found, expected, allowed| {
                let quantity = format!("{quantity}, impacts {which}");
                case.judge(&quantity, unit, found, expected, Relative(allowed));
            };
            judge("begin", "s", found.start, row[0], allowed);
            judge("approach speed", "m/s", found.approach, row[1], allowed);
            judge("end", "s", found.end, row[3], allowed);
            let force = allowed.max(tolerance("force"));
            judge("greatest force", "N", found.force, row[5], force);
        }
    }
}

/// Statistics of many revolutions: three runs from slightly different starts.
#[test]
fn s05_statistics_of_a_slider_crank() {
    let case = Case::read("S05");
    let (revolutions, skipped) = (60.0, 4.0);
    let mut sums = [0.0_f64; 6];
    let runs = 3;
    for run in 0..runs {
        let mut mechanism = SliderCrank::of(&case);
        mechanism.depth = f64::INFINITY;
        let mut state = mechanism.start();
        state.q[1] += 1e-9 * f64::from(run);
        let method = Method::Rk4 { step: 2e-7 };
        let mut stepper = method.start(&mut mechanism, &mut state).unwrap();
        let period = TAU / mechanism.speed;
        let (mut squares, mut touching, mut steps) = (0.0, 0.0, 0.0);
        let mut first = None;
        // Greatest force and acceleration, turn by turn.
        let mut peaks = vec![[0.0_f64; 2]];
        let mut turn_ends = (skipped + 1.0) * period;
        while state.t < revolutions * period {
            stepper.advance(&mut mechanism, &mut state).unwrap();
            if state.t > skipped * period {
                first.get_or_insert(mechanism.impacts.len());
                squares += state.a[1] * state.a[1];
                let contact = mechanism.memory.1.closed(0);
                touching += f64::from(contact.is_some());
                if state.t > turn_ends {
                    peaks.push([0.0; 2]);
                    turn_ends += period;
                }
                let peak = peaks.last_mut().expect("a turn is under way");
                peak[0] = peak[0].max(contact.map_or(0.0, |(_, force)| force));
                peak[1] = peak[1].max(state.a[1].abs());
                steps += 1.0;
            }
        }
        let counted = (mechanism.impacts.len() - first.unwrap_or(0)) as f64;
        sums[0] += f64::sqrt(squares / steps);
        sums[1] += touching / steps;
        sums[2] += counted / (revolutions - skipped);
        let mean = |k: usize| peaks.iter().map(|peak| peak[k]).sum::<f64>() / peaks.len() as f64;
        sums[3] += mean(0);
        sums[4] += peaks.iter().fold(0.0, |most: f64, peak| most.max(peak[0]));
        sums[5] += mean(1);
    }
    for ((name, unit, key), sum) in [
        (
            "root mean square of the acceleration",
            "m/s²",
            "rms_slider_acc",
        ),
        ("share of time in contact", "", "contact_fraction"),
        ("impacts a revolution", "", "impacts_per_rev"),
        (
            "greatest force of a revolution, mean",
            "N",
            "mean_peak_force_per_rev",
        ),
        ("greatest force", "N", "max_force"),
        (
            "greatest acceleration of a revolution, mean",
            "m/s²",
            "mean_peak_acc_per_rev",
        ),
    ]
    .into_iter()
    .zip(sums)
    {
        let found = sum / f64::from(runs);
        let expected = case.list(&format!("expected.{key}"));
        let (mean, deviation) = (expected[0], expected[1]);
        let allowed = case.number("tolerance.deviations") * deviation
            + case.number("tolerance.relative") * mean;
        case.judge(name, unit, found, mean, Absolute(allowed));
    }
}
