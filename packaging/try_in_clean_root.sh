#!/usr/bin/env bash
# Installs the packages of a folder in a fresh Debian 12 and runs what they brought. As root; needs debootstrap and a
# Debian mirror. What the fresh Debian was made of is kept in CACHE, so that the next time takes seconds.
#   try_in_clean_root.sh FOLDER CACHE
set -euo pipefail
folder=$(realpath "$1") cache=$(realpath -m "$2")
mkdir -p "$cache"
root=$(mktemp -d)
leave() {
  mountpoint -q "$root/proc" && umount "$root/proc"
  mountpoint -q "$root/var/cache/apt/archives" && umount "$root/var/cache/apt/archives"
  rm -rf --one-file-system "$root"
}
trap leave EXIT

if [ ! -e "$cache/base.tar" ]; then
  debootstrap --variant=minbase bookworm "$root" >"$cache/debootstrap.log"
  tar -C "$root" --one-file-system -cf "$cache/base.tar.part" .
  mv "$cache/base.tar.part" "$cache/base.tar"
else
  tar -C "$root" -xf "$cache/base.tar"
fi
mkdir -p "$cache/archives/partial"
mount -t proc proc "$root/proc"
mount --bind "$cache/archives" "$root/var/cache/apt/archives"
cp /etc/resolv.conf "$root/etc/resolv.conf"
mkdir "$root/packages"
cp "$folder"/*.deb "$root/packages"

inside() { chroot "$root" env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/root LC_ALL=C.UTF-8 "$@"; }
install_package() {
  echo "installing $1"
  inside sh -c "DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends -o APT::Keep-Downloaded-Packages=true /packages/$1_*.deb" >"$cache/install.log" 2>&1 ||
    { cat "$cache/install.log"; return 1; }
}
expect_file() { [ -s "$root/$1" ] || { echo "$1 is missing or empty"; return 1; }; }

inside apt-get update -qq
install_package ringdown
inside ringdownd --driver null --seconds 1
inside ringdown render --scene /usr/share/ringdown/presets/scenes/demo.toml --seconds 2 -o /root/demo.wav
expect_file root/demo.wav
for file in usr/share/man/man1/{ringdown,ringdownd}.1 usr/lib/systemd/user/ringdownd.service \
  usr/share/bash-completion/completions/ringdownd usr/share/doc/ringdown/{SECURITY,README}.md usr/share/doc/ringdown/copyright; do
  expect_file "$file"
done
install_package ringdown-bake
inside ringdown bake /usr/share/ringdown/presets/objects/steel-plate.toml --preview -o /root/plate.glb
inside ringdown info /root/plate.glb >/dev/null
install_package ringdown-viewer
inside ringdown-viewer --keys >/dev/null
inside apt-get purge -y -qq ringdown ringdown-bake ringdown-viewer >/dev/null 2>&1
[ ! -e "$root/usr/share/ringdown" ] || { echo "purging leaves /usr/share/ringdown behind"; exit 1; }
echo "installed, ran and removed in a clean Debian 12"
