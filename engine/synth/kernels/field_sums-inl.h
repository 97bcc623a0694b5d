#include <hwy/highway.h>

#include "engine/synth/kernels/field_sums.h"

#include "engine/synth/kernels/moment_vectors-inl.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

// From objects to a field
//
// Objects wait until there are kBatch of them; then add_objects_here() adds them to the field as a product of matrices:
// a vector holds one number of all channels, so an object's gains are vectors, and each of its numbers is multiplied by
// its gain vector.
//
// At the end, fill_lines_here() turns the lines into the spectra of eight sequences, each for two channels, of which
// one becomes the real part and the other the imaginary part. As lines of a real signal, they also appear at the
// mirrored frequency, conjugated. ChunkTransform transforms all sequences at once. Because lines lie between the
// frequencies of the transform, write_frames_here() rotates each frame by half a line's phase, and multiplies it by
// psi. Gains that move have a second set of lines, whose frames are multiplied by t.
HWY_BEFORE_NAMESPACE();
namespace ringdown::synth::HWY_NAMESPACE {

constexpr std::size_t kFieldWidth = kMaxAmbisonicChannels;
using FieldVector = Numbers<kFieldWidth>;
constexpr std::size_t kFieldHalf = kFieldWidth / 2;
using FieldPairs = Numbers<kFieldHalf>;

void add_objects_here(const float* objects, const float* gains, std::size_t count, float* field) {
  constexpr std::size_t kRows = 8;
  for (std::size_t i = 0; i < kGridNumbers; i += kRows, field += kRows * kFieldWidth) {
    FieldVector sum[kRows];
    RINGDOWN_UNROLL
    for (std::size_t r = 0; r < kRows; ++r) sum[r] = FieldVector::load(field + r * kFieldWidth);
    for (std::size_t o = 0; o < count; ++o) {
      const FieldVector gain = FieldVector::load(gains + o * kFieldWidth);
      const float* const numbers = objects + o * kGridNumbers + i;
      RINGDOWN_UNROLL
      for (std::size_t r = 0; r < kRows; ++r) sum[r] = multiply_add(FieldVector::all(numbers[r]), gain, sum[r]);
    }
    RINGDOWN_UNROLL
    for (std::size_t r = 0; r < kRows; ++r) sum[r].store(field + r * kFieldWidth);
  }
}

void add_lines_here(const float* lines, float gain, float* to) {
  for (std::size_t i = 0; i < kGridNumbers; i += 2 * kGridReach) {
    multiply_add(Pair::all(gain), Pair::load(lines + i), Pair::load(to + i)).store(to + i);
  }
}

void fill_lines_here(const float* bundle, float* re, float* im) {
  constexpr std::size_t kPoints = ChunkTransform::kPoints, kEdge = kGridReach / 2;
  const FieldPairs half = FieldPairs::all(0.5f);
  const auto add = [](FieldPairs what, float* to, bool first)
                       HWY_ATTR { (first ? what : FieldPairs::load(to) + what).store(to); };
  const auto put = [&](std::size_t line, bool first) HWY_ATTR {
    const float* const real = bundle + (line / kGridReach * 2 * kGridReach + line % kGridReach) * kFieldWidth;
    const float* const imaginary = real + kGridReach * kFieldWidth;
    const FieldPairs lr = FieldPairs::load(real), rr = FieldPairs::load(real + kFieldHalf);
    const FieldPairs li = FieldPairs::load(imaginary), ri = FieldPairs::load(imaginary + kFieldHalf);
    const std::size_t point = (line + kPoints - kEdge) % kPoints, mirrored = kPoints - 1 - point;
    add(half * (lr - ri), re + point * kFieldHalf, first);
    add(half * (li + rr), im + point * kFieldHalf, first);
    add(half * (lr + ri), re + mirrored * kFieldHalf, first);
    add(half * (rr - li), im + mirrored * kFieldHalf, first);
  };
  for (std::size_t line = kEdge; line < kEdge + kPoints / 2; ++line) put(line, true);
  for (std::size_t line = 0; line < kEdge; ++line) put(line, false);
  for (std::size_t line = kEdge + kPoints / 2; line < kGridLines; ++line) put(line, false);
}

// `turns` are the factors of frames: kChunkFrames real parts, then imaginary parts.
void write_frames_here(const float* re, const float* im, const std::uint16_t* place, const float* turns, bool first,
                       float* samples, std::size_t frames) {
  for (std::size_t j = 0; j < frames; ++j, samples += kFieldWidth) {
    const FieldPairs r = FieldPairs::load(re + place[j] * kFieldHalf), i = FieldPairs::load(im + place[j] * kFieldHalf);
    const FieldPairs turn_re = FieldPairs::all(turns[j]), turn_im = FieldPairs::all(turns[kChunkFrames + j]);
    const FieldPairs left = subtract_product(i, turn_im, r * turn_re), right = multiply_add(r, turn_im, i * turn_re);
    (first ? left : left + FieldPairs::load(samples)).store(samples);
    (first ? right : right + FieldPairs::load(samples + kFieldHalf)).store(samples + kFieldHalf);
  }
}

}  // namespace ringdown::synth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ringdown::synth {

HWY_EXPORT(add_objects_here);
HWY_EXPORT(add_lines_here);
HWY_EXPORT(fill_lines_here);
HWY_EXPORT(write_frames_here);

FieldSums::FieldSums() : spread_{}, grid_{nullptr, spread_.data()}, waiting_{}, field_{}, others_{}, turns_{} {
  const FrequencyGrid& grid = frequency_grid();
  for (std::size_t p = 0; p < kMoments; ++p) {
    for (std::size_t n = 0; n < kGridReach; ++n) {
      const std::complex<double> share = grid.spread[p][n];
      float* const by_re = spread_.data() + p * 4 * kGridReach;
      float* const by_im = by_re + 2 * kGridReach;
      by_re[n] = static_cast<float>(share.real());
      by_re[kGridReach + n] = static_cast<float>(share.imag());
      by_im[n] = -by_re[kGridReach + n];
      by_im[kGridReach + n] = by_re[n];
    }
  }
  for (std::size_t j = 0; j < kChunkFrames; ++j) {
    const auto frame = static_cast<double>(j);
    const std::complex<double> turn =
        std::polar(grid.psi[j], std::numbers::pi * frame / static_cast<double>(ChunkTransform::kPoints));
    const double t = (frame - kMomentMiddle) / kMomentScale;
    for (const Part part : {middle, slope}) {
      turns_[part][j] = static_cast<float>((part == slope ? t : 1) * turn.real());
      turns_[part][kChunkFrames + j] = static_cast<float>((part == slope ? t : 1) * turn.imag());
    }
  }
}

void FieldSums::open() REALTIME {
  waiting_.count = 0;
  waiting_.slopes = false;
  in_field_ = {};
  in_others_ = {};
  field_channels_ = other_channels_ = 0;
}

MomentTarget FieldSums::begin_object() REALTIME {
  Lines& lines = waiting_.objects[waiting_.count];
  lines.fill(0);
  grid_.lines = lines.data();
  return {.grid = &grid_};
}

void FieldSums::add_to(std::size_t channel, const GainLine& gain) REALTIME {
  add_lines(waiting_.objects[waiting_.count], gain.middle, channel, middle);
  if (gain.slope != 0) add_lines(waiting_.objects[waiting_.count], gain.slope, channel, slope);
}

void FieldSums::end_object(const FieldGains& gains, ChannelSet wanted) REALTIME {
  waiting_.gains[middle][waiting_.count] = gains.middle;
  waiting_.gains[slope][waiting_.count] = gains.slope;
  waiting_.slopes = waiting_.slopes || gains.moves;
  field_channels_ |= wanted & kAllAmbisonic;
  if (++waiting_.count < kBatch) return;
  add_waiting(waiting_);
  waiting_.count = 0;
  waiting_.slopes = false;
}

void FieldSums::add(const FieldSums& other) REALTIME {
  add_waiting(other.waiting_);
  field_channels_ |= other.field_channels_;
  for (const Part part : {middle, slope}) {
    if (other.in_field_[part]) {
      float* const field = part_of_field(part);
      for (std::size_t i = 0; i < field_[part].size(); ++i) field[i] += other.field_[part][i];
    }
    for (ChannelSet rest = other.in_others_[part]; rest != 0; rest &= rest - 1) {
      const auto channel = static_cast<std::size_t>(std::countr_zero(rest));
      add_lines(other.others_[channel][part], 1, channel, part);
    }
  }
}

float* FieldSums::part_of_field(Part part) REALTIME {
  if (!in_field_[part]) field_[part].fill(0);
  in_field_[part] = true;
  return field_[part].data();
}

// Synthesises the ambisonic channels first, then the others in bundles of up to kWidth.
void FieldSums::close(const std::array<double*, kMaxChannels>& out, std::size_t frames) REALTIME {
  add_waiting(waiting_);
  std::array<double*, kWidth> to;
  std::copy_n(out.data() + kFirstAmbisonic, kWidth, to.data());
  synthesize(to, frames);
  for (ChannelSet rest = other_channels_; rest != 0;) {
    in_field_ = {};
    to.fill(nullptr);
    for (std::size_t place = 0; place < kWidth && rest != 0; ++place, rest &= rest - 1) {
      const auto channel = static_cast<std::size_t>(std::countr_zero(rest));
      to[place] = out[channel];
      for (const Part part : {middle, slope}) {
        if (!contains(in_others_[part], channel)) continue;
        float* const bundle = part_of_field(part);
        for (std::size_t i = 0; i < kGridNumbers; ++i) bundle[i * kWidth + place] = others_[channel][part][i];
      }
    }
    synthesize(to, frames);
  }
}

// Highway's dispatch reads an atomic, and indexes a table of functions, all of them in this file.
TRUST_REALTIME_BEGIN
void FieldSums::add_waiting(const Waiting& waiting) REALTIME {
  if (waiting.count == 0) return;
  for (const Part part : {middle, slope}) {
    if (part == slope && !waiting.slopes) continue;
    HWY_DYNAMIC_DISPATCH(add_objects_here)
    (waiting.objects[0].data(), waiting.gains[part][0].data(), waiting.count, part_of_field(part));
  }
}

void FieldSums::add_lines(const Lines& lines, float gain, std::size_t channel, Part part) REALTIME {
  Lines& to = others_[channel][part];
  if (!contains(in_others_[part], channel)) to.fill(0);
  in_others_[part] |= only(channel);
  other_channels_ |= only(channel);
  HWY_DYNAMIC_DISPATCH(add_lines_here)(lines.data(), gain, to.data());
}

void FieldSums::synthesize(const std::array<double*, kWidth>& out, std::size_t frames) REALTIME {
  bool first = true;
  for (const Part part : {middle, slope}) {
    if (!in_field_[part]) continue;
    HWY_DYNAMIC_DISPATCH(fill_lines_here)(field_[part].data(), re_.data(), im_.data());
    transform_.run(re_.data(), im_.data(), frames);
    HWY_DYNAMIC_DISPATCH(write_frames_here)
    (re_.data(), im_.data(), transform_.places(), turns_[part].data(), first, samples_.data(), frames);
    first = false;
  }
  for (std::size_t c = 0; c < kWidth && !first; ++c) {
    if (!out[c]) continue;
    for (std::size_t j = 0; j < frames; ++j) out[c][j] += static_cast<double>(samples_[j * kWidth + c]);
  }
}
TRUST_REALTIME_END

}  // namespace ringdown::synth
#endif
