// The report that people open in a browser: one HTML file with everything in it, no network.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "codec/comparison.h"

namespace nmc::report {

/// The page. `report`: what --json prints, whose numbers are the page's; `comparison`: the motions that it plays.
std::string html_report(const nlohmann::ordered_json& report, const codec::Comparison& comparison);

/// What the page's scripts read: the report, the skeleton, the streams and the motions (src/report/html/data.js says
/// how they are packed).
nlohmann::ordered_json html_data(const nlohmann::ordered_json& report, const codec::Comparison& comparison);

/// JSON that stands in a script element: no "<" and no line separator of JavaScript; bytes that are no UTF-8 are
/// replaced.
std::string script_json(const nlohmann::ordered_json& json);

/// Text that stands in an element or in an attribute between double quotes.
std::string escape_html(std::string_view text);

}  // namespace nmc::report
