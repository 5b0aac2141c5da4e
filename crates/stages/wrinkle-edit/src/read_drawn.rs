//! From a line of a list to a drawn wrinkle.

use crate::draw::{Drawn, Key, Shape};
use crate::edit::Edit;
use crate::moment::Head;
use crate::read::{LENGTHS, Line, asymmetry, cameras, followed, frame, rounding, scope_of, width, within};
use crate::spline::{Place, through};
use crate::words::Clauses;
use std::collections::BTreeMap;

/// Places that a wrinkle is drawn by, at most.
const PLACES: usize = 1000;

/// The parts of a key; what is not said is that of the wrinkle's first key.
pub(crate) struct KeyWords {
    pub(crate) controls: Vec<Place>,
    widths: Option<Vec<f64>>,
    depths: Option<Vec<f64>>,
    epsilon: Option<f64>,
    kappa: Option<f64>,
}

impl KeyWords {
    /// With the numbers of another key where none are said.
    pub(crate) fn or(self, first: &Shape) -> Key {
        let shape = Shape {
            widths: self.widths.unwrap_or_else(|| first.widths.clone()),
            depths: self.depths.unwrap_or_else(|| first.depths.clone()),
            epsilon: self.epsilon.unwrap_or(first.epsilon),
            kappa: self.kappa.unwrap_or(first.kappa),
        };
        Key { controls: self.controls, shape }
    }
}

const LOOK: [&str; 8] = ["in", "at", "through", "controls", "width", "depth", "epsilon", "kappa"];

pub(crate) fn draw(id: &str, rest: &[&str], head: &Head) -> Result<Edit, String> {
    let clauses = Clauses::of(rest, &[&LOOK[..], &["frames", "ease", "follow"]].concat())?;
    if id.contains([',', '*', '?']) {
        return Err(format!("'{id}' is no id: commas, * and ? mean something in edits"));
    }
    let look = look(&clauses, head)?;
    let (Some(widths), Some(depths)) = (&look.widths, &look.depths) else {
        return Err("a drawn wrinkle needs a width and a depth, px".into());
    };
    let first = Shape { widths: widths.clone(), depths: depths.clone(), epsilon: 0.0, kappa: 0.0 };
    let mut scope = scope_of(&clauses, vec![id.to_string()], head)?;
    scope.cameras = vec![camera(&clauses, head)?];
    let keys = BTreeMap::from([(frame(&clauses, "at")?, look.or(&first))]);
    Ok(Edit::Draw(Drawn { scope, keys, follow: followed(&clauses, head, &[id])? }))
}

pub(crate) fn key(id: &str, rest: &[&str], head: &Head) -> Result<Line, String> {
    let clauses = Clauses::of(rest, &LOOK)?;
    let look = look(&clauses, head)?;
    Ok(Line::Key(id.to_string(), camera(&clauses, head)?, frame(&clauses, "at")?, look))
}

fn camera(clauses: &Clauses, head: &Head) -> Result<String, String> {
    clauses.needed("in")?;
    match cameras(clauses, head)?.as_slice() {
        [camera] => Ok(camera.clone()),
        _ => Err("a wrinkle is drawn in the image of one camera; draw it in each".into()),
    }
}

fn look(clauses: &Clauses, head: &Head) -> Result<KeyWords, String> {
    let controls = match (clauses.places("through")?, clauses.places("controls")?) {
        (Some(_), Some(_)) => return Err("write either 'through' or 'controls'".into()),
        (Some(places), None) if (2..=PLACES).contains(&places.len()) => through(&places),
        (None, Some(controls)) if (4..=PLACES).contains(&controls.len()) => controls,
        (Some(_), None) => return Err(format!("'through' takes 2 to {PLACES} places")),
        (None, Some(_)) => return Err(format!("'controls' takes 4 to {PLACES} control points")),
        (None, None) => return Err("where is it? write: through X,Y X,Y …".into()),
    };
    let length: f64 = controls.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    if !(1.0..=1e5).contains(&length) {
        return Err(format!("its places make a curve of {length:.1} px; they must lie apart, in px"));
    }
    let numbers = |key: &str, check: &dyn Fn(f64) -> Result<f64, String>| {
        let values = clauses.numbers(key)?;
        values.map(|values| values.into_iter().map(check).collect::<Result<Vec<f64>, String>>()).transpose()
    };
    let one = |values: Option<Vec<f64>>, key: &str| match values.as_deref() {
        None => Ok(None),
        Some([value]) => Ok(Some(*value)),
        Some(_) => Err(format!("'{key}' takes one number")),
    };
    Ok(KeyWords {
        controls,
        widths: numbers("width", &width)?,
        depths: numbers("depth", &|depth| within("the depth", depth, &LENGTHS))?,
        epsilon: one(numbers("epsilon", &|value| rounding(value, head))?, "epsilon")?,
        kappa: one(numbers("kappa", &|value| asymmetry(value, head))?, "kappa")?,
    })
}
