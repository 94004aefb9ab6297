//! Nanoseconds per step of a long spring chain: what the stepping itself costs.

use std::hint::black_box;

use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State};
use criterion::{Criterion, criterion_group, criterion_main};

/// Masses between springs, fixed at both ends.
struct Springs {
    count: usize,
}

impl SecondOrderSystem for Springs {
    type Record = ();

    fn new_record(&self) {}

    fn dofs(&self) -> usize {
        self.count
    }

    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], _: &mut [f64], (): &mut ()) {
        let q = at.q;
        let last = q.len() - 1;
        a[0] = q[1] - 2.0 * q[0];
        a[last] = q[last - 1] - 2.0 * q[last];
        for (a, q) in a[1..last].iter_mut().zip(q.windows(3)) {
            *a = q[0] - 2.0 * q[1] + q[2];
        }
    }
}

fn step(criterion: &mut Criterion) {
    let mut system = Springs { count: 244 };
    let start: Vec<f64> = (0..244).map(|i| (0.1 * f64::from(i)).sin()).collect();
    for method in Method::specimens(0.25) {
        let mut state = State::new(0.0, start.clone(), vec![0.0; 244]);
        let mut stepper = method
            .start(&mut system, &mut state)
            .expect("the springs are sound");
        criterion.bench_function(&format!("{}, 244 coordinates", method.name()), |b| {
            b.iter(|| black_box(stepper.advance(&mut system, &mut state)));
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).without_plots();
    targets = step
}
criterion_main!(benches);
