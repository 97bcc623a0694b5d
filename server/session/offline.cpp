#include "server/session/offline.h"

#include "engine/modal/nonlinear.h"
#include "protocol/pattern.h"
#include "protocol/schema.h"
#include "server/session/session.h"
#include "server/session/sound_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>

namespace ringdown::session {
namespace {

using synth::Frame;

tl::unexpected<Error> cancelled() { return fail(ErrorKind::cancelled, "cancelled; nothing was written"); }

// A part of the sound. The mix and the ambisonic channels begin and end at different blocks, because the limiter delays
// only the mix.
struct Piece {
  std::span<const float> left, right;
  std::vector<std::span<const float>> ambisonics;  // all of one length
};

// Returns the channels to write: the ambisonic ones if there are any, else left and right.
std::vector<std::span<const float>> written_channels(const Piece& piece) {
  return piece.ambisonics.empty() ? std::vector{piece.left, piece.right} : piece.ambisonics;
}

float peak_of(const Piece& piece) {
  float peak = 0;
  for (const std::span<const float> channel : written_channels(piece)) {
    for (const float sample : channel) peak = std::max(peak, std::abs(sample));
  }
  return peak;
}

// A sound file that is written in pieces.
class PieceFile {
 public:
  // `frames` is the length of the whole file; the number of channels is that of a piece.
  static Result<PieceFile> create(const std::filesystem::path& path, double sample_rate_hz, const Piece& first,
                                  std::size_t frames) {
    const auto target = output_target(path);
    if (!target) return fail(target);
    SoundFormat format{.channels = written_channels(first).size(), .frames = frames};
    if (!first.ambisonics.empty()) format.comment = "AmbiX: channels in ACN order, SN3D";
    auto file = SoundFile::create(*target, sample_rate_hz, format);
    if (!file) return fail(file);
    return PieceFile(std::move(*file));
  }

  Result<void> take(const Piece& piece) {
    const auto channels = written_channels(piece);
    for (std::size_t n = 0; n < channels.front().size(); ++n) {
      for (const std::span<const float> channel : channels) samples_.push_back(channel[n]);
    }
    return samples_.size() < kKept ? Result<void>() : write();
  }

  Result<void> finish() {
    if (const auto written = write(); !written) return written;
    return file_.finish();
  }

 private:
  static constexpr std::size_t kKept = 1 << 15;  // samples before they are written

  explicit PieceFile(SoundFile file) : file_(std::move(file)) {}

  Result<void> write() {
    const auto written = file_.write(samples_);
    samples_.clear();
    return written;
  }

  SoundFile file_;
  std::vector<float> samples_;  // frame by frame
};

// One rendering: a session, the score that is played on it, and the block that is being rendered.
class Run {
 public:
  using Take = std::function<Result<void>(const Piece&)>;

  // Warnings are added to `warnings`.
  Run(const OfflineOptions& options, std::vector<std::string>& warnings)
      : options_(options), warnings_(warnings), session_(options.sample_rate_hz), score_(options.score) {
    session_.rack().set_on_warning([this](const std::string& sentence) { warnings_.push_back(sentence); });
  }

  Result<void> prepare() {
    synth::MixerSettings settings = options_.mixer;
    settings.budget = 0;
    settings.max_coupled = modal::kMaxCoupled;
    session_.rack().mixer().configure(settings);
    for (const auto& [name, bank] : options_.objects) {
      if (const auto loaded = session_.rack().load(name, bank); !loaded) return fail(loaded);
    }
    if (options_.foley) {
      session_.scene().set_watched(true);  // contacts are reported even if nothing can sound
      session_.scene().recover_contacts(
          *options_.foley, [this](std::span<const scene::HeardContact> contacts) { contacts_.add(contacts); });
    }
    if (options_.scene) {
      if (const auto loaded = session_.scene().load(*options_.scene, 0); !loaded) return fail(loaded);
    }
    if (options_.foley) name_contacts();
    const double score_s = take_score_length();
    if (options_.foley) tail_ = !options_.seconds && !options_.tail_s;
    const double seconds = options_.foley && !options_.seconds
                               ? session_.scene().duration_s() + options_.tail_s.value_or(0)
                               : options_.seconds.value_or(std::max(score_s, session_.scene().duration_s()));
    if (!(seconds > 0 && seconds <= kMaxRender_s)) {
      return fail(ErrorKind::bad_input,
                  "nothing to render: name a scene or a score, or a length of 0 to 86400 s with --seconds");
    }
    frames_ = longest_ = static_cast<Frame>(std::llround(seconds * options_.sample_rate_hz));
    second_ = static_cast<Frame>(std::llround(options_.sample_rate_hz));
    fade_ = static_cast<Frame>(std::llround(options_.fade_s * options_.sample_rate_hz));
    if (tail_) longest_ = frames_ + static_cast<Frame>(kMaxTail_s - kTail_s) * second_;
    left_.resize(options_.block_frames);
    right_.resize(options_.block_frames);
    if (const auto order = settings.ambisonic_order) {
      ambisonics_.assign(synth::ambisonic_channels(*order), std::vector<float>(options_.block_frames));
    }
    return {};
  }

  // The length of the sound, and its channels without samples. Valid once the run is prepared. Before render() the
  // length is the largest possible one.
  [[nodiscard]] std::size_t frames() const { return static_cast<std::size_t>(longest_); }
  [[nodiscard]] Piece silence() const { return {{}, {}, std::vector<std::span<const float>>(ambisonics_.size())}; }

  [[nodiscard]] std::vector<ContactRow> contacts() const { return contacts_.rows(); }

  // Hands the sound to `take`, piece by piece, and ends with the first error that it returns. A tail grows second by
  // second, until the last second is quiet; the limiter's delay comes after that.
  Result<void> render(const Take& take, const Progress& progress) {
    take_ = take;
    const auto block = static_cast<Frame>(options_.block_frames);
    while (now_ < longest_ + latency()) {
      if (now_ == frames_ && frames_ < longest_) grow_tail();
      render_until(std::min(now_ + block, frames_ < longest_ ? frames_ : longest_ + latency()));
      if (!taken_) return taken_;
      if (!progress(static_cast<double>(now_) / static_cast<double>(longest_ + latency()))) return cancelled();
    }
    return {};
  }

 private:
  void name_contacts() {
    std::map<scene::BodyId, std::string> names;
    for (const scene::BodyState& body : session_.scene().poses().bodies) names[body.id] = body.name;
    if (const auto scene = session_.scene().description()) {
      for (std::size_t k = 0; k < scene->statics.size(); ++k)
        names[scene::kFirstStatic + static_cast<scene::BodyId>(k)] = scene->statics[k].name;
    }
    contacts_.set_names(std::move(names));
  }

  // Lets the last frames of a sound of known length fade away. `late` is the channel's delay.
  void fade(std::vector<float>& samples, Frame begin, Frame end, Frame late) const {
    if (fade_ == 0 || frames_ != longest_) return;
    for (Frame frame = std::max(begin, frames_ - fade_ + late); frame < end; ++frame) {
      const double left = static_cast<double>(std::max<Frame>(frames_ + late - frame, 0)) / static_cast<double>(fade_);
      float& sample = samples[static_cast<std::size_t>(frame - begin)];
      sample *= static_cast<float>(0.5 - 0.5 * std::cos(std::numbers::pi * std::min(left, 1.0)));
    }
  }

  // The score's last event and a tail, or just its end mark: scores for scsynth close with a /c_set that does nothing.
  double take_score_length() {
    if (score_.empty()) return 0;
    const double last_s = score_.back().time_s;
    if (score_.back().message.address != "/c_set") {
      tail_ = !options_.seconds;
      return last_s + kTail_s;
    }
    score_.pop_back();
    return last_s;
  }

  // Adds a second to the sound, or makes its length final if the last second was quiet.
  void grow_tail() {
    if (peak_since_ > loudest_ * static_cast<float>(std::pow(10, -kTail_db / 20))) {
      frames_ = std::min(frames_ + second_, longest_);
      peak_since_ = 0;
    } else {
      longest_ = frames_;
    }
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
    const auto done = visit(Overloaded{
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

  // Renders at most one block and hands it on.
  void render_frames(Frame end) {
    advance_scene(end);
    const Frame begin = std::exchange(now_, end);
    synth::Outputs outputs(left_.data(), right_.data());
    for (std::size_t c = 0; c < ambisonics_.size(); ++c) outputs.listen_to_ambisonics(c, ambisonics_[c].data());
    session_.rack().mixer().render(outputs, static_cast<std::size_t>(end - begin));
    session_.rack().collect();
    fade(left_, begin, end, latency());
    fade(right_, begin, end, latency());
    for (std::vector<float>& channel : ambisonics_) fade(channel, begin, end, 0);
    const auto part = [&](const std::vector<float>& samples, Frame first, Frame last) {
      const Frame from = std::clamp(first, begin, end), to = std::clamp(last, from, end);
      return std::span(samples).subspan(static_cast<std::size_t>(from - begin), static_cast<std::size_t>(to - from));
    };
    // The frames of the sound from `first` to `last` that lie in this block.
    const auto piece_of = [&](Frame first, Frame last) {
      const Frame late = latency();
      Piece piece{part(left_, late + first, late + last), part(right_, late + first, late + last), {}};
      for (const std::vector<float>& channel : ambisonics_) piece.ambisonics.push_back(part(channel, first, last));
      return piece;
    };
    const Piece piece = piece_of(0, frames_);
    if (tail_) {
      loudest_ = std::max(loudest_, peak_of(piece));
      peak_since_ = std::max(peak_since_, peak_of(piece_of(frames_ - second_, frames_)));
    }
    if (taken_) taken_ = take_(piece);
  }

  // Advances in short pieces, because a long block may have more events than the mixer's ring holds.
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

  [[nodiscard]] Frame latency() { return static_cast<Frame>(session_.rack().mixer().latency_frames()); }

  [[nodiscard]] Frame frame_of(const wire::ScoreEvent& event) const {
    return std::max(now_, static_cast<Frame>(std::llround(event.time_s * options_.sample_rate_hz)));
  }

  void warn(const wire::ScoreEvent& event, const std::string& sentence) {
    warnings_.push_back(formatted("at {:f} s: {}: {}", event.time_s, event.message.address, sentence));
  }

  const OfflineOptions& options_;
  std::vector<std::string>& warnings_;
  Session session_;
  std::vector<wire::ScoreEvent> score_;
  std::size_t next_ = 0, pushed_ = 0;
  Frame now_ = 0;                   // frames rendered so far
  Frame frames_ = 0, longest_ = 0;  // length of the sound without the limiter's delay: so far, and at most
  Frame second_ = 0;                // frames in a second
  Frame fade_ = 0;                  // frames of the fade at the end
  ContactReport contacts_;
  bool tail_ = false;                   // whether the length depends on how long the sound rings
  float loudest_ = 0, peak_since_ = 0;  // largest |sample| of the tail's sound: of all, and of the last second
  std::vector<float> left_, right_;     // one block
  std::vector<std::vector<float>> ambisonics_;
  Take take_;
  Result<void> taken_;  // the result of take_
};

void append(std::vector<float>& samples, std::span<const float> more) {
  samples.insert(samples.end(), more.begin(), more.end());
}

}  // namespace

Result<Recording> render_offline(const OfflineOptions& options, const Progress& progress) {
  Recording recording{.sample_rate_hz = options.sample_rate_hz};
  Run run(options, recording.warnings);
  if (const auto ready = run.prepare(); !ready) return fail(ready);
  recording.left.reserve(run.frames());
  recording.right.reserve(run.frames());
  recording.ambisonics.resize(run.silence().ambisonics.size());
  for (std::vector<float>& channel : recording.ambisonics) channel.reserve(run.frames());
  const auto keep = [&recording](const Piece& piece) -> Result<void> {
    append(recording.left, piece.left);
    append(recording.right, piece.right);
    for (std::size_t c = 0; c < piece.ambisonics.size(); ++c) append(recording.ambisonics[c], piece.ambisonics[c]);
    recording.peak = std::max(recording.peak, peak_of(piece));
    return {};
  };
  if (const auto rendered = run.render(keep, progress); !rendered) return fail(rendered);
  return recording;
}

Result<Rendering> render_to_file(const OfflineOptions& options, const std::filesystem::path& path,
                                 const Progress& progress) {
  Rendering rendering;
  Run run(options, rendering.warnings);
  if (const auto ready = run.prepare(); !ready) return fail(ready);
  auto file = PieceFile::create(path, options.sample_rate_hz, run.silence(), run.frames());
  if (!file) return fail(file);
  const auto write = [&](const Piece& piece) {
    rendering.peak = std::max(rendering.peak, peak_of(piece));
    return file->take(piece);
  };
  if (const auto rendered = run.render(write, progress); !rendered) return fail(rendered);
  if (const auto finished = file->finish(); !finished) return fail(finished);
  rendering.contacts = run.contacts();
  rendering.seconds = static_cast<double>(run.frames()) / options.sample_rate_hz;
  return rendering;
}

Result<void> write_audio(const Recording& recording, const std::filesystem::path& path, const Progress& progress) {
  constexpr std::size_t kPiece = 1 << 14;  // frames
  const std::size_t frames = recording.left.size();
  const auto piece_at = [&](std::size_t begin, std::size_t count) {
    Piece piece{std::span(recording.left).subspan(begin, count), std::span(recording.right).subspan(begin, count), {}};
    for (const auto& channel : recording.ambisonics)
      piece.ambisonics.push_back(std::span(channel).subspan(begin, count));
    return piece;
  };
  auto file = PieceFile::create(path, recording.sample_rate_hz, piece_at(0, 0), frames);
  if (!file) return fail(file);
  for (std::size_t begin = 0; begin < frames; begin += kPiece) {
    const std::size_t count = std::min(kPiece, frames - begin);
    if (const auto written = file->take(piece_at(begin, count)); !written) return written;
    if (!progress(static_cast<double>(begin + count) / static_cast<double>(frames))) return cancelled();
  }
  return file->finish();
}

}  // namespace ringdown::session
