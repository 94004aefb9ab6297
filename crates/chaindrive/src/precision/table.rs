//! The work-precision table as text: to read, and to store.

use std::fmt;
use std::io::Write;

use super::Errors;
use super::work::{Row, Table};
use crate::figure::percent;

/// A column of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// Name.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Description, in a line.
    pub description: &'static str,
    /// Value; NaN where there is none.
    pub value: f64,
}

/// Names of the columns of [`Errors`], in their order.
const ERRORS: [(&str, &str); 10] = [
    (
        "error_span_tension",
        "error of the span tensions up to the horizon, rms over the mean tension",
    ),
    (
        "error_tight_span_tension",
        "error of the tightest span's tension up to the horizon, rms over the mean tension",
    ),
    (
        "error_contact_force",
        "error of the roller-tooth forces up to the horizon, rms over their rms",
    ),
    (
        "error_sprocket_angle",
        "error of the sprockets' rotation up to the horizon, rms over the largest rotation",
    ),
    (
        "error_span_tension_mean",
        "error of the mean span tension over the window",
    ),
    (
        "error_span_tension_rms",
        "error of the root mean square of the span tension over the window",
    ),
    (
        "error_contact_force_p50",
        "error of the median contact force over the window",
    ),
    (
        "error_contact_force_p90",
        "error of the 90th percentile of the contact force over the window",
    ),
    (
        "error_contact_force_p99",
        "error of the 99th percentile of the contact force over the window",
    ),
    (
        "error_mesh_amplitude",
        "error of the tight span's amplitude at the frequency of the passing teeth",
    ),
];

impl Row {
    /// The numbers of a row, in the order of the columns.
    pub fn numbers(&self) -> Vec<Number> {
        let counts = &self.statistics;
        let rejected = counts.rejections + counts.error_rejections + counts.newton_failures;
        let missing = |value: Option<f64>| value.unwrap_or(f64::NAN);
        let or_failed = |count: u64| {
            if self.failure.is_none() {
                count as f64
            } else {
                f64::NAN
            }
        };
        let head = [
            (
                "step",
                "s",
                "step, or longest step under error control",
                missing(self.variant.step),
            ),
            (
                "tolerance",
                "1",
                "relative tolerance under error control",
                missing(self.variant.tolerance),
            ),
            (
                "onset_depth",
                "m",
                "deepest first penetration accepted",
                missing(self.variant.onset_depth),
            ),
            ("wall", "s", "wall time, median", self.wall),
            ("cpu", "s", "time on the processor, median", self.cpu),
            (
                "real_time_factor",
                "1",
                "simulated over wall time",
                self.real_time_factor,
            ),
            ("steps", "1", "accepted steps", or_failed(counts.steps)),
            (
                "evaluations",
                "1",
                "evaluations of the forces",
                or_failed(counts.evaluations),
            ),
            (
                "solves",
                "1",
                "linear equations solved",
                or_failed(counts.solves),
            ),
            (
                "rejections",
                "1",
                "candidate steps rejected",
                or_failed(rejected),
            ),
        ];
        let head = head.map(|(name, unit, description, value)| Number {
            name,
            unit,
            description,
            value,
        });
        let errors = ERRORS.iter().zip(self.errors.columns());
        let errors = errors.map(|((name, description), (_, value))| Number {
            name,
            unit: "1",
            description,
            value,
        });
        head.into_iter().chain(errors).collect()
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
            let remark = row.remark().replace('\n', "; ");
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
fn errors(errors: &Errors) -> String {
    let [p50, p90, p99] = errors.percentiles;
    let columns = [
        errors.tension,
        errors.tight_tension,
        errors.force,
        errors.angle,
        errors.mean,
        errors.rms,
        p50.max(p90).max(p99),
        errors.mesh,
    ];
    columns
        .map(|value| format!("{:>9}", percent(value)))
        .join(" ")
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(ran_in) = &self.ran_in {
            writeln!(f, "{ran_in}")?;
        }
        writeln!(f, "window                   {:.3e} s", self.window)?;
        writeln!(f, "reference                {}", self.reference.describe())?;
        writeln!(
            f,
            "checked by               {}: {} apart in tension, {} in the tight span",
            self.check.describe(),
            percent(self.agreement.tension),
            percent(self.agreement.tight_tension)
        )?;
        if let Some(gap) = &self.gap {
            writeln!(f, "tension                  of the links: {gap}")?;
        }
        writeln!(f, "chaos                    {}", self.horizon.sentence())?;
        writeln!(
            f,
            "  tight span             {}",
            self.horizon.tight_sentence()
        )?;
        writeln!(
            f,
            "times are medians of {}; spread is that of {} replicates; errors are relative; wave: up to the horizon, statistics: over the window",
            self.repeats, self.replicates
        )?;
        writeln!(
            f,
            "{:60} {:>9} {:>9} {:>9} {:>9} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
            "method",
            "wall [s]",
            "cpu [s]",
            "real time",
            "forces",
            "reject",
            "tension",
            "tight",
            "contact",
            "angle",
            "mean T",
            "rms T",
            "contact %",
            "mesh"
        )?;
        for row in &self.rows {
            if let Some(why) = &row.failure {
                writeln!(f, "{:60} {why}", row.variant.describe())?;
                continue;
            }
            let counts = &row.statistics;
            writeln!(
                f,
                "{:60} {:>9.4} {:>9.4} {:>9.3} {:>9} {:>7} {}{}",
                row.variant.describe(),
                row.wall,
                row.cpu,
                row.real_time_factor,
                counts.evaluations,
                counts.rejections + counts.error_rejections + counts.newton_failures,
                errors(&row.errors),
                if row.reference_limited {
                    "  reference limited"
                } else {
                    ""
                }
            )?;
        }
        writeln!(
            f,
            "{:60} {:>47} {}",
            "reference and check apart",
            "",
            errors(&self.agreement)
        )?;
        write!(
            f,
            "{:60} {:>47} {}",
            "spread of replicates",
            "",
            errors(&self.spread)
        )
    }
}
