//! The values that are varied, and the dimensions that they become.

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::columns::short;
use super::texts::TEXTS;
use super::{MOST, ResultQuantity, Statistic, SweepError, VARIANT};
use crate::Axis;
use crate::Channel;
use crate::scene::{Datum, Edit, Scene, SceneError, is_number};

/// How the values of several paths become variants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Arrangement {
    /// Every value with every value of the other paths; the last path varies fastest.
    #[default]
    Grid,
    /// The first value of each path, then the second value of each, and so on.
    Table,
}

/// One value for a place in a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Setting {
    /// As on the command line, see [`Scene::replace`].
    Text(String),
    /// As from a program, see [`Scene::replace_json`].
    Json(Json),
}

impl Setting {
    /// `count` values from `first` to `last`, both among them, at equal distances in SI units.
    ///
    /// ```
    /// use chaindrive::Scene;
    /// use chaindrive::sweep::Setting;
    ///
    /// let scene = Scene::preset("marine_engine")?;
    /// let forces = Setting::range(&scene, "route.pretension", "500 N", "2 kN", 4)?;
    /// assert_eq!(forces[1], Setting::Json(1000.0.into()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Ends that are not numbers of the scene, one of them with a unit and the other one, not zero, without;
    /// less than two values; counts, such as teeth, between which `count` whole numbers do not fit evenly.
    pub fn range(
        scene: &Scene,
        path: &str,
        first: &str,
        last: &str,
        count: usize,
    ) -> Result<Vec<Self>, SweepError> {
        let refuse = |reason: String| SweepError::Range {
            path: path.to_owned(),
            range: format!("{first}..{last}/{count}"),
            reason,
        };
        if !(2..=MOST).contains(&count) {
            return Err(refuse(format!("the number of values must be 2 to {MOST}")));
        }
        // A number without a unit is in SI units: beside "140 rpm" 80 would be 80 rad/s.
        let bare = |text: &str| text.trim().parse::<f64>().ok();
        for (one, other) in [(first, last), (last, first)] {
            if bare(one).is_some_and(|number| number != 0.0) && bare(other).is_none() {
                return Err(refuse(format!("give `{}` its unit too", one.trim())));
            }
        }
        let read = |text: &str| Ok::<_, SweepError>(scene.replace(path, text)?.datum(path));
        let shares = (0..count).map(|i| i as f64 / (count - 1) as f64);
        match (read(first)?, read(last)?) {
            (Some(Datum::Whole(first)), Some(Datum::Whole(last))) => {
                let span = last.saturating_sub(first);
                let gaps = i64::try_from(count - 1).unwrap_or(i64::MAX);
                if span % gaps != 0 {
                    return Err(refuse(format!(
                        "only whole numbers are allowed here, and {count} do not fit evenly"
                    )));
                }
                let number = |i: i64| Self::Json((first + span / gaps * i).into());
                Ok((0..=gaps).map(number).collect())
            }
            (Some(Datum::Quantity(first, _)), Some(Datum::Quantity(last, _))) => {
                // Exact at both ends.
                let number = |share: f64| Self::Json((first * (1.0 - share) + last * share).into());
                Ok(shares.map(number).collect())
            }
            _ => Err(refuse("there is no number here to be varied".into())),
        }
    }

    /// The edit that puts it at a path of a scene.
    pub(super) fn edit(&self, scene: &Scene, path: &str) -> Result<Edit, SceneError> {
        match self {
            Self::Text(text) => scene.edit(path, text),
            Self::Json(json) => scene.edit_json(path, json),
        }
    }

    /// Whether it is a number, with a unit or without.
    pub(super) fn is_number(&self) -> bool {
        match self {
            Self::Json(Json::Number(_)) => true,
            Self::Text(text) | Self::Json(Json::String(text)) => is_number(text),
            Self::Json(_) => false,
        }
    }

    /// As it was written.
    pub(super) fn text(&self) -> String {
        match self {
            Self::Text(text) | Self::Json(Json::String(text)) => text.trim().to_owned(),
            Self::Json(json) => json.to_string(),
        }
    }
}

/// Coordinates along a dimension.
#[derive(Clone, Debug, PartialEq)]
pub enum Coordinate {
    /// Quantities in SI units.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Whole(Vec<i64>),
    /// Words, and whatever is neither number nor word as it was written.
    Texts(Vec<String>),
}

impl Coordinate {
    /// Number of entries.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Whole(numbers) => numbers.len(),
            Self::Texts(texts) => texts.len(),
        }
    }

    /// Whether there is no entry.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// An entry as a text; numbers with the shortest digits that read back to the same number.
    pub fn text(&self, index: usize) -> String {
        match self {
            Self::Numbers(numbers) => format!("{:?}", numbers[index]),
            Self::Whole(numbers) => numbers[index].to_string(),
            Self::Texts(texts) => texts[index].clone(),
        }
    }

    /// An entry as a text, with five digits.
    pub(super) fn short(&self, index: usize) -> String {
        match self {
            Self::Numbers(numbers) => short(numbers[index]),
            Self::Whole(_) | Self::Texts(_) => self.text(index),
        }
    }

    /// The first entry that stands twice.
    fn repeated(&self) -> Option<String> {
        let texts = (0..self.len()).map(|i| self.text(i));
        let mut seen = std::collections::HashSet::new();
        texts.into_iter().find(|text| !seen.insert(text.clone()))
    }
}

/// A dimension of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// Name in results: the end of the path, as much of it as is needed.
    pub name: String,
    /// Place in the scene.
    pub path: String,
    /// SI unit of a quantity.
    pub unit: Option<&'static str>,
    /// The values in SI units.
    pub values: Coordinate,
    pub(super) settings: Vec<Setting>,
}

impl Dimension {
    /// Settings of a path, and what they are in their scenes.
    pub(super) fn new(
        path: &str,
        settings: Vec<Setting>,
        data: &[Option<Datum>],
        arrangement: Arrangement,
    ) -> Result<Self, SweepError> {
        let (unit, values) = coordinate(data, &settings);
        if arrangement == Arrangement::Grid
            && let Some(value) = values.repeated()
        {
            return Err(SweepError::Repeated {
                path: path.to_owned(),
                value,
            });
        }
        Ok(Self {
            name: String::new(),
            path: path.to_owned(),
            unit,
            values,
            settings,
        })
    }
}

impl Dimension {
    /// Settings of a path, and nothing else about them.
    pub(super) fn unnamed(path: String, settings: Vec<Setting>) -> Self {
        Self {
            name: path.clone(),
            path,
            unit: None,
            values: Coordinate::Texts(Vec::new()),
            settings,
        }
    }
}

fn coordinate(data: &[Option<Datum>], settings: &[Setting]) -> (Option<&'static str>, Coordinate) {
    let whole = data.iter().map(|datum| match datum {
        Some(Datum::Whole(number)) => Some(*number),
        _ => None,
    });
    if let Some(numbers) = whole.collect::<Option<_>>() {
        return (None, Coordinate::Whole(numbers));
    }
    let quantities = data.iter().map(|datum| match datum {
        Some(Datum::Quantity(number, unit)) => Some((*number, *unit)),
        _ => None,
    });
    if let Some(quantities) = quantities.collect::<Option<Vec<_>>>() {
        let unit = quantities.first().map(|(_, unit)| *unit);
        let numbers = quantities.into_iter().map(|(number, _)| number);
        return (unit, Coordinate::Numbers(numbers.collect()));
    }
    let texts = data.iter().zip(settings).map(|found| match found {
        (Some(Datum::Text(text)), _) => text.clone(),
        (_, setting) => setting.text(),
    });
    (None, Coordinate::Texts(texts.collect()))
}

/// Names every dimension by the end of its path: as many steps as tell it from the others and from
/// everything else in a result.
pub(super) fn name_all(dimensions: &mut [Dimension]) {
    let steps: Vec<Vec<String>> = dimensions.iter().map(|it| steps(&it.path)).collect();
    for (index, dimension) in dimensions.iter_mut().enumerate() {
        let own = &steps[index];
        let ambiguous = |count: usize| {
            let tail = &own[own.len() - count..];
            let others = steps
                .iter()
                .enumerate()
                .filter(|(other, _)| *other != index);
            let shared = others
                .map(|(_, path)| path)
                .any(|path| path.ends_with(tail));
            // The index of a list is no name.
            let unnamed = tail[0].bytes().all(|byte| byte.is_ascii_digit());
            shared || unnamed || is_taken(&tail.join("_"))
        };
        let count = (1..own.len()).find(|&count| !ambiguous(count));
        dimension.name = own[own.len() - count.unwrap_or(own.len())..].join("_");
    }
}

fn steps(path: &str) -> Vec<String> {
    let steps = path.split(['.', '[', ']']).map(str::trim);
    let steps = steps.filter(|step| !step.is_empty());
    steps.map(|step| step.replace(' ', "_")).collect()
}

/// Whether a result has something else of this name.
fn is_taken(name: &str) -> bool {
    let axes = Axis::ALL.iter().filter_map(|axis| axis.name());
    let channels = Channel::ALL.iter().map(|channel| channel.name());
    let statistics = Statistic::ALL.iter().map(|statistic| statistic.name());
    let along = Statistic::ALL
        .iter()
        .filter_map(|it| ResultQuantity::Statistic(*it).along());
    let own = ["time", "event", VARIANT]
        .into_iter()
        .chain(TEXTS.map(|(name, _)| name));
    axes.chain(channels)
        .chain(statistics)
        .chain(along)
        .chain(own)
        .any(|taken| taken == name)
}
