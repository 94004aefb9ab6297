//! All parts behind the teeth of a sprocket that yield, from the dimensions of the chain.

use chaindrive_mechanics::{
    Beam, BeamEnds, JointMasses, StackTerm, StrikingMass, ToothStack, rim_compliance,
    wall_compliance,
};

use super::super::Findings;
use super::super::cursor::Cursor;
use super::super::law::steel;
use super::{Parts, yields};
use crate::catalogue::Number;
use crate::scene::defaults;
use crate::scene::schema;
use chaindrive_quantities::Length;

/// A dimension that must be known: its key, its value, and what it is called.
type RequiredDimension = (&'static str, Option<f64>, &'static str);

impl Parts {
    /// All parts behind the teeth of a sprocket that yield, with the steel of a rim of some depth below the gaps. None where a dimension is
    /// missing, which is refused.
    pub(crate) fn stack(
        &self,
        text: schema::Stack,
        rim: Option<Length>,
        mut at: Cursor<'_, '_>,
    ) -> Option<ToothStack> {
        let mut ends = at.key("pin_ends");
        let pin_ends = ends.or_chosen(text.pin_ends, &defaults::PIN_ENDS);
        let load = at.key("load").or(text.load, &defaults::STACK_LOAD);
        let findings = at.findings;
        let [breaking, inner, outer] = self.needed(
            [
                ("breaking_load", self.breaking_load(), "least breaking load"),
                (
                    "inner.mass",
                    self.link(self.text.inner, |it| it.mass, Number::InnerMass),
                    "mass of an inner link",
                ),
                (
                    "outer.mass",
                    self.link(self.text.outer, |it| it.mass, Number::OuterMass),
                    "mass of an outer link",
                ),
            ],
            findings,
        )?;
        let load = load * breaking;
        let roller = self.text.roller.as_ref().and_then(|it| it.mass);
        let roller = self.number(roller, Number::RollerMass);
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
            terms.push(self.of_rim(depth.0, findings)?);
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
        needed: [RequiredDimension; N],
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
        let given = self.text.breaking_load;
        // That of strands is the load of them all.
        let of_strand = given.map(|it| it.0 / self.strands);
        self.number(of_strand, Number::BreakingLoad)
    }

    /// A property of a link, as the scene has it or the catalogue.
    fn link<T: Into<f64>>(
        &self,
        link: Option<schema::Link>,
        property: fn(schema::Link) -> Option<T>,
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
        let inertia = |link, of| self.link(link, |it| it.inertia, of);
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
                ROLLER.of(self.text.roller_diameter),
            ],
            findings,
        )?;
        let [bush, roller] = [0.5 * bush, 0.5 * roller];
        let modulus = steel().modulus;
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
            whole("roller on bush", yields([bush, play, length], load)?),
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
            self.text.roller_diameter.map(f64::from)
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
        let material = steel();
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
            let contact = yields([pin, play, length], of_pin * load)?;
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
                ROLLER.of(self.text.roller_diameter),
                WIDTH.of(self.roller_length()),
                ("pitch", self.text.pitch.map(f64::from), "pitch"),
            ],
            findings,
        )?;
        // ISO 606: b_f = 0.93 b₁ up to a pitch of 12.7 mm, 0.95 b₁ above.
        let teeth = if pitch > 12.7e-3 { 0.95 } else { 0.93 } * width;
        let modulus = steel().modulus;
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
    fn of(self, value: Option<impl Into<f64>>) -> RequiredDimension {
        (self.key, value.map(Into::into), self.what)
    }
}
