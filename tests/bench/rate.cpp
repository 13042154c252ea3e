// Prints what methods make of files at given tolerances: bytes, measured error, time and memory.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "rate_codec.h"
#include "rate_contexts.h"
#include "rate_dct.h"
#include "rate_gltfpack.h"
#include "rate_hidden.h"
#include "rate_process.h"
#include "rate_table.h"

namespace {

using namespace nmc::bench;
using nmc::codec::CompressOptions;

struct Arguments {
  std::vector<double> tolerances{0.1, 0.5, 1};
  std::vector<int> efforts{1, 5, 9};
  std::string gltfpack;
  bool paper = false;
  bool no_paper = false;
  bool ablation = false;
  bool brief = false;
  bool no_gltfpack = false;
  int threads = 0;
  std::vector<std::string> files;
};

constexpr double paper_tolerance_percent = 2;  // below it the paper's profile takes long

bool wants_paper(const Arguments& arguments, double tolerance_percent) {
  return !arguments.no_paper && (arguments.paper || tolerance_percent >= paper_tolerance_percent);
}

/// Measures in a process of its own; a failure is a row as well.
Measurement apart(const std::string& method, const std::function<Measurement()>& measure) {
  try {
    return run_apart([&] { return nlohmann::json(measure()); }).get<Measurement>();
  } catch (const std::exception& error) {
    Measurement row;
    row.method = method;
    row.note = error.what();
    return row;
  }
}

/// gltfpack's best at a tolerance, or why there is none.
using Opponent = std::function<Measurement(double tolerance)>;

Opponent without_gltfpack(const std::string& why) {
  return [why](double) {
    Measurement row;
    row.method = "gltfpack";
    row.note = why;
    return row;
  };
}

Opponent gltfpack_on(const std::string& program, const std::string& file) {
  if (program.empty()) return without_gltfpack("not installed");
  try {
    return [packed = Gltfpack(program, file)](double tolerance) { return packed.best_within(tolerance); };
  } catch (const std::exception& error) {
    return without_gltfpack(error.what());
  }
}

RateTable measure_table(const Arguments& arguments, const std::string& file, double tolerance_percent,
                        const Opponent& gltfpack) {
  RateTable table{std::filesystem::path(file).filename().string(), tolerance_percent, {}};
  if (!arguments.brief) print_head(table.file, tolerance_percent);
  const auto add = [&](const Measurement& row) {
    if (!arguments.brief) print_row(row);
    table.rows.push_back(row);
  };
  CompressOptions options;
  options.tolerance.value = tolerance_percent / 100;
  options.threads = arguments.threads;
  add(apart("as it is", [&] { return measure_cost(file); }));
  for (const int effort : arguments.efforts) {
    options.effort = effort;
    add(apart(fmt::format("default, effort {}", effort), [&] { return measure_codec(file, options); }));
  }
  if (wants_paper(arguments, tolerance_percent)) {
    CompressOptions paper = options;
    paper.profile = nmc::codec::Profile::paper;
    add(apart("`--profile paper`", [&] { return measure_codec(file, paper); }));
  }
  if (arguments.ablation) {
    options.effort = arguments.efforts.front();
    for (const CompressOptions& without : ablations(options))
      add(apart("without a part", [&] { return measure_codec(file, without); }));
    add(apart("without contexts", [&] { return measure_without_contexts(file, options); }));
    add(apart("without sharing", [&] { return measure_clips_apart(file, options); }));
    add(apart("with a hidden layer", [&] { return measure_hidden_layer(file, options); }));
  }
  add(apart("DCT", [&] { return measure_dct(file, options); }));
  if (!arguments.no_gltfpack) add(gltfpack(tolerance_percent / 100));
  if (arguments.brief) print_brief_row(table, arguments.efforts);
  return table;
}

void run(const Arguments& arguments) {
  const std::string gltfpack = arguments.no_gltfpack ? "" : find_gltfpack(arguments.gltfpack);
  std::vector<RateTable> tables;
  if (arguments.brief) print_brief_head(arguments.efforts);
  for (const std::string& file : arguments.files) {
    const Opponent opponent = gltfpack_on(gltfpack, file);
    for (const double tolerance : arguments.tolerances)
      tables.push_back(measure_table(arguments, file, tolerance, opponent));
  }
  print_means(tables);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Prints bytes, error, time and memory of the codec and of others on files.", "bench_rate");
  app.add_option("--tolerances", arguments.tolerances, "per cent of the character's size")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(1e-6, 100.0));
  app.add_option("--efforts", arguments.efforts, "of the default profile")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(1, 9));
  app.add_option("--gltfpack", arguments.gltfpack, "the program (default: that of tests/node_modules)");
  app.add_flag("--no-gltfpack", arguments.no_gltfpack, "leave gltfpack out");
  app.add_flag("--paper", arguments.paper, "the paper's profile at all tolerances, not only from 2 % on");
  app.add_flag("--no-paper", arguments.no_paper, "leave the paper's profile out");
  app.add_flag("--ablation", arguments.ablation,
               "the default with one part after the other left out, and with a hidden layer, at the first effort");
  app.add_flag("--brief", arguments.brief, "one line for each file and tolerance");
  app.add_option("--threads", arguments.threads, "0: all")->check(CLI::Range(0, 1024));
  app.add_option("FILES", arguments.files)->required()->check(CLI::ExistingFile);
  CLI11_PARSE(app, argc, argv);
  try {
    run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
