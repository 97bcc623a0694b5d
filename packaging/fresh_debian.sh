#!/usr/bin/env bash
# Tries Ringdown as its user meets it: in a fresh Debian, which mmdebstrap makes in a folder of its own. As root.
#   fresh_debian.sh packages CACHE FOLDER   installs the .deb files of FOLDER, hears them through JACK, runs what they
#                                           brought, removes them
#   fresh_debian.sh tar CACHE ARCHIVE       unpacks what ./run package tar made, and runs it as a user who is not root
#   fresh_debian.sh pages CACHE FOLDER [PAGE...]   installs the .deb files of FOLDER, then pastes the commands of README.md and
#                                           docs/use (packaging/pages/paste_pages.py), with JACK and a display, without network
#   fresh_debian.sh readme CACHE            pastes the commands under README's "Start" into a clone of what is committed,
#                                           then calls ./run test there; prints how long each took, and its processor time. With
#                                           RINGDOWN_PROOFS set: as continuous integration does
#   fresh_debian.sh run CACHE VERB...       ./run VERB ... in such a clone
# SUITE=trixie chooses another Debian than bookworm. The fresh Debian and the packages that it downloads are kept in CACHE.
set -euo pipefail
what=$1 cache=$(realpath -m "$2") suite=${SUITE:-bookworm}
shift 2
source_tree=$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")
mkdir -p "$cache"
if [ ! -e "$cache/$suite.tar" ]; then
  mmdebstrap --variant=minbase --include=ca-certificates "$suite" "$cache/part-$suite.tar" 2>"$cache/mmdebstrap.log" ||
    { tail -5 "$cache/mmdebstrap.log"; exit 1; }
  mv "$cache/part-$suite.tar" "$cache/$suite.tar"
fi
root=$(mktemp -d)
leave() {
  local place
  for place in dev/shm dev/pts proc var/cache/apt/archives; do
    ! mountpoint -q "$root/$place" || umount "$root/$place"
  done
  rm -rf --one-file-system "$root"
}
trap leave EXIT
tar -C "$root" -xf "$cache/$suite.tar"
mkdir -p "$root/dev/pts" "$root/dev/shm" "$cache/$suite/partial"
mount -t proc proc "$root/proc"
mount -t devpts devpts "$root/dev/pts"
mount -t tmpfs tmpfs "$root/dev/shm"
cp /etc/resolv.conf "$root/etc/resolv.conf"
echo "127.0.0.1 localhost $(hostname)" >"$root/etc/hosts"

inside() { chroot "$root" env -i PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin HOME=/root LC_ALL=C.UTF-8 "$@"; }

# The output goes to a log; the lines that say how long something took, or how it ended, are shown.
timed() {  # timed NAME COMMAND...
  local name=$1 log=$cache/$suite-$1.log from=$SECONDS code=0 spent TIMEFORMAT='%U + %S'
  shift
  spent=$({ time inside "$@" >"$log" 2>&1; } 2>&1) || code=$?
  sed 's/\x1b\[[0-9]*m//g' "$log" | grep -E '^packages: .* s to| (in|\./run .*:) [0-9]+ s$|^\./run .*: [0-9]+ s$|passed, .* failed|^[^ ]+\.wav: ' || true
  echo "$suite, $name: $((SECONDS - from)) s, processor time $spent s, exit $code"
  [ "$code" -eq 0 ] || tail -20 "$log"
  return "$code"
}

expect_file() { [ -s "$root/$1" ] || { echo "$1 is missing or empty"; return 1; }; }

# Without a network, so that no port is taken.
alone() {
  unshare --net sh -c 'ip link set lo up; exec "$@"' alone chroot "$root" env -i PATH=/usr/bin:/bin HOME=/root LC_ALL=C.UTF-8 "$@"
}

install() {  # install NAME-OR-FILE..., where files may have wildcards
  inside sh -c "DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends -o APT::Keep-Downloaded-Packages=true $*" \
    >"$cache/install.log" 2>&1 || { cat "$cache/install.log"; return 1; }
}

install_package() {
  echo "installing $1"
  install "/packages/$1_*.deb"
}

# JACK's own recorder hears the demo scene. The dummy driver keeps time as a sound card does.
try_sound() {
  local from=$SECONDS
  alone sh -ec '
    jackd -r -d dummy >/dev/null 2>&1 & jack=$!
    trap "kill $jack; wait $jack || true" EXIT
    jack_wait -w -t 10 >/dev/null 2>&1
    ringdownd --scene demo --connect >/dev/null & daemon=$!
    until jack_lsp -c ringdown:out_right | grep -q system:; do kill -0 $daemon; sleep 0.1; done
    jack_rec -f /root/heard.wav -d 2 ringdown:out_left ringdown:out_right >/dev/null 2>&1
    kill $daemon
    wait $daemon || true'
  /usr/bin/python3 -c '
import array, sys, wave
peak = max(map(abs, array.array("h", wave.open(sys.argv[1]).readframes(2**31 - 1))))
sys.exit(None if peak > 300 else f"JACK hears a peak of {peak} of 32768 from the demo scene")' "$root/root/heard.wav"
  echo "the demo scene sounds through JACK, $((SECONDS - from)) s after the installation with 2 s of recording"
}

# The C program of the library's page, by pkg-config, and what the Python module plays.
try_library() {
  install_package libringdown1
  install_package libringdown-dev
  install gcc libc6-dev pkg-config
  sed -n '/^```c$/,/^```$/p' "$source_tree/docs/use/library.md" | sed '/^```/d' >"$root/root/bell.c"
  inside sh -c 'cc /root/bell.c $(pkg-config --cflags --libs ringdown) -o /root/bell'
  inside /root/bell /usr/share/ringdown/presets/banks/coin.glb
  inside pkg-config --exists --print-errors ringdown-scene
  install_package python3-ringdown
  inside python3 -c '
import ringdown
presets = "/usr/share/ringdown/presets/"
coin = ringdown.Bank.open(presets + "banks/coin.glb")
assert abs(ringdown.render([(0, "coin", coin.points_m[0], (0, 0, 0.01))], {"coin": coin}, seconds=0.1)).max() > 0
assert ringdown.render_scene(presets + "scenes/coin.toml", 0.1).shape == (4800, 2)
print("import ringdown", ringdown.__version__)'
}

# The plug-in, before LV2's own tools; every module finds what it links.
try_plugin() {
  install_package ringdown-plugin
  install lilv-utils
  inside sh -c 'test "$(lv2ls | wc -l)" -eq 1 && lv2info "$(lv2ls)" | grep -q "wine-glass"'
  inside sh -c 'for file in /usr/lib/clap/ringdown.clap /usr/lib/vst3/ringdown.vst3/Contents/*/ringdown.so /usr/lib/lv2/ringdown.lv2/ringdown.so; do
    ! ldd "$file" | grep "not found" || exit 1; done'
}

try_packages() {  # try_packages FOLDER
  mount --bind "$cache/$suite" "$root/var/cache/apt/archives"
  mkdir "$root/packages"
  cp "$1"/*.deb "$root/packages"
  inside apt-get update -qq
  install_package ringdown-presets
  install_package ringdown
  install jackd2
  try_sound
  inside ringdown render --scene demo --seconds 2 -o /root/demo.wav
  inside ringdown picture /usr/share/ringdown/presets/banks/coin.glb -o /root/coin.png
  local file
  for file in root/demo.wav root/coin.png usr/share/man/man1/{ringdown,ringdownd}.1.gz usr/lib/systemd/user/ringdownd.service \
    usr/share/bash-completion/completions/ringdownd usr/share/doc/ringdown/{SECURITY,README}.md usr/share/doc/ringdown/copyright; do
    expect_file "$file"
  done
  install_package ringdown-doc
  expect_file usr/share/doc/ringdown/docs/use/start.md
  install_package ringdown-bake
  inside ringdown bake /usr/share/ringdown/presets/objects/steel-plate.toml --preview -o /root/plate.glb
  inside ringdown info /root/plate.glb >/dev/null
  install_package ringdown-viewer
  inside ringdown-viewer --keys >/dev/null
  for file in usr/share/applications/ringdown-{viewer,open}.desktop usr/libexec/ringdown/ringdown-open usr/share/mime/packages/ringdown.xml \
    usr/share/metainfo/io.github.ringdown.ringdown.metainfo.xml usr/share/icons/hicolor/{scalable/apps/ringdown.svg,48x48/apps/ringdown.png}; do
    expect_file "$file"
  done
  try_library
  try_plugin
  inside apt-get purge -y -qq ringdown ringdown-presets ringdown-doc ringdown-bake ringdown-viewer ringdown-plugin python3-ringdown libringdown-dev libringdown1 >/dev/null 2>&1
  local left
  for left in usr/share/ringdown usr/include/ringdown.h usr/lib/python3/dist-packages/ringdown usr/lib/lv2/ringdown.lv2; do
    [ ! -e "$root/$left" ] || { echo "purging leaves /$left behind"; return 1; }
  done
  echo "$suite: installed, played and removed"
}

try_pages() {  # try_pages FOLDER [PAGE...]
  local folder=$1
  shift
  mount --bind "$cache/$suite" "$root/var/cache/apt/archives"
  mkdir "$root/packages" "$root/source"
  cp "$folder"/*.deb "$root/packages"
  cp -r "$source_tree"/{README.md,docs,clients} "$root/source"
  cp "$source_tree/packaging/pages/paste_pages.py" "$root/source"
  ln -s /usr/share/ringdown/presets "$root/source/presets"
  inside apt-get update -qq
  install '/packages/*.deb jackd2 liblo-tools xvfb xauth libgl1-mesa-dri gcc libc6-dev pkg-config'
  alone bash -c '
    jackd -r -d dummy >/dev/null 2>&1 & jack=$!
    code=0
    sleep 2
    xvfb-run -a python3 /source/paste_pages.py /source /root/pages "$@" || code=$?
    kill "$jack"
    wait "$jack" || true
    exit "$code"' pages "$@"
}

# Without any package but JACK's library, and moved after it has run. The plug-ins' windows want the host's OpenGL.
try_tar() {  # try_tar ARCHIVE
  local home=$root/home/player folder file
  folder=$(basename "$1" .tar.gz)
  mkdir "$home"
  tar -C "$home" -xf "$1"
  mv "$home/$folder" "$home/first"
  chown -R 1000:1000 "$home"
  player() { chroot --userspec=1000:1000 "$root" env -i PATH=/usr/bin:/bin HOME=/home/player LC_ALL=C.UTF-8 sh -ec "cd; $*"; }
  player first/bin/ringdown render --scene demo --seconds 2 -o demo.wav
  mv "$home/first" "$home/moved to"
  player "'moved to/bin/ringdown' render --scene demo --seconds 2 -o again.wav"
  cmp "$home/demo.wav" "$home/again.wav"
  player "ln -s '/home/player/moved to/bin/ringdown' ringdown; ./ringdown picture coin -o coin.png"
  player "./ringdown bake 'moved to/share/ringdown/presets/objects/steel-plate.toml' --preview -o plate.glb; ./ringdown info plate.glb >info"
  player "'moved to/bin/ringdown-viewer' --keys >keys"
  for file in demo.wav coin.png plate.glb info keys; do expect_file "home/player/$file"; done
  player "for file in moved*/lib/*.so.* moved*/lib/clap/* moved*/lib/lv2/*/*.so moved*/lib/vst3/*/*/*/*.so; do
    ! ldd \"\$file\" | grep -v 'libGL.so' | grep 'not found' || { echo \"\$file\"; exit 1; }; done"
  mount --bind "$cache/$suite" "$root/var/cache/apt/archives"
  inside apt-get update -qq
  install libjack-jackd2-0
  player "'moved to/bin/ringdownd' --scene demo --driver null --seconds 1"
  echo "$suite: unpacked, played and moved"
}

case "$what" in
  tar) try_tar "$(realpath "$1")" ;;
  pages)
    folder=$(realpath "$1")
    shift
    try_pages "$folder" "$@" ;;
  packages) try_packages "$(realpath "$1")" ;;
  readme)
    git clone -q "$source_tree" "$root/root/ringdown"
    commands=$(sed -n '/^## Start/,/^## [^S]/s/^    //p' "$source_tree/README.md")
    timed readme bash -ec "cd /root/ringdown; $commands"
    timed test env RINGDOWN_PROOFS="${RINGDOWN_PROOFS:-}" bash -c 'cd /root/ringdown && ./run test'
    ;;
  run)
    git clone -q "$source_tree" "$root/root/ringdown"
    timed "$1" bash -c 'cd /root/ringdown && ./run "$@"' run "$@"
    ;;
  *) echo "say packages, tar, pages, readme or run" >&2; exit 2 ;;
esac
