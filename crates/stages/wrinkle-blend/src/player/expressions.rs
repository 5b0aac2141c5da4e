//! The six basis expressions [DutreveMeyer2011, Fig. 7], put together from whatever poses a character has.

use serde::Serialize;

/// An expression as a sum of poses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Expression {
    /// Its name.
    pub name: String,
    /// Per pose of the character how much of it.
    pub weights: Vec<f64>,
    /// What the character lacks for it, in words; empty where it has all.
    pub lacks: Vec<String>,
}

/// An expression that the user puts together: a name, and poses with their shares.
#[derive(Debug, Clone, PartialEq)]
pub struct Mix {
    /// Its name.
    pub name: String,
    /// Ids of poses and how much of each.
    pub parts: Vec<(String, f64)>,
}

/// A part of the face that moves in a way that has a name.
struct Role {
    /// In words.
    what: &'static str,
    /// Parts of ids of poses, in small letters and digits only.
    words: &'static [&'static str],
}

const BROWS_UP: Role = Role {
    what: "raised brows",
    words: &["browsup", "browup", "browraise", "raisebrow", "raisedbrow", "foreheadup"],
};
const FROWN: Role =
    Role { what: "a frown", words: &["frown", "browsdown", "browdown", "browlower", "corrugator"] };
const SMILE: Role =
    Role { what: "a smile", words: &["smile", "cornerpull", "cheekup", "cheekraise", "grin"] };
const SNARL: Role = Role { what: "a wrinkled nose", words: &["snarl", "nosewrinkl", "sneer", "noseup"] };
const JAW: Role = Role { what: "an open jaw", words: &["jawopen", "jawdrop", "mouthopen", "jawdown"] };
const MOUTH_DOWN: Role = Role {
    what: "lowered corners of the mouth",
    words: &["mouthdown", "cornerdepress", "lipsdown", "mouthfrown"],
};

/// An expression: what it cannot do without, and what helps where it is there.
struct Recipe {
    name: &'static str,
    needs: &'static [(&'static Role, f64)],
    helps: &'static [(&'static Role, f64)],
}

const RECIPES: [Recipe; 6] = [
    Recipe { name: "joy", needs: &[(&SMILE, 0.9)], helps: &[] },
    Recipe { name: "sadness", needs: &[(&FROWN, 0.5), (&BROWS_UP, 0.35)], helps: &[(&MOUTH_DOWN, 0.7)] },
    Recipe { name: "anger", needs: &[(&FROWN, 1.0)], helps: &[(&SNARL, 0.35)] },
    Recipe { name: "fear", needs: &[(&BROWS_UP, 0.85), (&FROWN, 0.55)], helps: &[(&JAW, 0.3)] },
    Recipe { name: "disgust", needs: &[(&SNARL, 0.9)], helps: &[(&FROWN, 0.4)] },
    Recipe { name: "surprise", needs: &[(&BROWS_UP, 1.0)], helps: &[(&JAW, 0.6)] },
];

impl Role {
    /// The pose of that name, the first if several have it.
    fn find(&self, poses: &[String]) -> Option<usize> {
        poses.iter().position(|id| {
            let plain: String =
                id.to_lowercase().chars().filter(|letter| letter.is_ascii_alphanumeric()).collect();
            self.words.iter().any(|word| plain.contains(word))
        })
    }
}

/// The six, by the names of the poses.
pub(crate) fn basis(poses: &[String]) -> Vec<Expression> {
    let cook = |recipe: &Recipe| {
        let mut weights = vec![0.0; poses.len()];
        let mut add = |(role, share): &(&Role, f64)| match role.find(poses) {
            Some(pose) => {
                weights[pose] = *share;
                None
            }
            None => Some(role.what.to_string()),
        };
        let lacks = recipe.needs.iter().filter_map(&mut add).collect();
        recipe.helps.iter().for_each(|part| drop(add(part)));
        Expression { name: recipe.name.into(), weights, lacks }
    };
    RECIPES.iter().map(cook).collect()
}

/// The six, and the user's own, which take the place of those of their name.
pub(crate) fn all(poses: &[String], own: &[Mix]) -> Vec<Expression> {
    let mut all = basis(poses);
    for mix in own {
        let of_pose = |id: &String| mix.parts.iter().filter(|(part, _)| part == id).map(|part| part.1).sum();
        let made = Expression {
            name: mix.name.clone(),
            weights: poses.iter().map(of_pose).collect(),
            lacks: vec![],
        };
        match all.iter_mut().find(|other| other.name == mix.name) {
            Some(other) => *other = made,
            None => all.push(made),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_string()).collect()
    }

    #[test]
    fn the_six_come_of_four_poses() {
        let found = basis(&ids(&["brows-up", "Frown_01", "smile", "Nose.Wrinkler"]));
        assert_eq!(found.len(), 6);
        assert!(found.iter().all(|expression| expression.lacks.is_empty()), "{found:?}");
        assert_eq!(found[3].weights, [0.85, 0.55, 0.0, 0.0]);
        assert_eq!(found[4].weights, [0.0, 0.4, 0.0, 0.9]);
    }

    #[test]
    fn what_is_not_there_is_said_and_can_be_given() {
        let poses = ids(&["smile", "x"]);
        let found = basis(&poses);
        assert_eq!(found[3].lacks, ["raised brows", "a frown"]);
        assert!(found[0].lacks.is_empty());
        let own = [
            Mix { name: "fear".into(), parts: vec![("x".into(), 0.5)] },
            Mix { name: "wink".into(), parts: vec![] },
        ];
        let found = all(&poses, &own);
        assert_eq!((found[3].weights.as_slice(), found[3].lacks.len()), (&[0.0, 0.5][..], 0));
        assert_eq!(found[6].name, "wink");
    }
}
