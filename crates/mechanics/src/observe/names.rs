//! Names and sizes of what a drive has, in the order of its readings.

use crate::system::{Member, System};

/// Size of a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChainSize {
    /// Rollers.
    pub rollers: usize,
    /// Links.
    pub links: usize,
    /// Joints with a state of their own.
    pub joints: usize,
    /// Spans between sprockets.
    pub spans: usize,
}

impl System {
    /// Names of the spans: "from-to" for consecutive sprockets of the route.
    pub fn span_names(&self) -> Vec<String> {
        let routes = self.chains.iter().map(|member| &member.route);
        routes
            .flat_map(|route| {
                let name = |k: usize| &self.bodies.wheels[route[k % route.len()]].name;
                (0..route.len()).map(move |i| format!("{}-{}", name(i), name(i + 1)))
            })
            .collect()
    }

    /// Sprockets at both ends of every span, by index, in the order of [`span_names`](Self::span_names).
    pub fn span_sprockets(&self) -> Vec<[usize; 2]> {
        let routes = self.chains.iter().map(|member| &member.route);
        routes
            .flat_map(|route| (0..route.len()).map(|i| [route[i], route[(i + 1) % route.len()]]))
            .collect()
    }

    /// Number of sprockets that turn by themselves, and of those whose rotation is given, directly or through gears.
    pub fn turning_sprockets(&self) -> [usize; 2] {
        let wheels = &self.bodies.wheels;
        let free = wheels.iter().filter(|it| it.turn.turned_by().is_some());
        let free = free.count();
        [free, wheels.len() - free]
    }

    /// Names of the chains, empty where there is one only; and how many rollers, links, joints and spans each has.
    pub fn chain_sizes(&self) -> Vec<(String, ChainSize)> {
        let size = |member: &Member| ChainSize {
            rollers: member.chain.rollers(),
            links: member.chain.links(),
            joints: member.chain.joints(),
            spans: member.route.len(),
        };
        let members = self.chains.iter();
        members
            .map(|member| (member.name.clone().unwrap_or_default(), size(member)))
            .collect()
    }

    /// Names of the shafts that have one, those that carry no more than a sprocket of their own left out.
    pub fn shaft_names(&self) -> Vec<String> {
        let shafts = self.bodies.shafts.iter();
        shafts.filter_map(|shaft| shaft.name.clone()).collect()
    }

    /// The shaft of a name, or that of the sprocket of a name.
    pub fn shaft_named(&self, name: &str) -> Option<usize> {
        let mut shafts = self.bodies.shafts.iter();
        let own = shafts.position(|shaft| shaft.name.as_deref() == Some(name));
        let wheel = || self.bodies.wheels.iter().find(|wheel| wheel.name == name);
        own.or_else(|| wheel().map(|wheel| wheel.shaft))
    }

    /// The sprocket of a name.
    pub fn sprocket_named(&self, name: &str) -> Option<usize> {
        let mut wheels = self.bodies.wheels.iter();
        wheels.position(|wheel| wheel.name == name)
    }

    /// The tensioner of a name.
    pub fn tensioner_named(&self, name: &str) -> Option<usize> {
        let mut slides = self.bodies.slides.iter();
        slides.position(|slide| slide.name == name)
    }

    /// Names of the couplings.
    pub fn coupling_names(&self) -> Vec<String> {
        let couplings = self.bodies.couplings.iter();
        couplings.map(|coupling| coupling.name.clone()).collect()
    }

    /// Names of the sprockets.
    pub fn sprocket_names(&self) -> Vec<String> {
        self.bodies
            .wheels
            .iter()
            .map(|wheel| wheel.name.clone())
            .collect()
    }

    /// Names of the guides.
    pub fn guide_names(&self) -> Vec<String> {
        self.bodies
            .rails
            .iter()
            .map(|rail| rail.name.clone())
            .collect()
    }

    /// Names of the tensioners.
    pub fn tensioner_names(&self) -> Vec<String> {
        self.bodies
            .slides
            .iter()
            .map(|slide| slide.name.clone())
            .collect()
    }

    /// Names of the tensioners whose oil can be compressed.
    pub fn oil_column_names(&self) -> Vec<String> {
        let slides = self.bodies.slides.iter();
        let columns = slides.filter(|slide| slide.push.pressure(0.0, 0.0).is_some());
        columns.map(|slide| slide.name.clone()).collect()
    }

    /// SI units of the position and of the push of every tensioner.
    pub fn tensioner_units(&self) -> Vec<(&'static str, &'static str)> {
        let carriers = self.bodies.slides.iter().map(|slide| &slide.carrier);
        carriers
            .map(|carrier| (carrier.coordinate_unit(), carrier.push_unit()))
            .collect()
    }

    /// Where in the drive a coordinate of the state belongs, in words.
    pub fn place(&self, dof: usize) -> String {
        let chain = self.chains.iter().find(|m| m.entries.contains(&dof));
        match chain {
            Some(member) => {
                let place = member.chain.name(dof - member.entries.start);
                match &member.name {
                    Some(name) => format!("{place}, in chain `{name}`"),
                    None => place,
                }
            }
            None => self.bodies.name(dof),
        }
    }
}
