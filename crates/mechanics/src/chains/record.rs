//! Results of one evaluation of a chain.

use serde::{Deserialize, Serialize};

use super::joints::Resistance;
use super::links::{Impulses, JointState};
use super::particles::Turning;
use super::particles::points;
use crate::bodies::BodyContacts;
use crate::contact::{Begun, Frame, Touch, Wrench};
use crate::seam::Loads;

/// Contact states, and the work space of the member.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Record {
    pub(crate) loads: Loads,
    /// What joints leave behind; empty where links are springs.
    pub(super) joint_state: JointState,
    #[serde(skip)]
    pub(super) impulses: Impulses,
    /// Findings in joints that are points; empty elsewhere.
    pub(super) points: points::Found,
    /// What resists in the joints; empty where nothing does.
    pub(super) resistance: Resistance,
    /// How the links of particles turn, where something resists that.
    #[serde(skip)]
    pub(super) turning: Turning,
}

impl Record {
    /// Room for every evaluation of a chain with these contacts.
    pub(crate) fn new(contacts: &BodyContacts) -> Self {
        let (wheels, rails) = (contacts.teeth.len(), contacts.rails.len());
        let touches = |count: usize| vec![Box::<Touch>::default(); count];
        Self {
            loads: Loads {
                teeth: touches(wheels),
                rails: touches(rails),
                wheel_wrenches: vec![Wrench::default(); wheels],
                rail_wrenches: vec![Wrench::default(); rails],
                frames: vec![Frame::fixed(); wheels + rails],
                ways: vec![None; wheels + rails],
            },
            ..Self::default()
        }
    }

    /// How contacts began: depth \[m\], and the share of the step after which they did.
    pub(crate) fn onsets(&self) -> impl Iterator<Item = (f64, f64)> {
        let Loads {
            wheel_wrenches,
            rail_wrenches,
            ..
        } = &self.loads;
        let joints = self.joint_state.tallies.iter().chain(&self.points.tallies);
        let wrenches = wheel_wrenches.iter().chain(rail_wrenches);
        wrenches
            .map(|wrench| (wrench.first_depth, wrench.first_share))
            .chain(joints.map(|tally| (tally.first_depth, tally.first_share)))
    }

    /// Contacts that began in the joints, and their depths: pins in bushes, bushes in rollers.
    pub(crate) fn joints(&self) -> [(Begun, f64); 2] {
        // A chain has links or points.
        let [links, points] = [&self.joint_state.tallies, &self.points.tallies];
        [0, 1].map(|k| {
            let begun = links[k].begun.and(points[k].begun);
            (begun, links[k].depth.max(points[k].depth))
        })
    }
}
