// Puts the page together: template, style, scripts as modules in data URLs, data.
#include "report/html_report.h"

#include <fmt/format.h>

#include <string_view>

#include "base/base64.h"
#include "report/embedded_text.h"

namespace nmc::report {
namespace {

/// The modules that the page imports; each names the others as "./name".
constexpr std::string_view modules[] = {
    "bars.js",          "charts.js",      "data.js",      "format.js",     "main.js",        "math.js",
    "motion.js",        "player.js",      "scene.js",     "skin.js",       "spectrum.js",    "table.js",
    "nmc/decisions.js", "nmc/decoder.js", "nmc/error.js", "nmc/header.js", "nmc/payload.js", "nmc/pose.js"};

void replace_all(std::string& text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Modules in data URLs have no folder: their relative imports become names of the import map.
std::string import_map() {
  nlohmann::ordered_json imports = nlohmann::ordered_json::object();
  for (const std::string_view name : modules) {
    std::string text(embedded_text(name));
    replace_all(text, "from './nmc/", "from 'nmc/");
    replace_all(text, "from './", name.starts_with("nmc/") ? "from 'nmc/" : "from 'report/");
    const std::string key = name.starts_with("nmc/") ? std::string(name) : "report/" + std::string(name);
    imports[key] = "data:text/javascript;base64," + base64(bytes_of(text));
  }
  return nlohmann::ordered_json{{"imports", std::move(imports)}}.dump();
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string script_json(const nlohmann::ordered_json& json) {
  std::string text = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  replace_all(text, "<", "\\u003c");
  replace_all(text, "\u2028", "\\u2028");
  replace_all(text, "\u2029", "\\u2029");
  return text;
}

std::string html_report(const nlohmann::ordered_json& report, const codec::Comparison& comparison) {
  const auto name_of = [&](const char* key) {
    const std::string path = report.contains(key) ? report[key].get<std::string>() : std::string();
    return path.substr(path.find_last_of('/') + 1);
  };
  const std::string name = name_of(report.contains("input") ? "input" : "original");
  const std::string title = nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  const std::string data = script_json(html_data(report, comparison));
  const std::string imports = import_map();
  // Each mark of the template once, from left to right: what is put in is not looked at again.
  std::string page;
  std::string_view rest = embedded_text("page.html");
  const std::pair<std::string_view, std::string> parts[] = {{"%TITLE%", escape_html(title.substr(1, title.size() - 2))},
                                                            {"%STYLE%", std::string(embedded_text("page.css"))},
                                                            {"%IMPORTS%", imports},
                                                            {"%DATA%", data}};
  for (const auto& [mark, text] : parts) {
    const std::size_t at = rest.find(mark);
    page += rest.substr(0, at);
    page += text;
    rest.remove_prefix(at + mark.size());
  }
  return page += rest;
}

}  // namespace nmc::report
