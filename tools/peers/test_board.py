"""Tests of the scoreboard: python tools/peers/test_board.py"""

import contextlib
import io
import json
import os
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import board
from context import Context, Failed, Missing

MODULE = '''
def score(ctx):
    yield {"metric": "rms_mm", "value": 0.5, "target": 1, "better": "lower", "unit": "mm", "context": {"seeds": ctx.seeds}}
    yield {"metric": "count", "value": 3, "target": 3, "better": "equal"}
    yield {"metric": "seconds", "value": 9.0}
'''


class Board(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        patch = mock.patch.object(board, "HERE", self.folder)
        patch.start()
        self.addCleanup(patch.stop)
        (self.folder / "soft_shell.py").write_text(MODULE)

    def run_board(self, *words):
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = board.main(list(words))
        return code, out.getvalue(), err.getvalue()

    def rows(self, *words):
        code, out, _ = self.run_board(*words, "--json")
        return code, [json.loads(line) for line in out.splitlines()]

    def change(self, old, new):
        path = self.folder / "soft_shell.py"
        text = path.read_text()
        self.assertIn(old, text)
        path.write_text(text.replace(old, new))

    def test_met_targets_pass(self):
        code, rows = self.rows("score", "soft-shell", "--seeds", "7,8")
        self.assertEqual(code, 0)
        self.assertEqual([row["metric"] for row in rows], ["soft-shell/rms_mm", "soft-shell/count", "soft-shell/seconds"])
        self.assertEqual([row["pass"] for row in rows], [True, True, None])
        self.assertEqual(rows[0]["context"], {"seeds": [7, 8]})

    def test_a_missed_target_fails(self):
        self.change('"value": 0.5', '"value": 1.5')
        code, rows = self.rows("score", "all")
        self.assertEqual((code, rows[0]["pass"]), (1, False))

    def test_higher_is_judged_the_other_way(self):
        self.change('"better": "lower"', '"better": "higher"')
        self.assertEqual(self.rows("score", "all")[0], 1)

    def test_no_value_and_no_number_fail_with_a_reason(self):
        for value in ("None", "float('nan')", "float('inf')"):
            self.change('"value": 0.5', f'"value": {value}')
            code, rows = self.rows("score", "all")
            self.assertEqual((code, rows[0]["value"], rows[0]["pass"]), (1, None, False))
            self.assertTrue(rows[0]["reason"])
            self.change(f'"value": {value}', '"value": 0.5')

    def test_a_value_that_is_only_reported_may_be_missing(self):
        self.change('"value": 9.0', '"value": None')
        self.assertEqual(self.rows("score", "all")[0], 0)

    def test_missing_data_and_exceptions_become_failed_rows(self):
        for line, reason in (
            ('raise ctx.Missing("no scans")', "no scans"),
            ("1 / 0", "ZeroDivisionError"),
            ('yield {"metrik": 1}', "metrik"),
            ('yield {"metric": "a", "better": "more"}', "more"),
        ):
            (self.folder / "soft_shell.py").write_text(MODULE + f"    {line}\n")
            code, rows = self.rows("score", "all")
            self.assertEqual((code, len(rows)), (1, 4), "what was measured before is kept")
            self.assertIn(reason, rows[3]["reason"])

    def test_a_module_that_does_not_load_is_a_failed_row(self):
        (self.folder / "soft_shell.py").write_text("import no_such_module_of_anyone")
        self.assertEqual(self.rows("score", "all")[0], 1)

    def test_nothing_measured_is_no_success(self):
        self.assertEqual(self.run_board("bench", "soft-shell")[0], 1)

    def test_unknown_stages_and_seeds_are_usage_errors(self):
        for words in (["score", "other"], ["score", "all", "--seeds", "a"], ["rank", "all"]):
            with self.assertRaises(SystemExit) as stop:
                self.run_board(*words)
            self.assertEqual(stop.exception.code, 2)

    def test_values_like_those_of_numpy_become_plain(self):
        class Scalar:
            def tolist(self):
                return 0.25

        scalar = Scalar()
        self.assertEqual(board.judged({"metric": "a", "value": scalar}, "shell")["value"], 0.25)
        self.assertEqual(json.dumps({"a": scalar}, default=board.jsonable), '{"a": 0.25}')

    def test_the_table_is_aligned(self):
        _, out, _ = self.run_board("score", "all")
        lines = out.splitlines()
        self.assertEqual(lines[0].index("value"), lines[1].index("0.5"))
        self.assertIn("≤ 1", lines[1])
        self.assertIn("2 targets met, 0 missed, 1 values reported only", out)


class Contexts(unittest.TestCase):
    def test_the_temporary_folder_goes(self):
        with Context([1]) as ctx:
            folder = ctx.tmp
            self.assertTrue(folder.is_dir())
        self.assertFalse(folder.exists())

    def test_absent_data_are_missing(self):
        with tempfile.TemporaryDirectory() as empty, mock.patch.dict(os.environ, FURROW_DATA=empty):
            (Path(empty) / "here").mkdir()
            self.assertEqual(Context([1]).data("here"), Path(empty) / "here")
            with self.assertRaises(Missing):
                Context([1]).data("gone")

    def test_a_summary_is_parsed_and_an_error_told(self):
        summary = "import json; print('noise'); print(json.dumps({'stage': 'a', 'results': {'n': 1}}))"
        with Context([1]) as ctx:
            self.assertEqual(ctx.run([sys.executable, "-c", summary])["results"], {"n": 1})
            with self.assertRaisesRegex(Failed, "broken"):
                ctx.run([sys.executable, "-c", "import sys; sys.exit('broken')"])
            with self.assertRaisesRegex(Failed, "no summary"):
                ctx.run([sys.executable, "-c", "pass"])


if __name__ == "__main__":
    unittest.main()
