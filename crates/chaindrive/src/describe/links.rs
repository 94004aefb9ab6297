//! Links, joints and rollers of the chain, and the laws of their contacts.

use chaindrive_contact::Friction;
use chaindrive_mechanics::{Chain, Clearance, Drive, FreeRoller, Surface};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

/// Links, joints and rollers of a chain.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LinkFacts {
    /// Model, as scenes name it.
    pub model: &'static str,
    /// Rollers, where they are told apart: lumped, free or none.
    pub rollers: Option<&'static str>,
    /// Strands that share the tension of the links; 0 where the model does not tell them apart.
    pub strands: usize,
    /// Joints between links, and between links and supports.
    pub joints: usize,
    /// Radial clearance of the pins \[m\].
    pub joint_clearance: Option<f64>,
    /// Radial clearance of free rollers \[m\].
    pub roller_clearance: Option<f64>,
    /// Kind of the friction of pins in their bushes, where there is any.
    pub joint_friction: Option<String>,
    /// Diameter of the pins on which it acts \[m\].
    pub pin_diameter: Option<f64>,
    /// Viscous damping of the joints \[N m s/rad\].
    pub joint_damping: f64,
    /// Torque of their seals \[N m\].
    pub seal_torque: f64,
}

impl LinkFacts {
    pub(super) fn of(chain: &Chain) -> Self {
        let resisting = chain.articulation.as_ref();
        let mut rubbing = resisting
            .filter(|it| it.rubs())
            .map(|it| (it.friction, it.radius));
        if let (true, Some(joint)) = (chain.model.rubs_in_bushes(), chain.model.clearance()) {
            rubbing = Some((joint.surface.friction, joint.pin_radius));
        }
        let rubbing = rubbing.filter(|(friction, _)| *friction != Friction::None);
        let (joint_friction, pin_diameter) = match rubbing {
            Some((friction, radius)) => {
                let kind = kind(serde_json::to_value(friction));
                (Some(kind), Some(2.0 * radius))
            }
            None => (None, None),
        };
        let joint_damping = resisting.map_or(0.0, |it| it.damping);
        let (model, rollers) = chain.model.names();
        Self {
            model,
            rollers,
            strands: chain.model.strands().len(),
            joints: if rollers.is_some() {
                chain.rollers()
            } else {
                0
            },
            joint_clearance: chain.model.clearance().map(Clearance::gap),
            roller_clearance: chain.model.free_roller().map(FreeRoller::gap),
            joint_friction,
            pin_diameter,
            joint_damping,
            seal_torque: resisting.map_or(0.0, |it| it.seal),
        }
    }
}

/// The law of a kind of contact.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ContactFacts {
    /// The parts that touch: teeth, guides, joints or rollers.
    pub pair: &'static str,
    /// Kind of the elastic law.
    pub elastic: String,
    /// Kind of the dissipation.
    pub dissipation: String,
    /// Coefficient of restitution \[–\] where the dissipation has one.
    pub restitution: Option<f64>,
    /// Kind of the friction.
    pub friction: String,
    /// Thickness of the film of oil that the parts meet \[m\], where there is one.
    pub film: Option<f64>,
}

/// The contacts of a drive, each kind of pair once for every law.
pub(super) fn contacts(drive: &Drive) -> Vec<ContactFacts> {
    let teeth = drive.sprockets.iter().map(|s| ("teeth", &s.surface));
    let guides = drive.guides.iter().map(|guide| ("guides", &guide.surface));
    let mut surfaces: Vec<(&'static str, &Surface)> = teeth.chain(guides).collect();
    for placed in &drive.chains {
        let model = &placed.chain.model;
        let joints = model.clearance().map(|it| ("joints", &it.surface));
        let rollers = model.free_roller().map(|it| ("rollers", &it.surface));
        surfaces.extend(joints.into_iter().chain(rollers));
    }
    let mut found: Vec<ContactFacts> = Vec::new();
    for (pair, surface) in surfaces {
        let facts = ContactFacts {
            pair,
            elastic: kind(serde_json::to_value(surface.law.elastic)),
            dissipation: kind(serde_json::to_value(surface.law.dissipation)),
            restitution: surface.law.dissipation.restitution(),
            friction: match surface.friction {
                Friction::None => "none".to_owned(),
                friction => kind(serde_json::to_value(friction)),
            },
            film: surface.film.map(|film| film.thickness),
        };
        if !found.contains(&facts) {
            found.push(facts);
        }
    }
    found
}

/// Effects that the model of a drive leaves out, in words: oil in seats, friction where parts touch, damping of the links, errors of sprockets,
/// losses of shafts, what yields behind teeth, gravity.
pub fn left_out(drive: &Drive) -> Vec<&'static str> {
    let contacts = contacts(drive);
    let facts: Vec<LinkFacts> = drive
        .chains
        .iter()
        .map(|it| LinkFacts::of(&it.chain))
        .collect();
    // What does not touch does not lack friction.
    let slips = |pair: &str| {
        let own = || contacts.iter().filter(|contact| contact.pair == pair);
        own().next().is_some() && own().all(|contact| contact.friction == "none")
    };
    let mut on_teeth = contacts.iter().filter(|it| it.pair == "teeth").peekable();
    let dry = on_teeth.peek().is_some() && on_teeth.all(|it| it.film.is_none());
    // Pins that turn in their bushes rub in no contact of these.
    let idle = !facts.is_empty() && facts.iter().all(|it| it.joint_friction.is_none());
    let mut chains = drive.chains.iter();
    let undamped = chains.all(|placed| {
        let springs = placed.chain.model.has_springs();
        springs && placed.chain.damping.iter().all(|d| *d <= 0.0)
    });
    let mut sprockets = drive.sprockets.iter().peekable();
    let exact = sprockets.peek().is_some() && sprockets.all(|it| it.tolerance.is_none());
    let losses = || {
        let at_sprockets = drive.sprockets.iter().map(|it| &it.loss);
        at_sprockets.chain(drive.shafts.iter().map(|it| &it.loss))
    };
    let turns = !drive.shafts.is_empty();
    let frictionless = turns && losses().all(|it| it.bearing.is_none());
    let clear = turns && losses().all(|it| it.drag.is_none());
    let mut sprockets = drive.sprockets.iter().peekable();
    let stiff = sprockets.peek().is_some() && sprockets.all(|it| it.stack.is_none());
    // Pins that move by themselves have what yields behind their own contacts.
    let mut chains = drive.chains.iter();
    let stiff = stiff && chains.any(|placed| placed.chain.model.fused()[1]);
    let lacks = [
        (dry, "oil between rollers and teeth"),
        (slips("teeth"), "friction on teeth"),
        (slips("guides"), "friction on guides"),
        (slips("rollers"), "friction of rollers on their bushes"),
        (idle, "friction of pins in their bushes"),
        (undamped, "damping of the links"),
        (exact, "run-out and pitch errors of sprockets"),
        (frictionless, "friction of the bearings of shafts"),
        (clear, "drag of oil and air on shafts"),
        (stiff, "bending of pins and bushes behind the teeth"),
        (drive.gravity.norm() <= 0.0, "gravity"),
    ];
    let found = lacks.into_iter().filter(|(lacking, _)| *lacking);
    found.map(|(_, name)| name).collect()
}

/// The kind of a law, as scenes write it.
fn kind(law: serde_json::Result<Value>) -> String {
    let kind = law
        .ok()
        .and_then(|law| Some(law["kind"].as_str()?.to_owned()));
    kind.unwrap_or_default()
}
