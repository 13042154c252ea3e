// gltf-nmc compare: all methods on the animations of one file.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "baselines/comparison.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/progress_line.h"
#include "cli/tolerance.h"
#include "gltf/cost.h"
#include "gltf/files.h"
#include "report/compare_report.h"

namespace nmc::cli {
namespace {

struct Arguments {
  std::string input;
  std::string output;
  std::string methods;
  std::string tolerances = "0.1,0.5,1,2%";
  std::string keep_encoded;
  std::string check_encoded;
  int effort = 5;
  int threads = 0;
  bool json = false;
  bool quiet = false;
  bool allow_external = false;
};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t first = 0; first <= text.size();) {
    const std::size_t end = std::min(text.find(',', first), text.size());
    std::string part = text.substr(first, end - first);
    part.erase(0, part.find_first_not_of(' '));
    part.erase(part.find_last_not_of(' ') + 1);
    if (!part.empty()) parts.push_back(part);
    first = end + 1;
  }
  return parts;
}

std::string method_names() {
  std::string names;
  for (const baselines::Method& method : baselines::all_methods())
    names += fmt::format("{}{}", names.empty() ? "" : ", ", method.name);
  return names;
}

std::vector<const baselines::Method*> chosen_methods(const std::string& text) {
  std::vector<const baselines::Method*> chosen;
  if (text.empty())
    for (const baselines::Method& method : baselines::all_methods()) chosen.push_back(&method);
  for (const std::string& name : split(text)) {
    const baselines::Method* method = baselines::find_method(name);
    if (!method)
      throw Error(ErrorCode::usage, fmt::format("--methods: '{}' is no method; there are {}.", name, method_names()));
    if (std::find(chosen.begin(), chosen.end(), method) == chosen.end()) chosen.push_back(method);
  }
  if (chosen.empty())
    throw Error(ErrorCode::usage, fmt::format("--methods: none named; there are {}.", method_names()));
  return chosen;
}

/// The names in lines that fit the help.
std::string wrapped_names() {
  constexpr std::size_t most = 60;
  std::string text;
  std::size_t width = 0;
  for (const std::string& name : split(method_names())) {
    const bool breaks = width + name.size() + 2 > most;
    if (!text.empty()) text += breaks ? ",\n" : ", ";
    width = (breaks ? 0 : width + 2) + name.size();
    text += name;
  }
  return text;
}

codec::Tolerance parse_one(const std::string& text) {
  try {
    return parse_tolerance(text);
  } catch (const Error& error) {  // the sentence names the other commands' option
    const std::string sentence = error.what();
    throw Error(error.code(), "--tolerances" + sentence.substr(std::min(sentence.find(':'), sentence.size())));
  }
}

/// A number without a unit has the last one's: 0.1,0.5,1,2%.
std::vector<codec::Tolerance> parse_tolerances(const std::string& text) {
  const std::vector<std::string> parts = split(text);
  if (parts.empty()) throw Error(ErrorCode::usage, "--tolerances: none named; write them like 0.1,0.5,1,2%.");
  const std::string& last = parts.back();
  const std::size_t unit = last.find_last_of("0123456789.");
  std::vector<codec::Tolerance> tolerances;
  for (const std::string& part : parts) {
    const bool bare = part.find_first_not_of("0123456789.") == std::string::npos;
    tolerances.push_back(parse_one(bare && unit != std::string::npos ? part + last.substr(unit + 1) : part));
  }
  return tolerances;
}

codec::Source read(const Arguments& a, const gltf::Document& document,
                   const std::vector<codec::Tolerance>& tolerances) {
  codec::Source source;
  double finest = 0;
  for (const codec::Tolerance& tolerance : tolerances) {
    if (finest > 0 && in_world_units(tolerance, source.size) >= finest) continue;
    codec::CompressOptions options;
    options.tolerance = tolerance;
    source = codec::read_source(document, options);
    finest = source.tolerance;
  }
  if (source.clips.empty())
    throw Error(ErrorCode::invalid_input, fmt::format("{}: there is no animation to compare methods on", a.input));
  return source;
}

std::filesystem::path encoded_name(const std::string& folder, std::string_view method, double share) {
  return std::filesystem::path(folder) / fmt::format("{}@{:g}%.bin", method, 100 * share);
}

void keep_encoded(const std::string& folder, const baselines::Comparison& result) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    throw Error(ErrorCode::io, fmt::format("--keep-encoded: {} cannot be made: {}.", folder, failure.message()));
  gltf::FileReplacement files;
  for (const baselines::MethodResult& method : result.methods)
    for (std::size_t t = 0; t < result.tolerances.size(); ++t)
      if (method.best[t])
        files.add(encoded_name(folder, method.method->name, result.tolerances[t]), method.curve[*method.best[t]].bytes);
  files.commit();
}

/// The files that an earlier run kept in place of encoding.
baselines::Comparison check_encoded(const std::string& folder, const codec::Source& source,
                                    const baselines::CompareOptions& options) {
  baselines::Comparison result;
  result.tolerances = options.tolerances;
  result.clips = source.clips.size();
  result.size = source.size;
  for (const codec::ClipSource& clip : source.clips) result.frames += clip.clip.times.size();
  const motion::ErrorMeter meter(source.skeleton, source.all_points);
  for (const baselines::Method* method : options.methods) {
    baselines::MethodResult made;
    made.method = method;
    for (const double tolerance : options.tolerances) {
      made.best.emplace_back();
      const std::filesystem::path path = encoded_name(folder, method->name, tolerance);
      if (!std::filesystem::exists(path)) continue;
      made.curve.push_back(baselines::judge(source, meter, *method, gltf::read_file(path)));
      made.best.back() = made.curve.size() - 1;
    }
    result.methods.push_back(std::move(made));
  }
  return result;
}

void write_report(const std::string& path, const std::string& text) {
  gltf::FileReplacement file;
  file.add(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  file.commit();
}

std::string report_text(const std::string& kind, const baselines::Comparison& result,
                        const report::CompareContext& context) {
  if (kind == ".json") return json_text(report::compare_json(result, context));
  if (kind == ".csv") return report::compare_csv(result, context);
  return report::compare_html(result, context);
}

int run(const Arguments& a) {
  const std::string kind = std::filesystem::path(a.output).extension().string();
  if (!a.output.empty() && kind != ".html" && kind != ".json" && kind != ".csv")
    throw Error(ErrorCode::usage, fmt::format("-o: {} ends in none of .html, .json and .csv.", a.output));
  if (!a.check_encoded.empty() && !std::filesystem::is_directory(a.check_encoded))
    throw Error(ErrorCode::io, fmt::format("--check-encoded: {} is no folder.", a.check_encoded));
  baselines::CompareOptions options;
  options.methods = chosen_methods(a.methods);
  const std::vector<codec::Tolerance> tolerances = parse_tolerances(a.tolerances);
  options.effort = a.effort;
  options.threads = a.threads;
  const gltf::Document document = gltf::read_document(a.input, {.allow_external = a.allow_external});
  const codec::Source source = read(a, document, tolerances);
  for (const codec::Tolerance& tolerance : tolerances)
    options.tolerances.push_back(in_world_units(tolerance, source.size) / source.size);

  report::CompareContext context;
  context.version = version;
  context.input = a.input;
  context.original_bytes = gltf::total_cost(document).key_bytes;
  const baselines::Comparison result = [&] {
    ProgressLine line(!a.quiet);
    options.progress = line.callback();
    return a.check_encoded.empty() ? baselines::compare(source, options)
                                   : check_encoded(a.check_encoded, source, options);
  }();
  if (!a.keep_encoded.empty()) keep_encoded(a.keep_encoded, result);
  if (!a.output.empty()) write_report(a.output, report_text(kind, result, context));
  if (a.json)
    print(json_text(report::compare_json(result, context)));
  else if (!a.quiet)
    print(report::compare_text(result, context));
  return 0;
}

}  // namespace

Run compare_command(CLI::App& app) {
  const auto a = std::make_shared<Arguments>();
  app.add_option("IN", a->input, "the file whose animations are coded: .glb or .gltf; it stays as it is")->required();
  app.add_option("--methods", a->methods, "some of these, with commas (default all):\n" + wrapped_names())
      ->type_name("NAMES")
      ->group("Comparison");
  app.add_option("--tolerances", a->tolerances,
                 "largest errors at joints and skin, with commas: shares of the\n"
                 "character's size or lengths (default 0.1,0.5,1,2%)")
      ->type_name("LIST")
      ->group("Comparison");
  app.add_option("--effort", a->effort, "of the method nmc, 1 to 9 (default 5)")
      ->type_name("N")
      ->check(whole_number(1, 9))
      ->group("Comparison");
  app.add_option("--threads", a->threads, "1 to 1024; the result does not depend on it (default all)")
      ->type_name("N")
      ->check(whole_number(1, 1024))
      ->group("Comparison");
  app.add_flag("--allow-external", a->allow_external, "let URIs in IN leave its folder (default refused)")
      ->group("File");
  app.add_option("-o,--output", a->output, "a page with a plot (.html), or the numbers (.json, .csv)\n(default none)")
      ->type_name("FILE")
      ->group("Output");
  app.add_option("--keep-encoded", a->keep_encoded,
                 "a folder for the encoded bytes, one METHOD@TOLERANCE%.bin each\n(default none)")
      ->type_name("FOLDER")
      ->group("Output");
  app.add_option("--check-encoded", a->check_encoded,
                 "encode nothing: decode and measure the files that\n--keep-encoded wrote for IN (default none)")
      ->type_name("FOLDER")
      ->group("Output");
  app.add_flag("--json", a->json, "the report as JSON on standard output instead of the table")->group("Output");
  app.add_flag("--quiet", a->quiet, "no table and no progress line")->group("Output");
  return [=] { return run(*a); };
}

}  // namespace nmc::cli
