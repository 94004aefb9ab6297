//! Time stepping of q̈ = a(t, q, q̇) with memory.
//!
//! A [`SecondOrderSystem`] says how it accelerates, judges candidate steps and takes accepted ones; a
//! [`Method`] says how to step; a [`Stepper`] carries a [`State`] forward, one accepted step at a time:
//!
//! ```text
//! try ─► inspect ─► accept ─► commit ─► (evaluate afresh if the commit was a jump)
//!  ▲        │
//!  └─ retry with a smaller step
//! ```
//!
//! | [`Method`] | order | evaluations per step | stable up to | when to choose |
//! |---|---|---|---|---|
//! | `Verlet` | 2 | 1 | h = 2 τ | the default for chains: cheapest at a per cent, energy stays bounded |
//! | `Rk4` | 4 | 4 | h = 2.78 τ | fixed steps at a per mille and below |
//! | `DormandPrince` | 5 | 6 | by error control | references, and motions with quiet stretches |
//! | `ImplicitDamping` | 1 | 1, and 1 solution | h = 2/ω | damping far stiffer than the springs |
//! | `GeneralizedAlpha` | 2 | 2 or more, each with a solution | every h | stiff modes that need not be resolved |
//!
//! τ is the [`time_scale`](SecondOrderSystem::time_scale) of the system, 1/ω its
//! [`undamped_time_scale`](SecondOrderSystem::undamped_time_scale). The implicit methods need a system that can
//! [`solve`](SecondOrderSystem::solve). Fixed steps keep a tenth in
//! reserve: a step above 0.9 of the limit is refused at the start and shortened during a run.
//!
//! Forces are evaluated with `&self` and memory advances with `&mut self` in
//! [`commit`](SecondOrderSystem::commit) only, so a rejected step leaves no trace. Nothing is allocated
//! in a step. This crate knows positions and velocities, and no bodies.
//!
//! # Example
//!
//! ```
//! use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State};
//!
//! struct Pendulum;
//!
//! impl SecondOrderSystem for Pendulum {
//!     type Record = ();
//!     fn new_record(&self) {}
//!     fn dofs(&self) -> usize {
//!         1
//!     }
//!     fn evaluate(&self, at: Moment<'_>, a: &mut [f64], _: &mut [f64], (): &mut ()) {
//!         a[0] = -at.q[0].sin();
//!     }
//! }
//!
//! let mut state = State::new(0.0, vec![0.1], vec![0.0]);
//! let mut stepper = Method::Rk4 { step: 0.05 }.start(&mut Pendulum, &mut state)?;
//! while state.t < 10.0 {
//!     stepper.advance(&mut Pendulum, &mut state)?;
//! }
//! let (mut q, mut v) = ([0.0], [0.0]);
//! state.at(10.0, &mut q, &mut v);
//! let energy = 0.5 * v[0] * v[0] + 1.0 - q[0].cos();
//! assert!((energy - (1.0 - 0.1_f64.cos())).abs() < 1e-8);
//! # Ok::<(), chaindrive_integrate::IntegrationError>(())
//! ```

mod array;
mod dense;
mod error;
mod finite;
mod generalized_alpha;
mod implicit_damping;
mod memory;
mod method;
mod outcome;
mod registers;
mod runge_kutta;
mod state;
mod statistics;
mod step_size;
mod stepper;
mod system;
mod tableau;
mod tolerance;
mod verlet;

pub use array::Array;
pub use error::{IntegrationError, StateQuantity};
pub use memory::StepperMemory;
pub use method::Method;
pub use registers::{InstructionSet, InstructionSetError, Registers};
pub use state::State;
pub use statistics::Statistics;
pub use stepper::{Step, Stepper, slack};
pub use system::{Continuity, Moment, Prediction, SecondOrderSystem, Verdict, Weights};

/// Hash of the sources of this crate, a part of the identity of a build.
#[doc(hidden)]
pub const SOURCES: &str = env!("CHAINDRIVE_SOURCES");
