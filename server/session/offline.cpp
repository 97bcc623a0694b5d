#include "server/session/offline.h"

#include "engine/modal/nonlinear.h"
#include "protocol/pattern.h"
#include "protocol/schema.h"
#include "server/session/loudness.h"
#include "server/session/session.h"
#include "server/session/sound_piece.h"
#include "server/session/stems.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

namespace ringdown::session {
namespace {

using synth::Frame;

tl::unexpected<Error> cancelled() { return fail(ErrorKind::cancelled, "cancelled; nothing was written"); }

// One rendering: a session, the score that is played on it, and the block that is being rendered.
class Run {
 public:
  using Take = std::function<Result<void>(const Piece&)>;

  // Warnings are added to `warnings`. With `stems` what happens to each object is kept.
  Run(const OfflineOptions& options, std::vector<std::string>& warnings, bool stems = false)
      : options_(options),
        warnings_(warnings),
        session_(options.sample_rate_hz, {}, options.variation ? Rack::Vary(Variation(*options.variation)) : nullptr),
        score_(options.score) {
    if (stems) stems_.emplace(session_.rack());
    session_.rack().warn = [this](const std::string& sentence) { warnings_.push_back(sentence); };
  }

  Result<void> prepare() {
    synth::MixerSettings settings = options_.mixer;
    settings.budget = 0;
    settings.max_coupled = modal::kMaxCoupled;
    session_.rack().mixer().configure(settings);
    for (const auto& [name, bank] : options_.objects) {
      if (const auto loaded = session_.rack().load(name, bank); !loaded) return fail(loaded);
    }
    ScenePlayer::Watch watch;
    if (options_.foley) {
      session_.scene().set_watched(true);  // contacts are reported even if nothing can sound
      watch = [this](std::span<const scene::HeardContact> contacts) { contacts_.add(contacts); };
    }
    session_.scene().read_with(options_.foley, options_.camera, std::move(watch));
    if (options_.scene) {
      if (const auto loaded = session_.scene().load(*options_.scene, 0); !loaded) return fail(loaded);
    }
    if (options_.foley) name_contacts();
    if (const auto cut = cut_out(); !cut) return cut;
    block_.left.resize(options_.block_frames);
    block_.right.resize(options_.block_frames);
    if (const auto order = settings.ambisonic_order) {
      block_.ambisonics.assign(synth::ambisonic_channels(*order), std::vector<float>(options_.block_frames));
    }
    return {};
  }

  // Hands what the score's pickups feel to `take`, too. Returns their number, up to the last; 0: the score sets none.
  std::size_t feel(const Take& take) {
    for (const wire::ScoreEvent& event : score_) {
      const auto request = protocol::parse(event.message);
      const auto* const set = request ? request->get_if<protocol::SetPickup>() : nullptr;
      if (set) felt_.resize(std::max<std::size_t>(felt_.size(), set->verb.number));
    }
    for (std::vector<float>& samples : felt_) samples.resize(options_.block_frames);
    take_felt_ = take;
    return felt_.size();
  }

  // The length of the sound. Before render() it is the largest possible one. Valid once the run is prepared.
  [[nodiscard]] std::size_t frames() const { return static_cast<std::size_t>(longest_ - cut_.first); }
  [[nodiscard]] PieceFormat format() const {
    const std::size_t field = block_.ambisonics.size();
    return {.channels = field > 0 ? field : 2, .ambisonic = field > 0, .frames = frames()};
  }
  [[nodiscard]] const Cut& cut() const { return cut_; }
  [[nodiscard]] const synth::MixerSettings& mixer() { return session_.rack().mixer().settings(); }
  [[nodiscard]] const StemLog* stems() const { return stems_ ? &*stems_ : nullptr; }

  [[nodiscard]] BodyCounts bodies() const {
    const auto scene = session_.scene().description();
    if (!scene) return {};
    BodyCounts counts;
    for (const scene::BodyDescription& body : scene->bodies) {
      counts.moved += body.path != nullptr;
      counts.sounding += !body.object.empty();
    }
    return counts;
  }
  [[nodiscard]] std::vector<ContactRow> contacts() const { return contacts_.rows(); }

  // Hands the sound to `take`, piece by piece, and ends with the first error that it returns. A tail grows second by
  // second, until the last second is quiet; the limiter's delay comes after that.
  Result<void> render(const Take& take, const Progress& progress) {
    take_ = take;
    const auto block = static_cast<Frame>(options_.block_frames);
    while (now_ < longest_ + latency()) {
      if (now_ == cut_.end && cut_.end < longest_) grow_tail();
      render_until(std::min(now_ + block, cut_.end < longest_ ? cut_.end : longest_ + latency()));
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

  // Decides which part is written, and how long its tail is.
  Result<void> cut_out() {
    const auto frames_of = [this](double seconds) {
      return static_cast<Frame>(std::llround(seconds * options_.sample_rate_hz));
    };
    const double score_s = take_score_length(), scene_s = session_.scene().duration_s();
    const double last_s = options_.to_s ? std::min(*options_.to_s, scene_s) : scene_s;
    const double all_s = options_.seconds.value_or(std::max(score_s, last_s));
    const std::optional<double> tail_s = options_.seconds || (marked_ && !options_.tail_s) ? 0 : options_.tail_s;
    const double min_tail_s = options_.min_tail_s.value_or(options_.score.empty() ? kMinTail_s : kMinScoreTail_s);
    const double sure_s = all_s + tail_s.value_or(min_tail_s), from_s = options_.from_s.value_or(0);
    const bool given = options_.scene || !options_.score.empty() || options_.seconds;
    if (!given || !(sure_s > 0 && sure_s <= kMaxRender_s)) {
      return fail(ErrorKind::bad_input,
                  "nothing to render: name a scene or a score, or a length of 0 to 86400 s with --seconds");
    }
    if (from_s > 0 && !(from_s < all_s)) {
      return fail(ErrorKind::usage, "nothing to render: the part begins at " + std::to_string(from_s) +
                                        " s, and the scene or the part ends at " + std::to_string(all_s) + " s");
    }
    second_ = frames_of(1);
    if (!options_.seconds && options_.scene) scene_end_ = frames_of(all_s);
    cut_ = {.first = frames_of(from_s), .end = frames_of(sure_s), .rise = from_s > 0 ? frames_of(kRise_s) : 0};
    cut_.fall = std::min(frames_of(options_.fade_s), cut_.end - cut_.first);
    tail_ = !tail_s;
    longest_ = tail_ ? frames_of(all_s) + static_cast<Frame>(kMaxTail_s) * second_ : cut_.end;
    return {};
  }

  // The score's last event, or its end mark: scores for scsynth close with a /c_set that does nothing.
  double take_score_length() {
    if (score_.empty()) return 0;
    const double last_s = score_.back().time_s;
    marked_ = score_.back().message.address == "/c_set";
    if (marked_) score_.pop_back();
    return last_s;
  }

  // Adds a second to the sound. If the last second was quiet, adds a fade instead and makes the length final.
  void grow_tail() {
    const auto from_db = [](double db) { return static_cast<float>(std::pow(10, db / 20)); };
    if (peak_since_ > std::min(from_db(kSilence_db), loudest_ * from_db(-kTail_db))) {
      cut_.end = std::min(cut_.end + second_, longest_);
      peak_since_ = 0;
    } else {
      longest_ = cut_.end += cut_.fall;
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
    advance_scene(std::min(end, scene_end_));
    block_.begin = std::exchange(now_, end);
    block_.end = end;
    if (stems_) stems_->begin_block(block_.begin);
    synth::Outputs outputs(block_.left.data(), block_.right.data());
    for (std::size_t c = 0; c < block_.ambisonics.size(); ++c)
      outputs.listen_to_ambisonics(c, block_.ambisonics[c].data());
    for (std::size_t pickup = 0; pickup < felt_.size(); ++pickup)
      outputs.listen_to_pickup(pickup, felt_[pickup].data());
    session_.rack().mixer().render(outputs, static_cast<std::size_t>(end - block_.begin));
    session_.rack().collect();
    const Frame late = latency();
    Cut fades = cut_;
    if (cut_.end != longest_) fades.fall = 0;  // it is not known yet where it lies
    fades.fade(block_, late);
    const Piece piece = Cut::part(block_, cut_.first, cut_.end, late);
    if (tail_) {
      loudest_ = std::max(loudest_, peak_of(piece));
      peak_since_ = std::max(peak_since_, peak_of(Cut::part(block_, cut_.end - second_, cut_.end, late)));
    }
    if (taken_) taken_ = take_(piece);
    if (taken_ && !felt_.empty()) taken_ = take_felt_(felt_piece());
  }

  [[nodiscard]] Piece felt_piece() const {
    const Frame from = std::clamp(cut_.first, block_.begin, block_.end), to = std::clamp(cut_.end, from, block_.end);
    Piece piece;
    for (const std::vector<float>& samples : felt_) {
      piece.ambisonics.push_back(std::span(samples).subspan(static_cast<std::size_t>(from - block_.begin),
                                                            static_cast<std::size_t>(to - from)));
    }
    return piece;
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
  Frame now_ = 0;                    // frames rendered so far
  Cut cut_;                          // in frames without the limiter's delay; its end may grow ...
  Frame longest_ = 0;                // ... up to this one
  Frame second_ = 0;                 // frames in a second
  Frame scene_end_ = synth::kNever;  // the scene stands still from this frame on
  ContactReport contacts_;
  std::optional<StemLog> stems_;
  bool marked_ = false;                 // whether the score has an end mark
  bool tail_ = false;                   // whether the length depends on how long the sound rings
  float loudest_ = 0, peak_since_ = 0;  // largest |sample| of the tail's sound: of all, and of the last second
  RenderedBlock block_;
  std::vector<std::vector<float>> felt_;  // of the block, for each pickup
  Take take_, take_felt_;
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
  if (run.format().ambisonic) recording.ambisonics.resize(run.format().channels);
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
                                 const Progress& progress, const FileOptions& file_options) {
  Rendering rendering;
  Run run(options, rendering.warnings, file_options.stems.has_value());
  if (const auto ready = run.prepare(); !ready) return fail(ready);
  PieceFormat format = run.format();
  format.bits = file_options.bits;
  format.scaled = file_options.lufs.has_value();
  auto file = PieceFile::create(path, options.sample_rate_hz, format);
  if (!file) return fail(file);
  std::optional<PieceFile> felt;
  if (file_options.pickups) {
    const std::size_t pickups = run.feel([&felt](const Piece& piece) { return felt->take(piece); });
    if (pickups == 0) return fail(ErrorKind::usage, "--pickups: the score sets no pickup (/object/NAME/pickup)");
    auto made = PieceFile::create(*file_options.pickups, options.sample_rate_hz,
                                  {.channels = pickups, .frames = run.frames(), .bits = format.bits});
    if (!made) return fail(made);
    felt.emplace(std::move(*made));
  }
  Loudness loudness(options.sample_rate_hz);
  const auto write = [&](const Piece& piece) {
    rendering.peak = std::max(rendering.peak, peak_of(piece));
    loudness.add(piece.left, piece.right);
    return file->take(piece);
  };
  // Stems take about as long as the rendering itself, or longer.
  const double share = file_options.stems ? 0.4 : 1;
  const auto rendered = run.render(write, [&](double done) { return progress(share * done); });
  if (!rendered) return fail(rendered);
  rendering.lufs = loudness.lufs();
  rendering.true_peak = loudness.true_peak();
  if (file_options.lufs && rendering.lufs) {
    rendering.gain = std::pow(10, (*file_options.lufs - *rendering.lufs) / 20);
    rendering.lufs = file_options.lufs;
    rendering.peak *= static_cast<float>(rendering.gain);
    rendering.true_peak *= rendering.gain;
  }
  if (file_options.stems) {
    const StemSettings settings{*file_options.stems, options.sample_rate_hz, format.bits, run.mixer(), run.cut()};
    const auto stems =
        write_stems(*run.stems(), settings, [&](double done) { return progress(share + (1 - share) * done); });
    if (!stems) return fail(stems);
    rendering.stems = *stems;
  }
  if (const auto finished = file->finish(static_cast<float>(rendering.gain)); !finished) return fail(finished);
  if (felt) {
    if (const auto finished = felt->finish(); !finished) return fail(finished);
  }
  rendering.contacts = run.contacts();
  rendering.bodies = run.bodies();
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
  const std::size_t field = recording.ambisonics.size();
  auto file = PieceFile::create(path, recording.sample_rate_hz,
                                {.channels = field > 0 ? field : 2, .ambisonic = field > 0, .frames = frames});
  if (!file) return fail(file);
  for (std::size_t begin = 0; begin < frames; begin += kPiece) {
    const std::size_t count = std::min(kPiece, frames - begin);
    if (const auto written = file->take(piece_at(begin, count)); !written) return written;
    if (!progress(static_cast<double>(begin + count) / static_cast<double>(frames))) return cancelled();
  }
  return file->finish();
}

}  // namespace ringdown::session
