"""Whether an environment still works after slim.py: imports all of stepscope, and uses what its packages are there for.

In the image this runs before anybody has the chance to miss a part. It leaves nothing behind.
"""

from __future__ import annotations

import ast
import importlib
import io
import json
import pkgutil
import subprocess
import sys
import tempfile
from pathlib import Path

BY_ALEMBIC = ".store.migrations."
"""Scripts that alembic runs; they are no modules of their own."""

EXTRAS = {"can", "distributed", "pytrinamic", "spidev"}
"""What comes only where it is asked for."""


def main() -> int:
    """0, or the exception of the first part that does not."""
    sys.dont_write_bytecode = True
    package = importlib.import_module("stepscope")
    names = [found.name for found in pkgutil.walk_packages(package.__path__, "stepscope.")]
    for name in names:
        if BY_ALEMBIC not in name:
            importlib.import_module(name)
    for path in Path(package.__path__[0]).rglob("*.py"):
        import_what_it_needs(path)
    for use in (
        compile_something,
        try_statistics,
        try_studies,
        keep_a_database,
        write_files,
        colour_a_traceback,
        draw_a_scene,
    ):
        use()
    print(f"{len(names)} modules, and all that they use, work")
    return 0


def import_what_it_needs(path: Path) -> None:
    """Parts of other packages that this module imports, also where it does so only when it needs them."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            wanted = [(each.name, "") for each in node.names]
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            wanted = [(node.module, each.name) for each in node.names]
        else:
            continue
        for name, part in wanted:
            if name.split(".")[0] in EXTRAS:
                continue
            found = importlib.import_module(name)
            if part and not hasattr(found, part):
                importlib.import_module(f"{name}.{part}")


def compile_something() -> None:
    """Numba with its LLVM."""
    import numba

    assert numba.njit(lambda x: x + 1)(1) == 2


def try_statistics() -> None:
    """What studies prove by."""
    import numpy as np
    from scipy import stats

    sample = np.random.default_rng(1).normal(size=30)
    stats.wilcoxon(sample)
    stats.ttest_rel(sample, sample[::-1])
    stats.binomtest(3, 10).proportion_ci()
    stats.bootstrap((sample,), np.mean, n_resamples=20)
    assert 0 < stats.beta.ppf(0.5, 2, 3) < stats.t.ppf(0.9, 3) < stats.chi2.ppf(0.9, 3)


def try_studies() -> None:
    """What studies search by."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    for sampler in (optuna.samplers.TPESampler(seed=1, multivariate=True), optuna.samplers.CmaEsSampler(seed=1)):
        study = optuna.create_study(sampler=sampler)
        study.optimize(lambda trial: trial.suggest_float("x", 0, 1) + trial.suggest_float("y", 0, 1), n_trials=12)


def keep_a_database() -> None:
    """As a first start makes it, by alembic's scripts."""
    database = importlib.import_module("stepscope.store.database")
    with tempfile.TemporaryDirectory() as folder:
        kept = database.Database(Path(folder))
        kept.open()
        kept.close()
        assert kept.problem is None, kept.problem


def write_files() -> None:
    """Recordings, as they are kept and as they are handed out."""
    import pyarrow as pa
    import pyarrow.csv
    import pyarrow.parquet

    table = pa.table({"position": [1, 2]})
    kept = io.BytesIO()
    with pa.ipc.new_stream(kept, table.schema, options=pa.ipc.IpcWriteOptions(compression="zstd")) as writer:
        writer.write_table(table)
    assert pa.ipc.open_stream(kept.getvalue()).read_all() == table
    parquet = io.BytesIO()
    pyarrow.parquet.write_table(table, parquet)
    assert pyarrow.parquet.ParquetFile(io.BytesIO(parquet.getvalue())).read() == table
    pyarrow.csv.write_csv(table, io.BytesIO())


def colour_a_traceback() -> None:
    """As the command line shows an error that nobody has foreseen."""
    from rich.console import Console
    from rich.traceback import Traceback

    try:
        int("an example")
    except ValueError as error:
        Console(file=io.StringIO()).print(Traceback.from_exception(type(error), error, error.__traceback__))


LEFT_OUT = ("cv2", "imageio", "PIL", "trimesh")
"""What viser could use and an image does not have (scripts/lock.py)."""


def draw_a_scene() -> None:
    """The process of the 3D view, told as the server tells it."""
    shape = importlib.import_module("stepscope.twin.shape")
    child = (
        f"import runpy, sys; sys.modules.update(dict.fromkeys({LEFT_OUT})); "
        "runpy.run_module('stepscope.twin.child', run_name='__main__')"
    )
    told = (
        {"shape": shape.Shape("bench", 0, "motor").message(), "scheme": "dark"},
        {"look": shape.AxisPose().message()},
    )
    done = subprocess.run(
        [sys.executable, "-B", "-c", child],
        input="".join(f"{json.dumps(message)}\n" for message in told),
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.splitlines()[-1]) == {"shown": 1}


if __name__ == "__main__":
    sys.exit(main())
