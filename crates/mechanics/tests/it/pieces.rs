//! Pieces that drives of these tests are put together from.

use chaindrive_contact::{Dissipation, Elastic, Friction, Law, elastic::Power};
use chaindrive_geometry::{Point, Seat, Side, Tip, ToothForm, ToothGap, Vector};
use chaindrive_integrate::{Moment, SecondOrderSystem, State};
use chaindrive_mechanics::{
    Adjust, Assembled, Chain, ChainModel, Drive, Ends, Fit, Forces, Layout, LinkBody, Observation,
    Parts, PlacedChain, PretensionAt, ShaftLoss, SpanStart, Sprocket, Stop, Strength, Support,
    Surface, System, Tighten, Tolerance,
};

/// A linear law without loss.
pub(crate) fn linear(stiffness: f64) -> Law {
    Law {
        elastic: Elastic::Power(Power::linear(stiffness)),
        series: None,
        dissipation: Dissipation::None,
        onset_floor: 0.01,
    }
}

/// A surface without friction and oil.
pub(crate) fn smooth(law: Law) -> Surface {
    Surface {
        law,
        friction: Friction::None,
        film: None,
    }
}

/// A link with its centre of mass in the middle.
pub(crate) fn body(mass: f64, inertia: f64) -> LinkBody {
    LinkBody {
        mass,
        inertia,
        centre: Vector::zeros(),
    }
}

/// Equal links of this pitch \[m\], mass \[kg\] and stiffness \[N/m\], on which nothing rubs or drags.
pub(crate) fn links(
    count: usize,
    [pitch, mass, stiffness]: [f64; 3],
    [roller_diameter, plate_height]: [f64; 2],
    ends: Ends,
    model: ChainModel,
) -> Chain {
    Chain {
        pitch,
        lengths: vec![pitch; count],
        stiffness: vec![stiffness; count],
        damping: vec![0.0; count],
        masses: vec![mass; count + usize::from(ends != Ends::Closed)],
        roller_diameter,
        roller_deviations: Vec::new(),
        plate_height,
        strength: Strength::default(),
        articulation: None,
        drag: 0.0,
        ends,
        model,
    }
}

/// A chain at these places, on its own.
pub(crate) fn laid(chain: Chain, positions: Vec<Point>, velocities: Vec<Vector>) -> PlacedChain {
    PlacedChain {
        name: None,
        chain,
        layout: Layout::Points {
            positions,
            velocities,
        },
        sprockets: Vec::new(),
        guides: Vec::new(),
    }
}

/// A chain around sprockets, under a tension as laid \[N\].
pub(crate) fn around(chain: Chain, stops: &[usize], pretension: f64) -> PlacedChain {
    PlacedChain {
        name: None,
        chain,
        layout: Layout::Route {
            stops: stops.iter().copied().map(Stop::Sprocket).collect(),
            phase: 0.5,
            start: SpanStart::Polygon,
            fit: Fit {
                growth: 0.0,
                sag: None,
                slack: None,
                adjust: Adjust::Nothing,
                pretension,
                tighten: Tighten::RestLength,
                at: PretensionAt::Phase,
            },
        },
        sprockets: stops.to_vec(),
        guides: Vec::new(),
    }
}

/// A wheel of the standard's form in the middle of its tolerances.
pub(crate) fn sprocket(
    name: &str,
    teeth: u32,
    [pitch, roller]: [f64; 2],
    centre: [f64; 2],
    surface: Surface,
) -> Sprocket {
    let form = ToothForm::Iso606 {
        gap: 0.5,
        tip: Tip::Mid,
        seat: Seat::Bottom,
    };
    Sprocket {
        name: name.into(),
        gap: ToothGap::new(teeth, pitch, roller, &form).expect("the form fits the chain"),
        side: Side::Left,
        centre: Point::from(centre),
        shaft: 0,
        support: Support::Fixed,
        forces: Forces::default(),
        inertia: 0.0,
        mass: 1.0,
        surface,
        stack: None,
        flank: None,
        gap_angle: 0.0,
        tolerance: Tolerance::default(),
        lateral: 0.0,
        loss: ShaftLoss::default(),
    }
}

/// Chains by themselves: nothing pulls at them, and they begin where they are laid.
pub(crate) fn alone(chains: Vec<PlacedChain>) -> Parts {
    Parts {
        chains,
        sprockets: Vec::new(),
        guides: Vec::new(),
        tensioners: Vec::new(),
        shafts: Vec::new(),
        couplings: Vec::new(),
        gears: Vec::new(),
        settle: false,
        gravity: Vector::zeros(),
        oil: None,
        tunable: Vec::new(),
    }
}

pub(crate) fn assembled(parts: Parts) -> Assembled {
    Drive::new(parts)
        .unwrap_or_else(|problems| panic!("{problems:?}"))
        .assemble()
        .unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn observed(system: &System, state: &State, flows: &[f64]) -> Observation {
    let mut out = Observation::default();
    let at = Moment {
        t: state.t,
        q: &state.q,
        v: &state.v,
        z: &state.z,
    };
    system.observe(at, flows, &mut system.new_record(), &mut out);
    out
}

/// What is seen at the start.
pub(crate) fn seen(assembled: &Assembled) -> Observation {
    let system = &assembled.system;
    observed(system, &assembled.state(), &vec![0.0; system.quadratures()])
}
