//! Inputs between two communication points.
//!
//! An importer sets values u_k at times t_k and asks for a step of length h. Held, an input stays u_k; extrapolated, it goes on along the
//! line through the last two values:
//!
//! ```text
//! u(t) = u_k + r (t − t_k)        r = 0, or (u_k − u_{k−1})/h_{k−1}
//! ```
//!
//! Angles and places come where they are told within the step, on a cubic without a jump of speed: to u_k, one step late, or to u_k + r h.
//!
//! The value that comes at the end of a step is not the one that acted there: work that the other side has given has not arrived.
//!
//! ```text
//! ΔE = Σ (u_k − u(t_k⁻)) Δx_k         u: torque or force, Δx: way of its point within the step that ends at t_k
//! ΔE = Σ −τ_k (u_k − u(t_k⁻)) h       u: speed, τ: torque of the chains on the shaft
//! ΔE = Σ −τ_k (u_k − u_{k−1} − Δx_k)  u: angle
//! ```
//!
//! The first is the sum Σ (τ_k − τ_{k−1}) ω h of held inputs. It is negative where the coupling makes energy: one that grows unstable shows it.

use chaindrive::{Control, Course};
use chaindrive_mechanics::Tensioner;
use serde::{Deserialize, Serialize};

/// Way of a centre that rounding alone makes \[m\]. *Assumed*: far below any clearance.
const AT_REST: f64 = 1e-14;

/// Part of the drive that an input acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Torque,
    Speed,
    Angle,
    Force,
    /// A place of a centre, by its acceleration.
    Centre,
    /// It jumps.
    Parameter,
}

/// An input or tunable parameter.
#[derive(Clone, Debug)]
pub(crate) struct Signal {
    pub(crate) control: Control,
    pub(crate) kind: Kind,
    /// The shaft by its place among the shafts, and the choice with which the input acts.
    pub(crate) shaft: Option<(usize, i64)>,
    pub(crate) start: f64,
    /// Its coordinate among the values read, or that of the tensioner that carries its point.
    pub(crate) place: Option<usize>,
    /// The tensioner on a point of which it acts, and the axis.
    pub(crate) carried: Option<(Tensioner, usize)>,
    /// Speed of its shaft, and the torques of chains on it, among the values read.
    pub(crate) speed: Option<usize>,
    pub(crate) torques: Vec<usize>,
}

impl Signal {
    /// A force, zero at the start, whose point has its coordinate at this place among the values read.
    pub(crate) fn force(control: Control, place: Option<usize>) -> Self {
        Self {
            control,
            kind: Kind::Force,
            shaft: None,
            start: 0.0,
            place,
            carried: None,
            speed: None,
            torques: Vec::new(),
        }
    }

    /// Its coordinate.
    fn coordinate(&self, values: &[f64]) -> f64 {
        let read = self.place.map_or(0.0, |index| values[index]);
        let carried = self.carried.as_ref();
        carried.map_or(read, |(tensioner, axis)| {
            tensioner.forced_place(read)[*axis]
        })
    }
}

/// An input as it stands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct InputState {
    /// As it was set last.
    pub(crate) value: f64,
    /// Slope that the importer gave for the next step.
    pub(crate) slope: Option<f64>,
    /// Whether it acts: from the first time on that it differs from its start.
    acts: bool,
    last: Option<LastStep>,
}

/// The last step of an input.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct LastStep {
    value: f64,
    /// Value that acted at its end.
    end: f64,
    /// Coordinate at its beginning.
    place: f64,
    /// Speed of a centre at its end.
    speed: f64,
    course: Option<Course>,
}

/// Energy through an input in one step \[J\].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ExchangedEnergy {
    pub(crate) work: f64,
    pub(crate) error: f64,
}

/// A communication point: the step that ended there, and the one that begins \[s\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct CommunicationPoint {
    pub(crate) last_step: f64,
    pub(crate) next_step: f64,
    pub(crate) linear: bool,
}

impl InputState {
    pub(crate) fn new(value: f64) -> Self {
        Self {
            value,
            slope: None,
            acts: false,
            last: None,
        }
    }

    /// Lets it act, also with the value of its start.
    pub(crate) fn begin(&mut self) {
        self.acts = true;
    }

    /// Ends its course: something else acts now.
    pub(crate) fn end(&mut self) {
        self.last = None;
        self.slope = None;
    }

    /// Whether it acts in the step to come.
    pub(crate) fn is_acting(&mut self, start: f64) -> bool {
        self.acts |= self.value.to_bits() != start.to_bits();
        self.acts
    }

    /// Input courses of the next step (none if unchanged), and the energy exchanged in the last.
    pub(crate) fn pass(
        &mut self,
        signal: &Signal,
        point: CommunicationPoint,
        values: &[f64],
    ) -> (Vec<Course>, ExchangedEnergy) {
        let place = signal.coordinate(values);
        let torque: f64 = signal.torques.iter().map(|index| values[*index]).sum();
        let exchanged = self.exchanged(signal.kind, point.last_step, place, torque);
        let given = self.slope.take();
        let linear = point.linear || given.is_some();
        let slope = given.unwrap_or(match self.last {
            Some(last) if point.last_step > 0.0 => (self.value - last.value) / point.last_step,
            _ => 0.0,
        });
        let rate = if linear { slope } else { 0.0 };
        let u = self.value;
        let mut last = LastStep {
            value: u,
            end: u + rate * point.next_step,
            place,
            speed: 0.0,
            course: None,
        };
        let before = self.last;
        let courses = match signal.kind {
            Kind::Torque | Kind::Speed | Kind::Force | Kind::Parameter => {
                let course = Course {
                    to: u,
                    over: 0.0,
                    rate: if signal.kind == Kind::Parameter {
                        0.0
                    } else {
                        rate
                    },
                };
                last.course = Some(course);
                let goes_on = before.and_then(|it| it.course) == Some(course) && course.rate == 0.0;
                if goes_on { Vec::new() } else { vec![course] }
            }
            Kind::Angle => {
                // Before there are two values, it goes on as it turns.
                let known = before.is_some() || linear;
                let turning = signal.speed.map_or(0.0, |index| values[index]);
                vec![Course {
                    to: last.end,
                    over: point.next_step,
                    rate: if known { slope } else { turning },
                }]
            }
            Kind::Centre => {
                let v = before.map_or(0.0, |it| it.speed);
                last.speed = slope;
                let h = point.next_step;
                let way = last.end - place;
                if way.abs() < AT_REST && v == 0.0 && slope == 0.0 {
                    let rest = Course::from(0.0);
                    last.course = Some(rest);
                    let rests = before.and_then(|it| it.course) == Some(rest);
                    self.last = Some(last);
                    return (if rests { Vec::new() } else { vec![rest] }, exchanged);
                }
                // x(t) = x + v t + ½ a₀ t² + (a₁ − a₀) t³/(6 h), so that x(h) = x + way and ẋ(h) = slope
                let from = 6.0 * way / (h * h) - (4.0 * v + 2.0 * slope) / h;
                let to = -6.0 * way / (h * h) + (2.0 * v + 4.0 * slope) / h;
                let over = Course {
                    to,
                    over: h,
                    rate: 0.0,
                };
                vec![Course::from(from), over]
            }
        };
        self.last = Some(last);
        (courses, exchanged)
    }

    /// Work in the last step \[J\], until the next one begins.
    pub(crate) fn work_so_far(&self, signal: &Signal, last_step: f64, values: &[f64]) -> f64 {
        let place = signal.coordinate(values);
        let torque = signal.torques.iter().map(|index| values[*index]).sum();
        self.exchanged(signal.kind, last_step, place, torque).work
    }

    fn exchanged(&self, kind: Kind, h: f64, place: f64, torque: f64) -> ExchangedEnergy {
        let Some(last) = self.last else {
            return ExchangedEnergy::default();
        };
        let way = place - last.place;
        let missed = self.value - last.end;
        match kind {
            Kind::Torque | Kind::Force => ExchangedEnergy {
                work: 0.5 * (last.value + last.end) * way,
                error: missed * way,
            },
            Kind::Speed => ExchangedEnergy {
                work: -torque * way,
                error: -torque * missed * h,
            },
            Kind::Angle => ExchangedEnergy {
                work: -torque * way,
                error: -torque * (self.value - last.value - way),
            },
            Kind::Centre | Kind::Parameter => ExchangedEnergy::default(),
        }
    }
}
