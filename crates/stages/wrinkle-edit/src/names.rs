//! Names of wrinkles, in the list of all and in images: added, changed, exchanged, taken out.

use crate::moment::Moment;
use artifact::Wrinkle;

/// Adds a wrinkle to the list, if it is not there.
pub(crate) fn add(wrinkles: &mut Vec<Wrinkle>, id: &str, paint: Option<String>) {
    if wrinkles.iter().all(|wrinkle| wrinkle.id != id) {
        wrinkles.push(Wrinkle { id: id.to_string(), paint });
    }
}

/// Gives a wrinkle another name; where only some of its images have it, there are two.
pub(crate) fn rename(wrinkles: &mut Vec<Wrinkle>, from: &str, to: &str, everywhere: bool) {
    let Some(wrinkle) = wrinkles.iter_mut().find(|wrinkle| wrinkle.id == from) else { return };
    if everywhere {
        wrinkle.id = to.to_string();
    } else {
        let paint = wrinkle.paint.clone();
        add(wrinkles, to, paint);
    }
}

/// Exchanges the names of two wrinkles.
pub(crate) fn swap(wrinkles: &mut [Wrinkle], ids: &[String]) {
    for wrinkle in wrinkles {
        if let Some(at) = ids.iter().position(|id| *id == wrinkle.id) {
            wrinkle.id.clone_from(&ids[1 - at]);
        }
    }
}

/// Refuses a name that an image has already.
pub(crate) fn refuse_taken(moment: &Moment, camera: &str, id: &str, advice: &str) -> Result<(), String> {
    match moment.shows(camera, id) {
        true => Err(format!("there is a wrinkle {id} already; {advice}")),
        false => Ok(()),
    }
}

/// Takes wrinkles out of an image, and counts them.
pub(crate) fn delete_in(moment: &mut Moment, camera: &str, ids: &[String]) -> usize {
    let shown = ids.iter().filter(|id| moment.shows(camera, id)).count();
    for id in ids {
        moment.take(camera, id);
    }
    shown
}

/// Gives a wrinkle another name in an image, and counts it.
pub(crate) fn rename_in(moment: &mut Moment, camera: &str, from: &str, to: &str) -> Result<usize, String> {
    if !moment.shows(camera, from) {
        return Ok(0);
    }
    refuse_taken(moment, camera, to, "swap the two, or delete one there first")?;
    let (sections, curve) = moment.take(camera, from);
    moment.put(camera, to, sections, curve);
    Ok(1)
}

/// Exchanges the names of two wrinkles in an image, and counts those that are there.
pub(crate) fn swap_in(moment: &mut Moment, camera: &str, ids: &[String]) -> usize {
    let shown = ids.iter().filter(|id| moment.shows(camera, id)).count();
    let taken: Vec<_> = ids.iter().map(|id| moment.take(camera, id)).collect();
    for ((sections, curve), id) in taken.into_iter().zip(ids.iter().rev()) {
        moment.put(camera, id, sections, curve);
    }
    shown
}
