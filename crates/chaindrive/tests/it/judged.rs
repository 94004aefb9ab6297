//! Runs of presets to their end, and the verdict on them.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::page::{Page, numerics};
use chaindrive::{Judgement, Reason, Run, Scene, Simulation, Summary, Verdict};

/// A preset with changes, each `path = value`.
pub(crate) fn preset(name: &str, changes: &[(&str, &str)]) -> Scene {
    let scene = Scene::preset(name).unwrap();
    changes.iter().fold(scene, |scene, (path, value)| {
        scene.replace(path, value).unwrap()
    })
}

/// Values of a drive without friction in its joints and compliance behind its contacts, set going with the kick of the polygons.
const BARE: [(&str, &str); 8] = [
    ("route.start", "polygon"),
    ("route.pretension_at", "phase"),
    ("contact.teeth.series", "0"),
    ("contact.teeth.dissipation", "lankarani-nikravesh"),
    ("contact.guides.dissipation", "lankarani-nikravesh"),
    ("contact.joints.series", "0"),
    ("contact.joints.friction", "none"),
    ("contact.joints.dissipation", "lankarani-nikravesh"),
];

/// A preset with these values for what it leaves open: its twins part within milliseconds, and small steps go wrong.
pub(crate) fn bare(name: &str) -> Scene {
    let scene = Scene::preset(name).unwrap();
    let text = scene.json();
    if text.get("sprockets").is_none() {
        return scene;
    }
    let open = |path: &str| {
        text.pointer(&format!("/{}", path.replace('.', "/")))
            .is_none()
    };
    let changes = BARE.iter().filter(|(path, _)| open(path));
    changes.fold(scene.clone(), |scene, (path, value)| {
        scene.replace(path, value).unwrap()
    })
}

/// A run of so many samples.
pub(crate) fn run(until: f64, samples: f64) -> Run {
    Run {
        until,
        every: until / samples,
        ..Run::default()
    }
}

/// A run to its end, with its contacts.
pub(crate) fn finished(scene: &Scene, run: &Run) -> (Simulation, Summary) {
    let run = Run {
        watched: true,
        ..run.clone()
    };
    let mut simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
    let mut summary = Summary::new(&simulation);
    while simulation.next_sample().unwrap().is_some() {
        summary.take(&simulation);
    }
    summary.end(&simulation);
    (simulation, summary)
}

/// The verdict on a run whose error nobody estimated.
pub(crate) fn verdict(scene: &Scene, run: &Run) -> Verdict {
    let (simulation, summary) = finished(scene, run);
    let unknown = Judgement::SwitchedOff;
    Verdict::of(&summary, &simulation, None, None, Some(&unknown))
}

pub(crate) fn names(verdict: &Verdict) -> Vec<&'static str> {
    verdict.reasons.iter().map(Reason::name).collect()
}

pub(crate) fn notes(verdict: &Verdict) -> Vec<&'static str> {
    verdict.notes.iter().map(Reason::name).collect()
}

/// The page of a run, and its numerics.
pub(crate) fn page(summary: &Summary, simulation: &Simulation) -> String {
    let verdict = Verdict::of(summary, simulation, None, None, None);
    let page = Page::of(&verdict, summary, simulation, None, None, &[]);
    let numerics = numerics(&verdict, summary, simulation, None, None);
    format!("{page}\n{numerics}")
}
