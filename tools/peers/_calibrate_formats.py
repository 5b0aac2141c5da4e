"""What other programs see with the cameras that `calibrate convert` writes, and what it reads of theirs.

Files go out of a random rig and into OpenCV's `FileStorage`, a TOML reader and a reader of COLMAP's text as its
documentation has it; the other way, files are written by OpenCV. What cv2.projectPoints makes of either is compared with
the projection of `cameras/1` by the reader in `tools/readers`.
"""

import json
import sys
import tomllib
from pathlib import Path

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "readers"))
import cameras as reader  # noqa: E402

UNIT_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
# Ten, so that names and numbers sort differently.
COUNT = 10


def looking_at_origin(rng):
    """Rotation and translation (mm) of a camera half a metre to two metres away that looks near the origin."""
    eye = rng.normal(size=3)
    eye *= rng.uniform(500, 2000) / np.linalg.norm(eye)
    forward = -eye + rng.uniform(-50, 50, 3)
    forward /= np.linalg.norm(forward)
    right = np.cross(rng.normal(size=3), forward)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward])
    return rotation, -rotation @ eye


def random_rig(rng, path):
    """Writes a rig with lenses of every kind; returns its cameras as the reader reads them."""
    cameras = {}
    for number in range(COUNT):
        rotation, translation = looking_at_origin(rng)
        kept = [(), ("k1", "k2"), ("k1", "k2", "p1", "p2"), ("k1", "k2", "p1", "p2", "k3")][number % 4]
        distortion = {key: float(rng.uniform(-0.2, 0.2)) / (50 if key[0] == "p" else 1) if key in kept else 0.0
                      for key in ("k1", "k2", "p1", "p2", "k3")}
        cameras[f"m{number}"] = {
            "image_size": [656, 490], "focal_px": rng.uniform(700, 1200, 2).tolist(), "center_px": rng.uniform(200, 350, 2).tolist(),
            "distortion": distortion, "rms_px": None,
            "cam_from_world": {"rotation": rotation.tolist(), "translation_mm": translation.tolist()},
        }
    path.write_text(json.dumps({"schema": "cameras/1", "data": {"cameras": cameras, "take": None}}))
    return reader.read(path)


# ---------------------------------------------------------------- what others read: matrix, distortion, rotation, translation


def from_opencv(path):
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    nodes = storage.getNode("cameras")
    found = {}
    for node in (nodes.at(index) for index in range(nodes.size())):
        matrix, distortion, rotation, translation = (node.getNode(key).mat() for key in ("camera_matrix", "distortion_coefficients", "R", "T"))
        found[node.getNode("name").string()] = matrix, distortion, rotation, translation.ravel()
    return found


def from_toml(path):
    tables = tomllib.loads(path.read_text())
    return {t["name"]: (np.array(t["matrix"]), np.array(t["distortions"]), cv2.Rodrigues(np.array(t["rotation"]))[0], np.array(t["translation"]))
            for key, t in tables.items() if key != "metadata"}


def from_colmap(folder):
    rows = [line.split() for line in (folder / "cameras.txt").read_text().splitlines() if not line.startswith("#")]
    lenses = {}
    for number, model, _, _, *parameters in rows:
        fx, fy, cx, cy, *distortion = map(float, parameters)
        assert len(distortion) == {"PINHOLE": 0, "OPENCV": 4, "FULL_OPENCV": 8}[model]
        # The centre of the first pixel is (0.5, 0.5) there, (0, 0) in OpenCV.
        lenses[number] = np.array([[fx, 0, cx - 0.5], [0, fy, cy - 0.5], [0, 0, 1]]), np.array(distortion or [0.0] * 4)
    found = {}
    lines = [line for line in (folder / "images.txt").read_text().splitlines() if not line.startswith("#")]
    for line in lines[::2]:
        _, w, x, y, z, *shift, number, name = line.split()
        w, x, y, z = map(float, (w, x, y, z))
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        found[Path(name).stem] = *lenses[number], np.eye(3) + 2 * w * cross + 2 * cross @ cross, np.array(shift, float)
    return found


def seen(camera, points):
    matrix, distortion, rotation, translation = camera
    return cv2.projectPoints(points, cv2.Rodrigues(rotation)[0], translation, matrix, distortion)[0][:, 0]


def out_of_ours(ctx, rig, points, path, folder, unit):
    """Largest difference per format, px: files that we write, read by others."""
    forms = {"opencv yml": ("opencv", "a.yml", from_opencv), "opencv json": ("opencv", "a.json", from_opencv),
             "anipose": ("anipose", "a.toml", from_toml), "colmap": ("colmap", "a", from_colmap)}
    worst = {}
    for name, (form, file, read) in forms.items():
        ctx.run([ctx.binary("calibrate"), "convert", path, "--from", "furrow", "--to", form, "--unit", unit, "--out", folder / file])
        found = read(folder / file)
        assert set(found) == set(rig), f"{name}: {sorted(found)}"
        worst[name] = max(np.abs(seen(found[id], points / UNIT_MM[unit]) - reader.project(camera, points)).max() for id, camera in rig.items())
    return worst


def into_ours(ctx, rig, points, folder, unit):
    """Largest difference, px: files that OpenCV writes, one per camera, read by us."""
    worst = 0.0
    for index, (id, camera) in enumerate(rig.items()):
        path = folder / f"{id}.{('yml', 'json')[index % 2]}"
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
        (fx, fy), (cx, cy) = camera["focal_px"], camera["center_px"]
        storage.write("image_width", 656)
        storage.write("image_height", 490)
        storage.write("camera_matrix", np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]]))
        storage.write("distortion_coefficients", camera["distortion"])
        storage.write("rvec", cv2.Rodrigues(camera["rotation"])[0])
        storage.write("tvec", camera["translation_mm"] / UNIT_MM[unit])
        storage.release()
        ctx.run([ctx.binary("calibrate"), "convert", path, "--from", "opencv", "--to", "furrow", "--unit", unit, "--out", folder / "ours.json"])
        ours = reader.read(folder / "ours.json")[id]
        worst = max(worst, np.abs(reader.project(ours, points) - reader.project(camera, points)).max())
    return worst


def score(ctx):
    """The metrics; `calibrate.py` passes them on."""
    worst = {}
    for seed in ctx.seeds:
        rng = np.random.default_rng(seed)
        folder = ctx.tmp / f"formats-{seed}"
        folder.mkdir()
        rig = random_rig(rng, folder / "cameras.json")
        points = rng.uniform(-80, 80, (50, 3))
        unit = list(UNIT_MM)[seed % 3]
        found = out_of_ours(ctx, rig, points, folder / "cameras.json", folder, unit)
        found["from opencv"] = into_ours(ctx, rig, points, folder, unit)
        worst = {name: max(float(value), worst.get(name, 0.0)) for name, value in found.items()}
    yield {"metric": "formats_px", "value": max(worst.values()), "target": 1e-6, "better": "lower", "unit": "px",
           "context": {"by_format": worst, "cameras": COUNT * len(ctx.seeds), "points": 50, "opencv": cv2.__version__}}
