"""Reads where the extracted images of a take are (frames/1)."""
import json
import pathlib
import sys


def read(path):
    """Per camera id: image_size, transfer, bit_depth, and images: frame number -> path, rising."""
    path = pathlib.Path(path)
    artifact = json.loads(path.read_text(encoding="utf-8"))
    if artifact["schema"] != "frames/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not frames/1")
    cameras = artifact["data"]["cameras"]
    for camera in cameras.values():
        pattern = camera["images"]
        numbers = [number for run in camera.pop("frames")
                   for number in range(run["first"], run["last"] + 1, run.get("step", 1))]
        camera["images"] = {number: path.parent / pattern.format(frame=number) for number in numbers}
    return cameras


if __name__ == "__main__":
    for name, camera in read(sys.argv[1]).items():
        print(f"{name}: {len(camera['images'])} images of {'x'.join(map(str, camera['image_size']))}, "
              f"{camera['bit_depth']} bit, {camera['transfer']}")
