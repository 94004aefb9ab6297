//! The sections of the page.

use super::{Section, error_by_step};
use std::f64::consts::TAU;

use chaindrive_mechanics::Extremes;

use crate::chain_verdict::CheckOutcome;
use crate::describe::left_out;
use crate::figure::{Measure, Scale, duration, figure, percent};
use crate::plausibility::implausible;
use crate::precision::Judgement;
use crate::rating::{Load, Rating, told_hours};
use crate::summary::{Bodies, ForceRecord, SprocketStatistics, Steadiness, Summary};
use crate::{RunInReport, Simulation, Verdict};

/// Share of the greatest power of its chain below which a sprocket idles. *Assumed*: bearings and teeth of an idler take less.
const IDLES: f64 = 0.02;
/// Share of a power by which the product of mean torque and mean speed differs where that is told. *Assumed*: what a reader would ask about.
const SWINGS: f64 = 0.01;
/// Inputs that are named before the rest is counted. *Assumed*: two lines of a terminal.
const NAMED: usize = 6;

/// Keys of inputs that decide most of a result: how things rub, strike and yield. They are named first. *Assumed*.
const DECIDE: [&str; 7] = [
    "coefficient",
    "restitution",
    "damping_ratio",
    "damping",
    "stiffness",
    "clearance",
    "modulus",
];

/// Share of the greatest pull of a link below which a link that is pressed is rounding. *Assumed*.
const ROUNDING: f64 = 1e-6;

/// A run as the page tells it.
pub(super) struct PageContent<'a> {
    pub(super) verdict: &'a Verdict,
    pub(super) summary: &'a Summary,
    pub(super) bodies: Bodies,
    pub(super) simulation: &'a Simulation,
    pub(super) ran_in: Option<&'a RunInReport>,
    pub(super) judgement: Option<&'a Judgement>,
    pub(super) assumed: &'a [String],
}

impl PageContent<'_> {
    pub(super) fn sections(&self) -> Vec<Section> {
        vec![
            self.verdict(),
            self.chain_verdict(),
            self.record(),
            self.drive(),
            self.spans(),
            self.links(),
            self.bearings(),
            self.impacts(),
            self.tensioners(),
            self.irregularity(),
            self.losses(),
            self.utilisation(),
            self.inputs(),
            self.next_steps(),
        ]
    }

    fn verdict(&self) -> Section {
        let title = format!("verdict: {}", self.verdict.trust.name());
        let mut section = Section::new(&title, "");
        section.sentences = self.verdict.sentences();
        section
    }

    /// What the chains are held against, the worst first.
    fn chain_verdict(&self) -> Section {
        let chains = &self.verdict.chains;
        let title = format!("verdict on the chain: {}", chains.outcome().name());
        let mut section = Section::new(&title, "limit\tvalue\tbounds\tunit\toutcome");
        for check in &chains.checks {
            let of = after(" of ", &check.of);
            section.rows.push(vec![
                format!("{}{of}", check.limit.name()),
                check.told_value(),
                check.told_bounds(),
                check.limit.unit().to_owned(),
                check.outcome.name().to_owned(),
            ]);
        }
        let worst = chains
            .reasons()
            .map(|it| format!("{it}. Limit: {}", it.limit.source()));
        let unjudged = chains
            .checks
            .iter()
            .filter(|it| it.outcome == CheckOutcome::NotJudged);
        let sentence = |words: String| words[..1].to_uppercase() + &words[1..] + ".";
        section.sentences.extend(worst.map(sentence));
        section
            .sentences
            .extend(unjudged.map(|it| sentence(it.to_string())));
        section
    }

    /// Length of the record, and the run-in before it.
    fn record(&self) -> Section {
        let mut section = Section::new("record", "");
        let time = self.summary.duration();
        if time > 0.0 {
            let samples = self.summary.samples;
            let time = Measure::Time.told(time);
            let told = format!("{time}, {samples} samples.");
            section.sentences.push(told);
        }
        section
            .sentences
            .extend(self.ran_in.map(RunInReport::to_string));
        let known = self.summary.steadiness();
        if known.iter().flatten().next().is_some() {
            let is_known = |it: &&Steadiness| it.mean.half_width.is_finite();
            let sentence = if !known.iter().flatten().all(|it| it.is_steady) {
                "The tensions are not steady throughout the record."
            } else if known.iter().flatten().all(|it| is_known(&it)) {
                "The tensions are steady throughout the record."
            } else {
                "Nobody can tell from this record whether the tensions are steady."
            };
            section.sentences.push(sentence.to_owned());
        }
        section
    }

    /// Power, torque, speed and ratio of every sprocket; which sides are tight.
    fn drive(&self) -> Section {
        let sprockets = &self.bodies.sprockets;
        let turning = Measure::Turning.scale(sprockets.iter().map(|it| it.speed));
        let torques = Measure::Torque.scale(sprockets.iter().map(|it| it.torque));
        let powers = Measure::Power.scale(sprockets.iter().map(|it| it.power));
        let [speed, torque, power] = [turning, torques, powers].map(|it| it.unit);
        let columns = format!(
            "sprocket\trole\tteeth\tspeed [{speed}]\ttorque [{torque}]\tpower [{power}]\tratio"
        );
        let mut section = Section::new("what the drive does", &columns);
        for it in sprockets {
            let leader = &sprockets[it.leader()];
            let ratio = it.speed / leader.speed;
            section.rows.push(vec![
                it.name.clone(),
                self.role(it).to_owned(),
                it.teeth.to_string(),
                turning.cell(it.speed),
                torques.cell(it.torque.abs()),
                powers.cell(it.power.abs()),
                figure(ratio),
            ]);
        }
        let swings = |it: &&SprocketStatistics| {
            (it.power - it.torque * it.speed).abs() > SWINGS * it.power.abs()
        };
        if sprockets
            .iter()
            .filter(swings)
            .any(|it| self.role(it) != "idles")
        {
            section.sentences.push(
                "Power is the mean of torque times speed, which swing together: it is not the product of their means."
                    .to_owned(),
            );
        }
        section.sentences.extend(self.chain_speeds());
        let speeds: Vec<f64> = sprockets.iter().map(|it| it.speed).collect();
        let against = self.simulation.assembled().drive.against_routes(&speeds);
        let against = against.iter().map(ToString::to_string);
        section.sentences.extend(against);
        for (chain, spans) in self.chains() {
            let mean = |index: &usize| self.summary.spans[*index].mean();
            let held = spans.filter(|index| mean(index).is_finite());
            let mut held: Vec<usize> = held.collect();
            held.sort_by(|a, b| mean(b).total_cmp(&mean(a)));
            let (Some(tight), Some(slack)) = (held.first(), held.last()) else {
                continue;
            };
            if tight == slack {
                continue;
            }
            let [tight, slack] = [tight, slack].map(|index| {
                let tension = Measure::Force.told(mean(index));
                format!("{}, {tension}", self.summary.spans[*index].name)
            });
            let of = after(" of ", &chain);
            let sentence = format!("Tight side{of}: {tight}. Slack side: {slack}.");
            section.sentences.push(sentence);
        }
        section
    }

    /// Mean speed of a chain \[m/s\], where it passes a sprocket.
    pub(super) fn chain_speed(&self, index: usize) -> Option<f64> {
        let sprockets = &self.bodies.sprockets;
        let first = sprockets.iter().find(|it| it.chain == index)?;
        let pitch = self.simulation.assembled().drive.chains[index].chain.pitch;
        // v = z p ω/2π
        Some(f64::from(first.teeth) * pitch * first.speed.abs() / TAU)
    }

    /// Links, pitch and speed of every chain.
    fn chain_speeds(&self) -> Vec<String> {
        let drive = &self.simulation.assembled().drive;
        let told = |(index, placed): (usize, &chaindrive_mechanics::PlacedChain)| {
            let speed = self.chain_speed(index)?;
            let pitch = placed.chain.pitch;
            let name = placed.name.as_ref().map(|it| format!(" {it}"));
            Some(format!(
                "Chain{}: {} links of {} at {}.",
                name.unwrap_or_default(),
                placed.chain.links(),
                Measure::Length.told_with(pitch, 6),
                Measure::Speed.told(speed)
            ))
        };
        drive.chains.iter().enumerate().filter_map(told).collect()
    }

    /// Part of a sprocket in its chain: it drives, is driven or idles.
    fn role(&self, sprocket: &SprocketStatistics) -> &'static str {
        let sprockets = self.bodies.sprockets.iter();
        let own = sprockets.filter(|it| it.chain == sprocket.chain);
        let greatest = own.map(|it| it.power.abs()).fold(0.0, f64::max);
        let power = sprocket.power;
        if power.abs() <= IDLES * greatest {
            "idles"
        } else if power < 0.0 {
            "drives"
        } else {
            "is driven"
        }
    }

    /// Names of the chains, empty where there is one, and the indices of their spans.
    fn chains(&self) -> Vec<(String, std::ops::Range<usize>)> {
        let mut first = 0;
        let sizes = self.simulation.system().chain_sizes();
        let alone = sizes.len() == 1;
        let chain = |(name, size): (String, chaindrive_mechanics::ChainSize)| {
            let spans = first..first + size.spans;
            first = spans.end;
            (if alone { String::new() } else { name }, spans)
        };
        sizes.into_iter().map(chain).collect()
    }

    /// Tensions of the spans, with intervals.
    fn spans(&self) -> Section {
        let spans = &self.summary.spans;
        let extremes = self.summary.span_extremes();
        let scale = Measure::Force.scale(extremes.iter().flat_map(|it| [it.least, it.greatest]));
        let columns = "mean\t± 95 %\tstd\t± 95 %\tp1\t± 95 %\tp99\t± 95 %\tleast\tgreatest";
        let columns = format!("span tension [{}]\t{columns}", scale.unit);
        let mut section = Section::new("span tensions", &columns);
        let known = spans.iter().zip(self.summary.steadiness());
        for ((span, known), extremes) in known.zip(extremes) {
            let Some(known) = known else {
                let sentence = format!("No roller ever holds span {}.", span.name);
                section.sentences.push(sentence);
                continue;
            };
            let mut row = vec![span.name.clone()];
            for it in [known.mean, known.deviation, known.p1, known.p99] {
                row.extend([scale.cell(it.value), half_width(&scale, it.half_width)]);
            }
            row.extend([extremes.least, extremes.greatest].map(|it| scale.cell(it)));
            section.rows.push(row);
            if span.missing > 0 {
                let share = span.missing as f64 / span.readings as f64;
                section.sentences.push(format!(
                    "No roller holds span {} in {} of the time.",
                    span.name,
                    percent(share)
                ));
            }
        }
        if !section.rows.is_empty() {
            let errors = error_by_step::of_tensions(self.judgement);
            section.sentences.push(errors);
        }
        if let Some(until) = self.summary.known_from() {
            let period = duration(self.summary.slowest_forcing());
            let until = duration(until);
            section.sentences.push(format!(
                "Intervals are unknown below three periods of {period}, the slowest forcing. Take --until \"{until}\"."
            ));
        } else if self.summary.steadiness().iter().flatten().any(is_blank) {
            let until = duration(2.0 * self.summary.duration());
            section.sentences.push(format!(
                "The record has too few periods for some intervals of p1 and p99. Take --until \"{until}\"."
            ));
        }
        section
    }

    /// Maximum link tension, against what breaks a link.
    fn links(&self) -> Section {
        let mut section = Section::new("maximum link tension", "");
        let loads = self.summary.carried().into_iter();
        let loads = loads.filter(|it| it.tension.greatest.is_finite());
        section.sentences.extend(loads.map(|it| strength(&it)));
        section
    }

    fn bearings(&self) -> Section {
        let bodies = &self.bodies;
        let sprockets = bodies.sprockets.iter().map(|it| (&it.name, &it.force));
        let guides = bodies.guides.iter().map(|(name, force)| (name, force));
        let all: Vec<(String, &ForceRecord)> = sprockets
            .map(|(name, force)| (name.clone(), force))
            .chain(guides.map(|(name, force)| (format!("guide {name}"), force)))
            .collect();
        let scale = Measure::Force.scale(all.iter().map(|(_, it)| it.extremes.greatest));
        let unit = scale.unit;
        let greatest =
            format!("greatest [{unit}]\tat [s]\tgreatest of a period, median [{unit}]\t± 95 %");
        let columns = format!("on\tmean [{unit}]\tdirection from x [deg]\t{greatest}");
        let mut section = Section::new("shaft loads and guide forces", &columns);
        for (name, force) in all {
            let [mean, direction] = force.mean_polar();
            let direction = if mean > 0.0 {
                format!("{:.1}", direction.to_degrees())
            } else {
                "–".to_owned()
            };
            let [mean, greatest] = [mean, force.extremes.greatest].map(|it| scale.cell(it));
            let at = if force.extremes.greatest > 0.0 {
                figure(force.extremes.greatest_at)
            } else {
                "–".to_owned()
            };
            let usual = force.usual_greatest;
            let usual = usual.map_or(["–".to_owned(), "–".to_owned()], |it| {
                [scale.cell(it.value), half_width(&scale, it.half_width)]
            });
            let row = [name, mean, direction, greatest, at].into_iter();
            section.rows.push(row.chain(usual).collect());
        }
        section
    }

    fn impacts(&self) -> Section {
        let struck = self.summary.impacts().iter().filter(|it| it.count > 0);
        let struck: Vec<_> = struck.collect();
        let scale = Measure::Force.scale(struck.iter().map(|it| it.greatest));
        let impulses = Measure::Impulse.scale(struck.iter().map(|it| it.impulse(0.5)));
        let estimate = self.judgement.and_then(Judgement::estimate);
        let by_step = estimate.map_or("", |_| "\t± step [%]");
        let (unit, impulse) = (scale.unit, impulses.unit);
        let half = format!("on\tnumber\tmedian [{unit}]{by_step}");
        let most = format!("p99 [{unit}]{by_step}\tgreatest [{unit}]");
        let columns = format!("{half}\t{most}\timpulse [{impulse}]\tclosing [m/s]");
        let mut section = Section::new("impacts of rollers that seat", &columns);
        for it in struck {
            let errors = estimate.map(|all| error_by_step::of_impacts(all, &it.sprocket));
            let half = errors.map(|it| error_by_step::cell(it.map(|it| it.p50)));
            let most = errors.map(|it| error_by_step::cell(it.map(|it| it.p99)));
            let mut row = vec![it.sprocket.clone(), it.count.to_string()];
            row.push(scale.cell(it.force(0.5)));
            row.extend(half);
            row.push(scale.cell(it.p99()));
            row.extend(most);
            row.push(scale.cell(it.greatest));
            row.push(impulses.cell(it.impulse(0.5)));
            row.push(format!("{:.3}", it.speed(0.5)));
            section.rows.push(row);
        }
        if !section.rows.is_empty() {
            let impulses = estimate.and_then(error_by_step::of_impulses);
            section.sentences.extend(impulses);
            section.sentences.push(
                "The greatest is one blow of this record: a longer one, and another step, find others, some greater by a quarter."
                    .to_owned(),
            );
        }
        section
    }

    fn tensioners(&self) -> Section {
        let columns = "tensioner\tunit\tmean\tleast\tgreatest\ttravel";
        let mut section = Section::new("tensioners", columns);
        for it in &self.bodies.tensioners {
            let travel = &it.travel;
            let quantity = if it.unit == "rad" {
                Measure::Angle
            } else {
                Measure::Length
            };
            let scale = quantity.scale([travel.least, travel.greatest]);
            let values = [it.mean, travel.least, travel.greatest, travel.range()];
            let mut row = vec![it.name.clone(), scale.unit.to_owned()];
            row.extend(values.map(|it| figure(it / scale.per)));
            section.rows.push(row);
        }
        section
    }

    /// Swing of the speeds, and transmission error.
    fn irregularity(&self) -> Section {
        let columns =
            "sprocket\tspeed, greatest less least [%]\ttransmission error, peak to peak [deg]";
        let mut section = Section::new("speed irregularity and transmission error", columns);
        for (index, it) in self.bodies.sprockets.iter().enumerate() {
            let Some(irregularity) = it.irregularity() else {
                continue;
            };
            let lag = if it.leader() == index {
                "–".to_owned()
            } else {
                figure(it.lag.range().to_degrees())
            };
            let irregularity = figure(100.0 * irregularity);
            section.rows.push(vec![it.name.clone(), irregularity, lag]);
        }
        section
    }

    /// Power of the chains against their rating.
    fn utilisation(&self) -> Section {
        let mut section = Section::new("utilisation", "");
        for rating in self.summary.ratings() {
            section.sentences.extend(rated(&rating));
        }
        section
    }

    fn inputs(&self) -> Section {
        let mut section = Section::new("assumed inputs", "");
        let drive = &self.simulation.assembled().drive;
        let left_out = left_out(drive);
        let left_out = (!left_out.is_empty())
            .then(|| format!("The model leaves out {}.", left_out.join(", ")));
        let notes = implausible(drive, None).into_iter();
        let notes = notes.map(|it| format!("Hardly plausible: {it}."));
        let left_out: Vec<String> = left_out.into_iter().chain(notes).collect();
        let assumed = self.assumed;
        if assumed.is_empty() {
            section.sentences.extend(left_out);
            return section;
        }
        let decides = |it: &&String| {
            let path = it.split(" = ").next().unwrap_or_default();
            DECIDE.iter().any(|key| path.ends_with(key))
        };
        let (first, other): (Vec<_>, Vec<_>) = assumed.iter().partition(decides);
        let named: Vec<&str> = first.iter().chain(&other).map(|it| it.as_str()).collect();
        let named = &named[..named.len().min(NAMED)];
        let rest = match assumed.len().saturating_sub(NAMED) {
            0 => String::new(),
            rest => format!(", and {rest} more"),
        };
        section.sentences = vec![
            format!("Assumed: {}{rest}.", named.join(", ")),
            "`chaindrive resolve` lists all inputs with their sources.".to_owned(),
        ];
        section.sentences.extend(left_out);
        section
    }
}

/// Words before a text; nothing where it is empty.
pub(super) fn after(words: &str, text: &str) -> String {
    if text.is_empty() {
        String::new()
    } else {
        format!("{words}{text}")
    }
}

/// Unknown intervals of quantiles: one or more.
fn is_blank(of: &Steadiness) -> bool {
    of.p1.half_width.is_nan() || of.p99.half_width.is_nan()
}

/// A half width, where it is known.
fn half_width(scale: &Scale, value: f64) -> String {
    if value.is_nan() {
        "unknown".to_owned()
    } else {
        scale.small(value)
    }
}

/// Maximum link tension of a chain, and its static safety factor.
fn strength(load: &Load) -> String {
    let of = after(" of ", &load.chain);
    let Extremes {
        least,
        greatest,
        greatest_at,
        ..
    } = load.tension;
    let pull = Measure::Force.told(greatest);
    let breaks = match load.strength.breaking_load {
        Some(breaking) => format!(
            "Static safety factor: {}, against the breaking load of {}",
            figure(breaking / greatest),
            Measure::Force.told(breaking)
        ),
        None => {
            "Static safety factor: not judged, no breaking load is known: give chain.breaking_load"
                .to_owned()
        }
    };
    let pressed = if load.pressed > 0.0 && -least > ROUNDING * greatest {
        format!(
            " Links are pressed by up to {}, in {} of links and time.",
            Measure::Force.told(-least),
            percent(load.pressed)
        )
    } else {
        String::new()
    };
    let at = duration(greatest_at);
    format!("Maximum link tension{of}, of any link: {pull} at {at}. {breaks}.{pressed}")
}

/// Power of a chain against its rating, or why there is none, and the lubrication that its speed asks for.
fn rated(rating: &Rating) -> Vec<String> {
    let Some(sprocket) = &rating.sprocket else {
        return Vec::new();
    };
    let of = after(" ", &rating.chain);
    let carried = Measure::Power.told(rating.carried);
    let power = match (&rating.limits, rating.governing()) {
        (Ok(limits), Some((by, power))) => {
            let others = limits.iter().filter(|it| it.by != by);
            let others: Vec<String> = others
                .map(|it| match it.power {
                    Some(power) => format!("{} {}", it.by.name(), Measure::Power.told(power)),
                    None => format!("{} not rated, source missing", it.by.name()),
                })
                .collect();
            let others = after("; ", &others.join(", "));
            let service = if (rating.service_factor - 1.0).abs() > f64::EPSILON {
                format!(" with the service factor {}", figure(rating.service_factor))
            } else {
                String::new()
            };
            format!(
                "Chain{of} carries {carried}, {:.0} %{service} of the {} that it is rated for by {} at the {} teeth of {}{others}.",
                100.0 * rating.utilisation().unwrap_or(f64::NAN),
                Measure::Power.told(power),
                by.name(),
                sprocket.teeth,
                sprocket.name
            )
        }
        (Err(why), _) => {
            let twin = rating.twin.map_or_else(String::new, |twin| {
                format!(
                    " That is {:.0} % of the {} that ASME B29.1 rates its chain of this pitch for.",
                    100.0 * rating.service_factor * rating.carried / twin,
                    Measure::Power.told(twin)
                )
            });
            let why = why.to_string();
            let why = why[..1].to_uppercase() + &why[1..];
            format!("Chain{of} carries {carried}. {why}.{twin}")
        }
        (Ok(_), None) => return Vec::new(),
    };
    let pressure = rating.bearing_pressure.map(|pressure| {
        format!(
            "Bearing pressure of pins on bushes: {}, under the mean pull of the tightest span.",
            Measure::Pressure.told(pressure)
        )
    });
    let oil = rating.lubrication.zip(rating.lubrication_speeds);
    let oil = oil.map(|(class, speeds)| {
        let assumed = if speeds.is_tabled { "" } else { ", assumed" };
        format!(
            "Lubrication: {} at {}; drops do up to {}, a bath up to {}{assumed}.",
            class.name(),
            Measure::Speed.told(rating.chain_speed),
            Measure::Speed.told_with(speeds.drip, 2),
            Measure::Speed.told_with(speeds.bath, 2),
        )
    });
    let wear = rating.wear_limit.map(|limit| {
        let after = rating.life.map_or_else(String::new, |hours| {
            format!(
                " A new one grows by that in {} of running as here: the wear coefficient of 3·10⁻⁷ mm³/(N m) is assumed, within a factor of ten.",
                told_hours(hours)
            )
        });
        format!("Chain{of} is worn out at {limit}.{after}")
    });
    let sentences = std::iter::once(power).chain(pressure);
    sentences.chain(oil).chain(wear).collect()
}
