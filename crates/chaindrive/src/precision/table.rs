//! The work-precision table as text: to read, and to store.

use std::fmt::{self, Write as _};
use std::io::Write;

use super::compare::{Errors, Number};
use super::work::{Row, Table};
use crate::figure::percent;
use crate::sheet::{NAMES, aligned, lines};
use crate::terminal_text::cell as text_cell;

macro_rules! numbers {
    ($($name:literal, $unit:literal, $text:literal, $value:expr;)*) => {
        [$(Number { name: $name, unit: $unit, description: $text, value: $value }),*]
    };
}

impl Row {
    /// The numbers of a row, in the order of the columns.
    pub fn numbers(&self) -> Vec<Number> {
        let counts = &self.statistics;
        let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
        let counted = |count: u64| {
            if self.failure.is_none() {
                count as f64
            } else {
                f64::NAN
            }
        };
        let head = numbers! {
            "step", "s", "step, or longest step under error control", or_nan(self.variant.step);
            "tolerance", "1", "relative tolerance under error control", or_nan(self.variant.tolerance);
            "onset_depth", "m", "deepest first penetration accepted", or_nan(self.variant.onset_depth);
            "wall", "s", "wall time, median", self.wall;
            "cpu", "s", "time on the processor, median", self.cpu;
            "real_time_factor", "1", "simulated over wall time", self.real_time_factor;
            "steps", "1", "accepted steps", counted(counts.steps);
            "evaluations", "1", "evaluations of the forces", counted(counts.evaluations);
            "solves", "1", "linear equations solved", counted(counts.solves);
            "rejections", "1", "candidate steps rejected", counted(counts.rejected());
        };
        head.into_iter().chain(self.errors.numbers()).collect()
    }

    /// Remark on the row; empty if there is none.
    pub fn remark(&self) -> &str {
        match &self.failure {
            Some(why) => why,
            None if self.reference_limited => "reference limited",
            None => "",
        }
    }
}

impl Table {
    /// Writes the table as CSV: a heading, one line a row, an empty cell where there is no number; the last
    /// two lines are `agreement` of reference and check and `spread` of the replicates.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn write_csv(&self, to: impl Write) -> Result<(), csv::Error> {
        let mut writer = csv::Writer::from_writer(to);
        let cell = |value: f64| {
            if value.fract() == 0.0 && value.abs() < 1e15 {
                format!("{value:.0}")
            } else if value.is_finite() {
                // The shortest digits that read back to the same number.
                format!("{value:?}")
            } else {
                String::new()
            }
        };
        for (place, row) in self.rows.iter().enumerate() {
            let numbers = row.numbers();
            if place == 0 {
                let names = numbers.iter().map(|number| number.name);
                writer.write_record(["method"].into_iter().chain(names).chain(["remark"]))?;
            }
            let cells = numbers.iter().map(|number| cell(number.value));
            let name = row.variant.stepping.name().to_owned();
            let remark = text_cell(&row.remark().replace('\n', "; ")).into_owned();
            writer.write_record([name].into_iter().chain(cells).chain([remark]))?;
        }
        let remarks = [self.reference.describe(), self.check.describe()].join(" against ");
        let spread = format!("{} replicates", self.replicates);
        for (name, errors, remark) in [
            ("agreement", &self.agreement, remarks),
            ("spread", &self.spread, spread),
        ] {
            // No step, no tolerance, no cost: ten empty cells.
            let cells = errors.columns().map(|(_, value)| cell(value));
            let empty = std::iter::repeat_n(String::new(), 10);
            let name = name.to_owned();
            writer.write_record([name].into_iter().chain(empty).chain(cells).chain([remark]))?;
        }
        Ok(writer.flush()?)
    }
}

/// Errors of one line of the printed table.
fn errors(of: &Errors) -> String {
    let percentiles = of.p50.max(of.p90).max(of.p99);
    let waves = [of.tension, of.tight_tension, of.force, of.angle];
    let columns = waves
        .into_iter()
        .chain([of.mean, of.rms, percentiles, of.mesh]);
    columns.map(percent).collect::<Vec<_>>().join("\t")
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut sheet = String::new();
        self.tell(&mut sheet)?;
        f.write_str(&aligned(sheet.trim_end(), NAMES))
    }
}

impl Table {
    fn tell(&self, sheet: &mut String) -> fmt::Result {
        if let Some(ran_in) = &self.ran_in {
            writeln!(sheet, "{ran_in}")?;
        }
        let (reference, check) = (self.reference.describe(), self.check.describe());
        let apart = [self.agreement.tension, self.agreement.tight_tension];
        let [apart, apart_tight] = apart.map(percent);
        lines! { sheet;
            "window\t{:.3e} s", self.window;
            "reference\t{reference}";
            "checked by\t{check}: {apart} apart in tension, {apart_tight} in the tight span";
        }
        if let Some(gap) = &self.gap {
            lines! { sheet; "tension\tof the links: {gap}"; }
        }
        lines! { sheet;
            "chaos\t{}", self.horizon.sentence();
            "  tight span\t{}", self.horizon.tight_sentence();
            "times are medians of {}; spread is that of {} replicates; errors are relative; wave: up to the horizon, statistics: over the window", self.repeats, self.replicates;
            "method\twall [s]\tcpu [s]\treal time\tforces\treject\ttension\ttight\tcontact\tangle\tmean T\trms T\tcontact %\tmesh";
        }
        for row in &self.rows {
            let method = row.variant.describe();
            if let Some(why) = &row.failure {
                lines! { sheet; "  {method}{}{why}", "\t".repeat(14); }
                continue;
            }
            let (counts, errors) = (&row.statistics, errors(&row.errors));
            let (wall, cpu, ratio) = (row.wall, row.cpu, row.real_time_factor);
            let (forces, rejected) = (counts.evaluations, counts.rejected());
            let limited = if row.reference_limited {
                "\treference limited"
            } else {
                ""
            };
            lines! { sheet;
                "  {method}\t{wall:.4}\t{cpu:.4}\t{ratio:.3}\t{forces}\t{rejected}\t{errors}{limited}";
            }
        }
        lines! { sheet;
            "  reference and check apart\t\t\t\t\t\t{}", errors(&self.agreement);
            "  spread of replicates\t\t\t\t\t\t{}", errors(&self.spread);
        }
        Ok(())
    }
}
