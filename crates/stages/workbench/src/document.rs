//! The files that pages edit.

/// A file of a take's folder that a page edits.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Document {
    /// Which dot is which marker, in one frame of each camera.
    Labels,
    /// Where the markers sit on the scan.
    Picks,
    /// The paint of one image of a camera, marked.
    Paint(String),
    /// Names of the wrinkles.
    Names,
    /// Landmarks of a photograph.
    Landmarks(String),
    /// A mask over a photograph or over texture coordinates.
    Mask(String),
    /// Vertices of the scan.
    Region(String),
    /// Corrections of measured wrinkles.
    Edits,
}

/// What a document's bytes are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// An artifact, which pages see as JSON.
    Artifact,
    /// A table or a list of commands, as people write it.
    Text,
    /// A picture, PNG.
    Picture,
}

/// Folder of a take for what is not finished, and for what was there before.
const ASIDE: &str = ".workbench";

impl Document {
    /// The document of an id, `labels` or `paint/<camera>`; none if there is no such document.
    #[must_use]
    pub fn of(id: &str) -> Option<Self> {
        match id.split_once('/') {
            None => match id {
                "labels" => Some(Self::Labels),
                "picks" => Some(Self::Picks),
                "names" => Some(Self::Names),
                "edits" => Some(Self::Edits),
                _ => None,
            },
            Some((kind, name)) if is_plain(name) => match kind {
                "paint" => Some(Self::Paint(name.to_string())),
                "landmarks" => Some(Self::Landmarks(name.to_string())),
                "mask" => Some(Self::Mask(name.to_string())),
                "region" => Some(Self::Region(name.to_string())),
                _ => None,
            },
            Some(_) => None,
        }
    }

    /// Its id.
    #[must_use]
    pub fn id(&self) -> String {
        match self {
            Self::Labels => "labels".to_string(),
            Self::Picks => "picks".to_string(),
            Self::Names => "names".to_string(),
            Self::Edits => "edits".to_string(),
            Self::Paint(camera) => format!("paint/{camera}"),
            Self::Landmarks(photograph) => format!("landmarks/{photograph}"),
            Self::Mask(name) => format!("mask/{name}"),
            Self::Region(name) => format!("region/{name}"),
        }
    }

    /// Where it is in the take's folder.
    #[must_use]
    pub fn path(&self) -> String {
        match self {
            Self::Labels => "labels.json".to_string(),
            Self::Picks => "picks.csv".to_string(),
            Self::Names => "wrinkles.csv".to_string(),
            Self::Edits => "wrinkle-edits.txt".to_string(),
            Self::Paint(camera) => format!("paint-mask/{camera}.png"),
            Self::Landmarks(photograph) => format!("photographs/{photograph}.landmarks.json"),
            Self::Mask(name) => format!("masks/{name}.png"),
            Self::Region(name) => format!("regions/{name}.json"),
        }
    }

    /// Where a page keeps what is not saved yet.
    #[must_use]
    pub fn draft(&self) -> String {
        format!("{ASIDE}/draft/{}", self.path())
    }

    /// Where the version before the last save is.
    #[must_use]
    pub fn previous(&self) -> String {
        format!("{ASIDE}/previous/{}", self.path())
    }

    /// What its bytes are.
    #[must_use]
    pub fn form(&self) -> Form {
        match self {
            Self::Labels | Self::Landmarks(_) | Self::Region(_) => Form::Artifact,
            Self::Picks | Self::Names | Self::Edits => Form::Text,
            Self::Paint(_) | Self::Mask(_) => Form::Picture,
        }
    }
}

/// Whether a name can stand in a file name anywhere: letters, digits, `_`, `-` and dots, the first one no dot.
fn is_plain(name: &str) -> bool {
    let plain = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.');
    !name.is_empty() && name.len() <= 100 && !name.starts_with('.') && name.chars().all(plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_lead_to_documents_and_back() {
        for id in [
            "labels",
            "picks",
            "names",
            "edits",
            "paint/w1",
            "landmarks/neutral",
            "mask/brow.soft",
            "region/neck",
        ] {
            let document = Document::of(id).unwrap();
            assert_eq!(document.id(), id);
            assert!(document.draft().ends_with(&document.path()) && document.previous() != document.draft());
        }
    }

    #[test]
    fn names_stay_in_the_folder() {
        for id in [
            "",
            "paint",
            "paint/",
            "paint/..",
            "paint/../labels",
            "paint/.hidden",
            "paint/a\\b",
            "paint/a b",
            "other/x",
        ] {
            assert_eq!(Document::of(id), None, "{id}");
        }
    }
}
