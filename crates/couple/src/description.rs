//! `modelDescription.xml`, after FMI 2.0.5 and FMI 3.0.2 (Modelica Association).

mod units;
mod xml;

use std::collections::BTreeSet;

use crate::export::LIBRARY;
use crate::model::Model;
use crate::variable::{Causality, Choices, EXTRAPOLATION, Kind, SHAFT_INPUT, Variable};

use xml::Xml;

/// A version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standard {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

/// Kinds of messages, as importers filter them.
const CATEGORIES: [(&str, &str); 3] = [
    ("logStatusWarning", "energy that is missing"),
    (
        "logStatusError",
        "refused calls and motions that cannot go on",
    ),
    ("logAll", "calls that an importer may follow"),
];

impl Standard {
    /// The version of a number.
    pub fn of(version: u32) -> Option<Self> {
        match version {
            2 => Some(Self::Two),
            3 => Some(Self::Three),
            _ => None,
        }
    }

    /// The description of a model for importers.
    pub fn description(self, model: &Model) -> String {
        let mut xml = Xml::new();
        let (version, token) = match self {
            Self::Two => ("2.0", "guid"),
            Self::Three => ("3.0", "instantiationToken"),
        };
        let tool = format!("chaindrive {}", env!("CARGO_PKG_VERSION"));
        let identifier = match self {
            Self::Two => format!("{{{}}}", model.token()),
            Self::Three => model.token().to_owned(),
        };
        xml.open(
            "fmiModelDescription",
            &[
                ("fmiVersion", version),
                ("modelName", model.name()),
                (token, &identifier),
                ("description", model.title()),
                ("generationTool", &tool),
                ("variableNamingConvention", "flat"),
            ],
        );
        self.interface(&mut xml);
        units_of(&mut xml, model);
        self.types(&mut xml);
        xml.open("LogCategories", &[]);
        for (name, description) in CATEGORIES {
            xml.empty("Category", &[("name", name), ("description", description)]);
        }
        xml.close("LogCategories");
        let (until, every) = model.suggested();
        xml.empty(
            "DefaultExperiment",
            &[
                ("startTime", "0"),
                ("stopTime", &until.to_string()),
                ("stepSize", &every.to_string()),
            ],
        );
        xml.open("ModelVariables", &[]);
        for (reference, variable) in model.variables().iter().enumerate() {
            match self {
                Self::Two => two(&mut xml, reference, variable),
                Self::Three => three(&mut xml, reference, variable),
            }
        }
        xml.close("ModelVariables");
        self.structure(&mut xml, model);
        xml.close("fmiModelDescription");
        xml.text()
    }

    fn interface(self, xml: &mut Xml) {
        let yes = "true";
        let states = match self {
            Self::Two => ["canGetAndSetFMUstate", "canSerializeFMUstate"],
            Self::Three => ["canGetAndSetFMUState", "canSerializeFMUState"],
        };
        let mut attributes = vec![
            ("modelIdentifier", LIBRARY),
            ("canHandleVariableCommunicationStepSize", yes),
            (states[0], yes),
            (states[1], yes),
        ];
        if self == Self::Two {
            attributes.push(("canInterpolateInputs", yes));
            attributes.push(("canNotUseMemoryManagementFunctions", yes));
        }
        xml.empty("CoSimulation", &attributes);
    }

    fn types(self, xml: &mut Xml) {
        xml.open("TypeDefinitions", &[]);
        for choices in [&SHAFT_INPUT, &EXTRAPOLATION] {
            let named = [("name", choices.name), ("description", choices.description)];
            match self {
                Self::Two => {
                    xml.open("SimpleType", &named);
                    xml.open("Enumeration", &[]);
                    items(xml, choices);
                    xml.close("Enumeration");
                    xml.close("SimpleType");
                }
                Self::Three => {
                    xml.open("EnumerationType", &named);
                    items(xml, choices);
                    xml.close("EnumerationType");
                }
            }
        }
        xml.close("TypeDefinitions");
    }

    /// Outputs depend on no input at the same time: inputs act in the step to come.
    fn structure(self, xml: &mut Xml, model: &Model) {
        let outputs: Vec<_> = model.of_causality(Causality::Output).collect();
        xml.open("ModelStructure", &[]);
        match self {
            Self::Two => {
                for list in ["Outputs", "InitialUnknowns"] {
                    xml.open(list, &[]);
                    for output in &outputs {
                        // Indices count from 1, value references from 0.
                        let index = (output + 1).to_string();
                        xml.empty("Unknown", &[("index", &index), ("dependencies", "")]);
                    }
                    xml.close(list);
                }
            }
            Self::Three => {
                for name in ["Output", "InitialUnknown"] {
                    for output in &outputs {
                        let reference = output.to_string();
                        xml.empty(
                            name,
                            &[("valueReference", &reference), ("dependencies", "")],
                        );
                    }
                }
            }
        }
        xml.close("ModelStructure");
    }
}

fn units_of(xml: &mut Xml, model: &Model) {
    let used: BTreeSet<_> = model
        .variables()
        .iter()
        .filter_map(Variable::unit)
        .collect();
    xml.open("UnitDefinitions", &[]);
    for unit in used {
        xml.open("Unit", &[("name", unit)]);
        let base: Vec<_> = units::base(unit)
            .iter()
            .map(|(name, exponent)| (*name, exponent.to_string()))
            .collect();
        let base: Vec<_> = base.iter().map(|(name, it)| (*name, it.as_str())).collect();
        xml.empty("BaseUnit", &base);
        if let Some((shown, factor)) = units::shown(unit) {
            let factor = factor.to_string();
            xml.empty("DisplayUnit", &[("name", shown), ("factor", &factor)]);
        }
        xml.close("Unit");
    }
    xml.close("UnitDefinitions");
}

fn items(xml: &mut Xml, choices: &Choices) {
    for (index, (name, description)) in choices.items.iter().enumerate() {
        let value = (index + 1).to_string();
        let item = [
            ("name", *name),
            ("value", &value),
            ("description", description),
        ];
        xml.empty("Item", &item);
    }
}

/// Causality, variability and what is said of the value at the start, where it is not the usual.
fn direction(variable: &Variable) -> Vec<(&'static str, &'static str)> {
    let number = matches!(variable.kind, Kind::Real { .. });
    match variable.causality {
        Causality::Independent => vec![("causality", "independent"), ("variability", "continuous")],
        Causality::Input if number => vec![("causality", "input"), ("variability", "continuous")],
        Causality::Input => vec![("causality", "input"), ("variability", "discrete")],
        Causality::Tunable => vec![
            ("causality", "parameter"),
            ("variability", "tunable"),
            ("initial", "exact"),
        ],
        Causality::Output => vec![
            ("causality", "output"),
            ("variability", "continuous"),
            ("initial", "calculated"),
        ],
        Causality::Constant => vec![
            ("causality", "local"),
            ("variability", "constant"),
            ("initial", "exact"),
        ],
    }
}

/// Attributes of the type of a number or choice, and the name of the type.
fn typed(variable: &Variable, real: &'static str) -> (&'static str, Vec<(&'static str, String)>) {
    match &variable.kind {
        Kind::Real { start, .. } => {
            let mut attributes = Vec::new();
            if let Some(unit) = variable.unit() {
                attributes.push(("unit", unit.to_owned()));
                if let Some((shown, _)) = units::shown(unit) {
                    attributes.push(("displayUnit", shown.to_owned()));
                }
            }
            attributes.extend(start.map(|start| ("start", start.to_string())));
            (real, attributes)
        }
        Kind::Choice { of, start } => (
            "Enumeration",
            vec![
                ("declaredType", of.name.to_owned()),
                ("start", start.to_string()),
            ],
        ),
        Kind::Text(_) => ("String", Vec::new()),
    }
}

fn text_of(variable: &Variable) -> Option<String> {
    match &variable.kind {
        Kind::Text(text) => Some(text.to_string_lossy().into_owned()),
        _ => None,
    }
}

fn two(xml: &mut Xml, reference: usize, variable: &Variable) {
    let reference = reference.to_string();
    let mut attributes = vec![
        ("name", variable.name.as_str()),
        ("valueReference", &reference),
        ("description", &variable.description),
    ];
    attributes.extend(direction(variable));
    xml.open("ScalarVariable", &attributes);
    let (name, typed) = typed(variable, "Real");
    let mut typed: Vec<_> = typed
        .iter()
        .map(|(name, it)| (*name, it.as_str()))
        .collect();
    let text = text_of(variable);
    typed.extend(text.as_deref().map(|text| ("start", text)));
    xml.empty(name, &typed);
    xml.close("ScalarVariable");
}

fn three(xml: &mut Xml, reference: usize, variable: &Variable) {
    let reference = reference.to_string();
    let mut attributes = vec![
        ("name", variable.name.as_str()),
        ("valueReference", &reference),
        ("description", &variable.description),
    ];
    attributes.extend(direction(variable));
    let (name, typed) = typed(variable, "Float64");
    attributes.extend(typed.iter().map(|(name, it)| (*name, it.as_str())));
    match text_of(variable) {
        None => xml.empty(name, &attributes),
        Some(text) => {
            xml.open(name, &attributes);
            xml.empty("Start", &[("value", &text)]);
            xml.close(name);
        }
    }
}
