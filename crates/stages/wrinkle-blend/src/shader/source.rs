//! The equations [DutreveMeyer2011, Eq. 4–8], once.

use super::expression::Type::{Float, Vec3};
use super::expression::{Expression, Function, call, name, vector};
use crate::map::{LEAST_Z, SNAP};

/// All functions; each uses only those before it.
pub(super) fn functions() -> Vec<Function> {
    vec![
        bone_share(),
        modulation(),
        bone_counts(),
        bone_counts_paper(),
        snap(),
        decode_normal(),
        weighted_normal(),
        add_wrinkle(),
        wrinkled_normal(),
    ]
}

fn bone_share() -> Function {
    let (ab, ac) = (name("ab"), name("ac"));
    Function {
        name: "bone_share",
        doc: &[
            "Eq. 4: how much of its way to a reference pose a bone went. ab: from neutral to now, ac: from neutral to the",
            "pose, both of the same point of the bone in the space of the head.",
        ],
        parameters: &[("ab", Vec3), ("ac", Vec3)],
        returns: Float,
        lets: vec![],
        result: call(
            "clamp",
            [call("dot", [ab, ac.clone()]) / call("dot", [ac.clone(), ac]), 0.0.into(), 1.0.into()],
        ),
    }
}

fn modulation() -> Function {
    Function {
        name: "modulation",
        doc: &["Eq. 6: the share of the wrinkles over the share of the way."],
        parameters: &[("x", Float)],
        returns: Float,
        lets: vec![],
        result: 0.5 * (call("cos", [std::f32::consts::PI * (1.0 + name("x"))]) + 1.0),
    }
}

fn bone_counts() -> Function {
    let x = name("x");
    Function {
        name: "bone_counts",
        doc: &[
            "How much a bone counts for a vertex, over its skin weight. The weight of a pose's map at a vertex is the sum of",
            "bone_counts * modulation(bone_share) over the bones of the pose, divided by max(1, sum of bone_counts over them).",
        ],
        parameters: &[("skin_weight", Float)],
        returns: Float,
        lets: vec![("x", Float, call("min", [4.0 * name("skin_weight"), 1.0.into()]))],
        result: x.clone() * x.clone() * (3.0 - 2.0 * x),
    }
}

fn bone_counts_paper() -> Function {
    Function {
        name: "bone_counts_paper",
        doc: &[
            "Eq. 5: the paper's own; the weight of a map is then min(1, sum of bone_counts_paper * modulation(bone_share)).",
        ],
        parameters: &[("skin_weight", Float)],
        returns: Float,
        lets: vec![],
        result: call("step", [1e-6.into(), name("skin_weight")]),
    }
}

fn snap() -> Function {
    Function {
        name: "snap",
        doc: &["No 8-bit code says 0: what flat maps say instead would add up."],
        parameters: &[("x", Float)],
        returns: Float,
        lets: vec![],
        result: name("x") * call("step", [SNAP.into(), call("abs", [name("x")])]),
    }
}

fn decode_normal() -> Function {
    Function {
        name: "decode_normal",
        doc: &["A texel of a normal map (linear, not sRGB; green up)."],
        parameters: &[("texel", Vec3)],
        returns: Vec3,
        lets: vec![],
        result: vector(["x", "y", "z"].map(|axis| {
            let texel = name("texel");
            let part = match axis {
                "x" => texel.x(),
                "y" => texel.y(),
                _ => texel.z(),
            };
            2.0 * part - 1.0
        })),
    }
}

fn weighted_normal() -> Function {
    let (n, w) = (name("n"), name("w"));
    Function {
        name: "weighted_normal",
        doc: &["Eq. 7: eta = (0, 0, 1) + w (n - (0, 0, 1)), never flatter than it makes sense."],
        parameters: &[("n", Vec3), ("w", Float)],
        returns: Vec3,
        lets: vec![],
        result: vector([
            w.clone() * call("snap", [n.clone().x()]),
            w.clone() * call("snap", [n.clone().y()]),
            call("max", [1.0 + w * (n.z() - 1.0), LEAST_Z.into()]),
        ]),
    }
}

fn add_wrinkle() -> Function {
    let (sum, eta) = (name("sum"), name("eta"));
    Function {
        name: "add_wrinkle",
        doc: &[
            "Eq. 8 for one map: x and y add, z multiply. Start with the neutral normal, add map by map, then normalize.",
        ],
        parameters: &[("sum", Vec3), ("eta", Vec3)],
        returns: Vec3,
        lets: vec![],
        result: vector([
            sum.clone().x() + eta.clone().x(),
            sum.clone().y() + eta.clone().y(),
            sum.z() * eta.z(),
        ]),
    }
}

fn wrinkled_normal() -> Function {
    let add = |sum: Expression, n, w| call("add_wrinkle", [sum, call("weighted_normal", [name(n), name(w)])]);
    Function {
        name: "wrinkled_normal",
        doc: &[
            "Eq. 8 for two maps: the tangent-space normal of the wrinkled skin. Normals are decoded, weights are interpolated",
            "between vertices.",
        ],
        parameters: &[("neutral", Vec3), ("n1", Vec3), ("n2", Vec3), ("w1", Float), ("w2", Float)],
        returns: Vec3,
        lets: vec![("first", Vec3, add(name("neutral"), "n1", "w1"))],
        result: call("normalize", [add(name("first"), "n2", "w2")]),
    }
}
