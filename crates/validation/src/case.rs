//! One folder of `tests/validation`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::verdict::{JudgementKind, Tolerance, Verdict, append};

/// One validation case: inputs, expected numbers, tolerances and their source.
#[derive(Debug)]
pub struct Case {
    id: String,
    value: Value,
    /// The file that verdicts are appended to.
    verdicts: Option<PathBuf>,
}

impl Case {
    /// Reads `tests/validation/<id>/reference.json`.
    ///
    /// # Panics
    /// The file is missing, is no JSON or belongs to another case.
    pub fn read(id: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../tests/validation")
            .join(id)
            .join("reference.json");
        let text = std::fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let value =
            serde_json::from_str(&text).unwrap_or_else(|error| panic!("{id} is no JSON: {error}"));
        let verdicts = std::env::var_os("CHAINDRIVE_VERDICTS").map(PathBuf::from);
        let case = Self::new(id, value, verdicts);
        assert_eq!(case.text("id"), id, "{}", path.display());
        case
    }

    pub(crate) fn new(id: &str, value: Value, verdicts: Option<PathBuf>) -> Self {
        Self {
            id: id.to_owned(),
            value,
            verdicts,
        }
    }

    /// Whether the case lists something at this place.
    pub fn lists(&self, place: &str) -> bool {
        self.find(place).is_some()
    }

    /// A number, such as `inputs.pitch` or, from a list, `expected.frequency.0`.
    ///
    /// # Panics
    /// There is no number.
    pub fn number(&self, place: &str) -> f64 {
        let found = self.at(place).as_f64();
        found.unwrap_or_else(|| panic!("{}: `{place}` is no number", self.id))
    }

    /// A list of numbers.
    ///
    /// # Panics
    /// There is no such list.
    pub fn list(&self, place: &str) -> Vec<f64> {
        serde_json::from_value(self.at(place).clone())
            .unwrap_or_else(|error| panic!("{}: `{place}`: {error}", self.id))
    }

    /// A list of lists of numbers, such as `expected.rows`.
    ///
    /// # Panics
    /// There is no such table.
    pub fn table(&self, place: &str) -> Vec<Vec<f64>> {
        serde_json::from_value(self.at(place).clone())
            .unwrap_or_else(|error| panic!("{}: `{place}`: {error}", self.id))
    }

    /// Names of what stands at a place that holds named things.
    ///
    /// # Panics
    /// Nothing has a name there.
    pub fn names(&self, place: &str) -> Vec<String> {
        let named = self.at(place).as_object();
        let named = named.unwrap_or_else(|| panic!("{}: `{place}` has no names", self.id));
        named.keys().cloned().collect()
    }

    /// Judges a number: asserts that `found` is `expected` within the tolerance, once the verdict is written down.
    ///
    /// The report shows one line for all values of a quantity, the one that is farthest off in parts of its tolerance.
    ///
    /// # Panics
    /// It is not.
    #[track_caller]
    pub fn judge(
        &self,
        quantity: &str,
        unit: &str,
        found: f64,
        expected: f64,
        tolerance: Tolerance,
    ) {
        self.judge_each(quantity, unit, &[found], &[expected], tolerance);
    }

    /// Judges as many numbers of one quantity as are expected.
    ///
    /// # Panics
    /// There are more or fewer, or one is farther off than the tolerance.
    #[track_caller]
    pub fn judge_each(
        &self,
        quantity: &str,
        unit: &str,
        found: &[f64],
        expected: &[f64],
        tolerance: Tolerance,
    ) {
        let id = &self.id;
        assert_eq!(found.len(), expected.len(), "{id}, {quantity}");
        let pairs = || found.iter().copied().zip(expected.iter().copied());
        let verdict = |(found, expected)| Verdict {
            judged: JudgementKind::Quantitative,
            unit,
            expected: Value::from(expected),
            found: Value::from(found),
            tolerance: tolerance.written(),
            agrees: tolerance.allows(found, expected),
            ..self.blank(quantity)
        };
        self.record(&pairs().map(verdict).collect::<Vec<_>>());
        let mut worst = (0.0, 0.0, 0.0);
        for (found, expected) in pairs() {
            let share = tolerance.share(found, expected);
            assert!(
                tolerance.allows(found, expected),
                "{id}, {quantity}: {found} {unit} found, {expected} expected, {share:.3} of the allowed {tolerance:?}"
            );
            if share >= worst.0 {
                worst = (share, found, expected);
            }
        }
        let (share, found, expected) = worst;
        eprintln!(
            "{id}, {quantity}: {found:.6e} for {expected:.6e} {unit}, {share:.1e} of the allowed {tolerance:?}"
        );
    }

    /// Judges a trend, a statement about signs and order that has no single number.
    ///
    /// # Panics
    /// It does not hold.
    #[track_caller]
    pub fn judge_trend(&self, quantity: &str, found: &str, expected: &str, holds: bool) {
        let id = &self.id;
        self.record(&[Verdict {
            judged: JudgementKind::Trend,
            expected: Value::from(expected),
            found: Value::from(found),
            agrees: holds,
            ..self.blank(quantity)
        }]);
        eprintln!("{id}, {quantity}: {found}, expected: {expected}");
        assert!(holds, "{id}, {quantity}: {found}, expected: {expected}");
    }

    /// Writes down a number that no verdict is passed on, for the reason that the case gives.
    ///
    /// The case lists the quantity and the reason in `carried`. The report counts such rows apart and shows them among the misses.
    ///
    /// # Panics
    /// The case gives no reason.
    pub fn carry(
        &self,
        quantity: &str,
        unit: &str,
        found: f64,
        expected: f64,
        tolerance: Tolerance,
    ) {
        let id = &self.id;
        let entries = self.find("carried").and_then(Value::as_array);
        let entry = entries
            .into_iter()
            .flatten()
            .find(|entry| entry["quantity"] == quantity);
        let reason = entry.and_then(|entry| entry["reason"].as_str());
        let reason = reason
            .unwrap_or_else(|| panic!("{id} gives no reason in `carried` to leave out {quantity}"));
        let share = tolerance.share(found, expected);
        eprintln!(
            "{id}, {quantity}, not judged: {found:.6e} for {expected:.6e} {unit}, {share:.1e} of {tolerance:?}"
        );
        self.record(&[Verdict {
            judged: JudgementKind::Carried,
            unit,
            expected: Value::from(expected),
            found: Value::from(found),
            tolerance: tolerance.written(),
            agrees: tolerance.allows(found, expected),
            note: reason,
            ..self.blank(quantity)
        }]);
    }

    fn blank<'a>(&'a self, quantity: &'a str) -> Verdict<'a> {
        Verdict {
            case: &self.id,
            quantity,
            source: self.text("source"),
            ..Verdict::default()
        }
    }

    fn record(&self, verdicts: &[Verdict<'_>]) {
        if let Some(path) = &self.verdicts {
            append(path, verdicts)
                .unwrap_or_else(|error| panic!("CHAINDRIVE_VERDICTS: {}: {error}", path.display()));
        }
    }

    fn text(&self, place: &str) -> &str {
        let found = self.at(place).as_str();
        found.unwrap_or_else(|| panic!("{}: `{place}` is no text", self.id))
    }

    fn at(&self, place: &str) -> &Value {
        let found = self.find(place);
        found.unwrap_or_else(|| panic!("{} has no `{place}`", self.id))
    }

    fn find(&self, place: &str) -> Option<&Value> {
        let mut pointer = String::new();
        for key in place.split('.') {
            write!(pointer, "/{key}").expect("a text grows");
        }
        self.value.pointer(&pointer)
    }
}
