// Tojo, Chen and Umetani 2022: figures 2 and 3.
#include <fmt/format.h>

#include <algorithm>

#include "base/symmetric_eigen.h"
#include "baselines/pose_matrix.h"
#include "codec/decoded_set.h"
#include "codec/paper_profile.h"
#include "comparison_measures.h"

namespace nmc::bench {
namespace {

std::vector<codec::PaperStep> train(const codec::Source& source, int max_frequencies, network::FrequencyChoice choice,
                                    std::size_t& values) {
  codec::Source strict = source;
  strict.tolerance = 0;
  codec::CompressOptions options;
  options.max_frequencies = max_frequencies;
  const codec::PaperClip clip = codec::encode_paper(strict, 0, options, choice);
  values = clip.values;
  return clip.steps;
}

double ratio(std::size_t values, std::size_t parameters) {
  return static_cast<double>(values) / static_cast<double>(parameters);
}

void print_figure_3(const codec::Source& source, const std::string& name, int max_frequencies) {
  std::size_t values = 0;
  const auto adaptive = train(source, max_frequencies, network::FrequencyChoice::adaptive, values);
  const auto naive = train(source, max_frequencies, network::FrequencyChoice::consecutive, values);
  fmt::print(
      "\n{}: adaptive and naive frequencies by K, SVD by rank; ratio (numbers in Y over numbers stored) and largest "
      "joint error in % of size\n\n| K or rank | adaptive ratio | error | naive ratio | error | SVD ratio | error |\n"
      "| ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
      name);
  const baselines::MotionData data = baselines::motion_data(source);
  const baselines::PoseForms forms = baselines::pose_forms(source.skeleton, data.head, data.clips[0]);
  const Eigen::MatrixXd poses = baselines::to_pose_matrix(source.skeleton, data.head, forms, data.clips[0]);
  // The left singular vectors, the largest value first: projected on the first k, the matrix has its best rank k.
  const Eigen::MatrixXd left = symmetric_eigen(poses * poses.transpose()).vectors.rowwise().reverse();
  for (int k = 0; k <= max_frequencies; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const auto cell = [&](const std::vector<codec::PaperStep>& steps) {
      if (i >= steps.size()) return std::string(" | ");
      return fmt::format("{:.2f} | {:.2f}", ratio(values, steps[i].parameters),
                         100 * steps[i].joint_error / source.size);
    };
    const Eigen::Index rank = std::min<Eigen::Index>({k + 1, poses.rows(), poses.cols()});
    const Eigen::MatrixXd low = left.leftCols(rank) * (left.leftCols(rank).transpose() * poses);
    const motion::Clip clip =
        baselines::to_clip(data.head, 0, baselines::from_pose_matrix(source.skeleton, data.head, forms, low));
    fmt::print("| {} / {} | {} | {} | {:.2f} | {:.2f} |\n", k, rank, cell(adaptive), cell(naive),
               static_cast<double>(poses.size()) / static_cast<double>(rank * (poses.rows() + poses.cols())),
               100 * measure_as_papers(source, {clip}).max_joint_share);
    std::fflush(stdout);
  }
}

}  // namespace

void print_tojo(const std::vector<std::filesystem::path>& files, int max_frequencies) {
  fmt::print(
      "## Tojo, Chen, Umetani 2022\n\nFigure 2: Algorithm 1 to K = {} at most, stopped below 2 %\n\n"
      "| clip | frames | K | ratio | largest joint error, % of size |\n| --- | ---: | ---: | ---: | ---: |\n",
      max_frequencies);
  for (const std::filesystem::path& path : files) {
    const auto source = read_motion(path);
    codec::Source strict = *source;
    strict.tolerance = 0.02 * source->size;
    codec::CompressOptions options;
    options.max_frequencies = max_frequencies;
    const codec::PaperClip clip = codec::encode_paper(strict, 0, options);
    fmt::print("| {} | {} | {} | {:.2f} | {:.2f} |\n", path.stem().string(), frame_count(*source),
               clip.set.frequencies.front(), ratio(clip.values, clip.parameters),
               100 * clip.joint_error / source->size);
    std::fflush(stdout);
  }
  fmt::print("\nFigure 3\n");
  for (std::size_t i = 0; i < std::min<std::size_t>(2, files.size()); ++i)
    print_figure_3(*read_motion(files[i]), files[i].stem().string(), max_frequencies);
}

}  // namespace nmc::bench
