"""Writes web/src/api/openapi.json from the Python models, the UI's TypeScript types and connection forms from it, the
calls that need no lease, the catalog that the UI's tests work with, and the blocking client from that for asyncio.

With --check nothing is written: it ends with 1 when a file is stale, and says which command makes it anew.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
from pathlib import Path

from blocking_client import Unmade, blocking_text
from forms import connection_forms

from web import WEB, WebBuildError, install_packages, npm, require_node

SCHEMA = WEB / "src" / "api" / "openapi.json"
TYPES = WEB / "src" / "api" / "schema.d.ts"
FORMS = WEB / "src" / "api" / "forms.json"
FREE_CALLS = WEB / "src" / "api" / "lease" / "free.json"
CATALOG = WEB / "test" / "catalog.json"
CLIENT = WEB.parent / "app" / "client"


def schema_text() -> str:
    """Return the schema as it stands in the repository: sorted by path, one line a value."""
    from app.main import create_app  # here, because `--help` and a broken app should not meet
    from app.settings import Settings

    with tempfile.TemporaryDirectory() as folder:
        app = create_app(Settings(data_dir=Path(folder)))
        return json.dumps(app.openapi(), indent=1, ensure_ascii=False) + "\n"


def free_calls_text() -> str:
    """Return the calls that may be made without the lease, "METHOD /path": the page asks before all others."""
    from app.api.http.policies import CHANGING_METHODS, Policies
    from app.api.router import BASE
    from app.main import create_app
    from app.settings import Settings

    with tempfile.TemporaryDirectory() as folder:
        routes = Policies(create_app(Settings(data_dir=Path(folder))), BASE).routes
    free = {each for each in routes if each.policy.lease == "free" and each.method in CHANGING_METHODS}
    paths = {f"{each.method} {BASE}{re.sub(r':int}', '}', each.path)}" for each in free}
    return json.dumps(sorted(paths), indent=2) + "\n"


def catalog_text() -> str:
    """Return what `GET /catalog` answers, but for models that only an installed package lists."""
    from app.api.catalog.routes import entries

    models = entries()
    models = [model for model in models if model.tier == "full"]
    return json.dumps([model.model_dump(mode="json") for model in models], indent=1, ensure_ascii=False) + "\n"


def forms_text(schema: str) -> str:
    """Return what the page's connection form is made of."""
    return json.dumps(connection_forms(json.loads(schema)), indent=1, ensure_ascii=False) + "\n"


def types_text(schema: str) -> str:
    """Return the TypeScript types of `schema`. Raises WebBuildError when openapi-typescript fails."""
    node = require_node()
    install_packages(node)
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "openapi.json"), Path(folder, "schema.d.ts")
        source.write_text(schema)
        # What a request may leave out stays optional; what an answer always has, the schema itself calls required.
        flags = ["--default-non-nullable=false", "-o", str(target)]
        npm(node, ["exec", "--no", "--", "openapi-typescript", str(source), *flags], quiet=True)
        return target.read_text()


def main() -> int:
    """Write or check the files."""
    schema = schema_text()
    try:
        wanted = {SCHEMA: schema, TYPES: types_text(schema), FORMS: forms_text(schema)}
        wanted |= {FREE_CALLS: free_calls_text(), CATALOG: catalog_text()}
        wanted[CLIENT / "blocking.py"] = blocking_text((CLIENT / "asynchronous.py").read_text())
    except (WebBuildError, Unmade) as error:
        print(f"types: {error}", file=sys.stderr)
        return 1
    stale = [path for path, text in wanted.items() if not path.is_file() or path.read_text() != text]
    if "--check" in sys.argv[1:]:
        for path in stale:
            print(f"{path.relative_to(WEB.parent)} is stale: run `make types` and commit it", file=sys.stderr)
        return 1 if stale else 0
    for path in stale:
        path.write_text(wanted[path])
        print(f"wrote {path.relative_to(WEB.parent)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
