"""Numbers of the shared sparse solve: against CHOLMOD with METIS' ordering on the same matrices, one thread and two."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

from linear_shell import face_like, read_obj, spread_handles

REPEATS = 3
# OpenBLAS takes Haswell's kernels on processors that it does not know; the better of the two is the peer.
KERNELS = ["Haswell", "SkylakeX"]
SIZES = [30_000, 100_000, 300_000, 700_000, 1_400_000]


def metric(name, value, target, better, unit, **context):
    return {"metric": f"operators/{name}", "value": value, "target": target, "better": better, "unit": unit, "context": context}


# ---- problems --------------------------------------------------------------------------------------------------------


def shell_matrix(rest, triangles):
    """k_s L + k_b L M⁻¹ L with libigl's operators."""
    import igl
    import scipy.sparse as sp

    stiffness = -igl.cotmatrix(rest, triangles)
    inverse = sp.diags(1.0 / igl.massmatrix(rest, triangles, igl.MASSMATRIX_TYPE_VORONOI).diagonal())
    matrix = (stiffness + 100.0 * stiffness @ inverse @ stiffness).tocsr()
    matrix.sort_indices()
    return matrix


def write_problem(path, rest, matrix, handles):
    """The file that the example `solve_times` reads; its head says how."""
    with open(path, "wb") as out:
        np.array([matrix.shape[0], matrix.nnz, len(handles)], "<u8").tofile(out)
        rest.astype("<f8").tofile(out)
        matrix.indptr.astype("<u8").tofile(out)
        matrix.indices.astype("<u4").tofile(out)
        matrix.data.astype("<f8").tofile(out)
        np.asarray(handles).astype("<u4").tofile(out)
    return path


def read_problem(path):
    """The same file: matrix among the free vertices, couplings, handles, and the free vertices."""
    import scipy.sparse as sp

    with open(path, "rb") as file:
        vertices, entries, handle_count = map(int, np.fromfile(file, "<u8", 3))
        file.seek(24 * vertices, os.SEEK_CUR)
        starts = np.fromfile(file, "<u8", vertices + 1).astype(np.int32)
        columns = np.fromfile(file, "<u4", entries).astype(np.int32)
        values = np.fromfile(file, "<f8", entries)
        handles = np.fromfile(file, "<u4", handle_count).astype(np.int64)
    matrix = sp.csr_matrix((values, columns, starts), shape=(vertices, vertices))
    free = np.setdiff1d(np.arange(vertices), handles)
    rows = matrix[free]
    return rows[:, free].tocsc(), rows[:, handles].tocsc(), handles, free


def synthetic(ctx, vertex_count, slivers=False):
    path = ctx.tmp / f"face-{vertex_count}{'-slivers' if slivers else ''}.bin"
    if not path.exists():
        rest, triangles = face_like(vertex_count, 1)
        if slivers:
            rest = with_slivers(rest, triangles)
        write_problem(path, rest, shell_matrix(rest, triangles), spread_handles(rest, 90, 1))
    return path


def with_slivers(rest, triangles, share=0.002, height=1e-3):
    """Needles: in some triangles a corner is moved almost onto the opposite edge."""
    rng = np.random.default_rng(7)
    rest = rest.copy()
    for a, b, c in triangles[rng.random(len(triangles)) < share]:
        rest[a] = 0.5 * (rest[b] + rest[c]) + height * (rest[a] - 0.5 * (rest[b] + rest[c]))
    return rest


def scan(ctx):
    """The Lee Perry-Smith head, its triangles split in four until it has at least 300 000 vertices."""
    import igl

    path = ctx.tmp / "scan.bin"
    if not path.exists():
        rest, triangles = read_obj(ctx.data("head_lee_perry_smith") / "LeePerrySmith.obj")
        rest = rest * (220.0 / np.ptp(rest, axis=0).max())
        rest, _, renamed = np.unique(rest.round(9), axis=0, return_index=True, return_inverse=True)
        triangles = renamed.reshape(-1)[triangles]
        triangles = triangles[np.apply_along_axis(lambda t: len(set(t)) == 3, 1, triangles)]
        while len(rest) < 300_000:
            rest, triangles = igl.upsample(rest, triangles, 1)
        largest = np.bincount(igl.vertex_components(triangles)).argmax()
        keep = igl.vertex_components(triangles) == largest
        names = np.cumsum(keep) - 1
        rest, triangles = rest[keep], names[triangles[keep[triangles].all(axis=1)]]
        write_problem(path, rest, shell_matrix(rest, triangles), spread_handles(rest, 90, 1))
    return path


# ---- the two sides ---------------------------------------------------------------------------------------------------


def example(ctx, package, name, *features):
    """An optimised example program of a library, built on first use and kept apart, since features share its path."""
    kept = ctx.tmp / "-".join([name, *(feature.strip("-") for feature in features)])
    if not kept.exists():
        command = ["cargo", "build", "--release", "--locked", "--package", package, "--example", name, *features]
        built = subprocess.run([*command, "--message-format=json-render-diagnostics"], cwd=ctx.root, stdout=subprocess.PIPE, text=True)
        if built.returncode != 0:
            raise ctx.Failed(f"{package}'s example {name} does not build")
        messages = map(json.loads, built.stdout.splitlines())
        paths = [m["executable"] for m in messages if m.get("executable") and m["target"]["name"] == name]
        shutil.copy2(paths[-1], kept)
    return kept


def ours(ctx, problem, threads=1, *options, features=()):
    words = [example(ctx, "operators", "solve_times", *features), problem, "--threads", threads, *options]
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0:
        raise ctx.Failed(done.stderr.strip())
    return json.loads(done.stdout)


def peer(ctx, problem, threads=1, kernel="SkylakeX", order=None):
    """CHOLMOD in a process of its own, so that its threads and its memory are its own."""
    environment = os.environ | {"OPENBLAS_CORETYPE": kernel, "OPENBLAS_NUM_THREADS": str(threads), "OMP_NUM_THREADS": str(threads)}
    words = [sys.executable, str(Path(__file__).resolve()), str(problem), *([str(order)] if order else [])]
    done = subprocess.run(words, capture_output=True, text=True, env=environment)
    if done.returncode != 0:
        raise ctx.Failed(done.stderr.strip())
    return json.loads(done.stdout)


def status_mib(line):
    text = Path("/proc/self/status").read_text()
    return int(re.search(rf"{line}:\s+(\d+)", text)[1]) / 1024


def peer_main(problem, order=None):
    """Runs in the peer's process: times and memory as JSON, METIS' order into a file."""
    import resource
    import time

    from sksparse.cholmod import analyze

    def cpu():
        usage = resource.getrusage(resource.RUSAGE_SELF)
        return usage.ru_utime + usage.ru_stime

    seconds = {}

    def timed(name, work):
        start = cpu(), time.perf_counter()
        result = work()
        seconds.setdefault(name, []).append([cpu() - start[0], time.perf_counter() - start[1]])
        return result

    a, b, handles, free = read_problem(problem)
    few = -b @ np.random.default_rng(0).standard_normal((len(handles), 3))
    before = status_mib("VmRSS")
    symbolic = timed("analyze", lambda: analyze(a, ordering_method="metis", mode="supernodal"))
    factor = timed("factor", lambda: symbolic.cholesky(a))
    mib = max(0.0, status_mib("VmHWM") - before)
    for _ in range(REPEATS):
        timed("solve3", lambda: factor(few))
    full = -b.toarray()
    timed("basis", lambda: factor(full))
    if order:
        np.concatenate([free[factor.P()], handles]).astype("<u4").tofile(order)
    print(json.dumps({"seconds": seconds, "factor_mib": mib}))


# ---- accuracy --------------------------------------------------------------------------------------------------------


def score(ctx):
    plain, slivers = (ours(ctx, synthetic(ctx, 700_000, slivers)) for slivers in (False, True))
    note = "largest deviation from a field whose image under the matrix is the right-hand side"
    yield metric("accuracy_mm", plain["accuracy_mm"], 1e-6, "lower", "mm", vertices=plain["vertices"],
                 refined_mm=plain["refined_mm"], reference=note)
    yield metric("sliver_accuracy_mm", slivers["refined_mm"], 1e-5, "lower", "mm", vertices=slivers["vertices"],
                 unrefined_mm=slivers["accuracy_mm"],
                 slivers="one triangle in 500 is a needle a thousandth of its height")
    problem, order = synthetic(ctx, 700_000), ctx.tmp / "metis.order"
    peer(ctx, problem, order=order)
    metis = ours(ctx, problem, 1, "--order", order, "--repeats", "1")
    yield metric("fill_vs_metis", plain["entries"] / metis["entries"], 1.15, "lower", "1", entries=plain["entries"],
                 metis_entries=metis["entries"], stored=plain["stored"], note="non-zeros of L by structure, both by our count")


# ---- speed and memory ------------------------------------------------------------------------------------------------


def first_frame(seconds, column):
    """Ordering, symbolic, numeric, and the median solve of three columns."""
    parts = [name for name in ("ordering", "analyze", "factor") if name in seconds]
    return sum(seconds[name][0][column] for name in parts) + float(np.median([row[column] for row in seconds["solve3"]]))


def median(seconds, name, column):
    return float(np.median([row[column] for row in seconds[name]]))


def interleaved(ctx, problem, threads):
    """Runs of both sides by turns; of the peer, the kernels that factor faster. Column 0 is CPU time, 1 wall time."""
    column = 0 if threads == 1 else 1
    rows = {"ours": [], **{kernel: [] for kernel in KERNELS}}
    for _ in range(REPEATS):
        rows["ours"].append(ours(ctx, problem, threads))
        for kernel in KERNELS:
            rows[kernel].append(peer(ctx, problem, threads, kernel))
    best = min(KERNELS, key=lambda kernel: np.median([median(run["seconds"], "factor", column) for run in rows[kernel]]))
    return rows["ours"], rows[best], best, column


def ratio(name, target, mine, theirs, value, **context):
    ours_s, peers_s = [value(run) for run in mine], [value(run) for run in theirs]
    ratios = [a / b for a, b in zip(ours_s, peers_s)]
    return metric(name, float(np.median(ours_s) / np.median(peers_s)), target, "lower", "1", ours=ours_s, peers=peers_s,
                  ratio_min=min(ratios), ratio_max=max(ratios), **context)


def bench_cholmod(ctx):
    problem = synthetic(ctx, 700_000)
    mine, theirs, kernel, column = interleaved(ctx, problem, 1)
    about = {"peer": f"CHOLMOD + METIS, OpenBLAS {kernel}", "vertices": mine[0]["vertices"], "handles": 90}
    one = {"clock": "CPU seconds, one thread each", **about}
    of = lambda name: lambda run: median(run["seconds"], name, column)
    first = lambda run: first_frame(run["seconds"], column)
    yield ratio("first_frame_vs_cholmod", 0.35, mine, theirs, first, timed="ordering, symbolic, numeric, one solve of 3 columns", **one)
    yield ratio("factor_vs_cholmod", None, mine, theirs, of("factor"), timed="ours with the symbolic part, the peer's without", **one)
    yield ratio("solve3_vs_cholmod", 0.80, mine, theirs, of("solve3"), timed="forward and backward, permutation included", **one)
    yield ratio("basis90_vs_cholmod", 0.50, mine, theirs, of("basis"), timed="90 columns, ours rounded to f32 and in vertex order", **one)
    yield ratio("memory_vs_cholmod", 1.15, mine, theirs, lambda run: run["factor_mib"], unit_of_lists="MiB",
                note="peak above the matrix, ordering and factorisation", **about)
    mine, theirs, kernel, column = interleaved(ctx, problem, 2)
    two = about | {"peer": f"CHOLMOD + METIS, OpenBLAS {kernel}", "clock": "wall seconds, two threads each"}
    first = lambda run: first_frame(run["seconds"], column)
    yield ratio("first_frame_vs_cholmod_2t", 0.35, mine, theirs, first, timed="ordering, symbolic, numeric, one solve of 3 columns", **two)
    yield ratio("factor_vs_cholmod_2t", None, mine, theirs, of("factor"), timed="ours with the symbolic part, the peer's without", **two)


def bench_narrow(ctx):
    """The same without AVX-512, on both sides."""
    problem = synthetic(ctx, 300_000)
    mine = [ours(ctx, problem, features=["--no-default-features"]) for _ in range(REPEATS)]
    theirs = [peer(ctx, problem, 1, "Haswell") for _ in range(REPEATS)]
    about = {"peer": "CHOLMOD + METIS, OpenBLAS Haswell", "vertices": mine[0]["vertices"], "clock": "CPU seconds, one thread each",
             "note": "substitution without AVX-512; faer's dense products still choose their own instructions"}
    yield ratio("avx2_solve3_vs_cholmod", None, mine, theirs, lambda run: median(run["seconds"], "solve3", 0), **about)


def bench_scan(ctx):
    problem = scan(ctx)
    mine, theirs, kernel, column = interleaved(ctx, problem, 1)
    yield ratio("scan_first_frame_vs_cholmod", None, mine, theirs, lambda run: first_frame(run["seconds"], column),
                peer=f"CHOLMOD + METIS, OpenBLAS {kernel}", vertices=mine[0]["vertices"], clock="CPU seconds, one thread each",
                mesh="Lee Perry-Smith head, subdivided")


def bench_scaling(ctx):
    table = {}
    for size in SIZES:
        runs = [ours(ctx, synthetic(ctx, size), 1) for _ in range(REPEATS)]
        table[runs[0]["vertices"]] = float(np.median([first_frame(run["seconds"], 0) for run in runs]))
    sizes, times = np.log(list(table)), np.log(list(table.values()))
    yield metric("scaling_exponent", float(np.polyfit(sizes, times, 1)[0]), 1.35, "lower", "1", first_frame_s=table,
                 timed="ordering, symbolic, numeric, one solve of 3 columns; CPU seconds of one thread")


def bench(ctx):
    yield from bench_cholmod(ctx)
    yield from bench_narrow(ctx)
    yield from bench_scan(ctx)
    yield from bench_scaling(ctx)


if __name__ == "__main__":
    peer_main(*sys.argv[1:])
