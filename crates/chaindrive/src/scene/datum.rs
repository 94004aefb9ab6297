//! Looks up single values of a scene, as they were understood: quantities in SI units.

use super::path::steps;
use super::tree::Value;
use super::{Scene, format, validate};

/// A value of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Datum {
    /// A number in the SI unit beside it; "1" for pure numbers.
    Quantity(f64, &'static str),
    /// A whole number, such as a number of teeth.
    Whole(i64),
    /// A word, a text or a truth value.
    Text(String),
}

impl Scene {
    /// The value at a path, see [`Scene::replace`]; `None` where the scene has none, or a table or list.
    ///
    /// ```
    /// use chaindrive::scene::{Datum, Scene};
    ///
    /// let scene = Scene::preset("marine_engine")?;
    /// let pretension = scene.datum("route.pretension");
    /// assert_eq!(pretension, Some(Datum::Quantity(15e3, "N"))); // written as "15 kN"
    /// # Ok::<(), chaindrive::scene::SceneError>(())
    /// ```
    pub fn datum(&self, path: &str) -> Option<Datum> {
        let (place, _) = self.tree.locate(path);
        let mut tree = self.tree.clone();
        tree.expand_chain();
        let units = validate::units(&mut tree, format::raw());
        let unit = units.get(&place).copied();
        match &tree.find(path)?.value {
            Value::Float(number) => Some(Datum::Quantity(*number, unit.unwrap_or("1"))),
            Value::Integer(number) => Some(match unit {
                Some(unit) => Datum::Quantity(*number as f64, unit),
                None => Datum::Whole(*number),
            }),
            Value::Text(text) => Some(Datum::Text(text.clone())),
            Value::Truth(truth) => Some(Datum::Text(truth.to_string())),
            Value::List(_) | Value::Table(_) | Value::Date => None,
        }
    }

    /// Whether a place is another one, or lies in it: what is put at `outer` takes the place of what is at `inner`.
    ///
    /// ```
    /// use chaindrive::Scene;
    ///
    /// let scene = Scene::preset("marine_engine")?;
    /// assert!(scene.encloses("sprockets.crank", "sprockets[0].teeth"));
    /// assert!(!scene.encloses("sprockets[0].teeth", "sprockets.crank"));
    /// # Ok::<(), chaindrive::scene::SceneError>(())
    /// ```
    pub fn encloses(&self, outer: &str, inner: &str) -> bool {
        let (outer, inner) = (self.place(outer), self.place(inner));
        steps(&inner).zip(steps(&outer)).all(|(a, b)| a == b)
            && steps(&outer).count() <= steps(&inner).count()
    }

    /// A path in its written form, with entries of lists by index: what two names of one place share.
    pub(crate) fn place(&self, path: &str) -> String {
        self.tree.locate(path).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_as_they_were_understood() {
        let scene = Scene::preset("marine_engine_bare").unwrap();
        let scene = scene
            .replace("sprockets.crank.motion.speed", "-60 rpm")
            .unwrap();
        let turn = -2.0 * std::f64::consts::PI;
        let Some(Datum::Quantity(speed, "rad/s")) = scene.datum("sprockets[0].motion.speed") else {
            panic!("a speed");
        };
        assert!((speed - turn).abs() < 1e-14);
        assert_eq!(scene.datum("chain.links"), Some(Datum::Whole(122)));
        assert_eq!(
            scene.datum("sprockets.crank.motion.kind"),
            Some(Datum::Text("constant".into()))
        );
        assert_eq!(scene.datum("sprockets.crank.motion"), None);
        assert_eq!(scene.datum("sprockets.crnk.teeth"), None);
    }
}
