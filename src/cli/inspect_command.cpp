// gltf-nmc inspect: what is inside a compressed file.
#include <memory>

#include "cli/command.h"
#include "cli/files.h"
#include "cli/terminal.h"
#include "report/inspect_report.h"

namespace nmc::cli {
namespace {

struct Arguments {
  std::string file;
  bool json = false;
  bool allow_external = false;
};

int run(const Arguments& a) {
  const gltf::Document document = gltf::read_document(a.file, {.allow_external = a.allow_external});
  const std::vector<codec::InspectedSet> sets = codec::inspect(document);
  report::InspectContext context;
  context.version = version;
  context.file = a.file;
  context.file_bytes = bytes_on_disk(a.file, document);
  context.animation_names = animation_names(document);
  context.kept = codec::inspect_kept(document);
  print(a.json ? json_text(report::inspect_json(sets, context)) : coloured(report::inspect_text(sets, context)));
  return 0;
}

}  // namespace

Run inspect_command(CLI::App& app) {
  const auto a = std::make_shared<Arguments>();
  app.add_option("FILE", a->file, "the file to look into: .glb or .gltf")->required();
  app.add_flag("--allow-external", a->allow_external, "let URIs in FILE leave its folder (default refused)")
      ->group("File");
  app.add_flag("--json", a->json, "as JSON instead of tables")->group("Output");
  return [=] { return run(*a); };
}

}  // namespace nmc::cli
