//! An arc spline as one of parry's shapes.
//!
//! Never put one into a parry `Compound`: its inner queries use the default dispatcher, which
//! does not know this shape and answers with silence, not with an error.

use parry2d_f64::bounding_volume::{Aabb, BoundingSphere};
use parry2d_f64::mass_properties::MassProperties;
use parry2d_f64::math::Vector;
use parry2d_f64::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use parry2d_f64::shape::{FeatureId, Shape, ShapeType, SubShapeId, TypedShape};

use super::{direction_from_parry, direction_to_parry, from_parry, to_parry};
use crate::crossing::crossings;
use crate::piece::right_of;
use crate::{ArcSpline, Foot, Piece, Point, Segment};

/// Index of a piece as parry counts.
pub(super) fn part(index: usize) -> SubShapeId {
    SubShapeId::try_from(index).unwrap_or(SubShapeId::MAX)
}

impl ArcSpline {
    /// Distance and place for parry, which expects an answer to every question.
    fn project(&self, p: Vector, solid: bool) -> (PointProjection, FeatureId) {
        let Some(foot) = self.nearest(from_parry(p), f64::INFINITY) else {
            let nowhere = Vector::splat(f64::NAN);
            return (PointProjection::new(false, nowhere), FeatureId::Unknown);
        };
        let inside = self.is_closed() && foot.distance <= 0.0;
        let point = if inside && solid {
            p
        } else {
            to_parry(foot.point)
        };
        let projection = PointProjection::new(inside, point).with_subshape(part(foot.piece));
        (projection, feature(&foot))
    }
}

fn feature(foot: &Foot) -> FeatureId {
    if foot.curvature.is_infinite() {
        FeatureId::Vertex(part(foot.piece))
    } else {
        FeatureId::Face(part(foot.piece))
    }
}

impl PointQuery for ArcSpline {
    fn project_local_point(&self, pt: Vector, solid: bool) -> PointProjection {
        self.project(pt, solid).0
    }

    fn project_local_point_and_get_feature(&self, pt: Vector) -> (PointProjection, FeatureId) {
        self.project(pt, false)
    }
}

impl RayCast for ArcSpline {
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: f64,
        solid: bool,
    ) -> Option<RayIntersection> {
        let (origin, direction) = (from_parry(ray.origin), direction_from_parry(ray.dir));
        if solid && self.contains(origin) {
            return Some(RayIntersection::new(0.0, Vector::ZERO, FeatureId::Unknown));
        }
        let first = |index: usize| {
            let mut best: Option<(f64, f64)> = None;
            crossings(&self.pieces()[index], origin, direction, |t, s| {
                let before = best.is_none_or(|(least, _)| t < least);
                if t >= 0.0 && t <= max_time_of_impact && before {
                    best = Some((t, s));
                }
            });
            best
        };
        let (index, (time, s)) = self.tree.first_along(ray, max_time_of_impact, first)?;
        // From inside the material a ray meets the back of the face.
        let normal = self.pieces()[index].normal(s);
        let facing = if normal.dot(&direction) > 0.0 {
            -normal
        } else {
            normal
        };
        let face = FeatureId::Face(part(index));
        let hit = RayIntersection::new(time, direction_to_parry(facing), face);
        Some(hit.with_subshape(part(index)))
    }
}

impl Shape for ArcSpline {
    fn compute_local_aabb(&self) -> Aabb {
        self.tree.root()
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.tree.root().bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    /// Only equal factors keep an arc an arc; others, and mirror images, are refused.
    fn scale_dyn(&self, scale: Vector, _num_subdivisions: u32) -> Option<Box<dyn Shape>> {
        let factor = scale.x;
        if factor.to_bits() != scale.y.to_bits() || factor <= 0.0 {
            return None;
        }
        let pieces: Vec<_> = self.pieces().iter().map(|p| scaled(p, factor)).collect();
        let curve = if self.is_closed() {
            Self::closed(&pieces)
        } else {
            Self::open(&pieces)
        };
        curve.ok().map(|curve| Box::new(curve) as Box<dyn Shape>)
    }

    fn mass_properties(&self, density: f64) -> MassProperties {
        let moments = self.area_moments();
        if moments.area > 0.0 {
            MassProperties::new(
                to_parry(moments.centroid()),
                moments.area * density,
                moments.central() * density,
            )
        } else {
            MassProperties::new(Vector::ZERO, 0.0, 0.0)
        }
    }

    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }

    fn as_typed_shape(&self) -> TypedShape<'_> {
        TypedShape::Custom(self)
    }

    fn ccd_thickness(&self) -> f64 {
        0.0
    }

    fn ccd_angular_thickness(&self) -> f64 {
        std::f64::consts::PI
    }

    fn feature_normal_at_point(
        &self,
        _subshape: SubShapeId,
        feature: FeatureId,
        point: Vector,
    ) -> Option<Vector> {
        let point = from_parry(point);
        let normal = match feature {
            FeatureId::Face(i) => {
                let piece = self.pieces().get(i as usize)?;
                match piece {
                    Piece::Segment(_) => piece.normal(0.0),
                    Piece::Arc(arc) => {
                        let spoke = (point - arc.centre).try_normalize(0.0)?;
                        spoke * arc.sweep.signum()
                    }
                }
            }
            FeatureId::Vertex(i) => {
                let station = self.stations.get(i as usize)?;
                (right_of(station.arriving) + right_of(station.start.tangent)).try_normalize(0.0)?
            }
            FeatureId::Unknown => return None,
        };
        Some(direction_to_parry(normal))
    }
}

fn scaled(piece: &Piece, factor: f64) -> Piece {
    let moved = |p: Point| Point::from(p.coords * factor);
    match *piece {
        Piece::Segment(Segment { start, end }) => Segment::new(moved(start), moved(end)).into(),
        Piece::Arc(arc) => crate::Arc {
            centre: moved(arc.centre),
            radius: arc.radius * factor,
            ..arc
        }
        .into(),
    }
}
