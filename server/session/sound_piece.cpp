#include "server/session/sound_piece.h"

#include "engine/base/output_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <utility>

namespace ringdown::session {
namespace {

using synth::Frame;

tl::unexpected<Error> no_room() {
  return fail(
      ErrorKind::input_output,
      std::string("cannot keep the sound in a temporary file until its loudness is known: ") + std::strerror(errno));
}

}  // namespace

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

void Cut::fade(RenderedBlock& block, Frame late) const {
  const auto shape = [](Frame done, Frame of) {
    const double share = std::clamp(static_cast<double>(done) / static_cast<double>(of), 0.0, 1.0);
    return static_cast<float>(0.5 - 0.5 * std::cos(std::numbers::pi * share));
  };
  const auto fade_channel = [&](std::vector<float>& samples, Frame delay) {
    const Frame risen = first + delay + rise, falls = end + delay - fall;
    for (Frame frame = block.begin; rise > 0 && frame < std::min(risen, block.end); ++frame)
      samples[static_cast<std::size_t>(frame - block.begin)] *= shape(frame - (risen - rise), rise);
    for (Frame frame = std::max(block.begin, falls); fall > 0 && frame < block.end; ++frame)
      samples[static_cast<std::size_t>(frame - block.begin)] *= shape(falls + fall - frame, fall);
  };
  fade_channel(block.left, late);
  fade_channel(block.right, late);
  for (std::vector<float>& channel : block.ambisonics) fade_channel(channel, 0);
}

Piece Cut::part(const RenderedBlock& block, Frame first, Frame end, Frame late) {
  const auto of = [&](const std::vector<float>& samples, Frame delay) {
    const Frame from = std::clamp(first + delay, block.begin, block.end);
    const Frame to = std::clamp(end + delay, from, block.end);
    return std::span(samples).subspan(static_cast<std::size_t>(from - block.begin),
                                      static_cast<std::size_t>(to - from));
  };
  Piece piece{of(block.left, late), of(block.right, late), {}};
  for (const std::vector<float>& channel : block.ambisonics) piece.ambisonics.push_back(of(channel, 0));
  return piece;
}

Result<PieceFile> PieceFile::create(const std::filesystem::path& path, double sample_rate_hz,
                                    const PieceFormat& format) {
  const auto target = output_target(path);
  if (!target) return fail(target);
  SoundFormat sound{.channels = format.channels, .frames = format.frames, .bits = format.bits};
  if (format.ambisonic) sound.comment = "AmbiX: channels in ACN order, SN3D";
  auto file = SoundFile::create(*target, sample_rate_hz, sound);
  if (!file) return fail(file);
  PieceFile made(std::move(*file), format.channels);
  if (format.scaled) {
    made.waiting_.reset(std::tmpfile());
    if (!made.waiting_) return no_room();
  }
  return made;
}

Result<void> PieceFile::take(const Piece& piece) {
  const auto channels = written_channels(piece);
  for (std::size_t n = 0; n < channels.front().size(); ++n) {
    for (const std::span<const float> channel : channels) samples_.push_back(channel[n]);
  }
  return samples_.size() < kKept ? Result<void>() : write();
}

Result<void> PieceFile::write() {
  if (waiting_) {
    if (std::fwrite(samples_.data(), sizeof(float), samples_.size(), waiting_.get()) != samples_.size())
      return no_room();
    samples_.clear();
    return {};
  }
  const auto written = file_.write(samples_);
  samples_.clear();
  return written;
}

Result<void> PieceFile::finish(float gain) {
  if (const auto written = write(); !written) return written;
  if (waiting_) {
    if (std::fseek(waiting_.get(), 0, SEEK_SET) != 0) return no_room();
    samples_.resize(kKept / channels_ * channels_);
    for (std::size_t count = 1; count > 0;) {
      count = std::fread(samples_.data(), sizeof(float), samples_.size(), waiting_.get());
      for (std::size_t n = 0; n < count; ++n) samples_[n] *= gain;
      if (const auto written = file_.write(std::span(samples_).first(count)); !written) return written;
    }
  }
  return file_.finish();
}

}  // namespace ringdown::session
