#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves the recipes in packaging/: vcpkg's manifest by its schema (its port is not run), and Conan's by making a static
# and a shared package of this checkout, with the system's OpenCL and no remote, and a program of another project with each.
# Usage: scripts/prove-recipes.sh [FOLDER]
#   FOLDER   has vcpkg's schemas, such as docs/ of a checkout of vcpkg-tool; default: from where vcpkg.json says they are
# Needs what scripts/setup.sh installs, python3-venv, and conan and jsonschema from PyPI, which go to build-recipes/.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$root/build-recipes
[[ $# == 0 || ($# == 1 && -d $1) ]] || { sed -n '5,7s/^# //p' "$0"; exit 2; }
manifest=$root/packaging/vcpkg/vcpkg.json
fail() { echo "prove-recipes: $1" >&2; exit 1; }

python=$work/env/bin/python
"$python" -c 'import conan, jsonschema' 2>/dev/null || {
  rm -rf "$work/env"
  "${GCDT_PYTHON:-python3}" -m venv "$work/env"
  "$python" -m pip install --quiet conan jsonschema
}

schemas=${1-}
if [[ ! $schemas ]]; then
  schemas=$work/schemas
  mkdir -p "$schemas"
  address=$("$python" -c 'import json, sys; print(json.load(open(sys.argv[1]))["$schema"])' "$manifest")
  for name in vcpkg.schema.json vcpkg-schema-definitions.schema.json; do
    "$python" -c 'import sys, urllib.request; urllib.request.urlretrieve(*sys.argv[1:])' "$(dirname "$address")/$name" \
      "$schemas/$name" || fail "$name cannot be fetched: give the folder that has it"
  done
fi
"$python" - "$manifest" "$schemas" "$root/CMakeLists.txt" <<'END'
import copy, json, pathlib, re, sys

import jsonschema
import referencing
from referencing.jsonschema import DRAFT7

manifest, schemas = json.loads(pathlib.Path(sys.argv[1]).read_text()), pathlib.Path(sys.argv[2])
schema = json.loads((schemas / "vcpkg.schema.json").read_text())
retrieve = lambda uri: DRAFT7.create_resource(json.loads((schemas / uri.rsplit("/", 1)[-1]).read_text()))
check = jsonschema.Draft7Validator(schema, registry=referencing.Registry(retrieve=retrieve))
check.check_schema(schema)
for error in check.iter_errors(manifest):
    sys.exit(f"prove-recipes: vcpkg.json: {error.json_path}: {error.message}")
# The schema refuses what is wrong, so that its silence says something.
for key, wrong in {"name": "G C D T", "version-semver": 1, "dependencies": [{"host": True}], "licence": "none"}.items():
    if not list(check.iter_errors(copy.deepcopy(manifest) | {key: wrong})):
        sys.exit(f"prove-recipes: the schemas accept {key} = {wrong!r}")
version = re.search(r"project\(gcdt VERSION ([0-9.]+)", pathlib.Path(sys.argv[3]).read_text()).group(1)
if manifest["version-semver"] != version:
    sys.exit(f"prove-recipes: vcpkg.json says {manifest['version-semver']}, CMakeLists.txt {version}")
END
echo "prove-recipes: vcpkg.json is as vcpkg's schema wants it"

export CONAN_HOME=$work/conan
trap 'rm -rf "$root/packaging/conan/test_package/build"' EXIT  # where Conan builds the program that uses the package
rm -rf "$CONAN_HOME"
conan() { "$work/env/bin/conan" "$@" || fail "conan $1 failed"; }
conan profile detect >"$work/profile.log" 2>&1
conan remote disable "*" >/dev/null
for shared in False True; do
  conan create "$root/packaging/conan" --no-remote --build 'gcdt/*' -o "gcdt/*:shared=$shared" \
    -c "tools.build:jobs=$(nproc)" >"$work/create.log" 2>&1 || { tail -40 "$work/create.log" >&2; exit 1; }
  grep 'triangles, valid' "$work/create.log" || fail "the program has not said that its mesh is valid"
done
echo "prove-recipes: Conan makes a static and a shared package, and a program uses each"
