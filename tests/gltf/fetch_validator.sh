#!/usr/bin/env bash
# The public glTF validator (Khronos, Apache-2.0) as fetch_validator.sh FOLDER: fetched from the npm registry once, by npm
# where there is one and by node alone where not, and unpacked only when it is the file that was pinned here.
# Exit codes: 0 it is in FOLDER/gltf-validator; 77 it cannot be fetched; 1 what came is another file.
set -euo pipefail

readonly version=2.0.0-dev.3.10
# the registry's own "integrity" of it
readonly sha512=a1d278934b519065e20c69fbf320c183e7c16c022f0675f187747002d6b47a64b11adc9a80513c078c442c1d6861edd2e510fc0a2dee640b1969ab1c1f62c011

mkdir -p "$1"
cd "$1"
readonly name=gltf-validator-$version.tgz
[ ! -e "gltf-validator/$version" ] || exit 0

fetch() {
  if command -v npm >/dev/null; then
    npm pack --silent "gltf-validator@$version" >/dev/null
  else
    node -e '
      const [registry, name] = process.argv.slice(1);
      fetch(`${registry.replace(/\/$/, "")}/gltf-validator/-/${name}`)
        .then(async (answer) => {
          if (!answer.ok) throw new Error(`the registry answers ${answer.status}`);
          require("fs").writeFileSync(name, Buffer.from(await answer.arrayBuffer()));
        })
        .catch((error) => { console.error((error.cause ?? error).message); process.exit(1); });
    ' "${npm_config_registry:-https://registry.npmjs.org}" "$name"
  fi
}

work=$(mktemp -d fetch.XXXXXX)
trap 'rm -rf "$OLDPWD/$work"' EXIT
cd "$work"
if ! fetch >log 2>&1; then
  echo "the glTF validator $version cannot be fetched from the npm registry: $(tail -1 log)"
  exit 77
fi
if ! sha512sum --check --status <<<"$sha512  $name"; then
  echo "what the npm registry sent as $name is not the file that was pinned; it was thrown away"
  exit 1
fi
tar -xzf "$name"
touch "package/$version"
mv -T package ../gltf-validator 2>/dev/null || [ -e "../gltf-validator/$version" ]  # another was quicker
