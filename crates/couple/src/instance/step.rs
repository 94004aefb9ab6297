//! Steps from one communication point to the next, and what is told of them.

use std::sync::Arc;
use std::time::{Duration, Instant};

use chaindrive::{Channel, Flow, SimulationError};

use super::{Instance, Phase};
use crate::fault::Fault;
use crate::signal::CommunicationPoint;
use crate::variable::LINEAR;

/// Difference of a communication point from the time of the drive that rounding may make, over the time and step.
const SAME_TIME: f64 = 1e-9;

/// Steps of the method in a communication step at most: at a microsecond each they would take eleven days.
const MOST_STEPS: f64 = 1e12;

/// Share of the energy that went in beyond which a ledger is open: what is missing is then more than any law is exact.
const OPEN: f64 = 1e-3;

/// By how much more energy has to be missing until it is told again.
const TOLD_AGAIN: f64 = 2.0;

impl Instance {
    /// Moves the drive on from a communication point \[s\] by a step \[s\]; tells what is to be warned of.
    ///
    /// It warns where more than a thousandth of the energy that went in is missing, and again where twice as much is.
    ///
    /// # Errors
    /// As [`step_until`](Self::step_until).
    pub fn step(&mut self, from: f64, step: f64) -> Result<Option<String>, Fault> {
        self.step_until(from, step, &|| false)
    }

    /// The same, which may be given up: `stop` is asked every 50 ms.
    ///
    /// # Errors
    /// [`Fault`]: not the time for it, another point than that where the drive stands, a step that is not positive, an input that cannot
    /// act. Also a motion that cannot go on or has lost its numbers, and a step that is given up: the drive stands at the beginning
    /// of the step then, as it was.
    pub fn step_until(
        &mut self,
        from: f64,
        step: f64,
        stop: &dyn Fn() -> bool,
    ) -> Result<Option<String>, Fault> {
        self.require(
            &[Phase::Stepping],
            "end the initialization first, or set a state of the time before",
        )?;
        let now = self.at.time;
        if !(step > 0.0 && step.is_finite()) {
            return Err(Fault::new(format!(
                "a step of {step} s: it must be positive and finite"
            )));
        }
        let off = (from - now).abs();
        if off.is_nan() || off > SAME_TIME * (now.abs() + step) {
            return Err(Fault::new(format!(
                "the communication point is {from} s, and the drive stands at {now} s"
            )));
        }
        let least = self.simulation.method().step();
        if step / least > MOST_STEPS {
            return Err(Fault::new(format!(
                "a step of {step} s: it takes more than {MOST_STEPS:e} steps of {least} s"
            )));
        }
        let before = self.save()?;
        self.refresh();
        let was_held = self.is_held();
        let mut moved = self.move_on(from, step, stop);
        if moved.is_ok() && was_held && !self.is_held() {
            let time = self.at.time;
            moved = Err(Fault::new(format!(
                "at {time} s no span has a tension that is a number: the chain has left its sprockets; take a gentler input"
            )));
        }
        if moved.is_err() && self.restore(&before).is_err() {
            self.at.phase = Phase::Failed;
        }
        moved
    }

    /// Readings of a channel.
    fn readings(&self, channel: Channel) -> &[f64] {
        let place = self.view.channels().iter().position(|it| *it == channel);
        place.map_or(&[][..], |place| self.view.values(place))
    }

    /// Whether a span has a tension.
    fn is_held(&self) -> bool {
        let tensions = self.readings(Channel::SpanTension);
        tensions.iter().any(|tension| tension.is_finite())
    }

    /// Moves the drive on; where that fails it stands anywhere.
    fn move_on(
        &mut self,
        from: f64,
        step: f64,
        stop: &dyn Fn() -> bool,
    ) -> Result<Option<String>, Fault> {
        self.act(step)?;
        let end = from + step;
        let begin = Instant::now();
        let patience = Duration::try_from_secs_f64(self.at.patience).unwrap_or(Duration::MAX);
        let bounded = self.at.patience > 0.0;
        let give_up = || stop() || bounded && begin.elapsed() > patience;
        let moved = self.simulation.move_to(end - self.at.begin, &give_up);
        self.fresh = false;
        match moved {
            Ok(()) => {}
            Err(SimulationError::Interrupted) => {
                let taken = begin.elapsed().as_secs_f64();
                return Err(Fault::new(format!(
                    "the step to {end} s was given up after {taken:.1} s and taken back"
                )));
            }
            Err(error) => return Err(Fault::new(format!("at {end} s: {error}"))),
        }
        self.at.time = end;
        self.at.step = step;
        self.missing_energy()
    }

    /// What is to be told of energy that is missing.
    fn missing_energy(&mut self) -> Result<Option<String>, Fault> {
        self.refresh();
        let of = |channel| self.readings(channel);
        let missing: f64 = of(Channel::EnergyResidual).iter().sum();
        let flows = Flow::ALL.iter().zip(of(Channel::EnergyFlows));
        let outside = flows.filter(|(flow, _)| !flow.is_loss());
        let worked: f64 = outside.map(|(_, worked)| worked.abs()).sum();
        // What moves at the start has been put in before.
        let put_in = of(Channel::EnergyKinetic)
            .iter()
            .fold(worked, |most, it| it.max(most));
        let time = self.at.time;
        if !(missing.is_finite() && worked.is_finite()) {
            return Err(Fault::new(format!(
                "at {time} s the energy of the drive is no number any more; take a smaller step, or a smaller input"
            )));
        }
        if missing.abs() <= (OPEN * put_in).max(TOLD_AGAIN * self.at.told) {
            return Ok(None);
        }
        self.at.told = missing.abs();
        Ok(Some(format!(
            "at {time} s {missing:.3e} J are missing of {put_in:.3e} J that went in: take a smaller communication step, a smaller \
             step of the method, or a gentler input"
        )))
    }

    /// Work of the inputs in the step that ended at this communication point \[J\].
    pub(super) fn work_of_the_last_step(&self) -> f64 {
        let signals = self.model.ports.signals.iter().zip(&self.at.signals);
        signals
            .map(|(signal, held)| held.work_so_far(signal, self.at.step, &self.values))
            .sum()
    }

    /// Sets what acts in the step to come.
    fn act(&mut self, step: f64) -> Result<(), Fault> {
        let model = Arc::clone(&self.model);
        for (index, signal) in model.ports.signals.iter().enumerate() {
            let held = &mut self.at.signals[index];
            if signal
                .shaft
                .is_some_and(|(shaft, choice)| self.at.shafts[shaft] != choice)
            {
                if !self.fresh {
                    self.refresh();
                }
                let held = &mut self.at.signals[index];
                self.at.work += held.work_so_far(signal, self.at.step, &self.values);
                held.end();
                continue;
            }
            if !held.is_acting(signal.start) {
                continue;
            }
            if !self.fresh {
                self.refresh();
            }
            let point = CommunicationPoint {
                last_step: self.at.step,
                next_step: step,
                linear: self.at.extrapolation == LINEAR,
            };
            let held = &mut self.at.signals[index];
            let (courses, exchanged) = held.pass(signal, point, &self.values);
            self.at.work += exchanged.work;
            self.at.error += exchanged.error;
            for course in courses {
                let set = self.simulation.set(&signal.control, course);
                set.map_err(|error| Fault::new(error.to_string()))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use chaindrive::{Request, Scene, Settings};

    use super::*;
    use crate::{Export, Model};

    fn unit() -> Instance {
        unit_of(&Scene::preset("marine_two_sprockets").unwrap())
    }

    fn unit_of(scene: &Scene) -> Instance {
        let request = Request::new(scene, &Settings::default()).unwrap();
        let model = Model::new(Export::new(&request, "drive")).unwrap();
        let mut unit = Instance::new(Arc::new(model));
        unit.enter_initialization(0.0).unwrap();
        unit.exit_initialization().unwrap();
        unit
    }

    fn reference(unit: &Instance, name: &str) -> u32 {
        unit.model().reference(name).unwrap()
    }

    /// Defect: five steps with 1e12 N m were taken without a word, and 4.8e12 J were missing.
    #[test]
    fn a_ledger_that_opens_is_told() {
        let mut unit = unit();
        assert_eq!(unit.step(0.0, 1e-4), Ok(None), "gentle");
        let torque = reference(&unit, "set_torque[camshaft]");
        unit.set_real(torque, 1e12).unwrap();
        let told: Vec<_> = (1..6)
            .map(|k| unit.step(f64::from(k) * 1e-4, 1e-4))
            .collect();
        let told = told.into_iter().find(|it| *it != Ok(None)).unwrap();
        match told {
            Ok(warning) => assert!(warning.unwrap().contains("are missing of")),
            Err(fault) => assert!(fault.0.contains(" s"), "{fault}"),
        }
    }

    /// Defect: a centre that jumped by 100 m made tensions that are no numbers, without a word.
    #[test]
    fn what_is_no_number_is_taken_back() {
        let mut unit = unit();
        unit.step(0.0, 1e-4).unwrap();
        let [place, energy] =
            ["set_centre_x[camshaft]", "energy_kinetic"].map(|name| reference(&unit, name));
        let before = unit.real(energy).unwrap();
        unit.set_real(place, 100.0).unwrap();
        unit.step(1e-4, 1e-4).unwrap_err();
        assert_eq!(unit.time().to_bits(), 1e-4_f64.to_bits());
        assert_eq!(unit.real(energy).unwrap().to_bits(), before.to_bits());
        assert_eq!(unit.phase(), Phase::Stepping);
    }

    #[test]
    fn a_step_is_given_up_and_taken_back() {
        let mut unit = unit();
        let patience = reference(&unit, "step_patience");
        unit.set_real(patience, -1.0).unwrap_err();
        unit.set_real(patience, 0.1).unwrap();
        let begin = Instant::now();
        let fault = unit.step(0.0, 1e5).unwrap_err();
        assert!(fault.0.contains("given up"), "{fault}");
        assert!(begin.elapsed() < Duration::from_secs(5));
        unit.set_real(patience, 0.0).unwrap();
        let fault = unit.step_until(0.0, 1e5, &|| true).unwrap_err();
        assert!(fault.0.contains("given up"), "{fault}");
        unit.step(0.0, 1e-4).unwrap();
    }

    /// W = F Δx of a centre on springs, and of a point of an arm.
    #[test]
    fn forces_on_centres_and_carriers_are_inputs() {
        let scene = Scene::preset("marine_two_sprockets").unwrap();
        let springs = "{ kind = \"springs\", stiffness = [1e8, 1e8], damping = [0, 0] }";
        let sprung = scene
            .replace("sprockets.camshaft.support", springs)
            .unwrap();
        let sprung = sprung.replace("sprockets.camshaft.mass", "500").unwrap();
        let mut unit = unit_of(&sprung);
        let [force, place, work] = [
            "set_force_x[camshaft]",
            "sprocket_x[camshaft]",
            "coupling_energy",
        ]
        .map(|name| reference(&unit, name));
        let begin = unit.real(place).unwrap();
        unit.set_real(force, 1e4).unwrap();
        for step in 0..3 {
            unit.step(f64::from(step) * 1e-4, 1e-4).unwrap();
        }
        let way = unit.real(place).unwrap() - begin;
        let found = unit.real(work).unwrap();
        assert!(way > 0.0 && (found / (1e4 * way) - 1.0).abs() < 1e-9);
        // The carrier says where: only then has it the inputs.
        let scene = Scene::preset("timing_drive").unwrap();
        let name = "set_force_y[tensioners.arm]";
        assert!(unit_of(&scene).model().reference(name).is_none());
        let scene = scene
            .replace("tensioners.arm.force_at", "[0.1, 0.1]")
            .unwrap();
        let mut unit = unit_of(&scene);
        let [force, work] = [name, "coupling_energy"].map(|name| reference(&unit, name));
        unit.set_real(force, 100.0).unwrap();
        for step in 0..20 {
            unit.step(f64::from(step) * 1e-4, 1e-4).unwrap();
        }
        let flows = unit.readings(Channel::EnergyFlows);
        let flow = flows[Flow::Forces as usize];
        let found = unit.real(work).unwrap();
        assert!(
            flow != 0.0 && (found / flow - 1.0).abs() < 1e-3,
            "{found} {flow}"
        );
    }

    /// Defect: after the first step the work was zero, for ½ J ω² of a shaft that a held torque had turned.
    #[test]
    fn the_work_of_inputs_is_that_of_this_instant() {
        let mut unit = unit();
        let [torque, angle, work] = [
            "set_torque[camshaft]",
            "sprocket_angle[camshaft]",
            "coupling_energy",
        ]
        .map(|name| reference(&unit, name));
        unit.set_real(torque, 1e3).unwrap();
        let begin = unit.real(angle).unwrap();
        for step in 0..3 {
            unit.step(f64::from(step) * 1e-4, 1e-4).unwrap();
            let way = unit.real(angle).unwrap() - begin;
            let found = unit.real(work).unwrap();
            assert!(
                (found - 1e3 * way).abs() <= 1e-9 * found.abs(),
                "{found} {way}"
            );
            assert!(found != 0.0);
        }
        // Whatever turns the shaft from now on, what was done stays.
        let shaft = reference(&unit, "input[camshaft]");
        let before = unit.real(work).unwrap();
        unit.set_choice(shaft, 3).unwrap();
        let speed = unit.model().reference("sprocket_speed[camshaft]").unwrap();
        let turning = unit.real(speed).unwrap();
        unit.set_real(reference(&unit, "set_speed[camshaft]"), turning)
            .unwrap();
        unit.step(3e-4, 1e-9).unwrap();
        assert!((unit.real(work).unwrap() - before).abs() < 0.05 * before.abs());
    }
}
