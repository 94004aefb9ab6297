//! Hashes the sources and presets, and tells what else decides about bits, for the identity of the build.

/// Libraries whose numbers get into results, or into the bytes of checkpoints. A test compares them with the tree of dependencies.
const LIBRARIES: [&str; 18] = [
    "approx",
    "glam",
    "glamx",
    "hdrhistogram",
    "libm",
    "matrixmultiply",
    "nalgebra",
    "num-complex",
    "num-rational",
    "num-traits",
    "ordered-float",
    "parry2d-f64",
    "postcard",
    "pulp",
    "robust",
    "simba",
    "spade",
    "wide",
];

fn main() {
    chaindrive_identity::emit(&["scenes"]);
    chaindrive_identity::emit_surroundings(&LIBRARIES);
}
