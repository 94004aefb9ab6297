//! The run that another one is compared with: with its step fixed, and sharper.

use chaindrive_mechanics::Assembled;

use crate::Run;

/// The run with the step that it would choose for itself, so that other samples do not change it.
pub(super) fn pinned(start: &Assembled, run: &Run) -> Run {
    Run {
        step: Some(run.method(&start.system).step()),
        ..run.clone()
    }
}

/// The same run, sharper, and in what.
pub(super) fn sharper(start: &Assembled, run: &Run) -> (Run, &'static str) {
    let onset_depth = run.onset_depth.map(|depth| 0.1 * depth);
    if run.method(&start.system).is_adaptive() {
        let better = Run {
            tolerance: 0.1 * run.tolerance,
            onset_depth,
            ..run.clone()
        };
        return match onset_depth {
            Some(_) => (better, "a tenth of the tolerance and of the onset depth"),
            None => (better, "a tenth of the tolerance"),
        };
    }
    let better = Run {
        step: run.step.map(|step| 0.5 * step),
        onset_depth,
        ..run.clone()
    };
    match onset_depth {
        Some(_) => (better, "half the step and a tenth of the onset depth"),
        None => (better, "half the step"),
    }
}
