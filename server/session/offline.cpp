#include "server/session/offline.h"

#include "engine/modal/nonlinear.h"
#include "protocol/pattern.h"
#include "protocol/schema.h"
#include "server/session/session.h"
#include "server/session/sound_file.h"

#include <algorithm>
#include <cmath>

namespace ringdown::session {
namespace {

using synth::Frame;

tl::unexpected<Error> cancelled() { return fail(ErrorKind::cancelled, "cancelled; nothing was written"); }

// One rendering: a session, the score that is played on it, and the samples so far.
class Run {
 public:
  Run(const OfflineOptions& options, Recording& recording)
      : options_(options), recording_(recording), session_(options.sample_rate_hz), score_(options.score) {
    session_.rack().set_on_warning([this](const std::string& sentence) { recording_.warnings.push_back(sentence); });
  }

  Result<void> prepare() {
    synth::MixerSettings settings = options_.mixer;
    settings.budget = 0;
    settings.most_coupled = modal::kMaxCoupled;
    session_.rack().mixer().configure(settings);
    for (const auto& [name, bank] : options_.objects) {
      if (const auto loaded = session_.rack().load(name, bank); !loaded) return fail(loaded.error());
    }
    if (options_.scene) {
      if (const auto loaded = session_.scene().load(*options_.scene, 0); !loaded) return fail(loaded.error());
    }
    const double score_s = take_score_length();
    const double seconds = options_.seconds.value_or(std::max(score_s, session_.scene().duration_s()));
    if (!(seconds > 0 && seconds <= kMaxRender_s)) {
      return fail(ErrorKind::bad_input,
                  "nothing to render: name a scene or a score, or a length of 0 to 86400 s with --seconds");
    }
    const auto frames = static_cast<std::size_t>(std::llround(seconds * options_.sample_rate_hz)) + latency();
    recording_.left.resize(frames);
    recording_.right.resize(frames);
    if (const auto order = settings.ambisonic_order) {
      recording_.ambisonics.assign(synth::ambisonic_channels(*order), std::vector<float>(frames));
    }
    return {};
  }

  Result<void> render(const Progress& progress) {
    const auto total = static_cast<Frame>(recording_.left.size());
    const auto block = static_cast<Frame>(options_.block_frames);
    for (Frame begin = 0; begin < total; begin += block) {
      render_until(std::min(begin + block, total));
      if (!progress(static_cast<double>(now_) / static_cast<double>(total))) return cancelled();
    }
    const auto late = static_cast<std::ptrdiff_t>(latency());
    for (auto* channel : {&recording_.left, &recording_.right})
      channel->erase(channel->begin(), channel->begin() + late);
    for (auto& channel : recording_.ambisonics) channel.resize(channel.size() - latency());  // passes no limiter
    return {};
  }

 private:
  // The score's last event and a tail, or just its end mark: scores for scsynth close with a /c_set that does nothing.
  double take_score_length() {
    if (score_.empty()) return 0;
    const double last_s = score_.back().time_s;
    if (score_.back().message.address != "/c_set") return last_s + kTail_s;
    score_.pop_back();
    return last_s;
  }

  void render_until(Frame end) {
    while (next_ < score_.size() && frame_of(score_[next_]) < end) {
      const wire::ScoreEvent& event = score_[next_++];
      if (!protocol::is_pattern(event.message.address)) {
        carry_out(event);
        continue;
      }
      const auto addresses = protocol::expand(event.message.address, *session_.rack().names());
      if (!addresses) warn(event, addresses.error().message);
      for (const std::string& address : addresses.value_or(std::vector<std::string>())) {
        carry_out({event.time_s, {address, event.message.arguments}});
      }
    }
    render_frames(end);
  }

  // Requests of the mixer's lane are sent ahead with their frames. Any other request splits the block at its frame.
  void carry_out(const wire::ScoreEvent& event) {
    auto request = protocol::parse(event.message);
    if (!request) return warn(event, request.error().message);
    const Frame frame = frame_of(event);
    const auto perform = [&](const auto& changes) -> Result<void> {
      render_frames(frame);
      return session_.perform(changes, now_).map([](auto) {});
    };
    const auto refuse = [&](const char* what) -> Result<void> {
      render_frames(frame);
      return fail(ErrorKind::refused, std::string(what) + " in a score");
    };
    const auto done =
        std::visit(protocol::Overloaded{
                       [&](const protocol::MixerRequest& r) {
                         flush_now_and_then();
                         return session_.play(r, frame);
                       },
                       [&](const protocol::TimedWorkerRequest& r) { return perform(r); },
                       [&](const protocol::WorkerRequest& r) { return perform(r); },
                       [&](const protocol::FileRequest&) { return refuse("no file is written"); },
                       [&](const protocol::Question&) { return refuse("nothing is answered"); },
                       [&](const protocol::SubscriptionRequest&) { return refuse("nobody can subscribe"); },
                       [&](const protocol::DaemonRequest&) { return refuse("there is no daemon to ask"); },
                   },
                   protocol::in_its_lane(*std::move(request)));
    if (!done) warn(event, done.error().message);
  }

  void render_frames(Frame end) {
    advance_scene(end);
    const auto begin = static_cast<std::size_t>(now_), count = static_cast<std::size_t>(end - now_);
    synth::Outputs outputs(recording_.left.data() + begin, recording_.right.data() + begin);
    for (std::size_t c = 0; c < recording_.ambisonics.size(); ++c) {
      outputs.listen_to_ambisonics(c, recording_.ambisonics[c].data() + begin);
    }
    session_.rack().mixer().render(outputs, count);
    session_.rack().collect();
    now_ = end;
  }

  // In short pieces, because a long block may have more events than the mixer's ring takes.
  void advance_scene(Frame end) {
    constexpr Frame kPiece = 256;
    for (Frame at = now_; at < end;) {
      at = std::min(at + kPiece, end);
      session_.scene().advance_to(at, std::nullopt);
      session_.rack().mixer().render({}, {});
    }
  }

  // Rendering 0 frames moves events from the mixer's short ring to its queue.
  void flush_now_and_then() {
    if (++pushed_ % (synth::kQueueCapacity / 2) == 0) session_.rack().mixer().render({}, {});
  }

  [[nodiscard]] std::size_t latency() { return session_.rack().mixer().latency_frames(); }

  [[nodiscard]] Frame frame_of(const wire::ScoreEvent& event) const {
    return std::max(now_, static_cast<Frame>(std::llround(event.time_s * options_.sample_rate_hz)));
  }

  void warn(const wire::ScoreEvent& event, const std::string& sentence) {
    recording_.warnings.push_back("at " + std::to_string(event.time_s) + " s: " + event.message.address + ": " +
                                  sentence);
  }

  const OfflineOptions& options_;
  Recording& recording_;
  Session session_;
  std::vector<wire::ScoreEvent> score_;
  std::size_t next_ = 0, pushed_ = 0;
  Frame now_ = 0;
};

// What is written: the ambisonic channels where there are some, else left and right.
std::vector<const std::vector<float>*> channels_of(const Recording& recording) {
  std::vector<const std::vector<float>*> channels;
  for (const std::vector<float>& channel : recording.ambisonics) channels.push_back(&channel);
  if (channels.empty()) channels = {&recording.left, &recording.right};
  return channels;
}

}  // namespace

Result<Recording> render_offline(const OfflineOptions& options, const Progress& progress) {
  Recording recording{.sample_rate_hz = options.sample_rate_hz};
  Run run(options, recording);
  if (const auto ready = run.prepare(); !ready) return fail(ready.error());
  if (const auto rendered = run.render(progress); !rendered) return fail(rendered.error());
  for (const std::vector<float>* channel : channels_of(recording)) {
    for (const float sample : *channel) recording.peak = std::max(recording.peak, std::abs(sample));
  }
  return recording;
}

Result<void> write_audio(const Recording& recording, const std::filesystem::path& path, const Progress& progress) {
  constexpr std::size_t kPiece = 1 << 16;  // frames
  const auto target = output_target(path);
  if (!target) return fail(target.error());
  const std::vector<const std::vector<float>*> channels = channels_of(recording);
  SoundFormat format{.channels = channels.size()};
  if (!recording.ambisonics.empty()) format.comment = "AmbiX: channels in ACN order, SN3D";
  auto file = SoundFile::create(*target, recording.sample_rate_hz, format);
  if (!file) return fail(file.error());
  const std::size_t frames = recording.left.size();
  std::vector<float> samples;
  for (std::size_t begin = 0; begin < frames; begin += kPiece) {
    const std::size_t end = std::min(begin + kPiece, frames);
    samples.clear();
    for (std::size_t n = begin; n < end; ++n) {
      for (const std::vector<float>* channel : channels) samples.push_back((*channel)[n]);
    }
    if (const auto written = file->write(samples); !written) return written;
    if (!progress(static_cast<double>(end) / static_cast<double>(frames))) return cancelled();
  }
  return file->finish();
}

}  // namespace ringdown::session
