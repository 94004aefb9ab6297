//! Forces from outside on centres and carriers, as they act.

use chaindrive_integrate::Moment;

use super::slide::Pose;
use super::{Bodies, Wheel, WheelSupport};
use crate::{Action, Forces};

/// A force from outside on what a tensioner carries, or on itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForceOnSlide {
    /// The wheel on whose centre it acts; none: the carrier itself.
    pub(crate) centre: Option<usize>,
    /// Generalised force Q = F·∂x/∂s \[N or N m\].
    pub(crate) along: f64,
    /// Its slope over the coordinate, F·∂²x/∂s² \[N/m or N m/rad\].
    pub(crate) bend: f64,
}

/// A force of the chains, with that from outside where one acts.
#[inline(always)]
pub(super) fn with_force(force: [f64; 2], given: Option<[f64; 2]>) -> [f64; 2] {
    given.map_or(force, |given| [force[0] + given[0], force[1] + given[1]])
}

impl Bodies {
    /// Force from outside on the centre of a wheel \[N\]; none where nothing acts.
    #[inline(always)]
    pub(crate) fn centre_force(&self, index: usize, at: Moment<'_>) -> Option<[f64; 2]> {
        let wheel = &self.wheels[index];
        let control = self.inputs.centre_force(index, at.t);
        self.acting(&wheel.forces, wheel.shaft, control, at)
    }

    /// Force from outside on a carrier itself \[N\]; none where nothing acts.
    pub(crate) fn carrier_force(&self, index: usize, at: Moment<'_>) -> Option<[f64; 2]> {
        let control = self.inputs.carrier_force(index, at.t);
        // A force on a carrier names the shaft that it follows.
        self.acting(&self.slides[index].forces, 0, control, at)
    }

    /// `own`: the shaft whose angle counts where a force names none.
    #[inline(always)]
    fn acting(
        &self,
        forces: &Forces,
        own: usize,
        control: Option<[f64; 2]>,
        at: Moment<'_>,
    ) -> Option<[f64; 2]> {
        if forces.is_empty() {
            return control;
        }
        let angle = |shaft: usize| {
            self.shafts[shaft]
                .turn
                .kinematics(at.t, at.q, at.v)
                .position
        };
        let value = |it: &Action| {
            let turns = it.turns_with_an_angle();
            it.at(
                at.t,
                if turns {
                    angle(it.follows().unwrap_or(own))
                } else {
                    0.0
                },
            )
        };
        Some(with_force(forces.sum(value), control))
    }

    /// Visits the forces from outside on all that a tensioner carries, and on itself.
    pub(crate) fn each_force_on(
        &self,
        index: usize,
        pose: Pose,
        at: Moment<'_>,
        mut visit: impl FnMut(ForceOnSlide),
    ) {
        let slide = &self.slides[index];
        let mut on_point = |centre, [x, y]: [f64; 2], place| {
            let [first, second] = slide.carrier.ways(pose.coordinate, place);
            visit(ForceOnSlide {
                centre,
                along: first.x * x + first.y * y,
                bend: second.x * x + second.y * y,
            });
        };
        for (index_of_wheel, wheel) in self.wheels.iter().enumerate() {
            if wheel.carried() == Some(index)
                && let Some(force) = self.centre_force(index_of_wheel, at)
            {
                on_point(
                    Some(index_of_wheel),
                    force,
                    slide.carry(pose, wheel.centre).0,
                );
            }
        }
        if let Some(force) = self.carrier_force(index, at) {
            // All points of a slide move alike.
            let assembled = slide.forced_at.unwrap_or_default();
            on_point(None, force, slide.carry(pose, assembled).0);
        }
    }

    /// All forces of the scene.
    pub(crate) fn all_forces(&self) -> impl Iterator<Item = &Action> {
        let centres = self.wheels.iter().flat_map(|it| it.forces.all());
        centres.chain(self.slides.iter().flat_map(|it| it.forces.all()))
    }

    /// The forces of the scene on all that moves by itself, body by body.
    fn moving_forces(&self) -> impl Iterator<Item = &Forces> {
        let moves = |wheel: &&Wheel| match wheel.support {
            WheelSupport::Fixed | WheelSupport::Prescribed { .. } => false,
            WheelSupport::Springs { .. } => true,
            WheelSupport::Carried(slide) => self.slides[slide].dof.is_some(),
        };
        let wheels = self.wheels.iter().filter(moves).map(|it| &it.forces);
        let slides = self.slides.iter().filter(|it| it.dof.is_some());
        let all = wheels.chain(slides.map(|it| &it.forces));
        all.filter(|forces| !forces.is_empty())
    }

    /// Whether a force of the scene acts on something that moves by itself.
    pub(crate) fn are_forced(&self) -> bool {
        self.moving_forces().next().is_some()
    }

    /// The largest of them at a time, where no shaft has turned yet \[N\].
    pub(crate) fn largest_force(&self, t: f64) -> f64 {
        let sizes = self.moving_forces().map(|forces| {
            let [x, y] = forces.unturned(t);
            x.hypot(y)
        });
        sizes.fold(0.0, f64::max)
    }

    /// Takes the forces of the scene away.
    pub(crate) fn free_of_forces(&mut self) {
        let centres = self.wheels.iter_mut().map(|it| &mut it.forces);
        let all = centres.chain(self.slides.iter_mut().map(|it| &mut it.forces));
        all.for_each(|forces| *forces = Forces::default());
    }
}
