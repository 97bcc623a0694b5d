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
void stream(Bytes bytes);  // OSC over TCP, in either framing
void score(Bytes file);    // OSC scores
void bank(Bytes file);     // .glb, and ringing what was read
void mesh(Bytes file);     // the first byte chooses: TetGen, Vega, Abaqus, IsoStuffer
void surface(Bytes file);  // the first byte chooses: OBJ, STL, PLY, OFF, glTF
void answer(Bytes bytes);  // of the process that reads mesh files
void geo(Bytes file);      // what a .geo says, by its names
void reader(Bytes file);   // mesh files of all kinds, read by that process; the first byte chooses the ending
void scene(Bytes file);    // .toml, and moving what was read
void gltf(Bytes file);     // .glb and .gltf scenes, moving what was read, and looking for what could be baked
void material(Bytes file);
void object(Bytes file);
void notes(Bytes file);
void scala(Bytes file);  // as a scale and as a keyboard mapping
void state(Bytes file);
void settings(Bytes file);
void options(Bytes words);  // of ringdownd's command line, one in a line
void nsm(Bytes datagram);   // a session manager's
void midi(Bytes messages);  // each after a byte with its length, and what they strike
void http(Bytes request);   // OSCQuery, by a socket to a server of its own

void expect(bool holds, const char* what);

struct Target {
  const char* name;
  void (*feed)(Bytes);
};
// A row for each; ./run fuzz takes the names from here.
inline constexpr Target kTargets[] = {
    {"osc", osc},           {"stream", stream},     {"score", score},   {"bank", bank},   {"mesh", mesh},
    {"scene", scene},       {"material", material}, {"object", object}, {"notes", notes}, {"state", state},
    {"settings", settings}, {"options", options},   {"nsm", nsm},       {"midi", midi},   {"geo", geo},
    {"answer", answer},     {"reader", reader},     {"http", http},     {"gltf", gltf},   {"surface", surface},
    {"scala", scala}};

}  // namespace ringdown::fuzz
