//! Two sprockets and the chain around them: the scene of most cases.

use std::fmt::Write as _;

use chaindrive::Scene;

/// The route ends with the upper span: the lower one hangs.
pub(crate) const LOWER_SPAN_HANGS: &str = "[route]\nstops = [\"driven\", \"driver\"]";

/// A scene of `driver` at the origin and `driven` beside it. Numbers that are zero and texts that are empty are not written.
#[derive(Clone, Copy)]
pub(crate) struct TwoSprockets<'a> {
    /// Keys and tables before those of the chain.
    pub(crate) before: &'a str,
    /// Pitch \[m\].
    pub(crate) pitch: f64,
    pub(crate) links: f64,
    /// Mass \[kg\] and stiffness \[N/m\] of a link.
    pub(crate) mass: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping_ratio: f64,
    /// Diameter of the rollers \[m\].
    pub(crate) roller: f64,
    /// Other keys of the chain.
    pub(crate) chain: &'a str,
    /// Stiffness of a roller on its teeth \[N/m\], where it is not that of the catalogue, and a damper beside it \[N s/m\].
    pub(crate) contact: f64,
    pub(crate) damper: f64,
    /// Other keys of `contact.teeth`.
    pub(crate) teeth_keys: &'a str,
    pub(crate) teeth: [f64; 2],
    /// Gaps of both sprockets.
    pub(crate) tooth: &'a str,
    /// Centre of the driven sprocket \[m\].
    pub(crate) centre: [f64; 2],
    /// Keys of the driver, among them its motion.
    pub(crate) driver: &'a str,
    /// Of the driven sprocket \[kg m²\].
    pub(crate) inertia: f64,
    /// Other keys of the driven sprocket.
    pub(crate) driven: &'a str,
    /// Tables after those of the sprockets, and keys of the run, the last of them.
    pub(crate) after: &'a str,
    /// How long it runs, and the time between samples \[s\].
    pub(crate) until: f64,
    pub(crate) every: f64,
    /// Other keys of the run.
    pub(crate) run: &'a str,
}

/// A driver at this speed \[rad/s\].
pub(crate) fn steady(speed: f64) -> String {
    format!("motion = {{ kind = \"constant\", speed = {speed} }}")
}

/// A small drive of soft links and teeth: its steps are long, and it is steady within a second.
pub(crate) const SOFT: TwoSprockets<'_> = TwoSprockets {
    pitch: 25.4e-3,
    links: 40.0,
    mass: 0.07,
    stiffness: 2e6,
    damping_ratio: 0.1,
    roller: 15.88e-3,
    chain: "drag = \"20 N s/m^2\"",
    contact: 1e7,
    teeth_keys: "restitution = 0.5",
    teeth: [20.0; 2],
    centre: [0.254, 0.0],
    driver: "motion = { kind = \"constant\", speed = 60 }",
    inertia: 0.01,
    driven: "load = [{ kind = \"constant\", torque = -20 }]",
    after: "[route]\npretension = \"600 N\"",
    until: 0.5,
    every: 1e-3,
    ..TwoSprockets::NOTHING
};

impl TwoSprockets<'_> {
    pub(crate) const NOTHING: Self = Self {
        before: "",
        pitch: 0.0,
        links: 0.0,
        mass: 0.0,
        stiffness: 0.0,
        damping_ratio: 0.0,
        roller: 0.0,
        chain: "",
        contact: 0.0,
        damper: 0.0,
        teeth_keys: "",
        teeth: [0.0; 2],
        tooth: "",
        centre: [0.0; 2],
        driver: "",
        inertia: 0.0,
        driven: "",
        after: "",
        until: 0.0,
        every: 0.0,
        run: "",
    };

    pub(crate) fn scene(&self) -> Scene {
        Scene::from_text(&self.text(), "two sprockets").unwrap_or_else(|error| panic!("{error}"))
    }

    pub(crate) fn text(&self) -> String {
        let mut text = format!("{}\n[chain]\n", self.before);
        let mut write = |keys: &[(&str, f64)], more: &str| {
            for (key, value) in keys.iter().filter(|(_, value)| *value != 0.0) {
                writeln!(text, "{key} = {value}").expect("a text grows");
            }
            writeln!(text, "{more}").expect("a text grows");
        };
        let chain = [
            ("pitch", self.pitch),
            ("links", self.links),
            ("mass", self.mass),
            ("stiffness", self.stiffness),
            ("damping_ratio", self.damping_ratio),
            ("roller_diameter", self.roller),
        ];
        write(&chain, self.chain);
        let law = |stiffness| format!("law = {{ kind = \"linear\", stiffness = {stiffness} }}");
        if self.contact > 0.0 {
            write(&[], &format!("[contact.teeth]\n{}", law(self.contact)));
            write(&[("damping", self.damper)], self.teeth_keys);
        }
        let tooth = match self.tooth {
            "" => String::new(),
            tooth => format!("tooth = {tooth}"),
        };
        let ends = [
            ("driver", [0.0; 2], 0.0, self.driver),
            ("driven", self.centre, self.inertia, self.driven),
        ];
        for ((name, centre, inertia, keys), teeth) in ends.into_iter().zip(self.teeth) {
            write(
                &[],
                &format!("[[sprockets]]\nname = \"{name}\"\ncentre = {centre:?}\n{tooth}"),
            );
            write(&[("teeth", teeth), ("inertia", inertia)], keys);
        }
        write(&[], &format!("{}\n[run]", self.after));
        write(&[("until", self.until), ("every", self.every)], self.run);
        text
    }
}
