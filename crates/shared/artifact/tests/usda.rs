//! USD point caches as text.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::usda::Writer;
use artifact::{Axis, Consent, Rate, Unit};
use mesh::{Mesh, NO_UV};
use nalgebra::Vector2;
use std::path::Path;
use support::{Place, bytes, refusal, says};

/// A quad and a triangle, in mm.
fn scan() -> Mesh {
    let mut mesh = Mesh::from_triangles(
        vec![[0.0, 0.0, 0.0], [10.0, 0.0, 0.5], [10.0, 10.0, 0.0], [0.0, 10.0, -0.25], [20.0, 5.0, 1e-6]],
        &[],
    );
    mesh.polygons.push(&[0, 1, 2, 3]);
    mesh.polygons.push(&[1, 4, 2]);
    mesh.uvs = vec![Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0), Vector2::new(1.5, 1.25)];
    mesh.corner_uvs = vec![0, 1, 2, 0, NO_UV, NO_UV, NO_UV];
    mesh
}

/// The coordinates of a frame: the rest pose in cm, lifted.
fn frame(lift: f32) -> Vec<f32> {
    scan()
        .positions
        .iter()
        .flat_map(|p| [p.x as f32 / 10.0, p.y as f32 / 10.0, p.z as f32 / 10.0 + lift])
        .collect()
}

fn write(path: &Path) {
    let rate = Some(Rate { frames: 30000, seconds: 1001 });
    let mut writer = Writer::create(path, &scan(), Unit::Cm, Axis::Y, rate).unwrap();
    for (number, lift) in [(-2, 0.0), (1001, 0.1), (1003, -3e7)] {
        writer.write(number, &frame(lift)).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
}

const EXPECTED: &str = r#"#usda 1.0
(
    defaultPrim = "face"
    metersPerUnit = 0.01
    upAxis = "Y"
    framesPerSecond = 29.97002997002997
    timeCodesPerSecond = 29.97002997002997
    startTimeCode = -2
    endTimeCode = 1003
)

def Mesh "face"
{
    uniform token subdivisionScheme = "none"
    int[] faceVertexCounts = [4, 3]
    int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 2]
    float3[] extent = [(0, 0, -0.025), (2, 1, 0.05)]
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (1.5, 1.25), (0, 0)] (
        interpolation = "faceVarying"
    )
    int[] primvars:st:indices = [0, 1, 2, 0, 3, 3, 3]
    point3f[] points = [(0, 0, 0), (1, 0, 0.05), (1, 1, 0), (0, 1, -0.025), (2, 0.5, 1e-7)]
    point3f[] points.timeSamples = {
        -2: [(0, 0, 0), (1, 0, 0.05), (1, 1, 0), (0, 1, -0.025), (2, 0.5, 1e-7)],
        1001: [(0, 0, 0.1), (1, 0, 0.15), (1, 1, 0.1), (0, 1, 0.075), (2, 0.5, 0.1000001)],
        1003: [(0, 0, -30000000), (1, 0, -30000000), (1, 1, -30000000), (0, 1, -30000000), (2, 0.5, -30000000)],
    }
    float3[] extent.timeSamples = {
        -2: [(0, 0, -0.025), (2, 1, 0.05)],
        1001: [(0, 0, 0.075), (2, 1, 0.15)],
        1003: [(0, 0, -30000000), (2, 1, -30000000)],
    }
}
"#;

#[test]
fn a_sequence_is_written_as_usd_has_it() {
    let place = Place::new();
    let path = place.path("face.usda");
    write(&path);
    let text = String::from_utf8(bytes(&path)).unwrap();
    // The range of frames stands in a field of fixed width.
    let trimmed: String = text.lines().map(|line| format!("{}\n", line.trim_end())).collect();
    assert_eq!(trimmed, EXPECTED);
}

#[test]
fn without_rate_and_texture_nothing_is_said_about_them() {
    let place = Place::new();
    let path = place.path("face.usda");
    let mesh = Mesh { uvs: vec![], corner_uvs: vec![], ..scan() };
    let mut writer = Writer::create(&path, &mesh, Unit::M, Axis::Z, None).unwrap();
    writer.write(7, &frame(0.0)).unwrap();
    writer.finish().unwrap().publish().unwrap();
    let text = String::from_utf8(bytes(&path)).unwrap();
    says(
        &text,
        &[
            "metersPerUnit = 1\n",
            "upAxis = \"Z\"",
            "startTimeCode = 7 ",
            "endTimeCode = 7 ",
            "(0.02, 0.005, 1e-9)",
        ],
    );
    assert!(!text.contains("PerSecond") && !text.contains("primvars"), "{text}");
}

#[test]
fn what_makes_no_sequence_is_refused() {
    let place = Place::new();
    let create = |mesh: &Mesh, rate| Writer::create(&place.path("a.usda"), mesh, Unit::Mm, Axis::Y, rate);
    let mut odd = scan();
    odd.positions[3].x = f64::NAN;
    assert_eq!(refusal(create(&odd, None).map(|_| ())), "a.usda, vertex 3: the position is not finite");
    let timeless = Some(Rate { frames: 0, seconds: 1 });
    assert_eq!(
        refusal(create(&scan(), timeless).map(|_| ())),
        "a.usda, rate: 0 frames in 1 seconds is no rate"
    );
    let mut writer = create(&scan(), None).unwrap();
    let mut coordinates = frame(0.0);
    coordinates[5] = f32::INFINITY;
    assert_eq!(
        refusal(writer.write(3, &coordinates)),
        "a.usda, frame 3, vertex 1: the position is not finite"
    );
    writer.write(3, &frame(0.0)).unwrap();
    assert_eq!(refusal(writer.write(3, &frame(0.0))), "a.usda, frame 3: would follow frame 3");
    drop(writer);
    says(&refusal(create(&scan(), None).unwrap().finish()), &["a.usda: would hold no frames"]);
    let message = refusal(Writer::create(Path::new("-"), &scan(), Unit::Mm, Axis::Y, None).map(|_| ()));
    says(&message, &["cannot be written to a pipe"]);
    assert!(place.names().is_empty());
}

fn consent() -> Consent {
    Consent {
        licence: "CC BY 4.0".to_string(),
        credit: Some("© \"Face\" \\ Lab".to_string()),
        notes: Some("two\nlines".to_string()),
    }
}

#[test]
fn consent_travels_with_the_file() {
    let place = Place::new();
    let path = place.path("face.usda");
    let mut writer =
        Writer::create_with_consent(&path, &scan(), Unit::Cm, Axis::Y, None, &consent()).unwrap();
    writer.write(1, &frame(0.0)).unwrap();
    writer.finish().unwrap().publish().unwrap();
    let text = String::from_utf8(bytes(&path)).unwrap();
    let data = "    customLayerData = {\n        string licence = \"CC BY 4.0\"\n        string credit = \"© \\\"Face\\\" \\\\ \
        Lab\"\n        string notes = \"two\\nlines\"\n    }\n    defaultPrim";
    says(&text, &[data, "startTimeCode = 1 ", "endTimeCode = 1 "]);
    let Ok(python) = std::env::var("FURROW_USD_PYTHON") else { return };
    let script = "import sys; from pxr import Sdf; d = Sdf.Layer.FindOrOpen(sys.argv[1]).customLayerData\n\
        assert d == {'licence': 'CC BY 4.0', 'credit': '© \"Face\" \\\\ Lab', 'notes': 'two\\nlines'}, d";
    let output = std::process::Command::new(python).arg("-c").arg(script).arg(&path).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Asks USD itself. It needs Python with `usd-core`, named by `FURROW_USD_PYTHON`.
#[test]
fn usd_reads_the_same_numbers() {
    let Ok(python) = std::env::var("FURROW_USD_PYTHON") else {
        println!("skipped: FURROW_USD_PYTHON names no Python with usd-core");
        return;
    };
    let place = Place::new();
    let path = place.path("face.usda");
    write(&path);
    let script = r#"
import sys
from pxr import Usd, UsdGeom, UsdUtils
stage = Usd.Stage.Open(sys.argv[1])
mesh = UsdGeom.Mesh(stage.GetDefaultPrim())
assert mesh.ValidateTopology(mesh.GetFaceVertexIndicesAttr().Get(), mesh.GetFaceVertexCountsAttr().Get(), 5)[0]
assert UsdGeom.GetStageUpAxis(stage) == 'Y' and UsdGeom.GetStageMetersPerUnit(stage) == 0.01
assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (-2, 1003)
assert stage.GetTimeCodesPerSecond() == 30000 / 1001
st = UsdGeom.PrimvarsAPI(mesh).GetPrimvar('st')
assert st.GetInterpolation() == 'faceVarying' and len(st.ComputeFlattened()) == 7
assert tuple(st.ComputeFlattened()[2]) == (1.5, 1.25)
points = mesh.GetPointsAttr()
assert points.GetTimeSamples() == [-2, 1001, 1003]
for time in [None, *points.GetTimeSamples()]:
    time = Usd.TimeCode.Default() if time is None else time
    box = UsdGeom.PointBased.ComputeExtent(points.Get(time))
    assert list(mesh.GetExtentAttr().Get(time)) == list(box), (time, box)
    print(' '.join(float(x).hex() for point in points.Get(time) for x in point))
"#;
    let output = std::process::Command::new(python).arg("-c").arg(script).arg(&path).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read: Vec<Vec<u64>> = String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(|line| line.split(' ').map(|hex| from_hex(hex).to_bits()).collect())
        .collect();
    let wrote = [frame(0.0), frame(0.0), frame(0.1), frame(-3e7)];
    for (read, wrote) in read.iter().zip(&wrote) {
        assert_eq!(*read, wrote.iter().map(|&x| f64::from(x).to_bits()).collect::<Vec<_>>());
    }
    assert_eq!(read.len(), wrote.len());
}

/// A number as Python's `float.hex` writes it: `-0x1.8p-3`.
fn from_hex(text: &str) -> f64 {
    let (sign, text) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    let (digits, exponent) = text.trim_start_matches("0x").split_once('p').unwrap();
    let (whole, fraction) = digits.split_once('.').unwrap();
    let mantissa = u64::from_str_radix(&format!("{whole}{fraction}"), 16).unwrap() as f64;
    sign * mantissa * 2f64.powi(exponent.parse::<i32>().unwrap() - 4 * fraction.len() as i32)
}
