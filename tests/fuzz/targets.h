// What is fed with broken input: one function per reader. Each must accept or refuse any bytes whatever, and what it
// accepts must keep the promises of its header; expect() ends the process when it does not.
//
// main.cpp makes a libFuzzer program of each (clang; ./run fuzz). corpus_test.cpp runs each over its corpus, with any
// compiler.
#pragma once

#include <cstddef>
#include <span>

namespace ringdown::fuzz {

using Bytes = std::span<const std::byte>;

void osc(Bytes datagram);  // checks, codec, schema
void slip(Bytes stream);   // OSC over TCP
void score(Bytes file);    // OSC scores
void bank(Bytes file);     // .glb, and ringing what was read
void text(Bytes file);     // the first byte chooses: scene, material, object, notes, state, settings
void mesh(Bytes file);     // the first byte chooses: TetGen, Vega, Abaqus, IsoStuffer
void answer(Bytes bytes);  // of the process that reads mesh files
void geo(Bytes file);      // what a .geo says, by its names
void reader(Bytes file);   // mesh files of all kinds, read by that process; the first byte chooses the ending

void expect(bool holds, const char* what);

struct Target {
  const char* name;
  void (*feed)(Bytes);
};
inline constexpr Target kTargets[] = {{"osc", osc},   {"slip", slip},     {"score", score},
                                      {"bank", bank}, {"text", text},     {"mesh", mesh},
                                      {"geo", geo},   {"answer", answer}, {"reader", reader}};

}  // namespace ringdown::fuzz
