//! Boards and wands: where they are, what they look like, and that a corner finder agrees.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "helpers of tests are tests too; one test writes pictures for OpenCV"
)]

use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Matrix2, Point3, Vector2, Vector3};
use std::collections::BTreeSet;
use virtual_rig::calibration::{
    Board, BoardCamera, BoardLight, BoardViews, CornerInImage, Dictionary, Params, Picture, common_volume,
    corners_in_image, is_seen_whole, render_led, wand_path,
};

/// Six cameras 1 m before a face, as paper A has them, with distortion.
fn rig() -> Vec<Camera> {
    let camera = |i: u32| {
        let (across, up) = (f64::from(i % 3) - 1.0, f64::from(i / 3) - 0.5);
        let eye = Point3::new(450.0 * across, 300.0 * up, 950.0 - 120.0 * across.abs());
        let distortion = BrownConrady { k1: -0.18, k2: 0.09, p1: 8e-4, p2: -5e-4, k3: 0.0 };
        let lens = Lens {
            focal_px: Vector2::new(1150.0 + 10.0 * f64::from(i), 1148.0),
            center_px: Vector2::new(331.2, 241.7),
            distortion,
        };
        let cam_from_world = Camera::pose_looking_at(eye, Point3::new(0.0, 5.0, 0.0), Vector3::y());
        Camera { image_size: [656, 490], lens, cam_from_world }
    };
    (0..6).map(camera).collect()
}

fn charuco() -> Board {
    let dictionary = Dictionary::FourByFour50;
    Board::Charuco { columns: 6, rows: 5, square_mm: 42.0, marker_mm: 33.0, dictionary }
}

fn views(board: Board, count: usize) -> BoardViews {
    BoardViews { board, count, ..BoardViews::default() }
}

/// The picture through a lens that blurs by 0.7 px, as no real lens is sharper: finders of corners need it.
fn blurred(mut picture: Picture) -> Picture {
    let weights: Vec<f32> = (-3..=3_i32).map(|i| (-0.5 * (i as f32 / 0.7).powi(2)).exp()).collect();
    let total: f32 = weights.iter().sum();
    let [width, height] = picture.size.map(i64::from);
    for step in [[1, 0], [0, 1]] {
        let from = picture.radiance.clone();
        for (index, to) in picture.radiance.iter_mut().enumerate() {
            let (x, y) = (index as i64 % width, index as i64 / width);
            *to = std::array::from_fn(|channel| {
                let at = |i: i64| {
                    let x = (x + (i - 3) * step[0]).clamp(0, width - 1);
                    let y = (y + (i - 3) * step[1]).clamp(0, height - 1);
                    from[(y * width + x) as usize][channel]
                };
                (0..7).map(|i| weights[i as usize] / total * at(i)).sum()
            });
        }
    }
    picture
}

fn srgb_code(linear: f32) -> u8 {
    let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded.clamp(0.0, 1.0)).round() as u8
}

/// A corner by the rule that gradients around it are at right angles to the way there, from sRGB codes as a camera
/// would give.
fn find_corner(picture: &Picture, start: Vector2<f64>) -> Vector2<f64> {
    let width = picture.size[0] as usize;
    let code = |x: i64, y: i64| f64::from(srgb_code(picture.radiance[y as usize * width + x as usize][1]));
    // Codes between pixels, so that the window moves with the corner.
    let at = |p: Vector2<f64>| {
        let (x, y) = (p.x.floor(), p.y.floor());
        let (u, v) = (p.x - x, p.y - y);
        let (x, y) = (x as i64, y as i64);
        (1.0 - v) * ((1.0 - u) * code(x, y) + u * code(x + 1, y))
            + v * ((1.0 - u) * code(x, y + 1) + u * code(x + 1, y + 1))
    };
    let mut corner = start;
    for _ in 0..30 {
        let (mut sum, mut side) = (Matrix2::zeros(), Vector2::zeros());
        for j in -7..=7_i32 {
            for i in -7..=7_i32 {
                let offset = Vector2::new(f64::from(i), f64::from(j));
                let point = corner + offset;
                let slope = |step: Vector2<f64>| at(point + step) - at(point - step);
                let gradient = Vector2::new(slope(Vector2::x()), slope(Vector2::y()));
                let weighted = (-offset.norm_squared() / 25.0).exp() * gradient * gradient.transpose();
                sum += weighted;
                side += weighted * point;
            }
        }
        corner = sum.try_inverse().unwrap() * side;
    }
    corner
}

/// Cameras whose names do not matter.
fn board_poses(cameras: &[Camera], views: &BoardViews, seed: u64) -> Vec<Isometry3<f64>> {
    let named: Vec<(&str, &Camera)> = cameras.iter().map(|camera| ("camera", camera)).collect();
    virtual_rig::calibration::board_poses(&named, views, seed).unwrap()
}

#[test]
fn corners_have_the_numbers_and_places_of_opencv() {
    let board = Board::Chessboard { columns: 4, rows: 3, square_mm: 10.0 };
    let corners = board.corners();
    assert_eq!(corners.len(), 12);
    assert_eq!(corners[0].point_in_board, Point3::new(10.0, 10.0, 0.0));
    assert_eq!((corners[5].id, corners[5].point_in_board), (5, Point3::new(20.0, 20.0, 0.0)));
    // cv2.aruco.CharucoBoard((6, 5), 42, 33, …).getChessboardCorners()
    let corners = charuco().corners();
    assert_eq!(corners.len(), 20);
    assert_eq!(corners[6].point_in_board, Point3::new(84.0, 84.0, 0.0));
}

#[test]
fn quads_fill_the_paper_and_none_overlaps() {
    for board in [Board::default(), charuco()] {
        let quads = board.quads();
        let area =
            |corners: &[Point3<f64>; 4]| (corners[1] - corners[0]).cross(&(corners[3] - corners[0])).norm();
        let total: f64 = quads.iter().map(|quad| area(&quad.corners_in_board)).sum();
        assert!((total - area(&board.outline())).abs() < 1e-6);
        assert!(quads.iter().all(|quad| area(&quad.corners_in_board) > 0.0));
        // Clockwise seen from before the board: the normal points into it.
        let turn = |c: &[Point3<f64>; 4]| (c[1] - c[0]).cross(&(c[2] - c[0])).z;
        assert!(quads.iter().all(|quad| turn(&quad.corners_in_board) > 0.0));
    }
}

/// The quads as painted and the picture as rendered are one board: at the middle of each quad stands its colour.
#[test]
fn the_picture_shows_the_quads() {
    let camera = &rig()[1];
    let light = BoardLight { level: 1.0, rise_per_m: [0.0; 3], room: 0.5 };
    for board in [Board::default(), charuco()] {
        let pose = board_poses(std::slice::from_ref(camera), &views(board.clone(), 1), 3)[0];
        let picture = BoardCamera::new(camera).render(&board, &pose, &light, 64);
        for quad in board.quads() {
            let middle = nalgebra::center(&quad.corners_in_board[0], &quad.corners_in_board[2]);
            let pixel = camera.project(&(pose * middle)).unwrap();
            let index = pixel.y.round() as usize * 656 + pixel.x.round() as usize;
            let seen = picture.radiance[index][1];
            assert!((seen - quad.reflectance[1]).abs() < 0.35, "{seen} at {pixel:?}, {:?}", quad.reflectance);
        }
    }
}

#[test]
fn rendered_corners_are_where_truth_says() {
    let rig = rig();
    for board in [Board::default(), charuco()] {
        let poses = board_poses(&rig, &views(board.clone(), 6), 1);
        let (mut sum, mut mean, mut count) = (0.0, Vector2::zeros(), 0);
        for (i, pose) in poses.iter().enumerate() {
            let camera = &rig[i % rig.len()];
            let picture = BoardCamera::new(camera).render(&board, pose, &BoardLight::default(), 96);
            let picture = blurred(picture);
            for CornerInImage { point_in_image, .. } in corners_in_image(camera, &board, pose) {
                let found = find_corner(&picture, point_in_image.map(f64::round));
                sum += (found - point_in_image).norm_squared();
                mean += found - point_in_image;
                count += 1;
            }
        }
        let rms = (sum / f64::from(count)).sqrt();
        let mean = mean.norm() / f64::from(count);
        println!("{count} corners, RMS {rms:.4} px, mean {mean:.4} px");
        assert!(count > 100 && rms < 0.05 && mean < 0.01, "{count} corners, RMS {rms} px, mean {mean} px");
    }
}

#[test]
fn poses_cover_all_images_and_are_shared() {
    let rig = rig();
    let views = views(Board::default(), 60);
    let poses = board_poses(&rig, &views, 5);
    let again = board_poses(&rig, &views, 5);
    assert_eq!((poses.len(), &poses), (60, &again), "the same seed gives the same poses");
    assert_ne!(poses, board_poses(&rig, &views, 6));
    for (c, camera) in rig.iter().enumerate() {
        let whole: Vec<&Isometry3<f64>> =
            poses.iter().filter(|pose| is_seen_whole(camera, &views.board, pose)).collect();
        let corners = whole.iter().flat_map(|pose| corners_in_image(camera, &views.board, pose));
        let cell = |corner: CornerInImage| {
            [(corner.point_in_image.x / 164.0) as u8, (corner.point_in_image.y / 122.5) as u8]
        };
        let cells: BTreeSet<[u8; 2]> = corners.map(cell).collect();
        println!("camera {c}: {} views, {} of 16 parts of the image", whole.len(), cells.len());
        assert!(whole.len() >= 10, "camera {c} sees {} views", whole.len());
        assert_eq!(cells.len(), 16, "camera {c} has corners in {} of 4 × 4 parts of its image", cells.len());
    }
    let seen_by =
        |pose: &Isometry3<f64>| rig.iter().filter(|camera| is_seen_whole(camera, &views.board, pose)).count();
    let shared = poses.iter().filter(|pose| seen_by(pose) >= 3).count();
    println!("{shared} views are seen by three cameras");
    assert!(shared >= 20 && poses.iter().all(|pose| seen_by(pose) >= 1));
}

#[test]
fn boards_tilt_up_to_the_limit() {
    let rig = &rig()[..1];
    let views = views(Board::default(), 40);
    let angle = |pose: &Isometry3<f64>| {
        let to_eye = rig[0].eye_in_world() - pose * views.board.middle();
        to_eye.angle(&(pose * -Vector3::z())).to_degrees()
    };
    let angles: Vec<f64> = board_poses(rig, &views, 2).iter().map(angle).collect();
    assert!(angles.iter().all(|&angle| angle <= 40.0 + 1e-9), "{angles:?}");
    assert!(angles.iter().any(|&angle| angle > 30.0));
}

#[test]
fn a_board_is_not_seen_from_behind() {
    let (camera, board) = (&rig()[1], Board::default());
    let front = board_poses(std::slice::from_ref(camera), &views(board.clone(), 1), 1)[0];
    let flip = Isometry3::rotation(std::f64::consts::PI * Vector3::y());
    let to_middle = Isometry3::translation(board.middle().x, board.middle().y, 0.0);
    let back = front * to_middle * flip * to_middle.inverse();
    assert_eq!(corners_in_image(camera, &board, &front).len(), 48);
    assert!(corners_in_image(camera, &board, &back).is_empty() && !is_seen_whole(camera, &board, &back));
    let picture = BoardCamera::new(camera).render(&board, &back, &BoardLight::default(), 4);
    assert!(picture.radiance.iter().all(|radiance| radiance[1] < 0.3), "the back has no pattern");
}

#[test]
fn a_ball_has_its_area_and_its_middle() {
    let camera = &rig()[0];
    for (radius_mm, place) in
        [(2.5, [13.3, -20.7, 9.0]), (0.2, [-60.0, 40.0, 0.0]), (6.0, [110.0, 60.0, -30.0])]
    {
        let point = Point3::from(place);
        let picture = render_led(camera, &point, radius_mm, [1.0, 0.5, 0.25], 0.0);
        let (mut sum, mut moment) = (0.0, Vector2::zeros());
        for (index, radiance) in picture.radiance.iter().enumerate() {
            sum += f64::from(radiance[0]);
            moment += f64::from(radiance[0]) * Vector2::new((index % 656) as f64, (index / 656) as f64);
            assert!((radiance[1] - 0.5 * radiance[0]).abs() < 1e-6 && radiance[0] <= 1.0);
        }
        // The outline of a small ball is a small circle across the view, seen through the lens's slope there.
        let at = |step: Vector3<f64>| camera.project(&(point + step)).unwrap();
        let view = (point - camera.eye_in_world()).normalize();
        let aside = view.cross(&Vector3::y()).normalize();
        let upward = view.cross(&aside);
        let slope = |way: Vector3<f64>| (at(1e-3 * way) - at(-1e-3 * way)) / 2e-3;
        let expected = std::f64::consts::PI * radius_mm * radius_mm * slope(aside).perp(&slope(upward)).abs();
        assert!((sum / expected - 1.0).abs() < 1e-3, "area {sum} px², expected {expected}");
        let truth = camera.project(&point).unwrap();
        // Within a pixel nobody can tell where a ball is that is smaller.
        let tolerance = if radius_mm < 1.0 { 0.5 } else { 0.02 };
        let off = (moment / sum - truth).norm();
        assert!(off < tolerance, "{off} px off");
    }
}

#[test]
fn a_ball_that_is_not_in_view_is_dark() {
    let camera = &rig()[1];
    let behind = camera.eye_in_world() + Vector3::new(0.0, 0.0, 50.0);
    for point in [behind, camera.eye_in_world(), Point3::new(2000.0, 0.0, 0.0)] {
        let picture = render_led(camera, &point, 3.0, [1.0; 3], 0.1);
        assert_eq!(picture, Picture::filled([656, 490], [0.1; 3]), "{point}");
    }
}

#[test]
fn the_wand_fills_the_common_volume_smoothly() {
    let rig = rig();
    let volume = common_volume(&rig).unwrap();
    assert!((volume.middle - Point3::new(0.0, 5.0, 0.0)).norm() < 1.0, "{volume:?}");
    assert!((80.0..250.0).contains(&volume.radius_mm), "{volume:?}");
    let path = wand_path(&volume, 300, 25.0, 7);
    assert_eq!(path, wand_path(&volume, 300, 25.0, 7));
    let seen = |point: &Point3<f64>| {
        rig.iter().all(|camera| camera.project(point).is_some_and(|pixel| camera.contains(pixel)))
    };
    assert!(path.iter().all(seen), "all cameras see all of it");
    for axis in 0..3 {
        let reach =
            |sign: f64| path.iter().map(|point| sign * (point - volume.middle)[axis]).fold(0.0, f64::max);
        assert!(reach(1.0) > 0.5 * volume.radius_mm && reach(-1.0) > 0.5 * volume.radius_mm, "axis {axis}");
    }
    let bend = |points: &[Point3<f64>]| ((points[2] - points[1]) - (points[1] - points[0])).norm();
    let step = |points: &[Point3<f64>]| (points[1] - points[0]).norm();
    assert!(path.windows(3).all(|points| bend(points) < 0.15 * volume.radius_mm));
    assert!(path.windows(2).all(|points| step(points) < 0.5 * volume.radius_mm));
}

#[test]
fn pictures_do_not_depend_on_the_number_of_threads() {
    let (camera, board) = (&rig()[2], charuco());
    let pose = board_poses(std::slice::from_ref(camera), &views(board.clone(), 1), 1)[0];
    let render = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| BoardCamera::new(camera).render(&board, &pose, &BoardLight::default(), 16))
    };
    assert_eq!(render(1), render(2));
}

#[test]
fn what_makes_no_sense_is_named() {
    let message = |change: &dyn Fn(&mut Params)| {
        let mut params = Params::default();
        params.check().unwrap();
        change(&mut params);
        params.check().unwrap_err().to_string()
    };
    let square = message(&|params| {
        params.boards.board = Board::Chessboard { columns: 8, rows: 6, square_mm: -1.0 };
    });
    assert_eq!(square, "calibration.boards.board.square_mm: -1 mm is no side of a square");
    let board = |columns, rows, marker_mm| Board::Charuco {
        columns,
        rows,
        square_mm: 20.0,
        marker_mm,
        dictionary: Dictionary::FourByFour50,
    };
    let many = message(&|params| params.boards.board = board(12, 9, 15.0));
    assert!(many.contains("needs 54 markers, the dictionary has 50"), "{many}");
    let large = message(&|params| params.boards.board = board(5, 4, 25.0));
    assert!(large.contains("marker_mm: a marker of 25 mm in a square of 20 mm"), "{large}");
    assert!(message(&|params| params.boards.tilt_deg = 80.0).contains("boards.tilt_deg: 80 degrees"));
    assert!(message(&|params| params.boards.distance = [1.2, 0.8]).contains("boards.distance"));
    assert!(message(&|params| params.wand.reach = f64::NAN).contains("wand.reach"));
    let board = Board::Chessboard { columns: 8, rows: 6, square_mm: 90.0 };
    let (first, rig) = (rig()[0].clone(), rig());
    let cameras = [("left", &first), ("right", &rig[1])];
    let error = virtual_rig::calibration::board_poses(&cameras, &views(board, 1), 1).unwrap_err().to_string();
    assert!(error.contains("camera left sees the board whole nowhere; take a smaller board"), "{error}");
}

#[test]
fn params_are_read_as_written() {
    let text = r#"{"boards": {"board": {"charuco": {"columns": 6, "rows": 5, "square_mm": 42.0, "marker_mm": 33.0,
        "dictionary": "4x4_50"}}, "count": 3}}"#;
    let params: Params = serde_json::from_str(text).unwrap();
    assert_eq!((params.boards.board.clone(), params.boards.count), (charuco(), 3));
    let back: Params = serde_json::from_str(&serde_json::to_string(&params).unwrap()).unwrap();
    assert_eq!(back, params);
    assert!(serde_json::from_str::<Params>(r#"{"boards": {"counts": 3}}"#).is_err());
    let unknown = r#"{"chessboard": {"columns": 7, "rows": 5, "square_mm": 22.0, "marker_mm": 3.0}}"#;
    assert!(serde_json::from_str::<Board>(unknown).is_err());
}

/// Pictures and truth for `tools/peers/_board_corners.py`, into the folder that `BOARDS` names.
#[test]
#[ignore = "writes pictures for OpenCV"]
fn write_pictures_for_opencv() {
    let folder = std::path::PathBuf::from(std::env::var("BOARDS").unwrap());
    std::fs::create_dir_all(&folder).unwrap();
    let rig = rig();
    for (name, board) in [("chessboard", Board::default()), ("charuco", charuco())] {
        let poses = board_poses(&rig, &views(board.clone(), 12), 1);
        for (i, pose) in poses.iter().enumerate() {
            let camera = &rig[i % rig.len()];
            let picture = BoardCamera::new(camera).render(&board, pose, &BoardLight::default(), 96);
            let picture = blurred(picture);
            let picture = blurred(picture);
            let stem = folder.join(format!("{name}-{i:02}"));
            save(&picture, &stem.with_extension("png"));
            let corners: Vec<_> = corners_in_image(camera, &board, pose)
                .iter()
                .map(|corner| (corner.id, corner.point_in_image.x, corner.point_in_image.y))
                .collect();
            let truth = serde_json::to_string(&(board.clone(), corners)).unwrap();
            std::fs::write(stem.with_extension("json"), truth).unwrap();
        }
    }
    let wand = Params::default().wand;
    let path = wand_path(&common_volume(&rig).unwrap(), 3, 25.0, 1);
    save(&render_led(&rig[0], &path[2], wand.radius_mm, wand.radiance, wand.room), &folder.join("led.png"));
}

fn save(picture: &Picture, path: &std::path::Path) {
    let bytes = picture.radiance.iter().flatten().map(|&linear| srgb_code(linear)).collect();
    image::RgbImage::from_raw(picture.size[0], picture.size[1], bytes).unwrap().save(path).unwrap();
}
