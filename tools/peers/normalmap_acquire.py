"""Scores of `normalmap-acquire`: normals of rendered skin, whose true ones are known, and of real photographs. And its speed beside NumPy.

Patches come from `virtual-rig pair`: 3 to 5 grooves, round or creased, under open sky or a flash, with everything that spoils photographs. Steep
is what truly tilts by more than 10°. Beside the estimator stand a flat map, the paper's rule as it is printed, and the paper's rule after the
median of the ratio was divided out, which it does not say. The transcription of the paper's rule in NumPy shares no code with the stage.
"""

import csv
import hashlib
import json
import statistics
import time

import cv2
import numpy as np
from scipy import ndimage
from scipy.fft import dctn, idctn

SEEDS = list(range(1, 11))
SUBJECTS = ["038", "107", "140", "172"]
STEEP_DEG = 10.0
# Outside of this share of the side landmarks do not reach, or the moved picture ends.
BORDER = 0.1
# MediaPipe's numbers around the middle of the forehead, above the brows.
FOREHEAD = [103, 67, 109, 10, 338, 297, 332, 334, 296, 336, 9, 107, 66, 105]
# MediaPipe's numbers along the oval of the face, from the forehead's middle to the subject's left.
OVAL = [10, 338, 297, 332, 284, 251, 389, 356, 454, 323, 361, 288, 397, 365, 379, 378, 400, 377, 152, 148, 176, 149, 150, 136, 172,
        58, 132, 93, 234, 127, 162, 21, 54, 103, 67, 109]
# The rim of the face in which no wrinkle ends: this share of its size.
RIM = 0.88
FACES = [("brows-up", 0), ("brows-up", 1), ("frown", 0.5), ("smile", 0)]
FACE_SEEDS = 3
FACE_SIZE = ["--vertices", 120000, "--side", 768]
FILM_FRAMES = 5
LUMA = np.array([0.0722, 0.7152, 0.2126])
REPEATS = 3


def metric(name, value, target, better, unit, **context):
    value = None if value is None else float(value)
    return {"metric": name, "value": value, "target": target, "better": better, "unit": unit, "context": context}


def pair(ctx, kind, flash, seed):
    """A pair of photographs, kept outside the repository under what draws it."""
    folder = ctx.root / "crates" / "stages" / "virtual-rig" / "src" / "pair"
    text = b"".join(b"".join(path.read_bytes().split()) for path in sorted(folder.glob("*.rs")))
    out = ctx.cache / f"pairs-{hashlib.sha256(text).hexdigest()[:12]}" / f"{kind}_{flash}_{seed}"
    if not (out / "truth" / "pair.json").exists():
        out.parent.mkdir(parents=True, exist_ok=True)
        ctx.run([ctx.binary("virtual-rig"), "pair", "--scenario", kind, "--flash", flash, "--seed", seed, "--out", out])
    return out


def face(ctx, expression, flash, seed, frames=None):
    """A pair of photographs of a whole face, and the film of the way there."""
    folder = ctx.root / "crates" / "stages" / "virtual-rig" / "src"
    text = b"".join(b"".join(path.read_bytes().split()) for path in sorted(folder.rglob("*.rs")) if "score" not in path.parts)
    out = ctx.cache / f"faces-{hashlib.sha256(text).hexdigest()[:12]}" / f"{expression}_{flash}_{seed}_{frames}"
    if not (out / "truth" / "pair.json").exists():
        out.parent.mkdir(parents=True, exist_ok=True)
        words = ["pair", "--face", expression, "--flash", flash, "--seed", seed, *FACE_SIZE, "--out", out]
        ctx.run([ctx.binary("virtual-rig"), *words, *(["--frames", frames] if frames else [])])
    return out


def faces(ctx, seeds):
    """Errors on whole faces, light unknown: on what is steep, and false tilts where the skin is still."""
    steep = {name: [] for name in ("flat", "ours", "paper", "normalised")}
    still, counted = [], []
    for expression, flash in FACES:
        for seed in seeds:
            folder = face(ctx, expression, flash, seed)
            truth = decoded(folder / "truth" / "normals.png")
            skin = cv2.imread(str(folder / "truth" / "normals.png"), cv2.IMREAD_UNCHANGED).any(axis=2)
            flat = flat_like(truth)
            tilt = angles(truth, flat)
            folds = skin & (tilt > STEEP_DEG)
            maps = {"flat": flat, "ours": acquire(ctx, folder), **{name: acquire(ctx, folder, *args) for name, args in PAPER.items()}}
            for name, found in maps.items():
                steep[name].append(angles(found, truth)[folds])
            still.append(angles(maps["ours"], flat)[skin & (tilt < 2)])
            counted.append(angles(maps["ours"], flat)[folds] > 0.5)
    return {name: np.concatenate(values) for name, values in steep.items()}, np.concatenate(still), np.concatenate(counted)


def film(ctx, seed):
    """How far the measured shares of the wrinkles are from the true ones, over the frames of a film."""
    folder = face(ctx, "brows-up", 0, seed, FILM_FRAMES)
    out = ctx.tmp / "theta.json"
    words = [ctx.binary("normalmap-acquire"), "fit-modulation", "--neutral", folder / "neutral.png", "--neutral-landmarks",
             folder / "neutral-landmarks.json", "--frames", folder / "frames" / "{frame:04}.png", "--frame-landmarks",
             folder / "frames" / "{frame:04}.json", "--out", out]
    ctx.run(words)
    found = np.array(json.loads(out.read_text())["frames"])
    truth = np.array(json.loads((folder / "truth" / "film.json").read_text())["frames"])
    return found, truth


def decoded(path):
    """Unit normals of a 16-bit map, y up."""
    raw = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[:, :, ::-1] / 65535.0 * 2 - 1
    return raw / np.linalg.norm(raw, axis=2, keepdims=True)


def acquire(ctx, folder, *args):
    out = ctx.tmp / "normals.png"
    words = [ctx.binary("normalmap-acquire"), "acquire", "--bits", 16, "--out", out]
    for side in ("neutral", "expression"):
        words += [f"--{side}", folder / f"{side}.png", f"--{side}-landmarks", folder / f"{side}-landmarks.json"]
    ctx.run([*words, *args])
    return decoded(out)


def angles(a, b):
    return np.degrees(np.arccos(np.clip((a * b).sum(2), -1, 1)))


def flat_like(normals):
    flat = np.zeros_like(normals)
    flat[:, :, 2] = 1
    return flat


def patches(ctx, seeds, kinds, **methods):
    """Errors of each method on steep pixels and on flat skin, degrees, over all patches of some kinds."""
    steep = {name: [] for name in ["flat", *methods]}
    skin = {name: [] for name in ["flat", *methods]}
    for kind, flash in kinds:
        for seed in seeds:
            folder = pair(ctx, kind, flash, seed)
            truth = decoded(folder / "truth" / "normals.png")
            flat = flat_like(truth)
            tilt = angles(truth, flat)
            border = int(BORDER * len(truth))
            inner = np.zeros(tilt.shape, bool)
            inner[border:-border, border:-border] = True
            maps = {name: acquire(ctx, folder, *args) for name, args in methods.items()}
            for name, found in {"flat": flat, **maps}.items():
                errors = angles(found, truth)
                steep[name].append(errors[inner & (tilt > STEEP_DEG)])
                skin[name].append(errors[inner & (tilt < 2)])
    join = lambda lists: {name: np.concatenate(values) for name, values in lists.items()}
    return join(steep), join(skin)


PAPER = {"paper": ["--mode", "paper"], "normalised": ["--mode", "paper", "--exposure", "global"]}


def table(errors):
    """Median, 90 % and mean of each method, for the context."""
    return {name: [round(float(f(e)), 2) for f in (np.median, p90, np.mean)] for name, e in errors.items() if len(e)}


def p90(errors):
    return np.quantile(errors, 0.9)


def score(ctx):
    seeds = ctx.seeds or SEEDS
    lit = lambda name: {"ours": ["--light", name], **PAPER}
    context = {"seeds": len(seeds), "table": "median, 90 %, mean on steep pixels"}
    ambient, _ = patches(ctx, seeds, [("round", 0), ("crease", 0)], **lit("ambient"))
    yield metric("ambient_ours_deg", np.median(ambient["ours"]), 10, "lower", "deg", **context, **table(ambient))
    yield metric("ambient_ours_p90_deg", p90(ambient["ours"]), 20, "lower", "deg", **context)
    for kind, wanted in (("round", [("p90", p90, 0.5), ("mean", np.mean, 0.55)]), ("crease", [("mean", np.mean, 0.85)])):
        found, _ = patches(ctx, seeds, [(kind, 1)], **lit("flash"))
        for name, value, target in wanted:
            ratio = value(found["ours"]) / value(found["paper"])
            yield metric(f"flash_{kind}_{name}_vs_paper", ratio, target, "lower", "ratio", **context, **table(found))
            ratio = value(found["ours"]) / value(found["normalised"])
            yield metric(f"flash_{kind}_{name}_vs_normalised_paper", ratio, None, None, "ratio")
    kinds = [(kind, flash) for kind in ("round", "crease") for flash in (0, 1)]
    blind, _ = patches(ctx, seeds, kinds, **lit("unknown"))
    ratio = np.mean(blind["ours"]) / np.mean(blind["paper"])
    yield metric("unknown_light_mean_vs_paper", ratio, 0.92, "lower", "ratio", **context, **table(blind))
    ratio = np.mean(blind["ours"]) / np.mean(blind["normalised"])
    yield metric("unknown_light_mean_vs_normalised_paper", ratio, None, None, "ratio")
    _, skin = patches(ctx, seeds, [("flat", 0), ("flat", 1)], **lit("unknown"))
    yield metric("flat_false_tilt_p90_deg", p90(skin["ours"]), 7, "lower", "deg", paper=float(p90(skin["paper"])),
                 normalised=float(p90(skin["normalised"])), seeds=len(seeds), light="unknown")
    yield paper_rel(ctx, seeds[0])
    few = seeds[:FACE_SEEDS]
    found, still, counted = faces(ctx, few)
    context = {"seeds": len(few), "light": "found by the stage", "faces": len(FACES) * len(few), "table": "median, 90 %, mean on steep pixels"}
    yield metric("face_deg", np.median(found["ours"]), None, None, "deg", **context, **table(found), steep_covered=float(counted.mean()))
    yield metric("face_mean_vs_paper", found["ours"].mean() / found["paper"].mean(), 0.92, "lower", "ratio", **context)
    yield metric("face_mean_vs_normalised_paper", found["ours"].mean() / found["normalised"].mean(), None, None, "ratio")
    yield metric("face_false_tilt_p90_deg", p90(still), 4, "lower", "deg", seeds=len(few))
    measured, true = film(ctx, seeds[0])
    yield metric("film_shown_rms", np.sqrt(np.mean((measured[:, 1] - true[:, 1]) ** 2)), None, None, "share", frames=FILM_FRAMES,
                 way_rms=float(np.sqrt(np.mean((measured[:, 0] - true[:, 0]) ** 2))), true=[round(float(x), 3) for x in true[:, 1]])
    yield from real(ctx)
    yield outside(ctx)


def linear(path):
    codes = cv2.imread(str(path), cv2.IMREAD_COLOR).astype(float) / 255
    return np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4) @ LUMA


def by_paper(neutral, expression, sigma):
    """[DutreveMeyer2011, Eq. 1-3] in NumPy, N_z = 1."""
    ratio = ndimage.gaussian_filter(expression / neutral, sigma, mode="nearest", truncate=4.0)
    down, right = np.gradient(ratio)
    length = np.hypot(right, down)
    z = np.clip(ratio, 0, 1)
    across = np.sqrt(1 - z * z) / np.maximum(length, 1e-300)
    sure = length > 1e-12
    return np.dstack([np.where(sure, -across * right, 0), np.where(sure, across * down, 0), np.where(sure, z, 1)])


def paper_rel(ctx, seed):
    """Largest difference from the transcription, where the gradient has a direction. Both photographs share their landmarks."""
    folder = pair(ctx, "round", 0, seed)
    numbers, io, blur = ctx.tmp / "normals.npy", 400.0, 0.005
    words = [ctx.binary("normalmap-acquire"), "acquire", "--mode", "paper", "--interocular-px", io, "--blur", blur]
    for side in ("neutral", "expression"):
        words += [f"--{side}", folder / f"{side}.png", f"--{side}-landmarks", folder / "neutral-landmarks.json"]
    ctx.run([*words, "--out", ctx.tmp / "paper.png", "--npy", numbers])
    neutral, expression = linear(folder / "neutral.png"), linear(folder / "expression.png")
    wanted = by_paper(neutral, expression, blur * io)
    found = np.load(numbers).reshape(wanted.shape)
    ratio = ndimage.gaussian_filter(expression / neutral, blur * io, mode="nearest", truncate=4.0)
    down, right = np.gradient(ratio)
    # The root is steep at R = 1, and directions are noise where the gradient vanishes.
    sound = (np.hypot(right, down) > 1e-6) & (np.abs(1 - ratio) > 1e-6)
    worst = np.abs(found - wanted)[sound].max()
    return metric("paper_mode_rel", worst, 1e-6, "lower", "rel", reference="NumPy and SciPy", pixels=int(sound.sum()))


def photographs(ctx, subject, *args):
    """The map of a real pair, the folder of its steps, and the arguments."""
    data = ctx.data("photo_pairs_london")
    steps = ctx.tmp / f"steps-{subject}"
    out = ctx.tmp / f"{subject}.png"
    words = [ctx.binary("normalmap-acquire"), "acquire", "--bits", 16, "--out", out, "--debug", steps]
    for side, name in (("neutral", "neutral"), ("expression", "smile")):
        words += [f"--{side}", data / f"{subject}_{name}.jpg", f"--{side}-landmarks", data / f"{subject}_{name}.lm478.csv"]
    ctx.run([*words, *args])
    return decoded(out), steps, data


def rim(data, subject, shape):
    """The face's edge: jaw, temples, hairline."""
    inner = polygon(data, subject, OVAL, shape, RIM)
    return polygon(data, subject, OVAL, shape, 1.0) & ~inner


def polygon(data, subject, ids, shape, share=0.85):
    with open(data / f"{subject}_neutral.lm478.csv") as file:
        rows = list(csv.DictReader(file))
    places = np.array([[float(rows[i]["x_px"]), float(rows[i]["y_px"])] for i in ids])
    middle = places.mean(0)
    inside = np.zeros(shape, np.uint8)
    cv2.fillPoly(inside, [np.round(middle + share * (places - middle)).astype(np.int32)], 1)
    return inside > 0


def real(ctx):
    tilts, papers, misses, before, rims = [], [], [], [], []
    for subject in SUBJECTS:
        found, steps, data = photographs(ctx, subject)
        rest = polygon(data, subject, FOREHEAD, found.shape[:2])
        tilts.append(angles(found, flat_like(found))[rest])
        rims.append(angles(found, flat_like(found))[rim(data, subject, found.shape[:2])])
        neutral = linear(data / f"{subject}_neutral.jpg")
        skin = region(steps)
        misses.append(blocks(neutral, steps, skin))
        paper, steps, _ = photographs(ctx, subject, "--mode", "paper", "--exposure", "global")
        papers.append(angles(paper, flat_like(paper))[rest])
        before.append(blocks(neutral, steps, skin))
    join = np.concatenate
    yield metric("forehead_false_tilt_p90_deg", p90(join(tilts)), 4, "lower", "deg", normalised_paper=float(p90(join(papers))),
                 by_subject=[round(float(p90(t)), 2) for t in tilts], expression="smile")
    yield metric("rim_false_tilt_p90_deg", p90(join(rims)), 4, "lower", "deg", by_subject=[round(float(p90(t)), 2) for t in rims],
                 p99=float(np.quantile(join(rims), 0.99)), where=f"outside of {RIM} of the face's oval: jaw, temples, hairline")
    yield metric("registration_px", p90(join(misses)), 2.5, "lower", "px", median=float(np.median(join(misses))),
                 by_landmarks_alone_p90=float(p90(join(before))), blocks=len(join(misses)), measured="block matching of 41 px, 90 %")


def region(steps):
    """The skin that counts, without the holes that blotches leave in it."""
    weight = cv2.imread(str(steps / "mask.png"), cv2.IMREAD_UNCHANGED)
    return cv2.morphologyEx((weight > 0).astype(np.uint8), cv2.MORPH_CLOSE, np.ones((25, 25), np.uint8))


def blocks(neutral, steps, skin):
    """How far blocks of skin lie from where they should, by normalised correlation of high-passed light, px."""
    high = lambda light: np.log(np.maximum(light, 1e-3)) - cv2.GaussianBlur(np.log(np.maximum(light, 1e-3)), (0, 0), 8)
    codes = cv2.imread(str(steps / "warped.png"), cv2.IMREAD_UNCHANGED) / 65535.0
    warped = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    skin = ndimage.uniform_filter(skin.astype(float), 41)
    a, b = (high(light).astype(np.float32) for light in (neutral, warped))
    half, reach, out = 20, 12, []
    for y in range(60, a.shape[0] - 60, 20):
        for x in range(60, a.shape[1] - 60, 20):
            if skin[y, x] < 0.9:
                continue
            here = a[y - half : y + half + 1, x - half : x + half + 1]
            there = b[y - half - reach : y + half + reach + 1, x - half - reach : x + half + reach + 1]
            fit = cv2.matchTemplate(there, here, cv2.TM_CCOEFF_NORMED)
            row, column = np.unravel_index(np.argmax(fit), fit.shape)
            # A block without structure fits anywhere.
            if fit[row, column] > 0.6 and 0 < row < 2 * reach and 0 < column < 2 * reach:
                out.append(np.hypot(row - reach, column - reach))
    return np.array(out)


def outside(ctx):
    """The largest change of a code outside a painted mask."""
    data = ctx.data("photo_pairs_london")
    shape = cv2.imread(str(data / "172_neutral.jpg")).shape[:2]
    mask = np.zeros(shape, np.uint8)
    cv2.circle(mask, (585, 700), 90, 255, -1)
    cv2.imwrite(str(ctx.tmp / "mask.png"), mask)
    photographs(ctx, "172", "--mask", ctx.tmp / "mask.png")
    codes = cv2.imread(str(ctx.tmp / "172.png"), cv2.IMREAD_UNCHANGED)[:, :, ::-1].astype(int)
    change = np.abs(codes - [32768, 32768, 65535]).max(2)
    return metric("outside_mask_change", change[mask == 0].max(), 0, "equal", "codes", inside=int(change[mask > 0].max()))


def solved(p, q, scale):
    """The surface of given slopes by cosines."""
    right, down = 0.5 * (p[:, 1:] + p[:, :-1]), 0.5 * (q[1:] + q[:-1])
    divergence = np.zeros_like(p)
    divergence[:, :-1] += right
    divergence[:, 1:] -= right
    divergence[:-1] += down
    divergence[1:] -= down
    along = [2 - 2 * np.cos(np.pi * np.arange(size) / size) for size in p.shape]
    return idctn(dctn(-divergence, norm="ortho") / (along[1][None] + along[0][:, None] + scale**-2), norm="ortho")


def by_numpy(neutral, expression, places, io):
    """The estimator's steps: warp, refinement (OpenCV's DIS flow), local exposure, slopes and side, coherence, surface."""
    blur = lambda plane, sigma: cv2.GaussianBlur(plane, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE)
    from scipy.interpolate import RBFInterpolator

    grid = np.mgrid[0 : neutral.shape[0] + 8 : 8, 0 : neutral.shape[1] + 8 : 8]
    warp = RBFInterpolator(places[0] / io, places[1], kernel="thin_plate_spline", smoothing=1e-3)
    coarse = warp(np.stack([grid[1].ravel(), grid[0].ravel()], 1) / io).reshape(*grid[0].shape, 2).astype(np.float32)
    fine = np.mgrid[0 : neutral.shape[0], 0 : neutral.shape[1]].astype(np.float32) / 8
    field = cv2.remap(coarse, fine[1], fine[0], cv2.INTER_CUBIC)
    fetch = lambda: cv2.remap(expression, field[:, :, 0], field[:, :, 1], cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    structure = lambda light: (lambda log: log - blur(log, 0.05 * io))(np.log(np.maximum(light, 1e-4)))
    code = lambda plane: np.clip(128 + 400 * plane, 0, 255).astype(np.uint8)
    flow = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM).calc(code(structure(neutral)), code(structure(fetch())), None)
    flow = blur(flow, 0.03 * io)
    field = cv2.remap(field, 8 * fine[1] + flow[:, :, 0], 8 * fine[0] + flow[:, :, 1], cv2.INTER_LINEAR)
    log = np.log(np.maximum(fetch(), 1e-6) / np.maximum(neutral, 1e-6))
    exposure = np.full_like(log, np.median(log))
    for _ in range(4):
        off = log - exposure
        spread = 1.4826 * np.median(np.abs(off))
        trust = 1 / (1 + np.where(off < 0, off / spread, off / (2.5 * spread)) ** 4)
        exposure = blur(trust * log, 0.08 * io) / blur(trust, 0.08 * io)
    ratio = np.exp(log - exposure)
    smooth = blur(ratio, 0.005 * io)
    noise = 1.4826 * np.median(np.abs(smooth - blur(smooth, 0.012 * io)))
    dark = np.maximum(0, 1 - np.maximum(smooth, 0.35))
    dark = dark**2 / (dark + noise)
    steep = 1.2 * np.sqrt(1 / (1 - dark) ** 2 - 1)
    gy, gx = np.gradient(blur(ratio, 0.01 * io))
    xx, xy, yy = (blur(product, 0.02 * io) for product in (gx * gx, gx * gy, gy * gy))
    stripes = np.clip((np.hypot(xx - yy, 2 * xy) / (xx + yy + 1e-18) - 0.2) / 0.35, 0, 1)
    gy, gx = np.gradient(blur(ratio, 0.016 * io))
    length = np.hypot(gx, gy)
    scale = stripes * steep / np.hypot(length, 0.7 * 1.4826 * np.median(length))
    height = solved(scale * gx, scale * gy, 0.1 * io)
    down, right = np.gradient(height)
    normals = np.dstack([-right, down, np.ones_like(right)])
    return normals / np.linalg.norm(normals, axis=2, keepdims=True)


def bench(ctx):
    """A real pair brought to 2048 px a side; one thread each; decoding apart."""
    data = ctx.data("photo_pairs_london")
    cv2.setNumThreads(1)
    words, lights, places = [ctx.binary("normalmap-acquire"), "acquire", "--out", ctx.tmp / "big.png", "--threads", 1], [], []
    for side, name in (("neutral", "neutral"), ("expression", "smile")):
        picture = cv2.imread(str(data / f"172_{name}.jpg"))
        factor = 2048 / picture.shape[0]
        cv2.imwrite(str(ctx.tmp / f"{side}.png"), cv2.resize(picture, (2048, 2048), interpolation=cv2.INTER_CUBIC))
        with open(data / f"172_{name}.lm478.csv") as file:
            rows = [[factor * float(row[key]) for key in ("x_px", "y_px", "z_rel")] for row in csv.DictReader(file)]
        with open(ctx.tmp / f"{side}.csv", "w") as file:
            file.write("x_px,y_px,z_rel\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows))
        words += [f"--{side}", ctx.tmp / f"{side}.png", f"--{side}-landmarks", ctx.tmp / f"{side}.csv"]
        lights.append(linear(ctx.tmp / f"{side}.png").astype(np.float32))
        places.append(np.array(rows)[:468, :2])
    io = float(np.hypot(*(places[0][33] + places[0][133] - places[0][362] - places[0][263]) / 2))
    ours, theirs = [], []
    for _ in range(REPEATS):
        ours.append(ctx.run(words)["seconds"]["acquire"])
        start = time.perf_counter()
        by_numpy(*lights, places, io)
        theirs.append(time.perf_counter() - start)
    context = {"repeats": REPEATS, "threads": 1, "size": "2048 x 2048", "timed": "warp, refinement, masks, normals; decoding and encoding apart"}
    yield metric("time_2048_s", statistics.median(ours), 2, "lower", "s", least=min(ours), most=max(ours), **context)
    ratios = [a / b for a, b in zip(ours, theirs)]
    yield metric("vs_numpy", statistics.median(ratios), 0.3, "lower", "ratio", least=min(ratios), most=max(ratios), numpy_s=statistics.median(theirs),
                 peer=f"NumPy {np.__version__}, SciPy, OpenCV {cv2.__version__} with DIS flow", **context)
