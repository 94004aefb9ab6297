//! Nanoseconds per evaluation of every law, over penetrations and rates of a running chain.

use std::collections::HashSet;
use std::hint::black_box;

use chaindrive_contact::dissipation::LankaraniNikravesh;
use chaindrive_contact::elastic::{ElasticLaw, Power};
use chaindrive_contact::{Approach, Dissipation, Elastic, Friction, Law};
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use serde::Serialize;

/// Contacts in one batch; the time per element is that of one evaluation.
const BATCH: u32 = 1024;

type Group<'a> = BenchmarkGroup<'a, criterion::measurement::WallTime>;

fn approaches() -> Vec<Approach> {
    (0..BATCH)
        .map(|i| {
            let phase = f64::from(i) * 0.618;
            Approach {
                penetration: 2e-6 * (1.01 + phase.sin()),
                rate: 0.4 * phase.cos(),
                onset_rate: 0.5,
            }
        })
        .collect()
}

fn group<'a>(criterion: &'a mut Criterion, name: &str) -> Group<'a> {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(u64::from(BATCH)));
    group
}

fn laws(criterion: &mut Criterion) {
    let approaches = approaches();
    let lossy = Dissipation::LankaraniNikravesh(LankaraniNikravesh { restitution: 0.9 });

    let mut elastics = group(criterion, "elastic");
    let mut seen = HashSet::new();
    for elastic in Elastic::specimens() {
        let name = elastic_name(&elastic);
        if !seen.insert(name.clone()) {
            continue; // another stiffness costs the same
        }
        let law = black_box(elastic);
        elastics.bench_function(format!("{name} force"), |b| {
            b.iter(|| -> f64 { approaches.iter().map(|at| law.force(at.penetration)).sum() });
        });
        elastics.bench_function(format!("{name} energy"), |b| {
            b.iter(|| -> f64 { approaches.iter().map(|at| law.energy(at.penetration)).sum() });
        });
        respond(&mut elastics, &name, with(elastic, lossy), &approaches);
    }
    elastics.finish();

    let mut dissipations = group(criterion, "dissipation");
    let hertz = Elastic::Power(Power {
        stiffness: 6.61e10,
        exponent: 1.5,
    });
    for dissipation in Dissipation::specimens() {
        let name = kind(&dissipation);
        let law = with(hertz, dissipation);
        let asked = black_box(law);
        dissipations.bench_function(format!("{name} force"), |b| {
            b.iter(|| -> f64 { approaches.iter().map(|at| asked.force(*at)).sum() });
        });
        respond(&mut dissipations, &name, law, &approaches);
    }
    dissipations.finish();

    let mut frictions = group(criterion, "friction");
    for friction in Friction::specimens() {
        let name = kind(&friction);
        let law = black_box(friction);
        frictions.bench_function(format!("{name} force"), |b| {
            b.iter(|| -> f64 { approaches.iter().map(|at| law.force(1e3, at.rate)).sum() });
        });
        frictions.bench_function(format!("{name} rub"), |b| {
            b.iter(|| -> f64 {
                approaches
                    .iter()
                    .map(|at| {
                        let rub = law.rub(1e3, at.rate, at.penetration, 1e-6);
                        rub.force + rub.damping + rub.state
                    })
                    .sum()
            });
        });
    }
    frictions.finish();
}

/// Force, stiffness and damping of the prepared law.
fn respond(group: &mut Group<'_>, name: &str, law: Law, approaches: &[Approach]) {
    let law = black_box(law.prepared());
    group.bench_function(format!("{name} respond"), |b| {
        b.iter(|| -> f64 {
            approaches
                .iter()
                .map(|at| {
                    let response = law.respond(*at);
                    response.force + response.stiffness + response.damping
                })
                .sum()
        });
    });
}

fn with(elastic: Elastic, dissipation: Dissipation) -> Law {
    Law {
        series: None,
        elastic,
        dissipation,
        onset_floor: 1e-3,
    }
}

fn elastic_name(elastic: &Elastic) -> String {
    let parameters = serde_json::to_value(elastic).expect("parameters are numbers");
    let detail = match elastic {
        Elastic::Power(power) => format!(" n = {}", power.exponent),
        Elastic::Cylindrical(law) => format!(" n = {:.3}", law.exponent),
        _ => parameters["length_scale"]
            .as_f64()
            .map_or(String::new(), |d| format!(" D = {:.2} mm", 1e3 * d)),
    };
    kind(elastic) + &detail
}

/// The name of a member in files.
fn kind(member: &impl Serialize) -> String {
    let parameters = serde_json::to_value(member).expect("parameters are numbers");
    let kind = parameters["kind"].as_str().expect("members have a name");
    match parameters["restitution"].as_f64() {
        Some(restitution) => format!("{kind} e = {restitution}"),
        None => kind.to_owned(),
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(500))
        .without_plots();
    targets = laws
}
criterion_main!(benches);
