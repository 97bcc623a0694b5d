// Renders the sources of a chunk, on the audio thread or spread over several threads, and adds up their sounds.
//
// Every thread has a workspace of its own, so threads share nothing while they render; the audio thread then adds the
// helpers' sums to its own. Slow modes are summed as moments when enough of them sounded in the last chunk, else by
// tables (work_cost.h); the choice depends on nothing else, so renders repeat bit for bit on one thread.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/modes/chunk.h"
#include "engine/synth/objects/source.h"
#include "engine/synth/worker_pool.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace ringdown::synth {

class Renderer {
 public:
  // Renders on `threads` threads, the audio thread among them. [worker, while nothing is rendered]
  void set_threads(std::size_t threads);
  [[nodiscard]] std::size_t threads() const REALTIME { return workspaces_.size(); }
  // Makes room for ambisonic channels in each thread. Must be repeated after set_threads(). [worker, while nothing is
  // rendered]
  void have_field(bool on) {
    for (Workspace& workspace : workspaces_) workspace.sums.have_field(on);
  }

  // Makes room for sums in each thread. Must come before anything is rendered. [worker]
  void make_room() {
    has_room_ = true;
    for (Workspace& workspace : workspaces_) workspace.sums.make_room();
  }

  // All functions below: [audio]

  // Begins a chunk; more than kChunkFrames only if nothing is rendered in it.
  void open(std::size_t frames) REALTIME;
  // Returns whether moments are cheaper than tables in a chunk of `frames`.
  [[nodiscard]] bool prefers_moments(std::size_t frames) const REALTIME;
  void render(std::span<Source* const> sources, const Chunk& chunk) REALTIME;
  // Turns the sums into samples, after everything was added; the samples are in sums() until the next open().
  void close() REALTIME { main().sums.close(); }

  // Return the audio thread's own workspace, and all workspaces.
  [[nodiscard]] Workspace& main() REALTIME { return workspaces_[0]; }
  [[nodiscard]] std::span<Workspace> workspaces() REALTIME { return {workspaces_.data(), workspaces_.size()}; }

 private:
  void render_source(std::size_t which, std::size_t thread) REALTIME;

  std::vector<Workspace> workspaces_ = std::vector<Workspace>(1);  // the audio thread's, then its helpers' workspaces
  std::unique_ptr<WorkerPool> helpers_;                            // null: the audio thread works alone
  bool has_room_ = false;                                          // make_room() was called
  std::size_t slow_modes_ = 0;                                     // slow modes that sounded in the last chunk
  std::span<Source* const> sources_;                               // sources of the chunk being rendered
  const Chunk* chunk_ = nullptr;
};

}  // namespace ringdown::synth
