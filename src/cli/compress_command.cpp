// gltf-nmc compress: the default command.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "base/error.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/progress_line.h"
#include "cli/report_file.h"
#include "cli/tolerance.h"
#include "report/compress_report.h"

namespace nmc::cli {
namespace {

struct Arguments {
  std::string input;
  std::string output;
  std::string profile = "default";
  std::string tolerance = "0.1%";
  int max_frequencies = 40;
  int effort = 5;
  double contact_weight = 3;
  double time_limit_seconds = 0;
  int threads = 0;
  bool optional = false;
  bool fallback = false;
  std::vector<std::string> exclude;
  std::string report;
  bool json = false;
  bool quiet = false;
  bool allow_external = false;
  // whether the user named them
  bool has_max_frequencies = false;
  bool has_effort = false;
  bool has_contact_weight = false;
};

void refuse_contradictions(const Arguments& a) {
  const auto refuse = [](const char* sentence) { throw Error(ErrorCode::usage, sentence); };
  const bool paper = a.profile == "paper";
  if (a.optional && a.fallback) refuse("--optional and --fallback contradict each other: give one of them.");
  if (a.has_max_frequencies && !paper)
    refuse("--max-frequencies belongs to --profile paper: add it, or leave both out.");
  if (a.has_effort && paper)
    refuse("--effort does not exist in --profile paper: use --max-frequencies or --time-limit.");
  if (a.has_contact_weight && paper) refuse("--contact-weight does not exist in --profile paper: leave it out.");
}

codec::CompressOptions make_options(const Arguments& a) {
  codec::CompressOptions options;
  options.profile = a.profile == "paper" ? codec::Profile::paper : codec::Profile::standard;
  options.tolerance = parse_tolerance(a.tolerance);
  options.max_frequencies = a.max_frequencies;
  options.effort = a.effort;
  options.contact_weight = a.contact_weight;
  options.time_limit_seconds = a.time_limit_seconds;
  options.threads = a.threads;
  if (a.optional) options.requirement = gltf::Requirement::optional;
  if (a.fallback) options.requirement = gltf::Requirement::fallback;
  options.exclude = a.exclude;
  return options;
}

void check_excluded(const Arguments& a, const gltf::Document& document) {
  const std::vector<std::string> names = animation_names(document);
  for (const std::string& name : a.exclude) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    throw Error(ErrorCode::usage, fmt::format("--exclude: {} has no animation named '{}'.", a.input, name));
  }
}

int run(const Arguments& a) {
  refuse_contradictions(a);
  codec::CompressOptions options = make_options(a);
  check_output(a.output);
  check_report(a.report, {a.input, a.output});
  const auto start = std::chrono::steady_clock::now();
  const gltf::Document document = gltf::read_document(a.input, {.allow_external = a.allow_external});
  check_excluded(a, document);

  report::CompressContext context;
  context.file_bytes_before = bytes_on_disk(a.input, document);
  codec::CompressResult result = [&] {
    ProgressLine line(!a.quiet);
    options.progress = line.callback();
    return codec::compress(document, options);
  }();
  gltf::write_document(result.document, a.output);
  if (result.clips.empty()) result.notes.push_back("the file has no animations; it was written as it is");

  context.version = version;
  context.input = a.input;
  context.output = a.output;
  context.profile = options.profile;
  context.file_bytes_after = bytes_on_disk(a.output, result.document);
  context.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  context.node_names = node_names(document);
  if (!a.report.empty()) {
    write_report(
        a.report, report::compress_json(result, context),
        codec::compare(document, result.document, context.file_bytes_before, context.file_bytes_after, a.threads));
  }
  if (a.json) {
    print(json_text(report::compress_json(result, context)));
  } else if (!a.quiet) {
    print(report::compress_text(result, context));
  }
  return 0;
}

}  // namespace

Run compress_command(CLI::App& app) {
  const auto a = std::make_shared<Arguments>();
  app.add_option("IN", a->input, "the file to compress: .glb or .gltf")->required();
  app.add_option("OUT", a->output, "the file to write: .glb, or .gltf with a .bin beside it; may be IN")->required();

  app.add_option("--tolerance", a->tolerance,
                 "largest error that may be seen: a share of the character's\n"
                 "size, above 0% to 100%, or a length above 0: 2mm, 1cm,\n"
                 "0.01m (default 0.1%)")
      ->type_name("AMOUNT")
      ->group("Error bound");
  app.add_option("--exclude", a->exclude, "leave this animation as it is; may be repeated (default none)")
      ->type_name("NAME")
      ->allow_extra_args(false)
      ->group("Error bound");

  app.add_option("--profile", a->profile,
                 "default: the smallest file that keeps the tolerance on\n"
                 "joints and skin; paper: the published method, the tolerance\n"
                 "on joints alone (default default)")
      ->type_name("NAME")
      ->check(CLI::Validator(
          [](const std::string& name) {
            return name == "default" || name == "paper"
                       ? ""
                       : fmt::format("'{}' is no profile: there are default and paper", name);
          },
          ""))
      ->group("Method");
  CLI::Option* effort =
      app.add_option("--effort", a->effort, "1 (fast) to 9 (smallest file); profile default only (default 5)")
          ->type_name("N")
          ->check(whole_number(1, 9))
          ->group("Method");
  CLI::Option* contact_weight =
      app.add_option(
             "--contact-weight", a->contact_weight,
             "1 to 100: how often the error of points that stand still\ncounts; profile default only (default 3)")
          ->type_name("X")
          ->check(CLI::Range(1.0, 100.0))
          ->group("Method");
  CLI::Option* frequencies = app.add_option("--max-frequencies", a->max_frequencies,
                                            "where Algorithm 1 gives up, 0 to 1000; profile paper only\n(default 40)")
                                 ->type_name("N")
                                 ->check(whole_number(0, 1000))
                                 ->group("Method");
  app.add_option("--time-limit", a->time_limit_seconds,
                 "stop searching after this time, above 0; what is not done\nstays as it is (default none)")
      ->type_name("SECONDS")
      ->check(positive_number())
      ->group("Method");
  app.add_option("--threads", a->threads, "1 to 1024; the result does not depend on it (default all)")
      ->type_name("N")
      ->check(whole_number(1, 1024))
      ->group("Method");

  app.add_flag("--optional", a->optional, "readers without the extension show the model, standing still")
      ->group("File");
  app.add_flag("--fallback", a->fallback, "the original keys stay in the file as well")->group("File");
  app.add_flag("--allow-external", a->allow_external, "let URIs in IN leave its folder (default refused)")
      ->group("File");

  app.add_option("--report", a->report, "write a page for the browser with player, errors and\nnumbers (default none)")
      ->type_name("FILE.html")
      ->group("Output");
  app.add_flag("--json", a->json, "the report as JSON on standard output instead of the table")->group("Output");
  app.add_flag("--quiet", a->quiet, "no table and no progress line")->group("Output");
  return [=] {
    a->has_effort = effort->count() > 0;
    a->has_contact_weight = contact_weight->count() > 0;
    a->has_max_frequencies = frequencies->count() > 0;
    return run(*a);
  };
}

}  // namespace nmc::cli
