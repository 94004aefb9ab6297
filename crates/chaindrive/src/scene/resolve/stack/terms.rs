//! All parts behind the teeth of a sprocket that yield, from the dimensions of the chain.

use chaindrive_mechanics::{
    Beam, BeamEnds, JointMasses, StackTerm, StrikingMass, ToothStack, rim_compliance,
    wall_compliance,
};

use super::super::Findings;
use super::super::law::steel;
use super::{Parts, yields};
use crate::catalogue::Number;
use crate::scene::defaults;
use crate::scene::schema;

/// Parts of the stack behind the teeth of a sprocket that a scene asks for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked<'a> {
    pub(crate) stack: schema::Stack,
    /// Its place.
    pub(crate) path: &'a str,
    /// Depth of the steel below the gaps \[m\]; none for a solid body.
    pub(crate) rim: Option<f64>,
}

/// A dimension that must be known: its key, its value, and what it is called.
type Needed = (&'static str, Option<f64>, &'static str);

impl Parts {
    /// All parts behind the teeth of a sprocket that yield. None where a dimension is missing, which is refused.
    pub(crate) fn stack(
        &self,
        asked: Asked<'_>,
        findings: &mut Findings<'_>,
    ) -> Option<ToothStack> {
        let Asked { stack, path, rim } = asked;
        let place = format!("{path}.pin_ends");
        let pin_ends = findings.or_chosen(stack.pin_ends, &place, &defaults::PIN_ENDS);
        let load = stack.load.map(|it| it.0);
        let load = findings.or_default(load, &format!("{path}.load"), &defaults::STACK_LOAD);
        let [breaking, inner, outer] = self.needed(
            [
                ("breaking_load", self.breaking_load(), "least breaking load"),
                (
                    "inner.mass",
                    self.link(
                        self.text.inner,
                        |it| it.mass.map(|it| it.0),
                        Number::InnerMass,
                    ),
                    "mass of an inner link",
                ),
                (
                    "outer.mass",
                    self.link(
                        self.text.outer,
                        |it| it.mass.map(|it| it.0),
                        Number::OuterMass,
                    ),
                    "mass of an outer link",
                ),
            ],
            findings,
        )?;
        let load = load * breaking;
        let roller = self.text.roller.as_ref().and_then(|it| it.mass);
        let roller = self.number(roller.map(|it| it.0), Number::RollerMass);
        let masses = JointMasses {
            roller: roller.filter(|_| self.has_rollers()).unwrap_or(0.0),
            inner,
            outer,
        };
        let mut terms = Vec::new();
        if self.has_rollers() && self.fused[0] {
            terms.extend(self.of_roller(load, findings)?);
        }
        if !self.free_rollers {
            terms.extend(self.of_joint(load, pin_ends, masses, findings)?);
        }
        if let Some(depth) = rim {
            terms.push(self.of_rim(depth, findings)?);
        }
        // Strands side by side yield together.
        for term in &mut terms {
            term.compliance /= self.strands;
        }
        Some(ToothStack {
            load: self.strands * load,
            terms,
            striking: self.striking(masses),
        })
    }

    /// Values of the chain; those that are missing are refused.
    fn needed<const N: usize>(
        &self,
        needed: [Needed; N],
        findings: &mut Findings<'_>,
    ) -> Option<[f64; N]> {
        for (key, _, what) in needed.iter().filter(|(_, value, _)| value.is_none()) {
            let or_else = if self.text.model.has_springs() {
                "or take rigid links and give it"
            } else {
                "or give it"
            };
            let hint = format!(
                "the stack behind the teeth needs the {what}: take a `type` of the catalogue that has it, {or_else}"
            );
            findings.refuse_once(&format!("chain.{key}"), "missing", &hint);
        }
        let known = needed.iter().all(|(_, value, _)| value.is_some());
        known.then(|| needed.map(|(_, value, _)| value.unwrap_or_default()))
    }

    fn breaking_load(&self) -> Option<f64> {
        let given = self.text.breaking_load.map(|it| it.0);
        // That of strands is the load of them all.
        let of_strand = given.map(|it| it / self.strands);
        self.number(of_strand, Number::BreakingLoad)
    }

    /// A property of a link, as the scene has it or the catalogue.
    fn link(
        &self,
        link: Option<schema::Link>,
        property: fn(schema::Link) -> Option<f64>,
        of: Number,
    ) -> Option<f64> {
        self.number(link.and_then(property), of)
    }

    /// Whether rollers run on the teeth, and no bushes.
    fn has_rollers(&self) -> bool {
        let is_bush = self.of_type.is_some_and(|it| it.kind == "bush");
        self.free_rollers || (self.fused[0] && !is_bush)
    }

    /// Mass that strikes, in proportion to that of the links of the scene.
    fn striking(&self, masses: JointMasses) -> StrikingMass {
        let inertia = |link, of| self.link(link, |it| it.inertia.map(|it| it.0), of);
        let inner = inertia(self.text.inner, Number::InnerInertia);
        let outer = inertia(self.text.outer, Number::OuterInertia);
        let hinged = || {
            let scale = self.mass / masses.lumped();
            Some(scale * masses.hinged(self.text.pitch?.0, [inner?, outer?]))
        };
        StrikingMass {
            lumped: self.mass,
            hinged: hinged(),
        }
    }

    /// Wall of the roller, and roller on bush, under a load \[N\].
    fn of_roller(&self, load: f64, findings: &mut Findings<'_>) -> Option<[StackTerm; 2]> {
        let length = self.roller_length();
        let [bush, play, length, roller] = self.needed(
            [
                BUSH.of(self.bush_diameter()),
                PLAY.of(self.roller_play()),
                WIDTH.of(length),
                ROLLER.of(self.text.roller_diameter.map(|it| it.0)),
            ],
            findings,
        )?;
        let [bush, roller] = [0.5 * bush, 0.5 * roller];
        let modulus = steel(findings.version).modulus;
        let whole = |part, compliance| StackTerm {
            part,
            compliance,
            share: 1.0,
        };
        Some([
            whole(
                "wall of the roller",
                wall_compliance([roller, bush + play], length, modulus),
            ),
            whole(
                "roller on bush",
                yields([bush, play, length], load, findings)?,
            ),
        ])
    }

    /// Bush and pin, where they do not move by themselves, each with its share of a load \[N\].
    fn of_joint(
        &self,
        load: f64,
        pin_ends: BeamEnds,
        masses: JointMasses,
        findings: &mut Findings<'_>,
    ) -> Option<Vec<StackTerm>> {
        let bush = if self.has_rollers() {
            self.bush_diameter()
        } else {
            self.text.roller_diameter.map(|it| it.0)
        };
        let [bush, pin, play, length, width] = self.needed(
            [
                BUSH.of(bush),
                (
                    "joint.pin_diameter",
                    self.pin_diameter(),
                    "diameter of the pin",
                ),
                PLAY.of(self.play()),
                ("joint.length", self.joint_length(), "length of the bush"),
                WIDTH.of(self.roller_length()),
            ],
            findings,
        )?;
        let [bush, pin] = [0.5 * bush, 0.5 * pin];
        let bore = pin + play;
        let material = steel(findings.version);
        let beam = |[outer_radius, inner_radius]: [f64; 2], length, ends| Beam {
            outer_radius,
            inner_radius,
            length,
            ends,
            material,
        };
        let [of_bush, of_pin] = masses.shares();
        let mut terms = vec![StackTerm {
            part: "bending of the bush",
            compliance: beam([bush, bore], width, BeamEnds::Clamped).compliance(),
            share: of_bush,
        }];
        if self.fused[1] {
            let on_pin = |part, compliance| StackTerm {
                part,
                compliance,
                share: of_pin,
            };
            let contact = yields([pin, play, length], of_pin * load, findings)?;
            let bending = beam([pin, 0.0], length, pin_ends).compliance();
            let wall = wall_compliance([bush, bore], length, material.modulus);
            terms.push(on_pin("wall of the bush", wall));
            terms.push(on_pin("bush on pin", contact));
            terms.push(on_pin("bending of the pin", bending));
        }
        Some(terms)
    }

    /// The steel below a gap, down to a depth \[m\].
    fn of_rim(&self, depth: f64, findings: &mut Findings<'_>) -> Option<StackTerm> {
        let [roller, width, pitch] = self.needed(
            [
                ROLLER.of(self.text.roller_diameter.map(|it| it.0)),
                WIDTH.of(self.roller_length()),
                ("pitch", self.text.pitch.map(|it| it.0), "pitch"),
            ],
            findings,
        )?;
        // ISO 606: b_f = 0.93 b₁ up to a pitch of 12.7 mm, 0.95 b₁ above.
        let teeth = if pitch > 12.7e-3 { 0.95 } else { 0.93 } * width;
        let modulus = steel(findings.version).modulus;
        Some(StackTerm {
            part: "rim of the sprocket",
            compliance: rim_compliance(depth, 0.5 * roller, teeth, modulus),
            share: 1.0,
        })
    }
}

/// A dimension of the chain that more than one part needs.
#[derive(Clone, Copy, Debug)]
struct Dimension {
    key: &'static str,
    what: &'static str,
}

const BUSH: Dimension = Dimension {
    key: "roller.bush_diameter",
    what: "outer diameter of the bush",
};
const PLAY: Dimension = Dimension {
    key: "joint.clearance",
    what: "radial clearance between pin and bush",
};
const WIDTH: Dimension = Dimension {
    key: "roller.length",
    what: "width between the inner plates",
};
const ROLLER: Dimension = Dimension {
    key: "roller_diameter",
    what: "diameter of the roller",
};

impl Dimension {
    fn of(self, value: Option<f64>) -> Needed {
        (self.key, value, self.what)
    }
}
