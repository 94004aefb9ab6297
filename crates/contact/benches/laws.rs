//! Nanoseconds per evaluation of every law, over penetrations and rates of a running chain.

use std::hint::black_box;

use chaindrive_contact::elastic::ElasticLaw;
use chaindrive_contact::{Approach, Dissipation, Elastic, Friction, Law};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

/// Contacts in one batch; the time per element is that of one evaluation.
const BATCH: u32 = 1024;

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

fn laws(criterion: &mut Criterion) {
    let approaches = approaches();
    let mut group = criterion.benchmark_group("force");
    group.throughput(Throughput::Elements(u64::from(BATCH)));
    for law in Law::specimens() {
        group.bench_function(name(&law), |b| {
            let law = black_box(law);
            b.iter(|| -> f64 { approaches.iter().map(|at| law.force(*at)).sum() });
        });
    }
    group.finish();

    let mut group = criterion.benchmark_group("elastic");
    group.throughput(Throughput::Elements(u64::from(BATCH)));
    for elastic in Elastic::specimens() {
        let elastic = black_box(elastic);
        group.bench_function(format!("stiffness {}", elastic_name(&elastic)), |b| {
            b.iter(|| -> f64 {
                approaches
                    .iter()
                    .map(|at| elastic.stiffness(at.penetration))
                    .sum()
            });
        });
    }
    for friction in Friction::specimens() {
        let friction = black_box(friction);
        group.bench_function(format!("{friction:?}"), |b| {
            b.iter(|| -> f64 {
                approaches
                    .iter()
                    .map(|at| friction.force(1e3, at.rate))
                    .sum()
            });
        });
    }
    group.finish();
}

fn elastic_name(elastic: &Elastic) -> String {
    match elastic {
        Elastic::Power(power) => format!("power {}", power.exponent),
        Elastic::Johnson(johnson) => format!("Johnson D = {:.1} mm", johnson.length_scale * 1e3),
    }
}

fn name(law: &Law) -> String {
    let elastic = elastic_name(&law.elastic);
    match law.dissipation {
        Dissipation::None => elastic,
        Dissipation::LankaraniNikravesh(member) => format!("{elastic}, e = {}", member.restitution),
        Dissipation::Viscous(_) => format!("{elastic}, viscous"),
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
