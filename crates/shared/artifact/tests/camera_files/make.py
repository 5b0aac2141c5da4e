"""Writes the files of this folder with the programs whose formats they are; run it once per program:

    python3 make.py opencv 4 | opencv 5    (needs cv2 of that version)
    python3 make.py anipose                (needs aniposelib)
    python3 make.py colmap                 (needs pycolmap)
    python3 make.py pixels                 (needs cv2: what the cameras see)
"""
import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
# Id: image size, focal lengths, principal point, k1 k2 p1 p2 k3, axis times angle, translation in m.
CAMERAS = {
    "left": ((656, 490), (900.5, 901.25), (327.4, 244.6), (-0.11, 0.023, 0.0011, -0.0017, 0.004), (0.1, -0.2, 0.03), (0.01, -0.02, 0.7)),
    "right": ((1384, 1038), (1800.0, 1799.0), (691.25, 518.75), (0.08, -0.1, 0.0, 0.0, 0.0), (2.9, 0.4, -0.7), (-0.03, 0.04, 0.9)),
}
# Around the head, m.
POINTS = [[x, y, z] for x in (-0.1, 0.03) for y in (-0.12, 0.0, 0.11) for z in (-0.05, 0.06)]


def matrix(camera):
    return [[camera[1][0], 0.0, camera[2][0]], [0.0, camera[1][1], camera[2][1]], [0.0, 0.0, 1.0]]


def opencv(version):
    import cv2
    import numpy as np
    assert cv2.__version__.startswith(version)
    size, _, _, distortion, turn, shift = camera = CAMERAS["left"]
    for ending in ("yml", "json"):
        out = cv2.FileStorage(str(HERE / f"opencv{version}.{ending}"), cv2.FILE_STORAGE_WRITE)
        out.write("calibration_time", "it's \"now\", at l'Atelier")
        out.write("nframes", 24)
        out.writeComment("flags: none", False)
        out.write("name", "left")
        out.write("image_width", size[0])
        out.write("image_height", size[1])
        out.write("camera_matrix", np.array(matrix(camera)))
        out.write("distortion_coefficients", np.array([distortion]).T)
        out.write("rvec", np.array([turn]).T)
        out.write("tvec", np.array([shift]).T)
        out.write("avg_reprojection_error", 0.125)
        out.write("grid_points", np.zeros((2, 3), np.float32))
        out.write("per_view", np.array([np.nan, 1.0, np.inf]).reshape(3, 1))
        out.release()
    pair = cv2.FileStorage(str(HERE / f"pair{version}.yml"), cv2.FILE_STORAGE_WRITE)
    for number, camera in enumerate(CAMERAS.values(), 1):
        pair.write(f"M{number}", np.array(matrix(camera)))
        pair.write(f"D{number}", np.array([camera[3]]))
    # x_2 = R x_1 + T
    first, second = ((cv2.Rodrigues(np.array(camera[4]))[0], np.array([camera[5]]).T) for camera in CAMERAS.values())
    turn = second[0] @ first[0].T
    pair.write("R", turn)
    pair.write("T", second[1] - turn @ first[1])
    pair.release()


def anipose():
    from aniposelib.cameras import Camera, CameraGroup
    cameras = [Camera(matrix=matrix(c), dist=c[3], size=c[0], rvec=c[4], tvec=c[5], name=name) for name, c in CAMERAS.items()]
    CameraGroup(cameras, {"adjusted": False, "error": 0.25}).dump(str(HERE / "anipose.toml"))


def colmap():
    import numpy as np
    import pycolmap
    rebuilt = pycolmap.Reconstruction()
    for number, (name, ((width, height), focal, center, distortion, turn, shift)) in enumerate(CAMERAS.items(), 1):
        k1, k2, p1, p2, k3 = distortion
        # COLMAP: (0.5, 0.5) is the centre of the top-left pixel.
        parameters = [*focal, center[0] + 0.5, center[1] + 0.5, k1, k2, p1, p2] + ([k3, 0, 0, 0] if k3 else [])
        camera = pycolmap.Camera(model="FULL_OPENCV" if k3 else "OPENCV", width=width, height=height, params=parameters, camera_id=number)
        rebuilt.add_camera_with_trivial_rig(camera)
        angle = np.linalg.norm(turn)
        rotation = pycolmap.Rotation3d(np.append(np.sin(angle / 2) * np.array(turn) / angle, np.cos(angle / 2)))
        image = pycolmap.Image(name=f"{name}.png", points2D=pycolmap.Point2DList(), camera_id=number, image_id=number)
        rebuilt.add_image_with_trivial_frame(image, pycolmap.Rigid3d(rotation, np.array(shift)))
    (HERE / "colmap").mkdir(exist_ok=True)
    rebuilt.write_text(str(HERE / "colmap"))


def pixels():
    import cv2
    import numpy as np
    seen = {}
    for name, camera in CAMERAS.items():
        arguments = [np.array(values) for values in (POINTS, camera[4], camera[5], matrix(camera), camera[3])]
        seen[name] = cv2.projectPoints(*arguments)[0][:, 0].tolist()
    text = json.dumps({"points_m": POINTS, "pixels": seen})
    (HERE / "pixels.json").write_text(text.replace("], [", "],\n [") + "\n")


if __name__ == "__main__":
    globals()[sys.argv[1]](*sys.argv[2:])
