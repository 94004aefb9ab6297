//! First-order states beside the motion: order, error control, stiffness, reading between steps.

use crate::problems::leaking::Leaking;
use crate::problems::{Smooth, all_methods, fixed, run};

use chaindrive_integrate::{IntegrationError, Method, State};

const SLOW: Leaking = Leaking { settling: 2.0 };

fn coarsest(method: Method) -> u32 {
    match method {
        Method::ImplicitDamping { .. } => 6400,
        Method::Verlet { .. } | Method::GeneralizedAlpha { .. } => 800,
        _ => 160,
    }
}

/// The state and the ledger over it converge with the order of the method, and so does the motion.
#[test]
fn every_method_keeps_its_order() {
    let precise = run(&SLOW, Method::specimens(1.0)[2], 6400);
    for method in all_methods(1.0) {
        let errors = |n| {
            let states = run(&SLOW, method, n);
            let pairs = states.iter().zip(&precise);
            pairs.fold([0.0_f64; 3], |worst, (found, exact)| {
                [
                    worst[0].max((found.z[0] - exact.z[0]).abs()),
                    worst[1].max((found.q[0] - exact.q[0]).abs()),
                    worst[2].max((Leaking::ledger(found) - Leaking::ledger(&SLOW.start())).abs()),
                ]
            })
        };
        let n = coarsest(method);
        let (coarse, fine) = (errors(n), errors(2 * n));
        for (what, (coarse, fine)) in ["state", "motion", "ledger"]
            .into_iter()
            .zip(coarse.into_iter().zip(fine))
        {
            let order = (coarse / fine).log2();
            let expected = f64::from(method.order());
            assert!(
                order > expected - 0.2 && fine < 1e-2,
                "{what}, {}: order {order}, error {fine:.1e}",
                method.name()
            );
        }
    }
}

/// A foot that settles in a hundredth of the step: the implicit methods follow it, and an explicit one must refuse.
#[test]
fn what_settles_within_a_step_is_implicit() {
    let stiff = Leaking { settling: 1e-4 };
    let precise = run(&stiff, Method::specimens(1.0)[2], 400_000);
    for (method, bound) in Method::implicit_specimens(1.0)
        .into_iter()
        .zip([3e-2, 2e-3])
    {
        let states = run(&stiff, method, 800);
        for (found, exact) in states.iter().zip(&precise) {
            let error = (found.q[0] - exact.q[0]).abs();
            assert!(error < bound, "{}: {error:.1e}", method.name());
        }
    }
    let mut state = stiff.start();
    let mut stepper = fixed(Method::Rk4 { step: 0.01 }, 0.01)
        .start(&mut stiff.clone(), &mut state)
        .expect("the problem states no time scale");
    let failure = (0..800).find_map(|_| stepper.advance(&mut stiff.clone(), &mut state).err());
    assert!(matches!(failure, Some(IntegrationError::NotFinite { .. })));
}

/// The error control sees states: a looser tolerance takes longer steps, and errs in proportion.
#[test]
fn error_control_holds_the_state() {
    let precise = run(&SLOW, Method::specimens(1.0)[2], 6400);
    let end = precise.last().expect("eight states");
    let error = |tolerance: f64| {
        let method = Method::DormandPrince {
            relative: tolerance,
            // The motion is let free: the state alone decides.
            absolute: tolerance,
            absolute_rate: 1e3,
            max_step: 1.0,
        };
        let mut state = SLOW.start();
        let mut system = SLOW.clone();
        let mut stepper = method.start(&mut system, &mut state).expect("starts");
        while state.t < SLOW.duration() {
            stepper.advance(&mut system, &mut state).expect("advances");
        }
        let mut z = [0.0];
        state.states_at(SLOW.duration(), &mut z);
        ((z[0] - end.z[0]).abs(), stepper.statistics().steps)
    };
    let [loose, tight] = [1e-4, 1e-8].map(error);
    assert!(loose.0 < 1e-2 && tight.0 < 1e-6, "{loose:?} {tight:?}");
    assert!(tight.1 > 2 * loose.1, "{loose:?} {tight:?}");
}

#[test]
fn a_state_is_missed_and_named() {
    let mut bare = State::new(0.0, vec![1.0], vec![0.0]);
    let refused = Method::Rk4 { step: 0.1 }.start(&mut SLOW.clone(), &mut bare);
    assert_eq!(
        refused.err().map(|error| error.to_string()).as_deref(),
        Some("the state has 0 first-order states, the system 1")
    );
    let mut broken = SLOW.start().with_states(vec![f64::NAN]);
    let refused = Method::Rk4 { step: 0.1 }.start(&mut SLOW.clone(), &mut broken);
    assert!(matches!(
        refused.err(),
        Some(IntegrationError::NotFinite { .. })
    ));
}

/// A clone of state and stepper goes on to the same bits.
#[test]
fn a_snapshot_is_a_clone() {
    for method in all_methods(0.01) {
        let mut system = SLOW.clone();
        let mut state = SLOW.start();
        let mut stepper = fixed(method, 0.01)
            .start(&mut system, &mut state)
            .expect("starts");
        for _ in 0..20 {
            stepper.advance(&mut system, &mut state).expect("advances");
        }
        let (mut again, mut twin) = (stepper.clone(), state.clone());
        for _ in 0..20 {
            stepper.advance(&mut system, &mut state).expect("advances");
            again.advance(&mut system, &mut twin).expect("advances");
        }
        assert_eq!(state, twin, "{}", method.name());
    }
}
