//! Texts that results have of every variant.

/// Message for a variant that was not carried out.
pub(crate) const OPEN: &str = "not carried out: the sweep was stopped";

/// Names and descriptions of the texts that results have of every variant.
pub(crate) const TEXTS: [(&str, &str); 7] = [
    (
        "verdict",
        "whether the numbers can be trusted: trusted, caution or distrusted",
    ),
    ("reasons", "names of what speaks against the numbers"),
    ("verdict_note", "what speaks against the numbers, in words"),
    (
        "chain_verdict",
        "whether the chains may carry their loads: pass, not judged, warning or fail",
    ),
    (
        "chain_reasons",
        "names of the limits that chains do not keep",
    ),
    ("chain_verdict_note", "the same in words"),
    ("error", "what went wrong; empty where nothing did"),
];

/// The text whose chunk is the last of a task: why variants failed; of those not carried out, that they were not.
pub(super) const MARK: &str = "error";

/// The text of a variant for which nothing is stored.
pub(super) fn blank(name: &str) -> &'static str {
    if name == MARK { OPEN } else { "" }
}
