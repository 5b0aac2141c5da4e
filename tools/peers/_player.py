"""What a headless browser draws of the player's page of `wrinkle-blend`."""

import json
import os
import pathlib
import signal
import subprocess

import numpy as np

WEB = pathlib.Path(__file__).parents[2] / "crates/shared/loopback/web"
BROWSER_TEST = pathlib.Path(__file__).parents[2] / "crates/stages/wrinkle-blend/tests/browser/player.mjs"


def drawn(ctx, folder, states, *words):
    """What the player's page found in a headless browser, and per state its blended map (RGBA; 255 where the mesh lies) and shares."""
    out = ctx.tmp / f"{folder.name}-drawn"
    out.mkdir(exist_ok=True)
    call = [ctx.binary("wrinkle-blend"), "play", "--model", folder / "head.glb", "--poses", folder / "poses.json", "--neutral", folder / "neutral.png", "--no-open", *words]
    player = subprocess.Popen([str(word) for word in call], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        url = player.stdout.readline().strip()
        run = subprocess.run(["node", BROWSER_TEST, url, out, json.dumps(states)], capture_output=True, text=True, timeout=600, cwd=WEB)
        if run.returncode:
            raise RuntimeError(run.stderr.strip())
        found = json.loads(run.stdout)
    finally:
        player.send_signal(signal.SIGINT)
        player.wait(timeout=10)
    texels = []
    for number in range(len(states)):
        shape = json.loads((out / f"{number}.json").read_text())
        texels.append(np.fromfile(out / f"{number}.rgba", "u1").reshape(shape["height"], shape["width"], 4))
    return found, texels


def agreement(ctx, folder, frames, poses, reference):
    """The shader in a real browser beside the pictures of `reference` (a function of a frame's number): the least share of texels within
    one code of 8 bits, the largest difference, whether the first state is exact; what the page complained of and what it uploaded while
    it moved."""
    states = [{"poses": [0] * poses, "clip": "expressions", "frame": 15 * frame} for frame in frames]
    found, texels = drawn(ctx, folder, states)
    apart = [np.abs(shown[..., :3] - reference(frame)).max(axis=2)[shown[..., 3] == 255] for frame, shown in zip(frames, texels)]
    return {
        "share": min(float((one <= 1).mean()) for one in apart),
        "largest": max(float(one.max()) for one in apart),
        "exact": bool((apart[0] == 0).all()),
        "faults": len(found["errors"]),
        "uploads": found["uploads_while_moving"],
    }


def browser_lacks():
    """Why the browser cannot be asked, if so."""
    if subprocess.run(["which", "node"], capture_output=True).returncode:
        return "there is no node"
    if not (WEB / "node_modules/playwright-core").is_dir():
        return "the packages of pages are not installed: just web"
    browsers = [os.environ.get("FURROW_BROWSER", ""), "/usr/bin/chromium-headless-shell", "/usr/bin/chromium", "/usr/bin/chromium-browser"]
    return None if any(os.path.exists(path) for path in browsers) else "there is no Chromium"
