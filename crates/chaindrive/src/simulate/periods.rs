//! Periods of the slowest forcing, as accepted steps saw them: works and impulses, energies, extremes.

use chaindrive_integrate::{Moment, SecondOrderSystem};
use chaindrive_mechanics::{
    Accounts, Assembled, DriveExtremes, Energy, Observation, Record, Sights, System, WatchPlan,
};
use serde::{Deserialize, Serialize};

use super::{Moving, Simulation};
use crate::Run;

/// What happened from the end of one period of the slowest forcing to that of the next, or to the end of the run.
///
/// Ends of periods lie between steps: works and energies there are those of the method's own interpolation. Extremes are those of
/// the steps that ended in it. None of it depends on when samples are taken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Period {
    /// Beginning and end \[s\].
    pub time: [f64; 2],
    /// Energy at both ends.
    pub energy: [Energy; 2],
    /// What came to the bodies between them.
    pub accounts: Accounts,
    /// Least and greatest of forces, speeds and places.
    pub extremes: DriveExtremes,
}

/// The end of a period.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct PeriodEnd {
    time: f64,
    energy: Energy,
    accounts: Accounts,
}

/// Readings of the spans while one tooth of the fastest sprocket passes. *Assumed*: the third harmonic of the mesh has 21 of them.
const READINGS_A_TOOTH: f64 = 64.0;
/// The same in a run in which nothing turns.
const READINGS_A_RUN: f64 = 4096.0;

/// Share of the greatest span tension by which a link is pressed to count as pressed. *Assumed*: less is the swing of its own mass.
pub(crate) const PRESSED: f64 = 0.05;

/// Forcings that are told from chance. *Assumed*: the slowest disturb means of short records most.
const MOST_FORCINGS: usize = 6;
/// Periods of the slowest forcing in which all are looked at for repeating together, and how near to a whole number of periods.
const TOGETHER: u32 = 12;
const WHOLE: f64 = 1e-6;

/// Numbers in a reading of the spans: time, tensions, pressed links, phases.
pub(super) fn reading_length(system: &System) -> usize {
    let chains = system.chain_sizes();
    let spans: usize = chains.iter().map(|(_, size)| size.spans).sum();
    let phases = system.watch_plan().map_or(0, |plan| plan.forcings.len());
    1 + spans + chains.len() + phases
}

/// Whether so many periods of something go into a time, but for rounding.
fn are_whole(time: f64, period: f64) -> bool {
    let periods = time / period;
    (periods - periods.round()).abs() < WHOLE * periods
}

/// How the steps of a run are watched.
pub(super) fn plan(assembled: &Assembled, run: &Run) -> WatchPlan {
    let drive = &assembled.drive;
    let tooth = assembled.fastest_tooth();
    let period = assembled.slowest_forcing();
    let mut forcings = assembled.forcings();
    forcings.retain(|it| it.period.is_finite());
    let together = |periods: &u32| {
        let time = f64::from(*periods) * period;
        forcings.iter().all(|it| are_whole(time, it.period))
    };
    let together = (1..=TOGETHER).find(together).unwrap_or(1);
    // What is whole in every period disturbs no mean of periods; beside others it does.
    if (forcings.iter()).all(|it| it.shaft.is_none() && are_whole(period, it.period)) {
        forcings.clear();
    }
    forcings.truncate(MOST_FORCINGS);
    WatchPlan {
        begin: assembled.time,
        period,
        together,
        forcings,
        interval: if tooth.is_finite() {
            tooth / READINGS_A_TOOTH
        } else {
            run.until / READINGS_A_RUN
        },
        leaders: (0..drive.sprockets.len())
            .map(|sprocket| drive.leader(sprocket))
            .collect(),
        pressed: PRESSED,
    }
}

impl Moving {
    /// What stands in the accounts at a time \[s\] within the last step, on the clock of the drive.
    fn account_at(&self, time: f64, record: &mut Record) -> PeriodEnd {
        let Self { system, state, .. } = self;
        let (mut q, mut v) = (vec![0.0; state.q.len()], vec![0.0; state.v.len()]);
        let (mut quadratures, mut z) =
            (vec![0.0; state.quadratures.len()], vec![0.0; state.z.len()]);
        state.at(time, &mut q, &mut v);
        state.quadratures_at(time, &mut quadratures);
        state.states_at(time, &mut z);
        let (q, v, z) = (q.as_slice(), v.as_slice(), z.as_slice());
        let at = Moment { t: time, q, v, z };
        let mut seen = Observation::default();
        system.observe_some(Sights::ENERGIES, at, &quadratures, record, &mut seen);
        PeriodEnd {
            time,
            energy: seen.energy,
            accounts: system.accounts(&quadratures),
        }
    }
}

impl PeriodEnd {
    /// The period from this end to another.
    fn to(&self, end: &Self, extremes: DriveExtremes) -> Period {
        Period {
            time: [self.time, end.time],
            energy: [self.energy, end.energy],
            accounts: end.accounts.since(&self.accounts),
            extremes,
        }
    }
}

impl Period {
    /// Tells its times from a zero of the clock on.
    pub(super) fn count_from(&mut self, zero: f64) {
        for time in &mut self.time {
            *time -= zero;
        }
        self.extremes.count_from(zero);
    }

    /// With the period after it.
    #[must_use]
    pub fn and(&self, next: &Self) -> Self {
        let mut extremes = self.extremes.clone();
        extremes.take(&next.extremes);
        Self {
            time: [self.time[0], next.time[1]],
            energy: [self.energy[0], next.energy[1]],
            accounts: self.accounts.and(&next.accounts),
            extremes,
        }
    }

    /// Its length \[s\].
    pub fn length(&self) -> f64 {
        self.time[1] - self.time[0]
    }
}

impl Simulation {
    /// Begins the account where the drive stands.
    pub(super) fn open_account(&mut self) {
        if self.moving.system.watch_plan().is_some() {
            let time = self.moving.state.t;
            self.period_end = self.moving.account_at(time, &mut self.record);
        }
    }

    /// Takes in the periods that ended in the last step.
    pub(super) fn end_periods(&mut self) {
        for (time, extremes) in self.moving.system.hand_out_periods() {
            let end = self.moving.account_at(time, &mut self.record);
            self.periods[1].push(self.period_end.to(&end, extremes));
            self.period_end = end;
        }
    }

    /// Periods of the slowest forcing that ended since the reading or sample before the last one, in a [watched](Run::watched) run.
    ///
    /// They are handed out as [`events`](Self::events) are.
    pub fn periods(&self) -> &[Period] {
        &self.periods[0]
    }

    /// What was read off the spans since the reading or sample before the last one, in a [watched](Run::watched) run: row after row the
    /// time \[s\], the tension of every span \[N\] and the number of pressed links of every chain.
    pub fn span_readings(&self) -> impl Iterator<Item = &[f64]> {
        self.readings[0].chunks_exact(self.reading_length)
    }

    /// Readings of the spans that were not handed out.
    pub fn outstanding_span_readings(&self) -> Vec<Vec<f64>> {
        let zero = self.zero();
        let rows = self.readings[1].chunks_exact(self.reading_length);
        let told = |row: &[f64]| {
            let mut row = row.to_vec();
            row[0] -= zero;
            row
        };
        rows.map(told).collect()
    }

    /// What was not handed out, up to the end of the run or as far as it has come: whole periods, and the one that has not ended, if there is any. The
    /// extremes of the latter include the end of the step that came to the end of the run.
    pub fn outstanding_periods(&self) -> Vec<Period> {
        let system = &self.moving.system;
        let Some(extremes) = system.extremes() else {
            return Vec::new();
        };
        let zero = self.zero();
        let end = self.moving.state.t.min(zero + self.until);
        let mut periods = self.periods[1].clone();
        if end > self.period_end.time {
            let end = self.moving.account_at(end, &mut system.new_record());
            periods.push(self.period_end.to(&end, extremes.clone()));
        }
        for it in &mut periods {
            it.count_from(zero);
        }
        periods
    }
}
