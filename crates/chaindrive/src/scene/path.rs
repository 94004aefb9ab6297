//! Dotted paths of values in a scene.

/// The steps of a dotted path: `sprockets[1].teeth` is `sprockets`, `1`, `teeth`.
pub(crate) fn steps(path: &str) -> impl Iterator<Item = String> + '_ {
    path.split(['.', '[', ']'])
        .map(|step| step.trim().to_owned())
        .filter(|step| !step.is_empty())
}

/// Appends a key to a path.
pub(crate) fn push_step(path: &mut String, step: &str) {
    if step.bytes().all(|b| b.is_ascii_digit()) {
        path.push('[');
        path.push_str(step);
        path.push(']');
        return;
    }
    if !path.is_empty() {
        path.push('.');
    }
    path.push_str(step);
}
