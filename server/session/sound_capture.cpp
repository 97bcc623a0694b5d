#include "server/session/sound_capture.h"

#include "engine/base/within_memory.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

namespace ringdown::session {
namespace {

using namespace std::chrono_literals;
using synth::Frame;
using synth::SoundTap;

constexpr auto kTurn = 10ms;  // how often the tap is emptied: it holds some 0.7 s in blocks of 64 frames

}  // namespace

bool SoundCapture::is_open() const {
  const std::scoped_lock lock(mutex_);
  return !path_.empty();
}

bool SoundCapture::writes() const { return !path_.empty() && !end_; }

Result<void> SoundCapture::start(OutputTarget target) {
  const std::scoped_lock lock(mutex_);
  if (writes()) {
    return fail(ErrorKind::refused,
                "path: " + path_.string() + " is being captured already; end it with /capture/stop");
  }
  const synth::Mixer& mixer = rack_.mixer();
  const std::filesystem::path path = target.named;
  auto file = SoundFile::create(std::move(target), mixer.sample_rate_hz());
  if (!file) return fail(file);
  frames_ = 0;
  lost_ = 0;
  sample_rate_hz_ = mixer.sample_rate_hz();
  const Frame first = mixer.counters().frames + static_cast<Frame>(mixer.latency_frames());
  const auto started = within_memory("capture " + path.string(), [&]() -> Result<void> {
    thread_ = std::jthread(
        [this, first](const std::stop_token& stop, SoundFile opened) { run(stop, std::move(opened), first); },
        std::move(*file));
    return {};
  });
  if (!started) return started;
  rack_.mixer().capture_tap().watch(true);
  path_ = path;
  end_.reset();
  return {};
}

Result<std::size_t> SoundCapture::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  const std::scoped_lock lock(mutex_);
  if (path_.empty()) return fail(ErrorKind::refused, "nothing is being captured; begin with /capture/start");
  path_.clear();
  return *std::exchange(end_, std::nullopt);
}

std::optional<SoundCapture::Progress> SoundCapture::progress() const {
  const std::scoped_lock lock(mutex_);
  if (!writes()) return std::nullopt;
  return Progress{path_.string(), static_cast<double>(frames_) / sample_rate_hz_};
}

void SoundCapture::run(const std::stop_token& stop, SoundFile file, Frame first) {
  Result<bool> more = true;
  for (bool last = false; more && *more && !last;) {
    std::this_thread::sleep_for(kTurn);
    last = stop.stop_requested();
    more = within_memory("capture sound", [&] { return write_pieces(file, first); });
  }
  rack_.mixer().capture_tap().watch(false);
  const auto finished = file.finish();
  const std::scoped_lock lock(mutex_);
  Result<std::size_t> end = frames_.load();
  if (!finished) {
    end = fail(finished);
  } else if (!more) {
    end = fail(more.error().kind, "{}; it holds the first {:f} s", more.error().message,
               static_cast<double>(frames_) / sample_rate_hz_);
  }
  if (lost_ > 0) rack_.warn(formatted("{}: {} frames were lost and are silent in it", path_.string(), lost_));
  if (!end) rack_.warn(end.error().message);
  if (more && !*more && finished) rack_.warn(path_.string() + " has ended: it is full, or the sample rate has changed");
  end_ = std::move(end);
}

Result<bool> SoundCapture::write_pieces(SoundFile& file, Frame first) {
  SoundTap& tap = rack_.mixer().capture_tap();
  std::vector<float> samples;
  std::size_t frames = frames_;
  bool more = true;
  for (; const SoundTap::Piece* piece = tap.front(); tap.pop()) {
    const auto early = static_cast<std::size_t>(std::max<Frame>(first - piece->frame, 0));
    if (early >= piece->frames || !more) continue;
    more = piece->sample_rate_hz == sample_rate_hz_;
    if (!more) continue;
    const auto begin = std::min(early + static_cast<std::size_t>(piece->frame - first), max_frames_);
    const std::size_t end = std::min(begin + piece->frames - early, max_frames_);
    samples.insert(samples.end(), 2 * (begin - frames), 0.0f);
    lost_ += begin - frames;
    const auto from = piece->samples.begin() + static_cast<std::ptrdiff_t>(2 * early);
    samples.insert(samples.end(), from, from + static_cast<std::ptrdiff_t>(2 * (end - begin)));
    frames = end;
    more = frames < max_frames_;
  }
  if (const auto written = file.write(samples); !written) return fail(written);
  frames_ = frames;
  return more;
}

}  // namespace ringdown::session
