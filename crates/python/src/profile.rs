//! Whole profiles of bodies, asked about points.

use chaindrive_geometry::{
    Arc, ArcSpline, AreaMoments, Foot, Piece, Point, Segment, Vector, biarc as tangent_arcs,
};
use numpy::ndarray::ArrayView2;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::drawing::points;
use crate::errors::{OrRaise, parameter};

/// The profile of a sprocket or guide.
#[pyclass(frozen, module = "chaindrive._core")]
#[derive(Debug)]
pub(crate) struct Profile(pub(crate) ArcSpline);

/// Feet, their normals and their arc lengths.
type Closest<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// Corners and bulges.
type CornersAndBulges<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);

/// Where two arcs meet that leave a place and arrive at another in unit directions, and their bulges; none where there are none.
#[pyfunction]
pub(crate) fn biarc(
    start: [f64; 2],
    leaving: [f64; 2],
    end: [f64; 2],
    arriving: [f64; 2],
) -> Option<([f64; 2], [f64; 2])> {
    let [a, b] = [start, end].map(Point::from);
    let [ta, tb] = [leaving, arriving].map(Vector::from);
    let pair = tangent_arcs(a, ta, b, tb)?;
    let joint = pair[0].end();
    Some(([joint.x, joint.y], pair.map(|piece: Piece| piece.bulge())))
}

#[pymethods]
impl Profile {
    /// The open curve through corners (n, 2) with bulges; back to the first corner where there are as many.
    #[staticmethod]
    fn with_bulges(
        corners: PyReadonlyArray2<'_, f64>,
        bulges: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Self> {
        let corners: Vec<Point> = rows(&corners.as_array()).collect();
        let bulges = bulges.as_array().to_vec();
        Ok(Self(ArcSpline::with_bulges(&corners, &bulges).or_raise()?))
    }

    /// Corners (n, 2) and bulges.
    fn bulges<'py>(&self, py: Python<'py>) -> PyResult<CornersAndBulges<'py>> {
        let (corners, bulges) = self.0.bulges();
        Ok((points(py, &corners)?, bulges.into_pyarray(py)))
    }

    /// The curve of pieces as `pieces` returns them, to the last bit.
    #[staticmethod]
    fn of_pieces(pieces: Vec<Vec<f64>>, closed: bool) -> PyResult<Self> {
        let piece = |numbers: Vec<f64>| match *numbers {
            [x, y, end_x, end_y] => Ok(Piece::Segment(Segment::new(
                Point::new(x, y),
                Point::new(end_x, end_y),
            ))),
            [x, y, radius, start_angle, sweep] => Ok(Piece::Arc(Arc {
                centre: Point::new(x, y),
                radius,
                start_angle,
                sweep,
            })),
            _ => {
                let message = format!("a piece of {} numbers", numbers.len());
                Err(parameter(message, "pieces", "four or five numbers"))
            }
        };
        let pieces: Vec<Piece> = pieces.into_iter().map(piece).collect::<PyResult<_>>()?;
        let curve = if closed {
            ArcSpline::closed(&pieces)
        } else {
            ArcSpline::open(&pieces)
        };
        Ok(Self(curve.or_raise()?))
    }

    /// Both ends of segments, and centre, radius, angle of the start and sweep of arcs.
    fn pieces(&self) -> Vec<Vec<f64>> {
        let numbers = |piece: &Piece| match piece {
            Piece::Segment(it) => vec![it.start.x, it.start.y, it.end.x, it.end.y],
            Piece::Arc(it) => vec![
                it.centre.x,
                it.centre.y,
                it.radius,
                it.start_angle,
                it.sweep,
            ],
        };
        self.0.pieces().iter().map(numbers).collect()
    }

    /// Area that pieces enclose which come back to where they begin, and its centre.
    fn area(&self) -> (f64, [f64; 2]) {
        let moments = AreaMoments::of(self.0.pieces());
        let centre = moments.centroid();
        (moments.area, [centre.x, centre.y])
    }

    /// Whether it is the border of a solid.
    #[getter]
    fn closed(&self) -> bool {
        self.0.is_closed()
    }

    /// Length along the profile.
    #[getter]
    fn length(&self) -> f64 {
        self.0.length()
    }

    /// Signed distances of points (n, 2).
    fn distance<'py>(
        &self,
        py: Python<'py>,
        places: PyReadonlyArray2<'py, f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        let feet = self.feet(&places.as_array()).into_iter();
        let distances: Vec<f64> = feet
            .map(|foot| foot.map_or(f64::NAN, |foot| foot.distance))
            .collect();
        distances.into_pyarray(py)
    }

    /// Nearest places (n, 2) to points (n, 2), the normals (n, 2) and the arc lengths there.
    fn closest<'py>(
        &self,
        py: Python<'py>,
        places: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Closest<'py>> {
        let feet = self.feet(&places.as_array());
        let nowhere = Point::new(f64::NAN, f64::NAN);
        let pairs = |of: &dyn Fn(&Foot) -> Point| -> Vec<Point> {
            let each = feet.iter().map(Option::as_ref);
            each.map(|foot| foot.map_or(nowhere, of)).collect()
        };
        let along: Vec<f64> = feet
            .iter()
            .map(|foot| foot.map_or(f64::NAN, |foot| self.0.arc_length_of(&foot)))
            .collect();
        Ok((
            points(py, &pairs(&|foot| foot.point))?,
            points(py, &pairs(&|foot| Point::from(foot.normal)))?,
            along.into_pyarray(py),
        ))
    }

    /// Whether points (n, 2) lie in the solid.
    fn contains<'py>(
        &self,
        py: Python<'py>,
        places: PyReadonlyArray2<'py, f64>,
    ) -> Bound<'py, PyArray1<bool>> {
        let places = places.as_array();
        let inside: Vec<bool> = rows(&places).map(|place| self.0.contains(place)).collect();
        inside.into_pyarray(py)
    }

    /// Points (n, 2) of a polyline that stands off by no more than a tolerance.
    fn outline<'py>(&self, py: Python<'py>, tolerance: f64) -> PyResult<Bound<'py, PyArray2<f64>>> {
        points(py, &self.0.polyline(tolerance).or_raise()?)
    }
}

impl Profile {
    fn feet(&self, places: &ArrayView2<'_, f64>) -> Vec<Option<Foot>> {
        let nearest = |place| self.0.nearest(place, f64::INFINITY);
        rows(places).map(nearest).collect()
    }
}

fn rows(places: &ArrayView2<'_, f64>) -> impl Iterator<Item = Point> {
    let (x, y) = (places.column(0), places.column(1));
    x.into_iter()
        .zip(y)
        .map(|(&x, &y)| Point::new(x, y))
        .collect::<Vec<_>>()
        .into_iter()
}
