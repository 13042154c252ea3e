// Lin, Peng, Lin and Tsai 2011: tables 1 to 4.
#include <fmt/format.h>

#include <functional>
#include <optional>

#include "baselines/clip_pca.h"
#include "baselines/pga_ik.h"
#include "baselines/rma.h"
#include "comparison_measures.h"

namespace nmc::bench {
namespace {

using baselines::Bytes;

/// One row: sums over files, weighted by their frames.
struct Row {
  double frames = 0, raw = 0, bytes = 0, error = 0, encode = 0, decode = 0;
  double axes = 0, primary_bits = 0, repeated_bits = 0, primary = 0, unique = 0, repeated = 0;

  std::string measures() const {
    return fmt::format("{:.2f} | {:.1f} | {:.0f} | {:.0f}", error / frames, raw / bytes, frames / encode,
                       frames / decode);
  }
};

/// The paper's settings where it gives them; the curves' threshold of 15 mm is ours.
baselines::RmaSettings rma_settings(double covered) {
  baselines::RmaSettings settings;
  settings.covered = covered;
  settings.curve = 0.015;
  settings.expected_primary = 0.005;
  settings.expected_repeated = 0.006;
  settings.root = 0.005;
  settings.contact_step = 0.025 / 8;
  return settings;
}

void judge(const codec::Source& source, const Bytes& bytes, double encode_seconds,
           std::vector<motion::Clip> (*decode)(std::span<const std::uint8_t>, const motion::Skeleton&), Row& row) {
  const double start = thread_seconds();
  const std::vector<motion::Clip> decoded = decode(bytes, source.skeleton);
  const auto frames = static_cast<double>(frame_count(source));
  row.decode += thread_seconds() - start;
  row.encode += encode_seconds;
  row.frames += frames;
  row.raw += static_cast<double>(raw_joint_bytes(source));
  row.bytes += static_cast<double>(bytes.size());
  row.error += frames * measure_as_papers(source, decoded).mean_joint_cm;
}

void add_rma(const codec::Source& source, const baselines::RmaEncoder& encoder, double prepare,
             const baselines::RmaSettings& settings, Row& row) {
  baselines::RmaCounts counts;
  const double start = thread_seconds();
  const Bytes bytes = encoder.encode(settings, &counts);
  judge(source, bytes, prepare + thread_seconds() - start, baselines::decode_rma, row);
  const auto frames = static_cast<double>(frame_count(source));
  row.axes += frames * counts.mean_axes;
  row.primary_bits += frames * counts.primary_bits;
  row.repeated_bits += frames * counts.repeated_bits;
  row.primary += frames * counts.primary_share;
  row.unique += frames * counts.unique_share;
  row.repeated += frames * counts.repeated_share;
}

void add_clip_pca(const codec::Source& source, Eigen::Index clip_frames, double covered, Row& row) {
  const double start = thread_seconds();
  const baselines::ClipPcaEncoder encoder(source);
  baselines::ClipPcaCounts counts;
  const Bytes bytes = encoder.encode({clip_frames, covered, 0, 0.005, 0.025 / 8}, &counts);
  judge(source, bytes, thread_seconds() - start, baselines::decode_clip_pca, row);
  row.axes += static_cast<double>(frame_count(source)) * counts.mean_axes;
}

void print_rma(const char* name, const char* variance, const Row& row) {
  fmt::print("| {} | {} | {} | {:.2f} | {:.2f} / {:.2f} | {:.0f}% / {:.0f}% / {:.0f}% |\n", name, variance,
             row.measures(), row.axes / row.frames, row.primary_bits / row.frames, row.repeated_bits / row.frames,
             100 * row.primary / row.frames, 100 * row.unique / row.frames, 100 * row.repeated / row.frames);
}

/// A table of RMA at 98 and 95 % beside clip PCA, and RMA's kinds of quantisation.
void print_tables(const std::vector<std::filesystem::path>& files, const char* title, Eigen::Index clip_frames) {
  struct Kind {
    const char* name;
    int primary, repeated;
  };
  constexpr Kind kinds[] = {{"uniform (16/16)", 16, 16}, {"uniform (9/7)", 9, 7}, {"adaptive", 0, 0}};
  constexpr double shares[] = {0.98, 0.95};
  Row rows[2][3], clip_pca, clip_pca_more;
  for (const std::filesystem::path& path : files) {
    const auto source = read_motion(path);
    const double start = thread_seconds();
    const baselines::RmaEncoder encoder(*source);
    const double prepare = thread_seconds() - start;
    for (int s = 0; s < 2; ++s)
      for (int k = 0; k < 3; ++k) {
        baselines::RmaSettings settings = rma_settings(shares[s]);
        settings.uniform_primary = kinds[k].primary;
        settings.uniform_repeated = kinds[k].repeated;
        add_rma(*source, encoder, prepare, settings, rows[s][k]);
      }
    add_clip_pca(*source, clip_frames, 0.95, clip_pca);
    add_clip_pca(*source, clip_frames, 0.98, clip_pca_more);
  }
  fmt::print(
      "\n{} ({} frames, ratio to {:.2f} MB)\n\n"
      "| method | variance | joint error, cm | ratio | encoding fps | decoding fps | axes | bits | clips "
      "(pri/uni/rep) |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
      title, rows[0][0].frames, rows[0][0].raw / 1e6);
  print_rma("rma", "98%", rows[0][2]);
  print_rma("rma", "95%", rows[1][2]);
  fmt::print("| clip-pca | 98% | {} | {:.2f} | 16 | |\n", clip_pca_more.measures(),
             clip_pca_more.axes / clip_pca_more.frames);
  fmt::print("| clip-pca | 95% | {} | {:.2f} | 16 | |\n", clip_pca.measures(), clip_pca.axes / clip_pca.frames);
  fmt::print(
      "\nQuantisation (table 4) on the same files\n\n| bits | variance | joint error, cm | ratio |\n| --- | ---: | "
      "---: | ---: |\n");
  for (int s = 0; s < 2; ++s)
    for (int k = 0; k < 3; ++k)
      fmt::print("| {} | {:.0f}% | {:.3f} | {:.1f} |\n", kinds[k].name, 100 * shares[s],
                 rows[s][k].error / rows[s][k].frames, rows[s][k].raw / rows[s][k].bytes);
  std::fflush(stdout);
}

void print_table_3(const std::filesystem::path& path, Eigen::Index clip_frames) {
  const auto source = read_motion(path);
  Row rma, clip_pca, pga;
  const double start = thread_seconds();
  const baselines::RmaEncoder encoder(*source);
  add_rma(*source, encoder, thread_seconds() - start, rma_settings(0.95), rma);
  add_clip_pca(*source, clip_frames, 0.95, clip_pca);
  const double before = thread_seconds();
  baselines::PgaSettings settings;
  settings.covered = 0.95;
  settings.way = 0.01;
  settings.expected = 0.0025;
  const Bytes bytes = baselines::PgaEncoder(*source).encode(settings);
  judge(*source, bytes, thread_seconds() - before, baselines::decode_pga_ik, pga);
  for (const auto& [name, row] : {std::pair("rma", &rma), std::pair("clip-pca", &clip_pca), std::pair("pga-ik", &pga)})
    fmt::print("| {} | {} | {} | {} |\n", path.stem().string(), frame_count(*source), name, row->measures());
  std::fflush(stdout);
}

}  // namespace

void print_lin(const std::vector<std::filesystem::path>& files_120_hz,
               const std::vector<std::filesystem::path>& files_30_hz) {
  fmt::print("\n## Lin, Peng, Lin, Tsai 2011\n");
  if (!files_120_hz.empty()) print_tables(files_120_hz, "Table 1: 120 Hz", 24);
  if (!files_30_hz.empty()) print_tables(files_30_hz, "Table 2: 30 Hz", 16);
  fmt::print(
      "\nTable 3: single sequences\n\n| sequence | frames | method | joint error, cm | ratio | encoding fps | decoding "
      "fps |\n| --- | ---: | --- | ---: | ---: | ---: | ---: |\n");
  for (const std::filesystem::path& path : files_120_hz) print_table_3(path, 24);
  for (const std::filesystem::path& path : files_30_hz) print_table_3(path, 16);
}

}  // namespace nmc::bench
