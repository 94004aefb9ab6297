//! Rigid links: bodies, joints and rollers.

use chaindrive_contact::Elastic;
use chaindrive_contact::Friction;
use chaindrive_contact::Law;
use chaindrive_contact::elastic::{ElasticLaw, Johnson, Power};
use chaindrive_geometry::Vector;
use chaindrive_mechanics::{
    ChainModel, Clearance, FreeRoller, Joint, LinkBody, PointJoints, RigidLinks, RollerModel,
    Surface,
};

use serde_json::json;

use super::articulation::Joints;
use super::body::Body;
use super::contact_stiffness::{PRESSED, stiffness_under_pretension};
use super::film::Strip;
use super::law::{Pair, cylindrical, elastic, steel};
use super::{Findings, contact, strands};
use crate::scene::defaults;
use crate::scene::schema::{self, Rollers, Route, SceneText};

/// Model of links that are springs. `text` is the chain completed from the catalogue.
pub(super) fn of_springs(
    all: (&SceneText, Option<&Route>),
    text: &schema::Chain,
    roller_diameter: f64,
    roller_length: Option<f64>,
    findings: &mut Findings<'_>,
) -> Option<ChainModel> {
    if text.model.has_strands() {
        strands::model(text).map(ChainModel::Strands)
    } else if text.is_of_points() {
        points(all, text, roller_diameter, roller_length, findings)
    } else {
        Some(ChainModel::Particles)
    }
}

/// Keys of rigid links have no meaning for particles.
pub(super) fn refuse_on_particles(text: &schema::Chain, findings: &mut Findings<'_>) {
    if text.model.has_strands() {
        return;
    }
    if text.is_of_points() {
        let inertia = |link: Option<schema::Link>| link.is_some_and(|it| it.inertia.is_some());
        let given = [
            ("inner.inertia", inertia(text.inner)),
            ("outer.inertia", inertia(text.outer)),
        ];
        let message = "the particle chain has its masses at the joints";
        let mut at = findings.at("chain");
        at.refuse_given(given, message, "leave it out");
        if text.ends.is_some() {
            let message = "free rollers of a particle chain need a closed chain";
            let hint = "leave `rollers` out, or take `model = \"clearance-joints\"`";
            findings.refuse_with("chain.rollers", message, hint);
        }
        return;
    }
    let given = [
        ("rollers", text.rollers.is_some()),
        ("outer_first", text.outer_first),
        ("inner", text.inner.is_some()),
        ("outer", text.outer.is_some()),
        ("roller", text.roller.is_some()),
    ];
    let hint = "take `model = \"clearance-joints\"` or `\"ideal-joints\"`, or `rollers = \"free\"`, or leave it out";
    let message = "the particle chain has none";
    findings.at("chain").refuse_given(given, message, hint);
}

/// Keys of the particle chain have no meaning for rigid links.
pub(super) fn refuse_of_particles(text: &schema::Chain, findings: &mut Findings<'_>) {
    let scatter = text.scatter.clone().unwrap_or_default();
    let mut at = findings.at("chain");
    let message = "rigid links have none";
    let masses = [
        ("mass", text.mass.is_some()),
        ("masses", text.masses.is_some()),
    ];
    let hint = "give `chain.inner.mass` and `chain.outer.mass`, or leave it out";
    at.refuse_given(masses, message, hint);
    let stiffnesses = [("stiffnesses", text.stiffnesses.is_some())];
    at.refuse_given(
        stiffnesses,
        message,
        "give one `stiffness`, or leave it out",
    );
    let dampings = [
        ("damping", text.damping.is_some()),
        ("damping_ratio", text.damping_ratio.is_some()),
    ];
    at.refuse_given(dampings, message, "only contacts damp them; leave it out");
    let scattered = [
        ("scatter.mass", scatter.mass.0 != 0.0),
        ("scatter.stiffness", scatter.stiffness.0 != 0.0),
    ];
    at.refuse_given(scattered, message, "only lengths can scatter; leave it out");
}

/// Values that must be there, and what to say where they are not.
struct RequiredValues<'f, 't> {
    findings: &'f mut Findings<'t>,
    of_type: Option<String>,
}

impl RequiredValues<'_, '_> {
    fn value(&mut self, value: Option<impl Into<f64>>, key: &str, what: &str) -> Option<f64> {
        if value.is_none() {
            let hint = match &self.of_type {
                Some(name) => {
                    format!("give the {what}, which the catalogue does not have for {name}")
                }
                None => format!("give the {what}"),
            };
            self.findings
                .refuse_with(&format!("chain.{key}"), "missing", hint);
        }
        value.map(Into::into)
    }
}

/// The links of a chain of rigid bodies. `text` is the chain completed from the catalogue.
pub(super) fn resolve(
    (scene, route): (&SceneText, Option<&Route>),
    text: &schema::Chain,
    count: usize,
    roller_diameter: f64,
    roller_length: Option<f64>,
    findings: &mut Findings<'_>,
) -> Option<Body> {
    let mut needs = RequiredValues {
        findings,
        of_type: text.of_type.clone(),
    };
    let inner = link(text.inner, "inner", &mut needs);
    let outer = link(text.outer, "outer", &mut needs);
    let rollers = rollers(scene, text, roller_diameter, roller_length, &mut needs);
    let joint = joint((scene, route), text, roller_diameter, &mut needs);
    let links = RigidLinks {
        inner: inner?,
        outer: outer?,
        outer_first: text.outer_first,
        joint: joint?,
        rollers: rollers?,
    };
    let pair = Pair {
        radius: 0.5 * roller_diameter,
        bore: None,
        length: roller_length,
    };
    let stiffness = match text.stiffness {
        Some(stiffness) => stiffness.0,
        None => laying_stiffness((scene, route), &links.joint, pair, findings)?,
    };
    Some(Body {
        masses: masses(&links, count, text.ends.is_some()),
        stiffness: vec![stiffness; count],
        model: ChainModel::Rigid(links),
    })
}

/// Rollers, bushes and pins of a particle chain as points of their own. `text` is the chain completed from the catalogue.
fn points(
    (scene, route): (&SceneText, Option<&Route>),
    text: &schema::Chain,
    roller_diameter: f64,
    roller_length: Option<f64>,
    findings: &mut Findings<'_>,
) -> Option<ChainModel> {
    let mut needs = RequiredValues {
        findings,
        of_type: text.of_type.clone(),
    };
    let mut mass = |text: Option<schema::Link>, name: &str| {
        let what = format!("mass of an {name} link");
        let mass = text.and_then(|link| link.mass);
        needs.value(mass, &format!("{name}.mass"), &what)
    };
    let (inner, outer) = (mass(text.inner, "inner"), mass(text.outer, "outer"));
    let rollers = rollers(scene, text, roller_diameter, roller_length, &mut needs);
    let joint = joint((scene, route), text, roller_diameter, &mut needs);
    let (Some(RollerModel::Free(roller)), Some(Joint::Clearance(joint))) = (rollers, joint) else {
        return None;
    };
    if roller.surface.friction != Friction::None {
        let message = "free rollers of a particle chain do not turn";
        let hint = "leave it out, or take `model = \"clearance-joints\"`";
        findings.refuse_with("contact.rollers.friction", message, hint);
    }
    Some(ChainModel::Points(PointJoints {
        inner: inner?,
        outer: outer?,
        outer_first: text.outer_first,
        joint,
        roller,
    }))
}

fn link(
    text: Option<schema::Link>,
    name: &str,
    needs: &mut RequiredValues<'_, '_>,
) -> Option<LinkBody> {
    let text = text.unwrap_or_default();
    let what = format!("mass of an {name} link");
    let mass = needs.value(text.mass, &format!("{name}.mass"), &what);
    let what = format!("moment of inertia of an {name} link about its centre of mass");
    let inertia = needs.value(text.inertia, &format!("{name}.inertia"), &what);
    Some(LinkBody {
        mass: mass?,
        inertia: inertia?,
        centre: Vector::new(text.centre[0].0, text.centre[1].0),
    })
}

/// Whether there is nothing that a roller could touch.
fn touches_nothing(scene: &SceneText) -> bool {
    scene.sprockets.is_empty() && scene.guides.is_empty()
}

fn rollers(
    scene: &SceneText,
    text: &schema::Chain,
    roller_diameter: f64,
    length: Option<f64>,
    needs: &mut RequiredValues<'_, '_>,
) -> Option<RollerModel> {
    let roller = text.roller.clone().unwrap_or_default();
    let model = text.rollers.unwrap_or_else(|| {
        let findings = &mut *needs.findings;
        if touches_nothing(scene) && text.roller.is_none() {
            findings.assume("chain.rollers", "none", "the chain touches nothing");
            Rollers::None
        } else {
            findings.assume("chain.rollers", "lumped", "assumed: the usual choice");
            Rollers::Lumped
        }
    });
    match model {
        Rollers::Lumped => {
            let mass = needs.value(roller.mass, "roller.mass", "mass of a roller")?;
            Some(RollerModel::Lumped { mass })
        }
        Rollers::None => {
            let described = roller
                != schema::Roller {
                    length: roller.length,
                    ..schema::Roller::default()
                };
            if described {
                let hint = "take `rollers = \"lumped\"` or `\"free\"`, or leave it out";
                needs
                    .findings
                    .refuse_with("chain.roller", "this chain has no rollers", hint);
            }
            Some(RollerModel::Bush)
        }
        Rollers::Free => {
            let mass = needs.value(roller.mass, "roller.mass", "mass of a roller");
            let what = "moment of inertia of a roller";
            let inertia = needs.value(roller.inertia, "roller.inertia", what);
            let bush = roller.bush_diameter.map(|diameter| 0.5 * diameter.0);
            let bush = needs.value(bush, "roller.bush_diameter", "outer diameter of the bush");
            let what = "radial clearance between bush and roller, such as \"0.05 mm\"";
            let clearance = needs.value(roller.clearance, "roller.clearance", what);
            let (bush, clearance) = (bush?, clearance?);
            let bore = bush + clearance;
            if bore >= 0.5 * roller_diameter {
                let message = format!("{}, must be less", 2.0 * bush);
                let hint = format!("the roller around it has a diameter of {roller_diameter} m");
                needs
                    .findings
                    .refuse_with("chain.roller.bush_diameter", message, hint);
                return None;
            }
            let pair = Pair {
                radius: bush,
                bore: Some(bore),
                length,
            };
            let said = contact::ContactText {
                own: &roller.contact,
                path: "chain.roller.contact",
                common: &scene.contact.rollers,
                fallback: contact::ROLLERS,
            };
            let law = law(said, pair, clearance, "roller", needs.findings);
            let friction = said.friction(needs.findings);
            let film = said.film(Strip::in_bore(pair), needs.findings);
            Some(RollerModel::Free(FreeRoller {
                mass: mass?,
                inertia: inertia?,
                bush_radius: bush,
                bore_radius: bore,
                surface: Surface {
                    law: law?,
                    friction: friction?,
                    film,
                },
            }))
        }
    }
}

fn joint(
    (scene, route): (&SceneText, Option<&Route>),
    text: &schema::Chain,
    roller_diameter: f64,
    needs: &mut RequiredValues<'_, '_>,
) -> Option<Joint> {
    if text.model == schema::ChainModel::IdealJoints {
        return Some(Joint::Ideal);
    }
    let joint = text.joint.clone().unwrap_or_default();
    let pin = joint.pin_diameter.map(|diameter| 0.5 * diameter.0);
    let pin = needs.value(pin, "joint.pin_diameter", "diameter of the pin");
    let what = "radial clearance between pin and bush, such as \"0.025 mm\"";
    let clearance = needs.value(joint.clearance, "joint.clearance", what);
    let (pin, clearance) = (pin?, clearance?);
    let bore = pin + clearance;
    // What surrounds the bore: the bush, and at the latest the roller.
    let bush = text.roller.as_ref().and_then(|roller| roller.bush_diameter);
    let bush = bush.map_or(roller_diameter, f64::from);
    if 2.0 * bore >= bush {
        let message = format!("{}, must be less", 2.0 * pin);
        let hint = format!("the bush around it has a diameter of {bush} m");
        needs
            .findings
            .refuse_with("chain.joint.pin_diameter", message, hint);
        return None;
    }
    let pair = Pair {
        radius: pin,
        bore: Some(bore),
        length: joint.length.map(f64::from),
    };
    let said = contact::ContactText {
        own: &joint.contact,
        path: "chain.joint.contact",
        common: &scene.contact.joints,
        fallback: contact::JOINTS,
    };
    let known = Joints::new(scene, text, text.stiffness.map(f64::from));
    // Particles have their friction beside the contact, and half of their plates in the links.
    let points = text.is_of_points();
    let friction = if points {
        Some(Friction::None)
    } else {
        known.friction(needs.findings)
    };
    let law = if clearance == 0.0 {
        without_play(said, pair, &known, points, needs)
    } else {
        let law = law(said, pair, clearance, "joint", needs.findings);
        law.map(|law| match said.series() {
            Some(_) => law,
            None => Law {
                series: known.plates(&law, route, pin, points, needs.findings),
                ..law
            },
        })
    };
    let film = said.film(Strip::in_bore(pair), needs.findings);
    let law = law?;
    Some(Joint::Clearance(Clearance {
        pin_radius: pin,
        bore_radius: bore,
        surface: Surface {
            law,
            friction: friction?,
            film,
        },
    }))
}

/// Law of pins that fill their bores: they touch all around, and only the link beside them yields.
fn without_play(
    said: contact::ContactText<'_>,
    pair: Pair,
    known: &Joints<'_>,
    points: bool,
    needs: &mut RequiredValues<'_, '_>,
) -> Option<Law> {
    if points {
        let message = "free rollers of a particle chain need pins with play";
        let hint = "give a clearance, or take `model = \"clearance-joints\"`";
        needs
            .findings
            .refuse_with("chain.joint.clearance", message, hint);
        return None;
    }
    if let Some(path) = said.law_path() {
        let message = "pins without play have no contact of their own";
        let hint = "leave it out: `series` is the stiffness of the joint then, or give a clearance";
        needs.findings.refuse_with(&path, message, hint);
        return None;
    }
    if let Some((_, path)) = said.film_text() {
        let message = "pins without play have no room for oil";
        let hint = "leave it out, or give `chain.joint.clearance`";
        needs.findings.refuse_with(&path, message, hint);
        return None;
    }
    let series = said.series().filter(|stiffness| *stiffness > 0.0);
    let stiffness = series.or(known.link_stiffness());
    let what = "stiffness of a link between its pins, or take `model = \"ideal-joints\"`";
    let stiffness = needs.value(stiffness, "stiffness", what)?;
    let law = said.law(pair, needs.findings, |_| {
        Some(Elastic::Power(Power::linear(stiffness)))
    })?;
    Some(Law {
        series: None,
        ..law
    })
}

/// Law of what turns in a bore; steel, and the enhanced cylindrical law, unless the scene says more.
fn law(
    said: contact::ContactText<'_>,
    pair: Pair,
    clearance: f64,
    name: &str,
    findings: &mut Findings<'_>,
) -> Option<Law> {
    said.law(pair, findings, |findings| {
        let Some(length) = pair.length else {
            let hint = format!("give the length of the contact, or `contact.{name}s.law`");
            findings.refuse_with(&format!("chain.{name}.length"), "missing", hint);
            return None;
        };
        let steel = steel();
        let law = cylindrical(pair, clearance, length, steel);
        if law.is_ok() {
            let text = json!({
                "kind": "cylindrical",
                "length": length,
                "modulus": steel.modulus,
                "poisson": steel.poisson,
            });
            // What is common is that of the only chain.
            let common = format!("contact.{name}s");
            let of = findings.chain.map_or(common, |_| said.path.to_owned());
            let remark = "follows from the dimensions of the chain";
            findings.assume(&format!("{of}.law"), text, remark);
        }
        law.map_err(|error| {
            let message = format!("{}, must be {}", error.value, error.allowed);
            let hint = format!("say so in `contact.{name}s.law`");
            findings.refuse_with(&format!("chain.{name}.{}", error.parameter), message, hint);
        })
        .ok()
    })
}

/// Stiffness with which the links are laid and settled \[N/m\]: that of a joint under the pretension,
/// or ten times that of a tooth.
fn laying_stiffness(
    (scene, route): (&SceneText, Option<&Route>),
    joint: &Joint,
    pair: Pair,
    findings: &mut Findings<'_>,
) -> Option<f64> {
    if let Joint::Clearance(joint) = joint {
        let stiffness = stiffness_under_pretension(&joint.surface.law, route, pair.radius);
        let remark = "follows from a joint under the pretension";
        findings.assume("chain.stiffness", stiffness, remark);
        return Some(stiffness);
    }
    // Where there are no teeth, those of a roller as long as it is thick will do.
    let length = pair
        .length
        .or(touches_nothing(scene).then_some(2.0 * pair.radius));
    let teeth = match (&scene.contact.teeth.law, length) {
        (Some(law), _) => elastic(law, pair, findings.at("contact.teeth.law"))?,
        (None, Some(length)) => {
            let steel = steel();
            Elastic::Johnson(Johnson::flat(pair.radius, length, steel.composite(steel)))
        }
        (None, None) => {
            let hint = "rigid links are laid with it; or give `contact.teeth.law`, of whose stiffness it is ten times";
            findings.refuse_with("chain.stiffness", "missing", hint);
            return None;
        }
    };
    let tooth = teeth.stiffness(PRESSED);
    let default = &defaults::LAYING_STIFFNESS;
    let mut at = findings.at("chain.stiffness");
    Some(at.or_multiple(None::<f64>, default, tooth))
}

/// Masses of the rollers while the chain is laid \[kg\]: every link halved between its ends.
fn masses(links: &RigidLinks, count: usize, open: bool) -> Vec<f64> {
    let roller = match links.rollers {
        RollerModel::Lumped { mass } => mass,
        RollerModel::Free(roller) => roller.mass,
        RollerModel::Bush => 0.0,
    };
    let rollers = count + usize::from(open);
    let mut masses = vec![0.0; rollers];
    for link in 0..count {
        let whole = if link.is_multiple_of(2) == links.outer_first {
            links.outer.mass
        } else {
            links.inner.mass + 2.0 * roller
        };
        masses[link] += 0.5 * whole;
        masses[(link + 1) % rollers] += 0.5 * whole;
    }
    masses
}
