// The page of `gltf-nmc compare`: tables and a plot of error over bytes, in one file.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "report/compare_report.h"
#include "report/format.h"
#include "report/html_report.h"

namespace nmc::report {
namespace {

using baselines::Comparison;
using baselines::Encoding;
using baselines::MethodResult;

constexpr std::array colors{"#d62728", "#1f77b4", "#17becf", "#2ca02c", "#7f7f7f", "#8c564b", "#bcbd22",
                            "#9467bd", "#e377c2", "#ff7f0e", "#005f73", "#6a994e", "#3d405b"};

/// What no finer setting of the same method beats in both bytes and error, from few bytes to many.
std::vector<const Encoding*> front(const MethodResult& method) {
  std::vector<const Encoding*> all;
  for (const Encoding& made : method.curve)
    if (std::isfinite(made.max_error) && made.max_error > 0 && !made.bytes.empty()) all.push_back(&made);
  std::sort(all.begin(), all.end(), [](const Encoding* a, const Encoding* b) {
    return std::pair(a->bytes.size(), a->max_error) < std::pair(b->bytes.size(), b->max_error);
  });
  std::vector<const Encoding*> kept;
  for (const Encoding* made : all)
    if (kept.empty() || made->max_error < kept.back()->max_error) kept.push_back(made);
  return kept;
}

/// Logarithmic axes in a frame of fixed size.
struct Plot {
  static constexpr double left = 70, top = 20, width = 700, height = 420;
  double low_bytes = 1, high_bytes = 10, low_error = 1e-4, high_error = 1;

  double x(double bytes) const { return left + width * std::log(bytes / low_bytes) / std::log(high_bytes / low_bytes); }
  double y(double error) const {
    return top + height * std::log(high_error / error) / std::log(high_error / low_error);
  }
};

Plot make_plot(const Comparison& result) {
  double low_bytes = std::numeric_limits<double>::max(), high_bytes = 1, low = low_bytes, high = 0;
  for (const MethodResult& method : result.methods)
    for (const Encoding* made : front(method)) {
      low_bytes = std::min(low_bytes, static_cast<double>(made->bytes.size()));
      high_bytes = std::max(high_bytes, static_cast<double>(made->bytes.size()));
    }
  for (const double tolerance : result.tolerances) {
    low = std::min(low, tolerance);
    high = std::max(high, tolerance);
  }
  if (low_bytes > high_bytes) low_bytes = 1;
  const auto power = [](double v) { return std::pow(10.0, v); };
  return {power(std::floor(std::log10(low_bytes))), power(std::ceil(std::log10(high_bytes) + 1e-9)), low / 2, high * 4};
}

std::string axes(const Plot& plot) {
  std::string svg;
  for (double bytes = plot.low_bytes; bytes <= plot.high_bytes * 1.001; bytes *= 10)
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/><text x=\"{0:.1f}\" y=\"{3}\" "
        "text-anchor=\"middle\">{4}</text>\n",
        plot.x(bytes), plot.top, plot.top + plot.height, plot.top + plot.height + 18,
        format_bytes(static_cast<std::size_t>(std::lround(bytes))));
  for (const double error : {1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 0.1, 0.2, 0.5, 1.0}) {
    if (error < plot.low_error || error > plot.high_error) continue;
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/><text x=\"{3}\" y=\"{4:.1f}\" "
        "text-anchor=\"end\">{5:g}%</text>\n",
        plot.left, plot.left + plot.width, plot.y(error), plot.left - 6, plot.y(error) + 4, 100 * error);
  }
  return svg + fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">bytes</text>\n", plot.left + plot.width / 2,
                           plot.top + plot.height + 38);
}

std::string curve(const Plot& plot, const MethodResult& method, std::size_t index) {
  const char* color = colors[index % colors.size()];
  std::string points, marks;
  for (const Encoding* made : front(method)) {
    if (made->max_error > plot.high_error || made->max_error < plot.low_error) continue;
    const double x = plot.x(static_cast<double>(made->bytes.size())), y = plot.y(made->max_error);
    points += fmt::format("{:.1f},{:.1f} ", x, y);
    marks += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"><title>{}: {} bytes, {}</title></circle>", x, y, color,
        escape_html(method.method->name), format_bytes(made->bytes.size()), format_percent(made->max_error));
  }
  return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>{}\n", points, color,
                     index == 0 ? 3 : 1.5, marks);
}

std::string legend(const Comparison& result) {
  std::string svg;
  for (std::size_t i = 0; i < result.methods.size(); ++i) {
    const double y = Plot::top + 10 + 20 * static_cast<double>(i), x = Plot::left + Plot::width + 20;
    svg += fmt::format(
        "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2}\" y2=\"{2}\" stroke=\"{3}\" stroke-width=\"3\"/><text x=\"{4}\" "
        "y=\"{5}\">{6}</text>\n",
        x, x + 20, y, colors[i % colors.size()], x + 26, y + 4, escape_html(result.methods[i].method->name));
  }
  return svg;
}

/// Errors in shares of the size are what the plot shows; the curves hold world units.
Comparison in_shares(Comparison result) {
  for (MethodResult& method : result.methods)
    for (Encoding& made : method.curve) {
      made.max_error /= result.size;
      made.max_joint /= result.size;
      made.mean_error /= result.size;
    }
  result.size = 1;
  return result;
}

std::string table(const Comparison& result, const CompareContext& context) {
  std::string html = "<table><thead><tr><th>method</th>";
  for (const double tolerance : result.tolerances)
    html += fmt::format("<th>bytes at {}</th><th>ratio</th><th>mean error</th>", format_percent(tolerance));
  html += "<th>encode frames/s</th><th>decode frames/s</th><th>source</th></tr></thead>\n<tbody>";
  for (const MethodResult& method : result.methods) {
    html += fmt::format("<tr><th>{}</th>", escape_html(method.method->name));
    const Encoding* last = nullptr;
    for (const std::optional<std::size_t>& best : method.best) {
      if (!best) {
        html += "<td>-</td><td></td><td></td>";
        continue;
      }
      last = &method.curve[*best];
      html += fmt::format("<td>{}</td><td>{}</td><td>{}</td>", format_bytes(last->bytes.size()),
                          format_ratio(context.original_bytes, last->bytes.size()), format_percent(last->mean_error));
    }
    const auto rate = [&](double seconds) {
      return seconds > 0 ? format_bytes(static_cast<std::size_t>(static_cast<double>(result.frames) / seconds)) : "";
    };
    html += fmt::format("<td>{}</td><td>{}</td><td class=\"left\">{}</td></tr>\n",
                        last ? rate(last->encode_seconds) : "", last ? rate(last->decode_seconds) : "",
                        escape_html(method.failure.empty() ? method.method->source : std::string_view(method.failure)));
  }
  return html + "</tbody></table>\n";
}

constexpr const char* style =
    ":root{color-scheme:light dark}body{font:15px/1.5 system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 "
    "1em}"
    "table{border-collapse:collapse;font-variant-numeric:tabular-nums}td,th{padding:.2em .7em;text-align:right;"
    "border-bottom:1px solid #8884;font-size:13px}tbody "
    "th,.left{text-align:left}div{overflow-x:auto}svg{max-width:100%}"
    "svg text{font:12px system-ui,sans-serif;fill:currentColor}.grid{stroke:#8885;stroke-width:1}";

}  // namespace

std::string compare_html(const Comparison& given, const CompareContext& context) {
  const Comparison result = in_shares(given);
  const Plot plot = make_plot(result);
  const double legend_bottom = Plot::top + 20 + 20 * static_cast<double>(result.methods.size());
  std::string svg = fmt::format("<svg viewBox=\"0 0 920 {}\" role=\"img\" aria-label=\"largest error over bytes\">\n",
                                std::max(Plot::top + Plot::height + 50, legend_bottom));
  svg += axes(plot);
  for (std::size_t i = 0; i < result.methods.size(); ++i) svg += curve(plot, result.methods[i], i);
  svg += legend(result) + "</svg>\n";
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>{0}: methods compared</title><style>{1}</style>"
      "</head><body>\n<h1>{0}: methods compared</h1>\n"
      "<p>{2} animations, {3} frames, {4} bytes of keys. Errors are the largest (or mean) distances of joints and skin "
      "points, in per cent of the character's size ({5}). Made by gltf-nmc {6}.</p>\n"
      "<h2>Largest error over bytes</h2>\n<div>{7}</div>\n<h2>Bytes at equal "
      "error</h2>\n<div>{8}</div>\n</body></html>\n",
      escape_html(printable(context.input)), style, result.clips, format_bytes(result.frames),
      format_bytes(context.original_bytes), format_length(given.size), escape_html(context.version), svg,
      table(result, context));
}

}  // namespace nmc::report
