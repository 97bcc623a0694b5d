#include "engine/synth/renderer.h"

#include "engine/synth/modes/fetch.h"
#include "engine/synth/objects/shedding.h"
#include "engine/synth/modes/work_cost.h"

#include <algorithm>

namespace ringdown::synth {
namespace {

constexpr std::size_t kMinModesToShare = 3000;  // fewer modes are rendered faster by one thread

}  // namespace

void Renderer::set_threads(std::size_t threads) {
  helpers_.reset();
  workspaces_ = std::vector<Workspace>(std::max<std::size_t>(1, threads));
  if (has_room_) make_room();
  if (threads < 2) return;
  helpers_ = std::make_unique<WorkerPool>(
      threads - 1, [this](std::size_t which, std::size_t thread) REALTIME { render_source(which, thread); });
}

void Renderer::open(std::size_t frames) REALTIME { main().sums.open(frames); }

bool Renderer::prefers_moments(std::size_t frames) const REALTIME {
  return slow_modes_ * frames > kFramesPerMode * (kMomentsFixed + slow_modes_);
}

// The sources of a chunk are a list of independent tasks. The audio thread and the helpers take them from the worker
// pool, each adds to the sums of its own workspace, and the audio thread adds these up when all are done. Which thread
// renders a source decides in which order numbers are added, so with helpers two renders agree only to rounding; on one
// thread they agree bit for bit. Few modes are not shared among threads: handing them over would take longer than
// rendering them.
void Renderer::render(std::span<Source* const> sources, const Chunk& chunk) REALTIME {
  sources_ = sources;
  chunk_ = &chunk;
  for (Workspace& workspace : workspaces().subspan(1)) {
    workspace.sums.open(chunk.frames);
    workspace.counts = {};
  }
  if (chunk.frames != kChunkFrames) {
    for (Source* source : sources) source->prepare(chunk);
  }
  if (helpers_ && slow_modes_ > kMinModesToShare) {
    helpers_->run(sources.size());
  } else {
    for (std::size_t i = 0; i < sources.size(); ++i) render_source(i, 0);
  }
  for (const Workspace& helper : workspaces().subspan(1)) {
    main().sums.add(helper.sums);
    main().counts.add(helper.counts);
  }
  slow_modes_ = main().counts.slow_modes;
}

void Renderer::render_source(std::size_t which, std::size_t thread) REALTIME {
  Source& source = *sources_[which];
  if (chunk_->moments) fetch_ahead(sources_, which, FetchStage::numbers, chunk_->frames);
  Workspace& workspace = workspaces_[thread];
  if (chunk_->shedding->may_render(source, *chunk_, workspace)) {
    source.render(*chunk_, workspace);
  } else {
    source.skip(*chunk_, workspace);
  }
}

}  // namespace ringdown::synth
