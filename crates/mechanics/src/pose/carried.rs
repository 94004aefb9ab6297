//! Lines of a carrier, from what it turns about to what it carries. For the eye: the drive knows no shape of a carrier.

use chaindrive_geometry::{ArcSpline, Point};

use crate::Carrier;
use crate::drive::{GuideSupport, Parts, Support};

/// Length of the drawn rod of a slider in pitches.
const ROD: f64 = 3.0;

/// Lines of a tensioner's carrier where it was laid.
pub(super) fn lines(parts: &Parts, tensioner: usize, pitch: f64) -> Vec<[Point; 2]> {
    let sprockets = parts.sprockets.iter();
    let (centres, tips): (Vec<Point>, Vec<f64>) = sprockets
        .filter(|it| it.support == Support::Tensioner(tensioner))
        .map(|it| (it.centre, it.gap.tip_radius))
        .unzip();
    let guides = parts.guides.iter();
    let faces: Vec<&ArcSpline> = guides
        .filter(|it| it.support == GuideSupport::Tensioner(tensioner))
        .map(|it| &it.face)
        .collect();
    match &parts.tensioners[tensioner].carrier {
        Carrier::Slider(slider) => {
            // A rod behind everything that it pushes, seen beyond the tips of a sprocket.
            let middles = faces.iter();
            let middles = middles.map(|face| (face.point_at(0.5 * face.length()), 0.0));
            let pushed = centres.iter().copied().zip(tips).chain(middles);
            pushed
                .map(|(end, covered)| [end - slider.direction * (covered + ROD * pitch), end])
                .collect()
        }
        Carrier::Arm(arm) => {
            let nearest = |from: Point| {
                let feet = faces
                    .iter()
                    .filter_map(|face| face.nearest(from, f64::INFINITY));
                let places = feet.map(|foot| foot.point).chain(centres.iter().copied());
                places.min_by(|a, b| (a - from).norm().total_cmp(&(b - from).norm()))
            };
            let feet = faces
                .iter()
                .filter_map(|face| face.nearest(arm.pivot, f64::INFINITY));
            let ends = feet.map(|foot| foot.point).chain(centres.iter().copied());
            let mut lines: Vec<_> = ends.map(|end| [arm.pivot, end]).collect();
            // The plunger pushes on the nearest thing that the arm carries, or on an arm of its own.
            lines.extend(
                arm.plunger
                    .map(|plunger| [nearest(plunger.at).unwrap_or(arm.pivot), plunger.at]),
            );
            lines
        }
    }
}
