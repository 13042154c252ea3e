// The table of methods.
#include <algorithm>
#include <array>
#include <limits>

#include "baselines/clip_pca.h"
#include "baselines/clip_sets.h"
#include "baselines/marker_pca.h"
#include "baselines/method.h"
#include "baselines/pga_ik.h"
#include "baselines/rma.h"
#include "baselines/simple_methods.h"
#include "motion/error.h"

namespace nmc::baselines {
namespace {

constexpr const char* liu = "Liu, McMillan 2006";
constexpr const char* tojo = "Tojo, Chen, Umetani 2022";

const std::array methods{
    Method{"nmc", "gltf-nmc's default", "the tolerance", true, prepare_nmc, decode_sets},
    Method{"nmc-paper", tojo, "frequencies of each clip", true, prepare_nmc_paper, decode_sets},
    Method{"nmc-naive", tojo, "frequencies of each clip", true, prepare_nmc_naive, decode_sets},
    Method{"svd", tojo, "rank of each clip", true, prepare_svd, decode_svd},
    Method{"pca", liu, "what the model of all poses leaves out", false, prepare_pca, decode_marker_pca},
    Method{"pca-piecewise", liu, "what each segment's model leaves out", false, prepare_pca_piecewise,
           decode_marker_pca},
    Method{"pca-segment", liu, "what models and key frames leave out", false, prepare_pca_segment, decode_marker_pca},
    Method{"clip-pca", "Arikan 2006, as Lin et al. 2011 give it", "length of clips, what their models leave out", false,
           prepare_clip_pca, decode_clip_pca},
    Method{"rma", "Lin, Peng, Lin, Tsai 2011", "what axes, splines and rounding leave out", false, prepare_rma,
           decode_rma},
    Method{"pga-ik", "Tournier et al. 2009, as Lin et al. 2011 give it", "what axes and splines leave out", false,
           prepare_pga_ik, decode_pga_ik},
    Method{"dct", "a plain transform", "step of each clip", true, prepare_dct, decode_sets},
    Method{"draco", "Draco's keyframe animation", "bits of each clip", true, prepare_draco, decode_draco},
    Method{"meshopt", "EXT_meshopt_compression", "bits and key rate of each clip", true, prepare_meshopt,
           decode_meshopt},
};

}  // namespace

std::span<const Method> all_methods() { return methods; }

const Method* find_method(std::string_view name) {
  const auto found = std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.name == name; });
  return found == methods.end() ? nullptr : &*found;
}

double largest_error(const codec::Source& source, const motion::ErrorMeter& meter, std::size_t clip,
                     const motion::Clip& decoded) {
  const codec::ClipSource& from = source.clips[clip];
  double worst = 0;
  for (const double error : meter.profile(from.original, codec::with_kept(from, decoded)).max_error) {
    if (!(error <= std::numeric_limits<double>::max())) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, error);
  }
  return worst;
}

}  // namespace nmc::baselines
