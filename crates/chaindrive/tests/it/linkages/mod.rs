//! Strands and rings of rigid links built by hand, and a bench that steps them with the state in view.
#![allow(dead_code, reason = "every test uses its part")]

use chaindrive::{Assembled, Drive, Observation};
use chaindrive_contact::elastic::Power;
use chaindrive_contact::{Dissipation, Elastic, Friction, Law};
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State, Stepper};
use chaindrive_mechanics::{
    Chain, ChainModel, Clearance, End, Ends, Guide, Joint, Layout, LinkBody, Motion, Parts,
    PlacedChain, Record, RigidLinks, RollerModel, Strength, Surface, System,
};

/// A chain of rigid links laid by points. Its fields are open: a case sets what it is about.
pub(crate) struct Strand {
    pub(crate) lengths: Vec<f64>,
    pub(crate) links: RigidLinks,
    pub(crate) ends: Ends,
    pub(crate) places: Vec<[f64; 2]>,
    pub(crate) velocities: Vec<[f64; 2]>,
    pub(crate) gravity: [f64; 2],
    pub(crate) guides: Vec<Guide>,
    pub(crate) roller_diameter: f64,
    pub(crate) settle: bool,
}

impl Strand {
    /// A strand of bars of equal length along +x, the first joint at the origin, at rest.
    pub(crate) fn straight(links: usize, length: f64, bar: LinkBody, ends: [End; 2]) -> Self {
        let places: Vec<[f64; 2]> = (0..=links).map(|i| [i as f64 * length, 0.0]).collect();
        Self {
            lengths: vec![length; links],
            links: bars(bar),
            ends: Ends::Open(ends),
            velocities: vec![[0.0; 2]; places.len()],
            places,
            gravity: [0.0; 2],
            guides: Vec::new(),
            roller_diameter: 0.5 * length,
            settle: false,
        }
    }

    /// A closed chain through the given places.
    pub(crate) fn ring(length: f64, bar: LinkBody, places: Vec<[f64; 2]>) -> Self {
        Self {
            lengths: vec![length; places.len()],
            ends: Ends::Closed,
            velocities: vec![[0.0; 2]; places.len()],
            places,
            ..Self::straight(1, length, bar, [End::Free, End::Free])
        }
    }

    pub(crate) fn drive(&self) -> Drive {
        let rollers = self.places.len();
        let links = self.lengths.len();
        let chain = Chain {
            pitch: self.lengths[0],
            lengths: self.lengths.clone(),
            // The particles only lay the links.
            stiffness: vec![1e8; links],
            damping: vec![0.0; links],
            masses: vec![0.01; rollers],
            roller_diameter: self.roller_diameter,
            roller_deviations: Vec::new(),
            plate_height: self.roller_diameter,
            strength: Strength::default(),
            articulation: None,
            drag: 0.0,
            ends: self.ends.clone(),
            model: ChainModel::Rigid(self.links.clone()),
        };
        let parts = Parts {
            chains: vec![PlacedChain {
                name: None,
                chain,
                layout: Layout::Points {
                    positions: self.places.iter().map(|p| Point::new(p[0], p[1])).collect(),
                    velocities: self.velocities.iter().map(|&v| v.into()).collect(),
                },
                sprockets: Vec::new(),
                guides: (0..self.guides.len()).collect(),
            }],
            sprockets: Vec::new(),
            guides: self.guides.clone(),
            tensioners: Vec::new(),
            shafts: Vec::new(),
            couplings: Vec::new(),
            gears: Vec::new(),
            settle: self.settle,
            gravity: self.gravity.into(),
            oil: None,
            tunable: Vec::new(),
        };
        Drive::new(parts).unwrap_or_else(|problems| panic!("{problems:?}"))
    }

    pub(crate) fn assemble(&self) -> Assembled {
        self.drive().assemble().unwrap_or_else(|e| panic!("{e}"))
    }
}

/// Equal links with ideal joints and no rollers.
pub(crate) fn bars(bar: LinkBody) -> RigidLinks {
    RigidLinks {
        inner: bar,
        outer: bar,
        outer_first: false,
        joint: Joint::Ideal,
        rollers: RollerModel::Lumped { mass: 0.0 },
    }
}

/// A link of given mass and inertia, its centre of mass in the middle.
pub(crate) fn body(mass: f64, inertia: f64) -> LinkBody {
    LinkBody {
        mass,
        inertia,
        centre: Vector::zeros(),
    }
}

/// A frictionless surface of F = K δⁿ.
pub(crate) fn surface(stiffness: f64, exponent: f64) -> Surface {
    Surface {
        law: Law {
            series: None,
            elastic: Elastic::Power(Power {
                stiffness,
                exponent,
            }),
            dissipation: Dissipation::None,
            onset_floor: 1e-9,
        },
        friction: Friction::None,
        film: None,
    }
}

/// A pin of radius `pin` \[m\] in a bush with the radial clearance `gap` \[m\].
pub(crate) fn clearance(pin: f64, gap: f64, surface: Surface) -> Joint {
    Joint::Clearance(Clearance {
        pin_radius: pin,
        bore_radius: pin + gap,
        surface,
    })
}

/// x = A sin(2π f t + φ) counted from its value at t = 0, as an end moves.
pub(crate) fn harmonic(amplitude: f64, frequency: f64, phase: f64) -> Motion {
    Motion::Harmonics {
        rate: 0.0,
        terms: vec![chaindrive_mechanics::Harmonic {
            amplitude,
            frequency,
            phase,
        }],
    }
}

/// A system in motion, with everything in view between steps.
pub(crate) struct Bench {
    pub(crate) system: System,
    pub(crate) state: State,
    stepper: Stepper<System>,
    record: Record,
    seen: Observation,
}

impl Bench {
    pub(crate) fn start(assembled: Assembled, method: Method) -> Self {
        let mut state = assembled.state();
        let mut system = assembled.system;
        let stepper = method
            .start(&mut system, &mut state)
            .unwrap_or_else(|error| panic!("{error}"));
        let record = system.new_record();
        Self {
            system,
            state,
            stepper,
            record,
            seen: Observation::default(),
        }
    }

    pub(crate) fn advance(&mut self) {
        self.stepper
            .advance(&mut self.system, &mut self.state)
            .unwrap_or_else(|error| panic!("{error}"));
    }

    pub(crate) fn until(&mut self, t: f64) {
        // Half a step of rounding is nothing a fixed step would notice.
        while self.state.t < t * (1.0 - 1e-12) {
            self.advance();
        }
    }

    /// Readings of the accepted state.
    pub(crate) fn look(&mut self) -> &Observation {
        let at = Moment {
            t: self.state.t,
            q: &self.state.q,
            v: &self.state.v,
            z: &[],
        };
        let flows = &self.state.quadratures;
        self.system
            .observe(at, flows, &mut self.record, &mut self.seen);
        &self.seen
    }

    /// Place and velocity of a body: x, y and angle. Free rollers stand after the links.
    pub(crate) fn body(&self, index: usize) -> [[f64; 3]; 2] {
        [&self.state.q, &self.state.v].map(|z| [0, 1, 2].map(|k| z[3 * index + k]))
    }
}

/// Places on a circle about the origin, `count` of them, the distance of neighbours `length`.
pub(crate) fn circle(count: usize, length: f64) -> Vec<[f64; 2]> {
    let step = std::f64::consts::TAU / count as f64;
    let radius = 0.5 * length / (0.5 * step).sin();
    (0..count)
        .map(|i| (step * i as f64).sin_cos())
        .map(|(s, c)| [radius * c, radius * s])
        .collect()
}
