// gltf-nmc verify: the error of a file against the original, measured anew.
#include <memory>

#include "base/error.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/report_file.h"
#include "cli/settings.h"
#include "cli/terminal.h"
#include "report/verify_report.h"

namespace nmc::cli {
namespace {

struct Arguments {
  std::string original;
  std::string file;
  bool joints_alone = false;
  std::string report;
  bool json = false;
  bool allow_external = false;
};

int run(const Arguments& a, const SettingsArguments& given) {
  check_report(a.report, {a.original, a.file});
  const Settings settings = read_settings(given);
  const gltf::ReadOptions read_options{.allow_external = a.allow_external};
  const gltf::Document original = gltf::read_document(a.original, read_options);
  const gltf::Document other = gltf::read_document(a.file, read_options);
  const codec::Verification result =
      codec::verify(original, other, settings.tolerance.value_or(codec::Tolerance{}), settings.rules);

  report::VerifyContext context;
  context.version = version;
  context.original = a.original;
  context.other = a.file;
  context.has_exceptions = !settings.rules.empty();
  context.joints_alone = a.joints_alone;
  context.node_names = node_names(original);
  if (!a.report.empty()) {
    write_report(a.report, report::verify_json(result, context),
                 codec::compare(original, other, bytes_on_disk(a.original, original), bytes_on_disk(a.file, other)));
  }
  print(a.json ? json_text(report::verify_json(result, context)) : coloured(report::verify_text(result, context)));
  return report::holds(result, context) ? 0 : static_cast<int>(ErrorCode::tolerance_not_kept);
}

}  // namespace

Run verify_command(CLI::App& app) {
  const auto a = std::make_shared<Arguments>();
  app.add_option("ORIGINAL", a->original, "the file before compression")->required();
  app.add_option("FILE", a->file, "the compressed or decoded file")->required();
  const auto settings = add_tolerances(app);
  app.add_flag("--joints", a->joints_alone,
               "hold skin joints alone to the tolerance, as profile paper does\n(default joints and skin)")
      ->group("Error bound");
  app.add_flag("--allow-external", a->allow_external, "let URIs leave the files' folders (default refused)")
      ->group("File");
  app.add_option("--report", a->report, "write a page for the browser with player, errors and\nnumbers (default none)")
      ->type_name("FILE.html")
      ->group("Output");
  app.add_flag("--json", a->json, "as JSON instead of a table")->group("Output");
  return [=] { return run(*a, *settings); };
}

}  // namespace nmc::cli
