// gltf-nmc decode: a compressed file back to core glTF channels.
#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/files.h"
#include "codec/compress.h"
#include "report/format.h"

namespace nmc::cli {
namespace {

struct Arguments {
  std::string input;
  std::string output;
  bool quiet = false;
  bool allow_external = false;
};

int run(const Arguments& a) {
  check_output(a.output);
  const gltf::Document document = gltf::read_document(a.input, {.allow_external = a.allow_external});
  const std::size_t bytes_before = bytes_on_disk(a.input, document);
  const std::size_t decoded = gltf::read_compression(document).animations.size();
  const gltf::Document expanded = codec::expand(document);
  gltf::write_document(expanded, a.output);
  if (a.quiet) return 0;
  print(fmt::format("{} -> {}: {} of {} animations decoded, {} -> {} bytes\n", report::printable(a.input),
                    report::printable(a.output), decoded, animation_names(document).size(),
                    report::format_bytes(bytes_before), report::format_bytes(bytes_on_disk(a.output, expanded))));
  if (decoded == 0) print("note: the file has no compressed animations; it was written as it is\n");
  return 0;
}

}  // namespace

Run decode_command(CLI::App& app) {
  const auto a = std::make_shared<Arguments>();
  app.add_option("IN", a->input, "the compressed file: .glb or .gltf")->required();
  app.add_option("OUT", a->output, "the file to write: .glb, or .gltf with a .bin beside it; may be IN")->required();
  app.add_flag("--allow-external", a->allow_external, "let URIs in IN leave its folder (default refused)")
      ->group("File");
  app.add_flag("-q,--quiet", a->quiet, "print nothing but errors")->group("Output");
  return [=] { return run(*a); };
}

}  // namespace nmc::cli
