#!/usr/bin/env bash
# What LV2's own tools say about the built plug-in: its description is without an error, and a host's library finds it
# with all its presets. validate.sh FOLDER: the folder that holds ringdown.lv2. Skipped (77) without the tools.
set -euo pipefail
folder=$(realpath "$1")  # sord_validate takes no other
for tool in lv2_validate sord_validate lv2info; do
  command -v "$tool" >/dev/null || { echo "skipped: there is no $tool"; exit 77; }
done
report=$(lv2_validate "$folder"/ringdown.lv2/*.ttl 2>&1) || true
grep -q '^Found 0 errors' <<<"$report" || { echo "$report"; exit 1; }
about=$(LV2_PATH="$folder:/usr/lib/lv2" lv2info urn:ringdown:instrument)
for line in 'Class: *Instrument Plugin' 'vibraphone-key' 'Symbol: *strike_point' '44 = "wrench"' 'Group: .*portGroup_strike'; do
  grep -q "$line" <<<"$about" || { echo "lv2info does not show $line:"; echo "$about"; exit 1; }
done
for line in 'unit:unit unit:midiNote' '%.3g ms\|unit:unit unit:ms' '"%.3g x"'; do
  grep -q "$line" "$folder/ringdown.lv2/ringdown.ttl" || { echo "ringdown.ttl does not have $line"; exit 1; }
done
if [ -e "$folder/ringdown.lv2/ringdown_ui.so" ]; then
  grep -q 'Class: *http://lv2plug.in/ns/extensions/ui#X11UI' <<<"$about" || { echo "lv2info shows no window:"; echo "$about"; exit 1; }
fi
