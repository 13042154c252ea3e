// gltf-nmc's own default, and the paper's network with adaptive and with consecutive frequencies.
#include "base/parallel.h"
#include "baselines/clip_sets.h"
#include "codec/decoded_set.h"
#include "codec/paper_profile.h"
#include "codec/standard_profile.h"
#include "codec/standard_sets.h"
#include "motion/error.h"

namespace nmc::baselines {
namespace {

using codec::EncodedSet;
using codec::Source;

/// The default profile on all clips; those that it would leave as they are, since they miss the bound, are coded at its
/// finest steps.
class NmcEncoder : public Encoder {
 public:
  NmcEncoder(const Source& source, const EncodeSettings& settings) : source_(source), settings_(settings) {}

  Bytes encode(double knob) override {
    const Source source = codec::with_tolerance(source_, knob * source_.size);
    codec::CompressOptions options;
    options.tolerance = {source.tolerance, codec::Tolerance::Unit::world_units};
    options.effort = settings_.effort;
    options.threads = settings_.threads;
    std::vector<codec::ClipResult> results = source.results;
    const motion::ErrorMeter meter(source.skeleton, source.all_points);
    const auto judge = [&](const EncodedSet& set, std::vector<codec::ClipResult>& into) {
      judge_by_error(source, meter, set, into);
    };
    std::vector<EncodedSet> sets = codec::encode_standard_sets(source, options, judge, results);
    if (const std::vector<std::size_t> missed = without_set(source, sets); !missed.empty())
      sets.push_back(
          codec::StandardEncoder(source, options, missed, codec::StandardEncoder::finest_precision).encode(missed));
    return write_sets(sets, source.clips.size());
  }

 private:
  static void judge_by_error(const Source& source, const motion::ErrorMeter& meter, const EncodedSet& set,
                             std::vector<codec::ClipResult>& results) {
    const codec::DecodedSet decoded(set.stream, "the new clip set");
    const std::vector<int> nodes = nodes_of(set);
    for (std::size_t i = 0; i < set.clips.size(); ++i) {
      const double error = largest_error(source, meter, set.clips[i], decoded.clip(i, nodes));
      results[static_cast<std::size_t>(source.clips[set.clips[i]].animation)].outcome =
          error <= source.tolerance ? codec::Outcome::compressed : codec::Outcome::kept_over_tolerance;
    }
  }

  static std::vector<std::size_t> without_set(const Source& source, const std::vector<EncodedSet>& sets) {
    std::vector<bool> has_set(source.clips.size(), false);
    for (const EncodedSet& set : sets)
      for (const std::size_t clip : set.clips) has_set[clip] = true;
    std::vector<std::size_t> missed;
    for (std::size_t i = 0; i < has_set.size(); ++i)
      if (!has_set[i]) missed.push_back(i);
    return missed;
  }

  const Source& source_;
  EncodeSettings settings_;
};

/// Algorithm 1 on each clip, every network on its way kept: of those within the bound the one with the fewest
/// frequencies is taken, as the algorithm would have stopped there.
class PaperEncoder : public Encoder {
 public:
  PaperEncoder(const Source& source, const EncodeSettings& settings, network::FrequencyChoice choice)
      : source_(source), threads_(settings.threads), choice_(choice) {}

  Bytes encode(double knob) override {
    if (ways_.empty()) train();
    std::vector<EncodedSet> sets;
    for (const Way& way : ways_) {
      std::size_t best = 0;
      for (std::size_t k = 0; k < way.sets.size(); ++k) {
        if (way.errors[k] < way.errors[best]) best = k;
        if (way.errors[k] <= knob * source_.size) {
          best = k;
          break;
        }
      }
      sets.push_back(way.sets[best]);
    }
    return write_sets(sets, source_.clips.size());
  }

 private:
  /// The networks of one clip by number of frequencies.
  struct Way {
    std::vector<EncodedSet> sets;
    std::vector<double> errors;  ///< at joints and skin, world units
  };

  void train() {
    ways_.resize(source_.clips.size());
    const Source strict = codec::with_tolerance(source_, 0);  // no network ends the search
    const motion::ErrorMeter meter(source_.skeleton, source_.all_points);
    parallel_for(ways_.size(), threads_, [&](std::size_t i) {
      codec::CompressOptions options;
      options.max_frequencies = codec::most_paper_frequencies(source_, i);
      codec::encode_paper(strict, i, options, choice_, [&](EncodedSet set) {
        const codec::DecodedSet decoded(set.stream, "the new network");
        ways_[i].errors.push_back(largest_error(source_, meter, i, decoded.clip(0, nodes_of(set))));
        ways_[i].sets.push_back(std::move(set));
      });
    });
  }

  const Source& source_;
  int threads_;
  network::FrequencyChoice choice_;
  std::vector<Way> ways_;
};

}  // namespace

std::unique_ptr<Encoder> prepare_nmc(const Source& source, const EncodeSettings& settings) {
  return std::make_unique<NmcEncoder>(source, settings);
}

std::unique_ptr<Encoder> prepare_nmc_paper(const Source& source, const EncodeSettings& settings) {
  return std::make_unique<PaperEncoder>(source, settings, network::FrequencyChoice::adaptive);
}

std::unique_ptr<Encoder> prepare_nmc_naive(const Source& source, const EncodeSettings& settings) {
  return std::make_unique<PaperEncoder>(source, settings, network::FrequencyChoice::consecutive);
}

}  // namespace nmc::baselines
