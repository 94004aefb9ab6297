//! A mass bouncing on a contact that remembers the speed at which it began.

use chaindrive_integrate::{Continuity, Moment, SecondOrderSystem, Verdict};

/// The mass, its contact, and what the contact remembers.
#[derive(Clone, Debug)]
pub(crate) struct Bounce {
    pub gravity: f64,
    pub mass: f64,
    pub stiffness: f64,
    pub exponent: f64,
    /// Hysteretic factor χ.
    pub factor: f64,
    /// Deepest first penetration that is accepted \[m\].
    pub tolerance: f64,
    /// The record of the accepted state.
    pub now: Record,
    /// Speed at onset of the present contact, interpolated.
    pub onset: Option<f64>,
    /// Speeds at onset so far.
    pub onsets: Vec<f64>,
    /// First penetrations so far.
    pub first_penetrations: Vec<f64>,
    /// States taken.
    pub commits: u64,
}

/// Record of an evaluation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Record {
    pub t: f64,
    pub gap: f64,
    pub rate: f64,
}

impl Bounce {
    pub(crate) fn new(stiffness: f64, exponent: f64, mass: f64) -> Self {
        Self {
            gravity: 9.806_65,
            mass,
            stiffness,
            exponent,
            factor: 0.0,
            tolerance: f64::INFINITY,
            now: Record::default(),
            onset: None,
            onsets: Vec::new(),
            first_penetrations: Vec::new(),
            commits: 0,
        }
    }

    fn elastic(&self, penetration: f64) -> f64 {
        let power = if (self.exponent - 1.5).abs() < 1e-12 {
            penetration * penetration.sqrt()
        } else {
            penetration.powf(self.exponent)
        };
        self.stiffness * power
    }

    /// Kinetic energy, height and contact, over the weight: the height of the next apex \[m\].
    pub(crate) fn apex(&self, q: f64, v: f64) -> f64 {
        let depth = (-q).max(0.0);
        let stored = self.elastic(depth) * depth / (self.exponent + 1.0);
        q + (0.5 * self.mass * v * v + stored) / (self.mass * self.gravity)
    }
}

impl SecondOrderSystem for Bounce {
    type Record = Record;

    fn new_record(&self) -> Record {
        Record::default()
    }

    fn dofs(&self) -> usize {
        1
    }

    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], _: &mut [f64], record: &mut Record) {
        *record = Record {
            t: at.t,
            gap: at.q[0],
            rate: -at.v[0],
        };
        a[0] = -self.gravity;
        if record.gap < 0.0 {
            // A contact that begins within the step reckons with its present speed.
            let onset = self.onset.unwrap_or(record.rate).max(1e-3);
            let damping = (1.0 + self.factor * record.rate / onset).max(0.0);
            a[0] += self.elastic(-record.gap) * damping / self.mass;
        }
    }

    fn inspect(&self, h: f64, end: &Record) -> Verdict {
        if self.now.gap > 0.0 && end.gap < -self.tolerance {
            // The secant, aimed at half the tolerance.
            let at_most = h * (self.now.gap + 0.5 * self.tolerance) / (self.now.gap - end.gap);
            Verdict::Retry { at_most }
        } else {
            Verdict::Accept
        }
    }

    fn commit(&mut self, _: f64, _: &mut [f64], v: &mut [f64], end: &mut Record) -> Continuity {
        self.commits += 1;
        end.rate = -v[0];
        if end.gap >= 0.0 {
            self.onset = None;
        } else if self.onset.is_none() {
            let s = (self.now.gap / (self.now.gap - end.gap)).clamp(0.0, 1.0);
            let onset = self.now.rate + s * (end.rate - self.now.rate);
            self.onset = Some(onset);
            self.onsets.push(onset);
            self.first_penetrations.push(-end.gap);
        }
        std::mem::swap(&mut self.now, end);
        Continuity::Smooth
    }
}
