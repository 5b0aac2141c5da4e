"""What a stage's metrics get to work with: binaries, data, folders, seeds."""

import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path


class Missing(Exception):
    """Something outside the project is not there: its metrics count as failed, with this as the reason."""


class Failed(Exception):
    """A stage did not do its work; the text is what it said."""


class Context:
    """The context of one run of the scoreboard; used in a `with`, it removes its temporary folder."""

    Missing = Missing
    Failed = Failed

    def __init__(self, seeds):
        self.seeds = seeds
        self.root = Path(__file__).resolve().parents[2]
        self._built = {}
        self._tmp = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._tmp:
            shutil.rmtree(self._tmp, ignore_errors=True)

    @property
    def tmp(self):
        """A folder of this run, removed at its end."""
        if self._tmp is None:
            self._tmp = Path(tempfile.mkdtemp(prefix="furrow-"))
        return self._tmp

    @property
    def cache(self):
        """A folder outside the repository that outlives the run, e.g. for synthetic takes."""
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        folder = base / "furrow"
        folder.mkdir(parents=True, exist_ok=True)
        return folder

    def data(self, folder):
        """A folder of real data; `FURROW_DATA` says where they are."""
        base = Path(os.environ.get("FURROW_DATA") or self.root.parent / "shared" / "data")
        if not (base / folder).is_dir():
            raise Missing(f"the data set {folder} is absent (just fetch-data says where it comes from)")
        return base / folder

    def binary(self, name):
        """The optimised binary of a stage, built on first use."""
        if name not in self._built:
            command = ["cargo", "build", "--release", "--locked", "--package", name, "--bin", name]
            built = subprocess.run(
                [*command, "--message-format=json-render-diagnostics"], cwd=self.root, stdout=subprocess.PIPE, text=True
            )
            if built.returncode != 0:
                raise Failed(f"{name} does not build")
            messages = map(json.loads, built.stdout.splitlines())
            paths = [m["executable"] for m in messages if m.get("executable") and m["target"]["name"] == name]
            self._built[name] = Path(paths[-1])
        return self._built[name]

    def run(self, words, cwd=None):
        """Runs a stage, quietly; returns its summary (`results`, `seconds`, `outputs`, …)."""
        words = [str(word) for word in words]
        done = subprocess.run([*words, "--json", "--quiet"], cwd=cwd or self.tmp, capture_output=True, text=True)
        if done.returncode != 0:
            raise Failed(done.stderr.strip() or f"{Path(words[0]).name} exits with {done.returncode}")
        # A stage that writes its artifact to standard output puts the summary on standard error.
        for text in (done.stdout, done.stderr):
            lines = text.strip().splitlines()
            if lines and lines[-1].startswith("{") and '"stage"' in lines[-1]:
                return json.loads(lines[-1])
        raise Failed(f"{Path(words[0]).name} prints no summary")
