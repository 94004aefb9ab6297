//! Verdicts: how far off is allowed, and the lines that the report is made of.

use std::fs::OpenOptions;
use std::io::{self, Write as _};
use std::path::Path;

use serde::Serialize;
use serde_json::Value;

/// Largest difference between the value found and the one expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// |found − expected| ≤ a, in the unit of the quantity.
    Absolute(f64),
    /// |found − expected| ≤ r |expected|.
    Relative(f64),
    /// expected − found ≤ s: it may exceed what was expected, and falls short of it by no more.
    Shortfall(f64),
}

impl Tolerance {
    /// Deviation in parts of what is allowed; nothing beyond 1 is.
    pub(crate) fn share(self, found: f64, expected: f64) -> f64 {
        let (off, allowed) = match self {
            Self::Absolute(most) => ((found - expected).abs(), most),
            Self::Relative(most) => ((found - expected).abs(), most * expected.abs()),
            Self::Shortfall(most) => ((expected - found).max(0.0), most),
        };
        // Exactly right is right, even where nothing is allowed.
        if off > 0.0 || off.is_nan() {
            off / allowed
        } else {
            0.0
        }
    }

    /// Whether it is near enough; a result that is no number never is.
    pub(crate) fn allows(self, found: f64, expected: f64) -> bool {
        found.is_finite() && self.share(found, expected) <= 1.0
    }

    /// As the report reads it: a number in the unit of the quantity, a share of the expected value in per cent, or
    /// a shortfall.
    pub(crate) fn written(self) -> Value {
        match self {
            Self::Absolute(most) => Value::from(most),
            Self::Relative(most) => Value::from(format!("{:?} %", 100.0 * most)),
            Self::Shortfall(most) => Value::from(format!("-{most:?}")),
        }
    }
}

/// Kind of a judgement on a row.
#[derive(Clone, Copy, Debug, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum JudgementKind {
    /// A number within a tolerance.
    #[default]
    Quantitative,
    /// A statement about signs and order.
    Trend,
    /// Not at all, for a reason that the case gives.
    Carried,
}

/// One line of the file that `CHAINDRIVE_VERDICTS` names.
#[derive(Debug, Serialize)]
pub(crate) struct Verdict<'a> {
    pub(crate) case: &'a str,
    /// Where the expected number comes from: "computed" here, "measured" in tests of measured cases.
    pub(crate) kind: &'a str,
    pub(crate) judged: JudgementKind,
    pub(crate) quantity: &'a str,
    pub(crate) unit: &'a str,
    pub(crate) expected: Value,
    pub(crate) found: Value,
    pub(crate) tolerance: Value,
    pub(crate) agrees: bool,
    pub(crate) source: &'a str,
    pub(crate) note: &'a str,
}

impl Default for Verdict<'_> {
    fn default() -> Self {
        Self {
            case: "",
            kind: "computed",
            judged: JudgementKind::Quantitative,
            quantity: "",
            unit: "",
            expected: Value::Null,
            found: Value::Null,
            tolerance: Value::Null,
            agrees: false,
            source: "",
            note: "",
        }
    }
}

/// Appends lines to a file that other threads and processes append to at the same time.
///
/// # Errors
/// The file cannot be written.
pub(crate) fn append(path: &Path, verdicts: &[Verdict<'_>]) -> io::Result<()> {
    let mut lines = String::new();
    for verdict in verdicts {
        lines.push_str(&serde_json::to_string(verdict)?);
        lines.push('\n');
    }
    let mut file = OpenOptions::new().create(true).append(true).open(path)?;
    // Held until the file is closed: lines of one call stay together, however many they are.
    file.lock()?;
    file.write_all(lines.as_bytes())
}

#[cfg(test)]
mod tests {
    use std::panic::catch_unwind;

    use serde_json::json;

    use super::*;
    use crate::Case;

    /// The text of the verdicts, line by line.
    fn lines(path: &Path) -> Vec<Value> {
        let text = std::fs::read_to_string(path).unwrap();
        text.lines()
            .map(|line| serde_json::from_str(line).expect("whole lines"))
            .collect()
    }

    fn case(path: &Path) -> Case {
        let value = json!({
            "source": "theory | practice",
            "carried": [{ "quantity": "sag", "reason": "the weight is not known" }],
        });
        Case::new("Z01", value, Some(path.to_owned()))
    }

    #[test]
    fn tolerances_end_where_they_say() {
        assert!(Tolerance::Absolute(0.1).allows(1.05, 1.0));
        assert!(!Tolerance::Absolute(0.1).allows(1.2, 1.0));
        assert!(Tolerance::Relative(0.1).allows(-21.0, -20.0));
        assert!(!Tolerance::Relative(0.1).allows(20.0, -20.0));
        assert!(!Tolerance::Relative(0.1).allows(1e-9, 0.0));
        assert!(Tolerance::Relative(0.1).allows(0.0, 0.0));
        assert!(Tolerance::Shortfall(0.3).allows(9.0, 4.0));
        assert!(!Tolerance::Shortfall(0.3).allows(3.6, 4.0));
        for wrong in [f64::NAN, f64::INFINITY] {
            assert!(!Tolerance::Absolute(0.1).allows(wrong, 1.0));
            assert!(!Tolerance::Relative(0.1).allows(wrong, 1.0));
            assert!(!Tolerance::Shortfall(0.1).allows(wrong, 1.0));
        }
    }

    /// A test that fails has said so in the report.
    #[test]
    fn a_miss_is_written_down_before_the_test_fails() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("verdicts");
        let missed = catch_unwind(|| {
            let tolerance = Tolerance::Relative(0.02);
            case(&path).judge("tension", "N", 120.0, 100.0, tolerance);
        });
        assert!(missed.is_err());
        let wrong = catch_unwind(|| case(&path).judge_trend("order", "falls", "rises", false));
        assert!(wrong.is_err());
        let verdicts = lines(&path);
        assert_eq!(
            verdicts[0],
            json!({
                "case": "Z01", "kind": "computed", "judged": "quantitative", "quantity": "tension", "unit": "N",
                "expected": 100.0, "found": 120.0, "tolerance": "2.0 %", "agrees": false,
                "source": "theory | practice", "note": "",
            })
        );
        assert_eq!(verdicts[1]["judged"], "trend");
        assert_eq!(verdicts[1]["agrees"], false);
        assert_eq!(verdicts.len(), 2);
    }

    #[test]
    fn what_is_not_judged_needs_a_reason() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("verdicts");
        let tolerance = Tolerance::Absolute(1e-3);
        case(&path).carry("sag", "m", 0.2, 0.1, tolerance);
        assert!(catch_unwind(|| case(&path).carry("pull", "N", 2.0, 1.0, tolerance)).is_err());
        let verdicts = lines(&path);
        assert_eq!(verdicts.len(), 1);
        assert_eq!(verdicts[0]["judged"], "carried");
        assert_eq!(verdicts[0]["note"], "the weight is not known");
    }

    #[test]
    fn lines_of_many_threads_stay_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("verdicts");
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..50 {
                        let values = [1.0; 40];
                        let tolerance = Tolerance::Absolute(0.0);
                        case(&path).judge_each("turn", "rad", &values, &values, tolerance);
                    }
                });
            }
        });
        assert_eq!(lines(&path).len(), 8 * 50 * 40);
    }
}
