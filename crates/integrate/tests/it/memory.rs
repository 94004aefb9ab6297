//! A stepper that remembers what another one did goes on as that one would, to the last bit.

use crate::problems::{Driven, Kepler, Smooth, all_methods};

use chaindrive_integrate::{IntegrationError, Method, SecondOrderSystem, State, Stepper};

fn started<P: Smooth>(problem: &P, method: Method) -> (P, State, Stepper<P>) {
    let (mut system, mut state) = (problem.clone(), problem.start());
    let stepper = method.start(&mut system, &mut state).expect("starts");
    (system, state, stepper)
}

fn goes_on<P: Smooth<Record: Clone>>(problem: &P) {
    for method in all_methods(0.01) {
        let (mut system, mut state, mut stepper) = started(problem, method);
        let mut advance = |stepper: &mut Stepper<P>, state: &mut State| {
            for _ in 0..100 {
                stepper.advance(&mut system, state).expect("advances");
            }
        };
        advance(&mut stepper, &mut state);
        let (then, memory) = (state.clone(), stepper.memory());
        advance(&mut stepper, &mut state);

        let (fresh, _, mut other) = started(problem, method);
        let mut again = then;
        other.remember(&fresh, &again, memory).expect("fits");
        advance(&mut other, &mut again);
        assert_eq!(again, state, "{}", method.name());
        assert_eq!(other.statistics(), stepper.statistics());
        assert_eq!(other.next_step().to_bits(), stepper.next_step().to_bits());
    }
}

#[test]
fn a_driven_pendulum_goes_on() {
    goes_on(&Driven);
}

#[test]
fn a_planet_goes_on() {
    goes_on(&Kepler);
}

#[test]
fn what_is_of_another_method_or_size_is_refused() {
    let step = 0.01;
    let (system, state, mut stepper) = started(&Driven, Method::Verlet { step });
    for other in [Method::Rk4 { step }, Method::Verlet { step: 0.02 }] {
        let memory = started(&Driven, other).2.memory();
        let refused = stepper.remember(&system, &state, memory);
        assert!(matches!(refused, Err(IntegrationError::OtherMethod { .. })));
    }
    let memory = stepper.memory();
    let larger = State::new(0.0, vec![0.0; 2], vec![0.0; system.dofs()]);
    let refused = stepper.remember(&system, &larger, memory);
    assert!(matches!(refused, Err(IntegrationError::Shape { .. })));
}
