//! Laws of the comparisons: known differences are found where they are, equal things do not differ.

use artifact_diff::{
    Error, Region, Samples, SequenceDiff, Summary, compare_images, compare_meshes, compare_samples,
};
use image::{DynamicImage, GrayImage, ImageBuffer, Luma, RgbImage};
use mesh::{Label, LabelKind, Mesh};
use nalgebra::{Point3, Vector2, Vector3};
use proptest::prelude::*;

/// A strip of `count` vertices, 1 mm apart.
fn strip(count: u32) -> Mesh {
    let positions = (0..count).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.0]).collect();
    let triangles: Vec<[u32; 3]> = (0..count - 2).map(|i| [i, i + 1, i + 2]).collect();
    Mesh::from_triangles(positions, &triangles)
}

#[test]
fn a_planted_difference_is_found_where_it_is() {
    let mesh = strip(100);
    let mut other = mesh.clone();
    other.positions[41].z = 3.0;
    other.positions[77].y += 4.0;
    let regions = [
        Region { name: "low".into(), vertices: (0..50).collect() },
        Region { name: "calm".into(), vertices: vec![5, 90] },
    ];
    let report = compare_meshes(&mesh, &other, &regions).unwrap();
    let all = report.whole();
    assert_eq!((all.count, all.max, all.max_at.as_str()), (100, 4.0, "vertex 77"));
    assert!((all.mean - 0.07).abs() < 1e-15 && (all.rms - 0.5).abs() < 1e-15);
    assert_eq!(report.regions[0].summary.max_at, "vertex 41");
    assert_eq!(report.regions[1].summary.max, 0.0);
    assert_eq!(report.structure, Vec::<String>::new());
}

#[test]
fn regions_decide_where_they_are_given() {
    let mesh = strip(10);
    let mut other = mesh.clone();
    other.positions[9].z = 2.0;
    let excess = |vertices: Vec<u32>, tolerance| {
        let regions = [Region { name: "lips".into(), vertices }];
        compare_meshes(&mesh, &other, &regions).unwrap().excess(tolerance)
    };
    assert_eq!(excess(vec![1, 2], 0.5), None);
    assert_eq!(
        excess(vec![1, 9], 0.5).unwrap(),
        "2.000 mm at vertex 9 of region lips: 1.500 mm more than the 0.5 mm allowed"
    );
    assert_eq!(excess(vec![1, 9], 2.0), None, "the tolerance itself passes");
    assert!(
        compare_meshes(&mesh, &other, &[])
            .unwrap()
            .excess(1.0)
            .unwrap()
            .starts_with("2.000 mm at vertex 9: ")
    );
    let beyond = [Region { name: "lips".into(), vertices: vec![10] }];
    assert_eq!(
        compare_meshes(&mesh, &other, &beyond),
        Err(Error::Region { region: "lips".into(), vertex: 10, count: 10 })
    );
}

#[test]
fn what_no_number_says_is_said_in_words() {
    let mesh = strip(6);
    let mut other = Mesh::from_triangles(Vec::new(), &[[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 4, 5]]);
    other.positions.clone_from(&mesh.positions);
    other.uvs = vec![Vector2::new(0.0, 0.0)];
    other.corner_uvs = vec![0; 12];
    other.labels = vec![Label { first_face: 0, kind: LabelKind::Group, name: "lips".into() }];
    let report = compare_meshes(&mesh, &other, &[]).unwrap();
    let expected = [
        "1 of 4 faces name other vertices, the first is face 1",
        "only the second has texture coordinates",
        "the groups differ",
    ];
    assert_eq!(report.structure, expected);
    let mut moved = other.clone();
    moved.uvs[0].x = 0.25;
    let report = compare_meshes(&other, &moved, &[]).unwrap();
    assert_eq!(report.structure, ["texture coordinates differ at 12 corners, by up to 0.25"]);
    assert_eq!(compare_meshes(&mesh, &strip(7), &[]), Err(Error::VertexCount { count: 6, other: 7 }));
}

#[test]
fn percentiles_are_by_nearest_rank() {
    let values: Vec<f64> = (1..=21).rev().map(f64::from).collect();
    let summary = Summary::of(&values, |at| format!("#{at}"));
    assert_eq!((summary.p95, summary.max, summary.max_at.as_str()), (20.0, 21.0, "#0"));
    assert_eq!(Summary::of(&[], |_| String::new()).count, 0);
}

fn samples(ids: &[&str], frames: &[(i64, &[Option<f64>])]) -> Samples {
    let vectors =
        |values: &[Option<f64>]| values.iter().map(|x| x.map(|x| Vector3::new(x, 0.0, 0.0))).collect();
    Samples {
        ids: ids.iter().map(ToString::to_string).collect(),
        frames: frames.iter().map(|(frame, values)| (*frame, vectors(values))).collect(),
    }
}

#[test]
fn markers_meet_by_id_and_frame() {
    let one = samples(
        &["a", "b", "x"],
        &[
            (1, &[Some(1.0), Some(2.0), Some(9.0)]),
            (2, &[Some(1.0), None, None]),
            (5, &[Some(1.0), Some(2.0), None]),
        ],
    );
    let two = samples(
        &["b", "a"],
        &[(2, &[Some(2.0), Some(1.0)]), (5, &[Some(2.5), Some(1.0)]), (6, &[None, None])],
    );
    let report = compare_samples(&one, &two, "marker").unwrap();
    assert_eq!((report.whole().count, report.whole().max), (3, 0.5));
    assert_eq!(report.whole().max_at, "frame 5, marker b");
    assert_eq!(report.details[1].summary.max_at, "frame 5");
    assert_eq!(
        report.structure,
        [
            "only the first has the markers x",
            "frame 1 is only in the first",
            "frame 6 is only in the second",
            "1 marker samples are only in the second, missing in the other",
        ]
    );
    assert_eq!(compare_samples(&one, &samples(&["q"], &[]), "marker"), Err(Error::NothingShared("marker")));
    assert_eq!(compare_samples(&one, &samples(&["a"], &[]), "marker"), Err(Error::NothingShared("frame")));
}

#[test]
fn images_are_compared_in_their_own_levels() {
    let image = RgbImage::new(4, 3);
    let mut other = image.clone();
    other.get_pixel_mut(2, 1).0 = [0, 7, 3];
    let report = compare_images(&DynamicImage::from(image.clone()), &DynamicImage::from(other)).unwrap();
    assert_eq!((report.whole().count, report.whole().max), (36, 7.0));
    assert_eq!(report.whole().max_at, "pixel 2, 1, green");
    let deep = |level: u16| DynamicImage::from(ImageBuffer::from_pixel(4, 3, Luma([level])));
    let report = compare_images(&deep(65535), &deep(0)).unwrap();
    assert_eq!((report.unit, report.whole().mean, report.whole().p95), ("levels", 65535.0, 65535.0));
    let gray = DynamicImage::from(GrayImage::new(4, 3));
    let format = |text: &str| text.to_string();
    assert_eq!(
        compare_images(&gray, &deep(0)),
        Err(Error::PixelFormat { format: format("8-bit gray"), other: format("16-bit gray") })
    );
    let wide = DynamicImage::from(RgbImage::new(5, 3));
    assert_eq!(compare_images(&image.into(), &wide), Err(Error::ImageSize { size: [4, 3], other: [5, 3] }));
}

#[test]
fn of_equal_maxima_the_first_is_named() {
    let (rest, raised) = (vec![Point3::origin(); 3], vec![Point3::new(0.0, 2.0, 0.0); 3]);
    let regions = [Region { name: "last".into(), vertices: vec![2] }];
    let mut diff = SequenceDiff::new(3, &regions).unwrap();
    diff.add(4, &rest, &rest).unwrap();
    diff.add(5, &rest, &raised).unwrap();
    diff.add(6, &rest, &raised).unwrap();
    let report = diff.finish(&[], &[]).unwrap();
    assert_eq!(report.whole().max_at, "frame 5, vertex 0");
    assert_eq!(report.regions[0].summary.max_at, "frame 5, vertex 2");
    assert!(SequenceDiff::new(2, &regions).is_err());
}

proptest! {
    #[test]
    fn sequences_give_what_one_long_list_gives(
        frames in prop::collection::vec(prop::collection::vec(0.0..20.0f64, 30), 1..6),
    ) {
        let rest = vec![Point3::origin(); 30];
        let mut diff = SequenceDiff::new(30, &[]).unwrap();
        for (frame, heights) in frames.iter().enumerate() {
            let raised: Vec<Point3<f64>> = heights.iter().map(|&z| Point3::new(0.0, 0.0, z)).collect();
            diff.add(frame as i64 + 1001, &rest, &raised).unwrap();
        }
        let report = diff.finish(&[], &[7, 9]).unwrap();
        let list = frames.concat();
        let exact = Summary::of(&list, |at| format!("frame {}, vertex {}", 1001 + at / 30, at % 30));
        let found = report.whole();
        prop_assert_eq!((found.count, found.max, &found.max_at), (exact.count, exact.max, &exact.max_at));
        prop_assert!((found.mean - exact.mean).abs() < 1e-12 && (found.rms - exact.rms).abs() < 1e-12);
        prop_assert!((found.p95 - exact.p95).abs() <= 0.0026 * exact.p95, "{} against {}", found.p95, exact.p95);
        prop_assert_eq!(&report.structure, &["2 frames between 7 and 9 are only in the second"]);
    }

    #[test]
    fn order_of_the_two_does_not_matter(moves in prop::collection::vec(prop::array::uniform3(-5.0..5.0f64), 12)) {
        let mesh = strip(12);
        let mut other = mesh.clone();
        for (point, by) in other.positions.iter_mut().zip(moves) {
            *point += Vector3::from(by);
        }
        let (there, back) = (compare_meshes(&mesh, &other, &[]).unwrap(), compare_meshes(&other, &mesh, &[]).unwrap());
        prop_assert_eq!(there, back);
        prop_assert_eq!(compare_meshes(&other, &other, &[]).unwrap().excess(0.0), None);
    }
}
