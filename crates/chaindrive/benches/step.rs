//! Nanoseconds per step of the presets: `cargo bench -p chaindrive --bench step`.
//!
//! Throughput is given in links, so that its inverse is the time per link and step.

use chaindrive::{Method, Scene};
use chaindrive_integrate::SecondOrderSystem;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    for preset in [
        "marine_engine_bare",
        "marine_two_sprockets",
        "industrial_16b",
        "spinning_ring",
        "bicycle",
    ] {
        let scene = Scene::preset(preset).expect("presets are valid");
        let drive = scene.drive().expect("presets resolve");
        let assembled = drive.assemble().expect("presets assemble");
        let links = assembled.system.links() as u64;
        group.throughput(Throughput::Elements(links));
        let scale = assembled.system.time_scale();
        let mut methods = vec![
            Method::Verlet { step: 0.5 * scale },
            Method::Rk4 { step: 0.5 * scale },
        ];
        if assembled.system.prefers_implicit_damping() {
            methods.push(Method::ImplicitDamping {
                step: 1.4 * assembled.system.undamped_time_scale(),
            });
        }
        for method in methods {
            let mut system = assembled.system.clone();
            let mut state = assembled.state();
            let mut stepper = method
                .start(&mut system, &mut state)
                .expect("the step is stable");
            // Into the running state, past the first revolutions of the wheels' windows.
            for _ in 0..2000 {
                stepper
                    .advance(&mut system, &mut state)
                    .expect("the drive runs");
            }
            group.bench_function(format!("{preset}/{}", method.name()), |bencher| {
                bencher.iter(|| {
                    stepper
                        .advance(&mut system, &mut state)
                        .expect("the drive runs")
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
