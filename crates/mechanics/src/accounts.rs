//! The accounts of bodies: the work that every source does on a shaft, the impulses of the chain on sprockets and guides, the courses of
//! tensioners.
//!
//! They are integrated along with the motion by the method's own rule, as the flows of the [ledger](crate::Energy) are. Means of torque, power and
//! force over any time are their differences, whoever looks and when.
//!
//! ```text
//! W = ∫ M ω dt      of every source on a shaft;   ∫ M dt, ∫ F dt of the chain;   ∫ ω dt;   ∫ s dt
//! Σ W = Δ ½ J ω²    over the sources of a shaft;   J: its inertia and that of its sprockets
//! ```

use serde::{Deserialize, Serialize};

/// What does work on a shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Driving torques of the scene.
    Drive,
    /// Loads of the scene, negative while they resist.
    Load,
    /// Torques that are set from outside.
    Control,
    /// A rotation that is given, by the scene or from outside.
    Motion,
    /// Chains, on the sprockets of the shaft.
    Chains,
    /// Gears that join it to the other shafts of its train.
    Gears,
    /// Couplings to other shafts.
    Couplings,
    /// Friction in its bearings and seals.
    Bearings,
    /// Oil and air around it.
    Drag,
}

impl Source {
    /// All sources, in the order of [`ShaftAccount::works`].
    pub const ALL: [Self; 9] = [
        Self::Drive,
        Self::Load,
        Self::Control,
        Self::Motion,
        Self::Chains,
        Self::Gears,
        Self::Couplings,
        Self::Bearings,
        Self::Drag,
    ];

    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drive => "drive",
            Self::Load => "load",
            Self::Control => "control",
            Self::Motion => "motion",
            Self::Chains => "chains",
            Self::Gears => "gears",
            Self::Couplings => "couplings",
            Self::Bearings => "bearings",
            Self::Drag => "drag",
        }
    }
}

/// What has come to a sprocket since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SprocketAccount {
    /// Work of the chain \[J\].
    pub work: f64,
    /// Impulse of the torque of the chain \[N m s\].
    pub torque: f64,
    /// Impulse of the force of the chain \[N s\].
    pub force: [f64; 2],
    /// Energy lost in the dampers of its bearing \[J\].
    pub damped: f64,
    /// Work of forces from outside on its centre \[J\].
    pub forced: f64,
}

/// Work of every source on a shaft since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShaftAccount {
    /// Energies \[J\] in the order of [`Source::ALL`].
    pub works: [f64; Source::ALL.len()],
    /// Angle turned \[rad\].
    pub angle: f64,
    /// Speed gained \[rad/s\].
    pub speed: f64,
}

/// What has come to a guide since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GuideAccount {
    /// Impulse of the force of the chain \[N s\].
    pub force: [f64; 2],
    /// Energy lost in impacts and by friction \[J\].
    pub lost: f64,
}

/// What a tensioner has done since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TensionerAccount {
    /// Integral of its coordinate \[m s or rad s\].
    pub course: f64,
    /// Impulse of its push \[N s, or N m s\].
    pub push: f64,
    /// Energy lost in it \[J\].
    pub lost: f64,
    /// Work of forces from outside on it, beside those on the centres that it carries \[J\].
    pub forced: f64,
}

/// The accounts of all bodies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Accounts {
    /// Of every sprocket.
    pub sprockets: Vec<SprocketAccount>,
    /// Of every shaft, those of single sprockets included.
    pub shafts: Vec<ShaftAccount>,
    /// Of every guide.
    pub guides: Vec<GuideAccount>,
    /// Of every tensioner.
    pub tensioners: Vec<TensionerAccount>,
}

impl ShaftAccount {
    /// Work of one source \[J\].
    pub fn work(&self, source: Source) -> f64 {
        self.works[source as usize]
    }

    /// Work of all sources together \[J\]: the change of the kinetic energy of the shaft.
    pub fn total(&self) -> f64 {
        self.works.iter().sum()
    }
}

/// Entries of one body in the row of all accounts.
trait Entry: Sized {
    const LENGTH: usize;

    fn from_row(row: &[f64]) -> Self;
}

impl Entry for SprocketAccount {
    const LENGTH: usize = 6;

    fn from_row(row: &[f64]) -> Self {
        Self {
            work: row[0],
            torque: row[1],
            force: [row[2], row[3]],
            damped: row[4],
            forced: row[5],
        }
    }
}

impl Entry for ShaftAccount {
    const LENGTH: usize = Source::ALL.len() + 2;

    fn from_row(row: &[f64]) -> Self {
        let (own, turned) = row.split_at(Source::ALL.len());
        let mut works = [0.0; Source::ALL.len()];
        works.copy_from_slice(own);
        Self {
            works,
            angle: turned[0],
            speed: turned[1],
        }
    }
}

impl Entry for GuideAccount {
    const LENGTH: usize = 3;

    fn from_row(row: &[f64]) -> Self {
        Self {
            force: [row[0], row[1]],
            lost: row[2],
        }
    }
}

impl Entry for TensionerAccount {
    const LENGTH: usize = 4;

    fn from_row(row: &[f64]) -> Self {
        Self {
            course: row[0],
            push: row[1],
            lost: row[2],
            forced: row[3],
        }
    }
}

/// Numbers of bodies that have an account: all of them, or none.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AccountSizes {
    pub(crate) sprockets: usize,
    pub(crate) shafts: usize,
    pub(crate) guides: usize,
    pub(crate) tensioners: usize,
}

impl AccountSizes {
    /// Numbers in all accounts together.
    pub(crate) fn length(self) -> usize {
        self.sprockets * SprocketAccount::LENGTH
            + self.shafts * ShaftAccount::LENGTH
            + self.guides * GuideAccount::LENGTH
            + self.tensioners * TensionerAccount::LENGTH
    }

    /// The accounts in a row of numbers.
    pub(crate) fn read(self, row: &[f64]) -> Accounts {
        fn all<T: Entry>(count: usize, row: &mut &[f64]) -> Vec<T> {
            let (own, rest) = row.split_at(count * T::LENGTH);
            *row = rest;
            own.chunks_exact(T::LENGTH).map(T::from_row).collect()
        }
        let mut row = row;
        Accounts {
            sprockets: all(self.sprockets, &mut row),
            shafts: all(self.shafts, &mut row),
            guides: all(self.guides, &mut row),
            tensioners: all(self.tensioners, &mut row),
        }
    }

    /// Rates of the accounts, to be written; without a place where none are kept.
    pub(crate) fn rates(self, row: &mut [f64]) -> AccountRates<'_> {
        let (sprockets, row) = row.split_at_mut(self.sprockets * SprocketAccount::LENGTH);
        let (shafts, row) = row.split_at_mut(self.shafts * ShaftAccount::LENGTH);
        let (guides, tensioners) = row.split_at_mut(self.guides * GuideAccount::LENGTH);
        AccountRates {
            sprockets,
            shafts,
            guides,
            tensioners,
        }
    }
}

/// Rates of all accounts, zero before they are written.
pub(crate) struct AccountRates<'a> {
    sprockets: &'a mut [f64],
    shafts: &'a mut [f64],
    guides: &'a mut [f64],
    tensioners: &'a mut [f64],
}

impl AccountRates<'_> {
    /// Whether accounts are kept.
    pub(crate) fn are_kept(&self) -> bool {
        !self.shafts.is_empty()
    }

    /// Adds the power of a source on a shaft \[W\].
    #[inline(always)]
    pub(crate) fn add(&mut self, shaft: usize, source: Source, power: f64) {
        let place = shaft * ShaftAccount::LENGTH + source as usize;
        if let Some(rate) = self.shafts.get_mut(place) {
            *rate += power;
        }
    }

    /// Power of all sources on a shaft \[W\].
    pub(crate) fn power(&self, shaft: usize) -> f64 {
        let row = &self.shafts[shaft * ShaftAccount::LENGTH..][..Source::ALL.len()];
        row.iter().sum()
    }

    /// Sets how a shaft turns: its speed \[rad/s\] and acceleration \[rad/s²\].
    #[inline(always)]
    pub(crate) fn turn(&mut self, shaft: usize, speed: f64, acceleration: f64) {
        let place = shaft * ShaftAccount::LENGTH + Source::ALL.len();
        if let Some(row) = self.shafts.get_mut(place..place + 2) {
            row.copy_from_slice(&[speed, acceleration]);
        }
    }

    /// Speed \[rad/s\] and acceleration \[rad/s²\] of a shaft, as they were set.
    pub(crate) fn turning(&self, shaft: usize) -> [f64; 2] {
        let place = shaft * ShaftAccount::LENGTH + Source::ALL.len();
        [self.shafts[place], self.shafts[place + 1]]
    }

    /// Sets the rates of a sprocket on a shaft: torque \[N m\] and force \[N\] of the chain, whose work the shaft gets.
    pub(crate) fn of_sprocket(&mut self, index: usize, shaft: usize, torque: f64, force: [f64; 2]) {
        let [speed, _] = self.turning(shaft);
        let power = torque * speed;
        let row = &mut self.sprockets[index * SprocketAccount::LENGTH..];
        row[..4].copy_from_slice(&[power, torque, force[0], force[1]]);
        self.add(shaft, Source::Chains, power);
    }

    /// Adds an impulse of the chain on a sprocket, which does work on its shaft: force, and moment \[N s, N m s\].
    pub(crate) fn strike(&mut self, index: usize, shaft: usize, speed: f64, impulse: [f64; 3]) {
        let [x, y, moment] = impulse;
        let row = &mut self.sprockets[index * SprocketAccount::LENGTH..];
        for (sum, added) in row.iter_mut().zip([moment * speed, moment, x, y]) {
            *sum += added;
        }
        self.add(shaft, Source::Chains, moment * speed);
    }

    /// Adds an impulse of the chain on a guide \[N s\], and what is lost \[J\].
    pub(crate) fn strike_guide(&mut self, index: usize, impulse: [f64; 2], lost: f64) {
        let [x, y] = impulse;
        let row = &mut self.guides[index * GuideAccount::LENGTH..];
        for (sum, added) in row.iter_mut().zip([x, y, lost]) {
            *sum += added;
        }
    }

    /// Adds what the dampers at a sprocket take \[W\].
    #[inline(always)]
    pub(crate) fn damp(&mut self, index: usize, power: f64) {
        if let Some(rate) = self.sprockets.get_mut(index * SprocketAccount::LENGTH + 4) {
            *rate += power;
        }
    }

    /// Adds what forces from outside do on the centre of a sprocket \[W\].
    pub(crate) fn force_centre(&mut self, index: usize, power: f64) {
        if let Some(rate) = self.sprockets.get_mut(index * SprocketAccount::LENGTH + 5) {
            *rate += power;
        }
    }

    /// Adds what forces from outside do on a tensioner itself \[W\].
    pub(crate) fn force_carrier(&mut self, index: usize, power: f64) {
        let place = index * TensionerAccount::LENGTH + 3;
        if let Some(rate) = self.tensioners.get_mut(place) {
            *rate += power;
        }
    }

    /// Sets the rates of a guide: force of the chain \[N\], and what is lost \[W\].
    pub(crate) fn of_guide(&mut self, index: usize, force: [f64; 2], lost: f64) {
        let row = &mut self.guides[index * GuideAccount::LENGTH..];
        row[..3].copy_from_slice(&[force[0], force[1], lost]);
    }

    /// Sets the rates of a tensioner: its coordinate \[m or rad\], its push \[N or N m\], and what is lost \[W\].
    #[inline(always)]
    pub(crate) fn of_tensioner(&mut self, index: usize, rates: [f64; 3]) {
        let row = self.tensioners.get_mut(index * TensionerAccount::LENGTH..);
        if let Some(row) = row.and_then(|row| row.first_chunk_mut::<3>()) {
            *row = rates;
        }
    }
}

impl Accounts {
    /// What has come between another reading and this one.
    #[must_use]
    pub fn since(&self, before: &Self) -> Self {
        self.combined(before, |now, before| now - before)
    }

    /// What has come in this time and another.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        self.combined(other, |own, other| own + other)
    }

    fn combined(&self, other: &Self, with: impl Fn(f64, f64) -> f64 + Copy) -> Self {
        fn each<T>(own: &[T], other: &[T], of: impl Fn(&T, &T) -> T) -> Vec<T> {
            own.iter().zip(other).map(|(a, b)| of(a, b)).collect()
        }

        let pair = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [with(a, c), with(b, d)];
        Self {
            sprockets: each(&self.sprockets, &other.sprockets, |a, b| SprocketAccount {
                work: with(a.work, b.work),
                torque: with(a.torque, b.torque),
                force: pair(a.force, b.force),
                damped: with(a.damped, b.damped),
                forced: with(a.forced, b.forced),
            }),
            shafts: each(&self.shafts, &other.shafts, |a, b| ShaftAccount {
                works: std::array::from_fn(|k| with(a.works[k], b.works[k])),
                angle: with(a.angle, b.angle),
                speed: with(a.speed, b.speed),
            }),
            guides: each(&self.guides, &other.guides, |a, b| GuideAccount {
                force: pair(a.force, b.force),
                lost: with(a.lost, b.lost),
            }),
            tensioners: each(&self.tensioners, &other.tensioners, |a, b| {
                TensionerAccount {
                    course: with(a.course, b.course),
                    push: with(a.push, b.push),
                    lost: with(a.lost, b.lost),
                    forced: with(a.forced, b.forced),
                }
            }),
        }
    }
}
