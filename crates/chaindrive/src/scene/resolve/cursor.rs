//! One place of a scene while it is resolved: its path is known once, and what is found there is noted with it.

use chaindrive_geometry::Vector;
use chaindrive_quantities::Ratio;
use serde::Serialize;
use serde_json::{Value as Json, json};

use super::Findings;
use crate::scene::defaults::Default;
use crate::scene::suggest::one_of;

/// A place in the scene, with the findings about all of it.
pub(super) struct Cursor<'f, 't> {
    pub(super) path: String,
    pub(super) findings: &'f mut Findings<'t>,
}

impl<'t> Findings<'t> {
    /// The place at a path.
    pub(super) fn at(&mut self, path: impl Into<String>) -> Cursor<'_, 't> {
        Cursor {
            path: path.into(),
            findings: self,
        }
    }
}

impl<'t> Cursor<'_, 't> {
    /// The place of a key in the table here.
    pub(super) fn key(&mut self, key: &str) -> Cursor<'_, 't> {
        self.findings.at(format!("{}.{key}", self.path))
    }

    /// The place of an entry of the list here.
    pub(super) fn entry(&mut self, index: usize) -> Cursor<'_, 't> {
        self.findings.at(format!("{}[{index}]", self.path))
    }

    /// The same place, for whoever takes it.
    pub(super) fn again(&mut self) -> Cursor<'_, 't> {
        self.findings.at(self.path.as_str())
    }

    /// The number given here, or its default.
    pub(super) fn or(&mut self, given: Option<impl Into<f64>>, default: &Default) -> f64 {
        given.map_or_else(
            || {
                let value = default.value;
                self.assume(value, default.basis.remark());
                value
            },
            Into::into,
        )
    }

    /// The number given here, or a multiple of another that has its unit.
    pub(super) fn or_multiple(
        &mut self,
        given: Option<impl Into<f64>>,
        default: &Default,
        of: f64,
    ) -> f64 {
        given.map_or_else(
            || {
                let (value, remark) = default.multiple(of);
                self.assume(value, remark);
                value
            },
            Into::into,
        )
    }

    /// The member of a family given here, or the default.
    pub(super) fn or_chosen<T: Copy + Serialize>(
        &mut self,
        given: Option<T>,
        choice: &Default<T>,
    ) -> T {
        given.unwrap_or_else(|| {
            let chosen = choice.value;
            self.assume(json!(chosen), choice.basis.remark());
            chosen
        })
    }

    /// Notes what is taken for the absent value.
    pub(super) fn assume(&mut self, value: impl Into<Json>, remark: impl Into<String>) {
        self.findings.assume(&self.path, value, remark);
    }

    /// Notes the member of a family that stands for nothing.
    pub(super) fn assume_kind(&mut self, kind: &str) {
        self.findings.assume_kind(&self.path, kind);
    }

    /// Refuses what is here, with a way out; an empty hint is none.
    pub(super) fn refuse(&mut self, message: impl Into<String>, hint: impl Into<String>) {
        self.findings.refuse_with(&self.path, message, hint);
    }

    /// The same of a value that several bodies share, once.
    pub(super) fn refuse_once(&mut self, message: impl Into<String>, hint: &str) {
        self.findings.refuse_once(&self.path, message, hint);
    }

    /// Refuses those of some keys that are given, because they mean nothing here.
    pub(super) fn refuse_given<const N: usize>(
        &mut self,
        given: [(&str, bool); N],
        message: &str,
        hint: &str,
    ) {
        for (key, _) in given.into_iter().filter(|(_, given)| *given) {
            self.key(key).refuse(message, hint);
        }
    }

    /// Index of the name given here; refused where nothing of its kind is called so.
    pub(super) fn lookup(&mut self, names: &[&str], kind: &str, name: &str) -> Option<usize> {
        let found = names.iter().position(|known| *known == name);
        if found.is_none() {
            self.refuse(format!("no {kind} is named `{name}`"), one_of(name, names));
        }
        found
    }

    /// A direction of any length as a unit vector.
    pub(super) fn direction(&mut self, [x, y]: [Ratio; 2]) -> Option<Vector> {
        let direction = Vector::new(x.0, y.0).try_normalize(f64::MIN_POSITIVE);
        if direction.is_none() {
            self.refuse("a direction must not be zero", "");
        }
        direction.filter(|unit| unit.iter().all(|c| c.is_finite()))
    }

    /// The value, or its error as a problem of this place.
    pub(super) fn keep<T, E: std::fmt::Display>(&mut self, result: Result<T, E>) -> Option<T> {
        self.findings.keep(&self.path, result)
    }
}
