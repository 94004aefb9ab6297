//! Whole profiles of bodies, asked about points.

use chaindrive_geometry::{ArcSpline, Foot, Point};
use numpy::ndarray::ArrayView2;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::drawing::points;
use crate::errors::OrRaise;

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

#[pymethods]
impl Profile {
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
