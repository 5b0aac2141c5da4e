//! Laws of whole takes.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use artifact::TrackState;
use nalgebra::{Isometry3, Vector2};
use virtual_rig::act::{HeadMotion, Timeline};
use virtual_rig::scenario::{Fault, FaultKind, Length, Performance, Scenario, preset};
use virtual_rig::take::{Given, ImageTruth, Role, Studio, shots_by_frame};
use virtual_rig::wrinkle::{Family, Fixed};

/// A small, short take with these changes.
fn studio(change: impl FnOnce(&mut Scenario)) -> Studio {
    let mut scenario = preset("standard").unwrap();
    Length::Tiny.apply(&mut scenario);
    (scenario.vertices, scenario.image_scale) = (2000, 0.25);
    change(&mut scenario);
    Studio::set_up(scenario, Given::default()).unwrap()
}

fn fault(text: &str) -> Fault {
    text.parse().unwrap()
}

/// An image of a camera at a time, with its truth.
fn image(studio: &Studio, camera: &str, time_s: f64) -> (Vec<u8>, ImageTruth) {
    let station = &studio.stations()[camera];
    let set = studio.set(time_s, station.exposure_s, false);
    let exposure = studio.expose(&set, station).unwrap();
    let truth = studio.truth_of(&set, station, &exposure);
    (studio.develop(&exposure, station, 0, time_s).unwrap(), truth)
}

#[test]
fn a_still_head_stays_where_it_is() {
    let studio = studio(|scenario| scenario.head = HeadMotion::still());
    for time_s in [0.0, 0.02, 0.5, 7.0] {
        let apart = studio.world_from_head(time_s).to_homogeneous() - Isometry3::identity().to_homogeneous();
        assert!(apart.amax() < 1e-9, "{time_s} s: {apart}");
    }
}

/// A face that does nothing moves with its head, and so do its markers.
#[test]
fn a_head_carries_its_markers_rigidly() {
    let studio = studio(|scenario| {
        scenario.performance = Performance::Events(Timeline { events: Vec::new(), seed: 1 });
    });
    let markers = |time_s: f64| {
        let set = studio.set(time_s, 0.0, false);
        (studio.markers_in_world(&set), set.pose.world_from_head)
    };
    let (rest, _) = markers(0.0);
    let (moved, world_from_head) = markers(0.7);
    assert!((world_from_head.translation.vector.norm()) > 0.5, "the head moves");
    for (at, now) in rest.iter().zip(&moved) {
        assert!((world_from_head * at - now).norm() < 1e-6);
    }
}

/// A dot that is wholly seen by a mocap camera stands in the image where its centre does. Not quite: where a dot bends over
/// the bridge of the nose, the side that faces the camera counts for more there. On average nothing is left of that.
#[test]
fn tracks_are_projected_markers() {
    let studio = studio(|_| {});
    let set = studio.set(0.02, 0.0, false);
    let world = studio.markers_in_world(&set);
    let mut offsets: Vec<Vector2<f64>> = Vec::new();
    for station in studio.stations().values().filter(|station| station.role == Role::Mocap) {
        let exposure = studio.expose(&set, station).unwrap();
        let truth = studio.truth_of(&set, station, &exposure);
        for (sample, point) in truth.tracks.iter().zip(&world) {
            if let Some(sample) = sample.filter(|s| s.state == TrackState::Seen && s.confidence > 0.99) {
                offsets.push(sample.at.coords - station.camera.project(point).unwrap());
            }
        }
    }
    assert!(offsets.len() > 200, "{}", offsets.len());
    let worst = offsets.iter().map(Vector2::norm).fold(0.0, f64::max);
    let mean = offsets.iter().sum::<Vector2<f64>>() / offsets.len() as f64;
    assert!(worst < 0.2 && mean.norm() < 0.02, "worst {worst} px, mean {mean}");
}

/// What a wrinkle camera truly sees of folds of a fixed depth.
fn folds(d_over_w: f64) -> ImageTruth {
    let studio = studio(|scenario| {
        scenario.vertices = 25_000;
        scenario.crease_mm = 0.2;
        scenario.light.shadows = false;
        scenario.folds.family = Family::S;
        scenario.folds.fixed = Some(Fixed { w_mm: 2.0, d_over_w });
    });
    let station = &studio.stations()["w1"];
    let set = studio.set(0.0, station.exposure_s, true);
    let exposure = studio.expose(&set, station).unwrap();
    studio.truth_of(&set, station, &exposure)
}

#[test]
fn a_bottom_behind_its_own_wall_is_not_seen() {
    let [shallow, deep] = [0.02, 0.8].map(folds);
    let sections = |truth: &ImageTruth| truth.sections.values().map(Vec::len).sum::<usize>();
    let seen = [&deep, &shallow].map(sections);
    assert!(seen[0] < seen[1] && seen[0] > 100, "{seen:?}");
    // From the bottom of S(p) the wall rises by 2 d/w; skin that is bent, and ends that run out, open it a little.
    let leans = |truth: &ImageTruth, limit: fn(f64) -> f64| -> usize {
        let sections = truth.sections.values().flatten();
        sections.filter(|at| at.tilt_rad.unwrap().tan().abs() > 1.2 * limit(at.d_px / at.w_px)).count()
    };
    let over = leans(&deep, |ratio| 0.5 / ratio);
    assert!(over * 20 < seen[0], "{over} of {} are seen through their walls", seen[0]);
    let over = leans(&shallow, |_| 0.5 / 0.8);
    assert!(over * 20 > seen[1], "the camera looks along few of the wrinkles: {over}");
}

#[test]
fn true_sections_point_from_left_to_right() {
    for sections in folds(0.3).sections.values() {
        let turned = sections.windows(2).filter(|pair| {
            let [along, right] =
                [Vector2::from(pair[1].at) - Vector2::from(pair[0].at), Vector2::from(pair[0].normal)];
            // y runs down.
            along.perp(&right) <= 0.0
        });
        assert!(turned.count() * 20 <= sections.len());
    }
}

#[test]
fn a_mirrored_camera_mirrors_image_and_tracks() {
    let plain = studio(|_| {});
    let mirrored = studio(|scenario| scenario.faults.push(fault("mirrored=1@m2")));
    let last = f64::from(plain.stations()["m2"].camera.image_size[0]) - 1.0;
    let ((straight, truth), (turned, other)) = (image(&plain, "m2", 0.0), image(&mirrored, "m2", 0.0));
    let width = last as usize + 1;
    for (row, turned) in straight.chunks(3 * width).zip(turned.chunks(3 * width)) {
        assert!(row.chunks(3).eq(turned.chunks(3).rev()));
    }
    assert!(truth.tracks.iter().flatten().count() > 40);
    for (one, other) in truth.tracks.iter().zip(&other.tracks) {
        let places =
            (one.map(|one| [last - one.at.x, one.at.y]), other.map(|other| [other.at.x, other.at.y]));
        assert_eq!(places.0, places.1);
    }
    assert_eq!(image(&plain, "m1", 0.0).0, image(&mirrored, "m1", 0.0).0, "another camera is as it was");
}

#[test]
fn cameras_that_were_touched_differ_from_their_calibration() {
    let plain = studio(|_| {});
    let touched =
        studio(|scenario| scenario.faults.extend([fault("rotated=0.5@m2"), fault("focal=0.02@m3")]));
    for (id, station) in touched.stations() {
        let was = &plain.stations()[id];
        assert_eq!(station.calibrated, was.calibrated, "{id}");
        assert_eq!(station.camera == station.calibrated, !["m2", "m3"].contains(&id.as_str()), "{id}");
    }
    let m2 = &touched.stations()["m2"];
    let turn = m2.camera.cam_from_world.rotation.angle_to(&m2.calibrated.cam_from_world.rotation);
    assert!((turn.to_degrees() - 0.5).abs() < 1e-6, "{turn}");
    let m3 = &touched.stations()["m3"];
    assert!((m3.camera.lens.focal_px.x / m3.calibrated.lens.focal_px.x - 1.02).abs() < 1e-12);
}

#[test]
fn lost_and_doubled_frames_are_known() {
    let studio = studio(|scenario| {
        scenario.extent.frames = 200;
        scenario.faults.extend([fault("dropped=0.2@m1"), fault("doubled=0.2@m2")]);
    });
    let shots = shots_by_frame(&studio.schedule().unwrap(), 200);
    let of = |camera: &str| -> Vec<usize> {
        let all = shots.values().flatten().filter(|shot| shot.camera == camera);
        all.map(|shot| shot.copies).collect()
    };
    assert!((20..=60).contains(&(200 - of("m1").len())), "{}", of("m1").len());
    assert!((20..=60).contains(&of("m2").iter().filter(|copies| **copies == 2).count()));
    assert!(of("m3") == vec![1; 200] && of("m2").len() == 200);
}

/// What stands twice in the footage has its image in its first copy, which is none that only repeats another.
#[test]
fn the_first_copy_of_an_image_is_the_image() {
    let studio = studio(|scenario| {
        scenario.extent.frames = 50;
        scenario.faults.push(fault("doubled=0.3@m2"));
    });
    let schedule = studio.schedule().unwrap();
    let (_, entries) = schedule.cameras.iter().find(|(id, _)| id == "m2").unwrap();
    let shots = shots_by_frame(&schedule, 50);
    let mut repeated = 0;
    for shot in shots.values().flatten().filter(|shot| shot.camera == "m2") {
        let shown = shot.shown();
        assert!(!shown.doubled && !entries[shown.index as usize].is_double, "{shown:?}");
        repeated += shot.copies - 1;
    }
    assert!(repeated > 5 && entries.iter().filter(|entry| entry.is_double).count() == repeated);
}

/// Every image of the take's frames is due by the header, and the header tells its time; nothing else is due.
#[test]
fn sync_says_when_each_image_was_taken() {
    let faults = ["offset=-3.4@m1", "offset=2.3@m2", "drift=10000@m3", "drift=-10000@m4", "offset=-0.6@w2"];
    let frames = 101;
    let studio = studio(|scenario| {
        scenario.extent.frames = frames;
        scenario.faults.extend(faults.map(fault));
        scenario.faults.extend(["offset=0.12@w1", "drift=10000@w1", "drift=10000@w2"].map(fault));
    });
    let extent = studio.scenario().extent;
    let schedule = studio.schedule().unwrap();
    let shots = shots_by_frame(&schedule, frames);
    for (id, entries) in &schedule.cameras {
        let sync = studio.sync_of(id, &studio.stations()[id]);
        let shown: Vec<i64> =
            shots.iter().filter(|(_, s)| s.iter().any(|shot| shot.camera == *id)).map(|(f, _)| *f).collect();
        assert_eq!(shown.len(), entries.len(), "{id}: each image has a frame of its own");
        let due = (0..entries.len() as i64).map(|n| sync.phase + n * i64::from(sync.every));
        assert!(shown.iter().map(|frame| extent.first_frame + frame).eq(due), "{id}: {shown:?}");
        for entry in entries {
            let (frame, hz) = (extent.first_frame + entry.mocap_frame, extent.rate.hz());
            let lag = sync.offset_frames + sync.drift_ppm * 1e-6 * (frame - sync.phase) as f64;
            let taken = frame as f64 + lag - extent.first_frame as f64;
            assert!((taken - entry.time_s * hz).abs() < 1e-9, "{id}, frame {frame}: {taken}");
            assert!(sync.is_due(frame), "{id}, frame {frame}");
        }
        assert!(sync.offset_frames.abs() < 0.6, "{id}: {}", sync.offset_frames);
    }
}

#[test]
fn a_camera_that_films_no_frame_of_the_take_is_refused() {
    let refusal = |text: &str| {
        let studio = studio(|scenario| scenario.faults.push(fault(text)));
        studio.schedule().map(drop).map_err(|error| error.to_string())
    };
    for text in ["offset=-3.4@m2", "offset=3@m2"] {
        let message = refusal(text).unwrap_err();
        assert!(
            message.starts_with("cameras.m2: none of its images shows a frame of the take, 1001 to 1003")
        );
    }
    assert_eq!((refusal("offset=2@m2"), refusal("offset=-0.5@w1")), (Ok(()), Ok(())));
}

/// Takes in which one thing goes wrong, as the tool makes them.
fn recipes() -> Vec<Fault> {
    let tool = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../tools/virtual-take");
    let text = artifact::read_text(tool.as_ref()).unwrap();
    let (_, list) = text.split_once("FAULTS=(").unwrap();
    list.split_once(')').unwrap().0.split_whitespace().map(fault).collect()
}

/// The images' numbers, frames and times: what the footage of a camera shows of the performance.
fn footage_of(studio: &Studio, camera: &str) -> (Vec<(i64, f64, bool)>, Vec<artifact::Shown>) {
    let schedule = studio.schedule().unwrap();
    let (_, entries) = schedule.cameras.iter().find(|(id, _)| id == camera).unwrap();
    let frames = studio.scenario().extent.frames;
    let shots = shots_by_frame(&schedule, frames);
    let shown = shots.range(0..i64::from(frames)).flat_map(|(_, shots)| shots);
    let shown = shown.filter(|shot| shot.camera == camera).map(virtual_rig::take::Shot::shown).collect();
    (entries.iter().map(|entry| (entry.exposure, entry.time_s, entry.is_double)).collect(), shown)
}

/// Each recipe changes its camera's footage; those that a stage could measure change the truth too.
#[test]
fn every_recipe_of_a_fault_shows() {
    let short = |fault: Option<Fault>| {
        studio(|scenario| {
            scenario.extent = preset("standard").unwrap().extent;
            scenario.faults.extend(fault);
        })
    };
    let plain = short(None);
    let recipes = recipes();
    assert!(recipes.len() > 8, "{recipes:?}");
    for recipe in recipes {
        let (camera, touched) = (recipe.camera.clone().unwrap(), short(Some(recipe.clone())));
        let station = |studio: &Studio| studio.stations()[&camera].clone();
        let footage = [&plain, &touched].map(|studio| footage_of(studio, &camera));
        let sync = [&plain, &touched].map(|studio| studio.sync_of(&camera, &station(studio)));
        let images = || [&plain, &touched].map(|studio| image(studio, &camera, 0.02));
        let (shows, is_true) = match recipe.kind {
            FaultKind::Dropped | FaultKind::Doubled => {
                (footage[0].0 != footage[1].0, footage[0].1 != footage[1].1)
            }
            FaultKind::Offset | FaultKind::Drift => (footage[0].0 != footage[1].0, sync[0] != sync[1]),
            FaultKind::Gamma | FaultKind::MotionBlur | FaultKind::Defocused => {
                let [(one, _), (other, _)] = images();
                (one != other, true)
            }
            FaultKind::Rotated | FaultKind::Mirrored | FaultKind::Focal => {
                let [(one, truth), (other, moved)] = images();
                (one != other, truth.tracks != moved.tracks)
            }
        };
        assert!(shows && is_true, "{recipe:?}: footage {shows}, truth {is_true}");
    }
}

#[test]
fn every_fault_can_be_said() {
    for (kind, name, _) in FaultKind::ALL {
        let amount = if matches!(kind, FaultKind::Gamma | FaultKind::Mirrored) { "1" } else { "0.25" };
        let said = fault(&format!("{name}={amount}@m1"));
        assert_eq!((said.kind, said.camera.as_deref()), (kind, Some("m1")), "{name}");
    }
}

/// The board of the named scenarios is held where each camera of the rig sees it whole, and mostly by several at once.
#[test]
fn the_board_fits_into_every_cameras_view() {
    use virtual_rig::calibration::{board_poses, is_seen_whole};
    for seed in 0..3 {
        let mut scenario = preset("standard").unwrap();
        (scenario.vertices, scenario.seed) = (2000, seed);
        let studio = Studio::set_up(scenario, Given::default()).unwrap();
        let views = &studio.scenario().calibration.boards;
        let stations = studio.stations().iter();
        let cameras: Vec<_> = stations.map(|(id, station)| (id.as_str(), &station.calibrated)).collect();
        let poses = board_poses(&cameras, views, seed).unwrap();
        let seen = |camera| poses.iter().filter(|pose| is_seen_whole(camera, &views.board, pose)).count();
        let least = cameras.iter().map(|(_, camera)| seen(camera)).min().unwrap();
        assert!(least >= views.count / 4, "a camera sees {least} of {}", views.count);
    }
}

/// Speed, and its change within an exposure, move a blurred dot as much as they move the truth of its centre.
#[test]
fn the_truth_of_a_blurred_dot_is_where_its_blur_is() {
    let studio = studio(|scenario| {
        scenario.image_scale = 0.5;
        let smile = r#"[{"action": "smile", "start_s": 0.0, "rise_s": 0.08, "fall_s": 0.08}]"#;
        let events = serde_json::from_str(smile).unwrap();
        scenario.performance = Performance::Events(Timeline { events, seed: 1 });
        scenario.faults.push(fault("motion-blur=14@m3"));
    });
    let station = &studio.stations()["m3"];
    let layers = studio.layers();
    let (mut squares, mut fastest) = (Vec::new(), 0.0f64);
    for time_s in [0.012, 0.04, 0.072] {
        let set = studio.set(time_s, station.exposure_s, false);
        let exposure = studio.expose(&set, station).unwrap();
        let truth = studio.truth_of(&set, station, &exposure);
        let width = exposure.size[0];
        for (dot, sample) in truth.tracks.iter().take(layers.dots().len()).enumerate() {
            let Some(sample) = sample.filter(|s| s.state == TrackState::Seen && s.confidence > 0.999) else {
                continue;
            };
            let (mut sum, mut share) = (Vector2::zeros(), 0.0);
            for cover in exposure.covers.iter().filter(|cover| cover.layer == layers.layer_of_dot(dot)) {
                let pixel = Vector2::new(f64::from(cover.pixel % width), f64::from(cover.pixel / width));
                let at = pixel + Vector2::from(cover.offset_px.map(f64::from));
                sum += f64::from(cover.share) * at;
                share += f64::from(cover.share);
            }
            squares.push((sum / share - sample.at.coords).norm_squared());
        }
        let before = studio.markers_in_world(&studio.set(time_s - 0.007, 0.0, false));
        let after = studio.markers_in_world(&studio.set(time_s + 0.007, 0.0, false));
        fastest = before.iter().zip(&after).map(|(p, q)| (q - p).norm()).fold(fastest, f64::max);
    }
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!(fastest > 1.0, "the dots should move: {fastest} mm");
    assert!(squares.len() > 60 && rms < 0.02, "{} dots, rms {rms} px", squares.len());
}

/// Normals are of unit length wherever there are any, and nothing of the background is in them.
#[test]
fn pictures_of_normals_hold_unit_normals_only() {
    let studio = studio(|_| {});
    let station = &studio.stations()["w1"];
    let normals = studio.normals_of(&studio.set(0.0, 0.0, false), station).unwrap();
    let lengths: Vec<f64> = normals
        .chunks(3)
        .filter(|code| **code != [0; 3])
        .map(|code| code.iter().map(|c| (2.0 * f64::from(*c) / 65535.0 - 1.0).powi(2)).sum::<f64>().sqrt())
        .collect();
    assert!(lengths.len() > normals.len() / 20, "{} of {} pixels", lengths.len(), normals.len() / 3);
    assert!(lengths.iter().all(|length| (length - 1.0).abs() < 1e-4));
}

/// Hands hide about a fifth of what the mocap cameras of `standard` see, once they have come.
#[test]
fn hands_hide_a_fifth_of_the_markers_in_hard() {
    let (mut seen, mut hidden) = (0.0, 0.0);
    for seed in 1..4 {
        let studio_with = |count: Option<usize>| {
            studio(|scenario| {
                scenario.hands = preset("hard").unwrap().hands;
                scenario.hands.count = count.unwrap_or(scenario.hands.count);
                scenario.seed = seed;
            })
        };
        let (free, hard) = (studio_with(Some(0)), studio_with(None));
        for time_s in [0.3, 0.9, 1.7, 2.3] {
            for id in ["m1", "m3", "m6"] {
                let is_seen = |studio: &Studio| -> Vec<bool> {
                    let truth = image(studio, id, time_s).1;
                    truth.tracks.iter().map(|s| s.is_some_and(|s| s.state == TrackState::Seen)).collect()
                };
                for (free, hard) in is_seen(&free).into_iter().zip(is_seen(&hard)) {
                    seen += f64::from(free);
                    hidden += f64::from(free && !hard);
                }
            }
        }
    }
    let share = hidden / seen;
    assert!((0.15..0.25).contains(&share), "{share} of {seen}");
}
