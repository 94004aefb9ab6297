//! Why a drive cannot be built, assembled or evaluated.

mod clash;

use chaindrive_contact::ParameterError;
use chaindrive_geometry::GeometryError;

pub use clash::Clash;

/// Why a description is not a drive. Every variant names the place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum DriveError {
    /// A number outside its meaning.
    #[error("{path} = {value}, must be {allowed}")]
    Parameter {
        path: String,
        value: f64,
        allowed: &'static str,
    },

    /// A contact or friction law refuses one of its parameters.
    #[error("{path}.{source}")]
    Law {
        path: String,
        source: ParameterError,
    },

    /// A table of a motion or torque is not usable.
    #[error("table: {problem}")]
    Table { problem: String },

    /// Two bodies occupy the same place.
    #[error(
        "sprockets `{first}` and `{second}` overlap by {:.1} mm; move the centres apart",
        .overlap * 1e3
    )]
    Overlap {
        first: String,
        second: String,
        overlap: f64,
    },

    /// An index refers to nothing.
    #[error("{path} refers to {kind} {index}, but there are {known}")]
    Reference {
        path: String,
        kind: &'static str,
        index: usize,
        known: usize,
    },

    /// Parts that do not go together.
    #[error("{path}: {problem}")]
    Conflict { path: String, problem: String },
}

impl DriveError {
    /// `Ok` when the condition holds, otherwise the parameter error.
    ///
    /// # Errors
    /// [`DriveError::Parameter`] when `ok` is false.
    pub fn require(ok: bool, path: &str, value: f64, allowed: &'static str) -> Result<(), Self> {
        if ok {
            return Ok(());
        }
        Err(Self::Parameter {
            path: path.to_owned(),
            value,
            allowed,
        })
    }

    /// Refuses a number at `place` under `key` that is not finite.
    pub(crate) fn finite(place: &str, key: &str, value: f64) -> Result<(), Self> {
        Self::require(
            value.is_finite(),
            &format!("{place}.{key}"),
            value,
            "finite",
        )
    }
}

impl DriveError {
    /// A law at `path` refuses one of its parameters.
    pub(crate) fn law(path: &str, source: ParameterError) -> Self {
        Self::Law {
            path: path.to_owned(),
            source,
        }
    }

    /// Puts a path within `chain` or `route` after that of one of several chains.
    pub(crate) fn place_in(&mut self, whole: &str) {
        match self {
            Self::Parameter { path, .. }
            | Self::Law { path, .. }
            | Self::Reference { path, .. }
            | Self::Conflict { path, .. } => {
                *path = match path.strip_prefix("chain") {
                    Some(rest) => format!("{whole}{rest}"),
                    None => format!("{whole}.{path}"),
                }
            }
            Self::Table { .. } | Self::Overlap { .. } => {}
        }
    }
}

/// Why a system cannot go on from what another one remembered: it is not of the same drive.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum MemoryError {
    /// Another number of something.
    #[error("it remembers {found} {what}, and this drive has {expected}")]
    Count {
        what: &'static str,
        found: usize,
        expected: usize,
    },

    /// Something that there is not.
    #[error("it remembers {what} {found}, and this drive has {count}")]
    Beyond {
        what: &'static str,
        found: usize,
        count: usize,
    },

    /// Another kind of chain.
    #[error("it remembers another chain model")]
    Model,
}

impl MemoryError {
    /// `Ok` where the number is as expected.
    pub(crate) fn unless(what: &'static str, found: usize, expected: usize) -> Result<(), Self> {
        if found == expected {
            return Ok(());
        }
        Err(Self::Count {
            what,
            found,
            expected,
        })
    }

    /// `Ok` where there are that many.
    pub(crate) fn unless_within(
        what: &'static str,
        found: usize,
        count: usize,
    ) -> Result<(), Self> {
        if found <= count {
            return Ok(());
        }
        Err(Self::Beyond { what, found, count })
    }
}

/// Pull that a sprocket asks of its chain, with all that turns with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Pull {
    /// Name of the sprocket.
    pub sprocket: String,
    /// Torque on it \[N m\], with those that other chains, gears and couplings bring.
    pub given: f64,
    /// The part of it that comes to the chain \[N m\]: less what speeds the shafts up.
    pub torque: f64,
    /// Pull at the pitch circle \[N\].
    pub pull: f64,
    /// Whether it is the sum of what all others ask for, which a motion brings.
    pub is_brought: bool,
}

impl std::fmt::Display for Pull {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let on = if self.is_brought {
            "that the loads ask of"
        } else {
            "on"
        };
        let given = plain(self.given);
        write!(f, "the torque of {given} N m {on} `{}`", self.sprocket)?;
        // What rounding leaves is no difference.
        if (self.given - self.torque).abs() > 1e-3 * self.given {
            let torque = plain(self.torque);
            write!(
                f,
                ", {torque} N m of it at the chain while the drive speeds up,"
            )?;
        }
        write!(f, " asks for a pull of {} kN", plain(self.pull * 1e-3))
    }
}

/// Why a valid drive could not be brought into its initial state.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum AssemblyError {
    /// The chain does not lie around its sprockets.
    #[error(transparent)]
    Geometry(#[from] GeometryError),

    /// The chain does not lie around the stops of its route, by name.
    #[error("{problem}")]
    Route {
        problem: String,
        source: GeometryError,
    },

    /// Newton's iteration for the static state ended without converging.
    #[error(
        "static equilibrium not found while applying {stage}: residual {residual:.1e} of the chain tension after {iterations} iterations; {}{}raise the pretension, or start with `settle = false`",
        .pull.as_ref().map_or_else(String::new, |pull| format!("{pull}: see that the chain and its tensioners can hold that, or lower it; ")),
        if *.tensioned { "see that every tensioner pushes onto the chain (torques are positive counter-clockwise), " } else { "" }
    )]
    NoEquilibrium {
        stage: &'static str,
        residual: f64,
        iterations: usize,
        /// Whether the drive has tensioners.
        tensioned: bool,
        /// The largest pull that a torque asks of a chain, where one does.
        pull: Option<Box<Pull>>,
    },

    /// A tensioner that pushes what it carries away from the chain.
    #[error(
        "tensioner `{tensioner}` pushes {carried} away from the chain, which passes there from {} to {}; {remedy}",
        .between[0], .between[1]
    )]
    PushesAway {
        tensioner: String,
        /// The stops that it carries.
        carried: String,
        /// The stops before and after.
        between: Box<[String; 2]>,
        /// What would make it push onto the chain.
        remedy: String,
    },

    /// A load that breaks the chain before it is in equilibrium.
    #[error(
        "{pull}, and the chain breaks at {} kN; lower the torque, or take a stronger chain",
        plain(.breaking * 1e-3)
    )]
    Overloaded { pull: Pull, breaking: f64 },

    /// A speed at the start other than that of what the shaft is joined with.
    #[error(
        "{shaft}.speed: it turns at {:.2} rpm with what it is joined with, not at {:.2} rpm; leave `speed` out",
        rpm(*.turns),
        rpm(*.asked)
    )]
    StartSpeed {
        shaft: String,
        asked: f64,
        turns: f64,
    },

    /// Torques that never balance.
    #[error(
        "the torques on {} balance at no speed; give a load against the motor, or a speed such as `speed = \"100 rpm\"`",
        .shafts.join(", ")
    )]
    NoWorkingPoint { shafts: Vec<String> },

    /// A linearisation was asked for away from equilibrium.
    #[error(
        "the modes need a static state, but forces are out of balance by {residual:.1e} of the chain tension; let the drive settle"
    )]
    NotStatic { residual: f64 },

    /// One of several chains has one of these problems.
    #[error("chain {chains}: {source}")]
    OfChain { chains: String, source: Box<Self> },

    /// A guide cannot carry the kernel's search along its face.
    #[error("guide `{guide}`: {problem}")]
    Guide { guide: String, problem: String },

    /// Bodies in each other's way, or a chain that runs through a guide.
    #[error("{}", listed(.clashes))]
    Clash { clashes: Vec<Clash> },

    /// A name that no sprocket or guide has.
    #[error("no sprocket or guide is named `{name}`; {known}")]
    UnknownBody { name: String, known: String },

    /// The chain does not lie between the parts as described.
    #[error("{problem}")]
    Layout { problem: String },
}

impl AssemblyError {
    /// The error with the names of the chains that it is about, once, where they have names.
    pub(crate) fn of_chains<'n>(self, names: impl Iterator<Item = Option<&'n String>>) -> Self {
        let names: Option<Vec<String>> = names.map(|name| Some(format!("`{}`", name?))).collect();
        match (self, names) {
            (told @ Self::OfChain { .. }, _) | (told, None) => told,
            (source, Some(names)) => Self::OfChain {
                chains: names.join(", "),
                source: Box::new(source),
            },
        }
    }

    /// An error of the geometry with the names of the stops.
    pub(crate) fn with_names(self, name: &dyn Fn(usize) -> String) -> Self {
        match self {
            Self::Geometry(source) => Self::Route {
                problem: source.with_names(name),
                source,
            },
            other => other,
        }
    }
}

/// A number without hundreds of digits.
fn plain(value: f64) -> String {
    if value.abs() < 1e9 {
        format!("{value:.1}")
    } else {
        format!("{value:.1e}")
    }
}

/// Turns a minute of an angular speed \[rad/s\].
fn rpm(speed: f64) -> f64 {
    speed * 30.0 / std::f64::consts::PI
}

fn listed(clashes: &[Clash]) -> String {
    let told: Vec<_> = clashes.iter().map(Clash::to_string).collect();
    told.join("\n")
}
