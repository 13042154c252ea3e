#include "rate_dct.h"

#include <fmt/format.h>

#include <chrono>

#include "baselines/dct.h"
#include "codec/source.h"
#include "gltf/edit.h"
#include "rate_codec.h"
#include "rate_process.h"
#include "rate_reference.h"

namespace nmc::bench {
using namespace nmc::codec;

Measurement measure_dct(const std::filesystem::path& path, const CompressOptions& options) {
  gltf::Document document = gltf::read_document(path);
  const auto start = std::chrono::steady_clock::now();
  const Source source = read_source(document, options);
  const gltf::CompressionEdit edit = compression_edit(source, baselines::encode_dct(source, options.threads));
  gltf::apply_compression(document, edit);
  Measurement row;
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  row.peak_bytes = peak_resident_bytes();
  row.method = "DCT, one step a clip";
  row.reached = true;
  if (const std::size_t missed = source.clips.size() - edit.taken.size())
    row.note = fmt::format("not reached on {} of {} clips, which stay as keys", missed, source.clips.size());
  measure_result(Reference(path), document, row);
  return row;
}

}  // namespace nmc::bench
