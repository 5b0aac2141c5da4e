//! What a list of edits is refused for, and warned of: by line.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests may")]

mod scene;

use scene::{edited, head, of};
use wrinkle_edit::{Editor, Edits, Error, Head, Params};

/// Lists without their first line, the line at fault, and what is said of it.
const FAULTS: &[(&str, usize, &str)] = &[
    ("merge a b", 2, "'merge' is no edit"),
    ("scale depth", 2, "write: scale depth|width FACTOR"),
    ("scale height 2", 2, "'height' cannot be scaled"),
    ("scale depth twice", 2, "'twice' is no number"),
    ("scale depth nan", 2, "'nan' is no number"),
    ("scale depth -1", 2, "the factor -1 is out of range"),
    ("scale width 0", 2, "no width"),
    ("\nscale depth 2 of brow_9", 3, "no wrinkle 'brow_9'; there are brow_1, brow_2, smile"),
    ("scale depth 2 of brow_1,chin*", 2, "no wrinkle 'chin*'"),
    ("scale depth 2 in w9", 2, "no camera 'w9'; there are w1, w2"),
    ("scale depth 2 brow_1", 2, "'brow_1' is not expected"),
    ("scale depth 2 of brow_1 of brow_2", 2, "'of' stands twice"),
    ("scale depth 2 of", 2, "nothing follows 'of'"),
    ("scale depth 2 frames 9-3", 2, "'9-3' is no range"),
    ("scale depth 2 frames 1002-1004", 2, "no frame in 1002-1004"),
    ("scale depth 2 ease 3", 2, "name them: frames A-B"),
    ("scale depth 2 frames 1001-1004 ease 3", 2, "eases over 6 frames"),
    ("set colour 2", 2, "'colour' cannot be set"),
    ("set kappa 1", 2, "kappa 1 is out of range"),
    ("set width 0", 2, "not positive"),
    ("delete smile\nscale depth 2 of smile", 3, "no wrinkle 'smile'"),
    ("rename smile grin\nrename smile laugh", 3, "no wrinkle 'smile'"),
    ("rename brow_1 brow_2", 2, "there is a wrinkle 'brow_2' already"),
    ("rename smile brow_1 frames 1005", 2, "frame 1005, camera w1: there is a wrinkle brow_1 already"),
    ("rename smile smile", 2, "its name already"),
    ("swap smile smile", 2, "with itself"),
    ("copy smile from 1005", 2, "'frames' is missing"),
    ("copy smile from 1006 frames 1009", 2, "no image of frame 1006"),
    (
        "draw smile in w1 at 1001 through 1,1 30,1 width 2 depth 1",
        2,
        "frame 1001, camera w1: there is a wrinkle smile",
    ),
    ("draw new in w1 at 1002 through 1,1 30,1 width 2 depth 1", 2, "no image of frame 1002 in w1"),
    ("draw new in w1,w2 at 1001 through 1,1 30,1 width 2 depth 1", 2, "one camera"),
    ("draw new in w1 at 1001 through 1,1 width 2 depth 1", 2, "2 to 1000 places"),
    ("draw new in w1 at 1001 through 1,1 1,1 width 2 depth 1", 2, "lie apart"),
    ("draw new in w1 at 1001 through 1,1 3 width 2 depth 1", 2, "'3' is no place"),
    ("draw new in w1 at 1001 through 1,1 30,1 width 2", 2, "a width and a depth"),
    ("key new in w1 at 1001 through 1,1 30,1", 2, "no line before draws new"),
    (
        "draw new in w1 at 1001 through 1,1 30,1 width 2 depth 1\nkey new in w1 at 1005 through 1,1 9,2 30,1",
        3,
        "5 control points, but 4",
    ),
    (
        "draw new in w1 at 1001 through 1,1 30,1 width 2 depth 1\ndraw new in w1 at 1005 through 1,1 30,1 width 2 depth 1",
        3,
        "was drawn in camera w1 in line 2",
    ),
];

#[test]
fn faults_name_their_line() {
    for &(list, line, word) in FAULTS {
        match edited(list) {
            Err(Error::Edit { line: found, what }) => {
                assert_eq!(found, line, "{list}: {what}");
                assert!(what.contains(word), "{list}: {what}");
            }
            other => panic!("{list}: {other:?}"),
        }
    }
    for (text, word) in [
        ("scale depth 2", "must begin with a line 'wrinkle-edits/1'"),
        ("wrinkle-edits/2", "reads wrinkle-edits/1"),
    ] {
        let error = Edits::parse(text, &head()).unwrap_err();
        assert!(matches!(&error, Error::Edit { line: 1, what } if what.contains(word)), "{error}");
    }
    let sharp = Head { profile: artifact::Profile::S, ..head() };
    assert!(Edits::parse("wrinkle-edits/1\nset epsilon 0.2", &sharp).is_err());
    assert!(Editor::new(&Edits::parse("", &sharp).unwrap(), &Params { step_px: 0.0 }).is_err());
}

#[test]
fn what_changes_nothing_is_said() {
    let (_, warnings) = edited("scale depth 2 of smile in w2").unwrap();
    assert!(warnings[0].contains("line 2: changes nothing"), "{warnings:?}");
    let (after, warnings) =
        edited("draw new in w1 at 1005 through 1,1 30,1 width 2 depth 1 follow smile").unwrap();
    assert!(warnings[0].contains("left out in 1 images"), "{warnings:?}");
    assert!(of(&after, 1009, "w1", "new").is_none() && of(&after, 1013, "w1", "new").is_some());
}
