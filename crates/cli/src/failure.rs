//! Failures of a command, with their exit codes.

use std::convert::Infallible;
use std::io::ErrorKind;

use chaindrive::record::{ReadError, ResumeError, WriteError};
use chaindrive::scene::SceneError;
use chaindrive::sweep::SweepError;
use chaindrive::{ProgramError, RequestError, SimulationError};

/// Exit code of bad input; also that of arguments the parser refuses.
pub(crate) const BAD_INPUT: u8 = 2;

/// Exit code of a mistake of the program; programs of Unix have it for their own ones.
pub(crate) const PROGRAM: u8 = 70;

/// Why a command did not do what was asked.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// The scene is wrong; its message has a line a problem.
    #[error(transparent)]
    Scene(#[from] SceneError),

    /// An argument is wrong.
    #[error("{0}")]
    Argument(String),

    /// Several scenes were looked at, and some are wrong; the messages are out.
    #[error("{}", wrong_scenes(*.wrong, *.scenes))]
    Scenes { wrong: usize, scenes: usize },

    /// The run could not begin.
    #[error("{scene}: {source}")]
    Start {
        scene: String,
        source: SimulationError,
    },

    /// The run could not go on.
    #[error("{scene}: {source}")]
    Simulation {
        scene: String,
        source: SimulationError,
    },

    /// The values to vary are wrong, or the machine refuses threads.
    #[error(transparent)]
    Sweep(SweepError),

    /// The sweep is through, but without some variants; their messages are out.
    #[error("{failed} of {variants} variants failed")]
    Variants { failed: usize, variants: usize },

    /// The result could not be written.
    #[error("{0}{remedy}", remedy = remedy_of(.0))]
    Write(#[from] WriteError),

    /// There is nothing to go on with.
    #[error(transparent)]
    Resume(ResumeError),

    /// There is nothing to look at.
    #[error(transparent)]
    Read(#[from] ReadError),

    /// The result could not be written.
    #[error("{path}: {source}{}", remedy(.source))]
    File {
        path: String,
        source: std::io::Error,
    },

    /// The target is taken.
    #[error("{path}: {found}; choose another name{hint}")]
    Taken {
        path: String,
        found: &'static str,
        hint: &'static str,
    },

    /// The result contradicts itself, and the user wants to be told by the exit code; what speaks against it is out.
    #[error("{scene}: distrusted, and --strict was asked for")]
    Distrusted { scene: String },

    /// The chain is too weak, and the user wants to be told by the exit code; what it exceeds is out.
    #[error("{scene}: the chain fails, and --strict was asked for")]
    Overloaded { scene: String },

    /// The user stopped the run.
    #[error("interrupted")]
    Interrupted,

    /// The program made a mistake.
    #[error(transparent)]
    Program(ProgramError),
}

impl From<Infallible> for Failure {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}

/// What to do where a file cannot be written.
fn remedy(error: &std::io::Error) -> &'static str {
    match error.kind() {
        ErrorKind::NotFound => "; make the folder first, or choose another",
        ErrorKind::NotADirectory => "; choose a place in a folder",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "; choose a place where you may write"
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "; make room, or choose another place"
        }
        _ => "",
    }
}

fn remedy_of(error: &WriteError) -> &'static str {
    match error {
        WriteError::Io { source, .. } => remedy(source),
        _ => "",
    }
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::Write(error) => Self::Write(error),
            other => Self::Sweep(other),
        }
    }
}

impl From<ResumeError> for Failure {
    fn from(error: ResumeError) -> Self {
        match error {
            ResumeError::Store(error) => Self::Write(error),
            other => Self::Resume(other),
        }
    }
}

fn wrong_scenes(wrong: usize, scenes: usize) -> String {
    match (wrong, scenes) {
        (_, 1) => "the scene is wrong".to_owned(),
        (1, _) => format!("1 of {scenes} scenes is wrong"),
        _ => format!("{wrong} of {scenes} scenes are wrong"),
    }
}

impl Failure {
    /// The result for a scene, unless the user did not want to wait for it.
    pub(crate) fn or_interrupted<T>(
        done: Result<T, SimulationError>,
        scene: &str,
    ) -> Result<T, Self> {
        done.map_err(|source| match source {
            SimulationError::Interrupted => Self::Interrupted,
            source => Self::Start {
                scene: scene.to_owned(),
                source,
            },
        })
    }

    /// The mistake in a request.
    pub(crate) fn request(error: RequestError, scene: &str) -> Self {
        match error {
            RequestError::Setting(source) => Self::Start {
                scene: scene.to_owned(),
                source,
            },
            RequestError::Scene(error) => error.into(),
            error => Self::Argument(error.to_string()),
        }
    }

    /// File, scene or result that it is about, where it is known.
    pub(crate) fn place(&self) -> Option<String> {
        match self {
            Self::Scene(error) | Self::Sweep(SweepError::Scene(error)) => {
                Some(error.source_name.clone())
            }
            Self::Start { scene, .. }
            | Self::Simulation { scene, .. }
            | Self::Distrusted { scene }
            | Self::Overloaded { scene } => Some(scene.clone()),
            Self::File { path, .. } | Self::Taken { path, .. } => Some(path.clone()),
            Self::Write(WriteError::Io { path, .. }) => Some(path.display().to_string()),
            _ => None,
        }
    }

    /// The mistakes in a scene, if it is about some.
    pub(crate) fn scene_error(&self) -> Option<&SceneError> {
        match self {
            Self::Scene(error) | Self::Sweep(SweepError::Scene(error)) => Some(error),
            _ => None,
        }
    }

    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Simulation { .. } | Self::Variants { .. } => 1,
            Self::Scene(_)
            | Self::Argument(_)
            | Self::Scenes { .. }
            | Self::Start { .. }
            | Self::Resume(_)
            | Self::Read(_)
            | Self::Sweep(_) => BAD_INPUT,
            Self::Write(_) | Self::File { .. } | Self::Taken { .. } => 3,
            Self::Distrusted { .. } => 4,
            Self::Overloaded { .. } => 5,
            Self::Program(_) => PROGRAM,
            Self::Interrupted => crate::INTERRUPTED,
        }
    }
}
