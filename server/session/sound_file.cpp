#include "server/session/sound_file.h"

#include "engine/base/file_format.h"

#include <sndfile.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::session {
namespace {

constexpr std::size_t kMaxWavBytes = 0xffff'0000;  // limit for samples; a length has 32 bits and includes the header

tl::unexpected<Error> cannot_write(const std::filesystem::path& path, const std::string& why) {
  return fail(ErrorKind::input_output, "cannot write {}: {}", path.string(), why);
}

}  // namespace

// A stream gets the sound only when complete, from a file without a name, because libsndfile goes back to write
// lengths.
struct SoundFile::Open {
  OutputTarget target;
  std::filesystem::path temporary;
  std::FILE* nameless = nullptr;  // the file without a name, used for a stream
  SNDFILE* file = nullptr;
  std::size_t channels = 2;

  bool open(SF_INFO& info) {
    if (target.is_stream) {
      nameless = std::tmpfile();
      if (nameless) file = sf_open_fd(::fileno(nameless), SFM_WRITE, &info, SF_FALSE);
    } else {
      temporary = formatted("{}.{}.part", target.path.string(), ::getpid());
      file = sf_open(temporary.c_str(), SFM_WRITE, &info);
    }
    return file != nullptr;
  }

  // Copies the finished sound to the stream.
  [[nodiscard]] Result<void> copy() const {
    const auto stream = open_stream(target.path);
    if (!stream) return fail(stream);
    Result<void> outcome;
    std::vector<std::byte> piece(std::size_t{1} << 16);
    std::rewind(nameless);
    for (std::size_t count = 1; outcome && count > 0;) {
      count = std::fread(piece.data(), 1, piece.size(), nameless);
      outcome = write_stream(*stream, std::span(piece).first(count), target.named);
    }
    ::close(*stream);
    return outcome;
  }

  ~Open() {
    if (file) sf_close(file);
    if (nameless) std::fclose(nameless);
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
  }
};

SoundFile::SoundFile(std::unique_ptr<Open> open) : open_(std::move(open)) {}
SoundFile::SoundFile(SoundFile&&) noexcept = default;
SoundFile& SoundFile::operator=(SoundFile&&) noexcept = default;
SoundFile::~SoundFile() = default;

Result<SoundFile> SoundFile::create(OutputTarget target, double sample_rate_hz, const SoundFormat& format) {
  const std::filesystem::path path = target.named;
  const std::string ending = ending_of(path);
  if (ending != ".wav" && ending != ".flac" && !target.is_stream) {
    return cannot_write(path, "its name must end in .wav or .flac, which decides the format");
  }
  const std::size_t bytes = static_cast<std::size_t>(format.bits) / 8;
  const int wav = bytes * format.channels * format.frames > kMaxWavBytes ? SF_FORMAT_RF64 : SF_FORMAT_WAV;
  const int samples = format.bits == 24 ? SF_FORMAT_PCM_24 : SF_FORMAT_FLOAT;
  SF_INFO info{.samplerate = static_cast<int>(sample_rate_hz),
               .channels = static_cast<int>(format.channels),
               .format = ending == ".flac" ? SF_FORMAT_FLAC | SF_FORMAT_PCM_24 : wav | samples};
  auto open = std::make_unique<Open>();
  open->target = std::move(target);
  if (!open->open(info)) {
    const bool no_file = open->target.is_stream && !open->nameless;
    return cannot_write(path, no_file ? std::strerror(errno) : sf_strerror(nullptr));
  }
  open->channels = format.channels;
  if (!format.comment.empty()) sf_set_string(open->file, SF_STR_COMMENT, format.comment.c_str());
  sf_command(open->file, SFC_SET_CLIPPING, nullptr, SF_TRUE);
  // The PEAK chunk would contain the time of day, so no two files would be equal.
  sf_command(open->file, SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
  return SoundFile(std::move(open));
}

Result<void> SoundFile::write(std::span<const float> samples) {
  const auto frames = static_cast<sf_count_t>(samples.size() / open_->channels);
  if (sf_writef_float(open_->file, samples.data(), frames) == frames) return {};
  return cannot_write(open_->target.named, "the disk may be full");
}

Result<void> SoundFile::finish() {
  const std::filesystem::path& path = open_->target.named;
  if (sf_close(std::exchange(open_->file, nullptr)) != 0) return cannot_write(path, "the disk may be full");
  if (open_->nameless) return open_->copy();
  std::error_code error;
  std::filesystem::rename(open_->temporary, open_->target.path, error);
  if (error) return cannot_write(path, error.message());
  return {};
}

}  // namespace ringdown::session
