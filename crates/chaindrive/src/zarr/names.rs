//! Names of the files of a store beside its arrays.

/// State from which a run goes on, beside the arrays.
pub(crate) const CHECKPOINT: &str = "checkpoint";

/// The document that makes a folder a Zarr group.
pub(crate) const GROUP: &str = "zarr.json";

/// The object that tells one store from another that is begun in its place later.
pub(crate) const IDENTITY: &str = "identity";

/// Begins the end of the name of a file on its way, the number of its process; readers of the store know no such key.
pub(crate) const STAGED: char = '#';

/// Recipe of a sweep.
pub(crate) const RECIPE: &str = "sweep.json";

/// How the arrays of a sweep are cut.
pub(crate) const LAYOUT: &str = "layout.json";

/// Lock of the layout.
const LOCK: &str = "layout.lock";

/// Folder of the choices of method and step that a sweep has made.
pub(crate) const CHOICES: &str = "choices";

/// Files of a sweep beside its arrays, and a folder of them.
pub(crate) const OF_SWEEPS: [&str; 4] = [RECIPE, LAYOUT, LOCK, CHOICES];
