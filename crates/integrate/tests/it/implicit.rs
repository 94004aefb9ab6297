//! Promises of implicit methods: stiff damping, energy, annihilation, and steps that cannot be solved.
#![allow(clippy::print_stdout, reason = "measured numbers are worth a look")]

use crate::problems;

use chaindrive_integrate::{
    IntegrationError, Method, Moment, SecondOrderSystem, State, StateQuantity, Stepper, Verdict,
    Weights,
};
use problems::Oscillator;

/// A mass on a spring and a damper, both hardening with the amplitude, pushed by a constant force.
#[derive(Clone, Debug)]
struct Mass {
    /// k/m \[1/s²\].
    stiffness: f64,
    /// Cubic part of the spring \[1/(m² s²)\].
    hardening: f64,
    /// c/m at q = 0 \[1/s\].
    damping: f64,
    /// Growth of the damping with q² \[1/(m² s)\].
    thickening: f64,
    /// Acceleration by the push \[m/s²\].
    push: f64,
    /// Candidates longer than this are sent back \[s\].
    longest: f64,
    /// Steps longer than this are not solved \[s\].
    solvable: f64,
    /// Share of the true derivatives that the solution reckons with.
    share: f64,
    /// Whether steps of one solution carry the stiffness as inertia.
    carries: bool,
}

impl Mass {
    /// Linear, with everything allowed.
    fn linear(stiffness: f64, damping: f64) -> Self {
        Self {
            stiffness,
            hardening: 0.0,
            damping,
            thickening: 0.0,
            push: 0.0,
            longest: f64::INFINITY,
            solvable: f64::INFINITY,
            share: 1.0,
            carries: false,
        }
    }

    fn nonlinear() -> Self {
        Self {
            hardening: 3.0,
            thickening: 2.0,
            push: 0.3,
            ..Self::linear(1.0, 0.2)
        }
    }

    fn energy(&self, state: &State) -> f64 {
        0.5 * (state.v[0] * state.v[0] + self.stiffness * state.q[0] * state.q[0])
    }

    /// Starts at q = 1, v = 0.5.
    fn start(&mut self, method: Method) -> (Stepper<Self>, State) {
        let mut state = State::new(0.0, vec![1.0], vec![0.5]);
        let stepper = method.start(self, &mut state).expect("starts");
        (stepper, state)
    }
}

impl SecondOrderSystem for Mass {
    /// C and K where the evaluation was.
    type Record = (f64, f64);
    fn new_record(&self) -> (f64, f64) {
        (0.0, 0.0)
    }
    fn dofs(&self) -> usize {
        1
    }
    fn quadratures(&self) -> usize {
        1
    }
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64], linear: &mut (f64, f64)) {
        let (q, v) = (at.q[0], at.v[0]);
        let damping = self.damping + self.thickening * q * q;
        a[0] = self.push - (self.stiffness + self.hardening * q * q) * q - damping * v;
        rates[0] = damping * v * v;
        *linear = (
            damping,
            self.stiffness + 3.0 * self.hardening * q * q + 2.0 * self.thickening * q * v,
        );
    }
    fn inspect(&self, h: f64, _: &(f64, f64)) -> Verdict {
        if h > self.longest {
            Verdict::Retry { at_most: 0.5 * h }
        } else {
            Verdict::Accept
        }
    }
    /// The exact limit of Verlet.
    fn time_scale(&self) -> f64 {
        1.0 / (self.damping + self.damping.hypot(self.stiffness.sqrt()))
    }
    fn undamped_time_scale(&self) -> f64 {
        1.0 / self.stiffness.sqrt()
    }
    fn carried_time_scale(&self) -> f64 {
        if self.carries {
            f64::INFINITY
        } else {
            self.undamped_time_scale()
        }
    }
    fn can_solve(&self) -> bool {
        true
    }
    fn solve(&self, weights: Weights, (c, k): &mut (f64, f64), x: &mut [f64]) -> bool {
        let carried = if weights.once && !self.carries {
            0.0
        } else {
            weights.stiffness
        };
        x[0] /= 1.0 + self.share * (weights.damping * *c + carried * *k);
        weights.damping <= self.solvable
    }
}

fn generalized_alpha(step: f64, spectral_radius: f64) -> Method {
    Method::GeneralizedAlpha {
        step,
        spectral_radius,
    }
}

/// λh = 1e4: far beyond Verlet, and the mass creeps as the damper lets it, q̇ = (g − ω² q)/λ.
#[test]
fn stiff_damping_creeps() {
    let step = 0.1;
    let mut system = Mass {
        push: 2.0,
        ..Mass::linear(1.0, 1e5)
    };
    let mut state = State::new(0.0, vec![1.0], vec![0.5]);
    let error = Method::Verlet { step }
        .start(&mut system, &mut state)
        .unwrap_err();
    assert!(matches!(error, IntegrationError::StepTooLarge { .. }));

    // Generalized-α does not resolve how the damper stops the mass: it begins with the creep.
    for (method, speed) in Method::implicit_specimens(step)
        .into_iter()
        .zip([0.5, 1e-5])
    {
        let mut state = State::new(0.0, vec![1.0], vec![speed]);
        let mut stepper = method.start(&mut system, &mut state).unwrap();
        for _ in 0..100_000 {
            stepper.advance(&mut system, &mut state).unwrap();
        }
        // q = g − (g − q₀) e^(−t/λ), but for q̇₀/λ at the start
        let exact = 2.0 - (-1e4 / 1e5_f64).exp();
        let creep = (2.0 - state.q[0]) / 1e5;
        println!("{}: q off by {:.1e}", method.name(), state.q[0] - exact);
        assert!((state.q[0] - exact).abs() < 2e-5, "{}", method.name());
        assert!((state.v[0] / creep - 1.0).abs() < 1e-3, "{}", method.name());
    }
}

/// Springs carried as inertia have no limit: (1 + hλ + (ωh)²/4)(z − 1)² + h (ω² h z + λ (z − 1)) is 4 + 2 hλ at z = −1.
#[test]
fn carried_stiffness_is_stable_with_every_step() {
    for (step, damping) in [(1.8, 0.0), (20.0, 0.0), (20.0, 0.3), (1e3, 0.0), (1e3, 1e3)] {
        let mut system = Mass {
            carries: true,
            ..Mass::linear(1.0, damping)
        };
        let (mut stepper, mut state) = system.start(Method::ImplicitDamping { step });
        // (1 + h²/4) v² + q² − h v q = v² + (q − h v/2)² is kept without damping, and bounds q.
        let (q, v) = (state.q[0], state.v[0]);
        let bound = (1.0 + 0.5 * step) * v.hypot(q - 0.5 * step * v) * (1.0 + 1e-9);
        for _ in 0..20_000 {
            stepper.advance(&mut system, &mut state).unwrap();
            assert!(state.q[0].abs() < bound, "h = {step}, λ = {damping}");
        }
    }
}

/// Carrying the stiffness leaves it of second order: the frequency is 2/h asin(ωh/√(4 + (ωh)²)) = 2/h atan(ωh/2), that of the trapezoidal rule.
#[test]
fn carried_stiffness_swings_as_with_the_trapezoidal_rule() {
    for step in [0.1, 0.5, 2.0] {
        let mut system = Mass {
            carries: true,
            ..Mass::linear(1.0, 0.0)
        };
        let (mut stepper, mut state) = system.start(Method::ImplicitDamping { step });
        let angle = 2.0 * f64::atan(0.5 * step);
        // q[n + 1] + q[n − 1] = 2 cos(ω′h) q[n] for every n.
        let mut q = vec![state.q[0]];
        for _ in 0..100 {
            stepper.advance(&mut system, &mut state).unwrap();
            q.push(state.q[0]);
        }
        for three in q.windows(3) {
            let error = three[0] + three[2] - 2.0 * angle.cos() * three[1];
            assert!(error.abs() < 1e-12, "h = {step}: {error}");
        }
    }
}

/// The limit of stability of stiffness that is left out is ωh = 2 whatever the damping, as documented: (ωh)² < 2 (2 + λh).
#[test]
fn implicit_damping_is_stable_to_its_limit() {
    for damping in [0.0, 0.3, 3.0, 1e3] {
        let mut system = Mass::linear(1.0, damping);
        let (mut stepper, mut state) = system.start(Method::ImplicitDamping { step: 1.8 });
        for _ in 0..20_000 {
            stepper.advance(&mut system, &mut state).unwrap();
            assert!(state.q[0].abs() < 10.0, "λ = {damping}");
        }
    }
    let mut state = State::new(0.0, vec![1.0], vec![0.5]);
    let error = Method::ImplicitDamping { step: 1.85 }
        .start(&mut Mass::linear(1.0, 1.0), &mut state)
        .unwrap_err();
    println!("{error}");
    assert!(matches!(error, IntegrationError::StepTooLarge { limit, .. }
        if (limit - 1.8).abs() < 1e-12));
}

/// Symplectic Euler conserves v² + q² − h v q to rounding, for ever; so energy stays within a band.
#[test]
fn energy_does_not_drift_with_implicit_damping() {
    let (mut system, step) = (Mass::linear(1.0, 0.0), 0.1);
    let (mut stepper, mut state) = system.start(Method::ImplicitDamping { step });
    let neighbour = |state: &State| {
        let (q, v) = (state.q[0], state.v[0]);
        v * v + q * q - step * v * q
    };
    let (first, energy) = (neighbour(&state), system.energy(&state));
    let mut band: f64 = 0.0;
    for _ in 0..1_000_000 {
        stepper.advance(&mut system, &mut state).unwrap();
        band = band.max((system.energy(&state) / energy - 1.0).abs());
    }
    let drift = neighbour(&state) / first - 1.0;
    println!("band {band:.1e}, drift {drift:.1e}");
    assert!(band < step);
    assert!(drift.abs() < 1e-11);
    let counts = stepper.statistics();
    assert_eq!(counts.evaluations, counts.steps + 1);
    assert_eq!(counts.solves, counts.steps);
}

/// ρ = 1 is the trapezoidal rule on linear problems, which conserves quadratic energies.
#[test]
fn energy_is_conserved_with_generalized_alpha_at_one() {
    for step in [0.1, 3.0] {
        let mut system = Mass::linear(1.0, 0.0);
        let (mut stepper, mut state) = system.start(generalized_alpha(step, 1.0));
        let energy = system.energy(&state);
        for _ in 0..1_000_000 {
            stepper.advance(&mut system, &mut state).unwrap();
        }
        let drift = system.energy(&state) / energy - 1.0;
        println!("step {step}: drift {drift:.1e}");
        assert!(drift.abs() < 1e-9);
        // A correction, and a look that there is no more.
        let counts = stepper.statistics();
        assert_eq!(counts.evaluations, 2 * counts.steps + 1);
        assert_eq!(
            (counts.solves, counts.newton_failures),
            (2 * counts.steps, 0)
        );
    }
}

/// A mode with ωh → ∞ keeps the share ρ of its amplitude per step; nothing with ρ = 0.
#[test]
fn spectral_radius_is_what_stiff_modes_keep() {
    let mut system = Mass::linear(1e12, 0.0);
    let amplitude = |radius: f64, steps: u32| {
        let mut system = system.clone();
        let (mut stepper, mut state) = system.start(generalized_alpha(1.0, radius));
        for _ in 0..steps {
            stepper.advance(&mut system, &mut state).unwrap();
        }
        state.q[0].abs()
    };
    let annihilated = amplitude(0.0, 6);
    println!("ρ = 0: {annihilated:.1e} after six steps");
    assert!(annihilated < 1e-9);
    for radius in [0.3, 0.8, 0.95] {
        // Multiple roots at infinity: the amplitude goes like n ρⁿ or n² ρⁿ, a matter of a per cent here.
        let kept = (amplitude(radius, 300) / amplitude(radius, 100)).powf(1.0 / 200.0);
        println!("ρ = {radius}: keeps {kept:.3}");
        assert!((kept / radius - 1.0).abs() < 0.02);
    }
    assert!(
        Method::GeneralizedAlpha {
            step: 1.0,
            spectral_radius: 1.0
        }
        .start(&mut system, &mut State::new(0.0, vec![1.0], vec![0.0]))
        .is_ok()
    );
}

/// Rejected candidates, whether sent back or not solved, change no bit of what follows.
#[test]
fn rejected_steps_leave_no_trace() {
    let run = |method: Method, system: &Mass| {
        let mut system = system.clone();
        let (mut stepper, mut state) = system.start(method);
        for _ in 0..40 {
            stepper.advance(&mut system, &mut state).unwrap();
        }
        (state, *stepper.statistics())
    };
    let free = Mass::nonlinear();
    let strict = Mass {
        longest: 0.125,
        ..free.clone()
    };
    for (long, short) in Method::implicit_specimens(0.5)
        .into_iter()
        .zip(Method::implicit_specimens(0.125))
    {
        let (expected, direct) = run(short, &free);
        let (found, counts) = run(long, &strict);
        assert_eq!((counts.rejections, direct.rejections), (80, 0));
        assert_eq!(found, expected, "{}", long.name());
        if let Method::ImplicitDamping { .. } = long {
            // Three candidates and two more looks at the beginning a step.
            assert_eq!(counts.evaluations, 1 + 40 * 5);
            assert_eq!(counts.solves, 40 * 3);
        }

        let brittle = Mass {
            // Newton's weight of the damping, not the step itself: between those of 0.25 and 0.125.
            solvable: if long.order() == 1 { 0.2 } else { 0.1 },
            ..free.clone()
        };
        let (found, counts) = run(long, &brittle);
        assert_eq!((counts.rejections, counts.newton_failures), (0, 80));
        assert_eq!(found, expected, "{}", long.name());
        assert!((counts.largest_step - 0.125).abs() < 1e-15);
    }
}

/// A step that no length makes solvable is an error, not a hang; the state is the last accepted one.
#[test]
fn a_step_that_is_never_solved_ends_the_run() {
    for method in Method::implicit_specimens(0.5) {
        let mut system = Mass::nonlinear();
        let (mut stepper, mut state) = system.start(method);
        stepper.advance(&mut system, &mut state).unwrap();
        let before = state.clone();
        system.solvable = 0.0;
        let error = stepper.advance(&mut system, &mut state).unwrap_err();
        println!("{}: {error}", method.name());
        let IntegrationError::StepUnderflow { t, step } = error else {
            panic!("{error}");
        };
        assert!((t - 0.5).abs() < 1e-15 && (step / 0.5e-3 - 1.0).abs() < 1e-9);
        assert_eq!(state, before);
        assert_eq!(stepper.statistics().newton_failures, 11);
    }
}

/// Derivatives that are off by half cost iterations and change nothing else.
#[test]
fn approximate_derivatives_will_do() {
    let run = |share: f64| {
        let mut system = Mass {
            share,
            ..Mass::nonlinear()
        };
        let (mut stepper, mut state) = system.start(generalized_alpha(0.02, 0.8));
        for _ in 0..500 {
            stepper.advance(&mut system, &mut state).unwrap();
        }
        (state, *stepper.statistics())
    };
    let (exact, few) = run(1.0);
    let (found, many) = run(0.5);
    let error = (found.q[0] - exact.q[0]).abs();
    println!(
        "off by {error:.1e}; {} and {} solutions",
        few.solves, many.solves
    );
    assert!(error < 1e-9);
    assert!(few.solves <= 3 * few.steps && many.solves > few.solves);
    assert_eq!(many.newton_failures, 0);
}

/// Between the steps velocities stay between those of the ends, also where a stiff damper stops the mass in one step.
#[test]
fn nothing_overshoots_between_the_steps() {
    let mut system = Mass::linear(1.0, 1e5);
    let (mut stepper, mut state) = system.start(Method::ImplicitDamping { step: 0.1 });
    for _ in 0..3 {
        let before = state.clone();
        stepper.advance(&mut system, &mut state).unwrap();
        let (mut q, mut v) = ([0.0], [0.0]);
        for part in [0.0, 0.1, 0.3, 0.5, 0.8, 1.0] {
            state.at(before.t + part * 0.1, &mut q, &mut v);
            let between = |x: f64, a: f64, b: f64| x >= a.min(b) - 1e-15 && x <= a.max(b) + 1e-15;
            assert!(between(v[0], before.v[0], state.v[0]));
            assert!(between(q[0], before.q[0], state.q[0]));
        }
    }
}

#[test]
fn a_system_that_cannot_solve_is_refused() {
    struct Explicit;
    impl SecondOrderSystem for Explicit {
        type Record = ();
        fn new_record(&self) {}
        fn dofs(&self) -> usize {
            1
        }
        fn evaluate(&self, _: Moment<'_>, a: &mut [f64], _: &mut [f64], (): &mut ()) {
            a[0] = -1.0;
        }
    }
    for method in Method::implicit_specimens(0.1) {
        let mut state = State::new(0.0, vec![0.0], vec![0.0]);
        let error = method.start(&mut Explicit, &mut state).unwrap_err();
        let expected = IntegrationError::Unsupported {
            method: method.name(),
        };
        assert_eq!(error, expected);
        assert!(error.to_string().contains("Verlet"), "{error}");
        println!("{error}");
    }
}

#[test]
fn parameters_are_checked() {
    let start = |method: Method| {
        let mut state = State::new(0.0, vec![0.0], vec![0.0]);
        method.start(&mut Oscillator, &mut state).map(|_| ())
    };
    for radius in [-0.1, 1.1, f64::NAN] {
        assert!(matches!(
            start(generalized_alpha(0.1, radius)),
            Err(IntegrationError::Parameter {
                parameter: "spectral_radius",
                ..
            })
        ));
    }
    for step in [0.0, f64::NAN] {
        for method in Method::implicit_specimens(step) {
            assert!(matches!(
                start(method),
                Err(IntegrationError::Parameter {
                    parameter: "step",
                    ..
                })
            ));
        }
    }
}

/// A force becomes NaN at t = 1; that is not a matter of the step.
#[test]
fn a_nan_stops_the_run_and_says_where() {
    struct Breaking;
    impl SecondOrderSystem for Breaking {
        type Record = ();
        fn new_record(&self) {}
        fn dofs(&self) -> usize {
            2
        }
        fn evaluate(&self, at: Moment<'_>, a: &mut [f64], _: &mut [f64], (): &mut ()) {
            a.fill(0.1);
            if at.t >= 1.0 {
                a[1] = f64::NAN;
            }
        }
        fn can_solve(&self) -> bool {
            true
        }
        fn solve(&self, _: Weights, (): &mut (), _: &mut [f64]) -> bool {
            true
        }
    }
    for method in Method::implicit_specimens(0.01) {
        let mut state = State::new(0.0, vec![0.0; 2], vec![1.0; 2]);
        let mut stepper = method.start(&mut Breaking, &mut state).unwrap();
        let error = loop {
            if let Err(error) = stepper.advance(&mut Breaking, &mut state) {
                break error;
            }
            assert!(state.t < 1.0, "{}: slipped through", method.name());
        };
        let IntegrationError::NotFinite { t, dof, quantity } = error else {
            panic!("{error}");
        };
        assert!((1.0..1.02).contains(&t), "{t}");
        assert_eq!((dof, quantity), (1, StateQuantity::Acceleration));
    }
}

/// A mass of 1 kg drawn along through a damper by a plate that moves at 1 m/s after a moment.
struct Towed {
    damping: f64,
}

/// Speed of the plate beside the mass, length of the step, change of the speed of the mass.
#[derive(Default)]
struct Towing {
    slip: f64,
    h: f64,
    change: f64,
}

impl SecondOrderSystem for Towed {
    type Record = Towing;
    fn new_record(&self) -> Towing {
        Towing::default()
    }
    fn dofs(&self) -> usize {
        1
    }
    /// Supplied by the plate, and lost.
    fn quadratures(&self) -> usize {
        2
    }
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64], record: &mut Towing) {
        let plate = if at.t > 0.05 { 1.0 } else { 0.0 };
        record.slip = plate - at.v[0];
        a[0] = self.damping * record.slip;
        rates.copy_from_slice(&[a[0] * plate, a[0] * record.slip]);
    }
    fn can_solve(&self) -> bool {
        true
    }
    fn solve(&self, weights: Weights, record: &mut Towing, x: &mut [f64]) -> bool {
        x[0] /= 1.0 + weights.damping * self.damping;
        (record.h, record.change) = (weights.damping, x[0]);
        true
    }
    fn add_solved(&self, record: &Towing, quadratures: &mut [f64]) {
        let Towing { slip, h, change } = *record;
        // The damper slackens by c Δv, and the slip by half of Δv; all that happens is after the plate has set out.
        quadratures[0] -= h * self.damping * change;
        quadratures[1] -= h * self.damping * change * (slip + 0.5 * (slip - change));
    }
}

/// Ten times as stiff as the step resolves, a damper takes as much as it gives: half of what the plate does.
#[test]
fn what_a_solution_adds_to_forces_is_booked() {
    let mut towed = Towed { damping: 100.0 };
    let mut state = State::new(0.0, vec![0.0], vec![0.0]);
    let method = Method::ImplicitDamping { step: 0.1 };
    let mut stepper = method.start(&mut towed, &mut state).expect("starts");
    for _ in 0..30 {
        stepper.advance(&mut towed, &mut state).expect("goes on");
    }
    let [supplied, lost] = [state.quadratures[0], state.quadratures[1]];
    let close = |found: f64, wanted: f64| (found - wanted).abs() < 1e-12;
    assert!(close(state.v[0], 1.0), "{}", state.v[0]);
    assert!(close(supplied, 1.0), "{supplied}");
    assert!(close(lost, 0.5), "{lost}");
}
