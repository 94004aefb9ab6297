//! Keeping a watch on the steps of a system, and the accounts of its bodies.

use chaindrive_geometry::Point;
use chaindrive_integrate::{Moment, SecondOrderSystem};

use super::{Record, System};
use crate::accounts::{AccountSizes, Accounts};
use crate::energy::Flow;
use crate::order::Forcing;
use crate::watch::{DriveExtremes, Watch, WatchPlan, WatchWork, mean_between};

impl System {
    /// Has every step watched as a plan says, and keeps the accounts of the bodies among the
    /// [quadratures](SecondOrderSystem::quadratures); none of it without a plan. To be said before a method starts.
    pub fn watch(&mut self, plan: Option<WatchPlan>) {
        self.bodies.accounts = AccountSizes::default();
        self.watch = None;
        if let Some(plan) = plan {
            self.bodies.accounts = AccountSizes {
                sprockets: self.bodies.wheels.len(),
                shafts: self.bodies.shafts.len(),
                guides: self.bodies.rails.len(),
                tensioners: self.bodies.slides.len(),
            };
            let AccountSizes {
                sprockets,
                shafts: _,
                guides,
                tensioners,
            } = self.bodies.accounts;
            let spans = self.chains.iter().map(|member| member.route.len()).sum();
            let sizes = [self.chains.len(), sprockets, guides, tensioners];
            self.watch = Some(Box::new(Watch::new(plan, spans, sizes)));
        }
    }

    /// How steps are watched, where they are.
    pub fn watch_plan(&self) -> Option<&WatchPlan> {
        self.watch.as_ref().map(|watch| &watch.plan)
    }

    /// The accounts of the bodies among the quadratures of a state; empty where none are kept.
    ///
    /// # Panics
    /// The quadratures are not those of this system.
    pub fn accounts(&self, quadratures: &[f64]) -> Accounts {
        assert_eq!(
            quadratures.len(),
            self.quadratures(),
            "quadratures of this system"
        );
        self.bodies.accounts.read(&quadratures[Flow::ALL.len()..])
    }

    /// Extremes since the last period of the watch ended.
    pub fn extremes(&self) -> Option<&DriveExtremes> {
        self.watch.as_ref().map(|watch| watch.current())
    }

    /// Periods of the watch that ended since the last call: when \[s\], and the extremes in each.
    pub fn hand_out_periods(&mut self) -> Vec<(f64, DriveExtremes)> {
        let watch = self.watch.as_mut();
        watch.map_or_else(Vec::new, |watch| watch.take_ended())
    }

    /// Hands out the readings of the spans since the last call: each a time \[s\], the tension of every span \[N\], not a number where no roller holds
    /// it, how many links of every chain are pressed, and the phase of every [forcing](WatchPlan::forcings) \[rad\].
    pub fn hand_out_readings(&mut self, to: &mut Vec<f64>) {
        if let Some(watch) = &mut self.watch {
            watch.hand_out_readings(to);
        }
    }
}

impl Watch {
    /// Takes in an accepted step: the state at its end, and the record of its evaluation before the memory of contacts takes it.
    pub(crate) fn see(&mut self, system: &System, at: Moment<'_>, record: &Record) {
        let t = at.t;
        self.pass(t);
        self.see_bodies(system, at, record);
        if !self.is_looking {
            self.look(system, at, &mut system.new_record());
        }
        let reads = self.due(0, t);
        if reads {
            self.readings.push(t);
        }
        self.see_chains(system, at, record, reads);
    }

    /// Forces on sprockets and guides, speeds, lags and places.
    fn see_bodies(&mut self, system: &System, at: Moment<'_>, record: &Record) {
        let t = at.t;
        let bodies = &system.bodies;
        // Sprockets turn with their shafts.
        let shafts = bodies.shafts.iter();
        let turning = &mut self.work.turning;
        turning.clear();
        turning.extend(shafts.map(|it| it.turn.kinematics(t, at.q, at.v)));
        let turned = |wheel: usize| &turning[bodies.wheels[wheel].shaft];
        let sprockets = &mut self.current.sprockets;
        let leaders = self.plan.leaders.iter().enumerate();
        for ((extremes, wrench), (wheel, (leader, ratio))) in sprockets
            .iter_mut()
            .zip(&record.wheel_wrenches)
            .zip(leaders)
        {
            let [x, y] = wrench.force;
            extremes.force.see((x * x + y * y).sqrt(), t);
            extremes.speed.see(turned(wheel).rate, t);
            // ε = θ − i θ₀
            let lag = turned(wheel).position - ratio * turned(*leader).position;
            extremes.lag.see(lag, t);
        }
        for (member, record) in system.chains.iter().zip(&record.chains) {
            let found = member
                .contacts
                .teeth
                .iter()
                .zip(&record.loads.wheel_wrenches);
            for (on, wrench) in found {
                sprockets[on.wheel].contact.see(wrench.greatest, t);
            }
        }
        for (extremes, wrench) in self.current.guides.iter_mut().zip(&record.rail_wrenches) {
            let [x, y] = wrench.force;
            extremes.see((x * x + y * y).sqrt(), t);
        }
        for (extremes, slide) in self.current.tensioners.iter_mut().zip(&bodies.slides) {
            extremes.see(slide.pose(at.q, at.v).coordinate, t);
        }
    }

    /// Tensions of links and spans; what is read is written down.
    fn see_chains(&mut self, system: &System, at: Moment<'_>, record: &Record, reads: bool) {
        let t = at.t;
        let tensions = &mut self.work.tensions;
        let (mut first, mut chains) = (0, 0);
        let readings = self.readings.len();
        if reads {
            let count = self.current.spans.len() + self.current.chains.len();
            self.readings.resize(readings + count, f64::NAN);
            let turning = &self.work.turning;
            let turned = |it: &Forcing| it.shaft.map_or(t, |shaft| turning[shaft].position);
            let phases = self.plan.forcings.iter().map(|it| it.rate * turned(it));
            self.readings.extend(phases);
        }
        let read = &mut self.readings[readings..];
        for (member, record) in system.chains.iter().zip(&record.chains) {
            let [least, greatest] = member
                .chain
                .tensions_of_step(member.own(at), record, tensions);
            let extremes = &mut self.current.chains[chains];
            extremes.see(least, t);
            extremes.see(greatest, t);
            let mut tight = 0.0_f64;
            for span in first..first + member.route.len() {
                let Some((last, next)) = self.ends[span] else {
                    continue;
                };
                let tension = mean_between(tensions, last, next);
                self.current.spans[span].see(tension, t);
                tight = tight.max(tension);
                if reads {
                    read[span] = tension;
                }
            }
            if reads {
                let limit = -self.plan.pressed * tight;
                let is_pressed = |tension: &&f64| tight > 0.0 && **tension < limit;
                // Few chains are pressed at any time.
                let count = if least < limit {
                    tensions.iter().filter(is_pressed).count()
                } else {
                    0
                };
                read[self.ends.len() + chains] = count as f64;
            }
            first += member.route.len();
            chains += 1;
        }
    }

    /// Looks where the spans begin and end, from time to time: after the memory of contacts has taken the record of the step, which is work space then.
    pub(crate) fn look(&mut self, system: &System, at: Moment<'_>, record: &mut Record) {
        if self.due(1, at.t) {
            self.is_looking = true;
            self.find_spans(system, at, record);
        }
    }

    /// Finds the rollers between which the spans lie.
    fn find_spans(&mut self, system: &System, at: Moment<'_>, record: &mut Record) {
        let WatchWork { seated, seats, .. } = &mut self.work;
        let mut span = 0;
        for (member, record) in system.chains.iter().zip(&mut record.chains) {
            let pose = member.chain.pose(member.own(at), record);
            seats.clear();
            for on in &member.contacts.teeth {
                let centre = system.bodies.wheel_centre(on.wheel, at);
                let place = |roller: usize| Point::new(pose.x[roller], pose.y[roller]);
                seats.push(system.seated(member, on, seated, centre, place));
            }
            for i in 0..member.route.len() {
                self.ends[span] = member.span_ends(seats, i);
                span += 1;
            }
        }
    }
}
