// gltf-nmc compress: the default command.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <new>
#include <numeric>
#include <optional>

#include "base/error.h"
#include "cli/cache.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/nearest.h"
#include "cli/outputs.h"
#include "cli/progress_line.h"
#include "cli/report_file.h"
#include "cli/settings.h"
#include "cli/terminal.h"
#include "codec/mesh_packing.h"
#include "codec/target_size.h"
#include "gltf/files.h"
#include "report/batch_report.h"
#include "report/compress_report.h"

namespace nmc::cli {
namespace {

struct Arguments {
  std::vector<std::string> files;
  std::string output;
  int threads = 0;
  std::string report;
  bool explain = false;
  bool draco = false;
  gltf::DracoBits draco_bits;
  std::vector<const CLI::Option*> draco_options;
  bool json = false;
  bool quiet = false;
  bool verbose = false;
  bool allow_external = false;
  std::string cache;
  bool dry_run = false;
  std::string settings;  ///< the options that the bytes depend on, as text
};

void refuse_contradictions(const Arguments& a, const Settings& settings) {
  const auto refuse = [](const std::string& sentence) { throw Error(ErrorCode::usage, sentence); };
  if (a.quiet && a.verbose) refuse("--quiet and --verbose contradict each other: give one of them.");
  if (a.draco && !settings.rules.empty())
    refuse("--draco holds meshes to one tolerance for everything: leave the others out.");
  for (const CLI::Option* option : a.draco_options) {
    if (a.draco || option->count() == 0) continue;
    const std::string name = option->get_name();
    refuse(fmt::format("{} belongs to --draco: add that, or leave {} out.", name, name));
  }
}

/// Names of --exclude that the file does not have.
std::vector<std::string> unknown_excluded(const codec::CompressOptions& options,
                                          const std::vector<std::string>& names) {
  std::vector<std::string> unknown;
  for (const std::string& name : options.exclude)
    if (std::find(names.begin(), names.end(), name) == names.end()) unknown.push_back(name);
  return unknown;
}

Verbosity verbosity(const Arguments& a) {
  return a.quiet ? Verbosity::quiet : a.verbose ? Verbosity::verbose : Verbosity::normal;
}

/// What became of one file, with the table for people.
struct FileResult {
  report::BatchFile file;
  std::string text;
};

/// One run over one file or many.
class Compression {
 public:
  Compression(const Arguments& a, const Settings& settings, const Outputs& outputs)
      : a_(a), settings_(settings), many_(!outputs.folder.empty()) {
    apply(settings, options_);
    options_.threads = a.threads;
    if (a.draco) options_.tolerance.value *= 1 - codec::mesh_share;
    options_.record_candidates = !a.report.empty();
    options_.explain = a.explain;
    if (!a.cache.empty()) cache_.emplace(a.cache, a.dry_run);
  }

  /// Throws Error for a file that cannot be read, compressed or written.
  FileResult run(const FilePair& pair, ProgressLine& line) {
    FileResult result;
    result.file.input = pair.input;
    result.file.output = pair.output;
    if (!many_ || !a_.dry_run) check_output(pair.output);
    const auto start = std::chrono::steady_clock::now();
    const gltf::Bytes bytes = gltf::read_file(pair.input);
    const std::filesystem::path path(pair.input);
    const gltf::Document document = gltf::parse_document(bytes, path.filename().string(), path.parent_path(),
                                                         {.allow_external = a_.allow_external});
    std::vector<std::string> notes;
    const std::vector<std::string> names = animation_names(document);
    for (const std::string& name : unknown_excluded(options_, names)) {
      if (!many_)
        throw Error(ErrorCode::usage, fmt::format("--exclude: {} has no animation named '{}'{}", pair.input, name,
                                                  did_you_mean(name, names)));
      notes.push_back(fmt::format("it has no animation named '{}' to exclude", name));
    }

    const std::string key = cache_ ? Cache::key(a_.settings, bytes, document) : "";
    CachedResult cached;
    if (cache_) {
      const Cache::Found found = cache_->find(key, cached);
      result.file.cache_damaged = found == Cache::Found::damaged;
      if (found == Cache::Found::entry) {
        line.skip();
        take(document, std::move(cached), start, result);
        return result;
      }
    }
    if (a_.dry_run) {
      result.file.status = report::FileStatus::would_compress;
      result.file.animations = names.size();
      return result;
    }
    compress(document, key, std::move(notes), start, line, result);
    return result;
  }

 private:
  using Clock = std::chrono::steady_clock;

  static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  void take(const gltf::Document& document, CachedResult cached, Clock::time_point start, FileResult& result) const {
    report::BatchFile& file = result.file;
    if (a_.dry_run) {
      file.status = report::FileStatus::would_take_cache;
      return;
    }
    cached.document.name = document.name;
    cached.document.folder = document.folder;
    gltf::write_document(cached.document, file.output);
    file.status = report::FileStatus::from_cache;
    file.report = std::move(cached.report);
    file.report["input"] = file.input;
    file.report["output"] = file.output;
    file.report["seconds_spent"] = seconds_since(start);
    file.report["from_cache"] = true;
    write_page(document, cached.document, file.report, tried_of(cached.tried));
    result.text = report::cached_text(file.report);
  }

  /// What was tried for each animation, where it was recorded.
  using Tried = std::vector<std::vector<codec::Candidate>>;

  static Tried tried_of(const std::vector<codec::ClipResult>& clips) {
    Tried tried;
    for (const codec::ClipResult& clip : clips) tried.push_back(clip.candidates);
    return tried;
  }

  /// The same out of the cache and into it.
  static Tried tried_of(const nlohmann::ordered_json& json) {
    Tried tried;
    for (const auto& clip : json) {
      tried.emplace_back();
      for (const auto& one : clip)
        tried.back().push_back(
            {one.at(0).get<std::size_t>(), one.at(1).get<double>(), one.at(2).get<bool>(), one.at(3).get<bool>()});
    }
    return tried;
  }

  static nlohmann::ordered_json tried_json(const Tried& tried) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const std::vector<codec::Candidate>& clip : tried) {
      json.push_back(nlohmann::ordered_json::array());
      for (const codec::Candidate& one : clip)
        json.back().push_back(nlohmann::ordered_json::array({one.bytes, one.error, one.kept, one.chosen}));
    }
    return json;
  }

  /// --report
  void write_page(const gltf::Document& before, const gltf::Document& after, const nlohmann::ordered_json& report,
                  const Tried& tried) const {
    if (a_.report.empty()) return;
    codec::Comparison comparison = codec::compare(before, after, report["file_bytes_before"].get<std::size_t>(),
                                                  report["file_bytes_after"].get<std::size_t>(), a_.threads);
    for (codec::ComparedClip& clip : comparison.clips)
      clip.candidates = tried.at(static_cast<std::size_t>(clip.animation));
    write_report(a_.report, report, comparison);
  }

  void compress(const gltf::Document& document, const std::string& key, std::vector<std::string> notes,
                Clock::time_point start, ProgressLine& line, FileResult& outcome) {
    report::CompressContext context;
    report::BatchFile& file = outcome.file;
    context.file_bytes_before = bytes_on_disk(file.input, document);
    options_.progress = line.callback();
    codec::CompressResult result = settings_.target_bytes
                                       ? codec::compress_to_size(document, options_, *settings_.target_bytes)
                                       : codec::compress(document, options_);
    if (a_.draco) codec::pack_meshes(document, a_.draco_bits, result);
    gltf::write_document(result.document, file.output);
    if (result.clips.empty()) result.notes.push_back("the file has no animations; it was written as it is");
    result.notes.insert(result.notes.end(), notes.begin(), notes.end());

    context.version = version;
    context.input = file.input;
    context.output = file.output;
    context.profile = options_.profile;
    context.file_bytes_after = bytes_on_disk(file.output, result.document);
    context.seconds = seconds_since(start);
    context.node_names = node_names(document);
    file.status = report::FileStatus::compressed;
    file.report = report::compress_json(result, context);
    const Tried tried = tried_of(result.clips);
    write_page(document, result.document, file.report, tried);
    if (cache_) {
      cache_->store(key, result.document, file.report, tried_json(tried));
      file.report["from_cache"] = false;
    }
    if (file.cache_damaged) result.notes.push_back("the cache's entry was damaged; it was made again");
    outcome.text = report::compress_text(result, context);
  }

  const Arguments& a_;
  const Settings& settings_;
  bool many_;
  codec::CompressOptions options_;
  std::optional<Cache> cache_;
};

/// The file's failure in place of its result; the others go on.
FileResult failed(const FilePair& pair, ErrorCode code, const std::string& sentence) {
  FileResult result;
  result.file.input = pair.input;
  result.file.output = pair.output;
  result.file.exit_code = static_cast<int>(code);
  result.file.error = sentence;
  print_failure(sentence);
  return result;
}

void print_batch(const Arguments& a, const std::vector<report::BatchFile>& files, const report::BatchContext& context) {
  if (a.json) {
    print(json_text(report::batch_json(files, context)));
  } else if (!a.quiet) {
    print(coloured(report::batch_text(files, context)));
  }
}

int run_many(const Arguments& a, const Settings& settings, const Outputs& outputs) {
  const auto start = std::chrono::steady_clock::now();
  if (!a.dry_run) make_folder(outputs.folder);
  Compression compression(a, settings, outputs);
  std::vector<report::BatchFile> files;
  std::vector<std::uint64_t> weights;
  for (const FilePair& pair : outputs.files) weights.push_back(file_bytes(pair.input));
  ProgressLine line(verbosity(a), std::accumulate(weights.begin(), weights.end(), std::uint64_t{0}));
  for (std::size_t i = 0; i < outputs.files.size(); ++i) {
    const FilePair& pair = outputs.files[i];
    line.begin(fmt::format("{}/{} {}", i + 1, outputs.files.size(), pair.input), weights[i]);
    try {
      files.push_back(compression.run(pair, line).file);
    } catch (const Error& error) {
      line.skip();
      files.push_back(failed(pair, error.code(), error.what()).file);
    } catch (const std::bad_alloc&) {
      line.skip();
      files.push_back(failed(pair, ErrorCode::internal, pair.input + ": there is not enough memory for it.").file);
    }
  }
  line.end();
  const report::BatchContext context{
      .version = version,
      .folder = outputs.folder,
      .dry_run = a.dry_run,
      .has_cache = !a.cache.empty(),
      .seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
  print_batch(a, files, context);
  return report::worst_exit_code(files);
}

int run_one(const Arguments& a, const Settings& settings, const Outputs& outputs) {
  check_report(a.report, {outputs.files[0].input, outputs.files[0].output});
  const FileResult result = [&] {
    Compression compression(a, settings, outputs);
    ProgressLine line(verbosity(a));
    return compression.run(outputs.files[0], line);
  }();
  if (a.dry_run) {
    const report::BatchContext context{
        .version = version, .folder = "", .dry_run = true, .has_cache = !a.cache.empty(), .seconds = 0};
    print_batch(a, {result.file}, context);
  } else if (a.json) {
    print(json_text(result.file.report));
  } else if (!a.quiet) {
    print(coloured(result.text));
  }
  return 0;
}

int run(const Arguments& a, const SettingsArguments& given) {
  const Settings settings = read_settings(given);
  refuse_contradictions(a, settings);
  const Outputs outputs = plan_outputs(a.files, a.output);
  if (!outputs.folder.empty() && !a.report.empty())
    throw Error(ErrorCode::usage, "--report is about one file: name one input and the file to write.");
  return outputs.folder.empty() ? run_one(a, settings, outputs) : run_many(a, settings, outputs);
}

/// The options that were given and that the bytes may depend on, as text for the cache: all but those known not to.
std::string settings_text(const CLI::App& app) {
  static constexpr std::array neutral{"--threads", "--json",   "--quiet",          "--verbose", "--cache",  "--output",
                                      "--dry-run", "--report", "--allow-external", "--help",    "--version"};
  std::string text;
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0 || option->get_positional()) continue;
    const std::string name = option->get_name();
    if (std::find(neutral.begin(), neutral.end(), name) != neutral.end()) continue;
    text += name + '\n';
    for (const std::string& value : option->results()) text += fmt::format("  {}:{}\n", value.size(), value);
  }
  return text;
}

/// Where the meshes are packed too: --draco, and the bits for each kind of attribute.
void add_mesh_options(CLI::App& app, Arguments& a) {
  app.add_flag("--draco", a.draco, "pack the meshes as well, with Draco; the tolerance\nholds over both")
      ->group("Meshes");
  const auto add = [&](const char* name, int& bits, const char* what) {
    const std::string text =
        fmt::format("bits of {}{}(default {})", what, std::string_view(what).size() > 30 ? '\n' : ' ', bits);
    a.draco_options.push_back(
        app.add_option(name, bits, text)->type_name("N")->check(whole_number(2, 24))->group("Meshes"));
  };
  add("--draco-position", a.draco_bits.position, "positions, 2 to 24; more where needed");
  add("--draco-normal", a.draco_bits.normal, "normals, 2 to 24");
  add("--draco-texcoord", a.draco_bits.texcoord, "texture coordinates, 2 to 24");
  add("--draco-color", a.draco_bits.color, "colours, 2 to 24");
  add("--draco-weight", a.draco_bits.weight, "skin weights, 2 to 24; more where needed");
  add("--draco-generic", a.draco_bits.generic, "other attributes, 2 to 24");
}

}  // namespace

Run compress_command(CLI::App& app) {
  const auto a = std::make_shared<Arguments>();
  app.add_option("FILE", a->files,
                 "IN OUT: the file to compress and the file to write, .glb or\n"
                 ".gltf (with a .bin beside it), OUT may be IN; with -o: one IN\n"
                 "or more")
      ->type_name("...");
  app.add_option("-o,--output", a->output,
                 "the file to write for one IN, or a folder where every IN gets\n"
                 "a file of its own name (default OUT)")
      ->type_name("PATH")
      ->group("File");

  const auto settings = add_settings(app);
  app.add_option("--threads", a->threads, "1 to 1024; the result does not depend on it (default all)")
      ->type_name("N")
      ->check(whole_number(1, 1024))
      ->group("Method");

  app.add_flag("--allow-external", a->allow_external, "let URIs in IN leave its folder (default refused)")
      ->group("File");

  app.add_option("--report", a->report, "write a page for the browser with player, errors and\nnumbers (default none)")
      ->type_name("FILE.html")
      ->group("Output");
  app.add_flag("--explain", a->explain,
               "keep in the file what else was tried for each animation,\nfor `inspect` to tell (default not)")
      ->group("File");
  app.add_option("--cache", a->cache,
                 "a folder of earlier results: what was compressed before with\n"
                 "the same options by this gltf-nmc is taken from there\n"
                 "(default none)")
      ->type_name("FOLDER")
      ->group("Work");
  app.add_flag("--dry-run", a->dry_run, "say what would be done; write nothing")->group("Work");

  add_mesh_options(app, *a);

  app.add_flag("--json", a->json, "the report as JSON on standard output instead of the table")->group("Output");
  app.add_flag("-q,--quiet", a->quiet, "no table and no progress line")->group("Output");
  app.add_flag("-v,--verbose", a->verbose, "a plain line on standard error for each animation that is done")
      ->group("Output");
  return [=, &app] {
    a->settings = settings_text(app);
    if (!settings->file.empty()) a->settings += read_settings_text(settings->file);
    return run(*a, *settings);
  };
}

}  // namespace nmc::cli
