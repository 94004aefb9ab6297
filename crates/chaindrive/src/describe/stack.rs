//! Parts behind the teeth that yield, and the mass that strikes.

use std::fmt;

use chaindrive_mechanics::{Parts, dry_blow};
use schemars::JsonSchema;
use serde::Serialize;

use crate::figure::{Measure, figure};

/// Parts behind the teeth of sprockets that are alike in them.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StackFacts {
    /// Names of the sprockets.
    pub sprockets: Vec<String>,
    /// Force on a tooth at which contacts were made springs \[N\].
    pub load: f64,
    /// Stiffness of all parts together \[N/m\]; absent where nothing yields.
    pub stiffness: Option<f64>,
    /// The parts, from the roller inwards.
    pub terms: Vec<StackTermFacts>,
    /// Mass that strikes in the model, at a joint \[kg\].
    pub lumped_mass: f64,
    /// Mass that would strike at a joint of hinged links \[kg\]; absent where their inertia is not known.
    pub hinged_mass: Option<f64>,
    /// Greatest force of the lumped mass at 1 m/s, dry and without loss \[N\].
    pub dry_blow: f64,
}

/// A part behind the teeth.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StackTermFacts {
    /// Its name.
    pub part: &'static str,
    /// Its stiffness \[N/m\]; absent where it does not yield.
    pub stiffness: Option<f64>,
    /// Share of the force on the tooth that passes it \[–\].
    pub share: f64,
}

impl fmt::Display for StackFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let told = |stiffness: Option<f64>| {
            stiffness.map_or_else(|| "rigid".to_owned(), |it| Measure::Stiffness.told(it))
        };
        write!(
            f,
            "{}: {} at {}",
            self.sprockets.join(", "),
            told(self.stiffness),
            Measure::Force.told(self.load)
        )?;
        for term in &self.terms {
            write!(f, "\n{} {}", term.part, told(term.stiffness))?;
            if term.share < 1.0 {
                write!(f, ", {:.0} % of the force", 100.0 * term.share)?;
            }
        }
        let [lumped, blow] = [figure(self.lumped_mass), Measure::Force.told(self.dry_blow)];
        write!(
            f,
            "\n{lumped} kg strike, at 1 m/s with {blow} if dry and without loss"
        )?;
        match self.hinged_mass {
            Some(hinged) => write!(f, "; hinged links would with {} kg", figure(hinged)),
            None => Ok(()),
        }
    }
}

/// The stacks that a scene asked for.
pub(super) fn of(parts: &Parts) -> Vec<StackFacts> {
    let mut found: Vec<StackFacts> = Vec::new();
    for sprocket in &parts.sprockets {
        let Some(stack) = &sprocket.stack else {
            continue;
        };
        let finite = |compliance: f64| (compliance > 0.0).then(|| compliance.recip());
        let terms = stack.terms.iter().map(|term| StackTermFacts {
            part: term.part,
            stiffness: finite(term.compliance),
            share: term.share,
        });
        let facts = StackFacts {
            sprockets: Vec::new(),
            load: stack.load,
            stiffness: Some(stack.stiffness()).filter(|it| it.is_finite()),
            terms: terms.collect(),
            lumped_mass: stack.striking.lumped,
            hinged_mass: stack.striking.hinged,
            dry_blow: dry_blow(&sprocket.surface.law, stack.striking.lumped, 1.0),
        };
        let alike = found.iter_mut().find(|it| {
            let sprockets = it.sprockets.clone();
            **it == StackFacts {
                sprockets,
                ..facts.clone()
            }
        });
        match alike {
            Some(it) => it.sprockets.push(sprocket.name.clone()),
            None => found.push(StackFacts {
                sprockets: vec![sprocket.name.clone()],
                ..facts
            }),
        }
    }
    found
}
