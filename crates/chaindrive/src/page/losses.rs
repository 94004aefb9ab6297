//! Losses by place, balance of powers, efficiency.

use chaindrive_mechanics::{Place, engagement_wave, warming};

use super::Section;
use super::sections::PageContent;
use crate::figure::{Measure, figure};

impl PageContent<'_> {
    pub(super) fn losses(&self) -> Section {
        let mut section = Section::new("losses", "place\tpower [W]\tshare [%]");
        let balance = self.summary.balance();
        if let Some(balance) = balance.filter(|it| !it.losses.is_empty() && it.time > 0.0) {
            let all = balance.lost();
            let places = balance.losses.iter();
            let names = places.map(|(place, lost)| (place.name(), *lost));
            for (place, lost) in names.chain(std::iter::once(("all", all))) {
                let share = format!("{:.1}", 100.0 * lost / all);
                let power = figure(lost / balance.time);
                section.rows.push(vec![place.to_owned(), power, share]);
            }
        }
        section.sentences.extend(self.waves());
        section.sentences.extend(self.balance());
        section.sentences.extend(self.forces());
        section.sentences.push(self.efficiency());
        section.sentences.extend(self.warmth());
        section
    }

    /// Power that comes in, goes out and is lost, over whole periods of the slowest forcing where there is one.
    fn balance(&self) -> Option<String> {
        let balance = self.summary.balance()?;
        if !(balance.time > 0.0 && balance.supplied > 0.0) {
            return None;
        }
        let told = |energy: f64| Measure::Power.told(energy / balance.time);
        let kept = balance.kept();
        let way = if kept < 0.0 {
            "came out of"
        } else {
            "went into"
        };
        let over = if balance.is_whole {
            "Over whole periods of the slowest forcing"
        } else {
            "Over the record, which is no whole period"
        };
        Some(format!(
            "{over}: put in {}, taken out {}, lost {}; {} {way} motion, height and springs, with what is unaccounted for.",
            told(balance.supplied),
            told(balance.delivered),
            told(balance.lost()),
            told(kept.abs())
        ))
    }

    /// Power of forces from outside by the bodies that they move; none where nothing of the kind works.
    fn forces(&self) -> Option<String> {
        let sprockets = self.bodies.sprockets.iter();
        let sprockets = sprockets.map(|it| (&it.name, it.forced));
        let tensioners = self.bodies.tensioners.iter();
        let all = sprockets.chain(tensioners.map(|it| (&it.name, it.forced)));
        let working = all.filter(|(_, power)| *power != 0.0);
        let told = working.map(|(name, power)| format!("{name} {}", Measure::Power.told(power)));
        let told: Vec<String> = told.collect();
        (!told.is_empty()).then(|| {
            format!(
                "Forces from outside put in, in the mean: {}.",
                told.join(", ")
            )
        })
    }

    /// The efficiency, or the reason why there is none.
    fn efficiency(&self) -> String {
        let ledger = self.summary.ledger();
        if let Some([efficiency, uncertain]) = ledger.efficiency() {
            let swings = if ledger.supplied_back > 0.0 {
                " and what goes to and fro"
            } else {
                ""
            };
            return format!(
                "Efficiency, 1 less the share that is lost: {:.1} % ± {:.1} % numerical, by the energy unaccounted for{swings}; friction is as uncertain as its coefficient.",
                100.0 * efficiency,
                100.0 * uncertain
            );
        }
        let why = ledger.unknown().unwrap_or_default();
        format!("Efficiency: none, {why}.")
    }

    /// What engagement sends into the spans as waves, most of which joints lose beside what wrapping costs them.
    fn waves(&self) -> Option<String> {
        let system = self.simulation.system();
        let drive = &self.simulation.assembled().drive;
        let ends = system.span_sprockets();
        let of_span = |(index, ends): (usize, &[usize; 2])| {
            let tension = self.summary.spans[index].mean();
            let sprockets = &self.bodies.sprockets;
            let chain = sprockets.get(ends[0])?.chain;
            let placed = &drive.chains[chain].chain;
            let mass = placed.masses.iter().sum::<f64>() / placed.masses.len() as f64;
            let speed = self.chain_speed(chain)?;
            let waves = ends.iter().map(|end| {
                engagement_wave(sprockets[*end].teeth, tension, mass / placed.pitch, speed)
            });
            tension.is_finite().then(|| waves.sum::<f64>())
        };
        let waves: f64 = ends.iter().enumerate().filter_map(of_span).sum();
        (waves > 0.0).then(|| {
            format!(
                "Engagement sends waves of some {} into the spans; joints lose most of it beside what wrapping costs them.",
                Measure::Power.told(waves)
            )
        })
    }

    /// By how much the only chain becomes warmer than the air around it; what is lost is not told apart by chains.
    fn warmth(&self) -> Option<String> {
        let drive = &self.simulation.assembled().drive;
        let [placed] = &drive.chains[..] else {
            return None;
        };
        // Oil carries more heat away than the air that is reckoned with.
        if drive.oil.is_some() {
            return None;
        }
        let inside = [Place::Joints, Place::Rollers, Place::Seals, Place::Offset];
        let balance = self.summary.balance()?;
        let lost = balance.losses.iter();
        let lost: f64 = lost
            .filter(|(place, _)| inside.contains(place))
            .map(|(_, lost)| lost)
            .sum();
        let power = lost / balance.time;
        let [from, to] = warming(&placed.chain, power, self.chain_speed(0)?)?;
        (power > 0.0).then(|| {
            format!(
                "What joints lose warms the chain, dry in air, by {} to {} K in the long run.",
                figure(from),
                figure(to)
            )
        })
    }
}
