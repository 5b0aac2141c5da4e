"""Runs every reader over the frozen files of the repository. Needs NumPy only: `python3 tools/readers/check.py`."""
import contextlib
import io
import os
import pathlib
import runpy
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
FIXTURES = ROOT / "fixtures" / "schema"
sys.path.insert(0, str(HERE))
sys.dont_write_bytecode = True

TRC = ("PathFileType\t4\t(X/Y/Z)\tsmile.trc\n"
       "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n"
       "100\t100\t2\t2\tmm\t100\t7\t2\n"
       "Frame#\tTime\tbrow_l\t\t\tlip_r\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n"
       "7\t0.06\t1\t2\t3\t\t\t\n8\t0.07\t1.5\t2\t3\t-4\t5\t6.25\n")


def close(found, wanted):
    assert np.allclose(found, wanted, rtol=1e-12, atol=1e-12, equal_nan=True), f"{found} is not {wanted}"


def check_static():
    import correspondence, provenance, take, vertex_map, vertex_path, vertex_set, warp
    manifest = take.read(FIXTURES / "take-1/take.json")
    close(manifest["hz"], 30000 / 1001)
    assert manifest["cameras"][0]["footage"] is None
    newer = take.read(FIXTURES / "take-2/take.json")
    footage = [camera["footage"] for camera in newer["cameras"]]
    assert footage[0]["file"] is None and footage[1]["file"] == "footage/left.mkv" and footage[2] is None
    assert footage[0]["images"].format(frame=17) == "footage/front/000017.png"
    mesh, markers, vertices, positions = correspondence.read(FIXTURES / "correspondence-1/correspondence.json")
    assert markers == ["brow_l", "lip_r", "nose", "temple"] and mesh["vertex_count"] == 5
    close(positions[3], [0, 10, -0.25])
    fitted = warp.read(FIXTURES / "warp-1/warp.json")["face_from_mocap"]
    # At the origin all four centers lie sqrt(0.5) away, but for their heights; far out the affine part is 1.
    distances = np.linalg.norm(np.array(fitted["centers"]), axis=1) ** 3
    close(warp.apply(fitted, [[5.0, 5.0, 0.0]])[0], distances @ np.array(fitted["weights"]) + [5, 5, 0])
    weightless = {**fitted, "weights": np.zeros((4, 3))}
    close(warp.apply(weightless, [[1.0, 2.0, 3.0], [-4.0, 5.0, -6.0]]), [[1, 2, 3], [-4, 5, -6]])
    assert vertex_set.read(FIXTURES / "vertex-set-1/vertex-set.json")[2].tolist() == [1, 2, 4]
    assert vertex_path.read(FIXTURES / "vertex-path-1/vertex-path.json")[2].tolist() == [4, 1, 2]
    _, _, new_from_old, old_from_new = vertex_map.read(FIXTURES / "vertex-map-1/vertex-map.json")
    assert new_from_old.tolist() == [-1, 0, 1, -1, 2] and old_from_new.tolist() == [1, 2, 4]
    record = provenance.read(FIXTURES / "provenance-1/handles.jsonl.prov.json")
    assert provenance.made_from(record, FIXTURES / "warp-1/warp.json") == "warp"
    assert provenance.made_from(record, FIXTURES / "obj/mesh.obj") is None


def check_blending():
    import blend_weights, poses
    posed, maps, curve = poses.read(FIXTURES / "poses-1/poses.json")
    close(posed["brows-up"]["jaw"]["rotation_wxyz"], [0.6, 0.8, 0, 0])
    assert np.isnan(posed["brows-up"]["jaw"]["translation"]).all() and posed["smile"] == {}
    assert maps == {"brows-up": "brows-up.png", "smile": None} and curve.tolist() == [[0, 0], [0.5, 0.125], [1, 1]]
    header, frames, shares, weights = blend_weights.read(FIXTURES / "blend-weights-1/blend-weights.jsonl")
    assert frames.tolist() == [1001, 1002, 1004] and header["bones"] == ["brow_l", "jaw"]
    close(shares[0], [[0.1, 1], [np.nan, 0]])
    close(weights[0], [[0, 0.5, 0.1], [0, 0, 0]])
    assert (weights[1] == 0).all() and np.isnan(weights[2]).all()


def check_frames():
    import handles, head_pose, trajectories_3d
    covariance, views = trajectories_3d.read_accuracy(FIXTURES / "trajectories-3d-1/measured.jsonl")
    close(covariance[0, 0], [[0.0025, 0, 0.0005], [0, 0.0025, -0.0005], [0.0005, -0.0005, 0.01]])
    assert views[0]["nose"] == ["front", "left", "right"] and np.isnan(covariance[1]).all() and views[1] == {}
    for kind in ("trajectories-3d", "head-trajectories"):
        header, frames, points, status = trajectories_3d.read(FIXTURES / f"{kind}-1/{kind}.jsonl")
        assert header["markers"] == ["brow_l", "lip_r", "nose"] and frames.tolist() == [1001, 1002, 1004]
        assert points.shape == (3, 3, 3) and np.isnan(points[1, 0]).all() and points[1, 2, 2] == 0.1 + 0.2
        assert status[1].tolist() == ["measured", "single-camera", "interpolated"]
    header, frames, poses, residuals = head_pose.read(FIXTURES / "head-pose-1/head-pose.jsonl")
    close(poses[0], np.eye(4))
    close(poses[1] @ [0, 0, 1, 1], [1.96, -2.0, 0.78, 1])
    assert np.isnan(poses[2]).all() and np.isnan(residuals[2]) and residuals[1] == 0.0625
    header, frames, moves, weights = handles.read(FIXTURES / "handles-1/handles.jsonl")
    close(moves[1], [[0, 0.5, -0.125], [np.nan] * 3])
    close(weights, [[np.inf, np.inf], [2.5, np.inf], [np.inf, np.inf]])


def check_capture():
    import cameras, frames, labels, sync, tracks_2d
    rig = cameras.read(FIXTURES / "cameras-1/cameras.json")
    # The first lies on the axis of the view, the second 10 mm off it to the right and down, the third behind the camera.
    pixels = cameras.project(rig["front"], [[0, 10, 0], [10, 0, 0], [0, 0, 900]])
    r2 = 2 / 80**2
    step = (1 - 0.125 * r2 + 0.0625 * r2**2) / 80
    close(pixels, [[959.5, 539.5], [959.5 + 2400 * step, 539.5 + 2400.5 * step], [np.nan] * 2])
    header, numbers, index, doubled = sync.read(FIXTURES / "sync-1/sync.jsonl")
    assert numbers.tolist() == [1001, 1002, 1004] and index["front"].tolist() == [5, sync.MISSING, 7]
    assert index["right"].tolist() == [0, sync.NOT_DUE, 1] and doubled["left"].tolist() == [False, False, True]
    close(sync.mocap_time(header["cameras"]["left"], [1002, 51002]), [1002.25, 51001.25])
    images = frames.read(FIXTURES / "frames-1/frames.json")
    assert list(images["right"]["images"]) == [1001, 1004, 1007, 1010] and len(images["front"]["images"]) == 9
    assert images["front"]["images"][1004] == FIXTURES / "frames-1/front/001004.png"
    frame, points = labels.read(FIXTURES / "labels-1/labels.json")
    assert frame == 1001 and points["front"][0] == ["brow_l", "nose"] and points["right"][1].shape == (0, 2)
    close(points["left"][1], [[200.5, 0.1]])
    _, numbers, there, points, confidence, states = tracks_2d.read(FIXTURES / "tracks-2d-1/tracks-2d.jsonl")
    assert numbers.tolist() == [1001, 1002, 1004] and there.tolist() == [[True, True], [True, False], [True, True]]
    assert states[2, 0].tolist() == ["predicted", "lost", "edited"] and confidence[2, 0].tolist() == [0.5, 0.0, 1.0]
    close(points[1, 0], [[812.5, 301.25], [np.nan] * 2, [960.0, 540.125]])


def check_scenario():
    import scenario
    found = scenario.read(FIXTURES / "scenario-1/scenario.json")
    assert found["hz"] == 50 and found["frames"].tolist() == [1001, 1002, 1003]
    assert found["wrinkle_frames"].tolist() == [1003]
    assert scenario.amount(found, "rotated", "m2") == 0.25 and scenario.amount(found, "rotated", "m1") is None
    assert scenario.amount(found, "dropped", "w1") == 0.125


def check_wrinkles():
    import large_scale, paint_model, sections, valleys, wrinkles_2d
    floor, paints = paint_model.read(FIXTURES / "paint-model-1/paint-model.json")
    close(paint_model.ratios([[0.096, 0.196, 0.396]], floor), [[np.log(2), np.log(2)]])
    # At a support pixel the kernel is 1; the other one lies 2 and 0.75 away along the axes.
    wanted = 2 - 1.75 * np.exp(-0.5 * (2**2 + 0.75**2)) - 0.25
    close(paint_model.decisions(paints["green"], np.array([[1.5, -1.0]])), [wanted])
    close(paint_model.decisions(paints["violet"], np.array([[-1.5, 1.75]])), [0.875])
    _, curves = wrinkles_2d.read(FIXTURES / "wrinkles-2d-1/wrinkles-2d.jsonl")
    points, tangents, normals = wrinkles_2d.evaluate(curves[1001]["right"]["brow_1"], [0.0, 0.5, 1.0])
    close(points, [[110, 200], [115, 200], [120, 200]])
    close(tangents, [[1, 0]] * 3)
    close(normals, [[0, 1]] * 3)
    # Across a knot the curve is smooth: (1, 4, 1) / 6 of the control points from both sides.
    bent = curves[1004]["right"]["brow_1"]
    close(wrinkles_2d.evaluate(bent, [1.0])[0], [(bent["controls"][1:4] * np.array([[1], [4], [1]])).sum(0) / 6])
    close(wrinkles_2d.evaluate(bent, [1 - 1e-15])[0], wrinkles_2d.evaluate(bent, [1.0])[0])
    header, frames = sections.read(FIXTURES / "sections-1/sections.jsonl")
    measured = frames[1002]["right"]["brow_1"]
    assert measured["state"].tolist() == ["measured", "flat"] and len(frames[1001]["right"]["brow_1"]["u"]) == 0
    close(measured["deviation"], [[0.25, 0.125], [np.nan] * 2])
    close(measured["tilt_rad"], [0.5, np.nan])
    close(sections.height([-6, 0, 6, 12], 6, 3), [0, -3, 0, 3 * np.exp(-2)])
    close(sections.height([-5, 0, 15], 10, 3, 0.25, 0.5), [0, -3, 0])
    _, frames = valleys.read(FIXTURES / "valleys-1/valleys.jsonl")
    close(frames[1002]["brow_1"]["at_mm"], [[5, 2.5, -0.5], [7.5, 2.5, -0.25]])
    assert frames[1001] == {} and frames[1004]["brow_2"] == {}
    _, frames, sequence = large_scale.read(FIXTURES / "wrinkled-1/wrinkled.json")
    assert frames.tolist() == [1001, 1002, 1004]
    close(sequence[:, 4, 2], [1, 1.5, 2])


def check_meshes():
    import large_scale, obj, pc2, ply, response_basis
    positions, uvs, faces, face_uvs = obj.read(FIXTURES / "obj/mesh.obj")
    assert faces == [[0, 1, 2, 3], [1, 4, 2]] and face_uvs == [[0, 1, 2, 3], [1, 4, 2]]
    close(uvs[4], [1.5, 0.5])
    vertices, ply_faces = ply.read(FIXTURES / "ply/mesh.ply")
    close(np.stack([vertices["x"], vertices["y"], vertices["z"]], axis=1), positions)
    close([vertices["s"], vertices["t"]], uvs.T)
    assert [face["vertex_indices"].tolist() for face in ply_faces] == faces
    _, frames, sequence = large_scale.read(FIXTURES / "large-scale-1/large-scale.json")
    start, samples = pc2.read(FIXTURES / "large-scale-1/sequence.pc2")
    assert start == 1001 and frames.tolist() == [1001, 1002, 1004] and np.array_equal(samples, sequence)
    close(sequence[0], positions)
    close(sequence[:, 4, 2], [1, 1.5, 2])
    _, basis, schur = response_basis.read(FIXTURES / "response-basis-1/response-basis.json")
    close(basis[2], [0.25, 0.5])
    close(schur, [[2, -0.5], [-0.5, 1.5]])


def check_maps():
    import baked_maps, landmarks
    index, pictures = baked_maps.read(FIXTURES / "baked-maps-1/baked-maps.json")
    assert list(pictures) == [1001, 1012] and pictures[1012]["displacement"].name == "displacement.1012.png"
    close(baked_maps.normals(index, np.array([255, 0, 128], dtype=np.uint8)), np.array([1, 1, 1 / 255]) / np.sqrt(2 + 255**-2))
    close(baked_maps.displacement_mm(index, [0, 65535]), [-0.9, 0.9])
    _, ids, points, depths = landmarks.read(FIXTURES / "landmarks-1/landmarks.json")
    assert ids == ["brow_l", "brow_r"]
    close(points, [[200.5, 0.1], [310, 12]])
    close(depths, [-3.25, np.nan])


def check_formats_of_others():
    import c3d, trc
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "smile.trc"
        path.write_text(TRC, encoding="utf-8")
        labels, unit, rate, frames, points = trc.read(path)
    assert (labels, unit, rate, frames.tolist()) == (["brow_l", "lip_r"], "mm", 100, [7, 8])
    close(points, [[[1, 2, 3], [np.nan] * 3], [[1.5, 2, 3], [-4, 5, 6.25]]])
    for reader, name in ((c3d, "c3d/markers.c3d"), (trc, "trc/markers.trc")):
        labels, unit, rate, frames, points = reader.read(FIXTURES / name)
        assert labels == ["brow_l", "lip_r", "nose"] and unit == "mm" and abs(rate - 30000 / 1001) < 1e-4, name
        first = points[list(frames).index(1004)]
        assert np.allclose(first[0], [0.5, 0.25, 100.5]) and np.isnan(first[2]).all(), name
    data = pathlib.Path(os.environ.get("FURROW_DATA", ROOT.parent / "shared" / "data")) / "c3d"
    if not data.is_dir():
        print(f"skipped: {data} absent")
        return
    # The same recording, once as reals and once as scaled integers.
    real, whole = (c3d.read(data / name) for name in ("Eb015pr.c3d", "Eb015pi.c3d"))
    assert real[0] == whole[0] and real[1:3] == ("mm", 50.0) and real[4].shape == (450, 26, 3)
    assert real[0][0] == "RFT1" and np.nanmax(np.abs(real[4] - whole[4])) < 0.1


def check_commands():
    inputs = {"take": "take-2/take.json", "cameras": "cameras-1/cameras.json",
              "sync": "sync-1/sync.jsonl", "frames": "frames-1/frames.json", "labels": "labels-1/labels.json",
              "paint_model": "paint-model-1/paint-model.json",
              "tracks_2d": "tracks-2d-1/tracks-2d.jsonl", "wrinkles_2d": "wrinkles-2d-1/wrinkles-2d.jsonl",
              "sections": "sections-1/sections.jsonl", "valleys": "valleys-1/valleys.jsonl",
              "trajectories_3d": "trajectories-3d-1/trajectories-3d.jsonl",
              "head_pose": "head-pose-1/head-pose.jsonl", "correspondence": "correspondence-1/correspondence.json",
              "warp": "warp-1/warp.json", "handles": "handles-1/handles.jsonl",
              "vertex_set": "vertex-set-1/vertex-set.json", "vertex_map": "vertex-map-1/vertex-map.json",
              "vertex_path": "vertex-path-1/vertex-path.json",
              "response_basis": "response-basis-1/response-basis.json", "obj": "obj/mesh.obj", "ply": "ply/mesh.ply",
              "large_scale": "large-scale-1/large-scale.json", "baked_maps": "baked-maps-1/baked-maps.json",
              "pc2": "large-scale-1/sequence.pc2",
              "provenance": "provenance-1/handles.jsonl.prov.json", "scenario": "scenario-1/scenario.json",
              "poses": "poses-1/poses.json", "landmarks": "landmarks-1/landmarks.json", "blend_weights": "blend-weights-1/blend-weights.jsonl"}
    readers = {path.stem for path in HERE.glob("*.py")} - {"check"}
    assert readers == set(inputs) | {"c3d", "trc"}, readers ^ set(inputs)
    for reader in sorted(readers):
        lines = (HERE / f"{reader}.py").read_text(encoding="utf-8").splitlines()
        assert len(lines) <= 50, f"{reader}.py has {len(lines)} lines"
    for reader, fixture in inputs.items():
        sys.argv, said = [f"{reader}.py", str(FIXTURES / fixture)], io.StringIO()
        with contextlib.redirect_stdout(said):
            runpy.run_path(str(HERE / f"{reader}.py"), run_name="__main__")
        assert said.getvalue().strip(), f"{reader}.py says nothing"


if __name__ == "__main__":
    for check in (check_static, check_blending, check_frames, check_capture, check_scenario, check_wrinkles, check_meshes, check_maps,
                  check_formats_of_others, check_commands):
        check()
        print(f"ok: {check.__name__.replace('_', ' ')}")
