#include "host_tools/lib/spectrum/fractional_filter.hpp"

#include <algorithm>
#include <bit>
#include <complex>

#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::spectrum {
namespace {

using Complex = std::complex<double>;
using Spectrum = std::vector<Complex>;

constexpr std::size_t kLargestPartition = std::size_t{1} << 16U;

void add_product(const Spectrum& a, const Spectrum& b, Spectrum& sum) {
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += product(a[k], b[k]);
}

/// Overlap-save: input segments and filter partitions are transformed at twice the partition's
/// length; the second half of their circular convolution is the linear one.
class Partitions {
 public:
  Partitions(std::size_t partition, std::size_t history, const BlockSource& input)
      : partition_(partition),
        first_input_(-static_cast<std::ptrdiff_t>(history)),
        input_(input),
        fft_(2 * partition),
        buffer_(2 * partition) {}

  /// Spectrum of the samples of blocks index - 1 and index, zero before the first input sample.
  Spectrum segment(std::ptrdiff_t index) {
    const auto size = static_cast<std::ptrdiff_t>(partition_);
    const std::ptrdiff_t first = (index - 1) * size;
    const std::ptrdiff_t zeros = std::clamp(first_input_ - first, std::ptrdiff_t{0}, 2 * size);
    const auto split = std::span(buffer_).subspan(static_cast<std::size_t>(zeros));
    std::fill(buffer_.begin(), buffer_.begin() + zeros, 0.0);
    input_(first + zeros, split);
    return transform();
  }

  Spectrum filter(FractionalWeights& weights) {
    const auto middle = buffer_.begin() + static_cast<std::ptrdiff_t>(partition_);
    std::generate(buffer_.begin(), middle, [&] { return weights.next(); });
    std::fill(middle, buffer_.end(), 0.0);
    return transform();
  }

  /// The valid half of the inverse transform, as much of it as the output has room for.
  void write(const Spectrum& bins, std::span<double> output) {
    fft_.inverse(bins, buffer_);
    std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(partition_), output.size(),
                output.begin());
  }

 private:
  Spectrum transform() {
    Spectrum bins(fft_.bins());
    fft_.forward(buffer_, bins);
    return bins;
  }

  std::size_t partition_;
  std::ptrdiff_t first_input_;
  const BlockSource& input_;
  RealFft fft_;
  std::vector<double> buffer_;
};

}  // namespace

void integrate_fractionally(double order, const BlockSource& input, std::size_t history,
                            std::span<double> output) {
  if (output.empty()) return;
  const std::size_t partition = std::min(std::bit_ceil(output.size()), kLargestPartition);
  const std::size_t blocks = (output.size() + partition - 1) / partition;
  const std::size_t past_blocks = (history + partition - 1) / partition;
  Partitions partitions(partition, history, input);

  // segments[k] is the input that lag block `lag` brings to output block k.
  std::vector<Spectrum> segments(blocks);
  for (std::size_t k = 0; k < blocks; ++k) {
    segments[k] = partitions.segment(static_cast<std::ptrdiff_t>(k));
  }
  std::vector<Spectrum> sums(blocks, Spectrum(partition + 1));
  FractionalWeights weights(order);
  for (std::size_t lag = 0; lag < blocks + past_blocks; ++lag) {
    const Spectrum filter = partitions.filter(weights);
    for (std::size_t k = 0; k < blocks; ++k) {
      if (!segments[k].empty()) add_product(filter, segments[k], sums[k]);
    }
    std::rotate(segments.begin(), segments.end() - 1, segments.end());
    segments[0] =
        lag < past_blocks ? partitions.segment(-static_cast<std::ptrdiff_t>(lag) - 1) : Spectrum{};
  }
  for (std::size_t k = 0; k < blocks; ++k) {
    const std::size_t first = k * partition;
    partitions.write(sums[k], output.subspan(first, std::min(partition, output.size() - first)));
  }
}

std::vector<double> difference_fractionally(double order, std::span<const double> values) {
  std::vector<double> result(values.size());
  const BlockSource source = [values](std::ptrdiff_t first, std::span<double> block) {
    const auto begin = std::min(static_cast<std::size_t>(first), values.size());
    const auto available = values.subspan(begin, std::min(block.size(), values.size() - begin));
    const auto end = std::copy(available.begin(), available.end(), block.begin());
    std::fill(end, block.end(), 0.0);
  };
  integrate_fractionally(-order, source, 0, result);
  return result;
}

}  // namespace zerorate::spectrum
