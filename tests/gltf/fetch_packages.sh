#!/usr/bin/env bash
# The public glTF validator (Khronos, Apache-2.0) and the glTF codec meshoptimizer (MIT) as fetch_packages.sh FOLDER; with
# a second argument `babylon` Babylon.js and its loaders (Apache-2.0) in their place. Fetched from the npm registry once,
# by npm where there is one and by node alone where not, and unpacked only when they are the files that were pinned here.
# Exit codes: 0 they are in FOLDER/gltf-validator and FOLDER/meshoptimizer, or FOLDER/node_modules/@babylonjs; 77 one
# cannot be fetched; 1 what came is another file.
set -euo pipefail

mkdir -p "$1"
cd "$1"

fetch() {  # fetch NAME VERSION FILE
  if command -v npm >/dev/null; then
    npm pack --silent "$1@$2" >/dev/null
  else
    node -e '
      const [registry, name, version, file] = process.argv.slice(1);
      fetch(`${registry.replace(/\/$/, "")}/${name}/-/${name.split("/").pop()}-${version}.tgz`)
        .then(async (answer) => {
          if (!answer.ok) throw new Error(`the registry answers ${answer.status}`);
          require("fs").writeFileSync(file, Buffer.from(await answer.arrayBuffer()));
        })
        .catch((error) => { console.error((error.cause ?? error).message); process.exit(1); });
    ' "${npm_config_registry:-https://registry.npmjs.org}" "$1" "$2" "$3"
  fi
}

work=$(mktemp -d fetch.XXXXXX)
trap 'rm -rf "$OLDPWD/$work"' EXIT
cd "$work"

install() {  # install NAME VERSION SHA512 [FOLDER]
  local target=../${4:-$1} plain=${1#@}
  local file=${plain//\//-}-$2.tgz
  [ ! -e "$target/$2" ] || return 0
  if ! fetch "$1" "$2" "$file" >log 2>&1; then
    echo "$1 $2 cannot be fetched from the npm registry: $(tail -1 log)"
    exit 77
  fi
  if ! sha512sum --check --status <<<"$3  $file"; then
    echo "what the npm registry sent as $file is not the file that was pinned; it was thrown away"
    exit 1
  fi
  tar -xzf "$file"
  touch "package/$2"
  mkdir -p "${target%/*}"
  mv -T package "$target" 2>/dev/null || { rm -r package; [ -e "$target/$2" ]; }  # another was quicker
}

# with the registry's own "integrity" of each
if [ "${2:-}" = babylon ]; then
  install @babylonjs/core 7.54.3 \
    3f99dc5d577c1845092e1c25a0ff55d2857041822bbd9ced82e55e2e5bdde51c7ef5a4277a72a3a55f1ab89e9246c525026359538a454cacf017aa361147e103 \
    node_modules/@babylonjs/core
  install @babylonjs/loaders 7.54.3 \
    4413e63ac68c4f18ba19ad3cb9e2d39ba4e7bf1fe5da73508a0b9cb9bbeb9e067b9aec27e7fb9b7dc4ad724908d5cd2abe1475fbf145943e78768ee0675a67b1 \
    node_modules/@babylonjs/loaders
  exit 0
fi
install gltf-validator 2.0.0-dev.3.10 \
  a1d278934b519065e20c69fbf320c183e7c16c022f0675f187747002d6b47a64b11adc9a80513c078c442c1d6861edd2e510fc0a2dee640b1969ab1c1f62c011
install meshoptimizer 0.22.0 \
  21e6e22bbf6ca88cbe1381203abf82030f8a7bc840b295cacc177425d80498f1e20309af123d92e21d6b7efa3ea3f0677c461dfe300e83921e7888f39734a70e
