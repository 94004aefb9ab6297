//! What a drive says of itself that hardly any machine is: one table of rules, each with its limit and where that is from.
//!
//! Nothing is refused for it. `check`, `describe` and the page of a run tell it, for a slip of units gives numbers that look like a result.

use std::f64::consts::{PI, TAU};
use std::fmt;

use chaindrive_contact::Friction;
use chaindrive_geometry::{Point, Route, Wheel};
use chaindrive_mechanics::{Adjust, Drive, Layout, PlacedChain, Rotation, Stop, Surface};

use crate::figure::figure;

/// Modulus of elasticity \[Pa\] and density \[kg/m³\] of steel.
const STEEL: [f64; 2] = [206e9, 7850.0];
/// Width of the thinnest rim in pitches, along the shaft and across, and its density \[kg/m³\]. *Assumed*: plastics are denser, and wheels wider.
const RIM: [f64; 2] = [0.1, 1000.0];
/// Thickness of all plates of a link side by side in pitches. *Assumed*: six of a quarter of a pitch, those of three strands.
const PLATES: f64 = 1.5;
/// Length of a contact in pitches. *Assumed*: no roller is as long.
const CONTACT: f64 = 10.0;
/// Depth at which contacts are asked for their stiffness \[m\].
const PRESSED: f64 = 1e-6;
/// Slip at which friction is asked for its coefficient \[m/s\].
const SLIPS: [f64; 4] = [1e-3, 1e-2, 0.1, 1.0];

/// A drive, and how long its run is foretold to take \[s\], where that is known.
#[derive(Clone, Copy, Debug)]
struct Subject<'a> {
    drive: &'a Drive,
    run_time: Option<f64>,
}

/// Values of a rule, each with the name of what it belongs to; empty where there is one only.
type Values = Vec<(String, f64)>;

/// A rule: what is looked at, between which limits it is plausible, and why.
#[derive(Clone, Copy, Debug)]
pub struct PlausibilityRule {
    /// Name.
    pub name: &'static str,
    /// What is looked at, in words.
    pub label: &'static str,
    /// Unit of value and limits, as they are printed.
    pub unit: &'static str,
    /// Least and greatest plausible value; infinite where there is none.
    pub limits: [f64; 2],
    /// Source of the limits, or that they are assumed.
    pub source: &'static str,
    values: fn(Subject<'_>) -> Values,
}

/// All rules.
pub const PLAUSIBILITY_RULES: &[PlausibilityRule] = &[
    PlausibilityRule {
        name: "wave-speed",
        label: "speed of longitudinal waves in the chain, p √(k/m)",
        unit: "m/s",
        limits: [0.0, 5120.0],
        source: "√(E/ρ) of a rod of steel, 206 GPa and 7850 kg/m³: see mass and stiffness of a link",
        values: wave_speeds,
    },
    PlausibilityRule {
        name: "link-stiffness",
        label: "stiffness of a link over that of the thickest steel plates of its height",
        unit: "",
        limits: [0.0, 1.0],
        source: "k = E A/p, E = 206 GPa, A = 1.5 p h: assumed, six plates of a quarter of a pitch",
        values: link_stiffness,
    },
    PlausibilityRule {
        name: "damping-ratio",
        label: "damping ratio of a link, c/2√(k m)",
        unit: "",
        limits: [0.0, 1.0],
        source: "beyond 1 a link creeps back instead of swinging: assumed, chains have some per cent",
        values: damping_ratios,
    },
    PlausibilityRule {
        name: "plate-height",
        label: "height of the link plates over the pitch",
        unit: "",
        limits: [0.5, 1.2],
        source: "0.78 to 0.95 in ISO 606: assumed with room for other chains",
        values: plate_heights,
    },
    PlausibilityRule {
        name: "contact-stiffness",
        label: "stiffness of a contact over that of steel of ten pitches in length",
        unit: "",
        limits: [0.0, 1.0],
        source: "k = E L, E = 206 GPa, L = 10 p: assumed, rollers are shorter",
        values: contact_stiffness,
    },
    PlausibilityRule {
        name: "friction",
        label: "coefficient of friction",
        unit: "",
        limits: [0.0, 1.5],
        source: "assumed: dry steel on steel has 0.8, rubber on road 1.2",
        values: coefficients,
    },
    PlausibilityRule {
        name: "inertia",
        label: "moment of inertia of a shaft and its sprockets over that of the thinnest rims of their size",
        unit: "",
        limits: [1.0, f64::INFINITY],
        source: "2π ρ a² R³, a = 0.1 p, ρ = 1000 kg/m³: assumed, every wheel is heavier",
        values: inertias,
    },
    PlausibilityRule {
        name: "gravity",
        label: "gravity along y, which points upward",
        unit: "m/s²",
        limits: [f64::NEG_INFINITY, 0.0],
        source: "assumed: pictures have y upward",
        values: gravity,
    },
    PlausibilityRule {
        name: "viscosity",
        label: "dynamic viscosity of the oil",
        unit: "Pa s",
        limits: [3e-4, 100.0],
        source: "assumed: petrol has 5e-4, VG 1500 in the cold some 50",
        values: viscosities,
    },
    PlausibilityRule {
        name: "guide-distance",
        label: "distance of a guide from the route",
        unit: "pitches",
        limits: [0.0, 10.0],
        source: "assumed: no chain swings as far, so that it never touches",
        values: guide_distances,
    },
    PlausibilityRule {
        name: "run-time",
        label: "time that the run is foretold to take",
        unit: "h",
        limits: [0.0, 1.0],
        source: "assumed: see steps and stiffness first, or shorten `run.until`",
        values: run_times,
    },
];

/// A value outside the limits of a rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Implausible {
    /// Name of the rule.
    pub rule: &'static str,
    /// The whole note.
    told: String,
}

impl fmt::Display for Implausible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.told)
    }
}

/// Everything about a drive that is hardly plausible; `run_time`: how long its run is foretold to take \[s\], where that is known.
pub fn implausible(drive: &Drive, run_time: Option<f64>) -> Vec<Implausible> {
    let subject = Subject { drive, run_time };
    let notes = PLAUSIBILITY_RULES.iter().flat_map(|rule| {
        let values = (rule.values)(subject).into_iter();
        values.filter_map(|(of, value)| rule.note(&of, value))
    });
    notes.collect()
}

impl PlausibilityRule {
    /// What is said of a value outside the limits.
    fn note(&self, of: &str, value: f64) -> Option<Implausible> {
        let [least, greatest] = self.limits;
        let (side, limit) = if value < least {
            ("below", least)
        } else if value > greatest {
            ("above", greatest)
        } else {
            return None;
        };
        let of = if of.is_empty() {
            String::new()
        } else {
            format!(" ({of})")
        };
        let unit = if self.unit.is_empty() {
            String::new()
        } else {
            format!(" {}", self.unit)
        };
        Some(Implausible {
            rule: self.name,
            told: format!(
                "{}{of}: {}{unit} is {side} {} ({})",
                self.label,
                figure(value),
                figure(limit),
                self.source
            ),
        })
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// A value of every chain; none where it has none.
fn of_chains(
    Subject { drive, .. }: Subject<'_>,
    value: impl Fn(&PlacedChain) -> Option<f64>,
) -> Values {
    let chains = drive.chains.iter();
    let named = chains.filter_map(|placed| {
        let name = placed.name.clone().unwrap_or_default();
        Some((name, value(placed)?))
    });
    named.collect()
}

/// Links that are springs: those of rigid ones serve to lay them.
fn springs(placed: &PlacedChain) -> Option<&PlacedChain> {
    placed.chain.model.has_springs().then_some(placed)
}

fn wave_speeds(subject: Subject<'_>) -> Values {
    of_chains(subject, |placed| {
        let chain = &springs(placed)?.chain;
        // c = p √(k/m)
        Some(chain.pitch * (mean(&chain.stiffness) / mean(&chain.masses)).sqrt())
    })
}

fn link_stiffness(subject: Subject<'_>) -> Values {
    of_chains(subject, |placed| {
        let chain = &springs(placed)?.chain;
        // k/(E A/p), A = 1.5 p h
        Some(mean(&chain.stiffness) / (STEEL[0] * PLATES * chain.plate_height))
    })
}

fn damping_ratios(subject: Subject<'_>) -> Values {
    of_chains(subject, |placed| {
        let chain = &springs(placed)?.chain;
        // ζ = c/2√(k m)
        let critical = 2.0 * (mean(&chain.stiffness) * mean(&chain.masses)).sqrt();
        Some(mean(&chain.damping) / critical)
    })
}

fn plate_heights(subject: Subject<'_>) -> Values {
    of_chains(subject, |placed| {
        Some(placed.chain.plate_height / placed.chain.pitch)
    })
}

/// All surfaces, each with the pitch of the chain that it meets.
fn surfaces(drive: &Drive) -> Vec<(String, &Surface, f64)> {
    let mut found = Vec::new();
    for placed in &drive.chains {
        let (model, pitch) = (&placed.chain.model, placed.chain.pitch);
        let teeth = placed
            .sprockets
            .iter()
            .map(|index| &drive.sprockets[*index]);
        found.extend(teeth.map(|it| (it.name.clone(), &it.surface, pitch)));
        let guides = placed.guides.iter().map(|index| &drive.guides[*index]);
        found.extend(guides.map(|it| (it.name.clone(), &it.surface, pitch)));
        let joints = model.clearance().map(|it| ("pins", &it.surface));
        let rollers = model.free_roller().map(|it| ("rollers", &it.surface));
        let own = joints.into_iter().chain(rollers);
        found.extend(own.map(|(name, surface)| (name.to_owned(), surface, pitch)));
    }
    found
}

fn contact_stiffness(Subject { drive, .. }: Subject<'_>) -> Values {
    let all = surfaces(drive).into_iter();
    // k/(E L), L = 10 p
    all.map(|(name, surface, pitch)| {
        let stiffness = surface.law.stiffness(PRESSED);
        (name, stiffness / (STEEL[0] * CONTACT * pitch))
    })
    .collect()
}

fn coefficients(Subject { drive, .. }: Subject<'_>) -> Values {
    let coefficient = |friction: &Friction| {
        let forces = SLIPS.iter().map(|slip| friction.force(1.0, *slip).abs());
        forces.fold(0.0, f64::max)
    };
    let all = surfaces(drive).into_iter();
    let mut found: Values = all
        .map(|(name, surface, _)| (name, coefficient(&surface.friction)))
        .collect();
    for placed in &drive.chains {
        let resisting = placed.chain.articulation.as_ref();
        found.extend(resisting.map(|it| ("pins".to_owned(), coefficient(&it.friction))));
    }
    found
}

fn inertias(Subject { drive, .. }: Subject<'_>) -> Values {
    let free = drive.shafts.iter().enumerate().filter(|(index, shaft)| {
        let geared = drive.gears.iter().any(|it| it.shafts.contains(index));
        !geared && matches!(shaft.rotation, Rotation::Free { .. })
    });
    let found = free.filter_map(|(index, shaft)| {
        let own = || drive.sprockets.iter().filter(|it| it.shaft == index);
        // J = 2π ρ a² R³
        let rim = |radius: f64, teeth: u32| {
            let pitch = 2.0 * radius * (PI / f64::from(teeth)).sin();
            TAU * RIM[1] * (RIM[0] * pitch).powi(2) * radius.powi(3)
        };
        let least: f64 = own().map(|it| rim(it.gap.pitch_radius, it.gap.teeth)).sum();
        let inertia = shaft.inertia + own().map(|it| it.inertia).sum::<f64>();
        let name = shaft.name.clone();
        let name = name.or_else(|| own().next().map(|it| it.name.clone()));
        (least > 0.0).then(|| (name.unwrap_or_default(), inertia / least))
    });
    found.collect()
}

fn gravity(Subject { drive, .. }: Subject<'_>) -> Values {
    vec![(String::new(), drive.gravity.y)]
}

fn viscosities(Subject { drive, .. }: Subject<'_>) -> Values {
    let oil = drive.oil.as_ref();
    let oil = oil.map(|it| ("lubricant".to_owned(), it.lubricant.dynamic_viscosity()));
    let films = surfaces(drive)
        .into_iter()
        .filter_map(|(name, surface, _)| Some((name, surface.film?.viscosity)));
    oil.into_iter().chain(films).collect()
}

fn guide_distances(Subject { drive, .. }: Subject<'_>) -> Values {
    let mut found = Vec::new();
    for (index, placed) in drive.chains.iter().enumerate() {
        let Layout::Route { stops, fit, .. } = &placed.layout else {
            continue;
        };
        let wheels = drive.wheels(index, &Adjust::Nothing, 0.0).ok().flatten();
        let Some(wheels) = wheels else {
            continue;
        };
        let Ok(route) = Route::taut(&wheels) else {
            continue;
        };
        for guide in &placed.guides {
            if stops.contains(&Stop::Guide(*guide)) {
                continue;
            }
            let guide = &drive.guides[*guide];
            let pieces = guide.face.pieces().iter();
            let places = pieces.flat_map(|piece| [0.0, 0.5, 1.0].map(|at| piece.point(at)));
            let distances = places.map(|place| distance(place, &wheels, &route));
            let nearest = distances.fold(f64::INFINITY, f64::min) - fit.sag.unwrap_or(0.0);
            found.push((guide.name.clone(), nearest / placed.chain.pitch));
        }
    }
    found
}

/// Distance of a place from a taut route \[m\].
fn distance(place: Point, wheels: &[Wheel], route: &Route) -> f64 {
    let around = wheels.iter();
    let around = around.map(|wheel| ((place - wheel.centre).norm() - wheel.radius).abs());
    let spans = route.spans.iter().map(|span| {
        let chord = span.arrives - span.leaves;
        let share = (place - span.leaves).dot(&chord) / chord.norm_squared();
        (span.leaves + chord * share.clamp(0.0, 1.0) - place).norm()
    });
    around.chain(spans).fold(f64::INFINITY, f64::min)
}

fn run_times(Subject { run_time, .. }: Subject<'_>) -> Values {
    let known = run_time.filter(|it| it.is_finite()).into_iter();
    known.map(|it| (String::new(), it / 3600.0)).collect()
}
