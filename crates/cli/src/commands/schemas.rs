//! `chaindrive schema`: the form of scenes, and of what commands print with `--json`.

use chaindrive::Description;
use chaindrive::scene::schema as scene_schema;
use clap::{Args, ValueEnum};
use serde_json::Value;

use super::check::Checked;
use super::design::Layouts;
use super::lists::{ChainList, ChannelList};
use super::scenes::{Differences, Resolved};
use super::{run, sweep};
use crate::answer::{answer, schema_of};
use crate::complaint::Complaint;
use crate::failure::Failure;

/// Prints the JSON Schema of scene files, or of what a command prints with `--json`.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A command; `error` is what stands on stderr where a command with `--json` fails
    #[arg(value_enum, default_value_t = Form::Scene)]
    of: Form,
}

/// Forms of documents.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Form {
    Scene,
    Run,
    Sweep,
    Check,
    Describe,
    Design,
    Diff,
    Resolve,
    Catalogue,
    Channels,
    CheckData,
    Compare,
    Calibrate,
    Predict,
    NextMeasurement,
    Uncertainty,
    Tornado,
    Error,
}

impl Form {
    fn schema(self) -> Value {
        match self {
            Self::Scene => scene_schema(),
            Self::Run => schema_of::<run::Answer>(),
            Self::Sweep => schema_of::<sweep::Answer>(),
            Self::Check => schema_of::<Checked>(),
            Self::Describe => schema_of::<Description>(),
            Self::Design => schema_of::<Layouts<'_>>(),
            Self::Diff => schema_of::<Differences>(),
            Self::Resolve => schema_of::<Resolved>(),
            Self::Catalogue => schema_of::<ChainList>(),
            Self::Channels => schema_of::<ChannelList>(),
            Self::CheckData => of_package(include_str!("../../schemas/check-data.schema.json")),
            Self::Compare => of_package(include_str!("../../schemas/compare.schema.json")),
            Self::Calibrate => of_package(include_str!("../../schemas/calibrate.schema.json")),
            Self::Predict => of_package(include_str!("../../schemas/predict.schema.json")),
            Self::NextMeasurement => {
                of_package(include_str!("../../schemas/next-measurement.schema.json"))
            }
            Self::Uncertainty => of_package(include_str!("../../schemas/uncertainty.schema.json")),
            Self::Tornado => of_package(include_str!("../../schemas/tornado.schema.json")),
            Self::Error => schema_of::<Complaint>(),
        }
    }
}

/// The form of what the Python package prints; its tests hold the answers against it.
fn of_package(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_default()
}

pub(crate) fn schema(arguments: &Arguments) -> Result<(), Failure> {
    answer(&arguments.of.schema())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published beside the sources, as the schema of scenes is.
    #[test]
    fn the_shipped_schemas_are_current() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas");
        for form in Form::value_variants()
            .iter()
            .filter(|form| **form != Form::Scene)
        {
            let name = form.to_possible_value().map(|it| it.get_name().to_owned());
            let path = folder.join(format!("{}.schema.json", name.unwrap_or_default()));
            let current = form.schema();
            if std::env::var_os("UPDATE_SCHEMA").is_some() {
                std::fs::create_dir_all(&folder).unwrap();
                std::fs::write(&path, format!("{current:#}\n")).unwrap();
            }
            let shipped = std::fs::read_to_string(&path).unwrap_or_default();
            assert_eq!(
                serde_json::from_str::<Value>(&shipped).ok(),
                Some(current),
                "{}: run this test with UPDATE_SCHEMA=1 to write the schemas anew",
                path.display()
            );
        }
    }
}
