//! A plucked span of every chain model: what friction and damping in its joints take from a swing, and the ledger of each cycle.
#![allow(clippy::print_stdout, reason = "measured losses are worth a look")]

use crate::pieces::{alone, assembled, body, laid, linear, links, smooth};

use std::f64::consts::{PI, TAU};

use chaindrive_contact::dissipation::Exact;
use chaindrive_contact::friction::SpringSlider;
use chaindrive_contact::{Dissipation, Friction, Law};
use chaindrive_geometry::{ArcSpline, Point, Segment, Vector};
use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State};
use chaindrive_mechanics::{
    Articulation, Assembled, ChainModel, Clearance, End, Ends, Energy, Flow, Guide, GuideSupport,
    Harmonic, Joint, Motion, Observation, Place, RigidLinks, RollerModel, Surface, Touches,
};

/// A chain of a marine engine, 56B: pitch \[m\], mass of a link \[kg\], radius of a roller \[m\].
const PITCH: f64 = 0.0889;
const MASS: f64 = 3.0;
const ROLLER: f64 = 0.025;
/// Radius of the pin \[m\], μ, and μ r \[m\].
const RADIUS: f64 = 0.012;
const FRICTION: f64 = 0.1;
const LEVER: f64 = FRICTION * RADIUS;
/// Pull \[N\].
const TENSION: f64 = 20e3;
/// Stiffness of links that give, of pins in bushes and of rails \[N/m\].
const STIFFNESS: f64 = 1e10;
/// Loss of a span, in μ r a cycle.
const LOSS: f64 = 4.5;

/// A span whose first and last roller are pulled apart by a constant force, each between two smooth rails: pins at the ends that
/// do not rub, in every chain model.
#[derive(Clone, Debug)]
struct Span {
    model: ChainModel,
    links: usize,
    /// Greatest displacement across at the start \[m\].
    amplitude: f64,
    articulation: Option<Articulation>,
    /// Drag across the links \[N s/m²\].
    drag: f64,
}

fn surface(dissipation: Dissipation, friction: Friction) -> Surface {
    let law = Law {
        dissipation,
        ..linear(STIFFNESS)
    };
    Surface {
        friction,
        ..smooth(law)
    }
}

/// Rigid links of the chain.
fn rigid(joint: Joint) -> ChainModel {
    let body = body(MASS, MASS * PITCH * PITCH / 10.0);
    ChainModel::Rigid(RigidLinks {
        inner: body,
        outer: body,
        outer_first: false,
        joint,
        rollers: RollerModel::Bush,
    })
}

/// Pins in bushes that are wider by `play`, a share of their radius. Without loss in impacts, pins that slide would chatter.
fn clearance(play: f64, friction: Friction) -> Joint {
    let lossy = Dissipation::Exact(Exact { restitution: 0.5 });
    Joint::Clearance(Clearance {
        pin_radius: RADIUS,
        bore_radius: (1.0 + play) * RADIUS,
        surface: surface(lossy, friction),
    })
}

impl Span {
    fn has_clearance(&self) -> bool {
        matches!(&self.model, ChainModel::Rigid(links) if links.joint != Joint::Ideal)
    }

    /// Angle by which the links in the middle turn against each other when the span is farthest out \[rad\].
    fn swing(&self) -> f64 {
        let n = self.links as f64;
        2.0 * self.amplitude / PITCH * (1.0 - (PI / n).cos())
    }

    /// Friction that yields after a share of the swing.
    fn friction(&self, share: f64) -> Friction {
        let torsional = LEVER * TENSION / (share * self.swing());
        Friction::SpringSlider(SpringSlider {
            coefficient: FRICTION,
            stiffness: torsional / (RADIUS * RADIUS),
        })
    }

    /// Length of a link under tension \[m\].
    fn spacing(&self) -> f64 {
        if self.model == rigid(Joint::Ideal) {
            PITCH
        } else {
            PITCH + TENSION / STIFFNESS
        }
    }

    /// Pulled apart by its ends, each between two rails.
    fn assembled(&self) -> Assembled {
        let pulled = |force: f64| End::Pulled {
            force: Vector::new(force, 0.0),
        };
        let ends = Ends::Open([pulled(-TENSION), pulled(TENSION)]);
        self.held(ends, |place| rails(place.x).into())
    }

    fn held(&self, ends: Ends, around: impl Fn(&Point) -> Vec<Guide>) -> Assembled {
        let n = self.links;
        let mut positions = vec![Point::origin()];
        for i in 0..n {
            let rise = |i: usize| self.amplitude * (PI * i as f64 / n as f64).sin();
            let (from, to) = (positions[i], rise(i + 1));
            let along = (self.spacing().powi(2) - (to - from.y).powi(2)).sqrt();
            positions.push(Point::new(from.x + along, to));
        }
        let of = [PITCH, MASS, STIFFNESS];
        let mut chain = links(n, of, [2.0 * ROLLER, 0.08], ends, self.model.clone());
        for end in [0, n] {
            chain.masses[end] *= 0.5;
        }
        chain.articulation = self.articulation;
        chain.drag = self.drag;
        let guides: Vec<Guide> = [0, n].iter().flat_map(|&i| around(&positions[i])).collect();
        let still = vec![Vector::zeros(); n + 1];
        let mut parts = alone(vec![laid(chain, positions, still)]);
        parts.chains[0].guides = (0..guides.len()).collect();
        parts.guides = guides;
        assembled(parts)
    }

    /// Amplitude of the first mode \[m\], link for link: the middles of links stand between the rollers.
    fn first_mode(&self, assembled: &Assembled, q: &[f64]) -> f64 {
        let n = self.links as f64;
        let (stride, particles) = (
            assembled.system.dofs() / 2,
            self.model == ChainModel::Particles,
        );
        let middle = |i: usize| {
            if particles {
                0.5 * (q[stride + i] + q[stride + i + 1])
            } else {
                q[3 * i + 1]
            }
        };
        let sum: f64 = (0..self.links)
            .map(|i| middle(i) * (PI * (i as f64 + 0.5) / n).sin())
            .sum();
        2.0 * sum / (n * (0.5 * PI / n).cos())
    }

    /// ω of the first mode of point masses \[rad/s\].
    fn omega(&self) -> f64 {
        let n = self.links as f64;
        2.0 * (TENSION / (PITCH * MASS)).sqrt() * (0.5 * PI / n).sin()
    }

    /// The start, and the end of every cycle. Damping of pins in bushes is stiff and taken implicitly.
    fn cycles(&self, cycles: usize, step: f64) -> Vec<Instant> {
        let mut assembled = self.assembled();
        let mut state = State::new(0.0, assembled.q.clone(), assembled.v.clone());
        let method = if self.has_clearance() {
            Method::ImplicitDamping { step }
        } else {
            Method::Verlet { step }
        };
        let mut stepper = method
            .start(&mut assembled.system, &mut state)
            .unwrap_or_else(|error| panic!("{error}"));
        let mut instants = vec![self.instant(&assembled, &state)];
        let (mut last, mut falling) = (instants[0], true);
        // Long enough for a span that swings slower than its first mode.
        while instants.len() <= cycles && state.t < 1.5 * cycles as f64 * TAU / self.omega() {
            stepper
                .advance(&mut assembled.system, &mut state)
                .expect("stays finite");
            let amplitude = self.first_mode(&assembled, &state.q);
            // A peak on the side where it began.
            if amplitude < last.amplitude && !falling && amplitude > 0.0 {
                let found = self.instant(&assembled, &state);
                let greatest = last.amplitude;
                instants.push(Instant {
                    amplitude: greatest,
                    ..found
                });
            }
            falling = amplitude < last.amplitude;
            last.amplitude = amplitude;
        }
        instants
    }

    /// Start and end of a run of Verlet's method with ends that are moved.
    fn shaken(&self, ends: Ends, until: f64, step: f64) -> [Instant; 2] {
        let mut assembled = self.held(ends, |_| Vec::new());
        let mut state = State::new(0.0, assembled.q.clone(), assembled.v.clone());
        let mut stepper = Method::Verlet { step }
            .start(&mut assembled.system, &mut state)
            .unwrap_or_else(|error| panic!("{error}"));
        let start = self.instant(&assembled, &state);
        while state.t < until {
            stepper
                .advance(&mut assembled.system, &mut state)
                .expect("stays finite");
        }
        [start, self.instant(&assembled, &state)]
    }

    fn instant(&self, assembled: &Assembled, state: &State) -> Instant {
        let system = &assembled.system;
        let at = Moment {
            t: state.t,
            q: &state.q,
            v: &state.v,
            z: &[],
        };
        let flows = if state.quadratures.is_empty() {
            vec![0.0; system.quadratures()]
        } else {
            state.quadratures.to_vec()
        };
        let mut out = Observation::default();
        system.observe(at, &flows, &mut system.new_record(), &mut out);
        Instant {
            amplitude: self.first_mode(assembled, &state.q),
            energy: out.energy,
        }
    }
}

/// A span that is farthest out.
#[derive(Clone, Copy, Debug)]
struct Instant {
    amplitude: f64,
    energy: Energy,
}

impl Instant {
    /// Energy lost since an earlier one \[J\].
    fn lost(&self, since: &Self) -> f64 {
        self.energy.dissipated() - since.energy.dissipated()
    }

    /// Share of what a cycle loses that is not accounted for.
    fn open([from, to]: &[Self; 2]) -> f64 {
        to.energy.residual(&from.energy).abs() / to.lost(from)
    }
}

/// Two smooth rails with a roller between them.
fn rails(x: f64) -> [Guide; 2] {
    [1.0, -1.0].map(|side| {
        let [from, to] = [-1.0, 1.0].map(|end| Point::new(x + 0.02 * end * side, side * ROLLER));
        let face = ArcSpline::open(&[Segment::new(from, to).into()]).expect("a line");
        Guide {
            name: format!("rail at {x} on {side}"),
            face,
            support: GuideSupport::Fixed,
            touches: Touches::Rollers,
            surface: surface(Dissipation::None, Friction::None),
        }
    })
}

/// Particles whose joints turn freely, so many links.
fn particles(links: usize) -> Span {
    Span {
        model: ChainModel::Particles,
        links,
        amplitude: 25.0 * LEVER,
        articulation: None,
        drag: 0.0,
    }
}

/// Joints that hold their friction themselves.
fn rubbing(model: ChainModel, links: usize) -> Span {
    let span = particles(links);
    let articulation = Some(Articulation {
        friction: span.friction(0.005),
        radius: RADIUS,
        damping: 0.0,
        seal: 0.0,
        lateral: None,
    });
    Span {
        model,
        articulation,
        ..span
    }
}

/// Pins that rub in their bushes.
fn pins(links: usize, play: f64) -> Span {
    let span = particles(links);
    let model = rigid(clearance(play, span.friction(0.002)));
    Span { model, ..span }
}

/// Angle by which a pin turns before it slides, as a share of the swing: it rolls in its bush until it has climbed to the angle
/// of friction.
///
/// ```text
/// θ_y = μ (c + δ(T))/r
/// ```
fn rolling(span: &Span, play: f64) -> f64 {
    FRICTION * (play + TENSION / STIFFNESS / RADIUS) / span.swing()
}

/// Friction takes a fixed amount from every swing, whatever the strand and whatever it is made of.
///
/// ```text
/// ΔA = 4.5 μ r a cycle
/// ```
///
/// The first mode alone would lose 16 μ r/π = 5.1 μ r; a strand cannot keep its sine, since friction acts like ends that
/// jump by ± μ r. An independent particle program found 4.5 ± 0.1 for 15 to 60 links. The farther a span swings, the more of its
/// sine it keeps: it loses 4.4 μ r a cycle from 15 μ r, 4.7 from 25, 4.8 from 45, and 4.9 from 100.
#[test]
fn friction_takes_the_same_from_every_swing() {
    let ideal = || rigid(Joint::Ideal);
    for (name, span, step) in [
        ("particles", rubbing(ChainModel::Particles, 15), 5e-6),
        ("particles", rubbing(ChainModel::Particles, 60), 5e-6),
        ("ideal", rubbing(ideal(), 15), 1e-5),
        ("ideal", rubbing(ideal(), 30), 1e-5),
        ("ideal", rubbing(ideal(), 60), 1e-5),
        ("clearance", pins(15, 1e-4), 2e-6),
        ("clearance", pins(30, 1e-4), 2e-6),
    ] {
        assert!(rolling(&span, 1e-4) < 0.01 || !span.has_clearance());
        let instants = span.cycles(3, step);
        let fell = (instants[0].amplitude - instants[3].amplitude) / 3.0 / LEVER;
        let open = instants.array_windows().map(Instant::open);
        let open = open.fold(0.0, f64::max);
        let links = span.links;
        println!("{name}, {links} links: {fell:.2} μ r a cycle, {open:.1e} of the loss open");
        assert!(
            (fell - LOSS).abs() < 0.2,
            "{name}, {links}: {fell} μ r a cycle"
        );
        assert!(open < 0.01, "{name}, {links}: {open}");
    }
}

/// Pins with play roll in their bushes before they slide, and lose nothing while they roll: a span whose joints turn by less than
/// θ_y swings on, one that swings farther loses the rest.
///
/// ```text
/// E = Σ 4 μ r T (θ_i − θ_y)  a cycle, over all joints with θ_i > θ_y
/// ```
#[test]
fn pins_that_roll_lose_nothing() {
    for (share, tolerance) in [(0.1, 0.05), (0.2, 0.05), (1.1, 0.0)] {
        let play = share / rolling(&pins(15, 1.0), 1.0) - TENSION / STIFFNESS / RADIUS;
        let span = pins(15, play);
        let yields = rolling(&span, play) * span.swing();
        let instants = span.cycles(3, 2e-6);
        // The first cycle begins from pins that have not rolled yet.
        for [from, to] in instants[1..].array_windows() {
            let mean = 0.5 * (from.amplitude + to.amplitude) / span.amplitude * span.swing();
            let slides = (1..span.links).map(|i| {
                let turn = mean * (PI * i as f64 / span.links as f64).sin();
                4.0 * LEVER * TENSION * (turn - yields).max(0.0)
            });
            let (slides, lost) = (slides.sum::<f64>(), to.lost(from));
            let fell = (from.amplitude - to.amplitude) / LEVER;
            println!("θ_y {share} of the swing: {lost:.3} J, not {slides:.3} J; {fell:.2} μ r");
            if share < 1.0 {
                assert!(
                    (lost / slides - 1.0).abs() < tolerance,
                    "{lost}, not {slides} J"
                );
            } else {
                // A fiftieth of what sliding pins lose in a cycle, 11 J.
                assert!(
                    slides == 0.0 && lost < 0.22 && fell.abs() < 0.1,
                    "{lost} J, {fell}"
                );
            }
        }
    }
}

/// Viscous damping of the joints damps a strand like a bending dashpot.
///
/// ```text
/// m ÿ_i = (T/ℓ) δ² y − (c/ℓ²) δ⁴ ẏ,   λ = 2 − 2 cos(π/n):   ω² = T λ/(ℓ m*),   ζ = c λ²/(2 ℓ² m* ω)
/// m* = m for particles,   m (1 − λ/4) + I λ/ℓ² for links
/// ```
#[test]
fn viscous_joints_damp_a_strand_as_their_closed_form_says() {
    let damping = 20.0;
    for (name, model, step) in [
        ("particles", ChainModel::Particles, 5e-6),
        ("ideal", rigid(Joint::Ideal), 1e-5),
        ("clearance", rigid(clearance(1e-4, Friction::None)), 2e-6),
    ] {
        let span = Span {
            model,
            amplitude: 1e-4,
            articulation: Some(Articulation {
                friction: Friction::None,
                radius: RADIUS,
                damping,
                seal: 0.0,
                lateral: None,
            }),
            ..particles(16)
        };
        let eigen = 2.0 - 2.0 * (PI / span.links as f64).cos();
        let mass = if name == "particles" {
            MASS
        } else {
            MASS * (1.0 - 0.25 * eigen + eigen / 10.0)
        };
        let omega = (TENSION * eigen / (PITCH * mass)).sqrt();
        let zeta = damping * eigen * eigen / (2.0 * PITCH * PITCH * mass * omega);
        let instants = span.cycles(6, step);
        let decrement = (instants[0].amplitude / instants[6].amplitude).ln() / 6.0;
        let found = decrement / (TAU * TAU + decrement * decrement).sqrt();
        println!("{name}: ζ = {found:.6}, {zeta:.6}");
        assert!(
            (found / zeta - 1.0).abs() < 2e-3,
            "{name}: {found}, not {zeta}"
        );
    }
}

/// Drag across a span damps its first mode, and takes what the ledger says.
///
/// ```text
/// ζ = b/(2 m′ ω),   m′ = m/p
/// ```
#[test]
fn drag_across_a_span_damps_it_as_its_closed_form_says() {
    for (name, model, step) in [
        ("particles", ChainModel::Particles, 1e-5),
        ("ideal", rigid(Joint::Ideal), 1e-5),
        ("clearance", rigid(clearance(1e-4, Friction::None)), 2e-6),
    ] {
        let span = Span {
            model,
            drag: 40.0,
            ..particles(30)
        };
        let zeta = span.drag * PITCH / (2.0 * MASS * span.omega());
        let instants = span.cycles(4, step);
        let decrement = (instants[0].amplitude / instants[4].amplitude).ln() / 4.0;
        let found = decrement / (TAU * TAU + decrement * decrement).sqrt();
        println!("{name}: ζ = {found:.6}, {zeta:.6}");
        assert!(
            (found / zeta - 1.0).abs() < 0.01,
            "{name}: {found}, not {zeta}"
        );
        for pair in instants.array_windows() {
            let [from, to] = pair.map(|it| it.energy);
            let drag = to.flow(Flow::DragLoss) - from.flow(Flow::DragLoss);
            let spans = to.losses()[Place::Spans as usize] - from.losses()[Place::Spans as usize];
            assert!(
                drag > 1.0 && (spans - drag).abs() < 1e-12 * drag,
                "{name}: {drag} J"
            );
            let open = Instant::open(pair);
            assert!(open < 1e-3, "{name}: {open}");
        }
    }
}

/// Supports that move the ends of a span feel what its joints and what drags do to its last links.
#[test]
fn driven_ends_pay_for_friction_and_drag() {
    for (drag, friction) in [(400.0, false), (0.0, true)] {
        let mut span = particles(6);
        span.drag = drag;
        span.amplitude = 0.0;
        if friction {
            span.articulation = Some(Articulation {
                friction: Friction::None,
                radius: RADIUS,
                damping: 300.0,
                seal: 0.0,
                lateral: None,
            });
        }
        let shake = |frequency: f64| End::Driven {
            x: Motion::Held,
            y: Motion::Harmonics {
                rate: 0.0,
                terms: vec![Harmonic {
                    amplitude: 0.005,
                    frequency,
                    // From rest.
                    phase: 0.5 * PI,
                }],
            },
        };
        let ends = Ends::Open([shake(40.0), shake(55.0)]);
        let instants = span.shaken(ends, 0.1, 2e-6);
        let lost = instants[1].lost(&instants[0]);
        let open = Instant::open(&instants);
        println!("{lost} J, {open:.1e} of it open");
        assert!(lost > 1.0 && open < 1e-3, "drag {drag}: {lost} J, {open}");
    }
}
