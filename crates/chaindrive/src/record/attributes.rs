//! Attributes of a result: one list, in memory and in a store.
//!
//! All are texts, numbers, or lists of these, so that they survive a conversion to netCDF, which
//! knows neither truth values nor tables.

use chaindrive_integrate::Method;
use chaindrive_mechanics::MissingRating;
use std::time::Duration;

use serde_json::{Map, Value};

use crate::RunInReport;
use crate::Summary;
use crate::clock::Instant;
use crate::page::{Page, numerics};
use crate::precision::{Choice, Judgement};
use crate::rating::Rating;
use crate::statistic::Statistic;
use crate::story::{Ending, Story};
use crate::{Reason, Run, Scene, Simulation, Stepping, Verdict};

/// Origin of a run: scene, versions, run-in and choice of method.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// Title of the scene, in a line.
    pub title: String,
    /// The text that reproduces the scene, changes included.
    pub scene: String,
    /// The scene in full, with the settings as they were in the end; none before the run begins.
    pub resolved_scene: Option<String>,
    /// Inputs that were assumed, see [`Scene::assumed`].
    pub assumed: Vec<String>,
    /// File or preset it was read from.
    pub scene_name: String,
    /// Settings of the run.
    pub run: Run,
    /// Simulated time between two checkpoints \[s\], where they are asked for.
    pub checkpoint_every: Option<f64>,
    /// The run-in, if there was one.
    pub ran_in: Option<RunInReport>,
    /// Choice of method and step, if one was made.
    pub choice: Option<Choice>,
    /// When somebody asked for it, or for it to go on.
    pub began: Instant,
    /// Wall time spent before it was stopped, if it was.
    pub earlier: Duration,
}

impl Provenance {
    /// The provenance of a scene that is run.
    pub fn of(scene: &Scene, run: &Run) -> Self {
        Self {
            title: scene.title().to_owned(),
            scene: scene.text().to_owned(),
            resolved_scene: None,
            assumed: Vec::new(),
            scene_name: scene.name().to_owned(),
            run: run.clone(),
            checkpoint_every: None,
            ran_in: None,
            choice: None,
            began: Instant::now(),
            earlier: Duration::ZERO,
        }
    }

    /// Wall time since somebody asked for it, times at which it was stopped not counted.
    pub(crate) fn wall_time(&self) -> Duration {
        self.earlier + self.began.elapsed()
    }
}

/// Everything that a result says about itself; what sums it up only at the end, where there are a summary and a verdict.
///
/// Wall times are the only attributes that two runs of one request do not share: `stepping_time`, `real_time_factor`,
/// `ns_per_link_step`, `wall_time`, and the line `speed` in `numerics`.
pub fn attributes(
    provenance: &Provenance,
    simulation: &Simulation,
    ended: Option<(&Summary, &Verdict)>,
    samples: u64,
    ending: &Ending,
    judgement: Option<&Judgement>,
) -> Map<String, Value> {
    let mut story = Story::of(&provenance.title, ending);
    story.text("scene_name", &provenance.scene_name);
    story.text("scene", &provenance.scene);
    if let Some(text) = &provenance.resolved_scene {
        story.text("resolved_scene", text);
    }

    story.number("until", provenance.run.until);
    if let Some(ran_in) = &provenance.ran_in {
        story.number("run_in", ran_in.time);
        if let Some(is_steady) = ran_in.is_steady {
            story.count("run_in_steady", u64::from(is_steady));
        }
    }
    story.number("every", provenance.run.every);
    // Of a run that is over, checkpoints make no other one.
    if let (Some(every), Ending::None) = (provenance.checkpoint_every, ending) {
        story.number("checkpoint_every", every);
    }
    story.number("time_reached", simulation.time());
    story.count("samples", samples);
    method(&mut story, simulation.method());
    if let Some(depth) = simulation.system().onset_depth() {
        story.number("onset_depth", depth);
    }
    let statistics = simulation.statistics();
    story.count("steps", statistics.steps);
    story.count("rejections", statistics.rejections);
    story.count("error_rejections", statistics.error_rejections);
    story.count("reductions", statistics.reductions);
    story.count("evaluations", statistics.evaluations);
    story.count("solves", statistics.solves);
    story.count("newton_failures", statistics.newton_failures);
    story.count("jumps", statistics.jumps);
    story.number("smallest_step", statistics.smallest_step);
    story.number("largest_step", statistics.largest_step);
    story.number("energy_residual_last", simulation.energy_residual());
    if let Some((summary, _)) = ended {
        story.number("energy_supplied", summary.energy_supplied());
        story.number("energy_dissipated", summary.energy_dissipated());
        story.number("energy_moved", summary.energy_moved());
        let ledger = summary.ledger();
        if let Some([efficiency, uncertain]) = ledger.efficiency() {
            story.number("efficiency", efficiency);
            story.number("efficiency_error", uncertain);
        }
        if let Some(why) = ledger.unknown() {
            story.text("efficiency_unknown", why);
        }
        if summary.slowest_forcing().is_finite() {
            story.number("slowest_forcing", summary.slowest_forcing());
        }
        let ratings = summary.ratings();
        let one = ratings.len() == 1;
        for it in &ratings {
            rating(&mut story, it, one);
        }
        story.number("energy_residual_largest", summary.residual);
        story.number("contact_force_largest", summary.greatest_contact());
        let links = summary.link_tension();
        if links.greatest.is_finite() {
            story.number("link_tension_greatest", links.greatest);
            story.number("link_tension_greatest_at", links.greatest_at);
        }
        for it in summary.impacts().iter().filter(|it| it.count > 0) {
            for (statistic, value) in Statistic::of_impacts(it) {
                let name = format!("{}_{}", statistic.name(), it.sprocket);
                match statistic {
                    Statistic::ImpactCount => story.count(&name, it.count),
                    _ => story.number(&name, value),
                }
            }
        }
    }
    assembly(&mut story, simulation);
    speed(&mut story, simulation, provenance.wall_time());
    let choice = provenance.choice.as_ref();
    let mut is_missed = false;
    if let Some((summary, verdict)) = ended {
        let ran_in = provenance.ran_in.as_ref();
        let assumed = &provenance.assumed;
        let page = Page::of(verdict, summary, simulation, ran_in, judgement, assumed);
        story.text("summary", &page.to_string());
        // Texts and lists of texts always become JSON.
        story.text("page", &serde_json::to_string(&page).unwrap_or_default());
        let numerics = numerics(verdict, summary, simulation, choice, judgement);
        story.text("numerics", &numerics);
        let missed = |it: &Reason| matches!(it, Reason::AccuracyMissed { .. });
        is_missed = verdict.reasons.iter().any(missed);
    }
    let verdict = ended.map(|(_, verdict)| verdict.attributes());
    let choice = choice.map(|it| it.attributes(is_missed));
    let judgement = judgement.map(Judgement::attributes);
    // A percentile that the impacts are too few to tell has no error.
    let struck = ended.into_iter().flat_map(|(summary, _)| summary.impacts());
    let few = struck.filter(|it| !it.tells(0.99));
    let few: Vec<String> = few
        .map(|it| format!("error_impact_force_p99_{}", it.sprocket))
        .collect();
    let all = [verdict, choice, judgement].into_iter().flatten().flatten();
    let all = all.filter(|(name, _)| !few.contains(name));
    story.0.extend(all);
    story.0
}

/// Ratings of the chains; of several chains each says its own.
fn rating(story: &mut Story, of: &Rating, is_only: bool) {
    let named = |what: &str| {
        if is_only {
            what.to_owned()
        } else {
            format!("{what}_{}", of.chain)
        }
    };
    if of.sprocket.is_some() {
        if let (Ok(limits), Some((by, power))) = (&of.limits, of.governing()) {
            story.number(&named("power_carried"), of.carried);
            story.number(&named("power_rated"), power);
            story.text(&named("power_limited_by"), by.name());
            for limit in limits {
                if let Some(power) = limit.power {
                    story.number(&named(&format!("power_limit_{}", limit.by.name())), power);
                }
            }
            story.number(&named("strand_factor"), of.strand_factor);
            story.number(&named("service_factor"), of.service_factor);
        }
        if let Err(why @ MissingRating::SourceMissing { .. }) = of.limits {
            story.number(&named("power_carried"), of.carried);
            story.text(&named("power_unrated"), &why.to_string());
            if let Some(twin) = of.twin {
                story.number(&named("power_twin"), twin);
            }
            story.number(&named("service_factor"), of.service_factor);
        }
        if let Some(class) = of.lubrication {
            story.text(&named("lubrication"), class.name());
        }
    }
    if let Some(limit) = of.wear_limit {
        story.number(&named("wear_limit"), limit.elongation);
        story.text(&named("wear_limit_by"), limit.bound.words());
    }
    if let Some([least, greatest]) = of.life {
        story.number(&named("life_least"), least);
        story.number(&named("life_greatest"), greatest);
    }
    let numbers = [
        ("greatest_tension", of.greatest_tension),
        ("tight_pull", of.tight_pull),
        ("static_safety", of.static_safety),
        ("dynamic_safety", of.dynamic_safety),
        ("bearing_pressure", of.bearing_pressure),
    ];
    for (name, number) in numbers {
        if let Some(number) = number {
            story.number(&named(name), number);
        }
    }
    for load in &of.shaft_loads {
        story.number(&format!("shaft_load_{}", load.sprocket), load.force);
        story.number(&format!("shaft_load_angle_{}", load.sprocket), load.angle);
    }
}

/// Cost of the run.
fn speed(story: &mut Story, simulation: &Simulation, wall_time: Duration) {
    let wall = simulation.stepping_time();
    let steps = simulation.statistics().steps.max(1) as f64;
    let link_steps = steps * simulation.system().links() as f64;
    story.number("stepping_time", wall);
    story.number("real_time_factor", simulation.time() / wall);
    story.number("ns_per_link_step", wall * 1e9 / link_steps);
    story.number("wall_time", wall_time.as_secs_f64());
}

fn method(story: &mut Story, method: Method) {
    story.text("method", Stepping::from(method).name());
    story.count("method_order", u64::from(method.order()));
    for (name, value) in method.parameters() {
        story.number(name, value);
    }
}

fn assembly(story: &mut Story, simulation: &Simulation) {
    let (system, assembled) = (simulation.system(), simulation.assembled());
    story.count("links", system.links() as u64);
    story.count("rollers", system.rollers() as u64);
    story.count("degrees_of_freedom", system.free_dofs() as u64);
    let chains = system.chain_sizes();
    for ((chain, _), fitting) in chains.iter().zip(&assembled.fittings) {
        let Some(fitting) = fitting else { continue };
        // Of several chains each says its own.
        let named = |what: &str| match chains.len() {
            1 => what.to_owned(),
            _ => format!("{what}_{chain}"),
        };
        story.number(&named("closing_strain"), fitting.strain);
        story.number(&named("closing_travel"), fitting.travel);
        let seated = fitting.seated.iter().copied();
        story.list(&named("pitches_seated"), seated);
        let spans = fitting.spans.iter().copied();
        story.list(&named("pitches_in_spans"), spans);
    }
    if !assembled.statics.is_empty() {
        let statics = &assembled.statics;
        story.list("static_stages", statics.iter().map(|s| s.stage));
        story.list("static_iterations", statics.iter().map(|s| s.iterations));
        story.list("static_residuals", statics.iter().map(|s| s.residual));
    }
}
