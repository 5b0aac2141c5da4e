"""Reads the calibrated cameras of a rig (cameras/1), and projects points with them."""
import json
import sys

import numpy as np


def read(path):
    """Per camera id: image_size, focal_px, center_px, distortion (k1 k2 p1 p2 k3, OpenCV's order), rotation: 3 x 3 and
    translation_mm of cam_from_world, and how well they are known."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] != "cameras/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not cameras/1")
    cameras = artifact["data"]["cameras"]
    for camera in cameras.values():
        pose = camera.pop("cam_from_world")
        camera["distortion"] = np.array([camera["distortion"][k] for k in ("k1", "k2", "p1", "p2", "k3")])
        camera["rotation"], camera["translation_mm"] = np.array(pose["rotation"]), np.array(pose["translation_mm"])
    return cameras


def project(camera, points):
    """Pixels of points in world space (#P x 3, mm): #P x 2; NaN behind the camera. Pixel (0, 0) is the centre of the
    top-left pixel."""
    in_cam = np.asarray(points, dtype=float) @ camera["rotation"].T + camera["translation_mm"]
    x, y = (in_cam[:, :2] / np.where(in_cam[:, 2:] > 0, in_cam[:, 2:], np.nan)).T
    k1, k2, p1, p2, k3 = camera["distortion"]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    distorted = np.stack([x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y], axis=1)
    return distorted * camera["focal_px"] + camera["center_px"]


if __name__ == "__main__":
    for name, camera in read(sys.argv[1]).items():
        eye = -camera["rotation"].T @ camera["translation_mm"]
        known = "" if camera["rms_px"] is None else f", {camera['rms_px']:.3g} px"
        print(f"{name}: {'x'.join(map(str, camera['image_size']))}, focal {camera['focal_px'][0]:.6g} px, at "
              f"{np.round(eye, 1).tolist()} mm{known}")
