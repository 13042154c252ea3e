#include "report/table.h"

#include <algorithm>
#include <stdexcept>

#include "report/format.h"

namespace nmc::report {
namespace {

constexpr std::size_t widest_cell = 40;

std::string padded(const std::string& cell, std::size_t width, Align align) {
  const std::string blanks(width - display_width(cell), ' ');
  return align == Align::left ? cell + blanks : blanks + cell;
}

}  // namespace

void Table::add_row(std::vector<std::string> cells) {
  if (cells.size() > columns_.size()) throw std::logic_error("a table row has more cells than the table has columns");
  cells.resize(columns_.size());
  for (std::string& cell : cells) cell = shorten(printable(cell), widest_cell);
  rows_.push_back(std::move(cells));
}

std::string Table::text() const {
  std::vector<std::size_t> widths(columns_.size(), 0);
  std::vector<std::size_t> shown;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    for (const auto& row : rows_) widths[c] = std::max(widths[c], display_width(row[c]));
    if (widths[c] == 0) continue;
    widths[c] = std::max(widths[c], display_width(columns_[c].title));
    shown.push_back(c);
  }
  const auto line = [&](const auto& cell_of) {
    std::string out;
    for (const std::size_t c : shown) {
      if (!out.empty()) out += "  ";
      out += padded(cell_of(c), widths[c], columns_[c].align);
    }
    out.erase(out.find_last_not_of(' ') + 1);
    return out + "\n";
  };
  const auto rule = [&] { return line([&](std::size_t c) { return std::string(widths[c], '-'); }); };

  std::string out = line([&](std::size_t c) { return columns_[c].title; }) + rule();
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (std::find(rules_.begin(), rules_.end(), r) != rules_.end()) out += rule();
    out += line([&](std::size_t c) { return rows_[r][c]; });
  }
  return out;
}

}  // namespace nmc::report
