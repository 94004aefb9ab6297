//! The points of a sweep: combinations of values, or rows of a table.

use std::collections::HashMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::dimension::Arrangement;
use super::{CHOSEN, Dimension, MOST, Setting, Sweep, SweepError, dimension};
use crate::scene::{Datum, Scene};
use crate::{Channel, Origin, Run};

/// Variants that are made before a sweep begins, until one of them is a drive. *Assumed*: some milliseconds each.
const TRIED: usize = 24;

/// Everything that decides about the numbers of a sweep: who has it computes the same variants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// The build and the instruction set that the sweep was begun with: others give other bits.
    #[serde(default)]
    pub origin: Origin,
    /// Text of the scene that is varied.
    pub scene: String,
    /// Name of the scene.
    pub scene_name: String,
    /// Channels that are kept.
    pub record: Vec<String>,
    /// Combination of the values into variants.
    pub arrangement: Arrangement,
    /// Paths with their values.
    pub vary: Vec<(String, Vec<Setting>)>,
}

impl Sweep {
    /// Every combination of the values at the paths, in their order; the last path varies fastest.
    /// `record` names channels to keep beside the statistics.
    ///
    /// # Errors
    /// Every value is put into the scene, the first ones of the other paths beside it; what is not of a
    /// scene is refused here, before hours have gone by. Values that do not go together are the failure
    /// of their variants, and refused as [`SweepError::NoDrive`] where that is true of all variants that are tried.
    pub fn new(
        scene: &Scene,
        vary: &[(String, Vec<Setting>)],
        record: &[String],
    ) -> Result<Self, SweepError> {
        let mut len: usize = 1;
        for (_, settings) in vary {
            len = len.saturating_mul(settings.len());
        }
        Self::build(scene, vary, record, Arrangement::Grid, len)
    }

    /// The rows of a table: the first value of each path, then the second of each, and so on.
    ///
    /// # Errors
    /// As [`Sweep::new`], and [`SweepError::Uneven`]. Of the numbers of a column the first, the least, and the greatest are
    /// put into the scene, and the first that is not whole; of everything else each value once.
    pub fn of_table(
        scene: &Scene,
        columns: &[(String, Vec<Setting>)],
        record: &[String],
    ) -> Result<Self, SweepError> {
        let len = columns.first().map_or(0, |(_, settings)| settings.len());
        for (path, settings) in columns {
            if settings.len() != len {
                return Err(SweepError::Uneven {
                    path: path.clone(),
                    rows: settings.len(),
                    first: columns[0].0.clone(),
                    others: len,
                });
            }
        }
        Self::build(scene, columns, record, Arrangement::Table, len)
    }

    fn build(
        scene: &Scene,
        vary: &[(String, Vec<Setting>)],
        record: &[String],
        arrangement: Arrangement,
        len: usize,
    ) -> Result<Self, SweepError> {
        Channel::check(record)?;
        if vary.is_empty() {
            return Err(SweepError::Nothing);
        }
        if let Some((path, _)) = vary.iter().find(|(_, settings)| settings.is_empty()) {
            return Err(SweepError::Empty { path: path.clone() });
        }
        if len > MOST {
            return Err(SweepError::TooMany { most: MOST });
        }
        let mut dimensions = Vec::new();
        let mut places = Vec::new();
        let mut most_samples = 0;
        for (index, (path, settings)) in vary.iter().enumerate() {
            let with = |setting: &Setting| {
                let edits = vary.iter().enumerate().map(|(other, (path, settings))| {
                    let setting = if other == index {
                        setting
                    } else {
                        &settings[0]
                    };
                    setting.edit(scene, path)
                });
                scene.put(&edits.collect::<Result<Vec<_>, _>>()?)
            };
            let first = with(&settings[0])?;
            places.push(new_place(&first, path, &places)?);
            let mut every = None;
            let mut look = |setting: &Setting| {
                // A scene takes a hundred times the memory of its value: none is kept.
                let scene = with(setting)?;
                let defaults = scene.run_defaults();
                if !record.is_empty() {
                    let interval = defaults.every.map(f64::to_bits);
                    if *every.get_or_insert(interval) != interval {
                        return Err(SweepError::Intervals { path: path.clone() });
                    }
                    most_samples = most_samples.max(samples(&Run::suggested(&defaults)));
                }
                Ok(scene.datum(path))
            };
            let data = match arrangement {
                Arrangement::Grid => settings.iter().map(&mut look).collect::<Result<_, _>>()?,
                Arrangement::Table => data_of_column(settings, &mut look)?,
            };
            let dimension = Dimension::new(path, settings.clone(), &data, arrangement)?;
            dimensions.push(dimension);
        }
        dimension::name_all(&mut dimensions);
        let sweep = Self {
            scene: scene.clone(),
            arrangement,
            dimensions: dimensions.into(),
            record: record.to_vec(),
            len,
            most_samples,
            blocks: Arc::default(),
            choices: Arc::default(),
        };
        sweep.check_some()?;
        Ok(sweep)
    }

    /// Refuses values that go together in no variant that is tried: these are spread over the sweep, and one that is a drive
    /// is enough.
    fn check_some(&self) -> Result<(), SweepError> {
        let count = self.len.min(TRIED);
        let mut first = None;
        for number in 0..count {
            let index = number * (self.len - 1) / (count - 1).max(1);
            match self.variant(index).and_then(|scene| scene.drive()) {
                Ok(_) => return Ok(()),
                Err(error) => _ = first.get_or_insert(error),
            }
        }
        match first {
            Some(source) => Err(SweepError::NoDrive {
                tried: count,
                variant: self.label(0),
                source,
            }),
            None => Ok(()),
        }
    }

    /// Everything that others need to compute the same variants.
    pub fn recipe(&self) -> Recipe {
        let vary = self.dimensions.iter();
        Recipe {
            origin: Origin::here(),
            scene: self.scene.text().to_owned(),
            scene_name: self.scene.name().to_owned(),
            record: self.record.clone(),
            arrangement: self.arrangement,
            vary: vary
                .map(|it| (it.path.clone(), it.settings.clone()))
                .collect(),
        }
    }

    /// The sweep of a recipe that was checked before: without names and coordinates, which running a variant does not take.
    ///
    /// # Errors
    /// A scene that is none.
    pub fn of_recipe(recipe: Recipe) -> Result<Self, SweepError> {
        let scene = Scene::from_text(&recipe.scene, &recipe.scene_name)?;
        let counts = recipe.vary.iter().map(|(_, settings)| settings.len());
        let len = match recipe.arrangement {
            Arrangement::Grid => counts.product(),
            Arrangement::Table => counts.max().unwrap_or(0),
        };
        let dimensions = recipe.vary.into_iter();
        Ok(Self {
            scene,
            arrangement: recipe.arrangement,
            dimensions: dimensions
                .map(|(path, settings)| Dimension::unnamed(path, settings))
                .collect(),
            record: recipe.record,
            len,
            most_samples: 0,
            blocks: Arc::default(),
            choices: Arc::default(),
        })
    }

    /// Samples of the longest run among those that were looked at; 0 when no channel is kept.
    pub(crate) fn most_samples(&self) -> usize {
        self.most_samples
    }
}

impl Recipe {
    /// The first thing in which another recipe differs, in words.
    pub fn difference(&self, other: &Self) -> Option<String> {
        if let Some(refusal) = other.origin.refusal() {
            return Some(refusal);
        }
        if self.scene != other.scene {
            let lines = self.scene.lines().zip(other.scene.lines());
            let line = lines.enumerate().find(|(_, (own, its))| own != its);
            return Some(match line {
                Some((number, (own, its))) => {
                    let number = number + 1;
                    format!("line {number} of its scene is `{its}` instead of `{own}`")
                }
                None => "its scene is longer or shorter".to_owned(),
            });
        }
        if self.record != other.record {
            return Some(format!(
                "it keeps the channels [{}] instead of [{}]",
                other.record.join(", "),
                self.record.join(", ")
            ));
        }
        let paths = |of: &Self| {
            let paths = of.vary.iter().map(|(path, _)| format!("`{path}`"));
            paths.collect::<Vec<_>>().join(", ")
        };
        if self.arrangement != other.arrangement || paths(self) != paths(other) {
            let word = |of: &Self| match of.arrangement {
                Arrangement::Grid => "a grid",
                Arrangement::Table => "a table",
            };
            return Some(format!(
                "it is {} of {} instead of {} of {}",
                word(other),
                paths(other),
                word(self),
                paths(self)
            ));
        }
        let mut columns = self.vary.iter().zip(&other.vary);
        columns.find_map(|((path, own), (_, its))| {
            (own != its).then(|| format!("it has other values of `{path}`"))
        })
    }
}

/// Samples of a run from its beginning to its end.
fn samples(run: &Run) -> usize {
    // A count beyond 2⁵³ fits no memory anyway.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive; casts saturate"
    )]
    let whole = (run.until / run.every).max(0.0) as usize;
    whole.saturating_add(1)
}

/// The place of a path in a scene; refused where one of the earlier paths leads there, or where something else decides about it.
fn new_place(first: &Scene, path: &str, earlier: &[String]) -> Result<String, SweepError> {
    let place = first.place(path);
    if earlier.contains(&place) {
        return Err(SweepError::Twice {
            path: path.to_owned(),
        });
    }
    let covered = earlier
        .iter()
        .find(|earlier| first.encloses(&place, earlier));
    if let Some(covered) = covered {
        return Err(SweepError::Covered {
            path: covered.clone(),
            by: path.to_owned(),
        });
    }
    if CHOSEN.contains(&place.as_str()) && first.run_defaults().accuracy.is_some() {
        return Err(SweepError::Chosen {
            path: path.to_owned(),
        });
    }
    Ok(place)
}

/// Kinds of the values of a column in a scene, looked up for as few of them as tell it of all: a table may have a million rows.
fn data_of_column(
    settings: &[Setting],
    look: &mut impl FnMut(&Setting) -> Result<Option<Datum>, SweepError>,
) -> Result<Vec<Option<Datum>>, SweepError> {
    let numbers: Vec<Option<f64>> = settings.iter().map(number).collect();
    let known = numbers.iter().flatten();
    let least = known.clone().copied().fold(f64::INFINITY, f64::min);
    let greatest = known.copied().fold(f64::NEG_INFINITY, f64::max);
    let telling = |number: f64, seen: &[f64]| {
        let broken = number.fract() != 0.0 && seen.iter().all(|it| it.fract() == 0.0);
        seen.is_empty() || number <= least || number >= greatest || broken
    };
    let mut seen = Vec::new();
    let mut unit = None;
    let mut texts = HashMap::new();
    let mut data = Vec::with_capacity(settings.len());
    for (setting, number) in settings.iter().zip(&numbers) {
        let Some(number) = *number else {
            let text = format!("{setting:?}");
            let datum = match texts.get(&text) {
                Some(datum) => Option::clone(datum),
                None => look(setting)?,
            };
            texts.insert(text, datum.clone());
            data.push(datum);
            continue;
        };
        if seen.contains(&number) || !telling(number, &seen) {
            data.push(Some(understood(number, unit)));
            continue;
        }
        let datum = look(setting)?;
        unit = match datum {
            Some(Datum::Quantity(_, unit)) => Some(unit),
            _ => None,
        };
        seen.push(number);
        data.push(datum);
    }
    Ok(data)
}

/// A number of a column of whole numbers, or of quantities with a unit.
fn understood(number: f64, unit: Option<&'static str>) -> Datum {
    match unit {
        Some(unit) => Datum::Quantity(number, unit),
        #[expect(
            clippy::cast_possible_truncation,
            reason = "counts; broken numbers were refused"
        )]
        None => Datum::Whole(number as i64),
    }
}

/// The number of a setting in SI units.
fn number(setting: &Setting) -> Option<f64> {
    match setting {
        Setting::Json(Json::Number(number)) => number.as_f64(),
        Setting::Json(_) | Setting::Text(_) => None,
    }
}
