//! Hashes the sources, for the identity of the build.

fn main() {
    chaindrive_identity::emit(&[]);
}
