// The pitch of each preset as a musician or a maker would name it. The list is written by hand from what the object is
// and from the shapes of its modes, not from any estimate; preset_pitch_test.cpp holds estimates against it.
//
// A mode (n, m) of a round body has n nodal meridians or diameters and m nodal circles.
#pragma once

#include <string_view>
#include <vector>

namespace ringdown::test {

struct PresetPitch {
  std::string_view preset;
  std::vector<double> hz;  // any of these; none: it has no definite pitch
};

inline const std::vector<PresetPitch>& preset_pitches() {
  static const std::vector<PresetPitch> list = {
      // Tuned keys and bars: the first bending mode, which is the note that their makers tune.
      {"vibraphone-key", {220.0}},     // A3
      {"marimba-key", {220.0}},        // A3: both modes of the pair that it makes with its tube
      {"xylophone-key", {440.0}},      // A4
      {"glockenspiel-bar", {1046.5}},  // C6
      {"wooden-bar", {431.8}},         // a xylophone's bar that nobody has tuned exactly
      {"tuning-fork", {440.0}},        // A4: both tines against each other
      // Bars, rods and tubes that hang free, as in a chime: the first bending mode.
      {"steel-rod", {614.1}},
      {"glass-slat", {730.9}},
      {"wrench", {912.3}},      // a bar with thick ends
      {"chime-tube", {534.2}},  // wind chimes of this size are tuned by their lowest mode
      // Bells. A church bell's strike note lies an octave below the nominal (4, 1), here 1932 Hz, whose next partials
      // (5, 1) and (6, 1) make 2 : 3 : 4 with it. A hand bell is tuned by (2, 0), which is its strike note.
      {"bronze-bell", {966.1}},
      {"hand-bell", {904.8}},
      {"crotale", {1620.6}},      // (2, 0), by which crotales are tuned
      {"singing-bowl", {369.8}},  // the rim's (2, 0)
      // Glasses, cups and pots ring by the rim's (2, 0). A handle splits it in two.
      {"wine-glass", {1136.2}},  // 467 Hz is the bowl on its stem
      {"tumbler", {1176.4}},
      {"porcelain-bowl", {974.0}},
      {"flower-pot", {1487.4}},
      {"mug", {1824.3, 1923.4}},
      {"bottle", {2577.4}},  // (2, 0) of the body's wall
      // Gongs whose middle is a drum of its own: (0, 1), in which all of the middle moves one way.
      {"gong", {680.2}},
      {"opera-gong", {332.8}},
      {"wood-block", {1020.3, 1059.0}},  // the two plates beside the slots, a semitone apart
      // Plates and blocks: unrelated modes of like strength.
      {"block", {}},
      {"brick", {}},
      {"ceramic-tile", {}},
      {"granite-slab", {}},
      {"steel-plate", {}},
      {"table-top", {}},
      {"dinner-plate", {}},
      {"window-pane", {}},
      {"frying-pan", {}},
      {"thunder-sheet", {}},
      {"anvil", {}},
      {"coin", {}},  // two partials above the range of musical pitch, which ends near 5 kHz
      // Instruments of indefinite pitch by every book on orchestration.
      {"triangle", {}},
      {"cow-bell", {}},  // of sheet steel; four inharmonic partials within an octave
      {"crash-cymbal", {}},
      {"tam-tam", {}},
      // Cutlery and other bent iron.
      {"fork", {}},
      {"knife", {}},
      {"spoon", {}},
      {"horseshoe", {}},
      // Several notes on one base.
      {"kalimba", {}},
      {"music-box-comb", {}},
  };
  return list;
}

}  // namespace ringdown::test
